//! Defects of ways that equal steps, one factor, weak loads and exact solutions leave unseen: the last weight of a
//! recursion on a graded grid, a factor that outlives its weight, rules for kernels that are not smooth, conditions
//! missing on Γ1, given loads with a facet or a cell less.

use std::sync::Arc;

use exact::ExactOnMesh;
use fem::contact::{Discretization, StepView, march};
use fem::mesh::Mesh;
use fem::space::Element;
use fem::space::quadrature::{TruthRules, edge, triangle_degree_4};
use formula::EvaluationPoint;
use scene::setup::{MeshData, TruthLoad, side_numbers};
use scene::{self, Data};
use vhi::Newton;
use vhi::history::{CorrectedEnd, ProductIntegration, TimeGrid, TimeRule, Trapezoid};

use super::levels::march_stale;
use super::memory::kernels;
use super::{Defect, Marched, Run, Term};
use crate::wrong::{Kernel, Rule, loads};

/// The trapezoidal rule with another last weight of the memory, its recursion included, where the scene has it.
fn last_weight(name: &'static str, weight: fn(&TimeGrid, usize) -> f64) -> Defect {
    Term::Memory.of(name, move |setup| {
        if setup.model.time_rule.is_trapezoidal() {
            let rule = Rule::memory(move |q, grid, n, j| match n > 0 && j == n {
                true => weight(grid, n) * q.at(grid.time(n), grid.time(n)),
                false => Trapezoid.kernel_weight(q, grid, n, j),
            });
            setup.model.time_rule = Box::new(Rule { recursive: true, ..rule });
        }
    })
}

/// Another rule where the scene has this one.
fn ruled(
    name: &'static str,
    is_of: fn(&scene::TimeRule) -> bool,
    rule: impl TimeRule + Clone + 'static,
) -> Defect {
    Term::Memory.of(name, move |setup| {
        if is_of(&setup.scene.time.rule) {
            setup.model.time_rule = Box::new(rule.clone());
        }
    })
}

/// Kernels that are no sums of exponentials, changed by their lags.
fn summed(name: &'static str, change: fn(f64, f64) -> f64) -> Defect {
    kernels(name, move |sound| match sound.exponentials() {
        Some(_) => sound,
        None => Box::new(Kernel::of(move |lag| change(sound.value(lag), lag))),
    })
}

/// The facets of Γ1 that lose their condition.
type Freed = fn(&Mesh, &[usize]) -> Vec<usize>;

/// Facets of Γ1 at its ends: one of their vertices is a vertex of no other facet of Γ1.
fn ends(mesh: &Mesh, clamped: &[usize]) -> Vec<usize> {
    let of = |v: &u32| clamped.iter().filter(|&&f| mesh.facet(f).contains(v)).count();
    clamped.iter().copied().filter(|&f| mesh.facet(f).iter().any(|v| of(v) == 1)).collect()
}

/// Solves in the plane with fewer conditions on Γ1, or with u_ν = 0 alone, and shows what it finds in the numbers of the sound
/// space.
fn freed(name: &'static str, which: Freed, held: bool) -> Defect {
    Term::Dirichlet.run(name, move |run| {
        let (setup, body) = (run.setup, &run.setup.body);
        let is_smooth = matches!(body.data, Data::Exact { interpolated: false, .. });
        let is_plane = setup.exact.is_some() && setup.scene.dimension == 2;
        if !(is_smooth && is_plane && body.element == Element::P1) {
            return run.sound();
        }
        let clamped = side_numbers(&body.domain.clamped);
        let mut mesh = run.data.space.mesh.clone();
        let on: Vec<usize> = mesh.facets_on(&clamped).collect();
        let no_side = mesh.sides.len() as u32;
        for f in which(&mesh, &on) {
            mesh.facet_side[f] = no_side;
        }
        mesh.sides.push("no condition".into());
        let mut symmetry = side_numbers(&body.domain.held());
        symmetry.extend(held.then_some(no_side));
        on_sides(run, mesh, [&clamped, &symmetry])
    })
}

