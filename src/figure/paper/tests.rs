use std::{collections::BTreeMap, io::Read};

use flate2::read::ZlibDecoder;
use resvg::{tiny_skia, usvg};

use super::*;
use crate::render::{
    furniture::{Panel, Piece},
    text::{Halo, TextLine, TextStyle, Typesetter, Weight},
};

const SIZE: [u32; 2] = [320, 200];

/// Colours that no format may touch.
fn pixels() -> Vec<[u8; 4]> {
    let pixel = |i: u32| {
        let mixed = i.wrapping_mul(2_654_435_761).rotate_left(11);
        [mixed as u8, (mixed >> 8) as u8, (mixed >> 16) as u8, 255]
    };
    (0..SIZE[0] * SIZE[1]).map(pixel).collect()
}

fn line(text: &str, at: [f32; 2], weight: Weight, tabular: bool) -> TextLine {
    TextLine {
        text: text.into(),
        at,
        style: TextStyle { size_px: 20.0, weight, tabular },
        color: [0.1, 0.1, 0.2],
        halo: None,
    }
}

/// Texts of all fonts, two of them with figures of other widths, and one with a halo.
fn texts() -> Vec<TextLine> {
    let halo = Some(Halo { color: [1.0; 3], width_px: 3.0, opacity: 0.85 });
    vec![
        line("A <title> & \"more\"", [30.0, 60.0], Weight::SemiBold, false),
        line("1111 and 2020", [30.0, 90.0], Weight::Regular, false),
        line("1111 AVAVA 3x4", [30.0, 120.0], Weight::Regular, true),
        line("東京 Tokyo", [30.0, 150.0], Weight::SemiBold, false),
        TextLine { halo, ..line("fine é", [190.0, 150.0], Weight::Regular, false) },
    ]
}

fn page() -> Page {
    let card = Panel {
        low: [20.0, 30.0],
        high: [300.0, 170.0],
        color: [1.0; 3],
        opacity: 1.0,
        radius_px: 0.0,
        softness_px: 1.0,
        ellipse: false,
    };
    let pieces: Vec<Piece> = std::iter::once(Piece::Panel(card)).chain(texts().into_iter().map(Piece::Text)).collect();
    let picture = Mark::Raster(Raster { at: [0, 0], size: SIZE, rgba: pixels() });
    Page { size: SIZE, marks: std::iter::once(picture).chain(marks::of(&pieces)).collect() }
}

fn notes(dpi: Option<f64>) -> Notes {
    Notes { dpi, ..picture::notes(Some(0xabcd)) }
}

fn written(format: Format) -> Vec<u8> {
    let file = std::env::temp_dir().join(format!("veduta-page-{format:?}-{}", std::process::id()));
    let save = || {
        page().save(&file, format, &notes(Some(200.0)), Some("Of <all>")).unwrap();
        std::fs::read(&file).unwrap()
    };
    let bytes = save();
    assert_eq!(bytes, save(), "the same page is the same bytes");
    std::fs::remove_file(&file).unwrap();
    bytes
}

/// What stands between two texts, wherever they come.
fn between<'t>(text: &'t str, start: &str, end: &str) -> Vec<&'t str> {
    text.split(start).skip(1).filter_map(|rest| rest.split_once(end).map(|(inside, _)| inside)).collect()
}

fn decoded(base64: &str) -> Vec<u8> {
    use base64::Engine;
    base64::engine::general_purpose::STANDARD.decode(base64).unwrap()
}

/// Ink of both, and ink that is in one alone.
fn compared(page: &[[u8; 4]], of: &TextLine) -> [f64; 2] {
    let run = Typesetter::default().rasterised(&TextLine { halo: None, ..of.clone() }, SIZE).unwrap();
    let (mut both, mut apart) = (0.0, 0.0);
    for (i, [ink, _]) in run.texels.iter().enumerate() {
        let [x, y] = [i as u32 % run.size[0] + run.origin[0], i as u32 / run.size[0] + run.origin[1]];
        let [r, ..] = page[(y * SIZE[0] + x) as usize];
        let seen = f64::from(255 - r) / 230.0;
        let expected = f64::from(*ink) / 255.0;
        both += expected;
        apart += (seen.min(1.0) - expected).abs();
    }
    [both, apart]
}

