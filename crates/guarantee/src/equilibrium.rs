//! Stresses in equilibrium with given loads, the nearest to a given one in 𝒜⁻¹: the dual problem of linear elasticity
//! with the element of Johnson and Mercier.
//!
//! Tractions are made continuous by displacements of the edges as multipliers (hybrid form). What is left after the
//! triangles are eliminated is symmetric and positive definite, four unknowns an edge, and the same at all times.

use std::collections::HashMap;
use std::f64::consts::{FRAC_1_SQRT_2, PI};

use algebra::linalg::{
    Analysis, BlockPattern, Factor, FactorError, Front, larger, largest, nested_dissection,
};
use fem::contact::Discretization;
use fem::mesh::Mesh;
use nalgebra::{SMatrix, SVector};
use vhi::law::TensorField;

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
        // Edges of a cell couple.
        let pattern = BlockPattern::new(&edges.cells, 3, 4, edges.free);
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
        // The middle of each free edge, in as many numbers as it has unknowns.
        let middle = |ends: &[u32; 2]| {
            let [x, y, _] = mesh.point(ends, &[0.5, 0.5]);
            [x, y, 0.0, 0.0]
        };
        let places: Vec<f64> = edges.ends[..edges.free].iter().flat_map(middle).collect();
        let analysis = Analysis::new(&pattern, &nested_dissection(&pattern, &places, &[]))?;
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

// The edges of a triangulation: those on Γ1 come last and have no unknowns.

/// Edges, four unknowns each: two components at each of its ends, that with the smaller number first.
pub(super) struct Edges {
    mesh: Mesh,
    /// The ends of each edge, the smaller number first.
    ends: Vec<[u32; 2]>,
    /// The edges of each cell, in the order of [`OPPOSITE`].
    cells: Vec<u32>,
    facets: Vec<u32>,
    free: usize,
}

/// The corners opposite to the edges 01, 12, 20 of a triangle.
const OPPOSITE: [usize; 3] = [2, 0, 1];

impl Edges {
    /// The edges of a mesh of triangles; those on the sides `clamped` have no unknowns.
    pub(super) fn new(space: &Discretization, clamped: &[u32]) -> Self {
        let mesh = space.mesh.clone();
        let (mut ends, mut known) = (Vec::new(), HashMap::new());
        let mut edge = |a: u32, b: u32| {
            let sorted = [a.min(b), a.max(b)];
            *known.entry(sorted).or_insert_with(|| {
                ends.push(sorted);
                ends.len() - 1
            })
        };
        let sides = |cell: &[u32]| [0, 1, 2].map(|a| [cell[a], cell[(a + 1) % 3]]);
        let cells: Vec<usize> = (0..mesh.cell_count())
            .flat_map(|c| sides(mesh.cell(c)))
            .map(|[a, b]| edge(a, b))
            .collect();
        let facets: Vec<usize> =
            mesh.facets.chunks_exact(2).map(|ends| edge(ends[0], ends[1])).collect();
        let mut is_clamped = vec![false; ends.len()];
        mesh.facets_on(clamped).for_each(|f| is_clamped[facets[f]] = true);
        let (free, held): (Vec<usize>, Vec<usize>) =
            (0..ends.len()).partition(|&edge| !is_clamped[edge]);
        let mut number = vec![0; ends.len()];
        let order = free.iter().chain(&held).copied();
        order.clone().enumerate().for_each(|(new, old)| number[old] = new as u32);
        Self {
            ends: order.map(|old| ends[old]).collect(),
            cells: cells.into_iter().map(|old| number[old]).collect(),
            facets: facets.into_iter().map(|old| number[old]).collect(),
            free: free.len(),
            mesh,
        }
    }

    /// How many are not on Γ1.
    pub(super) fn free(&self) -> usize {
        self.free
    }

    /// The free edges of a cell, each with the corner opposite to it.
    pub(super) fn of_cell(&self, c: usize) -> impl Iterator<Item = (usize, u32)> {
        let all = OPPOSITE.into_iter().zip(self.cells[3 * c..3 * (c + 1)].iter().copied());
        all.filter(|(_, edge)| (*edge as usize) < self.free)
    }

    /// The free edge on a boundary facet, with its ends in the order of its unknowns.
    pub(super) fn on_facet(&self, facet: usize) -> Option<(u32, [u32; 2])> {
        let edge = self.facets[facet];
        ((edge as usize) < self.free).then(|| (edge, self.ends[edge as usize]))
    }

