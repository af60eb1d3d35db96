//! Fonts for SVG: of the program's fonts the glyphs that a page has, each named by the character that it stands for.
//!
//! Which glyph a character has depends on how a text is set: figures of one width, letters that change beside others. A reader of an SVG
//! does not know that; so a character of two glyphs has each in a font of its own, and the text says which.

use std::collections::BTreeMap;

use subsetter::GlyphRemapper;
use swash::{FontRef, StringId};

use crate::render::text::fonts::Face;

/// A font of a page: the number of its file, and which of the glyphs of one character it has.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Family {
    file: usize,
    variant: usize,
}

impl Family {
    /// Its name in the page; no part of it begins with a figure, which names in style sheets must not.
    pub fn name(self) -> String {
        const NAMES: [&str; Face::FILES] = ["Inter", "Inter SemiBold", "Noto Sans CJK"];
        match self.variant {
            0 => format!("Veduta {}", NAMES[self.file]),
            variant => {
                let letter = char::from(b'A' + (variant % 26) as u8);
                format!("Veduta {} {}", NAMES[self.file], String::from(letter).repeat(variant / 26 + 1))
            }
        }
    }
}

/// The fonts of a page.
#[derive(Debug, Default)]
pub struct Fonts {
    /// The glyphs of characters.
    glyphs: BTreeMap<Family, BTreeMap<char, u16>>,
}

/// A font as a file.
#[derive(Clone, Debug)]
pub struct FontFile {
    /// Its family's name.
    pub name: String,
    /// Whether its outlines are those of PostScript.
    pub is_cff: bool,
    /// The file.
    pub data: Vec<u8>,
}

impl Fonts {
    /// The family in which a character is this glyph of a face.
    pub fn family(&mut self, face: Face, character: char, glyph: u16) -> Family {
        let mut family = Family { file: face.file(), variant: 0 };
        loop {
            let own = self.glyphs.entry(family).or_default();
            if *own.entry(character).or_insert(glyph) == glyph {
                return family;
            }
            family.variant += 1;
        }
    }

    /// All as files.
    pub fn files(&self) -> Result<Vec<FontFile>, String> {
        self.glyphs.iter().map(|(family, glyphs)| file(*family, glyphs)).collect()
    }
}

fn file(family: Family, glyphs: &BTreeMap<char, u16>) -> Result<FontFile, String> {
    let whole = Face::data_of(family.file);
    let mut mapper = GlyphRemapper::new();
    let characters: Vec<(u32, u16)> = glyphs.iter().map(|(c, id)| (u32::from(*c), mapper.remap(*id))).collect();
    let subset =
        subsetter::subset(whole, 0, &mapper).map_err(|error| format!("a font cannot be made smaller: {error}"))?;
    let mut tables = tables_of(&subset).ok_or("a font cannot be read")?;
    let os2 = tables_of(whole).and_then(|all| all.get(b"OS/2").cloned());
    tables.extend(os2.map(|table| (*b"OS/2", table)));
    tables.insert(*b"cmap", character_map(&characters));
    let name = family.name();
    let copyright = FontRef::from_index(whole, 0).and_then(|font| {
        let said = font.localized_strings().find_by_id(StringId::Copyright, None)?;
        Some(said.chars().collect::<String>())
    });
    tables.insert(*b"name", name_table(&name, &copyright.unwrap_or_default()));
    tables.insert(*b"post", [&[0, 3, 0, 0][..], &[0; 28]].concat());
    let is_cff = tables.contains_key(b"CFF ");
    Ok(FontFile { name, is_cff, data: assembled(&tables, is_cff) })
}

type Tables = BTreeMap<[u8; 4], Vec<u8>>;

/// The tables of a font file; `None`: it is none.
fn tables_of(font: &[u8]) -> Option<Tables> {
    let number = |at: usize| Some(u32::from_be_bytes(font.get(at..at + 4)?.try_into().ok()?) as usize);
    let count = usize::from(u16::from_be_bytes(font.get(4..6)?.try_into().ok()?));
    let table = |i: usize| {
        let entry = 12 + 16 * i;
        let (start, length) = (number(entry + 8)?, number(entry + 12)?);
        Some((font.get(entry..entry + 4)?.try_into().ok()?, font.get(start..start.checked_add(length)?)?.to_vec()))
    };
    (0..count).map(table).collect()
}

/// A `cmap` of one table of format 12: a range for each character.
fn character_map(characters: &[(u32, u16)]) -> Vec<u8> {
    let mut table = [0_u16, 1, 3, 10, 0, 12, 12, 0].map(u16::to_be_bytes).concat();
    let count = characters.len() as u32;
    for number in [16 + 12 * count, 0, count] {
        table.extend(number.to_be_bytes());
    }
    for (character, glyph) in characters {
        for number in [*character, *character, u32::from(*glyph)] {
            table.extend(number.to_be_bytes());
        }
    }
    table
}

