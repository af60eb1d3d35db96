//! `[animation]` of scene files: its keys, read and written.

use glam::DVec3;

use crate::{
    figure::scene_file::{
        camera::{CAMERA, DEFAULT_FOV_DEG},
        check::{Checker, Fields, Place},
        content::CONTENT,
        epoch::moment,
        forms::{Degrees, Form as _, Same, Word, numbers},
        keys::{Kind, Table, key},
        node::{Data, Node},
        paths::Options,
        poi::POI,
        reader::Reader,
        row::{self, Row, field, keys_of},
        shape_keys::SHAPES,
    },
    lens::nearest::did_you_mean,
    scene::{
        Scene,
        animation::{Animation, Change, ChangeKey, FPS, MOMENTS_S, MOST_FRAMES, Track},
    },
    time::Moment,
    view::{
        Camera, Projection,
        path::{CameraKey, CameraPath, PathError, Speed},
    },
};

/// Latest time of a key, seconds.
const LATEST_S: f64 = 1e6;
/// What an animation can change, by the first word of the way to it.
const CHANGED: [&str; 5] = ["lens", "poi", "style", "sun", "volume"];

const AT: Kind = Kind::Number { min: 0.0, max: LATEST_S };
const SPEED: Kind = Kind::Word { now: &["keys", "constant"], later: &[] };

/// `[animation]`.
pub const ANIMATION: Table = Table {
    name: "animation",
    doc: "What changes from frame to frame of `veduta animate`: the camera along a path, and numbers along theirs; see Animations. \
          Pictures by `veduta render` show nothing of it.",
    keys: keys_of!(ANIMATION_ROWS),
};

const ANIMATION_ROWS: &[Row<Animation>] = &[
    field!(
        key(
            "frames",
            Kind::Integer { min: 1, max: MOST_FRAMES as i64 },
            "up to the last key, and until all that moves has arrived or gone round",
            "",
            "How many pictures; frame i, from 0, is at i / `fps` seconds.",
            "300",
        ),
        Same,
        |animation: Animation| animation.frames
    )
    .always(),
    field!(
        key("fps", Kind::Number { min: 0.01, max: 1000.0 }, "30.0", "per second", "Pictures per second.", "25.0"),
        Same,
        |animation: Animation| animation.fps
    )
    .always(),
    field!(
        key(
            "speed",
            SPEED,
            "\"keys\"",
            "",
            "How the camera's path is followed: each key at its time (`keys`), or from the first to the last at one speed (`constant`), \
             when the times between say nothing.",
            "\"constant\"",
        ),
        Word,
        |animation: Animation| animation.speed
    ),
    Row::<Animation>::joint(
        key(
            "camera",
            Kind::Tables(&CAMERA_KEY),
            "it stays",
            "",
            "Where the camera is when.",
            "[{ at = 0.0, eye = [0, -90, 60], target = [0, 0, 5] }, { at = 4.0, eye = [90, 0, 60], target = [0, 0, 5] }]",
        ),
        |animation, options| {
            (!animation.camera.is_empty()).then(|| {
                Data::list(animation.camera.iter().map(|key| row::written(CAMERA_KEY_ROWS, key, &NOWHERE, options)))
            })
        },
    ),
    Row::<Animation>::joint(
        key(
            "change",
            Kind::Tables(&CHANGE),
            "nothing",
            "",
            "What else changes.",
            "[{ path = \"lens.a.shape.radius\", keys = [{ at = 0.0, value = 20.0 }, { at = 4.0, value = 60.0 }] }]",
        ),
        |animation, options| {
            (!animation.changes.is_empty()).then(|| {
                Data::list(animation.changes.iter().map(|change| row::written(CHANGE_ROWS, change, &still(), options)))
            })
        },
    ),
    Row::<Animation>::joint(
        key(
            "from",
            Kind::Moment,
            "none: the scene's moment stays",
            "",
            "The moment of the calendar that the first frame shows, in place of `[time] at`; with `until`.",
            "\"1400\"",
        ),
        |animation, _| animation.moments.map(|[first, _]| Data::Text(first.written())),
    ),
    Row::<Animation>::joint(
        key(
            "until",
            Kind::Moment,
            "none",
            "",
            "The moment that the last frame shows; those between show moments evenly between. Without `frames` and keys it takes ten seconds.",
            "\"2025\"",
        ),
        |animation, _| animation.moments.map(|[_, last]| Data::Text(last.written())),
    ),
];

