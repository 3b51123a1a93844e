//! L_κ: a proved bound of |κ'| for all ζ ≥ 0, or else for the ζ that a run can reach: twice that of the exact solution, or of
//! a run on a coarse mesh. Every run compares its ζ with that.

use formula::{Interval, Variable};

use super::{MeshData, Result, Setup};
use crate::Hypothesis;
use files::digits;
use vhi::Newton;

/// The bound of |κ'| in the constants of a scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct YieldSlope {
    /// L_κ; 0 without projection.
    pub lipschitz: f64,
    /// It holds for ζ up to this.
    pub zeta: f64,
    pub from: ZetaFrom,
}

/// Where the largest ζ of a [`YieldSlope`] comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ZetaFrom {
    /// The bound holds for all ζ ≥ 0.
    Everywhere,
    /// Twice the ζ of the exact solution.
    Exact,
    /// Twice the ζ of a run with the loads on a coarse mesh.
    Loads,
}

impl YieldSlope {
    /// How the number was obtained.
    pub fn how(&self) -> String {
        let zeta = digits(self.zeta, 5);
        let of = match self.from {
            ZetaFrom::Everywhere if self.lipschitz.is_finite() => {
                return "proved: bound of |kappa'| for all zeta >= 0".into();
            }
            ZetaFrom::Everywhere => {
                return "kappa is not Lipschitz, or no zeta is known up to which".into();
            }
            ZetaFrom::Exact => "the exact solution",
            ZetaFrom::Loads => "a coarse run",
        };
        format!("proved for zeta <= {zeta}, twice the zeta of {of}; a run beyond fails")
    }
}

/// Room for the scheme, and for what a coarse mesh misses.
const MARGIN: f64 = 2.0;
/// Steps of the coarse run, and cells of its mesh if a coarser one satisfies it.
const STEPS: u32 = 64;
const MOST_CELLS: f64 = 16_384.0;

/// L_κ of a scene.
///
/// # Errors
/// κ without a bound of |κ'| for the ζ that a run can reach; a coarse run that fails.
pub(super) fn yield_slope(setup: &Setup) -> Result<YieldSlope> {
    let projection = setup.body.material.projection.as_ref().filter(|given| given.mu > 0.0);
    let lipschitz = projection.map_or(0.0, |given| given.lipschitz);
    let everywhere = YieldSlope { lipschitz, zeta: f64::INFINITY, from: ZetaFrom::Everywhere };
    let scene = &setup.scene;
    let violates = |hypothesis| scene.violates.contains(&hypothesis);
    let Some(projection) = projection.filter(|given| given.lipschitz.is_infinite()) else {
        return Ok(everywhere);
    };
    if violates(Hypothesis::LipschitzKappa) || violates(Hypothesis::Smallness) {
        return Ok(everywhere);
    }
    let horizon = scene.time.horizon;
    let (zeta, from) = match &setup.exact {
        Some(exact) => (exact.zeta.at(horizon), ZetaFrom::Exact),
        None => (of_coarse_run(setup)?, ZetaFrom::Loads),
    };
    let zeta = MARGIN * zeta;
    let mut graph = scene.formulas.clone();
    let slope = graph.derivative(projection.kappa, Variable::Zeta);
    let over = Interval::new(0.0, zeta);
    let found = graph.largest_modulus(slope, Variable::Zeta, over);
    let message = format!(
        "|kappa'| has no bound for all zeta >= 0, nor for zeta up to {}, which a run can reach",
        digits(zeta, 5)
    );
    let known = zeta.is_finite() && found.bound.is_finite();
    let hint = "hold the slope from some zeta on, as in 0.02 + 0.4*min(zeta, 1)^2";
    scene.refuse_if(!known, "material.projection.kappa", message, hint)?;
    Ok(YieldSlope { lipschitz: found.bound, zeta, from })
}

/// ζ(T) of a run on a coarse mesh.
fn of_coarse_run(setup: &Setup) -> Result<f64> {
    let mut n = if setup.scene.dimension == 3 { 2 } else { 8 };
    while n > 1 && setup.body.domain.cells(n) > MOST_CELLS {
        n /= 2;
    }
    let mut zeta = 0.0;
    let data = MeshData::new(setup, n, None)?;
    data.march(setup, STEPS, &Newton::default(), &mut |view| {
        zeta = view.zeta;
        Ok(())
    })?;
    Ok(zeta)
}
