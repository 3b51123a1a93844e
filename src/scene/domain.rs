//! `[domain]`: the rectangle or box, its sides, and the mesh family.

use crate::formula::Point;

use super::diagnostic::SceneError;
use super::reading::{Reading, evenly};
use super::written;

/// A side of the rectangle or box.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Side {
    /// x = 0.
    Left,
    /// x = size\[0\].
    Right,
    /// y = 0.
    Bottom,
    /// y = size\[1\].
    Top,
    /// z = 0, of a box.
    Front,
    /// z = size\[2\], of a box.
    Back,
}

impl Side {
    /// All sides; those of a rectangle come first.
    pub const ALL: [Side; 6] =
        [Side::Left, Side::Right, Side::Bottom, Side::Top, Side::Front, Side::Back];

    /// The 2 d sides in dimension d.
    pub fn of(dimension: usize) -> &'static [Side] {
        &Self::ALL[..2 * dimension.min(3)]
    }

    /// The name in scene files.
    pub fn name(self) -> &'static str {
        match self {
            Side::Left => "left",
            Side::Right => "right",
            Side::Bottom => "bottom",
            Side::Top => "top",
            Side::Front => "front",
            Side::Back => "back",
        }
    }

    /// The axis of its normal.
    pub fn axis(self) -> usize {
        self as usize / 2
    }

    /// True if the outward normal points along the axis, false if against it.
    pub fn is_far(self) -> bool {
        self as usize % 2 == 1
    }

    /// The parallel side.
    pub fn opposite(self) -> Side {
        Self::ALL[self as usize ^ 1]
    }

    /// The outward normal, padded with zeros.
    pub fn normal(self) -> [f64; 3] {
        let mut normal = [0.0; 3];
        normal[self.axis()] = if self.is_far() { 1.0 } else { -1.0 };
        normal
    }

    pub(super) fn parse(
        reading: &Reading,
        key: &str,
        word: &str,
        dimension: usize,
    ) -> Result<Side, SceneError> {
        let known: Vec<_> = Side::of(dimension).iter().map(|side| (side.name(), *side)).collect();
        reading.choice(key, word, &known)
    }

    /// Points of the side of a domain of this `size`: a grid with `intervals` steps along each of the
    /// other axes, from small to large coordinates.
    pub fn points(self, size: &[f64], intervals: u32) -> Vec<[f64; 3]> {
        let mut points = vec![[0.0; 3]];
        for (axis, &length) in size.iter().enumerate() {
            let places: Vec<f64> = match axis == self.axis() {
                true if self.is_far() => vec![length],
                true => vec![0.0],
                false => evenly(0.0, length, intervals).collect(),
            };
            points = combined(&points, axis, &places);
        }
        points
    }
}

/// Where a point is, in words.
pub(super) fn place(point: &Point, dimension: usize) -> String {
    let named = [("x", point.x), ("y", point.y), ("z", point.z)];
    let parts: Vec<String> =
        named[..dimension].iter().map(|(name, value)| format!("{name} = {value}")).collect();
    parts.join(", ")
}

/// Each point with each place along an axis; the new axis varies slowest.
fn combined(points: &[[f64; 3]], axis: usize, places: &[f64]) -> Vec<[f64; 3]> {
    let with = |place: f64| {
        points.iter().map(move |point| {
            let mut point = *point;
            point[axis] = place;
            point
        })
    };
    places.iter().flat_map(|&place| with(place)).collect()
}

/// How the domain is cut into simplices.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum MeshFamily {
    /// n squares a unit length, each cut by the diagonal from lower left to upper right.
    Structured,
    /// The structured mesh with its inner vertices moved by up to `amplitude`·h along each of the `axes`.
    Perturbed { amplitude: f64, seed: u64, axes: [bool; 3] },
}

/// The rectangle or box of the product of (0, size\[i\]); each side is in exactly one of the three lists.
#[derive(Debug, Clone, PartialEq)]
pub struct Domain {
    /// One length a dimension, positive.
    pub size: Vec<f64>,
    /// Γ1, at least one side: u = 0.
    pub clamped: Vec<Side>,
    /// Γ2: σν = f2.
    pub traction: Vec<Side>,
    /// Γ3: contact.
    pub contact: Vec<Side>,
    pub mesh: MeshFamily,
}

impl Domain {
    pub(super) fn validate(
        reading: &Reading,
        written: &written::Domain,
        dimension: usize,
    ) -> Result<Domain, SceneError> {
        let shape = if dimension == 3 { "box" } else { "rectangle" };
        reading.choice("domain.shape", &written.shape, &[(shape, ())])?;
        let domain = Domain {
            size: size(reading, &written.size, dimension)?,
            clamped: sides(reading, "domain.clamped", &written.clamped, dimension)?,
            traction: sides(reading, "domain.traction", &written.traction, dimension)?,
            contact: sides(reading, "domain.contact", &written.contact, dimension)?,
            mesh: mesh(reading, written.mesh.as_ref(), dimension)?,
        };
        domain.each_side_once(reading)?;
        if domain.clamped.is_empty() {
            let message =
                "no side is clamped: without Γ1 there is no Korn inequality, and ‖ε(v)‖ is no norm";
            return Err(reading.error(
                "domain.clamped",
                message,
                "clamp at least one side: clamped = [\"top\"]",
            ));
        }
        Ok(domain)
    }

