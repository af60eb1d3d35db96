//! Operators and built-in functions of WGSL on the host.

use wgpu::naga::{BinaryOperator as B, MathFunction as M, UnaryOperator as U};

use crate::shader::host::value::{
    Dual,
    Scalar::{self, Bool, Int, Real, Uint},
    Value,
};

/// Functions that the host runs.
pub fn is_known(fun: M) -> bool {
    rate(fun, 0.5).is_some()
        || matches!(
            fun,
            M::Min
                | M::Max
                | M::Clamp
                | M::Atan2
                | M::Pow
                | M::Dot
                | M::Cross
                | M::Distance
                | M::Length
                | M::Normalize
                | M::Reflect
                | M::Fma
                | M::Mix
                | M::Step
                | M::SmoothStep
                | M::Transpose
                | M::Determinant
        )
}

/// A function of one number and its derivative; `None`: it is none of these.
fn rate(fun: M, x: f64) -> Option<(f64, f64)> {
    let inside = |low: f64, high: f64| f64::from(u8::from((low..=high).contains(&x)));
    Some(match fun {
        M::Abs => (x.abs(), x.signum()),
        M::Saturate => (x.clamp(0.0, 1.0), inside(0.0, 1.0)),
        M::Cos => (x.cos(), -x.sin()),
        M::Sin => (x.sin(), x.cos()),
        M::Tan => (x.tan(), 1.0 + x.tan() * x.tan()),
        M::Cosh => (x.cosh(), x.sinh()),
        M::Sinh => (x.sinh(), x.cosh()),
        M::Tanh => (x.tanh(), 1.0 - x.tanh() * x.tanh()),
        M::Acos => (x.acos(), -(1.0 - x * x).sqrt().recip()),
        M::Asin => (x.asin(), (1.0 - x * x).sqrt().recip()),
        M::Atan => (x.atan(), (1.0 + x * x).recip()),
        M::Asinh => (x.asinh(), (1.0 + x * x).sqrt().recip()),
        M::Acosh => (x.acosh(), (x * x - 1.0).sqrt().recip()),
        M::Atanh => (x.atanh(), (1.0 - x * x).recip()),
        M::Radians => (x.to_radians(), 1_f64.to_radians()),
        M::Degrees => (x.to_degrees(), 1_f64.to_degrees()),
        M::Ceil => (x.ceil(), 0.0),
        M::Floor => (x.floor(), 0.0),
        M::Round => (x.round_ties_even(), 0.0),
        M::Trunc => (x.trunc(), 0.0),
        M::Fract => (x - x.floor(), 1.0),
        M::Exp => (x.exp(), x.exp()),
        M::Exp2 => (x.exp2(), x.exp2() * std::f64::consts::LN_2),
        M::Log => (x.ln(), x.recip()),
        M::Log2 => (x.log2(), (x * std::f64::consts::LN_2).recip()),
        M::Sign => (if x == 0.0 { 0.0 } else { x.signum() }, 0.0),
        M::Sqrt => (x.sqrt(), if x > 0.0 { 0.5 / x.sqrt() } else { 0.0 }),
        M::InverseSqrt => (x.sqrt().recip(), -0.5 / (x * x.sqrt())),
        _ => return None,
    })
}

/// Pairs lanes: a scalar stands for as many as the others have.
fn lanes<const N: usize>(values: [&Value; N], f: impl Fn([Scalar; N]) -> Option<Scalar>) -> Option<Value> {
    let count = values.iter().map(|value| value.scalars().len()).max()?;
    let lane = |i: usize| {
        let mut each = [Bool(false); N];
        for (to, value) in each.iter_mut().zip(values) {
            let scalars = value.scalars();
            *to = *scalars.get(if scalars.len() == 1 { 0 } else { i })?;
        }
        f(each)
    };
    if values.iter().all(|value| matches!(value, Value::Scalar(_))) {
        return lane(0).map(Value::Scalar);
    }
    let all: Option<Vec<Scalar>> = (0..count).map(lane).collect();
    all.map(Value::lanes)
}

