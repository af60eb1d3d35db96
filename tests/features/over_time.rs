//! Occluders over time: a fade is a pattern of two pictures, on every rendering and both back ends; what was before does not
//! matter where nobody let time pass. And shadows of what lenses take away, which go or stay.

use crate::studio::*;
use glam::DVec3;
use veduta::{
    lens::{Lens, Occluders, Region, Rendering, chosen::Choice, dither::dither, kind::Occlusion},
    render::{
        frame::Backend,
        picture::{Picture, Request, Studio},
    },
    scene::{Poi, PoiPlace, Scene},
    view::Camera,
    visibility::{Pace, Test},
};

const SIZE: [u32; 2] = [160, 100];

/// The market square from the south, a place in it looked for; nobody hides it but those of `forced`.
fn square(render: &str, forced: &[String], is_lit: bool) -> Scene {
    let of = Occluders {
        pois: vec!["it".into()],
        test: Test::Spherical { radius: 0.0, reference: Default::default() },
        force: (!forced.is_empty()).then(|| Choice { ids: forced.to_vec(), ..Choice::default() }),
        ..Occluders::default()
    };
    let lens = Lens {
        kind: Occlusion { rendering: Rendering::of_word(render).unwrap(), content: None }.into(),
        effects: vec![],
        ..lens("occluders", [Region::Occluders(of)], "sepia")
    };
    let camera = Camera::looking(DVec3::new(-75.0, -110.0, 62.0), DVec3::new(8.0, 12.0, 4.0), 0.8);
    let mut scene = scene(camera, vec![lens]);
    scene.pois = vec![Poi { name: "it".into(), place: PoiPlace::At(DVec3::new(8.0, 12.0, 4.0)) }];
    scene.sun.shadows = is_lit;
    scene
}

fn of_square() -> Studio {
    studio(&[citydata("square.city.json")])
}

/// Buildings of the city: what is forced to hide something.
fn some_ids(studio: &Studio, count: usize) -> Vec<String> {
    let objects = studio.model.objects.iter().filter(|o| o.parents.is_empty() && !o.class.is_ground());
    objects.map(|o| o.id.to_string()).step_by(3).take(count).collect()
}

fn drawn(studio: &mut Studio, scene: &Scene, backend: Backend, samples: u32) -> Picture {
    let request = Request { samples, aovs: ALL, backend, ..Request::plain(SIZE) };
    studio.render(scene, &request).expect("a picture")
}

fn with_fade(mut scene: Scene, fade_s: f64) -> Scene {
    let Region::Occluders(of) = &mut scene.lenses[0].shapes[0] else { panic!("occluders") };
    of.pace = Pace { fade_s };
    scene
}

#[test]
fn a_fade_is_at_each_pixel_one_of_two_pictures_whatever_is_drawn() {
    let mut studio = of_square();
    let ids = some_ids(&studio, 8);
    // None of them stands before the place, where alone a cut-away cuts.
    for (i, render) in Rendering::words().filter(|word| *word != "cut-away").enumerate() {
        // The back ends take turns; in a thorough run each draws all.
        let both = [Backend::Specialised, Backend::Uber].into_iter().enumerate();
        for (_, backend) in both.filter(|(j, _)| is_tried(i + j, 2)) {
            let before = with_fade(square(render, &[], false), 0.5);
            let after = with_fade(square(render, &ids, false), 0.5);
            let [plain, wholly] = [&before, &after].map(|scene| drawn(&mut studio, scene, backend, 1));
            assert!(plain.rgba != wholly.rgba, "{render}: nothing is done");
            // Long enough for what faded before to have ended.
            studio.pass(&before, SIZE, 10.0).expect("a moment");
            for (dt, weight) in [(0.125, 0.25), (0.325, 0.9_f32), (0.5, 1.0)] {
                studio.pass(&after, SIZE, dt).expect("a moment");
                let now = drawn(&mut studio, &after, backend, 1);
                let inside = [&now, &wholly].map(|p| bits(p, 0));
                let (mut changed, mut others) = ([0; 2], 0);
                for (i, (x, y)) in (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| (x, y))).enumerate() {
                    let is_there = weight > dither([x, y], 0);
                    let expected = if is_there { &wholly } else { &plain };
                    let ids = |p: &Picture| p.object_id.as_ref().expect("ids")[i];
                    let depths = |p: &Picture| p.depth.as_ref().expect("depths")[i].to_bits();
                    assert_eq!(
                        (ids(&now), depths(&now), inside[0][i]),
                        (ids(expected), depths(expected), is_there && inside[1][i]),
                        "{render}, {backend:?}: pixel {x} {y} at {weight}"
                    );
                    others += usize::from(now.rgba[i] != expected.rgba[i]);
                    changed[usize::from(is_there)] += usize::from(plain.rgba[i] != wholly.rgba[i]);
                }
                assert_eq!(others, 0, "{render}, {backend:?}: pixels of another colour at {weight}");
                // What a screen door takes away are the pixels that come first.
                let is_done = weight == 1.0 || (render == "dither" && weight > 0.7);
                assert!(changed[1] > 20 && is_done == (changed[0] == 0), "{render}: {changed:?} at {weight}");
            }
        }
    }
}

