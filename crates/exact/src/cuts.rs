//! Simplices cut by the lines on which fields have kinks or jumps, with a rule on each side.
//!
//! A Gauss rule across a kink misses a share of the error that does not fall with h. Guards, whose sign decides a
//! branch of a formula, change sign along such lines. The simplices are cut there into straight pieces; the remaining
//! error for a curved line is of the order of its deviation, h² of the cell.

use super::shared_program::SharedProgram;
use fem::mesh::Mesh;
use fem::space::quadrature::Rule;
use formula::{Graph, Node, Program, Variable};

const MOST_CORNERS: usize = 4;
/// Guards below this share of their largest value at a vertex are zero: rounding of formulas.
const ZERO: f64 = 1e-11;
/// Pieces of a smaller share of their simplex are negligible.
const SMALLEST: f64 = 1e-14;
/// Halvings of an edge: places to 1e-12 of it.
const HALVINGS: usize = 40;
/// Coordinates are rounded to this share of the largest, so that points with one abscissa keep it: what depends on x
/// alone is then evaluated once.
const GRAIN: f64 = 1.0 / (1u64 << 40) as f64;

/// A piece of a simplex: barycentric coordinates of its corners.
#[derive(Clone, Copy)]
struct Piece {
    simplex: usize,
    corner: [[f64; MOST_CORNERS]; MOST_CORNERS],
}

/// Guards of fields on a list of simplices.
pub(super) struct Cuts {
    guards: Vec<Program>,
    /// All guards at the vertices.
    at_vertices: SharedProgram,
    /// Vertices of the simplices, number of vertices per simplex, and the index of each among the evaluated vertices.
    vertices: Vec<u32>,
    corners: usize,
    place: Vec<u32>,
}

/// A cut simplex: its number in the list, and the rule on its pieces.
pub(super) struct Cut {
    pub simplex: usize,
    pub rule: Rule,
}

