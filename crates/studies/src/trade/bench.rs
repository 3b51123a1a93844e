//! Runs with their errors and CPU seconds, the settings that are changed, and the grid.

use std::sync::Arc;
use std::time::Duration;

use super::optimum::Choices;
use algebra::linalg::larger;
use cpu_time::ThreadTime;
use fem::contact::{CaseError, CaseInfo, Observer, strain_distance};
use fem::norms::{ReferenceRun, step_errors, strain_error};
use fem::space::Element;
use run::sweep::{as_floors, floor_in, scene_reference};
use scene::setup::{MeshData, Setup, SetupError, reference_run};
use scene::{Body, Change, ContactQuadrature, ContactScene, Data, LoadForm, Norm, Scene};
use serde::Serialize;

/// One run; numbers that a run which failed has not are NaN.
#[derive(Debug, Clone, Default, Serialize)]
pub(super) struct Trial {
    pub n: u32,
    pub steps: u32,
    pub h: f64,
    pub k: f64,
    pub dofs: usize,
    pub error: f64,
    pub floor: f64,
    /// Of the thread: mesh, analysis, loads and march.
    #[serde(rename = "cpu_seconds")]
    pub seconds: f64,
    pub load_share: f64,
    pub history_bytes: usize,
    pub newton_iterations: u32,
    pub factorizations: u32,
    /// Why there is no error.
    pub reason: Option<String>,
    /// On the coarsest mesh: the error in k alone.
    #[serde(skip)]
    pub in_time: Option<f64>,
}

impl Trial {
    /// A run that was not made.
    pub(super) fn new([n, steps]: [u32; 2], [h, k]: [f64; 2]) -> Self {
        let [error, floor, seconds, load_share] = [f64::NAN; 4];
        Self { n, steps, h, k, error, floor, seconds, load_share, ..Self::default() }
    }

    /// n and N.
    pub(super) fn place(&self) -> [u32; 2] {
        [self.n, self.steps]
    }

    pub(super) fn converged(&self) -> bool {
        self.reason.is_none()
    }
}

/// A mesh with its loads, and the CPU seconds that it took.
pub(super) struct Meshed {
    pub data: MeshData,
    seconds: f64,
}

impl Meshed {
    pub(super) fn new(setup: &Setup, n: u32) -> Result<Self, SetupError> {
        let clock = ThreadTime::now();
        let data = MeshData::new(setup, n, None)?;
        Ok(Self { data, seconds: clock.elapsed().as_secs_f64() })
    }

    /// A march that shows its levels to `keep`, and the CPU seconds of mesh and march without those of `keep`.
    pub(super) fn march(
        &self,
        setup: &Setup,
        steps: u32,
        keep: &mut Observer<'_>,
    ) -> Result<(CaseInfo, f64), CaseError> {
        let (clock, mut keeping) = (ThreadTime::now(), Duration::ZERO);
        let info = setup.scheme.march(setup, &self.data, steps, &mut |view| {
            let clock = ThreadTime::now();
            let outcome = keep(view);
            keeping += clock.elapsed();
            outcome
        })?;
        let march = clock.elapsed().saturating_sub(keeping);
        Ok((info, self.seconds + march.as_secs_f64()))
    }
}

/// Runs one scene.
pub(super) struct Bench<'a> {
    /// The scene as written.
    pub setup: &'a Setup,
    /// The norm of the errors.
    pub norm: Norm,
    reference: Option<Arc<ReferenceRun>>,
    /// Largest ‖ε(u)‖ of the truth that was met.
    pub size: f64,
}

impl<'a> Bench<'a> {
    /// Makes the reference run of a scene without exact solution.
    pub(super) fn new(setup: &'a Setup, norm: Norm) -> Result<Self, SetupError> {
        let reference =
            scene_reference(setup).map(|wanted| reference_run(setup, wanted.n, wanted.steps, 1));
        let reference = reference.transpose()?.map(Arc::new);
        Ok(Self { setup, norm, reference, size: 0.0 })
    }

