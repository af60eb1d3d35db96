use glam::{DQuat, DVec3};
use proptest::prelude::*;

use crate::geom::{
    aabb::Aabb,
    ray::Ray,
    shape::{Volume, definition::Shape, error::ShapeError, mesh::Mesh, span::EVERYWHERE},
};

fn point(reach: f64) -> impl Strategy<Value = DVec3> {
    prop::array::uniform3(-reach..reach).prop_map(DVec3::from)
}

fn shapes() -> impl Strategy<Value = Shape> {
    let rotation = || point(1.0).prop_map(|v| DQuat::from_scaled_axis(3.0 * v));
    prop_oneof![
        (point(5.0), 0.1..8.0f64).prop_map(|(center, radius)| Shape::Sphere { center, radius }),
        (point(5.0), prop::array::uniform3(0.1..9.0f64), rotation()).prop_map(|(center, s, rotation)| Shape::Box {
            center,
            size: s.into(),
            rotation
        }),
        (point(5.0), 0.1..8.0f64, 0.1..9.0f64, rotation()).prop_map(|(center, radius, height, turn)| {
            Shape::Cylinder { center, radius, height, axis: turn * DVec3::Z }
        }),
        (point(5.0), prop::array::uniform3(0.1..8.0f64), rotation())
            .prop_map(|(center, r, rotation)| { Shape::Ellipsoid { center, radii: r.into(), rotation } }),
        (point(5.0), 0.1..8.0f64, prop_oneof![Just(0.0), 0.1..8.0f64], 0.1..9.0f64, rotation()).prop_map(
            |(center, radius, top_radius, height, turn)| {
                Shape::Frustum { center, radius, top_radius, height, axis: turn * DVec3::Z }
            }
        ),
        prop::collection::vec(point(6.0), 5..30).prop_map(|points| Shape::Convex { points }),
        polytopes(),
        // A lattice makes coplanar and collinear points the rule.
        prop::collection::vec(prop::array::uniform3(-2..3i32), 12..40).prop_map(|p| Shape::Convex {
            points: p.into_iter().map(|[x, y, z]| DVec3::new(x.into(), y.into(), z.into())).collect()
        }),
    ]
}

/// A box turned somehow, with corners cut off by planes of any length of normal; some lie beside it.
fn polytopes() -> impl Strategy<Value = Shape> {
    let cuts = prop::collection::vec((point(1.0), 0.5..6.0f64), 0..9);
    (point(5.0), point(3.0), prop::array::uniform6(0.3..6.0f64), cuts, 0.1..9.0f64).prop_map(
        |(center, turn, box_ends, cuts, length)| {
            let turn = DQuat::from_scaled_axis(turn);
            let sides = [DVec3::X, DVec3::Y, DVec3::Z, -DVec3::X, -DVec3::Y, -DVec3::Z];
            let sides = sides.map(|n| turn * n).into_iter().zip(box_ends);
            let planes = sides.chain(cuts.into_iter().filter_map(|(n, d)| Some((n.try_normalize()?, d))));
            let plane = |(n, d): (DVec3, f64)| {
                let n = length * n;
                [n.x, n.y, n.z, length * d + n.dot(center)]
            };
            Shape::Polytope { planes: planes.map(plane).collect() }
        },
    )
}

