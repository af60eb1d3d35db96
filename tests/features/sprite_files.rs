//! Depth sprites that have their own eye, and saved ones: every shown place is where f64 says it is in the sprite's own space.

use std::path::{Path, PathBuf};

use crate::studio::{self, Reference, lens, orthographic, scene, synthetic, used};
use glam::{DQuat, DVec2, DVec3};
use veduta::{
    city::synth,
    figure::picture::{Aov, AovFile},
    geom::{Aabb, Shape},
    lens::{
        Class, EffectUse, Lens, LensBody, LensSprite, OwnEye, Parameter, Placement, Region, SpriteSpace, classify,
        sprite::{DepthCode, Format, Mapping},
        sprite_file,
    },
    render::{
        frame::Backend,
        picture::{Picture, Request, Studio},
    },
    scene::{Scene, Sun},
    view::{Camera, View},
};

const SIZE: [u32; 2] = [200, 150];
/// Texels along the longer side of the frame of own eyes.
const RESOLUTION: u32 = 240;

fn house(studio: &Studio) -> DVec3 {
    let geometry = studio.geometries[studio.geometries.len() / 2];
    studio.model.geometries[geometry as usize].bounds.center()
}

fn cameras(at: DVec3) -> [Camera; 2] {
    [
        Camera::looking(at + DVec3::new(90.0, -120.0, 70.0), at, 0.9),
        orthographic(at + DVec3::new(90.0, -120.0, 70.0), at, 160.0),
    ]
}

/// Own eyes: away from the picture's, one that all sees, one that cuts the lens off, and one with parallel rays.
fn own_eyes(at: DVec3) -> [OwnEye; 3] {
    [
        OwnEye { camera: Camera::looking(at + DVec3::new(-70.0, -60.0, 90.0), at, 0.9), aspect: 1.0 },
        OwnEye { camera: Camera::looking(at + DVec3::new(-20.0, 90.0, 25.0), at + DVec3::Z * 12.0, 0.5), aspect: 1.6 },
        OwnEye { camera: orthographic(at + DVec3::new(10.0, 15.0, 120.0), at, 80.0), aspect: 0.75 },
    ]
}

/// Balls, boxes, and what rays enter and leave several times.
fn shapes(at: DVec3) -> Vec<Vec<Region>> {
    let turn = DQuat::from_rotation_z(0.6) * DQuat::from_rotation_x(0.35);
    let ball = |by: DVec3, radius: f64| Region::from(Shape::Sphere { center: at + by, radius });
    vec![
        vec![ball(DVec3::ZERO, 28.0)],
        vec![Shape::Box { center: at, size: DVec3::new(50.0, 40.0, 30.0), rotation: turn }.into()],
        vec![Region::Mesh { file: "citydata/ring.obj".into(), at, rotation: turn, scale: 25.0 }],
        vec![ball(DVec3::new(-16.0, -14.0, 14.0), 12.0), ball(DVec3::new(16.0, 10.0, -4.0), 14.0)],
    ]
}

fn formats() -> [LensSprite; 5] {
    let of = |format, mapping| LensSprite { format, mapping, ..LensSprite::default() };
    [
        LensSprite::default(),
        of(Format::Unorm16, Mapping::W),
        of(Format::Uint32, Mapping::Z),
        of(Format::Float16, Mapping::ComplementaryZ),
        of(Format::Unorm8, Mapping::InverseW),
    ]
}

const CLASSES: [(Class, &str, [u8; 3]); 4] = [
    (Class::Inside, "#00ff00", [0, 255, 0]),
    (Class::Front, "#ff0000", [255, 0, 0]),
    (Class::Behind, "#0000ff", [0, 0, 255]),
    (Class::Rest, "#ffffff", [255, 255, 255]),
];

/// A lens that paints each class in a colour of its own.
fn painting(shapes: &[Region], sprite: Option<LensSprite>) -> Lens {
    let paint = |(class, color, _): (Class, &str, [u8; 3])| EffectUse {
        class,
        parameters: [
            ("color".to_owned(), Parameter::Text(color.to_owned())),
            ("opacity".to_owned(), Parameter::Number(1.0)),
        ]
        .into(),
        ..used("overlay")
    };
    Lens { sprite, effects: CLASSES.map(paint).to_vec(), ..lens("painting", shapes.to_vec(), "sepia") }
}

fn request(backend: Backend) -> Request {
    let aovs = veduta::render::picture::Aovs { depth: true, ..Default::default() };
    Request { aovs, backend, ..Request::plain(SIZE) }
}

fn drawn(studio: &mut Studio, scene: &Scene) -> Picture {
    studio.render(scene, &request(Backend::Specialised)).expect("a picture")
}

/// The class of each pixel of a picture that such a lens painted.
fn classes(picture: &Picture) -> Vec<Class> {
    let class = |rgba: &[u8; 4]| {
        let found = CLASSES.iter().find(|(_, _, color)| *color == rgba[..3]);
        found.unwrap_or_else(|| panic!("{rgba:?} is no class")).0
    };
    picture.rgba.iter().map(class).collect()
}

