//! Lists of translucent layers, and laying them one over the other: what passes over lists share.

use wgpu::ShaderStages as S;

use crate::{
    gpu::{Gpu, GpuError},
    render::{
        eye::PictureTile,
        fields::FieldKinds,
        frame::Behind,
        pass::{
            context::FrameContext,
            layering::{self, Layering},
        },
        plan::FramePlan,
        resource::{
            bindings::{FLOATS, GroupLayout, STORAGE, UNIFORM, VOXEL_NUMBERS, VOXELS, WRITTEN, all_of, group, whole},
            formats::{OWN_DEPTH, SMOOTH_CODES, TRANSPARENCY},
            key::{Draw, Parts, PipelineKey, Stage, flag, words},
            layouts::{LENSES, SHADE, VIEW},
            recording::{Counted, DrawnPass, Recording, Shaded, kept, scissor},
            synced::Room,
            vertices,
        },
    },
    shader::{Module, Program},
};

/// Group 3: lists, fragment nodes, the tail of slots.
static LAYER_LISTS: GroupLayout = GroupLayout {
    label: "lists of layers",
    entries: &[
        (0, S::FRAGMENT, WRITTEN),
        (1, S::FRAGMENT, STORAGE),
        (2, S::FRAGMENT, FLOATS),
        (3, S::FRAGMENT, FLOATS),
    ],
};

/// The same, and what stands in the city of fields.
static LAYERS_AND_FIELDS: GroupLayout = GroupLayout {
    label: "lists of layers, and fields",
    entries: &[
        (0, S::FRAGMENT, WRITTEN),
        (1, S::FRAGMENT, STORAGE),
        (2, S::FRAGMENT, FLOATS),
        (3, S::FRAGMENT, FLOATS),
        (4, S::FRAGMENT, UNIFORM),
        (5, S::FRAGMENT, VOXELS),
        (6, S::FRAGMENT, VOXEL_NUMBERS),
    ],
};

/// Pools that much room is shared out between.
pub const POOLS: u64 = 16;
/// Words of the lists before those of the pixels: how many nodes spilled, how many layers at most, the longest list that was not
/// done; and, in lines of their own, how many nodes each pool was to take.
pub const HEADER: u64 = 16 * (1 + POOLS);
/// What to do where the GPU has no such buffer.
const SMALLER: &str = "a smaller picture would be right";

/// Translucent layers, one over the other.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct CompositeKey {
    /// What the context and the lenses do.
    pub program: Program,
    /// Base colours come with the lists.
    pub textured: bool,
    /// With them the opacity of texels.
    pub blended: bool,
    /// Something has light of its own.
    pub emits: bool,
    /// Whether texels say how much of it.
    pub texels_emit: bool,
    /// One clay colour.
    pub clay: bool,
    /// There is a shadow map, and one of the sky.
    pub shadows: bool,
    pub sky: bool,
    /// There is a plain ground, which fades; what is behind it.
    pub fades: bool,
    pub behind: Behind,
    /// Normals are in the lists.
    pub smooth: bool,
    /// Which layer is the shown surface is written down.
    pub shown: bool,
    /// Lists are in order.
    pub sorted: bool,
    /// Words of the record that the method keeps of each pixel, 0 for none.
    pub record: u32,
    /// What found no place is one layer behind the others.
    pub tail: bool,
    /// One layer is told in place of all.
    pub picks: bool,
    /// What stands in the city of fields.
    pub fields: FieldKinds,
}

impl CompositeKey {
    /// What it binds of its own.
    fn lists(&self) -> &'static GroupLayout {
        if self.program.has().fields { &LAYERS_AND_FIELDS } else { &LAYER_LISTS }
    }

    /// That of a frame, of lists that are in no order and have no record.
    pub fn new(plan: &FramePlan, program: &Program) -> Self {
        Self {
            program: program.clone(),
            textured: layering::has_colors(plan),
            blended: plan.blended,
            emits: plan.emits,
            texels_emit: plan.texels_emit,
            clay: plan.is_clay(),
            shadows: plan.sun.is_some(),
            sky: plan.sky.is_some(),
            fades: plan.fade.is_some(),
            behind: plan.input.behind(),
            smooth: plan.smooth,
            shown: plan.input.wants_shown_layers(),
            sorted: false,
            record: 0,
            tail: false,
            picks: false,
            fields: plan.input.fields.kinds(),
        }
    }
}

