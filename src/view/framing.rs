//! A camera that a ball just fits into: that of a best-view lens (Trapp, eq. 3.23 and below it).
//!
//! ```text
//!          near         far
//!           │   ╭───╮   │       D = r / sin(α/2): the ball touches the borders of the picture
//!  eye ─────┼──│  M  │──┼       near = D − r, far = D + r
//!   n ←     │   ╰───╯   │       V's √(2·r²) is the D of α = 90°
//! ```

use glam::{DVec2, DVec3};

use crate::{
    geom::Sphere,
    view::camera::{Camera, CameraError, MAX_FOV, MIN_FOV, Projection},
};

/// The field of view of a camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Field {
    /// Vertical field of view, radians, [`MIN_FOV`]..=[`MAX_FOV`].
    pub fov_y: f64,
    /// Width of the picture over its height, > 0.
    pub aspect: f64,
}

impl Default for Field {
    /// That of a scene's camera that says nothing, 45°, in a picture of 16 by 9.
    fn default() -> Self {
        Self { fov_y: 45_f64.to_radians(), aspect: 16.0 / 9.0 }
    }
}

impl Field {
    /// α: the smaller of the horizontal and the vertical field of view, radians.
    pub fn narrower(&self) -> f64 {
        self.fov_y.min(2.0 * ((0.5 * self.fov_y).tan() * self.aspect).atan())
    }

    /// The distance of the eye from the middle of a ball that just fits, metres: D = r / sin(α/2).
    pub fn distance_to(&self, radius: f64) -> f64 {
        radius / (0.5 * self.narrower()).sin()
    }
}

/// Why a ball cannot be looked at so.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FramingError {
    /// A camera error.
    #[error(transparent)]
    Camera(#[from] CameraError),
    /// No width.
    #[error("the picture's width over its height must be 0.0001 to 10000, is {0}")]
    Aspect(f64),
    /// No direction.
    #[error("the direction to look from must be a vector that is finite and not zero, is ({0}, {1}, {2})")]
    Normal(f64, f64, f64),
    /// Nothing to fill the picture with.
    #[error("a ball of {0} m cannot be looked at: 1 mm to 1000 km would be right")]
    Radius(f64),
}

/// A camera that a ball just fits into.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Framing {
    /// BVN: from the middle of the ball to the eye, unit.
    pub normal: DVec3,
    /// LF: M + BVN·D, metres.
    pub eye: DVec3,
    /// LT: M, metres.
    pub target: DVec3,
    /// Up in the picture; the world's up wherever that says it, see [`up_along`].
    pub up: DVec3,
    /// Vertical field of view, radians.
    pub fov_y: f64,
    /// Where the ball begins: D − r, metres along the view axis, > 0.
    pub near_m: f64,
    /// Where it ends: D + r, metres.
    pub far_m: f64,
}

/// The part of the picture that points fill at most.
const FILLED: f64 = 0.94;
/// The part of its depth by which a picture begins before the first point and ends behind the last one.
const SPARE: f64 = 1e-3;
/// The part of the radius of the ball by which an eye stays before the nearest point.
const LEAST_BEFORE: f64 = 0.05;

impl Framing {
    /// The camera in the direction `normal` (any length) of a ball. `viewer`: direction of view and up of the camera that the
    /// picture belongs to, if to any; asked for by views along the vertical alone.
    pub fn new(ball: &Sphere, normal: DVec3, field: &Field, viewer: Option<[DVec3; 2]>) -> Result<Self, FramingError> {
        if !(MIN_FOV * (1.0 - 1e-12)..=MAX_FOV * (1.0 + 1e-12)).contains(&field.fov_y) {
            return Err(CameraError::FieldOfView(field.fov_y.to_degrees()).into());
        }
        if !(1e-4..=1e4).contains(&field.aspect) {
            return Err(FramingError::Aspect(field.aspect));
        }
        if !(1e-3..=1e6).contains(&ball.radius) {
            return Err(FramingError::Radius(ball.radius));
        }
        let unit = if normal.is_finite() { normal.try_normalize() } else { None };
        let normal = unit.ok_or(FramingError::Normal(normal.x, normal.y, normal.z))?;
        let distance = field.distance_to(ball.radius);
        Ok(Self {
            normal,
            eye: ball.center + distance * normal,
            target: ball.center,
            up: up_along(normal, viewer),
            fov_y: field.fov_y,
            near_m: distance - ball.radius,
            far_m: distance + ball.radius,
        })
    }

