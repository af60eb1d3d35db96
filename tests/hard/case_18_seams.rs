//! Case 18: neighbouring edges refined at different levels. Property: both sides of a seam have the same corners, to the bit; no pixel of
//! the background inside the hull. Oracle: hashes of the corners on each seam; the pixels that a slightly smaller body covers, in f64;
//! from within a closed body, all.

use std::{
    collections::BTreeMap,
    hash::{DefaultHasher, Hash, Hasher},
};

use glam::{DVec2, DVec3};
use veduta::{
    geom::deform::refine::{Limits, refined},
    lens::deform::{ControlProfile, Step},
    render::{frame::Backend, picture::Studio},
    view::Camera,
};

use crate::{
    bodies::{block, place, studio_of},
    deformed::{Bent, Mesh, Pixels, deformers, direction, distances, drawn, is_weakened, parts, shown, strong},
    lenses::{in_cube, pixels, share, view},
    oracle::Numbers,
    studio,
};

const SIZE: [u32; 2] = [320, 240];

/// Where bodies are: at zero, in Dutch and in UTM coordinates, and far beyond.
const PLACES: [DVec3; 4] = [
    DVec3::ZERO,
    DVec3::new(85_000.1, 447_000.7, 3.3),
    DVec3::new(691_607.123, 5_334_760.377, 519.9),
    DVec3::new(-1.9e7, 3.1e7, 9_000.0),
];

type Bits = [u64; 3];

fn bits(p: DVec3) -> Bits {
    p.to_array().map(f64::to_bits)
}

/// A hash of the corners along each side of each triangle, from its lower end to its upper one; by the ends of the side.
fn seams(
    positions: &[DVec3],
    triangles: &[[u32; 3]],
    lenses: &[Bent],
    px: f64,
) -> (BTreeMap<(u32, u32), Vec<u64>>, usize) {
    let deformers = deformers(lenses);
    let limits = Limits { triangles: 200_000, ..Limits::default() };
    // Finer on one side than on the other: as near and far are.
    let near = positions[0];
    let scale = |p: DVec3| 400.0 / (1.0 + p.distance(near));
    let made = refined(positions, triangles, &deformers, &scale, px, limits);
    let mut corners: Vec<Vec<(DVec3, DVec3, DVec3)>> = vec![Vec::new(); triangles.len()];
    for &i in &made.kept {
        for (k, axis) in DVec3::AXES.into_iter().enumerate() {
            let p = positions[triangles[i as usize][k] as usize];
            corners[i as usize].push((axis, p, p));
        }
    }
    for corner in &made.vertices {
        corners[corner.source as usize].push((corner.weights, corner.rest, corner.shown));
    }
    let mut all: BTreeMap<(u32, u32), Vec<u64>> = BTreeMap::new();
    let mut most = 0;
    for (t, own) in triangles.iter().zip(&corners) {
        for k in 0..3 {
            let (a, b) = (t[k], t[(k + 1) % 3]);
            // On a side the third corner counts for nothing.
            let mut on: Vec<(DVec3, Bits, Bits)> =
                own.iter().filter(|c| c.0[(k + 2) % 3] == 0.0).map(|c| (c.0, bits(c.1), bits(c.2))).collect();
            let from = if a < b { k } else { (k + 1) % 3 };
            on.sort_by(|p, q| q.0[from].total_cmp(&p.0[from]));
            most = most.max(on.len());
            let mut hasher = DefaultHasher::new();
            on.iter().for_each(|(_, rest, shown)| (rest, shown).hash(&mut hasher));
            all.entry((a.min(b), a.max(b))).or_default().push(hasher.finish());
        }
    }
    (all, most)
}

