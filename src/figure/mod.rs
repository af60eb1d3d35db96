//! A figure is a frame written down: scene files and back, pictures and their metadata.

pub mod file;
pub mod picture;
pub mod scene_file;
