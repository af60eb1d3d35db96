//! WGSL text: which files make which module, and the parts that are put together from the scene.
//!
//! No wgpu handle lives here. Entry points stand in `shaders/pass` alone; everything else is importable
//! and free of side effects.

mod carried;
mod contents;
mod deforming;
pub mod effect;
pub mod effect_file;
mod forward;
mod hiding;
mod lens_test;
mod lining;
mod plan;
mod regions;
mod sections;
mod sorting;
mod specialised;
mod uber;
pub mod wgsl;

pub use carried::LEAST_CARRIED;
pub use deforming::{DEFORMER_NUMBERS, DeformPlan, PlanControl, PlanDeformer, PlanStep, STEP_NUMBERS};
pub use effect::{EffectDefinition, EffectKind, Mode, PerObject, effects, handlers};
pub use forward::{Forward, ForwardKind};
pub use plan::{
    Blend, BodyKind, ClassTest, Clip, MOST_CITIES, Plan, PlanBody, PlanBorder, PlanContent, PlanLens, Program, Scope,
    Step, Uber, VolumeTest,
};
pub use regions::Regions;
pub use specialised::scope_number;
pub use uber::{MOST_SLOTS, MOST_VOLUMES, TILE_PX};

macro_rules! files {
    ($($name:ident = $path:literal;)*) => {
        $(const $name: (&str, &str) = ($path, include_str!(concat!("../../shaders/", $path)));)*
    };
}

files! {
    VIEW = "lib/view.wgsl";
    VIEW_UNIFORM = "lib/view-uniform.wgsl";
    SURFACE = "lib/surface.wgsl";
    COLOR = "lib/color.wgsl";
    PACKED = "lib/packed.wgsl";
    SHAPE = "lib/shape.wgsl";
    LIGHT = "lib/light.wgsl";
    BLEND = "lib/blend.wgsl";
    MATERIAL = "lib/material.wgsl";
    CLASS = "lib/class.wgsl";
    DITHER = "lib/dither.wgsl";
    BORDER = "lib/border.wgsl";
    DISTANCE = "lib/distance.wgsl";
    SOLID_DISTANCE = "lib/solid-distance.wgsl";
    COMBINED_DISTANCE = "lib/combined-distance.wgsl";
    SIGHT = "lib/sight.wgsl";
    LENS = "lib/lens.wgsl";
    LENS_SPRITE = "lib/lens-sprite.wgsl";
    DEPTH_CODE = "lib/depth-code.wgsl";
    STORED_SPRITE = "lib/stored-sprite.wgsl";
    OWN_SPRITE = "lib/own-sprite.wgsl";
    STORED_PASS = "pass/stored-sprite.wgsl";
    STORED_FORM = "lib/stored-form.wgsl";
    STORED_LAYERS = "lib/stored-layers.wgsl";
    SPRITE_LIST = "pass/sprite-list.wgsl";
    CROSSING = "lib/crossing.wgsl";
    SOLID = "lib/solid.wgsl";
    MEMBERS = "lib/members.wgsl";
    FADING_MEMBERS = "lib/fading-members.wgsl";
    FADING_OUTLINE = "lib/fading-outline.wgsl";
    MEMBER_OUTLINE = "lib/member-outline.wgsl";
    SOLID_SPRITE = "lib/solid-sprite.wgsl";
    COMBINED = "lib/combined.wgsl";
    COMBINED_SECTION = "lib/combined-section.wgsl";
    COMBINED_SPRITE = "lib/combined-sprite.wgsl";
    COMBINED_PASS = "pass/combined-sprite.wgsl";
    OBJECTS = "lib/objects.wgsl";
    POINT = "lib/point.wgsl";
    LINE = "lib/line.wgsl";
    VEIL = "lib/veil.wgsl";
    EDGE = "lib/edge.wgsl";
    ONE_CITY = "lib/one-city.wgsl";
    CITIES = "lib/cities.wgsl";
    FRAGMENT = "lib/fragment.wgsl";
    CUT = "lib/cut.wgsl";
    OUTLINE = "lib/outline.wgsl";
    SILHOUETTE = "lib/silhouette.wgsl";
    GLASS = "lib/glass.wgsl";
    SHELL = "lib/shell.wgsl";
    SHELL_SIDES = "lib/shell-sides.wgsl";
    SHELL_SPRITE = "lib/shell-sprite.wgsl";
    HALO = "lib/halo.wgsl";
    FILTERED = "lib/filter.wgsl";
    GEOMETRY = "pass/geometry.wgsl";
    SHADOW = "pass/shadow.wgsl";
    SHADOW_CUT = "pass/shadow-cut.wgsl";
    SPRITE = "pass/sprite.wgsl";
    SHADE = "pass/shade.wgsl";
    LINES = "pass/lines.wgsl";
    NOTES = "lib/notes.wgsl";
    LAYERS = "pass/layers.wgsl";
    COMPOSITE = "pass/composite.wgsl";
    COUNT_LAYERS = "pass/count-layers.wgsl";
    SORT_LAYERS = "pass/sort-layers.wgsl";
    SHOWN = "pass/shown.wgsl";
    SLOTS = "lib/slots.wgsl";
    FORWARD = "lib/forward.wgsl";
    TAIL = "lib/tail.wgsl";
    CHANCE = "lib/chance.wgsl";
    TRANSLUCENT = "pass/translucent.wgsl";
    LINK_SLOTS = "pass/link-slots.wgsl";
    FILTER = "pass/filter.wgsl";
    RESOLVE = "pass/resolve.wgsl";
    NARROW = "pass/narrow.wgsl";
    DEFORM = "lib/deform.wgsl";
    REFINE = "pass/refine.wgsl";
    REGIONS = "pass/regions.wgsl";
    SECTIONS = "pass/sections.wgsl";
    FURNITURE = "pass/furniture.wgsl";
    FURNITURE_OVER = "pass/furniture-over.wgsl";
    BARE = "pass/bare.wgsl";
}

