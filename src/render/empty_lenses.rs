//! Lenses in which nothing of the cities lies, nor of fields, as far as boxes tell: what they do to what is inside is done to nothing.

use crate::{
    geom::Aabb,
    lens::{Class, LensBody},
    render::{city_facts::CityFacts, frame::FrameInput, volume::LensVolume},
    view::View,
};

/// Pixels that a line may be drawn beside the edge that it shows.
const LINE_PX: f64 = 8.0;
/// Boxes that are held against each other in one frame, at most: some tenths of a millisecond.
const MOST_TESTS: usize = 1 << 16;

/// The lenses, ascending, in whose volumes nothing is drawn. Where something is deformed none is known to be: its parts have one box.
pub(super) fn empty_lenses(input: &FrameInput, facts: &CityFacts) -> Vec<u32> {
    if input.volumes.is_empty() || !facts.moved.is_empty() {
        return Vec::new();
    }
    let of_city = facts.chunks.iter();
    let of_contents = facts.contents.iter().flat_map(|content| &content.chunks);
    let of_fields = input.fields.boxes();
    let of_chunks = of_city.chain(of_contents).copied().flatten().map(|chunk| chunk.bounds);
    let chunks: Vec<Aabb> = of_chunks.chain(of_fields).collect();
    if chunks.len() * input.volumes.len() > MOST_TESTS {
        return Vec::new();
    }
    let is_empty = |volume: &LensVolume| {
        room_of(volume, &input.view).is_some_and(|room| !chunks.iter().any(|chunk| chunk.meets(&room)))
    };
    let of_lens = input.volumes.chunk_by(|a, b| a.lens == b.lens);
    of_lens.filter(|volumes| volumes.iter().all(is_empty)).map(|volumes| volumes[0].lens).collect()
}

/// The box of all that a volume may hold, with what is drawn beside it, metres; `None`: it has none that numbers alone tell.
fn room_of(volume: &LensVolume, view: &View) -> Option<Aabb> {
    // A sprite rounds, and a section is seen where no face is.
    let is_told = volume.region.is_bounded() && volume.sprite.is_none() && !volume.has_own_eye();
    if !is_told || volume.section.is_some() || volume.everywhere {
        return None;
    }
    let bounds = volume.bounds_of_border(view);
    let farthest = bounds.corners().into_iter().map(|corner| view.depth(corner)).fold(0.0, f64::max);
    let beside = LINE_PX * view.pixel_m(farthest.max(view.camera.near_m));
    let room = Aabb { min: bounds.min - beside, max: bounds.max + beside };
    (room.size().is_finite() && !room.is_empty()).then_some(room)
}

/// Those of them that do nothing then: nobody sees a body of theirs, shows anything in them, or asks for their masks.
pub(super) fn idle_lenses(empty: &[u32], input: &FrameInput) -> Vec<u32> {
    let operations = input.operations;
    let acts = |lens: u32| {
        operations.list.iter().any(|o| o.lens == Some(lens) && o.class != Class::Inside)
            || operations.contents.iter().any(|content| content.lens == lens)
            || input.volumes.iter().any(|volume| volume.lens == lens && volume.drawn != LensBody::None)
    };
    if input.masks { Vec::new() } else { empty.iter().copied().filter(|&lens| !acts(lens)).collect() }
}
