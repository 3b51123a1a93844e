//! Every norm of a record a second time: |u - u_h|², |ε - ε_h|², |σ - σ_h|² at points of a strictly stronger rule, in the
//! plane on triangles that are quartered until the sums settle, σ_h from
//! the displacements of all levels with weights, histories and a stress computed here, the contact set by samples.
//! No moment, projection or stress of the library is used; formulas of the exact side are evaluated at points.

// Each test file compiles this module for itself and uses a part of it.
#![allow(dead_code)]

use exact::{Exact, MaterialNumbers};
use fem::contact::StepView;
use fem::space::quadrature::gauss_legendre;
use formula::{EvaluationPoint, Program};
use nalgebra::DMatrix;
use scene::setup::MeshData;

/// What is kept of a level.
pub struct Kept {
    pub t: f64,
    pub u: Vec<f64>,
    /// ξ + λ at the points of the trace.
    pub pressure: Vec<f64>,
}

impl Kept {
    pub fn of(view: &StepView<'_>) -> Self {
        let pressure = view.compliance.iter().zip(view.multiplier).map(|(a, b)| a + b).collect();
        Self { t: view.t, u: view.u.to_vec(), pressure }
    }
}

/// Errors of one level, or their maxima.
#[derive(Debug, Clone, Copy, Default)]
pub struct Errors {
    pub v: f64,
    pub l2: f64,
    pub stress: f64,
    pub trace: f64,
    pub pressure: f64,
    pub contact_set: f64,
    /// Measure of the points of Γ3 that are locked in one of truth and discrete solution alone.
    pub difference: f64,
}

impl Errors {
    pub fn max(self, other: Self) -> Self {
        Self {
            v: self.v.max(other.v),
            l2: self.l2.max(other.l2),
            stress: self.stress.max(other.stress),
            trace: self.trace.max(other.trace),
            pressure: self.pressure.max(other.pressure),
            contact_set: self.contact_set.max(other.contact_set),
            difference: self.difference.max(other.difference),
        }
    }
}

/// A tensor, its upper left d × d block in use.
type Full = [[f64; 3]; 3];

/// Points of a simplex with weights of sum one: Gauss points of the square or cube, moved by Duffy's map. Of the plane's
/// triangles 36 points, degree 10; of tetrahedra 125, degree 7 at least, where the library has 6.
fn simplex(corners: usize) -> Vec<(Vec<f64>, f64)> {
    let count = if corners == 4 { 5 } else { 6 };
    let line: Vec<(f64, f64)> =
        gauss_legendre(count).iter().map(|(x, w)| (0.5 + 0.5 * x, 0.5 * w)).collect();
    let mut points = vec![(Vec::new(), 1.0, 1.0)];
    for axis in (1..corners).rev() {
        let mut next = Vec::new();
        for (point, left, weight) in &points {
            for (x, w) in &line {
                // What is left of the barycentric sum; its power is the Jacobian, `axis` the normalisation.
                let mut longer: Vec<f64> = point.clone();
                longer.push(left * x);
                let jacobian = (1.0f64 - x).powi(axis as i32 - 1) * axis as f64;
                next.push((longer, left * (1.0 - x), weight * w * jacobian));
            }
        }
        points = next;
    }
    let closed = |(mut point, left, weight): (Vec<f64>, f64, f64)| {
        point.push(left);
        (point, weight)
    };
    points.into_iter().map(closed).collect()
}

/// Value of the outputs of formulas at points, one list an output.
fn at(exact: &Exact, nodes: &[formula::Node], points: &[[f64; 3]], t: f64) -> Vec<Vec<f64>> {
    let graph = exact.data.graph.clone();
    let program = Program::compile(&graph, nodes, exact.data.horizon);
    let mut out = vec![Vec::new(); nodes.len()];
    program.bind(points).evaluate(t, 0.0, &mut out);
    out
}

/// The tensor of upper components, row by row.
fn full(d: usize, component: impl Fn(usize) -> f64) -> Full {
    let (mut tensor, mut k) = ([[0.0; 3]; 3], 0);
    for i in 0..d {
        for j in i..d {
            (tensor[i][j], tensor[j][i]) = (component(k), component(k));
            k += 1;
        }
    }
    tensor
}

fn squares(a: &Full, b: &Full) -> f64 {
    a.as_flattened().iter().zip(b.as_flattened()).map(|(a, b)| (a - b).powi(2)).sum()
}

