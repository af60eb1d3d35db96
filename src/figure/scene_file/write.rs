//! A [`Scene`] as TOML: stable, readable, and read back as the same scene.

use std::fmt::Write;

use glam::{DMat3, DQuat, DVec2, DVec3};

use crate::{
    figure::scene_file::{
        animation, best_view,
        content::derive_keys,
        deformation, occlusion, overlay,
        parse::{lens_color, rotation},
        paths::Options,
        rendering, sprite, trajectory,
    },
    geom::{Shape, shape::FlatFigure},
    lens::{
        BorderUnit, Class, Content, Discrete, EffectUse, Focus, Lens, LensBody, Parameter, Placement,
        color::{parse_hex, to_hex},
    },
    scene::{
        Background, BaseStyle, CHORD_PX, Figure, Layout, Poi, PoiPlace, Scene, Style, Sun, Technique, TextSize,
        Transparency,
    },
    shader::Clip,
    view::{Camera, Projection, default_near_m},
};

/// The scene as a file that is read with `options`. Keys at their default are left out.
pub fn write(scene: &Scene, options: &Options) -> String {
    let mut out = Toml { text: "veduta = 1\n".into() };
    if scene.city != Default::default() {
        out.head("[city]");
        let files: Vec<String> = scene.city.files.iter().map(|f| quoted(&options.written(f))).collect();
        out.key_if(!files.is_empty(), "files", &list(files));
        out.key_if(scene.city.lod.is_some(), "lod", &quoted(scene.city.lod.as_deref().unwrap_or_default()));
        out.key_if(!scene.city.ground, "ground", "false");
    }
    if let Some(camera) = &scene.camera {
        out.camera(camera);
    }
    out.sun(&scene.sun);
    if scene.time_s != 0.0 {
        out.head("[time]");
        out.key("at_s", &number(scene.time_s));
    }
    out.style(&scene.style);
    for (i, way) in scene.trajectories.iter().enumerate() {
        out.head("[[trajectory]]");
        trajectory::written(i, way).iter().for_each(|(key, value)| out.key(key, value));
    }
    scene.pois.iter().for_each(|poi| out.poi(poi));
    scene.lenses.iter().enumerate().for_each(|(i, lens)| out.lens(i, lens, options));
    for overlay in &scene.overlays {
        out.head("[[overlay]]");
        overlay::written(overlay, options).iter().for_each(|(key, value)| out.key(key, value));
    }
    if scene.layout != Layout::default() {
        out.head("[layout]");
        overlay::layout_written(&scene.layout).iter().for_each(|(key, value)| out.key(key, value));
    }
    let figure = Figure::default();
    if scene.figure != figure {
        out.head("[figure]");
        let [w, h] = scene.figure.size;
        out.key_if(scene.figure.size != figure.size, "size", &format!("[{w}, {h}]"));
        out.key_if(scene.figure.samples != figure.samples, "samples", &scene.figure.samples.to_string());
        let legend = scene.figure.legend;
        out.key_if(legend != figure.legend, "legend", &quoted(legend.word()));
        for (key, text) in [("title", &scene.figure.title), ("caption", &scene.figure.caption)] {
            out.key_if(text.is_some(), key, &quoted(text.as_deref().unwrap_or_default()));
        }
        match scene.figure.text {
            Some(TextSize::Pixels(px)) => out.key("text_px", &number(px)),
            Some(TextSize::Points(points)) => out.key("text_pt", &number(points)),
            None => {}
        }
        out.key_if(scene.figure.dpi.is_some(), "dpi", &number(scene.figure.dpi.unwrap_or_default()));
    }
    if let Some(own) = &scene.animation {
        out.head("[animation]");
        animation::written(own).iter().for_each(|(key, value)| out.key(key, value));
    }
    out.text
}

struct Toml {
    text: String,
}

impl Toml {
    fn head(&mut self, head: &str) {
        let _ = write!(self.text, "\n{head}\n");
    }

    fn key(&mut self, key: &str, value: &str) {
        let _ = writeln!(self.text, "{key} = {value}");
    }

    fn key_if(&mut self, wanted: bool, key: &str, value: &str) {
        if wanted {
            self.key(key, value);
        }
    }

    fn camera(&mut self, camera: &Camera) {
        self.head("[camera]");
        camera_keys(camera).iter().for_each(|(key, value)| self.key(key, value));
    }

    fn sun(&mut self, sun: &Sun) {
        let default = Sun::default();
        if *sun == default {
            return;
        }
        self.head("[sun]");
        self.key_if(sun.azimuth != default.azimuth, "azimuth_deg", &number(degrees(sun.azimuth)));
        self.key_if(sun.elevation != default.elevation, "elevation_deg", &number(degrees(sun.elevation)));
        self.key_if(!sun.shadows, "shadows", "false");
    }

