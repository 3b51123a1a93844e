//! The penalty of jumps of an element whose functions are not continuous: to a tensor 𝒞 belongs the form
//!
//!   ∫ 𝒞ε(u):ε(v) + γ(𝒞) Σ_e (1/h_e) ∫_e [u]·[v]
//!
//! over edges e between cells and on Γ1, γ(𝒞) its stiffness against shear, 2μ where it is isotropic, and over an edge
//! between two materials their mean. Without it ε(v) = 0 for functions that are not rigid (Falk 1991), with it Korn's
//! inequality holds (Brenner 2004); λ is no part of it, so that nothing locks (Hansbo and Larson 2003). As γ is linear
//! in 𝒞, [u]/√h is a further strain to which 𝒜 and the ℬ_i do as they do to ε: a memory that is a multiple of the
//! elasticity stays one.

use super::{Discretization, Frames};
use crate::space::{Jump, MEAN_SQUARE};
use vhi::law::TensorField;

/// γ over the stiffness against shear. The order is seen to be one from 0.5 to 20, and the constant of Korn's inequality
/// at 1 is no smaller on finer meshes.
const WEIGHT: f64 = 1.0;

impl Discretization {
    /// γ(𝒞)/3 of a jump.
    fn penalty(&self, law: &TensorField, jump: &Jump) -> f64 {
        let shear = |c: u32| law.on(self.region(c as usize)).shear(self.mesh.dimension);
        let [one, other] = jump.cells.map(shear);
        WEIGHT * MEAN_SQUARE * 0.5 * (one + other)
    }

    /// Adds the penalty of `law` at a nodal vector to forces by nodes.
    pub(crate) fn add_jump_force(&self, law: &TensorField, v: &[f64], force: &mut [f64]) {
        // Jumps are those of plane elements.
        for jump in &self.jumps {
            let own = jump.of::<2>(v).map(|j| self.penalty(law, jump) * j);
            for (&node, sign) in jump.nodes.iter().zip(jump.signs) {
                let target = &mut force[2 * node as usize..][..2];
                target.iter_mut().zip(own).for_each(|(target, j)| *target += sign * j);
            }
        }
    }

    /// Adds its matrix on the unknowns of `frames` to lower-triangle `values`.
    pub(super) fn add_jump_stiffness(
        &self,
        frames: &Frames,
        law: &TensorField,
        values: &mut [f64],
    ) {
        let dofs = self.dofs();
        for jump in &self.jumps {
            let penalty = self.penalty(law, jump);
            let mut local = [0.0; 64];
            for (ab, pair) in local.chunks_exact_mut(8).enumerate() {
                let (a, i) = (ab / 2, ab % 2);
                (0..4).for_each(|b| pair[2 * b + i] = penalty * jump.signs[a] * jump.signs[b]);
            }
            frames.rotate_cell(&jump.nodes, &mut local);
            let dof = |ai: usize| 2 * jump.nodes[ai / 2] as usize + ai % 2;
            for (entry, value) in local.iter().enumerate() {
                let at = [dof(entry / 8), dof(entry % 8)];
                if *value != 0.0 && at[0] >= at[1] && at[0] < dofs {
                    self.pattern.add(at, *value, values);
                }
            }
        }
    }

    /// Σ_e (1/h_e) ∫_e |Σ_i γ(𝒞_i) ⟦v_i⟧|²: what the penalties of several tensors, each at its own nodal vector, are besides
    /// ‖Σ_i 𝒞_i ε(v_i)‖².
    pub fn jump_stress_square<'a>(
        &self,
        terms: impl Iterator<Item = (&'a TensorField, &'a [f64])> + Clone,
    ) -> f64 {
        let square = |jump: &Jump| -> f64 {
            let mut sum = [0.0; 2];
            for (law, v) in terms.clone() {
                let weight = self.penalty(law, jump) / MEAN_SQUARE;
                sum.iter_mut().zip(jump.of::<2>(v)).for_each(|(sum, j)| *sum += weight * j);
            }
            sum.iter().map(|own| MEAN_SQUARE * own * own).sum()
        };
        self.jumps.iter().map(square).sum()
    }

    /// Σ_e (1/h_e) ∫_e ⟦v⟧², the part of a norm of V^h that strains do not have.
    pub fn jump_square(&self, v: &[f64]) -> f64 {
        let square = |jump: &Jump| jump.of::<2>(v).iter().map(|j| MEAN_SQUARE * j * j).sum::<f64>();
        self.jumps.iter().map(square).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{Family, rectangle};
    use crate::space::Element;
    use vhi::law::Isotropic;

    /// With 𝒞ε for a strain, γ[v] is its jump: of several tensors γ adds up, and against one field with itself the force
    /// of the penalty does the work γ Σ_e (1/h_e) ∫_e ⟦v⟧².
    #[test]
    fn jumps_of_stresses_are_those_of_displacements_times_the_stiffness_against_shear() {
        let mesh = rectangle([1.0, 1.0], 3, Family::Structured);
        let top = mesh.side("top").expect("a side");
        let space = Discretization::of(Element::CR, mesh, &[top], &[]);
        let mut v: Vec<f64> = (0..space.nodes.len()).map(|i| (1.7 * i as f64).sin()).collect();
        v[space.dofs()..].fill(0.0);
        let laws = [0.7, 1.1].map(|mu| TensorField::from(Isotropic { lambda: 2.0, mu }));
        let terms = || laws.iter().map(|law| (law, &v[..]));
        let square = space.jump_square(&v);
        let mut force = vec![0.0; space.nodes.len()];
        space.add_jump_force(&laws[0], &v, &mut force);
        let work: f64 = force.iter().zip(&v).map(|(f, v)| f * v).sum();
        // Sums of some fifty products each.
        let close = |a: f64, b: f64| (a - b).abs() < 1e-13 * b;
        assert!(close(work, 1.4 * square), "{work} {square}");
        assert!(close(space.jump_stress_square(terms()), 3.6f64.powi(2) * square));
        assert!(close(space.jump_stress_square(terms().take(1)), 1.4f64.powi(2) * square));
    }
}
