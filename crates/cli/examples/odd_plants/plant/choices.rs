//! What is chosen of a plant, one choice a byte: bytes of chance, of a fuzzer, or of a test that shrinks them.

use secateur_plant::Random;

/// Bytes that choose; once they are spent, the first of everything is chosen, which is the plainest.
#[derive(Debug)]
pub(crate) struct Choices<'a> {
    bytes: &'a [u8],
}

/// How many choices a plant and what is asked of it have, at most.
const COUNT: usize = 40;

/// The bytes of a numbered plant.
pub(crate) fn bytes_of(number: u64) -> Vec<u8> {
    let mut random = Random::new(number);
    (0..COUNT).map(|_| random.bits() as u8).collect()
}

impl<'a> Choices<'a> {
    pub(crate) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes }
    }

    fn byte(&mut self) -> u8 {
        let Some((first, rest)) = self.bytes.split_first() else {
            return 0;
        };
        self.bytes = rest;
        *first
    }

    /// One of some things.
    pub(crate) fn one_of<T: Copy>(&mut self, of: &[T]) -> T {
        of[usize::from(self.byte()) % of.len()]
    }

    /// True in one of so many cases, and never where no bytes are left.
    pub(crate) fn one_in(&mut self, cases: u8) -> bool {
        self.byte() % cases == cases - 1
    }

    /// Numbers to place things by.
    pub(crate) fn random(&mut self) -> Random {
        Random::new(self.byte().into())
    }
}
