//! Text: from a string to placed glyphs of the fonts that ship with the program, and to coverage.
//!
//! Only the shipped fonts are ever used, so a picture's text is the same on every machine. What the first lacks is set in
//! the second (Chinese, Japanese, Korean), on the same base line; what both lack is drawn as a box. Texts may come from any
//! file: they are cleaned and bounded before anything is measured.

mod breaks;
pub mod fonts;
pub mod polygon;
mod raster;

use std::ops::Range;

use swash::{scale::ScaleContext, shape::ShapeContext, text::Script};

pub use fonts::has_glyph;
pub use raster::{Run, bent};

use crate::{lens::color::Srgb, render::text::fonts::Face};

/// Characters of one text that are drawn at most; the rest is an ellipsis.
pub const MAX_CHARS: usize = 1000;
/// Sizes of text, pixels per em.
pub const SIZES_PX: std::ops::RangeInclusive<f32> = 4.0..=400.0;

/// How heavy letters are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Weight {
    /// For reading.
    #[default]
    Regular,
    /// For titles.
    SemiBold,
}

/// How text is set.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TextStyle {
    /// The em, pixels; brought into [`SIZES_PX`].
    pub size_px: f32,
    /// How heavy.
    pub weight: Weight,
    /// Whether all figures are equally wide, for numbers below each other.
    pub tabular: bool,
}

/// A line around letters that keeps them readable on any ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Halo {
    /// Its colour, sRGB 0..1.
    pub color: Srgb,
    /// How far it reaches, pixels; good: an eighth of the em.
    pub width_px: f32,
    /// 0 to 1; good: 0.8.
    pub opacity: f32,
}

/// One line of text, placed.
#[derive(Clone, Debug, PartialEq)]
pub struct TextLine {
    /// What it says; drawn cleaned ([`cleaned`]).
    pub text: String,
    /// Left end of the base line, pixels from the picture's top left. Whole rows are crisp.
    pub at: [f32; 2],
    /// How it is set.
    pub style: TextStyle,
    /// sRGB 0..1.
    pub color: Srgb,
    /// Around the letters.
    pub halo: Option<Halo>,
}

/// A glyph and where its origin is on the base line, pixels.
#[derive(Clone, Debug, PartialEq)]
struct PlacedGlyph {
    face: Face,
    id: u16,
    x: f32,
    y: f32,
    /// The bytes of the text that it stands for; all glyphs of a letter have the same.
    source: Range<usize>,
}

/// Glyphs of one font in a line of text.
#[derive(Clone, Debug, PartialEq)]
pub struct GlyphRun {
    /// The font.
    pub face: Face,
    /// The em, pixels.
    pub size_px: f32,
    /// What they say.
    pub text: String,
    /// From left to right.
    pub glyphs: Vec<SetGlyph>,
    /// Where the run ends, pixels from the picture's left.
    pub end: f32,
}

/// A glyph in its place.
#[derive(Clone, Debug, PartialEq)]
pub struct SetGlyph {
    /// Its number in the font.
    pub id: u16,
    /// Its origin on the base line, pixels from the picture's top left.
    pub at: [f32; 2],
    /// The bytes of the run's text that it stands for; all glyphs of a letter have the same.
    pub source: Range<usize>,
}

/// Height of capitals, share of the em: to set text in the middle of something.
pub const CAP_HEIGHT: f32 = 0.727;

/// Sets text; keeps the shaper's and the rasteriser's caches.
#[derive(Default)]
pub struct Typesetter {
    shape: ShapeContext,
    scale: ScaleContext,
}

impl std::fmt::Debug for Typesetter {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Typesetter")
    }
}

