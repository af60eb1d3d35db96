//! The scene that is edited: what it is, what it was, and which file it has.

use std::{
    path::{Path, PathBuf},
    time::{Duration, Instant},
};

use crate::{
    figure::{
        file::write_whole,
        scene_file::{self, Edit, Options, SceneFileError, node::Data},
    },
    scene::{Command, History, Scene},
    view::Camera,
};

/// Moves of the eye that are farther apart are edits of their own.
const PAUSE: Duration = Duration::from_millis(700);

/// A scene with its edits.
#[derive(Debug, Default)]
pub struct Document {
    history: History,
    /// As the file has it.
    saved: Scene,
    file: Option<PathBuf>,
    /// Whether that file names files outside its folder.
    leads_outside: bool,
    /// An edit that goes on: a gizmo or a slider that is held.
    live: Option<(String, Scene)>,
    /// When the eye was moved last.
    looked: Option<Instant>,
    /// Where the eye was at first.
    begun: Option<Camera>,
    /// Whether the file says where the eye is.
    says_eye: bool,
}

impl Document {
    /// A scene without a past; `file`: where it is from.
    pub fn new(scene: Scene, file: Option<PathBuf>) -> Self {
        let leads_outside = file.as_ref().is_some_and(|file| leads_outside(&scene, file));
        let says_eye = scene.camera.is_some();
        Self {
            history: History::new(scene.clone()),
            says_eye,
            saved: scene,
            file,
            leads_outside,
            live: None,
            looked: None,
            begun: None,
        }
    }

    /// A scene that has edits beyond what its file has; without one, beyond its city.
    pub fn with_edits(scene: Scene, file: Option<PathBuf>) -> Self {
        let options = |file: &PathBuf| Options { allow_outside: true, ..Options::for_file(file) };
        let saved = file.as_ref().and_then(|file| scene_file::read(file, &options(file)).ok());
        let saved = saved.unwrap_or_else(|| Scene { city: scene.city.clone(), ..Scene::default() });
        let mut document = Self::new(saved, file);
        document.edit("edits that were not saved", |before| *before = scene);
        document
    }

    /// The scene as it is shown.
    pub fn scene(&self) -> &Scene {
        self.live.as_ref().map_or_else(|| self.history.scene(), |(_, scene)| scene)
    }

    /// Its file.
    pub fn file(&self) -> Option<&Path> {
        self.file.as_deref()
    }

    /// Its name.
    pub fn title(&self) -> String {
        let name = self.file.as_ref().or(self.scene().city.files.first());
        let name = name.and_then(|file| file.file_name()).map(|name| name.to_string_lossy().into_owned());
        name.unwrap_or_else(|| "Untitled".to_owned())
    }

    /// Whether something would be lost: looking around is nothing that is.
    pub fn is_changed(&self) -> bool {
        // Asked in every frame of the window: nothing is copied.
        let Scene {
            city,
            camera: _,
            camera_above_ground,
            sun,
            time_s,
            moment,
            time_steps,
            style,
            trajectories,
            volumes,
            pois,
            lenses,
            overlays,
            layout,
            figure,
            animation,
        } = self.scene();
        let saved = &self.saved;
        let is_set_alike = (city, sun, style, layout, figure, animation)
            == (&saved.city, &saved.sun, &saved.style, &saved.layout, &saved.figure, &saved.animation)
            && (time_s, moment, time_steps) == (&saved.time_s, &saved.moment, &saved.time_steps)
            && *camera_above_ground == saved.camera_above_ground;
        let has_alike = (trajectories, volumes, pois, lenses, overlays)
            == (&saved.trajectories, &saved.volumes, &saved.pois, &saved.lenses, &saved.overlays);
        !(is_set_alike && has_alike)
    }

    /// The rules by which its paths are read and written: relative to its file, and free to lead anywhere, as the person who edits it says where.
    pub fn options(&self) -> Options {
        match &self.file {
            Some(file) => Options { allow_outside: true, ..Options::for_file(file) },
            None => Options::for_command_line(),
        }
    }

    /// Whether its file, as it was opened or saved last, names files outside its folder: reading it has to be allowed.
    pub fn leads_outside(&self) -> bool {
        self.leads_outside
    }

    /// Does an edit.
    pub fn apply(&mut self, command: Command) {
        self.settle();
        self.history.apply(command);
    }

    /// Changes the scene.
    pub fn edit(&mut self, name: impl Into<String>, change: impl FnOnce(&mut Scene)) {
        self.settle();
        let command = Command::of(name, self.history.scene(), change);
        self.history.apply(command);
    }

