//! What happened: the iterates of the run on the bench and the curves of the runs before it.

/// What an iteration spent its time on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Phase {
    /// Which phase.
    pub kind: PhaseKind,
    /// How often it was done (for the global step: L-BFGS iterations or linear solves).
    pub count: u32,
    /// Time taken, in milliseconds.
    pub milliseconds: f64,
}

/// The phases of an iteration, in the order of the `phases` codes of the page.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PhaseKind {
    /// Every element on its own.
    Local,
    /// The vertices, all together.
    Global,
    /// New weights, and a new factorisation.
    Reweight,
    /// Energy, inverted elements, termination.
    Evaluate,
}

impl PhaseKind {
    /// From the code the page's JavaScript uses.
    pub fn from_code(code: f64) -> Self {
        match code as i64 {
            0 => Self::Local,
            1 => Self::Global,
            2 => Self::Reweight,
            _ => Self::Evaluate,
        }
    }
}

/// The numbers of one iterate.
#[derive(Debug, Clone, PartialEq)]
pub struct Record {
    /// 0 is the start.
    pub iteration: u32,
    /// Energy, relative: to the area of a surface, to the volume and stiffness of a solid.
    pub energy: f64,
    /// Inverted elements: triangles, tetrahedra.
    pub inverted: u32,
    /// Length of the gradient, relative as the energy.
    pub gradient_norm: f64,
    /// Smallest singular value over the elements.
    pub smallest_sigma: f64,
    /// Largest singular value over the elements.
    pub largest_sigma: f64,
    /// L-BFGS iterations of the global step.
    pub lbfgs_iterations: u32,
    /// Whether the weights changed after this iteration.
    pub reweighted: bool,
    /// Seconds since the solver started, setup apart.
    pub seconds: f64,
    /// Of a method in two stages: the iteration with which the first ended, once it has.
    pub switched_at: Option<u32>,
    /// Of a locally injective mapping: what the step was made with.
    pub lim: Option<LimStep>,
    /// Of an untangling: which part of which step this is, and what is wrong then.
    pub moment: Option<Moment>,
    /// The phases of the iteration that led here.
    pub phases: Vec<Phase>,
}

/// What a step of a locally injective mapping was made with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LimStep {
    /// α, how hard handles are led to their targets.
    pub alpha: f64,
    /// μ, what the diagonal needed for the matrix to be positive definite.
    pub mu: f64,
    /// σ, the part of the direction that was gone.
    pub sigma: f64,
    /// The largest distance of a handle from its target, relative.
    pub error: f64,
    /// β Σ φ.
    pub barrier: f64,
    /// Handles that are at their targets, and all.
    pub arrived: [u32; 2],
}

/// A part of a step of an untangling. Counts of three are of what the step works on, of the state that is handed out, and
/// of the primary solver's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moment {
    /// Which part.
    pub part: Part,
    /// Which iteration of the quadratic problem or the polisher; and how many the polisher has in this step.
    pub polish: [u32; 2],
    /// Inverted elements.
    pub inverted: [u32; 3],
    /// Elements below their least measure, of what the step works on, where they are counted.
    pub violated: Option<u32>,
    /// Zones of violated constraints.
    pub zones: u32,
    /// Iterations of the quadratic problem.
    pub solves: u32,
    /// Its constraints, and those that are active.
    pub constraints: [u32; 2],
    /// What becomes of what the step worked on.
    pub fate: Fate,
    /// The least η of an element, and the one they began with, relative to the measure at rest.
    pub offset: [f64; 2],
    /// Elements whose η was reduced.
    pub reduced: u32,
    /// The smallest measure of an element of the state that is handed out, relative to that at rest.
    pub smallest: f64,
    /// Where the boundary must not pass through itself: pairs of facets that do, of what the step works on, where they
    /// are counted.
    pub meeting: Option<u32>,
}

/// Where a step of an untangling has what is handed out, x.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fate {
    /// Where it was.
    Stays,
    /// A part of the way to what was polished.
    Partway,
    /// At what was polished.
    Reached,
}