/// Membership by the definition of each shape, written apart from the code under test.
fn holds(shape: &Shape, p: DVec3) -> bool {
    match shape {
        Shape::Sphere { center, radius } => (p - *center).dot(p - *center) <= radius * radius,
        Shape::Box { center, size, rotation } => {
            let m = glam::DMat3::from_quat(*rotation);
            let v = p - *center;
            (0..3).all(|i| 2.0 * v.dot(m.col(i)).abs() <= size[i])
        }
        Shape::Cylinder { center, radius, height, axis } => {
            let v = p - *center;
            v.cross(*axis).length() <= *radius && 2.0 * v.dot(*axis).abs() <= *height
        }
        Shape::Ellipsoid { center, radii, rotation } => {
            let m = glam::DMat3::from_quat(*rotation);
            let v = p - *center;
            (0..3).map(|i| (v.dot(m.col(i)) / radii[i]).powi(2)).sum::<f64>() <= 1.0
        }
        Shape::Frustum { center, radius, top_radius, height, axis } => {
            let v = p - *center;
            let up = v.dot(*axis) / height + 0.5;
            (0.0..=1.0).contains(&up) && v.cross(*axis).length() <= radius + up * (top_radius - radius)
        }
        Shape::Polytope { planes } => planes.iter().all(|[x, y, z, d]| DVec3::new(*x, *y, *z).dot(p) <= *d),
        Shape::Form(_) | Shape::Corridor { .. } | Shape::Flat { .. } => unreachable!("they have their own tests"),
        // Inside a hull iff no plane through three of its points has all points on one side and p on the other.
        Shape::Convex { points } => {
            let n = points.len();
            for i in 0..n {
                for j in i + 1..n {
                    for k in j + 1..n {
                        let normal = (points[j] - points[i]).cross(points[k] - points[i]);
                        if normal.length() < 1e-9 {
                            continue;
                        }
                        let side = |q: DVec3| (q - points[i]).dot(normal);
                        for s in [1.0, -1.0] {
                            if points.iter().all(|q| s * side(*q) <= 1e-9) && s * side(p) > 1e-9 {
                                return false;
                            }
                        }
                    }
                }
            }
            true
        }
    }
}

