//! Counts the operations of a kernel in naga's representation, after overrides are substituted and the branches that
//! they decide are removed, as every driver's compiler does.

use naga::back::pipeline_constants::process_overrides;
use naga::valid::{Capabilities, FunctionInfo, ModuleInfo, ValidationFlags, Validator};
use naga::{Arena, BinaryOperator, Block, Expression, Function, Handle, Literal, MathFunction, Statement};
use naga::{Module, ScalarKind, TypeInner};
use std::collections::HashMap;
use std::ops::AddAssign;
use weekender::kernel::Features;
use weekender::render_gpu::shader_source::{EntryPoint, source};

/// A specialised kernel.
pub struct Counted {
    module: Module,
    info: ModuleInfo,
}

/// The cost of code: operations on single numbers, except moves, accesses, sign changes and memory reads.
#[derive(Clone, Copy, Debug, Default)]
pub struct Cost {
    /// Operations on floats; a fused multiply and add counts as one.
    pub float: usize,
    /// Operations on integers and booleans.
    pub integer: usize,
    /// Square roots and divisions.
    pub special: usize,
}

impl Cost {
    pub fn total(self) -> usize {
        self.float + self.integer + self.special
    }

    fn times(self, count: usize) -> Cost {
        Cost { float: self.float * count, integer: self.integer * count, special: self.special * count }
    }
}

impl AddAssign for Cost {
    fn add_assign(&mut self, other: Cost) {
        self.float += other.float;
        self.integer += other.integer;
        self.special += other.special;
    }
}

impl Counted {
    pub fn of(features: &Features) -> anyhow::Result<Self> {
        let text = source(EntryPoint::PathTrace);
        let module = naga::front::wgsl::parse_str(&text)?;
        let info = Validator::new(ValidationFlags::all(), Capabilities::default()).validate(&module)?;
        let constants = features.overrides().into_iter().collect();
        let entry = Some((naga::ShaderStage::Compute, EntryPoint::PathTrace.name()));
        let (module, info) = process_overrides(&module, &info, entry, &constants)?;
        let mut module = module.into_owned();
        let known = Known { constants: module.constants.clone(), globals: module.global_expressions.clone() };
        let entries = module.entry_points.iter_mut().map(|entry| &mut entry.function);
        for function in module.functions.iter_mut().map(|(_, function)| function).chain(entries) {
            // Each pass can find values that let the next one find more.
            for _ in 0..3 {
                let mut body = std::mem::take(&mut function.body);
                let mut stores = HashMap::new();
                known.stores(&body, function, &mut stores);
                known.cut(&mut body, function, &stores);
                function.body = body;
            }
        }
        Ok(Counted { module, info: info.into_owned() })
    }

    /// Operations of the entry point, counting each function at every call.
    pub fn size(&self) -> usize {
        self.module.entry_points.iter().map(|entry| self.operations(&entry.function.body)).sum()
    }

    fn operations(&self, block: &Block) -> usize {
        let of = |statement: &Statement| match statement {
            Statement::Emit(range) => range.clone().count(),
            Statement::Call { function, .. } => self.operations(&self.module.functions[*function].body),
            Statement::If { accept, reject, .. } => 1 + self.operations(accept) + self.operations(reject),
            Statement::Loop { body, continuing, .. } => {
                1 + self.operations(body) + self.operations(continuing)
            }
            Statement::Block(inner) => self.operations(inner),
            _ => 1,
        };
        block.iter().map(of).sum()
    }

    /// Operations of one iteration of the path loop, with both sides of every branch. `trips` are the iterations of the
    /// loops over spheres.
    pub fn turn(&self, trips: &[usize]) -> Cost {
        let mut trips = trips.iter().copied();
        let mut cost = Cost::default();
        for (handle, function) in self.module.functions.iter() {
            if function.name.as_deref() == Some("trace")
                && let Some(body) = function.body.iter().find_map(|statement| match statement {
                    Statement::Loop { body, .. } => Some(body),
                    _ => None,
                })
            {
                cost += self.cost(body, function, &self.info[handle], &mut trips);
            }
        }
        cost
    }

    fn cost(
        &self,
        block: &Block,
        function: &Function,
        info: &FunctionInfo,
        trips: &mut dyn Iterator<Item = usize>,
    ) -> Cost {
        let mut cost = Cost::default();
        for statement in block.iter() {
            match statement {
                Statement::Emit(range) => {
                    for expression in range.clone() {
                        cost += self.expression(expression, function, info);
                    }
                }
                Statement::Call { function: called, .. } => {
                    let callee = &self.module.functions[*called];
                    cost += self.cost(&callee.body, callee, &self.info[*called], trips);
                }
                Statement::If { accept, reject, .. } => {
                    cost += self.cost(accept, function, info, trips);
                    cost += self.cost(reject, function, info, trips);
                }
                // An unrolled loop over spheres has no counter.
                Statement::Loop { body, .. } => {
                    let count = trips.next().unwrap_or(1);
                    cost += self.cost(body, function, info, trips).times(count);
                }
                Statement::Block(inner) => cost += self.cost(inner, function, info, trips),
                _ => {}
            }
        }
        cost
    }

