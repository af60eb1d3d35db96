//! What a pass is, and what it is handed.

use std::{
    any::{Any, TypeId},
    fmt::Debug,
};

use rustc_hash::FxHashMap;

use crate::{
    gpu::{Gpu, GpuError},
    render::{
        cities::Cities,
        images::Images,
        plan::FramePlan,
        programs::Programs,
        resource::{
            key::Key,
            pipelines::Pipelines,
            recording::Recording,
            targets::{Needs, Targets},
        },
        shared::{Shared, SharedGroups},
    },
};

/// One line of the list of passes: names under which statistics know it, and what it is for.
pub type Line = (&'static str, &'static str);

/// One pass of a frame: what it keeps on the GPU for a view.
pub(in crate::render) trait Pass: Debug + Sized {
    /// What it does in one frame, from the plan.
    type Input<'a>;

    /// Its part of the list of passes.
    const LIST: &'static [Line];

    /// Nothing yet.
    ///
    /// # Errors
    /// Those of the GPU.
    fn new(gpu: &Gpu) -> Result<Self, GpuError>;

    /// What a plan asks of it; `None`: nothing.
    fn wanted<'a>(plan: &'a FramePlan<'a>) -> Option<Self::Input<'a>>;

    /// Notes that a frame begins, whether or not it asks for the pass.
    fn begin(&mut self, _plan: &FramePlan) {}

    /// Forgets what it takes to be on the GPU: a frame failed, and it may not be there.
    fn forget(&mut self) {}

    /// Adds the targets that it draws into.
    fn add_needs(_input: &Self::Input<'_>, _plan: &FramePlan, _needs: &mut Needs) {}

    /// Adds the pipelines that it may run, in this frame or when a lens has moved.
    fn add_keys(&self, _input: Option<&Self::Input<'_>>, _plan: &FramePlan, _programs: &Programs, _keys: &mut Keys) {}

    /// Brings what it keeps on the GPU up to date.
    ///
    /// # Errors
    /// Those of the GPU.
    fn prepare(&mut self, _input: &Self::Input<'_>, _stage: &mut Preparing) -> Result<(), GpuError> {
        Ok(())
    }

    /// Records its commands.
    ///
    /// # Errors
    /// Those of the GPU, where something is read back on the way.
    fn record(
        &mut self,
        input: &Self::Input<'_>,
        frame: &FrameContext,
        recording: &mut Recording,
        board: &mut Board,
    ) -> Result<(), GpuError>;
}

/// What passes are recorded with.
#[derive(Clone, Copy)]
pub struct FrameContext<'a> {
    pub gpu: &'a Gpu,
    pub pipelines: &'a Pipelines,
    pub images: &'a Images,
    pub cities: Cities<'a>,
    pub shared: &'a Shared,
    pub groups: &'a SharedGroups,
    pub targets: &'a Targets,
    pub plan: &'a FramePlan<'a>,
    pub programs: &'a Programs,
}

/// What passes are prepared with.
pub struct Preparing<'a> {
    pub gpu: &'a Gpu,
    pub pipelines: &'a mut Pipelines,
    pub images: &'a Images,
    pub cities: Cities<'a>,
    pub shared: &'a mut Shared,
    pub targets: &'a Targets,
    pub plan: &'a FramePlan<'a>,
    pub programs: &'a Programs,
}

/// What passes hand on to later ones of the frame: one value of each type.
#[derive(Debug, Default)]
pub struct Board(FxHashMap<TypeId, Box<dyn Any>>);

impl Board {
    /// Hands a value on.
    pub fn put<T: Any>(&mut self, value: T) {
        self.0.insert(TypeId::of::<T>(), Box::new(value));
    }

    /// What was handed on.
    pub fn get<T: Any>(&self) -> Option<&T> {
        self.0.get(&TypeId::of::<T>())?.downcast_ref()
    }
}

/// A pipeline that a frame asks for.
#[derive(Debug)]
struct Asked {
    rank: u8,
    is_waited_for: bool,
    key: Key,
}

/// The pipelines that a frame asks for.
#[derive(Debug, Default)]
pub struct Keys(Vec<Asked>);

impl Keys {
    /// Adds pipelines; statistics name them by `rank`, and those of one rank in this order.
    pub fn add<K: Into<Key>>(&mut self, rank: u8, keys: impl IntoIterator<Item = K>) {
        self.0.extend(keys.into_iter().map(|key| Asked { rank, is_waited_for: false, key: key.into() }));
    }

    /// The same of pipelines of programs that are made off the frame where the back end is adaptive.
    pub fn add_programs<K: Into<Key>>(&mut self, rank: u8, keys: impl IntoIterator<Item = K>) {
        self.0.extend(keys.into_iter().map(|key| Asked { rank, is_waited_for: true, key: key.into() }));
    }

    /// Those that are made off the frame where the back end is adaptive.
    pub fn of_programs(&self) -> impl Iterator<Item = &Key> {
        self.0.iter().filter(|asked| asked.is_waited_for).map(|asked| &asked.key)
    }

    /// All, in the order of their ranks.
    pub fn sorted(mut self) -> Vec<Key> {
        self.0.sort_by_key(|asked| asked.rank);
        self.0.into_iter().map(|asked| asked.key).collect()
    }
}
