//! Moments of fields Σ_m f_m(x, t) g_m(y) on a mesh in rows: integrals over cells are products of matrices, columns by
//! points by rows, and the squares of what P1 functions cannot have are sums over columns times sums over rows.

use std::sync::Arc;

use nalgebra::DMatrix;

use super::bound_products::{AlongX, BoundProducts, Field, Fields, TENSOR, Term, Values};
use super::lanes::WIDTH;
use super::part_moments::{PartFamily, PartMoments};
use super::parts::Parts;
use super::products::Products;
use super::rows::{HALVES, Rows, width};
use crate::norms::linear_projection;
use crate::space::quadrature::Rule;

/// Corners of a triangle.
const CORNERS: usize = 3;

/// Products at the points of a rule on a mesh in rows.
pub(super) struct OnRows {
    rows: Rows,
    /// Of all its cells.
    region: usize,
    rule: Rule,
    products: BoundProducts,
    /// Distance of each point from the centroid of its cell, along either axis.
    from_centre: [Values; 2],
}

impl OnRows {
    /// Binds products to the points of `rule` on rows of one region; `along_x` are those of [`Self::along_x`].
    pub fn new(
        products: &Products,
        along_x: Arc<AlongX>,
        rows: Rows,
        region: usize,
        rule: &Rule,
    ) -> Self {
        let y = rows.y.each_ref().map(|corners| at_points(corners, rule));
        let from_centre = [(&along_x.at, rows.columns), (&y, rows.rows)]
            .map(|(at, count)| at.each_ref().map(|at| minus(at, &mean(at, count, &rule.weights))));
        let products = BoundProducts::new(products, along_x, &y);
        Self { rows, region, rule: rule.clone(), products, from_centre }
    }

    /// What all rows have in common.
    pub fn along_x(products: &Products, rows: &Rows, rule: &Rule) -> Arc<AlongX> {
        let x = rows.x.each_ref().map(|corners| at_points(corners, rule));
        Arc::new(AlongX::new(products, x))
    }

    /// Moments of u, ε and σ of all parts; none if a number is not finite.
    pub fn moments(&self, parts: &Parts<'_>, products: &Products) -> Option<PartMoments> {
        let fields = self.products.fields(parts, self.region, products)?;
        let cells = HALVES * self.rows.columns * self.rows.rows;
        let lengths = [TENSOR * cells, 2 * CORNERS * cells];
        let tensors = |of: fn(&Fields) -> &[Field; TENSOR]| {
            self.tensors(&fields.iter().map(of).collect::<Vec<_>>())
        };
        let strain = tensors(|part| &part.strain)?;
        let stress = tensors(|part| &part.stress)?;
        let all: Vec<&[Field; 2]> = fields.iter().map(|part| &part.displacement).collect();
        let displacement = self.vectors(&all)?;
        Some(PartMoments { strain, stress, displacement, lengths })
    }

    /// The means of σ alone, to the last bit those of [`Self::moments`].
    pub fn stress_means(&self, parts: &Parts<'_>, products: &Products) -> Option<Vec<Vec<f64>>> {
        let fields = self.products.fields(parts, self.region, products)?;
        let means = fields.iter().map(|part| self.by_cell(&self.means(&part.stress)));
        means.map(finite).collect()
    }

    /// ∫ of a field times each of some functions over all cells of a half, over the cells' area: one function after the
    /// other, and of each row by row. `tests` are the functions at the points, times weights.
    fn integrals(&self, field: &Field, half: usize, tests: &[Vec<f64>]) -> Vec<f64> {
        let (columns, rows, points) = (self.rows.columns, self.rows.rows, self.rule.weights.len());
        let inner = points * field.len();
        let mut left = Vec::with_capacity(columns * inner);
        field.iter().for_each(|term| left.extend_from_slice(&term.f[half]));
        let mut right = Vec::with_capacity(inner * rows * tests.len());
        for test in tests {
            for j in 0..rows {
                for term in field {
                    let g = &self.products.along_y[term.m][half];
                    right.extend(
                        test.iter().enumerate().map(|(q, weight)| weight * g[rows * q + j]),
                    );
                }
            }
        }
        let left = DMatrix::from_vec(columns, inner, left);
        let right = DMatrix::from_vec(inner, rows * tests.len(), right);
        (left * right).data.into()
    }

    /// The means of some fields.
    fn means(&self, fields: &[Field]) -> Vec<Values> {
        let weights = std::slice::from_ref(&self.rule.weights);
        let of = |field| [0, 1].map(|half| self.integrals(field, half, weights));
        fields.iter().map(of).collect()
    }

