//! Bodies whose wanted boundary passes through itself: it is parted by a flow, and pulled back as near as it can come
//! without meeting itself.

mod flow_problems;
mod overlap_problems;

use flow_problems::*;
use foldfree::Error;
use foldfree::certificate::{Certificate, SolidCertificate};
use foldfree::collision::{Boundary, BroadPhase, intersections};
use foldfree::deformation::{Material, Target, Untangling};
use foldfree::gini::GiniOptions;
use foldfree::optim::{BuildError, GiniStep, Status};
use glam::{DQuat, DVec2, DVec3};

/// Springs that count, and steps enough to see them.
fn options() -> GiniOptions {
    GiniOptions {
        target_stiffness: 1e-2,
        max_iterations: 30,
        ..GiniOptions::overlap()
    }
}

fn solid(wanted: &Wanted<4>, pins: &[u32], material: Material) -> Result<Untangling, Error> {
    let (rest, start) = (&wanted.rest, &wanted.start);
    Untangling::through_flow(rest, start, pins, &[], material, &options())
}

fn plane(wanted: &Wanted<3>) -> Result<Untangling, Error> {
    let (rest, start) = (&wanted.rest, &wanted.start);
    Untangling::through_flow_in_plane(rest, start, &[], &[], Material::Arap, &options())
}

/// How far the boundary is from where it is wanted.
struct Distance {
    /// Root of the mean square.
    mean: f64,
    /// Most of those vertices that are wanted at least a thickness away from where the boundary meets itself.
    elsewhere: f64,
}

/// The boundary of a body and of what is wanted, in `D` dimensions.
struct Watch<'a, const D: usize> {
    boundary: Boundary<D>,
    wanted: &'a [DVec3],
    /// Where the wanted boundary meets itself.
    crossing: Vec<DVec3>,
}

impl<'a, const D: usize> Watch<'a, D> {
    fn new(simplices: &[u32], wanted: &'a [DVec3]) -> Self {
        let boundary = Boundary::<D>::new(simplices).expect("a manifold");
        let meeting = meeting(&boundary, wanted);
        let corners = |f: &u32| boundary.facets[*f as usize];
        let vertices = meeting.as_flattened().iter().flat_map(corners);
        let crossing = vertices.map(|v| wanted[v as usize]).collect();
        Self {
            crossing,
            boundary,
            wanted,
        }
    }

    fn distance(&self, x: &[DVec3]) -> Distance {
        let (mut squares, mut elsewhere) = (0.0, 0.0f64);
        for &v in &self.boundary.vertices {
            let to = self.wanted[v as usize];
            let distance = to.distance(x[v as usize]);
            squares += distance * distance;
            if self.crossing.iter().all(|c| c.distance(to) > 1.0) {
                elsewhere = elsewhere.max(distance);
            }
        }
        let count = self.boundary.vertices.len() as f64;
        Distance {
            mean: (squares / count).sqrt(),
            elsewhere,
        }
    }

    /// Runs to its end, looking at every state. Returns what the first step did.
    fn run(&self, u: &mut Untangling) -> GiniStep {
        let mut first = None;
        assert!(meeting(&self.boundary, &u.positions()).is_empty());
        while u.solver().status() == Status::Running {
            let report = u.step().expect("a step");
            first = first.or(report.gini);
            assert!(meeting(&self.boundary, &u.positions()).is_empty());
        }
        first.expect("a step")
    }
}

/// Facets that meet, by the exact test.
fn meeting<const D: usize>(boundary: &Boundary<D>, x: &[DVec3]) -> Vec<[u32; 2]> {
    let x: Vec<[f64; D]> = x.iter().map(|p| std::array::from_fn(|i| p[i])).collect();
    intersections(boundary, &x, &mut BroadPhase::default(), 100_000)
}

