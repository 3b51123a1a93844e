//! `sweep solve --estimate --target E`: the recommendation in words and in JSON.

use serde_json::{Value, json};

use super::super::target::Target;
use super::super::{CliError, megabytes, print_text};
use judge::fit::Interval;
use run::sweep::MemoryLimit;
use scene::Norm;
use scene::setup::Setup;
use studies::trade::estimate::{
    Advice, Advised, Companions, CostSource, Estimate, Goal, NoAdvice, advise,
};

#[derive(Debug, Clone, Copy)]
pub(in super::super) struct Wanted {
    target: Target,
    norm: Norm,
    limit: MemoryLimit,
}

impl Wanted {
    /// Reads `--target` and `--norm`; refuses a norm on Γ3 without Γ3.
    pub(in super::super) fn read(
        setup: &Setup,
        target: &str,
        norm: &str,
        limit: MemoryLimit,
    ) -> Result<Self, CliError> {
        let norm = super::super::target::norm(norm)?;
        if norm.needs_contact() && setup.model.boundary.is_none() {
            let name = norm.name();
            return Err(CliError::other(format!(
                "`{name}` is a norm on Γ3, and the scene has none"
            )));
        }
        Ok(Self { target: Target::read(target, norm)?, norm, limit })
    }

    pub(super) fn norm(&self) -> Norm {
        self.norm
    }

    /// The recommendation for a run with its companions.
    pub(super) fn advise(
        &self,
        setup: &Setup,
        run: [u32; 2],
        found: &Companions,
    ) -> Result<Advice, NoAdvice> {
        let target = self.target.of(found.size);
        let goal = Goal { setup, run, norm: self.norm, target, limit: self.limit };
        advise(&goal, found)
    }
}

/// Prints the recommendation with its estimate.
pub(super) fn print(advice: &Advice, found: &Companions, norm: Norm, estimate: &Estimate) {
    let part = match norm {
        Norm::VMax => {
            format!(" ({:.3} % of the largest |eps(u)|)", 100.0 * advice.target / found.size)
        }
        _ => String::new(),
    };
    print_text(&format!("\ntarget {:.4e} in {}{part}", advice.target, norm.name()));
    print_text(&format!("  recommended: {}", advised_words(&advice.choice)));
    match &advice.cautious {
        Ok(advised) => print_text(&format!("  cautious:    {}", advised_words(advised))),
        Err(reason) => print_text(&format!("  cautious:    {reason}")),
    }
    print_text(&format!("  orders counted on: {}", orders_words(estimate)));
    print_text(&format!("  seconds: {}", source_words(advice.source)));
    let [n, steps] = advice.check;
    print_text(&format!(
        "  to check: --n {n} --steps {steps} --estimate, a run whose own companions narrow the interval"
    ));
}

fn advised_words(advised: &Advised) -> String {
    let warning = advised.extrapolates().map_or(String::new(), |text| format!("\n    far: {text}"));
    format!(
        "n = {}, N = {} (h = {:.5}, k = {:.5}), predicted: error {:.3e} in {}, {:.3} CPU s, {}{warning}",
        advised.n,
        advised.steps,
        advised.h,
        advised.k,
        advised.error,
        bracketed(advised.interval),
        advised.seconds,
        megabytes(advised.bytes),
    )
}

fn orders_words(estimate: &Estimate) -> String {
    let of = |(name, part): (&str, &studies::trade::estimate::Part)| match part
        .order()
        .zip(part.counted_on())
    {
        Some((order, [counted, _])) => format!("{counted:.2} in {name} ({order:.2} observed)"),
        None => format!("none in {name}, which does not show"),
    };
    [("h", &estimate.space), ("k", &estimate.time)].map(of).join(", ")
}

fn source_words(source: CostSource) -> &'static str {
    match source {
        CostSource::Timed => "fitted to the CPU times of this run and its companions",
        CostSource::Counted => {
            "by counts, at the rates of another machine: a companion is too short to time"
        }
    }
}

/// The key `recommendation`.
pub(super) fn json(advice: &Result<Advice, NoAdvice>, found: &Companions, norm: Norm) -> Value {
    let advice = match advice {
        Ok(advice) => advice,
        Err(reason) => return json!({ "norm": norm.name(), "refused": reason.to_string() }),
    };
    let refused = advice.cautious.as_ref().err().map(ToString::to_string);
    json!({
        "norm": norm.name(),
        "target": advice.target,
        "relative": (norm == Norm::VMax && found.size > 0.0).then(|| advice.target / found.size),
        "choice": advised_json(&advice.choice),
        "cautious": advice.cautious.as_ref().ok().map(advised_json),
        "cautious_refused": refused,
        "seconds_from": match advice.source {
            CostSource::Timed => "times",
            CostSource::Counted => "counts",
        },
        "check": { "n": advice.check[0], "steps": advice.check[1] },
        "refused": null,
    })
}

fn advised_json(advised: &Advised) -> Value {
    json!({
        "n": advised.n,
        "steps": advised.steps,
        "h": advised.h,
        "k": advised.k,
        "error": advised.error,
        "interval": [advised.interval.lo, advised.interval.hi],
        "cpu_seconds": advised.seconds,
        "bytes": advised.bytes,
        "finer": advised.finer,
        "extrapolates": advised.extrapolates(),
    })
}

pub(super) fn bracketed(interval: Interval) -> String {
    format!("[{:.3e}, {:.3e}]", interval.lo, interval.hi)
}
