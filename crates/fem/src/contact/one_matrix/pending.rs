//! A level between its load and its displacements.

use vhi::StepState;

/// A level whose passes are made with those of others.
#[derive(Debug, Clone, Default)]
pub(crate) struct Pending {
    /// n.
    pub n: usize,
    /// t_n.
    pub t: f64,
    /// 1 + βW.
    pub scale: f64,
    /// Weights W_i of the last slot.
    pub slot: Vec<f64>,
    /// F_n, Cartesian.
    pub force: Vec<f64>,
    /// u_n on Γ3 and its pressures.
    pub state: StepState,
}

impl Pending {
    /// Room for a level of so many unknowns and terms of the memory.
    pub(crate) fn new(dofs: usize, terms: usize) -> Self {
        Self { force: vec![0.0; dofs], slot: vec![0.0; terms], ..Self::default() }
    }
}
