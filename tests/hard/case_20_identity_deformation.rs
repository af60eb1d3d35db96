//! Case 20, deformations: those that move nothing change no byte, and no count; what one magnifies and the next one makes small again is
//! where it was, to a hundredth of a pixel. Oracle: the picture without them.

use glam::{DQuat, DVec2, DVec3};
use veduta::{
    geom::Shape,
    lens::{
        Lens,
        deform::{ControlProfile, Step},
    },
    render::{
        frame::Backend,
        picture::{Aovs, Picture, Request, Studio},
    },
    scene::{Background, Scene},
    view::Camera,
};

use crate::{
    bodies::{block, studio_of},
    deformed::{Bent, deformers},
    lenses::{in_cube, share, view},
    oracle::Numbers,
    studio,
};

const SIZE: [u32; 2] = [217, 131];
const BACKENDS: [Backend; 2] = [Backend::Specialised, Backend::Uber];

fn draw(studio: &mut Studio, scene: &Scene, size: [u32; 2], samples: u32, backend: Backend) -> Picture {
    // Masks of lenses are drawn for whoever asks for them.
    let aovs = Aovs { lens_mask: false, ..studio::ALL };
    let request = Request { samples, aovs, statistics: true, backend, ..Request::plain(size) };
    studio.render(scene, &request).unwrap_or_else(|error| panic!("{error}"))
}

/// Whether two pictures are the same in every byte of colour, depth, object and normal.
fn is_same(a: &Picture, b: &Picture) -> bool {
    let depth = |p: &Picture| p.depth.as_ref().expect("depth").iter().map(|d| d.to_bits()).collect::<Vec<_>>();
    a.rgba == b.rgba && a.object_id == b.object_id && a.normal == b.normal && depth(a) == depth(b)
}

/// What a picture took, but for times and memory: passes, what they drew, pipelines, handlers and warnings.
fn counts(picture: &Picture) -> String {
    let all = &picture.statistics;
    let passes: Vec<_> = all
        .passes
        .iter()
        .map(|pass| (&pass.name, &pass.view, &pass.serves, pass.draws, pass.triangles, pass.pixels))
        .collect();
    format!("{passes:?} {:?} {:?} {:?} {:?}", all.pipelines.names, all.handlers, all.city.triangles, all.warnings)
}

/// What was drawn of the city, but for shadows that are drawn anew, and what is told.
fn city(picture: &Picture) -> String {
    let all = &picture.statistics;
    let drawn = all.passes.iter().filter(|pass| pass.name.starts_with("geometry"));
    let drawn: Vec<_> = drawn.map(|pass| (&pass.name, &pass.view, pass.draws, pass.triangles, pass.pixels)).collect();
    format!("{drawn:?} {:?} {:?} {:?}", all.handlers, all.city.triangles, all.warnings)
}

/// The focus area of the first of [`identities`].
fn focus(center: DVec3) -> Shape {
    Shape::Box { center, size: DVec3::new(60.0, 50.0, 30.0), rotation: DQuat::IDENTITY }
}

/// Lenses that move nothing, each in its own way.
fn identities(middle: DVec3) -> Vec<(&'static str, Lens)> {
    let turn = Step::Twist { angle: 0.9 };
    let nothing = [
        ("moves by nothing", Step::Translate { by: DVec3::ZERO }),
        ("is as large", Step::Scale { factors: DVec3::ONE }),
        ("leans by nothing", Step::Shear { slope: DVec2::ZERO }),
        ("gets no narrower", Step::Taper { factor: 1.0 }),
        ("turns by nothing", Step::Twist { angle: 0.0 }),
        ("bends by nothing", Step::Bend { angle: 0.0 }),
    ];
    let controls = [
        ControlProfile::Everywhere,
        ControlProfile::Smooth { border: 0.25 },
        ControlProfile::Linear { border: 0.1 },
        ControlProfile::Bump,
        ControlProfile::Ring { inner: 0.2, outer: 0.9 },
    ];
    let size = DVec3::new(60.0, 50.0, 30.0);
    let bent = |steps: Vec<Step>, i: usize| Bent {
        center: middle,
        size,
        rotation: DQuat::from_rotation_z(0.4 * i as f64),
        steps,
        control: controls[i % controls.len()].clone(),
    };
    let mut all: Vec<(&str, Lens)> =
        nothing.iter().enumerate().map(|(i, (what, step))| (*what, bent(vec![step.clone()], i).lens(what))).collect();
    let every = nothing.iter().map(|(_, step)| step.clone()).collect();
    all.push(("does nothing in six steps", bent(every, 0).lens("six")));
    let strong = bent(vec![turn.clone()], 1).lens("a");
    let mut weak = strong.clone();
    weak.kind.deform_mut().expect("a deformation").strength = 0.0;
    all.push(("has no strength", weak));
    all.push(("is off", Lens { enabled: false, ..strong }));
    let away = Bent { center: middle + DVec3::new(5e3, 0.0, 0.0), ..bent(vec![turn.clone()], 1) };
    all.push(("is elsewhere", away.lens("away")));
    // Beside the city by a step.
    let beside = Bent { center: middle + DVec3::new(0.0, 2e3, 0.0), ..bent(vec![turn], 3) };
    all.push(("is beside it", beside.lens("beside")));
    all
}

