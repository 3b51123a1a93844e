//! `[domain]`: the rectangle, its sides, and the mesh family.

use super::diagnostic::SceneError;
use super::reading::Reading;
use super::written;

/// A side of the rectangle; outward normals (-1,0), (1,0), (0,-1), (0,1).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Side {
    Left,
    Right,
    Bottom,
    Top,
}

impl Side {
    /// The four sides.
    pub const ALL: [Side; 4] = [Side::Left, Side::Right, Side::Bottom, Side::Top];

    /// The name in scene files.
    pub fn name(self) -> &'static str {
        match self {
            Side::Left => "left",
            Side::Right => "right",
            Side::Bottom => "bottom",
            Side::Top => "top",
        }
    }

    pub(super) fn parse(reading: &Reading, key: &str, word: &str) -> Result<Side, SceneError> {
        reading.choice(key, word, &Side::ALL.map(|side| (side.name(), side)))
    }

    /// The point of the side at the fraction s ∈ [0, 1], from left to right or from bottom to top.
    pub(super) fn point(self, size: &[f64], s: f64) -> [f64; 2] {
        match self {
            Side::Left => [0.0, s * size[1]],
            Side::Right => [size[0], s * size[1]],
            Side::Bottom => [s * size[0], 0.0],
            Side::Top => [s * size[0], size[1]],
        }
    }
}

/// How the domain is cut into simplices.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum MeshFamily {
    /// n squares a unit length, each cut by the diagonal from lower left to upper right.
    Structured,
    /// The structured mesh with its inner vertices moved by up to `amplitude`·h in each coordinate.
    Perturbed { amplitude: f64, seed: u64 },
}

/// The rectangle (0, size\[0\]) × (0, size\[1\]); each side is in exactly one of the three lists.
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
        reading.choice("domain.shape", &written.shape, &[("rectangle", ())])?;
        let domain = Domain {
            size: size(reading, &written.size, dimension)?,
            clamped: sides(reading, "domain.clamped", &written.clamped)?,
            traction: sides(reading, "domain.traction", &written.traction)?,
            contact: sides(reading, "domain.contact", &written.contact)?,
            mesh: mesh(reading, written.mesh.as_ref())?,
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

    fn each_side_once(&self, reading: &Reading) -> Result<(), SceneError> {
        let lists =
            [("clamped", &self.clamped), ("traction", &self.traction), ("contact", &self.contact)];
        let mut owner: [Option<&str>; 4] = [None; 4];
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
        let is_free = |side: &Side| owner[*side as usize].is_none();
        let free: Vec<&str> = Side::ALL.into_iter().filter(is_free).map(Side::name).collect();
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

fn sides(reading: &Reading, key: &str, words: &[String]) -> Result<Vec<Side>, SceneError> {
    words
        .iter()
        .enumerate()
        .map(|(index, word)| Side::parse(reading, &format!("{key}.{index}"), word))
        .collect()
}

fn mesh(reading: &Reading, written: Option<&written::Mesh>) -> Result<MeshFamily, SceneError> {
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
    Ok(MeshFamily::Perturbed { amplitude, seed: reading.seed("domain.mesh.seed", seed)? })
}
