//! Pictures drawn in tiles: the same as in one piece.

use std::path::Path;

use veduta::{
    figure::{self, scene_file},
    render::{
        frame::Backend,
        picture::{Aovs, Picture, Request, Studio},
    },
    scene::{Scene, StyleLook},
};

use crate::studio::{is_tried, of_scene};

/// All of what pictures are compared by.
const ALL: Aovs = Aovs { depth: true, object_id: true, normal: true, lens_mask: true };
/// Sides of pictures that no side of a tile divides.
const SIZE: [u32; 2] = [300, 212];

/// How two pictures differ.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Differences {
    pixels: usize,
    /// Pixels with another object, another mask, another depth (by more than a part in 10⁵), another colour (by more than two steps of a channel).
    ids: usize,
    masks: usize,
    depths: usize,
    colors: usize,
}

impl Differences {
    fn of(whole: &Picture, tiled: &Picture) -> Self {
        let pixels = whole.rgba.len();
        let count = |differs: &dyn Fn(usize) -> bool| (0..pixels).filter(|i| differs(*i)).count();
        let [ids, other_ids] = [whole, tiled].map(|picture| picture.object_id.as_deref().expect("ids"));
        let [depth, other_depth] = [whole, tiled].map(|picture| picture.depth.as_deref().expect("depth"));
        let [masks, other_masks] = [whole, tiled].map(|picture| picture.lens_mask.as_deref().expect("masks"));
        Self {
            pixels,
            ids: count(&|i| ids[i] != other_ids[i]),
            masks: count(&|i| masks.iter().zip(other_masks).any(|(a, b)| a[i] != b[i])),
            depths: count(&|i| {
                let (a, b) = (depth[i], other_depth[i]);
                a.is_finite() != b.is_finite() || (a.is_finite() && (a - b).abs() > 1e-5 * a.abs())
            }),
            colors: count(&|i| whole.rgba[i].iter().zip(tiled.rgba[i]).any(|(a, b)| a.abs_diff(b) > 2)),
        }
    }

    fn add(&mut self, other: Self) {
        self.pixels += other.pixels;
        self.ids += other.ids;
        self.masks += other.masks;
        self.depths += other.depths;
        self.colors += other.colors;
    }
}

fn scene(name: &str) -> Scene {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(format!("{name}.toml"));
    scene_file::read(&path, &scene_file::Options::for_file(&path)).expect("a scene")
}

fn drawn(studio: &mut Studio, scene: &Scene, request: &Request, tile: Option<u32>) -> Picture {
    studio.renderer.settings.tile = tile;
    figure::draw(studio, scene, request).expect("a picture")
}

fn differences(studio: &mut Studio, scene: &Scene, request: &Request, tile: u32) -> Differences {
    let whole = drawn(studio, scene, request, None);
    let tiled = drawn(studio, scene, request, Some(tile));
    Differences::of(&whole, &tiled)
}

/// Scenes of the gallery: every kind of lens, overlays, deformations, filters, sections, sprites, translucent layers, parallel rays.
const SCENES: [&str; 23] = [
    "call-outs",
    "houses-on-the-way",
    "in-the-way",
    "lowered",
    "market-square",
    "near-and-far",
    "out-of-sight",
    "panorama",
    "planned-quarter",
    "rooms",
    "ropinski-6",
    "ropinski-8",
    "sections",
    "see-inside",
    "shown-as",
    "three-lenses",
    "tiesel-3-9",
    "town",
    "trapp-3-2-3-c",
    "trapp-3-3-1-d",
    "trapp-3-5-1",
    "trapp-5-3-3",
    "carbon-dioxide",
];

#[test]
fn tiles_make_the_picture_that_is_made_in_one_piece() {
    let mut all = Differences::default();
    for (i, name) in SCENES.into_iter().enumerate().filter(|(i, _)| is_tried(*i, 4)) {
        let scene = scene(name);
        let mut studio = of_scene(&scene);
        let samples = if i % 3 == 0 { 4 } else { 1 };
        let backend = if i / 2 % 2 == 0 { Backend::Specialised } else { Backend::Uber };
        let transparent = i % 5 == 0;
        let request = Request { samples, transparent, aovs: ALL, backend, ..Request::plain(SIZE) };
        let found = differences(&mut studio, &scene, &request, 64 + 16 * (i as u32 % 5));
        println!("{name}: {found:?}");
        all.add(found);
    }
    println!("all: {all:?}");
    assert!(all.ids as f64 <= 5e-6 * all.pixels as f64, "{all:?}");
}

#[test]
fn tiles_have_every_look() {
    let mut all = Differences::default();
    for (_, look) in StyleLook::WORDS {
        let mut scene = scene("market-square");
        scene.style.look = look;
        let mut studio = of_scene(&scene);
        let request = Request { samples: 2, aovs: ALL, ..Request::plain(SIZE) };
        let found = differences(&mut studio, &scene, &request, 96);
        println!("{look:?}: {found:?}");
        all.add(found);
    }
    assert!(all.ids as f64 <= 5e-6 * all.pixels as f64, "{all:?}");
}

/// What goes by pixels goes by those of the whole picture: patterns of ink, layers by chance, the texels of sprites, doors of pixels.
#[test]
fn patterns_and_sprites_know_nothing_of_tiles() {
    const LENSES: [&str; 5] = [
        "effects = [\"engraving\"]",
        "effects = [\"x-ray\"]",
        "effects = [\"screen-door\"]",
        "effects = [\"sepia\"]\nsprite = { resolution = 96 }",
        "effects = [\"sepia\"]\nsprite = { resolution = 700, format = \"unorm16\", layers = 2 }",
    ];
    let start = "veduta = 1\n[city]\nfiles = [\"builtin:square\"]\n[camera]\neye = [-75, -110, 62]\ntarget = [8, 12, 4]\nfov_deg = 46.0\n";
    let ball = "shape = { kind = \"sphere\", center = [8, 12, 6], radius = 40 }";
    let two = "shape = { kind = \"difference\", shapes = [{ kind = \"sphere\", center = [8, 12, 6], radius = 40 }, { kind = \"sphere\", center = [0, 0, 6], radius = 20 }] }";
    for (lens, shape) in LENSES.into_iter().flat_map(|lens| [(lens, ball), (lens, two)]) {
        let text = format!(
            "{start}[style]\ntransparency = \"stochastic\"\n[[lens]]\nname = \"l\"\nkind = \"color\"\n{shape}\n{lens}\n"
        );
        let scene = scene_file::parse(&text, "patterns", &scene_file::Options::for_command_line());
        let scene = scene.unwrap_or_else(|error| panic!("{error}"));
        let mut studio = of_scene(&scene);
        let request = Request { aovs: ALL, ..Request::plain(SIZE) };
        let found = differences(&mut studio, &scene, &request, 72);
        println!("{lens}: {found:?}");
        let Differences { ids, masks, depths, colors, .. } = found;
        assert!(ids + masks <= 1 && depths <= 2 && colors <= 6, "{lens}: {found:?}");
    }
}
