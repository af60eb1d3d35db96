use base64::{Engine, engine::general_purpose::STANDARD};
use glam::DVec3;

use crate::field::{
    Values,
    testing::{little, load, numbers, one, refused, zlib},
};

const VALUES: [f32; 6] = [1.0, 2.0, 3.5, -4.0, 5.0, 6.0];

/// An image of 3 × 2 × 1 samples around these elements.
fn image(file: &str, data: &str, behind: &str) -> String {
    format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\" {file}>\n<ImageData WholeExtent=\"0 2 0 1 0 0\" Origin=\"1 2 3\" Spacing=\"2 1 1\">\n<Piece Extent=\"0 2 0 1 0 0\">\n{data}\n</Piece></ImageData>{behind}</VTKFile>"
    )
}

fn array(attributes: &str, content: &str) -> String {
    format!("<PointData><DataArray type=\"Float32\" Name=\"a &lt; b\" {attributes}>{content}</DataArray></PointData>")
}

fn length(n: usize) -> [u8; 4] {
    (n as u32).to_le_bytes()
}

/// Blocks as VTK has them: their number, their size, that of the last, how long each is packed, and they themselves.
fn blocks(bytes: &[u8], size: usize, last: usize) -> [Vec<u8>; 2] {
    let packed: Vec<Vec<u8>> = bytes.chunks(size).map(zlib).collect();
    let mut head: Vec<u8> = [packed.len(), size, last].into_iter().flat_map(length).collect();
    head.extend(packed.iter().flat_map(|block| length(block.len())));
    [head, packed.concat()]
}

#[test]
fn every_encoding_gives_the_same() {
    let bytes = little(&VALUES);
    let own = |attributes: &str, content: &str| image("byte_order=\"LittleEndian\"", &array(attributes, content), "");
    let one_stream = STANDARD.encode([&length(24)[..], &bytes].concat());
    let two_streams = STANDARD.encode(length(24)) + &STANDARD.encode(&bytes);
    let packed = "byte_order=\"LittleEndian\" compressor=\"vtkZLibDataCompressor\"";
    let [head, body] = blocks(&bytes, 16, 8);
    let in_blocks = STANDARD.encode(head) + "\n " + &STANDARD.encode(body);
    // Two blocks of 12 bytes, the last of size 0: it is a full one.
    let [full_head, full_body] = blocks(&bytes, 12, 0);
    let full_blocks = STANDARD.encode(&full_head) + &STANDARD.encode(&full_body);
    let long = [&24_u64.to_be_bytes()[..], &VALUES.iter().flat_map(|v| v.to_be_bytes()).collect::<Vec<u8>>()].concat();
    let appended = |kind: &str, content: &[u8]| {
        let text = image(
            if content.len() > 40 { packed } else { "" },
            &array("format=\"appended\" offset=\"3\"", ""),
            &format!("<AppendedData encoding=\"{kind}\">\n _"),
        );
        let (before, after) = text.split_at(text.len() - "</VTKFile>".len());
        [before.as_bytes(), b"xyz", content, b"\n</AppendedData>", after.as_bytes()].concat()
    };
    let raw_blocks = [full_head, full_body].concat();
    for (what, file) in [
        ("ascii", own("format=\"ascii\"", "\n1 2 3.5\n-4e0 5 6\n").into_bytes()),
        ("one stream", own("format=\"binary\"", &format!("\n  {one_stream}\n")).into_bytes()),
        ("two streams", own("format=\"binary\"", &two_streams).into_bytes()),
        ("blocks", image(packed, &array("format=\"binary\"", &in_blocks), "").into_bytes()),
        ("full blocks", image(packed, &array("format=\"binary\"", &full_blocks), "").into_bytes()),
        (
            "long and big",
            image(
                "byte_order=\"BigEndian\" header_type=\"UInt64\"",
                &array("format=\"binary\"", &STANDARD.encode(long)),
                "",
            )
            .into_bytes(),
        ),
        ("appended raw", appended("raw", &[&length(24)[..], &bytes].concat())),
        ("appended base64", appended("base64", one_stream.as_bytes())),
        ("appended raw blocks", appended("raw", &raw_blocks)),
    ] {
        let field = one(load("a.vti", &file));
        assert_eq!(numbers(&field, 0), VALUES, "{what}");
        assert_eq!((field.name.as_str(), field.grid.size), ("a < b", [3, 2, 1]), "{what}");
        assert_eq!((field.grid.origin, field.grid.steps[0]), (DVec3::new(1.0, 2.0, 3.0), DVec3::X * 2.0), "{what}");
    }
}

