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
use super::oscillation::Constants;
use super::triangle::{Moments, Stress, Tractions, Triangle};

/// The factorized problem on one mesh.
pub(super) struct Equilibrium<'a> {
    space: &'a Discretization,
    pub(super) edges: Edges,
    shapes: Vec<Shape>,
    /// The shape of each cell.
    shape: Vec<u32>,
    pattern: BlockPattern,
    values: Vec<f64>,
    analysis: Analysis,
    factor: Factor,
    front: Front<f64>,
}

/// What is computed once for all cells that are translates of each other with one 𝒜.
struct Shape {
    triangle: Triangle,
    inside: Inside,
    constants: Constants,
}

/// Bytes of the shapes of a mesh; few on uniform ones, one a cell on others.
pub(super) fn bytes_of_shapes(space: &Discretization) -> f64 {
    (shapes(space).0.len() * size_of::<Shape>()) as f64
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
        let (firsts, shape) = shapes(space);
        let shapes = firsts.into_iter().map(|c| {
            let corners = std::array::from_fn(|a| corner(mesh.cell(c)[a]));
            let tensor = elasticity.on(space.region(c)).matrix::<3>();
            let triangle = Triangle::new(corners, tensor).ok_or(FactorError::NotFinite)?;
            let inside = Inside::new(&triangle).ok_or(FactorError::NotFinite)?;
            let constants = Constants::of(&corners);
            Ok(Shape { triangle, inside, constants })
        });
        let shapes = shapes.collect::<Result<Vec<Shape>, FactorError>>()?;
        let pattern = pattern(&edges);
        let mut values = vec![0.0; pattern.entries()];
        let couplings = |Shape { triangle, .. }: &Shape| triangle.to_tractions * triangle.of_edges;
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

    fn shape(&self, c: usize) -> &Shape {
        &self.shapes[self.shape[c] as usize]
    }

    /// How loads that are orthogonal to linear functions act on the strains of a cell.
    pub(super) fn constants(&self, c: usize) -> &Constants {
        &self.shape(c).constants
    }

    /// The stress nearest to `start`, constant or linear on each cell, among those in equilibrium with `given`.
    pub(super) fn nearest(&mut self, start: &[Stress], given: &Given) -> Vec<Stress> {
        let mesh = &self.space.mesh;
        let mut right: Vec<f64> = given.tractions.iter().map(|traction| -traction).collect();
        let mut stresses = Vec::with_capacity(start.len());
        for c in 0..start.len() {
            let triangle = &self.shape(c).triangle;
            let asked = given.moments[c] + self.own_moments(triangle, &start[c]);
            let stress = start[c] - triangle.of_moments * asked;
            let tractions = triangle.to_tractions * stress;
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
            let of_cell = Tractions::from_fn(|i, _| {
                unknowns[i].map_or(0.0, |unknown| displacements[unknown as usize])
            });
            *stress -= self.shape(c).triangle.of_edges * of_cell;
        }
        stresses
    }

    /// ∫ Div σ·ψ_a of a stress that is linear on a triangle; none where the element has constant ones.
    fn own_moments(&self, triangle: &Triangle, stress: &Stress) -> Moments {
        if self.space.geometry.shares.len() == 1 {
            return Moments::zeros();
        }
        // The same on all parts.
        let [divergence, ..] = triangle.divergence(stress);
        Moments::from_fn(|row, _| triangle.area / 3.0 * divergence[row % 2])
    }

    /// ‖σ - `start`‖² in 𝒜⁻¹, σ being `stresses` with what balances linear f0 inside the cells; `corners` are its values.
    pub(super) fn distance(
        &self,
        stresses: &[Stress],
        start: &[Stress],
        corners: &[Moments],
    ) -> f64 {
        let cell = |c: usize| {
            let triangle = &self.shape(c).triangle;
            let divergence = triangle.divergence(&stresses[c]);
            let load = Unbalanced::from_fn(|row, _| match row {
                0..6 => corners[c][row],
                _ => divergence[(row - 6) / 2][row % 2],
            });
            let off = stresses[c] - start[c];
            triangle.energy(&off) + self.shape(c).inside.added_energy(&off, &load)
        };
        (0..start.len()).map(cell).sum()
    }

    /// The largest jump of tractions between cells, and difference to given ones, over the largest traction; and what
    /// the stresses inside the cells miss of what they are to balance. It checks [`Self::nearest`], and so sums up the
    /// tractions itself.
    pub(super) fn imbalance(&self, stresses: &[Stress], given: &Given) -> f64 {
        let mesh = &self.space.mesh;
        let mut sums: Vec<f64> = given.tractions.iter().map(|traction| -traction).collect();
        let mut largest = 0.0f64;
        for (c, stress) in stresses.iter().enumerate() {
            let tractions = self.shape(c).triangle.to_tractions * stress;
            let unknowns = self.edges.unknowns(mesh.cell(c), c);
            for (unknown, traction) in unknowns.iter().zip(tractions.iter()) {
                largest = algebra::linalg::larger(largest, traction.abs());
                if let Some(unknown) = unknown {
                    sums[*unknown as usize] += traction;
                }
            }
        }
        let inside = self.shapes.iter().map(|shape| shape.inside.missed);
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

/// The first cell of each shape, and the shape of each cell: the edges from its first corner, to a part in 1e12 of its
/// size, and its region.
fn shapes(space: &Discretization) -> (Vec<usize>, Vec<u32>) {
    let mesh = &space.mesh;
    let (mut firsts, mut known) = (Vec::new(), HashMap::new());
    let shape = (0..mesh.cell_count()).map(|c| {
        let unit = 1e-12 * space.geometry.measure[c].sqrt();
        let [start, second, third] =
            std::array::from_fn(|corner| mesh.vertex(mesh.cell(c)[corner]));
        let edge = |to: &[f64], i: usize| ((to[i] - start[i]) / unit).round() as i64;
        let edges = [edge(second, 0), edge(second, 1), edge(third, 0), edge(third, 1)];
        *known.entry((space.region(c), edges)).or_insert_with(|| {
            firsts.push(c);
            firsts.len() as u32 - 1
        })
    });
    let shape = shape.collect();
    (firsts, shape)
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