    /// The camera in the direction `normal` (any length) of points, all of which just have room in the picture, in the middle of it: what is
    /// long fills it where a ball around it would not. Its target is as deep as the middle of the ball around them.
    pub fn of_points(
        points: &[DVec3],
        ball: &Sphere,
        normal: DVec3,
        field: &Field,
        viewer: Option<[DVec3; 2]>,
    ) -> Result<Self, FramingError> {
        let of_ball = Self::new(ball, normal, field, viewer)?;
        let forward = -of_ball.normal;
        let right = forward.cross(of_ball.up).normalize_or(DVec3::X);
        let up = right.cross(forward);
        let tan = FILLED * (0.5 * field.fov_y).tan() * DVec2::new(field.aspect, 1.0);
        // A point at (x, y) across and z along the view is in the picture of an eye at (a, b) and -d along it, if |x - a| ≤ tan·(z + d): the
        // borders of all, right and left, top and bottom.
        let (mut high, mut low) = (DVec2::NEG_INFINITY, DVec2::NEG_INFINITY);
        let (mut near, mut far) = (f64::INFINITY, f64::NEG_INFINITY);
        for point in points {
            let from_middle = *point - ball.center;
            let (across, along) = (DVec2::new(from_middle.dot(right), from_middle.dot(up)), from_middle.dot(forward));
            (high, low) = (high.max(across - tan * along), low.max(-across - tan * along));
            (near, far) = (near.min(along), far.max(along));
        }
        if !(high.is_finite() && low.is_finite()) {
            return Ok(of_ball);
        }
        let aside = 0.5 * (high - low);
        // An eye is never in what it looks at.
        let distance = (0.5 * (high + low) / tan).max_element().max(LEAST_BEFORE * ball.radius - near);
        let eye = ball.center + aside.x * right + aside.y * up - distance * forward;
        let near_m = near + distance;
        Ok(Self {
            eye,
            target: eye + distance * forward,
            near_m: (1.0 - SPARE) * near_m,
            far_m: (1.0 + SPARE) * (far + distance),
            ..of_ball
        })
    }

    /// The camera with this near plane, which cuts away what stands before the ball; as near and as far as cameras may have it.
    pub fn camera(&self) -> Camera {
        let projection = Projection::Perspective { fov_y: self.fov_y };
        Camera { eye: self.eye, target: self.target, up: self.up, projection, near_m: self.near_m.clamp(1e-4, 1e6) }
    }
}

