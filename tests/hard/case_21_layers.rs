//! Case 21, translucent layers: straight up and down, fields of view at their limits, pictures of one pixel, lenses of no size. Oracle: a
//! cube has two layers from outside and one from inside, whatever the view; what is no lens changes nothing.

use glam::DVec3;
use veduta::{
    geom::Shape,
    lens::{Class, Lens},
    render::{
        frame::Backend,
        picture::{Aovs, Request, Studio},
    },
    scene::{Scene, Transparency},
    view::{Camera, MAX_FOV, MIN_FOV},
};

use crate::{
    bodies::{METHODS, ORIGIN, block, layers_by_all, studio_of, translucent},
    studio,
};

/// A cube of 10 m.
fn cube() -> Studio {
    studio_of(&[block([0; 3], [10_000; 3])])
}

#[test]
fn a_cube_has_two_layers_from_outside_and_one_from_inside_in_every_view() {
    let mut studio = cube();
    let center = ORIGIN + DVec3::splat(5.0);
    let off = DVec3::new(0.31, -0.17, 0.0);
    for size in [[1, 1], [48, 36], [1, 40], [3, 1]] {
        for way in [-DVec3::Z, DVec3::Z, DVec3::Y, DVec3::new(1.0, -2.0, 1e-9)] {
            // The smallest field of view from 10 km: 2 m of it; the largest from within.
            let outside = Camera { projection: perspective(MIN_FOV), ..looking(center + off - 10_000.0 * way, way) };
            let found = layers_by_all(&mut studio, outside, size);
            assert!(found.iter().all(|count| *count == 2), "from outside along {way}, {size:?}: {found:?}");
            let parallel = studio::orthographic(center + off - 300.0 * way, center + off, 3.0);
            let found = layers_by_all(&mut studio, Camera { up: way, ..parallel }, size);
            // Up along the view is as good as any.
            assert!(found.iter().all(|count| *count == 2), "in parallel along {way}, {size:?}: {found:?}");
            for fov_y in [MIN_FOV, 1.0, MAX_FOV] {
                let inside = Camera { projection: perspective(fov_y), near_m: 1e-3, ..looking(center + off, way) };
                let found = layers_by_all(&mut studio, inside, size);
                assert!(found.iter().all(|count| *count == 1), "from inside along {way}, {fov_y}, {size:?}: {found:?}");
            }
        }
    }
}

fn perspective(fov_y: f64) -> veduta::view::Projection {
    veduta::view::Projection::Perspective { fov_y }
}

fn looking(eye: DVec3, way: DVec3) -> Camera {
    Camera::looking(eye, eye + way, 1.0)
}

fn shown(studio: &mut Studio, scene: &Scene, backend: Backend) -> (Vec<[u8; 4]>, Vec<u32>, Vec<u32>) {
    let aovs = Aovs { depth: true, object_id: true, ..Aovs::default() };
    let request = Request { samples: 2, aovs, backend, ..Request::plain([64, 48]) };
    let picture = studio.render(scene, &request).expect("a picture");
    let depth = picture.depth.expect("depths").iter().map(|d| d.to_bits()).collect();
    (picture.rgba, picture.object_id.expect("ids"), depth)
}

#[test]
fn see_through_lenses_of_no_size_change_nothing_and_methods_agree_in_extreme_views() {
    let mut studio = studio::synthetic(40);
    let center = studio.extent().center().with_z(studio.extent().min.z + 3.0);
    let clear = |shape: Shape, class| {
        let used = veduta::lens::EffectUse { class, ..studio::used("x-ray") };
        Lens { effects: vec![used], ..studio::lens("lens", vec![shape], "eraser") }
    };
    let down = looking(center + 60.0 * DVec3::Z, -DVec3::Z);
    let up = Camera { near_m: 0.01, ..looking(center, DVec3::Z) };
    let wide = Camera { projection: perspective(MAX_FOV), ..down };
    for (what, camera) in [("down", down), ("up", up), ("wide", wide)] {
        let plain = shown(&mut studio, &studio::scene(camera, vec![]), Backend::Specialised);
        for backend in [Backend::Specialised, Backend::Uber] {
            for shape in [
                Shape::Sphere { center, radius: 0.0 },
                Shape::Box { center, size: DVec3::new(0.0, 30.0, 30.0), rotation: glam::DQuat::IDENTITY },
                Shape::Cylinder { center, radius: 20.0, height: 0.0, axis: DVec3::Z },
            ] {
                let scene = studio::scene(camera, vec![clear(shape.clone(), Class::Inside)]);
                assert!(shown(&mut studio, &scene, backend) == plain, "{what} {backend:?} {shape:?}");
            }
        }
        // Of a lens with a size, and of all that is there: the same bytes by both back ends, and by methods that lay all layers.
        let sphere = Shape::Sphere { center, radius: 25.0 };
        let of_lens = studio::scene(camera, vec![clear(sphere, Class::Rest)]);
        for scene in [of_lens, translucent(camera, 0.3, Transparency::Exact)] {
            let exact = shown(&mut studio, &scene, Backend::Specialised);
            assert!(exact != plain || what == "up", "{what}: something is seen through");
            for method in METHODS {
                let mut own = scene.clone();
                own.style.transparency = method;
                let [one, other] = [Backend::Specialised, Backend::Uber].map(|b| shown(&mut studio, &own, b));
                assert!(one == other, "{what} {method:?}: both back ends");
                let lays_all = matches!(method, Transparency::Exact | Transparency::Peel { .. });
                assert!(!lays_all || one == exact, "{what} {method:?}");
            }
        }
    }
}
