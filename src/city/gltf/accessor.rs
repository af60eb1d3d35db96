//! Accessors: typed views of buffers, checked once against the bytes that exist, then read one element at a time.
//!
//! Nothing is allocated from an accessor's `count`: a view holds slices only.

use gltf::json::{
    accessor::{Accessor, ComponentType, Type},
    validation::Checked,
};

use super::{buffers::Buffers, document::Document};

/// A checked accessor.
#[derive(Debug)]
pub(super) struct View<'a> {
    bytes: &'a [u8],
    stride: usize,
    component: ComponentType,
    /// Components per element.
    pub dimension: usize,
    normalized: bool,
    /// Elements.
    pub count: u64,
    sparse: Option<Sparse<'a>>,
}

/// Elements that differ from the base.
#[derive(Debug)]
struct Sparse<'a> {
    /// Strictly increasing.
    indices: Vec<u32>,
    values: &'a [u8],
}

/// Opens accessor `index`; an error says what is wrong, with its JSON path.
pub(super) fn open<'a>(document: &Document, buffers: &'a Buffers<'_>, index: usize) -> Result<View<'a>, String> {
    let accessor = document.accessors.get(index)?;
    let at = |what: String| format!("accessors[{index}]: {what}");
    let (Checked::Valid(component), Checked::Valid(kind)) = (accessor.component_type, accessor.type_) else {
        return Err(at("unknown type or componentType".into()));
    };
    let (component, dimension) = (component.0, dimension(kind));
    let size = component.size() * dimension;
    let count = accessor.count.0;
    let (bytes, stride) = match accessor.buffer_view {
        None => (&[][..], 0),
        Some(view) => {
            let (bytes, view) = buffers.view(document, view.value()).map_err(at)?;
            let stride = view.byte_stride.map_or(size, |s| s.0);
            let offset = accessor.byte_offset.map_or(0, |o| o.0);
            check_room(bytes.len(), offset, stride, size, count).map_err(at)?;
            // An empty accessor may begin anywhere.
            (&bytes[(offset as usize).min(bytes.len())..], stride)
        }
    };
    let sparse =
        accessor.sparse.is_some().then(|| open_sparse(document, buffers, accessor, size)).transpose().map_err(at)?;
    Ok(View { bytes, stride, component, dimension, normalized: accessor.normalized, count, sparse })
}

fn dimension(kind: Type) -> usize {
    match kind {
        Type::Scalar => 1,
        Type::Vec2 => 2,
        Type::Vec3 => 3,
        Type::Vec4 | Type::Mat2 => 4,
        Type::Mat3 => 9,
        Type::Mat4 => 16,
    }
}

/// Whether `count` elements of `size` bytes, `stride` apart, lie inside `room` bytes from `offset`.
fn check_room(room: usize, offset: u64, stride: usize, size: usize, count: u64) -> Result<(), String> {
    if count == 0 {
        return Ok(());
    }
    if stride < size {
        return Err(format!("byteStride {stride} is less than the element's {size} bytes"));
    }
    let end = (count - 1).checked_mul(stride as u64).and_then(|n| n.checked_add(offset)?.checked_add(size as u64));
    match end {
        Some(end) if end <= room as u64 => Ok(()),
        _ => Err(format!("{count} elements of {size} bytes do not fit the buffer, which has {room} for them")),
    }
}

