//! The scenes after figures of Trapp, Tiesel, and Ropinski and Hinrichs show what those captions say, point by point.
//!
//! What is inside a lens is found here from depth and f64 geometry, not from the lens' own mask; what a style must make of
//! a pixel, from the picture of the same scene without lenses.

#![allow(clippy::print_stdout, reason = "what was measured, for those who ask with --no-capture")]

use std::{collections::BTreeMap, path::Path};

use crate::studio::*;
use glam::DVec3;
use veduta::{
    figure::scene_file::{self, Options},
    geom::{Aabb, Shape},
    lens::{EffectUse, LensBody, Parameter, Region, color},
    render::picture::{Picture, Studio},
    scene::{Scene, Sun},
    view::View,
};

const SIZE: [u32; 2] = [640, 360];

/// A shipped scene, without outlines, and its city.
struct Stage {
    scene: Scene,
    studio: Studio,
    plain: Picture,
    /// Where each pixel is: inside the volumes of a lens, around them, or too near to a border to say.
    places: Vec<Vec<Place>>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Place {
    Inside,
    Around,
    Border,
}

impl Stage {
    fn new(name: &str) -> Self {
        Self::changed(name, |_| ())
    }

    fn changed(name: &str, change: impl FnOnce(&mut Scene)) -> Self {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(format!("{name}.toml"));
        let mut scene = scene_file::read(&path, &Options::for_file(&path)).expect("a scene");
        scene.lenses.iter_mut().for_each(|lens| lens.body = LensBody::None);
        change(&mut scene);
        let mut studio = with_full_shadows(of_scene(&scene));
        let plain = picture(&mut studio, &Scene { lenses: vec![], ..scene.clone() }, SIZE);
        let places = (0..scene.lenses.len()).map(|i| places(&scene, &plain, i)).collect();
        Self { scene, studio, plain, places }
    }

    fn draw(&mut self) -> Picture {
        picture(&mut self.studio, &self.scene, SIZE)
    }

    /// The scene's picture with one change, which is taken back.
    fn draw_with(&mut self, change: impl FnOnce(&mut Scene)) -> Picture {
        let mut scene = self.scene.clone();
        change(&mut scene);
        picture(&mut self.studio, &scene, SIZE)
    }

    /// Pixels at a place of the first lens, at least a thousand.
    fn pixels(&self, place: Place) -> Vec<usize> {
        let pixels: Vec<usize> = (0..self.places[0].len()).filter(|&i| self.places[0][i] == place).collect();
        assert!(pixels.len() > 1000, "{place:?}: {}", pixels.len());
        pixels
    }

    /// Of some pixels those in which the plain picture is not cut at white, nearly all: lamps are brighter.
    fn not_cut(&self, pixels: &[usize]) -> impl Iterator<Item = usize> {
        let is_whole = |i: &usize| !self.plain.rgba[*i][..3].contains(&255);
        let whole: Vec<usize> = pixels.iter().copied().filter(is_whole).collect();
        assert!(whole.len() * 500 > pixels.len() * 499, "{} of {}", whole.len(), pixels.len());
        whole.into_iter()
    }

    /// Whether these pixels are as without any lens.
    fn assert_unchanged(&self, picture: &Picture, place: Place) {
        let changed = self.pixels(place).into_iter().filter(|&i| picture.rgba[i] != self.plain.rgba[i]).count();
        assert_eq!(changed, 0, "pixels {place:?} changed");
    }

    /// As [`Self::assert_unchanged`] of what is around the lens, but for what lines that begin in it reach over.
    fn assert_unchanged_beside_lines(&self, picture: &Picture) {
        const REACH: i64 = 3;
        let [w, h] = SIZE.map(i64::from);
        let is_far = |i: usize| {
            let (x, y) = (i as i64 % w, i as i64 / w);
            let beside = (-REACH..=REACH).flat_map(|dy| (-REACH..=REACH).map(move |dx| (x + dx, y + dy)));
            let mut seen = beside.filter(|(x, y)| (0..w).contains(x) && (0..h).contains(y));
            seen.all(|(x, y)| self.places[0][(y * w + x) as usize] == Place::Around)
        };
        let changed = self.pixels(Place::Around).into_iter().filter(|&i| picture.rgba[i] != self.plain.rgba[i]);
        // Edges of what is thinner than a pixel are drawn where no pixel's middle met it.
        let changed = changed.filter(|&i| is_far(i)).count();
        assert!(changed < 20, "{changed} pixels around changed");
    }

