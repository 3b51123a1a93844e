//! The equations of a scene, as plain text and for Typst.

use serde::{Deserialize, Serialize};

/// A formula with its number in the paper.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Equation {
    pub plain: String,
    /// In Typst's notation.
    pub typst: String,
    /// Number in the paper, or empty.
    pub number: String,
}

/// The terms that a scene has.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Terms {
    /// Problem 1 in ℝ^m, without a body.
    pub is_abstract: bool,
    /// The projection onto the yield ball.
    pub projection: bool,
    pub memory: bool,
    pub contact: bool,
    pub gap: bool,
    pub law: bool,
    pub friction: bool,
    pub quadratic: bool,
}

impl Equation {
    pub(super) fn new(plain: impl Into<String>, typst: impl Into<String>, number: &str) -> Self {
        Self { plain: plain.into(), typst: typst.into(), number: number.into() }
    }
}

/// The problem and its scheme.
pub fn equations(terms: Terms) -> Vec<Equation> {
    let mut list = match terms.is_abstract {
        true => vec![Equation::new(
            "⟨Au(t), v−u(t)⟩ + φ((𝒮u)(t), u(t), v) − φ((𝒮u)(t), u(t), u(t)) + j⁰(γ_j u(t); γ_j v−γ_j u(t)) ≥ ⟨f(t), v−u(t)⟩ for all v ∈ K",
            "chevron.l A u(t), v - u(t) chevron.r + phi((cal(S) u)(t), u(t), v) - phi((cal(S) u)(t), u(t), u(t)) \\ + j^0(gamma_j u(t); gamma_j v - gamma_j u(t)) >= chevron.l f(t), v - u(t) chevron.r quad forall v in K",
            "(2.2)",
        )],
        false => body(terms),
    };
    if terms.memory {
        list.push(Equation::new(
            "∫₀^{t_n} q(s) ds ≈ k Σ′_{j=0..n} q(t_j), first and last term halved",
            "integral_0^(t_n) q(s) dif s approx k limits(sum')_(j=0)^n q(t_j), quad \"first and last term halved\"",
            "(3.1)",
        ));
    }
    list
}

fn body(terms: Terms) -> Vec<Equation> {
    let mut plain = "σ = 𝒜ε(u)".to_owned();
    let mut typst = "bold(sigma) = cal(A) bold(epsilon)(bold(u))".to_owned();
    if terms.projection {
        plain += " + μ(ε(u) − P_{M(κ(ζ))} ε(u))";
        typst += " + mu (bold(epsilon)(bold(u)) - P_(M(kappa(zeta))) bold(epsilon)(bold(u)))";
    }
    if terms.memory {
        plain += " + ∫₀ᵗ ℬ(t−s) ε(u(s)) ds";
        typst += " + integral_0^t cal(B)(t - s) bold(epsilon)(bold(u)(s)) dif s";
    }
    let mut list = vec![Equation::new(plain, typst, "(5.1)")];
    if terms.projection {
        list.push(Equation::new(
            "ζ(t) = ∫₀ᵗ ‖ε(u(s))‖ ds",
            "zeta(t) = integral_0^t norm(bold(epsilon)(bold(u)(s))) dif s",
            "(5.1)",
        ));
    }
    list.push(Equation::new(
        "Div σ + f₀ = 0 in Ω, u = 0 on Γ₁, σν = f₂ on Γ₂",
        "\"Div\" bold(sigma) + bold(f)_0 = bold(0) \"in\" Omega, quad bold(u) = bold(0) \"on\" Gamma_1, quad bold(sigma nu) = bold(f)_2 \"on\" Gamma_2",
        "(5.2)–(5.4)",
    ));
    if terms.contact {
        list.push(contact(terms));
    }
    list
}

/// (5.5) with the scene's terms.
fn contact(terms: Terms) -> Equation {
    let (plain, typst) = match (terms.gap, terms.law) {
        (true, true) => (
            "σ_τ = 0, u_ν ≤ g, σ_ν + ξ ≤ 0, (σ_ν + ξ)(u_ν − g) = 0, ξ ∈ ∂j_ν(u_ν) on Γ₃",
            "bold(sigma)_tau = bold(0), quad u_nu <= g, quad sigma_nu + xi <= 0, quad (sigma_nu + xi)(u_nu - g) = 0, quad xi in partial j_nu (u_nu) quad \"on\" Gamma_3",
        ),
        (true, false) => (
            "σ_τ = 0, u_ν ≤ g, σ_ν ≤ 0, σ_ν (u_ν − g) = 0 on Γ₃",
            "bold(sigma)_tau = bold(0), quad u_nu <= g, quad sigma_nu <= 0, quad sigma_nu (u_nu - g) = 0 quad \"on\" Gamma_3",
        ),
        (false, true) => (
            "σ_τ = 0, −σ_ν = ξ ∈ ∂j_ν(u_ν) on Γ₃",
            "bold(sigma)_tau = bold(0), quad -sigma_nu = xi in partial j_nu (u_nu) quad \"on\" Gamma_3",
        ),
        (false, false) => ("σν = 0 on Γ₃", "bold(sigma nu) = bold(0) quad \"on\" Gamma_3"),
    };
    if !terms.friction {
        return Equation::new(plain, typst, "(5.5), (5.6)");
    }
    let (free, law) = ("bold(sigma)_tau = bold(0)", "-sigma_tau in S partial abs(u_tau)");
    let (plain, typst) = match (terms.gap, terms.law) {
        (false, false) => (
            "σ_ν = 0, −σ_τ ∈ S ∂|u_τ| on Γ₃".to_owned(),
            format!("sigma_nu = 0, quad {law} quad \"on\" Gamma_3"),
        ),
        _ => (plain.replace("σ_τ = 0", "−σ_τ ∈ S ∂|u_τ|"), typst.replace(free, law)),
    };
    Equation::new(plain, typst, "(5.5)")
}

