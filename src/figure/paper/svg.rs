//! A page as SVG, with its pixels as PNG and its fonts in it.

use base64::{Engine, engine::general_purpose::STANDARD};

use crate::{
    figure::paper::{
        Page, Told,
        marks::{Mark, Raster, SetText, Step},
        png,
        web_font::{Family, Fonts},
    },
    lens::color::{Srgb, to_hex},
    render::text::GlyphRun,
    scene::MM_PER_INCH,
};

/// The file; the same of the same page.
pub fn text(page: &Page, told: &Told) -> Result<String, String> {
    let [width, height] = page.size;
    let [wide, high] = page.size.map(|side| number(f64::from(side) / told.dots() * MM_PER_INCH));
    let mut fonts = Fonts::default();
    let mut body = String::new();
    for mark in &page.marks {
        match mark {
            Mark::Raster(raster) => body += &image(raster)?,
            Mark::Fill(fill) => {
                let (path, color) = (path(&fill.outline), to_hex(fill.color));
                body += &format!("<path d=\"{path}\" fill=\"{color}\"{}/>\n", opacity("fill-opacity", fill.opacity));
            }
            Mark::Text(text) => body += &lines(text, &mut fonts),
        }
    }
    let mut svg = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{wide}mm\" height=\"{high}mm\" \
         viewBox=\"0 0 {width} {height}\">\n"
    );
    if let Some(title) = told.title {
        svg += &format!("<title>{}</title>\n", escaped(title));
    }
    let notes: Vec<String> = told.notes.texts.iter().map(|(key, value)| format!("{key}: {value}")).collect();
    svg += &format!("<metadata>{}</metadata>\n", escaped(&notes.join("; ")));
    svg += "<style>\n";
    for font in fonts.files()? {
        let (kind, format) = if font.is_cff { ("otf", "opentype") } else { ("ttf", "truetype") };
        let data = STANDARD.encode(&font.data);
        svg += &format!(
            "@font-face {{ font-family: \"{}\"; src: url(\"data:font/{kind};base64,{data}\") format(\"{format}\"); }}\n",
            font.name
        );
    }
    svg += "</style>\n";
    svg += &body;
    svg += "</svg>\n";
    Ok(svg)
}

fn image(raster: &Raster) -> Result<String, String> {
    let ([x, y], [width, height]) = (raster.at, raster.size);
    let data = STANDARD.encode(png(raster)?);
    Ok(format!(
        "<image x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" href=\"data:image/png;base64,{data}\"/>\n"
    ))
}

fn path(outline: &[Step]) -> String {
    let at = |[x, y]: [f32; 2]| format!("{} {}", number(x.into()), number(y.into()));
    let step = |step: &Step| match *step {
        Step::Move(to) => format!("M{}", at(to)),
        Step::Line(to) => format!("L{}", at(to)),
        Step::Curve([a, b, to]) => format!("C{} {} {}", at(a), at(b), at(to)),
        Step::Close => "Z".to_owned(),
    };
    outline.iter().map(step).collect()
}

/// A line of text: an element for each font. What surrounds its letters stands below all of them, and is no second text.
fn lines(text: &SetText, fonts: &mut Fonts) -> String {
    let (mut below, mut all) = (String::new(), String::new());
    let map = text.map.map(|map| map.to_cols_array().map(|v| number(v.into())).join(" "));
    let map = map.map_or_else(String::new, |map| format!(" transform=\"matrix({map})\""));
    for run in text.runs.iter().filter(|run| !run.glyphs.is_empty()) {
        let weight = run.face.emboldened_em() * run.size_px;
        let color = to_hex(text.color);
        let around = |color: Srgb, share: f32, width: f32| {
            let width = number(width.into());
            let share = opacity("stroke-opacity", share);
            format!(" stroke=\"{}\"{share} stroke-width=\"{width}\" stroke-linejoin=\"round\"", to_hex(color))
        };
        let halo = text.halo.map(|halo| around(halo.color, halo.opacity, 2.0 * halo.width_px + weight));
        let heavier = if weight > 0.0 { around(text.color, 1.0, weight) } else { String::new() };
        for (family, chunk) in chunks(run, fonts) {
            let (size, name) = (number(run.size_px.into()), family.name());
            let start = format!("<text xml:space=\"preserve\" font-family=\"'{name}'\" font-size=\"{size}\"{map}");
            if let Some(halo) = &halo {
                below += &format!(
                    "{start} fill=\"none\"{halo} aria-hidden=\"true\" style=\"user-select: none\" {chunk}</text>\n"
                );
            }
            all += &format!("{start} fill=\"{color}\"{heavier} {chunk}</text>\n");
        }
    }
    below + &all
}

/// The parts of a run that are of one family, each with the places of its characters: what stands between `<text` and `</text>`.
fn chunks(run: &GlyphRun, fonts: &mut Fonts) -> Vec<(Family, String)> {
    let mut parts: Vec<(Family, f32, Vec<f32>, String)> = Vec::new();
    for (i, glyph) in run.glyphs.iter().enumerate() {
        let source = run.text.get(glyph.source.clone()).unwrap_or_default();
        let mut characters = source.chars();
        let is_next_of_cluster = i > 0 && run.glyphs[i - 1].source == glyph.source;
        // A letter of several glyphs is written once; one of several characters has its glyph at the first of them.
        let Some(first) = characters.next().filter(|_| !is_next_of_cluster) else { continue };
        let family = fonts.family(run.face, first, glyph.id);
        let is_simple = characters.next().is_none() && u32::from(first) < 0x10000;
        match parts.last_mut() {
            Some((own, y, xs, text))
                if *own == family && is_simple && *y == glyph.at[1] && xs.len() == text.chars().count() =>
            {
                xs.push(glyph.at[0]);
                text.push(first);
            }
            _ => parts.push((family, glyph.at[1], vec![glyph.at[0]], source.to_owned())),
        }
    }
    let part = |(family, y, xs, text): (Family, f32, Vec<f32>, String)| {
        let xs: Vec<String> = xs.iter().map(|x| number((*x).into())).collect();
        (family, format!("x=\"{}\" y=\"{}\">{}", xs.join(" "), number(y.into()), escaped(&text)))
    };
    parts.into_iter().map(part).collect()
}

/// An attribute that says how much is seen, where that is not all.
fn opacity(name: &str, share: f32) -> String {
    if share < 1.0 { format!(" {name}=\"{}\"", number((share.max(0.0)).into())) } else { String::new() }
}

/// A number with at most four decimals.
fn number(value: f64) -> String {
    let text = format!("{value:.4}");
    let short = text.trim_end_matches('0').trim_end_matches('.');
    if short == "-0" { "0".to_owned() } else { short.to_owned() }
}

/// Text as XML has it.
fn escaped(text: &str) -> String {
    let mut all = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => all.push_str("&amp;"),
            '<' => all.push_str("&lt;"),
            '>' => all.push_str("&gt;"),
            '"' => all.push_str("&quot;"),
            // What XML has no place for.
            c if (c.is_control() && c != '\n') || matches!(c, '\u{fffe}' | '\u{ffff}') => all.push(' '),
            c => all.push(c),
        }
    }
    all
}
