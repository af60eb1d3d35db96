//! Shading, region by region: each by a shader of its own that tests no lens; the depth test chooses the pixels.

use wgpu::ShaderStages as S;

use crate::{
    gpu::{Gpu, GpuError},
    render::{
        pass::{
            context::{Board, FrameContext, Keys, Line, Pass, Preparing},
            picture_pass::{PicturePass, draw_pieces},
            reference::region_geometry::RegionMap,
            shade::{ShadeKey, ShadeTarget, Shown, target_of},
        },
        picture_parts::Piece,
        plan::FramePlan,
        programs::Programs,
        regions::{RegionPass, RegionPasses},
        resource::{
            bindings::{GroupLayout, NUMBERS, group},
            formats::DEPTH,
            key::{Draw, Parts, PipelineKey, Stage, depth_test},
            layouts::{LENSES, SHADE, VIEW},
            recording::{Counted, Recording, cleared, cleared_depth, kept, read_depth},
            vertices,
        },
    },
    shader::{Module, Plan, Program},
};

/// Group 3: numbers of regions.
static REGIONS: GroupLayout = GroupLayout { label: "regions", entries: &[(0, S::FRAGMENT, NUMBERS)] };

/// `STEP` and `BACKGROUND` of `pass/regions.wgsl`.
const STEPS: f32 = 4096.0;
const BACKGROUND: u32 = 2048;
/// The part of shading that is the lenses'.
const LENSES_PART: u32 = 1;

/// Regions as depths, and how they are told apart.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
struct MarkKey(Plan);

impl PipelineKey for MarkKey {
    fn name(&self) -> String {
        Module::Regions(self.0.clone()).name()
    }

    fn parts(&self, _: wgpu::TextureFormat) -> Parts {
        Parts {
            module: Module::Regions(self.0.clone()),
            groups: vec![Some(&VIEW), Some(&SHADE), Some(&LENSES), Some(&REGIONS)],
            constants: Vec::new(),
            stage: Stage::Draw(Draw {
                buffers: vec![vertices::picture_corners()],
                depth: Some(depth_test(wgpu::CompareFunction::Always, true)),
                ..Draw::new("vertex", Some("fragment"))
            }),
        }
    }
}

/// The pipelines of a region: surfaces, and where it has some what is behind the city.
fn keys_of(plan: &FramePlan, region: &RegionPass) -> Vec<ShadeKey> {
    let shown = [Some(Shown::RegionSurface), region.has_background.then_some(Shown::RegionBackground)];
    let program = || Program::Specialised(region.shade.clone());
    shown.into_iter().flatten().map(|shown| ShadeKey::new(plan, ShadeTarget::of(plan), shown, program())).collect()
}

/// What writes the lens masks: accumulation's shading with nothing to do.
fn class_keys(plan: &FramePlan) -> [ShadeKey; 2] {
    let masks = Plan { steps: Vec::new(), ..plan.plans.lenses.clone() };
    [Shown::Surface, Shown::Background]
        .map(|shown| ShadeKey::new(plan, ShadeTarget::Picture, shown, Program::Specialised(masks.clone())))
}

/// The lens masks, where a technique goes by regions. It keeps nothing.
#[derive(Debug)]
pub struct Classes;

impl Pass for Classes {
    type Input<'a> = ();

    const LIST: &'static [Line] =
        &[("classes", "the lens masks, where a technique goes by regions and something asks for them")];

    fn new(_: &Gpu) -> Result<Self, GpuError> {
        Ok(Self)
    }

