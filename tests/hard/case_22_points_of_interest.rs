//! Case 22: points of interest behind the camera, in the plane of the eye, at the eye, far away and at infinity: every detection test has a
//! defined answer, which knows nothing of where one looks, and no number is NaN. Oracle: whether the box of an object is met,
//! by the definitions, in f64; the same lens looked through the other way.

use glam::DVec3;
use veduta::{
    figure::scene_file::{self, Options},
    lens::{Lens, Occluders, Region, kind::Occlusion},
    render::picture::Studio,
    scene::{Poi, PoiPlace, Scene},
    view::Camera,
    visibility::{Reference, Test},
};

use crate::studio;

const EYE: DVec3 = DVec3::new(-75.0, -110.0, 2.0);

fn tests() -> Vec<Test> {
    vec![
        Test::Exact { coverage: 0.0, rays: 64 },
        Test::Exact { coverage: 0.1, rays: 64 },
        Test::ViewAxis,
        Test::Spherical { radius: 60.0, reference: Reference::Nearest },
        Test::Cylindrical { radius: 60.0, up: DVec3::Z },
        Test::ViewerHeight { radius: 90.0, reference: Reference::Centre, up: DVec3::Z },
        Test::Ground { radius: 60.0 },
        Test::Not(Box::new(Test::All(vec![Test::ViewAxis, Test::Exact { coverage: 0.0, rays: 16 }]))),
    ]
}

/// Whom a lens finds that looks for a place from the eye towards `target`, with the shares they cover.
fn found(studio: &mut Studio, at: DVec3, test: &Test, target: DVec3) -> Vec<(String, Vec<String>, Option<[f64; 3]>)> {
    let of = Occluders { pois: vec!["it".into()], test: test.clone(), ..Occluders::default() };
    let plain = studio::lens("hides", [Region::Occluders(of)], "sepia");
    let lens = Lens { kind: Occlusion::default().into(), effects: vec![], ..plain };
    let pois = vec![Poi { name: "it".into(), place: PoiPlace::At(at) }];
    let scene = Scene { pois, ..studio::scene(Camera::looking(EYE, target, 0.8), vec![lens]) };
    let drawn = studio::picture(studio, &scene, [32, 24]);
    let depths = drawn.depth.expect("depths");
    assert!(depths.iter().all(|depth| *depth > 0.0), "a depth is no number");
    let list = drawn.statistics.lenses[0].occluders.clone().expect("occluders");
    let share = |c: veduta::render::stats::Coverage| [c.low, c.share, c.high];
    list.into_iter().map(|o| (o.id, o.why, o.coverage.map(share))).collect()
}

#[test]
fn every_test_has_an_answer_that_does_not_ask_where_one_looks() {
    let mut studio = studio::studio(&[studio::citydata("square.city.json")]);
    let ahead = DVec3::new(8.0, 12.0, 4.0);
    let forward = (ahead - EYE).with_z(0.0).normalize_or(glam::DVec3::X);
    let aside = DVec3::new(forward.y, -forward.x, 0.0);
    let places = [
        ahead,
        // Behind the eye; in its plane, aside and above; just off that plane; at the eye; at the horizon and beyond.
        EYE - 50.0 * forward,
        EYE + 150.0 * aside,
        EYE - 40.0 * DVec3::Z,
        EYE + 150.0 * aside + 1e-300 * forward,
        EYE,
        EYE + 1e6 * forward,
        EYE + 1e12 * forward,
        EYE + 1e300 * forward,
        DVec3::new(f64::INFINITY, 0.0, 0.0),
        DVec3::new(0.0, f64::NEG_INFINITY, f64::INFINITY),
    ];
    let mut hidden = 0;
    for at in places {
        for test in tests() {
            let towards = found(&mut studio, at, &test, ahead);
            let away = found(&mut studio, at, &test, EYE - (ahead - EYE));
            assert_eq!(towards, away, "{at} {test:?}");
            for share in towards.iter().filter_map(|o| o.2) {
                let [low, share, high] = share;
                assert!(0.0 <= low && low <= share && share <= high && high <= 1.0, "{at} {test:?}: {share}");
            }
            if test == Test::ViewAxis || matches!(test, Test::Exact { coverage, .. } if coverage == 0.0) {
                hidden += towards.len();
            }
            // At the eye nothing lies between; at infinity nothing is.
            if (at == EYE || !at.is_finite()) && matches!(test, Test::Exact { .. } | Test::ViewAxis) {
                assert_eq!(towards, [], "{test:?}");
            }
        }
        // Of a point, the axis goes through the box of whoever has a triangle on the sight line.
        let exact = found(&mut studio, at, &tests()[0], ahead);
        let axis: Vec<String> = found(&mut studio, at, &Test::ViewAxis, ahead).into_iter().map(|o| o.0).collect();
        for occluder in exact {
            assert!(axis.contains(&occluder.0), "{at}: {} is hit, its box is not", occluder.0);
        }
    }
    assert!(hidden > 10, "{hidden}");
}

#[test]
fn a_place_at_infinity_is_no_place_in_a_file() {
    for at in ["[inf, 0, 0]", "[0, nan, 0]", "[0, 0, 1e30]"] {
        let text = format!("veduta = 1\n[[poi]]\nname = \"it\"\nat = {at}\n");
        let refused = scene_file::parse(&text, "s", &Options::for_command_line()).unwrap_err().to_string();
        assert!(refused.contains("s:4: [poi.0] at: must be"), "{refused}");
    }
}
