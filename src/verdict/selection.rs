//! Which cases serve a prediction.

use std::collections::{BTreeMap, BTreeSet};

use super::{PointLeftOut, PointUsed, Prediction, Variable};
use crate::fit::{Direction, Point, screen};
use crate::record::{CaseRecord, Key, Status};

/// A case with its point.
#[derive(Debug, Clone)]
pub(super) struct Serving {
    pub(super) key: Key,
    pub(super) point: Point,
}

/// The cases of a line or grid, sorted into those that serve, those left out with the reason,
/// and what is missing altogether.
#[derive(Debug, Default)]
pub(super) struct Selection {
    pub(super) used: Vec<Serving>,
    pub(super) left_out: Vec<(Serving, String)>,
    pub(super) gaps: Vec<String>,
}

impl Selection {
    pub(super) fn points(&self) -> Vec<Point> {
        self.used.iter().map(|serving| serving.point).collect()
    }

    pub(super) fn points_used(&self) -> Vec<PointUsed> {
        let plain = |Point { h, k, error, .. }: Point| PointUsed { h, k, error };
        self.used.iter().map(|serving| plain(serving.point)).collect()
    }

    pub(super) fn points_left_out(&self) -> Vec<PointLeftOut> {
        let plain = |Point { h, k, error, .. }: Point, reason: &String| PointLeftOut {
            h,
            k,
            error,
            reason: reason.clone(),
        };
        self.left_out.iter().map(|(serving, reason)| plain(serving.point, reason)).collect()
    }
}

/// The cases of one scene, expected or recorded; of two records of one case the later counts.
pub(super) struct Cases<'a> {
    cases: BTreeMap<Key, Option<&'a CaseRecord>>,
}

impl<'a> Cases<'a> {
    pub(super) fn new(scene: &str, records: &'a [CaseRecord], expected: &[Key]) -> Self {
        let wanted = expected.iter().filter(|key| key.scene == scene);
        let found = records.iter().filter(|record| record.scene == scene);
        let mut cases: BTreeMap<Key, Option<&CaseRecord>> =
            wanted.map(|key| (key.clone(), None)).collect();
        cases.extend(found.map(|record| (record.key(), Some(record))));
        Self { cases }
    }

    /// The points of all converged cases that carry the norm.
    pub(super) fn points(&self, norm: &str) -> Vec<Point> {
        self.cases.values().flatten().filter_map(|record| point(record, norm)).collect()
    }

    /// Sorts the cases that a prediction rests on. Along h these are all n with the largest
    /// number of steps that was run on most n; along k all steps on the finest n that was run
    /// with most steps; jointly all. A broken case counts as a gap wherever it stands.
    pub(super) fn select(&self, prediction: &Prediction) -> Selection {
        let norm = &prediction.norm;
        let line = self.line(prediction);
        let mut selection = Selection::default();
        for (key, record) in &self.cases {
            let served = line.contains(&key);
            match found(*record, norm) {
                Found::Gap(gap) => selection.gaps.push(format!("{key} {gap}")),
                Found::NotMeasured if served => {
                    selection.gaps.push(format!("{key} has no row for {norm}"));
                }
                Found::NotMeasured => {}
                Found::Point(point) if served => {
                    let serving = Serving { key: key.clone(), point };
                    match exclusion(&serving, prediction) {
                        Some(reason) => selection.left_out.push((serving, reason)),
                        None => selection.used.push(serving),
                    }
                }
                Found::Point(_) => {}
            }
        }
        if self.cases.is_empty() {
            selection.gaps.push("the scene has no case".to_owned());
        }
        selection
    }

    /// The keys a prediction rests on. A mesh or time grid counts if one of its cases carries
    /// the norm: then all of them have to.
    fn line(&self, prediction: &Prediction) -> BTreeSet<&Key> {
        let keys = || self.cases.keys();
        match prediction.variable {
            Variable::H => {
                let measured = self.measured(&prediction.norm, |key| key.steps);
                let allowed = |s: &u32| inside(Some(*s), prediction.window_steps);
                let steps = keys().map(|key| key.steps).filter(|s| measured.contains(s));
                let fixed = most_frequent(steps.filter(allowed));
                keys().filter(|key| Some(key.steps) == fixed).collect()
            }
            Variable::K => {
                let measured = self.measured(&prediction.norm, |key| key.n);
                let allowed = |n: &Option<u32>| inside(*n, prediction.window_n);
                let cells = keys().map(|key| key.n).filter(|n| measured.contains(n));
                let fixed = most_frequent(cells.filter(allowed));
                keys().filter(|key| Some(key.n) == fixed).collect()
            }
            Variable::Joint | Variable::Path => keys().collect(),
        }
    }

