//! A lens around everything is the global effect.

use glam::{DQuat, DVec3};

use crate::{
    geom::Shape,
    measure::topics::gpu::{
        check::{Check, Findings},
        cities::synthetic,
        looks::{bit, cameras, ids, lens, picture, scene, used},
    },
    render::picture::RenderError,
};

/// See the module.
pub const CHECK: Check = Check {
    name: "lens around everything",
    case: "5",
    property: "on surface pixels a lens around the city, of 50 km and of 10,000 km, has the bytes of the same effect in the \
               style, elsewhere those without an effect",
    oracle: "byte equality",
    unit: "pixels",
    least: 100_000,
    run,
};

const SIZE: [u32; 2] = [160, 120];

/// A shape that holds the ball of radius `r`.
fn around(kind: usize, center: DVec3, r: f64) -> Shape {
    let rotation = DQuat::from_rotation_x(0.4) * DQuat::from_rotation_z(0.7);
    let axis = rotation * DVec3::Z;
    match kind % 4 {
        0 => Shape::Sphere { center, radius: r },
        1 => Shape::Box { center, size: DVec3::new(2.0, 2.6, 2.2) * r, rotation },
        2 => Shape::Cylinder { center, radius: r, height: 2.0 * r, axis },
        _ => Shape::Frustum { center, radius: 3.0 * r, top_radius: r, height: 2.0 * r, axis },
    }
}

fn run(found: &mut Findings) -> Result<(), RenderError> {
    let mut studio = synthetic(40, 7)?;
    let extent = studio.extent();
    let effects = ["sepia", "gooch", "blur"].map(used);
    let mut turn = 0;
    for camera in cameras(&studio) {
        let plain = picture(&mut studio, &scene(camera, Vec::new()), SIZE)?;
        let reach = (camera.eye - extent.center()).length() + extent.size().length();
        for effect in &effects {
            let mut global = scene(camera, Vec::new());
            global.style.effects = vec![effect.clone()];
            let global = picture(&mut studio, &global, SIZE)?;
            for r in [1.01 * reach, 5e4, 1e7] {
                let mut lens = lens("around", around(turn, extent.center(), r), "sepia");
                lens.effects = vec![effect.clone()];
                turn += 1;
                let drawn = picture(&mut studio, &scene(camera, vec![lens]), SIZE)?;
                for (i, id) in ids(&drawn).iter().enumerate() {
                    let right = if *id != 0 { &global } else { &plain };
                    found.ask(drawn.rgba[i] == right.rgba[i] && bit(&drawn, 0, i) == (*id != 0), || {
                        format!("{} within {r} m, pixel {i} of object {id}: {:?}", effect.effect, drawn.rgba[i])
                    });
                }
            }
            if !found.goes_on() {
                return Ok(());
            }
        }
    }
    Ok(())
}
