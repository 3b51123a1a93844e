//! Extreme eigenvalues of matrix-free linear maps (faer, Krylov–Schur), with residuals of our own.

use std::sync::Mutex;

use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::matrix_free::LinOp;
use faer::matrix_free::eigen::{PartialEigenParams, partial_eigen, partial_eigen_scratch};
use faer::{ColRef, Mat, MatMut, MatRef, Par, c64};

use super::{FactorError, axpy, dot, norm, signed_unit};

/// A linear map T on ℝ^m with the inner product (x, y) = x·Gy.
pub trait LinearMap: Send {
    /// `out` ← T x.
    ///
    /// # Errors
    /// A linear solve within T fails.
    fn apply(&mut self, x: &[f64], out: &mut [f64]) -> Result<(), FactorError>;

    /// `out` ← G x.
    fn gram(&mut self, x: &[f64], out: &mut [f64]);
}

/// An eigenvalue with what is known of its accuracy.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Extreme {
    pub value: f64,
    /// An eigenvector of length 1 in the inner product.
    pub vector: Vec<f64>,
    /// Applications of T.
    pub iterations: u32,
    /// ‖T x - θ x‖.
    pub residual: f64,
}

/// The outer eigenvalues of a linear map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spectrum {
    /// The largest modulus.
    pub radius: f64,
    /// The largest real eigenvalue; minus infinity if none is real.
    pub rightmost: f64,
    /// Applications of T.
    pub iterations: u32,
}

/// Why an eigenvalue was not found.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum EigenError {
    #[error(transparent)]
    Factor(#[from] FactorError),
    #[error(
        "an eigenvalue did not settle: {value} after {iterations} applications, with a residual of {residual:e}"
    )]
    NotSettled { value: f64, iterations: u32, residual: f64 },
}

/// Relative residual in the Euclidean norm that is asked for of a self-adjoint map: the error of Rayleigh's quotient is of
/// the order of its square.
const WANTED: f64 = 1e-8;
/// Relative residual in the inner product that is accepted of it.
const RESIDUAL: f64 = 1e-6;
/// Residual that is asked for of other maps, whose errors are not squared.
const WANTED_RADIUS: f64 = 1e-11;
/// Restarts, each of 32 applications, after which an iteration is given up.
const RESTARTS: usize = 100;
/// A smaller imaginary part, relative to the radius, is rounding of a nearly double real eigenvalue.
const REAL: f64 = 1e-6;
/// Vectors that an iteration holds: 65 of a basis and 64 of its change, as the library takes them for up to 32 eigenvalues.
pub const KRYLOV_VECTORS: usize = 129;
/// T x and x of the start are one direction: T is a multiple of the identity on all that an iteration sees.
const ONE_DIRECTION: f64 = 1e-13;
/// Added to a map of size one: a ten-thousandth of its rounding. With 1e-100 the library's factors underflow, and it goes on
/// without end as before.
const NOTHING: f64 = 1e-20;
/// Eigenvalues that are asked for where those of largest modulus may be complex.
const SEVERAL: usize = 8;

/// The largest eigenvalue of a map that is self-adjoint and positive semidefinite in its inner product; 0 for the zero
/// map.
///
/// # Errors
/// [`EigenError`].
pub fn largest_eigenvalue(map: &mut dyn LinearMap, start: &[f64]) -> Result<Extreme, EigenError> {
    let (values, mut vectors, iterations) = outer(map, start, (1, WANTED), 0.0)?;
    let top = (0..values.len()).max_by(|&a, &b| values[a].re.total_cmp(&values[b].re));
    let mut vector = top.map_or_else(|| start.to_vec(), |top| vectors.swap_remove(top));
    let (mut image, mut out) = (vec![0.0; start.len()], vec![0.0; start.len()]);
    map.gram(&vector, &mut image);
    let length = dot(&vector, &image).sqrt();
    vector.iter_mut().for_each(|x| *x /= length);
    image.iter_mut().for_each(|x| *x /= length);
    map.apply(&vector, &mut out)?;
    // Rayleigh's quotient, whose error is the square of the vector's.
    let value = dot(&image, &out);
    // Relative to the value, so that it is no smaller than a double in any units.
    if value != 0.0 {
        out.iter_mut().zip(&vector).for_each(|(out, x)| *out = *out / value - x);
    }
    map.gram(&out, &mut image);
    let relative = dot(&out, &image).max(0.0).sqrt();
    let residual = if value == 0.0 { relative } else { relative * value.abs() };
    let found = Extreme { value, vector, iterations, residual };
    match relative <= if value == 0.0 { f64::MIN_POSITIVE } else { RESIDUAL } {
        true => Ok(found),
        false => Err(EigenError::NotSettled { value, iterations, residual }),
    }
}

/// The outer eigenvalues of any linear map.
///
/// # Errors
/// [`EigenError`].
pub fn spectrum(map: &mut dyn LinearMap, start: &[f64]) -> Result<Spectrum, EigenError> {
    let (values, _, first) = outer(map, start, (SEVERAL, WANTED_RADIUS), 0.0)?;
    let radius = values.iter().map(|z| z.re.hypot(z.im)).fold(0.0, f64::max);
    let real = |values: &[c64], shift: f64| {
        let real = values.iter().filter(|z| z.im.abs() <= REAL * radius);
        real.map(|z| z.re - shift).fold(f64::NEG_INFINITY, f64::max)
    };
    // The shift makes the rightmost eigenvalue that of largest modulus, if it is real.
    let (shifted, _, second) = outer(map, start, (SEVERAL, WANTED_RADIUS), radius)?;
    let rightmost = real(&shifted, radius).max(real(&values, 0.0));
    let iterations = first + second;
    if values.is_empty() || shifted.is_empty() {
        return Err(EigenError::NotSettled { value: radius, iterations, residual: f64::NAN });
    }
    Ok(Spectrum { radius, rightmost, iterations })
}