fn view(camera: Camera, size: [u32; 2]) -> View {
    View::new(camera, size, &Aabb { min: camera.eye - 1e5, max: camera.eye + 1e5 }).expect("a view")
}

/// What a sprite is held against: its eye, the shapes seen by it, and how it stores distances.
struct Expected<'a> {
    own: View,
    space: SpriteSpace,
    references: Vec<Reference>,
    code: &'a dyn Fn(f64) -> f64,
    is_aggregate: bool,
}

impl<'a> Expected<'a> {
    /// Of a lens of these shapes, whose stored depths are off by `code` at a distance.
    fn of(own: View, lens: &[Region], code: &'a dyn Fn(f64) -> f64) -> Self {
        let references = lens.iter().map(Reference::of).collect();
        Self { own, space: SpriteSpace::of(&own), references, code, is_aggregate: false }
    }
}

/// The class of a shown place, and of the places that rounding and the steps of the format may take it for.
fn allowed(expected: &Expected, place: DVec3) -> Vec<Class> {
    let Some(at) = expected.space.texel(place) else { return vec![Class::Rest] };
    let mut found = Vec::new();
    // To the rounding of the projection in f32.
    let around = [[0.0, 0.0], [4e-3, 0.0], [-4e-3, 0.0], [0.0, 4e-3], [0.0, -4e-3]];
    let mut texels = around.map(|by| [(at.x + by[0]).floor(), (at.y + by[1]).floor()]).to_vec();
    texels.dedup();
    for [x, y] in texels {
        let is_out = x < 0.0 || y < 0.0 || x >= expected.space.size[0].into() || y >= expected.space.size[1].into();
        if is_out {
            found.push(Class::Rest);
            continue;
        }
        let ray = expected.own.ray(DVec2::new(x + 0.5, y + 0.5));
        let mut ends: Vec<(f64, f64)> = expected.references.iter().flat_map(|r| r.intervals(&ray)).collect();
        ends.retain(|(_, exit)| *exit > 0.0);
        ends.sort_by(|a, b| a.0.total_cmp(&b.0));
        if let (true, Some(first), Some(last)) = (expected.is_aggregate, ends.first(), ends.last()) {
            ends = vec![(first.0, last.1)];
        }
        // Rays that graze the shape are found to the root of the rounding.
        let grazing = ends.iter().map(|(a, b)| 4e-3 / (b - a).max(1e-3)).fold(0.0, f64::max);
        let room = 2.1 * (expected.code)(at.z) + 2e-3 + grazing.min(2.0);
        let near = ends.iter().flat_map(|(a, b)| [*a, *b]).filter(|end| (end - at.z).abs() <= room);
        let places = near.flat_map(|end| [end.next_down(), end]).chain([at.z - room, at.z, at.z + room]);
        found.extend(places.map(|d| classify(&ends, d)));
        if grazing > 0.5 {
            found.push(Class::Rest);
        }
    }
    found
}

/// Holds every pixel of a picture against f64; how many are of each class, and how many might be of another as well.
fn compare(name: &str, picture: &Picture, camera: Camera, expected: &Expected) -> ([usize; 4], usize) {
    let (view, depth) = (view(camera, SIZE), picture.depth.as_ref().expect("depth"));
    let (mut counts, mut unsure) = ([0; 4], 0);
    for (i, class) in classes(picture).into_iter().enumerate() {
        // What shows nothing is far away.
        let d = if depth[i].is_finite() { f64::from(depth[i]) } else { 1e9 };
        let place = view.pixel_ray(i as u32 % SIZE[0], i as u32 / SIZE[0]).at(d);
        let allowed = allowed(expected, place);
        let of = format!("pixel {i} at {:?}", expected.space.texel(place));
        assert!(allowed.contains(&class), "{name}: {of} is {class:?}, allowed {allowed:?}");
        unsure += usize::from(allowed.iter().any(|other| *other != allowed[0]));
        counts[CLASSES.iter().position(|(c, ..)| *c == class).expect("a class")] += 1;
    }
    (counts, unsure)
}

fn add(all: &mut [usize; 4], counts: [usize; 4]) {
    (0..4).for_each(|i| all[i] += counts[i]);
}

