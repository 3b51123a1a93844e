//! How tight each line is: a bar per line.

use super::document::{by_tightness, in_signs};
use super::lines::{LineStanding, Relation};
use super::scene::{SceneAudit, SceneLine};
use report::{Bar, Bars, ReportError, symbols};

impl SceneAudit {
    /// The tightness of every line over all runs, the tightest first; none without a line that has one.
    ///
    /// # Errors
    /// The drawing library's.
    pub(super) fn svg(&self) -> Result<Option<String>, ReportError> {
        let bar = |line: &&SceneLine| {
            let length = line.tightness?;
            let [name, says] = [line.statement.name, line.statement.says];
            let second = line.relation == Relation::Equal;
            let fails = line.standing != LineStanding::Holds;
            Some(Bar { name: name.into(), says: symbols(&in_signs(says)), length, second, fails })
        };
        let lines = self.summaries();
        Bars {
            bars: by_tightness(&lines).iter().filter_map(bar).collect(),
            first: "inequality: left side / right side".into(),
            second: "identity: difference / accuracy".into(),
            limit: "just holds".into(),
        }
        .svg()
    }
}
