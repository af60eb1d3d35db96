//! Lines that effects draw: where they are, against edges projected in f64; who colours, covers and hides them.

use crate::studio::*;
use glam::{DVec2, DVec3};
use veduta::{
    geom::Shape,
    lens::{Class, EffectUse, Lens, Parameter},
    render::{
        frame::Backend,
        picture::{Aovs, Picture, Request, Studio},
    },
    scene::Scene,
    view::{Camera, View},
};

const SIZE: [u32; 2] = [200, 150];
const AT: DVec3 = DVec3::new(5.0, 5.0, 5.0);
const WIDTH: f64 = 2.0;
/// Where a figure says no dots per inch, and is no larger than 1280 × 720.
const POINTS_PER_PX: f64 = 0.75;

/// The cube of `citydata`, 10 m wide, its lowest corner in the origin.
fn cube() -> Studio {
    studio(&[citydata("cube.city.json")])
}

fn camera() -> Camera {
    Camera::looking(DVec3::new(-13.0, -19.0, 17.0), AT, 0.8)
}

fn around(radius: f64) -> Shape {
    Shape::Sphere { center: AT, radius }
}

/// Red lines.
fn drawing(effect: &str) -> EffectUse {
    let parameters = [
        ("line_color".to_owned(), Parameter::Text("#ff0000".into())),
        ("line_width".to_owned(), Parameter::Number(POINTS_PER_PX * WIDTH)),
    ];
    EffectUse { parameters: parameters.into(), ..used(effect) }
}

fn with(name: &str, shape: Shape, effects: Vec<EffectUse>) -> Lens {
    Lens { effects, ..lens(name, vec![shape], "sepia") }
}

fn draw(studio: &mut Studio, lenses: Vec<Lens>) -> Picture {
    picture(studio, &scene(camera(), lenses), SIZE)
}

/// The ends of the cube's edges.
fn edges() -> Vec<[DVec3; 2]> {
    let corner = |i: usize| 10.0 * DVec3::new((i & 1) as f64, (i >> 1 & 1) as f64, (i >> 2 & 1) as f64);
    let mut all = Vec::new();
    for i in 0..8 {
        all.extend([1, 2, 4].into_iter().filter(|bit| i & bit == 0).map(|bit| [corner(i), corner(i | bit)]));
    }
    all
}

/// How far a pixel's centre is from the nearest of these edges in the picture.
fn distance_px(view: &View, edges: &[[DVec3; 2]], pixel: DVec2) -> f64 {
    let to = |[a, b]: &[DVec3; 2]| {
        let [a, b] = [*a, *b].map(|p| view.pixel(p).expect("before the eye").truncate());
        let t = ((pixel - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
        (a + t * (b - a)).distance(pixel)
    };
    edges.iter().map(to).fold(f64::INFINITY, f64::min)
}

fn pixels() -> impl Iterator<Item = (usize, DVec2)> {
    let all = (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5)));
    all.enumerate()
}

/// Lines are where these edges are and nowhere else; `below`: the picture without them. Returns how many pixels have all
/// of one.
fn lines_are_at(picture: &Picture, below: &Picture, view: &View, edges: &[[DVec3; 2]], unsure: &[[DVec3; 2]]) -> usize {
    let mut full = 0;
    for (i, pixel) in pixels() {
        if distance_px(view, unsure, pixel) < 2.0 * WIDTH {
            continue;
        }
        let away = distance_px(view, edges, pixel);
        if away > 0.5 * WIDTH + 0.55 {
            assert_eq!(picture.rgba[i], below.rgba[i], "{pixel} is no line: {away} px from the nearest edge");
        } else if away < 0.5 * WIDTH - 0.55 {
            assert_eq!(picture.rgba[i], [255, 0, 0, 255], "{pixel} is on an edge");
            full += 1;
        }
    }
    full
}