    /// Where the eye is at first: nothing that could be undone.
    pub fn begin_at(&mut self, camera: Camera) {
        let scene = Scene { camera: Some(camera), ..self.history.scene().clone() };
        self.history = History::new(scene);
        self.begun = Some(camera);
    }

    /// Moves the eye. Moves that follow each other at once are one edit.
    pub fn look(&mut self, camera: Camera) {
        self.settle();
        let command = Command::look(self.history.scene(), camera);
        if !command.is_effective() {
            return;
        }
        let follows = self.looked.is_some_and(|last| last.elapsed() < PAUSE);
        self.looked = Some(Instant::now());
        self.history.apply(if follows { command } else { command.beginning() });
    }

    /// Shows an edit that goes on; [`Self::settle`] does it.
    pub fn preview(&mut self, name: impl Into<String>, scene: Scene) {
        self.live = Some((name.into(), scene));
    }

    /// Whether an edit goes on.
    pub fn is_live(&self) -> bool {
        self.live.is_some()
    }

    /// Ends an edit that goes on.
    pub fn settle(&mut self) {
        if let Some((name, after)) = self.live.take() {
            let command = Command::new(name, self.history.scene().clone(), after);
            self.history.apply(command);
        }
    }

    /// Takes the last edit back; what it was.
    pub fn undo(&mut self) -> Option<String> {
        self.settle();
        self.history.undo().map(str::to_owned)
    }

    /// Does it again.
    pub fn redo(&mut self) -> Option<String> {
        self.settle();
        self.history.redo().map(str::to_owned)
    }

    /// The names of the edits that would be taken back, and done again.
    pub fn names(&self) -> [Option<&str>; 2] {
        self.history.next().map(|command| command.map(Command::name))
    }

    /// Sets one value as `--set` does: `lens.0.shape.radius=80`.
    ///
    /// # Errors
    /// The fault, in one message.
    pub fn set(&mut self, assignment: &str) -> Result<(), String> {
        self.do_edit(&Edit::of_assignment(assignment).map_err(message)?)
    }

    /// Gives a key another value: `lens.0.shape.radius`, a number; `None` takes it away.
    ///
    /// # Errors
    /// The fault, in one message.
    pub fn set_value(&mut self, path: &str, value: Option<Data>) -> Result<(), String> {
        self.do_edit(&Edit::new(path, value).map_err(message)?)
    }

    /// Shows what that would make; [`Self::settle`] does it.
    ///
    /// # Errors
    /// The fault, in one message.
    pub fn preview_value(&mut self, path: &str, value: Option<Data>) -> Result<(), String> {
        let edit = Edit::new(path, value).map_err(message)?;
        // Several values may be held at once: each goes on from what is shown.
        let after = edit.after(self.scene(), &self.options()).map_err(message)?;
        self.preview(name_of(self.scene(), path), after);
        Ok(())
    }

    fn do_edit(&mut self, edit: &Edit) -> Result<(), String> {
        let command = edit.command(self.scene(), &self.options()).map_err(message)?;
        let name = name_of(self.scene(), edit.path());
        self.apply(command.named(name));
        Ok(())
    }

    /// Gives a lens another name, wherever the scene names it.
    ///
    /// # Errors
    /// The fault of the name, in one message.
    pub fn rename_lens(&mut self, index: usize, name: &str) -> Result<(), String> {
        self.settle();
        let command = scene_file::rename_lens(self.scene(), index, name, &self.options()).map_err(message)?;
        self.apply(command);
        Ok(())
    }

    /// The scene as a reader of its file gets it.
    ///
    /// # Errors
    /// The scene cannot be written.
    pub fn as_written(&self) -> Result<Scene, String> {
        let options = self.options();
        scene_file::parse(&scene_file::to_toml_for(self.scene(), &options), &self.title(), &options).map_err(message)
    }

    /// The eye as its file says it: one that the file did not say, and that has not moved, it does not say now.
    fn said_eye(&self) -> Option<Camera> {
        let camera = self.scene().camera;
        let is_unsaid = self.file.is_some() && !self.says_eye && camera == self.begun;
        camera.filter(|_| !is_unsaid)
    }

