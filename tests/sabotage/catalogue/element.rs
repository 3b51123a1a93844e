//! Wrong quadratic elements: weights on Γ3, points and weights of strains, nodes at midpoints.

use fem::contact::{Discretization, StepView};
use fem::space::Element;
use scene::setup::Setup;
use vhi::Newton;

use super::contact::rebuilt;
use super::{Defect, March, Term, marched};
use crate::shipped::{Change, midpoints_between_corners, weigh_facets};

/// Another march, where the element is quadratic.
fn quadratic(setup: Setup, march: March) -> Setup {
    if setup.body.element == Element::P2 { marched(setup, march) } else { setup }
}

macro_rules! on {
    ($name:literal, $change:expr) => {
        Defect::of(Term::Element, $name, |setup| {
            quadratic(setup, |setup, data, steps, observe| {
                let change: Change = $change;
                rebuilt(setup, data, steps, observe, |space, _| change(space))
            })
        })
    };
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

/// Midpoints that follow their corners make linear functions of quadratic ones.
fn linear(setup: Setup) -> Setup {
    quadratic(setup, |setup, data, steps, observe| {
        let space = &data.space;
        data.march(setup, steps, &Newton::default(), &mut |view| {
            let u = midpoints_between_corners(space, view.u);
            observe(&StepView { u: &u, ..*view })
        })
    })
}

pub fn defects() -> Vec<Defect> {
    vec![
        on!("equal weights on the edges of Γ3 in place of Simpson's", |s| weigh_facets(
            s,
            [1.0 / 3.0; 2]
        )),
        on!("vertices of Γ3 alone carry the laws", |s| weigh_facets(s, [0.5, 0.0])),
        on!("quadratic elements with one strain point", |s| s.geometry.shares =
            vec![1.0, 0.0, 0.0]),
        on!("strain points of a triangle weighted 2, 1, 1", |s| s.geometry.shares =
            vec![0.5, 0.25, 0.25]),
        on!("strain points 10 % nearer to the centroid", nearer),
        Defect::of(Term::Element, "midpoints shown between their corners", linear),
    ]
}
