//! Furniture as the three things that both formats have: pixels, filled outlines, and text as glyphs.

use glam::{Affine2, Mat2, Mat3, Vec2, Vec3};

use crate::{
    lens::color::{Srgb, linear_from_srgb},
    render::{
        furniture::{BoardPiece, Panel, Piece, Strip},
        text::{GlyphRun, Halo, SetGlyph, TextLine, Typesetter},
    },
};

/// Outlines that a soft border is made of.
const SOFT_STEPS: u32 = 16;
/// How far the handles of a quarter of a circle reach, radii.
const QUARTER: f32 = 0.552_284_8;

/// One mark.
#[derive(Clone, Debug, PartialEq)]
pub enum Mark {
    /// Pixels.
    Raster(Raster),
    /// An area.
    Fill(Fill),
    /// A line of text.
    Text(SetText),
}

/// Pixels on whole pixels of the page.
#[derive(Clone, Debug, PartialEq)]
pub struct Raster {
    /// Left, top.
    pub at: [u32; 2],
    /// Width, height.
    pub size: [u32; 2],
    /// sRGB, straight alpha, row by row.
    pub rgba: Vec<[u8; 4]>,
}

/// An area of one colour.
#[derive(Clone, Debug, PartialEq)]
pub struct Fill {
    /// Its closed border; what that goes around is in it.
    pub outline: Vec<Step>,
    /// sRGB 0..1.
    pub color: Srgb,
    /// 0 to 1.
    pub opacity: f32,
}

/// A step of a border, pixels of the page.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Step {
    /// Begins here.
    Move([f32; 2]),
    /// Straight to here.
    Line([f32; 2]),
    /// By two handles to here.
    Curve([[f32; 2]; 3]),
    /// Back to the beginning.
    Close,
}

/// A line of text.
#[derive(Clone, Debug, PartialEq)]
pub struct SetText {
    /// Its glyphs, by font.
    pub runs: Vec<GlyphRun>,
    /// sRGB 0..1.
    pub color: Srgb,
    /// What surrounds its letters.
    pub halo: Option<Halo>,
    /// Where it is on the page; `None`: its pixels are the page's.
    pub map: Option<Affine2>,
}

impl Raster {
    /// Whether nothing shines through.
    pub fn is_opaque(&self) -> bool {
        self.rgba.iter().all(|[.., alpha]| *alpha == 255)
    }

    /// What of it is to be seen; `None`: nothing.
    pub fn trimmed(&self) -> Option<Self> {
        let [width, height] = self.size.map(|side| side as usize);
        let row = |y: usize| &self.rgba[y * width..(y + 1) * width];
        let is_seen = |[.., alpha]: &[u8; 4]| *alpha > 0;
        let top = (0..height).find(|y| row(*y).iter().any(is_seen))?;
        let bottom = (0..height).rfind(|y| row(*y).iter().any(is_seen))? + 1;
        let left = (top..bottom).filter_map(|y| row(y).iter().position(is_seen)).min()?;
        let right = (top..bottom).filter_map(|y| row(y).iter().rposition(is_seen)).max()? + 1;
        let rgba = (top..bottom).flat_map(|y| &row(y)[left..right]).copied().collect();
        let at = [self.at[0] + left as u32, self.at[1] + top as u32];
        Some(Self { at, size: [(right - left) as u32, (bottom - top) as u32], rgba })
    }
}

/// Whether a piece has no other form than pixels.
pub fn is_image(piece: &Piece) -> bool {
    match piece {
        Piece::Image(_) | Piece::Board(_) => true,
        Piece::Strip(strip) => strip.skin.is_some() || strip.fade.is_some(),
        Piece::Panel(_) | Piece::Text(_) | Piece::Polygon(_) => false,
    }
}

/// The marks of pieces that are no images.
pub fn of(pieces: &[Piece]) -> Vec<Mark> {
    let mut setter = Typesetter::default();
    let mut marks = Vec::new();
    for (i, piece) in pieces.iter().enumerate() {
        match piece {
            Piece::Panel(panel) if panel.softness_px > 1.0 => soft(panel, &mut marks),
            Piece::Panel(panel) => {
                // Columns beside each other go on below the next one: viewers smooth borders, and would show a gap.
                let high = match pieces.get(i + 1) {
                    Some(Piece::Panel(next)) if follows(panel, next) => [next.high[0], panel.high[1]],
                    _ => panel.high,
                };
                marks.push(fill(border(&Panel { high, ..*panel }, 0.0), panel.color, panel.opacity));
            }
            Piece::Text(line) => marks.push(Mark::Text(text(&mut setter, line))),
            Piece::Polygon(polygon) => marks.push(fill(closed(&polygon.points), polygon.color, polygon.opacity)),
            Piece::Strip(strip) => marks.push(fill(closed(&outline(strip)), strip.color, strip.opacity)),
            Piece::Image(_) | Piece::Board(_) => {}
        }
    }
    marks.retain(|mark| !matches!(mark, Mark::Fill(fill) if fill.outline.is_empty() || fill.opacity <= 0.0));
    marks
}

