//! Unknowns at the vertices of Γ3 whose normals are no axes.
//!
//! A constraint u_ν ≤ g sits on one unknown, so at such a vertex the unknowns are w = N u: the rows of
//! N are the normals of the sides that meet there, completed by unit vectors across them. With
//! B = N⁻¹, displacements are u = B w, forces Bᵀf, matrices BᵀKB. Elsewhere w = u, and a scene whose
//! normals are axes has no frame and pays nothing.
//!
//! On a plane of symmetry, and on Γ3 where contact is bilateral, u_ν = 0: that unknown is held. Its column of B and its row of N are zero, which leaves it out of
//! displacements, forces and matrices; on the diagonal of a matrix it keeps a positive number, so that it is solved to 0.

use algebra::linalg::complement;
use nalgebra::{DMatrix, DMatrixViewMut};

/// A vertex whose unknowns are not Cartesian components.
#[derive(Debug, Clone, PartialEq)]
struct Frame {
    node: usize,
    /// The rows along which the unknowns are: N, with those that are held.
    rows: DMatrix<f64>,
    /// N, zero where an unknown is held.
    normals: DMatrix<f64>,
    /// B = N⁻¹, zero where an unknown is held.
    basis: DMatrix<f64>,
    /// The unknowns that are held at zero.
    held: Vec<usize>,
}

impl Frame {
    fn new(node: usize, rows: DMatrix<f64>, held: Vec<usize>) -> Self {
        let (mut normals, mut basis) =
            (rows.clone(), rows.clone().try_inverse().expect("independent rows"));
        for &i in &held {
            normals.row_mut(i).fill(0.0);
            basis.column_mut(i).fill(0.0);
        }
        Self { node, rows, normals, basis, held }
    }
}

/// All of them, on one mesh.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Frames {
    dimension: usize,
    frames: Vec<Frame>,
    /// Position in `frames` by node, `NONE` without; empty if there is no frame.
    of_node: Vec<u32>,
}

const NONE: u32 = u32::MAX;

/// Two normals closer to dependence than this leave no room between them: a needle of 1e-6 rad.
const DEPENDENT: f64 = 1e-6;

impl Frames {
    /// No frames yet, for `nodes` nodes of `dimension` components.
    pub(crate) fn new(dimension: usize) -> Self {
        Self { dimension, ..Self::default() }
    }

    /// Gives a node unknowns along `normals` (unit vectors, at most d of them), of which the first
    /// become its first components; those of `held` are held at zero. Normals that depend on each other are a broken
    /// invariant of the mesh: two sides that meet at an angle have different normals.
    pub(crate) fn insert(
        &mut self,
        node: usize,
        nodes: usize,
        normals: &[[f64; 3]],
        held: Vec<usize>,
    ) {
        let d = self.dimension;
        let mut rows: Vec<Vec<f64>> = normals.iter().map(|normal| normal[..d].to_vec()).collect();
        rows.extend(complement(&rows, d).unwrap_or_default());
        assert_eq!(rows.len(), d, "dependent normals at node {node}");
        let rows = DMatrix::from_fn(d, d, |i, j| rows[i][j]);
        assert!(rows.determinant().abs() > DEPENDENT, "dependent normals at node {node}");
        self.push(nodes, Frame::new(node, rows, held));
    }

    /// Holds Cartesian components of a node at zero.
    pub(crate) fn hold(&mut self, node: usize, nodes: usize, components: Vec<usize>) {
        self.push(
            nodes,
            Frame::new(node, DMatrix::identity(self.dimension, self.dimension), components),
        );
    }

    fn push(&mut self, nodes: usize, frame: Frame) {
        self.of_node.resize(nodes, NONE);
        self.of_node[frame.node] = self.frames.len() as u32;
        self.frames.push(frame);
    }

    /// True if all unknowns are Cartesian components.
    pub(crate) fn is_empty(&self) -> bool {
        self.frames.is_empty()
    }

