//! Stresses in equilibrium with given loads, the nearest to a given one in 𝒜⁻¹: the dual problem of linear elasticity
//! with the element of Johnson and Mercier.
//!
//! Tractions are made continuous by displacements of the edges as multipliers (hybrid form). What is left after the
//! triangles are eliminated is symmetric and positive definite, four unknowns an edge, and the same at all times.

use std::collections::HashMap;

use algebra::linalg::{Analysis, BlockPattern, Factor, FactorError, Front, nested_dissection};
use fem::contact::Discretization;
use vhi::law::TensorField;

use super::edges::Edges;
use super::inside::{Inside, Unbalanced};
use super::triangle::{Moments, Stress, Tractions, Triangle};

/// The factorized problem on one mesh.
pub(super) struct Equilibrium<'a> {
    space: &'a Discretization,
    pub(super) edges: Edges,
    /// Cells that are translates of each other with one 𝒜 share what is computed for them.
    shapes: Vec<(Triangle, Inside)>,
    shape: Vec<u32>,
    pattern: BlockPattern,
    values: Vec<f64>,
    analysis: Analysis,
    factor: Factor,
    front: Front<f64>,
}

/// Loads of the dual problem.
pub(super) struct Given {
    /// ∫ f·ψ_a by cells.
    pub moments: Vec<Moments>,
    /// σν at both ends of each edge that is not on Γ1, outwards; zero inside.
    pub tractions: Vec<f64>,
}

impl<'a> Equilibrium<'a> {
    /// Eliminates the triangles and factorizes.
    ///
    /// # Errors
    /// The factorization's.
    pub(super) fn new(
        space: &'a Discretization,
        elasticity: &TensorField,
        clamped: &[u32],
    ) -> Result<Self, FactorError> {
        let (mesh, edges) = (&space.mesh, Edges::new(space, clamped));
        let corner = |v: u32| [mesh.vertex(v)[0], mesh.vertex(v)[1]];
        let (mut shapes, mut shape, mut known) = (Vec::new(), Vec::new(), HashMap::new());
        for c in 0..mesh.cell_count() {
            let corners = std::array::from_fn(|a| corner(mesh.cell(c)[a]));
            let key = (space.region(c), key(&corners, space.geometry.measure[c]));
            if let Some(&index) = known.get(&key) {
                shape.push(index);
                continue;
            }
            let tensor = elasticity.on(space.region(c)).matrix::<3>();
            let triangle = Triangle::new(corners, tensor).ok_or(FactorError::NotFinite)?;
            let inside = Inside::new(&triangle).ok_or(FactorError::NotFinite)?;
            known.insert(key, shapes.len() as u32);
            shape.push(shapes.len() as u32);
            shapes.push((triangle, inside));
        }
        let pattern = pattern(&edges);
        let mut values = vec![0.0; pattern.entries()];
        let couplings =
            |(triangle, _): &(Triangle, Inside)| triangle.traction_matrix() * triangle.of_edges;
        let couplings: Vec<_> = shapes.iter().map(couplings).collect();
        for (c, &shape) in shape.iter().enumerate() {
            let local = &couplings[shape as usize];
            let unknowns = edges.unknowns(mesh.cell(c), c);
            for (i, row) in unknowns.iter().enumerate() {
                for (j, column) in unknowns.iter().enumerate() {
                    let (Some(row), Some(column)) = (*row, *column) else { continue };
                    if row >= column {
                        pattern.add([row as usize, column as usize], local[(i, j)], &mut values);
                    }
                }
            }
        }
        let middles = edges.free.iter().zip(&edges.ends).filter(|(free, _)| free.is_some());
        let coordinates: Vec<f64> = middles
            .flat_map(|(_, [a, b])| {
                let (a, b) = (corner(*a), corner(*b));
                [a[0] + b[0], a[1] + b[1], 0.0, 0.0]
            })
            .collect();
        let analysis = Analysis::new(&pattern, &nested_dissection(&pattern, &coordinates, &[]))?;
        let mut factor = analysis.factor();
        analysis.factorize(&pattern, &values, &mut factor, &mut analysis.workspace())?;
        let front = Front::default();
        Ok(Self { space, edges, shapes, shape, pattern, values, analysis, factor, front })
    }

    fn triangle(&self, c: usize) -> &Triangle {
        &self.shapes[self.shape[c] as usize].0
    }

