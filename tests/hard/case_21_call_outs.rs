//! Case 21, call-outs: boards seen from their edge, larger than the picture, partly behind the eye, seen from straight
//! above, a million kilometres away: a defined picture, of one pixel too, the same bytes again and by both back ends.
//! Oracle: byte equality, and the picture without them.

use glam::DVec3;
use veduta::{
    figure::{
        self,
        scene_file::{self, Options},
    },
    render::{
        frame::Backend,
        picture::{Picture, Request, Studio},
    },
    scene::Scene,
    view::{Camera, Projection},
};

use crate::studio;

const EYE: DVec3 = DVec3::new(-240.0, -310.0, 170.0);

/// Where, its size, and how it stands.
const BOARDS: [([f64; 3], [u32; 2], &str); 9] = [
    ([0.0, 0.0, 10.0], [240, 160], ""),
    ([0.0, 0.0, 10.0], [240, 160], "tilt_deg = 90"),
    ([0.0, 0.0, 10.0], [240, 160], "tilt_deg = -90, height_m = 0"),
    // In the height of the eye, lying: its edge is seen.
    ([0.0, 0.0, 160.0], [240, 160], "tilt_deg = 90, height_m = 10"),
    ([-200.0, -260.0, 140.0], [240, 160], "width_m = 100000, height_m = 0, tilt_deg = 80"),
    // A pixel that fills the picture.
    ([0.0, 0.0, 10.0], [1, 1], "width_m = 100000, height_m = 0"),
    ([-240.0, -309.5, 169.0], [16384, 1], "width_m = 0.001"),
    // Straight below the eye, and around it.
    ([-240.0, -310.0, 100.0], [240, 160], "width_m = 50, height_m = 70"),
    ([1e9, -1e9, 1e9], [240, 160], "width_m = 100000, height_m = 100000"),
];

fn scene() -> Scene {
    let frames = ["rounded", "ellipse", "print", "vignette", "none"];
    let board = |(i, (at, size, call_out)): (usize, &([f64; 3], [u32; 2], &str))| {
        format!(
            "[[poi]]\nname = \"p{i}\"\nat = {at:?}\n[[lens]]\nname = \"l{i}\"\nkind = \"see-through\"\npoi = \"p{i}\"\n\
             view = {{ eye = [0, -60, 30], target = [0, 0, 5] }}\n[[overlay]]\nlens = \"l{i}\"\nsize = {size:?}\nframe = \"{}\"\n\
             caption = \"Board {i}\"\nline = \"curved\"\ncall_out = {{ {call_out} }}\n",
            frames[i % frames.len()]
        )
    };
    let boards: String = BOARDS.iter().enumerate().map(board).collect();
    let text = format!("veduta = 1\n[city]\nfiles = [\"builtin:town\"]\n{boards}");
    scene_file::parse(&text, "s", &Options::for_command_line()).unwrap_or_else(|e| panic!("{e}"))
}

/// By both back ends, and once more.
fn drawn(studio: &mut Studio, scene: &Scene, size: [u32; 2]) -> Picture {
    let [one, other, again] = [Backend::Specialised, Backend::Uber, Backend::Specialised].map(|backend| {
        let request = Request { statistics: true, backend, ..Request::plain(size) };
        figure::draw(studio, scene, &request).unwrap_or_else(|e| panic!("{e}"))
    });
    assert!(one.rgba == other.rgba, "both back ends draw the same bytes");
    assert!(one.rgba == again.rgba, "and the same again");
    one
}

#[test]
fn extreme_boards_have_a_defined_picture() {
    let mut studio = studio::studio(&["builtin:town".into()]);
    let aslant = Camera::looking(EYE, DVec3::new(0.0, 0.0, 10.0), 0.8);
    let down = Camera { up: DVec3::Y, ..Camera::looking(DVec3::Z * 400.0, DVec3::ZERO, 0.8) };
    let level = Camera { projection: Projection::Orthographic { height_m: 200.0 }, ..aslant };
    for camera in [aslant, down, level] {
        let seen = Scene { camera: Some(camera), ..scene() };
        let bare = Scene { lenses: Vec::new(), overlays: Vec::new(), ..seen.clone() };
        for size in [[1, 1], [5, 300], [640, 360]] {
            let with = drawn(&mut studio, &seen, size);
            assert!(with.rgba.iter().all(|color| color[3] == 255), "{size:?}");
            let told = with.statistics.overlays.len();
            assert!(told < BOARDS.len(), "not all are seen from before, or before the eye");
            let without = drawn(&mut studio, &bare, size);
            let differing = with.rgba.iter().zip(&without.rgba).filter(|(a, b)| a != b).count();
            assert!(size != [640, 360] || (told > 0 && differing > 1000), "{told} boards on {differing} pixels");
        }
    }
}
