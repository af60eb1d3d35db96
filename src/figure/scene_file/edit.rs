//! One value of a scene, as a command: typed, or as `--set PATH=VALUE`.
//!
//! The table that holds the value is written by its rows, changed and read again: the same checks, the same messages.

use crate::{
    figure::scene_file::{
        check::Problem,
        keys,
        node::{self, Data, Node},
        paths::Options,
        problems::SceneFileError,
        reader::Reader,
        scene::{self, ROOT},
        text,
    },
    lens::nearest::did_you_mean,
    scene::{Command, Scene},
};

/// What as a value takes a key, or an element of a list, away.
const UNSET: &str = "unset";
/// Keys of a table of which giving one takes the others away.
pub const FORMS: [&[&str]; 3] =
    [&["shape", "shapes"], &["text_px", "text_pt"], &["ids", "types", "where", "attribute"]];

/// Another value for a key.
#[derive(Clone, Debug, PartialEq)]
pub struct Edit {
    /// The way to it, as it is shown.
    path: String,
    segments: Vec<String>,
    value: Option<Data>,
}

impl Edit {
    /// What stands at `path` becomes `value`; `None` takes it away.
    ///
    /// A path is keys and, in lists, places from 0 or names: `lens.0.shape.radius`, `lens.NAME.enabled`, `lens."a.b".color`; the place after
    /// the last adds an element.
    ///
    /// # Errors
    /// What is wrong with the path.
    pub fn new(path: &str, value: Option<Data>) -> Result<Self, SceneFileError> {
        let segments = segments_of(path).map_err(|message| failure(path, path, message))?;
        Ok(Self { path: path.to_owned(), segments, value })
    }

    /// The edit of `PATH=VALUE`. The value is TOML, or a bare word, which is a text; `unset` takes the key or element away.
    ///
    /// # Errors
    /// What is wrong with the assignment.
    pub fn of_assignment(assignment: &str) -> Result<Self, SceneFileError> {
        let name = format!("--set {assignment}");
        let (path, value) = split(assignment)
            .ok_or_else(|| failure(&name, "", "must be PATH=VALUE, for example lens.0.shape.radius=80".into()))?;
        let segments = segments_of(path).map_err(|message| failure(&name, path, message))?;
        let value = value_of(value.trim()).map_err(|message| failure(&name, path, message))?;
        Ok(Self { path: path.to_owned(), segments, value })
    }

    /// The way to the value.
    pub fn path(&self) -> &str {
        &self.path
    }

    /// The command that does it; paths of files are written and read with `options`.
    ///
    /// # Errors
    /// There is no such key, or the scene would not be right.
    pub fn command(&self, scene: &Scene, options: &Options) -> Result<Command, SceneFileError> {
        Ok(self.command_to(scene, self.after(scene, options)?))
    }

    /// The scene after it.
    ///
    /// # Errors
    /// As for [`Self::command`].
    pub fn after(&self, scene: &Scene, options: &Options) -> Result<Scene, SceneFileError> {
        self.done(scene, &self.path, options, options)
    }

    fn command_to(&self, scene: &Scene, after: Scene) -> Command {
        Command::new(format!("set {}", self.path), scene.clone(), after)
    }

    fn done(&self, scene: &Scene, name: &str, written: &Options, read: &Options) -> Result<Scene, SceneFileError> {
        if let Some(after) = self.within_table(scene, written, read) {
            return Ok(after);
        }
        let mut root = scene::written(scene, written);
        assign(&mut root, &self.segments, self.value.as_ref()).map_err(|message| failure(name, &self.path, message))?;
        self::read(&root, name, read)
    }

