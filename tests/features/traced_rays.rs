//! Rays that lenses bend, followed by the processor or by the GPU: the same is seen, and what followed them is told.

use std::path::PathBuf;

use glam::{DVec2, DVec3};
use veduta::{
    geom::Shape,
    lens::{Lens, chosen::Choice, ray::RayLens},
    render::picture::{Picture, Request, Studio},
    scene::{CitySpec, Scene, Style},
    time::{Interval, Moment},
    view::{Camera, Projection},
};

use crate::studio::{
    bent::{all, lens, magnifier, magnify},
    *,
};

const SIZE: [u32; 2] = [160, 112];
/// Pixels of which one may show something else, or the same elsewhere: paths are told in f64 by the processor and in f32 by the GPU, and what that rounds
/// is a longer way along faces that are seen nearly edge on.
const ONE_OF: usize = 10_000;

fn both(studio: &mut Studio, scene: &Scene, samples: u32) -> [Picture; 2] {
    [true, false].map(|traces_rays| {
        studio.renderer.settings.traces_rays = traces_rays;
        let request = Request { aovs: ALL, samples, statistics: true, ..Request::plain(SIZE) };
        studio.render(scene, &request).unwrap_or_else(|error| panic!("{error}"))
    })
}

/// How many pixels of two pictures show different objects, depths or colours.
fn others([one, other]: &[Picture; 2]) -> usize {
    let [a, b] = [one, other].map(|picture| (picture.object_id.as_ref().unwrap(), picture.depth.as_ref().unwrap()));
    let is_near = |x: f32, y: f32| x == y || (x / y - 1.0).abs() < 2e-6;
    let is_like = |x: [u8; 4], y: [u8; 4]| (0..4).all(|c| x[c].abs_diff(y[c]) <= 2);
    let is_other = |i: &usize| {
        let i = *i;
        a.0[i] != b.0[i] || !is_near(a.1[i], b.1[i]) || !is_like(one.rgba[i], other.rgba[i])
    };
    (0..a.0.len()).filter(is_other).count()
}

/// A city, what is shown of it, and from where.
struct Place {
    name: &'static str,
    studio: Studio,
    style: Style,
    at: Option<Moment>,
}

/// What triangles have that rays meet: storeys and windows, planes that faces share, normals and images per corner, cities that move through a city.
fn places(folder: &Folder) -> Vec<Place> {
    let town = Scene {
        city: CitySpec { files: vec![PathBuf::from("builtin:town")], ..CitySpec::default() },
        ..Scene::default()
    };
    let options = veduta::city::synth::SynthOptions { buildings: 30, seed: 3 };
    let (mut city, mut day) = (Vec::new(), Vec::new());
    veduta::city::synth::full::write_cityjson(&options, &mut city, &mut |_| ()).expect("a town");
    veduta::city::synth::full::write_timetable(&options, &mut day).expect("a timetable");
    let files = vec![folder.write("moving.city.json", city)];
    let timetables = vec![folder.write("day.csv", day)];
    let moving = Scene { city: CitySpec { files, timetables, ..CitySpec::default() }, ..Scene::default() };
    let of_files = |name, files: &[&str]| Place {
        name,
        studio: studio(&files.iter().map(|file| citydata(file)).collect::<Vec<_>>()),
        style: Style::default(),
        at: None,
    };
    let styled = Style { facades: true, ..Style::default() };
    let seven = Interval::parse("2025-06-01T08:00:36").expect("a time").begin;
    vec![
        Place { name: "town", studio: of_scene(&town), style: styled, at: None },
        Place { name: "moving", studio: of_scene(&moving), style: Style::default(), at: seven },
        of_files("textures", &["textures.city.json"]),
        of_files("smooth", &["textured.gltf"]),
        of_files("one roof on another", &["roof-on-roof.city.json", "door-in-wall.city.json"]),
    ]
}

fn cameras(studio: &Studio) -> [Camera; 2] {
    let extent = studio.extent();
    let (middle, reach) = (extent.center(), 0.6 * extent.size().length());
    let slanting = Camera::looking(middle + reach * DVec3::new(0.4, -0.8, 0.6), middle, 0.9);
    let height_m = 0.9 * reach;
    [slanting, Camera { projection: Projection::Orthographic { height_m }, ..slanting }]
}

/// Lenses of every kind, at distances that suit a city; and several at once.
fn glasses(reach: f64) -> Vec<Vec<Lens>> {
    let of_size = |m: f64, aside: f64| {
        let center = DVec2::new(0.5 + aside, 0.5 - 0.5 * aside);
        magnifier(RayLens { center, ..magnify(m, 0.5 * reach, 0.5 * reach, 0.4) })
    };
    let mut sets: Vec<Vec<Lens>> = all().into_iter().skip(5).map(|lens| vec![lens]).collect();
    sets.push(vec![of_size(2.5, 0.0)]);
    let named = |name: &str, lens: Lens| Lens { name: name.into(), ..lens };
    let mut three = vec![named("a", of_size(1.7, -0.1)), named("b", of_size(2.2, 0.15)), named("c", all()[5].clone())];
    sets.push(three.clone());
    three[1].kind.ray_mut().expect("a lens that bends rays").radius = 0.2;
    three.push(named("d", all()[8].clone()));
    three[3].kind.ray_mut().expect("a lens that bends rays").radius = 0.12;
    sets.push(three);
    sets
}

