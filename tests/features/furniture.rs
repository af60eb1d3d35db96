//! Titles, captions and legends in pictures: what they show, and what they cost where there are none.

use std::collections::BTreeMap;

use crate::studio::*;
use glam::DVec3;
use veduta::{
    figure::{
        self,
        legend::legends,
        overlays,
        paper::{self, Format},
        scene_file,
    },
    geom::Shape,
    lens::{EffectUse, Lens, Parameter, ramp::ramp},
    overlay::Rect,
    render::{
        bands::Band,
        furniture::{Furniture, Panel, Piece},
        picture::{Aovs, Picture, Request, Studio},
        text::{Halo, TextLine, TextStyle, Weight},
    },
    scene::{Background, Figure, PiecePlace, Scene},
    view::{Camera, View},
};

const SIZE: [u32; 2] = [640, 360];

fn thematic(attribute: &str) -> EffectUse {
    let parameters = BTreeMap::from([("attribute".to_owned(), Parameter::Text(attribute.to_owned()))]);
    EffectUse { parameters, ..used("thematic") }
}

fn town() -> Studio {
    studio(&["builtin:town".into()])
}

/// The town with one lens of one effect.
fn scene_of(effect: EffectUse) -> Scene {
    let shape = Shape::Sphere { center: DVec3::new(0.0, -40.0, 10.0), radius: 110.0 };
    let lens = Lens { effects: vec![effect], ..lens("a lens", vec![shape], "sepia") };
    let camera = Camera::looking(DVec3::new(210.0, -560.0, 330.0), DVec3::new(0.0, -40.0, 15.0), 0.66);
    Scene { figure: Figure { legend: PiecePlace::Auto, ..Figure::default() }, ..scene(camera, vec![lens]) }
}

fn request(samples: u32, transparent: bool) -> Request {
    Request { samples, transparent, statistics: true, ..Request::plain(SIZE) }
}

fn bytes(color: [f32; 3]) -> [u8; 4] {
    let [r, g, b] = color.map(|c| (c * 255.0).round() as u8);
    [r, g, b, 255]
}

fn panels(furniture: &Furniture) -> Vec<Panel> {
    let panel = |piece: &Piece| match piece {
        Piece::Panel(panel) => Some(*panel),
        _ => None,
    };
    furniture.pieces.iter().filter_map(panel).collect()
}

fn pixel(picture: &Picture, x: f32, y: f32) -> [u8; 4] {
    picture.rgba[y as usize * picture.size[0] as usize + x as usize]
}

#[test]
fn a_legend_bar_has_the_colours_of_the_ramp() {
    let mut studio = town();
    let scene = scene_of(thematic("yearOfConstruction"));
    let furniture = figure::furniture_of(&studio, &scene, SIZE).expect("furniture").furniture;
    let drawn = figure::draw(&mut studio, &scene, &request(1, false)).expect("a picture");
    // The bar: panels of one row, of full opacity, side by side.
    let panels = panels(&furniture);
    let is_bar = |p: &&Panel| p.opacity == 1.0 && p.radius_px == 0.0 && p.high[1] - p.low[1] == 9.0;
    let bar: Vec<&Panel> = panels.iter().filter(is_bar).collect();
    let (left, right) = (bar[0].low[0], bar[bar.len() - 1].high[0]);
    assert_eq!(right - left, 130.0, "13 em of 10 pixels");
    for x in 0..130_u16 {
        let expected = bytes(ramp("viridis", (f64::from(x) + 0.5) / 130.0));
        for y in [bar[0].low[1], bar[0].high[1] - 1.0] {
            assert_eq!(pixel(&drawn, left + f32::from(x), y), expected, "column {x}");
        }
    }
}

#[test]
fn swatches_have_the_colours_of_the_categories() {
    let mut studio = town();
    for samples in [1, 3] {
        let scene = scene_of(thematic("function"));
        let furniture = figure::furniture_of(&studio, &scene, SIZE).expect("furniture").furniture;
        let drawn = figure::draw(&mut studio, &scene, &request(samples, false)).expect("a picture");
        let legend = legends(&scene, &studio.model, &[true], &studio.model, &[]).remove(0);
        let panels = panels(&furniture);
        let swatches: Vec<&Panel> =
            panels.iter().filter(|p| p.opacity == 1.0 && p.high[1] - p.low[1] == 9.0 && p.radius_px == 2.0).collect();
        assert!(swatches.len() >= 3 && swatches.len() == legend.scale.legend.len());
        for (swatch, entry) in swatches.iter().zip(&legend.scale.legend) {
            let at = [0, 1].map(|i| (swatch.low[i] + swatch.high[i]) / 2.0);
            assert_eq!(pixel(&drawn, at[0], at[1]), bytes(entry.color), "{}", entry.label);
        }
    }
}

