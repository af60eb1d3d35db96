//! Case 12, translucent layers: bodies of slivers of 1 mm × 1 km, and triangles with corners behind the eye: as case 11, and nothing
//! beside the outline. Oracle: the outline of the convex body in f64.

use glam::{DVec3, Vec3Swizzles as _};
use veduta::{
    geom::Aabb,
    view::{Camera, View},
};

use crate::{
    bodies::{Body, METHODS, ORIGIN, Outline, layers, layers_by_all, middle, place, studio_of},
    oracle::{Numbers, P3},
    studio,
};

const KILOMETRE: i64 = 1_000_000;

/// A beam 1 km long whose roof and floor are `count` slivers of 1 mm: their corners are those of the faces at its ends.
pub fn beam(count: i64, height: i64) -> Body {
    let at = |x: i64, y: i64, z: i64| [x, y * KILOMETRE / 2, z * height];
    let mut faces: Body = Vec::new();
    for i in 0..count {
        faces.push(vec![at(i, -1, 1), at(i + 1, -1, 1), at(i + 1, 1, 1), at(i, 1, 1)]);
        faces.push(vec![at(i, -1, 0), at(i, 1, 0), at(i + 1, 1, 0), at(i + 1, -1, 0)]);
    }
    for (y, turns) in [(-1, false), (1, true)] {
        let floor = (0..=count).map(|i| at(i, y, 0));
        let roof = (0..=count).rev().map(|i| at(i, y, 1));
        let mut end: Vec<P3> = floor.chain(roof).collect();
        if turns {
            end.reverse();
        }
        faces.push(end);
    }
    faces.push(vec![at(0, -1, 0), at(0, -1, 1), at(0, 1, 1), at(0, 1, 0)]);
    faces.push(vec![at(count, -1, 0), at(count, 1, 0), at(count, 1, 1), at(count, -1, 1)]);
    faces
}

/// A cone of `count` slivers about the z axis, 1 km high; 1 to 3 mm wide at its foot. The last foot is where the first is.
fn needle(count: i64) -> Body {
    let foot = |i: i64| -> P3 {
        let angle = std::f64::consts::TAU * (i % count) as f64 / count as f64;
        let radius = count as f64 * 0.3;
        [(radius * angle.cos()).round() as i64, (radius * angle.sin()).round() as i64, -KILOMETRE / 2]
    };
    let mut faces: Body = (0..count).map(|i| vec![foot(i), foot(i + 1), [0, 0, KILOMETRE / 2]]).collect();
    faces.push((0..count).rev().map(foot).collect());
    faces
}

/// What each pixel may have: two layers within the outline, or one where the eye is inside; none beside it. Returns how many pixels are
/// within and how many beside it.
fn check(found: &[u32], view: &View, corners: &[DVec3], (inside, closest): (bool, f64), what: &str) -> [usize; 2] {
    let outline = Outline::of(view, corners);
    // Corners are put on a grid of 1/256 pixel, and are where they are to 2⁻²³ of the distance and the extent (case 1).
    let rim = 0.02 + 2.0 * f64::from(f32::EPSILON) * 1500.0 / view.pixel_m(closest);
    let mut seen = [0, 0];
    for (i, count) in found.iter().enumerate() {
        let by = outline.inside_by(middle(view.size, i));
        let expected = if inside { 1 } else { 2 };
        // What is thinner than an adapter's grid folds on it, which adds layers two by two.
        let is_right = match by {
            _ if studio::snapping() > 0.0 && (inside || by > rim) => *count >= expected && (count - expected) % 2 == 0,
            _ if inside => *count == 1,
            by if by > rim => *count == expected,
            by if by < -rim => *count == 0,
            _ => count % 2 == 0,
        };
        assert!(is_right, "{what}, pixel {i}: {count} layers, {by} inside the outline");
        seen[0] += usize::from(inside || by > rim);
        seen[1] += usize::from(!inside && by < -rim);
    }
    seen
}

