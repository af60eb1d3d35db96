use glam::DVec3;

use crate::field::{
    Component, Values,
    testing::{big, gzip, load, load_with, numbers, one, refused},
};

/// Places of 2 × 3 × 1 samples, and their cells.
const GRID: &str = "object \"p\" class gridpositions counts 2 3 1\n origin 1 2 3\n delta 10 0 0\n delta 0 5 0\n delta 0 0 1\n\
    attribute \"dep\" string \"positions\"\nobject \"c\" class gridconnections counts 2 3 1\n attribute \"element type\" string \"cubes\"\n";
const FIELD: &str = "object \"heat\" class field\ncomponent \"positions\" value \"p\"\ncomponent \"connections\" \"c\"\ncomponent \"data\" value \"d\"\nend\n";
const VALUES: [f32; 6] = [1.0, 2.0, 3.0, 4.0, 5.0, 6.5];

fn file(data: &str) -> String {
    format!("# a comment\n{GRID}{data}\n{FIELD}")
}

#[test]
fn numbers_may_be_anywhere() {
    // The last axis is the fastest in the file, the first here.
    let wanted = [1.0, 4.0, 2.0, 5.0, 3.0, 6.5];
    let object = "object \"d\" class array type float rank 0 items 6";
    let behind = |text: String, bytes: &[u8]| [text.as_bytes(), bytes].concat();
    let little: Vec<u8> = VALUES.iter().flat_map(|v| v.to_le_bytes()).collect();
    let beside: [(&str, &[u8]); 3] =
        [("b.bin", &big(&VALUES)), ("b.txt", b"xx 1 2 3 4 5 6.5"), ("b.gz", &gzip(&big(&VALUES)))];
    let follows_in_bytes = {
        let text = file(&format!("{object} lsb binary data follows\n@"));
        let (before, after) = text.split_once('@').unwrap();
        [before.as_bytes(), &little, after.as_bytes()].concat()
    };
    for (what, bytes) in [
        ("follows", file(&format!("{object} data follows\n1 2 3, 4 5 6.5")).into_bytes()),
        (
            "follow",
            file(&format!("{object} ascii data follow 1 2 3 4 5 6.5 attribute \"dep\" string \"positions\""))
                .into_bytes(),
        ),
        ("offset, msb", behind(file(&format!("{object} msb ieee data 4")), &[&[9; 4], &big(&VALUES)[..]].concat())),
        ("offset, lsb", behind(file(&format!("{object} data lsb ieee 0")), &little)),
        ("offset, text", behind(file(&format!("{object} text data 1")), b" 1 2 3 4 5 6.5")),
        ("lsb follows", follows_in_bytes),
        ("file", file(&format!("{object} msb ieee data file \"b.bin\",0")).into_bytes()),
        ("file name", file(&format!("{object} msb ieee data b.bin")).into_bytes()),
        ("text file", file(&format!("{object} data b.txt,2")).into_bytes()),
        ("packed file", file(&format!("{object} msb ieee data file b.gz")).into_bytes()),
    ] {
        let field = one(load_with("a.dx", &bytes, &beside));
        assert_eq!(numbers(&field, 0), wanted, "{what}");
        assert_eq!((field.name.as_str(), field.grid.size), ("heat", [2, 3, 1]), "{what}");
        assert_eq!((field.grid.origin, field.grid.steps[1]), (DVec3::new(1.0, 2.0, 3.0), DVec3::Y * 5.0), "{what}");
    }
    assert_eq!(
        numbers(
            &one(load_with("a.dx.gz", gzip(file(&format!("{object} data follows\n1 2 3 4 5 6.5")).as_bytes()), &[])),
            0
        ),
        wanted
    );
}

#[test]
fn types_vectors_and_cells() {
    for (kind, is_bytes) in [
        ("byte", true),
        ("unsigned byte", true),
        ("ubyte", true),
        ("signed byte", false),
        ("short", false),
        ("uint", false),
        ("double", false),
    ] {
        let field = one(load(
            "a.dx",
            file(&format!("object \"d\" class array type {kind} rank 0 items 6 data follows 1 2 3 4 5 6")),
        ));
        assert_eq!((matches!(field.steps[0].values, Values::U8(_)), field.is_integer), (is_bytes, true), "{kind}");
    }
    let vectors = "object \"d\" class array type float rank 1 shape 2 items 6 data follows 1 2 3 4 5 6 7 8 9 10 11 12";
    let field = one(load("a.dx", file(vectors)));
    assert_eq!((field.components, field.scalar(0, Component::Index(1)).range), (2, Some([2.0, 12.0])));
    let complex =
        "object \"d\" class array type float category complex items 6 data follows 1 2 3 4 5 6 7 8 9 10 11 12";
    assert_eq!(one(load("a.dx", file(complex))).components, 2);
    let cells = "object \"d\" class array type int items 2 data follows 7 8 attribute \"dep\" string \"connections\"";
    let field = one(load("a.dx", file(cells)));
    assert_eq!(
        (numbers(&field, 0), field.grid.size, field.grid.origin),
        (vec![7.0, 8.0], [1, 2, 1], DVec3::new(6.0, 4.5, 3.0))
    );
}

