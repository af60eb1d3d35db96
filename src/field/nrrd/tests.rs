use glam::DVec3;
use proptest::prelude::*;

use crate::field::{
    Component, Field, Grid, Packing, Step, Values,
    testing::{gzip, load, load_with, numbers, one, refused},
    write_nrrd,
};

const HEAD: &str = "NRRD0004\n# a comment\ntype: uint8\ndimension: 3\nsizes: 2 3 1\nencoding: raw\n";

fn nrrd(lines: &str, data: &[u8]) -> Vec<u8> {
    [format!("{lines}\n").as_bytes(), data].concat()
}

#[test]
fn every_encoding_gives_the_same() {
    let wanted = [1.0, 2.0, 3.0, 250.0, 5.0, 6.0];
    let bytes = [1, 2, 3, 250, 5, 6];
    let head = |encoding: &str| HEAD.replace("encoding: raw", encoding);
    let raw = one(load("a.nrrd", nrrd(HEAD, &bytes)));
    assert_eq!((raw.name.as_str(), raw.grid.size, raw.is_integer), ("a", [2, 3, 1], true));
    assert_eq!(raw.steps[0].values, Values::U8(bytes.to_vec()));
    for (encoding, data) in [
        ("encoding: ascii", b"1 2,3\n250 5 6".to_vec()),
        ("encoding: text", b"1 2 3 250 5 6 ".to_vec()),
        ("encoding: hex", b"010203 fA\n0506".to_vec()),
        ("encoding: gzip", gzip(&bytes)),
        ("encoding: gz\nbyte skip: 2", gzip(&[&[0, 0], &bytes[..]].concat())),
        ("encoding: raw\nline skip: 2", [b"no\nno\n", &bytes[..]].concat()),
        ("encoding: raw\nline skip: 1\nbyte skip: 3", [b"no\nabc", &bytes[..]].concat()),
        ("encoding: raw\nbyte skip: -1", [b"whatever", &bytes[..]].concat()),
    ] {
        assert_eq!(numbers(&one(load("a.nrrd", nrrd(&head(encoding), &data))), 0), wanted, "{encoding}");
    }
    let packed = gzip(&nrrd(HEAD, &bytes));
    assert_eq!(numbers(&one(load("a.nrrd.gz", &packed)), 0), wanted);
}

#[test]
fn numbers_of_all_types_and_orders() {
    for (kind, endian, data, wanted) in [
        ("signed char", "", vec![0xff, 1], [-1.0, 1.0]),
        ("short", "endian: big\n", vec![0xff, 0xfe, 0, 3], [-2.0, 3.0]),
        ("uint16", "endian: little\n", vec![1, 0, 0, 1], [1.0, 256.0]),
        ("unsigned int", "endian: little\n", vec![1, 0, 0, 0, 0, 0, 0, 1], [1.0, 16_777_216.0]),
        ("double", "endian: big\n", [1.5_f64.to_be_bytes(), (-2.0_f64).to_be_bytes()].concat(), [1.5, -2.0]),
        ("long long", "endian: big\n", [7_i64.to_be_bytes(), (-9_i64).to_be_bytes()].concat(), [7.0, -9.0]),
    ] {
        let head = format!("NRRD0001\ntype: {kind}\ndimension: 1\nsizes: 2\n{endian}encoding: raw\n");
        assert_eq!(numbers(&one(load("a.nrrd", nrrd(&head, &data))), 0), wanted, "{kind}");
    }
}

