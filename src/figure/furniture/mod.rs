//! Title, caption and legends of a figure: where everything stands, in pixels, as [`Furniture`].
//!
//! ```text
//! +------------------------------------------+
//! | [title]                                  |
//! |                                          |
//! |                            [   legend   ]|
//! | [caption caption]          [            ]|
//! +------------------------------------------+
//! ```
//!
//! All of it stands on quiet cards, which are readable over dark and light cities and on paper. Sizes follow the em,
//! the em follows the picture; what has no room is shortened, counted, and at last left out with a warning.

pub(in crate::figure) mod card;
pub(in crate::figure) mod section;

use crate::{
    figure::legend::Legend,
    overlay::Rect,
    render::{
        furniture::{Furniture, Piece},
        text::{TextStyle, Weight, cleaned},
    },
    scene::{Corner, Figure},
};

use card::{Line, Painter, Place, Size};

/// The em of a picture 1280 × 720, pixels.
const EM_PX: f32 = 13.0;
/// No text is smaller unless the scene says so, pixels.
const LEAST_EM_PX: f32 = 10.0;
/// Share of the width that legends may take.
const LEGEND_WIDTH: f32 = 1.0 / 3.0;
/// Share of the height that they may take.
const LEGEND_HEIGHT: f32 = 0.8;

/// The em of a picture's text, pixels.
pub fn em_px(figure: &Figure, size: [u32; 2]) -> f32 {
    let [w, h] = size.map(|side| side as f32);
    let by_size = (EM_PX * (w / 1280.0).min(h / 720.0)).max(LEAST_EM_PX);
    figure.text_px().map_or(by_size, |px| px as f32)
}

/// Lays out a figure's title, caption and legends over a picture of `size` pixels.
pub fn lay_out(figure: &Figure, legends: &[Legend], size: [u32; 2]) -> Furniture {
    let mut painter = Painter::new(em_px(figure, size));
    let margin = painter.px(1.2);
    let [w, h] = size.map(|side| side as f32);
    let corner = figure.legend.corner().filter(|_| !legends.is_empty());
    // What the legend takes of the title's line or of the caption's.
    let beside = |is_top: bool| match corner {
        Some(corner) if corner.is_top() == is_top && !corner.is_left() => (w * LEGEND_WIDTH).floor() + margin,
        _ => 0.0,
    };
    let mut taken = [0.0, 0.0];
    if let Some(title) = figure.title.as_ref().filter(|text| !cleaned(text).is_empty()) {
        let room = Size { width: w - 2.0 * margin - beside(true), height: 0.25 * h };
        let style = TextStyle { size_px: 1.4 * painter.em, weight: Weight::SemiBold, tabular: false };
        let lines = painter.paragraph(title, style, room, 2);
        let place = Place { corner: Corner::TopLeft, margin: [margin, margin] };
        taken[0] = painter.card_or_warn("title", &lines, room, place, size);
    }
    if let Some(caption) = figure.caption.as_ref().filter(|text| !text.trim().is_empty()) {
        let width = (w - 2.0 * margin - beside(false)).min(0.6 * w).min(60.0 * painter.em);
        let room = Size { width, height: h / 3.0 };
        let style = TextStyle { size_px: painter.em, weight: Weight::Regular, tabular: false };
        let lines = painter.paragraph(caption, style, room, 6);
        let place = Place { corner: Corner::BottomLeft, margin: [margin, margin] };
        taken[1] = painter.card_or_warn("caption", &lines, room, place, size);
    }
    if let Some(corner) = corner {
        let side = taken[usize::from(!corner.is_top())];
        let used = if corner.is_left() && side > 0.0 { side + painter.px(0.6) } else { 0.0 };
        let room = Size {
            width: (w * LEGEND_WIDTH).floor().min(w - 2.0 * margin).min(24.0 * painter.em),
            height: (LEGEND_HEIGHT * h).min(h - 2.0 * margin - taken[0] - taken[1]),
        };
        let lines = section::fitted(&mut painter, legends, room);
        let place = Place { corner, margin: [margin, margin + used] };
        painter.card_or_warn("legend", &lines, room, place, size);
    }
    Furniture { pieces: painter.pieces }
}

/// Where the cards of furniture stand, with their shadows but not what is on them; pixels, rounded outwards.
pub fn cards(furniture: &Furniture) -> Vec<Rect> {
    let mut cards: Vec<Rect> = Vec::new();
    for piece in &furniture.pieces {
        let Piece::Panel(panel) = piece else { continue };
        let rect = Rect { min: panel.low.map(|v| v.floor() as i32), max: panel.high.map(|v| v.ceil() as i32) };
        if !cards.iter().any(|card| card.holds(&rect)) {
            cards.push(rect);
        }
    }
    cards
}

/// Height of lines one below the other, pixels.
pub(in crate::figure) fn height_of(lines: &[Line]) -> f32 {
    lines.iter().map(|line| line.height).sum()
}

#[cfg(test)]
mod tests;
