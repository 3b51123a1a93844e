//! Exact fields on a mesh, given as one or several parts: the nodal forces and the moments of each.
//!
//! The fields at one time are a single part. Fields that separate, Σ_m a_m(t) S_m(x), have as many as they have
//! factors; where σ is linear in them, loads and moments at all times follow from those of the parts.

use super::constitutive::{Tensor, mandel, stress};
use super::exact::Exact;
use super::facet_group::FacetGroup;
use super::nodal_force::{add_stress, facet_measure};
use super::reduction::{deviations, remainders};
use super::sampled::{Sampled, tensor_names, vector_names};
use crate::contact::{Discretization, LoadError};
use crate::formula::Program;
use crate::norms::{CellConstants, Moments, Piecewise};

/// Where the fields come from.
pub(super) struct Parts<'a> {
    pub exact: &'a Exact,
    pub space: &'a Discretization,
    /// Of each cell.
    pub regions: &'a [usize],
    /// [u, ε, H_1, …] and f0 of one part after another.
    pub interior: &'a Program,
    pub forces: &'a Program,
    pub count: usize,
    /// Whether the same formulas are evaluated at other times: they then stay bound to the points.
    pub again: bool,
    pub t: f64,
    pub zeta: f64,
    pub kappa: f64,
}

impl Parts<'_> {
    fn fields(&self) -> usize {
        self.exact.dimension() + self.exact.strain.len() + self.exact.memory.len()
    }

    /// [u, ε, H_1, …] of all parts, how many formulas they are, and the names of those that must be finite.
    fn inside(&self) -> ((&Program, usize), Vec<String>) {
        let d = self.exact.dimension();
        let names = [vector_names("u", d), tensor_names("ε", d)].concat();
        ((self.interior, self.count * self.fields()), self.of_all(names, self.fields()))
    }

    /// The names of one part, or one for each of the fields of several: no number of theirs may be anything else.
    fn of_all(&self, names: Vec<String>, fields: usize) -> Vec<String> {
        if self.again { names } else { vec![String::from("a part"); self.count * fields] }
    }

    /// σ of each part at point p of the values in a region, with ε before it.
    fn stresses<const D: usize>(
        &self,
        (values, p): (&[Vec<f64>], usize),
        region: usize,
        memory: &mut Vec<Tensor<D>>,
        mut put: impl FnMut(usize, &Tensor<D>, &Tensor<D>),
    ) {
        let material = self.exact.material_in(region);
        for (m, part) in values.chunks_exact(self.fields()).enumerate() {
            let strain: Tensor<D> = self.exact.tensors(part, p, memory);
            put(m, &strain, &stress(material, &strain, memory, self.kappa));
        }
    }

    fn zeros(&self) -> Vec<Vec<f64>> {
        vec![vec![0.0; self.space.nodes.len()]; self.count]
    }

    /// ∫ σ:ε(v) of each part, over all nodes.
    pub fn stress_forces<const D: usize>(
        &self,
        points: &Sampled,
    ) -> Result<Vec<Vec<f64>>, LoadError> {
        let space = self.space;
        let (mut forces, rule, mut memory) = (self.zeros(), &points.rule, Vec::new());
        let mut means = vec![[[0.0; D]; D]; self.count];
        let (program, names) = self.inside();
        let at = (self.t, 0.0);
        points.each_block(&space.mesh, program, at, self.again, &names, |cells, values| {
            for (index, c) in cells.enumerate() {
                means.fill([[0.0; D]; D]);
                for (q, weight) in rule.weights.iter().enumerate() {
                    let p = rule.weights.len() * index + q;
                    self.stresses(
                        (values, p),
                        self.regions[c],
                        &mut memory,
                        |m, _, sigma: &Tensor<D>| {
                            let targets = means[m].as_flattened_mut().iter_mut();
                            let pairs = targets.zip(sigma.as_flattened());
                            pairs.for_each(|(target, value)| *target += weight * value);
                        },
                    );
                }
                for (mean, force) in means.iter().zip(&mut forces) {
                    add_stress(&space.mesh, c, space.cell_nodes(c), mean, force);
                }
            }
        })?;
        Ok(forces)
    }

    /// ∫ f0·v of each part, over all nodes.
    pub fn body_forces<const D: usize>(
        &self,
        points: &Sampled,
    ) -> Result<Vec<Vec<f64>>, LoadError> {
        let space = self.space;
        let (mut forces, rule) = (self.zeros(), &points.rule);
        let program = (self.forces, D * self.count);
        let names = self.of_all(vector_names("f0", D), D);
        let at = (self.t, self.zeta);
        points.each_block(&space.mesh, program, at, self.again, &names, |cells, values| {
            for (index, c) in cells.enumerate() {
                let measure = space.geometry.measure[c];
                for (q, weight) in rule.weights.iter().enumerate() {
                    let p = rule.weights.len() * index + q;
                    for (&node, shape) in space.cell_nodes(c).iter().zip(&rule.points[q]) {
                        let weight = weight * measure * shape;
                        for (force, part) in forces.iter_mut().zip(values.chunks_exact(D)) {
                            for (i, field) in part.iter().enumerate() {
                                force[D * node as usize + i] += weight * field[p];
                            }
                        }
                    }
                }
            }
        })?;
        Ok(forces)
    }

    /// Adds ∫ (σν)·v over a group of facets, of each part.
    pub fn add_boundary_stress<const D: usize>(
        &self,
        group: &FacetGroup,
        forces: &mut [Vec<f64>],
    ) -> Result<(), LoadError> {
        let (space, rule, mut memory) = (self.space, &group.strains.rule, Vec::new());
        let (program, names) = self.inside();
        let at = (self.t, 0.0);
        let visit = |facets: std::ops::Range<usize>, values: &[Vec<f64>]| {
            for (local, index) in facets.enumerate() {
                let facet = group.mesh_facets[index];
                let measure = facet_measure(&space.mesh, facet);
                for (q, weight) in rule.weights.iter().enumerate() {
                    let p = rule.weights.len() * local + q;
                    let region = group.regions[index];
                    self.stresses((values, p), region, &mut memory, |m, _, sigma: &Tensor<D>| {
                        for (&vertex, shape) in space.mesh.facet(facet).iter().zip(&rule.points[q])
                        {
                            let node = space.nodes.of_vertex[vertex as usize] as usize;
                            for (i, row) in sigma.iter().enumerate() {
                                let traction: f64 =
                                    row.iter().zip(&group.normal).map(|(s, n)| s * n).sum();
                                forces[m][D * node + i] += weight * measure * shape * traction;
                            }
                        }
                    });
                }
            }
        };
        group.strains.each_block(&space.mesh, program, at, self.again, &names, visit)
    }

    /// Moments of u, ε and σ of all parts.
    pub fn moments<const D: usize>(&self, points: &Sampled) -> Result<PartMoments, LoadError> {
        let (space, rule, parts) = (self.space, &points.rule, self.count);
        let (count, cells) = (rule.weights.len(), space.mesh.cell_count());
        let (numbers, corners) = (self.exact.strain.len(), D + 1);
        let [mut strain, mut stress] =
            [(); 2].map(|()| PartFamily::with_room(parts, numbers * cells));
        let mut displacement = PartFamily::with_room(parts, D * corners * cells);
        let [mut strains, mut stresses] = [(); 2].map(|()| vec![Vec::new(); parts]);
        let mut displacements = vec![vec![0.0; D * count]; parts];
        let (mut memory, mut component) = (Vec::new(), vec![0.0; count]);
        let (program, names) = self.inside();
        let at = (self.t, 0.0);
        points.each_block(&space.mesh, program, at, self.again, &names, |cells, values| {
            for (index, c) in cells.enumerate() {
                strains.iter_mut().chain(&mut stresses).for_each(Vec::clear);
                let points = count * index..count * (index + 1);
                for p in points.clone() {
                    let region = self.regions[c];
                    self.stresses(
                        (values, p),
                        region,
                        &mut memory,
                        |m, strain: &Tensor<D>, sigma| {
                            mandel(strain, &mut strains[m]);
                            mandel(sigma, &mut stresses[m]);
                        },
                    );
                }
                for (list, family) in [(&mut strains, &mut strain), (&mut stresses, &mut stress)] {
                    for (own, vector) in list.iter_mut().zip(&mut family.vectors) {
                        vector.extend_from_slice(&deviations(own, &rule.weights)[..numbers]);
                    }
                }
                for (m, part) in values.chunks_exact(self.fields()).enumerate() {
                    let vector = &mut displacement.vectors[m];
                    let start = vector.len();
                    vector.resize(start + D * corners, 0.0);
                    for (i, field) in part[..D].iter().enumerate() {
                        component.copy_from_slice(&field[points.clone()]);
                        let linear = remainders(&mut component, rule);
                        (0..corners).for_each(|a| vector[start + D * a + i] = linear[a]);
                        (0..count).for_each(|q| displacements[m][D * q + i] = component[q]);
                    }
                }
                let measure = space.geometry.measure[c];
                strain.add_products(&strains, &rule.weights, measure);
                stress.add_products(&stresses, &rule.weights, measure);
                displacement.add_products(&displacements, &rule.weights, measure);
            }
        })?;
        let lengths = [numbers * cells, D * corners * cells];
        Ok(PartMoments { strain, stress, displacement, lengths })
    }
}

