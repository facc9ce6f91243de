//! Mode 1: triangle lists, as codes over recent edges and vertices.

use super::varint::Bytes;
use super::{ENDS_EARLY, GOES_ON, StreamError, WRONG_HEADER};

const HEADER: u8 = 0xe1;
const TABLE_BYTES: usize = 16;
const FIFO: usize = 16;

/// The last sixteen of something; entry 0 is the newest.
struct Recent<T> {
    entries: [T; FIFO],
    next: usize,
}

impl<T: Copy + Default> Recent<T> {
    /// Entries that were never pushed are zero, where the specification leaves
    /// them open.
    fn new() -> Self {
        Self {
            entries: [T::default(); FIFO],
            next: 0,
        }
    }

    fn push(&mut self, entry: T) {
        self.entries[self.next] = entry;
        self.next = (self.next + 1) % FIFO;
    }

    fn get(&self, age: u8) -> T {
        self.entries[(self.next + FIFO - 1 - usize::from(age)) % FIFO]
    }
}

struct Decoder<'a> {
    data: Bytes<'a>,
    table: &'a [u8],
    edges: Recent<(u32, u32)>,
    vertices: Recent<u32>,
    next: u32,
    last: u32,
}

impl Decoder<'_> {
    fn take_next(&mut self) -> u32 {
        let vertex = self.next;
        self.next = vertex.wrapping_add(1);
        vertex
    }

    fn explicit(&mut self) -> Result<u32, StreamError> {
        let code = self.data.varint()?;
        let magnitude = code >> 1;
        let delta = if code & 1 == 0 { magnitude } else { !magnitude };
        self.last = self.last.wrapping_add(delta);
        Ok(self.last)
    }

    /// A vertex by a half-byte: the next one, a recent one, or (15, where that
    /// is allowed) one of its own. Also whether it is new to the recent ones.
    fn by_nibble(&mut self, nibble: u8) -> Result<(u32, bool), StreamError> {
        match nibble {
            0 => Ok((self.take_next(), true)),
            15 => Ok((self.explicit()?, true)),
            age => Ok((self.vertices.get(age - 1), false)),
        }
    }

    /// A triangle on a recent edge.
    fn on_edge(&mut self, edge_age: u8, low: u8) -> Result<[u32; 3], StreamError> {
        let (a, b) = self.edges.get(edge_age);
        let (c, is_new) = match low {
            0 => (self.take_next(), true),
            13 | 14 => {
                let step = if low == 13 { u32::MAX } else { 1 };
                self.last = self.last.wrapping_add(step);
                (self.last, true)
            }
            15 => (self.explicit()?, true),
            age => (self.vertices.get(age), false),
        };
        self.edges.push((c, b));
        self.edges.push((a, c));
        if is_new {
            self.vertices.push(c);
        }
        Ok([a, b, c])
    }

    /// A triangle of its own.
    fn apart(&mut self, low: u8) -> Result<[u32; 3], StreamError> {
        let nibbles = match low {
            14 | 15 => self.data.byte()?,
            row => self.table[usize::from(row)],
        };
        if low >= 14 && nibbles == 0 {
            self.next = 0;
        }
        let a = if low == 15 {
            self.explicit()?
        } else {
            self.take_next()
        };
        let (b, b_is_new) = self.by_nibble(nibbles >> 4)?;
        let (c, c_is_new) = self.by_nibble(nibbles & 15)?;
        self.edges.push((b, a));
        self.edges.push((c, b));
        self.edges.push((a, c));
        self.vertices.push(a);
        if b_is_new {
            self.vertices.push(b);
        }
        if c_is_new {
            self.vertices.push(c);
        }
        Ok([a, b, c])
    }
}

/// `count` indices, three to a triangle.
pub(super) fn decode(source: &[u8], count: usize) -> Result<Vec<u32>, StreamError> {
    let (&header, rest) = source.split_first().ok_or(ENDS_EARLY)?;
    if header != HEADER {
        return Err(WRONG_HEADER);
    }
    let table_at = rest.len().checked_sub(TABLE_BYTES).ok_or(ENDS_EARLY)?;
    let (rest, table) = rest.split_at(table_at);
    // A byte for each triangle: also the bound of the allocation.
    let (codes, data) = rest.split_at_checked(count / 3).ok_or(ENDS_EARLY)?;
    let has_fifteen = |row: &u8| row >> 4 == 15 || row & 15 == 15;
    if table.iter().any(has_fifteen) {
        return Err(StreamError("its table names vertices that aren't there"));
    }
    let mut decoder = Decoder {
        data: Bytes::new(data),
        table,
        edges: Recent::new(),
        vertices: Recent::new(),
        next: 0,
        last: 0,
    };
    let mut indices = Vec::with_capacity(count);
    for &code in codes {
        let (high, low) = (code >> 4, code & 15);
        indices.extend(match high {
            15 => decoder.apart(low)?,
            edge_age => decoder.on_edge(edge_age, low)?,
        });
    }
    if decoder.data.is_empty() {
        Ok(indices)
    } else {
        Err(GOES_ON)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_strip_takes_a_byte_for_each_triangle() {
        // 0xf0 with table row 0x00: three new vertices 0 1 2. Edges are then,
        // newest first: (0,2) (2,1) (1,0). 0x10 puts vertex 3 on (2,1). Then
        // (2,3) is newest and 0x0f puts an explicit vertex on it: the code 18
        // is a delta of 9.
        let mut source = vec![HEADER, 0xf0, 0x10, 0x0f, 18];
        source.extend([0; TABLE_BYTES]);
        let found = decode(&source, 9).unwrap();
        assert_eq!(found, [0, 1, 2, 2, 1, 3, 2, 3, 9]);
        assert_eq!(decode(&source, 6), Err(GOES_ON));
        assert_eq!(decode(&source[..19], 9), Err(ENDS_EARLY));
    }
}
