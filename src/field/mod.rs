//! Fields of scalars, vectors and labels on grids: files become plain arrays.
//!
//! What is read lies on a regular grid; what a file has on another is resampled, and a warning says how. Coordinates and values stay in
//! the units of the file. Nothing is allocated that the bytes of a file do not call for.

pub mod data;
mod dx;
pub mod error;
mod general;
pub mod grid;
mod input;
mod metaimage;
#[cfg(feature = "netcdf")]
mod netcdf;
mod nifti;
mod nrrd;
mod numbers;
mod output;
mod resample;
mod sniff;
mod synthetic;
#[cfg(test)]
mod testing;
mod vti;
mod vtk;
mod words;

use std::{cell::RefCell, io, path::Path};

pub use data::{Component, Field, FieldFile, Scalars, Step, Values};
pub use error::FieldError;
pub use grid::Grid;
pub use nrrd::{Packing, write_nrrd};
pub use synthetic::plume;

use crate::field::{input::Input, output::Output, sniff::Format};

/// The field that comes with the program, as scenes name it: carbon dioxide over a city, by formula.
pub const PLUME: &str = "builtin:plume";
/// Samples of that.
const PLUME_SIZE: [usize; 3] = [65, 65, 25];

/// Whether a file is one of a field by its name.
pub fn is_field(path: &Path) -> bool {
    path == Path::new(PLUME) || sniff::is_named(path)
}

/// Loads a field file, and what it names beside it; [`PLUME`] is none, and always there.
///
/// # Errors
/// It cannot be read, or is no field: the file, the place and what would be right.
pub fn load(path: &Path) -> Result<FieldFile, FieldError> {
    if path == Path::new(PLUME) {
        return Ok(FieldFile {
            format: "built in",
            fields: vec![plume(PLUME_SIZE)],
            warnings: Vec::new(),
            beside: Vec::new(),
        });
    }
    let bytes = input::read(path).map_err(|e| FieldError::new(path, format!("cannot be read: {e}")))?;
    let beside = RefCell::new(Vec::new());
    let sibling = |path: &Path| {
        beside.borrow_mut().push(path.to_owned());
        input::read(path)
    };
    let file = load_bytes(path, &bytes, &sibling)?;
    Ok(FieldFile { beside: beside.into_inner(), ..file })
}

/// Loads a field file from memory. `path` is for messages, for its extension and for the names of files beside it, which `sibling` reads;
/// nothing else is read from the disk.
pub fn load_bytes(
    path: &Path,
    bytes: &[u8],
    sibling: &dyn Fn(&Path) -> io::Result<Vec<u8>>,
) -> Result<FieldFile, FieldError> {
    let input = Input::new(path, bytes, sibling)?;
    let mut output = Output::default();
    let format = match sniff::format(&input).map_err(|message| input.fail(message))? {
        Format::Nrrd => nrrd::read(&input, &mut output).map(|()| "NRRD")?,
        Format::Vti => vti::read(&input, &mut output).map(|()| "VTK XML image")?,
        Format::Vtk => vtk::read(&input, &mut output).map(|()| "legacy VTK")?,
        Format::Dx => dx::read(&input, &mut output).map(|()| "OpenDX")?,
        Format::General => general::read(&input, &mut output).map(|()| "general array (OpenDX)")?,
        Format::MetaImage => metaimage::read(&input, &mut output).map(|()| "MetaImage")?,
        Format::Nifti => nifti::read(&input, &mut output).map(|()| "NIfTI-1")?,
        #[cfg(feature = "netcdf")]
        Format::NetCdf => netcdf::read(&input, &mut output).map(|()| "NetCDF")?,
        #[cfg(not(feature = "netcdf"))]
        Format::NetCdf => return Err(input.fail("is NetCDF, which this build of Veduta does not read")),
    };
    output.finish(format).map_err(|message| input.fail(message))
}
