use glam::DVec3;

use crate::field::{
    Values,
    testing::{big, load, numbers, one, refused},
};

fn ascii(body: &str) -> String {
    format!("# vtk DataFile Version 3.0\na title\nASCII\n{body}")
}

const POINTS: &str = "DATASET STRUCTURED_POINTS\nDIMENSIONS 3 2 1\nORIGIN 1 2 3\nSPACING 2 1 1\n";

#[test]
fn structured_points_as_text() {
    let body = format!(
        "{POINTS}POINT_DATA 6\nSCALARS heat float 1\nLOOKUP_TABLE default\n1 2 3 4 5 6.5\nVECTORS wind%20at%2520 double\n{}\n\
        METADATA\nINFORMATION 1\nNAME L2_NORM_RANGE LOCATION vtkDataArray\nDATA 2 1 2\n\nSCALARS bare int\n1 2 3 4 5 6\n\
        LOOKUP_TABLE mine 2\n0 0 0 1\n1 1 1 1\nCOLOR_SCALARS c 2\n{}\nTEXTURE_COORDINATES t 1 float\n1 2 3 4 5 6\n\
        CELL_DATA 2\nFIELD FieldData 2\na 1 2 unsigned_char\n7 8\nb 2 2 long\n1 2\n3 4\n",
        "0 1 2 ".repeat(6),
        "0.5 1 ".repeat(6),
    );
    let file = load("a.vtk", ascii(&body)).unwrap();
    let names: Vec<&str> = file.fields.iter().map(|field| field.name.as_str()).collect();
    assert_eq!(names, ["heat", "wind at%20", "bare", "c", "t", "a", "b"]);
    let heat = &file.fields[0];
    assert_eq!((numbers(heat, 0)[5], heat.grid.origin, heat.is_integer), (6.5, DVec3::new(1.0, 2.0, 3.0), false));
    assert_eq!((file.fields[1].components, numbers(&file.fields[1], 0)[5]), (3, 2.0));
    assert_eq!((file.fields[5].steps[0].values.clone(), file.fields[5].grid.size), (Values::U8(vec![7, 8]), [2, 1, 1]));
    assert_eq!(file.fields[6].grid.origin, DVec3::new(2.0, 2.5, 3.0));
}

#[test]
fn bytes_are_big_endian() {
    let values = [1.0, -2.0, 3.5, 4.0, 5.0, 6.0];
    let head = format!("# vtk DataFile Version 4.2\nt\nBINARY\n{POINTS}POINT_DATA 6\n");
    let scalars = [format!("{head}SCALARS a float\nLOOKUP_TABLE default\n").as_bytes(), &big(&values), b"\n"].concat();
    assert_eq!(numbers(&one(load("a.vtk", &scalars)), 0), values);
    // Without a table, bytes begin behind the line.
    let bare = [format!("{head}SCALARS a float\n").as_bytes(), &big(&values)].concat();
    assert_eq!(numbers(&one(load("a.vtk", &bare)), 0), values);
    let bits = [format!("{head}SCALARS a bit\nLOOKUP_TABLE default\n").as_bytes(), &[0b1010_0100]].concat();
    assert_eq!(one(load("a.vtk", &bits)).steps[0].values, Values::U8(vec![1, 0, 1, 0, 0, 1]));
    let text = [&[2 | 3 << 6][..], b"ab", &[1 | 3 << 6], b"c"].concat();
    let doubles: Vec<u8> = [1_f64, 2.0, 3.0, 4.0, 5.0, 6.0].iter().flat_map(|v| v.to_be_bytes()).collect();
    let field = [
        format!("{head}FIELD FieldData 2\nnames 1 2 string\n").as_bytes(),
        &text,
        b"\nb 1 6 double\n",
        &doubles,
        b"\nMETADATA\nINFORMATION 0\n\n",
    ]
    .concat();
    let file = load("a.vtk", &field).unwrap();
    assert_eq!(
        (numbers(&file.fields[0], 0)[5], &file.warnings[0][..]),
        (6.0, "the array \"names\" is text; it is left out")
    );
    let short = refused(load("a.vtk", &scalars[..scalars.len() - 3]));
    assert!(short.contains("the array \"a\": 24 bytes belong here, 22 are left"), "{short}");
}

#[test]
fn rectilinear_grids() {
    let rectilinear = |x: &str, rest: &str| {
        ascii(&format!(
            "DATASET RECTILINEAR_GRID\nDIMENSIONS 3 2 1\nX_COORDINATES 3 float\n{x}\nY_COORDINATES 2 float\n0 5\nZ_COORDINATES 1 float\n7\n{rest}"
        ))
    };
    let data = "FIELD FieldData 1\nTIME 1 1 double\n2.5\nPOINT_DATA 6\nSCALARS a float\nLOOKUP_TABLE default\n0 10 30 1 11 31\n";
    let even = load("a.vtk", rectilinear("1 2 3", data)).unwrap();
    assert_eq!((even.warnings.len(), even.fields[0].grid.origin), (0, DVec3::new(1.0, 0.0, 7.0)));
    assert_eq!((even.fields[0].steps[0].time, even.fields[0].grid.steps[1]), (Some(2.5), DVec3::Y * 5.0));
    let uneven = load("a.vtk", rectilinear("1 2 4", data)).unwrap();
    assert!(uneven.warnings[0].contains("uneven spacing; resampled linearly"), "{:?}", uneven.warnings);
    let field = &uneven.fields[0];
    let x = |i: usize| field.grid.position(DVec3::new(i as f64, 0.0, 0.0)).x;
    for i in 0..field.grid.size[0] {
        assert!((f64::from(numbers(field, 0)[i]) - (x(i) - 1.0) * 10.0).abs() < 1e-5, "at {}", x(i));
    }
    let cells = one(load("a.vtk", rectilinear("1 2 3", "CELL_DATA 2\nSCALARS a float\nLOOKUP_TABLE default\n0 10\n")));
    assert_eq!((cells.grid.size, cells.grid.origin), ([2, 1, 1], DVec3::new(1.5, 2.5, 7.0)));
}

