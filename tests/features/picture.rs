//! Pictures whose answer is known by thought (style 20), drawn on whatever adapter there is.

use crate::studio::*;
use glam::DVec3;
use veduta::{
    figure::{
        picture::{Notes, save_picture},
        scene_file,
    },
    geom::{Aabb, Shape},
    lens::{Class, Lens, LensBody, LensSprite, Region, classify},
    render::{
        frame::Backend,
        picture::{Aovs, Request, Studio},
        stats::LensFigures,
    },
    scene::{BaseStyle, Scene, StyleLook, Technique, Transparency},
    view::{Camera, View},
};

const SIZE: [u32; 2] = [320, 240];

/// The middle of a house: `share` of all come before it in the file.
fn house(studio: &Studio, share: f64) -> DVec3 {
    let number = studio.geometries[(share * studio.geometries.len() as f64) as usize];
    studio.model.geometries[number as usize].bounds.center()
}

fn overview() -> Camera {
    Camera::looking(DVec3::new(140.0, -180.0, 120.0), DVec3::new(0.0, 0.0, 5.0), 0.8)
}

fn view(camera: Camera, size: [u32; 2]) -> View {
    View::new(camera, size, &Aabb { min: DVec3::splat(-2e4), max: DVec3::splat(2e4) }).expect("a view")
}

#[test]
fn six_triangles_stand_where_their_axes_point() {
    let mut studio = studio(&[citydata("axes.city.json")]);
    let axes = [DVec3::X, -DVec3::X, DVec3::Y, -DVec3::Y, DVec3::Z, -DVec3::Z];
    for (number, axis) in axes.into_iter().enumerate() {
        let drawn = picture(&mut studio, &scene(Camera::looking(axis * 60.0, DVec3::ZERO, 0.5), vec![]), [65, 65]);
        let middle = 32 * 65 + 32;
        assert_eq!(drawn.object_id.as_ref().unwrap()[middle], number as u32 + 1, "{axis}");
        assert_eq!(drawn.normal.as_ref().unwrap()[middle], axis.as_vec3().to_array(), "{axis}");
        assert!((drawn.depth.as_ref().unwrap()[middle] - 50.0).abs() < 50.0 * f32::EPSILON * 2.0, "{axis}");
    }
}

#[test]
fn depth_is_that_of_the_plane_across_picture_tiles() {
    // A cube's top seen from above, in a picture wider than a target: every pixel's depth is known.
    let mut studio = studio(&[citydata("cube.city.json")]);
    let camera = Camera::looking(DVec3::new(5.0, 5.0, 40.0), DVec3::new(5.0, 5.0, 0.0), 0.0005);
    let drawn = picture(&mut studio, &scene(camera, vec![]), [4300, 12]);
    let wrong = drawn.depth.unwrap().iter().filter(|d| (**d - 30.0).abs() > 30.0 * f32::EPSILON * 2.0).count();
    assert_eq!(wrong, 0);
    assert!(drawn.object_id.unwrap().iter().all(|&id| id == 1));
    assert!(drawn.normal.unwrap().iter().all(|&n| n == [0.0, 0.0, 1.0]));
}

#[test]
fn a_sphere_lens_in_orthographic_view_covers_pi_r_squared_pixels() {
    let mut studio = studio(&[citydata("cube.city.json")]);
    let camera = orthographic(DVec3::new(5.0, 5.0, 90.0), DVec3::new(5.0, 5.0, 0.0), 100.0);
    let sphere = lens("ball", vec![Shape::Sphere { center: DVec3::new(5.0, 5.0, 5.0), radius: 40.0 }], "sepia");
    let drawn = picture(&mut studio, &scene(camera, vec![sphere]), [200, 200]);
    let classes = drawn.statistics.lenses[0].classified;
    let covered = classes.front.unwrap() + classes.inside.unwrap() + classes.behind.unwrap();
    // Two pixels a metre: r = 80 pixels; the count differs from the area by less than the border's length.
    let area = std::f64::consts::PI * 80.0 * 80.0;
    assert!((covered as f64 - area).abs() < 0.1 * 2.0 * std::f64::consts::PI * 80.0, "{covered} against {area}");
    // The cube's 10 m square top is inside, nothing else is there.
    assert_eq!(classes.inside, Some(400));
    assert_eq!(drawn.statistics.lenses[0].objects, 1);
}

