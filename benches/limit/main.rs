//! How far a step is from the traffic of its factor, and how its cost grows; policy and results in `benches/README.md`.
//! Informs where the solver is worth work: what is near the limit is left alone. Not a benchmark of criterion's: sizes
//! are compared with each other, not with the last run. `cargo bench --bench limit`; with `--test` on small sizes.

use std::hint::black_box;
use std::path::Path;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use algebra::linalg::Front;
use cpu_time::ThreadTime;
use fem::contact::{kkt_residual, march, strain_norm};
use scene::Scene;
use scene::setup::{MeshData, Setup, TruthLoad};
use statrs::distribution::{ContinuousCDF, StudentsT};
use vhi::Newton;
use vhi::history::TimeGrid;

mod cliffs;
#[path = "../general_kernel/mod.rs"]
mod general_kernel;
mod split;

fn setup(name: &str) -> Setup {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("manufactured/{name}.toml"));
    let scene = Scene::read(&path).unwrap_or_else(|error| panic!("{error}"));
    Setup::new(scene).unwrap_or_else(|error| panic!("{error}"))
}

/// Least CPU seconds of some runs.
fn least(runs: usize, mut run: impl FnMut()) -> f64 {
    let once = |_| {
        let start = ThreadTime::now();
        run();
        start.elapsed().as_secs_f64()
    };
    (0..runs).map(once).fold(f64::INFINITY, f64::min)
}

/// Bytes a second of reading an array of so many doubles over and over, the better of CPU and wall time.
fn bandwidth(doubles: usize) -> f64 {
    let data = vec![1.0f64; doubles];
    let passes = (40_000_000 / doubles).max(2);
    let read = || {
        let (blocks, _) = data.as_chunks::<32>();
        let mut lanes = [0.0; 32];
        for block in blocks {
            for l in 0..32 {
                lanes[l] += block[l];
            }
        }
        black_box(lanes);
    };
    let mut best = f64::INFINITY;
    for _ in 0..5 {
        let start = Instant::now();
        (0..passes).for_each(|_| read());
        best = best.min(start.elapsed().as_secs_f64());
    }
    (8 * doubles * passes) as f64 / best
}

fn seconds_a_step(setup: &Setup, data: &MeshData, [few, many]: [u32; 2]) -> f64 {
    let run = |steps: u32| {
        least(3, || {
            let (grid, newton) = (setup.grid(steps), Newton::default());
            let mut load = TruthLoad(&*data.truth);
            march(&data.space, &setup.model, &grid, &mut load, &newton, &mut |_| Ok(()))
                .unwrap_or_else(|error| panic!("{error}"));
        })
    };
    (run(many) - run(few)) / f64::from(many - few)
}

/// Seconds of what a step does beside its solve: the KKT residual and ‖ε(u)‖, each from strains.
fn checks(setup: &Setup, data: &MeshData) -> [f64; 2] {
    let (grid, newton, mut seconds) = (setup.grid(1), Newton::default(), [f64::NAN; 2]);
    let mut load = TruthLoad(&*data.truth);
    march(&data.space, &setup.model, &grid, &mut load, &newton, &mut |view| {
        let force = data.truth.load(view.t)?;
        let residual = || kkt_residual(&data.space, &setup.model, view, &force);
        let norm = || strain_norm(&data.space, view.u);
        seconds = [least(5, || _ = black_box(residual())), least(5, || _ = black_box(norm()))];
        Ok(())
    })
    .unwrap_or_else(|error| panic!("{error}"));
    seconds
}