    /// The scene after the edit of one table; `None` where more is to be done, or something is wrong.
    fn within_table(&self, scene: &Scene, written: &Options, read: &Options) -> Option<Scene> {
        let (first, rest) = self.segments.split_first()?;
        let section = scene::section(first)?;
        let mut reader = Reader::new(read);
        let mut after = scene.clone();
        let is_element = rest.first().filter(|_| rest.len() > 1);
        if let Some(at) = is_element {
            let index = at.parse().ok().or_else(|| section.place_of(scene, at));
            if let Some((index, table)) = index.and_then(|i| Some((i, section.element(scene, i, written)?))) {
                let mut table = Node::of(table);
                within(&mut table, &format!("{first}.{index}"), &rest[1], &rest[2..], self.value.as_ref()).ok()?;
                section.read_element(&mut reader, &table, index, &mut after);
                scene::check(&mut reader, &after, &|_| &[]);
                return reader.checker.problems.is_empty().then_some(after);
            }
        }
        // The keys of an animation fall back on the camera.
        let is_alone = section.is_table() && !rest.is_empty() && (first != "camera" || scene.animation.is_none());
        if !is_alone {
            return None;
        }
        let table = section.written(scene, written).unwrap_or_else(|| Data::Table(Vec::new()));
        let mut table = Node::of(table);
        in_table(&mut table, &rest[0], &rest[1..], self.value.as_ref()).ok()?;
        section.read(&mut reader, &table, &mut after);
        scene::check(&mut reader, &after, &|_| &[]);
        reader.checker.problems.is_empty().then_some(after)
    }
}

/// The command for `assignment`, `PATH=VALUE`, see [`Edit::of_assignment`].
///
/// Paths are those of the command line: relative to the current folder, and free to lead anywhere.
///
/// # Errors
/// What is wrong with the assignment, or with the scene that it would make.
pub fn set(scene: &Scene, assignment: &str) -> Result<Command, SceneFileError> {
    set_by(scene, assignment, &Options::default(), &Options::for_command_line())
}

/// [`set`] for an assignment that stands in a file: its paths are read with `options`.
///
/// # Errors
/// As for [`set`].
pub fn set_within(scene: &Scene, assignment: &str, options: &Options) -> Result<Command, SceneFileError> {
    set_by(scene, assignment, options, options)
}

fn set_by(scene: &Scene, assignment: &str, written: &Options, read: &Options) -> Result<Command, SceneFileError> {
    let edit = Edit::of_assignment(assignment)?;
    let after = edit.done(scene, &format!("--set {assignment}"), written, read)?;
    Ok(edit.command_to(scene, after))
}

/// Gives a lens another name, wherever the scene names it: as [`Command::rename_lens`], and in what changes over time.
///
/// # Errors
/// The name is another lens', or empty; there is no lens at `index`.
pub fn rename_lens(scene: &Scene, index: usize, name: &str, options: &Options) -> Result<Command, SceneFileError> {
    let mut after = scene.clone();
    let title = "rename lens";
    if let (Some(lens), Some(command)) = (scene.lenses.get(index), Command::rename_lens(scene, index, name)) {
        command.redo(&mut after);
        for change in after.animation.iter_mut().flat_map(|animation| &mut animation.changes) {
            let Ok(mut way) = segments_of(&change.path) else { continue };
            if way.len() > 1 && way[0] == "lens" && way[1] == lens.name {
                way[1] = name.to_owned();
                change.path = path_of(&way);
            }
        }
    }
    let after = read(&scene::written(&after, options), title, options)?;
    Ok(Command::new(title, scene.clone(), after))
}

/// The path of some segments.
fn path_of(segments: &[String]) -> String {
    let quoted = |segment: &String| match segment.contains(['.', '=']) {
        true => format!("\"{segment}\""),
        false => segment.clone(),
    };
    segments.iter().map(quoted).collect::<Vec<_>>().join(".")
}

fn failure(name: &str, key: &str, message: String) -> SceneFileError {
    SceneFileError {
        name: name.to_owned(),
        problems: vec![Problem { line: 0, table: String::new(), key: key.to_owned(), message }],
        has_lines: false,
        is_data_absent: false,
    }
}

/// The scene that a tree means.
fn read(root: &Node, name: &str, options: &Options) -> Result<Scene, SceneFileError> {
    let mut reader = Reader::new(options);
    let scene = scene::read(&mut reader, root);
    if reader.checker.problems.is_empty() {
        return Ok(scene);
    }
    // Lines bring what is wrong into order, though nobody sees them.
    let error = match node::parse(&text::file(root)) {
        Ok(root) => {
            let mut reader = Reader::new(options);
            scene::read(&mut reader, &root);
            reader.error(name)
        }
        Err((line, message)) => SceneFileError::whole(name, line, message),
    };
    Err(SceneFileError { has_lines: false, ..error })
}

/// Splits at the first `=` outside quotes.
fn split(assignment: &str) -> Option<(&str, &str)> {
    let mut is_quoted = false;
    let at = assignment.find(|c: char| {
        is_quoted ^= c == '"';
        c == '=' && !is_quoted
    })?;
    let (path, value) = (assignment[..at].trim(), &assignment[at + 1..]);
    (!path.is_empty()).then_some((path, value))
}