/// The upward direction in a picture looked at from the direction `normal` (unit): the world's up. Along the vertical, of a viewer with direction
/// of view f and up u, normalise((I − n·nᵀ)(f − (f·n)u)): where f leads is the top of the picture, and where f is the vertical
/// too, u is. Without a viewer, or where that is nothing, north.
pub fn up_along(normal: DVec3, viewer: Option<[DVec3; 2]>) -> DVec3 {
    /// Below this sine they count as parallel, as for [`crate::view::basis::Basis`].
    const PARALLEL: f64 = 1e-6;
    if normal.cross(DVec3::Z).length() > PARALLEL {
        return DVec3::Z;
    }
    let across = |v: DVec3| v - v.dot(normal) * normal;
    let of_viewer = viewer.map(|[forward, up]| across(forward - forward.dot(normal) * up));
    let long_enough = of_viewer.filter(|up| up.length() > PARALLEL).and_then(DVec3::try_normalize);
    long_enough.unwrap_or(across(DVec3::Y).normalize_or(DVec3::Y))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::{geom::Aabb, view::project::View};

    const BALL: Sphere = Sphere { center: DVec3::new(85_000.0, 447_000.0, 12.0), radius: 10.0 };

    #[test]
    fn at_a_right_angle_the_eye_is_where_trapp_has_it() {
        let field = Field { fov_y: std::f64::consts::FRAC_PI_2, aspect: 1.0 };
        let view = Framing::new(&BALL, DVec3::X, &field, None).unwrap();
        assert!((view.eye - BALL.center).distance((2.0 * 10.0_f64.powi(2)).sqrt() * DVec3::X) < 1e-9);
        assert!(
            (view.near_m - (200_f64.sqrt() - 10.0)).abs() < 1e-12 && (view.far_m - view.near_m - 20.0).abs() < 1e-12
        );
    }

    proptest! {
        #![proptest_config(crate::seeds::config())]

        #[test]
        fn the_ball_touches_the_border_and_nothing_of_it_is_cut(
            n in prop::array::uniform3(-1.0..1.0f64), fov in 5.0..150.0f64, width in 100..1500u32, height in 100..1500u32
        ) {
            let Some(normal) = DVec3::from(n).try_normalize() else { return Ok(()) };
            let field = Field { fov_y: fov.to_radians(), aspect: f64::from(width) / f64::from(height) };
            let framing = Framing::new(&BALL, normal, &field, None).unwrap();
            let view = View::new(framing.camera(), [width, height], &Aabb::EMPTY).unwrap();
            let basis = view.basis;
            // Sight lines at the angle of the narrower side touch the ball; the other side has room.
            let half = view.half_extent();
            let touch = |axis: DVec3, tan: f64| {
                let along = (basis.forward + tan * axis).normalize_or(DVec3::X);
                let to = BALL.center - framing.eye;
                (to - to.dot(along) * along).length()
            };
            let (across, upwards) = (touch(basis.right, half.x), touch(basis.up, half.y));
            prop_assert!((across.min(upwards) - BALL.radius).abs() < 1e-6, "{across} {upwards}");
            let depth = (BALL.center - framing.eye).dot(basis.forward);
            prop_assert!((depth - BALL.radius - framing.near_m).abs() < 1e-6);
            prop_assert!((depth + BALL.radius - framing.far_m).abs() < 1e-6);
        }

        #[test]
        fn points_fill_the_picture_and_none_is_cut(
            n in prop::array::uniform3(-1.0..1.0f64), fov in 10.0..100.0f64, width in 200..1500u32, height in 200..1500u32,
            points in prop::collection::vec(prop::array::uniform3(-1.0..1.0f64), 4..40), size in prop::array::uniform3(1.0..90.0f64)
        ) {
            let Some(normal) = DVec3::from(n).try_normalize() else { return Ok(()) };
            let field = Field { fov_y: fov.to_radians(), aspect: f64::from(width) / f64::from(height) };
            let points: Vec<DVec3> = points.into_iter().map(|p| BALL.center + DVec3::from(p) * DVec3::from(size)).collect();
            let ball = Sphere::around(&points).unwrap();
            let framing = Framing::of_points(&points, &ball, normal, &field, None).unwrap();
            let camera = framing.camera();
            let view = View::new(camera, [width, height], &Aabb::EMPTY).unwrap();
            let sides = DVec2::new(f64::from(width), f64::from(height));
            let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
            for point in &points {
                let depth = view.depth(*point);
                prop_assert!(depth > camera.near_m && depth < framing.far_m);
                let at = view.pixel(*point).unwrap().truncate() / sides;
                (low, high) = (low.min(at), high.max(at));
            }
            prop_assert!(low.min_element() > 0.0 && high.max_element() < 1.0, "{low} {high}");
            // One side is filled, unless the eye would be in it; the other is in the middle.
            let is_near = view.depth(ball.center) <= LEAST_BEFORE * ball.radius
                - points.iter().map(|p| (*p - ball.center).dot(-framing.normal)).fold(f64::INFINITY, f64::min) + 1e-9;
            prop_assert!(is_near || ((high - low).max_element() - FILLED).abs() < 1e-6, "{low} {high}");
            // Never farther away than for the ball by more than the rim that is left.
            let by_ball = Framing::new(&ball, normal, &field, None).unwrap();
            prop_assert!(view.depth(ball.center) <= by_ball.eye.distance(ball.center) / FILLED + 1e-6);
        }

        #[test]
        fn seen_from_above_the_way_ahead_is_up(turn in 0.0..std::f64::consts::TAU, down in 0.0..1.5f64) {
            let ahead = DVec3::new(turn.sin(), turn.cos(), 0.0);
            let forward = ahead * down.cos() - DVec3::Z * down.sin();
            let up = ahead * down.sin() + DVec3::Z * down.cos();
            prop_assert!(up_along(DVec3::Z, Some([forward, up])).distance(ahead) < 1e-9);
        }
    }

    #[test]
    fn up_is_defined_everywhere() {
        assert_eq!(up_along(DVec3::X, Some([DVec3::Y, DVec3::Z])), DVec3::Z);
        assert_eq!(up_along(DVec3::Z, None), DVec3::Y, "north");
        assert_eq!(up_along(-DVec3::Z, None), DVec3::Y, "from below too");
        // A viewer that looks straight down has its own up; one for which nothing is left, north.
        assert_eq!(up_along(DVec3::Z, Some([-DVec3::Z, DVec3::X])), DVec3::X);
        let (n_u, m_u) = (0.5 * (1.0 - 5_f64.sqrt()), (0.5 * (5_f64.sqrt() - 1.0)).sqrt());
        let (forward, up) = (DVec3::new(-n_u, 0.0, m_u), DVec3::new(m_u, 0.0, n_u));
        assert_eq!(up_along(DVec3::Z, Some([forward, up])), DVec3::Y);
    }

    #[test]
    fn what_has_no_picture_is_refused() {
        let field = Field::default();
        let refused =
            |ball: &Sphere, normal, field: &Field| Framing::new(ball, normal, field, None).unwrap_err().to_string();
        assert!(refused(&BALL, DVec3::ZERO, &field).contains("not zero"));
        assert!(refused(&BALL, DVec3::NAN, &field).contains("finite"));
        assert!(refused(&Sphere { radius: 0.0, ..BALL }, DVec3::X, &field).contains("1 mm"));
        assert!(refused(&BALL, DVec3::X, &Field { fov_y: 4.0, ..field }).contains("179 degrees"));
        assert!(refused(&BALL, DVec3::X, &Field { aspect: 0.0, ..field }).contains("width"));
        // The widest and the narrowest still have a camera.
        for fov_y in [MIN_FOV, MAX_FOV] {
            assert!(
                Framing::new(&BALL, DVec3::X, &Field { fov_y, aspect: 1.0 }, None).unwrap().camera().check().is_ok()
            );
        }
    }
}
