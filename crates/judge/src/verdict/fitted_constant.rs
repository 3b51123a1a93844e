use serde::Serialize;

#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct FittedConstant {
    pub value: f64,
    pub interval: [f64; 2],
    pub order: f64,
    /// Constant of the leading errors, if known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub predicted: Option<f64>,
    /// Limit of error over step, if known independently of the cases.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub limit: Option<f64>,
    /// Measured over predicted on the finest case.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ratio: Option<f64>,
    /// Allowed distance of the ratio from one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tolerance: Option<f64>,
}

impl FittedConstant {
    pub(crate) fn fitted(value: f64, interval: impl Into<[f64; 2]>, order: f64) -> Self {
        let interval = interval.into();
        Self { value, interval, order, predicted: None, limit: None, ratio: None, tolerance: None }
    }
}
