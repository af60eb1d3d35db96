//! A small SVG writer: the few shapes a plot is made of. Lengths are CSS pixels, y grows downwards.

use std::fmt::Write as _;

/// The family of all text; the rasteriser has the first, other programs may take the next they know.
const FONTS: &str = "Inter, Helvetica Neue, Arial, sans-serif";

/// A drawing.
#[derive(Clone, Debug)]
pub struct Svg {
    size: [f64; 2],
    body: String,
}

/// The alignment of a text at its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// It begins there.
    Start,
    /// It is centred there.
    Middle,
    /// It ends there.
    End,
}

/// The look of a text.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Font {
    /// Height, pixels.
    pub size: f64,
    /// Semi-bold instead of regular.
    pub is_strong: bool,
    /// `#rrggbb`.
    pub color: &'static str,
}

/// The look of a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stroke {
    /// `#rrggbb`.
    pub color: &'static str,
    /// Pixels.
    pub width: f64,
    /// Lengths of dashes and gaps; empty: none.
    pub dashes: &'static str,
}

/// The shape of a point; each is told apart in grey as well.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Marker {
    /// ●
    Circle,
    /// ■
    Square,
    /// ▲
    Triangle,
    /// ◆
    Diamond,
}

impl Svg {
    /// A white page.
    pub fn new(size: [f64; 2], title: &str, description: &str) -> Self {
        let [w, h] = size;
        let body = format!(
            "<title>{}</title>\n<desc>{}</desc>\n<rect width=\"{w}\" height=\"{h}\" fill=\"#ffffff\"/>\n",
            escaped(title),
            escaped(description)
        );
        Self { size, body }
    }

    /// The whole file.
    pub fn finish(self) -> String {
        let [w, h] = self.size;
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{w}\" height=\"{h}\" viewBox=\"0 0 {w} {h}\" role=\"img\" \
             font-family=\"{FONTS}\">\n{}</svg>\n",
            self.body
        )
    }

    /// A line through points; through one there is none.
    pub fn line(&mut self, points: &[[f64; 2]], stroke: Stroke) {
        if points.len() < 2 {
            return;
        }
        let list: Vec<String> = points.iter().map(|[x, y]| format!("{x:.2},{y:.2}")).collect();
        let dashes = match stroke.dashes {
            "" => String::new(),
            dashes => format!(" stroke-dasharray=\"{dashes}\""),
        };
        let _ = writeln!(
            self.body,
            "<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{}\" stroke-linejoin=\"round\" \
             stroke-linecap=\"butt\"{dashes}/>",
            list.join(" "),
            stroke.color,
            stroke.width
        );
    }

    /// A point; hollow unless filled.
    pub fn marker(&mut self, [x, y]: [f64; 2], marker: Marker, color: &str, is_filled: bool) {
        let fill = if is_filled { color } else { "#ffffff" };
        let polygon = |corners: &[[f64; 2]]| {
            let list: Vec<String> = corners.iter().map(|[dx, dy]| format!("{:.2},{:.2}", x + dx, y + dy)).collect();
            format!("<polygon points=\"{}\"", list.join(" "))
        };
        // Of equal area, by eye.
        let shape = match marker {
            Marker::Circle => format!("<circle cx=\"{x:.2}\" cy=\"{y:.2}\" r=\"4.5\""),
            Marker::Square => polygon(&[[-4.0, -4.0], [4.0, -4.0], [4.0, 4.0], [-4.0, 4.0]]),
            Marker::Triangle => polygon(&[[0.0, -5.5], [5.2, 3.8], [-5.2, 3.8]]),
            Marker::Diamond => polygon(&[[0.0, -5.8], [5.8, 0.0], [0.0, 5.8], [-5.8, 0.0]]),
        };
        let _ = writeln!(self.body, "{shape} fill=\"{fill}\" stroke=\"{color}\" stroke-width=\"1.6\"/>");
    }

    /// A line of text; `at` is on its base line. A white rim keeps it readable over lines.
    pub fn text(&mut self, at: [f64; 2], anchor: Anchor, font: Font, text: &str) {
        let anchor = match anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        let weight = if font.is_strong { 600 } else { 400 };
        let common = format!(
            "x=\"{:.2}\" y=\"{:.2}\" text-anchor=\"{anchor}\" font-size=\"{}\" font-weight=\"{weight}\"",
            at[0], at[1], font.size
        );
        let _ = writeln!(
            self.body,
            "<text {common} fill=\"{0}\" stroke=\"#ffffff\" stroke-width=\"3\" stroke-linejoin=\"round\" \
             paint-order=\"stroke\">{1}</text>",
            font.color,
            escaped(text)
        );
    }
}

/// About how wide a text is, pixels: Inter's letters are 0.56 of their size wide on average.
pub fn text_width(text: &str, size: f64) -> f64 {
    text.chars().count() as f64 * 0.56 * size
}

/// Text that XML takes for text; characters it does not allow at all are left out.
fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out += "&amp;",
            '<' => out += "&lt;",
            '>' => out += "&gt;",
            '"' => out += "&quot;",
            '\t' | '\n' | '\r' => out.push(' '),
            c if c.is_control() || c == '\u{fffe}' || c == '\u{ffff}' => {}
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_text_makes_well_formed_xml() {
        let nasty = "a<b & \"c\"> ]]> \u{0}\u{1b}[1m\u{ffff} é 建";
        let mut svg = Svg::new([10.0, 10.0], nasty, nasty);
        svg.text([1.0, 2.0], Anchor::Middle, Font { size: 10.0, is_strong: false, color: "#000000" }, nasty);
        let text = svg.finish();
        let document = resvg::usvg::roxmltree::Document::parse(&text).unwrap();
        let title = document.descendants().find(|n| n.has_tag_name("title")).and_then(|n| n.text().map(str::to_owned));
        assert_eq!(title.unwrap(), "a<b & \"c\"> ]]> [1m é 建");
    }
}
