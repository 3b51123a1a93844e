//! Pattern of a symmetric finite element matrix: lower triangle by columns, D×D blocks of nodes.
//!
//! The rows of a column D·b + j are the remaining D - j of its diagonal block, then D rows for each larger neighbour of
//! node b, sorted. One slot number addresses a block, and assembly needs one per pair of vertices of a cell.

use sprs::CsMatI;

/// Pattern of the lower triangle and the addresses of the blocks of every cell.
#[derive(Debug, Clone)]
pub struct BlockPattern {
    dimension: usize,
    stride: usize,
    /// Column starts of the lower triangle.
    pub columns: Vec<u32>,
    /// Row numbers, sorted within a column.
    pub rows: Vec<u32>,
    /// Larger neighbours of node b: `neighbours[first[b]..first[b + 1]]`.
    first: Vec<u32>,
    neighbours: Vec<u32>,
    /// For every cell and local pair a < b (in the order 01, 02, 12, 03, …): the slot of the pair among the larger
    /// neighbours of its smaller node; `NONE` if a node is clamped.
    slots: Vec<u32>,
}

const NONE: u32 = u32::MAX;

impl BlockPattern {
    /// Pattern for `free` nodes with `dimension` components coupled by `cells` (`stride` node numbers each; numbers
    /// from `free` on are clamped and left out).
    pub fn new(cells: &[u32], stride: usize, dimension: usize, free: usize) -> Self {
        let (first, neighbours) = larger_neighbours(cells.chunks_exact(stride), free);
        let (columns, rows) = columns(dimension, &first, &neighbours);
        let mut slots = Vec::with_capacity(cells.len() * (stride - 1) / 2);
        for cell in cells.chunks_exact(stride) {
            for b in 1..stride {
                for a in 0..b {
                    let (low, high) = (cell[a].min(cell[b]), cell[a].max(cell[b]));
                    slots.push(if high as usize >= free {
                        NONE
                    } else {
                        let low = low as usize;
                        let list = &neighbours[first[low] as usize..first[low + 1] as usize];
                        list.partition_point(|&x| x < high) as u32
                    });
                }
            }
        }
        Self { dimension, stride, columns, rows, first, neighbours, slots }
    }

    pub(crate) fn order(&self) -> usize {
        self.columns.len() - 1
    }

    /// Number of stored entries of the lower triangle.
    pub fn entries(&self) -> usize {
        self.rows.len()
    }

    pub(crate) fn larger_neighbours(&self, node: usize) -> &[u32] {
        &self.neighbours[self.first[node] as usize..self.first[node + 1] as usize]
    }

    /// Adds `weight`·`local` to `values`; `local[(a, i), (b, j)]` is the symmetric matrix of cell `c`, row-major of
    /// order V·`D` for V nodes.
    #[inline]
    pub fn scatter<const D: usize>(
        &self,
        c: usize,
        nodes: &[u32],
        local: &[f64],
        values: &mut [f64],
    ) {
        // A constant number of nodes for linear elements lets loops unroll.
        let vertices = self.stride;
        let order = D * vertices;
        let free = (self.first.len() - 1) as u32;
        for (a, &node) in nodes.iter().enumerate() {
            if node < free {
                for j in 0..D {
                    let start = self.columns[D * node as usize + j] as usize;
                    for i in j..D {
                        values[start + i - j] += local[(D * a + i) * order + D * a + j];
                    }
                }
            }
        }
        let pairs = vertices * (vertices - 1) / 2;
        let slots = &self.slots[pairs * c..pairs * (c + 1)];
        let mut pair = 0;
        for b in 1..vertices {
            for a in 0..b {
                let slot = slots[pair];
                pair += 1;
                if slot == NONE {
                    continue;
                }
                let (low, high) = if nodes[a] < nodes[b] { (a, b) } else { (b, a) };
                for j in 0..D {
                    let column = D * nodes[low] as usize + j;
                    let start = self.columns[column] as usize + D - j + D * slot as usize;
                    for i in 0..D {
                        values[start + i] += local[(D * high + i) * order + D * low + j];
                    }
                }
            }
        }
    }

    /// Position of the diagonal entry of a dof.
    #[inline]
    pub fn diagonal(&self, dof: usize) -> usize {
        self.columns[dof] as usize
    }

