//! Hard case 27: lenses that bend rays, held to a slow ray caster: per pixel the path of Wang et al.'s own equations in f64, and every triangle.

use glam::{DVec2, DVec3};
use rayon::prelude::*;
use veduta::{
    geom::Shape,
    lens::{
        Deform, Lens, LensBody,
        chosen::Choice,
        deform::Step,
        kind::{Deformation, FeatureLens},
        ray::{Bend, Feature, Magnify, RayLens},
    },
    render::{frame::Backend, picture::Studio},
    view::{Camera, View},
};

pub use crate::studio::bent::*;
use crate::{lenses::pixels, studio};

/// Of pictures in an ordinary run.
const SIZE: [u32; 2] = [96, 64];
/// Pixels of an ordinary run.
const USUAL: u64 = 12_000;
/// The same where no ray is bent: a rasteriser rounds corners to 1/256 of a pixel.
const RASTER_PX: f64 = 2.0 / 256.0;

#[test]
fn what_bent_rays_show_is_what_a_slow_caster_says() {
    let mut studio = studio::synthetic(40);
    let wanted = pixels(USUAL);
    let scale = (wanted as f64 / USUAL as f64).sqrt().max(1.0);
    let size = SIZE.map(|side| (f64::from(side) * scale).round() as u32);
    let (mut compared, mut rows) = (0, Vec::new());
    for (c, camera) in cameras(&studio).into_iter().enumerate() {
        for (l, lens) in all().iter().enumerate() {
            // In an ordinary run each lens from one of the eyes.
            if scale == 1.0 && (c + l) % 3 != 0 {
                continue;
            }
            let (pixels, wrong, off) = compare(&mut studio, camera, lens, size);
            compared += pixels;
            rows.push(format!("eye {c}, lens {l}: {wrong} of {pixels} wrong, depths off by {off:.1e}"));
            assert!(pixels > 500, "{rows:#?}");
            assert!(wrong == 0, "{rows:#?}");
        }
    }
    println!("{compared} pixels\n{}", rows.join("\n"));
}

