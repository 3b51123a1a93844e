//! Volumes, faces and nesting of refined tetrahedra.

use std::collections::BTreeMap;

use super::*;
use crate::mesh::coarse::tests::cube;
use crate::mesh::geometry::{cross, dot};
use crate::mesh::{BoundaryFacet, CoarseMesh, Family, Mesh};

/// A regular tetrahedron beside a flat one, so that all three diagonals are chosen in turn.
fn pair() -> CoarseMesh {
    let mut solid = cube();
    solid.vertices = vec![
        [1.0, 1.0, 1.0],
        [1.0, -1.0, -1.0],
        [-1.0, 1.0, -1.0],
        [-1.0, -1.0, 1.0],
        [-2.0, -0.7, -2.5],
    ];
    solid.cells = vec![vec![0, 1, 2, 3], vec![1, 2, 4, 3]];
    solid.region = vec![0, 1];
    solid.regions = vec!["a".into(), "b".into()];
    let corners = [[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 4], [1, 3, 4], [2, 3, 4]];
    solid.facets = (0..).zip(corners).map(|(side, corners)| face(corners, side)).collect();
    solid.sides = (0..6).map(|side| side.to_string()).collect();
    solid.checked().unwrap()
}

fn face(corners: [u32; 3], side: u32) -> BoundaryFacet {
    BoundaryFacet { corners: corners.to_vec(), side, normal: [0.0; 3] }
}

fn volume(mesh: &Mesh, c: usize) -> f64 {
    let at = |a: usize| mesh.point(&[mesh.cell(c)[a]], &[1.0]);
    let [p, q, r] = [1, 2, 3].map(|a| minus(at(a), at(0)));
    dot(cross(p, q), r) / 6.0
}

#[test]
fn cells_of_equal_volume_tile_and_meet_face_to_face() {
    for solid in [cube().checked().unwrap(), pair()] {
        for n in [1, 2, 3, 4, 5] {
            let mesh = solid.refined(n, Family::Structured);
            let pieces = (n * n * n) as usize;
            assert_eq!(mesh.cell_count(), pieces * solid.cells.len());
            for c in 0..mesh.cell_count() {
                let expected = solid.measure_of(c / pieces) / pieces as f64;
                assert!((volume(&mesh, c) / expected - 1.0).abs() < 1e-12, "n = {n}, cell {c}");
            }
            let mut faces: BTreeMap<[u32; 3], usize> = BTreeMap::new();
            for c in 0..mesh.cell_count() {
                for out in 0..4 {
                    let face = mesh.cell(c).iter().enumerate().filter(|(a, _)| *a != out);
                    *faces.entry(sorted(face.map(|(_, v)| *v))).or_default() += 1;
                }
            }
            assert!(faces.values().all(|count| *count <= 2));
            let outer = faces.values().filter(|count| **count == 1).count();
            assert_eq!(outer, mesh.facet_side.len());
            for f in 0..mesh.facet_side.len() {
                assert_eq!(faces.get(&sorted(mesh.facet(f).iter().copied())), Some(&1));
                let at = |a: usize| mesh.point(&[mesh.facet(f)[a]], &[1.0]);
                let out = cross(minus(at(1), at(0)), minus(at(2), at(0)));
                assert!(dot(out, mesh.normal(f)) > (1.0 - 1e-12) * norm(out), "facet {f}");
            }
        }
    }
}

/// Vertices inside move by three coordinates, those of the boundary by none.
#[test]
fn moved_vertices_leave_the_domain_as_it_is() {
    let family = Family::Perturbed { amplitude: 0.24, seed: 5, axes: [true; 3] };
    for solid in [cube().checked().unwrap(), pair()] {
        let (plain, mesh) = (solid.refined(4, Family::Structured), solid.refined(4, family));
        let volumes: Vec<f64> = (0..mesh.cell_count()).map(|c| volume(&mesh, c)).collect();
        assert!(volumes.iter().all(|volume| *volume > 0.0));
        assert!((volumes.iter().sum::<f64>() / solid.measure() - 1.0).abs() < 1e-13);
        let moved = |v: u32, i: usize| mesh.point(&[v], &[1.0])[i] != plain.point(&[v], &[1.0])[i];
        for v in 0..mesh.vertices() as u32 {
            let inside = !mesh.facets.contains(&v);
            assert!((0..3).all(|i| moved(v, i) == inside), "vertex {v}");
        }
    }
}

fn sorted(face: impl Iterator<Item = u32>) -> [u32; 3] {
    let mut face: Vec<u32> = face.collect();
    face.sort_unstable();
    [face[0], face[1], face[2]]
}

/// The shapes of a refined tetrahedron are three at most, whatever n: the worst angle of n = 2 is that of n = 8.
#[test]
fn angles_do_not_degenerate_and_the_shortest_diagonal_is_taken() {
    let solid = pair();
    let angle = |n: u32| solid.refined(n, Family::Structured).quality().smallest_angle;
    assert!((angle(2) - angle(8)).abs() < 1e-9 && (angle(4) - angle(6)).abs() < 1e-9);
    let best = |corners: &[[f64; 3]]| {
        let middles = |order: [usize; 4]| {
            let [a, b, c, d] = order.map(|a| corners[a]);
            norm([0, 1, 2].map(|i| b[i] - a[i] + d[i] - c[i]))
        };
        ORDERS.map(|(order, _)| middles(order)).into_iter().fold(f64::INFINITY, f64::min)
    };
    for c in 0..2 {
        let corners = solid.corners(c);
        let (order, _) = shortest_diagonal(&corners);
        let [p, q, r, s] = order.map(|a| corners[a]);
        let chosen = norm([0, 1, 2].map(|i| q[i] - p[i] + s[i] - r[i]));
        assert!(chosen <= best(&corners) * (1.0 + 1e-8));
    }
    assert_eq!(solid.refined(3, Family::Structured).h(), solid.longest_edge() / 3.0);
}
