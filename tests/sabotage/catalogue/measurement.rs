//! Wrong measures of a right solution.

use exact::Exact;
use fem::contact::{LoadError, StepView};
use fem::norms::{AtPoints, Moments};
use fem::space::{Element, strain_of};
use scene::setup::Setup;
use std::sync::Arc;

use fem::contact::{CaseError, CaseInfo, Observer};
use scene::setup::{MeshData, Scheme};

use super::{Defect, MomentSeed, Site, Term};

/// The levels of a scheme through a filter of (n, N) and a change of the time that is read off.
struct Filtered {
    sound: Arc<dyn Scheme>,
    seen: fn(usize, usize) -> bool,
    /// Level whose time is taken for that of level n.
    timed: fn(usize) -> usize,
}

impl Scheme for Filtered {
    fn march(
        &self,
        setup: &Setup,
        data: &MeshData,
        steps: u32,
        observe: &mut Observer<'_>,
    ) -> Result<CaseInfo, CaseError> {
        let grid = setup.grid(steps);
        self.sound.march(setup, data, steps, &mut |view| {
            if !(self.seen)(view.n, grid.steps()) {
                return Ok(());
            }
            observe(&StepView { t: grid.time((self.timed)(view.n)), ..*view })
        })
    }
}

fn filtered(mut setup: Setup, seen: fn(usize, usize) -> bool, timed: fn(usize) -> usize) -> Setup {
    setup.scheme = Arc::new(Filtered { sound: setup.scheme, seen, timed });
    setup
}

/// The exact solution, where strains are constant on cells and u is not.
fn of_linear_elements<'a>(site: &Site<'a>) -> Option<&'a Exact> {
    site.exact.filter(|_| !site.interpolated && site.space.element == Element::P1)
}

/// ε(u) at the centroids, where P1 elements superconverge.
fn at_centroids(site: &Site<'_>, t: f64) -> Result<Moments, LoadError> {
    let mut moments = (*site.sound.moments(t)?).clone();
    if let Some(exact) = of_linear_elements(site) {
        let mesh = &site.space.mesh;
        let points: Vec<[f64; 3]> =
            (0..mesh.cell_count()).map(|c| mesh.point(mesh.cell(c), &[1.0 / 3.0; 3])).collect();
        let mut out = vec![Vec::new(); 5 + exact.memory.len()];
        exact.interior.bind(&points).evaluate(t, 0.0, &mut out);
        let mean = (0..points.len())
            .flat_map(|c| [out[2][c], out[4][c], std::f64::consts::SQRT_2 * out[3][c]])
            .collect();
        moments.strain = AtPoints { at: mean, rest: 0.0 };
    }
    Ok(moments)
}

/// ε of the nodal interpolant of u.
fn of_interpolant(site: &Site<'_>, t: f64) -> Result<Moments, LoadError> {
    let mut moments = (*site.sound.moments(t)?).clone();
    if let Some(exact) = of_linear_elements(site) {
        let (mesh, nodes) = (&site.space.mesh, &site.space.nodes);
        let points: Vec<[f64; 3]> =
            (0..mesh.vertices()).map(|v| mesh.point(&[v as u32], &[1.0])).collect();
        let mut out = vec![Vec::new(); 5 + exact.memory.len()];
        exact.interior.bind(&points).evaluate(t, 0.0, &mut out);
        let mut u = vec![0.0; nodes.len()];
        for v in 0..points.len() {
            let node = nodes.of_vertex[v] as usize;
            (u[2 * node], u[2 * node + 1]) = (out[0][v], out[1][v]);
        }
        let mean = (0..mesh.cell_count())
            .flat_map(|c| {
                strain_of::<3>(site.space.geometry.gradients(c), site.space.cell_nodes(c), &u)
            })
            .collect();
        moments.strain = AtPoints { at: mean, rest: 0.0 };
    }
    Ok(moments)
}

/// ‖ε(u) - Πε(u)‖ left out: the distance to the means alone.
fn without_rest(site: &Site<'_>, t: f64) -> Result<Moments, LoadError> {
    let mut moments = (*site.sound.moments(t)?).clone();
    moments.strain.rest = 0.0;
    Ok(moments)
}

/// Half of the squared rest lost, as a rule that misses it would.
fn half_rest(site: &Site<'_>, t: f64) -> Result<Moments, LoadError> {
    let mut moments = (*site.sound.moments(t)?).clone();
    moments.strain.rest *= 0.5;
    Ok(moments)
}

pub fn defects() -> Vec<Defect> {
    let sees = |name, measured: fn(Setup) -> Setup| Defect {
        measured,
        ..Defect::none(Term::Measurement, name)
    };
    let measures = |name, moments: MomentSeed| Defect {
        moments: Some(moments),
        ..Defect::none(Term::Measurement, name)
    };
    vec![
        sees("maximum over the first half of the steps", |setup| {
            filtered(setup, |n, steps| 2 * n <= steps, |n| n)
        }),
        sees("maximum over every fourth level", |setup| filtered(setup, |n, _| n % 4 == 0, |n| n)),
        sees("u_n compared with u(t_{n-1})", |setup| {
            filtered(setup, |_, _| true, |n| n.saturating_sub(1))
        }),
        sees("error at t = 0 alone", |setup| filtered(setup, |n, _| n == 0, |n| n)),
        measures("error norm by the one-point rule", at_centroids),
        measures("error against the interpolant", of_interpolant),
        measures("error against the projection of ε(u)", without_rest),
        measures("half of the interpolation error lost", half_rest),
    ]
}