#[test]
fn a_feature_is_magnified_where_rays_to_its_focal_point_meet_it() {
    let mut studio = studio::synthetic(40);
    let size = [240, 160];
    let mut compared = [0; 3];
    for (camera, band) in cameras(&studio).into_iter().zip([0.12, 0.2, 0.06]) {
        let sight = Sight::new(&studio, camera, size);
        let Sight { faces, half, is_parallel, .. } = &sight;
        let (half, is_parallel) = (*half, *is_parallel);
        let seen = |p: DVec3| if is_parallel { p.truncate() } else { p.truncate() / -p.z };
        // What the middle shows is the feature.
        let (object, _) = first(faces, &sight.straight(DVec2::ZERO), camera.near_m).expect("something in the middle");
        let id = studio.model.objects[object as usize].id.to_string();
        let own: Vec<&Face> = faces.iter().filter(|face| face.object == object).collect();
        let corners = || own.iter().flat_map(|face| face.corners);
        let nearest = corners().map(|p| -p.z).fold(f64::INFINITY, f64::min);
        let farthest = corners().map(|p| -p.z).fold(0.0, f64::max);
        let low = corners().map(seen).fold(DVec2::INFINITY, DVec2::min);
        let high = corners().map(seen).fold(DVec2::NEG_INFINITY, DVec2::max);
        let (z_l, z_m) = (0.5 * nearest, 0.5 * (nearest + farthest) - 0.5 * nearest);
        let plain = if is_parallel { 1.0 } else { 1.0 + z_m / z_l };
        let plane = Plane { center: 0.5 * (low + high), z_l, f: z_m / (1.0 - plain / 1.6), z_m };
        let magnify = Magnify { magnification: 1.6, at: Some(z_m), distance: Some(z_l), border: 1.0 };
        let of = Choice { ids: vec![id], ..Choice::default() };
        let ray = RayLens { bend: Bend::Feature(Feature { magnify, of }), radius: band, ..RayLens::feature() };
        let scene = studio::scene(camera, vec![lens(FeatureLens { ray })]);
        let picture = draw(&mut studio, &scene, size, Backend::Specialised);
        let ids = picture.object_id.expect("ids");
        let pixel = 2.0 * half.y / f64::from(size[1]);
        // The core, from three places per pixel and side: rays to the focal point against the feature alone.
        let alone: Vec<Face> = own.iter().map(|face| Face { corners: face.corners, object }).collect();
        let fine = 3;
        let wide = [size[0] * fine, size[1] * fine].map(|side| side as usize);
        let fine_place = |i: usize| {
            let at = DVec2::new((i % wide[0]) as f64 + 0.5, (i / wide[0]) as f64 + 0.5) / f64::from(fine);
            DVec2::new(at.x * pixel - half.x, half.y - at.y * pixel)
        };
        let is_core: Vec<bool> = (0..wide[0] * wide[1])
            .into_par_iter()
            .map(|i| {
                let path = plane.path(fine_place(i), 0.0, is_parallel);
                first(&alone, &path[1..], camera.near_m).is_some()
            })
            .collect();
        // What is not in it is nearest to its rim.
        let is_rim = |i: usize| {
            let beside = [i.wrapping_sub(1), i + 1, i.wrapping_sub(wide[0]), i + wide[0]];
            is_core[i] && beside.iter().any(|i| is_core.get(*i) != Some(&true))
        };
        let rim: Vec<DVec2> = (0..is_core.len()).filter(|i| is_rim(*i)).map(fine_place).collect();
        let width = band * 2.0 * half.y;
        // The lens has its core as texels of a field over all it bends, the reference as places: a share of each.
        let reach = rim.iter().map(|at| (*at - plane.center).abs().max_element()).fold(0.0, f64::max) + width;
        let off = (1.5 * 2.0 * reach / 512.0 + pixel / f64::from(fine)) / width;
        let found: Vec<(usize, bool)> = (0..ids.len())
            .into_par_iter()
            .map(|i| {
                let at = sight.place(sight.pixel(i));
                let (x, y) = (fine as usize * (i % size[0] as usize) + 1, fine as usize * (i / size[0] as usize) + 1);
                let from_rim = rim.iter().map(|from| from.distance_squared(at)).fold(f64::INFINITY, f64::min).sqrt();
                let k = from_rim / width;
                let (zone, ks): (usize, Vec<f64>) = match k {
                    _ if is_core[y * wide[0] + x] => (0, vec![0.0, off]),
                    k if k > 1.0 + off => (2, vec![1.0]),
                    k => (1, (0..65).map(|s| (k + off * (f64::from(s) / 32.0 - 1.0)).clamp(0.0, 1.0)).collect()),
                };
                let is_met = |k: f64, aside: DVec2| sight.id(&plane.path(at + aside, k, is_parallel)) == ids[i];
                let beside = pixel * if zone == 2 { RASTER_PX } else { BESIDE_PX };
                let ring = (0..8).map(|a| beside * DVec2::from_angle(f64::from(a) * std::f64::consts::FRAC_PI_4));
                let mut around = std::iter::once(DVec2::ZERO).chain(ring);
                (zone, around.any(|aside| ks.iter().any(|k| is_met(*k, aside))))
            })
            .collect();
        let mut wrong = [0; 3];
        for (zone, is_right) in found {
            compared[zone] += 1;
            wrong[zone] += usize::from(!is_right);
        }
        assert_eq!(wrong, [0; 3], "of {compared:?} in the core, the band and beyond");
    }
    assert!(compared[0] > 3000 && compared[1] > 3000, "{compared:?}");
    println!("{compared:?} in the core, the band and beyond");
}

