//! Deformations, regions and transforms of users: those that the docs show, as their readers would use them.

use std::sync::Once;

use crate::studio::{bent::Sight, *};
use glam::{DVec2, DVec3};
use veduta::{
    figure::scene_file::{Options, read},
    geom::{Aabb, deform::Deformers, shape::Motion},
    lens::{LensBody, OwnRegion, Region},
    render::{
        frame::Backend,
        picture::{Picture, Request, Studio},
    },
    scene::Scene,
    shader::effect,
    view::{Camera, Projection, View},
};

const SIZE: [u32; 2] = [240, 150];

/// The WGSL files that `docs/effects.md` shows, by their names.
fn documented(name: &str) -> String {
    let page = include_str!("../../docs/effects.md");
    let mut blocks = page.split("```wgsl\n").skip(1).filter_map(|rest| rest.split("```").next());
    let head = format!("//! name = \"{name}\"\n");
    blocks.find(|block| block.starts_with(&head)).unwrap_or_else(|| panic!("the page shows {name}")).to_owned()
}

/// Adds those handlers, once.
fn with_documented() {
    static ADDED: Once = Once::new();
    ADDED.call_once(|| {
        for name in ["ripple", "torus", "tabletop", "swirl"] {
            effect::add(&format!("{name}.wgsl"), &documented(name)).unwrap_or_else(|error| panic!("{error}"));
        }
    });
}

/// A scene of a synthetic town with a lens as a scene file has it.
struct Town {
    studio: Studio,
    at: DVec3,
    camera: Camera,
}

impl Town {
    fn new() -> Self {
        with_documented();
        let studio = synthetic(60);
        let at = studio.extent().center();
        let camera = Camera::looking(at + DVec3::new(40.0, -190.0, 130.0), at, 0.7);
        Self { studio, at, camera }
    }

    /// The scene with such lenses.
    fn scene(&self, lenses: &str) -> Result<Scene, String> {
        let folder =
            std::env::temp_dir().join(format!("veduta-own-{}-{:?}", std::process::id(), std::thread::current().id()));
        std::fs::create_dir_all(&folder).map_err(|error| error.to_string())?;
        std::fs::copy(citydata("courtyard.city.json"), folder.join("city.json")).map_err(|error| error.to_string())?;
        let file = folder.join("scene.toml");
        let text = format!("veduta = 1\n[city]\nfiles = [\"city.json\"]\n\n{lenses}");
        std::fs::write(&file, text).map_err(|error| error.to_string())?;
        let read = read(&file, &Options::for_file(&file)).map_err(|error| error.to_string());
        let _ = std::fs::remove_dir_all(&folder);
        let mut scene = read?;
        scene.camera = Some(self.camera);
        Ok(scene)
    }

    fn drawn(&mut self, scene: &Scene, backend: Backend) -> Picture {
        let request = Request { aovs: ALL, statistics: true, backend, ..Request::plain(SIZE) };
        self.studio.render(scene, &request).unwrap_or_else(|error| panic!("{error}"))
    }

    /// The picture, which is the same by both back ends.
    fn picture(&mut self, scene: &Scene) -> Picture {
        let [a, b] = [Backend::Specialised, Backend::Uber].map(|backend| self.drawn(scene, backend));
        // The normals of its glass are differences of the function over a thousandth of the distance, which make a hundred roundings of one; and
        // Mesa's algebra rounds by what stands around an expression. Elsewhere nothing differs.
        let is_glass = scene.lenses.iter().any(|lens| lens.body == LensBody::Shell);
        let step = |a: &[u8; 4], b: &[u8; 4]| (0..4).map(|i| a[i].abs_diff(b[i])).max().unwrap_or(0);
        let steps: Vec<u8> = a.rgba.iter().zip(&b.rgba).map(|(a, b)| step(a, b)).filter(|step| *step > 0).collect();
        let is_rounding = is_glass && steps.len() <= 3 && steps.iter().all(|step| *step == 1);
        let differ = if is_rounding { 0 } else { steps.len() };
        let what = || scene.lenses.iter().map(|lens| format!("{:?} {:?}", lens.body, lens.effects)).collect::<String>();
        assert!(differ == 0, "the back ends differ at {differ} pixels: {}", what());
        assert!(
            a.depth == b.depth && a.lens_mask == b.lens_mask && a.object_id == b.object_id,
            "the back ends differ in what is not seen"
        );
        a
    }