/// A module of the frame.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Module {
    /// The opaque geometry pass, and what is hidden in it.
    Geometry(Option<Program>),
    /// Depth from the sun, and what is hidden from it.
    Shadow(Option<Program>),
    /// The sides of a solid.
    Sprite,
    /// The depth sprite of a volume that has a closed form.
    StoredForm,
    /// That of a lens of several leaves, or of a solid, and what the leaves are.
    StoredLayers(Vec<VolumeTest>),
    /// Where rays go through the faces of its solids.
    SpriteList,
    /// The sides of a combination, and what its leaves are.
    CombinedSprite(Vec<VolumeTest>),
    /// Deferred shading, and what the lenses make of it.
    Shade(Program),
    /// Edges as lines, and what lenses make of them.
    Lines(Program),
    /// Lists of translucent layers, and what is translucent; whether the adapter can test depth before the shader runs.
    Layers(Program, bool),
    /// Translucent layers, one over the other, and what the lenses make of each.
    Composite(Program),
    /// How many layers the pixel has that has most.
    CountLayers,
    /// Long lists of layers in order.
    SortLayers,
    /// Layers that are the shown surface, in the targets of what is opaque.
    ShownLayers,
    /// The nearest layers in slots, and what is translucent; whether the adapter can test depth before the shader runs.
    Slots(Program, bool),
    /// Slots as lists.
    LinkSlots,
    /// Translucent fragments shaded where they are drawn.
    Forward(Forward),
    /// Regions as depths, and how they are told apart.
    Regions(Plan),
    /// Sections through closed shells, and what is hidden.
    Sections(Program),
    /// One direction of a neighbourhood filter: the number of its handler.
    Filter(u32),
    /// The mean of samples.
    Resolve,
    /// Lists of invokers narrowed to what tiles show.
    Narrow,
    /// What deformations meet, refined and moved, and what they do.
    Refine(DeformPlan),
    /// Titles, captions and legends.
    Furniture,
    /// Furniture over a transparent picture.
    FurnitureOver,
    /// The bare lit draw that benchmarks compare with.
    Bare,
}

