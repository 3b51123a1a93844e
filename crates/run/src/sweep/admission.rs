//! Memory checks of commands other than a sweep, before any of their runs.

use super::cost::{Cost, PROGRAM, PlanCost, kept_by_meshes, run_cost};
use super::plan::{CasePlan, ScenePlan, without_panic};
use fem::contact::Discretization;
use scene::Scene;
use scene::setup::{Setup, SetupError, trace_cells};
use std::fs;
use std::path::Path;
use std::str::FromStr;

/// A command would exceed the memory limit.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{what}: {source}")]
pub struct Refused {
    pub what: String,
    pub source: TooLarge,
}

/// Bytes held beside a run with so many steps on a mesh.
pub type Beside<'a> = dyn Fn(&Discretization, u32) -> f64 + 'a;

/// Consecutive runs of a body.
pub struct Runs<'a> {
    pub setup: &'a Setup,
    /// n and N of each.
    pub grid: Vec<(u32, u32)>,
    /// What is held beside each.
    pub beside: Box<Beside<'a>>,
}

impl Runs<'_> {
    /// Refuses all runs if one exceeds the limit, if possible before its mesh is made.
    ///
    /// # Errors
    /// [`Refused`], of the largest run.
    pub fn admit(&self, limit: &MemoryLimit) -> Result<(), Refused> {
        let setup = self.setup;
        let mut grid = self.grid.clone();
        grid.sort_unstable();
        grid.dedup();
        let name = &setup.scene.name;
        early(
            |n, steps| least_bytes_of_mesh(setup, n.unwrap_or_default(), steps),
            name,
            grid.iter().map(|&(n, steps)| (Some(n), steps)).collect(),
            limit,
        )?;
        let mut all = Vec::new();
        for of_mesh in grid.chunk_by(|a, b| a.0 == b.0) {
            // The run that makes the mesh reports its errors.
            let Ok(space) = setup.space(of_mesh[0].0) else { continue };
            all.extend(of_mesh.iter().map(|&(n, steps)| {
                let run = run_cost(setup, &space, steps).memory_bytes;
                ((Some(n), steps), run + (self.beside)(&space, steps))
            }));
        }
        // The first of the largest; NaN counts as one.
        let size = |bytes: f64| if bytes.is_nan() { f64::INFINITY } else { bytes };
        let dearest = all.into_iter().min_by(|a, b| size(b.1).total_cmp(&size(a.1)));
        dearest.map_or(Ok(()), |(run, bytes)| admitted(limit, bytes, false, name, run))
    }
}

/// Refuses a plan whose cases are measured `jobs` at a time while all meshes and what they keep are held; `beside` is
/// what else is held.
/// [`Refused`].
pub fn admit_plan(
    plan: &ScenePlan,
    jobs: usize,
    limit: &MemoryLimit,
    beside: impl Fn(&[(&CasePlan, &Cost)]) -> f64,
) -> Result<(), Refused> {
    let name = &plan.scene().name;
    let reference = plan.reference.map(|reference| (Some(reference.n), reference.steps));
    let runs = plan.runs().into_iter().map(|(n, steps)| (Some(n), steps));
    early(|n, steps| plan.least_bytes(n, steps), name, runs.chain(reference).collect(), limit)?;
    // The case that makes the mesh reports its errors.
    let Ok(PlanCost { cases, .. }) = plan.costs() else { return Ok(()) };
    let cases: Vec<(&CasePlan, &Cost)> = plan.cases.iter().zip(&cases).collect();
    // The most expensive `jobs` cases, and what all meshes keep.
    let mut working: Vec<f64> =
        cases.iter().map(|(_, cost)| cost.memory_bytes - PROGRAM - cost.kept_bytes).collect();
    working.sort_by(|a, b| b.total_cmp(a));
    let kept = kept_by_meshes(cases.iter().map(|(case, cost)| (case.n, *cost)));
    let together = working.iter().take(jobs).sum::<f64>() + kept;
    let bytes = PROGRAM + together + beside(&cases);
    let dearest = cases.iter().max_by(|a, b| a.1.memory_bytes.total_cmp(&b.1.memory_bytes));
    let Some((case, _)) = dearest else { return Ok(()) };
    admitted(limit, bytes, false, name, (case.n, case.steps))
}

