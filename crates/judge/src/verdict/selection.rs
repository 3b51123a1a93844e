//! Cases used for a prediction.

use std::collections::{BTreeMap, BTreeSet};

use serde::Serialize;

use super::{MeshAndSteps, Prediction, Variable};
use crate::record::{CaseRecord, Key, Status};
use fit::{Direction, LevelError, Point, is_step, screen};

/// A point on the line or grid of a prediction.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct JudgedPoint {
    #[serde(flatten)]
    pub point: Point,
    /// Its case.
    #[serde(skip)]
    pub place: MeshAndSteps,
    /// Why it was left out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
}

/// Cases of a line or grid: used, left out with the reason, and missing.
#[derive(Debug, Default)]
pub(super) struct Selection {
    pub(super) used: Vec<JudgedPoint>,
    pub(super) left_out: Vec<JudgedPoint>,
    /// Those left out for their floors or as zeros: what is used has to explain them.
    pub(super) screened_out: Vec<Point>,
    pub(super) gaps: Vec<String>,
}

impl Selection {
    /// The points used, and those that they have to explain.
    pub(super) fn points(&self) -> Vec<Point> {
        let used = self.used.iter().map(|used| used.point);
        used.chain(self.screened_out.iter().copied()).collect()
    }
}

/// Cases of one scene, expected or recorded, in order; of two records of one case the later counts.
pub(super) struct Cases<'a> {
    cases: Vec<(MeshAndSteps, Option<&'a CaseRecord>)>,
}

impl<'a> Cases<'a> {
    pub(super) fn new(scene: &str, records: &'a [CaseRecord], expected: &[Key]) -> Self {
        let wanted = expected.iter().filter(|key| key.scene == scene);
        let wanted = wanted.map(|key| (MeshAndSteps { n: key.n, steps: key.steps }, None));
        let found = records.iter().filter(|record| record.scene == scene);
        let found =
            found.map(|record| (MeshAndSteps { n: record.n, steps: record.steps }, Some(record)));
        let mut cases: Vec<(MeshAndSteps, Option<&CaseRecord>)> = wanted.chain(found).collect();
        cases.sort_by_key(|&(place, _)| place);
        cases.dedup_by(|later, kept| {
            let same = later.0 == kept.0;
            if same {
                *kept = *later;
            }
            same
        });
        Self { cases }
    }

    pub(super) fn points(&self, norm: &str) -> Vec<Point> {
        self.cases.iter().filter_map(|(_, record)| point((*record)?, norm)).collect()
    }

    /// Selects the cases for a prediction. Along h: all n with the largest number of steps that was run on most n;
    /// along k: all steps on the finest n that was run with most steps; jointly: all. A broken case is a gap wherever
    /// it stands.
    pub(super) fn select(&self, prediction: &Prediction) -> Selection {
        let norm = &prediction.norm;
        let line = self.line(prediction);
        let mut selection = Selection::default();
        for &(place, record) in &self.cases {
            let served = line(place);
            match found(record, norm) {
                Err(gap) => selection.gaps.push(format!("{place} {gap}")),
                Ok(None) if served => {
                    selection.gaps.push(format!("{place} has no row for {norm}"));
                }
                Ok(Some(point)) if served => {
                    let outside = outside(place, &point, prediction);
                    let screened = screen(&point).err().filter(|_| outside.is_none());
                    selection.screened_out.extend(screened.map(|_| point));
                    let reason = outside
                        .map(str::to_owned)
                        .or(screened.map(|exclusion| exclusion.to_string()));
                    let side = match &reason {
                        Some(_) => &mut selection.left_out,
                        None => &mut selection.used,
                    };
                    side.push(JudgedPoint { point, place, reason });
                }
                Ok(_) => {}
            }
        }
        if self.cases.is_empty() {
            selection.gaps.push("the scene has no case".to_owned());
        }
        selection
    }

    /// The line of a prediction. A mesh or time grid with the norm in one case needs it in all.
    fn line(&self, prediction: &Prediction) -> Box<dyn Fn(MeshAndSteps) -> bool> {
        let places = || self.cases.iter().map(|&(place, _)| place);
        match prediction.variable {
            Variable::H => {
                let measured = self.measured(&prediction.norm, |place| place.steps);
                let allowed = |s: &u32| inside(Some(*s), prediction.window_steps);
                let steps = places().map(|place| place.steps).filter(|s| measured.contains(s));
                let steps = most_frequent(steps.filter(allowed));
                Box::new(move |place| Some(place.steps) == steps)
            }
            Variable::K => {
                let measured = self.measured(&prediction.norm, |place| place.n);
                let allowed = |n: &Option<u32>| inside(*n, prediction.window_n);
                let cells = places().map(|place| place.n).filter(|n| measured.contains(n));
                let cells = most_frequent(cells.filter(allowed));
                Box::new(move |place| Some(place.n) == cells)
            }
            Variable::Joint | Variable::Path => Box::new(|_| true),
        }
    }

