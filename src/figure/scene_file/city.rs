//! `[city]` and `[sun]` in scene files.

use std::path::PathBuf;

use glam::DVec2;

use crate::{
    city::{
        change::{ATTRIBUTE, Between, CityChange},
        side_table::Join,
    },
    figure::scene_file::{
        check::lod,
        epoch::moment,
        forms::{Degrees, Form as _, Same, Word},
        keys::{Kind, Table, key},
        node::{Data, Node},
        row::{self, Row, field, keys_of},
    },
    scene::{CitySpec, Sun, SunTime},
    time::Moment,
};

/// `[city]`.
pub const CITY: Table =
    Table { name: "city", doc: "Which city to load, and how much of it to show.", keys: keys_of!(CITY_ROWS) };

/// Its rows.
pub const CITY_ROWS: &[Row<CitySpec>] = &[
    Row::<CitySpec>::new(
        key(
            "files",
            Kind::Texts,
            "none",
            "",
            "City files or folders, relative to the scene file; several make one city. `${VEDUTA_DATA}` stands for the folder that variable names, `builtin:old-town`, `builtin:square`, `builtin:town` and `builtin:rooms` for the built-in cities.",
            "[\"city.city.json\"]",
        ),
        |city, options| {
            (!city.files.is_empty())
                .then(|| Data::list(city.files.iter().map(|file| Data::Text(options.written(file)))))
        },
        |city, given| {
            let must_exist = given.reader.options().must_exist;
            city.files = given.reader.files(given.fields, given.key, must_exist);
        },
    ),
    Row::<CitySpec>::new(
        key("lod", Kind::Lod, "the finest there is", "", "Shows no level of detail finer than this.", "\"1.3\""),
        |city, _| city.lod.as_ref().map(Data::from),
        |city, given| city.lod = lod(given.node).map(|lod| lod.to_string()),
    ),
    field!(
        key(
            "up",
            Kind::Word { now: &["z", "y"], later: &[] },
            "\"z\"",
            "",
            "What is up in OBJ files, which do not say so: exporters of cities write `z`, modelling programs `y`.",
            "\"y\"",
        ),
        Word,
        |city: CitySpec| city.up
    ),
    field!(
        key(
            "materials",
            Kind::Word { now: &["tamed", "file"], later: &[] },
            "\"tamed\"",
            "",
            "Colours of materials: `tamed`, vivid ones quieter and never dark, or as the `file` has them. Textures stay as they are.",
            "\"file\"",
        ),
        Word,
        |city: CitySpec| city.materials
    ),
    field!(
        key(
            "ground",
            Kind::Boolean,
            "true",
            "",
            "Puts a plain ground under the city, which fills gaps of its terrain and goes on around it until it fades.",
            "false",
        ),
        Same,
        |city: CitySpec| city.ground
    ),
    field!(
        key(
            "from",
            Kind::Text,
            "the first that the city has of names that registers use",
            "",
            "The attribute that says since when an object is there; one without it takes its parent's. See Time.",
            "\"yearOfConstruction\"",
        ),
        Same,
        |city: CitySpec| city.dating.from
    ),
    field!(
        key(
            "until",
            Kind::Text,
            "the first that the city has of names that registers use",
            "",
            "The attribute that says until when an object is there, not included.",
            "\"yearOfDemolition\"",
        ),
        Same,
        |city: CitySpec| city.dating.until
    ),
    field!(
        key(
            "undated",
            Kind::Word { now: &["show", "hide", "ghost"], later: &[] },
            "\"show\"",
            "",
            "What becomes of objects without a date where a moment is shown: they are always there (`show`), never (`hide`), or always by halves (`ghost`); terrain, roads, water and land use without one always show.",
            "\"hide\"",
        ),
        Word,
        |city: CitySpec| city.dating.undated
    ),
    Row::<CitySpec>::new(
        key(
            "join",
            Kind::Tables(&JOIN),
            "none",
            "",
            "Side tables whose columns become attributes of its objects, one after the other; a later one replaces what is there.",
            "[{ file = \"register.csv\", key = \"pand\", attribute = \"identificatie\" }]",
        ),
        |city, options| {
            let of = |join| row::written(JOIN_ROWS, join, &Join::default(), options);
            (!city.joins.is_empty()).then(|| Data::list(city.joins.iter().map(of)))
        },
        |city, given| {
            let nodes = given.node.list().unwrap_or_default();
            let of = |(i, node): (usize, &Node)| {
                let place = given.fields.place.within(&format!("join.{i}"), node.line);
                let fields = given.reader.checker.fields(node, &JOIN, &[], place);
                let mut join = Join::default();
                row::read(JOIN_ROWS, &fields, given.reader, &mut join).then_some(join)
            };
            city.joins = nodes.iter().enumerate().filter_map(of).collect();
        },
    ),
    Row::<CitySpec>::new(
        key(
            "change",
            Kind::Tables(&CHANGE),
            "none",
            "",
            "Attributes that say what became of its objects from one state to another; see Change.",
            "[{ since = \"1900\", until = \"2000\" }]",
        ),
        |city, options| {
            let of = |change| row::written(CHANGE_ROWS, change, &ChangeKeys::default(), options);
            let all: Vec<ChangeKeys> = city.changes.iter().map(ChangeKeys::of).collect();
            (!all.is_empty()).then(|| Data::list(all.iter().map(of)))
        },
        |city, given| {
            let nodes = given.node.list().unwrap_or_default();
            let of = |(i, node): (usize, &Node)| {
                let place = given.fields.place.within(&format!("change.{i}"), node.line);
                let fields = given.reader.checker.fields(node, &CHANGE, &[], place);
                let mut keys = ChangeKeys::default();
                let is_read = row::read(CHANGE_ROWS, &fields, given.reader, &mut keys);
                let change = keys.change();
                // Of files that are not there that is told.
                if change.is_none() && !fields.given("files") {
                    let message =
                        "says no states: since and until, two times, or files, an earlier state, would be right";
                    given.reader.checker.note(&fields.place, "", node.line, message);
                }
                change.filter(|_| is_read)
            };
            city.changes = nodes.iter().enumerate().filter_map(of).collect();
        },
    ),
    Row::<CitySpec>::new(
        key(
            "timetables",
            Kind::Texts,
            "none",
            "",
            "Tables by which its objects move, CSV with the columns `id`, `t`, `x`, `y`, `z`, `yaw`, `scale`; see Moving objects.",
            "[\"timetable.csv\"]",
        ),
        |city, options| {
            let files = city.timetables.iter().map(|file| Data::Text(options.written(file)));
            (!city.timetables.is_empty()).then(|| Data::list(files))
        },
        |city, given| {
            let must_exist = given.reader.options().must_exist;
            city.timetables = given.reader.files(given.fields, given.key, must_exist);
        },
    ),
];

