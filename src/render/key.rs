//! What makes a pipeline the one it is: its module, entry points, targets and depth test.

use crate::{
    render::{
        city::SectionKind,
        edges::Edge,
        layout,
        pipelines::{
            CODES, COLORS, DEPTH, FILTERED, FURNITURE_LAYER, LINES, OWN_DEPTH, PICTURE, REGIONS, SMOOTH_CODES, SPRITES,
            VEIL,
        },
        sprite_passes::SolidStage,
        stored::LIST_TARGET,
        transparency::{SlotKeys, TranslucentKey},
    },
    shader::{Module, Plan, Program, VolumeTest},
};

/// Which furniture a pipeline draws.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum FurniturePart {
    /// Panels and text.
    Items,
    /// Insides of opaque panels.
    Solid,
    /// Pictures of overlays.
    Picture,
    /// Insides of opaque pictures.
    OpaquePicture,
    /// Overlays that stand in the scene.
    Board,
    /// Context lines of one colour.
    Strip,
    /// Context lines with a skin.
    Skin,
}

impl FurniturePart {
    fn name(self) -> &'static str {
        match self {
            Self::Items => "furniture",
            Self::Solid => "opaque panels",
            Self::Picture => "overlays",
            Self::OpaquePicture => "opaque overlays",
            Self::Board => "call-outs",
            Self::Strip => "context lines",
            Self::Skin => "context lines with a skin",
        }
    }

    fn is_opaque(self) -> bool {
        matches!(self, Self::Solid | Self::OpaquePicture)
    }

    fn entry_points(self) -> (&'static str, Option<&'static str>) {
        match self {
            Self::Items => ("vertex", Some("fragment")),
            Self::Solid => ("vertex", Some("solid")),
            Self::Picture => ("vertex", Some("picture_fragment")),
            Self::OpaquePicture => ("vertex", Some("opaque_picture")),
            Self::Board => ("vertex", Some("board")),
            Self::Strip => ("strip_vertex", Some("strip")),
            Self::Skin => ("strip_vertex", Some("strip_skin")),
        }
    }
}

/// What makes a pipeline the one it is.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Key {
    /// Opaque triangles.
    Geometry {
        /// How vertices are laid out and where depth comes from.
        section: GeometryKind,
        /// Whether base colours are written.
        colored: bool,
        /// Whether normals are interpolated.
        smooth: bool,
        /// Whether they are in other cities of the picture, and this one has flat faces alone.
        flat: bool,
        /// Whether interpolated depth is written, for the AOV.
        measured: bool,
        /// What is hidden; of a program that tells regions apart, what is not in the one that is drawn.
        cut: Option<Program>,
    },
    /// Depth from the sun, and what is hidden from it.
    Shadow(Option<Program>),
    /// One of the draws that make the depth sprite of a solid.
    SolidSprite(SolidStage),
    /// One of those of a combination, and what its leaves are.
    CombinedSprite(SolidStage, Vec<VolumeTest>),
    /// The stored depth sprite of a volume that has a closed form, by its kind.
    StoredForm(VolumeTest),
    /// That of a lens of several leaves, or of a solid, and what the leaves are.
    StoredLayers(Vec<VolumeTest>),
    /// Where rays go through the faces of its solids.
    SpriteList,
    /// Shading.
    Shade {
        /// What the context and the lenses do.
        program: Program,
        /// Which pixels.
        shown: Shown,
        /// Base colours come from a target.
        textured: bool,
        /// One clay colour.
        clay: bool,
        /// Where it goes.
        target: ShadeTarget,
        /// There is a shadow map.
        shadows: bool,
        /// Normals are in the target.
        smooth: bool,
        /// Some of what is shown are sections.
        sections: bool,
        /// What is behind the city.
        behind: Behind,
    },
    /// Edges as lines, and whether normals are in the target.
    Lines {
        /// What lines go through.
        program: Program,
        /// Normals are in the target.
        smooth: bool,
    },
    /// Lists of translucent layers.
    Layers {
        /// How vertices are laid out and where depth comes from.
        section: GeometryKind,
        /// Whether some faces of the picture have normals per vertex.
        smooth: bool,
        /// Whether they are in other cities of the picture, and this one has flat faces alone.
        flat: bool,
        /// Whether the picture has textures.
        textured: bool,
        /// What is translucent.
        program: Program,
        /// All is.
        all: bool,
        /// Whether the depth test can come first.
        early: bool,
    },
    /// Translucent layers, one over the other.
    Composite {
        /// What the context and the lenses do.
        program: Program,
        /// Base colours come from textures.
        textured: bool,
        /// One clay colour.
        clay: bool,
        /// There is a shadow map.
        shadows: bool,
        /// Normals are in the lists.
        smooth: bool,
        /// Which layer is the shown surface is written down.
        shown: bool,
        /// Lists are in order.
        sorted: bool,
        /// Words of the record that the method keeps of each pixel, 0 for none.
        record: u32,
        /// What found no place is one layer behind the others.
        tail: bool,
        /// One layer is told in place of all.
        picks: bool,
    },
    /// Translucent fragments one by one, by methods that keep no list of all.
    Translucent(TranslucentKey),
    /// Slots as lists.
    LinkSlots(SlotKeys),
    /// How many layers the pixel has that has most, of notes of so many words.
    CountLayers(u32),
    /// A step of sorting long lists.
    SortLayers {
        /// Words of a note.
        words: u32,
        /// How many notes are in order before.
        width: u32,
    },
    /// Layers that are the shown surface.
    ShownLayers {
        /// Normals are in the target.
        smooth: bool,
        /// Depth is written, for the AOV.
        measured: bool,
    },
    /// Regions as depths, and how they are told apart.
    Regions(Plan),
    /// One of the draws that make sections, and what is hidden.
    Section {
        /// What is hidden.
        program: Program,
        /// Which draw.
        draw: SectionDraw,
    },
    /// One direction of a neighbourhood filter, by its handler.
    Filter(u32),
    /// The mean of samples.
    Resolve,
    /// Titles, captions and legends; over the picture, or into a layer of their own where it is transparent.
    Furniture {
        /// Into a layer.
        layered: bool,
        /// Which of them.
        part: FurniturePart,
    },
    /// The layer of furniture over a transparent picture.
    FurnitureOver,
    /// One lit pass without anything else: what benchmarks compare with.
    Bare,
}

