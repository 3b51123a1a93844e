//! P1.

use crate::space::element::{FiniteElement, barycentre};
use crate::space::quadrature::Rule;

#[derive(Debug)]
pub(super) struct Linear;

impl FiniteElement for Linear {
    fn name(&self) -> &'static str {
        "P1"
    }

    fn degree(&self) -> usize {
        1
    }

    fn nodes(&self, corners: usize) -> Vec<Vec<f64>> {
        (0..corners).map(|a| barycentre(&[a], corners)).collect()
    }

    fn values(&self, b: &[f64]) -> Vec<f64> {
        b.to_vec()
    }

    fn slopes(&self, b: &[f64]) -> Vec<Vec<f64>> {
        self.nodes(b.len())
    }

    fn strain_rule(&self, dimension: usize) -> Rule {
        Rule::barycentre(dimension)
    }

    fn facet_weights(&self, dimension: usize) -> (Vec<f64>, f64) {
        (vec![1.0; dimension], dimension as f64)
    }
}
