//! Case 25, volumes: what a ray meets of a field is its integral, sorted among what is opaque and what is seen through, and along bent rays; projections
//! and surfaces are those of closed forms. Oracle: integrals in f64 along rays that are followed through every triangle.

use std::path::PathBuf;

use glam::{DMat3, DVec2, DVec3};
use rayon::prelude::*;
use veduta::{
    geom::Shape,
    lens::{EffectUse, Lens, Parameter, Region, color::linear_from_srgb},
    render::{
        frame::Backend,
        picture::{Aovs, Request, Studio},
    },
    scene::{
        BaseStyle, Scene, Style, Volume,
        volume::{RAMP_ENTRIES, Slice, VolumeMode},
    },
    view::{Camera, Projection, View},
};

use crate::{
    case_27_bent_rays::{Bent, Piece, Sight, cameras, first, magnifier, magnify, met, path, plain_ray},
    studio::{
        self,
        volumes::{in_box, written},
    },
};

/// Of a layer that has the opacities of the ramp, metres: as `studio::volumes` has it.
const THICKNESS: f64 = 10.0;
const SIZE: [u32; 2] = [120, 80];
const GRID: [usize; 3] = [17, 13, 9];
/// How far beside a pixel's ray something else may be met where that pixel is left out, pixels: as case 27 has it.
const EDGE_PX: f64 = 1e-2;
/// Of one cell of the walk: f32's rounding, and an exponential right to 2^-22.
const OF_CELL: f64 = 1.0 / 1_048_576.0;

/// A field and its values in f64.
struct Known {
    volume: Volume,
    value: fn(DVec3) -> f64,
    low: DVec3,
    high: DVec3,
}

fn constant(_: DVec3) -> f64 {
    0.5
}

fn linear(p: DVec3) -> f64 {
    0.1 + 0.3 * p.x + 0.25 * p.y + 0.3 * p.z
}

/// A ball, as far as samples tell: its radius is 0.45 of the box.
fn ball(p: DVec3) -> f64 {
    (1.0 - p.distance(DVec3::splat(0.5)) / 0.45).max(0.0)
}

/// What a field is between its samples, linearly.
fn between_samples(value: fn(DVec3) -> f64, p: DVec3) -> f64 {
    let cells = DVec3::from_array(GRID.map(|n| (n - 1) as f64));
    let at = (p * cells).clamp(DVec3::ZERO, cells);
    let low = at.floor().min(cells - 1.0);
    let share = at - low;
    let corner = |i: u32| {
        let odd = DVec3::new((i & 1).into(), (i >> 1 & 1).into(), (i >> 2).into());
        let weight = (odd * share + (1.0 - odd) * (1.0 - share)).element_product();
        // As the file has it.
        weight * f64::from(value((low + odd) / cells) as f32)
    };
    (0..8).map(corner).sum()
}

fn sampled_ball(p: DVec3) -> f64 {
    between_samples(ball, p)
}

/// The box that fields stand in: around the middle of the city, into the ground.
fn place(studio: &Studio) -> [DVec3; 2] {
    let middle = studio.extent().center();
    [middle - DVec3::new(45.0, 40.0, 18.0), middle + DVec3::new(40.0, 35.0, 30.0)]
}

fn known(studio: &Studio, name: &str, value: fn(DVec3) -> f64, opacity: &[f32]) -> Known {
    let [low, high] = place(studio);
    let share = |at: [usize; 3]| DVec3::from_array([0, 1, 2].map(|i| at[i] as f64 / (GRID[i] - 1) as f64));
    let file: PathBuf = written(name, GRID, |at| value(share(at)) as f32);
    Known { volume: in_box(&file, GRID, low, high, opacity), value, low, high }
}

impl Known {
    /// What the entries of the ramp make of a value: extinction, 1 / metres.
    fn extinction(&self, entries: &[[f32; 4]], value: f64) -> f64 {
        let at = value.clamp(0.0, 1.0) * (RAMP_ENTRIES - 1) as f64;
        let low = (at.floor() as usize).min(RAMP_ENTRIES - 2);
        let [a, b] = [entries[low][3], entries[low + 1][3]].map(f64::from);
        a + (b - a) * (at - low as f64)
    }