#[test]
fn own_projections_are_those_of_f64() {
    let mut studio = synthetic(60);
    let at = house(&studio);
    let mut all = [0; 4];
    for (eye, own) in own_eyes(at).into_iter().enumerate() {
        for (shape, of_lens) in shapes(at).into_iter().enumerate() {
            for sprite in formats() {
                for is_aggregate in [false, true] {
                    if is_aggregate && (shape < 3 || sprite != LensSprite::default()) {
                        continue;
                    }
                    let sprite =
                        LensSprite { own: Some(own), resolution: Some(RESOLUTION), aggregate: is_aggregate, ..sprite };
                    let name = format!("shape {shape}, eye {eye}, {sprite:?}");
                    let camera = cameras(at)[(eye + shape) % 2];
                    let scene = scene(camera, vec![painting(&of_lens, Some(sprite))]);
                    let picture = drawn(&mut studio, &scene);
                    let texels = studio.sprites(&scene, SIZE, 0).expect("a picture").remove(0);
                    let size = own.size(RESOLUTION);
                    assert_eq!((texels.space.size, size[0].max(size[1])), (size, RESOLUTION), "{name}");
                    let code = texels.code;
                    let step = |d: f64| code.quantum_m(d.clamp(code.near_m, code.far_m.min(1e4)));
                    let own = view(own.camera, size);
                    let expected = Expected { is_aggregate, ..Expected::of(own, &of_lens, &step) };
                    let (counts, unsure) = compare(&name, &picture, camera, &expected);
                    if sprite.format != Format::Unorm8 {
                        assert!(unsure < 3_000, "{name}: {unsure} are not told");
                    }
                    add(&mut all, counts);
                }
            }
        }
    }
    assert!(all.iter().all(|n| *n > 10_000), "{all:?}");
}

/// A folder that is gone with the value.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let folder = std::env::temp_dir().join(format!("veduta-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a temporary folder");
        Self(folder)
    }

    fn file(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        std::fs::remove_dir_all(&self.0).ok();
    }
}

/// Saves the sprite of the only lens of a scene.
fn save(studio: &mut Studio, scene: &Scene, file: &Path) -> DepthCode {
    let sprite = studio.sprite_of(scene, SIZE, 0).expect("a sprite");
    std::fs::write(file, sprite_file::bytes(&sprite).expect("a file")).expect("a temporary file");
    assert_eq!(sprite_file::read(file).expect("it is read"), sprite);
    sprite.code
}

fn saved(file: &Path) -> [Region; 1] {
    [Region::Sprite { file: file.to_owned() }]
}

#[test]
fn what_is_saved_is_the_same_lens_again() {
    let folder = Folder::new("saved-sprites");
    let mut studio = synthetic(60);
    let at = house(&studio);
    let own = own_eyes(at).map(Some);
    let eyes = [None, own[0], own[2]];
    let mut all = [0; 4];
    let mut number = 0;
    for camera in cameras(at) {
        for (eye, own) in eyes.into_iter().enumerate() {
            for (shape, of_lens) in shapes(at).into_iter().enumerate() {
                for sprite in [formats()[shape], formats()[(shape + 1 + eye) % 5]] {
                    number += 1;
                    // One of the two in turn, and in a thorough run both.
                    if !studio::is_tried(number + eye + shape, 2) {
                        continue;
                    }
                    let file = folder.file(&format!("{number}.exr"));
                    let resolution = own.map(|_| RESOLUTION);
                    let sprite = LensSprite { own, resolution, ..sprite };
                    let name = format!("shape {shape}, {sprite:?} from {}", camera.eye);
                    let first = scene(camera, vec![painting(&of_lens, Some(sprite))]);
                    let code = save(&mut studio, &first, &file);
                    let with = |camera| scene(camera, vec![painting(&saved(&file), None)]);
                    let before = classes(&drawn(&mut studio, &first));
                    let after = classes(&drawn(&mut studio, &with(camera)));
                    let apart = (0..before.len()).filter(|&i| before[i] != after[i]).count();
                    assert_eq!(apart, 0, "{name}");
                    // From elsewhere the place alone says where it is.
                    let other = Camera::looking(at + DVec3::new(-80.0, -70.0, 50.0), at, 0.8);
                    let seen = own.map_or(view(camera, SIZE), |own| view(own.camera, own.size(RESOLUTION)));
                    let step = |d: f64| code.quantum_m(d.clamp(code.near_m, code.far_m.min(1e4)));
                    let expected = Expected::of(seen, &of_lens, &step);
                    let (counts, _) = compare(&name, &drawn(&mut studio, &with(other)), other, &expected);
                    add(&mut all, counts);
                }
            }
        }
    }
    let least = if studio::is_thorough() { 20_000 } else { 8_000 };
    assert!(all.iter().all(|n| *n > least), "{all:?}");
}

