//! What overlays show: a best view in which its object stands out and fills the picture, a filled map, names in place of ids; and how large they are.

use glam::{DVec2, DVec3};
use veduta::{
    figure::{
        self,
        overlays::views::{From, local},
        scene_file,
    },
    lens::Class,
    render::picture::{Picture, Request, Studio},
    scene::Scene,
    view::View,
};

use crate::studio::*;

fn parsed(rest: &str) -> Scene {
    let text = format!("veduta = 1\n{rest}");
    scene_file::parse(&text, "s.toml", &Default::default()).unwrap_or_else(|error| panic!("{error}"))
}

/// A long house, and smaller ones around it.
fn street() -> Studio {
    let blocks = [
        ([-40, 20, 0], [80, 8, 7]),
        ([-30, 50, 0], [12, 12, 9]),
        ([10, 50, 0], [16, 10, 12]),
        ([-30, -20, 0], [12, 12, 6]),
        ([20, -20, 0], [14, 14, 8]),
    ];
    boxes("overlay-views", &blocks, false, true)
}

const LONG: &str = "[[poi]]\nname = \"long\"\nobject = \"box 0\"\n";
const EYE: &str = "[camera]\neye = [20, -110, 60]\ntarget = [0, 20, 0]\n";

fn drawn(studio: &mut Studio, scene: &Scene, size: [u32; 2]) -> Picture {
    figure::draw(studio, scene, &Request::plain(size)).expect("a picture")
}

/// The pixels of an overlay's picture.
fn part(picture: &Picture, lens: u32) -> (Vec<[u8; 4]>, [u32; 2]) {
    let shown = picture.overlays.iter().find(|shown| shown.lens == lens).expect("an overlay");
    let [x, y] = shown.at.map(|v| v as usize);
    let [w, h] = shown.size.map(|v| v as usize);
    let width = picture.size[0] as usize;
    let rows = (y..y + h).flat_map(|row| picture.rgba[row * width + x..row * width + x + w].to_vec());
    (rows.collect(), shown.size)
}

#[test]
fn an_object_fills_its_best_view_and_stands_out() {
    let mut studio = street();
    let scene = parsed(&format!("{EYE}{LONG}[[lens]]\nname = \"view\"\nkind = \"best-view\"\npoi = \"long\"\n"));
    let shown = scene.lenses[0].best_view().expect("a view");
    let main = scene.camera.expect("a camera");
    for size in [[240, 160], [160, 240], [400, 100]] {
        let from = From { main, size, tracked: None };
        let own =
            local(&mut studio, &scene, "view", shown, shown.view().expect("an eye"), &from).expect("a view").scene;
        let camera = own.camera.expect("a camera");
        let view = View::new(camera, size, &studio.extent()).expect("a view");
        let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        for corner in
            [[-40, 20, 0], [40, 20, 0], [40, 28, 0], [-40, 28, 0], [-40, 20, 7], [40, 20, 7], [40, 28, 7], [-40, 28, 7]]
        {
            let at = view.pixel(DVec3::from(corner.map(f64::from))).expect("before the eye");
            assert!(at.z >= camera.near_m);
            (low, high) = (low.min(at.truncate()), high.max(at.truncate()));
        }
        let [w, h] = size.map(f64::from);
        assert!(low.cmpge(DVec2::ZERO).all() && high.cmple(DVec2::new(w, h)).all(), "{size:?}: {low} {high}");
        let filled = ((high - low) / DVec2::new(w, h)).max_element();
        assert!(filled > 0.9, "{size:?}: {filled}");
        let last = own.lenses.last().expect("a lens that lets it stand out");
        assert!(last.effects.iter().all(|used| used.class == Class::Rest) && last.effects.len() == 2);
    }
    // In the picture: what is beside it is paler than in a view that says it is not to be.
    let mut studio = street();
    let plain = parsed(&format!(
        "{EYE}{LONG}[[lens]]\nname = \"view\"\nkind = \"best-view\"\npoi = \"long\"\nview = {{ highlight = false }}\n"
    ));
    let [pale, plain] = [&scene, &plain].map(|scene| part(&drawn(&mut studio, scene, [640, 360]), 0).0);
    let light =
        |texels: &[[u8; 4]]| texels.iter().map(|t| u64::from(t[0]) + u64::from(t[1]) + u64::from(t[2])).sum::<u64>();
    let same = pale.iter().zip(&plain).filter(|(a, b)| a == b).count();
    assert!(light(&pale) > light(&plain) && same * 12 > pale.len(), "{same} of {}", pale.len());
}

