use glam::DVec3;

use crate::field::{
    Component, Values,
    testing::{gzip, load, load_with, numbers, one, refused},
};

/// A header of an image of these dimensions and this type.
struct Made {
    bytes: Vec<u8>,
    is_big: bool,
}

impl Made {
    fn new(is_big: bool, dimensions: &[i16], kind: i16) -> Self {
        let mut made = Self { bytes: vec![0; 348], is_big };
        made.put(0, &348_i32.to_le_bytes());
        made.shorts(40, &[&[dimensions.len() as i16], dimensions].concat());
        made.shorts(70, &[kind]);
        made.floats(76, &[1.0, 2.0, 3.0, 4.0, 0.5]);
        made.floats(108, &[352.0, 0.0, 0.0]);
        made.bytes[344..348].copy_from_slice(b"n+1\0");
        made
    }

    fn put(&mut self, at: usize, little: &[u8]) {
        let mut own = little.to_vec();
        if self.is_big {
            own.reverse();
        }
        self.bytes[at..at + own.len()].copy_from_slice(&own);
    }

    fn shorts(&mut self, at: usize, all: &[i16]) {
        all.iter().enumerate().for_each(|(i, n)| self.put(at + 2 * i, &n.to_le_bytes()));
    }

    fn floats(&mut self, at: usize, all: &[f32]) {
        all.iter().enumerate().for_each(|(i, n)| self.put(at + 4 * i, &n.to_le_bytes()));
    }

    fn with(&self, data: &[u8]) -> Vec<u8> {
        [&self.bytes[..], &[0; 4], data].concat()
    }
}

#[test]
fn types_in_both_orders() {
    for (kind, little) in [
        (2, vec![1_u8, 2]),
        (256, vec![1, 2]),
        (4, [1_i16, 2].iter().flat_map(|n| n.to_le_bytes()).collect()),
        (512, [1_u16, 2].iter().flat_map(|n| n.to_le_bytes()).collect()),
        (8, [1_i32, 2].iter().flat_map(|n| n.to_le_bytes()).collect()),
        (768, [1_u32, 2].iter().flat_map(|n| n.to_le_bytes()).collect()),
        (1024, [1_i64, 2].iter().flat_map(|n| n.to_le_bytes()).collect()),
        (1280, [1_u64, 2].iter().flat_map(|n| n.to_le_bytes()).collect()),
        (16, [1_f32, 2.0].iter().flat_map(|n| n.to_le_bytes()).collect()),
        (64, [1_f64, 2.0].iter().flat_map(|n| n.to_le_bytes()).collect()),
    ] {
        let field = one(load("a.nii", Made::new(false, &[2], kind).with(&little)));
        assert_eq!((numbers(&field, 0), field.grid.size), (vec![1.0, 2.0], [2, 1, 1]), "{kind}");
        let size = little.len() / 2;
        let big: Vec<u8> = little.chunks(size).flat_map(|n| n.iter().rev().copied()).collect();
        assert_eq!(
            numbers(&one(load("a.nii.gz", gzip(&Made::new(true, &[2], kind).with(&big)))), 0),
            [1.0, 2.0],
            "{kind}"
        );
    }
}

