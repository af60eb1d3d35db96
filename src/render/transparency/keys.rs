//! The pipelines of the methods.

use crate::{
    render::{
        city::SectionKind,
        key::{GeometryKind, Key},
        layers::LayerKeys,
        pipelines::{CODES, COLORS, Layouts, OWN_DEPTH, SMOOTH_CODES},
    },
    scene::Transparency,
    shader::{Forward, ForwardKind, Module, Program},
};

/// Layers that a round of peeling takes off. One would be what the literature has; two passes that find several are cheaper.
const PEELED_AT_ONCE: u32 = 4;
/// Words of the record of a pixel that is peeled, as `lib/slots.wgsl` and `pass/composite.wgsl` have it.
const PEELING_RECORD: u32 = 12;

/// A pass over the translucent fragments of the city.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum FragmentPass {
    /// The depths of the nearest.
    Depths,
    /// Who these are.
    Codes,
    /// Their normals and colours.
    Rest,
    /// All others, or all, as one layer.
    Tail,
    /// Each there or not by chance.
    Chance,
}

impl FragmentPass {
    /// A name for people and statistics.
    pub fn name(self) -> &'static str {
        match self {
            Self::Depths => "slots, depths",
            Self::Codes => "slots, codes",
            Self::Rest => "slots, rest",
            Self::Tail => "weighted",
            Self::Chance => "stochastic",
        }
    }
}

/// What passes shade with that shade fragments where they are drawn.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct ForwardKeys {
    /// What the context and the lenses do.
    pub program: Program,
    /// One clay colour.
    pub clay: bool,
    /// There is a shadow map.
    pub shadows: bool,
    /// Of the picture: the context's, or the lenses'.
    pub part: u32,
    /// Base colours have a target.
    pub colored: bool,
    /// Interpolated depth has one, for the AOV.
    pub measured: bool,
}

/// Slots of each pixel, and what is in them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct SlotKeys {
    /// How many.
    pub slots: u32,
    /// Words of one.
    pub words: u32,
    /// Words of a pixel's record.
    pub record: u32,
    /// Layers of a pixel at most; 0: all.
    pub limit: u32,
}

/// One pass over one kind of section.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct TranslucentKey {
    /// How vertices are laid out and where depth comes from.
    pub section: GeometryKind,
    /// Whether some faces of the picture have normals per vertex.
    pub smooth: bool,
    /// Whether they are in other cities of the picture, and this one has flat faces alone.
    pub flat: bool,
    /// Whether the picture has textures.
    pub textured: bool,
    /// What is translucent.
    pub program: Program,
    /// Whether the depth test can come first.
    pub early: bool,
    /// Which pass.
    pub pass: FragmentPass,
    /// Of which slots.
    pub slots: SlotKeys,
    /// What it shades with, where it does.
    pub forward: Option<ForwardKeys>,
}

impl SlotKeys {
    /// Of passes that have nothing to do with slots.
    pub(in crate::render) const NONE: Self = Self { slots: 0, words: 3, record: 0, limit: 0 };

    /// Those of a method that has some, of so many words each.
    pub fn of(method: Transparency, words: u32) -> Option<Self> {
        match method {
            Transparency::KBuffer { layers } => Some(Self { slots: layers, words, record: 1, limit: 0 }),
            Transparency::Peel { layers } => {
                let slots = if layers == 0 { PEELED_AT_ONCE } else { layers.min(PEELED_AT_ONCE) };
                Some(Self { slots, words, record: PEELING_RECORD, limit: layers })
            }
            Transparency::Weighted => Some(Self { slots: 0, words, record: 0, limit: 0 }),
            Transparency::Exact | Transparency::Stochastic => None,
        }
    }

    /// Whether what finds no slot is one layer behind them.
    pub fn has_tail(&self) -> bool {
        !self.is_peeling()
    }

    /// Whether it goes on until nothing is left, or so many layers are laid.
    pub fn is_peeling(&self) -> bool {
        self.record > 1
    }

