//! Where a table with a row for each leaf keeps it.
//!
//! Of a million leaves most are seen in no view, and their rows are zeros. A table that is large
//! keeps rows only for leaves that need one; the others read a row of zeros that they share.

/// Rows by leaf, or by whatever else counts from 0.
#[derive(Clone, Debug)]
pub struct Rows {
    /// The row of each, [`SHARED`] where it has none of its own; empty where each has the row of
    /// its own number.
    row_of: Vec<u32>,
    /// Rows of zeros that nobody has any more.
    free: Vec<u32>,
    count: usize,
}

/// The row of zeros.
const SHARED: u32 = 0;

impl Rows {
    /// A row for each of `count`, always.
    pub fn of_all(count: usize) -> Self {
        Self {
            row_of: Vec::new(),
            free: Vec::new(),
            count,
        }
    }

    /// Rows for those of `count` that [ask](Self::own) for one.
    pub fn of_some(count: usize) -> Self {
        Self {
            row_of: vec![SHARED; count],
            free: Vec::new(),
            count: 1,
        }
    }

    /// How many rows there are: what comes before the next new one.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Where a leaf's numbers are to be read.
    #[inline(always)]
    pub fn row(&self, leaf: usize) -> usize {
        match self.row_of.is_empty() {
            true => leaf,
            false => self.row_of[leaf] as usize,
        }
    }

    /// The row of a leaf that is about to be written. It is full of zeros where it has none yet,
    /// and may be one more than there were.
    #[inline]
    pub fn own(&mut self, leaf: usize) -> usize {
        match self.row(leaf) {
            0 if !self.row_of.is_empty() => self.add(leaf),
            row => row,
        }
    }

    #[cold]
    fn add(&mut self, leaf: usize) -> usize {
        let row = self.free.pop().unwrap_or_else(|| {
            self.count += 1;
            self.count as u32 - 1
        });
        self.row_of[leaf] = row;
        row as usize
    }

    /// The leaf has only zeros in its row, which another may have.
    pub fn give_back(&mut self, leaf: usize) {
        if let Some(row) = self.row_of.get_mut(leaf)
            && *row != SHARED
        {
            self.free.push(std::mem::replace(row, SHARED));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_those_that_write_have_rows() {
        let mut rows = Rows::of_some(9);
        assert_eq!([rows.row(3), rows.row(8), rows.count()], [0, 0, 1]);
        assert_eq!([rows.own(8), rows.own(3), rows.own(8)], [1, 2, 1]);
        rows.give_back(8);
        rows.give_back(5);
        assert_eq!([rows.row(8), rows.row(3), rows.count()], [0, 2, 3]);
        // The row that was given back comes before a new one.
        assert_eq!([rows.own(7), rows.own(0)], [1, 3]);
    }

    #[test]
    fn where_all_have_rows_they_keep_them() {
        let mut rows = Rows::of_all(3);
        assert_eq!([rows.own(0), rows.own(2), rows.count()], [0, 2, 3]);
        rows.give_back(2);
        assert_eq!([rows.row(2), rows.own(2)], [2, 2]);
    }
}
