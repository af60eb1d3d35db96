//! Paths of bent rays: lenses that bend rays as a view meets them, and where the ray of a place of the picture goes (Wang et al. §3).
//!
//! Places of the picture are those of its plane at distance 1 from the eye, x right and y up; where rays are parallel, metres across. A path is
//! told by the distance D along the view axis:
//!
//! ```text
//!   eye ──────────── plane of the lens ──────────────── reached ───────────────
//!        own ray      │  bent, straight to where what   │  on in the direction in which
//!                     │  lies there is so much larger   │  the eye sees that place
//! ```
//!
//! A plane adds to the slope of the ray that meets it, as a thin lens does: `−(1−k)·φ·u`, where u is the place on the plane counted from the
//! lens' middle, and φ its power. For the ray of a pixel that is the formula of Wang et al.: with `e` = 1/distance in perspective, 0 with parallel
//! rays, `u(1 + z(e − (1−k)φ))` is where it is at z behind the plane, φ = e + 1/f. It holds for every magnification above 0, has no pole
//! where f has one, and of several lenses that a ray meets powers add: one that makes things smaller by as much undoes another one.
//! The focal point lies on the line of sight through the lens' middle, not straight before it: what is in the middle stays there.

use std::{
    borrow::Cow,
    collections::{BTreeMap, BTreeSet},
    path::Path,
    sync::Arc,
};

use glam::{DQuat, DVec2, DVec3};

use crate::{
    geom::{Shape, shape::FlatFigure},
    lens::{
        chosen::Choice,
        own_bend::OwnBend,
        ray::{Bend, Feature, FisheyeProjection, Magnify, RayLens, RayMethod, RayOutline, SampledRadius},
        share_field::{self, ShareField},
    },
    shader::MOST_RAY_LENSES,
    view::{Camera, Projection},
};

/// Of these, at most, act on some objects alone: rays are followed for each set of lenses that act on something.
pub const MOST_CHOOSING: usize = 3;

/// The rim of a lens in the picture's plane.
#[derive(Clone, Debug, PartialEq)]
pub struct Rim {
    /// Its middle.
    pub center: DVec2,
    /// From there to the rim.
    pub radius: f64,
    /// Its outline.
    pub outline: RayOutline,
    /// The colour of the grid over it, sRGB; `None`: it has none.
    pub grid: Option<[f32; 3]>,
    /// In place of an outline: how far its places are from a core.
    pub field: Option<Arc<ShareField>>,
    /// How what is seen within it is found, and how finely.
    pub method: RayMethod,
    /// As [`RayLens::fineness`] has it.
    pub fineness: f64,
    /// The objects that the lens acts on; `None`: all.
    pub only: Option<Chosen>,
}

/// Objects that a lens acts on.
#[derive(Clone, Debug, PartialEq)]
pub struct Chosen {
    /// One per object of the scene's own city.
    pub objects: Arc<[bool]>,
    /// Where their marks begin among the objects' values.
    pub first: u32,
}

impl Rim {
    /// How far from the middle a place is, in radii.
    pub fn share(&self, across: DVec2) -> f64 {
        let from = (across - self.center) / self.radius;
        if let Some(field) = &self.field {
            // Beyond its square nothing is bent.
            return if from.abs().max_element() < 1.0 { field.at(from) } else { f64::INFINITY };
        }
        match self.outline {
            RayOutline::Circle => from.length(),
            RayOutline::Square => from.abs().max_element(),
        }
    }
}

/// A lens with a plane across the view axis.
#[derive(Clone, Debug, PartialEq)]
pub struct PlaneLens {
    /// Its number among the scene's.
    pub lens: u32,
    /// Where it is in the picture.
    pub rim: Rim,
    /// How wide the band is in which rays find back, a share of the radius.
    pub border: f64,
    /// D of its plane, metres.
    pub distance: f64,
    /// D from which on what is seen is as much larger as it will be, metres.
    pub until: f64,
    /// What it takes from slopes, per metre.
    pub power: f64,
}

/// A lens that shows at each place of the picture what another place, or another direction, has.
#[derive(Clone, Debug, PartialEq)]
pub struct ImageLens {
    /// Its number among the scene's.
    pub lens: u32,
    /// Where it is in the picture.
    pub rim: Rim,
    /// What it shows.
    pub bend: ImageBend,
}

/// What a lens of the picture shows.
#[derive(Clone, Debug, PartialEq)]
pub enum ImageBend {
    /// Places nearer to its middle, or farther.
    Sampled(SampledRadius),
    /// Directions around that of its middle: the angle from rim to rim, and how angles lie in it.
    Round(f64, FisheyeProjection),
    /// What a handler of the user's says.
    Own(OwnBend),
}

/// The lenses of a view that bend rays.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RayPaths {
    /// Whether its rays are parallel.
    pub is_parallel: bool,
    /// Those of the picture, topmost first.
    pub images: Vec<ImageLens>,
    /// Those with planes, bottom first.
    pub planes: Vec<PlaneLens>,
}

/// How far shapes go that have no end, metres.
const FAR_M: f64 = 1e6;

/// Sides of a polygon in place of a circle.
const RING_SIDES: u32 = 60;

/// The view's share of where its lenses are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PictureFrame {
    /// Half its width and height, in the picture's plane.
    pub half: DVec2,
    /// Whether its rays are parallel.
    pub is_parallel: bool,
    /// D of the nearest that is seen, metres.
    pub near: f64,
}

impl PictureFrame {
    /// That of a camera's picture of so many pixels.
    pub fn new(camera: &Camera, size: [u32; 2]) -> Self {
        let is_parallel = matches!(camera.projection, Projection::Orthographic { .. });
        Self { half: camera.half_extent(size), is_parallel, near: camera.near_m }
    }