#[test]
fn arrays_of_points_cells_and_the_file() {
    let data = "<PointData><DataArray type=\"UInt8\" Name=\"labels\" format=\"ascii\">0 1 2 3 4 5</DataArray>\
        <DataArray type=\"Float64\" Name=\"v\" NumberOfComponents=\"2\" format=\"ascii\">1 2 3 4 5 6 7 8 9 10 11 nan</DataArray>\
        <DataArray type=\"String\" Name=\"s\" format=\"ascii\">65 0</DataArray></PointData>\
        <CellData><DataArray type=\"Int16\" Name=\"labels\" format=\"ascii\">-7 8</DataArray></CellData>";
    let time = "<FieldData><DataArray type=\"Float64\" Name=\"TimeValue\" NumberOfTuples=\"1\" format=\"ascii\">2.5</DataArray></FieldData>";
    let file = load("a.vti", image("", data, "").replace("<Piece", &format!("{time}<Piece"))).unwrap();
    let names: Vec<&str> = file.fields.iter().map(|field| field.name.as_str()).collect();
    assert_eq!(names, ["labels", "v", "labels 2"]);
    assert_eq!(file.fields[0].steps[0].values, Values::U8(vec![0, 1, 2, 3, 4, 5]));
    assert_eq!(
        (file.fields[1].components, file.fields[1].scalar(0, crate::field::Component::Magnitude).missing),
        (2, 1)
    );
    assert_eq!((file.fields[2].grid.size, file.fields[2].grid.origin), ([2, 1, 1], DVec3::new(2.0, 2.5, 3.0)));
    assert_eq!(file.fields[2].steps[0].time, Some(2.5));
    assert_eq!(file.warnings, ["the array \"s\" is text; it is left out"]);
}

#[test]
fn pieces_are_joined() {
    let piece = |extent: &str, values: &str| {
        format!(
            "<Piece Extent=\"{extent}\"><PointData><DataArray type=\"UInt8\" Name=\"a\" format=\"ascii\">{values}</DataArray></PointData></Piece>"
        )
    };
    let file = |pieces: String| {
        format!(
            "<VTKFile type=\"ImageData\"><ImageData WholeExtent=\"-1 2 0 1 0 0\" Direction=\"0 -1 0 1 0 0 0 0 1\">{pieces}</ImageData></VTKFile>"
        )
    };
    let both = file(piece("-1 1 0 1 0 0", "1 2 3 5 6 7") + &piece("1 2 0 1 0 0", "3 4 7 8"));
    let field = one(load("a.vti", both));
    assert_eq!(field.steps[0].values, Values::U8((1..=8).collect()));
    // The columns of the direction are the axes; the first sample is at -1 along the first.
    assert_eq!((field.grid.origin, field.grid.steps[0], field.grid.steps[1]), (DVec3::NEG_Y, DVec3::Y, DVec3::NEG_X));
    let gap = load("a.vti", file(piece("-1 -1 0 1 0 0", "1 5") + &piece("2 2 0 1 0 0", "4 8"))).unwrap();
    assert_eq!(gap.fields[0].scalar(0, crate::field::Component::Magnitude).missing, 4);
    assert!(gap.warnings[0].contains("do not cover"), "{:?}", gap.warnings);
    let alone = load("a.vti", file(piece("1 2 0 1 0 0", "3 4 7 8"))).unwrap();
    assert_eq!(alone.fields[0].grid.origin, DVec3::Y);
    assert!(alone.warnings[0].contains("smaller than the whole"), "{:?}", alone.warnings);
    let cells = |extent: &str, values: &str| piece(extent, values).replace("PointData", "CellData");
    let both = file(cells("-1 1 0 1 0 0", "1 2") + &cells("1 2 0 1 0 0", "3"));
    assert_eq!(one(load("a.vti", both)).steps[0].values, Values::U8(vec![1, 2, 3]));
    let far = file(piece("-1 -1 0 0 0 0", "1") + &piece("2 2 1 1 0 0", "4"));
    assert!(refused(load("a.vti", far)).contains("have 2 of its 8 numbers"));
    let other = file(
        piece("-1 1 0 1 0 0", "1 2 3 5 6 7")
            + &piece("1 2 0 1 0 0", "3 4 7 8 3 4 7 8").replace("format", "NumberOfComponents=\"2\" format"),
    );
    assert!(refused(load("a.vti", other)).contains("1 components in another piece, and 2 here"));
}

