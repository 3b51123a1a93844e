//! A step-size study in words and tables.

use super::BoundStudy;
use super::branch::Loss;
use super::constant_table::Constant;
use super::crossing::Crossing;
use super::ladder::{StepOutcome, StepRung};
use super::run::FactorAtLevel;
use super::sampled::Sampled;
use report::{Chapter, Row, Run, StudyDocument, digits, held, number, precise, sides};

impl BoundStudy {
    /// The study as a document.
    pub fn document(&self) -> StudyDocument {
        let title = format!("The bound measured: {}", self.scene);
        let mut document =
            StudyDocument::new(Chapter::Bound, title).of_scene(&self.scene, &self.fingerprint);
        document.threshold = Some(match self.study.not_followed {
            Some(_) => "–".into(),
            None => crossing(self.study.thresholds.radius),
        });
        if let Some([low, high]) = self.unknown {
            document.words(format!(
                "Whether (2.9) holds is unknown, neither verified nor refused: m0 lies between {} and {}.",
                digits(low, 6),
                digits(high, 6)
            ));
        }
        document.words(self.answer());
        document.table("The bound in four numbers, k below each.", self.numbers());
        let violated = self.violations.iter().map(|v| {
            let at = v.k.map_or_else(String::new, |k| format!("k = {}: ", digits(k, 7)));
            format!("{at}{}: {}", v.what, sides(v.left, v.right))
        });
        let all = "Every inequality between measured and proved factors holds, and every declared constant.";
        document.verdict(self.holds(), all, violated.collect());
        let worst = &self.study.worst;
        document.words(format!(
            "Measured in a run with {}; at its level {} (t = {}), where the factor is largest, the last step is taken again with other k.",
            self.grids(),
            worst.level,
            digits(worst.t, 5)
        ));
        self.ladder(&mut document);
        document.table(
            "Constants, how each was obtained, and whether the true one is certainly on the safe side.",
            self.constants.iter().map(constant),
        );
        document.table(
            "Declared constants, and what samples need of them.",
            self.samples.iter().map(sampled),
        );
        document.figure(
            "bound",
            "contraction factor of Λ against k, with the bounds of (3.4) (sweep bound).",
            self.svg(),
        );
        document
    }

    /// The four numbers in a sentence each.
    fn answer(&self) -> String {
        let limits = &self.limits;
        let below = |k: f64| match k {
            k if k.is_infinite() => "for every k".into(),
            k if k > 0.0 => format!("for k < {}", digits(k, 4)),
            _ => "for no k".into(),
        };
        let proved = format!(
            "Proved: Λ contracts {} by (3.4), {} by the sharpened bound; one solution per step is guaranteed {}.",
            below(limits.limit()),
            below(limits.sharpened_limit()),
            below(limits.solvable_limit())
        );
        let measured = match (&self.study.not_followed, self.study.thresholds.norm) {
            (Some(reason), _) => format!("Measured: nothing, {reason}."),
            (None, crossing) => {
                let ends = match crossing {
                    None => "at every k".into(),
                    Some([0.0, k]) => format!("for no k above {}", digits(k, 4)),
                    Some([k, f64::INFINITY]) => format!("at least up to k = {}", digits(k, 4)),
                    Some([low, high]) => format!("up to k = {}", digits(0.5 * (low + high), 4)),
                };
                format!("Measured: it contracts {ends}.")
            }
        };
        format!("{proved} {measured}")
    }

    /// The last step taken with other k.
    fn ladder(&self, document: &mut StudyDocument) {
        let (study, k) = (&self.study, digits(self.study.worst.k, 6));
        document.words(format!(
            "{} random starts at k = {k}: {} at the same solution, {} elsewhere, {} nowhere.",
            study.starts.same + study.starts.distinct + study.starts.failed,
            study.starts.same,
            study.starts.distinct,
            study.starts.failed
        ));
        document.table(
            "The contraction factor of Λ at that level, on this and other meshes.",
            study.meshes.iter().map(on_mesh),
        );
        if let Some(reason) = &study.not_followed {
            document.words(format!(
                "A last step of size k after the same past: not followed: {reason}."
            ));
        }
        document.table(
            "Contraction factor of Λ for a last step of size k after the same past, bounds, what solves the step, and other solutions from random starts.",
            study.rungs.iter().map(rung),
        );
    }