/// The draws of `pass/sections.wgsl`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum SectionDraw {
    /// Where volumes end.
    Ends,
    /// How many shells are there.
    Count,
    /// The sections.
    Fill {
        /// Interpolated depth is written, for the AOV.
        measured: bool,
    },
}

/// Pixels that shading is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Shown {
    /// Those that show a surface.
    Surface,
    /// Those that show what is behind the city.
    Background,
    /// All; four at once.
    Any,
    /// Those that show a surface of the region whose depth the target of regions has.
    RegionSurface,
    /// Those of it that show what is behind the city.
    RegionBackground,
}

/// Where shading goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ShadeTarget {
    /// The picture.
    Picture,
    /// The sum of samples, weighted by coverage.
    Sums,
    /// What a filter reads: colours weighted by coverage, and where the picture is transparent their opacity.
    Unfiltered,
}

/// What is behind the city, as `lib/light.wgsl` numbers it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Behind {
    /// The sky.
    Sky = 0,
    /// One colour.
    OneColor = 1,
    /// The picture is transparent.
    Nothing = 2,
}

impl Behind {
    /// Images that a neighbourhood filter has of such a picture: colours, and of a transparent one opacity.
    pub fn images(self) -> usize {
        1 + usize::from(self == Self::Nothing)
    }
}

/// Kinds of geometry sections, as far as pipelines differ.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum GeometryKind {
    /// Ordinary.
    Plain,
    /// Textured, with the bits of the alpha cutoff.
    Textured(u32),
    /// Depth from the shared plane.
    Coplanar,
}

impl From<SectionKind> for GeometryKind {
    fn from(kind: SectionKind) -> Self {
        match kind {
            SectionKind::Plain => Self::Plain,
            SectionKind::Textured { alpha_cutoff, .. } => Self::Textured(alpha_cutoff.to_bits()),
            SectionKind::Coplanar => Self::Coplanar,
        }
    }
}

const VERTEX: &[wgpu::VertexAttribute] =
    &wgpu::vertex_attr_array![0 => Sint32x3, 1 => Uint32, 2 => Float32x3, 3 => Uint32];