#[test]
fn beside_its_card_a_legend_changes_nothing_and_no_aov_sees_it() {
    let mut studio = town();
    let scene = scene_of(thematic("function"));
    let asked = Request { aovs: ALL, ..request(2, false) };
    let plain = studio.render(&scene, &asked).expect("a picture");
    let drawn = figure::draw(&mut studio, &scene, &asked).expect("a picture");
    let card = panels(&figure::furniture_of(&studio, &scene, SIZE).expect("furniture").furniture)[0];
    let margin = card.softness_px / 2.0 + 1.0;
    let mut changed = 0;
    for (i, (a, b)) in plain.rgba.iter().zip(&drawn.rgba).enumerate() {
        let at = [i as u32 % SIZE[0], i as u32 / SIZE[0]].map(|v| v as f32 + 0.5);
        let near = (0..2).all(|k| at[k] > card.low[k] - margin && at[k] < card.high[k] + margin);
        assert!(near || a == b, "{at:?}");
        changed += u32::from(a != b);
    }
    assert!(changed > 5000, "{changed}");
    assert_eq!(plain.object_id, drawn.object_id);
    assert_eq!(plain.normal, drawn.normal);
    assert_eq!(plain.lens_mask, drawn.lens_mask);
    assert_eq!(plain.depth, drawn.depth);
    assert_eq!(plain.statistics.lenses[0].pixels, drawn.statistics.lenses[0].pixels);
}

#[test]
fn who_asks_for_nothing_pays_nothing() {
    let scenes = [
        Scene { figure: Figure::default(), ..scene_of(thematic("function")) },
        // A legend, but of no colours that can be seen.
        scene_of(used("sepia")),
        {
            let mut scene = scene_of(thematic("function"));
            scene.lenses[0].enabled = false;
            scene
        },
        {
            let mut scene = scene_of(thematic("function"));
            scene.lenses[0].shapes = vec![Shape::Sphere { center: DVec3::new(0.0, -5e4, 0.0), radius: 10.0 }.into()];
            scene
        },
    ];
    for scene in scenes {
        // Each on a renderer of its own: what was made for one is there for the next.
        let plain = town().render(&scene, &request(2, false)).expect("a picture");
        let drawn = figure::draw(&mut town(), &scene, &request(2, false)).expect("a picture");
        assert!(plain.rgba == drawn.rgba);
        let names = |p: &Picture| p.statistics.passes.iter().map(|pass| pass.name.clone()).collect::<Vec<_>>();
        assert_eq!(names(&plain), names(&drawn));
        assert_eq!(plain.statistics.pipelines.names, drawn.statistics.pipelines.names);
        let made = |p: &Picture| (p.statistics.frame.allocations, p.statistics.frame.uploads);
        assert_eq!(made(&plain), made(&drawn));
        assert_eq!(plain.statistics.frame.peak_gpu_bytes, drawn.statistics.frame.peak_gpu_bytes);
    }
}

#[test]
fn the_same_furniture_gives_the_same_bytes_and_is_made_once() {
    let mut studio = town();
    let mut scene = scene_of(thematic("yearOfConstruction"));
    scene.figure.title = Some("How old the town is".into());
    let first = figure::draw(&mut studio, &scene, &request(1, false)).expect("a picture");
    let again = figure::draw(&mut studio, &scene, &request(1, false)).expect("a picture");
    assert!(first.rgba == again.rgba);
    assert!(figure::draw(&mut town(), &scene, &request(1, false)).expect("a picture").rgba == first.rgba);
    let frame = &again.statistics.frame;
    assert_eq!((again.statistics.pipelines.compiled, frame.allocations, frame.uploads), (0, 0, 0));
    let passes: Vec<_> = first.statistics.passes.iter().filter(|p| p.name == "furniture").collect();
    assert_eq!((passes.len(), passes[0].draws), (1, 1));
    assert_eq!(first.statistics.pipelines.names.iter().filter(|n| n.contains("furniture")).count(), 1);
}

