//! The penalty of jumps of an element whose functions are not continuous: to a tensor 𝒞 belongs the form
//!
//!   ∫ 𝒞ε(u):ε(v) + γ(𝒞) Σ_F (1/h_F) ∫_F [u]·[v]
//!
//! over facets F between cells and on Γ1, h_F = |F|^{1/(d-1)}, γ(𝒞) its stiffness against shear, 2μ where it is isotropic,
//! and over a facet between two materials their mean. Without it ε(v) = 0 for functions that are not rigid (Falk 1991), with
//! it Korn's inequality holds (Brenner 2004); λ is no part of it, so that nothing locks (Hansbo and Larson 2003). As γ is
//! linear in 𝒞, [u]/√h is a further strain to which 𝒜 and the ℬ_i do as they do to ε: a memory that is a multiple of the
//! elasticity stays one.

use super::{Discretization, Frames};
use crate::space::Jump;
use algebra::in_dimension;
use vhi::law::TensorField;

/// γ over the stiffness against shear. The order is seen to be one from 0.5 to 20, and the constant of Korn's inequality
/// at 1 is no smaller on finer meshes.
const WEIGHT: f64 = 1.0;

/// The most unknowns at the nodes of a jump: 2d nodes in space.
const MOST_UNKNOWNS: usize = 18;

impl Discretization {
    /// γ(𝒞) of a jump.
    fn penalty(&self, law: &TensorField, jump: &Jump) -> f64 {
        let shear = |c: u32| law.on(self.region(c as usize)).shear(self.mesh.dimension);
        let [one, other] = jump.cells.map(shear);
        WEIGHT * 0.5 * (one + other)
    }

    /// Adds the penalty of `law` at a nodal vector to forces by nodes.
    pub(crate) fn add_jump_force(&self, law: &TensorField, v: &[f64], force: &mut [f64]) {
        in_dimension!(self.mesh.dimension, D => self.add_force_in::<D>(law, v, force))
    }

    fn add_force_in<const D: usize>(&self, law: &TensorField, v: &[f64], force: &mut [f64]) {
        for jump in &self.jumps {
            let share = self.penalty(law, jump) * jump.at_a_corner::<D>();
            let on_w = Jump::at_corners(&jump.of::<D>(v));
            jump.add(&on_w.map(|at_corner| at_corner.map(|f| share * f)), force);
        }
    }

    /// Adds its matrix on the unknowns of `frames` to lower-triangle `values`.
    pub(super) fn add_jump_stiffness(
        &self,
        frames: &Frames,
        law: &TensorField,
        values: &mut [f64],
    ) {
        let (d, dofs) = (self.mesh.dimension, self.dofs());
        let (order, mut room) = (2 * d * d, [0.0; MOST_UNKNOWNS * MOST_UNKNOWNS]);
        for jump in &self.jumps {
            let local = &mut room[..order * order];
            local.fill(0.0);
            // Of Σ_q (Σ w - d w_q)²/(d(d+1)) = (d Σ w_q² - (Σ w)²)/(d+1), the same for all components.
            let share = self.penalty(law, jump) * jump.weight / (d + 1) as f64;
            for (a, b) in (0..2 * d).flat_map(|a| (0..2 * d).map(move |b| (a, b))) {
                let form = if a % d == b % d { (d - 1) as f64 } else { -1.0 };
                let value = share * jump.signs[a] * jump.signs[b] * form;
                (0..d).for_each(|i| local[order * (d * a + i) + d * b + i] = value);
            }
            frames.rotate_cell(jump.nodes(d), local);
            let dof = |ai: usize| d * jump.nodes[ai / d] as usize + ai % d;
            for (entry, value) in local.iter().enumerate() {
                let at = [dof(entry / order), dof(entry % order)];
                if *value != 0.0 && at[0] >= at[1] && at[0] < dofs {
                    self.pattern.add(at, *value, values);
                }
            }
        }
    }