impl Cuts {
    /// The guards of `fields` on some simplices of a mesh; None if no guard varies in space.
    pub(crate) fn new<'a>(
        graph: &Graph,
        fields: &[Node],
        horizon: f64,
        mesh: &'a Mesh,
        simplices: impl Iterator<Item = &'a [u32]>,
    ) -> Option<Self> {
        let mut simplices = simplices.peekable();
        let corners = simplices.peek()?.len();
        let varies = |&guard: &Node| {
            [Variable::X, Variable::Y, Variable::Z]
                .iter()
                .any(|&axis| graph.depends_on(guard, axis))
        };
        let guards: Vec<Node> = graph.guards(fields).into_iter().filter(varies).collect();
        let vertices: Vec<u32> = simplices.flatten().copied().collect();
        if guards.is_empty() {
            return None;
        }
        let mut distinct = vertices.clone();
        distinct.sort_unstable();
        distinct.dedup();
        let points: Vec<[f64; 3]> = distinct.iter().map(|&v| mesh.point(&[v], &[1.0])).collect();
        let all = Program::compile(graph, &guards, horizon);
        let place = |v: &u32| distinct.partition_point(|distinct| distinct < v) as u32;
        Some(Self {
            at_vertices: all.bind(&points).into(),
            place: vertices.iter().map(place).collect(),
            corners,
            guards: guards.iter().map(|&g| Program::compile(graph, &[g], horizon)).collect(),
            vertices,
        })
    }

    fn simplex(&self, s: usize) -> &[u32] {
        &self.vertices[self.corners * s..self.corners * (s + 1)]
    }

    /// The simplices that are cut at time t, with `rule` on each of their pieces.
    pub(crate) fn rules(&self, mesh: &Mesh, rule: &Rule, t: f64) -> Vec<Cut> {
        let values = self.at_vertices.values_at(t);
        let mut is_cut = vec![false; self.vertices.len() / self.corners];
        let mut active = Vec::new();
        for (guard, values) in self.guards.iter().zip(&values) {
            let largest = values.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
            let zero = ZERO * largest;
            let mut any = false;
            for (is_cut, places) in is_cut.iter_mut().zip(self.place.chunks(self.corners)) {
                let at = |&p: &u32| values[p as usize];
                let low = places.iter().map(at).fold(f64::INFINITY, f64::min);
                let high = places.iter().map(at).fold(f64::NEG_INFINITY, f64::max);
                let crosses = low < -zero && high > zero;
                *is_cut |= crosses;
                any |= crosses;
            }
            if any {
                active.push((guard, zero));
            }
        }
        let mut whole = [[0.0; MOST_CORNERS]; MOST_CORNERS];
        (0..MOST_CORNERS).for_each(|a| whole[a][a] = 1.0);
        let numbers = is_cut.iter().enumerate().filter(|(_, is_cut)| **is_cut).map(|(s, _)| s);
        let mut pieces: Vec<Piece> =
            numbers.map(|simplex| Piece { simplex, corner: whole }).collect();
        for (guard, zero) in active {
            pieces = self.divided(mesh, (guard, zero), t, &pieces);
        }
        let of_one = pieces
            .chunk_by(|a, b| a.simplex == b.simplex)
            .filter(|pieces_of_simplex| pieces_of_simplex.len() > 1);
        of_one
            .map(|pieces_of_simplex| Cut {
                simplex: pieces_of_simplex[0].simplex,
                rule: self.on_pieces(pieces_of_simplex, rule),
            })
            .collect()
    }

    /// Divides the pieces in which a guard changes sign.
    fn divided(
        &self,
        mesh: &Mesh,
        (guard, zero): (&Program, f64),
        t: f64,
        pieces: &[Piece],
    ) -> Vec<Piece> {
        let corners = self.corners;
        let place = |piece: &Piece, b: &[f64; MOST_CORNERS]| {
            mesh.point(self.simplex(piece.simplex), &b[..corners])
        };
        let values = |points: &[[f64; 3]]| guard.values(points, t, 0.0).swap_remove(0);
        let points: Vec<[f64; 3]> =
            pieces.iter().flat_map(|p| p.corner[..corners].iter().map(|b| place(p, b))).collect();
        let mut guard_values = values(&points);
        guard_values.iter_mut().filter(|value| value.abs() <= zero).for_each(|value| *value = 0.0);
        // Edges across which the sign changes: piece, its corners, the converging ends.
        let mut edges = Vec::new();
        for (i, values) in guard_values.chunks(corners).enumerate() {
            for a in 0..corners {
                for b in a + 1..corners {
                    if values[a] * values[b] < 0.0 {
                        // From the lower end: what depends on x alone is then halved at equal places in all rows.
                        let at = |a: usize| points[corners * i + a];
                        let [a, b] = if at(a) < at(b) { [a, b] } else { [b, a] };
                        edges.push((i, [a, b], [0.0, 1.0]));
                    }
                }
            }
        }
        let along = |(i, [a, b], _): &(usize, [usize; 2], [f64; 2]), s: f64| {
            let [from, to] = [pieces[*i].corner[*a], pieces[*i].corner[*b]];
            std::array::from_fn(|c| from[c] + s * (to[c] - from[c]))
        };
        for _ in 0..if edges.is_empty() { 0 } else { HALVINGS } {
            let middle = |[low, high]: [f64; 2]| 0.5 * (low + high);
            let points: Vec<[f64; 3]> = edges
                .iter()
                .map(|edge| place(&pieces[edge.0], &along(edge, middle(edge.2))))
                .collect();
            for (edge, value) in edges.iter_mut().zip(values(&points)) {
                let from = guard_values[corners * edge.0 + edge.1[0]];
                let end = usize::from((value < 0.0) != (from < 0.0));
                edge.2[end] = middle(edge.2);
            }
        }
        let mut divided = Vec::new();
        let mut edges = edges.iter().peekable();
        for (i, piece) in pieces.iter().enumerate() {
            let mut crossings = Vec::new();
            while let Some(edge) = edges.next_if(|edge| edge.0 == i) {
                crossings.push((edge.1, along(edge, 0.5 * (edge.2[0] + edge.2[1]))));
            }
            divide(*piece, &crossings, &mut divided);
        }
        divided
    }

    /// A rule on the pieces of one simplex, in its barycentric coordinates.
    fn on_pieces(&self, pieces: &[Piece], rule: &Rule) -> Rule {
        let corners = self.corners;
        let mut whole = Rule { points: Vec::new(), weights: Vec::new() };
        for piece in pieces {
            let share = share(&piece.corner, corners);
            if share <= SMALLEST {
                continue;
            }
            for (b, weight) in rule.points.iter().zip(&rule.weights) {
                let place = |c: usize| (0..corners).map(|a| b[a] * piece.corner[a][c]).sum();
                whole.points.push((0..corners).map(place).collect());
                whole.weights.push(weight * share);
            }
        }
        whole
    }

    /// The points of rules on simplices, rounded so that equal abscissae stay equal.
    pub(crate) fn points<'a>(
        &self,
        mesh: &Mesh,
        rules: impl Iterator<Item = (usize, &'a Rule)>,
    ) -> Vec<[f64; 3]> {
        let place = |(s, rule): (usize, &'a Rule)| {
            rule.points.iter().map(move |b| mesh.point(self.simplex(s), b)).collect::<Vec<_>>()
        };
        let mut points: Vec<[f64; 3]> = rules.flat_map(place).collect();
        let largest = points.as_flattened().iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        let grain = GRAIN * largest.log2().ceil().exp2();
        points.as_flattened_mut().iter_mut().for_each(|x| *x = (*x / grain).round() * grain);
        points
    }
}