/// The keys of an element of `change`, each for itself.
#[derive(Clone, Debug, Default, PartialEq)]
struct ChangeKeys {
    attribute: Option<String>,
    since: Option<Moment>,
    until: Option<Moment>,
    files: Vec<PathBuf>,
    key: Option<String>,
}

impl ChangeKeys {
    fn of(change: &CityChange) -> Self {
        let attribute = Some(change.attribute.clone()).filter(|name| name != ATTRIBUTE);
        match &change.between {
            Between::Moments([since, until]) => {
                Self { attribute, since: Some(*since), until: Some(*until), ..Self::default() }
            }
            Between::Files { files, key } => {
                Self { attribute, files: files.clone(), key: key.clone(), ..Self::default() }
            }
        }
    }

    /// What they mean; `None`: no two states, or more.
    fn change(self) -> Option<CityChange> {
        let between = match (self.since.zip(self.until), self.files.is_empty()) {
            (Some((since, until)), true) if self.key.is_none() => Between::Moments([since, until]),
            (None, false) if self.since.is_none() && self.until.is_none() => {
                Between::Files { files: self.files, key: self.key }
            }
            _ => return None,
        };
        Some(CityChange { attribute: self.attribute.unwrap_or_else(|| ATTRIBUTE.to_owned()), between })
    }
}

