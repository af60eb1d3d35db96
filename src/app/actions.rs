//! Actions of the window: one table that menus, keys and the list of shortcuts are made from.

use eframe::egui::{Context, Key, KeyboardShortcut, Modifiers};

use crate::{
    app::{drawn::Figure, new_lens::NewLens, timeline::Step},
    view::navigate::Axis,
};

/// Something that can be done by a menu, a key or a button.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    /// City files or a scene.
    Open,
    /// More files into the city that is shown.
    AddFiles,
    /// The built-in city.
    OpenBuiltin,
    /// To the file that the scene has, or asks for one.
    Save,
    /// To another file.
    SaveAs,
    /// The figure, or the picture that the window shows.
    Export,
    /// The picture that the window shows, to the clipboard.
    CopyPicture,
    /// Closes the window.
    Quit,
    /// Takes the last edit back.
    Undo,
    /// Does it again.
    Redo,
    /// Another lens on top.
    AddLens(NewLens),
    /// A way or an area for a lens, or something to measure.
    Draw(Figure),
    /// On the ground, at the height of eyes.
    ToggleWalk,
    /// The chosen lens once more.
    DuplicateLens,
    /// Gives it another name.
    RenameLens,
    /// Takes it away.
    DeleteLens,
    /// Towards the top.
    RaiseLens,
    /// Towards the bottom.
    LowerLens,
    /// On or off.
    ToggleLens,
    /// The whole city.
    GoHome,
    /// Shows all from the present direction.
    FrameAll,
    /// The chosen lens or object.
    FrameChosen,
    /// From a side.
    Look(Axis),
    /// Perspective or orthographic.
    ToggleProjection,
    /// The chosen object is not shown.
    HideObject,
    /// Nothing but it is shown.
    IsolateObject,
    /// All is shown.
    ShowAll,
    /// Searches the objects it is made of.
    Find,
    /// Shows or hides the costs of the picture.
    ToggleCost,
    /// The figure as it will be.
    TogglePreview,
    /// Plays through time, goes a step of it, says what is played, or keeps the view.
    Time(Step),
    /// Light or dark.
    ToggleTheme,
    /// All of these.
    Shortcuts,
}

/// A menu.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Menu {
    /// Files.
    File,
    /// Edits.
    Edit,
    /// Lenses.
    Lens,
    /// City objects.
    Object,
    /// The eye.
    View,
    /// About it.
    Help,
}

impl Menu {
    /// All, from the left.
    pub const ALL: [(Self, &'static str); 6] = [
        (Self::File, "File"),
        (Self::Edit, "Edit"),
        (Self::Lens, "Lens"),
        (Self::Object, "Object"),
        (Self::View, "View"),
        (Self::Help, "Help"),
    ];
}

/// One of the table.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// The action.
    pub action: Action,
    /// Where.
    pub menu: Menu,
    /// As people call it.
    pub name: &'static str,
    /// Its key.
    pub key: Option<KeyboardShortcut>,
}

const fn row(action: Action, menu: Menu, name: &'static str, key: Option<KeyboardShortcut>) -> Row {
    Row { action, menu, name, key }
}

const fn ctrl(key: Key) -> Option<KeyboardShortcut> {
    Some(KeyboardShortcut::new(Modifiers::COMMAND, key))
}

const fn ctrl_shift(key: Key) -> Option<KeyboardShortcut> {
    Some(KeyboardShortcut::new(Modifiers::COMMAND.plus(Modifiers::SHIFT), key))
}

const fn plain(key: Key) -> Option<KeyboardShortcut> {
    Some(KeyboardShortcut::new(Modifiers::NONE, key))
}

const fn shift(key: Key) -> Option<KeyboardShortcut> {
    Some(KeyboardShortcut::new(Modifiers::SHIFT, key))
}

