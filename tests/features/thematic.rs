//! Thematic colours through the shader: classes are told in sun and in shade, and faces have the colours of where they look.

use std::collections::BTreeMap;

use crate::studio::*;
use glam::DVec3;
use veduta::{
    figure::{
        legend::legends,
        scene_file::{Options, parse},
    },
    lens::{
        EffectUse, Parameter,
        color::{Srgb, difference, linear_from_oklab, oklab_from_srgb, srgb_from_linear},
        ramp::RAMPS,
        thematic::ThematicScale,
    },
    render::{
        frame::Backend,
        picture::{Aovs, Picture, Request, Studio},
    },
    scene::{Scene, Sun},
    view::Camera,
};

const SIZE: [u32; 2] = [256, 144];

fn text(word: &str) -> Parameter {
    Parameter::Text(word.into())
}

fn thematic(attribute: &str, more: &[(&str, Parameter)]) -> EffectUse {
    let own = BTreeMap::from([("attribute".to_owned(), text(attribute))]);
    let more = more.iter().map(|(key, value)| ((*key).to_owned(), value.clone()));
    EffectUse { parameters: own.into_iter().chain(more).collect(), ..used("thematic") }
}

/// Blocks in a row from west to east, each 4 m higher than the last.
fn blocks(count: i64) -> Studio {
    let all: Vec<_> = (0..count).map(|i| ([14 * i, 0, 0], [10, 10, 6 + 4 * i])).collect();
    boxes("classes", &all, false, false)
}

/// All of it, from the south-west; a low sun in the west-south-west, so that south sides are lit aslant, west sides straight on or in the shade
/// of lower neighbours, and with the sun behind it, north and east sides not at all.
fn scene_of(effect: EffectUse, from: DVec3, sun_deg: f64) -> Scene {
    let camera = Camera::looking(from, DVec3::new(56.0, 5.0, 14.0), 0.75);
    let mut scene = scene(camera, Vec::new());
    scene.sun = Sun { azimuth: sun_deg.to_radians(), elevation: 0.5, shadows: true, ..Sun::default() };
    scene.style.effects = vec![effect];
    scene
}

fn draw(studio: &mut Studio, scene: &Scene, backend: Backend) -> Picture {
    let aovs = Aovs { object_id: true, normal: true, ..Aovs::default() };
    let request = Request { aovs, backend, ..Request::plain(SIZE) };
    studio.render(scene, &request).expect("a picture")
}

fn scale(studio: &Studio, scene: &Scene) -> ThematicScale {
    legends(scene, &studio.model, &[true; 8], &studio.model, &[]).remove(0).scale
}

/// Pixels of objects: the object, and the colour, sRGB.
fn pixels(picture: &Picture) -> Vec<(usize, Srgb)> {
    let ids = picture.object_id.as_ref().expect("objects");
    let of = |(id, [r, g, b, _]): (&u32, &[u8; 4])| {
        (*id > 0).then(|| (*id as usize - 1, [*r, *g, *b].map(|c| f32::from(c) / 255.0)))
    };
    ids.iter().zip(&picture.rgba).filter_map(of).collect()
}

/// Holds every pixel to its legend: nearest to its own entry of all, hue and chroma its own as far as a screen has them. How far light moved
/// lightness, in multiples of the relief, at least and at most.
fn hold(studio: &Studio, scene: &Scene, picture: &Picture, name: &str) -> [f32; 2] {
    let scale = scale(studio, scene);
    let own = scale.object_colors(&studio.model);
    let mut moved = [f32::MAX, f32::MIN];
    for (object, seen) in pixels(picture) {
        let far = |color: &Srgb| difference(seen, *color);
        let nearest = scale.legend.iter().map(|entry| entry.color).min_by(|a, b| far(a).total_cmp(&far(b)));
        assert_eq!(nearest, Some(own[object]), "{name}: {seen:?} of {object}");
        let [lightness, a, b] = oklab_from_srgb(own[object]);
        let [shown, c, d] = oklab_from_srgb(seen);
        let whole = linear_from_oklab([shown, a, b]);
        if whole.iter().all(|channel| (0.005..0.995).contains(channel)) {
            // A step of 8 bits, and what it makes of lightness.
            let expected = srgb_from_linear(whole);
            let off = (0..3).map(|k| (expected[k] - seen[k]).abs()).fold(0.0, f32::max) * 255.0;
            assert!(off < 2.5, "{name}: {seen:?}, not {expected:?}");
        }
        // Where a screen does not have it: less chroma, on the same line from grey, but for what 8 bits make of dark colours.
        let (own_chroma, chroma, step) = (a.hypot(b), c.hypot(d), if shown < 0.2 { 0.03 } else { 0.008 });
        assert!(chroma <= own_chroma + step && (a * d - b * c).abs() <= step * own_chroma, "{name}: {seen:?}");
        let share = (shown - lightness) / scale.relief;
        moved = [moved[0].min(share), moved[1].max(share)];
    }
    moved
}