    fn view(&self) -> View {
        view_of(&self.scene)
    }
}

fn view_of(scene: &Scene) -> View {
    let city = Aabb { min: DVec3::splat(-1e3), max: DVec3::splat(1e3) };
    View::new(scene.camera.expect("a camera"), SIZE, &city).expect("a view")
}

fn places(scene: &Scene, picture: &Picture, lens: usize) -> Vec<Place> {
    let view = view_of(scene);
    let volumes: Vec<_> = scene.lenses[lens].shapes.iter().flat_map(|s| s.volumes().expect("volumes")).collect();
    let depth = picture.depth.as_ref().expect("depth was asked for");
    let place = |i: usize| {
        let d = f64::from(depth[i]);
        if !d.is_finite() {
            return Place::Around;
        }
        let at = view.pixel_ray(i as u32 % SIZE[0], i as u32 / SIZE[0]).at(d);
        let distance = volumes.iter().map(|v| v.signed_distance(at)).fold(f64::INFINITY, f64::min);
        match distance {
            _ if distance.abs() < 1.5 * view.pixel_m(d) => Place::Border,
            _ if distance < 0.0 => Place::Inside,
            _ => Place::Around,
        }
    };
    (0..depth.len()).map(place).collect()
}

fn linear(pixel: [u8; 4]) -> [f64; 3] {
    let [r, g, b, _] = pixel.map(|c| f32::from(c) / 255.0);
    color::linear_from_srgb([r, g, b]).map(f64::from)
}

fn bytes(linear: [f64; 3]) -> [f64; 3] {
    color::srgb_from_linear(linear.map(|c| c as f32)).map(|c| f64::from(c) * 255.0)
}

fn luminance([r, g, b]: [f64; 3]) -> f64 {
    0.2126 * r + 0.7152 * g + 0.0722 * b
}

/// Largest difference of a channel, 0..255.
fn apart(pixel: [u8; 4], wanted: [f64; 3]) -> f64 {
    (0..3).map(|c| (f64::from(pixel[c]) - wanted[c]).abs()).fold(0.0, f64::max)
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0), |(sum, count), value| (sum + value, count + 1.0));
    assert!(count > 0.0, "nothing to take the mean of");
    sum / count
}

/// How far apart the channels of a pixel are, 0..255.
fn colorfulness(pixel: [u8; 4]) -> f64 {
    let [r, g, b, _] = pixel;
    f64::from(r.max(g).max(b) - r.min(g).min(b))
}

/// Mean of how far luminance is from that of the four pixels beside it: what is sharp has much of it.
fn sharpness(picture: &Picture, pixels: &[usize]) -> f64 {
    let [w, h] = SIZE.map(|s| s as usize);
    let at = |i: usize| luminance(linear(picture.rgba[i]));
    let inner = pixels.iter().filter(|&&i| i % w > 0 && i % w < w - 1 && i / w > 0 && i / w < h - 1);
    mean(inner.map(|&i| (4.0 * at(i) - at(i - 1) - at(i + 1) - at(i - w) - at(i + w)).abs()))
}

// ---- Trapp, figure 3.5.1

/// Weighted means along rows, then columns: a Gaussian of which `radius` is 2.5 standard deviations.
fn blurred(image: &[[f64; 3]], radius: f64) -> Vec<[f64; 3]> {
    let [w, h] = SIZE.map(|s| s as i64);
    let along = |image: &[[f64; 3]], dx: i64, dy: i64| -> Vec<[f64; 3]> {
        let one = |i: i64| {
            let (mut sum, mut weights) = ([0.0; 3], 0.0);
            for o in -(radius.ceil() as i64)..=radius.ceil() as i64 {
                let (x, y) = (i % w + o * dx, i / w + o * dy);
                if (0..w).contains(&x) && (0..h).contains(&y) {
                    let weight = (-3.125 * (o as f64 / radius).powi(2)).exp();
                    let c = image[(y * w + x) as usize];
                    sum = [0, 1, 2].map(|k| sum[k] + weight * c[k]);
                    weights += weight;
                }
            }
            sum.map(|s| s / weights)
        };
        (0..w * h).map(one).collect()
    };
    along(&along(image, 1, 0), 0, 1)
}

#[test]
fn trapp_3_5_1_the_focus_is_normal_and_the_context_blurred_after_sepia() {
    let mut stage = Stage::new("trapp-3-5-1");
    let shown = stage.draw();
    // "The focus area appears normal":
    stage.assert_unchanged(&shown, Place::Inside);
    // "the context ... after sepia color transformation": the plain context has many hues, this one the brown of sepia.
    let around = stage.pixels(Place::Around);
    let hue = |pixel: [u8; 4]| {
        let [_, a, b] = color::oklab_from_linear(linear(pixel).map(|c| c as f32));
        f64::from(b).atan2(f64::from(a)).to_degrees()
    };
    let brown = |picture: &Picture| {
        around.iter().filter(|&&i| (60.0..85.0).contains(&hue(picture.rgba[i]))).count() as f64 / around.len() as f64
    };
    assert!(brown(&shown) > 0.99 && brown(&stage.plain) < 0.5, "{} {}", brown(&shown), brown(&stage.plain));
    // "is blurred":
    let ids = stage.plain.object_id.as_ref().expect("object ids");
    let of_objects: Vec<usize> = around.iter().copied().filter(|i| ids[*i] > 0).collect();
    let (sharp, soft) = (sharpness(&stage.plain, &of_objects), sharpness(&shown, &of_objects));
    assert!(soft < 0.1 * sharp, "sharpness {soft} beside {sharp}");
    // and by sepia first, then a Gaussian, of the whole picture: nothing of the focus' colours runs into the context.
    let sepia = stage.draw_with(|scene| {
        scene.lenses.clear();
        scene.style.effects = vec![used("sepia")];
    });
    let image: Vec<[f64; 3]> = sepia.rgba.iter().map(|p| linear(*p)).collect();
    let wanted = blurred(&image, 8.0);
    let worst = around.iter().map(|&i| apart(shown.rgba[i], bytes(wanted[i]))).fold(0.0, f64::max);
    assert!(worst <= 2.0, "{worst}");
    println!("3.5.1: brown {} of {}, sharpness {soft} of {sharp}", brown(&shown), brown(&stage.plain));
}

