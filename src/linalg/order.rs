//! The order of elimination.

use super::dissection::Bisector;
use super::{EliminationTree, Graph, SymmetricAssembly};
use crate::parallel;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::SymbolicSparseColMatRef;
use faer::sparse::linalg::amd;

/// An order of elimination that keeps the Cholesky factor sparse, in parts for threads.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Order {
    /// `unknowns[k]` is eliminated k-th.
    pub unknowns: Vec<u32>,
    /// Where the parts of each level end. Parts of one level know nothing of each other; a later level
    /// separates them.
    pub levels: Vec<Vec<usize>>,
}

/// Parts the levels are split into: eight at the bottom, enough for the threads a browser gives.
const PARTS: [usize; 3] = [8, 4, 2];

/// Above this mean degree a graph is taken for that of a solid, whose separators are so large that
/// nested dissection beats the minimum degree all the way down.
const SOLID_DEGREE: f64 = 9.0;

/// Below this the minimum degree takes over in a solid.
const SMALLEST_SEPARATED: usize = 120;

/// Below this both sides of a separator are for one thread.
const SMALLEST_SHARED: usize = 1000;

impl Order {
    /// Of the unknowns of a symmetric pattern given by its edges: the approximate minimum degree
    /// (Amestoy et al. 1996) on surfaces, nested dissection in solids. The order depends on the
    /// pattern alone, never on the number of threads.
    pub fn new(n: usize, edges: impl Iterator<Item = (u32, u32)> + Clone) -> Self {
        let graph = Graph::new(n, edges);
        let all: Vec<u32> = (0..n as u32).collect();
        let first = if graph.mean_degree() > SOLID_DEGREE {
            dissected(&graph, &mut Bisector::new(&graph), &all)
        } else {
            minimum_degree(&graph, &all)
        };
        Self::in_parts(&graph, &first)
    }

    /// As [`Self::new`], by minimum degree whatever the graph, and with the `last` unknowns of the highest
    /// numbers at the end, in their order.
    pub fn minimum_degree(
        n: usize,
        edges: impl Iterator<Item = (u32, u32)> + Clone,
        last: usize,
    ) -> Self {
        let before = n - last;
        let graph = Graph::new(before, edges);
        let all: Vec<u32> = (0..before as u32).collect();
        let mut order = Self::in_parts(&graph, &minimum_degree(&graph, &all));
        order.unknowns.extend(before as u32..n as u32);
        if let Some(end) = order.levels.last_mut().and_then(|parts| parts.last_mut()) {
            *end = n;
        }
        order
    }

    /// The order `first` of a graph, split into independent parts.
    fn in_parts(graph: &Graph, first: &[u32]) -> Self {
        let n = first.len();
        let mut place = vec![0u32; n];
        for (k, &v) in first.iter().enumerate() {
            place[v as usize] = k as u32;
        }
        let edges = graph
            .edges()
            .map(|(v, w)| (place[v as usize], place[w as usize]));
        let upper = SymmetricAssembly::new(n, edges).matrix().transpose();
        let (order, levels) = EliminationTree::new(&upper).split(&upper, &PARTS);
        let unknowns = order.iter().map(|&k| first[k as usize]).collect();
        Self { unknowns, levels }
    }
}

/// `region` by nested dissection.
fn dissected(graph: &Graph, bisector: &mut Bisector, region: &[u32]) -> Vec<u32> {
    if region.len() < SMALLEST_SEPARATED {
        return minimum_degree(graph, region);
    }
    let split = bisector.bisect(region);
    let [one, other] = &split.sides;
    let (mut order, rest) = match region.len() < SMALLEST_SHARED {
        true => (
            dissected(graph, bisector, one),
            dissected(graph, bisector, other),
        ),
        false => parallel::join(
            || dissected(graph, bisector, one),
            || dissected(graph, &mut Bisector::new(graph), other),
        ),
    };
    order.extend(rest);
    order.extend(split.separator);
    order
}

/// The vertices of `region` (ascending) by approximate minimum degree in the graph between them and
/// their neighbours outside, which are eliminated later: a clique of them has too high a degree to come
/// first (Pellegrini, Roman & Amestoy 2000, by other means).
fn minimum_degree(graph: &Graph, region: &[u32]) -> Vec<u32> {
    let own = |v: u32| region.binary_search(&v).ok().map(|k| k as u32);
    let mut halo: Vec<u32> = region.iter().flat_map(|&v| graph.of(v)).copied().collect();
    halo.retain(|&w| own(w).is_none());
    halo.sort_unstable();
    halo.dedup();
    let inner = region.len() as u32;
    let n = region.len() + halo.len();
    let mut edges = Vec::with_capacity(4 * n + halo.len() * halo.len() / 2);
    for (&v, k) in region.iter().zip(0u32..) {
        for &w in graph.of(v) {
            match own(w) {
                Some(place) if place < k => edges.push((k, place)),
                Some(_) => {}
                None => edges.extend(
                    halo.binary_search(&w)
                        .map(|place| (k, inner + place as u32)),
                ),
            }
        }
    }
    edges.extend((0..halo.len() as u32).flat_map(|k| (0..k).map(move |l| (inner + k, inner + l))));
    let assembly = SymmetricAssembly::new(n, edges.iter().copied());
    let pattern = assembly.matrix().pattern();
    let symbolic = SymbolicSparseColMatRef::new_checked(
        n,
        n,
        pattern.major_offsets(),
        None,
        pattern.minor_indices(),
    );
    let mut forward = vec![0usize; n];
    let mut inverse = vec![0usize; n];
    let mut buffer = MemBuffer::new(amd::order_scratch::<usize>(n, pattern.nnz()));
    let ordered = amd::order(
        &mut forward,
        &mut inverse,
        symbolic,
        amd::Control::default(),
        MemStack::new(&mut buffer),
    );
    // only an index overflow can fail here, and 32-bit meshes cannot cause one
    if ordered.is_err() {
        return region.to_vec();
    }
    let own = forward.iter().filter_map(|&k| region.get(k).copied());
    own.collect()
}