    /// Where a place of the city is in it, shares of its sides.
    fn share(&self, world: DVec3) -> DVec3 {
        (world - self.low) / (self.high - self.low)
    }

    /// From which to which parameter a line is in it.
    fn span(&self, origin: DVec3, direction: DVec3) -> [f64; 2] {
        let (from, along) = (self.share(origin), direction / (self.high - self.low));
        let mut span = [f64::NEG_INFINITY, f64::INFINITY];
        for i in 0..3 {
            let ends = [(0.0 - from[i]) / along[i], (1.0 - from[i]) / along[i]];
            span = [span[0].max(ends[0].min(ends[1])), span[1].min(ends[0].max(ends[1]))];
        }
        span
    }
}

/// A picture's rays in the city's space.
struct Eye {
    sight: Sight,
    to_world: DMat3,
    eye: DVec3,
    near: f64,
}

impl Eye {
    fn new(studio: &Studio, camera: Camera) -> Self {
        let view = View::new(camera, SIZE, &studio.extent()).expect("a view");
        let to_world = view.basis.view_from_world().transpose();
        Self { sight: Sight::new(studio, camera, SIZE), to_world, eye: camera.eye, near: camera.near_m }
    }

    /// Pieces of a path from view space, in the city's.
    fn in_city(&self, pieces: &[Piece]) -> Vec<Piece> {
        pieces.iter().map(|(range, o, d)| (*range, self.eye + self.to_world * *o, self.to_world * *d)).collect()
    }

    /// How far what is opaque is in a picture, parameters of paths; `None` where another thing is as near as an edge. That the distance is right is told by
    /// case 27.
    fn opaque(&self, depths: &[f32], i: usize, path_of: &dyn Fn(DVec2) -> Vec<Piece>) -> Option<f64> {
        let pixel = self.sight.pixel(i);
        let at = |x: f64, y: f64| {
            let pieces = path_of(self.sight.place(pixel + EDGE_PX * DVec2::new(x, y)));
            first(&self.sight.faces, &pieces, self.near).map(|(object, _)| object)
        };
        let sides = [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)];
        let middle = at(0.0, 0.0);
        let is_alike = sides.into_iter().all(|(x, y)| at(x, y) == middle) && middle.is_some() == depths[i].is_finite();
        is_alike.then_some(depths[i].into())
    }

    /// All that a straight ray meets, in order, and how far each may be off for the adapter's grid; `None` where it is as near as an edge to meeting
    /// other things.
    fn layers(&self, i: usize, path_of: &dyn Fn(DVec2) -> Vec<Piece>) -> Option<Vec<[f64; 2]>> {
        let pixel = self.sight.pixel(i);
        let at = |x: f64, y: f64| {
            let pieces = path_of(self.sight.place(pixel + EDGE_PX * DVec2::new(x, y)));
            let mut met = met(&self.sight.faces, &pieces, self.near);
            met.sort_by(f64::total_cmp);
            met
        };
        let middle = at(0.0, 0.0);
        let sides = [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0)].map(|(x, y)| at(x, y));
        let off = |k: usize| sides.iter().map(|side| (side[k] - middle[k]).abs()).fold(0.0, f64::max);
        let is_alike = sides.iter().all(|side| side.len() == middle.len());
        is_alike.then(|| (0..middle.len()).map(|k| [middle[k], off(k)]).collect())
    }
}

/// The optical depth between two parameters of a path, by so many steps of each stretch in the field: metres are those of the path.
fn optical_depth(known: &Known, entries: &[[f32; 4]], pieces: &[Piece], from: f64, until: f64, step: f64) -> f64 {
    let mut sum = 0.0;
    for (range, origin, direction) in pieces {
        let span = known.span(*origin, *direction);
        let low = span[0].max(range[0]).max(from);
        let high = span[1].min(range[1]).min(until);
        if low >= high {
            continue;
        }
        let metres = direction.length();
        let steps = ((high - low) * metres / step).ceil().max(1.0);
        let own = (high - low) / steps;
        let at = |i: f64| (known.value)(known.share(*origin + (low + (i + 0.5) * own) * *direction));
        let mean: f64 = (0..steps as u32).map(|i| known.extinction(entries, at(i.into()))).sum();
        sum += mean * own * metres;
    }
    sum
}

