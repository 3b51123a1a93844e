//! What does not change in time on a mesh in rows: of one half of all squares, the points of a rule with their places
//! along x, and sums over points and rows of functions of y.

use nalgebra::{DMatrix, DMatrixView, DMatrixViewMut};

use super::bound_products::Values;
use super::lanes::WIDTH;
use super::row_places::{Places, at_points};
use super::rows::{CORNERS, Rows, width};
use fem::norms::linear_projection;
use fem::space::quadrature::Rule;

/// A function along y, made of g_m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Along {
    /// g_m itself.
    Whole,
    /// g_m - ḡ_m.
    Varying,
    /// g'_m η, its linear part.
    Linear,
    /// g_m - ḡ_m - g'_m η.
    Curved,
}

/// How many functions are made of each g_m.
const KINDS: usize = 4;

/// Sums of g_m over the points of a row.
struct AlongY {
    /// ḡ_m and g'_m of each row.
    mean: Vec<f64>,
    slope: Vec<f64>,
    /// Σ w g_m of the points of each place, by row.
    of_mean: DMatrix<f64>,
    /// Σ w ψ_a g_m of the same, by row for one corner after the other: ψ_a = 3 (4 b_a - 1), whose product with a P1 function
    /// has the value at the corner as its mean.
    of_corners: DMatrix<f64>,
}

impl AlongY {
    /// The sums of g at the points of the rule; `eta` is their distance from the centroids.
    fn new(g: &[f64], eta: &[f64], places: &Places, rule: &Rule) -> Self {
        let (mean, slope) = (mean(g, &rule.weights), slope(g, eta, &rule.weights));
        let rows = mean.len();
        let mut of_mean = DMatrix::zeros(places.count(), rows);
        let mut of_corners = DMatrix::zeros(places.count(), CORNERS * rows);
        for (q, own) in g.chunks_exact(rows).enumerate() {
            let (place, weight) = (places.of[q], rule.weights[q]);
            let mut psi = [0.0; CORNERS];
            linear_projection(&rule.points[q], &mut psi);
            for (j, value) in own.iter().enumerate() {
                of_mean[(place, j)] += weight * value;
                for (a, psi) in psi.iter().enumerate() {
                    of_corners[(place, rows * a + j)] += weight * psi * value;
                }
            }
        }
        Self { mean, slope, of_mean, of_corners }
    }

    /// In the order of [`Along`] what is made of g, at the points of the rule.
    fn functions(&self, g: &[f64], eta: &[f64]) -> [Vec<f64>; KINDS] {
        let varying = minus(g, &self.mean);
        let linear = times(eta, &self.slope);
        let curved = varying.iter().zip(&linear).map(|(a, b)| a - b).collect();
        [g.to_vec(), varying, linear, curved]
    }
}

/// Of each place the sums Σ w |row| f f' over its points and all rows, of all pairs of functions.
fn products(
    functions: &[Vec<f64>],
    places: &Places,
    rule: &Rule,
    y_width: &[f64],
) -> Vec<DMatrix<f64>> {
    let (rows, count) = (y_width.len(), functions.len());
    let mut products = vec![DMatrix::zeros(count, count); places.count()];
    for (q, weight) in rule.weights.iter().enumerate() {
        let at = |f: &Vec<f64>| f[rows * q..rows * (q + 1)].to_vec();
        let own = DMatrix::from_vec(rows, count, functions.iter().flat_map(at).collect());
        let mut weighted = own.clone();
        for (mut row, width) in weighted.row_iter_mut().zip(y_width) {
            row *= weight * width;
        }
        products[places.of[q]].gemm_tr(1.0, &own, &weighted, 1.0);
    }
    products
}

/// One half of all squares.
pub(crate) struct Half {
    places: Places,
    /// Widths of the columns.
    x_width: Vec<f64>,
    /// Distance of the abscissae from the centroids.
    xi: Vec<f64>,
    /// Distance of the corners from the centroids, along x by column and along y by row.
    corners: [[Vec<f64>; CORNERS]; 2],
    along_y: Vec<AlongY>,
    /// Widths of the rows.
    y_width: Vec<f64>,
    /// Of each place the sums Σ w |row| g g' over its points and all rows, of all functions made of the g_m.
    products: Vec<DMatrix<f64>>,
}