#[test]
fn other_clip_settings_are_as_good_as_their_steps() {
    let folder = Folder::new("clipped-sprites");
    let mut studio = synthetic(60);
    let at = house(&studio);
    let file = folder.file("s.exr");
    let own = own_eyes(at)[0];
    for of_lens in [shapes(at).remove(0), shapes(at).remove(3)] {
        let sprite = LensSprite { own: Some(own), resolution: Some(RESOLUTION), ..LensSprite::default() };
        let camera = cameras(at)[0];
        save(&mut studio, &scene(camera, vec![painting(&of_lens, Some(sprite))]), &file);
        let seen = view(own.camera, own.size(RESOLUTION));
        for (_, format) in Format::WORDS {
            for (_, mapping) in Mapping::WORDS {
                for (near_m, far_m) in [(None, None), (Some(20.0), Some(400.0))] {
                    let again = LensSprite { format, mapping, near_m, far_m, ..LensSprite::default() };
                    let name = format!("{again:?}");
                    let scene = scene(camera, vec![painting(&saved(&file), Some(again))]);
                    let picture = drawn(&mut studio, &scene);
                    let code = studio.sprites(&scene, SIZE, 0).expect("a picture").remove(0).code;
                    assert_eq!((code.format, code.mapping), (format, mapping));
                    assert!(near_m.is_none_or(|near| near == code.near_m), "{code:?}");
                    let step = |d: f64| code.quantum_m(d.clamp(code.near_m, code.far_m.min(1e4))) + 1e-3;
                    let expected = Expected::of(seen, &of_lens, &step);
                    let (counts, _) = compare(&name, &picture, camera, &expected);
                    assert!(counts[0] > 100 && counts[3] > 1_000, "{name}: {counts:?}");
                }
            }
        }
        // A coarse format does show.
        let coarse = LensSprite { format: Format::Unorm8, near_m: Some(1.0), ..LensSprite::default() };
        let mut of = |sprite| classes(&drawn(&mut studio, &scene(camera, vec![painting(&saved(&file), sprite)])));
        let (fine, coarse) = (of(None), of(Some(coarse)));
        assert!((0..fine.len()).filter(|&i| fine[i] != coarse[i]).count() > 50);
    }
}

/// National coordinates, far from the origin: f32 alone would be off by decimetres.
#[test]
fn coordinates_may_be_those_of_a_country() {
    let folder = Folder::new("far-sprites");
    let file = folder.file("far.city.json");
    let mut text = Vec::new();
    synth::write_cityjson(&synth::SynthOptions { buildings: 40, seed: 7 }, &mut text, &mut |_| ()).expect("a city");
    let mut city: serde_json::Value = serde_json::from_slice(&text).expect("JSON");
    for (i, by) in [3_500_000.0, 5_400_000.0, 300.0].into_iter().enumerate() {
        let translate = &mut city["transform"]["translate"][i];
        *translate = (translate.as_f64().expect("a number") + by).into();
    }
    if let Some(metadata) = city.get_mut("metadata").and_then(serde_json::Value::as_object_mut) {
        metadata.remove("geographicalExtent");
    }
    std::fs::write(&file, serde_json::to_vec(&city).expect("JSON")).expect("a temporary file");
    let mut studio = studio::studio(&[file]);
    let at = house(&studio);
    assert!(at.x > 3e6 && at.y > 5e6, "{at}");
    let (own, of_lens) = (own_eyes(at)[0], shapes(at).remove(0));
    let sprite = LensSprite { own: Some(own), resolution: Some(RESOLUTION), ..LensSprite::default() };
    let saved_file = folder.file("far.exr");
    let camera = cameras(at)[0];
    let first = scene(camera, vec![painting(&of_lens, Some(sprite))]);
    let code = save(&mut studio, &first, &saved_file);
    let seen = view(own.camera, own.size(RESOLUTION));
    let step = |d: f64| code.quantum_m(d.max(code.near_m));
    let expected = Expected::of(seen, &of_lens, &step);
    let again = scene(camera, vec![painting(&saved(&saved_file), None)]);
    for scene in [first, again] {
        let (counts, _) = compare("far away", &drawn(&mut studio, &scene), camera, &expected);
        assert!(counts[0] > 300 && counts[1] > 20 && counts[3] > 300, "{counts:?}");
    }
}

#[test]
fn sprites_move_with_what_their_lens_is_attached_to() {
    let folder = Folder::new("moving-sprites");
    let mut studio = synthetic(40);
    let at = house(&studio);
    let camera = cameras(at)[0];
    let name = "anchor";
    let poi = |at: DVec3| veduta::scene::Poi { name: name.into(), place: veduta::scene::PoiPlace::At(at) };
    let (own, of_lens) = (own_eyes(DVec3::ZERO)[0], shapes(DVec3::ZERO).remove(0));
    let sprite = LensSprite { own: Some(own), resolution: Some(RESOLUTION), ..LensSprite::default() };
    let attached = |lens: Lens, at: DVec3| Scene {
        pois: vec![poi(at)],
        ..scene(camera, vec![Lens { placement: Placement::Poi(name.into()), ..lens }])
    };
    let file = folder.file("s.exr");
    // Saved where the lens' own coordinates are the world's.
    save(
        &mut studio,
        &attached(painting(&shapes(at)[0], Some(LensSprite { own: Some(own_eyes(at)[0]), ..sprite })), DVec3::ZERO),
        &file,
    );
    for (lens, by) in [(painting(&of_lens, Some(sprite)), at), (painting(&saved(&file), None), DVec3::ZERO)] {
        for moved in [DVec3::ZERO, DVec3::new(14.0, -9.0, 3.0)] {
            let own = own_eyes(at + moved)[0];
            let seen = view(own.camera, own.size(RESOLUTION));
            let expected = Expected::of(seen, &shapes(at + moved)[0], &|_| 1e-3);
            let picture = drawn(&mut studio, &attached(lens.clone(), by + moved));
            compare("attached", &picture, camera, &expected);
        }
    }
}