    /// Runs the scene with a change on some meshes, from few steps to many, and says what came of it.
    pub(super) fn runs(
        &mut self,
        change: &Change,
        meshes: &[u32],
        steps: &[u32],
        heard: &dyn Fn(&str),
    ) -> Vec<Trial> {
        let mut trials = Vec::new();
        for &n in meshes {
            // The truth is by the rules of the scene as written, with the element of the change.
            let judged = || -> Result<_, SetupError> {
                let setup = Setup::new(change.of(&self.setup.scene)?)?;
                let other = setup.body.element != self.setup.body.element;
                let by = if other { &setup } else { self.setup };
                let judge = MeshData::new(by, n, self.reference.clone())?;
                Ok((setup, judge))
            };
            let judged = judged().map_err(|error| error.to_string());
            let in_time = self.norm == Norm::VMax && meshes.len() > 1 && n == meshes[0];
            for &steps in steps {
                let sizes = [self.setup.body.domain.h(n), self.setup.grid(steps).largest_step()];
                let mut trial = Trial::new([n, steps], sizes);
                let run = judged.as_ref().map_err(Clone::clone).and_then(|(setup, judge)| {
                    let run = self.run(setup, judge, &mut trial, in_time);
                    run.map_err(|error| error.to_string())
                });
                trial.reason = run.err();
                let came = match &trial.reason {
                    Some(reason) => format!("failed: {reason}"),
                    None => format!("error {:.4e} in {:.4} s", trial.error, trial.seconds),
                };
                heard(&format!("{} n={n} N={steps} {came}", change.words()));
                trials.push(trial);
            }
        }
        trials
    }

    /// Makes a run from nothing, and `in_time` measures its distance to one with more steps.
    fn run(
        &mut self,
        setup: &Setup,
        judge: &MeshData,
        trial: &mut Trial,
        in_time: bool,
    ) -> Result<(), SetupError> {
        let [n, steps] = trial.place();
        let (space, still) = (&judge.space, vec![0.0; judge.space.nodes.len()]);
        let finer = || -> Result<_, SetupError> {
            Ok(MeshData::new(setup, n, None)?.trajectory(setup, FINER * steps, steps)?)
        };
        let finer = in_time.then(finer).transpose()?;
        let mut error = 0.0f64;
        let mut of_time = finer.as_ref().map(|_| 0.0f64);
        let (info, seconds) = Meshed::new(setup, n)?.march(setup, steps, &mut |view| {
            let truth = judge.truth.moments(view.t)?;
            let errors = as_floors(&step_errors(space, &setup.model, view, &truth));
            error = larger(error, floor_in(&errors, self.norm));
            self.size = self.size.max(strain_error(space, &still, &truth));
            // Grids that have no times in common show no error in k.
            of_time = of_time
                .zip(finer.as_ref().and_then(|finer| finer.at(view.t)))
                .map(|(most, finer)| larger(most, strain_distance(space, finer, view.u)));
            Ok(())
        })?;
        (trial.error, trial.in_time, trial.seconds) = (error, of_time, seconds);
        trial.floor = floor_in(&info.floors, self.norm);
        trial.load_share = (info.seconds_load / seconds).clamp(0.0, 1.0);
        trial.dofs = space.dofs();
        trial.history_bytes = info.peak_history_bytes;
        trial.newton_iterations = info.newton_iterations;
        trial.factorizations = info.work.linear.factorizations;
        Ok(())
    }
}

// What a scene file may say otherwise about how the same problem is discretised.

/// A change of the body of a scene.
fn of_body(words: &str, change: impl Fn(&mut ContactScene) + Send + Sync + 'static) -> Change {
    Change::new(words, move |mut scene| {
        if let Body::Contact(body) = &mut scene.body {
            change(body);
        }
        Ok(scene)
    })
}

