//! Where lenses lay closed shells open: the ends of volumes that have sections, as plain data.

use crate::{
    lens::Class,
    render::{
        cut::Cut, eye::PictureTile, frame::FrameInput, hiding::Reach, layout, operations::Operations, palette,
        seen::SeenVolume, volume::projected_box,
    },
    shader::{EffectKind, handlers},
};

/// How often rays may leave a volume that is not convex, or enter it, and have a section there.
const TURNS: u32 = 4;
/// One end of one volume.
#[derive(Clone, Debug)]
pub(super) struct SectionRound {
    /// Whose.
    pub lens: u32,
    /// Where it may be.
    pub part: PictureTile,
    pub reach: Reach,
    pub stage: layout::SectionStage,
}

/// Whether some lens of the scene asks for sections, in view or not, and hides something or shows something else.
pub(super) fn are_asked_for(input: &FrameInput) -> bool {
    input.volumes.iter().any(|v| v.section.is_some() && !ends_of(input.operations, v.lens).is_empty())
}

/// Of which of its ends a lens has sections: where rays leave it (`true`), where they enter it.
pub(super) fn ends_of(operations: &Operations, lens: u32) -> Vec<bool> {
    let hides = |effect: u32| handlers()[effect as usize].kind == EffectKind::Hide;
    let hidden = operations.list.iter().filter(|o| o.lens == Some(lens) && hides(o.effect)).map(|o| o.class);
    let hidden: Vec<Class> = hidden.collect();
    let shown: Vec<Class> = operations.contents.iter().filter(|c| c.lens == lens).map(|c| c.class).collect();
    // What is shown instead begins where its class does, and what is below it again where that ends.
    let is_one = |classes: &[Class], asked: &[Class]| classes.iter().any(|class| asked.contains(class));
    let leaves = hidden.contains(&Class::Inside) || is_one(&shown, &[Class::Inside, Class::Behind]);
    let enters = hidden.contains(&Class::Front) || is_one(&shown, &[Class::Inside, Class::Front]);
    [(true, leaves), (false, enters)].into_iter().filter(|(_, is_one)| *is_one).map(|(end, _)| end).collect()
}

/// The ends of a frame's volumes at which something may be laid open.
pub(super) fn rounds(input: &FrameInput, seen: &[SeenVolume], cut: Option<&Cut>) -> Vec<SectionRound> {
    let Some(cut) = cut else { return Vec::new() };
    let mut rounds = Vec::new();
    for (number, of_seen) in seen.iter().enumerate() {
        let volume = &input.volumes[of_seen.index];
        let Some(color) = volume.section else { continue };
        if !cut.hiding.lenses.contains(&volume.lens) || !volume.region.is_bounded() {
            continue;
        }
        let (view, bounds) = (&input.view, volume.bounds);
        let reach = projected_box(view, &bounds).map_or(Reach::Everywhere, |(low, high)| Reach::Along(low, high));
        let middle = bounds.center() - view.camera.eye;
        let center = [middle.dot(view.basis.right), middle.dot(view.basis.up), -view.depth(bounds.center())];
        let radius = 1.01 * bounds.center().distance(bounds.max);
        // What a file's sprite holds need not be convex.
        let intervals = volume.region.most_intervals().filter(|_| volume.region.saved().is_none());
        let turns = intervals.map_or(TURNS, |most| TURNS.min(most as u32));
        for leaves in ends_of(input.operations, volume.lens) {
            rounds.extend((0..turns).map(|turn| SectionRound {
                lens: volume.lens,
                part: of_seen.bounds,
                reach: reach.clone(),
                stage: layout::SectionStage {
                    center: center.map(|x| x as f32),
                    radius: radius as f32,
                    color: palette::linear(color),
                    volume: number as u32,
                    leaves: u32::from(leaves),
                    turn,
                    has_forms: u32::from(intervals.is_some()),
                    pad_0: 0,
                },
            }));
        }
    }
    rounds
}
