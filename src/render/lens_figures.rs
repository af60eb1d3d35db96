//! What a picture says of the lenses of its scene: masks and figures, also where one stands for several that were drawn.

use crate::{
    lens::{Class, solids::ShownCity},
    render::{
        enclosed::{areas, objects_meeting},
        picture::Picture,
        resolve::Resolved,
        stats,
        volume::LensVolume,
    },
    scene::{Drawn, Scene},
};

/// What is counted: the lenses of a scene, as they were drawn.
#[derive(Clone, Copy)]
pub(super) struct FiguresOf<'a> {
    pub scene: &'a Scene,
    pub drawn: &'a Drawn<'a>,
    pub resolved: &'a Resolved,
    /// The city where it is shown.
    pub city: ShownCity<'a>,
    /// Which lenses of the scene can be seen.
    pub seen: &'a [bool],
}

/// What statistics say of a lens of the scene; `at_rest`: its city.
pub(super) fn lens_figures(of: FiguresOf, at_rest: ShownCity, picture: &Picture, index: usize) -> stats::LensFigures {
    let FiguresOf { scene, drawn, resolved, city, seen } = of;
    let Resolved { volumes, contents, deformations, .. } = resolved;
    let visible = seen[index];
    let lens = &scene.lenses[index];
    let whole = drawn.whole(index as u32);
    let volumes: Vec<&LensVolume> = volumes.iter().filter(|v| v.lens == whole).collect();
    let planes = &picture.classes[3 * (index / 32)..3 * (index / 32) + 3];
    let bit = |plane: &[u32], i: usize| plane[i] >> (index % 32) & 1 == 1;
    let (mut front, mut inside, mut behind, mut rest) = (0, 0, 0, 0);
    for i in 0..planes[0].len() {
        match (bit(&planes[0], i), bit(&planes[1], i), bit(&planes[2], i)) {
            (true, ..) => inside += 1,
            (_, true, false) => front += 1,
            (_, false, true) => behind += 1,
            _ => rest += 1,
        }
    }
    let acts_inside = lens.classes().any(|class| class == Class::Inside);
    stats::LensFigures {
        id: index as u32,
        name: lens.name.clone(),
        kind: lens.kind.word().to_owned(),
        visible,
        objects: match contents.of_lens(whole) {
            Some(content) => content.objects_meeting(at_rest, &volumes, &deformations.moved),
            None => {
                // What it moves is in it at rest.
                let city = if lens.deform().is_some() { at_rest } else { city };
                objects_meeting(city, &areas(&volumes)).len() as u64
            }
        },
        covered: inside,
        pixels: if acts_inside { inside } else { 0 },
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