// ---- Trapp, figure 3.5.2

#[test]
fn trapp_3_5_2_a_the_context_is_darkened_and_the_focus_unchanged() {
    let mut stage = Stage::new("trapp-3-5-2-a");
    let shown = stage.draw();
    stage.assert_unchanged(&shown, Place::Inside);
    let around = stage.pixels(Place::Around);
    // Darker, every pixel that is not black; by one factor on all channels, so that it is the same colour in less light.
    let not_darker =
        around.iter().filter(|&&i| stage.plain.rgba[i][0] > 8 && shown.rgba[i][0] >= stage.plain.rgba[i][0]);
    assert_eq!(not_darker.count(), 0);
    let total = |picture: &Picture| mean(around.iter().map(|&i| luminance(linear(picture.rgba[i]))));
    let factor = total(&shown) / total(&stage.plain);
    assert!((0.05..0.4).contains(&factor), "{factor}");
    let same = |i: usize| apart(shown.rgba[i], bytes(linear(stage.plain.rgba[i]).map(|c| factor * c)));
    let worst = stage.not_cut(&around).map(same).fold(0.0, f64::max);
    assert!(worst <= 1.5, "{worst}");
    println!("3.5.2 A: the context has {factor} of its light");
}

/// Whether the context has no colour, and the focus its own.
fn assert_only_the_focus_has_color(stage: &Stage, shown: &Picture) {
    stage.assert_unchanged(shown, Place::Inside);
    let around = stage.pixels(Place::Around);
    assert!(around.iter().all(|&i| colorfulness(shown.rgba[i]) <= 1.0), "the context has colour");
    let most = |picture: &Picture, place| mean(stage.pixels(place).iter().map(|&i| colorfulness(picture.rgba[i])));
    let (focus, plain) = (most(shown, Place::Inside), most(&stage.plain, Place::Around));
    assert!(focus > 20.0 && plain > 20.0, "no colour to tell: {focus}, {plain}");
    println!("3.5.2: colourfulness of the focus {focus}, of the context {plain}, now at most 1");
}

#[test]
fn trapp_3_5_2_b_the_colours_of_the_context_are_discarded() {
    let mut stage = Stage::new("trapp-3-5-2-b");
    let shown = stage.draw();
    assert_only_the_focus_has_color(&stage, &shown);
    // Nothing but colour is discarded: luminance stays.
    let wanted = |i: usize| bytes([luminance(linear(stage.plain.rgba[i])); 3]);
    let around = stage.pixels(Place::Around);
    let worst = stage.not_cut(&around).map(|i| apart(shown.rgba[i], wanted(i))).fold(0.0, f64::max);
    assert!(worst <= 1.5, "{worst}");
}

#[test]
fn trapp_3_5_2_c_the_context_without_colours_is_inverted() {
    let mut stage = Stage::new("trapp-3-5-2-c");
    let shown = stage.draw();
    assert_only_the_focus_has_color(&stage, &shown);
    // First discarded, then inverted.
    let wanted = |i: usize| bytes([luminance(linear(stage.plain.rgba[i])); 3]).map(|c| 255.0 - c);
    let around = stage.pixels(Place::Around);
    let worst = stage.not_cut(&around).map(|i| apart(shown.rgba[i], wanted(i))).fold(0.0, f64::max);
    assert!(worst <= 1.5, "{worst}");
    // What was lighter is darker now: the sky against the roofs.
    let around = stage.pixels(Place::Around);
    let mean_of = |picture: &Picture, light: bool| {
        let is_light = |&&i: &&usize| (luminance(linear(stage.plain.rgba[i])) > 0.5) == light;
        mean(around.iter().filter(is_light).map(|&i| luminance(linear(picture.rgba[i]))))
    };
    let (light, dark) = (mean_of(&shown, true), mean_of(&shown, false));
    assert!(mean_of(&stage.plain, true) > mean_of(&stage.plain, false) + 0.2 && light + 0.1 < dark, "{light} {dark}");
    println!("3.5.2 C: what was light has luminance {light}, what was dark {dark}");
}