#[test]
fn what_is_wrong_is_said() {
    let ascii = array("format=\"ascii\"", "1 2 3 4 5 6");
    let good = image("", &ascii, "");
    let binary = |bytes: &[u8]| image("", &array("format=\"binary\"", &STANDARD.encode(bytes)), "");
    let packed = |[head, body]: [Vec<u8>; 2]| {
        let text = STANDARD.encode(head) + &STANDARD.encode(body);
        image("compressor=\"vtkZLibDataCompressor\"", &array("format=\"binary\"", &text), "")
    };
    let bytes = little(&VALUES);
    let [head, body] = blocks(&bytes, 24, 24);
    for (file, wanted) in [
        (good.replace("\"ImageData\" ", "\"UnstructuredGrid\""), "line 2: the file holds UnstructuredGrid"),
        (good.replace("\"ImageData\" ", "\"PImageData\""), "an index of pieces"),
        (image("compressor=\"vtkLZ4DataCompressor\"", &ascii, ""), "compressed with vtkLZ4DataCompressor"),
        (image("header_type=\"UInt16\"", &ascii, ""), "UInt32 or UInt64"),
        (
            good.replace("0 2 0 1 0 0\" Origin", "0 2 0 1\" Origin"),
            "WholeExtent is \"0 2 0 1\"; the first and the last",
        ),
        (good.replace("Extent=\"0 2 0 1 0 0\">", "Extent=\"0 9 0 1 0 0\">"), "is not in the WholeExtent"),
        (good.replace("Spacing=\"2 1 1\"", "Spacing=\"2 1\""), "Spacing is \"2 1\"; 3 numbers"),
        (good.replace("Spacing=\"2 1 1\"", "Spacing=\"0 1 1\""), "neither 0"),
        (good.replace("Float32", "Float16"), "its type is \"Float16\""),
        (good.replace("ascii", "zip"), "ascii, binary or appended"),
        (good.replace("3 4 5 6", "3"), "6 numbers belong here, after 3"),
        (good.replace("format=\"ascii\"", "NumberOfComponents=\"x\" format=\"ascii\""), "\"x\" are no components"),
        (good.replace("ascii", "appended"), "there is no AppendedData"),
        (
            good.replace("ascii", "appended")
                .replace("</VTKFile>", "<AppendedData encoding=\"raw\">_x</AppendedData></VTKFile>"),
            "no offset",
        ),
        (
            good.replace("ascii\"", "appended\" offset=\"9999\"")
                .replace("</VTKFile>", "<AppendedData encoding=\"raw\">_x</AppendedData></VTKFile>"),
            "behind the end of the file",
        ),
        (binary(&[&length(20)[..], &bytes[..20]].concat()), "have 20 bytes, the extent needs 24"),
        (binary(&[&length(24)[..], &bytes[..20]].concat()), "24 bytes belong here, 20 are left"),
        (image("", &array("format=\"binary\"", "AAA?"), ""), "\"?\" is no digit of base64"),
        (packed(blocks(&bytes[..12], 12, 0)), "1 blocks have 12 bytes, the extent needs 24"),
        (packed([head.clone(), b"nonsense nonsense nonsense nonsense".to_vec()]), "damaged"),
        (packed([head.clone(), body[..9].to_vec()]), "are left"),
        (
            packed({
                let [mut head, body] = blocks(&bytes, 24, 23);
                head[4] = 25;
                head[8] = 25;
                [head, body]
            }),
            "block 0 has 24 bytes, 25 belong there",
        ),
        (
            packed({
                let [mut head, _] = blocks(&bytes, 24, 24);
                head[6] = 9;
                head[10] = 9;
                head[3] = 9;
                [head, Vec::new()]
            }),
            "bytes",
        ),
        (good.replace("<Piece", "<NoPiece"), "stands outside of a Piece"),
        (good.replace(&ascii, ""), "has no DataArray"),
        (good.replace("ImageData WholeExtent", "Image WholeExtent"), "a Piece stands outside of ImageData"),
        ("<VTKFile type=\"ImageData\"></VTKFile>".into(), "has no element ImageData"),
        (good.replace("<Piece ", "<Piece Extent "), "a tag of XML is damaged"),
        ("<html></html>".into(), "is XML, but no VTKFile"),
    ] {
        let message = refused(load("a.vti", &file));
        assert!(message.starts_with("d/a.vti") && message.contains(wanted), "{wanted}: {message}");
    }
}
