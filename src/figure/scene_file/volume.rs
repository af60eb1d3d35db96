//! `[[volume]]` in scene files.

use crate::{
    field::{Component, PLUME},
    figure::scene_file::{
        check::Fields,
        forms::{Color, Form, Same, Turn, Word},
        keys::{FAR_M, Kind, RAMPS, Table, key},
        node::{Data, Node},
        paths::Options,
        reader::Reader,
        row::{self, Row, field, keys_of},
    },
    lens::color::Srgb,
    scene::{
        Volume,
        volume::{RAMP_ENTRIES, Slice, Transfer, VolumeLight, VolumeMode},
    },
};

/// `[[volume]]`.
pub const VOLUME: Table = Table {
    name: "volume",
    doc: "A field that stands in the city: values on a grid, seen through; see Volumes.",
    keys: keys_of!(VOLUME_ROWS),
};

/// `transfer` of a volume.
pub const TRANSFER: Table = Table {
    name: "transfer",
    doc: "How the values of a volume look: colour and opacity by the value.",
    keys: keys_of!(TRANSFER_ROWS),
};

/// `slice` of a volume.
pub const SLICE: Table =
    Table { name: "slice", doc: "The plane that `mode = \"slice\"` shows.", keys: keys_of!(SLICE_ROWS) };

/// The words of axes.
const AXES: &[&str] = &["x", "y", "z"];

/// An axis, by its letter.
struct Axis;

impl Form<u32> for Axis {
    fn data(value: &u32) -> Option<Data> {
        AXES.get(*value as usize).map(|word| (*word).into())
    }

    fn take(node: &Node, into: &mut u32) {
        if let Some(axis) = node.text().and_then(|text| AXES.iter().position(|word| *word == text)) {
            *into = axis as u32;
        }
    }
}

/// What of vectors is shown: their length, or a component.
struct Vector;

const COMPONENTS: &[(&str, Component)] = &[
    ("magnitude", Component::Magnitude),
    ("x", Component::Index(0)),
    ("y", Component::Index(1)),
    ("z", Component::Index(2)),
];

impl Form<Component> for Vector {
    fn data(value: &Component) -> Option<Data> {
        COMPONENTS.iter().find(|(_, own)| own == value).map(|(word, _)| (*word).into())
    }

    fn take(node: &Node, into: &mut Component) {
        if let Some((_, own)) = COMPONENTS.iter().find(|(word, _)| node.text() == Some(word)) {
            *into = *own;
        }
    }
}

const SLICE_ROWS: &[Row<Slice>] = &[
    field!(
        key(
            "axis",
            Kind::Word { now: AXES, later: &[] },
            "\"z\"",
            "",
            "The axis of the grid that it is across: its first, second or third.",
            "\"x\""
        ),
        Axis,
        |slice: Slice| slice.axis
    ),
    field!(
        key(
            "at",
            Kind::Number { min: 0.0, max: 1.0 },
            "0.5",
            "",
            "Where it is, a share of the way from the first sample to the last.",
            "0.25"
        ),
        Same,
        |slice: Slice| slice.at
    ),
];

/// Colours, as files have them.
struct ColorList;

impl Form<Vec<Srgb>> for ColorList {
    fn data(value: &Vec<Srgb>) -> Option<Data> {
        (!value.is_empty()).then(|| Data::list(value.iter().filter_map(Color::data)))
    }

    fn take(node: &Node, into: &mut Vec<Srgb>) {
        let color = |node: &Node| {
            let mut color = [0.0; 3];
            Color::take(node, &mut color);
            color
        };
        *into = node.list().unwrap_or_default().iter().map(color).collect();
    }
}

/// Shares, as files have them.
struct ShareList;

impl Form<Vec<f32>> for ShareList {
    fn data(value: &Vec<f32>) -> Option<Data> {
        // The number with the fewest digits that is rounded to it.
        let shortest = |n: &f32| format!("{n:?}").parse().unwrap_or_else(|_| f64::from(*n));
        Some(Data::list(value.iter().map(shortest)))
    }

    fn take(node: &Node, into: &mut Vec<f32>) {
        *into = node.list().unwrap_or_default().iter().filter_map(Node::number).map(|n| n as f32).collect();
    }
}

