//! One direction of a table of values without an exact one.

use serde_json::{Value, json};

use super::asked::{Answer, Asked, gap_verdict, next, verdict_text};
use super::eoc;
use super::wording::Part;
use files::{counted, digits};
use judge::fit::{
    Direction, EcaHoekstra, FitError, Further, Posterior, Triple, ValueSample, eca_hoekstra,
    infer_values, value_samples,
};
use judge::table::Group;
use judge::verdict::Decision;

/// Below this order both published uncertainties are too small in more than one table in twenty.
const LOW_ORDER: f64 = 0.75;

/// All results for the values, coarse to fine.
struct Findings {
    samples: Vec<ValueSample>,
    last_three: Option<Triple>,
    order: Result<Posterior, FitError>,
    estimate: Option<EcaHoekstra>,
}

/// The extrapolated value in one direction; None if it is neither refined nor predicted.
pub(super) fn part(group: &Group, direction: Direction, asked: Asked) -> Option<Part> {
    let predicted = asked.order(direction);
    if !group.refined(direction) && predicted.is_none() {
        return None;
    }
    // Along a path the value depends on one step.
    let findings = value_samples(&eoc::line(group, direction), direction)
        .map(|samples| Findings::of(samples, asked));
    let name = direction.name();
    let answer = predicted.map(|order| {
        gap_verdict(group).unwrap_or_else(|| match &findings {
            Ok(findings) => findings.answer(name, asked, order),
            Err(error) => Answer::open(error),
        })
    });
    let tail = verdict_text(predicted, answer.as_ref());
    let found = findings.as_ref().ok();
    let order = found.and_then(|found| found.order.as_ref().ok());
    let otherwise = findings.as_ref().err().map_or(String::new(), FitError::to_string);
    let mut further = object(found, name, answer.as_ref());
    further["predicted"] = predicted.into();
    let text = match &findings {
        Ok(findings) => text(findings, name, &tail),
        Err(error) => format!("{name}: {error}"),
    };
    Some(asked.part((text, further), order, answer, otherwise))
}

impl Findings {
    fn of(samples: Vec<ValueSample>, asked: Asked) -> Self {
        let last_three = samples.last_chunk().map(|three| Triple::of(*three));
        // Diverging values have no limit.
        let diverges = matches!(last_three, Some(Triple::Diverging { .. }));
        let estimate = eca_hoekstra(&samples).filter(|_| !diverges);
        Self { last_three, order: infer_values(&samples, asked.noise), estimate, samples }
    }

    fn answer(&self, name: &str, asked: Asked, order: f64) -> Answer {
        let steps: Vec<f64> = self.samples.iter().map(|sample| sample.step).collect();
        let further = Further::after(name, &steps, &[], None);
        let open = |reason: String| Answer {
            next: further.steps.clone(),
            ..Answer::open(format!("{reason}: {}", further.text))
        };
        match (self.last_three, &self.order) {
            (Some(Triple::Diverging { order }), _) => Answer::of(
                Decision::Fail,
                format!("the last three values diverge, order {order:.2}"),
            ),
            (Some(Triple::Oscillating { .. }), _) => open("the last three values oscillate".into()),
            (Some(Triple::Stationary), _) => {
                Answer::open("the last two values are equal: run coarser ones")
            }
            (_, Ok(posterior)) => asked.answer(posterior, order, further),
            (_, Err(FitError::TooFew { .. })) => {
                let found = counted(self.samples.len(), "value");
                open(format!("{found}, the interval of an order needs 4 that differ"))
            }
            (_, Err(error)) => open(error.to_string()),
        }
    }

    /// A warning where the published uncertainties are unreliable.
    fn caution(&self) -> Option<String> {
        let differences = self.samples.windows(2).map(|pair| pair[0].value - pair[1].value);
        let differences: Vec<f64> = differences.collect();
        let turns = differences.windows(2).any(|pair| pair[0] * pair[1] < 0.0);
        let order = self.last_three.and_then(Triple::order);
        match order {
            _ if turns => Some(
                "the values rise and fall: extrapolation, GCI and Eça-Hoekstra miss their 95 % there".into(),
            ),
            Some(order) if order < LOW_ORDER => Some(format!(
                "order {order:.2}: below {LOW_ORDER} GCI and Eça-Hoekstra miss their 95 %"
            )),
            _ => None,
        }
    }
}

fn text(findings: &Findings, name: &str, verdict: &str) -> String {
    let mut lines = Vec::new();
    let grids = counted(findings.samples.len(), "value");
    lines.push(match findings.last_three {
        None => format!("{name}: {grids}, an extrapolation needs 3"),
        Some(Triple::Converging { order, limit, gci }) => format!(
            "{name}: extrapolated value {}, order {order:.3} of the last three, GCI {gci:.2e} on the finest",
            digits(limit, 11)
        ),
        Some(Triple::Oscillating { half_range }) => format!(
            "{name}: the last three values oscillate, no extrapolation; half of their range {half_range:.2e}"
        ),
        Some(Triple::Diverging { order }) => {
            format!("{name}: the last three values diverge, order {order:.3}: no extrapolation")
        }
        Some(Triple::Stationary) => format!("{name}: the last two values are equal up to rounding"),
    });
    if let Ok(found) = &findings.order {
        lines.push(format!("   order {:.3} in {} over {grids}", found.order, found.interval));
    }
    lines.extend(findings.estimate.map(|found| {
        format!(
            "   Eça-Hoekstra: {}, uncertainty {:.2e} on the finest, expansion {}, factor {}",
            digits(found.fit.limit, 11),
            found.uncertainty,
            String::from(found.fit.expansion),
            found.safety
        )
    }));
    lines.extend(findings.caution().map(|words| format!("   caution: {words}")));
    if !verdict.is_empty() {
        lines.push(format!("   {verdict}"));
    }
    lines.join("\n")
}

fn object(found: Option<&Findings>, name: &str, answer: Option<&Answer>) -> Value {
    let triple = found.and_then(|found| found.last_three);
    let (behaviour, limit, gci, half_range) = match triple {
        Some(Triple::Converging { limit, gci, .. }) => {
            (Some("monotone"), Some(limit), Some(gci), None)
        }
        Some(Triple::Oscillating { half_range }) => {
            (Some("oscillating"), None, None, Some(half_range))
        }
        Some(Triple::Diverging { .. }) => (Some("divergent"), None, None, None),
        Some(Triple::Stationary) => (Some("stationary"), None, None, None),
        None => (None, None, None, None),
    };
    json!({
        "variable": name,
        "behaviour": behaviour,
        "finest": found.and_then(|found| found.samples.last()).map(|sample| sample.value),
        "extrapolated": limit,
        "order_of_last_three": triple.and_then(Triple::order),
        "gci": gci,
        "half_range": half_range,
        "caution": found.and_then(Findings::caution),
        "eca_hoekstra": found.and_then(|found| found.estimate),
        "next": next(answer),
        "points_used": found.map(|found| {
            let plain = |sample: &ValueSample| json!({name: sample.step, "value": sample.value});
            found.samples.iter().map(plain).collect::<Vec<Value>>()
        }),
    })
}
