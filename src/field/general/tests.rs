use glam::DVec3;

use crate::field::{
    Component, Values,
    testing::{big, load, load_with, numbers, one, refused},
};

/// A header of a grid of 2 × 3 with its numbers behind.
fn grid(lines: &str, numbers: &str) -> String {
    format!("# numbers\ngrid = 2 x 3\n{lines}end\n{numbers}")
}

#[test]
fn arrays_follow_each_other_in_four_ways() {
    let head = |interleaving: &str| {
        format!("field = t, v\nstructure = scalar, 2-vector\nseries = 2, 5, 0.5\nmajority = column\n{interleaving}")
    };
    // t is the number of the sample, v is (10, 20) times that; the second step has 100 more.
    let t = |step: usize, i: usize| (i + 100 * step).to_string();
    let v = |step: usize, i: usize, c: usize| ((i * 10 * (c + 1)) + 100 * step).to_string();
    let each = |of: &dyn Fn(usize) -> String| (0..6).map(of).collect::<Vec<_>>().join(" ");
    let field = |s| each(&|i| format!("{} {} {}", t(s, i), v(s, i, 0), v(s, i, 1)));
    let ts = |s| each(&|i| t(s, i));
    let vs = |s| each(&|i| format!("{} {}", v(s, i, 0), v(s, i, 1)));
    let component = |s, c| each(&|i| v(s, i, c));
    let record = |s| [ts(s), component(s, 0), component(s, 1)].join("\n");
    for (interleaving, text) in [
        ("interleaving = field\n", [field(0), field(1)].join("\n")),
        ("interleaving = record\n", [record(0), record(1)].join("\n")),
        ("interleaving = record-vector\n", [ts(0), vs(0), ts(1), vs(1)].join("\n")),
        ("", [ts(0), vs(0), ts(1), vs(1)].join("\n")),
        ("interleaving = series-vector\n", [ts(0), ts(1), vs(0), vs(1)].join("\n")),
    ] {
        let file = load("a.general", grid(&head(interleaving), &text)).unwrap();
        assert_eq!(numbers(&file.fields[0], 1), [100.0, 101.0, 102.0, 103.0, 104.0, 105.0], "{interleaving}");
        assert_eq!(file.fields[1].scalar(1, Component::Index(1)).range, Some([100.0, 200.0]), "{interleaving}");
        assert_eq!(numbers(&file.fields[1], 0)[4..6], [20.0, 40.0], "{interleaving}");
        assert_eq!(file.fields[0].steps.iter().map(|s| s.time).collect::<Vec<_>>(), [Some(5.0), Some(5.5)]);
    }
}

#[test]
fn majority_and_positions() {
    let of = |lines: &str| load("a.general", grid(lines, "1 2 3 4 5 6.5")).unwrap();
    let rows = of("");
    assert_eq!(numbers(&rows.fields[0], 0), [1.0, 4.0, 2.0, 5.0, 3.0, 6.5]);
    assert_eq!((rows.fields[0].name.as_str(), rows.fields[0].grid.size), ("field0", [2, 3, 1]));
    assert_eq!(numbers(&of("majority = column\n").fields[0], 0), [1.0, 2.0, 3.0, 4.0, 5.0, 6.5]);
    let pairs = of("positions = 10, 2, 90,\n -5\n");
    assert_eq!(
        (pairs.fields[0].grid.origin, pairs.fields[0].grid.steps[1]),
        (DVec3::new(10.0, 90.0, 0.0), DVec3::Y * -5.0)
    );
    let even = of("positions = regular, irregular, 10, 2, 0, 1, 2\n");
    assert_eq!((even.warnings.len(), even.fields[0].grid.origin.x), (0, 10.0));
    assert!(of("positions = regular, irregular, 10, 2, 0, 1, 3\n").warnings[0].contains("uneven spacing"));
    let explicit = of("majority = column\npositions = 0 0 1 0 0 1 1 1 0 2 2 2\n");
    assert!(explicit.warnings[0].contains("curved grid"), "{:?}", explicit.warnings);
    let cells =
        one(load("a.general", grid("dependency = connections\npositions = 10, 2, 90, -5\ntype = byte\n", "7 8")));
    assert_eq!((cells.grid.size, cells.steps[0].values.clone()), ([1, 2, 1], Values::U8(vec![7, 8])));
    assert_eq!(cells.grid.origin, DVec3::new(11.0, 87.5, 0.0));
}

