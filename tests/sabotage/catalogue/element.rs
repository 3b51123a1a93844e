//! Wrong quadratic elements: weights on Γ3, points and weights of strains, nodes at midpoints.

use fem::contact::{Discretization, StepView};
use fem::space::Element;
use vhi::Newton;

use super::{Defect, Term};
use crate::shipped::{Change, midpoints_between_corners, weigh_facets};

/// Another space, where the element is quadratic.
fn on(name: &'static str, change: Change) -> Defect {
    Term::Element.run(name, move |run| {
        let quadratic = run.setup.body.element == Element::P2;
        if quadratic { run.rebuilt(&|space, _| change(space)) } else { run.sound() }
    })
}

/// Gradients are linear on a cell: those at points nearer to the centroid are nearer to their mean.
fn nearer(space: &mut Discretization) {
    let points = space.geometry.shares.len();
    let stride = space.mesh.dimension * space.nodes.a_cell;
    for cell in space.geometry.gradient.chunks_exact_mut(points * stride) {
        for i in 0..stride {
            let mean = (0..points).map(|p| cell[stride * p + i]).sum::<f64>() / points as f64;
            (0..points).for_each(|p| cell[stride * p + i] += 0.1 * (mean - cell[stride * p + i]));
        }
    }
}

pub fn defects() -> Vec<Defect> {
    vec![
        on("equal weights on the edges of Γ3 in place of Simpson's", |space| {
            weigh_facets(space, [1.0 / 3.0; 2]);
        }),
        on("vertices of Γ3 alone carry the laws", |space| weigh_facets(space, [0.5, 0.0])),
        on("quadratic elements with one strain point", |space| {
            space.geometry.shares = vec![1.0, 0.0, 0.0];
        }),
        on("strain points of a triangle weighted 2, 1, 1", |space| {
            space.geometry.shares = vec![0.5, 0.25, 0.25];
        }),
        on("strain points 10 % nearer to the centroid", nearer),
        // Midpoints that follow their corners make linear functions of quadratic ones.
        Term::Element.run("midpoints shown between their corners", |run| {
            let space = &run.data.space;
            run.data.march(run.setup, run.steps, &Newton::default(), &mut |view| {
                let quadratic = run.setup.body.element == Element::P2;
                let linear = quadratic.then(|| midpoints_between_corners(space, view.u));
                (run.observe)(&StepView { u: linear.as_deref().unwrap_or(view.u), ..*view })
            })
        }),
    ]
}