proptest! {
    #![proptest_config(crate::seeds::cases(192))]

    #[test]
    fn contains_is_the_definition(shape in shapes(), p in point(9.0)) {
        let Ok(volume) = shape.volume() else { return Ok(()) };
        if volume.signed_distance(p).abs() > 1e-7 {
            prop_assert_eq!(volume.contains(p), holds(&shape, p));
        }
    }

    #[test]
    fn rays_enter_and_leave_where_points_say(shape in shapes(), origin in point(20.0), direction in point(1.0), axis_parallel in any::<bool>()) {
        let Ok(volume) = shape.volume() else { return Ok(()) };
        let mut direction = direction;
        if axis_parallel {
            direction = DVec3::new(0.0, direction.y.signum(), 0.0);
        }
        let ray = Ray { origin, direction };
        let span = volume.entry_exit(&ray);
        for i in -200..=200 {
            let t = f64::from(i) * 0.25;
            let p = ray.at(t);
            if volume.signed_distance(p).abs() > 1e-6 {
                let inside = span.is_some_and(|(entry, exit)| entry <= t && t < exit);
                prop_assert_eq!(inside, volume.contains(p), "t = {}, span {:?}", t, span);
            }
        }
        if let Some((entry, exit)) = span {
            prop_assert!(entry < exit);
            for t in [entry, exit] {
                prop_assert!(!t.is_finite() || volume.signed_distance(ray.at(t)).abs() < 1e-6);
            }
        }
    }

    #[test]
    fn distance_is_one_lipschitz_and_reaches_the_border(shape in shapes(), p in point(15.0), q in point(15.0)) {
        let Ok(volume) = shape.volume() else { return Ok(()) };
        let (at_p, at_q) = (volume.signed_distance(p), volume.signed_distance(q));
        prop_assert!((at_p - at_q).abs() <= p.distance(q) + 1e-9);
        // Walking down the gradient by the distance arrives at the border: it is exact, not a bound.
        let h = 1e-5;
        let gradient = DVec3::new(
            volume.signed_distance(p + h * DVec3::X) - volume.signed_distance(p - h * DVec3::X),
            volume.signed_distance(p + h * DVec3::Y) - volume.signed_distance(p - h * DVec3::Y),
            volume.signed_distance(p + h * DVec3::Z) - volume.signed_distance(p - h * DVec3::Z),
        ) / (2.0 * h);
        if at_p > 0.1 && (gradient.length() - 1.0).abs() < 1e-6 {
            prop_assert!(volume.signed_distance(p - at_p * gradient).abs() < 1e-3 * (1.0 + at_p));
        }
    }

    #[test]
    fn the_world_may_lie_anywhere(shape in shapes(), origin in point(20.0), direction in point(1.0)) {
        let shift = DVec3::new(85_001.0, 446_003.0, 7.0);
        let moved = match &shape {
            Shape::Sphere { center, radius } => Shape::Sphere { center: *center + shift, radius: *radius },
            Shape::Box { center, size, rotation } => Shape::Box { center: *center + shift, size: *size, rotation: *rotation },
            Shape::Cylinder { center, radius, height, axis } => Shape::Cylinder { center: *center + shift, radius: *radius, height: *height, axis: *axis },
            Shape::Ellipsoid { center, radii, rotation } => Shape::Ellipsoid { center: *center + shift, radii: *radii, rotation: *rotation },
            Shape::Frustum { center, radius, top_radius, height, axis } => {
                Shape::Frustum { center: *center + shift, radius: *radius, top_radius: *top_radius, height: *height, axis: *axis }
            }
            Shape::Convex { points } => Shape::Convex { points: points.iter().map(|p| *p + shift).collect() },
            Shape::Polytope { planes } => Shape::Polytope {
                planes: planes.iter().map(|[x, y, z, d]| [*x, *y, *z, d + DVec3::new(*x, *y, *z).dot(shift)]).collect(),
            },
            Shape::Form(_) | Shape::Corridor { .. } | Shape::Flat { .. } => unreachable!("they have their own tests"),
        };
        let (Ok(here), Ok(there)) = (shape.volume(), moved.volume()) else { return Ok(()) };
        prop_assert!((here.signed_distance(origin) - there.signed_distance(origin + shift)).abs() < 1e-6);
        let a = here.entry_exit(&Ray { origin, direction });
        let b = there.entry_exit(&Ray { origin: origin + shift, direction });
        if let (Some(a), Some(b)) = (a, b)
            && a.1 - a.0 > 0.1
            && direction.length() > 0.1
        {
            prop_assert!((a.0 - b.0).abs() < 1e-4 && (a.1 - b.1).abs() < 1e-4);
        }
    }

    #[test]
    fn meshes_are_closed_and_bounding_ones_bound(shape in shapes(), directions in prop::collection::vec(point(1.0), 20)) {
        let Ok(volume) = shape.volume() else { return Ok(()) };
        let (bounding, surface) = (volume.bounding_mesh(), volume.surface_mesh(24));
        for mesh in [&bounding, &surface] {
            prop_assert_eq!(mesh.validate(), Ok(()));
            prop_assert!(mesh.volume_m3() > 0.0);
        }
        for p in &surface.points {
            prop_assert!(volume.signed_distance(*p) < 1e-9);
        }
        let bounds = volume.bounds();
        for d in &directions {
            // The border point in any direction from the middle lies in the bounding mesh (convex: behind all faces).
            let ray = Ray { origin: bounds.center(), direction: *d };
            let Some((_, exit)) = volume.entry_exit(&ray) else { continue };
            let p = ray.at(exit);
            prop_assert!(bounds.min.cmple(p + 1e-9).all() && bounds.max.cmpge(p - 1e-9).all());
            for t in &bounding.triangles {
                let [a, b, c] = t.map(|i| bounding.points[i as usize]);
                let n = (b - a).cross(c - a).normalize_or_zero();
                prop_assert!((p - a).dot(n) < 1e-9, "{} past a bounding face", (p - a).dot(n));
            }
        }
    }
}

