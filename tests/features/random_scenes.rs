//! Random scenes of two to four lenses of any kind: both back ends draw the same, to the byte but for colours between two steps.

use std::time::Instant;

use crate::studio::{
    random_scene::{FAMILY, Wanted, scene},
    *,
};
use veduta::{
    figure::scene_file::{Options, parse},
    render::{
        frame::Backend,
        picture::{Picture, Request, Studio},
    },
    scene::Scene,
};

/// Of pictures in an ordinary run; a thorough one draws more of them.
const SIZE: [u32; 2] = [200, 125];
const THOROUGH_SIZE: [u32; 2] = [120, 75];
/// Scenes that every run draws, of as many families, and those of a thorough one, which draws all of a family.
const SCENES: u64 = 4;
const ALL_SCENES: u64 = 10_000;

fn drawn(studio: &mut Studio, scene: &Scene, backend: Backend) -> Result<Picture, String> {
    let size = if is_thorough() { THOROUGH_SIZE } else { SIZE };
    let request = Request { aovs: ALL, statistics: true, backend, ..Request::plain(size) };
    studio.render(scene, &request).map_err(|error| error.to_string())
}

/// Pixels whose colours may be a step of 255 apart. Colours that lie between two steps go to one or the other by their last bit, and that
/// is the compiler's: it may put sums and products together as a program suits it, which WGSL cannot forbid.
const BETWEEN_STEPS: usize = 2;

fn are_colors_same(one: &[[u8; 4]], other: &[[u8; 4]]) -> bool {
    let differ: Vec<_> = one.iter().zip(other).filter(|(a, b)| a != b).collect();
    differ.len() <= BETWEEN_STEPS && differ.iter().all(|(a, b)| a.iter().zip(*b).all(|(a, b)| a.abs_diff(*b) <= 1))
}

/// What of two pictures differs.
fn differences(one: &Picture, other: &Picture) -> Vec<&'static str> {
    let same = [
        ("colours", are_colors_same(&one.rgba, &other.rgba)),
        ("depths", one.depth == other.depth),
        ("object ids", one.object_id == other.object_id),
        ("normals", one.normal == other.normal),
        ("masks", one.lens_mask == other.lens_mask),
    ];
    same.into_iter().filter(|(_, is_same)| !is_same).map(|(what, _)| what).collect()
}

/// Whether both draw the same to the byte; `None`: neither can draw it.
fn same_by_both(studio: &mut Studio, text: &str) -> Result<Option<bool>, String> {
    let scene = parse(text, "random.toml", &outside()).unwrap_or_else(|error| panic!("{error}\n{text}"));
    let one = drawn(studio, &scene, Backend::Specialised);
    let other = drawn(studio, &scene, Backend::Uber);
    match (one, other) {
        (Ok(one), Ok(other)) => {
            let found = differences(&one, &other);
            if found.is_empty() {
                Ok(Some(one.rgba == other.rgba))
            } else {
                Err(format!("{} differ:\n{text}", found.join(", ")))
            }
        }
        (Err(one), Err(other)) if one == other => Ok(None),
        (one, other) => {
            let said = [one, other].map(|drawn| drawn.err().unwrap_or_else(|| "a picture".to_owned()));
            Err(format!("{} and {}:\n{text}", said[0], said[1]))
        }
    }
}

/// Seeds that are tried; `VEDUTA_SEEDS=FROM..TO`: these.
fn seeds() -> Vec<u64> {
    let given = std::env::var("VEDUTA_SEEDS").ok().and_then(|text| {
        let (from, to) = text.split_once("..")?;
        Some((from.parse().ok()?..to.parse().ok()?).collect())
    });
    given.unwrap_or_else(|| match is_thorough() {
        true => (0..ALL_SCENES).collect(),
        false => (0..SCENES).map(|family| family * FAMILY).collect(),
    })
}

/// Draws the scenes of these seeds by both; `of`: the studio and the text of one. `share`: how many of ten have to be drawn.
#[allow(clippy::print_stdout, reason = "what is drawn is told beside the results")]
fn draw_by_both(all: &[u64], share: usize, of: impl Fn(u64) -> (usize, String), studios: &mut [Studio]) {
    let (mut count, mut between, mut wrong) = (0, 0, Vec::new());
    for seed in all {
        let (which, text) = of(*seed);
        let started = Instant::now();
        println!("seed {seed}:\n{text}");
        match same_by_both(&mut studios[which], &text) {
            Ok(drawn) => {
                count += usize::from(drawn.is_some());
                between += usize::from(drawn == Some(false));
            }
            Err(difference) => {
                println!("seed {seed}: {difference}");
                wrong.push(format!("seed {seed}: {difference}"));
            }
        }
        println!("seed {seed}: {:.1} s", started.elapsed().as_secs_f64());
    }
    let total = all.len();
    println!("{count} of {total} scenes drawn, {between} of them with colours between two steps");
    assert!(wrong.is_empty(), "{} of {total} scenes:\n{}", wrong.len(), wrong.join("\n"));
    assert!(count * 10 > total * share, "{count} of {total} scenes can be drawn");
}

