//! Users' handlers run on the host: their WGSL, as naga reads it, in f64 with derivatives.
//!
//! What is asked of a deformation, a region or a transform beside the picture (where something is shown, whether space folds, which objects
//! are inside) is asked of the same text that the GPU runs. Numbers are f64 and carry their derivatives by the place ([`Dual`]), so these are
//! exact to rounding; at kinks one side counts. A GPU's f32 differs by its rounding, and its sine and power by what the adapter's are worth.

mod math;
mod run;
mod value;

use std::ops::Range;

use glam::{DMat3, DVec3};
use wgpu::naga::{Function, Handle, Module, front::wgsl};

use crate::shader::{
    effect::{definition::EffectDefinition, prototype::EffectKind},
    library::MOMENT,
};

pub use value::{Dual, Scalar, Value};

/// A handler's function, ready to run.
#[derive(Debug)]
pub struct HostProgram {
    module: Module,
    main: Handle<Function>,
    /// Types of the parameters in WGSL, in order.
    parameters: Vec<&'static str>,
    /// Whether its first argument has two coordinates, not three.
    is_flat: bool,
}

/// What the host cannot run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Unknown {
    /// Where it stands in the handler's source.
    pub at: Option<Range<usize>>,
    /// What it is, and what would be right.
    pub message: String,
}

impl PartialEq for HostProgram {
    fn eq(&self, other: &Self) -> bool {
        std::ptr::eq(self, other)
    }
}

impl HostProgram {
    /// Reads a handler whose WGSL was found to be valid.
    ///
    /// # Errors
    /// What it uses that the host does not run: pointers, bit functions, what is packed.
    pub fn new(effect: &EffectDefinition) -> Result<Self, Unknown> {
        let array = effect.kind.prototype().parameters;
        // What reads the parameters is not called here.
        let head = match effect.kind {
            EffectKind::Epoch => {
                format!("{}var<private> {array}: array<u32, {}>;\n", MOMENT.paragraph(), effect.floats().max(1))
            }
            _ => effect.array_of_parameters(),
        };
        let text = head.clone() + &effect.source;
        let unknown = |at: Option<Range<usize>>, message: String| {
            let own = |at: Range<usize>| at.start.saturating_sub(head.len())..at.end.saturating_sub(head.len());
            Unknown { at: at.map(own), message }
        };
        let module = wgsl::parse_str(&text).map_err(|error| {
            let at = error.labels().next().and_then(|(span, _)| span.to_range());
            unknown(at, error.message().to_owned())
        })?;
        let name = effect.wgsl_name();
        let main = module.functions.iter().find(|(_, f)| f.name.as_deref() == Some(&name)).map(|(handle, _)| handle);
        let main = main.ok_or_else(|| unknown(None, "there is no function `effect`".to_owned()))?;
        for (_, function) in module.functions.iter().filter(|(_, f)| f.name != Some(effect.own("parameters"))) {
            run::check(&module, function).map_err(|(at, message)| unknown(at.to_range(), message))?;
        }
        let parameters = effect.shader_parameters().map(|(_, type_name, _)| type_name).collect();
        Ok(Self { module, main, parameters, is_flat: effect.kind.subject().1 == "vec2f" })
    }

    /// What its function makes of a place in a lens of this size, with these parameters, packed as the GPU has them.
    pub fn call(&self, place: DVec3, size: DVec3, parameters: &[f32]) -> Option<Value> {
        let along = |i: usize| Dual::coordinate(place[i], i);
        let place = if self.is_flat { Value::vector([0, 1].map(along)) } else { Value::vector([0, 1, 2].map(along)) };
        let mut arguments = vec![place, Value::vector(size.to_array().map(Dual::constant))];
        if !self.parameters.is_empty() {
            arguments.push(self.parameters(parameters));
        }
        run::call(&self.module, &self.module.functions[self.main], arguments)
    }

    /// A vector that it gives, and the derivative of that by the place (columns: by x, y, z).
    pub fn vector(&self, place: DVec3, size: DVec3, parameters: &[f32]) -> Option<(DVec3, DMat3)> {
        let [x, y, z] = self.call(place, size, parameters)?.reals()?;
        let rows = DMat3::from_cols(x.slope, y.slope, z.slope);
        Some((DVec3::new(x.value, y.value, z.value), rows.transpose()))
    }

    /// A number that it gives, and its gradient.
    pub fn number(&self, place: DVec3, size: DVec3, parameters: &[f32]) -> Option<(f64, DVec3)> {
        match self.call(place, size, parameters)? {
            Value::Scalar(Scalar::Real(dual)) => Some((dual.value, dual.slope)),
            _ => None,
        }
    }

    /// The moment that a time operator makes of another, in its parameters' words; both as hours and microseconds of the hour.
    pub fn moment(&self, moment: [u32; 2], words: &[u32]) -> Option<[u32; 2]> {
        let mut arguments = vec![in_words("Moment", &mut moment.into_iter())];
        if !self.parameters.is_empty() {
            let mut words = words.iter().copied();
            arguments.push(Value::Many(self.parameters.iter().map(|name| in_words(name, &mut words)).collect()));
        }
        match run::call(&self.module, &self.module.functions[self.main], arguments)? {
            Value::Many(members) => match members[..] {
                [Value::Scalar(Scalar::Int(hour)), Value::Scalar(Scalar::Uint(micro))] => {
                    Some([hour.cast_unsigned(), micro])
                }
                _ => None,
            },
            _ => None,
        }
    }

    /// What a step of the program makes of a place: it takes no size.
    #[cfg(test)]
    fn step(&self, place: DVec3, parameters: &[f32]) -> Option<Value> {
        let place = Value::vector([0, 1, 2].map(|i| Dual::coordinate(place[i], i)));
        run::call(&self.module, &self.module.functions[self.main], vec![place, self.parameters(parameters)])
    }

    fn parameters(&self, numbers: &[f32]) -> Value {
        let mut numbers = numbers.iter().map(|n| f64::from(*n));
        let mut next = || numbers.next().unwrap_or(0.0);
        let of = |type_name: &&str| match *type_name {
            "bool" => Value::Scalar(Scalar::Bool(next() != 0.0)),
            "u32" => Value::Scalar(Scalar::Uint(next() as u32)),
            "vec3f" => Value::vector([next(), next(), next()].map(Dual::constant)),
            _ => Value::Scalar(Scalar::Real(Dual::constant(next()))),
        };
        Value::Many(self.parameters.iter().map(of).collect())
    }
}

/// A parameter of a time operator, of words.
fn in_words(type_name: &str, words: &mut impl Iterator<Item = u32>) -> Value {
    let mut next = || words.next().unwrap_or(0);
    let int = |word: u32| Value::Scalar(Scalar::Int(word.cast_signed()));
    let real = |word: u32| Dual::constant(f32::from_bits(word).into());
    match type_name {
        "Moment" => Value::Many(vec![int(next()), Value::Scalar(Scalar::Uint(next()))]),
        "Unit" => {
            Value::Many(vec![int(next()), Value::Scalar(Scalar::Uint(next())), Value::Scalar(Scalar::Uint(next()))])
        }
        "Duration" => Value::Many(vec![int(next()), int(next()), Value::Scalar(Scalar::Uint(next()))]),
        "bool" => Value::Scalar(Scalar::Bool(f32::from_bits(next()) != 0.0)),
        "u32" => Value::Scalar(Scalar::Uint(f32::from_bits(next()) as u32)),
        "vec3f" => Value::vector([next(), next(), next()].map(real)),
        _ => Value::Scalar(Scalar::Real(real(next()))),
    }
}

#[cfg(test)]
mod tests;
