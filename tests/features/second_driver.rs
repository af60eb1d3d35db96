//! Pictures by two drivers: the shipped scenes and random ones look the same within a pixel. Corners of triangles are drawn on grids that
//! differ from driver to driver, so borders may lie a pixel aside.
//!
//! `VEDUTA_SECOND_DRIVER` is a part of the second adapter's name; where its driver is not installed, `VK_DRIVER_FILES` names the files of both.
//! `VEDUTA_SCENE`: only files whose path contains this.

use std::{
    collections::BTreeSet,
    path::{Path, PathBuf},
    process::Command,
};

use exr::prelude::{FlatSamples, read_first_flat_layer_from_file};

use crate::studio::random_scene::{FAMILY, Wanted, scene};

const SIZE: [usize; 2] = [640, 360];
/// Steps of 255 that colours may differ by.
const STEPS: u8 = 2;
/// Blocks of a picture whose things may differ: what lies in narrow gaps, or on faces that a lens's face nearly touches.
const FEW: usize = SIZE[0] * SIZE[1] / 5000;
/// Blocks whose colours may: patterns as fine as pixels move by the driver's grid, too.
const FEW_COLORS: usize = SIZE[0] * SIZE[1] / 500;
/// Things that are as far as each other to this part of the distance: a grid of 1/16 pixel does not tell them apart where their faces are seen
/// at a slant.
const AS_FAR: f32 = 2e-3;
/// What one picture may cost: a software driver's compiler takes more than all memory for some programs.
const LIMITS: &str = "ulimit -v 16000000; exec timeout 150 \"$0\" \"$@\"";
/// Families of random scenes; the first of each is drawn.
const FAMILIES: std::ops::Range<u64> = 0..40;

/// A picture, row by row.
struct Drawn {
    colors: Vec<[u8; 4]>,
    ids: Vec<u32>,
    /// The words of lens masks, 32 lenses each.
    masks: Vec<Vec<u32>>,
    /// Metres; infinite where nothing is.
    depths: Vec<f32>,
}

