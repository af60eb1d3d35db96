//! Bodies of lenses as tinted glass and as a glow.

use crate::studio::*;
use glam::{DQuat, DVec2, DVec3};
use veduta::{
    figure::scene_file::{Options, parse},
    geom::{Aabb, Shape, combination::Operation, shape::FlatFigure},
    lens::{Lens, LensBody, Region, chosen::Choice},
    render::{
        frame::Backend,
        picture::{Picture, Request, Studio},
    },
    scene::{Background, Scene},
    view::{Camera, View},
};

const SIZE: [u32; 2] = [320, 200];
const BACKENDS: [Backend; 2] = [Backend::Specialised, Backend::Uber];

fn draw(studio: &mut Studio, scene: &Scene, backend: Backend) -> Picture {
    let request = Request { aovs: ALL, statistics: true, backend, ..Request::plain(SIZE) };
    studio.render(scene, &request).expect("a picture")
}

fn view_of(camera: Camera) -> View {
    View::new(camera, SIZE, &Aabb { min: DVec3::splat(-2e4), max: DVec3::splat(2e4) }).expect("a view")
}

fn pixels() -> impl Iterator<Item = (usize, u32, u32)> {
    (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| (x, y))).enumerate().map(|(i, (x, y))| (i, x, y))
}

/// A lens that is nothing but a body.
fn body_of(body: LensBody, focus: impl Into<Region>) -> Lens {
    Lens { body, effects: vec![], ..lens("a", [focus], "sepia") }
}

fn difference(a: [u8; 4], b: [u8; 4]) -> u8 {
    (0..3).map(|i| a[i].abs_diff(b[i])).max().unwrap_or(0)
}

#[test]
fn glass_is_where_rays_meet_the_lens_and_nothing_stands_before() {
    let mut studio = synthetic(60);
    let middle = studio.extent().center();
    let eye = middle + DVec3::new(60.0, -110.0, 80.0);
    for (camera, every) in [(Camera::looking(eye, middle, 0.8), 1), (orthographic(eye, middle, 150.0), 3)] {
        let view = view_of(camera);
        let plain = draw(&mut studio, &scene(camera, vec![]), Backend::Specialised);
        let depth = plain.depth.as_ref().expect("depth");
        let shapes = shapes(middle + DVec3::new(0.0, 0.0, 2.0), 26.0).into_iter().enumerate();
        for (i, focus) in shapes.step_by(if is_thorough() { 1 } else { every }) {
            let reference = Reference::of(&focus);
            let scene = scene(camera, vec![body_of(LensBody::Shell, focus)]);
            let glass = draw(&mut studio, &scene, Backend::Specialised);
            // Where the first and the last of the ray are, and how far away nothing is to be told.
            let ends = |x, y| {
                let spans = reference.intervals(&view.pixel_ray(x, y));
                spans.first().zip(spans.last()).map(|((enter, _), (_, exit))| (*enter, *exit))
            };
            let (mut tinted, mut wrong) = (0, 0);
            for (k, x, y) in
                pixels().step_by(7).filter(|(_, x, y)| (2..SIZE[0] - 2).contains(x) && (2..SIZE[1] - 2).contains(y))
            {
                let beside = [(0, 0), (2, 0), (0, 2), (2, 2), (1, 0), (0, 1), (2, 1), (1, 2)]
                    .map(|(dx, dy)| ends(x + dx - 1, y + dy - 1).is_some());
                if beside.contains(&true) != beside.iter().all(|b| *b) {
                    continue; // The line around it.
                }
                let shown = f64::from(depth[k]);
                let seen = ends(x, y).map(|(enter, exit)| [enter, exit]).map(|e| e.map(|t| shown / t - 1.0));
                let is_near = |e: &f64| e.abs() < 1e-3;
                if seen.is_some_and(|ends| ends.iter().any(is_near)) {
                    continue;
                }
                let wanted = seen.is_some_and(|ends| ends[0] > 0.0);
                let is_tinted = difference(glass.rgba[k], plain.rgba[k]) > 0;
                tinted += usize::from(is_tinted);
                // A tint may be the colour that it lies on.
                wrong += usize::from(is_tinted && !wanted) + usize::from(!is_tinted && wanted);
            }
            assert!(tinted > 14 && wrong <= tinted / 100, "shape {i}: {wrong} wrong, {tinted} tinted");
            assert!(glass.object_id == plain.object_id, "bodies are not what is shown");
        }
    }
}

