//! Case 4: lenses cut by the near plane, the eye inside, on and outside, lenses wholly behind the eye: exact class for
//! every pixel; the same picture for near = 0.125 and 1 m where D > 1 m. Oracle: f64 entry and exit of the pixel's ray.

use glam::{DQuat, DVec3};
use veduta::{
    geom::{Aabb, Shape},
    render::picture::Studio,
    view::{Camera, View},
};

use crate::studio;

const SIZE: [u32; 2] = [160, 120];

fn eye(studio: &Studio) -> (DVec3, DVec3) {
    let bounds = studio.model.geometries[studio.geometries[studio.geometries.len() / 2] as usize].bounds;
    // Before the house, a metre and a half up, looking past it.
    let eye = DVec3::new(bounds.min.x - 9.0, bounds.min.y - 6.0, bounds.min.z + 1.6);
    (eye, bounds.center())
}

fn lenses(eye: DVec3, forward: DVec3) -> Vec<(&'static str, Shape)> {
    let turn = DQuat::from_rotation_z(0.3);
    let cube = |center, edge| Shape::Box { center, size: DVec3::splat(edge), rotation: turn };
    let ball = |center, radius| Shape::Sphere { center, radius };
    vec![
        ("ball, eye in its middle", ball(eye, 14.0)),
        ("ball, eye near its border, inside", ball(eye + forward * 9.9, 10.0)),
        ("ball, eye on its border", ball(eye + forward * 10.0, 10.0)),
        ("ball, eye near its border, outside", ball(eye + forward * 10.1, 10.0)),
        ("ball cut by the near plane", ball(eye + forward * 0.6, 0.5)),
        ("ball smaller than the near distance", ball(eye, 0.05)),
        ("ball behind the eye", ball(eye - forward * 30.0, 20.0)),
        ("box, eye inside", cube(eye, 24.0)),
        ("box, eye outside", cube(eye + forward * 18.0, 16.0)),
        ("box cut by the near plane", cube(eye + forward * 0.5, 0.9)),
        ("box behind the eye", cube(eye - forward * 30.0, 20.0)),
    ]
}

#[test]
fn every_pixel_has_its_exact_class() {
    let mut studio = studio::synthetic(40);
    let (eye, target) = eye(&studio);
    let forward = (target - eye).normalize_or(DVec3::X);
    for (what, shape) in lenses(eye, forward) {
        let camera = Camera::looking(eye, target, 1.2);
        let view = View::new(camera, SIZE, &Aabb::EMPTY).expect("a view");
        let scene = studio::scene(camera, vec![studio::lens("lens", vec![shape.clone()], "sepia")]);
        let drawn = studio::picture(&mut studio, &scene, SIZE);
        let volume = shape.volume().expect("a volume");
        let depth = drawn.depth.as_ref().expect("depth");
        let inside = studio::bits(&drawn, 0);
        for y in 0..SIZE[1] {
            for x in 0..SIZE[0] {
                let i = (y * SIZE[0] + x) as usize;
                let d = f64::from(depth[i]);
                let ray = view.pixel_ray(x, y);
                let span = volume.entry_exit(&ray);
                let expected = span.is_some_and(|(enter, exit)| enter <= d && d < exit);
                // The float band (S7), and the silhouette, where an ulp decides between a hit and a miss.
                let sd = if d.is_finite() { volume.signed_distance(ray.at(d)).abs() } else { f64::INFINITY };
                let band = 8.0 * 2_f64.powi(-23) * d.max(1.0) + 1e-4;
                assert!(
                    inside[i] == expected || sd <= band,
                    "{what}: pixel {x},{y} at {d} m is {}, the ray is inside {span:?}",
                    inside[i]
                );
            }
        }
    }
}

#[test]
fn the_near_plane_changes_nothing_beyond_it() {
    let mut studio = studio::synthetic(40);
    let (eye, target) = eye(&studio);
    let forward = (target - eye).normalize_or(DVec3::X);
    for (what, shape) in lenses(eye, forward) {
        let mut of = |near_m: f64| {
            let camera = Camera { near_m, ..Camera::looking(eye, target, 1.2) };
            let scene = studio::scene(camera, vec![studio::lens("lens", vec![shape.clone()], "sepia")]);
            studio::picture(&mut studio, &scene, SIZE)
        };
        let (close, far) = (of(0.125), of(1.0));
        let depth = far.depth.as_ref().expect("depth");
        let ids = far.object_id.as_ref().expect("ids");
        assert_eq!(&close.object_id, &far.object_id, "{what}: something stands within a metre");
        let differing = (0..ids.len())
            .filter(|&i| {
                depth[i] > 1.0
                    && (close.rgba[i] != far.rgba[i] || studio::bits(&close, 0)[i] != studio::bits(&far, 0)[i])
            })
            .count();
        assert_eq!(differing, 0, "{what}");
    }
}

#[test]
fn a_lens_around_the_eye_and_everything_is_the_global_effect() {
    let mut studio = studio::synthetic(40);
    let (eye, target) = eye(&studio);
    let camera = Camera::looking(eye, target, 1.2);
    let around = [
        Shape::Sphere { center: eye, radius: 5e4 },
        Shape::Box { center: eye, size: DVec3::splat(1e5), rotation: DQuat::from_rotation_x(0.2) },
    ];
    let mut global = studio::scene(camera, vec![]);
    global.style.effects = vec![studio::used("sepia")];
    let everywhere = studio::picture(&mut studio, &global, SIZE);
    for shape in around {
        let scene = studio::scene(camera, vec![studio::lens("around", vec![shape], "sepia")]);
        let drawn = studio::picture(&mut studio, &scene, SIZE);
        let ids = drawn.object_id.as_ref().expect("ids");
        let differing = (0..ids.len()).filter(|&i| ids[i] != 0 && drawn.rgba[i] != everywhere.rgba[i]).count();
        assert_eq!(differing, 0);
    }
}
