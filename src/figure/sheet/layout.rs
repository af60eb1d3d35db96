//! Where everything stands on a sheet, in pixels.
//!
//! ```text
//! title
//!            heading      heading        of columns
//! heading   +--------+   +--------+
//!           |  cell  |   |  cell  |
//!           +--------+   +--------+
//!            caption      caption
//!            figures      figures
//! caption                  legends
//! ```

use crate::{
    figure::{
        furniture::{
            card::{Content, INK, Line, Painter, QUIET_INK, Size},
            height_of, section,
        },
        legend::Legend,
        sheet::Sheet,
    },
    lens::color::Srgb,
    render::{
        furniture::{Furniture, Panel, Piece},
        text::{TextStyle, Weight},
    },
    scene::{DEFAULT_DPI, TextSize},
    view::MAX_SIZE,
};

/// The page that a sheet fits without a size of its own: A4 landscape, millimetres.
const A4_MM: [f64; 2] = [297.0, 210.0];
const MM_PER_INCH: f64 = 25.4;
/// Dots per inch of it where the sheet says nothing else.
pub const A4_DPI: f64 = 300.0;
/// The em on it, points, and what it may be where there is little room: 36, 30 and 25 pixels at 300 dpi.
const A4_EMS: [TextSize; 3] = [TextSize::Points(8.64), TextSize::Points(7.2), TextSize::Points(6.0)];
/// Width of all columns of a sheet with cells of a given size, em.
const COLUMNS_EM: f32 = 97.0;
/// No text is smaller unless the sheet says so, pixels.
const LEAST_EM_PX: f32 = 10.0;
/// No cell is narrower unless the sheet says so, em.
const LEAST_CELL_EM: f32 = 8.0;
/// Width of the cells of a sheet that is longer than A4, em.
const LONG_CELL_EM: f32 = 20.0;
/// Title and caption have at least this width, em.
const LEAST_WIDTH_EM: f32 = 20.0;
/// Width of headings of rows, of a legend, and of a caption beside legends at least, em.
const HEAD_EM: f32 = 9.0;
const LEGEND_EM: f32 = 18.0;
const CAPTION_EM: f32 = 24.0;
/// What is behind everything, sRGB.
pub const PAPER: Srgb = [1.0; 3];
/// A line around cells, so that a pale one does not fade into the paper.
const RIM: Srgb = [0.72, 0.73, 0.75];

/// Texts of the cells, in the order of the cells.
#[derive(Clone, Debug, Default)]
pub struct Words {
    /// Below each cell.
    pub captions: Vec<Option<String>>,
    /// Numbers below it; of each cell as many.
    pub figures: Vec<Vec<String>>,
}

/// A page.
#[derive(Clone, Debug, PartialEq)]
pub struct Layout {
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// Width and height of each cell, pixels.
    pub cell_size: [u32; 2],
    /// Size of the text, its em, pixels.
    pub text_px: f32,
    /// Left and top of each cell.
    pub cells: Vec<[u32; 2]>,
    /// All but the cells.
    pub furniture: Furniture,
}

/// Lays out a sheet whose cells have the proportions of `scene_size`.
///
/// # Errors
/// Where the page would be larger than a picture may be.
pub fn lay_out(sheet: &Sheet, words: &Words, legends: &[Legend], scene_size: [u32; 2]) -> Result<Layout, String> {
    let page = Page { sheet, words, legends };
    let found = match sheet.cell_size {
        Some(size) => {
            let columns = (size[0] as f32) * sheet.lines()[1] as f32;
            let dpi = sheet.dpi.unwrap_or(DEFAULT_DPI);
            page.with(size, sheet.text.map_or((columns / COLUMNS_EM).max(LEAST_EM_PX), |text| text.px(dpi) as f32))
        }
        None => page.on_a4(scene_size),
    };
    let [w, h] = found.size;
    if w.max(h) > MAX_SIZE {
        return Err(format!(
            "the sheet would be {w}x{h} pixels, and {MAX_SIZE} is the most on a side; a smaller cell_size, or fewer rows or columns \
             would be right"
        ));
    }
    Ok(found)
}

