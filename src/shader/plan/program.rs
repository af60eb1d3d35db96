//! A plan on one of the back ends, and which libraries it calls.

use crate::shader::{
    forms::Forms,
    plan::{Bends, Plan, form::Form, lens::BodyKind, lens_test::LensTest, regions::Regions, uber::Uber},
};

/// A plan on one of the back ends. Both make the same picture.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Program {
    /// The plan, written out.
    Specialised(Plan),
    /// Everything that the scene may ask for, chosen per pixel from a table in a uniform.
    Uber(Uber),
}

impl Program {
    /// The same where no ray is bent.
    pub fn with_straight_rays(mut self) -> Self {
        match &mut self {
            Self::Specialised(plan) => plan.bends = Bends::default(),
            Self::Uber(uber) => uber.bends = Bends::default(),
        }
        self
    }

    /// How it tells regions apart, if it does.
    pub fn regions(&self) -> Option<&Regions> {
        match self {
            Self::Specialised(plan) => plan.regions.as_ref(),
            Self::Uber(_) => None,
        }
    }

    /// Which libraries it calls.
    pub fn has(&self) -> Parts {
        let (tests, has_lenses) = match self {
            Self::Specialised(plan) => (plan.tests().collect(), !plan.lenses.is_empty()),
            Self::Uber(uber) => (uber.tests.clone(), !uber.tests.is_empty()),
        };
        let (bodies, blends, lines, borders) = match self {
            Self::Specialised(plan) => (plan.bodies(), plan.has_blends(), plan.lines, plan.has_borders()),
            Self::Uber(uber) => (uber.bodies.clone(), uber.blends, uber.lines, uber.borders && has_lenses),
        };
        let transparency = match self {
            Self::Specialised(plan) => plan.transparency,
            Self::Uber(uber) => uber.transparency,
        };
        let by_ray = match self {
            Self::Specialised(plan) => plan.borders().any(|border| border.by_ray),
            Self::Uber(uber) => uber.by_ray && borders,
        };
        let contents = match self {
            Self::Specialised(plan) => !plan.contents.is_empty(),
            Self::Uber(uber) => uber.contents,
        };
        let timed = match self {
            Self::Specialised(plan) => plan.timed,
            Self::Uber(uber) => uber.timed,
        };
        let partly = match self {
            Self::Specialised(plan) => plan.partly,
            Self::Uber(uber) => uber.partly,
        };
        let moves = match self {
            Self::Specialised(plan) => plan.moves,
            Self::Uber(uber) => uber.moves,
        };
        let varies = match self {
            Self::Specialised(plan) => plan.varies,
            Self::Uber(uber) => uber.varies,
        };
        let bends = match self {
            Self::Specialised(plan) => plan.bends,
            Self::Uber(uber) => uber.bends,
        };
        let fields = match self {
            Self::Specialised(plan) => plan.fields,
            Self::Uber(uber) => uber.fields,
        };
        let has_body = |kind| bodies.contains(&kind);
        Parts {
            lenses: has_lenses,
            // The uber back end reads there which test it is.
            regions: tests.iter().any(|t| !t.is_sprite()) || (matches!(self, Self::Uber(_)) && has_lenses),
            closed: tests.iter().any(|t| t.spanned().is_some()),
            members: tests.contains(&LensTest::Numbers(Form::Members)),
            fading_members: tests.contains(&LensTest::Numbers(Form::FadingMembers)),
            fading: tests.contains(&LensTest::Numbers(Form::FadingMembers))
                || self.leaves().contains(&Form::FadingMembers),
            sprites: tests.iter().any(|t| t.is_sprite()),
            own_sprites: tests.contains(&LensTest::OwnSprite),
            solids: tests.iter().any(|t| t.has_faces()),
            side_sprites: tests.iter().any(|t| t.has_sides()),
            combinations: tests.iter().any(|t| t.has_leaves()),
            combined_sprites: tests.contains(&LensTest::Sides(Form::Combined)),
            bodies: !bodies.is_empty(),
            outlines: bodies.iter().any(|b| b.has_outline()),
            shells: has_body(BodyKind::Shell),
            halos: has_body(BodyKind::Halo),
            distances: borders || has_body(BodyKind::Shell) || has_body(BodyKind::Halo),
            blends: blends || borders,
            lines,
            transparency,
            contents,
            timed,
            partly,
            moves,
            varies,
            bends,
            fields,
            borders,
            by_ray,
        }
    }

