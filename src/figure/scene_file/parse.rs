//! From a checked tree to a [`Scene`].

use std::{
    collections::BTreeMap,
    ffi::OsStr,
    fmt::Write as _,
    io::ErrorKind,
    path::{Path, PathBuf},
};

use glam::{DQuat, DVec2, DVec3};

use crate::{
    city::{Lod, builtin},
    figure::scene_file::{
        animation, best_view,
        check::{Checker, Fields, Place, lod},
        content, deformation, figure,
        focus::Reader,
        keys::{self, CLASSES, Kind},
        node::{Data, Node},
        occlusion, overlay,
        paths::{Options, PathProblem},
        shape_keys, sprite, trajectory,
    },
    geom::{Shape, combination::Operation, shape::FlatFigure},
    lens::{
        BestView, Border, BorderUnit, Class, Content, Copied, Deform, Discrete, EffectUse, Focus, Lens, LensBody,
        LensKind, Parameter, Placement,
        best_view::Depiction,
        deform::ControlProfile,
        effect,
        nearest::did_you_mean,
        ramp::{MAX_CATEGORIES, category},
    },
    scene::{
        self, Background, BaseStyle, CHORD_PX, CitySpec, Poi, PoiPlace, Scene, Style, Sun, Technique, Transparency,
        overlay::Frame,
    },
    shader::{
        Blend, Clip,
        effect::{EffectKind, find as find_effect},
    },
    view::{Camera, CameraError, Projection, default_near_m},
};

/// Vertical field of view where none is given, degrees.
pub const DEFAULT_FOV_DEG: f64 = 45.0;

/// The rotation of a box: yaw counter-clockwise from above, pitch lifts its x end, roll about its own x; degrees.
pub fn rotation([yaw, pitch, roll]: [f64; 3]) -> DQuat {
    DQuat::from_rotation_z(yaw.to_radians())
        * DQuat::from_rotation_y(-pitch.to_radians())
        * DQuat::from_rotation_x(roll.to_radians())
}

/// The colour of a lens that names none, by its place.
pub fn lens_color(index: usize) -> [f32; 3] {
    category(index % MAX_CATEGORIES)
}

/// Reads the scene; problems go to the checker, and what they touch gets its default.
pub struct SceneReader<'o> {
    /// What is wrong so far.
    pub checker: Checker,
    /// Whether a path needs `${VEDUTA_DATA}` and it is not set.
    pub lacks_data: bool,
    options: &'o Options,
}

impl<'o> SceneReader<'o> {
    /// A reader of paths by `options`.
    pub fn new(options: &'o Options) -> Self {
        Self { checker: Checker::default(), lacks_data: false, options }
    }

    /// Reads a whole file.
    pub fn scene(&mut self, root: &Node) -> Scene {
        let place = Place { table: String::new(), prefix: String::new(), line: 1 };
        let top = self.checker.fields(root, &keys::ROOT, &[], place);
        let mut scene = Scene::default();
        for key in keys::ROOT.keys {
            let Some(node) = top.node(key.name) else { continue };
            match key.kind {
                Kind::Table(table) => {
                    let place = Place { table: key.name.into(), prefix: String::new(), line: node.line };
                    let fields = self.checker.fields(node, table, &[], place);
                    self.top_table(key.name, &fields, &mut scene);
                }
                Kind::Tables(table) => {
                    for (i, element) in node.list().unwrap_or_default().iter().enumerate() {
                        let place =
                            Place { table: format!("{}.{i}", key.name), prefix: String::new(), line: element.line };
                        let noted = self.checker.problems.len();
                        let fields = self.checker.fields(element, table, &[], place);
                        match key.name {
                            "poi" => {
                                scene.pois.extend(self.poi(&fields, i));
                                continue;
                            }
                            "trajectory" => {
                                scene.trajectories.extend(trajectory::read(&mut self.checker, &fields, i));
                                continue;
                            }
                            "overlay" => {
                                scene.overlays.push(self.overlay(&fields));
                                continue;
                            }
                            _ => {}
                        }
                        scene.lenses.push(self.lens(&fields, i));
                        // What else a lens of an unknown kind may have is not known.
                        if fields.is_bad("kind") {
                            self.checker.keep_after(noted, "kind");
                        }
                    }
                }
                _ => {}
            }
        }
        let lists = |key: &str| top.node(key).and_then(Node::list).unwrap_or_default();
        self.unique("lens", lists("lens"), scene.lenses.iter().map(|l| l.name.as_str()));
        self.unique("poi", lists("poi"), scene.pois.iter().map(|p| p.name.as_str()));
        self.unique("trajectory", lists("trajectory"), scene.trajectories.iter().map(|way| way.name.as_str()));
        // Of a way that is wrong it is told already.
        let is_whole = scene.trajectories.len() == lists("trajectory").len();
        let of_ways = if is_whole { scene::trajectory::problems(&scene) } else { Vec::new() };
        for problem in scene::overlay::problems(&scene).into_iter().chain(of_ways) {
            let (table, index) = problem.table.split_once('.').unwrap_or_default();
            let node = index.parse().ok().and_then(|i: usize| lists(table).get(i));
            let line = node.and_then(|n| n.entry(&problem.key).or(Some(n))).map_or(1, |n| n.line);
            let place = Place { table: problem.table.clone(), prefix: String::new(), line };
            self.checker.note(&place, &problem.key, line, problem.message);
        }
        scene
    }

