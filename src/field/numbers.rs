//! Numbers as files pack them, and how they lie: made into values in the order of grids.

use std::borrow::Cow;

use crate::field::data::Values;

/// The type of a number in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "the names say all")]
pub enum NumberKind {
    U8,
    I8,
    U16,
    I16,
    U32,
    I32,
    U64,
    I64,
    F32,
    F64,
}

impl NumberKind {
    /// Bytes of a number, 1 to 8.
    pub fn bytes(self) -> usize {
        match self {
            Self::U8 | Self::I8 => 1,
            Self::U16 | Self::I16 => 2,
            Self::U32 | Self::I32 | Self::F32 => 4,
            Self::U64 | Self::I64 | Self::F64 => 8,
        }
    }
}

/// Packed numbers of one type.
#[derive(Clone, Debug)]
pub struct Numbers<'a> {
    /// Their type.
    pub kind: NumberKind,
    /// Whether the most significant byte is first.
    pub is_big: bool,
    /// The bytes; behind the last number there may be more.
    pub bytes: Cow<'a, [u8]>,
}

impl<'a> Numbers<'a> {
    /// Numbers in these bytes.
    pub fn packed(kind: NumberKind, is_big: bool, bytes: impl Into<Cow<'a, [u8]>>) -> Self {
        Self { kind, is_big, bytes: bytes.into() }
    }

    /// No numbers, with room for so many.
    pub fn with_room(kind: NumberKind, count: usize) -> Self {
        Self { kind, is_big: false, bytes: Cow::Owned(Vec::with_capacity(count.saturating_mul(kind.bytes()))) }
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.bytes.len() / self.kind.bytes()
    }

    /// Adds a number, as near as its type can have it; of numbers that are little-endian.
    pub fn push(&mut self, value: f64) {
        let bytes = self.bytes.to_mut();
        match self.kind {
            NumberKind::U8 => bytes.push(value as u8),
            NumberKind::I8 => bytes.extend((value as i8).to_le_bytes()),
            NumberKind::U16 => bytes.extend((value as u16).to_le_bytes()),
            NumberKind::I16 => bytes.extend((value as i16).to_le_bytes()),
            NumberKind::U32 => bytes.extend((value as u32).to_le_bytes()),
            NumberKind::I32 => bytes.extend((value as i32).to_le_bytes()),
            NumberKind::U64 => bytes.extend((value as u64).to_le_bytes()),
            NumberKind::I64 => bytes.extend((value as i64).to_le_bytes()),
            NumberKind::F32 => bytes.extend((value as f32).to_le_bytes()),
            NumberKind::F64 => bytes.extend(value.to_le_bytes()),
        }
    }

    /// The number that begins at a byte; NaN past the end.
    pub fn at_byte(&self, at: usize) -> f64 {
        let mut eight = [0; 8];
        let size = self.kind.bytes();
        let Some(own) = at.checked_add(size).and_then(|end| self.bytes.get(at..end)) else { return f64::NAN };
        for (to, from) in eight.iter_mut().zip(own) {
            *to = *from;
        }
        if self.is_big
            && let Some(own) = eight.get_mut(..size)
        {
            own.reverse();
        }
        let [a, b, c, d, ..] = eight;
        match self.kind {
            NumberKind::U8 => f64::from(a),
            NumberKind::I8 => f64::from(i8::from_le_bytes([a])),
            NumberKind::U16 => f64::from(u16::from_le_bytes([a, b])),
            NumberKind::I16 => f64::from(i16::from_le_bytes([a, b])),
            NumberKind::U32 => f64::from(u32::from_le_bytes([a, b, c, d])),
            NumberKind::I32 => f64::from(i32::from_le_bytes([a, b, c, d])),
            NumberKind::U64 => u64::from_le_bytes(eight) as f64,
            NumberKind::I64 => i64::from_le_bytes(eight) as f64,
            NumberKind::F32 => f64::from(f32::from_le_bytes([a, b, c, d])),
            NumberKind::F64 => f64::from_le_bytes(eight),
        }
    }

