//! Pictures of the shared cities: masks against f64, the same bytes twice, and two files of one city against each other.

use glam::DVec3;
use libtest_mimic::{Failed, Trial};
use veduta::{
    geom::{Aabb, Shape},
    view::{Camera, View},
};

use crate::studio;

const SIZE: [u32; 2] = [960, 540];
const DEN_HAAG: &str = "denhaag-01/DenHaag_01.v1.0.city.json";
const DELFT: &str = "3dbag-delft/3dbag_5908_delft.v1.1.city.jsonl";
const PART_OF_IT: &str = "denhaag-01/DH_01_subs.city.json";

pub fn trials() -> Vec<Trial> {
    let masks = |name: &'static str, file: &'static str, radius: f64| {
        crate::trial(name, move |root| {
            let mut studio = studio::studio(&[root.join(file)]);
            let at = studio.extent().center();
            let camera = Camera::looking(at + DVec3::new(300.0, -420.0, 260.0), at, 0.7);
            let mut lens = studio::lens("sphere", vec![Shape::Sphere { center: at, radius }], "greyscale");
            lens.body = veduta::lens::LensBody::Outline;
            let scene = studio::scene(camera, vec![lens]);
            let drawn = studio::picture(&mut studio, &scene, SIZE);
            let view = View::new(camera, SIZE, &Aabb::EMPTY)?;
            let covered = studio::bits(&drawn, 0).iter().filter(|b| **b).count();
            let wrong = studio::wrong_pixels(&drawn, &view, &scene.lenses[0], 0);
            if covered < 1000 || wrong > 0 {
                return Err(format!("{wrong} wrong pixels, {covered} covered").into());
            }
            if studio::picture(&mut studio, &scene, SIZE).rgba != drawn.rgba {
                return Err("the same scene gave other bytes".into());
            }
            Ok(())
        })
    };
    vec![
        masks("pictures::den_haag_sphere_of_90_m", DEN_HAAG, 90.0),
        masks("pictures::vienna_sphere_of_60_m", "vienna-102081/vienna_102081.v1.1.city.jsonl", 60.0),
        masks("pictures::rotterdam_sphere_of_120_m", "rotterdam-delfshaven/3-20-DELFSHAVEN.city.json", 120.0),
        crate::trial("pictures::hidden_buildings_are_not_missed", |root| {
            let mut views = 0;
            for file in [DEN_HAAG, DELFT] {
                let mut studio = studio::studio(&[root.join(file)]);
                views += studio::hiding_changes_nothing(&mut studio, 10, SIZE).0;
            }
            if views < 5 { Err(format!("only {views} of 20 street views leave anything out").into()) } else { Ok(()) }
        }),
        crate::trial("pictures::both_files_of_den_haag_agree", |root| {
            let mut whole = studio::studio(&[root.join(DEN_HAAG)]);
            let mut part = studio::studio(&[root.join(PART_OF_IT)]);
            let bounds = part.extent();
            let reach = bounds.size().length().max(20.0);
            let mut compared = 0;
            for direction in [DVec3::new(0.5, -0.9, 0.6), DVec3::new(-0.8, 0.4, 0.5), DVec3::new(0.1, 0.1, 1.0)] {
                let camera = Camera::looking(bounds.center() + direction * reach, bounds.center(), 0.8);
                let scene = studio::scene(camera, vec![]);
                let (a, b) = (studio::picture(&mut whole, &scene, SIZE), studio::picture(&mut part, &scene, SIZE));
                compared += agree(&whole, &a, &part, &b)?;
            }
            if compared < 1500 { Err(format!("only {compared} pixels show the same object").into()) } else { Ok(()) }
        }),
    ]
}

/// Where both pictures show the same object their depths are equal to the bit; how many pixels that are.
fn agree(
    one: &veduta::render::picture::Studio,
    a: &veduta::render::picture::Picture,
    other: &veduta::render::picture::Studio,
    b: &veduta::render::picture::Picture,
) -> Result<usize, Failed> {
    let name = |studio: &veduta::render::picture::Studio, id: u32| {
        id.checked_sub(1).map(|i| studio.model.objects[i as usize].id.clone())
    };
    let (ids_a, ids_b) = (a.object_id.as_ref().ok_or("no ids")?, b.object_id.as_ref().ok_or("no ids")?);
    let (depth_a, depth_b) = (a.depth.as_ref().ok_or("no depth")?, b.depth.as_ref().ok_or("no depth")?);
    let mut same = 0;
    for i in 0..ids_a.len() {
        let (object_a, object_b) = (name(one, ids_a[i]), name(other, ids_b[i]));
        if object_a.is_none() || object_b.is_none() {
            continue;
        }
        if object_a == object_b {
            if depth_a[i].to_bits() != depth_b[i].to_bits() {
                return Err(format!("pixel {i}: {} m and {} m", depth_a[i], depth_b[i]).into());
            }
            same += 1;
        } else if depth_a[i] >= depth_b[i] {
            // What only the whole city has may stand before the object, never behind it or in its place.
            return Err(format!(
                "pixel {i} shows {object_a:?} at {} m, not {object_b:?} at {}",
                depth_a[i], depth_b[i]
            )
            .into());
        }
    }
    Ok(same)
}
