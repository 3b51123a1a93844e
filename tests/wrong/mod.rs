//! Parts of the solver that tests put in wrong, by functions: weights in time, kernels, yield limits, laws, the solver of a
//! step, schemes.

// Each test file compiles this module for itself and uses a part of it.
#![allow(dead_code)]

use std::sync::Arc;

use exact::Truth;
use fem::contact::{CaseError, CaseInfo, LoadError, MemoryTerm, Model, Observer};
use fem::norms::Moments;
use scene::setup::{MeshData, Scheme, Setup};
use vhi::history::{TimeGrid, TimeRule, Trapezoid};
use vhi::law::{HistoryKernel, MemoryKernel, Potential, YieldLimit};
use vhi::{OpenInequality, Scratch, StepError, StepInfo, StepSolver, StepState};

type Weight = Arc<dyn Fn(&TimeGrid, usize, usize) -> f64 + Send + Sync>;
type KernelWeight = Arc<dyn Fn(&dyn HistoryKernel, &TimeGrid, usize, usize) -> f64 + Send + Sync>;

/// A time rule by functions: the weights of ζ, and those of kernels where they are others.
#[derive(Clone)]
pub struct Rule {
    pub zeta: Weight,
    pub memory: Option<KernelWeight>,
    /// Its recursion is that of the trapezoidal rule.
    pub recursive: bool,
    pub last_share: f64,
}

impl TimeRule for Rule {
    fn weight(&self, grid: &TimeGrid, n: usize, j: usize) -> f64 {
        (self.zeta)(grid, n, j)
    }

    fn kernel_weight(&self, q: &dyn HistoryKernel, grid: &TimeGrid, n: usize, j: usize) -> f64 {
        match (&self.memory, self.weight(grid, n, j)) {
            (Some(memory), _) => memory(q, grid, n, j),
            (None, 0.0) => 0.0,
            (None, weight) => weight * q.at(grid.time(n), grid.time(j)),
        }
    }

    fn is_trapezoidal(&self) -> bool {
        self.recursive
    }

    fn last_share(&self) -> f64 {
        self.last_share
    }
}

impl Rule {
    /// The same weights for ζ and for the memory.
    pub fn of(weight: impl Fn(&TimeGrid, usize, usize) -> f64 + Send + Sync + 'static) -> Self {
        Self { zeta: Arc::new(weight), memory: None, recursive: false, last_share: 0.5 }
    }

    /// Weights of the memory, ζ by the trapezoidal rule.
    pub fn memory(
        weight: impl Fn(&dyn HistoryKernel, &TimeGrid, usize, usize) -> f64 + Send + Sync + 'static,
    ) -> Self {
        Self {
            memory: Some(Arc::new(weight)),
            ..Self::of(|grid: &TimeGrid, n, j| Trapezoid.weight(grid, n, j))
        }
    }

    /// Weights of ζ, the memory by the trapezoidal rule.
    pub fn zeta(weight: fn(&TimeGrid, usize, usize) -> f64) -> Self {
        let by_trapezoids =
            |q: &dyn HistoryKernel, grid: &_, n, j| Trapezoid.kernel_weight(q, grid, n, j);
        Self { zeta: Arc::new(weight), ..Self::memory(by_trapezoids) }
    }
}

/// The trapezoidal rule with k in place of k/2 at the end.
pub fn last_whole(grid: &TimeGrid, n: usize, j: usize) -> f64 {
    Trapezoid.weight(grid, n, j) * if j == n { 2.0 } else { 1.0 }
}

/// A kernel by a function of its lag; the sum is direct unless there are exponentials.
pub struct Kernel<F> {
    pub value: F,
    pub exponentials: Option<Vec<(f64, f64)>>,
}

impl<F> Kernel<F> {
    pub fn of(value: F) -> Self {
        Self { value, exponentials: None }
    }
}

impl<F: Fn(f64) -> f64 + Send + Sync> MemoryKernel for Kernel<F> {
    fn value(&self, lag: f64) -> f64 {
        (self.value)(lag)
    }

    fn exponentials(&self) -> Option<&[(f64, f64)]> {
        self.exponentials.as_deref()
    }
}

/// Puts other kernels into a model, each made of the sound one.
pub fn kernels(model: &mut Model, change: impl Fn(Box<dyn MemoryKernel>) -> Box<dyn MemoryKernel>) {
    let memory = std::mem::take(&mut model.memory).into_iter();
    let changed = |term: MemoryTerm| MemoryTerm { kernel: change(term.kernel), ..term };
    model.memory = memory.map(changed).collect();
}

