//! How a mesh of halved edges sits on the one before: each vertex is a coarse vertex or the midpoint of a
//! coarse edge.
//!
//! Vertices are numbered by position in lattice or coarse triangle, so moved vertices (perturbed and graded
//! families) keep their parents, and only the meaning "midpoint" is lost.

use std::sync::Arc;

use super::{CoarseMesh, Parents, subdivision};

/// What a mesh refines.
#[derive(Debug, Clone, Default, PartialEq)]
pub enum Nesting {
    /// Nothing that is known.
    #[default]
    Unknown,
    /// A rectangle's or box's lattice, as [`super::lattice()`] numbers it.
    Lattice {
        /// Cells an axis.
        counts: Vec<usize>,
        /// Width of a cell along each axis over that of the finest mesh.
        stretch: Vec<usize>,
    },
    /// A coarse triangulation with n parts per edge, as [`CoarseMesh::refined`] numbers it.
    Refined {
        /// The coarse triangulation.
        coarse: Arc<CoarseMesh>,
        /// n.
        parts: u32,
    },
}

/// Cells of coarse meshes are at most this many times as long along one axis as along another: beyond, a
/// smoother that works node by node sees only the short axis.
const LARGEST_STRETCH: usize = 4;

impl Nesting {
    /// The lattice with `counts` cells per axis.
    pub(crate) fn lattice(counts: &[usize]) -> Self {
        Self::Lattice { counts: counts.to_vec(), stretch: vec![1; counts.len()] }
    }

    /// The hierarchy of the rectangle or box of this size with n cells per unit length.
    pub fn of_box(size: &[f64], n: u32) -> Self {
        let cells = |s: &f64| ((s * f64::from(n)).round() as usize).max(1);
        Self::lattice(&size.iter().map(cells).collect::<Vec<_>>())
    }

    /// The mesh with every edge doubled, of a lattice along each axis whose count is even, and the
    /// parents of the vertices; nothing where no axis can be halved.
    pub(crate) fn coarsened(&self) -> Option<(Parents, Self)> {
        match self {
            Self::Unknown => None,
            Self::Lattice { counts, stretch } => {
                let least = stretch.iter().min().copied().unwrap_or(1);
                let axes = counts.iter().zip(stretch);
                let halved: Vec<bool> = axes
                    .map(|(count, stretch)| {
                        count % 2 == 0 && 2 * stretch <= LARGEST_STRETCH * least
                    })
                    .collect();
                let by = |halved: &bool| if *halved { 2 } else { 1 };
                let coarse: Vec<usize> =
                    counts.iter().zip(&halved).map(|(count, h)| count / by(h)).collect();
                let stretch = stretch.iter().zip(&halved).map(|(axis, h)| axis * by(h)).collect();
                halved.contains(&true).then(|| {
                    (lattice_parents(counts, &coarse), Self::Lattice { counts: coarse, stretch })
                })
            }
            Self::Refined { coarse, parts } => (parts % 2 == 0).then(|| {
                let parents = subdivision::parents(coarse, *parts);
                (parents, Self::Refined { coarse: coarse.clone(), parts: parts / 2 })
            }),
        }
    }
}

/// Parents at half the index, rounded down and up: the diagonals of rectangle and box run along
/// (1, 1) and (1, 1, 1), so these two vertices share a coarse edge.
fn lattice_parents(counts: &[usize], coarse: &[usize]) -> Parents {
    let total: usize = counts.iter().map(|count| count + 1).product();
    let parents = |mut vertex: usize| {
        let (mut low, mut high, mut stride) = (0, 0, 1);
        for (count, coarse) in counts.iter().zip(coarse) {
            let index = vertex % (count + 1);
            vertex /= count + 1;
            let by = count / coarse;
            low += stride * (index / by);
            high += stride * index.div_ceil(by);
            stride *= coarse + 1;
        }
        [low as u32, high as u32]
    };
    (0..total).map(parents).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{Family, Mesh, lattice, triangulate};

    /// Largest distance of a vertex from the middle of its parents; infinite if these share no coarse cell.
    fn off_the_middle(fine: &Mesh, coarse: &Mesh, parents: &Parents) -> f64 {
        assert_eq!(parents.len(), fine.vertices());
        let share_a_cell = |[p, q]: [u32; 2]| {
            (0..coarse.cell_count()).any(|c| [p, q].iter().all(|v| coarse.cell(c).contains(v)))
        };
        if !parents.iter().all(|&pair| share_a_cell(pair)) {
            return f64::INFINITY;
        }
        let distance = |(v, [p, q]): (usize, &[u32; 2])| {
            let ends = coarse.vertex(*p).iter().zip(coarse.vertex(*q));
            let at = fine.vertex(v as u32).iter();
            at.zip(ends).map(|(x, (a, b))| (x - 0.5 * (a + b)).abs()).fold(0.0, f64::max)
        };
        parents.iter().enumerate().map(distance).fold(0.0, f64::max)
    }

    #[test]
    fn parents_are_the_ends_of_the_coarse_edge_that_a_vertex_halves() {
        let structured = Family::Structured;
        let (parents, coarse) = Nesting::lattice(&[8, 4]).coarsened().unwrap();
        let plane = |n| lattice([2.0, 1.0], n, structured);
        assert!(off_the_middle(&plane(4), &plane(2), &parents) < 1e-15);
        assert_eq!(coarse, Nesting::Lattice { counts: vec![4, 2], stretch: vec![2, 2] });
        let (parents, _) = Nesting::lattice(&[8, 4, 4]).coarsened().unwrap();
        let solid = |n| lattice([2.0, 1.0, 1.0], n, structured);
        assert!(off_the_middle(&solid(4), &solid(2), &parents) < 1e-15);
        // A count too few an axis is a wrong mesh, and the check sees it.
        let wrong = lattice_parents(&[8, 4, 4], &[4, 4, 2]);
        assert!(off_the_middle(&solid(4), &solid(2), &wrong) > 0.1);
        let square = [[0.0, 0.0], [2.0, 0.0], [1.5, 1.0], [0.0, 1.5]];
        let triangles = triangulate(&square).unwrap();
        let names = (0..4).map(|i| format!("s{i}")).collect();
        let coarse = CoarseMesh::polygon(&square, &triangles, &[0, 1, 2, 3], names).unwrap();
        let coarse = Arc::new(coarse);
        let nesting = Nesting::Refined { coarse: coarse.clone(), parts: 8 };
        let (parents, _) = nesting.coarsened().unwrap();
        let mesh = |n| coarse.refined(n, structured);
        assert!(off_the_middle(&mesh(8), &mesh(4), &parents) < 1e-14);
    }

    #[test]
    fn what_does_not_divide_is_left_and_cells_stay_compact() {
        assert_eq!(Nesting::Unknown.coarsened(), None);
        assert_eq!(Nesting::lattice(&[9, 3, 5]).coarsened(), None);
        let mut nesting = Nesting::lattice(&[24, 23, 24]);
        let mut counts = Vec::new();
        while let Some((_, next)) = nesting.coarsened() {
            let Nesting::Lattice { counts: halved, .. } = &next else { panic!("a lattice") };
            counts.push(halved.clone());
            nesting = next;
        }
        assert_eq!(counts, [vec![12, 23, 12], vec![6, 23, 6]]);
    }
}