    /// Nodes whose unknowns are not Cartesian components, with N by rows.
    pub(crate) fn rows(&self) -> impl Iterator<Item = (usize, Vec<f64>)> {
        let turned = self.frames.iter().filter(|frame| !frame.rows.is_identity(0.0));
        turned.map(|frame| (frame.node, frame.rows.transpose().as_slice().to_vec()))
    }

    /// u = B w of a vector by nodes, in place.
    pub(crate) fn to_cartesian(&self, vector: &mut [f64]) {
        self.each(vector, |frame, at_node| &frame.basis * at_node);
    }

    /// w = N u of a vector by nodes, in place.
    pub fn to_unknowns(&self, vector: &mut [f64]) {
        self.each(vector, |frame, at_node| &frame.normals * at_node);
    }

    /// Bᵀf of forces by nodes, in place.
    pub(crate) fn force_on_unknowns(&self, force: &mut [f64]) {
        self.each(force, |frame, at_node| frame.basis.tr_mul(&at_node));
    }

    /// Nᵀg of forces on unknowns by nodes, in place.
    pub(crate) fn force_on_cartesian(&self, force: &mut [f64]) {
        self.each(force, |frame, at_node| frame.normals.tr_mul(&at_node));
    }

    /// Takes the part of Cartesian forces by nodes that does no work in V: what supports a plane of symmetry.
    pub fn without_support(&self, force: &mut [f64]) {
        self.each(force, |frame, at_node| match frame.held.is_empty() {
            true => at_node,
            false => frame.normals.tr_mul(&frame.basis.tr_mul(&at_node)),
        });
    }

    fn each(
        &self,
        vector: &mut [f64],
        map: impl Fn(&Frame, nalgebra::DVector<f64>) -> nalgebra::DVector<f64>,
    ) {
        let d = self.dimension;
        for frame in &self.frames {
            let at_node = &mut vector[d * frame.node..d * (frame.node + 1)];
            let image = map(frame, nalgebra::DVector::from_column_slice(at_node));
            at_node.copy_from_slice(image.as_slice());
        }
    }

    /// BᵀKB of the matrix of a cell, row-major over its `nodes`, in place.
    #[inline]
    pub(crate) fn rotate_cell(&self, nodes: &[u32], local: &mut [f64]) {
        if self.frames.is_empty() {
            return;
        }
        for (a, &node) in nodes.iter().enumerate() {
            let at = self.of_node.get(node as usize).copied().unwrap_or(NONE);
            if at != NONE {
                self.rotate_node(&self.frames[at as usize], a, nodes.len(), local);
            }
        }
    }