#[test]
fn places_come_from_spacings_or_directions() {
    let cell = format!(
        "{HEAD}spacings: 2 3 5\naxis mins: 10 20 nan\ncenterings: cell node ???\nunits: \"mm\" \"mm\" \"mm\"\n"
    );
    let file = load("a.nrrd", nrrd(&cell, &[0; 6])).unwrap();
    let grid = file.fields[0].grid;
    assert_eq!((grid.origin, grid.steps[1]), (DVec3::new(11.0, 20.0, 0.0), DVec3::Y * 3.0));
    assert_eq!(file.warnings, ["lengths are in mm, mm, mm"]);
    let ends = format!("{HEAD}axis mins: 0 0 0\naxis maxs: 4 4 4\ncenters: cell node node\n");
    let grid = one(load("a.nrrd", nrrd(&ends, &[0; 6]))).grid;
    assert_eq!((grid.steps[0].x, grid.steps[1].y, grid.origin.x), (2.0, 2.0, 1.0));
    let turned = format!(
        "{HEAD}space: left-posterior-superior\nspace directions: (0,2,0) (-1,0,0) (0,0,3)\nspace origin: (1,2,3)\nsample units: \"K\"\ncontent: heat\nkey:=value: 3\n"
    );
    let field = one(load("a.nrrd", nrrd(&turned, &[0; 6])));
    assert_eq!(field.grid.steps[..2], [DVec3::Y * 2.0, DVec3::NEG_X]);
    assert_eq!(
        (field.grid.origin, field.name.as_str(), field.unit.as_deref()),
        (DVec3::new(1.0, 2.0, 3.0), "heat", Some("K"))
    );
}

#[test]
fn axes_may_be_components_or_time() {
    let head = |rest: &str| format!("NRRD0005\ntype: uint8\nencoding: raw\n{rest}");
    let data: Vec<u8> = (0..12).collect();
    let vectors = head("dimension: 4\nsizes: 3 2 2 1\nkinds: 3-color domain domain domain\n");
    let field = one(load("a.nrrd", nrrd(&vectors, &data)));
    assert_eq!((field.components, field.grid.size), (3, [2, 2, 1]));
    assert_eq!(field.scalar(0, Component::Index(1)).values, Values::U8(vec![1, 4, 7, 10]));
    let last = head("dimension: 3\nsizes: 2 2 3\nkinds: space space vector\n");
    let field = one(load("a.nrrd", nrrd(&last, &data)));
    assert_eq!(field.scalar(0, Component::Index(1)).values, Values::U8(vec![4, 5, 6, 7]));
    let time = head(
        "dimension: 4\nsizes: 2 1 2 3\nkinds: domain domain domain time\nspacings: 1 1 1 0.5\naxis mins: 0 0 0 7\n",
    );
    let field = one(load("a.nrrd", nrrd(&time, &data)));
    assert_eq!(field.steps.iter().map(|s| s.time).collect::<Vec<_>>(), [Some(7.0), Some(7.5), Some(8.0)]);
    assert_eq!(numbers(&field, 2), [8.0, 9.0, 10.0, 11.0]);
    let unsaid = load("a.nrrd", nrrd(&head("dimension: 4\nsizes: 3 2 2 1\n"), &data)).unwrap();
    assert_eq!(unsaid.fields[0].components, 3);
    assert!(unsaid.warnings[0].contains("axis 0 of 4 is taken for components"), "{:?}", unsaid.warnings);
    let unsaid = load("a.nrrd", nrrd(&head("dimension: 4\nsizes: 6 1 1 2\n"), &data)).unwrap();
    assert_eq!(unsaid.fields[0].steps.len(), 2);
    let outside = head("dimension: 3\nsizes: 2 2 3\nspace dimension: 2\nspace directions: none (1,0) (0,1)\n");
    assert_eq!(one(load("a.nrrd", nrrd(&outside, &data))).components, 2);
}

