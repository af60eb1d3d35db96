//! Ray handlers of users: what is seen at a place of a lens, as their WGSL says it, on the host.

use std::sync::Arc;

use glam::{DMat2, DVec2, DVec3};

use crate::{
    lens::{handled::Handled, ray_path::Rim},
    shader::{
        effect::{AskedBy, number_of},
        host::HostProgram,
    },
};

/// A user's ray handler with its parameters.
///
/// Places are counted from the lens' middle in radii, y up. What is seen at one is `(x, y, z)`: in perspective the direction
/// `z·(way to the lens' middle) + radius·(x right + y up)` of the picture's plane, so that `(x, y, 1)` is what the picture has at the place
/// `(x, y)`, and with z ≤ 0 it looks aside and back; with parallel rays the place `(x, y) / z`.
#[derive(Clone, Debug, PartialEq)]
pub struct OwnBend {
    /// The number of its handler.
    pub handler: u32,
    /// Its parameters as the GPU reads them.
    pub parameters: Vec<f32>,
    /// How much it shows.
    pub extent: OwnExtent,
    program: Arc<HostProgram>,
}

/// Where such a lens looks: the same as a place of the picture's plane, or as a direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Seen {
    /// A place of the picture's plane.
    Place(DVec2),
    /// A direction from the eye, of length 1, that the plane has not, or only far out.
    Direction(DVec3),
}

/// How much such a lens shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OwnExtent {
    /// How many times as large as without it it shows things, along and across together, where it shows them largest, at most [`MOST_MAGNIFIED`] and at least 1.
    pub magnifies: f64,
    /// The widest angle from its middle that it sees, radians; `None`: it shows places of the picture alone.
    pub turn: Option<f64>,
    /// The least angle that a radius of it sees, along and across together, radians.
    pub per_radius: f64,
}

/// Slopes beyond which what is seen is a direction, not a place of the picture's plane: 89°.
pub const MOST_SLOPE: f64 = 64.0;
/// What lenses that show one place all over are taken to magnify.
const MOST_MAGNIFIED: f64 = 32.0;
/// Places along each side of the square around a lens, in its rim, at which it is asked how much it shows: once for each picture.
const PLACES: u32 = 32;

impl OwnBend {
    /// A use of a handler within a rim.
    ///
    /// # Errors
    /// There is no ray handler of this name.
    pub fn new(used: &Handled, rim: &Rim, is_parallel: bool) -> Result<Self, String> {
        let definition = used.definition(AskedBy::Rays)?;
        let (Some(program), Some(handler)) = (definition.host.clone(), number_of(&used.handler)) else {
            return Err("it does not run on the host".into());
        };
        let extent = OwnExtent { magnifies: 1.0, turn: None, per_radius: 1.0 };
        let own = Self { handler, parameters: used.floats(definition), extent, program };
        Ok(Self { extent: own.extent(rim, is_parallel), ..own })
    }

    /// What its handler is told of its lens: the radius in the picture's plane, twice, and whether the picture is in perspective.
    pub fn size(radius: f64, is_parallel: bool) -> DVec3 {
        DVec3::new(radius, radius, if is_parallel { 0.0 } else { 1.0 })
    }

    /// What is seen at a place, and its derivatives by the place's coordinates; where the handler gives nothing that can be seen, the place itself.
    fn raw(&self, place: DVec2, radius: f64, is_parallel: bool) -> (DVec3, [DVec3; 2]) {
        let said = self.program.vector(place.extend(0.0), Self::size(radius, is_parallel), &self.parameters);
        let is_right =
            |seen: &DVec3| seen.abs().max_element() <= 3e38 && *seen != DVec3::ZERO && (!is_parallel || seen.z > 0.0);
        match said {
            Some((seen, slopes)) if is_right(&seen) => (seen, [slopes.x_axis, slopes.y_axis]),
            _ => (place.extend(1.0), [DVec3::X, DVec3::Y]),
        }
    }

    /// Where it looks at a place of the picture's plane.
    pub fn seen(&self, across: DVec2, center: DVec2, radius: f64, is_parallel: bool) -> Seen {
        let (seen, _) = self.raw((across - center) / radius, radius, is_parallel);
        let across = center * seen.z + radius * seen.truncate();
        if is_parallel || (seen.z > 0.0 && across.abs().max_element() <= MOST_SLOPE * seen.z) {
            return Seen::Place(across / seen.z);
        }
        Seen::Direction(across.extend(-seen.z).normalize_or(DVec3::NEG_Z))
    }

