//! The top of scene files: their tables, one after the other, and what holds between them.

use std::collections::BTreeMap;

use crate::{
    figure::scene_file::{
        animation::{self, ANIMATION},
        camera::{self, CAMERA, Eye},
        check::{Fields, Place},
        city::{CITY, CITY_ROWS, SUN, SUN_ROWS},
        figure::{self, FIGURE, FIGURE_ROWS},
        keys::{Key, Kind, Table, key},
        lens::{self, LENS},
        node::{Data, Node},
        overlay::{self, LAYOUT, LAYOUT_ROWS, OVERLAY},
        paths::Options,
        poi::{self, POI},
        reader::Reader,
        row,
        style::{STYLE, STYLE_ROWS},
        trajectory::{self, TIME, TIME_ROWS, TRAJECTORY},
        volume::{self, VOLUME},
    },
    scene::{self, CitySpec, Figure, Layout, Scene, SceneProblem, Style, Sun},
};

/// A key of the whole file.
pub struct Section {
    /// Its name, its table and its text.
    key: Key,
    /// How the scene has it.
    holds: Holds,
}

/// How a scene has a key of the file.
enum Holds {
    /// The version: a number that says nothing of the scene.
    Version,
    /// A table, and how it is written and read.
    Table(fn(&Scene, &Options) -> Option<Data>, fn(&mut Reader, &Fields, &mut Scene)),
    /// Tables: how many there are, and how the one at a place is written and read, which is put to that place or at the end.
    Tables(fn(&Scene) -> usize, fn(&Scene, usize, &Options) -> Data, fn(&mut Reader, &Fields, usize, &mut Scene)),
}

const SECTIONS: &[Section] = &[
    Section {
        key: key("veduta", Kind::Integer { min: 1, max: 1 }, "", "", "Version of the format.", "1"),
        holds: Holds::Version,
    },
    Section {
        key: key(
            "city",
            Kind::Table(&CITY),
            "no city",
            "",
            "Which city, and how much of it.",
            "{ files = [\"a.city.json\"] }",
        ),
        holds: Holds::Table(
            |scene, options| said(row::written(CITY_ROWS, &scene.city, &CitySpec::default(), options)),
            |reader, fields, scene| {
                scene.city = CitySpec::default();
                row::read(CITY_ROWS, fields, reader, &mut scene.city);
            },
        ),
    },
    Section {
        key: key(
            "camera",
            Kind::Table(&CAMERA),
            "a good first view",
            "",
            "The eye.",
            "{ eye = [0, -90, 60], target = [0, 0, 5] }",
        ),
        holds: Holds::Table(
            |scene, options| {
                let above_ground = scene.camera_above_ground;
                scene.camera.map(|camera| camera::written(&Eye { camera, above_ground }, options))
            },
            |reader, fields, scene| {
                let eye = camera::read(reader, fields);
                scene.camera = eye.map(|eye| eye.camera);
                scene.camera_above_ground = eye.is_some_and(|eye| eye.above_ground);
            },
        ),
    },
    Section {
        key: key("sun", Kind::Table(&SUN), "from the south-west", "", "Light.", "{ azimuth_deg = 215.0 }"),
        holds: Holds::Table(
            |scene, options| said(row::written(SUN_ROWS, &scene.sun, &Sun::default(), options)),
            |reader, fields, scene| {
                scene.sun = Sun::default();
                row::read(SUN_ROWS, fields, reader, &mut scene.sun);
            },
        ),
    },
    Section {
        key: key("time", Kind::Table(&TIME), "the beginning", "", "Which moment is shown.", "{ at_s = 12.5 }"),
        holds: Holds::Table(
            |scene, options| said(row::written(TIME_ROWS, scene, &Scene::default(), options)),
            |reader, fields, scene| {
                (scene.time_s, scene.moment, scene.time_steps) = (0.0, None, Vec::new());
                row::read(TIME_ROWS, fields, reader, scene);
            },
        ),
    },
    Section {
        key: key("style", Kind::Table(&STYLE), "natural", "", "How the context looks.", "{ base = \"clay\" }"),
        holds: Holds::Table(
            |scene, options| said(row::written(STYLE_ROWS, &scene.style, &Style::default(), options)),
            |reader, fields, scene| {
                scene.style = Style::default();
                row::read(STYLE_ROWS, fields, reader, &mut scene.style);
            },
        ),
    },
    Section {
        key: key(
            "trajectory",
            Kind::Tables(&TRAJECTORY),
            "none",
            "",
            "Ways that points of interest move along.",
            "[{ name = \"tram\", points = [[0, 0, 2], [80, 0, 2]], speed_m_s = 8.0 }]",
        ),
        holds: Holds::Tables(
            |scene| scene.trajectories.len(),
            |scene, i, options| trajectory::written(i, &scene.trajectories[i], options),
            |reader, fields, i, scene| put(&mut scene.trajectories, i, trajectory::read(reader, fields, i)),
        ),
    },
    Section {
        key: key(
            "poi",
            Kind::Tables(&POI),
            "none",
            "",
            "Points of interest.",
            "[{ name = \"hall\", object = \"ID\" }]",
        ),
        holds: Holds::Tables(
            |scene| scene.pois.len(),
            |scene, i, options| poi::written(&scene.pois[i], options),
            |reader, fields, i, scene| put(&mut scene.pois, i, poi::read(reader, fields, i)),
        ),
    },
    Section {
        key: key(
            "volume",
            Kind::Tables(&VOLUME),
            "none",
            "",
            "Fields that stand in the city.",
            "[{ file = \"builtin:plume\", origin = [0, 0, 0], spacing = [10, 10, 5] }]",
        ),
        holds: Holds::Tables(
            |scene| scene.volumes.len(),
            |scene, i, options| volume::written(&scene.volumes[i], options),
            |reader, fields, i, scene| put(&mut scene.volumes, i, volume::read(reader, fields, i)),
        ),
    },
    Section {
        key: key("lens", Kind::Tables(&LENS), "none", "", "Lenses, bottom to top: the last is the top lens.", "[]"),
        holds: Holds::Tables(
            |scene| scene.lenses.len(),
            |scene, i, options| lens::written(i, &scene.lenses[i], options),
            |reader, fields, i, scene| put(&mut scene.lenses, i, Some(lens::read(reader, fields, i))),
        ),
    },
    Section {
        key: key(
            "overlay",
            Kind::Tables(&OVERLAY),
            "one for each best-view lens",
            "",
            "How pictures of best-view lenses stand over the main one.",
            "[{ lens = \"cathedral\", size = [320, 200] }]",
        ),
        holds: Holds::Tables(
            |scene| scene.overlays.len(),
            |scene, i, options| overlay::written(&scene.overlays[i], options),
            |reader, fields, i, scene| put(&mut scene.overlays, i, Some(overlay::read(reader, fields))),
        ),
    },
    Section {
        key: key(
            "layout",
            Kind::Table(&LAYOUT),
            "around the border",
            "",
            "Where overlays stand.",
            "{ along = \"right\" }",
        ),
        holds: Holds::Table(
            |scene, options| said(row::written(LAYOUT_ROWS, &scene.layout, &Layout::default(), options)),
            |reader, fields, scene| {
                scene.layout = Layout::default();
                row::read(LAYOUT_ROWS, fields, reader, &mut scene.layout);
            },
        ),
    },
    Section {
        key: key(
            "figure",
            Kind::Table(&FIGURE),
            "1280x720, 16 samples",
            "",
            "How a picture is made.",
            "{ size = [1920, 1080] }",
        ),
        holds: Holds::Table(
            |scene, options| said(row::written(FIGURE_ROWS, &scene.figure, &Figure::default(), options)),
            |reader, fields, scene| scene.figure = figure::read(reader, fields),
        ),
    },
    Section {
        key: key(
            "animation",
            Kind::Table(&ANIMATION),
            "none",
            "",
            "What changes from frame to frame.",
            "{ frames = 120, change = [] }",
        ),
        holds: Holds::Table(
            |scene, options| scene.animation.as_ref().map(|animation| animation::written(animation, options)),
            |reader, fields, scene| scene.animation = animation::read(reader, fields, scene),
        ),
    },
];