#[test]
fn data_may_be_beside() {
    let head = HEAD.replace("sizes: 2 3 1", "sizes: 2 1 3");
    let slices: [(&str, &[u8]); 3] = [("s08.raw", &[1, 2]), ("s09.raw", &[3, 4]), ("s10.raw", &[5, 6])];
    let wanted = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
    for rest in [
        "data file: s%02d.raw 8 10 1\n",
        "datafile: LIST\ns08.raw\ns09.raw\ns10.raw\n",
        "data file: LIST 2\ns08.raw\n./s09.raw\ns10.raw\n",
    ] {
        assert_eq!(numbers(&one(load_with("a.nhdr", format!("{head}{rest}"), &slices)), 0), wanted, "{rest}");
    }
    let back = one(load_with("a.nhdr", format!("{head}data file: s%02d.raw 10 8 -1\n"), &slices));
    assert_eq!(numbers(&back, 0), [5.0, 6.0, 3.0, 4.0, 1.0, 2.0]);
    let whole = one(load_with(
        "a.nhdr",
        format!("{head}data file: b.raw\nbyte skip: 1\n"),
        &[("b.raw", &[9, 1, 2, 3, 4, 5, 6])],
    ));
    assert_eq!(numbers(&whole, 0), wanted);
    let missing = refused(load_with("a.nhdr", format!("{head}data file: no.raw\n"), &slices));
    assert_eq!(missing, "d/no.raw: cannot be read: not found; d/a.nhdr names it");
    let short = refused(load_with("a.nhdr", format!("{head}data file: s08.raw\n"), &slices));
    assert!(
        short.starts_with("d/s08.raw, line 1: the header's sizes and type need 6 bytes of data, there are 2"),
        "{short}"
    );
    for (line, wanted) in [
        ("data file: s%d.raw 1 2", "FIRST LAST STEP"),
        ("data file: s%02d.raw 8 10 0", "FIRST LAST STEP"),
        ("data file: LIST", "followed by no name"),
        ("data file: LIST\na\nb\nc\nd", "6 numbers cannot be in 4 files"),
        ("data file: ../a.raw", "below its own folder"),
    ] {
        let message = refused(load_with("a.nhdr", format!("{head}{line}\n"), &slices));
        assert!(message.contains(wanted), "{line}: {message}");
    }
}

#[test]
fn what_is_wrong_is_said() {
    let lacks = |key: &str| HEAD.lines().filter(|line| !line.starts_with(key)).collect::<Vec<_>>().join("\n") + "\n";
    for (head, wanted) in [
        (HEAD.replace("0004", "0009"), "line 1: the file is of a version of NRRD that is not known"),
        (lacks("type"), "line 7: the header has no `type`"),
        (lacks("dimension"), "the header has no `dimension`"),
        (lacks("sizes"), "the header has no `sizes`"),
        (lacks("encoding"), "the header has no `encoding`"),
        (HEAD.replace("uint8", "block"), "line 3: `type: block` is no type of numbers"),
        (HEAD.replace("uint8", "float"), "has no `endian`"),
        (HEAD.replace("dimension: 3", "dimension: 17"), "1 to 16 belongs there"),
        (HEAD.replace("2 3 1", "2 3"), "`sizes` needs 3 values"),
        (HEAD.replace("2 3 1", "2 -3 1"), "`sizes` needs 3 values"),
        (HEAD.replace("2 3 1", "2 0 1"), "at least one"),
        (HEAD.replace("2 3 1", "2 3 4000"), "at most 2048"),
        (HEAD.replace("2 3 1", "2000 2000 2"), "need 8000000 bytes of data, there are 6"),
        (HEAD.replace("encoding: raw", "encoding: bzip2"), "`encoding: bzip2` is not read"),
        (format!("{HEAD}endian: middle\n"), "`endian` must be"),
        (format!("{HEAD}type: float\n"), "line 7: `type` is said twice"),
        (format!("{HEAD}what is this\n"), "is no line of a header"),
        (format!("{HEAD}line skip: 9\n"), "`line skip: 9` goes past the end"),
        (format!("{HEAD}byte skip: 9\n"), "`byte skip: 9` goes past the end"),
        (format!("{HEAD}byte skip: -2\n"), "a whole number belongs there"),
        (HEAD.replace("encoding: raw", "encoding: hex\nbyte skip: -1"), "for `encoding: raw` only"),
        (HEAD.replace("encoding: raw", "encoding: hex"), "6 bytes of hexadecimal digits belong here, there are 0"),
        (HEAD.replace("encoding: raw", "encoding: text"), "6 numbers belong here"),
        (HEAD.replace("encoding: raw", "encoding: gzip"), "the data is no gzip"),
        (format!("{HEAD}space origin: 1 2 3\n"), "(x,y,z) belongs there"),
        (format!("{HEAD}space directions: (1,0,0) (1,0,0) (0,0,1)\n"), "in one plane"),
        (format!("{HEAD}space directions: (1,0,0\n"), "`spacedirections` needs 3 values"),
        (format!("{HEAD}kinds: time time domain\n"), "2 of time"),
        (HEAD.replace("3\nsizes: 2 3 1", "5\nsizes: 9 9 9 9 9"), "more than three axes"),
    ] {
        let message = refused(load("a.nrrd", nrrd(&head, b"\x01\x02\x03zzz")));
        assert!(message.starts_with("d/a.nrrd") && message.contains(wanted), "{wanted}: {message}");
    }
}

