//! Figures for paper: PDF and SVG, in which the picture is pixels, as a PNG has them, and what stands over it lines, areas and text.
//!
//! ```text
//! Furniture ─ marks ─> rasters, filled outlines, glyphs ─┬─ pdf ─> PDF
//!                                                        └─ svg ─> SVG, with fonts (web_font)
//! ```
//!
//! The furniture is the list that the renderer draws into PNGs. What of it is an image stays one: pictures in overlays, boards in the
//! scene but for their text, lines with a skin and lines that fade.

mod marks;
mod pdf;
mod svg;
mod web_font;

use std::path::{Path, PathBuf};

use crate::{
    figure::{
        self, Apart,
        file::{WriteError, write_whole},
        picture::{self, Notes, PictureFile},
        sheet::{Layout, layout::PAPER},
    },
    gpu::GpuError,
    render::{
        bands::Band,
        furniture::{BoardPiece, Furniture, Piece},
        picture::{Picture, RenderError, Request, Studio},
        renderer::Renderer,
    },
    scene::{DEFAULT_DPI, Scene},
};

use marks::{Mark, Raster};

/// The format of a figure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Pixels alone.
    Png,
    /// A page of paper.
    Pdf,
    /// A drawing for the web, and for programs that draw.
    Svg,
}

impl Format {
    /// The format that the name of a file asks for; standard output, `-`, is PNG.
    ///
    /// # Errors
    /// Another format, in words that say which would be right.
    pub fn of(path: &Path) -> Result<Self, String> {
        let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase());
        match extension.as_deref() {
            _ if path.as_os_str() == "-" => Ok(Self::Png),
            Some("png") => Ok(Self::Png),
            Some("pdf") => Ok(Self::Pdf),
            Some("svg") => Ok(Self::Svg),
            Some(other) => {
                Err(format!("{}: .{other} cannot be written; .png, .pdf or .svg would be right", path.display()))
            }
            None => Err(format!("{}: names no format; .png, .pdf or .svg would be right", path.display())),
        }
    }
}

/// A file that a figure is to be.
#[derive(Clone, Copy, Debug)]
pub struct Target<'a> {
    /// Its path.
    pub path: &'a Path,
    /// Its format.
    pub format: Format,
    /// What it says of itself.
    pub notes: &'a Notes,
}

/// A figure that is drawn, and not there yet.
#[must_use = "it is not there before it is finished"]
pub struct Drawn {
    path: PathBuf,
    of: Of,
}

/// What it is.
enum Of {
    Pixels(Box<PictureFile>),
    Page { page: Page, format: Format, notes: Notes, title: Option<String> },
}

impl Drawn {
    /// Puts it where it is to be.
    ///
    /// # Errors
    /// Those of the file system; what the format cannot hold.
    pub fn finish(self) -> Result<(), WriteError> {
        match self.of {
            Of::Pixels(file) => file.finish(),
            Of::Page { page, format, notes, title } => page.save(&self.path, format, &notes, title.as_deref()),
        }
    }
}

/// Draws a figure for a file: pixels are written band by band, with what stands over them; formats of paper hold that apart. `also` sees every band. The
/// picture of the answer has no pixels.
///
/// # Errors
/// Those of [`figure::draw_in_bands`].
pub fn draw(
    studio: &mut Studio,
    scene: &Scene,
    request: &Request,
    target: Target,
    also: &mut dyn FnMut(&Band) -> Result<(), WriteError>,
) -> Result<(Picture, Drawn), RenderError> {
    let Target { path, format, notes } = target;
    let drawn = |of| Drawn { path: path.to_owned(), of };
    if format == Format::Png {
        let file = PictureFile::new(path, request.size, !request.transparent, notes);
        let mut file = file.map_err(|error| RenderError::Taken(error.into()))?;
        let picture = figure::draw_in_bands(studio, scene, request, &mut |band| {
            also(&band)?;
            Ok(file.rows(&band.rgba)?)
        })?;
        return Ok((picture, drawn(Of::Pixels(Box::new(file)))));
    }
    let mut rgba: Vec<[u8; 4]> = Vec::new();
    let Apart { picture, furniture } = figure::draw_apart(studio, scene, request, &mut |band| {
        also(&band)?;
        rgba.extend(band.rgba);
        Ok(())
    })?;
    let page = Page::of_figure(&mut studio.renderer, Raster { at: [0, 0], size: request.size, rgba }, &furniture)?;
    Ok((picture, drawn(Of::Page { page, format, notes: notes.clone(), title: scene.figure.title.clone() })))
}

/// A figure, ready to be written as vectors.
#[derive(Clone, Debug, PartialEq)]
pub struct Page {
    /// Width and height, pixels.
    size: [u32; 2],
    /// What is on it, bottom first.
    marks: Vec<Mark>,
}

