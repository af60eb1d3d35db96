//! What best-view lenses show in scene files: its tables, read and written.

use glam::DVec3;

use crate::{
    figure::scene_file::{
        check::{Checker, Fields},
        keys::{CAMERA, FAR_M, Key, Kind, Table, key},
        node::Node,
        paths::Options,
        write::{camera_keys, degrees, effect, list, number, point, quoted, write_color},
    },
    lens::{
        LensKind,
        best_view::{
            Background, BaseStyle, BestView, DEFAULT_FOV, Depiction, LocalView, Look, MOST_MAGNIFIED, MapMode,
        },
        nearest::did_you_mean,
    },
    view::Camera,
};

const fn view_kind(name: &'static str) -> Key {
    key("kind", Kind::Text, "the first that its kind of lens may have", "", "Which eye.", name)
}

const FOV: Key =
    key("fov_deg", Kind::Number { min: 0.01, max: 179.0 }, "45.0", "degrees", "Vertical field of view.", "30.0");

const MAP_MODES: [&str; 3] = [MapMode::WORDS[0].0, MapMode::WORDS[1].0, MapMode::WORDS[2].0];

/// All eyes of their own.
pub const VIEWS: &[Table] = &[
    Table {
        name: "best",
        doc: "All of the first point of interest: the sphere around it fills the overlay. What is nearer to this eye than that sphere is \
              left out, so that nothing hides it; where the eye is chosen and less than a tenth of the object is hidden, it stays.",
        keys: &[
            view_kind("\"best\""),
            key(
                "normal",
                Kind::Direction,
                "where most of its facades is seen from",
                "",
                "The direction from the object to the eye (best-view normal), of any length but 0.",
                "[-1.0, -1.0, 0.5]",
            ),
            FOV,
        ],
    },
    Table {
        name: "mcop",
        doc: "The main eye, looked at from outside (multiple centres of projection).",
        keys: &[
            view_kind("\"mcop\""),
            key(
                "normal",
                Kind::Direction,
                "[0, 0, 1]",
                "",
                "The direction from the main eye to this one, of any length but 0.",
                "[0, -1, 1]",
            ),
            key("distance", Kind::Number { min: 1e-3, max: FAR_M }, "", "m", "How far from the main eye.", "250.0"),
            FOV,
        ],
    },
    Table {
        name: "scop",
        doc: "From the main eye in another direction (single centre of projection): a rear-view mirror, a look aside.",
        keys: &[
            view_kind("\"scop\""),
            key(
                "direction",
                Kind::Direction,
                "[0, 0, 1], backwards",
                "",
                "Where it looks, of any length but 0.",
                "[1, 0, 0]",
            ),
            key(
                "axes",
                Kind::Word { now: &["camera", "world"], later: &[] },
                "\"camera\"",
                "",
                "The axes of `direction`: the main camera's (x to the right, y up, z towards whoever looks) or the model's.",
                "\"world\"",
            ),
            key("mirror", Kind::Boolean, "false", "", "Exchanges left and right, as a mirror does.", "true"),
            FOV,
        ],
    },
    Table {
        name: "map",
        doc: "A map of what lies around the main eye, seen straight from above.",
        keys: &[
            view_kind("\"map\""),
            key(
                "mode",
                Kind::Word { now: &MAP_MODES, later: &[] },
                "\"north-up\"",
                "",
                "What is at its top: north, or where the main eye looks (`head-up`, with a compass); `user-view` has north at the top and a \
                 symbol that shows where the main eye looks.",
                "\"head-up\"",
            ),
            key(
                "height_m",
                Kind::Number { min: 1e-3, max: 1e7 },
                "500.0",
                "m",
                "Metres of ground from its lower to its upper border.",
                "800.0",
            ),
            key(
                "magnification",
                Kind::Number { min: 1.0, max: MOST_MAGNIFIED },
                "1.0",
                "",
                "Fisheye: how many times larger its middle is than without; what is at its border is as much smaller.",
                "2.5",
            ),
            key(
                "lazy",
                Kind::Number { min: 0.0, max: 1.0 },
                "0.0",
                "",
                "Lazy tracking: how far the main eye may move from the middle before the map follows, as a share of the way to the border. \
                 A single picture has the eye in the middle; `animate` lets the map keep still.",
                "0.5",
            ),
        ],
    },
    Table {
        name: "worldlet",
        doc: "A small model that can be turned: the first point of interest and what is near it, alone.",
        keys: &[
            view_kind("\"worldlet\""),
            key(
                "azimuth_deg",
                Kind::Number { min: -FAR_M, max: FAR_M },
                "215.0",
                "degrees",
                "Where it is looked at from, clockwise from north.",
                "135.0",
            ),
            key(
                "elevation_deg",
                Kind::Number { min: -90.0, max: 90.0 },
                "30.0",
                "degrees",
                "And how far from above.",
                "60.0",
            ),
            key(
                "margin",
                Kind::Number { min: 0.0, max: FAR_M },
                "0.0",
                "m",
                "How much around the object belongs to it, in plan.",
                "25.0",
            ),
            FOV,
        ],
    },
    Table {
        name: "follow",
        doc: "The first point of interest, followed from behind the direction that it moves in: it is in the middle, and what lies before it \
              above. Behind a point of interest that does not move, or straight up or down, is the side of the main eye.",
        keys: &[
            view_kind("\"follow\""),
            key(
                "distance_m",
                Kind::Number { min: 0.0, max: FAR_M },
                "40.0",
                "m",
                "How far behind it, in plan.",
                "60.0",
            ),
            key("height_m", Kind::Number { min: 0.001, max: FAR_M }, "25.0", "m", "How far above it.", "12.0"),
            FOV,
        ],
    },
    Table {
        name: "onboard",
        doc: "From the first point of interest, level, to where it moves; from one that does not move, or straight up or down, to where the \
              main eye looks.",
        keys: &[
            view_kind("\"onboard\""),
            key(
                "azimuth_deg",
                Kind::Number { min: -FAR_M, max: FAR_M },
                "0.0",
                "degrees",
                "Clockwise from there: 90 looks to its right, 180 back.",
                "180.0",
            ),
            key(
                "height_m",
                Kind::Number { min: -FAR_M, max: FAR_M },
                "0.0",
                "m",
                "How far the eye is above it.",
                "1.7",
            ),
            FOV,
        ],
    },
    Table {
        name: "camera",
        doc: "Any eye; its keys are those of `[camera]`.",
        keys: &[
            view_kind("\"camera\""),
            CAMERA.keys[0],
            CAMERA.keys[1],
            CAMERA.keys[2],
            CAMERA.keys[3],
            CAMERA.keys[4],
            CAMERA.keys[5],
            CAMERA.keys[6],
        ],
    },
];

