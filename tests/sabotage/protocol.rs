//! Source: a benchmark is worth what the mistakes are that it sees.
//! Goal: answers of wrong solvers under the protocol of `sweep verify`: each mistake fails a claim of the scene that
//!   docs/EXTERNAL.md recommends for its kind of solver, and the matrix there is what comes out.
//! Mesh, data: the scenes of the matrix on small grids; solvers are the built-in one with a wrong component.
//!
//! `make sabotage` writes the matrix.

use std::fmt::Write;
use std::sync::Arc;

use algebra::linalg::signed_unit;
use fem::contact::StepView;
use judge::record::{CaseRecord, Key, Status};
use judge::verdict::{Decision, ForeseenConstant, Verdict};
use rayon::prelude::*;
use run::external::{Answer, Cause, Explanation, Given, InProcess, Solve, cause_of};
use run::sweep::{CasePlan, Overrides, ScenePlan, foresee, judge_scene, run_contact_case};
use scene::setup::{MeshData, NewtonMarch, Scheme, Setup, Subject};
use scene::{Norm, Scene, Source};

use crate::WRITE;
use crate::catalogue::{self, Defect, Term};
use crate::shipped::{self, edited, text};
use crate::suite::fresh;
use crate::wrong::scheme;

/// Scene, edits, n, steps.
type Row = (&'static str, &'static [(&'static str, &'static str)], &'static [u32], &'static [u32]);

/// Space alone: the error in time takes runs with 8 N steps.
const IN_SPACE: &[(&str, &str)] = &[(
    "[[predicts]]\nnorm = \"V_time_max\"\nvariable = \"k\"\norder = 2.0\nwindow_n = [16, 16]                      # one mesh: each case there needs a run with 8 N steps beside it\nwhy = \"Theorem 7, (3.17), on the space V^h of a fixed mesh\"\n",
    "",
)];

/// The columns. On its mesh of eight `signorini` has floors under its pressure: zones that cut cells.
const SCENES: [Row; 16] = [
    ("viscoelastic", &[], &[8, 16, 32], &[16]),
    ("prony", &[], &[2], &[4, 8, 16, 32, 64]),
    ("signorini", &[], &[16, 32, 64], &[8]),
    ("state-instant", &[], &[8], &[4, 8, 16, 32, 64]),
    ("state-grazing", &[], &[8, 16, 32], &[8]),
    ("compliance", &[], &[8, 16, 32], &[8]),
    ("state-open", &[], &[8, 16, 32], &[8]),
    ("affine-graded", &[], &[2], &[16, 32, 64, 128]),
    ("affine-locked", &[], &[2], &[4, 8, 16, 32, 64]),
    ("moving-obstacle-time", &[], &[2], &[4, 8, 16, 32, 64]),
    ("friction-front", IN_SPACE, &[8, 16, 32], &[8]),
    ("friction-coulomb", IN_SPACE, &[8, 16, 32], &[8]),
    ("friction-time", &[], &[2], &[6, 12, 24, 48, 96]),
    ("friction-box-time", &[], &[2], &[6, 12, 24, 48, 96]),
    ("symmetry", &[], &[8, 16, 32], &[4]),
    ("gap-and-law", &[], &[8, 16, 32], &[8]),
];

/// A mistake of the catalogue, in other words where they say more to the author of a solver.
type Mistake = (&'static str, Option<&'static str>);

