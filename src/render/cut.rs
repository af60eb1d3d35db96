//! What is hidden in one frame, and by which programs the parts of the city that it may reach are drawn.

use std::ops::Range;

use glam::DVec2;

use crate::{
    render::{
        city::Chunk,
        eye::{PictureTile, view_uniform},
        frame::FrameInput,
        hiding::{Hiding, Told},
        layout,
        own_sprites::OwnSprites,
        volume::LensVolume,
    },
    shader::{Plan, handlers},
    view::View,
};

/// What is hidden from one eye.
#[derive(Clone, Debug)]
pub(super) struct Cut {
    /// Where.
    pub hiding: Hiding,
    /// What.
    pub plan: Plan,
}

/// What chunks are told apart for.
#[derive(Clone, Copy, Debug)]
pub(super) struct Asked {
    /// Whether they are of a content of lenses.
    pub is_content: bool,
    /// Whether triangles must follow each other as they lie: of coplanar faces the later one wins.
    pub keeps_order: bool,
}

/// What is hidden from the main view, and from sun and sky; `None` where no hiding lens is in view.
#[derive(Clone, Debug, Default)]
pub(super) struct Cuts {
    pub picture: Option<Cut>,
    pub sun: Option<Cut>,
}

/// Shapes of lens volumes for the sun, in the main view's space.
pub(super) struct Shapes {
    pub eye: layout::View,
    pub shapes: Vec<layout::Region>,
    pub planes: Vec<[f32; 4]>,
}

/// From where light falls that something may be hidden from.
#[derive(Clone, Copy, Debug)]
pub(super) enum Lit<'a> {
    /// No map is drawn.
    Unshaded,
    /// What this view of the sun shows.
    From(&'a View),
    /// All: sky is everywhere.
    FromEverywhere,
}

impl Cuts {
    pub fn all(&self) -> impl Iterator<Item = &Cut> {
        self.picture.iter().chain(&self.sun)
    }
}

impl Cut {
    /// Of chunks the runs of indices that it leaves alone, and those that it may reach (`true`): all of a content. Those of which it leaves
    /// nothing opaque are left out, and empty parts.
    pub fn parts(cut: Option<&Self>, view: &View, chunks: &[&Chunk], asked: Asked) -> Vec<(Vec<Range<u32>>, bool)> {
        let mut told = Told::default();
        for chunk in chunks {
            match cut {
                None => told.add(&chunk.range, asked.is_content),
                Some(cut) if asked.is_content => {
                    if !cut.hiding.clears(chunk, view) {
                        told.add(&chunk.range, true);
                    }
                }
                Some(cut) => cut.hiding.tell_apart(chunk, view, asked.keeps_order, &mut told),
            }
        }
        [(told.whole, false), (told.reached, true)].into_iter().filter(|(part, _)| !part.is_empty()).collect()
    }

    /// The shapes of its lenses.
    pub fn shapes(&self, input: &FrameInput, own_sprites: &OwnSprites) -> Shapes {
        let (mut shapes, mut planes) = (Vec::new(), Vec::new());
        for (i, volume) in input.volumes.iter().enumerate().filter(|(_, v)| self.hiding.lenses.contains(&v.lens)) {
            shapes.push(match volume.has_own_eye() {
                true => own_sprites.rows(i, &input.view, &mut planes),
                false => volume.rows(&input.view, &mut planes),
            });
        }
        let whole = PictureTile::whole(input.view.size);
        Shapes { eye: view_uniform(&input.view, whole, DVec2::ZERO, 0, 0.0), shapes, planes }
    }

    /// All numbers that decide what is hidden from the sun.
    pub fn all_numbers(&self, input: &FrameInput, own_sprites: &OwnSprites) -> Vec<u8> {
        let Shapes { eye, shapes, planes } = self.shapes(input, own_sprites);
        let mut bytes = bytemuck::bytes_of(&eye).to_vec();
        bytes.extend_from_slice(bytemuck::cast_slice(&shapes));
        bytes.extend_from_slice(bytemuck::cast_slice(&planes));
        bytes.extend_from_slice(bytemuck::cast_slice(&input.operations.parameters));
        bytes.extend_from_slice(bytemuck::cast_slice(&input.operations.object_values));
        bytes
    }
}

impl Cuts {
    /// What is hidden in a frame. `picture`: what hides something in the picture, where the lenses that `is_seen` are; nothing is
    /// inside those that are `empty`.
    pub fn new(
        input: &FrameInput,
        is_seen: impl Fn(u32) -> bool,
        empty: &[u32],
        lit: Lit,
        picture: Option<Plan>,
    ) -> Self {
        let of = |hiding: Hiding, plan: Option<Plan>| plan.map(|plan| Cut { hiding, plan });
        let hiding =
            |is_active: &dyn Fn(u32) -> bool| Hiding::new(input.operations, input.volumes, &input.view, is_active);
        let frustum = match lit {
            Lit::Unshaded => None,
            Lit::From(sun) => Some(Some(sun.frustum(1.0))),
            Lit::FromEverywhere => Some(None),
        };
        let sun = frustum.and_then(|frustum| {
            let hiding = hiding(&|lens| {
                let is_anywhere = |v: &LensVolume| v.everywhere || (v.has_own_eye() && v.asks_sides);
                let meets = |v: &LensVolume| frustum.as_ref().is_none_or(|frustum| frustum.meets(&v.bounds));
                let is_met = |v: &LensVolume| is_anywhere(v) || meets(v);
                input.volumes.iter().any(|v| v.lens == lens && !v.keeps_shadows && is_met(v))
            });
            let own = input.volumes.iter().filter(|v| hiding.lenses.contains(&v.lens));
            // What the picture's sprites hold says nothing of what only the sun sees.
            let own = own.map(|v| (v.lens, v.test_from_sun(), v.region.forms_in_combination()));
            let plan = input.operations.lens_plan(&own.collect::<Vec<_>>(), empty, false, false).hiding(handlers());
            // Nor of how wide a border is that is measured in pixels: shadows end at the volume.
            let plan = plan.map(Plan::without_borders);
            of(hiding, plan)
        });
        let by_material = picture.as_ref().is_some_and(|plan| plan.clear_materials);
        Self { picture: of(hiding(&is_seen).with_materials(by_material), picture), sun }
    }
}
