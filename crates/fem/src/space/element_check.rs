//! Whether an element is what it says, found before anything is computed with it.

use super::element::{Element, FiniteElement, Simplex};
use super::polynomials::monomials;

/// What is wrong with an element in dimension d.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("element {element} in dimension {dimension}: {fault}")]
pub struct ElementError {
    pub element: &'static str,
    pub dimension: usize,
    pub fault: ElementFault,
}

/// A part of [`FiniteElement`] that contradicts the others.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ElementFault {
    /// Shortcuts for an element know it by its name.
    #[error("an element of the program has this name")]
    Name,
    #[error("{found} {what}, where polynomials of degree {degree} need {wanted}")]
    Count { what: &'static str, degree: usize, found: usize, wanted: usize },
    #[error("barycentric coordinates of a point sum up to {sum}")]
    Place { sum: f64 },
    /// Two cells that share a facet must have its nodes in common, whatever the order of their corners.
    #[error("the node at {place:?} of a facet is no node of the cell")]
    OnFacet { place: Vec<f64> },
    #[error(
        "shape functions and nodes do not reproduce polynomials of degree {degree}: {off:e} is missed at {at:?}"
    )]
    Values { degree: usize, at: Vec<f64>, off: f64 },
    #[error(
        "slopes of shape function {function} are {off:e} from differences of its values at {at:?}"
    )]
    Slopes { function: usize, at: Vec<f64>, off: f64 },
    #[error("the strain rule is {off:e} from the mean of a polynomial of degree {degree}")]
    StrainRule { degree: usize, off: f64 },
    #[error(
        "facet weight {node} over the sum is {found}, and the mean of its shape function {mean}"
    )]
    FacetWeight { node: usize, found: f64, mean: f64 },
    #[error("facet weight {node} is negative")]
    Negative { node: usize },
}

/// Rounding of sums of some ten terms below ten.
const ROUNDING: f64 = 1e-12;
/// Step of central differences, and what they are off for polynomials of degree 4: step² times a third derivative of some
/// hundred, and rounding over the step.
const STEP: f64 = 1e-5;
const DIFFERENCES: f64 = 1e-7;

impl Element {
    /// An element that is not among [`Element::ALL`], for problems in dimension d = 2 or 3.
    ///
    /// # Errors
    /// Nodes, shape functions, slopes, strain points or weights that do not belong together.
    pub fn checked(
        element: &'static dyn FiniteElement,
        dimension: usize,
    ) -> Result<Self, ElementError> {
        let fault = |fault| ElementError { element: element.name(), dimension, fault };
        let element = Self::new(element);
        if Self::ALL.contains(&element) {
            return Err(fault(ElementFault::Name));
        }
        check(element, dimension).map_err(fault)?;
        Ok(element)
    }
}

fn check(element: Element, d: usize) -> Result<(), ElementFault> {
    let (cell, facet) = (Simplex::cell(d), Simplex::facet(d));
    let (degree, strains) = (element.degree(), element.degree().saturating_sub(1));
    functions(element, cell, degree)?;
    functions(element, facet, degree)?;
    nodes_of_facets(element, d)?;
    slopes(element, d)?;
    let rule = element.strain_rule(d);
    counted("strain points", strains, rule.points.len(), d)?;
    rule.points.iter().try_for_each(|b| adds_up(b))?;
    let off = rule.missed(2 * strains);
    if off.is_nan() || off > ROUNDING {
        return Err(ElementFault::StrainRule { degree: 2 * strains, off });
    }
    facet_weights(element, d)
}

/// Number of polynomials of this degree in dimension d: Π (degree + i)/i, i ≤ d.
fn counted(what: &'static str, degree: usize, found: usize, d: usize) -> Result<(), ElementFault> {
    let wanted = (1..=d).fold(1, |count, i| count * (degree + i) / i);
    if found == wanted { Ok(()) } else { Err(ElementFault::Count { what, degree, found, wanted }) }
}

fn adds_up(b: &[f64]) -> Result<(), ElementFault> {
    let sum: f64 = b.iter().sum();
    if (sum - 1.0).abs() <= ROUNDING { Ok(()) } else { Err(ElementFault::Place { sum }) }
}