const TEXCOORD: &[wgpu::VertexAttribute] = &wgpu::vertex_attr_array![4 => Float32x2];
const PLANE: &[wgpu::VertexAttribute] = &wgpu::vertex_attr_array![4 => Float32x3, 5 => Sint32x3, 6 => Float32];
const SOLID_CORNER: &[wgpu::VertexAttribute] = &wgpu::vertex_attr_array![0 => Float32x3];
const CORNER: &[wgpu::VertexAttribute] = &wgpu::vertex_attr_array![0 => Float32x2];
const FURNITURE: &[wgpu::VertexAttribute] = &wgpu::vertex_attr_array![
    0 => Float32x2, 1 => Float32x2, 2 => Float32x4, 3 => Float32x4, 4 => Float32, 5 => Float32, 6 => Uint32, 7 => Uint32, 8 => Float32x4];

const STRIP: &[wgpu::VertexAttribute] = &wgpu::vertex_attr_array![
    0 => Float32x2, 1 => Float32, 2 => Float32, 3 => Float32, 4 => Float32, 5 => Float32x2, 6 => Float32x4, 7 => Float32x4];

fn per_vertex(array_stride: u64, attributes: &[wgpu::VertexAttribute]) -> Option<wgpu::VertexBufferLayout<'_>> {
    Some(wgpu::VertexBufferLayout { array_stride, step_mode: wgpu::VertexStepMode::Vertex, attributes })
}

impl Key {
    /// Whether it draws what of the city is in one region.
    pub(super) fn is_of_region(&self) -> bool {
        matches!(self, Self::Geometry { cut: Some(program), .. } if program.regions().is_some())
    }

    pub(super) fn module(&self) -> Module {
        match self {
            Self::Geometry { cut, .. } => Module::Geometry(cut.clone()),
            Self::Shadow(cut) => Module::Shadow(cut.clone()),
            Self::CombinedSprite(_, kinds) => Module::CombinedSprite(kinds.clone()),
            Self::StoredForm(_) => Module::StoredForm,
            Self::StoredLayers(kinds) => Module::StoredLayers(kinds.clone()),
            Self::SpriteList => Module::SpriteList,
            Self::SolidSprite(_) => Module::Sprite,
            Self::Shade { program, .. } => Module::Shade(program.clone()),
            Self::Lines { program, .. } => Module::Lines(program.clone()),
            Self::Layers { program, early, section, .. } => {
                Module::Layers(program.clone(), *early && *section != GeometryKind::Coplanar)
            }
            Self::Composite { program, .. } => Module::Composite(program.clone()),
            Self::CountLayers(_) => Module::CountLayers,
            Self::SortLayers { .. } => Module::SortLayers,
            Self::ShownLayers { .. } => Module::ShownLayers,
            Self::Translucent(own) => own.module(),
            Self::LinkSlots(_) => Module::LinkSlots,
            Self::Regions(plan) => Module::Regions(plan.clone()),
            Self::Section { program, .. } => Module::Sections(program.clone()),
            Self::Filter(effect) => Module::Filter(*effect),
            Self::Resolve => Module::Resolve,
            Self::Furniture { .. } => Module::Furniture,
            Self::FurnitureOver => Module::FurnitureOver,
            Self::Bare => Module::Bare,
        }
    }