#[test]
fn what_is_invalid_is_missing() {
    let data = "object \"d\" class array type float items 6 data follows 1 2 3 4 5 6\nobject \"i\" class array type byte items 6 data follows 0 1 0 0 0 1";
    let text = file(data).replace("component \"data\"", "component \"invalid positions\" \"i\" component \"data\"");
    assert_eq!(one(load("a.dx", text)).scalar(0, Component::Magnitude).missing, 2);
    let other = file(&data.replace("items 6 data follows 0 1 0 0 0 1", "items 1 data follows 3"));
    let other =
        load("a.dx", other.replace("component \"data\"", "component \"invalid positions\" \"i\" component \"data\""))
            .unwrap();
    assert!(other.warnings[0].contains("in a way that is not read"), "{:?}", other.warnings);
}

#[test]
fn series_and_groups() {
    let array = |name: &str, numbers: &str| {
        format!("object \"{name}\" class array type float items 6 data follows {numbers}\n")
    };
    let field = |name: u32, data: &str| {
        format!(
            "object {name} class field component \"positions\" \"p\" component \"connections\" \"c\" component \"data\" \"{data}\"\n"
        )
    };
    let base = format!(
        "{GRID}{}{}{}{}",
        array("d", "1 2 3 4 5 6"),
        array("e", "7 8 9 10 11 12"),
        field(7, "d"),
        field(8, "e")
    );
    let series = format!(
        "{base}object \"s\" class series member 0 position 2.5 value 7 member 1 value 8 position 4 attribute \"name\" string \"rain\"\nend\n"
    );
    let found = one(load("a.dx", series));
    assert_eq!(
        (found.name.as_str(), found.steps.iter().map(|s| s.time).collect::<Vec<_>>()),
        ("rain", vec![Some(2.5), Some(4.0)])
    );
    assert_eq!(numbers(&found, 1)[0], 7.0);
    let group = format!(
        "{base}object \"default\" class group member \"one\" value 7 member \"two\" 8\nobject 9 class light\nend\n"
    );
    let found = load("a.dx", group).unwrap();
    assert_eq!(found.fields.iter().map(|f| f.name.as_str()).collect::<Vec<_>>(), ["one", "two"]);
    assert_eq!(found.warnings, ["the object \"9\" is a light; it is left out"]);
    let loose = load("a.dx", format!("{base}end\n")).unwrap();
    assert_eq!(loose.fields.iter().map(|f| f.name.as_str()).collect::<Vec<_>>(), ["a", "a 2"], "numbers are no names");
    let circle = format!(
        "{base}object 20 class group member 0 21\nobject 21 class group member 0 20\nobject 22 class group member 0 20\nend\n"
    );
    assert!(refused(load("a.dx", circle)).contains("groups are too deep"));
    let uneven = series_of("8").replace(
        "object 8 class field component \"positions\" \"p\"",
        "object 8 class field component \"positions\" \"q\"",
    );
    assert!(refused(load("a.dx", uneven)).contains("another grid than the first"));
    let with_six =
        |member: &str| series_of(member).replace("items 2 data follows 1 2\n", "items 6 data follows 1 2 3 4 5 6\n");
    assert!(refused(load("a.dx", with_six("p"))).contains("but no field"));
    assert!(refused(load("a.dx", with_six("nobody"))).contains("refers to the object \"nobody\", which is not there"));
}

fn series_of(member: &str) -> String {
    format!(
        "{GRID}object \"q\" class gridpositions counts 1 2 1 origin 0 0 0 delta 1 0 0 delta 0 1 0 delta 0 0 1\n\
        object \"d\" class array type float items 6 data follows 1 2 3 4 5 6\nobject \"e\" class array type float items 2 data follows 1 2\n\
        object 7 class field component \"positions\" \"p\" component \"data\" \"d\"\n\
        object 8 class field component \"positions\" \"p\" component \"data\" \"e\"\n\
        object \"s\" class series member 0 position 1 value 7 member 1 position 2 value {member}\nend\n"
    )
}

