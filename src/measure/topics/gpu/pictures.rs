//! Pictures of the gallery against stored references of the software adapter.
//!
//! Rasterisers may put an edge a part of a pixel aside, so that a sample of an edge's pixel shows one side or the other: with one sample
//! that is the whole contrast. With as many as [`SAMPLES`] it is the part: a step of 255 where corners are put on a grid of 1/256 pixel.
//! SwiftShader is off by more than a step at 0.3 to 2 % of the pixels, by up to 23 steps.

use std::{
    fs::File,
    io::BufReader,
    path::{Path, PathBuf},
    time::Instant,
};

use crate::{
    city::load::{LoadOptions, Quiet, load},
    figure::{
        draw_untitled,
        file::WriteError,
        picture::{notes_of, save_picture},
        scene_file::{self, Options},
    },
    gpu::Gpu,
    measure::topics::gpu::report::Compared,
    render::picture::{Picture, RenderError, Request, Studio},
    scene::{CitySpec, Scene},
};

/// Scenes of built-in cities that between them use most of what draws: by the names of their files.
pub const SCENES: &[&str] = &[
    "rooms",
    "one-house",
    "town",
    "first-lens",
    "in-the-way",
    "bent-city",
    "who-hides-the-church",
    "trapp-3-1-3",
    "trapp-3-5-1",
    "tiesel-3-7",
    "call-outs",
    "sections",
    "ropinski-6",
];

/// Width and height of the pictures, pixels.
pub const SIZE: [u32; 2] = [240, 135];
/// Samples per pixel.
pub const SAMPLES: u32 = 256;
/// Channels may be off by this, steps of 255: GPUs filter textures with eight bits of a texel, each in its own way.
pub const STEPS: u8 = 2;
/// This share of the pixels may be off by more.
const SHARE: f64 = 1e-3;

/// Draws scenes; those of one city, one after the other, on one device.
#[derive(Debug, Default)]
pub struct Easel {
    last: Option<(CitySpec, Studio)>,
}

impl Easel {
    /// The picture of a scene of the folder, and the scene.
    fn draw(&mut self, folder: &Path, name: &str) -> Result<(Picture, Scene, Options), String> {
        let file = folder.join(format!("{name}.toml"));
        let options = Options { must_exist: true, ..Options::for_file(&file) };
        let scene = scene_file::read(&file, &options).map_err(|error| error.to_string())?;
        let mut studio = match self.last.take() {
            Some((city, studio)) if city == scene.city => studio,
            _ => opened(&scene.city)?,
        };
        let request = Request { samples: SAMPLES, ..Request::plain(SIZE) };
        let picture = draw_untitled(&mut studio, &scene, &request).map_err(|error| error.to_string())?;
        self.last = Some((scene.city.clone(), studio));
        Ok((picture, scene, options))
    }
}

fn opened(city: &CitySpec) -> Result<Studio, String> {
    let model = load(&city.files, &LoadOptions::default(), &Quiet).map_err(|error| error.to_string())?;
    let made = || -> Result<Studio, RenderError> { Studio::new(Gpu::open()?, model.into(), city) };
    made().map_err(|error| error.to_string())
}

/// Where the reference of a scene is.
pub fn reference(folder: &Path, name: &str) -> PathBuf {
    folder.join("references").join(format!("{name}.png"))
}

/// Draws a scene and compares it with its reference.
pub fn compare(easel: &mut Easel, folder: &Path, name: &str) -> Compared {
    let start = Instant::now();
    let right = read(&reference(folder, name));
    let found = right.and_then(|right| Ok((right, easel.draw(folder, name)?.0)));
    let mut compared = Compared {
        scene: name.to_owned(),
        pixels: u64::from(SIZE[0]) * u64::from(SIZE[1]),
        allowed: (SHARE * f64::from(SIZE[0] * SIZE[1])) as u64,
        ..Compared::default()
    };
    match found {
        Ok((right, picture)) => differ(&mut compared, &right, &picture.rgba),
        Err(trouble) => compared.trouble = Some(trouble),
    }
    compared.seconds = start.elapsed().as_secs_f64();
    compared
}

/// Counts the pixels that are off.
fn differ(compared: &mut Compared, right: &[[u8; 3]], found: &[[u8; 4]]) {
    for (i, (right, found)) in right.iter().zip(found).enumerate() {
        let steps = (0..3).map(|c| right[c].abs_diff(found[c])).max().unwrap_or(0);
        compared.wrong += u64::from(steps > STEPS);
        if steps > compared.max_steps {
            compared.max_steps = steps;
            compared.worst = (steps > STEPS).then_some([i as u32 % SIZE[0], i as u32 / SIZE[0]]);
        }
    }
}

/// The pixels of a reference.
fn read(file: &Path) -> Result<Vec<[u8; 3]>, String> {
    let failed = |what: &dyn std::fmt::Display| {
        format!("{}: {what}; `veduta measure gpu --write-references` makes it on a software adapter", file.display())
    };
    let stored = File::open(file).map_err(|error| failed(&error))?;
    let mut reader = png::Decoder::new(BufReader::new(stored)).read_info().map_err(|error| failed(&error))?;
    let info = reader.info();
    let is_ours = (info.width, info.height) == (SIZE[0], SIZE[1])
        && (info.color_type, info.bit_depth) == (png::ColorType::Rgb, png::BitDepth::Eight);
    if !is_ours {
        return Err(failed(&format!("is no picture of {}x{} pixels in 8-bit RGB", SIZE[0], SIZE[1])));
    }
    let mut bytes = vec![0; 3 * SIZE[0] as usize * SIZE[1] as usize];
    reader.next_frame(&mut bytes).map_err(|error| failed(&error))?;
    Ok(bytes.chunks_exact(3).map(|p| [p[0], p[1], p[2]]).collect())
}

/// Draws a scene and stores it as its reference, over the one that was there.
///
/// # Errors
/// It cannot be drawn or written.
pub fn write(easel: &mut Easel, folder: &Path, name: &str, adapter: &str) -> Result<PathBuf, String> {
    let (picture, scene, options) = easel.draw(folder, name)?;
    let file = reference(folder, name);
    let mut notes = notes_of(&scene, &options);
    notes.dpi = None;
    notes.texts.push(("veduta:adapter", adapter.to_owned()));
    let failed = |error: WriteError| error.to_string();
    save_picture(&file, picture.size, &picture.rgba, true, &notes).map_err(failed)?;
    Ok(file)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_that_are_off_by_more_than_two_steps_are_counted() {
        let compared = |found: &[[u8; 4]]| {
            let mut compared = Compared::default();
            differ(&mut compared, &[[10, 20, 30]; 3], found);
            (compared.wrong, compared.max_steps, compared.worst)
        };
        assert_eq!(compared(&[[10, 20, 30, 255]; 3]), (0, 0, None));
        assert_eq!(compared(&[[12, 18, 32, 255]; 3]), (0, 2, None));
        let off = [[10, 20, 30, 255], [10, 20, 33, 255], [13, 20, 30, 255]];
        assert_eq!(compared(&off), (2, 3, Some([1, 0])));
    }
}
