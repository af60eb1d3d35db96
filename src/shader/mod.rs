//! WGSL text: which files make which module, and the parts that are put together from the scene.
//!
//! No wgpu handle lives here. Entry points stand in `shaders/pass` alone; everything else is importable
//! and free of side effects.

mod carried;
mod contents;
mod deforming;
pub mod effect;
pub mod effect_file;
mod files;
mod forward;
mod geometry;
mod hiding;
mod lens_test;
mod library;
mod lining;
mod masks;
mod module;
mod module_name;
mod names;
mod plan;
mod regions;
mod sections;
mod shading;
mod sorting;
mod specialised;
mod template;
mod translucent;
mod uber;
pub mod wgsl;

pub use carried::LEAST_CARRIED;
pub use deforming::{DEFORMER_NUMBERS, DeformPlan, PlanControl, PlanDeformer, PlanStep, STEP_NUMBERS};
pub use effect::{EffectDefinition, EffectKind, Mode, PerObject, effects, handlers};
pub use forward::{Forward, ForwardKind};
pub use module::Module;
pub use plan::{
    Blend, BodyKind, ClassTest, Clip, MOST_CITIES, Plan, PlanBody, PlanBorder, PlanContent, PlanLens, Program, Scope,
    Step, Uber, VolumeTest,
};
pub use regions::Regions;
pub use specialised::scope_number;
pub use uber::{MOST_SLOTS, MOST_VOLUMES, TILE_PX};

#[cfg(test)]
mod tests;
