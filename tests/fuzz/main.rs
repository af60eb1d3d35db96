//! Fuzzing: every hand-made file, made wrong in many ways, through all loaders; no panic, no hang, bounded memory,
//! and a model that is sound ([`veduta::city::CityModel::validate`]).
//!
//! `cargo test` runs a short and always equal part. `./dev fuzz SECONDS` (`VEDUTA_FUZZ_SECONDS`) goes on with other
//! numbers each time; `VEDUTA_FUZZ_SEED` repeats a run. An input that fails is left in `target/fuzz/`.

mod mutate;
mod random;
mod watch;

use std::{
    panic::{AssertUnwindSafe, catch_unwind},
    path::{Path, PathBuf},
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicU64, Ordering::Relaxed},
    },
    time::{Duration, Instant, SystemTime, UNIX_EPOCH},
};

use glam::DVec3;
use random::Random;
use veduta::{
    city::{
        Texture, TextureImage, TextureOpacity, Wrap,
        build::ModelBuilder,
        coplanar, facts, ground,
        load::{LoadOptions, input, read_input},
        shown, spatial, texture,
    },
    geom::{
        Aabb, Volume,
        shape::{Motion, Sphere},
    },
    lens::{
        PlacedSprite, SpriteSpace, SpriteVolume,
        sprite::{DepthCode, Format, Mapping},
        sprite_file,
    },
    view::{Camera, View},
};

#[global_allocator]
static MEMORY: watch::Counting = watch::Counting;

/// Mutations in `cargo test`.
const SMOKE_MUTATIONS: u64 = 900;
/// What any of these small files may make live: mostly what a glTF file may unfold to by instancing.
const MAX_BYTES: usize = 700 << 20;
/// A file that takes longer hangs: the slowest takes well under a second on an idle machine.
const HANG_S: u64 = 120;
/// After so many failures the rest would tell nothing new.
const MAX_FAILURES: usize = 10;

/// A file to be made wrong.
struct Seed {
    name: String,
    bytes: Vec<u8>,
}

/// Every file of `citydata/`, and a JPEG, which it has none of.
fn seeds() -> Vec<Seed> {
    let mut seeds: Vec<Seed> = std::fs::read_dir("citydata")
        .expect("citydata/ is here")
        .map(|entry| entry.expect("citydata/ can be listed"))
        .filter(|entry| entry.file_name() != "README.md")
        .map(|entry| Seed {
            name: entry.file_name().to_string_lossy().into_owned(),
            bytes: std::fs::read(entry.path()).expect("a file of citydata/ can be read"),
        })
        .collect();
    seeds.sort_by(|a, b| a.name.cmp(&b.name));
    let mut jpeg = Vec::new();
    let picture = image::RgbImage::from_fn(9, 7, |x, y| image::Rgb([(x * 28) as u8, (y * 36) as u8, 99]));
    picture.write_to(&mut std::io::Cursor::new(&mut jpeg), image::ImageFormat::Jpeg).expect("a JPEG can be made");
    seeds.push(Seed { name: "picture.jpg".into(), bytes: jpeg });
    seeds.push(Seed { name: "sprite.exr".into(), bytes: sprite() });
    seeds
}

/// The file of a small depth sprite.
fn sprite() -> Vec<u8> {
    let camera = Camera::looking(DVec3::new(3.0, -9.0, 4.0), DVec3::ZERO, 0.7);
    let view = View::new(camera, [24, 16], &Aabb::EMPTY).expect("a view");
    let ball = Volume::Sphere(Sphere { center: DVec3::ZERO, radius: 2.0 });
    let texels = (0..16).flat_map(|y| (0..24).map(move |x| (x, y)));
    let ends = texels.flat_map(|(x, y)| {
        let both = ball.entry_exit(&view.pixel_ray(x, y)).map_or([0.0; 2], |(enter, exit)| [enter as f32, exit as f32]);
        [both, [0.0; 2]]
    });
    let sprite = SpriteVolume {
        ends: ends.collect(),
        space: SpriteSpace::of(&view),
        origin: [0, 0],
        kept: [24, 16],
        layers: 2,
        code: DepthCode { mapping: Mapping::W, near_m: 0.5, far_m: 50.0, format: Format::Unorm16 },
        crs: Some("EPSG:7415".into()),
    };
    sprite_file::bytes(&sprite).expect("a sprite can be written")
}

