use std::sync::atomic::{AtomicU32, Ordering::Relaxed};

use glam::DVec2;

use super::*;
use crate::{geom::combination::Operation, lens::chosen::Choice};

/// A folder of its own, gone at the end.
struct Folder(PathBuf);

impl Folder {
    fn new() -> Self {
        static MADE: AtomicU32 = AtomicU32::new(0);
        let number = MADE.fetch_add(1, Relaxed);
        let path = std::env::temp_dir().join(format!("veduta-solids-{}-{number}", std::process::id()));
        std::fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    fn file(&self, name: &str, text: &str) -> PathBuf {
        let path = self.0.join(name);
        std::fs::write(&path, text).unwrap();
        path
    }

    /// A picture, rows from north to south: `#` white, `+` mid grey, `-` a bit darker, `o` white and see-through, else black.
    fn image(&self, name: &str, rows: &[&str]) -> PathBuf {
        let path = self.0.join(name);
        let pixel = |x: u32, y: u32| match rows[y as usize].as_bytes()[x as usize] {
            b'#' => image::Rgba([255, 255, 255, 255]),
            b'+' => image::Rgba([128, 128, 128, 255]),
            b'-' => image::Rgba([127, 127, 127, 255]),
            b'o' => image::Rgba([255, 255, 255, 127]),
            _ => image::Rgba([0, 0, 0, 255]),
        };
        image::RgbaImage::from_fn(rows[0].len() as u32, rows.len() as u32, pixel).save(&path).unwrap();
        path
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

struct City {
    model: CityModel,
    geometries: Vec<u32>,
    index: OnceLock<SpatialIndex>,
}

impl City {
    fn of(path: &Path) -> Self {
        let model = load::load(&[path.to_owned()], &LoadOptions::default(), &load::Quiet).unwrap();
        let geometries = shown_geometries(&model, None);
        Self { model, geometries, index: OnceLock::new() }
    }

    fn named(name: &str) -> Self {
        Self::of(&Path::new("citydata").join(name))
    }

    fn shown(&self) -> ShownCity<'_> {
        ShownCity { model: &self.model, geometries: &self.geometries, index: &self.index, number: 0 }
    }

    fn ask(&self, solids: &mut Solids, region: &Region) -> Result<Vec<Volume>, RegionError> {
        let sight = Sightlines::From(DVec3::ZERO);
        solids.volumes(region, self.shown(), &Place { motion: Motion::NONE, sight })
    }

    fn one(&self, region: &Region) -> Volume {
        let mut all = self.ask(&mut Solids::default(), region).unwrap();
        assert_eq!(all.len(), 1, "{region:?}");
        all.remove(0)
    }

    fn error(&self, region: &Region) -> (String, String) {
        self.ask(&mut Solids::default(), region).expect_err("something is wrong")
    }
}

fn objects(ids: &[&str]) -> Region {
    Region::Objects(Choice { ids: ids.iter().map(|id| (*id).to_owned()).collect(), ..Choice::default() })
}

fn mesh(file: impl Into<PathBuf>) -> Region {
    Region::Mesh { file: file.into(), at: DVec3::ZERO, rotation: DQuat::IDENTITY, scale: 1.0 }
}

fn solid(volume: &Volume) -> &PlacedSolid {
    let Volume::Solid(placed) = volume else { panic!("{volume:?}") };
    placed
}

/// By the divergence theorem, cubic metres.
fn size(volume: &Volume) -> f64 {
    solid(volume).solid.faces().iter().map(|[a, b, c]| a.dot(b.cross(*c)) / 6.0).sum()
}

fn assert_holds(volume: &Volume, inside: &[[f64; 3]], outside: &[[f64; 3]]) {
    for (places, expected) in [(inside, true), (outside, false)] {
        for p in places {
            assert_eq!(volume.contains(DVec3::from(*p)), expected, "{p:?}");
        }
    }
}

#[test]
fn objects_are_the_union_of_their_bodies() {
    let cloister = City::named("courtyard.city.json").one(&objects(&["cloister"]));
    assert_holds(
        &cloister,
        &[[5.0, 5.0, 4.0], [25.0, 15.0, 8.9]],
        &[[15.0, 15.0, 4.0], [15.0, 15.0, -1.0], [5.0, 5.0, 9.1]],
    );
    assert!((size(&cloister) - 9.0 * (900.0 - 100.0)).abs() < 0.01, "{}", size(&cloister));

    let vault = City::named("inner-shell.city.json").one(&objects(&["vault"]));
    assert_holds(&vault, &[[1.0, 5.0, 5.0], [5.0, 5.0, 9.0]], &[[5.0, 5.0, 5.0], [11.0, 5.0, 5.0]]);
    assert!((size(&vault) - (1000.0 - 64.0)).abs() < 0.01, "{}", size(&vault));

    let twins = City::named("multisolid.city.json").one(&objects(&["twins"]));
    assert_holds(&twins, &[[2.0, 2.0, 2.0], [8.0, 2.0, 2.0]], &[[5.0, 2.0, 2.0]]);

    let row = City::named("party-wall.city.json");
    let both = row.one(&objects(&["left", "right"]));
    assert_holds(&both, &[[3.0, 4.0, 5.0], [9.0, 4.0, 8.0], [6.0, 4.0, 3.0]], &[[3.0, 4.0, 7.0]]);
    let left = row.one(&objects(&["left"]));
    assert_holds(&left, &[[3.0, 4.0, 5.0]], &[[9.0, 4.0, 5.0]]);
    let Region::Objects(choice) = objects(&["left"]) else { unreachable!() };
    let others = row.one(&Region::Objects(Choice { except: true, ..choice }));
    assert_holds(&others, &[[9.0, 4.0, 5.0]], &[[3.0, 4.0, 5.0]]);
}

/// A house whose floor is missing, and a yard that is a flat face.
const OPEN: &str = r#"{"type":"CityJSON","version":"2.0","transform":{"scale":[1,1,1],"translate":[0,0,0]},"CityObjects":{
"house":{"type":"Building","geometry":[{"type":"MultiSurface","lod":"2","boundaries":[[[4,5,6,7]],[[0,1,5,4]],[[1,2,6,5]],[[2,3,7,6]],[[3,0,4,7]]]}]},
"yard":{"type":"LandUse","geometry":[{"type":"MultiSurface","lod":"2","boundaries":[[[8,9,10,11]]]}]}},
"vertices":[[0,0,0],[10,0,0],[10,10,0],[0,10,0],[0,0,10],[10,0,10],[10,10,10],[0,10,10],[20,0,0],[30,0,0],[30,10,0],[20,10,0]]}"#;