    /// Levels where some case has the norm; all levels if none has.
    fn measured<T: Ord>(&self, norm: &str, level: impl Fn(MeshAndSteps) -> T) -> BTreeSet<T> {
        let carries =
            |record: &Option<&CaseRecord>| record.is_some_and(|record| record.norm(norm).is_some());
        let nowhere = !self.cases.iter().any(|(_, record)| carries(record));
        let carriers = self.cases.iter().filter(|(_, record)| nowhere || carries(record));
        carriers.map(|&(place, _)| level(place)).collect()
    }
}

/// The most frequent value; of ties the largest.
pub fn most_frequent<T: Ord>(values: impl Iterator<Item = T>) -> Option<T> {
    let mut counts: BTreeMap<T, usize> = BTreeMap::new();
    values.for_each(|value| *counts.entry(value).or_default() += 1);
    counts.into_iter().max_by_key(|(_, count)| *count).map(|(value, _)| value)
}

/// The point of a case, none if it was not measured, or what is wrong with the case.
fn found(record: Option<&CaseRecord>, norm: &str) -> Result<Option<Point>, String> {
    let record = record.ok_or("is missing")?;
    match &record.status {
        Status::Failed { reason } if reason.is_empty() => return Err("failed".into()),
        Status::Failed { reason } => return Err(format!("failed: {reason}")),
        Status::Skipped => return Err("was skipped".into()),
        Status::Converged => {}
    }
    let Some(point) = point(record, norm) else { return Ok(None) };
    let entry = record.norm(norm);
    if entry.is_some_and(|entry| entry.error.is_none()) {
        return Err(format!("has no error in {norm}"));
    }
    // Every measurement has one: without, an error says nothing of its digits.
    if entry.is_some_and(|entry| entry.floor.is_none()) {
        return Err(format!("has no floor in {norm}"));
    }
    let no_h = record.n.is_some() && record.h.is_none();
    let steps = record.h.into_iter().chain([record.k]);
    if let Some(step) = no_h.then_some(f64::NAN).into_iter().chain(steps).find(|s| !is_step(*s)) {
        return Err(format!("in {norm}: {}", LevelError::Size(step)));
    }
    match screen(&point) {
        Err(exclusion) if exclusion.is_broken() => Err(format!("in {norm}: {exclusion}")),
        _ => Ok(Some(point)),
    }
}

fn point(record: &CaseRecord, norm: &str) -> Option<Point> {
    let entry = record.norm(norm).filter(|_| record.converged())?;
    Some(Point {
        h: record.h.unwrap_or(f64::NAN),
        k: record.k,
        error: entry.error.unwrap_or(f64::NAN),
        floor: entry.floor.unwrap_or(0.0),
    })
}

/// Why a case is no point of the line of a prediction.
fn outside(place: MeshAndSteps, point: &Point, prediction: &Prediction) -> Option<&'static str> {
    let MeshAndSteps { n, steps } = place;
    let needed = |along: Direction| prediction.variable.direction().is_none_or(|it| it == along);
    let mut needs = Direction::BOTH.into_iter().filter(|along| needed(*along));
    if !inside(n, prediction.window_n) || !inside(Some(steps), prediction.window_steps) {
        Some("outside window")
    } else if !needs.all(|direction| is_step(direction.step(point))) {
        Some("no step size")
    } else {
        None
    }
}

pub(super) fn inside(value: Option<u32>, window: Option<[u32; 2]>) -> bool {
    match (value, window) {
        (Some(value), Some([first, last])) => first <= value && value <= last,
        _ => true,
    }
}

/// Points along one direction of a prediction, including those below the floor: for plots.
pub fn line_points(
    scene: &str,
    records: &[CaseRecord],
    norm: &str,
    variable: Variable,
) -> Vec<JudgedPoint> {
    let prediction = Prediction::new(norm, variable, 0.0);
    let Selection { used, left_out, .. } = Cases::new(scene, records, &[]).select(&prediction);
    [used, left_out].concat()
}

/// Keys of the cases used for a prediction.
pub fn line_keys(scene: &str, records: &[CaseRecord], prediction: &Prediction) -> Vec<Key> {
    let selection = Cases::new(scene, records, &[]).select(prediction);
    selection.used.into_iter().map(|used| used.place.key(scene)).collect()
}

#[cfg(test)]
mod tests;