#[test]
fn the_processor_sees_what_the_gpu_does() {
    let folder = Folder::new("traced");
    let (mut compared, mut wrong) = (0, 0);
    for (p, mut place) in places(&folder).into_iter().enumerate() {
        for (c, camera) in cameras(&place.studio).into_iter().enumerate() {
            let reach = 0.6 * place.studio.extent().size().length();
            for (g, lenses) in glasses(reach).into_iter().enumerate().filter(|(g, _)| is_tried(p + c + g, 3)) {
                let mut scene = Scene { style: place.style.clone(), ..scene(camera, lenses) };
                scene.moment = place.at;
                let pictures = both(&mut place.studio, &scene, 1);
                let [traced, followed] = pictures.each_ref().map(|picture| picture.statistics.frame.traced);
                assert!(followed.is_none(), "{}: the processor follows none", place.name);
                let rays = traced.unwrap_or_else(|| panic!("{}, {c}, {g}: it follows some", place.name)).rays;
                let off = others(&pictures);
                assert!(off <= 5, "{}, eye {c}, lenses {g}: {off} pixels differ", place.name);
                (compared, wrong) = (compared + rays as usize, wrong + off);
            }
        }
    }
    println!("{wrong} of {compared} pixels differ");
    assert!(compared > 100_000 && wrong * ONE_OF <= compared, "{wrong} of {compared} pixels differ");
}

/// It follows those of the pixels in the lens, up to a pixel beside it, of each sample.
#[test]
fn rays_are_counted_where_they_are_followed() {
    let mut studio = synthetic(20);
    let [camera, _] = cameras(&studio);
    for (radius, samples) in [(0.2, 1), (0.41, 1), (0.3, 4)] {
        let glass = magnifier(RayLens { radius, ..magnify(2.0, 60.0, 60.0, 0.4) });
        let [traced, _] = both(&mut studio, &scene(camera, vec![glass]), samples);
        let within = |by: f64| {
            let r = radius * f64::from(SIZE[1]) + by;
            let at = |i: u32, n: u32| f64::from(i) + 0.5 - 0.5 * f64::from(n);
            let all = (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| at(x, SIZE[0]).hypot(at(y, SIZE[1]))));
            all.filter(|from| *from < r).count() as u64 * u64::from(samples)
        };
        let rays = traced.statistics.frame.traced.expect("it follows some").rays;
        assert!((within(0.3)..=within(1.7)).contains(&rays), "{rays}: {} to {}", within(0.3), within(1.7));
    }
}

/// Where something hides parts of the city, the GPU is asked which of the first hits are there, and follows rays that have others.
#[test]
fn what_is_hidden_is_looked_through_by_both() {
    let mut studio = synthetic(20);
    let [camera, _] = cameras(&studio);
    let middle = studio.extent().center();
    let glass = lens(veduta::lens::kind::Magnifier { ray: magnify(2.0, 60.0, 60.0, 0.4) });
    let around = |radius: f64| [Shape::Sphere { center: middle, radius }];
    let plain = both(&mut studio, &scene(camera, vec![glass.clone()]), 1);
    // Of a house there are four faces at most along a ray, and many houses in the larger one.
    for (radius, effect) in [(60.0, "eraser"), (120.0, "eraser"), (400.0, "eraser"), (90.0, "wireframe")] {
        let hidden = crate::studio::lens("hidden", around(radius), effect);
        let pictures = both(&mut studio, &scene(camera, vec![glass.clone(), hidden]), 1);
        assert!(pictures[0].statistics.frame.traced.is_some(), "{effect}");
        let off = others(&pictures);
        assert!(off <= 1, "{effect} in {radius} m: {off} pixels differ");
        assert!(others(&[pictures[0].clone(), plain[0].clone()]) > 100, "{effect} in {radius} m hides something");
    }
    // Rays of lenses that act on some objects alone are the GPU's, and so are all where it follows them to layers: both are as far, to the bit.
    let ids = studio.model.objects.iter().step_by(3).map(|object| object.id.to_string()).collect();
    let mut choosing = glass.clone();
    choosing.kind.ray_mut().expect("a lens that bends rays").only = Some(Choice { ids, ..Choice::default() });
    let clear = crate::studio::lens("clear", around(90.0), "peel");
    for lenses in [vec![choosing], vec![glass, clear]] {
        let pictures = both(&mut studio, &scene(camera, lenses), 1);
        assert!(pictures[0].statistics.frame.traced.is_none() && pictures[0].rgba == pictures[1].rgba);
    }
}
