//! WGSL text: which files make which module, and the parts that are put together from the scene.
//!
//! No wgpu handle lives here. Entry points stand in `shaders/pass` alone; everything else is importable
//! and free of side effects.

mod carried;
mod contents;
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
mod tests {
    use super::*;

    fn step(effect: u32, scope: Scope, blend: Option<Blend>) -> Step {
        Step { effect, scope, parameters: 0, blend }
    }

    /// All that a combination may be made of.
    const LEAVES: [VolumeTest; 9] = [
        VolumeTest::Sphere,
        VolumeTest::Box,
        VolumeTest::Cylinder,
        VolumeTest::Convex,
        VolumeTest::Ellipsoid,
        VolumeTest::Frustum,
        VolumeTest::Solid,
        VolumeTest::Members,
        VolumeTest::FadingMembers,
    ];

    /// As the sun asks: no sprite tells it anything.
    fn by_shapes(mut program: Program) -> Program {
        let by_shape = |test: &mut VolumeTest| match test {
            VolumeTest::Sprite | VolumeTest::LayeredSprite => *test = VolumeTest::Sphere,
            VolumeTest::SolidSprite => *test = VolumeTest::Solid,
            VolumeTest::CombinedSprite => *test = VolumeTest::Combined,
            _ => {}
        };
        match &mut program {
            Program::Specialised(plan) => {
                plan.lenses.iter_mut().flat_map(|l| &mut l.volumes).for_each(by_shape);
                *plan = plan.clone().without_borders();
            }
            Program::Uber(uber) => {
                uber.borders = false;
                uber.by_ray = false;
                uber.tests.iter_mut().for_each(by_shape);
                uber.tests.sort_unstable();
                uber.tests.dedup();
            }
        }
        program
    }

    /// The numbers of all effects.
    fn numbers() -> Vec<u32> {
        let is_effect = |(_, h): &(usize, &EffectDefinition)| h.mode == Mode::Local;
        handlers().iter().enumerate().filter(is_effect).map(|(i, _)| i as u32).collect()
    }

    /// What the two lenses show: nothing, or all ways to clip.
    fn contents_of(seed: usize) -> Vec<PlanContent> {
        let content = |i: usize| PlanContent {
            lens: i as u32,
            class: ClassTest::ALL[(seed + i) % 4],
            city: (i + seed % 30) as u32 + 1,
            clip: Clip::ALL[(seed / 2 + i) % 3],
            keeps_terrain: (seed + i).is_multiple_of(4),
        };
        (0..if seed.is_multiple_of(2) { 0 } else { 2 }).map(content).collect()
    }