#[test]
fn a_glow_fades_away_from_the_silhouette() {
    let mut studio = synthetic(60);
    let middle = studio.extent().center();
    let camera = Camera::looking(middle + DVec3::new(60.0, -110.0, 80.0), middle, 0.8);
    let view = view_of(camera);
    let mut plain = scene(camera, vec![]);
    plain.style.effects = vec![used("clay")];
    let without = draw(&mut studio, &plain, Backend::Specialised);
    let shapes = shapes(middle + DVec3::new(0.0, 0.0, 2.0), 30.0).into_iter().enumerate();
    for (i, focus) in shapes.filter(|(i, _)| is_tried(*i, 2)) {
        let reference = Reference::of(&focus);
        let met: Vec<bool> = pixels().map(|(_, x, y)| !reference.intervals(&view.pixel_ray(x, y)).is_empty()).collect();
        let scene = Scene { lenses: vec![body_of(LensBody::Halo, focus)], ..plain.clone() };
        let glowing = draw(&mut studio, &scene, Backend::Specialised);
        let mut by_distance = vec![Vec::new(); 40];
        for (k, x, y) in pixels().step_by(if is_thorough() { 43 } else { 131 }) {
            let at = DVec2::new(f64::from(x), f64::from(y));
            // What is farther than 40 pixels away is as good as nowhere.
            let around = |c: u32, end: u32| c.saturating_sub(40)..(c + 41).min(end);
            let near = around(y, SIZE[1]).flat_map(|b| around(x, SIZE[0]).map(move |a| (a, b)));
            let nearest = near
                .filter(|(a, b)| met[(b * SIZE[0] + a) as usize] != met[k])
                .map(|(a, b)| at.distance(DVec2::new(f64::from(a), f64::from(b))));
            let nearest = nearest.fold(f64::INFINITY, f64::min);
            let change = difference(glowing.rgba[k], without.rgba[k]);
            if met[k] {
                assert!(change == 0 || nearest < 2.0, "shape {i}: pixel {x}, {y} of the lens glows");
            } else if nearest < 40.0 {
                by_distance[nearest as usize].push(f64::from(change));
            } else {
                assert_eq!(change, 0, "shape {i}: pixel {x}, {y} is far away");
            }
        }
        let mean = |list: &[f64]| list.iter().sum::<f64>() / list.len().max(1) as f64;
        let [near, halfway, beyond] = [mean(&by_distance[1]), mean(&by_distance[9]), mean(&by_distance[20..].concat())];
        assert!(near > 3.0 * halfway && halfway > 1.0 && beyond < 0.5, "shape {i}: {near} {halfway} {beyond}");
    }
}

/// How close a ray from the origin comes to a segment at least, as the sine of an angle; `direction` is unit.
fn least_sine(direction: DVec3, [a, b]: [DVec3; 2]) -> f64 {
    let e = b - a;
    let (ad, ed, aa, ae, ee) = (a.dot(direction), e.dot(direction), a.dot(a), a.dot(e), e.dot(e));
    let between = ((ed * aa - ad * ae) / (ad * ee - ed * ae)).clamp(0.0, 1.0);
    let places = [a, b, a + if between.is_finite() { between } else { 0.0 } * e];
    let ahead = places.into_iter().filter(|p| p.dot(direction) > 0.0);
    ahead.map(|p| p.cross(direction).length() / p.length()).fold(1.0, f64::min)
}