    /// How much it shows within a rim, by what it says of a grid of places.
    fn extent(&self, rim: &Rim, is_parallel: bool) -> OwnExtent {
        let (center, radius) = (rim.center, rim.radius);
        let ahead = center.extend(-1.0).normalize_or(DVec3::NEG_Z);
        let mut extent = OwnExtent { magnifies: 1.0, turn: None, per_radius: std::f64::consts::PI };
        let (mut widest, mut is_round) = (0.0_f64, false);
        for i in 0..(PLACES + 1).pow(2) {
            let steps = DVec2::new((i % (PLACES + 1)).into(), (i / (PLACES + 1)).into());
            let across = center + radius * (steps / (0.5 * f64::from(PLACES)) - 1.0);
            if rim.share(across) > 1.0 {
                continue;
            }
            let (seen, slopes) = self.raw((across - center) / radius, radius, is_parallel);
            let in_view = |v: DVec3| (center * v.z + radius * v.truncate()).extend(-v.z);
            let (way, by) = (in_view(seen), slopes.map(in_view));
            // Of places: how they move in the picture's plane, in radii.
            if way.z < 0.0 {
                let plane = |by: DVec3| (by.truncate() + by.z * way.truncate() / -way.z) / -way.z / radius;
                extent.magnifies = extent.magnifies.max(stretch(by.map(plane)).recip());
            }
            if is_parallel {
                continue;
            }
            is_round |= matches!(self.seen(across, center, radius, false), Seen::Direction(_));
            let unit = way.normalize_or(DVec3::NEG_Z);
            widest = widest.max(ahead.angle_between(unit));
            // Of directions: what is along them does not count.
            let (right, up) = unit.any_orthonormal_pair();
            let turned = by.map(|by| DVec2::new(by.dot(right), by.dot(up)) / way.length());
            extent.per_radius = extent.per_radius.min(stretch(turned));
        }
        let most = |number: f64| number.min(MOST_MAGNIFIED);
        let per_radius = extent.per_radius.max(MOST_MAGNIFIED.recip());
        OwnExtent { magnifies: most(extent.magnifies), per_radius, turn: is_round.then_some(widest) }
    }
}

/// How much a linear map stretches, along and across together.
fn stretch([x, y]: [DVec2; 2]) -> f64 {
    DMat2::from_cols(x, y).determinant().abs().sqrt().max(f64::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        lens::ray::{RayMethod, RayOutline},
        shader::effect,
    };

    fn rim(center: DVec2, outline: RayOutline) -> Rim {
        let (method, fineness) = (RayMethod::Rays, 1.0);
        Rim { center, radius: 0.4, outline, grid: None, field: None, method, fineness, only: None }
    }

    /// A handler of the text, which the tests of this file alone have.
    fn handler(name: &str, body: &str) -> OwnBend {
        let text = format!("//! name = \"{name}\"\n//! kind = \"ray\"\n//! spec = \"\"\n//! doc = \"\"\n\n{body}");
        effect::add(&format!("{name}.wgsl"), &text).unwrap_or_else(|error| panic!("{error}"));
        OwnBend::new(&Handled::named(name), &rim(DVec2::ZERO, RayOutline::Circle), false).unwrap()
    }

    #[test]
    fn what_it_shows_is_told_from_its_text() {
        let larger =
            handler("ray-larger", "fn effect(place: vec2f, size: vec3f) -> vec3f { return vec3f(place / 3.0, 1.0); }");
        for is_parallel in [false, true] {
            let center = DVec2::new(0.2, -0.1);
            let seen = larger.seen(center + DVec2::new(0.3, 0.0), center, 0.4, is_parallel);
            let Seen::Place(place) = seen else { panic!("{seen:?}") };
            assert!((place - center - DVec2::new(0.1, 0.0)).length() < 1e-15, "{place}");
            let extent = larger.extent(&rim(center, RayOutline::Circle), is_parallel);
            assert!((extent.magnifies - 3.0).abs() < 1e-12 && extent.turn.is_none(), "{extent:?}");
        }
        // A fisheye in its own words: of any angle, in a lens of any radius.
        let text = "fn effect(place: vec2f, size: vec3f) -> vec3f {
            let angle = 1.8 * length(place);
            let slope = select(1.8, sin(angle) / length(place), length(place) > 0.0);
            return vec3f(slope * place / size.x, cos(angle));
        }";
        let around = handler("ray-around", text);
        let extent = around.extent(&rim(DVec2::ZERO, RayOutline::Square), false);
        // In the corners of its square.
        assert!((extent.turn.unwrap() - 1.8 * 2f64.sqrt()).abs() < 1e-6, "{extent:?}");
        for share in [0.0, 0.3, 0.95] {
            let at = DVec2::new(0.6, 0.8) * share;
            let way = match around.seen(0.4 * at, DVec2::ZERO, 0.4, false) {
                Seen::Place(place) => place.extend(-1.0).normalize_or(DVec3::NEG_Z),
                Seen::Direction(way) => way,
            };
            let angle: f64 = 1.8 * share;
            let expected = (at / if share > 0.0 { share } else { 1.0 } * angle.sin()).extend(-angle.cos());
            // Numbers of the text are f32.
            assert!((way - expected).length() < 1e-7, "{way} {expected}");
        }
    }

    #[test]
    fn what_is_nothing_is_the_place_itself() {
        for (name, text) in [("ray-zero", "vec3f(0.0)"), ("ray-endless", "vec3f(place / 0.0 * 0.0, 1.0)")] {
            let own = handler(
                name,
                &format!(
                    "fn effect(place: vec2f, size: vec3f) -> vec3f {{ var zero = 0.0; _ = zero; return {}; }}",
                    text.replace("0.0 * 0.0", "zero")
                ),
            );
            let at = DVec2::new(0.1, 0.2);
            assert_eq!(own.seen(at, DVec2::ZERO, 0.5, false), Seen::Place(at), "{name}");
        }
        let behind =
            handler("ray-behind", "fn effect(place: vec2f, size: vec3f) -> vec3f { return vec3f(place, -1.0); }");
        let at = DVec2::new(0.1, 0.2);
        assert_eq!(behind.seen(at, DVec2::ZERO, 0.5, true), Seen::Place(at));
        assert!(matches!(behind.seen(at, DVec2::ZERO, 0.5, false), Seen::Direction(way) if way.z > 0.0));
    }
}