fn scene_with(camera: Camera, lenses: Vec<Lens>, volume: &Volume) -> Scene {
    // Without air before what is far away.
    let plain = studio::scene(camera, lenses);
    let style = Style { base: BaseStyle::Clay, ..plain.style.clone() };
    Scene { volumes: vec![volume.clone()], style, ..plain }
}

/// What is right at a pixel: how much light a volume of one colour gives, what is let through, and how far both may be off for where layers are.
type Right = [f64; 3];

/// The largest error over all pixels of what is let through and of its colour, beyond what may be off, and how many pixels were compared. `right` is
/// told how far what is opaque is.
fn compare(
    studio: &mut Studio,
    scene: &Scene,
    known: &Known,
    right: impl Fn(usize, &[f32], &[[f32; 4]]) -> Option<Right> + Sync,
) -> (f64, usize) {
    let aovs = Aovs { depth: true, ..Aovs::default() };
    let depths =
        studio.render(scene, &Request { aovs, ..Request::plain(SIZE) }).expect("a picture").depth.expect("depths");
    let found = studio.transparency(scene, SIZE).expect("a picture");
    let entries = known.volume.transfer.entries([0.0, 1.0], THICKNESS);
    let blue = f64::from(linear_from_srgb(known.volume.transfer.colors[0])[2]);
    let errors: Vec<f64> = (0..found.len())
        .into_par_iter()
        .filter_map(|i| {
            let [light, through, slack] = right(i, &depths, &entries)?;
            let [_, _, b, t] = found[i].map(f64::from);
            Some((t - through).abs().max((b - blue * light).abs()) - slack)
        })
        .collect();
    (errors.iter().copied().fold(0.0, f64::max), errors.len())
}

fn straight(eye: &Eye) -> impl Fn(DVec2) -> Vec<Piece> + Sync + '_ {
    |place| {
        let (origin, direction) = plain_ray(place, eye.sight.is_parallel);
        vec![([0.0, f64::INFINITY], origin, direction)]
    }
}

#[test]
fn what_a_ray_meets_is_the_integral() {
    let mut studio = studio::synthetic(40);
    let fields = [
        known(&studio, "constant", constant, &[0.3, 0.3]),
        known(&studio, "linear", linear, &[0.0, 0.4]),
        // Nothing is seen of half of it: cells begin where something is.
        known(&studio, "half", linear, &[0.0, 0.0, 0.4]),
        // Bent between its samples, and nothing around it.
        known(&studio, "ball", sampled_ball, &[0.0, 0.4]),
    ];
    for (f, field) in fields.into_iter().enumerate() {
        for (c, camera) in cameras(&studio).into_iter().enumerate() {
            let eye = Eye::new(&studio, camera);
            let mut off = Vec::new();
            for step in [1.0, 0.25] {
                let own = Known { volume: Volume { step, ..field.volume.clone() }, ..field };
                let scene = scene_with(camera, Vec::new(), &own.volume);
                let (error, count) = compare(&mut studio, &scene, &own, |i, depths, entries| {
                    let of = straight(&eye);
                    let until = eye.opaque(depths, i, &of)?;
                    let pieces = eye.in_city(&of(eye.sight.place(eye.sight.pixel(i))));
                    let through = (-optical_depth(&own, entries, &pieces, eye.near, until, 0.02)).exp();
                    Some([1.0 - through, through, 0.0])
                });
                assert!(count > 5000, "{count} pixels");
                off.push(error);
            }
            println!("field {f}, eye {c}: off by {:.1e}, with finer steps {:.1e}", off[0], off[1]);
            // A ray has at most 100 cells of 3 m, four times as many finer ones.
            let most = [100.0, 400.0].map(|cells| cells * OF_CELL);
            match f {
                0 => assert!(off[0] < most[0] && off[1] < most[1], "eye {c}: {off:?}"),
                // A ramp bends between its entries: what cells make of that falls with the square of their length.
                1 => assert!(off[0] < 1e-4 && off[1] < 1e-4 / 8.0 + OF_CELL, "eye {c}: {off:?}"),
                // And where it begins to rise there is a bend that a cell does not see.
                2 => assert!(off[0] < 1e-3 && off[1] < 1e-3 / 8.0 + OF_CELL, "eye {c}: {off:?}"),
                // As there is at each of its samples.
                _ => assert!(off[0] < 5e-3 && off[1] < 5e-3 / 8.0 + OF_CELL, "eye {c}: {off:?}"),
            }
        }
    }
}

