//! The parts of an answer to a table: one direction, a path, a grid, values. First what a caller claims and knows of its
//! errors.

use std::fmt::Display;

use super::eoc;
use files::{counted, digits};
use judge::fit::{
    Claim, Correction, Direction, Exclusion, FitError, FittedValue, Further, GridPosterior,
    Interval, JointFit, JointFits, Known, LARGEST_OTHER_SHARE, LineReading, NotIdentifiable, Point,
    Posterior, RefinementPath, Sample, Triple, ValueSample, constant_under, fit_constants,
    infer_grid, infer_values, joint_fits, plain, same_level, samples, screen, student_quantile,
    value_samples,
};
use judge::table::Group;
use judge::verdict::Decision;
use serde_json::{Value, json};

/// Predicted orders and their meaning.
#[derive(Debug, Clone, Copy)]
pub(super) struct Asked {
    pub(super) p: Option<f64>,
    pub(super) q: Option<f64>,
    /// What is claimed of the order in h, whatever it is, and of that in k.
    pub(super) claim: Claim,
    pub(super) in_time: Claim,
    pub(super) noise: Option<f64>,
    pub(super) reference: Option<f64>,
}

/// The judgement of an order, before it is printed.
pub(super) struct Answer {
    pub(super) decision: Decision,
    pub(super) reason: String,
    /// Probability that the order is as predicted.
    pub(super) probability: Option<f64>,
    /// Steps that would help an open decision.
    pub(super) next: Vec<f64>,
}

impl Answer {
    pub(super) fn of(decision: Decision, reason: String) -> Self {
        Self { decision, reason, probability: None, next: Vec::new() }
    }

    pub(super) fn open(why: impl Display) -> Self {
        Self::of(Decision::Unresolved, why.to_string())
    }
}

impl Asked {
    pub(super) fn order(self, direction: Direction) -> Option<f64> {
        match direction {
            Direction::Space => self.p,
            Direction::Time => self.q,
        }
    }

    pub(super) fn known(self) -> Known {
        Known {
            noise: self.noise,
            log: self.claim.log,
            reference: self.reference,
            differences: false,
        }
    }

    /// With the claim of one direction.
    pub(super) fn along(self, direction: Direction) -> Self {
        match direction {
            Direction::Space => self,
            Direction::Time => Self { claim: self.in_time, ..self },
        }
    }

    /// Judges an order; `further` is one more level.
    pub(super) fn answer(self, posterior: &Posterior, order: f64, further: Further) -> Answer {
        let ruling = posterior.decide(&Claim { order, ..self.claim });
        let left_out = posterior.left_out_in_words();
        let (help, next) = match posterior.help(&ruling, further) {
            Some(Further { steps, text }) => (format!(": {text}"), steps),
            None => (String::new(), Vec::new()),
        };
        let reason = format!("{}{left_out}{help}", ruling.reason);
        Answer { decision: ruling.decision, reason, probability: Some(ruling.probability), next }
    }

    /// The result, `json` with the entries of what was asked, found and answered, and the reason why nothing was.
    pub(super) fn part(
        self,
        (text, mut json): (String, Value),
        found: Option<&Posterior>,
        answer: Option<Answer>,
        otherwise: impl Display,
    ) -> Part {
        let decision = answer.as_ref().map(|answer| answer.decision);
        let probability = answer.as_ref().and_then(|answer| answer.probability);
        json["at_least"] = json!(self.claim.at_least);
        json["exact"] = json!(self.claim.exact);
        json["tolerance"] = json!(self.claim.tolerance);
        json["order"] = json!(found.map(|found| found.order));
        json["observed"] = json["order"].clone();
        json["interval"] = json!(found.map(|found| found.interval));
        json["verdict"] = json!(decision);
        json["probability"] = json!(probability);
        json["reason"] =
            answer.map_or_else(|| otherwise.to_string(), |answer| answer.reason).into();
        Part { text, json, decision }
    }
}

/// The steps that would help, for JSON.
pub(super) fn next(answer: Option<&Answer>) -> &[f64] {
    answer.map_or(&[], |answer| &answer.next)
}

/// The verdict for gaps: as in a sweep, a missing case is a failure.
pub(super) fn gap_verdict(group: &Group) -> Option<Answer> {
    group.gaps_in_words().map(|gaps| Answer::of(Decision::Fail, gaps))
}

