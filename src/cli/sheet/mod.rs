//! `veduta sheet`: a captioned comparison grid of one scene.

mod figures;

use std::path::{Path, PathBuf};

use clap::Args;

use crate::{
    city::builtin,
    cli::{
        arguments::GlobalArguments,
        failure::{Failure, Outcome},
        output,
        quality::Smoothness,
        render, terminal,
    },
    figure::{
        self,
        file::write_whole,
        legend::{self, Legend},
        paper::{Format, Page},
        picture::{self, Notes},
        scene_file::{self, Options},
        sheet::{
            self, Cell, Layout, Sheet, Words,
            layout::{PAPER, lay_out},
        },
    },
    render::picture::{Request, Studio},
    scene::{CitySpec, Scene, SceneProblem, TextSize, check_against},
};
use figures::Figures;

const EXAMPLES: &str = "\
Examples:
  veduta sheet styles.sheet.toml -o styles.png
  veduta sheet styles.sheet.toml -o styles.png --cells cells
  veduta sheet styles.sheet.toml -o styles.png --set style.base=clay --figures styles.json

SHEET names a scene and what of it changes in each row and column (docs/sheet.md). Beside OUT each cell is written
as the picture that `veduta render` makes of it: OUT-ROW-COLUMN.png.";

/// Arguments of `veduta sheet`.
#[derive(Args, Clone, Debug, Default)]
#[command(after_help = EXAMPLES)]
pub struct Arguments {
    /// A sheet file; `-` for stdin
    #[arg(value_name = "SHEET.toml")]
    pub sheet: PathBuf,
    /// The sheet to write: PNG, PDF or SVG by its name; `-` for stdout, as PNG
    #[arg(short, long, value_name = "OUT.png|pdf|svg")]
    pub output: PathBuf,
    /// Write the cells into this folder, as ROW-COLUMN.png; made where it is missing
    #[arg(long, value_name = "DIR")]
    pub cells: Option<PathBuf>,
    /// Write the figures of all cells as JSON
    #[arg(long = "figures", value_name = "FILE.json")]
    pub figures: Option<PathBuf>,
    /// How smooth pictures are.
    #[command(flatten)]
    pub smoothness: Smoothness,
    /// Change the scene before the sheet does; repeatable, in order
    #[arg(long = "set", value_name = "PATH=VALUE")]
    pub settings: Vec<String>,
}

/// A sheet and all that it takes to draw it.
pub struct Task {
    /// Its name in messages.
    pub name: String,
    /// The sheet.
    pub sheet: Sheet,
    /// The scene it varies.
    pub scene: Scene,
    /// The rules by which paths in the scene are read.
    pub options: Options,
    /// All files that will be written.
    pub written: Vec<PathBuf>,
}

/// A sheet drawn.
pub struct Drawn {
    /// Dots per inch, where it is made for a paper.
    dpi: Option<f64>,
    layout: Layout,
    cells: Vec<(Cell, Vec<[u8; 4]>)>,
    figures: Vec<Figures>,
    page: Vec<[u8; 4]>,
}

/// Draws the sheet and its cells.
pub fn run(arguments: &Arguments, global: &GlobalArguments) -> Outcome {
    let output = &arguments.output;
    let format = Format::of(output).map_err(Failure::usage)?;
    let outputs = || std::iter::once(output).chain(&arguments.figures);
    output::check(outputs(), [&arguments.sheet])?;
    let name = arguments.sheet.display().to_string();
    let sheet = sheet::file::read(&arguments.sheet).map_err(Failure::failed)?;
    let of_sheet = render::options_of(Some(&arguments.sheet), global);
    let file = of_sheet.resolve(&sheet.scene).map_err(|problem| match problem {
        scene_file::PathProblem::NoData => Failure::failed(format!("{name}: scene: VEDUTA_DATA is not set")),
        scene_file::PathProblem::Wrong(message) => Failure::failed(format!("{name}: scene: {message}")),
    })?;
    let options = render::options_of(Some(&file), global);
    let scene =
        scene_file::read(&file, &options).map_err(|error| Failure::failed(format!("{name}: scene: {error}")))?;
    let mut scene = render::changed(scene, &arguments.settings)?;
    let mut sheet = sheet;
    if arguments.smoothness.is_told() {
        sheet.samples = None;
    }
    arguments.smoothness.put_into(&mut scene)?;
    let mut task = Task { name, sheet, scene, options: options.clone(), written: Vec::new() };
    let cells = cell_files(arguments, &cells_of(&task)?)?;
    task.written = outputs().chain(&cells).cloned().collect();
    output::keep(&task.written, scene_file::files_of(&task.scene).iter().chain([&file, &arguments.sheet]))?;
    let mut kept = None;
    let drawn = draw(&task, &mut kept, global)?;
    if let Some(folder) = &arguments.cells {
        std::fs::create_dir_all(folder).map_err(|error| Failure::io(&folder.display().to_string(), &error))?;
    }
    for (file, (cell, rgba)) in cells.iter().zip(&drawn.cells) {
        let notes = picture::notes_of(&cell.scene, &options);
        picture::save_picture(file, drawn.layout.cell_size, rgba, true, &notes).map_err(output::unwritten)?;
    }
    if let Some(file) = &arguments.figures {
        let mut text = serde_json::to_string_pretty(&json(&drawn)).map_err(Failure::failed)?;
        text.push('\n');
        write_whole(file, |out| out.write_all(text.as_bytes())).map_err(output::unwritten)?;
    }
    // Last, so that a sheet that is there means that everything is there.
    match (format, kept) {
        (Format::Pdf | Format::Svg, Some((_, mut studio))) => {
            let cells = drawn.cells.iter().map(|(_, rgba)| &rgba[..]);
            let page = Page::of_sheet(&mut studio.renderer, &drawn.layout, cells).map_err(Failure::failed)?;
            page.save(output, format, &notes_of(&drawn), task.sheet.title.as_deref()).map_err(output::unwritten)
        }
        _ => save(output, &drawn),
    }
}

