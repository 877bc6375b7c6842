//! Continuous collision detection against exact arithmetic: nothing is missed, and no time is later than the impact.

mod ccd_oracle;

use ccd_oracle::motion::Motion;
use ccd_oracle::queries::{Kind, Whole, query};
use dashu_ratio::RBig;
use foldfree::collision::{Pair, time_of_impact};

fn points<const D: usize>(p: &[[i64; 3]; 4], shift: f64) -> [[f64; D]; 4] {
    p.map(|p| std::array::from_fn(|i| p[i] as f64 + shift))
}

/// The solver's answer; moved away from the origin by a number that keeps all coordinates exact.
fn answer(m: &Motion, kind: Kind, shift: f64, gap: f64) -> Option<f64> {
    if kind == Kind::VertexAndEdgeInThePlane {
        let (from, to) = (points::<2>(&m.from, shift), points::<2>(&m.to, shift));
        return time_of_impact(m.pair, &from, &to, gap);
    }
    time_of_impact(
        m.pair,
        &points::<3>(&m.from, shift),
        &points::<3>(&m.to, shift),
        gap,
    )
}

#[test]
fn nothing_is_missed() {
    let mut random = Whole(6);
    for kind in Kind::ALL {
        let (mut meetings, mut wrong) = (0, 0);
        const QUERIES: usize = 500;
        for _ in 0..QUERIES {
            let m = query(kind, &mut random);
            let exact = m.first_meeting();
            for (shift, gap) in [(0.0, 0.0), (2f64.powi(30), 0.0), (0.0, f64::INFINITY)] {
                let found = answer(&m, kind, shift, gap);
                match (&exact, found) {
                    (Some(exact), Some(t)) => {
                        let t = RBig::try_from(t).expect("finite");
                        assert!(t >= RBig::ZERO && t <= *exact, "{kind:?} {m:?} {t} {exact}");
                    }
                    (Some(exact), None) => panic!("missed: {kind:?} {m:?} {exact}"),
                    (None, Some(_)) => wrong += usize::from(gap == 0.0),
                    (None, None) => {}
                }
            }
            meetings += usize::from(exact.is_some());
        }
        assert!(
            meetings > QUERIES / 200,
            "{kind:?} is no test: {meetings} meetings"
        );
        // two answers a query; only what passes by at 1e-9 of its size is not always told apart
        let most = match kind {
            Kind::NearlyTouchingHalfway => QUERIES / 25,
            _ => QUERIES / 200,
        };
        assert!(wrong <= most, "{kind:?}: {wrong} false positives");
    }
}

#[test]
fn the_oracle_knows_what_everyone_knows() {
    let falling = |x: i64, z: i64| Motion {
        pair: Pair::VertexFace,
        from: [[x, 1, 4], [0, 0, 0], [8, 0, 0], [0, 8, 0]],
        to: [[x, 1, z], [0, 0, 0], [8, 0, 0], [0, 8, 0]],
    };
    let half = RBig::from(1) / RBig::from(2);
    assert_eq!(falling(1, -4).first_meeting(), Some(half.clone()));
    assert_eq!(falling(1, 0).first_meeting(), Some(RBig::ONE));
    assert_eq!(falling(1, 1).first_meeting(), None);
    assert_eq!(falling(8, -4).first_meeting(), None);
    assert_eq!(falling(7, -4).first_meeting(), Some(half.clone()));
    // edges that cross, that pass each other, that slide onto each other in one line
    let edges = |from: [[i64; 3]; 2], to: [[i64; 3]; 2]| Motion {
        pair: Pair::EdgeEdge,
        from: [from[0], from[1], [-2, 0, 0], [2, 0, 0]],
        to: [to[0], to[1], [-2, 0, 0], [2, 0, 0]],
    };
    let cross = edges([[0, -1, 2], [0, 1, 2]], [[0, -1, -2], [0, 1, -2]]);
    assert_eq!(cross.first_meeting(), Some(half.clone()));
    let beside = edges([[3, -1, 2], [3, 1, 2]], [[3, -1, -2], [3, 1, -2]]);
    assert_eq!(beside.first_meeting(), None);
    let line = edges([[4, 0, 0], [6, 0, 0]], [[0, 0, 0], [2, 0, 0]]);
    assert_eq!(line.first_meeting(), Some(half));
}
