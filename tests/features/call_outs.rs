//! Overlays with places of their own: on boards in the scene, in perspective, and where their author wants them in
//! the picture.

use crate::studio::*;
use glam::{DVec2, DVec3};
use veduta::{
    figure::{
        self,
        overlays::Standing,
        scene_file::{Options, parse},
    },
    render::picture::{Picture, Request, Studio},
    scene::Scene,
};

const SIZE: [u32; 2] = [640, 360];
const EYE: DVec3 = DVec3::new(-75.0, -110.0, 62.0);
const TARGET: DVec3 = DVec3::new(8.0, 12.0, 4.0);
const FOV_DEG: f64 = 46.0;

/// A folder with an image of four colours, which goes with it.
struct Folder(std::path::PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let folder = std::env::temp_dir().join(format!("veduta-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a folder");
        let four = |x: u32, y: u32| image::Rgba(COLORS[usize::from(x >= 60) + 2 * usize::from(y >= 40)]);
        image::RgbaImage::from_fn(120, 80, four).save(folder.join("four.png")).expect("an image");
        Self(folder)
    }

    fn scene(&self, rest: &str) -> Scene {
        let head = "veduta = 1\n[city]\nfiles = [\"builtin:square\"]\n[camera]\neye = [-75, -110, 62]\ntarget = [8, 12, 4]\n\
                    fov_deg = 46\n[figure]\nsize = [640, 360]\n";
        let options = Options { base: self.0.clone(), ..Options::default() };
        parse(&format!("{head}{rest}"), "s.toml", &options).unwrap_or_else(|error| panic!("{error}"))
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        std::fs::remove_dir_all(&self.0).expect("the folder");
    }
}

/// Upper left, upper right, lower left, lower right.
const COLORS: [[u8; 4]; 4] = [[255, 0, 255, 255], [0, 255, 0, 255], [255, 255, 0, 255], [0, 0, 255, 255]];

/// A lens that shows the four colours, of a place.
fn four(name: &str, at: [f64; 3], overlay: &str) -> String {
    format!(
        "[[poi]]\nname = \"{name}\"\nat = {at:?}\n[[lens]]\nname = \"{name}\"\nkind = \"annotation\"\nimage = \"four.png\"\n\
         color = \"#ff00ff\"\npoi = \"{name}\"\n[[overlay]]\nlens = \"{name}\"\nsize = [120, 80]\n{overlay}\n"
    )
}

const PLAIN: &str = "frame = \"none\"\nline = \"none\"\n";

fn request(size: [u32; 2]) -> Request {
    Request { statistics: true, ..Request::plain(size) }
}

fn drawn(studio: &mut Studio, scene: &Scene) -> Picture {
    figure::draw(studio, scene, &request(SIZE)).unwrap()
}

/// Of an overlay of a picture: its lens, and its rectangle.
fn told(picture: &Picture) -> Vec<(u64, [i64; 4])> {
    let of = |own: &serde_json::Value| {
        let [x, y, w, h] = ["x", "y", "width", "height"].map(|key| own[key].as_i64().unwrap());
        (own["lens"].as_u64().unwrap(), [x, y, x + w, y + h])
    };
    picture.statistics.overlays.iter().map(of).collect()
}

fn rendered(picture: &Picture) -> Vec<bool> {
    picture.statistics.overlays.iter().map(|own| own["rendered"].as_bool().unwrap()).collect()
}

fn pixel(picture: &Picture, at: DVec2) -> [u8; 4] {
    picture.rgba[at.y.floor() as usize * picture.size[0] as usize + at.x.floor() as usize]
}

/// A pinhole camera at [`EYE`], worked out here: where a place is in the picture.
fn seen(place: DVec3) -> DVec2 {
    let ahead = (TARGET - EYE).normalize_or(DVec3::X);
    let right = ahead.cross(DVec3::Z).normalize_or(DVec3::X);
    let from_eye = place - EYE;
    let f = 180.0 / (0.5 * FOV_DEG.to_radians()).tan();
    let (x, y) = (from_eye.dot(right), from_eye.dot(right.cross(ahead)));
    DVec2::new(320.0, 180.0) + f / from_eye.dot(ahead) * DVec2::new(x, -y)
}

/// Where (u, v) of a board that is `width` wide, two thirds of that high, and stands on `foot` is in the picture.
fn on_board(foot: DVec3, width: f64, tilt: f64, [u, v]: [f64; 2]) -> DVec2 {
    let to_eye = (EYE - foot).with_z(0.0).normalize_or(DVec3::X);
    let right = DVec3::Z.cross(to_eye);
    let up = tilt.cos() * DVec3::Z - tilt.sin() * to_eye;
    seen(foot + (u - 0.5) * width * right + (1.0 - v) * width * 2.0 / 3.0 * up)
}

