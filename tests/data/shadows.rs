//! Shadows of the shared cities against exact rays of the sun, one through every pixel.

use glam::DVec3;
use libtest_mimic::Trial;
use veduta::{scene::Sun, view::Camera};

use crate::studio::{self, by_rays::wrong_shadows};

pub fn trials() -> Vec<Trial> {
    let sun = |azimuth: f64, elevation: f64| Sun {
        azimuth: azimuth.to_radians(),
        elevation: elevation.to_radians(),
        ..Sun::default()
    };
    vec![crate::trial("shadows::shadows_are_those_of_exact_rays_in_the_street_and_from_above", move |root| {
        let mut studio = studio::studio(&[root.join("denhaag-01/DenHaag_01.v1.0.city.json")]);
        studio = studio::with_full_shadows(studio);
        let street = DVec3::new(78552.34, 457830.52, 12.463);
        let views = [
            (Camera::looking(street, street + DVec3::new(150.0, 150.0, 0.0), 60_f64.to_radians()), sun(100.0, 15.0)),
            (Camera::looking(street, street + DVec3::new(150.0, 150.0, 0.0), 60_f64.to_radians()), sun(220.0, 35.0)),
            (
                Camera::looking(
                    street + DVec3::new(-200.0, -300.0, 260.0),
                    street + DVec3::new(150.0, 150.0, 0.0),
                    45_f64.to_radians(),
                ),
                sun(100.0, 15.0),
            ),
        ];
        let mut all = Vec::new();
        for (camera, sun) in views {
            all.push(wrong_shadows(&mut studio, camera, sun)?);
        }
        if all.iter().all(|[wrong, compared]| wrong * 200 <= *compared && *compared > 10_000) {
            Ok(())
        } else {
            Err(format!("pixels of another light than rays within a pixel, and pixels compared: {all:?}").into())
        }
    })]
}
