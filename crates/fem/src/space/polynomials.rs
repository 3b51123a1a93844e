//! Polynomials on a simplex as sums of products of barycentric coordinates: since Σ b_i = 1, the products of so many of them
//! span all polynomials of this degree.

/// All products of `degree` of the coordinates `b`.
pub(super) fn monomials(degree: usize, b: &[f64]) -> Vec<f64> {
    match (degree, b) {
        (0, _) => vec![1.0],
        (_, []) => Vec::new(),
        (_, [first, rest @ ..]) => {
            let with_first = monomials(degree - 1, b).into_iter().map(|term| first * term);
            with_first.chain(monomials(degree, rest)).collect()
        }
    }
}

/// Their means over a simplex with so many corners, in their order: d! Π α_i!/(d + degree)! of Π b_i^α_i, d = corners - 1.
#[cfg(test)]
pub(super) fn means(degree: usize, corners: usize) -> Vec<f64> {
    let factorial = |m: usize| (1..=m).map(|i| i as f64).product::<f64>();
    let mean = |powers: Vec<usize>| {
        let above: f64 = powers.into_iter().map(factorial).product();
        factorial(corners - 1) * above / factorial(corners - 1 + degree)
    };
    powers(degree, corners).into_iter().map(mean).collect()
}

/// All lists of `count` powers with this sum, the largest first powers first.
#[cfg(test)]
fn powers(sum: usize, count: usize) -> Vec<Vec<usize>> {
    if count == 1 {
        return vec![vec![sum]];
    }
    let with = |first: usize| {
        powers(sum - first, count - 1).into_iter().map(move |rest| [vec![first], rest].concat())
    };
    (0..=sum).rev().flat_map(with).collect()
}
