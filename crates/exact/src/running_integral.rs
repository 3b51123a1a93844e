//! ∫_0^t f(s) ds for any t from few values of an expensive, piecewise smooth f.
//!
//! The horizon is cut into panels and these at the events of f; a piece that does not resolve f (on a long horizon,
//! with many oscillations per panel) is halved. On each piece f is interpolated at Gauss points by a Legendre series,
//! which is integrated in closed form. Values are independent of the times requested and their order.

use std::sync::{Mutex, PoisonError};

use fem::space::quadrature::gauss_legendre;

/// Panels of the horizon.
const PANELS: usize = 16;
/// Gauss points per piece: on T/16 a function analytic in a disc of radius T is resolved to rounding.
const POINTS: usize = 10;
/// A piece is halved while its last two Legendre coefficients exceed this share of the largest: the series then misses
/// about as much again.
const RESOLVED: f64 = 1e-12;
/// Largest error of a piece, as a share of the size of f on its panel times the panel: half a unit in the last place.
/// Towards powers (s - a)^p, p > 0, and kinks without events, pieces are halved until it is reached.
const NEGLIGIBLE: f64 = 1e-16;
/// Halvings of all pieces, of those towards few places, and number of the latter per panel.
const HALVINGS: u32 = 6;
const DEEPEST: u32 = 60;
const MOST: usize = 256;

/// A running integral, grown panel by panel.
pub(crate) struct RunningIntegral {
    horizon: f64,
    /// Allowed unresolved share of a piece.
    share: f64,
    panels: Mutex<Vec<Vec<Piece>>>,
}

/// One piece: its ends, the integral up to its start, and the Legendre coefficients of f.
struct Piece {
    from: f64,
    to: f64,
    before: f64,
    coefficients: Vec<f64>,
}

impl RunningIntegral {
    /// An integral over [0, horizon], not yet computed.
    pub(crate) fn new(horizon: f64) -> Self {
        Self { horizon, share: RESOLVED, panels: Mutex::new(Vec::new()) }
    }

    /// For a function whose values are accurate only to this share, if that is larger than the default.
    pub(crate) fn scaled_to(self, share: f64) -> Self {
        Self { share: share.max(RESOLVED), ..self }
    }

    /// ∫_0^t f; `events` lists the cuts inside an interval, sorted. Times beyond the horizon are extrapolated from its
    /// last piece.
    ///
    /// # Errors
    /// Those of f.
    pub(crate) fn at<E>(
        &self,
        t: f64,
        events: impl Fn(f64, f64) -> Vec<f64>,
        mut f: impl FnMut(f64) -> Result<f64, E>,
    ) -> Result<f64, E> {
        let width = self.horizon / PANELS as f64;
        let panel = ((t / width) as usize).min(PANELS - 1);
        let mut panels = self.panels.lock().unwrap_or_else(PoisonError::into_inner);
        while panels.len() <= panel {
            let p = panels.len();
            let before = match panels.last().and_then(|pieces| pieces.last()) {
                Some(piece) => piece.at(piece.to),
                None => 0.0,
            };
            let (from, to) = (width * p as f64, width * (p + 1) as f64);
            let mut cuts = vec![from];
            cuts.extend(events(from, to));
            cuts.push(to);
            let mut panel =
                Panel { before, width: to - from, share: self.share, ..Panel::default() };
            for pair in cuts.windows(2).filter(|pair| pair[1] - pair[0] > 1e-13 * width) {
                resolve([pair[0], pair[1]], 0, &mut panel, &mut f)?;
            }
            panels.push(panel.pieces);
        }
        let pieces = &panels[panel];
        let containing = pieces.iter().find(|piece| t <= piece.to).or(pieces.last());
        Ok(containing.map_or(0.0, |piece| piece.at(t)))
    }
}

#[derive(Default)]
struct Panel {
    /// The integral up to the next piece.
    before: f64,
    width: f64,
    share: f64,
    /// The largest coefficient so far.
    size: f64,
    /// Pieces halved beyond [`HALVINGS`].
    halved: usize,
    pieces: Vec<Piece>,
}

/// Appends the piece between two times, or its halves if it does not resolve f.
fn resolve<E>(
    [from, to]: [f64; 2],
    halvings: u32,
    panel: &mut Panel,
    f: &mut impl FnMut(f64) -> Result<f64, E>,
) -> Result<(), E> {
    let piece = Piece::new(from, to, panel.before, f)?;
    panel.size = panel.size.max(piece.size());
    let middle = 0.5 * (from + to);
    let may_go_on = halvings < HALVINGS || (halvings < DEEPEST && panel.halved < MOST);
    let negligible = (to - from) * piece.tail() <= NEGLIGIBLE * panel.width * panel.size;
    if piece.is_resolved(panel.share) || negligible || !may_go_on || middle <= from || middle >= to
    {
        panel.before = piece.at(to);
        panel.pieces.push(piece);
        return Ok(());
    }
    panel.halved += usize::from(halvings >= HALVINGS);
    resolve([from, middle], halvings + 1, panel, f)?;
    resolve([middle, to], halvings + 1, panel, f)
}

impl Piece {
    /// NaN counts as resolved, since halving does not help.
    fn is_resolved(&self, share: f64) -> bool {
        self.tail() <= share * self.size()
    }

