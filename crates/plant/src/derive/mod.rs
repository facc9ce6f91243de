//! Derivation: all modules of a word rewritten at once, step after step.
//!
//! Prusinkiewicz and Lindenmayer: The Algorithmic Beauty of Plants (1990),
//! sections 1.7 (stochastic), 1.8 (context-sensitive) and 1.10 (parametric).

mod context;
mod word;

use std::ops::Range;

use crate::Random;
use crate::language::{Code, Production, RulePosition, Rules, RulesError, Template, cut};

use context::Contexts;
use word::ENDS;
pub(crate) use word::Module;
pub use word::Word;

/// The most modules that a derivation may look at in all, which bounds its time
/// where rules wait for what never comes.
const MAX_LOOKS: u64 = 1 << 29;

impl Rules {
    /// Derives the axiom: for as many iterations as the file says, or until no
    /// production matches. `detail` is what the rules see by that name.
    ///
    /// Draws lots in the order of the modules, so equal numbers and equal states of
    /// `random` derive equal words. Takes time in proportion to the modules made
    /// and, at each step, to those that may still be rewritten.
    ///
    /// # Errors
    /// [`RulesError`], at the place of what went wrong: a division by zero, a
    /// result that is no finite number, a negative deviation or weight, weights
    /// that sum to zero, more modules or iterations than the limit.
    pub fn derive(&self, detail: f64, random: &mut Random) -> Result<Word, RulesError> {
        let mut derivation = Derivation::new(self, detail, random)?;
        derivation.start()?;
        let steps = derivation.steps()?;
        for iteration in 0..steps.unwrap_or(Self::MAX_ITERATIONS) {
            let has_rewritten = derivation.step(iteration)?;
            // What asks for the iteration may match in a later one, of which there
            // are as many as the file says.
            if !has_rewritten && (steps.is_none() || !self.asks_iteration) {
                return Ok(derivation.word);
            }
        }
        match (steps, derivation.last) {
            (None, Some(place)) => {
                let message = format!(
                    "the rules do not end: this production still matches after {} iterations",
                    Self::MAX_ITERATIONS
                );
                Err(RulesError::at(place, message))
            }
            _ => Ok(derivation.word),
        }
    }
}

struct Derivation<'a> {
    rules: &'a Rules,
    random: &'a mut Random,
    word: Word,
    /// Modules that may be rewritten.
    active: Vec<u32>,
    /// Detail, iteration, constants; then what a production names.
    frame: Vec<f64>,
    globals: usize,
    contexts: Contexts,
    stack: Vec<f64>,
    parameters: Vec<f64>,
    open: Vec<u32>,
    candidates: Vec<(u32, f64)>,
    looks: u64,
    /// The production that was taken last.
    last: Option<RulePosition>,
}

impl<'a> Derivation<'a> {
    fn new(rules: &'a Rules, detail: f64, random: &'a mut Random) -> Result<Self, RulesError> {
        let mut stack = Vec::new();
        let mut frame = vec![detail, 0.0];
        for &constant in &rules.constants {
            let value = rules.program.value(constant, &frame, &mut stack, random)?;
            frame.push(value);
        }
        Ok(Self {
            rules,
            random,
            word: Word::new(),
            active: Vec::new(),
            globals: frame.len(),
            frame,
            contexts: Contexts::default(),
            stack,
            parameters: Vec::new(),
            open: Vec::new(),
            candidates: Vec::new(),
            looks: 0,
            last: None,
        })
    }

    fn steps(&mut self) -> Result<Option<u32>, RulesError> {
        let Some((code, place)) = self.rules.iterations else {
            return Ok(None);
        };
        let value = self.value(code)?;
        if value < 0.0 || value > f64::from(Rules::MAX_ITERATIONS) {
            let most = Rules::MAX_ITERATIONS;
            let message = format!("expected 0 to {most} iterations, not {value}");
            return Err(RulesError::at(place, message));
        }
        Ok(Some(value as u32))
    }

    fn start(&mut self) -> Result<(), RulesError> {
        let made = self.append(self.rules.axiom.clone(), 0)?;
        self.word.link(ENDS, made.clone(), ENDS);
        self.active = made.filter(|&at| self.has_production(at)).collect();
        Ok(())
    }

    /// Rewrites what matches; says whether anything did.
    fn step(&mut self, iteration: u32) -> Result<bool, RulesError> {
        let rules = self.rules;
        self.frame[1] = f64::from(iteration);
        let active = std::mem::take(&mut self.active);
        let mut rewritten: Vec<(u32, Range<u32>)> = Vec::new();
        let mut next_active = Vec::with_capacity(active.len());
        for at in active {
            let Some(production) = self.choose(at)? else {
                let symbol = self.word.symbol(at, rules);
                let mut of_symbol = rules.productions_of[usize::from(symbol)].iter();
                if of_symbol.any(|&p| rules.productions[p as usize].may_match_later) {
                    next_active.push(at);
                }
                continue;
            };
            self.last = Some(production.place);
            self.bind(production)?;
            let made = self.append(production.successor.clone(), iteration)?;
            next_active.extend(made.clone().filter(|&new| self.has_production(new)));
            rewritten.push((at, made));
        }
        // Only now, so that contexts saw the word as it was before the step.
        for (at, made) in &rewritten {
            self.word.replace(*at, made.clone());
        }
        self.active = next_active;
        Ok(!rewritten.is_empty())
    }

