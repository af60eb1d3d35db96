//! Dialogs: which file, and whether edits may be lost. They are the window's own: they need no desktop portal, and keys alone will do.

use std::path::{Path, PathBuf};

use eframe::egui::{self, Context, Key, Modal, Ui};

use crate::app::{
    file_dialog::{Asking, FileDialog, Purpose, Wanted, Writing},
    state::Window,
};

/// The end of a dialog.
enum End {
    Goes,
    Done(Vec<PathBuf>),
    Cancelled,
}

/// Shows what is open.
pub fn show(window: &mut Window, context: &Context) {
    if let Some(mut dialog) = window.dialog.take() {
        let choices = figure_choices(window, &dialog);
        let response = Modal::new(egui::Id::unique("files")).show(context, |ui| body(&mut dialog, &choices, ui));
        match (response.should_close(), response.inner) {
            (true, _) | (_, End::Cancelled) => window.after_saving = None,
            (_, End::Goes) => window.dialog = Some(dialog),
            (_, End::Done(files)) => match dialog.wanted {
                Wanted::Read => window.guarded(Purpose::OpenThese(files)),
                Wanted::Add => window.add_files(&files),
                Wanted::Write(what) => {
                    let Some(file) = files.into_iter().next() else { return };
                    let is_own = what == Writing::Scene && window.document.file() == Some(&*file);
                    match file.exists() && !is_own {
                        true => window.asking = Some(Asking::Replace(file, what)),
                        false => write(window, &file, what),
                    }
                }
            },
        }
    }
    ask(window, context);
}

/// What can be written as a figure, in words: as the scene says, and as the window shows it, where it shows something.
fn figure_choices(window: &Window, dialog: &FileDialog) -> Vec<(Writing, String)> {
    if !matches!(dialog.wanted, Wanted::Write(Writing::Figure | Writing::Shown)) {
        return Vec::new();
    }
    let figure = &window.document.scene().figure;
    let samples = figure.samples();
    let each = if samples == 1 { "sample" } else { "samples" };
    let line = |what: &str, [w, h]: [u32; 2]| format!("{what}: {w} × {h} pixels, {samples} {each} each");
    let shown = window.shown_size().map(|size| (Writing::Shown, line("As the window shows it", size)));
    let own = (Writing::Figure, line("As the scene says (see Figure)", figure.pixels()));
    std::iter::once(own).chain(shown).collect()
}

fn body(dialog: &mut FileDialog, choices: &[(Writing, String)], ui: &mut Ui) -> End {
    ui.set_width(520.0);
    ui.heading(dialog.title());
    for (what, line) in choices {
        ui.radio_value(&mut dialog.wanted, Wanted::Write(*what), line);
    }
    ui.add_space(4.0);
    let mut goes_to = None;
    ui.horizontal(|ui| {
        if let Some(parent) = dialog.folder.parent()
            && ui.button("Up").clicked()
        {
            goes_to = Some(parent.to_owned());
        }
        ui.add(egui::Label::new(dialog.folder.display().to_string()).truncate());
    });
    let mut is_done = false;
    egui::ScrollArea::vertical().max_height(300.0).min_scrolled_height(200.0).auto_shrink([false, false]).show(
        ui,
        |ui| {
            if dialog.entries.is_empty() {
                match dialog.endings().first() {
                    Some(ending) => ui.weak(format!("No .{ending} file is here yet.")),
                    None => ui.weak("Nothing here that can be opened."),
                };
            }
            for (path, is_folder) in dialog.entries.clone() {
                let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
                let is_chosen = dialog.chosen.contains(&path);
                let text = if is_folder { format!("{name}/") } else { name };
                let response = ui.selectable_label(is_chosen, text);
                if response.clicked() && is_folder {
                    goes_to = Some(path);
                } else if response.clicked() || response.double_clicked() {
                    let adds = dialog.wanted == Wanted::Read
                        && ui.input(|input| input.modifiers.command || input.modifiers.shift);
                    match (adds, is_chosen) {
                        (true, true) => dialog.chosen.retain(|own| *own != path),
                        (true, false) => dialog.chosen.push(path),
                        (false, _) => dialog.chosen = vec![path],
                    }
                    dialog.typed = match &dialog.chosen[..] {
                        [only] => only.file_name().unwrap_or_default().to_string_lossy().into_owned(),
                        _ => String::new(),
                    };
                    is_done |= response.double_clicked();
                }
            }
        },
    );
    ui.add_space(4.0);
    ui.horizontal(|ui| {
        let label = ui.label("File");
        let field =
            ui.add(egui::TextEdit::singleline(&mut dialog.typed).desired_width(f32::INFINITY)).labelled_by(label.id);
        if std::mem::take(&mut dialog.is_fresh) {
            field.request_focus();
        }
        if field.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter)) {
            is_done = true;
        }
    });
    if dialog.chosen.len() > 1 {
        ui.weak(format!("{} files, opened as one city", dialog.chosen.len()));
    } else if dialog.reads() {
        ui.weak("With Ctrl several files are chosen, and opened as one city.");
    }
    if let Some(problem) = &dialog.problem {
        ui.colored_label(ui.visuals().error_fg_color, problem);
    }
    ui.add_space(4.0);
    let mut end = End::Goes;
    ui.horizontal(|ui| {
        let is_meant = !dialog.meant().is_empty();
        if ui.add_enabled(is_meant, egui::Button::new(dialog.button())).clicked() {
            is_done = true;
        }
        if ui.button("Cancel").clicked() {
            end = End::Cancelled;
        }
    });
    if let Some(folder) = goes_to {
        dialog.enter(folder);
    } else if is_done {
        end = finished(dialog);
    }
    end
}

