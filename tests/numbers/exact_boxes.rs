//! Source: (5.1)-(5.5) in three dimensions; loads, moments, checks and reference runs of exact solutions on boxes.
//! Goal: every term of the manufactured side in space agrees with hand calculation or with another integral; a plane
//!   scene stated as a box with exact tractions on its ends has the plane solution; the order in time is 2 where u(t) is
//!   in V^h; a lost end traction and a body force of another shear modulus are seen.
//! Mesh: boxes of n³ cubes, six tetrahedra each; top (y = 1) clamped, bottom in contact.
//! Data: affine-box, pure-box, sourced-box, and affine continued along z.

use std::sync::Arc;

use crate::shipped::{edited, on_mesh, relative, run, setup, setup_of, text, v_max};
use exact::{Exact, ExactOnMesh, LoadForm, Status, Truth, check};
use fem::norms::{ReferenceRun, step_errors};
use fem::space::quadrature::{Rule, TruthRules, tetrahedron_product};
use formula::Program;
use scene::setup::{MeshData, Setup, side_numbers, sides};

fn exact(setup: &Setup) -> Arc<Exact> {
    setup.exact.clone().expect("an exact solution")
}

/// The work of a load on v = (1 - y) e_i, which is in V^h.
fn work(data: &MeshData, load: &[f64], i: usize) -> f64 {
    let space = &data.space;
    let height = |node: usize| 1.0 - space.mesh.vertex(space.nodes.vertex[node])[1];
    (0..space.nodes.free).map(|node| height(node) * load[3 * node + i]).sum()
}

/// σ_iy of affine-box at t, with deviators ε - tr/`d` I; histories by Simpson's rule on 400 intervals.
fn traction(t: f64, d: f64) -> [f64; 3] {
    let [a, b, c] = [
        |s: f64| 0.08 * s * (2.0 - s),
        |s: f64| 0.3 * (2.0 * s).sin(),
        |s: f64| 0.2 * s * (1.0 + s),
    ];
    let simpson = |f: &dyn Fn(f64) -> f64| {
        let (count, step) = (400, t / 400.0);
        let weight = |i: i32| [2.0, 4.0][i as usize % 2] - f64::from(i == 0 || i == count);
        (0..=count).map(|i| weight(i) * f(step * f64::from(i))).sum::<f64>() * step / 3.0
    };
    let fading = |f: fn(f64) -> f64| simpson(&|s| -(s - t).exp() * f(s));
    // ε has yy = a, xy = -b/2, yz = -c/2 alone.
    let shear = |s: f64| 0.5 * (b(s).powi(2) + c(s).powi(2));
    let kappa = 0.10 + 0.05 * simpson(&|s| (a(s).powi(2) + shear(s)).sqrt());
    let trace = a(t) / d;
    let length = ((a(t) - trace).powi(2) + 2.0 * trace * trace + shear(t)).sqrt();
    let excess = (1.0 - kappa / length).max(0.0);
    let of_shear = |e: f64, h: f64| -0.5 * (2.0 * e + excess * e + 0.5 * h);
    let normal = 3.0 * a(t) + excess * (a(t) - trace) + 0.75 * fading(a);
    [of_shear(b(t), fading(b)), normal, of_shear(c(t), fading(c))]
}

/// F((1-y) e_i) = -σ_iy + c (v_ν on the bottom is -v_y) on the unit cube.
#[test]
fn loads_of_the_affine_box_are_those_by_hand() {
    let setup = setup("affine-box");
    let data = on_mesh(&setup, 2);
    for t in [0.4, 1.0] {
        let load = data.truth.load(t).expect("a load");
        let r = 0.08 * t * (2.0 - t);
        let pressure = if r <= 0.04 { 2.0 * r } else { 0.08 - 0.5 * (r - 0.04) };
        let by_hand = |d: f64, i: usize| -traction(t, d)[i] - if i == 1 { pressure } else { 0.0 };
        for i in 0..3 {
            // Simpson's rule: (1/400)⁴ times fourth derivatives of size 10; near t = 0 ‖ε‖ is smooth in t.
            assert!((work(&data, &load, i) - by_hand(3.0, i)).abs() < 1e-8, "{t} {i}");
        }
        let plane = (0..3).map(|i| (work(&data, &load, i) - by_hand(2.0, i)).abs());
        assert!(plane.fold(0.0, f64::max) > 1e-3, "the trace of the plane would pass");
    }
}

