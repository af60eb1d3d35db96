//! Case 12, faces that are seen edge on: rasterisers cover pixels beside them, whose middle is in the plane of the face far before or
//! behind it. Property: what is shown of a body is no nearer and no farther than its corners, and where faces are not edge on, it is where
//! they are. Oracle: the corners, and rays through the bodies, in f64.

use std::f64::consts::{FRAC_PI_2, TAU};

use glam::{DVec2, DVec3};
use veduta::{
    geom::{Ray, Shape},
    lens::deform::{ControlProfile, Step},
    render::picture::{Picture, Studio},
    scene::{Scene, Transparency},
    view::Camera,
};

use crate::{
    bodies::{Body, ORIGIN, middle, place, studio_of, translucent},
    deformed::{Bent, drawn},
    lenses::{share, view},
    oracle::{Numbers, P3},
    studio,
};

const SIZE: [u32; 2] = [240, 160];
/// Metres that a picture is high.
const HEIGHT_M: f64 = 150.0;
/// How far depths are rounded: 2⁻²² of the kilometre between near and far.
const ROOM_M: f64 = 1e-3;
/// Corners of each tower.
const SIDES: usize = 12;
/// How many towers there are from west to east, and from south to north.
const ACROSS: [usize; 2] = [16, 11];

/// A tower with upright walls: its lower ring, its upper one.
fn tower(at: [i64; 2], radius: i64, from: i64, to: i64) -> [Vec<P3>; 2] {
    [from, to].map(|z| {
        let corner = |i: usize| {
            let angle = TAU * (i as f64 + 0.31) / SIDES as f64;
            let [x, y] = [angle.cos(), angle.sin()].map(|s| (radius as f64 * s).round() as i64);
            [at[0] + x, at[1] + y, z]
        };
        (0..SIDES).map(corner).collect()
    })
}

fn towers() -> Vec<[Vec<P3>; 2]> {
    let mut numbers = Numbers(12_012);
    let places = (0..ACROSS[0]).flat_map(|x| (0..ACROSS[1]).map(move |y| [x, y]));
    let tower = |[x, y]: [usize; 2]| {
        let at = [14_000 * x as i64 - 105_000, 14_000 * y as i64 - 70_000];
        tower(at, 3_000 + numbers.below(3_500), -numbers.below(20_000), 60_000 + numbers.below(140_000))
    };
    places.map(tower).collect()
}

fn body([low, high]: &[Vec<P3>; 2]) -> Body {
    let mut faces = vec![low.iter().rev().copied().collect(), high.clone()];
    faces.extend((0..SIDES).map(|i| {
        let next = (i + 1) % SIDES;
        vec![low[i], low[next], high[next], high[i]]
    }));
    faces
}

/// Views along walls: straight down and up, slightly beside that, and level along walls of all towers.
fn cameras(numbers: &mut Numbers) -> Vec<Camera> {
    let middle = ORIGIN + DVec3::Z * 60.0;
    let mut all = Vec::new();
    for i in 0..12 {
        let aside =
            [0.0, 1e-6, 1e-5, 1e-4, 1e-3, 4e-3][i % 6] * DVec3::new(share(numbers) - 0.5, share(numbers) - 0.5, 0.0);
        let beside = DVec3::new(share(numbers), share(numbers), 0.0) * 20.0;
        let away = if i % 4 == 3 { -DVec3::Z } else { DVec3::Z };
        all.push(Camera {
            up: DVec3::Y,
            ..studio::orthographic(middle + beside + (away + aside) * 300.0, middle + beside, HEIGHT_M)
        });
    }
    for i in 0..6 {
        // The sides of a tower of twelve lie in these directions.
        let along = TAU * (0.31 + 0.5 + i as f64) / SIDES as f64 + FRAC_PI_2 + 1e-5 * (share(numbers) - 0.5);
        let target = middle + DVec3::new(share(numbers), share(numbers), 0.0) * 20.0;
        all.push(studio::orthographic(target + 300.0 * DVec3::new(along.cos(), along.sin(), 0.0), target, HEIGHT_M));
    }
    for i in 0..4 {
        // In the plane of a wall, straight above it.
        let [low, _] = &towers()[40 * i + 3];
        let on = place(low[i]).midpoint(place(low[i + 1])).with_z(ORIGIN.z);
        all.push(Camera { up: DVec3::Y, ..Camera::looking(on + DVec3::Z * 260.0, on, 0.6) });
    }
    all
}

/// What the corners of each tower, moved by `value`, are away along the view.
fn ranges(camera: Camera, corners: &[Vec<DVec3>], value: impl Fn(DVec3) -> DVec3) -> Vec<[f64; 2]> {
    let view = view(camera, SIZE);
    let range = |corners: &Vec<DVec3>| {
        let depths = corners.iter().map(|p| view.depth(value(*p)));
        depths.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], d| [low.min(d), high.max(d)])
    };
    corners.iter().map(range).collect()
}

/// How many pixels show a tower, and how many of them where it is not.
fn strayed(picture: &Picture, ranges: &[[f64; 2]]) -> [usize; 2] {
    let (ids, depths) = (picture.object_id.as_ref().expect("ids"), picture.depth.as_ref().expect("depths"));
    let mut found = [0; 2];
    for (id, depth) in ids.iter().zip(depths).filter(|(id, _)| **id != 0) {
        let [low, high] = ranges[*id as usize - 1];
        let is_there = (low - ROOM_M..=high + ROOM_M).contains(&f64::from(*depth));
        found = [found[0] + 1, found[1] + usize::from(!is_there)];
    }
    found
}

