//! What lenses hide, as far as a frame's passes go: which parts of the city may lose fragments.
//!
//! A pipeline that discards costs early depth tests, so only chunks that a hiding lens may reach are drawn by one
//! (architecture, decision 3).

use std::{ops::Range, sync::Arc};

use glam::DVec2;

use crate::{
    geom::{Aabb, Volume, shape::Sphere},
    lens::Class,
    render::{
        city::{Chunk, ObjectRun, Translucency},
        operations::{Operations, Translucent},
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
    /// In a box, and in or around a convex volume, so far.
    Around(Aabb, Volume, f64),
    /// In front of or behind what is seen between these pixels.
    Along(DVec2, DVec2),
}

impl Reach {
    /// Box around it, metres.
    pub fn bounds(&self) -> Aabb {
        match self {
            Self::Within(around) | Self::Around(around, ..) => *around,
            Self::Everywhere | Self::Along(..) => Aabb { min: glam::DVec3::NEG_INFINITY, max: glam::DVec3::INFINITY },
        }
    }

    /// Whether it may have to do with something in a box.
    pub fn touches(&self, bounds: &Aabb, view: &View) -> bool {
        match self {
            Self::Everywhere => true,
            Self::Within(around) | Self::Around(around, ..) => around.meets(bounds),
            Self::Along(low, high) => {
                projected_box(view, bounds).is_none_or(|(near, far)| near.cmple(*high).all() && far.cmpge(*low).all())
            }
        }
    }

    /// Whether it may have to do with a fragment that lies in a box: more exact than [`Self::touches`], which goes for all that is
    /// drawn around such a place.
    fn meets(&self, bounds: &Aabb, view: &View) -> bool {
        let may_be_near = |volume: &Volume, reach: f64| {
            let radius = 0.5 * bounds.size().length();
            let apart = match volume {
                Volume::Sphere(Sphere { center, radius }) => {
                    center.distance(center.clamp(bounds.min, bounds.max)) - radius
                }
                // Distances change by no more than one goes.
                _ => volume.signed_distance(bounds.center()) - radius,
            };
            apart <= reach + rounded(bounds.center().distance(view.camera.eye) + radius)
        };
        self.touches(bounds, view) && !matches!(self, Self::Around(_, volume, reach) if !may_be_near(volume, *reach))
    }
}

/// How far from its place a fragment may be taken to be that is so far from the eye, metres.
pub(super) fn rounded(distance: f64) -> f64 {
    ROUNDED_M + ROUNDED * distance
}

/// The volume by whose shape alone pixels tell what is inside, if it is convex.
pub(super) fn convex(volume: &LensVolume) -> Option<&Volume> {
    volume.region.volume().filter(|shape| shape.is_convex() && volume.sprite.is_none())
}

/// Where one class of a lens is, or of the context (`None`), seen from the main view.
pub fn reaches_of(lens: Option<u32>, class: Class, volumes: &[LensVolume], view: &View) -> Vec<Reach> {
    let Some(lens) = lens else { return vec![Reach::Everywhere] };
    let of_volume = |volume: &LensVolume| match class {
        Class::Rest => Reach::Everywhere,
        // In front of what its own eye sees, or behind it, places may be anywhere.
        Class::Front | Class::Behind if volume.has_own_eye() => Reach::Everywhere,
        _ if !volume.region.is_bounded() && volume.has_own_eye() => Reach::Everywhere,
        _ if !volume.region.is_bounded() => {
            volume.box_seen(view).map_or(Reach::Everywhere, |(low, high)| Reach::Along(low, high))
        }
        Class::Inside => match convex(volume) {
            Some(shape) => Reach::Around(volume.bounds_of_border(view), shape.clone(), volume.reach_m(view)),
            None => Reach::Within(volume.bounds_of_border(view)),
        },
        Class::Front | Class::Behind => projected_box(view, &volume.bounds_of_border(view))
            .map_or(Reach::Everywhere, |(low, high)| Reach::Along(low, high)),
    };
    volumes.iter().filter(|v| v.lens == lens).map(of_volume).collect()
}

/// The place of a fragment is rounded by far less than this part of its distance from the eye: 24 bits of a depth, and a few
/// steps of f32 from there to the distance from a lens' border.
const ROUNDED: f64 = 1.0 / 65536.0;
/// And by less than this, metres: vertices lie in the box around them but for a rounding step of their tile.
const ROUNDED_M: f64 = 1e-3;

/// Where all objects are translucent.
#[derive(Clone, Debug)]
struct Clear {
    /// In a convex volume; `None`: everywhere.
    volume: Option<(Aabb, Volume)>,
    /// Terrain too.
    terrain: bool,
}

impl Clear {
    /// Where an effect of the context is, or one of the class *inside* of a lens; where its borders are soft, nothing is sure.
    fn all_of(lens: Option<u32>, class: Class, terrain: bool, volumes: &[LensVolume]) -> Vec<Self> {
        let Some(lens) = lens else { return vec![Self { volume: None, terrain }] };
        let own = volumes.iter().filter(|v| class == Class::Inside && v.lens == lens && v.border.is_none());
        let volumes = own.filter_map(|v| Some((v.bounds, convex(v)?.clone())));
        volumes.map(|volume| Self { volume: Some(volume), terrain }).collect()
    }

    fn holds(&self, chunk: &Chunk, view: &View) -> bool {
        if chunk.has_terrain() && !self.terrain {
            return false;
        }
        let Some((around, volume)) = &self.volume else { return true };
        let Aabb { min, max } = chunk.bounds;
        around.min.cmple(min).all()
            && max.cmple(around.max).all()
            && chunk
                .bounds
                .corners()
                .into_iter()
                .all(|corner| volume.signed_distance(corner) <= -rounded(corner.distance(view.camera.eye)))
    }
}

/// Where the lenses of a frame, and its context, may hide something.
#[derive(Clone, Debug, Default)]
pub struct Hiding {
    /// Where they take something away, or put something else there.
    hidden: Vec<Reach>,
    /// Where contents of lenses may be, by their numbers.
    contents: Vec<(u32, Reach)>,
    /// Where something may be translucent, and whether terrain may be.
    translucent: Vec<(Reach, bool)>,
    /// Where all is.
    clear: Vec<Clear>,
    /// Whether what is translucent by its material counts: for whoever sees through it.
    by_material: bool,
    /// The lenses that hide something or show something else, ascending.
    pub lenses: Vec<u32>,
    /// Which objects of the scene's own city come and go; `None`: none does.
    presence: Option<Arc<[Presence]>>,
    /// Whether those that do may be there by halves.
    partly: bool,
}

/// Whether an object is there at the moments that a scene shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Presence {
    /// At all of them.
    Always,
    /// At some, or that is not known.
    Sometimes,
    /// At none.
    Never,
}

