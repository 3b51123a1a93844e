//! The runs that no other run beats in both error and time.

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn by_hand() {
        let points = [(1.0, 3.0), (2.0, 2.0), (2.0, 1.0), (3.0, 1.0), (0.5, f64::NAN), (4.0, 0.5)];
        assert_eq!(front(&points), [0, 2, 5]);
        assert!(front(&[]).is_empty());
        assert_eq!(front(&[(1.0, 1.0), (1.0, 1.0)]), [0]);
    }
}
