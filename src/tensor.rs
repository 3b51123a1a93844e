//! Symmetric tensors in Mandel notation: `S` numbers, of which the off-diagonal ones carry √2,
//! so that the Frobenius product is the Euclidean dot product.
//!
//! S = 3 (plane): (xx, yy, √2 xy). S = 6 (space): (xx, yy, zz, √2 yz, √2 xz, √2 xy).

/// A symmetric tensor of S^d in Mandel notation.
pub type Symmetric<const S: usize> = [f64; S];

/// Space dimension d of tensors with `S` = d(d+1)/2 numbers.
pub const fn dimension<const S: usize>() -> usize {
    if S == 3 { 2 } else { 3 }
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

/// ‖τ‖ (Frobenius).
#[inline]
pub fn norm<const S: usize>(tau: &Symmetric<S>) -> f64 {
    contract(tau, tau).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mandel_product_is_the_frobenius_product() {
        // [[1,2],[2,5]]: ‖·‖² = 1 + 4 + 4 + 25.
        let tau = [1.0, 5.0, 2.0 * 2f64.sqrt()];
        assert!((contract(&tau, &tau) - 34.0).abs() < 1e-14);
    }

    #[test]
    fn deviators_are_trace_free_in_their_own_dimension() {
        let plane = deviator(&[1.0, 5.0, 0.3]);
        assert!(trace(&plane).abs() < 1e-15 && plane[0] == -2.0);
        let space = deviator(&[1.0, 2.0, 6.0, 0.1, 0.2, 0.3]);
        assert!(trace(&space).abs() < 1e-15 && space[2] == 3.0);
    }
}
