//! Interpolation between two meshes.

use crate::linalg::BlockPattern;

/// The unknowns w = N u of a node with rotated coordinates.
#[derive(Debug, Clone, PartialEq)]
pub struct NodeFrame {
    pub node: usize,
    /// N by rows.
    pub rows: Vec<f64>,
}

/// A clamped node.
const NONE: u32 = u32::MAX;

/// P₀: the mean of two coarse nodes; clamped ones are zero.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Transfer {
    /// Coarse nodes of each fine node: the same twice, or two ends of an edge.
    parents: Vec<[u32; 2]>,
    /// The fine node at each coarse node.
    pub(super) twins: Vec<u32>,
    pub(super) weight: f64,
}

const MIDPOINT: f64 = 0.5;

impl Transfer {
    /// From coarse vertices of fine vertices and the nodes of those, of which the first `free` are not clamped; also
    /// returns the coarse nodes by vertex. Coarse vertices are clamped where their twins are.
    pub(super) fn new(parents: &[[u32; 2]], nodes: &[u32], free: usize) -> (Self, Vec<u32>) {
        let coarse_vertices = parents.iter().flatten().max().map_or(0, |&v| v as usize + 1);
        let (mut coarse_nodes, mut twins) = (vec![NONE; coarse_vertices], Vec::new());
        for (&[low, high], &node) in parents.iter().zip(nodes) {
            if low == high && (node as usize) < free {
                coarse_nodes[low as usize] = twins.len() as u32;
                twins.push(node);
            }
        }
        let mut of_node = vec![[NONE; 2]; free];
        for (pair, &node) in parents.iter().zip(nodes).filter(|(_, n)| (**n as usize) < free) {
            of_node[node as usize] = pair.map(|vertex| coarse_nodes[vertex as usize]);
        }
        (Self { parents: of_node, twins, weight: MIDPOINT }, coarse_nodes)
    }

    #[inline]
    pub(super) fn parents(&self, node: usize) -> (impl Iterator<Item = u32> + Clone + use<>, f64) {
        let [first, second] = self.parents[node];
        let (second, weight) = if first == second { (NONE, 1.0) } else { (second, self.weight) };
        ([first, second].into_iter().filter(|&parent| parent != NONE), weight)
    }

    /// Pattern of P₀ᵀAP₀.
    pub(super) fn coarse_pattern(&self, fine: &BlockPattern) -> BlockPattern {
        let mut lists: Vec<Vec<u32>> = vec![Vec::new(); self.twins.len()];
        let mut couple = |p: u32, q: u32| {
            let list = &mut lists[p.min(q) as usize];
            if p != q
                && let Err(at) = list.binary_search(&p.max(q))
            {
                list.insert(at, p.max(q));
            }
        };
        for node in 0..fine.nodes() {
            let (parents, _) = self.parents(node);
            for p in parents {
                for &other in fine.larger_neighbours(node).iter().chain(&[node as u32]) {
                    self.parents(other as usize).0.for_each(|q| couple(p, q));
                }
            }
        }
        BlockPattern::of_neighbours(fine.dimension(), &lists)
    }

    /// `out` ← Pᵀ v.
    pub(super) fn restrict<const D: usize>(&self, turns: &Turns, v: &[f32], out: &mut [f32]) {
        out.fill(0.0);
        for (node, values) in v.as_chunks::<D>().0.iter().enumerate() {
            let mut values = *values;
            if let Some(turn) = turns.of(node) {
                values = std::array::from_fn(|j| {
                    (0..D).map(|i| turn[3 * i + j] as f32 * values[i]).sum()
                });
            }
            let (parents, weight) = self.parents(node);
            for parent in parents {
                let out = &mut out[D * parent as usize..D * (parent as usize + 1)];
                out.iter_mut().zip(values).for_each(|(out, v)| *out += weight as f32 * v);
            }
        }
    }

    /// `out` ← `out` + P v.
    pub(super) fn add_interpolated<const D: usize>(
        &self,
        turns: &Turns,
        v: &[f32],
        out: &mut [f32],
    ) {
        let (values, out) = (v.as_chunks::<D>().0, out.as_chunks_mut::<D>().0);
        for (node, out) in out.iter_mut().enumerate() {
            let (parents, weight) = self.parents(node);
            let mut interpolated = [0.0f32; D];
            for parent in parents {
                let parent = &values[parent as usize];
                interpolated
                    .iter_mut()
                    .zip(parent)
                    .for_each(|(interpolated, v)| *interpolated += weight as f32 * v);
            }
            if let Some(turn) = turns.of(node) {
                interpolated = std::array::from_fn(|i| {
                    (0..D).map(|j| turn[3 * i + j] as f32 * interpolated[j]).sum()
                });
            }
            out.iter_mut().zip(interpolated).for_each(|(out, v)| *out += v);
        }
    }
}

/// M N at the nodes where it is not the identity.
#[derive(Debug, Clone, Default)]
pub(crate) struct Turns {
    of_node: Vec<u32>,
    /// Rows of three numbers, also in the plane.
    matrices: Vec<[f64; 9]>,
}

impl Turns {
    /// Takes the frames of a mesh and the held unknowns, in existing memory.
    pub(super) fn set(&mut self, d: usize, nodes: usize, frames: &[NodeFrame], held: &[usize]) {
        self.of_node.clear();
        self.matrices.clear();
        if frames.is_empty() && held.is_empty() {
            return;
        }
        self.of_node.resize(nodes, NONE);
        for frame in frames.iter().filter(|frame| frame.node < nodes) {
            let turn = self.at(frame.node);
            for (i, row) in frame.rows.chunks_exact(d).enumerate() {
                turn[3 * i..3 * i + d].copy_from_slice(row);
            }
        }
        for &dof in held {
            self.at(dof / d)[3 * (dof % d)..3 * (dof % d + 1)].fill(0.0);
        }
    }

    fn at(&mut self, node: usize) -> &mut [f64; 9] {
        if self.of_node[node] == NONE {
            self.of_node[node] = self.matrices.len() as u32;
            self.matrices.push([1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]);
        }
        &mut self.matrices[self.of_node[node] as usize]
    }

    #[inline]
    pub(super) fn of(&self, node: usize) -> Option<&[f64; 9]> {
        match self.of_node.get(node) {
            Some(&at) if at != NONE => Some(&self.matrices[at as usize]),
            _ => None,
        }
    }
}
