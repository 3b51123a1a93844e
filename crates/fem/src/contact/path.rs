//! The ways through the program that a run took. What no judged scene walks, no gate has seen.

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
    Recursion = "recursion, equal steps",
    RecursionGraded = "recursion, unequal steps",
    Condensed = "condensed, equal steps",
    CondensedGraded = "condensed, unequal steps",
    Newton = "newton, equal steps",
    NewtonGraded = "newton, unequal steps",
    /// [`super::Plan::Linear`], or [`super::Plan::Condensed`] with such a memory: matrices follow the last slot's weight; equal steps.
    Anew = "factors anew, equal steps",
    /// As above, with unequal steps: a matrix per level.
    AnewGraded = "factors anew, unequal steps",
    Recursive = "recursive memory, equal steps",
    RecursiveGraded = "recursive memory, unequal steps",
    Summed = "summed memory, equal steps",
    SummedGraded = "summed memory, unequal steps",
    Interpolated = "interpolated memory, equal steps",
    InterpolatedGraded = "interpolated memory, unequal steps",
    /// Factors of each Jacobian.
    Direct = "factors",
    /// Conjugate gradients with multigrid.
    Multigrid = "multigrid",
    AtVertices = "compliance at vertices",
    AtVerticesScaled = "compliance at vertices with a factor",
    AtGaussPoints = "compliance at Gauss points",
    AtGaussPointsScaled = "compliance at Gauss points with a factor",
    Exactly = "compliance integrated exactly",
    ExactlyScaled = "compliance integrated exactly with a factor",
    WeakInPlane = "weak form in the plane",
    WeakInSpace = "weak form in space",
    StrongInPlane = "strong form in the plane",
    StrongInSpace = "strong form in space",
    InterpolatedTruth = "exact solution interpolated",
    /// Given loads Σ a_i(t) F_i.
    LoadInParts = "given loads in parts",
    /// Given loads that are no such sum.
    LoadApart = "given loads that do not separate",
    /// Normals that are no axes, in the plane.
    FramesInPlane = "frames in the plane",
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
pub(super) fn by_grid(equal: bool, paths: [Path; 2]) -> Path {
    paths[usize::from(!equal)]
}
