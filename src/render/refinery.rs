//! Refines what deformations meet, on the GPU: `pass/refine.wgsl` in rounds, and [`crate::geom::deform::refine`] is its reference.
//!
//! ```text
//!   host: triangles that a support reaches ── gather ──▶ corners (cells of a lattice), triangles
//!                ┌───────────────────────────────────────────┘
//!                ▼
//!         ask ▶ look_inside ▶ add_up ▶ add_groups ──▶ host reads the sums ──▶ split ──▶ all done? ── yes ──▶ place, mix, draw, find_chunks
//!                ▲                                                                        │ no
//!                └────────────────────────────────────────────────────────────────────────┘
//! ```
//!
//! The order of triangles stays that of their sources in every round, so that what is drawn is the same each time.

use std::ops::Range;

use glam::{DVec3, IVec3};

use crate::{
    geom::{
        Aabb,
        deform::{
            Deformers,
            refine::{Limits, Report},
        },
    },
    gpu::{Gpu, GpuError},
    render::{
        deform_words::{DeformNumbers, Lattice, plan_of},
        layout::{self, CityVertex},
        resource::{
            bindings::{group, whole},
            synced::{Room, Synced},
        },
    },
    shader::{DeformPlan, Module},
};

/// `pass/refine.wgsl`.
const GROUP: u64 = 256;
const ROW: u64 = 32768;
const ANSWER_WORDS: u64 = 5;
const SUM_BYTES: u64 = 16;
const CORNER_BYTES: u64 = size_of::<layout::Corner>() as u64;
const TRIANGLE_BYTES: u64 = size_of::<layout::Triangle>() as u64;
/// Of `rest_bits`.
pub(super) const TURNED: u32 = 4;
pub(super) const LAYER_SHIFT: u32 = 3;
/// Kernels are kept for so many kinds of deformations.
const MOST_PLANS: usize = 8;
/// By how much the tolerance is raised where there are too many triangles, and how often; then nothing is halved at all.
const COARSER: f32 = 4.0;
const COARSENINGS: u32 = 8;
/// What to do where what is refined is too large for the GPU.
const SMALLER: &str = "a smaller lens, or one over fewer triangles, would be right (shape of the deformation)";

/// Kernels, and what each binds.
const KERNELS: [(&str, &[u32]); 10] = [
    ("gather", &[0, 3, 6, 7, 14]),
    ("ask", &[0, 1, 2, 3, 4, 11, 12, 13]),
    ("look_inside", &[0, 1, 2, 3, 4, 11, 12, 13]),
    ("add_up", &[0, 2, 4, 5]),
    ("add_groups", &[0, 5]),
    ("split", &[0, 1, 2, 3, 4, 5, 6, 14]),
    ("place", &[0, 1, 3, 7, 8, 10, 12]),
    ("mix_texcoords", &[0, 3, 9, 10]),
    ("draw", &[0, 1, 2, 7, 8, 10]),
    ("find_chunks", &[0, 2, 7, 10]),
];

/// The triangles that deformations may meet, at rest; three corners each, in the order of their places.
#[derive(Debug)]
pub(super) struct Rest {
    pub corners: wgpu::Buffer,
    /// Which corner flat values come from, [`TURNED`], and the layer of coplanar faces.
    pub bits: wgpu::Buffer,
    /// Where some have textures.
    pub texcoords: Option<wgpu::Buffer>,
    pub triangles: u32,
    /// The first triangle of each chunk, and behind the last one how many there are.
    pub firsts: Vec<u32>,
    pub lattice: Lattice,
    /// What deformations do, and the numbers of that.
    pub plan: DeformPlan,
    pub numbers: wgpu::Buffer,
    pub tables: wgpu::Buffer,
}

/// The same, on the host.
pub(super) struct RestTriangles<'a> {
    pub corners: &'a [CityVertex],
    pub bits: &'a [u32],
    pub texcoords: Option<&'a [[f32; 2]]>,
    pub firsts: Vec<u32>,
}

impl Rest {
    /// Triangles that are in `reach` at rest and where deformers take them.
    pub fn new(gpu: &Gpu, triangles: RestTriangles, deformers: &Deformers, reach: &Aabb) -> Result<Self, GpuError> {
        use wgpu::BufferUsages as U;
        let RestTriangles { corners, bits, texcoords, firsts } = triangles;
        let (plan, lattice) = (plan_of(deformers), Lattice::around(reach));
        let DeformNumbers { numbers, tables } = DeformNumbers::new(deformers, &plan, &lattice);
        Ok(Self {
            corners: gpu.buffer("corners at rest", U::STORAGE, corners)?,
            bits: gpu.buffer("triangles at rest", U::STORAGE | U::COPY_SRC, bits)?,
            texcoords: texcoords.map(|all| gpu.buffer("texture coordinates at rest", U::STORAGE, all)).transpose()?,
            triangles: bits.len() as u32,
            firsts,
            lattice,
            numbers: gpu.buffer("numbers of deformations", U::UNIFORM, &numbers)?,
            tables: gpu.buffer("tables of deformations", U::STORAGE, &tables)?,
            plan,
        })
    }
}

