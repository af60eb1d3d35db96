//! What best-view lenses show in scene files: its tables, read and written.

use glam::DVec3;

use crate::{
    figure::scene_file::{
        camera::{self, CAMERA, Eye},
        check::Fields,
        effects,
        forms::{Behind, Degrees, Form as _, Names, Same, Word},
        keys::{FAR_M, Key, Kind, Table, key},
        node::{Data, Node},
        paths::Options,
        reader::Reader,
        row::{self, Row, Variant, field, keys_of, kind, part, tables, variant},
        style::LOOKS,
    },
    lens::{
        LensKind,
        best_view::{
            Background, BaseStyle, BestView, DEFAULT_FOV, Depiction, LocalView, Look, MOST_MAGNIFIED, MapMode,
            StyleLook,
        },
        nearest::did_you_mean,
    },
    view::{Camera, Projection},
};

const FOV: Key =
    key("fov_deg", Kind::Number { min: 0.01, max: 179.0 }, "45.0", "degrees", "Vertical field of view.", "30.0");

const MAP_MODES: [&str; 3] = [MapMode::WORDS[0].0, MapMode::WORDS[1].0, MapMode::WORDS[2].0];

/// All eyes of their own.
pub const VIEWS: &[Table] = &tables::<_, { VIEW_KINDS.len() }>(VIEW_KINDS);

