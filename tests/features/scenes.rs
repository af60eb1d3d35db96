//! The shipped scenes are right, and say in their first line what they show.

use std::path::{Path, PathBuf};

use veduta::{
    city::load::{LoadOptions, Quiet, load},
    figure::scene_file::{self, Options},
    geom::{Volume, shape::Sightlines},
    lens::{Placement, Region},
    scene::{Scene, check_against},
    view::View,
};

fn scenes() -> Vec<(PathBuf, Scene)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let mut paths: Vec<PathBuf> = std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).collect();
    paths.retain(|path| path.extension().is_some_and(|e| e == "toml"));
    paths.retain(|path| !path.to_str().unwrap().ends_with(".sheet.toml"));
    paths.sort();
    let read = |path: PathBuf| {
        // Data need not be there to read the scene.
        let data = Some(PathBuf::from("/data"));
        let scene = scene_file::read(&path, &Options { data, ..Options::for_file(&path) }).unwrap();
        (path, scene)
    };
    paths.into_iter().map(read).collect()
}

#[test]
fn all_of_them_are_read_described_and_read_again() {
    let scenes = scenes();
    assert!(scenes.len() >= 7);
    for (path, scene) in scenes {
        let text = std::fs::read_to_string(&path).unwrap();
        let first = text.lines().next().unwrap_or_default();
        assert!(first.starts_with("# ") && first.ends_with('.'), "{}: begin with what it shows", path.display());
        let again = scene_file::parse(&scene_file::to_toml(&scene), "again", &Options::for_command_line()).unwrap();
        assert_eq!(again, scene, "{}", path.display());
        let view = View::new(scene.camera.expect("a camera"), scene.figure.size, &veduta::geom::Aabb::EMPTY).unwrap();
        let (eye, world_from_view) = (view.camera.eye, view.basis.view_from_world().transpose());
        let sight = Sightlines::From(eye);
        for lens in &scene.lenses {
            // What it is attached to need not be there to read the scene.
            if !matches!(lens.placement, Placement::World | Placement::Camera) {
                continue;
            }
            // Of a corridor some part.
            let is_seen = |volume: &Volume| {
                let middle = match volume {
                    Volume::Flat(flat) => flat.center(),
                    _ => volume.bounds().center(),
                };
                let is_of_camera = lens.placement == Placement::Camera;
                let at = view.pixel(if is_of_camera { eye + world_from_view * middle } else { middle });
                let [width, height] = scene.figure.size.map(f64::from);
                at.is_some_and(|at| (0.0..width).contains(&at.x) && (0.0..height).contains(&at.y))
            };
            for shape in &lens.shapes {
                let volumes = shape.volumes_seen(&sight).unwrap();
                let is_there = volumes.is_empty() || volumes.iter().any(is_seen);
                assert!(is_there, "{}: {} is seen", path.display(), lens.name);
            }
        }
    }
}

#[test]
fn those_of_the_built_in_town_name_what_it_has() {
    let model = load(&["builtin:town".into()], &LoadOptions::default(), &Quiet).unwrap();
    let built_in = |s: &Scene| s.city.files == [PathBuf::from("builtin:town")];
    let scenes: Vec<_> = scenes().into_iter().filter(|(_, s)| built_in(s)).collect();
    assert!(scenes.len() >= 2);
    for (path, scene) in scenes {
        assert_eq!(check_against(&scene, &model), [], "{}", path.display());
        for lens in scene.lenses.iter().filter(|l| l.placement == Placement::World) {
            let sight = Sightlines::From(scene.camera.unwrap().eye);
            // Of whole objects: what they stand in.
            let areas = lens.shapes.iter().flat_map(|shape| match shape {
                Region::Enclosed { parts, .. } => parts.iter().collect(),
                shape => vec![shape],
            });
            let volumes = areas.flat_map(|s| s.volumes_seen(&sight).unwrap());
            let meets = volumes.into_iter().any(|v| v.bounds().meets(&model.extent()));
            let is_everywhere = lens.shapes.is_empty() && lens.deform().is_some();
            assert!(meets || is_everywhere, "{}: {} acts on nothing", path.display(), lens.name);
        }
    }
}