#[test]
fn every_class_of_every_ramp_is_told_in_sun_and_in_shade() {
    let mut studio = blocks(9);
    for (i, row) in RAMPS.iter().enumerate() {
        for classes in [9.0, 4.0] {
            let more = [("ramp", text(row.name)), ("scale", text("equal")), ("classes", Parameter::Number(classes))];
            let effect = thematic("geometry:height", &more);
            for (from, sun) in [(DVec3::new(-40.0, -120.0, 70.0), 240.0), (DVec3::new(150.0, -90.0, 60.0), 300.0)] {
                let scene = scene_of(effect.clone(), from, sun);
                let picture = draw(&mut studio, &scene, Backend::Specialised);
                let name = format!("{} {classes} {sun}", row.name);
                let moved = hold(&studio, &scene, &picture, &name);
                let entries = scale(&studio, &scene).legend;
                assert_eq!(entries.len(), classes as usize, "{name}");
                assert!(entries.iter().all(|entry| entry.count > 0), "{name}");
                // Lit and shaded pixels are both there.
                assert!(moved[0] < -0.3 && moved[1] > 0.3, "{name}: {moved:?}");
                let seen: std::collections::BTreeSet<usize> = pixels(&picture).iter().map(|p| p.0).collect();
                assert_eq!(seen.len(), 9, "{name}");
            }
        }
        if i == 0 {
            let scene = scene_of(thematic("geometry:height", &[]), DVec3::new(-40.0, -120.0, 70.0), 240.0);
            let both = [Backend::Specialised, Backend::Uber].map(|backend| draw(&mut studio, &scene, backend).rgba);
            assert_eq!(both[0], both[1]);
        }
    }
}

#[test]
fn relief_is_a_share_of_what_light_may_do() {
    let mut studio = blocks(5);
    let of = |studio: &mut Studio, relief: f64| {
        let effect = thematic("geometry:height", &[("relief", Parameter::Number(relief))]);
        let scene = scene_of(effect, DVec3::new(-40.0, -120.0, 70.0), 240.0);
        let picture = draw(studio, &scene, Backend::Specialised);
        (scale(studio, &scene), pixels(&picture))
    };
    let (scale, flat) = of(&mut studio, 0.0);
    let own = scale.object_colors(&studio.model);
    for (object, seen) in flat {
        assert!((0..3).all(|k| (own[object][k] - seen[k]).abs() * 255.0 < 1.01), "{seen:?}: {:?}", own[object]);
    }
    let range = |pixels: &[(usize, Srgb)]| {
        let lightness = pixels.iter().filter(|p| p.0 == 2).map(|p| oklab_from_srgb(p.1)[0]);
        let [low, high] = lightness.fold([f32::MAX, f32::MIN], |[low, high], l| [low.min(l), high.max(l)]);
        high - low
    };
    let [half, whole] = [0.5, 1.0].map(|relief| range(&of(&mut studio, relief).1));
    assert!((half - 0.5 * whole).abs() < 0.012 && whole > 0.06, "{half} {whole}");
}

#[test]
fn faces_have_the_colours_of_their_slopes_and_directions() {
    let mut studio = studio(&["builtin:town".into()]);
    let camera = Camera::looking(DVec3::new(210.0, -460.0, 330.0), DVec3::new(0.0, -40.0, 15.0), 0.5);
    for (attribute, whole) in [("surface:slope", 90.0), ("surface:azimuth", 360.0)] {
        let mut scene = scene(camera, Vec::new());
        scene.style.effects = vec![thematic(attribute, &[("relief", Parameter::Number(0.0))])];
        let pictures = [Backend::Specialised, Backend::Uber].map(|backend| draw(&mut studio, &scene, backend));
        assert_eq!(pictures[0].rgba, pictures[1].rgba, "{attribute}");
        let scale = scale(&studio, &scene);
        let picture = &pictures[0];
        let (normals, ids) = (picture.normal.as_ref().expect("normals"), picture.object_id.as_ref().expect("objects"));
        let mut seen = std::collections::BTreeSet::new();
        let mut counts = [0, 0];
        for ((normal, id), [r, g, b, _]) in normals.iter().zip(ids).zip(&picture.rgba) {
            if *id == 0 {
                continue;
            }
            let [x, y, z] = normal.map(f64::from);
            let slope = z.abs().min(1.0).acos().to_degrees();
            let value = match attribute {
                "surface:slope" => Some(slope),
                _ => (slope > 1.0).then(|| x.atan2(y).to_degrees().rem_euclid(360.0)),
            };
            let shown = [*r, *g, *b].map(|c| f32::from(c) / 255.0);
            let is = |turned: f64| {
                let color = |value: f64| scale.color_of_number((value + turned).rem_euclid(360.0));
                difference(shown, value.map_or(scale.no_data, color)) < 0.02
            };
            // Few faces are seen from behind: their normal in the picture is turned to the eye.
            counts[usize::from(!is(0.0))] += 1;
            assert!(is(0.0) || is(180.0), "{attribute} {value:?}: {shown:?}");
            seen.insert(value.map(|value| (value / whole * 24.0) as u32));
        }
        assert!(seen.len() >= 4 && counts[1] * 20 < counts[0], "{attribute}: {seen:?} {counts:?}");
    }
}

