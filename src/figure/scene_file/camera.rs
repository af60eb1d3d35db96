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

const CAMERA_ROWS: &[Row<Camera>] = &[
    field!(
        key("eye", Kind::Point, "", "m", "Where the eye is.", "[78500.0, 457800.0, 150.0]"),
        Same,
        |camera: Camera| camera.eye
    ),
    field!(
        key("target", Kind::Point, "", "m", "What it looks at: any point but `eye`.", "[78600.0, 458000.0, 10.0]"),
        Same,
        |camera: Camera| camera.target
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
        |camera: Camera| camera.up
    ),
    Row::<Camera>::joint(
        key(
            "projection",
            Kind::Word { now: &["perspective", "orthographic"], later: &[] },
            "\"perspective\"",
            "",
            "Whether far things look smaller.",
            "\"orthographic\"",
        ),
        |camera, _| is_flat(camera).then(|| "orthographic".into()),
    )
    .always(),
    Row::<Camera>::joint(
        key("fov_deg", Kind::Number { min: 0.01, max: 179.0 }, "45.0", "degrees", "Vertical field of view.", "60.0"),
        |camera, _| match &camera.projection {
            Projection::Perspective { fov_y } => Degrees::data(fov_y),
            Projection::Orthographic { .. } => None,
        },
    )
    .always(),
    Row::<Camera>::joint(
        key(
            "height_m",
            Kind::Number { min: 0.001, max: 1e7 },
            "what `fov_deg` shows at the target",
            "m",
            "Height of an orthographic picture.",
            "250.0",
        ),
        |camera, _| match camera.projection {
            Projection::Orthographic { height_m } => Some(height_m.into()),
            Projection::Perspective { .. } => None,
        },
    )
    .always(),
    Row::<Camera>::joint(
        key(
            "near_m",
            Kind::Number { min: 1e-4, max: 1e6 },
            "a 512th of the way to the target, 0.125 to 1",
            "m",
            "What is nearer along the view axis is not drawn.",
            "0.5",
        ),
        |camera, _| (camera.near_m != default_near_m(camera.eye.distance(camera.target))).then(|| camera.near_m.into()),
    )
    .always(),
];

fn is_flat(camera: &Camera) -> bool {
    matches!(camera.projection, Projection::Orthographic { .. })
}

/// The table of a camera.
pub fn written(camera: &Camera, options: &Options) -> Data {
    row::written(CAMERA_ROWS, camera, &Camera { up: DVec3::Z, ..*camera }, options)
}

/// A camera, of `[camera]` or of a table with its keys.
pub fn read(reader: &mut Reader, fields: &Fields) -> Option<Camera> {
    let fov_y = fields.number("fov_deg").unwrap_or(DEFAULT_FOV_DEG).to_radians();
    let projection = Projection::Perspective { fov_y };
    let mut camera = Camera { eye: DVec3::ZERO, target: DVec3::ZERO, up: DVec3::Z, projection, near_m: 0.0 };
    if !row::read(CAMERA_ROWS, fields, reader, &mut camera) {
        return None;
    }
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
    Some(camera)
}