#[test]
fn what_is_seen_edge_on_is_where_its_corners_are() {
    let all = towers();
    let mut studio = studio_of(&all.iter().map(body).collect::<Vec<_>>());
    let corners: Vec<Vec<DVec3>> = all.iter().map(|rings| rings.concat().into_iter().map(place).collect()).collect();
    let center = ORIGIN + DVec3::Z * 90.0;
    let lifted = Bent::upright(
        center,
        DVec3::new(400.0, 400.0, 400.0),
        vec![Step::Translate { by: DVec3::new(3.0, 2.0, 15.0) }],
        ControlProfile::Everywhere,
    );
    let mut wrong = Vec::new();
    for kind in [Kind::Alone, Kind::BehindHiding, Kind::Layers, Kind::Lifted] {
        let mut numbers = Numbers(512);
        let (mut shown, mut stray) = (0, 0);
        for camera in cameras(&mut numbers) {
            let ranges = ranges(camera, &corners, |p| if kind == Kind::Lifted { lifted.value(p) } else { p });
            let [own, off] = strayed(&drawn(&mut studio, &kind.scene(camera, &lifted), SIZE), &ranges);
            (shown, stray) = (shown + own, stray + off);
        }
        assert!(shown > 100_000, "{kind:?}: {shown} pixels");
        wrong.extend((stray > 0).then(|| format!("{kind:?}: {stray} of {shown} pixels are where no corner is")));
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    let all: Vec<Solid> = all.iter().map(Solid::new).collect();
    let compared: usize = (0..4).map(|i| exact(&mut studio, &all, i)).sum();
    assert!(compared > 40_000, "{compared} pixels");
}

/// A place in each face of a tower, and its normal outwards; the middle, and what is around that.
struct Solid {
    faces: Vec<[DVec3; 2]>,
    middle: DVec3,
    radius: f64,
}

impl Solid {
    fn new([low, high]: &[Vec<P3>; 2]) -> Self {
        let mut faces = vec![[place(low[0]), -DVec3::Z], [place(high[0]), DVec3::Z]];
        faces.extend((0..SIDES).map(|i| {
            let [a, b] = [low[i], low[(i + 1) % SIDES]].map(place);
            [a, (b - a).cross(DVec3::Z)]
        }));
        let middle = place(low[0]).midpoint(place(high[SIDES / 2]));
        let radius = low.iter().chain(high).map(|p| place(*p).distance(middle)).fold(0.0, f64::max);
        Self { faces, middle, radius }
    }

    /// How far along a ray it is entered, metres.
    fn entry(&self, ray: &Ray) -> Option<f64> {
        let to_middle = self.middle - ray.origin;
        if to_middle.reject_from(ray.direction).length() > self.radius {
            return None;
        }
        let (mut from, mut to) = (f64::NEG_INFINITY, f64::INFINITY);
        for [at, outward] in &self.faces {
            let (speed, room) = (ray.direction.dot(*outward), (*at - ray.origin).dot(*outward));
            if speed < 0.0 {
                from = from.max(room / speed);
            } else if speed > 0.0 {
                to = to.min(room / speed);
            } else if room < 0.0 {
                to = f64::NEG_INFINITY;
            }
        }
        (from < to).then_some(from)
    }
}

/// Holds depths of a view at a slant to rays about the middle of each pixel; how many.
fn exact(studio: &mut Studio, all: &[Solid], number: usize) -> usize {
    let turn = 1.3 + 1.7 * number as f64;
    let away = DVec3::new(turn.cos(), turn.sin(), [0.4, 0.9, 1.6, -0.7][number]) * 260.0;
    let target = ORIGIN + DVec3::Z * 60.0;
    let camera = studio::orthographic(target + away, target, HEIGHT_M);
    let view = view(camera, SIZE);
    let picture = drawn(studio, &studio::scene(camera, vec![]), SIZE);
    let depths = picture.depth.as_ref().expect("depths");
    let mut compared = 0;
    for (i, depth) in depths.iter().enumerate() {
        let entries: Vec<_> = [[0.0, 0.0], [-0.02, -0.02], [0.02, -0.02], [-0.02, 0.02], [0.02, 0.02]]
            .into_iter()
            .map(|aside| {
                let ray = view.ray(middle(SIZE, i) + DVec2::from(aside));
                let met = all.iter().enumerate().filter_map(|(tower, solid)| Some((solid.entry(&ray)?, tower)));
                met.min_by(|a, b| a.0.total_cmp(&b.0))
            })
            .collect();
        let Some((_, tower)) = entries[0] else { continue };
        let Some(ts) = entries.iter().map(|e| e.filter(|e| e.1 == tower).map(|e| e.0)).collect::<Option<Vec<f64>>>()
        else {
            continue;
        };
        let [low, high] =
            ts.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], t| [low.min(*t), high.max(*t)]);
        compared += 1;
        let is_there = (low - ROOM_M..=high + ROOM_M).contains(&f64::from(*depth));
        assert!(is_there, "view {number}, pixel {i}: {depth} m, not {low} to {high}");
    }
    compared
}

/// What is shown of the towers.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Alone,
    BehindHiding,
    Layers,
    Lifted,
}

impl Kind {
    fn scene(self, camera: Camera, lifted: &Bent) -> Scene {
        match self {
            Self::Alone => studio::scene(camera, vec![]),
            Self::BehindHiding => {
                let ball = Shape::Sphere { center: ORIGIN + DVec3::new(30.0, 10.0, 150.0), radius: 70.0 };
                studio::scene(camera, vec![studio::lens("hides", [ball], "eraser")])
            }
            Self::Layers => translucent(camera, 0.6, Transparency::Exact),
            Self::Lifted => studio::scene(camera, vec![lifted.lens("lifted")]),
        }
    }
}