/// A picture of nothing but a background, with furniture.
fn over(background: [f32; 3], size: [u32; 2], transparent: bool, pieces: Vec<Piece>) -> Picture {
    let mut studio = studio(&[citydata("cube.city.json")]);
    let away = Camera::looking(DVec3::new(0.0, 0.0, 500.0), DVec3::new(0.0, 1.0, 1000.0), 0.5);
    let mut scene = scene(away, vec![]);
    scene.style.background = Background::Color(background);
    let request = Request { transparent, ..Request::plain(size) };
    studio.render_with(&scene, &request, &Furniture { pieces }).expect("a picture")
}

fn line(text: &str, at: [f32; 2]) -> Piece {
    let style = TextStyle { size_px: 30.0, weight: Weight::SemiBold, tabular: false };
    let halo = Some(Halo { color: [0.0; 3], width_px: 3.0, opacity: 0.7 });
    Piece::Text(TextLine { text: text.into(), at, style, color: [1.0, 0.9, 0.2], halo })
}

#[test]
fn tiles_of_a_large_picture_show_one_text() {
    // A target is 4096 wide and keeps 4080 columns: this text lies across that border.
    let pieces = |shift: f32| {
        let panel = |x: f32| Panel {
            low: [x + shift, 10.0],
            high: [x + shift + 150.0, 50.0],
            color: [0.1, 0.3, 0.5],
            opacity: 0.6,
            radius_px: 9.0,
            softness_px: 1.0,
            ellipse: false,
        };
        vec![Piece::Panel(panel(20.0)), line("Rotterdam", [30.0 + shift, 40.0])]
    };
    let small = over([0.5; 3], [200, 60], false, pieces(0.0));
    let large = over([0.5; 3], [4200, 60], false, pieces(4000.0));
    for y in 0..60 {
        let row = |picture: &Picture, from: usize| {
            let width = picture.size[0] as usize;
            picture.rgba[y * width + from..y * width + from + 200].to_vec()
        };
        assert!(row(&small, 0) == row(&large, 4000), "row {y}");
    }
    assert!(small.rgba.iter().filter(|p| p[0] > 200 && p[2] < 120).count() > 300, "no letters");
}

#[test]
fn furniture_over_nothing_keeps_its_colour() {
    let panel = Panel {
        low: [10.0, 10.0],
        high: [50.0, 50.0],
        color: [0.8, 0.4, 0.2],
        opacity: 0.5,
        radius_px: 0.0,
        softness_px: 1.0,
        ellipse: false,
    };
    let drawn = over([1.0; 3], [60, 60], true, vec![Piece::Panel(panel)]);
    let [r, g, b, a] = pixel(&drawn, 30.0, 30.0);
    assert!([r, g, b].iter().zip([204_i32, 102, 51]).all(|(c, e)| (i32::from(*c) - e).abs() <= 1), "{r} {g} {b}");
    assert!((i32::from(a) - 128).abs() <= 1, "{a}");
    assert_eq!(pixel(&drawn, 5.0, 5.0), [0; 4]);
    // Twice a half is three quarters.
    let drawn = over([1.0; 3], [60, 60], true, vec![Piece::Panel(panel), Piece::Panel(panel)]);
    assert!((i32::from(pixel(&drawn, 30.0, 30.0)[3]) - 191).abs() <= 1);
    // Over a colour: the mean of both in linear light.
    let drawn = over([0.0; 3], [60, 60], false, vec![Piece::Panel(panel)]);
    assert!((i32::from(pixel(&drawn, 30.0, 30.0)[0]) - 150).abs() <= 1, "{:?}", pixel(&drawn, 30.0, 30.0));
}