    /// What is seen through a lens before it bends rays, in camera coordinates: a flat figure just before all that is seen; `None`: it has no outline.
    pub fn figure(&self, lens: &RayLens) -> Option<Shape> {
        if matches!(lens.bend, Bend::Feature(_)) || lens.mask.is_some() {
            return None;
        }
        Some(self.flat(&self.rim(lens), 1.0, self.near))
    }

    /// What lies between shares of a rim at two distances D.
    fn between(&self, rim: &Rim, ends: [(f64, f64); 2]) -> Shape {
        Shape::Convex {
            points: ends.into_iter().flat_map(|(distance, share)| self.ring(rim, share, distance)).collect(),
        }
    }

    /// The corners of this share of a rim at D, of a circle those of a polygon around it.
    fn ring(&self, rim: &Rim, share: f64, distance: f64) -> Vec<DVec3> {
        let scale = if self.is_parallel { 1.0 } else { distance };
        let (sides, begins) = match rim.outline {
            RayOutline::Circle => (RING_SIDES, 0.0),
            RayOutline::Square => (4, 0.5),
        };
        let step = std::f64::consts::TAU / f64::from(sides);
        let radius = share * rim.radius / (0.5 * step).cos();
        let corner = |i: u32| rim.center + radius * DVec2::from_angle((f64::from(i) + begins) * step);
        (0..sides).map(|i| (scale * corner(i)).extend(-distance)).collect()
    }

    /// This share of a rim as a figure at D.
    fn flat(&self, rim: &Rim, share: f64, distance: f64) -> Shape {
        let scale = if self.is_parallel { 1.0 } else { distance };
        let radius = share * rim.radius * scale;
        let figure = match rim.outline {
            RayOutline::Circle => FlatFigure::Disc { radius },
            RayOutline::Square => FlatFigure::Rectangle { size: DVec2::splat(2.0 * radius) },
        };
        Shape::Flat { center: (scale * rim.center).extend(-distance), rotation: DQuat::IDENTITY, figure }
    }

    /// Where the rim of a lens is.
    pub fn rim(&self, lens: &RayLens) -> Rim {
        let place = DVec2::new(2.0 * lens.center.x - 1.0, 1.0 - 2.0 * lens.center.y);
        Rim {
            center: place * self.half,
            radius: lens.radius * 2.0 * self.half.y,
            outline: lens.outline,
            grid: None,
            field: None,
            method: lens.method,
            fineness: lens.fineness,
            only: None,
        }
    }
}

impl RayPaths {
    /// The lenses of a picture. `lenses`: their numbers, bottom first, and their colours, sRGB.
    pub fn new(lenses: &[(u32, &RayLens, [f32; 3])], frame: &PictureFrame, scenery: &Scenery) -> Self {
        let mut paths = Self { is_parallel: frame.is_parallel, ..Self::default() };
        for &(number, lens, color) in lenses {
            let field = lens.mask.as_ref().and_then(|file| (scenery.mask)(file));
            let plain = frame.rim(lens);
            // An image goes to the corners of its square.
            let outline = if field.is_some() { RayOutline::Square } else { plain.outline };
            let rim = Rim { grid: lens.grid.then_some(color), field, outline, ..plain };
            if rim.radius.is_nan() || rim.radius <= 0.0 {
                continue;
            }
            let image = |rim, bend| ImageLens { lens: number, rim, bend };
            match &lens.bend {
                Bend::Magnify(magnify) => {
                    let middle = || (scenery.shown)(rim.center).unwrap_or(DISTANCE_M);
                    paths.planes.extend(PlaneLens::new(number, &rim, magnify, frame, middle));
                }
                Bend::Feature(feature) => paths.planes.extend(of_feature(number, &rim, feature, frame, scenery)),
                Bend::Sample(sampling) if sampling.rate.is_even() => {}
                Bend::Sample(sampling) => {
                    paths.images.push(image(rim, ImageBend::Sampled(SampledRadius::new(&sampling.rate))));
                }
                Bend::Fisheye(fisheye) => {
                    paths.images.push(image(rim, ImageBend::Round(fisheye.angle, fisheye.projection)));
                }
                Bend::Own(used) => {
                    let own = OwnBend::new(used, &rim, frame.is_parallel);
                    paths.images.extend(own.ok().map(|own| image(rim, ImageBend::Own(own))));
                }
            }
        }
        paths.images.reverse();
        paths
    }

    /// Whether it bends no ray.
    pub fn is_empty(&self) -> bool {
        self.images.is_empty() && self.planes.is_empty()
    }

    /// Whether some lens looks in other directions than the view.
    pub fn looks_around(&self) -> bool {
        self.images.iter().any(|lens| match &lens.bend {
            ImageBend::Sampled(_) => false,
            ImageBend::Round(..) => true,
            ImageBend::Own(own) => own.extent.turn.is_some(),
        })
    }

    /// The numbers of the ray handlers of users among them, ascending, each once, and 0 behind these.
    pub fn own_handlers(&self) -> [u16; MOST_RAY_LENSES] {
        let of = |lens: &ImageLens| match &lens.bend {
            ImageBend::Own(own) => Some(own.handler as u16),
            _ => None,
        };
        let all: BTreeSet<u16> = self.images.iter().filter_map(of).collect();
        let mut found = [0; MOST_RAY_LENSES];
        found.iter_mut().zip(all).for_each(|(slot, handler)| *slot = handler);
        found
    }

    /// The numbers of the lenses, ascending.
    pub fn lenses(&self) -> Vec<u32> {
        let images = self.images.iter().map(|lens| lens.lens);
        let mut all: Vec<u32> = images.chain(self.planes.iter().map(|lens| lens.lens)).collect();
        all.sort_unstable();
        all
    }

    /// The rims of all lenses.
    pub fn rims(&self) -> impl Iterator<Item = &Rim> {
        self.images.iter().map(|lens| &lens.rim).chain(self.planes.iter().map(|lens| &lens.rim))
    }

