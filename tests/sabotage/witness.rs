//! What a defective program shows beside its sweep, against inequalities, identities and values from outside: those
//! of the audit, the history summed again, the Gronwall envelope, the factor of Λ, the check of the exact side, the
//! fixtures.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

use algebra::linalg::axpy;
use exact::{Exact, Status, Truth, check};
use fem::contact::{CaseError, Discretization, StepView, strain_distance, strain_norm};
use judge::claim::{Place, Standing};
use scene::setup::{AbstractSetup, MeshData, Setup, Subject, sides, step_bounds};
use scene::{Scene, Source};
use serde_json::Value;
use studies::solution::FinalState;
use studies::theory::audit::{AuditConstants, Auditor};
use studies::theory::bound::contraction;
use studies::theory::gronwall::{
    ContactInTime, Envelopes, Estimate, InTime, TruthAtLevel, prepare,
};
use vhi::StepBounds;
use vhi::history::{Memory, TimeGrid};

use crate::catalogue::{Defect, through};
use crate::fixtures;
use crate::norms::Norms;
use crate::shipped::{at_level, setup, text};
use crate::suite::{data, fresh, other_exact};

/// A sound scene on one mesh.
struct Stage {
    sound: Setup,
    space: Arc<Discretization>,
    truth: Arc<dyn Truth>,
}

impl Stage {
    fn new(name: &str, n: u32) -> Self {
        let sound = setup(name);
        let data = MeshData::new(&sound, n, None).unwrap_or_else(|error| panic!("{error}"));
        Self { space: data.space, truth: data.truth, sound }
    }

    /// The defective program with what it works on.
    fn program(&self, defect: &Defect) -> (Setup, MeshData) {
        let program = through(&defect.program, fresh(&self.sound));
        let data = data(defect, &program, &self.sound, &self.space, &self.truth);
        (program, data)
    }
}

/// The first link of the chain that does not hold.
fn violated(envelopes: &Envelopes, run: &Estimate) -> Option<&'static str> {
    let claims = envelopes.claims(run, &Place::default());
    let failed = claims.iter().find(|claim| claim.standing() != Standing::Passes)?;
    Some(failed.statement.says)
}

/// A run that broke off is no result, whatever else is said of it.
fn refused(error: CaseError) -> String {
    format!("no result: {error}")
}

/// Scenes, meshes and steps of the audit.
const AUDITED: [(&str, u32, u32); 7] = [
    ("compliance", 4, 4),
    ("affine", 2, 4),
    ("affine-locked", 2, 4),
    ("in-space", 8, 4),
    ("signorini", 4, 4),
    ("viscoelastic", 4, 4),
    ("pure-mild", 2, 8),
];
/// Scenes, meshes and steps of the envelopes.
const ENVELOPED: [(&str, u32, u32); 3] =
    [("affine-locked", 2, 128), ("in-space", 8, 64), ("long-growing", 2, 128)];
/// Scenes of the factor of Λ: its sharpened bound is attained in the first.
const BOUNDED: [&str; 2] = ["memory-minus-identity", "punch"];
/// The given-load scenes of the fixtures.
const PUNCHES: [&str; 3] = ["punch", "elastic-punch", "linear-punch"];

struct Enveloped {
    stage: Stage,
    steps: u32,
    levels: Vec<TruthAtLevel>,
    run: Estimate,
    envelopes: Envelopes,
}

/// The sound side of all witnesses.
pub struct Witnesses {
    audited: Vec<(Stage, u32, AuditConstants)>,
    enveloped: Vec<Enveloped>,
    bounded: Vec<(Setup, StepBounds)>,
    punches: Vec<(Stage, u32, Value)>,
    affine: Vec<(Stage, Value)>,
    pointwise: Setup,
    finite: Scene,
    norms: Norms,
}

/// What each witness objects to; `None` where it sees nothing.
#[derive(Debug, Default)]
pub struct Testimony {
    pub audit: Option<String>,
    pub history: Option<String>,
    pub gronwall: Option<String>,
    pub bound: Option<String>,
    pub check: Option<String>,
    pub norms: Option<String>,
    pub fixtures: Option<String>,
}

