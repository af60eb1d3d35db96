//! Furniture: what stands over a finished picture - panels, swatches, lines of text - as plain data, and its buffers.
//!
//! Whoever makes it (titles, captions, legends: [`crate::figure`]) says where everything stands in pixels of the whole
//! picture; tiles of a large picture each take their part. Equal furniture is set once.

use crate::{
    gpu::{Gpu, GpuError},
    lens::color::{Srgb, linear_from_srgb},
    render::{
        eye::PictureTile,
        layout::FurnitureItem,
        pipelines::{FURNITURE_LAYER, PICTURE, Pipelines},
        renderer::group,
        synced::Synced,
        text::{Run, TextLine, Typesetter},
    },
};

/// Everything that stands over a picture, bottom first.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Furniture {
    /// The pieces.
    pub pieces: Vec<Piece>,
}

/// One piece of furniture.
#[derive(Clone, Debug, PartialEq)]
pub enum Piece {
    /// A rectangle.
    Panel(Panel),
    /// A line of text.
    Text(TextLine),
}

/// A rectangle of one colour: a card, a swatch, its shadow. On whole pixels its colour is exact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Panel {
    /// Left, top, pixels from the picture's top left.
    pub low: [f32; 2],
    /// Right, bottom.
    pub high: [f32; 2],
    /// sRGB 0..1.
    pub color: Srgb,
    /// 0 to 1.
    pub opacity: f32,
    /// Radius of the corners, pixels.
    pub radius_px: f32,
    /// Over how many pixels the border fades: 1 is a clean one, more a shadow; ≥ 1.
    pub softness_px: f32,
}

/// No furniture, to be borrowed.
pub static NONE: Furniture = Furniture { pieces: Vec::new() };

impl Furniture {
    /// Whether there is nothing to draw.
    pub fn is_empty(&self) -> bool {
        self.pieces.is_empty()
    }
}

/// Furniture on the card.
#[derive(Debug)]
pub struct FurnitureOnGpu {
    setter: Typesetter,
    /// What the runs were made of, for a picture of this size.
    of: (Furniture, [u32; 2]),
    /// One per piece; panels and texts without a pixel have none.
    runs: Vec<Option<Run>>,
    /// The tile the buffers hold.
    tile: Option<PictureTile>,
    frame: Synced,
    items: Synced,
    coverage: Synced,
    group: Option<wgpu::BindGroup>,
    layer: Option<Layer>,
    count: u32,
}

/// What a transparent picture takes.
#[derive(Debug)]
struct Layer {
    size: [u32; 2],
    view: wgpu::TextureView,
    copy: wgpu::Texture,
    group: wgpu::BindGroup,
}

