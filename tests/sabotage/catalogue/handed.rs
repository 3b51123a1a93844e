//! Mistakes of solvers that answer `sweep verify` and that the other defects leave out: contact as a whole, penalties, loads
//! that are handed over, conditions on Γ1, pressures. They stand in the matrix of docs/EXTERNAL.md, not in docs/SABOTAGE.md.

use std::sync::Arc;

use exact::Truth;
use fem::contact::{CaseError, CaseInfo, Discretization, LoadError, Observer};
use fem::norms::Moments;
use fem::space::Element;
use run::external::Answer;
use scene::setup::{MeshData, Setup, side_numbers};
use vhi::Newton;
use vhi::law::NoPotential;

use super::contact::{gap, gap_in_time, penalty, rebuilt};
use super::paths::{half_freed, on_sides};
use super::{Defect, Term, marched};

/// The loads of a solver, made of those of the case on its mesh, at t, with steps k.
type Change = fn(&dyn Truth, &Discretization, f64, f64) -> Result<Vec<f64>, LoadError>;

struct Changed {
    sound: Arc<dyn Truth>,
    space: Arc<Discretization>,
    k: f64,
    change: Change,
}

impl Truth for Changed {
    fn load(&self, t: f64) -> Result<Arc<Vec<f64>>, LoadError> {
        (self.change)(&*self.sound, &self.space, t, self.k).map(Arc::new)
    }

    fn moments(&self, t: f64) -> Result<Arc<Moments>, LoadError> {
        self.sound.moments(t)
    }
}

fn under(setup: &Setup, data: &MeshData, steps: u32, change: Change) -> MeshData {
    let (sound, space) = (data.truth.clone(), data.space.clone());
    let k = setup.scene.time.horizon / f64::from(steps);
    MeshData::with_truth(space.clone(), Arc::new(Changed { sound, space, k, change }))
}

fn late(sound: &dyn Truth, _: &Discretization, t: f64, k: f64) -> Result<Vec<f64>, LoadError> {
    Ok(sound.load((t - k).max(0.0))?.to_vec())
}

/// Loads over the integral of their hat functions, taken for nodal values of a density that is then integrated.
fn lumped(
    sound: &dyn Truth,
    space: &Discretization,
    t: f64,
    _: f64,
) -> Result<Vec<f64>, LoadError> {
    let mut load = sound.load(t)?.to_vec();
    let d = space.mesh.dimension;
    if space.element != Element::P1 {
        return Ok(load);
    }
    let (corners, known) = ((d + 1) as f64, load.len());
    load.resize(space.nodes.len(), 0.0);
    let cells =
        || (0..space.mesh.cell_count()).map(|c| (space.cell_nodes(c), space.geometry.measure[c]));
    let mut hat = vec![0.0; load.len() / d];
    for (nodes, measure) in cells() {
        nodes.iter().for_each(|&node| hat[node as usize] += measure / corners);
    }
    let density: Vec<f64> = load.iter().enumerate().map(|(i, f)| f / hat[i / d]).collect();
    let mut out = vec![0.0; load.len()];
    for (nodes, measure) in cells() {
        for i in 0..d {
            let at = |node: &u32| *node as usize * d + i;
            let sum: f64 = nodes.iter().map(|node| density[at(node)]).sum();
            for node in nodes {
                out[at(node)] += measure / (corners * (corners + 1.0)) * (sum + density[at(node)]);
            }
        }
    }
    out.truncate(known);
    Ok(out)
}

/// Nothing at the ends of a facet that is neither on Γ1 nor on Γ3.
fn facet(sound: &dyn Truth, space: &Discretization, t: f64, _: f64) -> Result<Vec<f64>, LoadError> {
    let mut load = sound.load(t)?.to_vec();
    let (mesh, nodes) = (&space.mesh, &space.nodes);
    let touched = |v: &u32| {
        nodes.of_vertex[*v as usize] as usize >= nodes.free
            || space.trace.points.iter().any(|point| point.vertex == *v)
    };
    let free = (0..mesh.facet_side.len()).find(|&f| !mesh.facet(f).iter().any(touched));
    for &vertex in free.map_or(&[][..], |f| mesh.facet(f)) {
        let at = nodes.of_vertex[vertex as usize] as usize * mesh.dimension;
        load[at..at + mesh.dimension].fill(0.0);
    }
    Ok(load)
}

macro_rules! loads {
    ($name:literal, $change:expr) => {
        Defect::of(Term::Load, $name, |setup| {
            marched(setup, |setup, data, steps, observe| {
                let data = under(setup, data, steps, $change);
                data.march(setup, steps, &Newton::default(), observe)
            })
        })
    };
}

/// The setup without law and bound.
fn no_contact(mut setup: Setup) -> Setup {
    for boundary in &mut setup.model.boundary {
        boundary.potential = Arc::new(NoPotential);
        boundary.gap = Box::new(|_, _| f64::INFINITY);
    }
    setup
}

/// On a uniform grid.
fn gap_of_the_level_before(setup: Setup) -> Setup {
    marched(setup, |setup, data, steps, observe| {
        let k = setup.scene.time.horizon / f64::from(steps);
        rebuilt(setup, data, steps, observe, |_, model| {
            let Some(boundary) = model.boundary.first_mut() else { return };
            let sound = std::mem::replace(&mut boundary.gap, Box::new(|_, _| f64::INFINITY));
            boundary.gap = Box::new(move |x, t| sound(x, (t - k).max(0.0)));
        })
    })
}