#[test]
fn masks_of_all_shapes_are_right_to_the_pixel() {
    let mut studio = synthetic(60);
    let at = house(&studio, 0.5);
    let cameras = [
        Camera::looking(at + DVec3::new(90.0, -120.0, 70.0), at, 0.9),
        orthographic(at + DVec3::new(90.0, -120.0, 70.0), at, 160.0),
        // Street height, the eye among the houses and inside the larger lenses.
        Camera::looking(at + DVec3::new(6.5, 3.0, -6.0), at + DVec3::new(60.0, 30.0, 0.0), 1.1),
    ];
    for (look, camera) in cameras.into_iter().enumerate() {
        // Large, small and large; in a thorough run both from everywhere.
        for (_, r) in [45.0, 12.0].into_iter().enumerate().filter(|(i, _)| is_tried(i + look, 2)) {
            // From its figures, and by its sprite.
            let one = |(i, (shape, sprite)): (usize, (Region, Option<LensSprite>))| Lens {
                sprite,
                ..lens(&format!("any {i}"), vec![shape], "greyscale")
            };
            let twice = |shape: Region| [(shape.clone(), None), (shape, Some(LensSprite::default()))];
            let lenses: Vec<_> = shapes(at, r).into_iter().flat_map(twice).enumerate().map(one).collect();
            let scene = scene(camera, lenses);
            let drawn = picture(&mut studio, &scene, SIZE);
            let view = view(camera, SIZE);
            for (i, lens) in scene.lenses.iter().enumerate() {
                let (wrong, of) = (wrong_pixels(&drawn, &view, lens, i), &lens.shapes[0]);
                assert_eq!(wrong, 0, "{of:?} from {}, sprite {:?}", camera.eye, lens.sprite);
            }
            // The other classes: both tests look at the same ray.
            for pair in drawn.statistics.lenses.as_chunks::<2>().0 {
                let counts = |lens: &LensFigures| {
                    let c = &lens.classified;
                    [c.front, c.inside, c.behind, c.rest].map(|n| n.expect("a count"))
                };
                let apart: Vec<u64> =
                    counts(&pair[0]).iter().zip(counts(&pair[1])).map(|(a, b)| a.abs_diff(b)).collect();
                assert!(apart.iter().all(|&n| n <= 4), "{:?} and {:?}", counts(&pair[0]), counts(&pair[1]));
            }
        }
    }
}

#[test]
fn classes_of_concave_shapes_and_combinations_are_those_of_their_intervals() {
    let mut studio = synthetic(60);
    let at = house(&studio, 0.5);
    // From all eyes, and in a thorough run in a picture of four times as many pixels.
    let (size, least) = if is_thorough() { (SIZE, 20) } else { ([160, 120], 5) };
    for camera in [
        Camera::looking(at + DVec3::new(90.0, -120.0, 70.0), at, 0.9),
        orthographic(at + DVec3::new(90.0, -120.0, 70.0), at, 160.0),
        // Over the roofs, inside of some and in the hole of the ring; and beside what was cut away.
        Camera::looking(at + DVec3::new(2.0, 1.0, 10.0), at + DVec3::new(60.0, 30.0, -6.0), 1.1),
        Camera::looking(at + DVec3::new(25.0, 0.0, 9.0), at + DVec3::new(-60.0, 12.0, -4.0), 1.1),
    ] {
        let concave: Vec<Region> = shapes(at, 30.0).split_off(7);
        let one = |(i, shape): (usize, Region)| lens(&format!("any {i}"), vec![shape], "greyscale");
        let scene = scene(camera, concave.into_iter().enumerate().map(one).collect());
        let drawn = picture(&mut studio, &scene, size);
        let (view, depth) = (view(camera, size), drawn.depth.as_ref().expect("depth"));
        for (lens, figures) in scene.lenses.iter().zip(&drawn.statistics.lenses) {
            let reference = Reference::of(&lens.shapes[0]);
            let mut expected = [0_u64; 4];
            for (i, (x, y)) in (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| (x, y))).enumerate() {
                // What a ray grazes for less than a millimetre a GPU may miss.
                let mut along = reference.intervals(&view.pixel_ray(x, y));
                along.retain(|(entry, exit)| exit - entry > 1e-3);
                let class = classify(&along, depth[i].into());
                expected[class as usize] += 1;
            }
            let c = &figures.classified;
            let found = [c.inside, c.front, c.behind, c.rest].map(|n| n.expect("a count"));
            // Rays that graze an edge, and places on the border.
            let apart = (0..4).map(|i| found[i].abs_diff(expected[i])).max().unwrap_or(0);
            assert!(apart <= 4, "{:?} from {}: {found:?}, by intervals {expected:?}", lens.shapes[0], camera.eye);
            assert!(found[0] > least, "{:?} from {}: {found:?}", lens.shapes[0], camera.eye);
        }
    }
}

