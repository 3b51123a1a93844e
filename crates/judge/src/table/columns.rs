//! Positions of the columns, and rows read by them.

use super::cells::Cells;
use super::name::{Measure, Role, is_cells, normal, role, understood};
use super::number::{is_missing, parse};
use super::{Quantity, Row, TableError};
use crate::fit::{Point, screen};
use files::counted;

/// Deeper levels are not levels of refinement.
const DEEPEST: f64 = 64.0;

/// What a reader has to know beside the text.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Reading {
    /// Dimension of the mesh, if sizes are counts of cells or unknowns.
    pub dimension: Option<u32>,
}

#[derive(Debug, Clone)]
struct Size {
    at: usize,
    name: String,
    measure: Measure,
}

/// A column of errors or values; named if there may be several.
#[derive(Debug, Clone)]
pub(super) struct Measured {
    pub(super) at: usize,
    pub(super) norm: Option<String>,
}

#[derive(Debug)]
pub(super) struct Columns {
    h: Option<Size>,
    k: Option<Size>,
    dimension: Option<u32>,
    pub(super) measured: Vec<Measured>,
    pub(super) quantity: Quantity,
    floor: Option<usize>,
    sigma: Option<usize>,
    pub(super) scene: Option<usize>,
    pub(super) norm: Option<usize>,
    status: Option<usize>,
    count: usize,
    /// Names not understood, beside known norms.
    pub(super) unknown: Vec<String>,
}

impl Columns {
    pub(super) fn of(header: &Cells, reading: &Reading) -> Result<Self, TableError> {
        let roles: Vec<Role> = header.cells.iter().map(|name| role(name)).collect();
        let fail = |what: String| Err(TableError::at(header.line, what));
        let place = |wanted: Role| roles.iter().position(|role| *role == wanted);
        let unknown: Vec<String> = (header.cells.iter().zip(&roles))
            .filter(|(_, role)| **role == Role::Unknown)
            .map(|(name, _)| format!("`{name}`"))
            .collect();
        let names = match unknown.is_empty() {
            true => format!("; understood are {}", understood()),
            false => {
                format!("; not understood: {}; understood are {}", unknown.join(", "), understood())
            }
        };
        let wide = |(at, name): (usize, &String)| Measured { at, norm: Some(name.clone()) };
        let (measured, quantity) = match (place(Role::Error), place(Role::Value)) {
            (Some(_), Some(_)) => {
                return fail("both `error` and `value`: which of them is judged?".into());
            }
            (Some(at), None) => (vec![Measured { at, norm: None }], Quantity::Error),
            (None, Some(at)) => (vec![Measured { at, norm: None }], Quantity::Value),
            (None, None) => {
                let norms = header.cells.iter().enumerate().zip(&roles);
                let norms =
                    norms.filter(|(_, role)| **role == Role::Wide).map(|(column, _)| wide(column));
                (norms.collect(), Quantity::Error)
            }
        };
        if measured.is_empty() {
            return fail(format!("no column `error` (or `value`), and no norm{names}"));
        }
        let size = |time: bool| size(header, &roles, time, reading.dimension);
        let (h, k) = (size(false), size(true));
        if h.is_none() && k.is_none() {
            return fail(match roles.contains(&Role::Space(Measure::Count)) {
                true => "the mesh is known by its cells or unknowns alone: --dimension D says how h follows, h ~ dofs^(-1/D)".into(),
                false => format!("no column `h` and no column `k`{names}"),
            });
        }
        let long = measured.iter().all(|column| column.norm.is_none());
        Ok(Self {
            h,
            k,
            dimension: reading.dimension,
            measured,
            quantity,
            floor: place(Role::Floor),
            sigma: place(Role::Sigma),
            scene: place(Role::Scene),
            norm: place(Role::Norm),
            status: place(Role::Status),
            count: header.cells.len(),
            // A table with a column `error` may have any other column, as `cases.csv` does.
            unknown: if long { Vec::new() } else { unknown },
        })
    }