    /// The stress nearest to `start`, constant on each cell, among those in equilibrium with `given`.
    pub(super) fn nearest(&mut self, start: &[[f64; 3]], given: &Given) -> Vec<Stress> {
        let mesh = &self.space.mesh;
        let mut right: Vec<f64> = given.tractions.iter().map(|traction| -traction).collect();
        let mut stresses = Vec::with_capacity(start.len());
        for c in 0..start.len() {
            let triangle = self.triangle(c);
            let stress = Triangle::constant(&start[c]) - triangle.of_moments * given.moments[c];
            let tractions = triangle.traction_matrix() * stress;
            let unknowns = self.edges.unknowns(mesh.cell(c), c);
            for (unknown, traction) in unknowns.iter().zip(tractions.iter()) {
                if let Some(unknown) = unknown {
                    right[*unknown as usize] += traction;
                }
            }
            stresses.push(stress);
        }
        let displacements = self.solve(right);
        for (c, stress) in stresses.iter_mut().enumerate() {
            let unknowns = self.edges.unknowns(mesh.cell(c), c);
            let own = Tractions::from_fn(|i, _| {
                unknowns[i].map_or(0.0, |unknown| displacements[unknown as usize])
            });
            *stress -= self.triangle(c).of_edges * own;
        }
        stresses
    }

    /// ‖σ - `start`‖² in 𝒜⁻¹, σ being `stresses` with what balances linear f0 inside the cells; `corners` are its values.
    pub(super) fn distance(
        &self,
        stresses: &[Stress],
        start: &[[f64; 3]],
        corners: &[Moments],
    ) -> f64 {
        let cell = |c: usize| {
            let triangle = self.triangle(c);
            let divergence = triangle.divergence(&stresses[c]);
            let load = Unbalanced::from_fn(|row, _| match row {
                0..6 => corners[c][row],
                _ => divergence[(row - 6) / 2][row % 2],
            });
            let off = stresses[c] - Triangle::constant(&start[c]);
            triangle.energy(&off) + self.shapes[self.shape[c] as usize].1.added_energy(&off, &load)
        };
        (0..start.len()).map(cell).sum()
    }

    /// The largest jump of tractions between cells, and difference to given ones, over the largest traction; and what
    /// the stresses inside the cells miss of what they are to balance.
    pub(super) fn imbalance(&self, stresses: &[Stress], given: &Given) -> f64 {
        let mesh = &self.space.mesh;
        let mut sums: Vec<f64> = given.tractions.iter().map(|traction| -traction).collect();
        let mut largest = 0.0f64;
        for (c, stress) in stresses.iter().enumerate() {
            let tractions = self.triangle(c).traction_matrix() * stress;
            let unknowns = self.edges.unknowns(mesh.cell(c), c);
            for (unknown, traction) in unknowns.iter().zip(tractions.iter()) {
                largest = algebra::linalg::larger(largest, traction.abs());
                if let Some(unknown) = unknown {
                    sums[*unknown as usize] += traction;
                }
            }
        }
        let inside = self.shapes.iter().map(|(_, inside)| inside.missed);
        let inside = inside.fold(0.0, algebra::linalg::larger);
        let jump = algebra::linalg::largest(&sums);
        algebra::linalg::larger(inside, if largest > 0.0 { jump / largest } else { jump })
    }

    /// One solve with one refinement, which leaves tractions continuous to rounding.
    fn solve(&mut self, right: Vec<f64>) -> Vec<f64> {
        let mut found = right.clone();
        self.analysis.solve(&self.factor, &mut found, &mut self.front);
        let mut rest = vec![0.0; right.len()];
        self.pattern.multiply(&self.values, &found, &mut rest);
        rest.iter_mut().zip(&right).for_each(|(rest, right)| *rest = right - *rest);
        self.analysis.solve(&self.factor, &mut rest, &mut self.front);
        found.iter_mut().zip(&rest).for_each(|(found, rest)| *found += rest);
        found
    }
}

/// The edges of a triangle from its first corner, to a part in 1e12 of its size.
fn key(corners: &[[f64; 2]; 3], measure: f64) -> [i64; 4] {
    let unit = 1e-12 * measure.sqrt();
    let edge =
        |corner: usize, i: usize| ((corners[corner][i] - corners[0][i]) / unit).round() as i64;
    [edge(1, 0), edge(1, 1), edge(2, 0), edge(2, 1)]
}

/// Edges of a cell couple, four unknowns an edge.
fn pattern(edges: &Edges) -> BlockPattern {
    let mut larger = vec![Vec::new(); edges.free_count];
    for cell in &edges.of_cell {
        let free: Vec<u32> = cell.iter().filter_map(|edge| edges.free[*edge as usize]).collect();
        for &low in &free {
            larger[low as usize].extend(free.iter().filter(|&&high| high > low));
        }
    }
    for list in &mut larger {
        list.sort_unstable();
        list.dedup();
    }
    BlockPattern::of_neighbours(4, &larger)
}
