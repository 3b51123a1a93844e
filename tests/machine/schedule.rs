//! Which case begins when, seen from inside a sweep.

use std::sync::atomic::{AtomicUsize, Ordering::SeqCst};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use fem::contact::{CaseError, CaseInfo, Observer};
use judge::record::CaseRecord;
use run::sweep::{
    Machine, MemoryLimit, OutputDirectory, Overrides, Progress, ScenePlan, run_sweep,
};
use scene::setup::{MeshData, NewtonMarch, Scheme, Setup, Subject};

use crate::program::Folder;
use crate::shipped::setup;

/// Newton's method in time, in a place that counts how many are in it; each waits a while for company.
struct Counting {
    inside: AtomicUsize,
    most: AtomicUsize,
    patience: Duration,
}

impl Counting {
    fn new(patience: Duration) -> Arc<Self> {
        let (inside, most) = (AtomicUsize::new(0), AtomicUsize::new(0));
        Arc::new(Self { inside, most, patience })
    }
}

impl Scheme for Counting {
    fn march(
        &self,
        setup: &Setup,
        data: &MeshData,
        steps: u32,
        observe: &mut Observer<'_>,
    ) -> Result<CaseInfo, CaseError> {
        self.most.fetch_max(self.inside.fetch_add(1, SeqCst) + 1, SeqCst);
        let start = Instant::now();
        while self.most.load(SeqCst) < 2 && start.elapsed() < self.patience {
            std::thread::sleep(Duration::from_millis(1));
        }
        let outcome = NewtonMarch.march(setup, data, steps, observe);
        self.inside.fetch_sub(1, SeqCst);
        outcome
    }
}

/// The order in which cases begin.
#[derive(Default)]
struct Starts(Mutex<Vec<String>>);

impl Progress for Starts {
    fn doubted(&self, _: &str) {}
    fn begin(&self, _: usize, _: usize) {}
    fn started(&self, what: &str) {
        self.0.lock().expect("the list").push(what.to_owned());
    }
    fn finished(&self, _: &str, _: Option<&CaseRecord>) {}
}

fn plan(name: &str, scheme: Arc<dyn Scheme>, n: u32, steps: &[u32]) -> ScenePlan {
    let mut setup = setup(name);
    setup.scheme = scheme;
    let grid = Overrides { n: Some(vec![n]), steps: Some(steps.to_vec()) };
    ScenePlan::new(Subject::Contact(Box::new(setup)), &grid)
}

/// Predicted bytes of the cases of a plan, and their unknowns times steps.
fn predicted(plan: &ScenePlan) -> Vec<(f64, f64)> {
    let costs = plan.costs().unwrap_or_else(|error| panic!("{error}"));
    costs.cases.iter().map(|cost| (cost.memory_bytes, cost.work)).collect()
}

#[test]
fn a_limit_for_one_case_lets_no_two_overlap() {
    let folder = Folder::new("overlap");
    let run = |out: &str, room: f64, patience: u64| {
        let counting = Counting::new(Duration::from_millis(patience));
        let plan = plan("viscoelastic", counting.clone(), 8, &[4, 8, 16]);
        let most = predicted(&plan).iter().map(|(bytes, _)| *bytes).fold(0.0, f64::max);
        let memory = MemoryLimit::of_bytes(room * most);
        let machine = Machine { memory, ..Machine::with_jobs(2) };
        let out = OutputDirectory::take(&folder.at(out)).expect("a directory");
        let records =
            run_sweep(&[plan], &out, &machine, false, &Starts::default()).expect("a sweep");
        assert!(records.iter().all(CaseRecord::converged), "{records:?}");
        let errors: Vec<_> = records.into_iter().map(|record| record.errors).collect();
        (counting.most.load(SeqCst), errors)
    };
    // With room for two they do overlap: the count would see it. The time limit is for a machine that is busy.
    let (most, free) = run("two", 2.5, 60_000);
    assert_eq!(most, 2);
    let (most, limited) = run("one", 1.5, 20);
    assert_eq!(most, 1);
    assert_eq!(free, limited);
}

#[test]
fn cases_on_the_mesh_of_the_most_unknowns_times_steps_begin_first() {
    let folder = Folder::new("order");
    let scheme = || -> Arc<dyn Scheme> { Arc::new(NewtonMarch) };
    // By n³N the finer mesh would be first.
    let plans =
        [plan("viscoelastic", scheme(), 32, &[8, 16]), plan("pure-mild", scheme(), 16, &[8, 96])];
    let mut expected: Vec<([f64; 2], String)> = Vec::new();
    for plan in &plans {
        let works: Vec<f64> = predicted(plan).into_iter().map(|(_, work)| work).collect();
        let most = works.iter().copied().fold(0.0, f64::max);
        for (case, work) in plan.cases.iter().zip(works) {
            let name = &plan.scene().name;
            let n = case.n.expect("a mesh");
            expected.push(([most, work], format!("{name} n={n} N={}", case.steps)));
        }
    }
    expected.sort_by(|a, b| b.0.partial_cmp(&a.0).expect("numbers"));
    let expected: Vec<String> = expected.into_iter().map(|(_, name)| name).collect();
    assert!(expected[0].starts_with("pure-mild"), "{expected:?}");
    let starts = Starts::default();
    let out = OutputDirectory::take(&folder.at("out")).expect("a directory");
    run_sweep(&plans, &out, &Machine::with_jobs(1), false, &starts).expect("a sweep");
    assert_eq!(*starts.0.lock().expect("the list"), expected);
    let cubes = |name: &String| name.starts_with("viscoelastic");
    assert!(!cubes(&expected[0]), "the order by n³N would pass as well");
}