/// The table.
pub const ROWS: &[Row] = &[
    row(Action::Open, Menu::File, "Open…", ctrl(Key::O)),
    row(Action::AddFiles, Menu::File, "Add files to the city…", ctrl_shift(Key::O)),
    row(Action::OpenBuiltin, Menu::File, "Open the built-in city", None),
    row(Action::Save, Menu::File, "Save scene", ctrl(Key::S)),
    row(Action::SaveAs, Menu::File, "Save scene as…", ctrl_shift(Key::S)),
    row(Action::Export, Menu::File, "Export figure…", ctrl(Key::E)),
    row(Action::Quit, Menu::File, "Quit", ctrl(Key::Q)),
    row(Action::Undo, Menu::Edit, "Undo", ctrl(Key::Z)),
    row(Action::Redo, Menu::Edit, "Redo", ctrl_shift(Key::Z)),
    row(Action::CopyPicture, Menu::Edit, "Copy the picture", ctrl_shift(Key::C)),
    row(Action::AddLens(NewLens::Color), Menu::Lens, "Add colour lens", plain(Key::L)),
    row(Action::AddLens(NewLens::XRay), Menu::Lens, "Add x-ray lens", None),
    row(Action::AddLens(NewLens::Eraser), Menu::Lens, "Add eraser lens", None),
    row(Action::AddLens(NewLens::Content), Menu::Lens, "Add content lens (flat)", None),
    row(Action::AddLens(NewLens::Time), Menu::Lens, "Add time lens", plain(Key::Y)),
    row(Action::AddLens(NewLens::Change), Menu::Lens, "Add change lens", None),
    row(Action::AddLens(NewLens::Occlusion), Menu::Lens, "See the object through what hides it", plain(Key::R)),
    row(Action::AddLens(NewLens::Deformation), Menu::Lens, "Add deformation lens", None),
    row(Action::AddLens(NewLens::Lower), Menu::Lens, "Lower what hides the object", None),
    row(Action::AddLens(NewLens::Magnifier), Menu::Lens, "Add magnifier", None),
    row(Action::AddLens(NewLens::Feature), Menu::Lens, "Magnify the object in its outline", None),
    row(Action::AddLens(NewLens::Sampling), Menu::Lens, "Add sampling-rate lens", None),
    row(Action::AddLens(NewLens::Fisheye), Menu::Lens, "Add fisheye", None),
    row(Action::AddLens(NewLens::BestView), Menu::Lens, "Add best view of the object", plain(Key::B)),
    row(Action::AddLens(NewLens::Annotation), Menu::Lens, "Add annotation of the object", None),
    row(Action::AddLens(NewLens::Map), Menu::Lens, "Add map", plain(Key::M)),
    row(Action::Draw(Figure::Route), Menu::Lens, "Draw a way for a lens", None),
    row(Action::Draw(Figure::Area), Menu::Lens, "Draw an area for a lens", None),
    row(Action::DuplicateLens, Menu::Lens, "Duplicate lens", ctrl(Key::D)),
    row(Action::RenameLens, Menu::Lens, "Rename lens", plain(Key::F2)),
    row(Action::DeleteLens, Menu::Lens, "Delete lens", plain(Key::Delete)),
    row(Action::RaiseLens, Menu::Lens, "Raise lens", ctrl(Key::ArrowUp)),
    row(Action::LowerLens, Menu::Lens, "Lower lens", ctrl(Key::ArrowDown)),
    row(Action::ToggleLens, Menu::Lens, "Switch lens on or off", plain(Key::X)),
    row(Action::Find, Menu::Object, "Find…", ctrl(Key::F)),
    row(Action::HideObject, Menu::Object, "Hide", plain(Key::H)),
    row(Action::IsolateObject, Menu::Object, "Isolate", plain(Key::I)),
    row(Action::ShowAll, Menu::Object, "Show all", shift(Key::H)),
    row(Action::Draw(Figure::Measure), Menu::Object, "Measure distances", plain(Key::K)),
    row(Action::GoHome, Menu::View, "First view", plain(Key::Home)),
    row(Action::FrameAll, Menu::View, "Frame all", shift(Key::Home)),
    row(Action::FrameChosen, Menu::View, "Frame what is chosen", plain(Key::F)),
    row(Action::Look(Axis::Top), Menu::View, "From above", plain(Key::Num7)),
    row(Action::Look(Axis::South), Menu::View, "From the south", plain(Key::Num1)),
    row(Action::Look(Axis::East), Menu::View, "From the east", plain(Key::Num3)),
    row(Action::Look(Axis::North), Menu::View, "From the north", shift(Key::Num1)),
    row(Action::Look(Axis::West), Menu::View, "From the west", shift(Key::Num3)),
    row(Action::ToggleProjection, Menu::View, "Perspective or orthographic", plain(Key::Num5)),
    row(Action::ToggleWalk, Menu::View, "Walk on the ground, or fly", plain(Key::G)),
    row(Action::TogglePreview, Menu::View, "Figure as it will be", plain(Key::P)),
    row(Action::ToggleCost, Menu::View, "What it costs", plain(Key::T)),
    row(Action::Time(Step::Play), Menu::View, "Play through time, or pause", plain(Key::Space)),
    row(Action::Time(Step::Back), Menu::View, "Step back in time", plain(Key::Comma)),
    row(Action::Time(Step::On), Menu::View, "Step on in time", plain(Key::Period)),
    row(Action::Time(Step::LoopFrom), Menu::View, "Loop from this moment", plain(Key::OpenBracket)),
    row(Action::Time(Step::LoopUntil), Menu::View, "Loop until this moment", plain(Key::CloseBracket)),
    row(Action::Time(Step::Key), Menu::View, "Keep the view for this moment", plain(Key::C)),
    row(Action::ToggleTheme, Menu::View, "Light or dark", None),
    row(Action::Shortcuts, Menu::Help, "Keys and mouse", plain(Key::F1)),
];