/// Points of a simplex in general position.
fn samples(corners: usize) -> [Vec<f64>; 3] {
    [[1.0, 2.0, 4.0, 7.0], [5.0, 1.0, 3.0, 2.0], [2.0, 9.0, 1.0, 4.0]].map(|parts| {
        let sum: f64 = parts[..corners].iter().sum();
        parts[..corners].iter().map(|part| part / sum).collect()
    })
}

/// Σ_a φ_a(b) m(x_a) = m(b) for all monomials: with as many functions as these, they are those of the nodes.
fn functions(element: Element, simplex: Simplex, degree: usize) -> Result<(), ElementFault> {
    let nodes = element.nodes(simplex);
    counted("nodes", degree, nodes.len(), simplex.corners() - 1)?;
    nodes.iter().try_for_each(|node| adds_up(node))?;
    let at_nodes: Vec<Vec<f64>> = nodes.iter().map(|node| monomials(degree, node)).collect();
    for b in samples(simplex.corners()) {
        let values = element.values_on(simplex, &b);
        counted("shape functions", degree, values.len(), simplex.corners() - 1)?;
        for (m, exact) in monomials(degree, &b).into_iter().enumerate() {
            let sum: f64 = values.iter().zip(&at_nodes).map(|(value, node)| value * node[m]).sum();
            let off = (sum - exact).abs();
            if off.is_nan() || off > ROUNDING {
                return Err(ElementFault::Values { degree, at: b, off });
            }
        }
    }
    Ok(())
}

fn nodes_of_facets(element: Element, d: usize) -> Result<(), ElementFault> {
    let of_cell = element.nodes(Simplex::cell(d));
    let is_node = |place: &[f64]| of_cell.iter().any(|node| node == place);
    for b in element.nodes(Simplex::facet(d)) {
        for order in orders(d + 1) {
            // Coordinate 0 of the cell, wherever it goes, is that of the corner that the facet lacks.
            let place: Vec<f64> =
                order.iter().map(|&from| if from == 0 { 0.0 } else { b[from - 1] }).collect();
            if !is_node(&place) {
                return Err(ElementFault::OnFacet { place });
            }
        }
    }
    Ok(())
}

/// All orders of the numbers below `count`.
fn orders(count: usize) -> Vec<Vec<usize>> {
    let Some(last) = count.checked_sub(1) else { return vec![Vec::new()] };
    let with_last = |order: Vec<usize>| {
        (0..count).map(move |at| {
            let mut longer = order.clone();
            longer.insert(at, last);
            longer
        })
    };
    orders(last).into_iter().flat_map(with_last).collect()
}

/// ∂φ/∂b_i - ∂φ/∂b_0 against differences along the edge between corners 0 and i.
fn slopes(element: Element, d: usize) -> Result<(), ElementFault> {
    for b in samples(d + 1) {
        let slopes = element.slopes(&b);
        counted("slopes", element.degree(), slopes.len(), d)?;
        for i in 1..=d {
            let moved = |step: f64| {
                let mut at = b.clone();
                (at[0], at[i]) = (at[0] - step, at[i] + step);
                element.values(&at)
            };
            let pairs = moved(STEP).into_iter().zip(moved(-STEP));
            for (function, ((ahead, behind), of)) in pairs.zip(&slopes).enumerate() {
                let slope = (ahead - behind) / (2.0 * STEP);
                let off = (of[i] - of[0] - slope).abs();
                if off.is_nan() || off > DIFFERENCES {
                    return Err(ElementFault::Slopes { function, at: b, off });
                }
            }
        }
    }
    Ok(())
}