#[test]
fn a_board_shows_its_overlay_in_perspective() {
    let folder = Folder::new("board");
    for tilt in [0.0_f64, 35.0, 60.0, -20.0] {
        let call_out = format!("{PLAIN}call_out = {{ height_m = 14, width_m = 60, tilt_deg = {tilt} }}");
        let scene = folder.scene(&four("a", [10.0, 20.0, 3.0], &call_out));
        let mut studio = of_scene(&scene);
        let picture = drawn(&mut studio, &scene);
        let bare = drawn(&mut studio, &Scene { lenses: Vec::new(), overlays: Vec::new(), ..scene.clone() });
        let foot = DVec3::new(10.0, 20.0, 17.0);
        let at = |u: f64, v: f64| on_board(foot, 60.0, tilt.to_radians(), [u, v]);
        for u in [0.02, 0.2, 0.47, 0.53, 0.8, 0.98] {
            for v in [0.03, 0.3, 0.46, 0.54, 0.7, 0.97] {
                let expected = COLORS[usize::from(u > 0.5) + 2 * usize::from(v > 0.5)];
                assert_eq!(pixel(&picture, at(u, v)), expected, "({u}, {v}) tilted by {tilt}°");
            }
        }
        for (u, v) in [(-0.02, 0.5), (1.02, 0.5), (0.5, -0.04), (0.5, 1.04), (-0.02, 1.04), (1.02, -0.04)] {
            assert_eq!(pixel(&picture, at(u, v)), pixel(&bare, at(u, v)), "beside it: ({u}, {v}) tilted by {tilt}°");
        }
        // Statistics tell the rectangle around it.
        let corners = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)].map(|(u, v)| at(u, v));
        let low = corners.into_iter().reduce(DVec2::min).unwrap().floor();
        let high = corners.into_iter().reduce(DVec2::max).unwrap().ceil();
        let around = [low.x, low.y, high.x, high.y].map(|v| v as i64);
        assert_eq!(told(&picture), [(0, around)]);
    }
}

#[test]
fn near_boards_and_their_lines_lie_over_far_ones_whatever_their_order() {
    let folder = Folder::new("order");
    let own = |name: &str, at: [f64; 3], height: f64| {
        let line = "line = { color = \"#00ffff\", width = 6, end_width = 6 }";
        let call_out =
            format!("frame = \"none\"\n{line}\ncall_out = {{ height_m = {height}, width_m = 40, tilt_deg = 0 }}");
        four(name, at, &call_out)
    };
    // The pole of the near one passes before the far board.
    let (near, far) = (own("near", [-20.0, -25.0, 3.0], 45.0), own("far", [16.0, 27.0, 3.0], 14.0));
    let pictures = [format!("{near}{far}"), format!("{far}{near}")].map(|rest| {
        let scene = folder.scene(&rest);
        drawn(&mut of_scene(&scene), &scene)
    });
    assert!(pictures[0].rgba == pictures[1].rgba, "the order of lenses changes nothing");
    let far_board = |u: f64, v: f64| on_board(DVec3::new(16.0, 27.0, 17.0), 40.0, 0.0, [u, v]);
    let foot = DVec3::new(-20.0, -25.0, 48.0);
    let mut on_far = 0;
    // From below its edge on.
    for step in 10..100 {
        let at = seen(foot.with_z(48.0 - 0.45 * f64::from(step)));
        let (low, high) = (far_board(0.0, 0.0), far_board(1.0, 1.0));
        if at.cmpgt(low + 4.0).all() && at.cmplt(high - 4.0).all() {
            on_far += 1;
            assert_eq!(pixel(&pictures[0], at), [0, 255, 255, 255], "{at}");
        }
    }
    assert!(on_far > 10, "{on_far} of its points lie over the far board");
}

fn is_magenta([r, g, b, _]: [u8; 4]) -> bool {
    r > 200 && g < 60 && b > 200
}

/// The middle of all magenta pixels, and how many they are.
fn magenta(picture: &Picture) -> Option<(DVec2, usize)> {
    let place = |i: usize| DVec2::new((i % 640) as f64 + 0.5, (i / 640) as f64 + 0.5);
    let found: Vec<DVec2> = (0..picture.rgba.len()).filter(|&i| is_magenta(picture.rgba[i])).map(place).collect();
    (!found.is_empty()).then(|| (found.iter().sum::<DVec2>() / found.len() as f64, found.len()))
}

