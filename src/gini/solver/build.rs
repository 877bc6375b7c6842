//! What is done once.

use super::overlap::Window;
use super::{Best, Gini};
use crate::collision::Boundary;
use crate::energy::Energy;
use crate::geometry::{Elimination, RestShape};
use crate::gini::admm::{Admm, Body};
use crate::gini::contacts::Contacts;
use crate::gini::elements::Elements;
use crate::gini::outcome::MOST_PAIRS;
use crate::gini::problem::{image_measure, is_enclosed, not_positive};
use crate::gini::set::ConstraintSet;
use crate::gini::zones::Zones;
use crate::gini::{GiniOptions, GiniProblem};
use crate::optim::{BuildError, Criterion, Status, StepReport};
use crate::parallel;
use crate::space::Space;
use crate::wrapd::External;
use crate::wrapd::layout::element_order;

/// The mean of these positions.
pub fn centroid<const D: usize>(slots: &[u32], x: &[[f64; D]]) -> [f64; D] {
    let mut sum = [0.0; D];
    for &s in slots {
        (0..D).for_each(|i| sum[i] += x[s as usize][i]);
    }
    sum.map(|s| s / slots.len() as f64)
}

impl<const D: usize> Gini<D> {
    /// Checks the problem, analyses and factors the Laplacian, and looks at the start.
    ///
    /// # Errors
    /// Lengths that do not fit, options out of range, a start that is not finite, pins that leave nothing free. With
    /// overlap `NonManifoldFacet`, and `IntersectingStart` for a boundary that meets itself. `TooLarge` or
    /// `NotPositiveDefinite` for what the linear system cannot hold.
    ///
    /// # Panics
    /// If the space does not have D dimensions.
    pub fn new<S: Space, E: Energy<S>>(
        problem: GiniProblem,
        energy: E,
        options: GiniOptions,
    ) -> Result<Self, BuildError> {
        assert!(
            S::DIM == D && S::STRETCHES == D,
            "a space of {D} dimensions"
        );
        options.validate()?;
        problem.validate(D)?;
        let external = External {
            springs: problem.absolute_springs::<S, E>(&energy, options.target_stiffness),
            ..Default::default()
        };
        parallel::in_pool(|| Self::build(problem, external, Body::new::<S, E>(energy), options))
    }

    fn build(
        problem: GiniProblem,
        external: External,
        body: Body,
        options: GiniOptions,
    ) -> Result<Self, BuildError> {
        let n = problem.start.len() / D;
        let mut used = vec![false; n];
        for &v in &problem.rest.vertices {
            used[v as usize] = true;
        }
        let floating = problem.floating(D);
        let mut is_held: Vec<bool> = used.iter().map(|used| !used).collect();
        problem
            .pins
            .iter()
            .for_each(|&p| is_held[p as usize] = true);
        // of a component that nothing holds one vertex stays where it is in the linear system
        let mut fixed = is_held.clone();
        floating.iter().for_each(|c| fixed[c[0] as usize] = true);
        let fixed: Vec<u32> = (0..n as u32).filter(|&v| fixed[v as usize]).collect();
        let elimination = Elimination::new(problem.rest, n, &fixed);
        let slot = elimination.slot.clone();
        let order = element_order(problem.rest, &slot);
        let rest = problem.rest.reordered(&order);
        let mut x = vec![[0.0; D]; n];
        let mut movable = vec![true; n];
        for (v, position) in problem.start.as_chunks::<D>().0.iter().enumerate() {
            x[slot[v] as usize] = *position;
            movable[slot[v] as usize] = !is_held[v];
        }
        let mut iterate = x.clone();
        let primary = problem.primary.unwrap_or(problem.start);
        for (v, position) in primary.as_chunks::<D>().0.iter().enumerate() {
            if !is_held[v] {
                iterate[slot[v] as usize] = *position;
            }
        }
        let held: Vec<bool> = movable.iter().map(|m| !m).collect();
        let at_rest: f64 = rest.measure.iter().sum();
        // where pins leave less room than there is at rest, every η is less from the beginning
        let corners = &problem.rest.vertices;
        let is_enclosed = is_enclosed::<D>(corners, &is_held);
        let room = match is_enclosed {
            true => image_measure(corners, problem.start.as_chunks::<D>().0).0 / at_rest,
            false => 1.0,
        }
        .clamp(1e-6, 1.0);
        let first_offset = room * options.offset;
        let elements = Elements::new(&rest, &slot, &held, first_offset);
        let admm = Admm::new(
            body,
            &rest,
            order.clone(),
            &elimination,
            problem.start,
            &external,
        )?;
        let size = at_rest.powf(1.0 / D as f64);
        let contacts = match options.overlap {
            true => Some(build_contacts(problem.rest, &slot, &x, &options)?),
            false => None,
        };
        let goals = (0..n as u32).filter(|&s| held[s as usize]);
        let goals = goals.map(|s| (s, x[s as usize])).collect();
        let mut values = vec![0.0; elements.len()];
        elements.values(&x, &mut values);
        let mut set = ConstraintSet::new(elements.len());
        set.add_elements(&elements, &values);
        let floating = floating.into_iter().map(|component| {
            let slots: Vec<u32> = component.iter().map(|&v| slot[v as usize]).collect();
            let centroid = centroid(&slots, &x);
            (slots, centroid)
        });
        let mut this = Self {
            options,
            admm,
            order,
            corners: problem.rest.vertices.clone(),
            floating: floating.collect(),
            set,
            zones: Zones::new(n),
            contacts,
            goals,
            arrived: true,
            stride: 1.0,
            failures: 0,
            moved: f64::INFINITY,
            window: Window::new(if options.overlap { &x } else { &[] }),
            size,
            iterate,
            trial: x.clone(),
            trial_values: values.clone(),
            step: vec![[0.0; D]; elimination.free],
            trace: None,
            best: Best {
                inverted: usize::MAX,
                smallest: f64::NEG_INFINITY,
                x: x.clone(),
            },
            positions: problem.start.to_vec(),
            hopeless: Vec::new(),
            hopeless_measure: None,
            is_enclosed,
            first_offset,
            begins_anew: true,
            has_unwound: false,
            idle: 0,
            report: StepReport::at_start(),
            elements,
            slot,
            movable,
            x,
            values,
        };
        this.remember(this.count_inverted());
        this.look();
        this.judge();
        Ok(this)
    }

