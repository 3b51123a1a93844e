//! Error against h, and against k: one curve per norm, with a triangle of the predicted order.

use std::mem::discriminant;

use crate::SceneSummary;
use crate::chart::{Axis, Chart, Datum, Part, Series, Slope};
use crate::ruler::Scale;
use judge::fit::Direction;
use judge::record::{
    CONTACT_SET_MAX, CaseRecord, NORMS, V_TIME_MAX, is_by_state, norm_label, norm_label_in_time,
    norm_rank, norm_symbol,
};
use judge::verdict::{JudgedPoint, Variable, Verdict, cell_texts, line_points, most_frequent};

/// The picture of one scene in one direction; None if no norm has two points.
pub fn convergence_svg(
    scene: &SceneSummary,
    records: &[CaseRecord],
    verdicts: &[Verdict],
    direction: Direction,
) -> Option<String> {
    let (curves, not_drawn): (Vec<Curve<'_>>, Vec<Curve<'_>>) =
        curves(scene, records, verdicts, direction)
            .filter(|curve| curve.verdict.is_some() || !is_by_state(curve.norm))
            .partition(Curve::is_drawn);
    let of_scene = || records.iter().filter(|record| record.scene == scene.name);
    let level = |fixed: u32| match direction {
        Direction::Space => format!("N = {fixed}"),
        Direction::Time => format!("n = {fixed}"),
    };
    // Curves may come from different cases: the axis names the most frequent level, other curves theirs.
    let usual = most_frequent(curves.iter().filter_map(|curve| curve.fixed));
    let others = curves.iter().any(|curve| curve.fixed != usual);
    let mut step = step_name(of_scene(), direction).to_owned();
    if let Some(usual) = usual {
        let rest = if others { " where not named" } else { "" };
        step = format!("{step}, {}{rest}", level(usual));
    }
    let x = Axis::new(step, Scale::Steps);
    let y = Axis::new("error in the norm named", Scale::Log);
    let mut chart = Chart::new("", "", x, y);
    let label: fn(&str) -> &str = match of_scene().any(|record| record.n.is_some()) {
        true => norm_label,
        false => norm_label_in_time,
    };
    let named = |curve: &Curve<'_>| match curve.verdict.is_some_and(is_path) {
        true => Some("N grows with n".to_owned()),
        false => curve.fixed.filter(|level_of_curve| Some(*level_of_curve) != usual).map(level),
    };
    // Floors of judged curves explain omitted points; those of all others would hide them.
    let judged = curves.iter().any(|curve| curve.verdict.is_some());
    let floor = |curve: &Curve<'_>| match judged && curve.verdict.is_none() {
        true => Vec::new(),
        false => curve.visible_floor().to_vec(),
    };
    let series = |curve: &Curve<'_>| {
        let judged = curve.verdict.map(|verdict| {
            let [_, _, _, _, observed, decision, _] = cell_texts(verdict);
            format!("{observed} {decision}")
        });
        let rest = [Part::Hollow(curve.left_out.clone()), Part::Dashed(floor(curve))];
        let mut parts = vec![Part::Line(curve.used.clone()), Part::Points(curve.used.clone())];
        parts.extend(rest.into_iter().filter(|part| !part.points().is_empty()));
        let detail = [named(curve), judged].into_iter().flatten().collect::<Vec<_>>().join("\n");
        let (slope, ink) = (curve.slope(), ink(curve.norm));
        Series { detail, slope, ink, ..Series::new(label(curve.norm), parts) }
    };
    chart.series = curves.iter().map(series).collect();
    // Signs that occur are explained.
    for (sign, words) in
        [(Part::Hollow(Vec::new()), "left out"), (Part::Dashed(Vec::new()), "floor of the error")]
    {
        let mut parts = chart.series.iter().flat_map(|series| &series.parts);
        if parts.any(|part| discriminant(part) == discriminant(&sign)) {
            chart.keys.push((sign, words.into()));
        }
    }
    let names: Vec<&str> = not_drawn.iter().map(|curve| label(curve.norm)).collect();
    if !names.is_empty() {
        chart.note = format!("not drawn, in cases.csv: {}", names.join("; "));
    }
    chart.svg()
}

/// The abscissa and its convention.
fn step_name<'a>(
    records: impl Iterator<Item = &'a CaseRecord>,
    direction: Direction,
) -> &'static str {
    let records: Vec<&CaseRecord> = records.collect();
    // 1/n is off by a rounding at most.
    let cells = |record: &&CaseRecord| match (record.n, record.h) {
        (Some(n), Some(h)) => (f64::from(n) * h - 1.0).abs() < 1e-9,
        _ => true,
    };
    let horizon = |record: &CaseRecord| record.k * f64::from(record.steps);
    let same = |a: f64, b: f64| (a - b).abs() <= 1e-9 * b.abs();
    match direction {
        Direction::Space if records.iter().all(cells) => {
            "mesh size h = 1/n, n cells per unit length"
        }
        Direction::Space => "mesh size h, the longest edge",
        // On equal steps k N is T for every N; a graded or random grid has its largest step as k.
        Direction::Time
            if records.iter().all(|record| same(horizon(record), horizon(records[0]))) =>
        {
            "time step k = T/N"
        }
        Direction::Time => "largest time step k",
    }
}

