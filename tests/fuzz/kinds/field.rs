//! Fields on grids, of all formats, and what lies beside them.

use std::{
    io::{self, Read as _},
    path::Path,
};

use veduta::field::{Component, Field, FieldFile, Packing, Values, load_bytes, plume, write_nrrd};

use super::{Kind, READ_S, Seed, always, refused};

/// The largest files that are written and read again, in numbers.
const MOST_WRITTEN: usize = 1 << 16;
/// Headers whose data lie beside them, and these.
const DETACHED: &[(&str, &str)] = &[
    ("data.field.raw", "detached.field.nhdr"),
    ("data.field.lis", "table.field.general"),
    ("pair.field.img", "pair.field.hdr"),
];

pub fn kind() -> Kind {
    Kind { name: "fields", files: seeds(), sample: 2000, is_worth: always, most_s: READ_S, read: Box::new(read) }
}

/// One small file of every format, by its name.
fn seeds() -> Vec<Seed> {
    let mut seeds: Vec<Seed> = Vec::new();
    let mut add = |name: &str, bytes: Vec<u8>| {
        let (stem, extension) = name.split_once('.').expect("a name with an extension");
        seeds.push(Seed { name: format!("{stem}.field.{extension}"), bytes });
    };
    let field = plume([4, 3, 2]);
    add("raw.nrrd", write_nrrd(&field, Packing::Raw));
    add("packed.nrrd", write_nrrd(&field, Packing::Gzip));
    let text = b"NRRD0005\ntype: short\ndimension: 4\nsizes: 2 2 2 2\nkinds: vector domain domain time\nspacings: nan 1 2 0.5\naxis mins: nan 0 0 3\ncenterings: none cell node ???\nencoding: ascii\n\n";
    add("text.nrrd", [&text[..], b"1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16\n"].concat());
    add("detached.nhdr", b"NRRD0004\ntype: uint16\ndimension: 2\nsizes: 3 2\nendian: big\nencoding: raw\nbyte skip: -1\ndata file: data.field.raw\n".to_vec());
    add("many.nhdr", b"NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 3 2\nencoding: raw\ndata file: LIST\ndata.field.raw\ndata.field.raw\n".to_vec());
    add("data.raw", vec![0, 1, 0, 2, 0, 3, 0, 4, 0, 5, 0, 6]);
    add("local.mha", b"NDims = 3\nDimSize = 2 2 2\nElementSpacing = 1 1 2\nTransformMatrix = 0 1 0 1 0 0 0 0 1\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n\x01\x02\x03\x04\x05\x06\x07\x08".to_vec());
    add(
        "packed.mha",
        [
            &b"NDims = 2\nDimSize = 4 2\nCompressedData = True\nElementType = MET_UCHAR\nElementDataFile = LOCAL\n"[..],
            &zlib(&[1, 2, 3, 4, 5, 6, 7, 8]),
        ]
        .concat(),
    );
    add_vtk(&mut add);
    add_dx(&mut add);
    add("scattered.general", b"points = 4\nseries = 2, 1, 0.5\nfield = locations, co2\nstructure = 2-vector, scalar\ninterleaving = field\nend\n0 0 1\n0 9 2\n9 0 3\n9 9 -1000\n0 0 5\n0 9 6\n9 0 7\n9 9 8\n".to_vec());
    add("table.general", b"file = data.field.lis\ngrid = 2 x 2\nfield = t, v\nstructure = scalar, 2-vector\nlayout = 3, 5, 0, 5\nheader = lines 1\ninterleaving = field\nmajority = column\npositions = 1, 2, 3, -4\n".to_vec());
    add(
        "data.lis",
        b"a title\nx:  1.5  2.5  3.5\nx:  4.5  5.5  6.5\nx:  7.5 -99999.5  9.5\nx:  1.0  1.0  1.0\n".to_vec(),
    );
    add("blocks.general", b"grid = 2 x 3\nfield = a, b\ntype = byte, float\nblock = 1, 2, 2, 0, 3, 4\nrecordseparator = lines 1\npositions = regular, irregular, 0, 1, 0, 1, 3\ninterleaving = record\nend\n 1 2\n 3 4\n 5 6\n--\n1.5 2.5 3.5 \n4.5 5.5 6.5 \n".to_vec());
    let nifti = nifti();
    add("one.nii", [&nifti[..], &[0; 4], &[1, 2, 3, 4, 5, 6, 7, 8]].concat());
    add("one.nii.gz", gzip(&[&nifti[..], &[0; 4], &[1, 2, 3, 4, 5, 6, 7, 8]].concat()));
    let mut pair = nifti;
    pair[344..348].copy_from_slice(b"ni1\0");
    pair[108..112].copy_from_slice(&0_f32.to_le_bytes());
    add("pair.hdr", pair);
    add("pair.img", vec![1, 2, 3, 4, 5, 6, 7, 8]);
    if cfg!(feature = "netcdf") {
        add("classic.nc", classic_netcdf());
    }
    seeds
}