    /// The passes that fill them.
    pub(crate) fn passes(&self) -> &'static [FragmentPass] {
        const ALL: [FragmentPass; 3] = [FragmentPass::Depths, FragmentPass::Codes, FragmentPass::Rest];
        match (self.slots, self.words) {
            (0, _) => &[],
            (_, 3) => &ALL[..2],
            _ => &ALL,
        }
    }

    /// The pipelines of a frame's passes over sections, and that makes lists of slots.
    pub(in crate::render) fn all(&self, layers: &LayerKeys, sections: &[(SectionKind, bool)], early: bool) -> Vec<Key> {
        let passes = self.passes().iter().copied().chain(self.has_tail().then_some(FragmentPass::Tail));
        let keys = passes.flat_map(|pass| {
            sections.iter().map(move |&(kind, own)| layers.translucent_key(*self, (kind.into(), own), pass, early))
        });
        keys.chain((self.slots > 0).then_some(Key::LinkSlots(*self))).collect()
    }

    pub(in crate::render) fn constants(&self) -> [(&'static str, f64); 4] {
        [("SLOTS", self.slots), ("WORDS", self.words), ("RECORD", self.record), ("LIMIT", self.limit)]
            .map(|(name, value)| (name, f64::from(value)))
    }
}

impl LayerKeys {
    /// The pipeline of a pass over one kind of section; and whether its city has normals per vertex.
    pub(in crate::render) fn translucent_key(
        &self,
        slots: SlotKeys,
        (section, is_smooth_city): (GeometryKind, bool),
        pass: FragmentPass,
        early: bool,
    ) -> Key {
        let is_forward = matches!(pass, FragmentPass::Tail | FragmentPass::Chance);
        Key::Translucent(TranslucentKey {
            section,
            smooth: self.smooth,
            flat: self.smooth && !is_smooth_city,
            textured: self.textured,
            program: self.noting.clone(),
            early: early && section != GeometryKind::Coplanar && !is_forward,
            pass,
            slots,
            forward: self.forward.clone().filter(|_| is_forward),
        })
    }
}

impl TranslucentKey {
    pub(in crate::render) fn module(&self) -> Module {
        let kind = match self.pass {
            FragmentPass::Tail => ForwardKind::Tail,
            FragmentPass::Chance => ForwardKind::Chance(self.section == GeometryKind::Coplanar),
            _ => return Module::Slots(self.program.clone(), self.early),
        };
        let shading = self.forward.as_ref().map_or_else(|| self.program.clone(), |own| own.program.clone());
        Module::Forward(Forward { kind, hidden: self.program.clone(), shading })
    }

    pub(in crate::render) fn name(&self) -> String {
        let pass = match self.pass {
            FragmentPass::Depths => " depths",
            FragmentPass::Codes => " codes",
            FragmentPass::Rest => " rest",
            FragmentPass::Tail | FragmentPass::Chance => "",
        };
        let kind = match self.section {
            GeometryKind::Plain => "",
            GeometryKind::Textured(0) => " of textures",
            GeometryKind::Textured(_) => " of textures with holes",
            GeometryKind::Coplanar => " coplanar",
        };
        let flags = [(self.textured, " textured"), (self.smooth, " smooth"), (self.flat, " flat")];
        let flags: String = flags.iter().filter(|(on, _)| *on).map(|(_, name)| *name).collect();
        format!("{}{pass}{kind}{flags}", self.module().name())
    }

    pub(in crate::render) fn constants(&self) -> Vec<(&'static str, f64)> {
        let flag = |on: bool| f64::from(u8::from(on));
        let mut list =
            vec![("SMOOTH", flag(self.smooth)), ("FLAT_CITY", flag(self.flat)), ("TEXTURED", flag(self.textured))];
        let stage = match self.pass {
            FragmentPass::Depths => Some(0.0),
            FragmentPass::Codes => Some(1.0),
            FragmentPass::Rest => Some(2.0),
            FragmentPass::Tail | FragmentPass::Chance => None,
        };
        list.extend(stage.into_iter().flat_map(|stage| [("STAGE", stage), ("RECORD", f64::from(self.slots.record))]));
        if self.pass != FragmentPass::Chance {
            list.push(("SLOTS", f64::from(self.slots.slots)));
        }
        if let Some(own) = &self.forward {
            list.extend([("CLAY", flag(own.clay)), ("SHADOWS", flag(own.shadows)), ("PART", f64::from(own.part))]);
        }
        if let GeometryKind::Textured(cutoff) = self.section {
            list.push(("ALPHA_CUTOFF", f64::from(f32::from_bits(cutoff))));
        }
        list
    }

