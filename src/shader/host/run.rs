//! Functions of WGSL run on the host, statement by statement.

use wgpu::naga::{
    Block, Constant, Expression, Function, Handle, Literal, LocalVariable, Module, RelationalFunction, ScalarKind,
    Span, Statement, SwitchValue, Type, TypeInner,
};

use crate::shader::host::{
    math,
    value::{
        Dual,
        Scalar::{self, Bool, Int, Real, Uint},
        Value,
    },
};

/// What a function uses that the host does not run: its place, and what would be right.
pub fn check(module: &Module, function: &Function) -> Result<(), (Span, String)> {
    check_block(&function.body)?;
    for (handle, expression) in function.expressions.iter() {
        let what = match expression {
            Expression::Math { fun, .. } if !math::is_known(*fun) => {
                format!("{} is not run on the host", format!("{fun:?}").to_lowercase())
            }
            Expression::Derivative { .. } => "there are no neighbouring pixels here".to_owned(),
            Expression::As { convert: None, .. } => "bitcast is not run on the host".to_owned(),
            Expression::GlobalVariable(_) => "it knows its arguments alone".to_owned(),
            Expression::FunctionArgument(index) if takes_pointer(module, function, *index) => {
                "pointers are not run on the host".to_owned()
            }
            Expression::FunctionArgument(_) | Expression::Literal(_) | Expression::Constant(_) => continue,
            Expression::Relational { fun: RelationalFunction::IsInf | RelationalFunction::IsNan, .. } => {
                "it is not asked of numbers what they are".to_owned()
            }
            Expression::ZeroValue(_)
            | Expression::Compose { .. }
            | Expression::Access { .. }
            | Expression::AccessIndex { .. }
            | Expression::Splat { .. }
            | Expression::Swizzle { .. }
            | Expression::LocalVariable(_)
            | Expression::Load { .. }
            | Expression::Unary { .. }
            | Expression::Binary { .. }
            | Expression::Select { .. }
            | Expression::Relational { .. }
            | Expression::Math { .. }
            | Expression::As { .. }
            | Expression::CallResult(_) => continue,
            _ => "this is not run on the host".to_owned(),
        };
        let span = function.expressions.get_span(handle);
        return Err((span, format!("{what}; expected arithmetic of numbers and vectors")));
    }
    Ok(())
}

fn takes_pointer(module: &Module, function: &Function, argument: u32) -> bool {
    let ty = function.arguments.get(argument as usize).map(|argument| &module.types[argument.ty].inner);
    matches!(ty, Some(TypeInner::Pointer { .. } | TypeInner::ValuePointer { .. }))
}

/// The first statement that the host does not run.
fn check_block(block: &Block) -> Result<(), (Span, String)> {
    for (statement, span) in block.span_iter() {
        match statement {
            Statement::Block(inner) => check_block(inner)?,
            Statement::If { accept, reject, .. } => {
                check_block(accept)?;
                check_block(reject)?;
            }
            Statement::Switch { cases, .. } => cases.iter().try_for_each(|case| check_block(&case.body))?,
            Statement::Loop { body, continuing, .. } => {
                check_block(body)?;
                check_block(continuing)?;
            }
            Statement::Emit(_)
            | Statement::Break
            | Statement::Continue
            | Statement::Return { .. }
            | Statement::Store { .. }
            | Statement::Call { .. } => {}
            _ => {
                return Err((
                    *span,
                    "this is not run on the host; expected arithmetic of numbers and vectors".to_owned(),
                ));
            }
        }
    }
    Ok(())
}

/// What a function gives for these arguments; `None` where it does what [`check`] refuses.
pub fn call(module: &Module, function: &Function, arguments: Vec<Value>) -> Option<Value> {
    let mut frame =
        Frame { module, function, arguments, locals: Vec::new(), known: vec![None; function.expressions.len()] };
    for (_, local) in function.local_variables.iter() {
        let value = match local.init {
            Some(init) => frame.value(init)?,
            None => zero(module, local.ty)?,
        };
        frame.locals.push(value);
    }
    match frame.block(&function.body)? {
        Flow::Return(value) => value,
        _ => None,
    }
}

/// A call while it runs.
struct Frame<'a> {
    module: &'a Module,
    function: &'a Function,
    arguments: Vec<Value>,
    locals: Vec<Value>,
    /// Expressions that were emitted.
    known: Vec<Option<Value>>,
}

/// Where a statement leaves.
enum Flow {
    Next,
    Break,
    Continue,
    Return(Option<Value>),
}

