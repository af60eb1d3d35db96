//! The eye: cameras, how they project, where to look from at first, and paths over time.
//!
//! ```text
//!            up                        pixel (0,0) at the top left, centres at +½
//!            │   forward               ndc   x right, y up, -1..1
//!            │  ╱                      depth λ = near/D: 1 at the near plane, 0 at infinity
//!            │ ╱                       D     metres along `forward` from the eye
//!  eye ──────┴────── right
//! ```

pub mod basis;
pub mod camera;
pub mod first;
pub mod framing;
pub mod frustum;
pub mod jitter;
pub mod local;
pub mod navigate;
pub mod path;
pub mod project;

pub use basis::Basis;
pub use camera::{Camera, CameraError, MAX_FOV, MAX_SIZE, MIN_FOV, Projection, default_near_m};
pub use first::first_view;
pub use framing::{Field, Framing, FramingError};
pub use frustum::{Frustum, HalfSpace};
pub use jitter::jitter_px;
pub use project::View;
