//! Files of depth sprites.

use std::{path::Path, sync::Arc};

use glam::DVec3;
use veduta::{
    geom::{
        Aabb, Volume,
        shape::{Motion, Sphere},
    },
    lens::{
        PlacedSprite, SpriteSpace, SpriteVolume,
        sprite::{DepthCode, Format, Mapping},
        sprite_file,
    },
    view::{Camera, View},
};

use super::{Kind, READ_S, Seed, always, refused};

pub fn kind() -> Kind {
    let files = vec![Seed { name: "sprite.exr".into(), bytes: sprite() }];
    Kind {
        name: "sprites",
        files,
        sample: 60,
        is_worth: always,
        most_s: READ_S,
        read: Box::new(|_: &Path, _, bytes| read_sprite(bytes)),
    }
}

/// The file of a small depth sprite.
fn sprite() -> Vec<u8> {
    let camera = Camera::looking(DVec3::new(3.0, -9.0, 4.0), DVec3::ZERO, 0.7);
    let view = View::new(camera, [24, 16], &Aabb::EMPTY).expect("a view");
    let ball = Volume::Sphere(Sphere { center: DVec3::ZERO, radius: 2.0 });
    let texels = (0..16).flat_map(|y| (0..24).map(move |x| (x, y)));
    let ends = texels.flat_map(|(x, y)| {
        let both = ball.entry_exit(&view.pixel_ray(x, y)).map_or([0.0; 2], |(enter, exit)| [enter as f32, exit as f32]);
        [both, [0.0; 2]]
    });
    let sprite = SpriteVolume {
        ends: ends.collect(),
        space: SpriteSpace::of(&view),
        origin: [0, 0],
        kept: [24, 16],
        layers: 2,
        code: DepthCode { mapping: Mapping::W, near_m: 0.5, far_m: 50.0, format: Format::Unorm16 },
        crs: Some("EPSG:7415".into()),
    };
    sprite_file::bytes(&sprite).expect("a sprite can be written")
}

/// What a lens makes of a file.
fn read_sprite(bytes: &[u8]) -> Result<bool, String> {
    match sprite_file::read_bytes(bytes) {
        Err(message) => refused(&message),
        Ok(sprite) => {
            let intervals = sprite.kept[0] as usize * sprite.kept[1] as usize * sprite.layers as usize;
            if sprite.ends.len() != intervals || sprite.ends.iter().flatten().any(|d| d.is_nan()) {
                return Err("a sprite that is not sound".into());
            }
            let placed = PlacedSprite::new(Arc::new(sprite), &Motion::NONE);
            let corners = [DVec3::ZERO, DVec3::new(1.0, 1.0, 0.0), DVec3::new(0.0, 1.0, 1.0)];
            std::hint::black_box(placed.meets_triangle(&corners));
            Ok(true)
        }
    }
}
