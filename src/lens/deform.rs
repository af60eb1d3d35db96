//! Deformation lenses (Trapp §3.6): what their steps mean in the frame of their focus area.

use std::path::{Path, PathBuf};

use glam::{DMat3, DVec2, DVec3};

use crate::{
    geom::{
        Shape,
        deform::{Control, ControlPlane, Deformation, Frame, Opening, Operator, Profile, Space, Texels},
    },
    lens::{handled::Handled, occluders::Occluders},
    shader::effect::{AskedBy, Mode},
};

/// A corridor's half width over the reach of what opens it: all that it moves is in the corridor.
const CORRIDOR_PER_REACH: f64 = 1.5;

/// What a deformation lens does with space: steps one after the other, as strong as its control says.
#[derive(Clone, Debug, PartialEq)]
pub struct Deform {
    /// The first one first.
    pub steps: Vec<Step>,
    /// How strong it is over its focus area seen from above; `None`: as that of its kind has it ([`Deform::default_profile`]).
    pub control: Option<ControlProfile>,
    /// How much of it all, 0 to 1.
    pub strength: f64,
}

/// How strong a deformation is over the base of its focus area: 0 along its border, but for the first.
#[derive(Clone, Debug, PartialEq)]
pub enum ControlProfile {
    /// All of it everywhere, far beyond the focus area, too.
    Everywhere,
    /// Rises from the border, straight, over a part of the sides: 0 to ½.
    Linear {
        /// The part.
        border: f64,
    },
    /// The same, smoothly.
    Smooth {
        /// The part.
        border: f64,
    },
    /// A round hill.
    Bump,
    /// A round wall, between two parts of half a side.
    Ring {
        /// The inner one, ≥ 0.
        inner: f64,
        /// The outer one, up to 1.
        outer: f64,
    },
    /// The lightness of an image; its lower edge is where y begins.
    Image(PathBuf),
}

/// Why steps of city objects do not stand among others.
pub const OBJECTS_ALONE: &str =
    "heights and lower are about city objects: their lens has no shape, and no other kinds of steps";

/// Of a rising border that nobody gave.
pub const BORDER: f64 = 0.25;

/// One step of a deformation. Lengths are metres, angles radians; in the frame of the focus area, whose zero is the middle of its base.
#[derive(Clone, Debug, PartialEq)]
pub enum Step {
    /// Moves.
    Translate {
        /// Along its axes.
        by: DVec3,
    },
    /// Stretches, from the middle of the base.
    Scale {
        /// Along its axes, > 0.
        factors: DVec3,
    },
    /// The higher, the further aside.
    Shear {
        /// Metres along x and y for each metre of height.
        slope: DVec2,
    },
    /// Gets narrower, or wider, from the base to the top.
    Taper {
        /// At the top, > 0; at the base it is 1.
        factor: f64,
    },
    /// Turns about its vertical axis: not at all at the base, by this at the top.
    Twist {
        /// Counter-clockwise from above.
        angle: f64,
    },
    /// Bends along y, from one end of the focus area to the other, about its middle; both ends rise for angles > 0.
    Bend {
        /// Between both ends.
        angle: f64,
    },
    /// Opens a street: what stands beside the way of a corridor is moved away from it, and lowered.
    OpenStreet {
        /// How wide the street is.
        width: f64,
        /// How far each side is moved away, ≥ 0.
        aside: f64,
        /// How many times as high houses along it are, > 0.
        height: f64,
    },
    /// City objects as many times as high as a number of theirs says; those without it stay.
    Heights {
        /// The attribute that has the number; an object without it takes its parent's.
        attribute: String,
        /// Two numbers, ascending: what is below the first or above the last counts as that.
        from: [f64; 2],
        /// What heights are multiplied with there, > 0; between them as much in between.
        to: [f64; 2],
    },
    /// Makes city objects lower that hide a point of interest, so that they do not.
    Lower {
        /// The occluders.
        of: Box<Occluders>,
        /// What their heights are multiplied with, > 0.
        factor: f64,
    },
    /// What a user's handler does.
    Map(Handled),
    /// Raises what is far, as panoramas do; seen from the eye.
    Panorama {
        /// What is nearer stays.
        near: f64,
        /// From here on it goes on straight.
        far: f64,
        /// By how much.
        angle: f64,
    },
}

