use gronwall_algebra::linalg::*;

#[test]
fn the_order_is_a_permutation_and_keeps_components_together() {
    let cells: Vec<u32> = (0..98).flat_map(|i| [i, i + 1, i + 2]).collect();
    let pattern = BlockPattern::new(&cells, 3, 2, 100);
    let coordinates: Vec<f64> = (0..200).map(|i| f64::from(i / 2)).collect();
    let order = nested_dissection(&pattern, &coordinates, &[]);
    let mut seen = order.clone();
    seen.sort_unstable();
    assert!(seen.iter().enumerate().all(|(i, &dof)| i as u32 == dof));
    assert!(order.chunks(2).all(|pair| pair[0] % 2 == 0 && pair[1] == pair[0] + 1));
    let order = nested_dissection(&pattern, &coordinates, &[81, 3, 140]);
    assert_eq!(order[194..], [2, 80, 141, 81, 3, 140]);
    let mut seen = order.clone();
    seen.sort_unstable();
    assert!(seen.iter().enumerate().all(|(i, &dof)| i as u32 == dof));
}