#[test]
fn no_text_is_too_much() {
    let mut studio = town();
    let long = "A".repeat(1_000_000);
    let texts = [
        "\u{202e}שלום עולם مرحبا\u{202c}",
        "👩‍👩‍👧‍👦😀🏳️‍🌈",
        "\u{0}\u{1}\u{7}\u{1b}[31m\r\n\t\u{85}",
        "Z̸̧̢̛̤͎͓̱̈́̈́͛͒͝a̵l̷g̶o",
        "\n\n\n\n\n\n",
        &long,
        "漢字かな한글 ไทย हिन्दी",
    ];
    let effect = EffectUse {
        parameters: thematic("function")
            .parameters
            .into_iter()
            .chain([("label".to_owned(), Parameter::Text(long.clone()))])
            .collect(),
        ..thematic("function")
    };
    for text in texts {
        let mut scene = scene_of(effect.clone());
        scene.lenses[0].name = text.into();
        scene.figure.title = Some(text.into());
        scene.figure.caption = Some(text.into());
        let drawn = figure::draw(&mut studio, &scene, &request(1, false)).expect("a picture");
        let furniture = figure::furniture_of(&studio, &scene, SIZE).expect("furniture").furniture;
        assert!(furniture.pieces.len() < 500);
        // Text never covers the picture's middle.
        let plain = studio.render(&scene, &request(1, false)).expect("a picture");
        assert_eq!(pixel(&drawn, 320.0, 180.0), pixel(&plain, 320.0, 180.0));
    }
}

#[test]
fn characters_that_no_font_has_are_counted_once() {
    let mut scene = scene_of(thematic("function"));
    scene.figure.title = Some("東京 서울 Αθήνα Минск".into());
    let drawn = figure::draw(&mut town(), &scene, &request(1, false)).expect("a picture");
    assert!(drawn.statistics.warnings.iter().all(|warning| warning["code"] != "no-glyph"));
    scene.figure.title = Some("東京 😀😀 ש".into());
    scene.figure.caption = Some("😀".into());
    let drawn = figure::draw(&mut town(), &scene, &request(1, false)).expect("a picture");
    let told: Vec<_> = drawn.statistics.warnings.iter().filter(|warning| warning["code"] == "no-glyph").collect();
    assert_eq!((told.len(), &told[0]["count"]), (1, &2.into()));
    assert_eq!(told[0]["message"], "no font has ש (U+05E9), 😀 (U+1F600): drawn as boxes");
}

#[test]
fn the_font_has_its_notice() {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    let read = |name: &str| std::fs::read_to_string(root.join(name)).expect(name);
    assert!(read("assets/font/OFL.txt").contains("SIL OPEN FONT LICENSE Version 1.1"));
    let notice = read("assets/font/NOTICE.md");
    for file in std::fs::read_dir(root.join("assets/font")).expect("the folder") {
        let name = file.expect("an entry").file_name().to_string_lossy().into_owned();
        assert!(name == "NOTICE.md" || notice.contains(&name), "{name} is not in the notice");
    }
    assert!(read("README.md").contains("assets/font/OFL.txt"));
}

/// Eight overlays around a town, with a title, a caption and a legend.
const LABELLED: &str = r##"
veduta = 1

[city]
files = ["builtin:town"]

[camera]
eye = [-240.0, -310.0, 170.0]
target = [0.0, 0.0, 10.0]

[figure]
title = "Eight places of a town"
caption = "Each stands beside what it names, and what the figure says of itself is left free."
legend = "bottom-right"

[[lens]]
name = "ages"
shape = { kind = "sphere", center = [0.0, -40.0, 10.0], radius = 110.0 }
effects = [{ effect = "thematic", attribute = "yearOfConstruction" }]
"##;

