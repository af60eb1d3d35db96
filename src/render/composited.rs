//! Translucent layers composited in f64, from the colour and the opacity of each: what methods are measured against.

use crate::{
    render::picture::{RenderError, Studio},
    scene::{Scene, Transparency},
};

/// What lies over the opaque picture, per pixel, row 0 at the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Composited {
    /// Colours times opacity, linear light, and what is let through.
    pub transparency: Vec<[f64; 4]>,
    /// How many layers the pixel has that has most.
    pub most_layers: u32,
}

/// The error of transparency over any background from black to white: the larger of what colours are off over these, linear light.
pub fn error(found: [f64; 4], right: [f64; 4]) -> [f64; 3] {
    let over_white = found[3] - right[3];
    [0, 1, 2].map(|i| (found[i] - right[i]).abs().max((found[i] - right[i] + over_white).abs()))
}

impl Studio {
    /// The layers of the exact method, each shaded on the GPU in f32 and laid here in f64; unjittered, `size` fits one target
    /// ([`crate::render::parts::TILE`]). Draws as many frames as the deepest pixel has layers.
    ///
    /// # Errors
    /// What drawing cannot do.
    pub fn composited_in_f64(&mut self, scene: &Scene, size: [u32; 2]) -> Result<Composited, RenderError> {
        let mut exact = scene.clone();
        exact.style.transparency = Transparency::Exact;
        let mut found = Composited {
            transparency: vec![[0.0, 0.0, 0.0, 1.0]; size[0] as usize * size[1] as usize],
            most_layers: 0,
        };
        loop {
            self.renderer.settings.picked_layer = Some(found.most_layers);
            let layer = self.transparency(&exact, size);
            self.renderer.settings.picked_layer = None;
            // None of a pixel is 1; an opacity comes as its negative.
            let mut is_any = false;
            for (over, [r, g, b, opacity]) in
                found.transparency.iter_mut().zip(layer?).filter(|(_, layer)| layer[3] <= 0.0)
            {
                is_any = true;
                let a = -f64::from(opacity);
                let through = over[3];
                for (sum, c) in over.iter_mut().zip([r, g, b]) {
                    *sum += through * a * f64::from(c);
                }
                over[3] *= 1.0 - a;
            }
            if !is_any {
                return Ok(found);
            }
            found.most_layers += 1;
        }
    }

    /// What a frame of a scene, unjittered, lays over what is opaque: colours times opacity and what is let through, in f32. Layers by
    /// chance lay nothing.
    ///
    /// # Errors
    /// What drawing cannot do.
    pub fn transparency(&mut self, scene: &Scene, size: [u32; 2]) -> Result<Vec<[f32; 4]>, RenderError> {
        self.redraw(scene, size)?;
        while self.renderer.makes_room()? | self.renderer.sorts_longer()? {
            self.redraw(scene, size)?;
        }
        let nothing = || vec![[0.0, 0.0, 0.0, 1.0]; size[0] as usize * size[1] as usize];
        let Some(targets) = self.renderer.targets().filter(|_| self.renderer.layer_figures().bands > 0) else {
            return Ok(nothing());
        };
        let bytes = self.renderer.gpu.read_texture(&targets.transparency.texture, 0, wgpu::TextureAspect::All)?;
        Ok(bytemuck::pod_collect_to_vec(&bytes))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_those_over_black_and_over_white() {
        // 0.1 too bright itself, and 0.3 too much shines through; over white they add up.
        assert_eq!(error([0.5, 0.5, 0.25, 0.75], [0.375, 0.5, 0.5, 0.5]), [0.375, 0.25, 0.25]);
        assert_eq!(error([0.5; 4], [0.5; 4]), [0.0; 3]);
    }
}