/// `; predicted 1: pass, 1 lies in …`, to end a line.
pub(super) fn verdict_text(predicted: Option<impl Display>, answer: Option<&Answer>) -> String {
    match (predicted, answer) {
        (Some(order), Some(Answer { decision, reason, .. })) => {
            format!("predicted {order}: {}, {reason}", decision.name())
        }
        (None, Some(answer)) => answer.reason.clone(),
        _ => String::new(),
    }
}

// A result in words, and the words that results share.

/// The result for one table in one direction.
pub(super) struct Part {
    pub(super) text: String,
    pub(super) json: serde_json::Value,
    /// Set if an order is predicted.
    pub(super) decision: Option<Decision>,
}

// One direction of an error table.

/// A line of the table, and its result.
struct Line<'a> {
    direction: Direction,
    points: Vec<Point>,
    /// Points outside the window.
    outside: &'a [Point],
    read: Result<LineReading, FitError>,
    asked: Asked,
}

/// The order in one direction; None if it is neither refined nor predicted.
pub(super) fn line_part(
    group: &Group,
    direction: Direction,
    asked: Asked,
    joint: Option<&Result<Joint, NotIdentifiable>>,
    outside: &[Point],
) -> Option<Part> {
    if !group.refined(direction) && asked.order(direction).is_none() {
        return None;
    }
    let measured = group.line(direction);
    let read = LineReading::of(&measured, direction, &asked.known());
    let points = measured.into_iter().map(|(point, _)| point).collect();
    let line = Line { direction, points, outside, read, asked };
    let answer = asked.order(direction).map(|order| {
        let gaps = gap_verdict(group);
        gaps.or_else(|| line.bent(order, joint)).unwrap_or_else(|| line.answer(order))
    });
    let said = (line.text(answer.as_ref()), line.json(answer.as_ref()));
    let otherwise = line.read.as_ref().err().map_or(String::new(), FitError::to_string);
    let found = line.read.as_ref().ok().map(|read| &read.posterior);
    Some(asked.part(said, found, answer, otherwise))
}