    fn point(&self, at: DVec3) -> String {
        format!("[{}, {}, {}]", at.x, at.y, at.z)
    }

    fn pond(&self, rest: &str) -> String {
        let foot = self.at.with_z(20.0);
        format!(
            "[[lens]]\nname = \"pond\"\nbody = \"none\"\nkind = \"deformation\"\nshape = {{ kind = \"cylinder\", center = {}, radius = 150.0, height = 60.0 }}\n{rest}\n",
            self.point(foot)
        )
    }
}

/// Where pixels look to, and what stands there.
fn places(picture: &Picture, view: &View) -> Vec<Option<DVec3>> {
    let place = |(i, depth): (usize, &f32)| {
        let ray = view.pixel_ray(i as u32 % SIZE[0], i as u32 / SIZE[0]);
        let forward = ray.direction.dot(view.basis.forward);
        depth.is_finite().then(|| ray.origin + ray.direction * (f64::from(*depth) / forward))
    };
    picture.depth.as_ref().unwrap().iter().enumerate().map(place).collect()
}

#[test]
fn a_deformation_of_the_docs_moves_what_it_says_on_both_back_ends() {
    let mut town = Town::new();
    let scene = town.scene(&town.pond("deform = [{ kind = \"ripple\", height = 4.0, spacing = 10.0 }]")).unwrap();
    let still = Scene { lenses: vec![], ..scene.clone() };
    let before = town.picture(&still);
    let after = town.picture(&scene);
    assert!(before.rgba != after.rgba, "nothing moves");
    let deformers: std::sync::Arc<Deformers> = town.studio.deformers(&scene, SIZE).unwrap();
    let view = View::new(town.camera, SIZE, &Aabb::EMPTY).unwrap();
    // What is shown, taken back to rest, lies on a triangle of its object; its normal is that of the triangle, moved along.
    let triangles = triangles(&town.studio);
    let (mut moved, mut turned) = (0, 0);
    for (i, place) in places(&after, &view).into_iter().enumerate().step_by(7) {
        let (Some(place), object) = (place, after.object_id.as_ref().unwrap()[i]) else { continue };
        let rest = deformers.inverse(place).expect("nothing folds");
        // The chords of the mesh are half a pixel off at most: some 30 cm at 300 m.
        let on =
            triangles.iter().filter(|t| t.object + 1 == object && is_on(&t.corners, rest, 0.4)).collect::<Vec<_>>();
        assert!(object == 0 || !on.is_empty(), "pixel {i}: {place} of {object} was at {rest}");
        moved += usize::from((place - rest).length() > 1.0);
        let cofactor = veduta::geom::deform::cofactor(&deformers.jacobian(rest));
        let normal = DVec3::from(after.normal.as_ref().unwrap()[i].map(f64::from));
        let expected = on.iter().map(|t| (cofactor * normal_of(&t.corners)).normalize_or_zero());
        // As the mesh and the target have it: of two sides the one towards the eye.
        let apart = expected.map(|n| n.dot(normal).abs().min(1.0).acos()).fold(f64::INFINITY, f64::min);
        turned += usize::from(object != 0 && apart < 0.03);
    }
    assert!(moved > 500 && turned > 500, "{moved} places are moved, {turned} normals turned as they should be");
}

fn normal_of([a, b, c]: &[DVec3; 3]) -> DVec3 {
    (*b - *a).cross(*c - *a).normalize_or_zero()
}