    /// The levels at which some case carries the norm; all levels if no case does.
    fn measured<T: Ord>(&self, norm: &str, level: impl Fn(&Key) -> T) -> BTreeSet<T> {
        let carries =
            |record: &Option<&CaseRecord>| record.is_some_and(|record| record.norm(norm).is_some());
        let nowhere = !self.cases.values().any(carries);
        let carriers = self.cases.iter().filter(|(_, record)| nowhere || carries(record));
        carriers.map(|(key, _)| level(key)).collect()
    }
}

/// The most frequent value, the largest of several.
fn most_frequent<T: Ord>(values: impl Iterator<Item = T>) -> Option<T> {
    let mut counts: BTreeMap<T, usize> = BTreeMap::new();
    values.for_each(|value| *counts.entry(value).or_default() += 1);
    counts.into_iter().max_by_key(|(_, count)| *count).map(|(value, _)| value)
}

/// What is known of a case in one norm.
enum Found {
    Point(Point),
    NotMeasured,
    Gap(String),
}

fn found(record: Option<&CaseRecord>, norm: &str) -> Found {
    let Some(record) = record else {
        return Found::Gap("is missing".to_owned());
    };
    match &record.status {
        Status::Failed { reason } if reason.is_empty() => Found::Gap("failed".to_owned()),
        Status::Failed { reason } => Found::Gap(format!("failed: {reason}")),
        Status::Skipped => Found::Gap("was skipped".to_owned()),
        Status::Converged => match point(record, norm) {
            None => Found::NotMeasured,
            Some(_) if record.norm(norm).is_some_and(|entry| entry.error.is_none()) => {
                Found::Gap(format!("has no error in {norm}"))
            }
            Some(point) => match screen(&point) {
                Err(exclusion) if exclusion.is_broken() => {
                    Found::Gap(format!("in {norm}: {exclusion}"))
                }
                _ => Found::Point(point),
            },
        },
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

fn exclusion(serving: &Serving, prediction: &Prediction) -> Option<String> {
    let Serving { key, point } = serving;
    let needs = match prediction.variable {
        Variable::H | Variable::Path => &[Direction::Space][..],
        Variable::K => &[Direction::Time],
        Variable::Joint => &[Direction::Space, Direction::Time],
    };
    if !inside(key.n, prediction.window_n) || !inside(Some(key.steps), prediction.window_steps) {
        Some("outside window".to_owned())
    } else if !needs.iter().all(|direction| is_step(direction.step(point))) {
        Some("no step size".to_owned())
    } else {
        screen(point).err().map(|exclusion| exclusion.to_string())
    }
}

fn is_step(step: f64) -> bool {
    step.is_finite() && step > 0.0
}

pub(super) fn inside(value: Option<u32>, window: Option<[u32; 2]>) -> bool {
    match (value, window) {
        (Some(value), Some([first, last])) => first <= value && value <= last,
        _ => true,
    }
}

/// The points along one direction that a prediction in it would rest on, those below the floor
/// included: for pictures.
pub fn line_points(
    scene: &str,
    records: &[CaseRecord],
    norm: &str,
    variable: Variable,
) -> Vec<Point> {
    let prediction = Prediction {
        norm: norm.to_owned(),
        variable,
        order: 0.0,
        order_k: None,
        at_least: false,
        exact: false,
        why: String::new(),
        window_n: None,
        window_steps: None,
    };
    let selection = Cases::new(scene, records, &[]).select(&prediction);
    let left_out = selection.left_out.iter().map(|(serving, _)| serving);
    selection.used.iter().chain(left_out).map(|serving| serving.point).collect()
}

/// The cases that serve a prediction.
pub fn line_keys(scene: &str, records: &[CaseRecord], prediction: &Prediction) -> Vec<Key> {
    let selection = Cases::new(scene, records, &[]).select(prediction);
    selection.used.into_iter().map(|serving| serving.key).collect()
}

#[cfg(test)]
mod tests;