impl Line<'_> {
    fn answer(&self, order: f64) -> Answer {
        let further = |samples: &[Sample]| {
            let serving: Vec<f64> = samples.iter().map(|sample| sample.step).collect();
            let lost = self.points.iter().filter(|point| screen(point).is_err());
            let lost: Vec<f64> = lost.map(|point| self.direction.step(point)).collect();
            Further::after(self.direction.name(), &serving, &lost, self.asked.reference)
        };
        match &self.read {
            Ok(LineReading { samples, posterior }) => {
                self.asked.answer(posterior, order, further(samples))
            }
            Err(error @ FitError::TooFew { .. }) => {
                let samples = samples(&self.points, self.direction).unwrap_or_default();
                let Further { steps: next, text } = further(&samples);
                Answer { next, ..Answer::open(format!("{error}{}: {text}", self.below_floor())) }
            }
            Err(error) => Answer::open(format!("{error}{}", self.below_floor())),
        }
    }

    /// If the term of the other direction bends this line, the grid decides; if the grid cannot see this direction's
    /// term, nothing does.
    fn bent(&self, order: f64, joint: Option<&Result<Joint, NotIdentifiable>>) -> Option<Answer> {
        let joint = match joint? {
            Ok(joint) => joint,
            Err(refused) if refused.hidden == Some(self.direction) => {
                return Some(Answer::open(refused));
            }
            Err(_) => return None,
        };
        let other = self.direction.other();
        let used = self.points.iter().filter(|point| screen(point).is_ok());
        let share = used.map(|point| joint.fits.best.share(other, point)).fold(0.0, f64::max);
        (share > LARGEST_OTHER_SHARE).then(|| {
            let answer = joint.answer(self.direction, order, self.asked);
            let percent = 100.0 * share;
            let reason = format!(
                "the term in {} is up to {percent:.0} % of the error on this line, so the grid is judged: {}",
                other.name(),
                answer.reason
            );
            Answer { reason, ..answer }
        })
    }

    /// `; 2 points below floor; 1 point exactly 0`.
    fn below_floor(&self) -> String {
        let lost = self.points.iter().filter_map(|point| screen(point).err());
        let (zeros, low): (Vec<Exclusion>, _) = lost.partition(|why| *why == Exclusion::Zero);
        let words = |lost: Vec<Exclusion>, what: &str| match lost.len() {
            0 => String::new(),
            lost => format!("; {} {what}", counted(lost, "point")),
        };
        words(low, "below floor") + &words(zeros, "exactly 0")
    }

    /// The constant for the predicted or the found order; the scheme is unknown, so the next power is taken as the next
    /// term. None for an order that the table excludes, and against a run, whose share it would hold.
    fn constant(&self, read: &LineReading) -> Option<(f64, Interval)> {
        let order = self.asked.order(self.direction).unwrap_or(read.posterior.order);
        let against_a_run = self.asked.reference.is_some_and(|step| step > 0.0);
        if against_a_run || !read.posterior.interval.contains(order) {
            return None;
        }
        let factor = |step: f64| step.ln().abs().powf(self.asked.claim.log);
        let divided = read.samples.iter().map(|s| Sample { error: s.error / factor(s.step), ..*s });
        constant_under(order, &divided.collect::<Vec<_>>(), Correction::Linear)
    }

    fn text(&self, answer: Option<&Answer>) -> String {
        let name = self.direction.name();
        let verdict = verdict_text(self.asked.order(self.direction), answer);
        let read = match &self.read {
            Ok(read) => read,
            Err(_) if !verdict.is_empty() => return format!("{name}: {verdict}"),
            Err(error) => return format!("{name}: {error}{}", self.below_floor()),
        };
        let Posterior { order, interval, .. } = &read.posterior;
        let constant = self.constant(read).map_or(String::new(), |(value, Interval { lo, hi })| {
            format!(", constant {} in [{}, {}]", plain(value), plain(lo), plain(hi))
        });
        // A verdict says it with its reason.
        let verdict = match verdict.is_empty() {
            true => read.posterior.left_out_in_words(),
            false => format!("\n   {verdict}"),
        };
        format!("{name}: order {order:.3} in {interval}{constant}{}{verdict}", self.below_floor())
    }

    fn json(&self, answer: Option<&Answer>) -> serde_json::Value {
        let found = self.read.as_ref().ok();
        let posterior = found.map(|read| &read.posterior);
        let constant = found.and_then(|read| self.constant(read));
        let left_out = |(point, reason): (&Point, String)| {
            let mut left_out = json!(point);
            left_out["reason"] = reason.into();
            left_out
        };
        let serving = self.points.iter().filter(|point| screen(point).is_ok());
        let lost = self.points.iter().filter_map(|p| Some((p, screen(p).err()?.to_string())));
        let outside = self.outside.iter().map(|point| (point, "outside of the window".into()));
        json!({
            "variable": self.direction.name(),
            "local_slopes": posterior.map(|fitted| &fitted.slopes),
            "coarse_left_out": posterior.map(|fitted| fitted.coarse_left_out),
            "floor_from": posterior.and_then(|fitted| fitted.floor_from),
            "log": self.asked.claim.log,
            "reference": self.asked.reference,
            "constant": constant.map(|(value, _)| value),
            "constant_interval": constant.map(|(_, interval)| interval),
            "predicted": self.asked.order(self.direction),
            "next": next(answer),
            "points_used": serving.collect::<Vec<&Point>>(),
            "points_left_out": lost.chain(outside).map(left_out).collect::<Vec<_>>(),
        })
    }
}

// An error table refined along a path k = c h^s.

/// The order in h along the path, min(p, s q), and what it implies for p and q.
pub(super) fn path_part(group: &Group, path: RefinementPath, asked: Asked) -> Part {
    let measured = group.measurements();
    let read = LineReading::of(&measured, Direction::Space, &asked.known());
    let order = along(path, asked);
    let answer = order.map(|order| {
        gap_verdict(group).unwrap_or_else(|| match &read {
            Ok(read) => decide(read, path, asked, order),
            Err(error) => Answer::open(error),
        })
    });
    let RefinementPath { exponent, constant } = path;
    let found = read.as_ref().ok().map(|read| &read.posterior);
    let answered = answer.as_ref();
    let further = json!({
        "variable": "path",
        "exponent": exponent,
        "path_constant": constant,
        "local_slopes": found.map(|fitted| &fitted.slopes),
        "predicted": asked.p,
        "predicted_k": asked.q,
        "next": next(answered),
    });
    let otherwise = format!("along the path the order in h is min(p, {exponent:.2} q)");
    let head = format!("path k = {} h^{exponent:.2}:", digits(constant, 4));
    let tail = verdict_text(order.map(|order| format!("order {order} along it")), answered);
    let text = match &read {
        Ok(LineReading { posterior: Posterior { order, interval, .. }, .. }) => {
            let tail = match tail.is_empty() {
                true => format!("; it is min(p, {exponent:.2} q)"),
                false => format!("\n   {tail}"),
            };
            format!("{head} order {order:.3} in {interval} in h{tail}")
        }
        Err(_) if !tail.is_empty() => format!("{head} {tail}"),
        Err(error) => format!("{head} {error}"),
    };
    asked.part((text, further), found, answer, otherwise)
}

