//! Parametric, stochastic L-systems: modules rewritten in parallel.
//!
//! Prusinkiewicz and Lindenmayer: The Algorithmic Beauty of Plants (1990),
//! sections 1.7 (stochastic) and 1.10 (parametric).

use crate::{Module, Random, Symbol};

/// What a production sees of the module that it rewrites.
#[derive(Clone, Copy, Debug)]
pub struct Predecessor<'a> {
    /// Its parameters.
    pub parameters: &'a [f64],
    /// The derivation step, from 0.
    pub iteration: u32,
}

type Condition = Box<dyn Fn(Predecessor<'_>) -> bool + Send + Sync>;
type Successor = Box<dyn Fn(Predecessor<'_>, &mut Random, &mut Vec<Module>) + Send + Sync>;

/// A rule: what becomes of a module with this symbol.
pub struct Production {
    symbol: Symbol,
    weight: f64,
    condition: Condition,
    successor: Successor,
}

impl Production {
    /// A rule of weight 1 without a condition; `successor` appends what takes
    /// the module's place.
    pub fn new(
        symbol: Symbol,
        successor: impl Fn(Predecessor<'_>, &mut Random, &mut Vec<Module>) + Send + Sync + 'static,
    ) -> Self {
        Self {
            symbol,
            weight: 1.0,
            condition: Box::new(|_| true),
            successor: Box::new(successor),
        }
    }

    /// The same rule, for modules that meet this condition only.
    pub fn when(
        mut self,
        condition: impl Fn(Predecessor<'_>) -> bool + Send + Sync + 'static,
    ) -> Self {
        self.condition = Box::new(condition);
        self
    }

    /// The same rule with this weight, a finite number of at least 0. Among the
    /// rules that match a module, each is taken as often as its weight says.
    pub fn with_weight(mut self, weight: f64) -> Self {
        self.weight = weight;
        self
    }
}

/// Why a derivation stopped.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum DeriveError {
    /// The rules made more modules than the limit.
    #[error(
        "the plant needs more than {limit} modules at derivation step {iteration}: \
         ask for fewer leaves or fewer steps"
    )]
    TooManyModules {
        /// The limit.
        limit: usize,
        /// The step, from 0.
        iteration: u32,
    },
    /// A production made a parameter that is NaN or infinite.
    #[error("a production of {symbol} made a parameter that is not a finite number")]
    NotFinite {
        /// The symbol that was rewritten.
        symbol: Symbol,
    },
    /// A weight is negative or not finite, or all that match sum to zero.
    #[error("the weights of the productions of {symbol} do not sum to a positive number")]
    Weights {
        /// The symbol that was to be rewritten.
        symbol: Symbol,
    },
}

/// An axiom and the productions that rewrite it.
pub struct LSystem {
    /// What derivation starts from.
    pub axiom: Vec<Module>,
    /// The rules. A module that none matches stays as it is.
    pub productions: Vec<Production>,
    /// The most modules a derivation may make in all, below 2^32.
    pub max_modules: usize,
}

impl LSystem {
    /// Rewrites all modules `iterations` times, or until no rule matches any.
    ///
    /// Draws from `random` in order of the modules, so equal seeds derive equal
    /// strings. Takes time in proportion to the modules made and to those that
    /// still have rules at each step.
    ///
    /// # Errors
    /// [`DeriveError`], with the symbol or the limit that is at fault.
    pub fn derive(&self, iterations: u32, random: &mut Random) -> Result<Vec<Module>, DeriveError> {
        let mut word = Word::default();
        let axiom = word.append(&self.axiom);
        let mut active: Vec<u32> = axiom.filter(|&n| self.has_rule(&word, n)).collect();
        let mut successor = Vec::new();
        for iteration in 0..iterations {
            let mut next_active = Vec::with_capacity(active.len());
            let mut rewritten = false;
            for &node in &active {
                let module = word.nodes[node as usize].module;
                let predecessor = Predecessor {
                    parameters: module.parameters(),
                    iteration,
                };
                let Some(production) = self.choose(module.symbol(), predecessor, random)? else {
                    next_active.push(node);
                    continue;
                };
                rewritten = true;
                successor.clear();
                (production.successor)(predecessor, random, &mut successor);
                self.check(&module, &successor, word.nodes.len(), iteration)?;
                let made = word.replace(node, &successor);
                next_active.extend(made.filter(|&n| self.has_rule(&word, n)));
            }
            if !rewritten {
                break;
            }
            active = next_active;
        }
        Ok(word.modules())
    }

    fn has_rule(&self, word: &Word, node: u32) -> bool {
        let node = &word.nodes[node as usize];
        let symbol = node.module.symbol();
        !node.erased && self.productions.iter().any(|p| p.symbol == symbol)
    }

    fn check(
        &self,
        module: &Module,
        successor: &[Module],
        made: usize,
        iteration: u32,
    ) -> Result<(), DeriveError> {
        if made + successor.len() > self.max_modules {
            return Err(DeriveError::TooManyModules {
                limit: self.max_modules,
                iteration,
            });
        }
        let finite = |m: &Module| m.parameters().iter().all(|p| p.is_finite());
        if !successor.iter().all(finite) {
            let symbol = module.symbol();
            return Err(DeriveError::NotFinite { symbol });
        }
        Ok(())
    }

    /// The rule for this module. Draws a number only where there is a choice.
    fn choose(
        &self,
        symbol: Symbol,
        predecessor: Predecessor<'_>,
        random: &mut Random,
    ) -> Result<Option<&Production>, DeriveError> {
        let matching = || {
            self.productions
                .iter()
                .filter(move |p| p.symbol == symbol && (p.condition)(predecessor))
        };
        let (mut total, mut count) = (0.0, 0);
        for production in matching() {
            if !(0.0..f64::INFINITY).contains(&production.weight) {
                return Err(DeriveError::Weights { symbol });
            }
            total += production.weight;
            count += 1;
        }
        if count == 0 {
            return Ok(None);
        }
        if !(total > 0.0 && total.is_finite()) {
            return Err(DeriveError::Weights { symbol });
        }
        if count == 1 {
            return Ok(matching().next());
        }
        let mut left = total * random.unit();
        for production in matching() {
            left -= production.weight;
            if left < 0.0 {
                return Ok(Some(production));
            }
        }
        // Rounding left a remainder: it belongs to the last rule with a weight.
        Ok(matching().rfind(|p| p.weight > 0.0))
    }
}

/// A string of modules as a linked list, so that rewriting one leaves the others
/// where they are.
#[derive(Default)]
struct Word {
    nodes: Vec<Node>,
}

struct Node {
    module: Module,
    next: u32,
    /// Rewritten to nothing.
    erased: bool,
}

impl Word {
    const END: u32 = u32::MAX;

    /// Adds linked nodes that end the word, and returns their places.
    fn append(&mut self, modules: &[Module]) -> std::ops::Range<u32> {
        let start = self.nodes.len() as u32;
        let end = start + modules.len() as u32;
        self.nodes
            .extend(modules.iter().zip(start + 1..).map(|(&module, next)| Node {
                module,
                next,
                erased: false,
            }));
        if end > start {
            self.nodes[end as usize - 1].next = Self::END;
        }
        start..end
    }

    /// Puts modules in the place of a node, and returns theirs, in order.
    fn replace(&mut self, node: u32, modules: &[Module]) -> impl Iterator<Item = u32> + use<> {
        let at = node as usize;
        let Some((&first, rest)) = modules.split_first() else {
            self.nodes[at].erased = true;
            return std::iter::once(node).chain(0..0);
        };
        self.nodes[at].module = first;
        let after = self.nodes[at].next;
        let made = self.append(rest);
        if !made.is_empty() {
            self.nodes[at].next = made.start;
            self.nodes[made.end as usize - 1].next = after;
        }
        std::iter::once(node).chain(made)
    }

    fn modules(&self) -> Vec<Module> {
        let mut modules = Vec::with_capacity(self.nodes.len());
        let mut at = if self.nodes.is_empty() { Self::END } else { 0 };
        while at != Self::END {
            let node = &self.nodes[at as usize];
            if !node.erased {
                modules.push(node.module);
            }
            at = node.next;
        }
        modules
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const A: Symbol = Symbol::new('A');
    const B: Symbol = Symbol::new('B');

    fn letters(modules: &[Module]) -> String {
        modules.iter().map(|m| m.symbol().to_string()).collect()
    }

    fn system(productions: Vec<Production>) -> LSystem {
        LSystem {
            axiom: vec![Module::new(A, &[1.0])],
            productions,
            max_modules: 1000,
        }
    }

    fn push(symbol: Symbol, value: f64) -> impl Fn(&mut Vec<Module>) {
        move |out| out.push(Module::new(symbol, &[value]))
    }

    #[test]
    fn all_modules_are_rewritten_at_once() {
        // Lindenmayer's algae: A -> AB, B -> A has the lengths of Fibonacci.
        let algae = system(vec![
            Production::new(A, |_, _, out| {
                push(A, 0.0)(out);
                push(B, 0.0)(out);
            }),
            Production::new(B, |_, _, out| push(A, 0.0)(out)),
        ]);
        let word = |n| letters(&algae.derive(n, &mut Random::new(0)).unwrap());
        assert_eq!(word(0), "A");
        assert_eq!(word(3), "ABAAB");
        assert_eq!(word(4), "ABAABABA");
    }

    #[test]
    fn conditions_see_parameters_and_derivation_ends_by_itself() {
        // A(x) doubles while below 10: 1, 2, 4, 8, 16, then no rule matches.
        let doubling = system(vec![
            Production::new(A, |p, _, out| push(A, 2.0 * p.parameters[0])(out))
                .when(|p| p.parameters[0] < 10.0),
        ]);
        let end = doubling.derive(u32::MAX, &mut Random::new(0)).unwrap();
        assert_eq!(end[0].parameters(), [16.0]);
    }

    #[test]
    fn weights_say_how_often_a_rule_is_taken() {
        let mut chance = system(vec![
            Production::new(A, |_, _, out| push(B, 1.0)(out)).with_weight(3.0),
            Production::new(A, |_, _, out| push(B, 2.0)(out)).with_weight(1.0),
            Production::new(A, |_, _, out| push(B, 3.0)(out)).with_weight(0.0),
        ]);
        chance.axiom = vec![Module::new(A, &[]); 1000];
        chance.max_modules = 10_000;
        let end = chance.derive(1, &mut Random::new(9)).unwrap();
        let count = |value| end.iter().filter(|m| m.parameters()[0] == value).count();
        // Of 1000 draws at 3/4, four deviations are 55.
        assert!(count(1.0).abs_diff(750) < 55, "{}", count(1.0));
        assert_eq!(count(1.0) + count(2.0), 1000);
    }

    #[test]
    fn growth_without_end_meets_the_limit() {
        let endless = system(vec![Production::new(A, |_, _, out| {
            push(A, 0.0)(out);
            push(A, 0.0)(out);
        })]);
        let error = endless.derive(u32::MAX, &mut Random::new(0)).unwrap_err();
        // 512 modules fit 1000, 1024 do not: step 9 is the tenth doubling.
        let expected = DeriveError::TooManyModules {
            limit: 1000,
            iteration: 9,
        };
        assert_eq!(error, expected);
    }

    #[test]
    fn a_module_can_vanish_between_its_neighbours() {
        // A(1) -> B(1) A(2) B(3), then A(2) -> nothing.
        let vanishing = system(vec![
            Production::new(A, |_, _, out| {
                push(B, 1.0)(out);
                push(A, 2.0)(out);
                push(B, 3.0)(out);
            })
            .when(|p| p.iteration == 0),
            Production::new(A, |_, _, _| {}).when(|p| p.iteration > 0),
        ]);
        let end = vanishing.derive(5, &mut Random::new(0)).unwrap();
        assert_eq!(end, [Module::new(B, &[1.0]), Module::new(B, &[3.0])]);
    }

    #[test]
    fn nonsense_is_refused() {
        let nan = system(vec![Production::new(A, |_, _, out| push(B, f64::NAN)(out))]);
        let error = nan.derive(1, &mut Random::new(0)).unwrap_err();
        assert_eq!(error, DeriveError::NotFinite { symbol: A });
        for weight in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let rule = Production::new(A, |_, _, out| push(B, 0.0)(out)).with_weight(weight);
            let error = system(vec![rule]).derive(1, &mut Random::new(0));
            assert_eq!(error.unwrap_err(), DeriveError::Weights { symbol: A });
        }
    }
}
