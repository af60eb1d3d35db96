//! What is opaque in a picture, and how much of its light comes through what stands before it.

use crate::{
    render::picture::{RenderError, Studio},
    scene::{Scene, Transparency},
};

/// Per pixel, row 0 at the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Transmittance {
    /// Index + 1 of the opaque object, whatever translucent layers stand before it; 0: none.
    pub object_id: Vec<u32>,
    /// How much of its light comes through these: 1 where there is none, 0 where nothing does.
    pub through: Vec<f32>,
}

impl Studio {
    /// What is opaque in a picture of a scene and how much of it is seen, at the middle of each pixel. `size` fits one target
    /// ([`crate::render::parts::TILE`]).
    ///
    /// # Errors
    /// What drawing cannot do.
    pub fn transmittance(&mut self, scene: &Scene, size: [u32; 2]) -> Result<Transmittance, RenderError> {
        // Whatever the picture is drawn by: this is what it would be at best.
        let mut exact = scene.clone();
        exact.style.transparency = Transparency::Exact;
        let scene = &exact;
        let over = self.transparency(scene, size)?;
        let pixels = size[0] as usize * size[1] as usize;
        let Some(targets) = self.renderer.targets() else {
            return Ok(Transmittance { object_id: vec![0; pixels], through: vec![1.0; pixels] });
        };
        let gpu = &self.renderer.gpu;
        let codes = gpu.read_texture(&targets.codes.texture, 0, wgpu::TextureAspect::All)?;
        let words = if targets.needs.smooth { 2 } else { 1 };
        let codes = bytemuck::cast_slice::<u8, u32>(&codes).iter().step_by(words);
        let through = over.iter().map(|over| over[3]).collect();
        Ok(Transmittance { object_id: codes.map(|&code| self.renderer.object_id(code)).collect(), through })
    }
}