    fn numbers(&self) -> Vec<Row<'static, 2>> {
        let (limits, study, found) = (&self.limits, &self.study, &self.study.thresholds);
        let row =
            |what: &str, value: String| [("number", Run::plain(what)), (">k", Run::plain(value))];
        let limit = |k: f64| match k {
            k if k.is_infinite() => "every k".into(),
            k if k > 0.0 => digits(k, 9),
            _ => format!("no k: m0 = {}", digits(limits.m0, 7)),
        };
        let mut rows = vec![
            row("1: (3.4), the paper's norm of ℬ", limit(limits.paper_limit())),
            row("1: (3.4), operator norm", limit(limits.limit())),
            row("2: sharpened, half weight, terms apart", limit(limits.sharpened_limit())),
        ];
        if study.not_followed.is_none() {
            rows.push(row("3: ‖DΛ‖ = 1, measured", crossing(found.norm)));
            rows.push(row("3: spectral radius of DΛ = 1, measured", crossing(found.radius)));
        }
        rows.push(row(
            "4: one solution guaranteed, by monotonicity",
            limit(limits.solvable_limit()),
        ));
        if let Some(loss) = study.linear {
            for (on, k) in [("S^d", loss.tensors), ("the mesh", loss.mesh)] {
                let what = format!("4: linear, 𝒜 + (k/2)ℬ(0) singular on {on}");
                rows.push(row(&what, limit(k)));
            }
        }
        let last = study.rungs.last().map_or(0.0, |rung| rung.k);
        match &found.loss {
            _ if study.not_followed.is_some() => {}
            Some(Loss { bracket: (low, high), reason, .. }) => {
                let what = format!("4: the solution followed in k ends: {reason}");
                rows.push(row(&what, format!("{} ± {:.0e}", digits(*high, 9), high - low)));
            }
            None => {
                let what = "4: the solution followed in k does not end";
                rows.push(row(what, format!("> {}", digits(last, 5))));
            }
        }
        let precise = |value: Option<f64>| value.map(|value| digits(value, 6));
        let more = [
            (
                "largest real eigenvalue of DΛ there",
                precise(found.loss.as_ref().map(|loss| loss.rightmost)),
            ),
            ("3 over 1, the paper's norm", precise(self.ratio)),
            ("sharpened attained, to 1e-6", Some(if self.attained { "yes" } else { "no" }.into())),
        ];
        rows.extend(more.into_iter().filter_map(|(what, value)| Some(row(what, value?))));
        rows
    }
}

/// Where a factor reaches one.
fn crossing(found: Option<Crossing>) -> String {
    match found {
        None => "every k".into(),
        Some([0.0, k]) => format!("< {}", digits(k, 5)),
        Some([k, f64::INFINITY]) => format!("> {}", digits(k, 5)),
        Some([low, high]) => {
            let off = 0.5 * (high - low).max(1e-15 * high);
            format!("{} ± {off:.0e}", digits(0.5 * (low + high), 9))
        }
    }
}

fn on_mesh(at: &FactorAtLevel) -> Row<'static, 5> {
    [
        (">n", Run::plain(at.mesh.map_or_else(|| "–".into(), |n| n.to_string()))),
        (">k", precise(at.k, 6)),
        (">‖DΛ‖", precise(at.norm, 11)),
        (">spectral radius", precise(at.radius, 11)),
        (">sharpened", precise(at.sharpened, 11)),
    ]
}

fn rung(rung: &StepRung) -> Row<'static, 11> {
    let solved = |outcome: &StepOutcome| match outcome {
        Ok(iterations) => Run::plain(format!("{iterations} it.")),
        Err(_) => Run::plain("fails"),
    };
    [
        (">k", precise(rung.k, 5)),
        (">spectral radius", precise(rung.radius, 5)),
        (">‖DΛ‖", precise(rung.norm, 5)),
        (">finite", precise(rung.finite_worst, 5)),
        (">random", precise(rung.finite_random, 5)),
        (">sharpened", precise(rung.sharpened, 5)),
        (">(3.15)", precise(rung.theorem, 5)),
        (">paper's norm", precise(rung.paper, 5)),
        ("Newton", solved(&rung.newton)),
        ("Λ", solved(&rung.fixed_point)),
        (">others", Run::plain(rung.distinct.to_string())),
    ]
}

fn constant(constant: &Constant) -> Row<'static, 5> {
    let off = constant.uncertainty.map_or_else(|| "–".into(), |off| format!("{off:.1e}"));
    let how = constant.how.name();
    let side = if constant.safe { "safe side" } else { "no bound" };
    [
        ("constant", Run::formula(&constant.name)),
        (">value", precise(constant.value, 11)),
        (">±", Run::plain(off)),
        ("how", Run::plain(format!("{how}, {side}"))),
        ("note", Run::formula(&constant.note)),
    ]
}

fn sampled(sample: &Sampled) -> Row<'static, 5> {
    [
        ("constant", Run::formula(&sample.what)),
        (">declared", precise(sample.declared, 9)),
        (">needed", precise(sample.needed, 9)),
        (">samples", number(f64::from(sample.samples))),
        ("", held(sample.holds)),
    ]
}