impl Frame<'_> {
    fn block(&mut self, block: &Block) -> Option<Flow> {
        for statement in block.iter() {
            match self.statement(statement)? {
                Flow::Next => {}
                other => return Some(other),
            }
        }
        Some(Flow::Next)
    }

    fn statement(&mut self, statement: &Statement) -> Option<Flow> {
        match statement {
            Statement::Emit(range) => {
                for handle in range.clone().filter(|handle| !self.is_pointer(*handle)).collect::<Vec<_>>() {
                    let value = self.computed(handle)?;
                    self.known[handle.index()] = Some(value);
                }
            }
            Statement::Block(block) => return self.block(block),
            Statement::If { condition, accept, reject } => {
                return match self.value(*condition)?.truth()? {
                    true => self.block(accept),
                    false => self.block(reject),
                };
            }
            Statement::Switch { selector, cases } => {
                let selector = self.value(*selector)?.whole()?;
                let is_it = |value: &SwitchValue| match value {
                    SwitchValue::I32(n) => i64::from(*n) == selector,
                    SwitchValue::U32(n) => i64::from(*n) == selector,
                    SwitchValue::Default => false,
                };
                let first = cases.iter().position(|case| is_it(&case.value));
                let first = first.or_else(|| cases.iter().position(|case| case.value == SwitchValue::Default))?;
                for case in &cases[first..] {
                    match self.block(&case.body)? {
                        Flow::Next if case.fall_through => {}
                        Flow::Next | Flow::Break => break,
                        other => return Some(other),
                    }
                }
            }
            Statement::Loop { body, continuing, break_if } => loop {
                match self.block(body)? {
                    Flow::Break => break,
                    Flow::Return(value) => return Some(Flow::Return(value)),
                    Flow::Next | Flow::Continue => {}
                }
                self.block(continuing)?;
                if let Some(condition) = break_if
                    && self.value(*condition)?.truth()?
                {
                    break;
                }
            },
            Statement::Break => return Some(Flow::Break),
            Statement::Continue => return Some(Flow::Continue),
            Statement::Return { value } => {
                let value = match value {
                    Some(value) => Some(self.value(*value)?),
                    None => None,
                };
                return Some(Flow::Return(value));
            }
            Statement::Store { pointer, value } => {
                let value = self.value(*value)?;
                let (local, path) = self.place(*pointer)?;
                self.locals[local.index()].put(&path, value)?;
            }
            Statement::Call { function, arguments, result } => {
                let arguments: Option<Vec<Value>> = arguments.iter().map(|argument| self.value(*argument)).collect();
                let value = call(self.module, &self.module.functions[*function], arguments?);
                if let Some(result) = result {
                    self.known[result.index()] = Some(value?);
                }
            }
            _ => return None,
        }
        Some(Flow::Next)
    }

    fn is_pointer(&self, handle: Handle<Expression>) -> bool {
        match &self.function.expressions[handle] {
            Expression::LocalVariable(_) => true,
            Expression::Access { base, .. } | Expression::AccessIndex { base, .. } => self.is_pointer(*base),
            _ => false,
        }
    }

    /// The variable that a pointer leads to, and the elements on the way into it.
    fn place(&self, pointer: Handle<Expression>) -> Option<(Handle<LocalVariable>, Vec<usize>)> {
        match &self.function.expressions[pointer] {
            Expression::LocalVariable(local) => Some((*local, Vec::new())),
            Expression::Access { base, index } => {
                let (local, mut path) = self.place(*base)?;
                path.push(usize::try_from(self.value(*index)?.whole()?).unwrap_or(0));
                Some((local, path))
            }
            Expression::AccessIndex { base, index } => {
                let (local, mut path) = self.place(*base)?;
                path.push(*index as usize);
                Some((local, path))
            }
            _ => None,
        }
    }

    /// An expression, as it was emitted if it was.
    fn value(&self, handle: Handle<Expression>) -> Option<Value> {
        match &self.known[handle.index()] {
            Some(value) => Some(value.clone()),
            None => self.computed(handle),
        }
    }

    fn computed(&self, handle: Handle<Expression>) -> Option<Value> {
        match &self.function.expressions[handle] {
            Expression::FunctionArgument(index) => self.arguments.get(*index as usize).cloned(),
            Expression::Load { pointer } => {
                let (local, path) = self.place(*pointer)?;
                path.into_iter().try_fold(self.locals[local.index()].clone(), |value, index| value.element(index))
            }
            Expression::Access { base, index } => {
                self.value(*base)?.element(usize::try_from(self.value(*index)?.whole()?).unwrap_or(0))
            }
            Expression::AccessIndex { base, index } => self.value(*base)?.element(*index as usize),
            Expression::Splat { size, value } => {
                let value = self.value(*value)?;
                Some(Value::lanes(std::iter::repeat_n(*value.scalars().first()?, *size as usize)))
            }
            Expression::Swizzle { size, vector, pattern } => {
                let vector = self.value(*vector)?;
                let lanes = pattern[..*size as usize].iter().map(|c| vector.scalars().get(*c as usize).copied());
                lanes.collect::<Option<Vec<_>>>().map(Value::lanes)
            }
            Expression::Unary { op, expr } => math::unary(*op, &self.value(*expr)?),
            Expression::Binary { op, left, right } => math::binary(*op, &self.value(*left)?, &self.value(*right)?),
            Expression::Select { condition, accept, reject } => {
                math::select(&self.value(*condition)?, &self.value(*accept)?, &self.value(*reject)?)
            }
            Expression::Relational { fun, argument } => {
                let value = self.value(*argument)?;
                let mut all = value.scalars().iter().map(|x| matches!(x, Bool(true)));
                Some(Value::Scalar(Bool(match fun {
                    RelationalFunction::All => all.all(|is| is),
                    RelationalFunction::Any => all.any(|is| is),
                    _ => return None,
                })))
            }
            Expression::Math { fun, arg, arg1, arg2, arg3 } => {
                let arguments = [Some(*arg), *arg1, *arg2, *arg3];
                let values: Option<Vec<Value>> = arguments.into_iter().flatten().map(|a| self.value(a)).collect();
                math::function(*fun, &values?)
            }
            Expression::As { expr, kind, convert: Some(_) } => {
                let value = self.value(*expr)?;
                let lanes: Option<Vec<Scalar>> = value.scalars().iter().map(|x| converted(*x, *kind)).collect();
                match value {
                    Value::Scalar(_) => lanes?.first().copied().map(Value::Scalar),
                    _ => lanes.map(Value::lanes),
                }
            }
            Expression::Compose { ty, components } => {
                let values: Option<Vec<Value>> = components.iter().map(|c| self.value(*c)).collect();
                Some(composed(self.module, *ty, values?))
            }
            other => constant(self.module, other),
        }
    }
}