    /// A scene of the context and two lenses whose steps are these effects, in order; `seed` chooses classes, blends,
    /// bodies and masks. The modules that both back ends need for it.
    fn modules(effects: &[u32], seed: usize) -> Vec<Module> {
        let scopes: Vec<Scope> = std::iter::once(Scope::Everywhere)
            .chain(ClassTest::ALL.into_iter().flat_map(|c| [Scope::Lens(0, c), Scope::Lens(1, c)]))
            .collect();
        let mut steps = Vec::new();
        for (i, &effect) in effects.iter().enumerate() {
            let blend = (i + seed).is_multiple_of(3).then(|| Blend::ALL[(i + seed) % 6]);
            steps.push(step(effect, scopes[(seed + 4 * i) % scopes.len()], blend));
        }
        let lens = |number, volumes: &[usize], body| PlanLens {
            number,
            volumes: volumes.iter().map(|v| VolumeTest::ALL[(seed + v) % VolumeTest::ALL.len()]).collect(),
            leaves: LEAVES[seed % 8..].to_vec(),
            body,
            border: seed.is_multiple_of(5).then_some(PlanBorder {
                parameters: 5,
                dithers: seed.is_multiple_of(2),
                by_ray: seed.is_multiple_of(3),
            }),
        };
        let kind = [BodyKind::Outline, BodyKind::Shell, BodyKind::Halo][seed / 2 % 3];
        let body = seed.is_multiple_of(2).then_some(PlanBody { kind, parameters: 3 });
        let plan = Plan {
            lenses: vec![lens(0, &[0], None), lens(40, &[1, 2], body)],
            lines: effects.iter().any(|&e| handlers()[e as usize].lines),
            steps,
            haze: seed.is_multiple_of(5),
            masks: seed.is_multiple_of(7),
            contents: contents_of(seed),
            ..Plan::default()
        };
        let uber = Uber {
            effects: plan.effects(),
            tests: {
                let mut tests: Vec<VolumeTest> = plan.tests().collect();
                tests.sort_unstable();
                tests
            },
            leaves: LEAVES[seed % 8..].to_vec(),
            bodies: plan.bodies(),
            sides: !seed.is_multiple_of(3),
            borders: plan.has_borders(),
            by_ray: plan.has_borders() && seed.is_multiple_of(3),
            dithers: plan.has_borders(),
            blends: plan.has_blends(),
            haze: plan.haze,
            masks: plan.masks,
            lines: plan.lines,
            veils: false,
            contents: !plan.contents.is_empty(),
        };
        let hiding = plan.hiding(handlers()).map(Program::Specialised).into_iter();
        let hiding = hiding.chain(uber.hiding(handlers()).map(Program::Uber));
        let has_lenses = |p: &Program| p.has().lenses;
        let lining = plan.lining(handlers()).map(Program::Specialised).into_iter();
        let lining = lining.chain(uber.lining(handlers()).map(Program::Uber));
        let mut modules: Vec<Module> = hiding
            .clone()
            .flat_map(|p| {
                let layers =
                    [false, true].map(|early| [Module::Layers(p.clone(), early), Module::Slots(p.clone(), early)]);
                [Module::Geometry(Some(p.clone())), Module::Shadow(Some(by_shapes(p)))]
                    .into_iter()
                    .chain(layers.into_iter().flatten())
            })
            .collect();
        let layering = [
            plan.layering(handlers()).map(Program::Specialised).zip(plan.hiding(handlers()).map(Program::Specialised)),
            uber.layering(handlers()).map(Program::Uber).zip(uber.hiding(handlers()).map(Program::Uber)),
        ];
        for (shading, hidden) in layering.into_iter().flatten() {
            modules.push(Module::Composite(shading.clone()));
            let kinds = [ForwardKind::Tail, ForwardKind::Chance(false), ForwardKind::Chance(true)];
            modules.extend(kinds.map(|kind| {
                let (hidden, shading) = (hidden.clone(), shading.clone());
                Module::Forward(Forward { kind, hidden, shading })
            }));
        }
        modules.extend(hiding.filter(has_lenses).map(Module::Sections));
        modules.extend(lining.map(Module::Lines));
        modules.push(Module::Shade(Program::Specialised(plan.shading(handlers()))));
        modules.push(Module::Shade(Program::Uber(uber.shading(handlers()))));
        modules
    }

    fn all_modules() -> Vec<Module> {
        let plain = [Program::Specialised(Plan::default()), Program::Uber(Uber::default())];
        let mut modules = vec![
            Module::Geometry(None),
            Module::Shadow(None),
            Module::Sprite,
            Module::StoredForm,
            Module::Resolve,
            Module::Narrow,
            Module::Bare,
        ];
        modules.extend(plain.map(Module::Shade));
        modules.push(Module::SpriteList);
        modules.extend(LEAVES[..7].iter().map(|kind| Module::StoredLayers(vec![*kind])));
        modules.push(Module::StoredLayers(LEAVES[..7].to_vec()));
        modules.push(Module::CombinedSprite(LEAVES.to_vec()));
        modules.extend(LEAVES.map(|kind| Module::CombinedSprite(vec![kind])));
        let is_filter = |e: &u32| handlers()[*e as usize].kind == EffectKind::Filter;
        modules.extend(numbers().into_iter().filter(is_filter).map(Module::Filter));
        modules.extend([Module::Furniture, Module::FurnitureOver]);
        modules.extend([Module::CountLayers, Module::SortLayers, Module::ShownLayers, Module::LinkSlots]);
        modules
    }