/// What they become.
#[derive(Debug)]
pub(super) struct Made {
    /// [`CityVertex`]s.
    pub vertices: wgpu::Buffer,
    pub indices: wgpu::Buffer,
    pub texcoords: Option<wgpu::Buffer>,
    pub triangles: u32,
    /// The triangles of each chunk, and a box around them.
    pub chunks: Vec<(Range<u32>, Aabb)>,
    pub report: Report,
}

/// What refines, and the room that it works in.
#[derive(Debug)]
pub(super) struct Refinery {
    /// What was refined last, and the kernels for it.
    pipelines: Vec<(DeformPlan, Vec<wgpu::ComputePipeline>)>,
    /// One for each of two rounds in turn.
    stages: [Synced; 2],
    triangles: [Room; 2],
    corners: [Room; 2],
    answers: Room,
    sums: Room,
    asked: [Room; 2],
    coarse: wgpu::Buffer,
    /// The sums of a round.
    read: wgpu::Buffer,
}

/// One dispatch.
struct Task {
    kernel: usize,
    items: u64,
}

impl Refinery {
    pub fn new(gpu: &Gpu) -> Result<Self, GpuError> {
        use wgpu::BufferUsages as U;
        let room = |label| Room::new(gpu, label, U::STORAGE | U::COPY_SRC | U::COPY_DST, SMALLER);
        let stage = || Synced::new(gpu, "stage of refining", U::STORAGE);
        Ok(Self {
            pipelines: Vec::new(),
            stages: [stage()?, stage()?],
            triangles: [room("triangles that are refined")?, room("triangles that are refined")?],
            corners: [room("corners of what is refined")?, room("corners of what is refined")?],
            answers: room("answers of edges")?,
            sums: room("sums of refined triangles")?,
            asked: [room("triangles that are asked")?, room("triangles that are asked")?],
            coarse: gpu.empty_buffer("edges that stay coarse", U::STORAGE | U::COPY_DST | U::COPY_SRC, 4)?,
            read: gpu.empty_buffer("sums", U::COPY_DST | U::MAP_READ, 16)?,
        })
    }

    /// Makes kernels for what deformations do, unless there are some.
    fn fit_pipelines(&mut self, gpu: &Gpu, plan: &DeformPlan) {
        let known = self.pipelines.iter().position(|(of, _)| of == plan);
        let own = match known {
            Some(i) => self.pipelines.remove(i),
            None => (plan.clone(), pipelines_of(gpu, plan)),
        };
        self.pipelines.truncate(MOST_PLANS - 1);
        self.pipelines.insert(0, own);
    }

    /// Refines until no edge is farther off than asked for; `stage`: the view and its tolerance.
    pub fn refined(&mut self, gpu: &Gpu, rest: &Rest, stage: &layout::Refinement) -> Result<Made, GpuError> {
        let mut stage = layout::Refinement {
            anchor: rest.lattice.anchor.to_array(),
            shift: rest.lattice.shift,
            met: rest.triangles,
            chunks: (rest.firsts.len() as u32).saturating_sub(1),
            ..*stage
        };
        self.fit_pipelines(gpu, &rest.plan);
        let mut attempt = 0;
        loop {
            if let Some(made) = self.attempt(gpu, rest, &mut stage, attempt < COARSENINGS)? {
                return Ok(made);
            }
            attempt += 1;
            match attempt {
                COARSENINGS => stage.shortest = f32::MAX,
                _ => stage.tolerance *= COARSER,
            }
        }
    }

