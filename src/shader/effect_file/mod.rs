//! Effect files (after Tiesel §3): WGSL with a header of TOML in `//!` lines.
//!
//! ```wgsl
//! //! name = "posterise"
//! //! kind = "post"
//! //! spec = "Trapp §3.5"
//! //! doc = "Few steps of lightness instead of many."
//! //!
//! //! [[parameter]]
//! //! name = "steps"
//! //! type = "number"
//! //! range = [2, 16]
//! //! default = 4
//! //! doc = "How many."
//!
//! fn effect(color: vec3f, point: Point, p: Parameters) -> vec3f {
//!     return floor(color * p.steps) / p.steps;
//! }
//! ```
//!
//! `effect` gets the colour so far (linear light), the shown surface and its parameters, and returns the new colour.
//! Without parameters for WGSL it takes no `p`. The file may declare functions, constants, structs and aliases of its own:
//! every name it declares is qualified by the effect's, so that files never clash.

pub(super) mod bounds;
pub(super) mod check;
pub(super) mod cost;
pub(super) mod error;
pub(super) mod flow;
pub(super) mod header;
pub(super) mod parameters;
pub(super) mod read;
pub(super) mod redefined;

pub use check::checked;
pub use error::FileError;
pub use header::{MOST_LINE_WIDTH, MOST_REACH, RESERVED, RESERVED_OF_TIME};
pub use redefined::redefined;

#[cfg(test)]
mod tests;
