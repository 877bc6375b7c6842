//! Where the entries of L lie for triangular solves: panels without padding zeros.
//!
//! A panel is a run of columns with exactly the same rows below them. Its values lie in the order in
//! which a solve reads them: the columns of the triangle at the diagonal, then the rows below, four at
//! a time: all columns of the first four rows, all of the next. The row indices are stored once.

use super::EliminationTree;
use nalgebra_sparse::CscMatrix;

/// Rows that go through a panel at a time. The rows of a panel are filled up to a multiple, with zeros
/// that belong to rows already there.
pub const ROWS: usize = 4;

/// Widest panel: wider ones are split, so that their triangles stay small.
pub const WIDEST: usize = 16;

/// Consecutive columns of L with the same rows below them.
#[derive(Debug, Clone, Copy)]
pub struct Panel {
    /// First column.
    pub first: u32,
    /// Columns.
    pub width: u32,
    /// Where its values begin.
    pub values: u32,
    /// Where its rows begin (in fours).
    pub rows: u32,
    /// How many fours of rows it has,
    pub fours: u32,
    /// and how many of them are in its own part, the rest being in later levels.
    pub inner: u32,
}

impl Panel {
    /// Where its rows below the diagonal are, in fours.
    #[inline(always)]
    pub fn rows(&self) -> core::ops::Range<usize> {
        self.rows as usize..(self.rows + self.fours) as usize
    }
    /// Entries in the triangle at the diagonal.
    #[inline(always)]
    pub fn triangle(&self) -> usize {
        let width = self.width as usize;
        width * (width + 1) / 2
    }
    /// Values, zeros that fill up included.
    fn len(&self) -> usize {
        self.triangle() + self.fours as usize * ROWS * self.width as usize
    }
}

/// The last column of the panel that begins with column `first`, before `end`.
fn last_column(tree: &EliminationTree, begin: &[u32], first: usize, end: usize) -> usize {
    let count = |j: usize| begin[j + 1] - begin[j];
    let mut last = first;
    // beside its own, a column has at most the rows of its parent
    while last + 1 < end.min(first + WIDEST)
        && tree.parent[last] == last as u32 + 1
        && count(last) == count(last + 1) + 1
    {
        last += 1;
    }
    last
}

/// A part of a level: columns that know nothing of those of its neighbours.
#[derive(Debug, Clone, Copy)]
pub struct Part {
    /// Where its columns end.
    pub end: usize,
    /// Where its panels begin,
    pub begin_panel: usize,
    /// and end.
    pub end_panel: usize,
}

/// The panels of a factor.
#[derive(Debug, Clone, Default)]
pub struct Panels {
    /// By ascending column.
    pub panels: Vec<Panel>,
    /// Rows below, ascending but for the fill.
    pub rows: Vec<[u32; ROWS]>,
    /// The parts of each level; at least one level.
    pub levels: Vec<Vec<Part>>,
    /// Number of values.
    pub values: usize,
    /// Entries of L: values that are not fill.
    pub entries: usize,
}

impl Panels {
    /// The panels of the factor of a matrix with this upper triangle and the levels of its order.
    pub fn new(upper: &CscMatrix<f64>, levels: &[Vec<usize>]) -> Self {
        let n = upper.ncols();
        let tree = EliminationTree::new(upper);
        let (begin, rows) = tree.columns(upper);
        let mut this = Self {
            entries: n + rows.len(),
            ..Self::default()
        };
        let everything = [vec![n]];
        let levels = if levels.is_empty() {
            &everything
        } else {
            levels
        };
        let mut first = 0;
        for ends in levels {
            let level_end = ends.last().copied().unwrap_or(first);
            let parts = ends.iter().map(|&end| {
                let begin_panel = this.panels.len();
                while first < end {
                    let last = last_column(&tree, &begin, first, end);
                    let below = &rows[begin[last] as usize..begin[last + 1] as usize];
                    this.push(first, last, below, level_end);
                    first = last + 1;
                }
                let end_panel = this.panels.len();
                Part {
                    end,
                    begin_panel,
                    end_panel,
                }
            });
            let parts = parts.collect();
            this.levels.push(parts);
        }
        this
    }

    /// Most unknowns that the parts of a level may add to, times the parts.
    pub fn work(&self) -> usize {
        let n = self
            .panels
            .last()
            .map_or(0, |p| (p.first + p.width) as usize);
        let of_level = |parts: &Vec<Part>| parts.len() * (n - parts.last().map_or(n, |p| p.end));
        self.levels.iter().map(of_level).max().unwrap_or(0)
    }

    fn push(&mut self, first: usize, last: usize, below: &[u32], level_end: usize) {
        let (own, later) = below.split_at(below.partition_point(|&r| (r as usize) < level_end));
        let mut panel = Panel {
            first: first as u32,
            width: (last + 1 - first) as u32,
            values: self.values as u32,
            rows: self.rows.len() as u32,
            fours: 0,
            inner: 0,
        };
        self.push_rows(own);
        panel.inner = self.rows.len() as u32 - panel.rows;
        self.push_rows(later);
        panel.fours = self.rows.len() as u32 - panel.rows;
        self.values += panel.len();
        self.panels.push(panel);
    }

    fn push_rows(&mut self, rows: &[u32]) {
        self.rows.extend(rows.chunks(ROWS).map(|four| {
            let last = four[four.len() - 1];
            core::array::from_fn(|k| four.get(k).copied().unwrap_or(last))
        }));
    }

    /// Calls `each(row, column, place in the values)` for every entry of L in the columns from `first` on.
    pub fn for_each_entry(&self, first: usize, mut each: impl FnMut(usize, usize, usize)) {
        let begin = self
            .panels
            .partition_point(|p| ((p.first + p.width) as usize) <= first);
        for panel in &self.panels[begin..] {
            let columns = panel.first as usize..(panel.first + panel.width) as usize;
            let mut place = panel.values as usize;
            let mut found = |row, column, place| {
                if column >= first {
                    each(row, column, place);
                }
            };
            for j in columns.clone() {
                for i in j..columns.end {
                    found(i, j, place);
                    place += 1;
                }
            }
            for four in &self.rows[panel.rows()] {
                for j in columns.clone() {
                    for k in 0..ROWS {
                        if k == 0 || four[k] != four[k - 1] {
                            found(four[k] as usize, j, place);
                        }
                        place += 1;
                    }
                }
            }
        }
    }

    /// Where the diagonal is in the values.
    pub fn diagonal(&self) -> Vec<u32> {
        let of_panel = |panel: &Panel| {
            let (begin, width) = (panel.values, panel.width);
            (0..width).map(move |j| begin + j * width - j * j.saturating_sub(1) / 2)
        };
        self.panels.iter().flat_map(of_panel).collect()
    }
}
