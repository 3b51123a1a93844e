//! Formulas bound to the points of a quadrature rule on many simplices.

use std::sync::{Mutex, PoisonError};

use super::symbolic::components;
use crate::contact::LoadError;
use crate::formula::{Bound, Program};
use crate::mesh::Mesh;
use crate::space::quadrature::Rule;

/// Points with their formulas bound to them.
pub(super) struct Sampled {
    pub(super) rule: Rule,
    pub(super) points: Vec<[f64; 3]>,
    bound: Mutex<Option<Bound>>,
}

impl Sampled {
    /// The points of `rule` on each of the simplices.
    pub(super) fn new<'a>(
        mesh: &Mesh,
        simplices: impl Iterator<Item = &'a [u32]>,
        rule: &Rule,
    ) -> Self {
        let points = simplices
            .flat_map(|simplex| rule.points.iter().map(|b| mesh.point(simplex, b)))
            .collect();
        Self { rule: rule.clone(), points, bound: Mutex::new(None) }
    }

    /// Values of all outputs at all points at time t.
    pub(super) fn evaluate(
        &self,
        program: &Program,
        outputs: usize,
        t: f64,
        zeta: f64,
    ) -> Vec<Vec<f64>> {
        let mut out = vec![Vec::new(); outputs];
        let mut bound = self.bound.lock().unwrap_or_else(PoisonError::into_inner);
        bound.get_or_insert_with(|| program.bind(&self.points)).evaluate(t, zeta, &mut out);
        out
    }
}

/// Refuses values that are not finite, naming the place; `d` coordinates a point.
pub(super) fn finite(
    values: &[Vec<f64>],
    points: &[[f64; 3]],
    d: usize,
    t: f64,
    names: &[String],
) -> Result<(), LoadError> {
    for (field, name) in values.iter().zip(names) {
        if let Some(p) = field.iter().position(|v| !v.is_finite()) {
            let (what, value) = (name.clone(), field[p]);
            return Err(LoadError::NotFinite { what, value, place: points[p][..d].to_vec(), t });
        }
    }
    Ok(())
}

const AXIS_NAMES: [&str; 3] = ["x", "y", "z"];

/// u_x, u_y, …, in dimension d.
pub(super) fn vector_names(symbol: &str, d: usize) -> Vec<String> {
    AXIS_NAMES[..d].iter().map(|axis| format!("{symbol}_{axis}")).collect()
}

/// ε_xx, ε_xy, …, in dimension d.
pub(super) fn tensor_names(symbol: &str, d: usize) -> Vec<String> {
    let name = |(i, j): (usize, usize)| format!("{symbol}_{}{}", AXIS_NAMES[i], AXIS_NAMES[j]);
    components(d).into_iter().map(name).collect()
}
