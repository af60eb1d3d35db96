//! Lenses of every analytic shape, and what they hold by the definitions of the shapes alone, in f64.

use std::collections::BTreeMap;

use glam::{DMat3, DQuat, DVec3};
use veduta::{
    geom::Shape,
    lens::{Class, EffectUse, Lens, Parameter, Region},
    render::picture::{Picture, Studio},
    view::{Camera, View},
};

use crate::{oracle::Numbers, studio};

/// Kinds that [`shape`] makes.
pub const KINDS: usize = 9;

/// How many pixels a test of pictures looks at: `usual`, or what `VEDUTA_HARD_PIXELS` says (`./dev hard`).
pub fn pixels(usual: u64) -> u64 {
    std::env::var("VEDUTA_HARD_PIXELS").ok().map_or(usual, |n| n.parse().expect("VEDUTA_HARD_PIXELS is a number"))
}

/// A number from 0 to 1.
pub fn share(numbers: &mut Numbers) -> f64 {
    numbers.below(1 << 40) as f64 / (1_u64 << 40) as f64
}

/// A direction or a place in the cube of -1..1.
pub fn in_cube(numbers: &mut Numbers) -> DVec3 {
    DVec3::new(share(numbers), share(numbers), share(numbers)) * 2.0 - 1.0
}

/// A shape of one of [`KINDS`], about `r` metres large, turned and stretched at random.
pub fn shape(kind: usize, center: DVec3, r: f64, numbers: &mut Numbers) -> Shape {
    let axis = in_cube(numbers).try_normalize().unwrap_or(DVec3::Z);
    let rotation = DQuat::from_axis_angle(axis, 6.0 * share(numbers));
    let mut size = || r * (0.3 + 0.7 * share(numbers));
    let sizes = DVec3::new(size(), size(), size());
    match kind % KINDS {
        0 => Shape::Sphere { center, radius: sizes.x },
        1 => Shape::Box { center, size: 2.0 * sizes, rotation },
        2 => Shape::Cylinder { center, radius: sizes.x, height: 2.0 * sizes.y, axis },
        3 => Shape::Ellipsoid { center, radii: sizes, rotation },
        4 => Shape::Frustum { center, radius: sizes.x, top_radius: 0.0, height: 2.0 * sizes.y, axis },
        5 => Shape::Frustum { center, radius: sizes.x, top_radius: sizes.z, height: 2.0 * sizes.y, axis },
        6 => {
            // A slanting box: bits 0, 1, 2 of a corner's number choose its side.
            let axes = DMat3::from_quat(rotation);
            let (a, b, c) = (axes.x_axis * sizes.x, axes.y_axis * sizes.y, (axes.z_axis + 0.4 * axes.x_axis) * sizes.z);
            let side = |i: u32, bit: u32| if i >> bit & 1 == 0 { -1.0 } else { 1.0 };
            let points = (0..8).map(|i| center + side(i, 0) * a + side(i, 1) * b + side(i, 2) * c);
            Shape::Convex { points: points.collect() }
        }
        7 => {
            // An octahedron with two of its tips cut off; its normals have any length.
            let mut planes = Vec::new();
            for i in 0..8 {
                let side = |bit: u32| if i >> bit & 1 == 0 { -1.0 } else { 1.0 };
                planes.push((rotation * DVec3::new(side(0), side(1), side(2)), 3_f64.sqrt() * sizes.x));
            }
            planes.extend([rotation * DVec3::X, rotation * -DVec3::Z].map(|n| (n, sizes.x)));
            let plane = |(normal, d): (DVec3, f64)| [normal.x, normal.y, normal.z, d + normal.dot(center)];
            Shape::Polytope { planes: planes.into_iter().map(plane).collect() }
        }
        _ => {
            let way = sizes * in_cube(numbers).with_z(0.3 * share(numbers));
            let level = DVec3::new(-way.y, way.x, 0.0);
            let points = vec![center - way, center, center + level];
            Shape::Corridor { points, width: 0.6 * sizes.x, height: sizes.z }
        }
    }
}

