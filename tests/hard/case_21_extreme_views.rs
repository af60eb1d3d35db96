//! Case 21: cameras that look straight down or up, up ∥ view, lenses of zero size, pictures of 0 and of 16k pixels,
//! fields of view near 0° and 180°: a defined picture or a clear refusal. Oracle: the stated rules, and where points are
//! by the definition of an angle. (The zero-size window belongs to the window.)

use glam::{DVec2, DVec3};
use veduta::{
    figure::scene_file::{self, Options},
    geom::{Aabb, Ray, Shape},
    view::{Camera, CameraError, MAX_FOV, MIN_FOV, Projection, View},
};

const EYE: DVec3 = DVec3::new(85_000.5, 446_000.25, 300.0);

fn camera(direction: DVec3, up: DVec3) -> Camera {
    Camera { up, ..Camera::looking(EYE, EYE + direction, 0.8) }
}

fn view(camera: Camera) -> View {
    View::new(camera, [640, 480], &Aabb { min: EYE - 500.0, max: EYE + 500.0 }).unwrap()
}

/// Where a point 100 m along the view and 10 m aside appears.
fn beside(view: &View, aside: DVec3) -> DVec2 {
    view.pixel(EYE + 100.0 * view.basis.forward + 10.0 * aside).unwrap().truncate() - DVec2::new(320.0, 240.0)
}

#[test]
fn straight_down_has_north_at_the_top_and_straight_up_too() {
    for orthographic in [false, true] {
        for (direction, east_is) in [(-DVec3::Z, 1.0), (DVec3::Z, -1.0)] {
            let mut camera = camera(50.0 * direction, DVec3::Z);
            if orthographic {
                camera.projection = Projection::Orthographic { height_m: 80.0 };
            }
            let view = view(camera);
            let (north, east) = (beside(&view, DVec3::Y), beside(&view, DVec3::X));
            assert!(north.y < -10.0 && north.x.abs() < 1e-6, "north is up: {north}");
            assert!(east.x * east_is > 10.0 && east.y.abs() < 1e-6, "east from above is right: {east}");
        }
    }
}

#[test]
fn tilting_down_to_the_vertical_never_breaks() {
    // From 45° to 10⁻¹² rad off the vertical, to the north: north stays at the top all the way.
    for i in 0..400 {
        let off = 0.785 * 10_f64.powf(-12.0 * f64::from(i) / 399.0);
        let view = view(camera(DVec3::new(0.0, off.sin(), -off.cos()), DVec3::Z));
        let b = view.basis;
        assert!((b.right - DVec3::X).length() < 1e-9, "{off}: {}", b.right);
        assert!(b.up.y > 0.7 && (b.up.length() - 1.0).abs() < 1e-9 && b.up.dot(b.forward).abs() < 1e-9);
        assert!(view.clip_from_relative(DVec2::ZERO).is_finite());
    }
}

#[test]
fn any_up_parallel_to_the_view_gives_a_picture() {
    for direction in [DVec3::X, DVec3::Y, DVec3::Z, DVec3::new(1.0, 2.0, -3.0)] {
        for up in [direction, -direction, 1e6 * direction, 1e-6 * direction, DVec3::ZERO] {
            let view = view(camera(direction, up));
            let (right, top) = (beside(&view, view.basis.right), beside(&view, view.basis.up));
            assert!(right.x > 10.0 && top.y < -10.0 && right.y.abs() + top.x.abs() < 1e-6, "{direction} {up}");
        }
    }
}

#[test]
fn no_direction_no_picture() {
    let nowhere = camera(DVec3::ZERO, DVec3::Z);
    assert!(matches!(nowhere.check(), Err(CameraError::EyeIsTarget(..))));
    for wrong in [f64::NAN, f64::INFINITY] {
        assert!(matches!(camera(DVec3::new(wrong, 0.0, 0.0), DVec3::Z).check(), Err(CameraError::NotFinite("target"))));
        assert!(matches!(camera(DVec3::X, DVec3::splat(wrong)).check(), Err(CameraError::NotFinite("up"))));
    }
}