/// (5.1) from ε, the histories and κ.
fn sigma(d: usize, material: &MaterialNumbers, strain: &Full, past: &[Full], kappa: f64) -> Full {
    assert!(material.full.is_none(), "isotropic scenes alone");
    let trace = |e: &Full| (0..d).map(|i| e[i][i]).sum::<f64>();
    let mut out = [[0.0; 3]; 3];
    let mut add = |lambda: f64, mu: f64, e: &Full| {
        for i in 0..d {
            for j in 0..d {
                out[i][j] += 2.0 * mu * e[i][j];
            }
            out[i][i] += lambda * trace(e);
        }
    };
    add(material.lambda, material.mu_l, strain);
    for (&(lambda, mu), history) in material.memory.iter().zip(past) {
        add(lambda, mu, history);
    }
    if let Some(mu) = material.projection {
        let mut deviator = *strain;
        (0..d).for_each(|i| deviator[i][i] -= trace(strain) / d as f64);
        let length = squares(&deviator, &[[0.0; 3]; 3]).sqrt();
        if length > kappa {
            add(0.0, 0.5 * mu * (1.0 - kappa / length), &deviator);
        }
    }
    out
}

/// A cell: its corners, values and strain of a nodal vector there, its measure.
struct Cell {
    edges: DMatrix<f64>,
    nodes: Vec<usize>,
    measure: f64,
}

impl Cell {
    fn of(data: &MeshData, c: usize) -> Self {
        let (mesh, d) = (&data.space.mesh, data.space.mesh.dimension);
        let corner: Vec<[f64; 3]> =
            mesh.cell(c).iter().map(|&v| mesh.point(&[v], &[1.0])).collect();
        let edges = DMatrix::from_fn(d, d, |i, a| corner[a + 1][i] - corner[0][i]);
        let nodes = mesh.cell(c).iter();
        let nodes = nodes.map(|&v| data.space.nodes.of_vertex[v as usize] as usize).collect();
        let measure = edges.determinant().abs() / (1..=d).product::<usize>() as f64;
        Self { edges, nodes, measure }
    }

    fn strain(&self, u: &[f64]) -> Full {
        let d = self.edges.nrows();
        let value = |a: usize, i: usize| u[d * self.nodes[a] + i];
        let rises = DMatrix::from_fn(d, d, |i, a| value(a + 1, i) - value(0, i));
        let gradient = rises * self.edges.clone().try_inverse().expect("a cell");
        let mut strain = [[0.0; 3]; 3];
        for i in 0..d {
            for j in 0..d {
                strain[i][j] = 0.5 * (gradient[(i, j)] + gradient[(j, i)]);
            }
        }
        strain
    }
}

/// A part of a cell: its corners in barycentric coordinates, its share of the measure.
struct Piece {
    cell: usize,
    corner: Vec<Vec<f64>>,
    share: f64,
}

impl Piece {
    fn whole(cell: usize, corners: usize) -> Self {
        let unit = |a: usize| (0..corners).map(|b| f64::from(u8::from(a == b))).collect();
        Self { cell, corner: (0..corners).map(unit).collect(), share: 1.0 }
    }

    /// The barycentric coordinates in the cell of those in the piece.
    fn place(&self, b: &[f64]) -> Vec<f64> {
        let sum = |c: usize| b.iter().zip(&self.corner).map(|(b, corner)| b * corner[c]).sum();
        (0..b.len()).map(sum).collect()
    }

    /// The four halves of a triangle's size.
    fn quarters(&self) -> Vec<Self> {
        let middle = |a: usize, b: usize| -> Vec<f64> {
            let pair = self.corner[a].iter().zip(&self.corner[b]);
            pair.map(|(a, b)| 0.5 * (a + b)).collect()
        };
        let [p, q, r] = [0, 1, 2].map(|a| self.corner[a].clone());
        let [pq, qr, rp] = [(0, 1), (1, 2), (2, 0)].map(|(a, b)| middle(a, b));
        let part = |corners: [&Vec<f64>; 3]| Self {
            cell: self.cell,
            corner: corners.map(Clone::clone).to_vec(),
            share: 0.25 * self.share,
        };
        vec![
            part([&p, &pq, &rp]),
            part([&pq, &q, &qr]),
            part([&rp, &qr, &r]),
            part([&pq, &qr, &rp]),
        ]
    }
}

