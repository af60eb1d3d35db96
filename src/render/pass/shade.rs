//! Shading: outside of where lenses may be seen without them, inside with them.

use wgpu::ShaderStages as S;

use crate::{
    gpu::{Gpu, GpuError},
    render::{
        frame::Behind,
        pass::{
            context::{Board, FrameContext, Keys, Line, Pass},
            picture_pass::{PicturePass, draw_pieces},
        },
        plan::FramePlan,
        programs::Programs,
        resource::{
            bindings::{FLOATS, GroupLayout, KeptGroup, all_of, group},
            formats::{FILTERED, PICTURE},
            key::{Draw, Parts, PipelineKey, Stage, depth_test, flag, target, words},
            layouts::{LENSES, SHADE, VIEW},
            recording::{Counted, Recording, cleared, kept, read_depth},
            targets::{Needs, Target},
            vertices,
        },
    },
    shader::{Module, Program},
};

/// Group 3, where there are lines or translucent layers: both, as they are laid over the picture.
static LINES: GroupLayout =
    GroupLayout { label: "lines and layers", entries: &[(0, S::FRAGMENT, FLOATS), (1, S::FRAGMENT, FLOATS)] };

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

impl ShadeTarget {
    /// Where the samples of a frame go.
    pub fn of(plan: &FramePlan) -> Self {
        if plan.input.is_summed() { Self::Sums } else { Self::Picture }
    }
}

/// Shading.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct ShadeKey {
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
    /// There is a shadow map, and one of the sky; or the picture tells how much of that is seen.
    shadows: bool,
    sky: bool,
    occlusion: bool,
    /// Normals are in the target.
    smooth: bool,
    /// Something has light of its own.
    emits: bool,
    /// Texels say how much of it.
    texels_emit: bool,
    /// Some of what is shown are sections.
    sections: bool,
    /// Some walls have storeys and windows.
    facades: bool,
    /// There is a plain ground, which fades.
    fades: bool,
    /// What is behind the city.
    behind: Behind,
}

impl ShadeKey {
    /// What shades some pixels of a frame.
    pub fn new(plan: &FramePlan, target: ShadeTarget, shown: Shown, program: Program) -> Self {
        Self {
            program,
            shown,
            target,
            textured: plan.is_textured(),
            clay: plan.is_clay(),
            shadows: plan.sun.is_some(),
            sky: plan.sky.is_some(),
            occlusion: plan.has_screen_occlusion(),
            smooth: plan.smooth,
            emits: plan.emits,
            texels_emit: plan.texels_emit,
            sections: plan.has_sections,
            facades: plan.facades,
            fades: plan.fade.is_some(),
            behind: plan.input.behind(),
        }
    }

    fn targets(&self, sums: wgpu::TextureFormat) -> Vec<Option<wgpu::ColorTargetState>> {
        match self.target {
            ShadeTarget::Picture => vec![target(PICTURE, None)],
            ShadeTarget::Unfiltered => vec![target(FILTERED, None); self.behind.images()],
            ShadeTarget::Sums => {
                let add = wgpu::BlendComponent {
                    src_factor: wgpu::BlendFactor::One,
                    dst_factor: wgpu::BlendFactor::One,
                    operation: wgpu::BlendOperation::Add,
                };
                vec![target(sums, Some(wgpu::BlendState { color: add, alpha: add }))]
            }
        }
    }
}

impl PipelineKey for ShadeKey {
    fn name(&self) -> String {
        let list = [
            (matches!(self.shown, Shown::Background | Shown::RegionBackground), "background"),
            (matches!(self.shown, Shown::RegionSurface | Shown::RegionBackground), "of a region"),
            (self.textured, "textured"),
            (self.clay, "clay"),
            (self.target == ShadeTarget::Sums, "summed"),
            (self.target == ShadeTarget::Unfiltered, "unfiltered"),
            (self.shadows, "shadows"),
            (self.sky, "sky"),
            (self.occlusion, "ambient occlusion"),
            (self.emits, "emission"),
            (self.texels_emit, "of texels"),
            (self.sections, "sections"),
            (self.facades, "facades"),
            (self.fades, "plain ground"),
        ];
        format!("{}{}", Module::Shade(self.program.clone()).name(), words(&list))
    }