/// A4 landscape, pixels.
pub fn a4(dpi: f64) -> [u32; 2] {
    A4_MM.map(|mm| (mm / MM_PER_INCH * dpi).round() as u32)
}

struct Page<'a> {
    sheet: &'a Sheet,
    words: &'a Words,
    legends: &'a [Legend],
}

impl Page<'_> {
    /// With the largest cells that fit A4, with smaller text where there are none; what does not fit with any is longer.
    fn on_a4(&self, [w, h]: [u32; 2]) -> Layout {
        let dpi = self.sheet.dpi.unwrap_or(A4_DPI);
        let a4 = a4(dpi);
        let ems: Vec<f32> =
            self.sheet.text.map_or(A4_EMS.to_vec(), |text| vec![text]).iter().map(|em| em.px(dpi) as f32).collect();
        let of_width = |width: u32, em: f32| {
            let height = (f64::from(width) * f64::from(h) / f64::from(w)).round().clamp(1.0, f64::from(MAX_SIZE));
            self.with([width, height as u32], em)
        };
        let [lines, per_line] = self.sheet.lines().map(|n| n as u32);
        let least = |em: f32| (LEAST_CELL_EM * em).ceil() as u32;
        for em in &ems {
            let mut width = a4[0];
            while width >= least(*em) {
                let found = of_width(width, *em);
                let [over_x, over_y] = [0, 1].map(|axis| found.size[axis].saturating_sub(a4[axis]));
                if over_x == 0 && over_y == 0 {
                    return found;
                }
                // The narrower the cells, the longer what stands below them: no width between this one and the next fits.
                let of_height = f64::from(over_y) / f64::from(lines) * f64::from(w) / f64::from(h);
                let step = over_x.div_ceil(per_line).max(of_height.ceil().min(f64::from(MAX_SIZE)) as u32).max(1);
                width = width.saturating_sub(step);
            }
        }
        let em = ems[ems.len() - 1];
        of_width((LONG_CELL_EM * em).ceil() as u32, em)
    }

    fn with(&self, cell: [u32; 2], em: f32) -> Layout {
        let sheet = self.sheet;
        let mut pen = Pen { painter: Painter::new(em) };
        let margin = pen.painter.px(1.8);
        let gap = sheet.gap_px.map_or(pen.painter.px(1.0), |px| (px as f32).round());
        let [lines, per_line] = sheet.lines();
        let [_, columns] = sheet.grid();
        let [w, h] = cell.map(|side| side as f32);
        let bold = TextStyle { size_px: em, weight: Weight::SemiBold, tabular: false };
        let plain = TextStyle { weight: Weight::Regular, ..bold };
        let figures_style = TextStyle { size_px: 0.92 * em, weight: Weight::Regular, tabular: true };
        let rows: Vec<Vec<Line>> = (0..lines)
            .map(|line| {
                let heading = sheet.rows.get(line).and_then(|row| row.heading.as_deref());
                pen.lines(heading, bold, INK, HEAD_EM * em, ((h / (1.4 * em)) as usize).clamp(1, 6))
            })
            .collect();
        let widest = rows.iter().map(|lines| width_of(lines)).fold(0.0, f32::max);
        let head = if widest > 0.0 { widest.ceil() + pen.painter.px(0.8) } else { 0.0 };
        let grid = per_line as f32 * w + (per_line as f32 - 1.0) * gap;
        let content = (head + grid).max(LEAST_WIDTH_EM * em);
        let mut y = margin;
        if let Some(title) = &sheet.title {
            let style = TextStyle { size_px: 1.5 * em, ..bold };
            let lines = pen.lines(Some(title), style, INK, content, 2);
            y = pen.put(&lines, [margin, y]) + pen.painter.px(0.7);
        }
        let mut places = vec![[0, 0]; sheet.grid()[0] * columns];
        let wraps = lines != sheet.grid()[0];
        for (line, row_heading) in rows.iter().enumerate() {
            // Of this line: the cells by place, each with its column.
            let of_line: Vec<(usize, usize, f32)> = (0..per_line)
                .map(|at| (at, if wraps { line * per_line + at } else { at }))
                .filter(|(_, column)| *column < columns)
                .map(|(at, column)| (at, column, margin + head + at as f32 * (w + gap)))
                .collect();
            if line == 0 || wraps {
                let headings: Vec<(f32, Vec<Line>)> = of_line
                    .iter()
                    .map(|&(_, column, x)| {
                        let heading = sheet.columns.get(column).and_then(|one| one.heading.as_deref());
                        (x, pen.lines(heading, bold, INK, w, 2))
                    })
                    .collect();
                let tallest = headings.iter().map(|(_, lines)| height_of(lines)).fold(0.0, f32::max);
                for (x, lines) in &headings {
                    pen.put(lines, [*x, y + tallest - height_of(lines)]);
                }
                y += tallest + if tallest > 0.0 { pen.painter.px(0.2) } else { 0.0 };
            }
            pen.put(row_heading, [margin, y + ((h - height_of(row_heading)) / 2.0).round()]);
            let mut below = 0.0_f32;
            for &(_, column, x) in &of_line {
                let cell = if wraps { column } else { line * columns + column };
                places[cell] = [x as u32, y as u32];
                pen.rim([x, y], [x + w, y + h]);
                let caption = self.words.captions.get(cell).and_then(Option::as_deref);
                let mut lines = pen.lines(caption, plain, INK, w, 4);
                for figure in self.words.figures.get(cell).into_iter().flatten() {
                    lines.extend(pen.lines(Some(figure), figures_style, QUIET_INK, w, 1));
                }
                let end = pen.put(&lines, [x, y + h + pen.painter.px(0.3)]);
                below = below.max(if lines.is_empty() { 0.0 } else { end - y - h });
            }
            y += h + below;
            if line + 1 < lines {
                y += gap;
            }
        }
        y = self.footer(&mut pen, [margin, y], content, plain);
        Layout {
            size: [(content + 2.0 * margin).ceil() as u32, (y + margin).ceil() as u32],
            cell_size: cell,
            text_px: em,
            cells: places,
            furniture: Furniture { pieces: pen.painter.pieces },
        }
    }

    /// Caption and legends, beside each other where there is room; where it ends.
    fn footer(&self, pen: &mut Pen, [left, top]: [f32; 2], content: f32, style: TextStyle) -> f32 {
        let em = pen.painter.em;
        let [pad_x, pad_y] = pen.painter.padding();
        let room = Size { width: (LEGEND_EM * em).min(content) + 2.0 * pad_x, height: 16.0 * em + 2.0 * pad_y };
        let legends: Vec<Vec<Line>> = self
            .legends
            .iter()
            .map(|legend| section::fitted(&mut pen.painter, std::slice::from_ref(legend), room))
            .filter(|lines| !lines.is_empty())
            .collect();
        let apart = pen.painter.px(2.0);
        let all: f32 = legends.iter().map(|lines| width_of(lines).ceil() + apart).sum();
        let caption = self.sheet.caption.as_deref();
        if caption.is_none() && legends.is_empty() {
            return top;
        }
        let top = top + pen.painter.px(1.0);
        let is_beside = content - all >= CAPTION_EM * em;
        let width = if is_beside { content - all } else { content };
        let lines = pen.lines(caption, style, INK, width.min(60.0 * em), 8);
        let mut end = pen.put(&lines, [left, top]);
        let (mut x, mut y) = (left, top);
        if caption.is_some() && is_beside {
            x = left + content - (all - apart);
        } else if !lines.is_empty() {
            y = end + pen.painter.px(0.8);
        }
        let first = x;
        let mut lowest = y;
        for lines in &legends {
            let width = width_of(lines).ceil();
            if x > first && x + width > left + content {
                (x, y) = (first, lowest + pen.painter.px(0.8));
            }
            lowest = lowest.max(pen.put(lines, [x, y]));
            x += width + apart;
        }
        end = end.max(if legends.is_empty() { end } else { lowest });
        end
    }
}