    /// The unknowns of a cell's 12 tractions, `None` on Γ1: four for each edge, two at each of its ends.
    pub(super) fn unknowns(&self, c: usize) -> [Option<usize>; 12] {
        let (mut unknowns, cell) = ([None; 12], self.mesh.cell(c));
        for (s, edge) in self.of_cell(c) {
            let ends = [cell[(s + 1) % 3], cell[(s + 2) % 3]];
            for end in 0..2 {
                let second = usize::from(ends[end] > ends[1 - end]);
                for i in 0..2 {
                    unknowns[4 * s + 2 * end + i] = Some(4 * edge as usize + 2 * second + i);
                }
            }
        }
        unknowns
    }
}

// Stresses on one triangle: symmetric, of degree 2 on each of the three parts into which the centroid divides it, with
// continuous tractions between the parts, linear ones on the edges and a divergence that is linear on the whole. They
// are those of C. Johnson and B. Mercier (Numer. Math. 30, 1978) and what balances linear loads inside.
//
// A stress is 54 numbers, `18 part + 3 node + component`: part s has the corners a_{s+1}, a_{s+2} and the centroid, its
// nodes are these and the middles between them in turn, components are Mandel's. Tractions are 12 numbers, `4 edge + 2 end + component`: edge s runs
// from a_{s+1} to a_{s+2}, its normal points outwards.

pub(super) type Stress = SVector<f64, 54>;
pub(super) type Tractions = SVector<f64, 12>;
/// A linear vector field by its values at the corners, `2 corner + component`.
pub(super) type Linear = SVector<f64, 6>;

/// On the 54 numbers: 18 of continuity between the parts, 6 of linear tractions on the edges, 18 of the divergence.
type Conditions = SMatrix<f64, 42, 54>;

/// What the smallest ‖σ‖ in 𝒜⁻¹ with given divergence needs of a triangle.
pub(super) struct Triangle {
    /// Counterclockwise.
    corners: [[f64; 2]; 3],
    /// |T|.
    area: f64,
    /// 𝒜⁻¹.
    compliance: SMatrix<f64, 3, 3>,
    /// ∫ of products of functions of one part.
    mass: SMatrix<f64, 6, 6>,
    /// N: the tractions of a stress on the edges.
    pub(super) to_tractions: SMatrix<f64, 12, 54>,
    /// σ that displacements of the edges cause, all conditions being zero.
    pub(super) of_edges: SMatrix<f64, 54, 12>,
    /// The smallest σ with given Div σ.
    pub(super) of_divergence: SMatrix<f64, 54, 6>,
    /// How far its conditions are off, relative to what is asked.
    pub(super) missed: f64,
    /// How far those of [`Self::of_edges`] are off, for displacements of size 1.
    pub(super) missed_by_edges: f64,
}