/// Triangles are quartered where that moves a square by more than a share of the sum, so many times at most: a jump
/// is then left in strips of a hundredth of a cell.
const QUARTERED: usize = 7;

/// The sums of squares over the cells, by pieces that are quartered until they move by no more than `share`; in space by
/// one rule a cell.
fn settled(cells: usize, d: usize, share: f64, on: impl Fn(&[Piece]) -> Vec<[f64; 3]>) -> [f64; 3] {
    let mut pieces: Vec<Piece> = (0..cells).map(|c| Piece::whole(c, d + 1)).collect();
    let mut values = on(&pieces);
    let add = |sum: &mut [f64; 3], squares: &[f64; 3]| {
        sum.iter_mut().zip(squares).for_each(|(sum, square)| *sum += square);
    };
    let mut sums = [0.0; 3];
    for _ in 0..if d == 2 { QUARTERED } else { 0 } {
        let quarters: Vec<Vec<Piece>> = pieces.iter().map(Piece::quarters).collect();
        let flat: Vec<Piece> = quarters.into_iter().flatten().collect();
        let finer = on(&flat);
        let mut scale = sums;
        values.iter().for_each(|squares| add(&mut scale, squares));
        let mut open = (Vec::new(), Vec::new());
        let mut flat = flat.into_iter();
        for (squares, four) in values.iter().zip(finer.chunks(4)) {
            let mut together = [0.0; 3];
            four.iter().for_each(|quarter| add(&mut together, quarter));
            let moved = |i: usize| (together[i] - squares[i]).abs() > share * scale[i];
            let quarters: Vec<Piece> = flat.by_ref().take(4).collect();
            if (0..3).any(moved) {
                open.0.extend(quarters);
                open.1.extend_from_slice(four);
            } else {
                add(&mut sums, &together);
            }
        }
        (pieces, values) = open;
    }
    values.iter().for_each(|squares| add(&mut sums, squares));
    sums
}

/// Half of the steps beside t_j, up to t_n.
fn weights(levels: &[Kept]) -> Vec<f64> {
    let mut weights = vec![0.0; levels.len()];
    for j in 1..levels.len() {
        let half = 0.5 * (levels[j].t - levels[j - 1].t);
        weights[j - 1] += half;
        weights[j] += half;
    }
    weights
}

/// ‖ε(v)‖ of a nodal vector of linear elements.
pub fn strain_norm(data: &MeshData, v: &[f64]) -> f64 {
    let cells = (0..data.space.mesh.cell_count()).map(|c| Cell::of(data, c));
    let square = |cell: Cell| cell.measure * squares(&cell.strain(v), &[[0.0; 3]; 3]);
    cells.map(square).sum::<f64>().sqrt()
}

