//! `veduta render`: one picture, no window.

pub mod arguments;
