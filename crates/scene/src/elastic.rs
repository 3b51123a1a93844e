//! The elasticity tensor 𝒜 of a body or region: by two numbers, by moduli along the axes, or in full.

use vhi::law::{FourthOrder, Isotropic};

use super::diagnostic::Result;
use super::reading::Reading;
use super::spans::join;
use super::wording::heading;
use files::digits;

/// Kinds of the table `elasticity` with their keys.
pub(super) const TENSORS: [(&str, &str); 2] =
    [("full", "mandel"), ("orthotropic", "normal coupling shear")];

/// Exactly one of the pairs (lambda, mu_L) and (E, nu), or the table `elasticity`, in `[material]` or a region.
pub(super) fn elastic(reading: &Reading, key: &str, dimension: usize) -> Result<FourthOrder> {
    let names = ["lambda", "mu_L", "E", "nu", "elasticity"].into_iter();
    let given: Vec<&str> = names.filter(|name| reading.has(&join(key, name))).collect();
    match given[..] {
        ["lambda", "mu_L"] => elliptic(reading, key, dimension),
        ["E", "nu"] => from_young(reading, key),
        ["elasticity"] => full(reading, &join(key, "elasticity"), dimension),
        _ => {
            let list = if given.is_empty() { "nothing".to_string() } else { given.join(", ") };
            let part = heading(key);
            let message = format!("{part} gives {list}: elasticity needs exactly one pair");
            let hint = "give lambda and mu_L, or E and nu, or elasticity = { kind = \"full\", … }";
            Err(reading.error(key, message, hint))
        }
    }
}

/// m_𝒜 > 0: the eigenvalues 2 mu and 2 mu + d lambda of 𝒜 on S^d are positive.
fn elliptic(reading: &Reading, key: &str, dimension: usize) -> Result<FourthOrder> {
    let lambda = reading.finite(&join(key, "lambda"))?;
    // Half of the eigenvalue 2 mu_L of the elasticity tensor.
    let mu = reading.positive(&join(key, "mu_L"))?;
    let d = dimension as f64;
    let eigenvalue = 2.0 * mu + d * lambda;
    let message = format!(
        "2 mu_L + {dimension} lambda = {eigenvalue} is not positive: this eigenvalue of the elasticity tensor must be"
    );
    let hint = format!("give lambda > {}", -2.0 * mu / d);
    reading.refuse_if(eigenvalue <= 0.0, &join(key, "lambda"), message, hint)?;
    Ok(Isotropic { lambda, mu }.into())
}

/// Plane strain: λ = E ν/((1+ν)(1-2ν)), μ = E/(2(1+ν)).
fn from_young(reading: &Reading, key: &str) -> Result<FourthOrder> {
    let young = reading.positive(&join(key, "E"))?;
    let hint = "at 0.5 the material is incompressible: give less, such as 0.3";
    let fits = |poisson: f64| poisson > -1.0 && poisson < 0.5;
    let poisson = reading.number(&join(key, "nu"), fits, ["is outside (-1, 0.5)", hint])?;
    let lambda = young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson));
    Ok(Isotropic { lambda, mu: young / (2.0 * (1.0 + poisson)) }.into())
}

/// `{ kind = "full", mandel = [[…], …] }`, or `{ kind = "orthotropic", normal = […], coupling = […], shear = […] }`
/// with 𝒜_iiii, 𝒜_iijj and 𝒜_ijij along the axes, pairs in the order 12 in the plane and 23, 13, 12 in space.
fn full(reading: &Reading, key: &str, dimension: usize) -> Result<FourthOrder> {
    let (matrix, place) = if reading.kind(key, &TENSORS)? == "full" {
        let place = join(key, "mandel");
        (mandel(reading, &place, dimension * (dimension + 1) / 2)?, place)
    } else {
        (orthotropic(reading, key, dimension)?, key.to_string())
    };
    let tensor = FourthOrder::Full(matrix);
    let (smallest, _) = tensor.eigenvalues(dimension);
    let message = format!(
        "the elasticity tensor is not positive definite: its smallest eigenvalue m_A is {}",
        digits(smallest, 7)
    );
    let hint = "an elastic energy must be positive for every strain: raise the diagonal entries, or lower what couples them";
    // NaN is refused.
    let positive = smallest > 0.0;
    reading.refuse_if(!positive, &place, message, hint).map(|()| tensor)
}

fn mandel(reading: &Reading, place: &str, order: usize) -> Result<[[f64; 6]; 6]> {
    let hint = format!(
        "a full elasticity tensor is a {order} by {order} matrix here, in Mandel notation: xx, yy, sqrt(2) xy in the plane; xx, yy, zz, sqrt(2) yz, sqrt(2) xz, sqrt(2) xy in space"
    );
    let rows = reading.matrix(place, order, &hint)?;
    reading.symmetric(place, &rows)?;
    let mut matrix = [[0.0; 6]; 6];
    for (of_matrix, row) in matrix.iter_mut().zip(&rows) {
        of_matrix[..order].copy_from_slice(row);
    }
    Ok(matrix)
}

fn orthotropic(reading: &Reading, key: &str, d: usize) -> Result<[[f64; 6]; 6]> {
    let pairs: &[(usize, usize)] = if d == 2 { &[(0, 1)] } else { &[(1, 2), (0, 2), (0, 1)] };
    let hint = "normal = [A_xxxx, A_yyyy], coupling = [A_xxyy], shear = [A_xyxy] in the plane; three each, pairs in the order yz, xz, xy, in space";
    let list = |name: &str, count: usize| reading.numbers(&join(key, name), count, hint);
    let normal = list("normal", d)?;
    let coupling = list("coupling", pairs.len())?;
    let shear = list("shear", pairs.len())?;
    let mut matrix = [[0.0; 6]; 6];
    for (i, value) in normal.into_iter().enumerate() {
        matrix[i][i] = value;
    }
    for (at, &(i, j)) in pairs.iter().enumerate() {
        (matrix[i][j], matrix[j][i]) = (coupling[at], coupling[at]);
        // σ_ij = 2 𝒜_ijij ε_ij, which also holds for √2 times both.
        matrix[d + at][d + at] = 2.0 * shear[at];
    }
    Ok(matrix)
}