const TRANSFER_ROWS: &[Row<Transfer>] = &[
    field!(
        key(
            "ramp",
            Kind::Word { now: RAMPS, later: &[] },
            "\"viridis\"",
            "",
            "A colour ramp, from the lowest value to the highest; where there are `colors`, these.",
            "\"batlow\""
        ),
        Same,
        |transfer: Transfer| transfer.ramp
    ),
    field!(
        key(
            "colors",
            Kind::Colors,
            "those of `ramp`",
            "",
            "Colours at `values`, or at equal steps of the range; in between mixed.",
            "[\"#2166ac\", \"#f7f7f7\", \"#b2182b\"]"
        ),
        ColorList,
        |transfer: Transfer| transfer.colors
    ),
    field!(
        key(
            "opacity",
            Kind::Shares,
            "[0.0, 0.2]",
            "",
            "Opacities at `values`, or at equal steps of the range: each is how much of a layer as thick as the `thickness` of the volume hides what is behind it.",
            "[0.0, 0.0, 0.4]"
        ),
        ShareList,
        |transfer: Transfer| transfer.opacity
    ),
    field!(
        key(
            "values",
            Kind::Numbers,
            "equal steps of the range",
            "",
            "Where `colors` and `opacity` stand: ascending values of the field. Of labels, which are seen; the others are not.",
            "[380.0, 420.0, 600.0]"
        ),
        Values,
        |transfer: Transfer| transfer.values
    ),
    field!(
        key(
            "names",
            Kind::Texts,
            "their numbers",
            "",
            "Of labels: what the legend calls them, one name for each of `values`.",
            "[\"bone\", \"liver\"]"
        ),
        TextList,
        |transfer: Transfer| transfer.names
    ),
    field!(
        key(
            "range",
            Kind::Numbers,
            "from the first to the last of `values`, or all that the field has",
            "",
            "The lowest and the highest value; those beyond look like them.",
            "[0.0, 40.0]"
        ),
        Range,
        |transfer: Transfer| transfer.range
    ),
];

/// A list of numbers.
struct Values;

impl Form<Vec<f64>> for Values {
    fn data(value: &Vec<f64>) -> Option<Data> {
        (!value.is_empty()).then(|| Data::list(value.iter().copied()))
    }

    fn take(node: &Node, into: &mut Vec<f64>) {
        *into = node.list().unwrap_or_default().iter().filter_map(Node::number).collect();
    }
}

/// Texts, where there are some.
struct TextList;

impl Form<Vec<String>> for TextList {
    fn data(value: &Vec<String>) -> Option<Data> {
        (!value.is_empty()).then(|| Data::list(value))
    }

    fn take(node: &Node, into: &mut Vec<String>) {
        *into = node.texts();
    }
}

/// Two numbers.
struct Range;

impl Form<Option<[f64; 2]>> for Range {
    fn data(value: &Option<[f64; 2]>) -> Option<Data> {
        value.map(Into::into)
    }

    fn take(node: &Node, into: &mut Option<[f64; 2]>) {
        *into = node.numbers::<2>();
    }
}

