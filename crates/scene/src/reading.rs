//! One reading of a scene file: the text, its positions, its numbers, and the formulas compiled so far.

use std::ops::Range;

use serde::de::IgnoredAny;

use formula::{EvaluationPoint, Graph, Node, Scope, Variable};
use toml::de::DeTable;

use super::data::AXES;
use super::diagnostic::{Result, SceneError};
use super::heading::Hypothesis;
use super::source::Source;
use super::spans::Spans;
use super::values::Formula;

pub(super) struct Reading<'a> {
    pub source: &'a Source,
    pub spans: &'a Spans,
    pub table: &'a DeTable<'a>,
    pub violates: Vec<Hypothesis>,
    pub formulas: Graph,
    /// Named constants of `[exact.parameters]`, in file order.
    pub parameters: Vec<(String, Node)>,
}

impl<'a> Reading<'a> {
    pub(crate) fn new(source: &'a Source, spans: &'a Spans, table: &'a DeTable<'a>) -> Reading<'a> {
        Reading {
            source,
            spans,
            table,
            violates: Vec::new(),
            formulas: Graph::new(),
            parameters: Vec::new(),
        }
    }

    /// An error that underlines the value at `key`, or the part that should contain it.
    pub(crate) fn error(
        &self,
        key: &str,
        message: impl Into<String>,
        hint: impl Into<String>,
    ) -> SceneError {
        SceneError::at(self.source, self.spans.value(key), message, hint)
    }

    /// Refuses what [`Self::error`] underlines if it is at fault.
    pub(crate) fn refuse_if(
        &self,
        fault: bool,
        key: &str,
        message: impl ToString,
        hint: impl Into<String>,
    ) -> Result<()> {
        if fault { Err(self.error(key, message.to_string(), hint)) } else { Ok(()) }
    }

    /// An error that underlines the key itself.
    pub(crate) fn key_error(
        &self,
        key: &str,
        message: impl Into<String>,
        hint: impl Into<String>,
    ) -> SceneError {
        SceneError::at(self.source, self.spans.key(key), message, hint)
    }

    /// An error of something that is missing in the file.
    pub(crate) fn error_at_the_end(
        &self,
        message: impl Into<String>,
        hint: impl Into<String>,
    ) -> SceneError {
        let end = self.source.text.trim_end().len();
        SceneError::at(self.source, end..end, message, hint)
    }

    /// The number at a key.
    pub(crate) fn finite(&self, key: &str) -> Result<f64> {
        self.finite_number(key, self.required(key)?)
    }

    /// The number at a key, above 0.
    pub(crate) fn positive(&self, key: &str) -> Result<f64> {
        self.positive_number(key, self.required(key)?)
    }

    /// The number at a key, if it fits; `fault` says what is wrong with another one.
    pub(crate) fn number(
        &self,
        key: &str,
        fits: impl Fn(f64) -> bool,
        [fault, hint]: [&str; 2],
    ) -> Result<f64> {
        self.fitting(key, self.required(key)?, fits, [fault, hint])
    }

    /// The number at a key, between 0 and 1.
    pub(crate) fn share(&self, key: &str, hint: &str) -> Result<f64> {
        self.number(key, |share| share > 0.0 && share < 1.0, ["is not between 0 and 1", hint])
    }

    pub(crate) fn finite_number(&self, key: &str, value: f64) -> Result<f64> {
        self.fitting(key, value, f64::is_finite, ["is not finite", "give a finite number"])
    }

    pub(crate) fn positive_number(&self, key: &str, value: f64) -> Result<f64> {
        let value = self.finite_number(key, value)?;
        self.fitting(key, value, |value| value > 0.0, ["is not positive", "give a number above 0"])
    }

    fn fitting(
        &self,
        key: &str,
        value: f64,
        fits: impl Fn(f64) -> bool,
        [fault, hint]: [&str; 2],
    ) -> Result<f64> {
        let message = format!("`{}` = {value} {fault}", last(key));
        self.refuse_if(!fits(value), key, message, hint).map(|()| value)
    }

    /// A whole number from 1 to 2³¹ - 1.
    pub(crate) fn count(&self, key: &str) -> Result<u32> {
        let value: i64 = self.required(key)?;
        let count = i32::try_from(value).ok().filter(|&count| count >= 1);
        count.map(i32::unsigned_abs).ok_or_else(|| {
            let message = format!("{value} is not a whole number from 1 to 2147483647");
            self.error(key, message, "give a positive whole number")
        })
    }

    pub(crate) fn seed(&self, key: &str) -> Result<u64> {
        let value: i64 = self.required(key)?;
        let negative = format!("the seed {value} is negative");
        let hint = "give a whole number, 0 or above";
        u64::try_from(value).map_err(|_| self.error(key, negative, hint))
    }

    /// An increasing pair of counts, if it is there: the window of an order.
    pub(crate) fn window(&self, key: &str) -> Result<Option<[u32; 2]>> {
        match self.optional::<Vec<i64>>(key)?.as_deref() {
            None => Ok(None),
            Some([first, last]) if first <= last => {
                Ok(Some([self.count(&format!("{key}.0"))?, self.count(&format!("{key}.1"))?]))
            }
            Some(values) => {
                let hint = "a window is [from, to] with from <= to, as in [32, 128]";
                Err(self.error(key, format!("{values:?} is not a window"), hint))
            }
        }
    }

    /// Points of a graph; `form` names their two numbers.
    pub(crate) fn points(&self, key: &str, form: &str) -> Result<Vec<[f64; 2]>> {
        let count = self.required::<Vec<IgnoredAny>>(key)?.len();
        let hint = format!("a point is two finite numbers: {form}");
        (0..count).map(|index| self.pair(&format!("{key}.{index}"), &hint)).collect()
    }

    /// The given variables and the parameters of the scene.
    pub(crate) fn scope(&self, variables: &[Variable]) -> Scope {
        let mut scope = Scope::new(variables);
        for (name, node) in &self.parameters {
            scope.define(name, *node);
        }
        scope
    }

    /// The axes of the space, t, and the parameters of the scene.
    pub(crate) fn space_and_time(&self, dimension: usize) -> Scope {
        self.scope(&[&AXES[..dimension], &[Variable::T]].concat())
    }

    /// Compiles a formula; an error points into its text.
    pub(crate) fn compiled(&mut self, key: &str, formula: &Formula, scope: &Scope) -> Result<Node> {
        self.formulas.parse(&formula.0, scope).map_err(|error| {
            let hint = error.hint.unwrap_or_else(|| "correct the formula".to_string());
            let span = self.inside(key, &formula.0, error.span);
            SceneError::at(self.source, span, error.message, hint)
        })
    }

    /// The formula at a key.
    pub(crate) fn formula(&mut self, key: &str, scope: &Scope) -> Result<Node> {
        self.compiled(key, &self.required(key)?, scope)
    }

    /// The formulas of a list, one per component; there must be `dimension` of them.
    pub(crate) fn vector(
        &mut self,
        key: &str,
        dimension: usize,
        scope: &Scope,
    ) -> Result<Vec<Node>> {
        self.components(key, &self.required::<Vec<Formula>>(key)?, dimension, scope)
    }

    /// Compiles one formula per component; there must be `dimension` of them.
    pub(crate) fn components(
        &mut self,
        key: &str,
        formulas: &[Formula],
        dimension: usize,
        scope: &Scope,
    ) -> Result<Vec<Node>> {
        let (name, count) = (last(key), formulas.len());
        let message = format!("`{name}` has {count} components in dimension {dimension}");
        let hint = format!("give {dimension} formulas, one a component");
        self.refuse_if(count != dimension, key, message, hint)?;
        formulas
            .iter()
            .enumerate()
            .map(|(index, formula)| self.compiled(&format!("{key}.{index}"), formula, scope))
            .collect()
    }

    /// What `read` makes of a key, if it is there.
    pub(crate) fn if_given<T>(
        &mut self,
        key: &str,
        read: impl FnOnce(&mut Self, &str) -> Result<T>,
    ) -> Result<Option<T>> {
        if self.has(key) { read(self, key).map(Some) } else { Ok(None) }
    }

    /// Refuses a formula whose value at one of the points does not fit, with the message and the hint for the first.
    pub(crate) fn everywhere<H: Into<String>>(
        &self,
        (key, node): (&str, Node),
        points: impl IntoIterator<Item = EvaluationPoint>,
        fits: impl Fn(f64) -> bool,
        refusal: impl Fn(&EvaluationPoint, f64) -> (String, H),
    ) -> Result<()> {
        let values = points.into_iter().map(|at| (at, self.formulas.evaluate(node, &at)));
        match values.into_iter().find(|(_, value)| !fits(*value)) {
            None => Ok(()),
            Some((at, value)) => {
                let (message, hint) = refusal(&at, value);
                Err(self.error(key, message, hint))
            }
        }
    }

    /// Bytes of a part of a string value; the whole value if it contains escapes.
    fn inside(&self, key: &str, content: &str, part: Range<usize>) -> Range<usize> {
        let value = self.spans.value(key);
        match self.source.text[value.clone()].find(content) {
            Some(offset) if !content.is_empty() => {
                let start = value.start + offset;
                start + part.start..start + part.end
            }
            _ => value,
        }
    }
}

/// Places at evenly spaced times from 0 to the horizon.
pub(super) fn in_time(
    places: &[[f64; 3]],
    horizon: f64,
    intervals: u32,
) -> impl Iterator<Item = EvaluationPoint> {
    let at = |t| places.iter().map(move |&place| EvaluationPoint { t, ..place.into() });
    evenly(0.0, horizon, intervals).flat_map(at)
}

/// Evenly spaced numbers, both ends included.
pub(super) fn evenly(from: f64, to: f64, intervals: u32) -> impl Iterator<Item = f64> + Clone {
    (0..=intervals).map(move |i| from + (to - from) * f64::from(i) / f64::from(intervals))
}

pub(super) fn last(key: &str) -> &str {
    key.rsplit('.').find(|part| part.parse::<usize>().is_err()).unwrap_or(key)
}