#[test]
fn the_mask_of_a_corridor_is_that_of_its_bodies() {
    let mut studio = synthetic(60);
    let at = house(&studio, 0.5);
    let points = [[-60.0, -20.0, 2.0], [-10.0, 0.0, 2.0], [20.0, 40.0, 9.0], [20.0, 40.0, 15.0], [70.0, 35.0, 4.0]];
    let points = points.into_iter().map(|p| at + DVec3::from(p)).collect();
    let route = lens("route", vec![Shape::Corridor { points, width: 14.0, height: 22.0 }], "sepia");
    for camera in [
        Camera::looking(at + DVec3::new(90.0, -120.0, 70.0), at, 0.9),
        Camera::looking(at + DVec3::new(-50.0, -16.0, 2.0), at, 1.1),
    ] {
        let scene = scene(camera, vec![route.clone()]);
        let drawn = picture(&mut studio, &scene, SIZE);
        assert_eq!(wrong_pixels(&drawn, &view(camera, SIZE), &route, 0), 0);
        assert!(bits(&drawn, 0).iter().filter(|b| **b).count() > 300);
        let request = Request { aovs: ALL, statistics: true, backend: Backend::Uber, ..Request::plain(SIZE) };
        let other = studio.render(&scene, &request).expect("a picture");
        assert!(other.rgba == drawn.rgba && other.lens_mask == drawn.lens_mask, "the back ends differ");
    }
}

#[test]
fn several_volumes_of_one_lens_are_one_focus() {
    let mut studio = synthetic(60);
    let at = house(&studio, 0.5);
    let ball = |center| Shape::Sphere { center, radius: 18.0 };
    let both = lens("both", vec![ball(at), ball(house(&studio, 0.3)), ball(house(&studio, 0.7))], "sepia");
    let camera = Camera::looking(at + DVec3::new(90.0, -120.0, 70.0), at, 0.9);
    let scene = scene(camera, vec![both]);
    let drawn = picture(&mut studio, &scene, SIZE);
    assert_eq!(wrong_pixels(&drawn, &view(camera, SIZE), &scene.lenses[0], 0), 0);
    assert!(bits(&drawn, 0).contains(&true));
}

#[test]
fn the_same_scene_gives_the_same_bytes_and_costs_nothing_anew() {
    let mut studio = synthetic(60);
    let at = house(&studio, 0.5);
    let mut scene = scene(overview(), vec![lens("a", shapes(at, 40.0)[..1].to_vec(), "greyscale")]);
    scene.sun.shadows = true;
    let first = picture(&mut studio, &scene, SIZE);
    let second = picture(&mut studio, &scene, SIZE);
    assert_eq!(first.rgba, second.rgba);
    let frame = &second.statistics.frame;
    assert_eq!((frame.allocations, frame.uploads), (0, 0), "an unchanged frame allocates or uploads");
    assert!(second.statistics.passes.iter().all(|p| p.name != "shadow map"), "an unchanged shadow is drawn again");
    assert_eq!(second.statistics.pipelines.compiled, 0);
    let geometry = second.statistics.passes.iter().filter(|p| p.name == "geometry").count();
    assert_eq!(geometry, 1);
    // A second renderer, from nothing.
    assert_eq!(picture(&mut synthetic(60), &scene, SIZE).rgba, first.rgba);
}