#[test]
fn rays_are_followed_through_what_is_there_now() {
    let mut kept = studio::synthetic(20);
    let middle = kept.extent().center();
    let camera = Camera::looking(middle + DVec3::new(30.0, -90.0, 70.0), middle, 0.9);
    let raised = |factor: f64, x: f64| {
        let by = Step::Scale { factors: DVec3::new(1.0, 1.0, factor) };
        let deform = Deform { steps: vec![by], control: None, strength: 1.0 };
        let shape =
            Shape::Cylinder { center: middle + DVec3::new(x, 0.0, 0.0), radius: 40.0, height: 80.0, axis: DVec3::Z };
        Lens {
            body: LensBody::None,
            shapes: vec![shape.into()],
            ..Lens::plain("raised", Deformation { deform, content: None }, [0.5; 3])
        }
    };
    let glass = || magnifier(magnify(2.0, 30.0, 50.0, 0.4));
    let box_of = |studio: &mut Studio, lenses: Vec<Lens>| {
        let picture = draw(studio, &studio::scene(camera, lenses), [120, 80], Backend::Specialised);
        (
            picture.rgba,
            picture.object_id,
            picture.depth.expect("depths").iter().map(|d| d.to_bits()).collect::<Vec<_>>(),
        )
    };
    // One after the other, from what the last picture left, and each from nothing.
    let scenes = [(1.5, 0.0), (2.5, 0.0), (2.5, 25.0), (1.5, 0.0)];
    for (factor, x) in scenes {
        let lenses = vec![raised(factor, x), glass()];
        let fresh = box_of(&mut studio::synthetic(20), lenses.clone());
        assert!(box_of(&mut kept, lenses) == fresh, "raised by {factor} at {x}");
    }
    assert!(box_of(&mut kept, vec![glass()]) == box_of(&mut studio::synthetic(20), vec![glass()]), "at rest again");
}

/// A lens with `only` shows what it chose where its rays meet it, and all else where straight ones do: whichever is nearer.
#[test]
fn what_a_lens_chose_is_bent_and_nothing_else() {
    let mut studio = studio::synthetic(40);
    let size = [150, 100];
    let chosen: Vec<usize> = (0..studio.model.objects.len()).filter(|i| i % 3 == 1).collect();
    let ids = chosen.iter().map(|i| studio.model.objects[*i].id.to_string()).collect();
    let only = Some(Choice { ids, ..Choice::default() });
    let is_chosen = |object: u32| object % 3 == 1;
    let mut moved = [0; 2];
    for (c, camera) in cameras(&studio).into_iter().enumerate() {
        for l in [0, 3, 5, 7] {
            let mut bends = all()[l].clone();
            bends.kind.ray_mut().expect("a lens that bends rays").only = only.clone();
            let scene = studio::scene(camera, vec![bends.clone()]);
            let picture = draw(&mut studio, &scene, size, Backend::Specialised);
            let uber = draw(&mut studio, &scene, size, Backend::Uber);
            assert!(picture.rgba == uber.rgba && picture.object_id == uber.object_id, "eye {c}, lens {l}");
            let view = View::new(camera, size, &studio.extent()).expect("a view");
            let sight = Sight::new(&studio, camera, size);
            let reference = Bent::new(bends.ray().expect("a lens that bends rays"), &view);
            let of = |wanted: bool| -> Vec<Face> {
                let own = sight.faces.iter().filter(|face| is_chosen(face.object) == wanted);
                own.map(|face| Face { corners: face.corners, object: face.object }).collect()
            };
            let [own, others] = [true, false].map(of);
            let met = |pixel: DVec2| {
                let place = sight.place(pixel);
                let bent = first(&own, &path(&reference, place, sight.is_parallel), camera.near_m);
                let straight = first(&others, &sight.straight(place), camera.near_m);
                // Along the view axis; of a fisheye as far as they are.
                let is_round = l == 7;
                let depth = |(object, t): (u32, f64)| {
                    let (_, direction) = plain_ray(place, sight.is_parallel);
                    let is_far = is_round && !is_chosen(object);
                    (object, if is_far { t * direction.z.abs() } else { t })
                };
                [bent, straight].into_iter().flatten().map(depth).min_by(|a, b| a.1.total_cmp(&b.1))
            };
            let (ids, depths) = (picture.object_id.expect("ids"), picture.depth.expect("depths"));
            let mut wrong = 0;
            for i in 0..ids.len() {
                let pixel = sight.pixel(i);
                let own = met(pixel);
                let is_right = |found: Option<(u32, f64)>| match found {
                    None => ids[i] == 0,
                    Some((object, t)) => object + 1 == ids[i] && (t / f64::from(depths[i]) - 1.0).abs() < 1e-4,
                };
                // Beside the lens corners are drawn on the rasteriser's grid.
                let around = (0..8).map(|k| RASTER_PX * DVec2::from_angle(f64::from(k) * std::f64::consts::FRAC_PI_4));
                wrong += usize::from(!is_right(own) && !around.map(|by| met(pixel + by)).any(is_right));
                let was = sight.id(&sight.straight(sight.place(pixel)));
                moved[usize::from(ids[i] > 0 && is_chosen(ids[i] - 1))] += usize::from(was != ids[i]);
            }
            assert!(wrong == 0, "eye {c}, lens {l}: {wrong} pixels");
        }
    }
    assert!(moved.iter().all(|count| *count > 1000), "{moved:?} pixels changed");
    // Lines and what is seen through go with it.
    let mut bends = all()[0].clone();
    bends.kind.ray_mut().expect("a lens that bends rays").only = only;
    let around = Shape::Sphere { center: studio.extent().center(), radius: 40.0 };
    let camera = cameras(&studio)[0];
    let mut of = |effects: &[&str], backend| {
        let lenses = effects.iter().map(|effect| studio::lens(effect, [around.clone()], effect));
        let lenses = std::iter::once(bends.clone()).chain(lenses).collect();
        draw(&mut studio, &studio::scene(camera, lenses), size, backend).rgba
    };
    for effects in [&["edges"][..], &["transparent"]] {
        let [one, other] = [Backend::Specialised, Backend::Uber].map(|backend| of(effects, backend));
        assert!(one == other && one != of(&[], Backend::Specialised), "{effects:?}");
    }
}

