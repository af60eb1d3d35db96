//! NIfTI-1 (`.nii`, or `.hdr` with `.img`): a header of 348 bytes, then the numbers
//! (<https://nifti.nimh.nih.gov/nifti-1>).

use glam::{DMat3, DQuat, DVec3};

use crate::field::{
    data::Step,
    error::FieldError,
    grid::Grid,
    input::Input,
    numbers::{self, Layout, Meaning, NumberKind, Numbers},
    output::Output,
};

/// Bytes of the header.
const HEADER: usize = 348;
/// Where the header says what it is.
const MAGIC_AT: usize = 344;

/// A header, which has its numbers in one of two orders.
struct Header<'a> {
    bytes: &'a [u8],
    is_big: bool,
}

impl Header<'_> {
    fn number(&self, kind: NumberKind, at: usize) -> f64 {
        Numbers::packed(kind, self.is_big, self.bytes).at_byte(at)
    }

    fn short(&self, at: usize) -> i64 {
        self.number(NumberKind::I16, at) as i64
    }

    fn float(&self, at: usize) -> f64 {
        self.number(NumberKind::F32, at)
    }

    fn floats<const N: usize>(&self, at: usize) -> [f64; N] {
        std::array::from_fn(|i| self.float(at + 4 * i))
    }

    fn byte(&self, at: usize) -> u8 {
        self.bytes.get(at).copied().unwrap_or(0)
    }
}

/// Reads a NIfTI-1 file.
pub fn read(input: &Input<'_>, output: &mut Output) -> Result<(), FieldError> {
    let at = |byte: usize, message: String| FieldError::at(&input.path, format!("byte {byte}"), message);
    let Some(bytes) = input.bytes.get(..HEADER) else {
        return Err(input.fail(format!("has {} bytes; a NIfTI-1 header alone has 348", input.bytes.len())));
    };
    let is_big = bytes.starts_with(&[0, 0]);
    let header = Header { bytes, is_big };
    if header.number(NumberKind::I32, 0) == 540.0 {
        return Err(at(0, "the file is NIfTI-2; save it as NIfTI-1".into()));
    }
    let is_single = match bytes.get(MAGIC_AT..HEADER) {
        Some(b"n+1\0") => true,
        Some(b"ni1\0") => false,
        _ => {
            return Err(at(
                MAGIC_AT,
                "\"n+1\" or \"ni1\" belongs here; without it the file is ANALYZE, not NIfTI-1".into(),
            ));
        }
    };
    let shape = Shape::new(&header).map_err(|message| at(40, message))?;
    let (kind, parts) = number_kind(header.short(70)).map_err(|message| at(70, message))?;
    let components = shape.components.saturating_mul(parts);
    let grid = grid(&header, shape.size).map_err(|message| at(252, message))?;
    let meaning = match (header.float(112), header.float(116)) {
        (slope, offset) if slope != 0.0 && slope.is_finite() && offset.is_finite() && parts == 1 => {
            Meaning { slope, offset, missing: None }
        }
        _ => Meaning::PLAIN,
    };
    let beside = if is_single { None } else { Some(image(input)?) };
    let (file, start) = (beside.as_ref().unwrap_or(input), header.float(108));
    let start = if start.is_finite() && start >= 0.0 { start as usize } else { 0 };
    let start = if is_single { start.max(HEADER) } else { start };
    let data = Numbers::packed(kind, is_big, file.bytes.get(start..).unwrap_or_default());
    let value_bytes = if kind == NumberKind::U8 && meaning == Meaning::PLAIN { 1 } else { 4 };
    let volume = Layout::dense(kind, shape.size, parts).count().saturating_mul(kind.bytes());
    let units = header.byte(123);
    let mut steps = Vec::new();
    for step in 0..shape.times {
        output.reserve(shape.size, components, value_bytes).map_err(|message| input.fail(message))?;
        // Components that are an axis of their own come after time.
        let layout = Layout {
            components,
            start: volume.saturating_mul(step),
            component_stride: if parts > 1 { kind.bytes() } else { volume.saturating_mul(shape.times) },
            ..Layout::dense(kind, shape.size, parts)
        };
        let values = numbers::values(&data, &layout, &meaning);
        let values = values.map_err(|message| FieldError::at(&file.path, format!("byte {start}"), message))?;
        let time = (shape.times > 1).then(|| header.float(136) + header.float(92) * step as f64);
        steps.push(Step { time: time.filter(|time| time.is_finite()), values });
    }
    output.add_steps(input.stem(), grid, components, steps).map_err(|message| input.fail(message))?;
    let length = ["", "m", "mm", "µm"].get(usize::from(units & 7)).copied().unwrap_or("");
    let time = ["", "s", "ms", "µs", "Hz", "ppm", "rad/s"].get(usize::from(units >> 3 & 7)).copied().unwrap_or("");
    if !length.is_empty() {
        output.warn(format!("lengths are in {length}"));
    }
    if !time.is_empty() && shape.times > 1 {
        output.warn(format!("times are in {time}"));
    }
    Ok(())
}