/// `a(time = 2, y = 2, x = 3)` of bytes and `x(x)` of doubles.
fn classic_netcdf() -> Vec<u8> {
    let word = |n: u32| n.to_be_bytes().to_vec();
    let name = |text: &str| {
        let mut bytes = [word(text.len() as u32), text.as_bytes().to_vec()].concat();
        bytes.resize(bytes.len().next_multiple_of(4), 0);
        bytes
    };
    let units = [word(12), word(1), name("units"), word(2), name("hours since 2000-01-01")].concat();
    let dimensions = [word(10), word(3), name("time"), word(2), name("y"), word(2), name("x"), word(3)].concat();
    let head = |begin: u32| {
        let fill = [word(12), word(1), name("_FillValue"), word(1), word(1), vec![9, 0, 0, 0]].concat();
        let a = [name("a"), word(3), word(0), word(1), word(2), fill, word(1), word(12), word(begin)].concat();
        let x = [name("x"), word(1), word(2), word(0), word(0), word(6), word(24), word(begin + 12)].concat();
        let time = [name("time"), word(1), word(0), units.clone(), word(6), word(16), word(begin + 36)].concat();
        [b"CDF\x01".to_vec(), word(0), dimensions.clone(), word(0), word(0), word(11), word(3), a, x, time].concat()
    };
    let doubles: Vec<u8> = [5.0_f64, 7.0, 10.0, 0.0, 6.0].iter().flat_map(|n| n.to_be_bytes()).collect();
    [head(head(0).len() as u32), (1..=12).collect(), doubles].concat()
}

fn add_vtk(add: &mut impl FnMut(&str, Vec<u8>)) {
    let points = "DATASET STRUCTURED_POINTS\nDIMENSIONS 2 2 2\nORIGIN 0 0 0\nSPACING 1 2 3\nPOINT_DATA 8\n";
    add("text.vtk", format!("# vtk DataFile Version 3.0\nt\nASCII\n{points}SCALARS a float 1\nLOOKUP_TABLE default\n1 2 3 4 5 6 7 8\nVECTORS b%20c int\n{}\nMETADATA\nx\n\nCELL_DATA 1\nFIELD f 2\na 1 1 bit\n1\nd 2 1 double\n1 2\n", "1 2 3 ".repeat(8)).into_bytes());
    let binary = format!("# vtk DataFile Version 4.2\nt\nBINARY\n{points}SCALARS a short\nLOOKUP_TABLE default\n");
    add("bytes.vtk", [binary.as_bytes(), &[0, 1, 0, 2, 0, 3, 0, 4, 0, 5, 0, 6, 0, 7, 0, 8]].concat());
    add("axes.vtk", b"# vtk DataFile Version 3.0\nt\nASCII\nDATASET RECTILINEAR_GRID\nDIMENSIONS 3 2 1\nX_COORDINATES 3 float\n0 1 3\nY_COORDINATES 2 float\n0 1\nZ_COORDINATES 1 float\n0\nFIELD f 1\nTIME 1 1 double\n2\nPOINT_DATA 6\nSCALARS a float\nLOOKUP_TABLE default\n1 2 3 4 5 6\n".to_vec());
    add("curved.vtk", b"# vtk DataFile Version 3.0\nt\nASCII\nDATASET STRUCTURED_GRID\nDIMENSIONS 2 2 2\nPOINTS 8 float\n0 0 0 1 0 0 0 1 0 1 1 0\n0 0 1 1 0 1 0 1 1 2 2 2\nPOINT_DATA 8\nSCALARS a float\nLOOKUP_TABLE default\n1 2 3 4 5 6 7 8\nCELL_DATA 1\nSCALARS c int\nLOOKUP_TABLE default\n9\n".to_vec());
    let image = |file: &str, arrays: &str, behind: &str| {
        format!(
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\" {file}>\n<ImageData WholeExtent=\"0 1 0 1 0 1\" Origin=\"0 0 0\" Spacing=\"1 1 1\" Direction=\"1 0 0 0 1 0 0 0 1\">\n<Piece Extent=\"0 1 0 1 0 1\">{arrays}</Piece></ImageData>{behind}</VTKFile>\n"
        )
    };
    let array = |attributes: &str, text: &str| {
        format!("<PointData><DataArray type=\"UInt8\" Name=\"a\" {attributes}>{text}</DataArray></PointData>")
    };
    add("text.vti", image("", &format!("{}<CellData><DataArray type=\"Float32\" Name=\"c\" NumberOfComponents=\"2\" format=\"ascii\">1 2</DataArray></CellData>", array("format=\"ascii\"", "1 2 3 4 5 6 7 8")), "").into_bytes());
    // The length 8 and the bytes 1 to 8.
    add(
        "inline.vti",
        image(
            "byte_order=\"LittleEndian\" header_type=\"UInt32\"",
            &array("format=\"binary\"", "CAAAAAECAwQFBgcI"),
            "",
        )
        .into_bytes(),
    );
    let packed = zlib(&[1, 2, 3, 4, 5, 6, 7, 8]);
    let lengths = [1, 8, 0, packed.len() as u32];
    let head: Vec<u8> = lengths.iter().flat_map(|n| n.to_le_bytes()).collect();
    let text = image(
        "compressor=\"vtkZLibDataCompressor\"",
        &array("format=\"appended\" offset=\"0\"", ""),
        "<AppendedData encoding=\"raw\">_@</AppendedData>",
    );
    let (before, after) = text.split_once('@').expect("a mark");
    add("appended.vti", [before.as_bytes(), &head, &packed, after.as_bytes()].concat());
    let piece =
        |extent: &str, text: &str| format!("<Piece Extent=\"{extent}\">{}</Piece>", array("format=\"ascii\"", text));
    add(
        "pieces.vti",
        format!(
            "<VTKFile type=\"ImageData\"><ImageData WholeExtent=\"0 2 0 1 0 0\">{}{}</ImageData></VTKFile>",
            piece("0 1 0 1 0 0", "1 2 3 4"),
            piece("1 2 0 1 0 0", "2 5 4 6")
        )
        .into_bytes(),
    );
}

