//! One axis: positions of values, and ticks.

use crate::canvas::span;

/// How an axis is divided.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Scale {
    /// Equal steps of 1, 2 or 5 times a power of ten.
    #[default]
    Linear,
    /// Logarithmic, ticks at powers of ten, and at 2 and 5 if there is room.
    Log,
    /// Logarithmic, ticks at the data: step sizes, written 1/n where possible.
    Steps,
}

/// A tick: a short stroke, or with a label a line of the grid.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Tick {
    pub(super) at: f64,
    pub(super) label: Option<String>,
}

#[derive(Debug)]
pub(super) struct Ruler {
    scale: Scale,
    /// Ends; logarithms to base ten on a logarithmic axis.
    ends: [f64; 2],
    pub(super) ticks: Vec<Tick>,
}

/// Length of an axis and the distance that labels need, in canvas units.
#[derive(Debug, Clone, Copy)]
pub(super) struct Room {
    pub(super) length: f64,
    pub(super) label: f64,
}

/// Free share of the range at either end.
const MARGIN: f64 = 0.03;

const DIGITS: [i64; 3] = [1, 2, 5];

impl Scale {
    /// Whether a value can be placed.
    pub(super) fn holds(self, value: f64) -> bool {
        value.is_finite() && (self == Scale::Linear || value > 0.0)
    }

    fn measure(self, value: f64) -> f64 {
        if self == Scale::Linear { value } else { value.log10() }
    }
}

impl Ruler {
    /// An axis that shows all of `data` and `marks` that can be placed; None without data.
    pub(super) fn new(scale: Scale, data: &[f64], marks: &[f64], room: Room) -> Option<Self> {
        let mut levels: Vec<f64> = data.iter().copied().filter(|v| scale.holds(*v)).collect();
        levels.sort_by(f64::total_cmp);
        levels.dedup();
        levels.first()?;
        let all = levels.iter().chain(marks.iter().filter(|v| scale.holds(**v)));
        let measured = all.map(|v| scale.measure(*v));
        let range = span(measured);
        let (ends, mut ticks) = match scale {
            Scale::Linear => linear(range, room),
            Scale::Log => logarithmic(range, room),
            Scale::Steps => steps(range, &levels, room),
        };
        ticks.retain(|tick| scale.holds(tick.at));
        Some(Self { scale, ends, ticks })
    }

    /// Share of the axis below a value; outside of 0 to 1 beyond the ends.
    pub(super) fn share(&self, value: f64) -> f64 {
        (self.scale.measure(value) - self.ends[0]) / (self.ends[1] - self.ends[0])
    }

    /// Share of the axis per decade, if logarithmic.
    pub(super) fn decade(&self) -> Option<f64> {
        (self.scale != Scale::Linear).then(|| 1.0 / (self.ends[1] - self.ends[0]))
    }
}

fn linear((lo, hi): (f64, f64), room: Room) -> ([f64; 2], Vec<Tick>) {
    // A single value is centred on an axis of its size.
    let half = if hi > lo { 0.0 } else { 0.5 * lo.abs().max(f64::MIN_POSITIVE) };
    let (lo, hi) = (lo - half, hi + half);
    let most = (room.length / room.label).floor().max(2.0);
    let digits = |exponent: i32| DIGITS.map(|digit| digit as f64 * 10f64.powi(exponent));
    let exponent = ((hi - lo) / most).log10().floor() as i32;
    let sizes = digits(exponent).into_iter().chain(digits(exponent + 1));
    let step = sizes.into_iter().find(|size| (hi - lo) / size <= most).unwrap_or(hi - lo);
    let (first, last) = ((lo / step + 1e-9).floor(), (hi / step - 1e-9).ceil());
    let margin = MARGIN * step * (last - first);
    // At most 10 ticks, since their size grows by at most 2.5.
    let ticks = (0..=(last - first) as i64).map(|i| {
        let at = step * (first + i as f64);
        Tick { at, label: Some(with_decimals(at, step)) }
    });
    ([step * first - margin, step * last + margin], ticks.collect())
}

