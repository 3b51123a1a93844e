//! Load vectors F_n(v) over time.

/// Why a load could not be computed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LoadError {
    /// A formula gave no finite number.
    #[error("{what} is {value} at ({x}, {y}), t = {t}: the formula must be finite on the domain and its time interval")]
    NotFinite { what: String, value: f64, x: f64, y: f64, t: f64 },
}

/// A load Σ_i a_i(t) F_i with few vectors F_i.
pub struct Separated<'a> {
    /// The F_i.
    pub basis: &'a [Vec<f64>],
    /// The a_i, as one function that fills a slice.
    pub factors: &'a dyn Fn(f64, &mut [f64]),
}

/// The load of a scene on one mesh.
pub trait Load {
    /// `out` ← F(t), over the unknowns.
    ///
    /// # Errors
    /// [`LoadError`] if a formula is not finite.
    fn assemble(&mut self, t: f64, out: &mut [f64]) -> Result<(), LoadError>;

    /// The separated form, if the load has one.
    fn separated(&self) -> Option<Separated<'_>> {
        None
    }
}

/// One vector for all times.
pub struct ConstantInTime(pub Vec<f64>);

impl Load for ConstantInTime {
    fn assemble(&mut self, _: f64, out: &mut [f64]) -> Result<(), LoadError> {
        out.copy_from_slice(&self.0);
        Ok(())
    }
}