impl FurnitureOnGpu {
    /// Without anything yet.
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        use wgpu::BufferUsages as U;
        Ok(Self {
            setter: Typesetter::default(),
            of: (Furniture::default(), [0, 0]),
            runs: Vec::new(),
            tile: None,
            frame: Synced::new(gpu, "furniture frame", U::UNIFORM)?,
            items: Synced::new(gpu, "furniture items", U::VERTEX)?,
            coverage: Synced::new(gpu, "furniture coverage", U::STORAGE)?,
            group: None,
            layer: None,
            count: 0,
        })
    }

    /// Brings the buffers up to date for a tile of a picture of size `whole`.
    pub fn fit(
        &mut self,
        gpu: &Gpu,
        pipelines: &Pipelines,
        furniture: &Furniture,
        whole: [u32; 2],
        tile: PictureTile,
        layered: bool,
    ) -> Result<(), GpuError> {
        if self.of.1 != whole || self.of.0 != *furniture {
            let set = |piece: &Piece| match piece {
                Piece::Panel(_) => None,
                Piece::Text(line) => self.setter.rasterised(line, whole),
            };
            self.runs = furniture.pieces.iter().map(set).collect();
            self.of = (furniture.clone(), whole);
            self.tile = None;
        }
        if self.tile != Some(tile) {
            let (items, coverage) = assembled(furniture, &self.runs, tile);
            let size = tile.size.map(|side| side as f32);
            let mut stale = self.frame.sync(gpu, &[size])?;
            stale |= self.coverage.sync(gpu, &coverage)?;
            self.items.sync(gpu, &items)?;
            self.count = items.len() as u32;
            self.tile = Some(tile);
            if stale {
                self.group = None;
            }
        }
        let entries = [(0, self.frame.buffer()), (1, self.coverage.buffer())];
        self.group.get_or_insert_with(|| {
            let entries = entries.map(|(binding, buffer)| (binding, buffer.as_entire_binding()));
            group(gpu, "furniture", &pipelines.layouts.furniture, &entries)
        });
        if !layered {
            self.layer = None;
        } else if self.layer.as_ref().is_none_or(|l| l.size != tile.size) {
            self.layer = Some(Layer::new(gpu, pipelines, tile.size));
        }
        Ok(())
    }

    /// Pieces in the tile.
    pub fn count(&self) -> u32 {
        self.count
    }

    /// Where to draw, if not on the picture.
    pub fn layer(&self) -> Option<&wgpu::TextureView> {
        self.layer.as_ref().map(|l| &l.view)
    }

    /// Draws every piece in one go.
    pub fn draw(&self, pass: &mut wgpu::RenderPass) {
        pass.set_bind_group(0, self.group.as_ref(), &[]);
        pass.set_vertex_buffer(0, self.items.buffer().slice(..));
        pass.draw(0..6, 0..self.count);
    }

    /// Where there is a layer: copies the picture, and binds both.
    pub fn copied(&self, encoder: &mut wgpu::CommandEncoder, picture: &wgpu::Texture) -> Option<&wgpu::BindGroup> {
        let layer = self.layer.as_ref()?;
        encoder.copy_texture_to_texture(picture.as_image_copy(), layer.copy.as_image_copy(), picture.size());
        Some(&layer.group)
    }
}

impl Layer {
    fn new(gpu: &Gpu, pipelines: &Pipelines, size: [u32; 2]) -> Self {
        use wgpu::TextureUsages as U;
        let whole = [size[0], size[1], 1];
        let drawn = U::RENDER_ATTACHMENT | U::TEXTURE_BINDING;
        let layer = gpu.texture("furniture layer", whole, 1, FURNITURE_LAYER, drawn);
        let copy = gpu.texture("picture under furniture", whole, 1, PICTURE, U::COPY_DST | U::TEXTURE_BINDING);
        let [view, under] = [&layer, &copy].map(|t| t.create_view(&wgpu::TextureViewDescriptor::default()));
        let entries = [(0, wgpu::BindingResource::TextureView(&view)), (1, wgpu::BindingResource::TextureView(&under))];
        let group = group(gpu, "furniture over", &pipelines.layouts.furniture_over, &entries);
        Self { size, copy, group, view }
    }
}

/// Linear colour and alpha. The colour is that of a byte, so that no adapter's rounding changes it.
fn with_alpha(color: Srgb, opacity: f32) -> [f32; 4] {
    let [r, g, b] = linear_from_srgb(color.map(|c| (c.clamp(0.0, 1.0) * 255.0).round() / 255.0));
    [r, g, b, opacity.clamp(0.0, 1.0)]
}

