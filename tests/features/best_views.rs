//! Best-view lenses in pictures: overlays show what their own eyes see, pixel by pixel, and only when it changed.

use crate::studio::*;
use glam::{DVec2, DVec3};
use veduta::{
    figure::{
        self,
        overlays::{Standing, views},
        scene_file::{Options, parse, read, set_within},
    },
    lens::best_view::LocalView,
    overlay::Placed,
    render::picture::{Aovs, Picture, Request, Studio},
    scene::Scene,
    view::{Camera, local},
};

const SIZE: [u32; 2] = [640, 360];

/// A scene over the market square, from above the church.
fn square(rest: &str) -> Scene {
    let head = "veduta = 1\n[city]\nfiles = [\"builtin:square\"]\n[camera]\neye = [-75, -110, 62]\ntarget = [8, 12, 4]\n\
                fov_deg = 46\n[figure]\nsize = [640, 360]\n";
    parse(&format!("{head}{rest}"), "s.toml", &Options::default()).unwrap_or_else(|error| panic!("{error}"))
}

fn request(size: [u32; 2]) -> Request {
    Request { statistics: true, ..Request::plain(size) }
}

fn drawn(studio: &mut Studio, scene: &Scene) -> Picture {
    figure::draw(studio, scene, &request(SIZE)).unwrap()
}

/// Of an overlay of a picture: lens, left and top, width and height, whether it was drawn.
type Told = (usize, [usize; 2], [usize; 2], bool);

fn told(picture: &Picture) -> Vec<Told> {
    let number = |v: &serde_json::Value, key: &str| v[key].as_u64().unwrap() as usize;
    let overlays = picture.statistics.overlays.iter();
    overlays
        .map(|v| {
            let [lens, x, y, w, h] = ["lens", "x", "y", "width", "height"].map(|key| number(v, key));
            (lens, [x, y], [w, h], v["rendered"].as_bool().unwrap())
        })
        .collect()
}

fn rendered(picture: &Picture) -> Vec<bool> {
    told(picture).iter().map(|t| t.3).collect()
}

/// What is shown in a part of a picture.
fn part(picture: &Picture, at: [usize; 2], size: [usize; 2]) -> Vec<[u8; 4]> {
    let width = picture.size[0] as usize;
    (0..size[1]).flat_map(|y| picture.rgba[(at[1] + y) * width + at[0]..][..size[0]].iter().copied()).collect()
}

/// The picture of what a lens of a scene shows, drawn by itself.
fn alone(studio: &mut Studio, scene: &Scene, lens: usize, size: [u32; 2]) -> Picture {
    let camera = studio.camera(scene, SIZE);
    let own = &scene.lenses[lens];
    let shown = own.best_view().unwrap();
    let from = views::From { main: camera, size, tracked: None };
    let made = views::local(studio, scene, &own.name, shown, shown.view().unwrap(), &from).unwrap();
    let mut own = made.scene.clone();
    own.lenses.retain(|lens| !lens.kind.has_overlay());
    studio.render(&own, &request(size)).unwrap()
}

const PLAIN: &str = "frame = \"none\"\nline = \"none\"\n";

#[test]
fn overlays_show_what_their_own_eyes_see_texel_by_texel() {
    let views = [
        ("best-view", "poi = \"hall\"", ""),
        ("best-view", "poi = \"hall\"", "normal = [0, -1, 1]"),
        ("best-view", "poi = \"hall\"", "normal = [0, 0, 2]"),
        ("best-view", "", "kind = \"mcop\", distance = 80"),
        ("best-view", "", "kind = \"scop\", direction = [1, 0, -0.5]"),
        ("best-view", "", "kind = \"scop\", direction = [1, 1, 0], axes = \"world\", mirror = true"),
        ("map-view", "", "mode = \"head-up\", height_m = 300"),
        ("see-through", "", "eye = [0, -60, 30], target = [0, 0, 5]"),
        ("portal", "", "eye = [60, 60, 30], target = [0, 0, 5]"),
    ];
    let mut studio = None;
    for (kind, poi, view) in views {
        let scene = square(&format!(
            "[[poi]]\nname = \"hall\"\nobject = \"town-hall\"\n[[lens]]\nname = \"a\"\nkind = \"{kind}\"\n{poi}\nview = {{ {view} }}\n\
             [[overlay]]\nlens = \"a\"\nsize = [150, 101]\n{PLAIN}"
        ));
        let studio = studio.get_or_insert_with(|| of_scene(&scene));
        let picture = drawn(studio, &scene);
        let (lens, at, size, is_new) = told(&picture)[0];
        assert_eq!((lens, size, is_new), (0, [150, 101], true), "{view}: at exactly its size");
        let mut expected = alone(studio, &scene, 0, [150, 101]).rgba;
        if view.contains("mirror") {
            expected = expected.chunks(150).flat_map(|row| row.iter().rev().copied()).collect();
        }
        let shown = part(&picture, at, size);
        let other = shown.iter().zip(&expected).filter(|(a, b)| a != b).count();
        // The compass of a head-up map, the only sign among these, is 30 pixels wide.
        let sign = if kind == "map-view" { 32 * 32 } else { 0 };
        assert!(other <= sign, "{kind} {view}: {other} texels differ");
        assert_eq!(other > 0, kind == "map-view", "{kind} {view}");
    }
}

