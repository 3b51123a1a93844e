//! The trace constants of a contact scene, and its constants on one mesh.

use super::ladder::BoundError;
use fem::contact::{Discretization, TraceMass, TracePart, trace_constants};
use scene::setup::{Constants, Setup, TraceFamily, trace_families, with_trace_constant};
use vhi::law::TensorField;

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct TraceConstants {
    /// sup ‖v_ν‖²/‖ε(v)‖² with the consistent mass, and with the vertex rule's.
    pub strain: [TraceFamily; 2],
    /// sup ‖v_ν‖²/(𝒜ε(v), ε(v)), the same.
    pub energy: [TraceFamily; 2],
    /// sup ‖v_τ‖²/‖ε(v)‖², the same, where there is friction.
    pub tangential: Option<[TraceFamily; 2]>,
}

/// The meshes on which trace constants are computed.
const LEVELS: [u32; 6] = [8, 16, 32, 64, 128, 256];
/// None of them has more cells: eight times those of the finest mesh of a unit square.
const MOST_CELLS: f64 = 1_048_576.0;
/// Meshes in space, up to 15,000 unknowns.
const LEVELS_IN_SPACE: [u32; 4] = [2, 4, 8, 16];
/// The traces by both masses.
const NORMAL: [(TracePart, TraceMass); 2] =
    [(TracePart::Normal, TraceMass::Consistent), (TracePart::Normal, TraceMass::Lumped)];
const NORMAL_AND_TANGENTIAL: [(TracePart, TraceMass); 4] = [
    NORMAL[0],
    NORMAL[1],
    (TracePart::Tangential, TraceMass::Consistent),
    (TracePart::Tangential, TraceMass::Lumped),
];

impl TraceConstants {
    /// The families of a scene; none without contact sides.
    ///
    /// # Errors
    /// A stiffness matrix that cannot be factorized.
    pub(crate) fn new(setup: &Setup) -> Result<Option<Self>, BoundError> {
        if setup.body.domain.contact.is_empty() {
            return Ok(None);
        }
        let levels = Self::meshes(setup);
        let strain = TensorField::identity();
        let elastic = &setup.model.elasticity;
        // Coarse meshes may not follow the boundaries of regions.
        let follow: Vec<u32> =
            levels.iter().copied().filter(|&n| setup.check_regions(n).is_ok()).collect();
        let energy = trace_families(setup, elastic, NORMAL, &follow)?;
        if setup.model.friction.is_none() {
            let strain = trace_families(setup, &strain, NORMAL, &levels)?;
            return Ok(Some(Self { strain, energy, tangential: None }));
        }
        let [a, b, c, d] = trace_families(setup, &strain, NORMAL_AND_TANGENTIAL, &levels)?;
        Ok(Some(Self { strain: [a, b], energy, tangential: Some([c, d]) }))
    }

    /// The meshes of the families, n of each; none without contact sides.
    pub(crate) fn meshes(setup: &Setup) -> Vec<u32> {
        let levels = match (setup.body.domain.contact.is_empty(), setup.scene.dimension) {
            (true, _) => &[],
            (_, 2) => &LEVELS[..],
            _ => &LEVELS_IN_SPACE,
        };
        let whole = levels.iter().copied().filter(|&n| setup.scene.check_cells(n).is_ok());
        // The coarsest is there in any case: whether it fits into memory is another question.
        let fits = |&(i, n): &(usize, u32)| i == 0 || setup.body.domain.cells(n) <= MOST_CELLS;
        whole.enumerate().filter(fits).map(|(_, n)| n).collect()
    }

    /// The limit of a pair of families, and how far they and their extrapolations lie apart.
    pub(crate) fn limit(pair: &[TraceFamily; 2]) -> (f64, f64) {
        let apart = (pair[0].limit - pair[1].limit).abs();
        let extrapolated = pair[0].uncertainty.max(pair[1].uncertainty);
        (pair[0].limit, apart.max(extrapolated))
    }
}

/// The constants that judge the discrete problem on the mesh of `space`: c_j² is the largest of the
/// extrapolated limit with its uncertainty and the values of both masses on this mesh.
///
/// # Errors
/// A stiffness matrix that cannot be factorized.
pub(crate) fn on_mesh(
    setup: &Setup,
    traces: Option<&TraceConstants>,
    space: &Discretization,
) -> Result<Constants, BoundError> {
    let Some(traces) = traces else { return Ok(with_trace_constant(setup, 0.0)) };
    let strain = TensorField::identity();
    let largest = |pair: &[TraceFamily; 2], [consistent, lumped]: [f64; 2]| {
        let (limit, uncertainty) = TraceConstants::limit(pair);
        let above = limit + if uncertainty.is_nan() { 0.0 } else { uncertainty };
        above.max(consistent).max(lumped)
    };
    let Some(family) = &traces.tangential else {
        let normal = trace_constants(space, &strain, NORMAL)?.map(|found| found.value);
        return Ok(with_trace_constant(setup, largest(&traces.strain, normal)));
    };
    let found = trace_constants(space, &strain, NORMAL_AND_TANGENTIAL)?;
    let [a, b, c, d] = found.map(|found| found.value);
    let normal = with_trace_constant(setup, largest(&traces.strain, [a, b]));
    Ok(normal.with_friction(largest(family, [c, d])))
}