#[test]
fn a_change_of_case_is_at_each_pixel_one_of_two_renderings() {
    let mut studio = of_square();
    let ids = some_ids(&studio, 8);
    let cases = |nearer_m: f64| {
        let case = |word| Rendering::of_word(word).expect("a word").cases.remove(0);
        let mut near = case("flatten");
        near.when.nearer_m = Some(nearer_m);
        let mut scene = with_fade(square("discard", &ids, false), 0.5);
        *scene.lenses[0].kind.rendering_mut().unwrap() = Rendering::of_cases(vec![near, case("x-ray-color")]);
        scene
    };
    let (far, near) = (cases(0.0), cases(1e4));
    for backend in [Backend::Specialised, Backend::Uber] {
        let [before, after] = [&far, &near].map(|scene| drawn(&mut studio, scene, backend, 1));
        studio.pass(&far, SIZE, 10.0).expect("a moment");
        assert!(drawn(&mut studio, &far, backend, 1).rgba == before.rgba, "settled");
        for (scene, dt, share) in [(&near, 0.125, 0.25_f32), (&near, 0.25, 0.75), (&far, 0.125, 0.5), (&near, 0.5, 1.0)]
        {
            studio.pass(scene, SIZE, dt).expect("a moment");
            let now = drawn(&mut studio, scene, backend, 1);
            let mut changed = [0; 2];
            for (i, (x, y)) in (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| (x, y))).enumerate() {
                let is_after = share > dither([x, y], 0);
                let expected = if is_after { &after } else { &before };
                let told = |p: &Picture| (p.rgba[i], p.object_id.as_ref().expect("ids")[i], bits(p, 0)[i]);
                if before.rgba[i] != after.rgba[i] {
                    assert_eq!(told(&now), told(expected), "{backend:?}: pixel {x} {y} at {share}");
                    changed[usize::from(is_after)] += 1;
                }
            }
            assert!(changed[1] > 20 && (changed[0] == 0) == (share == 1.0), "{changed:?} at {share}");
        }
        studio.pass(&square("discard", &[], false), SIZE, 10.0).expect("a moment");
    }
}

#[test]
fn a_case_is_left_beyond_the_margin_only() {
    let mut studio = of_square();
    let with = |studio: &Studio, id: &String, beyond: f64| {
        let ids = std::slice::from_ref(id);
        let mut scene = with_fade(square("flatten", ids, false), 0.0);
        let eye = scene.camera.expect("a camera").eye;
        let object = studio.model.find_object(id).expect("it");
        let mut cases = vec![Rendering::of_word("flatten").expect("a word").cases.remove(0)];
        cases[0].when.nearer_m = Some(studio.model.family_bounds(object).distance_to(eye) + beyond);
        cases.extend(Rendering::of_word("box").expect("a word").cases);
        *scene.lenses[0].kind.rendering_mut().unwrap() = Rendering::of_cases(cases);
        scene
    };
    // One that is seen.
    let found = some_ids(&studio, 40).into_iter().find_map(|id| {
        let [near, far] = [0.5, -0.5].map(|beyond| {
            let scene = with(&studio, &id, beyond);
            drawn(&mut studio, &scene, Backend::default(), 1).rgba
        });
        (near != far).then_some((id, near, far))
    });
    let (id, near, far) = found.expect("a house in the picture");
    let with = |studio: &Studio, beyond: f64| with(studio, &id, beyond);
    // The margin is a metre: it takes effect once the place of the case was left by it, and again where it holds.
    for (beyond, is_near) in [(0.5, true), (-0.5, true), (-0.99, true), (-1.01, false), (-0.5, false), (0.01, true)] {
        let scene = with(&studio, beyond);
        studio.pass(&scene, SIZE, 0.1).expect("a moment");
        let now = drawn(&mut studio, &scene, Backend::default(), 1).rgba;
        assert!(now == if is_near { near.clone() } else { far.clone() }, "at {beyond}");
    }
}

#[test]
fn many_samples_make_a_fade_smooth() {
    let mut studio = of_square();
    let ids = some_ids(&studio, 8);
    let (before, after) = (square("discard", &[], false), square("discard", &ids, false));
    let [plain, wholly] = [&before, &after].map(|scene| drawn(&mut studio, scene, Backend::default(), 16));
    studio.pass(&before, SIZE, 0.0).expect("a moment");
    studio.pass(&after, SIZE, 0.15).expect("a moment");
    let half = drawn(&mut studio, &after, Backend::default(), 16);
    let linear = |byte: u8| (f64::from(byte) / 255.0).powf(2.2);
    let shares: Vec<f64> = (0..half.rgba.len())
        .map(|i| [&plain, &wholly, &half].map(|p| linear(p.rgba[i][0])))
        .filter(|[a, b, _]| (a - b).abs() > 0.1)
        .map(|[a, b, now]| (now - a) / (b - a))
        .collect();
    let mean = shares.iter().sum::<f64>() / shares.len() as f64;
    let near = shares.iter().filter(|share| (*share - 0.5).abs() < 0.13).count();
    // Of 16 samples 7 to 9 are there; where one of both pictures has a silhouette, its samples are not alike.
    assert!(shares.len() > 60 && (mean - 0.5).abs() < 0.02, "{mean} of {}", shares.len());
    assert!(near * 10 > shares.len() * 9, "{near} of {}", shares.len());
}