fn steps((lo, hi): (f64, f64), levels: &[f64], room: Room) -> ([f64; 2], Vec<Tick>) {
    let margin = (0.08 * (hi - lo)).max(0.08);
    let ends = [lo - margin, hi + margin];
    let place = |level: f64| room.length * (level.log10() - ends[0]) / (ends[1] - ends[0]);
    let mut free_from = f64::NEG_INFINITY;
    let ticks = levels.iter().map(|&at| {
        let free = place(at) >= free_from;
        let label = free.then(|| step_label(at));
        if let Some(label) = &label {
            // `room.label` is that of five characters, as in 1/128.
            free_from = place(at) + room.label * (label.chars().count() as f64 / 5.0).max(1.0);
        }
        Tick { at, label }
    });
    let ticks = ticks.collect();
    (ends, ticks)
}

/// The logarithm of digit·10^exponent.
fn measured((digit, exponent): (i64, i64)) -> f64 {
    (digit as f64).log10() + exponent as f64
}

/// Nearest double; zero or infinite out of range, where no tick is drawn.
fn value((digit, exponent): (i64, i64)) -> f64 {
    format!("{digit}e{exponent}").parse().unwrap_or(f64::NAN)
}

/// The axis ends at members of the sequence …, 0.5, 1, 2, 5, 10, …; these are labelled if there is room, else powers of
/// ten.
fn logarithmic((lo, hi): (f64, f64), room: Room) -> ([f64; 2], Vec<Tick>) {
    let margin = (MARGIN * (hi - lo)).max(MARGIN);
    let decades = || (lo - margin).floor() as i64 - 1..=(hi + margin).ceil() as i64;
    let members = || decades().flat_map(|exponent| DIGITS.map(|digit| (digit, exponent)));
    let below = members().map(measured).take_while(|member| *member <= lo - margin);
    let above = members().map(measured).find(|member| *member >= hi + margin);
    let ends = [below.fold(lo - margin, |_, last| last), above.unwrap_or(hi + margin)];
    let decade = room.length / (ends[1] - ends[0]);
    let digits_fit = decade * 2f64.log10() >= room.label;
    let every = (room.label / decade).ceil().max(1.0) as i64;
    let first = ends[0].ceil() as i64;
    let label = |digit: i64, exponent: i64| match digit {
        _ if digits_fit => DIGITS.contains(&digit).then(|| decimal(digit, exponent)),
        1 => ((exponent - first) % every == 0).then(|| power(exponent)),
        _ => None,
    };
    let tick = |(digit, exponent)| {
        let inside = (ends[0]..=ends[1]).contains(&measured((digit, exponent)));
        let label = label(digit, exponent);
        let drawn = inside && (label.is_some() || every == 1);
        drawn.then(|| Tick { at: value((digit, exponent)), label })
    };
    let all = decades().flat_map(|exponent| (1..10).map(move |digit| (digit, exponent)));
    let mut ticks: Vec<Tick> = all.filter_map(tick).collect();
    // Short strokes lie above the grid.
    ticks.sort_by_key(|tick| tick.label.is_none());
    (ends, ticks)
}

// Numbers at the ticks of an axis.

/// A step as 1/n if possible.
pub(super) fn step_label(step: f64) -> String {
    let inverse = 1.0 / step;
    // 1/n as computed is off by a rounding; a step of a graded grid by far more.
    if inverse > 1.5 && inverse < 1e6 && (inverse - inverse.round()).abs() < 1e-9 * inverse {
        format!("1/{}", inverse.round())
    } else if (1e-3..1e4).contains(&step) {
        format!("{}", (step * 1e4).round() / 1e4)
    } else {
        format!("{step:.1e}")
    }
}

/// digit·10^exponent, as a plain decimal if short.
pub(super) fn decimal(digit: i64, exponent: i64) -> String {
    match exponent {
        -3..0 => format!("{:.*}", -exponent as usize, digit as f64 * 10f64.powi(exponent as i32)),
        0..4 => format!("{}", digit * 10i64.pow(exponent as u32)),
        _ if digit == 1 => power(exponent),
        _ => format!("{digit}·{}", power(exponent)),
    }
}

pub(super) fn power(exponent: i64) -> String {
    let digit = |c: char| "⁰¹²³⁴⁵⁶⁷⁸⁹".chars().nth(c.to_digit(10)? as usize);
    let above = exponent.to_string().chars().map(|c| digit(c).unwrap_or('⁻')).collect::<String>();
    format!("10{above}")
}