/// A text fit to be set on one line: control characters and line ends become blanks, marks of direction and other
/// characters without width go, blanks are single, letters of Korean syllables are one syllable, and it ends with an
/// ellipsis after [`MAX_CHARS`].
pub fn cleaned(text: &str) -> String {
    let mut out = String::new();
    // Whatever the text, no more of it is looked at.
    let mut all = text.chars();
    for c in all.by_ref().take(MAX_CHARS) {
        match c {
            '\u{200b}'..='\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2060}'..='\u{206f}' | '\u{feff}' | '\u{ad}' => {}
            '\u{fe00}'..='\u{fe0f}' => {}
            c if c.is_control() || (c.is_whitespace() && c != '\u{a0}' && c != '\u{2009}') => {
                if !out.is_empty() && !out.ends_with(' ') {
                    out.push(' ');
                }
            }
            c => match out.chars().next_back().and_then(|last| syllable(last, c)) {
                Some(joined) => {
                    out.pop();
                    out.push(joined);
                }
                None => out.push(c),
            },
        }
    }
    out.truncate(out.trim_end().len());
    if all.next().is_some() {
        out.push('…');
    }
    out
}

/// The Korean syllable of a leading letter and a vowel, or of an open syllable and a trailing letter (Unicode 3.12).
fn syllable(last: char, c: char) -> Option<char> {
    let [s, l, v, t] = [0xac00, 0x1100, 0x1161, 0x11a7];
    let (last, c) = (u32::from(last), u32::from(c));
    let below = |c: u32, first: u32, count: u32| c.checked_sub(first).filter(|i| *i < count);
    if let (Some(leading), Some(vowel)) = (below(last, l, 19), below(c, v, 21)) {
        return char::from_u32(s + (leading * 21 + vowel) * 28);
    }
    let open = below(last, s, 11_172).filter(|i| i % 28 == 0)?;
    let trailing = below(c, t, 28).filter(|i| *i > 0)?;
    char::from_u32(s + open + trailing)
}

impl Typesetter {
    /// The glyphs of a cleaned text with kerning, and the width of it, pixels.
    fn shaped(&mut self, text: &str, style: TextStyle) -> (Vec<PlacedGlyph>, f32) {
        let (mut glyphs, mut x) = (Vec::new(), 0.0);
        for (face, run) in fonts::runs(text, style.weight) {
            let mut shaper = self
                .shape
                .builder(face.font())
                // The fonts have no script that joins letters: one way of setting does for all.
                .script(Script::Latin)
                .size(size_of(style))
                .features(&[("tnum", u16::from(style.tabular))])
                .build();
            let start = run.as_ptr() as usize - text.as_ptr() as usize;
            shaper.add_str(run);
            shaper.shape_with(|cluster| {
                let source = cluster.source.to_range();
                for glyph in cluster.glyphs {
                    let source = start + source.start..start + source.end;
                    glyphs.push(PlacedGlyph { face, id: glyph.id, x: x + glyph.x, y: glyph.y, source });
                    x += glyph.advance;
                }
            });
        }
        (glyphs, x)
    }

    /// The glyphs of a line where they are drawn, font by font.
    pub fn set(&mut self, line: &TextLine) -> Vec<GlyphRun> {
        let text = cleaned(&line.text);
        let (glyphs, width) = self.shaped(&text, line.style);
        let [left, base] = line.at;
        let runs: Vec<&[PlacedGlyph]> = glyphs.chunk_by(|a, b| a.face == b.face).collect();
        let first = |run: &[PlacedGlyph]| (run[0].source.start, run[0].x);
        let ends = runs.iter().skip(1).map(|next| first(next)).chain([(text.len(), width)]);
        let run = |(run, (end, x)): (&&[PlacedGlyph], (usize, f32))| {
            let start = first(run).0;
            let glyph = |glyph: &PlacedGlyph| SetGlyph {
                id: glyph.id,
                at: [left + glyph.x, base - glyph.y],
                source: glyph.source.start - start..glyph.source.end - start,
            };
            GlyphRun {
                face: run[0].face,
                size_px: size_of(line.style),
                text: text[start..end].to_owned(),
                glyphs: run.iter().map(glyph).collect(),
                end: left + x,
            }
        };
        runs.iter().zip(ends).map(run).collect()
    }

