//! Objects that move by timetables (after Tiesel §4.3): each is a city of its own on the GPU, which is drawn once for each moment at which some
//! of it may show, as it stands then. Of what is drawn for a moment stays what is where that moment shows.

use std::sync::Arc;

use glam::{DQuat, DVec3};

use crate::{
    city::{CityModel, lifetime::Lifetimes, timetable::Pose},
    geom::Aabb,
    render::{
        contents::{ContentCity, WantedContent},
        epochs::{Epochs, LensPlaces, MetLenses},
        standing::Placement,
    },
    time::Moment,
};

/// Moments for which something that moves is drawn in a picture, at most: as many as the table of surfaces tells apart.
pub const MOST_TURNS: usize = 62;

/// The objects of a city that move.
#[derive(Debug, Default)]
pub struct MovingObjects {
    all: Vec<MovingObject>,
    /// The city's geometries that stay where they are.
    still: Vec<u32>,
}

/// An object that moves, with its parts.
#[derive(Debug)]
struct MovingObject {
    /// Index among the model's.
    keyframes: usize,
    /// What is shown of it.
    city: Arc<ContentCity>,
    /// The box around that as its file has it, metres.
    bounds: Aabb,
}

/// What moves in a picture.
#[derive(Debug, Default)]
pub struct Moving {
    /// What is drawn, and where.
    pub wanted: Vec<WantedContent>,
    /// The moments for which it is.
    pub moments: Vec<Option<Moment>>,
    /// The box around all of it, metres.
    pub bounds: Aabb,
}

impl MovingObjects {
    /// Those of a city of which these geometries are shown.
    pub fn new(model: &Arc<CityModel>, geometries: &[u32]) -> Self {
        if model.moves.is_empty() {
            return Self::default();
        }
        let mut own: Vec<Vec<u32>> = vec![Vec::new(); model.moves.len()];
        let mut still = Vec::new();
        for &geometry in geometries {
            match model.mover(model.geometries[geometry as usize].object) {
                Some(i) => own[i].push(geometry),
                None => still.push(geometry),
            }
        }
        let shown = own.into_iter().enumerate().filter(|(_, geometries)| !geometries.is_empty());
        let all = shown.map(|(keyframes, geometries)| {
            let bounds = |g: &u32| model.geometries[*g as usize].bounds;
            let bounds = geometries.iter().map(bounds).fold(Aabb::EMPTY, |all, own| all.union(own));
            // Names of contents count from 1.
            let id = u64::MAX - keyframes as u64;
            let city = ContentCity { moves: true, ..ContentCity::plain(id, model.clone(), geometries, true) };
            MovingObject { keyframes, city: Arc::new(city), bounds }
        });
        Self { all: all.collect(), still }
    }

    /// The city's geometries that stay where they are.
    pub fn still(&self) -> &[u32] {
        &self.still
    }

    /// What of a city's geometries is drawn where its file has it, and the box around what is drawn beside that, metres. `is_still`: nothing
    /// that moves is among it.
    pub fn drawn_still<'a>(&'a self, is_still: bool, all: &'a [u32]) -> (&'a [u32], Aabb) {
        match is_still {
            true => (&self.still, self.all.iter().fold(Aabb::EMPTY, |all, object| all.union(object.bounds))),
            false => (all, Aabb::EMPTY),
        }
    }

    /// The objects of the model that move, parts by themselves.
    pub fn objects(&self) -> impl Iterator<Item = u32> {
        let geometries =
            self.all.iter().flat_map(|object| object.city.geometries.iter().map(|g| (&object.city.model, *g)));
        geometries.map(|(model, g)| model.geometries[g as usize].object)
    }

    /// Whether nothing moves.
    pub fn is_empty(&self) -> bool {
        self.all.is_empty()
    }

    /// What moves in a picture: each object at each moment that shows at a place where it stands then, or (`anywhere`) at any. `places`: of the
    /// lenses with operators.
    ///
    /// # Errors
    /// More moments than can be told apart.
    pub fn at(
        &self,
        model: &CityModel,
        epochs: &Epochs,
        places: &[LensPlaces],
        lifetimes: Option<&Lifetimes>,
        anywhere: bool,
    ) -> Result<Moving, String> {
        let mut found = Moving { bounds: Aabb::EMPTY, ..Moving::default() };
        if self.is_empty() {
            return Ok(found);
        }
        let everywhere = MetLenses::new(None, places);
        let too_many = || {
            format!(
                "objects move, and lenses show more than {MOST_TURNS} moments where they may be, or combinations of as many; fewer lenses with operators \
                 would be right"
            )
        };
        let all = epochs.moments_of(everywhere.of(0)).ok_or_else(too_many)?;
        for object in &self.all {
            let keyframes = &model.moves[object.keyframes];
            for at in &all {
                let is_there = |lifetimes: &Lifetimes| lifetimes.of[keyframes.object as usize].holds(*at);
                if !lifetimes.is_none_or(is_there) {
                    continue;
                }
                let placement = placement(&keyframes.pose(*at));
                let bounds = placement.boxed(&object.bounds);
                let met = MetLenses::new(Some(&[bounds]), places);
                let shown = epochs.moments_of(met.of(0)).ok_or_else(too_many)?;
                if !anywhere && shown.binary_search(at).is_err() {
                    continue;
                }
                let known = found.moments.iter().position(|known| known == at);
                let turn = known.unwrap_or(found.moments.len());
                if known.is_none() {
                    found.moments.push(*at);
                }
                found.bounds = found.bounds.union(bounds);
                found.wanted.push(WantedContent {
                    number: 0,
                    city: Some(object.city.clone()),
                    first_object: 0,
                    placement,
                    turn: 1 + turn as u32,
                });
            }
        }
        if found.moments.len() > MOST_TURNS { Err(too_many()) } else { Ok(found) }
    }
}

/// Where an object stands that has a pose.
pub(super) fn placement(pose: &Pose) -> Placement {
    let rotation = if pose.turn == 0.0 { DQuat::IDENTITY } else { DQuat::from_axis_angle(DVec3::Z, pose.turn) };
    Placement { from: pose.from, to: pose.to, rotation, scale: pose.scale }
}