#[test]
fn svg_holds_the_pixels_and_its_text_as_text() {
    let svg = String::from_utf8(written(Format::Svg)).unwrap();
    assert!(svg.contains("width=\"40.64mm\" height=\"25.4mm\" viewBox=\"0 0 320 200\""), "at 200 dots per inch");
    assert!(svg.contains("<title>Of &lt;all&gt;</title>") && svg.contains("veduta:scene: 000000000000abcd"));
    let png = decoded(between(&svg, "data:image/png;base64,", "\"")[0]);
    let read = image::load_from_memory(&png).unwrap().into_rgba8();
    assert_eq!(bytemuck::cast_slice::<u8, [u8; 4]>(read.as_raw()), pixels());
    // All that is written, but for what surrounds letters.
    let said: Vec<&str> =
        between(&svg, "<text ", "</text>").into_iter().filter(|text| !text.contains("aria-hidden")).collect();
    let said: String = said.iter().filter_map(|text| text.split_once('>')).map(|(_, text)| text).collect();
    assert_eq!(said, "A &lt;title&gt; &amp; &quot;more&quot;1111 and 20201111 AVAVA 3x4東京 Tokyofine é");
    let parsed = usvg::roxmltree::Document::parse(&svg).expect("XML");
    assert_eq!(parsed.root_element().tag_name().name(), "svg");
}

#[test]
fn svg_looks_as_the_picture_does() {
    let svg = String::from_utf8(written(Format::Svg)).unwrap();
    let mut fonts = usvg::fontdb::Database::new();
    between(&svg, "base64,", "\") format").into_iter().for_each(|font| fonts.load_font_data(decoded(font)));
    assert_eq!(fonts.len(), 4, "both weights, figures of one width, and Japanese");
    let options = usvg::Options { fontdb: std::sync::Arc::new(fonts), ..usvg::Options::default() };
    let tree = usvg::Tree::from_str(&svg, &options).unwrap();
    let mut pixmap = tiny_skia::Pixmap::new(SIZE[0], SIZE[1]).unwrap();
    let scale = SIZE[0] as f32 / tree.size().width();
    resvg::render(&tree, tiny_skia::Transform::from_scale(scale, scale), &mut pixmap.as_mut());
    let seen: &[[u8; 4]] = bytemuck::cast_slice(pixmap.data());
    if let Some(folder) = std::env::var_os("VEDUTA_SHOW") {
        std::fs::write(Path::new(&folder).join("page.svg"), &svg).unwrap();
        picture::save_picture(&Path::new(&folder).join("page.png"), SIZE, seen, true, &Notes::default()).unwrap();
    }
    for line in texts() {
        let [both, apart] = compared(seen, &line);
        assert!(apart < 0.3 * both, "\"{}\": {apart} of {both}", line.text);
        // As it would be were it set elsewhere.
        let [.., wrong] = compared(seen, &TextLine { at: [line.at[0] + 5.0, line.at[1]], ..line });
        assert!(wrong > 1.5 * apart, "{apart} {wrong}");
    }
    let at = |x: u32, y: u32| seen[(y * SIZE[0] + x) as usize];
    assert_eq!(at(290, 40), [255; 4], "the card");
}

/// The streams of a PDF without object streams: their dictionaries and what is in them.
fn streams(pdf: &[u8]) -> Vec<(String, Vec<u8>)> {
    let find = |from: usize, what: &[u8]| pdf[from..].windows(what.len()).position(|w| w == what).map(|at| from + at);
    let (mut all, mut from) = (Vec::new(), 0);
    while let Some(start) = find(from, b"stream\n") {
        let end = find(start, b"endstream").unwrap();
        let head = pdf[..start].windows(2).rposition(|w| w == b"<<").unwrap();
        let mut data = Vec::new();
        let raw = &pdf[start + 7..end];
        if ZlibDecoder::new(raw).read_to_end(&mut data).is_err() {
            data = raw.to_vec();
        }
        all.push((String::from_utf8_lossy(&pdf[head..start]).into_owned(), data));
        from = end + 9;
    }
    all
}