    /// A name for people and statistics.
    pub fn name(&self) -> String {
        let flags = |list: &[(bool, &str)]| -> String {
            list.iter().filter(|(on, _)| *on).map(|(_, name)| format!(" {name}")).collect()
        };
        match self {
            Self::Geometry { section, colored, smooth, flat, measured, .. } => {
                let kind = match section {
                    GeometryKind::Plain => "",
                    GeometryKind::Textured(0) => " textured",
                    GeometryKind::Textured(_) => " textured with holes",
                    GeometryKind::Coplanar => " coplanar",
                };
                format!(
                    "{}{kind}{}",
                    self.module().name(),
                    flags(&[(*colored, "colored"), (*smooth, "smooth"), (*flat, "flat"), (*measured, "measured")])
                )
            }
            Self::Shadow(_) => self.module().name(),
            Self::StoredForm(kind) => format!("depth sprite of a {}", kind.constant().to_lowercase()),
            Self::StoredLayers(_) => "depth sprite in layers".to_owned(),
            Self::SpriteList => "crossings of a sprite".to_owned(),
            Self::SolidSprite(stage) | Self::CombinedSprite(stage, _) => match stage {
                SolidStage::Missed => "depth sprite of a solid",
                SolidStage::Nearest => "depth sprite of a solid, nearest",
                SolidStage::Farthest => "depth sprite of a solid, farthest",
                SolidStage::NearestForm => "depth sprite of a combination, nearest of its forms",
                SolidStage::FarthestForm => "depth sprite of a combination, farthest of its forms",
                SolidStage::NearestFace => "depth sprite of a combination, nearest of its faces",
                SolidStage::FarthestFace => "depth sprite of a combination, farthest of its faces",
            }
            .to_owned(),
            Self::Shade { shown, textured, clay, target, shadows, sections, .. } => {
                let list = [
                    (matches!(shown, Shown::Background | Shown::RegionBackground), "background"),
                    (matches!(shown, Shown::RegionSurface | Shown::RegionBackground), "of a region"),
                    (*textured, "textured"),
                    (*clay, "clay"),
                    (*target == ShadeTarget::Sums, "summed"),
                    (*target == ShadeTarget::Unfiltered, "unfiltered"),
                    (*shadows, "shadows"),
                    (*sections, "sections"),
                ];
                format!("{}{}", self.module().name(), flags(&list))
            }
            Self::Layers { section, smooth, flat, textured, all, .. } => {
                let kind = match section {
                    GeometryKind::Plain => "",
                    GeometryKind::Textured(0) => " of textures",
                    GeometryKind::Textured(_) => " of textures with holes",
                    GeometryKind::Coplanar => " coplanar",
                };
                let list = [(*all, "of all"), (*textured, "textured"), (*smooth, "smooth"), (*flat, "flat")];
                let flags = flags(&list);
                format!("{}{kind}{flags}", self.module().name())
            }
            Self::Composite { textured, clay, shadows, smooth, shown, sorted, record, tail, picks, .. } => {
                let list = [
                    (*picks, "of one layer"),
                    (*record == 1, "of slots"),
                    (*record > 1, "of peeling"),
                    (*tail, "and a tail"),
                    (*sorted && *record == 0 && !*tail, "sorted"),
                    (*textured, "textured"),
                    (*clay, "clay"),
                    (*shadows, "shadows"),
                    (*smooth, "smooth"),
                    (*shown, "shown"),
                ];
                format!("{}{}", self.module().name(), flags(&list))
            }
            Self::SortLayers { width, .. } => format!("{} by {width}", self.module().name()),
            Self::CountLayers(_) | Self::ShownLayers { .. } => self.module().name(),
            Self::Translucent(own) => own.name(),
            Self::LinkSlots(keys) => format!("{} ({})", self.module().name(), keys.slots),
            Self::Filter(_) | Self::Lines { .. } | Self::Regions(_) => self.module().name(),
            Self::Section { draw, .. } => {
                let draw = match draw {
                    SectionDraw::Ends => "ends",
                    SectionDraw::Count => "count",
                    SectionDraw::Fill { measured: false } => "fill",
                    SectionDraw::Fill { measured: true } => "fill measured",
                };
                format!("{} {draw}", self.module().name())
            }
            Self::Resolve => "resolve".to_owned(),
            Self::Furniture { layered, part } => {
                format!("{}{}", part.name(), if *layered { " in a layer" } else { "" })
            }
            Self::FurnitureOver => "furniture over a transparent picture".to_owned(),
            Self::Bare => "bare lit draw".to_owned(),
        }
    }

