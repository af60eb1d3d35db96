//! WGSL text: which files make which module, and the parts that are put together from the scene.
//!
//! No wgpu handle lives here. Entry points stand in `shaders/pass` alone; everything else is importable
//! and free of side effects.

mod adapter;
mod backend;
mod bodies;
mod carried;
mod contents;
mod deforming;
pub mod effect;
pub mod effect_file;
mod epochs;
mod files;
mod followed;
mod forms;
mod forward;
mod geometry;
mod hiding;
pub mod host;
mod invoke;
mod lens_test;
mod library;
mod lining;
mod masks;
mod module;
mod module_name;
mod names;
mod own_region;
mod plan;
mod rays;
mod regions;
mod rows;
mod sections;
mod shading;
mod sorting;
mod specialised;
mod table;
mod template;
mod translucent;
mod uber;
pub mod wgsl;
mod writer;

pub use adapter::Adapter;
pub use carried::LEAST_CARRIED;
pub use deforming::{DEFORMER_NUMBERS, DeformPlan, PlanControl, PlanDeformer, PlanStep, STEP_HEAD};
pub use effect::{EffectDefinition, EffectKind, Mode, PerObject, effects, handlers};
pub use forward::{Forward, ForwardKind};
pub use lining::BENT_PARTS;
pub use module::Module;
pub use plan::{
    Bends, MOST_RAY_LENSES, Plan, RAY_NUMBERS,
    content::{Clip, MOST_CITIES, PlanContent},
    epoch::PlanEpoch,
    form::Form,
    lens::{BodyKind, PlanBody, PlanBorder, PlanLens},
    lens_test::LensTest,
    program::Program,
    regions::Regions,
    step::{Blend, ClassTest, Scope, Step, scope_number},
    uber::Uber,
};
pub use table::{MOST_SLOTS, MOST_VOLUMES, TILE_PX};

#[cfg(test)]
mod tests;
