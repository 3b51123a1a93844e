//! Which meshes and numbers of steps a trade runs, where the command line names none: at least three of each, so that
//! orders and exponents have something to rest on, and no more than the budget allows.

use super::optimum::Choices;
use fem::space::Element;
use run::sweep::{Overrides, ScenePlan};
use scene::Scene;
use scene::setup::{Setup, SetupError, Subject};

/// Levels of each direction that orders need.
const LEVELS: usize = 3;
/// Levels that are kept while the budget allows them.
const MOST: [usize; 2] = [4, 5];
/// Seconds that an unknown and step may take: punch at n = 64 and N = 32 has 266,000 of them and takes 0.7 s.
const RATE: f64 = 3e-6;
/// No mesh coarser than this, no fewer steps.
const LEAST: u32 = 2;

/// The grid of a trade: what is asked for, else that of the scene.
pub(super) fn trade_grid(
    setup: &Setup,
    n: &Option<Vec<u32>>,
    steps: &Option<Vec<u32>>,
    budget: f64,
) -> Result<[Vec<u32>; 2], SetupError> {
    let grid = match (n, steps) {
        (Some(n), Some(steps)) => [n.clone(), steps.clone()],
        _ => {
            let [own, own_steps] = scene_grid(setup, budget)?;
            [n.clone().unwrap_or(own), steps.clone().unwrap_or(own_steps)]
        }
    };
    let grid = grid.map(sorted);
    setup.scene.check_cases(&grid[0], &grid[1])?;
    Ok(grid)
}

/// The lists of a scene, completed by halves (or doubles) up to three levels, and without their finest levels while all runs
/// are above what `budget` seconds bear at `RATE`.
fn scene_grid(setup: &Setup, budget: f64) -> Result<[Vec<u32>; 2], SetupError> {
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
    let mut subject = Subject::new(scene.clone())?;
    loop {
        let [n, steps] = grid.clone().map(Some);
        let plan = ScenePlan::new(subject, &Overrides { n, steps });
        let seconds: f64 = plan.costs()?.cases.iter().map(|case| RATE * case.work).sum();
        // Meshes cost more than steps: they go first.
        let long = grid.iter_mut().find(|list| list.len() > LEVELS);
        match long.filter(|_| seconds > budget) {
            Some(list) => list.pop(),
            None => return Ok(grid),
        };
        subject = plan.subject;
    }
}

/// Meshes on which `other` has about as many nodes as the element of `scene` on each of `n`: at least three, as in
/// [`scene_grid`], where the domain has them.
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
    use super::*;

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