/// Refuses a scene whose trace constants do not fit, before it is set up: they enter (2.9) and the step bound if the
/// law falls, and a command may need them for `any` scene with contact.
/// [`Refused`].
pub fn admit_constants(scene: &Scene, any: bool, limit: &MemoryLimit) -> Result<(), Refused> {
    let Some(body) = scene.as_contact() else { return Ok(()) };
    if body.domain.contact.is_empty() || !any && body.is_monotone() {
        return Ok(());
    }
    // Of so many simplices not even the matrices fit; small meshes are made at once, as for runs.
    let cells = trace_cells(&body.domain);
    if cells <= MOMENT[1] {
        return Ok(());
    }
    let what = || format!("{}, c_j^2", scene.name);
    limit.admit(CELL * cells, true).map_err(|source| Refused { what: what(), source })
}

/// By a coarse mesh of each, the finest first.
fn early(
    least_bytes: impl Fn(Option<u32>, u32) -> f64,
    scene: &str,
    mut runs: Vec<(Option<u32>, u32)>,
    limit: &MemoryLimit,
) -> Result<(), Refused> {
    runs.sort_unstable_by(|a, b| b.cmp(a));
    let mut runs = runs.into_iter();
    runs.try_for_each(|run| admitted(limit, least_bytes(run.0, run.1), true, scene, run))
}

/// Refuses a run of a scene, by its n and N, that takes more than the limit.
fn admitted(
    limit: &MemoryLimit,
    bytes: f64,
    at_least: bool,
    scene: &str,
    (n, steps): (Option<u32>, u32),
) -> Result<(), Refused> {
    let mesh = n.map_or(String::new(), |n| format!("n = {n}, "));
    let what = || format!("{scene} {mesh}N = {steps}");
    limit.admit(bytes, at_least).map_err(|source| Refused { what: what(), source })
}

// Memory needs of the cases of a sweep, and refusal of those that exceed the limit.

/// Costs of the reference run of a plan, and of some of its cases in order or why they are refused: all of them, if the
/// reference run is too large, which each counts as its own.
pub(super) type Needs = (Option<Cost>, Vec<Result<Cost, TooLarge>>);

/// Cells per unit length, in the plane and in space, of the coarse mesh for estimates.
const COARSE: [u32; 2] = [16, 8];
/// Meshes with at most so many cells are made at once.
const MOMENT: [f64; 2] = [8_192.0, 196_608.0];
/// Bytes per cell if even the coarsest mesh has more cells than that: less than its matrices take without a factor.
const CELL: f64 = 400.0;
/// Share of the bytes of a coarse mesh, scaled by the number of cells, that is a lower bound: factors grow faster.
const SURELY: f64 = 0.5;

