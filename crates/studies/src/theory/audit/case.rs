//! One run audited: the lines at every level, and what they come to over all of them.

use super::constants::AuditConstants;
use super::fields::Fields;
use super::in_space::InSpaceFields;
use super::level::Levels;
use super::lines::{Line, LineStanding, Statement, lines};
use super::smooth::SmoothFields;
use algebra::linalg::larger;
use exact::Truth;
use fem::contact::{CaseError, LoadError, StepView};
use scene::setup::{MeshData, Setup, SetupError};

/// Why a scene cannot be audited.
#[derive(Debug, thiserror::Error)]
pub enum AuditError {
    #[error(
        "scene `{scene}` has no exact solution, and every line of the proof needs u: choose a scene with [exact]"
    )]
    NoTruth { scene: String },
    #[error(
        "scene `{scene}` has regions, an anisotropic tensor or several memory kernels: the audit knows one isotropic tensor and one kernel; `sweep run`, `bound` and `gronwall` serve this scene"
    )]
    Material { scene: String },
    #[error(
        "scene `{scene}` is one in space, and the integrals of the audit cut triangles and edges: choose a plane scene"
    )]
    Dimension { scene: String },
    #[error(transparent)]
    Setup(#[from] SetupError),
    #[error("n = {n}, N = {steps}: {source}")]
    Run {
        /// Cells per unit length.
        n: u32,
        steps: u32,
        source: CaseError,
    },
}

/// A line over all levels of a run.
#[derive(Debug, Clone, Default)]
pub struct CaseLine {
    /// The line of the proof.
    pub statement: Statement,
    /// Largest |left| and |right|.
    pub left: f64,
    /// Largest |right|.
    pub right: f64,
    /// Largest left/right (inequalities), largest |left - right| over the larger side (identities);
    /// none where both sides stay below the accuracy.
    pub ratio: Option<f64>,
    /// Largest accuracy.
    pub accuracy: f64,
    /// Largest rounding.
    pub rounding: f64,
    /// The level at which it fails worst.
    pub violation: Option<(usize, Line)>,
    /// The line where it is tightest; none where no level has a tightness.
    pub tightest: Option<Line>,
    /// Its bound is not defined at some level.
    pub undefined: bool,
}

/// An audited run.
#[derive(Debug, Clone)]
pub struct CaseAudit {
    /// Cells per unit length.
    pub n: u32,
    /// N.
    pub steps: u32,
    /// h.
    pub h: f64,
    /// k.
    pub k: f64,
    /// The lines.
    pub rows: Vec<CaseLine>,
}

/// Sees the levels of a run.
pub struct Auditor<'a> {
    truth: &'a dyn Truth,
    constants: &'a AuditConstants,
    unconstrained: bool,
    fields: Box<dyn Fields>,
    levels: Levels<'a>,
    rows: Vec<CaseLine>,
}

impl<'a> Auditor<'a> {
    /// An auditor of a run of `setup` on the mesh of `data` with the given number of steps.
    ///
    /// # Errors
    /// [`AuditError::NoTruth`], [`AuditError::Material`].
    pub fn new(
        setup: &'a Setup,
        data: &'a MeshData,
        steps: u32,
        constants: &'a AuditConstants,
    ) -> Result<Self, AuditError> {
        let missing = || AuditError::NoTruth { scene: setup.scene.name.clone() };
        let other = || AuditError::Material { scene: setup.scene.name.clone() };
        let exact = setup.exact.as_ref().ok_or_else(missing)?;
        let interpolated = setup.body.data.is_interpolated();
        let fields: Box<dyn Fields> = if interpolated {
            Box::new(InSpaceFields::new(exact, &data.space, setup.compliance_rule()))
        } else {
            Box::new(SmoothFields::new(setup, exact, &data.space))
        };
        Ok(Self {
            truth: &*data.truth,
            constants,
            unconstrained: is_unconstrained(setup),
            fields,
            levels: Levels::new(setup, &data.space, steps).ok_or_else(other)?,
            rows: Vec::new(),
        })
    }

    /// Computes the lines at the level that `view` shows; levels come in order.
    ///
    /// # Errors
    /// The truth's.
    pub fn observe(&mut self, view: &StepView<'_>) -> Result<(), LoadError> {
        let load = self.truth.load(view.t)?;
        let level = self.levels.next(&mut *self.fields, view, &load)?;
        for (i, line) in lines(&level, self.constants, self.unconstrained).iter().enumerate() {
            if i == self.rows.len() {
                let statement = line.statement;
                self.rows.push(CaseLine { statement, ..CaseLine::default() });
            }
            self.rows[i].add(view.n, line);
        }
        Ok(())
    }

    /// The lines over all levels seen.
    pub fn rows(self) -> Vec<CaseLine> {
        self.rows
    }
}

impl CaseLine {
    /// Over all levels; a violation outweighs everything else.
    pub(crate) fn standing(&self) -> LineStanding {
        match (self.violation, self.undefined) {
            (Some(_), _) => LineStanding::Violated,
            (None, true) => LineStanding::Undefined,
            (None, false) => LineStanding::Holds,
        }
    }

    fn add(&mut self, level: usize, line: &Line) {
        self.left = larger(self.left, line.left.abs());
        self.right = larger(self.right, line.right.abs());
        self.accuracy = larger(self.accuracy, line.accuracy);
        self.rounding = larger(self.rounding, line.rounding);
        self.ratio = self.ratio.into_iter().chain(line.ratio()).reduce(larger);
        self.undefined |= line.standing() == LineStanding::Undefined;
        if line.tightness().is_some() && self.tightest.is_none_or(|known| is_tighter(line, &known))
        {
            self.tightest = Some(*line);
        }
        let beyond = |line: &Line| line.excess() - line.accuracy;
        let worse = |(_, known): (usize, Line)| is_worse(beyond(line), beyond(&known));
        if line.standing() == LineStanding::Violated && self.violation.is_none_or(worse) {
            self.violation = Some((level, *line));
        }
    }
}

/// Whether a number is worse than one that is known; a NaN is worst of all.
fn is_worse(here: f64, known: f64) -> bool {
    !known.is_nan() && (here.is_nan() || here > known)
}

/// Whether a line is tighter than another; both have a tightness.
pub(super) fn is_tighter(line: &Line, known: &Line) -> bool {
    let [line, known] = [line, known].map(|line| line.tightness().unwrap_or(f64::NEG_INFINITY));
    is_worse(line, known)
}

/// Whether K = X: no gap.
pub(super) fn is_unconstrained(setup: &Setup) -> bool {
    setup.body.contact.as_ref().is_none_or(|contact| contact.gap.is_none())
}

/// Runs a case of `setup` by its scheme and audits every level.
///
/// # Errors
/// [`AuditError`].
pub fn audit_case(
    setup: &Setup,
    data: &MeshData,
    steps: u32,
    constants: &AuditConstants,
) -> Result<CaseAudit, AuditError> {
    let mut auditor = Auditor::new(setup, data, steps, constants)?;
    let mut observe = |view: &StepView<'_>| auditor.observe(view).map_err(CaseError::from);
    setup.scheme.march(setup, data, steps, &mut observe).map_err(|source| AuditError::Run {
        n: data.space.mesh.n,
        steps,
        source,
    })?;
    Ok(CaseAudit {
        n: data.space.mesh.n,
        steps,
        h: data.space.mesh.h(),
        k: setup.grid(steps).largest_step(),
        rows: auditor.rows(),
    })
}
