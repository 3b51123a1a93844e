//! The paths of a run: those known before its first level, and those that its levels show.

use super::path::by_grid;
use super::plan::Plan;
use super::{Discretization, LinearSolver, Model, Path, Paths, StepView};
use vhi::history::{Memory, TimeGrid};

/// What is known of a run before its first level.
pub(super) fn foreseen(
    plan: Plan,
    space: &Discretization,
    model: &Model,
    grid: &TimeGrid,
) -> Paths {
    let (mut paths, equal) = (Paths::default(), grid.is_uniform());
    let anew = Plan::changes_factor(model);
    paths.insert(match plan {
        Plan::Recursion => by_grid(equal, [Path::Recursion, Path::RecursionGraded]),
        Plan::Condensed | Plan::Linear if anew => by_grid(equal, [Path::Anew, Path::AnewGraded]),
        Plan::Condensed | Plan::Linear => by_grid(equal, [Path::Condensed, Path::CondensedGraded]),
        Plan::Newton => by_grid(equal, [Path::Newton, Path::NewtonGraded]),
    });
    paths.insert(match plan {
        // What is condensed is a factor.
        Plan::Condensed => Path::Direct,
        _ => match LinearSolver::of(space, model, grid.steps()) {
            LinearSolver::Direct => Path::Direct,
            LinearSolver::Multigrid => Path::Multigrid,
        },
    });
    if !space.frames.is_empty() {
        paths.insert([Path::FramesInPlane, Path::FramesInSpace][space.mesh.dimension - 2]);
    }
    paths
}

/// How a memory is kept.
pub(super) fn of_memory(memory: &Memory, grid: &TimeGrid) -> Path {
    let pair = match memory {
        Memory::Recursive { .. } => [Path::Recursive, Path::RecursiveGraded],
        Memory::Direct { .. } => [Path::Summed, Path::SummedGraded],
        Memory::Fast(_) => [Path::Interpolated, Path::InterpolatedGraded],
    };
    by_grid(grid.is_uniform(), pair)
}

/// What a level shows of gap and law.
pub(super) fn of_level(space: &Discretization, model: &Model, view: &StepView<'_>) -> Paths {
    let mut paths = Paths::default();
    for point in space.trace.points.iter().filter(|p| model.friction.is_some() && p.carries()) {
        // A vertex that sticks is held at 0 but for the rounding of a frame.
        let sticks = point.slip(view.u).iter().all(|u| u.abs() <= 4.0 * f64::EPSILON);
        paths.insert(if sticks { Path::Sticking } else { Path::Slipping });
    }
    let Some(boundary) = &model.boundary else { return paths };
    let law = &boundary.potential;
    let d = space.mesh.dimension;
    for (point, pressure) in space.trace.points.iter().zip(view.multiplier) {
        if !point.carries() {
            continue;
        }
        let x = space.mesh.point(&[point.vertex], &[1.0]);
        let at_node = &view.u[d * point.node as usize..][..d];
        let normal: f64 = at_node.iter().zip(&point.normal).map(|(u, normal)| u * normal).sum();
        let r = normal - (boundary.shift)(x);
        if *pressure > 0.0 {
            paths.insert(Path::Locked);
        }
        // A held jump is hit but for the rounding of a frame.
        let near = |jump: &f64| (r - jump).abs() <= 4.0 * f64::EPSILON * jump.abs();
        if law.jumps().iter().any(near) {
            paths.insert(Path::AtJump);
        }
        if law.kinks().last().is_some_and(|&last| r > last) {
            paths.insert(Path::Beyond);
        }
    }
    paths
}
