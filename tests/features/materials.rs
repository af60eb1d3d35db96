//! What materials and textures let through: as exact layers, whatever the file's format, beside whatever lenses do, in shadows and in
//! what is picked.

use std::path::{Path, PathBuf};

use crate::panes::*;
use crate::studio::*;
use glam::DVec3;
use veduta::{
    figure::scene_file::{Options, parse},
    geom::Shape,
    render::{
        frame::Backend,
        picture::{Picture, Request, Studio},
    },
    scene::{Scene, Transparency},
    view::View,
};

/// Of pictures with shadows.
const SHADOWED: [u32; 2] = [160, 120];
pub const BOTH: [Backend; 2] = [Backend::Specialised, Backend::Uber];

/// Of the materials of panes, how much they let through; the second is opaque.
const CLEAR: [f64; 4] = [0.5, 0.0, 0.25, 0.875];

/// An opacity as it is kept: to the nearest 511th.
fn kept(opacity: f64) -> f64 {
    1.0 - ((1.0 - opacity) * 511.0).round() / 511.0
}

/// The panes in their materials, of which some let something through.
fn glazed(panes: &[Pane]) -> PathBuf {
    let path = city(panes);
    let mut text = std::fs::read_to_string(&path).expect("the city");
    for (i, clear) in CLEAR.iter().enumerate() {
        let name = format!("\"name\": \"m{i}\"");
        text = text.replace(&name, &format!("{name}, \"transparency\": {clear}"));
    }
    std::fs::write(&path, text).expect("a temporary file");
    path
}

fn glazed_studio(panes: &[Pane]) -> Studio {
    let path = glazed(panes);
    let made = studio(std::slice::from_ref(&path));
    std::fs::remove_file(path).expect("the temporary file");
    made
}

/// What stands before the first pane of an opaque material, and is not hidden.
fn before_opaque(stack: &[(usize, [f32; 3])], is_hidden: impl Fn(usize) -> bool) -> Vec<(usize, [f32; 3])> {
    let there = stack.iter().filter(|(pane, _)| !is_hidden(*pane));
    there.take_while(|(pane, _)| CLEAR[pane % 4] > 0.0).copied().collect()
}

#[test]
fn materials_are_layers_that_lenses_show_their_share_of() {
    let mut random = Random(71);
    let mut all = panes(19, &mut random);
    // Two of a plane.
    all[8].x = all[6].x;
    let stacks = stacks(&mut studio_of(&all), &all);
    let mut studio = glazed_studio(&all);
    let own = |pane: usize| kept(1.0 - CLEAR[pane % 4]);
    let half_of_some = rule("transparent", &[("opacity", 0.5)], Some(&[0, 2, 4, 7, 10]), false);
    let gone = rule("eraser", &[], Some(&[0, 1, 5, 6]), false);
    for backend in BOTH {
        let found = transparency(&mut studio, &of_context(vec![]), backend, SIZE);
        let expected: Vec<_> =
            stacks.iter().map(|stack| composited(&before_opaque(stack, |_| false), |_, pane| own(pane))).collect();
        let error = largest_difference(&found, &expected);
        assert!(error < 20.0 * 2_f64.powi(-23), "{backend:?}: {error:e}");
        assert!(expected.iter().any(|over| over[3] < 0.1) && expected.iter().any(|over| over[3] == 1.0));
        // A rule shows half of what the material leaves.
        let found = transparency(&mut studio, &of_context(vec![half_of_some.clone()]), backend, SIZE);
        let share = |pane: usize| if [0, 2, 4, 7, 10].contains(&pane) { 0.5 * own(pane) } else { own(pane) };
        let expected: Vec<_> =
            stacks.iter().map(|stack| composited(&before_opaque(stack, |_| false), |_, pane| share(pane))).collect();
        let error = largest_difference(&found, &expected);
        assert!(error < 20.0 * 2_f64.powi(-23), "{backend:?}, half: {error:e}");
        // What is taken away is no layer.
        let found = transparency(&mut studio, &of_context(vec![gone.clone()]), backend, SIZE);
        let is_gone = |pane| [0, 1, 5, 6].contains(&pane);
        let expected: Vec<_> =
            stacks.iter().map(|stack| composited(&before_opaque(stack, is_gone), |_, pane| own(pane))).collect();
        let error = largest_difference(&found, &expected);
        assert!(error < 20.0 * 2_f64.powi(-23), "{backend:?}, gone: {error:e}");
    }
    // In clay they let through as much.
    let mut clay = of_context(vec![]);
    clay.style.base = veduta::scene::BaseStyle::Clay;
    let through = |all: &[[f32; 4]]| all.iter().map(|over| over[3]).collect::<Vec<_>>();
    let natural = through(&transparency(&mut studio, &of_context(vec![]), Backend::Uber, SIZE));
    assert_eq!(through(&transparency(&mut studio, &clay, Backend::Uber, SIZE)), natural);
}

