//! Case 11, translucent layers: through shared edges and corners of closed bodies nothing leaks and nothing is laid twice: entries and
//! exits alternate. Oracle: in integers, on which side of each edge of a convex body a pixel's ray passes; in perspective, outlines in f64.

use glam::{DVec2, DVec3};
use veduta::{
    geom::Aabb,
    scene::Transparency,
    view::{Camera, View},
};

use crate::{
    bodies::{Body, METHODS, ORIGIN, Outline, block, layers, layers_by_all, middle, place, studio_of},
    oracle::{Numbers, P3},
    studio,
};

/// An octahedron of `6 * size`, each face in 36 triangles; its corners are shared, and every one is at whole multiples of `size`.
fn octahedron(center: P3, size: i64) -> Body {
    let n = 6;
    let mut faces = Vec::new();
    for signs in 0..8_u32 {
        let at = |i: i64, j: i64| -> P3 {
            let p = [i * size, j * size, (n - i - j) * size];
            [0, 1, 2].map(|k| center[k] + if signs >> k & 1 == 0 { p[k] } else { -p[k] })
        };
        for i in 0..n {
            for j in 0..n - i {
                let mut split = vec![vec![at(i, j), at(i + 1, j), at(i, j + 1)]];
                if i + j + 1 < n {
                    split.push(vec![at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
                }
                // All of them look outwards.
                let is_mirrored = signs.count_ones() % 2 == 1;
                faces.extend(split.into_iter().map(|mut face| {
                    if is_mirrored {
                        face.reverse();
                    }
                    face
                }));
            }
        }
    }
    faces
}

/// Millimetres of a corner of the octahedra's net, and of a pixel: every other row and column of pixels is on it.
const SIZE: i64 = 256;
const PIXEL: i64 = 128;

#[test]
fn rays_through_corners_and_edges_of_closed_bodies_pass_each_surface_once() {
    // Three, one behind the other and beside each other, that do not touch.
    let centers = [[0, 0, 0], [-2 * SIZE, 3200, SIZE], [3 * SIZE, 6400, -2 * SIZE]];
    let mut studio = studio_of(&centers.map(|center| octahedron(center, SIZE)));
    let size = [64, 48];
    let height = 0.001 * (i64::from(size[1]) * PIXEL) as f64;
    let (mut through, mut at_rim) = (0, 0);
    // Which axes go right and up, and where the eye is on the third.
    for (right, up, eye) in [(0, 2, -DVec3::Y), (0, 1, DVec3::Z), (1, 2, DVec3::X)] {
        // Pixels' middles on the net, and 1 mm aside of it.
        for aside in [0, 1] {
            let half = 0.001 * (PIXEL / 2 + aside) as f64;
            let mut target = ORIGIN;
            target[right] += half;
            target[up] += half;
            let camera = studio::orthographic(target + 30.0 * eye, target, height);
            let found = layers_by_all(&mut studio, camera, size);
            for (i, count) in found.iter().enumerate() {
                let (x, y) = ((i % 64) as i64, (i / 64) as i64);
                let at = [PIXEL * (x - 31) + aside, PIXEL * (24 - y) + aside];
                // How far inside each outline, |x| + |y| < 6 size.
                let inside = centers.map(|c| 6 * SIZE - (at[0] - c[right]).abs() - (at[1] - c[up]).abs());
                let least = 2 * inside.iter().filter(|by| **by > 0).count() as u32;
                let rims = inside.iter().filter(|by| **by == 0).count() as u32;
                // On its rim a body is passed in two layers or none.
                let is_right = (least..=least + 2 * rims).contains(count) && count % 2 == 0;
                assert!(is_right, "{eye} {aside}, pixel {x},{y}: {count} layers, {least} and {rims} rims");
                (through, at_rim) = (through + least, at_rim + rims);
            }
        }
    }
    assert!(through > 5_000 && at_rim > 100, "{through} {at_rim}");
}

/// Checks that a convex body is passed in `inside` layers within its outline and in none beside it; how many pixels are within.
fn check(found: &[u32], size: [u32; 2], outline: &Outline, inside: u32, what: &str) -> usize {
    let mut within = 0;
    for (i, count) in found.iter().enumerate() {
        let by = outline.inside_by(middle(size, i));
        // Corners are put on a grid of 1/256 pixel.
        let is_right = if by > 0.02 { *count == inside } else { by > -0.02 || *count == 0 };
        assert!(is_right && (inside == 1 || count % 2 == 0), "{what}, pixel {i}: {count} layers, {by} inside");
        within += usize::from(by > 0.02);
    }
    within
}

#[test]
fn rays_through_corners_and_edges_pass_each_surface_once_in_perspective() {
    let body = octahedron([0; 3], 997);
    let mut corners: Vec<P3> = body.iter().flatten().copied().collect();
    corners.sort_unstable();
    corners.dedup();
    let places: Vec<DVec3> = corners.iter().map(|p| place(*p)).collect();
    let mut studio = studio_of(&[body]);
    // Odd sides: the middle of a pixel is in the middle of the picture.
    let size = [81, 61];
    let mut numbers = Numbers(311);
    let mut within = [0, 0];
    for round in 0..60 {
        let target = places[numbers.below(places.len() as u64) as usize];
        let is_inside = round % 2 == 0;
        // In the body, or 1 to 40 m before one of its corners.
        let aside = DVec3::from([0; 3].map(|_: i64| (numbers.below(2001) - 1000) as f64 / 1000.0));
        let eye = if is_inside {
            ORIGIN + 1.5 * aside
        } else {
            let outwards = (target - ORIGIN + 3.0 * aside).normalize_or(DVec3::Z);
            target + outwards * (4.0 + numbers.below(36) as f64)
        };
        if eye.distance(target) < 0.5 {
            continue;
        }
        let camera = Camera { near_m: 0.01, ..Camera::looking(eye, target, [0.02, 0.9, 2.2][round % 3]) };
        let view = View::new(camera, size, &Aabb::EMPTY).expect("a view");
        let outline = Outline::of(&view, &places);
        let method = METHODS[round % METHODS.len()];
        let found = layers(&mut studio, camera, size, method);
        // From inside one layer, wherever one looks: the outline, behind the eye too, is not asked.
        if is_inside {
            assert!(found.iter().all(|count| *count == 1), "{round}: {:?}", found.iter().find(|c| **c != 1));
            within[0] += found.len();
        } else {
            within[1] += check(&found, size, &outline, 2, &format!("{round} {method:?}"));
        }
    }
    assert!(within.iter().all(|count| *count > 50_000), "{within:?}");
}

#[test]
fn bodies_that_share_walls_edges_and_corners_are_passed_one_after_the_other() {
    // 27 boxes; their walls lie in each other's planes, and most are there twice.
    let cut = [-4001, -1333, 1210, 4999];
    let all = (0..3).flat_map(|x| (0..3).flat_map(move |y| (0..3).map(move |z| [x, y, z])));
    let bodies: Vec<Body> = all.map(|at: [usize; 3]| block(at.map(|i| cut[i]), at.map(|i| cut[i + 1]))).collect();
    let mut studio = studio_of(&bodies);
    let size = [80, 60];
    let mut numbers = Numbers(411);
    let mut sums = [0; 20];
    for round in 0..24 {
        // Onto a corner in the middle; from outside.
        let corner = [0; 3].map(|_: i64| cut[numbers.below(4) as usize]);
        let aside =
            DVec3::from([0; 3].map(|_: i64| (numbers.below(2001) - 1000) as f64 / 1000.0)).normalize_or(DVec3::Z);
        let camera = Camera::looking(place(corner) + 22.0 * aside, place(corner), 0.9);
        let view = View::new(camera, size, &Aabb::EMPTY).expect("a view");
        let found = layers(&mut studio, camera, size, Transparency::Exact);
        for (i, count) in found.iter().enumerate() {
            let ray = view.pixel_ray(i as u32 % size[0], i as u32 / size[0]);
            // Boxes that the ray meets: between two cuts of each axis. Near a line of two cuts it may be one more or less.
            let at = |t: f64| 1000.0 * (ray.origin + t * ray.direction - ORIGIN);
            let mut ends: Vec<f64> = Vec::new();
            for axis in 0..3 {
                ends.extend(cut.map(|c| (ORIGIN[axis] + 0.001 * c as f64 - ray.origin[axis]) / ray.direction[axis]));
            }
            ends.sort_by(f64::total_cmp);
            let is_in = |p: DVec3| (0..3).all(|k| (cut[0] as f64) < p[k] && p[k] < cut[3] as f64);
            let boxes = ends.windows(2).filter(|w| is_in(at(w[0].midpoint(w[1])))).count();
            // How near the ray comes to a line where two cuts meet, along the third axis.
            let from_edge = |axis: usize, a: i64, b: i64| {
                let of = |v: DVec3| DVec2::new(v[(axis + 1) % 3], v[(axis + 2) % 3]);
                let way = of(ray.direction);
                (0.001 * DVec2::new(a as f64, b as f64) - of(ray.origin - ORIGIN)).perp_dot(way).abs() / way.length()
            };
            let mut edges = (0..3).flat_map(|axis| cut.map(|a| cut.map(|b| from_edge(axis, a, b)))).flatten();
            let in_doubt = edges.any(|distance| distance < 0.02 * view.pixel_m(30.0));
            assert_eq!(count % 2, 0, "view {round}, pixel {i}");
            assert!(in_doubt || *count == 2 * boxes as u32, "view {round}, pixel {i}: {count} layers, {boxes} boxes");
            sums[usize::min(*count as usize, 19)] += u32::from(!in_doubt);
        }
    }
    assert!(sums[6] > 1000 && sums[10] > 500, "{sums:?}");
}
