//! `[material]`: elasticity, optional memory and projection, and named regions.

use vhi::law::FourthOrder;

use super::diagnostic::Result;
use super::domain::Domain;
use super::elastic::elastic;
use super::memory::{self, RelaxationTerm};
use super::projection::Projection;
use super::reading::Reading;
use super::region_place::{Place, place};
use super::spans::join;

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
        horizon: f64,
        domain: &Domain,
    ) -> Result<Material> {
        let elastic = elastic(reading, "material", domain.dimension())?;
        let base = memory::parts(reading, None, horizon, domain.dimension())?.unwrap_or_default();
        let (mut regions, mut parts) = (Vec::new(), Vec::new());
        for index in reading.entries("material.region")? {
            let region = Region::validate(reading, index, domain)?;
            let known = regions.iter().any(|other: &Region| other.name == region.name);
            let message = format!("two regions are called `{}`", region.name);
            let key = format!("material.region.{index}.name");
            reading.refuse_if(known, &key, message, "rename one of them")?;
            regions.push(region);
            let separate = memory::parts(reading, Some(index), horizon, domain.dimension())?;
            parts.push(separate.unwrap_or_else(|| base.clone()));
        }
        let message = format!("{} regions: at most {MOST_REGIONS} are told apart", regions.len());
        let (many, hint) = (regions.len() > MOST_REGIONS, "merge regions of one material");
        reading.refuse_if(many, "material.region", message, hint)?;
        let memory = memory::terms(reading, &base, &parts);
        let projection = reading
            .if_given("material.projection", |reading, _| Projection::validate(reading, horizon))?;
        Ok(Material { elastic, memory, projection, regions })
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
    fn validate(reading: &mut Reading, index: usize, domain: &Domain) -> Result<Region> {
        let table = format!("material.region.{index}");
        let key = join(&table, "name");
        let name: String = reading.required(&key)?;
        let hint = "for instance: name = \"layer\"";
        reading.refuse_if(name.trim().is_empty(), &key, "a region needs a name", hint)?;
        let place = place(reading, &table, &name, domain)?;
        Ok(Region { name, place, elastic: elastic(reading, &table, domain.dimension())? })
    }
}
