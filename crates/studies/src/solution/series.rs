//! A case as a series of VTU files with a .pvd index, for ParaView.

use algebra::in_dimension;
use std::path::{Path, PathBuf};

use super::vtu::{Field, VtuGrid, write_pvd, write_vtu};
use fem::contact::{Discretization, Model, StepView};
use files::{FileError, make_directory};

/// Files `SCENE_0000.vtu`, … and `SCENE.pvd` in one directory.
pub struct VtuSeries {
    dir: PathBuf,
    name: String,
    steps: Vec<(f64, String)>,
}

impl VtuSeries {
    /// Makes the directory.
    ///
    /// # Errors
    /// The file system's.
    pub fn new(dir: &Path, name: &str) -> Result<Self, FileError> {
        make_directory(dir)?;
        Ok(Self { dir: dir.to_owned(), name: name.to_owned(), steps: Vec::new() })
    }

    /// Writes one time level: at nodes the displacement and the contact pressure ξ + λ with its
    /// parts (zero off Γ3); on cells the mean stress (xx, yy, zz, xy, yz, xz) and where the body yields.
    ///
    /// # Errors
    /// The file system's.
    pub fn write(
        &mut self,
        space: &Discretization,
        model: &Model,
        view: &StepView<'_>,
    ) -> Result<(), FileError> {
        let mesh = &space.mesh;
        let points: Vec<[f64; 3]> =
            (0..mesh.vertices() as u32).map(|v| mesh.point(&[v], &[1.0])).collect();
        let (stress, yields) =
            in_dimension!(mesh.dimension, D, S => cell_fields::<S>(space, model, view));
        let displacement = space.at_vertices(view.u);
        let (mut xi, mut lambda) = (vec![0.0; points.len()], vec![0.0; points.len()]);
        for (i, point) in space.trace.points.iter().enumerate() {
            xi[point.vertex as usize] += view.compliance[i];
            lambda[point.vertex as usize] += view.multiplier[i];
        }
        let pressure: Vec<f64> = xi.iter().zip(&lambda).map(|(a, b)| a + b).collect();
        let vertex = |&node: &u32| space.nodes.vertex[node as usize];
        let cells: Vec<u32> = space.nodes.cells.iter().map(vertex).collect();
        let grid =
            VtuGrid { points: &points, cells: &cells, vertices_per_cell: space.nodes.a_cell };
        let scalar = |name, values| Field { name, components: 1, values };
        let file = format!("{}_{:04}.vtu", self.name, view.n);
        write_vtu(
            &self.dir.join(&file),
            &grid,
            &[
                Field { name: "displacement", components: mesh.dimension, values: &displacement },
                scalar("contact pressure", &pressure),
                scalar("compliance", &xi),
                scalar("multiplier", &lambda),
            ],
            &[
                Field { name: "stress", components: 6, values: &stress },
                scalar("yielding", &yields),
            ],
        )?;
        self.steps.push((view.t, file));
        Ok(())
    }

    /// Writes the index.
    ///
    /// # Errors
    /// The file system's.
    pub fn finish(self) -> Result<(), FileError> {
        write_pvd(&self.dir.join(format!("{}.pvd", self.name)), &self.steps)
    }
}

/// Stress in the component order of ParaView, and 1 where the projection acts.
fn cell_fields<const S: usize>(
    space: &Discretization,
    model: &Model,
    view: &StepView<'_>,
) -> (Vec<f64>, Vec<f64>) {
    // Mandel (xx, yy, √2 xy) or (xx, yy, zz, √2 yz, √2 xz, √2 xy) to (xx, yy, zz, xy, yz, xz).
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let (mut stress, mut yields) = (Vec::new(), Vec::new());
    for c in 0..space.mesh.cell_count() {
        let s = view.stress::<S>(space, model, c);
        stress.extend(if S == 3 {
            [s[0], s[1], 0.0, half * s[2], 0.0, 0.0]
        } else {
            [s[0], s[1], s[2], half * s[5], half * s[3], half * s[4]]
        });
        yields.push(f64::from(u8::from(view.yields::<S>(space, model, c))));
    }
    (stress, yields)
}
