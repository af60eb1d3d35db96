//! Just enough of WGSL's grammar to rename, merge and specialise what a file declares, by its tokens: never by how a text is laid out.

pub mod function;
pub mod merge;
pub mod rename;
pub mod token;
