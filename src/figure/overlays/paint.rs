//! The pieces of overlays, context lines, arrows and markers.

use std::path::Path;

use glam::{DVec2, Vec2};

use crate::{
    figure::overlays::{Room, places::Place, views::Local},
    lens::{
        best_view::{LocalView, MapMode},
        color::Srgb,
    },
    overlay::{Focus, Rect},
    render::{
        furniture::{ImagePiece, Panel, Piece, Strip},
        text::{CAP_HEIGHT, Halo, TextLine, TextStyle, Typesetter, Weight},
    },
    scene::{
        Overlay,
        overlay::{BuiltInFrame, ContextLine, Frame},
    },
    view::{Camera, local},
};

const WHITE: Srgb = [1.0; 3];
const INK: Srgb = [0.1, 0.115, 0.14];
const NEEDLE: Srgb = [0.84, 0.15, 0.16];

/// The size of captions.
const CAPTION_EMS: f32 = 0.92;

/// What an image of an overlay is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// What it shows.
    Picture,
    /// Its alpha mask.
    Alpha,
    /// Its frame mask.
    Frame,
    /// The skin of its lines.
    Skin,
    /// All of it, where it stands in the scene.
    Board,
}

/// The number of an image of the overlay of a lens, in a view whose numbers begin after `numbers`.
pub fn number(numbers: u64, lens: usize, part: Part) -> u64 {
    numbers + 1 + 5 * lens as u64 + part as u64
}

/// Alpha mask and frame mask of a frame that is made of images.
pub fn masks(frame: &Frame) -> [Option<&Path>; 2] {
    match frame {
        Frame::BuiltIn(_) => [None, None],
        Frame::Images { alpha, frame } => [alpha.as_deref(), frame.as_deref()],
    }
}

/// So many thirteenths of the em, whole pixels, at least one.
fn px(em: f32, n: f32) -> i32 {
    (n * em / 13.0).round().max(1.0) as i32
}

/// Where in an overlay that stands here its picture is.
pub fn picture_room(overlay: &Overlay, rect: Rect, em: f32) -> Room {
    let px = |n| px(em, n);
    let frame = match &overlay.frame {
        Frame::BuiltIn(frame) => *frame,
        Frame::Images { .. } => BuiltInFrame::None,
    };
    let (around, below) = match frame {
        BuiltInFrame::None | BuiltInFrame::Vignette => (0, 0),
        BuiltInFrame::Thin => (px(1.0), px(1.0)),
        BuiltInFrame::Rounded | BuiltInFrame::Ellipse => (px(4.0), px(4.0)),
        BuiltInFrame::Print => (px(8.0), px(22.0)),
    };
    let below = if overlay.caption.is_some() { below.max(px(22.0)) } else { below };
    let size: [i32; 2] = std::array::from_fn(|i| rect.max[i] - rect.min[i]);
    // A frame never takes all of a small overlay.
    let fits = |wanted: i32, side: i32| wanted.min((side - 1).max(0) / 3);
    let (x, top, bottom) = (fits(around, size[0]), fits(around, size[1]), fits(below, size[1]));
    Room { low: [rect.min[0] + x, rect.min[1] + top], high: [rect.max[0] - x, rect.max[1] - bottom] }
}

/// What an overlay shows.
#[derive(Clone, Copy, Debug)]
pub struct Content {
    /// The number of its image.
    pub image: u64,
    /// Whether left and right are exchanged.
    pub mirror: bool,
    /// How much a fisheye magnifies its middle.
    pub magnification: f32,
    /// The numbers of its alpha mask and its frame mask.
    pub masks: [Option<u64>; 2],
}

fn is_ellipse(overlay: &Overlay) -> bool {
    matches!(overlay.frame, Frame::BuiltIn(BuiltInFrame::Ellipse))
}

/// How text is set in an overlay, pixels.
struct Card {
    em: f32,
    pad: f32,
    line: f32,
}

impl Card {
    fn new(em: f32) -> Self {
        Self { em, pad: 0.8 * em, line: (1.4 * em).round() }
    }

    /// At most so many lines, each no wider than `width` where it has a place to break. The first of several paragraphs is a heading.
    fn lines(&self, setter: &mut Typesetter, text: &str, width: f32, most: usize) -> Vec<(String, TextStyle)> {
        let mut lines = Vec::new();
        for (i, paragraph) in text.split('\n').enumerate() {
            let weight = if i == 0 && text.contains('\n') { Weight::SemiBold } else { Weight::Regular };
            let style = TextStyle { size_px: self.em, weight, tabular: false };
            let left = most.saturating_sub(lines.len());
            lines.extend(setter.wrapped(paragraph, style, width, left).into_iter().map(|line| (line, style)));
        }
        lines
    }
}