/// Frames in turn, each another than the one before by one thing: what is held on the GPU shows as it does where all is drawn anew, and a lens that
/// hides nothing moves over a city that is not drawn again.
#[test]
fn what_is_held_from_frame_to_frame_shows_as_drawn_anew() {
    let mut studios = [true, false].map(|holds| {
        let mut studio = synthetic(60);
        studio.renderer.settings.holds_geometry = holds;
        studio
    });
    let at = house(&studios[0], 0.5);
    let mut scene = scene(overview(), vec![lens("a", shapes(at, 40.0)[..1].to_vec(), "greyscale")]);
    (scene.sun.shadows, scene.sun.ambient_occlusion) = (true, true);
    let mut request = Request { screen_occlusion: true, ..Request::plain(SIZE) };
    let effects = ["greyscale", "eraser", "posterise", "x-ray", "sepia", "cut-away"];
    let (mut held, mut seed) = (0, 5_u32);
    for frame in 0..96 {
        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let pick = seed >> 16;
        match frame % 8 {
            // Four times of eight nothing but the lens moves.
            0 | 1 | 3 | 4 => {
                let Region::Shape(Shape::Sphere { center, .. }) = &mut scene.lenses[0].shapes[0] else {
                    panic!("a sphere")
                };
                center.x += 3.0;
            }
            2 => scene.lenses[0].effects = vec![used(effects[pick as usize % effects.len()])],
            5 => match pick % 4 {
                0 => scene.camera.as_mut().expect("a camera").eye.x += 5.0,
                1 => request.samples = 4 - request.samples,
                2 => request.size[0] ^= 16,
                _ => request.aovs.depth ^= true,
            },
            6 => match pick % 6 {
                0 | 4 | 5 => scene.style.technique = Technique::Regions,
                1 => scene.style.transparency = [Transparency::Exact, Transparency::Stochastic][pick as usize / 4 % 2],
                2 => scene.style.facades ^= true,
                _ => scene.style.look = [StyleLook::Natural, StyleLook::Paper][pick as usize / 4 % 2],
            },
            _ => {
                // Back to what is held; every other time another has drawn into the same targets.
                request.samples = 1;
                if scene.style.technique == Technique::Regions {
                    scene.camera.as_mut().expect("a camera").eye.x -= 7.0;
                }
                (scene.style.technique, scene.style.transparency) = (Technique::Accumulate, Transparency::Exact);
                let view = view(scene.camera.expect("a camera"), request.size);
                if frame % 16 == 7 {
                    studios.iter_mut().for_each(|studio| studio.renderer.draw_bare(&view));
                }
            }
        }
        if scene.style.technique == Technique::Regions {
            // It hides nothing; from another place, and back again.
            scene.lenses[0].effects = vec![used("greyscale")];
            scene.camera.as_mut().expect("a camera").eye.x += 7.0;
        }
        studios[1].renderer.drop_targets();
        let [as_held, anew] = studios.each_mut().map(|studio| {
            let passes = studio.draw(&scene, &request).unwrap_or_else(|error| panic!("{frame}: {error}"));
            let targets = studio.renderer.targets().expect("targets");
            let bytes = studio.renderer.gpu.read_texture(&targets.picture.texture, 0, wgpu::TextureAspect::All);
            let is_drawn = passes.iter().any(|pass| pass.name.starts_with("geometry"));
            (is_drawn, bytes.expect("a picture"))
        });
        assert!(anew.0, "frame {frame}");
        held += u32::from(!as_held.0);
        assert!(
            as_held.1 == anew.1,
            "frame {frame}: another picture, {} {:?}",
            scene.lenses[0].effects[0].effect,
            request
        );
    }
    assert!(held > 20, "only {held} frames of 96 hold the city");
}

#[test]
fn what_near_buildings_hide_is_not_drawn_and_not_missed() {
    let mut studio = synthetic(8_000);
    let (used, fewer, all) = hiding_changes_nothing(&mut studio, 12, SIZE);
    assert!(used >= 6, "only {used} of 12 street views leave anything out");
    assert!(fewer * 3 < all * 2, "{fewer} triangles are drawn instead of {all}");
    // From above, everything is drawn in one pass.
    studio.renderer.settings.culls_hidden = true;
    let extent = studio.extent();
    let above = Camera::looking(extent.center() + DVec3::new(0.0, -1.0, 1.0) * extent.size().y, extent.center(), 0.8);
    let passes = picture(&mut studio, &scene(above, vec![]), SIZE).statistics.passes;
    assert!(passes.iter().all(|p| p.name != "geometry beyond"));
}