/// An opaque rectangle.
pub fn rectangle(low: [f32; 2], high: [f32; 2], color: Srgb) -> Mark {
    fill(closed(&[low, [high[0], low[1]], high, [low[0], high[1]]]), color, 1.0)
}

fn text(setter: &mut Typesetter, line: &TextLine) -> SetText {
    let halo = line.halo.filter(|halo| halo.width_px > 0.0 && halo.opacity > 0.0);
    SetText { runs: setter.set(line), color: line.color, halo, map: None }
}

/// The texts of a board whose image has this size, where they stand in the scene. Text is no perspective; a word is so short that its middle's is
/// that of all of it.
pub fn on_board(texts: &[TextLine], board: &BoardPiece, size: [u32; 2]) -> Vec<Mark> {
    let [a, b, c] = board.rows.map(Vec3::from);
    let pixel_from_image = Mat3::from_cols(a, b, c).transpose().inverse();
    let size = Vec2::new(size[0] as f32, size[1] as f32);
    let on_page = |at: Vec2| {
        let place = pixel_from_image * (at / size).extend(1.0);
        Vec2::from(board.low) + place.truncate() / place.z
    };
    let mut setter = Typesetter::default();
    let mut marks = Vec::new();
    for line in texts {
        let whole = text(&mut setter, line);
        for run in whole.runs.iter().flat_map(words) {
            let [left, base] = run.glyphs.first().map_or([0.0; 2], |glyph| glyph.at);
            let middle = Vec2::new(0.5 * (left + run.end), base - 0.3 * run.size_px);
            let step = 0.25 * run.size_px;
            let along = |axis: Vec2| (on_page(middle + step * axis) - on_page(middle - step * axis)) / (2.0 * step);
            let linear = Mat2::from_cols(along(Vec2::X), along(Vec2::Y));
            let map = Affine2::from_mat2_translation(linear, on_page(middle) - linear * middle);
            if map.is_finite() {
                marks.push(Mark::Text(SetText { runs: vec![run], map: Some(map), ..whole.clone() }));
            }
        }
    }
    marks
}

/// The words of a run, each with the blank after it.
fn words(run: &GlyphRun) -> Vec<GlyphRun> {
    let is_blank = |glyph: &SetGlyph| run.text.get(glyph.source.clone()) == Some(" ");
    let parts = run.glyphs.chunk_by(|a, b| !is_blank(a) || is_blank(b));
    let mut done = 0;
    let word = |part: &[SetGlyph]| {
        done += part.len();
        let next = run.glyphs.get(done);
        let (start, stop) = (part[0].source.start, next.map_or(run.text.len(), |glyph| glyph.source.start));
        let glyph = |glyph: &SetGlyph| SetGlyph {
            source: glyph.source.start - start..glyph.source.end - start,
            ..glyph.clone()
        };
        GlyphRun {
            text: run.text[start..stop].to_owned(),
            glyphs: part.iter().map(glyph).collect(),
            end: next.map_or(run.end, |glyph| glyph.at[0]),
            ..*run
        }
    };
    parts.map(word).collect()
}

fn fill(outline: Vec<Step>, color: Srgb, opacity: f32) -> Mark {
    Mark::Fill(Fill { outline, color, opacity: seen_opacity(opacity, color) })
}

/// The opacity that, blended in sRGB, looks as `opacity` blended in linear light, which pictures are: dark colours are taken to stand on
/// white, light ones on black.
fn seen_opacity(opacity: f32, color: Srgb) -> f32 {
    let opacity = opacity.clamp(0.0, 1.0);
    if opacity >= 1.0 {
        return 1.0;
    }
    let weigh = |c: [f32; 3]| c.iter().zip([0.2126, 0.7152, 0.0722]).map(|(c, weight)| c * weight).sum::<f32>();
    let light = weigh(linear_from_srgb(color));
    let gray =
        |linear: f32| if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 };
    let ground = if light < 0.2 { 1.0 } else { 0.0 };
    let seen = gray(ground + (light - ground) * opacity);
    ((seen - ground) / (gray(light) - ground)).clamp(0.0, 1.0)
}