/// The scene that sees all mistakes of its group.
const MISTAKES: [(&str, &[Mistake]); 12] = [
    (
        "viscoelastic",
        &[
            ("μ_L ε in place of 2 μ_L ε", Some("shear halved: μ_L ε in place of 2 μ_L ε")),
            ("shear stress counted twice", None),
            ("λ of plane stress", None),
            ("first corner of Γ1 freed", None),
            ("an inner node of Γ1 freed", None),
            ("half of Γ1 freed", None),
            ("one component alone clamped on half of Γ1", None),
            ("loads of the level before", None),
            ("loads taken for nodal densities and integrated again", None),
            ("no loads at the ends of one facet", None),
            ("no f2 on the left side", Some("no traction on the left side")),
        ],
    ),
    (
        "prony",
        &[
            ("load late by 0.001", Some("loads late by 0.001 T")),
            ("memory with the other sign", None),
            ("no memory", None),
            ("right-hand rectangle rule", None),
            ("left-hand rectangle rule", None),
            ("last weight k, not k/2", None),
            ("first weight 0, not k/2", None),
            ("last weight alone, no sum over the past", None),
            ("kernel at t_n - t_j + k", None),
            ("memory of u_{j-1} in place of u_j", None),
        ],
    ),
    (
        "state-instant",
        &[
            ("first weight k, not k/2", None),
            ("no contact: neither law nor gap", None),
            ("normal of Γ3 turned inward", None),
            ("gap ignored", None),
            ("gap 5 % too wide", None),
            ("gap 5 % too narrow", None),
            ("gap 1 % too wide", None),
            ("constraint at every other vertex", None),
            ("penalty 30 in place of the constraint", None),
            ("penalty 100 in place of the constraint", None),
            ("penalty 1e3 in place of the constraint", None),
            ("penalty 1e4 in place of the constraint", None),
            (
                "one Newton iteration, KKT system not checked",
                Some("active set stopped after one iteration"),
            ),
            ("pressures p handed over as 3 - 7 p", None),
            ("pressures with the other sign", None),
            ("pressures a quarter too low", None),
            ("forces of the vertices handed over as pressures", None),
        ],
    ),
    (
        "compliance",
        &[
            ("no compliance", Some("no law")),
            ("falling branch rises", Some("law without its falling branch: it goes on rising")),
            ("rising branch 5 % too steep", None),
        ],
    ),
    ("state-open", &[("law extended to open contact", Some("two-sided law: open contact pulls"))]),
    (
        "affine-locked",
        &[
            ("no projection", None),
            ("projection of ε, not of its deviator", None),
            ("κ constant, κ(0)", Some("ζ frozen: κ(0) at all times")),
            ("ζ explicit: its last weight on the level before", None),
            ("ζ without its square root", None),
        ],
    ),
    (
        "gap-and-law",
        &[("laws of two sides exchanged", None), ("gap of one side on all of Γ3", None)],
    ),
    (
        "moving-obstacle-time",
        &[("gap of t = 0 at all times", None), ("gap of the level before", None)],
    ),
    (
        "friction-front",
        &[
            ("friction left out", None),
            ("friction in proportion to the slip: nothing sticks", None),
            ("friction bound 10 % too large", None),
            ("friction bound of t = 0 at all times", None),
            ("half of Γ3 sticks", None),
            (
                "friction bound of the level before, KKT system not checked",
                Some("friction bound of the level before"),
            ),
        ],
    ),
    (
        "friction-coulomb",
        &[
            ("friction pushes along with the slip", None),
            (
                "friction that follows p takes a constant bound",
                Some("constant bound of friction where it follows p"),
            ),
        ],
    ),
    (
        "friction-box-time",
        &[(
            "a box of friction stresses in place of the ball, KKT system not checked",
            Some("friction along each axis by itself, not along the slip"),
        )],
    ),
    (
        "symmetry",
        &[("plane of symmetry forgotten", None), ("plane of symmetry held along itself too", None)],
    ),
];

/// A solver made of a program, with what it hands over.
struct Solver {
    program: Setup,
    handed: fn(&MeshData, &mut Answer),
}

impl Solve for Solver {
    fn solve(&self, given: &Given, data: &MeshData) -> Result<Answer, String> {
        let (mut u, mut pressure) = (Vec::new(), Vec::new());
        let (nodes, rows) = (&data.space.nodes, data.space.trace.points.len());
        let steps = given.document["steps"].as_u64().expect("steps") as u32;
        let run = self.program.scheme.march(&self.program, data, steps, &mut |view| {
            for &node in &nodes.of_vertex {
                let at = node as usize * nodes.dimension;
                u.extend_from_slice(&view.u[at..at + nodes.dimension]);
            }
            let pressures = view.compliance.iter().zip(view.multiplier).map(|(a, b)| a + b);
            pressure.extend(pressures.take(rows));
            Ok(())
        });
        run.map_err(|error| error.to_string())?;
        let mut answer = Answer { displacement: u, pressure: Some(pressure) };
        (self.handed)(data, &mut answer);
        Ok(answer)
    }
}

/// A scene with its meshes and constants, and what the sound solver leaves.
struct Stage {
    sound: Setup,
    plan: ScenePlan,
    keys: Vec<Key>,
    meshes: Vec<(u32, MeshData)>,
    foreseen: Vec<ForeseenConstant>,
    records: Vec<CaseRecord>,
}

