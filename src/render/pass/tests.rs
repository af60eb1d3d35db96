//! The list of passes.
