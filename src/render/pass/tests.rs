//! The list of passes, and its economy: a plan holds just what a scene calls for. No device is needed.

use std::sync::Arc;

use glam::{DVec2, DVec3, dvec3};

use crate::{
    city::CityModel,
    geom::{Aabb, Shape},
    lens::{
        Class, EffectUse, Lens, LensKind, LensSprite,
        ray::{Bend, Magnify, RayLens, RayMethod},
        ray_path::{PictureFrame, RayPaths, Scenery},
    },
    render::{
        city::{Chunk, ObjectRun, SectionKind, Translucency},
        city_facts::{CityFacts, SectionFacts},
        eye::PictureTile,
        frame::{Backend, FrameInput},
        furniture::{self, Furniture},
        moved::Moved,
        operations::{Beside, LensTables, Operations, SceneTime},
        own_sprites::OwnSprites,
        pass::{Inputs, list},
        placed_region::{Leaf, PlacedRegion},
        plan::{Adapter, FramePlan, Stayed},
        settings::Settings,
        solids::SolidTable,
        volume::LensVolume,
    },
    scene::{Background, BaseStyle, Sun, Technique, Transparency},
    view::{Camera, View},
};

/// The lines of the list that the docs of the table print.
fn printed() -> String {
    let line = |(name, about): (&str, &str)| format!("//! {name:<24}{about}\n");
    list().into_iter().map(line).collect()
}

#[test]
fn the_docs_print_the_table() {
    let docs = include_str!("mod.rs");
    let shown = docs.split("//! ```text\n").nth(1).and_then(|rest| rest.split("//! ```\n").next());
    assert_eq!(shown, Some(printed().as_str()), "the list of passes is\n{}", printed());
}

/// What a scene asks for in these tests.
#[derive(Clone)]
struct Asked {
    /// An effect of the only lens, a ball in the middle of the city.
    effect: Option<&'static str>,
    class: Class,
    sprite: Option<LensSprite>,
    section: Option<[f32; 3]>,
    technique: Technique,
    transparency: Transparency,
    sun: Sun,
    samples: u32,
    masks: bool,
    measured: bool,
    screen_occlusion: bool,
    furniture: Furniture,
    rays: RayPaths,
}

impl Asked {
    /// A city without lenses, at night.
    fn nothing() -> Self {
        Self {
            effect: None,
            class: Class::Inside,
            sprite: None,
            section: None,
            technique: Technique::Accumulate,
            transparency: Transparency::Exact,
            sun: Sun { shadows: false, ..Sun::default() },
            samples: 1,
            masks: false,
            measured: false,
            screen_occlusion: false,
            furniture: furniture::NONE.clone(),
            rays: RayPaths::default(),
        }
    }

    fn effect(effect: &'static str) -> Self {
        Self { effect: Some(effect), ..Self::nothing() }
    }

    fn operations(&self) -> Operations {
        let mut lens = Lens::plain("lens", LensKind::default(), [1.0; 3]);
        lens.body = crate::lens::LensBody::None;
        lens.effects.extend(self.effect.map(|effect| EffectUse {
            effect: effect.to_owned(),
            class: self.class,
            blend: None,
            weight: None,
            parameters: Default::default(),
        }));
        let present = [self.effect.is_some()];
        let city = CityModel::default();
        let tests = Default::default();
        let beside = Beside { tables: &LensTables::default(), time: &SceneTime::default(), point_px: 1.0 };
        Operations::new(&[], &[lens], &present, tests, &[&city], &beside).expect("operations")
    }

    fn volumes(&self) -> Vec<LensVolume> {
        let ball = Shape::Sphere { center: DVec3::ZERO, radius: 20.0 };
        let body = PlacedRegion::One(Leaf::Volume(ball.volume().expect("a volume")).into());
        let ball = LensVolume { sprite: self.sprite, section: self.section, ..LensVolume::plain(0, body) };
        self.effect.map(|_| ball).into_iter().collect()
    }

