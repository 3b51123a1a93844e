use super::*;

const LAW: Isotropic = Isotropic { lambda: 1.3, mu: 0.7 };

fn full(d: usize) -> FourthOrder {
    FourthOrder::Full(FourthOrder::from(LAW).block(d))
}

/// An isotropic tensor equals its full matrix, in both dimensions.
#[test]
fn both_forms_of_an_isotropic_tensor_agree() {
    for d in [2, 3] {
        let (a, b) = (FourthOrder::from(LAW), full(d));
        let ((low, high), (own_low, own_high)) = (a.eigenvalues(d), b.eigenvalues(d));
        assert!((low - own_low).abs() < 1e-13 && (high - own_high).abs() < 1e-13);
        assert!((a.entry_sum(d) - b.entry_sum(d)).abs() < 1e-13);
    }
    let strain = [0.1, -0.4, 0.25, 0.3, 0.2, -0.1];
    let (a, b) = (LAW.apply(&strain), full(3).apply(&strain));
    assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-15));
    let plane = [0.1, -0.4, 0.25];
    let (a, b) = (LAW.apply(&plane), full(2).apply(&plane));
    assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-15));
}

/// By hand: λ + 2μ and λ on the block of normal strains, 2μ for shears.
#[test]
fn matrices_are_those_of_lame_numbers() {
    let plane = [[2.7, 1.3, 0.0], [1.3, 2.7, 0.0], [0.0, 0.0, 1.4]];
    let close = |found: [[f64; 3]; 3]| {
        let pairs = found.as_flattened().iter().zip(plane.as_flattened());
        pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) < 1e-15
    };
    assert!(close(FourthOrder::from(LAW).matrix()) && close(full(2).matrix()));
    let soft = Isotropic { lambda: 0.1, mu: 0.2 };
    let field = TensorField::new(soft.into(), [full(2)]);
    assert!(close(field.on(1).matrix()) && !close(field.on(0).matrix()) && !field.is_uniform());
    assert!(close(TensorField::from(LAW).on(1).matrix()) && TensorField::from(LAW).is_uniform());
    assert_eq!(field.regions(), &[soft.into(), full(2)]);
    // Seventeen entries: four of the normal strains, and 2μ/2 for each of the four shears.
    let sum = 2.0 * (2.7 + 1.3) + 4.0 * 0.7;
    assert!((full(2).entry_sum(2) - sum).abs() < 1e-14);
    assert!((field.entry_sum(2) - sum).abs() < 1e-14);
    // Eigenvalues 2(λ + μ) and 2μ in the plane; the larger region gives the norm.
    assert!((field.norm(2) - 4.0).abs() < 1e-14);
    assert!((field.scaled(-3.0).norm(2) - 12.0).abs() < 1e-13);
}

#[test]
fn a_factor_multiplies_every_number() {
    let soft = Isotropic { lambda: 0.1, mu: 0.2 };
    let field = TensorField::new(soft.into(), [full(3)]).scaled(3.0);
    let FourthOrder::Isotropic(isotropic) = field.on(0) else { panic!("isotropic") };
    assert!((isotropic.lambda - 0.3).abs() < 1e-15 && (isotropic.mu - 0.6).abs() < 1e-15);
    let strain = [0.1, -0.4, 0.25, 0.3, 0.2, -0.1];
    let (found, once) = (field.on(1).apply(&strain), LAW.apply(&strain));
    assert!(found.iter().zip(once).all(|(a, b)| (a - 3.0 * b).abs() < 1e-14));
}

/// In space a full matrix has six eigenvalues: 3λ + 2μ once, 2μ five times, with one stiffer shear.
#[test]
fn eigenvalues_in_space_are_those_of_six_rows() {
    let FourthOrder::Full(mut matrix) = full(3) else { panic!("full") };
    matrix[5][5] = 9.0;
    let (low, high) = FourthOrder::Full(matrix).eigenvalues(3);
    assert!((low - 1.4).abs() < 1e-14 && (high - 9.0).abs() < 1e-14, "{low} {high}");
}

/// By hand: [[2, 1], [1, 2]] has 1 and 3, the shear entry is 5.
#[test]
fn eigenvalues_of_a_full_matrix() {
    let mut matrix = [[0.0; 6]; 6];
    (matrix[0][0], matrix[1][1], matrix[2][2]) = (2.0, 2.0, 5.0);
    (matrix[0][1], matrix[1][0]) = (1.0, 1.0);
    let (low, high) = FourthOrder::Full(matrix).eigenvalues(2);
    assert!((low - 1.0).abs() < 1e-14 && (high - 5.0).abs() < 1e-14);
    matrix[0][2] = 3.0;
    matrix[2][0] = 3.0;
    assert!(FourthOrder::Full(matrix).eigenvalues(2).0 < 0.0);
}

#[test]
fn regions_keep_their_own_tensors() {
    let soft = Isotropic { lambda: 0.1, mu: 0.2 };
    let field = TensorField::new(LAW.into(), [soft.into()]);
    assert_eq!(field.on(1), &FourthOrder::Isotropic(soft));
    let ((low, high), expected) = (field.eigenvalues(2), (0.4, 4.0));
    assert!((low - expected.0).abs() < 1e-15 && (high - expected.1).abs() < 1e-15);
    assert_eq!(TensorField::from(LAW).on(7), &FourthOrder::Isotropic(LAW));
    let sum = field.plus(2.0, &TensorField::from(soft), 2);
    let FourthOrder::Isotropic(sum) = sum.on(1) else { panic!("isotropic") };
    assert!((sum.lambda - 0.3).abs() < 1e-15 && (sum.mu - 0.6).abs() < 1e-15);
    let mixed = field.plus(1.0, &full(2).into(), 2);
    let twice = LAW.apply(&[1.0, 0.0, 0.5]).map(|s| 2.0 * s);
    let found = mixed.on(0).apply(&[1.0, 0.0, 0.5]);
    assert!(twice.iter().zip(found).all(|(a, b)| (a - b).abs() < 1e-14));
}

#[test]
fn a_multiple_is_one_on_every_region() {
    let twice = |law: Isotropic| Isotropic { lambda: 2.0 * law.lambda, mu: 2.0 * law.mu };
    let soft = Isotropic { lambda: 0.1, mu: 0.2 };
    let field = TensorField::new(LAW.into(), [soft.into()]);
    assert_eq!(field.map(twice).multiple_of(&field), Some(2.0));
    // The last digit may differ: 7 · 0.3/0.3 is not 7 in doubles; a millionth may not.
    let third = Isotropic { lambda: 0.6, mu: 0.3 };
    let large = |by: f64| {
        let stiff = |law: Isotropic| Isotropic { lambda: by * law.lambda, mu: by * law.mu };
        TensorField::new(stiff(LAW).into(), [stiff(third).into()])
    };
    let seven = 7.0 * 2f64.powi(30);
    let of_large = |field: &TensorField| field.multiple_of(&large(1.0));
    assert_eq!(of_large(&large(seven)), Some(seven));
    assert_ne!((seven * 0.3) / 0.3, seven);
    let next = large(1.000_001 * seven);
    assert_eq!(of_large(&TensorField::new(*large(seven).on(0), [*next.on(1)])), None);
    let other = TensorField::new(twice(LAW).into(), [soft.into()]);
    assert_eq!(other.multiple_of(&field), None);
    assert_eq!(TensorField::from(LAW).multiple_of(&full(2).into()), None);
}