/// Both load vectors on the mesh n at t = 1, with f2 on the given sides; the largest difference over the largest force.
fn forms_apart(setup: &Setup, exact: &Arc<Exact>, n: u32, traction: &[&str]) -> f64 {
    let data = on_mesh(setup, n);
    let kept: Vec<u32> = traction.iter().filter_map(|name| data.space.mesh.side(name)).collect();
    let load = |form| {
        let rules = TruthRules::of(3);
        let on_mesh = ExactOnMesh::new(exact.clone(), data.space.clone(), form, &kept, &rules);
        on_mesh.load(1.0).expect("a load")
    };
    let (weak, strong) = (load(LoadForm::Weak), load(LoadForm::Strong));
    let size = weak.iter().fold(0.0, |size: f64, f| size.max(f.abs()));
    weak.iter().zip(&*strong).map(|(a, b)| (a - b).abs() / size).fold(0.0, f64::max)
}

#[test]
fn strong_loads_are_the_weak_ones_with_all_four_tractions() {
    let setup = setup("sourced-box");
    let all = ["left", "right", "front", "back"];
    // Polynomials of degree 3 in space, within the degree of the rules: rounding.
    assert!(forms_apart(&setup, &exact(&setup), 2, &all) < 1e-12);
    for lost in 0..4 {
        let kept: Vec<&str> = (0..4).filter(|side| *side != lost).map(|side| all[side]).collect();
        assert!(forms_apart(&setup, &exact(&setup), 2, &kept) > 1e-2, "without {}", all[lost]);
    }
}

/// ‖ε(u - u_h)‖ and ‖u - u_h‖ by a rule of degree 9, with gradients of u_h from its values at the corners.
fn by_another_rule(exact: &Exact, data: &MeshData, t: f64, u: &[f64]) -> [f64; 2] {
    let (mesh, rule) = (&data.space.mesh, tetrahedron_product(6));
    let Rule { points, weights } = &rule;
    let graph = exact.data.graph.clone();
    let nodes: Vec<_> = exact.data.u.iter().chain(&exact.strain).copied().collect();
    let program = Program::compile(&graph, &nodes, exact.data.horizon);
    let (mut strain, mut l2) = (0.0, 0.0);
    for c in 0..mesh.cell_count() {
        let at: Vec<[f64; 3]> = points.iter().map(|b| mesh.point(mesh.cell(c), b)).collect();
        let mut out = vec![Vec::new(); 9];
        program.bind(&at).evaluate(t, 0.0, &mut out);
        let corner: Vec<nalgebra::Vector3<f64>> =
            mesh.cell(c).iter().map(|&v| mesh.point(&[v], &[1.0]).into()).collect();
        let value = |a: usize| {
            let node = data.space.nodes.of_vertex[mesh.cell(c)[a] as usize] as usize;
            nalgebra::Vector3::from_column_slice(&u[3 * node..3 * node + 3])
        };
        let columns = |f: &dyn Fn(usize) -> nalgebra::Vector3<f64>| {
            nalgebra::Matrix3::from_columns(&[f(1) - f(0), f(2) - f(0), f(3) - f(0)])
        };
        let edges = columns(&|a| corner[a]);
        let gradient = columns(&value) * edges.try_inverse().expect("a cell");
        let discrete = 0.5 * (gradient + gradient.transpose());
        for (q, weight) in weights.iter().enumerate() {
            let measure = weight * edges.determinant() / 6.0;
            let place = nalgebra::Vector3::from(at[q]);
            let discrete_u = value(0) + gradient * (place - corner[0]);
            l2 += measure * (0..3).map(|i| (out[i][q] - discrete_u[i]).powi(2)).sum::<f64>();
            let list =
                [(0, 0, 1.0), (0, 1, 2.0), (0, 2, 2.0), (1, 1, 1.0), (1, 2, 2.0), (2, 2, 1.0)];
            for (m, (i, j, count)) in list.into_iter().enumerate() {
                strain += measure * count * (out[3 + m][q] - discrete[(i, j)]).powi(2);
            }
        }
    }
    [strain.sqrt(), l2.sqrt()]
}

