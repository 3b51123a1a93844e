//! An exact solution on a mesh: load vectors and moments, shared by all cases on the mesh. Fields that separate in time
//! are integrated once, in parts; others at each time.

mod contact;

use fem::mesh::in_dimension;
use std::sync::{Arc, OnceLock};

use self::contact::ContactMoments;
use super::contact_samples::StatePoints;
use super::cuts::Cuts;
use super::exact::{Exact, LoadForm};
use super::facet_group::{FacetGroup, facet_groups};
use super::nodal_force::force_of_means;
use super::part_moments::{PartMoments, combined, forget_zeros};
use super::parts::Parts;
use super::sampled::Sampled;
use super::separation::Separation;
use super::truth::{ByTime, Truth};
use fem::contact::{Discretization, LoadError};
use fem::norms::{ContactSamples, Moments};
use fem::space::quadrature::{Rule, TruthRules};

/// An exact solution on one mesh of its dimension.
pub struct ExactOnMesh {
    exact: Arc<Exact>,
    space: Arc<Discretization>,
    form: LoadForm,
    /// Points of the error rule in the cells; points of σ in the weak form if different.
    error_points: Sampled,
    stress_points: Option<Sampled>,
    /// Points on the facets of cells, in the weak form for discontinuous elements.
    /// Points of the strong form in the cells.
    force_points: Sampled,
    /// Facets of Γ3 in groups of one normal: error points, then samples for the locked set.
    contact: Vec<FacetGroup>,
    traction: Vec<FacetGroup>,
    /// Of each cell.
    regions: Vec<usize>,
    loads: ByTime<Vec<f64>>,
    moments: ByTime<KnownMoments>,
    cuts: Option<Cuts>,
    /// The parts of loads and moments that do not separate.
    contact_forces: ByTime<Vec<f64>>,
    contact_moments: ByTime<ContactMoments>,
    /// Nodal vectors and moments of the parts; None if one is not finite.
    load_parts: OnceLock<Option<Vec<Vec<f64>>>>,
    moment_parts: OnceLock<Option<PartMoments>>,
    /// Whether separable fields are taken in parts.
    in_parts: bool,
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
        let regions = exact.cell_regions(&space.mesh);
        let fields = [&exact.data.u[..], &exact.strain].concat();
        let cells = (0..space.mesh.cell_count()).map(|c| space.mesh.cell(c));
        let graph = &exact.data.graph;
        let cuts = Cuts::new(graph, &fields, exact.data.horizon, &space.mesh, cells);
        let free: Vec<u32> = space.mesh.facets_on(traction).map(|f| f as u32).collect();
        Self {
            stress_points: (rules.stress != rules.error).then(|| cell_points(&rules.stress)),
            force_points: cell_points(&rules.load),
            error_points: cell_points(&rules.error),
            regions,
            contact,
            traction: facet_groups(&exact, &space, &free, &rules.side),
            exact,
            space,
            form,
            loads: ByTime::default(),
            moments: ByTime::default(),
            cuts,
            contact_forces: ByTime::default(),
            contact_moments: ByTime::default(),
            load_parts: OnceLock::new(),
            moment_parts: OnceLock::new(),
            in_parts: true,
            state_points: OnceLock::new(),
        }
    }

    /// Evaluates all fields at each time: for few times, and to check the parts.
    pub fn time_by_time(mut self) -> Self {
        self.in_parts = false;
        self
    }

    fn at(&self, t: f64) -> Parts<'_> {
        Parts {
            exact: &self.exact,
            space: &self.space,
            regions: &self.regions,
            interior: &self.exact.interior,
            forces: &self.exact.forces,
            count: 1,
            remembered_alone: &[],
            again: true,
            t,
            zeta: if self.form == LoadForm::Strong { self.exact.zeta.at(t) } else { f64::NAN },
            kappa: self.exact.kappa(t),
        }
    }

    /// The parts of separable fields.
    fn parts<'a>(&'a self, separation: &'a Separation) -> Parts<'a> {
        Parts {
            interior: &separation.interior,
            forces: &separation.forces,
            count: separation.factors.parts,
            remembered_alone: &separation.remembered_alone,
            again: false,
            t: 0.0,
            zeta: f64::NAN,
            // Separable fields have no projection.
            kappa: f64::INFINITY,
            ..self.at(0.0)
        }
    }

    fn separation(&self) -> Option<&Separation> {
        self.exact.separation.as_ref().filter(|_| self.in_parts)
    }

    /// Whether loads use the moments of σ: both are then bit-identical, whichever comes first.
    fn is_shared(&self) -> bool {
        self.form == LoadForm::Weak && self.stress_points.is_none()
    }

    /// Nodal vectors of all loads but the pressure on Γ3, by part.
    fn volume_forces<const D: usize, const N: usize>(
        &self,
        parts: &Parts<'_>,
    ) -> Result<Vec<Vec<f64>>, LoadError> {
        if self.form == LoadForm::Weak {
            let points = self.stress_points.as_ref().unwrap_or(&self.error_points);
            return parts.stress_forces::<D, N>(points);
        }
        let mut forces = parts.body_forces::<D>(&self.force_points)?;
        for group in self.traction.iter().chain(&self.contact) {
            parts.add_boundary_stress::<D>(group, &mut forces)?;
        }
        Ok(forces)
    }

    /// As above from the parts; None if there are none, or a number is not finite.
    fn volume_from_parts<const D: usize, const N: usize>(&self, t: f64) -> Option<Vec<f64>> {
        let separation = self.separation()?;
        let parts = self.load_parts.get_or_init(|| {
            let parts = self.parts(separation);
            let known = self.moment_parts.get().filter(|_| self.is_shared());
            let mut forces = match known {
                Some(known) => {
                    let means = known.as_ref()?.stress_means().iter();
                    means.map(|means| force_of_means::<D>(&self.space, means)).collect()
                }
                None => self.volume_forces::<D, N>(&parts).ok()?,
            };
            forget_zeros(&mut forces);
            Some(forces)
        });
        let factors = separation.of_stress().at(t);
        let force = combined(parts.as_ref()?, &factors, self.space.nodes.len());
        force.iter().all(|value| value.is_finite()).then_some(force)
    }

    fn compute_load<const D: usize, const N: usize>(
        &self,
        t: f64,
    ) -> Result<Arc<Vec<f64>>, LoadError> {
        let with = |mut force: Vec<f64>, pressure: &[f64]| {
            self.add_contact_pressure(pressure, &mut force);
            force.truncate(self.space.dofs());
            force
        };
        if let Some(force) = self.volume_from_parts::<D, N>(t) {
            let pressure = self.contact_forces.get_or(t, || self.contact_pressure(t))?;
            return Ok(Arc::new(with(force, &pressure)));
        }
        self.loads.get_or(t, || {
            let force = match self.moments.known(t).filter(|_| self.is_shared()) {
                Some(known) => {
                    let means = known.of_loads.as_ref().unwrap_or(&known.moments.stress.at);
                    force_of_means::<D>(&self.space, means)
                }
                None => self.volume_forces::<D, N>(&self.at(t))?.swap_remove(0),
            };
            Ok(with(force, &self.contact_pressure(t)?))
        })
    }

    /// Moments in the cells from the parts; None if there are none, or a number is not finite.
    fn moments_from_parts<const D: usize, const N: usize>(&self, t: f64) -> Option<Moments> {
        let separation = self.separation()?;
        let parts = self.moment_parts.get_or_init(|| {
            Some(self.parts(separation).moments::<D, N>(&self.error_points).ok()?.without_zeros())
        });
        parts.as_ref()?.at(&separation.factors.at(t), &separation.of_stress().at(t))
    }

    fn compute_moments<const D: usize, const N: usize>(
        &self,
        t: f64,
    ) -> Result<Arc<Moments>, LoadError> {
        let with = |cells: Moments, on_contact: ContactMoments| {
            let ContactMoments { normal, pressure, locked } = on_contact;
            Moments { normal, pressure, locked, ..cells }
        };
        let on_contact = || self.contact_moments.get_or(t, || self.compute_contact::<D>(t));
        if self.cuts.is_none()
            && let Some(cells) = self.moments_from_parts::<D, N>(t)
        {
            return Ok(Arc::new(with(cells, (*on_contact()?).clone())));
        }
        let known = self.moments.get_or(t, || {
            let at = self.at(t);
            let mut cells = match self.moments_from_parts::<D, N>(t) {
                Some(cells) => cells,
                None => at.moments::<D, N>(&self.error_points)?.single(),
            };
            let mut of_loads = None;
            if let Some(cuts) = &self.cuts {
                let before = cells.stress.at.clone();
                at.correct::<D, N>(cuts, &self.error_points.rule, &mut cells);
                of_loads = Some(before).filter(|at| self.is_shared() && *at != cells.stress.at);
            }
            let moments = Arc::new(with(cells, (*on_contact()?).clone()));
            Ok(KnownMoments { moments, of_loads })
        })?;
        Ok(known.moments.clone())
    }
}

impl Truth for ExactOnMesh {
    fn load(&self, t: f64) -> Result<Arc<Vec<f64>>, LoadError> {
        in_dimension!(self.space.mesh.dimension, D, S => self.compute_load::<D, S>(t))
    }

    fn moments(&self, t: f64) -> Result<Arc<Moments>, LoadError> {
        in_dimension!(self.space.mesh.dimension, D, S => self.compute_moments::<D, S>(t))
    }

    fn expect(&self, times: &[f64]) -> Result<(), LoadError> {
        if !self.is_shared() {
            return Ok(());
        }
        // The first gives the parts at all times.
        let needed = if self.separation().is_some() { 1 } else { times.len() };
        times.iter().take(needed).try_for_each(|&t| self.moments(t).map(drop))
    }

    fn contact_samples(&self, t: f64) -> Result<Option<ContactSamples>, LoadError> {
        if self.space.mesh.dimension != 2 {
            return Ok(None);
        }
        let points = || StatePoints::new(&self.exact, &self.space, false);
        Ok(Some(self.state_points.get_or_init(points).at(t)))
    }
}
