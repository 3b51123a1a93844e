//! The result of a fit of one error model to a grid.

use super::{Direction, ErrorCombination, Interval, Point};

/// A fitted value with its 95 % interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FittedValue {
    pub value: f64,
    pub interval: Interval,
}

/// One error model fitted to a grid, in logarithms.
#[derive(Debug, Clone)]
pub struct JointFit {
    pub model: ErrorCombination,
    /// Order p in h with its Student interval.
    pub order_h: FittedValue,
    /// Order q in k with its Student interval.
    pub order_k: FittedValue,
    /// Student intervals of p and q, before widening.
    pub student: [Interval; 2],
    pub constant_h: f64,
    pub constant_k: f64,
    pub floor: Option<f64>,
    /// ‖log E − log e‖, Euclidean over the points.
    pub residual_norm: f64,
    /// Condition of the Jacobian with columns scaled to length 1.
    pub condition: f64,
}

impl JointFit {
    /// The error of the model at (h, k).
    pub fn error(&self, h: f64, k: f64) -> f64 {
        self.combined(h, k).0.exp()
    }

    /// Share of a direction in the error at a point: its weight in a local slope.
    pub fn share(&self, direction: Direction, point: &Point) -> f64 {
        self.combined(point.h, point.k).1[direction as usize]
    }

    fn combined(&self, h: f64, k: f64) -> (f64, [f64; 3]) {
        let space = self.constant_h.ln() + self.order_h.value * h.ln();
        let time = self.constant_k.ln() + self.order_k.value * k.ln();
        self.model.combine([space, time, self.floor.map_or(f64::NEG_INFINITY, f64::ln)])
    }
}