/// Where the sky is seen, its glow is known by thought: a building may come close to a ray anywhere along it, behind many others.
#[test]
fn a_glow_is_as_strong_as_rays_come_close_to_any_of_many_buildings() {
    let text = "veduta = 1\n[city]\nfiles = [\"builtin:town\"]\nground = false\n[camera]\neye = [86, -58, 60]\ntarget = [-5, 5, 6]\nfov_deg = 45\n\
                [sun]\nshadows = false\n[[lens]]\nname = \"a\"\nkind = \"color\"\nbody = \"halo\"\n\
                shape = { kind = \"objects\", types = [\"Building\"] }\n";
    let scene = parse(text, "glow.toml", &Options::default()).unwrap_or_else(|error| panic!("{error}"));
    let mut studio = of_scene(&scene);
    let view = view_of(scene.camera.expect("a camera"));
    let is_building =
        |object: u32| studio.model.strings.get(studio.model.objects[object as usize].kind).starts_with("Building");
    let edges: Vec<[DVec3; 2]> = triangles(&studio)
        .iter()
        .filter(|t| is_building(t.object))
        .flat_map(|t| [[0, 1], [1, 2], [2, 0]].map(|pair| pair.map(|k| t.corners[k] - view.camera.eye)))
        .collect();
    let strength = |(k, x, y): (usize, u32, u32)| {
        let ray = view.pixel_ray(x, y);
        let direction = ray.direction.normalize_or(DVec3::X);
        let sine = edges.iter().map(|edge| least_sine(direction, *edge)).fold(1.0, f64::min);
        // The glow is 18 pixels on the axis wide, and of 0.92 at most.
        let closest = sine / direction.dot(view.basis.forward) / view.pixel_m(1.0);
        (k, 0.92 * (1.0 - closest / 18.0).max(0.0).powi(2))
    };
    // Each pixel asks all edges.
    let every = 3;
    let all: Vec<(usize, f64)> = pixels().filter(|(k, ..)| is_tried(*k, every)).map(strength).collect();
    for backend in BACKENDS {
        let request = Request { transparent: true, aovs: ALL, backend, ..Request::plain(SIZE) };
        let drawn = studio.render(&scene, &request).expect("a picture");
        let depth = drawn.depth.as_ref().expect("depth");
        let (mut glowing, mut errors) = (0, Vec::new());
        for (k, wanted) in all.iter().copied().filter(|(k, _)| !depth[*k].is_finite()) {
            glowing += usize::from(wanted > 0.02);
            errors.push((f64::from(drawn.rgba[k][3]) / 255.0 - wanted).abs());
        }
        assert!(glowing > 1000 / every, "{glowing} pixels glow");
        let worst = errors.iter().copied().fold(0.0, f64::max);
        let mean = errors.iter().sum::<f64>() / errors.len() as f64;
        // Places along a ray are as far from each other as there is room: the closest one may lie between two.
        assert!(worst < 0.1 && mean < 0.01, "{backend:?}: {worst} at worst, {mean} in the mean");
    }
}

#[test]
fn both_back_ends_draw_the_same_bodies_and_moving_them_compiles_nothing() {
    let mut studio = synthetic(60);
    let middle = studio.extent().center();
    let camera = Camera::looking(middle + DVec3::new(60.0, -110.0, 80.0), middle, 0.8);
    let bodies = [LensBody::Shell, LensBody::Halo, LensBody::Outline];
    let all: Vec<Lens> = shapes(middle + DVec3::new(0.0, 0.0, 2.0), 30.0)
        .into_iter()
        .enumerate()
        .map(|(i, focus)| Lens { name: format!("lens {i}"), ..body_of(bodies[i % 3], focus) })
        .collect();
    for part in all.chunks(if is_thorough() { 4 } else { 2 }).step_by(2) {
        let scene = scene(camera, part.to_vec());
        let [one, other] = BACKENDS.map(|backend| draw(&mut studio, &scene, backend));
        assert!(one.rgba == other.rgba);
    }
    let ball = |x: f64| Shape::Sphere { center: middle + DVec3::X * x, radius: 20.0 };
    for body in bodies {
        let first = draw(&mut studio, &scene(camera, vec![body_of(body, ball(0.0))]), Backend::Specialised);
        let then = draw(&mut studio, &scene(camera, vec![body_of(body, ball(9.0))]), Backend::Specialised);
        assert!(then.statistics.pipelines.compiled == 0 && first.rgba != then.rgba);
    }
}