#[test]
fn own_sprites_are_made_once() {
    let folder = Folder::new("kept-sprites");
    let mut studio = synthetic(40);
    let at = house(&studio);
    let (own, of_lens) = (own_eyes(at)[0], shapes(at).remove(2));
    let sprite = LensSprite { own: Some(own), resolution: Some(RESOLUTION), ..LensSprite::default() };
    let mut first = scene(cameras(at)[0], vec![painting(&of_lens, Some(sprite))]);
    let mut makes = |scene: &Scene| {
        let picture = studio.render(scene, &Request { statistics: true, ..request(Backend::Specialised) });
        let passes = picture.expect("a picture").statistics.passes;
        passes.iter().any(|pass| pass.name == "stored depth sprites")
    };
    assert!(makes(&first), "it is not there yet");
    first.camera = Some(cameras(at)[1]);
    assert!(!makes(&first), "the picture's eye is not that of the sprite");
    first.lenses[0].effects[0].parameters.insert("opacity".into(), Parameter::Number(0.5));
    assert!(!makes(&first), "what a lens does is not what it is");
    first.lenses[0].shapes = shapes(at + DVec3::X).remove(2);
    assert!(makes(&first), "its shape moved");
    first.lenses[0].sprite = Some(LensSprite { own: Some(own_eyes(at)[1]), ..sprite });
    assert!(makes(&first), "its eye moved");
    assert!(!makes(&first));
    // What moves within the same bounds is another shape, too.
    let ball = |by: f64, radius: f64| Region::from(Shape::Sphere { center: at + DVec3::X * by, radius });
    first.lenses[0].shapes = vec![ball(0.0, 20.0), ball(3.0, 5.0)];
    assert!(makes(&first) && !makes(&first));
    first.lenses[0].shapes[1] = ball(4.0, 5.0);
    assert!(makes(&first), "a part of it moved");
    // Rays with more intervals than layers are told of, also where it is there already.
    let one_layer = LensSprite { own: Some(own), resolution: Some(RESOLUTION), layers: 1, ..LensSprite::default() };
    let both = scene(cameras(at)[0], vec![painting(&shapes(at)[3], Some(one_layer))]);
    let mut told = || {
        let picture = studio::picture(&mut studio, &both, SIZE).statistics;
        let count = picture.warnings.iter().find(|w| w["code"] == "sprite-layers").and_then(|w| w["count"].as_u64());
        (picture.passes.iter().any(|pass| pass.name == "stored depth sprites"), count)
    };
    let (first_time, again) = (told(), told());
    assert!(first_time.0 && first_time.1 > Some(20), "{first_time:?}");
    assert_eq!(again, (false, first_time.1));
    // And one of a file is uploaded once.
    let file = folder.file("s.exr");
    save(&mut studio, &first, &file);
    let mut again = scene(cameras(at)[0], vec![painting(&saved(&file), None)]);
    let mut uploads = |scene: &Scene| {
        let before = (studio.renderer.gpu.uploads(), studio.renderer.gpu.allocations());
        studio.redraw(scene, SIZE).expect("a frame");
        (studio.renderer.gpu.uploads() - before.0, studio.renderer.gpu.allocations() - before.1)
    };
    uploads(&again);
    assert_eq!(uploads(&again), (0, 0), "an equal frame");
    again.lenses[0].sprite = Some(LensSprite { format: Format::Unorm16, ..LensSprite::default() });
    assert!(uploads(&again).0 > 0, "it is stored in another way");
    assert_eq!(uploads(&again), (0, 0), "an equal frame");
}

/// Pixels of two pictures that differ.
fn apart(a: &Picture, b: &Picture) -> usize {
    a.rgba.iter().zip(&b.rgba).filter(|(a, b)| a != b).count()
}