#[test]
fn an_overlay_is_drawn_again_only_when_what_it_shows_changed() {
    let scene = square(
        "[[poi]]\nname = \"hall\"\nobject = \"town-hall\"\n[[lens]]\nname = \"hall\"\nkind = \"best-view\"\npoi = \"hall\"\n\
         [[lens]]\nname = \"map\"\nkind = \"map-view\"\n[[lens]]\nname = \"note\"\nkind = \"annotation\"\ntext = \"x\"\npoi = \"hall\"\n\
         [[overlay]]\nlens = \"hall\"\nsize = [160, 100]\n[[overlay]]\nlens = \"map\"\nsize = [160, 100]\n\
         [[lens]]\nname = \"old\"\nshape = { kind = \"sphere\", center = [44, -7, 10], radius = 15 }\neffects = [\"sepia\"]\n",
    );
    let mut studio = of_scene(&scene);
    let mut standing = Standing::default();
    let mut draw = |scene: &Scene| figure::draw_next(&mut studio, scene, &request(SIZE), &mut standing).unwrap();
    let first = draw(&scene);
    assert_eq!(rendered(&first), [true, true, false]);
    let again = draw(&scene);
    assert_eq!((rendered(&again), again.rgba == first.rgba), (vec![false; 3], true), "nothing changed");
    let mut moved = scene.clone();
    moved.camera.as_mut().unwrap().eye.z += 1.0;
    assert_eq!(rendered(&draw(&moved)), [false; 3], "the main eye rose: map and best view stay as they are");
    moved.camera.as_mut().unwrap().eye.x += 3.0;
    assert_eq!(rendered(&draw(&moved)), [false, true, false], "the map follows the main eye");
    moved.figure.title = Some("Title".into());
    assert_eq!(rendered(&draw(&moved)), [false; 3], "titles are those of the main picture");
    moved.lenses[3].effects = vec![used("invert")];
    assert_eq!(rendered(&draw(&moved)), [true, true, false], "lenses of the world act in every view");
    moved.sun.elevation -= 0.1;
    assert_eq!(rendered(&draw(&moved)), [true, true, false]);
    moved.lenses[0].enabled = false;
    assert_eq!(rendered(&draw(&moved)), [false, false], "what is off takes no place");
    moved.lenses[0].enabled = true;
    assert_eq!(rendered(&draw(&moved)), [true, false, false], "and was forgotten");
}

#[test]
fn views_in_views_are_drawn_again_from_the_inside_outwards() {
    let scene = square(
        "[[lens]]\nname = \"outer\"\nkind = \"see-through\"\nview = { eye = [0, -60, 30], target = [0, 0, 5] }\nlenses = [\"inner\"]\n\
         [[lens]]\nname = \"inner\"\nkind = \"see-through\"\nview = { eye = [60, 60, 30], target = [0, 0, 5] }\n\
         [[overlay]]\nlens = \"outer\"\nsize = [300, 200]\n[[overlay]]\nlens = \"inner\"\nsize = [120, 80]\n",
    );
    let mut studio = of_scene(&scene);
    let first = drawn(&mut studio, &scene);
    let told_first = told(&first);
    assert_eq!(rendered(&first), [true, true], "the inner one stands in the picture too");
    assert_eq!(rendered(&drawn(&mut studio, &scene)), [false, false]);
    // The view in the view: what the outer overlay shows holds the frame and the picture of the inner one.
    let mut without = scene.clone();
    without.lenses[0].kind.best_view_mut().unwrap().lenses = Some(Vec::new());
    let plain = drawn(&mut studio, &without);
    let (_, at, size, _) = told_first[0];
    let differing = part(&first, at, size).iter().zip(part(&plain, at, size)).filter(|(a, b)| **a != *b).count();
    assert!((110 * 70..130 * 95).contains(&differing), "{differing}");
    // What the inner one shows changes: both are drawn again.
    drawn(&mut studio, &scene);
    let mut moved = scene.clone();
    moved.lenses[1].kind.best_view_mut().unwrap().depiction =
        veduta::lens::best_view::Depiction::View(LocalView::Camera {
            camera: Camera::looking(DVec3::new(60.0, 50.0, 30.0), DVec3::ZERO, 0.8),
            above_ground: false,
        });
    assert_eq!(rendered(&drawn(&mut studio, &moved)), [true, true]);
}

