//! The lens: shapes, effects and all else that is said of it.

use crate::{
    geom::Shape,
    lens::{
        best_view::BestView, body::LensBody, border::Border, class::Class, content::Content, deform::Deform,
        effect_use::EffectUse, handled::Handled, kind::LensKind, occluders::Occluders, placement::Placement,
        ray::RayLens, region::Region, rendering::Rendering, sprite::LensSprite,
    },
};

/// A lens.
#[derive(Clone, Debug, PartialEq)]
pub struct Lens {
    /// Its name, unique.
    pub name: String,
    /// What kind of lens it is, with what is its kind's own.
    pub kind: LensKind,
    /// `false`: keeps its place and its mask bit, acts on nothing.
    pub enabled: bool,
    /// Its own colour, sRGB 0..1: outline, legend, halo.
    pub color: [f32; 3],
    /// What its shapes are fixed to.
    pub placement: Placement,
    /// Its focus areas: inside where any of them is.
    pub shapes: Vec<Region>,
    /// What it does, in order (at most one scene style), after what it is drawn by.
    pub effects: Vec<EffectUse>,
    /// Which moment shows in it, of the one that shows below it: operators, one after the other; none: the same. Of a lens with an
    /// overlay, which moment that shows.
    pub time: Vec<Handled>,
    /// How the lens body itself is drawn.
    pub body: LensBody,
    /// The volumetric depth sprite that it is tested by; `None`: from its shapes.
    pub sprite: Option<LensSprite>,
    /// How it ends; `None`: at once.
    pub border: Option<Border>,
    /// Whether what it takes away, sees through or replaces still casts the shadow that it has without the lens.
    pub keeps_shadows: bool,
    /// Whether its focus area is of the city at rest and goes with what deformations move, or stands where it is.
    pub at_rest: bool,
    /// The colour, sRGB 0..1, of the sections through closed shells where it ends; `None`: what is cut is hollow.
    pub section: Option<[f32; 3]>,
}

impl Lens {
    /// A lens without shapes and without effects, its body as lenses of its kind have it.
    pub fn plain(name: impl Into<String>, kind: impl Into<LensKind>, color: [f32; 3]) -> Self {
        let kind = kind.into();
        let body = kind.row().body;
        Self {
            name: name.into(),
            kind,
            enabled: true,
            color,
            placement: Placement::World,
            shapes: Vec::new(),
            effects: Vec::new(),
            time: Vec::new(),
            body,
            sprite: None,
            border: None,
            keeps_shadows: false,
            at_rest: false,
            section: None,
        }
    }

    /// Its border, if it has a width.
    pub fn soft_border(&self) -> Option<Border> {
        self.border.filter(|b| b.width > 0.0)
    }

    /// Whether it is fixed to the camera: it acts in its view alone.
    pub fn is_of_camera(&self) -> bool {
        self.placement == Placement::Camera || self.ray().is_some()
    }

    /// Whether some of its shapes are depth sprites of files.
    pub fn has_sprite_file(&self) -> bool {
        self.shapes.iter().any(|s| s.any(&|f| matches!(f, Region::Sprite { .. })))
    }

    /// How its body is drawn: lenses by object have no surface, and a flat one has no silhouette that a ray comes close to; they
    /// show a line instead.
    pub fn drawn_body(&self) -> LensBody {
        let is_in = |is_one: &dyn Fn(&Region) -> bool| self.shapes.iter().any(|s| s.any(is_one));
        let is_by_object = || is_in(&Region::is_by_object);
        let is_flat = || is_in(&|f| matches!(f, Region::Shape(Shape::Flat { .. }) | Region::Magnified { .. }));
        match self.body {
            LensBody::Shell if is_by_object() => LensBody::Outline,
            LensBody::Halo if self.sprite.is_some() || is_by_object() || is_flat() || self.has_sprite_file() => {
                LensBody::Outline
            }
            body => body,
        }
    }
}

impl Lens {
    /// See [`LensKind::content`].
    pub fn content(&self) -> Option<&Content> {
        self.kind.content()
    }

    /// See [`LensKind::rendering`].
    pub fn rendering(&self) -> Option<&Rendering> {
        self.kind.rendering()
    }

    /// See [`LensKind::deform`].
    pub fn deform(&self) -> Option<&Deform> {
        self.kind.deform()
    }

    /// See [`LensKind::ray`].
    pub fn ray(&self) -> Option<&RayLens> {
        self.kind.ray()
    }

    /// See [`LensKind::best_view`].
    pub fn best_view(&self) -> Option<&BestView> {
        self.kind.best_view()
    }

    /// Has it draw nothing of its own where occluders are.
    pub fn clear_rendering(&mut self) {
        if let Some(rendering) = self.kind.rendering_mut() {
            *rendering = Rendering::of_cases(Vec::new());
        }
    }

    /// The classes it acts on, of what it does and shows.
    pub fn classes(&self) -> impl Iterator<Item = Class> {
        self.uses().map(|e| e.class).chain(self.shown().map(|c| c.class))
    }

    /// What it shows in itself: its own content, or what it shows occluders as; of several cases the first that shows something.
    pub fn shown(&self) -> Option<&Content> {
        let cases = || self.rendering().into_iter().flat_map(|render| &render.cases);
        self.content().or_else(|| cases().find_map(|case| case.content.as_ref()))
    }

    /// What it does, in order: how it draws occluders, then its effects.
    pub fn uses(&self) -> impl Iterator<Item = &EffectUse> {
        let cases = self.rendering().into_iter().flat_map(|render| &render.cases);
        cases.flat_map(|case| &case.effects).chain(&self.effects)
    }

    /// The query for occluders, if it is an occlusion lens.
    pub fn occluders(&self) -> Option<&Occluders> {
        let of_deform = || self.deform().and_then(Deform::occluders);
        self.shapes.first().and_then(Region::occluders).or_else(of_deform)
    }
}