/// Gives all kernels of a model other values.
pub fn see_kernels<F>(model: &mut Model, seen: F)
where
    F: Fn(&dyn MemoryKernel, f64) -> f64 + Copy + Send + Sync + 'static,
{
    kernels(model, |sound| Box::new(Kernel::of(move |lag| seen(&*sound, lag))));
}

/// A kernel of two times by a function.
pub struct OfTimes<F>(pub F);

impl<F: Fn(f64, f64) -> f64> HistoryKernel for OfTimes<F> {
    fn at(&self, t: f64, s: f64) -> f64 {
        (self.0)(t, s)
    }
}

/// Without the value at lag 0.
pub fn nothing_at_zero(kernel: &dyn MemoryKernel, lag: f64) -> f64 {
    if lag == 0.0 { 0.0 } else { kernel.value(lag) }
}

/// A limit through functions of ζ.
pub struct Limit<V, W> {
    pub value: V,
    pub slope: W,
}

impl<V, W> YieldLimit for Limit<V, W>
where
    V: Fn(f64) -> f64 + Send + Sync,
    W: Fn(f64) -> f64 + Send + Sync,
{
    fn value(&self, zeta: f64) -> f64 {
        (self.value)(zeta)
    }
    fn slope(&self, zeta: f64) -> f64 {
        (self.slope)(zeta)
    }
}

/// A law that states other constants, by factors of α, c0 and c1.
pub struct Understated(pub Arc<dyn Potential>, pub [f64; 3]);

impl Potential for Understated {
    fn subdifferential(&self, r: f64) -> (f64, f64) {
        self.0.subdifferential(r)
    }
    fn value_and_slope(&self, r: f64) -> (f64, f64) {
        self.0.value_and_slope(r)
    }
    fn jumps(&self) -> &[f64] {
        self.0.jumps()
    }
    fn kinks(&self) -> &[f64] {
        self.0.kinks()
    }
    fn resolution(&self) -> f64 {
        self.0.resolution()
    }
    fn alpha(&self) -> f64 {
        self.1[0] * self.0.alpha()
    }
    fn growth(&self) -> (f64, f64) {
        let (c0, c1) = self.0.growth();
        (self.1[1] * c0, self.1[2] * c1)
    }
}

/// A truth whose loads are others, made of the sound one at a time.
pub struct Loads<F> {
    pub sound: Arc<dyn Truth>,
    pub load: F,
}

impl<F> Truth for Loads<F>
where
    F: Fn(&dyn Truth, f64) -> Result<Vec<f64>, LoadError> + Send + Sync,
{
    fn load(&self, t: f64) -> Result<Arc<Vec<f64>>, LoadError> {
        (self.load)(&*self.sound, t).map(Arc::new)
    }

    fn moments(&self, t: f64) -> Result<Arc<Moments>, LoadError> {
        self.sound.moments(t)
    }
}

/// A truth with other loads.
pub fn loads<F>(sound: Arc<dyn Truth>, load: F) -> Arc<dyn Truth>
where
    F: Fn(&dyn Truth, f64) -> Result<Vec<f64>, LoadError> + Send + Sync + 'static,
{
    Arc::new(Loads { sound, load })
}

/// Methods of a level as the one in a field has them.
macro_rules! as_level {
    ($level:tt: $($method:ident)*) => { $(crate::wrong::as_level!(@$method $level);)* };
    (@dofs $level:tt) => {
        fn dofs(&self) -> usize { self.$level.dofs() }
    };
    (@graph $level:tt) => {
        fn graph(&self) -> &vhi::BoundaryGraph { self.$level.graph() }
    };
    (@residual $level:tt) => {
        fn residual(&mut self, u: &[f64], out: &mut [f64]) { self.$level.residual(u, out); }
    };
    (@linearize $level:tt) => {
        fn linearize(
            &mut self,
            slopes: &[f64],
            prescribed: &[Option<f64>],
        ) -> Result<(), algebra::linalg::FactorError> {
            self.$level.linearize(slopes, prescribed)
        }
    };
    (@solve $level:tt) => {
        fn solve(
            &mut self,
            rhs: &mut [f64],
            forcing: f64,
        ) -> Result<(), algebra::linalg::FactorError> {
            self.$level.solve(rhs, forcing)
        }
    };
    (@force_scale $level:tt) => {
        fn force_scale(&self, u: &[f64]) -> f64 { self.$level.force_scale(u) }
    };
}
pub(crate) use as_level;

/// Solves each step by a function.
pub struct Solver<F>(F);

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

/// A solver of steps by a function.
pub fn solver<F>(solve: F) -> Solver<F>
where
    F: Fn(&mut dyn OpenInequality, &mut StepState, &mut Scratch) -> Result<StepInfo, StepError>,
{
    Solver(solve)
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