/// Eyes, targets and fields of view: far away, close to the body with its ends behind the eye, within it.
fn looks(numbers: &mut Numbers, bodies_middle: DVec3, along: DVec3, reach: f64) -> Vec<(DVec3, DVec3, f64)> {
    let mut share = || (numbers.below(2001) - 1000) as f64 / 1000.0;
    let mut all = Vec::new();
    for i in 0..36 {
        let aside = DVec3::new(share(), share(), share());
        let on = bodies_middle + along * (480.0 * share());
        let eye = match i % 3 {
            0 => on + (aside - along * along.dot(aside)).normalize_or(DVec3::Z) * 300.0 * share().abs().max(0.1),
            1 => on + (aside - along * along.dot(aside)).normalize_or(DVec3::Z) * reach * (2.0 + 4.0 * share().abs()),
            _ => on,
        };
        let towards = match i % 4 {
            0 => on + along * (30.0 * share()),
            1 => bodies_middle + along * (500.0 * share().signum()),
            2 => eye + DVec3::new(share(), share(), share()),
            _ => on + aside.yzx() * reach,
        };
        if eye.distance(towards) > 1e-3 {
            all.push((eye, towards, [0.05, 0.8, 2.4][(i / 3) % 3]));
        }
    }
    all
}

#[test]
fn slivers_and_what_is_behind_the_eye_are_passed_once_and_fill_nothing_else() {
    let mut numbers = Numbers(212);
    let bodies = [
        ("200 slivers", beam(200, 300), DVec3::Y, DVec3::new(0.1, 0.0, 0.15), 0.2),
        ("one sliver", beam(1, 1), DVec3::Y, DVec3::new(0.0005, 0.0, 0.0005), 0.05),
        ("needle", needle(48), DVec3::Z, DVec3::ZERO, 0.05),
    ];
    let size = [96, 72];
    let mut seen = [0, 0];
    for (what, body, along, inner, reach) in bodies {
        let mut corners: Vec<P3> = body.iter().flatten().copied().collect();
        corners.sort_unstable();
        corners.dedup();
        let places: Vec<DVec3> = corners.iter().map(|p| place(*p)).collect();
        let mut studio = studio_of(&[body]);
        for (i, (eye, target, fov)) in looks(&mut numbers, ORIGIN + inner, along, reach).into_iter().enumerate() {
            let is_inside = i % 3 == 2 && what == "200 slivers";
            if i % 3 == 2 && !is_inside {
                continue;
            }
            let camera = Camera { near_m: 1e-3, ..Camera::looking(eye, target, fov) };
            let view = View::new(camera, size, &Aabb::EMPTY).expect("a view");
            let method = METHODS[i % METHODS.len()];
            let found = layers(&mut studio, camera, size, method);
            let what = format!("{what}, {method:?} from {eye} to {target}, {fov}");
            let closest =
                if i % 3 == 0 { reach.max((eye - ORIGIN - inner).cross(along).length() - reach) } else { reach };
            let [within, beside] = check(&found, &view, &places, (is_inside, closest), &what);
            seen = [seen[0] + within, seen[1] + beside];
        }
    }
    assert!(seen.iter().all(|count| *count > 50_000), "{seen:?}");
}

#[test]
fn all_methods_lay_slivers_alike() {
    let mut studio = studio_of(&[beam(200, 300)]);
    let eye = ORIGIN + DVec3::new(0.1, -3.0, 1.1);
    let camera = Camera { near_m: 0.01, ..Camera::looking(eye, eye + DVec3::new(0.0, 1.0, -0.3), 0.8) };
    let found = layers_by_all(&mut studio, camera, [160, 120]);
    let met = found.iter().filter(|count| **count == 2).count();
    let at_rim = found.iter().filter(|count| **count > 2).count();
    assert!(met > 1_000 && at_rim == 0, "{met} {at_rim}");
}
