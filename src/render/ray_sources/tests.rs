use proptest::prelude::*;

use super::*;
use crate::{
    geom::Aabb,
    lens::{
        ray::{Bend, Fisheye, Magnify, RayLens, RayOutline, Sampling, SamplingRate},
        ray_path::{PictureFrame, Scenery},
    },
};

fn view(is_parallel: bool, size: [u32; 2]) -> View {
    let camera = Camera::looking(DVec3::new(10.0, -200.0, 120.0), DVec3::new(0.0, 10.0, 5.0), 0.8);
    let projection = if is_parallel { Projection::Orthographic { height_m: 150.0 } } else { camera.projection };
    let extent = Aabb { min: DVec3::splat(-300.0), max: DVec3::splat(300.0) };
    View::new(Camera { projection, ..camera }, size, &extent).expect("a view")
}

fn paths(lenses: &[RayLens], view: &View) -> RayPaths {
    let frame = PictureFrame::new(&view.camera, view.size);
    let numbered: Vec<(u32, &RayLens, [f32; 3])> = (0..).zip(lenses).map(|(i, lens)| (i, lens, [0.0; 3])).collect();
    let scenery = Scenery { shown: &|_| Some(200.0), mask: &|_| None, feature: &|_| Vec::new() };
    RayPaths::new(&numbered, &frame, &scenery)
}

fn lens(bend: Bend) -> RayLens {
    RayLens { method: RayMethod::Image, ..RayLens::new(bend) }
}

fn magnifier(magnification: f64, border: f64) -> RayLens {
    lens(Bend::Magnify(Magnify { magnification, at: Some(80.0), distance: Some(90.0), border }))
}

fn fisheye(angle_deg: f64) -> RayLens {
    let bend = Fisheye { angle: angle_deg.to_radians(), projection: FisheyeProjection::Angular };
    RayLens { radius: 0.5, ..lens(Bend::Fisheye(bend)) }
}

/// Whether an image shows a place, view space of the picture.
fn shows(source: &RaySource, view: &View, p: DVec3) -> bool {
    let q = source.view.basis.view_from_world() * (view.basis.view_from_world().transpose() * p);
    let half = source.view.half_extent();
    let across = q.truncate() / if source.view.is_orthographic() { 1.0 } else { -q.z };
    let size = DVec2::new(source.view.size[0].into(), source.view.size[1].into());
    let texel = (0.5 + DVec2::new(0.5, -0.5) * (across / half)) * size;
    let first = DVec2::new(source.tile.origin[0].into(), source.tile.origin[1].into());
    let wide = DVec2::new(source.tile.size[0].into(), source.tile.size[1].into());
    let at = texel - first;
    q.z < 0.0 && at.cmpge(DVec2::ZERO).all() && at.cmplt(wide).all()
}

fn lenses() -> impl Strategy<Value = Vec<RayLens>> {
    let bend = prop_oneof![
        (0.3..8.0f64, 0.0..=1.0f64, 20.0..150.0f64, 5.0..150.0f64).prop_map(|(magnification, border, distance, at)| {
            Bend::Magnify(Magnify { magnification, at: Some(at), distance: Some(distance), border })
        }),
        (0.3..6.0f64).prop_map(|middle| Bend::Sample(Sampling { rate: SamplingRate::Cubic(middle) })),
        (20.0..360.0f64).prop_map(|angle| {
            Bend::Fisheye(Fisheye { angle: angle.to_radians(), projection: FisheyeProjection::Angular })
        }),
    ];
    let one = (bend, prop::array::uniform2(0.0..=1.0f64), 0.05..0.7f64, any::<bool>(), 0.3..3.0f64).prop_map(
        |(bend, center, radius, is_square, fineness)| RayLens {
            center: center.into(),
            radius,
            outline: if is_square { RayOutline::Square } else { RayOutline::Circle },
            fineness,
            ..lens(bend)
        },
    );
    prop::collection::vec(one, 1..4)
}

