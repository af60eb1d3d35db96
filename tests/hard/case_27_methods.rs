//! Hard case 27, the methods that are not exact: images of what the eye sees, and moved corners, held to exact rays. Finer ones are nearer; what no
//! lens is over is as without lenses, to the byte; what is hidden elsewhere is hidden in them.

use glam::{DVec2, DVec3};
use veduta::{
    geom::Shape,
    lens::{
        Lens,
        ray::{RayLens, RayMethod},
    },
    render::{
        frame::Backend,
        picture::{Picture, Studio},
    },
    view::{Camera, View},
};

use crate::{
    case_27_bent_rays::{all, cameras, draw, magnifier, magnify},
    studio,
};

const SIZE: [u32; 2] = [240, 160];
/// How far depths of one object may be from each other, of themselves: of an image the plane of a face goes through the middle of a texel, at f32.
const DEPTH_OFF: f64 = 1e-3;

fn by(lens: &Lens, method: RayMethod, fineness: f64) -> Lens {
    let mut lens = lens.clone();
    if let Some(ray) = lens.kind.ray_mut() {
        (ray.method, ray.fineness) = (method, fineness);
    }
    lens
}

/// The pixels that a lens is over.
fn over(lens: &Lens, camera: Camera) -> Vec<bool> {
    let ray = lens.ray().expect("a lens that bends rays");
    let view = View::new(camera, SIZE, &veduta::geom::Aabb::EMPTY).expect("a view");
    let rim = veduta::lens::ray_path::PictureFrame::new(&camera, SIZE).rim(ray);
    let half = view.half_extent();
    let place = |i: u32| {
        let pixel = DVec2::new(f64::from(i % SIZE[0]) + 0.5, f64::from(i / SIZE[0]) + 0.5);
        let size = DVec2::new(SIZE[0].into(), SIZE[1].into());
        (2.0 * pixel / size - 1.0) * DVec2::new(half.x, -half.y)
    };
    (0..SIZE[0] * SIZE[1]).map(|i| rim.share(place(i)) < 1.0).collect()
}

/// Of the pixels of a lens the shares in percent that show another object, and that show it elsewhere.
fn wrong(exact: &Picture, found: &Picture, over: &[bool]) -> [f64; 2] {
    let of = |picture: &Picture| (picture.object_id.clone().expect("ids"), picture.depth.clone().expect("depths"));
    let ((ids, depths), (other_ids, other_depths)) = (of(exact), of(found));
    let (mut count, mut ids_off, mut depths_off) = (0, 0, 0);
    for i in (0..ids.len()).filter(|i| over[*i]) {
        count += 1;
        let is_same = ids[i] == other_ids[i];
        ids_off += u32::from(!is_same);
        let off = (f64::from(depths[i]) / f64::from(other_depths[i]) - 1.0).abs();
        depths_off += u32::from(is_same && ids[i] != 0 && off > DEPTH_OFF);
    }
    [ids_off, depths_off].map(|off| 100.0 * f64::from(off) / f64::from(count))
}

fn measured(studio: &mut Studio, camera: Camera, lens: &Lens, beside: &[Lens]) -> Vec<(RayMethod, f64, [f64; 2])> {
    let mut scene = |own: Lens| {
        let lenses = std::iter::once(own).chain(beside.iter().cloned()).collect();
        draw(studio, &studio::scene(camera, lenses), SIZE, Backend::Specialised)
    };
    let exact = scene(lens.clone());
    let plain = scene(Lens { enabled: false, ..lens.clone() });
    let over = over(lens, camera);
    let mut found = Vec::new();
    for method in [RayMethod::Image, RayMethod::Vertices] {
        for fineness in [0.5, 4.0] {
            let picture = scene(by(lens, method, fineness));
            for (i, is_over) in over.iter().enumerate().filter(|(_, is_over)| !**is_over) {
                let (a, b) = (&picture.object_id.as_ref().expect("ids")[i], &plain.object_id.as_ref().expect("ids")[i]);
                assert!(a == b && !is_over, "{method:?} changes pixel {i} beside the lens");
            }
            found.push((method, fineness, wrong(&exact, &picture, &over)));
        }
    }
    found
}

