//! Exactly coplanar faces: a plate on a roof, while the camera jitters.

use glam::DVec3;

use crate::{
    measure::topics::gpu::{
        check::{Check, Findings},
        cities::{DUTCH, block, numbered, of_solids, place},
        looks::{ids, picture, scene, translucent},
    },
    render::picture::RenderError,
    scene::Transparency,
    view::Camera,
};

/// See the module.
pub const CHECK: Check = Check {
    name: "coplanar faces",
    case: "3",
    property: "of two objects whose faces lie in one plane the same one wins in every sub-pixel jitter, opaque and as \
               translucent layers",
    oracle: "the rule: the object whose id comes first",
    unit: "pixels",
    least: 50_000,
    run,
};

const SIZE: [u32; 2] = [40, 30];
const FRAMES: u32 = 100;

fn run(found: &mut Findings) -> Result<(), RenderError> {
    let roof = block([0, 0, 0], [10_000, 10_000, 5_000]);
    let plate = vec![vec![[2_000, 2_000, 5_000], [8_000, 2_000, 5_000], [8_000, 8_000, 5_000], [2_000, 8_000, 5_000]]];
    let middle = place(DUTCH, [5_000, 5_000, 5_000]);
    let eye = middle + DVec3::new(13.0, -29.0, 41.0);
    // The plate first, then the roof: the first one is seen, object 1.
    for solids in [[plate.clone(), roof.clone()], [roof, plate]] {
        let mut studio = of_solids(DUTCH, &numbered(solids))?;
        for in_layers in [false, true] {
            for i in 0..FRAMES {
                // Irrational steps: no two frames see the plane from the same place.
                let t = f64::from(i);
                let jitter =
                    1e-3 * DVec3::new((t * 0.618_034).fract(), (t * 0.754_878).fract(), (t * 0.569_840).fract());
                let camera = Camera::looking(eye + jitter, middle + jitter, 0.05);
                let seen = match in_layers {
                    true => translucent(camera, 0.9, Transparency::Exact),
                    false => scene(camera, Vec::new()),
                };
                let drawn = picture(&mut studio, &seen, SIZE)?;
                for (p, id) in ids(&drawn).iter().enumerate() {
                    let (x, y) = (p % SIZE[0] as usize, p / SIZE[0] as usize);
                    if (10..30).contains(&x) && (8..22).contains(&y) {
                        found.ask(*id == 1, || format!("frame {i}, pixel {x},{y}, layers {in_layers}: object {id}"));
                    }
                }
            }
            if !found.goes_on() {
                return Ok(());
            }
        }
    }
    Ok(())
}