// ---- Trapp, figure 3.5.3

/// Share of pixels of walls whose colour is not that of the same wall beside or below them: shadows and texture make it.
fn unevenness(picture: &Picture, pixels: &[usize]) -> f64 {
    let (objects, normals) = (picture.object_id.as_ref().expect("ids"), picture.normal.as_ref().expect("normals"));
    let w = SIZE[0] as usize;
    let is_wall = |i: usize| objects[i] != 0 && normals[i][2].abs() < 0.1;
    let same = |i: usize, j: usize| j < objects.len() && objects[i] == objects[j] && normals[i] == normals[j];
    let uneven = |i: usize| {
        [i + 1, i + w]
            .into_iter()
            .filter(|&j| same(i, j))
            .any(|j| apart(picture.rgba[i], bytes(linear(picture.rgba[j]))) > 2.5)
    };
    let walls: Vec<usize> =
        pixels.iter().copied().filter(|&i| is_wall(i) && same(i, i + 1) && same(i, i + w)).collect();
    assert!(walls.len() > 300, "few walls: {}", walls.len());
    walls.iter().filter(|&&i| uneven(i)).count() as f64 / walls.len() as f64
}

/// `flat`: where shading is flat; elsewhere it is standard, with texture.
fn assert_flat_and_standard(name: &str, flat: Place, standard: Place) {
    let mut stage = Stage::new(name);
    let shown = stage.draw();
    let elsewhere = stage.draw_with(|scene| scene.sun = Sun { azimuth: 1.0, elevation: 1.0, ..scene.sun });
    let changed = |pixels: &[usize]| {
        let surfaces = pixels.iter().filter(|&&i| shown.object_id.as_ref().is_some_and(|ids| ids[i] != 0));
        let (mut all, mut changed) = (0.0, 0.0);
        for &i in surfaces {
            all += 1.0;
            changed += f64::from(u8::from(shown.rgba[i] != elsewhere.rgba[i]));
        }
        changed / all
    };
    let (flat, standard) = (stage.pixels(flat), stage.pixels(standard));
    // Flat shading knows no sun, neither its light nor its shadows; standard shading lives of it.
    assert_eq!(changed(&flat), 0.0, "the sun changes flat shading");
    assert!(changed(&standard) > 0.8, "{}", changed(&standard));
    // And "texturing" is where standard shading is.
    let (even, uneven) = (unevenness(&shown, &flat), unevenness(&shown, &standard));
    assert!(even < 0.02 && uneven > 0.1, "{even} {uneven}");
    // Of which the texture is the larger part: without it, only borders of shadows are left.
    let bare = unevenness(&stage.plain, &standard);
    assert!(bare < 0.3 * uneven, "{bare} {uneven}");
    println!("{name}: the sun changes {} of standard, {} of flat", changed(&standard), changed(&flat));
    println!("{name}: uneven walls: flat {even}, standard {uneven}, of these by shadows {bare}");
}

#[test]
fn trapp_3_5_3_a_flat_shading_is_combined_with_standard_shading_and_texture() {
    assert_flat_and_standard("trapp-3-5-3-a", Place::Inside, Place::Around);
}

#[test]
fn trapp_3_5_3_b_a_colour_is_laid_over_the_lit_picture() {
    let mut stage = Stage::new("trapp-3-5-3-b");
    let shown = stage.draw();
    stage.assert_unchanged(&shown, Place::Around);
    let EffectUse { effect, parameters, .. } = &stage.scene.lenses[0].effects[0];
    assert_eq!(effect, "overlay");
    let (Some(Parameter::Text(paint)), Some(Parameter::Number(opacity))) =
        (parameters.get("color"), parameters.get("opacity"))
    else {
        panic!("{parameters:?}")
    };
    let paint = color::linear_from_srgb(color::parse_hex(paint).expect("a colour")).map(f64::from);
    let wanted = |i: usize| {
        let below = linear(stage.plain.rgba[i]);
        bytes([0, 1, 2].map(|c| below[c] + opacity * (paint[c] - below[c])))
    };
    let inside = stage.pixels(Place::Inside);
    let worst = stage.not_cut(&inside).map(|i| apart(shown.rgba[i], wanted(i))).fold(0.0, f64::max);
    assert!(worst <= 1.5, "{worst}");
    // It is a post style: light and shadow still show through.
    let spread = |picture: &Picture| {
        let lights: Vec<f64> = inside.iter().map(|&i| luminance(linear(picture.rgba[i]))).collect();
        let middle = mean(lights.iter().copied());
        mean(lights.iter().map(|l| (l - middle).powi(2))).sqrt()
    };
    let left = spread(&shown) / spread(&stage.plain);
    assert!((left - (1.0 - opacity)).abs() < 0.02, "{left}");
    println!("3.5.3 B: off by at most {worst} of 255; {left} of the contrast stays");
}

