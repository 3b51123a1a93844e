//! Benchmarks of the parts and of one case; policy in `benches/README.md`.

use std::hint::black_box;
use std::path::Path;

use algebra::linalg::Front;
use criterion::{Criterion, criterion_group, criterion_main};
use fem::contact::march;
use judge::fit::{Claim, Known, Level, infer};
use judge::record::{CaseRecord, L2_MAX, NormError, STRESS_L2_MAX, Status, V_MAX, V_TIME_MAX};
use judge::verdict::{Decision, Prediction, Variable, judge};
use scene::Scene;
use scene::setup::{MeshData, Setup, TruthLoad};
use vhi::history::{Memory, TimeGrid, Trapezoid};
use vhi::law::{ExponentialSum, Projection};
use vhi::{InVolume, Newton};

mod general_kernel;

fn setup(name: &str) -> Setup {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("manufactured/{name}.toml"));
    let scene = Scene::read(&path).unwrap_or_else(|error| panic!("{error}"));
    Setup::new(scene).unwrap_or_else(|error| panic!("{error}"))
}

/// Strains and their memory integrals of a full scene at the points of a mesh.
fn tape(c: &mut Criterion) {
    let setup = setup("pure-strong");
    let exact = setup.exact.as_ref().expect("an exact scene");
    let points: Vec<[f64; 3]> = (0..4096)
        .map(|i| [(f64::from(i % 64) + 0.3) / 64.0, (f64::from(i / 64) + 0.6) / 64.0, 0.0])
        .collect();
    let mut bound = exact.interior.bind(&points);
    let mut out = vec![Vec::new(); 8];
    let mut n = 0u32;
    c.bench_function("tape: u, strain, memory at 4096 points", |b| {
        b.iter(|| {
            n = (n + 1) % 997;
            bound.evaluate(black_box(f64::from(n) / 997.0), 0.0, &mut out);
        });
    });
}

/// All steps of a case, errors excluded.
fn cases(c: &mut Criterion) {
    for (name, n, steps) in [("punch", 32, 8), ("elastic-punch", 32, 8), ("linear-punch", 64, 32)] {
        let setup = setup(name);
        let data = MeshData::new(&setup, n, None).unwrap_or_else(|error| panic!("{error}"));
        let grid = setup.grid(steps);
        c.bench_function(&format!("case: {name} n={n} N={steps}"), |b| {
            b.iter(|| {
                let mut load = TruthLoad(&*data.truth);
                let newton = Newton::default();
                march(&data.space, &setup.model, &grid, &mut load, &newton, &mut |_| Ok(()))
                    .unwrap_or_else(|error| panic!("{error}"))
            });
        });
    }
}

/// Mesh, pattern and analysis; then one factorization and solve.
fn linear_algebra(c: &mut Criterion) {
    let setup = setup("linear-punch");
    c.bench_function("space: mesh, pattern, analysis n=64", |b| {
        b.iter(|| {
            let space = setup.space(black_box(64)).unwrap_or_else(|error| panic!("{error}"));
            space.factor_size()
        });
    });
    let space = setup.space(64).unwrap_or_else(|error| panic!("{error}"));
    let values = space.stiffness(&setup.model.elasticity);
    let analysis = space.analysis().unwrap_or_else(|error| panic!("{error}"));
    let (mut factor, mut workspace) = (analysis.factor(), analysis.workspace());
    let mut x = vec![1.0; space.dofs()];
    c.bench_function("factorization n=64", |b| {
        b.iter(|| analysis.factorize(&space.pattern, &values, &mut factor, &mut workspace));
    });
    c.bench_function("solve n=64", |b| {
        let mut front = Front::default();
        b.iter(|| {
            x.fill(1.0);
            analysis.solve(&factor, black_box(&mut x), &mut front);
        });
    });
}

/// The history of 256 steps, as a sum and as a recursion.
fn history(c: &mut Criterion) {
    let kernel = ExponentialSum { terms: vec![(-1.0, 1.0)] };
    let grid = TimeGrid::uniform(1.0, 256);
    let u = vec![0.5; 1000];
    let run = |mut memory: Memory| {
        let mut past = vec![0.0; u.len()];
        for _ in 0..=grid.steps() {
            memory.past(&kernel, &Trapezoid, &grid, &mut past);
            memory.commit(&grid, &u);
        }
        past
    };
    c.bench_function("history: direct sum, N=256", |b| b.iter(|| run(Memory::direct())));
    c.bench_function("history: recursion, N=256", |b| {
        b.iter(|| run(Memory::new(&kernel, &Trapezoid, &grid, u.len())));
    });
}

