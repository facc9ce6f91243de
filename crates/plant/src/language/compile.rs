//! From the parse tree to [`Rules`].

use pest::Parser;
use pest::iterators::{Pair, Pairs};

use super::code::{Code, DETAIL, ITERATION, Op, Program};
use super::error::place_of;
use super::expression::{Expressions, Names};
use super::places::Places;
use super::rules::{Production, Template};
use super::size::check_size;
use super::symbols::{Symbols, head_parts};
use super::{Grammar, Rule, RulePosition, Rules, RulesError, Settings, settings};

impl Rules {
    /// Reads a rule file.
    ///
    /// # Errors
    /// [`RulesError`] with line and column: what was expected there, a symbol or
    /// name that is not known, a wrong number of parameters, brackets that do not
    /// match, no axiom; a file of more than 1 MiB or with more than 24
    /// parentheses within one another.
    pub fn parse(text: &str) -> Result<Self, RulesError> {
        check_size(text)?;
        let mut files = Grammar::parse(Rule::file, text)
            .map_err(|error| RulesError::of_syntax(&error, text))?;
        let file = files.next().expect("the grammar starts with a file");
        let mut compiler = Compiler {
            places: Places::new(text),
            ..Compiler::default()
        };
        compiler.symbols.declare(file.clone().into_inner())?;
        compiler.ignored = vec![false; compiler.symbols.len()];
        compiler.compile(file.into_inner())
    }
}

#[derive(Default)]
struct Compiler<'a> {
    places: Places<'a>,
    symbols: Symbols,
    templates: Vec<Template>,
    productions: Vec<Production>,
    program: Program,
    constants: Vec<Code>,
    /// Constants that have been defined, by their slot.
    names: Names,
    /// For each symbol, whether contexts look through it.
    ignored: Vec<bool>,
    axiom: Option<std::ops::Range<u32>>,
    iterations: Option<(Code, RulePosition)>,
    max_modules: Option<usize>,
    settings: Settings,
}