    /// The rims of all lenses with the lenses' numbers, to be changed.
    pub fn rims_mut(&mut self) -> impl Iterator<Item = (u32, &mut Rim)> {
        let images = self.images.iter_mut().map(|lens| (lens.lens, &mut lens.rim));
        images.chain(self.planes.iter_mut().map(|lens| (lens.lens, &mut lens.rim)))
    }

    /// Those of the lenses that act on an object, by which it is seen; `None`: on what is no object.
    pub fn acting_on(&self, object: Option<u32>) -> Cow<'_, Self> {
        if self.rims().all(|rim| rim.only.is_none()) {
            return Cow::Borrowed(self);
        }
        let acts = |rim: &Rim| match &rim.only {
            None => true,
            Some(only) => object.is_some_and(|object| only.objects.get(object as usize) == Some(&true)),
        };
        let mut own = self.clone();
        own.images.retain(|lens| acts(&lens.rim));
        own.planes.retain(|lens| acts(&lens.rim));
        Cow::Owned(own)
    }

    /// The shapes, camera coordinates, whose union holds what a lens shows so many times as large as without it, or larger; none: nothing, or it has no
    /// such outline. They are where it stands in the city, up to [`FAR_M`], so that the sun finds it there, too: of a magnifier what its rays sweep
    /// while they are bent, and what they sweep as they go on; discs are polygons around them, by less than 1/700 of the radius too wide. Of
    /// lenses that look around it is a figure before all that is seen.
    pub fn magnified(&self, lens: u32, by: f64, frame: &PictureFrame) -> Vec<Shape> {
        if let Some(image) = self.images.iter().find(|image| image.lens == lens) {
            let share = image.magnified(by, self.is_parallel);
            let shape = |share: f64| match (&image.bend, self.is_parallel) {
                (ImageBend::Round(..) | ImageBend::Own(_), _) => frame.flat(&image.rim, share, frame.near),
                (ImageBend::Sampled(_), false) => {
                    let far = frame.ring(&image.rim, share, FAR_M);
                    Shape::Convex { points: std::iter::once(DVec3::ZERO).chain(far).collect() }
                }
                (ImageBend::Sampled(_), true) => frame.between(&image.rim, [(frame.near, share), (FAR_M, share)]),
            };
            return share.map(shape).into_iter().collect();
        }
        let plane = self.planes.iter().find(|plane| plane.lens == lens);
        let of = |plane: &PlaneLens| {
            let share = plane.magnified(by, self.is_parallel)?;
            let begins = plane.distance_of(by, self.is_parallel)?;
            let at = |d: f64| (d, share * (1.0 - plane.taken(d, self.is_parallel) * (1.0 - plane.found_back(share))));
            let mut all = vec![frame.between(&plane.rim, [plane.until, FAR_M.max(2.0 * plane.until)].map(at))];
            if plane.until - begins > 1e-6 * plane.until {
                all.push(frame.between(&plane.rim, [begins, plane.until].map(at)));
            }
            Some(all)
        };
        plane.and_then(of).unwrap_or_default()
    }

    /// Whether the ray of a place of the picture may be bent.
    pub fn bends(&self, across: DVec2) -> bool {
        self.rims().any(|rim| rim.share(across) < 1.0)
    }

    /// How many times as far from each other as without these lenses the rays of two places that lie close together are at most, wherever they
    /// are looked at; `None`: as far as can be.
    pub fn stretch(&self) -> Option<f64> {
        let of_image = |lens: &ImageLens| match &lens.bend {
            ImageBend::Sampled(radius) => {
                let at = |[place, shown, slope]: &[f64; 3]| slope.max(if *place > 0.0 { shown / place } else { 0.0 });
                // Between knots it may be a little more.
                Some(1.1 * radius.knots.iter().map(at).fold(1.0, f64::max))
            }
            ImageBend::Round(..) | ImageBend::Own(_) => None,
        };
        // By the most that a plane takes from what is seen: where the ray goes on.
        let of_plane = |lens: &PlaneLens| {
            let taken = lens.taken(lens.until, self.is_parallel);
            // A field's share grows by 1 over the band, not over the radius.
            (lens.rim.field.is_none() && lens.border > 0.0).then(|| 1.0 + taken.abs() / lens.border + taken.abs())
        };
        let all = self.images.iter().map(of_image).chain(self.planes.iter().map(of_plane));
        all.reduce(|a, b| Some(a? * b?)).unwrap_or(Some(1.0))
    }
}

impl RayPaths {
    /// By lens, where there are any, the thousandths of what it changes in which rays cross, so that things are seen more than once there (Wang et al. §3.2,
    /// whose condition is that of a Jacobian above 0: nothing is folded iff `a(a + τ(P−F)·∇k) > 0`, `a = 1 − τ(1−k)`, τ what the core takes). Deepest down it is
    /// the most.
    pub fn folds(&self) -> BTreeMap<u32, u32> {
        let of = |lens: &PlaneLens| {
            let share = lens.folded(self.is_parallel);
            (share > 0.0).then(|| (lens.lens, (1000.0 * share).round().max(1.0) as u32))
        };
        self.planes.iter().filter_map(of).collect()
    }
}

/// What lenses that bend rays ask of a city.
pub struct Scenery<'a> {
    /// D of what is seen at a place of the picture without them, metres; `None`: nothing.
    pub shown: &'a dyn Fn(DVec2) -> Option<f64>,
    /// That of an image, which is known.
    pub mask: &'a dyn Fn(&Path) -> Option<Arc<ShareField>>,
    /// The triangles of a choice, view space.
    pub feature: &'a dyn Fn(&Choice) -> Vec<[DVec3; 3]>,
}