    pub(in crate::render) fn entry_points(&self) -> (&'static str, Option<&'static str>) {
        match (self.section, self.smooth) {
            (GeometryKind::Plain, false) => ("vertex", Some("lay_plain")),
            (GeometryKind::Plain, true) => ("vertex_smooth", Some("lay_smooth")),
            (GeometryKind::Textured(_), _) => ("vertex_textured", Some("lay_textured")),
            (GeometryKind::Coplanar, _) => ("vertex_in_plane", Some("lay_coplanar")),
        }
    }

    pub(in crate::render) fn groups<'a>(&self, layouts: &'a Layouts) -> Vec<Option<&'a wgpu::BindGroupLayout>> {
        let image = matches!(self.section, GeometryKind::Textured(_)).then_some(&layouts.image);
        match self.forward {
            None => vec![Some(&layouts.slots), Some(&layouts.cut_city), Some(&layouts.lenses), image],
            Some(_) => vec![Some(&layouts.forward), Some(&layouts.shade), Some(&layouts.lenses), image],
        }
    }

    pub(in crate::render) fn targets(&self, sums: wgpu::TextureFormat) -> Vec<Option<wgpu::ColorTargetState>> {
        match (self.pass, &self.forward) {
            (FragmentPass::Tail, _) => {
                let add = blended(wgpu::BlendFactor::One, wgpu::BlendFactor::One);
                let multiply = blended(wgpu::BlendFactor::Zero, wgpu::BlendFactor::Src);
                vec![target(sums, Some(add)), target(through_format(sums), Some(multiply))]
            }
            (FragmentPass::Chance, Some(own)) => {
                let codes = if self.smooth { SMOOTH_CODES } else { CODES };
                let mut targets = vec![target(codes, None), None, None];
                targets[1] = if own.colored { target(COLORS, None) } else { None };
                targets[2] = if own.measured { target(OWN_DEPTH, None) } else { None };
                targets.truncate(if own.measured { 3 } else { 1 + usize::from(own.colored) });
                targets
            }
            _ => Vec::new(),
        }
    }

    /// A face of a plane has its own depth, not the interpolated one.
    pub(in crate::render) fn depth_compare(&self) -> wgpu::CompareFunction {
        match (self.section, self.pass) {
            (GeometryKind::Coplanar, FragmentPass::Chance) => wgpu::CompareFunction::GreaterEqual,
            (GeometryKind::Coplanar, _) => wgpu::CompareFunction::Always,
            _ => wgpu::CompareFunction::Greater,
        }
    }

    pub(in crate::render) fn writes_depth(&self) -> bool {
        self.pass == FragmentPass::Chance
    }
}

/// The format of what a tail lets through, where sums have this one.
pub(in crate::render) fn through_format(sums: wgpu::TextureFormat) -> wgpu::TextureFormat {
    match sums {
        wgpu::TextureFormat::Rgba32Float => wgpu::TextureFormat::R32Float,
        _ => wgpu::TextureFormat::R16Float,
    }
}

fn target(format: wgpu::TextureFormat, blend: Option<wgpu::BlendState>) -> Option<wgpu::ColorTargetState> {
    Some(wgpu::ColorTargetState { format, blend, write_mask: wgpu::ColorWrites::ALL })
}

fn blended(src_factor: wgpu::BlendFactor, dst_factor: wgpu::BlendFactor) -> wgpu::BlendState {
    let both = wgpu::BlendComponent { src_factor, dst_factor, operation: wgpu::BlendOperation::Add };
    wgpu::BlendState { color: both, alpha: both }
}
