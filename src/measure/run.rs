//! Measuring: draws, compares, starts afresh, and times in turn.

use std::{sync::Arc, time::Instant};

use crate::{
    gpu::Gpu,
    measure::{
        difference::{self, Against, Difference},
        pareto,
        ratio::{Estimate, in_turn, ratios},
        stage::Stage,
        topic::{Exact, Shot, Topic, Trial, Value, Variant},
    },
    render::{
        parts::TILE,
        picture::{Aovs, Picture, RenderError, Request, Studio},
        stats,
    },
    scene::{CitySpec, Scene, Transparency},
};

/// The set-up of a measurement.
#[derive(Debug)]
pub struct Setup<'a> {
    /// The city, on the GPU.
    pub studio: &'a mut Studio,
    /// The part of it that is shown.
    pub city: &'a CitySpec,
    /// Width and height of all pictures, pixels, at most [`crate::render::parts::TILE`].
    pub size: [u32; 2],
    /// The number of times that all variants are timed, at least one.
    pub pairs: usize,
}

/// The step that measuring is at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// Comparing pictures.
    Comparing,
    /// Starting a device anew for every variant.
    Starting,
    /// Timing in turn.
    Timing,
}

/// All that was measured of a topic.
#[derive(Clone, Debug)]
pub struct Measurement {
    /// Which one.
    pub topic: &'static Topic,
    /// On what.
    pub adapter: stats::Adapter,
    /// City objects shown.
    pub objects: u64,
    /// Triangles that can be drawn.
    pub triangles: u64,
    /// The memory of the city on the GPU, bytes.
    pub city_bytes: u64,
    /// Width and height of all pictures, pixels.
    pub size: [u32; 2],
    /// The number of times that all variants were timed.
    pub pairs: usize,
    /// The number of times that they were started afresh.
    pub starts: usize,
    /// Time of the plain frame, milliseconds.
    pub plain_ms: Estimate,
    /// The variants, in the topic's order.
    pub rows: Vec<Row>,
}

/// The measurements of one variant.
#[derive(Clone, Debug)]
pub struct Row {
    /// The text beside its point.
    pub label: String,
    /// Values of the topic's knobs.
    pub knobs: Vec<Value>,
    /// Against its reference.
    pub difference: Difference,
    /// Time, milliseconds.
    pub ms: Estimate,
    /// Time against the plain frame of the same round.
    pub ratio: Estimate,
    /// The time by which its first frame on a fresh device takes longer than a later one, milliseconds; where the topic starts them afresh.
    pub start_ms: Option<Estimate>,
    /// The memory that its first frame allocated on the GPU, bytes; all of it is held at once.
    pub gpu_bytes: u64,
    /// The refinement of the city by deformations.
    pub refined: Option<Refined>,
    /// Whether nothing it may be compared with beats it.
    pub is_pareto: bool,
}

/// The refinement of the city by deformations, in a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Refined {
    /// The number of triangles.
    pub triangles: u64,
    /// The distances of its edges from where they should be, pixels: the median of those that are bent, and the largest.
    pub chords_px: [f64; 2],
}

/// Measures a topic; `watch` hears how many of how many steps are done.
///
/// # Errors
/// The topic or drawing fails.
pub fn measure(
    topic: &'static Topic,
    setup: &mut Setup<'_>,
    watch: &mut dyn FnMut(Step, usize, usize),
) -> Result<Measurement, RenderError> {
    let trial = (topic.make)(&mut Stage { studio: setup.studio, size: setup.size })?;
    let differences = compare(setup.studio, &trial, watch)?;
    // A start takes as long as dozens of frames.
    let starts = (6 * setup.pairs / (5 * trial.variants.len().max(1))).clamp(1, 9);
    let cold =
        if topic.restarts { start(setup, &trial, starts, watch)? } else { allocate(setup.studio, &trial, watch)? };
    // The plain frame is the first of those that are timed.
    let shots: Vec<&Shot> = std::iter::once(&trial.plain).chain(trial.variants.iter().map(|v| &v.shot)).collect();
    let total = setup.pairs * shots.len();
    let mut done = 0;
    let times = in_turn(shots.len(), setup.pairs, |i| {
        watch(Step::Timing, done, total);
        done += 1;
        warm_up(setup.studio, shots[i])?;
        timed(setup.studio, shots[i])
    })?;
    let mut rows = Vec::with_capacity(trial.variants.len());
    for (i, Variant { label, knobs, .. }) in trial.variants.into_iter().enumerate() {
        let ms = estimate(&times[i + 1])?;
        let start_ms: Vec<f64> = cold[i].iter().map(|c| (c.first_ms - c.later_ms).max(0.0)).collect();
        rows.push(Row {
            label,
            knobs,
            difference: differences[i].0,
            refined: differences[i].1,
            ms,
            ratio: estimate(&ratios(&times[i + 1], &times[0]))?,
            start_ms: Some(estimate(&start_ms)?).filter(|_| topic.restarts),
            gpu_bytes: cold[i].iter().map(|c| c.bytes).max().unwrap_or(0),
            is_pareto: false,
        });
    }
    mark_front(topic, &mut rows);
    let city = setup.studio.renderer.city();
    Ok(Measurement {
        topic,
        adapter: adapter(&setup.studio.renderer.gpu),
        objects: setup.studio.objects,
        triangles: city.map_or(0, |c| c.triangles),
        city_bytes: city.map_or(0, |c| c.bytes),
        size: setup.size,
        pairs: setup.pairs,
        starts: if topic.restarts { starts } else { 0 },
        plain_ms: estimate(&times[0])?,
        rows,
    })
}