#[test]
fn deformations_that_move_nothing_change_no_byte_and_no_count() {
    let mut studio = studio::synthetic(60);
    let middle = studio.extent().center();
    let outside = Camera::looking(middle + DVec3::new(60.0, -110.0, 80.0), middle, 0.8);
    let inside = Camera::looking(middle + DVec3::new(5.0, -12.0, 6.0), middle + DVec3::new(30.0, 40.0, 0.0), 1.0);
    let level = studio::orthographic(middle + DVec3::new(60.0, -110.0, 80.0), middle, 150.0);
    for (camera, samples, shadows) in [(outside, 1, true), (inside, 2, false), (level, 1, false)] {
        let mut without = studio::scene(camera, vec![]);
        without.sun.shadows = shadows;
        without.style.background = Background::Sky;
        for backend in BACKENDS {
            // The second picture: pipelines are there.
            draw(&mut studio, &without, SIZE, samples, backend);
            let plain = draw(&mut studio, &without, SIZE, samples, backend);
            // Whoever counts what lenses hold works out their masks, whatever they do.
            let idle = studio::lens("idle", [focus(middle)], "sepia");
            let idle = vec![Lens { effects: vec![], ..idle }];
            let masked = draw(&mut studio, &Scene { lenses: idle, ..without.clone() }, SIZE, samples, backend);
            let mut all: Vec<_> = identities(middle).into_iter().map(|(what, lens)| (what, vec![lens])).collect();
            all.push(("all at once", identities(middle).into_iter().map(|(_, lens)| lens).collect()));
            for (what, mut lenses) in all {
                lenses.iter_mut().enumerate().for_each(|(i, lens)| lens.name = format!("identity {i}"));
                let drawn = draw(&mut studio, &Scene { lenses, ..without.clone() }, SIZE, samples, backend);
                assert!(is_same(&plain, &drawn), "{backend:?}: one that {what} changed something");
                let like = match what {
                    "is off" if backend == Backend::Specialised => Some(&plain),
                    "moves by nothing" => Some(&masked),
                    _ => None,
                };
                assert!(
                    like.is_none_or(|like| counts(like) == counts(&drawn)),
                    "{backend:?}: one that {what}: {}",
                    counts(&drawn)
                );
                assert_eq!(city(&plain), city(&drawn), "{backend:?}: one that {what}");
                let moved = drawn.statistics.frame.deformed;
                assert!(moved.is_none_or(|moved| moved.met == 0 && moved.triangles == 0), "{what}: {moved:?}");
            }
        }
    }
    // One that does something is seen, and is gone without a trace.
    let camera = Camera::looking(middle + DVec3::new(60.0, -110.0, 80.0), middle, 0.8);
    let without = studio::scene(camera, vec![]);
    let plain = draw(&mut studio, &without, SIZE, 1, Backend::Specialised);
    let turn = vec![Step::Twist { angle: 0.2 }];
    let lens = Bent::upright(middle, DVec3::new(60.0, 50.0, 30.0), turn, ControlProfile::Bump).lens("a");
    let bent = draw(&mut studio, &Scene { lenses: vec![lens], ..without.clone() }, SIZE, 1, Backend::Specialised);
    assert!(!is_same(&plain, &bent) && bent.statistics.frame.deformed.is_some_and(|moved| moved.met > 0));
    let again = draw(&mut studio, &without, SIZE, 1, Backend::Specialised);
    assert!(is_same(&plain, &again) && again.statistics.frame.deformed.is_none());
}