/// A field of several parts: what P1 functions can have of each, and the products of what they cannot.
#[derive(Debug, Default)]
pub(super) struct PartFamily {
    /// Cell means, or linear projections by their values at the corners; empty where they vanish.
    vectors: Vec<Vec<f64>>,
    /// Σ_K ∫_K r_m·r_l of the remainders, row by row.
    products: Vec<f64>,
}

impl PartFamily {
    fn with_room(parts: usize, numbers: usize) -> Self {
        let vectors = (0..parts).map(|_| Vec::with_capacity(numbers)).collect();
        Self { vectors, products: vec![0.0; parts * parts] }
    }

    /// Adds the products over one cell; `remainders` hold the numbers point by point, for each of `weights`.
    fn add_products(&mut self, remainders: &[Vec<f64>], weights: &[f64], measure: f64) {
        let parts = remainders.len();
        for m in 0..parts {
            let numbers = remainders[m].len() / weights.len();
            for l in m..parts {
                let mut sum = 0.0;
                let pairs =
                    remainders[m].chunks_exact(numbers).zip(remainders[l].chunks_exact(numbers));
                for ((a, b), weight) in pairs.zip(weights) {
                    sum += weight * a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
                }
                self.products[parts * m + l] += measure * sum;
            }
        }
    }