impl ImageLens {
    /// The share of its radius in the picture, as that is without it, of what it shows so many times as large as without it, or larger.
    fn magnified(&self, by: f64, is_parallel: bool) -> Option<f64> {
        let whole = |magnifies: f64| (magnifies >= by).then_some(1.0);
        match &self.bend {
            ImageBend::Sampled(radius) => within(by, |r| {
                let [a, b] = [r, r + SHARE_STEP].map(|r| radius.at(r.min(1.0)));
                [(b - a) / SHARE_STEP, radius.at(r.max(1e-6)) / r.max(1e-6)]
            })
            .map(|share| radius.at(share)),
            // In its middle; parallel rays have no angles.
            ImageBend::Round(..) if is_parallel => whole(1.0),
            ImageBend::Round(angle, FisheyeProjection::Angular) => whole(self.rim.radius / (0.5 * angle)),
            ImageBend::Round(angle, FisheyeProjection::Hemispherical) => whole(self.rim.radius / (0.5 * angle).sin()),
            ImageBend::Own(own) => whole(own.extent.magnifies),
        }
    }
}

/// Steps of a radius in which it is looked for where a lens magnifies.
const SHARE_STEP: f64 = 1.0 / 4096.0;

/// The share of a radius within which things are so many times as large, or larger: `shown` are what a step along the radius shows of one, and what
/// one across it does.
fn within(by: f64, shown: impl Fn(f64) -> [f64; 2]) -> Option<f64> {
    let is_so = |i: &u32| {
        let [along, across] = shown(f64::from(*i) * SHARE_STEP);
        along.abs().max(across.abs()) * by <= 1.0 + 1e-9
    };
    let steps = (0..(1.0 / SHARE_STEP) as u32).take_while(is_so).count();
    (steps > 0).then_some(steps as f64 * SHARE_STEP)
}

impl PlaneLens {
    /// The share of its radius within which it shows things so many times as large as without it, or larger, deepest down; `None`: nowhere, or its
    /// outline has no radius.
    fn magnified(&self, by: f64, is_parallel: bool) -> Option<f64> {
        let taken = self.taken(self.until, is_parallel);
        let k = |r: f64| self.found_back(r);
        // W5: ρ' and ρ / r.
        let shown = |r: f64| {
            let across = 1.0 - taken * (1.0 - k(r));
            let grows = if k(r) > 0.0 { taken * r / self.border } else { 0.0 };
            [across + grows, across]
        };
        if self.rim.field.is_some() { None } else { within(by, shown) }
    }

    /// How far the ray of this share of the radius has found back to where it would go: 0 in the core, 1 at the rim.
    pub(super) fn found_back(&self, share: f64) -> f64 {
        if self.border > 0.0 { ((share - (1.0 - self.border)) / self.border).max(0.0) } else { 0.0 }
    }

    /// D from which on its core shows things so many times as large as without it, or larger.
    fn distance_of(&self, by: f64, is_parallel: bool) -> Option<f64> {
        let e = if is_parallel { 0.0 } else { self.distance.recip() };
        let taken = 1.0 - by.recip();
        // By how it grows with depth; of one that makes smaller it is largest at its plane.
        let z = if taken <= 0.0 || self.power <= 0.0 { 0.0 } else { taken / (self.power - taken * e) };
        (z >= 0.0 && self.distance + z <= self.until * (1.0 + 1e-9)).then(|| (self.distance + z).min(self.until))
    }

    /// A magnifier; `None`: it changes nothing. `middle`: D of what it is about, metres.
    fn new(lens: u32, rim: &Rim, magnify: &Magnify, frame: &PictureFrame, middle: impl Fn() -> f64) -> Option<Self> {
        let middle = || middle().max(frame.near);
        let (distance, depth) = match (magnify.distance, magnify.at) {
            (Some(distance), Some(at)) => (distance, at),
            (Some(distance), None) => (distance, (middle() - distance).max(0.5 * distance)),
            (None, Some(at)) => ((middle() - at).max(0.5 * at), at),
            (None, None) => (0.5 * middle(), 0.5 * middle()),
        };
        let e = if frame.is_parallel { 0.0 } else { distance.recip() };
        let power = (1.0 - magnify.magnification.recip()) * (1.0 + depth * e) / depth;
        let (border, until, rim) = (magnify.border, distance + depth, rim.clone());
        (power != 0.0).then_some(Self { lens, rim, border, distance, until, power })
    }

    /// The part that its core takes from what is seen at D.
    fn taken(&self, d: f64, is_parallel: bool) -> f64 {
        let e = if is_parallel { 0.0 } else { self.distance.recip() };
        let z = d.min(self.until) - self.distance;
        z * self.power / (1.0 + z * e)
    }

    /// How many times as large its core shows things in the end, > 0.
    pub fn magnifies(&self, is_parallel: bool) -> f64 {
        (1.0 - self.taken(self.until, is_parallel)).recip()
    }

    /// The part of what it changes in which the rays that it bends cross.
    fn folded(&self, is_parallel: bool) -> f64 {
        let taken = self.taken(self.until, is_parallel);
        let Some(field) = &self.rim.field else {
            // a + τ(P−F)·∇k = 1 + τ(2s − 1)/b at a share s in the band.
            let from = (0.5 * (1.0 - self.border / taken)).max(1.0 - self.border);
            return if taken < 0.0 && self.border > 0.0 { 1.0 - from.min(1.0).powi(2) } else { 0.0 };
        };
        let (mut changed, mut folded) = (0_u32, 0_u32);
        let side = share_field::SIDE;
        let at = |x: usize, y: usize| f64::from(field.texels[y * side + x]);
        for (x, y) in (1..side - 1).flat_map(|y| (1..side - 1).map(move |x| (x, y))) {
            if at(x, y) >= 1.0 {
                continue;
            }
            changed += 1;
            let in_band = (at(x, y) - (1.0 - self.border)) / self.border;
            if self.border == 0.0 || in_band <= 0.0 {
                continue;
            }
            let k = in_band;
            // By texels, as the place is.
            let slope = 0.5 / self.border * DVec2::new(at(x + 1, y) - at(x - 1, y), at(x, y + 1) - at(x, y - 1));
            let from = DVec2::new(x as f64, y as f64) + 0.5 - 0.5 * side as f64;
            let a = 1.0 - taken * (1.0 - k);
            folded += u32::from(a * (a + taken * from.dot(slope)) <= 0.0);
        }
        f64::from(folded) / f64::from(changed.max(1))
    }

