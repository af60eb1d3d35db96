use proptest::prelude::*;

use super::*;
use crate::{
    geom::Aabb,
    view::{Camera, Projection},
};

const PICTURE: [u32; 2] = [640, 360];
const FOV: f64 = 0.8;
const EM: f32 = 13.0;

fn view(camera: Camera, size: [u32; 2]) -> View {
    View::new(camera, size, &Aabb { min: DVec3::splat(-500.0), max: DVec3::splat(500.0) }).unwrap()
}

/// From the south of the origin, 100 m away, level.
fn from_south(height_m: f64) -> View {
    view(Camera::looking(DVec3::new(0.0, -100.0, height_m), DVec3::new(0.0, 0.0, height_m), FOV), PICTURE)
}

/// A board of 240 × 160, above something of 10 m at the origin.
fn board_of(view: &View, call_out: &CallOut) -> Option<Board> {
    let above = Above { place: DVec3::new(0.0, 0.0, 5.0), heights_m: [0.0, 10.0] };
    board(view, call_out, &above, |s| [240.0, 160.0].map(|side: f64| (side * s).round().max(1.0) as u32), EM)
}

/// Where in the overlay a pixel lies, shares of its width and height; and its w.
fn on_overlay(board: &Board, pixel: DVec2) -> (DVec2, f64) {
    let piece = board.piece(0);
    let at = pixel - DVec2::new(piece.low[0].into(), piece.low[1].into());
    let [x, y, w] = piece.rows.map(|row| row.map(f64::from)).map(|[a, b, c]| a * at.x + b * at.y + c);
    let [image, size] = [board.image_size(), board.size].map(|s| DVec2::new(s[0].into(), s[1].into()));
    ((DVec2::new(x, y) / w * image - f64::from(board.margin)) / size, w)
}

fn upright(width_m: f64) -> CallOut {
    CallOut { height_m: Some(10.0), width_m: Some(width_m), tilt: 0.0 }
}

#[test]
fn one_that_faces_the_viewer_has_the_size_of_its_distance() {
    // 24 m by 16 m from 20 m on, seen from the height of its middle, 100 m away.
    let board = board_of(&from_south(28.0), &upright(24.0)).unwrap();
    let f = 180.0 / (0.5 * FOV).tan();
    let (half_w, half_h) = (f * 12.0 / 100.0, f * 8.0 / 100.0);
    assert!((board.depth - 100.0).abs() < 1e-9);
    assert!((board.foot.unwrap() - DVec2::new(320.0, 180.0 + half_h)).length() < 1e-9);
    for (u, v) in [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0), (0.3, 0.8)] {
        let pixel = DVec2::new(320.0 + (2.0 * u - 1.0) * half_w, 180.0 + (2.0 * v - 1.0) * half_h);
        let (found, w) = on_overlay(&board, pixel);
        assert!((found - DVec2::new(u, v)).length() < 1e-4 && (w - 1.0).abs() < 1e-4, "{found} at ({u}, {v})");
    }
    let around = |low: f64, high: f64| (low.floor() as i32, high.ceil() as i32);
    let (x, y) = (around(320.0 - half_w, 320.0 + half_w), around(180.0 - half_h, 180.0 + half_h));
    assert_eq!(board.seen, Rect { min: [x.0, y.0], max: [x.1, y.1] });
    // Its image has about as many pixels, and a few more.
    let wide = f64::from(board.size[0]) / (2.0 * half_w);
    assert!((1.0..1.4).contains(&wide), "{wide}");
}

#[test]
fn a_tilted_one_is_a_trapezoid() {
    let tilt = 0.7_f64;
    let seen = from_south(60.0);
    let board = board_of(&seen, &CallOut { tilt, ..upright(24.0) }).unwrap();
    let f = 180.0 / (0.5 * FOV).tan();
    let high_m = 24.0 * f64::from(board.size[1]) / f64::from(board.size[0]);
    for v in [0.0, 0.25, 1.0] {
        // The upper edge lies as much farther away as it is tilted.
        let (up, away) = ((1.0 - v) * high_m * tilt.cos(), (1.0 - v) * high_m * tilt.sin());
        let depth = 100.0 + away;
        for u in [0.0, 0.5, 1.0] {
            let pixel = DVec2::new(320.0 + f * (u - 0.5) * 24.0 / depth, 180.0 - f * (20.0 + up - 60.0) / depth);
            let (found, w) = on_overlay(&board, pixel);
            assert!((found - DVec2::new(u, v)).length() < 1e-4, "{found} at ({u}, {v})");
            assert!((w - (100.0 + 0.5 * high_m * tilt.sin()) / depth).abs() < 1e-4, "w is one over the distance");
        }
    }
}

#[test]
fn without_a_width_it_is_as_wide_in_the_picture_as_the_overlay() {
    for distance in [20.0, 100.0, 3000.0] {
        let eye = DVec3::new(-0.6 * distance, -0.8 * distance, 10.0);
        let seen = view(Camera::looking(eye, DVec3::new(0.0, 0.0, 10.0), FOV), PICTURE);
        let board = board_of(&seen, &CallOut { height_m: Some(0.0), width_m: None, tilt: 0.0 }).unwrap();
        assert!((240..=242).contains(&board.seen.size()[0]), "{distance} m: {:?}", board.seen);
        assert_eq!(board.size, [285, 190], "its image keeps its size");
    }
}