#[test]
fn places_scales_and_times() {
    let mut made = Made::new(true, &[2, 1, 1, 3], 2);
    made.bytes[123] = 2 | 8;
    made.floats(136, &[10.0]);
    let file = load("head.nii", made.with(&[1, 2, 3, 4, 5, 6])).unwrap();
    let field = &file.fields[0];
    assert_eq!((field.name.as_str(), field.steps[1].values.clone()), ("head", Values::U8(vec![3, 4])));
    assert_eq!(field.steps.iter().map(|s| s.time).collect::<Vec<_>>(), [Some(10.0), Some(10.5), Some(11.0)]);
    assert_eq!(
        (field.grid.steps[0], &file.warnings[..]),
        (DVec3::X * 2.0, &["lengths are in mm".to_owned(), "times are in s".to_owned()][..])
    );
    made.floats(112, &[0.5, 100.0]);
    assert_eq!(numbers(&one(load("a.nii", made.with(&[1, 2, 3, 4, 5, 6]))), 2), [102.5, 103.0]);
    // A turn by a quarter round z, with z the other way.
    let mut turned = Made::new(false, &[2, 2, 2], 2);
    turned.shorts(252, &[1, 0]);
    turned.floats(256, &[0.0, 0.0, 0.5_f32.sqrt(), 7.0, 8.0, 9.0]);
    turned.floats(76, &[-1.0]);
    let grid = one(load("a.nii", turned.with(&[0; 8]))).grid;
    let wanted = [DVec3::Y * 2.0, DVec3::X * -3.0, DVec3::Z * -4.0];
    assert!((0..3).all(|i| (grid.steps[i] - wanted[i]).length() < 1e-6), "{:?}", grid.steps);
    assert_eq!(grid.origin, DVec3::new(7.0, 8.0, 9.0));
    // A matrix goes before it.
    turned.shorts(254, &[2]);
    turned.floats(280, &[0.0, 0.0, 5.0, 1.0, 6.0, 0.0, 0.0, 2.0, 0.0, 7.0, 0.0, 3.0]);
    let grid = one(load("a.nii", turned.with(&[0; 8]))).grid;
    assert_eq!(
        (grid.steps, grid.origin),
        ([DVec3::Y * 6.0, DVec3::Z * 7.0, DVec3::X * 5.0], DVec3::new(1.0, 2.0, 3.0))
    );
}

#[test]
fn vectors_and_colours() {
    let vectors = one(load("a.nii", Made::new(false, &[2, 1, 1, 1, 3], 2).with(&[1, 2, 3, 4, 5, 6])));
    assert_eq!((vectors.components, numbers(&vectors, 0)), (3, vec![1.0, 3.0, 5.0, 2.0, 4.0, 6.0]));
    let colours = one(load("a.nii", Made::new(false, &[2], 128).with(&[1, 2, 3, 4, 5, 6])));
    assert_eq!((colours.components, colours.scalar(0, Component::Index(2)).range), (3, Some([3.0, 6.0])));
}

#[test]
fn numbers_may_be_beside() {
    let mut made = Made::new(false, &[2], 2);
    made.bytes[344..348].copy_from_slice(b"ni1\0");
    made.floats(108, &[1.0]);
    assert_eq!(numbers(&one(load_with("a.hdr", &made.bytes, &[("a.img", &[9, 1, 2])])), 0), [1.0, 2.0]);
    let packed = gzip(&[9, 1, 2]);
    assert_eq!(numbers(&one(load_with("a.hdr.gz", gzip(&made.bytes), &[("a.img.gz", &packed)])), 0), [1.0, 2.0]);
    assert!(refused(load("a.hdr", &made.bytes)).starts_with("d/a.img: cannot be read"));
    let short = refused(load_with("a.hdr", &made.bytes, &[("a.img", &[9, 1])]));
    assert!(short.starts_with("d/a.img, byte 1") && short.contains("need 2 bytes, there are 1"), "{short}");
}

#[test]
fn what_is_wrong_is_said() {
    let with = |change: &dyn Fn(&mut Made)| {
        let mut made = Made::new(false, &[2, 2, 1], 2);
        change(&mut made);
        refused(load("a.nii", made.with(&[1, 2, 3, 4])))
    };
    for (message, wanted) in [
        (with(&|m| m.put(0, &540_i32.to_le_bytes())), "byte 0: the file is NIfTI-2"),
        (with(&|m| m.bytes[344] = 0), "byte 344: \"n+1\" or \"ni1\" belongs here"),
        (with(&|m| m.shorts(40, &[9])), "byte 40: the file has 9 dimensions"),
        (with(&|m| m.shorts(42, &[-1])), "dimension 1 has -1 samples"),
        (with(&|m| m.shorts(40, &[6, 1, 1, 1, 1, 1, 2])), "more than 5 dimensions"),
        (with(&|m| m.shorts(70, &[1])), "byte 70: the datatype is 1"),
        (with(&|m| m.shorts(42, &[3])), "need 6 bytes, there are 4"),
        (with(&|m| m.shorts(42, &[3000])), "at most 2048"),
        (with(&|m| m.shorts(254, &[1])), "byte 252: the grid begins at"),
        (refused(load("a.nii", &Made::new(false, &[2], 2).bytes[..300])), "no header of NIfTI-1"),
    ] {
        assert!(message.contains(wanted), "{wanted}: {message}");
    }
}