#[test]
fn lenses_that_do_nothing_cost_nothing() {
    let mut studio = synthetic(60);
    let at = house(&studio, 0.5);
    let plain = picture(&mut studio, &scene(overview(), vec![]), SIZE);
    assert!(plain.statistics.passes.iter().all(|p| p.name == "geometry" || p.name == "shade"));
    assert!(plain.statistics.handlers.is_empty());
    let ball = |center, radius| lens("ball", vec![Shape::Sphere { center, radius }], "greyscale");
    let mut disabled = ball(at, 40.0);
    disabled.enabled = false;
    let idle = [("disabled", disabled), ("of no size", ball(at, 0.0)), ("off screen", ball(at + DVec3::Z * 9e3, 5.0))];
    for (why, lens) in idle {
        let drawn = picture(&mut studio, &scene(overview(), vec![lens]), SIZE);
        assert_eq!(drawn.rgba, plain.rgba, "{why}");
        let names = |s: &veduta::render::stats::Statistics| s.passes.iter().map(|p| p.name.clone()).collect::<Vec<_>>();
        assert_eq!(names(&drawn.statistics), names(&plain.statistics), "{why}");
        assert_eq!(drawn.statistics.pipelines.names, plain.statistics.pipelines.names, "{why}");
        assert_eq!(drawn.statistics.handlers, plain.statistics.handlers, "{why}");
        assert!(!drawn.statistics.lenses[0].visible, "{why}");
        assert!(bits(&drawn, 0).iter().all(|b| !b), "{why}");
    }
}

#[test]
fn a_lens_around_everything_is_the_global_effect() {
    let mut studio = synthetic(60);
    let around = lens("around", vec![Shape::Sphere { center: DVec3::ZERO, radius: 1e5 }], "sepia");
    let inside = picture(&mut studio, &scene(overview(), vec![around]), SIZE);
    let mut global: Scene = scene(overview(), vec![]);
    global.style.effects = vec![used("sepia")];
    let everywhere = picture(&mut studio, &global, SIZE);
    let ids = inside.object_id.as_ref().unwrap();
    let differing = (0..ids.len()).filter(|&i| ids[i] != 0 && inside.rgba[i] != everywhere.rgba[i]).count();
    assert_eq!(differing, 0);
    assert!(ids.iter().filter(|&&id| id != 0).count() > 1000);
}

#[test]
fn the_last_lens_is_on_top() {
    let mut studio = synthetic(60);
    let at = house(&studio, 0.5);
    let ball = |effect: &str| lens(effect, vec![Shape::Sphere { center: at, radius: 60.0 }], effect);
    let of = |studio: &mut _, list: &[&str]| {
        picture(studio, &scene(overview(), list.iter().map(|e| ball(e)).collect()), SIZE).rgba
    };
    let sepia = of(&mut studio, &["sepia"]);
    // Sepia of grey is sepia; grey of sepia is grey.
    assert_eq!(of(&mut studio, &["greyscale", "sepia"]), sepia);
    let grey = of(&mut studio, &["sepia", "greyscale"]);
    assert_ne!(grey, sepia);
    let inside = bits(&picture(&mut studio, &scene(overview(), vec![ball("greyscale")]), SIZE), 0);
    assert!(grey.iter().zip(inside).filter(|(_, b)| *b).all(|(c, _)| c[0] == c[1] && c[1] == c[2]));
}

#[test]
fn classes_other_than_inside_are_their_own_part() {
    let mut studio = synthetic(60);
    let at = house(&studio, 0.5);
    let plain = picture(&mut studio, &scene(overview(), vec![]), SIZE);
    let mut changed = vec![0_u8; plain.rgba.len()];
    for class in [Class::Inside, Class::Front, Class::Behind, Class::Rest] {
        let mut ball = lens("ball", vec![Shape::Sphere { center: at, radius: 40.0 }], "greyscale");
        ball.effects[0].class = class;
        let drawn = picture(&mut studio, &scene(overview(), vec![ball]), SIZE);
        for (i, count) in changed.iter_mut().enumerate() {
            *count += u8::from(drawn.rgba[i] != plain.rgba[i]);
        }
    }
    // Four classes partition the picture; a pixel that is grey already changes in none.
    assert!(changed.iter().all(|&c| c <= 1));
    assert!(changed.iter().filter(|&&c| c == 1).count() > plain.rgba.len() / 2);
}