fn channels(path: &Path) -> Vec<FlatSamples> {
    let image = read_first_flat_layer_from_file(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    image.layer_data.channel_data.list.into_iter().map(|channel| channel.sample_data).collect()
}

fn words(samples: &FlatSamples) -> &[u32] {
    match samples {
        FlatSamples::U32(words) => words,
        _ => panic!("numbers are whole"),
    }
}

fn drawn(adapter: &str, file: &Path, folder: &Path) -> Result<Drawn, String> {
    let [picture, ids, masks, depths] = ["picture.png", "ids.png", "masks.exr", "depths.exr"].map(|n| folder.join(n));
    let run = Command::new("sh")
        .args(["-c", LIMITS, env!("CARGO_BIN_EXE_veduta"), "render"])
        .arg(file)
        // A border of a shadow on a wall that the light grazes moves by many pixels where the map's corners move by a part of one.
        .args(["--set", "sun.shadows=false"])
        .args(["--quiet", "--samples", "1", "--size", &format!("{}x{}", SIZE[0], SIZE[1]), "-o"])
        .arg(&picture)
        .args(["--aov", &format!("object-id={}", ids.display())])
        .args(["--aov", &format!("lens-mask={}", masks.display())])
        .args(["--aov", &format!("depth={}", depths.display())])
        .env("VEDUTA_ADAPTER", adapter)
        .output()
        .expect("sh");
    if !run.status.success() {
        let said = String::from_utf8_lossy(&run.stderr);
        return Err(format!("{}: {}", run.status, said.lines().last().unwrap_or_default()));
    }
    let colors = image::open(picture).expect("a picture").to_rgba8().pixels().map(|pixel| pixel.0).collect();
    let ids: Vec<u32> = image::open(ids)
        .expect("numbers")
        .to_rgb8()
        .pixels()
        .map(|p| p.0.iter().fold(0, |id, c| id << 8 | u32::from(*c)))
        .collect();
    let planes = channels(&masks);
    let masks = (0..ids.len()).map(|i| planes.iter().map(|plane| words(plane)[i]).collect()).collect();
    let depths = channels(&depths)[0].values_as_f32().collect();
    Ok(Drawn { colors, ids, masks, depths })
}

/// The pixels around one, and it.
fn around(i: usize) -> impl Iterator<Item = usize> + Clone {
    let near = |at: usize, size: usize| at.saturating_sub(1)..(at + 2).min(size);
    let (columns, rows) = (near(i % SIZE[0], SIZE[0]), near(i / SIZE[0], SIZE[1]));
    rows.flat_map(move |y| columns.clone().map(move |x| SIZE[0] * y + x))
}

/// Whether a colour is between the least and the most of others, and so many steps more.
fn is_between(color: [u8; 4], others: impl Iterator<Item = [u8; 4]> + Clone) -> bool {
    (0..4).all(|c| {
        let least = others.clone().map(|other| other[c]).min().unwrap_or(0);
        let most = others.clone().map(|other| other[c]).max().unwrap_or(255);
        (least.saturating_sub(STEPS)..=most.saturating_add(STEPS)).contains(&color[c])
    })
}

/// Blocks of two by two pixels, by their first, none of which is there in the other picture. What is thinner may be seen by one driver and
/// not by the other.
fn blocks(is_there: impl Fn(usize) -> bool) -> Vec<[usize; 2]> {
    let alone: BTreeSet<usize> = (0..SIZE[0] * SIZE[1]).filter(|i| !is_there(*i)).collect();
    let is_block =
        |i: &usize| i % SIZE[0] + 1 < SIZE[0] && [1, SIZE[0], SIZE[0] + 1].iter().all(|by| alone.contains(&(i + by)));
    alone.iter().filter(|i| is_block(i)).map(|i| [i % SIZE[0], i / SIZE[0]]).collect()
}

/// What differs, in words, and whether it is no more than may.
fn differences(one: &Drawn, other: &Drawn) -> (String, bool) {
    // Other things, as far as each other.
    let is_doubtful = |i: usize| {
        let [a, b] = [one.depths[i], other.depths[i]];
        one.ids[i] != other.ids[i] && (a - b).abs() <= AS_FAR * a.min(b)
    };
    let colors =
        |a: &Drawn, b: &Drawn| blocks(|i| is_doubtful(i) || is_between(a.colors[i], around(i).map(|k| b.colors[k])));
    let ids = |a: &Drawn, b: &Drawn| blocks(|i| is_doubtful(i) || around(i).any(|k| b.ids[k] == a.ids[i]));
    let masks = |a: &Drawn, b: &Drawn| blocks(|i| is_doubtful(i) || around(i).any(|k| b.masks[k] == a.masks[i]));
    let mut is_right = true;
    let mut said = Vec::new();
    for (what, most, both) in [
        ("colours", FEW_COLORS, [colors(one, other), colors(other, one)]),
        ("object ids", FEW, [ids(one, other), ids(other, one)]),
        ("masks", FEW, [masks(one, other), masks(other, one)]),
    ] {
        if let Some(first) = both.iter().flatten().next() {
            said.push(format!("{} and {} blocks of {what}, first {first:?}", both[0].len(), both[1].len()));
        }
        is_right &= both.iter().all(|found| found.len() <= most);
    }
    (said.join("; "), is_right)
}

/// The shipped scenes that can be drawn here, and random ones.
fn scenes(folder: &Path) -> Vec<PathBuf> {
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let mut all: Vec<PathBuf> = std::fs::read_dir(shipped).unwrap().map(|e| e.unwrap().path()).collect();
    let has_data = std::env::var_os("VEDUTA_DATA").is_some();
    all.retain(|path| {
        let name = path.to_string_lossy();
        let is_there = || has_data || !std::fs::read_to_string(path).unwrap().contains("VEDUTA_DATA");
        name.ends_with(".toml") && !name.ends_with(".sheet.toml") && is_there()
    });
    all.sort();
    for family in FAMILIES {
        let path = folder.join(format!("random-{family}.toml"));
        let city = ["builtin:square", "builtin:town"][family as usize % 2];
        std::fs::write(
            &path,
            scene(family * FAMILY, city, Wanted { lenses: [2, 4], deformations: true, history: None }),
        )
        .unwrap();
        all.push(path);
    }
    all
}

#[test]
#[ignore = "asks for a second driver, which VEDUTA_SECOND_DRIVER names"]
fn two_drivers_draw_the_same_within_a_pixel() {
    let second = std::env::var("VEDUTA_SECOND_DRIVER").expect("VEDUTA_SECOND_DRIVER: a part of the adapter's name");
    let first = std::env::var("VEDUTA_FIRST_DRIVER").unwrap_or_else(|_| "llvmpipe".to_owned());
    let wanted = std::env::var("VEDUTA_SCENE").unwrap_or_default();
    let folder = std::env::temp_dir().join(format!("veduta-drivers-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let (mut count, mut wrong, mut left) = (0, Vec::new(), Vec::new());
    for file in scenes(&folder).into_iter().filter(|file| file.to_string_lossy().contains(&wanted)) {
        let name = file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let said = match [&first, &second].map(|adapter| drawn(adapter, &file, &folder)) {
            [Ok(one), Ok(other)] => {
                count += 1;
                let (found, is_right) = differences(&one, &other);
                if !is_right {
                    wrong.push(format!("{name}: {found}"));
                }
                found
            }
            // Random scenes may ask for too much.
            [Err(one), Err(other)] if one == other && name.starts_with("random") => one,
            [one, other] => {
                let why = [one, other].map(|drawn| drawn.err().unwrap_or_else(|| "a picture".to_owned())).join(" and ");
                left.push(format!("{name}: {why}"));
                why
            }
        };
        println!("{name}: {said}");
    }
    let _ = std::fs::remove_dir_all(&folder);
    println!("{count} compared; left out:\n{}", left.join("\n"));
    assert!(wrong.is_empty(), "{} of {count} scenes differ:\n{}", wrong.len(), wrong.join("\n"));
    assert!(count > 4 * left.len(), "{count} scenes could be compared; not:\n{}", left.join("\n"));
}