/// Sets lines and panels.
struct Pen {
    painter: Painter,
}

impl Pen {
    /// Running text in at most `most` lines.
    fn lines(&mut self, text: Option<&str>, style: TextStyle, ink: Srgb, width: f32, most: usize) -> Vec<Line> {
        let height = (1.4 * style.size_px).round();
        let wrapped = text.map_or_else(Vec::new, |text| self.painter.setter.wrapped(text, style, width, most));
        wrapped
            .into_iter()
            .map(|text| {
                let width = self.painter.setter.width(&text, style);
                Line { height, width, content: Content::Texts(vec![(text, style, ink)]) }
            })
            .collect()
    }

    /// Puts lines there, one below the other; where they end.
    fn put(&mut self, lines: &[Line], [x, mut y]: [f32; 2]) -> f32 {
        for line in lines {
            self.painter.line(line, [x, y]);
            y += line.height;
        }
        y
    }

    fn rim(&mut self, low: [f32; 2], high: [f32; 2]) {
        let line = self.painter.hairline();
        self.painter.pieces.push(Piece::Panel(Panel {
            low: low.map(|v| v - line),
            high: high.map(|v| v + line),
            color: RIM,
            opacity: 1.0,
            radius_px: 0.0,
            softness_px: 1.0,
            ellipse: false,
        }));
    }
}

