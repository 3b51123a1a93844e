//! Loads, exact fields and errors of manufactured scenes beside their solves.

use std::collections::BTreeMap;
use std::hint::black_box;
use std::path::Path;

use cpu_time::ThreadTime;
use fem::norms::step_errors;
use run::sweep::{Overrides, ScenePlan};
use scene::Registry;
use scene::setup::{MeshData, Setup, Subject};
use vhi::Newton;

use super::least;

/// What the cases of a scene cost.
const PARTS: [&str; 5] = ["loads", "exact fields", "errors", "space", "march"];

/// CPU seconds of [`PARTS`] of the cases of a scene, the shortest of 3 runs, every time anew; `cases` are the numbers of steps on
/// each mesh. Cases share their space, and loads and fields of common times. The space is the mesh, the numbering of its
/// unknowns and the analysis of their pattern; points to which formulas are bound belong to the fields, and so does ζ.
fn parts_of(
    registry: &Registry,
    name: &str,
    cases: &BTreeMap<u32, Vec<u32>>,
) -> [f64; PARTS.len()] {
    let once = || {
        let scene = registry.load(name).unwrap_or_else(|error| panic!("{error}"));
        let setup = Setup::new(scene).unwrap_or_else(|error| panic!("{error}"));
        let mut all = [0.0; PARTS.len()];
        for (&n, steps) in cases {
            let parts = parts_on(&setup, n, steps);
            all.iter_mut().zip(parts).for_each(|(all, part)| *all += part);
        }
        all
    };
    let total = |parts: &[f64; PARTS.len()]| parts.iter().sum::<f64>();
    let runs = [(); 3].map(|()| once());
    runs.into_iter().min_by(|a, b| total(a).total_cmp(&total(b))).unwrap_or([f64::NAN; PARTS.len()])
}

/// The same on one mesh, once.
fn parts_on(setup: &Setup, n: u32, steps: &[u32]) -> [f64; PARTS.len()] {
    let mut times: Vec<f64> =
        steps.iter().flat_map(|&steps| setup.grid(steps).times().to_vec()).collect();
    times.sort_by(f64::total_cmp);
    times.dedup();
    // The first one pays for memory that the next ones find.
    drop(black_box(setup.space(n)));
    let space = least(2, || drop(black_box(setup.space(n))));
    let mut data = None;
    let with_points = least(1, || data = Some(MeshData::new(setup, n, None)));
    let data =
        data.map_or_else(|| panic!("one run"), |data| data.unwrap_or_else(|e| panic!("{e}")));
    let binding = (with_points - space).max(0.0);
    let fields = least(1, || {
        data.truth.expect(&times).unwrap_or_else(|error| panic!("{error}"));
        times.iter().for_each(|&t| drop(black_box(data.truth.moments(t))));
    });
    let loads = least(1, || {
        times.iter().for_each(|&t| drop(black_box(data.truth.load(t))));
    });
    let newton = Newton::default();
    // Moments at all times are fields, and paid above.
    let (mut measured, mut observed) = (0.0, 0.0);
    let march = least(1, || {
        for &steps in steps {
            data.march(setup, steps, &newton, &mut |view| {
                let start = ThreadTime::now();
                let moments = data.truth.moments(view.t)?;
                let known = ThreadTime::now();
                black_box(step_errors(&data.space, &setup.model, view, &moments));
                measured += known.elapsed().as_secs_f64();
                observed += start.elapsed().as_secs_f64();
                Ok(())
            })
            .unwrap_or_else(|error| panic!("{error}"));
        }
    }) - observed;
    [loads, binding + fields, measured, space, march]
}

/// Loads, exact fields and errors of manufactured scenes beside the solves, of all cases of the gate and in the finest of
/// them alone. A solve is space and march.
pub fn split(largest: u32, only: &[&String]) {
    println!(
        "| scene | n | N | {} | over the solves | finest case alone | over the march |",
        PARTS.join(" | ")
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|");
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("manufactured");
    let registry = Registry::open(&folder).unwrap_or_else(|error| panic!("{error}"));
    let over = |[loads, fields, errors, space, march]: [f64; PARTS.len()]| {
        let beside = loads + fields + errors;
        [beside / (space + march), beside / march]
    };
    let (mut total, mut below) = ([0.0; PARTS.len()], [0; 3]);
    let mut scenes = 0;
    for name in
        registry.names().filter(|name| only.is_empty() || only.iter().any(|wanted| wanted == name))
    {
        let scene = registry.load(name).unwrap_or_else(|error| panic!("{error}"));
        let Ok(subject) = Subject::new(scene) else { continue };
        let plan = ScenePlan::new(subject, &Overrides::default());
        let Subject::Contact(setup) = &plan.subject else { continue };
        if setup.exact.is_none() {
            continue;
        }
        // Of each mesh its numbers of steps.
        let mut cases: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
        for case in &plan.cases {
            case.n.into_iter().for_each(|n| cases.entry(n).or_default().push(case.steps));
        }
        let Some((&n, steps)) = cases.last_key_value().filter(|(n, _)| **n <= largest) else {
            continue;
        };
        let most = steps.iter().copied().max().unwrap_or(0);
        let alone = BTreeMap::from([(n, vec![most])]);
        let finest = parts_of(&registry, name, &alone);
        let all = if cases == alone { finest } else { parts_of(&registry, name, &cases) };
        let [finest, _] = over(finest);
        let [solves, march] = over(all);
        scenes += 1;
        total.iter_mut().zip(all).for_each(|(total, part)| *total += part);
        for (below, ratio) in below.iter_mut().zip([solves, finest, march]) {
            *below += usize::from(ratio < 1.0);
        }
        println!(
            "| `{name}` | {n} | {most} | {} | {solves:.2} | {finest:.2} | {march:.2} |",
            milliseconds(&all)
        );
    }
    let [solves, march] = over(total);
    println!("| all {scenes} | | | {} | {solves:.2} | | {march:.2} |", milliseconds(&total));
    println!("| below 1 | | | | | | | | {} | {} | {} |", below[0], below[1], below[2]);
}

fn milliseconds(seconds: &[f64]) -> String {
    seconds.iter().map(|s| format!("{:.1}", 1e3 * s)).collect::<Vec<_>>().join(" | ")
}