#[test]
fn what_is_not_seen_is_an_arrow_at_the_border() {
    let folder = Folder::new("arrow");
    // Behind, below and to the left; and a board far above its place in the picture.
    for (at, call_out, is_there) in [
        ([-150.0, -300.0, 10.0], "{}", (|tip: DVec2| tip.y > 330.0 || tip.x < 20.0) as fn(DVec2) -> bool),
        ([8.0, 12.0, 40.0], "{ height_m = 400, width_m = 20 }", |tip| tip.y < 30.0),
    ] {
        let lens = four("a", at, &format!("frame = \"none\"\ncall_out = {call_out}"));
        let scene = folder.scene(&lens);
        let mut studio = of_scene(&scene);
        let picture = drawn(&mut studio, &scene);
        let (tip, count) = magenta(&picture).expect("an arrow");
        assert!((20..200).contains(&count) && is_there(tip), "{count} pixels at {tip}");
        assert!(told(&picture).is_empty());
        let hidden = lens.replace("frame =", "line = { outside = \"hidden\" }\nframe =");
        assert_eq!(magenta(&drawn(&mut studio, &folder.scene(&hidden))), None);
    }
}

#[test]
fn others_leave_boards_and_pinned_overlays_free() {
    let folder = Folder::new("free");
    let mut rest = four("board", [20.0, 30.0, 3.0], "call_out = { height_m = 8, width_m = 50 }");
    rest += &four("pinned", [0.0, 0.0, 3.0], "frame = \"none\"\nat = [0.2, 0.5]");
    for i in 0..8 {
        rest += &four(&format!("n{i}"), [8.0 * f64::from(i) - 20.0, 10.0, 3.0], "frame = \"none\"\nmin = [100, 66]");
    }
    rest += "[layout]\ngap = 12.0\n";
    let scene = folder.scene(&rest);
    let picture = drawn(&mut of_scene(&scene), &scene);
    let all = told(&picture);
    assert_eq!(all.len(), 10);
    assert_eq!(all[1], (1, [68, 140, 188, 220]), "120 by 80 around (128, 180)");
    for (i, (lens, a)) in all.iter().enumerate() {
        for (other, b) in &all[..i] {
            // The board and what is pinned stand where they stand.
            if *lens >= 2 {
                let is_apart = (0..2).any(|i| a[i] >= b[i + 2] + 12 || b[i] >= a[i + 2] + 12);
                assert!(is_apart, "{lens} at {a:?} and {other} at {b:?}");
            }
        }
    }
}

#[test]
fn a_pinned_overlay_stands_where_its_author_wants_it() {
    let folder = Folder::new("pinned");
    let scene = |overlay: &str| {
        folder.scene(&four("a", [8.0, 12.0, 4.0], &format!("frame = \"none\"\n{overlay}\n[layout]\nmargin = 16.0")))
    };
    let mut studio = of_scene(&scene(""));
    for (size, at, expected) in [
        (SIZE, [0.5, 0.25], [260, 50, 380, 130]),
        ([320, 200], [0.5, 0.25], [100, 16, 220, 96]),
        (SIZE, [0.0, 1.0], [16, 264, 136, 344]),
        (SIZE, [1.0, 0.0], [504, 16, 624, 96]),
        ([120, 90], [0.5, 0.5], [16, 16, 104, 74]),
    ] {
        let scene = scene(&format!("at = {at:?}"));
        let picture = figure::draw(&mut studio, &scene, &request(size)).unwrap();
        assert_eq!(told(&picture), [(0, expected)], "{at:?} of {size:?}");
        let middle = DVec2::new((expected[0] + expected[2]) as f64, (expected[1] + expected[3]) as f64) * 0.5;
        for (x, y, color) in [(-20.0, -15.0, 0), (20.0, -15.0, 1), (-20.0, 15.0, 2), (20.0, 15.0, 3)] {
            assert_eq!(pixel(&picture, middle + DVec2::new(x, y)), COLORS[color]);
        }
    }
    // Half of its size does not fit: a marker, as for others.
    let small = figure::draw(&mut studio, &scene("at = [0.5, 0.5]"), &request([90, 60])).unwrap();
    assert!(told(&small).is_empty());
    // Its line leaves it for the place, which is in the middle of the picture.
    let line =
        drawn(&mut studio, &scene("at = [0.5, 0.2]\nline = { color = \"#00ffff\", width = 6.0, end_width = 1.5 }"));
    for y in [120.0, 140.0, 160.0] {
        assert_eq!(pixel(&line, DVec2::new(320.0, y)), [0, 255, 255, 255], "{y}");
    }
}

