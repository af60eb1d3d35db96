//! Effects: pictures known by thought, and effect files as their authors meet them.

use std::{collections::BTreeMap, path::PathBuf};

use crate::studio::{self, *};
use glam::DVec3;
use veduta::{
    geom::Shape,
    lens::{EffectUse, Lens, Parameter, color},
    render::picture::{Picture, Request, Studio},
    scene::Scene,
    shader::{EffectDefinition, EffectKind, PerObject, effect::find, effects},
    view::Camera,
};

const SIZE: [u32; 2] = [240, 160];

/// A town, partly within a lens, and the lens' mask.
struct Stage {
    studio: Studio,
    camera: Camera,
    ball: Shape,
    inside: Vec<bool>,
    plain: Picture,
}

impl Stage {
    fn new() -> Self {
        let mut studio = synthetic(60);
        let number = studio.geometries[studio.geometries.len() / 2];
        let at = studio.model.geometries[number as usize].bounds.center();
        let camera = Camera::looking(at + DVec3::new(60.0, -90.0, 70.0), at, 0.8);
        let ball = Shape::Sphere { center: at, radius: 60.0 };
        let plain = picture(&mut studio, &scene(camera, vec![]), SIZE);
        let lensed = picture(&mut studio, &scene(camera, vec![lens("l", vec![ball.clone()], "greyscale")]), SIZE);
        let inside = bits(&lensed, 0);
        assert!(inside.iter().filter(|b| **b).count() > 1000);
        Self { studio, camera, ball, inside, plain }
    }

    fn scene(&self, effects: Vec<EffectUse>) -> Scene {
        let mut lens = lens("l", vec![self.ball.clone()], "greyscale");
        lens.effects = effects;
        scene(self.camera, vec![lens])
    }

    /// The picture with these effects inside the lens; outside it must be the plain one, but for lines of edges inside, which
    /// cover pixels beside them.
    fn with(&mut self, effects: Vec<EffectUse>) -> Picture {
        let names: Vec<String> = effects.iter().map(|e| e.effect.clone()).collect();
        let lines = draws_lines(&names.iter().map(String::as_str).collect::<Vec<_>>());
        let scene = self.scene(effects);
        let picture = picture(&mut self.studio, &scene, SIZE);
        for (i, inside) in self.inside.iter().enumerate() {
            assert!(*inside || lines || picture.rgba[i] == self.plain.rgba[i], "pixel {i} outside the lens changed");
        }
        picture
    }

    /// The largest difference of a channel from what `expected` makes of the plain picture, inside the lens.
    fn farthest(&mut self, effects: Vec<EffectUse>, expected: impl Fn([f32; 3]) -> [f32; 3]) -> i32 {
        let picture = self.with(effects);
        let apart = |i: usize| {
            let [r, g, b, _] = self.plain.rgba[i];
            let wanted = expected([r, g, b].map(|c| f32::from(c) / 255.0)).map(|c| (c * 255.0).round() as i32);
            (0..3).map(|c| (wanted[c] - i32::from(picture.rgba[i][c])).abs()).max().unwrap_or(0)
        };
        (0..self.inside.len()).filter(|i| self.inside[*i]).map(apart).max().unwrap_or(0)
    }
}

/// Effects that need no parameter, and no point of interest.
fn ready() -> impl Iterator<Item = &'static EffectDefinition> {
    effects().filter(|e| e.objects != Some(PerObject::Sights) && !e.parameters.iter().any(|p| p.is_required()))
}

#[test]
fn every_effect_changes_the_inside_and_nothing_else() {
    let mut stage = Stage::new();
    for effect in ready() {
        let picture = stage.with(vec![used(&effect.name)]);
        let changed = (0..stage.inside.len()).filter(|&i| picture.rgba[i] != stage.plain.rgba[i]).count();
        let inside = stage.inside.iter().filter(|b| **b).count();
        if effect.draws_coming() {
            assert_eq!(changed, 0, "all is there already");
            continue;
        }
        if effect.name == "transfer" {
            assert_eq!(changed, 0, "it is of volumes");
            continue;
        }
        assert!(changed * 20 > inside, "{} changed {changed} of {inside} pixels", effect.name);
        assert_eq!(picture.statistics.handlers.as_slice(), std::slice::from_ref(&effect.name));
        // What shows after something was hidden may lie elsewhere.
        let hides = effect.kind.decides_visibility();
        assert!(hides || picture.statistics.lenses[0].pixels as usize == inside, "{}", effect.name);
    }
}

