//! FLIP for low dynamic range: how different two pictures look to a person that flips between them, 0..1.
//!
//! After P. Andersson, J. Nilsson, T. Akenine-Möller, M. Oskarsson, K. Åström, M. D. Fairchild, *FLIP: A Difference
//! Evaluator for Alternating Images*, HPG 2020; section numbers below are the paper's.
//!
//! ```text
//! sRGB ─ YCxCz ─ blurred as the eye does (CSF) ─ L*a*b*, Hunt ─ HyAB ─ remapped ─> ΔE_c ┐
//!          └ Y ─ edges and points, in both pictures ─────────────────────────────> ΔE_f ┴ ΔE = ΔE_c^(1 − ΔE_f)
//! ```

use std::f64::consts::PI;

use rayon::prelude::*;

/// Pixels per degree of the paper's default viewer: a 0.7 m wide monitor of 3840 pixels, seen from 0.7 m (§6).
pub const PIXELS_PER_DEGREE: f64 = 0.7 * (3840.0 / 0.7) * PI / 180.0;

/// Contrast sensitivity, one row per channel of YCxCz: amplitude and width of two Gaussians (table 1), degrees².
const SENSITIVITY: [[[f64; 2]; 2]; 3] =
    [[[1.0, 0.0047], [0.0, 1e-5]], [[1.0, 0.0053], [0.0, 1e-5]], [[34.1, 0.04], [13.5, 0.025]]];
/// Exponent of the colour difference (§4.1).
const Q_C: f64 = 0.7;
/// Share of the largest difference below which the remapping is steep, and how much of 0..1 that part gets (§4.1).
const P_C: f64 = 0.4;
const P_T: f64 = 0.95;
/// Width of edge and point detectors, degrees, and the exponent of their difference (§4.2).
const FEATURE_WIDTH: f64 = 0.082;
const Q_F: f64 = 0.5;

/// The white of sRGB, D65, as the sum of the matrix' rows.
const WHITE: [f64; 3] = [0.950_428_545, 1.0, 1.088_900_371];
const XYZ_FROM_RGB: [[f64; 3]; 3] = [
    [10_135_552.0 / 24_577_794.0, 8_788_810.0 / 24_577_794.0, 4_435_075.0 / 24_577_794.0],
    [2_613_072.0 / 12_288_897.0, 8_788_810.0 / 12_288_897.0, 887_015.0 / 12_288_897.0],
    [1_425_312.0 / 73_733_382.0, 8_788_810.0 / 73_733_382.0, 70_074_185.0 / 73_733_382.0],
];

/// Mean FLIP of two sRGB pictures of `size`, row by row; alpha is ignored. 0: they look the same; 1: the most two can
/// differ. An empty picture, or pictures of other lengths than `size` says, give 0.
pub fn mean(size: [u32; 2], reference: &[[u8; 4]], test: &[[u8; 4]]) -> f64 {
    let map = map(size, reference, test, PIXELS_PER_DEGREE);
    if map.is_empty() { 0.0 } else { map.iter().sum::<f64>() / map.len() as f64 }
}

/// FLIP of every pixel, for a viewer that sees so many pixels per degree.
pub fn map(size: [u32; 2], reference: &[[u8; 4]], test: &[[u8; 4]], pixels_per_degree: f64) -> Vec<f64> {
    let pixels = size[0] as usize * size[1] as usize;
    if pixels == 0 || reference.len() != pixels || test.len() != pixels {
        return Vec::new();
    }
    let [a, b] = [reference, test].map(|picture| opponent_planes(size, picture));
    let colors = [&a, &b].map(|planes| perceived(planes, pixels_per_degree));
    let features = [&a, &b].map(|planes| features(&planes[0], pixels_per_degree));
    let largest = largest_color_difference();
    let flip = |i: usize| {
        let color = remapped(hyab(colors[0][i], colors[1][i]).powf(Q_C), largest);
        let [edge, point] = [0, 1].map(|k| (features[0][i][k] - features[1][i][k]).abs());
        let feature = (edge.max(point) / 2_f64.sqrt()).powf(Q_F).min(1.0);
        color.powf(1.0 - feature)
    };
    (0..pixels).map(flip).collect()
}

