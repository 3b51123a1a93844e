//! Symmetric tensors in Mandel notation: `S` numbers, off-diagonal ones times √2, so that the Frobenius product is the
//! dot product.
//!
//! S = 3 (plane): (xx, yy, √2 xy). S = 6 (space): (xx, yy, zz, √2 yz, √2 xz, √2 xy).

/// A symmetric tensor of S^d in Mandel notation.
pub type Symmetric<const S: usize> = [f64; S];

/// Space dimension d of tensors with `S` = d(d+1)/2 numbers.
pub const fn dimension<const S: usize>() -> usize {
    if S == 3 { 2 } else { 3 }
}

/// The two axes of each off-diagonal component.
#[inline]
pub const fn off_diagonal(d: usize) -> &'static [(usize, usize)] {
    if d == 2 { &[(1, 0)] } else { &[(1, 2), (2, 0), (0, 1)] }
}

/// tr τ.
#[inline]
pub fn trace<const S: usize>(tau: &Symmetric<S>) -> f64 {
    tau[..dimension::<S>()].iter().sum()
}

/// τ:σ, the Frobenius product.
#[inline]
pub fn contract<const S: usize>(tau: &Symmetric<S>, sigma: &Symmetric<S>) -> f64 {
    let mut sum = 0.0;
    for i in 0..S {
        sum += tau[i] * sigma[i];
    }
    sum
}

/// τ^D = τ - (tr τ / d) I.
#[inline]
pub fn deviator<const S: usize>(tau: &Symmetric<S>) -> Symmetric<S> {
    let d = dimension::<S>();
    let mean = trace(tau) / d as f64;
    let mut out = *tau;
    for value in &mut out[..d] {
        *value -= mean;
    }
    out
}

/// ‖τ‖ (Frobenius), for any tensor whose norm is a double.
#[inline]
pub fn norm<const S: usize>(tau: &Symmetric<S>) -> f64 {
    let square = contract(tau, tau);
    // Squares out of this range lose digits.
    if (1e-270..=1e300).contains(&square) { square.sqrt() } else { scaled_norm(tau) }
}

#[cold]
fn scaled_norm<const S: usize>(tau: &Symmetric<S>) -> f64 {
    let size = tau.iter().fold(0.0f64, |size, value| size.max(value.abs()));
    if size == 0.0 || !size.is_finite() {
        // Zero, infinite, or NaN, which the maximum ignores.
        return contract(tau, tau).sqrt();
    }
    let scaled = tau.map(|value| value / size);
    size * contract(&scaled, &scaled).sqrt()
}