/// The way from the wanted surface over the flow to the end, for a solid.
fn comes_apart(name: &str, wanted: &Wanted<4>, material: Material) {
    let watch = Watch::<3>::new(wanted.rest.simplices.as_flattened(), &wanted.start);
    assert!(
        !watch.crossing.is_empty(),
        "the wanted surface meets itself"
    );
    let mut u = solid(wanted, &[], material).expect("comes apart");
    let flowed = u.flowed().expect("flowed").clone();
    assert!(flowed.steps > 0 && flowed.pairs.len() == flowed.steps + 1);
    assert_eq!((flowed.pairs[0] > 0, flowed.pairs[flowed.steps]), (true, 0));
    let begin = watch.distance(&u.positions());
    let first = watch.run(&mut u);
    let (end, outcome) = (watch.distance(&u.positions()), u.outcome());
    println!(
        "{name}: {} tetrahedra, pairs {:?}; inverted after the quadratic problem of the first step {}, accepted {}; mean distance {:.3} -> {:.3}, elsewhere {:.3} -> {:.3}, {} steps",
        wanted.rest.simplices.len(),
        flowed.pairs,
        first.inverted_iterate,
        first.accepted,
        begin.mean,
        end.mean,
        begin.elsewhere,
        end.elsewhere,
        u.solver().report().iteration
    );
    assert_eq!(outcome.globally_injective, Some(true), "{outcome:?}");
    assert!(SolidCertificate::of_solid(&wanted.rest, &u.positions()).locally_injective);
    // the paper: one inversion of 31,197 tetrahedra after the first step
    assert!(50 * first.inverted_iterate <= wanted.rest.simplices.len());
    assert!(end.mean < 0.35 * begin.mean, "{} {}", end.mean, begin.mean);
    assert!(end.elsewhere < 0.3, "{}", end.elsewhere);
}

const STABLE: Material = Material::StableNeoHookean {
    young: Material::YOUNG,
    poisson: Material::POISSON,
};

#[test]
fn the_ends_of_a_bent_bar_come_apart() {
    comes_apart("bar", &bent_bar(2, 1.2, 0.7), Material::Arap);
}

#[test]
fn the_fingers_of_a_fist_leave_the_palm() {
    comes_apart("fist", &fist(2), Material::Arap);
    comes_apart("fist, stable neo-Hookean", &fist(2), STABLE);
}

#[test]
fn the_ends_of_a_strip_in_the_plane_come_apart() {
    let wanted = bent_strip(2, 1.1);
    let watch = Watch::<2>::new(wanted.rest.simplices.as_flattened(), &wanted.start);
    let mut u = plane(&wanted).expect("comes apart");
    let begin = watch.distance(&u.positions());
    watch.run(&mut u);
    let end = watch.distance(&u.positions());
    println!(
        "strip: {:?}; mean distance {:.3} -> {:.3}, elsewhere {:.3} -> {:.3}",
        u.flowed(),
        begin.mean,
        end.mean,
        begin.elsewhere,
        end.elsewhere
    );
    assert_eq!(u.outcome().globally_injective, Some(true));
    let uv: Vec<DVec2> = u.positions().iter().map(|p| p.truncate()).collect();
    assert!(Certificate::of_map(&wanted.rest, &uv).globally_injective);
    assert!(end.mean < 0.8 * begin.mean && end.elsewhere < 0.5);
}

#[test]
fn an_outline_that_winds_twice_becomes_a_circle() {
    // a strip as an 8: its outline crosses itself, and turns by nothing in all
    let mut wanted = bent_strip(2, 1.0);
    for (p, rest) in wanted.start.iter_mut().zip(&wanted.rest.positions) {
        let angle = std::f64::consts::PI * rest.x / 6.0;
        let bow = DVec2::new(2.0 * angle.sin(), 2.0 * (2.0 * angle).sin());
        *p = (bow + DVec2::new(0.0, rest.y)).extend(0.0);
    }
    let u = plane(&wanted).expect("a circle");
    let flowed = u.flowed().expect("flowed");
    assert_eq!((flowed.steps, flowed.pairs[1]), (1, 0));
    let boundary = Boundary::<2>::new(wanted.rest.simplices.as_flattened()).expect("a manifold");
    let x = u.positions();
    let rim = || boundary.vertices.iter().map(|&v| x[v as usize]);
    let centre = rim().sum::<DVec3>() / boundary.vertices.len() as f64;
    let radii: Vec<f64> = rim().map(|p| p.distance(centre)).collect();
    let (least, most) = radii
        .iter()
        .fold((f64::MAX, 0.0f64), |(l, m), &r| (l.min(r), m.max(r)));
    assert!(most < 1.2 * least, "{least} {most}");
}