/// Time of a scene's frame, one sample, against that of another of the same size: drawn in turn, so many times.
///
/// # Errors
/// Drawing fails, or pictures are larger than a target.
pub fn frame_ratio(
    studio: &mut Studio,
    scene: &Scene,
    plain: &Scene,
    size: [u32; 2],
    pairs: usize,
) -> Result<Estimate, RenderError> {
    if size.iter().any(|side| *side > TILE) {
        let message = format!(
            "frames of {}x{} pixels cannot be timed; at most {TILE} on a side would be right",
            size[0], size[1]
        );
        return Err(RenderError::Scene(message));
    }
    let shots = [scene, plain].map(|scene| Stage { studio, size }.shot(scene.clone(), 1));
    let times = in_turn(2, pairs, |i| {
        warm_up(studio, &shots[i])?;
        timed(studio, &shots[i])
    })?;
    estimate(&ratios(&times[0], &times[1]))
}

fn estimate(values: &[f64]) -> Result<Estimate, RenderError> {
    let nothing = || RenderError::Scene("no frame was timed; one round or more would be right".to_owned());
    Estimate::of(values).ok_or_else(nothing)
}

fn adapter(gpu: &Gpu) -> stats::Adapter {
    stats::Adapter {
        name: gpu.info.name.clone(),
        backend: format!("{:?}", gpu.info.backend).to_lowercase(),
        kind: gpu.kind().to_owned(),
    }
}

/// Draws a picture to its end without AOVs and without reading it back; milliseconds.
fn timed(studio: &mut Studio, shot: &Shot) -> Result<f64, RenderError> {
    let request = Request { aovs: Aovs::default(), statistics: false, ..shot.request };
    studio.renderer.settings.holds_geometry = false;
    let start = Instant::now();
    for scene in std::iter::once(&shot.scene).chain(&shot.also) {
        studio.draw(scene, &request)?;
    }
    studio.renderer.gpu.wait()?;
    Ok(start.elapsed().as_secs_f64() * 1e3)
}

/// Draws the frame before once unwatched: what a variant before it replaced (targets, sprites) is made anew then.
fn warm_up(studio: &mut Studio, shot: &Shot) -> Result<(), RenderError> {
    match &shot.before {
        None => timed(studio, shot)?,
        Some(scene) => timed(studio, &Shot { scene: scene.clone(), before: None, ..shot.clone() })?,
    };
    Ok(())
}

fn compare(
    studio: &mut Studio,
    trial: &Trial,
    watch: &mut dyn FnMut(Step, usize, usize),
) -> Result<Vec<(Difference, Option<Refined>)>, RenderError> {
    let mut reference: Option<(&Shot, Picture)> = None;
    let mut differences = Vec::with_capacity(trial.variants.len());
    for (i, variant) in trial.variants.iter().enumerate() {
        watch(Step::Comparing, i, trial.variants.len());
        let wanted = variant.reference.as_ref().unwrap_or(&trial.reference);
        let right = match reference.take() {
            Some((shot, picture)) if shot == wanted => picture,
            _ => studio.render(&wanted.scene, &wanted.request)?,
        };
        let picture = studio.render(&variant.shot.scene, &variant.shot.request)?;
        let mut difference = Difference::between(&right, &picture);
        if let (Some(mask), Some(bits)) = (&variant.mask, &picture.lens_mask) {
            difference.wrong_mask_pixels = Some(difference::wrong_bits(mask, &bits[0]));
        }
        if let Some(exact) = &variant.exact {
            let Shot { scene, request, .. } = &variant.shot;
            difference.against_f64 = Some(match exact {
                Exact::Light(light) => light.errors(&picture),
                Exact::Layers(_) if scene.style.transparency == Transparency::Stochastic => {
                    Against::pictures(&picture, &right)
                }
                Exact::Layers(layers) => {
                    Against::transparency(&studio.transparency(scene, request.size)?, &layers.transparency)
                }
            });
        }
        let figures = studio.renderer.deformed_figures();
        let refined = figures.map(|figures| -> Result<Refined, RenderError> {
            let chords_px = studio.renderer.chords()?.unwrap_or_default();
            Ok(Refined { triangles: figures.triangles, chords_px })
        });
        differences.push((difference, refined.transpose()?));
        reference = Some((wanted, right));
    }
    Ok(differences)
}