/// The width of a caption with its margins, pixels.
pub fn caption_width(caption: &str, em: f32) -> f32 {
    let style = TextStyle { size_px: CAPTION_EMS * em, weight: Weight::Regular, tabular: false };
    Typesetter::default().width(caption, style) + 2.0 * em
}

/// The height of an overlay of this width that holds all of a text, whole pixels.
pub fn text_height(text: &str, width: u32, em: f32) -> u32 {
    let card = Card::new(em);
    let lines = card.lines(&mut Typesetter::default(), text, width as f32 - 2.0 * card.pad, MOST_LINES);
    (2.0 * card.pad + card.line * lines.len() as f32).ceil() as u32
}

/// The part of the way from the middle of a map to its border where the sign of the eye is at most.
const AT_BORDER: f64 = 0.9;
/// A caption for which there is no room becomes so much smaller at most, as a part of its size.
const LEAST_CAPTION: f32 = 0.6;
/// Lines of text that are counted; no overlay shows more.
const MOST_LINES: usize = 1000;

/// Makes pieces; lengths go by the em of the picture's text.
pub struct Painter {
    em: f32,
    setter: Typesetter,
    pieces: Vec<Piece>,
}

impl Painter {
    pub fn new(em: f32) -> Self {
        Self { em, setter: Typesetter::default(), pieces: Vec::new() }
    }

    /// Adds pieces that are made.
    pub fn put(&mut self, pieces: &[Piece]) {
        self.pieces.extend_from_slice(pieces);
    }

    pub fn into_pieces(self) -> Vec<Piece> {
        self.pieces
    }

    fn px(&self, n: f32) -> i32 {
        px(self.em, n)
    }

    fn caption_style(&self) -> TextStyle {
        TextStyle { size_px: CAPTION_EMS * self.em, weight: Weight::Regular, tabular: false }
    }

    fn panel(&mut self, low: [f32; 2], high: [f32; 2], color: Srgb, opacity: f32, radius_px: f32, softness_px: f32) {
        self.pieces.push(Piece::Panel(Panel { low, high, color, opacity, radius_px, softness_px, ellipse: false }));
    }

    fn ground(&mut self, overlay: &Overlay, rect: Rect, radius: f32) {
        let opacity = overlay.opacity as f32;
        let (low, high) = (rect.min.map(|v| v as f32), rect.max.map(|v| v as f32));
        let drop = self.px(2.0) as f32;
        let shadow = |v: [f32; 2]| [v[0], v[1] + drop];
        self.panel(shadow(low), shadow(high), [0.05, 0.07, 0.1], 0.3 * opacity, radius, self.em);
        self.panel(low, high, WHITE, opacity, radius, 1.0);
    }

