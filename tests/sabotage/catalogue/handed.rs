//! Mistakes of solvers that answer `sweep verify` and that the other defects leave out: contact as a whole, penalties, loads
//! that are handed over, conditions on Γ1, pressures. They stand in the matrix of docs/EXTERNAL.md, not in docs/SABOTAGE.md.

use std::sync::Arc;

use exact::Truth;
use fem::contact::{Discretization, LoadError};
use fem::space::Element;
use run::external::Answer;
use scene::setup::{MeshData, side_numbers};
use vhi::Newton;
use vhi::law::NoPotential;

use super::contact::{gap, penalty};
use super::paths::{half_freed, on_sides};
use super::{Defect, Term};
use crate::wrong;

/// The loads of a solver, made of those of the case on its mesh, at t, with steps k.
type Change = fn(&dyn Truth, &Discretization, f64, f64) -> Result<Vec<f64>, LoadError>;

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

fn loads(name: &'static str, change: Change) -> Defect {
    Term::Load.run(name, move |run| {
        let (sound, space) = (run.data.truth.clone(), run.data.space.clone());
        let (of_space, k) = (space.clone(), run.k());
        let other = move |sound: &dyn Truth, t: f64| change(sound, &of_space, t, k);
        let data = MeshData::with_truth(space, wrong::loads(sound, other));
        data.march(run.setup, run.steps, &Newton::default(), run.observe)
    })
}

/// Planes of symmetry with another condition, where there are any.
fn planes(name: &'static str, is_clamped: bool) -> Defect {
    Term::Dirichlet.run(name, move |run| {
        let domain = &run.setup.body.domain;
        if domain.symmetry.is_empty() {
            return run.sound();
        }
        let planes = if is_clamped { &domain.symmetry[..] } else { &[] };
        let clamped = side_numbers(&[&domain.clamped[..], planes].concat());
        let mesh = run.data.space.mesh.clone();
        on_sides(run, mesh, [&clamped, &[]])
    })
}

/// Pressures alone are wrong: made of p and the weight of its row.
fn pressed(data: &MeshData, answer: &mut Answer, change: fn(f64, f64) -> f64) {
    let points = &data.space.trace.points;
    for (value, point) in answer.pressure.iter_mut().flatten().zip(points.iter().cycle()) {
        *value = change(*value, point.weight);
    }
}

pub fn handed() -> Vec<Defect> {
    let handed = |name, answer| Defect { answer, ..Defect::none(Term::Answer, name) };
    vec![
        Term::Gap.of("no contact: neither law nor gap", |setup| {
            for boundary in &mut setup.model.boundary {
                boundary.potential = Arc::new(NoPotential);
                boundary.gap = Box::new(|_, _| f64::INFINITY);
            }
        }),
        // Bound and law on -u_ν.
        Term::Gap.rebuilt("normal of Γ3 turned inward", |space, _| {
            for point in &mut space.trace.points {
                point.normal = point.normal.map(|x| -x);
                point.sign = -point.sign;
            }
        }),
        gap("gap 5 % too wide", |sound, x, t| 1.05 * sound(x, t)),
        gap("gap 5 % too narrow", |sound, x, t| 0.95 * sound(x, t)),
        gap("gap of t = 0 at all times", |sound, x, _| sound(x, 0.0)),
        // On a uniform grid.
        Term::Gap.run("gap of the level before", |run| {
            let k = run.k();
            run.rebuilt(&|_, model| {
                let Some(boundary) = model.boundary.first_mut() else { return };
                let sound = std::mem::replace(&mut boundary.gap, Box::new(|_, _| f64::INFINITY));
                boundary.gap = Box::new(move |x, t| sound(x, (t - k).max(0.0)));
            })
        }),
        penalty("penalty 30 in place of the constraint", 30.0),
        penalty("penalty 100 in place of the constraint", 100.0),
        penalty("penalty 1e4 in place of the constraint", 1e4),
        loads("loads of the level before", |sound, _, t, k| {
            Ok(sound.load((t - k).max(0.0))?.to_vec())
        }),
        loads("loads taken for nodal densities and integrated again", lumped),
        loads("no loads at the ends of one facet", facet),
        half_freed("half of Γ1 freed", false),
        half_freed("one component alone clamped on half of Γ1", true),
        Term::Compliance.of("laws of two sides exchanged", |setup| {
            if let [a, b] = &mut setup.model.boundary[..] {
                std::mem::swap(&mut a.sides, &mut b.sides);
            }
        }),
        // The first gap of a scene whose sides differ on all of them.
        Term::Gap.of("gap of one side on all of Γ3", |setup| {
            if setup.model.boundary.len() < 2 {
                return;
            }
            let stated = setup.scene_model().boundary;
            let finite = stated.into_iter().find(|b| (b.gap)([0.0; 3], 0.0).is_finite());
            let Some(first) = finite.map(|boundary| Arc::new(boundary.gap)) else { return };
            for boundary in &mut setup.model.boundary {
                let first = first.clone();
                boundary.gap = Box::new(move |x, t| first(x, t));
            }
        }),
        planes("plane of symmetry forgotten", false),
        planes("plane of symmetry held along itself too", true),
        handed("pressures p handed over as 3 - 7 p", |data, answer| {
            pressed(data, answer, |p, _| 3.0 - 7.0 * p);
        }),
        handed("pressures with the other sign", |data, answer| pressed(data, answer, |p, _| -p)),
        handed("pressures a quarter too low", |data, answer| {
            pressed(data, answer, |p, _| 0.75 * p);
        }),
        handed("forces of the vertices handed over as pressures", |data, answer| {
            pressed(data, answer, |p, weight| weight * p);
        }),
    ]
}
