//! Case 2: two parallel walls a gap g apart, seen from a distance z: the nearer one is in front wherever g ≥ 4 · 2⁻²³ · z, opaque and
//! translucent; below that a picture is at least the same every time. Oracle: the integers of their places and the side of the eye.

use glam::DVec3;
use veduta::{
    render::frame::Backend,
    scene::Scene,
    view::{Camera, default_near_m},
};

use crate::{panes::*, studio};

const PIXELS: [u32; 2] = [40, 32];

/// Two walls of 100 by 100 metres, the second `gap_mm` behind the first where one looks along x.
fn walls(gap_mm: i64) -> [Pane; 2] {
    let wall = |name: usize, x| Pane { name, x, low: [0, 0], high: [100_000, 100_000], material: name };
    [wall(0, 0), wall(1, gap_mm)]
}

/// Looks at the middle of the walls from `z_m` metres, `side` −1 before the first and +1 behind the second, turned by `off` from the
/// perpendicular; the walls fill the picture.
fn view(z_m: f64, side: f64, off: [f64; 2]) -> Camera {
    let middle = DVec3::new(0.0, 50.0, 50.0);
    let eye = middle + DVec3::new(side * z_m, off[0] * z_m, off[1] * z_m);
    let mut camera = Camera::looking(eye, middle, (4.0 / z_m).max(2e-4));
    camera.near_m = default_near_m(z_m);
    camera
}

/// The distance at which a gap is this many times what can be told.
fn distance_m(gap_mm: i64, times: f64) -> f64 {
    gap_mm as f64 * 1e-3 * f64::from(1 << 23) / (4.0 * times)
}

#[test]
fn the_nearer_wall_is_in_front() {
    let mut random = Random(3);
    for gap_mm in [1, 3, 40] {
        let mut studio = studio_of(&walls(gap_mm));
        for times in [1.0, 1.25, 3.0, 50.0] {
            for i in 0..24 {
                let side = if i % 2 == 0 { -1.0 } else { 1.0 };
                let off = [random.share() - 0.5, 0.2 * random.share()];
                // The perpendicular distance: obliquely seen, the way between the walls is longer, too.
                let camera = view(distance_m(gap_mm, times), side, off);
                let drawn = studio::picture(&mut studio, &studio::scene(camera, vec![]), PIXELS);
                let expected = if side < 0.0 { 1 } else { 2 };
                let ids = drawn.object_id.expect("ids");
                let wrong = ids.iter().filter(|id| **id != expected).count();
                assert_eq!(wrong, 0, "{gap_mm} mm from {} m, {off:?}", distance_m(gap_mm, times));
            }
        }
    }
}

#[test]
fn the_nearer_layer_is_laid_over_the_other() {
    let mut random = Random(5);
    let rule = |opacity: f64| vec![rule("transparent", &[("opacity", opacity)], None, false)];
    for gap_mm in [1, 40] {
        let mut studio = studio_of(&walls(gap_mm));
        for times in [1.0, 3.0, 50.0] {
            for i in 0..8 {
                let side = if i % 2 == 0 { -1.0 } else { 1.0 };
                let off = [random.share() - 0.5, 0.2 * random.share()];
                let seen = |effects| {
                    let mut scene: Scene = studio::scene(view(distance_m(gap_mm, times), side, off), vec![]);
                    scene.style.effects = effects;
                    scene
                };
                let alone = [0, 1].map(|pane: usize| {
                    let mut effects = vec![crate::panes::rule("eraser", &[], Some(&[pane]), true)];
                    effects.extend(rule(1.0));
                    transparency(&mut studio, &seen(effects), Backend::Specialised, PIXELS)
                });
                let found = transparency(&mut studio, &seen(rule(0.6)), Backend::Specialised, PIXELS);
                let [near, far] = if side < 0.0 { [&alone[0], &alone[1]] } else { [&alone[1], &alone[0]] };
                let color = |of: &[f32; 4]| [of[0], of[1], of[2]];
                let expected: Vec<[f64; 4]> = (0..found.len())
                    .map(|p| composited(&[(0, color(&near[p])), (1, color(&far[p]))], |_, _| f64::from(0.6_f32)))
                    .collect();
                let error = largest_difference(&found, &expected);
                assert!(error < 7.0 * 2_f64.powi(-24), "{gap_mm} mm, {times}, {off:?}: {error:e}");
            }
        }
    }
}

#[test]
fn what_cannot_be_told_is_drawn_alike_every_time() {
    for (gap_mm, times) in [(1, 0.3), (1, 0.01)] {
        let scene = studio::scene(view(distance_m(gap_mm, times), -1.0, [0.3, 0.1]), vec![]);
        let first = studio::picture(&mut studio_of(&walls(gap_mm)), &scene, PIXELS);
        let second = studio::picture(&mut studio_of(&walls(gap_mm)), &scene, PIXELS);
        assert!(first.object_id == second.object_id && first.rgba == second.rgba);
        assert!(first.object_id.expect("ids").iter().all(|id| [1, 2].contains(id)), "it has no hole");
    }
}
