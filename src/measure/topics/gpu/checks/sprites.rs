//! Masks of lenses that are tested by their depth sprites.

use glam::{DQuat, DVec3};

use crate::{
    geom::Shape,
    lens::{
        LensSprite,
        sprite::{Format, Mapping},
    },
    measure::topics::gpu::{
        check::{Check, Findings},
        cities::synthetic,
        looks::{bit, column_row, depths, house, lens, orthographic, picture, scene, view},
        shapes::holds,
    },
    render::picture::{RenderError, Studio},
    view::Camera,
};

/// See the module.
pub const CHECK: Check = Check {
    name: "masks of sprites",
    case: "lens tests",
    property: "masks by depth sprites err by at most two steps of the format along the ray and one and a half texels across it",
    oracle: "the shapes' definitions in f64",
    unit: "pixels",
    least: 200_000,
    run,
};

const SIZE: [u32; 2] = [200, 150];

/// All formats, each with one of the mappings.
const CODES: [(Format, Mapping); 6] = [
    (Format::Float32, Mapping::InverseW),
    (Format::Uint32, Mapping::Z),
    (Format::Float16, Mapping::InverseW),
    (Format::Unorm16, Mapping::W),
    (Format::Unorm16, Mapping::ComplementaryZ),
    (Format::Unorm8, Mapping::W),
];

fn run(found: &mut Findings) -> Result<(), RenderError> {
    let mut studio = synthetic(60, 7)?;
    let at = house(&studio).center();
    let cameras = [
        Camera::looking(at + DVec3::new(90.0, -120.0, 70.0), at, 0.9),
        orthographic(at + DVec3::new(90.0, -120.0, 70.0), at, 160.0),
        // Inside of what is 30 m large.
        Camera::looking(at + DVec3::new(9.0, 3.0, 12.0), at + DVec3::new(60.0, 30.0, -6.0), 1.1),
    ];
    let turn = DQuat::from_rotation_z(0.6) * DQuat::from_rotation_x(0.35);
    let shapes = [
        Shape::Sphere { center: at, radius: 30.0 },
        Shape::Box { center: at, size: DVec3::new(50.0, 40.0, 30.0), rotation: turn },
    ];
    for (format, mapping) in CODES {
        for (resolution, texel_px) in [(None, 1.0), (Some(50), 4.0)] {
            let sprite = LensSprite { resolution, format, mapping, ..LensSprite::default() };
            for (camera, shape) in cameras.iter().flat_map(|camera| shapes.iter().map(move |shape| (camera, shape))) {
                ask_mask(found, &mut studio, *camera, shape, sprite, texel_px)?;
                if !found.goes_on() {
                    return Ok(());
                }
            }
        }
    }
    Ok(())
}

fn ask_mask(
    found: &mut Findings,
    studio: &mut Studio,
    camera: Camera,
    shape: &Shape,
    sprite: LensSprite,
    texel_px: f64,
) -> Result<(), RenderError> {
    let mut lens = lens("sprite", shape.clone(), "sepia");
    lens.sprite = Some(sprite);
    let scene = scene(camera, vec![lens]);
    let drawn = picture(studio, &scene, SIZE)?;
    let stored = studio.sprites(&scene, SIZE, 0)?;
    let (Some(stored), Ok(volume)) = (stored.first(), shape.volume()) else {
        found.ask(false, || format!("{sprite:?}: there is no sprite"));
        return Ok(());
    };
    let (code, view) = (stored.code, view(camera, SIZE)?);
    for (i, &d) in depths(&drawn).iter().enumerate() {
        let d = f64::from(d);
        let [x, y] = column_row(SIZE, i);
        let (ray, is_in) = (view.pixel_ray(x, y), bit(&drawn, 0, i));
        let p = ray.at(d);
        let is_right = is_in == (d.is_finite() && holds(shape, p))
            || d.is_finite() && {
                // Along the ray a step is longer than along the axis.
                let along = ray.direction.length() * code.quantum_m(d.clamp(code.near_m, code.far_m));
                volume.signed_distance(p).abs() <= 2.0 * along + 1.5 * texel_px * view.pixel_m(d) + 1e-3
            };
        found.ask(is_right, || {
            let (format, mapping) = (sprite.format.word(), sprite.mapping.word());
            format!(
                "{format} {mapping}, pixel {x},{y} at {d} m is in the lens: {is_in}; {} m",
                volume.signed_distance(p)
            )
        });
    }
    Ok(())
}