fn limit(sizes: &[u32]) {
    println!(
        "| n | unknowns | MB of L | GB/s | limit, ms | solve | step | its KKT residual | its norm |"
    );
    println!("|---|---|---|---|---|---|---|---|---|");
    let setup = setup("linear-punch");
    for &n in sizes {
        let data = MeshData::new(&setup, n, None).unwrap_or_else(|error| panic!("{error}"));
        let space = &data.space;
        let values = space.stiffness(&setup.model.elasticity);
        let analysis = space.analysis().unwrap_or_else(|error| panic!("{error}"));
        let mut factor = analysis.factor();
        let (mut workspace, pattern) = (analysis.workspace(), &space.pattern);
        let done = analysis.factorize(pattern, &values, &mut factor, &mut workspace);
        assert!(done.is_ok());
        let entries = analysis.factor_entries();
        let bandwidth = bandwidth(entries);
        let limit = (16 * entries) as f64 / bandwidth;
        let (mut x, mut front) = (vec![1.0; space.dofs()], Front::default());
        let solve = least(if x.len() > 100_000 { 5 } else { 20 }, || {
            x.fill(1.0);
            analysis.solve(&factor, &mut x, &mut front);
        });
        drop(factor);
        let steps = if n > 256 { [2, 10] } else { [8, 40] };
        let solved = seconds_a_step(&setup, &data, steps);
        print!("| {n} | {} | {:.1} ", space.dofs(), 8e-6 * entries as f64);
        print!("| {:.0} | {:.2} ", 1e-9 * bandwidth, 1e3 * limit);
        let [residual, norm] = checks(&setup, &data);
        for seconds in [solve, solved, residual, norm] {
            print!("| {:.2} ms, {:.1} ", 1e3 * seconds, seconds / limit);
        }
        println!("|");
    }
}

/// Slope of log y over log x with half the width of its 95 % interval (Student's t).
fn exponent(points: &[[f64; 2]]) -> [f64; 2] {
    let logs: Vec<[f64; 2]> = points.iter().map(|p| p.map(f64::ln)).collect();
    let count = logs.len() as f64;
    let [x, y] = [0, 1].map(|i| logs.iter().map(|p| p[i]).sum::<f64>() / count);
    let spread: f64 = logs.iter().map(|p| (p[0] - x).powi(2)).sum();
    let slope = logs.iter().map(|p| (p[0] - x) * (p[1] - y)).sum::<f64>() / spread;
    let left: f64 = logs.iter().map(|p| (p[1] - y - slope * (p[0] - x)).powi(2)).sum();
    let student = StudentsT::new(0.0, 1.0, count - 2.0).map_or(f64::NAN, |t| t.inverse_cdf(0.975));
    [slope, student * (left / (count - 2.0) / spread).sqrt()]
}

fn growth(cases: &[(&str, &[u32], &[u32])]) {
    println!("| scene | n | in unknowns | N | in N |\n|---|---|---|---|---|");
    for (name, sizes, steps) in cases {
        let setup = setup(name);
        let seconds = |data: &MeshData, steps: u32| {
            least(3, || {
                let (grid, newton) = (setup.grid(steps), Newton::default());
                let mut load = TruthLoad(&*data.truth);
                march(&data.space, &setup.model, &grid, &mut load, &newton, &mut |_| Ok(()))
                    .unwrap_or_else(|error| panic!("{error}"));
            })
        };
        let on = |n: u32| MeshData::new(&setup, n, None).unwrap_or_else(|error| panic!("{error}"));
        let at = |&n: &u32| {
            let data = on(n);
            [data.space.dofs() as f64, seconds(&data, steps[0])]
        };
        let in_unknowns = exponent(&sizes.iter().map(at).collect::<Vec<_>>());
        let data = on(sizes[sizes.len() / 2]);
        let of = |&steps: &u32| [f64::from(steps), seconds(&data, steps)];
        let in_steps = exponent(&steps.iter().map(of).collect::<Vec<_>>());
        let [a, b] = [in_unknowns, in_steps].map(|[p, half]| format!("{p:.2} ± {half:.2}"));
        println!("| `{name}` | {sizes:?} | {a} | {steps:?} | {b} |");
    }
}