impl Module {
    /// A name for people and statistics.
    pub fn name(&self) -> String {
        match self {
            Self::Geometry(Some(program)) if program.regions().is_some() => "geometry of a region".to_owned(),
            Self::Geometry(hidden) => format!("geometry{}", hidden_name(hidden)),
            Self::Shadow(hidden) => format!("shadow{}", hidden_name(hidden)),
            Self::Sprite => "sprite".to_owned(),
            Self::StoredForm => "stored sprite".to_owned(),
            Self::StoredLayers(_) => "stored sprite in layers".to_owned(),
            Self::SpriteList => "crossings of a sprite".to_owned(),
            Self::CombinedSprite(_) => "sprite of a combination".to_owned(),
            Self::Shade(program) => {
                let names = names_of(program);
                let names = if names.is_empty() { names } else { format!(" ({names})") };
                let branches = if program.regions().is_some() { " in branches" } else { "" };
                let uber = if matches!(program, Program::Uber(_)) { " uber" } else { "" };
                let lenses = if program.has().lenses { " lenses" } else { "" };
                format!("shade{uber}{branches}{names}{lenses}")
            }
            Self::Lines(program) => {
                let uber = if matches!(program, Program::Uber(_)) { " uber" } else { "" };
                format!("lines{uber} ({})", names_of(program))
            }
            Self::Layers(program, _) => format!("layers{}", hidden_name(&Some(program.clone()))),
            Self::Composite(program) => {
                let uber = if matches!(program, Program::Uber(_)) { " uber" } else { "" };
                format!("composite{uber} ({})", names_of(program))
            }
            Self::CountLayers => "count layers".to_owned(),
            Self::SortLayers => "sort layers".to_owned(),
            Self::ShownLayers => "shown layers".to_owned(),
            Self::Slots(program, _) => format!("slots{}", hidden_name(&Some(program.clone()))),
            Self::LinkSlots => "link slots".to_owned(),
            Self::Forward(own) => own.name(),
            Self::Regions(_) => "regions".to_owned(),
            Self::Sections(program) => format!("sections{}", hidden_name(&Some(program.clone()))),
            Self::Filter(effect) => format!("filter {}", handlers()[*effect as usize].name),
            Self::Resolve => "resolve".to_owned(),
            Self::Narrow => "narrow".to_owned(),
            Self::Refine(_) => "refine".to_owned(),
            Self::Furniture => "furniture".to_owned(),
            Self::FurnitureOver => "furniture over".to_owned(),
            Self::Bare => "bare".to_owned(),
        }
    }

    /// The whole WGSL text.
    pub fn source(&self) -> String {
        self.source_with(handlers())
    }

    /// The whole WGSL text, where a program's numbers count these handlers.
    pub fn source_with(&self, handlers: &[EffectDefinition]) -> String {
        self.source_for_people(handlers, &[], LEAST_CARRIED)
    }

