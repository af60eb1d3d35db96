//! Lenses that act where another one bends rays so that things are larger: semantic zoom.

use glam::DVec2;
use veduta::{
    city::derived::{Derive, Form},
    lens::{Content, Lens, LensBody, Region, kind::ContentLens, ray::RayLens},
    render::{
        frame::Backend,
        picture::{Picture, Request, Studio},
    },
    view::Camera,
};

use crate::studio::{
    bent::{Sight, cameras, lens, magnifier, magnify},
    *,
};

const SIZE: [u32; 2] = [180, 120];

fn drawn(studio: &mut Studio, camera: Camera, lenses: Vec<Lens>) -> Picture {
    let scene = scene(camera, lenses);
    let [one, other] = [Backend::Specialised, Backend::Uber].map(|backend| {
        let request = Request { aovs: ALL, backend, ..Request::plain(SIZE) };
        studio.render(&scene, &request).unwrap_or_else(|error| panic!("{error}"))
    });
    assert!(one.rgba == other.rgba && one.lens_mask == other.lens_mask, "the back ends differ");
    one
}

fn within(by: f64) -> Region {
    Region::Magnified { lens: "bent".into(), by }
}

/// A magnifier of `m` at 60 m behind its plane at 90 m: where its core is so much larger, by the formula of Wang et al.
fn begins(m: f64, by: f64, is_parallel: bool) -> f64 {
    let e = if is_parallel { 0.0 } else { 1.0 / 90.0 };
    let inverse_f = (1.0 - (1.0 + 60.0 * e) / m) / 60.0;
    // (1 + z e) / (1 - z / f) = by.
    90.0 + (by - 1.0) / (e + by * inverse_f)
}

#[test]
fn what_is_magnified_is_told_by_place_on_both_back_ends() {
    let mut studio = synthetic(40);
    let (mut held, mut told) = (0, 0);
    for camera in cameras(&studio) {
        for (m, by, aside) in [(3.0, 1.8, 0.0), (4.0, 3.0, 0.12)] {
            let center = DVec2::new(0.5 + aside, 0.5);
            let glass = magnifier(RayLens { center, ..magnify(m, 90.0, 60.0, 0.4) });
            let acts = crate::studio::lens("acts", [within(by)], "invert");
            let picture = drawn(&mut studio, camera, vec![glass, acts]);
            let sight = Sight::new(&studio, camera, SIZE);
            let (depths, inside) = (picture.depth.as_ref().unwrap(), bits(&picture, 1));
            let (middle, radius) = (DVec2::new(2.0 * aside, 0.0) * sight.half, 0.42 * 2.0 * sight.half.y);
            let d = begins(m, by, sight.is_parallel);
            for (i, depth) in depths.iter().enumerate() {
                let share = (sight.place(sight.pixel(i)) - middle).length() / radius;
                let depth = f64::from(*depth);
                // Beyond the core the border compresses at once; a circle is a polygon up to where rays go on.
                if (share - 0.6).abs() < 2e-3 || (depth - d).abs() < 1e-4 * d {
                    continue;
                }
                let expected = share < 0.6 && depth > d && depth.is_finite();
                assert_eq!(inside[i], expected, "pixel {i}: {share} of the radius, {depth} of {d} m");
                held += usize::from(expected);
                told += 1;
            }
        }
    }
    assert!(held > 6_000 && told > 100_000, "{held} of {told} pixels");
}

#[test]
fn a_content_shows_where_there_is_room_for_it() {
    let mut studio = synthetic(40);
    let camera = cameras(&studio)[0];
    let glass = || magnifier(magnify(3.0, 90.0, 60.0, 0.4));
    let derive = Derive { form: Form::Flat { lift_m: 0.05 }, parts: false };
    let content = Content { derive: Some(derive), ..Content::default() };
    let finer = || Lens {
        body: LensBody::None,
        shapes: vec![within(1.5)],
        ..Lens::plain("finer", ContentLens { content: content.clone() }, [0.5; 3])
    };
    let plain = drawn(&mut studio, camera, vec![glass()]);
    let zoomed = drawn(&mut studio, camera, vec![glass(), finer()]);
    let [before, now] = [&plain, &zoomed].map(|picture| picture.rgba.clone());
    let changed = before.iter().zip(&now).filter(|(a, b)| a != b).count();
    assert!(changed > 500, "{changed} pixels");
    // Of a lens that is not there, or that has no such outline, nothing is held.
    let lost = Lens { shapes: vec![Region::Magnified { lens: "none".into(), by: 1.5 }], ..finer() };
    assert!(drawn(&mut studio, camera, vec![glass(), lost]).rgba == before, "nothing is there");
    let weak = lens(veduta::lens::kind::Magnifier { ray: magnify(1.3, 90.0, 60.0, 0.4) });
    let [alone, both] = [vec![weak.clone()], vec![weak, finer()]].map(|all| drawn(&mut studio, camera, all).rgba);
    assert!(alone == both, "it is not so large");
}