#[test]
fn open_buildings_are_closed_and_flat_objects_hold_nothing() {
    let folder = Folder::new();
    let city = City::of(&folder.file("open.city.json", OPEN));
    let house = city.one(&objects(&["house"]));
    assert_holds(&house, &[[5.0, 5.0, 5.0], [0.1, 0.1, 0.1]], &[[5.0, 5.0, -0.1], [25.0, 5.0, 0.0]]);
    assert!((size(&house) - 1000.0).abs() < 1e-6);
    assert_eq!(solid(&house).solid.mended, 4);
    assert!(city.ask(&mut Solids::default(), &objects(&["yard"])).unwrap().is_empty());
    // Who is not there has no body: the check of the scene says so.
    assert!(city.ask(&mut Solids::default(), &objects(&["hose"])).unwrap().is_empty());
    let both = city.one(&objects(&["hose", "house"]));
    assert_eq!(solid(&both).solid.faces(), solid(&house).solid.faces());
}

#[test]
fn masks_are_the_light_pixels_of_images() {
    let folder = Folder::new();
    let nowhere = City { model: CityModel::default(), geometries: vec![], index: OnceLock::new() };
    let image = folder.image("mask.png", &["#.+", "-o#"]);
    let mask = |size: DVec2, height: f64| Region::Mask {
        image: image.clone(),
        corner: DVec2::new(100.0, 200.0),
        size,
        base: 3.0,
        height,
    };
    let volume = nowhere.one(&mask(DVec2::new(30.0, 20.0), 7.0));
    // West to east, the northern row first.
    let inside = [[105.0, 215.0, 5.0], [125.0, 215.0, 9.9], [125.0, 205.0, 3.1]];
    let outside =
        [[115.0, 215.0, 5.0], [105.0, 205.0, 5.0], [115.0, 205.0, 5.0], [125.0, 205.0, 2.9], [125.0, 205.0, 10.1]];
    assert_holds(&volume, &inside, &outside);
    assert!((size(&volume) - 3.0 * 700.0).abs() < 0.01);
    assert!(nowhere.ask(&mut Solids::default(), &mask(DVec2::new(30.0, 20.0), 0.0)).unwrap().is_empty());
    assert!(nowhere.ask(&mut Solids::default(), &mask(DVec2::new(0.0, 20.0), 7.0)).unwrap().is_empty());
    assert_eq!(nowhere.error(&mask(DVec2::new(1e-30, 1e-30), 7.0)).0, "size");
    assert_eq!(nowhere.error(&mask(DVec2::new(-1.0, 20.0), 7.0)).0, "size");

    let layers = ["##", ".#", ".."].map(|row| folder.image(&format!("{}.png", row.replace('.', "_")), &[row]));
    let pile = |images: &[PathBuf]| Region::Mask3d {
        images: images.to_vec(),
        corner: DVec3::new(0.0, 0.0, -10.0),
        size: DVec3::new(2.0, 1.0, 3.0),
    };
    let stairs = nowhere.one(&pile(&layers));
    let outside = [[0.5, 0.5, -8.5], [1.5, 0.5, -7.5], [1.5, 1.5, -9.5]];
    assert_holds(&stairs, &[[0.5, 0.5, -9.5], [1.5, 0.5, -9.5], [1.5, 0.5, -8.5]], &outside);
    assert_eq!(nowhere.error(&pile(&layers[2..])).0, "images");
    let (key, message) = nowhere.error(&pile(&[layers[0].clone(), image]));
    assert_eq!(key, "images.1");
    assert!(message.contains("3x2") && message.contains("2x1"), "{message}");
}

