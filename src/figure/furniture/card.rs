//! A card: lines one below the other on a quiet ground, in a corner of the picture.

use crate::{
    figure::furniture::{desk::Area, height_of},
    lens::color::Srgb,
    render::{
        furniture::{Panel, Piece},
        text::{CAP_HEIGHT, Halo, TextLine, TextStyle, Typesetter},
    },
};

/// The ground of cards, and how much of the city it hides: print shows through what is thinner.
const CARD: Fill = Fill { color: [1.0, 1.0, 1.0], opacity: 0.93 };
const SHADOW: Fill = Fill { color: [0.05, 0.07, 0.1], opacity: 0.22 };
/// Text that says what something is.
pub const INK: Srgb = [0.1, 0.115, 0.14];
/// Text beside it.
pub const QUIET_INK: Srgb = [0.33, 0.355, 0.39];
/// Columns of a histogram.
const COLUMN: Srgb = [0.56, 0.585, 0.62];
/// A line around swatches, so that a pale one does not fade into the card.
pub(super) const RIM: Fill = Fill { color: [0.0, 0.0, 0.0], opacity: 0.22 };

/// How a panel is filled.
#[derive(Clone, Copy)]
pub(super) struct Fill {
    pub color: Srgb,
    /// 0..=1.
    pub opacity: f32,
}

impl Fill {
    pub fn opaque(color: Srgb) -> Self {
        Self { color, opacity: 1.0 }
    }
}

/// Width and height, pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Size {
    pub width: f32,
    pub height: f32,
}

/// A line of a card.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// Whole pixels.
    pub height: f32,
    /// What it needs, pixels.
    pub width: f32,
    pub content: Content,
}

/// What is on a line.
#[derive(Clone, Debug, PartialEq)]
pub enum Content {
    /// Space.
    Gap,
    /// Texts one after the other.
    Texts(Vec<(String, TextStyle, Srgb)>),
    /// A colour - a square, or the ring of a lens - and a text.
    Swatch { color: Srgb, is_ring: bool, text: String, style: TextStyle, ink: Srgb },
    /// A bar of colours from column to column, and the texts below it with the columns they belong to.
    Bar { colors: Vec<Srgb>, ticks: Vec<(f32, String)>, style: TextStyle },
    /// Columns of these heights, shares of the line's, side by side over this width, pixels.
    Columns { heights: Vec<f32>, width: f32 },
}

/// Makes pieces of cards.
pub struct Painter {
    /// Pixels.
    pub em: f32,
    pub setter: Typesetter,
    pub pieces: Vec<Piece>,
}

impl Painter {
    pub fn new(em: f32) -> Self {
        Self { em, setter: Typesetter::default(), pieces: Vec::new() }
    }

    /// Ems as whole pixels, at least one.
    pub fn px(&self, ems: f32) -> f32 {
        (ems * self.em).round().max(1.0)
    }

    /// The thinnest line, pixels.
    pub fn hairline(&self) -> f32 {
        self.px(1.0 / 13.0)
    }

    /// Side of a swatch, pixels.
    pub fn swatch(&self) -> f32 {
        self.px(0.92)
    }

    /// From the card's border to its lines, pixels: beside and above.
    pub fn padding(&self) -> [f32; 2] {
        [self.px(0.85), self.px(0.65)]
    }

    /// Room for lines on a card that may take `room`.
    pub fn inside(&self, room: Size) -> Size {
        let [x, y] = self.padding();
        Size { width: room.width - 2.0 * x, height: room.height - 2.0 * y }
    }

    /// Lines of running text that fit a card in `room`: at most `most`.
    pub fn paragraph(&mut self, text: &str, style: TextStyle, room: Size, most: usize) -> Vec<Line> {
        let height = (1.4 * style.size_px).round();
        let inside = self.inside(room);
        let most = ((inside.height / height).max(0.0) as usize).min(most);
        let lines = self.setter.wrapped(text, style, inside.width, most);
        lines
            .into_iter()
            .map(|text| {
                let width = self.setter.width(&text, style);
                Line { height, width, content: Content::Texts(vec![(text, style, INK)]) }
            })
            .collect()
    }

    /// Width and height of the card of some lines, whole pixels; `None`: it would be empty, or larger than `room`.
    pub fn card_size(&self, lines: &[Line], room: Size) -> Option<[f32; 2]> {
        let inside = self.inside(room);
        let is_empty = lines.iter().all(|line| line.width <= 0.0);
        if is_empty || lines.iter().any(|l| l.width > inside.width) || height_of(lines) > inside.height {
            return None;
        }
        let [pad_x, pad_y] = self.padding();
        let width = lines.iter().map(|l| l.width).fold(0.0, f32::max).ceil() + 2.0 * pad_x;
        Some([width, height_of(lines) + 2.0 * pad_y])
    }

    /// An empty card.
    pub fn card(&mut self, Area { low, high }: Area) {
        let radius = self.px(0.5);
        let drop = self.px(0.12);
        self.panel([low[0], low[1] + drop], [high[0], high[1] + drop], SHADOW, radius, 1.1 * self.em);
        self.panel(low, high, CARD, radius, 1.0);
    }

    /// A card with these lines, which has the size that they have.
    pub fn lines(&mut self, lines: &[Line], area: Area) {
        self.card(area);
        let [pad_x, pad_y] = self.padding();
        let mut y = area.low[1] + pad_y;
        for line in lines {
            self.line(line, [area.low[0] + pad_x, y]);
            y += line.height;
        }
    }

