//! Defects of ways that equal steps, one factor, weak loads and exact solutions leave unseen: the last weight of a
//! recursion on a graded grid, a factor that outlives its weight, rules for kernels that are not smooth, conditions
//! missing on Γ1, given loads with a facet or a cell less.

use std::sync::Arc;

use exact::{ExactOnMesh, Truth};
use fem::contact::{
    CaseError, CaseInfo, Discretization, LoadError, MemoryTerm, Observer, StepView, march,
};
use fem::mesh::Mesh;
use fem::norms::Moments;
use fem::space::Element;
use fem::space::quadrature::{TruthRules, edge, triangle_degree_4};
use formula::EvaluationPoint;
use scene::setup::{MeshData, Setup, TruthLoad, side_numbers};
use scene::{self, Data};
use vhi::Newton;
use vhi::history::{CorrectedEnd, ProductIntegration, TimeGrid, TimeRule, Trapezoid};
use vhi::law::{HistoryKernel, MemoryKernel};

use super::levels::march_stale;
use super::{Defect, Term, marched};

/// The trapezoidal rule, its recursion included, with another last weight of the memory.
struct LastWeight(fn(&TimeGrid, usize) -> f64);

impl TimeRule for LastWeight {
    fn weight(&self, grid: &TimeGrid, n: usize, j: usize) -> f64 {
        Trapezoid.weight(grid, n, j)
    }

    fn kernel_weight(&self, q: &dyn HistoryKernel, grid: &TimeGrid, n: usize, j: usize) -> f64 {
        match n > 0 && j == n {
            true => (self.0)(grid, n) * q.at(grid.time(n), grid.time(n)),
            false => Trapezoid.kernel_weight(q, grid, n, j),
        }
    }

    fn is_trapezoidal(&self) -> bool {
        true
    }
}

/// Where the scene has the trapezoidal rule.
fn last_weight(mut setup: Setup, weight: fn(&TimeGrid, usize) -> f64) -> Setup {
    if setup.model.time_rule.is_trapezoidal() {
        setup.model.time_rule = Box::new(LastWeight(weight));
    }
    setup
}

/// The end weight of kernels like -(t-s)^(1/2) by Riemann's zeta function alone: right in the long run.
struct LongRun;

impl TimeRule for LongRun {
    fn weight(&self, grid: &TimeGrid, n: usize, j: usize) -> f64 {
        Trapezoid.weight(grid, n, j)
    }

    fn kernel_weight(&self, q: &dyn HistoryKernel, grid: &TimeGrid, n: usize, j: usize) -> f64 {
        let end = if n > 0 && j == n { 0.207_886_2 * grid.step(n).powf(1.5) } else { 0.0 };
        Trapezoid.kernel_weight(q, grid, n, j) - end
    }
}

/// Product integration but for the weight at t_n.
struct PlainEnd;

impl TimeRule for PlainEnd {
    fn weight(&self, grid: &TimeGrid, n: usize, j: usize) -> f64 {
        Trapezoid.weight(grid, n, j)
    }

    fn kernel_weight(&self, q: &dyn HistoryKernel, grid: &TimeGrid, n: usize, j: usize) -> f64 {
        match j == n {
            true => Trapezoid.kernel_weight(q, grid, n, j),
            false => ProductIntegration.kernel_weight(q, grid, n, j),
        }
    }
}

fn corrected_end(mut setup: Setup, rule: impl TimeRule + 'static) -> Setup {
    if matches!(setup.scene.time.rule, scene::TimeRule::CorrectedEnd { .. }) {
        setup.model.time_rule = Box::new(rule);
    }
    setup
}

/// A kernel that is no sum of exponentials, changed by its lag.
struct Far {
    sound: Box<dyn MemoryKernel>,
    change: fn(f64, f64) -> f64,
}

impl MemoryKernel for Far {
    fn value(&self, lag: f64) -> f64 {
        (self.change)(self.sound.value(lag), lag)
    }
}

fn summed(mut setup: Setup, change: fn(f64, f64) -> f64) -> Setup {
    let changed = |MemoryTerm { kernel, tensor }: MemoryTerm| match kernel.exponentials() {
        Some(_) => MemoryTerm { kernel, tensor },
        None => MemoryTerm { kernel: Box::new(Far { sound: kernel, change }), tensor },
    };
    setup.model.memory = setup.model.memory.into_iter().map(changed).collect();
    setup
}

/// The facets of Γ1 that lose their condition.
type Freed = fn(&Mesh, &[usize]) -> Vec<usize>;

/// Facets of Γ1 at its ends: one of their vertices is a vertex of no other facet of Γ1.
fn ends(mesh: &Mesh, clamped: &[usize]) -> Vec<usize> {
    let of = |v: &u32| clamped.iter().filter(|&&f| mesh.facet(f).contains(v)).count();
    clamped.iter().copied().filter(|&f| mesh.facet(f).iter().any(|v| of(v) == 1)).collect()
}