impl Step {
    /// Whether it changes the heights of city objects.
    pub fn is_of_objects(&self) -> bool {
        matches!(self, Self::Heights { .. } | Self::Lower { .. })
    }

    /// When its handler runs: a user's as its header says, the program's always.
    fn mode(&self) -> Mode {
        match self {
            Self::Map(used) => used.definition(AskedBy::Steps).map_or(Mode::Local, |handler| handler.mode),
            _ => Mode::Local,
        }
    }
}

/// The eye, as camera deformations are about it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Viewer {
    /// Where it is, metres.
    pub eye: DVec3,
    /// Where it looks.
    pub forward: DVec3,
    /// The height of the ground, metres.
    pub ground: f64,
}

impl Deform {
    /// How strong it is where nobody says so: in round focus areas a bump, else a plateau with smooth borders.
    pub fn default_profile(area: &Shape) -> ControlProfile {
        match area {
            Shape::Cylinder { .. } | Shape::Sphere { .. } => ControlProfile::Bump,
            _ => ControlProfile::Smooth { border: BORDER },
        }
    }

    /// Whether it is about the eye or about city objects, and needs no focus area.
    pub fn needs_no_area(&self) -> bool {
        self.is_of_objects() || self.steps.iter().any(|step| matches!(step, Step::Panorama { .. }))
    }

    /// Whether it changes the heights of city objects.
    pub fn is_of_objects(&self) -> bool {
        self.steps.iter().any(Step::is_of_objects)
    }

    /// Whether it moves places by a handler that always does: an optional one then has nothing to do.
    pub fn always_moves(&self) -> bool {
        self.steps.iter().any(|step| !step.is_of_objects() && step.mode() == Mode::Local)
    }

    /// What of it runs: handlers that are never run are left out, and optional ones where `others` of the scene do something.
    #[must_use]
    pub fn running(&self, others: bool) -> Self {
        let runs = |step: &&Step| match step.mode() {
            Mode::Ignore => false,
            Mode::Optional => !others,
            Mode::Local | Mode::Global => true,
        };
        Self { steps: self.steps.iter().filter(runs).cloned().collect(), ..self.clone() }
    }

    /// The occluders that it makes lower; of several steps, the first ones.
    pub fn occluders(&self) -> Option<&Occluders> {
        self.steps.iter().find_map(|step| if let Step::Lower { of, .. } = step { Some(&**of) } else { None })
    }

    /// What it is in the world; `area`: its focus area there; `image`: the texels of its control's image.
    ///
    /// # Errors
    /// Steps that its focus area has no meaning for.
    pub fn deformation(
        &self,
        area: Option<&Shape>,
        viewer: &Viewer,
        image: impl FnOnce(&Path) -> Result<Texels, String>,
    ) -> Result<Deformation, String> {
        let made = match area {
            None => self.of_viewer(viewer)?,
            Some(Shape::Corridor { points, width, .. }) => self.along(points, *width)?,
            Some(area) => self.over(area, image)?,
        };
        Ok(made.at_strength(self.strength))
    }

    fn of_viewer(&self, viewer: &Viewer) -> Result<Deformation, String> {
        let chain: Option<Vec<Operator>> = self
            .steps
            .iter()
            .map(|step| match step {
                Step::Panorama { near, far, angle } => {
                    Some(Operator::panorama(*near, *far, *angle, viewer.eye.z - viewer.ground))
                }
                _ => None,
            })
            .collect();
        let chain = chain.ok_or("a deformation without a shape is a panorama; other steps need a shape")?;
        // Straight down there is no horizon: north is up then.
        let frame = Frame::upright(viewer.eye, viewer.forward).or_else(|| Frame::upright(viewer.eye, DVec3::Y));
        let frame = frame.ok_or("the eye is nowhere")?;
        Ok(Deformation { frame, space: Space::World, chain, control: Control::Everywhere })
    }

