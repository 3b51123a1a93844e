//! The ways through the program that a run took. What no judged scene walks, no gate has seen.

use super::plan::Plan;
use super::{Discretization, LinearSolver, Model, StepView};
use vhi::history::{Storage, TimeGrid};
use vhi::law::Projection;

/// Names each path once: the type, its list and its words cannot disagree.
macro_rules! paths {
    ($($(#[$doc:meta])* $name:ident = $words:literal,)+) => {
        /// One way that a part of the program may take.
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub enum Path {
            $($(#[$doc])* $name,)+
        }

        impl Path {
            /// All of them.
            pub const ALL: &[Self] = &[$(Self::$name,)+];

            /// Its name in output.
            pub fn name(self) -> &'static str {
                match self {
                    $(Self::$name => $words,)+
                }
            }
        }
    };
}

paths! {
    /// [`Plan::Recursion`] on equal steps.
    Recursion = "recursion, equal steps",
    /// As above, with unequal steps.
    RecursionGraded = "recursion, unequal steps",
    /// [`Plan::Condensed`] on equal steps.
    Condensed = "condensed, equal steps",
    /// As above, with unequal steps.
    CondensedGraded = "condensed, unequal steps",
    /// [`Plan::Newton`] on equal steps.
    Newton = "newton, equal steps",
    /// As above, with unequal steps.
    NewtonGraded = "newton, unequal steps",
    /// [`Plan::Linear`], or [`Plan::Condensed`] with such a memory: matrices follow the last slot's weight; equal steps.
    Anew = "factors anew, equal steps",
    /// As above, with unequal steps: a matrix per level.
    AnewGraded = "factors anew, unequal steps",
    /// [`Storage::Recursive`] on equal steps.
    Recursive = "recursive memory, equal steps",
    /// As above, with unequal steps.
    RecursiveGraded = "recursive memory, unequal steps",
    /// [`Storage::Direct`] on equal steps.
    Summed = "summed memory, equal steps",
    /// As above, with unequal steps.
    SummedGraded = "summed memory, unequal steps",
    /// [`Storage::Fast`] on equal steps.
    Interpolated = "interpolated memory, equal steps",
    /// As above, with unequal steps.
    InterpolatedGraded = "interpolated memory, unequal steps",
    /// The trapezoidal rule on equal steps.
    Trapezoid = "trapezoidal rule, equal steps",
    /// As above, with unequal steps.
    TrapezoidGraded = "trapezoidal rule, unequal steps",
    /// The left-endpoint rule on equal steps.
    Left = "left-endpoint rule, equal steps",
    /// As above, with unequal steps.
    LeftGraded = "left-endpoint rule, unequal steps",
    /// Gregory's rule with first differences.
    GregoryThree = "Gregory's rule of order 3",
    /// Gregory's rule with second differences.
    GregoryFour = "Gregory's rule of order 4",
    /// The corrected end weight on equal steps.
    CorrectedEnd = "corrected end, equal steps",
    /// As above, with unequal steps.
    CorrectedEndGraded = "corrected end, unequal steps",
    /// Product integration on equal steps.
    Product = "product integration, equal steps",
    /// As above, with unequal steps.
    ProductGraded = "product integration, unequal steps",
    /// Factors of each Jacobian.
    Direct = "factors",
    /// Conjugate gradients with multigrid.
    Multigrid = "multigrid",
    /// Compliance at the vertices.
    AtVertices = "compliance at vertices",
    /// Compliance at vertices, with a factor that depends on place.
    AtVerticesScaled = "compliance at vertices with a factor",
    /// Compliance at Gauss points.
    AtGaussPoints = "compliance at Gauss points",
    /// Compliance at Gauss points, with a factor that depends on place.
    AtGaussPointsScaled = "compliance at Gauss points with a factor",
    /// Compliance integrated exactly.
    Exactly = "compliance integrated exactly",
    /// Compliance integrated exactly, with a factor that depends on place.
    ExactlyScaled = "compliance integrated exactly with a factor",
    /// Loads of an exact solution in the weak form, in the plane.
    WeakInPlane = "weak form in the plane",
    /// As above, in space.
    WeakInSpace = "weak form in space",
    /// Loads of an exact solution in the strong form, in the plane.
    StrongInPlane = "strong form in the plane",
    /// As above, in space.
    StrongInSpace = "strong form in space",
    /// The exact solution is its interpolant.
    InterpolatedTruth = "exact solution interpolated",
    /// Given loads Σ a_i(t) F_i.
    LoadInParts = "given loads in parts",
    /// Given loads that are no such sum.
    LoadApart = "given loads that do not separate",
    /// Normals that are no axes, in the plane.
    FramesInPlane = "frames in the plane",
    /// As above, in space.
    FramesInSpace = "frames in space",
    /// Halved Newton steps.
    Damped = "damped newton",
    /// u_ν = g at the last level.
    Locked = "gap reached",
    /// A jump of the law held at the last level.
    AtJump = "law at its jump",
    /// u_ν - s beyond the last point of the law at the last level.
    Beyond = "law beyond its last point",
    /// A vertex with friction that sticks at the last level.
    Sticking = "friction sticks",
    /// One that slips.
    Slipping = "friction slips",
}

/// A set of paths.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Paths(u64);

const _: () = assert!(Path::ALL.len() <= u64::BITS as usize);

impl Paths {
    /// Adds a path.
    pub fn insert(&mut self, path: Path) {
        self.0 |= 1 << path as u32;
    }

    /// Whether it is there.
    pub fn contains(self, path: Path) -> bool {
        self.0 & (1 << path as u32) != 0
    }

    /// The paths that are in either set.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// All that are there.
    pub fn iter(self) -> impl Iterator<Item = Path> {
        Path::ALL.iter().copied().filter(move |&path| self.contains(path))
    }
}

/// The first on equal steps, the second on others.
pub fn by_grid(equal: bool, paths: [Path; 2]) -> Path {
    paths[usize::from(!equal)]
}

/// What is known of a run before its first level.
pub(super) fn foreseen<P: Projection>(
    plan: Plan,
    space: &Discretization,
    model: &Model<P>,
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
pub(super) fn of_storage(storage: Storage, grid: &TimeGrid) -> Path {
    let pair = match storage {
        Storage::Recursive => [Path::Recursive, Path::RecursiveGraded],
        Storage::Direct => [Path::Summed, Path::SummedGraded],
        Storage::Fast => [Path::Interpolated, Path::InterpolatedGraded],
    };
    by_grid(grid.is_uniform(), pair)
}

/// What a level shows of gap and law.
pub(super) fn of_level<P: Projection>(
    space: &Discretization,
    model: &Model<P>,
    view: &StepView<'_>,
) -> Paths {
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
        let own = &view.u[d * point.node as usize..][..d];
        let normal: f64 = own.iter().zip(&point.normal).map(|(u, normal)| u * normal).sum();
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