impl Witnesses {
    pub fn new() -> Self {
        let audited = AUDITED.map(|(name, n, steps)| {
            let stage = Stage::new(name, n);
            let constants = AuditConstants::new(&stage.sound).expect("constants");
            (stage, steps, constants)
        });
        let enveloped = ENVELOPED.map(|(name, n, steps)| {
            let stage = Stage::new(name, n);
            let scene = ContactInTime::new(&stage.sound, n, &[steps]).expect("a scene in time");
            let run = scene.measure(steps).expect("a run");
            let levels = scene.truth.levels(&stage.sound, steps).expect("levels");
            let envelopes = run.envelopes().expect("envelopes");
            Enveloped { stage, steps, levels, run, envelopes }
        });
        let bounded = BOUNDED.map(|name| {
            let sound = setup(name);
            let bounds = step_bounds(&sound).expect("bounds");
            (sound, bounds)
        });
        let punches = PUNCHES.iter().flat_map(|name| {
            [4, 8].map(|level| (Stage::new(name, level), level, fixtures::punch(name, level)))
        });
        let affine = fixtures::AFFINE.iter().flat_map(|(name, part)| {
            fixtures::rows(part).into_iter().take(2).map(|row| (Stage::new(name, 4), row))
        });
        let finite = Scene::from_source(Source::from_text("finite.toml", text("abstract-smooth")));
        Self {
            audited: audited.into(),
            enveloped: enveloped.into(),
            bounded: bounded.into(),
            punches: punches.collect(),
            affine: affine.collect(),
            pointwise: setup("pure-strong"),
            finite: finite.expect("a scene"),
            norms: Norms::new(),
        }
    }

    /// What the witnesses say of a program with this defect.
    pub fn hear(&self, defect: &Defect) -> Testimony {
        let guarded = |ask: &dyn Fn() -> Option<String>| {
            catch_unwind(AssertUnwindSafe(ask)).unwrap_or_else(|_| Some("panicked".into()))
        };
        Testimony {
            audit: guarded(&|| self.audit(defect)),
            history: guarded(&|| self.history(defect)),
            gronwall: guarded(&|| self.gronwall(defect)),
            bound: guarded(&|| self.bound(defect)),
            check: guarded(&|| self.check(defect)),
            norms: guarded(&|| self.norms.hear(defect)),
            fixtures: guarded(&|| self.fixtures(defect)),
        }
    }

    /// The inequalities of the proofs on runs of the defective program.
    fn audit(&self, defect: &Defect) -> Option<String> {
        self.audited.iter().find_map(|(stage, steps, constants)| {
            let (program, data) = stage.program(defect);
            let mut scene = fresh(&stage.sound);
            scene.exact.clone_from(&program.exact);
            let mut auditor = Auditor::new(&scene, &data, *steps, constants).ok()?;
            let run = program.scheme.march(&program, &data, *steps, &mut |view| {
                auditor.observe(view).map_err(CaseError::from)
            });
            // A run without result is not the audit's finding.
            let floor = run.ok()?.floors.v;
            let claims = auditor.claims(floor);
            let failed = claims.iter().find(|claim| claim.standing() == Standing::Fails)?;
            Some(format!("{} on {}", failed.statement.source, stage.sound.scene.name))
        })
    }

    /// The history and ζ that the program shows, against direct sums of the displacements that it shows.
    fn history(&self, defect: &Defect) -> Option<String> {
        let scenes = self.audited.iter().filter(|(stage, _, _)| {
            ["compliance", "affine", "viscoelastic"].contains(&stage.sound.scene.name.as_str())
        });
        scenes.into_iter().find_map(|(stage, _, _)| {
            let (program, data) = stage.program(defect);
            let mut again = Summed::new(&program, &data, 8);
            let run = program.scheme.march(&program, &data, 8, &mut |view| {
                again.see(view);
                Ok(())
            });
            run.ok()?;
            let off = again.off;
            let wrong = off.is_nan() || off > SUMS;
            wrong.then(|| format!("{} off by {off:.1e}", stage.sound.scene.name))
        })
    }

    /// e_n against the weighted envelope of the sound scene.
    fn gronwall(&self, defect: &Defect) -> Option<String> {
        let contact = self.enveloped.iter().find_map(|enveloped| {
            let (program, data) = enveloped.stage.program(defect);
            let mut estimate = enveloped.run.clone();
            estimate.error.clear();
            let run = program.scheme.march(&program, &data, enveloped.steps, &mut |view| {
                let exact = &enveloped.levels[view.n].u;
                estimate.error.push(strain_distance(&data.space, view.u, exact));
                Ok(())
            });
            run.ok()?;
            let says = violated(&enveloped.envelopes, &estimate)?;
            Some(format!("{says} on {}", enveloped.stage.sound.scene.name))
        });
        contact.or_else(|| {
            let sound = AbstractSetup::new(self.finite.clone()).expect("a setup");
            let program = through(&defect.abstract_program, sound);
            let subject = Subject::Abstract(Box::new(program));
            let run = prepare(&subject, None, &[64]).ok()?.measure(64).ok()?;
            let says = violated(&run.envelopes().ok()?, &run)?;
            Some(format!("{says} on abstract-smooth"))
        })
    }

