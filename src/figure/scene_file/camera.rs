//! `[camera]` in scene files, and all tables with its keys.

use glam::DVec3;

use crate::{
    figure::scene_file::{
        check::Fields,
        forms::{Degrees, Form, Same},
        keys::{Kind, Table, key},
        node::Data,
        paths::Options,
        reader::Reader,
        row::{self, Row, field, keys_of},
    },
    view::{Camera, CameraError, Projection, default_near_m},
};

/// Vertical field of view where none is given, degrees.
pub const DEFAULT_FOV_DEG: f64 = 45.0;

/// `[camera]`.
pub const CAMERA: Table = Table {
    name: "camera",
    doc: "The eye, in model coordinates (x east, y north, z up).",
    keys: keys_of!(CAMERA_ROWS),
};

const CAMERA_ROWS: &[Row<Eye>] = &[
    field!(key("eye", Kind::Point, "", "m", "Where the eye is.", "[78500.0, 457800.0, 150.0]"), Same, |own: Eye| own
        .camera
        .eye),
    field!(
        key("target", Kind::Point, "", "m", "What it looks at: any point but `eye`.", "[78600.0, 458000.0, 10.0]"),
        Same,
        |own: Eye| own.camera.target
    ),
    field!(
        key(
            "up",
            Kind::Direction,
            "[0, 0, 1]",
            "",
            "What is up in the picture. Where it is parallel to the view, north takes its place, and east where that is parallel too.",
            "[0, 0, 1]",
        ),
        Same,
        |own: Eye| own.camera.up
    ),
    Row::<Eye>::joint(
        key(
            "projection",
            Kind::Word { now: &["perspective", "orthographic"], later: &[] },
            "\"perspective\"",
            "",
            "Whether far things look smaller.",
            "\"orthographic\"",
        ),
        |own, _| is_flat(&own.camera).then(|| "orthographic".into()),
    )
    .always(),
    Row::<Eye>::joint(
        key("fov_deg", Kind::Number { min: 0.01, max: 179.0 }, "45.0", "degrees", "Vertical field of view.", "60.0"),
        |own, _| match &own.camera.projection {
            Projection::Perspective { fov_y } => Degrees::data(fov_y),
            Projection::Orthographic { .. } => None,
        },
    )
    .always(),
    Row::<Eye>::joint(
        key(
            "height_m",
            Kind::Number { min: 0.001, max: 1e7 },
            "what `fov_deg` shows at the target",
            "m",
            "Height of an orthographic picture.",
            "250.0",
        ),
        |own, _| match own.camera.projection {
            Projection::Orthographic { height_m } => Some(height_m.into()),
            Projection::Perspective { .. } => None,
        },
    )
    .always(),
    Row::<Eye>::joint(
        key(
            "near_m",
            Kind::Number { min: 1e-4, max: 1e6 },
            "a 512th of the way to the target, 0.125 to 1",
            "m",
            "What is nearer along the view axis is not drawn.",
            "0.5",
        ),
        |Eye { camera, .. }, _| {
            (camera.near_m != default_near_m(camera.eye.distance(camera.target))).then(|| camera.near_m.into())
        },
    )
    .always(),
    field!(
        key(
            "above_ground",
            Kind::Boolean,
            "false",
            "",
            "Whether the heights of `eye` and `target` are metres above the ground at each; see Heights above the ground.",
            "true",
        ),
        Same,
        |own: Eye| own.above_ground
    ),
];

/// A camera as files have it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Eye {
    /// The camera.
    pub camera: Camera,
    /// Whether heights of it are metres above the ground.
    pub above_ground: bool,
}

fn is_flat(camera: &Camera) -> bool {
    matches!(camera.projection, Projection::Orthographic { .. })
}

/// The table of a camera.
pub fn written(eye: &Eye, options: &Options) -> Data {
    let plain = Eye { camera: Camera { up: DVec3::Z, ..eye.camera }, above_ground: false };
    row::written(CAMERA_ROWS, eye, &plain, options)
}

/// A camera, of `[camera]` or of a table with its keys.
pub fn read(reader: &mut Reader, fields: &Fields) -> Option<Eye> {
    let fov_y = fields.number("fov_deg").unwrap_or(DEFAULT_FOV_DEG).to_radians();
    let projection = Projection::Perspective { fov_y };
    let camera = Camera { eye: DVec3::ZERO, target: DVec3::ZERO, up: DVec3::Z, projection, near_m: 0.0 };
    let mut eye = Eye { camera, above_ground: false };
    if !row::read(CAMERA_ROWS, fields, reader, &mut eye) {
        return None;
    }
    let camera = &mut eye.camera;
    let distance = camera.eye.distance(camera.target);
    if fields.text("projection") == Some("orthographic") {
        let seen = 2.0 * distance * (0.5 * fov_y).tan();
        camera.projection = Projection::Orthographic { height_m: fields.number("height_m").unwrap_or(seen) };
    } else if fields.given("height_m") && !(fields.given("projection") && fields.text("projection").is_none()) {
        let message = "has a meaning only with projection = \"orthographic\"";
        reader.checker.note(&fields.place, "height_m", fields.line("height_m"), message);
    }
    camera.near_m = fields.number("near_m").unwrap_or_else(|| default_near_m(distance));
    if let Err(error) = camera.check() {
        let key = match error {
            CameraError::EyeIsTarget(..) => "target",
            CameraError::FieldOfView(_) => "fov_deg",
            CameraError::Height(_) => "height_m",
            CameraError::Near(_) => "near_m",
            CameraError::NotFinite(_) | CameraError::Size(..) => "eye",
        };
        reader.checker.note(&fields.place, key, fields.line(key), error.to_string());
    }
    Some(eye)
}