#[test]
fn volumes_are_the_textbooks() {
    let cube =
        Shape::Box { center: DVec3::ONE, size: DVec3::new(2.0, 3.0, 4.0), rotation: DQuat::from_rotation_z(1.0) };
    assert!((cube.volume().unwrap().bounding_mesh().volume_m3() - 24.0).abs() < 1e-12);
    let ball = Shape::Sphere { center: DVec3::ZERO, radius: 2.0 }.volume().unwrap();
    let exact = 4.0 / 3.0 * std::f64::consts::PI * 8.0;
    assert!(ball.bounding_mesh().volume_m3() > exact && ball.bounding_mesh().volume_m3() < 1.09 * exact);
    assert!(ball.surface_mesh(300).volume_m3() < exact && ball.surface_mesh(300).volume_m3() > 0.999 * exact);
    let corners = [0, 1, 2, 3, 4, 5, 6, 7].map(|i| DVec3::new((i & 1).into(), (i >> 1 & 1).into(), (i >> 2).into()));
    let mut points = corners.to_vec();
    points.extend([DVec3::splat(0.5), DVec3::new(0.5, 0.5, 1.0), DVec3::new(0.5, 0.0, 0.0)]);
    let Volume::Convex(hull) = (Shape::Convex { points }).volume().unwrap() else { unreachable!() };
    assert_eq!(hull.planes().1.len(), 6, "coplanar triangles are one face");
}

#[test]
fn flat_and_wrong_shapes_are_refused() {
    let flat = |points: Vec<DVec3>| Shape::Convex { points }.volume().err();
    let square: Vec<DVec3> =
        [(0, 0), (1, 0), (1, 1), (0, 1), (2, 3)].map(|(x, y)| DVec3::new(x.into(), y.into(), 5.0)).into();
    assert_eq!(flat(square), Some(ShapeError::Flat(5)));
    assert_eq!(flat((0..6).map(|i| DVec3::splat(i.into())).collect()), Some(ShapeError::Flat(6)));
    assert_eq!(flat(vec![DVec3::ZERO; 9]), Some(ShapeError::FewPoints(1)));
    assert_eq!(flat(vec![DVec3::NAN; 4]), Some(ShapeError::NotFinite));
    assert_eq!(flat(vec![DVec3::ZERO; 5000]), Some(ShapeError::ManyPoints(5000)));
    let negative = Shape::Sphere { center: DVec3::ZERO, radius: -3.0 }.volume();
    assert_eq!(negative.err(), Some(ShapeError::Negative("radius", -3.0)));
    let no_axis = Shape::Cylinder { center: DVec3::ZERO, radius: 1.0, height: 1.0, axis: DVec3::ZERO }.volume();
    assert_eq!(no_axis.err(), Some(ShapeError::NoAxis));
}

#[test]
fn a_shape_without_volume_holds_nothing() {
    let through = Ray { origin: DVec3::new(-1.0, 0.0, 0.0), direction: DVec3::X };
    for shape in [
        Shape::Sphere { center: DVec3::ZERO, radius: 0.0 },
        Shape::Box { center: DVec3::ZERO, size: DVec3::new(1.0, 1.0, 0.0), rotation: DQuat::IDENTITY },
        Shape::Cylinder { center: DVec3::ZERO, radius: 1.0, height: 0.0, axis: DVec3::Z },
        Shape::Ellipsoid { center: DVec3::ZERO, radii: DVec3::new(1.0, 0.0, 1.0), rotation: DQuat::IDENTITY },
        Shape::Frustum { center: DVec3::ZERO, radius: 1.0, top_radius: 0.0, height: 0.0, axis: DVec3::Z },
        Shape::Frustum { center: DVec3::ZERO, radius: 0.0, top_radius: 0.0, height: 1.0, axis: DVec3::Z },
    ] {
        let volume = shape.volume().unwrap();
        assert!(volume.is_empty() && !volume.contains(DVec3::ZERO));
        assert_eq!(volume.entry_exit(&through), None);
        assert_eq!(volume.bounding_mesh(), Mesh::default());
    }
}

#[test]
fn tangents_miss_and_rays_in_a_face_are_inside() {
    let ball = Shape::Sphere { center: DVec3::ZERO, radius: 1.0 }.volume().unwrap();
    assert_eq!(ball.entry_exit(&Ray { origin: DVec3::new(-9.0, 1.0, 0.0), direction: DVec3::X }), None);
    let cube = Shape::Box { center: DVec3::ZERO, size: DVec3::splat(2.0), rotation: DQuat::IDENTITY }.volume().unwrap();
    let in_face = Ray { origin: DVec3::new(-9.0, 1.0, 0.5), direction: DVec3::X };
    assert_eq!(cube.entry_exit(&in_face), Some((8.0, 10.0)));
    let beside = Ray { origin: DVec3::new(-9.0, 1.0 + 1e-12, 0.5), direction: DVec3::X };
    assert_eq!(cube.entry_exit(&beside), None);
    let still = |origin| cube.entry_exit(&Ray { origin, direction: DVec3::ZERO });
    assert_eq!(still(DVec3::ZERO), Some(EVERYWHERE));
    assert_eq!(still(DVec3::splat(3.0)), None);
}