/// The errors of the last of `levels`, which are all from t = 0 on, by pieces of cells that settle to a share of the squares.
pub fn errors(exact: &Exact, data: &MeshData, levels: &[Kept], share: f64) -> Errors {
    let mut errors = Errors::default();
    let (now, d) = (&levels[levels.len() - 1], data.space.mesh.dimension);
    let (weights, cells) = (weights(levels), data.space.mesh.cell_count());
    let cells: Vec<Cell> = (0..cells).map(|c| Cell::of(data, c)).collect();
    let graph = &exact.data.graph;
    let zero = [[0.0; 3]; 3];
    let norm = |level: &Kept| {
        let cell = |cell: &Cell| cell.measure * squares(&cell.strain(&level.u), &zero);
        cells.iter().map(cell).sum::<f64>().sqrt()
    };
    let zeta = levels.iter().zip(&weights).map(|(level, w)| w * norm(level)).sum();
    let kappa = exact.data.kappa.map_or(f64::INFINITY, |kappa| {
        graph.evaluate(kappa, &EvaluationPoint { zeta, ..EvaluationPoint::default() })
    });
    // Σ' b_i(t_n - t_j) u_j, one a term: strains of it are the histories.
    let past: Vec<Vec<f64>> = exact
        .data
        .kernels
        .iter()
        .map(|&kernel| {
            let mut sum = vec![0.0; now.u.len()];
            for (level, w) in levels.iter().zip(&weights).filter(|(_, w)| **w > 0.0) {
                let lag = EvaluationPoint { t: now.t - level.t, ..EvaluationPoint::default() };
                let factor = w * graph.evaluate(kernel, &lag);
                sum.iter_mut().zip(&level.u).for_each(|(sum, u)| *sum += factor * u);
            }
            sum
        })
        .collect();
    let nodes = [&exact.data.u[..], &exact.strain, &exact.memory].concat();
    let numbers = exact.strain.len();
    let regions = exact.cell_regions(&data.space.mesh);
    let mesh = &data.space.mesh;
    let kappa_of_truth = exact.kappa(now.t);
    // ε_h and σ_h of each cell.
    let discrete: Vec<[Full; 2]> = cells
        .iter()
        .zip(&regions)
        .map(|(cell, &region)| {
            let strain = cell.strain(&now.u);
            let own_past: Vec<Full> = past.iter().map(|history| cell.strain(history)).collect();
            let stress = sigma(d, exact.material_in(region), &strain, &own_past, kappa);
            [strain, stress]
        })
        .collect();
    // The squares of V, stress and L2 on each piece.
    let on_pieces = |pieces: &[Piece]| -> Vec<[f64; 3]> {
        let rule = simplex(d + 1);
        let places: Vec<Vec<f64>> =
            pieces.iter().flat_map(|piece| rule.iter().map(|(b, _)| piece.place(b))).collect();
        let place =
            |(p, b): (usize, &Vec<f64>)| mesh.point(mesh.cell(pieces[p / rule.len()].cell), b);
        let points: Vec<[f64; 3]> = places.iter().enumerate().map(place).collect();
        let out = at(exact, &nodes, &points, now.t);
        let one = |(i, piece): (usize, &Piece)| {
            let (cell, mut squared) = (&cells[piece.cell], [0.0; 3]);
            let [strain, stress] = &discrete[piece.cell];
            let material = exact.material_in(regions[piece.cell]);
            for (q, (_, weight)) in rule.iter().enumerate() {
                let (share, p) = (weight * piece.share * cell.measure, i * rule.len() + q);
                let tensor = |first: usize| full(d, |k| out[first + k][p]);
                let (present, terms) = (tensor(d), exact.data.kernels.len());
                let remembered: Vec<Full> =
                    (1..=terms).map(|term| tensor(d + numbers * term)).collect();
                let of_truth = sigma(d, material, &present, &remembered, kappa_of_truth);
                squared[0] += share * squares(&present, strain);
                squared[1] += share * squares(&of_truth, stress);
                for (i, out) in out[..d].iter().enumerate() {
                    let value: f64 = places[p]
                        .iter()
                        .zip(&cell.nodes)
                        .map(|(b, node)| b * now.u[d * node + i])
                        .sum();
                    squared[2] += share * (out[p] - value).powi(2);
                }
            }
            squared
        };
        pieces.iter().enumerate().map(one).collect()
    };
    [errors.v, errors.stress, errors.l2] = settled(cells.len(), d, share, on_pieces);
    on_contact(exact, data, now, &mut errors);
    for value in
        [&mut errors.v, &mut errors.l2, &mut errors.stress, &mut errors.trace, &mut errors.pressure]
    {
        *value = value.sqrt();
    }
    errors
}

/// Parts into which an edge is cut for its integrals, and intervals of an edge in which contact sets are sampled.
const PARTS: [usize; 2] = [8, 64];

/// Places of a facet: those of the rule with their weights, and those of the samples.
fn places(corners: usize) -> [Vec<(Vec<f64>, f64)>; 2] {
    let [parts, intervals] = PARTS;
    if corners == 3 {
        let fine = 16;
        let grid = (0..=fine).flat_map(|i| (0..=fine - i).map(move |j| (i, j)));
        let share = |k: usize| k as f64 / fine as f64;
        let point = |(i, j): (usize, usize)| (vec![share(fine - i - j), share(i), share(j)], 0.0);
        return [simplex(3), grid.map(point).collect()];
    }
    let cut = |s: usize| {
        simplex(2).into_iter().map(move |(b, w)| {
            let x = (s as f64 + b[0]) / parts as f64;
            (vec![1.0 - x, x], w / parts as f64)
        })
    };
    let sample = |s: usize| {
        let x = s as f64 / intervals as f64;
        (vec![1.0 - x, x], 1.0 / intervals as f64)
    };
    [(0..parts).flat_map(cut).collect(), (0..=intervals).map(sample).collect()]
}

