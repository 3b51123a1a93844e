//! What does not change in time on a mesh in rows: of one half of all squares, the points of a rule with their places
//! along x, and sums over points and rows of functions of y.

use nalgebra::{DMatrix, DMatrixView};

use super::bound_products::Values;
use super::lanes::WIDTH;
use super::rows::{Rows, width};
use crate::norms::linear_projection;
use crate::space::quadrature::Rule;

/// Corners of a triangle.
pub const CORNERS: usize = 3;

/// Abscissae of two points are one if they differ by no more than this share of the column's width: rounding.
const SAME_ABSCISSA: f64 = 1e-13;

/// Points of a rule by their abscissae: in a triangle with a side along y several share one, in every column.
#[derive(Debug, Clone, PartialEq)]
pub struct Places {
    /// Of each point.
    pub of: Vec<usize>,
    /// The abscissae, of one place after the other in all columns.
    pub x: Vec<f64>,
    /// The weights of the points at each.
    pub weights: Vec<f64>,
}

impl Places {
    /// Those of the points of `rule` in columns where the corners have the given abscissae.
    pub fn new(corners: &[[f64; CORNERS]], rule: &Rule) -> Self {
        let columns = corners.len();
        let mut places = Self { of: Vec::new(), x: Vec::new(), weights: Vec::new() };
        let all = at_points(corners, rule);
        for (own, weight) in all.chunks_exact(columns).zip(&rule.weights) {
            let same = |known: &[f64]| {
                let pairs = known.iter().zip(own).zip(corners);
                pairs
                    .into_iter()
                    .all(|((a, b), corners)| (a - b).abs() <= SAME_ABSCISSA * width(corners))
            };
            let place = places.x.chunks_exact(columns).position(same).unwrap_or_else(|| {
                places.x.extend_from_slice(own);
                places.weights.push(0.0);
                places.weights.len() - 1
            });
            places.weights[place] += weight;
            places.of.push(place);
        }
        places
    }

    /// How many.
    pub fn count(&self) -> usize {
        self.weights.len()
    }
}

/// The points of a rule in all columns or rows, one point of the rule after the other.
pub fn at_points(corners: &[[f64; CORNERS]], rule: &Rule) -> Vec<f64> {
    let at = |b: &[f64], corner: &[f64; CORNERS]| b.iter().zip(corner).map(|(b, x)| b * x).sum();
    rule.points.iter().flat_map(|b| corners.iter().map(|corner| at(b, corner))).collect()
}

/// A function along y, made of g_m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Along {
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

/// One half of all squares.
pub struct Half {
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
    pub fn new(rows: &Rows, half: usize, places: Places, g: &[Values], rule: &Rule) -> Self {
        let [x, y] = [&rows.x[half], &rows.y[half]];
        let xi = minus(&places.x, &mean(&places.x, &places.weights));
        let at_y = at_points(y, rule);
        let eta = minus(&at_y, &mean(&at_y, &rule.weights));
        let y_width: Vec<f64> = y.iter().map(width).collect();
        let count = rows.rows;
        let mut functions = Vec::with_capacity(KINDS * g.len());
        let along_y = g.iter().map(|g| {
            let g = &g[half];
            let (mean, slope) = (mean(g, &rule.weights), slope(g, &eta, &rule.weights));
            let varying = minus(g, &mean);
            let linear = times(&eta, &slope);
            let curved = varying.iter().zip(&linear).map(|(a, b)| a - b).collect();
            functions.extend([g.clone(), varying, linear, curved]);
            let mut of_mean = DMatrix::zeros(places.count(), count);
            let mut of_corners = DMatrix::zeros(places.count(), CORNERS * count);
            for (q, own) in g.chunks_exact(count).enumerate() {
                let (place, weight) = (places.of[q], rule.weights[q]);
                let mut psi = [0.0; CORNERS];
                linear_projection(&rule.points[q], &mut psi);
                for (j, value) in own.iter().enumerate() {
                    of_mean[(place, j)] += weight * value;
                    for (a, psi) in psi.iter().enumerate() {
                        of_corners[(place, count * a + j)] += weight * psi * value;
                    }
                }
            }
            AlongY { mean, slope, of_mean, of_corners }
        });
        let along_y = along_y.collect();
        let products = (0..places.count()).map(|place| {
            let mut products = DMatrix::zeros(functions.len(), functions.len());
            for q in (0..rule.weights.len()).filter(|&q| places.of[q] == place) {
                let at = |f: &Vec<f64>| f[count * q..count * (q + 1)].to_vec();
                let own = DMatrix::from_vec(
                    count,
                    functions.len(),
                    functions.iter().flat_map(at).collect(),
                );
                let mut weighted = own.clone();
                for (j, mut row) in weighted.row_iter_mut().enumerate() {
                    row *= rule.weights[q] * y_width[j];
                }
                products.gemm_tr(1.0, &own, &weighted, 1.0);
            }
            products
        });
        let products = products.collect();
        let x_width = x.iter().map(width).collect();
        let corners = [x, y].map(|corners| {
            std::array::from_fn(|a| corners.iter().map(|own| own[a] - centre(own)).collect())
        });
        Self { places, x_width, xi, corners, along_y, y_width, products }
    }