#[test]
fn faces_have_the_colours_of_their_semantic_surfaces() {
    let mut studio = studio(&[citydata("semantics.city.json")]);
    let middle = studio.extent().center();
    for from in [DVec3::new(14.0, -16.0, 13.0), DVec3::new(-15.0, 12.0, 14.0)] {
        let mut scene = scene(Camera::looking(middle + from, middle, 0.8), Vec::new());
        scene.style.effects = vec![thematic("surface:colour", &[("relief", Parameter::Number(0.0))])];
        let pictures = [Backend::Specialised, Backend::Uber].map(|backend| draw(&mut studio, &scene, backend));
        assert_eq!(pictures[0].rgba, pictures[1].rgba);
        let scale = scale(&studio, &scene);
        let (white, grey) = (scale.legend[0].color, scale.no_data);
        let normals = pictures[0].normal.as_ref().expect("normals");
        let ids = pictures[0].object_id.as_ref().expect("objects");
        let mut counts = [0, 0];
        for ((normal, id), [r, g, b, _]) in
            normals.iter().zip(ids).zip(&pictures[0].rgba).filter(|((_, id), _)| **id > 0)
        {
            let is_wall = normal[2].abs() < 0.1;
            let shown = [*r, *g, *b].map(|c| f32::from(c) / 255.0);
            assert!(difference(shown, if is_wall { white } else { grey }) < 0.01, "{normal:?} of {id}: {shown:?}");
            counts[usize::from(is_wall)] += 1;
        }
        assert!(counts[0] > 300 && counts[1] > 300, "{counts:?}");
    }
}

#[test]
fn effects_after_it_contents_and_deformations_go_on_working() {
    let mut studio = studio(&["builtin:town".into()]);
    let shape = "shape = { kind = \"box\", center = [5, 3, 20], size = [120, 90, 40] }";
    let colors = "{ effect = \"thematic\", attribute = \"geometry:height\" }";
    let mut draw = |effects: &str, kind: &str, more: &str| {
        let text = format!(
            "veduta = 1\n[city]\nfiles = [\"builtin:town\"]\nground = false\n[camera]\neye = [-90, -140, 100]\ntarget = [0, 0, 10]\n\
             [[lens]]\nname = \"a\"\nbody = \"none\"\n{kind}{shape}\neffects = [{effects}]\n{more}"
        );
        let scene = parse(&text, "s.toml", &Options::default()).unwrap_or_else(|error| panic!("{error}"));
        let [a, b] = [Backend::Specialised, Backend::Uber].map(|backend| draw(&mut studio, &scene, backend));
        assert!(a.rgba == b.rgba && a.object_id == b.object_id && a.normal == b.normal, "{effects} {kind} {more}");
        a
    };
    let plain = draw(colors, "", "");
    let brown = draw(&format!("{colors}, \"sepia\""), "", "");
    // Objects and normals are what they are without colours.
    let none = draw("\"flat\"", "", "");
    assert!(none.object_id == plain.object_id && none.normal == plain.normal && plain.object_id == brown.object_id);
    let changed: Vec<[u8; 4]> = plain.rgba.iter().zip(&brown.rgba).filter(|(a, b)| a != b).map(|(_, b)| *b).collect();
    assert!(changed.len() > 3000 && changed.iter().all(|[r, g, b, _]| r >= g && g >= b), "{}", changed.len());
    let twist = format!(
        "[[lens]]\nname = \"b\"\nkind = \"deformation\"\nbody = \"none\"\n{shape}\ndeform = [{{ kind = \"twist\", angle_deg = 30.0 }}]\n"
    );
    assert_ne!(draw(colors, "", &twist).object_id, plain.object_id);
    // A content has the colours of the same scale.
    let content = "kind = \"content\"\ncontent = { from = [60, 20, 0], to = [5, 3, 0] }\n";
    let elsewhere = draw(colors, content, "");
    let without = draw("\"flat\"", content, "");
    assert!(elsewhere.object_id == without.object_id && elsewhere.object_id != plain.object_id);
    assert_ne!(elsewhere.rgba, without.rgba);
}