#[test]
fn rays_along_the_side_and_the_axis_of_a_cone() {
    // Half angle 45°, tip at (0, 0, 1).
    let tip_up = Shape::Frustum { center: DVec3::ZERO, radius: 2.0, top_radius: 0.0, height: 2.0, axis: DVec3::Z };
    let cone = tip_up.volume().unwrap();
    let span = |origin: [f64; 3], direction: [f64; 3]| {
        cone.entry_exit(&Ray { origin: origin.into(), direction: direction.into() })
    };
    assert_eq!(span([0.0, 0.0, 9.0], [0.0, 0.0, -1.0]), Some((8.0, 10.0)));
    // Beside the axis and along it: the side at height 0.5.
    assert_eq!(span([0.5, 0.0, 9.0], [0.0, 0.0, -1.0]), Some((8.5, 10.0)));
    assert_eq!(span([0.5, 0.0, -9.0], [0.0, 0.0, 1.0]), Some((8.0, 9.5)));
    // Within the side, and parallel to it: inside and outside.
    assert_eq!(span([-1.0, 0.0, -1.0], [1.0, 0.0, 1.0]), Some((0.0, 1.5)));
    assert_eq!(span([3.0, 0.0, -1.0], [-1.0, 0.0, 1.0]), None);
    // Through the other half of the double cone, above the tip.
    assert_eq!(span([-9.0, 0.0, 1.5], [1.0, 0.0, 0.0]), None);
    // Just below the tip.
    let (entry, exit) = span([-9.0, 0.0, 1.0 - 1e-9], [1.0, 0.0, 0.0]).unwrap();
    assert!((exit - entry - 2e-9).abs() < 1e-14);
}

#[test]
fn distances_to_an_ellipsoid_are_known_on_its_axes() {
    let radii = DVec3::new(5.0, 2.0, 1.0);
    let body = Shape::Ellipsoid { center: DVec3::ONE, radii, rotation: DQuat::IDENTITY }.volume().unwrap();
    let distance = |p: DVec3| body.signed_distance(DVec3::ONE + p);
    assert!((distance(DVec3::ZERO) + 1.0).abs() < 1e-12, "the shortest radius");
    for i in 0..3 {
        let axis = DVec3::AXES[i];
        assert!((distance((radii[i] + 3.0) * axis) - 3.0).abs() < 1e-12);
        assert!(distance(radii[i] * axis).abs() < 1e-12);
    }
    // On the longest axis, within the evolute, two points of the border are nearest.
    let brute = |p: DVec3| {
        let at = |i: i32| 1e-4 * f64::from(i);
        (0..62_832)
            .map(|i| (DVec3::new(5.0 * at(i).cos(), 0.0, at(i).sin()) - p).length())
            .fold(f64::INFINITY, f64::min)
    };
    for x in [0.5, 2.0, 4.5] {
        let p = DVec3::X * x;
        assert!((distance(p) + brute(p)).abs() < 1e-6, "{x}");
    }
}

#[test]
fn a_far_eye_still_hits_a_small_ball() {
    // From 1000 km, one nanometre inside and outside the silhouette of a one-metre ball.
    let ball = Shape::Sphere { center: DVec3::ZERO, radius: 1.0 }.volume().unwrap();
    let ray = |y: f64| Ray { origin: DVec3::new(-1e6, y, 0.0), direction: DVec3::X };
    let (entry, exit) = ball.entry_exit(&ray(1.0 - 1e-9)).unwrap();
    assert!((exit - entry - 2.0 * (2e-9_f64).sqrt()).abs() < 1e-7);
    assert_eq!(ball.entry_exit(&ray(1.0 + 1e-9)), None);
}