    /// Numbers given field by field, each row by row: cell by cell.
    fn by_cell(&self, fields: &[Values]) -> Vec<f64> {
        let (squares, count) = (self.rows.columns * self.rows.rows, fields.len());
        let mut all = vec![0.0; HALVES * squares * count];
        for (k, field) in fields.iter().enumerate() {
            for (half, values) in field.iter().enumerate() {
                let own = all[count * half + k..].iter_mut().step_by(HALVES * count);
                own.zip(values).for_each(|(own, value)| *own = *value);
            }
        }
        all
    }

    /// Means and products of what differs from them, of a tensor field of each part.
    fn tensors(&self, parts: &[&[Field; TENSOR]]) -> Option<PartFamily> {
        let means: Vec<Vec<Values>> = parts.iter().map(|part| self.means(*part)).collect();
        let mut sum = Differences::new(parts.len());
        for half in 0..HALVES {
            for k in 0..TENSOR {
                // f g = f̄ ḡ + f̄ (g - ḡ) + (f - f̄) g, and of the first nothing is left.
                let own = parts.iter().zip(&means).map(|(part, means)| {
                    let (mut terms, mut left) = (Vec::new(), means[k][half].clone());
                    for term in &part[k] {
                        let [f, g] = [&term.f[half], &self.products.along_y[term.m][half]];
                        let [f_mean, g_mean] = [self.mean_x(f), self.mean_y(g)];
                        for (j, row) in left.chunks_exact_mut(self.rows.columns).enumerate() {
                            row.iter_mut()
                                .zip(&f_mean)
                                .for_each(|(left, f)| *left -= f * g_mean[j]);
                        }
                        let flat = f_mean.repeat(self.rule.weights.len());
                        let [f_left, g_left] = [minus(f, &f_mean), minus(g, &g_mean)];
                        terms.extend([(flat, g_left), (f_left, g.clone())]);
                    }
                    (terms, vec![left])
                });
                let own: Vec<Centred> = own.collect();
                self.add_differences(half, &own, 1.0, &mut sum);
            }
        }
        let vectors = means.iter().map(|means| finite(self.by_cell(means)));
        sum.family(vectors.collect::<Option<_>>()?)
    }

    /// Linear projections by their values at the corners, and products of what differs from them, of u of each part.
    fn vectors(&self, parts: &[&[Field; 2]]) -> Option<PartFamily> {
        let squares = self.rows.columns * self.rows.rows;
        let tests: Vec<Vec<f64>> = (0..CORNERS)
            .map(|a| {
                self.rule.weights.iter().zip(&self.rule.points).map(|(w, b)| w * b[a]).collect()
            })
            .collect();
        let mut vectors = vec![vec![0.0; 2 * CORNERS * HALVES * squares]; parts.len()];
        let mut sum = Differences::new(parts.len());
        for half in 0..HALVES {
            for i in 0..2 {
                let own = parts.iter().zip(&mut vectors).map(|(part, vector)| {
                    let moments = self.integrals(&part[i], half, &tests);
                    let mut corners = vec![vec![0.0; squares]; CORNERS];
                    let cells = vector.chunks_exact_mut(2 * CORNERS).skip(half).step_by(HALVES);
                    for (square, cell) in cells.enumerate() {
                        let moment = [0, 1, 2].map(|a| moments[squares * a + square]);
                        let mut corner = [0.0; CORNERS];
                        linear_projection(&moment, &mut corner);
                        for a in 0..CORNERS {
                            corners[a][square] = corner[a];
                            cell[2 * a + i] = corner[a];
                        }
                    }
                    let mut terms = Vec::new();
                    for term in &part[i] {
                        terms.extend(self.beyond_linear(term, half, &mut corners));
                    }
                    // Σ_a v_a² + (Σ_a v_a)² of the values at the corners is 12 times the square over the area.
                    let total = (0..squares).map(|s| corners[0][s] + corners[1][s] + corners[2][s]);
                    let total = total.collect();
                    corners.push(total);
                    (terms, corners)
                });
                let own: Vec<Centred> = own.collect();
                self.add_differences(half, &own, 1.0 / 12.0, &mut sum);
            }
        }
        sum.family(vectors.into_iter().map(finite).collect::<Option<_>>()?)
    }