#[test]
fn trapp_3_5_3_c_is_as_a_but_inverted() {
    assert_flat_and_standard("trapp-3-5-3-c", Place::Around, Place::Inside);
}

#[test]
fn trapp_3_5_3_the_three_lenses_have_three_shapes() {
    let shapes = ["a", "b", "c"].map(|part| {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("scenes/trapp-3-5-3-{part}.toml"));
        let scene = scene_file::read(&path, &Options::for_file(&path)).expect("a scene");
        assert!(scene.lenses.iter().all(|lens| lens.shapes == scene.lenses[0].shapes));
        scene.lenses[0].shapes.clone()
    });
    assert!(matches!(shapes[0][..], [Region::Shape(Shape::Box { .. })]));
    assert!(matches!(shapes[1][..], [Region::Shape(Shape::Convex { .. })]));
    assert!(matches!(shapes[2][..], [Region::Shape(Shape::Sphere { .. })]));
}

// ---- Tiesel, figure 3.22

/// Turns a parameter of the lens' first effect.
fn turn(scene: &mut Scene, lens: usize, parameter: &str, value: f64) {
    let parameters: &mut BTreeMap<_, _> = &mut scene.lenses[lens].effects[0].parameters;
    parameters.insert(parameter.to_owned(), Parameter::Number(value));
}

const MARBLE: usize = 0;
const VELVET: usize = 1;

/// Light per pixel that a parameter at 0 takes away, in luminance; NaN where a picture is too bright to tell.
fn gained(with: &Picture, without: &Picture) -> Vec<f64> {
    let is_clipped = |p: &[u8; 4]| p[..3].iter().any(|&c| c >= 254);
    let one = |(a, b): (&[u8; 4], &[u8; 4])| match is_clipped(a) || is_clipped(b) {
        true => f64::NAN,
        false => luminance(linear(*a)) - luminance(linear(*b)),
    };
    with.rgba.iter().zip(&without.rgba).map(one).collect()
}

#[test]
fn tiesel_3_22_the_highlights_of_marble_and_of_velvet_are_both_kept_where_they_overlap() {
    let mut stage = Stage::new("tiesel-3-22");
    let shown = stage.draw();
    let matt_marble = stage.draw_with(|s| turn(s, MARBLE, "polish", 0.0));
    let matt_velvet = stage.draw_with(|s| turn(s, VELVET, "strength", 0.0));
    let alone = |stage: &mut Stage, lens: usize, parameter: &str| {
        let one = |s: &mut Scene| s.lenses[MARBLE + VELVET - lens].enabled = false;
        let with = stage.draw_with(one);
        let without = stage.draw_with(|s| {
            one(s);
            turn(s, lens, parameter, 0.0);
        });
        gained(&with, &without)
    };
    let marble_alone = alone(&mut stage, MARBLE, "polish");
    let velvet_alone = alone(&mut stage, VELVET, "strength");
    let (marble, velvet) = (gained(&shown, &matt_marble), gained(&shown, &matt_velvet));
    let both: Vec<usize> =
        (0..shown.rgba.len()).filter(|&i| stage.places.iter().all(|p| p[i] == Place::Inside)).collect();
    assert!(both.len() > 3000, "the lenses hardly overlap: {}", both.len());

    // "The specular highlights of the marble as well as the highlights of the red fabric ... are preserved": where a
    // lens alone adds light, so much it adds in the overlap.
    let strong = |alone: &[f64]| both.iter().copied().filter(|&i| alone[i] > 0.05).collect::<Vec<usize>>();
    for (name, alone, here) in [("marble", &marble_alone, &marble), ("velvet", &velvet_alone, &velvet)] {
        let places = strong(alone);
        assert!(places.len() > 400, "{name} has {} pixels of highlight", places.len());
        let known: Vec<f64> = places.iter().filter(|&&i| here[i].is_finite()).map(|&i| here[i] / alone[i]).collect();
        let worst = known.iter().map(|share| (share - 1.0).abs()).fold(0.0, f64::max);
        let share = mean(known.iter().copied());
        println!("3.22: {name}: {} pixels, {share} of its highlight is kept, at worst off by {worst}", known.len());
        assert!(known.len() > 300 && (share - 1.0).abs() < 0.03 && worst < 0.2, "{name}: {share} {worst}");
    }

    // They are what the caption calls them. Marble's: round the direction in which a mirror throws the sun at the eye.
    // Velvet's: at glancing angles. Both by geometry alone, from depth and normal in f64.
    let view = stage.view();
    let eye = stage.scene.camera.expect("a camera").eye;
    let sun = stage.scene.sun;
    let (a, e) = (sun.azimuth, sun.elevation);
    let to_sun = DVec3::new(a.sin() * e.cos(), a.cos() * e.cos(), e.sin());
    let (depth, normal) = (shown.depth.as_ref().expect("depth"), shown.normal.as_ref().expect("normals"));
    let angles = |i: usize| {
        let at = view.pixel_ray(i as u32 % SIZE[0], i as u32 / SIZE[0]).at(f64::from(depth[i]));
        let (to_eye, n) = ((eye - at).normalize_or(DVec3::Z), DVec3::from(normal[i].map(f64::from)));
        (n.dot((to_eye + to_sun).normalize_or(DVec3::Z)).acos().to_degrees(), n.dot(to_eye).acos().to_degrees())
    };
    let of = |light: &[f64], is_in: &dyn Fn(f64, f64) -> bool| {
        mean(both.iter().filter(|&&i| light[i].is_finite() && is_in(angles(i).0, angles(i).1)).map(|&i| light[i]))
    };
    let (near, far) = (of(&marble, &|mirror, _| mirror < 8.0), of(&marble, &|mirror, _| mirror > 20.0));
    assert!(near > 0.1 && far < 0.02 * near, "marble: {near} at the mirror's angle, {far} far from it");
    let (glancing, facing) = (of(&velvet, &|_, slant| slant > 65.0), of(&velvet, &|_, slant| slant < 40.0));
    assert!(glancing > 0.05 && facing < 0.1 * glancing, "velvet: {glancing} at glancing angles, {facing} head-on");
    println!(
        "3.22: marble {near} near the mirror's angle, {far} far from it; velvet {glancing} glancing, {facing} head-on"
    );

    // "the red fabric": apart from highlights, the overlap has the colour of the upper lens.
    let matt = both.iter().filter(|&&i| marble[i] < 0.01 && velvet[i] < 0.03).map(|&i| linear(shown.rgba[i]));
    assert!(matt.clone().count() > 300 && matt.clone().all(|[r, g, b]| r > 3.0 * g && r > 2.0 * b), "not red");
}