#[test]
fn meshes_are_what_files_enclose() {
    let nowhere = City { model: CityModel::default(), geometries: vec![], index: OnceLock::new() };
    let ring = nowhere.one(&mesh("citydata/ring.obj"));
    assert_holds(&ring, &[[1.0, 0.0, 0.0], [0.0, -1.2, 0.1]], &[[0.0, 0.0, 0.0], [1.4, 0.0, 0.0], [1.0, 0.0, 0.4]]);
    assert_eq!(solid(&ring).solid.mended, 0);
    let moved = nowhere.one(&Region::Mesh {
        file: "citydata/ring.obj".into(),
        at: DVec3::new(500.0, 0.0, 20.0),
        rotation: DQuat::from_rotation_x(std::f64::consts::FRAC_PI_2),
        scale: 10.0,
    });
    // Upright: its hole is along y.
    assert_holds(
        &moved,
        &[[510.0, 0.0, 20.0], [500.0, 0.0, 30.0]],
        &[[500.0, 0.0, 20.0], [500.0, 10.0, 20.0], [1.0, 0.0, 0.0]],
    );
    assert!((size(&moved) / size(&ring) - 1000.0).abs() < 0.1);
    // A cube of glTF, in national coordinates.
    let cube = nowhere.one(&mesh("citydata/national.gltf"));
    let bounds = cube.bounds();
    assert!(cube.contains(bounds.center()) && !cube.contains(bounds.max + 0.01), "{bounds:?}");
    let sides = bounds.size();
    assert!((size(&cube) - sides.x * sides.y * sides.z).abs() < 0.01 * size(&cube), "{bounds:?}");
}

