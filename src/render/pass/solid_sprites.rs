//! The sprites that tell the sides of solids and combinations: where rays enter first and leave last.

use std::ops::Range;

use crate::{
    gpu::{Gpu, GpuError},
    render::{
        eye::PictureTile,
        frame::FrameInput,
        layout,
        pass::context::{Board, FrameContext, Keys, Line, Pass, Preparing},
        placed_region::{PlacedLeaf, PlacedRegion},
        plan::FramePlan,
        programs::Programs,
        resource::{
            bindings::{DRAWN, GroupLayout, KeptGroup, STAGE, STAGE_STRIDE, group, one_of, strided},
            formats::SPRITES,
            key::{Draw, Parts, PipelineKey, Stage, depth_test, target},
            layouts::{PLANES, VIEW},
            recording::{Counted, DrawnPass, Recording, Shaded, cleared_depth, kept, scissor},
            synced::Synced,
            targets::Needs,
            vertices,
        },
        seen::{Kept, SeenSprite, SeenVolume},
        sprites::Place,
    },
    shader::{Form, Module},
};

/// Group 2: the stage, at a dynamic offset.
static SPRITE_STAGE: GroupLayout = GroupLayout { label: "stage", entries: &[(0, DRAWN, STAGE)] };

/// The draws that make the depth sprites of solids and combinations.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Side {
    /// Nothing is there yet.
    Missed,
    /// Where rays enter first.
    Nearest,
    /// Where they leave last.
    Farthest,
    /// Of a combination, where rays enter first by the ends of its closed forms.
    NearestForm,
    /// Where they leave last.
    FarthestForm,
    /// Of a combination, where rays enter first through faces of its solids.
    NearestFace,
    /// Where they leave last.
    FarthestFace,
}

impl Side {
    /// Whether it writes where rays enter.
    fn is_nearest(self) -> bool {
        matches!(self, Self::Nearest | Self::NearestForm | Self::NearestFace)
    }

    fn entry_points(self) -> (&'static str, &'static str) {
        match self {
            Self::Missed => ("vertex", "missed"),
            Self::Nearest => ("vertex_of_solid", "nearest"),
            Self::Farthest => ("vertex_of_solid", "farthest"),
            Self::NearestForm => ("vertex", "nearest_form"),
            Self::FarthestForm => ("vertex", "farthest_form"),
            Self::NearestFace => ("vertex_of_solid", "nearest_face"),
            Self::FarthestFace => ("vertex_of_solid", "farthest_face"),
        }
    }

    /// Whether it draws faces of solids.
    fn draws_faces(self) -> bool {
        matches!(self, Self::Nearest | Self::Farthest | Self::NearestFace | Self::FarthestFace)
    }
}

/// One of the draws of a solid, or of a combination whose leaves are these.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
struct SideKey {
    side: Side,
    leaves: Option<Vec<Form>>,
}

impl SideKey {
    fn of_solid(side: Side) -> Self {
        Self { side, leaves: None }
    }
}

impl PipelineKey for SideKey {
    fn name(&self) -> String {
        match self.side {
            Side::Missed => "depth sprite of a solid",
            Side::Nearest => "depth sprite of a solid, nearest",
            Side::Farthest => "depth sprite of a solid, farthest",
            Side::NearestForm => "depth sprite of a combination, nearest of its forms",
            Side::FarthestForm => "depth sprite of a combination, farthest of its forms",
            Side::NearestFace => "depth sprite of a combination, nearest of its faces",
            Side::FarthestFace => "depth sprite of a combination, farthest of its faces",
        }
        .to_owned()
    }

    fn parts(&self, _: wgpu::TextureFormat) -> Parts {
        let (vertex, fragment) = self.side.entry_points();
        let one_end = |write_mask| Some(wgpu::ColorTargetState { format: SPRITES, blend: None, write_mask });
        let (written, compare) = match self.side {
            Side::Missed => (target(SPRITES, None), None),
            side if side.is_nearest() => (one_end(wgpu::ColorWrites::RED), Some(wgpu::CompareFunction::Greater)),
            _ => (one_end(wgpu::ColorWrites::GREEN), Some(wgpu::CompareFunction::Less)),
        };
        Parts {
            module: self.leaves.clone().map_or(Module::Sprite, Module::CombinedSprite),
            groups: vec![Some(&VIEW), Some(&PLANES), Some(&SPRITE_STAGE)],
            constants: Vec::new(),
            stage: Stage::Draw(Draw {
                buffers: if self.side.draws_faces() { vec![vertices::solid_corners()] } else { Vec::new() },
                targets: vec![written],
                depth: compare.map(|compare| depth_test(compare, true)),
                ..Draw::new(vertex, Some(fragment))
            }),
        }
    }
}

