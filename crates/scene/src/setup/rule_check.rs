//! Quadrature error of loads and errors on a mesh, by comparison with the next rule at a few times.

use std::sync::Arc;

use super::{Setup, elasticity};
use crate::{Data, LoadForm};
use exact::Truth;
use fem::contact::{Discretization, Floors, LevelFields, LoadError, strain_norm};
use fem::norms::{ElasticProjection, Moments};
use fem::space::StrainPoint;
use fem::space::quadrature::TruthRules;
use vhi::law::TensorField;

/// Factor of the largest response of A = 𝒜 + μ to a difference of loads, for all times. The response bounds the change
/// of an error, which is smaller, since errors are nearly orthogonal to V^h (`sweep check --floors` measures it).
const SAFETY: f64 = 1.5;

/// Parts of [0, T] at whose ends rules are compared: once with moving fronts, once at the end, where some scenes have
/// none.
const TIMES: u32 = 2;
/// Times on meshes of few cells, where two times may miss a front.
const TIMES_ON_FEW: u32 = 4;
const FEW: usize = 4096;

/// Relative rounding of equal times.
const SAME_TIME: f64 = 1e-9;

/// Comparison of loads and moments with the next rules.
#[derive(Debug, Default)]
pub struct RuleCheck {
    /// Contribution of the load quadrature to each norm.
    pub floors: Floors,
    /// Moments of the exact fields by the next rule, with their times.
    moments: Vec<(f64, Arc<Moments>)>,
}

impl RuleCheck {
    /// The moments by the next rule, if t is one of the compared times.
    pub fn moments(&self, t: f64) -> Option<&Moments> {
        let close = |(time, _): &&(f64, Arc<Moments>)| (time - t).abs() <= SAME_TIME * t.abs();
        self.moments.iter().find(close).map(|(_, moments)| &**moments)
    }
}

/// The times at which rules are compared.
pub(super) fn check_times(setup: &Setup, cells: usize) -> Vec<f64> {
    let steps = setup.scene.sweep.as_ref().and_then(|sweep| sweep.steps.iter().max());
    let most = if cells <= FEW { TIMES_ON_FEW } else { TIMES };
    let parts = steps.map_or(most, |&steps| most.min(steps));
    (1..=parts).map(|i| setup.scene.time.horizon * f64::from(i) / f64::from(parts)).collect()
}

/// Compares the rules; `usual` are loads and fields by the scene's rules, if available, and `truth` makes them by given
/// rules, the next ones with error estimates of hereditary integrals. Fields by the next rules are not kept: their
/// formulas take more memory than the case.
///
/// # Errors
/// A load or field that is not finite, a mesh on which A cannot be factorized.
pub(super) fn rule_check(
    setup: &Setup,
    space: &Discretization,
    usual: Option<Arc<dyn Truth>>,
    truth: impl Fn(&TruthRules, bool) -> Result<Arc<dyn Truth>, LoadError>,
) -> Result<RuleCheck, LoadError> {
    let times = check_times(setup, space.mesh.cell_count());
    let loads = |truth: &dyn Truth| -> Result<Vec<Arc<Vec<f64>>>, LoadError> {
        times.iter().map(|&t| truth.load(t)).collect()
    };
    let (element, d) = (space.element, setup.scene.dimension);
    let usual = usual.map_or_else(|| truth(&TruthRules::for_element(element, d), false), Ok)?;
    let next = || truth(&TruthRules::stronger_for(element, d), true);
    let mut stronger = next()?;
    let moments = match setup.exact.is_some() {
        // Moments of a reference run are exact.
        false => Vec::new(),
        true => {
            let at = |&t: &f64| Ok((t, stronger.moments(t)?));
            times.iter().map(at).collect::<Result<_, LoadError>>()?
        }
    };
    if matches!(setup.body.data, Data::Exact { form: LoadForm::Strong, .. }) {
        // Frees the points of the moments before those of the loads are made; in the weak form they are shared.
        stronger = next()?;
    }
    let pairs = [loads(&*usual)?, loads(&*stronger)?];
    let elastic = elasticity(&setup.body.material);
    let floors = load_floors(space, &pairs, &elastic, setup.projection_mu())?;
    Ok(RuleCheck { floors, moments })
}

/// Floors from load vectors at equal times by two rules; `elasticity` and `mu` are the scene's.
fn load_floors(
    space: &Discretization,
    [usual, stronger]: &[Vec<Arc<Vec<f64>>>; 2],
    elasticity: &TensorField,
    mu: f64,
) -> Result<Floors, LoadError> {
    let mut operator = ElasticProjection::new(space, elasticity, mu)
        .map_err(|error| LoadError::Reference { reason: error.to_string() })?;
    let still = LevelFields { u: vec![0.0; space.nodes.len()], ..LevelFields::default() };
    // Stresses follow strains by the largest modulus; on Γ3 strains are those of its cells.
    let largest = elasticity.eigenvalues(space.mesh.dimension).1;
    let mut floors = Floors::default();
    for (usual, stronger) in usual.iter().zip(stronger) {
        let difference: Vec<f64> = stronger.iter().zip(&**usual).map(|(a, b)| a - b).collect();
        let u = operator.response(&difference);
        let pressure = largest * strain_on_contact(space, &u);
        let moved = LevelFields { u, ..LevelFields::default() }.distance(&still, space);
        floors = floors.max(Floors { stress: largest * moved.v, pressure, ..moved });
    }
    Ok(floors.times(SAFETY))
}

/// ‖ε(v)‖ on Γ3, from the cells with a side on it: a cell of measure m has about 2m/h of Γ3. In space the norm in the
/// body is used.
fn strain_on_contact(space: &Discretization, v: &[f64]) -> f64 {
    if space.mesh.dimension != 2 {
        return strain_norm(space, v);
    }
    let mut on_contact = vec![false; space.mesh.vertices()];
    for &facet in &space.trace.mesh_facet {
        let corners = space.mesh.facet(facet as usize).iter();
        corners.for_each(|&vertex| on_contact[vertex as usize] = true);
    }
    let touches = |at: &StrainPoint<'_>| {
        let corners = space.mesh.cell(at.cell).iter();
        corners.filter(|&&vertex| on_contact[vertex as usize]).count() > 1
    };
    let squares = space
        .points()
        .filter(touches)
        .map(|at| at.weight * at.strain::<3>(v).iter().map(|e| e * e).sum::<f64>());
    (2.0 * squares.sum::<f64>() / space.mesh.h()).sqrt()
}