/// Uses of the mouse, for the list.
pub const MOUSE: &[(&str, &str)] = &[
    ("Drag", "Orbit around the place under the pointer"),
    ("Right or middle drag, Shift drag", "Move the city along"),
    ("Ctrl drag", "Look around"),
    ("Wheel", "Come nearer, or go away from the place under the pointer"),
    ("Click", "Choose an object, or a lens by its handle; go to what an overlay shows"),
    ("Double click", "Go to the place under the pointer"),
    ("Drag an overlay", "Give it a place of its own"),
    ("Drag a handle", "Move the chosen lens; with Shift up and down"),
    ("Drag the ring", "Make the chosen lens larger or smaller"),
    ("Drag a square", "Move that side of the chosen lens; with Shift it grows as a whole"),
    ("Drag a round knob", "Move a point of a way, of an area or of a hull; with Shift up and down"),
    ("Drag the arrow", "Turn the chosen lens; with Shift by steps of 15 degrees"),
    ("W A S D, Q E", "Go forward, left, back, right, down and up; faster with Shift"),
    ("Arrows, Shift arrows", "Orbit around what the eye looks at; move along"),
    ("+ and -", "Come nearer to it, and go away"),
    ("Drag the timeline", "Go through time"),
    ("Drag the handles of the timeline", "Say what is played, round and round; a double click: all of it"),
    ("Drag an object that moves", "Go to the moment at which it comes where the pointer is, along its way"),
    ("Drop files", "Open them; effects (*.wgsl) are added, and read again when they change"),
];

/// The actions that the keys of this frame ask for; none while a text is written, but for those with Ctrl.
pub fn asked(context: &Context) -> Vec<Action> {
    let writes = context.text_edit_focused();
    let is_asked = |row: &&Row| {
        let Some(key) = row.key.filter(|key| !writes || key.modifiers.command) else { return false };
        // What text fields do with their own text stays theirs.
        let is_of_text =
            writes && matches!(row.action, Action::Undo | Action::Redo | Action::RaiseLens | Action::LowerLens);
        !is_of_text && context.input_mut(|input| input.consume_shortcut(&key))
    };
    // A key with Shift is no key without: those with more modifiers are asked first.
    let shifted =
        |wanted: bool| ROWS.iter().filter(move |row| row.key.is_some_and(|key| key.modifiers.shift) == wanted);
    shifted(true).chain(shifted(false)).filter(is_asked).map(|row| row.action).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_key_and_each_name_is_there_once() {
        for (i, row) in ROWS.iter().enumerate() {
            for other in &ROWS[..i] {
                assert!(row.key.is_none() || row.key != other.key, "{} and {}", row.name, other.name);
                assert_ne!(row.name, other.name);
                assert_ne!(row.action, other.action, "{}", row.name);
            }
        }
    }
}
