//! Furniture: what stands over a finished picture - panels, swatches, lines of text - as plain data, and its buffers.
//!
//! Whoever makes it (titles, captions, legends: [`crate::figure`]) says where everything stands in pixels of the whole
//! picture; tiles of a large picture each take their part. Equal furniture is set once.

use std::ops::Range;

use glam::Vec2;

use crate::{
    gpu::{Gpu, GpuError},
    lens::color::{Srgb, linear_from_srgb},
    render::{
        eye::PictureTile,
        images::Images,
        key::{FurniturePart, Key},
        layout::{FurnitureItem, StripVertex},
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
    /// An image that the renderer keeps.
    Image(ImagePiece),
    /// A context line.
    Strip(Strip),
}

/// An image of [`Renderer::images`](crate::render::images::Images), texel by texel; what of it is missing there is not drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImagePiece {
    /// Its number there.
    pub image: u64,
    /// The number of the image that says what of it is seen, stretched over it: the mean of its colours, times its alpha.
    pub mask: Option<u64>,
    /// Left, top, whole pixels from the picture's top left.
    pub low: [f32; 2],
    /// Right, bottom.
    pub high: [f32; 2],
    /// Whether left and right are exchanged.
    pub mirror: bool,
    /// 0 to 1.
    pub opacity: f32,
    /// Whether it is an ellipse.
    pub ellipse: bool,
    /// Radius of the corners, pixels.
    pub radius_px: f32,
    /// Over how many pixels the border fades: 1 is a clean one, more lies inside; ≥ 1.
    pub softness_px: f32,
    /// Fisheye: how many times larger the middle is ([`crate::view::local::fisheye`]); the image is as much larger than its place. At 1, its texels are pixels.
    pub magnification: f32,
}

/// A way of so many widths through the picture (B7).
#[derive(Clone, Debug, PartialEq)]
pub struct Strip {
    /// The way, pixels from the picture's top left; no point twice in a row.
    pub points: Vec<[f32; 2]>,
    /// Its widths at both ends, pixels.
    pub widths: [f32; 2],
    /// sRGB 0..1.
    pub color: Srgb,
    /// 0 to 1.
    pub opacity: f32,
    /// The number of the image that is laid along it.
    pub skin: Option<u64>,
    /// What it fades towards: a point, and the radii within which nothing and beyond which all is seen, pixels.
    pub fade: Option<([f32; 2], [f32; 2])>,
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
    /// Whether it is the ellipse that fills the rectangle.
    pub ellipse: bool,
}

/// No furniture, to be borrowed.
pub static NONE: Furniture = Furniture { pieces: Vec::new() };

impl Furniture {
    /// Whether there is nothing to draw.
    pub fn is_empty(&self) -> bool {
        self.pieces.is_empty()
    }

    /// What draws it; some of it may come twice.
    pub(super) fn parts(&self) -> impl Iterator<Item = FurniturePart> {
        self.pieces.iter().map(|piece| match piece {
            Piece::Panel(_) | Piece::Text(_) => FurniturePart::Items,
            Piece::Image(_) => FurniturePart::Picture,
            Piece::Strip(strip) => strip_part(strip.skin),
        })
    }
}

