//! The fronts of an elimination: which unknowns each eliminates, and where everything goes.

use super::{Cluster, FIXED};

/// Positions that follow each other below and above: `length` of them from `from` in the child go to those from `to` on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Run {
    pub from: u32,
    pub to: u32,
    pub length: u32,
}

/// A front whose update matrix is added to this one.
#[derive(Debug)]
pub struct Child {
    pub front: usize,
    /// Where its boundary is in this front; no run crosses from the eliminated unknowns to the boundary.
    pub runs: Vec<Run>,
}

/// A cell whose matrix is added to this front.
#[derive(Debug)]
pub struct Source {
    pub cell: usize,
    /// Number of the cell's unknowns, fixed ones included.
    pub size: usize,
    /// Places of the cell's unknowns and their positions in this front, ascending by position.
    pub places: Vec<(u32, u32)>,
}

/// One step of the elimination: a dense matrix over `eliminated` unknowns followed by `boundary` ones.
#[derive(Debug)]
pub struct Front {
    /// First of its eliminated unknowns, in elimination order.
    pub start: usize,
    pub eliminated: usize,
    /// The other unknowns, in elimination order, ascending.
    pub boundary: Vec<u32>,
    pub children: Vec<Child>,
    pub sources: Vec<Source>,
    /// Where its factors are kept.
    pub offset: usize,
    /// Distance from the root.
    depth: usize,
    /// Which of the two stacks of its part holds its update matrix, and where.
    pub stack: usize,
    pub update: usize,
}

impl Front {
    pub fn size(&self) -> usize {
        self.eliminated + self.boundary.len()
    }

    /// Length of its factors: the eliminated columns, then the eliminated rows of the other columns.
    pub fn length(&self) -> usize {
        self.eliminated * (self.size() + self.boundary.len())
    }

    /// Length of its update matrix.
    pub fn update_length(&self) -> usize {
        self.boundary.len() * self.boundary.len()
    }

    /// Position in this front of a place in the order of elimination.
    fn local(&self, place: u32) -> u32 {
        let place = place as usize;
        let position = match place.checked_sub(self.start) {
            Some(position) if position < self.eliminated => position,
            _ => self.eliminated + self.boundary.partition_point(|b| (*b as usize) < place),
        };
        position as u32
    }
}

/// The elimination of a matrix, before there are numbers.
pub struct Symbolic {
    /// Children before parents.
    pub fronts: Vec<Front>,
    /// Unknown -> place in the order of elimination.
    pub position: Vec<u32>,
    /// One past the last front of each of the subtrees that hang from the root: they are independent of each other.
    pub parts: Vec<usize>,
}

impl Symbolic {
    pub fn new(cells: &[Vec<u32>], tree: &Cluster, unknowns: usize) -> Self {
        let mut multiplicity = vec![0_u32; unknowns];
        for dof in cells.iter().flatten().filter(|d| **d != FIXED) {
            multiplicity[*dof as usize] += 1;
        }
        let mut walk = Walk { cells, multiplicity, fronts: Vec::new(), order: Vec::new() };
        walk.visit(tree, 0);
        let Walk { mut fronts, order, .. } = walk;
        let mut position = vec![0_u32; unknowns];
        for (i, dof) in order.iter().enumerate() {
            position[*dof as usize] = i as u32;
        }
        // From unknowns to places in the order of elimination, then to positions in each front.
        let mut offset = 0;
        for index in 0..fronts.len() {
            let (below, rest) = fronts.split_at_mut(index);
            let front = &mut rest[0];
            for dof in &mut front.boundary {
                *dof = position[*dof as usize];
            }
            front.boundary.sort_unstable();
            front.offset = offset;
            offset += front.length();
            let children = std::mem::take(&mut front.children);
            let sources = std::mem::take(&mut front.sources);
            front.children = children
                .into_iter()
                .map(|child| {
                    let positions = below[child.front].boundary.iter().map(|place| front.local(*place));
                    Child { runs: runs(positions, front.eliminated as u32), ..child }
                })
                .collect();
            front.sources = sources
                .into_iter()
                .map(|source| {
                    let unknowns = cells[source.cell].iter().zip(0..).filter(|(dof, _)| **dof != FIXED);
                    let mut places: Vec<_> =
                        unknowns.map(|(dof, place)| (place, front.local(position[*dof as usize]))).collect();
                    places.sort_unstable_by_key(|(_, position)| *position);
                    Source { places, ..source }
                })
                .collect();
        }
        let parts = fronts.last().map_or(Vec::new(), |root| root.children.iter().map(|c| c.front + 1).collect());
        Self { fronts, position, parts }
    }