/// A multiple of `step`, with as many decimals as the step has.
pub(super) fn with_decimals(value: f64, step: f64) -> String {
    let exponent = (step * (1.0 + 1e-9)).log10().floor() as i32;
    if (-4..5).contains(&exponent) {
        // Avoids -0.
        let value = if value.abs() < 0.5 * step { 0.0 } else { value };
        format!("{value:.*}", (-exponent).max(0) as usize)
    } else {
        format!("{value:.1e}")
    }
}

#[cfg(test)]
mod tests {
    mod ruler {
        use super::super::*;

        const ROOM: Room = Room { length: 800.0, label: 80.0 };

        fn labels(scale: Scale, data: &[f64]) -> Vec<String> {
            let ruler = Ruler::new(scale, data, &[], ROOM).unwrap();
            assert!(data.iter().all(|v| (0.0..=1.0).contains(&ruler.share(*v))), "{ruler:?}");
            let mut ticks = ruler.ticks;
            assert!(ticks.iter().all(|tick| tick.at.is_finite()), "{ticks:?}");
            ticks.sort_by(|a, b| a.at.total_cmp(&b.at));
            ticks.into_iter().filter_map(|tick| tick.label).collect()
        }

        #[test]
        fn a_wide_range_has_decades_a_narrow_one_digits() {
            assert_eq!(labels(Scale::Log, &[3e-6, 2e-2]), ["10⁻⁵", "10⁻⁴", "10⁻³", "10⁻²"]);
            assert_eq!(labels(Scale::Log, &[0.03, 0.15]), ["0.02", "0.05", "0.1", "0.2"]);
            assert_eq!(labels(Scale::Log, &[1.0]), ["0.5", "1", "2"]);
            // Labels stand clear of each other: no more than ten on 800 units.
            assert!(labels(Scale::Log, &[1e-30, 1.0]).len() <= 10);
            assert!(labels(Scale::Log, &[f64::MIN_POSITIVE, f64::MAX]).len() >= 2);
        }

        #[test]
        fn linear_ticks_are_round() {
            assert_eq!(labels(Scale::Linear, &[0.0, 1.0]).first().unwrap(), "0.0");
            assert_eq!(labels(Scale::Linear, &[0.0, 0.71]).last().unwrap(), "0.8");
            assert_eq!(labels(Scale::Linear, &[-3.0, 12.0]).first().unwrap(), "-4");
            assert!(labels(Scale::Linear, &[2.0]).len() >= 2);
            assert!(labels(Scale::Linear, &[0.0]).len() >= 2);
        }

        #[test]
        fn steps_are_the_levels_and_thin_out() {
            assert_eq!(labels(Scale::Steps, &[0.25, 0.125]), ["1/8", "1/4"]);
            let many: Vec<f64> = (1..100).map(|n| 1.0 / f64::from(n)).collect();
            assert!(labels(Scale::Steps, &many).len() <= 10);
        }

        #[test]
        fn what_has_no_place_makes_no_axis() {
            assert!(Ruler::new(Scale::Log, &[0.0, -1.0, f64::NAN], &[1.0], ROOM).is_none());
            assert!(Ruler::new(Scale::Linear, &[f64::INFINITY], &[], ROOM).is_none());
            let marked = Ruler::new(Scale::Steps, &[0.5], &[2.0, f64::INFINITY], ROOM).unwrap();
            assert!(marked.share(2.0) < 1.0 && marked.ticks.len() == 1);
        }
    }
    mod ticks {
        use super::super::*;

        #[test]
        fn numbers_read_as_they_should() {
            assert_eq!(power(-10), "10⁻¹⁰");
            assert_eq!(step_label(1.0 / 49.0), "1/49");
            assert_eq!(step_label(0.3), "0.3");
            assert_eq!(decimal(2, -3), "0.002");
            assert_eq!(decimal(5, 3), "5000");
            assert_eq!(decimal(2, -7), "2·10⁻⁷");
            assert_eq!(with_decimals(0.30000000000000004, 0.1), "0.3");
            assert_eq!(with_decimals(-1e-17, 0.02), "0.00");
            assert_eq!(with_decimals(3e-7, 1e-7), "3.0e-7");
        }
    }
}