#[test]
fn errors_are_those_of_another_integral() {
    for name in ["sourced-box", "pure-box"] {
        let setup = setup(name);
        let (exact, data) = (exact(&setup), on_mesh(&setup, 2));
        let mut level = 0;
        run(&setup, &setup.model, &data, 2, |view| {
            let moments = data.truth.moments(view.t).expect("moments");
            let found = step_errors(&data.space, &setup.model, view, &moments);
            let [v, l2] = by_another_rule(&exact, &data, view.t, view.u);
            // Squares of strains have degree 6, within both rules; those of u 8, beyond the weaker one, on cells of size ½.
            assert!(relative(found.v, v) < 1e-11, "{name}: {} {v}", found.v);
            assert!(relative(found.l2, l2) < 1e-4, "{name}: {} {l2}", found.l2);
            level += 1;
        })
        .unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(level, 3);
    }
}

/// affine without projection as a box, in strong form: f2 acts on left, right, front and back.
fn extruded(without: [&str; 2]) -> [Setup; 2] {
    let cut = |text: &str, from: &str, to: &str| {
        let (before, after) = text.split_once(from).expect("a term");
        format!("{before}{to}{}", after.split_once(to).expect("the next term").1)
    };
    let plane = cut(&text("affine"), "[material.projection]", "[contact]");
    let plane = cut(&plane, without[0], without[1]);
    let solid = edited(&plane, "dimension = 2", "dimension = 3");
    let solid = edited(&solid, "\"rectangle\"", "\"box\"");
    let solid = edited(&solid, "size = [1.0, 1.0]", "size = [1.0, 1.0, 0.5]");
    let solid =
        edited(&solid, "[\"left\", \"right\"]", "[\"left\", \"right\", \"front\", \"back\"]");
    let solid = edited(&solid, "\"-a*(1 - y)\"]", "\"-a*(1 - y)\", \"0\"]\nform = \"strong\"");
    [setup_of(plane), setup_of(solid)]
}

/// Largest difference of two runs at common vertices, over all levels.
fn apart(plane: &Setup, solid: &Setup, solid_data: &MeshData) -> f64 {
    let flat = on_mesh(plane, 4);
    let mut levels: Vec<Vec<f64>> = Vec::new();
    run(plane, &plane.model, &flat, 4, |view| levels.push(view.u.to_vec())).expect("a plane run");
    let (mut worst, mut common, mut level) = (0.0f64, 0, 0);
    run(solid, &solid.model, solid_data, 4, |view| {
        let space = &solid_data.space;
        for v in 0..space.mesh.vertices() {
            let x = space.mesh.vertex(v as u32);
            let same = |p: &usize| (0..2).all(|i| flat.space.mesh.vertex(*p as u32)[i] == x[i]);
            let Some(p) = (0..flat.space.mesh.vertices()).find(same) else { continue };
            let at_node = &view.u[3 * space.nodes.of_vertex[v] as usize..][..3];
            let twin = &levels[level][2 * flat.space.nodes.of_vertex[p] as usize..][..2];
            let differences = [at_node[0] - twin[0], at_node[1] - twin[1], at_node[2]];
            worst = differences.iter().fold(worst, |worst, d| worst.max(d.abs()));
            common += 1;
        }
        level += 1;
    })
    .expect("a run in space");
    assert_eq!((level, common), (5, 5 * 75));
    worst
}