#[test]
fn views_nest_three_deep_whatever_their_numbers() {
    let mut rest = String::new();
    for i in 0..20 {
        rest += &format!(
            "[[lens]]\nname = \"c{i}\"\nbody = \"none\"\nshape = {{ kind = \"sphere\", center = [{i}, 0, 5], radius = 4 }}\neffects = [\"sepia\"]\n"
        );
    }
    for (name, inner) in [("a", "[\"b\"]"), ("b", "[\"c\"]"), ("c", "[]")] {
        rest += &format!(
            "[[lens]]\nname = \"{name}\"\nkind = \"see-through\"\nview = {{ eye = [0, -60, 30], target = [0, 0, 5] }}\nlenses = {inner}\n\
             [[overlay]]\nlens = \"{name}\"\nsize = [200, 130]\n"
        );
    }
    let scene = square(&rest);
    let mut studio = of_scene(&scene);
    assert_eq!(rendered(&drawn(&mut studio, &scene)), [true; 3]);
    assert_eq!(rendered(&drawn(&mut studio, &scene)), [false; 3]);
}

/// The middle of all pixels of a part of a picture that are of a colour, and how many they are.
fn middle_of(pixels: &[[u8; 4]], width: usize, is_it: impl Fn([u8; 4]) -> bool) -> Option<(DVec2, usize)> {
    let found: Vec<DVec2> = (0..pixels.len())
        .filter(|&i| is_it(pixels[i]))
        .map(|i| DVec2::new((i % width) as f64 + 0.5, (i / width) as f64 + 0.5))
        .collect();
    (!found.is_empty()).then(|| (found.iter().sum::<DVec2>() / found.len() as f64, found.len()))
}

/// A column of pure magenta at a place, seen from above as a disc of 6 m.
fn marked(at: DVec3, rest: &str) -> Scene {
    let [x, y] = [at.x, at.y];
    square(&format!(
        "[[lens]]\nname = \"mark\"\nbody = \"none\"\nshape = {{ kind = \"cylinder\", center = [{x}, {y}, 0], radius = 3, height = 400 }}\n\
         effects = [{{ effect = \"flat\" }}, {{ effect = \"overlay\", color = \"#ff00ff\", opacity = 1.0 }}]\n{rest}"
    ))
}

fn is_magenta([r, g, b, _]: [u8; 4]) -> bool {
    r > 200 && g < 60 && b > 200
}

#[test]
fn a_fisheye_shows_places_where_its_closed_form_has_them() {
    // The eye is at (−75, −110); the map shows 200 m on 180 pixels.
    for (frame, reach) in [("ellipse", 1.0), ("none", std::f64::consts::SQRT_2)] {
        for offset in [DVec2::new(12.0, 5.0), DVec2::new(30.0, 40.0), DVec2::new(-20.0, 55.0)] {
            let place = DVec2::new(-75.0, -110.0) + offset;
            let scene = marked(
                place.extend(0.0),
                &format!(
                    "[[lens]]\nname = \"map\"\nkind = \"map-view\"\nview = {{ height_m = 200, magnification = 3 }}\n\
                     [[overlay]]\nlens = \"map\"\nsize = [180, 180]\nframe = \"{frame}\"\n"
                ),
            );
            let picture = drawn(&mut of_scene(&scene), &scene);
            let (_, at, size, _) = told(&picture)[0];
            let half = DVec2::new(size[0] as f64, size[1] as f64) * 0.5;
            let (found, count) =
                middle_of(&part(&picture, at, size), size[0], is_magenta).expect("the mark is on the map");
            let shown = |offset: DVec2| {
                let on_map = DVec2::new(offset.x, -offset.y) * (2.0 * half.y / 200.0);
                half + local::fisheye(on_map / (half * reach), 3.0) * half * reach
            };
            // The middle of a disc is not that of its picture: the mean over the disc.
            let disc = (0..400).map(|i| {
                let (turn, r) = (DVec2::from_angle(f64::from(i) * 2.399_963), 3.0 * (f64::from(i) / 400.0).sqrt());
                shown(offset + r * turn)
            });
            let expected = disc.sum::<DVec2>() / 400.0;
            assert!((found - expected).length() < 0.75, "{frame} {offset}: {found} for {expected}, {count} pixels");
            let without = half + DVec2::new(offset.x, -offset.y) * (2.0 * half.y / 200.0);
            assert!((found - without).length() > 3.0, "it is distorted");
        }
    }
}