    /// The largest coefficient, ignoring NaN.
    fn size(&self) -> f64 {
        self.coefficients.iter().fold(0.0, |size: f64, c| size.max(c.abs()))
    }

    fn tail(&self) -> f64 {
        self.coefficients[POINTS - 2..].iter().fold(0.0, |tail: f64, c| tail.max(c.abs()))
    }

    fn new<E>(
        from: f64,
        to: f64,
        before: f64,
        f: &mut impl FnMut(f64) -> Result<f64, E>,
    ) -> Result<Self, E> {
        let mut coefficients = vec![0.0; POINTS];
        for &(x, weight) in gauss_legendre(POINTS) {
            let value = f(0.5 * (from + to) + 0.5 * (to - from) * x)?;
            let polynomials = legendre(x);
            for (l, coefficient) in coefficients.iter_mut().enumerate() {
                *coefficient += (l as f64 + 0.5) * weight * value * polynomials[l];
            }
        }
        Ok(Self { from, to, before, coefficients })
    }

    /// The integral up to t: ∫_{-1}^x P_l = (P_{l+1}(x) - P_{l-1}(x))/(2l + 1).
    fn at(&self, t: f64) -> f64 {
        let half = 0.5 * (self.to - self.from);
        let x = (t - self.from) / half - 1.0;
        let polynomials = legendre(x);
        let mut sum = self.coefficients[0] * (x + 1.0);
        for (l, coefficient) in self.coefficients.iter().enumerate().skip(1) {
            let integral = (polynomials[l + 1] - polynomials[l - 1]) / (2 * l + 1) as f64;
            sum += coefficient * integral;
        }
        self.before + half * sum
    }
}

fn legendre(x: f64) -> [f64; POINTS + 1] {
    let mut p = [1.0; POINTS + 1];
    p[1] = x;
    for l in 2..=POINTS {
        let n = l as f64;
        p[l] = ((2.0 * n - 1.0) * x * p[l - 1] - (n - 1.0) * p[l - 2]) / n;
    }
    p
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kinks_named_as_events_cost_no_accuracy() {
        let integral = RunningIntegral::new(2.0);
        let events = |from: f64, to: f64| if from < 0.7 && 0.7 < to { vec![0.7] } else { vec![] };
        for t in [2.0, 0.3, 0.7, 1.234, 0.0] {
            let value: Result<f64, ()> =
                integral.at(t, events, |s| Ok((s - 0.7).abs() + (3.0 * s).sin()));
            let kink =
                if t < 0.7 { 0.7 * t - 0.5 * t * t } else { 0.245 + 0.5 * (t - 0.7) * (t - 0.7) };
            let exact = kink + (1.0 - (3.0 * t).cos()) / 3.0;
            assert!((value.unwrap() - exact).abs() < 1e-14, "{t}");
        }
    }

    /// Powers at the start, and roots at a place without an event: all to rounding.
    #[test]
    fn powers_are_halved_until_nothing_is_left() {
        for power in [0.1, 0.3, 0.6, 0.9] {
            let none = |_: f64, _: f64| Vec::new();
            let integral = RunningIntegral::new(1.0);
            let root = RunningIntegral::new(1.0);
            for t in [1.0, 0.3, 1e-3] {
                let value: Result<f64, ()> = integral.at(t, none, |s| Ok(s.powf(power)));
                let exact = t.powf(1.0 + power) / (1.0 + power);
                assert!((value.unwrap() - exact).abs() < 2e-15, "{power} {t}");
                let p = 1.0 + power;
                let value: Result<f64, ()> = root.at(t, none, |s| Ok((s - 0.3).abs().powf(power)));
                let exact = (0.3_f64.powf(p) + (t - 0.3).signum() * (t - 0.3).abs().powf(p)) / p;
                // 0.3 is not an edge of a panel: pieces end at neighbouring numbers.
                assert!((value.unwrap() - exact).abs() < 1e-13, "{power} {t} root");
            }
        }
    }

    /// On T = 64 a panel of width 4 has several oscillations and nearly a kink (complex roots of 0.02 + sin² 2t at
    /// distance 0.07 of the axis), resolved only by halving. The integral from 0 to π/2 repeats.
    #[test]
    fn a_long_horizon_is_resolved_by_halving() {
        let f = |s: f64| -> Result<f64, ()> { Ok((0.02 + (2.0 * s).sin().powi(2)).sqrt()) };
        let none = |_: f64, _: f64| Vec::new();
        let period = RunningIntegral::new(0.5 * std::f64::consts::PI);
        let one = period.at(0.5 * std::f64::consts::PI, none, f).unwrap();
        let long = RunningIntegral::new(64.0);
        for periods in [1.0, 7.0, 40.0] {
            let value = long.at(0.5 * std::f64::consts::PI * periods, none, f).unwrap();
            // 1e-12 of f's size, over pieces of total length 63.
            assert!((value - periods * one).abs() < 1e-10, "{periods}: {}", value - periods * one);
        }
        let coarse = Piece::new(0.0, 4.0, 0.0, &mut { f }).unwrap();
        let half_way = coarse.at(2.0) - long.at(2.0, none, f).unwrap();
        assert!(half_way.abs() > 1e-4, "{half_way}");
    }
}
