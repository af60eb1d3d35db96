//! The signs of a map: a scale bar, and an arrow to the north.
//!
//! In an orthographic picture a length across it is as long everywhere. In perspective it is true at one distance: the bar lies in the
//! picture where that is, and says so.

use glam::{DVec2, DVec3};

use crate::{
    figure::{
        furniture::{
            Layout,
            card::{Fill, INK, Painter, QUIET_INK},
            desk::Area,
        },
        ticks::number_text,
    },
    lens::color::Srgb,
    render::{
        furniture::{Piece, Polygon, Strip},
        text::{CAP_HEIGHT, Halo, TextStyle, Weight},
    },
    scene::{Anchor, PiecePlace},
    view::View,
};

/// Share of the picture's width that a bar takes, about.
const BAR_SHARE: f64 = 0.2;
/// Where a bar stands of itself: the first of these that is free.
const BAR_PLACES: [Anchor; 6] =
    [Anchor::BottomLeft, Anchor::BottomRight, Anchor::Bottom, Anchor::TopLeft, Anchor::TopRight, Anchor::Top];
/// Where an arrow does.
const ARROW_PLACES: [Anchor; 6] =
    [Anchor::TopRight, Anchor::TopLeft, Anchor::BottomRight, Anchor::BottomLeft, Anchor::Right, Anchor::Left];
/// Thickness of a bar, em.
const BAR_EM: f32 = 0.42;
/// Radius of the ring around an arrow that is seen from above, and side of its card; em.
const RING_EM: f32 = 1.75;
const ARROW_CARD_EM: f32 = 5.6;
/// Sides of the ring.
const RING_SIDES: u32 = 48;
/// The arrow, in radii of its ring: tip, right end, notch, left end; x east, y north.
const ARROW: [[f64; 2]; 4] = [[0.0, 1.0], [0.5, -0.8], [0.0, -0.45], [-0.5, -0.8]];
const WHITE: Srgb = [1.0; 3];
const PALE: Srgb = [0.62, 0.64, 0.67];

/// Round lengths of about so many metres, the nearest first, then shorter ones: 1, 2 and 5 times powers of ten.
fn round_lengths(metres: f64) -> Vec<f64> {
    if !(metres.is_finite() && metres > 0.0) {
        return Vec::new();
    }
    let power = metres.log10().floor() as i32;
    let all = (power - 2..=power + 1).flat_map(|p| [1.0, 2.0, 5.0].map(|m| m * 10_f64.powi(p)));
    let mut all: Vec<f64> = all.filter(|length| length.is_normal()).collect();
    let way = |length: &f64| (length / metres).ln().abs();
    let nearest = all.iter().copied().min_by(|a, b| way(a).total_cmp(&way(b))).unwrap_or(metres);
    all.retain(|length| *length <= nearest);
    all.reverse();
    all.truncate(3);
    all
}

/// A length as a bar says it: metres, from a thousand on kilometres.
fn length_text(metres: f64) -> String {
    let (value, unit) = if metres >= 1000.0 { (metres / 1000.0, "km") } else { (metres, "m") };
    // A thousandth of it tells 0.5 from 1.
    let step = if value >= 1.0 { 1.0 } else { 10_f64.powf(value.log10().floor()) };
    format!("{}\u{a0}{unit}", number_text(value, step))
}

/// Where a bar in perspective lies, pixels, and how far it is along the view axis, metres: on level ground as high as the camera's target.
fn on_ground(view: &View, place: PiecePlace) -> Option<(DVec2, f64)> {
    let share = match place {
        PiecePlace::None => return None,
        PiecePlace::Auto => {
            let pixel = view.pixel(view.camera.target).filter(|pixel| pixel.z > view.camera.near_m)?;
            return Some((pixel.truncate(), pixel.z));
        }
        PiecePlace::Anchor(anchor) => anchor.share().map(|share| 0.15 + 0.7 * f64::from(share)),
        PiecePlace::At(at) => at,
    };
    let pixel = DVec2::from(share) * DVec2::new(view.size[0].into(), view.size[1].into());
    let ray = view.ray(pixel);
    let along = (view.camera.target.z - ray.origin.z) / ray.direction.z;
    let depth = view.depth(ray.at(along));
    (along.is_finite() && depth > view.camera.near_m).then_some((pixel, depth))
}

/// A direction of the ground as the camera sees it at its target: x right, y down; 1 where it is not foreshortened.
fn seen(view: &View, direction: DVec3) -> DVec2 {
    DVec2::new(direction.dot(view.basis.right), -direction.dot(view.basis.up))
}