/// Runs of an index buffer that are drawn.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Told {
    /// Of which nothing is hidden.
    pub whole: Vec<Range<u32>>,
    /// Of which something may be.
    pub reached: Vec<Range<u32>>,
}

impl Told {
    /// Adds a run, to the last one if it follows that.
    pub fn add(&mut self, range: &Range<u32>, is_reached: bool) {
        let own = if is_reached { &mut self.reached } else { &mut self.whole };
        match own.last_mut().filter(|last| last.end == range.start) {
            Some(last) => last.end = range.end,
            None => own.push(range.clone()),
        }
    }
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
            let reaches = reaches_of(operation.lens, operation.class, volumes, view);
            let Some(Translucent { all_objects, terrain }) = operation.translucent else {
                hiding.hidden.extend(reaches);
                continue;
            };
            hiding.translucent.extend(reaches.into_iter().map(|reach| (reach, terrain)));
            if all_objects {
                hiding.clear.extend(Clear::all_of(operation.lens, operation.class, terrain, volumes));
            }
        }
        for content in operations.contents.iter().filter(|c| is_active(Some(c.lens))) {
            hiding.lenses.push(content.lens);
            let own = reaches_of(Some(content.lens), content.class, volumes, view);
            hiding.contents.extend(own.iter().map(|reach| (content.city, reach.clone())));
            hiding.hidden.extend(own);
        }
        if operations.timed {
            hiding.presence = Some(operations.presence.clone());
            hiding.partly = operations.partly;
            hiding.lenses.extend(operations.epochs.iter().map(|e| e.lens).filter(|lens| is_active(Some(*lens))));
        }
        hiding.lenses.sort_unstable();
        hiding.lenses.dedup();
        hiding
    }

    /// With what is translucent by its material, whatever lenses do.
    pub fn with_materials(self, by_material: bool) -> Self {
        Self { by_material, ..self }
    }

    /// Whether a content of lenses, by its number, may show something in a box.
    pub fn shows(&self, city: u32, bounds: &Aabb, view: &View) -> bool {
        self.contents.iter().any(|(number, reach)| *number == city && reach.touches(bounds, view))
    }

    /// Whether all fragments of a chunk are surely translucent, or taken away: none of them is left to those that are opaque.
    pub fn clears(&self, chunk: &Chunk, view: &View) -> bool {
        (self.by_material && chunk.translucency == Translucency::All)
            || self.clear.iter().any(|clear| clear.holds(chunk, view))
            || self.is_gone(chunk)
    }

    /// Whether no object of a chunk is there at any moment that shows.
    fn is_gone(&self, chunk: &Chunk) -> bool {
        let is_never = |run: &ObjectRun| self.presence_of(run.object) == Presence::Never;
        !chunk.runs.is_empty() && chunk.runs.iter().all(is_never)
    }

    /// Whether some object of a chunk comes and goes.
    fn comes_and_goes(&self, chunk: &Chunk) -> bool {
        self.presence.is_some() && chunk.runs.iter().any(|run| self.presence_of(run.object) != Presence::Always)
    }

    /// Tells what of a chunk, of the scene's own city, is left alone from what may be reached; what is surely gone, or translucent, is neither.
    /// Objects that come and go are told apart where nothing but that hides them, and where triangles need not follow each other as they lie.
    pub fn tell_apart(&self, chunk: &Chunk, view: &View, keeps_order: bool, told: &mut Told) {
        if self.clears(chunk, view) {
            return;
        }
        let acts =
            self.hidden.iter().any(|reach| reach.meets(&chunk.bounds, view)) || self.lenses_may_clear(chunk, view);
        if !self.comes_and_goes(chunk) || !chunk.has_run_ends || keeps_order {
            told.add(&chunk.range, acts || self.comes_and_goes(chunk));
            return;
        }
        let mut start = chunk.range.start;
        for run in chunk.runs.iter() {
            let end = run.end.min(chunk.range.end);
            if end > start {
                match self.presence_of(run.object) {
                    Presence::Never => {}
                    Presence::Always => told.add(&(start..end), acts),
                    Presence::Sometimes => told.add(&(start..end), true),
                }
                start = end;
            }
        }
    }

    fn presence_of(&self, object: u32) -> Presence {
        let known = self.presence.as_ref().and_then(|presence| presence.get(object as usize));
        known.copied().unwrap_or(Presence::Always)
    }

    /// Whether all of a chunk, of the scene's own city, is surely there and translucent.
    pub fn keeps_all_clear(&self, chunk: &Chunk, view: &View) -> bool {
        self.clears(chunk, view)
            && !self.comes_and_goes(chunk)
            && !self.hidden.iter().any(|reach| reach.meets(&chunk.bounds, view))
    }

    /// Whether some fragment of a chunk may be translucent; `is_content`: of another city than the scene's own.
    pub fn may_clear(&self, chunk: &Chunk, view: &View, is_content: bool) -> bool {
        self.lenses_may_clear(chunk, view) || (self.partly && (is_content || self.comes_and_goes(chunk)))
    }

    /// The same of its material and of what lenses do.
    fn lenses_may_clear(&self, chunk: &Chunk, view: &View) -> bool {
        let may =
            |(reach, terrain): &(Reach, bool)| (*terrain || !chunk.has_terrain()) && reach.meets(&chunk.bounds, view);
        (self.by_material && chunk.translucency != Translucency::None) || self.translucent.iter().any(may)
    }

    /// Whether some fragment of a chunk may be hidden, or translucent.
    pub fn touches(&self, chunk: &Chunk, view: &View) -> bool {
        self.hidden.iter().any(|reach| reach.meets(&chunk.bounds, view))
            || self.lenses_may_clear(chunk, view)
            || self.comes_and_goes(chunk)
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use proptest::prelude::*;

    use super::*;
    use crate::{
        geom::Shape,
        render::{
            cells::NO_CELL,
            operations::Operation,
            placed_region::{Leaf, PlacedRegion},
        },
        view::Camera,
    };

    fn view() -> View {
        let camera = Camera::looking(DVec3::new(3.0, -90.0, 62.0), DVec3::new(1.0, 5.0, 2.0), 0.9);
        View::new(camera, [640, 480], &Aabb::EMPTY).expect("a view")
    }

    /// A lens in which all but terrain is translucent, or terrain too.
    fn hiding(shape: &Shape, terrain: bool, view: &View) -> Hiding {
        let body = PlacedRegion::One(Leaf::Volume(shape.volume().expect("a volume")).into());
        let mut operations = Operations::default();
        operations.list.push(Operation {
            effect: crate::shader::effect::number_of("transparent").expect("an effect"),
            parameters: 0,
            lens: Some(0),
            class: Class::Inside,
            blend: None,
            translucent: Some(Translucent { all_objects: true, terrain }),
        });
        Hiding::new(&operations, &[LensVolume::plain(0, body)], view, |_| true)
    }

    fn point(reach: f64) -> impl Strategy<Value = DVec3> {
        prop::array::uniform3(-reach..reach).prop_map(DVec3::from)
    }

    fn shapes() -> impl Strategy<Value = Shape> {
        let length = || 5.0..60.0;
        prop_oneof![
            (point(20.0), length()).prop_map(|(center, radius)| Shape::Sphere { center, radius }),
            (point(20.0), point(30.0), point(3.0)).prop_map(|(center, half, turn)| Shape::Box {
                center,
                size: half.abs() + 10.0,
                rotation: glam::DQuat::from_scaled_axis(turn),
            }),
            (point(20.0), length(), length()).prop_map(|(center, radius, height)| Shape::Cylinder {
                center,
                radius,
                height,
                axis: DVec3::new(0.6, 0.0, 0.8)
            }),
        ]
    }

    proptest! {
        #![proptest_config(crate::seeds::config())]

        /// What is left out of a pass has nothing to do in it.
        #[test]
        fn chunks_are_left_out_where_all_their_points_agree(
            shape in shapes(), low in point(40.0), size in point(30.0), terrain: bool, has_terrain: bool,
            places in prop::collection::vec(prop::array::uniform3(0.0..=1.0_f64), 64),
        ) {
            let view = view();
            let hiding = hiding(&shape, terrain, &view);
            let bounds = Aabb { min: low, max: low + size.abs() };
            let cell = if has_terrain { NO_CELL } else { 0 };
            let chunk = Chunk { range: 0..3, bounds, cell, details: 1, translucency: Translucency::None, is_around: false, gives_way: false, runs: Arc::from([]), has_run_ends: true };
            let volume = shape.volume().expect("a volume");
            let acts = terrain || !has_terrain;
            let corners = bounds.corners().into_iter();
            for place in corners.chain(places.into_iter().map(|p| low + size.abs() * DVec3::from(p))) {
                let is_translucent = acts && volume.contains(place);
                prop_assert!(is_translucent || !hiding.clears(&chunk, &view), "{place} is opaque");
                prop_assert!(!is_translucent || hiding.may_clear(&chunk, &view, false), "{place} is translucent");
            }
            // And few are kept that could be left out: those within a box's radius of the border.
            let radius = 0.5 * bounds.size().length() + 0.1;
            let distance = volume.signed_distance(bounds.center());
            prop_assert!(!acts || distance > -2.0 * radius || hiding.clears(&chunk, &view));
            prop_assert!(distance < 2.0 * radius || !hiding.may_clear(&chunk, &view, false));
        }
    }
}