#[test]
fn maps_show_filled_buildings() {
    let mut studio = street();
    let map = |rest: &str| {
        parsed(&format!(
            "{EYE}{rest}[[lens]]\nname = \"map\"\nkind = \"map-view\"\nview = {{ height_m = 300 }}\n[[overlay]]\nlens = \"map\"\nsize = [300, 200]\nframe = \"none\"\nat = [0.7, 0.5]\n"
        ))
    };
    let brown = |[r, g, b, _]: &[u8; 4]| *r > *g && i32::from(*r) - i32::from(*b) > 45;
    let (texels, [w, h]) = part(&drawn(&mut studio, &map(""), [640, 360]), 0);
    let share = texels.iter().filter(|texel| brown(texel)).count() as f64 / f64::from(w * h);
    // Blocks of 640, 144, 160, 144 and 196 m², of which a map of 450 by 300 m around the eye shows all.
    let known = (640.0 + 144.0 + 160.0 + 144.0 + 196.0) / (450.0 * 300.0);
    assert!((0.6 * known..1.3 * known).contains(&share), "{share} of {known}");
    // One that says how it looks is as it says.
    let own = map("[style]\nlook = \"paper\"\neffects = [\"greyscale\"]\n");
    assert!(part(&drawn(&mut studio, &own, [640, 360]), 0).0.iter().all(|texel| !brown(texel)));
}

#[test]
fn overlays_have_the_same_share_of_figures_of_all_sizes() {
    let mut studio = street();
    let scene = parsed(&format!(
        "{EYE}{LONG}[[lens]]\nname = \"view\"\nkind = \"best-view\"\npoi = \"long\"\n[[overlay]]\nlens = \"view\"\nframe = \"none\"\n"
    ));
    for (size, expected) in [([1280, 720], [240, 160]), ([320, 200], [60, 40]), ([2560, 1440], [480, 320])] {
        assert_eq!(drawn(&mut studio, &scene, size).overlays[0].size, expected, "{size:?}");
    }
}

#[test]
fn words_have_room_in_small_figures() {
    let mut studio = street();
    let note = "[[lens]]\nname = \"note\"\nkind = \"annotation\"\npoi = \"long\"\ntext = \"The long house\"\n";
    let view = "[[lens]]\nname = \"view\"\nkind = \"best-view\"\npoi = \"long\"\n[[overlay]]\nlens = \"view\"\ncaption = \"The long house\"\n";
    let scene = parsed(&format!("{EYE}{LONG}{note}{view}"));
    // Ten pixels are an em: a card has 14 of them, less its rim; the other as many as its caption takes.
    let small = drawn(&mut studio, &scene, [320, 200]).overlays;
    assert_eq!(small[0].size[0], 134, "{small:?}");
    assert!((70..110).contains(&small[1].size[0]), "{small:?}");
    let large = drawn(&mut studio, &scene, [1280, 720]).overlays;
    assert!(large[0].size[0] == 232 && (220..=240).contains(&large[1].size[0]), "{large:?}");
}

#[test]
fn a_map_shows_the_city_wherever_the_eye_is() {
    let mut studio = street();
    let mut map = |eye: [f64; 2]| {
        let rest = format!(
            "[camera]\neye = [{}, {}, 60]\ntarget = [0, 20, 0]\n[[lens]]\nname = \"map\"\nkind = \"map-view\"\nview = {{ mode = \"user-view\", height_m = 200 }}\n\
             [[overlay]]\nlens = \"map\"\nsize = [300, 200]\nframe = \"none\"\n",
            eye[0], eye[1]
        );
        part(&drawn(&mut studio, &parsed(&rest), [640, 360]), 0).0
    };
    for eye in [[0.0, 0.0], [0.0, -900.0], [800.0, 700.0]] {
        let texels = map(eye);
        let built = texels.iter().filter(|[r, g, b, _]| r > g && i32::from(*r) - i32::from(*b) > 45).count();
        let needle = texels.iter().filter(|[r, g, b, _]| *r > 180 && *g < 80 && *b < 80).count();
        assert!(built > 200 && needle > 20, "{eye:?}: {built} texels of buildings, {needle} of the sign of the eye");
    }
}

#[test]
fn outlines_of_objects_are_drawn_with_their_notches() {
    let mut studio = boxes("overlay-area", &[([-20, 0, 0], [40, 6, 4]), ([-20, 6, 0], [6, 30, 4])], false, true);
    let scene = |to: &str| {
        parsed(&format!(
            "[camera]\neye = [0, 15, 120]\ntarget = [0, 15, 0]\nprojection = \"orthographic\"\nheight_m = 60\n\
             [[poi]]\nname = \"a\"\nobject = \"box 0\"\n[[lens]]\nname = \"note\"\nkind = \"annotation\"\npoi = \"a\"\ntext = \"a\"\ncolor = \"#ff00ff\"\n\
             [[overlay]]\nlens = \"note\"\nline = {{ kind = \"straight\", to = \"{to}\" }}\n"
        ))
    };
    let pink = |picture: &Picture| picture.rgba.iter().filter(|[r, g, b, _]| *r > 200 && *g < 90 && *b > 200).count();
    let [point, area] = ["point", "area"].map(|to| pink(&drawn(&mut studio, &scene(to), [400, 240])));
    // A rectangle of 40 by 6 m at 4 pixels a metre has a rim of 368 pixels, about two wide.
    assert!(area > point + 300, "{area} {point}");
}