    /// The text of the scene for a file: that of the file that it has, where there is one, with what is another value.
    fn text_for(&self, file: &Path) -> String {
        let options = Options { allow_outside: true, ..Options::for_file(file) };
        let scene = Scene { camera: self.said_eye(), ..self.scene().clone() };
        match self.file.as_ref().and_then(|own| std::fs::read_to_string(own).ok()) {
            Some(text) => scene_file::to_edited(&text, &self.options(), &scene, &options),
            None => scene_file::to_toml_for(&scene, &options),
        }
    }

    /// Writes the scene; it has this file from now on. What its text says besides stays.
    ///
    /// # Errors
    /// The message of the system, with the file.
    pub fn save(&mut self, file: &Path) -> Result<(), String> {
        self.settle();
        let text = self.text_for(file);
        write_whole(file, |out| out.write_all(text.as_bytes())).map_err(|error| error.to_string())?;
        self.says_eye = self.said_eye().is_some();
        self.file = Some(file.to_owned());
        self.saved = self.scene().clone();
        self.leads_outside = leads_outside(&self.saved, file);
        Ok(())
    }
}

/// The name of an edit, for a menu: `radius of crate`, `figure size`.
fn name_of(scene: &Scene, path: &str) -> String {
    let mut segments = path.split('.').map(str::trim);
    let first = segments.next().unwrap_or_default();
    let rest: Vec<&str> = segments.collect();
    let lens =
        rest.first().filter(|_| first == "lens").and_then(|index| scene.lenses.get(index.parse::<usize>().ok()?));
    let key = rest.iter().rev().find(|word| word.parse::<usize>().is_err()).map(|word| word.replace('_', " "));
    match (lens, key) {
        (Some(lens), Some(key)) => format!("{key} of {}", lens.name),
        (Some(lens), None) => format!("lens {}", lens.name),
        (None, Some(key)) => format!("{first} {key}"),
        (None, None) => first.replace('_', " "),
    }
}

/// Whether a scene, written to `file`, can only be read where it may lead out of that file's folder.
fn leads_outside(scene: &Scene, file: &Path) -> bool {
    let strict = Options::for_file(file);
    let text = scene_file::to_toml_for(scene, &strict);
    let is_read = |options: &Options| scene_file::parse(&text, "", options).is_ok();
    !is_read(&strict) && is_read(&Options { allow_outside: true, ..strict.clone() })
}