/// Whether a place is within so many metres of a triangle's plane, and of the triangle in it.
fn is_on(corners: &[DVec3; 3], place: DVec3, metres: f64) -> bool {
    let normal = normal_of(corners);
    let beside = |i: usize| {
        let [from, to] = [corners[i], corners[(i + 1) % 3]];
        normal.cross(to - from).normalize_or_zero().dot(place - from) > -metres
    };
    normal != DVec3::ZERO && normal.dot(place - corners[0]).abs() < metres && (0..3).all(beside)
}

#[test]
fn what_is_wrong_with_a_deformation_is_told() {
    let town = Town::new();
    let said = |rest: &str| town.scene(&town.pond(rest)).expect_err("it is wrong");
    let message = said("deform = [{ kind = \"riple\" }]");
    assert!(message.contains("did you mean \"ripple\"?"), "{message}");
    let message = said("deform = [{ kind = \"ripple\", hight = 3.0 }]");
    assert!(message.contains("\"ripple\" has no such parameter; did you mean \"height\"?"), "{message}");
    let message = said("deform = [{ kind = \"ripple\", height = 3000.0 }]");
    assert!(message.contains("height") && message.contains("must be a number 0 to 100, is 3000"), "{message}");
}

#[test]
fn a_handler_in_another_place_is_told_where_it_belongs() {
    let town = Town::new();
    let ball = format!("shape = {{ kind = \"sphere\", center = {}, radius = 9.0 }}", town.point(town.at));
    for (name, place) in [
        ("ripple", "a deformation"),
        ("torus", "a region test"),
        ("tabletop", "a transform"),
        ("swirl", "a ray"),
        ("tours", "no effect"),
    ] {
        let error = town.scene(&format!("[[lens]]\n{ball}\neffects = [\"{name}\"]\n")).expect_err("it is no effect");
        assert!(error.contains(place), "{error}");
    }
    assert!(effect::named().any(|handler| handler.name == "torus"), "people are told of it");
}

#[test]
fn a_deformation_that_is_written_anew_is_drawn_anew() {
    let mut town = Town::new();
    let text = documented("ripple").replace("\"ripple\"", "\"swell\"");
    effect::add("swell.wgsl", &text).unwrap();
    let scene = town.scene(&town.pond("deform = [{ kind = \"swell\", height = 4.0, spacing = 10.0 }]")).unwrap();
    let first = town.picture(&scene);
    // Its numbers and their places are the same; its text alone is another.
    effect::replace("swell.wgsl", &text.replace("p.height * wave", "-p.height * wave")).unwrap();
    town.studio.renderer.forget_shaders();
    let second = town.picture(&scene);
    assert!(first.rgba != second.rgba, "the old text is drawn");
    let mut fresh = Town::new();
    assert!(fresh.picture(&scene).rgba == second.rgba, "it is drawn as if it had always been so");
}

#[test]
fn a_deformation_that_folds_is_weakened_and_says_so() {
    let mut town = Town::new();
    let text = documented("ripple")
        .replace("\"ripple\"", "\"crumple\"")
        .replace("vec3f(0.0, 0.0, p.height * wave)", "vec3f(p.height * wave, 0.0, 0.0)");
    effect::add("crumple.wgsl", &text).unwrap();
    let scene = town.scene(&town.pond("deform = [{ kind = \"crumple\", height = 40.0, spacing = 10.0 }]")).unwrap();
    let picture = town.picture(&scene);
    let warnings = &picture.statistics.warnings;
    assert!(warnings.iter().any(|w| w["code"] == "deformation-weakened"), "{warnings:?}");
    // What is used of it folds nothing: its determinant is as large as is asked for wherever one looks.
    let deformers = town.studio.deformers(&scene, SIZE).unwrap();
    for i in 0..4000 {
        let around = DVec3::new(f64::from(i % 63) - 31.0, f64::from(i / 63) - 31.0, 0.4) * DVec3::new(4.7, 4.7, 1.0);
        let det = deformers.jacobian(town.at.with_z(1.0) + around).determinant();
        assert!(det > 0.15, "{det} at {around}");
    }
}

