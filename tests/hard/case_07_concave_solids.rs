//! Case 7: lenses of concave solids that touch and cross themselves, whose surface a ray crosses up to 40 times: a pixel is in
//! the lens where the winding number about the shown place is not 0. Oracle: the winding number as the solid angle of all
//! faces, in f64, rounded to the whole number that it is.

use std::{f64::consts::TAU, fmt::Write as _, path::PathBuf};

use glam::{DQuat, DVec2, DVec3};
use veduta::{
    geom::Ray,
    lens::Region,
    render::{frame::Backend, picture::Request},
    view::Camera,
};

use crate::{lenses::view, oracle::Numbers, studio};

const SIZE: [u32; 2] = [128, 96];

type Faces = Vec<[DVec3; 3]>;

fn quad([a, b, c, d]: [DVec3; 4]) -> [[DVec3; 3]; 2] {
    [[a, b, c], [a, c, d]]
}

/// A tube of this radius around the curve, closed after one round.
fn tube(rings: usize, sides: usize, radius: f64, curve: impl Fn(f64) -> DVec3) -> Faces {
    let corner = |i: usize, j: usize| {
        let t = (i % rings) as f64 / rings as f64;
        let along = curve(t + 1e-4) - curve(t - 1e-4);
        // The curves are level enough for a frame that stands upright.
        let out = along.cross(DVec3::Z).try_normalize().expect("a curve that is not upright");
        let up = out.cross(along).try_normalize().expect("a curve that is not upright");
        let angle = TAU * (j % sides) as f64 / sides as f64;
        (curve(t) + radius * (angle.cos() * out + angle.sin() * up)).as_vec3().as_dvec3()
    };
    let cells = (0..rings).flat_map(|i| (0..sides).map(move |j| (i, j)));
    cells.flat_map(|(i, j)| quad([corner(i, j), corner(i, j + 1), corner(i + 1, j + 1), corner(i + 1, j)])).collect()
}

/// What stands over a ring of corners between two heights; its fan may overlap itself, and then counts as often.
fn standing(ring: &[DVec2], [low, high]: [f64; 2]) -> Faces {
    let at = |i: usize, z: f64| ring[i % ring.len()].extend(z).as_vec3().as_dvec3();
    let mut faces = Faces::new();
    for i in 0..ring.len() {
        faces.extend(quad([at(i, low), at(i + 1, low), at(i + 1, high), at(i, high)]));
        faces.push([at(0, high), at(i, high), at(i + 1, high)]);
        faces.push([at(0, low), at(i + 1, low), at(i, low)]);
    }
    faces.retain(|[a, b, c]| a != b && b != c && c != a);
    faces
}

fn polar(r: f64, turns: f64) -> DVec2 {
    r * DVec2::from_angle(TAU * turns)
}

/// Around the origin, about a unit in size.
fn solids() -> Vec<(&'static str, Faces)> {
    let star: Vec<DVec2> = (0..14).map(|i| polar(if i % 2 == 0 { 1.0 } else { 0.35 }, f64::from(i) / 14.0)).collect();
    // Every second point of five: the middle is gone around twice.
    let pentagram: Vec<DVec2> = (0..5).map(|i| polar(1.0, 0.4 * f64::from(i))).collect();
    // Nine arms that meet in one point.
    let arm = |i: i32| {
        let at = |r: f64, aside: f64| polar(r, (f64::from(i) + aside) / 9.0);
        [DVec2::ZERO, at(0.6, -0.2), at(1.0, 0.0), at(0.6, 0.2)]
    };
    let touching: Vec<DVec2> = (0..9).flat_map(arm).collect();
    // Twenty walls: a ray along x crosses forty faces.
    let comb: Vec<DVec2> = (0..20)
        .flat_map(|i| {
            let x = 0.1 * f64::from(i) - 1.0;
            [[x, -0.8], [x, 0.8], [x + 0.05, 0.8], [x + 0.05, -0.7]].map(DVec2::from)
        })
        .chain([[1.0, -0.7], [1.0, -0.8]].map(DVec2::from))
        .collect();
    let circle = |t: f64| polar(0.8, t).extend(0.0);
    let mut tori = tube(32, 16, 0.25, circle);
    tori.extend(tube(32, 16, 0.25, |t| circle(t) + DVec3::new(0.5, 0.1, 0.15)));
    // Thick enough to go through itself in the middle.
    let eight = |t: f64| DVec3::new(0.8 * (TAU * t).sin(), 0.6 * (2.0 * TAU * t).sin(), 0.1 * (TAU * t).cos());
    vec![
        ("torus", tube(40, 20, 0.3, circle)),
        ("star", standing(&star, [-0.5, 0.5])),
        ("pentagram", standing(&pentagram, [-0.5, 0.5])),
        ("star that touches itself", standing(&touching, [-0.5, 0.5])),
        ("comb of 20 walls", standing(&comb, [-0.6, 0.6])),
        ("two tori that cross", tori),
        ("eight that crosses itself", tube(60, 12, 0.22, eight)),
    ]
}

fn written(faces: &Faces) -> String {
    let mut out = String::from("o solid\n");
    for p in faces.iter().flatten() {
        let _ = writeln!(out, "v {} {} {}", p.x, p.y, p.z);
    }
    for i in 0..faces.len() {
        let _ = writeln!(out, "f {} {} {}", 3 * i + 1, 3 * i + 2, 3 * i + 3);
    }
    out
}