/// What a file says of its figure beside the picture.
struct Told<'a> {
    notes: &'a Notes,
    /// Its title, if it has one.
    title: Option<&'a str>,
}

impl Told<'_> {
    /// Pixels of an inch.
    fn dots(&self) -> f64 {
        self.notes.dpi.unwrap_or(DEFAULT_DPI)
    }

    fn note(&self, keyword: &str) -> Option<&str> {
        self.notes.texts.iter().find(|(own, _)| *own == keyword).map(|(_, text)| text.as_str())
    }
}

impl Page {
    /// The page of a picture and of what stands over it, whose images are those that the renderer keeps: nothing else may have been drawn since.
    ///
    /// # Errors
    /// Those of the GPU.
    fn of_figure(renderer: &mut Renderer, picture: Raster, over: &Furniture) -> Result<Self, GpuError> {
        let size = picture.size;
        let over = drawn(renderer, size, over)?;
        Ok(Self { size, marks: std::iter::once(Mark::Raster(picture)).chain(over).collect() })
    }

    /// The page of a sheet, whose cells are pictures of one size.
    ///
    /// # Errors
    /// Those of the GPU.
    pub fn of_sheet<'a>(
        renderer: &mut Renderer,
        layout: &Layout,
        cells: impl Iterator<Item = &'a [[u8; 4]]>,
    ) -> Result<Self, GpuError> {
        let ground = marks::rectangle([0.0, 0.0], layout.size.map(|side| side as f32), PAPER);
        let furniture = drawn(renderer, layout.size, &layout.furniture)?;
        let cells = layout
            .cells
            .iter()
            .zip(cells)
            .map(|(at, rgba)| Mark::Raster(Raster { at: *at, size: layout.cell_size, rgba: rgba.to_vec() }));
        Ok(Self { size: layout.size, marks: std::iter::once(ground).chain(furniture).chain(cells).collect() })
    }

    /// Writes it, as PDF or SVG. A file of `size` pixels at D dots per inch is `size`/D inches large; D is 96 where the notes say none.
    ///
    /// # Errors
    /// Those of the file system; what the format cannot hold.
    pub fn save(self, path: &Path, format: Format, notes: &Notes, title: Option<&str>) -> Result<(), WriteError> {
        let told = Told { notes, title };
        let wrong = |message: String| WriteError::Format { path: path.to_owned(), message };
        let bytes = match format {
            Format::Pdf => pdf::bytes(self, &told).map_err(wrong)?,
            Format::Svg => svg::text(&self, &told).map_err(wrong)?.into_bytes(),
            Format::Png => return Err(wrong("a page is written as .pdf or .svg; name one of them".to_owned())),
        };
        write_whole(path, |out| out.write_all(&bytes))
    }
}

/// The marks of furniture; what has none but pixels is drawn by the renderer.
fn drawn(renderer: &mut Renderer, size: [u32; 2], furniture: &Furniture) -> Result<Vec<Mark>, GpuError> {
    let mut all = Vec::new();
    for run in furniture.pieces.chunk_by(|a, b| marks::is_image(a) == marks::is_image(b)) {
        match run.first().is_some_and(marks::is_image) {
            true => images(renderer, size, run, &mut all)?,
            false => all.extend(marks::of(run)),
        }
    }
    Ok(all)
}

/// Images as pixels, and the text of boards as text over them.
fn images(renderer: &mut Renderer, size: [u32; 2], pieces: &[Piece], all: &mut Vec<Mark>) -> Result<(), GpuError> {
    let layer = |renderer: &mut Renderer, pieces: Vec<Piece>, all: &mut Vec<Mark>| -> Result<(), GpuError> {
        let rgba = renderer.layer(size, &Furniture { pieces })?;
        all.extend(Raster { at: [0, 0], size, rgba }.trimmed().map(Mark::Raster));
        Ok(())
    };
    let mut waiting: Vec<Piece> = Vec::new();
    for piece in pieces {
        let Piece::Board(board) = piece else {
            waiting.push(piece.clone());
            continue;
        };
        let Some(apart) = renderer.board_apart(board.image)? else {
            waiting.push(piece.clone());
            continue;
        };
        waiting.push(Piece::Board(BoardPiece { image: apart.image, ..*board }));
        layer(renderer, std::mem::take(&mut waiting), all)?;
        renderer.forget_image(apart.image);
        all.extend(marks::on_board(&apart.texts, board, apart.size));
    }
    if waiting.is_empty() { Ok(()) } else { layer(renderer, waiting, all) }
}

/// The bytes of a PNG of some pixels, without alpha where all are opaque.
fn png(raster: &Raster) -> Result<Vec<u8>, String> {
    let is_opaque = raster.is_opaque();
    picture::png_of(raster.size, &raster.rgba, is_opaque, &Notes::default()).map_err(|error| error.to_string())
}

#[cfg(test)]
mod tests;
