//! Title, caption, legends and the signs of a map of a figure: where everything stands, in pixels, as [`Furniture`].
//!
//! ```text
//! +------------------------------------------+
//! | [title]                     [north arrow]|
//! |                                          |
//! |                                          |
//! |                            [   legend   ]|
//! | [caption caption]          [            ]|
//! +------------------------------------------+
//! ```
//!
//! All of it stands on quiet cards, which are readable over dark and light cities and on paper. Sizes follow the em,
//! the em follows the picture. No card stands on another, nor on an overlay with a place of its own: it makes way ([`desk`]). What has
//! no room is shortened, counted, and at last left out with a warning.

pub(in crate::figure) mod card;
mod desk;
pub(in crate::figure) mod section;
mod signs;

use crate::{
    figure::{legend::Legend, moments::MomentLabel},
    overlay::Rect,
    render::{
        furniture::{Furniture, Piece},
        text::{TextStyle, Weight, cleaned},
    },
    scene::{Anchor, Figure, PiecePlace},
    view::View,
};

use card::{Content, Line, Painter, Size};
use desk::{Area, Desk};

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

/// Furniture, and what of the picture it takes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Laid {
    /// The pieces.
    pub furniture: Furniture,
    /// What overlays leave free: cards with their shadows, and what stands without one; pixels, rounded outwards.
    pub taken: Vec<Rect>,
    /// Names of pieces that have no room; a warning has told of each.
    pub left_out: Vec<&'static str>,
}

/// What a figure says beside what its `[figure]` has.
#[derive(Clone, Copy, Debug, Default)]
pub struct Contents<'a> {
    /// Its legends.
    pub legends: &'a [Legend],
    /// Labels of time lenses.
    pub moments: &'a [MomentLabel],
}

/// Lays out what a figure asks for over the picture of a view. It leaves `standing` free, pixels: overlays with places of their own.
pub fn lay_out(figure: &Figure, contents: &Contents, view: &View, standing: &[Rect]) -> Laid {
    let legends = contents.legends;
    let painter = Painter::new(em_px(figure, view.size));
    let (margin, gap) = (painter.px(1.2), painter.px(0.6));
    let size = view.size.map(|side| side as f32);
    let desk = Desk::new(size, margin, gap, standing.iter().map(Area::from).collect());
    let mut layout = Layout { figure, size, margin, painter, desk, bare: Vec::new(), left_out: Vec::new() };
    let title = layout.title();
    let caption = layout.caption();
    layout.legend(legends, title + caption);
    layout.scale_bar(view);
    layout.north_arrow(view);
    contents.moments.iter().for_each(|label| layout.moment(label));
    let furniture = Furniture { pieces: layout.painter.pieces };
    let taken = cards(&furniture).into_iter().chain(layout.bare.iter().map(Area::rect)).collect();
    Laid { furniture, taken, left_out: layout.left_out }
}

/// A layout under way.
struct Layout<'a> {
    figure: &'a Figure,
    /// Of the picture, pixels.
    size: [f32; 2],
    margin: f32,
    painter: Painter,
    desk: Desk,
    /// What stands without a card.
    bare: Vec<Area>,
    left_out: Vec<&'static str>,
}

