//! What a picture cost and what its lenses did (contract, "Statistics"). Counts are counted, not declared.

use serde::Serialize;

/// One statistics object, as `--stats` writes it.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Statistics {
    /// Where it was drawn.
    pub adapter: Adapter,
    /// How the city was read.
    pub load: Load,
    /// What the city holds on the GPU.
    pub city: City,
    /// The frame as a whole.
    pub frame: Frame,
    /// Passes in order, all samples and tiles of the picture; measures are those of the first sample.
    pub passes: Vec<Pass>,
    /// Pipelines.
    pub pipelines: Pipelines,
    /// Names of the handlers that ran: everywhere, or at a pixel of their class of a lens.
    pub handlers: Vec<String>,
    /// Every lens of the scene, disabled ones included.
    pub lenses: Vec<LensFigures>,
    /// What lenses show in themselves, as far as it was loaded.
    pub contents: Vec<Content>,
    /// Overlays.
    pub overlays: Vec<serde_json::Value>,
    /// What was wrong and lived with.
    pub warnings: Vec<serde_json::Value>,
}

/// Where it was drawn.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Adapter {
    /// As the driver calls it.
    pub name: String,
    /// `vulkan`, `metal`, `dx12`, `gl`.
    pub backend: String,
    /// `hardware`, `integrated`, `virtual`, `software`, `other`.
    pub kind: String,
}

/// How the city was read.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Load {
    /// Milliseconds by stage.
    pub ms: std::collections::BTreeMap<String, f64>,
    /// Largest memory of the process so far, where the system tells.
    pub peak_bytes: Option<u64>,
}

/// What the city holds on the GPU.
#[derive(Clone, Debug, Default, Serialize)]
pub struct City {
    /// City objects with something to show.
    pub objects: u64,
    /// Triangles that can be drawn, the plain ground included.
    pub triangles: u64,
    /// Their vertices.
    pub vertices: u64,
    /// Buffers and textures.
    pub gpu_bytes: u64,
}

/// What lenses show in themselves.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Content {
    /// The lenses that show it.
    pub lenses: Vec<u32>,
    /// City objects with something to show.
    pub objects: u64,
    /// What the indices of a data set's objects are counted from in object ids; `null` for the scene's own files.
    pub first_object: Option<u32>,
    /// Triangles that can be drawn, a plain ground included.
    pub triangles: u64,
    /// Bytes on the GPU; 0 where it is the city as it is shown, or counted above.
    pub gpu_bytes: u64,
}

/// The frame as a whole.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Frame {
    /// From the first command to the finished picture, milliseconds.
    pub cpu_ms: f64,
    /// Sum of the passes' times; `null` without timestamps.
    pub gpu_ms: Option<f64>,
    /// Samples per pixel.
    pub samples: u32,
    /// Bytes ever allocated on the GPU: an upper bound of what was held at once.
    pub peak_gpu_bytes: u64,
    /// GPU allocations while drawing.
    pub allocations: u64,
    /// GPU uploads while drawing.
    pub uploads: u64,
    /// Bytes of these.
    pub uploaded_bytes: u64,
    /// What deformation lenses move; `null` where none does.
    pub deformed: Option<Deformed>,
    /// Translucent layers of all samples; `null` where nothing is seen through.
    pub layers: Option<Layers>,
    /// Rays that lenses bend and the processor followed, not the GPU; `null` where it followed none.
    pub traced: Option<Traced>,
}

/// Rays that the processor followed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Traced {
    /// How many, of all samples.
    pub rays: u64,
    /// How long that took, milliseconds.
    pub ms: f64,
}

/// What deformation lenses move.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Deformed {
    /// Triangles of the city that meet a deformation.
    pub met: u64,
    /// Triangles that they became.
    pub triangles: u64,
    /// How far edges may be from where they should be, pixels.
    pub tolerance_px: f64,
    /// Places that are less exact.
    pub coarse: u64,
}

/// Translucent layers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Layers {
    /// Fragments that are seen through and not behind what is opaque; 0 where the method does not count them (`weighted`,
    /// `stochastic`).
    pub fragments: u64,
    /// Bands that the picture was drawn in, for want of room.
    pub bands: u32,
    /// Fragments that are missing, for want of room.
    pub missing: u64,
    /// The method, as scene files call it.
    pub method: &'static str,
    /// What it holds on the GPU, bytes, beside the targets that every method has.
    pub gpu_bytes: u64,
    /// Rounds of peeling.
    pub rounds: u32,
    /// Fragments that are seen as one layer behind the others, for want of slots; `null` where all are (`weighted`).
    pub merged: Option<u64>,
    /// Fragments that are not shown, beyond the number of layers that are peeled.
    pub dropped: u64,
}