impl PipelineKey for CompositeKey {
    fn name(&self) -> String {
        let list = [
            (self.picks, "of one layer"),
            (self.program.has().fields, "and fields"),
            (self.record == 1, "of slots"),
            (self.record > 1, "of peeling"),
            (self.tail, "and a tail"),
            (self.sorted && self.record == 0 && !self.tail, "sorted"),
            (self.textured, "textured"),
            (self.blended, "blended"),
            (self.emits, "emission"),
            (self.texels_emit, "of texels"),
            (self.clay, "clay"),
            (self.shadows, "shadows"),
            (self.sky, "sky"),
            (self.fades, "plain ground"),
            (self.smooth, "smooth"),
            (self.shown, "shown"),
        ];
        format!("{}{}", Module::Composite(self.program.clone()).name(), words(&list))
    }

    fn parts(&self, _: wgpu::TextureFormat) -> Parts {
        let targets = [TRANSPARENCY, SMOOTH_CODES, OWN_DEPTH].map(|format| Some(format.into()));
        Parts {
            module: Module::Composite(self.program.clone()),
            groups: vec![Some(&VIEW), Some(&SHADE), Some(&LENSES), Some(self.lists())],
            constants: [&self.constants()[..], &self.of_fields()].concat(),
            stage: Stage::Draw(Draw {
                buffers: vec![vertices::picture_corners()],
                targets: targets[..if self.shown { 3 } else { 1 }].to_vec(),
                ..Draw::new("vertex", Some(if self.shown { "transparency_and_shown" } else { "transparency" }))
            }),
        }
    }
}

impl CompositeKey {
    /// Of layers.
    fn constants(&self) -> Vec<(&'static str, f64)> {
        vec![
            ("SORTED", flag(self.sorted)),
            ("RECORD", f64::from(self.record)),
            ("TAIL", flag(self.tail)),
            ("PICKS", flag(self.picks)),
            ("TEXTURED", flag(self.textured)),
            ("BLENDED", flag(self.blended)),
            ("EMITS", flag(self.emits)),
            ("TEXELS_EMIT", flag(self.texels_emit)),
            ("CLAY", flag(self.clay)),
            ("SHADOWS", flag(self.shadows)),
            ("SKY_SHADOWS", flag(self.sky)),
            ("GROUND_FADES", flag(self.fades)),
            ("BACKGROUND", f64::from(self.behind as u32)),
            ("SMOOTH", flag(self.smooth)),
        ]
    }

    /// Of fields, where there are some.
    fn of_fields(&self) -> Vec<(&'static str, f64)> {
        if !self.program.has().fields {
            return Vec::new();
        }
        let FieldKinds { walked, surfaces, projected, lit, shadowed, labels, numbers, steep } = self.fields;
        let all = [
            ("FIELDS_WALKED", walked),
            ("FIELDS_SURFACES", surfaces),
            ("FIELDS_PROJECTED", projected),
            ("FIELDS_LIT", lit),
            ("FIELDS_SHADOWED", shadowed),
            ("FIELDS_LABELS", labels),
            ("FIELDS_NUMBERS", numbers),
            ("FIELDS_STEEP", steep),
        ];
        all.map(|(name, is_on)| (name, flag(is_on))).to_vec()
    }
}

/// Lists of layers on the GPU: an A-buffer.
#[derive(Debug)]
pub struct LayerLists {
    /// The header, and the head of the list of each pixel.
    pub heads: Room,
    /// Fragment nodes.
    pub nodes: Room,
    /// The header, to be read.
    pub counted: wgpu::Buffer,
}