/// How long a level way looks that goes across the picture; 1 where the picture is upright, less where it is turned about the ray.
fn level_share(view: &View) -> f64 {
    DVec3::Z.cross(view.basis.up).try_normalize().map_or(1.0, |level| level.dot(view.basis.right).abs())
}

impl Layout<'_> {
    pub(super) fn scale_bar(&mut self, view: &View) {
        let place = self.figure.scale_bar;
        if !place.is_some() {
            return;
        }
        let share = level_share(view);
        let is_put = match view.is_orthographic() {
            true => self.bar_on_card(place, view.pixel_m(0.0) / share),
            false => match on_ground(view, place) {
                Some((at, depth)) => self.bar_on_ground(at, view.pixel_m(depth) / share),
                None => {
                    self.left_out.push("scale bar");
                    log::warn!(
                        "figure.scale_bar: there is no ground as high as the camera's target at its place in the picture, and it is left \
                         out; \"auto\", or a place below the horizon would be right"
                    );
                    return;
                }
            },
        };
        if !is_put {
            self.left_out("scale bar");
        }
    }

    /// A bar that is true everywhere, of pixels so many metres wide; whether there is room.
    fn bar_on_card(&mut self, place: PiecePlace, pixel_m: f64) -> bool {
        let style = self.sign_style();
        for metres in round_lengths(BAR_SHARE * f64::from(self.size[0]) * pixel_m) {
            let text = length_text(metres);
            let (long, wide) = ((metres / pixel_m) as f32, self.painter.setter.width(&text, style));
            let [pad_x, pad_y] = self.painter.padding();
            let [line, thick] = [1.35, BAR_EM].map(|em| self.painter.px(em));
            let size = [long.max(wide).ceil() + 2.0 * pad_x, line + thick + 2.0 * pad_y];
            let Some(low) = self.place(place, &BAR_PLACES, size) else { continue };
            let area = Area::new(low, size);
            self.painter.card(area);
            let left = low[0] + pad_x;
            let base = low[1] + pad_y + (0.5 * (line + CAP_HEIGHT * style.size_px)).round() - self.painter.px(0.15);
            let start = left + (0.5 * (long - wide)).max(0.0).floor();
            self.painter.text_on(&text, [start, base], style, INK, None);
            self.painter.halves([left + (0.5 * (wide - long)).max(0.0).floor(), low[1] + pad_y + line], [long, thick]);
            self.desk.take(area);
            return true;
        }
        false
    }

    /// A bar that is true at its place in the picture, of pixels so many metres wide there; whether there is room.
    fn bar_on_ground(&mut self, at: DVec2, pixel_m: f64) -> bool {
        let style = self.sign_style();
        let at = at.as_vec2();
        for metres in round_lengths(BAR_SHARE * f64::from(self.size[0]) * pixel_m) {
            let text = format!("{} here", length_text(metres));
            let (long, wide) = ((metres / pixel_m) as f32, self.painter.setter.width(&text, style));
            let [rim, thick, line] = [0.25, BAR_EM, 1.35].map(|em| self.painter.px(em));
            let (half, top) = (0.5 * long.max(wide) + rim, (at.y - 0.5 * thick).round());
            let area = Area { low: [at.x - half, top - line - rim], high: [at.x + half, top + thick + rim] };
            if !self.desk.is_free(&area) {
                continue;
            }
            let left = at.x - 0.5 * long;
            let casing = Fill { color: WHITE, opacity: 0.85 };
            let (low, high) = ([left - rim, top - rim], [left + long + rim, top + thick + rim]);
            self.painter.panel(low, high, casing, rim, 1.0);
            self.painter.halves([left, top], [long, thick]);
            let halo = Halo { color: WHITE, width_px: 0.2 * style.size_px, opacity: 0.85 };
            let base = top - rim - self.painter.px(0.3);
            self.painter.text_on(&text, [at.x - 0.5 * wide, base], style, INK, Some(halo));
            self.desk.take(area);
            self.bare.push(area);
            return true;
        }
        false
    }

    pub(super) fn north_arrow(&mut self, view: &View) {
        let place = self.figure.north_arrow;
        if !place.is_some() {
            return;
        }
        let side = self.painter.px(ARROW_CARD_EM);
        let Some(low) = self.place(place, &ARROW_PLACES, [side; 2]) else { return self.left_out("north arrow") };
        let area = Area::new(low, [side; 2]);
        self.painter.card(area);
        let middle = DVec2::new(f64::from(low[0] + 0.5 * side), f64::from(low[1] + 0.5 * side));
        let radius = f64::from(self.painter.px(RING_EM));
        let style = TextStyle { weight: Weight::SemiBold, ..self.sign_style() };
        self.painter.arrow(middle, radius, [seen(view, DVec3::X), seen(view, DVec3::Y)], style);
        self.desk.take(area);
    }

    fn sign_style(&self) -> TextStyle {
        TextStyle { size_px: self.painter.em, weight: Weight::Regular, tabular: true }
    }
}

