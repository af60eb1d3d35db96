//! Deformation lenses in pictures: what is shown is what the operators say of the city at rest, pixel by pixel, and
//! nothing else changes.

use crate::studio::*;
use glam::{DVec2, DVec3};
use veduta::{
    figure::{
        self,
        overlays::Standing,
        scene_file::{Options, parse},
    },
    geom::deform::Deformers,
    render::{
        frame::Backend,
        picture::{Aovs, Picture, Request, Studio},
    },
    scene::Scene,
    view::View,
};

const SIZE: [u32; 2] = [640, 400];
/// How far what is shown may be from where it should be, pixels: edges a quarter, what is between them twice that; and by as much more as the inverse of
/// these steps stretches.
const OFF_PX: f64 = 0.75;

/// The built-in town from above, without shadows, with lenses.
fn town(lenses: &str) -> Scene {
    let text = format!(
        "veduta = 1\n[city]\nfiles = [\"builtin:town\"]\nground = false\n[camera]\neye = [-90, -140, 100]\ntarget = [0, 0, 10]\n\
         [sun]\nshadows = false\n{lenses}"
    );
    parse(&text, "s.toml", &Options::default()).unwrap_or_else(|error| panic!("{error}"))
}

/// A deformation lens over the middle of the town.
fn lens(steps: &str, rest: &str) -> String {
    format!(
        "[[lens]]\nname = \"moved\"\nkind = \"deformation\"\nbody = \"none\"\n\
         shape = {{ kind = \"box\", center = [5, 3, 20], size = [120, 90, 40], rotation_deg = [20, 0, 0] }}\ndeform = [{steps}]\n{rest}\n"
    )
}

const STEPS: [&str; 7] = [
    "{ kind = \"twist\", angle_deg = 50.0 }",
    "{ kind = \"taper\", factor = 0.6 }",
    "{ kind = \"bend\", angle_deg = 40.0 }",
    "{ kind = \"shear\", by = [0.4, -0.2] }",
    "{ kind = \"scale\", factors = [1.0, 1.0, 2.5] }",
    "{ kind = \"translate\", by = [0.0, 10.0, 25.0] }",
    "{ kind = \"scale\", factors = [0.8, 0.8, 1.5] }, { kind = \"twist\", angle_deg = -30.0 }",
];

fn request(backend: Backend) -> Request {
    Request { aovs: ALL, statistics: true, backend, ..Request::plain(SIZE) }
}

fn drawn(studio: &mut Studio, scene: &Scene) -> Picture {
    studio.render(scene, &request(Backend::default())).unwrap_or_else(|error| panic!("{error}"))
}

/// The nearest point of a triangle (Ericson, 5.1.5).
fn nearest(p: DVec3, [a, b, c]: [DVec3; 3]) -> DVec3 {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let (d1, d2) = (ab.dot(ap), ac.dot(ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return a;
    }
    let bp = p - b;
    let (d3, d4) = (ab.dot(bp), ac.dot(bp));
    if d3 >= 0.0 && d4 <= d3 {
        return b;
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return a + ab * (d1 / (d1 - d3));
    }
    let cp = p - c;
    let (d5, d6) = (ab.dot(cp), ac.dot(cp));
    if d6 >= 0.0 && d5 <= d6 {
        return c;
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return a + ac * (d2 / (d2 - d6));
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0 {
        return b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6)));
    }
    let sum = va + vb + vc;
    a + ab * (vb / sum) + ac * (vc / sum)
}

/// The places that pixels show, with the objects they are of; every `step`-th pixel.
fn shown(picture: &Picture, view: &View, step: usize) -> Vec<(DVec3, u32)> {
    let (depths, ids) = (picture.depth.as_ref().unwrap(), picture.object_id.as_ref().unwrap());
    let place = |i: usize| {
        let depth = f64::from(depths[i]);
        let (x, y) = (i as u32 % SIZE[0], i as u32 / SIZE[0]);
        let ray = view.pixel_ray(x, y);
        (depth.is_finite() && ids[i] > 0)
            .then(|| (ray.origin + ray.direction * (depth / ray.direction.dot(view.basis.forward)), ids[i] - 1))
    };
    (0..depths.len()).step_by(step).filter_map(place).collect()
}