#[test]
fn a_lazy_map_keeps_still_until_the_eye_is_out_of_reach() {
    let scene = square(
        "[[lens]]\nname = \"map\"\nkind = \"map-view\"\nview = { mode = \"user-view\", height_m = 200, lazy = 0.5 }\n\
         [[overlay]]\nlens = \"map\"\nsize = [160, 160]\nframe = \"none\"\n",
    );
    let mut studio = of_scene(&scene);
    let mut standing = Standing::default();
    let mut arrows = Vec::new();
    let mut drawn_again = Vec::new();
    for step in 0..8 {
        let mut now = scene.clone();
        let camera = now.camera.as_mut().unwrap();
        (camera.eye.x, camera.target.x) =
            (camera.eye.x + 10.0 * f64::from(step), camera.target.x + 10.0 * f64::from(step));
        let picture = figure::draw_next(&mut studio, &now, &request(SIZE), &mut standing).unwrap();
        let (_, at, size, is_new) = told(&picture)[0];
        let is_red = |[r, g, b, _]: [u8; 4]| r > 190 && g < 70 && b < 80;
        arrows.push(middle_of(&part(&picture, at, size), size[0], is_red).unwrap().0.x);
        drawn_again.push(is_new);
    }
    // Half of the way to the border is 50 m.
    assert_eq!(drawn_again, [true, false, false, false, false, false, true, true]);
    let per_step = 10.0 * 160.0 / 200.0;
    for (step, pair) in arrows.windows(2).enumerate() {
        let expected = if step < 5 { per_step } else { 0.0 };
        assert!((pair[1] - pair[0] - expected).abs() < 0.5, "{arrows:?}");
    }
    // A single picture has the eye in the middle.
    let mut last = scene;
    let camera = last.camera.as_mut().unwrap();
    (camera.eye.x, camera.target.x) = (camera.eye.x + 70.0, camera.target.x + 70.0);
    let picture = drawn(&mut studio, &last);
    let (_, at, size, _) = told(&picture)[0];
    let is_red = |[r, g, b, _]: [u8; 4]| r > 190 && g < 70 && b < 80;
    let arrow = middle_of(&part(&picture, at, size), size[0], is_red).unwrap().0;
    assert!((arrow - 80.0).length() < 8.0, "{arrow}");
}

#[test]
fn compasses_show_north_and_arrows_where_the_eye_looks() {
    let needle = |[r, g, b, _]: [u8; 4]| r > 190 && g < 70 && b < 80;
    let tail = |[r, g, b, _]: [u8; 4]| r.abs_diff(140) < 12 && g.abs_diff(145) < 12 && b.abs_diff(153) < 12;
    for degrees in [0, 60, 135, 200, 310] {
        let to = DVec2::from_angle(f64::from(degrees).to_radians());
        let (tx, ty) = (-75.0 + 100.0 * to.x, -110.0 + 100.0 * to.y);
        let scene = |mode: &str| {
            let mut scene = square(&format!(
                "[[lens]]\nname = \"map\"\nkind = \"map-view\"\nview = {{ mode = \"{mode}\", height_m = 20000 }}\n\
                 look = {{ background = \"#ffffff\" }}\nlenses = []\n[layout]\nalong = \"right\"\n[[overlay]]\nlens = \"map\"\nsize = [200, 200]\nframe = \"none\"\n"
            ));
            scene.camera.as_mut().unwrap().target = DVec3::new(tx, ty, 30.0);
            scene
        };
        let mut studio = of_scene(&scene("head-up"));
        let picture = drawn(&mut studio, &scene("head-up"));
        let (_, at, size, _) = told(&picture)[0];
        // The upper right corner, where the compass is; the city is some pixels in the middle.
        let pixels = part(&picture, [at[0] + size[0] - 60, at[1]], [60, 60]);
        let red = middle_of(&pixels, 60, needle).unwrap().0;
        let grey = middle_of(&pixels, 60, tail).unwrap().0;
        // In a map whose top is the direction of view, north is turned by as much the other way.
        let north = DVec2::new(-to.x, -to.y);
        let found = (red - grey).normalize_or(DVec2::X);
        // The letter N covers a part of the red half, whose middle is aside by that; the compass is a dozen pixels in radius.
        assert!(found.angle_to(north).abs() < 0.3, "{degrees}°: {found} for {north}");
        let picture = drawn(&mut studio, &scene("user-view"));
        let (_, at, size, _) = told(&picture)[0];
        let half = 0.5 * DVec2::new(size[0] as f64, size[1] as f64);
        let red = middle_of(&part(&picture, at, size), size[0], needle).unwrap().0 - half;
        assert_eq!(size, [200, 200]);
        let ahead = DVec2::new(to.x, -to.y);
        // The arrow head is heavier at its base.
        assert!(red.length() < 6.0 && red.length() > 0.2 && red.angle_to(-ahead).abs() < 0.6, "{degrees}°: {red}");
    }
}