    /// f g without the linear part that f and g have in each cell, as products; that part is taken from `corners`.
    ///
    /// With f = f̄ + f' ξ + f̂ and g = ḡ + g' η + ĝ it is f' ξ g' η + (f̄ + f' ξ) ĝ + f̂ g.
    fn beyond_linear(&self, term: &Term, half: usize, corners: &mut [Vec<f64>]) -> [Along; 3] {
        let columns = self.rows.columns;
        let [f, g] = [&term.f[half], &self.products.along_y[term.m][half]];
        let [xi, eta] = self.from_centre.each_ref().map(|axis| &axis[half]);
        let [f_mean, g_mean] = [self.mean_x(f), self.mean_y(g)];
        let weights = &self.rule.weights;
        let [f_slope, g_slope] =
            [slope(f, xi, f_mean.len(), weights), slope(g, eta, g_mean.len(), weights)];
        let [x, y] = [&self.rows.x[half], &self.rows.y[half]];
        let centre = |at: &[f64; CORNERS]| at.iter().sum::<f64>() / CORNERS as f64;
        for (a, corner) in corners.iter_mut().enumerate() {
            let at_x = |i: usize| f_mean[i] + f_slope[i] * (x[i][a] - centre(&x[i]));
            let at_x: Vec<f64> = (0..columns).map(at_x).collect();
            for (j, row) in corner.chunks_exact_mut(columns).enumerate() {
                let along_y = g_slope[j] * (y[j][a] - centre(&y[j]));
                for ((left, close), mean) in row.iter_mut().zip(&at_x).zip(&f_mean) {
                    *left -= close * g_mean[j] + mean * along_y;
                }
            }
        }
        let [f_linear, g_linear] = [times(xi, &f_slope), times(eta, &g_slope)];
        let difference =
            |a: &[f64], b: &[f64]| -> Vec<f64> { a.iter().zip(b).map(|(a, b)| a - b).collect() };
        let f_left = difference(&minus(f, &f_mean), &f_linear);
        let g_left = difference(&minus(g, &g_mean), &g_linear);
        let f_close = difference(f, &f_left);
        [(f_linear, g_linear), (f_close, g_left), (f_left, g.clone())]
    }

    fn mean_x(&self, f: &[f64]) -> Vec<f64> {
        mean(f, self.rows.columns, &self.rule.weights)
    }

    fn mean_y(&self, g: &[f64]) -> Vec<f64> {
        mean(g, self.rows.rows, &self.rule.weights)
    }

    /// Σ over columns, rows and points of the product of two products, each point with its weight.
    fn product(&self, (f, g): &Along, (other_f, other_g): &Along) -> f64 {
        let mut sum = 0.0;
        for (q, weight) in self.rule.weights.iter().enumerate() {
            let [i, j] = [self.rows.columns, self.rows.rows].map(|n| n * q..n * (q + 1));
            let along_x = dot(&f[i.clone()], &other_f[i]);
            sum += weight * along_x * dot(&g[j.clone()], &other_g[j]);
        }
        sum
    }

    /// Adds Σ |K| (Σ_q w_q d_m d_l - `scale` Σ_v c_mv c_lv) over the cells of a half for all pairs of parts, d being the
    /// sum of products and c_v the numbers of a cell.
    fn add_differences(&self, half: usize, parts: &[Centred], scale: f64, sum: &mut Differences) {
        let x: Vec<f64> = self.rows.x[half].iter().map(width).collect();
        let y: Vec<f64> = self.rows.y[half].iter().map(width).collect();
        let columns = x.len();
        for (m, (terms, cells)) in parts.iter().enumerate() {
            let scaled: Vec<Along> =
                terms.iter().map(|(f, g)| (times(f, &x), times(g, &y))).collect();
            for (l, (others, other_cells)) in parts.iter().enumerate().skip(m) {
                let mut all = 0.0;
                for (r, own) in scaled.iter().enumerate() {
                    // Of a part with itself each pair of terms comes once, and counts twice.
                    let first = if l == m { r } else { 0 };
                    for (s, other) in others.iter().enumerate().skip(first) {
                        let pair = self.product(own, other);
                        all += if l == m && s > r { 2.0 * pair } else { pair };
                    }
                }
                for (own, other) in cells.iter().zip(other_cells) {
                    let pairs = own.chunks_exact(columns).zip(other.chunks_exact(columns));
                    let rows = pairs.zip(&y).map(|((own, other), y)| y * weighted(&x, own, other));
                    all -= scale * rows.sum::<f64>();
                }
                // A triangle is half of its square.
                sum.products[sum.parts * m + l] += 0.5 * all;
            }
        }
    }
}

