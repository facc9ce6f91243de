//! The symbols of a rule file and their numbers.

use std::collections::HashMap;

use pest::iterators::{Pair, Pairs};

use super::commands::COMMANDS;
use super::error::place_of;
use super::rules::SymbolInfo;
use super::{Rule, RulesError, cut};

/// The most symbols with their numbers of parameters.
const MAX_SYMBOLS: usize = 10_000;

/// A symbol is a name with a number of parameters.
#[derive(Default)]
pub(super) struct Symbols {
    infos: Vec<SymbolInfo>,
    /// For each name the numbers of parameters it is known with, and its number.
    numbers: HashMap<String, Vec<(usize, u16)>>,
}

impl Symbols {
    /// Numbers the turtle's symbols and those that stand before an arrow or in a
    /// declaration, wherever in the file they do.
    pub(super) fn declare(&mut self, statements: Pairs<'_, Rule>) -> Result<(), RulesError> {
        for (name, parameters, _) in COMMANDS {
            self.number(name, parameters);
        }
        for statement in statements {
            if matches!(statement.as_rule(), Rule::production | Rule::declaration) {
                let heads = statement.into_inner();
                for head in heads.filter(|p| p.as_rule() == Rule::head) {
                    let (symbol, names) = head_parts(head);
                    self.number(symbol.as_str(), names.len());
                    if self.infos.len() > MAX_SYMBOLS {
                        let message = format!("more than {MAX_SYMBOLS} symbols");
                        return Err(RulesError::at(place_of(&symbol), message));
                    }
                }
            }
        }
        Ok(())
    }

    fn number(&mut self, name: &str, parameters: usize) -> u16 {
        if let Some(known) = self.find(name, parameters) {
            return known;
        }
        let number = self.infos.len() as u16;
        self.infos.push(SymbolInfo {
            name: name.to_owned(),
            parameters,
        });
        let namesakes = self.numbers.entry(name.to_owned()).or_default();
        namesakes.push((parameters, number));
        number
    }

    fn find(&self, name: &str, parameters: usize) -> Option<u16> {
        let namesakes = self.numbers.get(name)?;
        let found = namesakes.iter().find(|(takes, _)| *takes == parameters);
        found.map(|&(_, number)| number)
    }

    pub(super) fn known(
        &self,
        symbol: &Pair<'_, Rule>,
        parameters: usize,
    ) -> Result<u16, RulesError> {
        let name = symbol.as_str();
        if let Some(number) = self.find(name, parameters) {
            return Ok(number);
        }
        let namesakes = self.numbers.get(name).into_iter().flatten();
        let mut counts: Vec<usize> = namesakes.map(|(takes, _)| *takes).collect();
        counts.sort_unstable();
        let name = cut(name);
        let message = match counts.as_slice() {
            [] => format!(
                "unknown symbol `{name}`: the turtle does not know it and no production is for it \
                 (to let it stand, write `symbol {name};`)"
            ),
            [1] => format!("`{name}` takes 1 parameter, not {parameters}"),
            [count] => format!("`{name}` takes {count} parameters, not {parameters}"),
            [most @ .., last] => {
                let most: Vec<String> = most.iter().map(usize::to_string).collect();
                let most = most.join(", ");
                format!("`{name}` takes {most} or {last} parameters, not {parameters}")
            }
        };
        Err(RulesError::at(place_of(symbol), message))
    }

    /// The number of a symbol of the turtle's that takes no parameters.
    ///
    /// # Panics
    /// If it is none, or before [`declare`](Self::declare).
    pub(super) fn of_turtle(&self, name: &str) -> u16 {
        self.find(name, 0).expect("a symbol of the turtle's")
    }

    /// The numbers of all symbols of a name, whatever parameters they take.
    pub(super) fn called(&self, name: &str) -> impl Iterator<Item = u16> {
        let namesakes = self.numbers.get(name).into_iter().flatten();
        namesakes.map(|&(_, number)| number)
    }

    pub(super) fn len(&self) -> usize {
        self.infos.len()
    }

    pub(super) fn into_infos(self) -> Vec<SymbolInfo> {
        self.infos
    }
}

/// The symbol of a head and the names of its parameters.
pub(super) fn head_parts(head: Pair<'_, Rule>) -> (Pair<'_, Rule>, Vec<Pair<'_, Rule>>) {
    let mut inner = head.into_inner();
    let symbol = inner.next().expect("a head has a symbol");
    (
        symbol,
        inner.filter(|p| p.as_rule() == Rule::name).collect(),
    )
}
