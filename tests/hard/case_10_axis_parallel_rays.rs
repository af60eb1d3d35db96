//! Case 10: axis-parallel and zero-direction rays, flat boxes, rays in a slab's plane: no misses. Oracle: the slab test
//! in `i128` fractions; for lenses, where they are in a parallel view along their axes, in whole steps of a pixel.

use glam::{DQuat, DVec3};
use veduta::{
    geom::{Aabb, Shape, bvh::Bvh, ray::Ray},
    lens::Class,
};

use crate::{
    lenses::{painted, painted_class},
    oracle::Numbers,
    studio,
};

/// Whether the half-line meets the closed box, all in integers: per axis the interval of t as fractions.
fn meets(min: [i64; 3], max: [i64; 3], origin: [i64; 3], direction: [i64; 3]) -> bool {
    // t in [near, far], both as numerator / positive denominator.
    let (mut near, mut far) = ((0_i128, 1_i128), (1_i128, 0_i128));
    for i in 0..3 {
        let (low, high, d) = (min[i] - origin[i], max[i] - origin[i], i128::from(direction[i]));
        if d == 0 {
            if low > 0 || high < 0 {
                return false;
            }
            continue;
        }
        let (low, high) = if d > 0 { (low, high) } else { (-high, -low) };
        let (enter, leave) = ((i128::from(low), d.abs()), (i128::from(high), d.abs()));
        if enter.0 * near.1 > near.0 * enter.1 {
            near = enter;
        }
        // far starts at infinity: 1 / 0.
        if far.1 == 0 || leave.0 * far.1 < far.0 * leave.1 {
            far = leave;
        }
    }
    far.1 == 0 || near.0 * far.1 <= far.0 * near.1
}

#[test]
fn no_ray_misses_a_box_it_meets() {
    let mut numbers = Numbers(10);
    let mut met = 0;
    for _ in 0..4_000 {
        // Far from the origin, as cities are; flat on an axis as often as not.
        let min = [85_000, 447_000, -3].map(|c| c + numbers.below(40));
        let max = min.map(|c| c + numbers.below(2) * numbers.below(20));
        let bounds = Aabb { min: DVec3::from(min.map(|c| c as f64)), max: DVec3::from(max.map(|c| c as f64)) };
        let bvh = Bvh::build(&[bounds]);
        for _ in 0..250 {
            let direction = [0; 3].map(|_: i64| numbers.below(2) * (numbers.below(9) - 4));
            let steps = numbers.below(9);
            // Through a point of the box, mostly of its rim; some go just past it.
            let target = [0, 1, 2].map(|i| min[i] + numbers.below((max[i] - min[i] + 2) as u64));
            let origin = [0, 1, 2].map(|i| target[i] - steps * direction[i]);
            if direction == [0; 3] || !meets(min, max, origin, direction) {
                continue;
            }
            met += 1;
            let ray = Ray {
                origin: DVec3::from(origin.map(|c| c as f64)),
                direction: DVec3::from(direction.map(|c| c as f64)),
            };
            let mut found = false;
            bvh.along_ray(&ray, f64::INFINITY, |_, end| {
                found = true;
                end
            });
            assert!(found, "{min:?} {max:?} {origin:?} {direction:?}");
        }
    }
    assert!(met > 200_000, "{met} rays that meet their box");
}

/// A cube as each of the shapes that can be one.
fn cubes(min: DVec3, size: DVec3) -> [Shape; 4] {
    let corner = |i: u32| min + size * DVec3::new((i & 1).into(), (i >> 1 & 1).into(), (i >> 2 & 1).into());
    let axes = [DVec3::X, DVec3::Y, DVec3::Z];
    let both = |n: DVec3| [[n.x, n.y, n.z, n.dot(min + size)], [-n.x, -n.y, -n.z, -n.dot(min)]];
    let middle = min + 0.5 * size;
    let way = 0.5 * size.x * DVec3::X;
    [
        Shape::Box { center: middle, size, rotation: DQuat::IDENTITY },
        Shape::Convex { points: (0..8).map(corner).collect() },
        Shape::Polytope { planes: axes.into_iter().flat_map(both).collect() },
        // Its body between two points; those around the points are left out below.
        Shape::Corridor { points: vec![middle - way, middle + way], width: size.y, height: size.z },
    ]
}

#[test]
fn lenses_hold_rays_within_their_faces_and_rays_without_direction() {
    let mut numbers = Numbers(110);
    let (mut in_face, mut still) = (0, 0);
    for _ in 0..4_000 {
        let min = [85_000, 447_000, -3].map(|c| c + numbers.below(40));
        let size = [0; 3].map(|_: i64| 2 * (1 + numbers.below(9)));
        let vector = |p: [i64; 3]| DVec3::from(p.map(|c| c as f64));
        let bodies = cubes(vector(min), vector(size)).map(|s| s.volumes().expect("volumes").pop().expect("one"));
        for _ in 0..40 {
            let axis = numbers.below(4) as usize;
            let mut direction = [0; 3];
            if axis < 3 {
                direction[axis] = [-3, -1, 1, 2][numbers.below(4) as usize];
            }
            // As often as not on the box's border, else anywhere near it.
            let origin = [0, 1, 2].map(|i| {
                let places = [min[i], min[i] + size[i], min[i] - 3 + numbers.below(size[i] as u64 + 6)];
                places[numbers.below(3) as usize]
            });
            let is_within = |i: usize| min[i] <= origin[i] && origin[i] <= min[i] + size[i];
            let is_met = (0..3).all(|i| i == axis || is_within(i));
            let ray = Ray { origin: vector(origin), direction: vector(direction) };
            for body in &bodies {
                let found = body.entry_exit(&ray);
                assert_eq!(found.is_some(), is_met, "{body:?} {ray:?}");
                let Some((enter, exit)) = found else { continue };
                if axis == 3 {
                    still += 1;
                    assert_eq!((enter, exit), (f64::NEG_INFINITY, f64::INFINITY), "{body:?} {ray:?}");
                    continue;
                }
                let ends =
                    [min[axis], min[axis] + size[axis]].map(|c| (c - origin[axis]) as f64 / direction[axis] as f64);
                let apart = (enter - ends[0].min(ends[1])).abs().max((exit - ends[0].max(ends[1])).abs());
                assert!(apart < 1e-9, "{body:?} {ray:?}: {enter} {exit}");
                in_face += u32::from((0..3).any(|i| i != axis && [min[i], min[i] + size[i]].contains(&origin[i])));
            }
        }
    }
    assert!(in_face > 20_000 && still > 5_000, "{in_face} {still}");
}

