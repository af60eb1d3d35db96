//! The handlers that `docs/effects.md` shows, with the lenses that it shows beside them, on a real city: both back ends draw the same
//! picture, depths, objects and masks, with shadows.

use libtest_mimic::{Failed, Trial};
use veduta::{
    figure::scene_file::{self, Options},
    render::{
        frame::Backend,
        picture::{Request, Studio},
    },
    scene::Scene,
    shader::effect,
};

use crate::studio;

const DELFT: &str = "3dbag-delft/3dbag_5908_delft.v1.1.city.jsonl";
const SIZE: [u32; 2] = [640, 400];

/// The file and the lens that the page shows under a heading.
fn documented(heading: &str) -> Option<(&'static str, &'static str)> {
    let page = include_str!("../../docs/effects.md");
    let section = page.split("\n### ").find(|section| section.starts_with(heading))?;
    let block = |kind: &str| section.split(&format!("```{kind}\n")).nth(1)?.split("```").next();
    Some((block("wgsl")?, block("toml")?))
}

pub fn trials() -> Vec<Trial> {
    let one = |heading: &'static str| {
        let name = heading.trim_start_matches("A ");
        crate::trial(&format!("own_handlers::a_{name}_of_the_docs"), move |root| {
            let (file, lens) = documented(heading).ok_or("the page shows none")?;
            effect::add(&format!("{name}.wgsl"), file).map_err(|error| error.to_string())?;
            let city = root.join(DELFT).display().to_string();
            let text = format!("veduta = 1\n[city]\nfiles = [{city:?}]\n\n{lens}");
            let options = Options { allow_outside: true, ..Options::default() };
            let scene = scene_file::parse(&text, "docs.toml", &options)?;
            let mut studio = studio::of_scene(&scene);
            drawn_alike(&mut studio, &scene)
        })
    };
    ["A deformation", "A region", "A transform"].map(one).into()
}

fn drawn_alike(studio: &mut Studio, scene: &Scene) -> Result<(), Failed> {
    let mut draw = |scene: &Scene, backend| {
        let aovs = studio::ALL;
        studio.render(scene, &Request { aovs, statistics: true, backend, ..Request::plain(SIZE) })
    };
    let [one, other] = [draw(scene, Backend::Specialised)?, draw(scene, Backend::Uber)?];
    if one.rgba != other.rgba || one.depth != other.depth || one.object_id != other.object_id {
        return Err("the back ends differ".into());
    }
    if one.lens_mask != other.lens_mask || one.normal != other.normal {
        return Err("the back ends differ in masks or normals".into());
    }
    let without = draw(&Scene { lenses: Vec::new(), ..scene.clone() }, Backend::Specialised)?;
    let changed = one.rgba.iter().zip(&without.rgba).filter(|(a, b)| a != b).count();
    let warnings = &one.statistics.warnings;
    let is_weakened = warnings.iter().any(|warning| warning["code"] == "deformation-weakened");
    if changed < 1500 || is_weakened {
        return Err(format!("{changed} pixels are changed; {warnings:?}").into());
    }
    Ok(())
}
