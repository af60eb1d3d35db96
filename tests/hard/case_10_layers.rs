//! Case 10, translucent layers: eye rays along an axis through boxes, flat ones among them, and in the planes of their walls. Oracle: in
//! integers, which boxes a pixel's ray meets and where.

use glam::DVec3;
use veduta::{
    render::{
        frame::Backend,
        picture::{Aovs, Request},
    },
    scene::Transparency,
    view::Camera,
};

use crate::{
    bodies::{Body, ORIGIN, block, layers_by_all, studio_of, translucent},
    oracle::{Numbers, P3},
    studio,
};

/// 128 mm to a pixel.
const SIZE: [u32; 2] = [64, 48];
const PIXEL: i64 = 128;

/// The camera along an axis, its right and its down in the world, and millimetres of the left upper pixel's middle.
struct Along {
    camera: Camera,
    right: P3,
    down: P3,
    first: P3,
}

/// Pixels' middles are at `offset` millimetres of whole pixels.
fn along(axis: usize, sign: i64, offset: i64) -> Along {
    let unit = |axis: usize, by: i64| [0, 1, 2].map(|i| if i == axis { by } else { 0 });
    let forward = unit(axis, sign);
    // As `camera.up` = +z has it, and +y where one looks along z.
    let up = unit(if axis == 2 { 1 } else { 2 }, 1);
    let cross = |a: P3, b: P3| [0, 1, 2].map(|i| a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3]);
    let (right, down) = (cross(forward, up), up.map(|c| -c));
    let from_middle = [i64::from(SIZE[0]), i64::from(SIZE[1])].map(|side| PIXEL * (1 - side) / 2);
    // The middle of the picture is between pixels.
    let middle = [0, 1, 2].map(|i| (right[i] + down[i]) * (PIXEL / 2) + (right[i].abs() + down[i].abs()) * offset);
    let first = [0, 1, 2].map(|i| middle[i] + right[i] * from_middle[0] + down[i] * from_middle[1]);
    let metres = |p: P3| 0.001 * DVec3::from(p.map(|c| c as f64));
    let target = ORIGIN + metres(middle);
    let camera = studio::orthographic(
        target - 20.0 * metres(forward.map(|c| 1000 * c)),
        target,
        0.001 * (i64::from(SIZE[1]) * PIXEL) as f64,
    );
    Along { camera, right, down, first }
}

/// Boxes about the middle, apart, their corners on whole pixels; every other one flat.
fn boxes(numbers: &mut Numbers) -> Vec<(P3, P3)> {
    let mut all: Vec<(P3, P3)> = Vec::new();
    while all.len() < 40 {
        let low = [0; 3].map(|_: i64| PIXEL * (numbers.below(56) - 28));
        let mut size = [0; 3].map(|_: i64| PIXEL * (1 + numbers.below(12)));
        if all.len() % 2 == 1 {
            size[numbers.below(3) as usize] = 0;
        }
        let high = [0, 1, 2].map(|i| low[i] + size[i]);
        // No face lies in another's plane where both are.
        let is_apart = |(l, h): &(P3, P3)| (0..3).any(|i| h[i] < low[i] || high[i] < l[i]);
        if all.iter().all(is_apart) {
            all.push((low, high));
        }
    }
    all
}

#[test]
fn rays_along_an_axis_pass_each_box_in_two_layers() {
    let mut numbers = Numbers(210);
    let (mut met, mut deepest, mut on_border) = (0, 0, 0);
    for _ in 0..2 {
        let all = boxes(&mut numbers);
        let bodies: Vec<Body> = all.iter().map(|(low, high)| block(*low, *high)).collect();
        let mut studio = studio_of(&bodies);
        for axis in 0..3 {
            for (sign, offset) in [(1, PIXEL / 2), (-1, PIXEL / 2), (1, 0), (-1, 0)] {
                let along = along(axis, sign, offset);
                let found = layers_by_all(&mut studio, along.camera, SIZE);
                // Depths at which a ray enters and leaves boxes, millimetres before the middle; whether it is on a border.
                let rays: Vec<(Vec<i64>, bool)> = (0..(SIZE[0] * SIZE[1]) as usize)
                    .map(|i| {
                        let (x, y) = ((i % SIZE[0] as usize) as i64, (i / SIZE[0] as usize) as i64);
                        let p = [0, 1, 2].map(|k| along.first[k] + PIXEL * (x * along.right[k] + y * along.down[k]));
                        let (mut ends, mut is_on_border) = (Vec::new(), false);
                        for (low, high) in &all {
                            let others = || (0..3).filter(|&k| k != axis);
                            if others().all(|k| low[k] < p[k] && p[k] < high[k]) {
                                ends.extend([low[axis], high[axis]].map(|c| sign * c));
                            } else if others().all(|k| low[k] <= p[k] && p[k] <= high[k]) {
                                is_on_border = true;
                            }
                        }
                        ends.sort_unstable();
                        (ends, is_on_border)
                    })
                    .collect();
                for (i, ((ends, is_on_border), count)) in rays.iter().zip(&found).enumerate() {
                    let least = ends.len() as u32;
                    // Through an edge each box has two layers or none; in the plane of a wall that wall has none.
                    let is_right = if *is_on_border { *count >= least && count % 2 == 0 } else { *count == least };
                    assert!(is_right, "axis {axis} {sign}, pixel {i}: {count} layers, {least} met");
                    (met, deepest) = (met + ends.len(), deepest.max(ends.len()));
                    on_border += usize::from(*is_on_border);
                }
                // Entries and exits come in their order: the layer at which half of the light is taken.
                for (opacity, layer) in [(0.6, 0), (0.3, 1), (0.22, 2), (0.18, 3), (0.12, 5)] {
                    let scene = translucent(along.camera, opacity, Transparency::Exact);
                    let aovs = Aovs { depth: true, ..Aovs::default() };
                    let asked = Request { aovs, backend: Backend::Specialised, ..Request::plain(SIZE) };
                    let depth = studio.render(&scene, &asked).expect("a picture").depth.expect("depths");
                    for (i, (ends, _)) in rays.iter().enumerate().filter(|(_, (_, is_on_border))| !is_on_border) {
                        match ends.get(layer) {
                            None => assert_eq!(depth[i], f32::INFINITY, "pixel {i}"),
                            Some(end) => {
                                // The target is at the coordinate of the middle along the axis: 0.
                                let expected = 20.0 + 0.001 * *end as f64;
                                assert!((f64::from(depth[i]) - expected).abs() < 1e-4, "pixel {i}: {} {end}", depth[i]);
                            }
                        }
                    }
                }
            }
        }
    }
    assert!(met > 15_000 && deepest >= 8 && on_border > 2_000, "{met} {deepest} {on_border}");
}
