//! Wrong measures of a right solution.

use exact::Exact;
use fem::contact::StepView;
use fem::norms::{AtPoints, Moments};
use fem::space::{Element, strain_of};

use super::Term::Measurement;
use super::{Defect, Site};

/// The levels of a scheme through a filter of (n, N) and a change of the time that is read off: that of another level.
fn filtered(
    name: &'static str,
    seen: fn(usize, usize) -> bool,
    timed: fn(usize) -> usize,
) -> Defect {
    Measurement.seen(name, move |grid, view, observe| match seen(view.n, grid.steps()) {
        true => observe(&StepView { t: grid.time(timed(view.n)), ..*view }),
        false => Ok(()),
    })
}

/// The exact solution, where strains are constant on cells and u is not.
fn of_linear_elements<'a>(site: &Site<'a>) -> Option<&'a Exact> {
    site.exact.filter(|_| !site.interpolated && site.space.element == Element::P1)
}

/// ε(u) at the centroids, where P1 elements superconverge.
fn at_centroids(site: &Site<'_>, t: f64, moments: &mut Moments) {
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
}

/// ε of the nodal interpolant of u.
fn of_interpolant(site: &Site<'_>, t: f64, moments: &mut Moments) {
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
}

pub fn defects() -> Vec<Defect> {
    vec![
        filtered("maximum over the first half of the steps", |n, steps| 2 * n <= steps, |n| n),
        filtered("maximum over every fourth level", |n, _| n % 4 == 0, |n| n),
        filtered("u_n compared with u(t_{n-1})", |_, _| true, |n| n.saturating_sub(1)),
        filtered("error at t = 0 alone", |n, _| n == 0, |n| n),
        Measurement.moments("error norm by the one-point rule", at_centroids),
        Measurement.moments("error against the interpolant", of_interpolant),
        // ‖ε(u) - Πε(u)‖ left out: the distance to the means alone.
        Measurement.moments("error against the projection of ε(u)", |_, _, moments| {
            moments.strain.rest = 0.0;
        }),
        // Half of the squared rest, as a rule that misses it would.
        Measurement.moments("half of the interpolation error lost", |_, _, moments| {
            moments.strain.rest *= 0.5;
        }),
    ]
}
