//! Ladders of the error in space against Céa's bound: λ/μ_L, mesh size, aspect ratio.
//!
//! For a linear body the discrete solution is the nearest element of V^h in the energy norm, so for the nodal
//! interpolant I_h u
//!
//! ```text
//! 2μ_L ‖ε(u - u_h)‖² ≤ 2μ_L ‖ε(u - I_h u)‖² + λ ‖div(u - I_h u)‖² ≤ (2μ_L + dλ) ‖ε(u - I_h u)‖²,
//! ```
//!
//! with |tr τ|² ≤ d |τ|².  With v = 0 in place of I_h u, and div u = 0: ‖ε(u - u_h)‖ ≤ ‖ε(u)‖.  No constant is
//! hidden, whatever the shape of the cells: the V norm is that of strains.

use super::UnderTest;
use super::answer::{SceneAnswer, Unanswered, march, set_up};
use super::rung::{Ladder, Measured, Relation, Rung, power_of_ten};
use super::scene_text::SceneText;
use fem::norms::strain_error;
use formula::EvaluationPoint;
use scene::setup::{MeshData, Setup};

/// Loads come from a rule, not from exact integrals: what that may add to the ratio.
const QUADRATURE: f64 = 0.01;

/// A run of a scene that does not depend on time, with what the bound needs.
pub(super) struct InSpace {
    answer: SceneAnswer,
    /// ‖ε(u - u_h)‖.
    error: f64,
    /// ‖ε(u - I_h u)‖.
    interpolation: f64,
    /// ‖ε(u)‖.
    size: f64,
}

impl InSpace {
    fn run(text: String, n: u32, under_test: &UnderTest<'_>) -> Result<Self, Unanswered> {
        let setup = set_up(text, under_test.prepare)?;
        let data = MeshData::new(&setup, n, None).map_err(Unanswered::refused)?;
        let answer = march(&setup, &data, 1)?;
        let error = answer.errors.map_or(f64::NAN, |errors| errors[0]);
        let truth = data.truth.moments(0.0).map_err(Unanswered::refused)?;
        let nothing = vec![0.0; data.space.nodes.len()];
        Ok(Self {
            answer,
            error,
            interpolation: strain_error(&data.space, &interpolant(&setup, &data), &truth),
            size: strain_error(&data.space, &nothing, &truth),
        })
    }

    /// The error over Céa's bound with the interpolant.
    fn ratio(&self, [lambda, mu]: [f64; 2]) -> f64 {
        self.error / ((1.0 + lambda / mu).sqrt() * self.interpolation)
    }

    /// The error over the smaller of this and ‖ε(u)‖, for u without divergence.
    fn locked_ratio(&self, lame: [f64; 2]) -> f64 {
        self.ratio(lame).max(self.error / self.size)
    }
}

/// u at the nodes.
fn interpolant(setup: &Setup, data: &MeshData) -> Vec<f64> {
    let Some(exact) = &setup.exact else { return Vec::new() };
    let (space, mut values) = (&data.space, vec![0.0; data.space.nodes.len()]);
    for (node, &vertex) in space.nodes.vertex.iter().enumerate() {
        let [x, y, z] = space.mesh.point(&[vertex], &[1.0]);
        let at = EvaluationPoint { x, y, z, ..EvaluationPoint::default() };
        for (i, &component) in exact.data.u.iter().enumerate() {
            values[2 * node + i] = exact.data.graph.evaluate(component, &at);
        }
    }
    values
}

/// A displacement without divergence, the curl of (1-y)² sin πx.
const SOLENOIDAL: &str = "[exact]\nu = [\"-2*(1 - y)*sin(pi*x)\", \"-pi*(1 - y)^2*cos(pi*x)\"]\n";

/// λ/μ_L from 1 to 1e8 on n = 16, 32: the bound at n = 32, and the order that is left there. P1 locks: V^h
/// has few fields without divergence, so the error stays near ‖ε(u)‖ until h is below √(μ_L/λ) or so. λ tr ε is a
/// sum of terms λ‖ε‖ that cancel, so it rounds to ελ‖ε‖ and more beside loads of order one: the KKT residual counts that.
pub(crate) fn locking() -> Ladder {
    let rung = |e: i32| {
        let lame = [power_of_ten(e), 1.0];
        let run = move |under_test: &UnderTest<'_>| {
            let (fine, order) = locked(lame, 32, under_test)?;
            let note = format!(
                "order {order:.2} at n = 16…32, error {:.1} h‖ε(u)‖",
                32.0 * fine.error / fine.size
            );
            Ok(Measured::of(fine.locked_ratio(lame), &fine.answer).noted(note))
        };
        Rung::new(format!("1e{e}"), Relation::AtMost(1.0 + QUADRATURE), run)
    };
    Ladder {
        name: "locking",
        parameter: "λ/μ_L",
        quantity: "error over Céa's bound",
        why: "Céa with the interpolant, factor √(1 + λ/μ_L), or with 0: ‖ε(u)‖ where div u = 0",
        rungs: [0, 1, 2, 4, 6, 8].map(rung).into(),
    }
}

