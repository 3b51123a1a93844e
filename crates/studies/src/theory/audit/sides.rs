//! A side of Γ2 or Γ3 with the formulas of the truth on it.

use std::sync::Arc;

use super::edges::{
    ContactSample, EdgeSample, between, cut_points, edge_and_place, number, padded, shape,
};
use super::fields::sort_interior;
use exact::{BoundaryFormulas, Exact, LawNumbers};
use fem::contact::Discretization;
use fem::mesh::PlanePart;
use formula::{Node, Program};

pub(crate) struct SideEdges {
    exact: Arc<Exact>,
    space: Arc<Discretization>,
    normal: [f64; 2],
    edges: Vec<[u32; 3]>,
    lengths: Vec<f64>,
    /// Guards of σ.
    guards: Program,
    contact: Option<ContactSide>,
}

/// What a side of Γ3 has beside.
struct ContactSide {
    /// The nodes of the edges as points of the trace.
    trace: Vec<[usize; 3]>,
    formulas: BoundaryFormulas,
    guards: Program,
    /// s and c of the law, with what they are without a formula.
    shift: (Option<Node>, f64),
    scale: (Option<Node>, f64),
    kinks: Vec<f64>,
    has_jump: bool,
}

impl SideEdges {
    /// All sides of Γ2 and Γ3, by their numbers in the mesh.
    pub(crate) fn all(
        exact: &Arc<Exact>,
        space: &Arc<Discretization>,
        traction: &[u32],
        contact: &[u32],
    ) -> Vec<Self> {
        let parts = |sides: &[u32], touches: bool| -> Vec<Self> {
            let of_side = |side: &u32| {
                let facets: Vec<u32> = space.mesh.facets_on(&[*side]).map(|f| f as u32).collect();
                let new = |part: PlanePart| {
                    let facets = part.members.iter().map(|&at| facets[at] as usize).collect();
                    Self::new(exact, space, [part.normal[0], part.normal[1]], facets, touches)
                };
                space.mesh.plane_parts(&facets).into_iter().map(new).collect::<Vec<_>>()
            };
            sides.iter().flat_map(of_side).collect()
        };
        let mut sides = parts(traction, false);
        sides.extend(parts(contact, true));
        sides
    }

    /// The plane part of a side with the given normal and facets.
    fn new(
        exact: &Arc<Exact>,
        space: &Arc<Discretization>,
        normal: [f64; 2],
        facets: Vec<usize>,
        touches: bool,
    ) -> Self {
        let horizon = exact.data.horizon;
        let graph = &exact.data.graph;
        let ends = |&f: &usize| padded(space.nodes.on_facet(f));
        let contact = touches.then(|| {
            let formulas = exact.boundary(&normal);
            let [u, xi, lambda, gap] =
                [formulas.normal, formulas.xi, formulas.lambda, formulas.gap];
            let guards = formulas.graph.guards(&[u, xi, lambda, gap]);
            let position = |f: &usize| {
                let is_facet = |&m: &u32| m as usize == *f;
                let at = space.trace.mesh_facet.iter().position(is_facet).unwrap_or(0);
                padded(space.trace.facet(at)).map(|a| a as usize)
            };
            let given = exact.data.contact.as_ref();
            let law = given.and_then(|contact| contact.law.as_ref());
            ContactSide {
                trace: facets.iter().map(position).collect(),
                shift: (given.and_then(|contact| contact.shift), 0.0),
                scale: (given.and_then(|contact| contact.scale), 1.0),
                guards: Program::compile(&formulas.graph, &guards, horizon),
                kinks: law.map_or(Vec::new(), LawNumbers::kinks),
                has_jump: law
                    .is_some_and(|law| law.points.windows(2).any(|pair| pair[0][0] == pair[1][0])),
                formulas,
            }
        });
        let length = |f: &usize| fem::contact::facet_measure(&space.mesh, *f);
        Self {
            exact: exact.clone(),
            space: space.clone(),
            normal,
            lengths: facets.iter().map(length).collect(),
            edges: facets.iter().map(ends).collect(),
            guards: Program::compile(graph, &graph.guards(&exact.stress), horizon),
            contact,
        }
    }

