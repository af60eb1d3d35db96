//! `[[overlay]]` and `[layout]` in scene files: their keys, read and written.

use std::path::PathBuf;

use crate::{
    figure::scene_file::{
        check::Fields,
        forms::{Color, Degrees, Form, Same, Word, Worded},
        keys::{Kind, Table, key},
        node::Data,
        paths::Options,
        reader::Reader,
        row::{self, Given, Row, field, keys_of},
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
    keys: keys_of!(OVERLAY_ROWS),
};

const OVERLAY_ROWS: &[Row<Overlay>] = &[
    field!(key("lens", Kind::Text, "", "", "The name of its lens.", "\"cathedral\""), Same, |overlay: Overlay| overlay
        .lens),
    field!(
        key("priority", Kind::Number { min: -1e6, max: 1e6 }, "0.0", "", "Where there is not room for all, higher ones stay larger; the lowest become markers.", "1.0",),
        Same,
        |overlay: Overlay| overlay.priority
    ),
    field!(
        key("interest", Kind::Number { min: 0.0, max: 1.0 }, "0.5", "", "How large it gets where `[layout]` has `size = \"interest\"`: 0 the smallest, 1 the largest size.", "1.0",),
        Same,
        |overlay: Overlay| overlay.interest
    ),
    Row::<Overlay>::new(
        key(
            "at",
            Kind::PicturePlace,
            "where the layout puts it",
            "",
            "A place of its own: where its middle is, as shares of the picture's width and height from the upper left. It keeps its `size`, as far as the picture holds that, and the margin to the border; the others leave it free. Of two that overlap, the one whose lens comes later lies in front.",
            "[0.5, 0.4]",
        ),
        |overlay, _| match overlay.stand {
            Stand::At(at) => Some(at.into()),
            _ => None,
        },
        |overlay, given| overlay.stand = given.node.numbers::<2>().map_or(Stand::Laid, Stand::At),
    )
    .after("caption"),
    Row::<Overlay>::new(
        key(
            "call_out",
            Kind::Table(&CALL_OUT),
            "none: it lies in the plane of the picture",
            "",
            "Has it stand in the scene, as a tilted board above its first point of interest; see Best-view lenses. Either this or `at`.",
            "{ tilt_deg = 30.0 }",
        ),
        |overlay, options| match &overlay.stand {
            Stand::Scene(own) => Some(row::written(CALL_OUT_ROWS, own, &CallOut::default(), options)),
            _ => None,
        },
        |overlay, given| overlay.stand = Stand::Scene(call_out(given)),
    )
    .after("at"),
    field!(
        key(
            "share",
            Kind::Number { min: 0.01, max: 1.0 },
            "0.2222",
            "",
            "Its preferred height as a share of the picture's, so that it is as large in figures of all sizes; it is half as wide again. In pictures narrower than 16 by 9 a share of 9/16 of their width.",
            "0.3",
        ),
        Same,
        |overlay: Overlay| overlay.share
    ),
    field!(
        key("size", Kind::Size, "by `share`", "pixels", "Its preferred size, in place of a share.", "[320, 200]"),
        Same,
        |overlay: Overlay| overlay.size
    ),
    field!(
        key(
            "min",
            Kind::Size,
            "half of `size`; a card of text keeps its size",
            "pixels",
            "It is made no smaller.",
            "[120, 80]",
        ),
        Same,
        |overlay: Overlay| overlay.min
    ),
    field!(
        key("max", Kind::Size, "one and a half of `size`", "pixels", "It is made no larger.", "[480, 300]"),
        Same,
        |overlay: Overlay| overlay.max
    ),
    field!(
        key(
            "opacity",
            Kind::Number { min: 0.0, max: 1.0 },
            "1.0",
            "",
            "How much of the picture below it hides.",
            "0.8",
        ),
        Same,
        |overlay: Overlay| overlay.opacity
    )
    .after("interest"),
    Row::<Overlay>::new(
        key(
            "frame",
            Kind::WordOrTable(&FRAMES, &FRAME),
            "\"rounded\"",
            "",
            "What is cut out of it and laid over it: a frame that is built in, or images.",
            "\"print\"",
        ),
        |overlay, options| Some(frame_data(&overlay.frame, options)),
        |overlay, given| overlay.frame = frame(given),
    ),
    field!(
        key("caption", Kind::Text, "none", "", "A line of text below what it shows.", "\"Town hall, 1893\""),
        Same,
        |overlay: Overlay| overlay.caption
    ),
    Row::<Overlay>::new(
        key(
            "line",
            Kind::WordOrTable(&["none", LINES[0], LINES[1], LINES[2]], &LINE),
            "\"straight\"",
            "",
            "The context lines from it to its points of interest: how they run, or a table that says more; `none`: it has none.",
            "{ kind = \"curved\", to = \"area\" }",
        ),
        |overlay, options| Some(line_data(overlay.line.as_ref(), options)),
        |overlay, given| overlay.line = line(given),
    ),
];

/// `call_out` of an overlay.
pub const CALL_OUT: Table = Table {
    name: "call_out",
    doc: "A board in the scene that shows an overlay, in perspective, turned to the viewer about the vertical axis. Its frame and its text are on it, as large beside what it shows as they are in an overlay of `size` pixels. Nothing of the city hides it.",
    keys: keys_of!(CALL_OUT_ROWS),
};

const CALL_OUT_ROWS: &[Row<CallOut>] = &[
    field!(
        key(
            "height_m",
            Kind::Number { min: 0.0, max: 1e5 },
            "an eighth of the heights of the object and of the board",
            "m",
            "From the top of the object, or from the point, to the lower edge.",
            "15.0",
        ),
        Same,
        |board: CallOut| board.height_m
    ),
    field!(
        key(
            "width_m",
            Kind::Number { min: 1e-3, max: 1e5 },
            "as wide in the picture as `size`",
            "m",
            "How wide it is.",
            "40.0",
        ),
        Same,
        |board: CallOut| board.width_m
    ),
    field!(
        key(
            "tilt_deg",
            Kind::Number { min: -90.0, max: 90.0 },
            "30.0",
            "degrees",
            "How far its upper edge is tilted away from the viewer: 0 stands upright, 90 lies flat.",
            "45.0",
        ),
        Degrees,
        |board: CallOut| board.tilt
    ),
];

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
    keys: keys_of!(LINE_ROWS),
};