#[test]
fn optional_and_ignored_deformations_run_when_their_header_says() {
    let mut town = Town::new();
    for mode in ["optional", "ignore"] {
        let text = documented("ripple")
            .replace("\"ripple\"", &format!("\"{mode}-ripple\""))
            .replace("//! kind", &format!("//! mode = \"{mode}\"\n//! kind"));
        effect::add(&format!("{mode}.wgsl"), &text).unwrap();
    }
    let lens = |name: &str, kind: &str| {
        town.pond(&format!("deform = [{{ kind = \"{kind}\" }}]")).replace("\"pond\"", &format!("\"{name}\""))
    };
    let [plain, optional, ignored] = [lens("a", "ripple"), lens("b", "optional-ripple"), lens("c", "ignore-ripple")];
    let scene = |lenses: &[&String]| town.scene(&lenses.iter().map(|s| s.as_str()).collect::<String>()).unwrap();
    let scenes = [
        scene(&[&plain]),
        scene(&[&optional]),
        scene(&[&plain, &optional]),
        scene(&[&ignored]),
        scene(&[&ignored, &optional]),
    ];
    let still = Scene { lenses: vec![], ..scenes[0].clone() };
    let [plain, optional, both, ignored, rest] = scenes.map(|scene| town.drawn(&scene, Backend::Specialised).rgba);
    let still = town.drawn(&still, Backend::Specialised).rgba;
    assert!(plain != still && optional == plain && both == plain, "an optional one runs alone, and only then");
    assert!(ignored == still && rest == plain, "an ignored one never runs");
}

/// A region of the docs as a lens, and the same on the host.
fn ring(town: &Town, rest: &str) -> (String, OwnRegion) {
    let (center, size) = (town.at.with_z(12.0), DVec3::new(160.0, 160.0, 60.0));
    let shape = format!(
        "{{ kind = \"torus\", center = {}, size = [160.0, 160.0, 60.0], rotation_deg = [20.0, 10.0, 5.0], thickness = 40.0 }}",
        town.point(center)
    );
    let text = format!("[[lens]]\nname = \"ring\"\nshape = {shape}\n{rest}\n");
    let scene = town.scene(&text).unwrap();
    let Region::Own { used, rotation, .. } = &scene.lenses[0].shapes[0] else { panic!("a region of a user's") };
    (text, OwnRegion::new(used, center, size, *rotation, &Motion::NONE).unwrap())
}

/// How far a test may be off: 8 · 2⁻²³ of the distance, and as much for what the function itself computes in f32.
const SLACK_M: f64 = 16.0 * 400.0 / 8_388_608.0;

#[test]
fn a_region_of_the_docs_holds_what_it_says_on_both_back_ends() {
    let mut town = Town::new();
    let (text, region) = ring(&town, "effects = [\"greyscale\"]\nbody = \"none\"");
    let scene = town.scene(&text).unwrap();
    let picture = town.picture(&scene);
    let view = View::new(town.camera, SIZE, &Aabb::EMPTY).unwrap();
    let inside = bits(&picture, 0);
    let (mut shown, mut doubtful) = (0, 0);
    for (i, place) in places(&picture, &view).into_iter().enumerate() {
        let away = place.map_or(f64::INFINITY, |place| region.distance(place));
        let slack = SLACK_M + place.map_or(0.0, |place| off_face(&view, view.depth(place)));
        if away.abs() > slack {
            assert_eq!(inside[i], away < 0.0, "pixel {i}: {away} m");
        }
        doubtful += usize::from(away.abs() <= slack);
        shown += usize::from(inside[i]);
    }
    assert!(shown > 3000 && doubtful < 200, "{shown} pixels inside, {doubtful} in doubt");
    // Written and read again it is the same.
    let again = veduta::figure::scene_file::to_toml(&scene);
    assert!(again.contains("kind = \"torus\"") && again.contains("thickness = 40"), "{again}");
    let figures = &picture.statistics.lenses[0];
    assert!(figures.objects > 3, "{} objects", figures.objects);
}

