//! CR: linear, continuous at the barycentres of facets alone, where the nodes are. V^h is not in V, and jumps across facets
//! are penalised (`jumps`). On a facet its functions count by their means, their values at the barycentre: a constant.

use crate::space::element::{FiniteElement, Simplex};
use crate::space::quadrature::Rule;

#[derive(Debug)]
pub(super) struct CrouzeixRaviart;

/// The corners on each facet of a cell, in cyclic order: on a triangle 01, 12, 20.
fn facets(dimension: usize) -> impl Iterator<Item = Vec<usize>> {
    let corners = dimension + 1;
    (0..corners).map(move |first| (0..dimension).map(|a| (first + a) % corners).collect())
}

impl FiniteElement for CrouzeixRaviart {
    fn name(&self) -> &'static str {
        "CR"
    }

    fn degree(&self) -> usize {
        1
    }

    fn facet_degree(&self) -> usize {
        0
    }

    fn is_conforming(&self) -> bool {
        false
    }

    fn nodes(&self, simplex: Simplex) -> Vec<Vec<f64>> {
        let d = simplex.dimension();
        if simplex.is_facet() {
            return vec![simplex.barycentre(&Vec::from_iter(0..d))];
        }
        facets(d).map(|facet| simplex.barycentre(&facet)).collect()
    }

    /// One at the barycentre of its facet, zero at those of the others.
    fn values_on(&self, simplex: Simplex, b: &[f64]) -> Vec<f64> {
        if simplex.is_facet() {
            return vec![1.0];
        }
        let d = simplex.dimension();
        let on_facet = |facet: Vec<usize>| facet.iter().map(|&i| b[i]).sum::<f64>();
        facets(d).map(|facet| d as f64 * on_facet(facet) - (d - 1) as f64).collect()
    }

    fn slopes(&self, b: &[f64]) -> Vec<Vec<f64>> {
        let d = b.len() - 1;
        let slope = |facet: &[usize], i: usize| if facet.contains(&i) { d as f64 } else { 0.0 };
        facets(d).map(|facet| (0..=d).map(|i| slope(&facet, i)).collect()).collect()
    }

    fn strain_rule(&self, dimension: usize) -> Rule {
        Rule::barycentre(dimension)
    }

    fn facet_weights(&self, _: usize) -> (Vec<f64>, f64) {
        (vec![1.0], 1.0)
    }
}