    /// The status of the start: there already, or out of reach of any map with these pins.
    fn judge(&mut self) {
        self.foresee();
        self.report.status = match () {
            _ if self.is_done() => Status::Converged(Criterion::Injective),
            _ if !self.hopeless.is_empty() || self.hopeless_measure.is_some() => Status::Stalled,
            _ if self.options.max_iterations == 0 => Status::MaxIterations,
            () => Status::Running,
        };
    }
}

impl<const D: usize> Gini<D> {
    /// What of the map is decided by where pins are to be, and is not injective.
    pub(super) fn foresee(&mut self) {
        let is_held: Vec<bool> = self
            .slot
            .iter()
            .map(|&s| !self.movable[s as usize])
            .collect();
        let mut points = self.x.clone();
        for &(slot, goal) in &self.goals {
            points[slot as usize] = goal;
        }
        let points: Vec<[f64; D]> = self.slot.iter().map(|&s| points[s as usize]).collect();
        let simplices = self.corners.chunks_exact(D + 1).zip(0..);
        let held = simplices.filter(|(s, _)| s.iter().all(|&v| is_held[v as usize]));
        let (corners, elements): (Vec<&[u32]>, Vec<u32>) = held.unzip();
        let inverted = not_positive(D, &corners.concat(), points.as_flattened());
        self.hopeless = inverted.iter().map(|&k| elements[k as usize]).collect();
        self.hopeless_measure = None;
        if self.is_enclosed {
            let (image, error) = image_measure(&self.corners, &points);
            self.hopeless_measure = (image <= error).then_some(image);
        }
    }
}

/// The boundary and its contacts; an error if it meets itself at the start.
fn build_contacts<const D: usize>(
    rest: &RestShape,
    slot: &[u32],
    x: &[[f64; D]],
    options: &GiniOptions,
) -> Result<Contacts<D>, BuildError> {
    let elements: Vec<u32> = rest.vertices.iter().map(|&v| slot[v as usize]).collect();
    let mut vertex = vec![0; slot.len()];
    (0..).zip(slot).for_each(|(v, &s)| vertex[s as usize] = v);
    let boundary = Boundary::<D>::new(&elements).map_err(|e| BuildError::NonManifoldFacet {
        vertices: e.vertices.map(|s| vertex[s as usize]),
        elements: e.elements,
    })?;
    let measure: f64 = rest.measure.iter().sum();
    let root = |measure: f64| measure.powf(1.0 / D as f64);
    let size = root(measure).min(100.0 * root(measure / rest.len() as f64));
    let mut contacts = Contacts::new(boundary, elements, x.len(), options.contact_offset * size);
    let meeting = contacts.intersections(x, MOST_PAIRS);
    if !meeting.is_empty() {
        let facet = |f: u32| {
            let facet = contacts.facets()[f as usize];
            std::array::from_fn(|i| vertex[facet[i.min(D - 1)] as usize])
        };
        let pairs = meeting.iter().map(|pair| pair.map(facet)).collect();
        return Err(BuildError::IntersectingStart { pairs });
    }
    Ok(contacts)
}