/// The whole file.
pub const ROOT: Table = Table { name: "", doc: "The top of the file.", keys: &keys::<{ SECTIONS.len() }>() };

const fn keys<const N: usize>() -> [Key; N] {
    let mut keys = [SECTIONS[0].key; N];
    let mut i = 0;
    while i < N {
        keys[i] = SECTIONS[i].key;
        i += 1;
    }
    keys
}

/// A table that says something.
fn said(table: Data) -> Option<Data> {
    (!table.is_empty_table()).then_some(table)
}

/// Puts an element to its place, or at the end.
fn put<T>(all: &mut Vec<T>, at: usize, element: Option<T>) {
    match (all.get_mut(at), element) {
        (Some(place), Some(element)) => *place = element,
        (None, Some(element)) => all.push(element),
        (_, None) => {}
    }
}

/// The section of a key.
pub fn section(name: &str) -> Option<&'static Section> {
    SECTIONS.iter().find(|section| section.key.name == name)
}

/// The scene as the tree of its file. Keys at their default are left out.
pub fn written(scene: &Scene, options: &Options) -> Node {
    let of = |section: &Section| Some((section.key.name, section.written(scene, options)?));
    Node::of(Data::table(SECTIONS.iter().filter_map(of)))
}

/// Reads a whole file.
pub fn read(reader: &mut Reader, root: &Node) -> Scene {
    let place = Place { table: String::new(), prefix: String::new(), line: 1 };
    let top = reader.checker.fields(root, &ROOT, &[], place);
    let mut scene = Scene::default();
    for section in SECTIONS {
        if let Some(node) = top.node(section.key.name) {
            section.read(reader, node, &mut scene);
        }
    }
    check(reader, &scene, &|table| top.node(table).and_then(Node::list).unwrap_or_default());
    scene
}