/// How far the place at rest of what is shown is from its object's faces, at worst, pixels.
fn farthest(studio: &Studio, deformers: &Deformers, view: &View, shown: &[(DVec3, u32)]) -> f64 {
    let all = triangles(studio);
    let pixel_m = |place: DVec3| view.depth(place) * 2.0 * view.half_extent().y / f64::from(SIZE[1]);
    let off = |(place, object): &(DVec3, u32)| {
        let rest = deformers.inverse(*place).unwrap_or_else(|| panic!("{place} has a place at rest"));
        let own = all.iter().filter(|triangle| triangle.object == *object);
        let off = own.map(|triangle| nearest(rest, triangle.corners).distance(rest)).fold(f64::INFINITY, f64::min);
        off / pixel_m(*place)
    };
    shown.iter().map(off).fold(0.0, f64::max)
}

#[test]
fn pixels_show_what_the_operators_make_of_the_city_at_rest() {
    let mut studio = of_scene(&town(""));
    let still = town("");
    let before = drawn(&mut studio, &still);
    for steps in STEPS {
        let scene = town(&lens(steps, ""));
        let picture = drawn(&mut studio, &scene);
        let view = View::new(scene.camera.unwrap(), SIZE, &studio.extent()).unwrap();
        let deformers = studio.deformers(&scene, SIZE).unwrap();
        assert_eq!(deformers.0.len(), 1);
        let places = shown(&picture, &view, 29);
        let moved = places.iter().filter(|(p, _)| deformers.inverse(*p).unwrap().distance(*p) > 1.0).count();
        assert!(moved > 100, "{steps}: {moved} pixels show what was moved by more than a metre");
        let off = farthest(&studio, &deformers, &view, &places);
        assert!(off < OFF_PX, "{steps}: shown {off} pixels from where it should be");
        let changed = picture.rgba.iter().zip(&before.rgba).filter(|(a, b)| a != b).count();
        assert!(changed > 4000, "{steps}: {changed} pixels changed");
    }
}

#[test]
fn normals_are_those_of_what_is_shown() {
    let scene = town(&lens("{ kind = \"twist\", angle_deg = 70.0 }, { kind = \"scale\", factors = [1, 1, 2] }", ""));
    let mut studio = of_scene(&scene);
    let picture = drawn(&mut studio, &scene);
    let (depths, normals, ids) =
        (picture.depth.as_ref().unwrap(), picture.normal.as_ref().unwrap(), picture.object_id.as_ref().unwrap());
    let view = View::new(scene.camera.unwrap(), SIZE, &studio.extent()).unwrap();
    let at = |x: u32, y: u32| {
        let ray = view.pixel_ray(x, y);
        let depth = f64::from(depths[(y * SIZE[0] + x) as usize]);
        ray.origin + ray.direction * (depth / ray.direction.dot(view.basis.forward))
    };
    let (mut compared, mut wrong) = (0, 0);
    for y in 1..SIZE[1] - 1 {
        for x in 1..SIZE[0] - 1 {
            let i = (y * SIZE[0] + x) as usize;
            let around = [(x - 1, y), (x + 1, y), (x, y - 1), (x, y + 1)];
            if ids[i] == 0 || around.iter().any(|(x, y)| ids[(y * SIZE[0] + x) as usize] != ids[i]) {
                continue;
            }
            // Differences of places: where they go on straight, their cross product is the normal.
            let [left, right, up, down] = around.map(|(x, y)| at(x, y));
            let middle = at(x, y);
            let is_smooth = |a: DVec3, b: DVec3| (0.5 * (a + b)).distance(middle) < 0.02 * a.distance(b);
            if !is_smooth(left, right) || !is_smooth(up, down) {
                continue;
            }
            let Some(across) = (right - left).cross(up - down).try_normalize() else { continue };
            let own = DVec3::from(normals[i].map(f64::from));
            compared += 1;
            wrong += u32::from(across.dot(own).abs() < 0.97);
        }
    }
    assert!(compared > 20_000, "{compared}");
    assert!(f64::from(wrong) < 0.01 * f64::from(compared), "{wrong} of {compared} normals are others");
}