#[test]
fn without_time_there_is_no_history_and_settled_pictures_are_those_without_it() {
    let mut studio = of_square();
    let ids = some_ids(&studio, 8);
    let (before, after) = (square("flatten", &[], true), square("flatten", &ids, true));
    let settled = drawn(&mut studio, &after, Backend::default(), 2);
    studio.pass(&after, SIZE, 0.1).expect("a moment");
    let first = drawn(&mut studio, &after, Backend::default(), 2);
    assert!(first.rgba == settled.rgba, "it begins settled");
    studio.pass(&before, SIZE, 0.1).expect("a moment");
    let going = drawn(&mut studio, &before, Backend::default(), 2);
    let plain = drawn(&mut of_square(), &before, Backend::default(), 2);
    assert!(going.rgba != plain.rgba && going.rgba != settled.rgba, "it fades");
    assert!(drawn(&mut studio, &after, Backend::default(), 2).rgba == settled.rgba, "of another moment");
    for _ in 0..3 {
        studio.pass(&before, SIZE, 0.1).expect("a moment");
    }
    assert!(drawn(&mut studio, &before, Backend::default(), 2).rgba == plain.rgba, "it ends settled");
    let mut off = before.clone();
    off.lenses[0].enabled = false;
    studio.pass(&off, SIZE, 0.1).expect("a moment");
    studio.pass(&after, SIZE, 0.0).expect("a moment");
    assert!(
        drawn(&mut studio, &after, Backend::default(), 2).rgba == settled.rgba,
        "a lens that was off begins settled"
    );
}

#[test]
fn statistics_say_how_far_each_has_come() {
    let mut studio = of_square();
    let ids = some_ids(&studio, 8);
    let (before, after) = (square("discard", &[], false), square("discard", &ids[..2], false));
    let listed = |studio: &mut Studio, scene: &Scene| {
        let drawn = picture(studio, scene, SIZE);
        let list = drawn.statistics.lenses[0].occluders.clone().expect("occluders");
        list.into_iter().map(|o| (o.id, o.why, o.weight)).collect::<Vec<_>>()
    };
    assert_eq!(listed(&mut studio, &after).iter().map(|o| o.2).collect::<Vec<_>>(), [None, None], "without time");
    studio.pass(&before, SIZE, 0.0).expect("a moment");
    studio.pass(&after, SIZE, 0.075).expect("a moment");
    let forced = |id: &String, weight| (id.clone(), vec!["forced".to_owned()], Some(weight));
    assert_eq!(listed(&mut studio, &after), [forced(&ids[0], 0.25), forced(&ids[1], 0.25)]);
    studio.pass(&before, SIZE, 0.03).expect("a moment");
    let gone = listed(&mut studio, &before);
    assert!(gone.iter().all(|o| o.1.is_empty() && (o.2.expect("a weight") - 0.15).abs() < 1e-9), "{gone:?}");
    assert_eq!(gone.len(), 2);
}

#[test]
fn shadows_of_what_is_taken_away_go_or_stay() {
    let mut studio = of_square();
    let ids = some_ids(&studio, 40);
    for render in ["discard", "flatten", "transparent", "box", "low"] {
        for backend in [Backend::Specialised, Backend::Uber] {
            let plain = drawn(&mut studio, &square(render, &[], true), backend, 1);
            let mut shadowed = |keeps_shadows| {
                let mut scene = square(render, &ids, true);
                scene.lenses[0].keeps_shadows = keeps_shadows;
                drawn(&mut studio, &scene, backend, 1)
            };
            let [gone, kept] = [false, true].map(&mut shadowed);
            assert!(gone.object_id == kept.object_id && gone.depth == kept.depth, "{render}: shadows alone differ");
            // Of what no lens touches: its light is that without the lens, or it is brighter.
            let outside: Vec<usize> = (0..plain.rgba.len())
                .filter(|&i| {
                    let surface = |p: &Picture| {
                        (p.object_id.as_ref().expect("ids")[i], p.depth.as_ref().expect("depths")[i].to_bits())
                    };
                    surface(&plain) == surface(&kept) && surface(&kept).0 > 0
                })
                .collect();
            let changed = |p: &Picture| outside.iter().filter(|&&i| plain.rgba[i] != p.rgba[i]).count();
            // Lines and layers lie over what stays.
            let over = if ["transparent", "box"].contains(&render) { outside.len() / 2 } else { 0 };
            assert!(outside.len() > 700, "{render}: {}", outside.len());
            assert!(changed(&kept) <= over, "{render}, {backend:?}: {} of {}", changed(&kept), outside.len());
            let lit = outside.iter().filter(|&&i| gone.rgba[i] != kept.rgba[i]).count();
            assert!(lit > 20, "{render}, {backend:?}: {lit} pixels differ by their shadows");
        }
    }
}
