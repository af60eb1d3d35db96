//! A scene becomes a frame.
pub mod layout;