#[test]
fn what_no_deformation_reaches_stays_to_the_bit() {
    let mut studio = of_scene(&town(""));
    let before = drawn(&mut studio, &town(""));
    let nothing = [
        lens("{ kind = \"twist\", angle_deg = 0.0 }", ""),
        lens("{ kind = \"twist\", angle_deg = 50.0 }", "strength = 0.0"),
        lens("{ kind = \"twist\", angle_deg = 50.0 }", "enabled = false"),
        lens("{ kind = \"twist\", angle_deg = 50.0 }", "").replace("[5, 3, 20]", "[5000, 3, 20]"),
    ];
    for lens in nothing {
        let picture = drawn(&mut studio, &town(&lens));
        assert_eq!(picture.rgba, before.rgba, "{lens}");
        let bits = |picture: &Picture| picture.depth.as_ref().unwrap().iter().map(|d| d.to_bits()).collect::<Vec<_>>();
        assert_eq!((bits(&picture), &picture.object_id), (bits(&before), &before.object_id), "{lens}");
        assert_eq!(picture.normal, before.normal, "{lens}");
    }
    // Beside a lens that does something: whoever is not in it, and hidden by nobody who is, is where it was, and looks as it did. Not
    // to the bit, since a triangle that reaches into the lens has other corners, whose normals turn over its whole width.
    let scene = town(&lens("{ kind = \"twist\", angle_deg = 50.0 }", ""));
    let picture = drawn(&mut studio, &scene);
    let deformers = studio.deformers(&scene, SIZE).unwrap();
    let view = View::new(scene.camera.unwrap(), SIZE, &studio.extent()).unwrap();
    let is_still = |i: usize, of: &Picture| {
        let depth = f64::from(of.depth.as_ref().unwrap()[i]);
        let ray = view.pixel_ray(i as u32 % SIZE[0], i as u32 / SIZE[0]);
        let place = ray.origin + ray.direction * (depth / ray.direction.dot(view.basis.forward));
        !depth.is_finite() || deformers.supports().all(|support| !support.contains(place))
    };
    let (mut same, mut other) = (0, 0);
    for i in 0..picture.rgba.len() {
        if is_still(i, &picture) && is_still(i, &before) {
            let [own, was] = [&picture, &before].map(|of| of.depth.as_ref().unwrap()[i]);
            let is_there = own == was || (own - was).abs() < 1e-4 * was;
            let is_alike = (0..3).all(|c| picture.rgba[i][c].abs_diff(before.rgba[i][c]) <= 1);
            if is_there && is_alike { same += 1 } else { other += 1 }
        }
    }
    assert!(same > 80_000, "{same}");
    assert!(other * 200 < same, "{other} of {same} pixels beside the lens are others");
}

#[test]
fn only_what_meets_a_lens_is_refined() {
    let scene = town(&lens("{ kind = \"twist\", angle_deg = 50.0 }", ""));
    let mut studio = of_scene(&scene);
    let picture = drawn(&mut studio, &scene);
    let deformed = picture.statistics.frame.deformed.expect("something is deformed");
    let deformers = studio.deformers(&scene, SIZE).unwrap();
    // The support is the box without top and base; a triangle meets it if the separating axes in plan find no gap.
    let frame = deformers.0[0].support().frame;
    let half = DVec2::new(60.0, 45.0);
    let meets = |corners: &[DVec3; 3]| {
        let own = corners.map(|corner| frame.from_world(corner).truncate());
        let axes = [DVec2::X, DVec2::Y].into_iter().chain((0..3).map(|i| (own[(i + 1) % 3] - own[i]).perp()));
        axes.filter(|axis| axis.length() > 1e-9).all(|axis| {
            let reach = half.x * axis.x.abs() + half.y * axis.y.abs();
            let along = own.map(|p| p.dot(axis));
            let (low, high) = along.iter().fold((f64::MAX, f64::MIN), |(l, h), v| (l.min(*v), h.max(*v)));
            low <= reach && high >= -reach
        })
    };
    let expected = triangles(&studio).iter().filter(|triangle| meets(&triangle.corners)).count() as u64;
    assert_eq!(deformed.met, expected);
    assert!(deformed.triangles > deformed.met && deformed.coarse == 0);
    assert!(picture.statistics.frame.deformed.is_some());
    assert!(drawn(&mut studio, &town("")).statistics.frame.deformed.is_none());
}

