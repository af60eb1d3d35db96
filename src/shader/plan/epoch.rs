//! Time operators of lenses: which moment shows where.

/// A time operator of a lens of a plan, which acts on what is inside the lens.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct PlanEpoch {
    /// Index into [`crate::shader::Plan::lenses`].
    pub lens: u32,
    /// Index into [`crate::shader::effect::handlers`].
    pub handler: u32,
    /// Where its words begin among the object values.
    pub words: u32,
    /// The bit of its lens in what is known of objects: whether it may hold some of one.
    pub bit: u32,
}
