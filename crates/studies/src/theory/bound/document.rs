//! A step-size study in words, tables and a picture.

use super::{BoundStudy, Constant, Crossing, StepRung};
use report::{
    Axis, Chapter, Chart, Findings, Mark, Part, Row, Run, Scale, Series, digits, precise,
};
use serde_json::json;

/// The bound is called attained if the measured factor comes this close.
const ATTAINED: f64 = 1e-6;

impl BoundStudy {
    /// What was found: claims, numbers, words.
    pub fn findings(&self) -> Findings {
        let (study, limits) = (&self.study, &self.limits);
        let title = (Chapter::Bound, format!("The bound measured: {}", self.scene));
        let scene = Some([&*self.scene, &*self.fingerprint]);
        let mut findings = Findings::new(title, scene, self.claims.clone());
        let found = &study.thresholds;
        let document = &mut findings.document;
        document.threshold = Some(match study.not_followed {
            Some(_) => "–".into(),
            None => crossing(study.thresholds.radius),
        });
        if let Some([low, high]) = self.unknown {
            document.words(format!(
                "Whether (2.9) holds is unknown, neither verified nor refused: m0 lies between {} and {}.",
                digits(low, 6),
                digits(high, 6)
            ));
        }
        let below = |k: f64| match k {
            k if k.is_infinite() => "for every k".into(),
            k if k > 0.0 => format!("for k < {}", digits(k, 4)),
            _ => "for no k".into(),
        };
        document.answer(format!(
            "Proved: Λ contracts {} by (3.4), {} by the sharpened bound; one solution per step is guaranteed {}. Measured: {}.",
            below(limits.limit()),
            below(limits.sharpened_limit()),
            below(limits.solvable_limit()),
            match &study.not_followed {
                Some(reason) => format!("nothing, {reason}"),
                None => format!("‖DΛ‖ < 1 for k below {}", crossing(study.thresholds.norm)),
            }
        ));
        document.table("The bound in four numbers, k below each.", self.numbers());
        document.words(format!(
            "Measured in a run with {}; at its level {} (t = {}), where the factor is largest, the last step is taken again with other k. Of {} random starts at k = {} {} end at the same solution, {} elsewhere, {} nowhere.",
            self.grids(),
            study.worst.level,
            digits(study.worst.t, 5),
            study.starts.same + study.starts.distinct + study.starts.failed,
            digits(study.worst.k, 6),
            study.starts.same,
            study.starts.distinct,
            study.starts.failed
        ));
        findings.table(
            "meshes",
            &study.meshes,
            "The contraction factor of Λ at that level, on this and other meshes.",
            ">n = mesh; >k = k 6; >‖DΛ‖ = norm 11; >spectral radius = radius 11; >sharpened = sharpened 11",
        );
        let document = &mut findings.document;
        let mut rungs = json!(study.rungs);
        for row in rungs.as_array_mut().into_iter().flatten() {
            for solver in ["newton", "fixed_point"] {
                if row[solver].is_string() {
                    row[solver] = json!("fails");
                }
            }
        }
        document.rows(
            "Contraction factor of Λ for a last step of size k after the same past, bounds, the iterations that solve the step, and other solutions from random starts.",
            &rungs,
            ">k = k; >spectral radius = radius; >‖DΛ‖ = norm; >sharpened = sharpened; >(3.15) = theorem; \
             >paper's norm = paper_norm; Newton = newton; Λ = fixed_point; >others = distinct",
        );
        document.table(
            "Constants, how each was obtained, and whether the true one is certainly on the safe side.",
            self.constants.iter().map(constant),
        );
        document.figure(
            "bound",
            "contraction factor of Λ against k, with the bounds of (3.4) (sweep bound).",
            self.svg(),
        );
        // Step sizes up to which something holds: null where it does for every k.
        let loss = found.loss.as_ref();
        let thresholds = json!({
            "paper_norm": limits.paper_limit(),
            "theorem": limits.limit(),
            "sharpened": limits.sharpened_limit(),
            "solvable": limits.solvable_limit(),
            "norm_one": found.norm,
            "radius_one": found.radius,
            "loss": loss.map(|loss| loss.bracket),
            "loss_reason": loss.map(|loss| &loss.reason),
            "loss_eigenvalue": loss.map(|loss| loss.rightmost),
            "not_followed": study.not_followed,
        });
        findings.number("thresholds", thresholds);
        findings.number("n", self.n);
        findings.number("steps", self.steps);
        findings.number("constants", &self.constants);
        findings.number("ratio", self.ratio());
        findings.number("attained", self.attained());
        findings.number("m0_unknown", self.unknown);
        findings.number("levels", &study.levels);
        findings.number("worst", study.worst);
        findings.number("starts", study.starts);
        findings.number("rungs", &study.rungs);
        findings
    }

    /// The measured threshold of Λ over (3.4) with the paper's norms: how many times too strict that is; none if Λ has no
    /// threshold.
    pub fn ratio(&self) -> Option<f64> {
        self.study.thresholds.radius.map(|[low, _]| low / self.limits.paper_limit())
    }

