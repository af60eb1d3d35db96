//! Furniture on the GPU, set once, and the pipelines that draw it.

use crate::{
    gpu::{Gpu, GpuError},
    render::{
        eye::PictureTile,
        furniture::{Furniture, FurniturePart, Piece},
        furniture_set::{Assembled, Batch, assembled},
        images::{FURNITURE_PICTURE, Images},
        layout::{self, FurnitureItem},
        resource::{
            bindings::{DRAWN, FLOATS, GroupLayout, STORAGE, UNIFORM, group},
            formats::{FURNITURE_LAYER, PICTURE},
            key::{Draw, Parts, PipelineKey, Stage, target},
            pipelines::Pipelines,
            recording::Counted,
            synced::Synced,
            vertices::per_vertex,
        },
        text::{Run, Typesetter, polygon},
    },
    shader::Module,
};

/// Group 0: the target, coverage of text.
static FURNITURE: GroupLayout =
    GroupLayout { label: "furniture", entries: &[(0, DRAWN, UNIFORM), (1, wgpu::ShaderStages::FRAGMENT, STORAGE)] };
/// Furniture over a transparent picture, group 0: both.
static FURNITURE_OVER: GroupLayout = GroupLayout {
    label: "furniture over",
    entries: &[(0, wgpu::ShaderStages::FRAGMENT, FLOATS), (1, wgpu::ShaderStages::FRAGMENT, FLOATS)],
};

const ITEM: &[wgpu::VertexAttribute] = &wgpu::vertex_attr_array![
    0 => Float32x2, 1 => Float32x2, 2 => Float32x4, 3 => Float32x4, 4 => Float32, 5 => Float32, 6 => Uint32, 7 => Uint32, 8 => Float32x4];
const STRIP: &[wgpu::VertexAttribute] = &wgpu::vertex_attr_array![
    0 => Float32x2, 1 => Float32, 2 => Float32, 3 => Float32, 4 => Float32, 5 => Float32x2, 6 => Float32x4, 7 => Float32x4];

/// Titles, captions and legends; over the picture, or into a layer of their own where it is transparent.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) struct FurnitureKey {
    /// Into a layer.
    pub layered: bool,
    /// Which of them.
    pub part: FurniturePart,
}

impl FurnitureKey {
    fn word(&self) -> &'static str {
        match self.part {
            FurniturePart::Items => "furniture",
            FurniturePart::Solid => "opaque panels",
            FurniturePart::Picture => "overlays",
            FurniturePart::OpaquePicture => "opaque overlays",
            FurniturePart::Board => "call-outs",
            FurniturePart::Strip => "context lines",
            FurniturePart::Skin => "context lines with a skin",
        }
    }

    fn entry_points(&self) -> (&'static str, &'static str) {
        match self.part {
            FurniturePart::Items => ("vertex", "fragment"),
            FurniturePart::Solid => ("vertex", "solid"),
            FurniturePart::Picture => ("vertex", "picture_fragment"),
            FurniturePart::OpaquePicture => ("vertex", "opaque_picture"),
            FurniturePart::Board => ("vertex", "board"),
            FurniturePart::Strip => ("strip_vertex", "strip"),
            FurniturePart::Skin => ("strip_vertex", "strip_skin"),
        }
    }

    fn vertex_buffer(&self) -> Option<wgpu::VertexBufferLayout<'static>> {
        match self.part {
            FurniturePart::Strip | FurniturePart::Skin => per_vertex(size_of::<layout::StripVertex>() as u64, STRIP),
            _ => Some(wgpu::VertexBufferLayout {
                array_stride: size_of::<FurnitureItem>() as u64,
                step_mode: wgpu::VertexStepMode::Instance,
                attributes: ITEM,
            }),
        }
    }
}

impl PipelineKey for FurnitureKey {
    fn name(&self) -> String {
        format!("{}{}", self.word(), if self.layered { " in a layer" } else { "" })
    }

    fn parts(&self, _: wgpu::TextureFormat) -> Parts {
        use FurniturePart as P;
        let is_opaque = matches!(self.part, P::Solid | P::OpaquePicture);
        let has_image = matches!(self.part, P::Picture | P::OpaquePicture | P::Board | P::Skin);
        let blend = (!is_opaque).then_some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING);
        let (vertex, fragment) = self.entry_points();
        let image = has_image.then_some(Some(&FURNITURE_PICTURE));
        Parts {
            module: Module::Furniture,
            groups: std::iter::once(Some(&FURNITURE)).chain(image).collect(),
            constants: Vec::new(),
            stage: Stage::Draw(Draw {
                buffers: vec![self.vertex_buffer()],
                targets: vec![target(if self.layered { FURNITURE_LAYER } else { PICTURE }, blend)],
                ..Draw::new(vertex, Some(fragment))
            }),
        }
    }
}

