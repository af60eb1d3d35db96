//! The shipped scenes of the shared data name what the cities have, their lenses act on something, and both back ends draw them
//! alike.

use std::{
    path::{Path, PathBuf},
    sync::Arc,
};

use libtest_mimic::{Failed, Trial};
use veduta::{
    city::{
        Geometry,
        load::{LoadOptions, Quiet, load},
    },
    figure::{
        self,
        scene_file::{self, Options},
    },
    gpu::Gpu,
    lens::Lens,
    render::{
        frame::Backend,
        picture::{Aovs, Request, Studio},
    },
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
    let model = Arc::new(model);
    let mut studio = Studio::new(Gpu::open()?, model.clone(), &scene.city)?;
    let volumes = studio.lens_volumes(&scene, scene.figure.size)?;
    // Those with an overlay have no focus area, nor those that bend rays, or are about the eye or about objects.
    let has_area = |lens: &Lens| {
        !lens.kind.has_overlay() && lens.ray().is_none() && lens.deform().is_none_or(|d| !d.needs_no_area())
    };
    for (i, lens) in scene.lenses.iter().enumerate().filter(|(_, lens)| has_area(lens)) {
        let own = volumes.iter().filter(|v| v.lens as usize == i);
        let bounds: Vec<_> = own.map(|v| v.bounds).collect();
        let meets = |g: &&Geometry| bounds.iter().any(|b| g.bounds.meets(b));
        if model.geometries.iter().filter(meets).count() < 5 {
            return Err(format!("{} acts on fewer than five geometries", lens.name).into());
        }
    }
    let mut draw = |backend: Backend| {
        let aovs = Aovs { depth: true, object_id: true, normal: false, lens_mask: true };
        let request = Request { samples: 2, aovs, backend, ..Request::plain([240, 135]) };
        figure::draw_untitled(&mut studio, &scene, &request)
    };
    let (a, b) = (draw(Backend::Specialised)?, draw(Backend::Uber)?);
    if a.rgba != b.rgba || a.lens_mask != b.lens_mask || a.object_id != b.object_id {
        let pixels = a.rgba.iter().zip(&b.rgba).filter(|(a, b)| a != b);
        let most = pixels.clone().flat_map(|(a, b)| (0..4).map(move |i| a[i].abs_diff(b[i]))).max().unwrap_or(0);
        let (masks, ids) = (a.lens_mask != b.lens_mask, a.object_id != b.object_id);
        return Err(format!(
            "the two back ends differ: in {} colours, by {most} at most; masks {masks}, ids {ids}",
            pixels.count()
        )
        .into());
    }
    Ok(())
}
