//! Which meshes and numbers of steps a trade runs, where the command line names none: at least three of each, so that
//! orders and exponents have something to rest on, and no more than the budget bears.

use super::optimum::Choices;
use fem::space::Element;
use run::sweep::{CasePlan, Cost, MemoryLimit, Overrides, Refused, ScenePlan, admit_plan};
use scene::Scene;
use scene::setup::{Setup, SetupError, Subject};

/// Levels of each direction that orders need.
const LEVELS: usize = 3;
/// Levels that are kept while the budget bears them.
const MOST: [usize; 2] = [4, 5];
/// Seconds that an unknown and step may take: punch at n = 64 and N = 32 has 266,000 of them and takes 0.7 s.
const RATE: f64 = 3e-6;
/// No mesh coarser than this, no fewer steps.
const LEAST: [u32; 2] = [2, 2];

/// The grid of a scene: its lists, completed by halves (or doubles) up to three levels, and without its finest
/// levels while all runs are above what `budget` seconds bear at `RATE`.
///
/// # Errors
/// The scene cannot be set up.
pub fn scene_grid(setup: &Setup, budget: f64) -> Result<[Vec<u32>; 2], SetupError> {
    let scene = &setup.scene;
    let (listed_n, listed_steps) = match &scene.sweep {
        Some(sweep) => (sweep.n.clone(), sweep.steps.clone()),
        None => (vec![8, 16, 32], vec![4, 8, 16]),
    };
    let choices = Choices::new(setup, true)?;
    let finest = choices.most();
    let cells = |n: u32| n <= finest[0] && choices.has_cells(n);
    let steps = |steps: u32| steps <= finest[1] && choices.has_steps(steps);
    let mut ns = completed(listed_n, LEAST[0], &cells);
    let mut numbers = completed(listed_steps, LEAST[1], &steps);
    ns.truncate(MOST[0]);
    numbers.truncate(MOST[1]);
    loop {
        let overrides = Overrides { n: Some(ns.clone()), steps: Some(numbers.clone()) };
        let plan = ScenePlan::new(Subject::new(scene.clone())?, &overrides);
        let seconds: f64 = plan.costs()?.cases.iter().map(|case| RATE * case.work).sum();
        if seconds <= budget {
            break;
        }
        // Meshes cost more than steps: they go first.
        match [ns.len() > LEVELS, numbers.len() > LEVELS] {
            [true, _] => ns.truncate(ns.len() - 1),
            [false, true] => numbers.truncate(numbers.len() - 1),
            [false, false] => break,
        }
    }
    Ok([ns, numbers])
}

/// Meshes on which `other` has about as many nodes as the element of `scene` on each of `n`: at least three, as in
/// [`scene_grid`], where the domain has them.
pub fn element_meshes(scene: &Scene, n: &[u32], other: Element) -> Vec<u32> {
    let degree = scene.as_contact().map_or(1, |body| body.element.degree());
    let nodes = |&n: &u32| (n * degree as u32).div_ceil(other.degree() as u32).max(LEAST[0]);
    let admitted = |n: u32| scene.check_cases(&[n], &[]).is_ok();
    completed(n.iter().map(nodes).filter(|&n| admitted(n)).collect(), LEAST[0], &admitted)
}

/// Refuses a trade of the cases of `plan` that would take more memory than there may be: beside a run a bench holds the
/// truth on its mesh and the displacements of all runs there.
///
/// # Errors
/// [`Refused`].
pub fn admit_trade(plan: &ScenePlan, limit: &MemoryLimit) -> Result<(), Refused> {
    let displacements =
        |(case, cost): &(&CasePlan, &Cost)| 8.0 * cost.dofs as f64 * (f64::from(case.steps) + 1.0);
    admit_plan(plan, 1, limit, |cases| cases.iter().map(displacements).sum())
}

/// A list with at least three levels, rising.
fn completed(mut list: Vec<u32>, least: u32, admitted: &dyn Fn(u32) -> bool) -> Vec<u32> {
    list.sort_unstable();
    list.dedup();
    while list.len() < LEVELS {
        let (Some(&first), Some(&last)) = (list.first(), list.last()) else { break };
        let half = first / 2;
        if first.is_multiple_of(2) && half >= least && admitted(half) {
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
    use super::*;

    #[test]
    fn lists_are_completed_downwards_and_then_upwards() {
        let any = |_| true;
        assert_eq!(completed(vec![16], 2, &any), [4, 8, 16]);
        assert_eq!(completed(vec![4], 2, &any), [2, 4, 8]);
        assert_eq!(completed(vec![6, 3, 4], 2, &any), [3, 4, 6]);
        assert_eq!(completed(vec![3], 2, &any), [3, 6, 12]);
        assert_eq!(completed(vec![16], 2, &|value| value == 8), [8, 16]);
        assert!(completed(Vec::new(), 2, &any).is_empty());
    }
}