/// `values` where a condition is, by lanes.
pub fn select(condition: &Value, accept: &Value, reject: &Value) -> Option<Value> {
    match condition.truth() {
        Some(true) => Some(accept.clone()),
        Some(false) => Some(reject.clone()),
        None => lanes([condition, accept, reject], |[is, yes, no]| match is {
            Bool(is) => Some(if is { yes } else { no }),
            _ => None,
        }),
    }
}

/// A unary operator.
pub fn unary(op: U, value: &Value) -> Option<Value> {
    if let Value::Many(columns) = value {
        return columns.iter().map(|column| unary(op, column)).collect::<Option<_>>().map(Value::Many);
    }
    lanes([value], |[x]| match (op, x) {
        (U::Negate, Real(x)) => Some(Real(-x)),
        (U::Negate, Int(x)) => Some(Int(x.wrapping_neg())),
        (U::LogicalNot, Bool(x)) => Some(Bool(!x)),
        (U::BitwiseNot, Int(x)) => Some(Int(!x)),
        (U::BitwiseNot, Uint(x)) => Some(Uint(!x)),
        _ => None,
    })
}

/// A binary operator.
pub fn binary(op: B, left: &Value, right: &Value) -> Option<Value> {
    match (op, left, right) {
        (B::Multiply, Value::Many(columns), Value::Many(others)) => {
            let each = others.iter().map(|other| combined(columns, other));
            each.collect::<Option<_>>().map(Value::Many)
        }
        (B::Multiply, Value::Many(columns), Value::Vector(..)) => combined(columns, right),
        (B::Multiply, Value::Vector(..), Value::Many(columns)) => {
            let each: Option<Vec<Scalar>> = columns.iter().map(|column| dot(left, column).map(Real)).collect();
            each.map(Value::lanes)
        }
        (_, Value::Many(columns), Value::Many(others)) => {
            let each = columns.iter().zip(others).map(|(a, b)| binary(op, a, b));
            each.collect::<Option<_>>().map(Value::Many)
        }
        (_, Value::Many(columns), _) => {
            columns.iter().map(|column| binary(op, column, right)).collect::<Option<_>>().map(Value::Many)
        }
        (_, _, Value::Many(columns)) => {
            columns.iter().map(|column| binary(op, left, column)).collect::<Option<_>>().map(Value::Many)
        }
        _ => lanes([left, right], |[a, b]| of_scalars(op, a, b)),
    }
}

/// A matrix times a vector.
fn combined(columns: &[Value], vector: &Value) -> Option<Value> {
    let parts =
        columns.iter().zip(vector.scalars()).map(|(column, share)| binary(B::Multiply, column, &Value::Scalar(*share)));
    let parts: Option<Vec<Value>> = parts.collect();
    let mut parts = parts?.into_iter();
    let first = parts.next()?;
    parts.try_fold(first, |sum, part| binary(B::Add, &sum, &part))
}

fn of_scalars(op: B, a: Scalar, b: Scalar) -> Option<Scalar> {
    match (a, b) {
        (Real(a), Real(b)) => of_reals(op, a, b),
        (Int(a), Int(b)) => of_ints(op, a, b),
        (Uint(a), Uint(b)) => of_uints(op, a, b),
        (Int(a), Uint(b)) => Some(Int(match op {
            B::ShiftLeft => a.wrapping_shl(b),
            B::ShiftRight => a.wrapping_shr(b),
            _ => return None,
        })),
        (Bool(a), Bool(b)) => Some(Bool(match op {
            B::And | B::LogicalAnd => a & b,
            B::InclusiveOr | B::LogicalOr => a | b,
            B::ExclusiveOr | B::NotEqual => a ^ b,
            B::Equal => a == b,
            _ => return None,
        })),
        _ => None,
    }
}