#[test]
fn places_may_be_explicit() {
    let explicit = |points: &str| {
        format!(
            "object \"p\" class array type float rank 1 shape 2 items 6 data follows {points}\nobject \"c\" class gridconnections counts 2 3\n\
            object \"d\" class array type float items 6 data follows 1 2 3 4 5 6\n{FIELD}"
        )
    };
    let regular = load("a.dx", explicit("0 0 0 1 0 2  4 0 4 1 4 2")).unwrap();
    assert_eq!((regular.warnings.len(), regular.fields[0].grid.size), (0, [2, 3, 1]));
    assert_eq!((regular.fields[0].grid.steps[0], numbers(&regular.fields[0], 0)[1]), (DVec3::X * 4.0, 4.0));
    let curved = load("a.dx", explicit("0 0 0 1 0 2  4 0 4 1 5 3")).unwrap();
    assert!(
        curved.warnings[0].contains("2 × 3 × 1 samples on a curved grid; resampled bilinearly"),
        "{:?}",
        curved.warnings
    );
    let scattered = explicit("0 0 0 1 0 2  4 0 4 1 5 3").replace("component \"connections\" \"c\"\n", "");
    let scattered = load("a.dx", scattered).unwrap();
    assert!(scattered.warnings[0].contains("6 scattered places"), "{:?}", scattered.warnings);
    assert_eq!(scattered.fields[0].grid.size, [128, 77, 1]);
    let product = format!(
        "object 1 class regulararray items 2 origin 1 0 delta 3 0\nobject 2 class array type float rank 1 shape 2 items 3 data follows 0 5 0 6 0 7\n\
        object \"p\" class productarray term 1 term 2\nobject \"c\" class gridconnections counts 2 3\n\
        object \"d\" class array type float items 6 data follows 1 2 3 4 5 6\n{FIELD}"
    );
    let product = one(load("a.dx", product));
    assert_eq!(
        (product.grid.size, product.grid.origin, product.grid.steps[1]),
        ([2, 3, 1], DVec3::new(1.0, 5.0, 0.0), DVec3::Y)
    );
}

#[test]
fn what_is_wrong_is_said() {
    let good = file("object \"d\" class array type float rank 0 items 6 data follows\n1 2 3 4 5 6");
    for (from, to, wanted) in [
        ("items 6", "items 7", "7 numbers belong here, after 6 comes \"object\""),
        ("items 6", "items six", "line 10: \"six\" stands where the number of items belongs"),
        (
            "items 6 data follows\n1 2 3 4 5 6",
            "items 5 data follows 1 2 3 4 5",
            "has 5 items, but the grid has 2 × 3 × 1",
        ),
        ("type float", "type string", "the type is string"),
        ("type float", "type half", "the type is \"half\""),
        ("rank 0", "shape 2000", "an item has 2000 numbers"),
        ("rank 0", "category odd", "real, complex or quaternion"),
        ("rank 0", "color red", "\"color\" is no keyword"),
        ("rank 0", "\"rank\" 0", "in quotes stands where a keyword belongs"),
        ("data follows\n1 2 3 4 5 6", "", "has no `data`"),
        ("data follows\n1 2 3 4 5 6", "ieee data 0", "24 bytes belong there, 0 are left"),
        ("data follows\n1 2 3 4 5 6", "shape 99 ieee data follows\n", "2376 bytes belong behind it"),
        ("data follows\n1 2 3 4 5 6", "ieee data b.bin", "d/b.bin: cannot be read"),
        ("data follows\n1 2 3 4 5 6", "ieee data /b.bin", "below its own folder"),
        ("class array type", "type", "the object has no class"),
        ("counts 2 3 1\n origin", "counts 2 3 1 4\n origin", "has 4 axes"),
        ("delta 0 5 0\n", "", "the grid has 3 axes and 2 deltas"),
        ("delta 0 5 0\n", "delta 1 0 0\n", "in one plane"),
        ("component \"data\" value \"d\"", "", "the field has no component \"data\""),
        ("component \"positions\" value \"p\"", "", "the field has no component \"positions\""),
        ("value \"p\"", "value \"d\"", "flat volume"),
        ("value \"p\"", "value \"c\"", "these are no places"),
        ("value \"d\"", "value \"p\"", "must be an object of class array"),
        ("value \"d\"", "file \"f.dx\" \"d\"", "objects of other files are not read"),
        ("# a comment", "what", "\"what\" stands where `object` or `end` belongs"),
        ("end\n", "component \"x\"", "`component` names no object"),
        ("end\n", "attribute \"x\"", "`attribute` is followed by the end of the file"),
    ] {
        assert!(good.contains(from), "{from}");
        let message = match load("a.dx", good.replacen(from, to, 1)) {
            Err(error) => error.to_string(),
            Ok(found) => found.warnings.concat(),
        };
        assert!(message.contains(wanted), "{wanted}: {message}");
    }
}