    /// The field Σ_m a_m S_m; none if it is not finite.
    fn combined(&self, factors: &[f64], length: usize) -> Option<(Vec<f64>, f64)> {
        let parts = factors.len();
        let mut rest = 0.0;
        for m in 0..parts {
            for l in m..parts {
                let twice = if l > m { 2.0 } else { 1.0 };
                rest += twice * factors[m] * factors[l] * self.products[parts * m + l];
            }
        }
        // Parts that cancel leave rounding, of either sign.
        let rest = if rest < 0.0 { 0.0 } else { rest };
        let vector = combined(&self.vectors, factors, length);
        (rest.is_finite() && vector.iter().all(|value| value.is_finite())).then_some((vector, rest))
    }
}

/// Σ_m a_m v_m, of vectors that are empty where they vanish.
pub(super) fn combined(vectors: &[Vec<f64>], factors: &[f64], length: usize) -> Vec<f64> {
    let mut sum = vec![0.0; length];
    for (vector, factor) in vectors.iter().zip(factors) {
        sum.iter_mut().zip(vector).for_each(|(sum, value)| *sum += factor * value);
    }
    sum
}

/// Moments of u, ε and σ in the cells, part by part.
#[derive(Debug, Default)]
pub(super) struct PartMoments {
    strain: PartFamily,
    stress: PartFamily,
    displacement: PartFamily,
    /// Numbers of ε, and of u.
    lengths: [usize; 2],
}

impl PartMoments {
    /// The moments of Σ_m a_m S_m in the cells; none if a number is not finite.
    pub fn at(&self, factors: &[f64]) -> Option<Moments> {
        let [tensors, corners] = self.lengths;
        let constants = |family: &PartFamily| {
            let (mean, rest) = family.combined(factors, tensors)?;
            Some(CellConstants { mean, rest })
        };
        let (strain, stress) = (constants(&self.strain)?, constants(&self.stress)?);
        let (corner, rest) = self.displacement.combined(factors, corners)?;
        let displacement = Piecewise { corner, rest };
        Some(Moments { strain, stress, displacement, ..Moments::default() })
    }

    /// Those of a single part.
    pub fn single(self) -> Moments {
        let [strain, stress, displacement] = [self.strain, self.stress, self.displacement]
            .map(|mut family| (family.vectors.swap_remove(0), family.products[0]));
        let constants = |(mean, rest)| CellConstants { mean, rest };
        let displacement = Piecewise { corner: displacement.0, rest: displacement.1 };
        let (strain, stress) = (constants(strain), constants(stress));
        Moments { strain, stress, displacement, ..Moments::default() }
    }

    /// Forgets vectors of nothing but zeros: the strain of a part that occurs in the memory alone.
    pub fn without_zeros(mut self) -> Self {
        let families = [&mut self.strain, &mut self.stress, &mut self.displacement];
        families.into_iter().for_each(|family| forget_zeros(&mut family.vectors));
        self
    }
}

/// Empties the vectors of zeros.
pub(super) fn forget_zeros(vectors: &mut [Vec<f64>]) {
    for vector in vectors.iter_mut().filter(|vector| vector.iter().all(|value| *value == 0.0)) {
        *vector = Vec::new();
    }
}
