//! Moments of fields with constant strain and memory: σ is constant too, and u is linear in space.

use std::sync::{Mutex, PoisonError};

use super::constitutive::{Tensor, mandel, stress};
use super::exact::Exact;
use super::part_moments::{PartFamily, PartMoments};
use super::parts::Parts;
use fem::mesh::Mesh;
use formula::BoundProgram;

/// [u, ε, H_1, …] at the vertices of a mesh.
pub(super) struct Uniform {
    vertices: Mutex<BoundProgram>,
}

impl Uniform {
    pub(crate) fn new(exact: &Exact, mesh: &Mesh) -> Self {
        let points: Vec<[f64; 3]> =
            (0..mesh.vertices()).map(|v| mesh.point(&[v as u32], &[1.0])).collect();
        Self { vertices: Mutex::new(exact.interior.bind(&points)) }
    }

    /// Moments of u, ε and σ; None if a number is not finite.
    pub(crate) fn moments<const D: usize>(&self, parts: &Parts<'_>) -> Option<PartMoments> {
        match D {
            2 => self.of_numbers::<D, 3>(parts),
            _ => self.of_numbers::<D, 6>(parts),
        }
    }

    fn of_numbers<const D: usize, const N: usize>(&self, parts: &Parts<'_>) -> Option<PartMoments> {
        let mut fields = vec![Vec::new(); parts.fields()];
        let lock = || self.vertices.lock().unwrap_or_else(PoisonError::into_inner);
        lock().evaluate(parts.t, 0.0, &mut fields);
        if !fields.iter().flatten().all(|value| value.is_finite()) {
            return None;
        }
        let mut memory: Vec<Tensor<D>> = Vec::new();
        let strain = parts.exact.tensors(|k| fields[k][0], &mut memory);
        let law = parts.exact.material_in(parts.regions[0]);
        let sigma = stress(law, &strain, &memory, parts.kappa);
        let mesh = &parts.space.mesh;
        let everywhere = |tensor: &Tensor<D>| -> PartFamily {
            let numbers: [f64; N] = mandel(tensor);
            PartFamily { vectors: vec![numbers.repeat(mesh.cell_count())], products: vec![0.0] }
        };
        let corners = (0..mesh.cell_count()).flat_map(|c| mesh.cell(c));
        let of_corner = |&v: &u32| fields[..D].iter().map(move |field| field[v as usize]);
        let corner: Vec<f64> = corners.flat_map(of_corner).collect();
        let lengths = [N * mesh.cell_count(), corner.len()];
        let displacement = PartFamily { vectors: vec![corner], products: vec![0.0] };
        let (strain, stress) = (everywhere(&strain), everywhere(&sigma));
        Some(PartMoments { strain, stress, displacement, lengths })
    }
}