fn width_of(lines: &[Line]) -> f32 {
    lines.iter().map(|line| line.width).fold(0.0, f32::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::sheet::file;

    fn sheet(text: &str) -> Sheet {
        file::parse(&format!("veduta_sheet = 1\nscene = \"a\"\n{text}"), "s").unwrap()
    }

    fn laid(text: &str, figures: usize) -> Result<Layout, String> {
        let sheet = sheet(text);
        let count = sheet.grid()[0] * sheet.grid()[1];
        let words = Words {
            captions: vec![Some("A caption of some length that may take two lines of a narrow cell.".into()); count],
            figures: vec![vec!["visible share 64 %".into(); figures]; count],
        };
        lay_out(&sheet, &words, &[], [1280, 720])
    }

    /// Boxes of texts and cells: none meets another.
    fn check_apart(found: &Layout) {
        let mut boxes: Vec<[f32; 4]> = Vec::new();
        let [w, h] = found.cell_size.map(|side| side as f32);
        for [x, y] in found.cells.iter().map(|at| at.map(|v| v as f32)) {
            boxes.push([x, y, x + w, y + h]);
        }
        let mut painter = Painter::new(10.0);
        for piece in &found.furniture.pieces {
            if let Piece::Text(line) = piece {
                let ([x, y], width) = (line.at, painter.setter.width(&line.text, line.style));
                boxes.push([x, y - 0.73 * line.style.size_px, x + width, y + 0.2 * line.style.size_px]);
            }
        }
        for (i, a) in boxes.iter().enumerate() {
            assert!(a[0] >= 0.0 && a[1] >= 0.0, "{a:?}");
            assert!(a[2] <= found.size[0] as f32 && a[3] <= found.size[1] as f32, "{a:?} in {:?}", found.size);
            for b in &boxes[..i] {
                let apart = a[2] <= b[0] || b[2] <= a[0] || a[3] <= b[1] || b[3] <= a[1];
                assert!(apart, "{a:?} and {b:?}");
            }
        }
    }

    const TEXTS: &str = "title = \"A title\"\ncaption = \"A caption below everything.\"\n";

    #[test]
    fn a_sheet_fills_a4_and_nothing_meets() {
        let a4 = a4(A4_DPI);
        assert_eq!(a4, [3508, 2480]);
        for (rows, columns) in [(1, 1), (1, 4), (3, 4), (4, 3), (2, 9)] {
            let named = |key: &str, n| (0..n).map(|i| format!("[[{key}]]\nname = \"{key}-{i}\"\n")).collect::<String>();
            let found = laid(&format!("{TEXTS}{}{}", named("row", rows), named("column", columns)), 3).unwrap();
            assert!(found.size[0] <= a4[0] && found.size[1] <= a4[1], "{:?}", found.size);
            // A caption that takes a line more in a narrower cell leaves a line free in each row.
            let is_full = found.size[0] + 40 > a4[0] || found.size[1] + 40 + 60 * rows as u32 > a4[1];
            assert!(is_full, "{rows}x{columns}: {:?}", found.size);
            assert_eq!(found.cells.len(), rows * columns);
            check_apart(&found);
        }
    }

    #[test]
    fn what_does_not_fit_is_longer_and_not_smaller_than_legible() {
        let rows = "[[row]]\n".repeat(30);
        let found = laid(&format!("{TEXTS}{rows}[[column]]\n[[column]]\n"), 3).unwrap();
        assert!(
            found.text_px == 25.0 && found.cell_size == [500, 281] && found.size[1] > a4(A4_DPI)[1],
            "{:?}",
            found.size
        );
        check_apart(&found);
    }

    #[test]
    fn points_follow_the_dots_of_the_paper() {
        let columns = "column = [{}, {}]\n";
        // 36 pixels at 300 dots per inch are as long as 18 at 150, on half the page.
        for (dpi, em, page) in
            [("", 36.0, [3508, 2480]), ("dpi = 150\n", 18.0, [1754, 1240]), ("dpi = 600\n", 72.0, [7016, 4961])]
        {
            let found = laid(&format!("{columns}{dpi}"), 1).unwrap();
            assert_eq!(found.text_px, em);
            assert!(
                found.size[0] <= page[0] && found.size[0] + 40 > page[0] && found.size[1] <= page[1],
                "{:?}",
                found.size
            );
        }
        let em = |text: &str| laid(&format!("{columns}{text}"), 0).unwrap().text_px;
        assert_eq!(em("text_pt = 7.5"), 31.25);
        assert_eq!(em("text_pt = 7.5\ndpi = 600"), 62.5);
        assert_eq!(em("text_pt = 7.5\ncell_size = [640, 480]"), 10.0);
        assert_eq!(em("text_pt = 7.5\ncell_size = [640, 480]\ndpi = 144"), 15.0);
        assert_eq!(em("text_px = 20\ndpi = 600"), 20.0);
        let said = |text: &str| sheet(text).dpi_of_file();
        assert_eq!([said(""), said("dpi = 600"), said("cell_size = [64, 48]")], [Some(300.0), Some(600.0), None]);
        assert_eq!(said("cell_size = [64, 48]\ndpi = 150"), Some(150.0));
    }

    #[test]
    fn wrapped_columns_stand_in_lines_with_their_headings() {
        let columns: String = (0..7).map(|i| format!("[[column]]\nname = \"style-{i}\"\n")).collect();
        let found = laid(&format!("{TEXTS}wrap = 3\n{columns}"), 1).unwrap();
        check_apart(&found);
        let [a, b, c] = [0, 3, 6].map(|i| found.cells[i]);
        assert!(a[0] == b[0] && b[0] == c[0] && a[1] < b[1] && b[1] < c[1]);
        let headings =
            found.furniture.pieces.iter().filter(|p| matches!(p, Piece::Text(t) if t.text.starts_with("style")));
        assert_eq!(headings.count(), 7);
    }

    #[test]
    fn cells_have_the_size_that_is_asked_for_or_it_is_refused() {
        let found = laid("cell_size = [64, 48]\ntext_px = 6\ncolumn = [{}, {}, {}]", 0).unwrap();
        assert_eq!(found.cell_size, [64, 48]);
        assert_eq!(found.cells[1][0] - found.cells[0][0], 64 + 6, "an em apart");
        check_apart(&found);
        let message = laid("cell_size = [9000, 48]\ncolumn = [{}, {}]", 0).unwrap_err();
        assert!(message.contains("and 16384 is the most on a side") && message.contains("cell_size"), "{message}");
    }
}
