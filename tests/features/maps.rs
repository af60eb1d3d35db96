//! What textures of glTF and OBJ say beside colours: how much light of their own faces have, and which way they face.

use std::path::PathBuf;

use crate::materials::{BOTH, at, drawn, linear, of_file, wall_bytes, wall_gltf};
use crate::studio::*;
use glam::DVec3;
use veduta::{
    render::picture::{Picture, Request},
    scene::Scene,
};

/// The factor of the light of the wall's material.
const FACTOR: [f64; 3] = [1.0, 0.5, 1.0];
/// Its picture of light: the left half in this colour, the right half black.
const NIGHT: [u8; 3] = [200, 100, 60];

/// A wall whose textures are, by number, `base.png`, `night.png` and `normals.png`.
fn wall(folder: &Folder, name: &str, material: &str, node: &str) -> PathBuf {
    let images = r#""images":[{"uri":"base.png"},{"uri":"night.png"},{"uri":"normals.png"}]"#;
    let text = wall_gltf(node, material)
        .replace(r#""textures":[{"source":0}]"#, r#""textures":[{"source":0},{"source":1},{"source":2}]"#)
        .replace(r#""images":[{"uri":"leaf.png"}]"#, images);
    folder.write(name, text)
}

fn images(folder: &Folder, normal: [f64; 3]) {
    let save = |name: &str, texel: &dyn Fn(u32) -> [u8; 3]| {
        let image = image::RgbImage::from_fn(32, 32, |x, _| image::Rgb(texel(x)));
        image.save(folder.0.join(name)).expect("an image");
    };
    save("base.png", &|_| [120, 110, 100]);
    save("night.png", &|x| if x < 16 { NIGHT } else { [0; 3] });
    save("normals.png", &|_| normal.map(|c| ((0.5 * c + 0.5) * 255.0).round() as u8));
    folder.write("wall.bin", wall_bytes());
}

/// A material whose light is as its picture says.
fn glowing(base: &str) -> String {
    format!(
        r#"{{"doubleSided":true,"emissiveFactor":{FACTOR:?},"emissiveTexture":{{"index":1}},"pbrMetallicRoughness":{{{base}}}}}"#
    )
}

/// Light that the wall has more with its picture of light than without, left and right of the middle.
fn more(dark: &Picture, lit: &Picture) -> [[f64; 3]; 2] {
    [-2.5, 2.5].map(|x| {
        let [dark, lit] = [dark, lit].map(|picture| at(picture, x, 5.0));
        std::array::from_fn(|k| linear(lit[k]) - linear(dark[k]))
    })
}

#[test]
fn a_picture_says_how_much_light_of_their_own_faces_have() {
    let folder = Folder::new("maps-light");
    images(&folder, [0.0, 0.0, 1.0]);
    let node = r#"{"mesh":0}"#;
    let sphere = "shape = { kind = \"sphere\", center = [0, 0, 5], radius = 4.5 }\nbody = \"none\"\n";
    let lens = |more: &str| format!("[[lens]]\nname = \"a\"\n{sphere}{more}\n");
    let see_through = lens("kind = \"color\"\neffects = [{ effect = \"transparent\", opacity = 0.5 }]");
    let method = |name: &str| format!("[style]\ntransparency = \"{name}\"\n{see_through}");
    let colored = lens("kind = \"color\"\neffects = [{ effect = \"overlay\", color = \"#000000\", opacity = 0.0 }]");
    let by = |technique: &str| format!("[style]\ntechnique = \"{technique}\"\n{colored}");
    let moved = lens("kind = \"deformation\"\ndeform = [{ kind = \"translate\", by = [0.0, 0.0, 0.05] }]");
    let perspective = "\n[camera]\neye = [0, -30, 5]\ntarget = [0, 0, 5]\nfov_deg = 22.62\n";
    for (base, scenes) in [
        (
            r#""baseColorTexture":{"index":0}"#,
            vec![
                String::new(),
                perspective.to_owned(),
                see_through.clone(),
                method("k-buffer"),
                method("peel"),
                method("weighted"),
                by("branches"),
                by("regions"),
                moved,
            ],
        ),
        (r#""baseColorFactor":[0.2,0.2,0.2,1]"#, vec![String::new(), format!("{perspective}{see_through}")]),
    ] {
        let plain = format!(r#"{{"doubleSided":true,"pbrMetallicRoughness":{{{base}}}}}"#);
        let files =
            [plain, glowing(base)].map(|material| wall(&folder, &format!("{}.gltf", material.len()), &material, node));
        for more_scene in scenes {
            let pictures = files.each_ref().map(|file| {
                let mut scene = of_file(file, "");
                if !more_scene.is_empty() {
                    let camera = if more_scene.contains("[camera]") { String::new() } else { CAMERA.to_owned() };
                    scene = of_text(file, &format!("{camera}{more_scene}"));
                }
                drawn(&scene)
            });
            let [left, right] = more(&pictures[0], &pictures[1]);
            let all: [f64; 3] = std::array::from_fn(|k| linear(NIGHT[k]) * FACTOR[k]);
            // Haze takes its part of what is seen in perspective, of all colours alike.
            let clear = if more_scene.contains("fov_deg") { left[0] / all[0] } else { 1.0 };
            assert!((0.8..=1.0).contains(&clear), "{base} {more_scene}: {clear}");
            for k in 0..3 {
                let wanted = clear * all[k];
                // A byte of a picture is 0.008 of light at most, what is seen through has 8 bits a channel too.
                assert!((left[k] - wanted).abs() < 0.012, "{base} {more_scene}: {left:?}, not {wanted} in {k}");
                assert!(right[k].abs() < 0.004, "{base} {more_scene}: {right:?} where the picture is black");
            }
        }
        // In clay there is none.
        let clay =
            files.each_ref().map(|file| drawn(&of_text(file, &format!("{CAMERA}[style]\nbase = \"clay\"\n"))).rgba);
        assert!(clay[0] == clay[1], "{base}");
    }
}

/// What [`of_file`] looks with.
const CAMERA: &str = "[camera]\neye = [0, -30, 5]\ntarget = [0, 0, 5]\nprojection = \"orthographic\"\nheight_m = 12\n";

fn of_text(file: &std::path::Path, more: &str) -> Scene {
    use veduta::figure::scene_file::{Options, parse};
    let file = file.display().to_string();
    let text = format!("veduta = 1\n[city]\nfiles = [{file:?}]\nground = false\n{more}");
    parse(&text, "scene.toml", &Options { allow_outside: true, ..Options::default() })
        .unwrap_or_else(|error| panic!("{error}"))
}

/// Where a picture of light is not shown, its light would flood the whole face: there is none, and why is told.
#[test]
fn light_whose_picture_is_not_shown_is_left_out() {
    let folder = Folder::new("maps-missing");
    images(&folder, [0.0, 0.0, 1.0]);
    let base = r#""baseColorTexture":{"index":0}"#;
    let plain = format!(r#"{{"doubleSided":true,"pbrMetallicRoughness":{{{base}}}}}"#);
    let node = r#"{"mesh":0}"#;
    let dark = drawn(&of_file(&wall(&folder, "plain.gltf", &plain, node), "")).rgba;
    let elsewhere =
        glowing(base).replace(r#""emissiveTexture":{"index":1}"#, r#""emissiveTexture":{"index":1,"texCoord":1}"#);
    let turned = glowing(base).replace(
        r#""emissiveTexture":{"index":1}"#,
        r#""emissiveTexture":{"index":1,"extensions":{"KHR_texture_transform":{"offset":[0.5,0]}}}"#,
    );
    let no_image = glowing(base).replace(r#""emissiveTexture":{"index":1}"#, r#""emissiveTexture":{"index":7}"#);
    for (what, material, told) in [
        ("set", elsewhere, "unsupported"),
        ("transform", turned, "unsupported"),
        ("texture", no_image, "appearance-index-out-of-range"),
        ("file", glowing(base), "missing-texture"),
    ] {
        if what == "file" {
            std::fs::remove_file(folder.0.join("night.png")).expect("the picture of light");
        }
        let scene = of_file(&wall(&folder, "wall.gltf", &material, node), "");
        let studio = of_scene(&scene);
        let warnings: Vec<_> =
            studio.model.warnings.iter().map(|(code, warning)| (code.code(), warning.count)).collect();
        assert_eq!(warnings, [(told, 1)], "{what}");
        assert!(drawn(&scene).rgba == dark, "{what}");
    }
}

/// OBJ says the same by `map_Ke` and `norm`; a `Ke` of 0 beside a picture means the picture as it is.
#[test]
fn mtl_names_pictures_of_light_and_of_normals() {
    let folder = Folder::new("maps-mtl");
    let own = DVec3::new(0.48, 0.36, 0.8);
    images(&folder, own.to_array());
    let wall = folder.write(
        "wall.obj",
        "mtllib m.mtl\nv -5 0 0\nv 5 0 0\nv 5 0 10\nv -5 0 10\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl a\nf 1/1 2/2 3/3 4/4\n",
    );
    let of = |mtl: &str| {
        folder.write("m.mtl", format!("newmtl a\nKd 0.4 0.4 0.4\n{mtl}\n"));
        drawn(&of_file(&wall, ""))
    };
    let dark = of("");
    for (ke, factor) in [("Ke 1 1 1", 1.0), ("", 1.0), ("Ke 0.5 0.5 0.5", linear(128))] {
        let [left, right] = more(&dark, &of(&format!("{ke}\nmap_Ke night.png")));
        for k in 0..3 {
            let wanted = factor * linear(NIGHT[k]);
            assert!((left[k] - wanted).abs() < 0.012 && right[k].abs() < 0.004, "{ke}: {left:?} {right:?} {wanted}");
        }
    }
    // A face without texture coordinates, and a picture that is not there, are dark.
    assert!(of("Ke 1 1 1\nmap_Ke nowhere.png").rgba == dark.rgba);
    folder.write("m.mtl", "newmtl a\nKd 0.4 0.4 0.4\nKe 1 1 1\nmap_Ke night.png\n");
    let bare = folder.write("bare.obj", "mtllib m.mtl\nv -5 0 0\nv 5 0 0\nv 5 0 10\nv -5 0 10\nusemtl a\nf 1 2 3 4\n");
    assert!(drawn(&of_file(&bare, "")).rgba == dark.rgba);
    folder.write("m.mtl", "newmtl a\nnorm normals.png\n");
    let found = normal_at(&of_file(&wall, ""), 0.5, 5.0);
    assert!((found - DVec3::new(own.x, -own.z, own.y)).length() < 0.01, "{found}");
}

/// The normals of a wall's pixels, seen by both back ends alike.
fn normal_at(scene: &Scene, x: f64, z: f64) -> DVec3 {
    let mut studio = of_scene(scene);
    let [one, other] = BOTH.map(|backend| {
        let request = Request { transparent: true, aovs: ALL, backend, ..Request::plain([60, 60]) };
        studio.render(scene, &request).expect("a picture").normal.expect("normals")
    });
    assert!(one == other, "both back ends");
    let (column, row) = ((x + 6.0) * 5.0, (11.0 - z) * 5.0);
    DVec3::from(one[row as usize * 60 + column as usize].map(f64::from))
}

#[test]
fn a_picture_of_normals_turns_faces() {
    let folder = Folder::new("maps-normals");
    let own = DVec3::new(0.48, 0.36, 0.8);
    images(&folder, own.to_array());
    let material = |scale: f64| {
        format!(
            r#"{{"doubleSided":true,"normalTexture":{{"index":2,"scale":{scale}}},"pbrMetallicRoughness":{{"baseColorTexture":{{"index":0}}}}}}"#
        )
    };
    // The wall faces south: x along u is to the east, y against v up.
    let world = |n: DVec3| DVec3::new(n.x, -n.z, n.y).normalize_or(DVec3::Z);
    // Texture coordinates of its corners, and where the image's x and y are then.
    let mirrored = [[1.0_f32, 1.0], [0.0, 1.0], [0.0, 0.0], [1.0, 0.0]];
    let turned = [[0.0_f32, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]];
    let plain = wall_bytes();
    let with = |texcoords: Option<[[f32; 2]; 4]>| {
        let mut bytes = plain.clone();
        for (i, number) in texcoords.iter().flatten().flatten().enumerate() {
            bytes[48 + 4 * i..52 + 4 * i].copy_from_slice(&number.to_le_bytes());
        }
        folder.write("wall.bin", bytes)
    };
    let identity = r#"{"mesh":0}"#;
    let see_through = "[[lens]]\nname = \"a\"\nshape = { kind = \"sphere\", center = [0, 0, 5], radius = 4.5 }\n\
                       kind = \"color\"\neffects = [{ effect = \"transparent\", opacity = 0.6 }]\n";
    let perspective = "[camera]\neye = [0, -30, 5]\ntarget = [0, 0, 5]\nfov_deg = 22.62\n";
    for (what, texcoords, node, scale, more, wanted) in [
        ("as it is", None, identity, 1.0, "", world(own)),
        ("in perspective", None, identity, 1.0, perspective, world(own)),
        ("half as much", None, identity, 0.5, "", world(DVec3::new(0.5 * own.x, 0.5 * own.y, own.z))),
        ("mirrored", Some(mirrored), identity, 1.0, "", world(DVec3::new(-own.x, own.y, own.z))),
        // Its u is up, and its v to the east: up in the image is to the west.
        ("turned", Some(turned), identity, 1.0, "", world(DVec3::new(-own.y, own.x, own.z))),
        (
            "in a mirroring node",
            None,
            r#"{"mesh":0,"scale":[-1,1,1]}"#,
            1.0,
            "",
            world(DVec3::new(-own.x, own.y, own.z)),
        ),
        ("seen through", None, identity, 1.0, see_through, world(own)),
    ] {
        with(texcoords);
        let file = wall(&folder, "wall.gltf", &material(scale), node);
        let scene = if more.contains("[camera]") { of_text(&file, more) } else { of_file(&file, more) };
        let found = normal_at(&scene, 0.5, 5.0);
        // Bytes of the image, and of packed normals.
        assert!((found - wanted).length() < 0.01, "{what}: {found}, not {wanted}");
    }
    // From behind, a face is what it is from the front, the other way round.
    with(None);
    let file = wall(&folder, "wall.gltf", &material(1.0), identity);
    let behind = CAMERA.replace("-30", "30");
    let found = normal_at(&of_text(&file, &behind), 0.5, 5.0);
    assert!((found + world(own)).length() < 0.01, "from behind: {found}");
    // A face that is seen never looks away, whatever its picture says: from the west it is nearly level to the eye.
    let west = CAMERA.replace("eye = [0, -30, 5]", "eye = [-30, -3, 5]");
    let found = normal_at(&of_text(&file, &west), 0.0, 5.0);
    let to_eye = DVec3::new(-30.0, -3.0, 0.0).normalize_or(DVec3::X);
    assert!(found.dot(to_eye) > 0.01 && found.dot(to_eye) < 0.05 && found.dot(world(own)) > 0.8, "{found}");
    // What light falls on the face is another.
    let [flat, bumped] = [0.0, 1.0].map(|scale| {
        let file = wall(&folder, "wall.gltf", &material(scale), identity);
        at(&drawn(&of_file(&file, "")), 0.5, 5.0)
    });
    assert_ne!(flat, bumped);
}

/// Two walls that overlap in one plane, each in its image: what is over the other shows its image, and through its holes the other's.
#[test]
fn faces_that_overlap_in_one_plane_show_their_images() {
    let folder = Folder::new("maps-plane");
    let save = |name: &str, texel: &dyn Fn(u32, u32) -> [u8; 4]| {
        let image = image::RgbaImage::from_fn(32, 32, |x, y| image::Rgba(texel(x, y)));
        image.save(folder.0.join(name)).expect("an image");
    };
    save("large.png", &|x, _| if x < 16 { [180, 60, 40, 255] } else { [60, 160, 40, 255] });
    save("small.png", &|x, y| if x.abs_diff(16) < 6 && y.abs_diff(16) < 6 { [0; 4] } else { [40, 60, 180, 255] });
    folder.write("m.mtl", "newmtl large\nKd 1 1 1\nmap_Kd large.png\nnewmtl small\nKd 1 1 1\nmap_Kd small.png\n");
    let head = "mtllib m.mtl\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";
    let large = "v -5 0 0\nv 5 0 0\nv 5 0 10\nv -5 0 10\ng z\nusemtl large\nf -4/1 -3/2 -2/3 -1/4\n";
    let small = "v -3 0 2\nv 3 0 2\nv 3 0 8\nv -3 0 8\ng small\nusemtl small\nf -4/1 -3/2 -2/3 -1/4\n";
    // Of faces that nothing else tells apart, the one of the first name is over the other.
    let both = folder.write("both.obj", format!("{head}{large}{small}"));
    let turned = folder.write("turned.obj", format!("{head}{}{small}", large.replace("g z", "g a")));
    let alone = [large, small].map(|of| folder.write(&format!("{}.obj", of.len()), format!("{head}{of}")));
    let sphere = "shape = { kind = \"sphere\", center = [0, 0, 5], radius = 9 }\nbody = \"none\"\n";
    let lens = |more: &str| format!("[[lens]]\nname = \"a\"\n{sphere}{more}\n");
    let see_through = lens("kind = \"color\"\neffects = [{ effect = \"transparent\", opacity = 0.5 }]");
    let moved = lens("kind = \"deformation\"\ndeform = [{ kind = \"translate\", by = [0.0, 0.0, 0.05] }]");
    let perspective = "[camera]\neye = [0, -30, 5]\ntarget = [0, 0, 5]\nfov_deg = 22.62\n";
    // Haze is by the size of what there is.
    let steep = "[camera]\neye = [-20, -4, 9]\ntarget = [0, 0, 5]\nprojection = \"orthographic\"\nheight_m = 12\n";
    for (both, camera, more, opacity) in [
        (&both, CAMERA, String::new(), 1.0),
        (&turned, CAMERA, String::new(), 1.0),
        (&both, perspective, String::new(), 1.0),
        (&both, steep, String::new(), 1.0),
        (&both, CAMERA, moved, 1.0),
        (&both, CAMERA, see_through.clone(), 0.5),
        (&turned, steep, see_through.clone(), 0.5),
        (&both, perspective, format!("[style]\ntransparency = \"k-buffer\"\n{see_through}"), 0.5),
    ] {
        let over = usize::from(both == &turned);
        let of = |file: &PathBuf| drawn(&of_text(file, &format!("{camera}{more}"))).rgba;
        let (shown, [large, small]) = (of(both), alone.each_ref().map(of));
        let mut seen = [0; 2];
        for (k, rgba) in shown.iter().enumerate() {
            let opacities = [large[k], small[k]].map(|texel| f64::from(texel[3]) / 255.0);
            // Borders of the walls and of the hole are drawn in other pixels than those of one alone.
            let is_border = opacities.iter().any(|o| (o - opacity).abs() > 0.01 && *o > 0.01);
            if is_border || opacities[0] == 0.0 {
                continue;
            }
            // Straight alpha, so that what is opaque over what is opaque is as what lets a half through over such.
            let laid = |above: [u8; 4], below: [u8; 4]| -> [f64; 3] {
                let through = 1.0 - opacity;
                let all = opacity + through * opacity;
                std::array::from_fn(|c| opacity * (linear(above[c]) + through * linear(below[c])) / all)
            };
            let is_there = opacities[1] > 0.01;
            let wanted = match (is_there, over) {
                (false, _) => laid(large[k], large[k]),
                (true, 0) => laid(small[k], large[k]),
                (true, _) => laid(large[k], small[k]),
            };
            let is_near = (0..3).all(|c| (linear(rgba[c]) - wanted[c]).abs() < 0.012);
            // Haze is by the size of what there is: of the small one alone it is another.
            let is_right = is_near || (camera == perspective && is_there && rgba[2] > rgba[0]);
            let place = (k % 60, k / 60);
            assert!(is_right, "{camera}{more} {place:?}: {rgba:?}, {:?}, {:?}", large[k], small[k]);
            seen[usize::from(is_there)] += 1;
        }
        assert!(seen[0] > 100 && seen[1] > 100, "{camera}{more}: {seen:?}");
    }
}

/// The sun nearly along a wall whose picture of normals turns it to the sun: light is even, whatever the texels of the shadow map are.
#[test]
fn faces_that_images_turn_to_the_sun_do_not_shade_themselves() {
    let folder = Folder::new("maps-shadows");
    images(&folder, [0.8, 0.0, 0.6]);
    let material =
        r#"{"doubleSided":true,"normalTexture":{"index":2},"pbrMetallicRoughness":{"baseColorTexture":{"index":0}}}"#;
    let file = wall(&folder, "wall.gltf", material, r#"{"mesh":0}"#);
    for azimuth in [94, 98, 105, 120] {
        let sun = format!("[sun]\nazimuth_deg = {azimuth}\nelevation_deg = 20\n");
        let picture = drawn(&of_file(&file, &sun));
        let inner = (-22..=22).flat_map(|x| (3..=47).map(move |z| (f64::from(x) * 0.2, f64::from(z) * 0.2)));
        let greens: Vec<u8> = inner.map(|(x, z)| at(&picture, x, z)[1]).collect();
        let (least, most) = (greens.iter().min(), greens.iter().max());
        assert!(most.zip(least).is_some_and(|(most, least)| most - least <= 1), "{azimuth}: {least:?} to {most:?}");
    }
}

/// What a deformation turns is lit as without shadows, where the sun sees it: shadows begin before faces as they are shown, not as they
/// are at rest.
#[test]
fn faces_that_deformations_turn_do_not_shade_themselves() {
    let folder = Folder::new("maps-twist");
    images(&folder, [0.3, 0.2, 0.933]);
    let material = r#"{"doubleSided":true,"normalTexture":{"index":2}}"#;
    let file = wall(&folder, "wall.gltf", material, r#"{"mesh":0}"#);
    // A turn of some 4.5 degrees a metre.
    let twist = "[[lens]]\nname = \"a\"\nkind = \"deformation\"\nbody = \"none\"\ndeform = [{ kind = \"twist\", angle_deg = 1000 }]\n\
                 shape = { kind = \"cylinder\", center = [0, 0, -100], radius = 30, height = 220 }\n";
    let mut compared = 0;
    for eye_deg in (0..360).step_by(60) {
        let (sin, cos) = f64::from(eye_deg).to_radians().sin_cos();
        let camera = CAMERA.replace("[0, -30, 5]", &format!("[{}, {}, 5]", 30.0 * cos, 30.0 * sin));
        for aside in [-40, 40] {
            let (azimuth, elevation) = ((450 - eye_deg + aside) % 360, 25);
            let of = |shadows: bool| {
                let sun = format!("[sun]\nazimuth_deg = {azimuth}\nelevation_deg = {elevation}\nshadows = {shadows}\n");
                drawn(&of_text(&file, &format!("{camera}{sun}{twist}")))
            };
            let (shaded, bare) = (of(true), of(false));
            let (across, up) = (f64::from(azimuth).to_radians(), f64::from(elevation).to_radians());
            let sun = DVec3::new(across.sin() * up.cos(), across.cos() * up.cos(), up.sin());
            let normals = shaded.normal.as_ref().expect("normals");
            for (k, normal) in normals.iter().enumerate() {
                // Its border is as far from the map's texels as from the sun.
                let is_inner = [1, 60].iter().all(|step| {
                    [k.wrapping_sub(*step), k + step].iter().all(|k| normals.get(*k).is_some_and(|n| *n != [0.0; 3]))
                });
                if is_inner && DVec3::from(normal.map(f64::from)).dot(sun) > 0.5 {
                    compared += 1;
                    let (found, wanted) = (shaded.rgba[k], bare.rgba[k]);
                    assert!(found[1].abs_diff(wanted[1]) <= 2, "{eye_deg} {aside} {k}: {found:?}, not {wanted:?}");
                }
            }
        }
    }
    assert!(compared > 3000, "{compared}");
}
