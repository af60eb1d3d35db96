//! Rigid motions of lens volumes: what stands in a frame of its own, put where the frame is.

use crate::geom::shape::{definition::Shape, error::ShapeError, flat::Sightlines, form::Volume, motion::Motion};

impl Sightlines {
    /// As a frame sees them that a motion has put where it is.
    fn before(&self, motion: &Motion) -> Self {
        match self {
            Self::From(eye) => Self::From(motion.point_before(*eye)),
            Self::Along(direction) => Self::Along(motion.rotation.conjugate() * *direction),
        }
    }
}

impl Shape {
    /// The volumes whose union it is once it has been turned and moved, for an eye with these sight lines, which stay where they
    /// are: only a flat lens depends on them.
    pub fn placed(&self, motion: &Motion, sight: &Sightlines) -> Result<Vec<Volume>, ShapeError> {
        let volumes = self.volumes_seen(&sight.before(motion))?;
        Ok(volumes.into_iter().map(|volume| volume.placed(motion)).collect())
    }
}

#[cfg(test)]
mod tests {
    use glam::{DQuat, DVec2, DVec3};
    use proptest::prelude::*;

    use super::*;
    use crate::geom::{ray::Ray, shape::flat::FlatFigure};

    /// One of each shape, near the origin.
    fn shapes() -> Vec<Shape> {
        let turn = DQuat::from_rotation_z(0.7) * DQuat::from_rotation_x(-0.4);
        let center = DVec3::new(1.0, -2.0, 0.5);
        let points: Vec<DVec3> =
            (0..12).map(|i| 3.0 * DVec3::from([1.7, 2.9, 0.8].map(|s| (s * f64::from(i)).sin()))).collect();
        let sides = [DVec3::X, DVec3::Y, DVec3::Z, DVec3::NEG_X, DVec3::NEG_Y, DVec3::new(0.3, 0.2, -1.0)];
        let flat = |figure| Shape::Flat { center, rotation: turn, figure };
        let arrow = [[0.0, 3.0], [-2.0, -2.0], [0.0, -0.5], [2.0, -2.0]].map(DVec2::from).to_vec();
        vec![
            Shape::Sphere { center, radius: 2.5 },
            Shape::Box { center, size: DVec3::new(3.0, 5.0, 2.0), rotation: turn },
            Shape::Cylinder { center, radius: 1.5, height: 4.0, axis: turn * DVec3::Z },
            Shape::Ellipsoid { center, radii: DVec3::new(3.0, 1.0, 2.0), rotation: turn },
            Shape::Frustum { center, radius: 2.5, top_radius: 0.5, height: 4.0, axis: turn * DVec3::X },
            Shape::Convex { points: points.clone() },
            Shape::Polytope { planes: sides.map(|n| [2.0 * n.x, 2.0 * n.y, 2.0 * n.z, 5.0]).to_vec() },
            Shape::Corridor { points: points[..4].to_vec(), width: 1.5, height: 1.0 },
            flat(FlatFigure::Disc { radius: 2.0 }),
            flat(FlatFigure::Rectangle { size: DVec2::new(4.0, 2.5) }),
            flat(FlatFigure::Polygon { points: arrow }),
        ]
    }

    proptest! {
        #![proptest_config(crate::seeds::config())]

        /// What a moved volume says of a moved point or ray is what the volume said before.
        #[test]
        fn motions_and_tests_commute(
            turn in prop::array::uniform3(-3.0..3.0f64), translation in prop::array::uniform3(-1e5..1e5f64),
            p in prop::array::uniform3(-5.0..5.0f64), q in prop::array::uniform3(-5.0..5.0f64), parallel in any::<bool>(),
        ) {
            let motion = Motion { rotation: DQuat::from_scaled_axis(turn.into()), translation: translation.into() };
            let (p, q) = (DVec3::from(p), DVec3::from(q));
            let eye = DVec3::new(4.0, -9.0, 6.0);
            let (here, moved) = match parallel {
                true => (Sightlines::Along(-eye), Sightlines::Along(motion.rotation * -eye)),
                false => (Sightlines::From(eye), Sightlines::From(motion.point(eye))),
            };
            // A sight line: flat lenses know no other ray.
            let ray = Ray { origin: if parallel { q } else { eye }, direction: if parallel { -eye } else { q - eye } };
            let moved_ray = Ray { origin: motion.point(ray.origin), direction: motion.rotation * ray.direction };
            for shape in shapes() {
                let before = shape.volumes_seen(&here).unwrap();
                let after = shape.placed(&motion, &moved).unwrap();
                prop_assert_eq!(before.len(), after.len());
                for (a, b) in before.iter().zip(&after) {
                    let (da, db) = (a.signed_distance(p), b.signed_distance(motion.point(p)));
                    prop_assert!((da - db).abs() < 1e-6, "{shape:?}: {da} and {db}");
                    prop_assert!(da.abs() < 1e-6 || a.contains(p) == b.contains(motion.point(p)), "{shape:?}");
                    let ends = |v: &Volume, r: &Ray| v.entry_exit(r).map_or([f64::NAN; 2], |(entry, exit)| [entry, exit]);
                    for (s, t) in ends(a, &ray).into_iter().zip(ends(b, &moved_ray)) {
                        let is_same = s == t || (s - t).abs() < 1e-6 || (s.is_nan() && t.is_nan());
                        // Where the ray only just meets it, a rounding decides.
                        let at = if s.is_nan() { t } else { s };
                        let grazes = || a.signed_distance(ray.at(at)).abs() < 1e-6 && s.is_nan() != t.is_nan();
                        prop_assert!(is_same || grazes(), "{shape:?}: {s} and {t}");
                    }
                }
            }
        }
    }

    #[test]
    fn nothing_moves_where_nothing_is_to_move() {
        let sight = Sightlines::From(DVec3::new(1e5, 3.3, 7.1));
        for shape in shapes() {
            let placed = format!("{:?}", shape.placed(&Motion::NONE, &sight));
            assert_eq!(placed, format!("{:?}", shape.volumes_seen(&sight)), "to the bit");
        }
    }
}