/// An element of `camera` of `[animation]`.
pub const CAMERA_KEY: Table = Table {
    name: "camera",
    doc: "The camera at a time. It goes through the keys on a centripetal Catmull-Rom curve. What a key does not say is as in \
          `[camera]`.",
    keys: keys_of!(CAMERA_KEY_ROWS),
};

const CAMERA_KEY_ROWS: &[Row<CameraKey>] = &[
    field!(key("at", AT, "", "s", "When, later than the key before.", "2.5"), Same, |key: CameraKey| key.at),
    field!(CAMERA.keys[0], Same, |key: CameraKey| key.eye),
    field!(CAMERA.keys[1], Same, |key: CameraKey| key.target),
    field!(
        key("up", Kind::Direction, "that of `[camera]`", "", "What is up in the picture.", "[0, 0, 1]"),
        Same,
        |key: CameraKey| key.up
    )
    .always(),
    Row::<CameraKey>::joint(
        key(
            "fov_deg",
            Kind::Number { min: 0.01, max: 179.0 },
            "that of `[camera]`, else 45.0",
            "degrees",
            "Vertical field of view.",
            "60.0",
        ),
        |key, _| match &key.projection {
            Projection::Perspective { fov_y } => Degrees::data(fov_y),
            Projection::Orthographic { .. } => None,
        },
    )
    .always(),
    Row::<CameraKey>::joint(
        key(
            "height_m",
            Kind::Number { min: 0.001, max: 1e7 },
            "that of `[camera]`",
            "m",
            "Height of the picture, where `[camera]` is orthographic.",
            "250.0",
        ),
        |key, _| match key.projection {
            Projection::Orthographic { height_m } => Some(height_m.into()),
            Projection::Perspective { .. } => None,
        },
    )
    .always(),
];

/// An element of `change` of `[animation]`.
pub const CHANGE: Table = Table {
    name: "change",
    doc: "A number, or a list of numbers, of a lens, a point of interest, the style or the sun over time.",
    keys: keys_of!(CHANGE_ROWS),
};

const CHANGE_ROWS: &[Row<Change>] = &[
    field!(
        key(
            "path",
            Kind::Text,
            "",
            "",
            "The way to it, as `--set` has it; it begins with `lens`, `poi`, `style` or `sun`.",
            "\"lens.a.shape.center\"",
        ),
        Same,
        |change: Change| change.path
    ),
    Row::<Change>::joint(
        key(
            "keys",
            Kind::Tables(&CHANGE_KEY),
            "",
            "",
            "What it is when. Places (`center`, `at`, `from`, `to` ...) go through them on a curve, as the camera does; all else goes from \
             key to key and never beyond them.",
            "[{ at = 0.0, value = 20.0 }, { at = 4.0, value = 60.0 }]",
        ),
        |change, options| {
            Some(Data::list(change.keys.iter().map(|key| row::written(CHANGE_KEY_ROWS, key, key, options))))
        },
    ),
    field!(
        key(
            "speed",
            SPEED,
            "\"keys\"",
            "",
            "How the path of a place is followed, as that of the camera.",
            "\"constant\"",
        ),
        Word,
        |change: Change| change.speed
    ),
];

/// An element of `keys` of a change.
pub const CHANGE_KEY: Table = Table { name: "keys", doc: "A value at a time.", keys: keys_of!(CHANGE_KEY_ROWS) };

const CHANGE_KEY_ROWS: &[Row<ChangeKey>] = &[
    field!(key("at", AT, "", "s", "When, later than the key before.", "2.5"), Same, |key: ChangeKey| key.at),
    field!(
        key(
            "value",
            Kind::Numbers,
            "",
            "",
            "What it is: a number or a list of numbers, in all keys of one form. Texts and `true` or `false` have nothing between them.",
            "[10.0, 20.0, 3.0]",
        ),
        Same,
        |key: ChangeKey| key.value
    ),
];

/// Whether the last word of a way is the name of a place.
fn is_place(path: &str) -> bool {
    let last = path.rsplit('.').next().unwrap_or_default().trim_matches('"');
    let tables = SHAPES.iter().chain([&CONTENT, &POI, &CAMERA]);
    tables.flat_map(|table| table.keys).any(|key| key.name == last && matches!(key.kind, Kind::Point))
}