/// Whether an opaque panel goes on in the next, to the right.
fn follows(panel: &Panel, next: &Panel) -> bool {
    let is_column = |p: &Panel| p.opacity >= 1.0 && p.radius_px <= 0.0 && p.softness_px <= 1.0 && !p.ellipse;
    let rows = |p: &Panel| [p.low[1], p.high[1]];
    is_column(panel) && is_column(next) && rows(panel) == rows(next) && panel.high[0] == next.low[0]
}

/// A panel whose border fades: outlines in each other, each of which adds what the next inner one has more.
fn soft(panel: &Panel, marks: &mut Vec<Mark>) {
    let mut below = 0.0;
    for i in 0..SOFT_STEPS {
        let share = (i as f32 + 1.0) / SOFT_STEPS as f32;
        let wanted = panel.opacity.clamp(0.0, 1.0) * share * share * (3.0 - 2.0 * share);
        // Where the middle of the step is.
        let beyond = panel.softness_px * (0.5 - (i as f32 + 0.5) / SOFT_STEPS as f32);
        let opacity = seen_opacity(wanted, panel.color);
        let own = if below < 1.0 { 1.0 - (1.0 - opacity) / (1.0 - below) } else { 0.0 };
        below = opacity;
        marks.push(Mark::Fill(Fill { outline: border(panel, beyond), color: panel.color, opacity: own }));
    }
}

/// The border of a panel, moved outwards; empty where nothing is left.
fn border(panel: &Panel, beyond: f32) -> Vec<Step> {
    let low = Vec2::from(panel.low) - beyond;
    let high = Vec2::from(panel.high) + beyond;
    let half = 0.5 * (high - low);
    if half.min_element() <= 0.0 {
        return Vec::new();
    }
    if panel.ellipse {
        return rounded(low, high, half);
    }
    let corner =
        panel.radius_px.max(0.0).min(0.5 * (panel.high[0] - panel.low[0])).min(0.5 * (panel.high[1] - panel.low[1]));
    let radius = (corner + beyond).max(0.0).min(half.min_element());
    match radius > 0.0 {
        true => rounded(low, high, Vec2::splat(radius)),
        false => closed(&[low.into(), [high.x, low.y], high.into(), [low.x, high.y]]),
    }
}

/// A rectangle whose corners are quarters of ellipses.
fn rounded(low: Vec2, high: Vec2, radius: Vec2) -> Vec<Step> {
    let k = QUARTER * radius;
    let at = |x: f32, y: f32| [x, y];
    let (l, t, r, b) = (low.x, low.y, high.x, high.y);
    let Vec2 { x: rx, y: ry } = radius;
    vec![
        Step::Move(at(l + rx, t)),
        Step::Line(at(r - rx, t)),
        Step::Curve([at(r - rx + k.x, t), at(r, t + ry - k.y), at(r, t + ry)]),
        Step::Line(at(r, b - ry)),
        Step::Curve([at(r, b - ry + k.y), at(r - rx + k.x, b), at(r - rx, b)]),
        Step::Line(at(l + rx, b)),
        Step::Curve([at(l + rx - k.x, b), at(l, b - ry + k.y), at(l, b - ry)]),
        Step::Line(at(l, t + ry)),
        Step::Curve([at(l, t + ry - k.y), at(l + rx - k.x, t), at(l + rx, t)]),
        Step::Close,
    ]
}

fn closed(points: &[[f32; 2]]) -> Vec<Step> {
    if points.len() < 3 {
        return Vec::new();
    }
    let lines = points[1..].iter().map(|p| Step::Line(*p));
    std::iter::once(Step::Move(points[0])).chain(lines).chain([Step::Close]).collect()
}