const VIEW_KINDS: &[Variant<LocalView>] = &[
    variant!(
        LocalView,
        "best",
        "All of the first point of interest: the sphere around it fills the overlay. What is nearer to this eye than that sphere is \
              left out, so that nothing hides it; where the eye is chosen and less than a tenth of the object is hidden, it stays.",
        LocalView::Best { normal: None, fov_y: DEFAULT_FOV, highlight: true },
        LocalView::Best { .. },
        &[
            kind!("best", "Which eye.", "the first that its kind of lens may have"),
            part!(LocalView, key(
                "normal",
                Kind::Direction,
                "where most of its facades is seen from, of two that show as much the sunlit side",
                "",
                "The direction from the object to the eye (best-view normal), of any length but 0.",
                "[-1.0, -1.0, 0.5]",
            ), Same, LocalView::Best { normal, .. } => normal),
            part!(LocalView, FOV, Degrees, LocalView::Best { fov_y, .. } => fov_y),
            part!(LocalView, key(
                "highlight",
                Kind::Boolean,
                "true",
                "",
                "Whether its object stands out: all else is pale, and dark by night. A point that is no object has nothing that stands out.",
                "false",
            ), Same, LocalView::Best { highlight, .. } => highlight),
        ]
    ),
    variant!(
        LocalView,
        "mcop",
        "The main eye, looked at from outside (multiple centres of projection).",
        LocalView::Mcop { normal: DVec3::Z, distance_m: 0.0, fov_y: DEFAULT_FOV },
        LocalView::Mcop { .. },
        &[
            kind!("mcop", "Which eye.", "the first that its kind of lens may have"),
            part!(LocalView, key(
                "normal",
                Kind::Direction,
                "[0, 0, 1]",
                "",
                "The direction from the main eye to this one, of any length but 0.",
                "[0, -1, 1]",
            ), Same, LocalView::Mcop { normal, .. } => normal),
            part!(LocalView, key("distance", Kind::Number { min: 1e-3, max: FAR_M }, "", "m", "How far from the main eye.", "250.0"), Same, LocalView::Mcop { distance_m, .. } => distance_m),
            part!(LocalView, FOV, Degrees, LocalView::Mcop { fov_y, .. } => fov_y),
        ]
    ),
    variant!(
        LocalView,
        "scop",
        "From the main eye in another direction (single centre of projection): a rear-view mirror, a look aside.",
        LocalView::Scop { direction: DVec3::Z, of_camera: true, mirror: false, fov_y: DEFAULT_FOV },
        LocalView::Scop { .. },
        &[
            kind!("scop", "Which eye.", "the first that its kind of lens may have"),
            part!(LocalView, key(
                "direction",
                Kind::Direction,
                "[0, 0, 1], backwards",
                "",
                "Where it looks, of any length but 0.",
                "[1, 0, 0]",
            ), Same, LocalView::Scop { direction, .. } => direction),
            Row::<LocalView>::new(
                key(
                    "axes",
                    Kind::Word { now: &["camera", "world"], later: &[] },
                    "\"camera\"",
                    "",
                    "The axes of `direction`: the main camera's (x to the right, y up, z towards whoever looks) or the model's.",
                    "\"world\"",
                ),
                |view, _| match view {
                    LocalView::Scop { of_camera: false, .. } => Some(WORLD.into()),
                    _ => None,
                },
                |view, given| if let LocalView::Scop { of_camera, .. } = view {
                    *of_camera = given.node.text() != Some(WORLD)
                }
            ),
            part!(LocalView, key("mirror", Kind::Boolean, "false", "", "Exchanges left and right, as a mirror does.", "true"), Same, LocalView::Scop { mirror, .. } => mirror),
            part!(LocalView, FOV, Degrees, LocalView::Scop { fov_y, .. } => fov_y),
        ]
    ),
    variant!(
        LocalView,
        "map",
        "A map of what lies around the main eye, seen straight from above.",
        LocalView::Map { mode: MapMode::default(), height_m: 500.0, magnification: 1.0, lazy: 0.0 },
        LocalView::Map { .. },
        &[
            kind!("map", "Which eye.", "the first that its kind of lens may have"),
            part!(LocalView, key(
                "mode",
                Kind::Word { now: &MAP_MODES, later: &[] },
                "\"north-up\"",
                "",
                "What is at its top: north, or where the main eye looks (`head-up`, with a compass); `user-view` has north at the top and a \
                 symbol that shows where the main eye looks.",
                "\"head-up\"",
            ), Word, LocalView::Map { mode, .. } => mode),
            part!(LocalView, key(
                "height_m",
                Kind::Number { min: 1e-3, max: 1e7 },
                "500.0",
                "m",
                "Metres of ground from its lower to its upper border.",
                "800.0",
            ), Same, LocalView::Map { height_m, .. } => height_m),
            part!(LocalView, key(
                "magnification",
                Kind::Number { min: 1.0, max: MOST_MAGNIFIED },
                "1.0",
                "",
                "Fisheye: how many times larger its middle is than without; what is at its border is as much smaller.",
                "2.5",
            ), Same, LocalView::Map { magnification, .. } => magnification),
            part!(LocalView, key(
                "lazy",
                Kind::Number { min: 0.0, max: 1.0 },
                "0.0",
                "",
                "Lazy tracking: how far the main eye may move from the middle before the map follows, as a share of the way to the border. \
                 A single picture has the eye in the middle; `animate` lets the map keep still.",
                "0.5",
            ), Same, LocalView::Map { lazy, .. } => lazy),
        ]
    ),
    variant!(
        LocalView,
        "worldlet",
        "A small model that can be turned: the first point of interest and what is near it, alone.",
        LocalView::Worldlet {
            azimuth: 215_f64.to_radians(),
            elevation: 30_f64.to_radians(),
            margin_m: 0.0,
            fov_y: DEFAULT_FOV
        },
        LocalView::Worldlet { .. },
        &[
            kind!("worldlet", "Which eye.", "the first that its kind of lens may have"),
            part!(LocalView, key(
                "azimuth_deg",
                Kind::Number { min: -FAR_M, max: FAR_M },
                "215.0",
                "degrees",
                "Where it is looked at from, clockwise from north.",
                "135.0",
            ), Degrees, LocalView::Worldlet { azimuth, .. } => azimuth),
            part!(LocalView, key(
                "elevation_deg",
                Kind::Number { min: -90.0, max: 90.0 },
                "30.0",
                "degrees",
                "And how far from above.",
                "60.0",
            ), Degrees, LocalView::Worldlet { elevation, .. } => elevation),
            part!(LocalView, key(
                "margin",
                Kind::Number { min: 0.0, max: FAR_M },
                "0.0",
                "m",
                "How much around the object belongs to it, in plan.",
                "25.0",
            ), Same, LocalView::Worldlet { margin_m, .. } => margin_m),
            part!(LocalView, FOV, Degrees, LocalView::Worldlet { fov_y, .. } => fov_y),
        ]
    ),
    variant!(
        LocalView,
        "follow",
        "The first point of interest, followed from behind the direction that it moves in: it is in the middle, and what lies before it \
              above. Behind a point of interest that does not move, or straight up or down, is the side of the main eye.",
        LocalView::Follow { distance_m: 40.0, height_m: 25.0, fov_y: DEFAULT_FOV },
        LocalView::Follow { .. },
        &[
            kind!("follow", "Which eye.", "the first that its kind of lens may have"),
            part!(LocalView, key(
                "distance_m",
                Kind::Number { min: 0.0, max: FAR_M },
                "40.0",
                "m",
                "How far behind it, in plan.",
                "60.0",
            ), Same, LocalView::Follow { distance_m, .. } => distance_m),
            part!(LocalView, key("height_m", Kind::Number { min: 0.001, max: FAR_M }, "25.0", "m", "How far above it.", "12.0"), Same, LocalView::Follow { height_m, .. } => height_m),
            part!(LocalView, FOV, Degrees, LocalView::Follow { fov_y, .. } => fov_y),
        ]
    ),
    variant!(
        LocalView,
        "onboard",
        "From the first point of interest, level, to where it moves; from one that does not move, or straight up or down, to where the \
              main eye looks.",
        LocalView::Onboard { azimuth: 0.0, height_m: 0.0, fov_y: DEFAULT_FOV },
        LocalView::Onboard { .. },
        &[
            kind!("onboard", "Which eye.", "the first that its kind of lens may have"),
            part!(LocalView, key(
                "azimuth_deg",
                Kind::Number { min: -FAR_M, max: FAR_M },
                "0.0",
                "degrees",
                "Clockwise from there: 90 looks to its right, 180 back.",
                "180.0",
            ), Degrees, LocalView::Onboard { azimuth, .. } => azimuth),
            part!(LocalView, key(
                "height_m",
                Kind::Number { min: -FAR_M, max: FAR_M },
                "0.0",
                "m",
                "How far the eye is above it.",
                "1.7",
            ), Same, LocalView::Onboard { height_m, .. } => height_m),
            part!(LocalView, FOV, Degrees, LocalView::Onboard { fov_y, .. } => fov_y),
        ]
    ),
    variant!(
        LocalView,
        "camera",
        "Any eye; its keys are those of `[camera]`.",
        LocalView::Camera { camera: NOWHERE, above_ground: false },
        LocalView::Camera { .. },
        &[
            kind!("camera", "Which eye.", "the first that its kind of lens may have"),
            Row::<LocalView>::joint(CAMERA.keys[0], |own, options| camera_key(own, "eye", options)).always(),
            Row::<LocalView>::joint(CAMERA.keys[1], |own, options| camera_key(own, "target", options)).always(),
            Row::<LocalView>::joint(CAMERA.keys[2], |own, options| camera_key(own, "up", options)).always(),
            Row::<LocalView>::joint(CAMERA.keys[3], |own, options| camera_key(own, "projection", options)).always(),
            Row::<LocalView>::joint(CAMERA.keys[4], |own, options| camera_key(own, "fov_deg", options)).always(),
            Row::<LocalView>::joint(CAMERA.keys[5], |own, options| camera_key(own, "height_m", options)).always(),
            Row::<LocalView>::joint(CAMERA.keys[6], |own, options| camera_key(own, "near_m", options)).always(),
            Row::<LocalView>::joint(CAMERA.keys[7], |own, options| camera_key(own, "above_ground", options)),
        ]
    ),
];