impl Layout<'_> {
    /// The title; its height.
    fn title(&mut self) -> f32 {
        let Some(title) = self.figure.title.as_ref().filter(|text| !cleaned(text).is_empty()) else { return 0.0 };
        let [w, h] = self.size;
        let width = w - 2.0 * self.margin - self.beside(self.figure.title_at, Anchor::TopLeft);
        let style = TextStyle { size_px: 1.4 * self.painter.em, weight: Weight::SemiBold, tabular: false };
        let rooms = [1.0, 0.6].map(|share| Size { width: share * width, height: 0.25 * h });
        let place = self.figure.title_at;
        self.put("title", place, Anchor::TopLeft, &rooms, |painter, room| painter.paragraph(title, style, room, 2))
    }

    /// The caption; its height.
    fn caption(&mut self) -> f32 {
        let Some(caption) = self.figure.caption.as_ref().filter(|text| !text.trim().is_empty()) else { return 0.0 };
        let [w, h] = self.size;
        let beside = self.beside(self.figure.caption_at, Anchor::BottomLeft);
        let width = (w - 2.0 * self.margin - beside).min(0.6 * w).min(60.0 * self.painter.em);
        let style = TextStyle { size_px: self.painter.em, weight: Weight::Regular, tabular: false };
        let rooms = [1.0, 0.7, 0.5].map(|share| Size { width: share * width, height: h / 3.0 });
        let place = self.figure.caption_at;
        self.put("caption", place, Anchor::BottomLeft, &rooms, |painter, room| {
            painter.paragraph(caption, style, room, 6)
        })
    }

    /// The label of a time lens, as near as there is room to where it should be.
    fn moment(&mut self, label: &MomentLabel) {
        let [w, h] = self.size;
        let style = TextStyle { size_px: self.painter.em, weight: Weight::SemiBold, tabular: true };
        let room = Size { width: w - 2.0 * self.margin, height: h - 2.0 * self.margin };
        let mut lines = self.painter.paragraph(&label.text, style, room, 1);
        for line in &mut lines {
            let Content::Texts(texts) = &line.content else { continue };
            let text = texts.iter().map(|(text, ..)| text.as_str()).collect();
            line.width += self.painter.swatch() + self.painter.px(0.6);
            line.content = Content::Swatch { color: label.color, is_ring: true, text, style, ink: card::INK };
        }
        let Some(size) = self.painter.card_size(&lines, room) else { return };
        let wanted = [label.at.x as f32 - size[0] / 2.0, label.at.y as f32 - size[1] / 2.0].map(f32::round);
        let wanted =
            [0, 1].map(|i| wanted[i].clamp(self.margin, (self.size[i] - self.margin - size[i]).max(self.margin)));
        let Some(low) = self.desk.nearest(wanted, size) else { return };
        let area = Area::new(low, size);
        self.painter.lines(&lines, area);
        self.desk.take(area);
    }

    /// The legends, where title and caption are so high together.
    fn legend(&mut self, legends: &[Legend], taken: f32) {
        if !self.figure.legend.is_some() || legends.is_empty() {
            return;
        }
        let [w, h] = self.size;
        let width = (w * LEGEND_WIDTH).floor().min(w - 2.0 * self.margin).min(24.0 * self.painter.em);
        let height = (LEGEND_HEIGHT * h).min(h - 2.0 * self.margin - taken);
        // What makes way for others has less room.
        let rooms = [1.0, 0.8, 0.6, 0.45, 0.3].map(|share| Size { width, height: share * height });
        let place = self.figure.legend;
        self.put("legend", place, Anchor::BottomRight, &rooms, |painter, room| section::fitted(painter, legends, room));
    }

    /// What a legend in the other corner takes of the line that a text stands on.
    fn beside(&self, text: PiecePlace, auto: Anchor) -> f32 {
        let share = |place: PiecePlace, auto: Anchor| match place {
            PiecePlace::Auto => Some(auto.share()),
            PiecePlace::Anchor(anchor) => Some(anchor.share()),
            PiecePlace::None | PiecePlace::At(_) => None,
        };
        match (share(text, auto), share(self.figure.legend, Anchor::BottomRight)) {
            (Some([x, y]), Some([legend_x, legend_y])) if y == legend_y && x != legend_x => {
                (self.size[0] * LEGEND_WIDTH).floor() + self.margin
            }
            _ => 0.0,
        }
    }

    /// Puts a card of lines where it is wanted, in the first of some rooms that it has; or says that it is left out. Its height.
    fn put(
        &mut self,
        what: &'static str,
        place: PiecePlace,
        auto: Anchor,
        rooms: &[Size],
        mut lines_in: impl FnMut(&mut Painter, Size) -> Vec<Line>,
    ) -> f32 {
        for room in rooms {
            let lines = lines_in(&mut self.painter, *room);
            let Some(size) = self.painter.card_size(&lines, *room) else { continue };
            let Some(low) = self.place(place, &[auto], size) else { continue };
            let area = Area::new(low, size);
            self.painter.lines(&lines, area);
            self.desk.take(area);
            return size[1];
        }
        self.left_out(what);
        0.0
    }

    /// Where a piece of this size stands.
    fn place(&self, place: PiecePlace, auto: &[Anchor], size: [f32; 2]) -> Option<[f32; 2]> {
        match place {
            PiecePlace::None => None,
            PiecePlace::Auto => self.desk.at_first(auto, size),
            PiecePlace::Anchor(anchor) => self.desk.at_first(&[anchor], size),
            PiecePlace::At(at) => self.desk.nearest(self.desk.at_share(at, size), size),
        }
    }

    fn left_out(&mut self, what: &'static str) {
        self.left_out.push(what);
        let [w, h] = self.size;
        log::warn!(
            "there is no room for the {what} in {w}x{h} pixels, and it is left out; a larger picture, smaller letters (figure.text_px, \
             text_pt), a shorter text or fewer pieces would be right"
        );
    }
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