    /// `None`: there would be too many triangles.
    fn attempt(
        &mut self,
        gpu: &Gpu,
        rest: &Rest,
        stage: &mut layout::Refinement,
        is_limited: bool,
    ) -> Result<Option<Made>, GpuError> {
        let limit = gpu.device.limits().max_storage_buffer_binding_size / CORNER_BYTES;
        let most = if is_limited { limit.min(Limits::default().triangles as u64) } else { u64::MAX };
        gpu.write(&self.coarse, &[0_u32]);
        let met = u64::from(rest.triangles);
        (stage.items, stage.corners) = (rest.triangles, 3 * rest.triangles);
        self.triangles[1].fit(gpu, met * TRIANGLE_BYTES)?;
        self.corners[0].fit(gpu, 3 * met * CORNER_BYTES)?;
        self.asked[1].fit(gpu, met * 4)?;
        let mut is_odd = false;
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        stage.asked = stage.items;
        self.stages[0].sync(gpu, &[*stage])?;
        self.run(gpu, &mut encoder, rest, 0, &[], &[Task { kernel: 0, items: met }]);
        self.triangles.swap(0, 1);
        self.asked.swap(0, 1);
        while stage.asked > 0 {
            let (items, asked) = (u64::from(stage.items), u64::from(stage.asked));
            self.answers.fit(gpu, items * ANSWER_WORDS * 4)?;
            let groups = items.div_ceil(GROUP);
            self.sums.fit(gpu, (items + groups + 1) * SUM_BYTES)?;
            let now = usize::from(is_odd);
            let tasks = [(1, 3 * asked), (2, asked), (3, groups), (4, 1)];
            let tasks = tasks.map(|(kernel, items)| Task { kernel, items });
            self.run(gpu, &mut encoder, rest, now, &[], &tasks);
            encoder.copy_buffer_to_buffer(self.sums.buffer(), (items + groups) * SUM_BYTES, &self.read, 0, SUM_BYTES);
            gpu.queue.submit([encoder.finish()]);
            let [triangles, fresh, left]: [u32; 3] =
                gpu.mapped(&self.read, |bytes| [0, 4, 8].map(|at| bytemuck::pod_read_unaligned(&bytes[at..at + 4])))?;
            encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            let corners = stage.corners + fresh;
            if u64::from(triangles.max(corners)) > most {
                return Ok(None);
            }
            self.triangles[1].fit(gpu, u64::from(triangles) * TRIANGLE_BYTES)?;
            self.asked[1].fit(gpu, u64::from(left) * 4)?;
            self.fit_corners(gpu, &mut encoder, u64::from(stage.corners), u64::from(corners))?;
            self.run(gpu, &mut encoder, rest, now, &[], &[Task { kernel: 5, items }]);
            self.triangles.swap(0, 1);
            self.asked.swap(0, 1);
            (stage.items, stage.corners, stage.asked) = (triangles, corners, left);
            is_odd = !is_odd;
            self.stages[usize::from(is_odd)].sync(gpu, &[*stage])?;
        }
        self.made(gpu, encoder, rest, stage, usize::from(is_odd)).map(Some)
    }

    /// Moves the corners of the last round and writes what is drawn.
    fn made(
        &self,
        gpu: &Gpu,
        mut encoder: wgpu::CommandEncoder,
        rest: &Rest,
        stage: &layout::Refinement,
        now: usize,
    ) -> Result<Made, GpuError> {
        use wgpu::BufferUsages as U;
        let (items, corners) = (u64::from(stage.items), u64::from(stage.corners));
        let made = |label, usage, bytes| gpu.empty_buffer(label, usage | U::STORAGE | U::COPY_SRC, bytes);
        let vertices = made("deformed vertices", U::VERTEX, corners * size_of::<CityVertex>() as u64)?;
        let indices = made("deformed indices", U::INDEX, 12 * items)?;
        let texcoords = rest
            .texcoords
            .as_ref()
            .map(|_| made("deformed texture coordinates", U::VERTEX, 8 * corners))
            .transpose()?;
        let words: Vec<u32> = rest.firsts.windows(2).flat_map(|ends| [ends[0], 0, 0, 0, 0, 0, 0, ends[1]]).collect();
        let chunks = gpu.buffer("chunks of what is deformed", U::STORAGE | U::COPY_SRC, &words)?;
        let own = [
            (6, corners, Some(&vertices)),
            (7, corners, texcoords.as_ref()),
            (8, items, Some(&indices)),
            // A group for each.
            (9, GROUP * u64::from(stage.chunks), Some(&chunks)),
        ];
        for (kernel, items, buffer) in own {
            let Some(buffer) = buffer else { continue };
            // The last two look at what the first one placed.
            let seen: &[(u32, &wgpu::Buffer)] =
                if kernel >= 8 { &[(10, buffer), (7, &vertices)] } else { &[(10, buffer)] };
            self.run(gpu, &mut encoder, rest, now, seen, &[Task { kernel, items }]);
        }
        let bytes = 4 * words.len() as u64;
        let read = gpu.empty_buffer("read-back", U::COPY_DST | U::MAP_READ, bytes + 4)?;
        encoder.copy_buffer_to_buffer(&chunks, 0, &read, 0, bytes);
        encoder.copy_buffer_to_buffer(&self.coarse, 0, &read, bytes, 4);
        gpu.queue.submit([encoder.finish()]);
        let read: Vec<u32> = gpu.mapped(&read, bytemuck::pod_collect_to_vec)?;
        let too_coarse = read.get(words.len()).copied().unwrap_or(0) as usize;
        let (found, _) = read[..words.len()].as_chunks::<8>();
        let ends = found.iter().skip(1).map(|words| words[0]).chain([stage.items]);
        let chunks = found.iter().zip(ends).map(|(words, end)| {
            let place = |k: usize| rest.lattice.place(IVec3::from([0, 1, 2].map(|axis| words[k + axis] as i32)));
            // What was not moved is where it was, next to a cell.
            let cell = rest.lattice.cell_m();
            (words[0]..end, Aabb { min: place(1) - cell, max: place(4) + cell })
        });
        let (tolerance_px, shortest_m) = (f64::from(stage.tolerance), f64::from(stage.shortest));
        Ok(Made {
            chunks: chunks.collect(),
            vertices,
            indices,
            texcoords,
            triangles: stage.items,
            report: Report { tolerance_px, shortest_m, too_coarse, unusable: 0 },
        })
    }