const LINE_ROWS: &[Row<ContextLine>] = &[
    field!(
        key(
            "kind",
            Kind::Word { now: &LINES, later: &[] },
            "\"straight\"",
            "",
            "How they run: straight, along the sides of the picture, or in a curve.",
            "\"orthogonal\"",
        ),
        Word,
        |line: ContextLine| line.kind
    )
    .always(),
    field!(
        key("color", Kind::Color, "the lens colour", "", "Their colour.", "\"#333333\""),
        Color,
        |line: ContextLine| line.color
    ),
    field!(
        key(
            "width",
            Kind::Number { min: 0.0, max: 200.0 },
            "6.0 of 720 that the picture is high, as much of others",
            "pixels",
            "How wide they are at the overlay.",
            "10.0",
        ),
        Same,
        |line: ContextLine| line.widths[0]
    ),
    field!(
        key(
            "end_width",
            Kind::Number { min: 0.0, max: 200.0 },
            "1.5 of 720 that the picture is high, as much of others",
            "pixels",
            "How wide they are at the place.",
            "2.0",
        ),
        Same,
        |line: ContextLine| line.widths[1]
    ),
    Row::<ContextLine>::new(
        key(
            "skin",
            Kind::Text,
            "one colour",
            "",
            "An image along them, with alpha; its left end is at the overlay.",
            "\"skin.png\"",
        ),
        |line, options| file_data(line.skin.as_ref(), options),
        |line, given| line.skin = given.file(),
    ),
    field!(
        key(
            "to",
            Kind::Word { now: &ENDS, later: &[] },
            "\"point\"",
            "",
            "What they end at: the middle of the place, or the outline of its object, which is then drawn.",
            "\"area\"",
        ),
        Word,
        |line: ContextLine| line.to
    ),
    field!(
        key(
            "outside",
            Kind::Word { now: &OUTSIDE, later: &[] },
            "\"arrow\"",
            "",
            "What is drawn for a place that is out of the picture or behind the eye: an arrow at the border, or nothing.",
            "\"hidden\"",
        ),
        Word,
        |line: ContextLine| line.outside
    ),
    field!(
        key(
            "arrow_distance",
            Kind::Number { min: 0.0, max: 1e9 },
            "never",
            "m",
            "For a place that is farther from the eye than this an arrow at the overlay takes the place of the line.",
            "500.0",
        ),
        Same,
        |line: ContextLine| line.arrow_distance_m
    ),
    field!(
        key(
            "fade",
            Kind::PlanLengths,
            "none",
            "pixels",
            "`[inner, outer]`: lines fade out towards the middle of the picture, from the outer radius to the inner one, within which they are not seen.",
            "[60, 200]",
        ),
        Same,
        |line: ContextLine| line.fade
    ),
];

