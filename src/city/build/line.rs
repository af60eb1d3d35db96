//! Geometries to triangles, in parallel and in order, without holding much more than the result.
//!
//! ```text
//! parts ─> jobs of some hundred polygons ─> workers: each takes the next job, does it, and appends what is due:
//!                                             its own chunk, and those that waited for it
//! ```

use std::{
    collections::BTreeMap,
    sync::{Condvar, Mutex, MutexGuard, PoisonError},
};

use super::{
    job::{self, Chunk},
    planes::PlaneTable,
    staging::{PackedStaging, Part, corners_and_triangles},
};

use crate::city::{
    build::lattice::Lattice,
    model::{CityModel, CutTriangle, NONE},
};

/// Jobs in a city, about; results do not depend on it.
const JOBS: usize = 128;
/// Fewest and most polygons per job: enough to be worth a thread's while, few enough to share work evenly.
const JOB_POLYGONS: (usize, usize) = (96, 1024);
/// Polygons that wait, done out of order, are at most this part of the city (or a job for each
/// worker): one too far ahead rests.
const WAITING_PART: usize = 32;

/// Triangulates geometries (sorted by object and LoD) and appends them to the model, in order.
pub(super) fn finish_geometries(model: &mut CityModel, staging: PackedStaging) {
    let context = job::Context::new(&model.objects, &model.surfaces, &staging);
    let polygons: usize = staging.parts.iter().map(Part::polygon_count).sum();
    let job_polygons = (polygons / JOBS).clamp(JOB_POLYGONS.0, JOB_POLYGONS.1);
    let line = Line {
        most_waiting: (polygons / WAITING_PART).max(rayon::current_num_threads() * job_polygons),
        state: Mutex::new(State {
            jobs: Jobs { parts: &staging.parts, polygons: job_polygons },
            taken: 0,
            waiting: BTreeMap::new(),
            waiting_polygons: 0,
            due: 0,
            built: Some(Built::new(&staging)),
            spare: Vec::new(),
            has_failed: false,
        }),
        moved: Condvar::new(),
    };
    rayon::scope(|scope| {
        for _ in 0..rayon::current_num_threads() {
            scope.spawn(|_| line.work(&context));
        }
    });
    let State { built, spare, .. } = line.state.into_inner().unwrap_or_else(PoisonError::into_inner);
    spare.into_iter().for_each(Chunk::give_back);
    model.steps = context.classes.iter().map(|lattice| lattice.step).collect();
    drop(context);
    staging.give_back();
    if let Some(built) = built {
        built.finish(model);
    }
}

/// Cuts sorted geometries into jobs; an object's geometries of one LoD stay together.
struct Jobs<'a> {
    parts: &'a [Part],
    /// At least so many per job, while there are any.
    polygons: usize,
}

impl<'a> Iterator for Jobs<'a> {
    type Item = &'a [Part];

    fn next(&mut self) -> Option<Self::Item> {
        let mut polygons = 0;
        let mut end = 0;
        while let Some(part) = self.parts.get(end) {
            let same_shape = end > 0 && {
                let last = &self.parts[end - 1];
                (last.object, last.lod) == (part.object, part.lod)
            };
            if polygons >= self.polygons && !same_shape {
                break;
            }
            polygons += part.polygon_count();
            end += 1;
        }
        let (job, rest) = self.parts.split_at(end);
        self.parts = rest;
        (!job.is_empty()).then_some(job)
    }
}

/// Where workers take jobs and put chunks.
struct Line<'a> {
    /// Polygons in [`State::waiting`] beyond which no new job is taken.
    most_waiting: usize,
    state: Mutex<State<'a>>,
    /// A chunk was appended.
    moved: Condvar,
}

struct State<'a> {
    jobs: Jobs<'a>,
    /// Jobs taken so far: the number of the next.
    taken: usize,
    /// Chunks that came before those of earlier jobs, by number.
    waiting: BTreeMap<usize, Chunk>,
    waiting_polygons: usize,
    /// The number of the chunk to be appended next.
    due: usize,
    /// The parts so far, which are appended to; `None` while a worker does it.
    built: Option<Built>,
    /// Appended chunks, to be used again: allocators keep what each thread frees apart, so asking anew for each job
    /// would hold several times as much.
    spare: Vec<Chunk>,
    /// A worker panicked: none waits for it.
    has_failed: bool,
}

impl<'a> Line<'a> {
    fn lock(&self) -> MutexGuard<'_, State<'a>> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Does jobs until none is left.
    fn work(&self, context: &job::Context<'_>) {
        let alarm = Alarm { line: self };
        let mut scratch = job::Scratch::default();
        while let Some((number, job, mut chunk)) = self.take() {
            job::run(job, context, &mut scratch, &mut chunk);
            self.put(number, chunk, &context.classes);
        }
        drop(alarm);
    }