/// The predicted order along the path, without the rounding of its exponent; a missing p or q counts as the faster
/// term.
fn along(path: RefinementPath, asked: Asked) -> Option<f64> {
    let order = match (asked.p, asked.q) {
        (Some(p), Some(q)) => path.order(p, q),
        (Some(p), None) => p,
        (None, Some(q)) => path.exponent * q,
        (None, None) => return None,
    };
    Some((1e6 * order).round() / 1e6)
}

fn decide(read: &LineReading, path: RefinementPath, asked: Asked, order: f64) -> Answer {
    let steps: Vec<f64> = read.samples.iter().map(|sample| sample.step).collect();
    let answer =
        asked.answer(&read.posterior, order, Further::after("h", &steps, &[], asked.reference));
    let (reason, helps) = (answer.reason.clone(), !answer.next.is_empty());
    let and = |words: &str| Answer { reason: format!("{reason}{words}"), ..answer };
    match (answer.decision, asked.p, asked.q) {
        (Decision::Pass, Some(p), Some(q)) => {
            let balanced = format!("run k proportional to h^{:.2}, or the grid", p / q);
            let hidden = |other: f64, name: &str, least: f64| {
                Answer::open(format!(
                    "{reason}, but the path cannot tell order {other} in {name} from {least:.2}: {balanced}"
                ))
            };
            match path.tests(p, q) {
                [true, true] => and(&format!(", so the orders are at least {p} in h and {q} in k")),
                [true, false] => hidden(q, "k", order / path.exponent),
                _ => hidden(p, "h", order),
            }
        }
        (Decision::Pass, Some(p), None) => and(&format!(", so the order is at least {p} in h")),
        (Decision::Pass, None, Some(q)) => and(&format!(", so the order is at least {q} in k")),
        (Decision::Fail, Some(_), None) => {
            Answer::open(format!("{reason}, in h or in k: run one k with several h"))
        }
        (Decision::Fail, None, Some(_)) => {
            Answer::open(format!("{reason}, in h or in k: run one h with several k"))
        }
        (Decision::Unresolved, ..) if helps => and(" on the path"),
        _ => and(""),
    }
}

// Both orders of an error table with a grid of h and k.

/// Residuals of logarithms below this are rounding.
const ROUNDING: f64 = 1e-12;

/// Both orders of a grid, and its constants by least squares.
pub(super) struct Joint {
    pub(super) fits: JointFits,
    posterior: GridPosterior,
    points: Vec<Point>,
}

impl Joint {
    /// # Errors
    /// Why the grid does not determine two orders.
    pub(super) fn of(group: &Group, asked: Asked) -> Result<Self, NotIdentifiable> {
        let measured = group.measurements();
        let points: Vec<Point> = measured.iter().map(|(point, _)| *point).collect();
        // One noise for all points: the root mean square.
        let sigmas: Option<Vec<f64>> = measured.iter().map(|(_, sigma)| *sigma).collect();
        let mean =
            |all: Vec<f64>| (all.iter().map(|s| s * s).sum::<f64>() / all.len() as f64).sqrt();
        let noise = asked.noise.or(sigmas.map(mean));
        let fits = joint_fits(&points, false)?;
        Ok(Self { fits, posterior: infer_grid(&points, noise)?, points })
    }

    /// The answer for one of the orders.
    pub(super) fn answer(&self, direction: Direction, order: f64, asked: Asked) -> Answer {
        let posterior = match direction {
            Direction::Space => &self.posterior.order_h,
            Direction::Time => &self.posterior.order_k,
        };
        let mut steps: Vec<f64> = self.points.iter().map(|point| direction.step(point)).collect();
        steps.sort_by(|a, b| b.total_cmp(a));
        steps.dedup_by(|a, b| same_level(*a, *b));
        let further = Further::after(direction.name(), &steps, &[], asked.reference);
        asked.along(direction).answer(posterior, order, further)
    }
}

