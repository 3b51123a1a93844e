//! The edges of a triangulation.

use std::collections::HashMap;

use fem::contact::Discretization;

/// Edges, with the unknowns of those that are not clamped.
pub(super) struct Edges {
    /// Edges of each cell, edge s opposite to its vertex s.
    pub of_cell: Vec<[u32; 3]>,
    /// The vertices of each edge, the smaller number first.
    pub ends: Vec<[u32; 2]>,
    /// The edge on each boundary facet of the mesh.
    of_facet: Vec<u32>,
    /// The number of each edge among those that are not on Γ1.
    pub free: Vec<Option<u32>>,
    /// How many these are.
    pub free_count: usize,
}

impl Edges {
    /// The edges of a mesh of triangles; those on the sides `clamped` have no unknowns.
    pub(super) fn new(space: &Discretization, clamped: &[u32]) -> Self {
        let mesh = &space.mesh;
        let mut known: HashMap<[u32; 2], u32> = HashMap::new();
        let mut ends = Vec::new();
        let mut of_cell = Vec::with_capacity(mesh.cell_count());
        for c in 0..mesh.cell_count() {
            let cell = mesh.cell(c);
            of_cell.push(std::array::from_fn(|s| {
                let key = sorted(cell[(s + 1) % 3], cell[(s + 2) % 3]);
                *known.entry(key).or_insert_with(|| {
                    ends.push(key);
                    ends.len() as u32 - 1
                })
            }));
        }
        let mut is_clamped = vec![false; ends.len()];
        let of_facet = (0..mesh.facet_side.len()).map(|f| {
            let edge = known[&sorted(mesh.facet(f)[0], mesh.facet(f)[1])];
            is_clamped[edge as usize] |= clamped.contains(&mesh.facet_side[f]);
            edge
        });
        let of_facet = of_facet.collect();
        let mut free_count = 0;
        let free = is_clamped.iter().map(|is_clamped| {
            free_count += usize::from(!is_clamped);
            (!is_clamped).then(|| free_count as u32 - 1)
        });
        let free = free.collect();
        Self { of_cell, ends, of_facet, free, free_count }
    }

    /// The free edge on a boundary facet, with its ends in the order of its unknowns.
    pub(super) fn on_facet(&self, facet: u32) -> Option<(u32, [u32; 2])> {
        let edge = self.of_facet[facet as usize] as usize;
        Some((self.free[edge]?, self.ends[edge]))
    }

    /// The unknowns of a cell's 12 tractions, `None` on Γ1: four for each edge, two at each of its ends.
    pub(super) fn unknowns(&self, cell: &[u32], c: usize) -> [Option<u32>; 12] {
        let mut unknowns = [None; 12];
        for (s, &edge) in self.of_cell[c].iter().enumerate() {
            let Some(free) = self.free[edge as usize] else { continue };
            for end in 0..2 {
                let vertex = cell[(s + 1 + end) % 3];
                let second = u32::from(self.ends[edge as usize][1] == vertex);
                for i in 0..2 {
                    unknowns[4 * s + 2 * end + i] = Some(4 * free + 2 * second + i as u32);
                }
            }
        }
        unknowns
    }
}

fn sorted(a: u32, b: u32) -> [u32; 2] {
    [a.min(b), a.max(b)]
}