    fn along(&self, points: &[DVec3], corridor: f64) -> Result<Deformation, String> {
        let Some(first) = points.first() else { return Err("a corridor needs points".into()) };
        let line: Vec<DVec2> = points.iter().map(|p| (*p - *first).truncate()).collect();
        let reach = 0.5 * corridor / CORRIDOR_PER_REACH;
        let open = |step: &Step| match *step {
            Step::OpenStreet { width, aside, height } => {
                if 0.5 * width >= reach {
                    let least = CORRIDOR_PER_REACH * width;
                    return Err(format!("a street {width} m wide is opened in a corridor wider than {least} m"));
                }
                let line = line.clone();
                Ok(Operator::Open(Opening { line, half_width: 0.5 * width, reach, aside, height, base: 0.0 }))
            }
            _ => {
                Err("along a corridor streets are opened (open-street); other steps need a box, a cylinder or a sphere"
                    .into())
            }
        };
        let chain = self.steps.iter().map(open).collect::<Result<_, String>>()?;
        let frame = Frame { pivot: *first, axes: DMat3::IDENTITY };
        Ok(Deformation { frame, space: Space::World, chain, control: Control::Everywhere })
    }

    fn over(&self, area: &Shape, image: impl FnOnce(&Path) -> Result<Texels, String>) -> Result<Deformation, String> {
        let (middle, axes, size) = match area {
            Shape::Box { center, size, rotation } => (*center, DMat3::from_quat(*rotation), *size),
            Shape::Cylinder { center, radius, height, axis } => {
                let rotation = glam::DQuat::from_rotation_arc(DVec3::Z, axis.try_normalize().unwrap_or(DVec3::Z));
                (*center, DMat3::from_quat(rotation), DVec3::new(2.0 * radius, 2.0 * radius, *height))
            }
            Shape::Sphere { center, radius } => (*center, DMat3::IDENTITY, DVec3::splat(2.0 * radius)),
            _ => return Err("a deformation is given over a box, a cylinder, a sphere or a corridor".into()),
        };
        if size.min_element() <= 0.0 {
            return Err("the focus area of a deformation needs width, depth and height".into());
        }
        let pivot = middle - axes * DVec3::new(0.0, 0.0, 0.5 * size.z);
        let z = [0.0, size.z];
        let operator = |step: &Step| {
            Ok(match step {
                Step::Translate { by } => Operator::Translate(*by),
                Step::Scale { factors } => Operator::Scale { factors: *factors, about: DVec3::ZERO },
                Step::Shear { slope } => Operator::Shear { slope: *slope, base: 0.0 },
                Step::Taper { factor } => Operator::Taper { z, factors: [1.0, *factor] },
                Step::Twist { angle } => Operator::Twist { z, angles: [0.0, *angle] },
                Step::Bend { angle } => Operator::Bend {
                    curvature: angle / size.y,
                    y: [-0.5 * size.y, 0.5 * size.y],
                    about: 0.0,
                    base: 0.0,
                },
                Step::Map(used) => Operator::Map(used.map(size)?),
                Step::OpenStreet { .. } => return Err("open-street needs a corridor as its shape".to_owned()),
                Step::Panorama { .. } => return Err("panorama is about the eye: it has no shape".to_owned()),
                Step::Heights { .. } | Step::Lower { .. } => return Err(OBJECTS_ALONE.to_owned()),
            })
        };
        let chain = self.steps.iter().map(operator).collect::<Result<_, String>>()?;
        let own = self.control.clone().unwrap_or_else(|| Self::default_profile(area));
        let profile = match &own {
            ControlProfile::Everywhere => {
                let frame = Frame { pivot, axes };
                return Ok(Deformation { frame, space: Space::World, chain, control: Control::Everywhere });
            }
            ControlProfile::Linear { border } => Profile::Linear { border: *border },
            ControlProfile::Smooth { border } => Profile::Smooth { border: *border },
            ControlProfile::Bump => Profile::Bump,
            ControlProfile::Ring { inner, outer } => Profile::Ring { inner: *inner, outer: *outer },
            ControlProfile::Image(file) => Profile::Texels(image(file)?),
        };
        let size = size.truncate();
        let plane = ControlPlane { corner: (-0.5 * size).extend(0.0), size, profile, band: None };
        Ok(Deformation { frame: Frame { pivot, axes }, space: Space::World, chain, control: Control::Plane(plane) })
    }
}