    fn top_table(&mut self, name: &str, fields: &Fields, scene: &mut Scene) {
        match name {
            "city" => scene.city = self.city(fields),
            "camera" => scene.camera = camera(&mut self.checker, fields),
            "sun" => scene.sun = sun(fields),
            "time" => scene.time_s = fields.number("at_s").unwrap_or(0.0),
            "style" => scene.style = self.style(fields),
            "layout" => scene.layout = overlay::layout(fields),
            "figure" => scene.figure = figure::read(&mut self.checker, fields),
            "animation" => scene.animation = animation::read(&mut self.checker, fields, scene),
            _ => {}
        }
    }

    fn unique<'a>(&mut self, table: &str, nodes: &[Node], names: impl Iterator<Item = &'a str>) {
        let mut seen: BTreeMap<&str, usize> = BTreeMap::new();
        for (i, name) in names.enumerate() {
            if let Some(first) = seen.insert(name, i) {
                let line = nodes.get(i).map_or(1, |n| n.line);
                let place = Place { table: format!("{table}.{i}"), prefix: String::new(), line };
                let message = format!("\"{name}\" is the name of {table}.{first} already; names must differ");
                self.checker.note(&place, "name", line, message);
            }
        }
    }

    fn city(&mut self, fields: &Fields) -> CitySpec {
        let lod = fields.node("lod").and_then(lod).map(|l| l.to_string());
        CitySpec {
            files: self.files(fields, self.options.must_exist),
            lod,
            ground: fields.boolean("ground").unwrap_or(true),
        }
    }

    fn files(&mut self, fields: &Fields, must_exist: bool) -> Vec<PathBuf> {
        let mut files = Vec::new();
        for (i, node) in fields.node("files").and_then(Node::list).unwrap_or_default().iter().enumerate() {
            match self.options.resolve(node.text().unwrap_or_default()) {
                Ok(path) if must_exist && is_absent(&path) => {
                    let mut message = format!("there is no file or folder {}", node.quoted());
                    if Some(path.as_os_str()) != node.text().map(OsStr::new) {
                        let _ = write!(message, " ({})", path.display());
                    }
                    self.checker.note(&fields.place, &format!("files.{i}"), node.line, message);
                }
                Ok(path) => files.push(path),
                Err(PathProblem::NoData) => {
                    self.lacks_data = true;
                    let message =
                        format!("{} needs the environment variable VEDUTA_DATA, which is not set", node.quoted());
                    self.checker.note(&fields.place, &format!("files.{i}"), node.line, message);
                }
                Err(PathProblem::Wrong(message)) => {
                    self.checker.note(&fields.place, &format!("files.{i}"), node.line, message);
                }
            }
        }
        files
    }

    fn style(&mut self, fields: &Fields) -> Style {
        let (effects, _) = self.effects(fields, "effects", false);
        self.without_sights(fields, "effects", &effects);
        let base = if fields.text("base") == Some("clay") { BaseStyle::Clay } else { BaseStyle::Natural };
        let background = fields.color("background").map_or(Background::Sky, Background::Color);
        let technique = fields.text("technique").and_then(Technique::of_word).unwrap_or_default();
        let transparency = self.transparency(fields).unwrap_or_default();
        let chord_px = fields.number("chord_px").unwrap_or(CHORD_PX);
        Style { base, effects, background, technique, transparency, chord_px }
    }

    fn transparency(&mut self, fields: &Fields) -> Option<Transparency> {
        let node = fields.node("transparency")?;
        if let Some(word) = node.text() {
            return Transparency::of(word, None).ok()?;
        }
        let own = self.checker.fields(node, &keys::TRANSPARENCY, &[], fields.place.within("transparency", node.line));
        match Transparency::of(own.text("method")?, own.integer("layers")) {
            Ok(method) => method,
            Err(message) => {
                self.checker.note(&own.place, "layers", own.line("layers"), message);
                None
            }
        }
    }

    fn poi(&mut self, fields: &Fields, index: usize) -> Option<Poi> {
        let name = fields.text("name").map_or_else(|| format!("poi-{index}"), str::to_owned);
        let given: Vec<&str> = ["object", "at", "trajectory"].into_iter().filter(|key| fields.given(key)).collect();
        let place = match given[..] {
            ["object"] => PoiPlace::Object(fields.text("object")?.to_owned()),
            ["at"] => PoiPlace::At(fields.point("at")?),
            [_] => PoiPlace::On(fields.text("trajectory")?.to_owned()),
            [] => {
                let message = "is missing: give object = \"ID\", at = [x, y, z] or trajectory = \"NAME\"";
                self.checker.note(&fields.place, "at", fields.place.line, message);
                return None;
            }
            [first, second, ..] => {
                let message = format!("is given together with {first}: a point of interest is one of them");
                self.checker.note(&fields.place, second, fields.line(second), message);
                return None;
            }
        };
        Some(Poi { name, place })
    }

    fn lens(&mut self, fields: &Fields, index: usize) -> Lens {
        let placement = self.placement(fields);
        let kind = fields.text("kind").and_then(LensKind::of_word).unwrap_or_default();
        let is_occlusion = kind == LensKind::Occlusion;
        let best_view = self.best_view(fields, kind);
        let deform = self.deform(fields, kind);
        let needs_shape = deform.as_ref().is_none_or(|deform| !deform.needs_no_area());
        let mut shapes = self.shapes(fields, needs_shape && !is_occlusion && !kind.has_overlay());
        let (effects, of_effects) = self.effects(fields, "effects", true);
        let render = is_occlusion.then(|| self.rendering(fields, &effects));
        if !is_occlusion {
            self.without_sights(fields, "effects", &effects);
        }
        if is_occlusion {
            shapes = self.occluded(fields, shapes);
        } else {
            let own = occlusion::OWN.into_iter().filter(|key| !kind.has_overlay() || *key != "poi");
            for key in own.filter(|key| fields.given(key)) {
                let message = "has a meaning only for a lens of kind = \"occlusion\"";
                self.checker.note(&fields.place, key, fields.line(key), message);
            }
        }
        let content = self.content(fields, of_effects);
        let is_saved = |shape: &Focus| matches!(shape, Focus::Sprite { .. });
        let has_saved = shapes.iter().any(|s| s.any(&is_saved));
        let all_saved = has_saved && shapes.iter().all(is_saved);
        let sprite = sprite::read(&mut self.checker, fields, all_saved, camera);
        let border = fields
            .node("border")
            .map(|node| self.checker.fields(node, &keys::BORDER, &[], fields.place.within("border", node.line)));
        let fades = border.as_ref().is_some_and(|b| b.text("unit") != Some("ray"));
        if (sprite.is_some() || has_saved) && fades {
            let message = match has_saved {
                true => {
                    "is given together with a shape of kind \"sprite\": what is tested by a depth sprite ends at once"
                }
                false => {
                    "is given together with sprite: what is tested by a depth sprite ends at once; leave out one of them"
                }
            };
            self.checker.note(&fields.place, "border", fields.line("border"), message);
        }
        Lens {
            name: fields.text("name").map_or_else(|| format!("lens-{index}"), str::to_owned),
            kind,
            enabled: fields.boolean("enabled").unwrap_or(true),
            color: fields.color("color").unwrap_or_else(|| lens_color(index)),
            placement,
            shapes,
            render,
            effects,
            best_view,
            deform,
            content,
            body: LensBody::WORDS
                .iter()
                .find(|(word, _)| fields.text("body") == Some(*word))
                .map_or_else(|| LensBody::of_kind(kind), |(_, body)| *body),
            sprite,
            border: border.map(|b| Border {
                width: b.number("width").unwrap_or(0.0),
                unit: match b.text("unit") {
                    Some("px") => BorderUnit::Pixels,
                    Some("ray") => BorderUnit::Ray,
                    _ => BorderUnit::Metres,
                },
                discrete: if b.text("discrete") == Some("dither") { Discrete::Dither } else { Discrete::Threshold },
            }),
            at_rest: fields.text("space") == Some("rest"),
            keeps_shadows: fields.boolean("shadows").unwrap_or(false),
            section: fields.color("section"),
        }
    }

    /// What the overlay of a lens shows, if its kind has one.
    fn best_view(&mut self, fields: &Fields, kind: LensKind) -> Option<BestView> {
        let given = |key: &&str| fields.given(key);
        if !kind.has_overlay() {
            for key in best_view::OWN.into_iter().filter(given) {
                let message = "has a meaning only for lenses that have an overlay: annotation, best-view, map-view, worldlet, see-through, portal";
                self.checker.note(&fields.place, key, fields.line(key), message);
            }
            return None;
        }
        for key in best_view::NOT_OWN.into_iter().filter(given) {
            let word = kind.word();
            let message = match key {
                "effects" => format!(
                    "has no meaning for a lens of kind \"{word}\"; what acts on all of its view stands in look = {{ effects = [...] }}"
                ),
                _ => format!("has no meaning for a lens of kind \"{word}\", which has an overlay and no focus area"),
            };
            self.checker.note(&fields.place, key, fields.line(key), message);
        }
        let depiction = match (kind, fields.node("image").and_then(Node::text), fields.text("text")) {
            (LensKind::Annotation, Some(_), Some(_)) => {
                let message =
                    "is given together with image: an annotation is one of them; a caption stands in [[overlay]]";
                self.checker.note(&fields.place, "text", fields.line("text"), message);
                None
            }
            (LensKind::Annotation, Some(_), None) => self.file(fields, "image").map(Depiction::Image),
            (LensKind::Annotation, None, Some(text)) => Some(Depiction::Text(text.to_owned())),
            (LensKind::Annotation, None, None) => {
                if !fields.given("image") && !fields.given("text") {
                    let message = "is missing: an annotation shows image = \"FILE\" or text = \"...\"";
                    self.checker.note(&fields.place, "image", fields.place.line, message);
                }
                None
            }
            _ => best_view::read_view(&mut self.checker, fields, kind, camera).map(Depiction::View),
        };
        let of_view = ["view", "lenses", "look"].into_iter().map(|key| (key, kind == LensKind::Annotation));
        let of_annotation = ["image", "text"].into_iter().map(|key| (key, kind != LensKind::Annotation));
        for (key, is_wrong) in of_view.chain(of_annotation) {
            if is_wrong && fields.given(key) {
                let message = format!("has no meaning for a lens of kind \"{}\"", kind.word());
                self.checker.note(&fields.place, key, fields.line(key), message);
            }
        }
        let look = fields.node("look").map(|node| {
            let place = fields.place.within("look", node.line);
            let own = self.checker.fields(node, &best_view::LOOK, &[], place);
            let (effects, _) = self.effects(&own, "effects", false);
            self.without_sights(&own, "effects", &effects);
            best_view::look(&own, effects)
        });
        let names = |node: &Node| -> Vec<String> {
            node.list().unwrap_or_default().iter().filter_map(|n| n.text().map(str::to_owned)).collect()
        };
        Some(BestView {
            pois: fields.node("poi").map(occlusion::texts).unwrap_or_default(),
            depiction: depiction.unwrap_or_else(|| Depiction::Text(String::new())),
            lenses: fields.node("lenses").map(names),
            look,
        })
    }

    /// The file that a key names; noted where it may not be read.
    fn file(&mut self, fields: &Fields, key: &str) -> Option<PathBuf> {
        let node = fields.node(key)?;
        match self.options.resolve(node.text()?) {
            Ok(path) => return Some(path),
            Err(PathProblem::NoData) => {
                self.lacks_data = true;
                let message = format!("{} needs the environment variable VEDUTA_DATA, which is not set", node.quoted());
                self.checker.note(&fields.place, key, node.line, message);
            }
            Err(PathProblem::Wrong(message)) => self.checker.note(&fields.place, key, node.line, message),
        }
        None
    }

    /// What a deformation lens does, if it is one.
    fn deform(&mut self, fields: &Fields, kind: LensKind) -> Option<Deform> {
        if kind != LensKind::Deformation {
            for key in deformation::OWN.into_iter().filter(|key| fields.given(key)) {
                let message = "has a meaning only for a lens of kind = \"deformation\"";
                self.checker.note(&fields.place, key, fields.line(key), message);
            }
            return None;
        }
        let (checker, options, lacks_data) = (&mut self.checker, self.options, &mut self.lacks_data);
        let steps = deformation::steps(&mut Reader { checker, options, lacks_data }, fields);
        let control = fields.node("control").and_then(|node| {
            let empty = Node::empty_table(node.line);
            let table = if node.text().is_some() { &empty } else { node };
            let place = fields.place.within("control", node.line);
            let own = self.checker.fields(table, &deformation::CONTROL, &[], place);
            if !own.given("image") {
                return deformation::profile(&mut self.checker, &own, node.text());
            }
            if own.given("profile") {
                let message = "is given together with profile: a control is one of them";
                self.checker.note(&own.place, "image", own.line("image"), message);
            }
            self.file(&own, "image").map(ControlProfile::Image)
        });
        Some(Deform { steps, control, strength: fields.number("strength").unwrap_or(1.0) })
    }

    fn overlay(&mut self, fields: &Fields) -> scene::Overlay {
        let table = |key: &str| fields.node(key).filter(|node| overlay::is_table(node));
        let frame = table("frame").map(|node| {
            let own = self.checker.fields(node, &overlay::FRAME, &[], fields.place.within("frame", node.line));
            Frame::Images { alpha: self.file(&own, "alpha"), frame: self.file(&own, "frame") }
        });
        let line = table("line").map(|node| {
            let own = self.checker.fields(node, &overlay::LINE, &[], fields.place.within("line", node.line));
            let skin = self.file(&own, "skin");
            (own, skin)
        });
        let call_out = table("call_out").map(|node| {
            if fields.given("at") {
                let message = "is given together with at: an overlay stands in the scene or at a place in the picture";
                self.checker.note(&fields.place, "call_out", node.line, message);
            }
            self.checker.fields(node, &overlay::CALL_OUT, &[], fields.place.within("call_out", node.line))
        });
        overlay::overlay(fields, overlay::Parts { frame, line, call_out })
    }

    /// The focus areas of an occlusion lens with these shapes.
    fn occluded(&mut self, fields: &Fields, shapes: Vec<Focus>) -> Vec<Focus> {
        let saved = shapes.iter().position(|shape| matches!(shape, Focus::Sprite { .. }));
        if saved.is_some() {
            let key = if fields.given("shape") { "shape" } else { "shapes" };
            let message = "a depth sprite cannot be combined with occluders; a shape of another kind would be right";
            self.checker.note(&fields.place, key, fields.line(key), message);
        }
        let (checker, options, lacks_data) = (&mut self.checker, self.options, &mut self.lacks_data);
        let of = occlusion::read(&mut Reader { checker, options, lacks_data }, fields);
        occlusion::areas(of, shapes)
    }

    /// The content of a lens; `of_effects`: that of its effect `lod`, and the line of it.
    fn content(&mut self, fields: &Fields, of_effects: Option<(Content, u32)>) -> Option<Content> {
        let clip = fields.text("clip").and_then(|word| Clip::ALL.into_iter().find(|clip| clip.word() == word));
        if let (true, Some((_, line))) = (fields.given("content"), &of_effects) {
            let message = "is given together with the effect \"lod\", which is a content too: a lens has one";
            self.checker.note(&fields.place, "content", *line, message);
        }
        let content = match fields.node("content") {
            None => of_effects.map(|(content, _)| content),
            Some(node) => {
                let place = fields.place.within("content", node.line);
                let own = self.checker.fields(node, &content::CONTENT, &[], place);
                let class = own.text("class").and_then(class_of).unwrap_or_default();
                let moved = ["from", "to", "rotation_deg", "scale"].into_iter().any(|key| own.given(key));
                let turn = own.node("rotation_deg").and_then(Node::numbers::<3>).map(rotation);
                let copied = moved.then(|| Copied {
                    from: own.point("from"),
                    to: own.point("to"),
                    rotation: turn.unwrap_or_default(),
                    scale: own.number("scale").unwrap_or(1.0),
                });
                let keep_terrain = own.boolean("keep_terrain").unwrap_or(false);
                let lod = own.node("lod").and_then(lod);
                if own.node("files").and_then(Node::list).is_some_and(<[Node]>::is_empty) {
                    let message = "is empty: name the files, or leave the key away for the scene's own city";
                    self.checker.note(&own.place, "files", own.line("files"), message);
                }
                let derive = content::derived(&own, &mut self.checker);
                Some(Content {
                    files: self.files(&own, false),
                    lod,
                    derive,
                    class,
                    clip: Clip::Order,
                    keep_terrain,
                    copied,
                })
            }
        };
        if content.is_none() && fields.given("clip") {
            let message = "has a meaning only for a lens with content";
            self.checker.note(&fields.place, "clip", fields.line("clip"), message);
        }
        if content.is_none() && !fields.given("content") && fields.text("kind") == Some("content") {
            let message = "is missing: a content lens shows something. For example content = { lod = \"1.2\" }";
            self.checker.note(&fields.place, "content", fields.place.line, message);
        }
        content.map(|content| Content { clip: clip.unwrap_or_default(), ..content })
    }

    fn placement(&mut self, fields: &Fields) -> Placement {
        let of_camera = fields.text("placement") == Some("camera");
        let Some(node) = fields.node("attached_to") else {
            return if of_camera { Placement::Camera } else { Placement::World };
        };
        if of_camera {
            let message = "is given together with placement = \"camera\": a lens is fixed to one of them";
            self.checker.note(&fields.place, "attached_to", node.line, message);
        }
        let place = fields.place.within("attached_to", node.line);
        let own = self.checker.fields(node, &keys::ATTACHED_TO, &[], place);
        match (own.text("object"), own.text("poi")) {
            (Some(id), None) if !own.given("poi") => return Placement::Object(id.to_owned()),
            (None, Some(name)) if !own.given("object") => return Placement::Poi(name.to_owned()),
            (None, None) if own.given("object") || own.given("poi") => {}
            (None, None) => {
                self.checker.note(&own.place, "", node.line, "is empty: give object = \"ID\" or poi = \"NAME\"");
            }
            _ => {
                let message = "is given together with object: a lens is attached to one of them";
                self.checker.note(&own.place, "poi", own.line("poi"), message);
            }
        }
        Placement::World
    }

    fn shapes(&mut self, fields: &Fields, must: bool) -> Vec<Focus> {
        match (fields.given("shape"), fields.given("shapes")) {
            (true, true) => {
                let message = "is given together with shape: put all of them into shapes";
                self.checker.note(&fields.place, "shapes", fields.line("shapes"), message);
            }
            (false, false) if must => {
                let message = "is missing: a lens acts somewhere. For example shape = { kind = \"sphere\", center = [x, y, z], radius = 60.0 }";
                self.checker.note(&fields.place, "shape", fields.place.line, message);
            }
            _ => {}
        }
        let one = fields.node("shape").map(|n| ("shape".to_owned(), n));
        let many = fields.node("shapes").and_then(Node::list).unwrap_or_default();
        let many = many.iter().enumerate().map(|(i, n)| (format!("shapes.{i}"), n));
        one.into_iter()
            .chain(many)
            .filter_map(|(key, node)| self.shape(node, &fields.place.within(&key, node.line)))
            .collect()
    }

    fn shape(&mut self, node: &Node, place: &Place) -> Option<Focus> {
        let Data::Table(entries) = &node.data else {
            self.checker.note(
                place,
                "",
                node.line,
                format!("must be a table {{ kind = ..., ... }}, is {}", node.quoted()),
            );
            return None;
        };
        let kind = entries.iter().find(|(k, ..)| k == "kind").map(|(.., n)| n);
        let names = || shape_keys::SHAPES.iter().map(|s| s.name);
        let all = names().collect::<Vec<_>>().join(", ");
        let Some(table) = kind.and_then(Node::text).and_then(|k| shape_keys::SHAPES.iter().find(|s| s.name == k))
        else {
            let (line, message) = match kind {
                None => (node.line, format!("is missing: one of {all}")),
                Some(n) => {
                    let hint = did_you_mean(n.text().unwrap_or_default(), names());
                    (n.line, format!("must be one of {all}, is {}{hint}", n.quoted()))
                }
            };
            self.checker.note(place, "kind", line, message);
            return None;
        };
        let fields = self.checker.fields(node, table, &[], place.clone());
        let how = Operation::ALL.into_iter().find(|how| how.word() == table.name);
        if how.is_some() || table.name == "enclosed" {
            let nodes = fields.node("shapes").and_then(Node::list)?;
            let part =
                |(i, node): (usize, &Node)| self.shape(node, &fields.place.within(&format!("shapes.{i}"), node.line));
            let parts: Vec<Focus> = nodes.iter().enumerate().filter_map(part).collect();
            let whole = fields.boolean("whole").unwrap_or(false);
            let types = fields.node("types").and_then(Node::list).unwrap_or_default();
            if fields.given("types") && types.is_empty() {
                self.checker.note(&fields.place, "types", fields.line("types"), "must name at least one type");
            }
            let types = types.iter().filter_map(|n| n.text().map(str::to_owned)).collect();
            return (parts.len() == nodes.len()).then_some(match how {
                Some(how) => Focus::Combined { how, parts },
                None => Focus::Enclosed { parts, whole, types },
            });
        }
        let turn = rotation(fields.node("rotation_deg").and_then(Node::numbers::<3>).unwrap_or([0.0; 3]));
        let (checker, options, lacks_data) = (&mut self.checker, self.options, &mut self.lacks_data);
        let mut reader = Reader { checker, options, lacks_data };
        if shape_keys::FOCUSES.contains(&table.name) {
            return reader.focus(table.name, &fields, turn);
        }
        if table.name == "flat" {
            let given: Vec<&str> = ["radius", "size", "points"].into_iter().filter(|key| fields.given(key)).collect();
            let message = match given[..] {
                [_] => None,
                [] => Some("is missing: a flat lens has a radius, a size = [width, height] or points".to_owned()),
                [first, ..] => Some(format!("is given together with {first}: a flat lens has one figure")),
            };
            if let Some(message) = message {
                self.checker.note(place, given.last().unwrap_or(&"radius"), node.line, message);
            }
        }
        let shape = built_shape(table.name, &fields)?;
        if let Err(error) = shape.check() {
            let key = ["points", "planes"].into_iter().find(|key| fields.given(key)).unwrap_or("");
            self.checker.note(place, key, node.line, error.to_string());
        }
        Some(shape.into())
    }

    /// What other readers work with.
    pub(super) fn parts(&mut self) -> (&mut Checker, &'o Options, &mut bool) {
        (&mut self.checker, self.options, &mut self.lacks_data)
    }

    /// The effects of a lens or of the context that a key lists, and what its effect `lod` shows, with the line of that.
    pub(super) fn effects(
        &mut self,
        fields: &Fields,
        key: &str,
        in_lens: bool,
    ) -> (Vec<EffectUse>, Option<(Content, u32)>) {
        let mut effects = Vec::new();
        let mut content: Option<(Content, u32)> = None;
        let mut scene_style: Option<String> = None;
        for (i, node) in fields.node(key).and_then(Node::list).unwrap_or_default().iter().enumerate() {
            let place = fields.place.within(&format!("{key}.{i}"), node.line);
            let Some(used) = self.effect(node, &place, in_lens) else { continue };
            if used.effect == effect::LOD {
                if content.is_some() {
                    self.checker.note(&place, "", node.line, "is a second \"lod\"; a lens shows one");
                }
                content = Some((self.lod_effect(&used, node, &place, in_lens), node.line));
                continue;
            }
            let is_scene_style = find_effect(&used.effect).is_some_and(|e| e.kind == EffectKind::Scene);
            match &scene_style {
                Some(first) if is_scene_style => {
                    let message =
                        format!("\"{}\" is a second scene style beside \"{first}\"; only one is possible", used.effect);
                    self.checker.note(&place, "", node.line, message);
                }
                None if is_scene_style => scene_style = Some(used.effect.clone()),
                _ => {}
            }
            effects.push(used);
        }
        (effects, content)
    }

    /// What the effect `lod` shows.
    fn lod_effect(&mut self, used: &EffectUse, node: &Node, place: &Place, in_lens: bool) -> Content {
        let mut note = |key: &str, message: String| self.checker.note(place, key, node.line, message);
        if !in_lens {
            note("", "has a meaning only in a lens; for the context [city] lod = \"1.2\" would be right".to_owned());
        }
        let lod = match used.parameters.get("lod") {
            Some(Parameter::Text(text)) => Lod::parse(text),
            Some(Parameter::Number(number)) => Lod::parse(&number.to_string()),
            _ => None,
        };
        if lod.is_none() {
            let given = if used.parameters.contains_key("lod") { "must be" } else { "is missing:" };
            note("lod", format!("{given} {}", Kind::Lod.describe()));
        }
        for key in used.parameters.keys().filter(|key| *key != "lod") {
            note(key, format!("\"lod\" has no such parameter{}", did_you_mean(key, ["lod", "class"].into_iter())));
        }
        for (key, _) in [("blend", used.blend.is_some()), ("weight", used.weight.is_some())].iter().filter(|k| k.1) {
            note(key, "\"lod\" shows something else; there is nothing to blend".to_owned());
        }
        Content { lod, class: used.class, ..Content::default() }
    }

    fn effect(&mut self, node: &Node, place: &Place, in_lens: bool) -> Option<EffectUse> {
        let mut used = EffectUse {
            effect: String::new(),
            class: Class::Inside,
            blend: None,
            weight: None,
            parameters: BTreeMap::new(),
        };
        let mut lines: BTreeMap<&str, u32> = BTreeMap::new();
        match &node.data {
            Data::Text(name) => used.effect.clone_from(name),
            Data::Table(entries) => {
                for (key, line, value) in entries {
                    lines.insert(key, *line);
                    match (key.as_str(), value.text()) {
                        ("effect", Some(name)) => name.clone_into(&mut used.effect),
                        ("class", _) if !in_lens => {
                            self.checker.note(
                                place,
                                key,
                                *line,
                                "has a meaning only in a lens: the context is everything",
                            );
                        }
                        ("class", Some(word)) if class_of(word).is_some() => {
                            used.class = class_of(word).unwrap_or_default();
                        }
                        ("blend", Some(word)) if Blend::parse(word).is_some() => used.blend = Blend::parse(word),
                        ("weight", _) if matches!(parameter(value), Some(Parameter::Number(_))) => {
                            used.weight = match parameter(value) {
                                Some(Parameter::Number(n)) => Some(n),
                                _ => None,
                            };
                        }
                        ("effect" | "class" | "blend" | "weight", text) => {
                            let (what, words): (String, &[&str]) = match key.as_str() {
                                "class" => (format!("one of {}", CLASSES.join(", ")), CLASSES),
                                "blend" => (format!("one of {}", Blend::WORDS.join(", ")), &Blend::WORDS),
                                "weight" => ("a number 0 to 1".into(), &[]),
                                _ => ("the name of an effect".into(), &[]),
                            };
                            let hint = text.map_or_else(String::new, |t| did_you_mean(t, words.iter().copied()));
                            self.checker.note(
                                place,
                                key,
                                *line,
                                format!("must be {what}, is {}{hint}", value.quoted()),
                            );
                        }
                        _ => match parameter(value) {
                            Some(value) => {
                                used.parameters.insert(key.clone(), value);
                            }
                            None => self.checker.note(
                                place,
                                key,
                                *line,
                                format!("{} is no value of a parameter", value.quoted()),
                            ),
                        },
                    }
                }
                if used.effect.is_empty() {
                    if !lines.contains_key("effect") {
                        self.checker.note(place, "effect", node.line, "is missing: the name of an effect");
                    }
                    return None;
                }
            }
            _ => {
                let message = format!("must be a name or a table {{ effect = NAME, ... }}, is {}", node.quoted());
                self.checker.note(place, "", node.line, message);
                return None;
            }
        }
        if used.effect == effect::LOD {
            return Some(used);
        }
        for problem in effect::check(&used) {
            let line = lines.get(problem.key.as_str()).copied().unwrap_or(node.line);
            let key = if problem.key == "effect" && lines.is_empty() { "" } else { &problem.key };
            self.checker.note(place, key, line, problem.message);
        }
        Some(used)
    }
}