#[test]
fn what_has_no_surface_shows_a_line() {
    let chosen = Choice { ids: vec!["a".into()], ..Choice::default() };
    let thematic = Region::Thematic(chosen);
    let ball = || Region::from(Shape::Sphere { center: DVec3::ZERO, radius: 1.0 });
    let both =
        Region::Combined { how: veduta::geom::combination::Operation::Union, parts: vec![ball(), thematic.clone()] };
    for body in [LensBody::Shell, LensBody::Halo] {
        assert_eq!(body_of(body, thematic.clone()).drawn_body(), LensBody::Outline);
        assert_eq!(body_of(body, both.clone()).drawn_body(), LensBody::Outline);
        assert_eq!(body_of(body, ball()).drawn_body(), body);
    }
    let in_sprite = Lens { sprite: Some(Default::default()), ..body_of(LensBody::Halo, ball()) };
    assert_eq!(in_sprite.drawn_body(), LensBody::Outline);
}

#[test]
fn a_line_around_a_convex_lens_is_that_around_any() {
    let mut studio = synthetic(20);
    let middle = studio.extent().center();
    let camera = Camera::looking(middle + DVec3::new(60.0, -110.0, 80.0), middle, 0.8);
    // With something out of the picture it is a combination, and its line is found without what is known of convex ones.
    let away = Region::from(Shape::Sphere { center: middle + DVec3::new(-5e3, 9e3, 0.0), radius: 1.0 });
    let mut on_line = 0;
    for (i, shape) in shapes(middle, 30.0).into_iter().take(7).enumerate() {
        let parts = vec![shape.clone(), away.clone()];
        let combined = Region::Combined { how: Operation::Union, parts };
        let plain = draw(&mut studio, &scene(camera, vec![body_of(LensBody::None, shape.clone())]), BACKENDS[i % 2]);
        let [one, other] = [shape.clone(), combined]
            .map(|region| draw(&mut studio, &scene(camera, vec![body_of(LensBody::Outline, region)]), BACKENDS[i % 2]));
        on_line += one.rgba.iter().zip(&plain.rgba).filter(|(a, b)| a != b).count();
        let differ = one.rgba.iter().zip(&other.rgba).filter(|(a, b)| a != b).count();
        assert_eq!(differ, 0, "{shape:?}");
    }
    assert!(on_line > 3000, "{on_line} pixels are on lines");
}

/// A ball, its middle as far away as `away` radii, seen by an eye that looks past it by `aside` radii.
fn past_a_ball(middle: DVec3, radius: f64, away: f64, aside: f64, fov: f64) -> Camera {
    let eye = middle + radius * away * DVec3::new(0.48, -0.64, 0.6);
    let target = middle + radius * aside * DVec3::new(0.8, 0.6, 0.0);
    Camera { near_m: 1e-3, ..Camera::looking(eye, target, fov) }
}

/// Of a ball and of figures in planes it is told where a pixel is clear of their line; of a combination nothing is.
#[test]
fn a_line_is_the_same_where_nothing_is_known_of_it_from_anywhere() {
    let mut studio = synthetic(20);
    let (middle, radius) = (studio.extent().center() + DVec3::Z * 40.0, 20.0);
    let facing = DQuat::from_rotation_arc(DVec3::Z, DVec3::new(0.48, -0.64, 0.6));
    let star = [[0.0, 1.0], [0.2, 0.2], [1.0, 0.0], [0.2, -0.3], [0.6, -1.0], [-0.3, -0.2], [-1.0, 0.4]];
    let figures = [
        FlatFigure::Disc { radius },
        FlatFigure::Rectangle { size: DVec2::new(2.0, 1.2) * radius },
        FlatFigure::Polygon { points: star.map(|p| radius * DVec2::from(p)).to_vec() },
    ];
    let flat = |figure| Region::from(Shape::Flat { center: middle, rotation: facing, figure });
    let bodies: Vec<Region> =
        std::iter::once(Shape::Sphere { center: middle, radius }.into()).chain(figures.map(flat)).collect();
    let away = Region::from(Shape::Sphere { center: middle + DVec3::new(-5e3, 9e3, 0.0), radius: 1e-3 });
    // Inside, at the border, outside; past it, towards it, away from it; from hundredths of a degree to nearly a half turn.
    let mut cameras = Vec::new();
    for away in [0.2, 0.999, 1.001, 1.3, 6.0, 300.0] {
        for (aside, fov) in [(0.0, 0.9), (1.0, 0.3), (0.99, 2e-3), (1.6, 3.1), (-40.0, 2.6), (1.01, 0.05)] {
            cameras.push(past_a_ball(middle, radius, away, aside, fov));
        }
    }
    for (aside, height) in [(0.0, 60.0), (1.0, 5.0), (1.001, 0.2), (0.5, 4e3)] {
        let eye = past_a_ball(middle, radius, 6.0, aside, 0.9);
        cameras.push(orthographic(eye.eye + (eye.target - middle), eye.target, height));
    }
    let (mut on_line, mut tried) = (0, 0);
    let all = cameras.iter().flat_map(|camera| bodies.iter().map(move |body| (*camera, body))).enumerate();
    for (i, (camera, body)) in all.filter(|(i, _)| is_tried(*i, 13)) {
        let unknown = Region::Combined { how: Operation::Union, parts: vec![body.clone(), away.clone()] };
        let mut of = |region: Option<&Region>| {
            let lenses = region.into_iter().map(|region| body_of(LensBody::Outline, region.clone())).collect();
            draw(&mut studio, &scene(camera, lenses), BACKENDS[i % 2]).rgba
        };
        let [none, known, unknown] = [None, Some(body), Some(&unknown)].map(&mut of);
        let differ = known.iter().zip(&unknown).filter(|(a, b)| a != b).count();
        assert_eq!(differ, 0, "camera {i}: {camera:?}");
        let lined = known.iter().zip(&none).filter(|(a, b)| a != b).count();
        on_line += lined;
        tried += usize::from(lined > 0);
    }
    assert!(tried > 2 && on_line > 1000, "{on_line} pixels are on the lines of {tried} pictures");
}

