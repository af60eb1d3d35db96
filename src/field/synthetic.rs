//! A made-up field, by formula: the same to the bit on every machine.
//!
//! Only `+ - * /` and square roots are used, which all machines round alike, and an exponential function of its own.

use glam::DVec3;

use crate::field::{
    data::{Field, Step, Values},
    grid::{Grid, MOST_PER_AXIS, MOST_SAMPLES},
};

/// What is in clean air, in ppm.
const BACKGROUND: f64 = 420.0;
/// How high the field is, where it is 1 long and wide.
const HEIGHT: f64 = 0.25;
/// How long and wide it is, in metres, where a scene does not say it: as a town.
const LENGTH: f64 = 400.0;
/// The most that noise adds or takes, in ppm.
const NOISE: f64 = 3.0;
/// The direction of the wind, 1 long.
const WIND: [f64; 2] = [0.96, 0.28];

/// A stack: where it stands and ends, and how much comes out of it.
struct Stack {
    x: f64,
    y: f64,
    top: f64,
    rate: f64,
}

const STACKS: [Stack; 4] = [
    Stack { x: 0.12, y: 0.30, top: 0.060, rate: 1.00 },
    Stack { x: 0.22, y: 0.52, top: 0.035, rate: 0.55 },
    Stack { x: 0.38, y: 0.22, top: 0.080, rate: 0.80 },
    Stack { x: 0.55, y: 0.62, top: 0.045, rate: 0.65 },
];

/// Carbon dioxide over a city, in ppm: plumes from a few stacks that the wind carries, and smooth noise.
///
/// Its grid is 400 m long along x and y and 100 m high, and stands on the plane of z = 0 with the origin in its middle. Sizes are brought to 1 to 2048, and all to the most samples of a grid.
pub fn plume(size: [usize; 3]) -> Field {
    let [nx, ny, nz] = size.map(|n| n.clamp(1, MOST_PER_AXIS));
    let nz = nz.min(MOST_SAMPLES / (nx * ny)).max(1);
    let size = [nx, ny, nz];
    let step = |n: usize, length: f64| if n > 1 { length / (n - 1) as f64 } else { 1.0 };
    let steps = [step(nx, 1.0), step(ny, 1.0), step(nz, HEIGHT)];
    let mut values = Vec::with_capacity(nx * ny * nz);
    for z in 0..nz {
        for y in 0..ny {
            for x in 0..nx {
                let at = |n: usize, axis: usize, size: usize| if size > 1 { n as f64 * steps[axis] } else { 0.0 };
                values.push(concentration(at(x, 0, nx), at(y, 1, ny), at(z, 2, nz)) as f32);
            }
        }
    }
    let [dx, dy, dz] = steps;
    Field {
        name: "co2".into(),
        grid: Grid {
            size,
            origin: DVec3::new(-0.5, -0.5, 0.0) * LENGTH,
            steps: [DVec3::X * dx, DVec3::Y * dy, DVec3::Z * dz].map(|step| step * LENGTH),
        },
        components: 1,
        is_integer: false,
        unit: Some("ppm".into()),
        steps: vec![Step { time: None, values: Values::F32(values) }],
    }
}

fn concentration(x: f64, y: f64, z: f64) -> f64 {
    let plumes: f64 = STACKS.iter().map(|stack| from_stack(stack, x, y, z)).sum();
    BACKGROUND + plumes + NOISE * noise(x * 9.0, y * 9.0, z * 18.0)
}

/// A Gaussian plume, reflected by the ground.
fn from_stack(stack: &Stack, x: f64, y: f64, z: f64) -> f64 {
    let (dx, dy) = (x - stack.x, y - stack.y);
    let along = dx * WIND[0] + dy * WIND[1];
    if along <= 0.0 {
        return 0.0;
    }
    let across = dy * WIND[0] - dx * WIND[1];
    // It grows wider with the way, first fast, then slowly.
    let root = (1.0 + 2.0 * along).sqrt();
    let (wide, high) = (0.012 + 0.10 * along / root, 0.010 + 0.06 * along / root);
    let fall = |distance: f64, width: f64| exp_of_minus(distance * distance / (2.0 * width * width));
    let upright = fall(z - stack.top, high) + fall(z + stack.top, high);
    stack.rate * 0.03 / (wide * high) * fall(across, wide) * upright
}

