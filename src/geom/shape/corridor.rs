//! Corridors: what lies along a line, such as a route, as a union of convex bodies.

use glam::{DQuat, DVec2, DVec3};

use crate::geom::shape::{
    error::ShapeError,
    form::{Volume, cylinder::Cylinder, oriented_box::OrientedBox},
    hull::Hull,
    limits::MAX_POINTS,
};

/// Seen from above, shorter ways are none: there the bodies at both ends are one to 2.5e-13 m²/width.
const SHORTEST_M: f64 = 1e-6;

/// The bodies of a corridor around a line: for each part of it a box, sheared where it climbs, and for each of its points an
/// upright cylinder, so that corners are round. None where it has no width or height.
pub(super) fn bodies(points: &[DVec3], width: f64, height: f64) -> Result<Vec<Volume>, ShapeError> {
    if !points.iter().all(|p| p.is_finite()) {
        return Err(ShapeError::NotFinite);
    }
    if points.len() < 2 {
        return Err(ShapeError::ShortLine(points.len()));
    }
    if points.len() > MAX_POINTS {
        return Err(ShapeError::ManyPoints(points.len()));
    }
    if width <= 0.0 || height <= 0.0 {
        return Ok(Vec::new());
    }
    let radius = 0.5 * width;
    let up = 0.5 * height * DVec3::Z;
    let cylinder = |center, height| Volume::Cylinder(Cylinder { center, radius, height, axis: DVec3::Z });
    let mut bodies: Vec<Volume> = points.iter().map(|p| cylinder(*p, height)).collect();
    for part in points.windows(2) {
        let (middle, way) = (part[0].midpoint(part[1]), part[1] - part[0]);
        let ground: DVec2 = way.truncate();
        let length = ground.length();
        if length < SHORTEST_M {
            if way.z != 0.0 {
                bodies.push(cylinder(middle, way.z.abs() + height));
            }
            continue;
        }
        if way.z == 0.0 {
            let rotation = DQuat::from_rotation_z(ground.y.atan2(ground.x));
            let size = DVec3::new(length, width, height);
            bodies.push(Volume::Box(OrientedBox { center: middle, size, rotation }));
            continue;
        }
        let aside = (radius / length * ground.perp()).extend(0.0);
        let corners: Vec<DVec3> =
            part.iter().flat_map(|p| [aside, -aside].map(|a| *p + a)).flat_map(|p| [p + up, p - up]).collect();
        bodies.push(Volume::Convex(Hull::new(&corners)?));
    }
    Ok(bodies)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// By its definition: along a part of the line, or around one of its points.
    fn holds(points: &[DVec3], width: f64, height: f64, p: DVec3) -> bool {
        let near = |on: DVec3| (p - on).truncate().length() <= 0.5 * width && (p.z - on.z).abs() <= 0.5 * height;
        let along = |part: &[DVec3]| {
            let way = (part[1] - part[0]).truncate();
            let t = (p - part[0]).truncate().dot(way) / way.length_squared();
            (0.0..=1.0).contains(&t) && near(part[0] + t * (part[1] - part[0]))
        };
        points.iter().any(|on| near(*on)) || points.windows(2).any(along)
    }

    proptest! {
        #![proptest_config(crate::seeds::config())]

        #[test]
        fn a_corridor_holds_what_is_along_its_line(
            line in prop::collection::vec(prop::array::uniform3(-9.0..9.0f64), 2..7),
            is_level in any::<bool>(),
            (width, height) in (0.2..4.0f64, 0.2..4.0f64),
            places in prop::collection::vec(prop::array::uniform3(-10.0..10.0f64), 60),
        ) {
            let level = if is_level { 0.0 } else { 1.0 };
            let far = DVec3::new(85_000.0, 446_000.0, 0.0);
            let points: Vec<DVec3> = line.iter().map(|p| DVec3::new(p[0], p[1], level * p[2])).collect();
            let moved: Vec<DVec3> = points.iter().map(|p| *p + far).collect();
            let bodies = bodies(&moved, width, height).expect("a corridor");
            for place in places {
                let p = DVec3::from(place);
                let distance = bodies.iter().map(|b| b.signed_distance(p + far)).fold(f64::INFINITY, f64::min);
                if distance.abs() > 1e-6 {
                    prop_assert_eq!(distance < 0.0, holds(&points, width, height, p), "{} {:?}", p, points);
                }
            }
        }
    }

    #[test]
    fn steps_straight_up_and_no_steps_are_part_of_it() {
        let line = [DVec3::ZERO, DVec3::ZERO, DVec3::Z * 10.0, DVec3::new(5.0, 0.0, 10.0)];
        let bodies = bodies(&line, 2.0, 1.0).expect("a corridor");
        let holds = |p: DVec3| bodies.iter().any(|b| b.contains(p));
        assert!(holds(DVec3::new(0.9, 0.0, 5.0)) && holds(DVec3::new(4.0, 0.9, 10.4)) && holds(DVec3::Z * -0.4));
        assert!(!holds(DVec3::new(1.1, 0.0, 5.0)) && !holds(DVec3::new(4.0, 0.0, 8.0)) && !holds(DVec3::Z * -0.6));
        assert_eq!(super::bodies(&line[..1], 2.0, 1.0).err(), Some(ShapeError::ShortLine(1)));
        assert!(super::bodies(&line, 0.0, 1.0).expect("none").is_empty());
    }
}