#[test]
fn both_sides_of_every_seam_have_the_same_corners() {
    let mut numbers = Numbers(618);
    let (mut compared, mut longest) = (0, 0);
    for i in 0..24 {
        let mesh = match i % 3 {
            0 => Mesh::ball(15.0, &mut numbers).halved(60, &mut numbers),
            1 => Mesh::block([9_000, 12_000, 15_000]).halved(80, &mut numbers),
            _ => Mesh::block([40_000, 500, 20_000]).halved(50, &mut numbers),
        };
        let at = PLACES[i % 4];
        let positions: Vec<DVec3> =
            mesh.corners.iter().map(|p| at + 0.001 * DVec3::from(p.map(|c| c as f64))).collect();
        // Every triangle begins with any of its corners.
        let triangles: Vec<[u32; 3]> = mesh
            .triangles
            .iter()
            .map(|t| {
                let mut t = t.map(|i| i as u32);
                t.rotate_left(numbers.below(3) as usize);
                t
            })
            .collect();
        let lenses = strong(i / 3, at, 16.0, &mut numbers);
        let (seams, most) = seams(&positions, &triangles, &lenses, 0.5);
        for (ends, hashes) in &seams {
            assert_eq!(hashes.len(), 2, "the body is closed");
            assert_eq!(hashes[0], hashes[1], "{i}: the seam between {ends:?} at {at}: {lenses:?}");
            compared += 1;
        }
        longest = longest.max(most);
    }
    assert!(compared > 3_000 && longest > 50, "{compared} seams, {longest} corners on the longest");
}

/// A lens scene's picture; `None` where a deformation would fold and is weakened.
fn depths(studio: &mut Studio, camera: Camera, lenses: &[Bent]) -> Option<(Vec<f32>, u64)> {
    let lenses = lenses.iter().enumerate().map(|(i, lens)| lens.lens(&i.to_string())).collect();
    let picture = drawn(studio, &studio::scene(camera, lenses), SIZE);
    let count = picture.statistics.frame.deformed.map_or(0, |deformed| deformed.triangles);
    (!is_weakened(&picture)).then(|| (distances(&picture).to_vec(), count))
}

/// Bodies with where they are, in millimetres: a ball, a block and a wall, all cut unevenly.
fn meshes(numbers: &mut Numbers) -> [Mesh; 3] {
    [
        Mesh::ball(15.0, numbers).halved(60, numbers),
        Mesh::block([9_000, 12_000, 15_000]).halved(80, numbers),
        Mesh::block([30_000, 3_000, 20_000]).halved(60, numbers),
    ]
}

/// How far an eye is from what is shown of a body, about.
fn clearance(eye: DVec3, faces: &[[DVec3; 3]], lenses: &[Bent]) -> f64 {
    let fine = faces.iter().flat_map(|face| parts(*face, 8));
    fine.map(|face| shown(lenses, face[0]).distance(eye)).fold(f64::INFINITY, f64::min)
}

/// A look from a place about anywhere.
fn look(eye: DVec3, numbers: &mut Numbers) -> Camera {
    let fov = [0.6, 1.2, 2.4][numbers.below(3) as usize];
    Camera { near_m: 0.02, ..Camera::looking(eye, eye + direction(numbers), fov) }
}

#[test]
fn from_within_closed_bodies_no_background_is_seen() {
    let mut numbers = Numbers(718);
    let meshes = meshes(&mut numbers);
    let mut studios = meshes.each_ref().map(|mesh| studio_of(&[mesh.body([0; 3])]));
    let (budget, mut tested, mut drawn, mut most) = (pixels(600_000), 0, 0, 0);
    let middle = place([0; 3]);
    for i in 0.. {
        if tested >= budget {
            break;
        }
        let which = i % 3;
        let lenses = strong(i / 3, middle, 18.0, &mut numbers);
        let faces = meshes[which].places([0; 3], 1.0);
        let half = [DVec3::splat(5.0), DVec3::new(6.0, 9.0, 12.0), DVec3::new(25.0, 1.5, 16.0)][which];
        let eye = shown(&lenses, middle + half * in_cube(&mut numbers));
        if clearance(eye, &faces, &lenses) < 0.4 {
            continue;
        }
        let camera = look(eye, &mut numbers);
        studios[which].backend = if i % 7 == 6 { Backend::Uber } else { Backend::Specialised };
        let Some((depths, count)) = depths(&mut studios[which], camera, &lenses) else { continue };
        let open = depths.iter().position(|d| !d.is_finite());
        assert!(open.is_none(), "{i}: pixel {open:?} of {camera:?} in {which} with {lenses:?}");
        assert!(depths.iter().all(|d| *d < 1e4), "{i}: something is far away");
        (tested, drawn, most) = (tested + depths.len() as u64, drawn + 1, most.max(count));
    }
    assert!(drawn >= 6 && most > 3_000, "{drawn} pictures, up to {most} triangles");
}

/// Pixels beside the end of a body that are not asked about.
const RIM: i64 = 3;

