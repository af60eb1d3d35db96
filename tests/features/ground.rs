//! The plain ground around a city, and looks of whole pictures: where ground ends nothing is seen of it, whatever is behind it, and both back
//! ends draw the same.

use glam::DVec3;
use veduta::{
    figure,
    render::{
        frame::Backend,
        picture::{Aovs, Picture, Request, Studio},
    },
    scene::{Scene, Style, StyleLook},
    view::Camera,
};

use crate::studio::*;

const SIZE: [u32; 2] = [192, 120];

/// The built-in town from beside it, up to the sky.
fn town(rest: &str) -> Scene {
    let text = format!(
        "veduta = 1\n[city]\nfiles = [\"builtin:town\"]\n[camera]\neye = [-240, -310, 90]\ntarget = [0, 0, 40]\n{rest}"
    );
    veduta::figure::scene_file::parse(&text, "town.toml", &Default::default()).unwrap_or_else(|error| panic!("{error}"))
}

fn drawn(studio: &mut Studio, scene: &Scene, backend: Backend, transparent: bool) -> Picture {
    let aovs = Aovs { depth: true, object_id: true, ..Aovs::default() };
    let request = Request { aovs, backend, transparent, ..Request::plain(SIZE) };
    figure::draw(studio, scene, &request).expect("a picture")
}

/// From above, the first rows of a column that show ground (of no object), if nothing of the city is before them.
fn horizon(picture: &Picture, x: usize) -> Option<usize> {
    let [w, h] = SIZE.map(|side| side as usize);
    let (depth, ids) = (picture.depth.as_ref()?, picture.object_id.as_ref()?);
    let first = (0..h).find(|y| depth[y * w + x].is_finite())?;
    (ids[first * w + x] == 0 && first > 0).then_some(first)
}

#[test]
fn ground_fades_into_what_is_behind_it_in_every_look() {
    let mut studio = of_scene(&town(""));
    let width = SIZE[0] as usize;
    for (word, look) in StyleLook::WORDS {
        let scene = Scene { style: Style { look, ..Style::default() }, ..town("") };
        let picture = drawn(&mut studio, &scene, Backend::Uber, false);
        let mut found = 0;
        for x in 0..width {
            let Some(first) = horizon(&picture, x) else { continue };
            found += 1;
            let [above, below] = [first - 1, first].map(|y| picture.rgba[y * width + x]);
            let step = (0..3).map(|c| above[c].abs_diff(below[c])).max().unwrap();
            assert!(step <= 2, "{word}: a step of {step} at column {x}: {above:?}, {below:?}");
        }
        assert!(found > width / 3, "{word}: ground meets the sky in {found} columns");
        // Before the houses it is ground.
        let near = picture.rgba[(SIZE[1] as usize - 1) * width + width / 2];
        let far = picture.rgba[width / 2];
        assert!((0..3).any(|c| near[c].abs_diff(far[c]) > 6), "{word}: {near:?} is ground, {far:?} is not");
        let other = drawn(&mut studio, &scene, Backend::Specialised, false);
        let differing = picture.rgba.iter().zip(&other.rgba).filter(|(a, b)| a != b).count();
        assert_eq!(differing, 0, "{word}: both back ends");
    }
}

/// A low sun throws the shadow of a cube of 10 m far beyond all that the city's own boxes hold; it ends where the rays of the sun say.
#[test]
fn shadows_on_the_plain_ground_are_whole() {
    let file = citydata("cube.city.json");
    let text = format!("veduta = 1\n[city]\nfiles = [{:?}]\n", file.to_str().expect("a path"));
    let options = figure::scene_file::Options { allow_outside: true, ..Default::default() };
    let mut scene = figure::scene_file::parse(&text, "cube.toml", &options).unwrap_or_else(|error| panic!("{error}"));
    let mut studio = of_scene(&scene);
    // From the west: the shadow lies to the east, 10 m / tan 9° = 63 m long.
    let elevation = 9.0_f64.to_radians();
    (scene.sun.azimuth, scene.sun.elevation) = (270.0_f64.to_radians(), elevation);
    let length = 10.0 / elevation.tan();
    // Straight from above, 0.5 m a pixel, the cube at the left.
    let middle = DVec3::new(40.0, 5.0, 0.0);
    scene.camera = Some(orthographic(middle + 90.0 * DVec3::Z, middle, 0.5 * f64::from(SIZE[1])));
    let picture = drawn(&mut studio, &scene, Backend::Uber, false);
    let at = |x: f64, y: f64| {
        let [w, h] = SIZE.map(f64::from);
        let (column, row) = (0.5 * w + (x - middle.x) * 2.0, 0.5 * h - (y - middle.y) * 2.0);
        picture.rgba[row as usize * SIZE[0] as usize + column as usize][..3].iter().map(|c| u32::from(*c)).sum::<u32>()
    };
    // Beside the shadow, as far from the cube: ground fades.
    for x in [14.0, 30.0, 50.0, 10.0 + length - 2.0] {
        assert!(at(x, 5.0) + 20 < at(x, 25.0), "{x} m: {} of {}", at(x, 5.0), at(x, 25.0));
    }
    let beyond = [5.0, 25.0].map(|y| at(10.0 + length + 2.0, y));
    assert!(beyond[0].abs_diff(beyond[1]) < 6, "{beyond:?}");
}