/// What a lens makes of a file.
fn read_sprite(bytes: &[u8]) -> Result<(), String> {
    match sprite_file::read_bytes(bytes) {
        Err(message) if message.is_empty() || message.contains('\n') || message.len() > 2000 => {
            Err(format!("an unreadable message: {message}"))
        }
        Err(_) => Ok(()),
        Ok(sprite) => {
            let intervals = sprite.kept[0] as usize * sprite.kept[1] as usize * sprite.layers as usize;
            if sprite.ends.len() != intervals || sprite.ends.iter().flatten().any(|d| d.is_nan()) {
                return Err("a sprite that is not sound".into());
            }
            let placed = PlacedSprite::new(Arc::new(sprite), &Motion::NONE);
            let corners = [DVec3::ZERO, DVec3::new(1.0, 1.0, 0.0), DVec3::new(0.0, 1.0, 1.0)];
            std::hint::black_box(placed.meets_triangle(&corners));
            Ok(())
        }
    }
}

/// Reads one wrong file in every way that `info` and the renderer do; the error is why the result is not sound.
fn read(folder: &Path, name: &str, bytes: &[u8]) -> Result<(), String> {
    if name.ends_with(".png") || name.ends_with(".jpg") {
        let image = TextureImage::Bytes(Arc::from(bytes));
        return match texture::decode(&Texture { image, wrap: [Wrap::Repeat; 2], opacity: TextureOpacity::Own }) {
            Ok(pixels) if pixels.levels[0].len() != pixels.width as usize * pixels.height as usize * 4 => {
                Err("a picture of the wrong size".into())
            }
            _ => Ok(()),
        };
    }
    if name.ends_with(".exr") {
        return read_sprite(bytes);
    }
    let options = LoadOptions { roots: vec![folder.to_owned()], ..LoadOptions::default() };
    // Libraries of materials are reached through a model; the mutated one lies in `folder`.
    let (name, bytes) = match name.ends_with(".mtl") {
        true => ("textured.obj", std::fs::read("citydata/textured.obj").map_err(|e| e.to_string())?),
        false => (name, bytes.to_vec()),
    };
    let Ok(input) = input::from_bytes(&folder.join(name), bytes) else { return Ok(()) };
    let mut builder = ModelBuilder::default();
    match read_input(&mut builder, input, &options) {
        Ok(()) => {}
        Err(e) if e.message.is_empty() || e.to_string().contains('\n') || e.to_string().len() > 2000 => {
            return Err(format!("an unreadable message: {e}"));
        }
        Err(_) => return Ok(()),
    }
    let model = builder.finish();
    model.validate()?;
    if let Some((_, w)) = model.warnings.iter().find(|(_, w)| w.message.is_empty() || w.message.contains('\n')) {
        return Err(format!("an unreadable warning: {:?}", w.message));
    }
    let shown = shown::shown_geometries(&model, None);
    let index = spatial::SpatialIndex::build(&model, &shown);
    let ground = ground::plain_ground(&model, &shown).is_some();
    let coplanar = coplanar::coplanar_triangles(&model, &shown).len();
    std::hint::black_box((index, ground, coplanar));
    let facts = serde_json::to_string(&facts::facts(&model, true)).map_err(|e| format!("facts: {e}"))?;
    serde_json::from_str::<serde_json::Value>(&facts).map_err(|e| format!("facts are no JSON: {e}"))?;
    model.textures.iter().for_each(|t| drop(texture::decode(t)));
    Ok(())
}

