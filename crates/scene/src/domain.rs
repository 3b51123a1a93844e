//! `[domain]`: the rectangle, box, polygon or mesh file, its named sides, and the mesh family.

use crate::reading::{Reading, placed};
use crate::source::{Result, SceneError, Source};
use fem::mesh::{
    CoarseMesh, Face, Family, Fault, Mesh, PolygonError, REST, lattice, read_gmsh, triangulate,
    vertex_at,
};
use files::read_file_up_to;
use formula::EvaluationPoint;
pub use side::Side;
pub(crate) use side::{SAME_NORMAL, largest_on};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use toml::de::DeTable;

mod side;

pub(super) fn place(point: &EvaluationPoint, dimension: usize) -> String {
    let named = [("x", point.x), ("y", point.y), ("z", point.z)];
    let parts: Vec<String> =
        named[..dimension].iter().map(|(name, value)| format!("{name} = {value}")).collect();
    parts.join(", ")
}

/// What the domain is.
#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    /// The product of (0, size\[i\]).
    Box,
    /// The union of coarse simplices, which the meshes refine.
    Refined(Arc<CoarseMesh>),
}

/// Each side is in exactly one of the four lists.
#[derive(Debug, Clone, PartialEq)]
pub struct Domain {
    pub shape: Shape,
    /// Extent along each axis, positive.
    pub size: Vec<f64>,
    /// In the order of [`Side`] and of `Mesh::sides`.
    pub sides: Vec<String>,
    /// Γ1: u = 0.
    pub clamped: Vec<Side>,
    /// Planes of symmetry: u_ν = 0, σ_τ = 0. With Γ1 they leave no rigid motion.
    pub symmetry: Vec<Side>,
    /// Γ2: σν = f2.
    pub traction: Vec<Side>,
    /// Γ3: contact.
    pub contact: Vec<Side>,
    /// u_ν = 0 on Γ3, by `[contact] bilateral`.
    pub bilateral: bool,
    pub mesh: Family,
}

impl Domain {
    pub(super) fn validate(reading: &Reading, dimension: usize) -> Result<Domain> {
        let (shape, size, sides) = shape(reading, dimension)?;
        let (clamped, symmetry, traction, contact) = Default::default();
        let mesh = Family::Structured;
        let bilateral = reading.optional("contact.bilateral")?.unwrap_or(false);
        let mut domain =
            Domain { shape, size, sides, clamped, symmetry, traction, contact, bilateral, mesh };
        domain.clamped = domain.listed(reading, "domain.clamped")?;
        domain.symmetry = domain.listed(reading, "domain.symmetry")?;
        domain.traction = domain.listed(reading, "domain.traction")?;
        domain.contact = domain.listed(reading, "domain.contact")?;
        // What becomes of the sides that no list names.
        if reading.has("domain.rest") {
            reading.choice("domain.rest", &[("traction", ())])?;
            let listed = domain.lists().map(|(_, sides)| &sides[..]).concat();
            domain.traction.extend(domain.all_sides().filter(|side| !listed.contains(side)));
        }
        domain.mesh = family(reading, &domain)?;
        domain.each_side_once(reading)?;
        side::few_at_a_vertex(reading, &domain)?;
        // A body that can move without strain: Γ1 is empty, and u_ν = 0 leaves a translation or rotation.
        let free = domain.clamped.is_empty();
        let top = domain.sides.iter().find(|name| *name == "top").or(domain.sides.first());
        let top = top.map_or("top", String::as_str);
        let hint = format!("clamp at least one side: clamped = [\"{top}\"]");
        let message =
            "no side is clamped: without Γ1 there is no Korn inequality, and ‖ε(v)‖ is no norm";
        let all_free = free && domain.held().is_empty();
        reading.refuse_if(all_free, "domain.clamped", message, &hint)?;
        let message = "no side is clamped, and the body can move along its planes of symmetry: there ‖ε(v)‖ is no norm";
        let left = free && side::rigid_motions_left(&domain) > 0;
        reading.refuse_if(left, "domain.symmetry", message, hint).map(|()| domain)
    }