    /// Puts one line there.
    pub fn line(&mut self, line: &Line, [x, y]: [f32; 2]) {
        match &line.content {
            Content::Gap => {}
            Content::Texts(texts) => {
                let mut x = x;
                let tallest = texts.iter().map(|(_, style, _)| style.size_px).fold(0.0, f32::max);
                for (text, style, ink) in texts {
                    self.text(text, [x, base(y, line.height, tallest)], *style, *ink);
                    x += self.setter.width(text, *style);
                }
            }
            Content::Swatch { color, is_ring, text, style, ink } => {
                let side = self.swatch();
                let top = y + ((line.height - side) / 2.0).round();
                let (low, high) = ([x, top], [x + side, top + side]);
                if *is_ring {
                    // As its outline stands in the picture.
                    let line = self.px(0.14).max(2.0);
                    self.panel(low, high, Fill::opaque(*color), side / 2.0, 1.0);
                    let inside = Fill::opaque(CARD.color);
                    self.panel(low.map(|v| v + line), high.map(|v| v - line), inside, side / 2.0 - line, 1.0);
                } else {
                    self.rimmed(low, high, self.px(0.18), *color);
                }
                let start = x + side + self.px(0.5);
                self.text(text, [start, base(y, line.height, style.size_px)], *style, *ink);
            }
            Content::Bar { colors, ticks, style } => self.bar(colors, ticks, *style, [x, y]),
            Content::Columns { heights, width } => self.columns(heights, *width, [x, y], line.height),
        }
    }

    fn bar(&mut self, colors: &[Srgb], ticks: &[(f32, String)], style: TextStyle, [x, y]: [f32; 2]) {
        let (top, bottom) = (y, y + self.bar_height());
        let rim = self.hairline();
        self.panel([x - rim, top - rim], [x + colors.len() as f32 + rim, bottom + rim], RIM, 0.0, 1.0);
        // Equal columns are one panel.
        let mut start = 0;
        for run in colors.chunk_by(|a, b| bytes(*a) == bytes(*b)) {
            let end = start + run.len();
            self.panel([x + start as f32, top], [x + end as f32, bottom], Fill::opaque(run[0]), 0.0, 1.0);
            start = end;
        }
        for (column, text) in ticks {
            let at = x + column.floor();
            let mark = (at - (rim / 2.0).floor()).clamp(x, x + colors.len() as f32 - rim);
            self.panel(
                [mark, bottom + rim],
                [mark + rim, bottom + rim + self.px(0.25)],
                Fill::opaque(QUIET_INK),
                0.0,
                1.0,
            );
            let width = self.setter.width(text, style);
            let left = (at + rim / 2.0 - width / 2.0).clamp(x, (x + colors.len() as f32 - width).max(x));
            self.text(text, [left, bottom + self.px(1.15)], style, QUIET_INK);
        }
    }

    /// The least that is not nothing is a pixel high.
    fn columns(&mut self, heights: &[f32], width: f32, [x, y]: [f32; 2], height: f32) {
        let base = y + height - self.hairline();
        let edge = |i: usize| x + (i as f32 / heights.len() as f32 * width).round();
        for (i, share) in heights.iter().enumerate().filter(|(_, share)| **share > 0.0) {
            let top = (base - share * (height - self.hairline())).round().min(base - 1.0);
            let right = (edge(i + 1) - 1.0).max(edge(i) + 1.0);
            self.panel([edge(i), top], [right, base], Fill::opaque(COLUMN), 0.0, 1.0);
        }
    }

    /// Height of a bar of colours, pixels.
    pub fn bar_height(&self) -> f32 {
        self.px(0.85)
    }

    fn rimmed(&mut self, low: [f32; 2], high: [f32; 2], radius: f32, color: Srgb) {
        let rim = self.hairline();
        self.panel(low.map(|v| v - rim), high.map(|v| v + rim), RIM, radius + rim, 1.0);
        self.panel(low, high, Fill::opaque(color), radius, 1.0);
    }

    /// A rectangle.
    pub(super) fn panel(&mut self, low: [f32; 2], high: [f32; 2], fill: Fill, radius_px: f32, softness_px: f32) {
        let Fill { color, opacity } = fill;
        self.pieces.push(Piece::Panel(Panel { low, high, color, opacity, radius_px, softness_px, ellipse: false }));
    }

    fn text(&mut self, text: &str, at: [f32; 2], style: TextStyle, color: Srgb) {
        self.text_on(text, at, style, color, None);
    }

    /// A line of text, with a halo where it stands on no card.
    pub(super) fn text_on(&mut self, text: &str, at: [f32; 2], style: TextStyle, color: Srgb, halo: Option<Halo>) {
        if !text.is_empty() {
            self.pieces.push(Piece::Text(TextLine { text: text.to_owned(), at, style, color, halo }));
        }
    }
}

/// The base line that sets capitals in the middle of a line.
fn base(y: f32, height: f32, size_px: f32) -> f32 {
    y + ((height + CAP_HEIGHT * size_px) / 2.0).round()
}

/// A colour as the picture holds it.
fn bytes(color: Srgb) -> [u8; 3] {
    color.map(|c| (c.clamp(0.0, 1.0) * 255.0).round() as u8)
}