#[test]
fn lines_of_places_out_of_the_picture_are_arrows_or_nothing() {
    let with = |line: &str| {
        square(&format!(
            "[[poi]]\nname = \"behind\"\nat = [-150, -300, 10]\n[[lens]]\nname = \"a\"\nkind = \"annotation\"\ntext = \"x\"\n\
             color = \"#ff00ff\"\npoi = \"behind\"\n[[overlay]]\nlens = \"a\"\nsize = [60, 40]\nline = {{ {line} }}\n"
        ))
    };
    let mut studio = of_scene(&with(""));
    let arrow = drawn(&mut studio, &with("outside = \"arrow\""));
    let (tip, count) = middle_of(&arrow.rgba, SIZE[0] as usize, is_magenta).expect("an arrow");
    assert!((20..200).contains(&count), "{count}");
    // The place lies behind, below and to the left.
    assert!(tip.y > 330.0 || tip.x < 20.0, "{tip}");
    let hidden = drawn(&mut studio, &with("outside = \"hidden\""));
    assert_eq!(middle_of(&hidden.rgba, SIZE[0] as usize, is_magenta), None);
}

/// A shipped scene, its city, its picture, and where its overlays stand.
struct Shipped {
    scene: Scene,
    studio: Studio,
    picture: Picture,
    placed: Placed,
}

fn shipped(name: &str, changes: &[&str]) -> Shipped {
    drawn_by(None, name, changes)
}

/// The scene by the studio that has drawn it with other changes, which knows the best views of its city.
fn drawn_by(studio: Option<Studio>, name: &str, changes: &[&str]) -> Shipped {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(format!("{name}.toml"));
    let options = Options::for_file(&path);
    let mut scene = read(&path, &options).expect("a scene");
    for change in changes {
        set_within(&scene, change, &options).expect("a change").redo(&mut scene);
    }
    let mut studio = studio.unwrap_or_else(|| of_scene(&scene));
    let mut standing = Standing::default();
    let size = scene.figure.size;
    let picture = figure::draw_next(&mut studio, &scene, &request(size), &mut standing).expect("a picture");
    let placed = standing.of_picture().expect("overlays").clone();
    Shipped { scene, studio, picture, placed }
}

/// Share of what a lens shows that is of an object and its parts.
fn share_of(shipped: &mut Shipped, lens: usize, object: &str) -> f64 {
    let Shipped { scene, studio, .. } = shipped;
    let own = &scene.lenses[lens];
    let shown = own.best_view().unwrap();
    let from = views::From { main: studio.camera(scene, scene.figure.size), size: [240, 160], tracked: None };
    let mut local = views::local(studio, scene, &own.name, shown, shown.view().unwrap(), &from).unwrap().scene;
    local.lenses.clear();
    let asked = Request { aovs: Aovs { object_id: true, ..Aovs::default() }, ..request([240, 160]) };
    let ids = studio.render(&local, &asked).unwrap().object_id.expect("ids");
    let (model, root) = (&studio.model, studio.model.find_object(object).expect("an object"));
    let roots = model.roots();
    let is_own = |id: &&u32| **id > 0 && (**id - 1 == root || roots[**id as usize - 1] == root);
    ids.iter().filter(is_own).count() as f64 / ids.len() as f64
}

#[test]
fn trapp_3_4_1_shows_sights_in_their_context() {
    let mut made = shipped("trapp-3-4-1", &[]);
    // The mill is out of the picture; the others are tied to their places, without crossings.
    assert_eq!((made.placed.placements.len(), made.placed.lines.len(), made.placed.crossings.sum()), (4, 3, 0));
    for (lens, object) in ["church", "town-hall", "windmill", "bridge"].into_iter().enumerate() {
        let share = share_of(&mut made, lens, object);
        assert!(share > 0.06, "{object} takes {share} of its overlay");
    }
}

#[test]
fn trapp_3_4_3_ties_one_depiction_to_several_places_and_shows_the_surroundings() {
    let made = shipped("trapp-3-4-3-a", &[]);
    assert_eq!((made.placed.placements.len(), made.placed.lines.len()), (1, 3));
    let mut made = shipped("trapp-3-4-3-b", &[]);
    let camera = made.studio.camera(&made.scene, made.scene.figure.size);
    let own = made.scene.lenses[0].best_view().unwrap();
    let from = views::From { main: camera, size: [200, 200], tracked: None };
    let map = views::local(&mut made.studio, &made.scene, "map", own, own.view().unwrap(), &from).unwrap();
    let seen = map.scene.camera.unwrap();
    assert_eq!(seen.eye.truncate(), camera.eye.truncate(), "around the eye");
    assert_eq!((seen.target - seen.eye).normalize_or(DVec3::X), -DVec3::Z, "from above");
}

