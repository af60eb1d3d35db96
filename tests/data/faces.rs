//! How many faces of each shared file are refused: a recorded maximum, so that a worse triangulation is seen.

use libtest_mimic::Trial;
use veduta::city::load::{LoadOptions, Quiet, load};

/// (file, faces refused at most). All of these have no area or cross themselves.
const REFUSED: &[(&str, u64)] = &[
    ("3dbag-delft/3dbag_5908_delft.v1.1.city.jsonl", 11),
    ("3dbag-delft/3dbag_901.v1.1.city.jsonl", 0),
    ("3dbag-delft/3dbag_multi_lod.v2.0.city.json", 0),
    ("3dbag-delft/3dbag_small.v2.0.city.jsonl", 0),
    ("delft-bgt/delft_bgt.v2.0.city.json", 4),
    ("denhaag-01/DH_01_subs.city.json", 0),
    ("denhaag-01/DenHaag_01.v1.0.city.json", 4),
    ("rotterdam-delfshaven/3-20-DELFSHAVEN.city.json", 621),
    ("rotterdam-delfshaven/delfshaven_cj2glb.glb", 28),
    ("rotterdam-delfshaven/one-textured/rotterdam_one.city.json", 1),
    ("vienna-102081/vienna_102081.v1.1.city.jsonl", 5),
];

pub fn trials() -> Vec<Trial> {
    let trial = |(file, most): &(&'static str, u64)| {
        let (file, most) = (*file, *most);
        crate::trial(&format!("faces::{file}"), move |root| {
            let model = load(&[root.join(file)], &LoadOptions::default(), &Quiet)?;
            let polygons: u64 = model.geometries.iter().map(|g| u64::from(g.polygons)).sum();
            if polygons == 0 {
                return Err("nothing was read".into());
            }
            let refused = model.faces_dropped;
            if refused <= most { Ok(()) } else { Err(format!("{refused} faces are refused, {most} were").into()) }
        })
    };
    REFUSED.iter().map(trial).collect()
}