    pub(super) fn constants(&self) -> Vec<(&'static str, f64)> {
        let flag = |on: bool| f64::from(u8::from(on));
        match self {
            Self::Geometry { section, smooth, flat, .. } => {
                let mut list = vec![("SMOOTH", flag(*smooth)), ("FLAT_CITY", flag(*flat))];
                if let GeometryKind::Textured(cutoff) = section {
                    list.push(("ALPHA_CUTOFF", f64::from(f32::from_bits(*cutoff))));
                }
                list
            }
            Self::Shade { textured, clay, target, shadows, smooth, sections, behind, .. } => vec![
                ("TEXTURED", flag(*textured)),
                ("CLAY", flag(*clay)),
                ("SUMMED", flag(*target == ShadeTarget::Sums)),
                ("SHADOWS", flag(*shadows)),
                ("SMOOTH", flag(*smooth)),
                ("SECTIONS", flag(*sections)),
                ("BACKGROUND", f64::from(*behind as u32)),
            ],
            Self::Layers { section, smooth, flat, textured, all, .. } => {
                let mut list = vec![
                    ("SMOOTH", flag(*smooth)),
                    ("FLAT_CITY", flag(*flat)),
                    ("TEXTURED", flag(*textured)),
                    ("ALL", flag(*all)),
                ];
                if let GeometryKind::Textured(cutoff) = section {
                    list.push(("ALPHA_CUTOFF", f64::from(f32::from_bits(*cutoff))));
                }
                list
            }
            Self::Translucent(own) => own.constants(),
            Self::LinkSlots(keys) => keys.constants().to_vec(),
            Self::Composite { textured, clay, shadows, smooth, sorted, record, tail, picks, .. } => vec![
                ("SORTED", flag(*sorted)),
                ("RECORD", f64::from(*record)),
                ("TAIL", flag(*tail)),
                ("PICKS", flag(*picks)),
                ("TEXTURED", flag(*textured)),
                ("CLAY", flag(*clay)),
                ("SHADOWS", flag(*shadows)),
                ("SMOOTH", flag(*smooth)),
            ],
            Self::CountLayers(words) => vec![("WORDS", f64::from(*words))],
            Self::SortLayers { words, width } => vec![("WORDS", f64::from(*words)), ("WIDTH", f64::from(*width))],
            Self::Lines { smooth, .. } => vec![("SMOOTH", flag(*smooth))],
            Self::StoredForm(kind) => vec![("KIND", f64::from(kind.number()))],
            _ => Vec::new(),
        }
    }

