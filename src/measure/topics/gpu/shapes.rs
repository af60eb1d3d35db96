//! Lenses of every analytic shape, and what they hold by the definitions of the shapes alone, in f64.

use std::collections::BTreeMap;

use glam::{DMat3, DQuat, DVec2, DVec3};

use crate::{
    geom::{Shape, Volume},
    lens::{Class, EffectUse, Lens, Parameter, Region, classify},
    measure::topics::gpu::{
        check::Findings,
        looks::{bit, column_row, depths, lens, used},
        numbers::Numbers,
    },
    render::picture::{Picture, RenderError},
    view::View,
};

/// Kinds that [`shape`] makes.
pub const KINDS: usize = 9;

/// A shape of one of [`KINDS`], about `r` metres large, turned and stretched at random.
pub fn shape(kind: usize, center: DVec3, r: f64, numbers: &mut Numbers) -> Shape {
    let axis = numbers.direction();
    let rotation = DQuat::from_axis_angle(axis, 6.0 * numbers.share());
    let mut size = || r * (0.3 + 0.7 * numbers.share());
    let sizes = DVec3::new(size(), size(), size());
    match kind % KINDS {
        0 => Shape::Sphere { center, radius: sizes.x },
        1 => Shape::Box { center, size: 2.0 * sizes, rotation },
        2 => Shape::Cylinder { center, radius: sizes.x, height: 2.0 * sizes.y, axis },
        3 => Shape::Ellipsoid { center, radii: sizes, rotation },
        4 => Shape::Frustum { center, radius: sizes.x, top_radius: 0.0, height: 2.0 * sizes.y, axis },
        5 => Shape::Frustum { center, radius: sizes.x, top_radius: sizes.z, height: 2.0 * sizes.y, axis },
        6 => slanting_box(center, rotation, sizes),
        7 => cut_octahedron(center, rotation, sizes.x),
        _ => {
            let way = sizes * numbers.in_cube().with_z(0.3 * numbers.share());
            let level = DVec3::new(-way.y, way.x, 0.0);
            let points = vec![center - way, center, center + level];
            Shape::Corridor { points, width: 0.6 * sizes.x, height: sizes.z }
        }
    }
}

/// -1 or 1, as a bit of a corner's number says.
fn side(corner: u32, bit: u32) -> f64 {
    if corner >> bit & 1 == 0 { -1.0 } else { 1.0 }
}

fn slanting_box(center: DVec3, rotation: DQuat, sizes: DVec3) -> Shape {
    let axes = DMat3::from_quat(rotation);
    let (a, b, c) = (axes.x_axis * sizes.x, axes.y_axis * sizes.y, (axes.z_axis + 0.4 * axes.x_axis) * sizes.z);
    let points = (0..8).map(|i| center + side(i, 0) * a + side(i, 1) * b + side(i, 2) * c);
    Shape::Convex { points: points.collect() }
}