#[test]
fn a_region_of_the_docs_goes_with_all_that_lenses_have() {
    let mut town = Town::new();
    let plain = town.scene("").unwrap();
    let bare = town.picture(&plain).rgba;
    // What lies in front of it, behind it and beside it; glass, glow, a soft border; holes with sections; in combinations.
    let rests = [
        "effects = [{ effect = \"greyscale\", class = \"front\" }]",
        "effects = [{ effect = \"sepia\", class = \"behind\" }, { effect = \"invert\", class = \"rest\" }]",
        "effects = [\"greyscale\"]\nbody = \"shell\"",
        "effects = [\"greyscale\"]\nbody = \"halo\"",
        "effects = [\"greyscale\"]\nborder = { width = 12.0 }",
        "effects = [\"eraser\"]\nsection = \"#c04020\"",
        "effects = [\"transparent\"]",
        "kind = \"content\"\ncontent = { derive = \"box\" }",
    ];
    let sun = |mut scene: Scene| {
        scene.sun.shadows = true;
        scene
    };
    for rest in rests {
        let (text, _) = ring(&town, rest);
        let scene = sun(town.scene(&text).unwrap_or_else(|error| panic!("{rest}: {error}")));
        let picture = town.picture(&scene);
        assert!(picture.rgba != bare, "{rest}: nothing is seen of it");
    }
    let (_, region) = ring(&town, "");
    let ball = format!("{{ kind = \"sphere\", center = {}, radius = 60.0 }}", town.point(town.at.with_z(12.0)));
    let (own, _) = ring(&town, "");
    let own = own.lines().find_map(|line| line.strip_prefix("shape = ")).unwrap().to_owned();
    let text = format!(
        "[[lens]]\nname = \"part\"\nshape = {{ kind = \"difference\", shapes = [{own}, {ball}] }}\neffects = [\"greyscale\"]\nbody = \"shell\"\n"
    );
    let scene = town.scene(&text).unwrap();
    let picture = town.picture(&scene);
    let view = View::new(town.camera, SIZE, &Aabb::EMPTY).unwrap();
    let inside = bits(&picture, 0);
    for (i, place) in places(&picture, &view).into_iter().enumerate() {
        let Some(place) = place else { continue };
        let away = region.distance(place).max(60.0 - place.distance(town.at.with_z(12.0)));
        let slack = SLACK_M + off_face(&view, view.depth(place));
        assert!(away.abs() <= slack || inside[i] == (away < 0.0), "pixel {i}: {away} m");
    }
}

#[test]
fn what_a_region_cannot_do_is_told() {
    let mut town = Town::new();
    let (text, _) = ring(&town, "effects = [\"greyscale\"]\nsprite = {}");
    let request = Request { aovs: ALL, statistics: true, ..Request::plain(SIZE) };
    let scene = town.scene(&text).unwrap();
    let error = town.studio.render(&scene, &request).expect_err("it has no sprite").to_string();
    assert!(error.contains("a region of your own is tested by its function, not by a depth sprite"), "{error}");
    let error = town.scene(&text.replace("torus", "tours")).expect_err("there is none");
    assert!(error.contains("did you mean \"torus\"?"), "{error}");
    let error = town.scene(&text.replace("thickness = 40.0", "thicknes = 40.0")).expect_err("no such parameter");
    assert!(error.contains("\"torus\" has no such parameter; did you mean \"thickness\"?"), "{error}");
    let error = town.scene(&text.replace("size = [160.0, 160.0, 60.0], ", "")).expect_err("no size");
    assert!(error.contains("size: is missing"), "{error}");
}

