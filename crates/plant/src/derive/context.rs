//! Contexts: what must stand before and after a module.

use crate::language::{POP, PUSH, Rules};

use super::word::{ENDS, Word};

/// Matches the contexts of a module, and keeps the modules found.
#[derive(Default)]
pub(super) struct Contexts {
    left: Vec<u32>,
    right: Vec<u32>,
    /// Modules looked at, in all.
    pub(super) steps: u64,
}

impl Contexts {
    /// Whether the symbols stand before and after a module.
    pub(super) fn are_met(
        &mut self,
        word: &Word,
        rules: &Rules,
        at: u32,
        [left, right]: [&[u16]; 2],
    ) -> bool {
        self.left.clear();
        self.right.clear();
        let mut here = at;
        for &symbol in left.iter().rev() {
            here = self.before(word, rules, here);
            if here == ENDS || word.symbol(here, rules) != symbol {
                return false;
            }
            self.left.push(here);
        }
        here = at;
        for &symbol in right {
            here = self.after(word, rules, here);
            if here == ENDS || word.symbol(here, rules) != symbol {
                return false;
            }
            self.right.push(here);
        }
        true
    }

    /// The modules found to the left, from the far one to the near one.
    pub(super) fn left(&self) -> impl Iterator<Item = u32> + '_ {
        self.left.iter().rev().copied()
    }

    /// The modules found to the right, from the near one to the far one.
    pub(super) fn right(&self) -> impl Iterator<Item = u32> + '_ {
        self.right.iter().copied()
    }

    /// The module before on the way to the root: a branch that has ended is passed
    /// over, the start of the branch one is on is walked through.
    fn before(&mut self, word: &Word, rules: &Rules, mut at: u32) -> u32 {
        loop {
            self.steps += 1;
            at = word.nodes[at as usize].previous;
            if at == ENDS {
                return ENDS;
            }
            match word.symbol(at, rules) {
                POP => at = word.other_bracket(at),
                PUSH => {}
                symbol if rules.ignored[usize::from(symbol)] => {}
                _ => return at,
            }
        }
    }

    /// The module after on the same axis: branches are passed over, and the end
    /// of the branch is the end.
    fn after(&mut self, word: &Word, rules: &Rules, mut at: u32) -> u32 {
        loop {
            self.steps += 1;
            at = word.nodes[at as usize].next;
            if at == ENDS {
                return ENDS;
            }
            match word.symbol(at, rules) {
                PUSH => at = word.other_bracket(at),
                POP => return ENDS,
                symbol if rules.ignored[usize::from(symbol)] => {}
                _ => return at,
            }
        }
    }
}