#[test]
fn overlays_leave_titles_captions_and_legends_free() {
    let mut studio = town();
    let mut text = LABELLED.to_owned();
    for i in 0..8 {
        let turn = f64::from(i) * std::f64::consts::TAU / 8.0;
        let (x, y) = (90.0 * turn.cos(), 90.0 * turn.sin());
        text += &format!(
            "[[poi]]\nname = \"p{i}\"\nat = [{x:.3}, {y:.3}, 8.0]\n[[lens]]\nname = \"l{i}\"\nkind = \"annotation\"\npoi = \"p{i}\"\n\
             text = \"Place {i}\"\n[[overlay]]\nlens = \"l{i}\"\nsize = [150, 56]\n"
        );
    }
    let scene =
        scene_file::parse(&text, "s", &scene_file::Options::for_command_line()).unwrap_or_else(|e| panic!("{e}"));
    let mut is_there_something = false;
    for size in [SIZE, [1280, 720], [720, 1280]] {
        let asked = Request { size, ..request(1, false) };
        let own = figure::furniture_of(&studio, &scene, size).unwrap();
        let cards = own.taken;
        assert!((3..=6).contains(&cards.len()), "title, caption and legend, and their shadows: {cards:?}");
        let meets = |standing: &overlays::Standing| {
            let placed = standing.of_picture().expect("overlays");
            let is_over = |p: &&veduta::overlay::Placement| cards.iter().any(|card| card.within(&p.rect, 0));
            (placed.placements.iter().filter(is_over).count(), placed.placements.len())
        };
        let [mut careless, mut careful] = [(); 2].map(|()| overlays::Standing::default());
        overlays::overlays(&mut studio, &scene, &asked, &[], &mut careless).unwrap();
        let made = overlays::overlays(&mut studio, &scene, &asked, &cards, &mut careful).unwrap();
        is_there_something |= meets(&careless).0 > 0;
        assert_eq!(meets(&careful), (0, 8), "{size:?}");
        // That is what a figure is.
        let pieces = made.furniture.pieces.into_iter().chain(own.furniture.pieces).collect();
        let drawn = studio.render_with(&scene, &asked, &Furniture { pieces }).unwrap();
        assert_eq!(figure::draw(&mut studio, &scene, &asked).unwrap().rgba, drawn.rgba, "{size:?}");
        if let Some(folder) = std::env::var_os("VEDUTA_SHOW") {
            let file = std::path::Path::new(&folder).join(format!("labelled-{}.png", size[0]));
            figure::picture::save_picture(&file, size, &drawn.rgba, true, &Default::default()).unwrap();
        }
    }
    assert!(is_there_something, "there is something to leave free");
}

/// A figure of some of everything, of a number: its scene file and its size.
fn random_figure(seed: u64) -> (String, [u32; 2]) {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    let mut below = |most: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % most
    };
    let place = |below: &mut dyn FnMut(usize) -> usize| match below(11) {
        0 => format!("[{:.3}, {:.3}]", below(1001) as f64 / 1000.0, below(1001) as f64 / 1000.0),
        i => {
            let words = [
                "auto",
                "top-left",
                "top-right",
                "bottom-left",
                "bottom-right",
                "top",
                "bottom",
                "left",
                "right",
                "auto",
            ];
            format!("\"{}\"", words[i - 1])
        }
    };
    let size = [400 + below(1200) as u32, 300 + below(900) as u32];
    let words = ["Houses", "of", "a", "town", "by", "their", "years,", "as", "the", "register", "has", "them"];
    let mut text = "veduta = 1\n[city]\nfiles = [\"builtin:town\"]\n[camera]\n".to_owned();
    let turn = below(360) as f64 / 57.3;
    let eye = [350.0 * turn.cos(), 350.0 * turn.sin(), 60.0 + below(400) as f64];
    text += &format!("eye = {eye:?}\ntarget = [0.0, 0.0, 10.0]\n");
    if below(2) == 0 {
        text += "projection = \"orthographic\"\nheight_m = 400.0\n";
    }
    text += "[figure]\n";
    let said = |key: &str, most: usize, below: &mut dyn FnMut(usize) -> usize| {
        let count = 1 + below(most);
        let line: Vec<&str> = (0..count).map(|_| words[below(words.len())]).collect();
        format!("{key} = \"{}\"\n{key}_at = {}\n", line.join(" "), place(below))
    };
    if below(4) > 0 {
        text += &said("title", 12, &mut below);
    }
    if below(4) > 0 {
        text += &said("caption", 30, &mut below);
    }
    let place = |below: &mut dyn FnMut(usize) -> usize| match below(9) {
        0 => format!("[{:.3}, {:.3}]", below(1001) as f64 / 1000.0, below(1001) as f64 / 1000.0),
        i => format!(
            "\"{}\"",
            ["auto", "top-left", "top-right", "bottom-left", "bottom-right", "top", "left", "right"][i - 1]
        ),
    };
    for key in ["legend", "scale_bar", "north_arrow"] {
        if below(4) > 0 {
            text += &format!("{key} = {}\n", place(&mut below));
        }
    }
    text += "[[lens]]\nname = \"ages\"\nshape = { kind = \"sphere\", center = [0.0, -40.0, 10.0], radius = 110.0 }\n";
    text += "effects = [{ effect = \"thematic\", attribute = \"yearOfConstruction\" }]\n";
    for i in 0..below(6) {
        let turn = below(360) as f64 / 57.3;
        text += &format!(
            "[[poi]]\nname = \"p{i}\"\nat = [{:.3}, {:.3}, 8.0]\n[[lens]]\nname = \"l{i}\"\nkind = \"annotation\"\npoi = \"p{i}\"\n\
             text = \"Place {i}\"\n[[overlay]]\nlens = \"l{i}\"\nsize = [{}, {}]\n",
            90.0 * turn.cos(),
            90.0 * turn.sin(),
            90 + below(80),
            40 + below(50),
        );
        // At most one has a place of its own: two of them may stand on each other.
        if i == 0 && below(2) == 0 {
            text += &match below(2) {
                0 => format!("at = [{:.3}, {:.3}]\n", below(1001) as f64 / 1000.0, below(1001) as f64 / 1000.0),
                _ => "call_out = { height_m = 20.0 }\n".to_owned(),
            };
        }
    }
    (text, size)
}