/// An outline is 1.2 points wide, 8 pixels at most, and a glow 13.5: by the dots per inch of the figure, or the share of a picture larger than usual. Tiles have
/// the same, and so have both back ends.
#[test]
fn bodies_are_as_wide_as_their_points_say() {
    const WIDE: [u32; 2] = [400, 100];
    let mut studio = synthetic(60);
    let middle = studio.extent().center() + DVec3::Z * 400.0;
    let camera = orthographic(middle - DVec3::Y * 100.0, middle, 100.0);
    let ball = Shape::Sphere { center: middle, radius: 30.0 };
    // Of the row through its middle: how much of the body's colour there is, in pixels, on each side.
    let mut row_of = |body: LensBody, dpi: Option<f64>, scale: f64, backend: Backend, tile: Option<u32>| -> Vec<f64> {
        let lens = Lens { color: [1.0; 3], ..body_of(body, ball.clone()) };
        let mut scene = scene(camera, vec![lens]);
        scene.style.background = Background::Color([0.0; 3]);
        (scene.figure.dpi, scene.figure.scale) = (dpi, scale);
        studio.renderer.settings.tile = tile;
        let picture = studio.render(&scene, &Request { backend, ..Request::plain(WIDE) }).expect("a picture");
        let row = &picture.rgba[(WIDE[1] / 2 * WIDE[0]) as usize..][..WIDE[0] as usize];
        row.iter().map(|p| crate::light::decoded([f64::from(p[0]) / 255.0; 3])[0] / 0.92).collect()
    };
    for (dpi, scale, px) in [
        (None, 1.0, 1.6),
        (Some(96.0), 1.0, 1.6),
        (Some(192.0), 1.0, 3.2),
        (Some(150.0), 2.0, 5.0),
        (Some(600.0), 1.0, 8.0),
    ] {
        let rows: Vec<Vec<f64>> = [(BACKENDS[0], None), (BACKENDS[1], None), (BACKENDS[0], Some(64))]
            .map(|(backend, tile)| row_of(LensBody::Outline, dpi, scale, backend, tile))
            .into();
        assert!(rows.iter().all(|row| *row == rows[0]), "{dpi:?}");
        let width = 0.5 * rows[0].iter().sum::<f64>();
        assert!((width - px).abs() < 0.05, "{dpi:?}, {scale}: {width} pixels, {px} would be right");
        // The glow is seen around the ball, less with the distance.
        let glow = row_of(LensBody::Halo, dpi, scale, BACKENDS[0], None);
        let lit = glow.iter().filter(|share| **share > 0.0).count() as f64;
        let reach = 0.5 * lit / (13.5 / 72.0 * dpi.unwrap_or(96.0) * scale);
        assert!((0.8..=1.1).contains(&reach) || px == 8.0, "{dpi:?}: a glow goes {reach} of its width");
    }
}
