//! Expressions, compiled to a list of operations on a stack of numbers.

use crate::Random;

use super::{RulePosition, RulesError};

/// The frame of an expression starts with these two.
pub(super) const DETAIL: u16 = 0;
pub(super) const ITERATION: u16 = 1;

/// What an operation does with the top of the stack.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Op {
    Constant(f64),
    /// A variable's place in the frame.
    Slot(u16),
    Negate,
    Not,
    Add,
    Subtract,
    Multiply,
    Divide,
    Power,
    Less,
    LessOrEqual,
    Greater,
    GreaterOrEqual,
    Equal,
    NotEqual,
    And,
    Or,
    Call(Function),
}

/// The functions that expressions can call.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Function {
    Abs,
    Sqrt,
    Exp,
    Log,
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
    Floor,
    Ceil,
    Round,
    Min,
    Max,
    Pow,
    Mod,
    Atan2,
    Clamp,
    Select,
    Uniform,
    Normal,
}

impl Function {
    /// Names and numbers of arguments.
    pub(super) const ALL: [(&'static str, usize, Self); 22] = [
        ("abs", 1, Self::Abs),
        ("sqrt", 1, Self::Sqrt),
        ("exp", 1, Self::Exp),
        ("log", 1, Self::Log),
        ("sin", 1, Self::Sin),
        ("cos", 1, Self::Cos),
        ("tan", 1, Self::Tan),
        ("asin", 1, Self::Asin),
        ("acos", 1, Self::Acos),
        ("atan", 1, Self::Atan),
        ("floor", 1, Self::Floor),
        ("ceil", 1, Self::Ceil),
        ("round", 1, Self::Round),
        ("min", 2, Self::Min),
        ("max", 2, Self::Max),
        ("pow", 2, Self::Pow),
        ("mod", 2, Self::Mod),
        ("atan2", 2, Self::Atan2),
        ("clamp", 3, Self::Clamp),
        ("select", 3, Self::Select),
        ("uniform", 2, Self::Uniform),
        ("normal", 2, Self::Normal),
    ];

    pub(super) fn arguments(self) -> usize {
        let known = Self::ALL.iter().find(|(_, _, function)| *function == self);
        known.map_or(0, |(_, arguments, _)| *arguments)
    }

    pub(super) fn is_random(self) -> bool {
        matches!(self, Self::Uniform | Self::Normal)
    }

    fn call(self, x: &[f64], random: &mut Random) -> Result<f64, &'static str> {
        let degrees = f64::to_degrees;
        let radians = f64::to_radians;
        Ok(match self {
            Self::Abs => x[0].abs(),
            Self::Sqrt => libm::sqrt(x[0]),
            Self::Exp => libm::exp(x[0]),
            Self::Log => libm::log(x[0]),
            Self::Sin => libm::sin(radians(x[0])),
            Self::Cos => libm::cos(radians(x[0])),
            Self::Tan => libm::tan(radians(x[0])),
            Self::Asin => degrees(libm::asin(x[0])),
            Self::Acos => degrees(libm::acos(x[0])),
            Self::Atan => degrees(libm::atan(x[0])),
            Self::Floor => libm::floor(x[0]),
            Self::Ceil => libm::ceil(x[0]),
            Self::Round => libm::round(x[0]),
            Self::Min => lesser(x[0], x[1]),
            Self::Max => -lesser(-x[0], -x[1]),
            Self::Pow => libm::pow(x[0], x[1]),
            Self::Mod if x[1] == 0.0 => return Err("division by zero"),
            Self::Mod => x[0] - x[1] * libm::floor(x[0] / x[1]),
            Self::Atan2 => degrees(libm::atan2(x[0], x[1])),
            Self::Clamp if x[1] > x[2] => {
                return Err("clamp has a lower bound above its upper one");
            }
            Self::Clamp => lesser(-lesser(-x[0], -x[1]), x[2]),
            Self::Select => x[if x[0] == 0.0 { 2 } else { 1 }],
            Self::Uniform => random.between(x[0], x[1]),
            Self::Normal if x[1] < 0.0 => return Err("normal has a negative deviation"),
            Self::Normal => random.normal(x[0], x[1]),
        })
    }
}

/// The smaller one; of zeros of either sign the first, on every platform.
fn lesser(a: f64, b: f64) -> f64 {
    if b < a { b } else { a }
}

/// An expression, as a range of a [`Program`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Code {
    pub(super) start: u32,
    pub(super) end: u32,
}

/// The operations of all expressions of a file, and where each is written.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Program {
    pub(super) ops: Vec<Op>,
    pub(super) places: Vec<RulePosition>,
}

impl Program {
    pub(super) fn push(&mut self, op: Op, place: RulePosition) {
        self.ops.push(op);
        self.places.push(place);
    }

    /// Whether an expression holds this operation.
    pub(super) fn contains(&self, code: Code, wanted: impl Fn(Op) -> bool) -> Option<RulePosition> {
        let range = code.start as usize..code.end as usize;
        let at = range.clone().find(|&at| wanted(self.ops[at]))?;
        Some(self.places[at])
    }

    /// The value of an expression. Comparisons are 1 where they hold, else 0;
    /// whatever is not 0 counts as true.
    ///
    /// `stack` is only lent, so that it is not allocated anew.
    pub(crate) fn value(
        &self,
        code: Code,
        frame: &[f64],
        stack: &mut Vec<f64>,
        random: &mut Random,
    ) -> Result<f64, RulesError> {
        stack.clear();
        for at in code.start as usize..code.end as usize {
            let result = match self.ops[at] {
                Op::Constant(value) => Ok(value),
                Op::Slot(slot) => Ok(frame[usize::from(slot)]),
                op => apply(op, stack, random),
            };
            match result {
                Ok(value) if value.is_finite() => stack.push(value),
                Ok(_) => return Err(self.fault(at, "the result is not a finite number")),
                Err(message) => return Err(self.fault(at, message)),
            }
        }
        Ok(stack.pop().expect("an expression leaves a value"))
    }

    fn fault(&self, at: usize, message: &str) -> RulesError {
        RulesError::at(self.places[at], message)
    }
}

fn apply(op: Op, stack: &mut Vec<f64>, random: &mut Random) -> Result<f64, &'static str> {
    let mut pop = || stack.pop().expect("compiled code balances its stack");
    let truth = |holds: bool| Ok(f64::from(u8::from(holds)));
    match op {
        Op::Negate => return Ok(-pop()),
        Op::Not => return truth(pop() == 0.0),
        Op::Call(function) => {
            let start = stack.len() - function.arguments();
            let value = function.call(&stack[start..], random);
            stack.truncate(start);
            return value;
        }
        _ => {}
    }
    let (b, a) = (pop(), pop());
    match op {
        Op::Add => Ok(a + b),
        Op::Subtract => Ok(a - b),
        Op::Multiply => Ok(a * b),
        Op::Divide if b == 0.0 => Err("division by zero"),
        Op::Divide => Ok(a / b),
        Op::Power => Ok(libm::pow(a, b)),
        Op::Less => truth(a < b),
        Op::LessOrEqual => truth(a <= b),
        Op::Greater => truth(a > b),
        Op::GreaterOrEqual => truth(a >= b),
        Op::Equal => truth(a == b),
        Op::NotEqual => truth(a != b),
        Op::And => truth(a != 0.0 && b != 0.0),
        _ => truth(a != 0.0 || b != 0.0),
    }
}
