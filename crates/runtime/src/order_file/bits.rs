//! Numbers of any width, one after the other without gaps, lowest bit first.

/// A sequence of bits that grows at its end.
#[derive(Debug, Default)]
pub(super) struct BitWriter {
    bytes: Vec<u8>,
    /// Bits of the last byte that are used, 0 for all.
    used: u32,
}

impl BitWriter {
    /// The lowest `width` bits of a number.
    pub(super) fn bits(&mut self, number: u64, width: u32) {
        let mut left = width;
        while left > 0 {
            if self.used == 0 {
                self.bytes.push(0);
            }
            let taken = (8 - self.used).min(left);
            let part = (number >> (width - left)) & ((1 << taken) - 1);
            if let Some(last) = self.bytes.last_mut() {
                *last |= (part << self.used) as u8;
            }
            self.used = (self.used + taken) % 8;
            left -= taken;
        }
    }

    /// A number from 1 on in about twice its own bits, small ones in few (Elias' gamma code).
    pub(super) fn gamma(&mut self, number: u64) {
        debug_assert!(number > 0, "the code has no zero");
        let more = number.ilog2();
        self.bits(0, more);
        self.bits(1, 1);
        self.bits(number, more);
    }

    /// A number of at least 0, small ones in few bits.
    pub(super) fn small(&mut self, number: u32) {
        self.gamma(u64::from(number) + 1);
    }

    pub(super) fn real(&mut self, number: f64) {
        self.bits(number.to_bits(), 64);
    }

    pub(super) fn into_bytes(self) -> Vec<u8> {
        self.bytes
    }
}

/// Reads what a [`BitWriter`] wrote; nothing beyond the end.
#[derive(Clone, Copy, Debug)]
pub(super) struct BitReader<'a> {
    bytes: &'a [u8],
    at: u64,
}

impl<'a> BitReader<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0 }
    }

    pub(super) fn bits(&mut self, width: u32) -> Option<u64> {
        if u64::from(width) > self.left() {
            return None;
        }
        let (mut number, mut read) = (0, 0);
        while read < width {
            let byte = u64::from(self.bytes[(self.at / 8) as usize]) >> (self.at % 8);
            let taken = (8 - (self.at % 8) as u32).min(width - read);
            number |= (byte & ((1 << taken) - 1)) << read;
            self.at += u64::from(taken);
            read += taken;
        }
        Some(number)
    }

    pub(super) fn bit(&mut self) -> Option<bool> {
        self.bits(1).map(|bit| bit == 1)
    }

    pub(super) fn gamma(&mut self) -> Option<u64> {
        let mut more = 0;
        while !self.bit()? {
            more += 1;
            if more > 40 {
                return None;
            }
        }
        Some(1 << more | self.bits(more)?)
    }

    pub(super) fn small(&mut self) -> Option<u32> {
        u32::try_from(self.gamma()? - 1).ok()
    }

    pub(super) fn real(&mut self) -> Option<f64> {
        self.bits(64).map(f64::from_bits)
    }

    /// Bits that were not read.
    pub(super) fn left(&self) -> u64 {
        self.bytes.len() as u64 * 8 - self.at
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_come_back() {
        let mut writer = BitWriter::default();
        for number in 1..300 {
            writer.bits(number * 77, 17);
            writer.gamma(number);
            writer.real(number as f64 / 3.0);
            writer.bits(1, 1);
        }
        writer.small(u32::MAX);
        let bytes = writer.into_bytes();
        let mut reader = BitReader::new(&bytes);
        for number in 1..300 {
            assert_eq!(reader.bits(17), Some(number * 77));
            assert_eq!(reader.gamma(), Some(number));
            assert_eq!(reader.real(), Some(number as f64 / 3.0));
            assert_eq!(reader.bit(), Some(true));
        }
        assert_eq!(reader.small(), Some(u32::MAX));
        assert!(reader.left() < 8);
        assert_eq!(reader.bits(8), None);
    }

    #[test]
    fn a_number_without_an_end_is_none() {
        assert_eq!(BitReader::new(&[0; 64]).gamma(), None);
        assert_eq!(BitReader::new(&[0; 2]).gamma(), None);
        assert_eq!(BitReader::new(&[]).bit(), None);
    }
}