/// The orders, and the joint fits of both models, without and with a floor term.
pub(super) fn grid_part(
    group: &Group,
    joint: &Result<Joint, NotIdentifiable>,
    asked: Asked,
) -> Part {
    let orders = asked.p.zip(asked.q);
    let answer = orders.map(|orders| {
        gap_verdict(group).unwrap_or_else(|| match joint {
            Ok(joint) => grid_both(joint, orders, asked),
            Err(refused) => Answer::open(refused),
        })
    });
    let (found, points) = (joint.as_ref().ok(), group.points());
    let floor = found.and_then(|_| joint_fits(&points, true).ok());
    let constants = found
        .zip(orders)
        .and_then(|(joint, orders)| fit_constants(&points, joint.fits.best.model, orders).ok());
    let (fits, time) =
        (found.map(|joint| &joint.fits), found.map(|joint| &joint.posterior.order_k));
    let all = fits.into_iter().chain(floor.as_ref());
    let all = all.flat_map(|fits| [Some(&fits.best), fits.other.as_ref()]).flatten();
    let constant = |c: FittedValue, order: Option<f64>| json!({"value": c.value, "interval": c.interval, "order": order});
    let json = json!({
        "variable": "joint",
        "observed_k": time.map(|posterior| posterior.order),
        "interval_k": time.map(|posterior| posterior.interval),
        "models": all.map(model).collect::<Vec<Value>>(),
        "better": fits.map(|fits| fits.best.model.name()),
        "constants": constants.map(|[h, k]| json!({
            "C_h": constant(h, asked.p), "C_k": constant(k, asked.q)
        })),
        "predicted": asked.p,
        "predicted_k": asked.q,
    });
    let head = verdict_text(orders.map(|(p, q)| format!("{p}, {q}")), answer.as_ref());
    let text = match joint {
        Err(_) if !head.is_empty() => format!("joint: {head}"),
        Err(refused) => format!("joint: {refused}"),
        Ok(joint) => grid_text(joint, floor.as_ref(), constants, &head),
    };
    let otherwise = joint.as_ref().err().map_or(String::new(), NotIdentifiable::to_string);
    let space = found.map(|joint| &joint.posterior.order_h);
    asked.part((text, json), space, answer, otherwise)
}

/// Passes if both orders pass, fails if one fails.
fn grid_both(joint: &Joint, (p, q): (f64, f64), asked: Asked) -> Answer {
    let space = joint.answer(Direction::Space, p, asked);
    let time = joint.answer(Direction::Time, q, asked);
    let probability = space.probability.zip(time.probability).map(|(a, b)| a.min(b));
    Answer {
        decision: space.decision.and(time.decision),
        reason: format!("in h: {}; in k: {}", space.reason, time.reason),
        probability,
        next: Vec::new(),
    }
}

fn grid_text(
    joint: &Joint,
    floor: Option<&JointFits>,
    constants: Option<[FittedValue; 2]>,
    verdict: &str,
) -> String {
    let GridPosterior { order_h, order_k } = &joint.posterior;
    let best = &joint.fits.best;
    let mut lines = vec![format!(
        "joint: order {:.3} in {} in h, {:.3} in {} in k",
        order_h.order, order_h.interval, order_k.order, order_k.interval
    )];
    lines.extend((!verdict.is_empty()).then(|| format!("   {verdict}")));
    let models = [Some(best), joint.fits.other.as_ref()].into_iter().flatten();
    lines.extend(models.enumerate().map(|(place, fit)| {
        let better = if place == 0 { " (better)" } else { "" };
        format!(
            "   {}{better}: {:.4e} h^{:.3}, {:.4e} k^{:.3}, residual {:.1e}",
            fit.model.name(),
            fit.constant_h,
            fit.order_h.value,
            fit.constant_k,
            fit.order_k.value,
            fit.residual_norm
        )
    }));
    if let Some([h, k]) = constants {
        let range = |c: FittedValue| {
            format!("{:.4e} in [{:.4e}, {:.4e}]", c.value, c.interval.lo, c.interval.hi)
        };
        lines.push(format!("   under the predicted orders: C_h {}, C_k {}", range(h), range(k)));
    }
    lines.extend(floor.and_then(|floor| floor_line(best, &floor.best, joint.points.len())));
    lines.join("\n")
}