/// The border of a strip: along its left side, and back along its right one.
fn outline(strip: &Strip) -> Vec<[f32; 2]> {
    let cuts = strip.crosscuts();
    let side = |sign: f32| {
        cuts.iter().map(move |cut| Vec2::from(cut.at) + sign * cut.half_width * cut.stretch * Vec2::from(cut.across))
    };
    side(1.0).chain(side(-1.0).rev()).map(Into::into).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::text::{TextStyle, Weight};

    fn panel(softness_px: f32) -> Panel {
        Panel {
            low: [20.0, 10.0],
            high: [80.0, 50.0],
            color: [0.0; 3],
            opacity: 0.5,
            radius_px: 6.0,
            softness_px,
            ellipse: false,
        }
    }

    #[test]
    fn a_soft_border_adds_up_to_what_it_is_inside() {
        let marks = of(&[Piece::Panel(panel(16.0))]);
        assert_eq!(marks.len(), SOFT_STEPS as usize);
        let mut left = 1.0;
        for mark in &marks {
            let Mark::Fill(fill) = mark else { panic!("an area") };
            left *= 1.0 - fill.opacity;
        }
        assert!((1.0 - left - seen_opacity(0.5, [0.0; 3])).abs() < 1e-4, "{left}");
        // Half of black in linear light on white is a light gray.
        assert!((seen_opacity(0.5, [0.0; 3]) - 0.265).abs() < 0.005 && seen_opacity(1.0, [0.3; 3]) == 1.0);
        assert!((seen_opacity(0.93, [1.0; 3]) - 0.969).abs() < 0.005);
    }

    #[test]
    fn words_of_a_board_stand_where_its_image_does() {
        let style = TextStyle { size_px: 20.0, weight: Weight::Regular, tabular: false };
        let line = TextLine { text: "One two  three".into(), at: [10.0, 40.0], style, color: [0.0; 3], halo: None };
        // Twice as wide as its image of 200 x 100, and in perspective downwards: w grows from 1 to 1.5.
        let rows = [[1.0 / 400.0, 0.0, 0.0], [0.0, 1.5 / 100.0, 0.0], [0.0, 0.5 / 100.0, 1.0]];
        let board = BoardPiece { image: 1, low: [50.0, 60.0], high: [450.0, 160.0], rows };
        let marks = on_board(std::slice::from_ref(&line), &board, [200, 100]);
        let words: Vec<&SetText> =
            marks.iter().filter_map(|mark| if let Mark::Text(text) = mark { Some(text) } else { None }).collect();
        let said: Vec<&str> = words.iter().map(|word| word.runs[0].text.as_str()).collect();
        assert_eq!(said, ["One ", "two ", "three"]);
        for word in words {
            let run = &word.runs[0];
            let [x, y] = run.glyphs[0].at;
            let seen = word.map.unwrap().transform_point2(Vec2::new(x, y));
            let [u, v, w] = rows.map(|row| row[0] * (seen.x - 50.0) + row[1] * (seen.y - 60.0) + row[2]);
            assert!((u / w * 200.0 - x).abs() < 1.5 && (v / w * 100.0 - y).abs() < 0.5, "{} {x} {y}: {seen}", run.text);
        }
    }

    #[test]
    fn strips_become_their_borders() {
        let strip = |points: Vec<[f32; 2]>, widths| Strip {
            points,
            widths,
            color: [0.0; 3],
            opacity: 1.0,
            skin: None,
            fade: None,
        };
        let straight = outline(&strip(vec![[0.0, 0.0], [10.0, 0.0]], [4.0, 2.0]));
        let mut ys: Vec<f32> = straight.iter().map(|p| p[1].abs()).collect();
        ys.sort_by(f32::total_cmp);
        assert_eq!((straight.len(), ys), (4, vec![1.0, 1.0, 2.0, 2.0]));
        let bent = outline(&strip(vec![[0.0, 0.0], [10.0, 0.0], [10.0, 10.0]], [2.0, 2.0]));
        assert!(bent.iter().any(|p| (p[0] - 11.0).abs() < 1e-5 && (p[1] + 1.0).abs() < 1e-5), "a mitre: {bent:?}");
        assert!(is_image(&Piece::Strip(Strip { skin: Some(1), ..strip(vec![], [1.0; 2]) })));
    }

    #[test]
    fn what_is_not_seen_of_pixels_is_not_kept() {
        let mut rgba = vec![[9, 9, 9, 0]; 6 * 4];
        assert_eq!(Raster { at: [0, 0], size: [6, 4], rgba: rgba.clone() }.trimmed(), None);
        (rgba[6 + 2], rgba[2 * 6 + 4]) = ([1, 2, 3, 255], [4, 5, 6, 7]);
        let kept = Raster { at: [100, 200], size: [6, 4], rgba }.trimmed().expect("two pixels");
        assert_eq!(
            (kept.at, kept.size, kept.rgba[0], kept.rgba[5]),
            ([102, 201], [3, 2], [1, 2, 3, 255], [4, 5, 6, 7])
        );
    }
}
