//! The runs that no other run beats in error and time, and in error, time and memory.

/// Indices of the points (cost, error) that no other point dominates: none is as good in both and better in one.
/// They are sorted by cost; of equal points the first is kept. A point that is not finite is not on the front.
pub fn front(points: &[(f64, f64)]) -> Vec<usize> {
    let mut order: Vec<usize> =
        (0..points.len()).filter(|&i| points[i].0.is_finite() && points[i].1.is_finite()).collect();
    order.sort_by(|&a, &b| {
        let (a, b) = (points[a], points[b]);
        a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1))
    });
    let mut least = f64::INFINITY;
    order.retain(|&i| {
        let better = points[i].1 < least;
        least = least.min(points[i].1);
        better
    });
    order
}

/// Indices of the points (cost, memory, error) that no other point dominates, in their own order; of equal points the
/// first is kept. A point that is not finite is not on the front.
pub fn front_of_three(points: &[[f64; 3]]) -> Vec<usize> {
    let finite = |i: &usize| points[*i].iter().all(|value| value.is_finite());
    let beats = |a: usize, b: usize| {
        let pairs = || points[a].iter().zip(&points[b]);
        pairs().all(|(a, b)| a <= b) && (pairs().any(|(a, b)| a < b) || a < b)
    };
    let all: Vec<usize> = (0..points.len()).filter(finite).collect();
    all.iter().copied().filter(|&i| !all.iter().any(|&j| j != i && beats(j, i))).collect()
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
        assert_eq!(front_of_three(&points), [0, 1, 5]);
        assert!(front_of_three(&[]).is_empty());
        // With one memory for all it is the front of two.
        let flat = [(1.0, 3.0), (2.0, 2.0), (2.0, 1.0), (3.0, 1.0), (4.0, 0.5)];
        assert_eq!(front_of_three(&flat.map(|(t, e)| [t, 7.0, e])), front(&flat));
    }

    #[test]
    fn by_hand() {
        let points = [(1.0, 3.0), (2.0, 2.0), (2.0, 1.0), (3.0, 1.0), (0.5, f64::NAN), (4.0, 0.5)];
        assert_eq!(front(&points), [0, 2, 5]);
        assert!(front(&[]).is_empty());
        assert_eq!(front(&[(1.0, 1.0), (1.0, 1.0)]), [0]);
    }
}