#[test]
fn samples_smooth_and_aovs_stay() {
    let mut studio = synthetic(60);
    let at = house(&studio, 0.5);
    let mut ball = lens("ball", vec![Shape::Sphere { center: at, radius: 40.0 }], "sepia");
    ball.body = LensBody::Outline;
    let scene = scene(overview(), vec![ball]);
    let one = picture(&mut studio, &scene, SIZE);
    let request = Request { samples: 8, aovs: ALL, statistics: true, ..Request::plain(SIZE) };
    let eight = studio.render(&scene, &request).expect("a picture");
    assert_eq!(one.depth, eight.depth);
    assert_eq!(one.object_id, eight.object_id);
    assert_eq!(one.lens_mask, eight.lens_mask);
    let near = |a: &[u8; 4], b: &[u8; 4]| (0..3).all(|i| a[i].abs_diff(b[i]) <= 2);
    let close = one.rgba.iter().zip(&eight.rgba).filter(|(a, b)| near(a, b)).count();
    assert!(close > one.rgba.len() / 2, "only {close} pixels agree");
    assert_ne!(one.rgba, eight.rgba);
}

#[test]
fn nothing_behind_the_city_where_it_is_to_be_transparent() {
    let mut studio = studio(&[citydata("cube.city.json")]);
    let scene = scene(Camera::looking(DVec3::new(40.0, -30.0, 30.0), DVec3::splat(5.0), 0.8), vec![]);
    for samples in [1, 4] {
        let aovs = Aovs { object_id: true, ..Aovs::default() };
        let request = Request { samples, transparent: true, aovs, ..Request::plain(SIZE) };
        let drawn = studio.render(&scene, &request).expect("a picture");
        let ids = drawn.object_id.expect("ids");
        let solid = drawn.rgba.iter().filter(|p| p[3] == 255).count();
        let clear = drawn.rgba.iter().filter(|p| p[3] == 0).count();
        let hit = ids.iter().filter(|&&id| id != 0).count();
        if samples == 1 {
            assert_eq!((solid, clear), (hit, ids.len() - hit));
        } else {
            assert!(solid > hit * 9 / 10 && clear + solid < ids.len(), "{solid} {clear} {hit}");
        }
    }
}

#[test]
fn a_frame_of_an_empty_city_is_a_sky() {
    let mut studio = studio(&[citydata("empty.city.json")]);
    let drawn = picture(&mut studio, &Scene { style: Default::default(), ..Scene::default() }, [64, 48]);
    assert!(drawn.rgba.iter().all(|p| p[3] == 255));
    assert!(drawn.object_id.unwrap().iter().all(|&id| id == 0));
}

#[test]
fn clay_has_one_colour() {
    let mut studio = studio(&[citydata("axes.city.json")]);
    let from = |studio: &mut _, axis: DVec3| {
        let mut scene = scene(orthographic(axis * 60.0, DVec3::ZERO, 20.0), vec![]);
        scene.style.base = BaseStyle::Clay;
        picture(studio, &scene, [33, 33]).rgba[16 * 33 + 16]
    };
    // Two faces that the sun does not reach at the same inclination to the sky differ in nothing but colour of file.
    let (a, b) = (from(&mut studio, DVec3::Y), from(&mut studio, DVec3::X));
    assert_eq!(a[0].cmp(&a[2]), b[0].cmp(&b[2]), "{a:?} {b:?}");
}

/// The pictures by which the window offers looks are those of the looks: `VEDUTA_UPDATE=looks` draws them anew.
#[test]
fn looks_are_offered_by_pictures_of_them() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/looks");
    let text = "veduta = 1\n[city]\nfiles = [\"builtin:square\"]\n[camera]\neye = [-52, -78, 40]\ntarget = [4, 6, 5]\nfov_deg = 38.0\n";
    let scene = scene_file::parse(text, "looks", &scene_file::Options::for_command_line()).expect("a scene");
    let mut studio = with_full_shadows(of_scene(&scene));
    for (word, look) in StyleLook::WORDS {
        let mut scene = scene.clone();
        scene.style.look = look;
        let drawn = studio.render(&scene, &Request { samples: 32, ..Request::plain([168, 112]) }).expect("a picture");
        let file = folder.join(format!("{word}.png"));
        if std::env::var_os("VEDUTA_UPDATE").is_some_and(|what| what == "looks") {
            save_picture(&file, drawn.size, &drawn.rgba, true, &Notes::default()).expect("a file");
        }
        let shipped = image::open(&file).expect("a picture").into_rgba8();
        let off = drawn.rgba.as_flattened().iter().zip(shipped.as_raw()).map(|(a, b)| f64::from(a.abs_diff(*b)));
        let mean = off.sum::<f64>() / (drawn.rgba.len() * 3) as f64;
        // Adapters differ a little; looks by 30 and more.
        assert!(mean < 4.0, "{word}: {mean}");
    }
}
