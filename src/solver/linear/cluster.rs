//! The order of elimination as a tree of clusters of cells, and the best such tree for a strip.

use std::collections::HashMap;

/// A set of cells that is eliminated together, after its parts.
#[derive(Debug, Clone)]
pub enum Cluster {
    /// Cells that are summed before anything is eliminated.
    Cells(Vec<usize>),
    /// The union of smaller clusters.
    Union(Vec<Cluster>),
}

impl Cluster {
    /// Nested dissection of a strip of `columns` x `rows` cells, cell (column, row) having index `column * rows + row`.
    ///
    /// The strip is cut into two halves, independent of each other up to the line where they meet. Each is cut into blocks, which
    /// are joined one after the other from the far end towards the middle: what is joined has only one open side. How many
    /// blocks, how a block is cut further and when to stop cutting is what the estimate of `Dissection` finds cheapest.
    pub fn strip(columns: usize, rows: usize) -> Self {
        let mut dissection = Dissection { rows, cheapest: HashMap::new() };
        let middle = columns / 2;
        let halves = [[0, middle], [columns, middle]].map(|[end, middle]| dissection.chain(end, middle));
        Self::Union(halves.into_iter().flatten().collect())
    }
}

/// A rectangle of cells: its size, and whether cells beyond its left and right side, its first and its last row wait to be joined.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
struct Block {
    size: [usize; 2],
    /// Before and after it, by direction.
    open: [[bool; 2]; 2],
}

/// What is best done with a block.
#[derive(Debug, Clone, Copy)]
enum Cut {
    None,
    /// Into two halves along this direction.
    Halves(usize),
}

/// Finds the cheapest dissection, by an estimate that counts in cycles and takes every cell for a biquadratic element with three
/// unknowns a node. For other cells the tree is just as valid.
struct Dissection {
    rows: usize,
    cheapest: HashMap<Block, (f64, Cut)>,
}

impl Dissection {
    /// Eliminating `k` unknowns coupled to `b` others: a part for every floating-point operation, one for every entry that is
    /// moved, and one for the front itself.
    fn cost(k: usize, b: usize) -> f64 {
        let (k, b) = (3.0 * k as f64, 3.0 * b as f64);
        (2.0 / 3.0 * k * k * k + 2.0 * k * k * b + 2.0 * k * b * b) / 8.0 + 2.0 * (k + b) * (k + b) + 500.0
    }

    /// Blocks from column `end` to column `middle`, joined in this order; none if there are no columns.
    fn chain(&mut self, end: usize, middle: usize) -> Option<Cluster> {
        let columns = end.abs_diff(middle);
        let rows = self.rows;
        let line = 2 * rows + 1;
        let block =
            |first: usize, last: usize| Block { size: [last - first, rows], open: [[first > 0, true], [false, false]] };
        let edges = |count: usize| (0..count).map(move |i| [i * columns / count, (i + 1) * columns / count]);
        let mut best = (f64::INFINITY, 0);
        for count in (1..=columns).filter(|count| columns / count <= 3 * rows) {
            let joins = (count - 1) as f64 * Self::cost(line, line);
            let cost = joins + edges(count).map(|[first, last]| self.evaluate(block(first, last)).0).sum::<f64>();
            if cost < best.0 {
                best = (cost, count);
            }
        }
        edges(best.1)
            .map(|[first, last]| {
                let at = if end < middle { end + first } else { end - last };
                self.cluster(block(first, last), [at, 0])
            })
            .reduce(|done, next| Cluster::Union(vec![done, next]))
    }

    /// The least cost of a block and how to reach it.
    fn evaluate(&mut self, block: Block) -> (f64, Cut) {
        if let Some(known) = self.cheapest.get(&block) {
            return *known;
        }
        let nodes = block.size.map(|n| 2 * n + 1);
        let open = |direction: usize| block.open[direction].map(usize::from).iter().sum::<usize>();
        let inner = [nodes[0] - open(0), nodes[1] - open(1)];
        let boundary = nodes[0] * nodes[1] - inner[0] * inner[1];
        let mut best = (Self::cost(inner[0] * inner[1], boundary), Cut::None);
        for direction in (0..2).filter(|d| block.size[*d] > 1) {
            let halves: f64 = block.halves(direction).map(|half| self.evaluate(half).0).iter().sum();
            let cost = halves + Self::cost(inner[1 - direction], boundary);
            if cost < best.0 {
                best = (cost, Cut::Halves(direction));
            }
        }
        self.cheapest.insert(block, best);
        best
    }

    /// The cluster of a block whose first cell is at (column, row).
    fn cluster(&mut self, block: Block, at: [usize; 2]) -> Cluster {
        match self.evaluate(block).1 {
            Cut::None => {
                let cell = |c: usize, r: usize| (at[0] + c) * self.rows + at[1] + r;
                let [columns, rows] = block.size;
                Cluster::Cells(
                    (0..columns).flat_map(|c| (0..rows).map(move |r| (c, r))).map(|(c, r)| cell(c, r)).collect(),
                )
            }
            Cut::Halves(direction) => {
                let [first, second] = block.halves(direction);
                let mut after = at;
                after[direction] += first.size[direction];
                Cluster::Union(vec![self.cluster(first, at), self.cluster(second, after)])
            }
        }
    }
}

impl Block {
    fn halves(self, direction: usize) -> [Self; 2] {
        let (mut first, mut second) = (self, self);
        first.size[direction] = self.size[direction] / 2;
        second.size[direction] -= first.size[direction];
        first.open[direction][1] = true;
        second.open[direction][0] = true;
        [first, second]
    }
}