/// The pipelines that make the sprite of a region.
fn keys_of(region: &PlacedRegion) -> Vec<SideKey> {
    match region {
        PlacedRegion::One(_) => [Side::Missed, Side::Nearest, Side::Farthest].map(SideKey::of_solid).to_vec(),
        PlacedRegion::Combined(_) => {
            let forms_of_leaves = region.forms_in_combination();
            let forms = [Side::NearestForm, Side::FarthestForm].into_iter();
            let faces = [Side::NearestFace, Side::FarthestFace].into_iter();
            let wanted = forms.chain(faces.filter(|_| region.has_solids()));
            let keys = wanted.map(|side| SideKey { side, leaves: Some(forms_of_leaves.clone()) });
            std::iter::once(SideKey::of_solid(Side::Missed)).chain(keys).collect()
        }
    }
}

/// The leaves of a region that have draws of their own: the solids of a combination, by their places in it.
fn own_draws(region: &PlacedRegion) -> impl Iterator<Item = (u32, &PlacedLeaf)> {
    let is_combined = matches!(region, PlacedRegion::Combined(_));
    (0..).zip(region.leaves()).filter(move |(_, leaf)| is_combined && leaf.is_solid())
}

/// A volume whose sides a sprite tells, with the sprite and its place.
#[derive(Clone, Copy)]
pub struct OnPage<'a> {
    lens: u32,
    region: &'a PlacedRegion,
    sprite: &'a SeenSprite,
    place: Place,
    rows: layout::Region,
}

/// What makes a sprite on pages of `page` texels: one stage for the region and one for each solid of a combination.
fn stages_of(on: &OnPage, input: &FrameInput, page: [u32; 2]) -> Vec<layout::SpriteStage> {
    let own = on.sprite.grid.shift(on.sprite.bounds.origin);
    let shift: [f32; 2] = std::array::from_fn(|i| on.place.origin[i] as f32 + own[i]);
    // Texels count down the page, clip space up.
    let clip_scale = on.sprite.grid.clip_scale(page);
    let side = |i: usize| clip_scale[i] + 2.0 * shift[i] / page[i] as f32 - 1.0;
    let stage = |region, leaves| layout::SpriteStage {
        region,
        pixels_per_texel: on.sprite.grid.pixels_per_texel(),
        origin: shift.map(|s| -s),
        clip_scale,
        clip_shift: [side(0), -side(1)],
        leaves,
    };
    let [first, last] = [on.rows.b[0] as u32, on.rows.b[1] as u32];
    // A solid has no planes.
    let of_leaf = |(i, leaf): (u32, &PlacedLeaf)| stage(leaf.rows(&input.view, &mut Vec::new()), [first, last, i, 0]);
    std::iter::once(stage(on.rows, [first, last, 0, 0])).chain(own_draws(on.region).map(of_leaf)).collect()
}

/// A draw of a sprite pass.
struct SideDraw<'a> {
    /// Which of the stages.
    stage: usize,
    key: SideKey,
    lens: u32,
    sprite: &'a SeenSprite,
    place: Place,
    corners: Range<u32>,
}

/// The draws of all sprites: what clears each, and then where rays enter first and leave last.
fn draws_of<'a>(sprites: &[OnPage<'a>], input: &FrameInput) -> Vec<SideDraw<'a>> {
    let mut first_stage = 0;
    let mut draws = Vec::new();
    for on in sprites {
        let &OnPage { lens, region, sprite, place, .. } = on;
        let mut add = |key, stage, corners| draws.push(SideDraw { stage, key, lens, sprite, place, corners });
        // Inside of it, rays enter nowhere first.
        let enters = |of: &Side| !of.is_nearest() || !region.holds_eye(&input.view);
        add(SideKey::of_solid(Side::Missed), first_stage, 0..3);
        match region {
            PlacedRegion::One(leaf) => {
                for of in [Side::Nearest, Side::Farthest].into_iter().filter(enters) {
                    add(SideKey::of_solid(of), first_stage, leaf.place.corners.clone());
                }
            }
            PlacedRegion::Combined(_) => {
                let forms_of_leaves = region.forms_in_combination();
                let key = |side| SideKey { side, leaves: Some(forms_of_leaves.clone()) };
                let forms = [Side::NearestForm, Side::FarthestForm];
                forms.into_iter().filter(enters).for_each(|of| add(key(of), first_stage, 0..3));
                for (i, (_, leaf)) in own_draws(region).enumerate() {
                    for of in [Side::NearestFace, Side::FarthestFace].into_iter().filter(enters) {
                        add(key(of), first_stage + 1 + i, leaf.place.corners.clone());
                    }
                }
            }
        }
        first_stage += 1 + own_draws(region).count();
    }
    draws
}

/// What the pass keeps.
#[derive(Debug)]
pub struct SolidSprites {
    stages: Synced,
    group: KeptGroup,
}