#[test]
fn planes_make_the_body_between_them() {
    let cube = [
        [1.0, 0.0, 0.0, 9.0],
        [-2.0, 0.0, 0.0, 0.0],
        [0.0, 1.0, 0.0, 9.0],
        [0.0, -1.0, 0.0, 0.0],
        [0.0, 0.0, 3.0, 27.0],
        [0.0, 0.0, -1.0, 0.0],
    ];
    let of = |planes: &[[f64; 4]]| Shape::Polytope { planes: planes.to_vec() }.volume();
    let volume = of(&cube).expect("a cube");
    assert_eq!(volume.bounds(), Aabb { min: DVec3::ZERO, max: DVec3::splat(9.0) });
    // A plane given twice, one that touches a corner, one beside it: the same body of twelve triangles.
    let more = [cube.as_slice(), &[cube[0], [1.0, 1.0, 1.0, 27.0], [0.0, 0.0, 1.0, 50.0]]].concat();
    let Ok(Volume::Convex(hull)) = of(&more) else { panic!("a cube") };
    assert_eq!(hull.planes().1.len(), 6);
    let (corners, triangles) = hull.faces();
    assert_eq!((corners.len(), triangles.len()), (8, 12));
    // Their sum of signed volumes is the cube's: all are counter-clockwise from outside.
    let signed = |[a, b, c]: &[u32; 3]| {
        let [a, b, c] = [a, b, c].map(|i| corners[*i as usize]);
        a.dot(b.cross(c)) / 6.0
    };
    assert!((triangles.iter().map(signed).sum::<f64>() - 729.0).abs() < 1e-9);
    // A pyramid of many sides, whose planes all meet in one corner, far from the origin.
    let far = DVec3::new(85_000.0, 446_000.0, 3.0);
    let mut pyramid = vec![[0.0, 0.0, -1.0, -far.z]];
    for i in 0..24 {
        let turn = std::f64::consts::TAU * f64::from(i) / 24.0;
        let n = DVec3::new(turn.cos(), turn.sin(), 1.0);
        pyramid.push([n.x, n.y, n.z, n.dot(far + 10.0 * DVec3::Z)]);
    }
    let Ok(Volume::Convex(hull)) = of(&pyramid) else { panic!("a pyramid") };
    assert_eq!((hull.faces().0.len(), hull.planes().1.len()), (25, 25));
    assert_eq!(of(&cube[..5]).expect_err("no floor"), ShapeError::Open);
    assert_eq!(of(&cube[..4]).expect_err("a shaft"), ShapeError::Open);
    assert_eq!(of(&[cube[0], cube[1], cube[0], cube[1]]).expect_err("a slab"), ShapeError::Open);
    let outwards = cube.map(|[x, y, z, d]| [-x, -y, -z, -d]);
    assert_eq!(of(&outwards).expect_err("all turned round"), ShapeError::Nothing);
    let mut flat = cube;
    flat[4][3] = 0.0;
    assert_eq!(of(&flat).expect_err("no height"), ShapeError::Nothing);
    assert_eq!(of(&[cube.as_slice(), &[[0.0, 0.0, 0.0, 1.0]]].concat()).expect_err("none"), ShapeError::NoNormal(6));
    let long = cube.map(|plane| plane.map(|v| 1e300 * v));
    assert_eq!(of(&long).expect("a cube of long normals").bounds(), volume.bounds());
    assert_eq!(of(&cube.map(|[x, y, z, d]| [1e-300 * x, y, z, 1e300 * d])).expect_err("far"), ShapeError::NotFinite);
    assert_eq!(of(&cube.map(|plane| plane.map(|v| 1e-300 * v))).expect("short").bounds(), volume.bounds());
    assert_eq!(of(&[[1.0, 0.0, 0.0, 1.0]; 65]).expect_err("too many"), ShapeError::ManyPlanes(65));
}