#[test]
fn a_wireframe_has_the_edges_of_polygons_and_no_diagonals() {
    let mut studio = cube();
    let view = View::new(camera(), SIZE, &studio.extent()).expect("a view");
    let all = [("keep_terrain".to_owned(), Parameter::Boolean(false))];
    let erased = EffectUse { parameters: all.into(), ..used("eraser") };
    let below = draw(&mut studio, vec![with("l", around(30.0), vec![erased])]);
    let picture = draw(&mut studio, vec![with("l", around(30.0), vec![drawing("wireframe")])]);
    assert!(lines_are_at(&picture, &below, &view, &edges(), &[]) > 200);
    assert_eq!(picture.statistics.handlers, ["wireframe"]);
    let passes: Vec<&str> = picture.statistics.passes.iter().map(|p| p.name.as_str()).collect();
    assert_eq!(passes, ["geometry", "clear lens masks", "lines", "shade"]);
}

#[test]
fn hidden_lines_are_not_drawn() {
    let mut studio = cube();
    let view = View::new(camera(), SIZE, &studio.extent()).expect("a view");
    let without = [
        ("line_width".to_owned(), Parameter::Number(0.25 * POINTS_PER_PX)),
        ("line_color".to_owned(), Parameter::Text("#f7f4ec".into())),
    ];
    let paper = |l: EffectUse| vec![with("l", around(30.0), vec![l])];
    let shading = |mut l: EffectUse| {
        l.parameters.insert("shading".to_owned(), Parameter::Number(0.0));
        l
    };
    let below = draw(&mut studio, paper(shading(EffectUse { parameters: without.into(), ..used("hidden-line") })));
    let picture = draw(&mut studio, paper(shading(drawing("hidden-line"))));
    // The corner farthest from the eye hides its three edges; outlines lie half over the sky, where they have no face.
    let far = DVec3::new(10.0, 10.0, 0.0);
    let seen: Vec<_> = edges().into_iter().filter(|e| !e.contains(&far)).collect();
    let hidden: Vec<_> = edges().into_iter().filter(|e| e.contains(&far)).collect();
    assert_eq!((seen.len(), hidden.len()), (9, 3));
    assert!(lines_are_at(&picture, &below, &view, &seen, &[]) > 150);
    // What is hidden would be seen through: its middle lies on a face.
    let middles: Vec<[DVec3; 2]> = hidden.iter().map(|[a, b]| [a.lerp(*b, 0.4), a.lerp(*b, 0.6)]).collect();
    let on_faces =
        pixels().filter(|(_, p)| distance_px(&view, &middles, *p) < 0.5 && distance_px(&view, &seen, *p) > 4.0);
    assert!(on_faces.map(|(i, _)| assert_eq!(picture.rgba[i], below.rgba[i])).count() > 10);
}

/// What is seen through has the lines of faces that look at the eye, and those alone; their surfaces stay.
#[test]
fn feature_lines_are_of_faces_that_look_at_the_eye() {
    let mut studio = cube();
    let view = View::new(camera(), SIZE, &studio.extent()).expect("a view");
    let clear =
        EffectUse { parameters: [("opacity".to_owned(), Parameter::Number(0.0))].into(), ..used("transparent") };
    let mut own = drawing("feature-lines");
    own.parameters.insert("fades".into(), Parameter::Boolean(false));
    let far = DVec3::new(10.0, 10.0, 0.0);
    let front: Vec<_> = edges().into_iter().filter(|e| !e.contains(&far)).collect();
    for backend in [Backend::Specialised, Backend::Uber] {
        let mut of = |effects: Vec<EffectUse>| {
            let request =
                Request { backend, aovs: Aovs { object_id: true, ..Aovs::default() }, ..Request::plain(SIZE) };

            studio.render(&scene(camera(), vec![with("l", around(30.0), effects)]), &request).expect("a picture")
        };
        let (below, picture) = (of(vec![clear.clone()]), of(vec![clear.clone(), own.clone()]));
        assert!(lines_are_at(&picture, &below, &view, &front, &[]) > 150, "{backend:?}");
        assert_eq!(picture.object_id, below.object_id, "{backend:?}: lines are no surfaces");
        // All edges, where all are asked for.
        own.parameters.insert("faces_front".into(), Parameter::Boolean(false));
        assert!(lines_are_at(&of(vec![clear.clone(), own.clone()]), &below, &view, &edges(), &[]) > 200);
        own.parameters.insert("faces_front".into(), Parameter::Boolean(true));
    }
}

