//! A word: modules in order, stored flat.

use std::ops::Range;

use crate::language::{POP, PUSH, Rules};

/// The string of modules that a derivation made, ready for [`draw`](crate::draw).
///
/// A doubly linked list in one array: rewriting a module leaves the others where
/// they are, and contexts are found by walking. Node 0 is before the first module
/// and after the last.
#[derive(Clone, Debug)]
pub struct Word {
    pub(super) nodes: Vec<Node>,
    parameters: Vec<f64>,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Node {
    /// Which of the rules' templates it was made from.
    pub(super) template: u32,
    /// The start of its parameters; for brackets the matching one.
    start: u32,
    pub(super) next: u32,
    pub(super) previous: u32,
}

/// A module of a word.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Module<'a> {
    pub(crate) template: u32,
    pub(crate) symbol: u16,
    pub(crate) parameters: &'a [f64],
}

/// The node before the first and after the last.
pub(super) const ENDS: u32 = 0;

impl Word {
    pub(super) fn new() -> Self {
        Self {
            nodes: vec![Node {
                template: u32::MAX,
                start: 0,
                next: ENDS,
                previous: ENDS,
            }],
            parameters: Vec::new(),
        }
    }

    /// Adds a module, after the one added before it, but not yet to the word.
    pub(super) fn push(&mut self, template: u32, parameters: &[f64]) {
        let at = self.nodes.len() as u32;
        self.nodes.push(Node {
            template,
            start: self.parameters.len() as u32,
            next: at + 1,
            previous: at - 1,
        });
        self.parameters.extend_from_slice(parameters);
    }

    /// Modules made so far; many parameters count as modules too.
    pub(super) fn size(&self) -> usize {
        self.nodes.len().max(self.parameters.len() / 4)
    }

    /// Notes for brackets added at `range`, which match, where their other is.
    pub(super) fn match_brackets(&mut self, range: Range<u32>, rules: &Rules, open: &mut Vec<u32>) {
        open.clear();
        for at in range {
            match self.symbol(at, rules) {
                PUSH => open.push(at),
                POP => {
                    let other = open.pop().expect("brackets of a successor match");
                    self.nodes[at as usize].start = other;
                    self.nodes[other as usize].start = at;
                }
                _ => {}
            }
        }
    }

    /// Puts the modules added at `range` in the place of a module.
    pub(super) fn replace(&mut self, at: u32, range: Range<u32>) {
        let Node { previous, next, .. } = self.nodes[at as usize];
        self.link(previous, range, next);
    }

    /// Puts the modules added at `range` between two that are neighbours.
    pub(super) fn link(&mut self, previous: u32, range: Range<u32>, next: u32) {
        if range.is_empty() {
            self.nodes[previous as usize].next = next;
            self.nodes[next as usize].previous = previous;
            return;
        }
        let last = range.end - 1;
        self.nodes[previous as usize].next = range.start;
        self.nodes[range.start as usize].previous = previous;
        self.nodes[last as usize].next = next;
        self.nodes[next as usize].previous = last;
    }

    pub(super) fn symbol(&self, at: u32, rules: &Rules) -> u16 {
        rules.templates[self.nodes[at as usize].template as usize].symbol
    }

    pub(super) fn parameters(&self, at: u32, rules: &Rules) -> &[f64] {
        let count = rules.symbols[usize::from(self.symbol(at, rules))].parameters;
        let start = self.nodes[at as usize].start as usize;
        &self.parameters[start..start + count]
    }

    /// The bracket that matches this one.
    pub(super) fn other_bracket(&self, at: u32) -> u32 {
        self.nodes[at as usize].start
    }

    /// All modules in order.
    pub(crate) fn modules<'a>(&'a self, rules: &'a Rules) -> impl Iterator<Item = Module<'a>> {
        let mut at = ENDS;
        std::iter::from_fn(move || {
            at = self.nodes[at as usize].next;
            (at != ENDS).then(|| {
                let symbol = self.symbol(at, rules);
                let parameters = match symbol {
                    PUSH | POP => &[],
                    _ => self.parameters(at, rules),
                };
                let template = self.nodes[at as usize].template;
                Module {
                    template,
                    symbol,
                    parameters,
                }
            })
        })
    }

    /// The word as text: symbols with their parameters, a blank between them.
    pub fn to_text(&self, rules: &Rules) -> String {
        let texts: Vec<String> = self
            .modules(rules)
            .map(|module| {
                let name = &rules.symbols[usize::from(module.symbol)].name;
                let parameters: Vec<String> =
                    module.parameters.iter().map(f64::to_string).collect();
                match parameters.as_slice() {
                    [] => name.clone(),
                    _ => format!("{name}({})", parameters.join(",")),
                }
            })
            .collect();
        texts.join(" ")
    }

    /// How many modules the derivation made in all, rewritten ones too.
    pub fn modules_made(&self) -> usize {
        self.nodes.len() - 1
    }

    /// How many leaves the turtle will draw.
    pub fn leaf_count(&self, rules: &Rules) -> usize {
        let is_leaf = |module: &Module<'_>| {
            crate::language::command_of(module.symbol).is_some_and(|command| command.is_leaf())
        };
        self.modules(rules).filter(is_leaf).count()
    }
}