/// Ends the dialog with the files that are meant, if that can be: folders that are typed are entered.
fn finished(dialog: &mut FileDialog) -> End {
    let meant = dialog.meant();
    match &meta(&meant) {
        Meta::Nothing => return End::Goes,
        Meta::Folder(folder) => {
            dialog.enter(folder.clone());
            dialog.typed.clear();
            return End::Goes;
        }
        Meta::Missing(file) if dialog.reads() => {
            dialog.problem = Some(format!("{}: there is no such file.", file.display()));
            return End::Goes;
        }
        _ => {}
    }
    if let (false, Some(file)) = (dialog.reads(), meant.first()) {
        let endings = dialog.endings();
        let is_right = |ending: &&str| file.extension().is_some_and(|own| own.eq_ignore_ascii_case(ending));
        if !endings.iter().any(is_right) {
            dialog.problem = Some(format!("{}: the name must end in .{}.", file.display(), endings.join(" or .")));
            return End::Goes;
        }
    }
    End::Done(meant)
}

enum Meta {
    Nothing,
    Folder(PathBuf),
    Missing(PathBuf),
    Fine,
}

fn meta(files: &[PathBuf]) -> Meta {
    let is_builtin = |file: &Path| file.to_string_lossy().starts_with("builtin:");
    match files {
        [] => Meta::Nothing,
        [folder] if folder.is_dir() => Meta::Folder(folder.clone()),
        files => files
            .iter()
            .find(|file| !file.exists() && !is_builtin(file))
            .map_or(Meta::Fine, |file| Meta::Missing(file.clone())),
    }
}

fn write(window: &mut Window, file: &Path, what: Writing) {
    match what {
        Writing::Scene => window.save(file),
        Writing::Figure => window.export(file),
        Writing::Shown => window.export_shown(file),
    }
}

fn ask(window: &mut Window, context: &Context) {
    let Some(asking) = window.asking.clone() else { return };
    let response = Modal::new(egui::Id::unique("question")).show(context, |ui| {
        ui.set_width(380.0);
        ui.heading(asking.title());
        match &asking {
            Asking::Lose(_) => {
                ui.label(
                    "They are lost unless the scene is saved first. The city's own files are not changed by any edit.",
                );
            }
            Asking::Replace(file, _) => {
                ui.label(format!("{} would be written over.", file.display()));
            }
            Asking::Outside(_, what) => {
                ui.label(what);
                ui.label("Allow it where you know who made the scene.");
            }
            Asking::ComeBack(left) => {
                ui.label(format!(
                    "Veduta ended before these were saved: edits of {}, kept {}.",
                    left.name(),
                    left.age()
                ));
            }
        }
        ui.add_space(8.0);
        let mut answer = None;
        ui.horizontal(|ui| {
            let names: &[&str] = match &asking {
                Asking::Lose(_) => &["Save", "Lose them", "Cancel"],
                Asking::Replace(..) => &["Replace", "Cancel"],
                Asking::Outside(..) => &["Allow", "Cancel"],
                Asking::ComeBack(_) => &["Open them", "Throw them away", "Later"],
            };
            for (i, name) in names.iter().enumerate() {
                let button = ui.button(*name);
                // Keys alone will do: Enter takes the first, Tab goes on.
                if i == 0 && ui.memory(|memory| memory.focused().is_none()) {
                    button.request_focus();
                }
                if button.clicked() {
                    answer = Some(*name);
                }
            }
        });
        answer
    });
    let answer = if response.should_close() { Some("Cancel") } else { response.inner };
    let Some(answer) = answer else { return };
    window.asking = None;
    match (asking, answer) {
        (Asking::Lose(purpose), "Lose them") => window.go_on(purpose),
        (Asking::Lose(purpose), "Save") => match window.document.file().map(Path::to_owned) {
            Some(file) => {
                window.save(&file);
                if !window.document.is_changed() {
                    window.go_on(purpose);
                }
            }
            None => {
                window.dialog = Some(FileDialog::save(std::env::current_dir().unwrap_or_default()));
                window.after_saving = Some(purpose);
            }
        },
        (Asking::Replace(file, what), "Replace") => write(window, &file, what),
        (Asking::Replace(..), _) => window.after_saving = None,
        (Asking::ComeBack(left), "Open them") => window.bring_back(left),
        (Asking::ComeBack(left), "Throw them away") => left.remove(),
        (Asking::Outside(files, _), "Allow") => window.open_allowing(&files, true),
        _ => {}
    }
}