fn notes_of(drawn: &Drawn) -> Notes {
    Notes { dpi: drawn.dpi, ..picture::notes(None) }
}

/// Writes the sheet itself.
pub fn save(file: &Path, drawn: &Drawn) -> Outcome {
    let page = &drawn.layout;
    picture::save_picture(file, page.size, &drawn.page, true, &notes_of(drawn)).map_err(output::unwritten)
}

/// Where the cells go: no two to one file, and none to the sheet's.
fn cell_files(arguments: &Arguments, cells: &[Cell]) -> Outcome<Vec<PathBuf>> {
    let output = &arguments.output;
    let stem = output.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
    let file = |cell: &Cell| match &arguments.cells {
        Some(folder) => Some(folder.join(format!("{}.png", cell.name))),
        None if output.as_os_str() == "-" => None,
        None => Some(output.with_file_name(format!("{stem}-{}.png", cell.name))),
    };
    let files: Vec<PathBuf> = cells.iter().filter_map(file).collect();
    match files.iter().find(|file| *file == output || Some(*file) == arguments.figures.as_ref()) {
        Some(twice) => Err(Failure::usage(format!("{}: two results cannot go to one file", twice.display()))),
        None => Ok(files),
    }
}

fn json(drawn: &Drawn) -> serde_json::Value {
    let cells = drawn.cells.iter().zip(&drawn.figures);
    let cell = |((cell, _), figures): (&(Cell, _), &Figures)| figures.json(cell);
    serde_json::json!({ "cell_size": drawn.layout.cell_size, "cells": cells.map(cell).collect::<Vec<_>>() })
}

/// The cells of a sheet.
fn cells_of(Task { name, sheet, scene, options, .. }: &Task) -> Outcome<Vec<Cell>> {
    // Folders of files that the command line put into the scene are named by that.
    let folder = |file: &PathBuf| {
        let folder = file.parent().filter(|_| !file.to_string_lossy().starts_with(builtin::PREFIX))?;
        Some(if folder.as_os_str().is_empty() { PathBuf::from(".") } else { folder.to_owned() })
    };
    let named = scene.city.files.iter().filter_map(folder);
    let roots = options.roots.iter().cloned().chain(named).collect();
    let of_sheet = Options { roots, ..options.clone() };
    sheet::cells(sheet, scene, name, &of_sheet).map_err(Failure::failed)
}

