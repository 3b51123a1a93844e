//! Why an answer is wrong: what its displacements leave of the discrete equations, level by level.
//!
//! Rows without contact hold elasticity, memory, projection and loads. Each mistake that is tried there leaves a residual of
//! its own; the one that leaves what the answer leaves, with the fewest numbers that are free, is named. Where these rows
//! balance, the forces that are left on Γ3 are those of contact, and are held against the law, the gap and the friction.

use std::collections::BTreeSet;

use algebra::linalg::{axpy, dot, largest, norm};
use exact::Densities;
use fem::contact::{CaseError, MemoryTerm, StepView, out_of_balance};
use scene::setup::{MeshData, Scheme, Setup};
use vhi::history::{TimeGrid, TimeRule, Trapezoid};
use vhi::law::{Convolution, FourthOrder, HistoryKernel, Isotropic, Projection, TensorField};

use super::left::{Left, added};
use super::touch::of_contact;
use judge::verdict::{Cause, Explanation};

/// Residuals below this share of the largest force are tolerances of solvers.
const SOUND: f64 = 1e-5;
/// So are those that a displacement moves which is known in single precision alone: nearly incompressible bodies.
const SINGLE: f64 = 1e-7;
/// A mistake that leaves all but this share of the residual unexplained is not the one.
const FITS: f64 = 1e-2;
/// Residuals that agree to this agree.
const EQUAL: f64 = 1e-9;

/// The cause that the answer of `scheme` to a case shows.
///
/// # Errors
/// Those of the scheme: an answer that is refused.
pub fn cause_of(
    setup: &Setup,
    scheme: &dyn Scheme,
    data: &MeshData,
    steps: u32,
) -> Result<Explanation, CaseError> {
    let (space, model) = (&*data.space, &setup.model);
    let (d, dofs) = (space.mesh.dimension, space.dofs());
    let mut pressed = vec![false; space.nodes.vertex.len()];
    for point in space.trace.points.iter().filter(|point| point.carries()) {
        pressed[point.node as usize] = true;
    }
    let mut left = Left {
        setup,
        data,
        grid: setup.grid(steps),
        u: Vec::new(),
        pressures: Vec::new(),
        balance: Vec::new(),
        scale: f64::MIN_POSITIVE,
        sound: 0.0,
        histories: Vec::new(),
        kappa: Vec::new(),
        norms: Vec::new(),
        loads: Vec::new(),
        rows: (0..dofs).filter(|row| !pressed[row / d]).collect(),
    };
    let none = vec![0.0; space.trace.points.len()];
    scheme.march(setup, data, steps, &mut |view| {
        let load = super::case_files::load(data, view.t)?;
        let alone = StepView { compliance: &none, multiplier: &none, friction: &[], ..*view };
        let mut balance = out_of_balance(space, model, &alone, &load);
        balance.truncate(dofs);
        let inner: Vec<f64> = balance.iter().zip(&*load).map(|(r, f)| r + f).collect();
        left.scale = left.scale.max(largest(&inner)).max(largest(&load));
        left.u.push(view.u.to_vec());
        left.balance.push(balance);
        left.histories.push(view.history.to_vec());
        left.kappa.push(view.kappa);
        left.norms.push(view.strain_norm);
        left.loads.push(load.to_vec());
        let sum = view.compliance.iter().zip(view.multiplier).map(|(xi, lambda)| xi + lambda);
        left.pressures.push(sum.collect());
        Ok(())
    })?;
    let sizes = |values: &[f64]| values.iter().map(|value| value.abs()).collect::<Vec<f64>>();
    let (stiffness, mut moved) = (sizes(&space.stiffness(&model.elasticity)), vec![0.0; dofs]);
    left.sound = SOUND * left.scale;
    for u in &left.u {
        space.pattern.multiply(&stiffness, &sizes(&u[..dofs]), &mut moved);
        left.sound = left.sound.max(SINGLE * largest(&moved));
    }
    let at =
        |n: usize| left.rows.iter().fold(0.0f64, |most, &row| most.max(left.balance[n][row].abs()));
    let off: Vec<f64> = (0..left.u.len()).map(at).collect();
    let most = off.iter().copied().fold(0.0, f64::max);
    let share = |value: f64| match value {
        0.0 => "0".to_owned(),
        _ => format!("{:.0e}", value / left.scale),
    };
    if most <= left.sound {
        let balanced = format!("off Gamma3 the forces balance to {} of the largest", share(most));
        return Ok(of_contact(&left, &balanced));
    }
    if left.u.iter().flatten().all(|u| *u == 0.0) {
        let says = "every displacement is zero".to_owned();
        return Ok(Explanation {
            cause: Cause::Levels,
            says,
            numbers: "nothing was solved".into(),
            fits: true,
        });
    }
    let later = off[1..].iter().copied().fold(0.0, f64::max);
    let mut found = of_body(&left, &off);
    found.numbers = format!(
        "off Gamma3 the forces are out of balance by {} of the largest at level 0 and {} later; {}",
        share(off[0]),
        share(later),
        found.numbers
    );
    Ok(found)
}