#[test]
fn erasers_take_shadows_along_and_both_back_ends_agree() {
    let folder = Folder::new("erasing-sprites");
    let mut studio = synthetic(60);
    let at = house(&studio);
    let camera = cameras(at)[0];
    let ball = [Region::from(Shape::Sphere { center: at, radius: 28.0 })];
    let with = |lenses: Vec<Lens>| Scene { sun: Sun::default(), ..scene(camera, lenses) };
    let own = OwnEye { camera: orthographic(at + DVec3::Z * 90.0, at, 70.0), aspect: 1.0 };
    let fine = LensSprite { own: Some(own), resolution: Some(1024), ..LensSprite::default() };
    let file = folder.file("s.exr");
    save(&mut studio, &with(vec![Lens { sprite: Some(fine), ..lens("s", ball.clone(), "eraser") }]), &file);
    let nothing = drawn(&mut studio, &with(vec![]));
    let analytic = drawn(&mut studio, &with(vec![lens("s", ball.clone(), "eraser")]));
    let changed = apart(&nothing, &analytic);
    assert!(changed > 500, "{changed}");
    for lens in [Lens { sprite: Some(fine), ..lens("s", ball, "eraser") }, lens("s", saved(&file), "eraser")] {
        let scene = with(vec![lens]);
        let picture = drawn(&mut studio, &scene);
        let wrong = apart(&picture, &analytic);
        assert!(wrong * 20 < changed, "{wrong} of {changed}");
        let uber = studio.render(&scene, &request(Backend::Uber)).expect("a picture");
        assert_eq!(apart(&picture, &uber), 0);
    }
    // What a lens takes away, from where the picture does not show it: the shadow alone goes.
    let aside = Camera::looking(at + DVec3::new(60.0, 90.0, 3.0), at + DVec3::new(120.0, 90.0, 0.0), 0.9);
    let far = |lenses: Vec<Lens>| Scene { camera: Some(aside), ..with(lenses) };
    let pictures = [far(vec![]), far(vec![lens("s", saved(&file), "eraser")])].map(|scene| drawn(&mut studio, &scene));
    let analytic = drawn(&mut studio, &far(vec![lens("s", [Shape::Sphere { center: at, radius: 28.0 }], "eraser")]));
    let (changed, wrong) = (apart(&pictures[0], &analytic), apart(&pictures[1], &analytic));
    assert!(wrong * 10 <= changed, "{wrong} of {changed}");
}

#[test]
fn bodies_of_saved_sprites_are_those_of_what_was_saved() {
    let folder = Folder::new("bodies-of-sprites");
    let mut studio = synthetic(20);
    let at = house(&studio) + DVec3::Z * 25.0;
    let ball = [Region::from(Shape::Sphere { center: at, radius: 24.0 })];
    let own = OwnEye { camera: Camera::looking(at + DVec3::new(-70.0, -60.0, 40.0), at, 0.7), aspect: 1.0 };
    let sprite = LensSprite { own: Some(own), resolution: Some(512), ..LensSprite::default() };
    let file = folder.file("s.exr");
    save(&mut studio, &scene(cameras(at)[0], vec![painting(&ball, Some(sprite))]), &file);
    let cameras = [cameras(at)[0], cameras(at)[1], Camera::looking(at + DVec3::new(80.0, 60.0, -10.0), at, 0.8)];
    for (look, camera) in cameras.into_iter().enumerate() {
        // The bodies take turns; in a thorough run each is seen by every camera.
        let bodies = [LensBody::Outline, LensBody::Shell].into_iter().enumerate();
        for (_, body) in bodies.filter(|(i, _)| studio::is_tried(i + look, 2)) {
            let mut of = |shapes: &[Region], sprite| {
                let lens = Lens { sprite, body, effects: vec![], ..lens("s", shapes.to_vec(), "sepia") };
                drawn(&mut studio, &scene(camera, vec![lens]))
            };
            let plain = of(&[Shape::Sphere { center: at, radius: 0.0 }.into()], None);
            let [analytic, own, saved] = [of(&ball, None), of(&ball, Some(sprite)), of(&saved(&file), None)];
            let painted = |p: &Picture| -> Vec<[i32; 2]> {
                let changed = (0..p.rgba.len()).filter(|&i| p.rgba[i] != plain.rgba[i]);
                changed.map(|i| [i as i32 % SIZE[0] as i32, i as i32 / SIZE[0] as i32]).collect()
            };
            let right = painted(&analytic);
            assert!(right.len() > 300, "{}", right.len());
            for found in [painted(&own), painted(&saved)] {
                let share = found.len() as f64 / right.len() as f64;
                assert!((0.8..1.25).contains(&share), "{body:?} from {}: {share}", camera.eye);
                // Texels of its own eye are steps along the silhouette.
                let far = |from: &[[i32; 2]], to: &[[i32; 2]]| {
                    let is_near = |p: &[i32; 2], q: &[i32; 2]| (0..2).all(|i| (p[i] - q[i]).abs() <= 3);
                    from.iter().filter(|p| !to.iter().any(|q| is_near(p, q))).count()
                };
                let (a, b) = (far(&found, &right), far(&right, &found));
                assert!(a + b <= right.len() / 50, "{body:?} from {}: {a} and {b} of {}", camera.eye, right.len());
            }
        }
    }
}