    /// The whole WGSL text with the names of a plan's lenses in comments (H4), for an adapter that carries so many vectors
    /// from vertices to fragments: [`LEAST_CARRIED`] or more.
    pub fn source_for_people(&self, handlers: &[EffectDefinition], lenses: &[&str], room: u32) -> String {
        let files: &[(&str, &str)] = match self {
            Self::Geometry(None) => &[VIEW, VIEW_UNIFORM, SURFACE, ONE_CITY, GEOMETRY],
            Self::Geometry(Some(program)) => &[
                &[VIEW, VIEW_UNIFORM, SURFACE, SIGHT],
                &lens_files(program)[..],
                &[OBJECTS, FRAGMENT, city_file(program), CUT, GEOMETRY],
            ]
            .concat(),
            Self::Shadow(None) => &[VIEW, VIEW_UNIFORM, SHADOW],
            Self::Shadow(Some(program)) => &[
                &[VIEW, VIEW_UNIFORM, SURFACE, SIGHT],
                &lens_files(program)[..],
                &[OBJECTS, FRAGMENT, city_file(program), SHADOW_CUT],
            ]
            .concat(),
            Self::Sprite => &[VIEW, VIEW_UNIFORM, SHAPE, SPRITE],
            Self::StoredForm => &[VIEW, SHAPE, DEPTH_CODE, STORED_PASS, STORED_FORM],
            Self::StoredLayers(_) => {
                &[VIEW, SIGHT, CLASS, SHAPE, SOLID, COMBINED, DEPTH_CODE, CROSSING, STORED_PASS, STORED_LAYERS]
            }
            Self::SpriteList => &[VIEW, SHAPE, CROSSING, SPRITE_LIST],
            Self::CombinedSprite(_) => {
                &[VIEW, VIEW_UNIFORM, SIGHT, CLASS, SHAPE, SOLID, COMBINED, SPRITE, COMBINED_PASS]
            }
            Self::Shade(program) => &Self::files_of_shade(program, handlers),
            Self::Lines(program) => &Self::files_of_lines(program),
            Self::Regions(plan) => &[
                &[VIEW, VIEW_UNIFORM, SIGHT],
                &lens_files(&Program::Specialised(plan.clone()))[..],
                &[SURFACE, OBJECTS, REGIONS],
            ]
            .concat(),
            Self::Sections(program) => &[
                &[VIEW, VIEW_UNIFORM, SURFACE, SIGHT],
                &lens_files(program)[..],
                &span_files(program)[..],
                program.has().combinations.then_some(COMBINED_SECTION).as_slice(),
                &[OBJECTS, FRAGMENT, city_file(program), SECTIONS],
            ]
            .concat(),
            Self::Layers(program, _) => &[
                &[VIEW, VIEW_UNIFORM, SURFACE, PACKED, SIGHT],
                &lens_files(program)[..],
                &[OBJECTS, FRAGMENT, city_file(program), GEOMETRY, NOTES, LAYERS],
            ]
            .concat(),
            Self::Composite(program) => &[&Self::files_of_shade(program, handlers)[..], &[NOTES, COMPOSITE]].concat(),
            Self::CountLayers => &[NOTES, COUNT_LAYERS],
            Self::SortLayers => &[NOTES, SORT_LAYERS],
            Self::ShownLayers => &[SHOWN],
            Self::Slots(program, _) => &[
                &[VIEW, VIEW_UNIFORM, SURFACE, PACKED, SIGHT],
                &lens_files(program)[..],
                &[OBJECTS, FRAGMENT, city_file(program), GEOMETRY, NOTES, SLOTS, TRANSLUCENT],
            ]
            .concat(),
            Self::LinkSlots => &[NOTES, LINK_SLOTS],
            Self::Forward(own) => return own.source(handlers, lenses),
            Self::Filter(_) => &[PACKED, FILTER],
            Self::Resolve => &[RESOLVE],
            Self::Narrow => &[VIEW, VIEW_UNIFORM, NARROW],
            Self::Refine(_) => &[SURFACE, DEFORM, REFINE],
            Self::Furniture => &[FURNITURE],
            Self::FurnitureOver => &[FURNITURE_OVER],
            Self::Bare => &[VIEW, VIEW_UNIFORM, SURFACE, BARE],
        };
        let mut text = String::new();
        // A fragment knows the threshold of its pixel.
        let threshold = (files.contains(&FRAGMENT) && !files.contains(&DITHER)).then_some(&DITHER);
        for (path, source) in files.iter().chain(threshold) {
            text.push_str(&format!("// ==== {path}\n\n{source}\n"));
        }
        if let Self::CombinedSprite(kinds) | Self::StoredLayers(kinds) = self {
            text.push_str(&lens_test::leaves(kinds));
        }
        match self {
            Self::Shade(program) | Self::Composite(program) => {
                let (own, of_scene) = match program {
                    Program::Specialised(plan) => {
                        (carried::of_plan(plan, handlers, room), specialised::source(plan, handlers, lenses, true))
                    }
                    Program::Uber(uber) => (carried::nothing(), uber::source(uber, handlers)),
                };
                let text =
                    text.replace("//@carried\n", &own.members).replace("//@handlers\n", &(own.functions + &of_scene));
                if matches!(self, Self::Shade(_)) {
                    return text;
                }
                let text = sorting::written_out(&text);
                let opacity = match program {
                    Program::Specialised(plan) => specialised::opacity(plan, handlers),
                    Program::Uber(uber) => uber::opacity(uber, handlers),
                };
                // Its pixels are no other shader's, whatever is opaque behind them.
                text.replace("//@opacity\n", &opacity).replace(specialised::ONLY_SHOWN, "")
            }
            Self::Layers(program, is_early) | Self::Slots(program, is_early) => {
                let own = hiding::source(program, handlers, lenses, hiding::Eye::Layers) + NOTHING_CUT;
                let (early, behind) = if *is_early { (EARLY, "") } else { ("", BEHIND) };
                // Slots are of a pass that has something to return.
                let leave = if matches!(self, Self::Slots(..)) { "discard;" } else { "return;" };
                let behind = behind.replace("return;", leave);
                text.replace("//@handlers\n", &own).replace(" //@early", early).replace("    //@behind\n", &behind)
            }
            Self::Lines(program) => text.replace("//@handlers\n", &lining::source(program, handlers, lenses)),
            Self::Refine(plan) => text.replace("//@deformers\n", &plan.shown()).replace("//@traced\n", &plan.traced()),
            Self::Geometry(None) => text.replace("//@handlers\n", NOTHING_CUT),
            Self::Geometry(Some(program)) => {
                let text = if program.regions().is_some() { regions::geometry(&text) } else { text };
                text.replace("//@handlers\n", &hiding::source(program, handlers, lenses, hiding::Eye::Picture))
            }
            Self::Sections(program) => text.replace("//@handlers\n", &sections::source(program, handlers, lenses)),
            Self::Regions(plan) => {
                let own = plan.regions.as_ref().map(|regions| regions::marks(plan, regions, lenses));
                text.replace("//@handlers\n", &own.unwrap_or_default())
            }
            Self::Shadow(Some(program)) => {
                text.replace("//@handlers\n", &hiding::source(program, handlers, lenses, hiding::Eye::Sun))
            }
            Self::Filter(effect) => {
                let filter = &handlers[*effect as usize];
                let own = carried::of_filter(filter);
                text.replace("//@carried\n", &own.members)
                    .replace("//@handlers\n", &(own.functions + &specialised::kernel(filter)))
            }
            _ => text,
        }
    }