    fn style(&mut self, style: &Style) {
        if *style == Style::default() {
            return;
        }
        self.head("[style]");
        self.key_if(style.base == BaseStyle::Clay, "base", "\"clay\"");
        self.key_if(!style.effects.is_empty(), "effects", &list(style.effects.iter().map(effect)));
        if let Background::Color(c) = style.background {
            self.key("background", &write_color(c));
        }
        self.key_if(style.technique != Technique::default(), "technique", &quoted(style.technique.word()));
        let (method, word) = (style.transparency, quoted(style.transparency.word()));
        let is_plain = Transparency::of(method.word(), None) == Ok(Some(method));
        match method.layers().filter(|_| !is_plain) {
            None => self.key_if(method != Transparency::default(), "transparency", &word),
            Some(layers) => self.key("transparency", &format!("{{ method = {word}, layers = {layers} }}")),
        }
        self.key_if(style.chord_px != CHORD_PX, "chord_px", &number(style.chord_px));
    }

    fn poi(&mut self, poi: &Poi) {
        self.head("[[poi]]");
        self.key("name", &quoted(&poi.name));
        match &poi.place {
            PoiPlace::Object(id) => self.key("object", &quoted(id)),
            PoiPlace::At(at) => self.key("at", &point(*at)),
            PoiPlace::On(way) => self.key("trajectory", &quoted(way)),
        }
    }

    fn lens(&mut self, index: usize, lens: &Lens, options: &Options) {
        self.head("[[lens]]");
        self.key("name", &quoted(&lens.name));
        self.key("kind", &quoted(lens.kind.word()));
        self.key_if(!lens.enabled, "enabled", "false");
        self.key_if(lens.color != lens_color(index), "color", &write_color(lens.color));
        match &lens.placement {
            Placement::World => {}
            Placement::Object(id) => self.key("attached_to", &format!("{{ object = {} }}", quoted(id))),
            Placement::Poi(name) => self.key("attached_to", &format!("{{ poi = {} }}", quoted(name))),
            Placement::Camera => self.key("placement", "\"camera\""),
        }
        let shown = lens.best_view.iter().flat_map(|shown| best_view::written(lens.kind, shown, options));
        shown.for_each(|(key, value)| self.key(key, &value));
        let deform = lens.deform.iter().flat_map(|deform| deformation::written(deform, options));
        deform.for_each(|(key, value)| self.key(key, &value));
        occlusion::written(lens).into_iter().for_each(|(key, value)| self.key(key, &value));
        let shapes: Vec<&Focus> = lens.shapes.iter().filter_map(Focus::own_shape).collect();
        match &shapes[..] {
            [] if lens.occluders().is_some() || lens.best_view.is_some() || lens.deform.is_some() => {}
            [one] => self.key("shape", &focus(one, options)),
            many => self.key("shapes", &list(many.iter().map(|one| focus(one, options)))),
        }
        let drawn = lens.render.iter().flat_map(rendering::written);
        drawn.for_each(|(key, value)| self.key(key, &value));
        self.key_if(!lens.effects.is_empty(), "effects", &list(lens.effects.iter().map(effect)));
        if let Some(own) = &lens.content {
            self.key("content", &content(own, options));
            self.key_if(own.clip != Clip::default(), "clip", &quoted(own.clip.word()));
        }
        self.key_if(lens.body != LensBody::of_kind(lens.kind), "body", &format!("\"{}\"", lens.body.word()));
        if let Some(sprite) = &lens.sprite {
            self.key("sprite", &sprite::written(sprite));
        }
        if let Some(border) = lens.border {
            let unit = match border.unit {
                BorderUnit::Metres => "",
                BorderUnit::Pixels => ", unit = \"px\"",
                BorderUnit::Ray => ", unit = \"ray\"",
            };
            let discrete = if border.discrete == Discrete::Dither { ", discrete = \"dither\"" } else { "" };
            self.key("border", &format!("{{ width = {}{unit}{discrete} }}", number(border.width)));
        }
        self.key_if(lens.keeps_shadows, "shadows", "true");
        self.key_if(lens.at_rest, "space", "\"rest\"");
        if let Some(section) = lens.section {
            self.key("section", &write_color(section));
        }
    }
}

/// The keys of a camera.
pub(super) fn camera_keys(camera: &Camera) -> Vec<(&'static str, String)> {
    let mut keys = vec![("eye", point(camera.eye)), ("target", point(camera.target))];
    if camera.up != DVec3::Z {
        keys.push(("up", point(camera.up)));
    }
    match camera.projection {
        Projection::Perspective { fov_y } => keys.push(("fov_deg", number(degrees(fov_y)))),
        Projection::Orthographic { height_m } => {
            keys.push(("projection", quoted("orthographic")));
            keys.push(("height_m", number(height_m)));
        }
    }
    if camera.near_m != default_near_m(camera.eye.distance(camera.target)) {
        keys.push(("near_m", number(camera.near_m)));
    }
    keys
}