    /// The next job and a chunk for it. A worker too far ahead waits: the job that is due is with another, at work.
    fn take(&self) -> Option<(usize, &'a [Part], Chunk)> {
        let mut state = self.lock();
        while state.waiting_polygons > self.most_waiting && !state.has_failed {
            state = self.moved.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
        let job = state.jobs.next()?;
        let number = state.taken;
        state.taken += 1;
        Some((number, job, state.spare.pop().unwrap_or_default()))
    }

    /// Hands in the chunk of a job, and appends all that are due, unless another worker is at it and will.
    fn put(&self, number: usize, chunk: Chunk, classes: &[Lattice]) {
        let mut state = self.lock();
        state.waiting_polygons += chunk.polygons as usize;
        state.waiting.insert(number, chunk);
        while let Some(mut built) = state.built.take() {
            let due = state.due;
            let Some(mut chunk) = state.waiting.remove(&due) else {
                state.built = Some(built);
                break;
            };
            drop(state);
            built.append(&mut chunk, classes);
            state = self.lock();
            state.built = Some(built);
            state.due += 1;
            state.waiting_polygons -= chunk.polygons as usize;
            // One of a single large geometry is not worth keeping.
            match chunk.polygons as usize <= 2 * JOB_POLYGONS.1 {
                true => state.spare.push(chunk),
                false => chunk.give_back(),
            }
            self.moved.notify_all();
        }
    }
}

/// Wakes those who would wait for a worker that panics.
struct Alarm<'a, 'b> {
    line: &'b Line<'a>,
}

impl Drop for Alarm<'_, '_> {
    fn drop(&mut self) {
        if std::thread::panicking() {
            self.line.lock().has_failed = true;
            self.line.moved.notify_all();
        }
    }
}

/// Everything appended so far.
struct Built {
    chunk: Chunk,
    planes: PlaneTable,
    /// Polygons so far, for the plane table.
    polygons: u32,
}

impl Built {
    /// Nothing yet. Nearly the whole is known before: growing by doubling would cost half as much memory again.
    fn new(staging: &PackedStaging) -> Self {
        let (corners, triangles) = corners_and_triangles(&staging.parts);
        let mut chunk = Chunk::default();
        chunk.vertices.reserve_exact(corners);
        chunk.indices.reserve_exact(3 * triangles);
        chunk.planes.reserve_exact(triangles);
        chunk.texcoords.reserve_exact(staging.texcoord_count());
        chunk.geometries.reserve_exact(staging.parts.len());
        chunk.tiles.reserve_exact(staging.parts.len());
        Self { chunk, planes: PlaneTable::default(), polygons: 0 }
    }

    fn append(&mut self, chunk: &mut Chunk, classes: &[Lattice]) {
        let all = &mut self.chunk;
        let (vertices, indices) = (all.vertices.len() as u32, all.indices.len() as u32);
        let (tiles, texcoords) = (all.tiles.len() as u32, all.texcoords.len() as u32);
        let geometries = all.geometries.len() as u32;
        let triangles = all.planes.len() as u32;
        all.cut_polygons
            .extend(chunk.cut_polygons.iter().map(|cut| CutTriangle { triangle: cut.triangle + triangles, ..*cut }));
        append_slice(&mut all.vertices, &chunk.vertices);
        append_slice(&mut all.indices, &chunk.indices);
        append_slice(&mut all.texcoords, &chunk.texcoords);
        make_room(&mut all.tiles, chunk.tiles.len());
        all.tiles.extend(chunk.tiles.drain(..).map(|mut tile| {
            tile.geometry += geometries;
            tile.vertices = tile.vertices.start + vertices..tile.vertices.end + vertices;
            tile.indices = tile.indices.start + indices..tile.indices.end + indices;
            if tile.texcoords != NONE {
                tile.texcoords += texcoords;
            }
            tile
        }));
        all.geometries.extend(chunk.geometries.drain(..).map(|mut geometry| {
            geometry.tiles = geometry.tiles.start + tiles..geometry.tiles.end + tiles;
            geometry
        }));
        let numbers: Vec<u32> = chunk
            .plane_keys
            .iter()
            .map(|&(key, polygon)| self.planes.add(key, self.polygons + polygon, classes))
            .collect();
        all.planes.extend(chunk.planes.iter().map(|&local| if local == 0 { 0 } else { numbers[local as usize - 1] }));
        self.polygons += chunk.polygons;
        all.warnings.append(std::mem::take(&mut chunk.warnings));
    }

    /// Hands everything to the model.
    fn finish(self, model: &mut CityModel) {
        let Self { mut chunk, planes, .. } = self;
        model.plane_equations = planes.finish(&mut chunk.planes);
        chunk.vertices.shrink_to_fit();
        chunk.indices.shrink_to_fit();
        chunk.planes.shrink_to_fit();
        chunk.texcoords.shrink_to_fit();
        chunk.tiles.shrink_to_fit();
        model.geometries = chunk.geometries;
        model.tiles = chunk.tiles;
        model.vertices = chunk.vertices;
        model.texcoords = chunk.texcoords;
        model.indices = chunk.indices;
        model.planes = chunk.planes;
        chunk.cut_polygons.shrink_to_fit();
        model.cut_polygons = chunk.cut_polygons;
        model.warnings.append(chunk.warnings);
    }
}

/// Room for `more`: where what was reserved is too little (tiles share corners), an eighth at a time, not the double.
fn make_room<T>(list: &mut Vec<T>, more: usize) {
    if list.capacity() - list.len() < more {
        list.reserve_exact(more.max(list.len() / 8));
    }
}

fn append_slice<T: Copy>(list: &mut Vec<T>, more: &[T]) {
    make_room(list, more.len());
    list.extend_from_slice(more);
}
