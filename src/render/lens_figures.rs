//! What a picture says of the lenses of its scene: masks and figures, also where one stands for several that were drawn.

use crate::{
    lens::{Class, solids::ShownCity},
    render::{
        displayed::Showing,
        enclosed::{areas, objects_meeting},
        moved::Moved,
        operations::{Operation, Operations},
        picture::Picture,
        resolve::Resolved,
        stats,
        volume::LensVolume,
    },
    scene::{Drawn, Scene},
    shader::{EffectKind, handlers},
};

/// What is counted: the lenses of a scene, as they were drawn.
#[derive(Clone, Copy)]
pub(super) struct FiguresOf<'a> {
    pub scene: &'a Scene,
    pub drawn: &'a Drawn<'a>,
    pub resolved: &'a Resolved,
    /// The city.
    pub city: ShownCity<'a>,
    /// Which lenses of the scene can be seen.
    pub seen: &'a [bool],
}

/// Of the `planned` effects those that ran, by name: everywhere, or at some pixel of their class of a lens. What decides who is shown, or
/// how much of it, is asked of more than what is shown, and runs where it is planned. Before lenses are folded ([`Picture::fold`]).
pub(super) fn handlers_that_ran(planned: &[u32], operations: &Operations, picture: &Picture) -> Vec<String> {
    let has_lines = operations.draws_lines();
    let on_lines = |kind: EffectKind| has_lines && kind.touches_lines();
    let has_ran = |operation: &Operation| {
        let Some(lens) = operation.lens else { return true };
        let is_soft = operations.borders.iter().any(|(of, _)| *of == lens);
        let kind = handlers()[operation.effect as usize].kind;
        let asks_all = is_soft || kind.decides_visibility() || kind == EffectKind::Opacity || on_lines(kind);
        asks_all || picture.class_counts[lens as usize].of(operation.class) > 0
    };
    let is_used = |effect: u32| operations.list.iter().any(|o| o.effect == effect && has_ran(o));
    // What no lens or style names is the program's own.
    let is_named = |effect: u32| operations.list.iter().any(|o| o.effect == effect);
    let ran = planned.iter().filter(|&&effect| !is_named(effect) || is_used(effect));
    ran.map(|&effect| handlers()[effect as usize].name.clone()).collect()
}

/// What statistics say of a lens of the scene.
pub(super) fn lens_figures(of: FiguresOf, picture: &Picture, index: usize) -> stats::LensFigures {
    let FiguresOf { scene, drawn, resolved, city, seen } = of;
    let Resolved { volumes, contents, deformations, .. } = resolved;
    let visible = seen[index];
    let lens = &scene.lenses[index];
    let whole = drawn.whole(index as u32);
    let volumes: Vec<&LensVolume> = volumes.iter().filter(|v| v.lens == whole).collect();
    let of_class =
        [Class::Inside, Class::Front, Class::Behind, Class::Rest].map(|c| (c, picture.class_counts[index].of(c)));
    let [inside, front, behind, rest] = of_class.map(|(_, count)| count);
    let acts_on = |class: Class| !volumes.is_empty() && lens.classes().any(|own| own == class);
    stats::LensFigures {
        id: index as u32,
        name: lens.name.clone(),
        kind: lens.kind.word().to_owned(),
        visible,
        objects: match contents.of_lens(whole) {
            Some(content) => content.objects_meeting(city, &volumes, &deformations.moved),
            None => {
                // What it moves is in it at rest.
                let nothing = Moved::default();
                let moved = if lens.deform().is_some() { &nothing } else { &deformations.moved };
                objects_meeting(city, &areas(&volumes), &Showing::of_city(moved)).len() as u64
            }
        },
        covered: inside,
        pixels: of_class.into_iter().filter(|(class, _)| acts_on(*class)).map(|(_, count)| count).sum(),
        classified: if volumes.is_empty() {
            stats::Classified::default()
        } else {
            // By object nothing is in front or behind.
            let has_sides = volumes.iter().any(|v| v.region.has_sides());
            let side = |count| has_sides.then_some(count);
            stats::Classified { front: side(front), inside: Some(inside), behind: side(behind), rest: Some(rest) }
        },
        occluders: None,
        seen: None,
        over_time: None,
    }
}

impl Picture {
    /// Makes what was noted of the lenses that were drawn that of the scene's lenses.
    pub(super) fn fold(&mut self, drawn: &Drawn, lens_count: usize) {
        if drawn.owners.is_none() {
            return;
        }
        let counts = [&mut self.excess, &mut self.open, &mut self.weakened, &mut self.folded];
        let counts = counts.into_iter().chain(&mut self.not_derived);
        for counts in counts {
            let of_drawn = std::mem::take(counts);
            of_drawn.into_iter().for_each(|(lens, count)| *counts.entry(drawn.owner(lens)).or_default() += count);
        }
        let of_drawn = std::mem::take(&mut self.class_counts);
        let own = |lens: usize| of_drawn.get(drawn.whole(lens as u32) as usize).copied();
        self.class_counts = (0..lens_count).filter_map(own).collect();
    }
}
