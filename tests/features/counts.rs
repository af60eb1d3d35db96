//! Counts of statistics: each is 0 where nothing is to be counted, and what thought says where something is.

use crate::studio::*;
use glam::DVec3;
use veduta::{
    geom::Shape,
    lens::{Class, Content, Copied, EffectUse, Lens, kind::ContentLens},
    render::{
        frame::Backend,
        picture::{Picture, Request, Studio},
    },
    scene::Scene,
    view::Camera,
};

const SIZE: [u32; 2] = [160, 100];

fn drawn(studio: &mut Studio, scene: &Scene, backend: Backend) -> Picture {
    let request = Request { aovs: ALL, statistics: true, backend, ..Request::plain(SIZE) };
    studio.render(scene, &request).expect("a picture")
}

fn passes(picture: &Picture) -> Vec<&str> {
    picture.statistics.passes.iter().map(|pass| pass.name.as_str()).collect()
}

struct Stage {
    studio: Studio,
    camera: Camera,
    middle: DVec3,
}

impl Stage {
    fn new() -> Self {
        let studio = synthetic(40);
        let middle = studio.extent().center();
        let camera = Camera::looking(middle + DVec3::new(60.0, -120.0, 80.0), middle, 0.7);
        Self { studio, camera, middle }
    }

    fn draw(&mut self, lenses: Vec<Lens>, backend: Backend) -> Picture {
        drawn(&mut self.studio, &scene(self.camera, lenses), backend)
    }

    fn ball(&self, up: f64, radius: f64) -> Shape {
        Shape::Sphere { center: self.middle + DVec3::Z * up, radius }
    }
}

#[test]
fn handlers_are_those_that_ran() {
    let mut stage = Stage::new();
    let everything = stage.ball(0.0, 5e3);
    for backend in [Backend::Specialised, Backend::Uber] {
        // In the air before the houses, in the picture and with nothing in it; then around all of them.
        let air = stage.ball(45.0, 8.0);
        for effect in ["greyscale", "blur", "velvet", "gooch"] {
            let empty = stage.draw(vec![lens("air", [air.clone()], effect)], backend);
            let figures = &empty.statistics.lenses[0];
            assert!(figures.visible, "{effect} is in the picture");
            assert_eq!((figures.covered, figures.pixels, figures.objects), (0, 0, 0), "{effect}");
            assert!(empty.statistics.handlers.is_empty(), "{effect}: {:?}", empty.statistics.handlers);
            let full = stage.draw(vec![lens("all", [everything.clone()], effect)], backend);
            assert_eq!(full.statistics.handlers, [effect], "{effect}");
        }
    }
}

#[test]
fn pixels_are_those_of_the_classes_that_a_lens_acts_on() {
    let mut stage = Stage::new();
    let ball = stage.ball(0.0, 30.0);
    let of = |class: Class| Lens {
        effects: vec![EffectUse { class, ..used("sepia") }],
        ..lens("l", [ball.clone()], "sepia")
    };
    let mut sum = 0;
    for class in [Class::Inside, Class::Front, Class::Behind, Class::Rest] {
        let picture = stage.draw(vec![of(class)], Backend::default());
        let figures = &picture.statistics.lenses[0];
        let classified = [
            (Class::Inside, figures.classified.inside),
            (Class::Front, figures.classified.front),
            (Class::Behind, figures.classified.behind),
            (Class::Rest, figures.classified.rest),
        ];
        let wanted = classified.into_iter().find(|(of, _)| *of == class).and_then(|(_, count)| count);
        assert_eq!(Some(figures.pixels), wanted, "{class:?}");
        // What inside is has a count of its own.
        assert_eq!(figures.covered, bits(&picture, 0).into_iter().filter(|is_in| *is_in).count() as u64);
        sum += figures.pixels;
    }
    assert_eq!(sum, u64::from(SIZE[0]) * u64::from(SIZE[1]), "each pixel is of one class");
    let none = stage.draw(vec![Lens { effects: vec![], ..of(Class::Inside) }], Backend::default());
    assert_eq!(none.statistics.lenses[0].pixels, 0, "without effects it acts on nothing");
}

#[test]
fn an_effect_of_no_weight_costs_nothing() {
    let mut stage = Stage::new();
    let ball = stage.ball(0.0, 30.0);
    let of = |effects: Vec<EffectUse>| Lens { effects, ..lens("l", [ball.clone()], "sepia") };
    for backend in [Backend::Specialised, Backend::Uber] {
        let plain = stage.draw(vec![of(vec![])], backend);
        for effect in ["blur", "sepia", "velvet"] {
            let weightless = EffectUse { weight: Some(0.0), ..used(effect) };
            let picture = stage.draw(vec![of(vec![weightless])], backend);
            assert_eq!(passes(&picture), passes(&plain), "{effect}");
            assert_eq!(picture.statistics.handlers, plain.statistics.handlers, "{effect}");
            assert!(picture.rgba == plain.rgba, "{effect}");
        }
    }
}

