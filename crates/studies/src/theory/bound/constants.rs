//! The trace constants of a contact scene, and its constants on one mesh.

use super::ladder::BoundError;
use fem::contact::{Discretization, TraceMass, TracePart, trace_constants};
use scene::setup::{Constants, Setup, TraceConstant, trace_constant, with_trace_constants};
use vhi::law::TensorField;

/// A trace constant, and what it is on a mesh.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct OnMesh {
    /// None where it is that of a tensor that varies: meshes for constants do not follow regions.
    pub limit: Option<TraceConstant>,
    /// By the consistent mass, and by the vertex rule.
    pub values: [f64; 2],
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct TraceConstants {
    /// The mesh.
    pub n: u32,
    /// sup ‖v_ν‖²/‖ε(v)‖².
    pub strain: OnMesh,
    /// sup ‖v_ν‖²/(𝒜ε(v), ε(v)).
    pub energy: OnMesh,
    /// sup ‖v_τ‖²/‖ε(v)‖², where there is friction.
    pub tangential: Option<OnMesh>,
}

impl TraceConstants {
    /// Those of a scene and a mesh of it; none without contact sides.
    ///
    /// # Errors
    /// A stiffness matrix that cannot be factorized.
    pub(crate) fn new(setup: &Setup, space: &Discretization) -> Result<Option<Self>, BoundError> {
        let domain = &setup.body.domain;
        if domain.contact.is_empty() {
            return Ok(None);
        }
        let of = |tensor: &TensorField, part| -> Result<OnMesh, BoundError> {
            let squares = [TraceMass::Consistent, TraceMass::Lumped].map(|mass| (part, mass));
            let values = trace_constants(space, tensor, squares)?.map(|found| found.value);
            let limit = tensor.is_uniform().then(|| trace_constant(domain, tensor, part));
            Ok(OnMesh { limit: limit.transpose()?, values })
        };
        let strain = TensorField::identity();
        let tangential = setup.model.friction.as_ref().map(|_| of(&strain, TracePart::Tangential));
        Ok(Some(Self {
            n: space.mesh.n,
            strain: of(&strain, TracePart::Normal)?,
            energy: of(&setup.model.elasticity, TracePart::Normal)?,
            tangential: tangential.transpose()?,
        }))
    }

    /// The constants that judge the discrete problem on the mesh: c_j² is the largest of what it may be and the values of
    /// both masses.
    pub(crate) fn on_mesh(&self, setup: &Setup) -> Constants {
        let largest = |of: &OnMesh| {
            let most = of.limit.as_ref().map_or(0.0, |limit| limit.range()[1]);
            TraceConstant::exactly(of.values.into_iter().fold(most, f64::max))
        };
        let tangential = self.tangential.as_ref().map_or(TraceConstant::ZERO, largest);
        with_trace_constants(setup, &largest(&self.strain), &tangential)
    }
}
