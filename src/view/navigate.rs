//! Moving a camera about: what a hand at a window does to it, as pure functions from camera to camera.
//!
//! ```text
//!   north (+y)                 heading  radians clockwise from north, of the view direction
//!      │  ╱ view direction     pitch    radians above the horizon, −90°..=90°
//!      │ ╱ heading             turn     x added to the heading, y to the pitch
//!      │╱
//!      └────── east (+x)
//! ```
//!
//! Whatever is asked for, the answer is a camera that passes [`Camera::check`] or the one that was given: numbers that
//! are not finite, a factor that is not positive or an empty box change nothing. A near plane that is the default one
//! of its camera's distance ([`default_near_m`]) becomes that of the new distance; any other is kept.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use glam::{DVec2, DVec3};

use crate::{
    geom::Aabb,
    view::{
        basis::Basis,
        camera::{Camera, MAX_FOV, MIN_FOV, Projection, default_near_m},
        project::View,
    },
};

/// Steepest pitch that turning leads to, radians (89.5°): beyond it a heading is hard to tell.
pub const MAX_PITCH: f64 = 89.5 * PI / 180.0;
/// Nearest that [`zoom`] brings an eye to what it looks at, metres.
pub const MIN_DISTANCE_M: f64 = 0.2;
/// Farthest that [`zoom`] takes an eye from what it looks at, metres.
pub const MAX_DISTANCE_M: f64 = 1e7;
/// Least and greatest height of an orthographic picture, metres: those of [`Camera::check`].
const HEIGHTS_M: (f64, f64) = (1e-3, 1e7);
/// The distance of the target after a descent to the ground, metres.
const LANDED_M: f64 = 30.0;
/// Part of the picture's half width and height that a framed box may fill: a margin of 3 % of the picture on each side.
const FILL: f64 = 0.94;
/// The pitch half way along a flight that rises, radians above the horizon (−40°), unless its ends look down
/// farther.
const FLIGHT_PITCH: f64 = -40.0 * PI / 180.0;
/// Shortest and longest time of a flight, seconds.
const FLIGHT_S: (f64, f64) = (0.25, 1.2);

/// Turns the camera about `pivot`: `turn.x` radians about the vertical, clockwise seen from above, and `turn.y` radians
/// about the camera's right axis, upwards for the view (so that the eye sinks).
///
/// `pivot` keeps its pixel. The picture has no roll afterwards, and no pitch beyond [`MAX_PITCH`]: the part of the turn
/// that would pass it is dropped. A camera that looks straight down has the heading of the top of its picture.
pub fn orbit(camera: &Camera, pivot: DVec3, turn: DVec2) -> Camera {
    let Ok(basis) = camera.basis() else { return *camera };
    if turn == DVec2::ZERO {
        return *camera;
    }
    let look = Look::of(&basis).turned(turn);
    let turned = look.basis();
    // On the turned axes the eye is where it was on the old ones, seen from the pivot: so the pivot keeps its pixel.
    let from_pivot = camera.eye - pivot;
    let eye = pivot
        + from_pivot.dot(basis.right) * turned.right
        + from_pivot.dot(basis.up) * turned.up
        + from_pivot.dot(basis.forward) * turned.forward;
    let target = eye + camera.eye.distance(camera.target) * turned.forward;
    settled(camera, Camera { eye, target, up: look.up(), ..*camera })
}

/// Turns the camera about its eye, as a head is turned; `turn` and its limits are those of [`orbit`].
pub fn look_around(camera: &Camera, turn: DVec2) -> Camera {
    orbit(camera, camera.eye, turn)
}

/// Moves the camera parallel to its picture so that the world point `at`, seen at `from_px`, is seen at `to_px`; pixels
/// as of [`View::pixel`]. A point that is not before a perspective eye moves nothing.
pub fn pan(view: &View, at: DVec3, from_px: DVec2, to_px: DVec2) -> Camera {
    let camera = &view.camera;
    let depth = view.depth(at);
    if !view.is_orthographic() && depth <= 0.0 {
        return *camera;
    }
    let dragged = view.pixel_m(depth) * (to_px - from_px);
    // The world follows the hand, so the camera goes the other way; rows of pixels go down.
    moved(camera, dragged.y * view.basis.up - dragged.x * view.basis.right)
}

/// Goes nearer to `at` (`factor` below 1) or farther from it (above 1); `at` keeps its pixel, the view its direction.
///
/// In perspective the distances of eye and target to `at` are multiplied by `factor`, between [`MIN_DISTANCE_M`] and
/// [`MAX_DISTANCE_M`] for the eye. In an orthographic view the height of the picture is, between 1 mm and 10,000 km,
/// and the eye moves aside; where the picture becomes higher than the target is away, the eye also draws back to that
/// distance, or the near plane would cut the ground at the bottom of the picture.
pub fn zoom(camera: &Camera, at: DVec3, factor: f64) -> Camera {
    let Ok(basis) = camera.basis() else { return *camera };
    if !(factor > 0.0 && factor.is_finite()) {
        return *camera;
    }
    let distance = camera.eye.distance(camera.target);
    match camera.projection {
        Projection::Perspective { .. } => {
            let away = camera.eye.distance(at);
            if away <= 0.0 {
                return *camera;
            }
            // An eye that is nearer than the nearest or farther than the farthest may stay, but not go on.
            let factor = factor.max((MIN_DISTANCE_M / away).min(1.0)).min((MAX_DISTANCE_M / away).max(1.0));
            let eye = at + factor * (camera.eye - at);
            let target = eye + (factor * distance).max(MIN_DISTANCE_M) * basis.forward;
            settled(camera, Camera { eye, target, ..*camera })
        }
        Projection::Orthographic { height_m } => {
            let higher = (height_m * factor).clamp(HEIGHTS_M.0, HEIGHTS_M.1);
            let to_at = at - camera.eye;
            let across = to_at - to_at.dot(basis.forward) * basis.forward;
            let aside = (1.0 - higher / height_m) * across;
            let back = if higher > height_m { (higher - distance).max(0.0) } else { 0.0 };
            let eye = camera.eye + aside - back * basis.forward;
            let projection = Projection::Orthographic { height_m: higher };
            settled(camera, Camera { eye, target: camera.target + aside, projection, ..*camera })
        }
    }
}

