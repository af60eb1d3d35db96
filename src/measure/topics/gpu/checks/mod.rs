//! The hard cases that depend on the adapter, one file and one row each.

mod compositing;
mod coplanar;
mod everywhere;
mod grazing;
mod identity;
mod jitter;
mod layer_room;
mod layers;
mod lens_faces;
mod many_lenses;
mod national;
mod near_plane;
mod repeats;
mod seams;
mod solids;
mod sprites;
mod walls;

use crate::measure::topics::gpu::check::Check;

/// All of them, in the order in which they are run.
pub const CHECKS: &[Check] = &[
    coplanar::CHECK,
    walls::CHECK,
    layers::CHECK,
    compositing::CHECK,
    layer_room::CHECK,
    repeats::CHECK,
    national::CHECK,
    jitter::CHECK,
    sprites::CHECK,
    many_lenses::CHECK,
    identity::CHECK,
    everywhere::CHECK,
    near_plane::CHECK,
    grazing::CHECK,
    lens_faces::CHECK,
    solids::CHECK,
    seams::CHECK,
];
