//! Methods of laying translucent layers one over the other that are not exact or not fast, for comparison and for small GPUs
//! ([`crate::scene::Transparency`]): the same fragments, classes, opacities and shading as the exact one ([`super::layers`]).
//!
//! ```text
//! k-buffer    slots: depths, codes, rest    the nearest layers of each pixel, whatever the draw order; then as lists
//!             composite
//! peel        the same, again and again with what is behind
//! weighted    composite of no slot at all, and of all layers as the tail that a K-buffer has
//! stochastic  chance    layers that are there by chance, into the targets of what is opaque
//! ```

pub mod fragments;
pub mod slots;
pub mod stochastic;
