use glam::DVec3;

use crate::field::testing::{load, numbers, refused};

/// A name as classic files have it, padded to four bytes.
fn name(text: &str) -> Vec<u8> {
    let mut bytes = (text.len() as u32).to_be_bytes().to_vec();
    bytes.extend(text.bytes());
    bytes.resize(bytes.len().next_multiple_of(4), 0);
    bytes
}

fn word(n: u32) -> Vec<u8> {
    n.to_be_bytes().to_vec()
}

fn text_attribute(key: &str, value: &str) -> Vec<u8> {
    [name(key), word(2), name(value)].concat()
}

/// A classic file: `heat(time = 2, y = 2, x = 3)` as packed shorts with a fill value, `x(x)` as doubles, `time(time)` as doubles.
fn classic() -> Vec<u8> {
    let dimensions = [word(10), word(3), name("time"), word(2), name("y"), word(2), name("x"), word(3)].concat();
    let head = |begin: u32| {
        let heat = [
            name("heat"),
            word(3),
            word(0),
            word(1),
            word(2),
            word(12),
            word(4),
            text_attribute("units", "K"),
            [name("_FillValue"), word(3), word(1), vec![0xff, 0xff, 0, 0]].concat(),
            [name("scale_factor"), word(5), word(1), 0.5_f32.to_be_bytes().to_vec()].concat(),
            [name("add_offset"), word(5), word(1), 100_f32.to_be_bytes().to_vec()].concat(),
            word(3),
            word(24),
            word(begin),
        ];
        let x = [name("x"), word(1), word(2), word(0), word(0), word(6), word(24), word(begin + 24)];
        let time = [
            name("time"),
            word(1),
            word(0),
            word(12),
            word(1),
            text_attribute("units", "hours since 2000-01-01"),
            word(6),
            word(16),
            word(begin + 48),
        ];
        [
            b"CDF\x01".to_vec(),
            word(0),
            dimensions.clone(),
            word(0),
            word(0),
            word(11),
            word(3),
            heat.concat(),
            x.concat(),
            time.concat(),
        ]
        .concat()
    };
    let begin = head(0).len() as u32;
    let shorts: Vec<u8> = [1_i16, 2, 3, 4, 5, 6, 7, 8, 9, 10, -1, 12].iter().flat_map(|n| n.to_be_bytes()).collect();
    let doubles = |all: &[f64]| all.iter().flat_map(|n| n.to_be_bytes()).collect::<Vec<u8>>();
    [head(begin), shorts, doubles(&[5.0, 7.0, 9.0]), doubles(&[0.0, 6.0])].concat()
}

#[test]
fn classic_files() {
    let file = load("a.nc", classic()).unwrap();
    assert_eq!((file.format, file.fields.len()), ("NetCDF", 1));
    let heat = &file.fields[0];
    assert_eq!((heat.name.as_str(), heat.unit.as_deref(), heat.grid.size), ("heat", Some("K"), [3, 2, 1]));
    assert_eq!((heat.grid.origin, heat.grid.steps[0]), (DVec3::X * 5.0, DVec3::X * 2.0));
    assert_eq!(heat.steps.iter().map(|step| step.time).collect::<Vec<_>>(), [Some(0.0), Some(6.0)]);
    assert_eq!(numbers(heat, 0), [100.5, 101.0, 101.5, 102.0, 102.5, 103.0]);
    assert!(numbers(heat, 1)[4].is_nan() && numbers(heat, 1)[5] == 106.0);
}

#[test]
fn coordinates_that_go_round_are_counted() {
    let mut bytes = classic();
    let x = bytes.len() - 40;
    bytes[x..x + 8].copy_from_slice(&100_f64.to_be_bytes());
    let file = load("a.nc", &bytes).unwrap();
    assert!(file.warnings[0].contains("the x coordinates must be finite and always rise or fall; they are counted"));
    assert_eq!((file.fields[0].grid.origin, file.fields[0].grid.steps[0]), (DVec3::ZERO, DVec3::X));
}

#[test]
fn damage_is_said() {
    let whole = classic();
    for length in 4..whole.len() {
        if let Err(error) = load("a.nc", &whole[..length]) {
            assert!(error.to_string().starts_with("d/a.nc: "), "{error}");
        }
    }
    assert!(refused(load("a.nc", &whole[..40])).contains("is damaged NetCDF"));
}
