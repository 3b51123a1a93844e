//! The points of one norm in one direction, with its verdict.

use super::SceneSummary;
use super::chart::Datum;
use super::slope::Slope;
use judge::fit::{Direction, Point};
use judge::record::{CONTACT_SET_MAX, CaseRecord, V_TIME_MAX, norm_rank};
use judge::verdict::{Variable, Verdict, cell_texts, line_points};

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

/// The curve of a norm in one direction; None with fewer than two points.
pub(super) fn curve<'a>(
    scene: &SceneSummary,
    records: &[CaseRecord],
    verdicts: &'a [Verdict],
    norm: &'a str,
    direction: Direction,
) -> Option<Curve<'a>> {
    let variable = match direction {
        Direction::Space => Variable::H,
        Direction::Time => Variable::K,
    };
    // A path is drawn over h.
    let along = |v: &Verdict| v.variable == variable || is_path(v) && direction == Direction::Space;
    let same = |v: &&Verdict| v.scene == scene.name && v.norm == norm && along(v);
    let verdict = verdicts.iter().find(same);
    if norm == V_TIME_MAX && direction == Direction::Space && verdict.is_none() {
        // Independent of h.
        return None;
    }
    let points = match verdict {
        Some(verdict) => judged_points(verdict, records),
        None => line_points(&scene.name, records, norm, variable),
    };
    let drawable = |p: &&Point| p.error > 0.0 && p.error.is_finite() && direction.step(p) > 0.0;
    let pair = |p: &Point| (direction.step(p), p.error);
    let (used, left_out): (Vec<&Point>, Vec<&Point>) =
        points.iter().filter(drawable).partition(|p| verdict.is_none_or(|v| uses(v, p)));
    if used.len() + left_out.len() < 2 {
        return None;
    }
    let path = verdict.is_some_and(is_path);
    let fixed =
        points.first().filter(|_| !path).and_then(|point| fixed_level(point, records, direction));
    let floor = points.iter().filter(drawable).map(|p| (direction.step(p), p.floor));
    Some(sorted(Curve {
        norm,
        used: used.into_iter().map(pair).collect(),
        left_out: left_out.into_iter().map(pair).collect(),
        floor: floor.filter(|(_, floor)| *floor > 0.0 && floor.is_finite()).collect(),
        verdict,
        fixed,
    }))
}

pub(super) fn is_path(verdict: &Verdict) -> bool {
    verdict.variable == Variable::Path
}

fn uses(verdict: &Verdict, point: &Point) -> bool {
    verdict.points_used.iter().any(|used| same_step(used.h, point.h) && used.k == point.k)
}

/// The level in the other direction of a point's case.
fn fixed_level(point: &Point, records: &[CaseRecord], direction: Direction) -> Option<u32> {
    let record = case_of(records, point.h, point.k)?;
    match direction {
        Direction::Space => Some(record.steps),
        Direction::Time => record.n,
    }
}

fn case_of(records: &[CaseRecord], h: f64, k: f64) -> Option<&CaseRecord> {
    let here = |record: &&CaseRecord| same_step(record.h.unwrap_or(f64::NAN), h) && record.k == k;
    records.iter().find(here)
}

/// Equal, or both absent: an abstract scene has no h.
fn same_step(a: f64, b: f64) -> bool {
    a == b || a.is_nan() && b.is_nan()
}

fn judged_points(verdict: &Verdict, records: &[CaseRecord]) -> Vec<Point> {
    let floor = |h: f64, k: f64| {
        case_of(records, h, k).and_then(|record| record.norm(&verdict.norm)?.floor).unwrap_or(0.0)
    };
    let used = verdict.points_used.iter().map(|p| (p.h, p.k, p.error));
    let left_out = verdict.points_left_out.iter().map(|p| (p.h, p.k, p.error));
    used.chain(left_out).map(|(h, k, error)| Point { h, k, error, floor: floor(h, k) }).collect()
}

fn sorted(mut curve: Curve<'_>) -> Curve<'_> {
    for line in [&mut curve.used, &mut curve.left_out, &mut curve.floor] {
        line.sort_by(|a, b| a.0.total_cmp(&b.0));
    }
    curve
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
