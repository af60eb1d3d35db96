//! Case 1: national coordinates, eye at street height. The camera-relative error per axis is at most
//! 2⁻²³ · (distance + extent of the object's tile), and a slow pan moves every vertex monotonically. Oracle: f64 on
//! the file's own figures; the code under test is the shader's arithmetic in its f32 twin, step by step.

use glam::DVec3;
use veduta::render::eye::{relative_to_eye, split_eye};

use crate::{oracle::Numbers, studio};

#[test]
fn vertices_near_the_eye_are_right_to_the_tile() {
    let studio = studio::studio(&[studio::citydata("crs-rd.city.json"), studio::citydata("crs-utm.city.json")]);
    let model = &studio.model;
    let mut numbers = Numbers(11);
    let mut tried = 0;
    for tile in &model.tiles {
        let extent = tile.bounds.size().max_element();
        for vertex in tile.vertices.clone() {
            let world = model.position(tile, vertex);
            for _ in 0..200 {
                let offset = [0, 1, 2].map(|_| numbers.below(2_000_001) as f64 * 1e-4 - 100.0);
                let eye = world + DVec3::from(offset);
                let (whole, fraction) = split_eye(eye);
                let position = model.vertices[vertex as usize].position;
                let found = relative_to_eye(tile.origin.to_array(), position, whole, fraction);
                let exact = world - eye;
                let allowed = 2_f64.powi(-23) * (exact.length() + extent);
                for axis in 0..3 {
                    let error = (f64::from(found[axis]) - exact[axis]).abs();
                    assert!(error <= allowed, "{error} m off at {world}, seen from {eye}");
                }
                tried += 1;
            }
        }
    }
    assert!(tried > 1000);
}

#[test]
fn a_slow_pan_never_moves_a_vertex_back() {
    let origin = [85_000, 446_000, -3];
    let mut numbers = Numbers(5);
    for _ in 0..200 {
        let offset = [0, 1, 2].map(|_| numbers.below(64_000) as f32 * 1e-3);
        let start = DVec3::new(85_013.4, 446_021.7, 1.7);
        let mut last = f32::INFINITY;
        for step in 0..2000 {
            // A tenth of a millimetre per frame, through several whole metres.
            let eye = start + DVec3::X * f64::from(step) * 1e-3;
            let (whole, fraction) = split_eye(eye);
            let [x, ..] = relative_to_eye(origin, offset, whole, fraction);
            assert!(x <= last, "moved back by {} at step {step}", x - last);
            last = x;
        }
    }
}
