//! Regularity hypotheses: measured, and compared with what a scene claims to violate.

use super::{AbstractSetup, Result, Setup};
use crate::{AbstractScene, ContactScene, Hypothesis, Scene, Side};
use exact::{
    BodyFace, Finding, Status, regularity_in_space, regularity_in_time, second_difference,
};
use formula::{EvaluationPoint, Node};

/// The boundary of a scene's body in plane pieces, for the checks of its exact solution.
pub fn sides(body: &ContactScene) -> Vec<BodyFace> {
    let domain = &body.domain;
    let of = |side: Side| {
        let [clamped, contact] =
            [&domain.clamped, &domain.contact].map(|list| list.contains(&side));
        let faces = domain.faces(side).into_iter();
        faces.map(move |face| BodyFace { side: side.0, face, clamped, contact })
    };
    domain.all_sides().flat_map(of).collect()
}

/// The regularity in time that Theorem 7 requires of an abstract scene: u_i on [0, T], and q_l(T, ·).
pub fn abstract_regularity(scene: &Scene, problem: &AbstractScene) -> Vec<Finding> {
    let horizon = scene.time.horizon;
    let value = |node: Node, x: f64, t: f64| {
        scene.formulas.evaluate(node, &EvaluationPoint { x, t, ..EvaluationPoint::default() })
    };
    let mut findings = Vec::new();
    for (i, &u) in problem.u.iter().enumerate() {
        let subject = format!("u_{} in W2,inf (3.17)", i + 1);
        findings.push(second_difference(&subject, "the component", horizon, |t| value(u, 0.0, t)));
    }
    for (l, kernel) in problem.kernels.iter().enumerate() {
        // 1 without a power, also at s = t.
        let q = |s: f64| value(kernel.q, s, horizon) * (horizon - s).powf(-kernel.power);
        let subject = format!("q_{}(T, .) in C2 (3.17)", l + 1);
        findings.push(second_difference(&subject, "the kernel", horizon, q));
    }
    for (l, kernel) in problem.kernels.iter().enumerate() {
        let Some(r) = kernel.inner else { continue };
        let subject = format!("r_{}(T, .) in C2 (3.17)", l + 1);
        let r = |tau: f64| value(r, tau, horizon);
        findings.push(second_difference(&subject, "the kernel", horizon, r));
    }
    findings
}

/// Checks what an abstract scene claims to violate.
///
/// # Errors
/// A claim without a supporting finding.
pub(super) fn abstract_claims(setup: &AbstractSetup) -> Result<()> {
    let scene = &setup.scene;
    claim(scene, Hypothesis::RegularInSpace, Vec::new)?;
    claim(scene, Hypothesis::RegularInTime, || abstract_regularity(scene, &setup.problem))
}

/// Checks what a contact scene with an exact solution claims to violate.
///
/// # Errors
/// A claim without a supporting finding.
pub(super) fn contact_claims(setup: &Setup) -> Result<()> {
    let Some(exact) = &setup.exact else { return Ok(()) };
    let faces = sides(&setup.body);
    claim(&setup.scene, Hypothesis::RegularInSpace, || regularity_in_space(exact, &faces))?;
    claim(&setup.scene, Hypothesis::RegularInTime, || regularity_in_time(exact))
}

fn claim(
    scene: &Scene,
    hypothesis: Hypothesis,
    findings: impl FnOnce() -> Vec<Finding>,
) -> Result<()> {
    let Some(index) = scene.violates.iter().position(|&claimed| claimed == hypothesis) else {
        return Ok(());
    };
    let findings = findings();
    let shown = findings.iter().any(|finding| finding.status == Status::Weak);
    let seen: Vec<String> = findings.iter().map(|f| format!("{}: {}", f.subject, f.text)).collect();
    let message = format!(
        "the scene claims to violate ({}), but nothing shows a violation: {}",
        hypothesis.name(),
        if seen.is_empty() { "the problem has no such hypothesis".into() } else { seen.join("; ") }
    );
    let hint = "remove the claim, because a prediction for a broken hypothesis says nothing where the hypothesis holds";
    Ok(scene.refuse_if(!shown, &format!("scene.violates.{index}"), message, hint)?)
}
