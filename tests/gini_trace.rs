//! What a step goes through: the quadratic problem's iterations, then the polisher's, each with what is wrong there.

mod overlap_problems;

use foldfree::collision::{Boundary, BroadPhase, Pair, intersections};
use foldfree::deformation::{Material, Untangling};
use foldfree::gini::{GiniOptions, TraceState};
use foldfree::mesh::SurfaceMesh;
use foldfree::optim::Status;
use glam::DVec3;
use overlap_problems::*;

fn overlap() -> GiniOptions {
    GiniOptions {
        settle: 0.0,
        ..GiniOptions::overlap()
    }
}

/// Pairs of boundary facets that meet, from the mesh alone.
fn meeting<const D: usize>(simplices: &[u32], positions: &[f64]) -> usize {
    let boundary = Boundary::<D>::new(simplices).expect("a manifold");
    let x: Vec<[f64; D]> = positions.as_chunks::<D>().0.to_vec();
    intersections(&boundary, &x, &mut BroadPhase::default(), 100_000).len()
}

fn volume(x: &[f64], t: [u32; 4]) -> f64 {
    let [a, b, c, d] = t.map(|v| DVec3::from_slice(&x[3 * v as usize..]));
    (b - a).cross(c - a).dot(d - a)
}

/// The states of the quadratic problem begin before its first iteration and end where the polisher begins.
fn joined(u: &Untangling, iterations: usize) {
    let (quadratic, polisher) = (u.quadratic_trace(), u.trace());
    assert_eq!(quadratic.len(), iterations + 1);
    let (last, first) = (quadratic.last().expect("states"), &polisher[0]);
    assert_eq!(last.positions, first.positions);
    assert_eq!(
        (last.inverted, last.violated, last.meeting),
        (first.inverted, first.violated, first.meeting)
    );
    assert!(quadratic.iter().all(|state| state.zones.is_empty()));
}

#[test]
fn every_iteration_of_both_is_seen() {
    let problem = interlocked_arms(1);
    let Moves {
        rest,
        start,
        pins,
        moves,
    } = &problem;
    let material = Material::Arap;
    let mut u = Untangling::of_solid(rest, start, pins, &[], material, &overlap()).expect("free");
    u.set_trace(true);
    let (mut longest, mut wrong, mut zoned) = (0, 0, 0);
    let mut kinds = [[0; 2]; 2];
    for pins in moves {
        u.move_pins(pins).expect("pins");
        while u.solver().status() == Status::Running {
            let report = u.step().expect("a step");
            let gini = report.gini.expect("of gini");
            joined(&u, gini.qp_iterations);
            assert_eq!(u.trace().len(), gini.polish.len() + 1);
            longest = longest.max(gini.qp_iterations);
            for state in u.quadratic_trace().iter().chain(u.trace()) {
                let x = &state.positions;
                let inverted = rest.simplices.iter().filter(|t| !(volume(x, **t) > 0.0));
                assert_eq!(state.inverted, inverted.count());
                let simplices = rest.simplices.as_flattened();
                assert_eq!(state.meeting, Some(meeting::<3>(simplices, x)));
                wrong += state.meeting.unwrap_or_default();
                for contact in &state.contacts {
                    kinds[usize::from(contact.pair == Pair::EdgeEdge)]
                        [usize::from(contact.active)] += 1;
                    zoned += usize::from(contact.zone > 0);
                    let [a, b, c, d] = contact.vertices;
                    // the two hooks are different bodies; parts of one have no vertex in common
                    assert!(a != c && a != d && b != c && b != d);
                }
            }
            for (state, step) in u.trace().iter().zip(&gini.polish) {
                let elements = state.zones.iter().copied();
                let contacts = state.contacts.iter().map(|c| c.zone);
                let zones = elements.chain(contacts).max().unwrap_or_default();
                assert_eq!(zones as usize, step.zones);
                assert_eq!(
                    (state.inverted, state.violated),
                    (step.inverted, step.violated)
                );
                let active = state.contacts.iter().filter(|c| c.active).count();
                assert!(active <= step.collisions);
                assert_eq!(active > 0, step.collisions > 0);
            }
        }
    }
    assert!(
        longest > 3 && wrong > 0 && zoned > 0,
        "{longest} {wrong} {zoned}"
    );
    assert!(kinds[0][1] > 0 && kinds[1][1] > 0, "{kinds:?}");
    let free = u.trace().last().expect("states");
    assert_eq!((free.inverted, free.meeting), (0, Some(0)));
}

#[test]
fn in_the_plane_and_without_overlap() {
    let problem = interlocked_arms_in_the_plane(2);
    let Moves {
        rest,
        start,
        pins,
        moves,
    } = &problem;
    let material = Material::Arap;
    let mut u = Untangling::of_plane(rest, start, pins, &[], material, &overlap()).expect("free");
    u.set_trace(true);
    u.move_pins(&moves[0]).expect("pins");
    let report = u.step().expect("a step");
    joined(&u, report.gini.expect("of gini").qp_iterations);
    for state in u.quadratic_trace().iter().chain(u.trace()) {
        let simplices = rest.simplices.as_flattened();
        assert_eq!(
            state.meeting,
            Some(meeting::<2>(simplices, &state.positions))
        );
        assert!(
            state
                .contacts
                .iter()
                .all(|c| c.pair == Pair::VertexFace && c.vertices[2] == c.vertices[3])
        );
    }
    assert!(u.trace().iter().any(|state| !state.contacts.is_empty()));

    // folded, nothing held: its centroid stays in every state
    let mut start: Vec<DVec3> = rest.positions.clone();
    start.iter_mut().for_each(|p| p.x *= -0.3 * p.y);
    let options = GiniOptions::default();
    let folded = |rest: &SurfaceMesh| {
        Untangling::of_plane(rest, &start, &[], &[], material, &options).expect("a problem")
    };
    let mut u = folded(rest);
    u.set_trace(true);
    let mut plain = folded(rest);
    let mut states: Vec<TraceState> = Vec::new();
    for _ in 0..3 {
        let report = u.step().expect("a step");
        joined(&u, report.gini.expect("of gini").qp_iterations);
        states.extend_from_slice(u.quadratic_trace());
        plain.step().expect("a step");
        assert_eq!(u.positions(), plain.positions(), "a trace changes nothing");
    }
    assert!(plain.trace().is_empty() && plain.quadratic_trace().is_empty());
    let left = |x: &[f64]| x.as_chunks::<2>().0.iter().map(|p| p[0]).sum::<f64>();
    let first = left(&states[0].positions);
    assert!(
        states
            .iter()
            .all(|s| s.meeting.is_none() && s.contacts.is_empty())
    );
    // both hooks float; the sum of their centroids, by vertices alike
    assert!(
        states
            .iter()
            .all(|s| (left(&s.positions) - first).abs() < 1e-9 * first.abs().max(1.0))
    );
    u.set_trace(false);
    u.step().expect("a step");
    assert!(u.trace().is_empty() && u.quadratic_trace().is_empty());
}