    /// Assigns room for the update matrices of some fronts; returns how long the two stacks have to be.
    ///
    /// A front's update matrix goes on the stack of its depth, even or odd; those of its children are then on top of the other
    /// one and are no longer needed.
    pub fn stack(fronts: &mut [Front], first: usize) -> [usize; 2] {
        let (mut top, mut longest) = ([0; 2], [0; 2]);
        for index in 0..fronts.len() {
            let (below, rest) = fronts.split_at_mut(index);
            let front = &mut rest[0];
            front.stack = front.depth % 2;
            front.update = top[front.stack];
            top[front.stack] += front.update_length();
            longest[front.stack] = longest[front.stack].max(top[front.stack]);
            for child in front.children.iter().filter(|child| child.front >= first) {
                top[1 - front.stack] -= below[child.front - first].update_length();
            }
        }
        longest
    }
}

/// Joins positions that follow each other, on either side of `split`.
fn runs(positions: impl Iterator<Item = u32>, split: u32) -> Vec<Run> {
    let mut runs: Vec<Run> = Vec::new();
    for (from, to) in (0..).zip(positions) {
        match runs.last_mut() {
            Some(run) if run.to + run.length == to && to != split => run.length += 1,
            _ => runs.push(Run { from, to, length: 1 }),
        }
    }
    runs
}

/// Walks the tree upwards, deciding where every unknown is eliminated.
struct Walk<'a> {
    cells: &'a [Vec<u32>],
    /// In how many cells each unknown appears.
    multiplicity: Vec<u32>,
    fronts: Vec<Front>,
    order: Vec<u32>,
}

impl Walk<'_> {
    /// Appends the fronts of a cluster; returns the index of its last one, and the unknowns on its boundary with the number of
    /// the cluster's cells that they appear in.
    fn visit(&mut self, cluster: &Cluster, depth: usize) -> (usize, Vec<(u32, u32)>) {
        let (mut children, mut sources) = (Vec::new(), Vec::new());
        let mut counts: Vec<(u32, u32)> = Vec::new();
        match cluster {
            Cluster::Cells(cells) => {
                for cell in cells {
                    let unknowns = &self.cells[*cell];
                    sources.push(Source { cell: *cell, size: unknowns.len(), places: Vec::new() });
                    counts.extend(unknowns.iter().filter(|d| **d != FIXED).map(|d| (*d, 1)));
                }
            }
            Cluster::Union(parts) => {
                for part in parts {
                    let (front, boundary) = self.visit(part, depth + 1);
                    children.push(Child { front, runs: Vec::new() });
                    counts.extend(boundary);
                }
            }
        }
        counts.sort_unstable();
        counts.dedup_by(|next, kept| {
            let same = next.0 == kept.0;
            if same {
                kept.1 += next.1;
            }
            same
        });
        let start = self.order.len();
        counts.retain(|(dof, count)| {
            let complete = *count == self.multiplicity[*dof as usize];
            if complete {
                self.order.push(*dof);
            }
            !complete
        });
        let eliminated = self.order.len() - start;
        let boundary = counts.iter().map(|(dof, _)| *dof).collect();
        self.fronts.push(Front {
            start,
            eliminated,
            boundary,
            children,
            sources,
            offset: 0,
            depth,
            stack: 0,
            update: 0,
        });
        (self.fronts.len() - 1, counts)
    }
}