/// With memory and law together the time error meets the law, and the discrete solution is no longer one tensor:
/// each alone.
#[test]
fn an_affine_scene_with_exact_end_tractions_has_the_plane_solution() {
    for without in [["[material.memory]", "[contact]"], ["law =", "quadrature"]] {
        let [plane, solid] = extruded(without);
        let data = on_mesh(&solid, 4);
        // Displacements of 0.3, a Newton tolerance of 16 units of rounding, a condition below 1e3.
        let off = apart(&plane, &solid, &data);
        assert!(off < 1e-12, "{without:?}: {off:e}");
        // Without the traction σ_zz on the ends the box bulges.
        let kept = &solid.body.domain.traction[..2];
        let (space, rules) = (data.space.clone(), TruthRules::of(3));
        let kept = side_numbers(kept);
        let free = ExactOnMesh::new(exact(&solid), space.clone(), LoadForm::Strong, &kept, &rules);
        let free = MeshData::with_truth(space, Arc::new(free));
        assert!(apart(&plane, &solid, &free) > 1e-4, "{without:?}");
    }
}

/// With μ = 0 a smooth scene continued along z has the plane one's exact solution: the two discrete solutions differ by
/// their errors at most, and the errors are of one size.
#[test]
fn errors_of_a_smooth_scene_continued_along_z_are_of_the_plane_size() {
    let plane = text("viscoelastic");
    let solid = edited(&plane, "dimension = 2", "dimension = 3");
    let solid = edited(&solid, "\"rectangle\"", "\"box\"");
    let solid = edited(&solid, "size = [1.0, 1.0]", "size = [1.0, 1.0, 1.0]");
    let (before, after) = solid.split_once("u = [").expect("u");
    let (u, rest) = after.split_once("]\n").expect("the end of u");
    let solid = format!("{before}u = [{u}, \"0\"]\n{rest}");
    let (open, close) = solid.split_once("traction = [").expect("traction");
    let solid = setup_of(format!("{open}traction = [\"front\", \"back\", {close}"));
    let plane = setup_of(plane);
    let error = |setup: &Setup| v_max(setup, &setup.model, &on_mesh(setup, 4), 2);
    let (flat, deep) = (error(&plane), error(&solid));
    assert!(relative(deep, flat) < 0.1, "{deep} {flat}");
}

/// u(t) in V^h with every term: the interpolant of pure-box, with the histories of the interpolant.
#[test]
fn the_order_in_time_of_an_interpolated_box_is_two() {
    let inside = edited(&text("pure-box"), "u = [", "interpolated = true\nu = [");
    let setup = setup_of(inside);
    let data = on_mesh(&setup, 3);
    let found = [8, 16, 32].map(|steps| v_max(&setup, &setup.model, &data, steps));
    for pair in found.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((1.95..=2.05).contains(&order), "{order}: {found:?}");
    }
}

#[test]
fn checks_pass_and_see_wrong_data() {
    let failed = |exact: &Exact, sides: &[_]| {
        let found = check(exact, sides);
        found.iter().filter(|finding| finding.status == Status::Failed).count()
    };
    for name in ["pure-box", "sourced-box", "affine-box"] {
        let setup = setup(name);
        let (all, sound) = (sides(&setup.body), exact(&setup));
        let findings = check(&sound, &all);
        assert!(findings.iter().all(|f| f.status != Status::Failed), "{name}: {findings:#?}");
        let pure = findings.iter().any(|finding| finding.text.starts_with("pure"));
        assert_eq!(pure, name == "pure-box", "{findings:#?}");
        // A face without its traction.
        let lost: Vec<_> = all.iter().filter(|of| of.face.normal[2] != 1.0).cloned().collect();
        assert_eq!(lost.len(), 5);
        assert!(failed(&sound, &lost) > 0, "{name}");
        if name == "affine-box" {
            // Its stress is constant: in balance whatever the modulus.
            continue;
        }
        // A body force of another shear modulus.
        drop(sound);
        let owned = |setup: Setup| {
            Arc::into_inner(setup.exact.expect("an exact solution")).expect("one owner")
        };
        let mut other = owned(crate::shipped::setup(name)).data;
        other.material.mu_l *= 1.05;
        let mut exact = owned(setup);
        exact.forces = Exact::new(other).forces;
        assert!(failed(&exact, &all) > 0, "{name}");
    }
}