impl Triangle {
    /// The triangle with these corners, counterclockwise, and 𝒜 as a Mandel matrix; `None` where 𝒜 or the triangle
    /// is degenerate.
    pub(super) fn new(corners: [[f64; 2]; 3], elasticity: [[f64; 3]; 3]) -> Option<Self> {
        let [a, b, c] = corners;
        let area = 0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]));
        let elasticity = SMatrix::<f64, 3, 3>::from_fn(|i, j| elasticity[i][j]);
        let mut triangle = Self {
            corners,
            area,
            compliance: elasticity.try_inverse()?,
            mass: area / 3.0 * mass(),
            to_tractions: SMatrix::zeros(),
            of_edges: SMatrix::zeros(),
            of_divergence: SMatrix::zeros(),
            missed: 0.0,
            missed_by_edges: 0.0,
        };
        for (edge, end) in [0, 1, 2].into_iter().flat_map(|edge| [(edge, 0), (edge, 1)]) {
            let (row, at) = (4 * edge + 2 * end, 18 * edge + 3 * end);
            let outward = triangle.outward(edge);
            add_traction(&mut triangle.to_tractions, row, at, outward);
        }
        let (conditions, asked) = (triangle.conditions(), triangle.asked());
        // M⁻¹ with M = ∫ 𝒜⁻¹σ:τ, M⁻¹Gᵀ and (G M⁻¹ Gᵀ)⁻¹.
        let of_part = triangle.mass.try_inverse()?.kronecker(&elasticity);
        let mut inverse = SMatrix::<f64, 54, 54>::zeros();
        (0..3).for_each(|part| {
            inverse.fixed_view_mut::<18, 18>(18 * part, 18 * part).copy_from(&of_part)
        });
        let raised = inverse * conditions.transpose();
        let inner = (conditions * raised).cholesky()?.inverse();
        let free = inverse * triangle.to_tractions.transpose();
        // Twice: G M⁻¹ Gᵀ has the condition of 𝒜, whose rounding a second correction removes.
        let held = |stress: SMatrix<f64, 54, 12>| stress - raised * (inner * (conditions * stress));
        triangle.of_edges = held(held(free));
        triangle.missed_by_edges = (conditions * triangle.of_edges).amax();
        let first = raised * (inner * asked);
        triangle.of_divergence = first - raised * (inner * (conditions * first - asked));
        triangle.missed = (conditions * triangle.of_divergence - asked).amax() / asked.amax();
        Some(triangle)
    }

    pub(super) fn constant(stress: &[f64; 3]) -> Stress {
        Stress::from_fn(|i, _| stress[i % 3])
    }

    /// A stress that is linear on the whole triangle, by its values at barycentric coordinates.
    pub(super) fn linear(at: impl Fn(&[f64]) -> [f64; 3]) -> Stress {
        let corner =
            |a: usize| std::array::from_fn::<f64, 3, _>(|b| if a == b { 1.0 } else { 0.0 });
        let (corners, centroid) = ([0, 1, 2].map(|a| at(&corner(a))), at(&[1.0 / 3.0; 3]));
        Stress::from_fn(|i, _| {
            let value = |local: usize| match local {
                2 => centroid[i % 3],
                _ => corners[(i / 18 + 1 + local) % 3][i % 3],
            };
            match i % 18 / 3 {
                node @ 0..3 => value(node),
                middle => 0.5 * (value(middle - 3) + value((middle - 2) % 3)),
            }
        })
    }

    /// The conditions: jumps of tractions across the lines from corners to the centroid, tractions at the middles of
    /// edges less the means of those at their ends, then Div σ at the corners of the parts.
    fn conditions(&self) -> Conditions {
        let mut matrix = Conditions::zeros();
        let mut row = 0;
        let mut add = |terms: &[(usize, usize, [f64; 2])]| {
            for &(part, node, normal) in terms {
                add_traction(&mut matrix, row, 18 * part + 3 * node, normal);
            }
            row += 2;
        };
        for v in 0..3 {
            // Corner v is the second corner of the part before and the first of the part after.
            let normal = right_of(self.corners[v], self.centroid());
            let (before, after) = ((v + 1) % 3, (v + 2) % 3);
            for (node, other) in [(1, 0), (2, 2), (4, 5)] {
                add(&[(before, node, normal), (after, other, normal.map(|n| -n))]);
            }
        }
        for part in 0..3 {
            let (normal, half) = (self.outward(part), self.outward(part).map(|n| -0.5 * n));
            add(&[(part, 3, normal), (part, 0, half), (part, 1, half)]);
        }
        for part in 0..3 {
            let gradients = self.part_gradients(part);
            for corner in 0..3 {
                let at = |l: usize| if l == corner { 1.0 } else { 0.0 };
                let slope = |node: usize| {
                    let (a, b) = (node % 3, (node + 1) % 3);
                    let along = |i: usize| match node < 3 {
                        true => (4.0 * at(a) - 1.0) * gradients[a][i],
                        false => 4.0 * (at(a) * gradients[b][i] + at(b) * gradients[a][i]),
                    };
                    (part, node, [0, 1].map(|i| self.length() * along(i)))
                };
                add(&std::array::from_fn::<_, 6, _>(slope));
            }
        }
        matrix
    }

    /// What the conditions are to be for a linear Div σ.
    fn asked(&self) -> SMatrix<f64, 42, 6> {
        SMatrix::from_fn(|row, column| match row.checked_sub(24) {
            Some(row) if row % 2 == column % 2 => match (row / 6, row % 6 / 2) {
                (_, 2) => self.length() / 3.0,
                (part, local) if (part + 1 + local) % 3 == column / 2 => self.length(),
                _ => 0.0,
            },
            _ => 0.0,
        })
    }

    /// The factor that makes conditions on slopes of the size of those on tractions.
    fn length(&self) -> f64 {
        self.area.sqrt()
    }

    /// The outward normal of the edge opposite to a corner.
    fn outward(&self, edge: usize) -> [f64; 2] {
        right_of(self.corners[(edge + 1) % 3], self.corners[(edge + 2) % 3])
    }

    fn centroid(&self) -> [f64; 2] {
        std::array::from_fn(|i| self.corners.iter().map(|corner| corner[i]).sum::<f64>() / 3.0)
    }

    /// Gradients of the three linear functions of a part.
    fn part_gradients(&self, part: usize) -> [[f64; 2]; 3] {
        let at = [self.corners[(part + 1) % 3], self.corners[(part + 2) % 3], self.centroid()];
        let twice = 2.0 * self.area / 3.0;
        std::array::from_fn(|l| {
            let (p, q) = (at[(l + 1) % 3], at[(l + 2) % 3]);
            [(p[1] - q[1]) / twice, (q[0] - p[0]) / twice]
        })
    }

    /// Div σ of a stress that is linear on the whole triangle.
    pub(super) fn divergence(&self, stress: &Stress) -> [f64; 2] {
        let mut sum = [0.0; 2];
        for (local, [gx, gy]) in self.part_gradients(0).into_iter().enumerate() {
            let shear = FRAC_1_SQRT_2 * stress[3 * local + 2];
            sum[0] += gx * stress[3 * local] + gy * shear;
            sum[1] += gx * shear + gy * stress[3 * local + 1];
        }
        sum
    }

    /// ∫ 𝒜⁻¹σ:σ.
    pub(super) fn energy(&self, stress: &Stress) -> f64 {
        let of_part = |part: usize| {
            let at = SMatrix::<f64, 3, 6>::from_column_slice(
                &stress.as_slice()[18 * part..18 * part + 18],
            );
            (at * self.mass).component_mul(&(self.compliance * at)).sum()
        };
        (0..3).map(of_part).sum()
    }
}