#[test]
fn pins_return_to_their_places() {
    let wanted = fist(1);
    let all = 0..wanted.start.len() as u32;
    let pins: Vec<u32> = all.filter(|&v| wanted.start[v as usize].y <= 1.0).collect();
    let watch = Watch::<3>::new(wanted.rest.simplices.as_flattened(), &wanted.start);
    let mut u = solid(&wanted, &pins, Material::Arap).expect("comes apart");
    assert!(
        pins.iter()
            .any(|&v| u.positions()[v as usize] != wanted.start[v as usize])
    );
    watch.run(&mut u);
    assert_eq!(u.outcome().globally_injective, Some(true));
    for v in pins {
        assert_eq!(
            u.positions()[v as usize],
            wanted.start[v as usize],
            "vertex {v}"
        );
    }
}

#[test]
fn targets_go_before_the_start() {
    let mut wanted = fist(1);
    wanted.start = wanted.rest.positions.clone();
    let (rest, start) = (&wanted.rest, &wanted.start);
    let boundary = Boundary::<3>::new(rest.simplices.as_flattened()).expect("a manifold");
    // where nothing meets nothing flows
    let u = solid(&wanted, &[], Material::Arap).expect("free");
    assert_eq!(
        (u.positions(), u.flowed().expect("asked").steps),
        (start.clone(), 0)
    );
    assert!(
        u.notes()
            .iter()
            .any(|note| note.contains("does not meet itself")),
        "{:?}",
        u.notes()
    );
    // targets of all other vertices' are where they are: the body stays, but for what is pulled elsewhere
    let vertex = boundary.vertices[0];
    let to = start[vertex as usize] - DVec3::new(0.3, 0.3, 0.3);
    let targets = [Target {
        vertex,
        position: to,
    }];
    let options = GiniOptions {
        target_stiffness: 1.0,
        ..options()
    };
    let mut u = Untangling::through_flow(rest, start, &[], &targets, Material::Arap, &options)
        .expect("free");
    while u.solver().status() == Status::Running {
        u.step().expect("a step");
    }
    let x = u.positions();
    assert!(x[vertex as usize].distance(to) < 0.5 * start[vertex as usize].distance(to));
    let far = boundary
        .vertices
        .iter()
        .filter(|&&v| start[v as usize].distance(to) > 5.0);
    assert!(far.clone().count() > 10);
    assert!(
        far.into_iter()
            .all(|&v| x[v as usize].distance(start[v as usize]) < 0.05)
    );
}

