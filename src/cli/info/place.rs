//! What is at a place in plan: `--at`.

use std::str::FromStr;

use glam::DVec2;
use serde::Serialize;

use crate::city::{CityModel, ground::plain_ground, place::Places, shown::shown_geometries, spatial::SpatialIndex};

/// A place in plan, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place(pub DVec2);

impl FromStr for Place {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let number = |part: &str| part.trim().parse::<f64>().ok().filter(|n| n.abs() <= 1e9);
        let place = text.split_once(',').and_then(|(x, y)| Some(DVec2::new(number(x)?, number(y)?)));
        place.map(Self).ok_or_else(|| "expected X,Y in model coordinates, metres, as in 85010.5,447320".to_owned())
    }
}

/// What is there.
#[derive(Clone, Debug, Serialize)]
pub struct PlaceFacts {
    /// The place, metres.
    pub x: f64,
    /// The same, northwards.
    pub y: f64,
    /// Height of the ground, metres: of terrain and what lies on it, else of the plain ground; null where there is neither.
    pub ground_m: Option<f64>,
    /// Whether that is the plain ground, which no file has.
    pub is_plain_ground: bool,
    /// Height of what stands highest there, metres; null: nothing does.
    pub top_m: Option<f64>,
    /// How high that is above the ground, metres.
    pub above_ground_m: Option<f64>,
    /// Its id.
    pub object: Option<String>,
    /// Its type, as the file calls it.
    pub r#type: Option<String>,
}

impl PlaceFacts {
    /// What is at a place of a city.
    pub fn new(city: &CityModel, at: DVec2) -> Self {
        let shown = shown_geometries(city, None);
        let index = SpatialIndex::build(city, &shown);
        let plain = plain_ground(city, &shown);
        let of_files = Places { model: city, index: &index, ground: None };
        let places = Places { ground: plain.as_ref(), ..of_files };
        let (ground_m, top) = (places.ground(at), places.top(at));
        let object = top.map(|top| &city.objects[top.object as usize]);
        Self {
            x: at.x,
            y: at.y,
            ground_m,
            is_plain_ground: ground_m.is_some() && of_files.ground(at).is_none(),
            top_m: top.map(|top| top.height),
            above_ground_m: top.zip(ground_m).map(|(top, ground)| top.height - ground),
            object: object.map(|object| object.id.to_string()),
            r#type: object.map(|object| city.strings.get(object.kind).to_owned()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_two_numbers() {
        assert_eq!("1.5,-2".parse(), Ok(Place(DVec2::new(1.5, -2.0))));
        assert_eq!(" 85010 , 447320.25 ".parse(), Ok(Place(DVec2::new(85_010.0, 447_320.25))));
        for wrong in ["", "1", "1;2", "1,2,3", "a,b", "nan,1", "1e12,0"] {
            assert!(wrong.parse::<Place>().is_err(), "{wrong}");
        }
    }
}