#[test]
fn statistics_count_what_the_texels_meet() {
    let folder = Folder::new("counted-sprites");
    let mut studio = synthetic(120);
    let at = house(&studio);
    let ball = |radius: f64| [Region::from(Shape::Sphere { center: at, radius })];
    let file = folder.file("s.exr");
    let sprite = LensSprite { own: Some(own_eyes(at)[0]), resolution: Some(512), ..LensSprite::default() };
    save(&mut studio, &scene(cameras(at)[0], vec![painting(&ball(45.0), Some(sprite))]), &file);
    let mut met = |shapes: &[Region]| {
        let scene = scene(cameras(at)[0], vec![lens("s", shapes.to_vec(), "sepia")]);
        studio::picture(&mut studio, &scene, SIZE).statistics.lenses[0].clone()
    };
    let [less, found, more] = [met(&ball(44.0)), met(&saved(&file)), met(&ball(46.0))];
    assert!(less.objects <= found.objects && found.objects <= more.objects, "{less:?} {found:?} {more:?}");
    assert!(found.objects > 3, "{found:?}");
    let classified = |l: &veduta::render::stats::LensFigures| {
        let c = &l.classified;
        [c.front, c.inside, c.behind, c.rest].map(|n| n.expect("a count"))
    };
    assert_eq!(classified(&found).iter().sum::<u64>(), u64::from(SIZE[0] * SIZE[1]));
    assert!(classified(&found).iter().all(|n| *n > 0), "{found:?}");
}

#[test]
fn wrong_files_are_told_in_one_line() {
    let folder = Folder::new("wrong-sprites");
    let mut studio = synthetic(20);
    let at = house(&studio);
    let camera = cameras(at)[0];
    let of_lens = shapes(at).remove(0);
    let right = folder.file("right.exr");
    let sprite = LensSprite { own: Some(own_eyes(at)[0]), resolution: Some(64), ..LensSprite::default() };
    let first = scene(camera, vec![painting(&of_lens, Some(sprite))]);
    save(&mut studio, &first, &right);
    let whole = std::fs::read(&right).expect("a file");
    let depth = folder.file("depth.exr");
    let band = veduta::render::bands::Band { size: [2, 2], depth: Some(vec![1.0; 4]), ..Default::default() };
    let mut aov = AovFile::new(&depth, Aov::Depth, [2, 2], &Default::default()).expect("an AOV");
    aov.take(&band).and_then(|()| aov.finish()).expect("an AOV");
    std::fs::write(folder.file("text.exr"), "no picture").expect("a file");
    std::fs::write(folder.file("torn.exr"), &whole[..whole.len() / 2]).expect("a file");
    let good = studio.sprite_of(&first, SIZE, 0).expect("a sprite");
    let put = |name: &str, change: &dyn Fn(&mut veduta::lens::SpriteVolume)| {
        let mut sprite = good.clone();
        change(&mut sprite);
        std::fs::write(folder.file(name), sprite_file::bytes(&sprite).expect("bytes")).expect("a file");
    };
    let inside = good.ends.iter().position(|ends| ends[1] > 0.0).expect("an interval");
    put("nan.exr", &|s| s.ends[inside][0] = f32::NAN);
    put("crossed.exr", &|s| s.ends[inside].swap(0, 1));
    put("elsewhere.exr", &|s| s.crs = Some("EPSG:25832".into()));
    let crs = studio.model.crs.clone();
    let mut message = |focus: Region| {
        let scene = scene(camera, vec![lens("s", [focus], "sepia")]);
        let error = studio.redraw(&scene, SIZE).expect_err("it is wrong").to_string();
        assert!(!error.contains('\n'), "{error}");
        error
    };
    let mut cases = vec![
        ("none.exr", "cannot be read: No such file or directory"),
        ("", "is a folder; a file that `veduta render --sprite` wrote would be right"),
        ("text.exr", "is no OpenEXR file that can be read ("),
        ("torn.exr", "is no OpenEXR file that can be read ("),
        ("depth.exr", "is no depth sprite: the attribute veduta.sprite is missing"),
        ("nan.exr", "is not a number; a distance in metres"),
        ("crossed.exr", ", beyond its end at "),
    ];
    if crs.is_some() {
        cases.push(("elsewhere.exr", "has coordinates of EPSG:25832, the city those of "));
    }
    for (name, expected) in cases {
        let file = folder.file(name);
        let found = message(Region::Sprite { file: file.clone() });
        assert!(found.starts_with("[lens.0] shape.file: "), "{found}");
        assert!(found.contains(&*file.to_string_lossy()) && found.contains(expected), "{found}: not {expected}");
    }
    let part = Region::Combined {
        how: veduta::geom::combination::Operation::Union,
        parts: vec![of_lens[0].clone(), Region::Sprite { file: right.clone() }],
    };
    let found = message(part);
    assert!(found.starts_with("[lens.0] shape.shapes.1.kind: a depth sprite is no part of a combination"), "{found}");
    // And what cannot be saved; an own eye sees what the picture does not.
    let behind = Camera::looking(camera.eye, camera.eye * 2.0 - at, 0.5);
    let unseen = Scene {
        camera: Some(behind),
        ..scene(camera, vec![Lens { sprite: Some(sprite), ..lens("s", of_lens.clone(), "sepia") }])
    };
    assert_eq!(studio.sprite_of(&unseen, SIZE, 0).expect("a sprite"), good);
    let mut refused =
        |lens: Lens| studio.sprite_of(&scene(camera, vec![lens]), SIZE, 0).expect_err("no sprite").to_string();
    let turned = OwnEye { camera: Camera::looking(at + 90.0, at + 180.0, 0.5), aspect: 1.0 };
    let blind = LensSprite { own: Some(turned), ..sprite };
    let empty = refused(Lens { sprite: Some(blind), ..lens("s", of_lens.clone(), "sepia") });
    assert!(empty.starts_with("[lens.0] has an empty sprite: nothing of its shapes is in the frame"), "{empty}");
    let large =
        studio.sprite_of(&scene(camera, vec![painting(&of_lens, None)]), [5_000, 10], 0).expect_err("no sprite");
    assert!(
        large.to_string().contains("its sprite has the picture's 5000x10 pixels; at most 4096 on a side"),
        "{large}"
    );
    let mut refused =
        |lens: Lens| studio.sprite_of(&scene(camera, vec![lens]), SIZE, 0).expect_err("no sprite").to_string();
    let away = refused(lens("s", [Shape::Sphere { center: camera.eye * 2.0 - at, radius: 1.0 }], "sepia"));
    assert!(away.starts_with("[lens.0] has no sprite: it is not in the picture"), "{away}");
    let off = refused(Lens { enabled: false, ..lens("s", of_lens, "sepia") });
    assert!(off.starts_with("[lens.0] is not enabled"), "{off}");
}

