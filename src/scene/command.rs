//! Every edit of a scene is a command with a name that can be undone and redone, whoever issues it (architecture 14).

use crate::{
    lens::{
        BestView, Handled, Lens,
        best_view::{Depiction, LocalView},
        epoch::{linked, makes_one_moment, moment_after, set_to},
        links,
    },
    scene::model::Scene,
    time::Moment,
    view::Camera,
};

/// One edit. Scenes are small plain data, so a command simply holds both sides of it: undoing cannot drift.
#[derive(Clone, Debug, PartialEq)]
pub struct Command {
    name: String,
    before: Scene,
    after: Scene,
    /// Several in a row are one edit.
    goes_on: bool,
    /// It is the first of a new row.
    begins: bool,
}

impl Command {
    /// The edit that turns `before` into `after`.
    pub fn new(name: impl Into<String>, before: Scene, after: Scene) -> Self {
        Self { name: name.into(), before, after, goes_on: false, begins: false }
    }

    /// The edit that `change` makes.
    pub fn of(name: impl Into<String>, scene: &Scene, change: impl FnOnce(&mut Scene)) -> Self {
        let mut after = scene.clone();
        change(&mut after);
        Self::new(name, scene.clone(), after)
    }

    /// Moves the eye; several such moves in a row are one edit.
    pub fn look(scene: &Scene, camera: Camera) -> Self {
        Self { goes_on: true, ..Self::of("move camera", scene, |s| s.camera = Some(camera)) }
    }

    /// Shows another moment, or all times; several in a row are one edit.
    pub fn show_moment(scene: &Scene, moment: Option<Moment>) -> Self {
        Self { goes_on: true, ..Self::of("move through time", scene, |s| s.moment = moment) }
    }

    /// It begins a row of its own, whatever went before.
    #[must_use]
    pub fn beginning(self) -> Self {
        Self { begins: true, ..self }
    }

    /// By another name.
    #[must_use]
    pub fn named(self, name: impl Into<String>) -> Self {
        Self { name: name.into(), ..self }
    }

    /// Puts a lens on top.
    pub fn add_lens(scene: &Scene, lens: Lens) -> Self {
        Self::of(format!("add lens {}", lens.name), scene, |s| s.lenses.push(lens))
    }

    /// Takes a lens away, with what shows it: its overlays, and its place in views. What is linked to it in time shows what it showed: the steps of
    /// the lens, and the delay, come in the place of the link. `None` where there is none at `index`.
    pub fn remove_lens(scene: &Scene, index: usize) -> Option<Self> {
        let Lens { name, time, .. } = scene.lenses.get(index)?;
        Some(Self::of(format!("remove lens {name}"), scene, |s| {
            s.lenses.remove(index);
            s.overlays.retain(|overlay| overlay.lens != *name);
            let views = s.lenses.iter_mut().filter_map(|lens| lens.kind.best_view_mut()?.lenses.as_mut());
            views.for_each(|shown| shown.retain(|shown| shown != name));
            let steps = s.lenses.iter_mut().map(|lens| &mut lens.time).chain([&mut s.time_steps]);
            steps.for_each(|steps| links::replace(steps, name, time));
        }))
    }

    /// Gives a lens another name wherever lenses and overlays name it: in its overlay, in views that show it, in lenses that are linked to it in
    /// time, in shapes. `None` where there is none at `index`.
    pub fn rename_lens(scene: &Scene, index: usize, name: &str) -> Option<Self> {
        let before = &scene.lenses.get(index)?.name;
        Some(Self::of("rename lens", scene, |s| {
            name.clone_into(&mut s.lenses[index].name);
            let views = s.lenses.iter_mut().filter_map(|lens| lens.kind.best_view_mut()?.lenses.as_mut());
            let named = views.flatten().chain(s.overlays.iter_mut().map(|overlay| &mut overlay.lens));
            named.filter(|own| *own == before).for_each(|own| name.clone_into(own));
            let steps = s.lenses.iter_mut().map(|lens| &mut lens.time).chain([&mut s.time_steps]);
            steps.for_each(|steps| links::rename(steps, before, name));
            let shapes = s.lenses.iter_mut().flat_map(|lens| &mut lens.shapes);
            shapes.for_each(|shape| shape.rename_lens(before, name));
        }))
    }