/// Takes a mistake: what it leaves by levels, columns whose factors are free or one that is `known`, and its words.
type Offer<'o> = dyn FnMut(Cause, bool, &[Vec<Vec<f64>>], &dyn Fn(&[f64]) -> String) + 'o;

/// The mistake that leaves what the answer leaves, of those in rows without contact.
fn of_body(left: &Left<'_>, off: &[f64]) -> Explanation {
    let residual = left.long(&left.balance);
    // Beside an answer near zero everything is small, and any load fits.
    let inner = left.long(&added(left.balance.clone(), 1.0, &left.loads));
    let size = norm(&residual).min(norm(&inner));
    let mut best: Option<(f64, f64, Cause, String)> = None;
    // A factor that is free has to explain ten times as much.
    let mut better = |rest: f64, free: usize, cause: Cause, says: &dyn Fn() -> String| {
        let score = rest.max(EQUAL) * 10f64.powi(free as i32);
        if rest <= FITS && best.as_ref().is_none_or(|best| score < 0.99 * best.0) {
            best = Some((score, rest, cause, says()));
        }
    };
    let mut offer =
        |cause, known: bool, columns: &[Vec<Vec<f64>>], says: &dyn Fn(&[f64]) -> String| {
            let columns: Vec<Vec<f64>> = columns.iter().map(|column| left.long(column)).collect();
            if known {
                better(norm(&minus(residual.clone(), &columns[0])) / size, 0, cause, &|| says(&[]));
            } else if residual.len() > 3 * columns.len() {
                let (rest, factors) = fit(&columns, &residual);
                better(rest / size, columns.len(), cause, &|| says(&factors));
            }
        };
    of_past(left, &mut offer);
    of_loads(left, &mut offer);
    of_assembly(left, &mut offer);
    of_tensors(left, &mut offer);
    if off[0] > left.sound && off[1..].iter().all(|&off| off <= left.sound) {
        let says = || "level 0 is not solved like the levels that follow from it".to_owned();
        better(0.0, 3, Cause::Levels, &says);
    }
    if let Some(says) = held_along(left) {
        better(0.0, 0, Cause::Symmetry, &|| says.clone());
    }
    if let Some(says) = few_rows(left) {
        better(0.0, 3, Cause::Loads, &|| says.clone());
    }
    if let Some((_, rest, cause, says)) = best {
        let numbers = format!("this mistake leaves {rest:.0e} of it unexplained");
        return Explanation { cause, says, numbers, fits: true };
    }
    let within = |factor: f64, term: &[Vec<f64>]| {
        off.iter().zip(term).all(|(off, term)| *off <= factor * largest(term) + left.sound)
    };
    let unsolved: Vec<String> =
        (1..off.len()).filter(|&n| off[n] > left.sound).map(|n| n.to_string()).collect();
    let levels = format!("levels {} are not solved to the end, as others are", unsolved.join(", "));
    let past = off[0] <= left.sound && within(2.2, &left.remembered(&left.histories));
    // A wrong sum over the past shows on all levels from the first on that it reaches.
    let to_the_end = off.iter().rev().take(unsolved.len()).all(|&off| off > left.sound);
    let (cause, says) = match () {
        () if unsolved.len() + 1 < off.len()
            && left.setup.model.projection.is_none()
            && !(past && to_the_end) =>
        {
            (Cause::Levels, levels.as_str())
        }
        () if past => {
            (Cause::Memory, "the memory: weights, kernel, tensor or sign of the sums over the past")
        }
        () if within(1.1, &left.projected(&left.kappa, false)) => {
            (Cause::Projection, "the projection or zeta: it is no more than the projection adds")
        }
        () => {
            (Cause::Loads, "the loads: no factor of a tensor and no sum over the past leaves this")
        }
    };
    let numbers = "no mistake that was tried leaves just this".to_owned();
    Explanation { cause, says: says.to_owned(), numbers, fits: false }
}