    fn expression(&self, handle: Handle<Expression>, function: &Function, info: &FunctionInfo) -> Cost {
        let shape = |handle: Handle<Expression>| match *info[handle].ty.inner_with(&self.module.types) {
            TypeInner::Scalar(scalar) => (1, scalar.kind),
            TypeInner::Vector { size, scalar } => (size as usize, scalar.kind),
            _ => (0, ScalarKind::Sint),
        };
        let (mut count, kind) = shape(handle);
        // The type of the operands decides which unit compares.
        let mut kind_of_operands = kind;
        let mut is_special = false;
        match &function.expressions[handle] {
            Expression::Binary { op, left, .. } => {
                kind_of_operands = shape(*left).1;
                is_special = *op == BinaryOperator::Divide && kind == ScalarKind::Float;
            }
            Expression::Math { fun, .. } => match fun {
                MathFunction::Sqrt | MathFunction::InverseSqrt => is_special = true,
                MathFunction::Abs => count = 0,
                MathFunction::Clamp => count *= 2,
                _ => {}
            },
            Expression::Select { .. } => {}
            Expression::As { convert: Some(_), .. } => kind_of_operands = ScalarKind::Uint,
            _ => count = 0,
        }
        match kind_of_operands {
            _ if is_special => Cost { special: count, ..Cost::default() },
            ScalarKind::Float => Cost { float: count, ..Cost::default() },
            _ => Cost { integer: count, ..Cost::default() },
        }
    }
}

/// Values that are known once overrides are substituted.
struct Known {
    constants: Arena<naga::Constant>,
    globals: Arena<Expression>,
}

/// The values that are stored in a variable.
type Stores = HashMap<Handle<naga::LocalVariable>, Vec<Handle<Expression>>>;

impl Known {
    fn literal(&self, function: &Function, expression: Handle<Expression>) -> Option<Literal> {
        match function.expressions[expression] {
            Expression::Literal(literal) => Some(literal),
            Expression::Constant(constant) => match self.globals[self.constants[constant].init] {
                Expression::Literal(literal) => Some(literal),
                _ => None,
            },
            _ => None,
        }
    }

    fn truth(&self, function: &Function, stores: &Stores, condition: Handle<Expression>) -> Option<bool> {
        match function.expressions[condition] {
            Expression::Unary { op: naga::UnaryOperator::LogicalNot, expr } => {
                self.truth(function, stores, expr).map(|truth| !truth)
            }
            Expression::Binary { op, left, right } => {
                let equal = self.literal(function, left)? == self.literal(function, right)?;
                match op {
                    naga::BinaryOperator::Equal => Some(equal),
                    naga::BinaryOperator::NotEqual => Some(!equal),
                    _ => None,
                }
            }
            Expression::Load { pointer } => match function.expressions[pointer] {
                Expression::LocalVariable(variable) => match stores.get(&variable)?.as_slice() {
                    [only] => self.truth(function, stores, *only),
                    _ => None,
                },
                _ => None,
            },
            _ => match self.literal(function, condition)? {
                Literal::Bool(truth) => Some(truth),
                _ => None,
            },
        }
    }

    fn stores(&self, block: &Block, function: &Function, stores: &mut Stores) {
        for statement in block.iter() {
            match statement {
                Statement::Store { pointer, value } => {
                    if let Expression::LocalVariable(variable) = function.expressions[*pointer] {
                        stores.entry(variable).or_default().push(*value);
                    }
                }
                Statement::If { accept, reject, .. } => {
                    self.stores(accept, function, stores);
                    self.stores(reject, function, stores);
                }
                Statement::Loop { body, continuing, .. } => {
                    self.stores(body, function, stores);
                    self.stores(continuing, function, stores);
                }
                Statement::Block(inner) => self.stores(inner, function, stores),
                _ => {}
            }
        }
    }

    /// Replaces each branch whose condition is known by the side that is taken, as every driver's compiler does.
    fn cut(&self, block: &mut Block, function: &Function, stores: &Stores) {
        let mut kept = Block::new();
        for (statement, span) in std::mem::take(block).span_into_iter() {
            match statement {
                Statement::If { condition, mut accept, mut reject } => {
                    self.cut(&mut accept, function, stores);
                    self.cut(&mut reject, function, stores);
                    match self.truth(function, stores, condition) {
                        Some(true) => kept.extend_block(accept),
                        Some(false) => kept.extend_block(reject),
                        None => kept.push(Statement::If { condition, accept, reject }, span),
                    }
                }
                Statement::Loop { mut body, mut continuing, break_if } => {
                    self.cut(&mut body, function, stores);
                    self.cut(&mut continuing, function, stores);
                    kept.push(Statement::Loop { body, continuing, break_if }, span);
                }
                Statement::Block(mut inner) => {
                    self.cut(&mut inner, function, stores);
                    kept.push(Statement::Block(inner), span);
                }
                other => kept.push(other, span),
            }
        }
        *block = kept;
    }
}