    /// The edges of what was refined last, by their ends at rest, metres; each once for every triangle beside it. For measurements.
    pub fn edges(&self, gpu: &Gpu, rest: &Rest, triangles: u32) -> Result<Vec<[DVec3; 2]>, GpuError> {
        let words = |room: &Room| -> Result<Vec<u32>, GpuError> {
            Ok(bytemuck::pod_collect_to_vec(&gpu.read_buffer(room.buffer())?))
        };
        let (corners, triangle_words) = (words(&self.corners[0])?, words(&self.triangles[0])?);
        let place = |i: u32| {
            let at = i as usize * (CORNER_BYTES as usize / 4);
            rest.lattice.place(IVec3::from([0, 1, 2].map(|axis| corners[at + axis] as i32)))
        };
        let of_triangle = |words: &[u32]| {
            let [a, b, c] = [0, 1, 2].map(|i| place(words[i]));
            [[a, b], [b, c], [c, a]]
        };
        let all = triangle_words.chunks_exact(TRIANGLE_BYTES as usize / 4).take(triangles as usize);
        Ok(all.flat_map(of_triangle).collect())
    }

    /// Makes room for more corners, beside those that are there.
    fn fit_corners(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        before: u64,
        corners: u64,
    ) -> Result<(), GpuError> {
        if corners * CORNER_BYTES > self.corners[0].buffer().size() {
            self.corners[1].fit(gpu, corners * CORNER_BYTES)?;
            let [from, to] = &self.corners;
            encoder.copy_buffer_to_buffer(from.buffer(), 0, to.buffer(), 0, before * CORNER_BYTES);
            self.corners.swap(0, 1);
        }
        Ok(())
    }

    /// Notes dispatches, one after the other; `own`: buffers that are theirs, by binding.
    fn run(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        rest: &Rest,
        stage: usize,
        own: &[(u32, &wgpu::Buffer)],
        tasks: &[Task],
    ) {
        let common = |binding: u32| match binding {
            0 => self.stages[stage].buffer(),
            1 => &rest.numbers,
            2 => self.triangles[0].buffer(),
            3 => self.corners[0].buffer(),
            4 => self.answers.buffer(),
            5 => self.sums.buffer(),
            6 => self.triangles[1].buffer(),
            7 => &rest.corners,
            8 => &rest.bits,
            9 => rest.texcoords.as_ref().unwrap_or(&rest.corners),
            12 => &rest.tables,
            13 => self.asked[0].buffer(),
            14 => self.asked[1].buffer(),
            _ => &self.coarse,
        };
        let Some((_, pipelines)) = self.pipelines.first() else { return };
        for Task { kernel, items } in tasks {
            let pipeline = &pipelines[*kernel];
            let buffer =
                |binding: u32| own.iter().find(|(b, _)| *b == binding).map_or_else(|| common(binding), |(_, b)| b);
            // A kernel that does not read tables has no room for them.
            let bound = KERNELS[*kernel].1.iter().filter(|binding| **binding != 12 || rest.plan.has_tables());
            let entries: Vec<_> = bound.map(|&binding| (binding, whole(buffer(binding)))).collect();
            let bound = group(gpu, "refining", &pipeline.get_bind_group_layout(0), &entries);
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
                label: Some(KERNELS[*kernel].0),
                timestamp_writes: None,
            });
            pass.set_pipeline(pipeline);
            pass.set_bind_group(0, &bound, &[]);
            let groups = items.div_ceil(GROUP).max(1);
            pass.dispatch_workgroups(groups.min(ROW) as u32, groups.div_ceil(ROW) as u32, 1);
        }
    }
}

fn pipelines_of(gpu: &Gpu, plan: &DeformPlan) -> Vec<wgpu::ComputePipeline> {
    let module = gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some("refine"),
        source: wgpu::ShaderSource::Wgsl(Module::Refine(plan.clone()).source().into()),
    });
    let pipeline = |(entry_point, _): &(&str, &[u32])| {
        gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(entry_point),
            layout: None,
            module: &module,
            entry_point: Some(entry_point),
            compilation_options: Default::default(),
            cache: None,
        })
    };
    KERNELS.iter().map(pipeline).collect()
}

#[cfg(test)]
mod tests;