/// Magnifies about the middle of a base, and makes small again.
fn there_and_back(base: DVec3, factors: DVec3, rotation: DQuat) -> [Bent; 2] {
    let size = DVec3::splat(10.0);
    let center = base + rotation * DVec3::Z * 5.0;
    [factors, 1.0 / factors].map(|factors| Bent {
        center,
        size,
        rotation,
        steps: vec![Step::Scale { factors }],
        control: ControlProfile::Everywhere,
    })
}

#[test]
fn what_is_magnified_and_made_small_again_is_where_it_was() {
    // Everywhere, in f64.
    let mut numbers = Numbers(620);
    for _ in 0..20_000 {
        let base = 1e6 * in_cube(&mut numbers);
        let factors = DVec3::from([0; 3].map(|_| 100_f64.powf(2.0 * share(&mut numbers) - 1.0)));
        let both = deformers(&there_and_back(base, factors, DQuat::from_rotation_x(3.0 * share(&mut numbers))));
        let place = base + 500.0 * in_cube(&mut numbers);
        assert!(both.value(place).distance(place) < 1e-7, "{place} by {factors}");
    }
    // In pictures: by how much a surface may be shifted along the sight line, if it is shifted by a hundredth of a pixel.
    const OFF_PX: f64 = 0.01;
    const LARGE: [u32; 2] = [400, 300];
    // Houses that stand apart: of what shares a plane one is lifted off the other where it is deformed.
    let mut house = |i: i64| {
        let low = [9_000 * (i % 8) + 500 * numbers.below(5), 11_000 * (i / 8) + 500 * numbers.below(5), 0];
        let size = [0; 3].map(|_| 2_000 + numbers.below(5_000));
        block(low, [0, 1, 2].map(|axis| low[axis] + size[axis]))
    };
    let mut studio = studio_of(&(0..64).map(&mut house).collect::<Vec<_>>());
    let middle = studio.extent().center();
    let far = Camera::looking(middle + DVec3::new(40.0, -70.0, 50.0), middle, 0.8);
    let near = Camera::looking(middle + DVec3::new(5.0, -40.0, 2.0), middle + DVec3::new(9.0, 40.0, 0.0), 1.0);
    let (mut compared, mut others) = (0, 0);
    for camera in [far, near] {
        let without = studio::scene(camera, vec![]);
        let view = view(camera, LARGE);
        let backend = Backend::Specialised;
        let plain = draw(&mut studio, &without, LARGE, 1, backend);
        for (i, factor) in [1.5, 4.0, 0.2, 8.0].into_iter().enumerate() {
            let factors = if i == 2 { DVec3::new(factor, 1.0, 2.0) } else { DVec3::splat(factor) };
            let base = middle + DVec3::new(7.0, 9.0, -4.0) * i as f64;
            let lenses = there_and_back(base, factors, DQuat::from_rotation_z(0.3 * i as f64));
            let lenses = vec![lenses[0].lens("large"), lenses[1].lens("small")];
            let drawn = draw(&mut studio, &Scene { lenses, ..without.clone() }, LARGE, 1, backend);
            assert!(drawn.statistics.frame.deformed.is_some_and(|moved| moved.met > 0), "both are used");
            let (was, is) = (plain.depth.as_ref().unwrap(), drawn.depth.as_ref().unwrap());
            let (ids, now) = (plain.object_id.as_ref().unwrap(), drawn.object_id.as_ref().unwrap());
            let normals = plain.normal.as_ref().unwrap();
            for p in 0..was.len() {
                let (was, is) = (f64::from(was[p]), f64::from(is[p]));
                if ids[p] == 0 && now[p] == 0 {
                    continue;
                }
                let ray = view.pixel_ray(p as u32 % LARGE[0], p as u32 / LARGE[0]);
                let normal = DVec3::from(normals[p].map(f64::from));
                let cosine = (normal.dot(ray.direction) / ray.direction.length()).abs();
                let off = OFF_PX * view.pixel_m(was) / cosine.max(1e-9);
                // Where something else is seen there, an edge is near.
                let is_there = ids[p] == now[p] && (is - was).abs() <= off + 2.0 * f64::from(f32::EPSILON) * was;
                compared += 1;
                others += u32::from(!is_there);
            }
        }
    }
    // An edge is a hundredth of a pixel from the middle of one pixel in fifty that it passes.
    assert!(compared > 250_000 && others * 1000 < compared, "{others} of {compared} pixels are elsewhere");
}