    /// All of them.
    pub fn all(&self) -> Vec<f64> {
        (0..self.len()).map(|i| self.at_byte(i * self.kind.bytes())).collect()
    }
}

/// Where the numbers of a grid's samples lie in their bytes.
#[derive(Clone, Copy, Debug)]
pub struct Layout {
    /// Samples along each axis.
    pub size: [usize; 3],
    /// Numbers of a sample.
    pub components: usize,
    /// The byte of the first number.
    pub start: usize,
    /// Bytes from a sample to the next along each axis.
    pub strides: [usize; 3],
    /// Bytes from a component to the next.
    pub component_stride: usize,
}

impl Layout {
    /// Samples one after the other, x fastest, their components together.
    pub fn dense(kind: NumberKind, size: [usize; 3], components: usize) -> Self {
        Self::ordered(kind, size, components, [0, 1, 2])
    }

    /// Samples one after the other, their components together; `order` has the axes, the fastest first.
    pub fn ordered(kind: NumberKind, size: [usize; 3], components: usize, order: [usize; 3]) -> Self {
        let mut strides = [0; 3];
        let mut stride = kind.bytes().saturating_mul(components);
        for axis in order {
            strides[axis] = stride;
            stride = stride.saturating_mul(size[axis]);
        }
        Self { size, components, start: 0, strides, component_stride: kind.bytes() }
    }

    /// Samples one after the other, z fastest: the order of C's arrays.
    pub fn last_fastest(kind: NumberKind, size: [usize; 3], components: usize) -> Self {
        Self::ordered(kind, size, components, [2, 1, 0])
    }

    /// How many numbers there are.
    pub fn count(&self) -> usize {
        self.size.iter().fold(self.components, |count, n| count.saturating_mul(*n))
    }

    /// Where the last number ends.
    pub fn end(&self, kind: NumberKind) -> usize {
        let along = self.size.iter().zip(self.strides).map(|(n, stride)| n.saturating_sub(1).saturating_mul(stride));
        let of_components = self.components.saturating_sub(1).saturating_mul(self.component_stride);
        [of_components, kind.bytes(), self.start].into_iter().chain(along).fold(0, usize::saturating_add)
    }
}

/// What the numbers of a file mean.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Meaning {
    /// What they are multiplied with, then.
    pub slope: f64,
    /// What is added to them, last.
    pub offset: f64,
    /// The number that stands for none.
    pub missing: Option<f64>,
}

impl Meaning {
    /// They are the values.
    pub const PLAIN: Self = Self { slope: 1.0, offset: 0.0, missing: None };

    fn of(&self, number: f64) -> f32 {
        if self.missing == Some(number) {
            return f32::NAN;
        }
        let value = (number * self.slope + self.offset) as f32;
        if value.is_finite() { value } else { f32::NAN }
    }
}

/// Values in the order of grids; the error says how many bytes are missing.
pub fn values(numbers: &Numbers<'_>, layout: &Layout, meaning: &Meaning) -> Result<Values, String> {
    let (kind, bytes) = (numbers.kind, &numbers.bytes[..]);
    let needed = layout.end(kind);
    if needed > bytes.len() {
        let [x, y, z] = layout.size;
        let (components, have) = (layout.components, bytes.len());
        return Err(format!(
            "{x} × {y} × {z} samples of {components} {kind:?} need {needed} bytes, there are {have}; the header or the data are wrong"
        ));
    }
    let is_big = numbers.is_big;
    macro_rules! of {
        ($number:ty) => {
            match is_big {
                true => gathered(bytes, layout, |b| meaning.of(<$number>::from_be_bytes(b) as f64)),
                false => gathered(bytes, layout, |b| meaning.of(<$number>::from_le_bytes(b) as f64)),
            }
        };
    }
    Ok(Values::F32(match kind {
        NumberKind::U8 if *meaning == Meaning::PLAIN => return Ok(Values::U8(gathered(bytes, layout, |[byte]| byte))),
        NumberKind::U8 => of!(u8),
        NumberKind::I8 => of!(i8),
        NumberKind::U16 => of!(u16),
        NumberKind::I16 => of!(i16),
        NumberKind::U32 => of!(u32),
        NumberKind::I32 => of!(i32),
        NumberKind::U64 => of!(u64),
        NumberKind::I64 => of!(i64),
        NumberKind::F32 => of!(f32),
        NumberKind::F64 => of!(f64),
    }))
}

