//! Numbers of one to five bytes, seven bits each (unsigned LEB128).

use super::{ENDS_EARLY, StreamError};

/// Bytes that are read one after another.
pub(super) struct Bytes<'a> {
    rest: &'a [u8],
}

impl<'a> Bytes<'a> {
    pub(super) fn new(rest: &'a [u8]) -> Self {
        Self { rest }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.rest.is_empty()
    }

    pub(super) fn byte(&mut self) -> Result<u8, StreamError> {
        let (&first, rest) = self.rest.split_first().ok_or(ENDS_EARLY)?;
        self.rest = rest;
        Ok(first)
    }

    pub(super) fn take(&mut self, count: usize) -> Result<&'a [u8], StreamError> {
        let (taken, rest) = self.rest.split_at_checked(count).ok_or(ENDS_EARLY)?;
        self.rest = rest;
        Ok(taken)
    }

    /// Bits beyond the 32nd are ignored, as the specification asks.
    pub(super) fn varint(&mut self) -> Result<u32, StreamError> {
        let mut value = 0;
        for shift in [0, 7, 14, 21, 28] {
            let byte = self.byte()?;
            value |= u32::from(byte & 0x7f) << shift;
            if byte & 0x80 == 0 {
                return Ok(value);
            }
        }
        Err(StreamError("a number of it has more than five bytes"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_examples_of_the_specification() {
        let decode = |bytes: &[u8]| Bytes::new(bytes).varint();
        assert_eq!(decode(&[0x7f]), Ok(0x7f));
        assert_eq!(decode(&[0x81, 0x04]), Ok(0x201));
        assert_eq!(decode(&[0xff, 0xa0, 0x05]), Ok(0x1_5000 | 0x7f));
        assert_eq!(decode(&[0xff]), Err(ENDS_EARLY));
        assert!(decode(&[0x80; 6]).is_err());
    }
}
