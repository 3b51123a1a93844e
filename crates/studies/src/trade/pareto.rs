//! The runs that no other run beats in error and time, and in error, time and memory.

/// Errors that differ by a smaller part are one: a knob that buys the sixth digit buys nothing.
pub(super) const TIE: f64 = 0.01;

/// Indices of the points (costs, error) that no other point dominates: none is as good in all and better in one. They are
/// sorted by the first cost; of equal points the first is kept, and of errors that differ by a part below `tie` that of
/// the run that costs less. A point that is not finite is not on the front.
pub fn front<const N: usize>(points: &[[f64; N]], tie: f64) -> Vec<usize> {
    let finite = |i: &usize| points[*i].iter().all(|value| value.is_finite());
    let mut order: Vec<usize> = (0..points.len()).filter(finite).collect();
    order.sort_by(|&a, &b| {
        let both = points[a].iter().zip(&points[b]);
        both.map(|(a, b)| a.total_cmp(b)).find(|order| order.is_ne()).unwrap_or(a.cmp(&b))
    });
    let mut kept: Vec<usize> = Vec::new();
    for i in order {
        let beats = |&j: &usize| {
            let mut costs = points[j].iter().zip(&points[i]).take(N - 1);
            costs.all(|(less, more)| less <= more)
                && points[i][N - 1] >= (1.0 - tie) * points[j][N - 1]
        };
        if !kept.iter().any(beats) {
            kept.push(i);
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_axes_by_hand() {
        let points = [
            [1.0, 2.0, 3.0],
            // Slower and no better than the first, with less memory.
            [2.0, 1.0, 3.0],
            // Beaten by the first in all three, and by the last in two.
            [2.0, 3.0, 4.0],
            [f64::NAN, 0.0, 0.0],
            [1.0, 2.0, 3.0],
            [9.0, 3.0, 0.5],
        ];
        assert_eq!(front(&points, 0.0), [0, 1, 5]);
        assert!(front::<3>(&[], 0.0).is_empty());
        // With one memory for all it is the front of two.
        let flat = [[1.0, 3.0], [2.0, 2.0], [2.0, 1.0], [3.0, 1.0], [4.0, 0.5]];
        assert_eq!(front(&flat.map(|[t, e]| [t, 7.0, e]), 0.0), front(&flat, 0.0));
        // A tie in error is on the front where it saves memory, and not else.
        let ties = [[1.0, 2.0, 3.0], [2.0, 1.0, 2.999], [3.0, 2.0, 2.998]];
        assert_eq!(front(&ties, 0.01), [0, 1]);
        assert_eq!(front(&ties, 0.0), [0, 1, 2]);
    }

    #[test]
    fn by_hand() {
        let points = [[1.0, 3.0], [2.0, 2.0], [2.0, 1.0], [3.0, 1.0], [0.5, f64::NAN], [4.0, 0.5]];
        assert_eq!(front(&points, 0.0), [0, 2, 5]);
        assert!(front::<2>(&[], 0.0).is_empty());
        assert_eq!(front(&[[1.0, 1.0], [1.0, 1.0]], 0.0), [0]);
        // The sixth digit at four times the time is no better error; many small steps down are one in the end.
        let ties = [[1.0, 1.0], [4.0, 0.999_999], [5.0, 0.995], [6.0, 0.985]];
        assert_eq!(front(&ties, 0.01), [0, 3]);
        assert_eq!(front(&ties, 0.0), [0, 1, 2, 3]);
    }
}