// --- colour -----------------------------------------------------------------------------------

fn linear_from_srgb(byte: u8) -> f64 {
    let v = f64::from(byte) / 255.0;
    if v <= 0.04045 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }
}

fn times(m: &[[f64; 3]; 3], v: [f64; 3]) -> [f64; 3] {
    m.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

fn ycxcz_from_rgb(rgb: [f64; 3]) -> [f64; 3] {
    let xyz = times(&XYZ_FROM_RGB, rgb);
    let [x, y, z] = [xyz[0] / WHITE[0], xyz[1] / WHITE[1], xyz[2] / WHITE[2]];
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

fn rgb_from_ycxcz([luma, cx, cz]: [f64; 3]) -> [f64; 3] {
    let y = (luma + 16.0) / 116.0;
    let xyz = [(y + cx / 500.0) * WHITE[0], y * WHITE[1], (y - cz / 200.0) * WHITE[2]];
    let m = glam::DMat3::from_cols_array_2d(&XYZ_FROM_RGB).transpose();
    (m.inverse() * glam::DVec3::from_array(xyz)).to_array()
}

/// L*a*b* with the Hunt effect: colours fade as they darken (§4.1).
fn hunt_lab(rgb: [f64; 3]) -> [f64; 3] {
    let xyz = times(&XYZ_FROM_RGB, rgb);
    let delta: f64 = 6.0 / 29.0;
    let f = |t: f64| if t > delta.powi(3) { t.cbrt() } else { t / (3.0 * delta * delta) + 4.0 / 29.0 };
    let [x, y, z] = [f(xyz[0] / WHITE[0]), f(xyz[1] / WHITE[1]), f(xyz[2] / WHITE[2])];
    let l = 116.0 * y - 16.0;
    [l, 0.01 * l * 500.0 * (x - y), 0.01 * l * 200.0 * (y - z)]
}

/// City-block in lightness, Euclidean in chroma.
fn hyab(a: [f64; 3], b: [f64; 3]) -> f64 {
    (a[0] - b[0]).abs() + (a[1] - b[1]).hypot(a[2] - b[2])
}

/// The largest difference of two colours of sRGB: green and blue (§4.1).
fn largest_color_difference() -> f64 {
    hyab(hunt_lab([0.0, 1.0, 0.0]), hunt_lab([0.0, 0.0, 1.0])).powf(Q_C)
}

/// Two straight lines: everyday differences take up most of 0..1 (§4.1).
fn remapped(difference: f64, largest: f64) -> f64 {
    let knee = P_C * largest;
    if difference < knee {
        P_T * difference / knee
    } else {
        (P_T + (1.0 - P_T) * (difference - knee) / (largest - knee)).min(1.0)
    }
}

/// Three planes, YCxCz.
fn opponent_planes(size: [u32; 2], picture: &[[u8; 4]]) -> [Plane; 3] {
    let width = size[0] as usize;
    let pixels: Vec<[f64; 3]> =
        picture.iter().map(|&[r, g, b, _]| ycxcz_from_rgb([r, g, b].map(linear_from_srgb))).collect();
    [0, 1, 2].map(|k| Plane { width, values: pixels.iter().map(|p| p[k]).collect() })
}

/// The colour of each pixel as the eye perceives it: blurred by its contrast sensitivity, then L*a*b* with Hunt.
fn perceived(planes: &[Plane; 3], pixels_per_degree: f64) -> Vec<[f64; 3]> {
    let blurred = [0, 1, 2].map(|k| blurred(&planes[k], SENSITIVITY[k], pixels_per_degree));
    let lab = |i: usize| {
        let rgb = rgb_from_ycxcz([0, 1, 2].map(|k: usize| blurred[k].values[i]));
        hunt_lab(rgb.map(|v| v.clamp(0.0, 1.0)))
    };
    (0..blurred[0].values.len()).map(lab).collect()
}

fn blurred(plane: &Plane, gaussians: [[f64; 2]; 2], pixels_per_degree: f64) -> Plane {
    let widest = SENSITIVITY.iter().flatten().map(|g| g[1]).fold(0.0, f64::max);
    let radius = (3.0 * (widest / (2.0 * PI * PI)).sqrt() * pixels_per_degree).ceil() as i32;
    let mut sum = Plane { width: plane.width, values: vec![0.0; plane.values.len()] };
    let mut weight = 0.0;
    // A sum of two Gaussians is not separable, but each of them is.
    for [amplitude, b] in gaussians.into_iter().filter(|g| g[0] > 0.0) {
        let tap = |x: i32| (-(PI * f64::from(x) / pixels_per_degree).powi(2) / b).exp();
        let kernel: Vec<f64> = (-radius..=radius).map(tap).collect();
        let scale = amplitude * (PI / b).sqrt();
        weight += scale * kernel.iter().sum::<f64>().powi(2);
        for (to, from) in sum.values.iter_mut().zip(plane.convolved(&kernel, &kernel).values) {
            *to += scale * from;
        }
    }
    sum.values.iter_mut().for_each(|v| *v /= weight);
    sum
}

// --- features ---------------------------------------------------------------------------------

/// The strength of an edge, and of a point, at every pixel (§4.2).
fn features(luma: &Plane, pixels_per_degree: f64) -> Vec<[f64; 2]> {
    let sigma = 0.5 * FEATURE_WIDTH * pixels_per_degree;
    let radius = (3.0 * sigma).ceil() as i32;
    let gaussian = |x: i32| (-f64::from(x * x) / (2.0 * sigma * sigma)).exp();
    let flat: Vec<f64> = (-radius..=radius).map(gaussian).collect();
    let edge = balanced((-radius..=radius).map(|x| -f64::from(x) * gaussian(x)).collect(), &flat);
    let point = |x: i32| (f64::from(x * x) / (sigma * sigma) - 1.0) * gaussian(x);
    let point = balanced((-radius..=radius).map(point).collect(), &flat);
    let normalized = Plane { width: luma.width, values: luma.values.iter().map(|y| (y + 16.0) / 116.0).collect() };
    let found = [edge, point].map(|kernel| {
        let [x, y] = [normalized.convolved(&kernel, &flat), normalized.convolved(&flat, &kernel)];
        x.values.into_iter().zip(y.values).map(|(x, y)| x.hypot(y)).collect::<Vec<_>>()
    });
    found[0].iter().zip(&found[1]).map(|(e, p)| [*e, *p]).collect()
}

/// Scales a kernel so that, times `across`, what is positive sums to 1 and what is negative to −1.
fn balanced(kernel: Vec<f64>, across: &[f64]) -> Vec<f64> {
    let across: f64 = across.iter().sum();
    let sum = |sign: f64| kernel.iter().map(|v| (v * sign).max(0.0)).sum::<f64>() * across;
    let (positive, negative) = (sum(1.0), sum(-1.0));
    kernel.into_iter().map(|v| v / if v > 0.0 { positive } else { negative }).collect()
}

/// One channel, row by row.
struct Plane {
    width: usize,
    values: Vec<f64>,
}

impl Plane {
    /// Convolved along x, then along y; beyond its border the plane goes on as it ends.
    fn convolved(&self, along_x: &[f64], along_y: &[f64]) -> Self {
        self.rows_convolved(along_x).transposed().rows_convolved(along_y).transposed()
    }

    fn rows_convolved(&self, kernel: &[f64]) -> Self {
        let radius = kernel.len() / 2;
        let mut values = vec![0.0; self.values.len()];
        values.par_chunks_mut(self.width).zip(self.values.par_chunks(self.width)).for_each(|(to, from)| {
            let [Some(&first), Some(&last)] = [from.first(), from.last()] else { return };
            let mut padded = vec![first; radius];
            padded.extend_from_slice(from);
            padded.resize(from.len() + 2 * radius, last);
            for (to, around) in to.iter_mut().zip(padded.windows(kernel.len())) {
                *to = around.iter().zip(kernel).map(|(value, weight)| value * weight).sum();
            }
        });
        Self { width: self.width, values }
    }

    fn transposed(&self) -> Self {
        let (width, height) = (self.width, self.values.len() / self.width);
        let values = (0..self.values.len()).map(|i| self.values[i % height * width + i / height]).collect();
        Self { width: height, values }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: [u32; 2] = [48, 32];

    fn filled(color: [u8; 3]) -> Vec<[u8; 4]> {
        vec![[color[0], color[1], color[2], 255]; (SIZE[0] * SIZE[1]) as usize]
    }

    /// A picture with edges, dots and colours.
    fn pattern(seed: u32) -> Vec<[u8; 4]> {
        let pixel = |i: u32| {
            let (x, y) = (i % SIZE[0], i / SIZE[0]);
            let dot = if (x * 7 + y * 13 + seed).is_multiple_of(29) { 255 } else { 40 };
            [(x * 5 + seed) as u8, dot, if y > 15 { 200 } else { (seed * 3) as u8 }, 255]
        };
        (0..SIZE[0] * SIZE[1]).map(pixel).collect()
    }

    #[test]
    fn equal_pictures_do_not_differ() {
        assert_eq!(mean(SIZE, &pattern(1), &pattern(1)), 0.0);
        assert_eq!(mean([0, 0], &[], &[]), 0.0);
        assert!(map(SIZE, &pattern(1), &pattern(1)[1..], PIXELS_PER_DEGREE).is_empty());
    }

    #[test]
    fn whole_pictures_of_one_colour() {
        // Green and blue differ the most of all colours: 1 by construction.
        let most = mean(SIZE, &filled([0, 255, 0]), &filled([0, 0, 255]));
        assert!((most - 1.0).abs() < 1e-6, "{most}");
        // Black and white: HyAB 100, so 0.95 + 0.05 (100^0.7 − 0.4 c) / (0.6 c) with c = 41.2760, worked out by hand
        // from L*a*b* of green (87.735, −86.183, 83.179) and blue (32.297, 79.188, −107.860). The authors' program
        // says 0.967399: in single precision its feature detectors do not quite sum to 0.
        let contrast = mean(SIZE, &filled([0; 3]), &filled([255; 3]));
        assert!((contrast - 0.96738).abs() < 1e-5, "{contrast}");
        // A step of one level of 255 is next to nothing.
        let step = mean(SIZE, &filled([128; 3]), &filled([129; 3]));
        assert!(step > 0.0 && step < 0.03, "{step}");
    }

    /// Compares with the authors' own program (flip-evaluator 1.7, LDR, default viewer) on the same two pictures.
    #[test]
    fn it_is_what_its_authors_compute() {
        let found = map(SIZE, &pattern(1), &pattern(9), PIXELS_PER_DEGREE);
        let at = |x: u32, y: u32| found[(y * SIZE[0] + x) as usize];
        for (value, theirs) in [
            (mean(SIZE, &pattern(1), &pattern(9)), 0.317674),
            (at(0, 0), 0.567569),
            (at(24, 16), 0.563715),
            (at(47, 31), 0.166417),
            (at(30, 5), 0.298956),
        ] {
            // Theirs is single precision.
            assert!((value - theirs).abs() < 2e-5, "{value} is not {theirs}");
        }
    }

    #[test]
    fn it_is_symmetric() {
        let (a, b) = (pattern(1), pattern(9));
        let (one, other) = (map(SIZE, &a, &b, PIXELS_PER_DEGREE), map(SIZE, &b, &a, PIXELS_PER_DEGREE));
        assert!(one.iter().zip(&other).all(|(x, y)| (x - y).abs() < 1e-12));
        assert!(one.iter().all(|v| (0.0..=1.0).contains(v)));
    }

    #[test]
    fn one_wrong_dot_is_seen_around_it_and_not_far_away() {
        let a = filled([90, 120, 150]);
        let mut b = a.clone();
        let at = (16 * SIZE[0] + 24) as usize;
        b[at] = [255, 120, 150, 255];
        let found = map(SIZE, &a, &b, PIXELS_PER_DEGREE);
        let most = found.iter().copied().fold(0.0, f64::max);
        assert!(most > 0.1, "{most}");
        assert!(found[at] > 0.5 * most);
        assert!(found[0] < 1e-9 && found[found.len() - 1] < 1e-9);
    }
}