    /// Position of the entry of two dofs, if the pattern has it.
    pub fn position(&self, i: usize, j: usize) -> Option<usize> {
        let (row, column) = (i.max(j) as u32, i.min(j));
        let range = self.columns[column] as usize..self.columns[column + 1] as usize;
        self.rows[range.clone()].binary_search(&row).ok().map(|offset| range.start + offset)
    }

    /// Adds to entry (i, j) of lower-triangle `values`, if the pattern has it.
    pub fn add(&self, [i, j]: [usize; 2], value: f64, values: &mut [f64]) {
        if let Some(position) = self.position(i, j) {
            values[position] += value;
        }
    }

    /// All off-diagonal entries of the row and column of each of `dofs`: (other dof, position).
    pub fn couplings(&self, dofs: &[u32]) -> Vec<Vec<(u32, u32)>> {
        let mut index = vec![NONE; self.order()];
        for (at, &dof) in dofs.iter().enumerate() {
            index[dof as usize] = at as u32;
        }
        let mut couplings = vec![Vec::new(); dofs.len()];
        for column in 0..self.order() {
            for position in self.columns[column] as usize + 1..self.columns[column + 1] as usize {
                let row = self.rows[position] as usize;
                for (dof, other) in [(column, row), (row, column)] {
                    if index[dof] != NONE {
                        couplings[index[dof] as usize].push((other as u32, position as u32));
                    }
                }
            }
        }
        couplings
    }

    /// The matrix with these lower-triangle `values`, as a compressed sparse column matrix.
    pub fn matrix(&self, values: Vec<f64>) -> CsMatI<f64, u32> {
        let order = self.order();
        CsMatI::new_csc((order, order), self.columns.clone(), self.rows.clone(), values)
    }

    /// (row, column, value) of the lower triangle with these `values`.
    pub(super) fn iter<'v>(
        &'v self,
        values: &'v [f64],
    ) -> impl Iterator<Item = (usize, usize, f64)> + 'v {
        let column = |j: usize| self.columns[j] as usize..self.columns[j + 1] as usize;
        let entries =
            move |j: usize| column(j).map(move |at| (self.rows[at] as usize, j, values[at]));
        (0..self.order()).flat_map(entries)
    }

    /// y ← A x for the symmetric matrix with lower-triangle `values`.
    pub fn multiply(&self, values: &[f64], x: &[f64], y: &mut [f64]) {
        y[..self.order()].fill(0.0);
        for column in 0..self.order() {
            let start = self.columns[column] as usize;
            let end = self.columns[column + 1] as usize;
            let x_column = x[column];
            let mut sum = values[start] * x_column;
            for (&row, &value) in self.rows[start + 1..end].iter().zip(&values[start + 1..end]) {
                y[row as usize] += value * x_column;
                sum += value * x[row as usize];
            }
            y[column] += sum;
        }
    }

    pub(crate) fn dimension(&self) -> usize {
        self.dimension
    }
}

/// Column starts and row numbers of the lower triangle.
fn columns(dimension: usize, first: &[u32], neighbours: &[u32]) -> (Vec<u32>, Vec<u32>) {
    let (mut columns, mut rows) = (vec![0u32], Vec::new());
    for b in 0..first.len() - 1 {
        let list = &neighbours[first[b] as usize..first[b + 1] as usize];
        for j in 0..dimension {
            rows.extend((j..dimension).map(|i| (dimension * b + i) as u32));
            for &a in list {
                rows.extend((0..dimension).map(|i| (dimension * a as usize + i) as u32));
            }
            columns.push(rows.len() as u32);
        }
    }
    (columns, rows)
}

/// Sorted larger neighbours of every free node, as (starts, list).
fn larger_neighbours<'a>(
    cells: impl Iterator<Item = &'a [u32]>,
    free: usize,
) -> (Vec<u32>, Vec<u32>) {
    let mut lists: Vec<Vec<u32>> = vec![Vec::new(); free];
    for cell in cells {
        for &low in cell {
            for &high in cell {
                if low < high && (high as usize) < free {
                    let list = &mut lists[low as usize];
                    if let Err(at) = list.binary_search(&high) {
                        list.insert(at, high);
                    }
                }
            }
        }
    }
    let mut first = Vec::with_capacity(free + 1);
    first.push(0);
    let mut neighbours = Vec::new();
    for list in lists {
        neighbours.extend(list);
        first.push(neighbours.len() as u32);
    }
    (first, neighbours)
}