/// Moves the camera by `steps` metres to the right, forward and up, without turning it.
///
/// With `level`, right and forward are horizontal and up is vertical, as on foot; a camera that looks straight down
/// goes forward to the top of its picture. Otherwise they are the camera's own axes.
pub fn travel(camera: &Camera, steps: DVec3, level: bool) -> Camera {
    let Ok(basis) = camera.basis() else { return *camera };
    let axes = if level { Look { pitch: 0.0, ..Look::of(&basis) }.basis() } else { basis };
    moved(camera, steps.x * axes.right + steps.y * axes.forward + steps.z * axes.up)
}

/// Walks `steps` metres to the right and forward: [`travel`]s level, then has the eye `eye_height_m` above the ground
/// there.
///
/// `ground` gives the height (z, metres) of the ground below a place (x, y); where it has none, the eye keeps its
/// height.
pub fn walk(camera: &Camera, steps: DVec2, ground: impl FnOnce(DVec2) -> Option<f64>, eye_height_m: f64) -> Camera {
    let there = travel(camera, steps.extend(0.0), true);
    match ground(there.eye.truncate()) {
        Some(height) => moved(&there, (height + eye_height_m - there.eye.z) * DVec3::Z),
        None => there,
    }
}

/// The camera with its eye at `eye`, without roll: it looks at `at`, or, where there is none (or it is at the eye, or
/// right above or below it), level where it was headed, at a place 30 m ahead.
pub fn landed(camera: &Camera, eye: DVec3, at: Option<DVec3>) -> Camera {
    let Ok(basis) = camera.basis() else { return *camera };
    let ahead = eye + LANDED_M * Look { pitch: 0.0, ..Look::of(&basis) }.basis().forward;
    let target = at.filter(|at| (*at - eye).truncate().length() >= MIN_DISTANCE_M).unwrap_or(ahead);
    settled(camera, Camera { eye, target, up: DVec3::Z, ..*camera })
}

/// A side to look from, by the compass.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Axis {
    /// From above, straight down; north is at the top of the picture, east on its right.
    Top,
    /// From the north, looking south: north facades, west on the right.
    North,
    /// From the south, looking north: south facades, east on the right.
    South,
    /// From the east, looking west: east facades, north on the right.
    East,
    /// From the west, looking east: west facades, south on the right.
    West,
}

impl Axis {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Top, Self::North, Self::South, Self::East, Self::West];

    /// Direction of view, unit: into the picture.
    pub fn direction(self) -> DVec3 {
        match self {
            Self::Top => DVec3::NEG_Z,
            Self::North => DVec3::NEG_Y,
            Self::South => DVec3::Y,
            Self::East => DVec3::NEG_X,
            Self::West => DVec3::X,
        }
    }

    /// The upward direction of the picture, unit.
    pub fn up(self) -> DVec3 {
        if self == Self::Top { DVec3::Y } else { DVec3::Z }
    }
}

/// Looks at all of `bounds` from a side, in a picture `aspect` times as wide as high; as `camera` projects. See
/// [`framed`].
pub fn axis_view(axis: Axis, bounds: &Aabb, camera: &Camera, aspect: f64) -> Camera {
    fitted(camera, axis.direction(), axis.up(), bounds, aspect)
}

/// Moves the camera, without turning it, so that all of `bounds` is in a picture `aspect` times as wide as high
/// (1e-4..=1e4), with a margin of 3 % of the picture on each side that it touches.
///
/// The target becomes a point at the depth of the middle of `bounds`. A perspective eye goes as near as the corners
/// allow; an orthographic one gets the height that fits and does not come nearer to its target than it was, so that it
/// stays out of what surrounds `bounds`. An empty box, and one without any size, changes nothing.
pub fn framed(camera: &Camera, bounds: &Aabb, aspect: f64) -> Camera {
    let Ok(basis) = camera.basis() else { return *camera };
    fitted(camera, basis.forward, camera.up, bounds, aspect)
}

/// `camera` looking along `forward` (unit) at all of `bounds`.
///
/// On the axes of the eye a point (s, d) fits the width iff |s − eye.s| ≤ tan·(d − eye.d): with A = min(tan·d − s) and
/// B = min(tan·d + s) the deepest eye is at eye.d = (A+B)/(2·tan), eye.s = (B−A)/2. The height likewise.
fn fitted(camera: &Camera, forward: DVec3, up: DVec3, bounds: &Aabb, aspect: f64) -> Camera {
    let size = bounds.size();
    if !(size.is_finite() && size.max_element() > 0.0 && (1e-4..=1e4).contains(&aspect)) {
        return *camera;
    }
    let basis = Basis::looking_along(forward, up);
    let center = bounds.center();
    let corners = bounds.corners().map(|corner| corner - center);
    let reach = |axis: DVec3| corners.iter().fold(0.0, |far: f64, corner| far.max(corner.dot(axis)));
    let half_depth = reach(forward);
    // Nothing of the box may lie before the near plane. Its default is less than this at any distance that this decides.
    let default_m = (half_depth / 500.0).clamp(default_near_m(0.0), 1.0);
    let near_m = if has_default_near(camera) { default_m } else { camera.near_m };
    let nearest = (half_depth + 1.001 * near_m).max(MIN_DISTANCE_M);
    let there = match camera.projection {
        Projection::Perspective { fov_y } => {
            let side = |axis: DVec3, tan: f64| {
                let (mut a, mut b) = (f64::INFINITY, f64::INFINITY);
                for corner in corners {
                    let (s, d) = (corner.dot(axis), corner.dot(forward));
                    a = a.min(d * tan - s);
                    b = b.min(d * tan + s);
                }
                (0.5 * (b - a), 0.5 * (a + b) / tan)
            };
            let tan = FILL * (0.5 * fov_y).tan();
            let (right, deepest_x) = side(basis.right, tan * aspect);
            let (up_m, deepest_y) = side(basis.up, tan);
            let distance = (-deepest_x.min(deepest_y)).max(nearest);
            let target = center + right * basis.right + up_m * basis.up;
            Camera { eye: target - distance * forward, target, up, ..*camera }
        }
        Projection::Orthographic { .. } => {
            let half = reach(basis.up).max(reach(basis.right) / aspect);
            let height_m = (2.0 * half / FILL).clamp(HEIGHTS_M.0, HEIGHTS_M.1);
            let distance = camera.eye.distance(camera.target).max(nearest);
            let projection = Projection::Orthographic { height_m };
            Camera { eye: center - distance * forward, target: center, up, projection, ..*camera }
        }
    };
    settled(camera, there)
}

