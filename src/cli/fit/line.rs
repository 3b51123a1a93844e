//! One direction of an error table.

use serde_json::json;

use super::asked::{Answer, Asked, gap_verdict, next, verdict_text};
use super::grid::Joint;
use super::wording::Part;
use files::counted;
use judge::fit::{
    Correction, Direction, Exclusion, FitError, Further, Interval, LARGEST_OTHER_SHARE,
    LineReading, NotIdentifiable, Point, Posterior, Sample, constant_under, plain, samples, screen,
};
use judge::table::Group;

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
pub(super) fn part(
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
    /// term.
    fn constant(&self, read: &LineReading) -> Option<(f64, Interval)> {
        let order = self.asked.order(self.direction).unwrap_or(read.posterior.order);
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
        let verdict = if verdict.is_empty() { verdict } else { format!("\n   {verdict}") };
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