/// Whether nothing is there. What is there and cannot be read, loading tells.
fn is_absent(path: &Path) -> bool {
    let is_builtin = path.to_string_lossy().starts_with(builtin::PREFIX);
    !is_builtin && std::fs::metadata(path).is_err_and(|error| error.kind() == ErrorKind::NotFound)
}

/// A camera, of `[camera]` or of a table with its keys.
fn camera(checker: &mut Checker, fields: &Fields) -> Option<Camera> {
    let (eye, target) = (fields.point("eye")?, fields.point("target")?);
    let up = fields.point("up").unwrap_or(DVec3::Z);
    let fov_y = fields.number("fov_deg").unwrap_or(DEFAULT_FOV_DEG).to_radians();
    let distance = eye.distance(target);
    let projection = if fields.text("projection") == Some("orthographic") {
        let seen = 2.0 * distance * (0.5 * fov_y).tan();
        Projection::Orthographic { height_m: fields.number("height_m").unwrap_or(seen) }
    } else {
        if fields.given("height_m") && !(fields.given("projection") && fields.text("projection").is_none()) {
            let message = "has a meaning only with projection = \"orthographic\"";
            checker.note(&fields.place, "height_m", fields.line("height_m"), message);
        }
        Projection::Perspective { fov_y }
    };
    let near_m = fields.number("near_m").unwrap_or_else(|| default_near_m(distance));
    let camera = Camera { eye, target, up, projection, near_m };
    if let Err(error) = camera.check() {
        let key = match error {
            CameraError::EyeIsTarget(..) => "target",
            CameraError::FieldOfView(_) => "fov_deg",
            CameraError::Height(_) => "height_m",
            CameraError::Near(_) => "near_m",
            CameraError::NotFinite(_) | CameraError::Size(..) => "eye",
        };
        checker.note(&fields.place, key, fields.line(key), error.to_string());
    }
    Some(camera)
}