    /// Whether the measured factor equals the sharpened bound at some step size.
    pub fn attained(&self) -> bool {
        let rungs = &self.study.rungs;
        rungs.iter().any(|r| r.sharpened > 0.0 && r.norm >= (1.0 - ATTAINED) * r.sharpened)
    }

    fn grids(&self) -> String {
        let mesh = self.n.map_or(String::new(), |n| format!("n = {n}, "));
        format!("{mesh}N = {}", self.steps)
    }

    fn numbers(&self) -> Vec<Row<'static, 2>> {
        let (limits, study, found) = (&self.limits, &self.study, &self.study.thresholds);
        let limit = |k: f64| match k {
            k if k.is_infinite() => "every k".into(),
            k if k > 0.0 => digits(k, 9),
            _ => format!("no k: m0 = {}", digits(limits.m0, 7)),
        };
        let mut rows = Vec::new();
        let mut say = |what: &str, value: String| {
            rows.push([("number", Run::plain(what)), (">k", Run::plain(value))]);
        };
        say("1: (3.4), the paper's norm of ℬ", limit(limits.paper_limit()));
        say("1: (3.4), operator norm", limit(limits.limit()));
        say("2: sharpened, half weight, terms apart", limit(limits.sharpened_limit()));
        if study.not_followed.is_none() {
            say("3: ‖DΛ‖ = 1, measured", crossing(found.norm));
            say("3: spectral radius of DΛ = 1, measured", crossing(found.radius));
        }
        say("4: one solution guaranteed, by monotonicity", limit(limits.solvable_limit()));
        if let Some(loss) = &found.loss {
            let lost = format!("4: the step loses its solution: {}", loss.reason);
            say(&lost, crossing(Some(loss.bracket)));
            say("largest real eigenvalue of DΛ there", digits(loss.rightmost, 6));
        } else if let Some(last) = study.rungs.last() {
            say("4: the step has its solution", format!("> {}", digits(last.k, 5)));
        }
        if let Some(ratio) = self.ratio() {
            say("3 over 1, the paper's norm", digits(ratio, 6));
        }
        let attained = if self.attained() { "yes" } else { "no" };
        say("sharpened attained, to 1e-6", attained.into());
        rows
    }

    /// Factors of Λ against k with their bounds; none if no number can be drawn.
    fn svg(&self) -> Option<String> {
        let question = format!(
            "Contraction factor of Λ for a last step of size k after the past of level {} ({})",
            self.study.worst.level,
            self.grids()
        );
        let x = Axis::new("step size k (time)", Scale::Log);
        let y = Axis::new("contraction factor", Scale::Log);
        let mut chart = Chart::new(&self.scene, &question, x, y);
        let rungs = &self.study.rungs;
        let of = |of: fn(&StepRung) -> f64| rungs.iter().map(|rung| (rung.k, of(rung))).collect();
        let (line, points) = (Part::Line(of(|rung| rung.norm)), Part::Points(of(|rung| rung.norm)));
        chart.series = vec![
            Series::new("measured: ‖DΛ‖, worst direction", vec![line, points]),
            Series::new("measured: spectral radius of DΛ", vec![Part::Line(of(|at| at.radius))]),
            Series::new("sharpened bound", vec![Part::Dashed(of(|rung| rung.sharpened))]),
            Series::new("(3.15), operator norm", vec![Part::Dotted(of(|rung| rung.theorem))]),
            Series::new("(3.15), the paper's norm", vec![Part::Line(of(|rung| rung.paper))]),
        ];
        chart.horizontals = vec![Mark { at: 1.0, label: "Λ contracts below 1".into() }];
        let found = &self.study.thresholds;
        let stops = found.radius.filter(|[low, high]| *low > 0.0 && high.is_finite());
        let marks = [
            (Some(self.limits.paper_limit()), "(3.4), the paper's norm"),
            (Some(self.limits.sharpened_limit()), "sharpened"),
            (stops.map(|[low, _]| low), "Λ stops converging"),
            (found.loss.as_ref().map(|loss| loss.bracket[1]), "the solution ends"),
        ];
        chart.verticals.extend(marks.into_iter().filter_map(|(at, label)| {
            let at = at?;
            let value = if at.is_finite() { digits(at, 4) } else { "every k".into() };
            Some(Mark { at, label: format!("{label}: {value}") })
        }));
        chart.svg()
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

fn constant(constant: &Constant) -> Row<'static, 5> {
    let off = constant.uncertainty.map_or_else(|| "–".into(), |off| format!("{off:.1e}"));
    let side = if constant.safe { "safe side" } else { "no bound" };
    [
        ("constant", Run::formula(&constant.name)),
        (">value", precise(constant.value, 11)),
        (">±", Run::plain(off)),
        ("how", Run::plain(format!("{}; {side}", constant.how.words()))),
        ("note", Run::formula(&constant.note)),
    ]
}