    /// The libraries that lines call.
    fn files_of_lines(program: &Program) -> Vec<(&'static str, &'static str)> {
        let cities = city_file(program);
        let mut files = vec![VIEW, VIEW_UNIFORM, SURFACE, COLOR, LIGHT, OBJECTS, POINT, SIGHT, FRAGMENT, cities, EDGE];
        if program.has().blends {
            files.push(BLEND);
        }
        files.extend(lens_files(program));
        files.push(LINES);
        files
    }

    /// The libraries that shading calls, and no other.
    fn files_of_shade(program: &Program, handlers: &[EffectDefinition]) -> Vec<(&'static str, &'static str)> {
        let parts = program.has();
        let has = |kind| program.effects().iter().any(|&e| handlers[e as usize].kind == kind);
        let (materials, filters) = (has(EffectKind::Material), has(EffectKind::Filter));
        let mut files = vec![VIEW, SURFACE, COLOR, PACKED, LIGHT, OBJECTS, POINT, SIGHT];
        files.extend(lens_files(program));
        let optional = [
            (parts.blends || materials, BLEND),
            (materials, MATERIAL),
            (parts.bodies, OUTLINE),
            (parts.bodies && parts.members, MEMBER_OUTLINE),
            (parts.bodies && parts.fading_members, FADING_OUTLINE),
            (parts.shells, GLASS),
            (filters, FILTERED),
            (parts.lines, LINE),
            (parts.veils, VEIL),
        ];
        files.extend(if parts.shells { span_files(program) } else { Vec::new() });
        files.extend(optional.iter().filter(|(is_used, _)| *is_used).map(|(_, file)| *file));
        files.push(SHADE);
        files
    }
}