/// Whether the closed body holds `p`: the definition of each shape. Convex ones as [`shape`] makes them.
pub fn holds(shape: &Shape, p: DVec3) -> bool {
    match shape {
        Shape::Sphere { center, radius } => p.distance(*center) <= *radius,
        Shape::Box { center, size, rotation } => (rotation.inverse() * (p - *center)).abs().cmple(0.5 * *size).all(),
        Shape::Cylinder { center, radius, height, axis } => {
            let along = (p - *center).dot(*axis);
            along.abs() <= 0.5 * height && (p - *center - along * *axis).length() <= *radius
        }
        Shape::Ellipsoid { center, radii, rotation } => (rotation.inverse() * (p - *center) / *radii).length() <= 1.0,
        Shape::Frustum { center, radius, top_radius, height, axis } => {
            let along = (p - *center).dot(*axis);
            let share = 0.5 + along / height;
            along.abs() <= 0.5 * height
                && (p - *center - along * *axis).length() <= radius + (top_radius - radius) * share
        }
        Shape::Convex { points } => {
            let (a, b, c) = (points[1] - points[0], points[2] - points[0], points[4] - points[0]);
            let at = DMat3::from_cols(a, b, c).inverse() * (p - points[0]);
            at.cmpge(DVec3::ZERO).all() && at.cmple(DVec3::ONE).all()
        }
        Shape::Form(volume) => volume.contains(p),
        Shape::Flat { .. } => {
            unreachable!("a flat lens holds what an eye sees through it; case 4 has tests of its own")
        }
        Shape::Polytope { planes } => planes.iter().all(|[x, y, z, d]| DVec3::new(*x, *y, *z).dot(p) <= *d),
        Shape::Corridor { points, width, height } => {
            let near = |on: DVec3| (p - on).truncate().length() <= 0.5 * width && (p.z - on.z).abs() <= 0.5 * height;
            let along = |part: &[DVec3]| {
                let way = (part[1] - part[0]).truncate();
                let t = (p - part[0]).truncate().dot(way) / way.length_squared();
                (0.0..=1.0).contains(&t) && near(part[0] + t * (part[1] - part[0]))
            };
            points.iter().any(|on| near(*on)) || points.windows(2).any(along)
        }
    }
}

/// The stated band of an analytic test around a volume, metres, for a place at D; the adapter's grid included.
pub fn band(volume: &veduta::geom::Volume, view: &View, d: f64) -> f64 {
    veduta::measure::topics::gpu::shapes::band(volume, view, d, studio::snapping())
}

/// The first pixel whose bit is not what the shapes hold, outside the band; and how many were inside.
pub fn check_mask(picture: &Picture, view: &View, lens: &Lens, bit: usize) -> Result<u64, String> {
    let inside = studio::bits(picture, bit);
    let depth = picture.depth.as_ref().expect("depth was asked for");
    let mut count = 0;
    for (i, &d) in depth.iter().enumerate() {
        let d = f64::from(d);
        let [x, y] = [i as u32 % picture.size[0], i as u32 / picture.size[0]];
        assert!(d > 0.0, "no distance at {x},{y}: {d}");
        count += u64::from(inside[i]);
        let p = view.pixel_ray(x, y).at(d);
        if inside[i] == (d.is_finite() && lens.shapes.iter().any(|s| matches!(s, Region::Shape(s) if holds(s, p)))) {
            continue;
        }
        let volumes = lens.shapes.iter().flat_map(|s| s.volumes().expect("volumes"));
        let beyond = |v: &veduta::geom::Volume| v.signed_distance(p).abs() - band(v, view, d);
        let least = volumes.map(|v| beyond(&v)).fold(f64::INFINITY, f64::min);
        if !d.is_finite() || least > 0.0 {
            return Err(format!("pixel {x},{y} at {d} m is {}, {least} m beyond the band: {lens:?}", inside[i]));
        }
    }
    Ok(count)
}

/// What [`painted`] paints the classes in.
const COLORS: [(Class, &str, [u8; 4]); 4] = [
    (Class::Inside, "#ffffff", [255, 255, 255, 255]),
    (Class::Front, "#ff0000", [255, 0, 0, 255]),
    (Class::Behind, "#00ff00", [0, 255, 0, 255]),
    (Class::Rest, "#0000ff", [0, 0, 255, 255]),
];

/// A lens that paints each class in its own colour.
pub fn painted(shapes: Vec<Shape>) -> Lens {
    let paint = |(class, color, _): (Class, &str, _)| EffectUse {
        class,
        parameters: BTreeMap::from([
            ("color".to_owned(), Parameter::Text(color.to_owned())),
            ("opacity".to_owned(), Parameter::Number(1.0)),
        ]),
        ..studio::used("overlay")
    };
    Lens { effects: COLORS.map(paint).to_vec(), ..studio::lens("lens", shapes, "sepia") }
}

/// The class that a pixel was painted as.
pub fn painted_class(color: [u8; 4]) -> Option<Class> {
    COLORS.iter().find(|(_, _, painted)| *painted == color).map(|(class, ..)| *class)
}

/// Looks over the city from above, along its streets, and in parallel.
pub fn cameras(studio: &Studio) -> [Camera; 3] {
    let extent = studio.extent();
    let (center, size) = (extent.center(), extent.size().length());
    let house = studio.model.geometries[studio.geometries[studio.geometries.len() / 2] as usize].bounds;
    let street = DVec3::new(house.min.x - 9.0, house.min.y - 6.0, house.min.z + 1.6);
    let above = center + size * DVec3::new(0.4, -0.6, 0.5);
    [
        Camera::looking(above, center, 0.8),
        Camera::looking(street, house.center(), 1.2),
        studio::orthographic(above, center, 0.6 * size),
    ]
}

/// The view that a picture of the scene has.
pub fn view(camera: Camera, size: [u32; 2]) -> View {
    let all = veduta::geom::Aabb { min: camera.eye - 1e8, max: camera.eye + 1e8 };
    View::new(camera, size, &all).expect("a view")
}
