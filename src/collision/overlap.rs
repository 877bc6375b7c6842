//! What lies inside another body though no boundaries meet.
//!
//! Where no element is inverted, the number of elements over a point is the winding number of the boundary around it.
//! Where boundaries do not meet it changes at boundaries alone, by one, and every region that they bound has one of
//! their connected parts at its rim. So if no part has a vertex inside an element that is not its own, there is no
//! point over which there are two elements: the map is injective.

use super::Boundary;
use crate::boxes::{Bounds, Tree};
use crate::certificate::{orientation, orientation_of_tetrahedron};
use glam::{DVec2, DVec3};
use std::cmp::Ordering;

/// Pairs (vertex, element): one vertex of each connected part of the boundary, with the elements that it is in
/// without being a corner; sorted. By exact predicates. `elements` has D + 1 vertices for each, and none may be
/// inverted.
pub fn overlaps<const D: usize>(
    boundary: &Boundary<D>,
    elements: &[u32],
    positions: &[[f64; D]],
) -> Vec<[u32; 2]> {
    let around = |element: &[u32]| {
        let corners = element.iter().map(|&v| positions[v as usize]);
        corners.fold(Bounds::EMPTY, Bounds::with)
    };
    let boxes: Vec<Bounds<D>> = elements.chunks_exact(D + 1).map(around).collect();
    let tree = Tree::new(&boxes);
    let mut found = Vec::new();
    for vertex in boundary.representatives() {
        tree.at(positions[vertex as usize], &boxes, &mut |e| {
            let element = &elements[(D + 1) * e as usize..(D + 1) * (e as usize + 1)];
            if !element.contains(&vertex) && contains::<D>(element, vertex, positions) {
                found.push([vertex, e]);
            }
        });
    }
    found.sort_unstable();
    found
}

/// Is the vertex in the closed positive element?
fn contains<const D: usize>(element: &[u32], vertex: u32, positions: &[[f64; D]]) -> bool {
    (0..=D).all(|replaced| {
        let at = |i: usize| {
            let v = if i == replaced { vertex } else { element[i] };
            positions[v as usize]
        };
        let sign = match D {
            2 => {
                let [a, b, c] = [0, 1, 2].map(|i| DVec2::new(at(i)[0], at(i)[1]));
                orientation(a, b, c)
            }
            _ => {
                let point = |i: usize| DVec3::new(at(i)[0], at(i)[1], at(i)[2]);
                orientation_of_tetrahedron(point(0), point(1), point(2), point(3))
            }
        };
        sign != Ordering::Less
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_body_inside_another_is_found() {
        let elements = [0, 1, 2, 3, 4, 5, 6, 7];
        let boundary = Boundary::<3>::new(&elements).expect("two tetrahedra");
        let corners = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let with = |scale: f64, shift: f64| -> Vec<[f64; 3]> {
            let second = corners.map(|c| c.map(|x| scale * x + shift));
            corners.into_iter().chain(second).collect()
        };
        assert_eq!(overlaps(&boundary, &elements, &with(0.1, 0.1)), [[4, 0]]);
        assert_eq!(overlaps(&boundary, &elements, &with(9.0, -1.0)), [[0, 1]]);
        assert!(overlaps(&boundary, &elements, &with(1.0, 0.4)).is_empty());
    }

    #[test]
    fn in_the_plane_too() {
        let elements = [0, 1, 2, 3, 4, 5];
        let boundary = Boundary::<2>::new(&elements).expect("two triangles");
        let corners = [[0.0; 2], [1.0, 0.0], [0.0, 1.0]];
        let second = corners.map(|c| c.map(|x| 0.1 * x + 0.2));
        let x: Vec<[f64; 2]> = corners.into_iter().chain(second).collect();
        assert_eq!(overlaps(&boundary, &elements, &x), [[3, 0]]);
    }
}