/// A function along x and one along y, at the points of the rule in all columns and rows of a half.
type Along = (Vec<f64>, Vec<f64>);

/// A part of a field in the cells of a half: what differs from P1 functions, but for numbers of each cell, as products of
/// functions along x and along y; and these numbers, each in all cells row by row.
type Centred = (Vec<Along>, Vec<Vec<f64>>);

/// Products of what cells cannot have of each part, row by row.
struct Differences {
    parts: usize,
    products: Vec<f64>,
}

impl Differences {
    fn new(parts: usize) -> Self {
        Self { parts, products: vec![0.0; parts * parts] }
    }

    /// The family with what cells can have; none if a product is not finite.
    fn family(mut self, vectors: Vec<Vec<f64>>) -> Option<PartFamily> {
        for square in self.products.iter_mut().step_by(self.parts + 1) {
            // Of a field that P1 functions have rounding is left, of either sign.
            if *square < 0.0 {
                *square = 0.0;
            }
        }
        Some(PartFamily { vectors, products: finite(self.products)? })
    }
}

fn finite(values: Vec<f64>) -> Option<Vec<f64>> {
    values.iter().all(|value| value.is_finite()).then_some(values)
}

/// The points of a rule in all columns or rows, one point of the rule after the other.
fn at_points(corners: &[[f64; CORNERS]], rule: &Rule) -> Vec<f64> {
    let at = |b: &[f64], corner: &[f64; CORNERS]| b.iter().zip(corner).map(|(b, x)| b * x).sum();
    rule.points.iter().flat_map(|b| corners.iter().map(|corner| at(b, corner))).collect()
}

/// The means over the points of the rule, of so many columns or rows.
fn mean(values: &[f64], count: usize, weights: &[f64]) -> Vec<f64> {
    let mut mean = vec![0.0; count];
    for (own, weight) in values.chunks_exact(count).zip(weights) {
        mean.iter_mut().zip(own).for_each(|(mean, value)| *mean += weight * value);
    }
    mean
}

/// The slopes of the lines closest to the values in each of so many columns or rows.
fn slope(values: &[f64], from_centre: &[f64], count: usize, weights: &[f64]) -> Vec<f64> {
    let product = |a: &[f64]| {
        let products: Vec<f64> = a.iter().zip(from_centre).map(|(a, b)| a * b).collect();
        mean(&products, count, weights)
    };
    product(values).iter().zip(product(from_centre)).map(|(a, b)| a / b).collect()
}

/// The values less a number of each column or row.
fn minus(values: &[f64], means: &[f64]) -> Vec<f64> {
    each_with_own(values, means, |value, mean| value - mean)
}

/// The values in all columns or rows times a number of each.
fn times(values: &[f64], numbers: &[f64]) -> Vec<f64> {
    each_with_own(values, numbers, |value, number| value * number)
}

/// The values in all columns or rows, each with a number of its own.
fn each_with_own(values: &[f64], numbers: &[f64], with: impl Fn(f64, f64) -> f64) -> Vec<f64> {
    let mut all = Vec::with_capacity(values.len());
    for own in values.chunks_exact(numbers.len()) {
        all.extend(own.iter().zip(numbers).map(|(value, number)| with(*value, *number)));
    }
    all
}

/// Σ a b.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut lanes = [0.0; WIDTH];
    let ((a, a_rest), (b, b_rest)) = (a.as_chunks::<WIDTH>(), b.as_chunks::<WIDTH>());
    for (a, b) in a.iter().zip(b) {
        for l in 0..WIDTH {
            lanes[l] += a[l] * b[l];
        }
    }
    lanes.iter().sum::<f64>() + a_rest.iter().zip(b_rest).map(|(a, b)| a * b).sum::<f64>()
}

/// Σ w a b.
fn weighted(w: &[f64], a: &[f64], b: &[f64]) -> f64 {
    let mut lanes = [0.0; WIDTH];
    let [(w, w_rest), (a, a_rest), (b, b_rest)] = [w, a, b].map(|all| all.as_chunks::<WIDTH>());
    for ((w, a), b) in w.iter().zip(a).zip(b) {
        for l in 0..WIDTH {
            lanes[l] += w[l] * a[l] * b[l];
        }
    }
    let rest = w_rest.iter().zip(a_rest).zip(b_rest).map(|((w, a), b)| w * a * b);
    lanes.iter().sum::<f64>() + rest.sum::<f64>()
}