    fn wanted<'a>(plan: &'a FramePlan<'a>) -> Option<()> {
        (plan.plans.regions.is_some() && plan.input.wants_masks()).then_some(())
    }

    fn record(
        &mut self,
        (): &(),
        frame: &FrameContext,
        recording: &mut Recording,
        _: &mut Board,
    ) -> Result<(), GpuError> {
        let targets = frame.targets;
        // What it paints is painted over.
        let color = cleared(&targets.picture.view, wgpu::Color::TRANSPARENT);
        let pass = PicturePass { name: "classes", color: Some(color), depth: read_depth(&targets.depth.view) };
        pass.record(frame, recording, |pass| {
            let mut counted = Counted::NONE;
            for key in class_keys(frame.plan) {
                counted += draw_pieces(frame, pass, &key, LENSES_PART, &frame.plan.parts.inside);
            }
            counted
        });
        Ok(())
    }
}

/// What the pass keeps: regions as depths, once a technique drew by them.
#[derive(Debug)]
pub struct RegionShade(Option<wgpu::Texture>);

impl Pass for RegionShade {
    type Input<'a> = &'a RegionPasses;

    const LIST: &'static [Line] = &[
        ("regions", "the numbers of regions as depths, with those of the background"),
        ("shade regions", "each region by a shader of its own that tests no lens"),
    ];

    fn new(_: &Gpu) -> Result<Self, GpuError> {
        Ok(Self(None))
    }

    fn wanted<'a>(plan: &'a FramePlan<'a>) -> Option<&'a RegionPasses> {
        plan.plans.regions.as_ref()
    }

    fn add_keys(&self, input: Option<&&RegionPasses>, plan: &FramePlan, _: &Programs, keys: &mut Keys) {
        let Some(regions) = input else { return };
        keys.add_programs(27, [MarkKey(regions.plan.clone())]);
        keys.add_programs(27, regions.passes.iter().flat_map(|region| keys_of(plan, region)));
        if plan.input.wants_masks() {
            keys.add_programs(27, class_keys(plan));
        }
    }

    fn prepare(&mut self, _: &&RegionPasses, stage: &mut Preparing) -> Result<(), GpuError> {
        let [width, height] = stage.plan.input.tile.size;
        if self.0.as_ref().is_none_or(|depth| [depth.width(), depth.height()] != [width, height]) {
            let usage = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING;
            self.0 = Some(stage.gpu.texture("regions as depths", [width, height, 1], 1, DEPTH, usage));
        }
        Ok(())
    }

    fn record(
        &mut self,
        regions: &&RegionPasses,
        frame: &FrameContext,
        recording: &mut Recording,
        board: &mut Board,
    ) -> Result<(), GpuError> {
        let (Some(own), Some(RegionMap(map))) = (&self.0, board.get()) else { return Ok(()) };
        let (plan, pieces) = (frame.plan, &frame.plan.parts.inside);
        let depth = own.create_view(&Default::default());
        let map = wgpu::BindingResource::TextureView(map);
        let numbers = group(frame.gpu, "regions", &frame.pipelines.layout(&REGIONS), &[(0, map)]);
        let pass = PicturePass { name: "regions", color: None, depth: cleared_depth(&depth, 0.0) };
        pass.record(frame, recording, |pass| {
            pass.set_bind_group(3, &numbers, &[]);
            draw_pieces(frame, pass, &MarkKey(regions.plan.clone()), LENSES_PART, pieces)
        });
        let color = Some(kept(&target_of(frame).view));
        let pass = PicturePass { name: "shade regions", color, depth: read_depth(&depth) };
        let [w, h] = plan.input.tile.size.map(|side| side as f32);
        pass.record(frame, recording, |pass| {
            let mut counted = Counted::NONE;
            for region in &regions.passes {
                let own: Vec<Piece> =
                    pieces.iter().map(|(corners, tile)| (corners.clone(), tile.common(region.part))).collect();
                for (key, first) in keys_of(plan, region).iter().zip([0, BACKGROUND]) {
                    // The triangles lie at depth 0; the depth test finds what lies at the region's.
                    let depth = (first + region.number + 1) as f32 / STEPS;
                    pass.set_viewport(0.0, 0.0, w, h, depth, depth);
                    counted += draw_pieces(frame, pass, key, LENSES_PART, &own);
                }
            }
            counted
        });
        Ok(())
    }
}