/// Switches how the camera projects; what is as deep as the target keeps its size in the picture.
///
/// To an orthographic view only the projection changes. To a perspective with the vertical field of view `fov_y`
/// (radians) the eye moves along the view axis, where its distance to the target fits the height of the picture. There
/// and back with the `fov_y` that a perspective camera has is that camera.
pub fn with_projection(camera: &Camera, orthographic: bool, fov_y: f64) -> Camera {
    let Ok(basis) = camera.basis() else { return *camera };
    match camera.projection {
        Projection::Perspective { .. } if orthographic => {
            let height_m = picture_height_m(camera).clamp(HEIGHTS_M.0, HEIGHTS_M.1);
            settled(camera, Camera { projection: Projection::Orthographic { height_m }, ..*camera })
        }
        Projection::Orthographic { height_m } if !orthographic => {
            let distance = 0.5 * height_m / (0.5 * fov_y).tan();
            let eye = camera.target - distance * basis.forward;
            settled(camera, Camera { eye, projection: Projection::Perspective { fov_y }, ..*camera })
        }
        _ => *camera,
    }
}

/// An animated move from one camera to another.
///
/// The target goes in a straight line, the heading the short way round, the distance of the eye by equal factors in
/// equal times: so the eye never swings through the target. Far moves rise in between, as high as *Smooth and efficient
/// zooming and panning* (van Wijk and Nuij 2003) does between two pictures of one size: to a picture about as high as
/// the way is long, and look down on it. The eye is never lower than the lower of both ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flight {
    /// Where it starts.
    pub from: Camera,
    /// Where it ends.
    pub to: Camera,
}

impl Flight {
    /// The camera at `t`, 0..=1: exactly [`Flight::from`] at 0 and before, exactly [`Flight::to`] at 1 and after. It
    /// starts and ends at rest. Between projections of two kinds it keeps the first until it ends, in a picture that
    /// grows to the size of the other. Where one end has no picture ([`Camera::check`]), it stays at `from` until it
    /// ends.
    pub fn at(&self, t: f64) -> Camera {
        let (from, to) = (&self.from, &self.to);
        if t >= 1.0 {
            return *to;
        }
        let (Ok(start), Ok(end)) = (from.basis(), to.basis()) else { return *from };
        if t.is_nan() || t <= 0.0 || from == to {
            return *from;
        }
        let s = t * t * t * (t * (6.0 * t - 15.0) + 10.0);
        let mix = |a: f64, b: f64| (1.0 - s) * a + s * b;
        let mix_factors = |a: f64, b: f64| mix(a.ln(), b.ln()).exp();

        let (first, last) = (Look::of(&start), Look::of(&end));
        let heading = first.heading + s * shorter(last.heading - first.heading);
        let whole_rise = self.rise();
        let (between, pitch) = (4.0 * s * (1.0 - s), mix(first.pitch, last.pitch));
        // A level view would only draw back, not rise.
        let down = (pitch - FLIGHT_PITCH).max(0.0) * between * (1.0 - 1.0 / whole_rise);
        let look = Look { heading, pitch: pitch - down };
        let first_roll = first.roll_of(&start);
        let roll = first_roll + s * shorter(last.roll_of(&end) - first_roll);

        let distances = [from, to].map(|camera| camera.eye.distance(camera.target));
        let rise = whole_rise.powf(between);
        let distance = mix_factors(distances[0], distances[1]) * rise;
        let projection = match (from.projection, to.projection) {
            (Projection::Perspective { fov_y }, Projection::Perspective { fov_y: last }) => {
                Projection::Perspective { fov_y: mix(fov_y, last) }
            }
            (Projection::Perspective { fov_y }, Projection::Orthographic { height_m }) => {
                let last = 2.0 * (0.5 * height_m / distances[1]).atan();
                Projection::Perspective { fov_y: mix(fov_y, last.clamp(MIN_FOV, MAX_FOV)) }
            }
            (Projection::Orthographic { height_m }, _) => {
                let height_m = mix_factors(height_m, picture_height_m(to)) * rise;
                Projection::Orthographic { height_m: height_m.clamp(HEIGHTS_M.0, HEIGHTS_M.1) }
            }
        };

        let basis = look.basis();
        let target = (1.0 - s) * from.target + s * to.target;
        let eye = target - distance * basis.forward;
        let lifted = (from.eye.z.min(to.eye.z) - eye.z).max(0.0) * DVec3::Z;
        // Without roll the up of a level picture, which is the vertical itself.
        let up = if roll.abs() < 1e-9 { look.up() } else { roll.cos() * basis.up + roll.sin() * basis.right };
        let near_m = if has_default_near(from) && has_default_near(to) {
            default_near_m(distance)
        } else {
            mix_factors(from.near_m, to.near_m)
        };
        let there = Camera { eye: eye + lifted, target: target + lifted, up, projection, near_m };
        if there.check().is_ok() { there } else { *from }
    }

    /// The time that it should take, 0.25..=1.2 seconds: the longer, the more the picture changes.
    pub fn duration_s(&self) -> f64 {
        let (Ok(start), Ok(end)) = (self.from.basis(), self.to.basis()) else { return FLIGHT_S.0 };
        let turn = start.forward.angle_between(end.forward).max(start.right.angle_between(end.right)) / FRAC_PI_2;
        let growth = (picture_height_m(&self.to) / picture_height_m(&self.from)).ln().abs();
        let way = self.way().asinh();
        let effort = turn + 0.5 * growth + 0.5 * way;
        let part = 1.0 - (-0.5 * effort).exp();
        if part.is_finite() { FLIGHT_S.0 + (FLIGHT_S.1 - FLIGHT_S.0) * part.clamp(0.0, 1.0) } else { FLIGHT_S.0 }
    }

    /// The way of the target, in heights of the picture (the geometric mean of both).
    fn way(&self) -> f64 {
        let height_m = (picture_height_m(&self.from).ln() * 0.5 + picture_height_m(&self.to).ln() * 0.5).exp();
        self.from.target.distance(self.to.target) / height_m
    }

    /// By which factor the picture grows half way: 1 for moves of up to the height of the picture. Van Wijk and Nuij's
    /// is √(1 + way²) for pictures of one size and their ρ = √2.
    fn rise(&self) -> f64 {
        (self.way() - 1.0).max(0.0).hypot(1.0)
    }
}

