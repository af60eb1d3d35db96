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
    shader::handlers,
    view::View,
};

/// Where something may be hidden, or drawn in lines.
#[derive(Clone, Debug, PartialEq)]
pub enum Reach {
    /// Anywhere.
    Everywhere,
    /// In a box, metres.
    Within(Aabb),
    /// In front of or behind what is seen between these pixels.
    Along(DVec2, DVec2),
}

impl Reach {
    /// Box around it, metres.
    pub fn bounds(&self) -> Aabb {
        match self {
            Self::Within(around) => *around,
            Self::Everywhere | Self::Along(..) => Aabb { min: glam::DVec3::NEG_INFINITY, max: glam::DVec3::INFINITY },
        }
    }

    /// Whether it may have to do with something in a box.
    pub fn touches(&self, bounds: &Aabb, view: &View) -> bool {
        match self {
            Self::Everywhere => true,
            Self::Within(around) => around.meets(bounds),
            Self::Along(low, high) => {
                projected_box(view, bounds).is_none_or(|(near, far)| near.cmple(*high).all() && far.cmpge(*low).all())
            }
        }
    }
}

/// Where one class of a lens is, or of the context (`None`), seen from the main view.
pub fn reaches_of(lens: Option<u32>, class: Class, volumes: &[LensVolume], view: &View) -> Vec<Reach> {
    let Some(lens) = lens else { return vec![Reach::Everywhere] };
    let of_volume = |volume: &LensVolume| match class {
        Class::Rest => Reach::Everywhere,
        // In front of what its own eye sees, or behind it, places may be anywhere.
        Class::Front | Class::Behind if volume.has_own_eye() => Reach::Everywhere,
        _ if !volume.body.is_bounded() && volume.has_own_eye() => Reach::Everywhere,
        _ if !volume.body.is_bounded() => {
            volume.box_seen(view).map_or(Reach::Everywhere, |(low, high)| Reach::Along(low, high))
        }
        Class::Inside => Reach::Within(volume.bounds_of_border(view)),
        Class::Front | Class::Behind => projected_box(view, &volume.bounds_of_border(view))
            .map_or(Reach::Everywhere, |(low, high)| Reach::Along(low, high)),
    };
    volumes.iter().filter(|v| v.lens == lens).map(of_volume).collect()
}

/// Where the lenses of a frame, and its context, may hide something.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Hiding {
    reaches: Vec<Reach>,
    /// Where contents of lenses may be, by their numbers.
    contents: Vec<(u32, Reach)>,
    /// The lenses that hide something or show something else, ascending.
    pub lenses: Vec<u32>,
}

impl Hiding {
    /// Of all hiding effects of the context and of the lenses that `is_active`, and of the contents of these, seen from the
    /// main view.
    pub fn new(operations: &Operations, volumes: &[LensVolume], view: &View, is_active: impl Fn(u32) -> bool) -> Self {
        let mut hiding = Self::default();
        let hides = |effect: u32| handlers()[effect as usize].kind.decides_visibility();
        let is_active = |lens: Option<u32>| lens.is_none_or(&is_active);
        for operation in operations.list.iter().filter(|o| hides(o.effect) && is_active(o.lens)) {
            hiding.lenses.extend(operation.lens);
            hiding.reaches.extend(reaches_of(operation.lens, operation.class, volumes, view));
        }
        for content in operations.contents.iter().filter(|c| is_active(Some(c.lens))) {
            hiding.lenses.push(content.lens);
            let own = reaches_of(Some(content.lens), content.class, volumes, view);
            hiding.contents.extend(own.iter().map(|reach| (content.city, reach.clone())));
            hiding.reaches.extend(own);
        }
        hiding.lenses.sort_unstable();
        hiding.lenses.dedup();
        hiding
    }

    /// Whether a content of lenses, by its number, may show something in a box.
    pub fn shows(&self, city: u32, bounds: &Aabb, view: &View) -> bool {
        self.contents.iter().any(|(number, reach)| *number == city && reach.touches(bounds, view))
    }

    /// Whether something in a box may be hidden.
    pub fn touches(&self, bounds: &Aabb, view: &View) -> bool {
        self.reaches.iter().any(|reach| reach.touches(bounds, view))
    }
}