/// An element of `change` of `[city]`.
pub const CHANGE: Table = Table {
    name: "change",
    doc: "An attribute that says of each object what became of it, from one time to another (`since`, `until`) or since an earlier state in other files.",
    keys: keys_of!(CHANGE_ROWS),
};

const CHANGE_ROWS: &[Row<ChangeKeys>] = &[
    field!(
        key("attribute", Kind::Text, "\"change\"", "", "The name of the attribute.", "\"since 1900\""),
        Same,
        |change: ChangeKeys| change.attribute
    ),
    field!(
        key(
            "since",
            Kind::Moment,
            "none",
            "",
            "The earlier time; with `until`. The attribute says `added`, `removed`, `kept` or `at neither`.",
            "\"1900\"",
        ),
        Same,
        |change: ChangeKeys| change.since
    ),
    field!(
        key("until", Kind::Moment, "none", "", "The later time; with `since`.", "\"2000\""),
        Same,
        |change: ChangeKeys| change.until
    ),
    Row::<ChangeKeys>::new(
        key(
            "files",
            Kind::Texts,
            "none",
            "",
            "City files of an earlier state, in place of `since` and `until`. The attribute says `added`, `kept`, `other shape`, `other attributes` or `other shape and attributes`.",
            "[\"2015.city.json\"]",
        ),
        |change, options| {
            let files = change.files.iter().map(|file| Data::Text(options.written(file)));
            (!change.files.is_empty()).then(|| Data::list(files))
        },
        |change, given| {
            let must_exist = given.reader.options().must_exist;
            change.files = given.reader.files(given.fields, given.key, must_exist);
        },
    ),
    field!(
        key(
            "key",
            Kind::Text,
            "the id",
            "",
            "With `files`: the attribute by which objects of both states are the same.",
            "\"identificatie\"",
        ),
        Same,
        |change: ChangeKeys| change.key
    ),
];

/// An element of `join` of `[city]`.
pub const JOIN: Table = Table {
    name: "join",
    doc: "A side table: CSV, or GeoJSON whose properties count. Its columns become attributes of the objects that its rows are of, everywhere. `veduta info` tells what was joined.",
    keys: keys_of!(JOIN_ROWS),
};

const JOIN_ROWS: &[Row<Join>] = &[
    Row::<Join>::new(
        key("file", Kind::Text, "", "", "The table, relative to the scene file.", "\"register.csv\""),
        |join, options| Some(Data::Text(options.written(&join.file))),
        |join, given| join.file = given.file().unwrap_or_default(),
    ),
    field!(
        key(
            "key",
            Kind::Text,
            "the first column; of GeoJSON `id`",
            "",
            "The column that says of which object a row is. Of rows with the same the first counts.",
            "\"pand\"",
        ),
        Same,
        |join: Join| join.key
    ),
    field!(
        key(
            "attribute",
            Kind::Text,
            "the id of objects",
            "",
            "The attribute of objects, a text or a whole number, that has the same.",
            "\"identificatie\"",
        ),
        Same,
        |join: Join| join.attribute
    ),
    field!(
        key(
            "from",
            Kind::Text,
            "none",
            "",
            "The column that says since when a row holds: its attributes change over time, and an object has several rows.",
            "\"since\"",
        ),
        Same,
        |join: Join| join.valid[0]
    ),
    field!(
        key("until", Kind::Text, "none", "", "The column that says until when, not included.", "\"until\""),
        Same,
        |join: Join| join.valid[1]
    ),
];

/// `[sun]`.
pub const SUN: Table = Table { name: "sun", doc: "Where the light comes from.", keys: keys_of!(SUN_ROWS) };