/// The needs of `cases` of `plan`, computed before any of them begins.
pub(super) fn needs(plan: &ScenePlan, cases: &[CasePlan], limit: &MemoryLimit) -> Needs {
    // A mesh that would not fit is not made.
    let early = |n: Option<u32>, steps: u32| limit.admit(plan.least_bytes(n, steps), true);
    let too_large = plan.reference.and_then(|run| early(Some(run.n), run.steps).err());
    if let Some(reason) = too_large {
        return (None, vec![Err(reason); cases.len()]);
    }
    let refused: Vec<Option<TooLarge>> =
        cases.iter().map(|case| early(case.n, case.steps).err()).collect();
    let open = cases.iter().zip(&refused).filter(|(_, refused)| refused.is_none());
    let open: Vec<CasePlan> = open.map(|(case, _)| case.clone()).collect();
    let predicted = without_panic(|| plan.costs_of(&open).map_err(|error| error.to_string()));
    // The case that makes the mesh reports its errors.
    let PlanCost { cases: costs, reference } = predicted.unwrap_or_else(|_| PlanCost {
        cases: vec![Cost::UNKNOWN; open.len()],
        reference: plan.reference.map(|_| Cost::UNKNOWN),
    });
    // Alone a case finds nothing on its mesh; in its turn, what longer ones have left.
    let need = |cost: &Cost| {
        let memory_bytes = cost.memory_bytes + cost.left_bytes;
        let kept_bytes = cost.kept_bytes + cost.left_bytes;
        limit.admit(cost.memory_bytes, false).map(|()| Cost { memory_bytes, kept_bytes, ..*cost })
    };
    let mut open = costs.iter().map(need);
    let cases = refused.into_iter().map(|refused| match refused {
        Some(reason) => Err(reason),
        None => open.next().unwrap_or(Ok(Cost::UNKNOWN)),
    });
    (reference, cases.collect())
}

/// Refuses a single run, without measuring errors, that would exceed the limit; if possible before the mesh is made.
/// [`TooLarge`].
pub fn admit_run(
    setup: &Setup,
    space: Option<&Discretization>,
    (n, steps): (u32, u32),
    limit: &MemoryLimit,
) -> Result<(), TooLarge> {
    match space {
        None => limit.admit(least_bytes_of_mesh(setup, n, steps), true),
        Some(space) => limit.admit(run_cost(setup, space, steps).memory_bytes, false),
    }
}

/// A lower bound for the bytes of a run on mesh n: those on a coarse mesh times the ratio of cells, reduced.
pub(super) fn least_bytes_of_mesh(setup: &Setup, n: u32, steps: u32) -> f64 {
    let (domain, place) = (&setup.body.domain, usize::from(setup.scene.dimension == 3));
    let cells = domain.cells(n);
    if cells <= MOMENT[place] {
        return 0.0;
    }
    let known = |&m: &u32| domain.cells(m) <= MOMENT[place] && setup.scene.check_cells(m).is_ok();
    let Some(coarse) = (1..=COARSE[place]).rev().find(known) else { return CELL * cells };
    let bytes = || -> Result<f64, SetupError> {
        let space = setup.space(coarse)?;
        Ok(run_cost(setup, &space, steps).march_bytes)
    };
    // If the coarse mesh cannot be made there is no bound.
    SURELY * cells / domain.cells(coarse) * bytes().unwrap_or(0.0)
}

// Memory limit: what the user allows, or what the machine has available.

/// The predicted bytes that cases may take together.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MemoryLimit {
    /// ∞ if unknown.
    bytes: f64,
    /// Given by the user.
    given: bool,
}

/// A case is predicted to exceed the limit.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error(
    "{} {} of memory predicted, above the limit of {} ({source_of_limit}): not started; take a smaller n or fewer steps, or raise --memory-limit",
    if *.at_least { "at least" } else { "about" }, in_words(*.bytes), in_words(*.limit)
)]
pub struct TooLarge {
    pub bytes: f64,
    /// `bytes` is a lower bound from a coarser mesh; the mesh itself would not fit.
    pub at_least: bool,
    pub limit: f64,
    /// The origin of the limit, in words.
    pub source_of_limit: &'static str,
}

impl MemoryLimit {
    /// No limit.
    pub const NONE: Self = Self { bytes: f64::INFINITY, given: false };

    /// A limit as a user gives it.
    pub fn of_bytes(bytes: f64) -> Self {
        Self { bytes, given: true }
    }

    /// Available memory, respecting control groups; none if unknown.
    pub fn of_machine() -> Self {
        available(Path::new("/")).map_or(Self::NONE, |bytes| Self { bytes, given: false })
    }

    /// The limit in bytes.
    pub fn bytes(&self) -> f64 {
        self.bytes
    }