pub(super) fn list(items: impl IntoIterator<Item = String>) -> String {
    format!("[{}]", items.into_iter().collect::<Vec<_>>().join(", "))
}

/// The shortest text that reads back as the same f64.
pub(super) fn number(n: f64) -> String {
    format!("{n:?}")
}

pub(super) fn point(p: DVec3) -> String {
    list(p.to_array().map(number))
}

pub(super) fn write_color(c: [f32; 3]) -> String {
    let hex = to_hex(c);
    if parse_hex(&hex) == Some(c) { quoted(&hex) } else { list(c.map(|c| format!("{c:?}"))) }
}

/// A TOML basic string.
pub fn quoted(text: &str) -> String {
    let mut out = String::with_capacity(text.len() + 2);
    out.push('"');
    for c in text.chars() {
        match c {
            '"' | '\\' => out.extend(['\\', c]),
            c if c.is_control() => {
                let _ = write!(out, "\\U{:08X}", u32::from(c));
            }
            c => out.push(c),
        }
    }
    out.push('"');
    out
}

/// The degrees with the fewest decimals that read back as the same radians; else the nearest there are.
pub(super) fn degrees(radians: f64) -> f64 {
    let exact = radians.to_degrees();
    rounded(exact).find(|d| d.to_radians() == radians).unwrap_or(exact)
}

/// `n` with 0, 1, ... 13 decimals.
fn rounded(n: f64) -> impl Iterator<Item = f64> {
    (0..=13).filter_map(move |digits| format!("{n:.digits$}").parse().ok()).map(|d: f64| d + 0.0)
}

/// A focus area as its table.
pub(super) fn focus(focus: &Focus, options: &Options) -> String {
    match focus {
        Focus::Shape(one) => shape(one),
        other => super::focus::written(other, options).unwrap_or_default(),
    }
}

fn shape(shape: &Shape) -> String {
    match shape {
        Shape::Sphere { center, radius } => {
            format!("{{ kind = \"sphere\", center = {}, radius = {} }}", point(*center), number(*radius))
        }
        Shape::Box { center, size, rotation: turn } => {
            format!("{{ kind = \"box\", center = {}, size = {}{} }}", point(*center), point(*size), turned(*turn))
        }
        Shape::Cylinder { center, radius, height, axis } => {
            format!(
                "{{ kind = \"cylinder\", center = {}, radius = {}, height = {}{} }}",
                point(*center),
                number(*radius),
                number(*height),
                tilted(*axis)
            )
        }
        Shape::Ellipsoid { center, radii, rotation: turn } => {
            format!(
                "{{ kind = \"ellipsoid\", center = {}, radii = {}{} }}",
                point(*center),
                point(*radii),
                turned(*turn)
            )
        }
        Shape::Frustum { center, radius, top_radius, height, axis } => {
            let (kind, top) = match *top_radius {
                0.0 => ("cone", String::new()),
                top => ("frustum", format!(", top_radius = {}", number(top))),
            };
            format!(
                "{{ kind = \"{kind}\", center = {}, radius = {}{top}, height = {}{} }}",
                point(*center),
                number(*radius),
                number(*height),
                tilted(*axis)
            )
        }
        Shape::Convex { points } => {
            format!("{{ kind = \"convex\", points = {} }}", list(points.iter().map(|p| point(*p))))
        }
        Shape::Polytope { planes } => {
            format!("{{ kind = \"polytope\", planes = {} }}", list(planes.iter().map(|p| list(p.map(number)))))
        }
        Shape::Corridor { points, width, height } => format!(
            "{{ kind = \"corridor\", points = {}, width = {}, height = {} }}",
            list(points.iter().map(|p| point(*p))),
            number(*width),
            number(*height)
        ),
        Shape::Flat { center, rotation: turn, figure } => {
            let pair = |p: &DVec2| list(p.to_array().map(number));
            let figure = match figure {
                FlatFigure::Disc { radius } => format!("radius = {}", number(*radius)),
                FlatFigure::Rectangle { size } => format!("size = {}", pair(size)),
                FlatFigure::Polygon { points } => format!("points = {}", list(points.iter().map(pair))),
            };
            format!("{{ kind = \"flat\", center = {}{}, {figure} }}", point(*center), turned(*turn))
        }
    }
}