/// Kernel, grid, n and the scene's own weight of level j.
type Weight = fn(&dyn HistoryKernel, &TimeGrid, usize, usize, f64) -> f64;

fn plain(q: &dyn HistoryKernel, grid: &TimeGrid, n: usize, j: usize) -> f64 {
    match Trapezoid.weight(grid, n, j) {
        0.0 => 0.0,
        weight => weight * q.at(grid.time(n), grid.time(j)),
    }
}

/// Sums over the past that are often written in place of the right ones.
const SUMS: [(&str, Weight); 16] = [
    ("is left out", |_, _, _, _, _| 0.0),
    ("has the other sign", |_, _, _, _, own| -own),
    ("is summed by the right-hand rectangle rule", |q, grid, n, j, _| match j {
        0 => 0.0,
        _ => grid.step(j) * q.at(grid.time(n), grid.time(j)),
    }),
    ("is summed by the left-hand rectangle rule", |q, grid, n, j, _| match j == n {
        true => 0.0,
        false => grid.step(j + 1) * q.at(grid.time(n), grid.time(j)),
    }),
    ("has twice the last weight, k and not k/2", |_, _, n, j, own| {
        own * if j == n { 2.0 } else { 1.0 }
    }),
    ("has twice the first weight, k and not k/2", |_, _, _, j, own| {
        own * if j == 0 { 2.0 } else { 1.0 }
    }),
    ("has the weight k at both ends, and not k/2", |_, _, n, j, own| {
        own * if j == 0 || j == n { 2.0 } else { 1.0 }
    }),
    ("has its kernel at t_n - t_j + k", |q, grid, n, j, _| match n {
        0 => 0.0,
        _ => Trapezoid.weight(grid, n, j) * q.at(grid.time(n), grid.time(j) - grid.step(n)),
    }),
    ("is of u_(j-1) in place of u_j", |q, grid, n, j, _| match j == n {
        true => 0.0,
        false => plain(q, grid, n, j + 1),
    }),
    ("is of u_(j-1) in place of u_j, and u_0 before it", |q, grid, n, j, _| {
        let first = if j == 0 { plain(q, grid, n, 0) } else { 0.0 };
        first + if j == n { 0.0 } else { plain(q, grid, n, j + 1) }
    }),
    ("has its last weight on the level before", |q, grid, n, j, _| match n - j {
        0 => 0.0,
        1 => plain(q, grid, n, j) + Trapezoid.weight(grid, n, n) * q.at(grid.time(n), grid.time(j)),
        _ => plain(q, grid, n, j),
    }),
    ("leaves out the level itself", |_, _, n, j, own| if j == n { 0.0 } else { own }),
    ("leaves out the level t = 0", |_, _, _, j, own| if j == 0 { 0.0 } else { own }),
    ("keeps its last term alone", |_, _, n, j, own| if j == n { own } else { 0.0 }),
    ("is summed by the trapezoidal rule", |q, grid, n, j, _| plain(q, grid, n, j)),
    ("is of u_(j-1) in place of u_j, but for the level itself", |q, grid, n, j, _| {
        let first = if j == 0 && n > 0 { plain(q, grid, n, 0) } else { 0.0 };
        match n - j {
            0 => plain(q, grid, n, n),
            1 => first,
            _ => first + plain(q, grid, n, j + 1),
        }
    }),
];