#[test]
fn every_method_shows_materials() {
    let mut random = Random(72);
    let mut studio = glazed_studio(&panes(15, &mut random));
    let mut by = |method: Transparency, backend| {
        let mut scene = of_context(vec![]);
        scene.style.transparency = method;
        transparency(&mut studio, &scene, backend, SIZE)
    };
    for backend in BOTH {
        let exact = by(Transparency::Exact, backend);
        assert_eq!(by(Transparency::Peel { layers: 0 }, backend), exact, "{backend:?}");
        assert_eq!(by(Transparency::KBuffer { layers: 16 }, backend), exact, "{backend:?}");
        // What is let through does not depend on the order.
        let weighted = by(Transparency::Weighted, backend);
        let off = exact.iter().zip(&weighted).map(|(a, b)| (a[3] - b[3]).abs()).fold(0.0, f32::max);
        assert!(off < 1e-3, "{backend:?}: {off}");
    }
    let mut scene = of_context(vec![]);
    scene.style.transparency = Transparency::Stochastic;
    let mut shown = |scene: &Scene, samples| {
        let request = Request { size: SIZE, samples, ..request(Backend::Specialised) };
        let drawn = studio.render(scene, &request).expect("a picture");
        drawn.rgba.iter().map(|rgba| f64::from(rgba[0])).sum::<f64>() / drawn.rgba.len() as f64
    };
    let [chance, exact] = [shown(&scene, 64), shown(&of_context(vec![]), 1)];
    assert!((chance - exact).abs() < 2.0, "{chance} in the mean of 64 samples, {exact}");
}

#[test]
fn what_is_picked_is_the_layer_at_which_half_is_opaque() {
    let mut random = Random(73);
    let all = panes(16, &mut random);
    let stacks = stacks(&mut studio_of(&all), &all);
    let mut studio = glazed_studio(&all);
    for backend in BOTH {
        let request = Request { size: SIZE, samples: 1, aovs: ALL, ..request(backend) };
        let drawn = studio.render(&of_context(vec![]), &request).expect("a picture");
        let ids = drawn.object_id.as_ref().expect("ids");
        for (k, stack) in stacks.iter().enumerate() {
            let mut through = 1.0;
            let shown = stack.iter().find(|(pane, _)| {
                through *= 1.0 - kept(1.0 - CLEAR[pane % 4]);
                through <= 0.5
            });
            let id = shown.map_or(0, |(pane, _)| pane + 1);
            let name = |id: u32| studio.model.objects.get((id as usize).wrapping_sub(1)).map(|o| o.id.to_string());
            assert_eq!(name(ids[k]), shown.map(|(pane, _)| format!("p{pane}")), "{backend:?}, pixel {k}, {id}");
        }
    }
}

/// A picture of a disc, of a colour and an opacity, and nothing around it.
fn leaf(folder: &Folder, name: &str, color: [u8; 4]) {
    let is_in = |x: u32, y: u32| (f64::from(x) - 31.5).hypot(f64::from(y) - 31.5) < 24.0;
    let texel = |x, y| image::Rgba(if is_in(x, y) { color } else { [200, 0, 0, 0] });
    image::RgbaImage::from_fn(64, 64, texel).save(folder.0.join(name)).expect("an image");
}

