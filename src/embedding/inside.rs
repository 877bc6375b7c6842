//! The inside of a body whose boundary is given.

use crate::geometry::{Elimination, RestShape};
use crate::linalg::{Cholesky, SymmetricAssembly};
use crate::optim::BuildError;

/// Places the vertices inside of triangles in the plane (D = 2) or of tetrahedra (D = 3) harmonically in the rest shape's
/// Laplacian: the minimum of the Dirichlet energy with the vertices of the `boundary` where they are in `x`. What is part
/// of no element stays, too. It may invert elements.
///
/// # Errors
/// `TooLarge`; `NotPositiveDefinite` where a part of the body has no boundary.
pub fn harmonic_inside<const D: usize>(
    rest: &RestShape,
    boundary: &[u32],
    x: &mut [[f64; D]],
) -> Result<(), BuildError> {
    let mut is_inside = vec![false; x.len()];
    (rest.vertices.iter()).for_each(|&v| is_inside[v as usize] = true);
    (boundary.iter()).for_each(|&v| is_inside[v as usize] = false);
    let held: Vec<u32> = (0..x.len() as u32)
        .filter(|&v| !is_inside[v as usize])
        .collect();
    let elimination = Elimination::new(rest, x.len(), &held);
    let free = elimination.free;
    if free == 0 {
        return Ok(());
    }
    let mut of_slot = vec![0; x.len()];
    for (v, &slot) in elimination.slot.iter().enumerate() {
        of_slot[slot as usize] = v;
    }
    let entries = elimination.laplacian(rest);
    let mut solution = vec![0.0; D * free];
    let rows = solution.as_chunks_mut::<D>().0;
    for &(i, j, _, value) in &entries {
        let (inner, outer) = (i.min(j) as usize, i.max(j) as usize);
        if inner < free && outer >= free {
            let p = x[of_slot[outer]];
            (0..D).for_each(|k| rows[inner][k] -= value * p[k]);
        }
    }
    let mut assembly = SymmetricAssembly::new(free, entries.iter().map(|e| (e.0, e.1)));
    assembly.fill(|c| entries[c].3);
    let mut factor = Cholesky::analyze(assembly.matrix(), &elimination.levels)?;
    factor
        .factorize(assembly.matrix())
        .map_err(|e| BuildError::NotPositiveDefinite { pivot: e.pivot })?;
    factor.solve_in_place(&mut solution, D);
    for (p, &v) in solution.as_chunks::<D>().0.iter().zip(&of_slot) {
        x[v] = *p;
    }
    Ok(())
}