#[test]
fn finer_images_and_smaller_triangles_are_nearer_to_exact_rays() {
    let mut studio = studio::synthetic(40);
    let (cameras, lenses) = (cameras(&studio), all());
    let mut rows = Vec::new();
    // Magnifiers, one that makes smaller, sampling rates, fisheyes; slanting, parallel, in a street.
    for (camera, lens) in [(0, 0), (1, 1), (0, 3), (2, 5), (1, 6), (0, 7), (2, 8)] {
        let found = measured(&mut studio, cameras[camera], &lenses[lens], &[]);
        let [(.., image), (.., fine_image), (.., moved), (.., finely_moved)] = found[..] else { panic!("four") };
        rows.push(format!("eye {camera}, lens {lens}: {found:?}"));
        // What a lens with a plane shows between its plane and its depth is hidden in part; others see the same as the picture.
        let is_plane = lenses[lens].ray().is_some_and(|ray| ray.bend.magnify().is_some());
        let most = if is_plane { 4.0 } else { 0.6 };
        assert!(fine_image[0] < most && fine_image[0] < 0.8 * image[0], "images: {rows:#?}");
        assert!(finely_moved[0] < 0.1 && finely_moved[0] <= 0.3 * moved[0] + 0.01, "moved corners: {rows:#?}");
        assert!(fine_image[1] < 0.3 && finely_moved[1] < 0.1, "depths: {rows:#?}");
    }
    println!("{}", rows.join("\n"));
}

#[test]
fn what_lenses_hide_is_hidden_in_images_and_of_moved_corners() {
    let mut studio = studio::synthetic(40);
    let middle = studio.extent().center();
    let ball = |at: DVec3, radius| studio::lens("eraser", [Shape::Sphere { center: at, radius }], "eraser");
    let slanting = cameras(&studio)[0];
    let street = Camera::looking(middle, middle + DVec3::new(10.0, 30.0, -1.0), 1.0);
    // Beside an eye in a street, and behind it, not alike: what is hidden from one face of the cube around it is not from another.
    let ahead = (street.target - street.eye).normalize_or(DVec3::Y);
    let aside = ahead.cross(DVec3::Z);
    let around = [ball(street.eye + 40.0 * aside, 30.0), ball(street.eye - 50.0 * ahead, 35.0)];
    let magnified = magnifier(magnify(2.5, 100.0, 100.0, 0.4));
    for (camera, lens, beside) in
        [(slanting, magnified, vec![ball(middle, 60.0)]), (street, all()[8].clone(), around.to_vec())]
    {
        let mut ids = |own: Lens, beside: &[Lens], backend| {
            let lenses = std::iter::once(own).chain(beside.iter().cloned()).collect();
            let picture = draw(&mut studio, &studio::scene(camera, lenses), SIZE, backend);
            (picture.object_id.expect("ids"), picture.rgba)
        };
        // Much is hidden.
        let [whole, erased] = [&[][..], &beside].map(|beside| ids(lens.clone(), beside, Backend::Specialised).0);
        let hidden = whole.iter().zip(&erased).filter(|(a, b)| a != b).count();
        assert!(hidden > whole.len() / 200, "{hidden} pixels are others");
        // Both back ends hide the same.
        for method in [RayMethod::Image, RayMethod::Vertices] {
            let [one, other] =
                [Backend::Specialised, Backend::Uber].map(|backend| ids(by(&lens, method, 1.0), &beside, backend));
            assert!(one == other, "{method:?}");
        }
        for (method, fineness, [wrong, _]) in measured(&mut studio, camera, &lens, &beside) {
            // Large triangles around the eye have long sides at half the fineness.
            let most = if fineness > 1.0 { 0.5 } else { 20.0 };
            assert!(wrong < most, "{method:?} at {fineness}: {wrong} % of the pixels");
        }
    }
}

/// A lens that follows rays is exact whatever other lenses lie over it.
#[test]
fn where_one_lens_follows_rays_they_are_followed() {
    let mut studio = studio::synthetic(40);
    let camera = cameras(&studio)[0];
    let ray = |lens: &Lens| lens.ray().expect("a lens that bends rays").clone();
    let under = magnifier(magnify(2.0, 90.0, 90.0, 0.4));
    let small = magnifier(RayLens { radius: 0.2, ..ray(&magnifier(magnify(1.6, 120.0, 60.0, 0.5))) });
    let exact =
        draw(&mut studio, &studio::scene(camera, vec![under.clone(), small.clone()]), SIZE, Backend::Specialised);
    let within = over(&small, camera);
    for method in [RayMethod::Image, RayMethod::Vertices] {
        let mixed = studio::scene(camera, vec![by(&under, method, 1.0), small.clone()]);
        let mixed = draw(&mut studio, &mixed, SIZE, Backend::Specialised);
        let wrong = |is_within: bool| {
            let pixels = (0..within.len()).filter(|i| within[*i] == is_within);
            pixels
                .filter(|i| exact.object_id.as_ref().expect("ids")[*i] != mixed.object_id.as_ref().expect("ids")[*i])
                .count()
        };
        assert_eq!(wrong(true), 0, "{method:?}");
        assert!(wrong(false) > 0, "the other one is not exact");
    }
}