    /// The names of the passes that its last sample takes, the first name of each.
    fn passes(&self) -> Vec<&'static str> {
        let (operations, volumes, solids) = (self.operations(), self.volumes(), Arc::new(SolidTable::default()));
        let camera = Camera::looking(dvec3(3.0, -90.0, 62.0), DVec3::ZERO, 0.9);
        let bounds = Aabb { min: DVec3::splat(-30.0), max: DVec3::splat(30.0) };
        let input = FrameInput {
            view: View::new(camera, [64, 48], &bounds).expect("a view"),
            tile: PictureTile::whole([64, 48]),
            sun: self.sun,
            base: BaseStyle::default(),
            look: crate::scene::StyleLook::default(),
            background: Background::Sky,
            technique: self.technique,
            transparency: self.transparency,
            transparent: false,
            haze: 0.0,
            volumes: &volumes,
            rays: &self.rays,
            fields: &Default::default(),
            lens_count: 1,
            solids: &solids,
            operations: &operations,
            backend: Backend::Specialised,
            measured: self.measured,
            shown: false,
            masks: self.masks,
            sample: if self.masks { 0 } else { self.samples - 1 },
            samples: self.samples,
            suns: &[],
            sun_of: [0, 1],
            screen_occlusion: self.screen_occlusion,
            moved: &Moved::default(),
            chord_px: 1.0,
            furniture: &self.furniture,
            most_triangles: None,
        };
        let chunks = [Chunk {
            range: 0..36,
            bounds,
            cell: 0,
            details: 1,
            translucency: Translucency::None,
            is_around: false,
            gives_way: false,
            runs: [ObjectRun { end: 36, object: 0 }].into(),
            has_run_ends: true,
        }];
        let sections = vec![SectionFacts { kind: SectionKind::Plain, is_smooth: false, is_read: false }];
        let facts = CityFacts {
            bounds,
            reach: bounds,
            fade: None,
            all: bounds,
            moved: Aabb::EMPTY,
            chunks: vec![&chunks],
            cells: &[],
            has_blocks: false,
            has_edges: true,
            has_smooth: false,
            emits: false,
            texels_emit: false,
            own_sections: sections.clone(),
            sections,
            contents: Vec::new(),
        };
        let mut own_sprites = OwnSprites::default();
        let stayed = Stayed { own_sprites: &mut own_sprites, sprite_bytes: 0, count_bytes: 0 };
        let plan = FramePlan::new(&input, &facts, Adapter::default(), Settings::new(false), stayed);
        let lines = Inputs::of(&plan).lines();
        lines.into_iter().map(|lines| lines[0].0).collect()
    }
}

#[test]
fn a_plan_holds_just_the_passes_that_a_scene_calls_for() {
    let plain = Asked::nothing();
    assert_eq!(plain.passes(), ["geometry", "shade"]);
    let shadows = Asked { sun: Sun::default(), ..plain.clone() };
    assert_eq!(shadows.passes(), ["shadow map", "geometry", "shade"]);
    let at_once = Asked { screen_occlusion: true, ..shadows.clone() };
    assert_eq!(at_once.passes(), ["shadow map", "geometry", "ambient occlusion", "shade"]);
    assert_eq!(
        Asked { screen_occlusion: true, ..plain.clone() }.passes(),
        ["geometry", "shade"],
        "a sun without shadows"
    );
    let open = Sun { ambient_occlusion: false, ..Sun::default() };
    assert_eq!(Asked { sun: open, ..at_once }.passes(), ["shadow map", "geometry", "shade"]);
    let several = Asked { samples: 4, ..plain.clone() };
    assert_eq!(several.passes(), ["geometry", "shade", "resolve"]);
    let text = furniture::Piece::Panel(furniture::Panel {
        low: [0.0; 2],
        high: [9.0; 2],
        color: [1.0; 3],
        opacity: 1.0,
        radius_px: 0.0,
        softness_px: 1.0,
        ellipse: false,
    });
    let titled = Asked { furniture: Furniture { pieces: vec![text] }, ..plain.clone() };
    assert_eq!(titled.passes(), ["geometry", "shade", "furniture"]);
    assert_eq!(Asked { masks: true, ..plain }.passes(), ["geometry", "shade"], "there is no lens");
}