fn compared<T: PartialOrd>(op: B, a: T, b: T) -> Option<Scalar> {
    Some(Bool(match op {
        B::Equal => a == b,
        B::NotEqual => a != b,
        B::Less => a < b,
        B::LessEqual => a <= b,
        B::Greater => a > b,
        B::GreaterEqual => a >= b,
        _ => return None,
    }))
}

fn of_reals(op: B, a: Dual, b: Dual) -> Option<Scalar> {
    Some(Real(match op {
        B::Add => a + b,
        B::Subtract => a - b,
        B::Multiply => a * b,
        B::Divide => a / b,
        B::Modulo => a - b * Dual::constant((a.value / b.value).trunc()),
        _ => return compared(op, a.value, b.value),
    }))
}

macro_rules! whole {
    ($name:ident, $type:ty, $wrap:ident) => {
        fn $name(op: B, a: $type, b: $type) -> Option<Scalar> {
            Some($wrap(match op {
                B::Add => a.wrapping_add(b),
                B::Subtract => a.wrapping_sub(b),
                B::Multiply => a.wrapping_mul(b),
                // As WGSL has it.
                B::Divide => a.checked_div(b).unwrap_or(a),
                B::Modulo => a.checked_rem(b).unwrap_or(0),
                B::And => a & b,
                B::InclusiveOr => a | b,
                B::ExclusiveOr => a ^ b,
                B::ShiftLeft => a.wrapping_shl(b as u32),
                B::ShiftRight => a.wrapping_shr(b as u32),
                _ => return compared(op, a, b),
            }))
        }
    };
}

whole!(of_ints, i32, Int);
whole!(of_uints, u32, Uint);

/// The scalar product.
fn dot(a: &Value, b: &Value) -> Option<Dual> {
    let (a, b) = (a.scalars(), b.scalars());
    let terms = a.iter().zip(b).map(|(a, b)| Some(a.real()? * b.real()?));
    terms.reduce(|sum, term| Some(sum? + term?))?
}

/// A built-in function; `arguments`: as many as it takes.
pub fn function(fun: M, arguments: &[Value]) -> Option<Value> {
    let [a, rest @ ..] = arguments else { return None };
    let one = |x: Scalar| match x {
        Real(x) => rate(fun, x.value).map(|(value, rate)| Real(x.mapped(value, rate))),
        Int(x) if fun == M::Abs => Some(Int(x.wrapping_abs())),
        Int(x) if fun == M::Sign => Some(Int(x.signum())),
        Uint(_) if fun == M::Abs => Some(x),
        _ => None,
    };
    match (fun, rest) {
        (M::Dot, [b]) => dot(a, b).map(|x| Value::Scalar(Real(x))),
        (M::Length, []) => dot(a, a).map(|x| Value::Scalar(Real(x.root()))),
        (M::Distance, [b]) => function(M::Length, &[binary(B::Subtract, a, b)?]),
        (M::Normalize, []) => binary(B::Divide, a, &function(M::Length, std::slice::from_ref(a))?),
        (M::Cross, [b]) => {
            let ([a, b], two) =
                ([a.reals::<3>()?, b.reals::<3>()?], |a: Dual, b: Dual, c: Dual, d: Dual| a * b - c * d);
            Some(Value::vector([two(a[1], b[2], a[2], b[1]), two(a[2], b[0], a[0], b[2]), two(a[0], b[1], a[1], b[0])]))
        }
        (M::Reflect, [normal]) => {
            let twice = dot(a, normal)? * Dual::constant(2.0);
            binary(B::Subtract, a, &binary(B::Multiply, normal, &Value::Scalar(Real(twice)))?)
        }
        (M::Transpose, []) => transposed(a),
        (M::Determinant, []) => determinant(a).map(|x| Value::Scalar(Real(x))),
        (_, []) => lanes([a], |[x]| one(x)),
        (_, [b]) => lanes([a, b], |[x, y]| of_two(fun, x, y)),
        (_, [b, c]) => lanes([a, b, c], |[x, y, z]| of_three(fun, x, y, z)),
        _ => None,
    }
}

