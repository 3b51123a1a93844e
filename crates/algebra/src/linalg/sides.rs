//! The right sides of a pass at one unknown: one number, or several, for which the factor is read once where a single pass
//! is bound by its memory traffic.

use super::cholesky::Real;
use super::supernode::COLUMNS;

/// Right sides of a pass with several: two registers of four doubles.
pub const SIDES: usize = 8;

pub type RightSides = [f64; SIDES];

/// Partial sums of a scalar product: two registers of four doubles, per column.
const LANES: usize = 8;
const HALF: usize = LANES / 2;

/// What substitutions do with the right sides at one unknown. Sums have a fixed number of lanes, so that results do not
/// depend on the vector unit, and each side is independent of the others.
pub trait Sides<T>: Copy {
    const NONE: Self;

    fn plus(self, other: Self) -> Self;

    fn minus(self, other: Self) -> Self;

    /// self - `entry`·`other`.
    fn less(self, entry: T, other: Self) -> Self;

    fn over(self, entry: T) -> Self;

    /// x ← x - Σ_a w_a c_a.
    fn subtract(c: [&[T]; COLUMNS], w: [Self; COLUMNS], x: &mut [Self]);

    /// Σ_i c_i x_i.
    fn product(c: &[T], x: &[Self]) -> Self;

    /// The same for several columns c.
    fn products(c: [&[T]; COLUMNS], x: &[Self]) -> [Self; COLUMNS];
}

impl<T: Real> Sides<T> for T {
    const NONE: Self = <T as Real>::ZERO;

    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        self + other
    }

    #[inline(always)]
    fn minus(self, other: Self) -> Self {
        self - other
    }

    #[inline(always)]
    fn less(self, entry: T, other: Self) -> Self {
        self - entry * other
    }

    #[inline(always)]
    fn over(self, entry: T) -> Self {
        self / entry
    }

    #[inline(always)]
    fn subtract(c: [&[T]; COLUMNS], w: [Self; COLUMNS], x: &mut [Self]) {
        subtract(c, w, x);
    }

    #[inline(always)]
    fn product(c: &[T], x: &[Self]) -> Self {
        product(c, x)
    }

    #[inline(always)]
    fn products(c: [&[T]; COLUMNS], x: &[Self]) -> [Self; COLUMNS] {
        products(c, x)
    }
}

impl Sides<f64> for RightSides {
    const NONE: Self = [0.0; SIDES];

    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        std::array::from_fn(|l| self[l] + other[l])
    }

    #[inline(always)]
    fn minus(self, other: Self) -> Self {
        std::array::from_fn(|l| self[l] - other[l])
    }

    #[inline(always)]
    fn less(self, entry: f64, other: Self) -> Self {
        std::array::from_fn(|l| self[l] - entry * other[l])
    }

    #[inline(always)]
    fn over(self, entry: f64) -> Self {
        self.map(|value| value / entry)
    }

    #[inline(always)]
    fn subtract(c: [&[f64]; COLUMNS], w: [Self; COLUMNS], x: &mut [Self]) {
        let c = c.map(|c| &c[..x.len()]);
        for (i, row) in x.iter_mut().enumerate() {
            for a in 0..COLUMNS {
                *row = row.less(c[a][i], w[a]);
            }
        }
    }

    #[inline(always)]
    fn product(c: &[f64], x: &[Self]) -> Self {
        let mut sum = Self::NONE;
        for (entry, row) in c.iter().zip(x) {
            for l in 0..SIDES {
                sum[l] += entry * row[l];
            }
        }
        sum
    }

    #[inline(always)]
    fn products(c: [&[f64]; COLUMNS], x: &[Self]) -> [Self; COLUMNS] {
        let c = c.map(|c| &c[..x.len()]);
        let mut sums = [Self::NONE; COLUMNS];
        for (i, row) in x.iter().enumerate() {
            for a in 0..COLUMNS {
                for l in 0..SIDES {
                    sums[a][l] += c[a][i] * row[l];
                }
            }
        }
        sums
    }
}

#[inline(always)]
fn product<T: Real>(a: &[T], b: &[T]) -> T {
    let mut lanes = [T::ZERO; LANES];
    let (a_blocks, b_blocks) = (a.chunks_exact(LANES), b.chunks_exact(LANES));
    let (a_rest, b_rest) = (a_blocks.remainder(), b_blocks.remainder());
    for (a, b) in a_blocks.zip(b_blocks) {
        for l in 0..LANES {
            lanes[l] += a[l] * b[l];
        }
    }
    let rest = a_rest.iter().zip(b_rest).fold(T::ZERO, |sum, (a, b)| sum + *a * *b);
    total(lanes) + rest
}

/// x ← x - Σ_a w_a c_a, in blocks of fixed size: fronts are short, and longer unrolling would spend its time on
/// remainders.
#[inline(always)]
fn subtract<T: Real>(c: [&[T]; COLUMNS], w: [T; COLUMNS], x: &mut [T]) {
    let [c0, c1, c2, c3] = c.map(|c| &c[..x.len()]);
    for (i, x) in x.iter_mut().enumerate() {
        *x -= (c0[i] * w[0] + c1[i] * w[1]) + (c2[i] * w[2] + c3[i] * w[3]);
    }
}

#[inline(always)]
fn products<T: Real>(c: [&[T]; COLUMNS], x: &[T]) -> [T; COLUMNS] {
    let ((x, x_rest), c) = (x.as_chunks::<LANES>(), c.map(|c| c.as_chunks::<LANES>()));
    let mut lanes = [[T::ZERO; LANES]; COLUMNS];
    let blocks = x.iter().zip(c[0].0).zip(c[1].0).zip(c[2].0).zip(c[3].0);
    for ((((x, c0), c1), c2), c3) in blocks {
        for (lanes, c) in lanes.iter_mut().zip([c0, c1, c2, c3]) {
            for l in 0..LANES {
                lanes[l] += c[l] * x[l];
            }
        }
    }
    let ((x, x_rest), c) = (x_rest.as_chunks::<HALF>(), c.map(|c| c.1.as_chunks::<HALF>()));
    let mut halves: [[T; HALF]; COLUMNS] =
        lanes.map(|lanes| std::array::from_fn(|l| lanes[l] + lanes[l + HALF]));
    if let [x] = x {
        for (halves, (c, _)) in halves.iter_mut().zip(c) {
            for l in 0..HALF {
                halves[l] += c[0][l] * x[l];
            }
        }
    }
    // Separate sums: lanes addressed one by one would not stay in registers.
    let mut rest = [T::ZERO; COLUMNS];
    for (i, x) in x_rest.iter().enumerate() {
        for (rest, (_, c)) in rest.iter_mut().zip(c) {
            *rest += c[i] * *x;
        }
    }
    std::array::from_fn(|a| {
        let [p, q, r, s] = halves[a];
        ((p + r) + (q + s)) + rest[a]
    })
}

#[inline(always)]
fn total<T: Real>(lanes: [T; LANES]) -> T {
    let mut lanes = lanes;
    let mut half = LANES / 2;
    while half > 0 {
        for l in 0..half {
            lanes[l] += lanes[l + half];
        }
        half /= 2;
    }
    lanes[0]
}