/// The first problem, as the window says it: it knows where it is.
fn message(error: SceneFileError) -> String {
    error.problems.first().map_or_else(|| error.to_string(), |problem| format!("{}: {}", problem.key, problem.message))
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    fn camera(x: f64) -> Camera {
        Camera::looking(DVec3::new(x, 0.0, 10.0), DVec3::Y * 50.0, 0.8)
    }

    #[test]
    fn moves_of_the_eye_in_a_row_are_one_edit() {
        let mut document = Document::default();
        document.edit("wider", |scene| scene.figure.size[0] = 900);
        for x in 0..5 {
            document.look(camera(f64::from(x)));
        }
        assert_eq!(document.names()[0], Some("move camera"));
        assert_eq!(document.undo().as_deref(), Some("move camera"));
        assert_eq!(document.scene().camera, None);
        assert_eq!(document.redo().as_deref(), Some("move camera"));
        assert_eq!(document.scene().camera, Some(camera(4.0)));
        assert_eq!((document.undo(), document.undo().as_deref()), (Some("move camera".into()), Some("wider")));
        assert_eq!(document.undo(), None);
    }

    #[test]
    fn what_is_held_is_one_edit_when_it_is_let_go() {
        let mut document = Document::default();
        let lens = "lens.0={ name = \"a\", shape = { kind = \"sphere\", center = [0, 0, 0], radius = 10 }, effects = [\"sepia\"] }";
        document.set(lens).unwrap();
        for radius in [20, 30, 40] {
            document.preview_value("lens.0.shape.radius", Some(f64::from(radius).into())).unwrap();
        }
        assert!(document.preview_value("lens.0.shape.radius", Some((-1.0).into())).unwrap_err().contains("radius"));
        let held = document.scene().clone();
        document.settle();
        assert_eq!(*document.scene(), held);
        document.undo();
        assert!(document.scene().lenses.len() == 1 && *document.scene() != held);
        document.undo();
        assert!(document.scene().lenses.is_empty());
    }

    #[test]
    fn looking_around_is_nothing_to_be_lost() {
        let mut document = Document::new(Scene::default(), None);
        document.look(camera(1.0));
        assert!(!document.is_changed());
        document.edit("wider", |scene| scene.figure.size[0] = 900);
        assert!(document.is_changed());
        document.undo();
        assert!(!document.is_changed());
    }

    #[test]
    fn a_scene_comes_back_as_it_was_saved() {
        let folder = std::env::temp_dir().join(format!("veduta-document-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let file = folder.join("s.toml");
        let mut document = Document::default();
        document.set("city.files=[\"builtin:square\"]").unwrap();
        document.look(camera(3.0));
        document.save(&file).unwrap();
        assert!(!document.is_changed() && document.title() == "s.toml");
        let again = scene_file::read(&file, &document.options()).unwrap();
        assert_eq!(again, document.as_written().unwrap());
        let [own, read] = [document.scene(), &again].map(|scene| scene.camera.unwrap());
        assert!(own.eye == read.eye && own.target == read.target && again.city == document.scene().city);
        assert!(document.save(&folder.join("no/where.toml")).unwrap_err().contains("where.toml"));
        std::fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn one_number_that_is_changed_is_the_difference_of_its_file() {
        const FILE: &str = "# Drawn for the exhibition.\nveduta = 1\n\n[figure]\nsize = [ 800, 600 ] # fits the frame\n\n\n[sun]\nazimuth_deg = 90\n[city]\nfiles = [\"builtin:square\"]\n\n# The old town.\n[[lens]]\nshape = { kind = \"sphere\", radius = 60, center = [1, 2, 3] } # by hand\nname = \"a\"\neffects = [\"sepia\"]\n";
        let folder = std::env::temp_dir().join(format!("veduta-edited-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let file = folder.join("s.toml");
        std::fs::write(&file, FILE).unwrap();
        let open = || {
            let scene = scene_file::read(&file, &Options::for_file(&file)).unwrap();
            let mut document = Document::new(scene, Some(file.clone()));
            document.begin_at(camera(3.0));
            document
        };
        let mut document = open();
        document.save(&file).unwrap();
        assert_eq!(std::fs::read_to_string(&file).unwrap(), FILE);
        for radius in [61.0, 62.5] {
            document.preview_value("lens.0.shape.radius", Some(radius.into())).unwrap();
        }
        document.save(&file).unwrap();
        let edited = FILE.replace("radius = 60,", "radius = 62.5,");
        assert_eq!(std::fs::read_to_string(&file).unwrap(), edited);
        // Elsewhere it is the same text, with what it did not say before.
        document.look(camera(4.0));
        document.save(&folder.join("t.toml")).unwrap();
        let elsewhere = std::fs::read_to_string(folder.join("t.toml")).unwrap();
        assert!(elsewhere.starts_with(&edited) && elsewhere.contains("[camera]\neye = [4.0, "), "{elsewhere}");
        std::fs::remove_dir_all(&folder).unwrap();
    }

    #[test]
    fn edits_are_called_by_what_they_change() {
        let mut document = Document::default();
        let lens = "lens.0={ name = \"crate\", effects = [\"sepia\"], shape = { kind = \"sphere\", center = [0, 0, 0], radius = 9 } }";
        for (assignment, name) in [
            (lens, "lens"),
            ("lens.0.shape.radius=12", "radius of crate"),
            ("lens.0.effects.0={ effect = \"sepia\", amount = 0.5 }", "effects of crate"),
            ("figure.size=[800, 500]", "figure size"),
            ("camera.fov_deg=60", "camera fov deg"),
        ] {
            let _ = document.set("camera={ eye = [0, -9, 9], target = [0, 0, 0] }");
            document.set(assignment).unwrap();
            assert_eq!(document.names()[0], Some(name));
        }
    }

    #[test]
    fn a_scene_that_is_saved_beside_its_city_or_elsewhere_can_be_edited_on() {
        let folder = std::env::temp_dir().join(format!("veduta-outside-{}", std::process::id()));
        std::fs::create_dir_all(folder.join("scenes")).unwrap();
        let city = folder.join("a.city.json");
        std::fs::write(&city, "{}").unwrap();
        for (file, is_outside) in [("s.toml", false), ("scenes/s.toml", true)] {
            let mut document = Document::default();
            document.edit("open", |scene| scene.city.files = vec![city.clone()]);
            assert!(!document.leads_outside(), "it has no file");
            document.save(&folder.join(file)).unwrap();
            assert_eq!(document.leads_outside(), is_outside);
            document.set("figure.size=[800, 500]").unwrap();
            assert_eq!(document.as_written().unwrap().city.files, std::slice::from_ref(&city));
            let opened = Document::new(document.scene().clone(), Some(folder.join(file)));
            assert_eq!(opened.leads_outside(), is_outside);
        }
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