/// The strings that a content stream shows, as codes of two bytes.
fn shown(content: &[u8]) -> Vec<Vec<u16>> {
    let (mut all, mut i) = (Vec::new(), 0);
    while i < content.len() {
        let mut bytes = Vec::new();
        match content[i] {
            b'(' => {
                i += 1;
                let mut depth = 1;
                while i < content.len() {
                    match content[i] {
                        b'\\' => {
                            i += 1;
                            let octal: String = content[i..]
                                .iter()
                                .take(3)
                                .take_while(|b| b.is_ascii_digit())
                                .map(|b| *b as char)
                                .collect();
                            match content[i] {
                                _ if !octal.is_empty() => {
                                    bytes.push(u32::from_str_radix(&octal, 8).unwrap() as u8);
                                    i += octal.len() - 1;
                                }
                                b'n' => bytes.push(b'\n'),
                                b'r' => bytes.push(b'\r'),
                                b't' => bytes.push(b'\t'),
                                b'b' => bytes.push(8),
                                b'f' => bytes.push(12),
                                other => bytes.push(other),
                            }
                        }
                        b'(' => {
                            depth += 1;
                            bytes.push(b'(');
                        }
                        b')' if depth == 1 => break,
                        b')' => {
                            depth -= 1;
                            bytes.push(b')');
                        }
                        other => bytes.push(other),
                    }
                    i += 1;
                }
            }
            b'<' if content.get(i + 1) != Some(&b'<') => {
                let hex: Vec<u8> = content[i + 1..].iter().copied().take_while(|b| *b != b'>').collect();
                i += hex.len() + 1;
                let pair = |pair: &[u8]| u8::from_str_radix(std::str::from_utf8(pair).ok()?, 16).ok();
                bytes = hex.chunks(2).filter_map(pair).collect();
            }
            _ => {}
        }
        if !bytes.is_empty() {
            all.push(bytes.chunks_exact(2).map(|b| u16::from_be_bytes([b[0], b[1]])).collect());
        }
        i += 1;
    }
    all
}

#[test]
fn pdf_holds_the_pixels_and_its_text_as_text() {
    let pdf = written(Format::Pdf);
    let plain = String::from_utf8_lossy(&pdf).into_owned();
    assert!(plain.contains("/MediaBox[0 0 115.2 72]"), "320 x 200 pixels at 200 dots per inch are 1.6 x 1 inches");
    assert!(
        plain.contains(concat!("/Creator(Veduta ", env!("CARGO_PKG_VERSION"), ")"))
            && plain.contains("veduta:scene=000000000000abcd")
    );
    assert!(!plain.contains("/CreationDate") && !plain.contains("/ModDate") && plain.contains("/FontFile"));
    let streams = streams(&pdf);
    let (_, rgb) = streams.iter().find(|(head, _)| head.contains("/Subtype/Image")).expect("a picture");
    let expected: Vec<u8> = pixels().iter().flat_map(|[r, g, b, _]| [*r, *g, *b]).collect();
    assert!(*rgb == expected, "the picture is as it was");
    let maps: Vec<BTreeMap<u16, String>> = streams
        .iter()
        .filter(|(head, _)| head.contains("/Type/CMap"))
        .map(|(_, map)| {
            let map = String::from_utf8_lossy(map).into_owned();
            let pair = |line: &str| {
                let (code, text) = line.strip_prefix('<')?.strip_suffix('>')?.split_once("> <")?;
                let units: Option<Vec<u16>> = text
                    .as_bytes()
                    .chunks(4)
                    .map(|hex| u16::from_str_radix(std::str::from_utf8(hex).ok()?, 16).ok())
                    .collect();
                Some((u16::from_str_radix(code, 16).ok()?, String::from_utf16_lossy(&units?)))
            };
            between(&map, "beginbfchar", "endbfchar").join("\n").lines().filter_map(pair).collect()
        })
        .collect();
    assert_eq!(maps.len(), 3, "both weights and Japanese");
    let (_, content) = streams.iter().find(|(_, data)| data.windows(3).any(|w| w == b" Tf")).expect("text");
    let codes: Vec<u16> = shown(content).concat();
    let said: Vec<String> =
        maps.iter().map(|map| codes.iter().map(|code| map.get(code).map_or("?", String::as_str)).collect()).collect();
    for wanted in ["A <title> & \"more\"", "1111 and 2020", "1111 AVAVA 3x4", "東京", " Tokyo", "fine é"] {
        assert!(said.iter().any(|text| text.contains(wanted)), "\"{wanted}\" in {said:?}");
    }
}

#[test]
fn formats_go_by_the_name() {
    let of = |name: &str| Format::of(Path::new(name));
    assert_eq!(
        [of("a.png"), of("-"), of("b/a.PDF"), of("a.svg")].map(Result::unwrap),
        [Format::Png, Format::Png, Format::Pdf, Format::Svg]
    );
    assert_eq!(of("a.jpg").unwrap_err(), "a.jpg: .jpg cannot be written; .png, .pdf or .svg would be right");
    assert_eq!(of("a").unwrap_err(), "a: names no format; .png, .pdf or .svg would be right");
}
