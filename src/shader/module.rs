//! The modules of a frame: which there are, and their texts.

use crate::{
    geom::shape::VolumeForm,
    shader::{
        adapter::Adapter,
        backend, carried,
        deforming::DeformPlan,
        effect::{definition::EffectDefinition, registry::handlers},
        files, followed,
        forms::{self, Forms},
        forward::Forward,
        geometry::{self, Drawn, NOTHING_CUT},
        hiding::{self, Eye},
        library::{
            AMBIENT_OCCLUSION, BARE, BENT_EDGES, BENT_RAYS, CLASS, COMBINED, COMBINED_PASS, COMPOSITE, COUNT_LAYERS,
            CROSSING, CUT, DEFORM, DEPTH_CODE, FACADE, FILTER, FORM, FRAGMENT_NODES, FURNITURE, FURNITURE_OVER, File,
            GEOMETRY, HELD, HELD_LAYERS, HOLE, LAYER_NODES, LAYERS, LINK_SLOTS, NARROW, OBJECTS, ONE_CITY, PACKED,
            RAY_GRID, RAY_IMAGES, RAY_LAYERS, RAY_VERTICES, RAY_WALK, RAY_WARP, RAYS, REFINE, REGION, REGIONS, RESOLVE,
            SHADE, SHADOW, SHADOW_CUT, SHOWN, SIGHT, SLOTS, SORT_LAYERS, SPRITE, SPRITE_LIST, STORED_FORM,
            STORED_LAYERS, STORED_PASS, SURFACE, TEXEL, TRANSLUCENT, VIEW, VIEW_UNIFORM,
        },
        lining,
        plan::{Bends, Plan, form::Form, lens_test::LensTest, program::Program},
        rays, regions, sections,
        shading::Shading,
        sorting, specialised,
        template::Template,
        translucent::{self, DepthTest, OPAQUE_DEPTH, behind_plane},
    },
};

/// A module of the frame.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Module {
    /// The opaque geometry pass, and what is hidden in it.
    Geometry(Option<Program>),
    /// Depth from the sun, and what is hidden from it.
    Shadow(Option<Program>),
    /// The sides of a solid.
    Sprite,
    /// The depth sprite of a volume of this closed form.
    StoredForm(VolumeForm),
    /// That of a lens of several leaves, or of a solid, and what the leaves are.
    StoredLayers(Vec<Form>),
    /// Where rays go through the faces of its solids.
    SpriteList,
    /// The sides of a combination, and what its leaves are.
    CombinedSprite(Vec<Form>),
    /// Bent rays, followed through the city, what is hidden, and how many lenses bend them.
    Rays(Option<Program>, Bends),
    /// What bent rays meet that were followed on the processor, what is hidden, and how many lenses bend them.
    TracedRays(Option<Program>, Bends),
    /// Images of what they meet.
    RayImages(Bends),
    /// Corners where lenses show them, what is hidden, and how many lenses bend rays.
    RayVertices(Option<Program>, Bends),
    /// Bent rays, looked up in images of what the eye sees, and how many lenses bend them.
    RayWarp(Bends),
    /// Deferred shading, and what the lenses make of it.
    Shade(Program),
    /// Edges as lines, and what lenses make of them.
    Lines(Program),
    /// Lists of translucent layers, and what is translucent; whether the adapter can test depth before the shader runs.
    Layers(Program, bool),
    /// Translucent layers, one over the other, and what the lenses make of each.
    Composite(Program),
    /// Translucent layers that bent rays meet, and what is translucent.
    RayLayers(Program),
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
    /// How much of the sky is seen, as far as the picture tells.
    AmbientOcclusion,
    /// The mean of samples.
    Resolve,
    /// Lists of invokers narrowed to what tiles show.
    Narrow,
    /// Meshes that deformations reach, refined and moved.
    Refine(DeformPlan),
    /// Titles, captions and legends.
    Furniture,
    /// Furniture over a transparent picture.
    FurnitureOver,
    /// The bare lit draw that benchmarks compare with.
    Bare,
}

impl Module {
    /// The whole WGSL text.
    pub fn source(&self) -> String {
        self.source_with(handlers())
    }

