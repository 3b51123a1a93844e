//! `[domain]`: the rectangle, box, polygon or mesh file, its named sides, and the mesh family.

mod depth;
mod family;
mod mesh_file;
mod normals;
mod polygon;
mod shape;
mod side;

pub(super) use family::MESHES;
pub(super) use mesh_file::with_mesh;
pub use side::{Face, Side};

use std::sync::Arc;

use fem::mesh::{CoarseMesh, Family, Mesh, REST, lattice};
use formula::EvaluationPoint;

use super::diagnostic::Result;
use super::reading::Reading;

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
    pub mesh: Family,
}

impl Domain {
    pub(super) fn validate(reading: &Reading, dimension: usize) -> Result<Domain> {
        let (shape, size, sides) = shape::shape(reading, dimension)?;
        let (clamped, symmetry, traction, contact) = Default::default();
        let mesh = Family::Structured;
        let mut domain = Domain { shape, size, sides, clamped, symmetry, traction, contact, mesh };
        domain.clamped = domain.listed(reading, "domain.clamped")?;
        domain.symmetry = domain.listed(reading, "domain.symmetry")?;
        domain.traction = domain.listed(reading, "domain.traction")?;
        domain.contact = domain.listed(reading, "domain.contact")?;
        domain.take_rest(reading)?;
        domain.mesh = family::family(reading, &domain)?;
        domain.each_side_once(reading)?;
        normals::few_at_a_vertex(reading, &domain)?;
        domain.fixed(reading)?;
        Ok(domain)
    }

    /// d.
    pub fn dimension(&self) -> usize {
        self.size.len()
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
            Shape::Box => vec![Face::of_box(&self.size, side)],
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

    /// Refuses a body that can move without strain: Γ1 is empty, and u_ν = 0 on planes of symmetry leaves a translation or
    /// rotation.
    fn fixed(&self, reading: &Reading) -> Result<()> {
        if !self.clamped.is_empty() {
            return Ok(());
        }
        let hint = format!("clamp at least one side: clamped = [\"{}\"]", self.example_of_a_side());
        if self.symmetry.is_empty() {
            let message =
                "no side is clamped: without Γ1 there is no Korn inequality, and ‖ε(v)‖ is no norm";
            return Err(reading.error("domain.clamped", message, hint));
        }
        let message = "no side is clamped, and the body can move along its planes of symmetry: there ‖ε(v)‖ is no norm";
        let left = normals::rigid_motions_left(self) > 0;
        reading.refuse_if(left, "domain.symmetry", message, hint)
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
                depth::under(coarse, side.0, |of| self.clamped.contains(&Side(of)))
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
                (0..mesh.cell_count()).map(|c| mesh.point(mesh.cell(c), &centroid)).collect()
            }
        }
    }

    fn example_of_a_side(&self) -> &str {
        let top = self.sides.iter().find(|name| *name == "top");
        top.or(self.sides.first()).map_or("top", String::as_str)
    }

    fn listed(&self, reading: &Reading, key: &str) -> Result<Vec<Side>> {
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

    /// `rest`: what becomes of the sides that no list names.
    fn take_rest(&mut self, reading: &Reading) -> Result<()> {
        if reading.optional::<String>("domain.rest")?.is_none() {
            return Ok(());
        }
        reading.choice("domain.rest", &[("traction", ())])?;
        let lists = [&self.clamped, &self.symmetry, &self.traction, &self.contact];
        let listed = lists.into_iter().flatten();
        let listed: Vec<Side> = listed.copied().collect();
        self.traction.extend(self.all_sides().filter(|side| !listed.contains(side)));
        Ok(())
    }

    fn each_side_once(&self, reading: &Reading) -> Result<()> {
        let lists = [
            ("clamped", &self.clamped),
            ("symmetry", &self.symmetry),
            ("traction", &self.traction),
            ("contact", &self.contact),
        ];
        let mut owner: Vec<Option<&str>> = vec![None; self.sides.len()];
        for (list, sides) in lists {
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