fn class_of(word: &str) -> Option<Class> {
    Some(match word {
        "inside" => Class::Inside,
        "front" => Class::Front,
        "behind" => Class::Behind,
        "rest" => Class::Rest,
        _ => return None,
    })
}

fn built_shape(kind: &str, fields: &Fields) -> Option<Shape> {
    let center = fields.point("center");
    let turned = || rotation(fields.node("rotation_deg").and_then(Node::numbers::<3>).unwrap_or([0.0; 3]));
    let axis = || {
        let axis = fields.point("axis").unwrap_or(DVec3::Z);
        // A unit axis stays as it is, to the bit: written and read again it must not drift.
        if (axis.length_squared() - 1.0).abs() < 1e-15 { Some(axis) } else { axis.try_normalize() }
    };
    let points = || {
        let list = fields.node("points").and_then(Node::list)?;
        Some(list.iter().filter_map(|p| p.numbers::<3>().map(DVec3::from)).collect())
    };
    Some(match kind {
        "sphere" => Shape::Sphere { center: center?, radius: fields.number("radius")? },
        "ellipsoid" => Shape::Ellipsoid { center: center?, radii: fields.point("radii")?, rotation: turned() },
        "box" => Shape::Box { center: center?, size: fields.point("size")?, rotation: turned() },
        "cylinder" => Shape::Cylinder {
            center: center?,
            radius: fields.number("radius")?,
            height: fields.number("height")?,
            axis: axis()?,
        },
        "cone" | "frustum" => Shape::Frustum {
            center: center?,
            radius: fields.number("radius")?,
            top_radius: if kind == "cone" { 0.0 } else { fields.number("top_radius")? },
            height: fields.number("height")?,
            axis: axis()?,
        },
        "corridor" => {
            Shape::Corridor { points: points()?, width: fields.number("width")?, height: fields.number("height")? }
        }
        "polytope" => {
            let list = fields.node("planes").and_then(Node::list)?;
            Shape::Polytope { planes: list.iter().filter_map(Node::numbers::<4>).collect() }
        }
        "flat" => {
            let figure = if let Some(radius) = fields.number("radius") {
                FlatFigure::Disc { radius }
            } else if let Some(size) = fields.node("size").and_then(Node::numbers::<2>) {
                FlatFigure::Rectangle { size: size.into() }
            } else {
                let list = fields.node("points").and_then(Node::list)?;
                FlatFigure::Polygon { points: list.iter().filter_map(|p| p.numbers::<2>().map(DVec2::from)).collect() }
            };
            Shape::Flat { center: center?, rotation: turned(), figure }
        }
        _ => Shape::Convex { points: points()? },
    })
}

pub(super) fn parameter(node: &Node) -> Option<Parameter> {
    match &node.data {
        Data::Boolean(b) => Some(Parameter::Boolean(*b)),
        Data::Integer(_) | Data::Number(_) => node.number().map(Parameter::Number),
        Data::Text(t) => Some(Parameter::Text(t.clone())),
        Data::List(list) => {
            let numbers: Vec<f64> = list.iter().filter_map(Node::number).collect();
            let texts: Vec<String> = list.iter().filter_map(|n| n.text().map(str::to_owned)).collect();
            match list.len() {
                n if n == numbers.len() => Some(Parameter::Numbers(numbers)),
                n if n == texts.len() => Some(Parameter::Texts(texts)),
                _ => None,
            }
        }
        Data::Table(_) | Data::Date(_) => None,
    }
}

fn sun(fields: &Fields) -> Sun {
    let default = Sun::default();
    let radians = |key, default: f64| fields.number(key).map_or(default, f64::to_radians);
    Sun {
        azimuth: radians("azimuth_deg", default.azimuth),
        elevation: radians("elevation_deg", default.elevation),
        shadows: fields.boolean("shadows").unwrap_or(default.shadows),
    }
}