// The points of one norm in one direction, with its verdict.

/// A floor is drawn within three decades of the smallest error; below, it would flatten the picture.
const FLOOR_RANGE: f64 = 1e-3;

/// One norm in the picture: abscissa and error.
struct Curve<'a> {
    norm: &'a str,
    used: Vec<Datum>,
    left_out: Vec<Datum>,
    floor: Vec<Datum>,
    verdict: Option<&'a Verdict>,
    /// n of a curve along k, N of one along h.
    fixed: Option<u32>,
}

pub(super) fn norms<'a>(records: impl IntoIterator<Item = &'a CaseRecord>) -> Vec<&'a str> {
    let mut norms: Vec<&str> = records.into_iter().flat_map(CaseRecord::norms).collect();
    norms.sort_by_key(|norm| (norm_rank(norm), *norm));
    norms.dedup();
    norms
}

/// The curves of a scene in one direction, by norm; those with fewer than two points are left out.
fn curves<'a>(
    scene: &SceneSummary,
    records: &'a [CaseRecord],
    verdicts: &'a [Verdict],
    direction: Direction,
) -> impl Iterator<Item = Curve<'a>> {
    let norms = norms(records.iter().filter(|record| record.scene == scene.name));
    let curve = move |norm| {
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
    };
    norms.into_iter().filter_map(curve)
}

fn is_path(verdict: &Verdict) -> bool {
    verdict.variable == Variable::Path
}

impl Curve<'_> {
    /// Whether the picture shows the curve. Without a verdict, curves that would flatten all others are left to the
    /// table: the distance of the locked sets (the length of Γ3 while one of them is empty), and errors within their
    /// floors.
    fn is_drawn(&self) -> bool {
        let above_floor = |(step, error): &Datum| {
            let floor = self.floor.iter().find(|point| point.0 == *step);
            floor.is_none_or(|point| *error > point.1)
        };
        let readable = self.norm != CONTACT_SET_MAX && self.points().any(|p| above_floor(&p));
        self.verdict.is_some() || readable
    }

    fn points(&self) -> impl Iterator<Item = Datum> {
        self.used.iter().chain(&self.left_out).copied()
    }

    /// The floors, if near the errors.
    fn visible_floor(&self) -> &[Datum] {
        let lowest = self.points().map(|point| point.1).fold(f64::INFINITY, f64::min);
        let visible = self.floor.iter().all(|(_, floor)| *floor >= FLOOR_RANGE * lowest);
        if visible { &self.floor } else { &[] }
    }

    /// The predicted order, along the points used.
    fn slope(&self) -> Option<Slope> {
        let verdict = self.verdict?;
        let label = cell_texts(verdict)[3].clone();
        Some(Slope { order: verdict.predicted, label, along: self.used.clone() })
    }
}

// The judged errors of a scene, small enough for a card: points, the line through them, the order at its end.

/// Further curves are left to the large picture.
const MOST: usize = 3;

/// The scene's verdicts in the variable of the first; None without points.
pub(super) fn thumbnail_svg(
    scene: &SceneSummary,
    records: &[CaseRecord],
    verdicts: &[Verdict],
) -> Option<String> {
    let of_scene: Vec<&Verdict> = verdicts.iter().filter(|v| v.scene == scene.name).collect();
    let in_time = of_scene.first().is_some_and(|verdict| verdict.variable == Variable::K);
    let (direction, name) = match in_time {
        true => (Direction::Time, "error against k"),
        false => (Direction::Space, "error against h"),
    };
    let drawn = curves(scene, records, verdicts, direction)
        .filter(|curve| curve.verdict.is_some() || of_scene.is_empty())
        .filter(|curve| curve.used.len() > 1)
        .take(if of_scene.is_empty() { 1 } else { MOST });
    let axes = Chart::new("", "", Axis::new(name, Scale::Steps), Axis::new("", Scale::Log));
    Chart { series: drawn.map(small).collect(), small: true, ..axes }.svg()
}

fn small(curve: Curve<'_>) -> Series {
    let order = curve.verdict.and_then(|verdict| verdict.observed);
    let name =
        order.map_or(String::new(), |order| format!("{} {order:.2}", norm_symbol(curve.norm)));
    let Curve { norm, used, left_out, .. } = curve;
    let parts = vec![Part::Line(used.clone()), Part::Points(used), Part::Hollow(left_out)];
    Series { ink: ink(norm), ..Series::new(name, parts) }
}

/// The number of a norm's colour and shape, the same in every picture.
fn ink(norm: &str) -> Option<usize> {
    Some(norm_rank(norm)).filter(|rank| *rank < NORMS.len())
}