impl LayerLists {
    /// Without room for anything.
    ///
    /// # Errors
    /// Those of the GPU.
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST;
        let read = wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ;
        Ok(Self {
            heads: Room::new(gpu, "lists of layers", usage | wgpu::BufferUsages::COPY_SRC, SMALLER)?,
            nodes: Room::new(gpu, "layers", usage, SMALLER)?,
            counted: gpu.empty_buffer("number of layers", read, 4 * HEADER)?,
        })
    }

    /// What they take on the GPU.
    pub fn bytes(&self) -> u64 {
        self.heads.buffer().size() + self.nodes.buffer().size()
    }

    /// As many words of the nodes, for shaders to tell from how many there is room for. They are bound two by two: of one more there
    /// is no further node.
    pub fn nodes(&self, words: u64) -> wgpu::BindingResource<'_> {
        let size = wgpu::BufferSize::new(4 * words.max(1).next_multiple_of(2));
        wgpu::BindingResource::Buffer(wgpu::BufferBinding { buffer: self.nodes.buffer(), offset: 0, size })
    }

    /// Reads the header, as it is after what was recorded; that is submitted.
    ///
    /// # Errors
    /// What the GPU cannot read back.
    pub fn read_header<T>(
        &self,
        gpu: &Gpu,
        recording: &mut Recording,
        read: impl FnOnce(&[u8]) -> T,
    ) -> Result<T, GpuError> {
        recording.encoder.copy_buffer_to_buffer(self.heads.buffer(), 0, &self.counted, 0, 4 * HEADER);
        recording.submit(gpu);
        gpu.mapped(&self.counted, read)
    }
}

/// A part of the picture, and how many words of nodes there are for it.
#[derive(Clone, Copy, Debug)]
pub struct Band {
    pub tile: PictureTile,
    pub words: u64,
}

/// Lays what is listed for a band one over the other.
pub fn composite(
    frame: &FrameContext,
    recording: &mut Recording,
    layering: &Layering,
    key: &CompositeKey,
    lists: &LayerLists,
    band: Band,
) {
    let FrameContext { gpu, targets, groups, shared, .. } = *frame;
    let entries = [
        (0, whole(lists.heads.buffer())),
        (1, lists.nodes(band.words)),
        (2, all_of(&targets.tail_sums)),
        (3, all_of(&targets.tail_through)),
        (4, whole(shared.fields.table.buffer())),
        (5, wgpu::BindingResource::TextureView(&shared.fields.values_view)),
        (6, wgpu::BindingResource::TextureView(&shared.fields.bricks_view)),
    ];
    let layout = key.lists();
    let own = group(gpu, layout.label, &frame.pipelines.layout(layout), &entries[..layout.entries.len()]);
    let colors =
        [&targets.transparency, &targets.shown_code, &targets.shown_depth].map(|target| Some(kept(&target.view)));
    let pass = DrawnPass {
        name: "composite",
        view: "main",
        lenses: layering.lenses(),
        shaded: Shaded::Counted,
        colors: &colors[..if layering.shown { 3 } else { 1 }],
        depth: None,
    };
    recording.draw(pass, |pass| {
        pass.set_pipeline(frame.pipelines.get(key));
        pass.set_bind_group(0, &groups.view, &[]);
        pass.set_bind_group(1, &groups.shade, &[]);
        pass.set_bind_group(2, &groups.lenses, &[]);
        pass.set_bind_group(3, &own, &[]);
        pass.set_vertex_buffer(0, shared.mesh.buffer().slice(..));
        let mut counted = Counted::NONE;
        for (corners, tile) in &layering.pieces {
            let tile = tile.common(band.tile);
            if corners.is_empty() || tile.is_empty() {
                continue;
            }
            scissor(pass, tile);
            pass.draw(corners.clone(), layering.part..layering.part + 1);
            counted += Counted::corners(corners.len() as u32);
        }
        counted
    });
}