/// Solves in the plane with fewer conditions on Γ1, and shows what it finds in the numbers of the sound space.
fn freed(
    setup: &Setup,
    data: &MeshData,
    steps: u32,
    observe: &mut Observer<'_>,
    (which, held): (Freed, bool),
) -> Result<CaseInfo, CaseError> {
    let Data::Exact { interpolated: false, .. } = setup.body.data else {
        return data.march(setup, steps, &Newton::default(), observe);
    };
    if setup.body.element != Element::P1 {
        return data.march(setup, steps, &Newton::default(), observe);
    }
    if setup.exact.is_none() || setup.scene.dimension != 2 {
        return data.march(setup, steps, &Newton::default(), observe);
    }
    let clamped = side_numbers(&setup.body.domain.clamped);
    let mut mesh = data.space.mesh.clone();
    let on: Vec<usize> = mesh.facets_on(&clamped).collect();
    let no_side = mesh.sides.len() as u32;
    for f in which(&mesh, &on) {
        mesh.facet_side[f] = no_side;
    }
    mesh.sides.push("no condition".into());
    let mut symmetry = side_numbers(&setup.body.domain.held());
    symmetry.extend(held.then_some(no_side));
    on_sides(setup, data, steps, observe, (mesh, [&clamped, &symmetry]))
}

/// Solves with these clamped and symmetric sides, and shows what it finds in the numbers of the sound space.
pub(super) fn on_sides(
    setup: &Setup,
    data: &MeshData,
    steps: u32,
    observe: &mut Observer<'_>,
    (mesh, [clamped, symmetry]): (Mesh, [&[u32]; 2]),
) -> Result<CaseInfo, CaseError> {
    let (Some(exact), Data::Exact { form, .. }) = (&setup.exact, &setup.body.data) else {
        return data.march(setup, steps, &Newton::default(), observe);
    };
    let domain = &setup.body.domain;
    let [contact, traction] = [&domain.contact, &domain.traction].map(|sides| side_numbers(sides));
    let sides = [clamped, symmetry, &contact];
    let mut space = Discretization::with_symmetry(setup.body.element, mesh, sides);
    space.regions.clone_from(&data.space.regions);
    let space = Arc::new(space);
    let (d, rules) = (setup.scene.dimension, TruthRules::of(setup.scene.dimension));
    let truth = ExactOnMesh::new(exact.clone(), space.clone(), *form, &traction, &rules);
    let renumbered = |by_nodes: &[f64]| {
        let mut shown = vec![0.0; by_nodes.len()];
        for (node, &v) in space.nodes.vertex.iter().enumerate() {
            let at = data.space.nodes.of_vertex[v as usize] as usize;
            shown[d * at..d * (at + 1)].copy_from_slice(&by_nodes[d * node..d * (node + 1)]);
        }
        shown
    };
    let mut see = |view: &StepView<'_>| {
        let u = renumbered(view.u);
        let history: Vec<Vec<f64>> = view.history.iter().map(|sum| renumbered(sum)).collect();
        observe(&StepView { u: &u, history: &history, ..*view })
    };
    let mut load = TruthLoad(&truth);
    let grid = setup.grid(steps);
    march(&space, &setup.model, &grid, &mut load, &Newton::default(), &mut see)
}

/// Given loads less a part of them.
struct Less {
    sound: Arc<dyn Truth>,
    part: Box<dyn Fn(f64) -> Vec<f64> + Send + Sync>,
}

impl Truth for Less {
    fn load(&self, t: f64) -> Result<Arc<Vec<f64>>, LoadError> {
        let (sound, part) = (self.sound.load(t)?, (self.part)(t));
        Ok(Arc::new(sound.iter().zip(&part).map(|(f, part)| f - part).collect()))
    }

    fn moments(&self, t: f64) -> Result<Arc<Moments>, LoadError> {
        self.sound.moments(t)
    }
}

/// Where a part of a given load acts: its first facet or cell.
#[derive(Clone, Copy)]
enum Lost {
    Facet,
    Cell,
    /// The other component of the traction on the first facet in the place of each.
    Turned,
}