/// The parts of a step of an untangling, in their order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// No step yet.
    Start,
    /// Every element on its own.
    Local,
    /// The quadratic problem.
    Quadratic,
    /// An iteration of the polisher.
    Polish,
    /// What comes of the step.
    Outcome,
}

impl Part {
    fn from_code(code: f64) -> Self {
        match code as i64 {
            0 => Self::Start,
            1 => Self::Local,
            2 => Self::Quadratic,
            3 => Self::Polish,
            _ => Self::Outcome,
        }
    }
}

/// How many numbers the page sends with an iterate, phases apart.
pub const RECORD_WIDTH: usize = 10;

impl Record {
    /// From the page's typed arrays: [`RECORD_WIDTH`] numbers in the order of the fields (−1 for a switch that
    /// has not been), and three (kind, count, milliseconds) for every phase. `None` if the first is too short.
    ///
    /// Behind them may stand the seven of a [`LimStep`], or the eighteen of a [`Moment`].
    pub fn from_numbers(numbers: &[f64], phases: &[f64]) -> Option<Self> {
        let (numbers, own) = numbers.split_at_checked(RECORD_WIDTH)?;
        let moment = Moment::from_numbers(own);
        let lim = match *own {
            [alpha, mu, sigma, error, barrier, arrived, all] => Some(LimStep {
                alpha,
                mu,
                sigma,
                error,
                barrier,
                arrived: [arrived as u32, all as u32],
            }),
            _ => None,
        };
        let &[
            iteration,
            energy,
            inverted,
            gradient_norm,
            smallest_sigma,
            largest_sigma,
            lbfgs,
            reweighted,
            seconds,
            switched_at,
        ] = numbers
        else {
            return None;
        };
        Some(Self {
            iteration: iteration as u32,
            energy,
            inverted: inverted as u32,
            gradient_norm,
            smallest_sigma,
            largest_sigma,
            lbfgs_iterations: lbfgs as u32,
            reweighted: reweighted != 0.0,
            seconds,
            switched_at: (switched_at >= 0.0).then_some(switched_at as u32),
            lim,
            moment,
            phases: phases
                .as_chunks::<3>()
                .0
                .iter()
                .map(|&[kind, count, milliseconds]| Phase {
                    kind: PhaseKind::from_code(kind),
                    count: count as u32,
                    milliseconds,
                })
                .collect(),
        })
    }

    /// max(σ₁, 1/σ of the last) over the elements; infinite while one is inverted or collapsed. Of an untangling that of the
    /// state that is handed out.
    pub fn worst_distortion(&self) -> f64 {
        let inverted = self.moment.map_or(self.inverted, |m| m.inverted[1]);
        if self.smallest_sigma > 0.0 && inverted == 0 {
            self.largest_sigma.max(1.0 / self.smallest_sigma)
        } else {
            f64::INFINITY
        }
    }
}

impl Moment {
    /// From the numbers of the page: part, iteration, how many the polisher has, three counts of inverted
    /// elements, violated constraints (−1: not counted), zones, iterations of the quadratic problem, its constraints and active ones,
    /// whether x moved and whether it got there, least and first η, how many are reduced, smallest measure, pairs that meet (−1: not counted).
    fn from_numbers(numbers: &[f64]) -> Option<Self> {
        let &[
            part,
            polish,
            polishes,
            trial,
            result,
            primary,
            violated,
            zones,
            solves,
            constraints,
            active,
            moved,
            reached,
            least,
            first,
            reduced,
            smallest,
            meeting,
        ] = numbers
        else {
            return None;
        };
        Some(Self {
            part: Part::from_code(part),
            polish: [polish as u32, polishes as u32],
            inverted: [trial as u32, result as u32, primary as u32],
            violated: (violated >= 0.0).then_some(violated as u32),
            zones: zones as u32,
            solves: solves as u32,
            constraints: [constraints as u32, active as u32],
            fate: match (moved != 0.0, reached != 0.0) {
                (_, true) => Fate::Reached,
                (true, false) => Fate::Partway,
                (false, false) => Fate::Stays,
            },
            offset: [least, first],
            reduced: reduced as u32,
            smallest,
            meeting: (meeting >= 0.0).then_some(meeting as u32),
        })
    }
}

