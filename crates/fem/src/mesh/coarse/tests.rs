//! A square and the six tetrahedra of a cube, whole and damaged.

use super::*;

fn facet(corners: &[u32], side: u32) -> BoundaryFacet {
    BoundaryFacet { corners: corners.to_vec(), side, normal: [0.0; 3] }
}

fn square() -> CoarseMesh {
    CoarseMesh {
        dimension: 2,
        vertices: [[0.0, 0.0], [1.0, 0.0], [9.0, 9.0], [1.0, 1.0], [0.0, 1.0]]
            .map(|[x, y]| [x, y, 0.0])
            .to_vec(),
        cells: vec![vec![0, 3, 1], vec![0, 3, 4]],
        region: vec![0, 0],
        regions: vec!["body".into()],
        facets: [([1, 0], 0), ([1, 3], 1), ([3, 4], 2), ([4, 0], 1)]
            .map(|(ends, side)| facet(&ends, side))
            .to_vec(),
        sides: vec!["bottom".into(), "free".into(), "top".into()],
        inner: Vec::new(),
    }
}

#[test]
fn triangles_and_edges_are_turned_and_unused_vertices_go() {
    let coarse = square().checked().unwrap();
    assert_eq!(coarse.vertices.len(), 4);
    assert!((0..2).all(|t| coarse.measure_of(t) == 0.5));
    let Piece { corners, normal, .. } = coarse.piece(&coarse.facets[0]);
    assert_eq!((&corners[..], normal), (&[[0.0; 3], [1.0, 0.0, 0.0]][..], [0.0, -1.0, 0.0]));
    assert_eq!(coarse.longest_edge(), 2f64.sqrt());
    assert_eq!(coarse.bounds(), [[0.0; 3], [1.0, 1.0, 0.0]]);
}

#[test]
fn what_is_no_plane_domain_is_refused() {
    type Defect = fn(&mut CoarseMesh);
    let cases: [(Defect, &str); 10] = [
        (|c| c.vertices[3] = [0.5, 0.0, 0.0], "the triangle has no area"),
        (|c| c.vertices[3][0] = f64::NAN, "has no area"),
        (|c| c.cells[1][2] = 7, "names vertex 7, and there are 5"),
        (|c| c.cells.push(vec![0, 1, 3]), "belongs to another one on the same side"),
        (|c| c.facets.truncate(3), "the edge [[0.0, 1.0], [0.0, 0.0]] bounds"),
        (|c| c.facets[2].corners = vec![0, 3], "which does not bound the domain"),
        (|c| c.facets[2].corners = vec![0, 9], "names vertex 9, and there are 5"),
        (|c| c.facets[3] = c.facets[1].clone(), "is named twice, by `free` and by `free`"),
        (
            |c| {
                c.vertices[2] = [0.5, 0.5, 0.0];
                c.cells[0] = vec![0, 1, 2];
                c.cells.push(vec![2, 1, 3]);
            },
            "the vertex [0.5, 0.5] hangs on the edge",
        ),
        (
            |c| {
                c.vertices.extend([[5.0, 5.0, 0.0], [6.0, 5.0, 0.0], [5.0, 6.0, 0.0]]);
                c.cells.push(vec![5, 6, 7]);
                c.facets.extend([[5, 6], [6, 7], [7, 5]].map(|ends| facet(&ends, 1)));
            },
            "no chain of common edges",
        ),
    ];
    for (defect, message) in cases {
        let mut coarse = square();
        defect(&mut coarse);
        let error = coarse.checked().unwrap_err().to_string();
        assert!(error.contains(message), "{error}");
    }
}

/// A cube of Kuhn's tetrahedra with its twelve faces on the sides `low` (z = 0) and `rest`, and a vertex that nothing uses.
pub(crate) fn cube() -> CoarseMesh {
    let vertices = (0..8).map(|v| [0, 1, 2].map(|i| f64::from(v >> i & 1))).chain([[9.0; 3]]);
    let path = |axes: [u32; 3]| {
        let [a, b, _] = axes.map(|axis| 1 << axis);
        vec![0, a, a + b, 7]
    };
    let paths = [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [1, 0, 2], [2, 1, 0]];
    let face = |corners: [u32; 3]| facet(&corners, u32::from(!corners.iter().all(|v| v & 4 == 0)));
    // Each square of the boundary has the diagonal from its lowest to its highest vertex.
    let mut facets = Vec::new();
    for axis in 0..3u32 {
        let [a, b] = [1 << ((axis + 1) % 3), 1 << ((axis + 2) % 3)];
        for far in [0, 1 << axis] {
            facets.extend([face([far, far + a, far + a + b]), face([far, far + a + b, far + b])]);
        }
    }
    CoarseMesh {
        dimension: 3,
        vertices: vertices.collect(),
        cells: paths.map(path).to_vec(),
        region: vec![0; 6],
        regions: vec!["body".into()],
        facets,
        sides: vec!["low".into(), "rest".into()],
        inner: Vec::new(),
    }
}