/// Pixels of a metre, and half of one: what the rays of a parallel view lie between, in 1/32 m.
const SIZE: [u32; 2] = [128, 96];

/// How far inside an outline a place is, from its middle: only the sign counts.
type InsideBy = Box<dyn Fn(i64, i64) -> i64>;

/// Seen along z from above the cube's roof: shapes around 5, 5, whose outlines are known in 1/32 m: positive inside.
fn outlines() -> Vec<(&'static str, Shape, InsideBy)> {
    let c = DVec3::new(5.0, 5.0, 14.0);
    let disc = |r: i64| -> InsideBy { Box::new(move |x, y| r * r - x * x - y * y) };
    let rectangle = |a: i64, b: i64| -> InsideBy { Box::new(move |x: i64, y: i64| (a - x.abs()).min(b - y.abs())) };
    let m = |units: i64| units as f64 / 32.0;
    let tips = [DVec3::X, DVec3::Y, DVec3::Z].into_iter().flat_map(|a| [a, -a]);
    let half_space = |i: u32| {
        let side = |bit: u32| if i >> bit & 1 == 0 { -1.0 } else { 1.0 };
        let n = DVec3::new(side(0), side(1), side(2));
        [n.x, n.y, n.z, n.dot(c) + m(45)]
    };
    let rotation = DQuat::IDENTITY;
    vec![
        // 33² + 56² = 65²: some rays touch it.
        ("sphere", Shape::Sphere { center: c, radius: m(65) }, disc(65)),
        // Odd halves: rays within its faces.
        ("box", Shape::Box { center: c, size: DVec3::new(m(106), m(62), 3.0), rotation }, rectangle(53, 31)),
        ("cylinder along", Shape::Cylinder { center: c, radius: m(65), height: 4.0, axis: DVec3::Z }, disc(65)),
        (
            "cylinder across",
            Shape::Cylinder { center: c, radius: m(31), height: m(106), axis: DVec3::X },
            rectangle(53, 31),
        ),
        ("cone", Shape::Frustum { center: c, radius: m(65), top_radius: 0.0, height: 3.0, axis: DVec3::Z }, disc(65)),
        (
            "frustum",
            Shape::Frustum { center: c, radius: 0.5, top_radius: m(65), height: 3.0, axis: DVec3::Z },
            disc(65),
        ),
        (
            "ellipsoid",
            Shape::Ellipsoid { center: c, radii: DVec3::new(m(60), m(30), 1.0), rotation },
            Box::new(|x, y| 3600 - x * x - 4 * y * y),
        ),
        (
            "convex",
            Shape::Convex { points: tips.map(|a| c + m(45) * a).collect() },
            Box::new(|x: i64, y: i64| 45 - x.abs() - y.abs()),
        ),
        (
            "polytope",
            Shape::Polytope { planes: (0..8).map(half_space).collect() },
            Box::new(|x: i64, y: i64| 45 - x.abs() - y.abs()),
        ),
        (
            "corridor",
            Shape::Corridor { points: vec![c - DVec3::X, c + DVec3::X], width: m(62), height: 3.0 },
            Box::new(|x: i64, y: i64| {
                let beyond = (x.abs() - 32).max(0);
                31 * 31 - beyond * beyond - y * y
            }),
        ),
    ]
}

#[test]
fn pictures_along_the_axes_of_lenses_are_right_to_the_pixel() {
    let mut studio = studio::studio(&[studio::citydata("cube.city.json")]);
    // 1/16 m per pixel: all of it shows the roof.
    let camera = studio::orthographic(DVec3::new(5.0, 5.0, 30.0), DVec3::new(5.0, 5.0, 10.0), 6.0);
    let mut on_border = 0;
    for (what, shape, inside_by) in outlines() {
        let scene = studio::scene(camera, vec![painted(vec![shape])]);
        let drawn = studio::picture(&mut studio, &scene, SIZE);
        let mut behind = 0;
        for (i, &color) in drawn.rgba.iter().enumerate() {
            let (x, y) = (i as i64 % i64::from(SIZE[0]), i as i64 / i64::from(SIZE[0]));
            let by = inside_by(2 * x + 1 - i64::from(SIZE[0]), i64::from(SIZE[1]) - 2 * y - 1);
            let class = painted_class(color);
            assert!(class == Some(Class::Behind) || class == Some(Class::Rest), "{what} {x},{y}: {color:?}");
            let is_behind = class == Some(Class::Behind);
            assert!(by == 0 || is_behind == (by > 0), "{what}: {x},{y} is {class:?}, {by} inside");
            behind += u32::from(is_behind);
            on_border += u32::from(by == 0);
        }
        assert!(behind > 500, "{what}: {behind}");
    }
    assert!(on_border > 200, "{on_border}");
}