/// The first gap of a scene whose sides differ on all of them.
fn one_gap(mut setup: Setup) -> Setup {
    if let [_, _, ..] = setup.model.boundary[..] {
        let stated = setup.scene_model().boundary;
        let finite = stated.into_iter().find(|b| (b.gap)([0.0; 3], 0.0).is_finite());
        if let Some(first) = finite.map(|boundary| Arc::new(boundary.gap)) {
            for boundary in &mut setup.model.boundary {
                let first = first.clone();
                boundary.gap = Box::new(move |x, t| first(x, t));
            }
        }
    }
    setup
}

/// Bound and law on -u_ν.
fn turned(setup: Setup) -> Setup {
    marched(setup, |setup, data, steps, observe| {
        rebuilt(setup, data, steps, observe, |space, _| {
            for point in &mut space.trace.points {
                point.normal = point.normal.map(|x| -x);
                point.sign = -point.sign;
            }
        })
    })
}

/// Planes of symmetry with another condition.
fn planes(setup: Setup, clamped: bool) -> Setup {
    let of = if clamped { clamped_planes } else { free_planes };
    if setup.body.domain.symmetry.is_empty() { setup } else { marched(setup, of) }
}

fn clamped_planes(
    setup: &Setup,
    data: &MeshData,
    steps: u32,
    observe: &mut Observer<'_>,
) -> Result<CaseInfo, CaseError> {
    let domain = &setup.body.domain;
    let clamped = side_numbers(&[&domain.clamped[..], &domain.symmetry].concat());
    on_sides(setup, data, steps, observe, (data.space.mesh.clone(), [&clamped, &[]]))
}

fn free_planes(
    setup: &Setup,
    data: &MeshData,
    steps: u32,
    observe: &mut Observer<'_>,
) -> Result<CaseInfo, CaseError> {
    let clamped = side_numbers(&setup.body.domain.clamped);
    on_sides(setup, data, steps, observe, (data.space.mesh.clone(), [&clamped, &[]]))
}

/// Pressures alone are wrong: made of p and the weight of its row.
fn pressed(data: &MeshData, mut answer: Answer, change: fn(f64, f64) -> f64) -> Answer {
    let points = &data.space.trace.points;
    for (value, point) in answer.pressure.iter_mut().flatten().zip(points.iter().cycle()) {
        *value = change(*value, point.weight);
    }
    answer
}

pub fn handed() -> Vec<Defect> {
    let constraint = |name, program| Defect::of(Term::Gap, name, program);
    let handed = |name, answer| Defect { answer, ..Defect::none(Term::Answer, name) };
    vec![
        constraint("no contact: neither law nor gap", no_contact),
        constraint("normal of Γ3 turned inward", turned),
        constraint("gap 5 % too wide", |setup| gap(setup, |_, g| 1.05 * g)),
        constraint("gap 5 % too narrow", |setup| gap(setup, |_, g| 0.95 * g)),
        constraint("gap of t = 0 at all times", |setup| {
            gap_in_time(setup, |sound, x, _| sound(x, 0.0))
        }),
        constraint("gap of the level before", gap_of_the_level_before),
        constraint("penalty 30 in place of the constraint", |setup| penalty(setup, 30.0)),
        constraint("penalty 100 in place of the constraint", |setup| penalty(setup, 100.0)),
        constraint("penalty 1e4 in place of the constraint", |setup| penalty(setup, 1e4)),
        loads!("loads of the level before", late),
        loads!("loads taken for nodal densities and integrated again", lumped),
        loads!("no loads at the ends of one facet", facet),
        Defect::of(Term::Dirichlet, "half of Γ1 freed", |setup| half_freed(setup, false)),
        Defect::of(Term::Dirichlet, "one component alone clamped on half of Γ1", |setup| {
            half_freed(setup, true)
        }),
        Defect::of(Term::Compliance, "laws of two sides exchanged", |mut setup| {
            let sides = |setup: &Setup, i: usize| setup.model.boundary[i].sides.clone();
            if setup.model.boundary.len() == 2 {
                let [a, b] = [0, 1].map(|i| sides(&setup, i));
                (setup.model.boundary[0].sides, setup.model.boundary[1].sides) = (b, a);
            }
            setup
        }),
        constraint("gap of one side on all of Γ3", one_gap),
        Defect::of(Term::Dirichlet, "plane of symmetry forgotten", |setup| planes(setup, false)),
        Defect::of(Term::Dirichlet, "plane of symmetry held along itself too", |setup| {
            planes(setup, true)
        }),
        handed("pressures p handed over as 3 - 7 p", |data, answer| {
            pressed(data, answer, |p, _| 3.0 - 7.0 * p)
        }),
        handed("pressures with the other sign", |data, answer| pressed(data, answer, |p, _| -p)),
        handed("pressures a quarter too low", |data, answer| {
            pressed(data, answer, |p, _| 0.75 * p)
        }),
        handed("forces of the vertices handed over as pressures", |data, answer| {
            pressed(data, answer, |p, weight| weight * p)
        }),
    ]
}
