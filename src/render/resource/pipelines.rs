//! Pipelines by canonical key, made when first needed, or off the frame; how many were made and met again is counted.

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

/// All pipelines.
#[derive(Debug)]
pub struct Pipelines {
    maker: Maker,
    modules: Modules,
    made: FxHashMap<Key, Pipeline>,
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

    /// Makes a pipeline if it is not there yet.
    pub fn prepare(&mut self, key: &Key) {
        if !self.made.contains_key(key) {
            let pipeline = self.maker.make(&mut self.modules, &**key);
            self.made.insert(key.clone(), pipeline);
            self.compiled += 1;
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
            self.made.entry(key).or_insert(pipeline);
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

    /// How many pipelines are being made off the frame.
    pub fn pending(&self) -> usize {
        self.asked.len()
    }

    /// A prepared pipeline.
    pub fn get(&self, key: &(dyn AnyKey + 'static)) -> &wgpu::RenderPipeline {
        match self.made.get(key) {
            Some(Pipeline::Render(pipeline)) => pipeline,
            _ => unreachable!("{key:?} was not prepared"),
        }
    }

    /// A prepared pipeline that computes.
    pub fn get_compute(&self, key: &(dyn AnyKey + 'static)) -> &wgpu::ComputePipeline {
        match self.made.get(key) {
            Some(Pipeline::Compute(pipeline)) => pipeline,
            _ => unreachable!("{key:?} was not prepared"),
        }
    }
}
