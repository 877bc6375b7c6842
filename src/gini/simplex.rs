//! The signed measure of a simplex and its gradient.

/// Positions of the corners: 3 in the plane, 4 in space; what is beyond does not count.
pub type Corners<const D: usize> = [[f64; D]; 4];

/// The corners at these slots.
#[inline(always)]
pub fn corners<const D: usize>(x: &[[f64; D]], slots: &[u32; 4]) -> Corners<D> {
    let at = |i: usize| x[slots[i] as usize];
    // in the plane the fourth slot repeats the third
    [at(0), at(1), at(2), at(3)]
}

#[inline(always)]
fn edge<const D: usize>(p: &Corners<D>, i: usize) -> [f64; 3] {
    let mut e = [0.0; 3];
    for c in 0..D {
        e[c] = p[i][c] - p[0][c];
    }
    e
}

#[inline(always)]
fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// Signed area of a triangle in the plane, or volume of a tetrahedron.
#[inline(always)]
pub fn signed_measure<const D: usize>(p: &Corners<D>) -> f64 {
    let (a, b) = (edge(p, 1), edge(p, 2));
    if D == 2 {
        0.5 * (a[0] * b[1] - a[1] * b[0])
    } else {
        let (c, n) = (edge(p, 3), cross(a, b));
        (n[0] * c[0] + n[1] * c[1] + n[2] * c[2]) / 6.0
    }
}

/// Its gradient by the corners; in the plane the fourth is 0.
#[inline(always)]
pub fn measure_gradient<const D: usize>(p: &Corners<D>) -> [[f64; D]; 4] {
    let mut g = [[0.0; D]; 4];
    let (a, b) = (edge(p, 1), edge(p, 2));
    if D == 2 {
        (g[1][0], g[1][1]) = (0.5 * b[1], -0.5 * b[0]);
        (g[2][0], g[2][1]) = (-0.5 * a[1], 0.5 * a[0]);
    } else {
        let c = edge(p, 3);
        for (corner, normal) in [(1, cross(b, c)), (2, cross(c, a)), (3, cross(a, b))] {
            for i in 0..D {
                g[corner][i] = normal[i] / 6.0;
            }
        }
    }
    for i in 0..D {
        g[0][i] = -(g[1][i] + g[2][i] + g[3][i]);
    }
    g
}
