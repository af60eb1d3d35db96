//! The shipped scenes of the shared data name what the cities have, and their lenses act on something.

use std::path::{Path, PathBuf};

use libtest_mimic::{Failed, Trial};
use veduta::{
    city::load::{LoadOptions, Quiet, load},
    figure::scene_file::{self, Options},
    scene::check_against,
};

pub fn trials() -> Vec<Trial> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let mut paths: Vec<PathBuf> = std::fs::read_dir(folder).into_iter().flatten().flatten().map(|e| e.path()).collect();
    paths.sort();
    paths.retain(|path| std::fs::read_to_string(path).is_ok_and(|text| text.contains("${VEDUTA_DATA}")));
    let name = |path: &Path| path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    paths.into_iter().map(|path| crate::trial(&format!("scenes::{}", name(&path)), move |_| check(&path))).collect()
}

fn check(path: &Path) -> Result<(), Failed> {
    let scene = scene_file::read(path, &Options::for_file(path))?;
    let model = load(&scene.city.files, &LoadOptions::default(), &Quiet)?;
    if let Some(problem) = check_against(&scene, &model).first() {
        return Err(problem.to_string().into());
    }
    for lens in &scene.lenses {
        let meets_some = lens.shapes.iter().any(|shape| {
            let bounds = shape.volume().map(|v| v.bounds());
            bounds.is_ok_and(|b| model.geometries.iter().filter(|g| g.bounds.meets(&b)).count() >= 5)
        });
        if !meets_some {
            return Err(format!("{} acts on fewer than five geometries", lens.name).into());
        }
    }
    Ok(())
}