#[test]
fn before_the_background_no_body_has_a_hole() {
    let mut numbers = Numbers(818);
    let meshes = meshes(&mut numbers);
    let mut studios = meshes.each_ref().map(|mesh| studio_of(&[mesh.body([0; 3])]));
    let (budget, mut tested, mut refused, mut beside) = (pixels(400_000), 0, 0, 0);
    let middle = place([0; 3]);
    for i in 0.. {
        if tested >= budget {
            break;
        }
        let which = i % 3;
        let lenses = strong(i / 3, middle, 18.0, &mut numbers);
        // A look from outside at a place in it, from near and far.
        let about = middle + [5.0, 8.0, 15.0][which] * DVec3::new(1.0, 0.1, 1.0) * in_cube(&mut numbers);
        let away = 3.0 + 60.0 * share(&mut numbers).powi(2);
        let target = shown(&lenses, about);
        let eye = target + direction(&mut numbers) * away;
        let camera = Camera { near_m: 0.02, ..Camera::looking(eye, target, [0.5, 1.0, 2.0][i % 3]) };
        let Some((depths, _)) = depths(&mut studios[which], camera, &lenses) else {
            refused += 1;
            continue;
        };
        // A body of nine tenths lies in it.
        let view = view(camera, SIZE);
        let mut inner = Pixels::new(SIZE);
        for face in meshes[which].places([0; 3], 0.9) {
            // Parts of half a metre.
            let size = face[0].distance(face[1]).max(face[1].distance(face[2])).max(face[2].distance(face[0]));
            for part in parts(face, (2.0 * size).ceil().min(80.0) as u32) {
                inner.add(&view, part.map(|p| shown(&lenses, p)), 0.0);
            }
        }
        // Its own faces are looked at in parts that are straight: next to where it ends they may reach beyond what is shown.
        let deep = |i: usize| {
            let [w, h] = SIZE.map(|side| side as i64);
            let (x, y) = (i as i64 % w, i as i64 / w);
            let mut around = (-RIM..=RIM).flat_map(|dy| (-RIM..=RIM).map(move |dx| (x + dx, y + dy)));
            around.all(|(x, y)| x < 0 || y < 0 || x >= w || y >= h || inner.is_in[(y * w + x) as usize])
        };
        for (i, d) in depths.iter().enumerate().filter(|(i, _)| deep(*i)) {
            assert!(d.is_finite(), "pixel {i} of {camera:?} in {which} with {lenses:?}");
            tested += 1;
        }
        beside += depths.iter().filter(|d| !d.is_finite()).count();
    }
    assert!(beside > 20_000, "{beside} pixels of background, {refused} looks refused");
}

/// Six times the volume of what a closed mesh and a place hold between them, over the sphere: 1 inside (solid angles; van Oosterom and
/// Strackee).
fn winding(faces: &[[DVec3; 3]], at: DVec3) -> f64 {
    let angle = |face: &[DVec3; 3]| {
        let [a, b, c] = face.map(|p| p - at);
        let [x, y, z] = [a.length(), b.length(), c.length()];
        let over = x * y * z + a.dot(b) * z + b.dot(c) * x + c.dot(a) * y;
        2.0 * a.dot(b.cross(c)).atan2(over)
    };
    faces.iter().map(angle).sum::<f64>() / (4.0 * std::f64::consts::PI)
}