/// The numbers of a layout that ends within the bytes.
fn gathered<const N: usize, T>(bytes: &[u8], layout: &Layout, make: impl Fn([u8; N]) -> T) -> Vec<T> {
    let Layout { size: [nx, ny, nz], components, start, strides: [sx, sy, sz], component_stride } = *layout;
    let mut all = Vec::with_capacity(layout.count());
    let number = |at: usize| bytes.get(at..).and_then(|rest| rest.first_chunk::<N>()).copied().unwrap_or([0; N]);
    for z in 0..nz {
        for y in 0..ny {
            let row = start + z * sz + y * sy;
            for x in 0..nx {
                all.extend((0..components).map(|c| make(number(row + x * sx + c * component_stride))));
            }
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [NumberKind; 10] = [
        NumberKind::U8,
        NumberKind::I8,
        NumberKind::U16,
        NumberKind::I16,
        NumberKind::U32,
        NumberKind::I32,
        NumberKind::U64,
        NumberKind::I64,
        NumberKind::F32,
        NumberKind::F64,
    ];

    #[test]
    fn every_type_is_packed_and_read_in_both_orders() {
        for kind in ALL {
            let mut numbers = Numbers::with_room(kind, 3);
            let wanted = [0.0, 100.0, if kind == NumberKind::U8 { 200.0 } else { 17.0 }];
            wanted.iter().for_each(|n| numbers.push(*n));
            assert_eq!(numbers.all(), wanted, "{kind:?}");
            let size = kind.bytes();
            let swapped: Vec<u8> = numbers.bytes.chunks(size).flat_map(|c| c.iter().rev().copied()).collect();
            let big = Numbers::packed(kind, true, swapped);
            assert_eq!(big.all(), wanted, "{kind:?}");
            for numbers in [&numbers, &big] {
                let read = values(numbers, &Layout::dense(kind, [3, 1, 1], 1), &Meaning::PLAIN).unwrap();
                assert_eq!((0..3).map(|i| f64::from(read.get(i))).collect::<Vec<_>>(), wanted, "{kind:?}");
            }
        }
    }

    #[test]
    fn layouts_turn_axes_round() {
        let numbers = Numbers::packed(NumberKind::U8, false, (0..12).collect::<Vec<u8>>());
        let layout = Layout::last_fastest(NumberKind::U8, [2, 3, 1], 2);
        let Values::U8(read) = values(&numbers, &layout, &Meaning::PLAIN).unwrap() else { panic!("bytes stay bytes") };
        assert_eq!(read, [0, 1, 6, 7, 2, 3, 8, 9, 4, 5, 10, 11]);
        let short = Layout::dense(NumberKind::U8, [13, 1, 1], 1);
        assert!(values(&numbers, &short, &Meaning::PLAIN).unwrap_err().contains("need 13 bytes, there are 12"));
        let huge = Layout::dense(NumberKind::F64, [2048; 3], usize::MAX / 2);
        assert!(values(&numbers, &huge, &Meaning::PLAIN).is_err());
    }

    #[test]
    fn numbers_mean_values() {
        let numbers = Numbers::packed(NumberKind::U8, false, vec![0_u8, 9, 10]);
        let meaning = Meaning { slope: 2.0, offset: 1.0, missing: Some(9.0) };
        let read = values(&numbers, &Layout::dense(NumberKind::U8, [3, 1, 1], 1), &meaning).unwrap();
        assert_eq!((read.get(0), read.get(2)), (1.0, 21.0));
        assert!(read.get(1).is_nan());
        let far = Numbers::packed(NumberKind::F64, false, 1e300_f64.to_le_bytes().to_vec());
        let read = values(&far, &Layout::dense(NumberKind::F64, [1, 1, 1], 1), &Meaning::PLAIN).unwrap();
        assert!(read.get(0).is_nan(), "what F32 cannot have is missing");
    }
}
