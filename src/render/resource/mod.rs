//! What passes are made of on the GPU: formats, bind groups, pipelines, targets, buffers that follow a scene, and the
//! recording of passes. Nothing here knows a scene, a lens or a city.

pub mod bindings;
pub mod formats;
pub mod key;
pub mod layouts;
pub mod pipeline;
pub mod pipelines;
pub mod recording;
pub mod synced;
pub mod targets;
pub mod vertices;
pub mod worker;