    pub(super) fn rows(&self, cells: &Cells) -> Result<Vec<Row>, TableError> {
        let line = cells.line;
        if cells.cells.len() != self.count {
            let (found, wanted) = (counted(cells.cells.len(), "field"), self.count);
            let hint = if cells.cells.len() == 2 * wanted {
                "; decimal commas are written as points"
            } else {
                ""
            };
            return Err(TableError::at(line, format!("{found}, the header has {wanted}{hint}")));
        }
        let text =
            |at: Option<usize>| at.and_then(|at| cells.cells.get(at)).filter(|t| !t.is_empty());
        let number = |at: Option<usize>, absent: f64| -> Result<f64, TableError> {
            match text(at) {
                Some(text) if !is_missing(text) => {
                    parse(text).map_err(|what| TableError::at(line, what))
                }
                _ => Ok(absent),
            }
        };
        let step = |size: &Option<Size>| -> Result<f64, TableError> {
            let Some(Size { at, name, measure }) = size else { return Ok(f64::NAN) };
            let step = number(Some(*at), f64::NAN)?;
            let absent = text(Some(*at)).is_none_or(|text| is_missing(text));
            if *measure == Measure::Level && step.abs() <= DEEPEST {
                return Ok((-step).exp2());
            }
            if !(absent || step.is_finite() && step > 0.0) {
                let what = format!("{name} = {step} is no step size, which is positive");
                return Err(TableError::at(line, what));
            }
            if *measure == Measure::Level && !absent {
                let what = format!("{name} = {step} is no level of refinement");
                return Err(TableError::at(line, what));
            }
            Ok(match (measure, self.dimension) {
                (Measure::Length | Measure::Level, _) => step,
                (Measure::Count, Some(dimension)) => step.powf(-1.0 / f64::from(dimension)),
                (Measure::Number | Measure::Count, _) => 1.0 / step,
            })
        };
        let (h, k) = (step(&self.h)?, step(&self.k)?);
        let (floor, sigma) = (number(self.floor, 0.0)?, number(self.sigma, f64::NAN)?);
        let status = text(self.status);
        let row = |column: &Measured| {
            let error = number(Some(column.at), f64::NAN)?;
            let point = Point { h, k, error, floor };
            let there = text(Some(column.at)).is_some_and(|text| !is_missing(text));
            let gap = match status {
                Some(status) if status != "converged" => Some(format!("the case is {status}")),
                _ => self.gap(&point, there, sigma),
            };
            Ok(Row { line, point, sigma: (sigma.is_finite()).then_some(sigma), gap })
        };
        self.measured.iter().map(row).collect()
    }

    fn gap(&self, point: &Point, there: bool, sigma: f64) -> Option<String> {
        match self.quantity {
            _ if sigma <= 0.0 || sigma.is_infinite() => {
                Some(format!("sigma {sigma} is no standard deviation"))
            }
            Quantity::Error if !there => Some("no error".into()),
            Quantity::Value if !there => Some("no value".into()),
            Quantity::Error => {
                screen(point).err().filter(|why| why.is_broken()).map(|why| why.to_string())
            }
            Quantity::Value if point.error.is_finite() => None,
            Quantity::Value => Some(format!("the value {} is no number", point.error)),
        }
    }
}

/// The column of sizes in one direction. Preference: a length, a number along the side, a count (which needs the
/// dimension). With a dimension given, `n` is a counter.
fn size(header: &Cells, roles: &[Role], time: bool, dimension: Option<u32>) -> Option<Size> {
    let counted = header.cells.iter().any(|name| is_cells(name));
    let found = header.cells.iter().enumerate().zip(roles).filter_map(|((at, name), role)| {
        let measure = match (role, time) {
            (Role::Space(measure), false) | (Role::Time(measure), true) => *measure,
            _ => return None,
        };
        let rank = match measure {
            Measure::Length => 0,
            Measure::Count if dimension.is_none() => return None,
            Measure::Count if is_cells(name) => 1,
            Measure::Count => 2,
            // Beside cells `n` may be a counter, as in `n cells`: the dimension decides.
            Measure::Number if dimension.is_none() && normal(name) == "n" && counted => {
                return None;
            }
            Measure::Number => 3,
            Measure::Level => 4,
        };
        // Of h and hmax, the one called h.
        let plain = normal(name).len();
        Some((rank, plain, Size { at, name: name.clone(), measure }))
    });
    found.min_by_key(|(rank, plain, _)| (*rank, *plain)).map(|(.., size)| size)
}