/// The file of the numbers of a `.hdr`.
fn image<'a>(input: &Input<'a>) -> Result<Input<'a>, FieldError> {
    let name = input.path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let name = name.strip_suffix(".gz").unwrap_or(&name);
    let stem = name.rsplit_once('.').map_or(name, |(stem, _)| stem);
    let found = input.beside(&format!("{stem}.img"), true);
    found.or_else(|error| input.beside(&format!("{stem}.img.gz"), true).map_err(|_| error))
}

/// Samples along the axes.
struct Shape {
    size: [usize; 3],
    times: usize,
    components: usize,
}

impl Shape {
    fn new(header: &Header<'_>) -> Result<Self, String> {
        let dimensions = header.short(40);
        if !(1..=7).contains(&dimensions) {
            return Err(format!("the file has {dimensions} dimensions; 1 to 7 belong here"));
        }
        let count = |axis: i64| -> Result<usize, String> {
            if axis > dimensions {
                return Ok(1);
            }
            let count = header.short(40 + 2 * axis as usize);
            usize::try_from(count)
                .ok()
                .filter(|n| *n > 0)
                .ok_or_else(|| format!("dimension {axis} has {count} samples; at least one belongs here"))
        };
        if count(6)? > 1 || count(7)? > 1 {
            return Err("the file has more than 5 dimensions; space, time and components can be read".into());
        }
        Ok(Self { size: [count(1)?, count(2)?, count(3)?], times: count(4)?, components: count(5)? })
    }
}

/// The type of the numbers of a code, and how many of them are one value.
fn number_kind(code: i64) -> Result<(NumberKind, usize), String> {
    Ok(match code {
        2 => (NumberKind::U8, 1),
        4 => (NumberKind::I16, 1),
        8 => (NumberKind::I32, 1),
        16 => (NumberKind::F32, 1),
        32 => (NumberKind::F32, 2),
        64 => (NumberKind::F64, 1),
        128 => (NumberKind::U8, 3),
        256 => (NumberKind::I8, 1),
        512 => (NumberKind::U16, 1),
        768 => (NumberKind::U32, 1),
        1024 => (NumberKind::I64, 1),
        1280 => (NumberKind::U64, 1),
        1792 => (NumberKind::F64, 2),
        2304 => (NumberKind::U8, 4),
        other => {
            return Err(format!(
                "the datatype is {other}; 2 (uint8), 4 (int16), 16 (float) or another that is a number of up to 64 bits belongs here"
            ));
        }
    })
}

/// Where samples are: by `sform`, else by `qform`, else by spacings alone.
fn grid(header: &Header<'_>, size: [usize; 3]) -> Result<Grid, String> {
    let [handedness, dx, dy, dz] = header.floats::<4>(76);
    let spacing = [dx, dy, dz].map(|d| if d.is_finite() && d != 0.0 { d.abs() } else { 1.0 });
    if header.short(254) > 0 {
        let [x, y, z] = [header.floats::<4>(280), header.floats::<4>(296), header.floats::<4>(312)];
        let steps = std::array::from_fn(|axis| DVec3::new(x[axis], y[axis], z[axis]));
        return Grid::new(size, DVec3::new(x[3], y[3], z[3]), steps);
    }
    let [sx, sy, sz] = spacing;
    if header.short(252) > 0 {
        let [b, c, d, ox, oy, oz] = header.floats::<6>(256);
        let a = (1.0 - (b * b + c * c + d * d)).max(0.0).sqrt();
        let turn = DMat3::from_quat(DQuat::from_xyzw(b, c, d, a).normalize());
        let sign = if handedness < 0.0 { -1.0 } else { 1.0 };
        return Grid::new(
            size,
            DVec3::new(ox, oy, oz),
            [turn.x_axis * sx, turn.y_axis * sy, turn.z_axis * (sz * sign)],
        );
    }
    Grid::new(size, DVec3::ZERO, [DVec3::X * sx, DVec3::Y * sy, DVec3::Z * sz])
}

#[cfg(test)]
mod tests;