/// A direction of view on the compass.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Look {
    /// Clockwise from north, radians.
    heading: f64,
    /// Above the horizon, radians, −π/2..=π/2.
    pitch: f64,
}

impl Look {
    /// That of a camera with these axes. Where they are steeper than turning leads to, the heading is that of the top
    /// of the picture: the direction of view has hardly any.
    fn of(basis: &Basis) -> Self {
        let forward = basis.forward;
        let pitch = forward.z.atan2(forward.truncate().length());
        let ahead = if pitch.abs() <= MAX_PITCH { forward } else { -pitch.signum() * basis.up };
        Self { heading: ahead.x.atan2(ahead.y), pitch }
    }

    /// Turned by `turn`, radians; a pitch beyond [`MAX_PITCH`] may stay or come back, not go on.
    fn turned(self, turn: DVec2) -> Self {
        let (lowest, highest) = (self.pitch.min(-MAX_PITCH), self.pitch.max(MAX_PITCH));
        Self { heading: self.heading + turn.x, pitch: (self.pitch + turn.y).clamp(lowest, highest) }
    }

    /// The axes of an eye that looks there without roll.
    fn basis(self) -> Basis {
        let (sin, cos) = self.heading.sin_cos();
        let (rise, level) = self.pitch.sin_cos();
        let (right, forward) = (DVec3::new(cos, -sin, 0.0), DVec3::new(level * sin, level * cos, rise));
        Basis { right, up: right.cross(forward), forward }
    }

    /// The reference up of a camera that looks there without roll: the vertical, and along it the top of the picture.
    fn up(self) -> DVec3 {
        if self.pitch.abs() <= MAX_PITCH + 1e-9 {
            return DVec3::Z;
        }
        let (sin, cos) = self.heading.sin_cos();
        -self.pitch.signum() * DVec3::new(sin, cos, 0.0)
    }

    /// The turn of axes with this direction of view about it, radians, −π..=π: 0 where up is up.
    fn roll_of(self, basis: &Basis) -> f64 {
        let level = self.basis();
        basis.up.dot(level.right).atan2(basis.up.dot(level.up))
    }
}

/// The same turn the short way round, radians, −π..=π.
fn shorter(turn: f64) -> f64 {
    turn - TAU * (turn / TAU).round()
}

/// Height of the picture at the depth of the target, metres.
fn picture_height_m(camera: &Camera) -> f64 {
    match camera.projection {
        Projection::Perspective { fov_y } => 2.0 * camera.eye.distance(camera.target) * (0.5 * fov_y).tan(),
        Projection::Orthographic { height_m } => height_m,
    }
}

/// Whether the near plane is where a camera that states none has it, up to what rounding of eye and target makes of it.
fn has_default_near(camera: &Camera) -> bool {
    let default = default_near_m(camera.eye.distance(camera.target));
    (camera.near_m - default).abs() <= 1e-6 * default
}

/// `camera` elsewhere, without a turn.
fn moved(camera: &Camera, by: DVec3) -> Camera {
    settled(camera, Camera { eye: camera.eye + by, target: camera.target + by, ..*camera })
}