type Outer = (Vec<c64>, Vec<Vec<f64>>, u32);

/// So many eigenvalues of T + `shift` of largest modulus, or all of a small map; the real parts of their vectors, and the
/// applications of T.
fn outer(
    map: &mut dyn LinearMap,
    start: &[f64],
    (count, wanted): (usize, f64),
    shift: f64,
) -> Result<Outer, EigenError> {
    let (order, length) = (start.len(), norm(start));
    let start: Vec<f64> = start.iter().map(|x| x / length).collect();
    let (start, mut out) = (&start[..], vec![0.0; order]);
    let mut shifted = Shifted { order, shift, scale: 1.0, map: Mutex::new((map, 0, None)) };
    shifted.apply_to(start, &mut out);
    let (value, size) = (dot(start, &out), norm(&out));
    axpy(-value, start, &mut out);
    let one_direction = norm(&out) <= ONE_DIRECTION * size;
    // The iteration sees a map of size one, so that no square leaves the range of doubles, whatever the units.
    shifted.scale = size;
    let (values, vectors) = if one_direction {
        (vec![c64::new(value, 0.0)], vec![start.to_vec()])
    } else {
        shifted.iterate(start, count.min(order), wanted)
    };
    let (_, iterations, failed) =
        shifted.map.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
    if let Some(error) = failed {
        return Err(error.into());
    }
    Ok((values, vectors, iterations))
}

/// (T + shift)/scale, its applications, and why one failed; the rest of an iteration then sees zeros.
struct Shifted<'m> {
    order: usize,
    shift: f64,
    scale: f64,
    map: Mutex<(&'m mut dyn LinearMap, u32, Option<FactorError>)>,
}

impl Shifted<'_> {
    fn apply_to(&self, x: &[f64], out: &mut [f64]) {
        let mut locked = self.map.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        let (map, count, failed) = &mut *locked;
        *count += 1;
        if failed.is_none() {
            *failed = map.apply(x, out).err();
            axpy(self.shift, x, out);
            out.iter_mut().for_each(|value| *value /= self.scale);
            // An iteration does not end on what is not a number.
            if failed.is_none() && !out.iter().all(|value| value.is_finite()) {
                *failed = Some(FactorError::NotFinite);
            }
        }
        if failed.is_some() {
            out.fill(0.0);
        }
    }

    fn iterate(&self, start: &[f64], count: usize, wanted: f64) -> (Vec<c64>, Vec<Vec<f64>>) {
        let params = PartialEigenParams { max_restarts: RESTARTS, ..PartialEigenParams::default() };
        let mut vectors = Mat::<c64>::zeros(self.order, count);
        let mut values = vec![c64::new(0.0, 0.0); count];
        let scratch = partial_eigen_scratch::<f64>(self, count, Par::Seq, params);
        let info = partial_eigen(
            vectors.as_mut(),
            &mut values,
            self,
            ColRef::from_slice(start),
            wanted,
            Par::Seq,
            MemStack::new(&mut MemBuffer::new(scratch)),
            params,
        );
        values.truncate(info.n_converged_eigen);
        values.iter_mut().for_each(|z| *z = c64::new(self.scale * z.re, self.scale * z.im));
        (values, real_parts(vectors.as_ref()))
    }
}

impl std::fmt::Debug for Shifted<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "a map of order {}", self.order)
    }
}

impl LinOp<f64> for Shifted<'_> {
    fn apply_scratch(&self, _: usize, _: Par) -> StackReq {
        StackReq::EMPTY
    }

    fn nrows(&self) -> usize {
        self.order
    }

    fn ncols(&self) -> usize {
        self.order
    }

    fn apply(&self, mut out: MatMut<'_, f64>, x: MatRef<'_, f64>, _: Par, _: &mut MemStack) {
        let mut image = vec![0.0; self.order];
        for j in 0..x.ncols() {
            let column: Vec<f64> = (0..self.order).map(|i| x[(i, j)]).collect();
            self.apply_to(&column, &mut image);
            // Where the map is zero on some coordinates the basis may span all others. Then the library orthogonalizes to
            // an exact zero, and goes on without end. Each vector gets a direction of its own: one for all is spanned soon.
            let mut seed = column.iter().fold(1, |seed: u64, x| seed.rotate_left(5) ^ x.to_bits());
            image.iter_mut().for_each(|value| *value += NOTHING * signed_unit(&mut seed));
            image.iter().enumerate().for_each(|(i, value)| out[(i, j)] = *value);
        }
    }

    fn conj_apply(&self, out: MatMut<'_, f64>, x: MatRef<'_, f64>, par: Par, room: &mut MemStack) {
        self.apply(out, x, par, room);
    }
}

fn real_parts(vectors: MatRef<'_, c64>) -> Vec<Vec<f64>> {
    let column = |j: usize| (0..vectors.nrows()).map(|i| vectors[(i, j)].re).collect();
    (0..vectors.ncols()).map(column).collect()
}