    /// Columns and rows.
    fn size(&self) -> [usize; 2] {
        [self.x_width.len(), self.y_width.len()]
    }

    /// The means of f over the points of each column.
    pub fn mean_x(&self, f: &[f64]) -> Vec<f64> {
        mean(f, &self.places.weights)
    }

    /// The slopes of the lines closest to f in each column.
    pub fn slope_x(&self, f: &[f64]) -> Vec<f64> {
        slope(f, &self.xi, &self.places.weights)
    }

    /// The function of these slopes, zero at the centroids.
    pub fn line_x(&self, slope: &[f64]) -> Vec<f64> {
        times(&self.xi, slope)
    }

    /// Adds Σ_q w_q f g_m of all squares.
    pub fn add_mean(&self, f: &[f64], m: usize, sum: &mut DMatrix<f64>) {
        sum.gemm(1.0, &self.by_place(f), &self.along_y[m].of_mean, 1.0);
    }

    /// Adds the values at the corners of the linear projections of f g_m on all squares, for one corner after the other.
    pub fn add_corners(&self, f: &[f64], m: usize, sum: &mut DMatrix<f64>) {
        sum.gemm(1.0, &self.by_place(f), &self.along_y[m].of_corners, 1.0);
    }

    fn by_place<'a>(&self, f: &'a [f64]) -> DMatrixView<'a, f64> {
        DMatrixView::from_slice(f, self.x_width.len(), self.places.count())
    }

    /// Subtracts f̄ ḡ_m, `f` being the means f̄.
    pub fn subtract_means(&self, f: &[f64], m: usize, from: &mut [f64]) {
        subtract(f, &self.along_y[m].mean, from);
    }

    /// Subtracts at a corner the linear part of f g_m, f̄ ḡ + f' ξ ḡ + f̄ g' η.
    pub fn subtract_linear(
        &self,
        [mean, slope]: [&[f64]; 2],
        m: usize,
        corner: usize,
        from: &mut [f64],
    ) {
        let (own, [xi, eta]) = (&self.along_y[m], self.corners.each_ref().map(|at| &at[corner]));
        let close: Vec<f64> =
            mean.iter().zip(slope).zip(xi).map(|((f, slope), xi)| f + slope * xi).collect();
        subtract(&close, &own.mean, from);
        subtract(mean, &times(eta, &own.slope), from);
    }

    /// Σ |K| Σ_q w_q of the product of two products over all cells of the half and their points, over half the area of a
    /// square: `f` are functions along x, at all places or the same at each.
    pub fn product(&self, own: &Term, other: &Term) -> f64 {
        let sums = self.products.iter().enumerate().map(|(place, products)| {
            let along_x = weighted(&self.x_width, self.at(&own.f, place), self.at(&other.f, place));
            along_x * products[(own.number(), other.number())]
        });
        sums.sum()
    }

    fn at<'a>(&self, f: &'a [f64], place: usize) -> &'a [f64] {
        let columns = self.x_width.len();
        let first = columns * place;
        f.get(first..first + columns).unwrap_or(f)
    }

    /// Σ |square| a b over numbers of the squares.
    pub fn product_of_numbers(&self, a: &[f64], b: &[f64]) -> f64 {
        let [columns, _] = self.size();
        let pairs = a.chunks_exact(columns).zip(b.chunks_exact(columns));
        pairs.zip(&self.y_width).map(|((a, b), y)| y * weighted(&self.x_width, a, b)).sum()
    }
}

/// f(x) times a function along y.
pub struct Term {
    /// At the places of all columns, or one number a column.
    pub f: Vec<f64>,
    pub m: usize,
    pub along_y: Along,
}

impl Term {
    /// The number of its function along y.
    fn number(&self) -> usize {
        KINDS * self.m + self.along_y as usize
    }
}

fn centre(at: &[f64; CORNERS]) -> f64 {
    at.iter().sum::<f64>() / CORNERS as f64
}

/// Takes f(i) g(j) from numbers of the squares, row by row.
fn subtract(f: &[f64], g: &[f64], from: &mut [f64]) {
    for (row, g) in from.chunks_exact_mut(f.len()).zip(g) {
        row.iter_mut().zip(f).for_each(|(own, f)| *own -= f * g);
    }
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
pub fn minus(values: &[f64], means: &[f64]) -> Vec<f64> {
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