/// Divides a piece at crossings of its edges, edge by edge: a new corner has neither sign, so the remaining crossings
/// stay valid.
fn divide(piece: Piece, crossings: &[([usize; 2], [f64; MOST_CORNERS])], out: &mut Vec<Piece>) {
    let Some((&([a, b], at), rest)) = crossings.split_first() else {
        out.push(piece);
        return;
    };
    for lost in [b, a] {
        let mut half = piece;
        half.corner[lost] = at;
        let left: Vec<_> = rest.iter().filter(|(ends, _)| !ends.contains(&lost)).copied().collect();
        divide(half, &left, out);
    }
}

/// The share of a simplex that a piece has: the determinant of its barycentric coordinates.
fn share(corner: &[[f64; MOST_CORNERS]; MOST_CORNERS], corners: usize) -> f64 {
    let matrix = nalgebra::DMatrix::from_fn(corners, corners, |a, c| corner[a][c]);
    matrix.determinant().abs()
}

#[cfg(test)]
mod tests {
    use super::*;
    use fem::mesh::{Family, lattice};
    use fem::space::quadrature::{tetrahedron_degree_5, triangle_degree_4};
    use formula::Scope;

    /// The integral of a formula over the unit square or cube by a rule on each cell, cut where it has guards.
    fn integral(mesh: &Mesh, text: &str, with_cuts: bool) -> f64 {
        let mut graph = Graph::new();
        let scope = Scope::new(&[Variable::X, Variable::Y, Variable::Z, Variable::T]);
        let f = graph.parse(text, &scope).expect("a formula");
        let program = Program::compile(&graph, &[f], 1.0);
        let rule = if mesh.dimension == 2 { triangle_degree_4() } else { tetrahedron_degree_5() };
        let cells = mesh.cell_count();
        let cuts = Cuts::new(&graph, &[f], 1.0, mesh, (0..cells).map(|c| mesh.cell(c)));
        let cuts = cuts.filter(|_| with_cuts);
        let cut = cuts.as_ref().map_or(Vec::new(), |cuts| cuts.rules(mesh, &rule, 0.5));
        let of_cell = |c: usize| {
            let rule_of_cell =
                cut.iter().find(|cut| cut.simplex == c).map_or(&rule, |cut| &cut.rule);
            let points: Vec<[f64; 3]> =
                rule_of_cell.points.iter().map(|b| mesh.point(mesh.cell(c), b)).collect();
            let mut values = vec![Vec::new()];
            program.bind(&points).evaluate(0.5, 0.0, &mut values);
            let sum: f64 = values[0].iter().zip(&rule_of_cell.weights).map(|(v, w)| v * w).sum();
            // Cells of one size.
            sum / cells as f64
        };
        (0..cells).map(of_cell).sum()
    }