    #[test]
    fn contents_alone_make_modules_that_are_valid() {
        let lens =
            |number| PlanLens { number, volumes: vec![VolumeTest::Sphere], leaves: vec![], body: None, border: None };
        for contents in [contents_of(1), contents_of(3), contents_of(5)] {
            let plan = Plan { lenses: vec![lens(0), lens(1)], contents, ..Plan::default() };
            let uber = Uber { tests: vec![VolumeTest::Sphere], contents: true, ..Uber::default() };
            let hiding = [
                Program::Specialised(plan.hiding(handlers()).expect("something is clipped")),
                Program::Uber(uber.hiding(handlers()).expect("something may be clipped")),
            ];
            for program in hiding {
                validate(&Module::Geometry(Some(program.clone())));
                validate(&Module::Shadow(Some(program)));
            }
            assert!(plan.shading(handlers()).contents.is_empty(), "shading asks what is there, not why");
        }
    }

    fn validate(module: &Module) {
        validate_text(&module.name(), &module.source());
    }

    fn validate_text(name: &str, source: &str) {
        let parsed = match wgpu::naga::front::wgsl::parse_str(source) {
            Ok(parsed) => parsed,
            Err(error) => panic!("{name}: {}", error.emit_to_string(source)),
        };
        let mut validator = wgpu::naga::valid::Validator::new(
            wgpu::naga::valid::ValidationFlags::all(),
            wgpu::naga::valid::Capabilities::default()
                | wgpu::naga::valid::Capabilities::SHADER_FLOAT16_IN_FLOAT32
                | wgpu::naga::valid::Capabilities::EARLY_DEPTH_TEST,
        );
        if let Err(error) = validator.validate(&parsed) {
            panic!("{name}: {}", error.emit_to_string(source));
        }
    }

    fn validate_all(lists: &[Vec<u32>]) {
        use rayon::prelude::*;
        lists.par_iter().enumerate().for_each(|(seed, list)| {
            modules(list, seed).iter().for_each(validate);
        });
    }

    #[test]
    fn regions_of_all_kinds_are_told_apart_by_valid_wgsl() {
        let [sepia, gloss, cel] = ["sepia", "gloss", "cel"].map(|name| effect::number_of(name).expect("there is one"));
        for (seed, test) in VolumeTest::ALL.into_iter().enumerate() {
            let lens =
                |number| PlanLens { number, volumes: vec![test], leaves: LEAVES.to_vec(), body: None, border: None };
            let steps = vec![
                step(sepia, Scope::Everywhere, None),
                step(cel, Scope::Lens(0, ClassTest::Inside), None),
                step(gloss, Scope::Lens(1, ClassTest::ALL[seed % 4]), None),
                step(sepia, Scope::Lens(1, ClassTest::ALL[(seed + 1) % 4]), Some(Blend::Multiply)),
            ];
            let plan = Plan { lenses: vec![lens(0), lens(1)], steps, haze: seed % 2 == 0, ..Plan::default() };
            for regions in [Regions::combinations(&plan), Regions::passes(&plan)] {
                let plan = Plan { regions: Some(regions.clone()), ..plan.clone() };
                validate(&Module::Geometry(Some(Program::Specialised(plan.clone()))));
                validate(&Module::Regions(plan.clone()));
                for region in 0..regions.count().expect("few") {
                    validate(&Module::Shade(Program::Specialised(plan.of_region(region))));
                }
            }
            let regions = Some(Regions::combinations(&plan));
            validate(&Module::Shade(Program::Specialised(Plan { regions, masks: seed % 3 == 0, ..plan })));
        }
    }

