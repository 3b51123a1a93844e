//! The picture of a step-size study: factors against k, with bounds and thresholds.

use super::BoundStudy;
use super::ladder::StepRung;
use files::digits;
use report::{Axis, Chart, Mark, Part, Scale, Series};

impl BoundStudy {
    /// Factors of Λ against k with their bounds; none if no number can be drawn.
    pub(crate) fn svg(&self) -> Option<String> {
        let worst = &self.study.worst;
        let question = format!(
            "Contraction factor of Λ for a last step of size k after the past of level {} ({})",
            worst.level,
            self.grids()
        );
        let x = Axis::new("step size k (time)", Scale::Log);
        let y = Axis::new("contraction factor", Scale::Log);
        let mut chart = Chart::new(&self.scene, &question, x, y);
        let points = |of: fn(&StepRung) -> f64| -> Vec<(f64, f64)> {
            self.study.rungs.iter().map(|rung| (rung.k, of(rung))).collect()
        };
        let norms = |at_solution: bool| {
            let rungs = self.study.rungs.iter().filter(|rung| rung.at_solution == at_solution);
            rungs.map(|rung| (rung.k, rung.norm)).collect::<Vec<_>>()
        };
        let norm = vec![
            Part::Line(points(|rung| rung.norm)),
            Part::Points(norms(true)),
            Part::Hollow(norms(false)),
        ];
        if !norms(false).is_empty() {
            let key = "no solution found: at the last one";
            chart.keys.push((Part::Hollow(Vec::new()), key.into()));
        }
        chart.series = vec![
            Series::new("measured: ‖DΛ‖, worst direction", norm),
            Series::new(
                "measured: spectral radius of DΛ",
                vec![Part::Line(points(|at| at.radius))],
            ),
            Series::new("sharpened bound", vec![Part::Dashed(points(|rung| rung.sharpened))]),
            Series::new("(3.15), operator norm", vec![Part::Dotted(points(|rung| rung.theorem))]),
            Series::new("(3.15), the paper's norm", vec![Part::Line(points(|rung| rung.paper))]),
        ];
        chart.horizontals = vec![Mark { at: 1.0, label: "Λ contracts below 1".into() }];
        chart.verticals = self.marks();
        chart.svg()
    }

    fn marks(&self) -> Vec<Mark> {
        let mark = |at: f64, label: &str| {
            let value = if at.is_finite() { digits(at, 4) } else { "every k".into() };
            Mark { at, label: format!("{label}: {value}") }
        };
        let thresholds = &self.study.thresholds;
        let mut marks = vec![
            mark(self.limits.paper_limit(), "(3.4), the paper's norm"),
            mark(self.limits.sharpened_limit(), "sharpened"),
        ];
        let stops = thresholds.radius.filter(|[low, high]| *low > 0.0 && high.is_finite());
        marks.extend(stops.map(|[low, _]| mark(low, "Λ stops converging")));
        marks.extend(thresholds.loss.iter().map(|loss| mark(loss.bracket.1, "the solution ends")));
        marks
    }
}