/// What a scene offers beside h and k: itself, its settings, other elements.
pub(super) fn changes(setup: &Setup) -> Vec<Change> {
    let mut found = vec![Change::none()];
    if let Data::Exact { interpolated: false, form: written, .. } = setup.body.data {
        let (words, other) = match written {
            LoadForm::Weak => ("strong loads", LoadForm::Strong),
            LoadForm::Strong => ("weak loads", LoadForm::Weak),
        };
        found.push(of_body(words, move |body| {
            if let Data::Exact { form, .. } = &mut body.data {
                *form = other;
            }
        }));
    }
    // A jump has no value at a point that is held there; edges are cut in the plane alone.
    let laws = || setup.body.laws();
    let free = laws().next().is_some() && laws().all(|law| !law.is_set_valued());
    for (words, rule) in [
        ("contact by vertices", ContactQuadrature::Vertex),
        ("contact by Gauss points", ContactQuadrature::Gauss),
        ("contact exact", ContactQuadrature::Exact),
    ] {
        let cut = rule == ContactQuadrature::Exact && setup.scene.dimension > 2;
        if free && rule != setup.rule() && rule.serves(setup.body.element) && !cut {
            found.push(of_body(words, move |body| {
                body.contact.iter_mut().for_each(|contact| contact.quadrature = rule);
            }));
        }
    }
    let others = Element::ALL.into_iter().filter(|&other| other != setup.body.element);
    let admitted = others.filter(|&other| setup.scene.with_element(other).is_ok());
    found.extend(admitted.map(|element| {
        let words = format!("element {}", element.name());
        Change::new(words, move |scene| scene.with_element(element))
    }));
    found
}

// Which meshes and numbers of steps a trade runs, where the command line names none: at least three of each, so that
// orders and exponents have something to rest on, and no more than the budget bears.

/// Levels of each direction that orders need.
const LEVELS: usize = 3;
/// Levels that are kept while the budget allows them.
const MOST: [usize; 2] = [4, 5];
/// An error in k is the distance to a run with so many times the steps, which has 1/64 of it at order 2.
const FINER: u32 = 8;
/// Seconds that an unknown and level may take: punch at n = 64 and N = 32 has 270,000 of them and takes 0.7 s.
const RATE: f64 = 3e-6;
/// No mesh coarser than this, no fewer steps.
const LEAST: u32 = 2;

/// The grid of a trade: what is asked for, else the lists of the scene, completed by halves (or doubles) up to three levels,
/// and without their finest levels while all runs are above what `budget` seconds bear at `RATE`.
pub(super) fn trade_grid(
    setup: &Setup,
    asked: [&Option<Vec<u32>>; 2],
    budget: f64,
) -> Result<[Vec<u32>; 2], SetupError> {
    let scene = &setup.scene;
    let (listed_n, listed_steps) = match &scene.sweep {
        Some(sweep) => (sweep.n.clone(), sweep.steps.clone()),
        None => (vec![8, 16, 32], vec![4, 8, 16]),
    };
    let choices = Choices::new(setup, true)?;
    let finest = choices.most();
    let cells = |n: u32| n <= finest[0] && choices.has_cells(n);
    let suit = |steps: u32| steps <= finest[1] && choices.has_steps(steps);
    let mut grid = [completed(listed_n, &cells), completed(listed_steps, &suit)];
    grid.iter_mut().zip(MOST).for_each(|(list, most)| list.truncate(most));
    let unknowns = |n: &u32| {
        let degree = setup.body.element.degree() as i32;
        setup.body.domain.cells(*n) * f64::from(degree.pow(scene.dimension as u32))
    };
    loop {
        let [unknowns, levels]: [f64; 2] = [
            grid[0].iter().map(unknowns).sum(),
            grid[1].iter().map(|&steps| f64::from(steps) + 1.0).sum(),
        ];
        // Meshes cost more than steps: they go first.
        let long = grid.iter_mut().find(|list| list.len() > LEVELS);
        match long.filter(|_| RATE * unknowns * levels > budget) {
            Some(list) => list.pop(),
            None => break,
        };
    }
    let given = grid.iter_mut().zip(asked);
    given.for_each(|(own, asked)| *own = sorted(asked.as_ref().unwrap_or(own).clone()));
    scene.check_cases(&grid[0], &grid[1])?;
    Ok(grid)
}