#[test]
fn nothing_of_a_figure_stands_on_anything() {
    let mut studio = town();
    let (mut pieces, mut left_out, mut placed) = (0, 0, 0);
    for seed in 0..200 {
        let (text, size) = random_figure(seed);
        let scene = scene_file::parse(&text, "s", &scene_file::Options::for_command_line())
            .unwrap_or_else(|error| panic!("{error}\n{text}"));
        let laid = figure::furniture_of(&studio, &scene, size).expect("furniture");
        let mut standing = overlays::Standing::default();
        overlays::pass(&mut studio, &scene, size, &laid.taken, &mut standing).expect("places");
        let view = View::new(studio.camera(&scene, size), size, &studio.extent()).expect("a view");
        let is_card = |p: &&Panel| p.color == [1.0; 3] && p.opacity > 0.9 && p.opacity < 1.0;
        let panels = panels(&laid.furniture);
        let rect = |low: [f32; 2], high: [f32; 2]| Rect {
            min: low.map(|v| v.floor() as i32),
            max: high.map(|v| v.ceil() as i32),
        };
        let mut all: Vec<Rect> = panels.iter().filter(is_card).map(|p| rect(p.low, p.high)).collect();
        // What has no card comes last of what is taken.
        let is_of_panel = |taken: &&Rect| panels.iter().any(|p| rect(p.low, p.high) == **taken);
        all.extend(laid.taken.iter().filter(|taken| !is_of_panel(taken)));
        let figure = &scene.figure;
        let asked = [figure.title.is_some(), figure.caption.is_some()].into_iter().filter(|is| *is).count()
            + [figure.legend, figure.scale_bar, figure.north_arrow].iter().filter(|place| place.is_some()).count();
        assert_eq!(all.len() + laid.left_out.len(), asked, "{seed}: {:?}\n{text}", laid.left_out);
        pieces += all.len();
        left_out += laid.left_out.len();
        let own = overlays::standing(&studio, &scene, &view);
        let of_picture = standing.of_picture().map_or(&[][..], |placed| &placed.placements);
        placed += own.len() + of_picture.len();
        all.extend(own);
        all.extend(of_picture.iter().map(|placement| placement.rect));
        for (i, a) in all.iter().enumerate() {
            let is_in = (0..2).all(|axis| a.min[axis] >= 0 && a.max[axis] <= size[axis] as i32);
            assert!(is_in, "{seed}: {a:?} in {size:?}\n{text}");
            for b in &all[..i] {
                let is_apart = (0..2).any(|axis| a.max[axis] <= b.min[axis] || b.max[axis] <= a.min[axis]);
                assert!(is_apart, "{seed}: {a:?} on {b:?} in {size:?}\n{text}");
            }
        }
    }
    // Most have room.
    assert!(
        pieces > 500 && placed > 200 && left_out * 10 < pieces,
        "{pieces} pieces, {left_out} left out, {placed} overlays"
    );
    println!("{pieces} pieces, {left_out} left out, {placed} overlays");
}

