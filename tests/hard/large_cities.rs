//! Cities of kilometres: what is near has the shadows that rays say, however far the city goes on.

use glam::DVec3;
use veduta::{
    measure::topics::gpu::views::{overview, street},
    scene::Sun,
    view::Camera,
};

use crate::studio::{self, by_rays::wrong_shadows};

/// Pictures of one sample, from streets and from above, with a high sun and a low one: at most one pixel of two hundred has a light that no ray within
/// a texel of the shadow map has. With all that there is the city is 10 km wide.
#[test]
fn shadows_are_those_of_rays_in_a_city_of_ten_kilometres() {
    let buildings = if studio::is_thorough() { 260_000 } else { 6_000 };
    let mut studio = studio::with_full_shadows(studio::synthetic(buildings));
    let along = street(&studio);
    let looks = along.target - along.eye;
    let back = Camera { target: along.eye + DVec3::new(-looks.y, looks.x, looks.z), ..along };
    let over = overview(&studio.extent(), [440, 275]).expect("a view");
    let near = Camera { eye: over.target + 0.1 * (over.eye - over.target), ..over };
    let sun = |azimuth: f64, elevation: f64| Sun {
        azimuth: azimuth.to_radians(),
        elevation: elevation.to_radians(),
        ..Sun::default()
    };
    for (name, camera) in [("along", along), ("back", back), ("near", near), ("over", over)] {
        for sun in [sun(100.0, 15.0), sun(220.0, 45.0)] {
            let [wrong, compared] = wrong_shadows(&mut studio, camera, sun).expect("a picture");
            println!("{name}, {:.0}°: {wrong} of {compared}", sun.elevation.to_degrees());
            assert!(wrong * 200 <= compared && compared > 5_000, "{name}: {wrong} of {compared} pixels");
        }
    }
}
