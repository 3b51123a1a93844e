/// Unknowns of one time level: start value on entry, solution on return.
#[derive(Debug, Default)]
pub struct StepState {
    pub u: Vec<f64>,
    /// c_i per graph: the pressure ξ + λ.
    pub pressure: Vec<f64>,
}

impl Clone for StepState {
    fn clone(&self) -> Self {
        Self { u: self.u.clone(), pressure: self.pressure.clone() }
    }

    /// Reuses memory: levels are kept at every step.
    fn clone_from(&mut self, other: &Self) {
        self.u.clone_from(&other.u);
        self.pressure.clone_from(&other.pressure);
    }
}