/// All pairs of n and N of `punch` in one process on two threads, the dearest first: wall and CPU seconds of meshes and
/// marches, without errors.
fn sweep(numbers: &[u32]) {
    let setup = setup("punch");
    let mut best = [f64::INFINITY; 2];
    for _ in 0..3 {
        let (start, cpu) = (Instant::now(), cpu_time::ProcessTime::now());
        let mut cases: Vec<(u32, u32)> =
            numbers.iter().flat_map(|&n| numbers.iter().map(move |&steps| (n, steps))).collect();
        cases.sort_by_key(|&(n, steps)| {
            std::cmp::Reverse((u64::from(n).pow(2) * u64::from(steps), n))
        });
        let meshes: Vec<OnceLock<MeshData>> = numbers.iter().map(|_| OnceLock::new()).collect();
        let next = AtomicUsize::new(0);
        let work = || {
            while let Some(&(n, steps)) = cases.get(next.fetch_add(1, Ordering::Relaxed)) {
                let at = numbers.iter().position(|&number| number == n).unwrap_or(0);
                let data = meshes[at].get_or_init(|| {
                    MeshData::new(&setup, n, None).unwrap_or_else(|error| panic!("{error}"))
                });
                let (grid, newton) = (setup.grid(steps), Newton::default());
                let mut load = TruthLoad(&*data.truth);
                march(&data.space, &setup.model, &grid, &mut load, &newton, &mut |_| Ok(()))
                    .unwrap_or_else(|error| panic!("{error}"));
            }
        };
        std::thread::scope(|scope| {
            scope.spawn(work);
            work();
        });
        best[0] = best[0].min(start.elapsed().as_secs_f64());
        best[1] = best[1].min(cpu.elapsed().as_secs_f64());
    }
    let [wall, cpu] = best;
    println!(
        "\n{} cases of `punch`, two threads: {wall:.2} s, CPU {cpu:.2} s",
        numbers.len().pow(2)
    );
}

/// CPU seconds of the sums over the past of a kernel that is no sum of exponentials, by interpolation.
fn kernel(numbers: &[u32]) {
    const UNKNOWNS: usize = 2000;
    let u = vec![0.5; UNKNOWNS];
    let at = |&steps: &u32| {
        let grid = TimeGrid::uniform(1.0, steps);
        let seconds = least(3, || drop(black_box(general_kernel::sums(&grid, &u))));
        println!("| {steps} | {seconds:.3} |");
        [f64::from(steps), seconds]
    };
    println!("sums over the past of -(1 + 4t)^-1.5, {UNKNOWNS} unknowns\n\n| N | s |\n|---|---|");
    let [slope, half] = exponent(&numbers.iter().map(at).collect::<Vec<_>>());
    println!("\nexponent in N: {slope:.2} ± {half:.2}");
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let names = arguments.iter().filter(|argument| !argument.starts_with('-'));
    if arguments.iter().any(|argument| argument == "--split") {
        return split::split(u32::MAX, &names.collect::<Vec<&String>>());
    }
    // Named benchmarks are others.
    if names.clone().count() > 0 && names.clone().all(|name| name != "limit") {
        return;
    }
    if arguments.iter().any(|argument| argument == "--test") {
        limit(&[8, 16]);
        split::split(4, &[]);
        cliffs::cliffs(4, 1);
        kernel(&[16, 32, 64]);
        sweep(&[4, 8]);
        return growth(&[("linear-punch", &[4, 8, 16], &[4, 8, 16])]);
    }
    if arguments.iter().any(|argument| argument == "--cliffs") {
        return cliffs::cliffs(u32::MAX, 3);
    }
    if arguments.iter().any(|argument| argument == "--sweep") {
        return sweep(&[8, 16, 32, 64]);
    }
    if arguments.iter().any(|argument| argument == "--kernel") {
        // Half octaves: an exponent of five points has an interval as wide as what it is compared with.
        return kernel(&[1024, 1448, 2048, 2896, 4096, 5793, 8192, 11585, 16384]);
    }
    limit(&[64, 128, 256, 512]);
    sweep(&[8, 16, 32, 64]);
    println!();
    growth(&[
        ("linear-punch", &[32, 45, 64, 91, 128, 181, 256], &[16, 32, 64, 128, 256, 512]),
        ("elastic-punch", &[16, 23, 32, 45, 64, 91, 128], &[16, 32, 64, 128, 256]),
        ("punch", &[16, 23, 32, 45, 64, 91], &[16, 32, 64, 128]),
        ("punch-box", &[4, 6, 8, 12, 16], &[4, 8, 16, 32]),
    ]);
}