/// `look` of a lens.
pub const LOOK: Table =
    Table { name: "look", doc: "How the view of a best-view lens looks.", keys: keys_of!(LOOK_ROWS) };

const LOOK_ROWS: &[Row<Look>] = &[
    field!(key("look", LOOKS, "\"natural\"", "", "As `look` of `[style]`.", "\"paper\"",), Word, |look: Look| look
        .look),
    field!(
        key(
            "base",
            Kind::Word { now: &["natural", "clay"], later: &[] },
            "\"natural\"",
            "",
            "As `base` of `[style]`.",
            "\"clay\"",
        ),
        Word,
        |look: Look| look.base
    ),
    Row::<Look>::new(
        key("effects", Kind::Effects, "none", "", "As `effects` of `[style]`.", "[\"sepia\"]"),
        |look, _| effects::listed(&look.effects),
        |look, given| look.effects = effects::of_context(given),
    ),
    field!(
        key("background", Kind::Background, "\"sky\"", "", "As `background` of `[style]`.", "\"#ffffff\""),
        Behind,
        |look: Look| look.background
    ),
];

/// The keys of a lens that only lenses with an overlay have, beside `poi`.
pub const OWN: [&str; 5] = ["image", "text", "view", "lenses", "look"];

/// The keys of a lens that have no meaning for one with an overlay.
pub const NOT_OWN: [&str; 14] = [
    "placement",
    "attached_to",
    "above_ground",
    "shape",
    "shapes",
    "effects",
    "content",
    "clip",
    "space",
    "body",
    "sprite",
    "border",
    "shadows",
    "section",
];