/// Means of products of two of the functions of degree 2 on a triangle.
fn mass() -> SMatrix<f64, 6, 6> {
    SMatrix::from_fn(|k, l| {
        let (low, high) = (k.min(l), k.max(l));
        let mean = match (low < 3, high < 3) {
            (_, true) => [-1.0, 6.0][usize::from(k == l)],
            (false, _) => [16.0, 32.0][usize::from(k == l)],
            // A corner, and the middle opposite to it.
            _ if (high - 1) % 3 == low => -4.0,
            _ => 0.0,
        };
        mean / 180.0
    })
}

/// The unit vector to the right of a line.
fn right_of(from: [f64; 2], to: [f64; 2]) -> [f64; 2] {
    let length = (to[0] - from[0]).hypot(to[1] - from[1]);
    [(to[1] - from[1]) / length, (from[0] - to[0]) / length]
}

/// Adds σν, σ being the three numbers from column `at`, to two rows; the slopes of a function in place of ν give Div σ.
fn add_traction<const R: usize>(
    matrix: &mut SMatrix<f64, R, 54>,
    row: usize,
    at: usize,
    [nx, ny]: [f64; 2],
) {
    matrix[(row, at)] += nx;
    matrix[(row, at + 2)] += ny * FRAC_1_SQRT_2;
    matrix[(row + 1, at + 1)] += ny;
    matrix[(row + 1, at + 2)] += nx * FRAC_1_SQRT_2;
}

// Constants of a triangle T with which loads orthogonal to linear functions act on strains, proved and explicit.
//
// Let v be a displacement less the rigid motion with its mean and its mean rotation ω. In the plane
// ∂_x ω = ∂_x ε_xy - ∂_y ε_xx and ∂_y ω = ∂_x ε_yy - ∂_y ε_xy, so the Babuška–Aziz constant β of T bounds
// ‖ω‖ ≤ ‖ε(v)‖/β, and ‖∇v‖² = ‖ε(v)‖² + 2‖ω‖² ≤ (1 + 2/β²) ‖ε(v)‖². On a domain in a disc of radius R that is
// star-shaped with respect to the concentric disc of radius ρ, β ≥ ρ/(2R) (M. Costabel, M. Dauge, Arch. Ration.
// Mech. Anal. 217 (2015)); here the discs are about the incentre. The inequality of Payne and Weinberger,
// ‖v‖ ≤ (h/π) ‖∇v‖ on convex domains, gives ‖v‖_T; with x - p, p the corner opposite to an edge E at the height H, the
// divergence theorem gives H ‖v‖²_E ≤ 2‖v‖² + 2h ‖v‖ ‖∇v‖.

/// Constants C with ‖v‖ ≤ C ‖ε(v)‖_T for some rigid motion taken off.
pub(super) struct Constants {
    /// Of ‖v‖_T.
    pub inside: f64,
    /// Of ‖v‖_E for the edges opposite to each corner.
    pub on_edge: [f64; 3],
}

impl Constants {
    /// The constants of the triangle with these corners.
    pub(super) fn of(corners: &[[f64; 2]; 3]) -> Self {
        let distance = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]);
        let sides: [f64; 3] =
            std::array::from_fn(|s| distance(corners[(s + 1) % 3], corners[(s + 2) % 3]));
        let [a, b, c] = *corners;
        let twice = ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])).abs();
        let around: f64 = sides.iter().sum();
        let incentre: [f64; 2] =
            std::array::from_fn(|i| (0..3).map(|s| sides[s] * corners[s][i]).sum::<f64>() / around);
        let inner = twice / around;
        let outer = corners.iter().map(|&corner| distance(corner, incentre)).fold(0.0, f64::max);
        let beta = inner / (2.0 * outer);
        let korn = (1.0 + 2.0 / (beta * beta)).sqrt();
        let longest = sides.iter().copied().fold(0.0, f64::max);
        let inside = longest / PI * korn;
        let on_edge = sides.map(|side| {
            let height = twice / side;
            ((2.0 * inside * inside + 2.0 * longest * inside * korn) / height).sqrt()
        });
        Self { inside, on_edge }
    }
}
