//! What lenses are fixed to.

/// What the shapes of a lens are fixed to, whose origin and axes their coordinates are of; metres.
#[derive(Clone, Debug, PartialEq, Eq, Default)]
pub enum Placement {
    /// The world: model coordinates.
    #[default]
    World,
    /// The world, with heights that are metres above the ground at each place: `Scene::on_ground` makes it [`Self::World`].
    AboveGround,
    /// A city object, by its id: the middle of the axis-aligned box around the geometries of all its levels of detail and those
    /// of all its parts; the world's axes.
    Object(String),
    /// A point of interest, by its name: its point, or its object as above; the world's axes.
    Poi(String),
    /// The camera: the eye; x to the right of the picture, y to its top, z out of it to whoever looks.
    Camera,
}