#[test]
fn orientation_is_mended_and_normals_point_outward() {
    let solid = cube().checked().unwrap();
    assert_eq!(solid.vertices.len(), 8);
    assert!((0..6).all(|c| (solid.measure_of(c) - 1.0 / 6.0).abs() < 1e-15));
    assert_eq!(solid.longest_edge(), 3f64.sqrt());
    for face in solid.pieces() {
        let [a, b, c] = face.corners[..] else { panic!("a triangle") };
        let middle = [0, 1, 2].map(|i| (a[i] + b[i] + c[i]) / 3.0 - 0.5);
        assert!(dot(middle, face.normal) > 0.4, "{face:?}");
        assert!(dot(cross(minus(b, a), minus(c, a)), face.normal) > 0.9);
        assert_eq!(face.side == 0, face.normal == [0.0, 0.0, -1.0]);
    }
}

#[test]
fn faces_of_a_turned_plane_have_one_normal() {
    let mut solid = cube();
    let (s, c) = 0.7f64.sin_cos();
    for [x, y, z] in &mut solid.vertices {
        [*y, *z] = [c * *y - s * *z, s * *y + c * *z];
        [*x, *y] = [c * *x - s * *y, s * *x + c * *y];
    }
    let solid = solid.checked().unwrap();
    let mut normals: Vec<[f64; 3]> = solid.facets.iter().map(|face| face.normal).collect();
    normals.sort_by(|a, b| a.partial_cmp(b).unwrap());
    normals.dedup();
    assert_eq!(normals.len(), 6);
}

#[test]
fn what_is_no_body_is_refused_at_its_element() {
    type Defect = fn(&mut CoarseMesh);
    let cases: [(Defect, At, &str); 9] = [
        (|s| s.vertices[3] = [1.0, 0.0, 0.0], At::Cell(0), "has no volume"),
        (|s| s.vertices[0][0] = f64::NAN, At::Cell(0), "has no volume"),
        (|s| s.cells[2][1] = 12, At::Cell(2), "names vertex 12, and there are 9"),
        (|s| s.facets[3].corners[1] = 12, At::Facet(3), "names vertex 12, and there are 9"),
        (|s| s.cells.push(vec![0, 1, 3, 7]), At::Cell(6), "another one on the same side"),
        (|s| s.facets.truncate(11), At::Cell(5), "belongs to no side"),
        (|s| s.facets[4].corners = vec![0, 3, 7], At::Facet(4), "which does not bound the domain"),
        (|s| s.facets[5] = s.facets[4].clone(), At::Facet(5), "is named twice"),
        (
            |s| {
                s.vertices.extend([[5.0; 3], [6.0, 5.0, 5.0], [5.0, 6.0, 5.0], [5.0, 5.0, 6.0]]);
                s.cells.push(vec![9, 10, 11, 12]);
                for corners in [[9, 10, 11], [9, 10, 12], [9, 11, 12], [10, 11, 12]] {
                    s.facets.push(facet(&corners, 1));
                }
            },
            At::Cell(6),
            "no chain of common faces",
        ),
    ];
    for (defect, at, message) in cases {
        let mut solid = cube();
        defect(&mut solid);
        let error = solid.checked().unwrap_err();
        assert!(error.to_string().contains(message), "{error}");
        assert_eq!(error.at, at, "{error}");
    }
}

/// A cube beside one whose common face is cut along the other diagonal has a vertex in the middle of that face.
#[test]
fn a_hanging_vertex_is_told_from_a_face_without_a_name() {
    let mut solid = cube();
    // The tetrahedron 0 1 3 7 cut in two at the middle of its edge 0-7, its neighbours left whole.
    solid.vertices[8] = [0.5, 0.5, 0.5];
    solid.cells[0] = vec![0, 1, 3, 8];
    solid.cells.push(vec![8, 1, 3, 7]);
    solid.region.push(0);
    let error = solid.checked().unwrap_err();
    let hanging =
        matches!(&error.fault, CoarseFault::Hanging { vertex, .. } if *vertex == [0.5; 3]);
    assert!(hanging, "{error}");
}