#[test]
fn volumes_are_sorted_among_what_is_seen_through() {
    let mut studio = studio::synthetic(40);
    let field = known(&studio, "sorted", constant, &[0.3, 0.3]);
    let middle = studio.extent().center();
    const OPACITY: f64 = 0.3;
    // Surfaces are black, so that all light is the volume's. What makes them translucent thins the volume out by as much.
    let parameters =
        |all: &[(&str, Parameter)]| all.iter().map(|(name, value)| ((*name).to_owned(), value.clone())).collect();
    let used =
        |effect: &str, all: &[(&str, Parameter)]| EffectUse { parameters: parameters(all), ..studio::used(effect) };
    let clear =
        used("transparent", &[("opacity", Parameter::Number(OPACITY)), ("keep_terrain", Parameter::Boolean(false))]);
    let black = used("clay", &[("color", Parameter::Text("#000000".into()))]);
    let around = Region::Shape(Shape::Sphere { center: middle, radius: 400.0 });
    let all = Lens { effects: vec![clear, black], ..studio::lens("all", [around], "clay") };
    for (c, camera) in cameras(&studio).into_iter().enumerate() {
        let eye = Eye::new(&studio, camera);
        let scene = scene_with(camera, vec![all.clone()], &field.volume);
        let (error, count) = compare(&mut studio, &scene, &field, |i, _, entries| {
            let of = straight(&eye);
            let layers = eye.layers(i, &of)?;
            let pieces = eye.in_city(&of(eye.sight.place(eye.sight.pixel(i))));
            let (mut light, mut through, mut at, mut slack) = (0.0, 1.0, eye.near, 0.0);
            let densest = entries.iter().map(|entry| f64::from(entry[3])).fold(0.0, f64::max);
            for [until, off] in layers.into_iter().chain([[f64::INFINITY, 0.0]]) {
                slack += through * OPACITY * densest * off;
                let left = (-OPACITY * optical_depth(&field, entries, &pieces, at, until, 0.5)).exp();
                light += through * (1.0 - left);
                through *= left * if until.is_finite() { 1.0 - OPACITY } else { 1.0 };
                at = until;
            }
            Some([light, through, slack])
        });
        println!("eye {c}: {count} pixels, off by {error:.1e}");
        // As many cells, and layers between them.
        assert!(count > 4000 && error < 200.0 * OF_CELL, "eye {c}: {count} pixels, off by {error:.1e}");
    }
}

#[test]
fn bent_rays_go_through_volumes() {
    let mut studio = studio::synthetic(40);
    let field = known(&studio, "bent", constant, &[0.3, 0.3]);
    for (c, camera) in cameras(&studio).into_iter().enumerate() {
        let eye = Eye::new(&studio, camera);
        let view = View::new(camera, SIZE, &studio.extent()).expect("a view");
        for ray in [magnify(2.5, 100.0, 100.0, 0.4), magnify(0.7, 60.0, 140.0, 0.8)] {
            let bent = Bent::new(&ray, &view);
            let of = |place| path(&bent, place, eye.sight.is_parallel);
            let scene = scene_with(camera, vec![magnifier(ray)], &field.volume);
            let (error, count) = compare(&mut studio, &scene, &field, |i, depths, entries| {
                let until = eye.opaque(depths, i, &of)?;
                let pieces = eye.in_city(&of(eye.sight.place(eye.sight.pixel(i))));
                let through = (-optical_depth(&field, entries, &pieces, eye.near, until, 0.5)).exp();
                Some([1.0 - through, through, 0.0])
            });
            println!("eye {c}: {count} pixels, off by {error:.1e}");
            assert!(count > 5000 && error < 200.0 * OF_CELL, "eye {c}: {count} pixels, off by {error:.1e}");
        }
    }
}