    /// The width of a text on one line, pixels.
    pub fn width(&mut self, text: &str, style: TextStyle) -> f32 {
        self.shaped(&cleaned(text), style).1
    }

    /// The text, cleaned, or as much of its beginning as fits into `width_px` with an ellipsis; empty where not even
    /// that fits.
    pub fn elided(&mut self, text: &str, style: TextStyle, width_px: f32) -> String {
        let text = cleaned(text);
        if self.shaped(&text, style).1 <= width_px {
            return text;
        }
        let ends: Vec<usize> = text.char_indices().map(|(i, _)| i).collect();
        let cut = |end: usize| format!("{}…", text[..end].trim_end().trim_end_matches('…'));
        // The longest beginning that fits; widths grow with length but for kerning, which the last step makes good.
        let (mut fits, mut too_long) = (0, ends.len());
        while fits + 1 < too_long {
            let middle = usize::midpoint(fits, too_long);
            if self.shaped(&cut(ends[middle]), style).1 <= width_px { fits = middle } else { too_long = middle }
        }
        // Without a mark that belonged to the letter after the cut.
        let text = cut(ends.get(fits).copied().unwrap_or(0));
        if self.shaped(&text, style).1 <= width_px { text } else { String::new() }
    }

    /// The text in at most `most` lines of `width_px`, broken at blanks, Chinese and Japanese also between characters; what
    /// does not fit ends in an ellipsis. A line end of the text begins a line.
    pub fn wrapped(&mut self, text: &str, style: TextStyle, width_px: f32, most: usize) -> Vec<String> {
        let mut bounded: String = text.chars().take(MAX_CHARS).collect();
        if bounded.len() < text.len() {
            bounded.push('…');
        }
        let mut lines: Vec<String> = Vec::new();
        for paragraph in bounded.trim().lines() {
            let paragraph = cleaned(paragraph);
            let mut line = String::new();
            for word in paragraph.split(' ') {
                for (i, piece) in breaks::pieces(word).into_iter().enumerate() {
                    let blank = if i == 0 && !line.is_empty() { " " } else { "" };
                    let longer = format!("{line}{blank}{piece}");
                    if line.is_empty() || self.shaped(&longer, style).1 <= width_px {
                        line = longer;
                    } else {
                        lines.push(std::mem::replace(&mut line, piece.to_owned()));
                    }
                }
            }
            lines.push(line);
        }
        if lines.len() > most {
            lines.truncate(most);
            lines.last_mut().into_iter().for_each(|last| last.push_str(" …"));
        }
        // A word may be longer than a line.
        lines.iter().map(|line| self.elided(line, style, width_px)).collect()
    }
}

