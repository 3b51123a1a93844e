//! Whether the parts of an element belong together: nodes, functions, slopes, strain points, weights.

use super::element::{Element, FiniteElement};
use super::polynomials::monomials;
use super::quadrature::{Rule, triangle_degree_4};

/// Rounding of sums of some ten terms below ten.
const ROUNDING: f64 = 1e-12;
/// Step of central differences, and what they are off for polynomials of degree 4: step² times a third derivative of some
/// hundred, and rounding over the step.
const STEP: f64 = 1e-5;
const DIFFERENCES: f64 = 1e-7;

/// Which part contradicts the others.
fn check(element: Element, d: usize) -> Result<(), String> {
    let (degree, strains) = (element.degree(), element.degree().saturating_sub(1));
    functions(element, d + 1, degree)?;
    functions(element, d, degree)?;
    nodes_of_facets(element, d)?;
    slopes(element, d)?;
    let rule = element.strain_rule(d);
    counted("strain points", strains, rule.points.len(), d)?;
    rule.points.iter().try_for_each(|b| adds_up(b))?;
    within("strain rule", rule.missed(2 * strains), ROUNDING)?;
    facet_weights(element, d)
}

/// NaN is not within anything.
fn within(what: &str, off: f64, most: f64) -> Result<(), String> {
    if off <= most { Ok(()) } else { Err(format!("{what}: {off:e}")) }
}

/// Number of polynomials of this degree in dimension d: Π (degree + i)/i, i ≤ d.
fn counted(what: &str, degree: usize, found: usize, d: usize) -> Result<(), String> {
    let wanted = (1..=d).fold(1, |count, i| count * (degree + i) / i);
    if found == wanted { Ok(()) } else { Err(format!("{found} {what}")) }
}

fn adds_up(b: &[f64]) -> Result<(), String> {
    within("place", (b.iter().sum::<f64>() - 1.0).abs(), ROUNDING)
}

/// Points of a simplex in general position.
fn samples(corners: usize) -> [Vec<f64>; 3] {
    [[1.0, 2.0, 4.0, 7.0], [5.0, 1.0, 3.0, 2.0], [2.0, 9.0, 1.0, 4.0]].map(|parts| {
        let sum: f64 = parts[..corners].iter().sum();
        parts[..corners].iter().map(|part| part / sum).collect()
    })
}

/// Σ_a φ_a(b) m(x_a) = m(b) for all monomials: with as many functions as these, they are those of the nodes.
fn functions(element: Element, corners: usize, degree: usize) -> Result<(), String> {
    let nodes = element.nodes(corners);
    counted("nodes", degree, nodes.len(), corners - 1)?;
    nodes.iter().try_for_each(|node| adds_up(node))?;
    let at_nodes: Vec<Vec<f64>> = nodes.iter().map(|node| monomials(degree, node)).collect();
    for b in samples(corners) {
        let values = element.values(&b);
        counted("shape functions", degree, values.len(), corners - 1)?;
        for (m, exact) in monomials(degree, &b).into_iter().enumerate() {
            let sum: f64 = values.iter().zip(&at_nodes).map(|(value, node)| value * node[m]).sum();
            within("values", (sum - exact).abs(), ROUNDING)?;
        }
    }
    Ok(())
}

fn nodes_of_facets(element: Element, d: usize) -> Result<(), String> {
    let of_cell = element.nodes(d + 1);
    let is_node = |place: &[f64]| of_cell.iter().any(|node| node == place);
    for b in element.nodes(d) {
        for order in orders(d + 1) {
            // Coordinate 0 of the cell, wherever it goes, is that of the corner that the facet lacks.
            let place: Vec<f64> =
                order.iter().map(|&from| if from == 0 { 0.0 } else { b[from - 1] }).collect();
            if !is_node(&place) {
                return Err(format!("facet: {place:?}"));
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
fn slopes(element: Element, d: usize) -> Result<(), String> {
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
                within(
                    &format!("slopes of {function}"),
                    (of[i] - of[0] - slope).abs(),
                    DIFFERENCES,
                )?;
            }
        }
    }
    Ok(())
}

fn facet_weights(element: Element, d: usize) -> Result<(), String> {
    let rule = element.square_rule(d);
    let (weights, sum) = element.facet_weights(d);
    counted("facet weights", element.degree(), weights.len(), d - 1)?;
    let mut means = vec![0.0; weights.len()];
    for (b, weight) in rule.points.iter().zip(&rule.weights) {
        let values = element.values(b);
        means.iter_mut().zip(values).for_each(|(mean, value)| *mean += weight * value);
    }
    for (node, (weight, mean)) in weights.iter().zip(means).enumerate() {
        if *weight < 0.0 {
            return Err(format!("negative weight {node}"));
        }
        within(&format!("weight {node}"), (weight / sum - mean).abs(), ROUNDING)?;
    }
    Ok(())
}

#[test]
fn the_elements_of_scenes_are_what_they_say() {
    for (element, d) in Element::ALL.into_iter().flat_map(|element| [(element, 2), (element, 3)]) {
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
        "P2 damaged"
    }
    fn degree(&self) -> usize {
        if self.0 == "degree" { 3 } else { 2 }
    }
    fn nodes(&self, corners: usize) -> Vec<Vec<f64>> {
        let mut nodes = Element::P2.nodes(corners);
        match self.0 {
            "place" => nodes[0][0] = 1.5,
            "facet" if corners == 2 => nodes[2] = vec![0.25, 0.75],
            "nodes" if corners == 3 => nodes.swap(3, 4),
            _ => (),
        }
        nodes
    }
    fn values(&self, b: &[f64]) -> Vec<f64> {
        let mut values = Element::P2.values(b);
        if self.0 == "facet" && b.len() == 2 {
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
    let found = |part: &'static str| {
        let element: &'static Damaged = Box::leak(Box::new(Damaged(part)));
        check(Element::new(element), 2).err().unwrap_or_default()
    };
    assert_eq!(found("nothing"), "");
    for (part, said) in [
        ("degree", "6 nodes"),
        ("place", "place: "),
        ("nodes", "values: "),
        ("facet", "facet: "),
        ("slopes", "slopes of 3: "),
        ("strains", "6 strain points"),
        ("rule", "strain rule: "),
        ("weights", "weight 0: "),
        ("sign", "negative weight 2"),
        ("NaN", "weight 0: NaN"),
    ] {
        assert!(found(part).starts_with(said), "{part}: {}", found(part));
    }
}