/// A scene of one file, seen from the south along the y axis, 12 m high, with nothing behind.
pub fn of_file(file: &Path, more: &str) -> Scene {
    let text = format!(
        "veduta = 1\n[city]\nfiles = [{:?}]\nground = false\n[camera]\neye = [0, -30, 5]\ntarget = [0, 0, 5]\n\
         projection = \"orthographic\"\nheight_m = 12\n{more}",
        file.display().to_string()
    );
    parse(&text, "scene.toml", &Options { allow_outside: true, ..Options::default() })
        .unwrap_or_else(|error| panic!("{error}"))
}

/// The same by both back ends, transparent where there is nothing.
pub fn drawn(scene: &Scene) -> Picture {
    let mut studio = of_scene(scene);
    let mut of = |backend| {
        let request = Request { transparent: true, aovs: ALL, backend, ..Request::plain([60, 60]) };
        studio.render(scene, &request).expect("a picture")
    };
    let [one, other] = BOTH.map(&mut of);
    assert_eq!((&one.rgba, &one.object_id), (&other.rgba, &other.object_id));
    one
}

/// The pixel at a place of the picture plane, metres from the z axis and from the ground.
pub fn at(picture: &Picture, x: f64, z: f64) -> [u8; 4] {
    let (column, row) = ((x + 6.0) * 5.0, (11.0 - z) * 5.0);
    picture.rgba[row as usize * 60 + column as usize]
}

/// A wall 10 m high and wide in the plane y = 0, as OBJ.
const WALL: &str = "mtllib m.mtl\nv -5 0 0\nv 5 0 0\nv 5 0 10\nv -5 0 10\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl a\nf 1/1 2/2 3/3 4/4\n";

#[test]
fn mtl_says_it_in_four_ways() {
    let folder = Folder::new("materials-mtl");
    leaf(&folder, "leaf.png", [20, 160, 40, 255]);
    leaf(&folder, "thin.png", [20, 160, 40, 102]);
    // Light where there is something, without opacity.
    let mask = image::GrayImage::from_fn(32, 32, |x, _| image::Luma([if x < 16 { 0 } else { 51 }]));
    mask.save(folder.0.join("mask.png")).expect("an image");
    let wall = folder.write("wall.obj", WALL);
    // The opacity of the left and of the right half of the wall, and of its corner.
    for (mtl, left, right, corner) in [
        ("Kd 1 0 0", 1.0, 1.0, 1.0),
        ("Kd 1 0 0\nd 0.25", 0.25, 0.25, 0.25),
        ("Kd 1 0 0\nTr 0.25", 0.75, 0.75, 0.75),
        ("Kd 1 0 0\nd 0", 0.0, 0.0, 0.0),
        ("map_Kd leaf.png", 1.0, 1.0, 0.0),
        ("map_Kd thin.png", 0.4, 0.4, 0.0),
        ("map_Kd thin.png\nd 0.5", 0.2, 0.2, 0.0),
        ("map_Kd leaf.png\nmap_d leaf.png", 1.0, 1.0, 0.0),
        ("Kd 0 0 1\nmap_d mask.png", 0.0, 0.2, 0.0),
        ("map_Kd leaf.png\nmap_d mask.png", 0.0, 0.2, 0.0),
    ] {
        folder.write("m.mtl", format!("newmtl a\n{mtl}\n"));
        let picture = drawn(&of_file(&wall, ""));
        for (what, x, z, wanted) in
            [("left", -2.5, 5.0, left), ("right", 2.5, 5.0, right), ("corner", -4.7, 0.3, corner)]
        {
            let found = f64::from(at(&picture, x, z)[3]) / 255.0;
            // A texture's opacity has 255 steps, a material's 511, the picture 255.
            assert!((found - wanted).abs() < 1.6 / 255.0, "{mtl:?}, {what}: {found}, not {wanted}");
        }
        // In clay as much.
        let clay = drawn(&of_file(&wall, "[style]\nbase = \"clay\"\n"));
        let opacities = |picture: &Picture| picture.rgba.iter().map(|rgba| rgba[3]).collect::<Vec<_>>();
        assert_eq!(opacities(&clay), opacities(&picture), "{mtl:?}");
        let is_blue = mtl.contains("Kd 0 0 1");
        let [r, g, b, _] = at(&picture, 2.5, 5.0);
        assert!(!is_blue || (b > 60 && r < 10 && g < 10), "{mtl:?}: the colour is that of Kd, not {r} {g} {b}");
    }
    // An opacity that is not there is told, and the texture is opaque.
    folder.write("m.mtl", "newmtl a\nmap_Kd leaf.png\nmap_d nowhere.png\n");
    let scene = of_file(&wall, "");
    let studio = of_scene(&scene);
    let told: Vec<_> = studio.model.warnings.iter().map(|(code, warning)| (code.code(), warning.count)).collect();
    assert_eq!(told, [("missing-texture", 1)]);
}