/// Where vertices stand: of the scene's own city, or also of contents.
fn city_file(program: &Program) -> (&'static str, &'static str) {
    if program.has().contents { CITIES } else { ONE_CITY }
}

/// The libraries of the lens tests that a program makes.
fn lens_files(program: &Program) -> Vec<(&'static str, &'static str)> {
    let parts = program.has();
    let files = [
        (parts.lenses, CLASS),
        (parts.lenses, SHAPE),
        (parts.shapes, LENS),
        (parts.sprites || parts.own_sprites || parts.side_sprites, LENS_SPRITE),
        (parts.sprites || parts.own_sprites, DEPTH_CODE),
        (parts.sprites || parts.own_sprites, STORED_SPRITE),
        (parts.own_sprites, OWN_SPRITE),
        (parts.members, MEMBERS),
        (parts.borders || parts.fading, DITHER),
        (parts.fading, FADING_MEMBERS),
        (parts.solids, SOLID),
        (parts.side_sprites, SOLID_SPRITE),
        (parts.combinations, COMBINED),
        (parts.combined_sprites, COMBINED_SPRITE),
        (parts.borders, BORDER),
        (parts.by_ray && parts.side_sprites, SHELL_SIDES),
        (parts.by_ray && parts.sprites, SHELL_SPRITE),
        (parts.distances, DISTANCE),
        (parts.distances && parts.solids, SOLID_DISTANCE),
        (parts.distances && parts.combinations, COMBINED_DISTANCE),
    ];
    files.into_iter().filter(|(is_used, _)| *is_used).map(|(_, file)| file).collect()
}

/// The libraries that tell from sprites where a ray is inside.
fn span_files(program: &Program) -> Vec<(&'static str, &'static str)> {
    let parts = program.has();
    // With borders along rays they are there already.
    let is_new = !parts.by_ray;
    let files = [(parts.side_sprites && is_new, SHELL_SIDES), (parts.sprites && is_new, SHELL_SPRITE)];
    files.into_iter().filter(|(is_used, _)| *is_used).map(|(_, file)| file).collect()
}

/// Where nothing is hidden.
const NOTHING_CUT: &str = "fn cut(at: vec2f, depth: f32, code: u32) {}\n";

/// Where the depth test comes before the shader.
const EARLY: &str = " @early_depth_test(force)";

/// Where it may come after, when the note is taken already.
const BEHIND: &str = "    if textureLoad(opaque_depth, vec2i(in.clip.xy), 0) >= in.clip.z {\n        return;\n    }\n";

fn names_of(program: &Program) -> String {
    let names: Vec<&str> = program.effects().iter().map(|&e| handlers()[e as usize].name.as_str()).collect();
    names.join(", ")
}

fn hidden_name(hidden: &Option<Program>) -> String {
    match hidden {
        None => String::new(),
        Some(program) => {
            let uber = if matches!(program, Program::Uber(_)) { " uber" } else { "" };
            let contents = program.has().contents.then_some("contents".to_owned());
            let effects = Some(names_of(program)).filter(|names| !names.is_empty());
            let what: Vec<String> = contents.into_iter().chain(effects).collect();
            format!(" cut{uber} ({})", what.join(", "))
        }
    }
}

#[cfg(test)]
mod tests;