#[test]
fn numbers_may_be_bytes() {
    let values = [1.0, 2.0, 3.0, 4.0, 5.0, 6.5];
    let head = "file = b.bin\ngrid = 3 x 2\nformat = msb ieee\nmajority = column\nheader = bytes 3\n";
    let beside = [&b"abc"[..], &big(&values)].concat();
    assert_eq!(numbers(&one(load_with("a.general", head, &[("b.bin", &beside)])), 0), values);
    let marked = head.replace("bytes 3", "marker \"c\"");
    assert_eq!(numbers(&one(load_with("a.general", marked, &[("b.bin", &beside)])), 0), values);
    // Bytes and floats by turns.
    let mixed = "file = b.bin\ngrid = 2\nformat = lsb binary\ninterleaving = field\nfield = a, b\ntype = byte, float\nstructure = 2-vector, scalar\n";
    let bytes = [&[1, 2][..], &0.5_f32.to_le_bytes(), &[3, 4], &1.5_f32.to_le_bytes()].concat();
    let file = load_with("a.general", mixed, &[("b.bin", &bytes)]).unwrap();
    assert_eq!(
        (file.fields[0].steps[0].values.clone(), numbers(&file.fields[1], 0)),
        (Values::U8(vec![1, 2, 3, 4]), vec![0.5, 1.5])
    );
    let separated = "file = b.bin\ngrid = 2\nformat = binary\nfield = a, b\ntype = byte\nrecordseparator = bytes 1\nseries = 2, separator = bytes 2\n";
    let bytes = [1, 2, 0, 3, 4, 9, 9, 5, 6, 0, 7, 8];
    let file = load_with("a.general", separated, &[("b.bin", &bytes)]).unwrap();
    assert_eq!(file.fields[1].steps[1].values, Values::U8(vec![7, 8]));
    let short = refused(load_with("a.general", head, &[("b.bin", &beside[..20])]));
    assert!(
        short.starts_with("d/b.bin") && short.contains("24 bytes of \"field0\" belong here, 17 are left"),
        "{short}"
    );
}

#[test]
fn tables_have_columns() {
    let head = "grid = 3\nfield = a, b\ninterleaving = field\nlayout = 3, 4, 1, 5\nheader = lines 1\nend\n";
    let rows = "a title\nx: 1.50-2.500\nx: 2.50     7\nx: 3.50     8 and more\n";
    let file = load("a.general", format!("{head}{rows}")).unwrap();
    assert_eq!((numbers(&file.fields[0], 0), file.warnings.len()), (vec![1.5, 2.5, 3.5], 0));
    assert_eq!(numbers(&file.fields[1], 0), [2.5, 7.0, 8.0], "a character between is passed over");
    // A number that is too long for its characters moves what is behind it.
    let moved = load("a.general", format!("{head}{}", rows.replace("2.50     7", " -12345.0 77"))).unwrap();
    assert_eq!((numbers(&moved.fields[0], 0)[1], numbers(&moved.fields[1], 0)[1]), (-12_345.0, 77.0));
    assert!(moved.warnings[0].contains("1 lines do not keep to `layout`"), "{:?}", moved.warnings);
    let blank = load("a.general", format!("{head}{}", rows.replace("2.50", "    "))).unwrap();
    assert_eq!(blank.fields[0].scalar(0, Component::Magnitude).missing, 1);
    let block = "grid = 5\nfield = a\nblock = 2, 2, 3\nend\nx 1.52.5 note\ny   3  4\nz 5.5\n";
    assert_eq!(numbers(&one(load("a.general", block)), 0), [1.5, 2.5, 3.0, 4.0, 5.5]);
}

