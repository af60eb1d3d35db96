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
        asks_all || picture.class_at(lens as usize).any(|class| class == operation.class)
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
    let (mut front, mut inside, mut behind, mut rest) = (0, 0, 0, 0);
    for class in picture.class_at(index) {
        match class {
            Class::Inside => inside += 1,
            Class::Front => front += 1,
            Class::Behind => behind += 1,
            Class::Rest => rest += 1,
        }
    }
    let of_class = [(Class::Inside, inside), (Class::Front, front), (Class::Behind, behind), (Class::Rest, rest)];
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
    /// The class of what each pixel shows with regard to a lens, as it was written down.
    fn class_at(&self, lens: usize) -> impl Iterator<Item = Class> {
        let planes = &self.classes[3 * (lens / 32)..3 * (lens / 32) + 3];
        (0..planes[0].len()).map(move |i| {
            let [inside, front, behind] = [0, 1, 2].map(|plane: usize| planes[plane][i] >> (lens % 32) & 1 == 1);
            match (inside, front, behind) {
                (true, ..) => Class::Inside,
                (_, true, false) => Class::Front,
                (_, false, true) => Class::Behind,
                _ => Class::Rest,
            }
        })
    }

    /// Makes what was noted of the lenses that were drawn that of the scene's lenses.
    pub(super) fn fold(&mut self, drawn: &Drawn, lens_count: usize) {
        if drawn.owners.is_none() {
            return;
        }
        let counts = [&mut self.excess, &mut self.open, &mut self.weakened].into_iter().chain(&mut self.not_derived);
        for counts in counts {
            let of_drawn = std::mem::take(counts);
            of_drawn.into_iter().for_each(|(lens, count)| *counts.entry(drawn.owner(lens)).or_default() += count);
        }
        let words = drawn.scene.lenses.len().max(1).div_ceil(32);
        let per_word = self.classes.len() / words;
        let of_drawn = std::mem::take(&mut self.classes);
        let pixels = of_drawn.first().map_or(0, Vec::len);
        self.classes = vec![vec![0; pixels]; lens_count.div_ceil(32) * per_word];
        for lens in 0..lens_count {
            let whole = drawn.whole(lens as u32) as usize;
            for class in 0..per_word {
                let from = &of_drawn[whole / 32 * per_word + class];
                let to = &mut self.classes[lens / 32 * per_word + class];
                to.iter_mut().zip(from).for_each(|(to, from)| *to |= (from >> (whole % 32) & 1) << (lens % 32));
            }
        }
    }
}
