//! Hard case 20, for lenses: one that changes nothing changes no byte.

use std::collections::BTreeMap;

use glam::DVec3;
use veduta::{
    lens::{Border, BorderUnit, Class, Discrete, EffectUse, Lens, LensBody, LensSprite, Parameter},
    render::{
        frame::Backend,
        picture::{Aovs, Picture, Request, Studio},
    },
    scene::{Background, Scene},
    shader::{Mode, handlers},
    view::Camera,
};

use crate::studio;

const SIZE: [u32; 2] = [217, 131];
const BACKENDS: [Backend; 2] = [Backend::Specialised, Backend::Uber];

fn draw(studio: &mut Studio, scene: &Scene, samples: u32, transparent: bool, backend: Backend) -> Picture {
    let aovs = Aovs { lens_mask: false, ..studio::ALL };
    let request = Request { samples, transparent, aovs, backend, ..Request::plain(SIZE) };
    studio.render(scene, &request).expect("a picture")
}

/// Whether two pictures are the same in every byte of colour, depth, object and normal.
fn is_same(a: &Picture, b: &Picture) -> bool {
    let depth = |p: &Picture| p.depth.as_ref().expect("depth").iter().map(|d| d.to_bits()).collect::<Vec<_>>();
    a.rgba == b.rgba && a.object_id == b.object_id && a.normal == b.normal && depth(a) == depth(b)
}

/// Lenses that change nothing, each in its own way.
fn identities(middle: DVec3) -> Vec<(String, Lens)> {
    let shapes = studio::shapes(middle, 35.0);
    let of = |i: usize| shapes[i % shapes.len()].clone();
    let plain = |i: usize, effects: Vec<EffectUse>| Lens { effects, ..studio::lens("identity", [of(i)], "sepia") };
    let mut all = vec![
        ("of no effect".to_owned(), plain(0, vec![])),
        (
            "disabled".to_owned(),
            Lens { enabled: false, body: LensBody::Outline, ..plain(1, vec![studio::used("eraser")]) },
        ),
        ("by its sprite".to_owned(), Lens { sprite: Some(LensSprite::default()), ..plain(2, vec![]) }),
        ("of no size".to_owned(), {
            let shape = veduta::geom::Shape::Sphere { center: middle, radius: 0.0 };
            Lens { body: LensBody::Outline, ..studio::lens("identity", [shape], "invert") }
        }),
    ];
    // Every effect that is laid over what is below, with hardly anything of its own; on each class, with borders and without.
    let laid = |h: &&veduta::shader::EffectDefinition| h.mode == Mode::Local && !h.kind.decides_visibility();
    for (i, handler) in handlers().iter().filter(laid).enumerate() {
        let class = [Class::Inside, Class::Front, Class::Behind, Class::Rest][i % 4];
        let mut parameters = BTreeMap::new();
        if handler.name == "thematic" || handler.name == "discard-color" {
            parameters.insert("attribute".to_owned(), Parameter::Text("height".into()));
        }
        let effect = EffectUse { class, weight: Some(1e-30), parameters, ..studio::used(&handler.name) };
        let border = Border { width: 15.0, unit: BorderUnit::Metres, discrete: Discrete::Dither };
        let border = (i % 3 == 1).then_some(border);
        all.push((format!("{} of hardly any weight", handler.name), Lens { border, ..plain(i, vec![effect]) }));
    }
    all
}

/// Where one looks from: outside, within a lens, or along parallel rays.
#[derive(Clone, Copy, PartialEq)]
enum Look {
    Outside,
    Inside,
    Level,
}

fn changes_no_byte(look: Look) {
    let mut studio = studio::synthetic(60);
    let middle = studio.extent().center();
    let away = middle + DVec3::new(60.0, -110.0, 80.0);
    let (camera, samples, transparent) = match look {
        Look::Outside => (Camera::looking(away, middle, 0.8), 1, false),
        Look::Inside => {
            (Camera::looking(middle + DVec3::new(5.0, -12.0, 6.0), middle + DVec3::new(30.0, 40.0, 0.0), 1.0), 2, true)
        }
        Look::Level => (studio::orthographic(away, middle, 150.0), 1, false),
    };
    let mut without = studio::scene(camera, vec![]);
    without.sun.shadows = look == Look::Outside;
    without.style.background = Background::Sky;
    let plain = draw(&mut studio, &without, samples, transparent, Backend::Specialised);
    // One by one only once: each is a program of its own.
    for (name, lens) in identities(middle).into_iter().filter(|_| look == Look::Outside) {
        let scene = Scene { lenses: vec![lens], ..without.clone() };
        let drawn = draw(&mut studio, &scene, samples, transparent, Backend::Specialised);
        assert!(is_same(&plain, &drawn), "a lens {name} changed something");
    }
    // Many at once; not all, as a module takes a compiler more than twice as long that is twice as long.
    let mut lenses: Vec<Lens> = identities(middle).into_iter().map(|(_, lens)| lens).collect();
    lenses.iter_mut().enumerate().for_each(|(i, lens)| lens.name = format!("identity {i}"));
    // From outside each was looked at; of the rest each look has its own share, unless runs are thorough.
    let share = |i: usize| match look {
        _ if studio::is_thorough() => true,
        Look::Outside => i.is_multiple_of(4),
        Look::Inside => i.is_multiple_of(2),
        Look::Level => i % 2 == 1,
    };
    for some in lenses.chunks(4).enumerate().filter(|(i, _)| share(*i)).map(|(_, some)| some) {
        let scene = Scene { lenses: some.to_vec(), ..without.clone() };
        for backend in BACKENDS {
            let drawn = draw(&mut studio, &scene, samples, transparent, backend);
            assert!(is_same(&plain, &drawn), "{backend:?}: {} and its like changed something", some[0].name);
        }
    }
}

#[test]
fn a_lens_that_changes_nothing_changes_no_byte_from_outside() {
    changes_no_byte(Look::Outside);
}

#[test]
fn a_lens_that_changes_nothing_changes_no_byte_around_the_eye() {
    changes_no_byte(Look::Inside);
}

#[test]
fn a_lens_that_changes_nothing_changes_no_byte_along_parallel_rays() {
    changes_no_byte(Look::Level);
}

#[test]
fn an_eraser_that_hides_nothing_changes_no_byte() {
    let mut studio = studio::studio(&[studio::citydata("square.city.json")]);
    let middle = studio.extent().center();
    let camera = Camera::looking(middle + DVec3::new(60.0, -110.0, 80.0), middle, 0.8);
    let without = studio::scene(camera, vec![]);
    let plain = draw(&mut studio, &without, 1, false, Backend::Specialised);
    // Beside the city, above it, and of what is not there.
    let far = studio.extent().max + DVec3::splat(500.0);
    let shapes = [
        veduta::geom::Shape::Sphere { center: far, radius: 90.0 },
        veduta::geom::Shape::Sphere { center: middle + DVec3::Z * 300.0, radius: 150.0 },
    ];
    for shape in shapes {
        for backend in BACKENDS {
            let scene = Scene { lenses: vec![studio::lens("a", [shape.clone()], "eraser")], ..without.clone() };
            let drawn = draw(&mut studio, &scene, 1, false, backend);
            assert!(is_same(&plain, &drawn), "{shape:?}, {backend:?}");
        }
    }
}