    /// Where its core shows a place of view space behind its plane, in the picture's plane.
    fn shown_by_core(&self, p: DVec3, is_parallel: bool) -> DVec2 {
        let seen = p.truncate() / if is_parallel { 1.0 } else { -p.z };
        self.rim.center + (seen - self.rim.center) / (1.0 - self.taken(-p.z, is_parallel))
    }
}

/// A lens whose core is where rays to its focal point meet a feature, and whose band goes around that; `None`: the feature is not behind its plane.
fn of_feature(number: u32, rim: &Rim, feature: &Feature, frame: &PictureFrame, scenery: &Scenery) -> Option<PlaneLens> {
    let triangles = (scenery.feature)(&feature.of);
    let is_parallel = frame.is_parallel;
    let seen = |p: &DVec3| p.truncate() / if is_parallel { 1.0 } else { -p.z };
    let corners = || triangles.iter().flatten().filter(|p| -p.z > frame.near);
    let bounds = |all: &mut dyn Iterator<Item = DVec2>| {
        all.fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)))
    };
    let (low, high) = bounds(&mut corners().map(seen));
    let depths = corners().map(|p| -p.z).fold((f64::INFINITY, 0.0_f64), |(low, high), d| (low.min(d), high.max(d)));
    if !(low.is_finite() && high.is_finite()) {
        return None;
    }
    // The focal point lies on the line of sight through its middle.
    let band = rim.radius;
    let rim = Rim { center: 0.5 * (low + high), ..rim.clone() };
    let magnify = Magnify { border: 1.0, ..feature.magnify };
    let mut lens = PlaneLens::new(number, &rim, &magnify, frame, || 0.5 * (depths.0 + depths.1))?;
    let ranges = [[lens.distance.max(frame.near), lens.until], [lens.until, f64::INFINITY]];
    let parts: Vec<Vec<DVec2>> = triangles
        .iter()
        .flat_map(|triangle| ranges.map(|range| share_field::between(*triangle, range)))
        .filter(|part| !part.is_empty())
        .map(|part| part.into_iter().map(|p| lens.shown_by_core(p, is_parallel)).collect())
        .collect();
    let (low, high) = bounds(&mut parts.iter().flatten().copied());
    let reach = (low - rim.center).abs().max((high - rim.center).abs()).max_element() + band;
    if !reach.is_finite() {
        return None;
    }
    let mut core = vec![false; share_field::SIDE * share_field::SIDE];
    for part in &parts {
        let placed: Vec<DVec2> = part.iter().map(|p| (*p - rim.center) / reach).collect();
        share_field::mark(&mut core, &placed);
    }
    let field = Some(Arc::new(ShareField::of_core(&core, band / reach)));
    lens.rim = Rim { radius: reach, field, outline: RayOutline::Square, ..rim };
    Some(lens)
}

