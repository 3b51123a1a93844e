//! `sweep check`: verifies the manufactured data and the hypotheses, without a solve.

use clap::Args;

use super::abstract_problem::fact;
use super::explain::under_loads;
use super::machine::Common;
use super::{CliError, Scenes, abstract_problem, meshes_fit, print_beside, print_json};
use exact::{Finding, Status, check};
use files::digits;
use run::sweep::admit_constants;
use scene::Hypothesis;
use scene::setup::{Constants, Setup, Subject, constants, sides, trace_levels};
use studies::theory::corner::Corner;

/// `sweep check`.
#[derive(Args)]
#[command(after_help = "JSON keys with --json: scene, findings (subject, status, value, text).")]
pub(crate) struct Check {
    /// Name of a scene, or path of a TOML file
    scene: String,
    #[command(flatten)]
    common: Common,
}

impl Check {
    pub(super) fn execute(&self, scenes: &Scenes) -> Result<u8, CliError> {
        let scene = scenes.scene(&self.scene)?;
        let limit = self.common.allowance.limit();
        admit_constants(&scene, true, &limit)?;
        let subject = Subject::new(scene)?;
        let mut findings = Vec::new();
        match &subject {
            Subject::Contact(setup) => {
                meshes_fit(setup, &limit)?;
                if let Some(exact) = &setup.exact {
                    findings.extend(check(exact, &sides(&setup.body)));
                    if setup.scene.violates.contains(&Hypothesis::RegularInSpace) {
                        findings.iter_mut().for_each(strong_form_is_no_measure);
                    }
                }
                findings.extend(interfaces(setup));
                findings.extend(hypotheses(setup, &constants(setup)?));
                findings.extend(under_loads(setup).iter().map(at_corner));
            }
            Subject::Abstract(setup) => findings.extend(abstract_problem::findings(setup)),
        }
        let failed = findings.iter().any(|finding| finding.status == Status::Failed);
        if self.common.json {
            let rows: Vec<_> = findings.iter().map(row).collect();
            print_json(&serde_json::json!({ "scene": subject.scene().name, "findings": rows }))?;
        } else {
            for finding in &findings {
                let Finding { subject, status, text, .. } = finding;
                print_beside(&format!("{subject:<28} {:<9} ", status.name()), 39, text);
            }
        }
        Ok(u8::from(failed))
    }
}

fn row(finding: &Finding) -> serde_json::Value {
    serde_json::json!({
        "subject": finding.subject,
        "status": finding.status.name(),
        "value": finding.value,
        "text": finding.text,
    })
}

/// The order in h at a corner, for given loads.
fn at_corner(corner: &Corner) -> Finding {
    let order = corner.order();
    let text = format!("{}; order in h {order:.4}", corner.in_words());
    let status = if order < 1.0 { Status::Weak } else { Status::Fact };
    Finding::new("corner", status, order, text)
}

/// If (5.25) is violated f0 may be infinite at a point, and quadrature of the strong form does not judge the weak one
/// that the solver is given.
fn strong_form_is_no_measure(finding: &mut Finding) {
    if finding.subject == "loads" && finding.status == Status::Failed {
        finding.status = Status::Weak;
        finding.text.push_str(": (5.25) is violated, f0 may not be integrable by a fixed rule");
    }
}

fn alpha_nu_from(setup: &Setup) -> &'static str {
    let law = setup.body.contact.as_ref().and_then(|contact| contact.law.as_ref());
    match law.and_then(|law| law.scale) {
        Some(_) => "proved: steepest descent of the law, times its factor's maximum, sampled",
        None => "proved: steepest descent of the law",
    }
}

/// Shape of the cells on the coarsest mesh of the sweep.
fn mesh_quality(setup: &Setup) -> Finding {
    let n = setup.scene.sweep.as_ref().and_then(|sweep| sweep.n.iter().min().copied()).unwrap_or(4);
    let q = setup.body.domain.mesh(n).quality();
    let text = format!(
        "n = {n}: smallest angle {} degrees, longest edge over altitude at most {}, h_max = {}, h_max/h_min = {}",
        digits(q.smallest_angle, 3),
        digits(q.aspect, 3),
        digits(q.longest, 4),
        digits(q.longest / q.shortest, 3)
    );
    Finding::new("mesh", Status::Fact, q.smallest_angle, text)
}

