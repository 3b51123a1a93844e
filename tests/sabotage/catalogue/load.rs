//! Wrong loads: quadrature, sides, signs; and a body force of another material on the exact side.

use std::sync::Arc;

use exact::constitutive::{Tensor, stress};
use exact::{Exact, MaterialNumbers};
use fem::contact::{Discretization, LoadError, facet_measure, stress_force};
use fem::space::Element;
use fem::space::quadrature::{Rule, TruthRules, edge, triangle_degree_4};
use scene::setup::Setup;

use super::Term::Load;
use super::{Defect, Site};

/// ε and H at points, from the compiled formulas.
fn fields(exact: &Exact, points: &[[f64; 3]], t: f64) -> Vec<(Tensor<2>, Tensor<2>)> {
    let has_memory = !exact.memory.is_empty();
    let mut out = vec![Vec::new(); if has_memory { 8 } else { 5 }];
    exact.interior.bind(points).evaluate(t, 0.0, &mut out);
    let tensor = |first: usize, p: usize| -> Tensor<2> {
        [[out[first][p], out[first + 1][p]], [out[first + 1][p], out[first + 2][p]]]
    };
    let memory = |p: usize| if has_memory { tensor(5, p) } else { [[0.0; 2]; 2] };
    (0..points.len()).map(|p| (tensor(2, p), memory(p))).collect()
}

/// σ of a strain, a memory and κ, under the numbers of a material.
type Law = fn(&MaterialNumbers, &Tensor<2>, &Tensor<2>, f64) -> Tensor<2>;

/// The law itself, with one term of memory.
fn sound(
    material: &MaterialNumbers,
    strain: &Tensor<2>,
    memory: &Tensor<2>,
    kappa: f64,
) -> Tensor<2> {
    stress(material, strain, &[*memory], kappa)
}

/// ∫ σ:ε(v) by a rule.
fn volume(exact: &Exact, space: &Discretization, t: f64, rule: &Rule, law: Law) -> Vec<f64> {
    let cells = 0..space.mesh.cell_count();
    let points: Vec<[f64; 3]> = cells
        .clone()
        .flat_map(|c| rule.points.iter().map(move |b| space.mesh.point(space.mesh.cell(c), b)))
        .collect();
    let (fields, kappa) = (fields(exact, &points, t), exact.kappa(t));
    let mut force = vec![0.0; space.nodes.len()];
    for c in cells {
        let mut sum = [0.0; 3];
        for (q, weight) in rule.weights.iter().enumerate() {
            let (strain, memory) = &fields[rule.weights.len() * c + q];
            let sigma = law(&exact.data.material, strain, memory, kappa);
            let scale = weight * space.geometry.measure[c];
            sum[0] += scale * sigma[0][0];
            sum[1] += scale * sigma[1][1];
            sum[2] += scale * std::f64::consts::SQRT_2 * sigma[0][1];
        }
        let (gradients, nodes) = (space.geometry.gradients(c), space.cell_nodes(c));
        stress_force::<2, 3>(gradients, nodes, &sum, &mut force);
    }
    force
}

/// ∫ f2·v over a side of the unit square, with f2 = σν taken at x = `from` and put at x = `at`.
fn traction(exact: &Exact, space: &Discretization, t: f64, from: f64, at: f64) -> Vec<f64> {
    let (mesh, rule) = (&space.mesh, edge(4));
    let name = if at == 0.0 { "left" } else { "right" };
    let mut force = vec![0.0; space.nodes.len()];
    let Some(side) = mesh.side(name) else { return force };
    let normal = if from == 0.0 { -1.0 } else { 1.0 };
    let facets: Vec<usize> = mesh.facets_on(&[side]).collect();
    for f in facets {
        let points: Vec<[f64; 3]> =
            rule.points.iter().map(|b| [from, mesh.point(mesh.facet(f), b)[1], 0.0]).collect();
        let kappa = exact.kappa(t);
        for (q, (strain, memory)) in fields(exact, &points, t).iter().enumerate() {
            let sigma = sound(&exact.data.material, strain, memory, kappa);
            let scale = rule.weights[q] * facet_measure(mesh, f) * normal;
            for (&vertex, shape) in mesh.facet(f).iter().zip(&rule.points[q]) {
                let node = space.nodes.of_vertex[vertex as usize] as usize;
                force[2 * node] += scale * shape * sigma[0][0];
                force[2 * node + 1] += scale * shape * sigma[1][0];
            }
        }
    }
    force
}