/// The command line: saved, and used in a scene beside it.
#[test]
fn render_saves_sprites_that_scenes_use() {
    let folder = Folder::new("command-sprites");
    let head = "veduta = 1\n[city]\nfiles = [\"builtin:square\"]\n[camera]\neye = [0, -80, 30]\ntarget = [0, 0, 5]\n";
    let effects = "effects = [\"invert\"]\nbody = \"none\"\n";
    let shape = "shape = { kind = \"box\", center = [0, 0, 8], size = [50, 30, 30] }";
    let first = format!("{head}[[lens]]\nname = \"the hall\"\n{shape}\n{effects}");
    let second = format!("{head}[[lens]]\nshape = {{ kind = \"sprite\", file = \"hall.exr\" }}\n{effects}");
    std::fs::write(folder.file("first.toml"), first).expect("a scene");
    std::fs::write(folder.file("second.toml"), second).expect("a scene");
    let run = |scene: &str, more: &[&str]| {
        let output = crate::program()
            .current_dir(&folder.0)
            .args(["render", scene, "--size", "96x64", "-o"])
            .arg(format!("{scene}.png"))
            .args(more)
            .output()
            .expect("it runs");
        (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
    };
    let (code, told) = run("first.toml", &["--sprite", "the hall=hall.exr"]);
    assert_eq!(code, Some(0), "{told}");
    let (code, told) = run("second.toml", &[]);
    assert_eq!(code, Some(0), "{told}");
    let pixels = |name: &str| image::open(folder.file(name)).expect("a picture").to_rgb8().into_raw();
    let [a, b] = ["first.toml.png", "second.toml.png"].map(pixels);
    let apart = a.chunks(3).zip(b.chunks(3)).filter(|(a, b)| a != b).count();
    // Walls that lie in the faces of the box may be on either side of them by its sprite.
    assert!(apart < 60, "{apart} pixels differ");
    let once = std::fs::read(folder.file("hall.exr")).expect("the sprite");
    let (code, _) = run("first.toml", &["--sprite", "0=hall.exr"]);
    assert!(code == Some(0) && once == std::fs::read(folder.file("hall.exr")).expect("the sprite"), "other bytes");
    for (more, expected) in [
        (["--sprite", "hal=a.exr"], "the scene has no lens \"hal\""),
        (["--sprite", "the hall=a.png"], "sprites are OpenEXR; .exr would be right"),
        (["--sprite", "the hall"], "LENS=FILE.exr would be right"),
    ] {
        let (code, told) = run("first.toml", &more);
        assert!(code == Some(2) && told.contains(expected), "{code:?}: {told}");
    }
    assert!(!folder.file("a.exr").exists());
    let bordered =
        format!("{head}[[lens]]\nshape = {{ kind = \"sprite\", file = \"hall.exr\" }}\nborder = {{ width = 2 }}\n");
    std::fs::write(folder.file("bordered.toml"), bordered).expect("a scene");
    let (code, told) = run("bordered.toml", &[]);
    assert!(code == Some(1) && told.contains("border: is given together with a shape of kind \"sprite\""), "{told}");
}
