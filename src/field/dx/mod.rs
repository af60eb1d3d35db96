//! Native files of OpenDX (`.dx`): objects that refer to each other, and numbers behind or beside them.

mod assemble;
mod clauses;
mod objects;
mod positions;
mod tokens;

use crate::field::{dx::objects::Objects, error::FieldError, input::Input, output::Output};

/// Reads a native file.
pub fn read(input: &Input<'_>, output: &mut Output) -> Result<(), FieldError> {
    let objects = Objects::read(input)?;
    assemble::assemble(input, &objects, output)
}

#[cfg(test)]
mod tests;