#[test]
fn masks_and_erasers_go_by_what_is_shown() {
    let others = "[[lens]]\nname = \"ball\"\nshape = { kind = \"sphere\", center = [10, 5, 30], radius = 22 }\neffects = [\"sepia\"]\n\
                  [[lens]]\nname = \"gone\"\nshape = { kind = \"sphere\", center = [-20, -15, 20], radius = 14 }\neffects = [\"eraser\"]\n";
    let scene = town(&format!("{}{others}", lens(STEPS[6], "")));
    let mut studio = of_scene(&scene);
    let picture = drawn(&mut studio, &scene);
    let view = View::new(scene.camera.unwrap(), SIZE, &studio.extent()).unwrap();
    for index in [1, 2] {
        assert_eq!(wrong_pixels(&picture, &view, &scene.lenses[index], index), 0, "lens {index}");
    }
    assert!(bits(&picture, 1).iter().filter(|bit| **bit).count() > 1200);
    assert_eq!(bits(&picture, 2).iter().filter(|bit| **bit).count(), 0, "what is erased is not shown");
    let deformers = studio.deformers(&scene, SIZE).unwrap();
    assert!(farthest(&studio, &deformers, &view, &shown(&picture, &view, 43)) < OFF_PX);
}

#[test]
fn both_back_ends_and_a_second_picture_are_the_same() {
    let effects = "[[lens]]\nname = \"lines\"\nshape = { kind = \"sphere\", center = [10, 5, 30], radius = 30 }\neffects = [\"hidden-line\"]\n\
                   [[lens]]\nname = \"glass\"\nshape = { kind = \"sphere\", center = [-30, 15, 20], radius = 25 }\neffects = [\"x-ray\"]\n";
    let scene = town(&format!("{}{effects}", lens(STEPS[0], "")));
    let mut studio = of_scene(&scene);
    let [first, second, uber] = [Backend::Specialised, Backend::Specialised, Backend::Uber]
        .map(|backend| studio.render(&scene, &request(backend)).unwrap_or_else(|error| panic!("{error}")));
    assert_eq!(first.rgba, second.rgba);
    assert_eq!(first.rgba, uber.rgba);
    assert_eq!(first.object_id, uber.object_id);
}

#[test]
fn what_would_fold_is_weakened_and_told() {
    // A bend of 40 m by 400 degrees folds what is higher than 5.7 m.
    let scene = town(
        "[[lens]]\nname = \"too much\"\nkind = \"deformation\"\nshape = { kind = \"box\", center = [0, 0, 20], size = [60, 40, 40] }\n\
         deform = [{ kind = \"bend\", angle_deg = 400.0 }]\n",
    );
    let mut studio = of_scene(&scene);
    let picture = drawn(&mut studio, &scene);
    let warnings = &picture.statistics.warnings;
    let told = warnings.iter().find(|warning| warning["code"] == "deformation-weakened").expect("a warning");
    let used = told["count"].as_u64().unwrap();
    assert!((1..1000).contains(&used), "{told}");
    let deformers = studio.deformers(&scene, SIZE).unwrap();
    let extent = studio.extent();
    for n in 0..20_000 {
        let part = [0.618_034, 0.754_878, 0.569_840].map(|step: f64| (step * f64::from(n)).fract());
        let place = extent.min + DVec3::from(part) * extent.size();
        assert!(deformers.jacobian(place).determinant() > 0.0, "{place}");
    }
    let asked = Aovs { depth: true, ..Aovs::default() };
    let again = studio.render(&scene, &Request { aovs: asked, ..request(Backend::default()) }).unwrap();
    assert!(again.depth.unwrap().iter().all(|depth| !depth.is_nan()));
}

