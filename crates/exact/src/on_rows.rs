//! Moments of fields Σ_m f_m(x, t) g_m(y) on a mesh in rows: integrals over cells are products of matrices, columns by
//! places by rows, and the squares of what P1 functions cannot have are sums over columns times sums over rows.

use std::sync::Arc;

use super::bound_products::{AlongX, Field, Fields, TENSOR, Values, along_y};
use super::part_moments::{PartFamily, PartMoments};
use super::parts::Parts;
use super::products::Products;
use super::row_half::{Along, Half, Product, minus};
use super::rows::{CORNERS, HALVES, Rows};
use fem::space::quadrature::Rule;

/// Products at the points of a rule on a mesh in rows.
pub(super) struct OnRows {
    columns: usize,
    rows: usize,
    /// The region of all its cells.
    region: usize,
    along_x: Arc<AlongX>,
    halves: [Half; HALVES],
    /// Whether all g_m are finite in all rows.
    is_finite: bool,
}

impl OnRows {
    /// Binds products to the points of a rule of each half on rows of one region.
    pub(crate) fn new(
        products: &Products,
        along_x: Arc<AlongX>,
        rows: &Rows,
        region: usize,
        rules: &[Rule; HALVES],
    ) -> Self {
        let g = along_y(products, rows, rules);
        let is_finite = g.iter().flatten().flatten().all(|value| value.is_finite());
        let half =
            |half: usize| Half::new(rows, half, along_x.places[half].clone(), &g, &rules[half]);
        let halves = std::array::from_fn(half);
        Self { columns: rows.columns, rows: rows.rows, region, along_x, halves, is_finite }
    }

    fn squares(&self) -> usize {
        self.columns * self.rows
    }

    /// The fields of all parts along x; none if a number is not finite.
    fn fields(&self, parts: &Parts<'_>, products: &Products) -> Option<Vec<Fields>> {
        self.is_finite.then(|| self.along_x.fields(parts, self.region, products))?
    }

    /// Moments of u, ε and σ of all parts; none if a number is not finite.
    pub(crate) fn moments(&self, parts: &Parts<'_>, products: &Products) -> Option<PartMoments> {
        let fields = self.fields(parts, products)?;
        let cells = HALVES * self.squares();
        let lengths = [TENSOR * cells, 2 * CORNERS * cells];
        let tensors = |of: fn(&Fields) -> &[Field; TENSOR]| {
            self.tensors(&fields.iter().map(of).collect::<Vec<_>>())
        };
        let strain = tensors(|part| &part.strain)?;
        let stress = tensors(|part| &part.stress)?;
        let all: Vec<&[Field; 2]> = fields.iter().map(|part| &part.displacement).collect();
        let displacement = self.vectors(&all)?;
        Some(PartMoments { strain, stress, displacement, lengths, by_rows: true })
    }

    /// The means of σ alone, to the last bit those of [`Self::moments`].
    pub(crate) fn stress_means(
        &self,
        parts: &Parts<'_>,
        products: &Products,
    ) -> Option<Vec<Vec<f64>>> {
        let fields = self.fields(parts, products)?;
        let means = fields.iter().map(|part| self.by_cell(&self.means(&part.stress)));
        means.map(finite).collect()
    }

    /// The means of some fields, each row by row.
    fn means(&self, fields: &[Field]) -> Vec<Values> {
        let of = |field: &Field| {
            std::array::from_fn(|half| self.halves[half].means(&terms_of(field, half)))
        };
        fields.iter().map(of).collect()
    }

    /// Numbers given field by field, each row by row: cell by cell.
    fn by_cell(&self, fields: &[Values]) -> Vec<f64> {
        let count = fields.len();
        let mut all = vec![0.0; HALVES * self.squares() * count];
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
        for (number, half) in self.halves.iter().enumerate() {
            for k in 0..TENSOR {
                // f g = f̄ ḡ + f̄ (g - ḡ) + (f - f̄) g, and of the first nothing is left.
                let own = parts.iter().zip(&means).map(|(part, means)| {
                    let all = terms_of(&part[k], number);
                    let constant: Vec<Vec<f64>> = all.iter().map(|(f, _)| half.mean_x(f)).collect();
                    let numbers = constant.iter().zip(&all).map(|(f, &(_, m))| (f.as_slice(), m));
                    let mut left = means[k][number].clone();
                    half.subtract_means(&numbers.collect::<Vec<_>>(), &mut left);
                    let products = all.iter().zip(constant).flat_map(|(&(f, m), mean)| {
                        let varying = minus(f, &mean);
                        [(mean, Along::Varying), (varying, Along::Whole)]
                            .map(|(f, along_y)| Product { f, m, along_y })
                    });
                    (products.collect(), left)
                });
                let own: Vec<Centred> = own.collect();
                sum.add(half, &own, 1.0);
            }
        }
        let vectors = means.iter().map(|means| finite(self.by_cell(means)));
        sum.family(vectors.collect::<Option<_>>()?)
    }