#[test]
fn ground_of_a_transparent_picture_fades_away() {
    let scene = town("");
    let mut studio = of_scene(&scene);
    for backend in [Backend::Specialised, Backend::Uber] {
        let picture = drawn(&mut studio, &scene, backend, true);
        let width = SIZE[0] as usize;
        let opacities: Vec<u8> =
            (0..width).filter_map(|x| Some(picture.rgba[horizon(&picture, x)? * width + x][3])).collect();
        assert!(opacities.len() > width / 3 && opacities.iter().all(|opacity| *opacity <= 2), "{opacities:?}");
        assert_eq!(picture.rgba[(SIZE[1] as usize - 1) * width + width / 2][3], 255, "near it is there");
    }
}

/// A post style acts on ground and sky alike, and a scene style does not end the fading.
#[test]
fn styles_of_the_context_leave_no_line_at_the_horizon() {
    let plain = town("");
    let mut studio = of_scene(&plain);
    let width = SIZE[0] as usize;
    for effects in ["['sepia']", "['gooch', 'posterise']", "['clay', 'edges']"] {
        let scene = town(&format!("[style]\neffects = {effects}\n"));
        let picture = drawn(&mut studio, &scene, Backend::Specialised, false);
        for x in 0..width {
            let Some(first) = horizon(&picture, x) else { continue };
            let [above, below] = [first - 1, first].map(|y| picture.rgba[y * width + x]);
            let step = (0..3).map(|c| above[c].abs_diff(below[c])).max().unwrap();
            assert!(step <= 2, "{effects}: a step of {step} at column {x}: {above:?}, {below:?}");
        }
    }
}

#[test]
fn a_deformation_of_the_whole_city_takes_the_ground_around_it_away() {
    let bent = "[[lens]]\nname = \"bent\"\nkind = \"deformation\"\n\
                shape = { kind = \"box\", center = [0, 0, 0], size = [2000, 2000, 400] }\n\
                deform = [{ kind = \"translate\", by = [0, 0, 30] }]\n";
    let camera = Camera::looking(DVec3::new(-240.0, -310.0, 90.0), DVec3::new(0.0, 0.0, 40.0), 0.8);
    let [plain, deformed] = ["", bent].map(|rest| Scene { camera: Some(camera), ..town(rest) });
    let mut studio = of_scene(&plain);
    let shown = |studio: &mut Studio, scene: &Scene| {
        let picture = drawn(studio, scene, Backend::Uber, false);
        picture.depth.unwrap().iter().filter(|depth| depth.is_finite()).count()
    };
    let [before, after] = [&plain, &deformed].map(|scene| shown(&mut studio, scene));
    assert!(after * 4 < before * 3, "{after} pixels show something, {before} before");
}

/// What is opaque lies elsewhere: held against it, all of a translucent layer would be a line.
#[test]
fn lines_of_a_look_leave_translucent_layers_alone() {
    let glass = "[[lens]]\nname = \"glass\"\nkind = \"color\"\nbody = \"none\"\n\
                 shape = { kind = \"box\", center = [0, 0, 0], size = [900, 900, 400] }\n\
                 effects = [{ effect = \"transparent\", opacity = 0.4 }]\n";
    let scenes = [String::new(), "effects = [{ effect = 'edges', strength = 0 }]\n".to_owned()]
        .map(|rest| town(&format!("[style]\nlook = \"paper\"\n{rest}{glass}")));
    let mut studio = of_scene(&scenes[0]);
    for backend in [Backend::Specialised, Backend::Uber] {
        let [lined, bare] = [0, 1].map(|i| drawn(&mut studio, &scenes[i], backend, false));
        let of_objects: Vec<usize> =
            (0..lined.rgba.len()).filter(|i| lined.object_id.as_ref().is_some_and(|ids| ids[*i] > 0)).collect();
        let light = |of: &Picture| of_objects.iter().map(|i| f64::from(of.rgba[*i][1])).sum::<f64>();
        let kept = light(&lined) / light(&bare);
        assert!(of_objects.len() > 2000 && kept > 0.93, "{kept} of the light of {} pixels", of_objects.len());
    }
}
