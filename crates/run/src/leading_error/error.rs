//! Why a constant is not predicted.

use algebra::linalg::FactorError;
use fem::contact::LoadError;

/// Why a scene, norm or direction has no predicted constant.
#[derive(Debug, thiserror::Error)]
pub enum NoConstant {
    /// The scene does not want it.
    #[error("the scene says constant = false")]
    OptedOut,
    /// Given loads: the truth is a run.
    #[error("no exact solution: a reference run knows no constant beforehand")]
    NoExact,
    /// Nothing is predicted of this norm.
    #[error("{norm} has no predicted constant: it is no norm of a leading error")]
    Norm { norm: &'static str },
    /// In space u_h and I_h u are told apart at the order of the error itself.
    #[error("{norm} has no predicted constant in h: V_max and stress_L2_max have one")]
    InSpace { norm: &'static str },
    /// Both directions at once.
    #[error("both steps are refined: constants are predicted along h alone and along k alone")]
    Joint,
    /// Stresses of interpolants and tangents here are those of P1.
    #[error("{element} has a predicted constant in h for V_max alone")]
    Element { element: &'static str },
    /// Of a space that is not in V the interpolant is not superclose.
    #[error(
        "{element} functions jump: consistency error and jumps are of the order of the interpolation error, and no constant of their sum is derived"
    )]
    Nonconforming { element: &'static str },
    /// I_h u is not closer to u_h than to u.
    #[error("the mesh is no grid of translated simplices, so the interpolant is not superclose")]
    Mesh,
    /// u is not in H², or U^h is not in U.
    #[error("a hypothesis of (5.26) is violated: the interpolation error is not the whole error")]
    Regularity,
    /// V_max in k on a scene with space error.
    #[error("u(t) is not in V^h: the error holds space error as well")]
    NotInSpace,
    /// A rule whose weights depend on the kernel.
    #[error("the time rule weighs the kernel in a way of its own")]
    Rule,
    /// The linearised step has no solution.
    #[error("the linearised problem is singular at t = {t}")]
    Singular { t: f64 },
    /// A formula.
    #[error(transparent)]
    Load(#[from] LoadError),
    /// The tangent.
    #[error(transparent)]
    Factor(#[from] FactorError),
    /// The space.
    #[error("{0}")]
    Setup(String),
}