#[test]
fn closed_houses_of_the_town_have_no_holes() {
    let text = "veduta = 1\n[city]\nfiles = [\"builtin:town\"]\nground = false\n[sun]\nshadows = false\n";
    let options = veduta::figure::scene_file::Options::default();
    let town = veduta::figure::scene_file::parse(text, "s.toml", &options).expect("a scene");
    let mut studio = studio::of_scene(&town);
    let mut objects: BTreeMap<u32, Vec<[DVec3; 3]>> = BTreeMap::new();
    for triangle in studio::triangles(&studio) {
        objects.entry(triangle.object).or_default().push(triangle.corners);
    }
    // Those whose every edge lies between two triangles, once each way.
    let is_closed = |faces: &Vec<[DVec3; 3]>| {
        let mut edges: BTreeMap<(Bits, Bits), i32> = BTreeMap::new();
        for face in faces {
            for k in 0..3 {
                *edges.entry((bits(face[k]), bits(face[(k + 1) % 3]))).or_default() += 1;
            }
        }
        edges.iter().all(|((a, b), count)| *count == 1 && edges.get(&(*b, *a)) == Some(&1))
    };
    let houses: Vec<_> = objects.values().filter(|faces| is_closed(faces)).collect();
    assert!(houses.len() > 10, "{} closed houses of {}", houses.len(), objects.len());
    let mut numbers = Numbers(918);
    let (budget, mut tested, mut drawn) = (pixels(500_000), 0, 0);
    for i in 0..100_000 {
        if tested >= budget {
            break;
        }
        let faces = houses[numbers.below(houses.len() as u64) as usize];
        let (low, high) = faces
            .iter()
            .flatten()
            .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), p| (low.min(*p), high.max(*p)));
        let rest = low + (high - low) * (0.5 + 0.4 * in_cube(&mut numbers));
        if winding(faces, rest).abs() < 0.5 {
            continue;
        }
        let mut center = DVec3::new(5.0, 3.0, 20.0);
        let size = DVec3::new(120.0, 90.0, 40.0);
        let lens = match i % 3 {
            0 => {
                Bent::upright(center, size, vec![Step::Twist { angle: 0.35 }], ControlProfile::Smooth { border: 0.25 })
            }
            1 => {
                let steps = vec![Step::Shear { slope: DVec2::new(0.6, -0.9) }, Step::Twist { angle: 0.7 }];
                Bent::upright(center, size, steps, ControlProfile::Everywhere)
            }
            _ => {
                // A hill whose border runs through the house.
                center = rest + DVec3::new(9.0, 4.0, 0.0) * in_cube(&mut numbers);
                let lift = vec![Step::Translate { by: DVec3::Z * 60.0 * (2.0 * share(&mut numbers) - 1.0) }];
                Bent::upright(center, DVec3::new(24.0, 18.0, 40.0), lift, ControlProfile::Bump)
            }
        };
        let lenses = [lens];
        let eye = shown(&lenses, rest);
        if clearance(eye, faces, &lenses) < 1.5 {
            continue;
        }
        let camera = look(eye, &mut numbers);
        let Some((depths, _)) = depths(&mut studio, camera, &lenses) else { continue };
        let open = depths.iter().position(|d| !d.is_finite());
        assert!(open.is_none(), "{i}: pixel {open:?} of {camera:?} with {lenses:?}");
        (tested, drawn) = (tested + depths.len() as u64, drawn + 1);
    }
    assert!(drawn >= 6, "{drawn} pictures");
}

#[test]
fn walls_that_share_a_plane_leave_no_gap() {
    // Two houses wall to wall, and a plate on one of their other walls: of what is in one plane one lies over the other.
    let bodies = [
        block([-10_000, -8_000, 0], [0, 8_000, 12_000]),
        block([0, -5_000, 0], [9_000, 11_000, 10_000]),
        block([-6_000, -8_200, 3_000], [-2_000, -8_000, 7_000]),
    ];
    let quads = bodies.iter().flatten().flat_map(|f| [[f[0], f[1], f[2]], [f[0], f[2], f[3]]]);
    let faces: Vec<[DVec3; 3]> = quads.map(|t| t.map(place)).collect();
    let mut studio = studio_of(&bodies);
    let center = place([0, 0, 6_000]);
    let mut numbers = Numbers(1018);
    let (budget, mut tested, mut drawn) = (pixels(600_000), 0, 0);
    for i in 0.. {
        if tested >= budget {
            break;
        }
        let lenses = strong(i / 2, center, 16.0, &mut numbers);
        let inside = [place([-5_000, 0, 6_000]), place([4_500, 3_000, 5_000])][i % 2];
        let eye = shown(&lenses, inside + DVec3::new(3.5, 6.5, 3.5) * in_cube(&mut numbers));
        if clearance(eye, &faces, &lenses) < 0.7 {
            continue;
        }
        let camera = look(eye, &mut numbers);
        let Some((depths, _)) = depths(&mut studio, camera, &lenses) else { continue };
        let open = depths.iter().position(|d| !d.is_finite());
        assert!(open.is_none(), "{i}: pixel {open:?} of {camera:?} with {lenses:?}");
        (tested, drawn) = (tested + depths.len() as u64, drawn + 1);
    }
    assert!(drawn >= 6, "{drawn} pictures");
}