// Groups of the scenes in a report.

/// In the order of a report.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
pub enum Group {
    /// The problem of the paper with every term.
    Whole,
    /// Contact with some of the terms.
    Contact,
    /// Beyond the paper: friction, elements of higher degree.
    Beyond,
    /// No contact.
    #[default]
    Materials,
    /// No body.
    Abstract,
    /// A hypothesis is broken on purpose, or at its limit.
    Broken,
    /// Solved by another program.
    External,
}

impl Group {
    pub(crate) const ALL: [Self; 7] = [
        Self::Whole,
        Self::Contact,
        Self::Beyond,
        Self::Materials,
        Self::Abstract,
        Self::Broken,
        Self::External,
    ];

    /// The group of a scene with these terms.
    pub fn of(terms: Terms, breaks: bool) -> Self {
        let Terms { is_abstract, projection, memory, contact, gap, law, friction, quadratic } =
            terms;
        if breaks {
            Self::Broken
        } else if is_abstract {
            Self::Abstract
        } else if friction || quadratic {
            Self::Beyond
        } else if projection && memory && gap && law {
            Self::Whole
        } else if contact {
            Self::Contact
        } else {
            Self::Materials
        }
    }

    pub(crate) fn title(self) -> &'static str {
        match self {
            Self::Whole => "Every term of the paper",
            Self::Contact => "Laws, states, gaps",
            Self::Beyond => "Elements and friction",
            Self::Materials => "Materials and memory",
            Self::Abstract => "Abstract inequality",
            Self::Broken => "Broken, or at the limit",
            Self::External => "Another solver",
        }
    }
}

#[cfg(test)]
mod tests {
    mod equation {
        use super::super::*;

        #[test]
        fn a_term_that_is_absent_is_not_written() {
            let all = Terms {
                projection: true,
                memory: true,
                contact: true,
                gap: true,
                law: true,
                ..Terms::default()
            };
            let text = |terms| {
                equations(terms)
                    .iter()
                    .map(|e| format!("{} {}\n", e.plain, e.typst))
                    .collect::<String>()
            };
            for sign in ["μ(", "ζ(t)", "ℬ", "∂j_ν", "u_ν ≤ g", "Σ′"] {
                assert!(text(all).contains(sign), "{sign}");
                assert!(!text(Terms::default()).contains(sign), "{sign}");
            }
            assert!(!text(Terms { gap: false, ..all }).contains("≤ g"));
            assert!(!text(Terms { law: false, ..all }).contains('ξ'));
            assert!(text(Terms { is_abstract: true, ..all }).contains("j⁰"));
            for (gap, law) in [(true, true), (true, false), (false, true), (false, false)] {
                let text = text(Terms { gap, law, friction: true, ..all });
                assert!(text.contains("−σ_τ ∈ S") && text.contains("in S partial"), "{text}");
                assert!(!text.contains("σ_τ = 0") && !text.contains("tau = bold(0)"), "{text}");
            }
        }
    }
    mod group {
        use super::super::*;

        #[test]
        fn a_missing_term_leaves_the_whole_problem() {
            let contact = Terms { contact: true, gap: true, law: true, ..Terms::default() };
            let whole = Terms { projection: true, memory: true, ..contact };
            assert_eq!(Group::of(whole, false), Group::Whole);
            assert_eq!(Group::of(whole, true), Group::Broken);
            assert_eq!(Group::of(contact, false), Group::Contact);
            // Friction is beyond the paper, whatever else a scene has.
            assert_eq!(Group::of(Terms { friction: true, ..whole }, false), Group::Beyond);
            assert_eq!(Group::of(Terms { quadratic: true, ..whole }, false), Group::Beyond);
            assert_eq!(
                Group::of(Terms { contact: false, gap: false, ..whole }, false),
                Group::Materials
            );
            assert_eq!(Group::of(Terms { is_abstract: true, ..whole }, false), Group::Abstract);
            assert!(Group::ALL.is_sorted());
        }
    }
}