impl Half {
    /// The half numbered `half` of the squares of `rows`, with the g_m at the points of the rule in all rows.
    pub(crate) fn new(rows: &Rows, half: usize, places: Places, g: &[Values], rule: &Rule) -> Self {
        let [x, y] = [&rows.x[half], &rows.y[half]];
        let xi = minus(&places.x, &mean(&places.x, &places.weights));
        let at_y = at_points(y, rule);
        let eta = minus(&at_y, &mean(&at_y, &rule.weights));
        let along_y: Vec<AlongY> =
            g.iter().map(|g| AlongY::new(&g[half], &eta, &places, rule)).collect();
        let functions = g.iter().zip(&along_y).flat_map(|(g, own)| own.functions(&g[half], &eta));
        let y_width: Vec<f64> = y.iter().map(width).collect();
        let products = products(&functions.collect::<Vec<_>>(), &places, rule, &y_width);
        let x_width = x.iter().map(width).collect();
        let corners = [x, y].map(|corners| {
            std::array::from_fn(|a| corners.iter().map(|own| own[a] - centre(own)).collect())
        });
        Self { places, x_width, xi, corners, along_y, y_width, products }
    }

    /// The means of f over the points of each column.
    pub(crate) fn mean_x(&self, f: &[f64]) -> Vec<f64> {
        mean(f, &self.places.weights)
    }

    /// The slopes of the lines closest to f in each column.
    pub(crate) fn slope_x(&self, f: &[f64]) -> Vec<f64> {
        slope(f, &self.xi, &self.places.weights)
    }

    /// The function of these slopes, zero at the centroids.
    pub(crate) fn line_x(&self, slope: &[f64]) -> Vec<f64> {
        times(&self.xi, slope)
    }

    /// Σ_m Σ_q w_q f g_m of all squares, row by row, of functions f each with its m.
    pub(crate) fn means(&self, terms: &[(&[f64], usize)]) -> Vec<f64> {
        let mut sum = DMatrix::zeros(self.x_width.len(), self.y_width.len());
        let pairs = terms.iter().map(|&(f, m)| (f, self.along_y[m].of_mean.as_view()));
        add_products(1.0, pairs, &mut sum.as_view_mut());
        sum.data.into()
    }

    /// The values at the corners of the linear projections of Σ_m f g_m on all squares, row by row for one corner after
    /// the other.
    pub(crate) fn corners(&self, terms: &[(&[f64], usize)]) -> Vec<f64> {
        let mut sum = DMatrix::zeros(self.x_width.len(), CORNERS * self.y_width.len());
        let pairs = terms.iter().map(|&(f, m)| (f, self.along_y[m].of_corners.as_view()));
        add_products(1.0, pairs, &mut sum.as_view_mut());
        sum.data.into()
    }

    /// Subtracts Σ_m f̄ ḡ_m from numbers of the squares, where the f are the means f̄.
    pub(crate) fn subtract_means(&self, terms: &[(&[f64], usize)], from: &mut [f64]) {
        let pairs = terms.iter().map(|&(f, m)| (f, row(&self.along_y[m].mean)));
        add_products(-1.0, pairs, &mut self.squares(from));
    }

    /// Subtracts from numbers of the squares at all corners the linear parts of Σ_m f g_m, f̄ ḡ + f' ξ ḡ + f̄ g' η; of f
    /// its mean and its slope.
    pub(crate) fn subtract_linear(&self, terms: &[([&[f64]; 2], usize)], from: &mut [f64]) {
        let squares = self.x_width.len() * self.y_width.len();
        for (corner, from) in from.chunks_exact_mut(squares).enumerate() {
            let [xi, eta] = self.corners.each_ref().map(|at| &at[corner]);
            let close = |[mean, slope]: [&[f64]; 2]| -> Vec<f64> {
                mean.iter().zip(slope).zip(xi).map(|((f, slope), xi)| f + slope * xi).collect()
            };
            let parts: Vec<[Vec<f64>; 2]> = terms
                .iter()
                .map(|&(f, m)| [close(f), times(eta, &self.along_y[m].slope)])
                .collect();
            let pairs = terms.iter().zip(&parts).flat_map(|(&([mean, _], m), [close, sloped])| {
                [(close.as_slice(), row(&self.along_y[m].mean)), (mean, row(sloped))]
            });
            add_products(-1.0, pairs, &mut self.squares(from));
        }
    }

