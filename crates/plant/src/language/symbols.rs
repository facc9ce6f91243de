//! The symbols of a rule file and their numbers.

use std::collections::HashMap;

use pest::iterators::{Pair, Pairs};

use super::commands::COMMANDS;
use super::compile::place_of;
use super::rules::SymbolInfo;
use super::{Rule, RulesError};

/// The most symbols with their numbers of parameters.
const MAX_SYMBOLS: usize = 10_000;

/// A symbol is a name with a number of parameters.
#[derive(Default)]
pub(super) struct Symbols {
    infos: Vec<SymbolInfo>,
    numbers: HashMap<(String, usize), u16>,
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
                    let place = place_of(&head);
                    let (symbol, names) = head_parts(head);
                    self.number(symbol.as_str(), names.len());
                    if self.infos.len() > MAX_SYMBOLS {
                        let message = format!("more than {MAX_SYMBOLS} symbols");
                        return Err(RulesError::at(place, message));
                    }
                }
            }
        }
        Ok(())
    }

    fn number(&mut self, name: &str, parameters: usize) -> u16 {
        let key = (name.to_owned(), parameters);
        if let Some(&known) = self.numbers.get(&key) {
            return known;
        }
        let number = self.infos.len() as u16;
        self.infos.push(SymbolInfo {
            name: key.0.clone(),
            parameters,
        });
        self.numbers.insert(key, number);
        number
    }

    pub(super) fn known(
        &self,
        symbol: &Pair<'_, Rule>,
        parameters: usize,
    ) -> Result<u16, RulesError> {
        let name = symbol.as_str();
        if let Some(&number) = self.numbers.get(&(name.to_owned(), parameters)) {
            return Ok(number);
        }
        let namesakes = self.infos.iter().filter(|info| info.name == name);
        let mut counts: Vec<usize> = namesakes.map(|info| info.parameters).collect();
        counts.sort_unstable();
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
        self.numbers[&(name.to_owned(), 0)]
    }

    /// The numbers of all symbols of a name, whatever parameters they take.
    pub(super) fn called(&self, name: &str) -> Vec<u16> {
        let named = self.infos.iter().zip(0u16..);
        let same = named.filter(|(info, _)| info.name == name);
        same.map(|(_, number)| number).collect()
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