/// `look` of a lens.
pub const LOOK: Table = Table {
    name: "look",
    doc: "How the view of a best-view lens looks.",
    keys: &[
        key(
            "base",
            Kind::Word { now: &["natural", "clay"], later: &[] },
            "\"natural\"",
            "",
            "As `base` of `[style]`.",
            "\"clay\"",
        ),
        key("effects", Kind::Effects, "none", "", "As `effects` of `[style]`.", "[\"sepia\"]"),
        key("background", Kind::Background, "\"sky\"", "", "As `background` of `[style]`.", "\"#ffffff\""),
    ],
};

/// The keys of a lens that only lenses with an overlay have, beside `poi`.
pub const OWN: [&str; 5] = ["image", "text", "view", "lenses", "look"];

/// The keys of a lens that have no meaning for one with an overlay.
pub const NOT_OWN: [&str; 13] = [
    "placement",
    "attached_to",
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

/// The words of the views that a kind of lens may have, the default first; empty: it has none.
pub fn views_of(kind: LensKind) -> &'static [&'static str] {
    match kind {
        LensKind::BestView => &["best", "mcop", "scop", "follow", "onboard", "camera"],
        LensKind::MapView => &["map"],
        LensKind::Worldlet => &["worldlet"],
        LensKind::SeeThrough | LensKind::Portal => &["camera"],
        _ => &[],
    }
}

/// The view of a lens of this kind; noted and `None` where something is wrong.
pub fn read_view(
    checker: &mut Checker,
    fields: &Fields,
    kind: LensKind,
    camera: impl Fn(&mut Checker, &Fields) -> Option<Camera>,
) -> Option<LocalView> {
    let words = views_of(kind);
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
                checker.note(&place, "kind", n.line, message);
                return None;
            }
        },
    };
    let own = checker.fields(node, VIEWS.iter().find(|table| table.name == word)?, &[], place);
    let fov_y = own.number("fov_deg").map_or(DEFAULT_FOV, f64::to_radians);
    Some(match word {
        "best" => LocalView::Best { normal: own.point("normal"), fov_y },
        "mcop" => LocalView::Mcop {
            normal: own.point("normal").unwrap_or(DVec3::Z),
            distance_m: own.number("distance")?,
            fov_y,
        },
        "scop" => LocalView::Scop {
            direction: own.point("direction").unwrap_or(DVec3::Z),
            of_camera: own.text("axes") != Some("world"),
            mirror: own.boolean("mirror").unwrap_or(false),
            fov_y,
        },
        "map" => LocalView::Map {
            mode: MapMode::WORDS
                .iter()
                .find(|(w, _)| own.text("mode") == Some(*w))
                .map_or_else(Default::default, |(_, m)| *m),
            height_m: own.number("height_m").unwrap_or(500.0),
            magnification: own.number("magnification").unwrap_or(1.0),
            lazy: own.number("lazy").unwrap_or(0.0),
        },
        "worldlet" => LocalView::Worldlet {
            azimuth: own.number("azimuth_deg").unwrap_or(215.0).to_radians(),
            elevation: own.number("elevation_deg").unwrap_or(30.0).to_radians(),
            margin_m: own.number("margin").unwrap_or(0.0),
            fov_y,
        },
        "follow" => LocalView::Follow {
            distance_m: own.number("distance_m").unwrap_or(40.0),
            height_m: own.number("height_m").unwrap_or(25.0),
            fov_y,
        },
        "onboard" => LocalView::Onboard {
            azimuth: own.number("azimuth_deg").unwrap_or(0.0).to_radians(),
            height_m: own.number("height_m").unwrap_or(0.0),
            fov_y,
        },
        _ => LocalView::Camera(camera(checker, &own)?),
    })
}

