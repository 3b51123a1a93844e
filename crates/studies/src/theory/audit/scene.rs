//! A scene audited: for each inequality and run the level where it comes nearest to failing.

use rayon::prelude::*;

use super::constants::{AuditConstants, c_j_source};
use super::level::{AuditError, Auditor};
use fem::contact::{BoundaryRule, CaseError, Discretization};
use judge::claim::{Claim, Standing};
use report::{Chapter, Findings, Row, Run, digits, precise};
use run::sweep::{Runs, run_cost};
use scene::setup::{MeshData, Setup, SetupError};
use scene::{Extension, TimeRule};

/// The inequalities of a run of `setup` by its scheme, each at its worst level.
///
/// # Errors
/// [`AuditError`].
pub fn audit_case(
    setup: &Setup,
    data: &MeshData,
    steps: u32,
    constants: &AuditConstants,
) -> Result<Vec<Claim>, AuditError> {
    let mut auditor = Auditor::new(setup, data, steps, constants)?;
    let n = data.space.mesh.n;
    let run = setup
        .scheme
        .march(setup, data, steps, &mut |view| auditor.observe(view).map_err(CaseError::from));
    let info = run.map_err(|source| AuditError::Run { n, steps, source })?;
    let claims = auditor.claims(info.floors.v);
    Ok(Claim::worst(&claims).into_iter().map(|(worst, _)| worst.clone()).collect())
}

/// The runs of [`audit`], `jobs` of a mesh at a time.
pub fn audit_runs<'a>(setup: &'a Setup, ns: &[u32], steps: &[u32], jobs: usize) -> Runs<'a> {
    let grid = ns.iter().flat_map(|&n| steps.iter().map(move |&steps| (n, steps))).collect();
    let others = steps.len().min(jobs).saturating_sub(1) as f64;
    // The scene's own, and that of the memory alone.
    let truths = if setup.model.memory.is_empty() { 1.0 } else { 2.0 };
    let beside = move |space: &Discretization, steps: u32| {
        // The others march as well, with fewer steps or as many; beside each stands what the rule remembers of u and u^{kh}, and
        // once what the truths keep: points, and moments of all levels.
        let run = run_cost(setup, space, steps);
        let strains = 3.0 * space.geometry.points() as f64;
        let moments = 2.0 * strains + 2.0 * space.nodes.cells.len() as f64;
        others * run.march_bytes
            + (1.0 + others) * (1.0 + strains / space.dofs() as f64) * run.history_bytes
            + truths * (run.load_bytes + 8.0 * moments * (f64::from(steps) + 1.0))
    };
    Runs { setup, grid, beside: Box::new(beside) }
}

/// Audits the runs of `setup` on the meshes `ns` with the numbers of steps `steps`, by the boundary rule of the model.
///
/// # Errors
/// [`AuditError`]: no exact solution, a run without result.
pub fn audit(setup: &Setup, ns: &[u32], steps: &[u32]) -> Result<Findings, AuditError> {
    covered(setup)?;
    audit_under(setup, &AuditConstants::new(setup)?, ns, steps)
}

/// [`audit`] under these constants.
///
/// # Errors
/// As [`audit`].
pub fn audit_under(
    setup: &Setup,
    constants: &AuditConstants,
    ns: &[u32],
    steps: &[u32],
) -> Result<Findings, AuditError> {
    if setup.scene.dimension != 2 {
        return Err(AuditError::Dimension { scene: setup.scene.name.clone() });
    }
    let mut claims = Vec::new();
    for &n in ns {
        let data = MeshData::new(setup, n, None)?;
        let run = |&steps: &u32| audit_case(setup, &data, steps, constants);
        let cases = steps.par_iter().map(run).collect::<Result<Vec<_>, AuditError>>()?;
        claims.extend(cases.into_iter().flatten());
    }
    Ok(found(setup, constants, claims))
}

fn found(setup: &Setup, constants: &AuditConstants, mut claims: Vec<Claim>) -> Findings {
    let m0 = constants.m0();
    if m0 <= 0.0 {
        let undefined = |claim: &&mut Claim| claim.standing() == Standing::Unresolved;
        for claim in claims.iter_mut().filter(undefined) {
            claim.note = format!("m0 = {} is not positive, (2.9) is violated", digits(m0, 5));
        }
    }
    let unconstrained = setup.body.contact.as_ref().is_none_or(|contact| contact.gap.is_none());
    let theorem = if unconstrained { "Theorems 10 and 11 (K = X)" } else { "Theorem 10" };
    // The rule's word in scene files.
    let rule = match setup.rule() {
        BoundaryRule::Vertex => "vertex",
        BoundaryRule::Gauss => "gauss",
        BoundaryRule::Exact => "exact",
    };
    let scene = &setup.scene;
    let title = (Chapter::Audit, format!("Checklist: {}", scene.name));
    let mut findings = Findings::new(title, Some([&scene.name, &scene.source.hash]), claims);
    findings.document.words(format!("{theorem}; boundary rule {rule}."));
    findings.document.table("Constants of the bounds.", constants.rows());
    findings.number("theorem", theorem);
    findings.number("rule", rule);
    let mut constants = serde_json::json!(constants);
    constants["m0"] = m0.into();
    findings.number("constants", constants);
    findings
}

impl AuditConstants {
    fn rows(&self) -> [Row<'static, 2>; 10] {
        let c = self;
        let c_j = format!("c_j², {}", c_j_source(c.c_j_proved));
        let named = [
            ("m_A", c.m_a),
            ("L_A", c.l_a),
            ("α_φ", c.alpha_phi),
            ("β_φ", c.beta_phi),
            ("α_j", c.alpha_j),
            (&c_j, c.c_j_squared),
            ("c0", c.c0),
            ("c1", c.c1),
            ("‖R‖‖q‖", c.history),
            ("m0", c.m0()),
        ];
        named.map(|(name, value)| [("constant", Run::formula(name)), (">value", precise(value, 7))])
    }
}

/// What the inequalities leave out of account.
fn covered(setup: &Setup) -> Result<(), SetupError> {
    let others = [
        (Extension::Friction, "its lines are those of the normal law alone"),
        (Extension::SingularKernel, "its sums are those of kernels with a value at s = t"),
    ];
    for (extension, why) in others {
        setup.scene.without(&[extension], "sweep audit", why)?;
    }
    let message =
        "`sweep audit` knows the sums of the trapezoidal rule alone, which is that of the theorems";
    let other = setup.scene.time.rule != TimeRule::Trapezoid;
    Ok(setup.scene.refuse_if(other, "time.rule", message, "remove `rule`")?)
}