/// The effect of a floor term, if it reduces the residual significantly: F of one more parameter at 95 % is the square
/// of Student's quantile. Bends of the error terms reduce it as well, so this is only a hint at a floor.
fn floor_line(plain: &JointFit, with: &JointFit, points: usize) -> Option<String> {
    let floor = with.floor?;
    // An exact table leaves nothing to explain.
    if plain.residual_norm < ROUNDING {
        return None;
    }
    let freedom = points.checked_sub(5)?;
    let (before, after) = (plain.residual_norm.powi(2), with.residual_norm.powi(2));
    let gain = (before - after) * freedom as f64;
    let better = gain > student_quantile(freedom)?.powi(2) * after;
    let word = if better { "better" } else { "no better" };
    Some(format!(
        "   with a floor term ({word}): {}, order {:.3} in h, {:.3} in k, floor {floor:.2e}, residual {:.1e}",
        with.model.name(),
        with.order_h.value,
        with.order_k.value,
        with.residual_norm
    ))
}

fn model(fit: &JointFit) -> Value {
    json!({
        "model": fit.model.name(),
        "order_h": fit.order_h.value,
        "interval_h": fit.order_h.interval,
        "order_k": fit.order_k.value,
        "interval_k": fit.order_k.interval,
        "C_h": fit.constant_h,
        "C_k": fit.constant_k,
        "floor": fit.floor,
        "residual": fit.residual_norm,
    })
}

// One direction of a table of values without an exact one.

/// Below this order the index is too small in more than one table in twenty.
const LOW_ORDER: f64 = 0.75;

/// All results for the values, coarse to fine.
struct Findings {
    samples: Vec<ValueSample>,
    last_three: Option<Triple>,
    order: Result<Posterior, FitError>,
}

/// The extrapolated value in one direction; None if it is neither refined nor predicted.
pub(super) fn values_part(group: &Group, direction: Direction, asked: Asked) -> Option<Part> {
    let predicted = asked.order(direction);
    if !group.refined(direction) && predicted.is_none() {
        return None;
    }
    // Along a path the value depends on one step.
    let line = eoc::line(group, direction);
    let other = direction.other();
    let held =
        line.last().filter(|_| group.refined(other) && judge::fit::path(&group.points()).is_none());
    let held = held.map_or(String::new(), |point| {
        format!(" at {} = {}", other.name(), plain(other.step(point)))
    });
    let findings = value_samples(&line, direction).map(|samples| Findings::of(samples, asked));
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
    let mut further = values_object(found, name, answer.as_ref());
    further["predicted"] = predicted.into();
    let text = match &findings {
        Ok(findings) => values_text(findings, &format!("{name}{held}"), &tail),
        Err(error) => format!("{name}: {error}"),
    };
    Some(asked.part((text, further), order, answer, otherwise))
}

impl Findings {
    fn of(samples: Vec<ValueSample>, asked: Asked) -> Self {
        let last_three = samples.last_chunk().map(|three| Triple::of(*three));
        Self { last_three, order: infer_values(&samples, asked.noise), samples }
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
                open(format!("{found}, but the interval of an order needs 4 different ones"))
            }
            (_, Err(error)) => open(error.to_string()),
        }
    }

    /// A warning where the index is unreliable.
    fn caution(&self) -> Option<String> {
        let differences = self.samples.windows(2).map(|pair| pair[0].value - pair[1].value);
        let differences: Vec<f64> = differences.collect();
        let turns = differences.windows(2).any(|pair| pair[0] * pair[1] < 0.0);
        let order = self.last_three.and_then(Triple::order);
        match order {
            _ if turns => {
                Some("the values rise and fall: extrapolation and GCI miss their 95 % there".into())
            }
            Some(order) if order < LOW_ORDER => {
                Some(format!("order {order:.2}: below {LOW_ORDER} GCI misses its 95 %"))
            }
            _ => None,
        }
    }
}

fn values_text(findings: &Findings, name: &str, verdict: &str) -> String {
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
    lines.extend(findings.caution().map(|words| format!("   caution: {words}")));
    if !verdict.is_empty() {
        lines.push(format!("   {verdict}"));
    }
    lines.join("\n")
}

fn values_object(found: Option<&Findings>, name: &str, answer: Option<&Answer>) -> Value {
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
        "next": next(answer),
        "points_used": found.map(|found| {
            let plain = |sample: &ValueSample| json!({name: sample.step, "value": sample.value});
            found.samples.iter().map(plain).collect::<Vec<Value>>()
        }),
    })
}
