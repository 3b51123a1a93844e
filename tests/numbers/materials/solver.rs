//! The solver with tensors by region, in full, and several terms of memory, in the plane and in space.

use fem::contact::{ContactProblem, Discretization, LastSlot, MemoryTerm, Model, StepView, march};
use fem::mesh::{Family, Mesh, lattice};
use scene::Norm;
use vhi::Newton;
use vhi::history::{TimeGrid, Trapezoid};
use vhi::law::{AnyProjection, ExponentialSum, FourthOrder, Isotropic, TensorField, VonMises};

use crate::differences;
use crate::judged::record;
use crate::shipped::{on_mesh, setup};
use crate::wrong::Limit;

const SOFT: Isotropic = Isotropic { lambda: 0.4, mu: 0.7 };

/// A symmetric positive definite matrix without zeros: the identity times 3, and a smooth rest.
fn anisotropic() -> FourthOrder {
    let rest = |i: usize, j: usize| 0.3 * (1.0 + (i * j) as f64).cos();
    FourthOrder::Full(std::array::from_fn(|i| {
        std::array::from_fn(|j| rest(i, j) + if i == j { 3.0 } else { 0.0 })
    }))
}

/// Two halves of a body, one above y = ½.
fn halves(mesh: Mesh, clamped: &[&str]) -> Discretization {
    let sides: Vec<u32> = clamped.iter().filter_map(|name| mesh.side(name)).collect();
    let mut space = Discretization::new(mesh, &sides, &[]);
    let share = 1.0 / (space.mesh.dimension + 1) as f64;
    let upper = |c: usize| {
        let cell = space.mesh.cell(c);
        space.mesh.point(cell, &vec![share; cell.len()])[1] > 0.5
    };
    space.regions = (0..space.mesh.cell_count()).map(|c| u8::from(upper(c))).collect();
    space
}

fn kernel(a: f64, c: f64) -> Box<ExponentialSum> {
    Box::new(ExponentialSum { terms: vec![(a, c)] })
}

fn terms() -> Vec<MemoryTerm> {
    let second = TensorField::new(Isotropic { lambda: 0.0, mu: 0.2 }.into(), [anisotropic()]);
    vec![
        MemoryTerm { kernel: kernel(-1.0, 1.0), tensor: Isotropic { lambda: 0.1, mu: 0.3 }.into() },
        MemoryTerm { kernel: kernel(0.1, 3.0), tensor: second },
    ]
}

/// [`differences::mismatch`] with projection, ζ, regions and two terms of memory.
fn mismatch(space: &Discretization, weights: &[f64]) -> f64 {
    let model = Model {
        elasticity: TensorField::new(SOFT.into(), [anisotropic()]),
        memory: terms(),
        projection: Some(AnyProjection::new(VonMises {
            mu: 0.7,
            limit: Limit { value: |zeta: f64| 0.1 + 0.2 * zeta, slope: |_: f64| 0.2 },
        })),
        boundary: Vec::new(),
        friction: None,
        time_rule: Box::new(Trapezoid),
    };
    let mut problem = ContactProblem::new(space, &model).expect("an analysis");
    let order = space.dofs();
    let slot = LastSlot { zeta: 0.4, memory: weights.to_vec() };
    problem.begin(&slot, 0.3, &vec![0.0; order], &[]);
    let u: Vec<f64> = (0..order).map(|i| 0.2 * (1.7 * i as f64).sin()).collect();
    let d: Vec<f64> = (0..order).map(|i| (0.9 * i as f64).cos()).collect();
    differences::mismatch(&mut problem, &u, &d)
}

#[test]
fn the_tangent_is_the_derivative_of_the_force() {
    let family = Family::Perturbed { amplitude: 0.1, seed: 3, axes: [true; 3] };
    let plane = halves(lattice([1.0, 1.0], 4, family), &["top"]);
    let solid = halves(lattice([1.0, 1.0, 1.0], 2, family), &["top"]);
    for space in [&plane, &solid] {
        // Truncation 1e-12 over curvature, rounding 1e-16/1e-6 times the condition of the matrix.
        let off = mismatch(space, &[-0.2, 0.05]);
        assert!(off < 1e-6, "{off:e}");
        assert!(mismatch(space, &[]) < 1e-6);
    }
}