    /// Linear projections by their values at the corners, and products of what differs from them, of u of each part.
    fn vectors(&self, parts: &[&[Field; 2]]) -> Option<PartFamily> {
        let squares = self.squares();
        let mut vectors = vec![vec![0.0; 2 * CORNERS * HALVES * squares]; parts.len()];
        let mut sum = Differences::new(parts.len());
        for (number, half) in self.halves.iter().enumerate() {
            for i in 0..2 {
                let own = parts.iter().zip(&mut vectors).map(|(part, vector)| {
                    let all = terms_of(&part[i], number);
                    let mut corners = half.corners(&all);
                    for (a, values) in corners.chunks_exact(squares).enumerate() {
                        let first = 2 * (CORNERS * number + a) + i;
                        let own = vector[first..].iter_mut().step_by(2 * CORNERS * HALVES);
                        own.zip(values).for_each(|(own, value)| *own = *value);
                    }
                    let terms = beyond_linear(half, &all, &mut corners);
                    // Σ_a v_a² + (Σ_a v_a)² of the values at the corners is 12 times the square over the area.
                    let total =
                        |s: usize| corners[s] + corners[squares + s] + corners[2 * squares + s];
                    let total: Vec<f64> = (0..squares).map(total).collect();
                    corners.extend(total);
                    (terms, corners)
                });
                let own: Vec<Centred> = own.collect();
                sum.add(half, &own, 1.0 / 12.0);
            }
        }
        sum.family(vectors.into_iter().map(finite).collect::<Option<_>>()?)
    }
}

/// The terms of a field in one half.
fn terms_of(field: &Field, half: usize) -> Vec<(&[f64], usize)> {
    field.iter().map(|term| (term.f[half].as_slice(), term.m)).collect()
}

/// Σ_m f g_m without the linear parts that f and g_m have in each cell, as products; these are taken from `corners`.
///
/// With f = f̄ + f' ξ + f̂ and g = ḡ + g' η + ĝ it is f' ξ g' η + (f̄ + f' ξ) ĝ + f̂ g.
fn beyond_linear(half: &Half, terms: &[(&[f64], usize)], corners: &mut [f64]) -> Vec<Product> {
    let lines: Vec<[Vec<f64>; 2]> =
        terms.iter().map(|(f, _)| [half.mean_x(f), half.slope_x(f)]).collect();
    let linear: Vec<([&[f64]; 2], usize)> = lines
        .iter()
        .zip(terms)
        .map(|([mean, slope], &(_, m))| ([mean.as_slice(), slope.as_slice()], m))
        .collect();
    half.subtract_linear(&linear, corners);
    let products = terms.iter().zip(&lines).flat_map(|(&(f, m), [mean, slope])| {
        let linear = half.line_x(slope);
        let left: Vec<f64> = minus(f, mean).iter().zip(&linear).map(|(a, b)| a - b).collect();
        let close = f.iter().zip(&left).map(|(f, left)| f - left).collect();
        [(linear, Along::Linear), (close, Along::Curved), (left, Along::Whole)]
            .map(|(f, along_y)| Product { f, m, along_y })
    });
    products.collect()
}

/// A part of a field in the cells of a half: what differs from P1 functions, but for numbers of each cell, as products of
/// functions along x and along y; and these numbers, one in all cells row by row after the other.
type Centred = (Vec<Product>, Vec<f64>);

/// Products of what cells cannot have of each part, row by row.
struct Differences {
    parts: usize,
    products: Vec<f64>,
}

impl Differences {
    fn new(parts: usize) -> Self {
        Self { parts, products: vec![0.0; parts * parts] }
    }

    /// Adds Σ |K| (Σ_q w_q d_m d_l - `scale` Σ_v c_mv c_lv) over the cells of a half for all pairs of parts, d being the
    /// sum of products and c_v the numbers of a cell.
    fn add(&mut self, half: &Half, parts: &[Centred], scale: f64) {
        for (m, (terms, cells)) in parts.iter().enumerate() {
            for (l, (others, other_cells)) in parts.iter().enumerate().skip(m) {
                let mut all = 0.0;
                for (r, own) in terms.iter().enumerate() {
                    // Of a part with itself each pair of terms comes once, and counts twice.
                    let first = if l == m { r } else { 0 };
                    for (s, other) in others.iter().enumerate().skip(first) {
                        let pair = half.product(own, other);
                        all += if l == m && s > r { 2.0 * pair } else { pair };
                    }
                }
                all -= scale * half.product_of_numbers(cells, other_cells);
                // A triangle is half of its square.
                self.products[self.parts * m + l] += 0.5 * all;
            }
        }
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