/// An eye that is nowhere yet.
const NOWHERE: Camera = Camera {
    eye: DVec3::ZERO,
    target: DVec3::ZERO,
    up: DVec3::Z,
    projection: Projection::Perspective { fov_y: DEFAULT_FOV },
    near_m: 0.0,
};

/// The axes of a direction that are not the camera's.
const WORLD: &str = "world";
/// The view with the keys of a camera.
const CAMERA_VIEW: &str = "camera";

/// A key of the camera that a view is.
fn camera_key(view: &LocalView, key: &str, options: &Options) -> Option<Data> {
    let &LocalView::Camera { camera, above_ground } = view else { return None };
    Node::of(camera::written(&Eye { camera, above_ground }, options)).entry(key).map(|node| node.data.clone())
}

/// The view of a lens of this kind; noted and `None` where something is wrong.
fn read_view(reader: &mut Reader, fields: &Fields, kind: &LensKind) -> Option<LocalView> {
    let words = kind.row().views;
    let empty = Node::empty_table(fields.place.line);
    let node = fields.node("view").unwrap_or(&empty);
    let line = if fields.given("view") { node.line } else { fields.place.line };
    let place = fields.place.within("view", line);
    let word = match node.entry("kind") {
        None => words.first().copied()?,
        Some(n) => match n.text().and_then(|text| words.iter().find(|word| **word == text)) {
            Some(word) => *word,
            None => {
                let hint = did_you_mean(n.text().unwrap_or_default(), words.iter().copied());
                let all = words.join(", ");
                let message =
                    format!("must be one of {all} for a lens of kind \"{}\", is {}{hint}", kind.word(), n.quoted());
                reader.checker.note(&place, "kind", n.line, message);
                return None;
            }
        },
    };
    let view = VIEW_KINDS.iter().find(|view| view.table.name == word)?;
    let own = reader.checker.fields(node, &view.table, &[], place);
    match word {
        CAMERA_VIEW => {
            camera::read(reader, &own).map(|Eye { camera, above_ground }| LocalView::Camera { camera, above_ground })
        }
        _ => view.read(&own, reader),
    }
}