/// An octahedron with two of its tips cut off; its normals have any length.
fn cut_octahedron(center: DVec3, rotation: DQuat, r: f64) -> Shape {
    let corner = |i: u32| DVec3::new(side(i, 0), side(i, 1), side(i, 2));
    let mut planes: Vec<(DVec3, f64)> = (0..8).map(|i| (rotation * corner(i), 3_f64.sqrt() * r)).collect();
    planes.extend([DVec3::X, -DVec3::Z].map(|n| (rotation * n, r)));
    let plane = |(normal, d): (DVec3, f64)| [normal.x, normal.y, normal.z, d + normal.dot(center)];
    Shape::Polytope { planes: planes.into_iter().map(plane).collect() }
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
        Shape::Form(volume) => volume.contains(p),
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
        // What an eye sees through it: no place is in it by itself.
        Shape::Flat { .. } => false,
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

/// The stated band of an analytic test around a volume, metres, for a place at distance D: 8 · 2⁻²³ · max(D, |centre − eye|), and what the
/// adapter may move corners by ([`crate::gpu::Gpu::snapping`], pixels) at that distance.
pub fn band(volume: &Volume, view: &View, d: f64, snapping: f64) -> f64 {
    let reach = d.max(volume.bounds().center().distance(view.camera.eye));
    8.0 * 2_f64.powi(-23) * reach + snapping * view.pixel_m(d.clamp(0.0, 1e30))
}

/// The volumes of all shapes of a lens.
///
/// # Errors
/// Shapes that have none.
pub fn volumes(lens: &Lens) -> Result<Vec<Volume>, RenderError> {
    let of = |focus: &Region| focus.volumes().map_err(RenderError::Scene);
    Ok(lens.shapes.iter().map(of).collect::<Result<Vec<_>, _>>()?.concat())
}

/// Asks of every pixel whether its bit is what the shapes of the lens hold at the shown place, outside the band.
///
/// # Errors
/// Shapes without volumes.
pub fn ask_mask(
    found: &mut Findings,
    picture: &Picture,
    view: &View,
    lens: &Lens,
    number: usize,
) -> Result<(), RenderError> {
    let (volumes, snapping) = (volumes(lens)?, found.snapping);
    for (i, &d) in depths(picture).iter().enumerate() {
        let d = f64::from(d);
        let [x, y] = column_row(picture.size, i);
        let is_in = bit(picture, number, i);
        let p = view.pixel_ray(x, y).at(d);
        let right = d.is_finite() && lens.shapes.iter().any(|s| matches!(s, Region::Shape(s) if holds(s, p)));
        let beyond = |v: &Volume| v.signed_distance(p).abs() - band(v, view, d, snapping);
        let least = || volumes.iter().map(beyond).fold(f64::INFINITY, f64::min);
        let is_right = d > 0.0 && (is_in == right || d.is_finite() && least() <= 0.0);
        found.ask(is_right, || {
            format!("{}: pixel {x},{y} at {d} m is in the lens: {is_in}; {} m beyond the band", lens.name, least())
        });
    }
    Ok(())
}

/// The colours that [`painted`] paints the classes in.
const COLORS: [(Class, &str, [u8; 4]); 4] = [
    (Class::Inside, "#ffffff", [255, 255, 255, 255]),
    (Class::Front, "#ff0000", [255, 0, 0, 255]),
    (Class::Behind, "#00ff00", [0, 255, 0, 255]),
    (Class::Rest, "#0000ff", [0, 0, 255, 255]),
];

/// A lens that paints each class in its own colour.
pub fn painted(name: &str, shape: Shape) -> Lens {
    let paint = |(class, color, _): (Class, &str, _)| EffectUse {
        class,
        parameters: BTreeMap::from([
            ("color".to_owned(), Parameter::Text(color.to_owned())),
            ("opacity".to_owned(), Parameter::Number(1.0)),
        ]),
        ..used("overlay")
    };
    Lens { effects: COLORS.map(paint).to_vec(), ..lens(name, shape, "sepia") }
}

/// The class that a pixel was painted as.
pub fn painted_class(color: [u8; 4]) -> Option<Class> {
    COLORS.iter().find(|(_, _, painted)| *painted == color).map(|(class, ..)| *class)
}

/// The classes that a place at D on a ray may have, where a ray within a thousandth of a pixel, and ends within the band,
/// could be meant.
pub fn possible_classes(volume: &Volume, view: &View, at: DVec2, d: f64, snapping: f64) -> Vec<Class> {
    let mut classes = Vec::new();
    for (i, j) in (-1..=1).flat_map(|j| (-1..=1).map(move |i| (i, j))) {
        let ray = view.ray(at + 1e-3 * DVec2::new(f64::from(i), f64::from(j)));
        let slack = band(volume, view, d, snapping);
        let span = volume.entry_exit(&ray);
        // Where the ray goes along a face, what is near it may be far from the end.
        let near = (volume.signed_distance(ray.at(d)).abs() <= slack).then_some(Class::Inside);
        let of_moved = |by: f64| {
            let moved: Vec<(f64, f64)> = span.iter().map(|(enter, exit)| (enter - by, exit + by)).collect();
            classify(&moved, d)
        };
        for class in [-slack, 0.0, slack].map(of_moved).into_iter().chain(near) {
            if !classes.contains(&class) {
                classes.push(class);
            }
        }
    }
    classes
}