/// An animation of which nothing is said.
const PLAIN: Animation =
    Animation { frames: 0, fps: FPS, speed: Speed::Keys, camera: Vec::new(), changes: Vec::new(), moments: None };

/// A camera of which nothing is said yet.
const NOWHERE: CameraKey = CameraKey {
    at: 0.0,
    eye: DVec3::ZERO,
    target: DVec3::ZERO,
    up: DVec3::Z,
    projection: Projection::Perspective { fov_y: 0.0 },
};

/// A change of nothing.
fn still() -> Change {
    Change { is_place: false, path: String::new(), speed: Speed::Keys, keys: Vec::new() }
}

/// Reads the table of a scene of which all else is read: keys fall back on its camera.
pub fn read(reader: &mut Reader, fields: &Fields, scene: &Scene) -> Option<Animation> {
    let camera = scene.camera.as_ref();
    let mut animation = PLAIN;
    row::read(ANIMATION_ROWS, fields, reader, &mut animation);
    let checker = &mut reader.checker;
    let before = checker.problems.len();
    animation.camera = camera_keys(checker, fields, camera, animation.speed);
    animation.changes = elements(fields, "change")
        .into_iter()
        .filter_map(|(key, node)| change(reader, &fields.place.within(&key, node.line), node))
        .collect();
    animation.moments = moments(reader, fields);
    if reader.checker.problems.len() > before {
        return None;
    }
    if fields.given("frames") {
        return Some(animation);
    }
    let last_camera = animation.camera.iter().map(|key| key.at);
    let last = animation.changes.iter().flat_map(|change| change.keys.iter().map(|key| key.at)).chain(last_camera);
    // What moves arrives, or goes round once.
    let arrivals = scene.trajectories.iter().map(|way| (way.end_s() - scene.time_s).clamp(0.0, LATEST_S));
    let last = last.chain(arrivals).chain(animation.moments.map(|_| MOMENTS_S));
    let by_keys = (last.fold(0.0, f64::max) * animation.fps).round() + 1.0;
    if by_keys > f64::from(MOST_FRAMES) {
        let message = format!("is {by_keys} up to the last key; at most {MOST_FRAMES} would be right");
        reader.checker.note(&fields.place, "frames", fields.place.line, message);
    }
    animation.frames = by_keys as u32;
    Some(animation)
}

/// The moments that the first frame and the last one show.
fn moments(reader: &mut Reader, fields: &Fields) -> Option<[Moment; 2]> {
    let of = |key: &str| fields.node(key).and_then(|node| moment(node).ok());
    for (key, other) in [("from", "until"), ("until", "from")] {
        if fields.given(key) && !fields.given(other) {
            let message = format!("is given without {other}: moments go from one to another");
            reader.checker.note(&fields.place, key, fields.line(key), message);
        }
    }
    Some([of("from")?, of("until")?])
}

fn elements<'a>(fields: &Fields<'a>, key: &str) -> Vec<(String, &'a Node)> {
    let list = fields.node(key).and_then(Node::list).unwrap_or_default();
    list.iter().enumerate().map(|(i, node)| (format!("{key}.{i}"), node)).collect()
}