#[test]
fn units_turns_and_numbers_change_nothing() {
    let wanted = bent_bar(2, 1.2, 0.7);
    let begin = |wanted: &Wanted<4>| {
        let u = solid(wanted, &[], Material::Arap).expect("comes apart");
        (u.positions(), u.flowed().expect("flowed").clone())
    };
    let (x, flowed) = begin(&wanted);
    // a power of two loses nothing in the flow
    let (scaled, same) = begin(&wanted.moved(|p| 1024.0 * p));
    assert_eq!(flowed, same);
    let near = |a: &[DVec3], to: &dyn Fn(DVec3) -> DVec3, size: f64| {
        let most = a
            .iter()
            .zip(&x)
            .map(|(a, x)| a.distance(to(*x)))
            .fold(0.0, f64::max);
        assert!(most < 1e-9 * size, "{most:e}");
    };
    near(&scaled, &|p| 1024.0 * p, 1024.0);
    let turn = DQuat::from_axis_angle(DVec3::new(0.6, -0.48, 0.64).normalize(), 1.0);
    let to = |p: DVec3| 1e-3 * (turn * p + DVec3::new(3.0, 5.0, -2.0));
    let (turned, same) = begin(&wanted.moved(to));
    assert_eq!(flowed.steps, same.steps);
    near(&turned, &to, 1e-3);
    let n = x.len() as u32;
    let number: Vec<u32> = (0..n).map(|v| (v * 7 + 3) % n).collect();
    assert_ne!(n % 7, 0);
    let (mixed, same) = begin(&wanted.renumbered(&number));
    assert_eq!(flowed, same);
    let back: Vec<DVec3> = number.iter().map(|&v| mixed[v as usize]).collect();
    near(&back, &|p| p, 1.0);
    // and in the plane
    let wanted = bent_strip(2, 1.3);
    let begin = |wanted: &Wanted<3>| {
        let u = plane(wanted).expect("comes apart");
        (u.positions(), u.flowed().expect("flowed").steps)
    };
    let (x, steps) = begin(&wanted);
    let turn = DQuat::from_rotation_z(2.0);
    let to = |p: DVec3| 1e3 * (turn * p);
    let n = x.len() as u32;
    let number: Vec<u32> = (0..n).map(|v| (v * 7 + 3) % n).collect();
    let (turned, same) = begin(&wanted.moved(to).renumbered(&number));
    assert_eq!(steps, same);
    for (v, p) in number.iter().zip(&x) {
        assert!(turned[*v as usize].distance(to(*p)) < 1e-6);
    }
}

/// What refuses it, as words.
fn refusal(result: Result<Untangling, Error>) -> String {
    match result {
        Err(Error::Build(BuildError::InvalidOption { option, what })) => {
            format!("{option}: {what}")
        }
        Err(error) => panic!("another error: {error}"),
        Ok(_) => panic!("it was taken"),
    }
}

#[test]
fn what_no_map_has_as_its_boundary_is_refused() {
    let inside = refusal(solid(&nested_boxes(), &[], Material::Arap));
    assert!(
        inside.contains("flow: the body of vertex") && inside.contains("inside another"),
        "{inside}"
    );
    let mut mirrored = bent_bar(1, 1.2, 0.7);
    mirrored.start.iter_mut().for_each(|p| p.z = -p.z);
    let out = refusal(solid(&mirrored, &[], Material::Arap));
    assert!(out.contains("inside out"), "{out}");
    let hollow = hollow_box(5.0);
    let cavity = refusal(solid(&hollow, &[], Material::Arap));
    assert!(cavity.contains("cavity"), "{cavity}");
    let mut point = bent_bar(1, 1.2, 0.7);
    point.start.iter_mut().for_each(|p| *p = DVec3::ONE);
    let point = refusal(solid(&point, &[], Material::Arap));
    assert!(
        point.contains("start") && point.contains("no extent"),
        "{point}"
    );
    let wanted = bent_bar(1, 1.2, 0.7);
    let (rest, start) = (&wanted.rest, &wanted.start);
    let without = GiniOptions::default();
    let needs = refusal(Untangling::through_flow(
        rest,
        start,
        &[],
        &[],
        Material::Arap,
        &without,
    ));
    assert!(needs.contains("overlap"), "{needs}");
    // a pin out of range, two targets for one vertex: as everywhere
    assert!(refusal(solid(&wanted, &[99_999], Material::Arap)).starts_with("pins"));
    let twice = [Target {
        vertex: 0,
        position: DVec3::ZERO,
    }; 2];
    let twice = Untangling::through_flow(rest, start, &[], &twice, Material::Arap, &options());
    assert!(refusal(twice).contains("two targets"));
}

