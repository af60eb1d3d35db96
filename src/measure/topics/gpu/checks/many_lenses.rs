//! Masks of one to 64 overlapping lenses.

use crate::{
    lens::Lens,
    measure::topics::gpu::{
        check::{Check, Findings},
        cities::synthetic,
        looks::{cameras, lens, picture_by, scene, view},
        numbers::Numbers,
        shapes::{KINDS, ask_mask, shape},
    },
    render::{
        frame::Backend,
        picture::{RenderError, Studio},
    },
};

/// See the module.
pub const CHECK: Check = Check {
    name: "many lenses",
    case: "6",
    property: "every mask of 1 to 64 overlapping lenses is what f64 says of the shown place, outside the stated band, by both \
               back ends",
    oracle: "the shapes' definitions in f64",
    unit: "mask bits",
    least: 500_000,
    run,
};

const SIZE: [u32; 2] = [200, 150];

/// `count` lenses around what can be seen, from a tenth of a metre to the size of the city.
fn lenses(count: usize, studio: &Studio, numbers: &mut Numbers) -> Vec<Lens> {
    let extent = studio.extent();
    let one = |i: usize| {
        let anywhere = extent.center() + 0.5 * extent.size() * numbers.in_cube();
        let house = studio.geometries[numbers.below(studio.geometries.len() as u64) as usize];
        let center = [anywhere, studio.model.geometries[house as usize].bounds.center()][i % 2];
        let r = 0.1 * (0.5 * extent.size().length() / 0.1).powf(numbers.share().sqrt());
        let kind = numbers.below(KINDS as u64) as usize;
        let effect = ["sepia", "greyscale", "invert", "darken"][numbers.below(4) as usize];
        lens(&format!("lens {i} of kind {kind}"), shape(kind, center, r, numbers), effect)
    };
    (0..count).map(one).collect()
}

fn run(found: &mut Findings) -> Result<(), RenderError> {
    let mut studio = synthetic(60, 7)?;
    let mut numbers = Numbers(6);
    for (round, count) in [1, 64, 7, 33].into_iter().enumerate() {
        let lenses = lenses(count, &studio, &mut numbers);
        let backend = if round % 2 == 0 { Backend::Specialised } else { Backend::Uber };
        for camera in cameras(&studio) {
            let drawn = picture_by(&mut studio, &scene(camera, lenses.clone()), SIZE, backend)?;
            let view = view(camera, SIZE)?;
            for (number, lens) in lenses.iter().enumerate() {
                ask_mask(found, &drawn, &view, lens, number)?;
            }
        }
        if !found.goes_on() {
            break;
        }
    }
    Ok(())
}
