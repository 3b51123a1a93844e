//! Regularity hypotheses: measured, and compared with what a scene claims to violate.

use super::{AbstractSetup, Result, Setup};
use crate::{AbstractScene, ContactScene, Face, Hypothesis, Scene, Shape, Side};
use exact::{
    Finding, SideOfBox, Status, regularity_in_space, regularity_in_time, second_difference,
};
use formula::{EvaluationPoint, Node};

/// The sides of a scene's rectangle or box; empty for other shapes.
pub fn sides(body: &ContactScene) -> Vec<SideOfBox> {
    let of = |side: Side| {
        let side_of_box = move |face: Face| SideOfBox {
            normal: face.normal,
            clamped: body.domain.clamped.contains(&side),
            contact: body.domain.contact.contains(&side),
        };
        body.domain.faces(side).into_iter().map(side_of_box)
    };
    match body.domain.shape {
        Shape::Box => body.domain.all_sides().flat_map(of).collect(),
        // The exact solution knows the triangles and their sides.
        Shape::Refined(_) => Vec::new(),
    }
}

/// The regularity in time that Theorem 7 requires of an abstract scene: u_i on [0, T], and q_l(T, ·).
pub fn abstract_regularity(scene: &Scene, problem: &AbstractScene) -> Vec<Finding> {
    let (graph, horizon) = (&scene.formulas, scene.time.horizon);
    let component = |(i, &node): (usize, &Node)| {
        let value =
            |t: f64| graph.evaluate(node, &EvaluationPoint { t, ..EvaluationPoint::default() });
        let subject = format!("u_{} in W2,inf (3.17)", i + 1);
        second_difference(&subject, "the component", horizon, value)
    };
    let mut findings: Vec<Finding> = problem.u.iter().enumerate().map(component).collect();
    findings.extend(problem.kernels.iter().enumerate().map(|(l, kernel)| {
        let value = |s: f64| {
            let factor = graph.evaluate(
                kernel.q,
                &EvaluationPoint { x: s, t: horizon, ..EvaluationPoint::default() },
            );
            // 1 without a power, also at s = t.
            factor * (horizon - s).powf(-kernel.power)
        };
        let subject = format!("q_{}(T, .) in C2 (3.17)", l + 1);
        second_difference(&subject, "the kernel", horizon, value)
    }));
    let inner =
        problem.kernels.iter().enumerate().filter_map(|(l, kernel)| Some((l, kernel.inner?)));
    findings.extend(inner.map(|(l, r)| {
        let at = |tau: f64| EvaluationPoint { x: tau, t: horizon, ..EvaluationPoint::default() };
        let subject = format!("r_{}(T, .) in C2 (3.17)", l + 1);
        second_difference(&subject, "the kernel", horizon, |tau| graph.evaluate(r, &at(tau)))
    }));
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
    let sides = sides(&setup.body);
    claim(&setup.scene, Hypothesis::RegularInSpace, || regularity_in_space(exact, &sides))?;
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