/// The value at x of a P1 function on the structured mesh of a unit cube: on the path of the sorted coordinates.
fn interpolated(data: &MeshData, n: u32, u: &[f64], x: &[f64]) -> [f64; 3] {
    let space = &data.space;
    let scaled: Vec<f64> = x.iter().map(|x| x * f64::from(n)).collect();
    let low: Vec<f64> = scaled.iter().map(|x| x.floor().min(f64::from(n) - 1.0)).collect();
    let share: Vec<f64> = scaled.iter().zip(&low).map(|(x, low)| x - low).collect();
    let mut order = [0, 1, 2];
    order.sort_by(|&i, &j| share[j].total_cmp(&share[i]));
    let mut corner: Vec<usize> = low.iter().map(|x| *x as usize).collect();
    let mut weights = vec![1.0 - share[order[0]]];
    weights.extend((0..2).map(|i| share[order[i]] - share[order[i + 1]]));
    weights.push(share[order[2]]);
    let mut value = [0.0; 3];
    for (step, weight) in weights.into_iter().enumerate() {
        if step > 0 {
            corner[order[step - 1]] += 1;
        }
        let count = n as usize + 1;
        let vertex = (corner[2] * count + corner[1]) * count + corner[0];
        let node = space.nodes.of_vertex[vertex] as usize;
        value.iter_mut().zip(&u[3 * node..]).for_each(|(v, u)| *v += weight * u);
    }
    value
}

/// Distances to a finer run by moments on the coarse mesh, and by both functions on the fine one.
#[test]
fn errors_against_a_reference_run_are_distances_on_its_mesh() {
    let setup = setup("punch-box");
    let fine = on_mesh(&setup, 6);
    let (mut reference, mut known) = (ReferenceRun::new(fine.space.clone()), Vec::new());
    run(&setup, &setup.model, &fine, 2, |view| {
        reference.keep(&setup.model, view);
        known.push(view.u.to_vec());
    })
    .expect("a fine run");
    for n in [2, 3] {
        let coarse = on_mesh(&setup, n);
        let refinement = reference.refinement(&coarse.space).expect("nested meshes");
        let mut level = 0;
        run(&setup, &setup.model, &coarse, 2, |view| {
            let moments = reference.moments(&refinement, &coarse.space, view.t).expect("moments");
            let found = step_errors(&coarse.space, &setup.model, view, &moments);
            let space = &fine.space;
            let mut difference = known[level].clone();
            for v in 0..space.mesh.vertices() {
                let coarse_u = interpolated(&coarse, n, view.u, space.mesh.vertex(v as u32));
                let at = 3 * space.nodes.of_vertex[v] as usize;
                (0..3).for_each(|i| difference[at + i] -= coarse_u[i]);
            }
            let v = fem::contact::strain_norm(space, &difference);
            // ∫ d² of a linear d on a triangle: |F|/12 (Σ d_a² + (Σ d_a)²).
            let on_facet = |f: usize| {
                let d = space
                    .trace
                    .facet(f)
                    .iter()
                    .map(|&i| space.trace.normal(i as usize, &difference));
                let (sum, squares) = d.fold((0.0, 0.0), |(s, q), d| (s + d, q + d * d));
                space.trace.measure[f] / 12.0 * (squares + sum * sum)
            };
            let trace = (0..space.trace.measure.len()).map(on_facet).sum::<f64>().sqrt();
            if level > 0 {
                // Squares are differences of numbers 10 to 100 times as large.
                assert!(relative(found.v, v) < 1e-11, "{} {v}", found.v);
                assert!(relative(found.trace, trace) < 1e-9, "{} {trace}", found.trace);
                assert!(
                    found.stress > found.v
                        && found.pressure > 0.0
                        && found.contact_set <= 2f64.sqrt()
                );
            }
            level += 1;
        })
        .expect("a coarse run");
        assert_eq!(level, 3);
    }
    assert!(reference.refinement(&on_mesh(&setup, 4).space).is_err());
}