/// One pass.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Pass {
    /// What it does.
    pub name: String,
    /// Which view it drew.
    pub view: String,
    /// Lens ids it served, or `"scene"`.
    #[serde(rename = "for")]
    pub serves: serde_json::Value,
    /// Draw calls or dispatches.
    pub draws: u32,
    /// Triangles handed to the rasteriser.
    pub triangles: u64,
    /// Fragment shader invocations; `null` where the adapter does not count them.
    pub pixels: Option<u64>,
    /// Milliseconds on the GPU; `null` without timestamps.
    pub gpu_ms: Option<f64>,
}

/// Pipelines.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Pipelines {
    /// Made for this picture.
    pub compiled: u32,
    /// Met again.
    pub reused: u32,
    /// All that were used.
    pub names: Vec<String>,
}

/// What a lens did.
#[derive(Clone, Debug, Default, Serialize)]
pub struct LensFigures {
    /// Its number, from 0.
    pub id: u32,
    /// Its name.
    pub name: String,
    /// Its kind.
    pub kind: String,
    /// Whether its bounds met the picture.
    pub visible: bool,
    /// City objects of which a triangle meets its volume.
    pub objects: u64,
    /// Pixels whose shown surface is inside.
    pub covered: u64,
    /// Pixels whose shown surface is of a class that it acts on.
    pub pixels: u64,
    /// Pixels by class.
    pub classified: Classified,
    /// Occluders that an occlusion lens found.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub occluders: Option<Vec<Occluder>>,
    /// Of a lens that makes occluders lower, how much of its points of interest is seen; those that are points have no share.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub seen: Option<Vec<Visible>>,
    /// Of an occlusion lens in a frame of an animation, how many come and go.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub over_time: Option<OverTime>,
}

/// How much of a point of interest is seen, of what would be seen were there nothing but terrain.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Visible {
    /// Its name.
    pub poi: String,
    /// As the picture shows it, 0 to 1; `null` where nothing of it is in the picture.
    pub share: Option<f64>,
    /// The same without deformations.
    pub at_rest: Option<f64>,
}

/// Occluders over time, counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct OverTime {
    /// Such that are wholly drawn as occluders.
    pub whole: u64,
    /// Such that are to be, and fade in.
    pub entering: u64,
    /// Such that are none any more, and fade out.
    pub leaving: u64,
    /// Of all of them, such that change from one case of `render` to another.
    pub changing: u64,
}

/// A city object that hides something, with its parts.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Occluder {
    /// Its id.
    pub id: String,
    /// The tests that held, `not …` for those under `not` that did not, `forced`.
    pub why: Vec<String>,
    /// How much of a point of interest it covers, at most; `null` where no test measures it.
    pub coverage: Option<Coverage>,
    /// How far its box is from the eye, metres: what `nearer` of a case is compared with.
    pub distance: f64,
    /// Of a lens that draws occluders by cases, the one that it is drawn in, from 1 on in the order of `render`; `null`: in none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub case: Option<Option<usize>>,
    /// In a frame of an animation, how far it has come or gone, 0 to 1; one that no test holds for is `kept` by its margin, or
    /// fades.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub weight: Option<f64>,
}

/// A share of what is seen of a point of interest, were it alone.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Coverage {
    /// 0 to 1.
    pub share: f64,
    /// Lower end of the 95 % interval.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

/// Pixels by class; `null` where a class does not exist.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Classified {
    /// D < D_F.
    pub front: Option<u64>,
    /// D_F ≤ D < D_B.
    pub inside: Option<u64>,
    /// D ≥ D_B.
    pub behind: Option<u64>,
    /// The ray misses the lens, or is between two of its volumes.
    pub rest: Option<u64>,
}

/// Largest resident memory of this process so far, bytes; `None` where the system does not tell.
pub fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|l| l.starts_with("VmHWM:"))?;
    let kibibytes: u64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(kibibytes * 1024)
}