/// Lines of `edges` are on average of samples as wide as they say, on the nearer side of a silhouette.
#[test]
fn edges_are_as_wide_as_they_say() {
    let mut studio = cube();
    // Straight from the south: the upper side of the cube lies across the picture.
    let eye = orthographic(AT - 40.0 * DVec3::Y, AT, 15.0);
    for px in [0.5, 1.0, 1.5, 3.0, 6.0] {
        let parameters = [
            ("color".to_owned(), Parameter::Text("#ff0000".into())),
            ("strength".to_owned(), Parameter::Number(1.0)),
            ("width".to_owned(), Parameter::Number(POINTS_PER_PX * px)),
        ];
        let black = EffectUse { parameters: [("amount".to_owned(), Parameter::Number(1.0))].into(), ..used("darken") };
        let lines = EffectUse { parameters: parameters.into(), ..used("edges") };
        let mut asked = scene(eye, vec![]);
        asked.style.effects = vec![black, lines];
        let picture = studio.render(&asked, &Request { samples: 64, ..Request::plain(SIZE) }).expect("a picture");
        // From the sky to the middle of the cube.
        let red = |y: u32| {
            let [r, g, b, _] = picture.rgba[(y * SIZE[0] + SIZE[0] / 2) as usize].map(f64::from);
            if g + b < 1.0 { crate::light::decoded([r / 255.0; 3])[0] } else { 0.0 }
        };
        let rows: f64 = (0..SIZE[1] / 2).map(red).sum();
        println!("{px} px: {rows}");
        // The row that the silhouette lies in is half sky.
        assert!((rows - px).abs() < 0.6 + 0.05 * px, "{px} px are {rows}");
    }
}

#[test]
fn a_line_is_in_a_lens_by_its_own_depth() {
    let mut studio = cube();
    let view = View::new(camera(), SIZE, &studio.extent()).expect("a view");
    // The lens holds the lower half of the cube, to the nearest millimetre.
    let half = Shape::Box {
        center: DVec3::new(5.0, 5.0, 0.0),
        size: DVec3::new(12.0, 12.0, 10.0),
        rotation: glam::DQuat::IDENTITY,
    };
    let erased = with("l", half.clone(), vec![used("eraser")]);
    let below = draw(&mut studio, vec![erased]);
    let picture = draw(&mut studio, vec![with("l", half, vec![drawing("wireframe")])]);
    let lower: Vec<[DVec3; 2]> =
        edges().into_iter().filter(|[a, _]| a.z < 5.0).map(|[a, b]| [a, DVec3::new(b.x, b.y, b.z.min(5.0))]).collect();
    // What stands above hides what is behind it: compared where it does not.
    let upper: Vec<[DVec3; 2]> =
        edges().into_iter().map(|[a, b]| [a.with_z(a.z.max(5.0)), b.with_z(b.z.max(5.0))]).collect();
    let front: Vec<[DVec3; 2]> = lower.iter().copied().filter(|[a, b]| a.z == 0.0 && b.z == 0.0).collect();
    assert!(lower.len() == 8 && front.len() == 4);
    for (i, pixel) in pixels() {
        if distance_px(&view, &lower, pixel) > 0.5 * WIDTH + 0.55 {
            assert_eq!(picture.rgba[i], below.rgba[i], "{pixel}: a line outside the lens");
        }
        let (ground, above) = (distance_px(&view, &front, pixel), distance_px(&view, &upper, pixel));
        if ground < 0.4 && above > 3.0 && below.object_id.as_ref().is_some_and(|ids| ids[i] == 0) {
            assert_eq!(picture.rgba[i], [255, 0, 0, 255], "{pixel}: no line at the foot of the cube");
        }
    }
}