fn add_dx(add: &mut impl FnMut(&str, Vec<u8>)) {
    let grid = "object 1 class gridpositions counts 2 2 2\norigin 0 0 0\ndelta 1 0 0\ndelta 0 1 0\ndelta 0 0 1\nobject 2 class gridconnections counts 2 2 2\n";
    let field = |key: &str, data: u32| {
        format!(
            "object {key} class field component \"positions\" value 1 component \"connections\" value 2 component \"data\" value {data}\n"
        )
    };
    add("text.dx", format!("{grid}object 3 class array type float rank 0 items 8 data follows\n1 2 3 4 5 6 7 8\nattribute \"dep\" string \"positions\"\n{}end\n", field("\"heat\"", 3)).into_bytes());
    add(
        "bytes.dx",
        [
            format!("{grid}object 3 class array type short rank 0 items 8 msb ieee data 0\n{}end\n", field("4", 3))
                .as_bytes(),
            &[0, 1, 0, 2, 0, 3, 0, 4, 0, 5, 0, 6, 0, 7, 0, 8],
        ]
        .concat(),
    );
    add("series.dx", format!("{grid}object 3 class array type byte items 8 data follows 1 2 3 4 5 6 7 8\nobject 4 class array type byte items 8 data follows 1 2 3 4 5 6 7 8\n{}{}object 7 class series member 0 position 1.5 value 5 member 1 position 2 value 6\nobject 8 class group member \"a\" value 7 member \"b\" value 5\nend\n", field("5", 3), field("6", 4)).into_bytes());
    add("curved.dx", format!("object 1 class array type float rank 1 shape 2 items 6 data follows 0 0 0 1 0 2 1 0 1 1 2 3\nobject 2 class gridconnections counts 2 3\nobject 3 class array type float rank 1 shape 2 items 6 data follows 1 2 3 4 5 6 7 8 9 10 11 12\n{}end\n", field("\"v\"", 3)).into_bytes());
    add("product.dx", format!("object 5 class regulararray items 2 origin 1 0 delta 3 0\nobject 6 class array type float rank 1 shape 2 items 3 data follows 0 5 0 6 0 8\nobject 1 class productarray term 5 term 6\nobject 2 class gridconnections counts 2 3\nobject 3 class array type float items 6 data follows 1 2 3 4 5 6\n{}end\n", field("7", 3)).into_bytes());
    add("scattered.dx", b"object 1 class array type float rank 1 shape 3 items 4 data follows 0 0 0 1 2 3 4 0 1 1 1 1\nobject 3 class array type float items 4 data follows 1 2 3 4\nobject 4 class field component \"positions\" 1 component \"data\" 3\nend\n".to_vec());
}

