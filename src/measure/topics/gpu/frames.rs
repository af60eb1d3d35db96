//! Frames of two views, with lenses and seen through, drawn in turn with the plain frame.

use std::time::Instant;

use crate::{
    measure::{
        ratio::{Estimate, in_turn, ratios},
        stage::plain_scene,
        topics::gpu::{
            clock::{Clock, Part},
            report::{Frames, Timed},
            views::{overview, see_through_city, see_through_lens, spread, street, with_lens, with_ten},
        },
    },
    render::picture::{RenderError, Studio},
    scene::Scene,
};

/// The size at which lenses over a tenth of the picture are looked for, pixels: their share hardly depends on it.
const SEARCH: [u32; 2] = [320, 180];
/// Rounds below which there is no 95 % interval.
pub const LEAST_ROUNDS: usize = 6;

/// A frame that is timed.
#[derive(Clone, Debug)]
struct Shot {
    name: String,
    about: &'static str,
    /// The number of the plain frame of its view.
    plain: usize,
    scene: Scene,
}

/// The names of all frames.
pub fn names() -> Vec<String> {
    let of_view = |v: &'static str| KINDS.map(|(kind, _)| format!("{v} {kind}"));
    VIEWS.into_iter().flat_map(of_view).collect()
}

const VIEWS: [&str; 2] = ["V1", "V2"];

/// The frames that are drawn in each view; the first is the plain frame.
const KINDS: [(&str, &str); 7] = [
    ("plain", "the plain frame"),
    ("lens", "one greyscale lens over a tenth of the picture"),
    ("ten", "ten overlapping lenses, each over a tenth of the picture"),
    ("few", "ten lenses all over the city"),
    ("thousand", "a thousand lenses all over the city"),
    ("see-through", "translucent within a lens over a tenth of the picture"),
    ("see-through city", "translucent everywhere"),
];

/// The size of frames, and how often and how long they are timed.
#[derive(Clone, Copy, Debug)]
pub struct Timing<'a> {
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// The number of times that all frames are drawn at most.
    pub rounds: usize,
    /// The time there is.
    pub clock: &'a Clock,
}

/// Times the frames that `is_wanted`, and the plain frames of their views; `watch` hears how many frames of how many are drawn. `city`
/// names what is shown.
///
/// # Errors
/// Drawing fails.
pub fn time(
    studio: &mut Studio,
    city: String,
    timing: &Timing<'_>,
    is_wanted: &dyn Fn(&str) -> bool,
    watch: &mut dyn FnMut(usize, usize),
) -> Result<Frames, RenderError> {
    let mut shots = Vec::new();
    for v in VIEWS {
        shots_of(v, studio, timing.size, is_wanted, &mut shots)?;
    }
    let total = timing.rounds * shots.len();
    let mut times: Vec<Vec<f64>> = vec![Vec::new(); shots.len()];
    let (mut done, mut rounds, mut longest) = (0, 0, 0.0_f64);
    // Two rounds at a time: one there, one back.
    while rounds < timing.rounds {
        let left = timing.clock.end(Part::Frames).saturating_duration_since(Instant::now()).as_secs_f64();
        if rounds > 0 && longest > left {
            break;
        }
        let (start, more) = (Instant::now(), (timing.rounds - rounds).min(2));
        let taken = in_turn(shots.len(), more, |i| {
            watch(done, total);
            done += 1;
            // Once unwatched: what a frame before it replaced is made anew then.
            drawn(studio, &shots[i].scene, timing.size)?;
            drawn(studio, &shots[i].scene, timing.size)
        })?;
        times.iter_mut().zip(taken).for_each(|(all, more)| all.extend(more));
        rounds += more;
        longest = longest.max(start.elapsed().as_secs_f64());
    }
    let by_gpu = gpu_times(studio, &shots, timing);
    let rows = shots.iter().zip(&times).zip(by_gpu).map(|((shot, own), gpu_ms)| {
        let of = |values: &[f64]| {
            Estimate::of(values)
                .ok_or_else(|| RenderError::Scene("no frame was timed; one round or more would be right".to_owned()))
        };
        let ratio = of(&ratios(own, &times[shot.plain]))?;
        Ok(Timed { name: shot.name.clone(), about: shot.about.to_owned(), ms: of(own)?, ratio, gpu_ms })
    });
    let rows = rows.collect::<Result<Vec<_>, RenderError>>()?;
    let triangles = studio.renderer.city().map_or(0, |c| c.triangles);
    Ok(Frames { city, triangles, size: timing.size, rounds, is_cut: rounds < timing.rounds, rows })
}

/// The wanted frames of one view, behind its plain frame.
fn shots_of(
    v: &str,
    studio: &mut Studio,
    size: [u32; 2],
    is_wanted: &dyn Fn(&str) -> bool,
    shots: &mut Vec<Shot>,
) -> Result<(), RenderError> {
    let wanted: Vec<_> = KINDS.into_iter().filter(|(kind, _)| is_wanted(&format!("{v} {kind}"))).collect();
    if wanted.is_empty() {
        return Ok(());
    }
    let extent = studio.extent();
    let scene = plain_scene(if v == "V1" { overview(&extent, size)? } else { street(studio) });
    let needs = |kinds: &[&str]| wanted.iter().any(|(kind, _)| kinds.contains(kind));
    let lensed = match needs(&["lens", "ten", "see-through"]) {
        true => with_lens(&scene, studio, SEARCH)?,
        false => scene.clone(),
    };
    let plain = shots.len();
    shots.push(Shot { name: format!("{v} plain"), about: KINDS[0].1, plain, scene: scene.clone() });
    for (kind, about) in wanted.into_iter().filter(|(kind, _)| *kind != "plain") {
        let scene = match kind {
            "lens" => lensed.clone(),
            "ten" => with_ten(&lensed, studio, SEARCH)?,
            "few" => spread(&scene, &extent, 10),
            "thousand" => spread(&scene, &extent, 1000),
            "see-through" => see_through_lens(&lensed),
            _ => see_through_city(&scene),
        };
        shots.push(Shot { name: format!("{v} {kind}"), about, plain, scene });
    }
    Ok(())
}

/// Draws a frame to its end; milliseconds.
fn drawn(studio: &mut Studio, scene: &Scene, size: [u32; 2]) -> Result<f64, RenderError> {
    studio.renderer.settings.holds_geometry = false;
    let start = Instant::now();
    studio.redraw(scene, size)?;
    studio.renderer.gpu.wait()?;
    Ok(start.elapsed().as_secs_f64() * 1e3)
}

/// How often a frame is timed by the GPU's clock.
const BY_GPU: usize = 5;

/// The median time of each frame by the GPU's clock, as far as there is time and the GPU has one.
fn gpu_times(studio: &mut Studio, shots: &[Shot], timing: &Timing<'_>) -> Vec<Option<f64>> {
    let mut one = |shot: &Shot| {
        if !timing.clock.has_time(Part::Frames) {
            return None;
        }
        studio.renderer.settings.holds_geometry = false;
        // Once unwatched, as above.
        studio.redraw_timed(&shot.scene, timing.size).ok()?;
        let times: Option<Vec<f64>> =
            (0..BY_GPU).map(|_| studio.redraw_timed(&shot.scene, timing.size).ok().flatten()).collect();
        Estimate::of(&times?).map(|estimate| estimate.median)
    };
    shots.iter().map(&mut one).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_view_has_its_plain_frame_first() {
        let names = names();
        assert_eq!(names.len(), VIEWS.len() * KINDS.len());
        assert_eq!([&*names[0], &*names[KINDS.len()]], ["V1 plain", "V2 plain"]);
    }
}
