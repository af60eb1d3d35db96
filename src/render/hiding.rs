//! What lenses hide, as far as a frame's passes go: which parts of the city may lose fragments.
//!
//! A pipeline that discards costs early depth tests, so only chunks that a hiding lens may reach are drawn by one
//! (architecture, decision 3).

use glam::DVec2;

use crate::{
    geom::Aabb,
    lens::Class,
    render::{
        operations::Operations,
        volume::{LensVolume, projected_box},
    },
    shader::{EffectKind, handlers},
    view::View,
};

/// Where something may be hidden.
#[derive(Clone, Debug, PartialEq)]
enum Reach {
    /// Anywhere.
    Everywhere,
    /// In a box, metres.
    Within(Aabb),
    /// In front of or behind what is seen between these pixels.
    Along(DVec2, DVec2),
}

/// Where the lenses of a frame, and its context, may hide something.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Hiding {
    reaches: Vec<Reach>,
    /// The lenses that hide something, ascending.
    pub lenses: Vec<u32>,
}

impl Hiding {
    /// Of all hiding effects of the context and of the lenses that `is_active`, seen from the main view.
    pub fn new(operations: &Operations, volumes: &[LensVolume], view: &View, is_active: impl Fn(u32) -> bool) -> Self {
        let mut hiding = Self::default();
        let hides = |effect: u32| handlers()[effect as usize].kind == EffectKind::Hide;
        for operation in operations.list.iter().filter(|o| hides(o.effect)) {
            let Some(lens) = operation.lens else {
                hiding.reaches.push(Reach::Everywhere);
                continue;
            };
            if !is_active(lens) {
                continue;
            }
            hiding.lenses.push(lens);
            let own = volumes.iter().filter(|v| v.lens == lens);
            hiding.reaches.extend(own.map(|volume| match operation.class {
                Class::Rest => Reach::Everywhere,
                Class::Inside => Reach::Within(volume.bounds),
                Class::Front | Class::Behind => {
                    projected_box(view, &volume.bounds).map_or(Reach::Everywhere, |(low, high)| Reach::Along(low, high))
                }
            }));
        }
        hiding.lenses.dedup();
        hiding
    }

    /// Whether something in a box may be hidden.
    pub fn touches(&self, bounds: &Aabb, view: &View) -> bool {
        self.reaches.iter().any(|reach| match reach {
            Reach::Everywhere => true,
            Reach::Within(around) => around.meets(bounds),
            Reach::Along(low, high) => {
                projected_box(view, bounds).is_none_or(|(near, far)| near.cmple(*high).all() && far.cmpge(*low).all())
            }
        })
    }
}