/// The states of an untangling.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum State {
    /// What a step works on, x̂ of the paper.
    #[default]
    Trial,
    /// x, which is handed out.
    Result,
    /// x̄, the primary solver's.
    Primary,
}

impl State {
    /// From the page's name for it.
    pub fn from_name(name: &str) -> Option<Self> {
        match name {
            "trial" => Some(Self::Trial),
            "result" => Some(Self::Result),
            "primary" => Some(Self::Primary),
            _ => None,
        }
    }

    /// What it is called in a heading.
    pub fn title(self) -> &'static str {
        match self {
            Self::Trial => "Being polished",
            Self::Result => "Handed out",
            Self::Primary => "Primary solver",
        }
    }
}

/// One run of a solver.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Run {
    /// Method, kebab-case.
    pub method: String,
    /// Where it started, kebab-case.
    pub start: String,
    /// Its iterates' numbers.
    pub records: Vec<Record>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn records_come_from_numbers() {
        let r = Record::from_numbers(
            &[3.0, 1.5, 0.0, 1e-3, 0.5, 1.25, 2.0, 1.0, 0.25, 2.0],
            &[0.0, 1.0, 4.5, 1.0, 2.0, 3.5],
        )
        .unwrap();
        assert_eq!(
            (r.iteration, r.lbfgs_iterations, r.reweighted),
            (3, 2, true)
        );
        assert_eq!(
            r.phases[1],
            Phase {
                kind: PhaseKind::Global,
                count: 2,
                milliseconds: 3.5
            }
        );
        assert_eq!((r.worst_distortion(), r.switched_at), (2.0, Some(2)));
        assert!(Record::from_numbers(&[1.0], &[]).is_none());
        let mut lim = [0.0; 17];
        lim[10..].copy_from_slice(&[1e8, 0.1, 0.5, 0.25, 0.02, 3.0, 4.0]);
        let step = Record::from_numbers(&lim, &[]).and_then(|r| r.lim).unwrap();
        assert_eq!((step.alpha, step.arrived), (1e8, [3, 4]));
        let mut moment = [0.0; 28];
        moment[10..].copy_from_slice(&[
            3.0, 2.0, 5.0, 7.0, 9.0, 8.0, 20.0, 4.0, 50.0, 30.0, 12.0, 1.0, 0.0, 0.01, 0.1, 6.0,
            -0.5, 11.0,
        ]);
        let record = Record::from_numbers(&moment, &[]).unwrap();
        assert_eq!(record.lim, None);
        let m = record.moment.unwrap();
        assert_eq!(
            (m.part, m.polish, m.inverted),
            (Part::Polish, [2, 5], [7, 9, 8])
        );
        assert_eq!(
            (m.constraints, m.offset, m.fate),
            ([30, 12], [0.01, 0.1], Fate::Partway)
        );
        assert_eq!((m.violated, m.meeting), (Some(20), Some(11)));
        for (moved, reached, fate) in [(0.0, 0.0, Fate::Stays), (1.0, 1.0, Fate::Reached)] {
            [moment[21], moment[22]] = [moved, reached];
            let record = Record::from_numbers(&moment, &[]).unwrap();
            assert_eq!(record.moment.map(|m| m.fate), Some(fate));
        }
        // it is x whose stretch is told, whatever is wrong in what is worked on
        let mut record = record.clone();
        (record.smallest_sigma, record.largest_sigma, record.inverted) = (0.5, 1.5, 7);
        assert_eq!(record.worst_distortion(), f64::INFINITY);
        record.moment = record.moment.map(|m| Moment {
            inverted: [7, 0, 8],
            ..m
        });
        assert_eq!(record.worst_distortion(), 2.0);
    }

    #[test]
    fn an_inverted_map_has_no_finite_distortion() {
        let r = Record::from_numbers(&[0.0, 9.0, 4.0, 0.0, -0.5, 1.0, 0.0, 0.0, 0.0, -1.0], &[])
            .unwrap();
        assert_eq!(r.worst_distortion(), f64::INFINITY);
        assert_eq!(r.switched_at, None);
    }
}