proptest! {
    #![proptest_config(crate::seeds::config())]

    /// Whatever a bent ray passes is in an image, at every distance; those of tiles show what the pixels of the tiles see.
    #[test]
    fn all_that_rays_pass_is_in_an_image(all in lenses(), is_parallel in any::<bool>(), tile in any::<bool>(), places in prop::collection::vec(prop::array::uniform3(0.0..1.0f64), 40)) {
        let view = view(is_parallel, [320, 200]);
        let tile = if tile { PictureTile { origin: [96, 48], size: [128, 96] } } else { PictureTile::whole(view.size) };
        let paths = paths(&all, &view);
        let sources = sources(&paths, &view, tile);
        for [x, y, far] in places {
            let pixel = DVec2::new(
                f64::from(tile.origin[0]) + x * f64::from(tile.size[0]),
                f64::from(tile.origin[1]) + y * f64::from(tile.size[1]),
            );
            let ndc = DVec2::new(2.0 * pixel.x / 320.0 - 1.0, 1.0 - 2.0 * pixel.y / 200.0);
            let across = ndc * view.half_extent();
            if paths.bends(across) {
                let t = 1.0 + 400.0 * far * far;
                let p = paths.line(across, t).at(t);
                prop_assert!(sources.iter().any(|source| shows(source, &view, p)), "{p} at {across}, {sources:?}");
            }
        }
    }
}

#[test]
fn fisheyes_look_at_the_faces_that_they_reach() {
    let view = view(false, [320, 200]);
    let faces = |angle| sources(&paths(&[fisheye(angle)], &view), &view, PictureTile::whole(view.size)).len();
    assert_eq!([60.0, 89.0, 95.0, 180.0, 249.0, 252.0, 360.0].map(faces), [1, 1, 5, 5, 5, 6, 6]);
}

#[test]
fn images_have_as_many_texels_as_the_lens_magnifies() {
    let view = view(false, [640, 400]);
    let whole = PictureTile::whole(view.size);
    let pixel = 2.0 * view.half_extent().y / 400.0;
    let texel = |lens: RayLens| sources(&paths(&[lens], &view), &view, whole)[0].texel;
    assert!((texel(magnifier(2.5, 0.4)) * 2.5 / pixel - 1.0).abs() < 1e-9);
    assert!((texel(RayLens { fineness: 2.0, ..magnifier(4.0, 0.4) }) * 8.0 / pixel - 1.0).abs() < 1e-9);
    assert!((texel(magnifier(0.5, 0.4)) / pixel - 1.0).abs() < 1e-9, "what it makes smaller has those of the picture");
    // The middle of a cubic rate of 2.5 has I(1) · 2.5 texels to a pixel.
    let sampled = lens(Bend::Sample(Sampling { rate: SamplingRate::Cubic(2.5) }));
    let least = 2.5 * (0..1000).map(|i| 1e-3 / SamplingRate::Cubic(2.5).at((f64::from(i) + 0.5) * 1e-3)).sum::<f64>();
    assert!((texel(sampled) * least / pixel - 1.0).abs() < 1e-4);
    // Where that were more than an image may have, it is coarser.
    let close = sources(&paths(&[magnifier(500.0, 1.0)], &view), &view, whole);
    assert!(close[0].tile.size.iter().all(|side| *side <= 4096) && close[0].texel > pixel / 500.0);
}

#[test]
fn images_of_a_large_picture_take_no_more_than_they_may() {
    let view = view(false, [7680, 4320]);
    let lenses = [RayLens { fineness: 8.0, ..fisheye(300.0) }, RayLens { fineness: 8.0, ..magnifier(6.0, 0.4) }];
    let all = sources(&paths(&lenses, &view), &view, PictureTile::whole(view.size));
    let side = |axis: usize| all.iter().map(|source| u64::from(source.tile.size[axis])).max().expect("some");
    let texels = side(0) * side(1) * all.len() as u64;
    assert!(all.len() == 7 && texels < 26_000_000 && texels > 10_000_000, "{texels} texels of {} images", all.len());
}

#[test]
fn the_finest_image_comes_first_and_only_lenses_that_ask_have_one() {
    let view = view(false, [320, 200]);
    let whole = PictureTile::whole(view.size);
    let lenses = [magnifier(2.0, 0.4), magnifier(6.0, 0.4), RayLens { method: RayMethod::Rays, ..magnifier(9.0, 0.4) }];
    let all = sources(&paths(&lenses, &view), &view, whole);
    assert_eq!(all.len(), 2);
    assert!(all[0].texel < all[1].texel);
    let beside = RayLens { center: DVec2::splat(4.0), ..magnifier(2.0, 0.4) };
    assert_eq!(sources(&paths(&[beside], &view), &view, whole), []);
}