fn camera_keys(checker: &mut Checker, fields: &Fields, camera: Option<&Camera>, speed: Speed) -> Vec<CameraKey> {
    let mut found = Vec::new();
    let mut lines = Vec::new();
    for (key, node) in elements(fields, "camera") {
        let own = checker.fields(node, &CAMERA_KEY, &[], fields.place.within(&key, node.line));
        let default = camera.map(|camera| camera.projection);
        let (given, other) = match default {
            Some(Projection::Orthographic { .. }) => ("height_m", "fov_deg"),
            _ => ("fov_deg", "height_m"),
        };
        if own.given(other) {
            let message = format!("has no meaning in this projection; {given} would be right");
            checker.note(&own.place, other, own.line(other), message);
        }
        let projection = match default {
            Some(Projection::Orthographic { height_m }) => {
                Projection::Orthographic { height_m: own.number("height_m").unwrap_or(height_m) }
            }
            Some(Projection::Perspective { fov_y }) => {
                Projection::Perspective { fov_y: own.number("fov_deg").map_or(fov_y, f64::to_radians) }
            }
            None => Projection::Perspective { fov_y: own.number("fov_deg").unwrap_or(DEFAULT_FOV_DEG).to_radians() },
        };
        let up = own.point("up").or(camera.map(|camera| camera.up)).unwrap_or(DVec3::Z);
        let (Some(at), Some(eye), Some(target)) = (own.number("at"), own.point("eye"), own.point("target")) else {
            continue;
        };
        found.push(CameraKey { at, eye, target, up, projection });
        lines.push(own.place);
    }
    if let Err(error) = CameraPath::new(&found, speed, None)
        && error != PathError::Empty
    {
        let (PathError::Time(i)
        | PathError::Camera(i, _)
        | PathError::OppositeUp(i)
        | PathError::Projection(i)
        | PathError::Rests(i)) = error
        else {
            return found;
        };
        let place = lines.get(i).unwrap_or(&fields.place);
        // The place says which key it is.
        let text = error.to_string();
        let message = text.split_once(": ").map_or(text.as_str(), |(_, message)| message);
        checker.note(place, "", place.line, message);
    }
    found
}

fn change(reader: &mut Reader, place: &Place, node: &Node) -> Option<Change> {
    let fields = reader.checker.fields(node, &CHANGE, &[], place.clone());
    let mut change = still();
    row::read(CHANGE_ROWS, &fields, reader, &mut change);
    if change.path.is_empty() {
        return None;
    }
    change.is_place = is_place(&change.path);
    let checker = &mut reader.checker;
    let first = change.path.split('.').next().unwrap_or_default();
    if !CHANGED.contains(&first) {
        let message = match first {
            "camera" => "the camera has keys of its own: camera = [{ at = ..., eye = ..., target = ... }]".to_owned(),
            "city" | "figure" | "animation" | "veduta" => {
                format!("\"{first}\" is the same in all frames; an animation changes {}", CHANGED.join(", "))
            }
            _ => format!("there is no \"{first}\" in a scene{}", did_you_mean(first, CHANGED)),
        };
        checker.note(&fields.place, "path", fields.line("path"), message);
    }
    for (key, node) in elements(&fields, "keys") {
        let own = checker.fields(node, &CHANGE_KEY, &[], fields.place.within(&key, node.line));
        let (Some(at), Some(value)) = (own.number("at"), own.node("value").and_then(numbers)) else { continue };
        if let Some(before) = change.keys.last() {
            if at <= before.at {
                checker.note(&own.place, "at", own.line("at"), PathError::Time(0).to_string().replace("key 0: ", ""));
            }
            if !value.is_like(&before.value) {
                let message = format!("has another form than {}, that of the key before", before.value);
                checker.note(&own.place, "value", own.line("value"), message);
            }
        }
        change.keys.push(ChangeKey { at, value });
    }
    if change.keys.is_empty() && fields.node("keys").is_some_and(|n| n.list().is_some_and(<[Node]>::is_empty)) {
        checker.note(&fields.place, "keys", fields.line("keys"), "is empty; a change has one key or more");
    }
    if change.speed == Speed::Constant && !change.is_place {
        let message = "has a meaning only for a place, such as a center";
        checker.note(&fields.place, "speed", fields.line("speed"), message);
    }
    Track::new(&change).map(|_| change)
}

/// The table.
pub fn written(animation: &Animation, options: &Options) -> Data {
    row::written(ANIMATION_ROWS, animation, &PLAIN, options)
}