/// The kernel of ζ.
struct One;

impl HistoryKernel for One {
    fn at(&self, _: f64, _: f64) -> f64 {
        1.0
    }
}

/// Memory, ζ and projection.
fn of_past(left: &Left<'_>, offer: &mut Offer<'_>) {
    let (model, grid, rule) = (&left.setup.model, &left.grid, &*left.setup.model.time_rule);
    let levels = 0..left.u.len();
    let projected = left.projected(&left.kappa, false);
    let by_zeta = |zeta: &dyn Fn(usize) -> f64| {
        let limit = model.projection.limit()?;
        let kappa: Vec<f64> = levels.clone().map(|n| limit.value(zeta(n))).collect();
        Some(added(projected.clone(), -1.0, &left.projected(&kappa, false)))
    };
    let summed = |n: usize, weight: &dyn Fn(usize) -> f64| {
        (0..=n).map(|j| weight(j) * left.norms[j]).sum::<f64>()
    };
    for (name, sum) in SUMS {
        let of_level = |n: usize| {
            let of_term = |term: &MemoryTerm| {
                let (kernel, mut apart) = (Convolution(&*term.kernel), vec![0.0; left.u[n].len()]);
                for j in 0..=n {
                    let own = rule.kernel_weight(&kernel, grid, n, j);
                    axpy(own - sum(&kernel, grid, n, j, own), &left.u[j], &mut apart);
                }
                apart
            };
            model.memory.iter().map(of_term).collect()
        };
        let memory = left.remembered(&levels.clone().map(of_level).collect::<Vec<_>>());
        let other = |n: usize| summed(n, &|j| sum(&One, grid, n, j, rule.weight(grid, n, j)));
        if let Some(zeta) = by_zeta(&other) {
            let both = added(memory.clone(), 1.0, &zeta);
            offer(Cause::Projection, true, &[zeta], &|_| format!("zeta {name}"));
            offer(Cause::Memory, true, &[both], &|_| format!("the memory, and zeta, {name}"));
        }
        // A kernel may be infinite where another rule takes it.
        if memory.iter().flatten().all(|force| force.is_finite()) {
            offer(Cause::Memory, true, &[memory], &|_| format!("the memory {name}"));
        }
    }
    if let Some(column) = by_zeta(&|n| summed(n, &|j| rule.weight(grid, n, j) * left.norms[j])) {
        offer(Cause::Projection, true, &[column], &|_| "zeta sums squares of norms".into());
        let whole = added(projected.clone(), -1.0, &left.projected(&left.kappa, true));
        let says = "the projection is of the strain, not of its deviator";
        offer(Cause::Projection, true, &[whole], &|_| says.into());
        offer(Cause::Projection, true, &[projected], &|_| "the projection is left out".into());
    }
    let says = |c: &[f64]| format!("the memory is taken {:.4} times", 1.0 - c[0]);
    offer(Cause::Memory, false, &[left.remembered(&left.histories)], &says);
}

fn of_loads(left: &Left<'_>, offer: &mut Offer<'_>) {
    let loads = left.loads.clone();
    let late = |n: usize| minus(loads[n.saturating_sub(1)].clone(), &loads[n]);
    let column = [(0..loads.len()).map(late).collect()];
    offer(Cause::Loads, true, &column, &|_| "the loads are those of the level before".into());
    offer(Cause::Loads, false, &column, &|c| {
        format!("the loads are late by {:.4} of a step, between two levels", c[0])
    });
    // dF/dt by a difference over a share of a step.
    let slope = |n: usize| {
        let (t, by) = (left.grid.time(n), 1e-4 * left.grid.largest_step());
        match left.data.truth.load(t - by) {
            Ok(before) if n > 0 => {
                minus(before.to_vec(), &loads[n]).iter().map(|f| f / by).collect()
            }
            _ => vec![0.0; loads[n].len()],
        }
    };
    let column = (0..loads.len()).map(slope).collect();
    offer(Cause::Loads, false, &[column], &|c| format!("the loads are late by {:.1e}", c[0]));
    offer(Cause::Loads, false, &[loads], &|c| {
        format!("the loads are taken {:.4} times", 1.0 + c[0])
    });
}