/// What the overlay of a lens shows, if its kind has one.
pub fn read(reader: &mut Reader, fields: &Fields, kind: &LensKind) -> Option<BestView> {
    let given = |key: &&str| fields.given(key);
    if !kind.has_overlay() {
        for key in OWN.into_iter().filter(given) {
            let message = "has a meaning only for lenses that have an overlay: annotation, best-view, map-view, worldlet, see-through, portal";
            reader.checker.note(&fields.place, key, fields.line(key), message);
        }
        return None;
    }
    for key in NOT_OWN.into_iter().filter(given) {
        let word = kind.word();
        let message = match key {
            "effects" => format!(
                "has no meaning for a lens of kind \"{word}\"; what acts on all of its view stands in look = {{ effects = [...] }}"
            ),
            _ => format!("has no meaning for a lens of kind \"{word}\", which has an overlay and no focus area"),
        };
        reader.checker.note(&fields.place, key, fields.line(key), message);
    }
    let depiction = depiction(reader, fields, kind);
    let of_view = ["view", "lenses", "look"].into_iter().map(|key| (key, kind.row().is_note));
    let of_annotation = ["image", "text"].into_iter().map(|key| (key, !kind.row().is_note));
    for (key, is_wrong) in of_view.chain(of_annotation) {
        if is_wrong && fields.given(key) {
            let message = format!("has no meaning for a lens of kind \"{}\"", kind.word());
            reader.checker.note(&fields.place, key, fields.line(key), message);
        }
    }
    let look = fields.node("look").map(|node| {
        let own = reader.checker.fields(node, &LOOK, &[], fields.place.within("look", node.line));
        let mut look = PLAIN_LOOK;
        row::read(LOOK_ROWS, &own, reader, &mut look);
        look
    });
    Some(BestView {
        pois: fields.node("poi").map(Node::names).unwrap_or_default(),
        depiction: depiction.unwrap_or_else(|| Depiction::Text(String::new())),
        lenses: fields.node("lenses").map(Node::texts),
        look,
    })
}

/// What an overlay shows; noted and `None` where something is wrong.
fn depiction(reader: &mut Reader, fields: &Fields, kind: &LensKind) -> Option<Depiction> {
    match (kind.row().is_note, fields.node("image").and_then(Node::text), fields.text("text")) {
        (true, Some(_), Some(_)) => {
            let message = "is given together with image: an annotation is one of them; a caption stands in [[overlay]]";
            reader.checker.note(&fields.place, "text", fields.line("text"), message);
            None
        }
        (true, Some(_), None) => reader.file(fields, "image").map(Depiction::Image),
        (true, None, Some(text)) => Some(Depiction::Text(text.to_owned())),
        (true, None, None) => {
            if !fields.given("image") && !fields.given("text") {
                let message = "is missing: an annotation shows image = \"FILE\" or text = \"...\"";
                reader.checker.note(&fields.place, "image", fields.place.line, message);
            }
            None
        }
        _ => read_view(reader, fields, kind).map(Depiction::View),
    }
}

/// A look of which nothing is said.
const PLAIN_LOOK: Look =
    Look { look: StyleLook::Natural, base: BaseStyle::Natural, effects: Vec::new(), background: Background::Sky };

/// `poi` of a lens with an overlay.
pub fn pois(shown: &BestView) -> Option<Data> {
    if shown.pois.is_empty() { None } else { Names::data(&shown.pois) }
}

/// `look`.
pub fn look(shown: &BestView, options: &Options) -> Option<Data> {
    shown.look.as_ref().map(|look| row::written(LOOK_ROWS, look, &PLAIN_LOOK, options))
}

/// `view`, of a lens of this kind.
pub fn view(kind: &LensKind, shown: &BestView, options: &Options) -> Option<Data> {
    let view = shown.view()?;
    let own = Variant::of(VIEW_KINDS, view)?;
    let Data::Table(mut entries) = own.written(view, options) else { return None };
    let is_default = kind.row().views.first() == Some(&own.table.name);
    if is_default && entries.len() > 1 {
        entries.retain(|(key, ..)| key != "kind");
    }
    Some(Data::Table(entries))
}