    #[test]
    fn jumps_across_lines_and_planes_are_integrated_exactly() {
        let square = lattice([1.0, 1.0], 5, Family::Structured);
        let cube = lattice([1.0, 1.0, 1.0], 2, Family::Structured);
        // The corner below x + y/2 = t is a triangle t by 2t; below x + y + z = t a sixth of t³. Two crossing lines
        // share a piece of a cell; 3 (x - t) has the line of x - t.
        let cases = [
            (&square, "if(x + y/2 < t - 0.13, 3*x, 0)", 0.37f64.powi(3)),
            (&square, "if(x < t - 0.13, 1, 2) * if(y < 0.71, 1, 3)", 1.63 * 1.58),
            (
                &square,
                "max(x - t - 0.03, 0) + abs(3*(x - t - 0.03))",
                0.47 * 0.235 + 1.5 * (0.47 * 0.47 + 0.53 * 0.53),
            ),
            (&cube, "if(x + y + z < t + 0.17, 1, 0)", 0.67f64.powi(3) / 6.0),
            (&cube, "if(z < t + 0.17, x, 2*x)", 0.5 * (0.67 + 2.0 * 0.33)),
        ];
        for (mesh, text, exact) in cases {
            let found = integral(mesh, text, true);
            assert!((found - exact).abs() < 1e-11, "{text}: {found} {exact}");
            // Across the line the rule is off.
            let across = integral(mesh, text, false);
            assert!((across - exact).abs() > 1e-5, "{text}: {across} {exact}");
        }
    }

    #[test]
    fn curved_lines_are_cut_to_the_square_of_the_cell() {
        let exact = std::f64::consts::FRAC_PI_4 * 0.81;
        let off = [4, 8, 16].map(|n| {
            let mesh = lattice([1.0, 1.0], n, Family::Structured);
            (integral(&mesh, "if(x^2 + y^2 < 0.81, 1, 0)", true) - exact).abs()
        });
        assert!(off[1] < 0.35 * off[0] && off[2] < 0.35 * off[1], "{off:?}");
        assert!(off[0] < 5e-3, "{off:?}");
    }

    #[test]
    fn what_is_smooth_or_has_its_kink_on_a_side_is_left_whole() {
        let mesh = lattice([1.0, 1.0], 4, Family::Structured);
        let cut = |text: &str| {
            let mut graph = Graph::new();
            let scope = Scope::new(&[Variable::X, Variable::Y, Variable::T]);
            let f = graph.parse(text, &scope).expect("a formula");
            let cells = (0..mesh.cell_count()).map(|c| mesh.cell(c));
            let cuts = Cuts::new(&graph, &[f], 1.0, &mesh, cells);
            cuts.map(|cuts| cuts.rules(&mesh, &triangle_degree_4(), 0.5).len())
        };
        assert_eq!(cut("x*y*t"), None);
        assert_eq!(cut("max(t - 0.2, 0)*x"), None);
        assert_eq!(cut("abs(x - t)"), Some(0));
        assert_eq!(cut("abs(x - t - 1e-13)"), Some(0));
        // A column of four squares.
        assert_eq!(cut("abs(x - t - 0.1)"), Some(8));
    }
}
