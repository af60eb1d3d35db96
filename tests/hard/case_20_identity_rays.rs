//! Case 20, lenses that bend rays: those that bend nothing change no byte; what one magnifies and the next one makes small again is where it was, to a
//! hundredth of a pixel; what the plain picture shows is reached by some bent ray. Oracle: the picture without them, and rays in f64.

use glam::{DVec2, DVec3};
use rayon::prelude::*;
use veduta::{
    geom::Shape,
    lens::{
        Lens, LensBody, Region,
        kind::{FeatureLens, SamplingLens},
        ray::{Bend, RayLens, RayOutline, Sampling, SamplingRate},
    },
    render::{
        frame::Backend,
        picture::{Picture, Request, Studio},
    },
    scene::Scene,
};

use crate::{
    case_27_bent_rays::{Plane, Sight, cameras, first, lens, magnifier, magnify, plain_ray},
    studio,
};

const SIZE: [u32; 2] = [180, 120];
/// How far from an edge of the plain picture another object may be shown, pixels.
const BESIDE_PX: f64 = 0.01;

fn draw(studio: &mut Studio, scene: &Scene, backend: Backend) -> Picture {
    let request = Request { samples: 2, aovs: studio::ALL, backend, ..Request::plain(SIZE) };
    studio.render(scene, &request).expect("a picture")
}

/// Lenses that bend nothing.
fn identities() -> Vec<(&'static str, Lens)> {
    let sampling =
        |rate| lens(SamplingLens { ray: RayLens { bend: Bend::Sample(Sampling { rate }), ..RayLens::sampling() } });
    let even = [[0.0, 2.5], [0.4, 2.5], [1.0, 2.5]].map(DVec2::from).to_vec();
    let mut feature = RayLens::feature();
    if let Some(magnify) = feature.bend.magnify_mut() {
        magnify.magnification = 1.0;
    }
    let disabled = Lens { enabled: false, ..magnifier(magnify(3.0, 60.0, 60.0, 0.4)) };
    let elsewhere = RayLens { center: DVec2::new(0.5, 0.0), radius: 1e-6, ..magnify(3.0, 60.0, 60.0, 0.4) };
    vec![
        ("magnifies by 1", magnifier(magnify(1.0, 60.0, 60.0, 0.4))),
        (
            "magnifies by 1 in a square",
            magnifier(RayLens { outline: RayOutline::Square, ..magnify(1.0, 9.0, 300.0, 0.0) }),
        ),
        ("samples its middle as its rim", sampling(SamplingRate::Cubic(1.0))),
        ("samples all alike", sampling(SamplingRate::Points(even))),
        ("a feature as large as it is", lens(FeatureLens { ray: feature })),
        ("disabled", disabled),
        ("between pixels", magnifier(elsewhere)),
    ]
}

#[test]
fn lenses_that_bend_nothing_change_no_byte() {
    let mut studio = studio::synthetic(40);
    for (c, camera) in cameras(&studio).into_iter().enumerate() {
        let plain = draw(&mut studio, &studio::scene(camera, vec![]), Backend::Specialised);
        for (l, (what, lens)) in identities().into_iter().enumerate() {
            // In an ordinary run each from one of the eyes.
            if !studio::is_thorough() && (c + l) % 3 != 0 {
                continue;
            }
            for backend in [Backend::Specialised, Backend::Uber] {
                let found = draw(&mut studio, &studio::scene(camera, vec![lens.clone()]), backend);
                let bits =
                    |p: &Picture| p.depth.as_ref().expect("depths").iter().map(|d| d.to_bits()).collect::<Vec<_>>();
                assert!(found.rgba == plain.rgba, "{what}, eye {c}, {backend:?}: colours");
                assert!(
                    found.object_id == plain.object_id && found.normal == plain.normal,
                    "{what}, eye {c}, {backend:?}"
                );
                assert!(bits(&found) == bits(&plain), "{what}, eye {c}, {backend:?}: depths");
            }
        }
    }
}