    /// Σ_F (1/h_F) ∫_F |Σ_i γ(𝒞_i) ⟦v_i⟧|²: what the penalties of several tensors, each at a nodal vector v_i, add to
    /// ‖Σ_i 𝒞_i ε(v_i)‖².
    pub fn jump_stress_square<'a>(
        &self,
        terms: impl Iterator<Item = (&'a TensorField, &'a [f64])> + Clone,
    ) -> f64 {
        in_dimension!(
            self.mesh.dimension, D => self.sum_of_squares::<D>(terms.map(|(law, v)| (Some(law), v)))
        )
    }

    /// Σ_F (1/h_F) ∫_F ⟦v⟧², the part of a norm of V^h that strains do not have.
    pub fn jump_square(&self, v: &[f64]) -> f64 {
        in_dimension!(
            self.mesh.dimension, D => self.sum_of_squares::<D>(std::iter::once((None, v)))
        )
    }

    /// Σ_F (1/h_F) ∫_F of the squared sum of jumps, each times γ of its tensor if it has one.
    fn sum_of_squares<'a, const D: usize>(
        &self,
        terms: impl Iterator<Item = (Option<&'a TensorField>, &'a [f64])> + Clone,
    ) -> f64 {
        let square = |jump: &Jump| -> f64 {
            let mut sum = [[0.0; D]; D];
            for (law, v) in terms.clone() {
                let weight = law.map_or(1.0, |law| self.penalty(law, jump));
                let at_corners = jump.of::<D>(v);
                let pairs = sum.as_flattened_mut().iter_mut().zip(at_corners.as_flattened());
                pairs.for_each(|(sum, j)| *sum += weight * j);
            }
            let squares: f64 = sum.as_flattened().iter().map(|j| j * j).sum();
            jump.at_a_corner::<D>() * squares
        };
        self.jumps.iter().map(square).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{Family, lattice};
    use crate::space::Element;
    use vhi::law::Isotropic;

    /// With 𝒞ε for a strain, γ[v] is its jump: of several tensors γ adds up, and against one field with itself force and matrix
    /// of the penalty do the work γ Σ_F (1/h_F) ∫_F ⟦v⟧².
    #[test]
    fn jumps_of_stresses_are_those_of_displacements_times_the_stiffness_against_shear() {
        let family = Family::Perturbed { amplitude: 0.15, seed: 2, axes: [true; 3] };
        for mesh in [lattice([1.0, 1.0], 3, family), lattice([1.0; 3], 2, family)] {
            let (d, top) = (mesh.dimension, mesh.side("top").expect("a side"));
            let space = Discretization::of(Element::CR, mesh, &[top], &[]);
            let mut v: Vec<f64> = (0..space.nodes.len()).map(|i| (1.7 * i as f64).sin()).collect();
            v[space.dofs()..].fill(0.0);
            let laws = [0.7, 1.1].map(|mu| TensorField::from(Isotropic { lambda: 2.0, mu }));
            let terms = || laws.iter().map(|law| (law, &v[..]));
            let square = space.jump_square(&v);
            let mut force = vec![0.0; space.nodes.len()];
            space.add_jump_force(&laws[0], &v, &mut force);
            let work: f64 = force.iter().zip(&v).map(|(f, v)| f * v).sum();
            // Sums of some hundred products each.
            let close = |a: f64, b: f64| (a - b).abs() < 1e-12 * b;
            assert!(close(work, 1.4 * square), "{d}: {work} {square}");
            assert!(close(space.jump_stress_square(terms()), 3.6f64.powi(2) * square));
            assert!(close(space.jump_stress_square(terms().take(1)), 1.4f64.powi(2) * square));
            let mut values = vec![0.0; space.pattern.entries()];
            space.add_jump_stiffness(&space.frames, &laws[0], &mut values);
            let mut product = vec![0.0; space.dofs()];
            space.pattern.multiply(&values, &v[..space.dofs()], &mut product);
            let off = product.iter().zip(&force).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(off < 1e-12 * work, "{d}: {off:e}");
        }
    }
}