const VOLUME_ROWS: &[Row<Volume>] = &[
    field!(
        key("name", Kind::Text, "`volume-N`, N its place in the file", "", "Its name, unique.", "\"smoke\""),
        Same,
        |volume: Volume| volume.name
    )
    .always(),
    field!(key("visible", Kind::Boolean, "true", "", "Whether it is shown.", "false"), Same, |volume: Volume| volume
        .visible),
    Row::<Volume>::new(
        key(
            "file",
            Kind::Text,
            "",
            "",
            "Its file: NRRD, VTK (`.vti`, `.vtk`), OpenDX (`.dx`, `.general`), NIfTI or MetaImage; or `builtin:plume`.",
            "\"wind.nrrd\"",
        ),
        |volume, options| Some(Data::Text(options.written(&volume.file))),
        |volume, given| {
            volume.file = match given.node.text() {
                Some(PLUME) => PLUME.into(),
                _ => given.file().unwrap_or_default(),
            }
        },
    ),
    field!(
        key("field", Kind::Text, "the first of the file", "", "Name of the array of the file.", "\"temperature\""),
        Same,
        |volume: Volume| volume.field
    ),
    field!(
        key(
            "label",
            Kind::Text,
            "its name, or where it has none that of the array",
            "",
            "What the legend calls its values.",
            "\"Temperature\""
        ),
        Same,
        |volume: Volume| volume.label
    ),
    field!(
        key("unit", Kind::Text, "what the file says", "", "Unit of its values, for the legend.", "\"K\""),
        Same,
        |volume: Volume| volume.unit
    ),
    field!(
        key(
            "component",
            Kind::Word { now: &["magnitude", "x", "y", "z"], later: &[] },
            "\"magnitude\"",
            "",
            "What of vectors is shown: their length or one of their components. Of single numbers, the number.",
            "\"z\""
        ),
        Vector,
        |volume: Volume| volume.component
    ),
    field!(
        key(
            "time_step",
            Kind::Integer { min: 0, max: 1_000_000 },
            "0",
            "",
            "Which step in time of the file, from 0, where `begins` and `ends` are not given.",
            "12"
        ),
        Same,
        |volume: Volume| volume.time_step
    ),
    field!(
        key(
            "begins",
            Kind::Moment,
            "none",
            "",
            "When its first step in time is; with `ends`. Then the moment of the scene, and in time lenses theirs, say which step is seen: each up to the next one, the first before and where no moment is, the last after.",
            "\"2024-06-01 06:00\""
        ),
        Same,
        |volume: Volume| volume.begins
    ),
    field!(
        key(
            "ends",
            Kind::Moment,
            "none",
            "",
            "When its last step in time is; the others are at equal times between.",
            "\"2024-06-02 06:00\""
        ),
        Same,
        |volume: Volume| volume.ends
    ),
    field!(
        key(
            "labels",
            Kind::Boolean,
            "false",
            "",
            "Whether its values are numbers of things, whole and 0 to 255: they are not mixed, and `transfer` has the `values` that are seen.",
            "true"
        ),
        Same,
        |volume: Volume| volume.labels
    ),
    field!(
        key(
            "origin",
            Kind::Point,
            "as in the file",
            "metres",
            "Where its first sample stands in the city.",
            "[85200.0, 446900.0, 0.0]"
        ),
        Same,
        |volume: Volume| volume.origin
    ),
    field!(
        key(
            "spacing",
            Kind::Lengths,
            "as in the file",
            "metres",
            "From a sample to the next along each axis of its grid.",
            "[20.0, 20.0, 5.0]"
        ),
        Same,
        |volume: Volume| volume.spacing
    ),
    field!(
        key(
            "rotation_deg",
            Kind::Angles,
            "[0, 0, 0]",
            "degrees",
            "Turns it about its first sample: yaw counter-clockwise from above, pitch lifts its east, roll about its east.",
            "[30.0, 0.0, 0.0]"
        ),
        Turn,
        |volume: Volume| volume.rotation
    ),
    Row::<Volume>::new(
        key(
            "up",
            Kind::Word { now: &["y", "z"], later: &[] },
            "\"z\"",
            "",
            "Which of the coordinates of its file goes up.",
            "\"y\"",
        ),
        |volume, _| Some(Data::from(if volume.y_up { "y" } else { "z" })),
        |volume, given| volume.y_up = given.node.text() == Some("y"),
    ),
    Row::<Volume>::new(
        key(
            "transfer",
            Kind::Table(&TRANSFER),
            "viridis, from clear to a fifth",
            "",
            "How its values look.",
            "{ ramp = \"batlow\", opacity = [0.0, 0.5] }",
        ),
        |volume, options| {
            let written = row::written(TRANSFER_ROWS, &volume.transfer, &Transfer::default(), options);
            (!written.is_empty_table()).then_some(written)
        },
        |volume, given| {
            let own = given.table(&TRANSFER);
            volume.transfer = Transfer::default();
            row::read(TRANSFER_ROWS, &own, given.reader, &mut volume.transfer);
            check_transfer(&own, given.reader, &volume.transfer);
        },
    ),
    field!(
        key(
            "mode",
            Kind::Word {
                now: &["direct", "gradient", "maximum", "minimum", "average", "x-ray", "isosurface", "slice"],
                later: &[],
            },
            "\"direct\"",
            "",
            "What a ray makes of the values that it meets: each takes light away and gives its own; the same where values change; one layer of the largest, the smallest or their mean; light is taken away; the surface of a value; a plane.",
            "\"maximum\""
        ),
        Word,
        |volume: Volume| volume.mode
    ),
    field!(
        key(
            "level",
            Kind::Number { min: f64::MIN, max: f64::MAX },
            "the middle of the transfer's range",
            "",
            "Of `isosurface`: the value whose surface is shown. Of labels it is around all that are seen.",
            "1200.0"
        ),
        Same,
        |volume: Volume| volume.level
    ),
    Row::<Volume>::new(
        key(
            "slice",
            Kind::Table(&SLICE),
            "across the third axis, in the middle",
            "",
            "Of `slice`: where.",
            "{ axis = \"x\", at = 0.3 }",
        ),
        |volume, options| {
            let written = row::written(SLICE_ROWS, &volume.slice, &Slice::default(), options);
            (!written.is_empty_table()).then_some(written)
        },
        |volume, given| {
            let own = given.table(&SLICE);
            volume.slice = Slice::default();
            row::read(SLICE_ROWS, &own, given.reader, &mut volume.slice);
        },
    ),
    field!(
        key(
            "light",
            Kind::Word { now: &["none", "lit", "shadowed"], later: &[] },
            "\"none\"",
            "",
            "Whether sun and sky light it, as a surface across the way that its values change; and whether the city casts its shadows on it.",
            "\"lit\""
        ),
        Word,
        |volume: Volume| volume.light
    ),
    field!(
        key(
            "keep",
            Kind::Boolean,
            "false",
            "",
            "Whether lenses take nothing of it away: what hides and what makes translucent, such as the eraser and x-ray, leaves it as it is, and shows it behind walls.",
            "true"
        ),
        Same,
        |volume: Volume| volume.keeps
    ),
    field!(
        key(
            "thickness",
            Kind::Number { min: 1e-3, max: FAR_M },
            "the smallest distance of its samples",
            "metres",
            "How thick a layer is that has the opacities of `transfer`.",
            "25.0"
        ),
        Same,
        |volume: Volume| volume.thickness
    ),
    field!(
        key(
            "step",
            Kind::Number { min: 0.01, max: 16.0 },
            "1.0",
            "",
            "How far rays go from one value to the next, as shares of the smallest distance of its samples: smaller is finer, and slower.",
            "0.5"
        ),
        Same,
        |volume: Volume| volume.step
    ),
];