/// A `name`: whose it is, its family, `Regular`, its whole name and the one that PostScript has.
fn name_table(family: &str, copyright: &str) -> Vec<u8> {
    let plain: String = family.chars().filter(|c| *c != ' ').collect();
    let names: [(u16, &str); 5] = [(0, copyright), (1, family), (2, "Regular"), (4, family), (6, &plain)];
    let mut strings = Vec::new();
    let mut table = [0, names.len() as u16, 6 + 12 * names.len() as u16].map(u16::to_be_bytes).concat();
    for (id, text) in names {
        let bytes: Vec<u8> = text.encode_utf16().flat_map(u16::to_be_bytes).collect();
        let record = [3, 1, 0x409, id, bytes.len() as u16, strings.len() as u16];
        table.extend(record.map(u16::to_be_bytes).concat());
        strings.extend(bytes);
    }
    table.extend(strings);
    table
}

/// A font file of these tables.
fn assembled(tables: &Tables, is_cff: bool) -> Vec<u8> {
    let count = tables.len() as u16;
    let log = count.max(1).ilog2() as u16;
    let search = 16 << log;
    let mut file = if is_cff { b"OTTO".to_vec() } else { vec![0, 1, 0, 0] };
    file.extend([count, search, log, 16 * count - search].map(u16::to_be_bytes).concat());
    let mut start = 12 + 16 * tables.len();
    let mut adjustment = None;
    for (tag, table) in tables {
        let mut table = table.clone();
        if tag == b"head" && table.len() >= 12 {
            table[8..12].fill(0);
            adjustment = Some(start + 8);
        }
        file.extend(tag);
        for number in [checksum(&table), start as u32, table.len() as u32] {
            file.extend(number.to_be_bytes());
        }
        start += table.len().next_multiple_of(4);
    }
    for (tag, table) in tables {
        let from = file.len();
        file.extend(table);
        if tag == b"head" && table.len() >= 12 {
            file[from + 8..from + 12].fill(0);
        }
        file.resize(file.len().next_multiple_of(4), 0);
    }
    if let Some(at) = adjustment {
        let value = 0xb1b0_afba_u32.wrapping_sub(checksum(&file));
        file[at..at + 4].copy_from_slice(&value.to_be_bytes());
    }
    file
}

/// The sum of the words of a table.
fn checksum(table: &[u8]) -> u32 {
    let word = |bytes: &[u8]| {
        let mut word = [0; 4];
        word[..bytes.len()].copy_from_slice(bytes);
        u32::from_be_bytes(word)
    };
    table.chunks(4).map(word).fold(0, u32::wrapping_add)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::text::Weight;

    #[test]
    fn a_character_of_two_glyphs_has_two_families() {
        let mut fonts = Fonts::default();
        let face = Face::First(Weight::Regular);
        let glyph = |c: char| face.font().charmap().map(c);
        let (one, a) = (glyph('1'), glyph('a'));
        let plain = fonts.family(face, '1', one);
        assert_eq!(fonts.family(face, 'a', a), plain);
        let other = fonts.family(face, '1', a);
        assert_eq!((other.variant, fonts.family(face, '1', one), fonts.family(face, '1', a)), (1, plain, other));
        let files = fonts.files().unwrap();
        assert_eq!(files.iter().map(|f| f.name.as_str()).collect::<Vec<_>>(), ["Veduta Inter", "Veduta Inter B"]);
        for (file, [of_one, of_a]) in files.iter().zip([[one, a], [a, 0]]) {
            assert_eq!(checksum(&file.data), 0xb1b0_afba);
            let font = FontRef::from_index(&file.data, 0).expect("a font");
            let whole = face.font();
            for (c, id) in [('1', of_one), ('a', of_a)] {
                let own = font.charmap().map(c);
                let widths = [font.glyph_metrics(&[]).advance_width(own), whole.glyph_metrics(&[]).advance_width(id)];
                assert!((own > 0) == (id > 0) && widths[0] == widths[1], "{c}: {own} {id} {widths:?}");
            }
            let said = font.localized_strings().find_by_id(StringId::Copyright, None).expect("whose it is");
            assert!(said.chars().collect::<String>().contains("Inter Project Authors"));
        }
    }

    #[test]
    fn outlines_of_both_kinds_survive() {
        let mut fonts = Fonts::default();
        let faces = [(Face::First(Weight::SemiBold), 'Ä'), (Face::Fallback(Weight::Regular), '京')];
        for (face, c) in faces {
            fonts.family(face, c, face.font().charmap().map(c));
        }
        let files = fonts.files().unwrap();
        assert_eq!(files.iter().map(|f| f.is_cff).collect::<Vec<_>>(), [false, true]);
        for (file, (face, c)) in files.iter().zip(faces) {
            assert!(file.data.len() < 40_000, "{}", file.data.len());
            let font = FontRef::from_index(&file.data, 0).expect("a font");
            let outline = |font: FontRef, id: u16| {
                let mut context = swash::scale::ScaleContext::new();
                let mut scaler = context.builder(font).size(100.0).hint(false).build();
                let outline = scaler.scale_outline(id).expect("an outline");
                outline.points().iter().map(|p| [p.x, p.y].map(|v| v.round() as i32)).collect::<Vec<_>>()
            };
            assert_eq!(outline(font, font.charmap().map(c)), outline(face.font(), face.font().charmap().map(c)), "{c}");
        }
    }
}