#[test]
fn a_transform_of_the_docs_puts_a_model_where_it_says() {
    let mut town = Town::new();
    let [middle, foot] = [30.0, 0.0].map(|z| town.point(town.at.with_z(z)));
    let lens = |own: &str| {
        format!(
            "[[lens]]\nname = \"model\"\nkind = \"content\"\nshape = {{ kind = \"cylinder\", center = {middle}, radius = 50.0, height = 80.0 }}\ncontent = {{ from = {foot}, {own} }}\n"
        )
    };
    // A quarter of the size, turned by 90 degrees: the same as the program's own keys say.
    let own = lens("transform = { kind = \"tabletop\", turn = 90.0, times = 4.0, table = 0.0 }");
    let keys = lens("rotation_deg = [90.0, 0.0, 0.0], scale = 0.25");
    let [own, keys] = [own, keys].map(|lens| town.scene(&lens).unwrap());
    let [own, keys] = [own, keys].map(|scene| town.picture(&scene));
    let differ = own.rgba.iter().zip(&keys.rgba).filter(|(a, b)| a != b).count();
    // A cosine of 90 degrees in f64 is 6e-17 and not 0: edges may fall to the other side of a pixel's middle.
    assert!(differ < 20, "{differ} pixels differ");
    let text =
        documented("tabletop").replace("\"tabletop\"", "\"squash\"").replace("small.z + p.table", "0.5 * small.z");
    effect::add("squash.wgsl", &text).unwrap();
    let scene = town.scene(&lens("transform = { kind = \"squash\" }")).unwrap();
    let request = Request { aovs: ALL, statistics: true, ..Request::plain(SIZE) };
    let error = town.studio.render(&scene, &request).expect_err("it squashes").to_string();
    assert!(
        error.contains("content.transform: \"squash\" does more than turn, move and scale alike along all axes"),
        "{error}"
    );
}

#[test]
fn two_contents_of_one_city_stand_where_each_says() {
    let mut town = Town::new();
    let lens = |name: &str, east: f64, own: &str| {
        format!(
            "[[lens]]\nname = \"{name}\"\nbody = \"none\"\nkind = \"content\"\nshape = {{ kind = \"sphere\", center = {}, radius = 30.0 }}\ncontent = {{ derive = \"box\"{own} }}\n\n",
            town.point(town.at.with_z(0.0) + DVec3::X * east),
        )
    };
    let moved = lens("b", 40.0, ", scale = 0.4");
    let [alone, both] = [moved.clone(), lens("a", -40.0, "") + &moved].map(|lenses| town.scene(&lenses).unwrap());
    let [alone, both] = [alone, both].map(|scene| town.picture(&scene));
    let inside = bits(&alone, 0);
    let differ = (0..inside.len()).filter(|&i| inside[i] && alone.rgba[i] != both.rgba[i]).count();
    let shown = inside.iter().filter(|is| **is).count();
    assert!(
        shown > 250 && differ == 0,
        "{differ} of {shown} pixels of the moved one are others beside the one that stands"
    );
}

/// A scene with a lens of a ray handler.
fn bent_by(town: &Town, ray: &str) -> Scene {
    town.scene(&format!("[[lens]]\nname = \"eddy\"\nbody = \"none\"\nkind = \"ray\"\nray = {{ {ray} }}\n")).unwrap()
}

/// Pixels whose objects differ.
fn differing(a: &Picture, b: &Picture) -> usize {
    let [a, b] = [a, b].map(|picture| picture.object_id.as_ref().unwrap());
    a.iter().zip(b).filter(|(a, b)| a != b).count()
}