    /// Refuses more than the limit; NaN exceeds any limit.
    ///
    /// # Errors
    /// [`TooLarge`].
    pub fn admit(&self, bytes: f64, at_least: bool) -> Result<(), TooLarge> {
        if bytes <= self.bytes {
            return Ok(());
        }
        let source_of_limit = match self.given {
            true => "--memory-limit",
            false => "what this machine has available",
        };
        Err(TooLarge { bytes, at_least, limit: self.bytes, source_of_limit })
    }
}

impl FromStr for MemoryLimit {
    type Err = String;

    /// Bytes, with K, M, G or T for powers of 1024: `512M`, `8G`, `1.5G`.
    fn from_str(text: &str) -> Result<Self, String> {
        const UNITS: [(char, f64); 4] =
            [('K', 1024.0), ('M', 1_048_576.0), ('G', 1_073_741_824.0), ('T', 1_099_511_627_776.0)];
        let unit =
            UNITS.iter().find(|(name, _)| text.ends_with([*name, name.to_ascii_lowercase()]));
        let number = if unit.is_some() { &text[..text.len() - 1] } else { text };
        let plain = !number.is_empty() && number.chars().all(|c| c.is_ascii_digit() || c == '.');
        match number.parse::<f64>() {
            Ok(value) if plain && value > 0.0 => {
                Ok(Self::of_bytes(value * unit.map_or(1.0, |(_, factor)| *factor)))
            }
            _ => Err(format!("`{text}` is no amount of memory; 512M and 8G are")),
        }
    }
}

/// Bytes in powers of 1024, three digits.
fn in_words(bytes: f64) -> String {
    let (mut value, mut unit) = (bytes / 1024.0, "KiB");
    for larger in ["MiB", "GiB", "TiB"] {
        if value < 1024.0 {
            break;
        }
        (value, unit) = (value / 1024.0, larger);
    }
    let digits = if value < 10.0 { 2 } else { usize::from(value < 100.0) };
    format!("{value:.digits$} {unit}")
}

/// Available bytes of the system below `root`: MemAvailable, limited by the control groups of this process.
fn available(root: &Path) -> Option<f64> {
    let memory = fs::read_to_string(root.join("proc/meminfo")).ok()?;
    let line = memory.lines().find_map(|line| line.strip_prefix("MemAvailable:"))?;
    let kibibytes: f64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some((1024.0 * kibibytes).min(left_to_groups(root)))
}

/// What the control groups leave, ∞ without any: version 2, then version 1.
fn left_to_groups(root: &Path) -> f64 {
    let groups = fs::read_to_string(root.join("proc/self/cgroup")).unwrap_or_default();
    let mut left = f64::INFINITY;
    for line in groups.lines() {
        let mut fields = line.splitn(3, ':').skip(1);
        let (Some(controllers), Some(group)) = (fields.next(), fields.next()) else { continue };
        let (folder, names) = match controllers {
            "" => ("sys/fs/cgroup", ["memory.max", "memory.current", "inactive_file "]),
            _ if controllers.split(',').any(|controller| controller == "memory") => (
                "sys/fs/cgroup/memory",
                ["memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file "],
            ),
            _ => continue,
        };
        let top = root.join(folder);
        // A group is bound by those above it as well.
        for ancestor in Path::new(group.trim_start_matches('/')).ancestors() {
            left = left.min(left_to_group(&top.join(ancestor), names));
        }
    }
    left
}

/// The limit of a group less its use; reclaimable file cache does not count.
fn left_to_group(folder: &Path, [limit, used, forgettable]: [&str; 3]) -> f64 {
    let number = |name: &str| -> Option<f64> {
        fs::read_to_string(folder.join(name)).ok()?.trim().parse().ok()
    };
    // Version 2 writes `max` for no limit, version 1 a number beyond any memory.
    let Some(limit) = number(limit) else { return f64::INFINITY };
    let statistics = fs::read_to_string(folder.join("memory.stat")).unwrap_or_default();
    let files = statistics.lines().find_map(|line| line.strip_prefix(forgettable)?.parse().ok());
    let used = number(used).unwrap_or(0.0) - files.unwrap_or(0.0);
    (limit - used.max(0.0)).max(0.0)
}

