//! Rows of a mesh in bands of one material each.

use std::sync::Arc;

use super::bound_products::AlongX;
use super::on_rows::OnRows;
use super::part_moments::PartMoments;
use super::parts::Parts;
use super::products::Products;
use super::row_places::rules_of_halves;
use super::rows::Rows;
use fem::space::quadrature::Rule;

/// Bands of rows, in order.
pub(super) struct Bands(Vec<OnRows>);

impl Bands {
    /// Cuts `rows` where the region changes; `regions` are those of the cells, one for all of a row. Fields are integrated
    /// to the degree of `rule`.
    pub(crate) fn new(products: &Products, rows: &Rows, regions: &[usize], rule: &Rule) -> Self {
        let of_row = |j: usize| regions[rows.length() * j];
        let rules = rules_of_halves(rows, rule);
        let along_x = Arc::new(AlongX::new(products, rows, &rules));
        let mut bands = Vec::new();
        let mut first = 0;
        for j in 1..=rows.rows {
            if j == rows.rows || of_row(j) != of_row(first) {
                let (band, region) = (rows.some(first..j), of_row(first));
                bands.push(OnRows::new(products, along_x.clone(), &band, region, &rules));
                first = j;
            }
        }
        Self(bands)
    }

    /// Moments of u, ε and σ of all parts; none if a number is not finite.
    pub(crate) fn moments(&self, parts: &Parts<'_>, products: &Products) -> Option<PartMoments> {
        let mut bands = self.0.iter().map(|band| band.moments(parts, products));
        let first = bands.next()??;
        bands.try_fold(first, |all, band| Some(all.followed_by(band?)))
    }

    /// The means of σ alone, to the last bit those of [`Self::moments`].
    pub(crate) fn stress_means(
        &self,
        parts: &Parts<'_>,
        products: &Products,
    ) -> Option<Vec<Vec<f64>>> {
        let mut all = vec![Vec::new(); parts.count];
        for band in &self.0 {
            let means = band.stress_means(parts, products)?;
            all.iter_mut().zip(means).for_each(|(all, means)| all.extend(means));
        }
        Some(all)
    }
}