/// Mistakes of who assembles the loads himself.
fn of_assembly(left: &Left<'_>, offer: &mut Offer<'_>) {
    let (space, truth) = (&*left.data.space, &left.data.truth);
    let all = left.grid.times().iter().map(|&t| truth.densities(t));
    let Ok(Some(all)) = all.collect::<Result<Option<Vec<Densities>>, _>>() else { return };
    let by = |flat: bool, change: &dyn Fn(&mut Densities)| -> Vec<Vec<f64>> {
        let assembled = |densities: &Densities| {
            let mut densities = densities.clone();
            change(&mut densities);
            densities.assembled(space, flat)
        };
        all.iter().map(assembled).collect()
    };
    let body = |densities: &mut Densities| densities.traction.fill(0.0);
    let traction = |densities: &mut Densities| densities.body.fill(0.0);
    let mesh = &space.mesh;
    let mut parts = vec![("f0".to_owned(), by(false, &body)), ("f2".into(), by(false, &traction))];
    for (side, name) in mesh.sides.iter().enumerate() {
        let of_side = by(false, &|densities| {
            densities.body.fill(0.0);
            let count = densities.traction.len() / mesh.facet_side.len();
            let facets = densities.traction.chunks_mut(count).zip(&mesh.facet_side);
            let others = facets.filter(|(_, of)| **of as usize != side);
            others.for_each(|(values, _)| values.fill(0.0));
        });
        parts.push((format!("f2 on side {name}"), of_side));
    }
    let acts = |part: &[Vec<f64>]| part.iter().any(|level| largest(level) > left.sound);
    for (name, part) in parts.iter().filter(|(_, part)| acts(part)) {
        let none = part.iter().map(|level| level.iter().map(|f| -f).collect()).collect();
        offer(Cause::Loads, true, &[none], &|_| format!("the loads: {name} is left out"));
        offer(Cause::Loads, false, std::slice::from_ref(part), &|c| {
            format!("the loads: {name} is taken {:.4} times", 1.0 + c[0])
        });
    }
    let lumped = [
        ("cells and facets", by(true, &|_| ()), by(false, &|_| ())),
        ("cells", by(true, &body), parts[0].1.clone()),
        ("facets", by(true, &traction), parts[1].1.clone()),
    ];
    for (which, flat, full) in lumped {
        offer(Cause::Loads, true, &[added(flat, -1.0, &full)], &|_| {
            format!(
                "the loads are lumped: {which} give equal shares to their nodes, as a rule of one point does"
            )
        });
    }
    let whole = by(false, &|_| ());
    let mut weighed = |says: String, weights: &dyn Fn(&mut Densities)| {
        let column = added(by(false, weights), -1.0, &whole);
        offer(Cause::Loads, true, &[column], &|_| says.clone());
    };
    weighed("the loads: the points of a rule have equal weights".into(), &|densities| {
        for rule in &mut densities.rules {
            let share = 1.0 / rule.weights.len() as f64;
            rule.weights.fill(share);
        }
    });
    for (i, which) in ["cells", "facets"].into_iter().enumerate() {
        let count = all.first().map_or(0, |densities| densities.rules[i].weights.len());
        for q in 0..count {
            let says = format!("the loads: {which} take point {q} of their rule alone");
            weighed(says, &|densities| {
                let weights = &mut densities.rules[i].weights;
                weights
                    .iter_mut()
                    .enumerate()
                    .for_each(|(at, w)| *w = f64::from(u8::from(at == q)));
            });
        }
    }
}