#[test]
fn a_lens_with_nothing_in_it_adds_no_pass() {
    let mut stage = Stage::new();
    let over = stage.studio.extent().max.z - stage.middle.z;
    for backend in [Backend::Specialised, Backend::Uber] {
        let without = |aovs| Request { aovs, statistics: true, backend, ..Request::plain(SIZE) };
        for (up, place) in [(over + 25.0, "in the air"), (-400.0, "in the ground")] {
            let ball = stage.ball(up, 8.0);
            for effect in ["sepia", "blur", "x-ray", "eraser", "wireframe", "transparent"] {
                let one = scene(stage.camera, vec![lens("l", [ball.clone()], effect)]);
                let none = scene(
                    stage.camera,
                    vec![lens("l", [ball.clone()], effect)]
                        .into_iter()
                        .map(|l| Lens { effects: vec![], ..l })
                        .collect(),
                );
                for aovs in [ALL, Default::default()] {
                    let [one, none] =
                        [&one, &none].map(|scene| stage.studio.render(scene, &without(aovs)).expect("a picture"));
                    assert_eq!(passes(&one), passes(&none), "{effect} {place}");
                    assert_eq!(one.statistics.lenses[0].visible, up > 0.0, "{effect} {place}");
                    assert!(one.statistics.handlers.is_empty(), "{effect} {place}: {:?}", one.statistics.handlers);
                    assert!(one.rgba == none.rgba && one.depth == none.depth, "{effect} {place}");
                }
            }
        }
        // What it does to what is behind it is done; and to all that misses it.
        for class in [Class::Behind, Class::Rest] {
            let air = lens("l", [stage.ball(over + 25.0, 8.0)], "sepia");
            let air = Lens { effects: vec![EffectUse { class, ..used("sepia") }], ..air };
            let picture = stage.draw(vec![air], backend);
            assert_eq!(picture.statistics.handlers, ["sepia"], "{class:?}");
        }
        // With a second part among the houses it acts there.
        let parts = [stage.ball(over + 25.0, 8.0), stage.ball(0.0, 30.0)];
        let both = stage.draw(vec![lens("l", parts, "sepia")], backend);
        assert_eq!(both.statistics.handlers, ["sepia"]);
        // Around the highest roof something may be in it again.
        let full = stage.ball(over, 8.0);
        let roofs = stage.draw(vec![lens("l", [full], "blur")], backend);
        assert!(passes(&roofs).iter().any(|pass| pass.contains("filter")), "{:?}", passes(&roofs));
    }
}

/// Whether a lens shows what only a content or the plain ground puts there.
#[test]
fn a_lens_around_a_copy_or_around_bare_ground_acts() {
    let mut stage = Stage::new();
    let top = stage.studio.extent().max.z - stage.middle.z;
    let in_the_air = stage.ball(top + 60.0, 20.0);
    let copied = Some(Copied { from: Some(stage.middle), ..Copied::default() });
    let content = Content { copied, ..Content::default() };
    let around = lens("copy", [in_the_air.clone()], "sepia");
    let copy = Lens { kind: ContentLens { content }.into(), effects: vec![], ..around };
    let camera = Camera::looking(
        stage.middle + DVec3::new(0.0, -120.0, top + 100.0),
        stage.middle + DVec3::Z * (top + 60.0),
        0.7,
    );
    for backend in [Backend::Specialised, Backend::Uber] {
        for effect in ["sepia", "eraser"] {
            let over = lens("over", [in_the_air.clone()], effect);
            let alone = drawn(&mut stage.studio, &scene(camera, vec![copy.clone()]), backend);
            let both = drawn(&mut stage.studio, &scene(camera, vec![copy.clone(), over]), backend);
            assert!(alone.rgba != both.rgba, "{effect} does nothing to the copy");
            assert_eq!(both.statistics.handlers, [effect]);
        }
    }
    // On the plain ground, beside all houses.
    let mut grounded = boxes("bare-ground", &[([0, 0, 0], [10, 10, 10])], false, true);
    let extent = grounded.extent();
    let corner = DVec3::new(extent.min.x + 0.2, extent.min.y + 0.2, 0.0);
    let camera = Camera::looking(corner + DVec3::new(-6.0, -9.0, 12.0), corner, 0.9);
    let ball = Shape::Sphere { center: corner, radius: 2.0 };
    for backend in [Backend::Specialised, Backend::Uber] {
        let picture = drawn(&mut grounded, &scene(camera, vec![lens("l", [ball.clone()], "sepia")]), backend);
        assert!(picture.statistics.lenses[0].covered > 20, "the corner of the ground is in it");
        assert_eq!(picture.statistics.handlers, ["sepia"]);
    }
}