fn on_contact(exact: &Exact, data: &MeshData, now: &Kept, errors: &mut Errors) {
    let (mesh, trace, d) = (&data.space.mesh, &data.space.trace, data.space.mesh.dimension);
    let [rule, samples] = places(d);
    let mut sets: [Vec<[f64; 3]>; 2] = Default::default();
    let mut all: Vec<[f64; 3]> = Vec::new();
    for f in 0..trace.mesh_facet.len() {
        let members: Vec<usize> = trace.facet(f).iter().map(|&i| i as usize).collect();
        let vertices: Vec<u32> = members.iter().map(|&i| trace.points[i].vertex).collect();
        let normal = trace.points[members[0]].normal;
        let program = exact.boundary(data.space.side(f), &normal[..d]).program;
        let fields = |places: &[(Vec<f64>, f64)]| {
            let points: Vec<[f64; 3]> =
                places.iter().map(|(b, _)| mesh.point(&vertices, b)).collect();
            let mut out = vec![Vec::new(); 5];
            program.bind(&points).evaluate(now.t, 0.0, &mut out);
            (points, out)
        };
        let corner: Vec<f64> = vertices
            .iter()
            .map(|&v| {
                let node = data.space.nodes.of_vertex[v as usize] as usize;
                (0..d).map(|i| normal[i] * now.u[d * node + i]).sum()
            })
            .collect();
        let linear =
            |b: &[f64], values: &[f64]| b.iter().zip(values).map(|(b, v)| b * v).sum::<f64>();
        let pressure: Vec<f64> = members.iter().map(|&i| now.pressure[i]).collect();
        let measure = size(mesh, &vertices);
        let (_, out) = fields(&rule);
        for (q, (b, weight)) in rule.iter().enumerate() {
            errors.trace += weight * measure * (out[0][q] - linear(b, &corner)).powi(2);
            errors.pressure += weight * measure * (out[1][q] - linear(b, &pressure)).powi(2);
        }
        let (points, out) = fields(&samples);
        let (_, ends) = fields(&corners(d));
        let meets = |u: f64, g: f64| g.is_finite() && g - u <= 1e-9 * g.abs();
        let held: Vec<bool> = (0..d).map(|a| meets(corner[a], ends[2][a])).collect();
        for (q, (b, weight)) in samples.iter().enumerate() {
            let truth = meets(out[0][q], out[2][q]);
            let discrete = b.iter().zip(&held).all(|(b, held)| *b == 0.0 || *held);
            all.push(points[q]);
            sets[0].extend(truth.then_some(points[q]));
            sets[1].extend(discrete.then_some(points[q]));
            if truth != held.iter().all(|held| *held) {
                errors.difference += weight * measure;
            }
        }
    }
    errors.contact_set = distance(&sets, &all, d);
}

fn corners(d: usize) -> Vec<(Vec<f64>, f64)> {
    (0..d).map(|a| ((0..d).map(|b| f64::from(u8::from(a == b))).collect(), 0.0)).collect()
}

/// Length of an edge, area of a triangle.
fn size(mesh: &fem::mesh::Mesh, vertices: &[u32]) -> f64 {
    let corner: Vec<nalgebra::Vector3<f64>> =
        vertices.iter().map(|&v| mesh.point(&[v], &[1.0]).into()).collect();
    match corner[..] {
        [a, b] => (b - a).norm(),
        [a, b, c] => 0.5 * (b - a).cross(&(c - a)).norm(),
        _ => panic!("no facet"),
    }
}

/// Hausdorff distance; the diameter of all samples where one set alone is empty.
fn distance(sets: &[Vec<[f64; 3]>; 2], all: &[[f64; 3]], d: usize) -> f64 {
    let apart =
        |a: &[f64; 3], b: &[f64; 3]| (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt();
    match (sets[0].is_empty(), sets[1].is_empty()) {
        (true, true) => return 0.0,
        (true, false) | (false, true) => {
            let far = |a: &[f64; 3]| all.iter().map(|b| apart(a, b)).fold(0.0, f64::max);
            // The samples of a plane side lie on a line, and in space on a rectangle: its diagonal.
            assert!(d == 2 || d == 3);
            return all.iter().map(far).fold(0.0, f64::max);
        }
        _ => {}
    }
    let from = |a: &[[f64; 3]], b: &[[f64; 3]]| {
        let near = |p: &[f64; 3]| b.iter().map(|q| apart(p, q)).fold(f64::INFINITY, f64::min);
        a.iter().map(near).fold(0.0, f64::max)
    };
    from(&sets[0], &sets[1]).max(from(&sets[1], &sets[0]))
}
