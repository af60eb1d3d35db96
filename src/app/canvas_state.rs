//! State of the canvas that stays between frames.

use std::{sync::Arc, time::Instant};

use eframe::egui::{Mesh, Pos2, Rect, TextureHandle, Vec2};
use glam::DVec3;

use crate::{
    app::gizmo::places::GizmoKind,
    city::way::Stop,
    lens::Region,
    view::{Camera, navigate::Flight},
};

/// The effect of a drag.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Drag {
    Orbit {
        pivot: DVec3,
    },
    Pan {
        at: DVec3,
    },
    Look,
    /// A gizmo of the chosen lens.
    Gizmo(Box<Grip>),
    /// An overlay: what is held of it is so far from its middle.
    Overlay {
        lens: usize,
        off: Vec2,
    },
    /// A gizmo of a lens that bends rays: what is held of it is so far from it.
    Ray {
        lens: usize,
        kind: GizmoKind,
        off: Vec2,
    },
    /// An object along its way: through time.
    Along(Arc<Held>),
}

/// A place of an object that moves, held by the pointer.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Held {
    /// The way of that place.
    pub(super) way: Vec<Stop>,
    /// How much later than the scene it shows there, microseconds.
    pub(super) later: i64,
}

/// The state of the picture in the window.
#[derive(Default)]
pub struct Canvas {
    pub(super) texture: Option<TextureHandle>,
    pub(super) rect: Option<Rect>,
    pub(super) drag: Option<Drag>,
    pub(super) flight: Option<(Flight, Instant)>,
    pub(super) last_step: Option<Instant>,
    /// Whether the eye moved in the last frames: pictures are to be quick until it rests.
    pub(super) moved_at: Option<Instant>,
    pub(super) hovered: Option<Hovered>,
    /// The next move is down to the ground.
    pub(super) step_down: bool,
    pub(super) outlines: Option<Outlines>,
    /// The first view of what is open.
    pub(super) home: Option<Camera>,
}

/// The thing under the pointer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hovered {
    /// The object, by index; `None`: the plain ground, or a part that no object has.
    pub object: Option<u32>,
    /// Where it is, metres.
    pub at: DVec3,
}

/// The outlines of the last picture.
#[derive(Clone, Debug)]
pub(super) struct Outlines {
    pub(super) mesh: Arc<Mesh>,
    pub(super) objects: [Option<u32>; 2],
    pub(super) rect: Rect,
}

/// Something of a lens that can be held, and where it is in the window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Gizmo {
    /// The lens, by its place.
    pub lens: usize,
    /// Which of its shapes.
    pub shape: usize,
    /// The kind of gizmo there.
    pub kind: GizmoKind,
    /// Where it is, model coordinates.
    pub(super) place: DVec3,
    /// Where it is shown.
    pub at: Pos2,
}

/// A gizmo that is being dragged: everything is worked out from how the lens was at first, so that nothing drifts.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Grip {
    pub(super) gizmo: Gizmo,
    /// From the gizmo to what was pressed.
    pub(super) off: Vec2,
    pub(super) before: Region,
    /// Where the middle was, model coordinates.
    pub(super) middle: DVec3,
}