/// `a."b.c".d` → a, b.c, d.
fn segments_of(path: &str) -> Result<Vec<String>, String> {
    let mut segments = vec![String::new()];
    let mut is_quoted = false;
    for c in path.chars() {
        match c {
            '"' => is_quoted = !is_quoted,
            '.' if !is_quoted => segments.push(String::new()),
            c => segments.last_mut().into_iter().for_each(|s| s.push(c)),
        }
    }
    match segments.iter().position(String::is_empty) {
        _ if is_quoted => Err("a quote is not closed".into()),
        Some(_) => Err("has an empty part between its dots".into()),
        None => Ok(segments),
    }
}

/// TOML, or a bare word; `None` for [`UNSET`].
fn value_of(text: &str) -> Result<Option<Data>, String> {
    if text == UNSET {
        return Ok(None);
    }
    if text.is_empty() {
        return Err("has no value after the =".into());
    }
    match value_of_toml(text) {
        Some(value) => Ok(Some(value)),
        // What begins like TOML was meant as TOML.
        None if text.starts_with(['[', '{', '"', '\'']) => {
            Err(format!("{text} is not a TOML value; texts and lists need their closing quotes and brackets"))
        }
        None => Ok(Some(Data::text(text))),
    }
}

/// One TOML value.
fn value_of_toml(text: &str) -> Option<Data> {
    match node::parse(&format!("v = {text}")).ok()?.data {
        Data::Table(mut entries) if entries.len() == 1 => {
            entries.pop().filter(|(key, ..)| key == "v").map(|e| e.2.data)
        }
        _ => None,
    }
}

fn assign(root: &mut Node, segments: &[String], value: Option<&Data>) -> Result<(), String> {
    let (first, rest) = segments.split_first().ok_or("is empty")?;
    let Some(section) = scene::section(first) else {
        return Err(format!("there is no \"{first}\" in a scene{}", did_you_mean(first, keys::names(&ROOT))));
    };
    // A first lens or point of interest has no list to stand in yet.
    if section.has_tables() && !rest.is_empty() {
        root.entry_or(first, Data::List(Vec::new()));
    }
    in_table(root, first, rest, value)
}

fn in_table(table: &mut Node, key: &str, rest: &[String], value: Option<&Data>) -> Result<(), String> {
    // One shape is written as `shape`, but may be called `shapes.0` as well.
    if key == "shapes"
        && !rest.is_empty()
        && !table.has("shapes")
        && let Some(one) = table.remove("shape")
    {
        table.insert("shapes", Data::List(vec![one]));
    }
    // Giving the one form takes the other away.
    for forms in FORMS {
        if rest.is_empty() && value.is_some() && forms.contains(&key) {
            forms.iter().for_each(|form| drop(table.remove(form)));
        }
    }
    match (rest.split_first(), value) {
        (None, Some(value)) => table.insert(key, value.clone()),
        (None, None) => drop(table.remove(key)),
        (Some((next, rest)), value) => {
            let empty = if next == "0" { Data::List(Vec::new()) } else { Data::Table(Vec::new()) };
            let child = table.entry_or(key, empty).ok_or_else(|| format!("there is no \"{key}\" in it"))?;
            return within(child, key, next, rest, value);
        }
    }
    Ok(())
}

/// Goes one step down into `parent`, which is called `name`.
fn within(parent: &mut Node, name: &str, key: &str, rest: &[String], value: Option<&Data>) -> Result<(), String> {
    match &mut parent.data {
        Data::Table(_) => in_table(parent, key, rest, value),
        Data::List(list) => in_list(list, name, key, rest, value),
        // What has no parameters is written as its word.
        Data::Text(word) if let Some(own) = key_of_word(name, key) => {
            let mut table = Node::of(Data::table([(own, Data::text(&*word))]));
            in_table(&mut table, key, rest, value)?;
            *parent = table;
            Ok(())
        }
        other => Err(format!("\"{name}\" is {}: there is no \"{key}\" in it", text::value(other))),
    }
}

/// The key that a word means, where it may stand for a table.
fn key_of_word(name: &str, key: &str) -> Option<&'static str> {
    match name {
        "render" => Some("as"),
        "transparency" => Some("method"),
        _ => (key == "effect" || name == "effects").then_some("effect"),
    }
}