    fn point(&self, (edge, x): (usize, f64)) -> [f64; 3] {
        self.space.mesh.point(&self.edges[edge][..2], &[1.0 - x, x])
    }

    fn points(&self, places: &[f64]) -> Vec<[f64; 3]> {
        places.iter().map(|&q| self.point(edge_and_place(q, self.edges.len()))).collect()
    }

    /// The points of the side at t, cut for the truth and for `traces`.
    pub(crate) fn samples(&self, t: f64, zeta: f64, traces: &[&[f64]]) -> Vec<EdgeSample> {
        let values = |program: &Program, places: &[f64], t: f64| {
            program.values(&self.points(places), t, zeta)
        };
        let stress = |places: &[f64]| values(&self.guards, places, t);
        let Some(contact) = &self.contact else {
            return self.at(t, &cut_points(self.edges.len(), &[&stress]));
        };
        let guards = |time: f64| move |places: &[f64]| values(&contact.guards, places, time);
        let (now, first) = (guards(t), guards(0.0));
        let crossings = |places: &[f64]| {
            let normal = values(&contact.formulas.program, places, t).swap_remove(0);
            let trace = |values: &&[f64]| self.along(contact, places, values);
            let fields: Vec<Vec<f64>> =
                std::iter::once(normal).chain(traces.iter().map(trace)).collect();
            let points = self.points(places).into_iter();
            let shift = |x| number(&self.exact, contact.shift, x);
            let shifts: Vec<f64> = points.map(shift).collect();
            contact.crossings(&fields, &shifts)
        };
        self.at(t, &cut_points(self.edges.len(), &[&stress, &now, &first, &crossings]))
    }

    /// A trace at these places.
    fn along(&self, contact: &ContactSide, places: &[f64], values: &[f64]) -> Vec<f64> {
        let at = |&q: &f64| {
            let (edge, x) = edge_and_place(q, self.edges.len());
            between(contact.trace[edge], &shape(self.space.element, x), values)
        };
        places.iter().map(at).collect()
    }

    fn at(&self, t: f64, points: &[(usize, f64, f64)]) -> Vec<EdgeSample> {
        let exact = &*self.exact;
        let coordinates: Vec<[f64; 3]> =
            points.iter().map(|&(edge, x, _)| self.point((edge, x))).collect();
        let (u, strain, history) = sort_interior(&exact.interior.values(&coordinates, t, 0.0));
        let contact = self
            .contact
            .as_ref()
            .map(|contact| (contact, contact.formulas.program.values(&coordinates, t, 0.0)));
        let sample = |(p, &(edge, x, weight)): (usize, &(usize, f64, f64))| EdgeSample {
            vertices: self.edges[edge],
            shape: shape(self.space.element, x),
            weight: weight * self.lengths[edge],
            normal: self.normal,
            u: u[p],
            strain: strain[p],
            history: history[p],
            contact: contact.as_ref().map(|(contact, state)| ContactSample {
                trace: contact.trace[edge],
                normal: state[0][p],
                gap: state[2][p],
                shift: number(exact, contact.shift, coordinates[p]),
                scale: number(exact, contact.scale, coordinates[p]),
                compliance: state[3][p],
                multiplier: state[4][p],
            }),
        };
        points.iter().enumerate().map(sample).collect()
    }
}

impl ContactSide {
    /// Distances of u_ν and of each trace from the kinks of the law; differences between them.
    fn crossings(&self, fields: &[Vec<f64>], shifts: &[f64]) -> Vec<Vec<f64>> {
        let mut rows = Vec::new();
        for field in fields {
            for kink in &self.kinks {
                rows.push(field.iter().zip(shifts).map(|(u, s)| u - s - kink).collect());
            }
        }
        if self.has_jump {
            // j_ν⁰(r; d) has a kink in d where ∂j_ν(r) is an interval.
            for (i, a) in fields.iter().enumerate() {
                for b in &fields[..i] {
                    rows.push(a.iter().zip(b).map(|(a, b)| a - b).collect());
                }
            }
        }
        rows
    }
}
