//! Parts of the solver that tests put in wrong, by functions: weights in time, kernels, yield limits, laws, the solver of a
//! step, schemes.

use std::sync::Arc;

use fem::contact::{CaseError, CaseInfo, MemoryTerm, Model, Observer};
use scene::setup::{MeshData, Scheme, Setup};
use vhi::history::{TimeGrid, TimeRule, Trapezoid};
use vhi::law::{HistoryKernel, MemoryKernel, Potential, YieldLimit};
use vhi::{OpenInequality, Scratch, StepError, StepInfo, StepSolver, StepState};

/// Weights by a function; nothing is promised of them.
pub struct Weights(pub fn(&TimeGrid, usize, usize) -> f64);

impl TimeRule for Weights {
    fn weight(&self, grid: &TimeGrid, n: usize, j: usize) -> f64 {
        (self.0)(grid, n, j)
    }
}

/// Weights of kernels by a function; those without kernel are trapezoidal.
pub struct KernelWeights<F>(pub F);

impl<F> TimeRule for KernelWeights<F>
where
    F: Fn(&dyn HistoryKernel, &TimeGrid, usize, usize) -> f64 + Send + Sync,
{
    fn weight(&self, grid: &TimeGrid, n: usize, j: usize) -> f64 {
        Trapezoid.weight(grid, n, j)
    }

    fn kernel_weight(&self, q: &dyn HistoryKernel, grid: &TimeGrid, n: usize, j: usize) -> f64 {
        (self.0)(q, grid, n, j)
    }
}

/// The right-hand rectangle rule.
pub fn rectangle(grid: &TimeGrid, n: usize, j: usize) -> f64 {
    if n == 0 || j == 0 { 0.0 } else { grid.step(j) }
}

/// The last weight on the level before: an explicit history.
pub fn lagged(grid: &TimeGrid, n: usize, j: usize) -> f64 {
    match n - j {
        0 => 0.0,
        1 => Trapezoid.weight(grid, n, j) + Trapezoid.weight(grid, n, n),
        _ => Trapezoid.weight(grid, n, j),
    }
}

/// The trapezoidal rule with k in place of k/2 at the end.
pub fn last_whole(grid: &TimeGrid, n: usize, j: usize) -> f64 {
    Trapezoid.weight(grid, n, j) * if j == n { 2.0 } else { 1.0 }
}

/// The same at the start.
pub fn first_whole(grid: &TimeGrid, n: usize, j: usize) -> f64 {
    Trapezoid.weight(grid, n, j) * if j == 0 { 2.0 } else { 1.0 }
}

/// A kernel seen through a defect; it does not say what it is a sum of.
struct Through<F> {
    kernel: Box<dyn MemoryKernel>,
    seen: F,
}

impl<F: Fn(&dyn MemoryKernel, f64) -> f64 + Send + Sync> MemoryKernel for Through<F> {
    fn value(&self, lag: f64) -> f64 {
        (self.seen)(&*self.kernel, lag)
    }
}

/// Gives all kernels of a model other values.
pub fn see_kernels<F>(model: &mut Model, seen: F)
where
    F: Fn(&dyn MemoryKernel, f64) -> f64 + Copy + Send + Sync + 'static,
{
    let terms = std::mem::take(&mut model.memory).into_iter();
    let through = |MemoryTerm { kernel, tensor }| MemoryTerm {
        kernel: Box::new(Through { kernel, seen }),
        tensor,
    };
    model.memory = terms.map(through).collect();
}

/// Without the value at lag 0.
pub fn nothing_at_zero(kernel: &dyn MemoryKernel, lag: f64) -> f64 {
    if lag == 0.0 { 0.0 } else { kernel.value(lag) }
}

/// κ = start + slope·ζ.
pub struct Limit {
    pub start: f64,
    pub slope: f64,
}

impl YieldLimit for Limit {
    fn value(&self, zeta: f64) -> f64 {
        self.start + self.slope * zeta
    }

    fn slope(&self, _: f64) -> f64 {
        self.slope
    }
}

/// A law seen through changes of single answers.
pub struct Changed {
    pub sound: Arc<dyn Potential>,
    pub slope: fn(f64) -> f64,
    pub value: fn(f64) -> f64,
    /// Factors of α, c0 and c1.
    pub constants: [f64; 3],
}

impl Changed {
    pub fn new(sound: Arc<dyn Potential>) -> Self {
        Self { sound, slope: |p| p, value: |p| p, constants: [1.0; 3] }
    }
}

impl Potential for Changed {
    fn subdifferential(&self, r: f64) -> (f64, f64) {
        self.sound.subdifferential(r)
    }
    fn value_and_slope(&self, r: f64) -> (f64, f64) {
        let (value, slope) = self.sound.value_and_slope(r);
        ((self.value)(value), (self.slope)(slope))
    }
    fn jumps(&self) -> &[f64] {
        self.sound.jumps()
    }
    fn kinks(&self) -> &[f64] {
        self.sound.kinks()
    }
    fn resolution(&self) -> f64 {
        self.sound.resolution()
    }
    fn alpha(&self) -> f64 {
        self.constants[0] * self.sound.alpha()
    }
    fn growth(&self) -> (f64, f64) {
        let (c0, c1) = self.sound.growth();
        (self.constants[1] * c0, self.constants[2] * c1)
    }
}

/// Solves each step by a function.
pub struct Solver<F>(pub F);

impl<F> StepSolver for Solver<F>
where
    F: Fn(&mut dyn OpenInequality, &mut StepState, &mut Scratch) -> Result<StepInfo, StepError>,
{
    fn solve_level(
        &self,
        problem: &mut dyn OpenInequality,
        state: &mut StepState,
        scratch: &mut Scratch,
    ) -> Result<StepInfo, StepError> {
        (self.0)(problem, state, scratch)
    }
}

struct March<F>(F);

impl<F> Scheme for March<F>
where
    F: Fn(&Setup, &MeshData, u32, &mut Observer<'_>) -> Result<CaseInfo, CaseError> + Send + Sync,
{
    fn march(
        &self,
        setup: &Setup,
        data: &MeshData,
        steps: u32,
        observe: &mut Observer<'_>,
    ) -> Result<CaseInfo, CaseError> {
        (self.0)(setup, data, steps, observe)
    }
}

/// A scheme that marches by a function.
pub fn scheme<F>(march: F) -> Arc<dyn Scheme>
where
    F: Fn(&Setup, &MeshData, u32, &mut Observer<'_>) -> Result<CaseInfo, CaseError>
        + Send
        + Sync
        + 'static,
{
    Arc::new(March(march))
}