/// Solves with these clamped and symmetric sides, and shows what it finds in the numbers of the sound space.
pub(super) fn on_sides(run: Run<'_>, mesh: Mesh, [clamped, symmetry]: [&[u32]; 2]) -> Marched {
    let Run { setup, data, steps, .. } = run;
    let (Some(exact), Data::Exact { form, .. }) = (&setup.exact, &setup.body.data) else {
        return run.sound();
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
        (run.observe)(&StepView { u: &u, history: &history, ..*view })
    };
    let mut load = TruthLoad(&truth);
    let grid = setup.grid(steps);
    march(&space, &setup.model, &grid, &mut load, &Newton::default(), &mut see)
}

/// Where a part of a given load acts: its first facet or cell.
#[derive(Clone, Copy)]
enum Lost {
    Facet,
    Cell,
    /// The other component of the traction on the first facet in the place of each.
    Turned,
}

fn losing(name: &'static str, lost: Lost) -> Defect {
    Term::Load.run(name, move |run| {
        let Data::Loads { body, traction } = &run.setup.body.data else { return run.sound() };
        let (space, graph) = (run.data.space.clone(), run.setup.scene.formulas.clone());
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
        let less = loads(run.data.truth.clone(), move |sound, t| {
            Ok(sound.load(t)?.iter().zip(part(t)).map(|(f, part)| f - part).collect())
        });
        let data = MeshData::with_truth(run.data.space.clone(), less);
        data.march(run.setup, run.steps, &Newton::default(), run.observe)
    })
}

/// The first half of the facets of Γ1 without a condition, or with u_ν = 0 alone.
pub(super) fn half_freed(name: &'static str, held: bool) -> Defect {
    freed(name, |_, on| on[..on.len() / 2].to_vec(), held)
}

pub fn defects() -> Vec<Defect> {
    let freeing = |name, which| freed(name, which, false);
    let by_products = |rule: &_| *rule == scene::TimeRule::ProductIntegration;
    let corrected = |rule: &_| matches!(rule, scene::TimeRule::CorrectedEnd { .. });
    // All of these weigh kernels: the weights of ζ are sound.
    vec![
        last_weight("last weight of a recursion frozen after level 1", |grid, _| {
            0.5 * grid.step(1)
        }),
        last_weight("last weight of a recursion by the step before", |grid, n| {
            0.5 * grid.step(n.max(2) - 1)
        }),
        last_weight("last weight of a recursion by the mean step", |grid, _| {
            0.5 * grid.time(grid.steps()) / grid.steps() as f64
        }),
        Term::Solver.run("factor kept when the last weight changes", |run| march_stale(run, true)),
        Term::Solver
            .run("factor kept when the last weight changes, KKT system not checked", |run| {
                march_stale(run, false)
            }),
        ruled("corrected end for another exponent", corrected, CorrectedEnd { exponent: 0.25 }),
        // The end weight of kernels like -(t-s)^(1/2) by Riemann's zeta function: right in the long run.
        ruled(
            "corrected end of the long run alone",
            corrected,
            Rule::memory(|q, grid, n, j| {
                let end = if n > 0 && j == n { 0.207_886_2 * grid.step(n).powf(1.5) } else { 0.0 };
                Trapezoid.kernel_weight(q, grid, n, j) - end
            }),
        ),
        ruled(
            "product integration without its end weight",
            by_products,
            Rule::memory(|q, grid, n, j| match j == n {
                true => Trapezoid.kernel_weight(q, grid, n, j),
                false => ProductIntegration.kernel_weight(q, grid, n, j),
            }),
        ),
        summed(
            "kernel of sums 1 % too strong beyond T/2",
            |b, lag| {
                if lag > 0.5 { 1.01 * b } else { b }
            },
        ),
        summed("sums forget lags beyond 3/4 T", |b, lag| if lag > 0.75 { 0.0 } else { b }),
        freeing("first corner of Γ1 freed", |mesh, on| ends(mesh, on)[..1].to_vec()),
        freeing("all ends of Γ1 freed", ends),
        freeing("an inner node of Γ1 freed", |_, on| on[1..3].to_vec()),
        losing("first facet of each loaded side without f2", Lost::Facet),
        losing("f2 turned on the first facet of each loaded side", Lost::Turned),
        losing("first cell without f0", Lost::Cell),
    ]
}