/// Corners, texture coordinates and indices of a wall 10 m high and wide, as glTF has them.
pub fn wall_bytes() -> Vec<u8> {
    [-5.0_f32, 0.0, 0.0, 5.0, 0.0, 0.0, 5.0, 10.0, 0.0, -5.0, 10.0, 0.0]
        .iter()
        .chain(&[0.0_f32, 1.0, 1.0, 1.0, 1.0, 0.0, 0.0, 0.0])
        .flat_map(|number| number.to_le_bytes())
        .chain([0_u16, 1, 2, 0, 2, 3].iter().flat_map(|index| index.to_le_bytes()))
        .collect()
}

/// That wall in a node, of a material.
pub fn wall_gltf(node: &str, material: &str) -> String {
    format!(
        r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{node}],
"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0,"TEXCOORD_0":1}},"indices":2,"material":0}}]}}],
"materials":[{material}],
"textures":[{{"source":0}}],"images":[{{"uri":"leaf.png"}}],"buffers":[{{"byteLength":92,"uri":"wall.bin"}}],
"bufferViews":[{{"buffer":0,"byteLength":48}},{{"buffer":0,"byteOffset":48,"byteLength":32}},{{"buffer":0,"byteOffset":80,"byteLength":12}}],
"accessors":[{{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[-5,0,0],"max":[5,10,0]}},
{{"bufferView":1,"componentType":5126,"count":4,"type":"VEC2"}},{{"bufferView":2,"componentType":5123,"count":6,"type":"SCALAR"}}]}}"#
    )
}

