//! The shares of the bounds against h.

use super::case::CaseAudit;
use super::scene::SceneAudit;
use report::{Axis, Chart, Mark, Part, ReportError, Scale, Series};

/// Ratios of these inequalities are drawn: the bounds of the proof.
const DRAWN: [&str; 7] = ["(4.7)", "(4.14)", "(4.16)", "(4.17)", "(4.19)", "(4.20)", "(5.23)"];

impl SceneAudit {
    /// Ratios left/right of the bounds against h, at the smallest k; none with fewer than two meshes.
    ///
    /// # Errors
    /// The drawing library's.
    pub fn svg(&self) -> Result<Option<String>, ReportError> {
        let steps = self.cases.iter().map(|case| case.steps).max().unwrap_or(0);
        let line: Vec<&CaseAudit> = self.cases.iter().filter(|case| case.steps == steps).collect();
        if line.len() < 2 {
            return Ok(None);
        }
        let question = format!(
            "Share of each bound that is used, largest over the levels (N = {steps}, rule {})",
            self.rule_name()
        );
        let x = Axis::new("mesh size h (length)", Scale::Log);
        let y = Axis::new("left side / right side", Scale::Log);
        let mut chart = Chart::new(&format!("{}: {}", self.scene, self.theorem()), &question, x, y);
        for name in DRAWN {
            let points: Vec<(f64, f64)> = line
                .iter()
                .filter_map(|case| {
                    let row = case.rows.iter().find(|row| row.statement.name == name)?;
                    Some((case.h, row.ratio.filter(|ratio| *ratio > 0.0)?))
                })
                .collect();
            if points.len() > 1 {
                let parts = vec![Part::Line(points.clone()), Part::Points(points)];
                chart.series.push(Series::new(name, parts));
            }
        }
        chart.horizontals = vec![Mark { at: 1.0, label: "the bound is attained".into() }];
        chart.svg()
    }
}