/// e to the power of `-t`, for t of 0 or more.
fn exp_of_minus(t: f64) -> f64 {
    if t > 64.0 {
        return 0.0;
    }
    // 64 times the power of a 64th: u is at most 1.
    let u = t / 64.0;
    let mut sum = 1.0;
    for n in (1..=18).rev() {
        sum = 1.0 + sum * u / f64::from(n);
    }
    let mut power = 1.0 / sum;
    for _ in 0..6 {
        power *= power;
    }
    power
}

/// Smooth noise, -1 to 1.
fn noise(x: f64, y: f64, z: f64) -> f64 {
    let (x0, y0, z0) = (x.floor(), y.floor(), z.floor());
    let smooth = |t: f64| t * t * (3.0 - 2.0 * t);
    let (u, v, w) = (smooth(x - x0), smooth(y - y0), smooth(z - z0));
    let at = |dx: i64, dy: i64, dz: i64| lattice(x0 as i64 + dx, y0 as i64 + dy, z0 as i64 + dz);
    let mix = |a: f64, b: f64, t: f64| a + (b - a) * t;
    let on_x = |dy, dz| mix(at(0, dy, dz), at(1, dy, dz), u);
    let on_y = |dz| mix(on_x(0, dz), on_x(1, dz), v);
    mix(on_y(0), on_y(1), w)
}

/// A number of -1 to 1 for whole coordinates, by a fixed hash (the finish of SplitMix64).
fn lattice(x: i64, y: i64, z: i64) -> f64 {
    let mut hash = (x as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15)
        ^ (y as u64).wrapping_mul(0xc2b2_ae3d_27d4_eb4f)
        ^ (z as u64).wrapping_mul(0x1656_67b1_9e37_79f9);
    hash = (hash ^ hash >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    hash = (hash ^ hash >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    hash ^= hash >> 31;
    (hash >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::field::{Component, nrrd::Packing, write_nrrd};

    #[test]
    fn the_exponential_function_is_one() {
        for t in [0.0_f64, 1e-9, 0.5, 1.0, 7.25, 33.0, 63.9] {
            let wanted = (-t).exp();
            assert!((exp_of_minus(t) - wanted).abs() <= 1e-13 * wanted, "{t}");
        }
        assert_eq!(exp_of_minus(65.0), 0.0);
    }

    #[test]
    fn noise_is_smooth_and_bounded() {
        let at = |i: i32| noise(f64::from(i) * 0.01, 0.3, 7.7);
        assert!((0..2000).all(|i| at(i).abs() <= 1.0 && (at(i + 1) - at(i)).abs() < 0.04));
    }

    #[test]
    fn the_plume_is_the_same_everywhere() {
        let field = plume([32, 24, 16]);
        let found = field.scalar(0, Component::Magnitude);
        let [min, max] = found.range.unwrap();
        assert!(min >= 416.0 && max > 440.0 && max < 900.0, "{min} to {max}");
        assert_eq!(field.grid.bounds(), [DVec3::new(-200.0, -200.0, 0.0), DVec3::new(200.0, 200.0, 100.0)]);
        assert_eq!(found.missing, 0);
        let bytes = write_nrrd(&field, Packing::Raw);
        let hash =
            bytes.iter().fold(0xcbf2_9ce4_8422_2325_u64, |h, b| (h ^ u64::from(*b)).wrapping_mul(0x100_0000_01b3));
        assert_eq!(hash, 0x6d27_64f7_05a4_6da5, "{hash:#x}");
    }

    #[test]
    fn sizes_are_brought_into_the_limits() {
        assert_eq!(plume([0, 3, 1]).grid.size, [1, 3, 1]);
        assert_eq!(plume([1, 1, 9999]).grid.size, [1, 1, 2048]);
    }
}