/// What lies just in the plane of a lens, or just where rays go on again, is on the lines before that and behind it: neither may round it away.
#[test]
fn what_stands_where_rays_turn_is_not_missed() {
    let mut studio = studio::boxes("turned", &[([-90, 10, 0], [180, 180, 10])], false, false);
    let size = [240, 240];
    let mut shown = 0;
    for (i, height) in [70.0, 133.7, 777.7].into_iter().enumerate() {
        let middle = DVec3::new(0.37, 100.21, 10.0);
        let eye = middle + DVec3::new(0.0, 0.0, height);
        let above = Camera { up: DVec3::Y, ..Camera::looking(eye, middle, 2.0 * (60.0 / height).atan()) };
        let level = Camera { up: DVec3::Y, ..studio::orthographic(eye, middle, 120.0) };
        for (camera, [distance, at]) in [above, level]
            .into_iter()
            .flat_map(|camera| [[0.5, 0.5], [0.3, 0.7], [1.0, 0.4]].map(|shares| (camera, shares.map(|s| s * height))))
        {
            let glass = magnifier(RayLens { radius: 0.5, ..magnify(2.5 + 0.1 * i as f64, distance, at, 0.4) });
            for picture in draw_both(&mut studio, &studio::scene(camera, vec![glass]), size) {
                // Through its top one sees its floor.
                let depths = picture.depth.expect("depths");
                let lost = depths.iter().filter(|d| (f64::from(**d) / height - 1.0).abs() > 1e-5).count();
                assert_eq!(lost, 0, "{lost} pixels from {height} m, turned at {distance} m and {at} m behind");
            }
            shown += size[0] * size[1];
            // A layer of what is seen through is there once.
            let clear = studio::lens("clear", [Shape::Sphere { center: middle, radius: 1e4 }], "transparent");
            let glass = magnifier(RayLens { radius: 0.5, ..magnify(2.5 + 0.1 * i as f64, distance, at, 0.4) });
            let mut scene = studio::scene(camera, vec![glass, clear]);
            scene.city.ground = false;
            let picture = draw(&mut studio, &scene, size, Backend::Specialised);
            let mut colors = picture.rgba.clone();
            colors.sort_unstable();
            let usual = colors[colors.len() / 2];
            let is_other = |color: &&[u8; 4]| (0..3).any(|c| color[c].abs_diff(usual[c]) > 3);
            let others = picture.rgba.iter().filter(is_other).count();
            assert_eq!(others, 0, "{others} pixels have other layers, {usual:?}");
        }
    }
    println!("{shown} pixels");
}