/// Final displacements of a body under a constant load, N = 4.
fn marched(space: &Discretization, elasticity: TensorField, memory: Vec<MemoryTerm>) -> Vec<f64> {
    struct Weight(Vec<f64>);
    impl fem::contact::Load for Weight {
        fn assemble(&mut self, t: f64, out: &mut [f64]) -> Result<(), fem::contact::LoadError> {
            out.iter_mut().zip(&self.0).for_each(|(out, force)| *out = (1.0 + t) * force);
            Ok(())
        }
    }
    let time_rule = Box::new(Trapezoid);
    let model = Model {
        elasticity,
        memory,
        projection: None,
        boundary: Vec::new(),
        friction: None,
        time_rule,
    };
    let mut load = Weight((0..space.dofs()).map(|i| (0.3 * i as f64).sin()).collect());
    let (grid, mut last) = (TimeGrid::uniform(1.0, 4), Vec::new());
    let mut keep = |view: &StepView<'_>| {
        last = view.u.to_vec();
        Ok(())
    };
    march(space, &model, &grid, &mut load, &Newton::default(), &mut keep).expect("a march");
    last
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    let size = a.iter().fold(0.0f64, |size, a| size.max(a.abs()));
    a.iter().zip(b).fold(0.0f64, |off, (a, b)| off.max((a - b).abs())) / size
}

/// One law in several disguises: regions that agree, the isotropic tensor in full, a kernel split in two terms, bulk and
/// shear with the same kernel. In each a change of 1e-6 is seen.
#[test]
fn disguises_of_one_material_agree() {
    let plane = halves(lattice([1.0, 1.0], 4, Family::Structured), &["top"]);
    let solid = halves(lattice([1.0, 1.0, 1.0], 2, Family::Structured), &["top"]);
    for (space, d) in [(&plane, 2), (&solid, 3)] {
        let term = |a: f64, tensor: TensorField| MemoryTerm { kernel: kernel(a, 1.0), tensor };
        let memory = Isotropic { lambda: 0.1, mu: 0.3 };
        let plain = || vec![term(-1.0, memory.into())];
        let base = marched(space, SOFT.into(), plain());
        let full = |more: f64| {
            let zero = FourthOrder::Full([[0.0; 6]; 6]);
            let mut sum = zero.plus(1.0, &SOFT.into(), d);
            if let FourthOrder::Full(matrix) = &mut sum {
                matrix[d][d] *= 1.0 + more;
            }
            TensorField::new(SOFT.into(), [sum])
        };
        let split = |share: f64| {
            let bulk = Isotropic { lambda: memory.lambda + 2.0 * memory.mu / d as f64, mu: 0.0 };
            let shear = Isotropic { lambda: -2.0 * memory.mu / d as f64, mu: share * memory.mu };
            vec![term(-1.0, bulk.into()), term(-1.0, shear.into())]
        };
        let halved = |a: f64| vec![term(a, memory.into()), term(-0.5, memory.into())];
        // Rounding of two paths through a solve with condition 1e3.
        let same = |u: Vec<f64>| assert!(distance(&base, &u) < 1e-12, "{:e}", distance(&base, &u));
        let other = |u: Vec<f64>| assert!(distance(&base, &u) > 1e-9, "{:e}", distance(&base, &u));
        same(marched(space, TensorField::new(SOFT.into(), [SOFT.into()]), plain()));
        same(marched(space, full(0.0), plain()));
        other(marched(space, full(1e-6), plain()));
        same(marched(space, SOFT.into(), split(1.0)));
        other(marched(space, SOFT.into(), split(1.0 + 1e-6)));
        same(marched(space, SOFT.into(), halved(-0.5)));
        other(marched(space, SOFT.into(), halved(-0.5 * (1.0 + 1e-6))));
    }
}

/// A scalar kernel keeps its cheap path: one solve a step and one state an exponential; a second term costs as much
/// again.
#[test]
fn absent_terms_cost_nothing() {
    // (factorizations, bytes of history) of 16 steps with 40 unknowns.
    let cost = |name: &str| {
        let setup = setup(name);
        let record = record(&setup, &on_mesh(&setup, 4), 4, 16, &[Norm::VMax]);
        assert_eq!(record.dofs, 40);
        (record.factorizations, record.peak_history_bytes as usize)
    };
    // A state an exponential and u_{n-1}; the whole past; both terms.
    let vectors = |count: usize| count * 40 * size_of::<f64>();
    assert_eq!(cost("viscoelastic"), (1, vectors(2)));
    assert_eq!(cost("prony").1, vectors(3));
    assert_eq!(cost("power-law").1, vectors(17));
    assert_eq!(cost("bulk-shear").1, vectors(5));
    assert_eq!(cost("orthotropic"), (1, 0));
    // Equal kernels in different regions are one term.
    assert_eq!(setup("layered").model.memory.len(), 1);
    assert!(setup("viscoelastic").space(4).expect("a space").regions.is_empty());
}