    fn parts(&self, sums: wgpu::TextureFormat) -> Parts {
        let has = self.program.has();
        let fragment = match self.shown {
            Shown::Surface | Shown::RegionSurface => "surface",
            Shown::Background | Shown::RegionBackground => "background",
            Shown::Any => "unfiltered",
        };
        let compare = match self.shown {
            // The triangle lies at depth 0, where nothing is stored.
            Shown::Surface => Some(wgpu::CompareFunction::Less),
            Shown::Background | Shown::RegionSurface | Shown::RegionBackground => Some(wgpu::CompareFunction::Equal),
            Shown::Any => None,
        };
        Parts {
            module: Module::Shade(self.program.clone()),
            groups: vec![Some(&VIEW), Some(&SHADE), Some(&LENSES), (has.lines || has.transparency).then_some(&LINES)],
            constants: vec![
                ("TEXTURED", flag(self.textured)),
                ("CLAY", flag(self.clay)),
                ("SUMMED", flag(self.target == ShadeTarget::Sums)),
                ("SHADOWS", flag(self.shadows)),
                ("SKY_SHADOWS", flag(self.sky)),
                ("SCREEN_OCCLUSION", flag(self.occlusion)),
                ("SMOOTH", flag(self.smooth)),
                ("EMITS", flag(self.emits)),
                ("TEXELS_EMIT", flag(self.texels_emit)),
                ("SECTIONS", flag(self.sections)),
                ("FACADES", flag(self.facades)),
                ("GROUND_FADES", flag(self.fades)),
                ("BACKGROUND", f64::from(self.behind as u32)),
            ],
            stage: Stage::Draw(Draw {
                buffers: vec![vertices::picture_corners()],
                targets: self.targets(sums),
                depth: compare.map(|compare| depth_test(compare, false)),
                ..Draw::new("vertex", Some(fragment))
            }),
        }
    }
}

/// Surfaces and background of a frame, by one program.
fn both(plan: &FramePlan, program: &Program) -> [ShadeKey; 2] {
    [Shown::Surface, Shown::Background].map(|shown| ShadeKey::new(plan, ShadeTarget::of(plan), shown, program.clone()))
}

/// The target of a frame's samples.
pub fn target_of<'a>(frame: &FrameContext<'a>) -> &'a Target {
    if frame.plan.input.is_summed() { &frame.targets.sums } else { &frame.targets.picture }
}

/// Whether some of the picture is shaded with lenses or bent rays by this pass, and not region by region.
fn shades_lenses(plan: &FramePlan) -> bool {
    !(plan.plans.looked_at.is_empty() && plan.input.rays.is_empty()) && plan.plans.regions.is_none()
}

/// What the pass keeps.
#[derive(Debug)]
pub struct Shade {
    /// Lines and translucent layers.
    lines: KeptGroup,
}

impl Pass for Shade {
    type Input<'a> = ();

    const LIST: &'static [Line] = &[("shade", "outside of where lenses may be seen without them, inside with them")];

    fn new(_: &Gpu) -> Result<Self, GpuError> {
        Ok(Self { lines: KeptGroup::default() })
    }

    fn wanted<'a>(_: &'a FramePlan<'a>) -> Option<()> {
        Some(())
    }

    fn add_needs((): &(), plan: &FramePlan, needs: &mut Needs) {
        needs.sums = plan.input.is_summed();
    }

    fn add_keys(&self, _: Option<&()>, plan: &FramePlan, programs: &Programs, keys: &mut Keys) {
        keys.add_programs(20, both(plan, &programs.context));
        if shades_lenses(plan) {
            keys.add_programs(21, both(plan, &programs.lenses));
        }
    }

    fn record(
        &mut self,
        (): &(),
        frame: &FrameContext,
        recording: &mut Recording,
        _: &mut Board,
    ) -> Result<(), GpuError> {
        let FrameContext { targets, plan, programs, .. } = *frame;
        self.lines.fit(frame.shared.stamp, || {
            let entries = [(0, all_of(&targets.lines)), (1, all_of(&targets.transparency))];
            group(frame.gpu, "lines and layers", &frame.pipelines.layout(&LINES), &entries)
        });
        let view = &target_of(frame).view;
        let color = match plan.input.is_first() {
            true => cleared(view, wgpu::Color::TRANSPARENT),
            false => kept(view),
        };
        let pass = PicturePass { name: "shade", color: Some(color), depth: read_depth(&targets.depth.view) };
        pass.record(frame, recording, |pass| {
            pass.set_bind_group(3, self.lines.get(), &[]);
            let mut counted = Counted::NONE;
            for key in both(plan, &programs.context) {
                counted += draw_pieces(frame, pass, &key, 0, &plan.parts.outside);
            }
            if shades_lenses(plan) {
                for key in both(plan, &programs.lenses) {
                    counted += draw_pieces(frame, pass, &key, 1, &plan.parts.inside);
                }
            }
            counted
        });
        Ok(())
    }
}