#[test]
fn projections_and_surfaces_are_those_of_closed_forms() {
    let mut studio = studio::synthetic(40);
    let field = known(&studio, "projected", linear, &[0.0, 0.8]);
    const LEVEL: f64 = 0.55;
    const PLANE: Slice = Slice { axis: 1, at: 0.3 };
    let modes = [
        VolumeMode::Maximum,
        VolumeMode::Minimum,
        VolumeMode::Average,
        VolumeMode::Isosurface,
        VolumeMode::XRay,
        VolumeMode::Slice,
    ];
    for (c, camera) in cameras(&studio).into_iter().enumerate() {
        let eye = Eye::new(&studio, camera);
        for mode in modes {
            let level = (mode == VolumeMode::Isosurface).then_some(LEVEL);
            let own =
                Known { volume: Volume { mode, level, slice: PLANE, step: 0.25, ..field.volume.clone() }, ..field };
            let scene = scene_with(camera, Vec::new(), &own.volume);
            let (error, count) = compare(&mut studio, &scene, &own, |i, depths, entries| {
                let of = straight(&eye);
                let until = eye.opaque(depths, i, &of)?;
                let pieces = eye.in_city(&of(eye.sight.place(eye.sight.pixel(i))));
                let (_, origin, direction) = pieces[0];
                let [low, high] = own.span(origin, direction);
                let (low, high) = (low.max(eye.near), high.min(until));
                let of_value = |value: f64| (-THICKNESS * own.extinction(entries, value)).exp();
                if low >= high {
                    return Some([0.0, 1.0, 0.0]);
                }
                if mode == VolumeMode::Slice {
                    let [from, along] = [own.share(origin), direction / (own.high - own.low)];
                    let t = (PLANE.at - from.y) / along.y;
                    let place = from + t * along;
                    let sides = [
                        place.x,
                        1.0 - place.x,
                        place.z,
                        1.0 - place.z,
                        (t - eye.near) * along.length(),
                        (until - t) * along.length(),
                    ];
                    // One that ends at a side, or at what is opaque, may be seen or not.
                    if sides.iter().any(|side| side.abs() < 1e-4) {
                        return None;
                    }
                    let through = if sides.iter().all(|side| *side > 0.0) { of_value(linear(place)) } else { 1.0 };
                    return Some([1.0 - through, through, 0.0]);
                }
                let ends = [low, high].map(|t| linear(own.share(origin + t * direction)));
                let through = match mode {
                    VolumeMode::Maximum => of_value(ends[0].max(ends[1])),
                    VolumeMode::Minimum => of_value(ends[0].min(ends[1])),
                    VolumeMode::Average => of_value(0.5 * (ends[0] + ends[1])),
                    VolumeMode::XRay => (-optical_depth(&own, entries, &pieces, eye.near, until, 0.02)).exp(),
                    // A surface that ends with the ray may be seen or not.
                    _ if ends.iter().any(|value| (value - LEVEL).abs() < 1e-4) => return None,
                    _ if (ends[0] < LEVEL) == (ends[1] < LEVEL) => 1.0,
                    _ => of_value(LEVEL),
                };
                let light = if mode == VolumeMode::XRay { 0.0 } else { 1.0 - through };
                Some([light, through, 0.0])
            });
            println!("eye {c}, {mode:?}: {count} pixels, off by {error:.1e}");
            let most = match mode {
                // The first and the last cell are looked at in their middles: at most half a step of 1.3 m from the ends, where values change by 0.01 a
                // metre and opacities by 0.8 of that.
                VolumeMode::Maximum | VolumeMode::Minimum => 6e-3,
                VolumeMode::XRay => 2e-5,
                _ => 2e-6,
            };
            assert!(count > 5000 && error < most, "eye {c}, {mode:?}: {count} pixels, off by {error:.1e}");
        }
    }
}