    /// The lenses that are linked to one in time, by name.
    pub fn linked_to<'a>(scene: &'a Scene, name: &str) -> Vec<&'a str> {
        let is_linked = |lens: &&Lens| lens.time.iter().any(|step| links::linked_lens(step) == Some(name));
        scene.lenses.iter().filter(is_linked).map(|lens| lens.name.as_str()).collect()
    }

    /// Moves a lens to another place in the order; `None` where either place is not.
    pub fn reorder_lens(scene: &Scene, from: usize, to: usize) -> Option<Self> {
        let lens = scene.lenses.get(from).filter(|_| to < scene.lenses.len())?;
        Some(Self::of(format!("reorder lens {}", lens.name), scene, |s| {
            let lens = s.lenses.remove(from);
            s.lenses.insert(to, lens);
        }))
    }

    /// Steps through a portal: its eye, and its moment where it has one, become the main ones, and the main ones, the eye `from`, its own, so that
    /// it leads back. `None`: there is no portal
    /// at `index`.
    pub fn step_through(scene: &Scene, index: usize, from: Camera) -> Option<Self> {
        let lens = scene.lenses.get(index).filter(|lens| lens.kind.row().is_door)?;
        let Some(&LocalView::Camera { camera: to, above_ground }) = lens.best_view().and_then(BestView::view) else {
            return None;
        };
        let is_elsewhen = !lens.time.is_empty();
        // Moments that are made of the scene's, one for one, need no steps of its own.
        let steps = linked(&lens.time, &scene.lenses).unwrap_or_default();
        let then = moment_after(&steps, scene.moment, scene.time_s).ok();
        let then = then.filter(|_| scene.time_steps.is_empty() && steps.iter().all(makes_one_moment));
        Some(Self::of(format!("step through {}", lens.name), scene, |s| {
            (s.camera, s.camera_above_ground) = (Some(to), above_ground);
            if is_elsewhen {
                let back: Vec<Handled> = s.moment.map(set_to).into_iter().chain(s.time_steps.clone()).collect();
                let own = std::mem::replace(&mut s.lenses[index].time, back);
                match then {
                    Some(then) => s.moment = then,
                    None => s.time_steps.extend(own),
                }
            }
            if let Some(shown) = s.lenses[index].kind.best_view_mut() {
                shown.depiction = Depiction::View(LocalView::Camera { camera: from, above_ground: false });
            }
        }))
    }

    /// What it does, for a menu: `move camera`.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Whether it changes anything.
    pub fn is_effective(&self) -> bool {
        self.before != self.after
    }

    /// Does it (again).
    pub fn redo(&self, scene: &mut Scene) {
        scene.clone_from(&self.after);
    }

    /// Takes it back.
    pub fn undo(&self, scene: &mut Scene) {
        scene.clone_from(&self.before);
    }
}

/// A scene and the edits that led to it.
#[derive(Clone, Debug, Default)]
pub struct History {
    scene: Scene,
    done: Vec<Command>,
    undone: Vec<Command>,
}

/// Edits that can be undone; older ones are forgotten.
const DEPTH: usize = 256;

impl History {
    /// A scene without a past.
    pub fn new(scene: Scene) -> Self {
        Self { scene, done: Vec::new(), undone: Vec::new() }
    }

    /// The scene as it is now.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// Does a command made for the present scene. What was undone before can no longer be redone. A command without
    /// effect leaves no trace; one made for another scene is refused with `false`.
    pub fn apply(&mut self, command: Command) -> bool {
        if command.before != self.scene {
            return false;
        }
        if command.is_effective() {
            command.redo(&mut self.scene);
            self.undone.clear();
            let is_same =
                |last: &&mut Command| last.goes_on && command.goes_on && !command.begins && last.name == command.name;
            match self.done.last_mut().filter(is_same) {
                Some(last) => last.after = command.after,
                None => {
                    if self.done.len() == DEPTH {
                        self.done.remove(0);
                    }
                    self.done.push(command);
                }
            }
        }
        true
    }

    /// The edits that would be taken back, and done again.
    pub fn next(&self) -> [Option<&Command>; 2] {
        [self.done.last(), self.undone.last()]
    }

    /// Takes the last edit back; its name, if there was one.
    pub fn undo(&mut self) -> Option<&str> {
        let command = self.done.pop()?;
        command.undo(&mut self.scene);
        self.undone.push(command);
        self.undone.last().map(Command::name)
    }