fn solenoidal(lame: [f64; 2]) -> String {
    SceneText { lame, ..SceneText::free(SOLENOIDAL) }.text()
}

/// The run on n, and the order from n/2 to n.
fn locked(
    lame: [f64; 2],
    n: u32,
    under_test: &UnderTest<'_>,
) -> Result<(InSpace, f64), Unanswered> {
    let [coarse, fine] = [n / 2, n].map(|n| InSpace::run(solenoidal(lame), n, under_test));
    let (coarse, fine) = (coarse?, fine?);
    let order = (coarse.error / fine.error).log2();
    Ok((fine, order))
}

/// Where the order returns at λ/μ_L = 1e2: slopes from n = 4 on.
pub(crate) fn locking_order(finest: u32) -> Ladder {
    let lame = [1e2, 1.0];
    let rung = move |n: u32| {
        let run = move |under_test: &UnderTest<'_>| {
            let (fine, order) = locked(lame, n, under_test)?;
            Ok(Measured::of(fine.locked_ratio(lame), &fine.answer)
                .noted(format!("order {order:.2}")))
        };
        Rung::new(n.to_string(), Relation::AtMost(1.0 + QUADRATURE), run).with_largest(
            solenoidal(lame),
            n,
            1,
        )
    };
    let ns = [4, 8, 16, 32, 64, 128, 256].into_iter().filter(|&n| n <= finest);
    Ladder {
        name: "locking-order",
        parameter: "n at λ/μ_L = 1e2",
        quantity: "error over Céa's bound",
        why: "as locking; the note shows where order 1 returns",
        rungs: ns.map(rung).collect(),
    }
}

/// A displacement without symmetries.
pub(super) const SMOOTH: &str =
    "[exact]\nu = [\"0.2*sin(pi*x)*(1 - y^2)\", \"-0.1*(1 + cos(pi*x))*(1 - y)*(1 + y/2)\"]\n";

/// A linear body with λ = μ_L below Céa's bound √2 ‖ε(u - I_h u)‖, with a remark on the run.
pub(super) fn below_bound(
    at: impl Into<String>,
    scene: &SceneText,
    n: u32,
    note: impl Fn(&InSpace) -> String + Send + Sync + 'static,
) -> Rung {
    let text = scene.text();
    Rung::new(at, Relation::AtMost(1.0 + QUADRATURE), move |under_test| {
        let found = InSpace::run(text.clone(), n, under_test)?;
        Ok(Measured::of(found.ratio([1.0, 1.0]), &found.answer).noted(note(&found)))
    })
}

/// h from one cell to 1/finest: between the best approximation and Céa's bound √2 ‖ε(u - I_h u)‖.
pub(crate) fn mesh_size(finest: u32) -> Ladder {
    let scene = SceneText::free(SMOOTH);
    let error = |found: &InSpace| format!("error {:.2e}", found.error);
    let rung =
        |n: u32| below_bound(n.to_string(), &scene, n, error).with_largest(scene.text(), n, 1);
    let ns = [1, 2, 4, 8, 16, 32, 64, 128, 256, 512].into_iter().filter(|&n| n <= finest);
    Ladder {
        name: "mesh",
        parameter: "n = 1/h",
        quantity: "error over Céa's bound",
        why: "Céa with the interpolant, factor √(1 + λ/μ_L) = √2",
        rungs: ns.map(rung).collect(),
    }
}

/// A strip 1 × δ of cells with aspect ratio 1/δ, n = 8: the bound has no constant of shape.
pub(crate) fn aspect_ratio() -> Ladder {
    let rung = |e: i32| {
        let height = power_of_ten(-e);
        let domain = SceneText::parallelogram([0.0, height]);
        let exact = SMOOTH.replace('y', &format!("(y/{height:?})"));
        let scene = SceneText { domain, ..SceneText::free(exact) };
        below_bound(format!("1e{e}"), &scene, 8, |_| String::new())
    };
    Ladder {
        name: "aspect",
        parameter: "aspect ratio of the cells",
        quantity: "error over Céa's bound",
        why: "as mesh: no constant of shape in the norm of strains",
        rungs: [0, 1, 2, 3, 4, 6].map(rung).into(),
    }
}