#[test]
fn trapp_3_4_5_is_three_maps_of_one_place() {
    let red = |made: &Shipped| {
        let (_, at, size, _) = told(&made.picture)[0];
        let needle = |[r, g, b, _]: [u8; 4]| r > 205 && g < 60 && b < 60;
        let half = DVec2::new(size[0] as f64, size[1] as f64) * 0.5;
        middle_of(&part(&made.picture, at, size), size[0], needle).map(|(at, count)| (at - half, count))
    };
    let [north, heading, user] = ["north-up", "head-up", "user-view"]
        .map(|mode| red(&shipped("trapp-3-4-3-b", &[&format!("lens.map.view.mode={mode}")])));
    assert_eq!(north, None, "north up has no sign");
    assert!(heading.is_some_and(|(at, _)| at.x > 60.0 && at.y < -60.0), "a compass at the upper right: {heading:?}");
    assert!(user.is_some_and(|(at, _)| at.length() < 8.0), "an arrow in the middle: {user:?}");
}

#[test]
fn trapp_3_4_8_orders_hides_and_fades_lines() {
    let hidden =
        shipped("sights", &["overlay.0={ lens = 'the mill', line = { outside = 'hidden', color = '#ff00ff' } }"]);
    assert_eq!((hidden.placed.placements.len(), hidden.placed.lines.len(), hidden.placed.crossings.sum()), (5, 4, 0));
    assert_eq!(
        middle_of(&hidden.picture.rgba, 1280, is_magenta),
        None,
        "the mill is out of the picture, and so has no line"
    );
    let line = "overlay.0={ lens = 'the town hall', line = { fade = [160, 300], color = '#ff00ff' } }";
    let faded = drawn_by(Some(hidden.studio), "sights", &[line]);
    let whole = drawn_by(Some(faded.studio), "sights", &[&line.replace("fade = [160, 300], ", "")]);
    let [faded, whole] = [faded.picture, whole.picture];
    let near = |picture: &Picture, inner: f64, outer: f64| {
        let pixels = picture.rgba.iter().enumerate().filter(|(i, color)| {
            let at = DVec2::new((i % 1280) as f64 + 0.5, (i / 1280) as f64 + 0.5);
            (inner..outer).contains(&(at - DVec2::new(640.0, 360.0)).length()) && is_magenta(**color)
        });
        pixels.count()
    };
    // The line comes from above the town hall, and ends in a dot that is 214 pixels from the middle.
    assert_eq!(near(&faded, 300.0, 1000.0), near(&whole, 300.0, 1000.0), "beyond the outer radius all of it is seen");
    assert!(near(&faded, 225.0, 260.0) == 0 && near(&whole, 225.0, 260.0) > 20, "towards the middle it vanishes");
}

#[test]
fn trapp_5_3_2_goes_by_what_one_looks_at() {
    let focus = shipped("sights", &["layout.exploration_focus=true"]);
    let middle = |made: &Shipped, lens: u32| {
        let rect = made.placed.placements.iter().find(|p| p.id == lens).unwrap().rect;
        (f64::from(rect.min[0] + rect.max[0]) / 2.0, rect.size())
    };
    // The fountain is nearest to the middle of the picture.
    assert!((middle(&focus, 2).0 - 640.0).abs() <= 1.0);
    let sized = drawn_by(Some(focus.studio), "sights", &["layout.size=distance"]);
    let areas: Vec<i32> = (0..5).map(|lens| middle(&sized, lens).1).map(|[w, h]| w * h).collect();
    // Church, fountain, town hall, mill, bridge: from near to far.
    let by_distance = [0, 2, 1, 3, 4];
    assert!(by_distance.windows(2).all(|pair| areas[pair[0]] > areas[pair[1]]), "{areas:?}");
}

#[test]
fn trapp_5_3_1_magnifies_the_middle() {
    let made = shipped("trapp-5-3-1", &[]);
    let view = made.scene.lenses[0].best_view().unwrap().view().unwrap();
    assert!(matches!(view, LocalView::Map { magnification, .. } if *magnification == 3.0));
    // It is another picture than without: by how much, the closed form says (above).
    let plain = drawn_by(Some(made.studio), "trapp-5-3-1", &["lens.map.view.magnification=1"]);
    let (_, at, size, _) = told(&made.picture)[0];
    let other =
        part(&made.picture, at, size).iter().zip(part(&plain.picture, at, size)).filter(|(a, b)| **a != *b).count();
    assert!(other > size[0] * size[1] / 2);
}

/// The colour of a texel of an image.
type Texels<'a> = &'a dyn Fn(u32, u32) -> [u8; 4];