/// The pieces that meet a tile, in its pixels, and the coverage of their texts: two texels per word.
fn assembled(furniture: &Furniture, runs: &[Option<Run>], tile: PictureTile) -> (Vec<FurnitureItem>, Vec<u32>) {
    let (mut items, mut bytes) = (Vec::new(), Vec::<[u8; 2]>::new());
    let origin = tile.origin.map(|o| o as f32);
    let size = tile.size.map(|s| s as f32);
    let inside = |p: [f32; 2]| [p[0] - origin[0], p[1] - origin[1]];
    for (piece, run) in furniture.pieces.iter().zip(runs) {
        match (piece, run) {
            (Piece::Panel(panel), _) => {
                let (low, high) = (inside(panel.low), inside(panel.high));
                let softness = panel.softness_px.max(1.0);
                let seen = |i: usize| high[i] > low[i] && high[i] + softness > 0.0 && low[i] - softness < size[i];
                if seen(0) && seen(1) {
                    items.push(FurnitureItem {
                        low,
                        high,
                        color: with_alpha(panel.color, panel.opacity),
                        radius: panel.radius_px.max(0.0),
                        softness,
                        ..Default::default()
                    });
                }
            }
            (Piece::Text(line), Some(run)) => {
                let halo = line.halo.map_or([0.0; 4], |h| with_alpha(h.color, h.opacity));
                items.extend(clipped(run, tile, &mut bytes).map(|item| FurnitureItem {
                    color: with_alpha(line.color, 1.0),
                    halo,
                    ..item
                }));
            }
            (Piece::Text(_), None) => {}
        }
    }
    if bytes.len() % 2 == 1 {
        bytes.push([0, 0]);
    }
    (items, bytes.as_chunks().0.iter().map(|[[a, b], [c, d]]| u32::from_le_bytes([*a, *b, *c, *d])).collect())
}

/// The part of a run that is in a tile; its coverage is appended.
fn clipped(run: &Run, tile: PictureTile, bytes: &mut Vec<[u8; 2]>) -> Option<FurnitureItem> {
    let low: [u32; 2] = std::array::from_fn(|i| run.origin[i].max(tile.origin[i]));
    let high: [u32; 2] = std::array::from_fn(|i| (run.origin[i] + run.size[i]).min(tile.origin[i] + tile.size[i]));
    if low[0] >= high[0] || low[1] >= high[1] {
        return None;
    }
    let first_texel = bytes.len() as u32;
    for y in low[1]..high[1] {
        let row = (y - run.origin[1]) as usize * run.size[0] as usize;
        let column = |x: u32| row + (x - run.origin[0]) as usize;
        bytes.extend(&run.texels[column(low[0])..column(high[0])]);
    }
    let inside = |p: [u32; 2]| std::array::from_fn(|i| (p[i] - tile.origin[i]) as f32);
    let row_texels = high[0] - low[0];
    Some(FurnitureItem { low: inside(low), high: inside(high), first_texel, row_texels, ..Default::default() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tiles_share_a_run_without_gap_or_overlap() {
        let texels: Vec<[u8; 2]> = (0..7 * 5).map(|i| [i as u8 + 1, 0]).collect();
        let run = Run { origin: [3, 2], size: [7, 5], texels };
        let mut seen = [0_u8; 12 * 9];
        for (x, y) in [(0, 0), (5, 0), (10, 0), (0, 4), (5, 4), (10, 4)] {
            let tile = PictureTile { origin: [x, y], size: [5, if y == 0 { 4 } else { 5 }] };
            let mut bytes = vec![[99, 99]; 3];
            let Some(item) = clipped(&run, tile, &mut bytes) else { continue };
            assert_eq!(item.first_texel, 3);
            let [low, high] = [item.low, item.high].map(|p| p.map(|v| v as u32));
            for (i, (row, column)) in
                (low[1]..high[1]).flat_map(|row| (low[0]..high[0]).map(move |column| (row, column))).enumerate()
            {
                let at = ((row + y) * 12 + column + x) as usize;
                assert_eq!(seen[at], 0);
                seen[at] = bytes[3 + i][0];
            }
        }
        for (i, value) in seen.iter().enumerate() {
            let (x, y) = (i as i32 % 12 - 3, i as i32 / 12 - 2);
            let expected = if (0..7).contains(&x) && (0..5).contains(&y) { (y * 7 + x + 1) as u8 } else { 0 };
            assert_eq!(*value, expected, "{x} {y}");
        }
    }
}
