//! The texels of depth sprites against the pixels of the picture that is drawn.

use crate::render::eye::PictureTile;

/// The grid of a sprite over a picture: that of the whole picture, whatever tile of it is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct SpriteGrid {
    /// Width and height of the whole sprite, texels.
    pub size: [u32; 2],
    /// Width and height of the whole picture, pixels.
    pub picture: [u32; 2],
    /// The tile that is drawn.
    pub tile: PictureTile,
}

impl SpriteGrid {
    /// That of a sprite with an eye of its own: its texels are its pixels.
    pub fn own(size: [u32; 2]) -> Self {
        Self { size, picture: size, tile: PictureTile::whole(size) }
    }

    /// Along one axis: where a pixel of the picture begins, texels.
    fn texel(&self, i: usize, pixel: u32) -> f64 {
        f64::from(pixel) * f64::from(self.size[i]) / f64::from(self.picture[i])
    }

    /// The texels that pixels of the tile look at, with one more on two sides.
    pub fn around(&self, pixels: PictureTile) -> PictureTile {
        let from = |i: usize| self.tile.origin[i] + pixels.origin[i];
        let low = |i: usize| self.texel(i, from(i)).floor() as u32;
        let high = |i: usize| (self.texel(i, from(i) + pixels.size[i]).ceil() as u32 + 1).min(self.size[i]);
        PictureTile { origin: std::array::from_fn(low), size: std::array::from_fn(|i| high(i) - low(i)) }
    }

    /// Texels of a pixel.
    pub fn texels_per_pixel(&self) -> [f32; 2] {
        std::array::from_fn(|i| self.size[i] as f32 / self.picture[i] as f32)
    }

    /// Pixels of a texel.
    pub fn pixels_per_texel(&self) -> [f32; 2] {
        std::array::from_fn(|i| self.picture[i] as f32 / self.size[i] as f32)
    }

    /// From the tile's first pixel to the texel `origin`, texels.
    pub fn shift(&self, origin: [u32; 2]) -> [f32; 2] {
        std::array::from_fn(|i| (self.texel(i, self.tile.origin[i]) - f64::from(origin[i])) as f32)
    }

    /// From the tile's clip space to that of a target of `target` texels: all of the tile, by how much of it that is.
    pub fn clip_scale(&self, target: [u32; 2]) -> [f32; 2] {
        std::array::from_fn(|i| (self.texel(i, self.tile.size[i]) / f64::from(target[i])) as f32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tile_looks_at_the_texels_of_the_whole_sprite() {
        let whole = PictureTile::whole([300, 200]);
        for size in [[300, 200], [128, 86], [700, 467]] {
            let of = |tile| SpriteGrid { size, picture: [300, 200], tile };
            let tile = PictureTile { origin: [96, 64], size: [150, 104] };
            let (grid, kept) = (of(tile), of(tile).around(PictureTile::whole(tile.size)));
            assert_eq!(of(whole).around(whole), PictureTile::whole(size));
            assert_eq!(of(whole).shift([3, 5]), [-3.0, -5.0]);
            let scale = grid.texels_per_pixel();
            for (i, scale) in scale.into_iter().enumerate() {
                // All that pixels of the tile look at is kept.
                let texel = |pixel: u32| ((f64::from(pixel) + 0.5) * f64::from(scale)) as u32;
                assert!(texel(tile.origin[i]) >= kept.origin[i] && texel(tile.end(i) - 1) < kept.end(i), "{size:?}");
                // And made where it is seen: the middle of a texel, in pixels of the tile.
                let made = (10.5 - grid.shift([0, 0])[i]) * grid.pixels_per_texel()[i];
                let right = 10.5 / scale - tile.origin[i] as f32;
                assert!((made - right).abs() < 1e-3, "{made} is not {right}");
            }
        }
    }
}