/// A folder with images, by name, of so many pixels each.
fn images(name: &str, all: &[(&str, [u32; 2], Texels)]) -> std::path::PathBuf {
    let folder = std::env::temp_dir().join(format!("veduta-{name}-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    for (file, [width, height], color) in all {
        let image = image::RgbaImage::from_fn(*width, *height, |x, y| image::Rgba(color(x, y)));
        image.save(folder.join(file)).expect("an image");
    }
    folder
}

fn in_folder(folder: &std::path::Path, rest: &str) -> Scene {
    let head = "veduta = 1\n[city]\nfiles = [\"builtin:square\"]\n[camera]\neye = [-75, -110, 62]\ntarget = [8, 12, 4]\n\
                fov_deg = 46\n[figure]\nsize = [640, 360]\n";
    let options = Options { base: folder.to_owned(), ..Options::default() };
    parse(&format!("{head}{rest}"), "s.toml", &options).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn masks_say_what_is_seen_and_what_lies_over_it() {
    let black_and_white = |x: u32, _: u32| if x < 80 { [0, 0, 0, 255] } else { [255; 4] };
    let rim = |x: u32, y: u32| if x.min(y) < 5 || x >= 155 || y >= 95 { [255, 0, 255, 255] } else { [0; 4] };
    let folder = images("masks", &[("alpha.png", [160, 100], &black_and_white), ("frame.png", [160, 100], &rim)]);
    let scene = in_folder(
        &folder,
        "[[lens]]\nname = \"a\"\nkind = \"see-through\"\nview = { eye = [0, -60, 30], target = [0, 0, 5] }\n\
         [[overlay]]\nlens = \"a\"\nsize = [160, 100]\nline = \"none\"\nframe = { alpha = \"alpha.png\", frame = \"frame.png\" }\n",
    );
    let mut studio = of_scene(&scene);
    let picture = drawn(&mut studio, &scene);
    let (_, at, size, _) = told(&picture)[0];
    assert_eq!(size, [160, 100]);
    let shown = part(&picture, at, size);
    let own = alone(&mut studio, &scene, 0, [160, 100]).rgba;
    let below =
        part(&drawn(&mut studio, &Scene { lenses: Vec::new(), overlays: Vec::new(), ..scene.clone() }), at, size);
    std::fs::remove_dir_all(folder).expect("the folder");
    for (i, pixel) in shown.iter().enumerate() {
        let (x, y) = ((i % 160) as u32, (i / 160) as u32);
        let over = rim(x, y);
        let expected = match (over[3] > 0, x < 80) {
            (true, _) => over,
            (false, true) => below[i],
            (false, false) => own[i],
        };
        assert_eq!(*pixel, expected, "({x}, {y})");
    }
}

#[test]
fn skins_run_along_their_lines() {
    // The half at the overlay is green, that at the place magenta; the rim is transparent.
    let stripes = |x: u32, y: u32| match (x < 32, (4..12).contains(&y)) {
        (_, false) => [0; 4],
        (true, true) => [0, 255, 0, 255],
        (false, true) => [255, 0, 255, 255],
    };
    let folder = images("skins", &[("skin.png", [64, 16], &stripes)]);
    let scene = in_folder(
        &folder,
        "[[poi]]\nname = \"hall\"\nobject = \"town-hall\"\n[[lens]]\nname = \"a\"\nkind = \"annotation\"\ntext = \"x\"\npoi = \"hall\"\n\
         [layout]\nalong = \"left\"\n[[overlay]]\nlens = \"a\"\nsize = [60, 40]\nline = { width = 24, end_width = 24, skin = \"skin.png\" }\n",
    );
    let mut studio = of_scene(&scene);
    let mut standing = Standing::default();
    let picture = figure::draw_next(&mut studio, &scene, &request(SIZE), &mut standing).unwrap();
    std::fs::remove_dir_all(folder).expect("the folder");
    let line = standing.of_picture().expect("an overlay").lines[0].points.clone();
    let (from, to) = (line[0], line[line.len() - 1]);
    let color = |t: f64, across: f64| {
        let along = (to - from).normalize_or(DVec2::X);
        let at = from.lerp(to, t) + across * along.perp();
        picture.rgba[at.y as usize * 640 + at.x as usize]
    };
    for t in [0.1, 0.3, 0.45] {
        assert!(matches!(color(t, 0.0), [0..=40, 230..=255, 0..=40, _]), "{t}: {:?}", color(t, 0.0));
    }
    for t in [0.55, 0.7, 0.9] {
        assert!(is_magenta(color(t, 0.0)), "{t}: {:?}", color(t, 0.0));
    }
    for (t, across) in [(0.3, 8.0), (0.3, -8.0), (0.7, 8.0), (0.7, -8.0)] {
        let [r, g, b, _] = color(t, across);
        assert!(!(is_magenta([r, g, b, 255]) || (g > 230 && r < 40)), "the rim is clear: {t}, {across}");
    }
}

const WALK: &str = "[[trajectory]]\nname = \"walk\"\npoints = [[-40, 0, 2], [40, 0, 2]]\nspeed_m_s = 4\nmarker = false\n\
                    [[poi]]\nname = \"visitor\"\ntrajectory = \"walk\"\n";

#[test]
fn what_goes_by_a_moving_point_moves_with_it() {
    let mut scene = square(&format!(
        "{WALK}[[lens]]\nname = \"around\"\nbody = \"none\"\nattached_to = {{ poi = \"visitor\" }}\n\
         shape = {{ kind = \"cylinder\", center = [0, 0, 0], radius = 6, height = 400 }}\n\
         effects = [{{ effect = \"flat\" }}, {{ effect = \"overlay\", color = \"#ff00ff\", opacity = 1.0 }}]\n\
         [[lens]]\nname = \"follow\"\nkind = \"best-view\"\npoi = \"visitor\"\nview = {{ kind = \"follow\", distance_m = 30, height_m = 20 }}\n\
         [[lens]]\nname = \"eyes\"\nkind = \"best-view\"\npoi = \"visitor\"\nview = {{ kind = \"onboard\", azimuth_deg = 90, height_m = 1.5 }}\n\
         [[lens]]\nname = \"still\"\nkind = \"see-through\"\nview = {{ eye = [0, -60, 30], target = [0, 0, 5] }}\nlenses = []\n"
    ));
    // Seen from straight above.
    scene.camera = Some(Camera { up: DVec3::Y, ..Camera::looking(DVec3::new(0.0, 0.0, 300.0), DVec3::ZERO, 0.5) });
    let mut studio = of_scene(&scene);
    let mut standing = Standing::default();
    let mut places = Vec::new();
    for (time_s, again) in
        [(0.0, [true, true, true]), (0.0, [false; 3]), (5.0, [true, true, false]), (10.0, [true, true, false])]
    {
        scene.time_s = time_s;
        let mut bare = scene.clone();
        bare.lenses.truncate(1);
        let picture = figure::draw_next(&mut studio, &scene, &request(SIZE), &mut standing).unwrap();
        assert_eq!(rendered(&picture), again, "{time_s} s");
        let seen = studio.render(&bare, &request(SIZE)).unwrap();
        places.push(middle_of(&seen.rgba, SIZE[0] as usize, is_magenta).expect("the lens is seen").0);
        for (lens, eye, target) in
            [(1, DVec3::new(-30.0, 0.0, 20.0), DVec3::ZERO), (2, DVec3::new(0.0, 0.0, 1.5), DVec3::new(0.0, -1.0, 1.5))]
        {
            let own = scene.lenses[lens].best_view().unwrap();
            let from = views::From { main: scene.camera.unwrap(), size: [240, 160], tracked: None };
            let local = views::local(&mut studio, &scene, "x", own, own.view().unwrap(), &from).unwrap();
            let camera = local.scene.camera.unwrap();
            let visitor = DVec3::new(-40.0 + 4.0 * time_s, 0.0, 2.0);
            assert!((camera.eye - visitor - eye).length() < 1e-9, "{lens} at {time_s} s: {}", camera.eye);
            let along = (camera.target - camera.eye).normalize_or(DVec3::X);
            assert!((along - (target - eye).normalize_or(DVec3::X)).length() < 1e-9, "{lens} at {time_s} s: {along}");
        }
    }
    // 300 m above, 0.5 rad over 360 pixels; the cylinder is seen from above, so that its middle is that of its section.
    let metre = 180.0 / (300.0 * 0.25_f64.tan());
    let steps: Vec<f64> = places.windows(2).map(|pair| (pair[1] - pair[0]).x).collect();
    for (step, metres) in steps.iter().zip([0.0, 20.0, 20.0]) {
        assert!((step - metres * metre).abs() < 1.5 + 0.06 * metres * metre, "{steps:?} for {metre} pixels per metre");
    }
}

#[test]
fn a_view_of_what_is_not_there_is_left_out() {
    let lens = |name: &str, id: &str, kind: &str| {
        format!(
            "[[poi]]\nname = \"{name}\"\nobject = \"{id}\"\n[[lens]]\nname = \"{name}\"\nkind = \"{kind}\"\npoi = \"{name}\"\n"
        )
    };
    for kind in ["best-view", "worldlet"] {
        let scene = square(&format!("{}{}", lens("hall", "town-hall", kind), lens("gone", "town-hlal", kind)));
        let picture = drawn(&mut of_scene(&scene), &scene);
        assert_eq!(told(&picture).iter().map(|t| t.0).collect::<Vec<_>>(), [0], "{kind}: the other is drawn");
    }
}
