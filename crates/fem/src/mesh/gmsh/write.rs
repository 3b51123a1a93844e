//! A mesh as the text of a `.msh` file, version 2.2, sides and regions as physical groups.

use std::fmt::Write as _;

use super::super::Mesh;

/// The text, of the vertices without midpoints; coordinates read back to the same doubles.
pub fn write_gmsh(mesh: &Mesh) -> String {
    let d = mesh.dimension;
    let groups = mesh.sides.len() + mesh.regions.len();
    let mut text = format!("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n{groups}\n");
    for (dimension, first, names) in
        [(d - 1, 1, &mesh.sides), (d, 1 + mesh.sides.len(), &mesh.regions)]
    {
        for (i, name) in names.iter().enumerate() {
            let _ = writeln!(text, "{dimension} {} \"{name}\"", first + i);
        }
    }
    let _ = writeln!(text, "$EndPhysicalNames\n$Nodes\n{}", mesh.corners());
    for v in 0..mesh.corners() {
        let [x, y, z] = mesh.point(&[v as u32], &[1.0]);
        let _ = writeln!(text, "{} {x} {y} {z}", v + 1);
    }
    let facets = mesh.facet_side.len();
    let _ = writeln!(text, "$EndNodes\n$Elements\n{}", facets + mesh.cell_count());
    // 1 is a line, 2 a triangle, 4 a tetrahedron.
    let (facet_type, cell_type) = if d == 2 { (1, 2) } else { (2, 4) };
    let mut element = |tag: usize, kind: usize, group: usize, vertices: &[u32]| {
        let _ = write!(text, "{tag} {kind} 2 {group} {group}");
        vertices.iter().for_each(|v| {
            let _ = write!(text, " {}", v + 1);
        });
        text.push('\n');
    };
    for (f, &side) in mesh.facet_side.iter().enumerate() {
        element(1 + f, facet_type, 1 + side as usize, mesh.facet(f));
    }
    for (c, &region) in mesh.cell_region.iter().enumerate() {
        let group = 1 + mesh.sides.len() + region as usize;
        element(1 + facets + c, cell_type, group, mesh.cell(c));
    }
    text.push_str("$EndElements\n");
    text
}