    #[test]
    fn what_finds_no_room_is_read_where_it_stands() {
        let lens = |number| PlanLens {
            number,
            volumes: VolumeTest::ALL.to_vec(),
            leaves: LEAVES.to_vec(),
            body: None,
            border: None,
        };
        let plan = Plan { lenses: (0..9).map(lens).collect(), ..Plan::default() };
        let module = Module::Shade(Program::Specialised(plan));
        for room in [14, LEAST_CARRIED, 31, 1000] {
            let source = module.source_for_people(handlers(), &[], room);
            validate_text(&module.name(), &source);
            let members = source.matches("@interpolate(flat, either)").count() as u32;
            let left = source.matches(" = shapes_uniform[").count();
            assert!(members <= room.max(14), "{members} vectors where {room} fit");
            assert_eq!(left > 0, room < 1000, "{left} are left with room for {room}");
        }
    }

    #[test]
    fn lens_tests_have_their_numbers_in_wgsl() {
        for test in VolumeTest::ALL {
            let line = format!("const {}: u32 = {}u;\n", test.constant(), test.number());
            assert!(SHAPE.1.contains(&line), "lib/shape.wgsl lacks {line}");
        }
    }

    #[test]
    fn every_module_is_valid_wgsl() {
        all_modules().iter().for_each(validate);
    }

    #[test]
    fn every_effect_of_the_context_is_valid_wgsl_without_a_lens() {
        for number in numbers() {
            let lines = handlers()[number as usize].lines;
            let plan = Plan { steps: vec![step(number, Scope::Everywhere, None)], lines, ..Plan::default() };
            let uber = Uber { effects: vec![number], lines, ..Uber::default() };
            let hiding = plan.hiding(handlers()).map(Program::Specialised).into_iter();
            for program in hiding.chain(uber.hiding(handlers()).map(Program::Uber)) {
                validate(&Module::Geometry(Some(program.clone())));
                validate(&Module::Shadow(Some(program)));
            }
            let lining = plan.lining(handlers()).map(Program::Specialised).into_iter();
            lining.chain(uber.lining(handlers()).map(Program::Uber)).for_each(|p| validate(&Module::Lines(p)));
            validate(&Module::Shade(Program::Specialised(plan.shading(handlers()))));
            validate(&Module::Shade(Program::Uber(uber.shading(handlers()))));
        }
    }

    #[test]
    fn every_effect_and_every_ordered_pair_is_valid_wgsl() {
        let all = numbers();
        let singles = all.iter().flat_map(|&a| vec![vec![a]; 9]);
        let pairs = all.iter().flat_map(|&a| all.iter().map(move |&b| vec![a, b]));
        validate_all(&singles.chain(pairs).collect::<Vec<_>>());
    }

    #[test]
    fn a_thousand_triples_of_effects_are_valid_wgsl() {
        let all = numbers();
        let mut state = 0x9e37_79b9_7f4a_7c15_u64;
        let mut next = || {
            // SplitMix64.
            state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
            let mixed = (state ^ (state >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
            all[((mixed ^ (mixed >> 31)) % all.len() as u64) as usize]
        };
        validate_all(&(0..1000).map(|_| vec![next(), next(), next()]).collect::<Vec<_>>());
    }

    #[test]
    #[ignore = "minutes; ./dev hard"]
    fn all_triples_of_effects_are_valid_wgsl() {
        let all = numbers();
        let pairs: Vec<(u32, u32)> = all.iter().flat_map(|&a| all.iter().map(move |&b| (a, b))).collect();
        validate_all(&pairs.iter().flat_map(|&(a, b)| all.iter().map(move |&c| vec![a, b, c])).collect::<Vec<_>>());
    }

    #[test]
    fn an_effect_nobody_uses_is_not_in_the_text() {
        let greyscale = effect::number_of("greyscale").expect("there is one");
        let plan = Plan { steps: vec![step(greyscale, Scope::Everywhere, None)], ..Plan::default() };
        let uber = Uber { effects: plan.effects(), ..Uber::default() };
        for program in [Program::Specialised(plan), Program::Uber(uber)] {
            let source = Module::Shade(program).source();
            assert!(source.contains("fn greyscale"));
            assert!(!source.contains("fn sepia") && !source.contains("fn thematic") && !source.contains("fn haze"));
            assert!(!source.contains("var sprites"), "a lens that is not there is in the shader");
            assert!(!source.contains("struct Material") && !source.contains("fn blend_add"), "{source}");
        }
    }
}