/// A value of its parts.
fn composed(module: &Module, ty: Handle<Type>, parts: Vec<Value>) -> Value {
    match module.types[ty].inner {
        TypeInner::Vector { .. } => {
            let scalars: Vec<Scalar> = parts.iter().flat_map(|part| part.scalars().to_vec()).collect();
            Value::lanes(scalars)
        }
        _ => Value::Many(parts),
    }
}

/// An expression that is the same everywhere.
fn constant(module: &Module, expression: &Expression) -> Option<Value> {
    let global = |handle: Handle<Expression>| constant(module, &module.global_expressions[handle]);
    let of = |constant: Handle<Constant>| global(module.constants[constant].init);
    match expression {
        Expression::Literal(literal) => Some(Value::Scalar(match literal {
            Literal::F32(x) => Real(Dual::constant(f64::from(*x))),
            Literal::F64(x) | Literal::AbstractFloat(x) => Real(Dual::constant(*x)),
            Literal::I32(x) => Int(*x),
            Literal::U32(x) => Uint(*x),
            Literal::AbstractInt(x) => Int(i32::try_from(*x).ok()?),
            Literal::Bool(x) => Bool(*x),
            _ => return None,
        })),
        Expression::Constant(constant) => of(*constant),
        Expression::ZeroValue(ty) => zero(module, *ty),
        Expression::Compose { ty, components } => {
            let parts: Option<Vec<Value>> = components.iter().map(|c| global(*c)).collect();
            Some(composed(module, *ty, parts?))
        }
        Expression::Splat { size, value } => {
            let value = global(*value)?;
            Some(Value::lanes(std::iter::repeat_n(*value.scalars().first()?, *size as usize)))
        }
        _ => None,
    }
}

fn converted(scalar: Scalar, kind: ScalarKind) -> Option<Scalar> {
    let number = match scalar {
        Real(x) if kind == ScalarKind::Float => return Some(Real(x)),
        Real(x) => x.value,
        Int(x) => f64::from(x),
        Uint(x) => f64::from(x),
        Bool(x) => f64::from(u8::from(x)),
    };
    Some(match (kind, scalar) {
        (ScalarKind::Float, _) => Real(Dual::constant(number)),
        // Bits stay.
        (ScalarKind::Sint, Uint(x)) => Int(x as i32),
        (ScalarKind::Uint, Int(x)) => Uint(x as u32),
        (ScalarKind::Sint, _) => Int(number as i32),
        (ScalarKind::Uint, _) => Uint(number as u32),
        (ScalarKind::Bool, _) => Bool(number != 0.0),
        _ => return None,
    })
}

fn zero_scalar(kind: ScalarKind) -> Option<Scalar> {
    converted(Int(0), kind)
}

fn zero(module: &Module, ty: Handle<Type>) -> Option<Value> {
    Some(match &module.types[ty].inner {
        TypeInner::Scalar(scalar) => Value::Scalar(zero_scalar(scalar.kind)?),
        TypeInner::Vector { size, scalar } => {
            Value::lanes(std::iter::repeat_n(zero_scalar(scalar.kind)?, *size as usize))
        }
        TypeInner::Matrix { columns, rows, scalar } => {
            let column = Value::lanes(std::iter::repeat_n(zero_scalar(scalar.kind)?, *rows as usize));
            Value::Many(vec![column; *columns as usize])
        }
        TypeInner::Array { base, size: wgpu::naga::ArraySize::Constant(count), .. } => {
            Value::Many(vec![zero(module, *base)?; count.get() as usize])
        }
        TypeInner::Struct { members, .. } => {
            Value::Many(members.iter().map(|member| zero(module, member.ty)).collect::<Option<_>>()?)
        }
        _ => return None,
    })
}