/// The sum of the solid angles of the faces about a place, in full turns (van Oosterom and Strackee, 1983).
fn winding(faces: &Faces, p: DVec3) -> f64 {
    let angle = |[a, b, c]: &[DVec3; 3]| {
        let (a, b, c) = (*a - p, *b - p, *c - p);
        let (x, y, z) = (a.length(), b.length(), c.length());
        2.0 * a.dot(b.cross(c)).atan2(x * y * z + a.dot(b) * z + b.dot(c) * x + c.dot(a) * y)
    };
    faces.iter().map(angle).sum::<f64>() / (2.0 * TAU)
}

fn crossings(faces: &Faces, ray: &Ray) -> usize {
    let is_met = |[a, b, c]: &&[DVec3; 3]| {
        let side = |a: DVec3, b: DVec3| ray.direction.dot((a - ray.origin).cross(b - ray.origin));
        let sides = [side(*a, *b), side(*b, *c), side(*c, *a)];
        sides.iter().all(|s| *s > 0.0) || sides.iter().all(|s| *s < 0.0)
    };
    faces.iter().filter(is_met).count()
}

#[test]
fn concave_lenses_hold_what_their_surface_goes_around() {
    let mut studio = studio::synthetic(40);
    let extent = studio.extent();
    let house = studio.model.geometries[studio.geometries[studio.geometries.len() / 2] as usize].bounds;
    let mut numbers = Numbers(7);
    let folder = std::env::temp_dir().join(format!("veduta-case-07-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a temporary folder");
    let (mut most_crossings, mut doubly) = (0, 0);
    for (name, faces) in solids() {
        let file: PathBuf = folder.join(format!("{}.obj", name.replace(' ', "-")));
        std::fs::write(&file, written(&faces)).expect("a temporary file");
        let (mut inside, mut asked, mut between) = (0, 0, 0);
        for round in 0..3 {
            let scale = [1.0, 0.3, 0.12][round] * extent.size().truncate().max_element();
            let turn = |numbers: &mut Numbers| numbers.below(1 << 20) as f64 * 6e-6;
            let tilt = if round == 0 { 0.0 } else { turn(&mut numbers) };
            let rotation = DQuat::from_rotation_z(turn(&mut numbers)) * DQuat::from_rotation_x(tilt);
            let at = if round == 0 { extent.center() } else { house.center() };
            let lens = studio::lens("solid", [Region::Mesh { file: file.clone(), at, rotation, scale }], "sepia");
            let volume = &lens.shapes[0].volumes().expect("a solid")[0];
            let own = |p: DVec3| rotation.conjugate() * (p - at) / scale;
            let distance = [0.9, 1.6, 0.6][round] * scale;
            let eyes = [DVec3::new(-0.9, -0.7, 0.5), DVec3::new(0.1, -0.2, 1.2), DVec3::new(1.0, 0.0, 0.08)];
            for eye in eyes.map(|e| at + distance * e) {
                let camera = Camera::looking(eye, at, 1.0);
                let view = view(camera, SIZE);
                let scene = studio::scene(camera, vec![lens.clone()]);
                let mut masks = Vec::new();
                for backend in [Backend::Specialised, Backend::Uber] {
                    let aovs = studio::ALL;
                    let request = Request { aovs, backend, ..Request::plain(SIZE) };
                    let drawn = studio.render(&scene, &request).expect("a picture");
                    masks.push((studio::bits(&drawn, 0), drawn.depth.expect("depth")));
                }
                assert!(masks[0] == masks[1], "{name}: the back ends differ");
                let (bits, depth) = &masks[0];
                for (i, d) in depth.iter().enumerate().filter(|(_, d)| d.is_finite()) {
                    let ray = view.pixel_ray(i as u32 % SIZE[0], i as u32 / SIZE[0]);
                    let p = ray.at(f64::from(*d));
                    let turns = winding(&faces, own(p));
                    let whole = turns.round();
                    let d = f64::from(*d);
                    let band = 8.0 * 2_f64.powi(-23) * d.max(at.distance(eye))
                        + 1e-6 * scale
                        + 2.0 * studio::off_face(&view, d);
                    if (turns - whole).abs() > 1e-6 || volume.signed_distance(p).abs() <= band {
                        continue;
                    }
                    assert_eq!(
                        bits[i],
                        whole != 0.0,
                        "{name}, round {round}, eye {eye}: pixel {i} at {p}, {turns} turns"
                    );
                    asked += 1;
                    inside += u32::from(bits[i]);
                    doubly += u32::from(whole.abs() > 1.5);
                    between += u32::from(
                        whole == 0.0 && volume.bounds().min.cmplt(p).all() && volume.bounds().max.cmpgt(p).all(),
                    );
                    if i % 16 == 0 {
                        let ray = Ray { origin: own(ray.origin), direction: rotation.conjugate() * ray.direction };
                        most_crossings = most_crossings.max(crossings(&faces, &ray));
                    }
                }
            }
        }
        assert!(asked > 30_000 && inside > 1_000 && between > 1_000, "{name}: {inside} of {asked}, {between} between");
    }
    std::fs::remove_dir_all(folder).expect("the temporary folder");
    assert!(most_crossings >= 16 && doubly > 100, "{most_crossings} crossings, {doubly} doubly inside");
}