// ---- Ropinski and Hinrichs, figures 1, 3, 5, 6, 7, 8; Trapp, figures 3.1.3 and 3.2.3; Tiesel, figure 3.7

/// Pixels whose shown place lies further away than without lenses.
fn revealed(stage: &Stage, picture: &Picture) -> Vec<usize> {
    let depth = |p: &Picture| p.depth.clone().expect("depth was asked for");
    let (with, without) = (depth(picture), depth(&stage.plain));
    (0..with.len()).filter(|&i| with[i] > without[i] * 1.0001).collect()
}

/// "Reveals the inside structure" (1), "insights" (3), "arbitrary convex shapes", "quadric" (5): inside of the lens what is
/// hidden shows between the lines, outside nothing changes.
#[test]
fn wireframe_lenses_reveal_what_is_inside_and_leave_the_rest() {
    for name in ["ropinski-1", "ropinski-3", "ropinski-5"] {
        let mut stage = Stage::new(name);
        let shown = stage.draw();
        // What was in the lens may show what is outside, behind it: what was around it stays.
        stage.assert_unchanged_beside_lines(&shown);
        let revealed = revealed(&stage, &shown);
        let inside = stage.pixels(Place::Inside);
        let share = revealed.len() as f64 / inside.len() as f64;
        assert!(share > 0.5, "{name}: {} of {} pixels show what is behind", revealed.len(), inside.len());
        assert!(revealed.iter().all(|&i| stage.places[0][i] != Place::Around), "{name}");
    }
}

/// "Visualization of the lens by a semi-transparent lens volume" (3 d), which "does not occlude scene geometry".
#[test]
fn the_lens_body_is_tinted_and_lets_everything_through() {
    let mut stage = Stage::new("ropinski-3");
    let bare = stage.draw();
    let glass = stage.draw_with(|s| s.lenses[0].body = LensBody::Shell);
    let view = stage.view();
    let volume = stage.scene.lenses[0].shapes[0].volumes().expect("a volume").remove(0);
    let [mut tinted, mut met] = [0, 0];
    for i in 0..glass.rgba.len() {
        let ray = view.pixel_ray(i as u32 % SIZE[0], i as u32 / SIZE[0]);
        let depth = f64::from(bare.depth.as_ref().expect("depth")[i]);
        if volume.entry_exit(&ray).is_some_and(|(enter, _)| enter < 0.999 * depth) {
            met += 1;
            tinted += usize::from(glass.rgba[i] != bare.rgba[i]);
        }
    }
    assert!(met > 5000 && tinted as f64 > 0.99 * met as f64, "{tinted} of {met} pixels are tinted");
    assert!(glass.depth == bare.depth && glass.object_id == bare.object_id);
}