#[test]
fn lenses_above_colour_lines_and_erasers_take_them() {
    let mut studio = cube();
    let ball = around(30.0);
    let has = |picture: &Picture, color: [u8; 3]| picture.rgba.iter().filter(|p| p[..3] == color).count();
    let below = |more: Vec<EffectUse>| with("below", around(30.0), more);
    let plain = draw(&mut studio, vec![below(vec![drawing("wireframe")])]);
    let red = has(&plain, [255, 0, 0]);
    assert!(red > 200, "{red}");
    for lenses in [
        vec![below(vec![drawing("wireframe"), used("invert")])],
        vec![below(vec![drawing("wireframe")]), with("above", ball.clone(), vec![used("invert")])],
    ] {
        let inverted = draw(&mut studio, lenses);
        assert_eq!((has(&inverted, [0, 255, 255]), has(&inverted, [255, 0, 0])), (red, 0));
    }
    // What is below does not touch it.
    let under =
        draw(&mut studio, vec![with("under", ball.clone(), vec![used("invert")]), below(vec![drawing("wireframe")])]);
    assert_eq!(has(&under, [255, 0, 0]), red);
    let drawn = draw(&mut studio, vec![below(vec![drawing("hidden-line")])]);
    assert!(has(&drawn, [255, 0, 0]) > 150);
    for (above, lines) in [("flat", false), ("eraser", false)] {
        let picture = draw(
            &mut studio,
            vec![below(vec![drawing("hidden-line")]), with("above", ball.clone(), vec![used(above)])],
        );
        assert_eq!(has(&picture, [255, 0, 0]) > 0, lines, "{above}");
    }
    let erased =
        draw(&mut studio, vec![with("first", ball.clone(), vec![used("eraser")]), below(vec![drawing("wireframe")])]);
    assert_eq!(has(&erased, [255, 0, 0]), 0);
}

#[test]
fn an_edge_stays_as_long_as_one_of_its_faces_does() {
    let mut studio = studio(&[citydata("semantics.city.json")]);
    let bounds = studio.extent();
    let (at, size) = (bounds.center(), bounds.size().length());
    let camera = Camera::looking(at + DVec3::new(-0.9, -1.1, 0.5) * size, at, 0.8);
    let part = |part: &str| {
        let parameters = [("part".to_owned(), Parameter::Text(part.into()))];
        with(
            part,
            Shape::Sphere { center: at, radius: size },
            vec![EffectUse { parameters: parameters.into(), ..used("eraser") }],
        )
    };
    let paper = || with("paper", Shape::Sphere { center: at, radius: size }, vec![drawing("hidden-line")]);
    let mut red = |lenses: Vec<Lens>| {
        let picture = picture(&mut studio, &scene(camera, lenses), SIZE);
        picture.rgba.iter().map(|p| p[..3] == [255, 0, 0]).collect::<Vec<bool>>()
    };
    let all = red(vec![paper()]);
    let without_roofs = red(vec![paper(), part("roofs")]);
    let kept = (0..all.len()).filter(|&i| all[i] && without_roofs[i]).count();
    let count = all.iter().filter(|r| **r).count();
    // The eaves are edges of walls too; what a gone roof hid may be seen besides.
    assert!(count > 100 && kept * 10 > count * 6, "{kept} of {count}");
    let nothing = red(vec![
        paper(),
        part("roofs"),
        part("walls"),
        with("rest", Shape::Sphere { center: at, radius: size }, vec![used("eraser")]),
    ]);
    assert!(!nothing.contains(&true));
}