impl Section {
    /// What a scene has of it; `None`: all of it is at its default.
    pub fn written(&self, scene: &Scene, options: &Options) -> Option<Data> {
        match self.holds {
            Holds::Version => Some(Data::Integer(1)),
            Holds::Table(written, _) => written(scene, options),
            Holds::Tables(count, written, _) => {
                let count = count(scene);
                (count > 0).then(|| Data::list((0..count).map(|i| written(scene, i, options))))
            }
        }
    }

    /// Whether it is one table.
    pub fn is_table(&self) -> bool {
        matches!(self.holds, Holds::Table(..))
    }

    /// Whether it is a list of tables.
    pub fn has_tables(&self) -> bool {
        matches!(self.holds, Holds::Tables(..))
    }

    /// One of its tables; `None` where it has none, or not so many.
    pub fn element(&self, scene: &Scene, index: usize, options: &Options) -> Option<Data> {
        match self.holds {
            Holds::Tables(count, written, _) if index < count(scene) => Some(written(scene, index, options)),
            _ => None,
        }
    }

    /// The place of the table of this name.
    pub fn place_of(&self, scene: &Scene, name: &str) -> Option<usize> {
        match self.key.name {
            "trajectory" => scene.trajectories.iter().position(|way| way.name == name),
            "poi" => scene.pois.iter().position(|poi| poi.name == name),
            "volume" => scene.volumes.iter().position(|volume| volume.name == name),
            "lens" => scene.lenses.iter().position(|lens| lens.name == name),
            _ => None,
        }
    }

    /// Takes it over into a scene.
    pub fn read(&self, reader: &mut Reader, node: &Node, scene: &mut Scene) {
        match (&self.key.kind, &self.holds) {
            (Kind::Table(table), Holds::Table(_, read)) => {
                let place = Place { table: self.key.name.into(), prefix: String::new(), line: node.line };
                let fields = reader.checker.fields(node, table, &[], place);
                read(reader, &fields, scene);
            }
            (_, Holds::Tables(..)) => {
                for (i, element) in node.list().unwrap_or_default().iter().enumerate() {
                    self.read_element(reader, element, i, scene);
                }
            }
            _ => {}
        }
    }

    /// Takes one of its tables over.
    pub fn read_element(&self, reader: &mut Reader, element: &Node, index: usize, scene: &mut Scene) {
        let (Kind::Tables(table), Holds::Tables(_, _, read)) = (&self.key.kind, &self.holds) else { return };
        let place = Place { table: format!("{}.{index}", self.key.name), prefix: String::new(), line: element.line };
        let noted = reader.checker.problems.len();
        let fields = reader.checker.fields(element, table, &[], place);
        read(reader, &fields, index, scene);
        // What else a lens of an unknown kind may have is not known.
        if fields.is_bad("kind") {
            reader.checker.keep_after(noted, "kind");
        }
    }
}

/// Notes what is wrong between tables: names that two have, or none.
pub fn check<'n>(reader: &mut Reader, scene: &Scene, lists: &dyn Fn(&str) -> &'n [Node]) {
    unique(reader, "lens", lists("lens"), scene.lenses.iter().map(|lens| lens.name.as_str()));
    unique(reader, "poi", lists("poi"), scene.pois.iter().map(|poi| poi.name.as_str()));
    unique(reader, "volume", lists("volume"), scene.volumes.iter().map(|volume| volume.name.as_str()));
    unique(reader, "trajectory", lists("trajectory"), scene.trajectories.iter().map(|way| way.name.as_str()));
    // Of a way that is wrong it is told already.
    let is_whole = lists("trajectory").len() <= scene.trajectories.len();
    let of_ways = if is_whole { scene::trajectory::problems(scene) } else { Vec::new() };
    for SceneProblem { table, key, message, .. } in scene::overlay::problems(scene).into_iter().chain(of_ways) {
        let (name, index) = table.split_once('.').unwrap_or_default();
        let node = index.parse().ok().and_then(|i: usize| lists(name).get(i));
        let line = node.and_then(|node| node.entry(&key).or(Some(node))).map_or(1, |node| node.line);
        let place = Place { table: table.clone(), prefix: String::new(), line };
        reader.checker.note(&place, &key, line, message);
    }
}

fn unique<'a>(reader: &mut Reader, table: &str, nodes: &[Node], names: impl Iterator<Item = &'a str>) {
    let mut seen: BTreeMap<&str, usize> = BTreeMap::new();
    for (i, name) in names.enumerate() {
        if let Some(first) = seen.insert(name, i) {
            let line = nodes.get(i).map_or(1, |n| n.line);
            let place = Place { table: format!("{table}.{i}"), prefix: String::new(), line };
            let message = format!("\"{name}\" is the name of {table}.{first} already; names must differ");
            reader.checker.note(&place, "name", line, message);
        }
    }
}