#[test]
fn fields_of_view_are_refused_outside_their_limits_and_right_at_them() {
    for degrees in [0.0, -10.0, 0.009, 179.1, 180.0, 360.0, f64::NAN, f64::INFINITY] {
        let projection = Projection::Perspective { fov_y: degrees.to_radians() };
        let refused = Camera { projection, ..camera(DVec3::Y, DVec3::Z) };
        assert!(matches!(refused.check(), Err(CameraError::FieldOfView(_))), "{degrees}");
    }
    for fov_y in [MIN_FOV, 0.01_f64.to_radians(), MAX_FOV, 179_f64.to_radians()] {
        let view = view(Camera { projection: Projection::Perspective { fov_y }, ..camera(DVec3::Y, DVec3::Z) });
        // By the definition of the angle: half of it up from the axis is the upper border.
        let top = EYE + 100.0 * DVec3::new(0.0, (0.5 * fov_y).cos(), (0.5 * fov_y).sin());
        let at = view.pixel(top).unwrap();
        assert!((at.x - 320.0).abs() < 1e-3 && at.y.abs() < 1e-3, "{fov_y}: {at}");
        assert!(view.clip_from_relative(DVec2::ZERO).is_finite());
    }
    for height_m in [0.0, -1.0, f64::NAN, 1e8] {
        let refused = Camera { projection: Projection::Orthographic { height_m }, ..camera(DVec3::Y, DVec3::Z) };
        assert!(matches!(refused.check(), Err(CameraError::Height(_))), "{height_m}");
    }
}

#[test]
fn pictures_of_no_pixels_and_beyond_16k_are_refused_and_16k_has_all_its_pixels() {
    let camera = camera(DVec3::new(0.3, 1.0, -0.2), DVec3::Z);
    for size in [[0, 100], [100, 0], [0, 0], [16_385, 1], [1, u32::MAX]] {
        assert_eq!(View::new(camera, size, &Aabb::EMPTY), Err(CameraError::Size(size[0], size[1])));
    }
    let view = View::new(camera, [16_384, 16_384], &Aabb::EMPTY).unwrap();
    for at in [0, 1, 8191, 8192, 16_383] {
        for other in [0, 4000, 16_383] {
            let (x, y) = (at, other);
            let back = view.pixel(view.pixel_ray(x, y).at(2_000.0)).unwrap();
            let error = back.truncate() - DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
            assert!(error.length() < 1e-4, "{x} {y}: {error}");
        }
    }
    let text = |size: &str| format!("veduta = 1\n[figure]\nsize = {size}\n");
    let read = |text: &str| scene_file::parse(text, "s", &Options::for_command_line());
    assert_eq!(read(&text("[16384, 16384]")).unwrap().figure.size, [16_384; 2]);
    for size in ["[0, 1]", "[1, 16385]", "[-1, 5]", "[1e300, 5]", "[99999999999, 1]"] {
        assert!(read(&text(size)).unwrap_err().to_string().contains("1 to 16384"), "{size}");
    }
}

#[test]
fn a_lens_of_zero_size_holds_nothing_and_a_negative_one_is_refused() {
    let lens = |shape: &str| {
        let text = format!("veduta = 1\n[[lens]]\nshape = {{ {shape} }}\n");
        scene_file::parse(&text, "s", &Options::for_command_line()).map(|mut s| s.lenses.remove(0).shapes.remove(0))
    };
    let center = "center = [85000.5, 446010.25, 300.0]";
    for shape in [
        format!("kind = \"sphere\", {center}, radius = 0"),
        format!("kind = \"box\", {center}, size = [0, 5, 5]"),
        format!("kind = \"box\", {center}, size = [0, 0, 0]"),
        format!("kind = \"cylinder\", {center}, radius = 0, height = 9"),
        format!("kind = \"cylinder\", {center}, radius = 9, height = 0"),
        format!("kind = \"ellipsoid\", {center}, radii = [0, 5, 5]"),
        format!("kind = \"cone\", {center}, radius = 0, height = 9"),
        format!("kind = \"frustum\", {center}, radius = 9, top_radius = 2, height = 0"),
    ] {
        let volume = lens(&shape).unwrap().volumes().unwrap().remove(0);
        let middle = DVec3::new(85_000.5, 446_010.25, 300.0);
        assert!(!volume.contains(middle), "{shape}");
        for direction in [DVec3::X, DVec3::Y, DVec3::Z, DVec3::new(1.0, -2.0, 0.5), DVec3::ZERO] {
            assert_eq!(volume.entry_exit(&Ray { origin: middle - 3.0 * direction, direction }), None, "{shape}");
        }
        assert!(volume.bounding_mesh().triangles.is_empty());
    }
    for (shape, right) in [
        (format!("kind = \"sphere\", {center}, radius = -1e-9"), "≥ 0"),
        (format!("kind = \"box\", {center}, size = [1, -1, 1]"), "from 0 to 1e9"),
        (format!("kind = \"cylinder\", {center}, radius = 1, height = -1"), "≥ 0"),
    ] {
        let error = lens(&shape).unwrap_err().to_string();
        assert!(error.contains(right), "{shape}: {error}");
    }
    assert!(Shape::Sphere { center: DVec3::ZERO, radius: -1.0 }.volume().is_err());
}