    /// The whole WGSL text, where a program's numbers count these handlers.
    pub fn source_with(&self, handlers: &[EffectDefinition]) -> String {
        self.source_for_people(handlers, &[], &Adapter::LEAST)
    }

    /// The whole WGSL text with the names of a plan's lenses in comments, for an adapter.
    pub fn source_for_people(&self, handlers: &[EffectDefinition], lenses: &[&str], adapter: &Adapter) -> String {
        let mut files = files::with_threshold(self.files(handlers));
        files.extend_from_slice(self.held(adapter));
        if self.bends().is_any() {
            files.push(BENT_RAYS);
            files.extend((self.bends().choosing > 0 && !files.contains(&OBJECTS)).then_some(OBJECTS));
            files.extend(matches!(self, Self::Lines(_) | Self::RayVertices(..)).then_some(BENT_EDGES));
            let shades = matches!(self, Self::Shade(_) | Self::Composite(_));
            files.extend((shades && self.bends().grids).then_some(RAY_GRID));
        }
        let text = Template::of_files(&files);
        let text = match files.contains(&VIEW) {
            true => {
                text.fill("ray", rays::source(self.bends(), self.carries_lens())).fill("snapping", adapter.snapping())
            }
            false => text,
        };
        let hidden = |program: &Program, eye| hiding::source(program, handlers, lenses, eye);
        let filled = match self {
            Self::CombinedSprite(leaves) | Self::StoredLayers(leaves) => {
                return text.text() + &Forms::of_leaves(leaves).functions();
            }
            Self::StoredForm(form) => return text.text() + &forms::of_stage(*form),
            Self::Sprite | Self::SpriteList => return text.text() + &forms::numbers_of(VolumeForm::Solid),
            Self::Forward(own) => return own.source(handlers, lenses, adapter),
            Self::Shade(program) => {
                let own = backend::shading(program, handlers, lenses, &Shading::of_surfaces(adapter.carried));
                text.fill("carried", own.members).fill("handlers", own.functions)
            }
            Self::Composite(program) => {
                let own = backend::shading(program, handlers, lenses, &Shading::of_layers(adapter.carried));
                let text = text.fill("carried", own.members).fill("handlers", own.functions);
                sorting::filled(text)
                    .fill("opacity", backend::opacity(program, handlers) + &backend::kept(program, handlers))
            }
            Self::Layers(program, is_early) => {
                let text = geometry::filled(text, Drawn::Surfaces, &(hidden(program, Eye::Layers) + NOTHING_CUT));
                let elsewhere = if program.has().bends.is_any() { followed::LEFT_OUT } else { "" };
                translucent::filled(
                    text.fill("elsewhere", elsewhere),
                    DepthTest::of_nodes(*is_early),
                    program.has().contents,
                    Some("opaque_depth"),
                    "return;",
                )
            }
            Self::Slots(program, is_early) => {
                let text = geometry::filled(text, Drawn::Surfaces, &(hidden(program, Eye::Layers) + NOTHING_CUT));
                // They are of a pass that has something to return.
                translucent::filled(
                    text,
                    DepthTest::of_nodes(*is_early),
                    program.has().contents,
                    Some("opaque_depth"),
                    "discard;",
                )
                .fill("opaque-depth", OPAQUE_DEPTH)
                .fill("behind-plane", behind_plane("opaque_depth"))
            }
            Self::Lines(program) => {
                let bent = if program.has().bends.is_any() { lining::BENT } else { "" };
                text.fill("handlers", lining::source(program, handlers, lenses)).fill("bent", bent)
            }
            Self::Refine(plan) => text.fill("deformers", plan.shown(handlers)).fill("traced", plan.traced(handlers)),
            Self::Geometry(None) => geometry::filled(text, Drawn::Surfaces, NOTHING_CUT),
            Self::Geometry(Some(program)) => {
                let drawn = if program.regions().is_some() { Drawn::Regions } else { Drawn::Surfaces };
                geometry::filled(text, drawn, &hidden(program, Eye::Picture))
            }
            Self::Sections(program) => text.fill("handlers", sections::source(program, handlers, lenses)),
            Self::Regions(plan) => {
                let own = plan.regions.as_ref().map(|regions| regions::marks(plan, regions, lenses));
                text.fill("handlers", own.unwrap_or_default())
            }
            Self::Rays(..)
            | Self::TracedRays(..)
            | Self::RayVertices(..)
            | Self::RayWarp(_)
            | Self::RayImages(_)
            | Self::RayLayers(_) => self.rays_filled(text, &hidden),
            Self::Shadow(Some(program)) => text.fill("handlers", hidden(program, Eye::Sun)),
            Self::Filter(effect) => {
                let filter = &handlers[*effect as usize];
                let own = carried::of_filter(filter);
                text.fill("carried", own.members).fill("handlers", own.functions + &specialised::kernel(filter))
            }
            _ => text,
        };
        filled.text()
    }

