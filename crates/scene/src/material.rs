//! `[material]`: elasticity, optional memory and projection, and named regions.

use vhi::law::FourthOrder;

use super::diagnostic::SceneError;
use super::domain::Domain;
use super::elastic::{Given, elastic};
use super::memory::{self, Part, RelaxationTerm};
use super::projection::Projection;
use super::reading::Reading;
use super::region_place::{Place, place};
use super::written;

/// The law (5.1) with the terms that the scene has.
#[derive(Debug, Clone, PartialEq)]
pub struct Material {
    /// 𝒜 outside all named regions, positive definite.
    pub elastic: FourthOrder,
    /// The terms of ℬ; empty without memory.
    pub memory: Vec<RelaxationTerm>,
    pub projection: Option<Projection>,
    /// `[[material.region]]`, in file order.
    pub regions: Vec<Region>,
}

/// A named part of the body with a separate elasticity; separate memory is in [`RelaxationTerm::regions`].
#[derive(Debug, Clone, PartialEq)]
pub struct Region {
    pub name: String,
    pub place: Place,
    pub elastic: FourthOrder,
}

/// Regions are numbered by a byte.
const MOST_REGIONS: usize = 200;

impl Material {
    pub(super) fn validate(
        reading: &mut Reading,
        written: &written::Material,
        horizon: f64,
        domain: &Domain,
    ) -> Result<Material, SceneError> {
        let dimension = domain.dimension();
        let given = Given {
            lambda: written.lambda,
            mu: written.mu_l,
            young: written.young,
            poisson: written.poisson,
            table: written.elasticity.as_ref(),
        };
        let elastic = elastic(reading, "material", &given, dimension)?;
        let base = match &written.memory {
            Some(memory) => memory::parts(reading, None, memory, horizon, dimension)?,
            None => Vec::new(),
        };
        let (mut regions, mut parts) = (Vec::new(), Vec::new());
        for (index, region) in written.region.iter().enumerate() {
            let (region, region_memory) =
                Region::validate(reading, index, region, horizon, domain)?;
            if regions.iter().any(|other: &Region| other.name == region.name) {
                let message = format!("two regions are called `{}`", region.name);
                let key = format!("material.region.{index}.name");
                return Err(reading.error(&key, message, "rename one of them"));
            }
            regions.push(region);
            parts.push(region_memory.unwrap_or_else(|| base.clone()));
        }
        if regions.len() > MOST_REGIONS {
            let message =
                format!("{} regions: at most {MOST_REGIONS} are told apart", regions.len());
            return Err(reading.error("material.region", message, "merge regions of one material"));
        }
        let memory = memory::terms(reading, &base, &parts);
        let projection = written.projection.as_ref();
        let projection = projection.map(|p| Projection::validate(reading, p, horizon));
        Ok(Material { elastic, memory, projection: projection.transpose()?, regions })
    }

    /// The key of the first exponent of a kernel that is infinite at s = t.
    pub(super) fn singular_key(&self) -> Option<String> {
        let singular = self.memory.iter().find_map(|term| term.singular)?;
        Some(format!("{}.singular", memory::key(singular.region)))
    }

    /// Whether 𝒜 is given in full somewhere.
    pub fn is_anisotropic(&self) -> bool {
        let mut elastic = self.regions.iter().map(|region| &region.elastic).chain([&self.elastic]);
        elastic.any(|elastic| matches!(elastic, FourthOrder::Full(_)))
    }

    /// Whether one isotropic tensor and at most one term of memory describe the whole body.
    pub fn is_plain(&self) -> bool {
        self.regions.is_empty()
            && self.memory.len() <= 1
            && matches!(self.elastic, FourthOrder::Isotropic(_))
    }
}

impl Region {
    /// A region, and its separate memory if any.
    fn validate(
        reading: &mut Reading,
        index: usize,
        written: &written::Region,
        horizon: f64,
        domain: &Domain,
    ) -> Result<(Region, Option<Vec<Part>>), SceneError> {
        let dimension = domain.dimension();
        let key = format!("material.region.{index}");
        if written.name.trim().is_empty() {
            let message = "a region needs a name";
            return Err(reading.error(
                &format!("{key}.name"),
                message,
                "for instance: name = \"layer\"",
            ));
        }
        let place = place(reading, &key, written, domain)?;
        let given = Given {
            lambda: written.lambda,
            mu: written.mu_l,
            young: written.young,
            poisson: written.poisson,
            table: written.elasticity.as_ref(),
        };
        let elastic = elastic(reading, &key, &given, dimension)?;
        let parts = |written| memory::parts(reading, Some(index), written, horizon, dimension);
        let memory = written.memory.as_ref().map(parts).transpose()?;
        Ok((Region { name: written.name.clone(), place, elastic }, memory))
    }
}
