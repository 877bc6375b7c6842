//! Continuous collision detection on a million random and degenerate queries, against exact arithmetic: misses (there
//! are to be none), false positives, times.
//!
//! `cargo run --release --example ccd [queries]`

#[path = "../tests/ccd_oracle/mod.rs"]
mod ccd_oracle;

use ccd_oracle::queries::{Kind, Whole, query};
use dashu_ratio::RBig;
use foldfree::collision::time_of_impact;
use foldfree::optim::Stopwatch;

fn main() {
    let count = std::env::args().nth(1).and_then(|n| n.parse().ok());
    let count: usize = count.unwrap_or(1_000_000);
    let each = count.div_ceil(Kind::ALL.len());
    let mut random = Whole(1);
    println!(
        "kind, queries, meetings, missed, late, false positives (and of algorithm 1 with s = 0.1), ns a query"
    );
    let (mut missed_in_all, mut wrong_in_all) = (0, 0);
    for kind in Kind::ALL {
        let motions: Vec<_> = (0..each).map(|_| query(kind, &mut random)).collect();
        let clock = Stopwatch::start();
        let answers: Vec<[Option<f64>; 2]> = motions
            .iter()
            .map(|m| {
                [0.0, f64::INFINITY].map(|gap| {
                    if kind == Kind::VertexAndEdgeInThePlane {
                        let [from, to] =
                            [m.from, m.to].map(|p| p.map(|p| [p[0] as f64, p[1] as f64]));
                        return time_of_impact(m.pair, &from, &to, gap);
                    }
                    let [from, to] = [m.from, m.to].map(|p| p.map(|p| p.map(|x| x as f64)));
                    time_of_impact(m.pair, &from, &to, gap)
                })
            })
            .collect();
        let nanoseconds = (1e9 * clock.seconds()) as usize / (2 * each);
        let (mut meetings, mut missed, mut late, mut wrong) = (0, 0, 0, [0, 0]);
        for (m, answers) in motions.iter().zip(answers) {
            let exact = m.first_meeting();
            meetings += usize::from(exact.is_some());
            for (answer, wrong) in answers.iter().zip(&mut wrong) {
                match (&exact, answer) {
                    (Some(exact), Some(t)) => {
                        let t = RBig::try_from(*t).expect("a finite time");
                        late += usize::from(t > *exact);
                    }
                    (Some(_), None) => missed += 1,
                    (None, Some(_)) => *wrong += 1,
                    (None, None) => {}
                }
            }
        }
        println!(
            "{:24} {each} {meetings:6} {missed} {late} {:5} ({:6}) {nanoseconds}",
            format!("{kind:?}"),
            wrong[0],
            wrong[1]
        );
        missed_in_all += missed + late;
        wrong_in_all += wrong[0];
    }
    println!(
        "{} queries: {missed_in_all} missed or late, {wrong_in_all} false positives",
        each * Kind::ALL.len()
    );
}