    /// The text of a module of bent rays; `hidden`: what is hidden from an eye.
    fn rays_filled<'a>(&self, text: Template<'a>, hidden: &dyn Fn(&Program, Eye) -> String) -> Template<'a> {
        match self {
            Self::Rays(program, _) | Self::TracedRays(program, _) | Self::RayVertices(program, _) => {
                let asked = program.as_ref().map(|p| (hidden(p, Eye::Rays), p.has().has_cities()));
                let followed = text
                    .fill("handlers", followed::source(asked))
                    .fill("met", followed::FIRST)
                    .fill("bindings", followed::LAST_GROUP);
                match self {
                    Self::Rays(..) => followed.fill("found", followed::FOLLOWED),
                    Self::TracedRays(..) => followed.fill("found", followed::traced(program.is_some())),
                    _ => followed,
                }
            }
            Self::RayWarp(bends) => {
                const FIRST: u32 = 5;
                let own = carried::of_lens(*bends, FIRST);
                text.fill("carried", own.members).fill("handlers", own.functions)
            }
            Self::RayImages(_) => text
                .fill("handlers", followed::source(None))
                .fill("met", followed::FIRST)
                .fill("bindings", followed::FIRST_GROUP),
            Self::RayLayers(program) => {
                let (hidden, has_cities) = (hidden(program, Eye::RayLayers), program.has().has_cities());
                let handlers = hidden + followed::cities(has_cities);
                text.fill("handlers", handlers)
                    .fill("met", followed::ALL)
                    .fill("bindings", followed::LAST_GROUP)
                    .leave("elsewhere")
            }
            _ => text,
        }
    }

    /// Whether its rays are those that lenses bend.
    fn bends(&self) -> Bends {
        match self {
            Self::Shade(program)
            | Self::Composite(program)
            | Self::Layers(program, _)
            | Self::RayLayers(program)
            | Self::Lines(program) => program.has().bends,
            Self::Rays(_, bends)
            | Self::TracedRays(_, bends)
            | Self::RayVertices(_, bends)
            | Self::RayImages(bends)
            | Self::RayWarp(bends) => *bends,
            _ => Bends::default(),
        }
    }

    /// Whether the only lens that bends rays is carried to fragments.
    fn carries_lens(&self) -> bool {
        matches!(self, Self::Shade(_) | Self::Composite(_) | Self::RayWarp(_))
    }

    /// What it has besides where triangles hold their depth.
    fn held(&self, adapter: &Adapter) -> &'static [File] {
        match self {
            Self::Geometry(_) if adapter.holds_depth => &[HELD],
            Self::Layers(..) if adapter.holds_depth => &[HELD, HELD_LAYERS],
            _ => &[],
        }
    }

    /// The files it is made of, in order.
    fn files(&self, handlers: &[EffectDefinition]) -> Vec<File> {
        let of: &[File] = match self {
            Self::Geometry(None) => &[VIEW, VIEW_UNIFORM, SURFACE, ONE_CITY, FACADE, GEOMETRY],
            Self::RayImages(_) => &[VIEW, VIEW_UNIFORM, SURFACE, ONE_CITY, FACADE, RAY_WALK, RAY_IMAGES],
            Self::RayWarp(_) => &[VIEW, VIEW_UNIFORM, SURFACE, RAY_WARP],
            Self::RayVertices(None, _) => &[VIEW, VIEW_UNIFORM, SURFACE, ONE_CITY, FACADE, RAY_WALK, RAY_VERTICES],
            Self::RayVertices(Some(program), _) => {
                return files::of_city(program, &[FACADE, RAY_WALK, RAY_VERTICES]);
            }
            Self::Rays(None, _) | Self::TracedRays(None, _) => {
                &[VIEW, VIEW_UNIFORM, SURFACE, ONE_CITY, FACADE, RAY_WALK, RAYS]
            }
            Self::Rays(Some(program), _) | Self::TracedRays(Some(program), _) => {
                return files::of_city(program, &[FACADE, RAY_WALK, RAYS]);
            }
            Self::Geometry(Some(program)) => return files::of_city(program, &[CUT, FACADE, GEOMETRY]),
            Self::Shadow(None) => &[VIEW, VIEW_UNIFORM, SURFACE, HOLE, SHADOW],
            Self::Shadow(Some(program)) => return files::of_city(program, &[HOLE, SHADOW_CUT]),
            Self::Sprite => &[VIEW, VIEW_UNIFORM, REGION, SPRITE],
            Self::StoredForm(form) => {
                let form = Forms { tests: vec![LensTest::volume(*form)], ..Forms::default() }.files();
                return [&[VIEW, SIGHT, REGION, FORM], &form[..], &[DEPTH_CODE, STORED_PASS, STORED_FORM]].concat();
            }
            Self::StoredLayers(leaves) => {
                let forms = Forms::of_leaves(leaves).files();
                let stored = [COMBINED, DEPTH_CODE, CROSSING, STORED_PASS, STORED_LAYERS];
                return [&[VIEW, SIGHT, CLASS, REGION, FORM], &forms[..], &stored].concat();
            }
            Self::SpriteList => &[VIEW, REGION, CROSSING, SPRITE_LIST],
            Self::CombinedSprite(leaves) => {
                let forms = Forms::of_leaves(leaves).files();
                return [
                    &[VIEW, VIEW_UNIFORM, SIGHT, CLASS, REGION, FORM],
                    &forms[..],
                    &[COMBINED, SPRITE, COMBINED_PASS],
                ]
                .concat();
            }
            Self::Shade(program) => return [files::of_shading(program, handlers), vec![SHADE]].concat(),
            Self::Composite(program) => {
                let own = vec![SHADE, TEXEL, FRAGMENT_NODES, COMPOSITE];
                return [files::of_shading(program, handlers), files::of_fields(program), own].concat();
            }
            Self::Lines(program) => return files::of_lines(program),
            Self::Regions(plan) => {
                let lenses = files::of_lenses(&Program::Specialised(plan.clone()));
                return [&[VIEW, VIEW_UNIFORM, SIGHT], &lenses[..], &[SURFACE, OBJECTS, REGIONS]].concat();
            }
            Self::Sections(program) => return files::of_sections(program),
            Self::Layers(program, _) => {
                return files::of_translucent_city(program, &[FACADE, GEOMETRY, FRAGMENT_NODES, LAYER_NODES, LAYERS]);
            }
            Self::RayLayers(program) => {
                let own = [FACADE, FRAGMENT_NODES, LAYER_NODES, RAY_WALK, RAY_LAYERS];
                return files::of_translucent_city(program, &own);
            }
            Self::Slots(program, _) => {
                return files::of_translucent_city(program, &[FACADE, GEOMETRY, FRAGMENT_NODES, SLOTS, TRANSLUCENT]);
            }
            Self::CountLayers => &[FRAGMENT_NODES, COUNT_LAYERS],
            Self::SortLayers => &[FRAGMENT_NODES, SORT_LAYERS],
            Self::ShownLayers => &[SHOWN],
            Self::LinkSlots => &[FRAGMENT_NODES, LINK_SLOTS],
            // Two texts, merged.
            Self::Forward(_) => &[],
            Self::Filter(_) => &[PACKED, FILTER],
            Self::AmbientOcclusion => &[VIEW, VIEW_UNIFORM, SURFACE, AMBIENT_OCCLUSION],
            Self::Resolve => &[RESOLVE],
            Self::Narrow => &[VIEW, VIEW_UNIFORM, NARROW],
            Self::Refine(_) => &[SURFACE, DEFORM, REFINE],
            Self::Furniture => &[FURNITURE],
            Self::FurnitureOver => &[FURNITURE_OVER],
            Self::Bare => &[VIEW, VIEW_UNIFORM, SURFACE, BARE],
        };
        of.to_vec()
    }
}
