//! The runs that no other run beats in error and time, and in error, time and memory.

/// Errors that differ by a smaller part are one: a knob that buys the sixth digit buys nothing.
pub(super) const TIE: f64 = 0.01;

/// Indices of the points (cost, error) that no other point dominates: none is as good in both and better in one. They are
/// sorted by cost; of equal points the first is kept. A point that is not finite is not on the front, nor is one whose
/// error is less than that of a cheaper one by a part of it below `tie`.
pub fn front(points: &[(f64, f64)], tie: f64) -> Vec<usize> {
    let mut order: Vec<usize> =
        (0..points.len()).filter(|&i| points[i].0.is_finite() && points[i].1.is_finite()).collect();
    order.sort_by(|&a, &b| {
        let (a, b) = (points[a], points[b]);
        a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1))
    });
    let mut least = f64::INFINITY;
    order.retain(|&i| {
        let better = points[i].1 < (1.0 - tie) * least;
        if better {
            least = points[i].1;
        }
        better
    });
    order
}

/// Indices of the points (cost, memory, error) that no other point dominates, in the order of `points`; of equal points the
/// first is kept, and of errors that are a tie that of the cheaper run. A point that is not finite is not on the front.
pub(crate) fn front_of_three(points: &[[f64; 3]], tie: f64) -> Vec<usize> {
    let finite = |i: &usize| points[*i].iter().all(|value| value.is_finite());
    let mut order: Vec<usize> = (0..points.len()).filter(finite).collect();
    order.sort_by(|&a, &b| {
        let both = points[a].iter().zip(&points[b]);
        both.map(|(a, b)| a.total_cmp(b)).find(|order| order.is_ne()).unwrap_or(a.cmp(&b))
    });
    let mut kept: Vec<usize> = Vec::new();
    for i in order {
        // Those before it cost no more.
        let beaten = kept.iter().any(|&j| {
            let ([_, less, good], [_, memory, error]) = (points[j], points[i]);
            less <= memory && error >= (1.0 - tie) * good
        });
        if !beaten {
            kept.push(i);
        }
    }
    kept.sort_unstable();
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
        assert_eq!(front_of_three(&points, 0.0), [0, 1, 5]);
        assert!(front_of_three(&[], 0.0).is_empty());
        // With one memory for all it is the front of two.
        let flat = [(1.0, 3.0), (2.0, 2.0), (2.0, 1.0), (3.0, 1.0), (4.0, 0.5)];
        assert_eq!(front_of_three(&flat.map(|(t, e)| [t, 7.0, e]), 0.0), front(&flat, 0.0));
        // A tie in error is on the front where it saves memory, and not else.
        let ties = [[1.0, 2.0, 3.0], [2.0, 1.0, 2.999], [3.0, 2.0, 2.998]];
        assert_eq!(front_of_three(&ties, 0.01), [0, 1]);
        assert_eq!(front_of_three(&ties, 0.0), [0, 1, 2]);
    }

    #[test]
    fn by_hand() {
        let points = [(1.0, 3.0), (2.0, 2.0), (2.0, 1.0), (3.0, 1.0), (0.5, f64::NAN), (4.0, 0.5)];
        assert_eq!(front(&points, 0.0), [0, 2, 5]);
        assert!(front(&[], 0.0).is_empty());
        assert_eq!(front(&[(1.0, 1.0), (1.0, 1.0)], 0.0), [0]);
        // The sixth digit at four times the time is no better error; many small steps down are one in the end.
        let ties = [(1.0, 1.0), (4.0, 0.999_999), (5.0, 0.995), (6.0, 0.985)];
        assert_eq!(front(&ties, 0.01), [0, 3]);
        assert_eq!(front(&ties, 0.0), [0, 1, 2, 3]);
    }
}
