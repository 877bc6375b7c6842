//! A binary tree of boxes: built once by halving, refitted as the boxes move.

use super::Bounds;
use crate::total_order::ranked;
use std::ops::ControlFlow;

/// Items in a leaf.
const LEAF: usize = 4;

/// A complete tree; the children of node k are 2k and 2k + 1, over the lower and the upper half of its items.
#[derive(Debug, Clone)]
pub struct Tree<const D: usize> {
    order: Vec<u32>,
    nodes: Vec<Bounds<D>>,
}

/// A node and the range of its items.
type Node = (usize, usize, usize);

impl<const D: usize> Tree<D> {
    /// Of these boxes.
    pub fn new(boxes: &[Bounds<D>]) -> Self {
        let leaves = boxes.len().div_ceil(LEAF).next_power_of_two();
        let mut nodes = vec![Bounds::EMPTY; 2 * leaves];
        let mut order: Vec<(i64, u32)> = (0..boxes.len() as u32).map(|item| (0, item)).collect();
        build(&mut nodes, &mut order, boxes, 1);
        Self {
            order: order.iter().map(|&(_, item)| item).collect(),
            nodes,
        }
    }

    /// The same tree of other boxes.
    pub fn refit(&mut self, boxes: &[Bounds<D>]) {
        refit(&mut self.nodes, &self.order, boxes, 1);
    }

    /// Visits every pair of different items whose boxes meet, once, until a visit breaks off.
    pub fn pairs(&self, boxes: &[Bounds<D>], visit: &mut impl FnMut(u32, u32) -> ControlFlow<()>) {
        // broken off or not, that is all
        let _ = self.within((1, 0, self.order.len()), boxes, visit);
    }

    /// Visits the items whose boxes have this point.
    pub fn at(&self, point: [f64; D], boxes: &[Bounds<D>], visit: &mut impl FnMut(u32)) {
        let point = Bounds::EMPTY.with(point);
        let mut stack = vec![(1, 0, self.order.len())];
        while let Some(node) = stack.pop() {
            if !self.nodes[node.0].meets(&point) {
                continue;
            }
            if self.is_leaf(node.0) {
                for &item in &self.order[node.1..node.2] {
                    if boxes[item as usize].meets(&point) {
                        visit(item);
                    }
                }
            } else {
                stack.extend(halves(node));
            }
        }
    }

    fn is_leaf(&self, node: usize) -> bool {
        2 * node >= self.nodes.len()
    }

    fn within(
        &self,
        node: Node,
        boxes: &[Bounds<D>],
        visit: &mut impl FnMut(u32, u32) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let (number, start, end) = node;
        if end - start < 2 {
            return ControlFlow::Continue(());
        }
        if self.is_leaf(number) {
            for i in start..end {
                for j in i + 1..end {
                    self.test(i, j, boxes, visit)?;
                }
            }
            return ControlFlow::Continue(());
        }
        let [lower, upper] = halves(node);
        self.within(lower, boxes, visit)?;
        self.within(upper, boxes, visit)?;
        self.between(lower, upper, boxes, visit)
    }

    fn between(
        &self,
        a: Node,
        b: Node,
        boxes: &[Bounds<D>],
        visit: &mut impl FnMut(u32, u32) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        if !self.nodes[a.0].meets(&self.nodes[b.0]) {
            return ControlFlow::Continue(());
        }
        // both are at the same depth, so that both are leaves or neither
        if self.is_leaf(a.0) {
            for i in a.1..a.2 {
                for j in b.1..b.2 {
                    self.test(i, j, boxes, visit)?;
                }
            }
        } else {
            for a in halves(a) {
                for b in halves(b) {
                    self.between(a, b, boxes, visit)?;
                }
            }
        }
        ControlFlow::Continue(())
    }

    fn test(
        &self,
        i: usize,
        j: usize,
        boxes: &[Bounds<D>],
        visit: &mut impl FnMut(u32, u32) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let (i, j) = (self.order[i], self.order[j]);
        if boxes[i as usize].meets(&boxes[j as usize]) {
            return visit(i.min(j), i.max(j));
        }
        ControlFlow::Continue(())
    }
}

fn halves((node, start, end): Node) -> [Node; 2] {
    let middle = start + (end - start) / 2;
    [(2 * node, start, middle), (2 * node + 1, middle, end)]
}

/// The items of `order` into the tree under this node, halved where their centres have their median.
fn build<const D: usize>(
    nodes: &mut [Bounds<D>],
    order: &mut [(i64, u32)],
    boxes: &[Bounds<D>],
    node: usize,
) {
    let around = order
        .iter()
        .fold(Bounds::EMPTY, |b, &(_, i)| b.union(boxes[i as usize]));
    nodes[node] = around;
    if 2 * node >= nodes.len() {
        return;
    }
    let extent = |i: usize| around.high[i] * 0.5 - around.low[i] * 0.5;
    let axis = (1..D).fold(0, |best, i| match extent(i) > extent(best) {
        true => i,
        false => best,
    });
    let middle = order.len() / 2;
    if !order.is_empty() {
        for (centre, item) in order.iter_mut() {
            let b = &boxes[*item as usize];
            *centre = ranked(b.low[axis] * 0.5 + b.high[axis] * 0.5);
        }
        order.select_nth_unstable(middle);
    }
    let (lower, upper) = order.split_at_mut(middle);
    build(nodes, lower, boxes, 2 * node);
    build(nodes, upper, boxes, 2 * node + 1);
}

fn refit<const D: usize>(nodes: &mut [Bounds<D>], order: &[u32], boxes: &[Bounds<D>], node: usize) {
    nodes[node] = if 2 * node >= nodes.len() {
        let items = order.iter();
        items.fold(Bounds::EMPTY, |b, &i| b.union(boxes[i as usize]))
    } else {
        let (lower, upper) = order.split_at(order.len() / 2);
        refit(nodes, lower, boxes, 2 * node);
        refit(nodes, upper, boxes, 2 * node + 1);
        nodes[2 * node].union(nodes[2 * node + 1])
    };
}