#[test]
fn what_is_magnified_and_made_small_again_is_where_it_was() {
    let mut studio = studio::synthetic(40);
    let (mut compared, mut wrong) = (0, 0);
    for (c, camera) in cameras(&studio).into_iter().enumerate() {
        // Of magnifications of 1 / (2 - 1 / m) powers are the opposite ones.
        let m = [2.0, 3.5, 1.4][c];
        let pair = [m, 1.0 / (2.0 - 1.0 / m)].map(|m| magnifier(magnify(m, 80.0, 120.0, 0.5)));
        let picture = draw(&mut studio, &studio::scene(camera, pair.to_vec()), Backend::Specialised);
        let sight = Sight::new(&studio, camera, SIZE);
        let ids = picture.object_id.expect("ids");
        let of_pixel = |i: usize| {
            let at = sight.pixel(i);
            let ring = (0..8).map(|k| BESIDE_PX * DVec2::from_angle(f64::from(k) * std::f64::consts::FRAC_PI_4));
            let mut around = std::iter::once(DVec2::ZERO).chain(ring);
            around.any(|aside| sight.id(&sight.straight(sight.place(at + aside))) == ids[i])
        };
        compared += ids.len();
        wrong += (0..ids.len()).into_par_iter().filter(|i| !of_pixel(*i)).count();
    }
    println!("{compared} pixels, {wrong} wrong");
    assert_eq!(wrong, 0, "of {compared} pixels");
}

#[test]
fn layers_are_there_once_where_lenses_overlap() {
    let mut studio = studio::synthetic(40);
    let middle = studio.extent().center();
    let clear = studio::lens("clear", [Region::Shape(Shape::Sphere { center: middle, radius: 300.0 })], "x-ray");
    let clear = Lens { body: LensBody::None, ..clear };
    for (c, camera) in cameras(&studio).into_iter().enumerate() {
        // Nested, and one beside the other: their rectangles have much in common.
        let aside = |center: [f64; 2], m: f64| RayLens { center: center.into(), ..magnify(m, 80.0, 120.0, 0.5) };
        let pairs = [
            [aside([0.5, 0.5], 2.0), aside([0.5, 0.5], 1.0 / 1.5)],
            [aside([0.4, 0.4], 1.0 + 1e-9), aside([0.6, 0.6], 1.0 + 1e-9)],
        ];
        let plain = draw(&mut studio, &studio::scene(camera, vec![clear.clone()]), Backend::Specialised);
        for (p, pair) in pairs.into_iter().enumerate() {
            let lenses = std::iter::once(clear.clone()).chain(pair.map(magnifier)).collect();
            let found = draw(&mut studio, &studio::scene(camera, lenses), Backend::Specialised);
            let differs = |(a, b): &(&[u8; 4], &[u8; 4])| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > 2);
            let count = found.rgba.iter().zip(&plain.rgba).filter(differs).count();
            // Rays beside edges may round to the other side.
            assert!(count * 200 < found.rgba.len(), "eye {c}, pair {p}: {count} of {} pixels", found.rgba.len());
        }
    }
}

#[test]
fn nothing_that_is_seen_is_lost_by_a_border_that_is_wide_enough() {
    let studio = studio::synthetic(40);
    let (mut reached, mut hidden, mut lost) = (0_u32, 0_u32, Vec::new());
    for (c, camera) in cameras(&studio).into_iter().enumerate() {
        let sight = Sight::new(&studio, camera, SIZE);
        // What is made smaller finds back within a border of at least 1/m - 1.
        for (m, border) in [(2.5, 0.3), (6.0, 0.05), (0.8, 0.5)] {
            let ray = magnify(m, 70.0, 90.0, border);
            let radius = ray.radius * 2.0 * sight.half.y;
            let plane = Plane::of(&ray, sight.is_parallel);
            for i in (0..(SIZE[0] * SIZE[1]) as usize).step_by(7) {
                let place = sight.place(sight.pixel(i));
                let Some((object, d)) = first(&sight.faces, &sight.straight(place), camera.near_m) else { continue };
                let (origin, direction) = plain_ray(place, sight.is_parallel);
                let there = origin + d * direction;
                let share = place.length() / radius;
                if share >= 1.0 {
                    continue;
                }
                // Which place of the lens shows it: along its radius, by halves.
                let k = |share: f64| ((share - (1.0 - border)) / border).clamp(0.0, 1.0);
                let shown = |share: f64| {
                    let path = plane.path(share / place.length() * radius * place, k(share), sight.is_parallel);
                    let (_, origin, direction) = *path.iter().find(|(range, ..)| d <= range[1]).expect("a piece");
                    let at = origin + d * direction;
                    at.truncate().dot(place) - there.truncate().dot(place)
                };
                let (mut low, mut high) = (0.0, 1.0);
                if shown(low) > 0.0 || shown(high) < 0.0 {
                    lost.push((c, m, place, object));
                    continue;
                }
                for _ in 0..60 {
                    let middle = 0.5 * (low + high);
                    if shown(middle) < 0.0 { low = middle } else { high = middle }
                }
                let share = 0.5 * (low + high);
                let path = plane.path(share / place.length() * radius * place, k(share), sight.is_parallel);
                match first(&sight.faces, &path, camera.near_m) {
                    Some((own, found)) if own == object && (found - d).abs() < 1e-6 * d => reached += 1,
                    // What the straight ray passes may stand in the way of the bent one.
                    Some((_, found)) if found < d * (1.0 + 1e-9) => hidden += 1,
                    _ => lost.push((c, m, place, object)),
                }
            }
        }
    }
    println!("{reached} places are reached, {hidden} stand behind others then, {} are lost", lost.len());
    assert!(lost.is_empty(), "{} of {}: {:?}", lost.len(), reached + hidden, &lost[..lost.len().min(5)]);
    assert!(reached > 2000 && hidden < reached / 4, "{reached} are reached, {hidden} hidden");
}