/// Seeds of families of their own: each thing that is drawn over random scenes has others. Programs of both back ends take long to compile: few.
fn seeds_beside(family: u64, most: usize) -> Vec<u64> {
    let mut all: Vec<u64> = seeds().into_iter().map(|seed| seed + family * FAMILY).collect();
    if !is_thorough() {
        all.truncate(most);
    }
    all
}

#[test]
fn both_back_ends_draw_random_scenes_the_same() {
    let wanted = Wanted { lenses: [2, 4], deformations: true, history: None };
    let cities = ["builtin:square", "builtin:town"];
    let mut studios = cities.map(|city| of_scene(&parse_city(city)));
    let of = |seed: u64| {
        let which = (seed / FAMILY % 2) as usize;
        (which, scene(seed, cities[which], wanted))
    };
    draw_by_both(&seeds(), 8, of, &mut studios);
}

/// Lenses that bend rays, over a random scene.
fn bends(seed: u64) -> &'static str {
    const ALL: [&str; 10] = [
        "kind = \"magnifier\"\nray = { center = [0.4, 0.5], radius = 0.4, method = \"image\" }",
        "kind = \"magnifier\"\nray = { center = [0.4, 0.5], radius = 0.4 }",
        "kind = \"sampling\"\nray = { radius = 0.45, magnification = 3.0, method = \"vertices\" }",
        "kind = \"fisheye\"\nray = { angle_deg = 280, method = \"image\", fineness = 1.5 }",
        "kind = \"magnifier\"\nray = { radius = 0.4, method = \"vertices\" }\n[[lens]]\nname = \"b1\"\nkind = \"magnifier\"\n\
         ray = { center = [0.6, 0.6], radius = 0.3, method = \"image\" }",
        "kind = \"magnifier\"\nray = { radius = 0.4, only = { types = [\"Building\"] } }",
        "kind = \"sampling\"\nray = { radius = 0.45, magnification = 3.0 }",
        "kind = \"magnifier\"\nray = { radius = 0.45, magnification = 0.6, border = 0.8, outline = \"square\", grid = true }\n[[lens]]\nname = \"b1\"\n\
         kind = \"magnifier\"\nray = { center = [0.6, 0.6], radius = 0.3 }\neffects = [\"sepia\"]",
        "kind = \"fisheye\"\nray = { angle_deg = 250 }",
        "kind = \"magnifier\"\nray = { radius = 0.45, magnification = 3.0 }\n[[lens]]\nname = \"large\"\n\
         shape = { kind = \"magnified\", lens = \"b0\", by = 1.4 }\neffects = [\"invert\", \"edges\"]",
    ];
    ALL[seed as usize % ALL.len()]
}

#[test]
fn both_back_ends_bend_rays_through_random_scenes_the_same() {
    let wanted = Wanted { lenses: [1, 3], deformations: true, history: None };
    let city = "builtin:square";
    let of = |seed: u64| {
        let bends = bends(if is_thorough() { seed } else { seed / FAMILY });
        (0, format!("{}\n[[lens]]\nname = \"b0\"\n{bends}\n", scene(seed, city, wanted)))
    };
    draw_by_both(&seeds_beside(2000, 2), 5, of, &mut [of_scene(&parse_city(city))]);
}

/// What volumes of a random scene are like, beside their file.
fn volumes_of(seed: u64) -> &'static str {
    const ALL: [&str; 4] = [
        "light = \"shadowed\"",
        "mode = \"maximum\"\n[[volume]]\nname = \"second\"\nmode = \"isosurface\"\nlight = \"lit\"\ntransfer = { opacity = [0.6, 0.6] }",
        "mode = \"gradient\"\n[[volume]]\nname = \"second\"\nmode = \"slice\"\ntransfer = { ramp = \"vik\", opacity = [0.5, 0.9] }",
        "mode = \"x-ray\"\n[[volume]]\nname = \"second\"\nmode = \"average\"\nstep = 0.5",
    ];
    ALL[(seed % 4) as usize]
}

