//! Source: a gate that has never failed is not a gate.
//! Goal: every seeded defect of the catalogue against every gate; the sound program passes all of them, every gate
//!   catches something, and which gate catches what is as docs/SABOTAGE.md says.
//! Mesh, data: tests/sabotage/suite.rs and witness.rs.
//!
//! `make sabotage` runs the whole catalogue and writes docs/SABOTAGE.md; `make sabotage-check`, a part of `make ci`,
//! compares. Six defects run with the plain tests.

#![allow(clippy::too_many_lines, reason = "tables of defects and of bad input")]

#[path = "../again/mod.rs"]
mod again;
mod answers;
mod catalogue;
mod diagnosis;
mod document;
mod fixtures;
mod foreseen;
mod matrix;
mod norms;
mod protocol;
mod readback;
mod reasons;
#[path = "../shipped/mod.rs"]
mod shipped;
mod suite;
mod tables;
mod witness;
#[path = "../wrong/mod.rs"]
mod wrong;

use catalogue::{Defect, Term};
use fem::norms::step_errors;
use matrix::{Effect, Gate, Line, Reference};
use rayon::prelude::*;
use scene::setup::Setup;
use std::sync::LazyLock;

/// Asks for the document to be written.
const WRITE: &str = "SABOTAGE_WRITE";

/// The sound program on the whole suite.
static WHOLE: LazyLock<Reference> = LazyLock::new(|| Reference::new(suite::trials()));

fn defect(name: &str) -> Defect {
    let found = catalogue::all().into_iter().find(|defect| defect.name == name);
    found.unwrap_or_else(|| panic!("no defect {name}"))
}

fn report(line: &Line) -> String {
    let said: Vec<String> =
        line.caught.iter().map(|(gate, what)| format!("{}: {what}", gate.name())).collect();
    format!("{}\n    {}", line.defect.name, said.join("\n    "))
}

#[test]
#[ignore = "the whole catalogue takes minutes: make sabotage"]
fn every_defect_against_every_gate() {
    let start = std::time::Instant::now();
    let reference = &*WHOLE;
    let sound = reference.line(&Defect::SOUND);
    assert!(!sound.is_caught(), "the sound program is objected to: {}", report(&sound));
    assert_eq!(sound.effect, Effect::Nothing, "{:?} {:?}", sound.shift, sound.ratio);
    // Panics of defective programs are failed cases; their messages would drown the matrix.
    let hook = std::panic::take_hook();
    std::panic::set_hook(Box::new(|_| ()));
    let defects = catalogue::all();
    let lines: Vec<Line> = defects.par_iter().map(|defect| reference.line(defect)).collect();
    std::panic::set_hook(hook);
    for line in &lines {
        println!("{}", report(line));
    }
    let text = document::render(&lines);
    println!("{text}\n{} defects in {:.0?}", lines.len(), start.elapsed());
    if std::env::var_os(WRITE).is_some() {
        std::fs::write(document::path(), &text).expect("docs/SABOTAGE.md");
    }
    for gate in Gate::ALL {
        assert!(lines.iter().any(|line| line.by(gate)), "{} has never failed", gate.name());
    }
    let missed = foreseen::missed(&lines);
    assert!(missed.is_empty(), "{missed:#?}");
    let scores = document::Scores::of(&lines);
    let [theory, all] = scores.shares();
    assert_eq!(scores.orders[0], scores.orders[1], "a moved order is not caught");
    assert!(theory >= 0.85 && all >= 0.95, "{theory:.3} {all:.3}");
    for line in lines.iter().filter(|line| !line.by_theory()) {
        // A survivor without a reason is a missing gate.
        assert!(reasons::reason(line.defect.name).is_some(), "{}: why?", line.defect.name);
    }
    let committed = std::fs::read_to_string(document::path()).expect("docs/SABOTAGE.md");
    let (now, before) = (document::marks(&text), document::marks(&committed));
    for (name, gates) in &now {
        assert_eq!(Some(gates), before.get(name), "{name}: docs/SABOTAGE.md, see make sabotage");
    }
    assert_eq!(now.len(), before.len(), "docs/SABOTAGE.md has other rows: make sabotage");
}

/// Rows of the document and the catalogue are the same, and names are unique.
#[test]
fn the_document_has_a_row_for_every_defect() {
    let committed = std::fs::read_to_string(document::path()).expect("docs/SABOTAGE.md");
    let rows: Vec<String> = document::marks(&committed).into_keys().collect();
    let mut names: Vec<String> =
        catalogue::all().iter().map(|defect| defect.name.to_owned()).collect();
    names.sort();
    assert_eq!(names, rows);
    assert!(names.windows(2).all(|pair| pair[0] != pair[1]));
    assert!(names.len() >= 40);
}

/// Scenes on which the sound program passes every gate, and defects with gates that catch each.
fn are_caught(scenes: &[&str], defects: &[(&str, Gate)]) {
    let reference = Reference::new(suite::some(scenes));
    let sound = reference.line(&Defect::SOUND);
    assert!(!sound.is_caught(), "{}", report(&sound));
    for &(name, gate) in defects {
        let line = reference.line(&defect(name));
        assert!(line.by(gate), "{} by {}", report(&line), gate.name());
    }
}