#[test]
fn gltf_says_which_opacity_counts() {
    let folder = Folder::new("materials-gltf");
    leaf(&folder, "leaf.png", [20, 160, 40, 153]);
    folder.write("wall.bin", wall_bytes());
    for (material, middle, corner) in [
        (r#""alphaMode":"OPAQUE""#, 1.0, 1.0),
        (r#""alphaMode":"BLEND""#, 0.6, 0.0),
        (r#""alphaMode":"MASK""#, 1.0, 0.0),
        (r#""alphaMode":"MASK","alphaCutoff":0.7"#, 0.0, 0.0),
        (r#""alphaMode":"BLEND","factor":0.5"#, 0.3, 0.0),
        (r#""alphaMode":"OPAQUE","factor":0.5"#, 1.0, 1.0),
        (r#""alphaMode":"MASK","factor":0.5"#, 0.0, 0.0),
    ] {
        for is_textured in [true, false] {
            let factor = if material.contains("factor") { 0.5 } else { 1.0 };
            let material = material.replace(",\"factor\":0.5", "");
            let texture = if is_textured { r#","baseColorTexture":{"index":0}"# } else { "" };
            let material = format!(
                r#"{{{material},"doubleSided":true,"pbrMetallicRoughness":{{"baseColorFactor":[1,1,1,{factor}]{texture}}}}}"#
            );
            let text = wall_gltf(r#"{"mesh":0}"#, &material);
            let picture = drawn(&of_file(&folder.write("wall.gltf", text), ""));
            let plain = match (material.contains("BLEND"), material.contains("MASK")) {
                (true, _) => factor,
                (_, true) if factor < 0.5 => 0.0,
                _ => 1.0,
            };
            for (what, x, z, textured) in [("middle", 0.5, 5.0, middle), ("corner", -4.7, 0.3, corner)] {
                let wanted = if is_textured { textured } else { plain };
                let found = f64::from(at(&picture, x, z)[3]) / 255.0;
                let of = if is_textured { "textured" } else { "plain" };
                assert!((found - wanted).abs() < 1.6 / 255.0, "{material}, {of}, {what}: {found}, not {wanted}");
            }
        }
    }
}

/// A level pane 10 m wide and long, 6 m over a floor that is opaque; the sun is straight above.
#[test]
fn the_sun_shines_through_holes_and_what_lets_more_than_half_through() {
    let folder = Folder::new("materials-shadows");
    leaf(&folder, "leaf.png", [20, 160, 40, 255]);
    leaf(&folder, "thin.png", [20, 160, 40, 102]);
    leaf(&folder, "thick.png", [20, 160, 40, 153]);
    let roof = "mtllib m.mtl\nv -5 -5 6\nv 5 -5 6\nv 5 5 6\nv -5 5 6\nv -20 -20 0\nv 20 -20 0\nv 20 20 0\nv -20 20 0\n\
                vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl a\nf 1/1 2/2 3/3 4/4\nusemtl floor\nf 5 6 7 8\n";
    let model = folder.write("roof.obj", roof);
    let floor = "mtllib m.mtl\nv -20 -20 0\nv 20 -20 0\nv 20 20 0\nv -20 20 0\nusemtl floor\nf 1 2 3 4\n";
    let floor = folder.write("floor.obj", floor);
    folder.write("wall.bin", wall_bytes());
    let node = r#"{"mesh":0,"rotation":[-0.70710678,0,0,0.70710678],"translation":[0,6,5]}"#;
    let of_gltf = |mode: &str| {
        let material = format!(
            r#"{{"alphaMode":"{mode}","doubleSided":true,"pbrMetallicRoughness":{{"baseColorTexture":{{"index":0}}}}}}"#
        );
        folder.write(&format!("{mode}.gltf"), wall_gltf(node, &material))
    };
    let (mask, blend, opaque) = (of_gltf("MASK"), of_gltf("BLEND"), of_gltf("OPAQUE"));
    // Whether there is shadow under the middle of the pane, and under its corner.
    for (mtl, gltf, middle, corner) in [
        ("Kd 1 0 0", None, true, true),
        ("Kd 1 0 0\nd 0.5", None, true, true),
        ("Kd 1 0 0\nd 0.4", None, false, false),
        ("map_Kd leaf.png", None, true, false),
        ("map_Kd thick.png", None, true, false),
        ("map_Kd thin.png", None, false, false),
        ("map_Kd thick.png\nd 0.7", None, false, false),
        ("map_Kd leaf.png\nd 0.7", None, true, false),
        ("", Some(&mask), true, false),
        ("", Some(&blend), true, false),
        ("", Some(&opaque), true, true),
    ] {
        folder.write("m.mtl", format!("newmtl a\n{mtl}\nnewmtl floor\nKd 0.8 0.8 0.8\n"));
        let files = match gltf {
            Some(gltf) => vec![gltf, &floor],
            None => vec![&model],
        };
        let files: Vec<String> = files.iter().map(|file| file.display().to_string()).collect();
        let text = format!(
            "veduta = 1\n[city]\nfiles = {files:?}\nground = false\n[camera]\neye = [0, -40, 3]\ntarget = [0, 0, 0]\n\
             projection = \"orthographic\"\nheight_m = 24\n[sun]\nazimuth_deg = 180\nelevation_deg = 89\n"
        );
        let scene = parse(&text, "scene.toml", &Options { allow_outside: true, ..Options::default() })
            .unwrap_or_else(|error| panic!("{error}"));
        let mut studio = with_full_shadows(of_scene(&scene));
        // The same where a lens takes the far corner away.
        let far = Shape::Sphere { center: DVec3::new(4.5, 4.5, 6.0), radius: 0.6 };
        let with_lens = Scene { lenses: vec![lens("far", [far], "eraser")], ..scene.clone() };
        for (backend, scene) in BOTH.into_iter().flat_map(|backend| [(backend, &scene), (backend, &with_lens)]) {
            let view = View::new(scene.camera.expect("a camera"), SHADOWED, &studio.extent()).expect("a view");
            let request = Request { aovs: ALL, backend, ..Request::plain(SHADOWED) };
            let drawn = studio.render(scene, &request).expect("a picture");
            let light = |place: DVec3| {
                let p = view.pixel(place).expect("in the picture");
                f64::from(drawn.rgba[p.y as usize * SHADOWED[0] as usize + p.x as usize][1])
            };
            let outside = light(DVec3::new(9.0, 0.0, 0.0));
            for (what, place, wanted) in
                [("middle", DVec3::new(0.5, 0.5, 0.0), middle), ("corner", DVec3::new(-4.5, -4.5, 0.0), corner)]
            {
                let found = light(place) < 0.9 * outside;
                assert_eq!(found, wanted, "{mtl:?}, {gltf:?}, {backend:?}, {what}: {} of {outside}", light(place));
            }
        }
    }
}

/// Linear light of a byte of a picture (IEC 61966-2-1).
pub fn linear(byte: u8) -> f64 {
    let c = f64::from(byte) / 255.0;
    if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
}

#[test]
fn light_of_their_own_is_added_to_what_falls_on_surfaces() {
    let folder = Folder::new("materials-emission");
    let wall = folder.write("wall.obj", WALL);
    let of = |mtl: &str, more: &str| {
        folder.write("m.mtl", format!("newmtl a\n{mtl}\n"));
        at(&drawn(&of_file(&wall, more)), 1.0, 5.0).map(linear)
    };
    let dark = of("Kd 0.5 0.5 0.5", "");
    let glowing = of("Kd 0.5 0.5 0.5\nKe 0 0.6 0.3", "");
    // Numbers of MTL are those of a screen.
    let own = [0.0, 0.6, 0.3].map(|c: f64| if c == 0.0 { 0.0 } else { ((c + 0.055) / 1.055).powf(2.4) });
    for k in 0..3 {
        // A byte of a picture is 0.008 of light at most.
        assert!((glowing[k] - dark[k] - own[k]).abs() < 0.008, "{k}: {} and {}, {}", glowing[k], dark[k], own[k]);
    }
    // In a transparent picture the colour of what lets half through is its own.
    let half = of("Kd 0.5 0.5 0.5\nKe 0 0.6 0.3\nd 0.5", "");
    (0..3).for_each(|k| assert!((half[k] - glowing[k]).abs() < 0.008, "{k}: {half:?}, {glowing:?}"));
    // None in clay; the same in brick; none where a lens draws it in one colour.
    let clay = "[style]\nbase = \"clay\"\n";
    assert_eq!(of("Kd 0.5 0.5 0.5\nKe 0 0.6 0.3", clay), of("Kd 0.5 0.5 0.5", clay));
    let through = |effect: &str| {
        format!(
            "[[lens]]\nname = \"a\"\nkind = \"color\"\nbody = \"none\"\neffects = [{effect:?}]\n\
                 shape = {{ kind = \"sphere\", center = [0, 0, 5], radius = 4 }}\n"
        )
    };
    let [bricks, glowing_bricks] =
        ["", "\nKe 0 0.6 0.3"].map(|ke| of(&format!("Kd 0.5 0.5 0.5{ke}"), &through("brick")));
    for k in 0..3 {
        assert!((glowing_bricks[k] - bricks[k] - own[k]).abs() < 0.008, "{k}: {glowing_bricks:?}, {bricks:?}");
    }
    let [flat, flat_too] = ["", "\nKe 0 0.6 0.3"].map(|ke| of(&format!("Kd 0.5 0.5 0.5{ke}"), &through("flat")));
    assert_eq!(flat, flat_too);
    // Whatever else the scene has: an effect on materials elsewhere, or there, of which the light it adds is kept.
    let elsewhere = format!(
        "{}[[lens]]\nname = \"b\"\nkind = \"color\"\nbody = \"none\"\neffects = [\"glow\"]\n\
             shape = {{ kind = \"sphere\", center = [900, 0, 5], radius = 4 }}\n",
        through("flat")
    );
    let there =
        through("flat").replace(r#"["flat"]"#, "[{ effect = \"glow\", rim = 0, color = \"#004000\" }, \"flat\"]");
    for (what, more, added) in [("elsewhere", elsewhere, 0.0), ("there", there, 0.55 * linear(0x40))] {
        let [dark, lamp] = ["", "\nKe 0 0.6 0.3"].map(|ke| of(&format!("Kd 0.5 0.5 0.5{ke}"), &more));
        assert_eq!(dark, lamp, "{what}");
        for (k, added) in [0.0, added, 0.0].into_iter().enumerate() {
            assert!((dark[k] - flat[k] - added).abs() < 0.008, "{what}, {k}: {dark:?}, {flat:?}");
        }
    }
    // A style that is laid over what is below by no weight changes nothing, highlights included.
    let weightless = through("flat").replace(
        r#"["flat"]"#,
        "[{ effect = \"glow\", rim = 0 }, { effect = \"clay\", blend = \"replace\", weight = 0 }]",
    );
    let alone = through("flat").replace(r#"["flat"]"#, "[{ effect = \"glow\", rim = 0 }]");
    let lamp = "Kd 0.5 0.5 0.5\nKe 0 0.6 0.3";
    assert_eq!(of(lamp, &weightless), of(lamp, &alone));
}

/// A wall in a texture of one colour, and in a material of that: light, layers and textures agree about what a colour is.
#[test]
fn a_texture_of_one_colour_is_that_colour() {
    let folder = Folder::new("one-colour");
    let wall = "mtllib m.mtl\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nv -5 0 0\nv 5 0 0\nv 5 0 10\nv -5 0 10\nusemtl m\nf 1/1 2/2 3/3 4/4\n";
    let obj = folder.write("wall.obj", wall);
    let camera = veduta::view::Camera::looking(DVec3::new(3.0, -30.0, 5.0), DVec3::new(0.0, 0.0, 5.0), 0.7);
    for rgb in [[32_u8, 32, 32], [64, 64, 64], [128, 128, 128], [200, 40, 90]] {
        let [r, g, b] = rgb.map(|byte| f64::from(byte) / 255.0);
        image::RgbImage::from_pixel(4, 4, image::Rgb(rgb)).save(folder.0.join("one.png")).expect("an image");
        for opacity in ["", "d 0.5\n"] {
            for backend in BOTH {
                let drawn = [format!("Kd {r} {g} {b}\n"), "Kd 1 1 1\nmap_Kd one.png\n".to_owned()].map(|material| {
                    folder.write("m.mtl", format!("newmtl m\n{opacity}{material}"));
                    let mut studio = studio(std::slice::from_ref(&obj));
                    let scene = Scene { camera: Some(camera), ..Scene::default() };
                    let request = Request { backend, ..Request::plain([60, 40]) };
                    studio.render(&scene, &request).expect("a picture").rgba
                });
                let [material, texture] = &drawn;
                let worst = material.iter().zip(texture).flat_map(|(a, b)| (0..3).map(|i| a[i].abs_diff(b[i]))).max();
                // What is seen through is kept with 8 bits a channel, as a square root.
                let most = if opacity.is_empty() { 1 } else { 2 };
                assert!(worst <= Some(most), "{rgb:?} {opacity:?} {backend:?}: {worst:?}");
                let middle = material[60 * 20 + 30];
                assert!(material.contains(&middle) && middle != material[0], "{rgb:?}: the wall is there");
            }
        }
    }
}
