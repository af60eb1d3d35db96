//! A page as PDF, by krilla: pixels without loss, text that can be selected in subsets of the fonts.

use krilla::{
    Data, Document,
    color::rgb,
    geom::{Path, PathBuilder, Point, Size, Transform},
    image::Image,
    metadata::Metadata,
    num::NormalizedF32,
    page::PageSettings,
    paint::{Fill, LineJoin, Stroke},
    surface::Surface,
    text::{Font, GlyphId, KrillaGlyph},
};

use crate::{
    figure::paper::{
        Page, Told,
        marks::{Mark, Raster, SetText, Step},
    },
    lens::color::Srgb,
    render::text::{GlyphRun, fonts::Face},
};

/// Points of an inch.
const POINTS: f64 = 72.0;

/// The file; the same of the same page.
pub fn bytes(page: Page, told: &Told) -> Result<Vec<u8>, String> {
    let scale = POINTS / told.dots();
    let [width, height] = page.size.map(|side| (f64::from(side) * scale) as f32);
    let settings =
        PageSettings::from_wh(width, height).ok_or_else(|| "a page without area cannot be written".to_owned())?;
    let mut document = Document::new();
    document.set_metadata(metadata(told));
    let mut fonts = Fonts::default();
    let mut paper = document.start_page_with(settings);
    let mut surface = paper.surface();
    surface.push_transform(&Transform::from_scale(scale as f32, scale as f32));
    for mark in page.marks {
        match mark {
            Mark::Raster(raster) => draw_raster(&mut surface, raster),
            Mark::Fill(fill) => {
                if let Some(path) = path(&fill.outline) {
                    surface.set_stroke(None);
                    surface.set_fill(Some(filled(fill.color, fill.opacity)));
                    surface.draw_path(&path);
                }
            }
            Mark::Text(text) => draw_text(&mut surface, &text, &mut fonts)?,
        }
    }
    surface.pop();
    surface.finish();
    paper.finish();
    document.finish().map_err(|error| format!("cannot be made as PDF: {error:?}"))
}

fn metadata(told: &Told) -> Metadata {
    let keywords = told.note("veduta:scene").map(|hash| format!("veduta:scene={hash}"));
    let program = told.note("Software").unwrap_or_default();
    Metadata::new()
        .title(told.title.unwrap_or_default().to_owned())
        .creator(program.to_owned())
        .producer(program.to_owned())
        .keywords(keywords.into_iter().collect())
}

fn draw_raster(surface: &mut Surface, raster: Raster) {
    let [width, height] = raster.size;
    // Not a second copy: it may be a large part of all memory.
    let image = Image::from_rgba8(raster.rgba.into_flattened(), width, height);
    let Some(size) = Size::from_wh(width as f32, height as f32) else { return };
    surface.push_transform(&Transform::from_translate(raster.at[0] as f32, raster.at[1] as f32));
    surface.draw_image(image, size);
    surface.pop();
}

fn path(outline: &[Step]) -> Option<Path> {
    let mut path = PathBuilder::new();
    for step in outline {
        match *step {
            Step::Move([x, y]) => path.move_to(x, y),
            Step::Line([x, y]) => path.line_to(x, y),
            Step::Curve([[a, b], [c, d], [x, y]]) => path.cubic_to(a, b, c, d, x, y),
            Step::Close => path.close(),
        }
    }
    path.finish()
}

fn draw_text(surface: &mut Surface, text: &SetText, fonts: &mut Fonts) -> Result<(), String> {
    let map = text.map.map_or([1.0, 0.0, 0.0, 1.0, 0.0, 0.0], |map| map.to_cols_array());
    let [a, b, c, d, e, f] = map;
    surface.push_transform(&Transform::from_row(a, b, c, d, e, f));
    for run in text.runs.iter().filter(|run| !run.glyphs.is_empty()) {
        let font = fonts.get(run.face)?;
        let (start, glyphs) = placed(run);
        if let Some(halo) = text.halo {
            // As outlines: what surrounds letters is no second text.
            surface.set_fill(None);
            surface.set_stroke(Some(stroke(halo.color, halo.opacity, 2.0 * halo.width_px)));
            surface.draw_glyphs(start, &glyphs, font.clone(), &run.text, run.size_px, true);
        }
        let weight = run.face.emboldened_em() * run.size_px;
        surface.set_stroke((weight > 0.0).then(|| stroke(text.color, 1.0, weight)));
        surface.set_fill(Some(filled(text.color, 1.0)));
        surface.draw_glyphs(start, &glyphs, font, &run.text, run.size_px, false);
    }
    surface.pop();
    Ok(())
}

/// Where a run begins, and its glyphs, each as far on as the next one is.
fn placed(run: &GlyphRun) -> (Point, Vec<KrillaGlyph>) {
    let [x, y] = run.glyphs.first().map_or([0.0; 2], |glyph| glyph.at);
    let ends = run.glyphs.iter().skip(1).map(|next| next.at[0]).chain([run.end]);
    let glyph = |(glyph, end): (&crate::render::text::SetGlyph, f32)| KrillaGlyph {
        glyph_id: GlyphId::new(glyph.id.into()),
        text_range: glyph.source.clone(),
        x_advance: (end - glyph.at[0]) / run.size_px,
        x_offset: 0.0,
        y_offset: (y - glyph.at[1]) / run.size_px,
        y_advance: 0.0,
        location: None,
    };
    (Point::from_xy(x, y), run.glyphs.iter().zip(ends).map(glyph).collect())
}

fn color(color: Srgb) -> rgb::Color {
    let [r, g, b] = color.map(|c| (c.clamp(0.0, 1.0) * 255.0).round() as u8);
    rgb::Color::new(r, g, b)
}

fn share(share: f32) -> NormalizedF32 {
    NormalizedF32::new(share.clamp(0.0, 1.0)).unwrap_or(NormalizedF32::ONE)
}

fn filled(own: Srgb, opacity: f32) -> Fill {
    Fill { paint: color(own).into(), opacity: share(opacity), ..Fill::default() }
}

fn stroke(own: Srgb, opacity: f32, width: f32) -> Stroke {
    let paint = color(own).into();
    Stroke { paint, width, opacity: share(opacity), line_join: LineJoin::Round, ..Stroke::default() }
}

/// Fonts of a file, each once.
#[derive(Default)]
struct Fonts {
    by_file: [Option<Font>; Face::FILES],
}

impl Fonts {
    fn get(&mut self, face: Face) -> Result<Font, String> {
        let slot = &mut self.by_file[face.file()];
        if slot.is_none() {
            *slot = Font::new(Data::from(face.data()), 0);
        }
        slot.clone().ok_or_else(|| "a font of the program cannot be read".to_owned())
    }
}
