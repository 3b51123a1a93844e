//! What a rung takes of the memory.

use super::UnderTest;
use super::answer::set_up;
use super::rung::{Ladder, Rung};
use ::run::sweep::{MemoryLimit, Refused, Runs};
use fem::contact::Discretization;

/// Refuses a rung that would take more memory than there may be. One without a mesh, or on a small one, takes next to
/// none.
///
/// # Errors
/// [`Refused`].
pub fn admit(
    ladder: &Ladder,
    rung: &Rung,
    under_test: &UnderTest<'_>,
    limit: &MemoryLimit,
) -> Result<(), Refused> {
    let Some(largest) = &rung.largest else { return Ok(()) };
    // A scene that is refused is so when it is climbed.
    let Ok(setup) = set_up(largest.text.clone(), under_test.prepare) else { return Ok(()) };
    // An answer is all levels: u and σ, in lists that double as they grow, and the moments that they are measured against.
    let answer = |space: &Discretization, steps: u32| {
        let d = space.mesh.dimension;
        let (tensor, cells) = (d * (d + 1) / 2, space.mesh.cell_count());
        let moments = 2 * tensor + d * (d + 1);
        let numbers = 2 * (space.nodes.len() + tensor * cells) + moments * cells;
        8.0 * (f64::from(steps) + 1.0) * numbers as f64
    };
    let grid = vec![(largest.n, largest.steps)];
    let runs = Runs { setup: &setup, grid, beside: Box::new(answer) };
    runs.admit(limit).map_err(|refused| Refused {
        what: format!(
            "{} at {} (other ladders, or none of --long, take less)",
            ladder.name, rung.at
        ),
        source: refused.source,
    })
}