    /// Its sides by condition.
    fn lists(&self) -> [(&'static str, &Vec<Side>); 4] {
        [
            ("clamped", &self.clamped),
            ("symmetry", &self.symmetry),
            ("traction", &self.traction),
            ("contact", &self.contact),
        ]
    }

    /// d.
    pub fn dimension(&self) -> usize {
        self.size.len()
    }

    /// Where u_ν = 0: planes of symmetry, and Γ3 where contact is bilateral.
    pub fn held(&self) -> Vec<Side> {
        let contact = if self.bilateral { &self.contact[..] } else { &[] };
        [&self.symmetry[..], contact].concat()
    }

    /// The name of a side.
    pub fn name(&self, side: Side) -> &str {
        &self.sides[side.index()]
    }

    /// Its sides by name.
    pub(super) fn known(&self) -> Vec<(&str, Side)> {
        self.sides.iter().map(String::as_str).zip((0..).map(Side)).collect()
    }

    /// The plane pieces of a side.
    pub fn faces(&self, side: Side) -> Vec<Face> {
        match &self.shape {
            Shape::Box => vec![Face::of_box(&self.size, side.0)],
            Shape::Refined(coarse) => {
                let of_side = coarse.pieces().into_iter().filter(|piece| piece.side == side.0);
                of_side.map(|piece| Face::simplex(&piece)).collect()
            }
        }
    }

    pub(crate) fn points_on(&self, side: Side, intervals: u32) -> Vec<[f64; 3]> {
        self.faces(side).iter().flat_map(|face| face.points(intervals)).collect()
    }

    /// All sides.
    pub fn all_sides(&self) -> impl Iterator<Item = Side> + use<> {
        (0..self.sides.len() as u32).map(Side)
    }

    /// If Γ3 is one plane piece and all normal lines from it end on Γ1, or across a plane of symmetry: the longest of them
    /// within the body.
    pub(crate) fn depth_under_contact(&self) -> Option<f64> {
        let [side] = self.contact[..] else { return None };
        match &self.shape {
            Shape::Box => {
                let opposite = Side(side.0 ^ 1);
                let ends = [&self.clamped, &self.symmetry].iter().any(|on| on.contains(&opposite));
                ends.then(|| self.size[side.index() / 2])
            }
            Shape::Refined(coarse) if coarse.dimension == 2 => {
                side::depth_under(coarse, side.0, |of| self.clamped.contains(&Side(of)))
            }
            // Not implemented in space.
            Shape::Refined(_) => None,
        }
    }

    /// |Ω|.
    pub fn measure(&self) -> f64 {
        match &self.shape {
            Shape::Box => self.size.iter().product(),
            Shape::Refined(coarse) => coarse.measure(),
        }
    }

    /// Smallest and largest x.
    pub fn width(&self) -> [f64; 2] {
        match &self.shape {
            Shape::Box => [0.0, self.size[0]],
            Shape::Refined(coarse) => coarse.bounds().map(|corner| corner[0]),
        }
    }

    /// The mesh n.
    pub fn mesh(&self, n: u32) -> Mesh {
        let family = self.mesh;
        match (&self.shape, &self.size[..]) {
            (Shape::Refined(coarse), _) => coarse.refined(n, family),
            (Shape::Box, &[a, b, c]) => lattice([a, b, c], n, family),
            (Shape::Box, _) => lattice([self.size[0], self.size[1]], n, family),
        }
    }

    /// Number of cells of mesh n, without making it.
    pub fn cells(&self, n: u32) -> f64 {
        match &self.shape {
            Shape::Refined(coarse) => {
                coarse.count() as f64 * f64::from(n).powi(coarse.dimension as i32)
            }
            Shape::Box => {
                // As the meshes of boxes round; no side has less than one.
                let along = |size: &f64| (size * f64::from(n)).round().max(1.0);
                let each = if self.dimension() == 2 { 2.0 } else { 6.0 };
                each * self.size.iter().map(along).product::<f64>()
            }
        }
    }

    /// The reported size of mesh n: 1/n for a rectangle or box, else the longest coarse edge over n.
    pub fn h(&self, n: u32) -> f64 {
        match &self.shape {
            Shape::Box => 1.0 / f64::from(n),
            Shape::Refined(coarse) => coarse.longest_edge() / f64::from(n),
        }
    }

    /// A grid of points with `intervals` steps along each axis or coarse edge, ends included; along edges of tetrahedra
    /// correspondingly fewer.
    pub(crate) fn points(&self, intervals: u32) -> Vec<[f64; 3]> {
        let coarse = match &self.shape {
            Shape::Refined(coarse) => coarse,
            Shape::Box => return Face::whole(&self.size).points(intervals),
        };
        let beside = match coarse.dimension {
            2 => 1.0,
            _ => (coarse.count() as f64 / 6.0).cbrt().max(1.0),
        };
        let parts = (f64::from(intervals) / beside).ceil() as u32;
        let mesh = coarse.refined(parts, Family::Structured);
        (0..mesh.vertices() as u32).map(|v| mesh.point(&[v], &[1.0])).collect()
    }

    /// Interior points: the midpoints of count × count parts of a rectangle (of a box, at z = 0), or the centroids of
    /// its coarse simplices, cut into at least count².
    pub fn inner_points(&self, count: u32) -> Vec<[f64; 3]> {
        match &self.shape {
            Shape::Box => {
                let part = |i: u32| (f64::from(i) + 0.5) / f64::from(count);
                // In space the planes alternate.
                let depth = self.size.get(2).copied().unwrap_or(0.0);
                let planes = count.saturating_sub(1).max(1);
                let at = |i: u32| {
                    let [x, y] = [part(i / count), part(i % count)];
                    [self.size[0] * x, self.size[1] * y, depth * part(i % planes)]
                };
                (0..count * count).map(at).collect()
            }
            Shape::Refined(coarse) => {
                let share = f64::from(count * count) / coarse.count() as f64;
                let root = if self.dimension() == 2 { share.sqrt() } else { share.cbrt() };
                let mesh = coarse.refined(root.ceil().max(1.0) as u32, Family::Structured);
                let corners = mesh.dimension + 1;
                let centroid = vec![1.0 / corners as f64; corners];
                mesh.points_of(&mesh.cells(), &[centroid])
            }
        }
    }

    /// The sides that a list names.
    pub(super) fn listed(&self, reading: &Reading, key: &str) -> Result<Vec<Side>> {
        let one = |index| {
            let key = format!("{key}.{index}");
            let name = reading.required::<String>(&key)?;
            let inside = self.inner_groups().contains(&name);
            let message = format!(
                "the group `{name}` of the mesh bounds nothing: no edge or face of it is on the boundary"
            );
            let hint = "take it out of the list; a group inside the domain is no side";
            reading.refuse_if(inside, &key, message, hint)?;
            reading.choice(&key, &self.known())
        };
        reading.entries(key)?.map(one).collect()
    }

    /// Groups of the mesh file that bound nothing and are passed over.
    pub fn inner_groups(&self) -> &[String] {
        match &self.shape {
            Shape::Refined(coarse) => &coarse.inner,
            Shape::Box => &[],
        }
    }

    fn each_side_once(&self, reading: &Reading) -> Result<()> {
        let mut owner: Vec<Option<&str>> = vec![None; self.sides.len()];
        for (list, sides) in self.lists() {
            for (index, side) in sides.iter().enumerate() {
                if let Some(first) = owner[side.index()].replace(list) {
                    let (key, side) = (format!("domain.{list}.{index}"), self.name(*side));
                    let message = format!("the side `{side}` is in `{first}` and in `{list}`");
                    let hint =
                        "each side must be in exactly one of clamped, symmetry, traction, contact";
                    return Err(reading.error(&key, message, hint));
                }
            }
        }
        let named = self.sides.iter().zip(&owner);
        let free: Vec<&str> =
            named.filter(|(_, owner)| owner.is_none()).map(|(name, _)| name.as_str()).collect();
        let message = match free[..] {
            [REST] if matches!(self.shape, Shape::Refined(_)) => {
                "no condition on the side rest: edges or faces of the boundary without a group"
                    .to_owned()
            }
            _ => format!("no condition on the side {}", free.join(", ")),
        };
        let hint = "put each side into clamped, symmetry, traction or contact, or write rest = \"traction\"; a free side is a traction side without a load";
        reading.refuse_if(!free.is_empty(), "domain", message, hint)
    }
}

// `[domain] shape`: its keys and its meaning.

/// The shapes with their keys.
const SHAPES: [(&str, &str); 4] = [
    ("rectangle", "size"),
    ("box", "size"),
    ("polygon", "vertices sides points triangles"),
    ("mesh", "file"),
];

fn shape(reading: &Reading, dimension: usize) -> Result<(Shape, Vec<f64>, Vec<String>)> {
    let known: &[(&str, &str)] = match dimension {
        3 => &[("box", "box"), ("mesh", "mesh")],
        _ => &[("rectangle", "rectangle"), ("polygon", "polygon"), ("mesh", "mesh")],
    };
    let shape = reading.choice("domain.shape", known)?;
    reading.only("domain", ("shape", shape), &SHAPES)?;
    let coarse = match shape {
        "polygon" => polygon(reading)?,
        "mesh" => {
            let path = path_of(reading.source, &reading.required::<String>("domain.file")?);
            let text = reading.source.mesh.as_deref().unwrap_or_default();
            let mesh = read_gmsh(text).map_err(|error| {
                let message = format!("the mesh file, {error}");
                let source = Source::from_text(path.clone(), text);
                SceneError::at(&source, error.span, message, error.fault.hint())
            })?;
            let cells = match mesh.dimension {
                3 => "tetrahedra, and dimension = 2",
                _ => "triangles and no tetrahedra, and dimension = 3",
            };
            let message = format!("the mesh {} has {cells}", path.display());
            let hint = "write the other dimension, or export the elements of this one from gmsh";
            reading.refuse_if(mesh.dimension != dimension, "domain.file", message, hint)?;
            mesh
        }
        _ => {
            let lengths = reading.entries_of("domain.size", dimension)?;
            let length = |index| reading.positive(&format!("domain.size.{index}"));
            let size = lengths.map(length).collect::<Result<_, _>>()?;
            let names = side::OF_A_BOX[..2 * dimension].iter().map(|name| (*name).to_string());
            return Ok((Shape::Box, size, names.collect()));
        }
    };
    let [low, high] = coarse.bounds();
    let (size, sides) = ((0..dimension).map(|i| high[i] - low[i]), coarse.sides.clone());
    Ok((Shape::Refined(coarse.into()), size.collect(), sides))
}

// `[domain] mesh`: how the vertices of the meshes are placed.

/// Larger exponents give cells at the corner below rounding.
const STEEPEST: f64 = 8.0;

/// The kinds of mesh with their keys.
const MESHES: [(&str, &str); 3] =
    [("structured", ""), ("perturbed", "amplitude seed axes"), ("graded", "corner exponent")];

pub(super) fn family(reading: &Reading, domain: &Domain) -> Result<Family> {
    if !reading.has("domain.mesh") {
        return Ok(Family::Structured);
    }
    let kind = reading.kind("domain.mesh", &MESHES)?;
    let tetrahedra = matches!(&domain.shape, Shape::Refined(coarse) if coarse.dimension == 3);
    let message = format!("meshes of kind `{kind}` are not made of tetrahedra from a file");
    let hint =
        "remove `mesh`, because the file says where the vertices are and refinement keeps them";
    reading.refuse_if(kind != "structured" && tetrahedra, "domain.mesh.kind", message, hint)?;
    match kind {
        "structured" => Ok(Family::Structured),
        "perturbed" => {
            let hint = "it is a part of the mesh width; from 0.25 on a triangle may turn over";
            let fits = |amplitude| (0.0..0.25).contains(&amplitude);
            let key = "domain.mesh.amplitude";
            let amplitude = reading.number(key, fits, ["is outside [0, 0.25)", hint])?;
            let seed = reading.seed("domain.mesh.seed")?;
            let known = &[("x", 0), ("y", 1), ("z", 2)][..domain.dimension()];
            let mut axes = [!reading.has("domain.mesh.axes"); 3];
            for index in reading.entries("domain.mesh.axes")? {
                axes[reading.choice(&format!("domain.mesh.axes.{index}"), known)?] = true;
            }
            Ok(Family::Perturbed { amplitude, seed, axes })
        }
        _ => {
            let key = "domain.mesh.corner";
            let corner = reading.pair(key)?;
            let fault = format!("is outside [1, {STEEPEST}]");
            let hint = "1 leaves the mesh as it is; for u ~ r^s at the corner 1/s or a little more restores order 1";
            let fits = |exponent| (1.0..=STEEPEST).contains(&exponent);
            let exponent = reading.number("domain.mesh.exponent", fits, [&fault, hint])?;
            let (known, what) = match &domain.shape {
                Shape::Box if domain.dimension() == 3 => {
                    let message = "a box has no graded meshes";
                    return Err(reading.error("domain.mesh.kind", message, "grade a plane scene"));
                }
                Shape::Box => {
                    let ends =
                        |axis: usize| corner[axis] == 0.0 || corner[axis] == domain.size[axis];
                    (ends(0) && ends(1), "corner of the rectangle")
                }
                Shape::Refined(coarse) => {
                    (vertex_at(coarse, corner).is_some(), "vertex of the coarse triangulation")
                }
            };
            let message = format!("({}, {}) is no {what}", corner[0], corner[1]);
            reading.refuse_if(
                !known,
                key,
                message,
                "grade towards a vertex that is in the file",
            )?;
            Ok(Family::Graded { corner, exponent })
        }
    }
}

// `shape = "polygon"`: vertices, named edges, and a coarse triangulation.

pub(super) fn polygon(reading: &Reading) -> Result<CoarseMesh> {
    let boundary = &reading.points("domain.vertices")?[..];
    let extent = |axis: usize| {
        let along = || boundary.iter().map(|p| p[axis]);
        along().fold(f64::NEG_INFINITY, f64::max) - along().fold(f64::INFINITY, f64::min)
    };
    let extent = extent(0).max(extent(1));
    // Coinciding or too few points get better messages below.
    let known = extent <= 0.0 || EXTENTS.contains(&extent);
    let message = format!("the polygon is {extent:.1e} across, outside 1e-150 to 1e150");
    let hint = "areas leave the range of doubles there; state the scene in another unit of length";
    reading.refuse_if(!known, "domain.vertices", message, hint)?;
    let triangles = triangulate(boundary).map_err(|error| refused(reading, &error))?;
    let mut vertices = boundary.to_vec();
    let triangles = match (reading.has("domain.triangles"), reading.has("domain.points")) {
        (false, false) => triangles,
        (false, true) => {
            let message = "`points` are vertices of `triangles`, and there are none";
            let hint = "add triangles = [[i, j, k], ...], numbered from 0, first the vertices, then the points";
            return Err(reading.key_error("domain.points", message, hint));
        }
        (true, points) => {
            if points {
                vertices.extend(reading.points("domain.points")?);
            }
            let last = vertices.len() as i64 - 1;
            let fault = format!("is no vertex: {} are numbered from 0", vertices.len());
            let triangle = |t| {
                let key = format!("domain.triangles.{t}");
                reading.entries_of(&key, 3)?;
                let corner = |a: usize| reading.whole(&format!("{key}.{a}"), 0..=last, &fault);
                Ok([corner(0)?, corner(1)?, corner(2)?])
            };
            reading.entries("domain.triangles")?.map(triangle).collect::<Result<_>>()?
        }
    };
    let (sides, of_edge) = names(reading, boundary.len())?;
    CoarseMesh::polygon(&vertices, &triangles, &of_edge, sides).map_err(|error| {
        let hint = "the triangles must cover the polygon, edge to edge, and each edge of the polygon must be an edge of one of them";
        reading.error("domain.triangles", error, hint)
    })
}

/// Range in which areas of polygons and of all their cells are doubles.
const EXTENTS: std::ops::RangeInclusive<f64> = 1e-150..=1e150;

/// Names of the sides in order of appearance, and the side of each edge.
fn names(reading: &Reading, count: usize) -> Result<(Vec<String>, Vec<u32>)> {
    let names: Option<Vec<String>> = reading.optional("domain.sides")?;
    let names = names.unwrap_or_else(|| (1..=count).map(|i| format!("s{i}")).collect());
    let message = format!("{} names for {count} edges", names.len());
    let hint = "give one name per edge; edge i goes from vertex i to the next, and several may share a name";
    reading.refuse_if(names.len() != count, "domain.sides", message, hint)?;
    let mut sides: Vec<String> = Vec::new();
    let mut of_edge = Vec::new();
    for (i, name) in names.into_iter().enumerate() {
        if reading.has("domain.sides") {
            reading.text(&format!("domain.sides.{i}"))?;
        }
        let side = sides.iter().position(|known| *known == name).unwrap_or_else(|| {
            sides.push(name);
            sides.len() - 1
        });
        of_edge.push(side as u32);
    }
    Ok((sides, of_edge))
}

fn refused(reading: &Reading, error: &PolygonError) -> SceneError {
    let (vertex, hint) = match error {
        PolygonError::TooFew { .. } => (None, "vertices = [[0.0, 0.0], [1.0, 0.0], [0.5, 1.0]]"),
        PolygonError::Repeated { second, .. } => (
            Some(second),
            "name each corner once; the last edge returns to the first vertex by itself",
        ),
        PolygonError::Crossing { second, .. } => {
            (Some(second), "order the vertices along the boundary")
        }
        PolygonError::Clockwise { .. } => {
            (None, "reverse them: the domain lies on the left of each edge")
        }
        PolygonError::TooThin { vertex } => {
            (Some(vertex), "widen the polygon, or give triangles = [[i, j, k], ...]")
        }
    };
    // Vertices in messages count from 0, as in `triangles`.
    let key = vertex.map_or(String::new(), |vertex| format!(".{vertex}"));
    reading.error(&format!("domain.vertices{key}"), error, hint)
}

// `shape = "mesh"`: a gmsh file beside the scene file.

/// Largest mesh file, 64 MiB; a coarse mesh has a few thousand cells.
const LARGEST_FILE: u64 = 64 << 20;

/// Adds the text of the mesh file that the domain names, unless present.
pub(crate) fn with_mesh(source: Source, table: &DeTable<'_>) -> Result<Source> {
    let word = |key| table.get("domain")?.get_ref().get(key)?.get_ref().as_str();
    let (Some("mesh"), Some(file), None) = (word("shape"), word("file"), &source.mesh) else {
        return Ok(source);
    };
    let path = path_of(&source, file);
    let inside = source.beside.iter().find(|(name, _)| *name == file);
    match inside.map_or_else(|| text(&path), |(_, text)| Ok((*text).to_owned())) {
        Ok(mesh) => Ok(source.with_mesh(mesh)),
        Err((reason, hint)) => {
            let message = format!("cannot read the mesh {}: {reason}", path.display());
            Err(SceneError::at(&source, placed(table, "domain.file").value, message, hint))
        }
    }
}

fn path_of(source: &Source, file: &str) -> PathBuf {
    source.path.parent().unwrap_or(Path::new("")).join(file)
}

fn text(path: &Path) -> Result<String, (String, &'static str)> {
    let hint = "give the path of a gmsh file (.msh, ASCII), relative to the folder of the scene";
    let bytes =
        read_file_up_to(path, LARGEST_FILE).map_err(|error| (error.source.to_string(), hint))?;
    String::from_utf8(bytes).map_err(|error| {
        let head = error.as_bytes().split(|byte| *byte == b'\n').nth(1);
        if head.is_some_and(|head| head.split(|byte| *byte == b' ').nth(1) == Some(b"1")) {
            return (Fault::Binary.to_string(), Fault::Binary.hint());
        }
        let byte = error.utf8_error().valid_up_to();
        (format!("byte {byte} is not text"), "write names of groups in UTF-8, or without accents")
    })
}