    pub(super) fn compute_entry(&self) -> Option<&'static str> {
        match self {
            Self::StoredForm(_) | Self::StoredLayers(_) => Some("store"),
            Self::CountLayers(_) => Some("count"),
            Self::SortLayers { .. } => Some("sort"),
            Self::LinkSlots(_) => Some("link"),
            _ => None,
        }
    }

    pub(super) fn entry_points(&self) -> (&'static str, Option<&'static str>) {
        match self {
            Self::Geometry { section, colored, measured, smooth, .. } => {
                let full = *colored || *measured || self.is_of_region();
                match (section, smooth) {
                    (GeometryKind::Plain, false) => ("vertex", Some(if full { "full" } else { "plain" })),
                    (GeometryKind::Plain, true) => {
                        ("vertex_smooth", Some(if full { "smooth_full" } else { "smooth_plain" }))
                    }
                    (GeometryKind::Textured(_), _) => ("vertex_textured", Some("textured")),
                    (GeometryKind::Coplanar, _) => {
                        ("vertex_coplanar", Some(if full { "coplanar_full" } else { "coplanar_plain" }))
                    }
                }
            }
            Self::Layers { section, smooth, .. } => match (section, smooth) {
                (GeometryKind::Plain, false) => ("vertex", Some("note_plain")),
                (GeometryKind::Plain, true) => ("vertex_smooth", Some("note_smooth")),
                (GeometryKind::Textured(_), _) => ("vertex_textured", Some("note_textured")),
                (GeometryKind::Coplanar, _) => ("vertex_coplanar_layer", Some("note_coplanar")),
            },
            Self::Translucent(own) => own.entry_points(),
            Self::Furniture { part, .. } => part.entry_points(),
            Self::Composite { shown, .. } => ("vertex", Some(if *shown { "veil_and_shown" } else { "veil" })),
            Self::Shadow(None) => ("vertex", None),
            Self::Shade { shown, .. } => {
                let fragment = match shown {
                    Shown::Surface | Shown::RegionSurface => "surface",
                    Shown::Background | Shown::RegionBackground => "background",
                    Shown::Any => "unfiltered",
                };
                ("vertex", Some(fragment))
            }
            Self::Section { draw, .. } => match draw {
                SectionDraw::Ends => ("vertex_everywhere", Some("ends")),
                SectionDraw::Count => ("vertex", Some("count")),
                SectionDraw::Fill { .. } => ("vertex_everywhere", Some("fill")),
            },
            Self::SpriteList => ("vertex", Some("note")),
            Self::SolidSprite(SolidStage::Missed) => ("vertex", Some("missed")),
            Self::SolidSprite(SolidStage::Nearest) => ("vertex_of_solid", Some("nearest")),
            Self::SolidSprite(SolidStage::Farthest) => ("vertex_of_solid", Some("farthest")),
            Self::CombinedSprite(SolidStage::NearestForm, _) => ("vertex", Some("nearest_form")),
            Self::CombinedSprite(SolidStage::FarthestForm, _) => ("vertex", Some("farthest_form")),
            Self::CombinedSprite(SolidStage::NearestFace, _) => ("vertex_of_solid", Some("nearest_face")),
            Self::CombinedSprite(SolidStage::FarthestFace, _) => ("vertex_of_solid", Some("farthest_face")),
            _ => ("vertex", Some("fragment")),
        }
    }

    pub(super) fn vertex_buffers(&self) -> Vec<Option<wgpu::VertexBufferLayout<'static>>> {
        let vertex = per_vertex(size_of::<layout::CityVertex>() as u64, VERTEX);
        match self {
            Self::Geometry { section: GeometryKind::Textured(_), .. }
            | Self::Layers { section: GeometryKind::Textured(_), .. }
            | Self::Translucent(TranslucentKey { section: GeometryKind::Textured(_), .. }) => {
                vec![vertex, per_vertex(8, TEXCOORD)]
            }
            Self::Geometry { section: GeometryKind::Coplanar, .. }
            | Self::Layers { section: GeometryKind::Coplanar, .. }
            | Self::Translucent(TranslucentKey { section: GeometryKind::Coplanar, .. }) => {
                vec![vertex, per_vertex(size_of::<layout::Plane>() as u64, PLANE)]
            }
            Self::Geometry { .. }
            | Self::Layers { .. }
            | Self::Translucent(_)
            | Self::Shadow(_)
            | Self::Bare
            | Self::Section { draw: SectionDraw::Count, .. } => vec![vertex],
            Self::Lines { .. } => vec![Some(Edge::LAYOUT)],
            Self::Shade { .. } | Self::Composite { .. } | Self::Regions(_) | Self::Filter(_) => {
                vec![per_vertex(8, CORNER)]
            }
            Self::SpriteList
            | Self::SolidSprite(SolidStage::Nearest | SolidStage::Farthest)
            | Self::CombinedSprite(SolidStage::NearestFace | SolidStage::FarthestFace, _) => {
                vec![per_vertex(12, SOLID_CORNER)]
            }
            Self::Furniture { part: FurniturePart::Strip | FurniturePart::Skin, .. } => {
                vec![per_vertex(size_of::<layout::StripVertex>() as u64, STRIP)]
            }
            Self::Furniture { .. } => vec![Some(wgpu::VertexBufferLayout {
                array_stride: size_of::<layout::FurnitureItem>() as u64,
                step_mode: wgpu::VertexStepMode::Instance,
                attributes: FURNITURE,
            })],
            _ => Vec::new(),
        }
    }

    pub(super) fn topology(&self) -> wgpu::PrimitiveTopology {
        match self {
            Self::Lines { .. } => wgpu::PrimitiveTopology::TriangleStrip,
            _ => wgpu::PrimitiveTopology::TriangleList,
        }
    }

    pub(super) fn targets(&self, sums: wgpu::TextureFormat) -> Vec<Option<wgpu::ColorTargetState>> {
        match self {
            Self::Geometry { colored, measured, smooth, .. } => {
                let codes = if *smooth { SMOOTH_CODES } else { CODES };
                let mut targets = vec![Some(codes.into()), colored.then(|| COLORS.into())];
                targets.extend(measured.then(|| Some(OWN_DEPTH.into())));
                // Without the colour target the list ends where it may.
                targets.truncate(if *measured { 3 } else { 1 + usize::from(*colored) });
                if self.is_of_region() {
                    targets.resize(3, None);
                    targets.push(Some(REGIONS.into()));
                }
                targets
            }
            Self::Shade { target: ShadeTarget::Sums, .. } => {
                let add = wgpu::BlendComponent {
                    src_factor: wgpu::BlendFactor::One,
                    dst_factor: wgpu::BlendFactor::One,
                    operation: wgpu::BlendOperation::Add,
                };
                vec![Some(wgpu::ColorTargetState {
                    format: sums,
                    blend: Some(wgpu::BlendState { color: add, alpha: add }),
                    write_mask: wgpu::ColorWrites::ALL,
                })]
            }
            Self::Composite { shown, .. } => {
                let all = [VEIL, SMOOTH_CODES, OWN_DEPTH].map(|format| Some(format.into()));
                all[..if *shown { 3 } else { 1 }].to_vec()
            }
            Self::ShownLayers { smooth, measured } => {
                let codes = if *smooth { SMOOTH_CODES } else { CODES };
                [Some(codes.into())].into_iter().chain(measured.then(|| Some(OWN_DEPTH.into()))).collect()
            }
            Self::Translucent(own) => own.targets(sums),
            Self::SpriteList => vec![Some(wgpu::ColorTargetState {
                format: LIST_TARGET,
                blend: None,
                write_mask: wgpu::ColorWrites::empty(),
            })],
            Self::SolidSprite(SolidStage::Missed) => vec![Some(SPRITES.into())],
            Self::SolidSprite(stage) | Self::CombinedSprite(stage, _) => {
                let write_mask = if stage.is_nearest() { wgpu::ColorWrites::RED } else { wgpu::ColorWrites::GREEN };
                vec![Some(wgpu::ColorTargetState { format: SPRITES, blend: None, write_mask })]
            }
            Self::Section { draw: SectionDraw::Fill { measured }, .. } => {
                let own_depth = measured.then(|| Some(OWN_DEPTH.into()));
                [Some(SMOOTH_CODES.into()), Some(COLORS.into())].into_iter().chain(own_depth).collect()
            }
            Self::Filter(_) => vec![Some(FILTERED.into()); 4],
            Self::Shade { target: ShadeTarget::Unfiltered, behind, .. } => {
                vec![Some(FILTERED.into()); behind.images()]
            }
            Self::Lines { .. } => vec![Some(wgpu::ColorTargetState {
                format: LINES,
                blend: Some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING),
                write_mask: wgpu::ColorWrites::ALL,
            })],
            Self::Furniture { layered, part } => vec![Some(wgpu::ColorTargetState {
                format: if *layered { FURNITURE_LAYER } else { PICTURE },
                blend: (!part.is_opaque()).then_some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING),
                write_mask: wgpu::ColorWrites::ALL,
            })],
            Self::Shade { .. } | Self::Resolve | Self::FurnitureOver | Self::Bare => vec![Some(PICTURE.into())],
            _ => Vec::new(),
        }
    }

    pub(super) fn depth_test(&self) -> Option<wgpu::DepthStencilState> {
        use wgpu::CompareFunction as C;
        let compare = match self {
            Self::SolidSprite(SolidStage::Missed) => return None,
            Self::Geometry { section: GeometryKind::Coplanar, .. } => C::GreaterEqual,
            // Its own depth is not the interpolated one.
            Self::Layers { section: GeometryKind::Coplanar, .. } => C::Always,
            Self::Translucent(own) => own.depth_compare(),
            Self::Geometry { .. } | Self::Layers { .. } | Self::Shadow(_) | Self::Bare | Self::Lines { .. } => {
                C::Greater
            }
            Self::SolidSprite(stage) | Self::CombinedSprite(stage, _) => {
                if stage.is_nearest() {
                    C::Greater
                } else {
                    C::Less
                }
            }
            // The triangle lies at depth 0, where nothing is stored.
            Self::Shade { shown: Shown::Surface, .. } => C::Less,
            Self::Shade { shown: Shown::Background | Shown::RegionSurface | Shown::RegionBackground, .. } => C::Equal,
            Self::Section { draw: SectionDraw::Fill { .. }, .. } => C::Greater,
            Self::Regions(_) | Self::Section { .. } => C::Always,
            Self::Shade { shown: Shown::Any, .. }
            | Self::StoredForm(_)
            | Self::StoredLayers(_)
            | Self::SpriteList
            | Self::Composite { .. }
            | Self::CountLayers(_)
            | Self::SortLayers { .. }
            | Self::LinkSlots(_)
            | Self::ShownLayers { .. }
            | Self::Filter(_)
            | Self::Resolve
            | Self::Furniture { .. }
            | Self::FurnitureOver => {
                return None;
            }
        };
        Some(wgpu::DepthStencilState {
            format: DEPTH,
            depth_write_enabled: Some(match self {
                Self::Section { draw, .. } => matches!(draw, SectionDraw::Fill { .. }),
                Self::Translucent(own) => own.writes_depth(),
                _ => !matches!(self, Self::Shade { .. } | Self::Layers { .. } | Self::Lines { .. }),
            }),
            depth_compare: Some(compare),
            stencil: wgpu::StencilState::default(),
            bias: wgpu::DepthBiasState::default(),
        })
    }
}