#[test]
fn effects_do_what_their_arithmetic_says() {
    let mut stage = Stage::new();
    // Bytes of the plain picture are rounded, and so are those of the result.
    let one = |effect, numbers: &[(&str, f64)]| vec![with_numbers(effect, numbers)];
    assert!(stage.farthest(one("invert", &[]), |c| c.map(|c| 1.0 - c)) <= 1);
    assert!(stage.farthest(vec![used("invert"), used("invert")], |c| c) <= 1);
    assert_eq!(stage.farthest(one("darken", &[("amount", 1.0)]), |_| [0.0; 3]), 0);
    assert!(stage.farthest(one("brighten", &[("amount", 1.0)]), |_| [1.0; 3]) <= 1);
    for identity in [
        one("darken", &[("amount", 0.0)]),
        one("brighten", &[("amount", 0.0)]),
        one("saturate", &[("factor", 1.0)]),
        one("overlay", &[("opacity", 0.0)]),
        one("greyscale", &[("amount", 0.0)]),
    ] {
        let name = identity[0].effect.clone();
        assert!(stage.farthest(identity, |c| c) <= 1, "{name}");
    }
    let halved = |c: [f32; 3]| color::srgb_from_linear(color::linear_from_srgb(c).map(|c| 0.125 * c));
    assert!(stage.farthest(one("darken", &[("amount", 0.5)]), halved) <= 1);
    let grey = |c: [f32; 3]| {
        let [r, g, b] = color::linear_from_srgb(c);
        color::srgb_from_linear([0.2126 * r + 0.7152 * g + 0.0722 * b; 3])
    };
    assert!(stage.farthest(one("greyscale", &[]), grey) <= 1);
    let paint = |mode: &str| EffectUse {
        parameters: [
            ("mode".to_owned(), Parameter::Text(mode.into())),
            ("color".to_owned(), Parameter::Text("#804020".into())),
            ("opacity".to_owned(), Parameter::Number(1.0)),
        ]
        .into(),
        ..used("overlay")
    };
    let brown = [128.0, 64.0, 32.0].map(|c| c / 255.0);
    assert_eq!(stage.farthest(vec![paint("alpha")], |_| brown), 0);
    let blended = |f: fn(f32, f32) -> f32| {
        move |c: [f32; 3]| {
            let (below, above) = (color::linear_from_srgb(c), color::linear_from_srgb(brown));
            color::srgb_from_linear([0, 1, 2].map(|i| f(below[i], above[i])))
        }
    };
    assert!(stage.farthest(vec![paint("multiply")], blended(|a, b| a * b)) <= 1);
    assert!(stage.farthest(vec![paint("screen")], blended(|a, b| 1.0 - (1.0 - a) * (1.0 - b))) <= 1);
}

#[test]
fn an_engraving_gives_back_the_lightness_of_the_picture() {
    let mut stage = Stage::new();
    let luminance = |p: &[u8; 4]| {
        let [r, g, b] = color::linear_from_srgb([p[0], p[1], p[2]].map(|c| f32::from(c) / 255.0));
        f64::from(0.2126 * r + 0.7152 * g + 0.0722 * b)
    };
    for numbers in [vec![], vec![("spacing", 3.0), ("angle_deg", -70.0)]] {
        let picture = stage.with(vec![with_numbers("engraving", &numbers)]);
        let inside = || (0..stage.inside.len()).filter(|i| stage.inside[*i]);
        let mean =
            |picture: &Picture| inside().map(|i| luminance(&picture.rgba[i])).sum::<f64>() / inside().count() as f64;
        let (wanted, found) = (mean(&stage.plain), mean(&picture));
        // Lines are cut by borders of faces, and shares are kept off 0 and 1.
        assert!((found / wanted - 1.0).abs() < 0.03, "{found}, not {wanted}");
        let tones = inside().map(|i| picture.rgba[i][1]);
        assert!(tones.clone().max() > Some(230) && tones.min() < Some(60), "no lines");
    }
}