/// The layer of furniture over a transparent picture.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) struct FurnitureOverKey;

impl PipelineKey for FurnitureOverKey {
    fn name(&self) -> String {
        "furniture over a transparent picture".to_owned()
    }

    fn parts(&self, _: wgpu::TextureFormat) -> Parts {
        Parts {
            module: Module::FurnitureOver,
            groups: vec![Some(&FURNITURE_OVER)],
            constants: Vec::new(),
            stage: Stage::Draw(Draw { targets: vec![target(PICTURE, None)], ..Draw::new("vertex", Some("fragment")) }),
        }
    }
}

/// Furniture on the GPU.
#[derive(Debug)]
pub struct FurnitureOnGpu {
    setter: Typesetter,
    /// What the runs were made of, for a picture of this size.
    of: (Furniture, [u32; 2]),
    /// One per piece; panels and texts without a pixel have none.
    runs: Vec<Option<Run>>,
    /// Per piece, whether it is an image without transparency.
    opaque: Vec<bool>,
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

/// What furniture stands over.
#[derive(Clone, Copy, Debug)]
pub struct Over {
    /// Width and height of the picture.
    pub whole: [u32; 2],
    /// What of it is drawn.
    pub tile: PictureTile,
    /// Whether it is transparent.
    pub layered: bool,
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
            opaque: Vec::new(),
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

    /// Brings the buffers up to date for a tile of a picture.
    pub fn fit(
        &mut self,
        gpu: &Gpu,
        pipelines: &Pipelines,
        images: &Images,
        furniture: &Furniture,
        Over { whole, tile, layered }: Over,
    ) -> Result<(), GpuError> {
        if self.of.1 != whole || self.of.0 != *furniture {
            let set = |piece: &Piece| match piece {
                Piece::Panel(_) | Piece::Image(_) | Piece::Board(_) | Piece::Strip(_) => None,
                Piece::Text(line) => self.setter.rasterised(line, whole),
                Piece::Polygon(polygon) => polygon::rasterised(&polygon.points, whole),
            };
            self.runs = furniture.pieces.iter().map(set).collect();
            self.of = (furniture.clone(), whole);
            self.tile = None;
        }
        let is_opaque = |piece: &Piece| matches!(piece, Piece::Image(image) if images.is_opaque(image.image));
        if !self.opaque.iter().copied().eq(furniture.pieces.iter().map(is_opaque)) {
            self.opaque = furniture.pieces.iter().map(is_opaque).collect();
            self.tile = None;
        }
        if self.tile != Some(tile) {
            let Assembled { items, corners, coverage, batches } = assembled(furniture, &self.runs, &self.opaque, tile);
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
            group(gpu, "furniture", &pipelines.layout(&FURNITURE), &entries)
        });
        if !layered {
            self.layer = None;
        } else if self.layer.as_ref().is_none_or(|l| l.size != tile.size) {
            self.layer = Some(Layer::new(gpu, pipelines, tile.size));
        }
        Ok(())
    }

    /// Draws and triangles in the tile.
    pub fn counts(&self) -> Counted {
        Counted { draws: self.batches.len() as u32, triangles: self.triangles }
    }

    /// Where to draw, if not on the picture.
    pub fn layer(&self) -> Option<&wgpu::TextureView> {
        self.layer.as_ref().map(|l| &l.view)
    }

    /// Draws every piece, in order.
    pub fn draw(&self, pass: &mut wgpu::RenderPass, gpu: &Gpu, pipelines: &Pipelines, images: &Images, layered: bool) {
        pass.set_bind_group(0, self.group.as_ref(), &[]);
        for batch in &self.batches {
            let (vertices, instances, buffer) = match batch.part {
                FurniturePart::Strip | FurniturePart::Skin => (batch.of.clone(), 0..1, &self.corners),
                _ => (0..6, batch.of.clone(), &self.items),
            };
            if let Some((image, mask)) = batch.image {
                let Some(group) = images.group(gpu, pipelines, image, mask) else { continue };
                pass.set_bind_group(1, &group, &[]);
            }
            pass.set_pipeline(pipelines.get(&FurnitureKey { layered, part: batch.part }));
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
        let group = group(gpu, "furniture over", &pipelines.layout(&FURNITURE_OVER), &entries);
        Self { size, copy, group, view }
    }
}