    /// The lens tests and leaves that it calls for.
    pub(in crate::shader) fn forms(&self) -> Forms {
        let mut tests: Vec<LensTest> = match self {
            Self::Specialised(plan) => plan.tests().collect(),
            Self::Uber(uber) => uber.tests.clone(),
        };
        tests.sort_unstable();
        tests.dedup();
        Forms { tests, leaves: self.leaves(), distances: self.has().distances, outlines: self.has().outlines }
    }

    /// Forms of the leaves of its combinations, ascending, each once.
    pub fn leaves(&self) -> Vec<Form> {
        match self {
            Self::Specialised(plan) => {
                let mut all: Vec<Form> = plan.lenses.iter().flat_map(|l| &l.leaves).copied().collect();
                all.sort_unstable();
                all.dedup();
                all
            }
            Self::Uber(uber) => uber.leaves.clone(),
        }
    }

    /// The numbers of all time operators its text has, ascending, each once.
    pub fn epochs(&self) -> Vec<u32> {
        match self {
            Self::Specialised(plan) => {
                let mut all: Vec<u32> = plan.epochs.iter().map(|epoch| epoch.handler).collect();
                all.sort_unstable();
                all.dedup();
                all
            }
            Self::Uber(uber) => uber.epochs.clone(),
        }
    }

    /// The numbers of all handlers its text has, ascending.
    pub fn effects(&self) -> Vec<u32> {
        match self {
            Self::Specialised(plan) => plan.effects(),
            Self::Uber(uber) => uber.effects.clone(),
        }
    }
}

impl Parts {
    /// Whether cities stand elsewhere than the scene's own: contents of lenses, what moves.
    pub fn has_cities(&self) -> bool {
        self.contents || self.moves
    }
}

/// Which libraries a program calls.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Parts {
    /// The classes of lenses.
    pub lenses: bool,
    /// The rows of regions.
    pub regions: bool,
    /// The lens test from closed forms.
    pub closed: bool,
    /// The lens test by depth sprites.
    pub sprites: bool,
    /// By those that have their own eye.
    pub own_sprites: bool,
    /// Membership by object.
    pub members: bool,
    /// Membership by object where objects come or go.
    pub fading_members: bool,
    /// The same, also of leaves of combinations.
    pub fading: bool,
    /// The lens test from the faces of solids.
    pub solids: bool,
    /// The sides of solids and combinations by depth sprites.
    pub side_sprites: bool,
    /// The lens test from the leaves of combinations.
    pub combinations: bool,
    /// Their sides by depth sprites.
    pub combined_sprites: bool,
    /// Bodies.
    pub bodies: bool,
    /// Their silhouettes.
    pub outlines: bool,
    /// As glass.
    pub shells: bool,
    /// As a glow.
    pub halos: bool,
    /// How far a place is from a lens.
    pub distances: bool,
    /// Blend modes.
    pub blends: bool,
    /// Lines over what was shaded.
    pub lines: bool,
    /// Translucent layers over what was shaded.
    pub transparency: bool,
    /// Contents of lenses.
    pub contents: bool,
    /// Moments, and when objects are there.
    pub timed: bool,
    /// What is there by halves.
    pub partly: bool,
    /// What moves.
    pub moves: bool,
    /// How places look that have another moment.
    pub varies: bool,
    /// Lenses that bend rays.
    pub bends: Bends,
    /// Fields in the city.
    pub fields: bool,
    /// Soft borders of lenses.
    pub borders: bool,
    /// Borders of lenses along rays.
    pub by_ray: bool,
}