/// Runs to the end, with every state watched, which has to be injective.
fn ends_injective<const D: usize, const CORNERS: usize>(
    u: Result<Untangling, Error>,
    wanted: &Wanted<CORNERS>,
) {
    let mut u = u.expect("comes apart");
    let watch = Watch::<D>::new(wanted.rest.simplices.as_flattened(), &wanted.start);
    watch.run(&mut u);
    assert_eq!(
        u.outcome().globally_injective,
        Some(true),
        "{:?}",
        u.outcome()
    );
}

#[test]
fn a_cavity_that_is_out_comes_in() {
    let wanted = hollow_box(1.2);
    ends_injective::<3, 4>(solid(&wanted, &[], Material::Arap), &wanted);
}

#[test]
fn holes_in_the_plane_do_too() {
    let wanted = hollow_square(1.1);
    ends_injective::<2, 3>(plane(&wanted), &wanted);
    let out = refusal(plane(&hollow_square(5.0)));
    assert!(out.contains("cavity"), "{out}");
    // two squares at one corner: an outline that branches
    let mut branch = wanted;
    branch.rest.simplices.clear();
    branch.rest.simplices.extend([[0, 1, 2], [0, 3, 4]]);
    branch.rest.positions = [
        [0.0, 0.0],
        [1.0, 0.0],
        [1.0, 1.0],
        [-1.0, 0.0],
        [-1.0, -1.0],
    ]
    .map(|[x, y]| DVec3::new(x, y, 0.0))
    .to_vec();
    branch.start = branch.rest.positions.clone();
    branch.start[3] = DVec3::new(2.0, 0.5, 0.0);
    let branches = refusal(plane(&branch));
    assert!(branches.contains("branches"), "{branches}");
}

#[test]
fn what_does_not_come_apart_is_said() {
    // two boxes in one place: both become spheres in one place
    let mut wanted = nested_boxes();
    for (p, rest) in wanted.start.iter_mut().zip(&wanted.rest.positions) {
        *p = if rest.x >= 4.0 {
            3.0 * (*rest - 4.0) + 0.1
        } else {
            *rest
        };
    }
    match solid(&wanted, &[], Material::Arap) {
        Err(Error::Build(
            error @ BuildError::NotFlowedApart {
                steps,
                pairs,
                first,
            },
        )) => {
            assert!(steps > 10 && pairs > 0);
            assert_eq!(error.code(), "not-flowed-apart");
            assert!(
                error.to_string().contains(&format!("{pairs} pairs")),
                "{error}"
            );
            let n = wanted.start.len() as u32;
            assert!(first.as_flattened().iter().all(|&v| v < n));
        }
        Err(error) => panic!("another error: {error}"),
        Ok(_) => panic!("two bodies in one place"),
    }
}

#[test]
fn open_surfaces_are_refused() {
    use foldfree::embedding::flow_apart;
    let wanted = bent_bar(1, 1.2, 0.0);
    let mut boundary =
        Boundary::<3>::new(wanted.rest.simplices.as_flattened()).expect("a manifold");
    boundary.facets.pop();
    let boundary = Boundary::of_facets(boundary.facets);
    let all = |points: &[DVec3]| points.iter().map(|p| p.to_array()).collect::<Vec<_>>();
    let (rest, mut x) = (all(&wanted.rest.positions), all(&wanted.start));
    let before = x.clone();
    let error = flow_apart(&boundary, &rest, &mut x).expect_err("open");
    assert!(error.to_string().contains("open"), "{error}");
    assert_eq!(x, before);
}

#[test]
fn what_lies_on_one_point_opens() {
    let mut wanted = bent_bar(2, 1.2, 0.7);
    // the middle of one side of the bar, with the triangles between
    let rest = &wanted.rest.positions;
    let patch: Vec<usize> = (0..rest.len())
        .filter(|&v| rest[v].z > 0.49 && rest[v].x.abs() < 1.1)
        .collect();
    assert!(patch.len() > 8);
    let at = wanted.start[patch[0]];
    patch.iter().for_each(|&v| wanted.start[v] = at);
    ends_injective::<3, 4>(solid(&wanted, &[], Material::Arap), &wanted);
}
