//! The six tetrahedra of a cube, whole and damaged.

use super::*;

/// A cube of Kuhn's tetrahedra with its twelve faces on the sides `low` (z = 0) and `rest`, and a vertex that nothing uses.
pub(crate) fn cube() -> Solid {
    let vertices = (0..8).map(|v| [0, 1, 2].map(|i| f64::from(v >> i & 1))).chain([[9.0; 3]]);
    let path = |axes: [u32; 3]| {
        let [a, b, _] = axes.map(|axis| 1 << axis);
        [0, a, a + b, 7]
    };
    let paths = [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [1, 0, 2], [2, 1, 0]];
    let face = |corners: [u32; 3]| {
        let side = u32::from(!corners.iter().all(|v| v & 4 == 0));
        BoundaryFace { corners, side, normal: [0.0; 3] }
    };
    // Each square of the boundary has the diagonal from its lowest to its highest vertex.
    let mut faces = Vec::new();
    for axis in 0..3u32 {
        let [a, b] = [1 << ((axis + 1) % 3), 1 << ((axis + 2) % 3)];
        for far in [0, 1 << axis] {
            faces.extend([face([far, far + a, far + a + b]), face([far, far + a + b, far + b])]);
        }
    }
    Solid {
        vertices: vertices.collect(),
        cells: paths.map(path).to_vec(),
        region: vec![0; 6],
        regions: vec!["body".into()],
        faces,
        sides: vec!["low".into(), "rest".into()],
    }
}

#[test]
fn orientation_is_mended_and_normals_point_outward() {
    let solid = cube().checked().unwrap();
    assert_eq!(solid.vertices.len(), 8);
    assert!((0..6).all(|c| (solid.volume(c) - 1.0 / 6.0).abs() < 1e-15));
    assert_eq!(solid.longest_edge(), 3f64.sqrt());
    for face in &solid.faces {
        let [a, b, c] = solid.places(face.corners);
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
    let mut normals: Vec<[f64; 3]> = solid.faces.iter().map(|face| face.normal).collect();
    normals.sort_by(|a, b| a.partial_cmp(b).unwrap());
    normals.dedup();
    assert_eq!(normals.len(), 6);
}

#[test]
fn what_is_no_body_is_refused_at_its_element() {
    type Defect = fn(&mut Solid);
    let cases: [(Defect, At, &str); 9] = [
        (|s| s.vertices[3] = [1.0, 0.0, 0.0], At::Cell(0), "has no volume"),
        (|s| s.vertices[0][0] = f64::NAN, At::Cell(0), "has no volume"),
        (|s| s.cells[2][1] = 12, At::Cell(2), "names vertex 12, and there are 9"),
        (|s| s.faces[3].corners[1] = 12, At::Face(3), "names vertex 12, and there are 9"),
        (|s| s.cells.push([0, 1, 3, 7]), At::Cell(6), "another one on the same side"),
        (|s| s.faces.truncate(11), At::Cell(5), "belongs to no side"),
        (|s| s.faces[4].corners = [0, 3, 7], At::Face(4), "which does not bound the body"),
        (|s| s.faces[5] = s.faces[4], At::Face(5), "is named twice"),
        (
            |s| {
                s.vertices.extend([[5.0; 3], [6.0, 5.0, 5.0], [5.0, 6.0, 5.0], [5.0, 5.0, 6.0]]);
                s.cells.push([9, 10, 11, 12]);
                for corners in [[9, 10, 11], [9, 10, 12], [9, 11, 12], [10, 11, 12]] {
                    s.faces.push(BoundaryFace { corners, side: 1, normal: [0.0; 3] });
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
        assert_eq!(error.at(), at, "{error}");
    }
}

/// A cube beside one whose common face is cut along the other diagonal has a vertex in the middle of that face.
#[test]
fn a_hanging_vertex_is_told_from_a_face_without_a_name() {
    let mut solid = cube();
    // The tetrahedron 0 1 3 7 cut in two at the middle of its edge 0-7, its neighbours left whole.
    solid.vertices[8] = [0.5, 0.5, 0.5];
    solid.cells[0] = [0, 1, 3, 8];
    solid.cells.push([8, 1, 3, 7]);
    solid.region.push(0);
    let error = solid.checked().unwrap_err();
    assert!(matches!(error, SolidError::Hanging { vertex, .. } if vertex == [0.5; 3]), "{error}");
}