#[test]
fn lines_of_overlays_end_where_their_places_are_shown() {
    let place = DVec3::new(12.0, -5.0, 24.0);
    let overlay = "[[poi]]\nname = \"p\"\nat = [12, -5, 24]\n[[lens]]\nname = \"note\"\nkind = \"annotation\"\ntext = \"here\"\npoi = \"p\"\n";
    let scene = town(&format!("{}{overlay}", lens("{ kind = \"translate\", by = [0, 6, 20] }", "")));
    let mut studio = of_scene(&scene);
    let mut standing = Standing::default();
    figure::draw_next(&mut studio, &scene, &request(Backend::default()), &mut standing).unwrap();
    let view = View::new(scene.camera.unwrap(), SIZE, &studio.extent()).unwrap();
    let shown = studio.deformers(&scene, SIZE).unwrap().value(place);
    assert!(shown.distance(place) > 15.0, "it is moved");
    let line = &standing.of_picture().unwrap().lines[0];
    let end = *line.points.last().unwrap();
    assert!(end.distance(view.pixel(shown).unwrap().truncate()) < 0.01, "{end}");
}

#[test]
fn lenses_of_the_city_at_rest_go_with_the_houses() {
    let others = "[[lens]]\nname = \"ball\"\nspace = \"rest\"\nshape = { kind = \"sphere\", center = [10, 5, 10], radius = 22 }\neffects = [\"sepia\"]\n\
                  [[lens]]\nname = \"box\"\nspace = \"rest\"\nshape = { kind = \"box\", center = [-25, -15, 20], size = [20, 30, 50] }\neffects = [\"invert\"]\n";
    let scene = town(&format!("{}{others}", lens(STEPS[6], "")));
    let mut studio = of_scene(&scene);
    let picture = drawn(&mut studio, &scene);
    let view = View::new(scene.camera.unwrap(), SIZE, &studio.extent()).unwrap();
    let deformers = studio.deformers(&scene, SIZE).unwrap();
    let depths = picture.depth.as_ref().unwrap();
    for (index, size_m) in [(1, 44.0), (2, 50.0)] {
        let volume = scene.lenses[index].shapes[0].volumes().unwrap().remove(0);
        let bits = bits(&picture, index);
        let (mut inside, mut moved, mut wrong) = (0, 0, 0);
        for (i, depth) in depths.iter().enumerate().filter(|(_, depth)| depth.is_finite()) {
            let ray = view.pixel_ray(i as u32 % SIZE[0], i as u32 / SIZE[0]);
            let place = ray.origin + ray.direction * (f64::from(*depth) / ray.direction.dot(view.basis.forward));
            let rest = deformers.inverse(place).unwrap();
            // The moved body is right to a thousandth of its size, and round ones have 96 sides; as these steps stretch.
            let away = volume.signed_distance(rest);
            if away.abs() < 4.0 * size_m / 1000.0 {
                continue;
            }
            inside += u32::from(away < 0.0);
            moved += u32::from(away < 0.0 && volume.signed_distance(place) > 0.5);
            wrong += u32::from(bits[i] != (away < 0.0));
        }
        assert_eq!(wrong, 0, "lens {index}");
        assert!(inside > 400 && moved > 60, "lens {index}: {inside} pixels inside, {moved} of them only at rest");
    }
    // Without a deformation it is as it was.
    let still = town(others);
    let displayed = town(&others.replace("space = \"rest\"\n", ""));
    assert_eq!(drawn(&mut studio, &still).rgba, drawn(&mut studio, &displayed).rgba);
}

