//! Films of frames: made by `ffmpeg` where it is there; else the line to run is told.

use std::{
    ffi::OsString,
    path::{Path, PathBuf},
    process::{Command, Stdio},
    str::FromStr,
};

use crate::cli::failure::{Failure, Outcome};

/// A film to write: `walk.mp4` or `walk.gif`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Film {
    /// Where to.
    pub file: PathBuf,
    kind: Kind,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Mp4,
    Gif,
}

impl FromStr for Film {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let file = PathBuf::from(text);
        let kind = match file.extension().map(|e| e.to_string_lossy().to_lowercase()).as_deref() {
            Some("mp4") => Kind::Mp4,
            Some("gif") => Kind::Gif,
            _ => return Err("a film ends in .mp4 or .gif".to_owned()),
        };
        Ok(Self { file, kind })
    }
}

/// Frames that are files.
#[derive(Clone, Debug)]
pub struct Frames<'a> {
    /// Their names, as ffmpeg has them: `frames/%04d.png`.
    pub pattern: &'a Path,
    /// The number of the first.
    pub first: u32,
    /// How many.
    pub count: u64,
    /// Per second.
    pub fps: f64,
}

/// The program that makes films.
const FFMPEG: &str = "ffmpeg";

impl Film {
    /// What to hand to ffmpeg for a film that goes to a file.
    fn arguments(&self, frames: &Frames, to: &Path) -> Vec<OsString> {
        let text = |parts: &[String]| parts.iter().map(OsString::from).collect::<Vec<_>>();
        let mut all =
            text(&["-framerate".into(), frames.fps.to_string(), "-start_number".into(), frames.first.to_string()]);
        all.push("-i".into());
        all.push(frames.pattern.into());
        all.extend(text(&["-frames:v".into(), frames.count.to_string(), "-vf".into()]));
        all.push(match self.kind {
            // Players want sides that are even.
            Kind::Mp4 => "pad=ceil(iw/2)*2:ceil(ih/2)*2".into(),
            Kind::Gif => "split[a][b];[a]palettegen[p];[b][p]paletteuse".into(),
        });
        if self.kind == Kind::Mp4 {
            all.extend(
                ["-c:v", "libx264", "-crf", "18", "-pix_fmt", "yuv420p", "-movflags", "+faststart"].map(OsString::from),
            );
        }
        all.push(to.into());
        all
    }

    /// The line that makes it, to be run by hand.
    fn line(&self, frames: &Frames) -> String {
        let quoted = |part: OsString| {
            let text = part.to_string_lossy().into_owned();
            let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_./%:,+=".contains(c);
            if text.chars().all(is_plain) { text } else { format!("'{}'", text.replace('\'', "'\\''")) }
        };
        let arguments: Vec<String> = self.arguments(frames, &self.file).into_iter().map(quoted).collect();
        format!("{FFMPEG} {}", arguments.join(" "))
    }

    /// Makes the film of frames that are there; it appears whole or not at all. Where there is no ffmpeg, the line to run is told.
    ///
    /// # Errors
    /// What ffmpeg says.
    pub fn make(&self, frames: &Frames) -> Outcome {
        let name = self.file.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let part = self.file.with_file_name(format!(".part-{}-{name}", std::process::id()));
        let mut command = Command::new(FFMPEG);
        command.args(["-hide_banner", "-loglevel", "error", "-y"]).args(self.arguments(frames, &part));
        let output = match command.stdin(Stdio::null()).output() {
            Ok(output) => output,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
                log::warn!(
                    "{}: there is no {FFMPEG} to make it; the frames are there: {}",
                    self.file.display(),
                    self.line(frames)
                );
                return Ok(());
            }
            Err(error) => return Err(Failure::io(FFMPEG, &error)),
        };
        let result = match output.status.success() {
            true => std::fs::rename(&part, &self.file)
                .map_err(|error| Failure::io(&self.file.display().to_string(), &error)),
            false => {
                let said = String::from_utf8_lossy(&output.stderr);
                let said = said.lines().rfind(|line| !line.trim().is_empty()).unwrap_or("no reason given").to_owned();
                Err(Failure::failed(format!(
                    "{}: {FFMPEG}: {said}; to run it by hand: {}",
                    self.file.display(),
                    self.line(frames)
                )))
            }
        };
        if result.is_err() {
            let _ = std::fs::remove_file(&part);
        }
        result
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_film_says_how_it_is_made() {
        let film: Film = "out/my walk.mp4".parse().expect("a film");
        let frames = Frames { pattern: Path::new("frames/%04d.png"), first: 7, count: 12, fps: 25.0 };
        let line = film.line(&frames);
        let expected = "ffmpeg -framerate 25 -start_number 7 -i frames/%04d.png -frames:v 12 -vf 'pad=ceil(iw/2)*2:ceil(ih/2)*2' -c:v libx264 -crf 18 -pix_fmt yuv420p -movflags +faststart 'out/my walk.mp4'";
        assert_eq!(line, expected);
        assert!("walk.GIF".parse::<Film>().expect("a film").line(&frames).contains("palettegen"));
        for wrong in ["walk", "walk.avi", ".mp4"] {
            assert!(wrong.parse::<Film>().is_err(), "{wrong}");
        }
    }
}