    /// Numbers of the squares, row by row, as columns by rows.
    fn squares<'a>(&self, numbers: &'a mut [f64]) -> DMatrixViewMut<'a, f64> {
        DMatrixViewMut::from_slice(numbers, self.x_width.len(), self.y_width.len())
    }

    /// Σ |square| Σ_q w_q of one product times another over all squares and the points of their halves.
    pub(crate) fn product(&self, own: &Product, other: &Product) -> f64 {
        let sums = self.products.iter().enumerate().map(|(place, products)| {
            let along_x = weighted(&self.x_width, self.at(&own.f, place), self.at(&other.f, place));
            along_x * products[(own.number(), other.number())]
        });
        sums.sum()
    }

    /// A function along x at a place of all columns.
    fn at<'a>(&self, f: &'a [f64], place: usize) -> &'a [f64] {
        let columns = self.x_width.len();
        if f.len() == columns { f } else { &f[columns * place..columns * (place + 1)] }
    }

    /// Σ |square| a b over numbers of the squares, row by row, one list of them after the other.
    pub(crate) fn product_of_numbers(&self, a: &[f64], b: &[f64]) -> f64 {
        let columns = self.x_width.len();
        let pairs = a.chunks_exact(columns).zip(b.chunks_exact(columns));
        let widths = self.y_width.iter().cycle();
        pairs.zip(widths).map(|((a, b), y)| y * weighted(&self.x_width, a, b)).sum()
    }
}

/// f(x) times a function along y.
pub(crate) struct Product {
    /// At the places of all columns, or one number per column.
    pub f: Vec<f64>,
    pub m: usize,
    pub along_y: Along,
}

impl Product {
    /// The number of its function along y.
    fn number(&self) -> usize {
        KINDS * self.m + self.along_y as usize
    }
}

fn centre(at: &[f64; CORNERS]) -> f64 {
    at.iter().sum::<f64>() / CORNERS as f64
}

/// Numbers of rows as a matrix with one place.
fn row(numbers: &[f64]) -> DMatrixView<'_, f64> {
    DMatrixView::from_slice(numbers, 1, numbers.len())
}

/// Adds `scale` Σ f g of pairs f, columns by places, and g, places by what the sum has beside columns: one product of
/// matrices, which passes over the sum once.
fn add_products<'a>(
    scale: f64,
    pairs: impl Iterator<Item = (&'a [f64], DMatrixView<'a, f64>)>,
    sum: &mut DMatrixViewMut<'_, f64>,
) {
    let pairs: Vec<_> = pairs.collect();
    let f = pairs.iter().map(|(f, _)| *f).collect::<Vec<_>>().concat();
    let mut g = DMatrix::zeros(pairs.iter().map(|(_, g)| g.nrows()).sum(), sum.ncols());
    let mut first = 0;
    for (_, own) in &pairs {
        g.rows_mut(first, own.nrows()).copy_from(own);
        first += own.nrows();
    }
    sum.gemm(scale, &DMatrixView::from_slice(&f, sum.nrows(), first), &g, 1.0);
}

/// The means over the points of a rule.
fn mean(values: &[f64], weights: &[f64]) -> Vec<f64> {
    let mut mean = vec![0.0; values.len() / weights.len()];
    for (own, weight) in values.chunks_exact(mean.len()).zip(weights) {
        mean.iter_mut().zip(own).for_each(|(mean, value)| *mean += weight * value);
    }
    mean
}

/// The slopes of the lines closest to the values in each column or row.
fn slope(values: &[f64], from_centre: &[f64], weights: &[f64]) -> Vec<f64> {
    let product = |a: &[f64]| {
        let products: Vec<f64> = a.iter().zip(from_centre).map(|(a, b)| a * b).collect();
        mean(&products, weights)
    };
    product(values).iter().zip(product(from_centre)).map(|(a, b)| a / b).collect()
}

/// The values less a number of each column or row.
pub(crate) fn minus(values: &[f64], means: &[f64]) -> Vec<f64> {
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
