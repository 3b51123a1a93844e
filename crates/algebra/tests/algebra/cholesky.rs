use gronwall_algebra::linalg::*;

fn laplacian() -> (BlockPattern, Vec<f64>, Vec<f64>) {
    let cells: Vec<u32> = (0..28).flat_map(|i| [i, i + 1, i + 2]).collect();
    let pattern = BlockPattern::new(&cells, 3, 2, 30);
    let mut values = vec![0.0; pattern.entries()];
    for dof in 0..60 {
        values[pattern.diagonal(dof)] = 5.0;
        if dof >= 2 {
            values[pattern.position(dof, dof - 2).expect("neighbours")] = -1.0;
        }
    }
    (pattern, values, (0..60).map(|i| f64::from(i / 2)).collect())
}

#[test]
fn solves_with_two_right_sides() {
    let (pattern, values, coordinates) = laplacian();
    let analysis =
        Analysis::new(&pattern, &nested_dissection(&pattern, &coordinates, &[])).unwrap();
    let (mut factor, mut workspace) = (analysis.factor(), analysis.workspace());
    analysis.factorize(&pattern, &values, &mut factor, &mut workspace).unwrap();
    let x: Vec<f64> = (0..120).map(|i| f64::from(i % 7) - 3.0).collect();
    let mut front = Front::default();
    let mut both = vec![0.0; 120];
    for (x, both) in x.chunks(60).zip(both.chunks_mut(60)) {
        pattern.multiply(&values, x, both);
        let mut one = both.to_vec();
        analysis.solve(&factor, &mut one, &mut front);
        assert!(one.iter().zip(x).all(|(p, q)| (p - q).abs() < 1e-14));
    }
    analysis.solve(&factor, &mut both, &mut front);
    assert!(both.iter().zip(&x).all(|(p, q)| (p - q).abs() < 1e-14));
}

/// The last triangle is the factor of the Schur complement; what is held on the last unknowns moves the others by
/// backward substitution.
#[test]
fn the_last_triangle_condenses() {
    let (pattern, values, coordinates) = laplacian();
    let last = [21, 3, 37, 59, 40];
    let order = nested_dissection(&pattern, &coordinates, &last);
    let analysis = Analysis::new(&pattern, &order).unwrap();
    let (mut factor, mut workspace) = (analysis.factor(), analysis.workspace());
    analysis.factorize(&pattern, &values, &mut factor, &mut workspace).unwrap();
    let (size, mut front) = (last.len(), Front::default());
    let first = 60 - size;
    let triangle = analysis.last_triangle(&factor, first);
    let l = |i: usize, j: usize| if j <= i { triangle[size * j + i] } else { 0.0 };
    let held: Vec<f64> = (0..size).map(|i| (i as f64 * 0.7).sin() + 2.0).collect();
    // What holds them: forces on the last unknowns alone, S times the displacements.
    let transposed = |j: usize| -> f64 { (j..size).map(|i| l(i, j) * held[i]).sum() };
    let schur: Vec<f64> =
        (0..size).map(|i| (0..size).map(|j| l(i, j) * transposed(j)).sum()).collect();
    let mut x = vec![0.0; 60];
    (0..size).for_each(|j| x[first + j] = transposed(j));
    analysis.backward(&factor, &mut x, &mut front);
    let mut u = vec![0.0; 60];
    order.iter().zip(&x).for_each(|(&dof, x)| u[dof as usize] = *x);
    let mut force = vec![0.0; 60];
    pattern.multiply(&values, &u, &mut force);
    for (i, &dof) in order.iter().enumerate() {
        let wanted = if i < first { 0.0 } else { schur[i - first] };
        assert!((force[dof as usize] - wanted).abs() < 1e-13, "{i}: {wanted}");
        assert!(i < first || (x[i] - held[i - first]).abs() < 1e-14, "{i}");
    }
}

/// A band matrix of half width 4 in natural order: columns of length 5, shorter at the end.
#[test]
fn multiplications_of_a_band_matrix() {
    let (pattern, ..) = laplacian();
    let natural: Vec<u32> = (0..60).collect();
    let analysis = Analysis::new(&pattern, &natural).unwrap();
    // Blocks of two couple to the next two nodes: column j reaches row 2⌊j/2⌋ + 5.
    let length = |j: usize| (2 * (j / 2) + 6).min(60) - j;
    let exact: f64 = (0..60).map(|j| (length(j) as f64).powi(2)).sum();
    let found = analysis.multiplications();
    // Supernodes store zeros, at most those of the full triangle.
    let full: f64 = (1..=60).map(|length| f64::from(length).powi(2)).sum();
    assert!(found >= exact && found <= full, "{found} {exact} {full}");
}

#[test]
fn an_indefinite_matrix_names_its_unknown() {
    let (pattern, values, coordinates) = laplacian();
    let analysis =
        Analysis::new(&pattern, &nested_dissection(&pattern, &coordinates, &[])).unwrap();
    let (mut factor, mut workspace) = (analysis.factor(), analysis.workspace());
    for dof in 0..60 {
        let mut bad = values.clone();
        bad[pattern.diagonal(dof)] = -1.0;
        let error = analysis.factorize(&pattern, &bad, &mut factor, &mut workspace);
        assert_eq!(error, Err(FactorError::NotPositiveDefinite { dof }));
    }
    let mut bad = values;
    bad[3] = f64::NAN;
    let error = analysis.factorize(&pattern, &bad, &mut factor, &mut workspace);
    assert_eq!(error, Err(FactorError::NotFinite));
}
