//! Case 21, overlays: points of interest on one pixel, no overlay at all, overlays larger than the picture, and all of their places behind the
//! camera: a defined
//! picture, of one pixel too, and the same bytes by both back ends. Oracle: byte equality, and the picture without them.

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
};

use crate::studio;

const CITY: &str = r#"
veduta = 1

[city]
files = ["builtin:town"]

[camera]
eye = [-240.0, -310.0, 170.0]
target = [0.0, 0.0, 10.0]
"#;

const SIZES: [[u32; 2]; 2] = [[1, 1], [640, 360]];

fn scene(rest: &str) -> Scene {
    scene_file::parse(&format!("{CITY}{rest}"), "s", &Options::for_command_line()).unwrap_or_else(|e| panic!("{e}"))
}

/// As many annotations of places, each with an overlay.
fn annotations(places: &[[f64; 3]], overlay: &str) -> String {
    let one = |(i, [x, y, z]): (usize, &[f64; 3])| {
        format!(
            "[[poi]]\nname = \"p{i}\"\nat = [{x:?}, {y:?}, {z:?}]\n[[lens]]\nname = \"l{i}\"\nkind = \"annotation\"\npoi = \"p{i}\"\n\
             text = \"Place {i}\"\n[[overlay]]\nlens = \"l{i}\"\n{overlay}\n"
        )
    };
    places.iter().enumerate().map(one).collect()
}

fn drawn(studio: &mut Studio, scene: &Scene, size: [u32; 2]) -> Picture {
    let [one, other] = [Backend::Specialised, Backend::Uber].map(|backend| {
        let request = Request { statistics: true, backend, ..Request::plain(size) };
        figure::draw(studio, scene, &request).unwrap_or_else(|e| panic!("{e}"))
    });
    assert_eq!(one.rgba, other.rgba, "both back ends draw the same bytes");
    one
}

fn differing(a: &Picture, b: &Picture) -> usize {
    a.rgba.iter().zip(&b.rgba).filter(|(a, b)| a != b).count()
}

#[test]
fn no_overlays_leave_the_picture_as_it_is() {
    let mut studio = studio::studio(&["builtin:town".into()]);
    let bare = scene("");
    let off = annotations(&[[0.0, 0.0, 10.0]], "").replace("kind =", "enabled = false\nkind =");
    for size in SIZES {
        let plain = drawn(&mut studio, &bare, size);
        for rest in ["[layout]\nalong = \"right\"\n", &off] {
            let with = drawn(&mut studio, &scene(rest), size);
            assert_eq!((differing(&plain, &with), with.statistics.overlays.len()), (0, 0), "{rest}");
        }
    }
}

#[test]
fn places_on_one_pixel_have_their_overlays() {
    let mut studio = studio::studio(&["builtin:town".into()]);
    let bare = drawn(&mut studio, &scene(""), SIZES[1]);
    for line in ["straight", "orthogonal", "curved"] {
        let overlay = format!("size = [90, 40]\nline = {{ kind = \"{line}\", to = \"area\" }}");
        let together = scene(&annotations(&[[0.0, 0.0, 10.0]; 7], &overlay));
        let with = drawn(&mut studio, &together, SIZES[1]);
        assert_eq!(with.statistics.overlays.len(), 7);
        assert!(differing(&bare, &with) > 7 * 60 * 30, "{line}: seven overlays are seen");
        drawn(&mut studio, &together, SIZES[0]);
    }
}

#[test]
fn overlays_larger_than_the_picture_are_markers() {
    let mut studio = studio::studio(&["builtin:town".into()]);
    let places = [[0.0, 0.0, 10.0], [60.0, 20.0, 10.0], [-50.0, 40.0, 5.0]];
    let large = scene(&annotations(&places, "size = [4000, 3000]\nmin = [2000, 1500]"));
    for size in SIZES {
        let with = drawn(&mut studio, &large, size);
        assert_eq!(with.statistics.overlays.len(), 0, "none has room");
        let marked = differing(&drawn(&mut studio, &scene(""), size), &with);
        assert!(size == [1, 1] || (50..20_000).contains(&marked), "{marked} pixels of markers");
    }
    // Those that may shrink do.
    let shrinks = scene(&annotations(&places[..1], "size = [4000, 3000]\nmin = [40, 30]"));
    assert_eq!(drawn(&mut studio, &shrinks, SIZES[1]).statistics.overlays.len(), 1);
    drawn(&mut studio, &shrinks, SIZES[0]);
}

#[test]
fn places_behind_the_camera_have_arrows_or_nothing_and_no_lines() {
    let mut studio = studio::studio(&["builtin:town".into()]);
    // Behind the eye, in its plane, at it, and as far away as can be told.
    let places = [[-480.0, -620.0, 330.0], [-400.0, -190.0, 170.0], [-240.0, -310.0, 170.0], [-1e9, -1e9, 1e9]];
    let of = |outside: &str| {
        scene(&annotations(
            &places,
            &format!("size = [90, 40]\nline = {{ outside = \"{outside}\", width = 40.0, end_width = 40.0 }}"),
        ))
    };
    for size in SIZES {
        let [hidden, arrow] = ["hidden", "arrow"].map(|outside| drawn(&mut studio, &of(outside), size));
        if size != [1, 1] {
            assert_eq!([&hidden, &arrow].map(|p| p.statistics.overlays.len()), [4, 4]);
            // Lines of 40 pixels would cover thousands.
            let arrows = differing(&hidden, &arrow);
            assert!((20..4000).contains(&arrows), "{arrows} pixels of arrows");
        }
    }
}