/// How far what is shown of each object is from its faces of another height, at worst, pixels; each object's factor.
fn farthest_raised(studio: &Studio, scene: &Scene, view: &View, shown: &[(DVec3, u32)]) -> f64 {
    let moved = studio.moved(scene, SIZE).unwrap();
    let all = triangles(studio);
    let pixel_m = |place: DVec3| view.depth(place) * 2.0 * view.half_extent().y / f64::from(SIZE[1]);
    let off = |(place, object): &(DVec3, u32)| {
        let own = all.iter().filter(|triangle| triangle.object == *object);
        let raised = own.map(|triangle| triangle.corners.map(|corner| moved.place(Some(*object), corner)));
        let off = raised.map(|corners| nearest(*place, corners).distance(*place)).fold(f64::INFINITY, f64::min);
        off / pixel_m(*place)
    };
    shown.iter().map(off).fold(0.0, f64::max)
}

#[test]
fn heights_go_by_a_number_of_objects() {
    let scene = town(
        "[[lens]]\nname = \"young\"\nkind = \"deformation\"\nstrength = 0.5\n\
         deform = [{ kind = \"heights\", attribute = \"yearOfConstruction\", from = [1950, 2000], to = [0.5, 3.0] }]\n",
    );
    let mut studio = of_scene(&scene);
    let picture = drawn(&mut studio, &scene);
    let view = View::new(scene.camera.unwrap(), SIZE, &studio.extent()).unwrap();
    let moved = studio.moved(&scene, SIZE).unwrap();
    let model = studio.model.clone();
    let name = model.strings.find("yearOfConstruction").unwrap();
    let mut changed = 0;
    for object in 0..model.objects.len() as u32 {
        let year = match model.attribute(object, name) {
            Some(veduta::city::Value::Integer(year)) => Some(year as f64),
            _ => None,
        };
        let full = year.map_or(1.0, |year| 0.5 + 2.5 * ((year - 1950.0) / 50.0).clamp(0.0, 1.0));
        let factor = moved.heights.of(object).map_or(1.0, |height| height.factor);
        assert!((factor - (1.0 + 0.5 * (full - 1.0))).abs() < 1e-12, "{object}: {year:?} {factor}");
        changed += u32::from(factor != 1.0);
    }
    assert!(changed > 300, "{changed}");
    let places = shown(&picture, &view, 17);
    assert!(farthest_raised(&studio, &scene, &view, &places) < OFF_PX);
    let figures = picture.statistics.frame.deformed.unwrap();
    assert_eq!(figures.met, figures.triangles, "what is only stretched is not split");
    let wrong = town(
        "[[lens]]\nkind = \"deformation\"\ndeform = [{ kind = \"heights\", attribute = \"yearOfConstruktion\", from = [0, 1], to = [1, 2] }]\n",
    );
    let error = studio.render(&wrong, &request(Backend::default())).map(|_| ()).unwrap_err().to_string();
    assert!(error.contains("lens.0") && error.contains("did you mean \"yearOfConstruction\""), "{error}");
}

