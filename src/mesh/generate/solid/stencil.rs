//! What is left of one lattice tetrahedron: the stencils of isosurface stuffing.
//!
//! A corner is inside, outside, or has been moved onto the surface; an edge from an inside to an
//! outside corner has a cut point. The part of the tetrahedron that is kept is its inside corners,
//! its corners on the surface and its cut points: a tetrahedron, a pyramid or a prism. Quadrilateral
//! sides are split by a rule that needs nothing but the side, so that neighbours agree.

/// Where a corner is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Side {
    /// In the solid.
    Inside,
    /// Moved onto the surface.
    On,
    /// Not in the solid.
    Outside,
}

/// Lattice coordinates: all even or all odd, a cell being two wide.
pub(super) type Coordinates = [i64; 3];

/// Fills a positively oriented tetrahedron; `node` names a corner, `cut` the cut point between an
/// inside and an outside corner.
pub(super) fn fill(
    sides: [Side; 4],
    at: &[Coordinates; 4],
    node: impl Fn(usize) -> u32,
    cut: impl Fn(usize, usize) -> u32,
    tetrahedra: &mut Vec<[u32; 4]>,
) {
    let mut corners = [0; 4];
    let mut count = 0;
    let mut which = |side| {
        let start = count;
        for i in 0..4 {
            if sides[i] == side {
                corners[count] = i;
                count += 1;
            }
        }
        count - start
    };
    let (inside, outside) = (which(Side::Inside), which(Side::Outside));
    which(Side::On);
    let [p, q, r, s] = corners;
    let whole = [0, 1, 2, 3].map(&node);
    // Replacing corners in place by points of the tetrahedron keeps the orientation.
    let replaced = |changes: &[(usize, u32)]| {
        let mut result = whole;
        for &(corner, by) in changes {
            result[corner] = by;
        }
        result
    };
    match (inside, outside) {
        (0, _) => {}
        (_, 0) => tetrahedra.push(whole),
        (1, 1) => tetrahedra.push(replaced(&[(q, cut(p, q))])),
        (1, 2) => tetrahedra.push(replaced(&[(q, cut(p, q)), (r, cut(p, r))])),
        (1, _) => tetrahedra.push(replaced(&[(q, cut(p, q)), (r, cut(p, r)), (s, cut(p, s))])),
        (2, 1) => {
            // A pyramid over the quadrilateral p, q and their cut points.
            let (with, other) = match touches(at, p, q, r) {
                true => (p, q),
                false => (q, p),
            };
            let (near, far) = (cut(with, r), cut(other, r));
            tetrahedra.push(replaced(&[(r, far)]));
            tetrahedra.push(replaced(&[(other, far), (r, near)]));
        }
        (2, _) => {
            let (r, s) = if odd([p, q, r, s]) { (s, r) } else { (r, s) };
            let before = [touches(at, p, q, r), touches(at, p, q, s)];
            // The two sides are split towards different corners, which leaves one way to split the
            // side on the surface.
            let prism = [
                [node(p), cut(p, r), cut(p, s)],
                [node(q), cut(q, r), cut(q, s)],
            ];
            push_prism(prism, [before[0], before[1], before[1]], tetrahedra);
        }
        _ => {
            let (p, q) = if odd([p, q, r, s]) { (q, p) } else { (p, q) };
            let before = [
                touches(at, p, q, s),
                touches(at, p, r, s),
                touches(at, q, r, s),
            ];
            let prism = [[p, q, r].map(&node), [p, q, r].map(|i| cut(i, s))];
            push_prism(prism, before, tetrahedra);
        }
    }
}

/// Does the diagonal of the quadrilateral between the edges p–outside and q–outside begin at p?
///
/// It begins at the corner whose edge is short (half a diagonal of the cell). If both are, p and q
/// differ along one axis with the outside corner half way between, and exactly one of them is
/// greater than it in an even number of coordinates: the parity rule of the paper.
fn touches(at: &[Coordinates; 4], p: usize, q: usize, outside: usize) -> bool {
    match (is_long(at[p], at[outside]), is_long(at[q], at[outside])) {
        (false, false) => (0..3).filter(|&k| at[p][k] > at[outside][k]).count() % 2 == 0,
        (long, _) => !long,
    }
}

/// Is the edge a side of a cell (two wide) rather than half of a cell's diagonal?
pub(super) fn is_long(a: Coordinates, b: Coordinates) -> bool {
    (0..3).any(|k| a[k] == b[k])
}

/// Splits the prism of triangles `a`, `b` (column i is a[i]–b[i]; a[0] a[1] a[2] b[2] is positive);
/// `before` says for the columns (0, 1), (0, 2), (1, 2) whether the diagonal between them begins at
/// the a of the first.
fn push_prism([a, b]: [[u32; 3]; 2], before: [bool; 3], tetrahedra: &mut Vec<[u32; 4]>) {
    let [ab, ac, bc] = before.map(usize::from);
    // The diagonals are not cyclic, so the columns have an order: by how many they come before.
    let wins = [ab + ac, 1 - ab + bc, 2 - ac - bc];
    let mut order = [0; 3];
    for column in 0..3 {
        order[2 - wins[column]] = column;
    }
    let [x, y, z] = order;
    let pieces = [
        [a[x], a[y], a[z], b[z]],
        [a[x], a[y], b[z], b[y]],
        [a[x], b[x], b[y], b[z]],
    ];
    let flip = odd([x, y, z]);
    for [p, q, r, s] in pieces {
        tetrahedra.push(if flip { [q, p, r, s] } else { [p, q, r, s] });
    }
}

/// Is the permutation odd?
fn odd<const N: usize>(order: [usize; N]) -> bool {
    let inversions = |i: usize| (i + 1..N).filter(|&j| order[j] < order[i]).count();
    (0..N).map(inversions).sum::<usize>() % 2 == 1
}

#[cfg(test)]
#[path = "stencil_tests.rs"]
mod tests;