/// Meshes on which `other` has about as many nodes as the element of `scene` on each of `n`: at least three, as in
/// [`trade_grid`], where the domain has them.
pub(super) fn element_meshes(scene: &Scene, n: &[u32], other: Element) -> Vec<u32> {
    let degree = scene.as_contact().map_or(1, |body| body.element.degree());
    let nodes = |&n: &u32| (n * degree as u32).div_ceil(other.degree() as u32).max(LEAST);
    let admitted = |n: u32| scene.check_cases(&[n], &[]).is_ok();
    completed(n.iter().map(nodes).filter(|&n| admitted(n)).collect(), &admitted)
}

fn sorted(mut list: Vec<u32>) -> Vec<u32> {
    list.sort_unstable();
    list.dedup();
    list
}

/// A list with at least three levels, rising.
fn completed(list: Vec<u32>, admitted: &dyn Fn(u32) -> bool) -> Vec<u32> {
    let mut list = sorted(list);
    while list.len() < LEVELS {
        let (Some(&first), Some(&last)) = (list.first(), list.last()) else { break };
        let half = first / 2;
        if first.is_multiple_of(2) && half >= LEAST && admitted(half) {
            list.insert(0, half);
        } else if let Some(double) = last.checked_mul(2).filter(|&double| admitted(double)) {
            list.push(double);
        } else {
            break;
        }
    }
    list
}

#[cfg(test)]
mod tests {
    mod settings {
        use super::super::*;
        use scene::Scene;

        fn offered(name: &str) -> String {
            let path = format!("{}/../../manufactured/{name}.toml", env!("CARGO_MANIFEST_DIR"));
            let setup = Setup::new(Scene::read(path.as_ref()).expect("a scene")).expect("a setup");
            let all = changes(&setup).split_off(1);
            for change in &all {
                let changed = change.of(&setup.scene).expect("a scene that may be so");
                assert!(Setup::new(changed).is_ok(), "{name}: {change:?}");
            }
            all.iter().map(Change::words).collect::<Vec<_>>().join(", ")
        }

        #[test]
        fn a_scene_offers_what_its_file_may_say() {
            for (name, words) in [
                ("pure-mild", "strong loads, contact by Gauss points, contact exact, element P2"),
                // Quadratic elements have one rule on Γ3; without a law there is none.
                ("quadratic-compliance", "strong loads, element P1"),
                ("signorini", "strong loads, element P2"),
                // Given loads are what they are, and nothing is integrated where u lives in V^h.
                ("linear-punch", "element P2"),
                ("in-space", "contact by Gauss points, contact exact, element P2"),
                // The plane alone cuts edges.
                ("pure-box", "strong loads, contact by Gauss points, element P2"),
            ] {
                assert_eq!(offered(name), words, "{name}");
            }
        }
    }

    mod grid {
        use super::super::*;

        #[test]
        fn lists_are_completed_downwards_and_then_upwards() {
            let any = |_| true;
            assert_eq!(completed(vec![16], &any), [4, 8, 16]);
            assert_eq!(completed(vec![4], &any), [2, 4, 8]);
            assert_eq!(completed(vec![6, 3, 4], &any), [3, 4, 6]);
            assert_eq!(completed(vec![3], &any), [3, 6, 12]);
            assert_eq!(completed(vec![16], &|value| value == 8), [8, 16]);
            assert!(completed(Vec::new(), &any).is_empty());
        }
    }
}