/// The size that is set, pixels per em.
fn size_of(style: TextStyle) -> f32 {
    if style.size_px.is_finite() { style.size_px.clamp(*SIZES_PX.start(), *SIZES_PX.end()) } else { *SIZES_PX.start() }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const STYLE: TextStyle = TextStyle { size_px: 20.0, weight: Weight::Regular, tabular: false };

    #[test]
    fn the_font_has_what_legends_of_europe_need() {
        let signs = "€²³°–—…≤≥×·−¹⁰₂½‰µ";
        let letters = "AÄÅÆÇÉÍŁÑÓŐØŚŞŠÚŰÝŽßþđı ΑΒΓΩαβγω АБВЖИЙКЯабвжйяҐїє";
        for c in signs.chars().chain(letters.chars()).chain(' '..='~') {
            assert!(has_glyph(c), "{c:?}");
        }
        assert!(signs.chars().chain(letters.chars()).all(fonts::is_in_first));
        assert!(!has_glyph('😀') && !has_glyph('ש'));
        for weight in [Weight::Regular, Weight::SemiBold] {
            assert_eq!(Face::First(weight).font().metrics(&[]).units_per_em, 2048);
        }
        let cap = |face: Face| {
            let metrics = face.font().metrics(&[]);
            metrics.cap_height / f32::from(metrics.units_per_em)
        };
        assert!((cap(Face::First(Weight::Regular)) - CAP_HEIGHT).abs() < 1e-3);
        // Letters of both fonts stand beside each other.
        assert!((cap(Face::Fallback(Weight::Regular)) - CAP_HEIGHT).abs() < 0.01);
    }

    #[test]
    fn the_fallback_has_what_figures_of_east_asia_need() {
        // All syllables of Korean, all kana, and of each standard of characters the first and the last.
        for c in ('\u{ac00}'..='\u{d7a3}').chain('ぁ'..='ゖ').chain('ァ'..='ヺ').chain('ㄅ'..='ㄩ').chain('！'..='～')
        {
            assert!(has_glyph(c), "{c:?}");
        }
        let chinese = "啊座亍齄城市视图建筑年代一龘臺灣街區、。《》「」￥";
        let japanese = "亜腕弌瑤都市眺め東京駅周辺々〆ヶー㎡";
        for c in chinese.chars().filter(|c| *c != '龘').chain(japanese.chars()).chain("伽詰".chars()) {
            assert!(has_glyph(c) && !fonts::is_in_first(c), "{c:?}");
        }
    }

    #[test]
    fn runs_are_of_one_font_and_keep_marks_with_their_letters() {
        let runs = |text| fonts::runs(text, Weight::Regular);
        let (first, fallback) = (Face::First(Weight::Regular), Face::Fallback(Weight::Regular));
        assert_eq!(runs("Delft Дом"), [(first, "Delft Дом")]);
        assert_eq!(runs("東京 Tokyo駅"), [(fallback, "東京"), (first, " Tokyo"), (fallback, "駅")]);
        assert_eq!(runs("か\u{3099}e\u{301}"), [(fallback, "か\u{3099}"), (first, "e\u{301}")]);
        // What neither has is a box of the first.
        assert_eq!(runs("東😀"), [(fallback, "東"), (first, "😀")]);
        assert_eq!(runs(""), [(first, "")]);
    }

    #[test]
    fn chinese_is_as_wide_as_its_em_and_scripts_stand_beside_each_other() {
        let mut set = Typesetter::default();
        assert!((set.width("城市视图", STYLE) - 4.0 * STYLE.size_px).abs() < 1e-3);
        let parts = ["東京", " Tokyo ", "서울"].map(|part| set.shaped(part, STYLE).1);
        let whole = set.shaped("東京 Tokyo 서울", STYLE);
        assert!((whole.1 - parts.iter().sum::<f32>()).abs() < 1e-2);
        // One base line.
        assert!(whole.0.iter().all(|glyph| glyph.y == 0.0));
        assert!(whole.0.windows(2).all(|pair| pair[0].x < pair[1].x));
    }

    #[test]
    fn widths_scale_kern_and_align() {
        let mut set = Typesetter::default();
        let mut width = |text: &str, style| set.width(text, style);
        let twice = TextStyle { size_px: 40.0, ..STYLE };
        assert!((width("Rotterdam", twice) - 2.0 * width("Rotterdam", STYLE)).abs() < 1e-3);
        assert!(width("AVAVAV", STYLE) < 3.0 * (width("A", STYLE) + width("V", STYLE)), "no kerning");
        assert_eq!(width("", STYLE), 0.0);
        let tabular = TextStyle { tabular: true, ..STYLE };
        assert!((width("111", tabular) - width("888", tabular)).abs() < 1e-3);
        assert!(width("111", STYLE) < width("888", STYLE));
        // What the font does not have takes the width of its box.
        assert!(width("שלום", STYLE) > 10.0);
    }

    #[test]
    fn texts_are_cleaned() {
        assert_eq!(cleaned("  a\tb\r\n\u{0}c\u{1b}[31m "), "a b c [31m");
        assert_eq!(cleaned("\u{202e}abc\u{200b}\u{feff}"), "abc");
        assert_eq!(cleaned("5\u{2009}000\u{a0}m"), "5\u{2009}000\u{a0}m");
        // Korean as some systems write names of files: letter by letter.
        assert_eq!(cleaned("\u{1112}\u{1161}\u{11ab}\u{1100}\u{1173}\u{11af}"), "한글");
        assert_eq!(cleaned("\u{ac00}\u{11a7}\u{1112}\u{11ab}"), "\u{ac00}\u{11a7}\u{1112}\u{11ab}");
        let million = "x".repeat(1_000_000);
        assert_eq!(cleaned(&million).chars().count(), MAX_CHARS + 1);
        assert!(cleaned(&million).ends_with('…'));
    }

    #[test]
    fn what_does_not_fit_ends_in_an_ellipsis() {
        let mut set = Typesetter::default();
        let text = "Nieuwe Binnenweg";
        let full = set.width(text, STYLE);
        assert_eq!(set.elided(text, STYLE, full + 0.1), text);
        let shorter = set.elided(text, STYLE, full - 1.0);
        assert!(shorter.ends_with('…') && text.starts_with(shorter.trim_end_matches('…')), "{shorter}");
        // The longest that fits: one letter more would not.
        let more: String = text.chars().take(shorter.chars().count()).collect();
        assert!(set.width(&format!("{more}…"), STYLE) > full - 1.0);
        assert_eq!(set.elided(text, STYLE, 1.0), "");
        assert_eq!(set.elided("", STYLE, 0.0), "");
    }

    #[test]
    fn lines_break_at_blanks() {
        let mut set = Typesetter::default();
        let width = set.width("one two three", STYLE) + 1.0;
        assert_eq!(set.wrapped("one two three four five", STYLE, width, 9), ["one two three", "four five"]);
        assert_eq!(set.wrapped("one\ntwo", STYLE, width, 9), ["one", "two"]);
        assert_eq!(set.wrapped("one two three\nfour\nfive", STYLE, width, 2), ["one two three", "four …"]);
        let long = set.wrapped(&"x".repeat(400), STYLE, width, 3);
        assert!(long.len() == 1 && long[0].ends_with('…') && set.width(&long[0], STYLE) <= width, "{long:?}");
        assert!(set.wrapped("", STYLE, width, 3).is_empty());
    }

    #[test]
    fn lines_without_blanks_break_between_characters() {
        let mut set = Typesetter::default();
        let five = 5.0 * STYLE.size_px + 0.1;
        assert_eq!(set.wrapped("城市视图建筑年代", STYLE, five, 9), ["城市视图建", "筑年代"]);
        // What closes does not begin a line.
        assert_eq!(set.wrapped("城市视图建。年代", STYLE, five, 9), ["城市视图", "建。年代"]);
        assert_eq!(set.wrapped("東京 LoD2", STYLE, five, 9), ["東京 LoD2"]);
        assert_eq!(set.wrapped("東京都 LoD2の街", STYLE, five, 9), ["東京都", "LoD2の街"]);
    }

    proptest! {
        #![proptest_config(crate::seeds::config())]

        #[test]
        fn any_text_can_be_set(text in "\\PC{0,40}|[\\x00-\\x{10FFFF}]{0,40}", width in 0.0_f32..300.0) {
            let mut set = Typesetter::default();
            let shown = set.elided(&text, STYLE, width);
            prop_assert!(set.width(&shown, STYLE) <= width);
            for line in set.wrapped(&text, STYLE, width, 4) {
                prop_assert!(set.width(&line, STYLE) <= width);
            }
            let halo = Some(Halo { color: [1.0; 3], width_px: 2.0, opacity: 0.8 });
            let line = TextLine { text, at: [-10.0, 20.0], style: STYLE, color: [0.0; 3], halo };
            if let Some(run) = set.rasterised(&line, [100, 40]) {
                prop_assert!(run.origin[0] + run.size[0] <= 100 && run.origin[1] + run.size[1] <= 40);
            }
        }
    }
}