    fn rotate_node(&self, frame: &Frame, a: usize, corners: usize, local: &mut [f64]) {
        let (d, basis, order) = (self.dimension, &frame.basis, self.dimension * corners);
        // By columns it is the transposed matrix, whose image is that of the matrix, transposed.
        let mut matrix = DMatrixViewMut::from_slice(local, order, order);
        let diagonal = matrix.diagonal().rows(d * a, d).clone_owned();
        let rows = basis.tr_mul(&matrix.rows(d * a, d));
        matrix.rows_mut(d * a, d).copy_from(&rows);
        let columns = matrix.columns(d * a, d) * basis;
        matrix.columns_mut(d * a, d).copy_from(&columns);
        for &j in &frame.held {
            matrix[(d * a + j, d * a + j)] = diagonal[j];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frames(normals: &[[f64; 3]], d: usize) -> Frames {
        let mut frames = Frames::new(d);
        frames.insert(1, 3, normals, Vec::new());
        frames
    }

    #[test]
    fn first_components_are_the_normal_displacements_and_work_is_kept() {
        let s = 0.5f64.sqrt();
        for (normals, d) in [
            (vec![[0.6, -0.8, 0.0]], 2),
            (vec![[0.6, -0.8, 0.0], [-s, -s, 0.0]], 2),
            (vec![[0.0, 0.6, 0.8]], 3),
            (vec![[1.0, 0.0, 0.0], [0.0, 0.6, 0.8]], 3),
        ] {
            let frames = frames(&normals, d);
            let u: Vec<f64> = (0..3 * d).map(|i| (i as f64 + 0.3).sin()).collect();
            let f: Vec<f64> = (0..3 * d).map(|i| (i as f64 + 0.7).cos()).collect();
            let (mut w, mut g) = (u.clone(), f.clone());
            frames.to_unknowns(&mut w);
            frames.force_on_unknowns(&mut g);
            for (i, normal) in normals.iter().enumerate() {
                let along: f64 = (0..d).map(|j| normal[j] * u[d + j]).sum();
                assert!((w[d + i] - along).abs() < 1e-14);
            }
            assert_eq!((&w[..d], &w[2 * d..]), (&u[..d], &u[2 * d..]));
            let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
            // Rounding of sums of nine products, through an inverse of condition below 10.
            assert!((dot(&w, &g) - dot(&u, &f)).abs() < 1e-13);
            frames.to_cartesian(&mut w);
            assert!(w.iter().zip(&u).all(|(a, b)| (a - b).abs() < 1e-14));
        }
    }

    /// An oblique vertex with one held unknown, and a vertex between two planes of symmetry: displacements that are left
    /// have no normal part, forces that are left do the same work on them, and the support does none.
    #[test]
    fn held_unknowns_leave_displacements_forces_and_matrices() {
        let normal = [0.6, -0.8];
        let mut frames = Frames::new(2);
        frames.insert(0, 2, &[[0.6, -0.8, 0.0]], vec![0]);
        frames.hold(1, 2, vec![0, 1]);
        let mut u = vec![0.3, 0.7, -0.2, 0.9];
        frames.to_cartesian(&mut u);
        assert!((normal[0] * u[0] + normal[1] * u[1]).abs() < 1e-15);
        assert_eq!(u[2..], [0.0, 0.0]);
        let force = vec![1.3, -0.4, 0.2, 0.5];
        let mut kept = force.clone();
        frames.without_support(&mut kept);
        let work = |f: &[f64]| f.iter().zip(&u).map(|(f, u)| f * u).sum::<f64>();
        assert!((work(&force) - work(&kept)).abs() < 1e-15);
        assert!((normal[0] * kept[0] + normal[1] * kept[1]).abs() < 1e-15);
        assert_eq!(kept[2..], [0.0, 0.0]);
        let mut matrix: Vec<f64> = (0..16).map(|i| if i % 5 == 0 { 4.0 } else { 1.0 }).collect();
        frames.rotate_cell(&[0, 1], &mut matrix);
        for held in [0, 2, 3] {
            let row = (0..4).map(|j| matrix[4 * held + j]);
            assert!(row.enumerate().all(|(j, value)| value == if j == held { 4.0 } else { 0.0 }));
        }
    }

    #[test]
    fn the_matrix_of_a_cell_turns_with_its_unknowns() {
        let frames = frames(&[[0.6, -0.8, 0.0]], 2);
        let matrix =
            DMatrix::from_fn(6, 6, |i, j| ((i + 1) * (j + 1)) as f64 + (i as f64 - j as f64).cos());
        let nodes = [2, 1, 0];
        let mut local: Vec<f64> = matrix.transpose().as_slice().to_vec();
        frames.rotate_cell(&nodes, &mut local);
        let w: Vec<f64> = (0..6).map(|i| (i as f64 * 1.3).sin()).collect();
        let quadratic = |values: &dyn Fn(usize, usize) -> f64, v: &[f64]| -> f64 {
            (0..6)
                .flat_map(|i| (0..6).map(move |j| (i, j)))
                .map(|(i, j)| v[i] * values(i, j) * v[j])
                .sum()
        };
        // By nodes, then by the corners of the cell.
        let mut u: Vec<f64> = (0..3).rev().flat_map(|a| [w[2 * a], w[2 * a + 1]]).collect();
        frames.to_cartesian(&mut u);
        let u: Vec<f64> = (0..3).rev().flat_map(|a| [u[2 * a], u[2 * a + 1]]).collect();
        let turned = quadratic(&|i, j| local[6 * i + j], &w);
        let plain = quadratic(&|i, j| matrix[(i, j)], &u);
        assert!((turned - plain).abs() < 1e-12 * plain.abs());
    }
}