/// Draws a sheet. `kept` is a studio that may have its city, and gets the last one used.
pub fn draw(task: &Task, kept: &mut Option<(CitySpec, Studio)>, global: &GlobalArguments) -> Outcome<Drawn> {
    let Task { name, sheet, scene, .. } = task;
    let mut cells = cells_of(task)?;
    let failed = |message: String| Failure::failed(format!("{name}: {message}"));
    let count = cells.len();
    let size = scene.figure.pixels();
    let mut words = Words {
        captions: cells.iter().map(|cell| cell.caption.clone()).collect(),
        figures: vec![vec!["–".to_owned(); sheet.figures.len()]; count],
    };
    // Before a city is loaded: what is too large stays so with legends.
    lay_out(sheet, &words, &[], size).map_err(failed)?;
    // Cells of one city follow each other: it is loaded once.
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by_key(|&i| (cells.iter().position(|cell| cell.scene.city == cells[i].scene.city), i));
    let mut legends: Vec<Legend> = Vec::new();
    let mut reported: Vec<SceneProblem> = Vec::new();
    for &i in &order {
        let cell = &mut cells[i];
        let was_open = kept.as_ref().is_some_and(|(city, _)| *city == cell.scene.city);
        let studio = studio_of(kept, &cell.scene, task, global)?;
        let mut problems = check_against(&cell.scene, &studio.model);
        problems.retain(|problem| !reported.contains(problem));
        // Opening tells those of its scene.
        let new = if was_open { render::told(problems, &format!("cell {}: scene", cell.name))? } else { problems };
        reported.extend(new);
        if sheet.legend {
            let shown = studio.on_ground(&cell.scene).and_then(|scene| {
                let volumes = studio.volumes(&scene)?;
                Ok((studio.lenses_in_view(&scene, size)?, studio.shown_beside(&scene, size)?, volumes))
            });
            let (seen, beside, volumes) = shown.map_err(|error| failed(format!("cell {}: {error}", cell.name)))?;
            legend::join(&mut legends, legend::volume_legends(&cell.scene, &volumes));
            legend::join(&mut legends, legend::legends(&cell.scene, studio.file(), &seen, &studio.model, &beside));
        }
    }
    let planned = lay_out(sheet, &words, &legends, size).map_err(failed)?;
    let cell_size = planned.cell_size;
    let mut pictures: Vec<Vec<[u8; 4]>> = vec![Vec::new(); count];
    let mut found: Vec<Figures> = vec![Figures::default(); count];
    let progress = terminal::Progress::counting(count as u64, "drawing", "cells", global);
    for (done, &i) in order.iter().enumerate() {
        let cell = &mut cells[i];
        cell.scene.figure.set_pixels(cell_size);
        progress.says(format!("drawing {}", cell.name));
        let studio = studio_of(kept, &cell.scene, task, global)?;
        let in_cell = |error: &dyn std::fmt::Display| failed(format!("cell {}: {error}", cell.name));
        pictures[i] =
            figure::draw_untitled(studio, &cell.scene, &request(&cell.scene)).map_err(|error| in_cell(&error))?.rgba;
        found[i] = figures::of(studio, cell, sheet).map_err(|error| in_cell(&error))?;
        words.figures[i] = sheet.figures.iter().map(|figure| found[i].text(*figure)).collect();
        progress.at(done as u64 + 1);
    }
    drop(progress);
    let planned =
        Sheet { cell_size: Some(cell_size), text: Some(TextSize::Pixels(planned.text_px.into())), ..sheet.clone() };
    let layout = lay_out(&planned, &words, &legends, size).map_err(failed)?;
    let Some((_, studio)) = kept else { return Err(failed("there is no cell".to_owned())) };
    let mut page =
        studio.renderer.page(layout.size, PAPER, &layout.furniture).map_err(|error| failed(error.to_string()))?;
    for (at, rgba) in layout.cells.iter().zip(&pictures) {
        blit(&mut page, layout.size[0], *at, rgba, cell_size);
    }
    Ok(Drawn {
        dpi: sheet.dpi_of_file(),
        layout,
        cells: cells.into_iter().zip(pictures).collect(),
        figures: found,
        page,
    })
}

/// The studio of a scene's city: the kept one, if it has that city.
fn studio_of<'k>(
    kept: &'k mut Option<(CitySpec, Studio)>,
    scene: &Scene,
    task: &Task,
    global: &GlobalArguments,
) -> Outcome<&'k mut Studio> {
    if kept.as_ref().is_none_or(|(city, _)| *city != scene.city) {
        // The old one goes first: two cities may be more than the GPU holds.
        *kept = None;
        *kept = Some((scene.city.clone(), render::open(scene, &task.options, &task.written, global)?.0));
    }
    let (_, studio) = kept.as_mut().ok_or_else(|| Failure::failed("no city"))?;
    Ok(studio)
}

/// The request that `veduta render` makes.
fn request(scene: &Scene) -> Request {
    Request { samples: scene.figure.samples(), ..Request::plain(scene.figure.pixels()) }
}

fn blit(page: &mut [[u8; 4]], width: u32, [x, y]: [u32; 2], rgba: &[[u8; 4]], [w, h]: [u32; 2]) {
    for row in 0..h as usize {
        let to = (y as usize + row) * width as usize + x as usize;
        page[to..to + w as usize].copy_from_slice(&rgba[row * w as usize..(row + 1) * w as usize]);
    }
}