/// The picture blurred by hand, from its bytes: columns of rows, weights of the kernel, linear light.
fn blurred(picture: &Picture, radius: f64) -> Vec<[f32; 3]> {
    let [w, h] = picture.size.map(|s| s as i64);
    let reach = radius.ceil() as i64;
    let weight = |o: i64| (-0.5 * (2.5 * o as f64 / radius).powi(2)).exp();
    let pass = |image: &[[f64; 3]], step: [i64; 2]| -> Vec<[f64; 3]> {
        let at = |i: i64| {
            let (x, y) = (i % w, i / w);
            let (mut sum, mut weights) = ([0.0; 3], 0.0);
            for o in -reach..=reach {
                let (x, y) = (x + o * step[0], y + o * step[1]);
                if (0..w).contains(&x) && (0..h).contains(&y) {
                    let c = image[(y * w + x) as usize];
                    sum = [0, 1, 2].map(|k| sum[k] + weight(o) * c[k]);
                    weights += weight(o);
                }
            }
            sum.map(|s| s / weights)
        };
        (0..w * h).map(at).collect()
    };
    let linear = |p: &[u8; 4]| color::linear_from_srgb([p[0], p[1], p[2]].map(|c| f32::from(c) / 255.0)).map(f64::from);
    let image: Vec<[f64; 3]> = picture.rgba.iter().map(linear).collect();
    let done = pass(&pass(&image, [1, 0]), [0, 1]);
    done.into_iter().map(|c| color::srgb_from_linear(c.map(|c| c as f32))).collect()
}

#[test]
fn blur_is_a_gaussian_of_the_lens_own_unmasked_picture() {
    let mut stage = Stage::new();
    let wanted = blurred(&stage.plain, 5.0);
    let picture = stage.with(vec![with_numbers("blur", &[("radius", 5.0)])]);
    let apart =
        |i: usize| (0..3).map(|c| (wanted[i][c] * 255.0 - f32::from(picture.rgba[i][c])).abs()).fold(0.0_f32, f32::max);
    let worst = (0..wanted.len()).filter(|i| stage.inside[*i]).map(apart).fold(0.0_f32, f32::max);
    // Bytes of the plain picture are rounded, dark ones most in linear light; so are what the filter reads and the result.
    assert!(worst <= 2.0, "{worst}");
    // Another lens' style is not sampled: the blurred lens beside a black one is as without it.
    let mut scene = stage.scene(vec![with_numbers("blur", &[("radius", 5.0)])]);
    let mut below = lens("below", vec![stage.ball.clone()], "darken");
    below.effects = vec![with_numbers("darken", &[("amount", 1.0)])];
    scene.lenses.insert(0, below);
    let both = studio::picture(&mut stage.studio, &scene, SIZE);
    assert_eq!(both.rgba, picture.rgba);
}

/// One sample, nothing behind the city.
fn transparent() -> Request {
    Request { transparent: true, ..Request::plain(SIZE) }
}