impl Painter {
    /// A bar of two halves, dark and light; from its upper left corner.
    fn halves(&mut self, [left, top]: [f32; 2], [long, thick]: [f32; 2]) {
        let line = self.hairline().min(0.25 * thick);
        self.panel([left, top], [left + long, top + thick], Fill::opaque(INK), 0.0, 1.0);
        let light = ([left + 0.5 * long, top + line], [left + long - line, top + thick - line]);
        if light.0[0] < light.1[0] {
            self.panel(light.0, light.1, Fill::opaque(WHITE), 0.0, 1.0);
        }
    }

    /// An arrow to the north in a ring of this radius, pixels, on ground whose east and north are seen so.
    fn arrow(&mut self, middle: DVec2, radius: f64, [east, north]: [DVec2; 2], style: TextStyle) {
        let at = |[x, y]: [f64; 2]| middle + radius * (x * east + y * north);
        let ring = (0..=RING_SIDES).map(|i| f64::from(i) / f64::from(RING_SIDES) * std::f64::consts::TAU);
        let mut ring: Vec<DVec2> = ring.map(|angle| at([angle.cos(), angle.sin()])).collect();
        ring.dedup_by(|next, before| next.distance(*before) < 0.25);
        // Seen from its edge, it would be a line that goes to and fro.
        if east.perp_dot(north).abs() * radius > 1.5 {
            self.way(&ring, f64::from(self.hairline()), PALE);
        }
        let corners = ARROW.map(at);
        let [tip, right, notch, left] = corners;
        self.polygon(&corners, INK);
        self.polygon(&[tip, right, notch], PALE);
        // From its edge, it is a line as long as it looks.
        self.way(&[notch, tip], 0.6 * f64::from(self.hairline()), INK);
        self.way(&[tip, right, notch, left, tip], 0.6 * f64::from(self.hairline()), INK);
        let direction = if north.length() > 0.05 { north.normalize_or(DVec2::NEG_Y) } else { DVec2::NEG_Y };
        let letter = middle + radius * north + 0.62 * f64::from(self.em) * direction;
        let width = self.setter.width("N", style);
        let base = letter.y as f32 + 0.5 * CAP_HEIGHT * style.size_px;
        self.text_on("N", [letter.x as f32 - 0.5 * width, base.round()], style, QUIET_INK, None);
    }

    fn polygon(&mut self, corners: &[DVec2], color: Srgb) {
        let points = corners.iter().map(|p| p.as_vec2().to_array()).collect();
        self.pieces.push(Piece::Polygon(Polygon { points, color, opacity: 1.0 }));
    }

    fn way(&mut self, points: &[DVec2], width: f64, color: Srgb) {
        let mut points = points.to_vec();
        points.dedup_by(|next, before| next.distance(*before) < 0.05);
        if points.len() > 1 {
            let points = points.iter().map(|p| p.as_vec2().to_array()).collect();
            let strip = Strip { points, widths: [width as f32; 2], color, opacity: 1.0, skin: None, fade: None };
            self.pieces.push(Piece::Strip(strip));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_round_and_about_what_is_asked_for() {
        assert_eq!(round_lengths(120.0), [100.0, 50.0, 20.0]);
        assert_eq!(round_lengths(0.8), [1.0, 0.5, 0.2]);
        for exponent in -30..60 {
            let metres = 10_f64.powf(0.1 * f64::from(exponent));
            let [nearest, next, ..] = round_lengths(metres)[..] else { panic!("at least two") };
            assert!((0.62..=1.6).contains(&(nearest / metres)), "{metres}: {nearest}");
            assert!(next < nearest && next >= 0.39 * nearest, "{nearest} {next}");
        }
        for wrong in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert_eq!(round_lengths(wrong), Vec::<f64>::new());
        }
        let said = [0.05, 0.5, 1.0, 200.0, 1000.0, 20_000.0].map(length_text);
        assert_eq!(said, ["0.05 m", "0.5 m", "1 m", "200 m", "1 km", "20 km"].map(|text| text.replace(' ', "\u{a0}")));
    }
}
