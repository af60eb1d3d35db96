//! Storeys and windows on walls without textures.

use veduta::{
    figure::scene_file::{Options, parse},
    render::{
        frame::Backend,
        picture::{Aovs, Picture, Request, Studio},
    },
    scene::{Scene, StyleLook},
};

use crate::studio::of_scene;

const SIZE: [u32; 2] = [320, 220];

fn scene(eye: &str, more: &str) -> Scene {
    let text = format!(
        "veduta = 1\n[city]\nfiles = [\"builtin:square\"]\n[camera]\n{eye}\nfov_deg = 46.0\n[style]\nfacades = true\n{more}"
    );
    parse(&text, "facades", &Options::for_command_line()).unwrap_or_else(|error| panic!("{error}"))
}

const NEAR: &str = "eye = [-26, -30, 12]\ntarget = [8, 12, 6]";

const AROUND: &str = "eye = [-60, -88, 50]\ntarget = [8, 12, 4]";

fn draw(studio: &mut Studio, scene: &Scene, facades: bool, backend: Backend) -> Picture {
    let mut scene = scene.clone();
    scene.style.facades = facades;
    let aovs = Aovs { depth: true, object_id: true, normal: true, lens_mask: true };
    studio.render(&scene, &Request { aovs, backend, ..Request::plain(SIZE) }).expect("a picture")
}

/// How many pixels are darker than without, and how many lighter.
fn changed(plain: &Picture, with: &Picture) -> [usize; 2] {
    let sum = |pixel: &[u8; 4]| pixel[..3].iter().map(|c| i32::from(*c)).sum::<i32>();
    let pairs = || plain.rgba.iter().zip(&with.rgba).map(|(a, b)| sum(b) - sum(a));
    [pairs().filter(|d| *d < -9).count(), pairs().filter(|d| *d > 9).count()]
}

/// How many pixels show something else, or farther off than by rounding.
fn others(plain: &Picture, with: &Picture) -> usize {
    let [ids, other_ids] = [plain, with].map(|picture| picture.object_id.as_deref().expect("ids"));
    let [depth, other] = [plain, with].map(|picture| picture.depth.as_deref().expect("depth"));
    let is_other = |i: &usize| {
        ids[*i] != other_ids[*i] || (depth[*i].is_finite() && (depth[*i] - other[*i]).abs() > 1e-5 * depth[*i])
    };
    (0..ids.len()).filter(is_other).count()
}

#[test]
fn walls_get_windows_and_nothing_else_changes() {
    let scene = scene(NEAR, "");
    let mut studio = of_scene(&scene);
    let plain = draw(&mut studio, &scene, false, Backend::Specialised);
    let with = draw(&mut studio, &scene, true, Backend::Specialised);
    let [darker, lighter] = changed(&plain, &with);
    assert!(darker > 3000 && lighter == 0, "{darker} darker, {lighter} lighter");
    assert!(others(&plain, &with) <= 3, "what is there is what was there");
    let uber = draw(&mut studio, &scene, true, Backend::Uber);
    let most = with.rgba.as_flattened().iter().zip(uber.rgba.as_flattened()).map(|(a, b)| a.abs_diff(*b)).max();
    assert!(most <= Some(1), "back ends differ by {most:?}");
    // Taken away they leave no trace.
    assert!(draw(&mut studio, &scene, false, Backend::Specialised).rgba == plain.rgba);
}

#[test]
fn every_look_shows_them_quietly() {
    for (word, look) in StyleLook::WORDS {
        let mut scene = scene(NEAR, "");
        scene.style.look = look;
        let mut studio = of_scene(&scene);
        let plain = draw(&mut studio, &scene, false, Backend::Specialised);
        let with = draw(&mut studio, &scene, true, Backend::Specialised);
        let [darker, lighter] = changed(&plain, &with);
        assert!(darker > 1500 && lighter < 20, "{word}: {darker} darker, {lighter} lighter");
        let mean = |picture: &Picture| {
            let all = picture.rgba.iter().flat_map(|pixel| &pixel[..3]).map(|c| f64::from(*c));
            all.sum::<f64>() / (3 * picture.rgba.len()) as f64
        };
        let share = mean(&with) / mean(&plain);
        assert!((0.9..1.0).contains(&share), "{word}: {share}");
    }
}

/// From afar walls have the colour that storeys and windows have on average, and no pattern.
#[test]
fn from_afar_they_are_an_even_tone() {
    let scene = scene("eye = [-900, -1300, 700]\ntarget = [0, 0, 5]", "background = \"#ffffff\"\n");
    let mut studio = of_scene(&scene);
    let plain = draw(&mut studio, &scene, false, Backend::Specialised);
    let with = draw(&mut studio, &scene, true, Backend::Specialised);
    let ratios: Vec<f64> = plain
        .rgba
        .iter()
        .zip(&with.rgba)
        .filter(|(a, _)| a[1] > 60)
        .map(|(a, b)| f64::from(b[1]) / f64::from(a[1]))
        // All colours are rounded to bytes once more.
        .filter(|ratio| *ratio < 0.985)
        .collect();
    assert!(ratios.len() > 100, "{} pixels of walls", ratios.len());
    let mean = ratios.iter().sum::<f64>() / ratios.len() as f64;
    let spread = (ratios.iter().map(|r| (r - mean).powi(2)).sum::<f64>() / ratios.len() as f64).sqrt();
    assert!((0.88..0.99).contains(&mean) && spread < 0.03, "{mean} ± {spread}");
}

/// Windows go with walls that lenses move or show elsewhere.
#[test]
fn windows_go_with_their_walls() {
    let lens = "[[lens]]\nname = \"l\"\nkind = \"deformation\"\nshape = { kind = \"sphere\", center = [8, 12, 6], radius = 40 }\ndeform = [{ kind = \"scale\", factors = [1, 1, 1.4] }]\n";
    let bent = scene(AROUND, lens);
    let mut studio = of_scene(&bent);
    let plain = draw(&mut studio, &bent, false, Backend::Specialised);
    let with = draw(&mut studio, &bent, true, Backend::Specialised);
    let [darker, lighter] = changed(&plain, &with);
    assert!(darker > 3000 && lighter < 20, "{darker} darker, {lighter} lighter");
    assert!(others(&plain, &with) <= 3, "what is there is what was there");
    let boxes = "[[lens]]\nname = \"l\"\nkind = \"content\"\nshape = { kind = \"sphere\", center = [8, 12, 6], radius = 60 }\ncontent = { derive = \"prism\" }\n";
    let boxes = scene(NEAR, boxes);
    let plain = draw(&mut studio, &boxes, false, Backend::Specialised);
    let with = draw(&mut studio, &boxes, true, Backend::Specialised);
    let [darker, lighter] = changed(&plain, &with);
    assert!(darker > 3000 && lighter < 20, "{darker} darker, {lighter} lighter");
}