    /// The picture of an overlay in its frame.
    pub fn overlay(&mut self, overlay: &Overlay, rect: Rect, content: Content) {
        let Content { image, mirror, magnification, masks: [alpha, frame] } = content;
        let room = picture_room(overlay, rect, self.em);
        let (low, high) = (room.low.map(|v| v as f32), room.high.map(|v| v as f32));
        let side = room.size()[0].min(room.size()[1]) as f32;
        let opacity = overlay.opacity as f32;
        let mut piece = ImagePiece {
            image,
            mask: alpha,
            low,
            high,
            mirror,
            opacity,
            ellipse: false,
            radius_px: 0.0,
            softness_px: 1.0,
            magnification,
        };
        match &overlay.frame {
            Frame::BuiltIn(BuiltInFrame::None) | Frame::Images { .. } => {}
            Frame::BuiltIn(BuiltInFrame::Rounded) => {
                self.ground(overlay, rect, self.px(7.0) as f32);
                piece.radius_px = self.px(4.0) as f32;
            }
            Frame::BuiltIn(BuiltInFrame::Thin) => {
                let (low, high) = (rect.min.map(|v| v as f32), rect.max.map(|v| v as f32));
                self.panel(low, high, INK, opacity, 0.0, 1.0);
                if overlay.caption.is_some() {
                    let line = self.px(1.0) as f32;
                    let (band_low, band_high) = ([low[0] + line, room.high[1] as f32 + line], high.map(|v| v - line));
                    self.panel(band_low, band_high, WHITE, opacity, 0.0, 1.0);
                }
            }
            Frame::BuiltIn(BuiltInFrame::Print) => self.ground(overlay, rect, self.px(1.0) as f32),
            Frame::BuiltIn(BuiltInFrame::Ellipse) => {
                let around = self.px(4.0) as f32;
                let (outer_low, outer_high) = (low.map(|v| v - around), high.map(|v| v + around));
                let drop = self.px(2.0) as f32;
                for (color, opacity, down, softness_px) in
                    [([0.05, 0.07, 0.1], 0.3 * opacity, drop, self.em), (WHITE, opacity, 0.0, 1.0)]
                {
                    self.pieces.push(Piece::Panel(Panel {
                        low: [outer_low[0], outer_low[1] + down],
                        high: [outer_high[0], outer_high[1] + down],
                        color,
                        opacity,
                        radius_px: 0.0,
                        softness_px,
                        ellipse: true,
                    }));
                }
                piece.ellipse = true;
            }
            Frame::BuiltIn(BuiltInFrame::Vignette) => {
                (piece.radius_px, piece.softness_px) = (0.5 * side, (0.3 * side).max(1.0));
            }
        }
        self.pieces.push(Piece::Image(piece));
        if let Some(frame) = frame {
            let over = ImagePiece { image: frame, mask: None, mirror: false, magnification: 1.0, ..piece };
            self.pieces.push(Piece::Image(over));
        }
        if let Some(caption) = &overlay.caption {
            let band = [high[1], rect.max[1] as f32];
            // Where there is no card below it, it is read over the city.
            let has_card = matches!(
                overlay.frame,
                Frame::BuiltIn(BuiltInFrame::Rounded | BuiltInFrame::Thin | BuiltInFrame::Print)
            );
            let halo = (!has_card).then_some(Halo { color: WHITE, width_px: 0.2 * self.em, opacity: 0.85 });
            self.centred(caption, [rect.min[0] as f32, rect.max[0] as f32], band, self.caption_style(), halo);
        }
    }

    fn centred(
        &mut self,
        text: &str,
        [left, right]: [f32; 2],
        [top, bottom]: [f32; 2],
        style: TextStyle,
        halo: Option<Halo>,
    ) {
        let room = (right - left - self.em).max(0.0);
        // Smaller before it is cut.
        let smaller = (room / self.setter.width(text, style).max(1.0)).min(1.0);
        let style =
            if smaller >= LEAST_CAPTION { TextStyle { size_px: smaller * style.size_px, ..style } } else { style };
        let Some(text) = self.setter.wrapped(text, style, room, 1).into_iter().next() else { return };
        let width = self.setter.width(&text, style);
        let base = (0.5 * (top + bottom + CAP_HEIGHT * style.size_px)).round();
        let at = [0.5 * (left + right - width), base];
        self.pieces.push(Piece::Text(TextLine { text, at, style, color: INK, halo }));
    }

    /// An overlay of text.
    pub fn text(&mut self, overlay: &Overlay, rect: Rect, text: &str) {
        self.ground(overlay, rect, self.px(7.0) as f32);
        let card = Card::new(self.em);
        let [width, tall] = [0, 1].map(|i| (rect.max[i] - rect.min[i]) as f32 - 2.0 * card.pad);
        let most = (tall / card.line).floor().max(0.0) as usize;
        for (i, (text, style)) in card.lines(&mut self.setter, text, width, most).into_iter().enumerate() {
            let y = rect.min[1] as f32 + card.pad + card.line * i as f32;
            let base = (y + 0.5 * (card.line + CAP_HEIGHT * style.size_px)).round();
            let at = [rect.min[0] as f32 + card.pad, base];
            self.pieces.push(Piece::Text(TextLine { text, at, style, color: INK, halo: None }));
        }
    }

    fn strip(&mut self, points: &[DVec2], widths: [f64; 2], color: Srgb, opacity: f32) -> Strip {
        let points = points.iter().map(|p| p.as_vec2().to_array()).collect();
        Strip { points, widths: widths.map(|w| w as f32), color, opacity, skin: None, fade: None }
    }