#[cfg(test)]
mod tests {
    mod admission {
        use super::super::*;
        use crate::sweep::Overrides;
        use scene::Scene;
        use scene::setup::Subject;

        fn plan(n: &[u32], steps: &[u32]) -> ScenePlan {
            let path = format!("{}/../../manufactured/signorini.toml", env!("CARGO_MANIFEST_DIR"));
            let scene = Scene::read(path.as_ref()).expect("a scene");
            let overrides = Overrides { n: Some(n.to_vec()), steps: Some(steps.to_vec()) };
            ScenePlan::new(Subject::new(scene).expect("a subject"), &overrides)
        }

        fn setup(plan: &ScenePlan) -> &Setup {
            match &plan.subject {
                Subject::Contact(setup) => setup,
                Subject::Abstract(_) => panic!("no body"),
            }
        }

        /// The smallest limit in bytes that is admitted.
        fn least(admitted: impl Fn(&MemoryLimit) -> bool) -> f64 {
            let (mut low, mut high) = (0.0, 1e12);
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                match admitted(&MemoryLimit::of_bytes(middle)) {
                    true => high = middle,
                    false => low = middle,
                }
            }
            high
        }

        #[test]
        fn runs_take_what_the_dearest_of_them_takes_and_what_is_held_beside_it() {
            let plan = plan(&[8], &[4]);
            let setup = setup(&plan);
            let runs = |grid: &[(u32, u32)], beside: f64| Runs {
                setup,
                grid: grid.to_vec(),
                beside: Box::new(move |_, _| beside),
            };
            let of = |grid: &[(u32, u32)], beside: f64| {
                least(|limit| runs(grid, beside).admit(limit).is_ok())
            };
            let (small, large) = (of(&[(8, 4)], 0.0), of(&[(16, 8)], 0.0));
            assert!(small < large);
            let near = |a: f64, b: f64| (a - b).abs() < 1.0;
            assert!(near(of(&[(16, 8), (8, 4)], 0.0), large));
            assert!(near(of(&[(8, 4)], 1e9), small + 1e9));
            let said =
                runs(&[(8, 4), (16, 8)], 0.0).admit(&MemoryLimit::of_bytes(small)).unwrap_err();
            assert!(said.to_string().starts_with("signorini n = 16, N = 8: about "), "{said}");
            // NaN exceeds any finite limit.
            let whatever = MemoryLimit::of_bytes(1e300);
            let unknown = |steps: u32| if steps == 4 { f64::NAN } else { 0.0 };
            let beside: Box<Beside<'_>> = Box::new(move |_, steps| unknown(steps));
            let mixed = Runs { setup, grid: vec![(8, 2), (8, 4), (16, 8)], beside };
            assert!(mixed.admit(&whatever).unwrap_err().source.bytes.is_nan());
            // A mesh that fits no machine is not made.
            let said =
                runs(&[(8, 4), (4096, 4)], 0.0).admit(&MemoryLimit::of_bytes(1e9)).unwrap_err();
            assert!(said.to_string().contains("n = 4096") && said.source.at_least, "{said}");
        }

