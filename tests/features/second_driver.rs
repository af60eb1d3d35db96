//! Pictures by two drivers: the shipped scenes and random ones look the same within a pixel. Corners of triangles are drawn on grids that
//! differ from driver to driver, so borders may lie a pixel aside.
//!
//! `VEDUTA_SECOND_DRIVER` is a part of the second adapter's name; where its driver is not installed, `VK_DRIVER_FILES` names the files of both.

use exr::prelude::{ReadChannels as _, ReadLayers as _};
use std::{
    collections::BTreeSet,
    path::{Path, PathBuf},
    process::Command,
};

use crate::studio::random_scene::{Wanted, scene};

const SIZE: [usize; 2] = [640, 360];
/// Steps of 255 that colours may differ by.
const STEPS: u8 = 2;
/// Blocks of a picture whose things may differ: what lies in narrow gaps, or on faces that a lens's face nearly touches.
const FEW: usize = SIZE[0] * SIZE[1] / 5000;
/// Blocks whose colours may: patterns as fine as pixels move by the driver's grid, too.
const FEW_COLORS: usize = SIZE[0] * SIZE[1] / 500;
/// What one picture may cost: a software driver's compiler takes more than all memory for some programs.
const LIMITS: &str = "ulimit -v 16000000; exec timeout 150 \"$0\" \"$@\"";
const SEEDS: std::ops::Range<u64> = 0..40;

/// Samples of a picture, row by row: `channels` numbers a pixel.
struct Image {
    channels: usize,
    bytes: Vec<u8>,
}

impl Image {
    fn of_file(path: &Path) -> Self {
        let image = image::open(path).expect("a picture");
        assert_eq!([image.width() as usize, image.height() as usize], SIZE);
        let bytes = image.to_rgba8().into_raw();
        Self { channels: bytes.len() / (SIZE[0] * SIZE[1]), bytes }
    }

    fn at(&self, x: usize, y: usize) -> &[u8] {
        &self.bytes[self.channels * (SIZE[0] * y + x)..][..self.channels]
    }

    /// The pixels around one, and it.
    fn around(&self, x: usize, y: usize) -> impl Iterator<Item = &[u8]> + Clone {
        let [columns, rows] = [(x, SIZE[0]), (y, SIZE[1])].map(|(at, size)| at.saturating_sub(1)..(at + 2).min(size));
        rows.flat_map(move |y| columns.clone().map(move |x| self.at(x, y)))
    }
}

/// Blocks of two by two pixels of one, by their first, of which the other has no value within a pixel: between the least and the most
/// there, and so many steps more. What is thinner may be seen by one driver and not by the other.
fn alone(one: &Image, other: &Image, steps: u8) -> Vec<[usize; 2]> {
    let pixels = (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| [x, y]));
    let is_alone = |[x, y]: &[usize; 2]| {
        let (own, around) = (one.at(*x, *y), other.around(*x, *y));
        match steps {
            // Numbers of things have no between.
            0 => !around.clone().any(|there| there == own),
            _ => (0..own.len()).any(|c| {
                let least = around.clone().map(|there| there[c]).min().unwrap_or(0);
                let most = around.clone().map(|there| there[c]).max().unwrap_or(255);
                own[c] < least.saturating_sub(steps) || own[c] > most.saturating_add(steps)
            }),
        }
    };
    let found: BTreeSet<[usize; 2]> = pixels.filter(is_alone).collect();
    let has_block = |[x, y]: &[usize; 2]| [[1, 0], [0, 1], [1, 1]].iter().all(|[i, j]| found.contains(&[x + i, y + j]));
    found.iter().filter(|at| has_block(at)).copied().collect()
}

struct Drawn {
    picture: Image,
    ids: Image,
    masks: Image,
    /// Metres; infinite where nothing is.
    depths: Vec<f32>,
}

fn depths_of_file(path: &Path) -> Vec<f32> {
    let image = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        .from_file(path)
        .expect("depths");
    image.layer_data.channel_data.list[0].sample_data.values_as_f32().collect()
}

/// Where two drivers show other things that are as far, to a part of the distance that a grid of 1/16 pixel does not tell apart on faces seen
/// at a slant.
fn doubtful(one: &Drawn, other: &Drawn) -> impl Fn(&[usize; 2]) -> bool {
    let is_doubtful: Vec<bool> = (0..SIZE[0] * SIZE[1])
        .map(|i| {
            let [x, y] = [i % SIZE[0], i / SIZE[0]];
            let [a, b] = [one.depths[i], other.depths[i]];
            one.ids.at(x, y) != other.ids.at(x, y) && (a - b).abs() <= 2e-3 * a.min(b)
        })
        .collect();
    move |[x, y]| is_doubtful[SIZE[0] * y + x]
}

fn drawn(adapter: &str, file: &Path, folder: &Path) -> Result<Drawn, String> {
    let out = |what: &str| folder.join(format!("{what}.png"));
    let run = Command::new("sh")
        .args(["-c", LIMITS, env!("CARGO_BIN_EXE_veduta"), "render"])
        .arg(file)
        // A border of a shadow on a wall that the light grazes moves by many pixels where the map's corners move by a part of one.
        .args(["--set", "sun.shadows=false"])
        .args(["--quiet", "--samples", "1", "--size", &format!("{}x{}", SIZE[0], SIZE[1]), "-o"])
        .arg(out("picture"))
        .args([
            "--aov",
            &format!("object-id={}", out("ids").display()),
            "--aov",
            &format!("lens-mask={}", out("masks").display()),
            "--aov",
            &format!("depth={}", folder.join("depth.exr").display()),
        ])
        .env("VEDUTA_ADAPTER", adapter)
        .output()
        .expect("sh");
    match run.status.success() {
        true => {
            let [picture, ids, masks] = ["picture", "ids", "masks"].map(|what| Image::of_file(&out(what)));
            Ok(Drawn { picture, ids, masks, depths: depths_of_file(&folder.join("depth.exr")) })
        }
        false => {
            Err(format!("{}: {}", run.status, String::from_utf8_lossy(&run.stderr).lines().last().unwrap_or_default()))
        }
    }
}

/// What differs, in words, and whether it is no more than may.
fn differences(one: &Drawn, other: &Drawn) -> (String, bool) {
    let mut is_right = true;
    let is_doubtful = doubtful(one, other);
    let mut of = |what: &str, a: &Image, b: &Image, steps: u8| {
        let [here, there] = [alone(a, b, steps), alone(b, a, steps)].map(|mut found| {
            found.retain(|at| !is_doubtful(at));
            found
        });
        let first = here.first().or(there.first()).copied()?;
        let most = if steps == 0 { FEW } else { FEW_COLORS };
        is_right &= here.len().max(there.len()) <= most;
        Some(format!("{} and {} blocks of {what}, first {first:?}", here.len(), there.len()))
    };
    let found = [
        of("colours", &one.picture, &other.picture, STEPS),
        of("object ids", &one.ids, &other.ids, 0),
        of("masks", &one.masks, &other.masks, 0),
    ];
    (found.into_iter().flatten().collect::<Vec<_>>().join("; "), is_right)
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
    for seed in SEEDS {
        let path = folder.join(format!("random-{seed}.toml"));
        let city = ["builtin:square", "builtin:town"][seed as usize % 2];
        std::fs::write(&path, scene(seed, city, Wanted { lenses: [2, 4], deformations: true })).unwrap();
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
            // What neither draws is no scene, as random ones may be.
            [Err(one), Err(_)] => one,
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