/// Places of boxes whose tops are all as far from an eye above them.
#[test]
fn things_are_as_many_times_as_large_as_the_lens_says() {
    let boxes: Vec<([i64; 3], [i64; 3])> = (-6..=6)
        .flat_map(|x| {
            (-6..=6).map(move |y| ([10 * x - 1, 100 + 10 * y - 1, 0], [2, 2, if (x + y) % 2 == 0 { 10 } else { 4 }]))
        })
        .collect();
    let mut studio = studio::boxes("magnified", &boxes, false, false);
    let size = [400, 400];
    let middle = DVec3::new(0.0, 100.0, 0.0);
    let (eye, m) = (middle + DVec3::new(0.0, 0.0, 160.0), 2.2);
    let above = veduta::view::Camera { up: DVec3::Y, ..veduta::view::Camera::looking(eye, middle, 0.75) };
    let level = veduta::view::Camera { up: DVec3::Y, ..studio::orthographic(eye, middle, 125.0) };
    for camera in [above, level] {
        // As large as it says at the tops of the high ones, which are nearest; what is lower is as much larger.
        let ray = RayLens { radius: 0.5, ..magnify(m, 50.0, 100.0, 0.3) };
        let centers = |studio: &mut Studio, lenses: Vec<Lens>| {
            let scene = studio::scene(camera, lenses);
            let request = Request { aovs: studio::ALL, ..Request::plain(size) };
            let picture = studio.render(&scene, &request).expect("a picture");
            let (ids, normals) = (picture.object_id.expect("ids"), picture.normal.expect("normals"));
            let mut sums = vec![(DVec2::ZERO, 0.0); boxes.len() + 1];
            for (i, (id, normal)) in ids.iter().zip(&normals).enumerate() {
                // Tops alone.
                if *id > 0 && normal[2] > 0.9 {
                    let at = DVec2::new((i % 400) as f64 + 0.5, (i / 400) as f64 + 0.5) - 200.0;
                    sums[*id as usize].0 += at;
                    sums[*id as usize].1 += 1.0;
                }
            }
            sums.into_iter().map(|(sum, count)| (count > 10.0).then(|| sum / count)).collect::<Vec<_>>()
        };
        let sight = Sight::new(&studio, camera, size);
        let plain = centers(&mut studio, vec![]);
        let large = centers(&mut studio, vec![magnifier(ray)]);
        let (mut measured, mut worst) = (0, 0.0_f64);
        for (plain, large) in plain.iter().zip(&large) {
            let (Some(plain), Some(large)) = (plain, large) else { continue };
            // Wholly in the core, and far enough from the middle to be measured.
            if large.length() > 0.7 * 200.0 - 17.0 || plain.length() < 13.0 {
                continue;
            }
            // Where its middle is, not where pixels have it.
            let pixel = 2.0 * sight.half.y / 400.0;
            let tops = boxes.iter().map(|(at, size)| {
                let from_eye = DVec3::new(at[0] as f64 + 1.0, at[1] as f64 + 1.0, size[2] as f64) - eye;
                let across = from_eye.truncate() / if sight.is_parallel { 1.0 } else { -from_eye.z };
                across * DVec2::new(1.0, -1.0) / pixel
            });
            let plain = tops.min_by(|a, b| a.distance(*plain).total_cmp(&b.distance(*plain))).expect("a top");
            let found = large.dot(plain) / plain.length_squared();
            worst = worst.max((found / m - 1.0).abs());
            measured += 1;
        }
        println!("{measured} tops, off by {worst:.2e}");
        assert!(measured >= 8 && worst < 0.01, "{measured} tops, off by {worst}");
    }
}