    /// Points of the domain: a grid with `intervals` steps along each axis, ends included.
    pub fn points(&self, intervals: u32) -> Vec<[f64; 3]> {
        let axes = self.size.iter().enumerate();
        axes.fold(vec![[0.0; 3]], |points, (axis, &length)| {
            let places: Vec<f64> = evenly(0.0, length, intervals).collect();
            combined(&points, axis, &places)
        })
    }

    fn each_side_once(&self, reading: &Reading) -> Result<(), SceneError> {
        let lists =
            [("clamped", &self.clamped), ("traction", &self.traction), ("contact", &self.contact)];
        let mut owner: [Option<&str>; 6] = [None; 6];
        for (list, sides) in lists {
            for (index, side) in sides.iter().enumerate() {
                if let Some(first) = owner[*side as usize].replace(list) {
                    return Err(twice(
                        reading,
                        &format!("domain.{list}.{index}"),
                        *side,
                        [first, list],
                    ));
                }
            }
        }
        let is_free = |side: &&Side| owner[**side as usize].is_none();
        let all = Side::of(self.size.len()).iter();
        let free: Vec<&str> = all.filter(is_free).map(|side| side.name()).collect();
        if free.is_empty() {
            return Ok(());
        }
        let message = format!("no condition on the side {}", free.join(", "));
        let hint = "put each side into clamped, traction or contact; a free side is a traction side without a load";
        Err(reading.error("domain", message, hint))
    }
}

fn twice(reading: &Reading, key: &str, side: Side, [first, second]: [&str; 2]) -> SceneError {
    let lists = if first == second {
        format!("twice in `{first}`")
    } else {
        format!("in `{first}` and in `{second}`")
    };
    let message = format!("the side `{}` is {lists}", side.name());
    reading.error(key, message, "each side belongs to exactly one of clamped, traction, contact")
}

fn size(reading: &Reading, size: &[f64], dimension: usize) -> Result<Vec<f64>, SceneError> {
    if size.len() != dimension {
        let message = format!("`size` has {} entries in dimension {dimension}", size.len());
        return Err(reading.error(
            "domain.size",
            message,
            "give one length a dimension: size = [1.0, 1.0]",
        ));
    }
    size.iter()
        .enumerate()
        .map(|(index, &length)| reading.positive(&format!("domain.size.{index}"), length))
        .collect()
}

fn sides(
    reading: &Reading,
    key: &str,
    words: &[String],
    dimension: usize,
) -> Result<Vec<Side>, SceneError> {
    let parse = |(index, word): (usize, &String)| {
        Side::parse(reading, &format!("{key}.{index}"), word, dimension)
    };
    words.iter().enumerate().map(parse).collect()
}

fn mesh(
    reading: &Reading,
    written: Option<&written::Mesh>,
    dimension: usize,
) -> Result<MeshFamily, SceneError> {
    let Some(mesh) = written else {
        return Ok(MeshFamily::Structured);
    };
    let perturbed = reading.choice(
        "domain.mesh.kind",
        &mesh.kind,
        &[("structured", false), ("perturbed", true)],
    )?;
    if !perturbed {
        reading.surplus("domain.mesh.amplitude", mesh.amplitude.as_ref(), &mesh.kind)?;
        reading.surplus("domain.mesh.seed", mesh.seed.as_ref(), &mesh.kind)?;
        reading.surplus("domain.mesh.axes", mesh.axes.as_ref(), &mesh.kind)?;
        return Ok(MeshFamily::Structured);
    }
    let amplitude =
        reading.needed("domain.mesh.amplitude", mesh.amplitude, &mesh.kind, "amplitude = 0.2")?;
    if !(0.0..0.25).contains(&amplitude) {
        let message = format!("amplitude = {amplitude} is outside [0, 0.25)");
        return Err(reading.error(
            "domain.mesh.amplitude",
            message,
            "it is a part of the mesh width; from 0.25 on a triangle may turn over",
        ));
    }
    let seed = reading.needed("domain.mesh.seed", mesh.seed, &mesh.kind, "seed = 1")?;
    let seed = reading.seed("domain.mesh.seed", seed)?;
    Ok(MeshFamily::Perturbed {
        amplitude,
        seed,
        axes: axes(reading, mesh.axes.as_deref(), dimension)?,
    })
}

/// The axes along which vertices move: all, unless some are named.
fn axes(
    reading: &Reading,
    words: Option<&[String]>,
    dimension: usize,
) -> Result<[bool; 3], SceneError> {
    let Some(words) = words else { return Ok([true; 3]) };
    let known = &[("x", 0), ("y", 1), ("z", 2)][..dimension];
    let mut moved = [false; 3];
    for (index, word) in words.iter().enumerate() {
        moved[reading.choice(&format!("domain.mesh.axes.{index}"), word, known)?] = true;
    }
    Ok(moved)
}
