//! View rays that graze a sphere, a cylinder and the edges of a box.

use glam::{DQuat, DVec3};

use crate::{
    geom::Shape,
    lens::Class,
    measure::topics::gpu::{
        check::{Check, Findings},
        cities::{block, numbered, of_solids},
        looks::{column_row, picture, scene},
        numbers::Numbers,
        shapes::{painted, painted_class},
    },
    render::picture::RenderError,
    view::Camera,
};

/// See the module.
pub const CHECK: Check = Check {
    name: "grazing rays",
    case: "8",
    property: "a ray that passes an outline outside the stated band is a hit or a miss as the discriminant says",
    oracle: "the discriminant's sign and the slab test, in i128",
    unit: "pixels",
    least: 100_000,
    run,
};

const SIZE: [u32; 2] = [160, 120];
const EYE: DVec3 = DVec3::new(5.0, -6.0, 5.0);
/// A metre: 240 because pixels' rays leave a facade k metres away at multiples of k/240 m, and fine enough for the band.
const METRE: i64 = 240 << 24;

type Whole = [i64; 3];

fn dot(a: Whole, b: Whole) -> i128 {
    (0..3).map(|i| i128::from(a[i]) * i128::from(b[i])).sum()
}

/// The discriminant of the line o + t·d and a ball of radius r around 0, times a positive number: positive where the line passes through it.
fn discriminant(o: Whole, d: Whole, r: i64) -> i128 {
    let along = dot(o, d);
    along * along - dot(d, d) * (dot(o, o) - i128::from(r) * i128::from(r))
}

/// Whether the half-line o + t·d passes through the inside of a box between -half and half.
fn passes_box(o: Whole, d: Whole, half: Whole) -> bool {
    // t in (near, far), as numerator / positive denominator.
    let (mut near, mut far) = ((0_i128, 1_i128), None::<(i128, i128)>);
    for i in 0..3 {
        let (low, high, by) = (i128::from(-half[i] - o[i]), i128::from(half[i] - o[i]), i128::from(d[i]));
        if by == 0 {
            if low >= 0 || high <= 0 {
                return false;
            }
            continue;
        }
        let (low, high) = if by > 0 { (low, high) } else { (-high, -low) };
        let (enter, leave) = ((low, by.abs()), (high, by.abs()));
        if enter.0 * near.1 > near.0 * enter.1 {
            near = enter;
        }
        if far.is_none_or(|far| leave.0 * far.1 < far.0 * leave.1) {
            far = Some(leave);
        }
    }
    far.is_none_or(|far| near.0 * far.1 < far.0 * near.1)
}

fn metres(p: Whole) -> DVec3 {
    DVec3::from(p.map(|c| c as f64)) / METRE as f64
}

/// The direction of a pixel's ray, times 240: half the picture is as high as half its distance.
fn direction(x: i64, y: i64) -> Whole {
    [2 * x + 1 - i64::from(SIZE[0]), 2 * i64::from(SIZE[1]), i64::from(SIZE[1]) - 2 * y - 1]
}

/// A body about a place before the eye, in units of 1/[`METRE`].
enum Body {
    Ball(i64),
    /// Upright, higher than the picture.
    Tower(i64),
    /// Half its edges.
    Block(Whole),
}

impl Body {
    /// Whether a half-line passes through it, were it larger by so much on all sides.
    fn passes(&self, o: Whole, d: Whole, by: i64) -> bool {
        match self {
            Self::Ball(radius) => discriminant(o, d, radius + by) > 0,
            Self::Tower(radius) => discriminant([o[0], o[1], 0], [d[0], d[1], 0], radius + by) > 0,
            Self::Block(half) => passes_box(o, d, half.map(|h| h + by)),
        }
    }

    fn shape(&self, center: Whole) -> Shape {
        let center = metres(center) + EYE;
        let metres_of = |length: i64| length as f64 / METRE as f64;
        match self {
            Self::Ball(radius) => Shape::Sphere { center, radius: metres_of(*radius) },
            Self::Tower(radius) => Shape::Cylinder { center, radius: metres_of(*radius), height: 40.0, axis: DVec3::Z },
            Self::Block(half) => Shape::Box { center, size: 2.0 * metres(*half), rotation: DQuat::IDENTITY },
        }
    }
}

/// Before a wall, a body whose outline passes through the middle of pixels, and where it is.
fn body(kind: usize, numbers: &mut Numbers) -> (Whole, Body) {
    let [dx, dy, dz] = direction(20 + numbers.below(120), 15 + numbers.below(90));
    let far = 2 + numbers.below(3);
    // On this pixel's ray, `far` metres before the eye.
    let on_ray = [dx, dy, dz].map(|c| c * far * (METRE / 240));
    let mut aside = || (numbers.below(120) + 40) * (METRE / 240);
    if kind == 2 {
        // A corner of its front on the ray: two of its edges pass through a column and a row of pixels.
        let half = [aside(), aside() / 8, aside()];
        return ([on_ray[0] + half[0], on_ray[1] + half[1], on_ray[2] - half[2]], Body::Block(half));
    }
    // As large as the ray passes by, to the last unit.
    let mut center = [on_ray[0] + aside(), on_ray[1], on_ray[2] + aside()];
    let mut d = [dx, dy, dz];
    if kind == 1 {
        (center[2], d[2]) = (0, 0);
    }
    let along = dot(center, d) as f64 / dot(d, d) as f64;
    let passes_at = DVec3::from([0, 1, 2].map(|i| center[i] as f64 - along * d[i] as f64)).length();
    let radius = passes_at.round() as i64;
    (center, if kind == 0 { Body::Ball(radius) } else { Body::Tower(radius) })
}

fn run(found: &mut Findings) -> Result<(), RenderError> {
    // Nothing but the facade y = 0 of a cube.
    let mut studio = of_solids(DVec3::ZERO, &numbered([block([0, 0, 0], [10_000, 10_000, 10_000])]))?;
    let camera = Camera::looking(EYE, EYE + DVec3::Y, 2.0 * 0.5_f64.atan());
    let mut numbers = Numbers(88);
    // The wall is the farthest.
    let slant = metres(direction(0, 0)).length() / metres([0, 240, 0]).length();
    for round in 0..18 {
        let (center, body) = body(round % 3, &mut numbers);
        let shape = body.shape(center);
        let Ok(volume) = shape.volume() else { continue };
        let band = 8.0 * 2_f64.powi(-23) * (6.0 * slant).max(volume.bounds().center().distance(EYE));
        let by = (band * METRE as f64).ceil() as i64;
        let drawn = picture(&mut studio, &scene(camera, vec![painted("grazed", shape)]), SIZE)?;
        for (i, &color) in drawn.rgba.iter().enumerate() {
            let [x, y] = column_row(SIZE, i).map(i64::from);
            let d = direction(x, y);
            let class = painted_class(color);
            let from = center.map(|c| -c);
            let is_right = match [-by, by].map(|by| body.passes(from, d, by)) {
                [true, true] => class == Some(Class::Behind),
                [false, false] => class == Some(Class::Rest),
                _ => matches!(class, Some(Class::Behind | Class::Rest)),
            };
            found.ask(is_right, || format!("body {round}, pixel {x},{y} is {class:?}, {color:?}"));
        }
        if !found.goes_on() {
            break;
        }
    }
    Ok(())
}