#[test]
fn what_was_made_is_kept_while_it_is_asked_for() {
    let nowhere = City { model: CityModel::default(), geometries: vec![], index: OnceLock::new() };
    let mut solids = Solids::default();
    let first = nowhere.ask(&mut solids, &mesh("citydata/ring.obj")).unwrap();
    let moved = Region::Mesh {
        file: "citydata/ring.obj".into(),
        at: DVec3::new(3.0, 2.0, 1.0),
        rotation: DQuat::from_rotation_z(1.0),
        scale: 1.0,
    };
    let second = nowhere.ask(&mut solids, &moved).unwrap();
    assert!(Arc::ptr_eq(&solid(&first[0]).solid, &solid(&second[0]).solid), "moving a mesh makes it anew");
    assert_ne!(first[0].bounds(), second[0].bounds());
    let larger =
        Region::Mesh { file: "citydata/ring.obj".into(), at: DVec3::ZERO, rotation: DQuat::IDENTITY, scale: 2.0 };
    assert!(!Arc::ptr_eq(&solid(&first[0]).solid, &solid(&nowhere.ask(&mut solids, &larger).unwrap()[0]).solid));
    solids.forget_others();
    // Asked for since: kept. The larger one was not: made anew, and another.
    let kept = nowhere.ask(&mut solids, &moved).unwrap();
    solids.forget_others();
    assert_eq!(solids.made.len(), 1);
    assert!(Arc::ptr_eq(&solid(&kept[0]).solid, &solid(&first[0]).solid));
    solids.forget_others();
    assert!(solids.made.is_empty());

    let row = City::named("party-wall.city.json");
    let once = row.ask(&mut solids, &objects(&["left"])).unwrap();
    let twice = row.ask(&mut solids, &objects(&["left"])).unwrap();
    assert!(Arc::ptr_eq(&solid(&once[0]).solid, &solid(&twice[0]).solid));
}

#[test]
fn wrong_files_are_named_with_their_key() {
    let folder = Folder::new();
    let nowhere = City { model: CityModel::default(), geometries: vec![], index: OnceLock::new() };
    let text = folder.file("text.png", "hello");
    let black = folder.image("black.png", &[".."]);
    let no_face = folder.file("points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n");
    let flat = folder.file("flat.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    let missing = folder.0.join("none.png");
    let mask = |image: &PathBuf| Region::Mask {
        image: image.clone(),
        corner: DVec2::ZERO,
        size: DVec2::ONE,
        base: 0.0,
        height: 1.0,
    };
    for (region, key, name, words) in [
        (mask(&text), "image", "text.png", "no image of a kind that is read"),
        (mask(&black), "image", "black.png", "empty"),
        (mask(&missing), "image", "none.png", "cannot be read"),
        (mesh(&no_face), "file", "points.obj", "no faces"),
        (mesh(&flat), "file", "flat.obj", "no volume"),
        (mesh(&missing), "file", "none.png", "cannot be read"),
        (mesh(&text), "file", "text.png", "text"),
        (mesh(&folder.0), "file", "veduta-solids", "is a folder"),
        (
            Region::Mesh { file: "citydata/ring.obj".into(), at: DVec3::ZERO, rotation: DQuat::IDENTITY, scale: 0.0 },
            "scale",
            "",
            "> 0",
        ),
    ] {
        let (at, message) = nowhere.error(&region);
        assert_eq!(at, key, "{message}");
        assert!(message.contains(name) && message.contains(words), "{message}");
        assert!(!message.contains('\n'), "{message}");
    }
    // Choices and combinations are no volumes: who draws them asks for their parts.
    let union = Region::Combined { how: Operation::Union, parts: vec![mesh("citydata/ring.obj")] };
    assert!(nowhere.ask(&mut Solids::default(), &union).unwrap().is_empty());
}
