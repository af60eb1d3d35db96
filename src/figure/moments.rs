//! Labels of time lenses: the moment that shows in each, and where lenses overlap, as finely as the city's dates say it (after Tiesel §4.2.2).

use glam::{DVec2, DVec3};

use crate::{
    city::lifetime::Lifetimes,
    geom::Aabb,
    lens::LensBody,
    render::{
        epochs::Epochs,
        picture::{RenderError, Studio},
        volume::LensVolume,
    },
    scene::Scene,
    time::{Granularity, Moment},
    view::View,
};

/// A label of a moment.
#[derive(Clone, Debug, PartialEq)]
pub struct MomentLabel {
    /// What it says: `1650`, `3 May 1890, 14:05`.
    pub text: String,
    /// The middle of it, pixels.
    pub at: DVec2,
    /// The colour of its lens, sRGB 0..1.
    pub color: [f32; 3],
}

/// A moment as finely as dates say it, and finer where it is.
pub fn label(moment: Moment, dates: Option<Granularity>) -> String {
    let own = Granularity::of(moment);
    moment.label(dates.map_or(own, |dates| own.max(dates.min(Granularity::Day))))
}

/// Moments that show together, ascending, each with how much it counts.
type Shown = Vec<(Option<Moment>, f64)>;

/// Moments of a label that are told one by one, at most.
const MOST_TOLD: usize = 4;

/// What says which moments show together: `1650 + 1750`, `1400 … 1900 (6)`; `None`: where there is one that is none.
fn label_of(shown: &Shown, dates: Option<Granularity>) -> Option<String> {
    let told: Vec<String> = shown.iter().map(|(at, _)| at.map(|at| label(at, dates))).collect::<Option<_>>()?;
    Some(match &told[..] {
        [first, .., last] if told.len() > MOST_TOLD => format!("{first} \u{2026} {last} ({})", told.len()),
        _ => told.join(" + "),
    })
}

/// The labels of a scene's time lenses in a picture of this size: one for each lens that shows a moment and has a body, above its middle; one for
/// each pair of lenses that overlap, where another moment shows there.
///
/// # Errors
/// Those of the lenses' volumes.
pub fn labels(studio: &Studio, scene: &Scene, view: &View) -> Result<Vec<MomentLabel>, RenderError> {
    if !scene.figure.time_labels || scene.lenses.iter().all(|lens| lens.time.is_empty()) {
        return Ok(Vec::new());
    }
    let epochs = Epochs::new(scene).map_err(RenderError::Scene)?;
    let dates = studio.lifetimes(scene)?.granularity;
    let volumes = studio.lens_volumes(scene, view.size)?;
    let is_timed = |volume: &&LensVolume| epochs.operators.iter().any(|(lens, _)| *lens == volume.lens);
    let timed: Vec<&LensVolume> = volumes.iter().filter(is_timed).collect();
    let moments_at =
        |place: DVec3| epochs.moments_at(|lens| timed.iter().any(|volume| volume.lens == lens && holds(volume, place)));
    let mut labels: Vec<MomentLabel> = Vec::new();
    // A label of a lens stands on the top of its outline, one of two lenses above the middle of what they share.
    let mut add = |volume: &LensVolume, bounds: &Aabb, known: &[Shown]| {
        let is_whole = known.is_empty();
        let own = &scene.lenses[volume.lens as usize];
        let middle = bounds.center();
        let shown = moments_at(middle);
        let on_outline =
            || volume.box_seen(view).map(|(low, high)| DVec3::new(0.5 * (low.x + high.x), low.y.max(0.0), 1.0));
        let above = || view.pixel(middle.with_z(bounds.max.z)).or_else(|| view.pixel(middle));
        let top = on_outline().filter(|_| is_whole).or_else(above);
        let is_seen = |at: &DVec3| {
            at.z > 0.0 && at.x >= 0.0 && at.y >= 0.0 && at.x < f64::from(view.size[0]) && at.y < f64::from(view.size[1])
        };
        if own.body == LensBody::None || known.contains(&shown) {
            return shown;
        }
        if let (Some(text), Some(at)) = (label_of(&shown, dates), top.filter(is_seen)) {
            labels.push(MomentLabel { text, at: at.truncate(), color: own.color });
        }
        shown
    };
    let bounded = |volume: &&&LensVolume| volume.region.is_bounded() && !volume.everywhere;
    let own: Vec<&LensVolume> = timed.iter().filter(bounded).copied().collect();
    let moments: Vec<Shown> = own.iter().map(|volume| add(volume, &volume.region.bounds(), &[])).collect();
    for (i, above) in own.iter().enumerate() {
        for (j, below) in own[..i].iter().enumerate() {
            let (a, b) = (above.region.bounds(), below.region.bounds());
            let shared = Aabb { min: a.min.max(b.min), max: a.max.min(b.max) };
            let is_shared = !shared.is_empty() && holds(above, shared.center()) && holds(below, shared.center());
            if is_shared && above.lens != below.lens {
                add(above, &shared, &[moments[i].clone(), moments[j].clone()]);
            }
        }
    }
    Ok(labels)
}

/// Whether a volume holds a place, as far as that can be told without the city.
fn holds(volume: &LensVolume, place: DVec3) -> bool {
    match volume.region.volume() {
        Some(shape) => shape.contains(place),
        None => volume.region.bounds().distance_to(place) == 0.0,
    }
}

impl Studio {
    /// When the objects of its city are there.
    ///
    /// # Errors
    /// An attribute that the scene asks for is not there.
    pub fn lifetimes(&self, scene: &Scene) -> Result<std::sync::Arc<Lifetimes>, RenderError> {
        self.known_lifetimes().of(&self.model, &scene.city.dating).map_err(RenderError::Scene)
    }
}