    /// Does the last edit that was taken back again; its name, if there was one.
    pub fn redo(&mut self) -> Option<&str> {
        let command = self.undone.pop()?;
        command.redo(&mut self.scene);
        self.done.push(command);
        self.done.last().map(Command::name)
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::lens::kind::{Portal, SeeThrough, TimeLens};

    fn resized(scene: &Scene, width: u32) -> Command {
        Command::of(format!("width {width}"), scene, |s| s.figure.size[0] = width)
    }

    #[test]
    fn what_is_done_can_be_undone_and_redone() {
        let mut history = History::default();
        for width in [10, 20, 30] {
            assert!(history.apply(resized(&history.scene().clone(), width)));
        }
        assert_eq!(history.undo(), Some("width 30"));
        assert_eq!(history.undo(), Some("width 20"));
        assert_eq!(history.scene().figure.size[0], 10);
        assert_eq!(history.redo(), Some("width 20"));
        assert_eq!(history.scene().figure.size[0], 20);
        assert!(history.apply(resized(&history.scene().clone(), 99)));
        assert_eq!(history.redo(), None, "a new edit ends the other future");
        while history.undo().is_some() {}
        assert_eq!(*history.scene(), Scene::default());
    }

    #[test]
    fn a_portal_leads_there_and_back() {
        let [here, there] = [0.0, 500.0].map(|x| Camera::looking(DVec3::new(x, 0.0, 9.0), DVec3::ZERO + DVec3::Y, 0.8));
        let shown = BestView {
            pois: Vec::new(),
            depiction: Depiction::View(LocalView::Camera { camera: there, above_ground: false }),
            lenses: None,
            look: None,
        };
        let portal = Lens::plain("gate", Portal { shown: shown.clone() }, [0.0; 3]);
        let mut scene = Scene { camera: Some(here), lenses: vec![portal.clone()], ..Scene::default() };
        let before = scene.clone();
        Command::step_through(&scene, 0, here).unwrap().redo(&mut scene);
        assert_eq!(scene.camera, Some(there));
        Command::step_through(&scene, 0, there).unwrap().redo(&mut scene);
        assert_eq!(scene, before);
        scene.lenses[0].kind = SeeThrough { shown }.into();
        // To another moment, and back to this one.
        let mut later = scene.clone();
        later.lenses[0] = Lens { time: vec![set_to(Moment::of_year(1650).unwrap())], ..portal };
        later.moment = Moment::of_year(1900);
        let started = later.clone();
        Command::step_through(&later.clone(), 0, here).unwrap().redo(&mut later);
        assert_eq!((later.camera, later.moment), (Some(there), Moment::of_year(1650)));
        Command::step_through(&later.clone(), 0, there).unwrap().redo(&mut later);
        assert_eq!((later.moment, &later.lenses[0].time), (started.moment, &started.lenses[0].time));
        assert_eq!(Command::step_through(&scene, 0, here), None, "a window is no door");
        assert_eq!(Command::step_through(&scene, 1, here), None);
    }

    #[test]
    fn links_follow_the_name_of_a_lens_and_outlive_it() {
        let year = |year: i64| set_to(Moment::of_year(year).unwrap());
        let lens = |name: &str, time: Vec<Handled>| Lens { time, ..Lens::plain(name, TimeLens::default(), [0.0; 3]) };
        let lenses = vec![lens("then", vec![year(1650)]), lens("after", vec![links::link_to("then", "10 years")])];
        let mut history =
            History::new(Scene { lenses, time_steps: vec![links::link_to("then", "0 s")], ..Scene::default() });
        let started = history.scene().clone();
        let shown = |scene: &Scene| {
            let steps = linked(&scene.lenses.last().unwrap().time, &scene.lenses).unwrap();
            [moment_after(&steps, None, 0.0).unwrap(), scene.shown_moment()]
        };
        let as_before = shown(&started);
        assert_eq!(as_before, [Moment::of_year(1660), Moment::of_year(1650)]);
        assert_eq!(Command::linked_to(history.scene(), "then"), ["after"]);
        history.apply(Command::rename_lens(history.scene(), 0, "old").unwrap());
        assert_eq!(history.scene().lenses[1].time, [links::link_to("old", "10 years")]);
        assert_eq!(history.scene().time_steps, [links::link_to("old", "0 s")]);
        assert_eq!(shown(history.scene()), as_before);
        assert_eq!(history.undo(), Some("rename lens"), "all of it is one edit");
        assert_eq!(*history.scene(), started);
        history.apply(Command::remove_lens(history.scene(), 0).unwrap());
        assert_eq!(history.scene().lenses.len(), 1);
        assert_eq!(shown(history.scene()), as_before);
        history.undo();
        assert_eq!(*history.scene(), started);
    }

    #[test]
    fn nothing_done_leaves_no_trace_and_strangers_are_refused() {
        let mut history = History::default();
        assert!(history.apply(Command::of("nothing", &Scene::default(), |_| ())));
        assert_eq!(history.undo(), None);
        let other = Command::of("x", &Scene::default(), |s| s.figure.samples = Some(4)).after;
        assert!(!history.apply(resized(&other, 3)));
    }

    #[test]
    fn the_past_is_bounded() {
        let mut history = History::default();
        for width in 1..1000 {
            history.apply(resized(&history.scene().clone(), width));
        }
        assert_eq!(std::iter::from_fn(|| history.undo().map(|_| ())).count(), DEPTH);
    }

    #[test]
    fn lenses_come_go_and_change_places() {
        let lens = |name: &str| Lens {
            name: name.into(),
            kind: Default::default(),
            enabled: true,
            color: [0.0; 3],
            placement: Default::default(),
            shapes: vec![],
            effects: vec![],
            time: vec![],
            body: Default::default(),
            sprite: None,
            border: None,
            keeps_shadows: false,
            at_rest: false,
            section: None,
        };
        let mut history = History::default();
        for name in ["a", "b", "c"] {
            history.apply(Command::add_lens(&history.scene().clone(), lens(name)));
        }
        let names = |h: &History| h.scene().lenses.iter().map(|l| l.name.clone()).collect::<String>();
        history.apply(Command::reorder_lens(history.scene(), 0, 2).unwrap());
        assert_eq!(names(&history), "bca");
        history.apply(Command::remove_lens(history.scene(), 1).unwrap());
        assert_eq!(names(&history), "ba");
        assert_eq!(Command::remove_lens(history.scene(), 2), None);
        assert_eq!(Command::reorder_lens(history.scene(), 0, 2), None);
        history.undo();
        assert_eq!(names(&history), "bca");
    }
}
