//! National coordinates: distances of what stands there, and a slow walk towards a wall.

use glam::{DVec2, DVec3};

use crate::{
    geom::Ray,
    measure::topics::gpu::{
        check::{Check, Findings},
        cities::{Corner, DUTCH, UTM, block, numbered, of_solids, pane, place},
        looks::{column_row, depths, middle, picture, scene, view},
        numbers::Numbers,
    },
    render::picture::{RenderError, Studio},
    view::Camera,
};

/// See the module.
pub const CHECK: Check = Check {
    name: "national coordinates",
    case: "1",
    property: "distances in Dutch and UTM coordinates err by at most 4 · 2⁻²³ · (distance + extent of the tile), and \
               steps of a millimetre never lead back",
    oracle: "boxes met by rays in f64; the walls' integers",
    unit: "pixels",
    least: 20_000,
    run,
};

const SIZE: [u32; 2] = [160, 120];
/// The distance by which rasterisers may move a corner, and more: pixels.
const ASIDE: f64 = 1.0 / 64.0;

/// Where a ray enters a box first: its parameter and which face that is on.
fn entry(ray: &Ray, [low, high]: [DVec3; 2]) -> Option<(f64, usize)> {
    let (mut enter, mut leave, mut face) = (f64::NEG_INFINITY, f64::INFINITY, 0);
    for axis in 0..3 {
        let by = ray.direction[axis];
        let ends = [low, high].map(|end| (end[axis] - ray.origin[axis]) / by);
        let [near, far] = if by < 0.0 { [ends[1], ends[0]] } else { ends };
        if near > enter {
            (enter, face) = (near, axis);
        }
        leave = leave.min(far);
    }
    (enter <= leave && enter > 0.0).then_some((enter, face))
}

/// The first thing that a ray meets: how far away, and which face of which box.
fn first(ray: &Ray, boxes: &[[DVec3; 2]]) -> Option<(f64, [usize; 2])> {
    let met = boxes.iter().enumerate().filter_map(|(i, ends)| entry(ray, *ends).map(|(t, face)| (t, [i, face])));
    met.min_by(|a, b| a.0.total_cmp(&b.0))
}

/// The largest extent of a tile along an axis, metres.
fn extent(studio: &Studio) -> f64 {
    studio.model.tiles.iter().map(|tile| tile.bounds.size().max_element()).fold(0.0, f64::max)
}

fn boxes(numbers: &mut Numbers) -> Vec<[Corner; 2]> {
    let one = |i: i64| {
        let low = [9_000 * (i % 3) + numbers.below(2_000), 9_000 * (i / 3) + numbers.below(2_000), 0];
        let size = [4_000, 4_000, 5_000].map(|least| least + numbers.below(2_500));
        [low, [0, 1, 2].map(|axis| low[axis] + size[axis])]
    };
    (0..6).map(one).collect()
}

fn run(found: &mut Findings) -> Result<(), RenderError> {
    let mut numbers = Numbers(11);
    for origin in [DUTCH, UTM] {
        let corners = boxes(&mut numbers);
        let mut studio = of_solids(origin, &numbered(corners.iter().map(|[low, high]| block(*low, *high))))?;
        let boxes: Vec<[DVec3; 2]> = corners.iter().map(|ends| ends.map(|corner| place(origin, corner))).collect();
        for _ in 0..6 {
            let middle = place(origin, [13_000, 8_000, 2_000]);
            let eye = middle + DVec3::new(-25.0 * numbers.share() - 16.0, -22.0 + 40.0 * numbers.share(), 0.1);
            ask_distances(found, &mut studio, &boxes, Camera::looking(eye, middle, 1.0))?;
        }
        walk(found, origin)?;
        if !found.goes_on() {
            break;
        }
    }
    Ok(())
}

/// Compares the distance of each pixel that shows one face, and at all places that its corners could be moved to.
fn ask_distances(
    found: &mut Findings,
    studio: &mut Studio,
    boxes: &[[DVec3; 2]],
    camera: Camera,
) -> Result<(), RenderError> {
    let drawn = picture(studio, &scene(camera, Vec::new()), SIZE)?;
    let (view, extent) = (view(camera, SIZE)?, extent(studio));
    for (i, &d) in depths(&drawn).iter().enumerate() {
        let d = f64::from(d);
        let aside = [[0.0, 0.0], [-1.0, -1.0], [-1.0, 1.0], [1.0, -1.0], [1.0, 1.0]].map(|by| ASIDE * DVec2::from(by));
        let met = aside.map(|by| first(&view.ray(middle(SIZE, i) + by), boxes));
        if met.iter().any(|hit| hit.map(|hit| hit.1) != met[0].map(|hit| hit.1)) {
            continue;
        }
        let [x, y] = column_row(SIZE, i);
        if met[0].is_none() {
            found.ask(d == f64::INFINITY, || format!("pixel {x},{y} shows something at {d} m where nothing is"));
            continue;
        }
        let ways = met.iter().flatten().map(|hit| hit.0);
        let (least, most) = ways.fold((f64::INFINITY, 0.0_f64), |(a, b), t| (a.min(t), b.max(t)));
        let allowed = 4.0 * 2_f64.powi(-23) * (most + extent);
        found.ask((least - allowed..=most + allowed).contains(&d), || {
            format!("pixel {x},{y} from {}: {d} m, not {least} to {most} m", camera.eye)
        });
    }
    Ok(())
}

/// Towards a wall by a millimetre a picture, through several whole metres.
fn walk(found: &mut Findings, origin: DVec3) -> Result<(), RenderError> {
    let mut studio = of_solids(origin, &numbered([pane(12_000, [-50_000, -50_000], [50_000, 50_000])]))?;
    let (wall, extent) = (place(origin, [12_000, 0, 0]), extent(&studio));
    let mut last = f64::INFINITY;
    for step in 0..300 {
        let away = 9.5 - 0.001 * f64::from(step) - if step >= 150 { 4.0 } else { 0.0 };
        let eye = DVec3::new(wall.x - away, wall.y + 0.4, wall.z + 1.7);
        let drawn = picture(&mut studio, &scene(Camera::looking(eye, eye + DVec3::X, 0.8), Vec::new()), [8, 6])?;
        let nearest = depths(&drawn).iter().fold(f32::INFINITY, |d, other| d.min(*other));
        let farthest = depths(&drawn).iter().fold(0.0_f32, |d, other| d.max(*other));
        let (nearest, farthest) = (f64::from(nearest), f64::from(farthest));
        let allowed = 4.0 * 2_f64.powi(-23) * (away + extent);
        let exact = wall.x - eye.x;
        let is_right = (nearest - exact).abs() <= allowed && (farthest - exact).abs() <= allowed && farthest < last;
        found.ask(is_right, || format!("step {step}: {nearest} to {farthest} m, not {exact} m; before that {last} m"));
        last = nearest;
    }
    Ok(())
}