#[test]
fn of_pinned_overlays_the_later_lies_in_front() {
    let folder = Folder::new("front");
    let place = [8.0, 12.0, 4.0];
    let first = four("first", place, &format!("{PLAIN}at = [0.4, 0.4]"));
    let scene = folder.scene(&format!("{first}{}", four("second", place, &format!("{PLAIN}at = [0.5, 0.5]"))));
    let picture = drawn(&mut of_scene(&scene), &scene);
    assert_eq!(told(&picture), [(0, [196, 104, 316, 184]), (1, [260, 140, 380, 220])]);
    assert_eq!(pixel(&picture, DVec2::new(280.0, 160.0)), COLORS[0], "the upper left of the second");
}

#[test]
fn boards_are_drawn_again_only_when_they_show_something_else() {
    let folder = Folder::new("again");
    let board = |caption: &str| {
        format!(
            "[[overlay]]\nlens = \"inner\"\nsize = [150, 100]\ncaption = \"{caption}\"\ncall_out = {{ width_m = 30 }}\n"
        )
    };
    let rest = "[[poi]]\nname = \"hall\"\nobject = \"town-hall\"\n\
                [[lens]]\nname = \"inner\"\nkind = \"best-view\"\npoi = \"hall\"\n\
                [[lens]]\nname = \"outer\"\nkind = \"see-through\"\nview = { eye = [-75, -110, 90], target = [8, 12, 30] }\nlenses = [\"inner\"]\n";
    let scene = folder.scene(&format!("{rest}{}", board("one")));
    let mut studio = of_scene(&scene);
    let mut standing = Standing::default();
    let mut draw = |scene: &Scene| figure::draw_next(&mut studio, scene, &request(SIZE), &mut standing).unwrap();
    let first = draw(&scene);
    assert_eq!(rendered(&first), [true, true]);
    // The smallest of them has block models made, for which all are drawn again.
    draw(&scene);
    let again = draw(&scene);
    assert_eq!((rendered(&again), again.rgba == first.rgba), (vec![false; 2], true), "nothing changed");
    let mut moved = scene.clone();
    moved.camera.as_mut().unwrap().eye += DVec3::new(0.5, 0.5, 0.0);
    let aside = draw(&moved);
    assert_eq!((rendered(&aside), aside.rgba == first.rgba), (vec![false; 2], false), "it is the same board elsewhere");
    moved.camera.as_mut().unwrap().eye = EYE.lerp(TARGET, 0.4);
    assert_eq!(rendered(&draw(&moved)), [true, false], "nearer it has more pixels");
    let other = folder.scene(&format!("{rest}{}", board("two")));
    draw(&scene);
    assert_eq!(rendered(&draw(&other)), [true, true], "another caption, also on the board in the overlay");
}

#[test]
fn characters_that_no_font_has_are_told_of_boards_too() {
    let folder = Folder::new("glyph");
    let scene = folder.scene(&four("a", [8.0, 12.0, 4.0], "caption = \"\u{1cff}\"\ncall_out = {}"));
    let picture = drawn(&mut of_scene(&scene), &scene);
    assert!(picture.without_glyph.contains(&'\u{1cff}'), "{:?}", picture.without_glyph);
}

#[test]
fn over_nothing_a_board_is_all_there_is() {
    let folder = Folder::new("nothing");
    let mut scene = folder.scene(&four("a", [8.0, 12.0, 4.0], &format!("{PLAIN}call_out = {{ height_m = 30 }}")));
    scene.city.ground = false;
    let mut studio = of_scene(&scene);
    let asked = Request { transparent: true, ..request(SIZE) };
    let picture = figure::draw(&mut studio, &scene, &asked).unwrap();
    let [x, y, right, low] = told(&picture)[0].1;
    let middle = DVec2::new((x + right) as f64, (y + low) as f64) * 0.5;
    // The city ends below it.
    for (dx, dy, color) in [(-20.0, -15.0, 0), (20.0, -15.0, 1), (-20.0, 15.0, 2), (20.0, 15.0, 3)] {
        assert_eq!(pixel(&picture, middle + DVec2::new(dx, dy)), COLORS[color]);
    }
    assert_eq!(pixel(&picture, DVec2::new(x as f64 - 4.0, middle.y))[3], 0);
}
