//! Sums and norms of vectors.

/// Independent partial sums of a scalar product.
const LANES: usize = 8;

/// Σ a_i b_i; eight sums, each in order.
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    let length = a.len().min(b.len());
    let (a, b) = (&a[..length], &b[..length]);
    let ((a, a_rest), (b, b_rest)) = (a.as_chunks::<LANES>(), b.as_chunks::<LANES>());
    let mut lanes = [0.0; LANES];
    for (a, b) in a.iter().zip(b) {
        for l in 0..LANES {
            lanes[l] += a[l] * b[l];
        }
    }
    let rest: f64 = a_rest.iter().zip(b_rest).map(|(x, y)| x * y).sum();
    lanes.iter().sum::<f64>() + rest
}

/// ‖a‖₂.
pub fn norm(a: &[f64]) -> f64 {
    root_of_squares(|scale| a.iter().map(|x| (scale * x) * (scale * x)).sum())
}

/// Sums of squares in this range lost nothing to under- or overflow.
const SQUARES: std::ops::RangeInclusive<f64> = 1e-270..=1e300;

/// Whether a sum of squares lost nothing to under- or overflow.
pub fn is_sound_sum(squares: f64) -> bool {
    SQUARES.contains(&squares)
}

/// 2^500, a factor that brings squares back into range.
const RESCALED: f64 = 3.273_390_607_896_142e150;

/// √S(1) for a sum of squares S(s) = Σ w_i (s x_i)². If S(1) leaves the safe range, S(s)/s² is used with a power of two
/// s: the same bits except under under- or overflow.
pub fn root_of_squares(sum: impl Fn(f64) -> f64) -> f64 {
    let plain = sum(1.0);
    if is_sound_sum(plain) || plain.is_nan() {
        return plain.sqrt();
    }
    let scale = if plain > 1.0 { 1.0 / RESCALED } else { RESCALED };
    sum(scale).sqrt() / scale
}

/// The larger of two numbers; unlike `f64::max` it keeps a NaN.
pub fn larger(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() { f64::NAN } else { a.max(b) }
}

/// max |a_i|, 0 if empty; keeps a NaN.
pub fn largest(a: &[f64]) -> f64 {
    let (blocks, rest) = a.as_chunks::<LANES>();
    // Comparisons with NaN are false, so NaN is detected separately, without branches.
    let (mut lanes, mut nothing) = ([0.0f64; LANES], [0.0; LANES]);
    for block in blocks {
        for l in 0..LANES {
            let size = block[l].abs();
            lanes[l] = if size > lanes[l] { size } else { lanes[l] };
            nothing[l] += if size.is_nan() { 1.0 } else { 0.0 };
        }
    }
    if nothing.iter().sum::<f64>() > 0.0 {
        return f64::NAN;
    }
    lanes.iter().chain(rest).fold(0.0, |worst, value| larger(worst, value.abs()))
}

/// y ← y + α x.
pub fn axpy(alpha: f64, x: &[f64], y: &mut [f64]) {
    for (target, value) in y.iter_mut().zip(x) {
        *target += alpha * value;
    }
}