#[test]
fn a_transparent_picture_is_blurred_without_what_is_not_there() {
    let mut stage = Stage::new();
    // The whole city in a wide lens, and much sky over it.
    let Shape::Sphere { center: at, .. } = stage.ball else { unreachable!("the stage has a ball") };
    let ball = Shape::Sphere { center: at, radius: 1000.0 };
    let camera = Camera::looking(at + DVec3::new(60.0, -200.0, 25.0), at + DVec3::new(0.0, 0.0, 20.0), 0.5);
    let mut one = lens("all", vec![ball], "blur");
    one.effects = vec![with_numbers("blur", &[("radius", 4.0)])];
    let mut scene = scene(camera, vec![one]);
    let request = transparent();
    let picture = stage.studio.render(&scene, &request).expect("a picture");
    scene.lenses.clear();
    let plain = stage.studio.render(&scene, &request).expect("a picture");
    let alphas = |p: &Picture| p.rgba.iter().map(|c| c[3]).collect::<Vec<_>>();
    assert!(alphas(&picture) == alphas(&plain), "the silhouette changed");
    let [w, h] = SIZE.map(|s| s as i64);
    let weight = |o: i64| (-0.5 * (2.5 * o as f64 / 4.0).powi(2)).exp();
    let (mut checked, mut mixed) = (0, 0);
    for i in (0..w * h).filter(|i| plain.rgba[*i as usize][3] == 255) {
        let (x, y) = (i % w, i / w);
        let (mut sum, mut weights, mut all) = ([0.0; 3], 0.0, 0.0);
        for (dx, dy) in (-4..=4).flat_map(|dx| (-4..=4).map(move |dy| (dx, dy))) {
            let (x, y) = (x + dx, y + dy);
            if !(0..w).contains(&x) || !(0..h).contains(&y) {
                continue;
            }
            let p = plain.rgba[(y * w + x) as usize];
            let here = weight(dx) * weight(dy);
            all += here;
            if p[3] == 255 {
                let c = color::linear_from_srgb([p[0], p[1], p[2]].map(|c| f32::from(c) / 255.0));
                sum = [0, 1, 2].map(|k| sum[k] + here * f64::from(c[k]));
                weights += here;
            }
        }
        let wanted = color::srgb_from_linear(sum.map(|s| (s / weights) as f32)).map(|c| c * 255.0);
        let found = picture.rgba[i as usize];
        for c in 0..3 {
            // Where little of the neighbourhood is there, rounding weighs more.
            let tolerance = if weights > 0.5 * all { 2.0 } else { 5.0 };
            let wrong = (wanted[c] - f32::from(found[c])).abs();
            assert!(wrong <= tolerance, "pixel {x} {y}: {found:?}, not {wanted:?} of {weights}");
        }
        checked += 1;
        mixed += u32::from(weights < 0.9 * all);
    }
    assert!(checked > 1000 && mixed > 100, "{checked} {mixed}");
}

#[test]
fn what_filters_have_in_common_is_made_once() {
    let mut stage = Stage::new();
    let Shape::Sphere { center, .. } = stage.ball else { unreachable!("the stage has a ball") };
    let mut blurs = |radii: [f64; 2]| {
        let one = |i: usize| {
            let center = center + DVec3::new([-25.0, 25.0][i], 0.0, 0.0);
            let shape = Shape::Sphere { center, radius: 30.0 };
            Lens {
                effects: vec![with_numbers("blur", &[("radius", radii[i])])],
                ..lens(&format!("{i}"), vec![shape], "blur")
            }
        };
        let both = picture(&mut stage.studio, &scene(stage.camera, vec![one(0), one(1)]), SIZE);
        let insides = [bits(&both, 0), bits(&both, 1)];
        for (i, rgba) in both.rgba.iter().enumerate() {
            assert!(insides[0][i] || insides[1][i] || *rgba == stage.plain.rgba[i]);
        }
        let made: Vec<String> = both.statistics.passes.iter().map(|p| p.name.clone()).collect();
        let filter_passes = made.into_iter().filter(|name| name.contains("filter")).collect::<Vec<_>>();
        (both, filter_passes)
    };
    let (equal, passes) = blurs([5.0, 5.0]);
    assert_eq!(passes, ["unfiltered", "filter down", "filter across"]);
    let (unequal, passes) = blurs([2.5, 5.0]);
    assert_eq!(passes, ["unfiltered", "filter down", "filter across", "filter down", "filter across"]);
    assert_eq!(unequal.statistics.pipelines.compiled, 0, "a radius is a parameter");
    let insides = [bits(&equal, 0), bits(&equal, 1)];
    let wanted = [2.5, 5.0].map(|radius| blurred(&stage.plain, radius));
    let mut checked = [0; 2];
    for i in 0..stage.plain.rgba.len() {
        // The upper lens is drawn over the lower one.
        let Some(lens) = [1, 0].into_iter().find(|l| insides[*l][i]) else { continue };
        checked[lens] += 1;
        for (both, wanted) in [(&equal, &wanted[1]), (&unequal, &wanted[lens])] {
            let apart = wanted[i].iter().zip(both.rgba[i]).map(|(w, byte)| (w * 255.0 - f32::from(byte)).abs());
            let apart = apart.fold(0.0, f32::max);
            assert!(apart <= 2.0, "pixel {i} of lens {lens}: {apart}");
        }
    }
    assert!(checked.into_iter().all(|n| n > 500), "{checked:?}");
}

