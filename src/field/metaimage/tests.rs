use glam::DVec3;

use crate::field::{
    Component, Values,
    testing::{big, load, load_with, numbers, one, refused, zlib},
};

const HEAD: &str = "ObjectType = Image\nNDims = 3\nDimSize = 2 3 1\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n";

fn with(line: &str, data: &[u8]) -> Vec<u8> {
    [line.as_bytes(), HEAD.as_bytes(), data].concat()
}

#[test]
fn data_may_be_raw_packed_text_or_beside() {
    let bytes = [1, 2, 3, 4, 5, 6];
    let raw = one(load("a.mha", with("", &bytes)));
    assert_eq!((raw.steps[0].values.clone(), raw.grid.size), (Values::U8(bytes.to_vec()), [2, 3, 1]));
    let packed = one(load("a.mha", with("CompressedData = True\n", &zlib(&bytes))));
    assert_eq!(packed.steps[0].values, raw.steps[0].values);
    let text = one(load("a.mha", with("BinaryData = False\n", b"1 2 3 4 5 6")));
    assert_eq!(text.steps[0].values, raw.steps[0].values);
    let beside = HEAD.replace("LOCAL", "b.raw");
    assert_eq!(one(load_with("a.mhd", &beside, &[("b.raw", &bytes)])).steps[0].values, raw.steps[0].values);
    let skipped = format!("HeaderSize = -1\n{beside}");
    assert_eq!(
        one(load_with("a.mhd", skipped, &[("b.raw", &[9, 9, 1, 2, 3, 4, 5, 6])])).steps[0].values,
        raw.steps[0].values
    );
    let floats = HEAD.replace("UCHAR", "FLOAT").replace("2 3 1", "1 2").replace("NDims = 3", "NDims = 2");
    let floats = [
        b"BinaryDataByteOrderMSB = True\nElementNumberOfChannels = 2\n",
        floats.as_bytes(),
        &big(&[3.0, 4.0, 6.0, 8.0]),
    ]
    .concat();
    let field = one(load("a.mha", floats));
    assert_eq!((field.components, field.scalar(0, Component::Magnitude).range), (2, Some([5.0, 10.0])));
    assert_eq!(numbers(&field, 0), [3.0, 4.0, 6.0, 8.0]);
}

#[test]
fn places() {
    let grid = one(load(
        "a.mha",
        with("Offset = 1 2 3\nElementSpacing = 2 3 4\nTransformMatrix = 0 1 0 -1 0 0 0 0 1\n", &[0; 6]),
    ))
    .grid;
    assert_eq!(
        (grid.origin, grid.steps),
        (DVec3::new(1.0, 2.0, 3.0), [DVec3::Y * 2.0, DVec3::X * -3.0, DVec3::Z * 4.0])
    );
}

#[test]
fn what_is_wrong_is_said() {
    for (from, to, wanted) in [
        ("DimSize = 2 3 1\n", "", "the header has no `DimSize`"),
        ("2 3 1", "2 3 1 1", "line 3: `DimSize` is \"2 3 1 1\""),
        ("2 3 1", "2 3 3000", "at most 2048"),
        ("2 3 1", "2 3 2", "12 bytes of data belong here, there are 6"),
        ("ElementType = MET_UCHAR\n", "", "the header has no `ElementType`"),
        ("MET_UCHAR", "MET_STRING", "`ElementType` is \"MET_STRING\""),
        ("ObjectType = Image", "Offset = 1 2", "line 1: `Offset` is \"1 2\"; 3 numbers"),
        ("ObjectType = Image", "ElementSpacing = 1 1 -", "3 numbers belong there"),
        ("ObjectType = Image", "ElementSpacing = 0 1 1", "neither 0"),
        ("ObjectType = Image", "ElementNumberOfChannels = 0", "0 components"),
        ("ObjectType = Image", "Image", "\"Image\" is no line of a header"),
        ("ObjectType = Image", "CompressedData = True", "damaged"),
        ("LOCAL", "LIST", "line 5: the data are in several files"),
        ("LOCAL", "no.raw", "d/no.raw: cannot be read"),
    ] {
        assert!(HEAD.contains(from));
        let message = refused(load("a.mha", [HEAD.replacen(from, to, 1).as_bytes(), b"\nzzzzz"].concat()));
        assert!(message.contains(wanted), "{wanted}: {message}");
    }
    assert!(refused(load("a.mha", "NDims = 3\nDimSize = 2 3 1\n")).contains("the header has no `ElementDataFile`"));
}