#[test]
fn effects_call_for_their_own_passes_alone() {
    let passes = |effect| Asked::effect(effect).passes();
    assert_eq!(passes("greyscale"), ["geometry", "shade"], "a lens that colours is no pass");
    assert_eq!(passes("cut-away"), ["geometry", "shade"], "nor one that hides");
    assert_eq!(passes("blur"), ["geometry", "unfiltered", "shade"]);
    assert_eq!(passes("hidden-line"), ["geometry", "lines", "shade"]);
    assert_eq!(passes("transparent"), ["geometry", "layers", "shade"]);
    let masked = Asked { masks: true, ..Asked::effect("greyscale") };
    assert_eq!(masked.passes(), ["geometry", "clear lens masks", "shade"]);
    let sprite = Asked { sprite: Some(LensSprite::default()), ..Asked::effect("greyscale") };
    assert_eq!(sprite.passes(), ["crossings of sprites", "geometry", "shade"]);
    let section = Asked { section: Some([1.0; 3]), ..Asked::effect("cut-away") };
    assert_eq!(section.passes(), ["geometry", "ends of lenses", "shade"]);
    let uncut = Asked { section: Some([1.0; 3]), ..Asked::effect("greyscale") };
    assert_eq!(uncut.passes(), ["geometry", "shade"], "what is not cut has no section");
}

#[test]
fn lenses_that_bend_rays_call_for_a_pass_where_they_are_seen_and_bend_any() {
    let passes = |lens: &RayLens| {
        let frame = PictureFrame { half: DVec2::splat(0.5), is_parallel: false, near: 0.5 };
        let rays = RayPaths::new(
            &[(0, lens, [0.0; 3])],
            &frame,
            &Scenery { shown: &|_| None, mask: &|_| None, feature: &|_| Vec::new() },
        );
        Asked { rays, ..Asked::nothing() }.passes()
    };
    let lens = RayLens::magnifier();
    assert_eq!(passes(&lens), ["geometry", "bent rays", "shade"]);
    assert_eq!(passes(&RayLens::fisheye()), ["geometry", "bent rays", "shade"]);
    let image = RayLens { method: RayMethod::Image, ..lens.clone() };
    assert_eq!(passes(&image), ["geometry", "images of lenses", "shade"], "no ray is followed");
    assert_eq!(passes(&RayLens { radius: 0.0, ..lens.clone() }), ["geometry", "shade"]);
    assert_eq!(
        passes(&RayLens { center: DVec2::splat(3.0), ..lens.clone() }),
        ["geometry", "shade"],
        "beside the picture"
    );
    let Bend::Magnify(magnify) = lens.bend else { panic!("a magnifier") };
    let same = RayLens { bend: Bend::Magnify(Magnify { magnification: 1.0, ..magnify }), ..lens };
    assert_eq!(passes(&same), ["geometry", "shade"], "it shows what is there");
}

#[test]
fn each_method_of_transparency_has_its_own_pass() {
    let passes = |transparency| Asked { transparency, measured: true, ..Asked::effect("transparent") }.passes();
    assert_eq!(passes(Transparency::Exact), ["geometry", "layers", "shade", "shown layers"]);
    for slots in [Transparency::KBuffer { layers: 4 }, Transparency::Peel { layers: 0 }, Transparency::Weighted] {
        assert_eq!(passes(slots), ["geometry", "slots, depths", "shade", "shown layers"]);
    }
    assert_eq!(passes(Transparency::Stochastic), ["geometry", "stochastic", "shade"]);
}

#[test]
fn techniques_kept_for_reference_have_passes_of_their_own() {
    let passes = |technique| Asked { technique, ..Asked::effect("greyscale") }.passes();
    assert_eq!(passes(Technique::Branches), ["geometry", "shade"]);
    // Of the geometry of regions the first line is that of what no lens reaches.
    assert_eq!(passes(Technique::Regions), ["geometry", "shade", "regions"]);
    let masked = Asked { technique: Technique::Regions, masks: true, ..Asked::effect("greyscale") };
    assert_eq!(masked.passes(), ["geometry", "clear lens masks", "classes", "shade", "regions"]);
}
