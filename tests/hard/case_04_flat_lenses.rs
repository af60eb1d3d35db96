//! Case 4, of flat lenses: the eye close before the plane, close behind it, and the plane before the near plane: exact class for
//! every pixel, and the same picture for near = 0.125 and 1 m where D > 1 m. Oracle: f64 entry of the pixel's ray.

use glam::{DQuat, DVec2, DVec3};
use veduta::{
    geom::{
        Aabb, Shape,
        shape::{FlatFigure, Sightlines},
    },
    view::{Camera, View},
};

use crate::studio;

const SIZE: [u32; 2] = [160, 120];

#[test]
fn flat_lenses_near_the_eye_have_exact_classes_whatever_the_near_plane() {
    let mut studio = studio::synthetic(40);
    let bounds = studio.model.geometries[studio.geometries[studio.geometries.len() / 2] as usize].bounds;
    let eye = DVec3::new(bounds.min.x - 9.0, bounds.min.y - 6.0, bounds.min.z + 1.6);
    let camera = |near_m: f64| Camera { near_m, ..Camera::looking(eye, bounds.center(), 1.2) };
    let view = View::new(camera(0.125), SIZE, &Aabb::EMPTY).expect("a view");
    let forward = view.basis.forward;
    let facing = DQuat::from_rotation_arc(DVec3::Z, -forward);
    let mut held = Vec::new();
    for ahead in [-3.0, -1e-6, 1e-6, 0.02, 0.3, 0.7, 2.0] {
        for tilt in [0.0, 0.5, 1.4] {
            let shape = Shape::Flat {
                center: eye + ahead * forward,
                rotation: facing * DQuat::from_rotation_x(tilt),
                figure: FlatFigure::Rectangle { size: DVec2::splat(f64::abs(ahead)) },
            };
            let volume = shape.volumes_seen(&Sightlines::From(eye)).expect("a volume").remove(0);
            let mut draw = |near_m: f64| {
                let scene = studio::scene(camera(near_m), vec![studio::lens("flat", vec![shape.clone()], "sepia")]);
                studio::picture(&mut studio, &scene, SIZE)
            };
            let (close, far) = (draw(0.125), draw(1.0));
            let (depth, inside) = (close.depth.as_ref().expect("depth"), studio::bits(&close, 0));
            let beyond = far.depth.as_ref().expect("depth");
            for (i, (x, y)) in (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| (x, y))).enumerate() {
                let at = DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
                let holds = |offset: DVec2, d: f64| {
                    volume.entry_exit(&view.ray(at + offset)).is_some_and(|(entry, _)| entry <= d)
                };
                let d = f64::from(depth[i]);
                let near = [[0.0, 0.0], [0.01, 0.01], [-0.01, 0.01], [0.01, -0.01], [-0.01, -0.01]].map(DVec2::from);
                let expected = holds(DVec2::ZERO, d);
                // A hundredth of a pixel, and a hundred thousandth of the way: the border.
                if near
                    .iter()
                    .all(|o| holds(*o, d * (1.0 + 1e-5)) == expected && holds(*o, d / (1.0 + 1e-5)) == expected)
                {
                    assert_eq!(inside[i], expected, "{ahead} m ahead, tilted by {tilt}: pixel {x},{y} at {d} m");
                }
                if beyond[i] > 1.0 {
                    let same = close.rgba[i] == far.rgba[i] && inside[i] == studio::bits(&far, 0)[i];
                    assert!(same, "{ahead} m ahead, tilted by {tilt}: pixel {x},{y} depends on the near plane");
                }
            }
            held.push(inside.iter().filter(|b| **b).count());
        }
    }
    assert!(held[..6].iter().all(|n| *n == 0) && held[6..].iter().all(|n| *n > 300), "{held:?}");
}