#[test]
fn blend_modes_and_weights_are_their_arithmetic() {
    use veduta::shader::Blend;
    let mut stage = Stage::new();
    let paint = |blend: Blend, weight: Option<f64>| {
        let parameters =
            [("color".to_owned(), Parameter::Text("#804020".into())), ("opacity".to_owned(), Parameter::Number(1.0))];
        vec![EffectUse { blend: Some(blend), weight, parameters: parameters.into(), ..used("overlay") }]
    };
    let brown = color::linear_from_srgb([128.0, 64.0, 32.0].map(|c| c / 255.0));
    for (blend, f) in [
        (Blend::Replace, (|_, a| a) as fn(f32, f32) -> f32),
        (Blend::Add, |b, a| (b + a).min(1.0)),
        (Blend::Subtract, |b, a| (b - a).max(0.0)),
        (Blend::Multiply, |b, a| b * a),
        (Blend::Screen, |b, a| 1.0 - (1.0 - b) * (1.0 - a)),
    ] {
        let wanted = |weight: f32| {
            move |c: [f32; 3]| {
                let below = color::linear_from_srgb(c);
                color::srgb_from_linear([0, 1, 2].map(|i| below[i] + (f(below[i], brown[i]) - below[i]) * weight))
            }
        };
        // Where two bright ones leave a dark one, the byte that was rounded is far from the result: 20 dark steps.
        let most = if blend == Blend::Subtract { 20 } else { 2 };
        assert!(stage.farthest(paint(blend, None), wanted(1.0)) <= most, "{blend:?}");
        if blend != Blend::Add {
            assert!(stage.farthest(paint(blend, Some(0.25)), wanted(0.25)) <= 2, "{blend:?}, a quarter");
        }
        assert!(stage.farthest(paint(blend, Some(0.0)), |c| c) <= 1, "{blend:?}, nothing");
    }
}

#[test]
fn the_glow_of_one_lens_survives_the_colour_of_another() {
    let mut stage = Stage::new();
    let glow = EffectUse {
        parameters: [
            ("color".to_owned(), Parameter::Text("#800000".into())),
            ("strength".to_owned(), Parameter::Number(1.0)),
            ("rim".to_owned(), Parameter::Number(0.0)),
        ]
        .into(),
        ..used("glow")
    };
    let flat = lens("flat", vec![stage.ball.clone()], "flat");
    let glowing = Lens { effects: vec![glow], ..lens("glow", vec![stage.ball.clone()], "glow") };
    let alone = picture(&mut stage.studio, &scene(stage.camera, vec![flat.clone()]), SIZE);
    for lenses in [vec![glowing.clone(), flat.clone()], vec![flat, glowing]] {
        let both = picture(&mut stage.studio, &scene(stage.camera, lenses), SIZE);
        let (mut objects, red) = (0, color::linear_from_srgb([128.0 / 255.0, 0.0, 0.0])[0]);
        for i in 0..alone.rgba.len() {
            let is_object = alone.object_id.as_ref().is_some_and(|ids| ids[i] != 0);
            if !stage.inside[i] || !is_object {
                continue;
            }
            let below = color::linear_from_srgb([f32::from(alone.rgba[i][0]) / 255.0; 3])[0];
            let wanted = color::srgb_from_linear([(below + red).min(1.0); 3])[0] * 255.0;
            assert!((wanted - f32::from(both.rgba[i][0])).abs() <= 1.5, "pixel {i}: {:?}", both.rgba[i]);
            assert_eq!(alone.rgba[i][1..], both.rgba[i][1..], "pixel {i}");
            objects += 1;
        }
        assert!(objects > 500);
    }
}