/// Its rows.
pub const SUN_ROWS: &[Row<Sun>] = &[
    field!(
        key(
            "azimuth_deg",
            Kind::Number { min: -360.0, max: 360.0 },
            "215.0",
            "degrees",
            "Clockwise from north.",
            "135.0",
        ),
        Degrees,
        |sun: Sun| sun.azimuth
    ),
    field!(
        key("elevation_deg", Kind::Number { min: -90.0, max: 90.0 }, "48.0", "degrees", "Above the horizon.", "30.0"),
        Degrees,
        |sun: Sun| sun.elevation
    ),
    field!(key("shadows", Kind::Boolean, "true", "", "Whether it casts shadows.", "false"), Same, |sun: Sun| sun
        .shadows),
    field!(
        key(
            "size_deg",
            Kind::Number { min: 0.0, max: 20.0 },
            "0.53",
            "degrees",
            "Angular diameter of its disc: how soft shadows are in pictures of several samples; 0 is a point.",
            "3.0",
        ),
        Degrees,
        |sun: Sun| sun.size
    ),
    field!(
        key(
            "ambient_occlusion",
            Kind::Boolean,
            "true",
            "",
            "Whether the city hides parts of the sky from itself, where `shadows` are on; in pictures of several samples.",
            "false",
        ),
        Same,
        |sun: Sun| sun.ambient_occlusion
    ),
    Row::<Sun>::new(
        key(
            "at",
            Kind::Moment,
            "none: by azimuth and elevation",
            "",
            "A date and an hour of the city's clock: the sun stands where it does then, by the city's place on the earth. See Sun and sky.",
            "\"2026-06-21T16:00\"",
        ),
        |sun, _| match sun.when {
            SunTime::At(moment) => Some(Data::Text(moment.written())),
            SunTime::Never | SunTime::Scene => None,
        },
        |sun, given| sun.when = moment(given.node).map_or(sun.when, SunTime::At),
    ),
    Row::<Sun>::new(
        key(
            "follows_time",
            Kind::Boolean,
            "false",
            "",
            "Whether the sun stands where it does at the scene's moment, `[time] at`.",
            "true",
        ),
        |sun, _| (sun.when == SunTime::Scene).then(|| true.into()),
        |sun, given| match (given.node.data == Data::Boolean(true), sun.when) {
            (true, SunTime::At(_)) => {
                given.note("is given together with at: the sun shines at one time; leave out one of them")
            }
            (true, _) => sun.when = SunTime::Scene,
            (false, _) => {}
        },
    ),
    field!(
        key(
            "in_lenses",
            Kind::Boolean,
            "false",
            "",
            "With `follows_time`: whether the sun stands in time lenses where it does at the moments that show there, with its shadows. Each of these moments takes a frame.",
            "true",
        ),
        Same,
        |sun: Sun| sun.in_lenses
    ),
    Row::<Sun>::new(
        key(
            "place",
            Kind::PlanPoint,
            "where the city's reference system says",
            "degrees",
            "Latitude and longitude, north and east positive, of the place where the sun is seen, for `at` and `follows_time`. North is then along y.",
            "[52.01, 4.36]",
        ),
        |sun, _| Same::data(&sun.place),
        |sun, given| match given.node.numbers::<2>() {
            Some([latitude, longitude]) if latitude.abs() <= 90.0 && longitude.abs() <= 180.0 => {
                sun.place = Some(DVec2::new(latitude, longitude));
            }
            _ => given.note(format!(
                "must be [LATITUDE, LONGITUDE], -90 to 90 and -180 to 180 degrees, is {}",
                given.node.quoted()
            )),
        },
    ),
    field!(
        key(
            "utc_offset_h",
            Kind::Number { min: -14.0, max: 14.0 },
            "whole hours by the longitude",
            "h",
            "How far the city's clock is ahead of UTC, for `at` and `follows_time`: in summer often an hour more.",
            "2.0",
        ),
        Same,
        |sun: Sun| sun.utc_offset_h
    ),
];