/// Defects of every kind on two cheap scenes.
#[test]
fn six_defects_are_caught() {
    are_caught(
        &["affine", "steady"],
        &[
            ("last weight k, not k/2", Gate::Orders),
            ("last weight k, not k/2", Gate::Bound),
            ("solution through f32", Gate::Kkt),
            ("recursion with rates 2 % off", Gate::History),
            ("memory part of f0 with the other sign", Gate::Check),
            ("rising branch 5 % too steep", Gate::Audit),
            ("all ratios of steps taken for 2", Gate::Tables),
            ("h of rectangles and boxes doubled", Gate::Constants),
        ],
    );
    are_caught(
        &["abstract-contact"],
        &[
            ("multiplier of the load 1e-4 too large", Gate::Constants),
            ("selection of the load 1e-4 too large", Gate::Orders),
        ],
    );
}

/// Measures, truths that are runs, answers of other solvers and reports: each wrong in one place, each seen without a recorded
/// number.
#[test]
fn what_measures_answers_and_reports_show_is_checked() {
    assert_eq!(readback::misread(&Defect::SOUND), []);
    for defect in catalogue::all().iter().filter(|defect| defect.term == Term::Report) {
        let found = readback::misread(defect);
        let by = |file: &str| found.iter().any(|(of, _)| of.contains(file));
        // The kinds of files that show what is wrong; pictures know nothing of the words of a decision.
        let files: &[&str] = match defect.name {
            "the predicted order shown as the observed one" => &["forest.svg"],
            "the forest against the order 1" => &["-k.svg", "forest.svg"],
            "intervals of a report half as wide" => &["forest.svg"],
            "a failed verdict shown as a pass" => &["junit.xml"],
            "norms exchanged in a report" => &[],
            "k of a report for the horizon 1" => &["cases.csv", "-k.svg"],
            _ => &["cases.csv", "-h.svg"],
        };
        let mut tables = vec!["report.md", "tables.tex", "index.html", "report.json"];
        // verdict.json leaves floors to cases.csv.
        tables.extend((defect.name != "errors shown as floors").then_some("verdict.json"));
        for file in tables.iter().chain(files) {
            assert!(by(file), "{} in {file}: {found:#?}", defect.name);
        }
    }
    let answers = answers::Answers::new();
    assert_eq!(answers.misread(&Defect::SOUND), None);
    for defect in catalogue::all().iter().filter(|defect| defect.term == Term::Answer) {
        assert!(answers.misread(defect).is_some(), "{}", defect.name);
    }
    let norms = norms::Norms::new();
    assert_eq!(norms.of_a_sound_run().or(norms.hear(&Defect::SOUND)), None);
    for name in [
        "distance of contact sets 0 where one is empty",
        "measure of unlike contact sets halved",
        "reference run read one step late",
        "reference run with half of its remainders",
        "V_time_max without shear",
        "V_time_max against 4 N steps",
    ] {
        assert!(norms.hear(&defect(name)).is_some(), "{name}");
    }
}

/// The seams are sound where nothing wrong is passed in: the loop of the defects, and a load driven by the scheme.
#[test]
fn the_seams_are_sound() {
    let mut setup = shipped::setup("affine-locked");
    let data = shipped::on_mesh(&setup, 4);
    let errors = |setup: &Setup| {
        let mut found = Vec::new();
        let run = setup.scheme.march(setup, &data, 8, &mut |view| {
            let moments = data.truth.moments(view.t)?;
            found.push(step_errors(&data.space, &setup.model, view, &moments));
            Ok(())
        });
        run.expect("a run");
        found
    };
    let sound = errors(&setup);
    catalogue::sound_loop(&mut setup);
    assert_eq!(sound, errors(&setup));
}

/// The term of a defect of the solver is named for four of five.
#[test]
#[ignore = "a diagnosis of every defect of the solver takes minutes: make sabotage"]
fn diagnosis_names_the_term() {
    let reference = &*WHOLE;
    let hook = std::panic::take_hook();
    std::panic::set_hook(Box::new(|_| ()));
    let asked = |defect: &Defect| {
        defect.is_of_solver() && !matches!(defect.term, Term::Friction | Term::Element)
    };
    let defects: Vec<Defect> = catalogue::all().into_iter().filter(asked).collect();
    let found: Vec<_> = defects
        .par_iter()
        .filter_map(|defect| Some((defect, diagnosis::diagnosed(reference, defect)?)))
        .collect();
    std::panic::set_hook(hook);
    for (defect, found) in &found {
        let mark = if found.named { "named " } else { "MISSED" };
        println!(
            "{mark} {}: {} on {}: {:?}",
            defect.term.name(),
            defect.name,
            found.scene,
            found.finding
        );
    }
    let count = |keep: fn(&diagnosis::Diagnosed) -> bool| {
        found.iter().filter(|(_, found)| keep(found)).count()
    };
    let (named, among) = (count(|found| found.named), count(|found| found.among));
    println!("{named} named alone, {among} among others, of {}", found.len());
    assert!(10 * named >= 8 * found.len(), "{named} of {}", found.len());
}
