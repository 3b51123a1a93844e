//! Exact histories of I_h u for the prediction, integrated independently, so that errors in the histories of the exact
//! solution show.

use super::adaptive::integral;
use super::cells::{Mandel, inner, strains};
use super::sums::Kernel;
use exact::Exact;
use fem::contact::Discretization;
use fem::mesh::Mesh;
use fem::space::quadrature::Rule;
use formula::{BoundProgram, Program};

/// ∫_0^t b_i(t-s) u(s) ds at the nodes, and ζ(t) = ∫_0^t ‖ε(I_h u(s))‖ ds, advanced from one time to the next.
pub(super) struct OwnHistory<'a, const S: usize> {
    space: &'a Discretization,
    u: BoundProgram,
    kernels: &'a [Kernel],
    t: f64,
    /// ∫_0^t exp(-c (t-s)) u(s) ds of all exponentials in turn, then ζ if needed.
    carried: Vec<f64>,
    rates: Vec<f64>,
    with_zeta: bool,
    /// For kernels without recursion: guards of u at the nodes, and their values at t.
    guards: Option<(BoundProgram, Vec<Vec<f64>>)>,
    /// The ends of steps in which one of these changes sign.
    kinked: Vec<f64>,
}

impl<'a, const S: usize> OwnHistory<'a, S> {
    /// The history of `exact` at t = 0.
    pub(super) fn new(
        exact: &Exact,
        space: &'a Discretization,
        kernels: &'a [Kernel],
        with_zeta: bool,
    ) -> Self {
        let graph = exact.data.graph.clone();
        let program = Program::compile(&graph, &exact.data.u, exact.data.horizon);
        let points = points_of_nodes(space);
        let terms = kernels.iter().flat_map(Kernel::exponentials);
        let rates: Vec<f64> = terms.map(|&(_, rate)| rate).collect();
        let carried = vec![0.0; rates.len() * space.nodes.len() + usize::from(with_zeta)];
        let guards = graph.guards(&exact.data.u);
        let guards = kernels.iter().any(Kernel::is_direct).then(|| {
            let mut values = vec![Vec::new(); guards.len()];
            let program = Program::compile(&graph, &guards, exact.data.horizon);
            let mut bound = program.bind(&points);
            bound.evaluate(0.0, 0.0, &mut values);
            (bound, values)
        });
        let (u, kinked) = (program.bind(&points), Vec::new());
        Self { space, u, kernels, t: 0.0, carried, rates, with_zeta, guards, kinked }
    }

    pub(super) fn displacement(&mut self, t: f64) -> Vec<f64> {
        nodal(&mut self.u, self.space, t)
    }

    pub(super) fn advance(&mut self, to: f64) {
        let Self { space, u, rates, carried, with_zeta, t: from, guards, kinked, .. } = self;
        if let Some((bound, before)) = guards {
            let mut values = vec![Vec::new(); before.len()];
            bound.evaluate(to, 0.0, &mut values);
            let pairs = before.iter().flatten().zip(values.iter().flatten());
            if pairs.into_iter().any(|(a, b)| (*a > 0.0) != (*b > 0.0)) {
                kinked.extend([*from, to]);
            }
            *before = values;
        }
        if carried.is_empty() {
            *from = to;
            return;
        }
        let mut f = |times: &[f64]| -> Vec<Vec<f64>> {
            let at = |&s: &f64| {
                let u = nodal(u, space, s);
                let faded = |rate: &f64| (-rate * (to - s)).exp();
                let mut all: Vec<f64> =
                    rates.iter().flat_map(|rate| u.iter().map(|u| faded(rate) * u)).collect();
                if *with_zeta {
                    let strain: Vec<Mandel<S>> = strains(space, &u);
                    all.push(inner(space, &strain, &strain).sqrt());
                }
                all
            };
            times.iter().map(at).collect()
        };
        let step = to - *from;
        let ends = f(&[*from, to]);
        let trapezoid: Vec<f64> =
            ends[0].iter().zip(&ends[1]).map(|(a, b)| 0.5 * step * (a + b)).collect();
        let added = integral(&[*from, to], &trapezoid, f);
        for (values, rate) in carried.chunks_mut(space.nodes.len()).zip(&*rates) {
            values.iter_mut().for_each(|value| *value *= (-rate * step).exp());
        }
        algebra::linalg::axpy(1.0, &added, carried);
        *from = to;
    }

    /// ∫_0^t b(t-s) u(s) ds of one kernel; `discrete` is the corresponding sum.
    pub(super) fn remembered(&mut self, term: usize, discrete: &[f64]) -> Vec<f64> {
        let (kernel, length) = (&self.kernels[term], self.space.nodes.len());
        if kernel.is_direct() {
            let (u, space) = (&mut self.u, self.space);
            let mut at = |&s: &f64| nodal(u, space, s);
            let v = |times: &[f64]| times.iter().map(&mut at).collect();
            return kernel.integral(self.t, &self.kinked, discrete, v);
        }
        let before: usize = self.kernels[..term].iter().map(|k| k.exponentials().len()).sum();
        let mut sum = vec![0.0; length];
        for ((a, _), values) in
            kernel.exponentials().iter().zip(self.carried.chunks(length).skip(before))
        {
            algebra::linalg::axpy(*a, values, &mut sum);
        }
        sum
    }

    /// ζ(t); 0 if not needed.
    pub(super) fn zeta(&self) -> f64 {
        self.carried.last().copied().filter(|_| self.with_zeta).unwrap_or(0.0)
    }
}

/// The points of a rule, cell by cell.
pub(super) fn points_of_cells(mesh: &Mesh, rule: &Rule) -> Vec<[f64; 3]> {
    (0..mesh.cell_count())
        .flat_map(|c| rule.points.iter().map(move |b| mesh.point(mesh.cell(c), b)))
        .collect()
}

pub(super) fn points_of_nodes(space: &Discretization) -> Vec<[f64; 3]> {
    space.nodes.vertex.iter().map(|&vertex| space.mesh.point(&[vertex], &[1.0])).collect()
}

/// A field at the nodes as a nodal vector.
pub(super) fn nodal(bound: &mut BoundProgram, space: &Discretization, t: f64) -> Vec<f64> {
    let d = space.mesh.dimension;
    let mut fields = vec![Vec::new(); d];
    bound.evaluate(t, 0.0, &mut fields);
    let mut all = vec![0.0; space.nodes.len()];
    for (i, field) in fields.iter().enumerate() {
        all[i..].iter_mut().step_by(d).zip(field).for_each(|(at, value)| *at = *value);
    }
    all
}