/// A header of 2 × 2 × 1 samples in two steps.
fn nifti() -> Vec<u8> {
    let mut header = vec![0; 348];
    header[..4].copy_from_slice(&348_i32.to_le_bytes());
    let mut shorts = |at: usize, all: &[i16]| {
        all.iter().enumerate().for_each(|(i, n)| header[at + 2 * i..at + 2 * i + 2].copy_from_slice(&n.to_le_bytes()));
    };
    shorts(40, &[4, 2, 2, 1, 2]);
    shorts(70, &[2]);
    shorts(252, &[1]);
    let mut floats = |at: usize, all: &[f32]| {
        all.iter().enumerate().for_each(|(i, n)| header[at + 4 * i..at + 4 * i + 4].copy_from_slice(&n.to_le_bytes()));
    };
    floats(76, &[1.0, 2.0, 3.0, 4.0, 0.5]);
    floats(108, &[352.0, 0.5, 1.0]);
    floats(256, &[0.0, 0.0, 0.7, 1.0, 2.0, 3.0]);
    header[123] = 10;
    header[344..348].copy_from_slice(b"n+1\0");
    header
}

fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut packed = Vec::new();
    flate2::read::GzEncoder::new(bytes, flate2::Compression::fast())
        .read_to_end(&mut packed)
        .expect("memory can be read");
    packed
}

fn zlib(bytes: &[u8]) -> Vec<u8> {
    let mut packed = Vec::new();
    flate2::read::ZlibEncoder::new(bytes, flate2::Compression::fast())
        .read_to_end(&mut packed)
        .expect("memory can be read");
    packed
}

/// Loads a wrong file, or the header that names it.
fn read(folder: &Path, name: &str, bytes: &[u8]) -> Result<bool, String> {
    let sibling = |path: &Path| -> io::Result<Vec<u8>> {
        if path == folder.join(name) { Ok(bytes.to_vec()) } else { std::fs::read(path) }
    };
    let loaded = match DETACHED.iter().find(|(data, _)| *data == name) {
        Some((_, header)) => {
            let own = std::fs::read(folder.join(header)).map_err(|error| error.to_string())?;
            load_bytes(&folder.join(header), &own, &sibling)
        }
        None => load_bytes(&folder.join(name), bytes, &sibling),
    };
    match loaded {
        Ok(file) => check(&file).map(|()| true),
        Err(error) => refused(&error.to_string()),
    }
}

/// Why a file that was taken is not sound.
fn check(file: &FieldFile) -> Result<(), String> {
    file.warnings.iter().try_for_each(|warning| refused(warning).map(drop))?;
    for (i, field) in file.fields.iter().enumerate() {
        if field.name.is_empty() || file.fields[..i].iter().any(|other| other.name == field.name) {
            return Err(format!("the name {:?} is taken", field.name));
        }
        check_field(field).map_err(|why| format!("{:?}: {why}", field.name))?;
    }
    if file.fields.is_empty() { Err("there are no fields".into()) } else { Ok(()) }
}

fn check_field(field: &Field) -> Result<(), String> {
    let grid = &field.grid;
    let count = grid.count() * field.components;
    if grid.size.iter().any(|n| !(1..=2048).contains(n)) || field.components == 0 || field.steps.is_empty() {
        return Err("its grid is none".into());
    }
    if grid.corners().iter().any(|corner| !corner.is_finite()) || grid.steps.iter().any(|step| step.length() == 0.0) {
        return Err("its places are none".into());
    }
    for step in &field.steps {
        let is_sound = match &step.values {
            Values::U8(values) => values.len() == count,
            Values::F32(values) => values.len() == count && !values.iter().any(|value| value.is_infinite()),
        };
        if !is_sound {
            return Err("its values are not as many as its samples, or infinite".into());
        }
    }
    for component in [Component::Magnitude, Component::Index(0), Component::Index(field.components)] {
        let scalars = field.scalar(0, component);
        let is_empty = scalars.range.is_none() && scalars.missing == scalars.values.len();
        let is_ordered = scalars.range.is_some_and(|[min, max]| min <= max && max.is_finite());
        if scalars.values.len() != grid.count() || !(is_empty || is_ordered) {
            return Err(format!("its scalars are not sound: {:?}", scalars.range));
        }
    }
    if count * field.steps.len() > MOST_WRITTEN {
        return Ok(());
    }
    let none = |_: &Path| Err(io::Error::new(io::ErrorKind::NotFound, "there is none"));
    let written = load_bytes(Path::new("written.nrrd"), &write_nrrd(field, Packing::Raw), &none);
    let again = written.map_err(|error| format!("what was written is refused: {error}"))?;
    let same = again.fields.len() == 1 && again.fields[0].steps.len() == field.steps.len();
    let is_equal = |a: &Values, b: &Values| {
        a.len() == b.len()
            && (0..a.len()).all(|i| a.get(i).to_bits() == b.get(i).to_bits() || a.get(i).is_nan() && b.get(i).is_nan())
    };
    let mut steps = field.steps.iter().zip(again.fields.first().map_or(&[][..], |field| &field.steps));
    match same && steps.all(|(a, b)| is_equal(&a.values, &b.values)) {
        true => Ok(()),
        false => Err("what was written is another field".into()),
    }
}