/// "Its sphere of influence ranges from its 2D shape to the far clipping plane": what is seen through the pane and behind it.
#[test]
fn a_flat_lens_acts_behind_its_pane_alone() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/ropinski-6.toml");
    let mut scene = scene_file::read(&path, &Options::for_file(&path)).expect("a scene");
    scene.lenses[0].body = LensBody::None;
    let mut studio = of_scene(&scene);
    let plain = picture(&mut studio, &Scene { lenses: vec![], ..scene.clone() }, SIZE);
    let shown = picture(&mut studio, &scene, SIZE);
    let Region::Shape(Shape::Flat { center, rotation, .. }) = scene.lenses[0].shapes[0].clone() else {
        panic!("a flat lens")
    };
    let view = view_of(&scene);
    let (depth, mask) = (plain.depth.as_ref().expect("depth"), bits(&shown, 0));
    let (mut counts, mut changed) = ([0; 3], 0);
    for i in 0..mask.len() {
        let ray = view.pixel_ray(i as u32 % SIZE[0], i as u32 / SIZE[0]);
        let normal = rotation * DVec3::Z;
        let t = normal.dot(center - ray.origin) / normal.dot(ray.direction);
        let own = rotation.conjugate() * (ray.at(t) - center);
        let [dx, dy] = [own.x.abs() - 23.0, own.y.abs() - 15.0];
        if dx.abs() < 0.3 || dy.abs() < 0.3 || (f64::from(depth[i]) / t - 1.0).abs() < 1e-4 {
            continue;
        }
        let is_through = dx < 0.0 && dy < 0.0;
        let is_in = is_through && f64::from(depth[i]) > t;
        counts[usize::from(is_through) + usize::from(is_in)] += 1;
        assert_eq!(mask[i], is_in, "pixel {i}");
        // Lines that begin beyond the pane are as wide as a pixel or two.
        changed += usize::from(!is_in && shown.rgba[i] != plain.rgba[i]);
    }
    assert!(counts.iter().all(|c| *c > 500) && changed < 150, "{counts:?}, {changed} of the others changed");
}

/// "Lenses intersecting the near or the far clipping plane ... has not been solved yet": here they are exact.
#[test]
fn lenses_across_the_clipping_planes_are_exact() {
    let mut stage = Stage::new("ropinski-7");
    let shown = stage.draw();
    let eye = stage.scene.camera.expect("a camera").eye;
    let around = stage.scene.lenses[1].shapes[0].volumes().expect("a volume").remove(0);
    assert!(around.contains(eye), "the eye is inside");
    for lens in 0..2 {
        let mask = bits(&shown, lens);
        let wrong = (0..mask.len()).filter(|&i| match stage.places[lens][i] {
            Place::Inside => !mask[i],
            Place::Around => mask[i],
            Place::Border => false,
        });
        assert_eq!(wrong.count(), 0, "lens {lens}");
        assert!(mask.iter().filter(|b| **b).count() > 1000);
    }
}

/// "Eraser lenses reveal occluded parts of the scene by removing partial or complete information."
#[test]
fn erasers_remove_all_or_a_part() {
    let mut stage = Stage::new("ropinski-8");
    let shown = stage.draw();
    let view = stage.view();
    let (depth, normal) = (shown.depth.as_ref().expect("depth"), shown.normal.as_ref().expect("normals"));
    let volumes: Vec<_> =
        stage.scene.lenses.iter().map(|l| l.shapes[0].volumes().expect("a volume").remove(0)).collect();
    let mut roofs = 0;
    for i in (0..depth.len()).filter(|&i| depth[i].is_finite()) {
        let d = f64::from(depth[i]);
        let at = view.pixel_ray(i as u32 % SIZE[0], i as u32 / SIZE[0]).at(d);
        assert!(volumes[0].signed_distance(at) > -1e-3, "pixel {i} shows what the lens holds");
        let is_in = volumes[1].signed_distance(at) < -1e-3;
        let slope = f64::from(normal[i][2].abs());
        roofs += usize::from(is_in && slope > 0.3 && at.z > 4.0);
    }
    assert!(revealed(&stage, &shown).len() > 3000);
    assert!(roofs > 500, "{roofs} pixels of roofs without walls");
}

/// "Application of the image-based focus and context separation ... using a volumetric depth sprite of a cube, a sphere and
/// multiple spheres": in it the roofs are gone, around it nothing changes.
#[test]
fn a_depth_sprite_tells_focus_and_context_apart() {
    for name in ["trapp-3-2-3-a", "trapp-3-2-3-b", "trapp-3-2-3-c"] {
        // What is gone casts no shadow any more.
        let mut stage = Stage::changed(name, |s| s.sun.shadows = false);
        assert!(stage.scene.lenses[0].sprite.is_some(), "{name} has a sprite");
        let shown = stage.draw();
        stage.assert_unchanged_beside_lines(&shown);
        assert!(revealed(&stage, &shown).len() > 1000, "{name}");
        // Whatever is shown in it is drawn in lines on paper: pale or dark, but not coloured.
        let inside = stage.pixels(Place::Inside);
        let mask = bits(&shown, 0);
        let colorful = mean(inside.iter().filter(|&&i| mask[i]).map(|&i| colorfulness(shown.rgba[i])));
        assert!(colorful < 30.0, "{name}: {colorful}");
    }
}