/// `[layout]`.
pub const LAYOUT: Table = Table {
    name: "layout",
    doc: "Where overlays stand that have no place of their own. They never overlap, and leave free the points of interest that they can leave free.",
    keys: keys_of!(LAYOUT_ROWS),
};

/// Its rows.
pub const LAYOUT_ROWS: &[Row<Layout>] = &[
    field!(
        key(
            "along",
            Kind::Word { now: &ALONG, later: &[] },
            "\"border\"",
            "",
            "In a row at the `top` or the `bottom`, in a column on the `left` or the `right`, in two columns (`sides`), or all around the `border`.",
            "\"right\"",
        ),
        Word,
        |layout: Layout| layout.along
    ),
    field!(
        key(
            "size",
            Kind::Word { now: &SIZES, later: &[] },
            "\"preferred\"",
            "",
            "What their sizes go by, between `min` and `max` of each: their preferred size, how near their places are (`distance`), or their `interest`.",
            "\"distance\"",
        ),
        Word,
        |layout: Layout| layout.sizes
    ),
    field!(
        key(
            "exploration_focus",
            Kind::Boolean,
            "false",
            "",
            "The overlay whose place is nearest to the middle of the picture stands in the middle of its row.",
            "true",
        ),
        Same,
        |layout: Layout| layout.exploration_focus
    ),
    field!(
        key(
            "margin",
            Kind::Number { min: 0.0, max: 4096.0 },
            "16.0 of 720 that the picture is high, as much of others",
            "pixels",
            "To the border of the picture.",
            "24.0",
        ),
        Same,
        |layout: Layout| layout.margin_px
    ),
    field!(
        key(
            "gap",
            Kind::Number { min: 0.0, max: 4096.0 },
            "12.0 of 720 that the picture is high, as much of others",
            "pixels",
            "Between overlays.",
            "8.0"
        ),
        Same,
        |layout: Layout| layout.gap_px
    ),
];

fn file_data(file: Option<&PathBuf>, options: &Options) -> Option<Data> {
    file.map(|file| Data::Text(options.written(file)))
}

fn call_out(given: &mut Given) -> CallOut {
    if given.fields.given("at") {
        given.note("is given together with at: an overlay stands in the scene or at a place in the picture");
    }
    let own = given.table(&CALL_OUT);
    let mut board = CallOut::default();
    row::read(CALL_OUT_ROWS, &own, given.reader, &mut board);
    board
}

fn frame(given: &mut Given) -> Frame {
    match given.node.text() {
        Some(word) => Frame::BuiltIn(BuiltInFrame::of_word(word).unwrap_or_default()),
        None => {
            let own = given.table(&FRAME);
            Frame::Images { alpha: given.reader.file(&own, "alpha"), frame: given.reader.file(&own, "frame") }
        }
    }
}

fn frame_data(frame: &Frame, options: &Options) -> Data {
    match frame {
        Frame::BuiltIn(frame) => frame.word().into(),
        Frame::Images { alpha, frame } => {
            let files = [("alpha", alpha), ("frame", frame)].into_iter();
            Data::table(files.filter_map(|(key, file)| Some((key, file_data(file.as_ref(), options)?))))
        }
    }
}

/// What a line is called that there is none of.
const NO_LINE: &str = "none";

fn line(given: &mut Given) -> Option<ContextLine> {
    let mut line = ContextLine::default();
    match given.node.text() {
        Some(NO_LINE) => return None,
        Some(_) => Word::take(given.node, &mut line.kind),
        None => {
            let own = given.table(&LINE);
            row::read(LINE_ROWS, &own, given.reader, &mut line);
        }
    }
    Some(line)
}

fn line_data(line: Option<&ContextLine>, options: &Options) -> Data {
    let plain = ContextLine::default();
    match line {
        None => NO_LINE.into(),
        Some(line) if *line == plain => line.kind.word().into(),
        Some(line) => row::written(LINE_ROWS, line, &plain, options),
    }
}

/// An overlay.
pub fn read(reader: &mut Reader, fields: &Fields) -> Overlay {
    let mut overlay = Overlay::of("");
    row::read(OVERLAY_ROWS, fields, reader, &mut overlay);
    if fields.given("share") && fields.given("size") {
        let message = "is given together with size: a share of the picture, or pixels";
        reader.checker.note(&fields.place, "share", fields.line("share"), message);
    }
    overlay
}

/// The table of an overlay.
pub fn written(overlay: &Overlay, options: &Options) -> Data {
    row::written(OVERLAY_ROWS, overlay, &Overlay::of(""), options)
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