/// The keys of what a best-view lens shows.
pub(super) fn written(kind: LensKind, shown: &BestView, options: &Options) -> Vec<(&'static str, String)> {
    let names = |names: &[String]| match names {
        [one] => quoted(one),
        all => list(all.iter().map(|name| quoted(name))),
    };
    let mut keys = Vec::new();
    if !shown.pois.is_empty() {
        keys.push(("poi", names(&shown.pois)));
    }
    match &shown.depiction {
        Depiction::Image(file) => keys.push(("image", quoted(&options.written(file)))),
        Depiction::Text(text) => keys.push(("text", quoted(text))),
        Depiction::View(view) => {
            let (word, own) = view_keys(view);
            let is_default = views_of(kind).first() == Some(&word);
            let head = (!is_default || own.is_empty()).then(|| format!("kind = {}", quoted(word)));
            let own = own.into_iter().map(|(key, value)| format!("{key} = {value}"));
            let all: Vec<String> = head.into_iter().chain(own).collect();
            keys.push(("view", format!("{{ {} }}", all.join(", "))));
        }
    }
    if let Some(lenses) = &shown.lenses {
        keys.push(("lenses", list(lenses.iter().map(|name| quoted(name)))));
    }
    if let Some(look) = &shown.look {
        let mut own = Vec::new();
        if look.base == BaseStyle::Clay {
            own.push("base = \"clay\"".to_owned());
        }
        if !look.effects.is_empty() {
            own.push(format!("effects = {}", list(look.effects.iter().map(effect))));
        }
        if let Background::Color(c) = look.background {
            own.push(format!("background = {}", write_color(c)));
        }
        keys.push(("look", if own.is_empty() { "{}".to_owned() } else { format!("{{ {} }}", own.join(", ")) }));
    }
    keys
}

fn view_keys(view: &LocalView) -> (&'static str, Vec<(&'static str, String)>) {
    let fov = |fov_y: f64| (fov_y != DEFAULT_FOV).then(|| ("fov_deg", number(degrees(fov_y))));
    match view {
        LocalView::Best { normal, fov_y } => {
            ("best", normal.map(|n| ("normal", point(n))).into_iter().chain(fov(*fov_y)).collect())
        }
        LocalView::Mcop { normal, distance_m, fov_y } => {
            let normal = (*normal != DVec3::Z).then(|| ("normal", point(*normal)));
            let distance = ("distance", number(*distance_m));
            ("mcop", normal.into_iter().chain([distance]).chain(fov(*fov_y)).collect())
        }
        LocalView::Scop { direction, of_camera, mirror, fov_y } => {
            let direction = (*direction != DVec3::Z).then(|| ("direction", point(*direction)));
            let axes = (!of_camera).then(|| ("axes", quoted("world")));
            let mirror = mirror.then(|| ("mirror", "true".to_owned()));
            ("scop", direction.into_iter().chain(axes).chain(mirror).chain(fov(*fov_y)).collect())
        }
        LocalView::Map { mode, height_m, magnification, lazy } => {
            let word = MapMode::WORDS.iter().find(|(_, m)| m == mode).map_or("north-up", |(word, _)| word);
            let mode = (*mode != MapMode::default()).then(|| ("mode", quoted(word)));
            let magnification = (*magnification != 1.0).then(|| ("magnification", number(*magnification)));
            let lazy = (*lazy != 0.0).then(|| ("lazy", number(*lazy)));
            (
                "map",
                mode.into_iter().chain([("height_m", number(*height_m))]).chain(magnification).chain(lazy).collect(),
            )
        }
        LocalView::Worldlet { azimuth, elevation, margin_m, fov_y } => {
            let mut keys =
                vec![("azimuth_deg", number(degrees(*azimuth))), ("elevation_deg", number(degrees(*elevation)))];
            if *margin_m != 0.0 {
                keys.push(("margin", number(*margin_m)));
            }
            keys.extend(fov(*fov_y));
            ("worldlet", keys)
        }
        LocalView::Follow { distance_m, height_m, fov_y } => {
            let own = [("distance_m", number(*distance_m)), ("height_m", number(*height_m))];
            ("follow", own.into_iter().chain(fov(*fov_y)).collect())
        }
        LocalView::Onboard { azimuth, height_m, fov_y } => {
            let own = [("azimuth_deg", number(degrees(*azimuth))), ("height_m", number(*height_m))];
            ("onboard", own.into_iter().chain(fov(*fov_y)).collect())
        }
        LocalView::Camera(camera) => ("camera", camera_keys(camera)),
    }
}

/// The look of a view.
pub fn look(fields: &Fields, effects: Vec<crate::lens::EffectUse>) -> Look {
    Look {
        base: if fields.text("base") == Some("clay") { BaseStyle::Clay } else { BaseStyle::Natural },
        effects,
        background: fields.color("background").map_or(Background::Sky, Background::Color),
    }
}