fn of_tensors(left: &Left<'_>, offer: &mut Offer<'_>) {
    let (model, d) = (&left.setup.model, left.data.space.mesh.dimension);
    let regions = model.elasticity.regions().len();
    let on = |region: usize, tensor: FourthOrder| {
        let zero = FourthOrder::Isotropic(Isotropic { lambda: 0.0, mu: 0.0 });
        let of = |at: usize| if at == region { tensor } else { zero };
        TensorField::new(of(0), (1..regions).map(of))
    };
    let lame = [(1.0, 0.0), (0.0, 1.0)].map(|(lambda, mu)| Isotropic { lambda, mu }.into());
    // One tensor on all regions, where there are several.
    for region in (0..regions).filter(|_| regions > 1) {
        let everywhere = |own: &TensorField| TensorField::from(*own.on(region));
        let elastic = left.stiff(&everywhere(&model.elasticity), &left.u);
        let elastic = added(left.stiff(&model.elasticity, &left.u), -1.0, &elastic);
        let memory = added(
            left.remembered(&left.histories),
            -1.0,
            &left.remembered_by(&everywhere, &left.histories),
        );
        let whole = added(memory, 1.0, &elastic);
        for (column, which) in [(elastic, "elasticity"), (whole, "elasticity and memory")] {
            offer(Cause::Elasticity, true, &[column], &|_| {
                format!("all regions have the {which} of region {region} of cells.csv")
            });
        }
    }
    for region in 0..regions {
        if let FourthOrder::Isotropic(law) = *model.elasticity.on(region) {
            let says = |c: &[f64]| {
                let [lambda, mu] = [law.lambda - c[0], law.mu - c[1]];
                format!(
                    "the elasticity has lambda = {lambda:.4}, mu = {mu:.4}, not {}, {}",
                    law.lambda, law.mu
                )
            };
            offer(
                Cause::Elasticity,
                false,
                &lame.map(|tensor| left.stiff(&on(region, tensor), &left.u)),
                &says,
            );
        }
        let order = d * (d + 1) / 2;
        let entries: Vec<_> = (0..order).flat_map(|a| (a..order).map(move |b| (a, b))).collect();
        let of_entry = |&(a, b): &(usize, usize)| {
            let mut matrix = [[0.0; 6]; 6];
            (matrix[a][b], matrix[b][a]) = (1.0, 1.0);
            left.stiff(&on(region, FourthOrder::Full(matrix)), &left.u)
        };
        let columns: Vec<_> = entries.iter().map(of_entry).collect();
        let says = |c: &[f64]| {
            let off = entries.iter().zip(c).filter(|(_, c)| c.abs() > SOUND);
            let off: Vec<String> =
                off.map(|((a, b), c)| format!("{}{} by {:.4}", a + 1, b + 1, -c)).collect();
            format!("the elasticity has another Mandel matrix: entries off are {}", off.join(", "))
        };
        offer(Cause::Elasticity, false, &columns, &says);
    }
    // A mistake that the tensors of elasticity and memory share.
    let of = |tensor: FourthOrder| {
        let field: TensorField = tensor.into();
        let of_term = |i: usize| {
            let sums: Vec<Vec<f64>> = left.histories.iter().map(|sums| sums[i].clone()).collect();
            left.stiff(&field, &sums)
        };
        std::iter::once(left.stiff(&field, &left.u))
            .chain((0..model.memory.len()).map(of_term))
            .collect::<Vec<_>>()
    };
    let columns: Vec<_> = lame.into_iter().flat_map(of).collect();
    offer(Cause::Elasticity, false, &columns, &|_| "the tensors of elasticity and memory".into());
    let mut shear = [[0.0; 6]; 6];
    (d..d * (d + 1) / 2).for_each(|a| shear[a][a] = 1.0);
    let says = "the tensors have other shear entries: sigma12 = 2 mu eps12, which is mu gamma12 where a matrix takes gamma12 = 2 eps12";
    offer(Cause::Elasticity, false, &of(FourthOrder::Full(shear)), &|_| says.into());
}