    /// ‖DΛ‖ of the defective model at the last of four levels against the sharpened bound.
    fn bound(&self, defect: &Defect) -> Option<String> {
        self.bounded.iter().find_map(|(sound, bounds)| {
            let program = through(&defect.program, fresh(sound));
            let data = MeshData::new(&program, 2, None).ok()?;
            let k = program.grid(4).step(4);
            let norm = at_level(&program, &data, 4, 4, |level, state| {
                let found = contraction(level, &state.u, &state);
                Ok(found.map_or(f64::NAN, |found| found.norm))
            });
            let (norm, most) = (norm.ok()?, bounds.sharpened_factor(k));
            // Rounding of a norm, as the gate of the bound has it.
            let wrong = norm.is_nan() || norm > most * (1.0 + 1e-9);
            wrong.then(|| format!("{norm:.4} > {most:.4} on {}", sound.scene.name))
        })
    }

    /// `sweep check` of an exact side that a defect replaced.
    fn check(&self, defect: &Defect) -> Option<String> {
        let (stage, _, _) = &self.audited[0];
        let (program, _) = stage.program(defect);
        let exact: &Exact = other_exact(&program, &stage.sound)?;
        let findings = check(exact, &sides(&program.body));
        let failed = findings.iter().find(|finding| finding.status == Status::Failed)?;
        Some(failed.subject.clone())
    }

    /// Values of an independent implementation.
    fn fixtures(&self, defect: &Defect) -> Option<String> {
        let punches = self.punches.iter().find_map(|(stage, level, expected)| {
            let (program, data) = stage.program(defect);
            let mut last = None;
            let run = program.scheme.march(&program, &data, *level, &mut |view| {
                let state = || FinalState::new(&data.space, &stage.sound.model, view);
                last = (view.n == *level as usize).then(state);
                Ok(())
            });
            if let Err(error) = run {
                return Some(refused(error));
            }
            fixtures::punch_disagrees(&last?, expected)
        });
        let affine = || {
            self.affine.iter().find_map(|(stage, row)| {
                let (program, data) = stage.program(defect);
                let program = through(&defect.measured, program);
                fixtures::affine_disagrees(&stage.sound, &program, &data, row)
            })
        };
        let pointwise = || {
            let program = through(&defect.program, fresh(&self.pointwise));
            fixtures::fields_disagree(other_exact(&program, &self.pointwise)?)
        };
        punches.or_else(affine).or_else(pointwise)
    }
}

/// Rounding of sums of eight terms, relative to the largest of them.
const SUMS: f64 = 1e-12;

/// The history of a run, by direct sums.
struct Summed<'a> {
    program: &'a Setup,
    data: &'a MeshData,
    grid: TimeGrid,
    direct: Memory,
    norms: Vec<f64>,
    off: f64,
}

impl<'a> Summed<'a> {
    fn new(program: &'a Setup, data: &'a MeshData, steps: u32) -> Self {
        let grid = program.grid(steps);
        Self { program, data, grid, direct: Memory::direct(), norms: Vec::new(), off: 0.0 }
    }

    fn see(&mut self, view: &StepView<'_>) {
        let (rule, grid, n) = (&*self.program.model.time_rule, &self.grid, view.n);
        self.norms.push(strain_norm(&self.data.space, view.u));
        let zeta: f64 =
            self.norms.iter().enumerate().map(|(j, z)| rule.weight(grid, n, j) * z).sum();
        // Without projection ζ is shown for information, and by the trapezoidal rule.
        let acts = self.program.model.projection.is_some();
        let mut off = if acts { (view.zeta - zeta).abs() / zeta.abs().max(1e-3) } else { 0.0 };
        if let ([term], [shown]) = (&self.program.model.memory[..], view.history) {
            let mut sum = vec![0.0; shown.len()];
            self.direct.past(&*term.kernel, rule, grid, &mut sum);
            self.direct.commit(grid, view.u);
            let now = vhi::law::Convolution(&*term.kernel);
            axpy(rule.kernel_weight(&now, grid, n, n), view.u, &mut sum);
            let largest = sum.iter().fold(1e-3f64, |most, value| most.max(value.abs()));
            let worst = sum.iter().zip(shown).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            off = off.max(worst / largest);
        }
        self.off = if off.is_nan() || off > self.off { off } else { self.off };
    }
}