/// How a mistake is seen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Seen {
    /// The scene has no such term: the answer is the sound one.
    Absent,
    /// The solver finds no answer.
    Silent,
    /// It passes.
    Passes,
    /// By orders of displacements, or an answer that is refused.
    Orders,
    /// By predicted constants alone.
    Constants,
    /// By pressures alone.
    Pressures,
}

impl Seen {
    fn mark(self) -> &'static str {
        match self {
            Self::Absent | Self::Silent => "",
            Self::Passes => "–",
            Self::Orders => "●",
            Self::Constants => "c",
            Self::Pressures => "p",
        }
    }
}

impl Stage {
    fn new((name, edits, ns, steps): &Row) -> Self {
        let text = edits.iter().fold(text(name), |text, (from, to)| edited(&text, from, to));
        let scene = Scene::from_source(Source::from_text("manufactured/edited.toml", text));
        let scene = scene.unwrap_or_else(|error| panic!("{name}: {error}"));
        let sound = Setup::new(scene.clone()).unwrap_or_else(|error| panic!("{name}: {error}"));
        let subject = Subject::new(scene).unwrap_or_else(|error| panic!("{name}: {error}"));
        let overrides = Overrides { n: Some(ns.to_vec()), steps: Some(steps.to_vec()) };
        let plan = ScenePlan::new(subject, &overrides);
        let mesh = |&n: &u32| (n, MeshData::new(&sound, n, None).unwrap_or_else(|e| panic!("{e}")));
        let (meshes, keys) = (ns.iter().map(mesh).collect(), plan.keys());
        let (foreseen, records) = (Vec::new(), Vec::new());
        let mut stage = Self { sound, plan, keys, meshes, foreseen, records };
        stage.records = stage.answered(&Defect::SOUND);
        stage.foreseen = foresee(&stage.plan.subject, &stage.records);
        for verdict in stage.judged(&stage.records, true) {
            assert_eq!(verdict.decision, Decision::Pass, "{name}, sound: {verdict:?}");
        }
        stage
    }

    /// The records of a solver with a mistake; what it hands over is measured as `sweep verify` does it.
    fn answered(&self, mistake: &Defect) -> Vec<CaseRecord> {
        let program = mistake.apply(fresh(&self.sound));
        let solver = Arc::new(InProcess(Solver { program, handed: mistake.answer }));
        let setup = Setup { scheme: solver, ..fresh(&self.sound) };
        let record = |case: &CasePlan| {
            let mesh = self.meshes.iter().find(|(n, _)| case.n == Some(*n));
            let (_, data) = mesh.expect("a mesh");
            self.plan.record(case, || Ok(run_contact_case(&setup, data, case)))
        };
        self.plan.cases.iter().map(record).collect()
    }

    /// What the equations say of a mistake, on the smallest case where they say something.
    fn cause(&self, mistake: &Defect) -> Option<Explanation> {
        let solver = InProcess(Solver {
            program: mistake.apply(fresh(&self.sound)),
            handed: mistake.answer,
        });
        let found = |case: &CasePlan| {
            let (_, data) = self.meshes.iter().find(|(n, _)| case.n == Some(*n))?;
            cause_of(&self.sound, &solver, data, case.steps).ok()
        };
        let all: Vec<Explanation> = self.plan.cases.iter().take(3).filter_map(found).collect();
        let wrong = all.iter().find(|found| found.cause != Cause::Nothing);
        wrong.or(all.first()).cloned()
    }

    fn judged(&self, records: &[CaseRecord], constants: bool) -> Vec<Verdict> {
        let foreseen = if constants { &self.foreseen[..] } else { &[] };
        judge_scene(self.plan.scene(), records, &self.keys, foreseen)
    }

    fn seen(&self, mistake: &Defect) -> Seen {
        let records = self.answered(mistake);
        let failed = records.iter().find_map(|record| match &record.status {
            Status::Failed { reason } => Some(reason),
            _ => None,
        });
        // A solver that fails by itself tells nothing of the scene.
        if let Some(reason) = failed {
            let refused =
                ["which is clamped", "plane of symmetry"].iter().any(|word| reason.contains(word));
            return if refused { Seen::Orders } else { Seen::Silent };
        }
        // To rounding: histories are summed in another order.
        let errors = |records: &[CaseRecord]| -> Vec<f64> {
            let errors = records.iter().flat_map(|record| &record.errors);
            errors.filter_map(|entry| entry.error).collect()
        };
        let mut pairs = errors(&self.records).into_iter().zip(errors(&records));
        if pairs.all(|(a, b)| (a - b).abs() <= 1e-9 * a + 1e-13) {
            return Seen::Absent;
        }
        let of_pressure = |norm: &str| {
            let norm = Norm::all().find(|known| known.name() == norm);
            norm.is_some_and(Norm::wants_pressure)
        };
        let open = |constants: bool, pressures: bool| {
            let verdicts = self.judged(&records, constants);
            let mut open = verdicts.iter().filter(|verdict| verdict.decision != Decision::Pass);
            open.any(|verdict| of_pressure(&verdict.norm) == pressures)
        };
        match () {
            () if open(false, false) => Seen::Orders,
            () if open(true, false) => Seen::Constants,
            () if open(false, true) => Seen::Pressures,
            () => Seen::Passes,
        }
    }
}