#[test]
fn marble_stays_in_the_stone_and_fades_with_distance() {
    let mut studio = studio(&[citydata("square.city.json")]);
    let mut draw = |eye: DVec3, target: DVec3, height_m: f64| {
        let mut scene = scene(orthographic(eye, target, height_m), vec![]);
        scene.style.effects = vec![with_numbers("marble", &[("polish", 0.0), ("scale", 7.3)])];
        picture(&mut studio, &scene, SIZE)
    };
    // 160 pixels of 0.25 m. The eye crosses whole metres, zero and cubes of the lattice, and goes back along its view.
    let (eye, target) = (DVec3::new(-3.2, -390.1, 190.3), DVec3::new(-3.2, 10.0, 0.0));
    let back = (eye - target) * 0.2;
    let still = draw(eye, target, 40.0);
    let w = SIZE[0] as usize;
    for pixels in [0_usize, 7, 31, 90] {
        let right = DVec3::X * (0.25 * pixels as f64);
        let moved = draw(eye + right + back, target + right, 40.0);
        let pairs = (0..still.rgba.len()).filter(|i| i % w >= pixels).map(|i| (still.rgba[i], moved.rgba[i - pixels]));
        let (mut all, mut other) = (0, 0);
        for (a, b) in pairs {
            all += 1;
            other += u32::from((0..3).any(|c| a[c].abs_diff(b[c]) > 2));
        }
        // Edges of faces may fall on the other side of a pixel's middle.
        assert!(other * 200 < all, "{pixels} pixels to the right: {other} of {all} changed");
    }
    // Ground, seen from above: what the veins make of it, by how large a pixel is.
    let mut spread = |height_m: f64| {
        let above = draw(DVec3::new(0.0, 0.0, 300.0), DVec3::ZERO, height_m);
        let normals = above.normal.as_ref().expect("normals");
        let is_flat = |i: &usize| normals[*i] == [0.0, 0.0, 1.0];
        let lights: Vec<f64> = (0..w * SIZE[1] as usize).filter(is_flat).map(|i| f64::from(above.rgba[i][1])).collect();
        let mean = lights.iter().sum::<f64>() / lights.len() as f64;
        let of_squares = lights.iter().map(|l| (l - mean).powi(2)).sum::<f64>() / lights.len() as f64;
        assert!(lights.len() > 100);
        (mean, of_squares.sqrt())
    };
    let (near, far) = (spread(40.0), spread(1200.0));
    assert!(near.1 > 12.0 && far.1 < 1.0 && (near.0 - far.0).abs() < 15.0, "{near:?} {far:?}");
}

/// Whether some of these effects draw edges.
fn draws_lines(effects: &[&str]) -> bool {
    effects.iter().any(|name| find(name).is_some_and(|effect| effect.lines))
}

/// Whether some of these effects are opacity rules.
fn is_seen_through(effects: &[&str]) -> bool {
    effects.iter().any(|name| find(name).is_some_and(|e| e.kind == EffectKind::Opacity))
}

/// The passes that a lens with these effects adds to a plain frame, from what the kinds of effects are.
fn predicted(effects: &[&str]) -> Vec<String> {
    let filters = effects.iter().filter(|e| **e == "blur").count();
    let mut names = vec!["geometry", "clear lens masks"];
    if is_seen_through(effects) {
        names.push("layers");
        names.extend(effects.contains(&"peel").then_some("count layers"));
        names.push("composite");
    }
    names.extend(draws_lines(effects).then_some("lines"));
    for _ in 0..filters {
        names.extend(["unfiltered", "filter down", "filter across"]);
    }
    names.push("shade");
    names.extend(is_seen_through(effects).then_some("shown layers"));
    names.into_iter().map(str::to_owned).collect()
}

/// Whether a lens may have these effects at once.
fn go_together(names: &[&str]) -> bool {
    let is_scene = |name: &&&str| find(name).is_some_and(|e| e.kind == EffectKind::Scene);
    names.iter().filter(is_scene).count() < 2
}

/// All pairs of effects that go together.
fn pairs() -> impl Iterator<Item = [&'static str; 2]> {
    let all: Vec<&str> = ready().map(|e| e.name.as_str()).collect();
    let of = |i: usize| all[i + 1..].iter().map(|&b| [all[i], b]).collect::<Vec<_>>();
    let pairs: Vec<[&str; 2]> = (0..all.len()).flat_map(of).collect();
    pairs.into_iter().filter(|pair| go_together(pair))
}

/// A pair for each two ways in which effects add passes: by their prototypes, by lines, and by what must be counted first. Effects take
/// turns.
fn covering_pairs() -> Vec<[&'static str; 2]> {
    let way = |name: &str| find(name).map(|e| (e.kind, e.lines, e.asks_most_layers));
    let mut uses: BTreeMap<&str, usize> = BTreeMap::new();
    let mut chosen: BTreeMap<_, Vec<[&str; 2]>> = BTreeMap::new();
    for pair in pairs() {
        let mut ways = pair.map(way);
        ways.sort_unstable();
        chosen.entry(ways).or_default().push(pair);
    }
    let mut covering = Vec::new();
    for of_ways in chosen.into_values() {
        let used = |pair: &[&str; 2]| pair.iter().map(|name| uses.get(name).copied().unwrap_or(0)).sum::<usize>();
        let pair = of_ways.into_iter().min_by_key(used).expect("each has one at least");
        pair.iter().for_each(|name| *uses.entry(name).or_default() += 1);
        covering.push(pair);
    }
    covering
}