/// The camera at the end: `there`, with the near plane that belongs there; `camera` itself where either is no camera.
fn settled(camera: &Camera, there: Camera) -> Camera {
    let near_m =
        if has_default_near(camera) { default_near_m(there.eye.distance(there.target)) } else { camera.near_m };
    let there = Camera { near_m, ..there };
    if camera.check().is_ok() && there.check().is_ok() { there } else { *camera }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const NATIONAL: DVec3 = DVec3::new(85_000.0, 447_000.0, 3.0);
    const SIZE: [u32; 2] = [1280, 720];
    const ASPECT: f64 = 1280.0 / 720.0;

    fn view(camera: &Camera) -> View {
        View::new(*camera, SIZE, &Aabb::EMPTY).unwrap()
    }

    /// Where a point is seen, as a part of the picture.
    fn place(camera: &Camera, at: DVec3) -> DVec2 {
        view(camera).pixel(at).expect("before the eye").truncate() / DVec2::new(SIZE[0].into(), SIZE[1].into())
    }

    /// The point at a place in the picture (parts of it) at depth `d`.
    fn seen_at(camera: &Camera, part: [f64; 2], d: f64) -> DVec3 {
        view(camera).ray(DVec2::from(part) * DVec2::new(SIZE[0].into(), SIZE[1].into())).at(d)
    }

    fn looking(eye: DVec3, heading: f64, pitch: f64, distance: f64, projection: Projection) -> Camera {
        let look = Look { heading, pitch };
        let target = eye + distance * look.basis().forward;
        Camera { eye, target, up: look.up(), projection, near_m: default_near_m(distance) }
    }

    fn perspective(fov_degrees: f64) -> Projection {
        Projection::Perspective { fov_y: fov_degrees.to_radians() }
    }

    /// Without roll, up to 80 degrees up or down.
    fn cameras() -> impl Strategy<Value = Camera> {
        let eye = prop::array::uniform3(-500.0..500.0f64).prop_map(|e| NATIONAL + DVec3::from(e));
        (eye, -4.0..4.0f64, -1.4..1.4f64, 10.0..2000.0f64, any::<bool>(), 0.2..1.0f64).prop_map(
            |(eye, heading, pitch, distance, orthographic, scale)| {
                let projection = if orthographic {
                    Projection::Orthographic { height_m: 500.0 * scale }
                } else {
                    perspective(100.0 * scale)
                };
                looking(eye, heading, pitch, distance, projection)
            },
        )
    }

    /// With any up, rolled as it makes them, and with near planes of their own.
    fn rolled_cameras() -> impl Strategy<Value = Camera> {
        (cameras(), prop::array::uniform3(-1.0..1.0f64), 0.001..2.0f64).prop_map(|(camera, up, near_m)| Camera {
            up: DVec3::from(up),
            near_m,
            ..camera
        })
    }

    fn boxes() -> impl Strategy<Value = Aabb> {
        (prop::array::uniform3(-500.0..500.0f64), prop::array::uniform3(0.0..300.0f64)).prop_map(|(min, size)| {
            let min = NATIONAL + DVec3::from(min);
            Aabb { min, max: min + DVec3::from(size) + 0.5 }
        })
    }

    fn angles() -> impl Strategy<Value = DVec2> {
        prop::array::uniform2(-3.0..3.0f64).prop_map(DVec2::from)
    }

    fn parts() -> impl Strategy<Value = [f64; 2]> {
        prop::array::uniform2(0.0..1.0f64)
    }

    fn distance_m(camera: &Camera) -> f64 {
        camera.eye.distance(camera.target)
    }

    /// Greatest distance of a corner from the picture's middle, as a part of its half width or height: 1 on the border.
    fn fill(camera: &Camera, bounds: &Aabb) -> f64 {
        let from_middle = |corner| 2.0 * (place(camera, corner) - 0.5).abs().max_element();
        bounds.corners().into_iter().map(from_middle).fold(0.0, f64::max)
    }

    /// Whether the box fills the picture but for the margin, or less where an eye that is nearer would have it before its near plane.
    fn just_fits(camera: &Camera, bounds: &Aabb) -> bool {
        let nearest =
            bounds.corners().into_iter().map(|corner| view(camera).depth(corner)).fold(f64::INFINITY, f64::min);
        let fill = fill(camera, bounds);
        (fill - FILL).abs() < 1e-6 || (fill < FILL && nearest < 1.03 * camera.near_m)
    }

    #[test]
    fn a_small_box_is_as_near_as_the_near_plane_lets_it() {
        // Half a metre along its diagonal, through a wide lens: the nearest corner is in the middle of the picture, so it is the near plane
        // that keeps the eye away, and no more than that.
        let bounds = Aabb { min: NATIONAL, max: NATIONAL + 0.5 };
        let eye = NATIONAL + DVec3::new(-200.0, -200.0, 200.0);
        let up = DVec3::new(0.3, -0.8, 0.1);
        let camera = Camera { up, ..Camera::looking(eye, eye + DVec3::new(100.0, 100.0, -100.0), 1.74) };
        let there = framed(&camera, &bounds, ASPECT);
        let fill = fill(&there, &bounds);
        assert!(fill < FILL && just_fits(&there, &bounds), "{fill}");
        assert!(bounds.corners().iter().all(|corner| view(&there).depth(*corner) >= there.near_m));
    }

    proptest! {
        #![proptest_config(crate::seeds::config())]

        #[test]
        fn a_pivot_keeps_its_pixel(
            camera in prop_oneof![cameras(), rolled_cameras()], part in parts(), d in 5.0..2000.0f64, turn in angles()
        ) {
            let pivot = seen_at(&camera, part, d);
            let turned = orbit(&camera, pivot, turn);
            prop_assert!(place(&turned, pivot).distance(part.into()) < 1e-6);
            prop_assert!((view(&turned).depth(pivot) - d).abs() < 1e-6);
            prop_assert!((distance_m(&turned) - distance_m(&camera)).abs() < 1e-6);
            prop_assert_eq!(turned.up, DVec3::Z);
            prop_assert!(view(&turned).basis.right.z.abs() < 1e-9, "no roll");
        }

        #[test]
        fn a_turn_and_back_is_no_turn(
            camera in cameras(), part in parts(), d in 5.0..2000.0f64, x in -9.0..9.0f64, to in -1.4..1.4f64
        ) {
            let turn = DVec2::new(x, to - Look::of(&view(&camera).basis).pitch);
            let pivot = seen_at(&camera, part, d);
            let back = orbit(&orbit(&camera, pivot, turn), pivot, -turn);
            let scale = 1.0 + d + distance_m(&camera);
            prop_assert!(back.eye.distance(camera.eye) < 1e-9 * scale, "{}", back.eye - camera.eye);
            prop_assert!(back.target.distance(camera.target) < 1e-9 * scale);
            prop_assert_eq!((back.up, back.projection), (camera.up, camera.projection));
        }

        #[test]
        fn turning_adds_to_heading_and_pitch_up_to_the_limit(camera in cameras(), turn in angles()) {
            let before = Look::of(&view(&camera).basis);
            let turned = look_around(&camera, turn);
            let after = Look::of(&view(&turned).basis);
            prop_assert_eq!(turned.eye, camera.eye);
            prop_assert!((after.pitch - (before.pitch + turn.y).clamp(-MAX_PITCH, MAX_PITCH)).abs() < 1e-9);
            prop_assert!(shorter(after.heading - before.heading - turn.x).abs() < 1e-7);
        }

        #[test]
        fn the_point_held_stays_under_the_hand(
            camera in rolled_cameras(), from in parts(), to in parts(), d in 1.0..2000.0f64
        ) {
            let size = DVec2::new(SIZE[0].into(), SIZE[1].into());
            let at = seen_at(&camera, from, d);
            let panned = pan(&view(&camera), at, DVec2::from(from) * size, DVec2::from(to) * size);
            prop_assert!(place(&panned, at).distance(to.into()) < 1e-6);
            let way = panned.eye - camera.eye;
            prop_assert!(way.dot(view(&camera).basis.forward).abs() < 1e-6, "parallel to the picture");
            prop_assert!(way.distance(panned.target - camera.target) < 1e-9);
            prop_assert_eq!(panned.near_m, if has_default_near(&camera) { panned.near_m } else { camera.near_m });
        }

        #[test]
        fn zooming_keeps_the_pixel_and_the_direction(
            camera in rolled_cameras(), part in parts(), d in 5.0..2000.0f64, factor in 0.001..50.0f64
        ) {
            let at = seen_at(&camera, part, d);
            let zoomed = zoom(&camera, at, factor);
            prop_assert!(place(&zoomed, at).distance(part.into()) < 1e-6, "{} {part:?}", place(&zoomed, at));
            prop_assert!(view(&zoomed).basis.forward.distance(view(&camera).basis.forward) < 1e-7);
            match (camera.projection, zoomed.projection) {
                (Projection::Orthographic { height_m }, Projection::Orthographic { height_m: higher }) => {
                    prop_assert!((higher - height_m * factor).abs() < 1e-9 * higher);
                    let least = if factor > 1.0 { higher } else { 0.0 };
                    prop_assert!((distance_m(&zoomed) - distance_m(&camera).max(least)).abs() < 1e-6);
                }
                (Projection::Perspective { .. }, _) => {
                    let nearer = (factor * camera.eye.distance(at)).max(MIN_DISTANCE_M);
                    prop_assert!((zoomed.eye.distance(at) - nearer).abs() < 1e-8 * (1.0 + nearer));
                    prop_assert_eq!(zoomed.projection, camera.projection);
                }
                _ => prop_assert!(false, "another kind of projection"),
            }
        }

        #[test]
        fn walking_stays_level(
            camera in prop_oneof![cameras(), rolled_cameras()], right in -50.0..50.0f64, forward in -50.0..50.0f64
        ) {
            let walked = travel(&camera, DVec3::new(right, forward, 0.0), true);
            prop_assert_eq!(walked.eye.z, camera.eye.z);
            let way = walked.eye - camera.eye;
            prop_assert!((way.length() - right.hypot(forward)).abs() < 1e-8);
            let ahead = (camera.target - camera.eye).truncate().try_normalize().unwrap();
            prop_assert!((way.truncate().dot(ahead) - forward).abs() < 1e-6, "{way}");
            prop_assert!((way.truncate().dot(DVec2::new(ahead.y, -ahead.x)) - right).abs() < 1e-6);
            let above = walk(&camera, DVec2::new(right, forward), |at| Some(at.x - NATIONAL.x), 1.7);
            prop_assert!((above.eye.z - (walked.eye.x - NATIONAL.x) - 1.7).abs() < 1e-9);
            prop_assert!((above.target - above.eye).distance(camera.target - camera.eye) < 1e-9);
            prop_assert_eq!(walk(&camera, DVec2::new(right, forward), |_| None, 1.7), walked);
        }

        #[test]
        fn travelling_goes_along_the_axes_of_the_camera(
            camera in rolled_cameras(), steps in prop::array::uniform3(-50.0..50.0f64)
        ) {
            let there = travel(&camera, steps.into(), false);
            let (basis, way) = (view(&camera).basis, there.eye - camera.eye);
            let at = DVec3::new(way.dot(basis.right), way.dot(basis.forward), way.dot(basis.up));
            prop_assert!(at.distance(steps.into()) < 1e-8);
        }

        #[test]
        fn a_framed_box_just_fits(camera in rolled_cameras(), bounds in boxes(), aspect in 0.3..3.0f64) {
            let camera = Camera { near_m: default_near_m(distance_m(&camera)), ..camera };
            let wide = framed(&camera, &bounds, ASPECT);
            prop_assert!(just_fits(&wide, &bounds), "{}", fill(&wide, &bounds));
            prop_assert!(view(&wide).basis.forward.distance(view(&camera).basis.forward) < 1e-7);
            prop_assert!(view(&wide).basis.up.distance(view(&camera).basis.up) < 1e-5);
            for camera in [wide, framed(&camera, &bounds, aspect)] {
                let seen = view(&camera);
                prop_assert!(bounds.corners().iter().all(|corner| seen.depth(*corner) >= camera.near_m));
                prop_assert!((seen.depth(bounds.center()) - distance_m(&camera)).abs() < 1e-6);
            }
        }

        #[test]
        fn sides_show_all_of_a_box_from_where_they_say(camera in cameras(), bounds in boxes()) {
            for axis in Axis::ALL {
                let there = axis_view(axis, &bounds, &camera, ASPECT);
                prop_assert!((fill(&there, &bounds) - FILL).abs() < 1e-6, "{axis:?}");
                prop_assert!(view(&there).basis.forward.distance(axis.direction()) < 1e-7);
                let from_middle = there.eye - bounds.center();
                let (side, right) = match axis {
                    Axis::Top => (from_middle.z, DVec3::X),
                    Axis::North => (from_middle.y, -DVec3::X),
                    Axis::South => (-from_middle.y, DVec3::X),
                    Axis::East => (from_middle.x, DVec3::Y),
                    Axis::West => (-from_middle.x, -DVec3::Y),
                };
                prop_assert!(side > 0.0 && view(&there).basis.right.distance(right) < 1e-7, "{axis:?}");
                prop_assert_eq!(view(&there).is_orthographic(), view(&camera).is_orthographic());
                prop_assert!(view(&there).is_orthographic() || there.projection == camera.projection);
            }
        }

        #[test]
        fn another_projection_and_back_is_the_start(camera in rolled_cameras(), fov in 0.1..2.0f64, part in parts()) {
            let fov_y = match camera.projection {
                Projection::Perspective { fov_y } => fov_y,
                Projection::Orthographic { .. } => fov,
            };
            let orthographic = view(&camera).is_orthographic();
            prop_assert_eq!(with_projection(&camera, orthographic, fov_y), camera);
            let other = with_projection(&camera, !orthographic, fov_y);
            prop_assert_eq!(view(&other).is_orthographic(), !orthographic);
            let beside = seen_at(&camera, part, distance_m(&camera));
            prop_assert!(place(&other, beside).distance(part.into()) < 1e-6, "keeps its size");
            let back = with_projection(&other, orthographic, fov_y);
            let growth = picture_height_m(&back) / picture_height_m(&camera);
            prop_assert!((growth - 1.0).abs() < 1e-9);
            prop_assert!(place(&back, beside).distance(part.into()) < 1e-6);
            if !orthographic {
                prop_assert!(back.eye.distance(camera.eye) < 1e-9 * (1.0 + distance_m(&camera)));
                prop_assert_eq!(back.projection, camera.projection);
            }
        }

        #[test]
        fn flights_are_exact_at_their_ends_and_go_on_between(from in rolled_cameras(), to in rolled_cameras()) {
            let flight = Flight { from, to };
            prop_assert_eq!((flight.at(0.0), flight.at(1.0)), (from, to));
            prop_assert_eq!((flight.at(-1.0), flight.at(2.0), flight.at(f64::NAN)), (from, to, from));
            prop_assert!((FLIGHT_S.0..=FLIGHT_S.1).contains(&flight.duration_s()));
            let steps = 4000;
            let mut before = from;
            let lowest = from.eye.z.min(to.eye.z);
            for i in 1..=steps {
                let now = flight.at(f64::from(i) / f64::from(steps));
                prop_assert!(now.check().is_ok());
                prop_assert!(now.eye.z >= lowest - 1e-9);
                // A few thousand metres and half a circle in 4000 steps, the fastest at twice the mean speed and more.
                let reach = distance_m(&before) + from.target.distance(to.target) + 10.0;
                prop_assert!(now.eye.distance(before.eye) < 0.01 * reach, "{i}: {}", now.eye - before.eye);
                prop_assert!(now.target.distance(before.target) < 0.01 * reach, "{i}");
                let (a, b) = (view(&before).basis, view(&now).basis);
                prop_assert!(a.forward.distance(b.forward) < 0.01 && a.up.distance(b.up) < 0.02, "{i}: {a:?} {b:?}");
                let growth = picture_height_m(&now) / picture_height_m(&before);
                prop_assert!((growth - 1.0).abs() < 0.02, "{i}: {growth}");
                before = now;
            }
        }

        #[test]
        fn flights_between_level_cameras_do_not_roll(from in cameras(), to in cameras(), t in 0.0..1.0f64) {
            let flight = Flight { from, to };
            let basis = view(&flight.at(t)).basis;
            prop_assert!(basis.right.z.abs() < 1e-9);
            let headings = [from, flight.at(t), to].map(|camera| Look::of(&view(&camera).basis).heading);
            let (turned, whole) = (shorter(headings[1] - headings[0]), shorter(headings[2] - headings[0]));
            prop_assert!(turned * whole >= -1e-9 && turned.abs() <= whole.abs() + 1e-9, "the short way round");
        }

        #[test]
        fn no_numbers_are_needed_to_answer(
            camera in rolled_cameras(), axis in 0..3usize,
            bad in prop::sample::select(vec![f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, -1e300])
        ) {
            let mut at = camera.target;
            at[axis] = bad;
            let turn = DVec2::new(at.x, at.y);
            let answers = [
                orbit(&camera, at, DVec2::ONE),
                orbit(&camera, NATIONAL, DVec2::new(bad, 0.1)),
                look_around(&camera, turn),
                pan(&view(&camera), at, DVec2::ZERO, DVec2::ONE),
                pan(&view(&camera), camera.target, DVec2::splat(bad), DVec2::ONE),
                zoom(&camera, at, 0.5),
                zoom(&camera, camera.target, bad),
                travel(&camera, at, true),
                travel(&camera, at, false),
                walk(&camera, DVec2::ONE, |_| Some(bad), 1.7),
                walk(&camera, DVec2::ONE, |_| Some(0.0), bad),
                framed(&camera, &Aabb { min: NATIONAL, max: at }, 1.0),
                framed(&camera, &Aabb { min: at, max: NATIONAL }, bad),
                axis_view(Axis::Top, &Aabb { min: NATIONAL, max: at }, &camera, 1.0),
                with_projection(&camera, true, bad),
                with_projection(&camera, false, bad),
                Flight { from: Camera { eye: at, ..camera }, to: camera }.at(1.0),
                Flight { from: camera, to: Camera { eye: at, ..camera } }.at(0.5),
            ];
            for (i, answer) in answers.into_iter().enumerate() {
                prop_assert!(answer.check().is_ok(), "{i}: {answer:?}");
            }
            // Where the given camera has no picture, it comes back.
            let none = Camera { eye: at, up: DVec3::splat(bad), ..camera };
            for answer in [
                orbit(&none, NATIONAL, DVec2::ONE), zoom(&none, NATIONAL, 0.5), travel(&none, DVec3::ONE, true),
                framed(&none, &Aabb { min: NATIONAL, max: NATIONAL + 1.0 }, 1.0), with_projection(&none, true, 1.0),
            ] {
                prop_assert!(answer.up == none.up || bad.is_nan() && answer.up.is_nan());
                prop_assert_eq!(answer.target, none.target);
            }
            let from_none = Flight { from: none, to: camera };
            prop_assert!((FLIGHT_S.0..=FLIGHT_S.1).contains(&from_none.duration_s()));
        }
    }

    #[test]
    fn turning_about_a_point_is_what_is_written() {
        let camera = Camera::looking(NATIONAL - 10.0 * DVec3::Y, NATIONAL, 1.0);
        let near = |camera: &Camera, eye: DVec3| assert!((camera.eye - NATIONAL).distance(eye) < 1e-9, "{camera:?}");
        // A quarter clockwise: the view goes east, so the eye stands in the west.
        near(&orbit(&camera, NATIONAL, DVec2::new(FRAC_PI_2, 0.0)), -10.0 * DVec3::X);
        // Looking down by 30 degrees lifts the eye.
        let down = orbit(&camera, NATIONAL, DVec2::new(0.0, -PI / 6.0));
        near(&down, DVec3::new(0.0, -10.0 * (PI / 6.0).cos(), 5.0));
        let steepest = orbit(&camera, NATIONAL, DVec2::new(0.0, -9.0));
        near(&steepest, 10.0 * DVec3::new(0.0, -MAX_PITCH.cos(), MAX_PITCH.sin()));
        let around = look_around(&camera, DVec2::new(-FRAC_PI_2, 0.0));
        assert!((around.target - around.eye).distance(-10.0 * DVec3::X) < 1e-9, "to the left");
    }

    #[test]
    fn seen_from_straight_above_the_top_of_the_picture_is_ahead() {
        let top = Camera { up: DVec3::X, ..Camera::looking(NATIONAL + 100.0 * DVec3::Z, NATIONAL, 1.0) };
        let ahead = travel(&top, DVec3::new(0.0, 5.0, 0.0), true);
        assert!((ahead.eye - top.eye).distance(5.0 * DVec3::X) < 1e-9);
        // Further down is not possible; round and up is.
        assert!(orbit(&top, NATIONAL, DVec2::new(0.0, -1.0)).eye.distance(top.eye) < 1e-9);
        let round = orbit(&top, NATIONAL, DVec2::new(FRAC_PI_2, 0.0));
        assert!(round.eye.distance(top.eye) < 1e-9 && view(&round).basis.up.distance(-DVec3::Y) < 1e-9);
        let raised = orbit(&top, NATIONAL, DVec2::new(0.0, PI / 6.0));
        assert_eq!(raised.up, DVec3::Z);
        assert!(
            (raised.eye - NATIONAL).distance(100.0 * DVec3::new(-0.5, 0.0, 0.75_f64.sqrt())) < 1e-9,
            "from the west"
        );
        // Up into the sky, the bottom of the picture is ahead.
        let sky = Camera { up: -DVec3::X, ..Camera::looking(NATIONAL, NATIONAL + 100.0 * DVec3::Z, 1.0) };
        assert!((travel(&sky, DVec3::Y, true).eye - sky.eye).distance(DVec3::X) < 1e-9);
        // Flights leave from there without a jump.
        let flight = Flight { from: top, to: raised };
        assert!(view(&flight.at(1e-3)).basis.up.distance(DVec3::X) < 1e-6);
    }

    #[test]
    fn the_eye_stays_before_what_it_zooms_to() {
        let mut camera = Camera::looking(NATIONAL - 50.0 * DVec3::Y, NATIONAL, 1.0);
        for _ in 0..100 {
            camera = zoom(&camera, NATIONAL, 0.7);
        }
        assert!((camera.eye.distance(NATIONAL) - MIN_DISTANCE_M).abs() < 1e-6 && camera.eye.y < NATIONAL.y);
        for _ in 0..100 {
            camera = zoom(&camera, NATIONAL, 1.5);
        }
        assert!((camera.eye.distance(NATIONAL) - MAX_DISTANCE_M).abs() < 1e-2);
        let mut flat = with_projection(&Camera::looking(NATIONAL - 50.0 * DVec3::Y, NATIONAL, 1.0), true, 1.0);
        for (factor, limit) in [(0.3, HEIGHTS_M.0), (3.0, HEIGHTS_M.1)] {
            for _ in 0..60 {
                flat = zoom(&flat, NATIONAL, factor);
            }
            assert_eq!(flat.projection, Projection::Orthographic { height_m: limit });
        }
    }

    #[test]
    fn a_near_plane_of_ones_own_is_kept() {
        let camera = Camera::looking(NATIONAL - 100.0 * DVec3::Y, NATIONAL, 1.0);
        let bounds = Aabb { min: NATIONAL, max: NATIONAL + 50.0 };
        let own = Camera { near_m: 0.7, ..camera };
        let far = zoom(&camera, NATIONAL, 10.0);
        assert!((far.near_m - default_near_m(1000.0)).abs() < 1e-9 && far.near_m != camera.near_m);
        assert_eq!(zoom(&own, NATIONAL, 10.0).near_m, 0.7);
        assert_eq!(axis_view(Axis::Top, &bounds, &own, 1.0).near_m, 0.7);
        // Far away before it: the eye keeps the box behind it.
        let cutting = Camera { near_m: 400.0, ..camera };
        let there = framed(&cutting, &bounds, 1.0);
        assert!(there.near_m == 400.0 && bounds.corners().iter().all(|c| view(&there).depth(*c) >= 400.0));
        assert!((Flight { from: own, to: Camera { near_m: 0.175, ..far } }.at(0.5).near_m - 0.35).abs() < 1e-9);
    }

    #[test]
    fn a_far_flight_rises_and_a_near_one_does_not() {
        let street = looking(NATIONAL, 0.3, 0.0, 20.0, perspective(50.0));
        let away = |metres: f64| moved(&street, metres * DVec3::X);
        let far = Flight { from: street, to: away(3000.0) };
        let middle = far.at(0.5);
        assert!(middle.eye.z > street.eye.z + 1000.0, "{middle:?}");
        let height = picture_height_m(&middle) / 3000.0;
        assert!((0.9..1.1).contains(&height), "as high as the way is long: {height}");
        let near = Flight { from: street, to: away(10.0) };
        assert!((near.at(0.5).eye - street.eye).distance(5.0 * DVec3::X) < 1e-9);
        assert!(near.duration_s() < far.duration_s());
        assert_eq!(Flight { from: street, to: street }.duration_s(), FLIGHT_S.0);
        // At rest at both ends.
        for (t, end) in [(1e-4, far.from), (1.0 - 1e-4, far.to)] {
            assert!(far.at(t).eye.distance(end.eye) < 1e-4);
        }
    }

    #[test]
    fn what_cannot_be_done_changes_nothing() {
        let camera = Camera::looking(NATIONAL - 100.0 * DVec3::Y, NATIONAL, 1.0);
        for factor in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert_eq!(zoom(&camera, NATIONAL, factor), camera);
        }
        assert_eq!(zoom(&camera, camera.eye, 0.5), camera);
        assert_eq!(pan(&view(&camera), camera.eye - DVec3::Y, DVec2::ZERO, DVec2::ONE), camera);
        let point = Aabb { min: NATIONAL, max: NATIONAL };
        let bounds = Aabb { min: NATIONAL, max: NATIONAL + 1.0 };
        for (bounds, aspect) in [(&Aabb::EMPTY, 1.0), (&point, 1.0), (&bounds, 0.0), (&bounds, f64::NAN)] {
            assert_eq!(framed(&camera, bounds, aspect), camera);
            assert_eq!(axis_view(Axis::East, bounds, &camera, aspect), camera);
        }
        assert_eq!(
            with_projection(&with_projection(&camera, true, 1.0), false, 0.0).projection,
            Projection::Orthographic { height_m: picture_height_m(&camera) }
        );
        let none = Camera { eye: NATIONAL, ..camera };
        assert_eq!(orbit(&none, NATIONAL, DVec2::ONE), none);
        assert_eq!(look_around(&none, DVec2::ONE), none);
        assert_eq!(zoom(&none, camera.eye, 0.5), none);
        assert_eq!(walk(&none, DVec2::ONE, |_| Some(0.0), 1.7), none);
        assert_eq!(framed(&none, &bounds, 1.0), none);
        assert_eq!(axis_view(Axis::Top, &bounds, &none, 1.0), none);
        assert_eq!(
            (Flight { from: none, to: camera }.at(0.5), Flight { from: camera, to: none }.at(0.5)),
            (none, camera)
        );
    }

    #[test]
    fn who_lands_looks_at_what_is_named_or_level_ahead() {
        let camera = Camera::looking(NATIONAL + DVec3::new(0.0, -300.0, 200.0), NATIONAL, 0.7);
        let eye = NATIONAL + DVec3::new(20.0, -40.0, 1.7);
        let there = landed(&camera, eye, Some(NATIONAL));
        assert_eq!((there.eye, there.target, there.up), (eye, NATIONAL, DVec3::Z));
        // North as before.
        let ahead = landed(&camera, eye, None);
        assert!(ahead.eye == eye && (ahead.target - eye - LANDED_M * DVec3::Y).length() < 1e-9, "{ahead:?}");
        for nothing in [eye, eye + 9.0 * DVec3::Z, DVec3::NAN] {
            assert_eq!(landed(&camera, eye, Some(nothing)), ahead);
        }
        assert_eq!(landed(&camera, DVec3::NAN, None), camera);
    }
}