/// The nodes that are out of balance at some level.
fn wrong_nodes(left: &Left<'_>) -> BTreeSet<usize> {
    let d = left.data.space.mesh.dimension;
    let wrong = |level: &Vec<f64>| -> Vec<usize> {
        let rows = left.rows.iter().filter(|&&row| level[row].abs() > left.sound);
        rows.map(|row| row / d).collect()
    };
    left.balance.iter().flat_map(wrong).collect()
}

/// The words where all nodes that are out of balance lie on planes of symmetry, and do not move.
fn held_along(left: &Left<'_>) -> Option<String> {
    let (space, d) = (&*left.data.space, left.data.space.mesh.dimension);
    let still =
        |node: usize| left.u.iter().all(|u| u[d * node..d * (node + 1)].iter().all(|u| *u == 0.0));
    let on: Vec<usize> = space
        .supports
        .iter()
        .map(|at| space.nodes.of_vertex[at.vertex as usize] as usize)
        .collect();
    wrong_nodes(left).iter().all(|node| on.contains(node) && still(*node)).then(|| {
        "planes of symmetry do not move at all: there u_nu = 0 alone, and the rest is free (symmetry.csv)".to_owned()
    })
}

/// The words where few nodes, or one side alone, are out of balance.
fn few_rows(left: &Left<'_>) -> Option<String> {
    let (space, d) = (&*left.data.space, left.data.space.mesh.dimension);
    let wrong = wrong_nodes(left);
    let place = |&node: &usize| {
        let x = space.mesh.vertex(space.nodes.vertex[node]);
        let x: Vec<String> = x.iter().map(|x| format!("{x:.4}")).collect();
        format!("({})", x.join(", "))
    };
    if wrong.len() <= 2 * d && space.nodes.free > 8 * wrong.len() {
        let places: Vec<String> = wrong.iter().map(place).collect();
        return Some(format!("the loads at {}: all other rows balance", places.join(" and ")));
    }
    let mesh = &space.mesh;
    let on = |node: usize, side: Option<u32>| {
        let mut facets = (0..mesh.facet_side.len())
            .filter(|&f| side.is_none_or(|side| mesh.facet_side[f] == side));
        facets.any(|f| space.nodes.on_facet(f).contains(&space.nodes.vertex[node]))
    };
    let inside = (0..space.nodes.free).filter(|&node| !on(node, None)).count() > 3;
    let whole = |side: &u32| wrong.iter().all(|&node| on(node, Some(*side)));
    let side = (0..mesh.sides.len() as u32).find(whole).filter(|_| inside)?;
    Some(format!("the loads of side {}: all other rows balance", mesh.sides[side as usize]))
}

/// What is left of `r` by columns, least squares, and their factors; columns that follow from others have none.
fn fit(columns: &[Vec<f64>], r: &[f64]) -> (f64, Vec<f64>) {
    let mut rest = r.to_vec();
    let mut known: Vec<(Vec<f64>, Vec<f64>)> = Vec::new();
    let mut factors = vec![0.0; columns.len()];
    for (i, column) in columns.iter().enumerate() {
        let mut direction = column.clone();
        let mut made = vec![0.0; columns.len()];
        made[i] = 1.0;
        // Twice, for rounding.
        for (other, of_other) in known.iter().chain(&known) {
            let along = dot(&direction, other);
            axpy(-along, other, &mut direction);
            made.iter_mut().zip(of_other).for_each(|(made, other)| *made -= along * other);
        }
        let length = norm(&direction);
        if length <= EQUAL * norm(column) {
            continue;
        }
        direction.iter_mut().chain(&mut made).for_each(|value| *value /= length);
        let along = dot(&rest, &direction);
        axpy(-along, &direction, &mut rest);
        factors.iter_mut().zip(&made).for_each(|(factor, made)| *factor += along * made);
        known.push((direction, made));
    }
    (norm(&rest), factors)
}

fn minus(mut a: Vec<f64>, b: &[f64]) -> Vec<f64> {
    a.iter_mut().zip(b).for_each(|(a, b)| *a -= b);
    a
}