#[test]
fn both_back_ends_see_through_volumes_the_same() {
    let size = [13, 11, 9];
    let file = volumes::written("seen-by-both", size, |[x, y, z]| ((x * 7 + y * 5 + z * 3) % 17) as f32);
    let wanted = Wanted { lenses: [1, 3], deformations: true, history: None };
    let city = "builtin:square";
    let of = |seed: u64| {
        let own = format!("file = {file:?}\norigin = [-60, -50, -4]\nspacing = [9, 8, 7]\n");
        let of_seed = volumes_of(if is_thorough() { seed } else { seed / FAMILY });
        let all: String = of_seed.split("[[volume]]\n").map(|volume| format!("[[volume]]\n{own}{volume}\n")).collect();
        let bends =
            if seed % 3 == 1 { "[[lens]]\nname = \"b0\"\nkind = \"magnifier\"\nray = { radius = 0.3 }\n" } else { "" };
        (0, format!("{}\n{all}{bends}", scene(seed, city, wanted)))
    };
    draw_by_both(&seeds_beside(3000, 3), 5, of, &mut [of_scene(&parse_city(city))]);
}

/// Keys of `[city]` by which things of the square move and change over centuries; the tables stay as long as the tests run.
fn history() -> &'static str {
    let model = of_scene(&parse_city("builtin:square")).model;
    let houses: Vec<&str> =
        model.objects.iter().filter(|o| o.parents.is_empty() && !o.class.is_ground()).map(|o| &*o.id).collect();
    let mut uses = "id,use,since,until\n".to_owned();
    for (i, id) in houses.iter().enumerate().filter(|(i, _)| i % 2 == 0) {
        uses += &format!("{id},home,,{}\n{id},{},{},\n", 1600 + i, ["shop", "mill"][i / 2 % 2], 1650 + 3 * i);
    }
    let mut ways = "id,t,x,y,z,yaw\n".to_owned();
    for (i, id) in houses.iter().enumerate().filter(|(i, _)| i % 9 == 0) {
        let bounds = model.family_bounds(model.find_object(id).expect("it"));
        let (at, by) = (bounds.center().with_z(bounds.min.z), 20.0 - (i % 5) as f64 * 10.0);
        ways += &format!(
            "{id},1550,{},{},{},0\n{id},1980,{},{},{},{}\n",
            at.x,
            at.y,
            at.z,
            at.x + by,
            at.y - by,
            at.z + 1.0,
            7 * i
        );
    }
    let folder = std::env::temp_dir().join(format!("veduta-history-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let [uses_file, ways_file] = [("uses.csv", uses), ("ways.csv", ways)].map(|(name, text)| {
        let file = folder.join(name);
        std::fs::write(&file, text).expect("a file");
        file.display().to_string()
    });
    format!("timetables = [{ways_file:?}]\njoin = [{{ file = {uses_file:?}, from = \"since\", until = \"until\" }}]")
        .leak()
}

#[test]
fn both_back_ends_draw_random_moments_the_same() {
    let history = history();
    let wanted = Wanted { lenses: [2, 4], deformations: true, history: Some(history) };
    let city = format!("veduta = 1\n[city]\nfiles = [\"builtin:square\"]\n{history}\n");
    let studio = of_scene(&parse(&city, "city.toml", &outside()).unwrap_or_else(|error| panic!("{error}")));
    // Every family of an ordinary run is another than that of scenes without time.
    let all = seeds_beside(1000, usize::MAX);
    draw_by_both(&all, 7, |seed| (0, scene(seed, "builtin:square", wanted)), &mut [studio]);
}

fn outside() -> Options {
    Options { allow_outside: true, ..Options::default() }
}

fn parse_city(city: &str) -> Scene {
    parse(&format!("veduta = 1\n[city]\nfiles = [\"{city}\"]\n"), "city.toml", &Options::default())
        .unwrap_or_else(|error| panic!("{error}"))
}

