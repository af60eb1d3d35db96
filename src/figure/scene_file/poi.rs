//! `[[poi]]` in scene files.

use crate::{
    figure::scene_file::{
        check::Fields,
        forms::Same,
        keys::{Kind, Table, key},
        node::Data,
        paths::Options,
        reader::Reader,
        row::{self, Row, field, keys_of},
    },
    scene::{Poi, PoiPlace},
};

/// `[[poi]]`.
pub const POI: Table = Table {
    name: "poi",
    doc: "A point of interest: a city object or a place; exactly one of `object`, `at` and `trajectory`.",
    keys: keys_of!(POI_ROWS),
};

const POI_ROWS: &[Row<Poi>] = &[
    field!(
        key("name", Kind::Text, "`poi-N`, N its place in the file", "", "Its name, unique.", "\"hall\""),
        Same,
        |poi: Poi| poi.name
    )
    .always(),
    Row::<Poi>::joint(
        key("object", Kind::Text, "none", "", "Id of a city object.", "\"NL.IMBAG.Pand.0503100000031316\""),
        |poi, _| match &poi.place {
            PoiPlace::Object(id) => Some(id.into()),
            _ => None,
        },
    )
    .always(),
    Row::<Poi>::joint(key("at", Kind::Point, "none", "m", "A point.", "[10.0, 20.0, 3.0]"), |poi, _| match poi.place {
        PoiPlace::At(at) | PoiPlace::AboveGround(at) => Some(at.into()),
        _ => None,
    })
    .always(),
    Row::<Poi>::joint(
        key(
            "above_ground",
            Kind::Boolean,
            "false",
            "",
            "Whether the height of `at` is metres above the ground there; see Heights above the ground.",
            "true",
        ),
        |poi, _| matches!(poi.place, PoiPlace::AboveGround(_)).then(|| true.into()),
    )
    .always(),
    Row::<Poi>::joint(
        key("trajectory", Kind::Text, "none", "", "Name of a `[[trajectory]]`: it moves along it.", "\"tram 1\""),
        |poi, _| match &poi.place {
            PoiPlace::On(way) => Some(way.into()),
            _ => None,
        },
    )
    .always(),
];

/// The table of a point of interest.
pub fn written(poi: &Poi, options: &Options) -> Data {
    row::written(POI_ROWS, poi, poi, options)
}

/// A point of interest; `None`, with a note, where it is none.
pub fn read(reader: &mut Reader, fields: &Fields, index: usize) -> Option<Poi> {
    let name = fields.text("name").map_or_else(|| format!("poi-{index}"), str::to_owned);
    let given: Vec<&str> = ["object", "at", "trajectory"].into_iter().filter(|key| fields.given(key)).collect();
    let place = match given[..] {
        ["object"] => PoiPlace::Object(fields.text("object")?.to_owned()),
        ["at"] if fields.boolean("above_ground") == Some(true) => PoiPlace::AboveGround(fields.point("at")?),
        ["at"] => PoiPlace::At(fields.point("at")?),
        [_] => PoiPlace::On(fields.text("trajectory")?.to_owned()),
        [] => {
            let message = "is missing: give object = \"ID\", at = [x, y, z] or trajectory = \"NAME\"";
            reader.checker.note(&fields.place, "at", fields.place.line, message);
            return None;
        }
        [first, second, ..] => {
            let message = format!("is given together with {first}: a point of interest is one of them");
            reader.checker.note(&fields.place, second, fields.line(second), message);
            return None;
        }
    };
    if fields.given("above_ground") && !fields.given("at") {
        let message = "has a meaning only with at = [x, y, z]";
        reader.checker.note(&fields.place, "above_ground", fields.line("above_ground"), message);
    }
    Some(Poi { name, place })
}
