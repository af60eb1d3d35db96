//! City object types of CityJSON and what kind of thing they are.

use crate::city::model::ObjectClass;

/// The class of a type as the file names it; extensions (`+Foo`) and unknown ones are [`ObjectClass::Other`].
pub fn class(kind: &str) -> ObjectClass {
    match kind {
        "TINRelief" => ObjectClass::Terrain,
        "WaterBody" => ObjectClass::Water,
        "Road" | "Railway" | "TransportSquare" | "Waterway" => ObjectClass::Road,
        "PlantCover" | "SolitaryVegetationObject" => ObjectClass::Vegetation,
        "LandUse" => ObjectClass::Land,
        "OtherConstruction" => ObjectClass::Construction,
        _ if kind.starts_with("Building") => ObjectClass::Building,
        _ if kind.starts_with("Bridge") || kind.starts_with("Tunnel") => ObjectClass::Construction,
        _ => ObjectClass::Other,
    }
}