#[test]
fn what_is_behind_the_eye_or_seen_from_behind_or_from_its_edge_is_none() {
    let facing = from_south(28.0);
    assert!(board_of(&facing, &upright(24.0)).is_some());
    let away = view(Camera::looking(facing.camera.eye, DVec3::new(0.0, -200.0, 28.0), FOV), PICTURE);
    for width_m in [None, Some(24.0), Some(1e5)] {
        assert!(board_of(&away, &CallOut { width_m, ..upright(24.0) }).is_none(), "{width_m:?}");
    }
    let aside = view(Camera::looking(facing.camera.eye, DVec3::new(300.0, -100.0, 28.0), FOV), PICTURE);
    assert!(board_of(&aside, &upright(24.0)).is_none(), "out of the picture");
    // Lying flat at 20 m: seen from above, not from its edge, not from below.
    let flat = CallOut { tilt: 90_f64.to_radians(), ..upright(24.0) };
    for (height_m, is_seen) in [(40.0, true), (20.0, false), (5.0, false)] {
        assert_eq!(board_of(&from_south(height_m), &flat).is_some(), is_seen, "from {height_m} m");
    }
}

#[test]
fn from_straight_above_its_top_is_that_of_the_picture() {
    for projection in [Projection::Perspective { fov_y: FOV }, Projection::Orthographic { height_m: 90.0 }] {
        let above = Camera { projection, up: DVec3::Y, ..Camera::looking(DVec3::Z * 120.0, DVec3::ZERO, FOV) };
        let flat = CallOut { tilt: 90_f64.to_radians(), ..upright(24.0) };
        let board = board_of(&view(above, PICTURE), &flat).unwrap();
        assert!((board.foot.unwrap() - DVec2::new(320.0, 180.0)).length() < 1e-9);
        assert!(board.seen.max[1] <= 181 && board.seen.min[1] < 150, "{projection:?}: {:?}", board.seen);
    }
}

#[test]
fn a_picture_of_one_pixel_has_small_images() {
    let seen = view(from_south(28.0).camera, [1, 1]);
    for width_m in [None, Some(1e-3), Some(1e5)] {
        let board = board_of(&seen, &CallOut { width_m, ..upright(24.0) });
        let Some(board) = board else { continue };
        assert!(board.image_size().iter().all(|side| *side < 32), "{:?}", board.image_size());
    }
}

proptest! {
    #![proptest_config(crate::seeds::config())]

    #[test]
    fn pixels_show_what_lies_there(
        eye in prop::array::uniform3(-200.0..200.0f64), target in prop::array::uniform3(-40.0..40.0f64), ortho in any::<bool>(),
        width_m in 1.0..300.0f64, height_m in 0.0..80.0f64, tilt in -1.57..1.57f64, u in 0.0..1.0f64, v in 0.0..1.0f64,
    ) {
        let national = DVec3::new(85_000.0, 446_000.0, 0.0);
        let (eye, target) = (DVec3::from(eye) + national, DVec3::from(target) + national);
        prop_assume!(eye.distance(target) > 1.0);
        let camera = Camera::looking(eye, target, FOV);
        let projection = if ortho { Projection::Orthographic { height_m: 150.0 } } else { camera.projection };
        let seen = view(Camera { projection, ..camera }, PICTURE);
        let call_out = CallOut { height_m: Some(height_m), width_m: Some(width_m), tilt };
        let above = Above { place: national, heights_m: [0.0, 10.0] };
        let size_at = |s: f64| [240.0, 160.0].map(|side: f64| (side * s).round().max(1.0) as u32);
        let Some(board) = board(&seen, &call_out, &above, size_at, EM) else { return Ok(()) };
        let (quad, _) = stand(&seen, &call_out, &above, size_at, EM).unwrap();
        prop_assert!((quad.across.length() - width_m).abs() < 1e-9 && quad.across.z == 0.0);
        prop_assert!(quad.across.dot(quad.down).abs() < 1e-6 * width_m * width_m, "a rectangle");
        let place = |at: DVec2| seen.pixel(quad.corner + at.x * quad.across + at.y * quad.down);
        let Some(pixel) = place(DVec2::new(u, v)).filter(|p| p.z > camera.near_m) else { return Ok(()) };
        let is_in = (0..2).all(|i| (0.0..f64::from(PICTURE[i])).contains(&pixel[i]));
        prop_assume!(is_in);
        let (found, w) = on_overlay(&board, pixel.truncate());
        prop_assert!(w > 0.0);
        let back = place(found).expect("before the eye");
        prop_assert!((back - pixel).truncate().length() < 0.02, "{found} for ({u}, {v})");
        let corner = |i: usize| f64::from(board.seen.min[i]) <= pixel[i] && pixel[i] <= f64::from(board.seen.max[i]);
        prop_assert!(corner(0) && corner(1), "{pixel} in {:?}", board.seen);
    }
}
