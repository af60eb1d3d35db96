//! The fonts that ship with the program: *Inter*, and behind it *Noto Sans CJK* for what Inter has no letters for.

use std::{io::Read, sync::LazyLock};

use flate2::read::GzDecoder;
use swash::{
    FontRef,
    text::{
        Codepoint, Script,
        cluster::{CharCluster, Parser, Status, Token},
    },
};

use crate::render::text::Weight;

/// Inter 4 (OFL 1.1, `assets/font/NOTICE.md`), a subset: Latin, Greek, Cyrillic, figures and signs.
pub const REGULAR: &[u8] = include_bytes!("../../../assets/font/Inter-Regular.ttf");
/// Its titles.
pub const SEMI_BOLD: &[u8] = include_bytes!("../../../assets/font/Inter-SemiBold.ttf");
/// Noto Sans CJK 2.004 (OFL 1.1, `assets/font/NOTICE.md`), a subset: Chinese, Japanese, Korean; gzip.
const FALLBACK: &[u8] = include_bytes!("../../../assets/font/NotoSansCJKjp-Regular.otf.gz");

static INTER: LazyLock<[FontRef<'static>; 2]> = LazyLock::new(|| [REGULAR, SEMI_BOLD].map(font));
static FALLBACK_DATA: LazyLock<Vec<u8>> = LazyLock::new(|| {
    let mut data = Vec::new();
    GzDecoder::new(FALLBACK).read_to_end(&mut data).unwrap_or_else(|_| unreachable!("a test reads the shipped fonts"));
    data
});
static NOTO: LazyLock<FontRef<'static>> = LazyLock::new(|| font(fallback_data()));

/// How much heavier the fallback, which has one weight, is made for titles, em: a stem as Noto Sans CJK Medium has it.
const EMBOLDENED_EM: f32 = 1.0 / 36.0;

/// One of the fonts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Face {
    /// Inter, which is asked first and sets the measures of a line.
    First(Weight),
    /// Noto Sans CJK, for what Inter does not have.
    Fallback(Weight),
}

impl Face {
    /// The font.
    pub fn font(self) -> FontRef<'static> {
        match self {
            Self::First(Weight::Regular) => INTER[0],
            Self::First(Weight::SemiBold) => INTER[1],
            Self::Fallback(_) => *NOTO,
        }
    }

    /// How many files the fonts are.
    pub const FILES: usize = 3;

    /// The number of its file, from 0.
    pub fn file(self) -> usize {
        match self {
            Self::First(Weight::Regular) => 0,
            Self::First(Weight::SemiBold) => 1,
            Self::Fallback(_) => 2,
        }
    }

    /// Its file.
    pub fn data(self) -> &'static [u8] {
        Self::data_of(self.file())
    }

    /// The file of a number below [`Self::FILES`].
    pub fn data_of(file: usize) -> &'static [u8] {
        match file {
            0 => REGULAR,
            1 => SEMI_BOLD,
            _ => fallback_data(),
        }
    }

    /// How much heavier than its outlines it is drawn, em.
    pub fn emboldened_em(self) -> f32 {
        if self == Self::Fallback(Weight::SemiBold) { EMBOLDENED_EM } else { 0.0 }
    }
}

fn font(data: &'static [u8]) -> FontRef<'static> {
    FontRef::from_index(data, 0).unwrap_or_else(|| unreachable!("a test reads the shipped fonts"))
}

/// The file of the fallback; unpacked when it is first asked for.
pub fn fallback_data() -> &'static [u8] {
    &FALLBACK_DATA
}

/// Whether the first font has a glyph for the character.
pub fn is_in_first(c: char) -> bool {
    INTER[0].charmap().map(c) != 0
}

/// Whether any font has a glyph for the character.
pub fn has_glyph(c: char) -> bool {
    is_in_first(c) || NOTO.charmap().map(c) != 0
}

/// The text in runs of one font each, in their order. A letter and its marks are not torn apart: they are set in the fallback where it
/// has all of them and the first font has not. What neither has is the first font's, which draws a box.
pub fn runs(text: &str, weight: Weight) -> Vec<(Face, &str)> {
    let (first, fallback) = (Face::First(weight), Face::Fallback(weight));
    if text.chars().all(is_in_first) {
        return vec![(first, text)];
    }
    let tokens = text.char_indices().map(|(at, ch)| Token {
        ch,
        offset: at as u32,
        len: ch.len_utf8() as u8,
        info: ch.properties().into(),
        data: 0,
    });
    let (mut parser, mut cluster) = (Parser::new(Script::Latin, tokens), CharCluster::new());
    let mut found: Vec<(Face, std::ops::Range<usize>)> = Vec::new();
    while parser.next(&mut cluster) {
        let mut has_all = |face: Face| {
            let charmap = face.font().charmap();
            cluster.map(|c| charmap.map(c)) == Status::Complete
        };
        let face = if !has_all(first) && has_all(fallback) { fallback } else { first };
        let range = cluster.range().to_range();
        match found.last_mut() {
            Some((last, of_run)) if *last == face => of_run.end = range.end,
            _ => found.push((face, range)),
        }
    }
    found.into_iter().map(|(face, range)| (face, &text[range])).collect()
}