/// Tables of it, for the docs.
pub const TABLES: [(&str, &Table); 4] = [
    ("[animation]", &ANIMATION),
    ("camera of the animation", &CAMERA_KEY),
    ("change of the animation", &CHANGE),
    ("keys of a change", &CHANGE_KEY),
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::scene_file::{Options, parse};

    const SCENE: &str = r#"
veduta = 1
[camera]
eye = [0, -90, 60]
target = [0, 0, 5]
fov_deg = 30.0
[animation]
fps = 10
speed = "constant"
camera = [
  { at = 0.5, eye = [0, -90, 60], target = [0, 0, 5] },
  { at = 2.0, eye = [90, 0, 60], target = [0, 0, 5], fov_deg = 60.0 },
]
[[animation.change]]
path = "lens.\"a.b\".shape.center"
keys = [{ at = 0, value = [0, 0, 0] }, { at = 3.04, value = [9, 0, 0] }]
[[animation.change]]
path = "lens.a.shape.points"
keys = [{ at = 1, value = [[0, 0], [1, 1]] }]
"#;

    fn read(text: &str) -> Result<Animation, String> {
        let scene = parse(text, "s", &Options::for_command_line()).map_err(|error| error.to_string())?;
        Ok(scene.animation.unwrap())
    }

    #[test]
    fn an_animation_is_read_with_what_its_keys_leave_to_the_camera() {
        let found = read(SCENE).unwrap();
        assert_eq!((found.frames, found.fps, found.speed), (31, 10.0, Speed::Constant), "up to the last key");
        let fov = |i: usize| match found.camera[i].projection {
            Projection::Perspective { fov_y } => fov_y.to_degrees().round(),
            Projection::Orthographic { .. } => f64::NAN,
        };
        assert_eq!((fov(0), fov(1), found.camera[0].up), (30.0, 60.0, DVec3::Z));
        let places: Vec<bool> = found.changes.iter().map(|change| change.is_place).collect();
        assert_eq!(places, [true, false]);
        assert_eq!(found.changes[1].keys[0].value.to_string(), "[[0.0, 0.0], [1.0, 1.0]]");
        let flat = SCENE
            .replace("fov_deg = 30.0", "projection = \"orthographic\"\nheight_m = 7")
            .replace(", fov_deg = 60.0", "");
        let flat = read(&flat).unwrap();
        assert_eq!(flat.camera[1].projection, Projection::Orthographic { height_m: 7.0 });
    }

    #[test]
    fn every_mistake_names_its_line_place_and_remedy() {
        for (from, to, expected) in [
            ("fps = 10", "fps = 0", "s:8: [animation] fps: must be a number 0.01 to 1000, is 0"),
            ("fps = 10", "frmes = 10", "s:8: [animation] frmes: unknown key; did you mean \"frames\"?"),
            ("at = 2.0", "at = 0.5", "s:12: [animation] camera.1: `at` must be a later time"),
            ("at = 0.5, ", "", "s:11: [animation] camera.0.at: is missing: When, later than the key before."),
            ("eye = [90, 0, 60]", "eye = [0, 0, 5]", "s:12: [animation] camera.1: eye and target are the same point"),
            ("eye = [90, 0, 60]", "eye = [0, -90, 60]", "at constant speed no time is left for what else changes"),
            ("fov_deg = 60.0", "height_m = 60.0", "camera.1.height_m: has no meaning in this projection; fov_deg"),
            ("fov_deg = 60.0", "up = [0, 0, -1]", "camera.1: `up` is the opposite of that of the key before"),
            ("lens.a.shape", "camera.shape", "s:18: [animation] change.1.path: the camera has keys of its own"),
            (
                "lens.a.shape",
                "city.shape",
                "change.1.path: \"city\" is the same in all frames; an animation changes lens",
            ),
            ("lens.a.shape", "lense.shape", "there is no \"lense\" in a scene; did you mean \"lens\"?"),
            ("value = [9, 0, 0]", "value = [9, 0]", "change.0.keys.1.value: has another form than [0.0, 0.0, 0.0]"),
            ("value = [9, 0, 0]", "value = true", "keys.1.value: must be a number, or a list of numbers, is true"),
            ("value = [9, 0, 0]", "value = \"#ff0000\"", "keys.1.value: must be a number, or a list of numbers"),
            ("at = 3.04", "at = 0", "change.0.keys.1.at: `at` must be a later time than that of the key before"),
            ("keys = [{ at = 1, value = [[0, 0], [1, 1]] }]", "keys = []", "change.1.keys: is empty"),
            (
                "keys = [{ at = 1,",
                "speed = \"constant\"\nkeys = [{ at = 1,",
                "change.1.speed: has a meaning only for a place",
            ),
            ("at = 3.04", "at = 900000", "[animation] frames: is 9000001 up to the last key; at most 1000000"),
        ] {
            assert!(SCENE.contains(from), "{from}");
            let message = read(&SCENE.replacen(from, to, 1)).unwrap_err();
            assert!(message.contains(expected) && message.lines().count() == 1, "{to}: {message}");
        }
    }
}
