//! Pipelines of passes over translucent fragments: those that find the nearest in slots, and those that shade fragments where they are
//! drawn.

use wgpu::ShaderStages as S;

use crate::{
    render::{
        frame::Behind,
        pass::{
            layering::{self, LayerPrograms},
            opaque::in_order,
            section_kind::{GeometryKind, Normals},
        },
        plan::FramePlan,
        resource::{
            bindings::{DEPTHS, DRAWN, GroupLayout, STAGE, STORAGE, UNIFORM, WRITTEN},
            formats::{COLORS, OWN_DEPTH, codes, through},
            key::{Draw, Parts, PipelineKey, Stage, depth_test, flag, target, words},
            layouts::{CUT_CITY, LENSES, SHADE},
        },
    },
    scene::Transparency,
    shader::{Forward, ForwardKind, Module, Program},
};

/// Group 0 of slots: the view, lists and records, slots, the depth of what is opaque, the band at a dynamic offset.
pub static SLOTS: GroupLayout = GroupLayout {
    label: "slots of layers",
    entries: &[
        (0, DRAWN, UNIFORM),
        (1, S::FRAGMENT, WRITTEN),
        (2, S::FRAGMENT, WRITTEN),
        (3, S::FRAGMENT, DEPTHS),
        (4, S::FRAGMENT, STAGE),
    ],
};
/// Group 0 of fragments that are shaded where they are drawn: the view, slots, the band and the city, both at dynamic offsets.
pub static FORWARD: GroupLayout = GroupLayout {
    label: "fragments",
    entries: &[(0, DRAWN, UNIFORM), (2, S::FRAGMENT, STORAGE), (4, S::FRAGMENT, STAGE), (5, DRAWN, STAGE)],
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
    /// Which fragments these are.
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

    /// Whether it shades.
    fn is_forward(self) -> bool {
        matches!(self, Self::Tail | Self::Chance)
    }
}

/// Slots of each pixel, and what is in them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Slots {
    /// How many.
    pub slots: u32,
    /// Words of one.
    pub words: u32,
    /// Words of a pixel's record.
    pub record: u32,
    /// Layers of a pixel at most; 0: all.
    pub limit: u32,
}

impl Slots {
    /// Of passes that have nothing to do with slots.
    pub const NONE: Self = Self { slots: 0, words: 3, record: 0, limit: 0 };

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
    pub fn passes(&self) -> &'static [FragmentPass] {
        const ALL: [FragmentPass; 3] = [FragmentPass::Depths, FragmentPass::Codes, FragmentPass::Rest];
        match (self.slots, self.words) {
            (0, _) => &[],
            (_, 3) => &ALL[..2],
            _ => &ALL,
        }
    }

    /// As pipelines read them.
    pub fn constants(&self) -> [(&'static str, f64); 4] {
        [("SLOTS", self.slots), ("WORDS", self.words), ("RECORD", self.record), ("LIMIT", self.limit)]
            .map(|(name, value)| (name, f64::from(value)))
    }
}

/// What passes shade with that shade fragments where they are drawn.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
struct Shading {
    /// What the context and the lenses do.
    program: Program,
    /// Something has light of its own.
    emits: bool,
    /// One clay colour.
    clay: bool,
    /// There is a shadow map, and one of the sky.
    shadows: bool,
    sky: bool,
    /// There is a plain ground, which fades; what is behind it.
    fades: bool,
    behind: Behind,
    /// Of the picture: the context's, or the lenses'.
    part: u32,
    /// Base colours have a target.
    colored: bool,
    /// Interpolated depth has one, for the AOV.
    measured: bool,
}

impl Shading {
    fn of(plan: &FramePlan, program: &Program) -> Self {
        Self {
            program: program.clone(),
            emits: plan.emits,
            clay: plan.is_clay(),
            // Mesa 22.3 crashes where fragments of the city sample the shadow map.
            shadows: plan.sun.is_some() && !plan.adapter.is_software,
            sky: plan.sky.is_some() && !plan.adapter.is_software,
            fades: plan.fade.is_some(),
            behind: plan.input.behind(),
            part: u32::from(plan.has_lenses()),
            colored: plan.colored,
            measured: plan.input.measured,
        }
    }
}

/// One pass over one kind of section.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct FragmentKey {
    section: GeometryKind,
    normals: Normals,
    /// Whether nodes have colours.
    textured: bool,
    /// Whether these have the opacity of texels.
    blended: bool,
    /// Whether nodes have shares of own light.
    texels_emit: bool,
    /// What is translucent.
    program: Program,
    /// Whether the depth test can come first.
    early: bool,
    /// Which pass.
    pass: FragmentPass,
    /// Of which slots.
    slots: Slots,
    /// What it shades with, where it does.
    shading: Option<Shading>,
}

impl FragmentKey {
    /// The pipeline of a pass over one kind of section, and whether its city has normals per vertex.
    pub fn new(
        plan: &FramePlan,
        programs: LayerPrograms,
        pass: FragmentPass,
        slots: Slots,
        section: GeometryKind,
        is_smooth_city: bool,
    ) -> Self {
        let tests_early = plan.adapter.tests_depth_early && !section.is_layer();
        Self {
            section,
            normals: Normals::new(plan.smooth, is_smooth_city),
            textured: layering::has_colors(plan),
            blended: plan.blended,
            texels_emit: plan.texels_emit,
            program: programs.noting.clone(),
            early: tests_early && !pass.is_forward(),
            pass,
            slots,
            shading: pass.is_forward().then(|| Shading::of(plan, programs.composite)),
        }
    }

