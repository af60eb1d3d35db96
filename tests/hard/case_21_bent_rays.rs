//! Case 21, lenses that bend rays: straight up and down, fields of view at their limits, pictures of one pixel, lenses of no size, larger than the picture, at its
//! corner, with extreme numbers: a defined picture, the same bytes by both back ends, and again. Oracle: byte equality.

use glam::{DVec2, DVec3};
use veduta::{
    lens::{
        Lens,
        chosen::Choice,
        kind::{FeatureLens, FisheyeLens, SamplingLens},
        ray::{Bend, Feature, Fisheye, FisheyeProjection, RayLens, RayOutline, Sampling, SamplingRate},
    },
    render::{
        frame::Backend,
        picture::{Request, Studio},
    },
    scene::Scene,
    view::{Camera, MAX_FOV, MIN_FOV, Projection},
};

use crate::{
    case_27_bent_rays::{lens, magnifier, magnify},
    studio,
};

type Drawn = (Vec<[u8; 4]>, Vec<u32>, Vec<u32>);

fn drawn(studio: &mut Studio, scene: &Scene, size: [u32; 2], backend: Backend) -> Drawn {
    let request = Request { aovs: studio::ALL, backend, ..Request::plain(size) };
    let picture = studio.render(scene, &request).expect("a picture");
    let depths = picture.depth.expect("depths");
    assert!(depths.iter().all(|d| !d.is_nan() && *d >= 0.0), "depths are numbers");
    (picture.rgba, picture.object_id.expect("ids"), depths.iter().map(|d| d.to_bits()).collect())
}

fn extreme_lenses() -> Vec<(&'static str, Lens)> {
    let fisheye = |angle: f64, projection| {
        let bend = Bend::Fisheye(Fisheye { angle: angle.to_radians(), projection });
        lens(FisheyeLens { ray: RayLens { bend, ..RayLens::fisheye() } })
    };
    let of =
        |magnify: RayLens, center: [f64; 2], radius| magnifier(RayLens { center: center.into(), radius, ..magnify });
    let points = [[0.0, 1000.0], [1e-3, 0.01], [0.999, 1000.0], [1.0, 0.01]].map(DVec2::from).to_vec();
    let steep = Bend::Sample(Sampling { rate: SamplingRate::Points(points) });
    let RayLens { bend: Bend::Feature(Feature { magnify: own, .. }), .. } = RayLens::feature() else {
        panic!("a feature lens")
    };
    let all = Bend::Feature(Feature { magnify: own, of: Choice::default() });
    vec![
        ("of no size", of(magnify(3.0, 20.0, 20.0, 0.4), [0.5, 0.5], 1e-12)),
        ("larger than the picture", of(magnify(3.0, 20.0, 20.0, 0.4), [0.5, 0.5], 4.0)),
        ("at the corner", of(magnify(3.0, 20.0, 20.0, 0.4), [0.0, 1.0], 0.5)),
        ("a thousand times", of(magnify(1000.0, 20.0, 20.0, 0.0), [0.5, 0.5], 0.4)),
        ("a tenth", of(magnify(0.1, 20.0, 20.0, 1.0), [0.5, 0.5], 0.4)),
        ("at the eye", of(magnify(3.0, 1e-3, 1e-3, 0.4), [0.5, 0.5], 0.4)),
        ("far away", of(magnify(3.0, 1e6, 1e6, 0.4), [0.5, 0.5], 0.4)),
        ("square", magnifier(RayLens { outline: RayOutline::Square, ..magnify(3.0, 20.0, 1e-3, 1.0) })),
        ("all around", fisheye(360.0, FisheyeProjection::Angular)),
        ("hardly any", fisheye(1.0, FisheyeProjection::Hemispherical)),
        ("steep", lens(SamplingLens { ray: RayLens { bend: steep, ..RayLens::sampling() } })),
        ("a feature that is everything", lens(FeatureLens { ray: RayLens { bend: all, ..RayLens::feature() } })),
    ]
}

#[test]
fn bent_rays_in_extreme_views_are_the_same_by_both_back_ends() {
    let mut studio = studio::synthetic(20);
    let center = studio.extent().center().with_z(studio.extent().min.z + 3.0);
    let looking = |eye: DVec3, way: DVec3| Camera::looking(eye, eye + way, 1.0);
    let with = |camera: Camera, fov_y| Camera { projection: Projection::Perspective { fov_y }, ..camera };
    let down = looking(center + 60.0 * DVec3::Z, -DVec3::Z);
    let level = studio::orthographic(center + DVec3::new(0.0, -90.0, 0.0), center, 50.0);
    let views = [
        ("down", down, [48, 32]),
        ("up", Camera { near_m: 0.01, ..looking(center, DVec3::Z) }, [48, 32]),
        ("narrow", with(looking(center + 5000.0 * DVec3::Z, -DVec3::Z), MIN_FOV), [48, 32]),
        ("wide", with(down, MAX_FOV), [48, 32]),
        ("level", level, [48, 32]),
        ("up along the view", Camera { up: -DVec3::Z, ..down }, [33, 7]),
        ("one pixel", down, [1, 1]),
        ("a column", down, [1, 40]),
        ("a row", down, [40, 1]),
    ];
    let mut pictures = 0;
    for (v, (view, camera, size)) in views.into_iter().enumerate() {
        for (l, (what, lens)) in extreme_lenses().into_iter().enumerate() {
            // In an ordinary run each lens in two views or three, and each view with three lenses or four.
            if !studio::is_thorough() && (v + l) % 4 != 0 {
                continue;
            }
            let scene = studio::scene(camera, vec![lens]);
            let one = drawn(&mut studio, &scene, size, Backend::Specialised);
            let other = drawn(&mut studio, &scene, size, Backend::Uber);
            assert!(one == other, "{what}, {view}: back ends differ");
            assert!(one == drawn(&mut studio, &scene, size, Backend::Specialised), "{what}, {view}: not again");
            if what == "of no size" {
                let plain = drawn(&mut studio, &studio::scene(camera, vec![]), size, Backend::Specialised);
                assert!(one == plain, "{what}, {view}: something is changed");
            }
            pictures += 1;
        }
    }
    println!("{pictures} pictures");
    assert!(pictures > 20);
}

#[test]
fn rays_that_cross_are_told_of() {
    let mut studio = studio::synthetic(20);
    let camera =
        Camera::looking(studio.extent().center() + DVec3::new(0.0, -90.0, 60.0), studio.extent().center(), 1.0);
    let mut told = |border: f64| {
        let scene = studio::scene(
            camera,
            vec![magnifier(magnify(0.5, 40.0, 40.0, border)), magnifier(magnify(4.0, 40.0, 40.0, 0.2))],
        );
        let request = Request { statistics: true, ..Request::plain([32, 24]) };
        let picture = studio.render(&scene, &request).expect("a picture");
        let warnings = picture.statistics.warnings.iter().filter(|warning| warning["code"] == "rays-fold");
        warnings
            .map(|warning| (warning["count"].as_u64(), warning["objects"].as_array().map_or(0, Vec::len)))
            .collect::<Vec<_>>()
    };
    // Nothing is narrower than 1 / 0.5 - 1; of a half of that from 3/4 of the radius on things are turned round.
    assert_eq!(told(1.0), []);
    assert_eq!(told(0.5), [(Some(438), 1)]);
}
