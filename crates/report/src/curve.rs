//! The points of one norm in one direction, with its verdict.

use super::SceneSummary;
use super::chart::Datum;
use super::slope::Slope;
use judge::fit::Direction;
use judge::record::{CONTACT_SET_MAX, CaseRecord, V_TIME_MAX, norm_rank};
use judge::verdict::{JudgedPoint, Variable, Verdict, cell_texts, line_points};

/// A floor is drawn within three decades of the smallest error; below, it would flatten the picture.
const FLOOR_RANGE: f64 = 1e-3;

/// One norm in the picture: abscissa and error.
pub(super) struct Curve<'a> {
    pub(super) norm: &'a str,
    pub(super) used: Vec<Datum>,
    pub(super) left_out: Vec<Datum>,
    pub(super) floor: Vec<Datum>,
    pub(super) verdict: Option<&'a Verdict>,
    /// n of a curve along k, N of one along h.
    pub(super) fixed: Option<u32>,
}

pub(super) fn norms<'a>(records: impl IntoIterator<Item = &'a CaseRecord>) -> Vec<&'a str> {
    let mut norms: Vec<&str> = records.into_iter().flat_map(CaseRecord::norms).collect();
    norms.sort_by_key(|norm| (norm_rank(norm), *norm));
    norms.dedup();
    norms
}

/// The curves of a scene in one direction, by norm.
pub(super) fn curves<'a>(
    scene: &SceneSummary,
    records: &'a [CaseRecord],
    verdicts: &'a [Verdict],
    direction: Direction,
) -> impl Iterator<Item = Curve<'a>> {
    let norms = norms(records.iter().filter(|record| record.scene == scene.name));
    norms.into_iter().filter_map(move |norm| curve(scene, records, verdicts, norm, direction))
}

/// The curve of a norm in one direction; None with fewer than two points.
fn curve<'a>(
    scene: &SceneSummary,
    records: &[CaseRecord],
    verdicts: &'a [Verdict],
    norm: &'a str,
    direction: Direction,
) -> Option<Curve<'a>> {
    // A path is drawn over h.
    let along = |v: &Verdict| v.variable.direction() == Some(direction);
    let same = |v: &&Verdict| v.scene == scene.name && v.norm == norm && along(v);
    let verdict = verdicts.iter().find(same);
    if norm == V_TIME_MAX && direction == Direction::Space && verdict.is_none() {
        // Independent of h.
        return None;
    }
    let variable = if direction == Direction::Space { Variable::H } else { Variable::K };
    let mut points = match verdict {
        Some(verdict) => [&verdict.points_used[..], &verdict.points_left_out].concat(),
        None => line_points(&scene.name, records, norm, variable),
    };
    let fixed = points.first().filter(|_| !verdict.is_some_and(is_path));
    let fixed = fixed.and_then(|point| match direction {
        Direction::Space => Some(point.place.steps),
        Direction::Time => point.place.n,
    });
    let step = |judged: &JudgedPoint| direction.step(&judged.point);
    points.retain(|p| p.point.error > 0.0 && p.point.error.is_finite() && step(p) > 0.0);
    points.sort_by(|a, b| step(a).total_cmp(&step(b)));
    if points.len() < 2 {
        return None;
    }
    let floor = points.iter().map(|p| (step(p), p.point.floor));
    let floor = floor.filter(|(_, floor)| *floor > 0.0 && floor.is_finite()).collect();
    let (used, left_out): (Vec<_>, Vec<_>) =
        points.iter().partition(|p| verdict.is_none() || p.reason.is_none());
    let data = |points: Vec<&JudgedPoint>| -> Vec<Datum> {
        points.into_iter().map(|p| (step(p), p.point.error)).collect()
    };
    Some(Curve { norm, used: data(used), left_out: data(left_out), floor, verdict, fixed })
}

pub(super) fn is_path(verdict: &Verdict) -> bool {
    verdict.variable == Variable::Path
}

impl Curve<'_> {
    /// Whether the picture shows the curve. Without a verdict, curves that would flatten all others are left to the
    /// table: the distance of the locked sets (the length of Γ3 while one of them is empty), and errors within their
    /// floors.
    pub(super) fn is_drawn(&self) -> bool {
        let above_floor = |(step, error): &Datum| {
            let floor = self.floor.iter().find(|point| point.0 == *step);
            floor.is_none_or(|point| *error > point.1)
        };
        let readable = self.norm != CONTACT_SET_MAX && self.points().any(|p| above_floor(&p));
        self.verdict.is_some() || readable
    }

    pub(super) fn points(&self) -> impl Iterator<Item = Datum> {
        self.used.iter().chain(&self.left_out).copied()
    }

    /// The floors, if near the errors.
    pub(super) fn visible_floor(&self) -> &[Datum] {
        let lowest = self.points().map(|point| point.1).fold(f64::INFINITY, f64::min);
        let visible = self.floor.iter().all(|(_, floor)| *floor >= FLOOR_RANGE * lowest);
        if visible { &self.floor } else { &[] }
    }

    /// The predicted order, along the points used.
    pub(super) fn slope(&self) -> Option<Slope> {
        let verdict = self.verdict?;
        let label = cell_texts(verdict)[3].clone();
        Some(Slope { order: verdict.predicted, label, along: self.used.clone() })
    }
}