fn open_sparse<'a>(
    document: &Document,
    buffers: &'a Buffers<'_>,
    accessor: &Accessor,
    size: usize,
) -> Result<Sparse<'a>, String> {
    let Some(sparse) = &accessor.sparse else { return Err("sparse is missing".into()) };
    let Checked::Valid(index_type) = sparse.indices.component_type else {
        return Err("sparse.indices.componentType must be an unsigned integer".into());
    };
    let part = |view: usize, offset: u64, size: usize| {
        let (bytes, _) = buffers.view(document, view)?;
        check_room(bytes.len(), offset, size, size, sparse.count.0)?;
        Ok::<_, String>(&bytes[(offset as usize).min(bytes.len())..])
    };
    let packed = part(sparse.indices.buffer_view.value(), sparse.indices.byte_offset.0, index_type.0.size())?;
    let values = part(sparse.values.buffer_view.value(), sparse.values.byte_offset.0, size)?;
    // The count is bounded: that many indices are in the buffer.
    let indices: Vec<u32> =
        (0..sparse.count.0 as usize).map(|i| scalar(packed, i * index_type.0.size(), index_type.0) as u32).collect();
    if indices.windows(2).any(|w| w[0] >= w[1]) {
        return Err("sparse.indices must strictly increase".into());
    }
    if let Some(last) = indices.last().filter(|last| u64::from(**last) >= accessor.count.0) {
        return Err(format!("sparse.indices has {last}, the accessor {} elements", accessor.count.0));
    }
    Ok(Sparse { indices, values })
}

/// Reads one component; 0 where there are no bytes (an accessor without bufferView is zeros).
fn scalar(bytes: &[u8], at: usize, component: ComponentType) -> f64 {
    let word = |n: usize| bytes.get(at..at + n).unwrap_or(&[0; 4][..n]);
    match component {
        ComponentType::I8 => f64::from(word(1)[0] as i8),
        ComponentType::U8 => f64::from(word(1)[0]),
        ComponentType::I16 => f64::from(i16::from_le_bytes([word(2)[0], word(2)[1]])),
        ComponentType::U16 => f64::from(u16::from_le_bytes([word(2)[0], word(2)[1]])),
        ComponentType::U32 => f64::from(u32::from_le_bytes([word(4)[0], word(4)[1], word(4)[2], word(4)[3]])),
        ComponentType::F32 => f64::from(f32::from_le_bytes([word(4)[0], word(4)[1], word(4)[2], word(4)[3]])),
    }
}

/// Integers as fractions (glTF 2.0, 3.6.2.2).
fn as_fraction(value: f64, component: ComponentType) -> f64 {
    match component {
        ComponentType::I8 => (value / 127.0).max(-1.0),
        ComponentType::U8 => value / 255.0,
        ComponentType::I16 => (value / 32767.0).max(-1.0),
        ComponentType::U16 => value / 65535.0,
        ComponentType::U32 | ComponentType::F32 => value,
    }
}

impl View<'_> {
    /// Component `c` of element `i`, as the file means it.
    fn component(&self, i: u64, c: usize) -> f64 {
        let size = self.component.size();
        let changed = self.sparse.as_ref().and_then(|s| {
            let slot = s.indices.binary_search(&u32::try_from(i).ok()?).ok()?;
            Some((s.values, (slot * self.dimension + c) * size))
        });
        let (bytes, at) = changed.unwrap_or((self.bytes, (i as usize).saturating_mul(self.stride) + c * size));
        let value = scalar(bytes, at, self.component);
        if self.normalized { as_fraction(value, self.component) } else { value }
    }

    /// The first `N` components of element `i`; those it lacks are 0.
    pub fn get<const N: usize>(&self, i: u64) -> [f64; N] {
        std::array::from_fn(|c| if c < self.dimension { self.component(i, c) } else { 0.0 })
    }

    /// Elements that had to be looked at to open it.
    pub fn opening_cost(&self) -> u64 {
        self.sparse.as_ref().map_or(0, |s| s.indices.len() as u64)
    }

    /// Element `i` of an index accessor.
    pub fn index(&self, i: u64) -> u32 {
        self.component(i, 0) as u32
    }

    /// Whether it can hold vertex indices.
    pub fn is_indices(&self) -> bool {
        let unsigned = matches!(self.component, ComponentType::U8 | ComponentType::U16 | ComponentType::U32);
        self.dimension == 1 && unsigned && !self.normalized
    }
}
