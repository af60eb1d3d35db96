//! Case 8: view rays that graze a sphere, a cylinder or an edge of a box: never NaN, and a wrong answer only inside the
//! stated band. Oracle: the sign of the discriminant, and the slab test, in `i128`.

use glam::{DQuat, DVec3};
use veduta::{
    geom::{Ray, Shape},
    lens::Class,
    view::Camera,
};

use crate::{
    lenses::{painted, painted_class},
    oracle::{Numbers, P3},
    studio,
};

fn dot(a: P3, b: P3) -> i128 {
    (0..3).map(|i| i128::from(a[i]) * i128::from(b[i])).sum()
}

/// Of the line o + t·d and a ball of radius r around 0, times a positive number: positive where the line passes through it.
fn discriminant(o: P3, d: P3, r: i64) -> i128 {
    let along = dot(o, d);
    along * along - dot(d, d) * (dot(o, o) - i128::from(r) * i128::from(r))
}

/// The same for a cylinder along z: of what lies across it.
fn discriminant_across(o: P3, d: P3, r: i64) -> i128 {
    discriminant([o[0], o[1], 0], [d[0], d[1], 0], r)
}

/// Whether the half-line o + t·d passes through the inside of a box between -half and half.
fn passes_box(o: P3, d: P3, half: P3) -> bool {
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

/// In f64: rays that pass a body within a millionth of its size, most of them nearer. The band here is 8 ulp of the largest
/// length.
#[test]
fn the_f64_tests_say_what_the_discriminant_says() {
    let mut numbers = Numbers(8);
    let (mut grazed, mut decided) = (0, 0);
    for _ in 0..60_000 {
        // Whole numbers up to 4e8: f64 holds them, and i128 their discriminants.
        let d = [0; 3].map(|_: i64| numbers.below(2001) - 1000);
        let other = [0; 3].map(|_: i64| numbers.below(2001) - 1000);
        // Across the ray.
        let out = [0, 1, 2].map(|i| d[(i + 1) % 3] * other[(i + 2) % 3] - d[(i + 2) % 3] * other[(i + 1) % 3]);
        let steps = numbers.below(40_000) - 20_000;
        let near: P3 = [0, 1, 2].map(|i| 20 * out[i] + numbers.below(3) - 1);
        let o = [0, 1, 2].map(|i| near[i] + steps * d[i]);
        let length = (dot(near, near) as f64).sqrt();
        let r = length.round() as i64 + numbers.below(3) - 1;
        if d[0] == 0 && d[1] == 0 || r < 1000 {
            continue;
        }
        let vector = |p: P3| DVec3::from(p.map(|c| c as f64));
        let ray = Ray { origin: vector(o), direction: vector(d) };
        let across =
            ((i128::from(near[0]) * i128::from(near[0]) + i128::from(near[1]) * i128::from(near[1])) as f64).sqrt();
        let r_across = across.round() as i64;
        let largest = vector(o).length().max(length);
        let band = 8.0 * f64::EPSILON * largest;
        let ball = Shape::Sphere { center: DVec3::ZERO, radius: r as f64 };
        let tower = Shape::Cylinder { center: DVec3::ZERO, radius: r_across as f64, height: 1e12, axis: DVec3::Z };
        for (shape, discriminant, d) in
            [(ball, discriminant(o, d, r), d), (tower, discriminant_across(o, d, r_across), [d[0], d[1], 0])]
        {
            let found = shape.volume().expect("a volume").entry_exit(&ray);
            assert!(found.is_none_or(|(enter, exit)| enter < exit && enter.is_finite() && exit.is_finite()));
            // How far inside or outside the ray passes: r − q = (r² − q²) / (r + q).
            let size =
                if let Shape::Sphere { radius, .. } | Shape::Cylinder { radius, .. } = shape { radius } else { 0.0 };
            let inside_by = discriminant as f64 / dot(d, d) as f64 / (2.0 * size);
            grazed += u32::from(inside_by.abs() < 1.0);
            if inside_by.abs() > band {
                decided += 1;
                assert_eq!(found.is_some(), discriminant > 0, "{shape:?} {ray:?}: inside by {inside_by}");
            }
        }
    }
    assert!(grazed > 20_000 && decided > 80_000, "{grazed} graze, {decided} are outside the band");
}

const SIZE: [u32; 2] = [160, 120];
/// A metre: 240 because pixels' rays leave a facade k metres away at multiples of k/240 m, and fine enough for the band.
const METRE: i64 = 240 << 24;

fn metres(p: P3) -> DVec3 {
    DVec3::from(p.map(|c| c as f64)) / METRE as f64
}

/// The direction of a pixel's ray, times 240: half the picture is as high as half its distance.
fn direction(x: i64, y: i64) -> P3 {
    [2 * x + 1 - i64::from(SIZE[0]), 2 * i64::from(SIZE[1]), i64::from(SIZE[1]) - 2 * y - 1]
}

/// Whether a half-line passes through a body that is larger by so much on all sides.
type Passes = Box<dyn Fn(P3, P3, i64) -> bool>;

/// Before a wall, a body whose outline passes through the middle of pixels.
fn body(kind: usize, numbers: &mut Numbers) -> (P3, Shape, Passes) {
    let (x, y) = (20 + numbers.below(120), 15 + numbers.below(90));
    let [dx, dy, dz] = direction(x, y);
    let far = 2 + numbers.below(3);
    // On this pixel's ray, `far` metres before the eye.
    let on_ray = [dx, dy, dz].map(|c| c * far * (METRE / 240));
    let aside = |numbers: &mut Numbers| (numbers.below(120) + 40) * (METRE / 240);
    match kind {
        0 | 1 => {
            // As large as the ray passes by, to the last unit.
            let sign = [1, -1][numbers.below(2) as usize];
            let mut center = [on_ray[0] + sign * aside(numbers), on_ray[1], on_ray[2] + aside(numbers)];
            if kind == 1 {
                center[2] = 0;
            }
            let flat = |p: P3| if kind == 1 { [p[0], p[1], 0] } else { p };
            let (c, d) = (flat(center), flat([dx, dy, dz]));
            let along = dot(c, d) as f64 / dot(d, d) as f64;
            let passes_at = DVec3::from([0, 1, 2].map(|i| c[i] as f64 - along * d[i] as f64)).length();
            let radius = passes_at.round() as i64;
            let place = metres(center) + EYE;
            let radius_m = radius as f64 / METRE as f64;
            if kind == 0 {
                let passes = move |o: P3, d: P3, by: i64| discriminant(o, d, radius + by) > 0;
                (center, Shape::Sphere { center: place, radius: radius_m }, Box::new(passes))
            } else {
                // Taller than the picture.
                let tower = Shape::Cylinder { center: place, radius: radius_m, height: 40.0, axis: DVec3::Z };
                (center, tower, Box::new(move |o: P3, d: P3, by: i64| discriminant_across(o, d, radius + by) > 0))
            }
        }
        _ => {
            // A corner of its front on the ray: two of its edges pass through a column and a row of pixels.
            let half = [aside(numbers), aside(numbers) / 8, aside(numbers)];
            let center = [on_ray[0] + half[0], on_ray[1] + half[1], on_ray[2] - half[2]];
            let shape =
                Shape::Box { center: metres(center) + EYE, size: 2.0 * metres(half), rotation: DQuat::IDENTITY };
            (center, shape, Box::new(move |o: P3, d: P3, by: i64| passes_box(o, d, half.map(|h| h + by))))
        }
    }
}

const EYE: DVec3 = DVec3::new(5.0, -6.0, 5.0);

#[test]
fn every_pixel_beside_an_outline_has_its_class() {
    // Nothing but the facade y = 0 of a cube.
    let mut studio = studio::studio(&[studio::citydata("cube.city.json")]);
    let camera = Camera::looking(EYE, EYE + DVec3::Y, 2.0 * 0.5_f64.atan());
    let mut numbers = Numbers(88);
    let (mut grazed, mut behind, mut missed) = (0, 0, 0);
    for round in 0..90 {
        let (center, shape, passes) = body(round % 3, &mut numbers);
        let volume = shape.volume().expect("a volume");
        let scene = studio::scene(camera, vec![painted(vec![shape.clone()])]);
        let drawn = studio::picture(&mut studio, &scene, SIZE);
        assert!(drawn.object_id.as_ref().expect("ids").iter().all(|&id| id == 1), "the facade fills the picture");
        // The wall is the farthest.
        let slant = metres(direction(0, 0)).length() / metres([0, 240, 0]).length();
        let band = 8.0 * 2_f64.powi(-23) * (6.0 * slant).max(volume.bounds().center().distance(EYE));
        let by = (band * METRE as f64).ceil() as i64;
        let from = center.map(|c| -c);
        for (i, &color) in drawn.rgba.iter().enumerate() {
            let (x, y) = (i as i64 % i64::from(SIZE[0]), i as i64 / i64::from(SIZE[0]));
            let d = direction(x, y);
            let is_behind = match painted_class(color) {
                Some(Class::Behind) => true,
                Some(Class::Rest) => false,
                other => panic!("{shape:?}: pixel {x},{y} is {color:?}: {other:?}"),
            };
            match (passes(from, d, -by), passes(from, d, by)) {
                (true, true) => assert!(is_behind, "{shape:?}: the ray of pixel {x},{y} goes through it"),
                (false, false) => assert!(!is_behind, "{shape:?}: the ray of pixel {x},{y} misses it"),
                _ => grazed += 1,
            }
            behind += u32::from(is_behind);
            missed += u32::from(!is_behind);
        }
    }
    assert!(grazed > 2_000 && behind > 100_000 && missed > 100_000, "{grazed} {behind} {missed}");
}