fn without(
    setup: &Setup,
    data: &MeshData,
    steps: u32,
    observe: &mut Observer<'_>,
    lost: Lost,
) -> Result<CaseInfo, CaseError> {
    let Data::Loads { body, traction } = &setup.body.data else {
        return data.march(setup, steps, &Newton::default(), observe);
    };
    let (space, graph) = (data.space.clone(), setup.scene.formulas.clone());
    let (body, traction) = (body.clone(), traction.clone());
    let part = move |t: f64| {
        let mesh = &space.mesh;
        let mut force = vec![0.0; space.nodes.len()];
        let mut add = |simplex: &[u32], measure: f64, formulas: &[formula::Node]| {
            let rule = if simplex.len() == 2 { edge(6) } else { triangle_degree_4() };
            for (shapes, weight) in rule.points.iter().zip(&rule.weights) {
                let [x, y, z] = mesh.point(simplex, shapes);
                for (i, &formula) in formulas.iter().enumerate() {
                    let at = EvaluationPoint { x, y, z, t, ..EvaluationPoint::default() };
                    let value = weight * measure * graph.evaluate(formula, &at);
                    for (&v, shape) in simplex.iter().zip(shapes) {
                        let node = space.nodes.of_vertex[v as usize] as usize;
                        force[2 * node + i] += shape * value;
                    }
                }
            }
        };
        if let Lost::Cell = lost {
            add(mesh.cell(0), space.geometry.measure[0], &body);
            return force;
        }
        for (side, formulas) in &traction {
            let facet = mesh.facets_on(&[side.0]).next().expect("a facet");
            let measure = fem::contact::facet_measure(mesh, facet);
            add(mesh.facet(facet), measure, formulas);
            if let Lost::Turned = lost {
                let turned: Vec<_> = formulas.iter().rev().copied().collect();
                add(mesh.facet(facet), -measure, &turned);
            }
        }
        force
    };
    let less = Less { sound: data.truth.clone(), part: Box::new(part) };
    let data = MeshData::with_truth(data.space.clone(), Arc::new(less));
    data.march(setup, steps, &Newton::default(), observe)
}

macro_rules! freeing {
    ($name:literal, $which:expr) => {
        Defect::of(Term::Dirichlet, $name, |setup| {
            marched(setup, |setup, data, steps, observe| {
                freed(setup, data, steps, observe, ($which, false))
            })
        })
    };
}

macro_rules! losing {
    ($name:literal, $lost:expr) => {
        Defect::of(Term::Load, $name, |setup| {
            marched(setup, |setup, data, steps, observe| {
                without(setup, data, steps, observe, $lost)
            })
        })
    };
}

macro_rules! stale {
    ($name:literal, $checked:literal) => {
        Defect::of(Term::Solver, $name, |setup| {
            marched(setup, |setup, data, steps, observe| {
                march_stale(setup, data, steps, observe, $checked)
            })
        })
    };
}

/// The first half of the facets of Γ1 without a condition, or with u_ν = 0 alone.
pub(super) fn half_freed(setup: Setup, held: bool) -> Setup {
    const HALF: Freed = |_, on| on[..on.len() / 2].to_vec();
    match held {
        true => marched(setup, |setup, data, steps, observe| {
            freed(setup, data, steps, observe, (HALF, true))
        }),
        false => marched(setup, |setup, data, steps, observe| {
            freed(setup, data, steps, observe, (HALF, false))
        }),
    }
}

pub fn defects() -> Vec<Defect> {
    // All of them weigh kernels; the weights of ζ are sound.
    let memory = |name, program| Defect::of(Term::Memory, name, program);
    vec![
        memory("last weight of a recursion frozen after level 1", |setup| {
            last_weight(setup, |grid, _| 0.5 * grid.step(1))
        }),
        memory("last weight of a recursion by the step before", |setup| {
            last_weight(setup, |grid, n| 0.5 * grid.step(n.max(2) - 1))
        }),
        memory("last weight of a recursion by the mean step", |setup| {
            last_weight(setup, |grid, _| 0.5 * grid.time(grid.steps()) / grid.steps() as f64)
        }),
        stale!("factor kept when the last weight changes", true),
        stale!("factor kept when the last weight changes, KKT system not checked", false),
        memory("corrected end for another exponent", |setup| {
            corrected_end(setup, CorrectedEnd { exponent: 0.25 })
        }),
        memory("corrected end of the long run alone", |setup| corrected_end(setup, LongRun)),
        memory("product integration without its end weight", |mut setup| {
            if setup.scene.time.rule == scene::TimeRule::ProductIntegration {
                setup.model.time_rule = Box::new(PlainEnd);
            }
            setup
        }),
        memory("kernel of sums 1 % too strong beyond T/2", |setup| {
            summed(setup, |b, lag| if lag > 0.5 { 1.01 * b } else { b })
        }),
        memory("sums forget lags beyond 3/4 T", |setup| {
            summed(setup, |b, lag| if lag > 0.75 { 0.0 } else { b })
        }),
        freeing!("first corner of Γ1 freed", |mesh, on| ends(mesh, on)[..1].to_vec()),
        freeing!("all ends of Γ1 freed", ends),
        freeing!("an inner node of Γ1 freed", |_, on| on[1..3].to_vec()),
        losing!("first facet of each loaded side without f2", Lost::Facet),
        losing!("f2 turned on the first facet of each loaded side", Lost::Turned),
        losing!("first cell without f0", Lost::Cell),
    ]
}