fn facet_weights(element: Element, d: usize) -> Result<(), ElementFault> {
    let (facet, rule) = (Simplex::facet(d), element.square_rule(d));
    let (weights, sum) = element.facet_weights(d);
    counted("facet weights", element.degree(), weights.len(), d - 1)?;
    let mut means = vec![0.0; weights.len()];
    for (b, weight) in rule.points.iter().zip(&rule.weights) {
        let values = element.values_on(facet, b);
        means.iter_mut().zip(values).for_each(|(mean, value)| *mean += weight * value);
    }
    for (node, (weight, mean)) in weights.iter().zip(means).enumerate() {
        let found = weight / sum;
        if *weight < 0.0 {
            return Err(ElementFault::Negative { node });
        }
        let off = (found - mean).abs();
        if off.is_nan() || off > ROUNDING {
            return Err(ElementFault::FacetWeight { node, found, mean });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::space::quadrature::{Rule, triangle_degree_4};

    #[test]
    fn the_elements_of_scenes_are_what_they_say() {
        for (element, d) in
            Element::ALL.into_iter().flat_map(|element| [(element, 2), (element, 3)])
        {
            assert_eq!(check(element, d), Ok(()), "{element:?} {d}");
        }
    }

    /// P2 with one part replaced.
    #[derive(Debug)]
    struct Damaged(&'static str);

    impl Damaged {
        fn turned(&self, part: &str, mut list: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
            if self.0 == part {
                list.swap(3, 4);
            }
            list
        }
    }

    impl FiniteElement for Damaged {
        fn name(&self) -> &'static str {
            if self.0 == "name" { "P1" } else { "P2 damaged" }
        }
        fn degree(&self) -> usize {
            if self.0 == "degree" { 3 } else { 2 }
        }
        fn nodes(&self, simplex: Simplex) -> Vec<Vec<f64>> {
            let mut nodes = Element::P2.nodes(simplex);
            match self.0 {
                "place" => nodes[0][0] = 1.5,
                "facet" if simplex.is_facet() => nodes[2] = vec![0.25, 0.75],
                "nodes" if !simplex.is_facet() => nodes.swap(3, 4),
                _ => (),
            }
            nodes
        }
        fn values_on(&self, simplex: Simplex, b: &[f64]) -> Vec<f64> {
            let mut values = Element::P2.values_on(simplex, b);
            if self.0 == "facet" && simplex.is_facet() {
                // Those of nodes at the ends and at 3/4.
                let x = b[1];
                values = vec![
                    (x - 1.0) * (x - 0.75) / 0.75,
                    x * (x - 0.75) / 0.25,
                    x * (1.0 - x) / (0.75 * 0.25),
                ];
            }
            values
        }
        fn slopes(&self, b: &[f64]) -> Vec<Vec<f64>> {
            self.turned("slopes", Element::P2.slopes(b))
        }
        fn strain_rule(&self, dimension: usize) -> Rule {
            let mut rule = Element::P2.strain_rule(dimension);
            match self.0 {
                "strains" => triangle_degree_4(),
                "rule" => {
                    rule.weights = vec![0.5, 0.25, 0.25];
                    rule
                }
                _ => rule,
            }
        }
        fn facet_weights(&self, dimension: usize) -> (Vec<f64>, f64) {
            match self.0 {
                "weights" => (vec![1.0; 3], 3.0),
                "sign" => (vec![1.0, 1.0, -4.0], 6.0),
                "NaN" => (vec![f64::NAN; 3], 1.0),
                _ => Element::P2.facet_weights(dimension),
            }
        }
    }

    #[test]
    fn each_part_that_does_not_belong_is_named() {
        use ElementFault as F;
        let fault = |part: &'static str| {
            let element: &'static Damaged = Box::leak(Box::new(Damaged(part)));
            Element::checked(element, 2).expect_err(part).fault
        };
        assert_eq!(check(Element::new(&Damaged("nothing")), 2), Ok(()));
        assert!(matches!(fault("degree"), F::Count { found: 6, wanted: 10, .. }));
        assert_eq!(fault("place"), F::Place { sum: 1.5 });
        assert_eq!(fault("name"), F::Name);
        assert!(matches!(fault("nodes"), F::Values { off, .. } if off > 0.01));
        assert_eq!(fault("facet"), F::OnFacet { place: vec![0.75, 0.25, 0.0] });
        assert!(matches!(fault("slopes"), F::Slopes { function: 3, off, .. } if off > 0.1));
        assert!(matches!(fault("strains"), F::Count { found: 6, wanted: 3, .. }));
        assert!(matches!(fault("rule"), F::StrainRule { degree: 2, off } if off > 0.01));
        assert!(matches!(fault("weights"), F::FacetWeight { node: 0, .. }));
        assert_eq!(fault("sign"), F::Negative { node: 2 });
        assert!(matches!(fault("NaN"), F::FacetWeight { .. }));
    }
}
