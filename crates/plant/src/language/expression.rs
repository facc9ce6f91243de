//! Expressions of the parse tree, compiled to operations.

use std::collections::HashMap;

use pest::iterators::Pair;

use super::code::{Code, DETAIL, Function, ITERATION, Op, Program};
use super::error::place_of;
use super::places::Places;
use super::{Rule, RulePosition, RulesError, cut};

/// The most names that are known at once.
const MAX_NAMES: usize = 10_000;

/// The names that an expression can use, and their slots in its frame.
#[derive(Clone, Debug, Default)]
pub(super) struct Names {
    slots: HashMap<String, u16>,
    next: u16,
    /// The names that the production at hand has defined.
    local: Vec<String>,
    /// The first slot of these, in a production.
    first_local: Option<u16>,
}

impl Names {
    pub(super) fn of_file() -> Self {
        Self {
            slots: HashMap::from([("detail".to_owned(), DETAIL)]),
            next: ITERATION + 1,
            local: Vec::new(),
            first_local: None,
        }
    }

    pub(super) fn enter_production(&mut self) {
        self.first_local = Some(self.next);
        self.slots.insert("iteration".to_owned(), ITERATION);
    }

    /// Forgets what the production has defined.
    pub(super) fn leave_production(&mut self) {
        for name in self.local.drain(..) {
            self.slots.remove(&name);
        }
        self.slots.remove("iteration");
        self.next = self.first_local.take().unwrap_or(self.next);
    }

    /// Gives a name the next slot.
    pub(super) fn define(&mut self, name: &Pair<'_, Rule>) -> Result<(), RulesError> {
        let text = name.as_str();
        let refuse = |message: String| Err(RulesError::at(place_of(name), message));
        if Function::ALL.iter().any(|(function, ..)| *function == text) {
            return refuse(format!("`{text}` is the name of a function"));
        }
        if text == "iteration" || self.slots.contains_key(text) {
            return refuse(format!("the name `{}` is taken", cut(text)));
        }
        if usize::from(self.next) >= MAX_NAMES {
            return refuse(format!("more than {MAX_NAMES} names"));
        }
        self.slots.insert(text.to_owned(), self.next);
        if self.first_local.is_some() {
            self.local.push(text.to_owned());
        }
        self.next += 1;
        Ok(())
    }

    fn slot(&self, name: &Pair<'_, Rule>) -> Result<u16, RulesError> {
        let text = name.as_str();
        self.slots.get(text).copied().ok_or_else(|| {
            let hint = match text {
                "iteration" => ": only productions have an iteration".to_owned(),
                _ if Function::ALL.iter().any(|(function, ..)| *function == text) => {
                    format!(": the function takes its arguments in parentheses, `{text}(...)`")
                }
                _ => String::new(),
            };
            RulesError::at(
                place_of(name),
                format!("unknown name `{}`{hint}", cut(text)),
            )
        })
    }
}

pub(super) struct Expressions<'a> {
    pub(super) program: &'a mut Program,
    pub(super) names: &'a Names,
    pub(super) places: &'a Places<'a>,
}

impl Expressions<'_> {
    pub(super) fn compile(&mut self, pair: Pair<'_, Rule>) -> Result<Code, RulesError> {
        let start = self.program.ops.len() as u32;
        self.push(pair)?;
        let end = self.program.ops.len() as u32;
        Ok(Code { start, end })
    }

    fn place(&self, pair: &Pair<'_, Rule>) -> RulePosition {
        self.places.at(pair.as_span().start())
    }

    fn push(&mut self, pair: Pair<'_, Rule>) -> Result<(), RulesError> {
        match pair.as_rule() {
            Rule::number => self.push_number(&pair),
            Rule::call => self.push_call(pair),
            Rule::variable => {
                let slot = self.names.slot(&pair)?;
                let place = self.place(&pair);
                self.program.push(Op::Slot(slot), place);
                Ok(())
            }
            _ => self.push_operation(pair),
        }
    }

    /// Operands with operators between them, or a sign or `not` before them:
    /// an operator is applied as soon as the operand after it is there.
    fn push_operation(&mut self, pair: Pair<'_, Rule>) -> Result<(), RulesError> {
        let mut waiting = Vec::new();
        let mut operands = 0;
        for part in pair.into_inner() {
            let place = self.place(&part);
            let op = match (part.as_rule(), part.as_str()) {
                (Rule::open | Rule::close, _) => continue,
                (Rule::minus, _) => Op::Negate,
                (Rule::not_word, _) => Op::Not,
                (Rule::or_word, _) => Op::Or,
                (Rule::and_word, _) => Op::And,
                (Rule::comparing, "<") => Op::Less,
                (Rule::comparing, "<=") => Op::LessOrEqual,
                (Rule::comparing, ">") => Op::Greater,
                (Rule::comparing, ">=") => Op::GreaterOrEqual,
                (Rule::comparing, "==") => Op::Equal,
                (Rule::comparing, _) => Op::NotEqual,
                (Rule::adding, "+") => Op::Add,
                (Rule::adding, _) => Op::Subtract,
                (Rule::multiplying, "*") => Op::Multiply,
                (Rule::multiplying, _) => Op::Divide,
                (Rule::raising, _) => Op::Power,
                _ => {
                    self.push(part)?;
                    operands += 1;
                    while let Some((op, place)) = waiting.pop() {
                        self.program.push(op, place);
                    }
                    continue;
                }
            };
            waiting.push((op, place));
        }
        debug_assert!(operands > 0 && waiting.is_empty());
        Ok(())
    }

    fn push_number(&mut self, pair: &Pair<'_, Rule>) -> Result<(), RulesError> {
        let place = self.place(pair);
        let value: f64 = pair.as_str().parse().unwrap_or(f64::INFINITY);
        if !value.is_finite() {
            return Err(RulesError::at(place, "the number is too large"));
        }
        self.program.push(Op::Constant(value), place);
        Ok(())
    }

    fn push_call(&mut self, pair: Pair<'_, Rule>) -> Result<(), RulesError> {
        let place = self.place(&pair);
        let mut inner = pair.into_inner();
        let name = inner.next().expect("a call has a name").as_str();
        let known = Function::ALL.iter().find(|(known, ..)| *known == name);
        let Some(&(_, takes, function)) = known else {
            let names: Vec<&str> = Function::ALL.iter().map(|(name, ..)| *name).collect();
            let names = names.join(", ");
            let name = cut(name);
            let message = format!("unknown function `{name}`: there are {names}");
            return Err(RulesError::at(place, message));
        };
        let mut given = 0;
        for argument in inner.filter(|p| p.as_rule() == Rule::expression) {
            self.push(argument)?;
            given += 1;
        }
        if given != takes {
            let arguments = if takes == 1 { "argument" } else { "arguments" };
            let message = format!("`{name}` takes {takes} {arguments}, not {given}");
            return Err(RulesError::at(place, message));
        }
        self.program.push(Op::Call(function), place);
        Ok(())
    }
}