    fn module(&self) -> Module {
        let kind = match self.pass {
            FragmentPass::Tail => ForwardKind::Tail,
            FragmentPass::Chance => ForwardKind::Chance(self.section.is_layer()),
            _ => return Module::Slots(self.program.clone(), self.early),
        };
        let shading = self.shading.as_ref().map_or_else(|| self.program.clone(), |own| own.program.clone());
        Module::Forward(Forward { kind, hidden: self.program.clone(), shading })
    }

    fn constants(&self) -> Vec<(&'static str, f64)> {
        let mut list = vec![
            ("SMOOTH", flag(self.normals.smooth)),
            ("FLAT_CITY", flag(self.normals.flat)),
            ("TEXTURED", flag(self.textured)),
            ("BLENDED", flag(self.blended)),
            ("TEXELS_EMIT", flag(self.texels_emit)),
        ];
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
        if let Some(own) = &self.shading {
            list.extend([
                ("EMITS", flag(own.emits)),
                ("CLAY", flag(own.clay)),
                ("SHADOWS", flag(own.shadows)),
                ("SKY_SHADOWS", flag(own.sky)),
                ("GROUND_FADES", flag(own.fades)),
                ("BACKGROUND", f64::from(own.behind as u32)),
                ("PART", f64::from(own.part)),
            ]);
        }
        list.extend(self.section.constants(false));
        list
    }

    fn entry_points(&self) -> (&'static str, &'static str) {
        match (self.section, self.normals.smooth) {
            (GeometryKind::Plain, false) => ("vertex", "lay_plain"),
            (GeometryKind::Plain, true) => ("vertex_smooth", "lay_smooth"),
            (GeometryKind::Textured(_), _) => ("vertex_textured", "lay_textured"),
            (GeometryKind::Coplanar(None), _) => ("vertex_in_plane", "lay_coplanar"),
            (GeometryKind::Coplanar(Some(_)), _) => ("vertex_textured_in_plane", "lay_textured_coplanar"),
        }
    }

    fn groups(&self) -> Vec<Option<&'static GroupLayout>> {
        let image = self.section.images();
        match self.shading {
            None => vec![Some(&SLOTS), Some(&CUT_CITY), Some(&LENSES), image],
            Some(_) => vec![Some(&FORWARD), Some(&SHADE), Some(&LENSES), image],
        }
    }

    fn targets(&self, sums: wgpu::TextureFormat) -> Vec<Option<wgpu::ColorTargetState>> {
        match (self.pass, &self.shading) {
            (FragmentPass::Tail, _) => {
                let add = blended(wgpu::BlendFactor::One, wgpu::BlendFactor::One);
                let multiply = blended(wgpu::BlendFactor::Zero, wgpu::BlendFactor::Src);
                vec![target(sums, Some(add)), target(through(sums), Some(multiply))]
            }
            (FragmentPass::Chance, Some(own)) => in_order([
                target(codes(self.normals.smooth), None),
                if own.colored { target(COLORS, None) } else { None },
                if own.measured { target(OWN_DEPTH, None) } else { None },
                None,
                self.texels_emit.then(|| self.section.emissions()),
            ]),
            _ => Vec::new(),
        }
    }

    /// A face of a plane has its own depth, not the interpolated one.
    fn depth_compare(&self) -> wgpu::CompareFunction {
        match (self.section, self.pass) {
            (GeometryKind::Coplanar(_), FragmentPass::Chance) => wgpu::CompareFunction::GreaterEqual,
            (GeometryKind::Coplanar(_), _) => wgpu::CompareFunction::Always,
            _ => wgpu::CompareFunction::Greater,
        }
    }
}

impl PipelineKey for FragmentKey {
    fn name(&self) -> String {
        let pass = match self.pass {
            FragmentPass::Depths => " depths",
            FragmentPass::Codes => " codes",
            FragmentPass::Rest => " rest",
            FragmentPass::Tail | FragmentPass::Chance => "",
        };
        let Normals { smooth, flat } = self.normals;
        let flags = words(&[
            (self.textured, "textured"),
            (self.blended, "blended"),
            (self.texels_emit, "of light"),
            (smooth, "smooth"),
            (flat, "flat"),
        ]);
        format!("{}{pass}{}{flags}", self.module().name(), self.section.words())
    }

    fn parts(&self, sums: wgpu::TextureFormat) -> Parts {
        let (vertex, fragment) = self.entry_points();
        let writes_depth = self.pass == FragmentPass::Chance;
        Parts {
            module: self.module(),
            groups: self.groups(),
            constants: self.constants(),
            stage: Stage::Draw(Draw {
                buffers: self.section.vertex_buffers(false),
                targets: self.targets(sums),
                depth: Some(depth_test(self.depth_compare(), writes_depth)),
                ..Draw::new(vertex, Some(fragment))
            }),
        }
    }
}

fn blended(src_factor: wgpu::BlendFactor, dst_factor: wgpu::BlendFactor) -> wgpu::BlendState {
    let both = wgpu::BlendComponent { src_factor, dst_factor, operation: wgpu::BlendOperation::Add };
    wgpu::BlendState { color: both, alpha: both }
}

/// The slots of a frame's method; `None`: it has none.
pub fn slots_of(plan: &FramePlan) -> Option<Slots> {
    Slots::of(plan.input.transparency, layering::words(plan))
}