/// Whether the meshes of the sweep follow the boundaries of the regions.
fn interfaces(setup: &Setup) -> Option<Finding> {
    let sweep = setup.scene.sweep.as_ref()?;
    if setup.body.material.regions.is_empty() {
        return None;
    }
    let (mut fit, mut cut) = (Vec::new(), None);
    for &n in &sweep.n {
        match setup.check_regions(n) {
            Ok(()) => fit.push(n.to_string()),
            Err(error) => cut = cut.or(Some(error)),
        }
    }
    let fits = format!("no cell is cut on n = {}", fit.join(", "));
    let (status, value, text) = match cut {
        None => (Status::Verified, fit.len() as f64, fits),
        Some(error) => (Status::Failed, f64::NAN, error.to_string()),
    };
    Some(Finding::new("mesh lines on interfaces", status, value, text))
}

/// Constants of the trace, and how friction changes them.
fn trace_findings(setup: &Setup, c: &Constants) -> Vec<Finding> {
    let mut findings = Vec::new();
    if c.c_j_squared > 0.0 {
        let levels: Vec<String> =
            trace_levels(&setup.body.domain).iter().map(u32::to_string).collect();
        let (few, list) = (levels.len() < 3, levels.join(", "));
        let how = match few {
            true => format!("on n = {list}, finer meshes having too many cells; no bound"),
            false => format!("extrapolated from n = {list}; no bound"),
        };
        findings.push(fact("c_j^2", c.c_j_squared, &how));
    }
    if let Some(bound) = c.c_j_squared_bound {
        findings.push(fact("c_j^2, upper bound", bound, "proved: distance to the clamped side"));
    }
    if setup.model.friction.is_some() {
        let how = "proved: steepest descent of the friction bound";
        findings.push(fact("alpha_tau", c.alpha_tau, how));
        findings.push(fact("c_tau^2", c.c_tau_squared, "extrapolated as c_j^2 is; no bound"));
        if let Some(coulomb) = &c.coulomb {
            let [a, b] = coulomb.coefficients(c.alpha_nu, c.c_j_squared, c.c_tau_squared);
            findings.push(fact("A", a, "of |v_nu|^2 in (2.9): friction follows the normal law"));
            findings.push(fact("B", b, "of |v_tau|^2 in (2.9)"));
            let printed = c.m_elastic - c.concave_as_printed();
            let how = "m_A - alpha_phi - alpha_nu c_j^2, less sharp than with A and B";
            findings.push(fact("m0 by alpha_phi", printed, how));
        }
    }
    findings
}

/// Constants of the paper, with their origin.
fn hypotheses(setup: &Setup, c: &Constants) -> Vec<Finding> {
    let mut findings = vec![mesh_quality(setup)];
    if !setup.body.element.is_conforming() {
        let text = "functions jump: Theorems 6 to 11 do not apply as they stand, orders are those of `why`; the constants below are those of V";
        findings.push(Finding::new("V^h in V", Status::Weak, f64::NAN, text.into()));
    }
    // Of all of φ, including friction that follows the normal law.
    let alpha_phi = match c.coulomb {
        None => "proved: mu",
        Some(_) => "mu + mu_f L_p c_j c_tau with the extrapolated c_j, c_tau",
    };
    findings.extend([
        fact("m_A, elastic part", c.m_elastic, "smallest eigenvalue of the elasticity tensor"),
        fact("m_A", c.m_a, "proved: elastic part + mu"),
        fact("L_A", c.l_a, "proved: largest eigenvalue + mu"),
        fact("alpha_phi", c.alpha_phi_as_printed(), alpha_phi),
        fact("alpha_nu", c.alpha_nu, alpha_nu_from(setup)),
    ]);
    findings.extend(trace_findings(setup, c));
    let status = if c.m0 > 0.0 { Status::Verified } else { Status::Weak };
    let text = format!("m0 = {} with the extrapolated c_j^2", digits(c.m0, 7));
    findings.push(Finding::new("m0 > 0 (2.9)", status, c.m0, text));
    findings.push(fact("beta_phi", c.beta_phi, "proved: max(mu L_kappa sqrt|Omega|, 1)"));
    findings.push(fact("|B|", c.memory.operator, "operator norm, sampled over [0, T]"));
    if c.singular.0 > 0.0 {
        let note = format!("the same of C in the terms t^-{} C", c.singular.0);
        findings.push(fact("|C|", c.singular.1.operator, &note));
    }
    if setup.body.material.projection.is_some() {
        findings.push(fact("L_kappa", c.lipschitz_kappa, "sampled exact derivative"));
    }
    let bounds = c.step_bounds(setup.model.time_rule.as_ref());
    let (limit, sharpened) = (bounds.limit(), bounds.sharpened_limit());
    findings.push(fact("step bound (3.4)", limit, "k below this: one solution per step"));
    findings.push(fact("sharpened step bound", sharpened, "half weight, terms apart"));
    let solvable = bounds.solvable_limit();
    findings.push(fact("solvable step bound", solvable, "k below this: each step monotone"));
    findings
}
