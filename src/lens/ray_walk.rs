//! Where the ray of a place of the picture goes, straight piece by straight piece ([`ray_path`](crate::lens::ray_path) says what a plane does to it).

use glam::{DVec2, DVec3};

use crate::lens::{
    own_bend::Seen,
    ray::FisheyeProjection,
    ray_path::{ImageBend, PlaneLens, RayPaths, Rim},
};

/// A line in view space: x right, y up, −z forward; metres from the eye.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ViewLine {
    /// Where it begins.
    pub origin: DVec3,
    /// Where it goes, per unit of its parameter: by one metre along the view axis; of a fisheye by one metre.
    pub direction: DVec3,
}

impl ViewLine {
    /// The place at a parameter.
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin + t * self.direction
    }
}

/// A straight piece of a path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathPiece {
    /// From where to where it goes, of the line's parameter.
    pub range: [f64; 2],
    /// The line that it lies on.
    pub line: ViewLine,
}

/// What happens to a ray at a distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathEvent {
    /// D, metres.
    pub distance: f64,
    /// Which of the planes it is.
    pub plane: usize,
    /// Whether the ray ceases to be bent by it there; otherwise it meets it.
    pub ends: bool,
}

/// What follows the paths of one picture's rays, one after the other.
#[derive(Clone, Debug)]
pub struct RayWalk<'a> {
    paths: &'a RayPaths,
    events: Vec<PathEvent>,
    /// What each plane added to the slope of the ray that is followed.
    bent: Vec<DVec2>,
    pieces: Vec<PathPiece>,
}

impl<'a> RayWalk<'a> {
    /// One along the paths of these lenses.
    pub fn new(paths: &'a RayPaths) -> Self {
        Self { paths, events: paths.events(), bent: vec![DVec2::ZERO; paths.planes.len()], pieces: Vec::new() }
    }

    /// The path of the ray of a place of the picture; at least one piece, the nearest first.
    pub fn pieces(&mut self, across: DVec2) -> &[PathPiece] {
        self.pieces.clear();
        match self.paths.place_shown(across) {
            Seen::Place(place) => self.pass_planes(place),
            Seen::Direction(direction) => {
                let line = ViewLine { origin: DVec3::ZERO, direction };
                self.pieces.push(PathPiece { range: [0.0, f64::INFINITY], line });
            }
        }
        &self.pieces
    }

    fn pass_planes(&mut self, place: DVec2) {
        let Self { paths, events, bent, pieces } = self;
        let (mut origin, mut slope) = if paths.is_parallel { (place, DVec2::ZERO) } else { (DVec2::ZERO, place) };
        let mut from = 0.0;
        bent.fill(DVec2::ZERO);
        for &PathEvent { distance, plane, ends } in events.iter() {
            let lens = &paths.planes[plane];
            let line = ViewLine { origin: origin.extend(0.0), direction: slope.extend(-1.0) };
            pieces.push(PathPiece { range: [from, distance], line });
            from = distance;
            // Changes of the slope, and of where the line begins, so that it goes through the same place.
            let by = if ends { bent[plane] } else { paths.bent(lens, origin + distance * slope) };
            let (by_slope, by_origin) = match (ends, paths.is_parallel) {
                (false, _) => (by, -distance * by),
                (true, true) => (-by, distance * by),
                // The direction in which the eye sees that place.
                (true, false) => (-lens.distance / distance * by, lens.distance * by),
            };
            slope += by_slope;
            origin += by_origin;
            bent[plane] = by;
        }
        let line = ViewLine { origin: origin.extend(0.0), direction: slope.extend(-1.0) };
        pieces.push(PathPiece { range: [from, f64::INFINITY], line });
    }
}

impl RayPaths {
    /// What happens along the view axis, nearest first.
    pub fn events(&self) -> Vec<PathEvent> {
        let of = |(plane, lens): (usize, &PlaneLens)| {
            [(lens.distance, false), (lens.until, true)].map(|(distance, ends)| PathEvent { distance, plane, ends })
        };
        let mut events: Vec<PathEvent> = self.planes.iter().enumerate().flat_map(of).collect();
        events.sort_by(|a, b| a.distance.total_cmp(&b.distance).then(a.ends.cmp(&b.ends)));
        events
    }

    /// The path of the ray of a place of the picture, piece by piece; at least one. [`RayWalk`] tells many of them sooner.
    pub fn pieces(&self, across: DVec2) -> Vec<PathPiece> {
        RayWalk::new(self).pieces(across).to_vec()
    }

    /// What the lenses of the picture show at one of its places: another place, or a direction.
    fn place_shown(&self, across: DVec2) -> Seen {
        let mut place = across;
        for lens in &self.images {
            let share = lens.rim.share(place);
            if share >= 1.0 {
                continue;
            }
            match &lens.bend {
                ImageBend::Sampled(radius) => {
                    // Along the way from the middle, whatever the outline.
                    let scale = if share > 0.0 { radius.at(share) / share } else { 0.0 };
                    place = lens.rim.center + scale * (place - lens.rim.center);
                }
                ImageBend::Round(angle, projection) => {
                    return Seen::Direction(self.round(&lens.rim, place, *angle, *projection));
                }
                ImageBend::Own(own) => match own.seen(place, lens.rim.center, lens.rim.radius, self.is_parallel) {
                    Seen::Place(seen) => place = seen,
                    Seen::Direction(direction) => return Seen::Direction(direction),
                },
            }
        }
        Seen::Place(place)
    }

    /// What a plane adds to the slope of a ray that meets it there, metres from the view axis.
    fn bent(&self, lens: &PlaneLens, at: DVec2) -> DVec2 {
        let scale = if self.is_parallel { 1.0 } else { lens.distance };
        let share = lens.rim.share(at / scale);
        if share >= 1.0 {
            return DVec2::ZERO;
        }
        -(1.0 - lens.found_back(share)) * lens.power * (at - scale * lens.rim.center)
    }

    /// The direction of a place of a fisheye, from the eye.
    fn round(&self, rim: &Rim, place: DVec2, angle: f64, projection: FisheyeProjection) -> DVec3 {
        // Parallel rays have no direction to the middle but one.
        let middle = if self.is_parallel { DVec2::ZERO } else { rim.center };
        let forward = middle.extend(-1.0).normalize_or(DVec3::NEG_Z);
        let right = forward.cross(DVec3::Y).normalize_or(DVec3::X);
        let up = right.cross(forward);
        let from = (place - rim.center) / rim.radius;
        let share = from.length();
        let turn = match projection {
            FisheyeProjection::Angular => 0.5 * angle * share,
            FisheyeProjection::Hemispherical => (share * (0.5 * angle).sin()).clamp(-1.0, 1.0).asin(),
        };
        // sin(turn) / share, at 0 its limit.
        let slope = if share > 1e-9 {
            turn.sin() / share
        } else {
            match projection {
                FisheyeProjection::Angular => 0.5 * angle,
                FisheyeProjection::Hemispherical => (0.5 * angle).sin(),
            }
        };
        let direction = turn.cos() * forward + slope * (from.x * right + from.y * up);
        direction.normalize_or(forward)
    }

    /// The line that a path lies on at a parameter.
    pub fn line(&self, across: DVec2, t: f64) -> ViewLine {
        let pieces = self.pieces(across);
        let piece = pieces.iter().find(|piece| t <= piece.range[1]).unwrap_or(&pieces[0]);
        piece.line
    }
}