/// The key of a rotation, where there is one.
pub(super) fn turned(rotation: DQuat) -> String {
    match angles(rotation) {
        [0.0, 0.0, 0.0] => String::new(),
        angles => format!(", rotation_deg = {}", list(angles.map(number))),
    }
}

/// The key of an axis that is not upright.
fn tilted(axis: DVec3) -> String {
    if axis == DVec3::Z { String::new() } else { format!(", axis = {}", point(axis)) }
}

/// Yaw, pitch and roll of a rotation, degrees: the inverse of [`rotation`], with as few decimals as it takes.
pub(super) fn angles(turn: DQuat) -> [f64; 3] {
    let m = DMat3::from_quat(turn.normalize());
    let [x, y, z] = [m.x_axis, m.y_axis, m.z_axis];
    // Looking straight up or down, yaw and roll turn about one axis: all of it is called yaw.
    let upright = x.x.hypot(x.y) < 1e-9;
    let yaw = if upright { (-y.x).atan2(y.y) } else { x.y.atan2(x.x) };
    let pitch = x.z.atan2(x.x.hypot(x.y));
    let roll = if upright { 0.0 } else { y.z.atan2(z.z) };
    // Half a turn is written as 180, whichever sign its rounding has.
    let half = |a: f64| if a < 1e-9 - 180.0 { a + 360.0 } else { a };
    let exact = [yaw, pitch, roll].map(f64::to_degrees).map(half);
    let same = |a: &[f64; 3]| {
        let q = rotation(*a);
        q == turn || -q == turn
    };
    let near =
        |a: &[f64; 3]| rotation(*a).dot(turn).abs() > 1.0 - 1e-15 && (0..3).all(|i| (a[i] - exact[i]).abs() < 1e-9);
    let candidates = || (0..=13).map(|n: usize| exact.map(|a| rounded(a).nth(n).unwrap_or(a)));
    candidates().find(same).or_else(|| candidates().find(near)).unwrap_or(exact)
}

fn class_word(class: Class) -> Option<&'static str> {
    match class {
        Class::Inside => None,
        Class::Front => Some("front"),
        Class::Behind => Some("behind"),
        Class::Rest => Some("rest"),
    }
}

fn content(content: &Content, options: &Options) -> String {
    let mut keys = Vec::new();
    if !content.files.is_empty() {
        keys.push(format!("files = {}", list(content.files.iter().map(|f| quoted(&options.written(f))))));
    }
    keys.extend(content.lod.map(|lod| format!("lod = {}", quoted(&lod.to_string()))));
    keys.extend(content.derive.iter().flat_map(derive_keys));
    keys.extend(class_word(content.class).map(|word| format!("class = {}", quoted(word))));
    if content.keep_terrain {
        keys.push("keep_terrain = true".to_owned());
    }
    if let Some(copied) = &content.copied {
        keys.extend(copied.from.map(|p| format!("from = {}", point(p))));
        keys.extend(copied.to.map(|p| format!("to = {}", point(p))));
        if copied.rotation != DQuat::IDENTITY {
            keys.push(format!("rotation_deg = {}", list(angles(copied.rotation).map(number))));
        }
        // Something says that it is moved.
        if copied.scale != 1.0 || (copied.rotation == DQuat::IDENTITY && copied.from.is_none() && copied.to.is_none()) {
            keys.push(format!("scale = {}", number(copied.scale)));
        }
    }
    if keys.is_empty() { "{}".to_owned() } else { format!("{{ {} }}", keys.join(", ")) }
}

pub(super) fn effect(used: &EffectUse) -> String {
    let class = class_word(used.class);
    if class.is_none() && used.blend.is_none() && used.weight.is_none() && used.parameters.is_empty() {
        return quoted(&used.effect);
    }
    let mut out = format!("{{ effect = {}", quoted(&used.effect));
    if let Some(class) = class {
        let _ = write!(out, ", class = \"{class}\"");
    }
    if let Some(blend) = used.blend {
        let _ = write!(out, ", blend = \"{}\"", blend.word());
    }
    if let Some(weight) = used.weight {
        let _ = write!(out, ", weight = {}", number(weight));
    }
    for (key, value) in &used.parameters {
        let bare = !key.is_empty() && key.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_' || b == b'-');
        let key = if bare { key.clone() } else { quoted(key) };
        let _ = write!(out, ", {key} = {}", parameter_written(value));
    }
    out + " }"
}

/// The value of a parameter.
pub(super) fn parameter_written(value: &Parameter) -> String {
    match value {
        Parameter::Boolean(b) => b.to_string(),
        Parameter::Number(n) => number(*n),
        Parameter::Text(t) => quoted(t),
        Parameter::Numbers(n) => list(n.iter().map(|n| number(*n))),
        Parameter::Texts(t) => list(t.iter().map(|t| quoted(t))),
    }
}
