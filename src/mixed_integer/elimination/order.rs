//! Which row is eliminated next: the one with the fewest terms (paper, §2.2), counted anew whenever
//! elimination changes it.

use super::rows::Rows;
use std::collections::BTreeSet;

/// The open rows by number of terms, then by number; or as they were given.
pub(super) struct Queue {
    rows: BTreeSet<(u32, u32)>,
    /// The count under which a row is queued; all 0 when rows keep their order.
    key: Vec<u32>,
    reordered: bool,
}

impl Queue {
    pub fn new(rows: &Rows, reordered: bool) -> Self {
        let key: Vec<u32> = (0..rows.len() as u32)
            .map(|row| u32::from(reordered) * rows.terms(row).len() as u32)
            .collect();
        Self {
            rows: key.iter().copied().zip(0..).collect(),
            key,
            reordered,
        }
    }

    pub fn pop(&mut self, rows: &Rows) -> Option<u32> {
        let (_, row) = self.rows.pop_first()?;
        debug_assert!(rows.is_open(row), "a row is eliminated once");
        Some(row)
    }

    /// A row that was taken out is to be eliminated later.
    pub fn put_back(&mut self, row: u32, rows: &Rows) {
        let key = &mut self.key[row as usize];
        if self.reordered {
            *key = rows.terms(row).len() as u32;
        }
        self.rows.insert((*key, row));
    }

    /// A row that is still open has other terms now.
    pub fn changed(&mut self, row: u32, rows: &Rows) {
        let key = &mut self.key[row as usize];
        let new = rows.terms(row).len() as u32;
        if self.reordered && *key != new && self.rows.remove(&(*key, row)) {
            *key = new;
            self.rows.insert((new, row));
        }
    }
}
