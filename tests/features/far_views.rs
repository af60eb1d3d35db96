//! Overlays that show much of a city in few pixels: they draw block models, no more triangles than four for each of their pixels, and
//! look as they would with all of it.

use crate::studio::*;
use veduta::{
    figure::{
        self,
        scene_file::{Options, parse},
    },
    lens::best_view::LocalView,
    render::picture::{Picture, Request},
    scene::Scene,
};

fn request(size: [u32; 2]) -> Request {
    Request { samples: 4, statistics: true, ..Request::plain(size) }
}

/// The built-in town with an overlay of this size, whose eye is so far from its middle.
fn town(size: [u32; 2], far: f64, rest: &str) -> Scene {
    let [width, height] = size;
    let text = format!(
        "veduta = 1\n[city]\nfiles = [\"builtin:town\"]\n[[lens]]\nname = \"far\"\nkind = \"see-through\"\n\
         view = {{ eye = [{far}, -{far}, {far}], target = [0, 0, 0] }}\n{rest}\n\
         [[overlay]]\nlens = \"far\"\nsize = [{width}, {height}]\nframe = \"none\"\n"
    );
    parse(&text, "s.toml", &Options::default()).unwrap_or_else(|error| panic!("{error}"))
}

/// Triangles that a pass of the overlay's view took for each of its pixels, one sample.
fn per_pixel(picture: &Picture, view: &str, pass: &str) -> f64 {
    let overlay = &picture.statistics.overlays[0];
    let pixels = overlay["width"].as_f64().unwrap() * overlay["height"].as_f64().unwrap();
    let own = picture.statistics.passes.iter().find(|p| p.view == view && p.name == pass);
    own.unwrap_or_else(|| panic!("{pass} of {view} is told")).triangles as f64 / pixels
}

#[test]
fn far_overlays_take_at_most_four_triangles_for_each_pixel() {
    let mut studio = with_full_shadows(of_scene(&town([32, 24], 300.0, "")));
    let all = studio.renderer.city().unwrap().triangles;
    for (size, far) in [([32, 24], 300.0), ([32, 24], 60.0), ([24, 40], 500.0), ([8, 6], 400.0), ([48, 30], 300.0)] {
        let scene = town(size, far, "");
        let picture = figure::draw(&mut studio, &scene, &request([640, 360])).unwrap();
        let triangles = picture.statistics.overlays[0]["triangles"].as_u64().unwrap();
        let [seen, casting] =
            [("far", "geometry"), ("far: sun", "shadow map")].map(|(view, pass)| per_pixel(&picture, view, pass));
        assert!(seen > 0.0 && seen <= 4.0, "{size:?} from {far} m: {seen} triangles a pixel");
        assert!(casting > 0.0 && casting <= 4.0, "{size:?} from {far} m: {casting} triangles a pixel cast shadows");
        assert_eq!(triangles as f64, seen * f64::from(size[0] * size[1]), "the overlay tells what its pass drew");
        assert!(triangles < all);
    }
}

#[test]
fn an_overlay_with_room_for_all_draws_all() {
    let scene = town([80, 60], 420.0, "");
    let mut studio = of_scene(&scene);
    let all = studio.renderer.city().unwrap().triangles;
    let picture = figure::draw(&mut studio, &scene, &request([640, 360])).unwrap();
    assert_eq!(picture.statistics.overlays[0]["triangles"].as_u64(), Some(all));
}

#[test]
fn a_far_overlay_looks_as_with_all_triangles() {
    let scene = town([36, 27], 260.0, "");
    let mut studio = of_scene(&scene);
    let picture = figure::draw(&mut studio, &scene, &request([640, 360])).unwrap();
    let [x, y] = ["x", "y"].map(|key| picture.statistics.overlays[0][key].as_u64().unwrap() as usize);
    let shown: Vec<[u8; 4]> = (0..27).flat_map(|row| &picture.rgba[(y + row) * 640 + x..][..36]).copied().collect();
    // From the same eye, as pictures of their own: all of the city, and nothing but its ground.
    let mut alone = scene.clone();
    let best_view = alone.lenses.remove(0).best_view().expect("a view").clone();
    let Some(LocalView::Camera { camera, .. }) = best_view.view() else { panic!("a camera") };
    alone.camera = Some(*camera);
    let full = studio.render(&alone, &request([36, 27])).unwrap().rgba;
    alone.style.effects = vec![used("eraser")];
    let bare = studio.render(&alone, &request([36, 27])).unwrap().rgba;
    let mean = |other: &[[u8; 4]]| {
        let sums = shown.iter().zip(other).map(|(a, b)| (0..3).map(|i| u32::from(a[i].abs_diff(b[i]))).sum::<u32>());
        f64::from(sums.sum::<u32>()) / (3 * shown.len()) as f64
    };
    let [own, without] = [&full, &bare].map(|other| mean(other));
    assert!(own > 0.0, "block models are drawn");
    // Seen: 0.12; 0.2 where roofs of blocks are all coloured as flat ones.
    assert!(own < 0.16 * without, "{own} of 255 off the city in full, {without} off the city without houses");
}