#[test]
fn a_ray_of_the_docs_shows_what_it_says_on_both_back_ends() {
    let mut town = Town::new();
    let parallel = Camera { projection: Projection::Orthographic { height_m: 170.0 }, ..town.camera };
    for camera in [town.camera, parallel] {
        let scene = |ray: &str| Scene { camera: Some(camera), ..bent_by(&town, ray) };
        let rays = scene("center = [0.45, 0.55], radius = 0.4, bend = { kind = \"swirl\", turns = 0.6 }");
        let image = scene(
            "center = [0.45, 0.55], radius = 0.4, method = \"image\", fineness = 2, bend = { kind = \"swirl\", turns = 0.6 }",
        );
        let plain = Scene { camera: Some(camera), ..town.scene("").unwrap() };
        let view = View::new(camera, SIZE, &town.studio.extent()).unwrap();
        let sight = Sight::new(&town.studio, camera, SIZE);
        let [shown, looked_up, plain] = [rays, image, plain].map(|scene| town.picture(&scene));
        let half = view.half_extent();
        let (center, radius) = (DVec2::new(-0.1, -0.1) * half, 0.8 * half.y);
        let ids = shown.object_id.as_ref().unwrap();
        let (mut inside, mut wrong) = (0, 0);
        for (i, id) in ids.iter().enumerate() {
            // The handler's own words, in f64.
            let met = |pixel: DVec2| {
                let place = (sight.place(pixel) - center) / radius;
                let rest = (1.0 - place.length_squared()).max(0.0);
                let turned = DVec2::from_angle(std::f64::consts::TAU * 0.6 * rest * rest).rotate(place);
                sight.id(&sight.straight(center + radius * turned))
            };
            let pixel = sight.pixel(i);
            let from_rim = (sight.place(pixel) - center).length() / radius;
            if from_rim > 0.99 {
                continue;
            }
            inside += 1;
            // Sine and cosine of GPUs are right to 2^-11: a fifth of a pixel at most here.
            let around = (0..8).map(|k| 0.2 * DVec2::from_angle(f64::from(k) * std::f64::consts::FRAC_PI_4));
            wrong += usize::from(met(pixel) != *id && !around.map(|by| met(pixel + by)).any(|own| own == *id));
        }
        assert!(inside > 8_000 && wrong == 0, "{wrong} of {inside}");
        assert!(differing(&shown, &plain) > inside / 4, "{}", differing(&shown, &plain));
        // An image shows what the eye sees: with no way through a plane it is all there, but for texels of edges.
        assert!(differing(&shown, &looked_up) < inside / 50, "{}", differing(&shown, &looked_up));
        // Beside the lens nothing changes.
        let outside = |i: &usize| (sight.place(sight.pixel(*i)) - center).length() / radius > 1.01;
        assert!((0..ids.len()).filter(outside).all(|i| shown.rgba[i] == plain.rgba[i]), "beside the lens");
    }
}

#[test]
fn a_fisheye_in_ones_own_words_is_the_fisheye() {
    static ADDED: Once = Once::new();
    let page = include_str!("../../docs/effects.md");
    let body = page
        .split("```wgsl\n    let turn = p.angle")
        .nth(1)
        .and_then(|rest| rest.split("```").next())
        .expect("the page has it");
    let text = format!(
        "//! name = \"globe\"\n//! kind = \"ray\"\n//! spec = \"\"\n//! doc = \"\"\n//!\n//! [[parameter]]\n//! name = \"angle\"\n//! type = \"number\"\n\
         //! default = 1.0\n//! doc = \"\"\n\nfn effect(place: vec2f, size: vec3f, p: Parameters) -> vec3f {{\n    let turn = p.angle{body}}}\n"
    );
    ADDED.call_once(|| effect::add("globe.wgsl", &text).unwrap_or_else(|error| panic!("{error}")));
    let mut town = Town::new();
    let middle = town.at + DVec3::new(3.0, -20.0, 5.0);
    town.camera = Camera::looking(middle, middle + DVec3::new(-10.0, 40.0, 4.0), 0.9);
    let mut drawn = Vec::new();
    for method in ["rays", "image"] {
        let own = format!("radius = 0.45, method = \"{method}\", bend = {{ kind = \"globe\", angle = 2.4 }}");
        let fisheye = format!("radius = 0.45, method = \"{method}\", angle_deg = {}", 4.8_f64.to_degrees());
        let fisheye =
            format!("[[lens]]\nname = \"eddy\"\nbody = \"none\"\nkind = \"fisheye\"\nray = {{ {fisheye} }}\n");
        let scenes = [bent_by(&town, &own), town.scene(&fisheye).unwrap()];
        drawn.extend(scenes.map(|scene| town.picture(&scene)));
    }
    let [own, fisheye, own_image, fisheye_image] = &drawn[..] else { panic!("four of them") };
    // Its sines are those of the adapter, those of the fisheye are not.
    assert!(differing(own, fisheye) < 60, "{} pixels", differing(own, fisheye));
    // Images are wrong beside edges, and its own are as fine.
    let off = [(own, own_image), (fisheye, fisheye_image)].map(|(rays, image)| differing(rays, image));
    assert!(off[0] < 300 && off[0] <= off[1], "{off:?} pixels");
    let shown = own.object_id.as_ref().unwrap().iter().filter(|id| **id > 0).count();
    assert!(shown > 3000, "{shown}");
}