/// What a lens with these effects adds to a frame: passes, handlers and pipelines.
fn adds_its_own(stage: &mut Stage, names: &[&str]) {
    let scene = stage.scene(names.iter().map(|n| used(n)).collect());
    let statistics = studio::picture(&mut stage.studio, &scene, [48, 32]).statistics;
    let passes: Vec<String> = statistics.passes.iter().map(|p| p.name.clone()).collect();
    assert_eq!(passes, predicted(names), "{names:?}");
    let mut ran = statistics.handlers.clone();
    ran.sort_unstable();
    let mut wanted = names.to_vec();
    wanted.sort_unstable();
    assert_eq!(ran, wanted);
    // Beside geometry: shading without and with the lens, of surfaces and of the sky; what a filter reads, and the filter.
    let filters = names.iter().filter(|n| **n == "blur").count();
    let of_city = |n: &&String| n.starts_with("geometry") || n.starts_with("layers");
    let pipelines = statistics.pipelines.names.iter().filter(|n| !of_city(n));
    let lines = usize::from(draws_lines(names));
    // What lays layers over each other, what shows them to AOVs, and what counts them.
    let layers = if is_seen_through(names) { 2 + usize::from(names.contains(&"peel")) } else { 0 };
    assert_eq!(pipelines.count(), 4 + 2 * filters + lines + layers, "{:?}", statistics.pipelines.names);
}

#[test]
fn each_effect_and_each_two_prototypes_add_their_own_passes_and_handlers() {
    let mut stage = Stage::new();
    let pairs = covering_pairs();
    // What is in a pair adds its own there; in a thorough run it is tried alone, too.
    let in_pairs = |name: &str| pairs.iter().flatten().any(|other| *other == name);
    let alone = ready().filter(|effect| studio::is_thorough() || !in_pairs(&effect.name));
    alone.for_each(|effect| adds_its_own(&mut stage, &[&effect.name]));
    // Seven prototypes, hidings and scene styles with lines, and what counts layers: but for scene styles each with each.
    assert!(pairs.len() > 40, "{pairs:?}");
    pairs.iter().for_each(|pair| adds_its_own(&mut stage, pair));
}

#[test]
#[ignore = "a minute or two; ./dev hard"]
fn all_pairs_of_effects_add_their_own_passes_and_handlers() {
    let mut stage = Stage::new();
    pairs().for_each(|pair| adds_its_own(&mut stage, &pair));
}

#[test]
fn dragging_a_parameter_compiles_nothing() {
    let mut stage = Stage::new();
    stage.with(vec![with_numbers("overlay", &[("opacity", 0.2)]), used("posterise")]);
    let again =
        stage.with(vec![with_numbers("overlay", &[("opacity", 0.9)]), with_numbers("posterise", &[("steps", 7.0)])]);
    assert_eq!(again.statistics.pipelines.compiled, 0);
}

#[test]
fn a_lens_that_comes_and_goes_allocates_once() {
    let mut stage = Stage::new();
    let lensed = stage.with(vec![used("blur")]);
    assert!(lensed.statistics.frame.allocations > 0, "its images");
    // A transparent picture has filters read and write more images, which stay.
    let blurred = stage.scene(vec![used("blur")]);
    stage.studio.render(&blurred, &transparent()).expect("a picture");
    let plain = scene(stage.camera, vec![]);
    let without = picture(&mut stage.studio, &plain, SIZE);
    let again = stage.with(vec![used("blur")]);
    for (seen, before) in [(&without, &stage.plain), (&again, &lensed)] {
        assert_eq!(seen.statistics.frame.allocations, 0);
        assert!(seen.statistics.passes.iter().all(|p| p.name != "shadow map"), "the sun and the city are the same");
        assert!(seen.rgba == before.rgba, "what is in the targets from other pictures shows");
    }
    let cleared = |p: &Picture| p.statistics.passes.iter().map(|p| p.name.clone()).collect::<Vec<_>>();
    assert!(!cleared(&without).iter().any(|name| name == "clear lens masks"), "{:?}", cleared(&without));
}

