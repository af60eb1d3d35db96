//! wgpu, and nothing that knows a city: the device, counted allocations and uploads, read-back, timers.

mod device;
mod readback;
mod snapping;
mod timer;

pub use device::{Gpu, GpuError};
pub use timer::{PassMeasure, Slot, Timer};