fn mistake(name: &str) -> Defect {
    let known = catalogue::handed().into_iter().chain(catalogue::all());
    let found = known.into_iter().find(|defect| defect.name == name);
    found.unwrap_or_else(|| panic!("no mistake {name}"))
}

/// What has to be named where a term is wrong. An answer that moves where it is held is refused with a reason that names it.
fn expected(term: Term) -> Option<Cause> {
    match term {
        Term::Elasticity => Some(Cause::Elasticity),
        Term::Load => Some(Cause::Loads),
        Term::Memory | Term::TimeRule => Some(Cause::Memory),
        Term::Projection | Term::Zeta => Some(Cause::Projection),
        Term::Gap | Term::Compliance => Some(Cause::Contact),
        Term::Friction => Some(Cause::Friction),
        Term::Answer => Some(Cause::Pressures),
        Term::Solver => Some(Cause::Levels),
        Term::Dirichlet => Some(Cause::Symmetry),
        _ => None,
    }
}

/// The built-in solver off by the tolerance of an iteration: every displacement by a share of 1e-8 of itself. It hands over no
/// pressures.
fn rounded() -> Arc<dyn Scheme> {
    scheme(|setup, data, steps, observe| {
        let mut state = 7;
        setup.scheme.march(setup, data, steps, &mut |view| {
            let u: Vec<f64> =
                view.u.iter().map(|u| u * (1.0 + 1e-8 * signed_unit(&mut state))).collect();
            let compliance = vec![f64::NAN; view.compliance.len()];
            observe(&StepView { u: &u, compliance: &compliance, ..*view })
        })
    })
}

/// On coarse meshes, of all elements, rules, laws and frictions.
#[test]
fn no_sound_solver_is_accused() {
    let mut looked_at = 0;
    for setup in shipped::bodies() {
        let data = shipped::on_a_mesh(&setup);
        let schemes = [Arc::new(NewtonMarch), rounded()];
        for (scheme, name) in schemes.into_iter().zip(["as it is", "rounded"]) {
            let found = cause_of(&setup, &*scheme, &data, 4);
            let found = found.unwrap_or_else(|error| panic!("{}: {error}", setup.scene.name));
            assert_eq!(found.cause, Cause::Nothing, "{}, {name}: {found:?}", setup.scene.name);
            looked_at += 1;
        }
    }
    assert!(looked_at > 200, "{looked_at}");
}

/// Which gap a solver takes of an obstacle that moves is said in words.
#[test]
fn a_gap_of_another_time_is_named() {
    let stage = Stage::new(&("moving-obstacle-time", &[], &[2], &[4, 8, 16]));
    for name in ["gap of t = 0 at all times", "gap of the level before"] {
        let found = stage.cause(&mistake(name)).expect("a cause");
        assert_eq!(found.says, format!("contact: the {name}"));
    }
}

/// The table of docs/EXTERNAL.md.
fn table(rows: &[(&str, Mistake, Vec<Seen>)]) -> String {
    let mut text = String::from("| mistake |");
    for (i, (scene, ..)) in SCENES.iter().enumerate() {
        let _ = write!(text, " {} `{scene}` |", i + 1);
    }
    let _ = writeln!(text, "\n|---|{}", "---|".repeat(SCENES.len()));
    for (_, (name, words), seen) in rows {
        let marks: Vec<&str> = seen.iter().map(|seen| seen.mark()).collect();
        let _ = writeln!(text, "| {} | {} |", words.unwrap_or(name), marks.join(" | "));
    }
    text
}