#[test]
fn structured_grids() {
    let grid = |points: &str, data: &str| {
        ascii(&format!("DATASET STRUCTURED_GRID\nDIMENSIONS 2 2 2\nPOINTS 8 float\n{points}\n{data}\n"))
    };
    let data = "POINT_DATA 8\nSCALARS a float\nLOOKUP_TABLE default\n0 1 2 3 4 5 6 7\nSCALARS b float\nLOOKUP_TABLE default\n0 1 2 3 4 5 6 7";
    let box_points = "0 0 0 1 0 0  0 1 0 1 1 0  0 0 1 1 0 1  0 1 1 1 1 1";
    let regular = load("a.vtk", grid(box_points, data)).unwrap();
    assert_eq!((regular.warnings.len(), numbers(&regular.fields[1], 0)[7]), (0, 7.0));
    let bent = load("a.vtk", grid(&box_points.replace("1 1 1", "2 2 1"), data)).unwrap();
    assert!(bent.warnings[0].contains("curved grid") && bent.warnings.len() == 2, "{:?}", bent.warnings);
    let cell = grid(
        "0 0 0 1 0 0  0 1 0 1 1 0  0 0 1 1 0 1  0 1 1 2 2 1",
        "CELL_DATA 1\nSCALARS a float\nLOOKUP_TABLE default\n5",
    );
    assert_eq!(numbers(&one(load("a.vtk", cell)), 0), [5.0]);
}

#[test]
fn what_is_wrong_is_said() {
    let good = ascii(&format!("{POINTS}POINT_DATA 6\nSCALARS a float 1\nLOOKUP_TABLE default\n1 2 3 4 5 6\n"));
    for (from, to, wanted) in [
        ("ASCII", "TEXT", "line 3: the third line must be ASCII or BINARY"),
        ("STRUCTURED_POINTS", "POLYDATA", "line 4: the data set is POLYDATA"),
        ("DIMENSIONS 3 2 1", "DIMENSIONS 3 2 x", "\"x\" stands where samples along x, y and z belongs"),
        ("DIMENSIONS 3 2 1", "DIMENSIONS 3 2 2", "data for 6 samples, but the grid has 3 × 2 × 2"),
        ("DIMENSIONS 3 2 1", "DIMENSIONS 0 2 1", "data for 6 samples"),
        ("SPACING 2 1 1", "SPACING 0 1 1", "neither 0"),
        ("SPACING 2 1 1", "SPACE 2 1 1", "\"SPACE\" is no keyword"),
        ("ORIGIN 1 2 3", "ORIGIN 1 2 z", "an origin of three coordinates belongs here"),
        ("float 1", "half 1", "\"half\" is no type of numbers"),
        ("float 1", "float one", "\"one\" stands where the number of components belongs"),
        ("float 1", "float 2", "12 numbers belong here, after 6 comes \"the end\""),
        ("float 1", "float 0", "0 components"),
        ("SCALARS a", "SCALES a", "\"SCALES\" is no kind of data"),
        ("DATASET STRUCTURED_POINTS\n", "", "there is no DATASET before it"),
        ("SCALARS a float 1\nLOOKUP_TABLE default", "FIELD f 1\na 1 7 float", "has 7 samples, 6 belong there"),
        ("SCALARS a float 1\nLOOKUP_TABLE default", "FIELD f 2\na 1 6 float", "the name of an array belongs here"),
        ("1 2 3 4 5 6", "1 2 three", "the array \"a\": 6 numbers belong here, after 2 comes \"three\""),
    ] {
        assert!(good.contains(from));
        let message = refused(load("a.vtk", good.replace(from, to)));
        assert!(message.starts_with("d/a.vtk, line ") && message.contains(wanted), "{wanted}: {message}");
    }
    let nothing = refused(load("a.vtk", ascii(POINTS)));
    assert_eq!(nothing, "d/a.vtk: has no array of numbers on a grid");
    let curved = "DATASET STRUCTURED_GRID\nDIMENSIONS 2 2 1\nPOINTS 3 float\n0 0 0 1 0 0 0 1 0\nPOINT_DATA 4\nSCALARS a int\nLOOKUP_TABLE default\n1 2 3 4\n";
    assert!(refused(load("a.vtk", ascii(curved))).contains("not as many POINTS as DIMENSIONS"));
    let axes = "DATASET RECTILINEAR_GRID\nDIMENSIONS 2 2 1\nX_COORDINATES 3 float\n1 2 3\nPOINT_DATA 4\nSCALARS a int\nLOOKUP_TABLE default\n1 2 3 4\n";
    assert!(refused(load("a.vtk", ascii(axes))).contains("not as many X_, Y_ and Z_COORDINATES"));
}