impl Compiler<'_> {
    fn compile(mut self, statements: Pairs<'_, Rule>) -> Result<Rules, RulesError> {
        self.names = Names::of_file();
        let mut end = RulePosition { line: 1, column: 1 };
        for statement in statements {
            let place = self.place(&statement);
            let rule = statement.as_rule();
            let inner = statement.into_inner();
            match rule {
                Rule::constant => self.constant(inner)?,
                Rule::ignored => self.ignore(inner)?,
                Rule::iterations => self.set_iterations(inner, place)?,
                Rule::modules => self.set_modules(inner)?,
                Rule::setting => self.set(inner)?,
                Rule::axiom => self.set_axiom(inner, place)?,
                Rule::production => self.production(inner, place)?,
                _ => end = place,
            }
        }
        let Some(axiom) = self.axiom else {
            return Err(RulesError::at(
                end,
                "the file has no axiom: write `axiom: ...;`",
            ));
        };
        let mut productions_of = vec![Vec::new(); self.symbols.len()];
        for (production, index) in self.productions.iter().zip(0..) {
            productions_of[usize::from(production.symbol)].push(index);
        }
        let whole = Code {
            start: 0,
            end: self.program.ops.len() as u32,
        };
        let uses = |slot| {
            let found = self.program.contains(whole, |op| op == Op::Slot(slot));
            found.is_some()
        };
        Ok(Rules {
            uses_detail: uses(DETAIL),
            asks_iteration: uses(ITERATION),
            symbols: self.symbols.into_infos(),
            templates: self.templates,
            axiom,
            productions: self.productions,
            productions_of,
            ignored: self.ignored,
            constants: self.constants,
            iterations: self.iterations,
            max_modules: self.max_modules.unwrap_or(Rules::MAX_MODULES),
            program: self.program,
            settings: self.settings,
        })
    }

    fn place(&self, pair: &Pair<'_, Rule>) -> RulePosition {
        self.places.at(pair.as_span().start())
    }

    fn expression(&mut self, pair: Pair<'_, Rule>) -> Result<Code, RulesError> {
        Expressions {
            program: &mut self.program,
            names: &self.names,
            places: &self.places,
        }
        .compile(pair)
    }

    fn constant(&mut self, inner: Pairs<'_, Rule>) -> Result<(), RulesError> {
        let [name, value] = name_and_value(inner);
        let code = self.expression(value)?;
        self.names.define(&name)?;
        self.constants.push(code);
        Ok(())
    }

    fn ignore(&mut self, inner: Pairs<'_, Rule>) -> Result<(), RulesError> {
        for symbol in inner.filter(|p| p.as_rule() == Rule::symbol) {
            let mut numbers = self.symbols.called(symbol.as_str()).peekable();
            if numbers.peek().is_none() {
                self.symbols.known(&symbol, 0)?;
            }
            for number in numbers {
                self.ignored[usize::from(number)] = true;
            }
        }
        Ok(())
    }

    fn set_iterations(
        &mut self,
        inner: Pairs<'_, Rule>,
        at: RulePosition,
    ) -> Result<(), RulesError> {
        once(self.iterations.is_some(), at, "iterations")?;
        let value = only(inner, Rule::expression);
        self.iterations = Some((self.expression(value)?, at));
        Ok(())
    }

    fn set_modules(&mut self, inner: Pairs<'_, Rule>) -> Result<(), RulesError> {
        let value = only(inner, Rule::number);
        let place = place_of(&value);
        once(self.max_modules.is_some(), place, "modules")?;
        let number: f64 = value.as_str().parse().unwrap_or(f64::INFINITY);
        let most = Rules::MAX_MODULES;
        if !(1.0..=most as f64).contains(&number) {
            return Err(RulesError::at(
                place,
                format!("write a number from 1 to {most}"),
            ));
        }
        self.max_modules = Some(number as usize);
        Ok(())
    }

    fn set(&mut self, inner: Pairs<'_, Rule>) -> Result<(), RulesError> {
        let mut name = None;
        let mut values = Vec::new();
        for pair in inner {
            match pair.as_rule() {
                Rule::name => name = Some(pair),
                Rule::value => values.push(pair),
                _ => {}
            }
        }
        let name = name.expect("a setting has a name");
        settings::set(&mut self.settings, &name, &values)
    }

    fn set_axiom(&mut self, inner: Pairs<'_, Rule>, at: RulePosition) -> Result<(), RulesError> {
        once(self.axiom.is_some(), at, "axiom")?;
        let word = only(inner, Rule::word);
        self.axiom = Some(self.word(word)?);
        Ok(())
    }

    fn word(&mut self, word: Pair<'_, Rule>) -> Result<std::ops::Range<u32>, RulesError> {
        let start = self.templates.len() as u32;
        let mut open: Vec<RulePosition> = Vec::new();
        for item in word.into_inner() {
            let place = self.place(&item);
            let template = match item.as_rule() {
                Rule::push => {
                    open.push(place);
                    self.bracket("[", place)
                }
                Rule::pop if open.pop().is_none() => {
                    return Err(RulesError::at(place, "`]` without a `[` before it"));
                }
                Rule::pop => self.bracket("]", place),
                _ => self.template(item, place)?,
            };
            self.templates.push(template);
        }
        match open.last() {
            Some(&place) => Err(RulesError::at(place, "`[` without a `]` after it")),
            None => Ok(start..self.templates.len() as u32),
        }
    }

    fn bracket(&self, name: &str, place: RulePosition) -> Template {
        Template {
            symbol: self.symbols.of_turtle(name),
            arguments: Vec::new(),
            place,
        }
    }

    fn template(
        &mut self,
        module: Pair<'_, Rule>,
        place: RulePosition,
    ) -> Result<Template, RulesError> {
        let mut inner = module.into_inner();
        let symbol = inner.next().expect("a module has a symbol");
        let arguments: Vec<_> = inner.filter(|p| p.as_rule() == Rule::expression).collect();
        let number = self.symbols.known(&symbol, arguments.len())?;
        let arguments: Result<Vec<Code>, RulesError> = arguments
            .into_iter()
            .map(|argument| self.expression(argument))
            .collect();
        Ok(Template {
            symbol: number,
            arguments: arguments?,
            place,
        })
    }

    fn production(
        &mut self,
        inner: Pairs<'_, Rule>,
        place: RulePosition,
    ) -> Result<(), RulesError> {
        self.names.enter_production();
        let mut production = Production {
            symbol: 0,
            left: Vec::new(),
            right: Vec::new(),
            condition: None,
            weight: None,
            bindings: Vec::new(),
            successor: 0..0,
            may_match_later: false,
            place,
        };
        for part in inner {
            match part.as_rule() {
                Rule::left_context => production.left = self.heads(part.into_inner())?,
                Rule::right_context => production.right = self.heads(part.into_inner())?,
                Rule::head => production.symbol = self.head(part)?,
                Rule::condition => {
                    production.condition = Some(self.certain(part, "a condition")?);
                }
                Rule::weight => production.weight = Some(self.certain(part, "a weight")?),
                Rule::bindings => production.bindings = self.bindings(part.into_inner())?,
                Rule::word => production.successor = self.word(part)?,
                _ => {}
            }
        }
        let asks = |code: Option<Code>| {
            let code = code.unwrap_or_default();
            let iteration = |op| op == Op::Slot(ITERATION);
            self.program.contains(code, iteration).is_some()
        };
        production.may_match_later = !production.left.is_empty()
            || !production.right.is_empty()
            || asks(production.condition);
        self.productions.push(production);
        self.names.leave_production();
        Ok(())
    }

    fn heads(&mut self, inner: Pairs<'_, Rule>) -> Result<Vec<u16>, RulesError> {
        let heads = inner.filter(|p| p.as_rule() == Rule::head);
        heads.map(|head| self.head(head)).collect()
    }

    fn head(&mut self, head: Pair<'_, Rule>) -> Result<u16, RulesError> {
        let (symbol, names) = head_parts(head);
        let number = self.symbols.known(&symbol, names.len())?;
        for name in &names {
            self.names.define(name)?;
        }
        Ok(number)
    }

    fn bindings(&mut self, inner: Pairs<'_, Rule>) -> Result<Vec<Code>, RulesError> {
        let mut codes = Vec::new();
        for binding in inner.filter(|p| p.as_rule() == Rule::binding) {
            let [name, value] = name_and_value(binding.into_inner());
            codes.push(self.expression(value)?);
            self.names.define(&name)?;
        }
        Ok(codes)
    }

    /// An expression that draws no lots.
    fn certain(&mut self, part: Pair<'_, Rule>, what: &str) -> Result<Code, RulesError> {
        let code = self.expression(only(part.into_inner(), Rule::expression))?;
        let random = |op| matches!(op, Op::Call(function) if function.is_random());
        match self.program.contains(code, random) {
            Some(place) => {
                let message = format!("{what} cannot draw lots: draw them in `with` or `let`");
                Err(RulesError::at(place, message))
            }
            None => Ok(code),
        }
    }
}

fn once(is_there: bool, place: RulePosition, what: &str) -> Result<(), RulesError> {
    match is_there {
        true => Err(RulesError::at(place, format!("`{what}` is given twice"))),
        false => Ok(()),
    }
}

fn only(inner: Pairs<'_, Rule>, rule: Rule) -> Pair<'_, Rule> {
    let mut found = inner.filter(|p| p.as_rule() == rule);
    found.next().expect("the grammar puts one there")
}

fn name_and_value(inner: Pairs<'_, Rule>) -> [Pair<'_, Rule>; 2] {
    [
        only(inner.clone(), Rule::name),
        only(inner, Rule::expression),
    ]
}
