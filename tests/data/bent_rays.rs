//! Lenses that bend rays over a real city, held to a slow ray caster in f64: objects within 10⁻³ pixel of an edge's image, depths to 2 · 10⁻⁶.

#![allow(clippy::print_stdout, reason = "what was measured, for those who ask with --no-capture")]

use std::path::Path;

use libtest_mimic::{Failed, Trial};

use crate::studio::{
    bent::{all, cameras, compare},
    is_thorough, studio,
};

/// Pictures of an ordinary run, and how many of a lens' pixels there are in a thorough one, if nothing else is said.
const SIZE: [u32; 2] = [72, 48];
const MANY: u64 = 1_000_000;

pub fn trials() -> Vec<Trial> {
    let file = "denhaag-01/DenHaag_01.v1.0.city.json";
    vec![crate::trial(&format!("bent_rays::{file}"), move |root| check(&root.join(file)))]
}

/// The pictures' size of this run.
fn size() -> [u32; 2] {
    let said = std::env::var("VEDUTA_HARD_PIXELS").ok().and_then(|pixels| pixels.parse::<u64>().ok());
    let wanted = match (said, is_thorough()) {
        // Of ten lenses and three eyes; half of a picture is in a lens.
        (Some(pixels), _) => pixels / 15,
        (None, true) => MANY / 15,
        (None, false) => return SIZE,
    };
    let scale = (wanted as f64 / f64::from(SIZE[0] * SIZE[1])).sqrt().max(1.0);
    SIZE.map(|side| (f64::from(side) * scale).ceil() as u32)
}

fn check(file: &Path) -> Result<(), Failed> {
    let mut studio = studio(&[file.to_owned()]);
    let size = size();
    let (mut compared, mut wrong, mut rows) = (0, 0, Vec::new());
    for (c, camera) in cameras(&studio).into_iter().enumerate() {
        for (l, lens) in all().iter().enumerate() {
            if size == SIZE && (c + l) % 3 != 0 {
                continue;
            }
            let (pixels, off, farthest) = compare(&mut studio, camera, lens, size);
            (compared, wrong) = (compared + pixels, wrong + off);
            rows.push(format!("eye {c}, lens {l}: {off} of {pixels} wrong, depths off by {farthest:.1e}"));
        }
    }
    println!("{compared} pixels\n{}", rows.join("\n"));
    if compared < 5_000 || wrong > 0 {
        return Err(format!("{wrong} of {compared} pixels are wrong:\n{}", rows.join("\n")).into());
    }
    Ok(())
}