#[test]
fn a_scale_bar_measures_what_is_drawn() {
    let mut studio = town();
    // A lens 200 m long, seen from above and from the side.
    let shape =
        Shape::Box { center: DVec3::ZERO, size: DVec3::new(200.0, 120.0, 400.0), rotation: glam::DQuat::IDENTITY };
    for eye in [DVec3::new(0.0, -0.01, 700.0), DVec3::new(0.0, -500.0, 300.0)] {
        let camera = orthographic(eye, DVec3::ZERO, 300.0);
        let figure = Figure { scale_bar: PiecePlace::Auto, ..Figure::default() };
        let scene = Scene { figure, ..scene(camera, vec![lens("a", vec![shape.clone()], "sepia")]) };
        let asked =
            Request { size: [1280, 720], aovs: Aovs { lens_mask: true, ..Aovs::default() }, ..request(1, false) };
        let drawn = figure::draw(&mut studio, &scene, &asked).expect("a picture");
        let mask = &drawn.lens_mask.as_ref().expect("a mask")[0];
        let columns = (0..1280).filter(|x| (0..720).any(|y| mask[y * 1280 + x] & 1 == 1)).count() as f64;
        let laid = figure::furniture_of(&studio, &scene, [1280, 720]).expect("furniture").furniture;
        let bar = panels(&laid).into_iter().find(|p| p.radius_px == 0.0 && p.opacity == 1.0).expect("a bar");
        let said = laid.pieces.iter().find_map(|piece| match piece {
            Piece::Text(line) => line.text.strip_suffix("\u{a0}m")?.parse::<f64>().ok(),
            _ => None,
        });
        let metres = said.expect("a length") / f64::from(bar.high[0] - bar.low[0]) * columns;
        assert!((metres / 200.0 - 1.0).abs() < 0.005, "{metres} m");
        // And in the picture: as many dark and white pixels, one after the other.
        let y = (0.5 * (bar.low[1] + bar.high[1])).round();
        let is_bar = |x: i32| {
            let [r, g, b, _] = pixel(&drawn, x as f32, y);
            let is_dark = [r, g, b].iter().all(|c| *c < 60);
            is_dark || [r, g, b] == [255; 3]
        };
        let seen = (bar.low[0] as i32..).take_while(|x| is_bar(*x)).count() as f32;
        assert!((seen - (bar.high[0] - bar.low[0])).abs() <= 1.5, "{seen} pixels of {bar:?}");
    }
}

#[test]
fn what_boards_say_is_text_on_paper() {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/call-outs.toml");
    let mut scene = scene_file::read(&path, &scene_file::Options::for_file(&path)).expect("a scene");
    scene.figure.set_pixels([640, 360]);
    let mut studio = of_scene(&scene);
    let asked = request(1, false);
    let file = std::env::temp_dir().join(format!("veduta-boards-{}.svg", std::process::id()));
    let target = paper::Target { path: &file, format: Format::Svg, notes: &Default::default() };
    let mut rgba = Vec::new();
    let mut also = |band: &Band| {
        rgba.extend_from_slice(&band.rgba);
        Ok(())
    };
    let (picture, drawn) = paper::draw(&mut studio, &scene, &asked, target, &mut also).expect("a figure");
    drawn.finish().expect("a file");
    assert!(picture.rgba.is_empty(), "no more than one band at a time");
    assert!(rgba == studio.render(&scene, &asked).expect("a picture").rgba, "the picture alone");
    let svg = std::fs::read_to_string(&file).expect("a file");
    std::fs::remove_file(&file).expect("a file");
    for words in [&["Fountain"][..], &["Old ", "Church"], &["Town ", "hall, ", "1893"], &["Windmill"]] {
        for word in words {
            let is_there =
                |line: &str| line.contains(&format!(">{word}</text>")) && line.contains("transform=\"matrix(");
            assert!(svg.lines().any(is_there), "\"{word}\"");
        }
    }
    assert!(svg.contains(">Along the market</text>"), "of an overlay in the plane of the picture");
    // The picture, four boards of which one has no image, and the overlay's picture; the lines are areas.
    assert_eq!((svg.matches("<image ").count(), svg.matches("<path ").count() > 8), (6, true));
    assert!(figure::draw(&mut studio, &scene, &asked).expect("a picture").rgba != rgba);
}
