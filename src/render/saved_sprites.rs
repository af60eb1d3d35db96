//! The sprite that a lens is tested by, as it is saved.

use std::collections::BTreeMap;

use crate::{
    lens::{Class, EffectUse, LensSprite, SpriteVolume},
    render::{
        parts::TILE,
        picture::{RenderError, Studio},
        stored::SpriteTexels,
    },
    scene::Scene,
};

impl Studio {
    /// The sprite that a lens is tested by in a picture of this size: the one its keys give, or the default one, seen by the
    /// picture's eye.
    ///
    /// # Errors
    /// Where the lens has none, or more than one; and those of drawing.
    pub fn sprite_of(&mut self, scene: &Scene, size: [u32; 2], lens: usize) -> Result<SpriteVolume, RenderError> {
        let of = |message: String| RenderError::Scene(format!("[lens.{lens}] {message}"));
        let Some(asked) = scene.lenses.get(lens) else { return Err(of("there is no such lens".into())) };
        if !asked.enabled {
            return Err(of("is not enabled: there is no sprite of it; enabled = true would be right".into()));
        }
        let mut scene = scene.clone();
        if !asked.has_sprite_file() {
            scene.lenses[lens].sprite.get_or_insert_with(LensSprite::default);
        }
        let is_own = asked.has_sprite_file() || asked.sprite.is_some_and(|sprite| sprite.own.is_some());
        if !is_own && size.iter().any(|side| *side > TILE) {
            let message = format!(
                "its sprite has the picture's {}x{} pixels; at most {TILE} on a side, or a camera of its own, would be right",
                size[0], size[1]
            );
            return Err(of(message));
        }
        if is_own {
            // Also where the picture does not show what is inside.
            let effect = "greyscale".to_owned();
            let (blend, weight, parameters) = (None, None, BTreeMap::new());
            scene.lenses[lens].effects = vec![EffectUse { effect, class: Class::Rest, blend, weight, parameters }];
            scene.lenses[lens].kind.set_content(None);
            scene.lenses[lens].clear_rendering();
        }
        let found = self.sprites(&scene, size, lens)?;
        match &found[..] {
            [one] if one.bounds.is_empty() => {
                Err(of("has an empty sprite: nothing of its shapes is in the frame of its own eye".into()))
            }
            [one] => Ok(saved(one, self.model.crs.clone())),
            [] => Err(of("has no sprite: it is not in the picture, or all its shapes are \"thematic\"".into())),
            many => Err(of(format!("has {} sprites; shapes that are one sprite together would be right", many.len()))),
        }
    }
}

/// A sprite that was read back, as distances.
fn saved(texels: &SpriteTexels, crs: Option<String>) -> SpriteVolume {
    let ends = |codes: &[u32; 2]| match texels.code.distances(*codes) {
        None => [0.0; 2],
        // Before the eye there is no entry.
        Some((entry, exit)) => [entry.max(0.0), exit.max(f32::MIN_POSITIVE)],
    };
    SpriteVolume {
        space: texels.space,
        origin: texels.bounds.origin,
        kept: texels.bounds.size,
        layers: texels.layers,
        ends: texels.codes.iter().map(ends).collect(),
        code: texels.code,
        crs,
    }
}