/// "Aggregation of two volumetric depth sprites": one lens, inside where either of them is.
#[test]
fn two_solids_are_one_lens() {
    let mut stage = Stage::new("trapp-3-1-3");
    let shown = stage.draw();
    stage.assert_unchanged(&shown, Place::Around);
    let mask = bits(&shown, 0);
    let wrong = (0..mask.len()).filter(|&i| stage.places[0][i] == Place::Inside && !mask[i]).count();
    assert_eq!(wrong, 0);
    let view = stage.view();
    let volumes: Vec<_> =
        stage.scene.lenses[0].shapes.iter().map(|s| s.volumes().expect("a volume").remove(0)).collect();
    let depth = shown.depth.as_ref().expect("depth");
    let of = |k: usize| {
        let is_in = |i: usize| {
            let at = view.pixel_ray(i as u32 % SIZE[0], i as u32 / SIZE[0]).at(f64::from(depth[i]));
            mask[i] && depth[i].is_finite() && volumes[k].contains(at) && !volumes[1 - k].contains(at)
        };
        (0..mask.len()).filter(|&i| is_in(i)).count()
    };
    assert!(of(0) > 500 && of(1) > 500, "each of them holds something of its own");
}

/// "The red fabric effect has a spherical shape, a 2D texture is used for the marble effect lens to create an extruded
/// fleur-de-lis volume."
#[test]
fn velvet_in_a_ball_and_marble_in_an_extruded_figure() {
    let mut stage = Stage::new("tiesel-3-7");
    let shown = stage.draw();
    for lens in 0..2 {
        let mask = bits(&shown, lens);
        let wrong = (0..mask.len()).filter(|&i| match stage.places[lens][i] {
            Place::Inside => !mask[i],
            Place::Around => mask[i],
            Place::Border => false,
        });
        assert_eq!(wrong.count(), 0, "lens {lens}");
        let colors = mask.iter().zip(&shown.rgba).filter(|(is_in, _)| **is_in).map(|(_, p)| *p);
        let [r, g, b] = [0, 1, 2].map(|c| mean(colors.clone().map(|p| f64::from(p[c]))));
        match lens {
            0 => assert!((r - b).abs() < 40.0 && g > 100.0, "marble is {r} {g} {b}"),
            _ => assert!(r > 3.0 * g && r > 3.0 * b, "velvet is {r} {g} {b}"),
        }
    }
    let changed = (0..shown.rgba.len())
        .filter(|&i| stage.places.iter().all(|p| p[i] == Place::Around) && shown.rgba[i] != stage.plain.rgba[i]);
    assert_eq!(changed.count(), 0);
}

/// "Lens order determines the clipping behaviour of individual lens content" (3.9); "the clipping of individual lenses changes as
/// the user successively selects lenses" (3.12): in a lens nothing of what lies below it shows, whatever that is.
#[test]
fn the_content_of_a_higher_lens_clips_those_below() {
    for name in ["tiesel-3-9", "tiesel-3-12-a", "tiesel-3-12-b"] {
        let mut stage = Stage::changed(name, |s| s.sun.shadows = false);
        let all = stage.draw();
        let count = stage.scene.lenses.len();
        for lens in 0..count {
            // Without those below: as it was, where the lens is and none above it.
            let alone = stage.draw_with(|s| s.lenses[..lens].iter_mut().for_each(|l| l.enabled = false));
            let masks: Vec<Vec<bool>> = (0..count).map(|i| bits(&all, i)).collect();
            // Where a lower lens clips what stands before, one sees further with it than without.
            let still = bits(&alone, lens);
            let is_own = |i: &usize| masks[lens][*i] && still[*i] && (lens + 1..count).all(|above| !masks[above][*i]);
            let own: Vec<usize> = (0..all.rgba.len()).filter(is_own).collect();
            let overlaps = own.iter().filter(|&&i| masks[..lens].iter().any(|m| m[i])).count();
            assert!(own.len() > 1000 && (lens == 0 || overlaps > 300), "{name}, lens {lens}: {overlaps} overlap");
            // What lower lenses do to colours they do to what is shown in both.
            let shown = |p: &Picture, i: usize| {
                (p.object_id.as_ref().expect("ids")[i], p.depth.as_ref().expect("depth")[i].to_bits())
            };
            let other = own.iter().filter(|&&i| shown(&all, i) != shown(&alone, i)).count();
            // A fragment is clipped before its depth is stored, the mask is asked after: they may round the border differently.
            assert!(other < 4, "{name}, lens {lens}: {other} pixels of what is below show in it");
            let hidden = stage.draw_with(|s| s.lenses[lens].kind.set_content(None));
            let changed = own.iter().filter(|&&i| all.rgba[i] != hidden.rgba[i]).count();
            assert!(changed > own.len() / 20, "{name}, lens {lens} has content of its own: {changed} of {}", own.len());
        }
    }
    let top = |name: &str| Stage::new(name).scene.lenses.pop().expect("a lens").name;
    assert_ne!(top("tiesel-3-12-a"), top("tiesel-3-12-b"));
}