#[test]
fn scattered_places_are_among_the_numbers() {
    let head =
        "points = 4\nseries = 2\nfield = locations, co2\nstructure = 2-vector, scalar\ninterleaving = field\nend\n";
    let rows = "0 0 300\n0 127 310\n63.5 0 320\n63.5 127 -1000\n";
    let file = load("a.general", format!("{head}{rows}{}", rows.replace("-1000", "350"))).unwrap();
    let field = &file.fields[0];
    assert_eq!((field.name.as_str(), field.grid.size, field.steps.len()), ("co2", [64, 128, 1], 2));
    assert!(
        file.warnings[0].contains("at 4 scattered places; resampled to a regular grid of 64 × 128 × 1"),
        "{:?}",
        file.warnings
    );
    assert!(file.warnings[1].contains("-1000 is far from all other values"), "{:?}", file.warnings);
    let last = field.grid.count() - 1;
    assert_eq!((numbers(field, 0)[0], numbers(field, 1)[last]), (300.0, 350.0));
    assert!(numbers(field, 0)[last] > 300.0);
    // Stations that move: each step has its own places.
    let moving = load("a.general", format!("{head}{rows}{}", rows.replace("0 0 300", "1 1 300"))).unwrap();
    assert!(numbers(&moving.fields[0], 1)[0] > 300.0);
    let given = "points = 3\npositions = 0 0 127 0 0 127\nend\n1 2 3\n";
    assert_eq!(numbers(&one(load("a.general", given)), 0)[127], 2.0);
    let curved = "grid = 2 x 2\nfield = locations, a\nstructure = 2-vector, scalar\ninterleaving = field\nend\n0 0 1\n0 1 2\n1 0 3\n2 2 4\n";
    assert!(load("a.general", curved).unwrap().warnings[0].contains("curved grid"));
}

#[test]
fn what_is_wrong_is_said() {
    let good = grid("field = a\nstructure = scalar\ntype = float\nformat = ascii\nseries = 1\n", "1 2 3 4 5 6");
    for (from, to, wanted) in [
        ("grid = 2 x 3", "grid = 2 x many", "line 2: `grid` is \"2 x many\"; samples along each axis"),
        ("grid = 2 x 3", "grid = 2 x 0", "`grid` is"),
        ("grid = 2 x 3", "grid = 2 x 3 x 4 x 5", "`grid` is"),
        ("grid = 2 x 3", "grid = 2 x 3000", "at most 2048"),
        ("grid = 2 x 3", "grid 2 x 3 = y\npoints = zero", "`points` is \"zero\""),
        ("field = a", "field", "\"field\" is no statement"),
        ("scalar", "tensor", "`structure` is \"tensor\"; `scalar` or `3-vector`"),
        ("type = float", "type = half", "`type` is \"half\""),
        ("ascii", "morse", "`format` is \"morse\""),
        ("series = 1", "series = 1, 2", "`series` is \"1, 2\"; how many steps"),
        ("series = 1", "series = 1, separator = words 2", "`series` is"),
        ("series = 1", "series = 2", "\"a\": 6 numbers belong here, after 0 comes \"the end\""),
        ("series = 1", "majority = both", "`row` or `column`"),
        ("series = 1", "interleaving = none", "`interleaving` is \"none\""),
        ("series = 1", "header = lines x", "`header` is \"lines x\"; `lines N`"),
        ("series = 1", "header = lines 9", "goes past the end of the file"),
        ("series = 1", "header = marker \"zz\"", "goes past the end of the file"),
        ("series = 1", "layout = 1", "`layout` is \"1\"; `skip, width` for each array"),
        ("series = 1", "block = 0, 0, 0", "lines have no numbers"),
        ("series = 1", "block = 0, 1, 1", "a line with numbers of \"a\" belongs here, the file ends"),
        ("series = 1", "layout = 40, 3\ninterleaving = field", "ends before the 3 characters"),
        ("series = 1", "layout = 0, 3\ninterleaving = field", "\"1 2\" stands in the line before"),
        ("series = 1", "positions = 1 2 3", "`positions` is \"1 2 3\"; an origin and a delta"),
        ("series = 1", "positions = 1 0 1 0", "x coordinates must be finite and always rise or fall"),
        ("series = 1", "file = no.lis", "d/no.lis: cannot be read"),
        ("field = a", "field = locations", "names no array but `locations`"),
        ("5 6", "five", "6 numbers belong here, after 4 comes \"five\""),
    ] {
        assert!(good.contains(from), "{from}");
        let message = refused(load("a.general", good.replacen(from, to, 1)));
        assert!(message.contains(wanted), "{wanted}: {message}");
    }
    assert!(refused(load("a.general", "file = x\n")).contains("the header has no `grid`"));
}
