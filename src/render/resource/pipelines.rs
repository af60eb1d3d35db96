//! Pipelines by canonical key, made when first needed, or off the frame; how many were made and met again is counted. Where there are
//! too many, those that no frame has used for longest are given back.

use rustc_hash::{FxHashMap, FxHashSet};

use crate::{
    gpu::Gpu,
    render::resource::{
        bindings::GroupLayout,
        key::{AnyKey, Key},
        pipeline::{Maker, Modules, Pipeline},
        worker::Worker,
    },
};

/// A pipeline, and the last frame that used it.
#[derive(Debug)]
struct Made {
    pipeline: Pipeline,
    frame: u64,
}

/// All pipelines.
#[derive(Debug)]
pub struct Pipelines {
    maker: Maker,
    modules: Modules,
    made: FxHashMap<Key, Made>,
    /// The number of this frame.
    frame: u64,
    /// Pipelines that a frame waited for, since the last [`Pipelines::begin_picture`].
    pub compiled: u32,
    /// Whether lists were narrowed since then, and whether the pipeline for it was made.
    pub narrowing: Option<bool>,
    /// Pipelines that were made off the frame and arrived since then.
    pub arrived: u32,
    /// Keys of the pipelines used since then, in order of first use.
    pub used: Vec<Key>,
    /// Made off the frame: what was asked for and is not there yet, and the worker that makes it.
    asked: FxHashSet<Key>,
    worker: Option<Worker>,
}

impl Pipelines {
    /// No pipeline yet.
    pub fn new(gpu: &Gpu) -> Self {
        Self {
            maker: Maker::new(gpu),
            modules: Modules::default(),
            made: FxHashMap::default(),
            frame: 0,
            compiled: 0,
            narrowing: None,
            arrived: 0,
            used: Vec::new(),
            asked: FxHashSet::default(),
            worker: None,
        }
    }

    /// The bind group layout that plain data describe.
    pub fn layout(&self, layout: &GroupLayout) -> wgpu::BindGroupLayout {
        self.maker.layouts.of(layout)
    }

    /// Where samples are summed: f32 where it can be blended, else f16.
    pub fn sums(&self) -> wgpu::TextureFormat {
        self.maker.sums
    }

    /// All are made anew: effects have other WGSL now.
    pub fn forget(&mut self) {
        self.worker = None;
        self.modules.clear();
        self.made.clear();
        self.asked.clear();
    }

    /// Starts counting anew.
    pub fn begin_picture(&mut self) {
        (self.compiled, self.arrived) = (0, 0);
        self.narrowing = None;
        self.used.clear();
    }

    /// Starts a frame, which prepares all that it uses. Where there are more than `most`, a quarter of them goes.
    pub fn begin_frame(&mut self, most: usize) {
        self.frame += 1;
        if self.made.len() <= most {
            return;
        }
        let mut frames: Vec<u64> = self.made.values().map(|made| made.frame).collect();
        frames.sort_unstable();
        let oldest = frames[(frames.len() - most + most / 4).min(frames.len() - 1)];
        self.made.retain(|_, made| made.frame >= oldest);
        self.modules.clear();
    }

    /// Makes a pipeline if it is not there yet.
    pub fn prepare(&mut self, key: &Key) {
        let frame = self.frame;
        match self.made.get_mut(key) {
            Some(made) => made.frame = frame,
            None => {
                let pipeline = self.maker.make(&mut self.modules, &**key);
                self.made.insert(key.clone(), Made { pipeline, frame });
                self.compiled += 1;
            }
        }
        if !self.used.contains(key) {
            self.used.push(key.clone());
        }
    }

    /// Whether a pipeline is there; if it is not, it is made off the frame, and is there in a later one.
    pub fn is_ready(&mut self, key: &Key) -> bool {
        while let Some(Ok((key, pipeline))) = self.worker.as_ref().map(|w| w.ready.try_recv()) {
            self.asked.remove(&key);
            // The frame may have made it meanwhile.
            self.made.entry(key).or_insert(Made { pipeline, frame: self.frame });
            self.arrived += 1;
        }
        if self.made.contains_key(key) {
            return true;
        }
        if self.asked.insert(key.clone()) {
            if self.worker.is_none() {
                self.worker = Worker::start(self.maker.clone());
            }
            let sent = self
                .worker
                .as_ref()
                .is_some_and(|w| w.wanted.as_ref().is_some_and(|wanted| wanted.send(key.clone()).is_ok()));
            if !sent {
                self.worker = None;
                self.asked.clear();
            }
        }
        false
    }

    /// How many pipelines are there.
    pub fn kept(&self) -> usize {
        self.made.len()
    }

    /// How many pipelines are being made off the frame.
    pub fn pending(&self) -> usize {
        self.asked.len()
    }

    /// A prepared pipeline.
    pub fn get(&self, key: &(dyn AnyKey + 'static)) -> &wgpu::RenderPipeline {
        match self.made.get(key).map(|made| &made.pipeline) {
            Some(Pipeline::Render(pipeline)) => pipeline,
            _ => unreachable!("{key:?} was not prepared"),
        }
    }

    /// A prepared pipeline that computes.
    pub fn get_compute(&self, key: &(dyn AnyKey + 'static)) -> &wgpu::ComputePipeline {
        match self.made.get(key).map(|made| &made.pipeline) {
            Some(Pipeline::Compute(pipeline)) => pipeline,
            _ => unreachable!("{key:?} was not prepared"),
        }
    }
}