fn fields() -> impl Strategy<Value = Field> {
    let shape = ([1..5_usize, 1..5_usize, 1..5_usize], 1..4_usize, 1..4_usize, any::<bool>(), any::<bool>());
    shape.prop_flat_map(|(size, components, steps, is_bytes, is_timed)| {
        let count = size.iter().product::<usize>() * components;
        let values = match is_bytes {
            true => proptest::collection::vec(any::<u8>(), count).prop_map(Values::U8).boxed(),
            false => proptest::collection::vec(-1e30..1e30_f32, count).prop_map(Values::F32).boxed(),
        };
        let places = [-1e6..1e6_f64, -1e6..1e6_f64, -1e6..1e6_f64];
        let lengths = [0.1..9.0_f64, 0.1..9.0_f64, 0.1..9.0_f64];
        let made =
            (proptest::collection::vec(values, steps), places, lengths, -0.9..0.9_f64, "[a-z:=%#\"][a-z ]{0,8}[a-z]");
        made.prop_map(move |(values, origin, [a, b, c], skew, name)| {
            let steps = [DVec3::new(a, 0.0, 0.0), DVec3::new(skew * a, b, 0.0), DVec3::new(0.0, skew * b, c)];
            let grid = Grid::new(size, DVec3::from_array(origin), steps).expect("a grid");
            let timed = |(i, values)| Step { time: is_timed.then_some(2.5 + 0.25 * i as f64), values };
            let steps: Vec<Step> = values.into_iter().enumerate().map(timed).collect();
            let is_integer = is_bytes || steps.iter().all(|step| step.values.is_whole());
            Field { name, grid, components, is_integer, unit: is_bytes.then(|| "ppm".to_owned()), steps }
        })
    })
}

proptest! {
    #![proptest_config(crate::seeds::config())]

    #[test]
    fn what_is_written_is_read_again(field in fields(), is_packed in any::<bool>()) {
        let packing = if is_packed { Packing::Gzip } else { Packing::Raw };
        let found = one(load("b.nrrd", write_nrrd(&field, packing)));
        let near = |a: DVec3, b: DVec3| (a - b).length() <= 1e-9 * (1.0 + a.length());
        prop_assert!(near(found.grid.origin, field.grid.origin));
        prop_assert!((0..3).all(|i| near(found.grid.steps[i], field.grid.steps[i])));
        prop_assert_eq!(Field { grid: field.grid, ..found }, field);
    }
}

#[test]
fn missing_values_and_mixed_steps_are_written() {
    let grid = Grid::new([2, 1, 1], DVec3::ZERO, [DVec3::X; 3]).unwrap();
    let steps = [Values::U8(vec![1, 2]), Values::F32(vec![f32::NAN, 0.5])].map(|values| Step { time: None, values });
    let field = Field { name: "a".into(), grid, components: 1, is_integer: false, unit: None, steps: steps.into() };
    let found = one(load("a.nrrd", write_nrrd(&field, Packing::Raw)));
    assert_eq!(numbers(&found, 0), [1.0, 2.0]);
    assert!(numbers(&found, 1)[0].is_nan());
}