/// What is drawn at once.
#[derive(Clone, Debug)]
enum Batch {
    /// Panels and texts.
    Items(Range<u32>),
    /// One image, an item of its own, and its mask.
    Image { item: u32, image: u64, mask: Option<u64> },
    /// Corners of a strip.
    Strip { corners: Range<u32>, skin: Option<u64> },
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
    corners: Synced,
    coverage: Synced,
    batches: Vec<Batch>,
    group: Option<wgpu::BindGroup>,
    layer: Option<Layer>,
    triangles: u64,
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
            corners: Synced::new(gpu, "corners of context lines", U::VERTEX)?,
            coverage: Synced::new(gpu, "furniture coverage", U::STORAGE)?,
            batches: Vec::new(),
            group: None,
            layer: None,
            triangles: 0,
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
                Piece::Panel(_) | Piece::Image(_) | Piece::Strip(_) => None,
                Piece::Text(line) => self.setter.rasterised(line, whole),
            };
            self.runs = furniture.pieces.iter().map(set).collect();
            self.of = (furniture.clone(), whole);
            self.tile = None;
        }
        if self.tile != Some(tile) {
            let Assembled { items, corners, coverage, batches } = assembled(furniture, &self.runs, tile);
            let size = tile.size.map(|side| side as f32);
            let mut stale = self.frame.sync(gpu, &[size])?;
            stale |= self.coverage.sync(gpu, &coverage)?;
            self.items.sync(gpu, &items)?;
            self.corners.sync(gpu, &corners)?;
            self.triangles = 2 * items.len() as u64 + corners.len() as u64 / 3;
            self.batches = batches;
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

    /// Draws and triangles in the tile.
    pub fn counts(&self) -> (u32, u64) {
        (self.batches.len() as u32, self.triangles)
    }

    /// Where to draw, if not on the picture.
    pub fn layer(&self) -> Option<&wgpu::TextureView> {
        self.layer.as_ref().map(|l| &l.view)
    }

    /// Draws every piece, in order.
    pub fn draw(&self, pass: &mut wgpu::RenderPass, gpu: &Gpu, pipelines: &Pipelines, images: &Images, layered: bool) {
        pass.set_bind_group(0, self.group.as_ref(), &[]);
        for batch in &self.batches {
            let (part, bound, vertices, instances, buffer) = match batch {
                Batch::Items(items) => (FurniturePart::Items, None, 0..6, items.clone(), &self.items),
                Batch::Image { item, image, mask } => {
                    (FurniturePart::Picture, Some((*image, *mask)), 0..6, *item..item + 1, &self.items)
                }
                Batch::Strip { corners, skin } => {
                    (strip_part(*skin), skin.map(|skin| (skin, None)), corners.clone(), 0..1, &self.corners)
                }
            };
            if let Some((image, mask)) = bound {
                let Some(group) = images.group(gpu, pipelines, image, mask) else { continue };
                pass.set_bind_group(1, &group, &[]);
            }
            pass.set_pipeline(pipelines.get(&Key::Furniture { layered, part }));
            pass.set_vertex_buffer(0, buffer.buffer().slice(..));
            pass.draw(vertices, instances);
        }
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

/// The pieces that meet a tile, in its pixels.
#[derive(Default)]
struct Assembled {
    items: Vec<FurnitureItem>,
    corners: Vec<StripVertex>,
    /// Of texts: two texels per word.
    coverage: Vec<u32>,
    batches: Vec<Batch>,
}

impl Assembled {
    /// Puts the items from `first` on into a batch with those before them.
    fn batch_items(&mut self, first: usize) {
        let end = self.items.len() as u32;
        match self.batches.last_mut() {
            Some(Batch::Items(items)) => items.end = end,
            _ if first as u32 == end => {}
            _ => self.batches.push(Batch::Items(first as u32..end)),
        }
    }
}

/// The pieces that meet a tile.
fn assembled(furniture: &Furniture, runs: &[Option<Run>], tile: PictureTile) -> Assembled {
    let mut all = Assembled::default();
    let mut bytes = Vec::<[u8; 2]>::new();
    let origin = tile.origin.map(|o| o as f32);
    let size = tile.size.map(|s| s as f32);
    let inside = |p: [f32; 2]| [p[0] - origin[0], p[1] - origin[1]];
    for (piece, run) in furniture.pieces.iter().zip(runs) {
        let first = all.items.len();
        let items = &mut all.items;
        match (piece, run) {
            (Piece::Image(image), _) => {
                let (low, high) = (inside(image.low), inside(image.high));
                if (0..2).all(|i| high[i] > low[i] && high[i] > 0.0 && low[i] < size[i]) {
                    let flag = |on: bool| f32::from(u8::from(on));
                    items.push(FurnitureItem {
                        low,
                        high,
                        color: [0.0, 0.0, 0.0, image.opacity.clamp(0.0, 1.0)],
                        halo: [flag(image.mirror), flag(image.ellipse), (image.magnification - 1.0).max(0.0), 0.0],
                        radius: image.radius_px.max(0.0),
                        softness: image.softness_px.max(1.0),
                        ..Default::default()
                    });
                    all.batches.push(Batch::Image { item: first as u32, image: image.image, mask: image.mask });
                }
                continue;
            }
            (Piece::Strip(strip), _) => {
                let first = all.corners.len() as u32;
                all.corners.extend(strip_corners(strip, origin));
                let end = all.corners.len() as u32;
                match all.batches.last_mut() {
                    Some(Batch::Strip { corners, skin }) if *skin == strip.skin => corners.end = end,
                    _ => all.batches.push(Batch::Strip { corners: first..end, skin: strip.skin }),
                }
                continue;
            }
            (Piece::Panel(panel), _) => {
                let (low, high) = (inside(panel.low), inside(panel.high));
                let softness = panel.softness_px.max(1.0);
                let seen = |i: usize| high[i] > low[i] && high[i] + softness > 0.0 && low[i] - softness < size[i];
                if seen(0) && seen(1) {
                    items.push(FurnitureItem {
                        low,
                        high,
                        color: with_alpha(panel.color, panel.opacity),
                        halo: [0.0, f32::from(u8::from(panel.ellipse)), 0.0, 0.0],
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
        all.batch_items(first);
    }
    if bytes.len() % 2 == 1 {
        bytes.push([0, 0]);
    }
    all.coverage = bytes.as_chunks().0.iter().map(|[[a, b], [c, d]]| u32::from_le_bytes([*a, *b, *c, *d])).collect();
    all
}

fn strip_part(skin: Option<u64>) -> FurniturePart {
    if skin.is_some() { FurniturePart::Skin } else { FurniturePart::Strip }
}

/// How far a mitre may reach, in half widths; sharper bends are cut there.
const MITRE: f32 = 3.0;

/// The triangles of a strip, three corners each, with a pixel around it. At bends its sides meet in a mitre.
fn strip_corners(strip: &Strip, origin: [f32; 2]) -> Vec<StripVertex> {
    let points: Vec<Vec2> = strip.points.iter().map(|p| Vec2::from(*p) - Vec2::from(origin)).collect();
    let normal = |pair: &[Vec2]| (pair[1] - pair[0]).perp().normalize_or(Vec2::Y);
    let normals: Vec<Vec2> = points.windows(2).map(normal).collect();
    let mut along = vec![0.0_f32];
    for pair in points.windows(2) {
        along.push(along[along.len() - 1] + pair[0].distance(pair[1]));
    }
    let length = along[along.len() - 1];
    if normals.is_empty() || length <= 0.0 {
        return Vec::new();
    }
    let ends = strip.widths.map(|width| 0.5 * width);
    let fade = strip.fade.map_or([0.0; 4], |(at, radii)| [at[0] - origin[0], at[1] - origin[1], radii[0], radii[1]]);
    let color = with_alpha(strip.color, strip.opacity);
    let mut sides: Vec<[StripVertex; 2]> = Vec::new();
    for (i, point) in points.iter().enumerate() {
        let before = normals[i.max(1) - 1];
        let after = normals[i.min(normals.len() - 1)];
        let middle = (before + after).normalize_or(after);
        let stretch = (1.0 / middle.dot(after).max(1.0 / MITRE)).min(MITRE);
        let half_width = ends[0] + (ends[1] - ends[0]) * along[i] / length;
        let reach = half_width.max(0.5) + 1.0;
        // Half a pixel beyond the ends, where their borders fade.
        let beyond = match i {
            0 => -0.5,
            _ if i + 1 == points.len() => 0.5,
            _ => 0.0,
        };
        let ahead = -after.perp();
        let corner = |sign: f32| StripVertex {
            at: (*point + sign * reach * stretch * middle + beyond * ahead).into(),
            across: sign * reach,
            half_width,
            along: along[i] + beyond,
            length,
            ends,
            color,
            fade,
        };
        sides.push([corner(1.0), corner(-1.0)]);
    }
    let quads = sides.windows(2).flat_map(|pair| {
        let ([a, b], [c, d]) = (pair[0], pair[1]);
        [a, b, c, c, b, d]
    });
    quads.collect()
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