    /// A context line, or its first part as an arrow.
    pub fn line(
        &mut self,
        points: &[DVec2],
        style: &ContextLine,
        lens_color: Srgb,
        skin: Option<u64>,
        is_far: bool,
        size: [u32; 2],
    ) {
        let (color, widths) = (style.color.unwrap_or(lens_color), style.widths_in(size));
        if is_far {
            if let [from, to, ..] = points
                && let Some(direction) = (*to - *from).try_normalize()
            {
                let length = f64::from(self.px(26.0));
                self.arrow(*from + length * direction, direction, color);
            }
            return;
        }
        let centre = [0.5 * size[0] as f32, 0.5 * size[1] as f32];
        let fade = style.fade.map(|radii| (centre, radii.map(|r| r as f32)));
        if skin.is_none() {
            // Seen on dark and on light ground.
            let rim = f64::from(self.px(2.0));
            let casing = self.strip(points, widths.map(|w| w + rim), WHITE, 0.75);
            self.pieces.push(Piece::Strip(Strip { fade, ..casing }));
        }
        let color = if skin.is_some() { style.color.unwrap_or(WHITE) } else { color };
        let strip = self.strip(points, widths, color, 1.0);
        self.pieces.push(Piece::Strip(Strip { skin, fade, ..strip }));
    }

    /// What a line ends at: a dot, or the outline of an object.
    pub fn focus(&mut self, place: &Place, style: &ContextLine, lens_color: Srgb) {
        let color = style.color.unwrap_or(lens_color);
        if let Some(Focus::Point(at)) = place.focus {
            for (radius, color) in [(self.px(5.0), WHITE), (self.px(3.5), color)] {
                let (at, radius) = (at.as_vec2(), radius as f32);
                let (low, high) = (at - radius, at + radius);
                self.panel(low.into(), high.into(), color, 1.0, radius, 1.0);
            }
        }
        let closed = |ring: &Vec<DVec2>| -> Vec<DVec2> { ring.iter().chain(ring.first()).copied().collect() };
        let rings: Vec<Vec<DVec2>> = place.outline.iter().map(closed).collect();
        // All rims first: none lies over the colour of another ring.
        for (width, color, opacity) in [(self.px(4.0), WHITE, 0.75), (self.px(2.0), color, 1.0)] {
            for ring in &rings {
                let strip = self.strip(ring, [f64::from(width); 2], color, opacity);
                self.pieces.push(Piece::Strip(strip));
            }
        }
    }

    /// An arrow head with its tip here.
    pub fn arrow(&mut self, tip: DVec2, direction: DVec2, color: Srgb) {
        let length = f64::from(self.px(15.0));
        let width = f64::from(self.px(14.0));
        let rim = f64::from(self.px(2.0));
        for (grown, color, opacity) in [(rim, WHITE, 0.85), (0.0, color, 1.0)] {
            let points = [tip - (length + grown) * direction, tip + 1.4 * grown * direction];
            let strip = self.strip(&points, [width + 3.0 * grown, 0.0], color, opacity);
            self.pieces.push(Piece::Strip(strip));
        }
    }

    /// A part of the way of something that moves: what it has gone, or what lies before it.
    pub fn trace(&mut self, points: &[DVec2], color: Srgb, is_gone: bool) {
        let (width, rim) = (f64::from(self.px(3.0)), f64::from(self.px(2.0)));
        let (casing, opacity) = if is_gone { (0.8, 1.0) } else { (0.35, 0.45) };
        for (width, color, opacity) in [(width + rim, WHITE, casing), (width, color, opacity)] {
            let strip = self.strip(points, [width; 2], color, opacity);
            self.pieces.push(Piece::Strip(strip));
        }
    }

    /// Something that moves, here and to there; without a direction it stands, or comes or goes along the ray.
    pub fn moving(&mut self, at: DVec2, direction: Option<DVec2>, color: Srgb) {
        let radius = self.px(8.0) as f32;
        let [rim, drop] = [2.0, 1.0].map(|n| self.px(n) as f32);
        let place = at.as_vec2();
        let disc = |painter: &mut Self, middle: Vec2, radius: f32, color: Srgb, opacity: f32, softness: f32| {
            painter.panel((middle - radius).into(), (middle + radius).into(), color, opacity, radius, softness);
        };
        disc(self, place + Vec2::new(0.0, drop), radius + 2.0 * rim, [0.05, 0.07, 0.1], 0.35, 2.0 * rim);
        disc(self, place, radius + rim, WHITE, 1.0, 1.0);
        disc(self, place, radius, color, 1.0, 1.0);
        match direction {
            None => disc(self, place, 0.35 * radius, WHITE, 1.0, 1.0),
            Some(along) => {
                let reach = f64::from(radius);
                let points = [at - 0.45 * reach * along, at + 0.75 * reach * along];
                let strip = self.strip(&points, [1.05 * reach, 0.0], WHITE, 1.0);
                self.pieces.push(Piece::Strip(strip));
            }
        }
    }

