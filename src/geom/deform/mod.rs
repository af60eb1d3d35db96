//! Deformation lenses (Trapp §3.6): what moves places, how much, and what the surfaces there become.
//!
//! A [`Deformation`] is plain data: a rigid frame T (pivot; axes A, B, N), operators that are applied one after the other (g), and a
//! control κ that says how much of it each place gets. In the frame of the lens
//!
//! ```text
//!   θ(x) = x + κ(x)·(g(x) − x)        J = I + κ·(J_g − I) + (g(x) − x) ⊗ ∇κ        n' = normalise(cof(J)·n)
//! ```
//!
//! A [`Deformer`] is one made ready for use, and [`Deformers`] are several, bottom first. All is f64. Whether a deformation folds
//! space is proven or refuted with intervals ([`Deformer::prove`]); what folds is used at a strength at which it does not
//! ([`Deformation::safe_strength`]). [`refine`] makes meshes fine enough to follow it.
//!
//! Two limits of the formula itself: κ between 0 and 1 mixes a place with where it is taken in a straight line, so a half turn (a
//! twist by π under a κ that passes ½) sends places through the axis, and folds; and det J > 0 keeps neighbours apart, not what
//! comes round from far away (a bend by more than one turn).

mod certificate;
mod control;
mod deformer;
mod interval;
mod inverse;
mod map;
mod number;
mod opening;
mod operator;
pub mod refine;
#[cfg(test)]
pub(crate) mod tests;

use glam::{DMat3, DVec3};

pub use certificate::{CLEAR, Proof, Strength};
pub use control::{Band, Control, ControlPlane, Profile, Texels};
pub use deformer::{Deformer, Deformers, Support};
pub use interval::Interval;
pub use map::{Map, Mapped};
pub use opening::Opening;
pub use operator::Operator;

/// A rigid frame: a pivot and three axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Where its zero is, metres.
    pub pivot: DVec3,
    /// A, B, N = A × B as columns, orthonormal.
    pub axes: DMat3,
}

impl Frame {
    /// The frame of the world.
    pub const WORLD: Self = Self { pivot: DVec3::ZERO, axes: DMat3::IDENTITY };

    /// A frame with A along `a` and B beside it, towards `b`; `None` where they are (nearly) parallel or not finite.
    pub fn new(pivot: DVec3, a: DVec3, b: DVec3) -> Option<Self> {
        let a = a.try_normalize()?;
        let n = a.cross(b.try_normalize()?);
        let n = n.try_normalize().filter(|_| n.length() > 1e-9)?;
        pivot.is_finite().then_some(Self { pivot, axes: DMat3::from_cols(a, n.cross(a), n) })
    }

    /// A frame that stands upright at `pivot`: B level along `forward`, A to its right, N up. `None` for a forward straight up or down.
    pub fn upright(pivot: DVec3, forward: DVec3) -> Option<Self> {
        Self::new(pivot, DVec3::new(forward.y, -forward.x, 0.0), DVec3::new(forward.x, forward.y, 0.0))
    }

    /// A place of the world, in this frame.
    pub fn from_world(&self, place: DVec3) -> DVec3 {
        self.axes.transpose() * (place - self.pivot)
    }

    /// A place of this frame, in the world.
    pub fn to_world(&self, place: DVec3) -> DVec3 {
        self.pivot + self.axes * place
    }

    /// `inner`, which is given in this frame, in the world.
    #[must_use]
    pub fn then(&self, inner: &Self) -> Self {
        Self { pivot: self.to_world(inner.pivot), axes: self.axes * inner.axes }
    }
}

/// What a frame is given in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Space {
    /// The world.
    #[default]
    World,
    /// The frame of the camera, which the deformation then follows.
    Camera,
}

/// A deformation as a scene has it; see the module.
#[derive(Clone, Debug, PartialEq)]
pub struct Deformation {
    /// T; its pivot is the zero of operators and control.
    pub frame: Frame,
    /// What the frame is given in.
    pub space: Space,
    /// g: applied one after the other, the first one first. None: nothing moves.
    pub chain: Vec<Operator>,
    /// κ.
    pub control: Control,
}

/// Why a deformation may not be used at any strength.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct Fault(pub &'static str);

impl Deformation {
    /// The same in the world, for a camera with this frame there.
    #[must_use]
    pub fn in_world(&self, camera: &Frame) -> Self {
        match self.space {
            Space::World => self.clone(),
            Space::Camera => Self { frame: camera.then(&self.frame), space: Space::World, ..self.clone() },
        }
    }

    /// The same with a part of its strength in 0..=1: every operator at it ([`Operator::at_strength`]).
    #[must_use]
    pub fn at_strength(&self, strength: f64) -> Self {
        let chain = self.chain.iter().map(|operator| operator.at_strength(strength)).collect();
        Self { chain, ..self.clone() }
    }

    /// Whether its numbers can be used.
    pub fn check(&self) -> Result<(), Fault> {
        let Frame { pivot, axes } = self.frame;
        let turned = axes * axes.transpose() - DMat3::IDENTITY;
        let is_rigid = turned.to_cols_array().iter().all(|d| d.abs() < 1e-9) && axes.determinant() > 0.0;
        let frame = (!is_rigid || !pivot.is_finite()).then_some("the frame is not rigid");
        let chain = || self.chain.iter().find_map(Operator::fault);
        frame.or_else(chain).or_else(|| self.control.fault()).map_or(Ok(()), |words| Err(Fault(words)))
    }
}

/// The cofactor matrix of a Jacobian with columns a, b, c: b × c, c × a, a × b. A surface normal n becomes normalise(cof·n), whatever the
/// size of the determinant.
pub fn cofactor(jacobian: &DMat3) -> DMat3 {
    let [a, b, c] = [jacobian.x_axis, jacobian.y_axis, jacobian.z_axis];
    DMat3::from_cols(b.cross(c), c.cross(a), a.cross(b))
}

/// Rows as glam's columns.
fn matrix(rows: &number::Matrix<f64>) -> DMat3 {
    DMat3::from_cols_array_2d(rows).transpose()
}