/// D of what is seen where nothing is, metres.
const DISTANCE_M: f64 = 100.0;

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::{
        geom::shape::{Motion, Sightlines},
        lens::ray::{Fisheye, Sampling, SamplingRate},
    };

    fn frame(is_parallel: bool) -> PictureFrame {
        PictureFrame {
            half: if is_parallel { DVec2::new(80.0, 50.0) } else { DVec2::new(0.8, 0.5) },
            is_parallel,
            near: 0.5,
        }
    }

    fn magnifier(magnification: f64, at: f64, distance: f64, border: f64) -> RayLens {
        let magnify = Magnify { magnification, at: Some(at), distance: Some(distance), border };
        RayLens { bend: Bend::Magnify(magnify), ..RayLens::magnifier() }
    }

    fn paths(lenses: &[RayLens], is_parallel: bool) -> RayPaths {
        let numbered: Vec<_> = (0..).zip(lenses).map(|(number, lens)| (number, lens, [0.0; 3])).collect();
        RayPaths::new(
            &numbered,
            &frame(is_parallel),
            &Scenery { shown: &|_| None, mask: &|_| None, feature: &|_| Vec::new() },
        )
    }

    /// Where the path of a place is at a distance, as the picture without lenses has it.
    fn seen(paths: &RayPaths, across: DVec2, d: f64) -> DVec2 {
        let place = paths.line(across, d).at(d).truncate();
        if paths.is_parallel { place } else { place / d }
    }

    proptest! {
        #![proptest_config(crate::seeds::config())]

        /// At every depth the core magnifies by the formula: 1/(1−z/f) with parallel rays, (1+z/z_L)/(1−z/f) in perspective; what is beyond the place
        /// where it is reached is magnified as much.
        #[test]
        fn a_core_magnifies_by_the_formula(
            is_parallel in any::<bool>(),
            magnification in 0.3..12.0_f64,
            at in 1.0..400.0_f64,
            distance in 1.0..400.0_f64,
            z in 0.0..2.0_f64,
            angle in 0.0..6.3_f64,
        ) {
            let lens = magnifier(magnification, at, distance, 0.4);
            let paths = paths(std::slice::from_ref(&lens), is_parallel);
            let rim = frame(is_parallel).rim(&lens);
            let at_rim = 0.5 * rim.radius;
            let across = rim.center + at_rim * DVec2::from_angle(angle);
            let e = if is_parallel { 0.0 } else { 1.0 / distance };
            let inverse_f = (1.0 - (1.0 + at * e) / magnification) / at;
            let depth = (z * at).min(at);
            let expected = (1.0 + depth * e) / (1.0 - depth * inverse_f);
            let from = seen(&paths, across, distance + z * at) - rim.center;
            prop_assert!((at_rim / from.length() / expected - 1.0).abs() < 1e-9, "{} is not {expected}", at_rim / from.length());
            // Before the plane nothing changes.
            prop_assert!((seen(&paths, across, 0.9 * distance) - across).length() < 1e-12);
        }

        /// Nothing is lost and nothing inverts: at every depth, what is farther from the middle is seen farther from it, and at the rim all is as
        /// without the lens.
        #[test]
        fn magnifiers_compress_and_lose_nothing(
            is_parallel in any::<bool>(),
            magnification in 1.0..20.0_f64,
            at in 1.0..400.0_f64,
            distance in 1.0..400.0_f64,
            border in 0.02..1.0_f64,
            z in 0.0..4.0_f64,
        ) {
            let lens = magnifier(magnification, at, distance, border);
            let paths = paths(std::slice::from_ref(&lens), is_parallel);
            let rim = frame(is_parallel).rim(&lens);
            let place = |share: f64| rim.center + DVec2::new(share * rim.radius, 0.0);
            let shown = |share: f64| (seen(&paths, place(share), distance + z * at) - rim.center).x;
            let mut before = shown(0.0);
            prop_assert!(before.abs() < 1e-12);
            for i in 1..=400 {
                let now = shown(f64::from(i) / 400.0);
                prop_assert!(now > before);
                before = now;
            }
            prop_assert!((before - rim.radius).abs() < 1e-9 * rim.radius);
        }

        /// A lens that makes things smaller by as much undoes one that makes them larger, at every depth.
        #[test]
        fn opposite_lenses_undo_each_other(
            is_parallel in any::<bool>(),
            magnification in 1.0..1.9_f64,
            at in 1.0..400.0_f64,
            distance in 1.0..400.0_f64,
            share in 0.0..1.1_f64,
            z in 0.0..4.0_f64,
        ) {
            // Powers are 1 − 1/m times the same number.
            let opposite = 1.0 / (2.0 - magnification.recip());
            let lenses = [magnifier(magnification, at, distance, 0.4), magnifier(opposite, at, distance, 0.4)];
            let paths = paths(&lenses, is_parallel);
            let rim = frame(is_parallel).rim(&lenses[0]);
            let across = rim.center + DVec2::new(0.6, 0.8) * share * rim.radius;
            let off = seen(&paths, across, distance + z * at).distance(across);
            prop_assert!(off < 1e-12 * rim.radius.max(1.0), "{off}");
        }

        /// Paths are of one piece each from end to end.
        #[test]
        fn pieces_meet(
            is_parallel in any::<bool>(),
            lenses in prop::collection::vec((0.3..8.0_f64, 1.0..200.0_f64, 1.0..200.0_f64, 0.0..1.0_f64, 0.1..0.9_f64), 1..5),
            x in -1.0..1.0_f64,
            y in -1.0..1.0_f64,
        ) {
            let lenses: Vec<RayLens> = lenses
                .into_iter()
                .map(|(m, at, distance, border, center)| RayLens { center: DVec2::splat(center), ..magnifier(m, at, distance, border) })
                .collect();
            let paths = paths(&lenses, is_parallel);
            let pieces = paths.pieces(DVec2::new(x, y) * frame(is_parallel).half);
            prop_assert_eq!(pieces.len(), 2 * lenses.iter().filter(|l| *l != &RayLens::magnifier()).count() + 1);
            for pair in pieces.windows(2) {
                let end = pair[0].range[1];
                prop_assert_eq!(end, pair[1].range[0]);
                let [a, b] = [pair[0], pair[1]].map(|piece| piece.line.at(end));
                prop_assert!(a.distance(b) < 1e-9 * a.length().max(1.0), "{} and {}", a, b);
            }
        }
    }

    #[test]
    fn neighbours_are_no_farther_apart_than_the_stretch_says() {
        for (is_parallel, magnification, border) in
            [(false, 3.0, 0.4), (true, 3.0, 0.1), (false, 0.6, 0.7), (false, 12.0, 1.0)]
        {
            let lens = magnifier(magnification, 60.0, 40.0, border);
            let paths = paths(std::slice::from_ref(&lens), is_parallel);
            let (stretch, rim) = (paths.stretch().unwrap(), frame(is_parallel).rim(&lens));
            let mut most: f64 = 0.0;
            for i in 0..2000 {
                let place = |i: u32| rim.center + DVec2::new(f64::from(i) / 2000.0 * 1.05 * rim.radius, 0.0);
                for d in [30.0, 60.0, 90.0, 100.0, 400.0] {
                    let apart = seen(&paths, place(i), d).distance(seen(&paths, place(i + 1), d));
                    most = most.max(apart / place(i).distance(place(i + 1)));
                }
            }
            assert!(most <= stretch && stretch < 2.5 * most, "{most} of {stretch}");
        }
    }

    #[test]
    fn a_lens_that_magnifies_by_one_is_none() {
        assert!(paths(&[magnifier(1.0, 30.0, 20.0, 0.4)], false).is_empty());
        assert!(!paths(&[magnifier(1.1, 30.0, 20.0, 0.4)], false).is_empty());
    }

    /// Where things are larger by what a lens is asked for, told from where neighbouring rays go.
    #[test]
    fn what_is_magnified_is_seen_through_its_figure() {
        for is_parallel in [false, true] {
            for (magnification, border, by) in
                [(3.0, 0.4, 2.0), (3.0, 0.4, 2.99), (3.0, 0.0, 1.2), (2.0, 1.0, 1.3), (0.6, 0.8, 0.5), (5.0, 0.5, 0.9)]
            {
                let paths = paths(&[magnifier(magnification, 60.0, 40.0, border)], is_parallel);
                let shapes = paths.magnified(0, by, &frame(is_parallel));
                let plane = &paths.planes[0];
                let larger = |share: f64, d: f64| {
                    let place = |share: f64| plane.rim.center + DVec2::X * (share * plane.rim.radius);
                    let [a, b] = [share - 1e-6, share + 1e-6].map(|s| seen(&paths, place(s), d));
                    let along = 2e-6 * plane.rim.radius / (b - a).x.abs();
                    let across = share * plane.rim.radius / (seen(&paths, place(share), d) - plane.rim.center).length();
                    along.min(across)
                };
                let volumes: Vec<_> = shapes
                    .iter()
                    .flat_map(|shape| {
                        let sight =
                            if is_parallel { Sightlines::Along(DVec3::NEG_Z) } else { Sightlines::From(DVec3::ZERO) };
                        shape.placed(&Motion::NONE, &sight).unwrap()
                    })
                    .collect();
                // The part that it is told from, by neighbouring rays.
                let share = (0..4096).map(|i| f64::from(i) / 4096.0).find(|s| larger(s + 1e-4, 2.0 * plane.until) < by);
                let share = share.unwrap_or(1.0);
                // Places along rays, of all shares and depths: they are in the shapes where the core is so large and the share is within.
                for (i, k) in (0..60).flat_map(|i| (0..60).map(move |k| (i, k))) {
                    let (s, d) = (f64::from(i) / 60.0 + 0.003, plane.distance * (0.9 + 0.06 * f64::from(k)));
                    let place = paths
                        .line(plane.rim.center + DVec2::from_angle(f64::from(k)) * (s * plane.rim.radius), d)
                        .at(d);
                    let is_so = s < share && d >= plane.distance_of(by, is_parallel).unwrap();
                    let doubtful =
                        (s - share).abs() < 0.004 || (d - plane.distance_of(by, is_parallel).unwrap()).abs() < 0.01;
                    let is_in = volumes.iter().any(|volume| volume.contains(place));
                    assert!(doubtful || is_in == is_so, "{magnification} {border} {by}: {s}, {d} is in: {is_in}");
                }
                for part in [0.1, 0.5, 0.99] {
                    assert!(
                        larger(part * share, 2.0 * plane.until) >= by * 0.999,
                        "{magnification} {border} {by} at {part}"
                    );
                }
                if share < 0.999 {
                    assert!(larger(share + 0.002, 2.0 * plane.until) < by, "{magnification} {border} {by} beyond");
                }
            }
        }
        let lens = RayLens { bend: Bend::Sample(Sampling { rate: SamplingRate::Cubic(3.0) }), ..RayLens::sampling() };
        let paths = paths(&[lens], false);
        let shapes = paths.magnified(0, 1.2, &frame(false));
        let sight = Sightlines::From(DVec3::ZERO);
        let volumes = shapes[0].placed(&Motion::NONE, &sight).unwrap();
        let ImageBend::Sampled(sampled) = &paths.images[0].bend else { panic!("it samples") };
        let along = |r: f64| 2e-5 / (sampled.at(r + 1e-5) - sampled.at(r - 1e-5));
        for (i, d) in (1..100).flat_map(|i| [0.7, 30.0, 9000.0].map(|d| (i, d))) {
            let share = f64::from(i) / 100.0;
            let at = paths.line(paths.images[0].rim.center + DVec2::Y * (share * paths.images[0].rim.radius), d).at(d);
            let is_in = volumes[0].contains(at);
            assert!((along(share) - 1.2).abs() < 0.03 || is_in == (along(share) > 1.2), "{share} at {d}: {is_in}");
        }
        assert!(paths.magnified(0, 9.0, &frame(false)).is_empty());
    }

    #[test]
    fn what_nobody_says_is_told_from_what_is_in_the_middle() {
        let plane = |at, distance| {
            let bend = Bend::Magnify(Magnify { magnification: 2.0, at, distance, border: 0.4 });
            let lens = RayLens { bend, ..RayLens::magnifier() };
            let paths = RayPaths::new(
                &[(3, &lens, [0.0; 3])],
                &frame(false),
                &Scenery { shown: &|_| Some(100.0), mask: &|_| None, feature: &|_| Vec::new() },
            );
            (paths.planes[0].lens, paths.planes[0].distance, paths.planes[0].until)
        };
        assert_eq!(plane(None, None), (3, 50.0, 100.0));
        assert_eq!(plane(None, Some(80.0)), (3, 80.0, 100.0 + 20.0));
        assert_eq!(plane(Some(30.0), None), (3, 70.0, 100.0));
        assert_eq!(plane(Some(300.0), None), (3, 150.0, 450.0), "never behind the eye");
    }

    #[test]
    fn a_sampling_lens_is_as_large_as_its_rate() {
        let rate = SamplingRate::Cubic(3.0);
        let lens = RayLens { bend: Bend::Sample(Sampling { rate: rate.clone() }), ..RayLens::sampling() };
        let whole = (0..1000).map(|i| rate.at((f64::from(i) + 0.5) / 1000.0).recip()).sum::<f64>() / 1000.0;
        for is_parallel in [false, true] {
            let paths = paths(std::slice::from_ref(&lens), is_parallel);
            let rim = frame(is_parallel).rim(&lens);
            for share in [0.01, 0.3, 0.7, 0.95] {
                let at = |share: f64| seen(&paths, rim.center + DVec2::new(0.0, share * rim.radius), 40.0).y;
                let magnification = 2e-4 * rim.radius / (at(share + 1e-4) - at(share - 1e-4));
                // A cubic between knots: its slope is right to their distance.
                let expected = rate.at(share) * whole;
                assert!((magnification / expected - 1.0).abs() < 1e-4, "{magnification} is not {expected}");
            }
        }
    }

    #[test]
    fn fisheyes_are_straight_in_the_middle_and_see_to_their_angle() {
        for (projection, angle) in [
            (FisheyeProjection::Angular, 3.0),
            (FisheyeProjection::Angular, std::f64::consts::TAU),
            (FisheyeProjection::Hemispherical, std::f64::consts::PI),
        ] {
            let lens = RayLens { bend: Bend::Fisheye(Fisheye { angle, projection }), ..RayLens::fisheye() };
            let paths = paths(std::slice::from_ref(&lens), false);
            let direction = |share: f64, turn: f64| paths.line(0.5 * share * DVec2::from_angle(turn), 1.0).direction;
            assert_eq!(direction(0.0, 0.0), DVec3::NEG_Z);
            // Beside the middle as the limit says.
            let slope = if projection == FisheyeProjection::Angular { 0.5 * angle } else { (0.5 * angle).sin() };
            assert!((direction(1e-6, 0.0).x / 1e-6 - slope).abs() < 1e-6);
            for turn in [0.0, 1.0, 2.5] {
                let rim = direction(1.0 - 1e-12, turn);
                assert!((rim.z + (0.5 * angle).cos()).abs() < 1e-5, "{rim}");
                // A line through the middle stays one.
                let half = direction(0.5, turn);
                assert!(half.truncate().perp_dot(DVec2::from_angle(turn)).abs() < 1e-12);
            }
        }
    }

    /// A letter C of boxes' fronts, view space, and its convex hull's.
    fn letter(is_open: bool) -> Vec<[DVec3; 3]> {
        let rectangle = |low: DVec2, high: DVec2| {
            let corner = |x, y| DVec3::new(x, y, -100.0);
            let [a, b] = [corner(low.x, low.y), corner(high.x, low.y)];
            let [c, d] = [corner(high.x, high.y), corner(low.x, high.y)];
            [[a, b, c], [a, c, d]]
        };
        let parts = match is_open {
            true => vec![([-12.0, -12.0], [-6.0, 12.0]), ([-6.0, 6.0], [14.0, 12.0]), ([-6.0, -12.0], [14.0, -6.0])],
            false => vec![([-12.0, -12.0], [14.0, 12.0])],
        };
        parts.into_iter().flat_map(|(low, high)| rectangle(low.into(), high.into())).collect()
    }

    /// The part of what a lens changes whose cells, of a grid, are shown turned round: by what becomes of their corners.
    fn turned_round(paths: &RayPaths) -> f64 {
        let lens = &paths.planes[0];
        let (rim, steps) = (&lens.rim, 300);
        let place =
            |x: i32, y: i32| rim.center + rim.radius * (2.0 * DVec2::new(x.into(), y.into()) / f64::from(steps) - 1.0);
        let shown = |at: DVec2| seen(paths, at, 2.0 * lens.until);
        let (mut changed, mut turned) = (0, 0);
        for (x, y) in (0..steps).flat_map(|y| (0..steps).map(move |x| (x, y))) {
            if rim.share(place(x, y)) >= 1.0 {
                continue;
            }
            changed += 1;
            let [a, b, c] = [(x, y), (x + 1, y), (x, y + 1)].map(|(x, y)| shown(place(x, y)));
            turned += i32::from((b - a).perp_dot(c - a) <= 0.0);
        }
        f64::from(turned) / f64::from(changed)
    }

    #[test]
    fn crossing_rays_are_told_where_there_are_some() {
        for is_parallel in [false, true] {
            let plain = |magnification, border, outline| {
                let bend = Magnify { magnification, at: Some(60.0), distance: Some(40.0), border };
                let lens = RayLens { bend: Bend::Magnify(bend), outline, ..RayLens::magnifier() };
                paths(&[lens], is_parallel)
            };
            for outline in [RayOutline::Circle, RayOutline::Square] {
                // With 1 / 0.8 - 1 = 0.25 of the radius nothing crosses.
                for (magnification, border) in
                    [(3.0, 0.05), (0.8, 0.26), (0.8, 0.24), (0.8, 0.1), (0.4, 1.0), (0.3, 0.6)]
                {
                    let paths = plain(magnification, border, outline);
                    let (found, expected) = (paths.planes[0].folded(is_parallel), turned_round(&paths));
                    // Cells of 1/300 along the border of what crosses.
                    assert!((found - expected).abs() < 0.02, "{magnification}, {border}: {found}, {expected}");
                    assert_eq!(found > 0.0, magnification < 1.0 && border < 1.0 / magnification - 1.0);
                }
            }
            for (is_open, magnification, radius) in
                [(false, 3.0, 0.05), (true, 1.2, 0.3), (true, 3.0, 0.08), (true, 2.5, 0.05)]
            {
                let magnify = Magnify { magnification, at: Some(60.0), distance: Some(40.0), border: 1.0 };
                let bend = Bend::Feature(Feature { magnify, of: Choice::default() });
                let lens = RayLens { bend, radius, ..RayLens::feature() };
                let feature = |_: &Choice| letter(is_open);
                let scenery = Scenery { shown: &|_| None, mask: &|_| None, feature: &feature };
                let paths = RayPaths::new(&[(5, &lens, [0.0; 3])], &frame(is_parallel), &scenery);
                let expected = turned_round(&paths);
                let found = paths.folds().get(&5).map_or(0.0, |share| f64::from(*share) / 1000.0);
                assert!((found - expected).abs() < 0.03, "{is_open} {magnification}, {radius}: {found}, {expected}");
                assert_eq!(found > 0.0, is_open && magnification > 2.0, "{is_open} {magnification}: {found}");
            }
        }
    }

    #[test]
    fn lenses_act_on_what_they_chose() {
        let mut paths = paths(&[magnifier(2.0, 50.0, 50.0, 0.4), magnifier(3.0, 50.0, 50.0, 0.4)], false);
        assert!(matches!(paths.acting_on(None), Cow::Borrowed(_)));
        paths.planes[1].rim.only = Some(Chosen { objects: [false, true].into(), first: 7 });
        let acting = |object| paths.acting_on(object).lenses();
        assert_eq!([None, Some(0), Some(1), Some(2)].map(acting), [vec![0], vec![0], vec![0, 1], vec![0]]);
    }
}
