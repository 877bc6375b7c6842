//! The order of elimination.

use super::minimum_degree::{Halo, minimum_degree};
use super::{EliminationTree, Graph, SymmetricAssembly, bisect};
use crate::parallel;

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
        let first = if graph.mean_degree() > SOLID_DEGREE {
            let all: Vec<u32> = (0..n as u32).collect();
            dissected(&graph, &graph, &all)
        } else {
            minimum_degree(&graph, &Halo::default())
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
        let first = minimum_degree(&graph, &Halo::default());
        let mut order = Self::in_parts(&graph, &first);
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

/// The vertices of a part of a graph by nested dissection. `names` are those of the whole, ascending.
fn dissected(whole: &Graph, part: &Graph, names: &[u32]) -> Vec<u32> {
    let name = |&v: &u32| names[v as usize];
    if names.len() < SMALLEST_SEPARATED {
        let halo = Halo::new(whole, part, names);
        return minimum_degree(part, &halo).iter().map(name).collect();
    }
    let split = bisect(part);
    let [one, other] = &split.sides;
    let places = part.places(&[one, other]);
    let dissected = |side: &[u32]| {
        let names: Vec<u32> = side.iter().map(name).collect();
        dissected(whole, &part.part(side, &places), &names)
    };
    let (mut order, rest) = match names.len() < SMALLEST_SHARED {
        true => (dissected(one), dissected(other)),
        false => parallel::join(|| dissected(one), || dissected(other)),
    };
    order.extend(rest);
    order.extend(split.separator.iter().map(name));
    order
}