#[test]
fn who_hides_a_point_of_interest_is_lowered_and_nobody_else() {
    let text = |lens: &str| {
        format!(
            "veduta = 1\n[city]\nfiles = [\"builtin:square\"]\n[camera]\neye = [14, -112, 15]\ntarget = [-56, -14, 13]\nfov_deg = 44\n\
             [sun]\nshadows = false\n[[poi]]\nname = \"church\"\nobject = \"church\"\n{lens}"
        )
    };
    let of = |text: String| parse(&text, "s.toml", &Options::default()).unwrap_or_else(|error| panic!("{error}"));
    let scene = of(text(
        "[[lens]]\nname = \"low\"\nkind = \"deformation\"\ndeform = [{ kind = \"lower\", poi = \"church\", factor = 0.1 }]\n",
    ));
    let plain = of(text(""));
    let mut studio = of_scene(&scene);
    let [lowered, before] = [&scene, &plain].map(|scene| drawn(&mut studio, scene));
    let model = studio.model.clone();
    let roots = model.roots();
    let church = model.find_object("church").unwrap();
    let is_church = |id: &&u32| **id > 0 && (**id - 1 == church || roots[(**id - 1) as usize] == church);
    let count = |picture: &Picture| picture.object_id.as_ref().unwrap().iter().filter(is_church).count();
    let [seen, was] = [&lowered, &before].map(count);
    // Were nothing in the way: the reference takes it away.
    let alone = of(text(
        "[[lens]]\nname = \"gone\"\nkind = \"occlusion\"\npoi = \"church\"\ntest = { kind = \"exact\" }\nrender = \"discard\"\n",
    ));
    let whole = count(&drawn(&mut studio, &alone));
    assert!(was < seen && seen as f64 > 0.9 * whole as f64, "{was} of {whole} pixels before, {seen} now");
    let shares = |picture: &Picture| picture.statistics.lenses[0].seen.clone().unwrap().remove(0);
    let share = |seen: usize, whole: usize| Some(seen as f64 / whole as f64);
    let told = shares(&lowered);
    assert_eq!((&*told.poi, told.share, told.at_rest), ("church", share(seen, whole), share(was, whole)));
    // The whole is what the church is where it is shown, too: here leaning to the side, and twice as large.
    let leaning = "[[lens]]\nname = \"leaning\"\nkind = \"deformation\"\nshape = { kind = \"box\", center = [-56, -14, 20], size = [120, 120, 40] }\n\
                   control = \"everywhere\"\ndeform = [{ kind = \"scale\", factors = [2, 2, 2] }, { kind = \"shear\", by = [0.3, 0.2] }]\n";
    let [leaning, alone] = [&scene, &alone].map(|other| {
        let both = of(text(leaning));
        let scene = Scene { lenses: other.lenses.iter().chain(&both.lenses).cloned().collect(), ..other.clone() };
        drawn(&mut studio, &scene)
    });
    let [seen, large] = [&leaning, &alone].map(count);
    assert!(large > 2 * whole, "{whole} pixels, and {large} of what is larger");
    assert_eq!(shares(&leaning).share, share(seen, large));
    assert_eq!(shares(&leaning).at_rest, share(was, whole));
    // Whom the test finds in the city at rest, and no other.
    let found: Vec<String> =
        lowered.statistics.lenses[0].occluders.clone().unwrap().into_iter().map(|o| o.id).collect();
    let moved = studio.moved(&scene, SIZE).unwrap();
    let mut lower = 0;
    for object in 0..model.objects.len() as u32 {
        let is_found = found.iter().any(|id| **id == *model.objects[roots[object as usize] as usize].id);
        match moved.heights.of(object) {
            Some(height) => {
                assert!(is_found && (height.factor - 0.1).abs() < 1e-12, "{}", model.objects[object as usize].id);
                lower += 1;
            }
            None => assert!(!is_found || model.objects[object as usize].geometries.is_empty()),
        }
    }
    assert!(lower >= 5, "{lower}");
    let view = View::new(scene.camera.unwrap(), SIZE, &studio.extent()).unwrap();
    assert!(farthest_raised(&studio, &scene, &view, &shown(&lowered, &view, 31)) < OFF_PX);
}

#[test]
fn edges_are_as_near_as_is_asked_for() {
    let mut studio = of_scene(&town(""));
    let mut triangles = Vec::new();
    for chord_px in [2.0, 0.5, 0.125] {
        let mut scene = town(&lens(STEPS[6], ""));
        scene.style.chord_px = chord_px;
        let picture = drawn(&mut studio, &scene);
        let deformed = picture.statistics.frame.deformed.unwrap();
        assert_eq!((deformed.tolerance_px, deformed.coarse), (chord_px, 0));
        let [median, worst] = studio.renderer.chords().unwrap().unwrap();
        assert!(worst <= 1.05 * chord_px && median > 0.05 * worst, "{chord_px}: {median} {worst}");
        triangles.push(deformed.triangles);
    }
    assert!(triangles[0] < triangles[1] && triangles[1] < triangles[2], "{triangles:?}");
}