#[test]
fn a_lens_of_a_ray_handler_goes_with_others() {
    let mut town = Town::new();
    let eddy = "[[lens]]\nname = \"eddy\"\nkind = \"ray\"\nray = { radius = 0.4, grid = true, bend = { kind = \"swirl\", turns = 0.4 } }\n";
    let plain = town.scene(eddy).unwrap();
    let plain = town.picture(&plain).rgba;
    let ball = format!("shape = {{ kind = \"sphere\", center = {}, radius = 60.0 }}", town.point(town.at));
    for rest in [
        format!("[[lens]]\nname = \"a\"\n{ball}\neffects = [\"edges\"]\n"),
        format!("[[lens]]\nname = \"a\"\n{ball}\neffects = [\"transparent\"]\n"),
        "[[lens]]\nname = \"glass\"\nkind = \"magnifier\"\nray = { radius = 0.3 }\n".to_owned(),
        "[[lens]]\nname = \"other\"\nkind = \"ray\"\nray = { radius = 0.2, bend = { kind = \"swirl\", turns = -0.4 } }\n".to_owned(),
    ] {
        let scene = town.scene(&format!("{eddy}{rest}")).unwrap();
        assert!(town.picture(&scene).rgba != plain, "{rest}");
    }
}

#[test]
fn what_is_wrong_with_a_ray_handler_is_told() {
    let town = Town::new();
    let of =
        |ray: &str| town.scene(&format!("[[lens]]\nname = \"eddy\"\nkind = \"ray\"\n{ray}\n")).map(|_| ()).unwrap_err();
    for (ray, expected) in [
        ("", "ray.bend: is missing: a ray handler of your own"),
        ("ray = { radius = 0.2 }", "ray.bend: is missing: a ray handler of your own"),
        ("ray = { bend = { kind = \"swirk\" } }", "there is no handler \"swirk\"; did you mean \"swirl\"?"),
        ("ray = { bend = { kind = \"torus\" } }", "there is no handler \"torus\""),
        ("ray = { bend = { kind = \"swirl\", turns = 9 } }", "turns"),
        (
            "ray = { bend = { kind = \"swirl\" }, method = \"vertices\" }",
            "ray.method: does not go with a handler of your own",
        ),
        ("ray = { bend = { kind = \"swirl\" }, magnification = 2 }", "ray.magnification: has a meaning only"),
    ] {
        let message = of(ray);
        assert!(message.contains(expected), "{ray}\n  gave     {message}\n  expected {expected}");
    }
    // As it is written, so it is read.
    let scene = bent_by(&town, "radius = 0.3, bend = { kind = \"swirl\", turns = 0.75 }");
    let text = veduta::figure::scene_file::to_toml(&scene);
    assert!(text.contains("kind = \"swirl\"") && text.contains("turns = 0.75"), "{text}");
}