/// Where the last panic was, for the report.
static PANIC: Mutex<String> = Mutex::new(String::new());

/// [`read`], with panics and memory judged.
fn judge(folder: &Path, name: &str, bytes: &[u8]) -> Result<(), String> {
    let before = watch::start();
    let outcome = catch_unwind(AssertUnwindSafe(|| read(folder, name, bytes)));
    let peak = watch::peak_over(before);
    match outcome {
        Err(_) => Err(format!("panic: {}", PANIC.lock().unwrap_or_else(PoisonError::into_inner))),
        Ok(Err(unsound)) => Err(unsound),
        Ok(Ok(())) if peak > MAX_BYTES => Err(format!("{} MiB for {} bytes", peak >> 20, bytes.len())),
        Ok(Ok(())) => Ok(()),
    }
}

/// Ends the process when one file takes too long; the file is in `target/fuzz/now/`.
fn watch_for_hangs(finished: Arc<AtomicU64>) {
    std::thread::spawn(move || {
        let mut last = (u64::MAX, Instant::now());
        loop {
            std::thread::sleep(Duration::from_secs(1));
            let now = finished.load(Relaxed);
            if now != last.0 {
                last = (now, Instant::now());
            } else if last.1.elapsed().as_secs() > HANG_S {
                std::fs::write("target/fuzz/now/HANGS", format!("mutation {now}")).ok();
                std::process::abort();
            }
        }
    });
}

fn number_from(variable: &str) -> Option<u64> {
    std::env::var(variable).ok()?.parse().ok()
}

#[test]
fn wrong_files_do_no_harm() {
    let seconds = number_from("VEDUTA_FUZZ_SECONDS");
    let clock = SystemTime::now().duration_since(UNIX_EPOCH).map_or(1, |d| d.as_secs());
    let seed = number_from("VEDUTA_FUZZ_SEED").unwrap_or(if seconds.is_some() { clock } else { 1 });
    let folder = PathBuf::from("target/fuzz/now");
    std::fs::remove_dir_all(&folder).ok();
    std::fs::create_dir_all(&folder).expect("target/fuzz/ can be made");
    let seeds = seeds();
    // What models point to lies beside them.
    for seed in &seeds {
        std::fs::write(folder.join(&seed.name), &seed.bytes).expect("target/fuzz/ can be written");
    }
    for seed in &seeds {
        judge(&folder, &seed.name, &seed.bytes).unwrap_or_else(|e| panic!("{} as it is: {e}", seed.name));
    }
    std::panic::set_hook(Box::new(|info| {
        *PANIC.lock().unwrap_or_else(PoisonError::into_inner) = info.to_string().replace('\n', " ");
    }));
    let finished = Arc::new(AtomicU64::new(0));
    watch_for_hangs(finished.clone());
    let start = Instant::now();
    let mut failures: Vec<String> = Vec::new();
    let mut number = 0;
    while failures.len() < MAX_FAILURES
        && seconds.map_or(number < SMOKE_MUTATIONS, |s| start.elapsed() < Duration::from_secs(s))
    {
        let Seed { name, bytes } = &seeds[(number % seeds.len() as u64) as usize];
        let wrong = mutate::mutated(bytes, name, &mut Random::new(seed, number));
        std::fs::write(folder.join(name), &wrong).expect("target/fuzz/ can be written");
        if let Err(why) = judge(&folder, name, &wrong) {
            let kept = format!("target/fuzz/{seed}-{number}-{name}");
            std::fs::write(&kept, &wrong).expect("target/fuzz/ can be written");
            failures.push(format!("{kept}: {why}"));
        }
        std::fs::write(folder.join(name), bytes).expect("target/fuzz/ can be written");
        number += 1;
        finished.store(number, Relaxed);
    }
    drop(std::panic::take_hook());
    println!("seed {seed}: {number} files in {:.0} s", start.elapsed().as_secs_f64());
    assert!(failures.is_empty(), "seed {seed}, {number} files:\n{}", failures.join("\n"));
}