/// The sound load plus `more` - `less`, by the formulas also where the true fields are their interpolants.
fn changed(
    site: &Site<'_>,
    t: f64,
    parts: impl Fn(&Exact) -> (Vec<f64>, Vec<f64>),
) -> Result<Vec<f64>, LoadError> {
    let mut load = site.sound.load(t)?.to_vec();
    // The parts are those of linear functions.
    if let Some(exact) = site.exact.filter(|_| site.space.element == Element::P1) {
        let (more, less) = parts(exact);
        for (value, (more, less)) in load.iter_mut().zip(more.iter().zip(&less)) {
            *value += more - less;
        }
    }
    Ok(load)
}

fn centroid() -> Rule {
    Rule { points: vec![vec![1.0 / 3.0; 3]], weights: vec![1.0] }
}

fn degree_zero(site: &Site<'_>, t: f64) -> Result<Vec<f64>, LoadError> {
    // Where strains are constant on cells every rule is exact.
    if site.interpolated {
        return Ok(site.sound.load(t)?.to_vec());
    }
    changed(site, t, |exact| {
        let at = |rule: &Rule| volume(exact, site.space, t, rule, sound);
        (at(&centroid()), at(&TruthRules::of(2).stress))
    })
}

/// The part of the volume under another law.
fn volume_by(name: &'static str, law: Law) -> Defect {
    Load.load(name, move |site, t| {
        changed(site, t, |exact| {
            let at = |law: Law| volume(exact, site.space, t, &triangle_degree_4(), law);
            (at(law), at(sound))
        })
    })
}

/// The exact side of a scene with other numbers in f0, all else as it is.
fn other_body_force(setup: &mut Setup) {
    let Some(sound) = &setup.exact else { return };
    let mut written = Exact::new(sound.data.clone());
    let mut data = sound.data.clone();
    data.material.memory = data.material.memory.iter().map(|(l, m)| (-l, -m)).collect();
    written.forces = Exact::new(data).forces;
    setup.exact = Some(Arc::new(written));
}

pub fn defects() -> Vec<Defect> {
    vec![
        Load.load("load quadrature of degree 0", degree_zero),
        volume_by(
            "memory part of the load with the other sign",
            |material, strain, memory, kappa| {
                sound(material, strain, &memory.map(|row| row.map(|h| -h)), kappa)
            },
        ),
        volume_by("load without its projection part", |material, strain, memory, _| {
            sound(material, strain, memory, f64::INFINITY)
        }),
        Load.load("f2 of the left side put on the right", |site, t| {
            changed(site, t, |exact| {
                let put = |at: f64| traction(exact, site.space, t, 0.0, at);
                (put(1.0), put(0.0))
            })
        }),
        Load.load("no f2 on the left side", |site, t| {
            changed(site, t, |exact| {
                let left = traction(exact, site.space, t, 0.0, 0.0);
                (vec![0.0; left.len()], left)
            })
        }),
        // By a thousandth of the time unit.
        Load.load("load late by 0.001", |site, t| {
            Ok(site.sound.load((t - 1e-3).max(0.0))?.to_vec())
        }),
        Load.load("load 0.1 % too strong", |site, t| {
            Ok(site.sound.load(t)?.iter().map(|f| 1.001 * f).collect())
        }),
        Load.of("memory part of f0 with the other sign", other_body_force),
    ]
}
