//! Stresses in equilibrium with given loads, the nearest to a given one in 𝒜⁻¹: the dual problem of linear elasticity
//! with the element of Johnson and Mercier.
//!
//! Tractions are made continuous by displacements of the edges as multipliers (hybrid form). What is left after the
//! triangles are eliminated is symmetric and positive definite, four unknowns an edge, and the same at all times.

use std::collections::HashMap;

use algebra::linalg::{Analysis, Factor, FactorError, Front, nested_dissection};
use algebra::linalg::{larger, largest};
use fem::contact::Discretization;
use vhi::law::TensorField;

use super::edges::Edges;
use super::oscillation::Constants;
use super::triangle::{Linear, Stress, Tractions, Triangle};

/// The factorized problem on one mesh.
pub(super) struct Equilibrium {
    pub(super) edges: Edges,
    shapes: Vec<Shape>,
    /// The shape of each cell.
    shape: Vec<u32>,
    /// What the stresses of the last loads miss inside the cells, as a traction.
    missed: f64,
    analysis: Analysis,
    factor: Factor,
    front: Front,
}

/// What is computed once for all cells that are translates of each other with one 𝒜.
struct Shape {
    triangle: Triangle,
    constants: Constants,
}

/// Bytes of the shapes of a mesh; few on uniform ones, one a cell on others.
pub(super) fn bytes_of_shapes(space: &Discretization) -> f64 {
    (shapes(space).0.len() * size_of::<Shape>()) as f64
}

/// Linear loads of the dual problem.
pub(super) struct Given {
    /// f0 by cells.
    pub body: Vec<Linear>,
    /// σν at both ends of each edge that is not on Γ1, outwards; zero inside.
    pub tractions: Vec<f64>,
}

impl Equilibrium {
    /// Eliminates the triangles and factorizes.
    ///
    /// # Errors
    /// The factorization's.
    pub(super) fn new(
        space: &Discretization,
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
            Ok(Shape { triangle, constants: Constants::of(&corners) })
        });
        let shapes = shapes.collect::<Result<Vec<Shape>, FactorError>>()?;
        let pattern = edges.pattern();
        let mut values = vec![0.0; pattern.entries()];
        let couplings = |Shape { triangle, .. }: &Shape| triangle.to_tractions * triangle.of_edges;
        let couplings: Vec<_> = shapes.iter().map(couplings).collect();
        for (c, &shape) in shape.iter().enumerate() {
            let (local, unknowns) = (&couplings[shape as usize], edges.unknowns(c));
            for (i, row) in unknowns.iter().enumerate() {
                for (j, column) in unknowns.iter().enumerate() {
                    let (Some(row), Some(column)) = (*row, *column) else { continue };
                    if row >= column {
                        pattern.add([row, column], local[(i, j)], &mut values);
                    }
                }
            }
        }
        let analysis = Analysis::new(&pattern, &nested_dissection(&pattern, &edges.places(), &[]))?;
        let mut factor = analysis.factor();
        analysis.factorize(&pattern, &values, &mut factor, &mut analysis.workspace())?;
        let front = Front::default();
        Ok(Self { edges, shapes, shape, missed: 0.0, analysis, factor, front })
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
        let mut stresses = Vec::with_capacity(start.len());
        for (c, start) in start.iter().enumerate() {
            let triangle = &self.shape(c).triangle;
            let divergence = triangle.divergence(start);
            let asked = given.body[c] + Linear::from_fn(|row, _| divergence[row % 2]);
            stresses.push(start - triangle.of_divergence * asked);
        }
        self.missed = 0.0;
        // The second time what rounding leaves of the first: displacements times λ are much larger than tractions.
        self.join(&mut stresses, given);
        self.join(&mut stresses, given);
        stresses
    }

    /// Displaces the edges so that tractions are continuous.
    fn join(&mut self, stresses: &mut [Stress], given: &Given) {
        let mut right: Vec<f64> = given.tractions.iter().map(|traction| -traction).collect();
        self.add_tractions(stresses, &mut right);
        self.analysis.solve(&self.factor, &mut right, &mut self.front);
        for (c, stress) in stresses.iter_mut().enumerate() {
            let unknowns = self.edges.unknowns(c);
            let of_cell =
                Tractions::from_fn(|i, _| unknowns[i].map_or(0.0, |unknown| right[unknown]));
            let triangle = &self.shapes[self.shape[c] as usize].triangle;
            *stress -= triangle.of_edges * of_cell;
            self.missed = larger(self.missed, triangle.missed_by_edges * of_cell.amax());
        }
    }

    /// Adds the tractions of all cells to `sums`; returns the largest.
    fn add_tractions(&self, stresses: &[Stress], sums: &mut [f64]) -> f64 {
        let mut most = 0.0f64;
        for (c, stress) in stresses.iter().enumerate() {
            let tractions = self.shape(c).triangle.to_tractions * stress;
            for (unknown, traction) in self.edges.unknowns(c).iter().zip(tractions.iter()) {
                most = larger(most, traction.abs());
                if let Some(unknown) = unknown {
                    sums[*unknown] += traction;
                }
            }
        }
        most
    }

    /// ‖`stresses` - `start`‖² in 𝒜⁻¹.
    pub(super) fn distance(&self, stresses: &[Stress], start: &[Stress]) -> f64 {
        let pairs = stresses.iter().zip(start).enumerate();
        pairs.map(|(c, (stress, start))| self.shape(c).triangle.energy(&(stress - start))).sum()
    }

    /// The largest jump of tractions between cells, and difference to given ones, over the largest traction; and what
    /// the stresses inside the cells miss of what they are to balance.
    pub(super) fn imbalance(&self, stresses: &[Stress], given: &Given) -> f64 {
        let mut sums: Vec<f64> = given.tractions.iter().map(|traction| -traction).collect();
        let most = self.add_tractions(stresses, &mut sums);
        let inside = self.shapes.iter().map(|shape| shape.triangle.missed).fold(0.0, larger);
        let off = larger(self.missed, largest(&sums));
        larger(inside, if most > 0.0 { off / most } else { off })
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
