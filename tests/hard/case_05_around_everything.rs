//! Case 5: a lens that holds the whole scene, or reaches past every far plane, is the global effect on all surface pixels
//! and nothing elsewhere. Oracle: byte equality with the same effect in the scene's style, and with no effect.

use glam::{DQuat, DVec3};
use veduta::{geom::Shape, lens::EffectUse};

use crate::{
    lenses::{cameras, holds},
    studio,
};

const SIZE: [u32; 2] = [160, 120];

/// A shape of each kind that holds the ball of radius `r`.
fn around(c: DVec3, r: f64) -> Vec<(&'static str, Shape)> {
    let rotation = DQuat::from_rotation_x(0.4) * DQuat::from_rotation_z(0.7);
    let axis = rotation * DVec3::Z;
    let side = |i: u32, bit: u32| if i >> bit & 1 == 0 { -1.0 } else { 1.0 };
    let corner = |i: u32| DVec3::new(side(i, 0), side(i, 1), side(i, 2));
    let plane = |i: u32| {
        let n = rotation * corner(i);
        [n.x, n.y, n.z, n.dot(c) + 3_f64.sqrt() * r]
    };
    vec![
        ("sphere", Shape::Sphere { center: c, radius: r }),
        ("box", Shape::Box { center: c, size: DVec3::new(2.0, 2.6, 2.2) * r, rotation }),
        ("cylinder", Shape::Cylinder { center: c, radius: r, height: 2.0 * r, axis }),
        ("ellipsoid", Shape::Ellipsoid { center: c, radii: DVec3::new(1.0, 1.5, 1.1) * r, rotation }),
        ("cone", Shape::Frustum { center: c, radius: 4.0 * r, top_radius: 0.0, height: 4.0 * r, axis }),
        ("frustum", Shape::Frustum { center: c, radius: 3.0 * r, top_radius: r, height: 2.0 * r, axis }),
        ("convex", Shape::Convex { points: (0..8).map(|i| c + rotation * (r * corner(i))).collect() }),
        ("polytope", Shape::Polytope { planes: (0..8).map(plane).collect() }),
        (
            "corridor",
            Shape::Corridor { points: vec![c - DVec3::X * r, c + DVec3::X * r], width: 2.0 * r, height: 2.0 * r },
        ),
    ]
}

#[test]
fn a_lens_around_the_scene_is_the_global_effect() {
    let mut studio = studio::synthetic(40);
    let extent = studio.extent();
    let effects: [EffectUse; 4] = ["sepia", "gooch", "velvet", "blur"].map(studio::used);
    let mut turn = 0;
    for camera in cameras(&studio) {
        let drawn_by = |studio: &mut _, lenses, global: Option<&EffectUse>| {
            let mut scene = studio::scene(camera, lenses);
            scene.style.effects = global.into_iter().cloned().collect();
            studio::picture(studio, &scene, SIZE)
        };
        let plain = drawn_by(&mut studio, vec![], None);
        let globals = effects.each_ref().map(|effect| drawn_by(&mut studio, vec![], Some(effect)).rgba);
        // Just around the city and the eye; a city of cities; beyond what any picture shows.
        let reach = (camera.eye - extent.center()).length() + extent.size().length();
        for r in [1.01 * reach, 5e4, 1e7] {
            for (what, shape) in around(extent.center(), r) {
                assert!(holds(&shape, camera.eye) && extent.corners().iter().all(|p| holds(&shape, *p)), "{what}");
                let (effect, global) = (&effects[turn % 4], &globals[turn % 4]);
                turn += 1;
                let mut lens = studio::lens("around", vec![shape], "sepia");
                lens.effects = vec![effect.clone()];
                let drawn = drawn_by(&mut studio, vec![lens], None);
                let ids = drawn.object_id.as_ref().expect("ids");
                let bits = studio::bits(&drawn, 0);
                let is_surface = |i: &usize| ids[*i] != 0;
                let (surface, sky): (Vec<usize>, Vec<usize>) = (0..ids.len()).partition(is_surface);
                assert!(surface.len() > 500, "{what}: {} pixels show the city", surface.len());
                assert!(surface.iter().all(|&i| bits[i]) && sky.iter().all(|&i| !bits[i]), "{what} {r}: mask");
                let name = &effect.effect;
                assert!(surface.iter().all(|&i| drawn.rgba[i] == global[i]), "{what} {r}: not {name} everywhere");
                assert!(sky.iter().all(|&i| drawn.rgba[i] == plain.rgba[i]), "{what} {r}: {name} in the sky");
            }
        }
    }
    assert_eq!(turn, 81);
}