    fn has_production(&self, at: u32) -> bool {
        let symbol = usize::from(self.word.symbol(at, self.rules));
        !self.rules.productions_of[symbol].is_empty()
    }

    fn value(&mut self, code: Code) -> Result<f64, RulesError> {
        let program = &self.rules.program;
        program.value(code, &self.frame, &mut self.stack, self.random)
    }

    /// The production for a module. Draws lots only where there is a choice.
    fn choose(&mut self, at: u32) -> Result<Option<&'a Production>, RulesError> {
        let rules = self.rules;
        let symbol = usize::from(self.word.symbol(at, rules));
        self.candidates.clear();
        for &index in &rules.productions_of[symbol] {
            let production = &rules.productions[index as usize];
            self.looks += 1;
            if !self.matches(at, production)? {
                continue;
            }
            let weight = production.weight.map_or(Ok(1.0), |code| self.value(code))?;
            if weight < 0.0 {
                let message = format!("the weight of this production is negative: {weight}");
                return Err(RulesError::at(production.place, message));
            }
            self.candidates.push((index, weight));
        }
        if self.looks + self.contexts.steps > MAX_LOOKS {
            let place = rules.templates[self.word.nodes[at as usize].template as usize].place;
            let message =
                format!("the rules do not end: more than {MAX_LOOKS} modules were looked at");
            return Err(RulesError::at(place, message));
        }
        let chosen = match self.candidates.as_slice() {
            [] => return Ok(None),
            [(index, weight)] if *weight > 0.0 => *index,
            _ => self.draw_lot(symbol)?,
        };
        let production = &rules.productions[chosen as usize];
        if rules.productions_of[symbol].len() > 1 {
            // Another candidate's names may be in the frame.
            let holds = self.matches(at, production)?;
            debug_assert!(holds, "a match does not depend on lots");
        }
        Ok(Some(production))
    }

    fn draw_lot(&mut self, symbol: usize) -> Result<u32, RulesError> {
        let total: f64 = self.candidates.iter().map(|(_, weight)| weight).sum();
        if !(total > 0.0 && total.is_finite()) {
            let place = self.rules.productions[self.candidates[0].0 as usize].place;
            let name = cut(&self.rules.symbols[symbol].name);
            let message = format!(
                "the weights of the productions that match `{name}` sum to {total}, not to a \
                 positive number"
            );
            return Err(RulesError::at(place, message));
        }
        let mut left = total * self.random.unit();
        for &(index, weight) in &self.candidates {
            left -= weight;
            if left < 0.0 {
                return Ok(index);
            }
        }
        // Rounding left a remainder: it belongs to the last one with a weight.
        let last = self.candidates.iter().rfind(|(_, weight)| *weight > 0.0);
        Ok(last.expect("the weights sum to more than zero").0)
    }

    /// Whether a production's contexts and condition hold; its parameters and those
    /// of its contexts are then in the frame.
    fn matches(&mut self, at: u32, production: &Production) -> Result<bool, RulesError> {
        let contexts = [&production.left[..], &production.right[..]];
        if !self.contexts.are_met(&self.word, self.rules, at, contexts) {
            return Ok(false);
        }
        self.frame.truncate(self.globals);
        let found = self
            .contexts
            .left()
            .chain([at])
            .chain(self.contexts.right());
        for module in found {
            let parameters = self.word.parameters(module, self.rules);
            self.frame.extend_from_slice(parameters);
        }
        match production.condition {
            Some(condition) => Ok(self.value(condition)? != 0.0),
            None => Ok(true),
        }
    }

    fn bind(&mut self, production: &Production) -> Result<(), RulesError> {
        for &binding in &production.bindings {
            let value = self.value(binding)?;
            self.frame.push(value);
        }
        Ok(())
    }

    /// Makes modules from templates, linked among themselves.
    fn append(&mut self, templates: Range<u32>, iteration: u32) -> Result<Range<u32>, RulesError> {
        let rules = self.rules;
        let start = self.word.nodes.len() as u32;
        for index in templates {
            let template = &rules.templates[index as usize];
            if self.word.size() > rules.max_modules {
                return Err(over_limit(rules, template, iteration));
            }
            self.parameters.clear();
            for &argument in &template.arguments {
                let value = self.value(argument)?;
                self.parameters.push(value);
            }
            self.word.push(index, &self.parameters);
        }
        let made = start..self.word.nodes.len() as u32;
        self.word
            .match_brackets(made.clone(), rules, &mut self.open);
        Ok(made)
    }
}

fn over_limit(rules: &Rules, template: &Template, iteration: u32) -> RulesError {
    let message = format!(
        "the rules make more than {} modules, the limit, at iteration {iteration}: do they end?",
        rules.max_modules
    );
    RulesError::at(template.place, message)
}
