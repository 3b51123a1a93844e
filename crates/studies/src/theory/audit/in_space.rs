//! The fields of a truth that lies in V^h at all times: constant strains, linear traces, and the
//! boundary rule of the scheme in every boundary integral, as its loads have it.

use std::sync::Arc;

use super::edges::{ContactSample, EdgeSample, cut_points, edge_and_place, number, padded, shape};
use super::fields::{CellValues, Fields, Volume};
use super::pointwise::Plane;
use super::strips::CellPoints;
use exact::{ComplianceRule, Exact, InterpolatedOnMesh, LawNumbers};
use fem::contact::{Discretization, LoadError};
use fem::space::quadrature::edge;
use fem::space::strain_of;

/// The nodal interpolant of formulas as a truth.
pub(crate) struct InSpaceFields {
    exact: Arc<Exact>,
    truth: InterpolatedOnMesh,
    space: Arc<Discretization>,
    rule: ComplianceRule,
}

impl InSpaceFields {
    /// The interpolant of `exact` on `space`, with the boundary rule of the scheme.
    pub(crate) fn new(
        exact: &Arc<Exact>,
        space: &Arc<Discretization>,
        rule: ComplianceRule,
    ) -> Self {
        let truth = InterpolatedOnMesh::new(exact.clone(), space.clone(), rule);
        Self { exact: exact.clone(), truth, space: space.clone(), rule }
    }

    /// (edge, ξ, weight) of the rule on the whole of Γ3.
    fn points(
        &self,
        traces: &[&[f64]],
        shift: &dyn Fn(usize, f64) -> f64,
    ) -> Vec<(usize, f64, f64)> {
        let trace = &self.space.trace;
        let edges = trace.measure.len();
        let on_each = |points: &[(f64, f64)]| -> Vec<(usize, f64, f64)> {
            (0..edges).flat_map(|e| points.iter().map(move |&(x, w)| (e, x, w))).collect()
        };
        match self.rule {
            ComplianceRule::Vertex => on_each(&[(0.0, 0.5), (1.0, 0.5)]),
            ComplianceRule::Gauss => {
                let rule = edge(3);
                let points: Vec<(f64, f64)> =
                    rule.points.iter().zip(&rule.weights).map(|(b, w)| (b[1], *w)).collect();
                on_each(&points)
            }
            ComplianceRule::Exact => {
                let contact = self.exact.data.contact.as_ref();
                let law = contact.and_then(|contact| contact.law.as_ref());
                let kinks = law.map_or(Vec::new(), LawNumbers::kinks);
                let offset = |values: &[f64], q: f64, kink: f64| {
                    let (e, x) = edge_and_place(q, edges);
                    let [a, b] = [0, 1].map(|end| values[trace.facet(e)[end] as usize]);
                    a + x * (b - a) - shift(e, x) - kink
                };
                let pairs: Vec<(&[f64], f64)> =
                    traces.iter().flat_map(|at| kinks.iter().map(|&kink| (*at, kink))).collect();
                let crossings = |places: &[f64]| -> Vec<Vec<f64>> {
                    let row = |&(values, kink): &(&[f64], f64)| {
                        places.iter().map(|&q| offset(values, q, kink)).collect()
                    };
                    pairs.iter().map(row).collect()
                };
                cut_points(edges, &[&crossings])
            }
        }
    }
}

impl Fields for InSpaceFields {
    fn volume(&mut self, t: f64, _: f64) -> Result<Volume, LoadError> {
        let (u, memory) = self.truth.displacements(t)?;
        let (mesh, geometry) = (&self.space.mesh, &self.space.geometry);
        let cells = mesh.cell_count();
        let strains = |nodal: &Vec<f64>| -> Vec<Plane> {
            let of = |c| strain_of::<3>(geometry.gradients(c), self.space.cell_nodes(c), nodal);
            (0..cells).map(of).collect()
        };
        let centre = |c: usize| mesh.point(mesh.cell(c), &[1.0 / 3.0; 3]);
        let at = CellPoints {
            points: (0..cells).map(centre).collect(),
            weights: geometry.measure.clone(),
            cells: (0..cells as u32).collect(),
        };
        let plain = CellValues {
            at,
            u: vec![[0.0; 2]; cells],
            strain: strains(&u),
            // One term at most: scenes with more are not audited.
            history: memory.first().map_or_else(|| vec![[0.0; 3]; cells], strains),
            force: vec![[0.0; 2]; cells],
        };
        Ok(Volume { plain, ..Volume::default() })
    }

    fn edges(&mut self, t: f64, _: f64, traces: &[&[f64]]) -> Result<Vec<EdgeSample>, LoadError> {
        let (trace, mesh) = (&self.space.trace, &self.space.mesh);
        let state = self.truth.contact_state(t);
        let contact = self.exact.data.contact.as_ref();
        let law = contact.and_then(|contact| contact.law.as_ref());
        let ends = |e: usize| [0, 1].map(|a| trace.facet(e)[a] as usize);
        let vertices = |e: usize| ends(e).map(|i| trace.points[i].vertex);
        let shift_formula = contact.and_then(|contact| contact.shift);
        let scale_formula = contact.and_then(|contact| contact.scale);
        let at = |e: usize, x: f64| mesh.point(&vertices(e), &[1.0 - x, x]);
        let shift = |e: usize, x: f64| number(&self.exact, (shift_formula, 0.0), at(e, x));
        let scale = |e: usize, x: f64| number(&self.exact, (scale_formula, 1.0), at(e, x));
        let normal: Vec<f64> = state.iter().map(|at| at[0]).collect();
        let mut all = vec![normal.as_slice()];
        all.extend(traces);
        let sample = |(e, x, weight): (usize, f64, f64)| {
            let [a, b] = ends(e);
            let between = |field: usize| (1.0 - x) * state[a][field] + x * state[b][field];
            let (normal, s, c) = (between(0), shift(e, x), scale(e, x));
            let compliance = match (self.rule, law) {
                (ComplianceRule::Vertex, _) => between(3),
                (_, Some(law)) => c * law.pressure(normal - s),
                (_, None) => 0.0,
            };
            EdgeSample {
                vertices: padded(&vertices(e)),
                shape: shape(self.space.element, x),
                weight: weight * trace.measure[e],
                contact: Some(ContactSample {
                    trace: padded(&[a, b]),
                    normal,
                    gap: between(2),
                    shift: s,
                    scale: c,
                    compliance,
                    multiplier: 0.0,
                }),
                ..EdgeSample::default()
            }
        };
        Ok(self.points(&all, &shift).into_iter().map(sample).collect())
    }

    fn interpolant(&mut self, t: f64) -> Result<Vec<f64>, LoadError> {
        Ok(self.truth.displacements(t)?.0)
    }

    fn zeta(&mut self, t: f64) -> Result<Option<f64>, LoadError> {
        self.truth.zeta(t).map(Some)
    }

    fn remembered(&mut self, t: f64) -> Result<CellValues, LoadError> {
        Ok(self.volume(t, f64::NAN)?.plain)
    }

    fn nodal_multiplier(&mut self, t: f64) -> Result<Option<Vec<f64>>, LoadError> {
        Ok(Some(self.truth.contact_state(t).iter().map(|at| at[4]).collect()))
    }
}
