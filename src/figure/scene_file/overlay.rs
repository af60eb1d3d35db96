//! `[[overlay]]` and `[layout]` in scene files: their keys, read and written.

use crate::{
    figure::scene_file::{
        check::Fields,
        keys::{Kind, Table, key},
        node::{Data, Node},
        paths::Options,
        write::{degrees, number, quoted, write_color},
    },
    scene::overlay::{
        Along, BuiltInFrame, CallOut, ContextLine, Frame, Layout, LineEnd, LineKind, Outside, Overlay, Sizes, Stand,
    },
};

const fn words<T: Copy, const N: usize>(all: &[(&'static str, T); N]) -> [&'static str; N] {
    let mut words = [""; N];
    let mut i = 0;
    while i < N {
        words[i] = all[i].0;
        i += 1;
    }
    words
}

const FRAMES: [&str; 6] = words(&BuiltInFrame::WORDS);
const LINES: [&str; 3] = words(&LineKind::WORDS);
const ENDS: [&str; 2] = words(&LineEnd::WORDS);
const OUTSIDE: [&str; 2] = words(&Outside::WORDS);
const ALONG: [&str; 6] = words(&Along::WORDS);
const SIZES: [&str; 3] = words(&Sizes::WORDS);

/// `[[overlay]]`.
pub const OVERLAY: Table = Table {
    name: "overlay",
    doc: "How the picture of a best-view lens stands over the main one. A lens of such a kind without a table here has one with every key at \
          its default.",
    keys: &[
        key("lens", Kind::Text, "", "", "The name of its lens.", "\"cathedral\""),
        key(
            "priority",
            Kind::Number { min: -1e6, max: 1e6 },
            "0.0",
            "",
            "Where there is not room for all, higher ones stay larger; the lowest become markers.",
            "1.0",
        ),
        key(
            "interest",
            Kind::Number { min: 0.0, max: 1.0 },
            "0.5",
            "",
            "How large it gets where `[layout]` has `size = \"interest\"`: 0 the smallest, 1 the largest size.",
            "1.0",
        ),
        key(
            "at",
            Kind::PicturePlace,
            "where the layout puts it",
            "",
            "A place of its own: where its middle is, as shares of the picture's width and height from the upper left. It keeps its `size`, as far as the picture holds that, and the margin to the border; the others leave it free. Of two that overlap, the one whose lens comes later lies in front.",
            "[0.5, 0.4]",
        ),
        key(
            "call_out",
            Kind::Table(&CALL_OUT),
            "none: it lies in the plane of the picture",
            "",
            "Has it stand in the scene, as a tilted board above its first point of interest; see Best-view lenses. Either this or `at`.",
            "{ tilt_deg = 30.0 }",
        ),
        key("size", Kind::Size, "[240, 160]", "pixels", "Its preferred size.", "[320, 200]"),
        key(
            "min",
            Kind::Size,
            "half of `size`; a card of text keeps its size",
            "pixels",
            "It is made no smaller.",
            "[120, 80]",
        ),
        key("max", Kind::Size, "one and a half of `size`", "pixels", "It is made no larger.", "[480, 300]"),
        key(
            "opacity",
            Kind::Number { min: 0.0, max: 1.0 },
            "1.0",
            "",
            "How much of the picture below it hides.",
            "0.8",
        ),
        key(
            "frame",
            Kind::WordOrTable(&FRAMES, &FRAME),
            "\"rounded\"",
            "",
            "What is cut out of it and laid over it: a frame that is built in, or images.",
            "\"print\"",
        ),
        key("caption", Kind::Text, "none", "", "A line of text below what it shows.", "\"Town hall, 1893\""),
        key(
            "line",
            Kind::WordOrTable(&["none", LINES[0], LINES[1], LINES[2]], &LINE),
            "\"straight\"",
            "",
            "The context lines from it to its points of interest: how they run, or a table that says more; `none`: it has none.",
            "{ kind = \"curved\", to = \"area\" }",
        ),
    ],
};

/// `call_out` of an overlay.
pub const CALL_OUT: Table = Table {
    name: "call_out",
    doc: "A board in the scene that shows an overlay, in perspective, turned to the viewer about the vertical axis. Its frame and its text are on it, as large beside what it shows as they are in an overlay of `size` pixels. Nothing of the city hides it.",
    keys: &[
        key(
            "height_m",
            Kind::Number { min: 0.0, max: 1e5 },
            "an eighth of the heights of the object and of the board",
            "m",
            "From the top of the object, or from the point, to the lower edge.",
            "15.0",
        ),
        key(
            "width_m",
            Kind::Number { min: 1e-3, max: 1e5 },
            "as wide in the picture as `size`",
            "m",
            "How wide it is.",
            "40.0",
        ),
        key(
            "tilt_deg",
            Kind::Number { min: -90.0, max: 90.0 },
            "30.0",
            "degrees",
            "How far its upper edge is tilted away from the viewer: 0 stands upright, 90 lies flat.",
            "45.0",
        ),
    ],
};

/// `frame` of an overlay.
pub const FRAME: Table = Table {
    name: "frame",
    doc: "Masks of an overlay: images, stretched over it.",
    keys: &[
        key("alpha", Kind::Text, "none: all is seen", "", "What of it is seen: white yes, black no.", "\"alpha.png\""),
        key(
            "frame",
            Kind::Text,
            "none",
            "",
            "What is laid over it; what shows is where this is transparent.",
            "\"frame.png\"",
        ),
    ],
};

/// `line` of an overlay.
pub const LINE: Table = Table {
    name: "line",
    doc: "Context lines: how an overlay is tied to its points of interest.",
    keys: &[
        key(
            "kind",
            Kind::Word { now: &LINES, later: &[] },
            "\"straight\"",
            "",
            "How they run: straight, along the sides of the picture, or in a curve.",
            "\"orthogonal\"",
        ),
        key("color", Kind::Color, "the lens colour", "", "Their colour.", "\"#333333\""),
        key(
            "width",
            Kind::Number { min: 0.0, max: 200.0 },
            "6.0",
            "pixels",
            "How wide they are at the overlay.",
            "10.0",
        ),
        key(
            "end_width",
            Kind::Number { min: 0.0, max: 200.0 },
            "1.5",
            "pixels",
            "How wide they are at the place.",
            "2.0",
        ),
        key(
            "skin",
            Kind::Text,
            "one colour",
            "",
            "An image along them, with alpha; its left end is at the overlay.",
            "\"skin.png\"",
        ),
        key(
            "to",
            Kind::Word { now: &ENDS, later: &[] },
            "\"point\"",
            "",
            "What they end at: the middle of the place, or the outline of its object, which is then drawn.",
            "\"area\"",
        ),
        key(
            "outside",
            Kind::Word { now: &OUTSIDE, later: &[] },
            "\"arrow\"",
            "",
            "What is drawn for a place that is out of the picture or behind the eye: an arrow at the border, or nothing.",
            "\"hidden\"",
        ),
        key(
            "arrow_distance",
            Kind::Number { min: 0.0, max: 1e9 },
            "never",
            "m",
            "For a place that is farther from the eye than this an arrow at the overlay takes the place of the line.",
            "500.0",
        ),
        key(
            "fade",
            Kind::PlanLengths,
            "none",
            "pixels",
            "`[inner, outer]`: lines fade out towards the middle of the picture, from the outer radius to the inner one, within which they are not seen.",
            "[60, 200]",
        ),
    ],
};

/// `[layout]`.
pub const LAYOUT: Table = Table {
    name: "layout",
    doc: "Where overlays stand that have no place of their own. They never overlap, and leave free the points of interest that they can leave free.",
    keys: &[
        key(
            "along",
            Kind::Word { now: &ALONG, later: &[] },
            "\"border\"",
            "",
            "In a row at the `top` or the `bottom`, in a column on the `left` or the `right`, in two columns (`sides`), or all around the `border`.",
            "\"right\"",
        ),
        key(
            "size",
            Kind::Word { now: &SIZES, later: &[] },
            "\"preferred\"",
            "",
            "What their sizes go by, between `min` and `max` of each: their preferred size, how near their places are (`distance`), or their `interest`.",
            "\"distance\"",
        ),
        key(
            "exploration_focus",
            Kind::Boolean,
            "false",
            "",
            "The overlay whose place is nearest to the middle of the picture stands in the middle of its row.",
            "true",
        ),
        key(
            "margin",
            Kind::Number { min: 0.0, max: 4096.0 },
            "16.0",
            "pixels",
            "To the border of the picture.",
            "24.0",
        ),
        key("gap", Kind::Number { min: 0.0, max: 4096.0 }, "12.0", "pixels", "Between overlays.", "8.0"),
    ],
};

fn of_word<T: Copy + Default>(all: &[(&str, T)], word: Option<&str>) -> T {
    all.iter().find(|(w, _)| word == Some(*w)).map_or_else(T::default, |(_, value)| *value)
}

fn word_of<T: PartialEq>(all: &[(&'static str, T)], value: &T) -> String {
    quoted(all.iter().find(|(_, v)| v == value).map_or("", |(word, _)| word))
}

fn size(node: &Node) -> Option<[u32; 2]> {
    node.numbers::<2>().map(|size| size.map(|side| side as u32))
}

/// The layout.
pub fn layout(fields: &Fields) -> Layout {
    let default = Layout::default();
    Layout {
        along: of_word(&Along::WORDS, fields.text("along")),
        sizes: of_word(&Sizes::WORDS, fields.text("size")),
        exploration_focus: fields.boolean("exploration_focus").unwrap_or(default.exploration_focus),
        margin_px: fields.number("margin").unwrap_or(default.margin_px),
        gap_px: fields.number("gap").unwrap_or(default.gap_px),
    }
}

/// What is read in other tables of an overlay.
pub struct Parts<'a> {
    /// `frame`, where it is a table, with its files.
    pub frame: Option<Frame>,
    /// `line`, where it is a table, and its skin.
    pub line: Option<(Fields<'a>, Option<std::path::PathBuf>)>,
    /// `call_out`.
    pub call_out: Option<Fields<'a>>,
}

/// An overlay.
pub fn overlay(fields: &Fields, parts: Parts) -> Overlay {
    let default = Overlay::of(fields.text("lens").unwrap_or_default());
    let number = |key: &str, default: f64| fields.number(key).unwrap_or(default);
    let frame = match fields.node("frame").and_then(Node::text) {
        Some(word) => Frame::BuiltIn(of_word(&BuiltInFrame::WORDS, Some(word))),
        None => parts.frame.unwrap_or_default(),
    };
    let line = match (fields.node("line").and_then(Node::text), parts.line) {
        (Some("none"), _) => None,
        (word, None) => Some(ContextLine { kind: of_word(&LineKind::WORDS, word), ..ContextLine::default() }),
        (_, Some((own, skin))) => {
            let plain = ContextLine::default();
            Some(ContextLine {
                kind: of_word(&LineKind::WORDS, own.text("kind")),
                color: own.color("color"),
                widths: [
                    own.number("width").unwrap_or(plain.widths[0]),
                    own.number("end_width").unwrap_or(plain.widths[1]),
                ],
                skin,
                to: of_word(&LineEnd::WORDS, own.text("to")),
                outside: of_word(&Outside::WORDS, own.text("outside")),
                arrow_distance_m: own.number("arrow_distance"),
                fade: own.node("fade").and_then(Node::numbers::<2>),
            })
        }
    };
    let at = fields.node("at").and_then(Node::numbers::<2>);
    Overlay {
        priority: number("priority", default.priority),
        interest: number("interest", default.interest),
        stand: parts.call_out.as_ref().map_or(at.map_or(Stand::Laid, Stand::At), |own| Stand::Scene(call_out(own))),
        size: fields.node("size").and_then(size).unwrap_or(default.size),
        min: fields.node("min").and_then(size),
        max: fields.node("max").and_then(size),
        opacity: number("opacity", default.opacity),
        frame,
        caption: fields.text("caption").map(str::to_owned),
        line,
        ..default
    }
}

fn call_out(own: &Fields) -> CallOut {
    let default = CallOut::default();
    CallOut {
        height_m: own.number("height_m"),
        width_m: own.number("width_m"),
        tilt: own.number("tilt_deg").map_or(default.tilt, f64::to_radians),
    }
}

/// Whether a node is a table.
pub fn is_table(node: &Node) -> bool {
    matches!(node.data, Data::Table(_))
}

/// The keys of an overlay.
pub(super) fn written(overlay: &Overlay, options: &Options) -> Vec<(&'static str, String)> {
    let default = Overlay::of(&overlay.lens);
    let pair = |[a, b]: [u32; 2]| format!("[{a}, {b}]");
    let mut keys = vec![("lens", quoted(&overlay.lens))];
    let mut number_if = |name, value: f64, default: f64| {
        if value != default {
            keys.push((name, number(value)));
        }
    };
    number_if("priority", overlay.priority, default.priority);
    number_if("interest", overlay.interest, default.interest);
    number_if("opacity", overlay.opacity, default.opacity);
    if overlay.size != default.size {
        keys.push(("size", pair(overlay.size)));
    }
    keys.extend(overlay.min.map(|size| ("min", pair(size))));
    keys.extend(overlay.max.map(|size| ("max", pair(size))));
    match &overlay.frame {
        frame if *frame == Frame::default() => {}
        Frame::BuiltIn(frame) => keys.push(("frame", word_of(&BuiltInFrame::WORDS, frame))),
        Frame::Images { alpha, frame } => {
            let file = |name, file: &Option<std::path::PathBuf>| {
                file.as_ref().map(|file| format!("{name} = {}", quoted(&options.written(file))))
            };
            let own: Vec<String> = file("alpha", alpha).into_iter().chain(file("frame", frame)).collect();
            keys.push(("frame", format!("{{ {} }}", own.join(", "))));
        }
    }
    keys.extend(overlay.caption.as_ref().map(|text| ("caption", quoted(text))));
    match &overlay.stand {
        Stand::Laid => {}
        Stand::At([x, y]) => keys.push(("at", format!("[{}, {}]", number(*x), number(*y)))),
        Stand::Scene(own) => keys.push(("call_out", call_out_table(own))),
    }
    match &overlay.line {
        None => keys.push(("line", quoted("none"))),
        Some(line) if *line == ContextLine::default() => {}
        Some(line) => keys.push(("line", line_table(line, options))),
    }
    keys
}

fn call_out_table(call_out: &CallOut) -> String {
    let mut own = Vec::new();
    own.extend(call_out.height_m.map(|metres| format!("height_m = {}", number(metres))));
    own.extend(call_out.width_m.map(|metres| format!("width_m = {}", number(metres))));
    if call_out.tilt != CallOut::default().tilt {
        own.push(format!("tilt_deg = {}", number(degrees(call_out.tilt))));
    }
    if own.is_empty() { "{}".to_owned() } else { format!("{{ {} }}", own.join(", ")) }
}

fn line_table(line: &ContextLine, options: &Options) -> String {
    let plain = ContextLine::default();
    let mut own = vec![format!("kind = {}", word_of(&LineKind::WORDS, &line.kind))];
    own.extend(line.color.map(|color| format!("color = {}", write_color(color))));
    for (key, i) in [("width", 0), ("end_width", 1)] {
        if line.widths[i] != plain.widths[i] {
            own.push(format!("{key} = {}", number(line.widths[i])));
        }
    }
    own.extend(line.skin.as_ref().map(|file| format!("skin = {}", quoted(&options.written(file)))));
    if line.to != plain.to {
        own.push(format!("to = {}", word_of(&LineEnd::WORDS, &line.to)));
    }
    if line.outside != plain.outside {
        own.push(format!("outside = {}", word_of(&Outside::WORDS, &line.outside)));
    }
    own.extend(line.arrow_distance_m.map(|metres| format!("arrow_distance = {}", number(metres))));
    own.extend(line.fade.map(|[a, b]| format!("fade = [{}, {}]", number(a), number(b))));
    format!("{{ {} }}", own.join(", "))
}

/// The keys of a layout that is not the default one.
pub(super) fn layout_written(layout: &Layout) -> Vec<(&'static str, String)> {
    let default = Layout::default();
    let mut keys = Vec::new();
    if layout.along != default.along {
        keys.push(("along", word_of(&Along::WORDS, &layout.along)));
    }
    if layout.sizes != default.sizes {
        keys.push(("size", word_of(&Sizes::WORDS, &layout.sizes)));
    }
    if layout.exploration_focus {
        keys.push(("exploration_focus", "true".to_owned()));
    }
    if layout.margin_px != default.margin_px {
        keys.push(("margin", number(layout.margin_px)));
    }
    if layout.gap_px != default.gap_px {
        keys.push(("gap", number(layout.gap_px)));
    }
    keys
}

#[cfg(test)]
mod tests {
    use crate::figure::scene_file::{Options, parse};

    #[test]
    fn places_that_are_none_are_told() {
        let both = "is given together with at: an overlay stands in the scene or at a place in the picture";
        for (lines, expected) in [
            ("at = [0.5, 1.5]", "s.toml:8: [overlay.0] at: must be [x, y], two numbers 0 to 1, is [0.5, 1.5]"),
            ("at = [320, 200]", "at: must be [x, y], two numbers 0 to 1, is [320, 200]"),
            ("at = [0.5]", "at: must be [x, y], two numbers 0 to 1, is [0.5]"),
            ("call_out = true", "call_out: must be a table"),
            ("call_out = { tilt_deg = 91 }", "call_out.tilt_deg: must be a number -90 to 90, is 91"),
            ("call_out = { width_m = 0 }", "call_out.width_m: must be a number 0.001 to 100000, is 0"),
            ("call_out = { height = 3 }", "call_out.height: unknown key; did you mean \"height_m\"?"),
            ("at = [0.5, 0.5]\ncall_out = {}", &format!("s.toml:9: [overlay.0] call_out: {both}")),
            ("at = [2, 0.5]\ncall_out = {}", both),
            (
                "call_out = {}",
                "s.toml:8: [overlay.0] call_out: stands above a point of interest, and lens \"a\" has no poi",
            ),
        ] {
            let lens = "[[lens]]\nname = \"a\"\nkind = \"annotation\"\ntext = \"x\"\n";
            let text = format!("veduta = 1\n{lens}[[overlay]]\nlens = \"a\"\n{lines}\n");
            let message = parse(&text, "s.toml", &Options::default()).unwrap_err().to_string();
            assert!(message.contains(expected), "{lines}\n  gave     {message}\n  expected {expected}");
        }
    }
}