fn of_two(fun: M, x: Scalar, y: Scalar) -> Option<Scalar> {
    Some(match (fun, x, y) {
        (M::Min, Real(x), Real(y)) => Real(if y.value < x.value { y } else { x }),
        (M::Max, Real(x), Real(y)) => Real(if y.value > x.value { y } else { x }),
        (M::Min, Int(x), Int(y)) => Int(x.min(y)),
        (M::Max, Int(x), Int(y)) => Int(x.max(y)),
        (M::Min, Uint(x), Uint(y)) => Uint(x.min(y)),
        (M::Max, Uint(x), Uint(y)) => Uint(x.max(y)),
        (M::Step, Real(edge), Real(x)) => Real(Dual::constant(f64::from(u8::from(x.value >= edge.value)))),
        (M::Atan2, Real(y), Real(x)) => {
            let squared = x.value * x.value + y.value * y.value;
            let slope =
                if squared > 0.0 { (y.slope * x.value - x.slope * y.value) / squared } else { glam::DVec3::ZERO };
            Real(Dual { value: y.value.atan2(x.value), slope })
        }
        (M::Pow, Real(x), Real(e)) => {
            let value = x.value.powf(e.value);
            let by_base = x.mapped(value, if e.value == 0.0 { 0.0 } else { e.value * x.value.powf(e.value - 1.0) });
            let by_exponent = e.mapped(value, if value == 0.0 { 0.0 } else { value * x.value.ln() });
            Real(Dual { value, slope: by_base.slope + by_exponent.slope })
        }
        _ => return None,
    })
}

fn of_three(fun: M, x: Scalar, y: Scalar, z: Scalar) -> Option<Scalar> {
    if fun == M::Clamp {
        return of_two(M::Min, of_two(M::Max, x, y)?, z);
    }
    let (Real(x), Real(y), Real(z)) = (x, y, z) else { return None };
    Some(Real(match fun {
        M::Fma => x * y + z,
        M::Mix => x * (Dual::constant(1.0) - z) + y * z,
        M::SmoothStep => {
            let t = (z - x) / (y - x);
            let q = t.value.clamp(0.0, 1.0);
            let inside = f64::from(u8::from((0.0..=1.0).contains(&t.value)));
            t.mapped(q * q * (3.0 - 2.0 * q), inside * 6.0 * q * (1.0 - q))
        }
        _ => return None,
    }))
}

fn transposed(matrix: &Value) -> Option<Value> {
    let Value::Many(columns) = matrix else { return None };
    let rows = columns.first()?.scalars().len();
    let row = |i: usize| Value::lanes(columns.iter().filter_map(|column| column.scalars().get(i).copied()));
    Some(Value::Many((0..rows).map(row).collect()))
}

fn determinant(matrix: &Value) -> Option<Dual> {
    let Value::Many(columns) = matrix else { return None };
    let rows: Option<Vec<Vec<Dual>>> =
        columns.iter().map(|column| column.scalars().iter().map(|x| x.real()).collect()).collect();
    fn of(rows: &[Vec<Dual>]) -> Option<Dual> {
        let (first, rest) = rows.split_first()?;
        if rest.is_empty() {
            return first.first().copied();
        }
        let mut sum = Dual::constant(0.0);
        for (i, &x) in first.iter().enumerate() {
            let minor: Vec<Vec<Dual>> = rest
                .iter()
                .map(|row| row.iter().enumerate().filter(|(j, _)| *j != i).map(|(_, x)| *x).collect())
                .collect();
            let term = x * of(&minor)?;
            sum = if i % 2 == 0 { sum + term } else { sum - term };
        }
        Some(sum)
    }
    of(&rows?)
}