// ---- effect files

struct Folder(PathBuf);

impl Folder {
    fn new(name: &str, files: &[(&str, &str)]) -> Self {
        let path = std::env::temp_dir().join(format!("veduta-effects-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&path).unwrap();
        for (file, text) in files {
            std::fs::write(path.join(file), text).unwrap();
        }
        Self(path)
    }

    fn path(&self, name: &str) -> String {
        self.0.join(name).to_str().unwrap().to_owned()
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// Exit code, stdout and stderr.
fn veduta(arguments: &[&str]) -> (i32, String, String) {
    let output = crate::program().args(arguments).output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (output.status.code().expect("the program was killed"), text(output.stdout), text(output.stderr))
}

/// The effect file that `docs/effects.md` shows.
fn documented() -> String {
    let page = include_str!("../../docs/effects.md");
    let block = page.split("```wgsl\n").nth(1).and_then(|rest| rest.split("```").next());
    block.expect("the page shows an effect").to_owned()
}

const BROKEN: &str = "//! name = \"broken\"\n//! kind = \"post\"\n//! spec = \"\"\n//! doc = \"Is broken.\"\n\n\
                      fn effect(color: vec3f, point: Point) -> vec3f {\n    return colour;\n}\n";

#[test]
fn the_effect_of_the_docs_is_right_and_works_at_once() {
    let no_number = BROKEN.replace("broken", "nothing").replace("colour", "sqrt(color - 9.0) / (color - color)");
    let folder =
        Folder::new("docs", &[("broken.wgsl", BROKEN), ("night.wgsl", &documented()), ("nothing.wgsl", &no_number)]);
    let root = folder.path("");
    let (code, _, said) = veduta(&["effects", "--check", &folder.path("night.wgsl")]);
    assert_eq!(code, 0, "{said}");
    let (code, _, said) = veduta(&["effects", "--check", &folder.path("broken.wgsl")]);
    assert_eq!(code, 1);
    assert!(said.contains("broken.wgsl:7:12: no definition in scope for identifier: `colour`"), "{said}");
    let (code, list, said) = veduta(&["effects", "--json", "--effects", &root]);
    assert_eq!(code, 0, "{said}");
    assert!(list.contains("\"night\"") && list.contains("\"greyscale\"") && !list.contains("\"broken\""));
    assert!(said.contains("this effect is left out"), "{said}");
    let model = citydata("courtyard.city.json");
    let model = model.to_str().unwrap();
    let draw = |effect: &str| {
        let picture = folder.path(&format!("{effect}.png"));
        let effect = format!("style.effects=[\"{effect}\"]");
        let size = ["--size", "64x48", "--effects", &root, "--set", &effect, "-o", &picture, "-q"];
        let (code, _, said) = veduta(&[&["render", model][..], &size].concat());
        assert_eq!(code, 0, "{said}");
        image::open(&picture).unwrap().to_rgb8()
    };
    let (plain, night) = (draw("sepia"), draw("night"));
    let mean = |image: &image::RgbImage| image.pixels().map(|p| f64::from(p.0[1])).sum::<f64>();
    assert!(mean(&night) < 0.7 * mean(&plain), "the night is not dark");
    assert!(draw("nothing").pixels().all(|p| p.0 == [0, 0, 0]), "what is no number is not black");
}

#[test]
fn a_folder_of_effects_that_is_none_is_said() {
    let folder = Folder::new("none", &[("a.txt", "")]);
    let (code, _, said) = veduta(&["effects", "--effects", &folder.path("")]);
    assert!(code == 1 && said.contains("there is no effect (*.wgsl) in this folder"), "{said}");
    let twice = BROKEN.replace("colour", "color").replace("name = \"broken\"", "name = \"sepia\"");
    let folder = Folder::new("twice", &[("mine.wgsl", &twice)]);
    let (code, _, said) = veduta(&["effects", "--effects", &folder.path("")]);
    assert!(code == 0 && said.contains("there is an effect \"sepia\" already"), "{said}");
}