fn in_list(list: &mut Vec<Node>, name: &str, key: &str, rest: &[String], value: Option<&Data>) -> Result<(), String> {
    let called = |node: &Node| node.entry("name").and_then(Node::text).map(str::to_owned);
    let index = match key.parse::<usize>() {
        Ok(index) => index,
        Err(_) => list.iter().position(|v| called(v).as_deref() == Some(key)).ok_or_else(|| {
            let names: Vec<String> = list.iter().filter_map(called).collect();
            format!("there is no {name} \"{key}\"{}", did_you_mean(key, names.iter().map(String::as_str)))
        })?,
    };
    if index > list.len() || (index == list.len() && value.is_none()) {
        return Err(format!("there is no {name}.{index}: there are {}, from 0", list.len()));
    }
    match (rest.split_first(), value) {
        (None, Some(value)) if index == list.len() => list.push(Node::of(value.clone())),
        (None, Some(value)) => list[index] = Node::of(value.clone()),
        (None, None) => drop(list.remove(index)),
        (Some((next, rest)), value) => {
            if index == list.len() {
                list.push(Node::empty_table(0));
            }
            let child_name = if name == "effects" { name.to_owned() } else { format!("{name}.{index}") };
            within(&mut list[index], &child_name, next, rest, value)?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        figure::scene_file::{parse, to_toml_for},
        geom::Shape,
        lens::Region,
        scene::{BaseStyle, TextSize},
        view::Projection,
    };

    const SCENE: &str = r#"
veduta = 1
[camera]
eye = [0, -90, 60]
target = [0, 0, 5]
[[lens]]
name = "old town"
shape = { kind = "sphere", center = [0, 0, 0], radius = 60.0 }
effects = ["sepia", { effect = "thematic", attribute = "year" }]
[[lens]]
name = "b"
shape = { kind = "box", center = [0, 0, 0], size = [1, 2, 3] }
"#;

    const PEEL: &str = "style.transparency={method=\"peel\"}";

    fn after(assignment: &str) -> Result<Scene, String> {
        let mut scene = parse(SCENE, "s", &Options::for_command_line()).unwrap();
        let command = set(&scene, assignment).map_err(|e| e.to_string())?;
        command.redo(&mut scene);
        Ok(scene)
    }

    #[test]
    fn a_lens_is_renamed_wherever_the_scene_names_it() {
        let text = format!(
            "{SCENE}\n[[poi]]\nname = \"p\"\nat = [0, 0, 0]\n\
             [[lens]]\nname = \"v\"\nkind = \"best-view\"\npoi = \"p\"\nlenses = [\"b\", \"old town\"]\n\
             [[overlay]]\nlens = \"v\"\ncaption = \"old town\"\n\
             [animation]\nframes = 3\nchange = [{{ path = \"lens.old town.shape.radius\", keys = [{{ at = 0, value = 1 }}, {{ at = 1, value = 2 }}] }}]\n"
        );
        let options = Options::for_command_line();
        let mut scene = parse(&text, "s", &options).unwrap_or_else(|error| panic!("{error}"));
        for (index, name) in [(0, "a.b"), (2, "view")] {
            rename_lens(&scene, index, name, &options).unwrap_or_else(|error| panic!("{error}")).redo(&mut scene);
        }
        assert_eq!(scene.lenses.iter().map(|lens| lens.name.as_str()).collect::<Vec<_>>(), ["a.b", "b", "view"]);
        assert_eq!(scene.overlays[0].lens, "view");
        let shown = scene.lenses[2].best_view().and_then(|shown| shown.lenses.clone());
        assert_eq!(shown, Some(vec!["b".to_owned(), "a.b".to_owned()]));
        assert_eq!(scene.animation.as_ref().unwrap().changes[0].path, "lens.\"a.b\".shape.radius");
        // It is the same scene, written and read.
        assert_eq!(parse(&to_toml_for(&scene, &options), "again", &options).unwrap(), scene);
        for (index, wrong) in [(0, "b"), (0, ""), (1, "view")] {
            assert!(rename_lens(&scene, index, wrong, &options).is_err(), "{wrong}");
        }
    }

    #[test]
    fn values_are_set_by_place_and_by_name() {
        let radius = |s: &Scene| match s.lenses[0].shapes[0] {
            Region::Shape(Shape::Sphere { radius, .. }) => radius,
            _ => f64::NAN,
        };
        assert_eq!(radius(&after("lens.0.shape.radius=80").unwrap()), 80.0);
        assert_eq!(radius(&after("lens.old town.shape.radius = 81.5").unwrap()), 81.5);
        assert_eq!(radius(&after("lens.\"old town\".shapes.0.radius=82").unwrap()), 82.0);
        assert!(!after("lens.b.enabled=false").unwrap().lenses[1].enabled);
        assert_eq!(after("figure.size=[64,48]").unwrap().figure.size, [64, 48]);
        assert_eq!(after("city.lod=1.3").unwrap().city.lod.as_deref(), Some("1.3"));
        assert_eq!(after("city.lod=\"2.0\"").unwrap().city.lod.as_deref(), Some("2"));
        assert!(!after("city.ground=false").unwrap().city.ground);
        assert_eq!(after("style.base=clay").unwrap().style.base, BaseStyle::Clay);
        assert_eq!(after("lens.1.color=#ff0000").unwrap().lenses[1].color, [1.0, 0.0, 0.0]);
        assert_eq!(
            after("lens.0.effects.1.attribute=height").unwrap().lenses[0].effects[1].text("attribute"),
            Some("height")
        );
        assert_eq!(after("lens.0.effects.0.amount=0.5").unwrap().lenses[0].effects[0].number("amount"), Some(0.5));
        assert_eq!(after("lens.1.effects.0=sepia").unwrap().lenses[1].effects[0].effect, "sepia");
        assert_eq!(
            after("style.transparency=peel").unwrap().style.transparency,
            after(PEEL).unwrap().style.transparency
        );
        assert!((after("sun.azimuth_deg=90").unwrap().sun.azimuth - std::f64::consts::FRAC_PI_2).abs() < 1e-15);
        let camera = after("camera.projection=orthographic").unwrap().camera.unwrap();
        assert!(matches!(camera.projection, Projection::Orthographic { height_m } if height_m > 10.0));
    }

    /// Parts of what the file leaves to its default, and of what it writes as a word alone.
    #[test]
    fn parts_of_an_occlusion_lens_are_set_by_themselves() {
        let scene = |render: &str| {
            let text = format!(
                "veduta = 1\n[[poi]]\nname = \"p\"\nat = [1, 2, 3]\n[[lens]]\nname = \"o\"\nkind = \"occlusion\"\npoi = \"p\"\n{render}"
            );
            parse(&text, "s", &Options::for_command_line()).unwrap()
        };
        for (render, assignment, whole) in [
            ("", "lens.o.test.coverage=0.05", "test = { kind = \"exact\", coverage = 0.05 }"),
            ("", "lens.o.render.as=x-ray", "render = { as = \"x-ray\" }"),
            (
                "render = \"transparent\"",
                "lens.o.render.opacity=0.25",
                "render = { as = \"transparent\", opacity = 0.25 }",
            ),
        ] {
            let mut set_so = scene(render);
            set(&set_so, assignment).unwrap_or_else(|e| panic!("{assignment}: {e}")).redo(&mut set_so);
            assert_eq!(set_so.lenses[0], scene(whole).lenses[0], "{assignment}");
        }
    }

    #[test]
    fn elements_come_and_go() {
        let added = after("lens.2={name=\"c\", shape={kind=\"sphere\", center=[0,0,0], radius=1}}").unwrap();
        assert_eq!(added.lenses.iter().map(|l| l.name.as_str()).collect::<Vec<_>>(), ["old town", "b", "c"]);
        assert_eq!(after("lens.b=unset").unwrap().lenses.len(), 1);
        assert_eq!(after("poi.0={at=[1,2,3]}").unwrap().pois[0].name, "poi-0");
        assert_eq!(after("lens.0.effects=unset").unwrap().lenses[0].effects, []);
        assert_eq!(after("camera=unset").unwrap().camera, None);
        let mut with_steps = after("time.steps=[{op=\"set\",at=\"1650\"}]").unwrap();
        assert_eq!(with_steps.time_steps.len(), 1);
        set(&with_steps.clone(), "time.steps=unset").unwrap().redo(&mut with_steps);
        assert_eq!(with_steps.time_steps, []);
        let both = after(
            "lens.0.shapes=[{kind=\"sphere\",center=[0,0,0],radius=1},{kind=\"sphere\",center=[9,0,0],radius=1}]",
        );
        assert_eq!(both.unwrap().lenses[0].shapes.len(), 2);
    }

    #[test]
    fn one_size_of_text_takes_the_other_away() {
        let scene = after("figure.text_px=20").unwrap();
        assert_eq!(scene.figure.text, Some(TextSize::Pixels(20.0)));
        let then = |scene: &Scene, assignment: &str| {
            let mut scene = scene.clone();
            set(&scene.clone(), assignment).unwrap().redo(&mut scene);
            scene
        };
        let scene = then(&scene, "figure.text_pt=9");
        assert_eq!((scene.figure.text, scene.figure.text_px()), (Some(TextSize::Points(9.0)), Some(12.0)));
        let scene = then(&scene, "figure.dpi=300");
        assert_eq!((scene.figure.dpi, scene.figure.text_px()), (Some(300.0), Some(37.5)));
        assert_eq!(then(&scene, "figure.text_px=20").figure.text_px(), Some(20.0));
    }

    #[test]
    fn mistakes_name_the_path_and_the_nearest_key() {
        for (assignment, expected) in [
            (
                "lens.0.shape.raduis=80",
                "--set lens.0.shape.raduis=80: [lens.0] shape.raduis: unknown key; did you mean \"radius\"?",
            ),
            (
                "lens.0.shape.radius=-3",
                "--set lens.0.shape.radius=-3: [lens.0] shape.radius: must be a number ≥ 0, is -3",
            ),
            ("lens.old twn.enabled=false", "there is no lens \"old twn\"; did you mean \"old town\"?"),
            ("lens.9.enabled=false", "there is no lens.9: there are 2, from 0"),
            ("cmaera.eye=[0,0,0]", "there is no \"cmaera\" in a scene; did you mean \"camera\"?"),
            ("camera.eye=[0,0", "[0,0 is not a TOML value"),
            ("camera.eye", "must be PATH=VALUE"),
            ("=3", "must be PATH=VALUE"),
            ("lens..x=3", "has an empty part"),
            ("camera.eye=", "has no value after the ="),
            ("veduta.x=3", "\"veduta\" is 1: there is no \"x\" in it"),
            ("time.at=3", "[time] at: must be a time: \"1890\""),
        ] {
            let message = after(assignment).unwrap_err();
            assert!(message.contains(expected), "{assignment}: {message}");
        }
    }

    /// What an edit of ten lenses costs, typed and by way of text: `cargo test --release -- --ignored --nocapture an_edit_costs`.
    #[test]
    #[ignore = "a measurement, which prints"]
    #[allow(clippy::print_stderr, reason = "it is what the measurement is for")]
    fn what_an_edit_costs() {
        let options = Options::for_command_line();
        let lens = |i: usize| {
            format!(
                "[[lens]]\nname = \"l{i}\"\nshape = {{ kind = \"sphere\", center = [{i}, 0, 0], radius = 60.0 }}\neffects = [\"sepia\", {{ effect = \"overlay\", color = \"#ff0000\" }}]\n"
            )
        };
        let text: String = std::iter::once("veduta = 1\n".to_owned()).chain((0..10).map(lens)).collect();
        let scene = parse(&text, "s", &options).unwrap();
        let by_text = |radius: f64| {
            let mut root: toml::Table = to_toml_for(&scene, &options).parse().unwrap();
            root["lens"][0]["shape"]["radius"] = toml::Value::Float(radius);
            parse(&toml::to_string(&root).unwrap(), "s", &options).unwrap()
        };
        let typed = |radius: f64| {
            Edit::new("lens.0.shape.radius", Some(radius.into())).unwrap().after(&scene, &options).unwrap()
        };
        assert_eq!(by_text(7.5), typed(7.5));
        let median = |edit: &dyn Fn(f64) -> Scene| {
            let mut times: Vec<f64> = (0..201)
                .map(|i| {
                    let start = std::time::Instant::now();
                    std::hint::black_box(edit(1.0 + f64::from(i)));
                    start.elapsed().as_secs_f64() * 1e6
                })
                .collect();
            times.sort_by(f64::total_cmp);
            times[times.len() / 2]
        };
        let [text, value] = [median(&by_text), median(&typed)];
        eprintln!("by text {text:.1} µs, typed {value:.1} µs: {:.1} times as fast", text / value);
    }
}
