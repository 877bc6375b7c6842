//! Turning faces so that neighbours agree.

use super::{MeshError, NONE, next, previous};

/// Do the two faces of an edge, given by their corners facing it, run along it in opposite directions?
#[inline]
fn agree(simplices: &[[u32; 3]], corner: u32, across: u32) -> bool {
    let corners = simplices.as_flattened();
    corners[next(corner) as usize] == corners[previous(across) as usize]
}

/// The first face that disagrees with a neighbour, and that neighbour.
pub(super) fn first_clash(simplices: &[[u32; 3]], opposite: &[u32]) -> Option<[usize; 2]> {
    opposite.iter().enumerate().find_map(|(corner, &across)| {
        let clash = across != NONE && !agree(simplices, corner as u32, across);
        clash.then_some([corner / 3, across as usize / 3])
    })
}

/// Turns the fewer faces of each component until all agree, and keeps `opposite` in step. Returns how
/// many were turned.
pub(in crate::mesh) fn orient(
    simplices: &mut [[u32; 3]],
    opposite: &mut Vec<u32>,
) -> Result<usize, MeshError> {
    if first_clash(simplices, opposite).is_none() {
        return Ok(0);
    }
    let mut side: Vec<Option<bool>> = vec![None; simplices.len()];
    let mut turned = 0;
    let mut component = Vec::new();
    for seed in 0..simplices.len() {
        if side[seed].is_some() {
            continue;
        }
        component.clear();
        component.push(seed);
        side[seed] = Some(false);
        let mut reached = 0;
        while let Some(&face) = component.get(reached) {
            reached += 1;
            for corner in 3 * face as u32..3 * face as u32 + 3 {
                let across = opposite[corner as usize];
                if across == NONE {
                    continue;
                }
                let neighbour = across as usize / 3;
                // The same side where the two agree, the other where they do not.
                let wanted = side[face].map(|s| s == agree(simplices, corner, across));
                match side[neighbour] {
                    None => {
                        side[neighbour] = wanted;
                        component.push(neighbour);
                    }
                    found if found != wanted => {
                        return Err(MeshError::NotOrientable { face: neighbour });
                    }
                    _ => {}
                }
            }
        }
        // The majority stays; on a tie, the first face.
        let against = component.iter().filter(|&&f| side[f] == Some(true)).count();
        if 2 * against > component.len() {
            for &face in &component {
                side[face] = side[face].map(|s| !s);
            }
        }
        turned += against.min(component.len() - against);
    }
    let is_turned = |face: usize| side[face] == Some(true);
    for (face, simplex) in simplices.iter_mut().enumerate() {
        if is_turned(face) {
            simplex.swap(1, 2);
        }
    }
    let moved = |corner: u32| match (is_turned(corner as usize / 3), corner % 3) {
        (true, 1) => corner + 1,
        (true, 2) => corner - 1,
        _ => corner,
    };
    let before = std::mem::replace(opposite, vec![NONE; opposite.len()]);
    for (corner, &across) in before.iter().enumerate() {
        if across != NONE {
            opposite[moved(corner as u32) as usize] = moved(across);
        }
    }
    Ok(turned)
}
