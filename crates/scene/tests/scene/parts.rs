//! What laws, friction, sources, names and domains say of themselves, against values by hand.

use super::good::LOADED;
use scene::setup::{Setup, TraceConstant, with_trace_constants};
use scene::{Friction, FrictionBound, Law, Scene, Source, nearest};
use std::f64::consts::SQRT_2;

fn law(points: &[[f64; 2]], slope_before: f64, slope_after: f64) -> Law {
    Law { points: points.to_vec(), slope_before, slope_after, curve: None, scale: None }
}

fn setup(text: String) -> Setup {
    let scene = Scene::from_source(Source::from_text("block.toml", text));
    Setup::new(scene.unwrap_or_else(|error| panic!("{error}")))
        .unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn alpha_is_the_steepest_descent() {
    let points = [[0.0, 0.0], [0.04, 0.08], [0.10, 0.05]];
    assert!((law(&points, 0.0, 0.0).alpha() - 0.5).abs() < 1e-12);
    assert_eq!(law(&[[0.0, 0.0]], 2.0, 2.0).alpha(), 0.0);
    assert_eq!(law(&[[0.0, 0.0]], 1.0, -3.0).alpha(), 3.0);
    let slip = |points: &[[f64; 2]]| Friction { bound: FrictionBound::Slip(points.to_vec()) };
    assert!((slip(&[[0.0, 0.3], [0.1, 0.28], [0.2, 0.27]]).alpha() - 0.2).abs() < 1e-12);
    assert_eq!(slip(&[[0.0, 0.1], [0.1, 0.2]]).alpha(), 0.0);
    assert_eq!(slip(&[[0.0, 0.1]]).alpha(), 0.0);
}

/// The rise of 0.08 over 0.04 in the law of the valid text.
#[test]
fn friction_that_follows_the_law_has_its_steepest_rise() {
    let text = LOADED.replace("judge = true", "violates = [\"2.9\"]");
    let friction = "friction = { bound = { kind = \"coulomb\", coefficient = 0.1 } }\n[loads]";
    let setup = setup(text.replace("[loads]", friction));
    let constants = with_trace_constants(&setup, [&TraceConstant::ZERO; 3]);
    assert!((constants.coulomb.unwrap().rise - 2.0).abs() < 1e-12);
}

#[test]
fn a_jump_upward_costs_nothing() {
    let jump = law(&[[0.0, 0.0], [0.0, 1.0], [2.0, 0.0]], 0.0, 0.0);
    assert!(jump.is_set_valued());
    assert!((jump.alpha() - 0.5).abs() < 1e-15);
}

/// Records of different meshes must differ.
#[test]
fn the_mesh_is_part_of_the_hash() {
    let of = |mesh: &str| Source::from_text("a.toml", "text").with_mesh(mesh.into()).hash;
    let plain = Source::from_text("a.toml", "text").hash;
    assert!(of("one") == of("one") && of("one") != of("two") && of("one") != plain);
}

#[test]
fn only_what_may_be_meant_is_offered() {
    assert_eq!(nearest("quadrture", ["gap", "quadrature"]), Some("quadrature"));
    assert_eq!(nearest("colour", ["gap", "law"]), None);
    assert_eq!(nearest("a", ["b"]), None);
}

/// The proved bound of c_j² of a polygon turned and moved: contact on one of its edges, numbered from 1, and one clamped or
/// all others.
fn depth(vertices: &[[f64; 2]], contact: usize, clamped: Option<usize>) -> Option<f64> {
    let turn = |&[x, y]: &[f64; 2]| [0.6 * x - 0.8 * y + 2.0, 0.8 * x + 0.6 * y];
    let turned: Vec<[f64; 2]> = vertices.iter().map(turn).collect();
    let others = (1..=vertices.len()).filter(|edge| *edge != contact);
    let (held, free): (Vec<_>, Vec<_>) =
        others.partition(|edge| clamped.is_none_or(|one| one == *edge));
    let names = |edges: &[usize]| edges.iter().map(|edge| format!("s{edge}")).collect::<Vec<_>>();
    let setup = setup(format!(
        "[scene]\nname = \"depth\"\nquestion = \"How deep?\"\ndimension = 2\njudge = false\n[domain]\nshape = \"polygon\"\nvertices = {turned:?}\nclamped = {:?}\ntraction = {:?}\ncontact = [\"s{contact}\"]\n[time]\nhorizon = 1.0\n[material]\nlambda = 1.0\nmu_L = 1.0\n[contact]\n[loads]\nbody = [\"0\", \"0\"]\n",
        names(&held),
        names(&free)
    ));
    with_trace_constants(&setup, [&TraceConstant::ZERO; 3]).c_j_squared_bound
}

#[test]
fn depths_of_known_shapes() {
    let is = |found: Option<f64>, known: f64| (found.unwrap() - known).abs() < 1e-12;
    // The lines from the bottom end on the right, top and left edges: the deepest at (1.5, 1).
    let trapezium = [[0.0, 0.0], [2.0, 0.0], [1.5, 1.0], [0.5, 0.8]];
    assert!(is(depth(&trapezium, 1, None), 1.0));
    assert_eq!(depth(&trapezium, 1, Some(3)), None);
    // From the top down all lines end on the bottom.
    assert!(depth(&trapezium, 3, Some(1)).is_some());
    let notch = [[0.0, 0.0], [3.0, 0.0], [3.0, 2.0], [2.0, 2.0], [2.0, 0.5], [1.0, 0.5]];
    let notch = [&notch[..], &[[1.0, 2.0], [0.0, 2.0]]].concat();
    assert!(is(depth(&notch, 1, None), 2.0));
    // From the left wall of the notch, lines run to the left side.
    assert!(is(depth(&notch, 6, Some(8)), 1.0));
}

fn limit(error: impl Fn(i32) -> f64) -> TraceConstant {
    TraceConstant::new((0..3).map(|i| (1 << i, 2.0 - error(i))).collect(), None)
}

/// Of 2 with errors of all kinds: smooth, of a corner, of the worst corner, of both, and of one that hides at first.
#[test]
fn the_limit_lies_within_the_uncertainty() {
    let pow = |base: f64| move |i: i32| 0.1 * base.powi(-i);
    let found = [pow(16.0), pow(2.0), pow(SQRT_2)].map(limit);
    let found = found.into_iter().chain([
        limit(|i| pow(16.0)(i) + 0.01 * pow(SQRT_2)(i)),
        limit(|i| pow(4.0)(i) + 0.05 * pow(2.0)(i)),
    ]);
    for found in found {
        let [low, high] = found.range();
        assert!(low < 2.0 + 1e-12 && high > 2.0 - 1e-12, "{found:?}");
        assert!((found.value - 2.0).abs() <= found.uncertainty + 1e-12, "{found:?}");
        // Rounding of an eigenvalue is 1e-9 of it.
        assert!(found.uncertainty >= 1e-9 * 2.0 && found.uncertainty < 0.2, "{found:?}");
    }
}

/// Growth that does not become less shows no limit, nor does a single mesh; a proved bound that is attained does.
#[test]
fn what_does_not_settle_is_not_known() {
    assert_eq!(limit(|i| 1.0 - 0.1 * f64::from(i)).uncertainty, f64::INFINITY);
    let one = |bound| TraceConstant::new(vec![(8, 2.0)], bound);
    assert_eq!(one(None).range()[1], f64::INFINITY);
    assert_eq!(one(Some(2.5)).range()[1], 2.5);
    assert!((one(Some(2.0)).range()[0] - 2.0).abs() < 1e-8);
}