#[test]
fn every_mistake_fails_a_claim_of_the_recommended_scene() {
    let stages: Vec<Stage> = SCENES.par_iter().map(Stage::new).collect();
    let asked: Vec<(&str, Mistake)> = MISTAKES
        .iter()
        .flat_map(|(scene, all)| all.iter().map(move |mistake| (*scene, *mistake)))
        .collect();
    // Panics of wrong solvers are failed cases.
    let hook = std::panic::take_hook();
    std::panic::set_hook(Box::new(|_| ()));
    let rows: Vec<(&str, Mistake, Vec<Seen>)> = asked
        .par_iter()
        .map(|&(scene, named)| {
            let mistake = mistake(named.0);
            (scene, named, stages.par_iter().map(|stage| stage.seen(&mistake)).collect())
        })
        .collect();
    std::panic::set_hook(hook);
    let text = table(&rows);
    println!("{text}");
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/EXTERNAL.md");
    let document = std::fs::read_to_string(path).expect("a document");
    let from = document.find("| mistake |").expect("the matrix");
    let length = document[from..].find("\n\n").expect("its end") + 1;
    if std::env::var_os(WRITE).is_some() {
        let written = document.replace(&document[from..from + length], &text);
        std::fs::write(path, written).expect("docs/EXTERNAL.md");
    } else {
        assert_eq!(document[from..from + length], text, "docs/EXTERNAL.md: make sabotage");
    }
    assert!(rows.len() >= 24, "{}", rows.len());
    for (scene, (name, _), seen) in &rows {
        let at = SCENES.iter().position(|row| row.0 == *scene).expect("a column");
        let caught = [Seen::Orders, Seen::Constants, Seen::Pressures].contains(&seen[at]);
        assert!(caught, "{name} on {scene}: {:?}", seen[at]);
    }
    let unnamed: Vec<String> = asked
        .par_iter()
        .filter_map(|&(scene, (name, _))| {
            let at = SCENES.iter().position(|row| row.0 == scene).expect("a column");
            let mistake = mistake(name);
            let found = stages[at].cause(&mistake);
            let refused = found.is_none() && mistake.term == Term::Dirichlet;
            let named = found.as_ref().map(|found| found.cause) == expected(mistake.term);
            (!refused && !named).then(|| format!("{name} on {scene}: {found:?}"))
        })
        .collect();
    assert!(unnamed.is_empty(), "{unnamed:#?}");
}

/// How stiff a penalty: the table of docs/GALLERY.md.
#[test]
fn penalties_leave_what_the_gallery_says() {
    let row = SCENES.iter().find(|row| row.0 == "signorini").expect("a scene");
    let stage = Stage::new(row);
    let meshes: Vec<String> = row.2.iter().map(|n| format!(" n = {n} |")).collect();
    let mut text =
        format!("| penalty |{}\n|---|{}\n", meshes.concat(), "---|".repeat(meshes.len()));
    let errors = |mistake: &Defect| -> Vec<f64> {
        let records = stage.answered(mistake);
        let of = |record: &CaseRecord| record.norm("trace_L2_max").and_then(|entry| entry.error);
        records.iter().map(|record| of(record).expect("an error")).collect()
    };
    let mut all = Vec::new();
    for (words, name) in [
        ("30", Some("penalty 30 in place of the constraint")),
        ("100", Some("penalty 100 in place of the constraint")),
        ("1e3", Some("penalty 1e3 in place of the constraint")),
        ("1e4", Some("penalty 1e4 in place of the constraint")),
        ("none, the constraint", None),
    ] {
        let found = errors(&name.map_or(Defect::SOUND, mistake));
        let cells: Vec<String> = found.iter().map(|error| format!(" {error:.1e} |")).collect();
        let _ = writeln!(text, "| {words} |{}", cells.concat());
        all.push(found);
    }
    println!("{text}");
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/GALLERY.md");
    let document = std::fs::read_to_string(path).expect("a document");
    let from = document.find("| penalty |").expect("the table");
    let length = document[from..].find("\n\n").map_or(document.len() - from, |end| end + 1);
    if std::env::var_os(WRITE).is_some() {
        std::fs::write(path, document.replace(&document[from..from + length], &text)).expect(path);
    } else {
        assert_eq!(document[from..from + length], text, "docs/GALLERY.md: make sabotage");
    }
    // A compliance of 1/c adds an error of order 1/c, which no mesh takes away.
    let finest = |row: &[f64]| row[row.len() - 1];
    let [soft, .., constraint] = &all[..] else { panic!("rows") };
    assert!(finest(soft) > 2.0 * finest(constraint), "{all:?}");
}