/// Notes lists that do not go together.
fn check_transfer(fields: &Fields, reader: &mut Reader, transfer: &Transfer) {
    let mut note = |key: &str, message: String| reader.checker.note(&fields.place, key, fields.line(key), message);
    let count = transfer.values.len();
    if fields.given("values") && (count == 0 || !transfer.values.is_sorted_by(|a, b| a < b)) {
        note("values", "must be a list of numbers, each larger than the one before".to_owned());
        return;
    }
    let lists =
        [("colors", transfer.colors.len()), ("opacity", transfer.opacity.len()), ("names", transfer.names.len())];
    for (key, own) in lists {
        // An opacity alone is that of all.
        let is_one = key == "opacity" && own == 1;
        if count > 0 && fields.given(key) && own != count && !is_one {
            note(key, format!("has {own} entries and values {count}; as many as values would be right"));
        }
    }
    if fields.given("range") && transfer.range.is_none_or(|[low, high]| low >= high) {
        note("range", "must be two numbers, the second larger, as in [0.0, 40.0]".to_owned());
    }
}

/// The table of a volume.
pub fn written(volume: &Volume, options: &Options) -> Data {
    row::written(VOLUME_ROWS, volume, &Volume::default(), options)
}

/// A volume; `None`, with a note, where it is none.
pub fn read(reader: &mut Reader, fields: &Fields, index: usize) -> Option<Volume> {
    let mut volume = Volume { name: format!("volume-{index}"), ..Volume::default() };
    row::read(VOLUME_ROWS, fields, reader, &mut volume).then_some(())?;
    let mut note = |key: &str, message: String| reader.checker.note(&fields.place, key, fields.line(key), message);
    if volume.spacing.is_some_and(|spacing| spacing.min_element() <= 0.0) {
        note("spacing", "must be three numbers above 0".to_owned());
    }
    if volume.labels && volume.transfer.values.is_empty() {
        note("labels", "needs the labels that are seen: transfer = { values = [1, 2], colors = [...] }".to_owned());
    }
    let most = (RAMP_ENTRIES - 1) as f64;
    if volume.labels && volume.transfer.values.iter().any(|label| label.fract() != 0.0 || !(0.0..=most).contains(label))
    {
        note("transfer", format!("values: labels are whole numbers 0 to {most}"));
    }
    // Those that are seen are seen.
    if volume.labels && volume.transfer.opacity == Transfer::default().opacity {
        volume.transfer.opacity = vec![1.0];
    }
    let mixes =
        matches!(volume.mode, VolumeMode::Maximum | VolumeMode::Minimum | VolumeMode::Average | VolumeMode::Gradient);
    if volume.labels && mixes {
        let message = "does not go with labels, which are not mixed; \"direct\", \"isosurface\", \"x-ray\" or \"slice\" would be right";
        note("mode", message.to_owned());
    }
    let lit = [VolumeMode::Direct, VolumeMode::Gradient, VolumeMode::Isosurface];
    if volume.light != VolumeLight::None && !lit.contains(&volume.mode) {
        note("light", "has a meaning only with mode = \"direct\", \"gradient\" or \"isosurface\"".to_owned());
    }
    if !volume.labels && !volume.transfer.names.is_empty() {
        note("transfer", "names: have a meaning only with labels = true".to_owned());
    }
    if volume.level.is_some() && volume.mode != VolumeMode::Isosurface {
        note("level", "has a meaning only with mode = \"isosurface\"".to_owned());
    }
    match (volume.begins, volume.ends) {
        (None, Some(_)) => note("begins", "is missing: the times of steps are known with both".to_owned()),
        (Some(_), None) => note("ends", "is missing: the times of steps are known with both".to_owned()),
        (Some(begins), Some(ends)) if ends <= begins => note("ends", "must be later than begins".to_owned()),
        (Some(_), Some(_)) if fields.given("time_step") => {
            note("time_step", "is given together with begins: the moment says which step is seen".to_owned());
        }
        _ => {}
    }
    if fields.given("slice") && volume.mode != VolumeMode::Slice {
        note("slice", "has a meaning only with mode = \"slice\"".to_owned());
    }
    Some(volume)
}
