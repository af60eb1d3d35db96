//! Region tests of users in the world: what their handlers say, contained in a box.

use std::sync::Arc;

use glam::{DQuat, DVec3};

use crate::{
    geom::{
        Aabb, Ray, Volume,
        shape::{Motion, OrientedBox},
    },
    lens::handled::Handled,
    shader::{
        effect::{AskedBy, number_of},
        host::HostProgram,
    },
};

/// A user's region, placed.
#[derive(Clone, Debug)]
pub struct OwnRegion {
    /// The number of its handler.
    pub handler: u32,
    /// Its middle, metres.
    pub center: DVec3,
    /// Half its edges, metres, ≥ 0.
    pub half: DVec3,
    /// Turns its axes into the world's.
    pub rotation: DQuat,
    /// Its parameters as the GPU reads them.
    pub parameters: Vec<f32>,
    program: Arc<HostProgram>,
}

/// Steps along a ray, at most, and how near its ends are found, in longest half edges.
const STEPS: usize = 4096;
const EXACT: f64 = 1e-7;

impl OwnRegion {
    /// A region over a box of these full edges, metres, moved.
    ///
    /// # Errors
    /// There is no region test of this name.
    pub fn new(used: &Handled, center: DVec3, size: DVec3, rotation: DQuat, motion: &Motion) -> Result<Self, String> {
        let definition = used.definition(AskedBy::Shapes)?;
        let (Some(program), Some(handler)) = (definition.host.clone(), number_of(&used.handler)) else {
            return Err("it does not run on the host".into());
        };
        Ok(Self {
            handler,
            center: motion.point(center),
            half: 0.5 * size,
            rotation: (motion.rotation * rotation).normalize(),
            parameters: used.floats(definition),
            program,
        })
    }

    /// Whether its box holds nothing.
    pub fn is_empty(&self) -> bool {
        self.half.min_element() <= 0.0
    }

    /// Its box.
    fn around(&self) -> Volume {
        Volume::Box(OrientedBox { center: self.center, size: 2.0 * self.half, rotation: self.rotation })
    }

    /// The box along the world's axes around its own, metres.
    pub fn bounds(&self) -> Aabb {
        self.around().bounds()
    }

    /// How far a place is from it at least, metres; negative inside. What is no number is outside.
    pub fn distance(&self, place: DVec3) -> f64 {
        let own = self.rotation.conjugate() * (place - self.center);
        let said = self.program.number(own, 2.0 * self.half, &self.parameters).map(|(distance, _)| distance);
        let said = said.filter(|distance| distance.abs() <= 3e38).unwrap_or(3e38);
        said.max(self.around().signed_distance(place))
    }

    /// Where the line of a ray enters it first and leaves it last; `None`: it misses.
    pub fn entry_exit(&self, ray: &Ray) -> Option<(f64, f64)> {
        let (low, high) = self.around().entry_exit(ray)?;
        let (exact, speed) = (EXACT * self.half.max_element(), ray.direction.length());
        let end = |from: f64, way: f64| {
            let mut at = from;
            for _ in 0..STEPS {
                let free = self.distance(ray.at(at));
                if free <= exact {
                    return Some(at);
                }
                at += way * free / speed;
            }
            None
        };
        let (entry, exit) = (end(low, 1.0)?, end(high, -1.0)?);
        (entry < exit).then_some((entry, exit))
    }
}