        #[test]
        fn a_plan_holds_all_of_its_meshes_and_works_on_some_cases() {
            let bytes = |n: &[u32], steps: &[u32], jobs: usize| {
                let plan = plan(n, steps);
                least(|limit| admit_plan(&plan, jobs, limit, |_| 0.0).is_ok())
            };
            let costs = |n: u32, steps: u32| {
                let plan = plan(&[n], &[steps]);
                let cost = plan.costs().expect("a prediction").cases[0];
                (cost.memory_bytes, cost.kept_bytes)
            };
            let ((small, small_kept), (large, large_kept)) = (costs(8, 4), costs(16, 4));
            let near = |a: f64, b: f64| assert!((a - b).abs() < 1.0, "{a} {b}");
            near(bytes(&[16], &[4], 1), large);
            near(bytes(&[8, 16], &[4], 1), large + small_kept);
            near(bytes(&[8, 16], &[4], 2), large + small - PROGRAM);
            // Cases on one mesh share what it keeps.
            let (shared, kept) = costs(16, 2);
            near(bytes(&[16], &[2, 4], 2), large + shared - PROGRAM - kept);
            assert!(kept <= large_kept);
            let plan = plan(&[8], &[4]);
            let beside = |cases: &[(&CasePlan, &Cost)]| 1e9 * cases.len() as f64;
            let smallest = least(|limit| admit_plan(&plan, 1, limit, beside).is_ok());
            near(smallest, small + 1e9);
        }
    }

    mod memory_limit {
        use super::super::*;

        #[test]
        fn amounts_are_read_and_nothing_else_is() {
            let bytes = |text: &str| text.parse::<MemoryLimit>().map(|limit| limit.bytes());
            assert_eq!(bytes("1000"), Ok(1000.0));
            assert_eq!(bytes("512M"), Ok(536_870_912.0));
            assert_eq!(bytes("1.5g"), Ok(1_610_612_736.0));
            for text in ["", "M", "-1G", "0", "nan", "inf", "1e9", "8GB", "8 G", "1..5"] {
                assert!(bytes(text).is_err(), "{text}");
            }
        }

        #[test]
        fn a_refusal_has_its_numbers_and_the_way_out() {
            let limit: MemoryLimit = "512M".parse().unwrap();
            assert_eq!(limit.admit(536_870_912.0, false), Ok(()));
            let said = limit.admit(5e9, false).unwrap_err().to_string();
            for part in ["about 4.66 GiB", "512 MiB", "--memory-limit", "smaller n"] {
                assert!(said.contains(part), "{said}");
            }
            assert!(limit.admit(5e9, true).unwrap_err().to_string().contains("at least 4.66 GiB"));
            assert!(limit.admit(f64::NAN, false).is_err());
            assert_eq!(MemoryLimit::NONE.admit(1e300, false), Ok(()));
        }

        #[test]
        fn control_groups_and_the_machine_are_both_limits() {
            let root = std::env::temp_dir().join(format!("gronwall-memory-{}", std::process::id()));
            let write = |name: &str, text: &str| {
                let path = root.join(name);
                fs::create_dir_all(path.parent().unwrap()).unwrap();
                fs::write(path, text).unwrap();
            };
            assert_eq!(available(&root), None);
            write("proc/meminfo", "MemTotal:  9000 kB\nMemAvailable:    8000 kB\n");
            assert_eq!(available(&root), Some(8_192_000.0));
            // Version 2: the group above binds, and its file cache does not count.
            write("proc/self/cgroup", "0::/outer/inner\n");
            write("sys/fs/cgroup/outer/inner/memory.max", "max\n");
            write("sys/fs/cgroup/outer/memory.max", "5000000\n");
            write("sys/fs/cgroup/outer/memory.current", "2000000\n");
            write("sys/fs/cgroup/outer/memory.stat", "anon 1500000\ninactive_file 500000\n");
            assert_eq!(available(&root), Some(3_500_000.0));
            write("proc/self/cgroup", "4:cpu:/\n7:memory,other:/job\n");
            write("sys/fs/cgroup/memory/job/memory.limit_in_bytes", "3000000\n");
            write("sys/fs/cgroup/memory/job/memory.usage_in_bytes", "1000000\n");
            assert_eq!(available(&root), Some(2_000_000.0));
            fs::remove_dir_all(&root).unwrap();
        }
    }
}