/// A content that no lens of the picture shows, beside a lens that hides: both programs place the city itself.
#[test]
fn a_content_that_is_not_in_the_picture_changes_nothing() {
    let scene = |lens: &str| {
        format!(
            "veduta = 1\n[city]\nfiles = [\"builtin:square\"]\n[camera]\neye = [-64.26, 44.99, 139.25]\ntarget = [0, 0, 8]\nfov_deg = 55\n\
             [[poi]]\nname = \"p\"\nat = [-4.4, 19.7, 8]\n[[lens]]\nname = \"l1\"\nkind = \"occlusion\"\npoi = \"p\"\n\
             test = {{ kind = \"exact\" }}\nrender = \"flatten\"\n{lens}"
        )
    };
    let mut studio = of_scene(&parse_city("builtin:square"));
    let cone = "{ kind = \"cone\", center = [-77.1, -36.0, 5.0], radius = 57.6, height = 42.7 }";
    for effect in ["eraser", "screen-door", "peel", "x-ray"] {
        let lens = format!(
            "[[lens]]\nname = \"l2\"\nshape = {cone}\neffects = [{{ effect = \"{effect}\", class = \"behind\" }}]\n"
        );
        assert_eq!(same_by_both(&mut studio, &scene(&lens)), Ok(Some(true)), "{effect}");
    }
}

/// A lens at rest that a deformation moves is a solid of many faces where it is shown, and software adapters end all loops of a shader after
/// 65,535 rounds: a glow around it must not take those that write the masks.
#[test]
fn a_glow_around_a_solid_of_many_faces_leaves_the_masks() {
    let text = "veduta = 1\n[city]\nfiles = [\"builtin:square\"]\n[camera]\neye = [-155.41, 18.99, 99.61]\ntarget = [-10.84, 8.88, 8]\n\
        fov_deg = 55\n[sun]\nshadows = false\n[[lens]]\nname = \"l0\"\nkind = \"deformation\"\n\
        shape = { kind = \"box\", center = [-27.15, -42.71, 13.54], size = [57.05, 49.95, 63.37] }\n\
        deform = [{ kind = \"taper\", factor = 0.92 }]\nbody = \"none\"\n[[lens]]\nname = \"l1\"\nkind = \"color\"\n\
        shape = { kind = \"ellipsoid\", center = [15.24, 10.81, 4.60], radii = [31.63, 25.83, 30.74], rotation_deg = [335, 54, -58] }\n\
        effects = [{ effect = \"sepia\", class = \"front\" }]\nspace = \"rest\"\nbody = \"halo\"\n[[lens]]\nname = \"l2\"\n\
        kind = \"content\"\nshape = { kind = \"sphere\", center = [5.60, 19.91, 4.43], radius = 46.21 }\n\
        content = { derive = \"box\", class = \"behind\" }\neffects = [\"glow\"]\nbody = \"outline\"\n";
    let mut studio = of_scene(&parse_city("builtin:square"));
    assert_eq!(same_by_both(&mut studio, text), Ok(Some(true)));
}

/// The square, some of whose materials let light through.
fn glazed_square(name: &str) -> std::path::PathBuf {
    let text = std::fs::read_to_string(citydata("square.city.json")).expect("the square");
    let mut city: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    let materials = city["appearance"]["materials"].as_array_mut().expect("materials");
    for (material, clear) in materials.iter_mut().zip([0.3, 0.75, 0.0].iter().cycle()) {
        material["transparency"] = (*clear).into();
    }
    let path = std::env::temp_dir().join(format!("veduta-glazed-{name}-{}.city.json", std::process::id()));
    std::fs::write(&path, city.to_string()).expect("a temporary file");
    path
}

/// Lenses of all kinds over materials that are translucent: hidden, deformed, shown as contents, cut open.
#[test]
fn both_back_ends_draw_random_scenes_of_glass_the_same() {
    let path = glazed_square("random");
    let mut studio = studio(std::slice::from_ref(&path));
    let (mut count, mut wrong) = (0, Vec::new());
    let seeds = match (is_thorough(), std::env::var_os("VEDUTA_SEEDS").is_some()) {
        (true, true) => seeds(),
        (true, false) => (0..400).collect(),
        _ => (0..4).map(|family| 3 * FAMILY + family * FAMILY).collect(),
    };
    for seed in seeds {
        let text = scene(seed, "glass.city.json", Wanted { lenses: [2, 4], deformations: true, history: None });
        match same_by_both(&mut studio, &text) {
            Ok(drawn) => count += usize::from(drawn.is_some()),
            Err(difference) => wrong.push(format!("seed {seed}: {difference}")),
        }
    }
    std::fs::remove_file(path).expect("the temporary file");
    println!("{count} scenes of glass drawn");
    assert!(wrong.is_empty(), "{} scenes:\n{}", wrong.len(), wrong.join("\n"));
    assert!(count > 0);
}