#[test]
fn lines_are_the_same_on_both_back_ends_and_everywhere_in_the_context() {
    let mut studio = synthetic(30);
    let number = studio.geometries[studio.geometries.len() / 2];
    let at = studio.model.geometries[number as usize].bounds.center();
    let camera = Camera::looking(at + DVec3::new(60.0, -80.0, 55.0), at, 0.8);
    let ball = Shape::Sphere { center: at, radius: 45.0 };
    let roofs =
        EffectUse { parameters: [("part".to_owned(), Parameter::Text("roofs".into()))].into(), ..used("eraser") };
    let lenses = vec![
        with("wire", ball.clone(), vec![drawing("wireframe"), used("sepia")]),
        with(
            "paper",
            Shape::Box { center: at + DVec3::X * 40.0, size: DVec3::splat(60.0), rotation: Default::default() },
            vec![EffectUse { class: Class::Inside, weight: Some(0.6), ..drawing("hidden-line") }],
        ),
        with("roofs", ball, vec![roofs]),
    ];
    let mut scene: Scene = scene(camera, lenses);
    for context in [vec![], vec![used("hidden-line"), used("posterise")], vec![used("wireframe")]] {
        scene.style.effects = context;
        let mut draw = |backend: Backend| {
            let request =
                Request { samples: 3, transparent: true, aovs: ALL, statistics: true, backend, ..Request::plain(SIZE) };
            studio.render(&scene, &request).expect("a picture")
        };
        let (a, b) = (draw(Backend::Specialised), draw(Backend::Uber));
        assert!(a.rgba == b.rgba, "{:?}", scene.style.effects);
        assert!(a.object_id == b.object_id && a.lens_mask == b.lens_mask);
        assert_eq!(a.statistics.handlers, b.statistics.handlers);
    }
}

#[test]
fn who_draws_no_lines_has_no_edges() {
    let mut studio = cube();
    let far = Shape::Sphere { center: AT + DVec3::Z * 900.0, radius: 3.0 };
    let mut disabled = with("l", around(30.0), vec![drawing("wireframe")]);
    disabled.enabled = false;
    for lenses in [vec![], vec![with("l", around(30.0), vec![used("edges")])], vec![disabled]] {
        let picture = draw(&mut studio, lenses);
        assert!(!studio.renderer.has_edges() && picture.statistics.passes.iter().all(|p| p.name != "lines"));
    }
    let away = draw(&mut studio, vec![with("l", far, vec![drawing("wireframe")])]);
    assert!(away.statistics.passes.iter().all(|p| p.name != "lines"));
    draw(&mut studio, vec![with("l", around(30.0), vec![drawing("wireframe")])]);
    let moved = draw(&mut studio, vec![with("l", around(25.0), vec![drawing("wireframe")])]);
    assert_eq!(moved.statistics.pipelines.compiled, 0);
}

#[test]
fn a_lens_out_of_view_leaves_no_lines_behind() {
    let mut studio = cube();
    let at = |x: f64| {
        let shape = Shape::Sphere { center: AT + DVec3::new(x, 0.0, 0.0), radius: 6.0 };
        scene(camera(), vec![Lens { effects: vec![drawing("wireframe")], ..lens("l", vec![shape], "eraser") }])
    };
    for backend in [Backend::Uber, Backend::Specialised] {
        let aovs = Aovs::default();
        let request = Request { aovs, backend, ..Request::plain(SIZE) };
        let mut drawn = |scene: &Scene| studio.render(scene, &request).expect("a picture").rgba;
        let plain = drawn(&scene(camera(), vec![]));
        // Never in view before, then in view, and gone again.
        assert_eq!(drawn(&at(-900.0)), plain, "{backend:?}");
        assert_ne!(drawn(&at(0.0)), plain, "{backend:?}");
        assert_eq!(drawn(&at(-900.0)), plain, "{backend:?}");
    }
}