/// Where f32 tells distances apart only by metres, walks with finer steps than these end, and what they lay is right but for where the field begins and
/// ends.
#[test]
fn walks_end_far_from_the_eye() {
    let mut studio = studio::synthetic(40);
    let field = known(&studio, "far", constant, &[0.3, 0.3]);
    let middle = studio.extent().center();
    let near = Camera::looking(middle + DVec3::new(300.0, -600.0, 500.0), middle, 0.8);
    let direction = (near.eye - middle).normalize_or(DVec3::X);
    for distance in [1e5, 1e6, 1e7] {
        let eye = middle + distance * direction;
        let camera =
            Camera { projection: Projection::Orthographic { height_m: 160.0 }, ..Camera::looking(eye, middle, 0.8) };
        let eye = Eye::new(&studio, camera);
        // From one distance in f32 to the next.
        let unit = f64::from((distance as f32).next_up() - distance as f32);
        for mode in [VolumeMode::Direct, VolumeMode::Maximum] {
            let own = Known { volume: Volume { mode, step: 0.01, ..field.volume.clone() }, ..field };
            let scene = scene_with(camera, Vec::new(), &own.volume);
            let (error, count) = compare(&mut studio, &scene, &own, |i, depths, entries| {
                let of = straight(&eye);
                let until = eye.opaque(depths, i, &of)?;
                let pieces = eye.in_city(&of(eye.sight.place(eye.sight.pixel(i))));
                let depth = optical_depth(&own, entries, &pieces, eye.near, until, 1.0);
                let [low, high] = own.span(pieces[0].1, pieces[0].2);
                let extinction = own.extinction(entries, 0.5);
                let off = 4.0 * unit * extinction;
                let through = match mode {
                    VolumeMode::Maximum if depth > off => (-THICKNESS * extinction).exp(),
                    // One that ends at a side, or at what is opaque, may be seen or not.
                    VolumeMode::Maximum if high.min(until) - low > -4.0 * unit => return None,
                    _ => (-depth).exp(),
                };
                Some([1.0 - through, through, if mode == VolumeMode::Maximum { 0.0 } else { off }])
            });
            println!("from {distance:.0e} m, {mode:?}: {count} pixels, off by {error:.1e}");
            // As many cells as there can be where distances are told apart so badly, at most.
            assert!(
                count > 4000 && error < 100.0 * OF_CELL,
                "from {distance:.0e} m, {mode:?}: {count} pixels, off by {error:.1e}"
            );
        }
    }
}

#[test]
fn volumes_of_which_nothing_is_seen_change_no_byte() {
    let mut studio = studio::synthetic(40);
    let field = known(&studio, "unseen", linear, &[0.0, 0.0]);
    let away = Volume { origin: Some(field.low + DVec3::new(0.0, 0.0, 900.0)), ..field.volume.clone() };
    let seen = known(&studio, "hidden", linear, &[0.5, 0.5]).volume;
    let invisible = Volume { visible: false, ..seen };
    for camera in cameras(&studio) {
        for backend in [Backend::Specialised, Backend::Uber] {
            let request = Request { samples: 2, aovs: studio::ALL, backend, ..Request::plain(SIZE) };
            let mut draw = |scene: &Scene| studio.render(scene, &request).expect("a picture");
            let without = Scene { volumes: Vec::new(), ..scene_with(camera, Vec::new(), &field.volume) };
            let plain = draw(&without);
            for volume in [&field.volume, &away, &invisible] {
                let found = draw(&scene_with(camera, Vec::new(), volume));
                assert!(found.rgba == plain.rgba && found.object_id == plain.object_id, "{volume:?}");
            }
        }
    }
}
