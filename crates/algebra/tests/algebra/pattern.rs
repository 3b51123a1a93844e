use gronwall_algebra::linalg::*;

/// Scatter of two cells against a dense sum, with node 3 clamped in the second cell.
#[test]
fn scatter_agrees_with_a_dense_assembly() {
    let cells = [2u32, 0, 1, 1, 3, 2];
    let pattern = BlockPattern::new(&cells, 3, 2, 3);
    let mut values = vec![0.0; pattern.entries()];
    let mut dense = vec![vec![0.0; 6]; 6];
    for c in 0..2 {
        let nodes = &cells[3 * c..3 * c + 3];
        let mut local = [0.0; 36];
        for i in 0..6 {
            for j in 0..6 {
                local[6 * i + j] = (10 * (i + j) + i * j + c) as f64;
            }
        }
        pattern.scatter::<2>(c, nodes, &local, &mut values);
        for i in 0..6 {
            for j in 0..6 {
                let (row, column) =
                    (2 * nodes[i / 2] as usize + i % 2, 2 * nodes[j / 2] as usize + j % 2);
                if row < 6 && column < 6 {
                    dense[row][column] += local[6 * i + j];
                }
            }
        }
    }
    for i in 0..6 {
        for j in 0..=i {
            let at = pattern.position(i, j).expect("coupled nodes");
            assert_eq!(values[at], dense[i][j], "entry {i},{j}");
        }
    }
    let x = [1.0, -2.0, 0.5, 3.0, 0.0, 1.5];
    let mut y = [0.0; 6];
    pattern.multiply(&values, &x, &mut y);
    for i in 0..6 {
        let row: f64 = (0..6).map(|j| dense[i.max(j)][i.min(j)] * x[j]).sum();
        assert!((y[i] - row).abs() < 1e-12 * row.abs().max(1.0));
    }
    let couplings = pattern.couplings(&[3]);
    assert_eq!(couplings[0].len(), 5);
}