impl SolidSprites {
    fn draw(
        &self,
        frame: &FrameContext,
        recording: &mut Recording,
        name: &'static str,
        clear: Option<f32>,
        draws: &[&SideDraw],
    ) {
        let Some(first) = draws.first() else { return };
        let FrameContext { targets, groups, shared, .. } = *frame;
        let mut lenses: Vec<u32> = draws.iter().map(|d| d.lens).collect();
        lenses.dedup();
        let pass = DrawnPass {
            name,
            view: "main",
            lenses: &lenses,
            shaded: Shaded::Counted,
            // Every texel that is read is written first.
            colors: &[Some(kept(&targets.sprites.layers[first.place.page as usize]))],
            depth: clear.map(|clear| cleared_depth(&targets.sprite_depth.view, clear)),
        };
        recording.draw(pass, |pass| {
            pass.set_bind_group(0, &groups.view, &[]);
            pass.set_bind_group(1, &groups.planes, &[]);
            if clear.is_some() {
                pass.set_vertex_buffer(0, shared.solid_corners.buffer().slice(..));
            }
            let mut counted = Counted::NONE;
            for draw in draws {
                pass.set_pipeline(frame.pipelines.get(&draw.key));
                pass.set_bind_group(2, self.group.get(), &[draw.stage as u32 * STAGE_STRIDE as u32]);
                scissor(pass, PictureTile { origin: draw.place.origin, size: draw.sprite.bounds.size });
                pass.draw(draw.corners.clone(), 0..1);
                counted += Counted::corners(draw.corners.end - draw.corners.start);
            }
            counted
        });
    }
}

/// The passes over a page: their names, what they clear depth to, and which sides they draw.
const PASSES: [(&str, Option<f32>); 3] =
    [("depth sprites", None), ("depth sprites, nearest", Some(0.0)), ("depth sprites, farthest", Some(1.0))];

impl Pass for SolidSprites {
    type Input<'a> = Vec<OnPage<'a>>;

    const LIST: &'static [Line] = &[
        ("depth sprites", "of the solids in view whose sides are asked for: nothing, then"),
        ("depth sprites, nearest", "where rays enter first"),
        ("depth sprites, farthest", "and where they leave last"),
    ];

    fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        let stages = Synced::new(gpu, "sprite stages", wgpu::BufferUsages::UNIFORM)?;
        Ok(Self { stages, group: KeptGroup::default() })
    }

    fn wanted<'a>(plan: &'a FramePlan<'a>) -> Option<Vec<OnPage<'a>>> {
        let on_page = |volume: &'a SeenVolume| match volume.sprite.as_ref()? {
            sprite @ SeenSprite { kept: Kept::Page(place), .. } => Some((volume, sprite, *place)),
            _ => None,
        };
        let volumes = plan.seen.volumes.iter().filter_map(on_page).zip(&plan.numbers.sides);
        let sprites = volumes.map(|((volume, sprite, place), rows)| OnPage {
            lens: volume.lens,
            region: &plan.input.volumes[volume.index].region,
            sprite,
            place,
            rows: *rows,
        });
        (plan.seen.pages.count > 0).then(|| sprites.collect())
    }

    fn add_needs(_: &Vec<OnPage>, plan: &FramePlan, needs: &mut Needs) {
        let pages = &plan.seen.pages;
        needs.sprites = [pages.size[0], pages.size[1], pages.count];
        needs.sprite_depth = plan.seen.volumes.iter().any(|v| v.test.has_faces());
    }

    fn add_keys(&self, input: Option<&Vec<OnPage>>, _: &FramePlan, _: &Programs, keys: &mut Keys) {
        keys.add(12, input.into_iter().flatten().flat_map(|on| keys_of(on.region)));
    }

    fn prepare(&mut self, sprites: &Vec<OnPage>, stage: &mut Preparing) -> Result<(), GpuError> {
        let needs = &stage.targets.needs;
        let page = [needs.sprites[0], needs.sprites[1]].map(|s| s.max(1));
        let stages = sprites.iter().flat_map(|on| stages_of(on, stage.plan.input, page));
        let bytes: Vec<u8> = stages.flat_map(|stage| strided(&stage)).collect();
        if self.stages.sync(stage.gpu, &bytes)? {
            self.group.forget();
        }
        Ok(())
    }

    fn record(
        &mut self,
        sprites: &Vec<OnPage>,
        frame: &FrameContext,
        recording: &mut Recording,
        _: &mut Board,
    ) -> Result<(), GpuError> {
        self.group.fit(frame.shared.stamp, || {
            let entries = [(0, one_of::<layout::SpriteStage>(&self.stages))];
            group(frame.gpu, "sprite stage", &frame.pipelines.layout(&SPRITE_STAGE), &entries)
        });
        let draws = draws_of(sprites, frame.plan.input);
        for page in 0..frame.plan.seen.pages.count {
            for (name, clear) in PASSES {
                let is_here = |side: Side| match side {
                    Side::Missed => clear.is_none(),
                    side => clear == Some(if side.is_nearest() { 0.0 } else { 1.0 }),
                };
                let here: Vec<&SideDraw> =
                    draws.iter().filter(|draw| draw.place.page == page && is_here(draw.key.side)).collect();
                self.draw(frame, recording, name, clear, &here);
            }
        }
        Ok(())
    }
}
