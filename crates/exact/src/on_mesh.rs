//! An exact solution on a mesh: load vectors and moments, shared by all cases on the mesh.

mod contact;
mod densities;

use fem::mesh::in_dimension;
use std::sync::{Arc, OnceLock};

use super::contact_samples::StatePoints;
use super::cuts::Cuts;
use super::densities::Densities;
use super::exact::{Exact, LoadForm};
use super::facet_group::{FacetGroup, facet_groups};
use super::fields::Fields;
use super::nodal_force::force_of_means;
use super::sampled::Sampled;
use super::truth::{ByTime, Truth};
use fem::contact::{Discretization, LoadError};
use fem::norms::{ContactSamples, Moments};
use fem::space::quadrature::{Rule, TruthRules};
use formula::Node;

/// An exact solution on one mesh of its dimension.
pub struct ExactOnMesh {
    exact: Arc<Exact>,
    space: Arc<Discretization>,
    form: LoadForm,
    /// Points of the error rule in the cells; points of σ in the weak form if different.
    error_points: Sampled,
    stress_points: Option<Sampled>,
    /// Points of the strong form in the cells.
    force_points: Sampled,
    /// Facets of Γ3 in groups of one normal: error points, then samples for the locked set.
    contact: Vec<FacetGroup>,
    traction: Vec<FacetGroup>,
    loads: ByTime<Vec<f64>>,
    moments: ByTime<KnownMoments>,
    cuts: Option<Cuts>,
    /// Where f0 jumps, in the strong form.
    force_cuts: Option<Cuts>,
    state_points: OnceLock<StatePoints>,
}

struct KnownMoments {
    moments: Arc<Moments>,
    /// The means of σ by the rule of loads, where a kink changes them in some cell.
    of_loads: Option<Vec<f64>>,
}

impl ExactOnMesh {
    /// Binds the formulas of `exact` to the points of `rules` on `space`; `traction` are the sides of Γ2.
    pub fn new(
        exact: Arc<Exact>,
        space: Arc<Discretization>,
        form: LoadForm,
        traction: &[u32],
        rules: &TruthRules,
    ) -> Self {
        let cell_points = |rule: &Rule| {
            let cells = (0..space.mesh.cell_count()).map(|c| space.mesh.cell(c));
            Sampled::new(cells, rule)
        };
        let contact = facet_groups(&exact, &space, &space.trace.mesh_facet, &rules.side);
        let fields = [&exact.data.u[..], &exact.strain].concat();
        let cuts = |fields: &[Node]| {
            let cells = (0..space.mesh.cell_count()).map(|c| space.mesh.cell(c));
            Cuts::new(&exact.data.graph, fields, exact.data.horizon, &space.mesh, cells)
        };
        let force_cuts = (form == LoadForm::Strong).then(|| cuts(&exact.body_force)).flatten();
        let cuts = cuts(&fields);
        let free: Vec<u32> = space.mesh.facets_on(traction).map(|f| f as u32).collect();
        Self {
            stress_points: (rules.stress != rules.error).then(|| cell_points(&rules.stress)),
            force_points: cell_points(&rules.load),
            error_points: cell_points(&rules.error),
            contact,
            traction: facet_groups(&exact, &space, &free, &rules.side),
            exact,
            space,
            form,
            loads: ByTime::default(),
            moments: ByTime::default(),
            cuts,
            force_cuts,
            state_points: OnceLock::new(),
        }
    }

    fn at(&self, t: f64) -> Fields<'_> {
        Fields { exact: &self.exact, space: &self.space, t, zeta: self.exact.zeta.at(t) }
    }

    /// Whether loads use the moments of σ: both are then bit-identical, whichever comes first.
    fn is_shared(&self) -> bool {
        self.form == LoadForm::Weak && self.stress_points.is_none()
    }

    fn compute_load<const D: usize>(&self, t: f64) -> Result<Arc<Vec<f64>>, LoadError> {
        self.loads.get_or(t, || {
            if self.form == LoadForm::Strong {
                return Ok(self.densities_at::<D>(t)?.assembled(&self.space, false));
            }
            let mut force = match self.moments.known(t).filter(|_| self.is_shared()) {
                Some(known) => {
                    let means = known.of_loads.as_ref().unwrap_or(&known.moments.stress.at);
                    force_of_means::<D>(&self.space, means)
                }
                None => {
                    let points = self.stress_points.as_ref().unwrap_or(&self.error_points);
                    self.at(t).stress_force::<D>(points)?
                }
            };
            self.add_contact_pressure(t, &mut force)?;
            force.truncate(self.space.dofs());
            Ok(force)
        })
    }

    fn compute_moments<const D: usize>(&self, t: f64) -> Result<Arc<Moments>, LoadError> {
        let known = self.moments.get_or(t, || {
            let fields = self.at(t);
            let mut moments = fields.moments(&self.error_points)?;
            let mut of_loads = None;
            if let Some(cuts) = &self.cuts {
                let before = moments.stress.at.clone();
                fields.correct(cuts, &self.error_points.rule, &mut moments);
                let changed = self.is_shared() && before != moments.stress.at;
                of_loads = changed.then_some(before);
            }
            self.add_contact::<D>(t, &mut moments)?;
            Ok(KnownMoments { moments: Arc::new(moments), of_loads })
        })?;
        Ok(known.moments.clone())
    }
}

impl Truth for ExactOnMesh {
    fn load(&self, t: f64) -> Result<Arc<Vec<f64>>, LoadError> {
        in_dimension!(self.space.mesh.dimension, D => self.compute_load::<D>(t))
    }

    fn moments(&self, t: f64) -> Result<Arc<Moments>, LoadError> {
        in_dimension!(self.space.mesh.dimension, D => self.compute_moments::<D>(t))
    }

    fn densities(&self, t: f64) -> Result<Option<Densities>, LoadError> {
        if self.form == LoadForm::Weak {
            return Ok(None);
        }
        in_dimension!(self.space.mesh.dimension, D => self.densities_at::<D>(t)).map(Some)
    }

    fn expect(&self, times: &[f64]) -> Result<(), LoadError> {
        if !self.is_shared() {
            return Ok(());
        }
        times.iter().try_for_each(|&t| self.moments(t).map(drop))
    }

    fn contact_samples(&self, t: f64) -> Result<Option<ContactSamples>, LoadError> {
        if self.space.mesh.dimension != 2 {
            return Ok(None);
        }
        let points = || StatePoints::new(&self.exact, &self.space, false);
        Ok(Some(self.state_points.get_or_init(points).at(t)))
    }
}