    /// Stands for so many overlays.
    pub fn marker(&mut self, at: DVec2, count: usize) {
        let radius = self.px(10.0) as f32;
        let at = at.as_vec2();
        for (radius, color) in [(radius + self.px(1.5) as f32, WHITE), (radius, INK)] {
            self.panel((at - radius).into(), (at + radius).into(), color, 1.0, radius, 1.0);
        }
        let style = TextStyle { size_px: 0.9 * self.em, weight: Weight::SemiBold, tabular: true };
        let text = count.to_string();
        let width = self.setter.width(&text, style);
        let base = at.y + 0.5 * CAP_HEIGHT * style.size_px;
        self.pieces.push(Piece::Text(TextLine {
            text,
            at: [at.x - 0.5 * width, base.round()],
            style,
            color: WHITE,
            halo: None,
        }));
    }

    /// What is drawn into a view beside the city: on maps a compass, or where the main eye is and looks.
    pub fn signs(&mut self, overlay: &Overlay, view: &LocalView, local: &Local, main: &Camera, room: Room) {
        let LocalView::Map { mode, height_m, magnification, .. } = view else { return };
        let heading = local::heading(main);
        let on_page = |v: DVec2| DVec2::new(v.x, -v.y);
        match mode {
            MapMode::NorthUp => {}
            MapMode::UserView => {
                let (low, high) = (room.low.map(f64::from), room.high.map(f64::from));
                let half = 0.5 * (DVec2::from(high) - DVec2::from(low));
                let reach = half * if is_ellipse(overlay) { 1.0 } else { std::f64::consts::SQRT_2 };
                let from_middle = main.eye.truncate() - local.middle.unwrap_or(main.eye.truncate());
                let place = on_page(from_middle) * (2.0 * half.y / height_m);
                let mut place = local::fisheye(place / reach, *magnification) * reach;
                // An eye that is beyond the map is at its border.
                let out =
                    if is_ellipse(overlay) { (place / half).length() } else { (place / half).abs().max_element() };
                if out > AT_BORDER {
                    place *= AT_BORDER / out;
                }
                let at = DVec2::from(low) + half + place;
                let ahead = on_page(heading);
                self.arrow(at + f64::from(self.px(9.0)) * ahead, ahead, NEEDLE);
            }
            MapMode::HeadUp => {
                // North in a map whose top is the heading.
                let north = on_page(DVec2::Y.rotate(DVec2::new(heading.y, heading.x)));
                let radius = f64::from(self.px(15.0));
                let (low, high) = (room.low.map(f64::from), room.high.map(f64::from));
                let half = 0.5 * (DVec2::from(high) - DVec2::from(low));
                // At the upper right of what is seen.
                let corner = half * if is_ellipse(overlay) { std::f64::consts::FRAC_1_SQRT_2 } else { 1.0 };
                let inward = radius + f64::from(self.px(if is_ellipse(overlay) { 0.0 } else { 6.0 }));
                let middle = DVec2::from(low) + half + (corner - inward) * DVec2::new(1.0, -1.0);
                let (at, reach) = (middle.as_vec2(), Vec2::splat(radius as f32));
                self.panel((at - reach).into(), (at + reach).into(), WHITE, 0.9, radius as f32, 1.0);
                let half = 0.62 * radius;
                for (tip, color) in [(north, NEEDLE), (-north, [0.55, 0.57, 0.6])] {
                    let strip = self.strip(&[middle, middle + half * tip], [0.42 * radius, 0.0], color, 1.0);
                    self.pieces.push(Piece::Strip(strip));
                }
                let style = TextStyle { size_px: 0.62 * self.em, weight: Weight::SemiBold, tabular: false };
                let width = self.setter.width("N", style);
                let at = (middle + 0.82 * radius * north).as_vec2();
                let base = at.y + 0.5 * CAP_HEIGHT * style.size_px;
                self.pieces.push(Piece::Text(TextLine {
                    text: "N".into(),
                    at: [at.x - 0.5 * width, base],
                    style,
                    color: INK,
                    halo: None,
                }));
            }
        }
    }
}
