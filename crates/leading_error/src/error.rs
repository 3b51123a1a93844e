use algebra::linalg::FactorError;
use fem::contact::LoadError;

/// Why a scene, norm or direction has no predicted constant.
#[derive(Debug, thiserror::Error)]
pub enum NoConstant {
    #[error("the scene says constant = false")]
    OptedOut,
    #[error("no exact solution: a reference run knows no constant beforehand")]
    NoExact,
    /// There is no prediction for this norm.
    #[error("{norm} has no predicted constant: it is no norm of a leading error")]
    Norm { norm: &'static str },
    #[error("{norm} has no predicted constant in h: V_max and stress_L2_max have one")]
    InSpace { norm: &'static str },
    #[error("both steps are refined: constants are predicted along h alone and along k alone")]
    Joint,
    /// Only P1 interpolants and tangents are implemented.
    #[error("{element} has a predicted constant in h for V_max alone")]
    Element { element: &'static str },
    #[error(
        "{element} has no predicted constant in h: interpolants of a degree above 2 are not superclose"
    )]
    Degree { element: &'static str },
    /// I_h u is not superclose on this mesh.
    #[error("the mesh is no grid of translated simplices, so the interpolant is not superclose")]
    Mesh,
    /// u is not in H², or U^h is not in U.
    #[error("a hypothesis of (5.26) is violated: the interpolation error is not the whole error")]
    Regularity,
    #[error("u(t) is not in V^h: the error holds space error as well")]
    NotInSpace,
    /// The rule's weights depend on the kernel.
    #[error("the time rule weighs the kernel in a way of its own")]
    Rule,
    #[error("a history of a history in a body has no predicted constant: abstract scenes have one")]
    Nested,
    #[error("the linearised problem is singular at t = {t}")]
    Singular { t: f64 },
    #[error(transparent)]
    Load(#[from] LoadError),
    #[error(transparent)]
    Factor(#[from] FactorError),
    #[error("{0}")]
    Setup(String),
}