/// A start on a device on which nothing was drawn before.
struct Cold {
    first_ms: f64,
    later_ms: f64,
    bytes: u64,
}

fn start(
    setup: &Setup<'_>,
    trial: &Trial,
    starts: usize,
    watch: &mut dyn FnMut(Step, usize, usize),
) -> Result<Vec<Vec<Cold>>, RenderError> {
    let mut cold: Vec<Vec<Cold>> = trial.variants.iter().map(|_| Vec::new()).collect();
    let total = starts * cold.len();
    for round in 0..starts {
        for (i, variant) in trial.variants.iter().enumerate() {
            watch(Step::Starting, round * trial.variants.len() + i, total);
            let mut studio = Studio::new(Gpu::open()?, Arc::clone(setup.studio.file()), setup.city)?;
            let before = studio.renderer.gpu.allocated_bytes();
            let first_ms = timed(&mut studio, &variant.shot)?;
            let bytes = studio.renderer.gpu.allocated_bytes() - before;
            let mut later_ms = f64::INFINITY;
            for _ in 0..3 {
                if variant.shot.before.is_some() {
                    warm_up(&mut studio, &variant.shot)?;
                }
                later_ms = later_ms.min(timed(&mut studio, &variant.shot)?);
            }
            cold[i].push(Cold { first_ms, later_ms, bytes });
        }
    }
    Ok(cold)
}

/// Measures the memory of each variant on a GPU that has the city and the pipelines: its first frame after all targets and lists were dropped.
fn allocate(
    studio: &mut Studio,
    trial: &Trial,
    watch: &mut dyn FnMut(Step, usize, usize),
) -> Result<Vec<Vec<Cold>>, RenderError> {
    let mut cold = Vec::new();
    for (i, variant) in trial.variants.iter().enumerate() {
        watch(Step::Starting, i, trial.variants.len());
        studio.renderer.drop_targets();
        let before = studio.renderer.gpu.allocated_bytes();
        let first_ms = timed(studio, &variant.shot)?;
        cold.push(vec![Cold { first_ms, later_ms: first_ms, bytes: studio.renderer.gpu.allocated_bytes() - before }]);
    }
    Ok(cold)
}

/// Marks the variants on the Pareto front of those that may be compared.
pub fn mark_front(topic: &Topic, rows: &mut [Row]) {
    let group = |row: &Row| -> Vec<Value> { topic.alike.iter().filter_map(|&k| row.knobs.get(k).cloned()).collect() };
    for i in 0..rows.len() {
        let own = group(&rows[i]);
        let among: Vec<usize> = (0..rows.len()).filter(|&k| group(&rows[k]) == own).collect();
        let points: Vec<[f64; 2]> = among.iter().map(|&k| topic.front.map(|quantity| quantity.of(&rows[k]))).collect();
        let at = among.iter().position(|&k| k == i);
        rows[i].is_pareto = at.is_some_and(|at| pareto::front(&points)[at]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::{quantity::Quantity, topic::Knob};

    /// A row with a knob, a FLIP error and a ratio.
    fn row(knob: f64, flip: f64, ratio: f64) -> Row {
        let at = |median| Estimate { median, low: median, high: median };
        Row {
            label: String::new(),
            knobs: vec![Value::Number(knob)],
            difference: Difference { flip, ..Difference::default() },
            ms: at(1.0),
            ratio: at(ratio),
            start_ms: Some(at(1.0)),
            gpu_bytes: 1,
            refined: None,
            is_pareto: false,
        }
    }

    #[test]
    fn fronts_are_those_of_what_may_be_compared() {
        let topic = Topic {
            name: "test",
            title: "",
            about: "",
            sources: &[],
            reference: "",
            knobs: &[Knob { name: "k", unit: "" }],
            x: Quantity::Flip,
            y: &[Quantity::Ratio],
            front: [Quantity::Flip, Quantity::Ratio],
            alike: &[],
            series: &[],
            panels: None,
            notes: None,
            slope: None,
            restarts: true,
            make: |_| Err(RenderError::Scene(String::new())),
        };
        let rows = [row(0.0, 0.0, 2.0), row(0.0, 0.1, 3.0), row(1.0, 0.5, 5.0), row(1.0, 0.2, 6.0)];
        let front = |topic: &Topic| {
            let mut rows = rows.clone();
            mark_front(topic, &mut rows);
            rows.map(|row| row.is_pareto)
        };
        assert_eq!(front(&topic), [true, false, false, false], "the first beats all");
        assert_eq!(front(&Topic { alike: &[0], ..topic }), [true, false, true, true], "or only its own kind");
    }
}