/// The sums over 4,096 steps of a kernel that is no sum of exponentials, by interpolation.
fn fast_history(c: &mut Criterion) {
    let grid = TimeGrid::uniform(1.0, 4096);
    let u = vec![0.5; 100];
    c.bench_function("history: interpolated kernel, N=4096", |b| {
        b.iter(|| general_kernel::sums(&grid, &u));
    });
}

/// Cell matrices of one tensor scattered into the pattern; stress and tangent of the projection at many strains.
fn assembly(c: &mut Criterion) {
    let setup = setup("punch");
    let space = setup.space(64).unwrap_or_else(|error| panic!("{error}"));
    c.bench_function("assembly: stiffness n=64", |b| {
        b.iter(|| space.stiffness(black_box(&setup.model.elasticity)));
    });
    let strains: Vec<[f64; 3]> =
        (0..4096).map(|i| [0.2, -0.1, 0.3].map(|e: f64| e * f64::from(i) / 4096.0)).collect();
    c.bench_function("projection: response at 4096 strains", |b| {
        b.iter(|| {
            let responses = strains.iter().map(|e| setup.model.projection.response(e, 0.1));
            responses.flatten().map(|response| response.tangent[0][0]).sum::<f64>()
        });
    });
}

/// The march of `elastic-punch` on Γ3 and in the volume: what condensation is worth.
fn condensed(c: &mut Criterion) {
    let setup = setup("elastic-punch");
    let data = MeshData::new(&setup, 32, None).unwrap_or_else(|error| panic!("{error}"));
    let grid = setup.grid(16);
    let newton = Newton::default();
    c.bench_function("contact: 16 steps condensed, n=32", |b| {
        b.iter(|| {
            let mut load = TruthLoad(&*data.truth);
            march(&data.space, &setup.model, &grid, &mut load, &newton, &mut |_| Ok(()))
        });
    });
    c.bench_function("contact: 16 steps in the volume, n=32", |b| {
        b.iter(|| {
            let mut load = TruthLoad(&*data.truth);
            march(&data.space, &setup.model, &grid, &mut load, &InVolume(newton), &mut |_| Ok(()))
        });
    });
}

/// Tables of four to six levels judged. Policy: below a millisecond each.
fn fit(c: &mut Criterion) {
    let claim = Claim::new(1.0).unwrap_or_else(|error| panic!("{error}"));
    for count in 4..=6 {
        let sizes = (3..3 + count).map(|i| 0.5f64.powi(i));
        let levels: Vec<Level> =
            sizes.filter_map(|h| Level::new(h, h + 4.0 * h * h).ok()).collect();
        c.bench_function(&format!("fit: verdict on {count} levels"), |b| {
            b.iter(|| {
                infer(black_box(&levels), &Known::default()).map(|found| found.decide(&claim))
            });
        });
    }
}

/// Three predictions judged on one scene of 2,500 cases in 4 norms: 10,000 rows of `cases.csv`.
fn judging(c: &mut Criterion) {
    let norms = [V_MAX, L2_MAX, STRESS_L2_MAX, V_TIME_MAX];
    let case = |n: u32, steps: u32| {
        let (h, k) = (1.0 / f64::from(n), 1.0 / f64::from(steps));
        let error = 0.3 * h * (1.0 + h) + 4.0 * k * k;
        let entry =
            |norm: &str| NormError { norm: norm.into(), error: Some(error), floor: Some(1e-14) };
        CaseRecord {
            status: Status::Converged,
            errors: norms.map(entry).to_vec(),
            ..CaseRecord::without_work("grid", Some(n), steps, k)
        }
    };
    let levels = || (0..50).map(|i| (8.0 * 1.1f64.powi(i)).round() as u32 + i as u32);
    let records: Vec<CaseRecord> =
        levels().flat_map(|n| levels().map(move |s| (n, s))).map(|(n, s)| case(n, s)).collect();
    let keys: Vec<_> = records.iter().map(CaseRecord::key).collect();
    let predictions = [(Variable::H, 1.0), (Variable::K, 2.0), (Variable::Joint, 1.0)].map(
        |(variable, order)| Prediction {
            order_k: Some(2.0),
            why: "(5.26)".into(),
            ..Prediction::new(V_MAX, variable, order)
        },
    );
    c.bench_function("judging: 3 predictions from 10,000 rows", |b| {
        b.iter(|| {
            let verdict = |p: &Prediction| judge("grid", &records, &keys, p, Decision::Pass);
            predictions.iter().map(verdict).collect::<Vec<_>>()
        });
    });
}

criterion_group!(
    parts,
    tape,
    cases,
    linear_algebra,
    history,
    fast_history,
    assembly,
    condensed,
    fit,
    judging
);
criterion_main!(parts);
