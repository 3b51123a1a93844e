// Cubics on triangles, with nodes in thirds, corners first: an element of your own under a scene.
use gronwall::scene::Scene;
use gronwall::space::quadrature::{Rule, triangle_degree_4};
use gronwall::space::{Element, FiniteElement};
use gronwall::Sweep;

#[derive(Debug)]
struct Cubic;

fn lattice(corners: u32) -> Vec<Vec<u32>> {
    let all = (0..4u32.pow(corners)).map(|code| (0..corners).map(move |i| code / 4u32.pow(i) % 4));
    let nodes = all.map(Vec::from_iter).filter(|node| node.iter().sum::<u32>() == 3);
    let (corners, others): (Vec<_>, Vec<_>) = nodes.partition(|node| node.contains(&3));
    [corners, others].concat()
}

/// Π (3b - m)/(m + 1), m < count, and its derivative.
fn factor(count: u32, b: f64) -> (f64, f64) {
    match count {
        0 => (1.0, 0.0),
        1 => (3.0 * b, 3.0),
        2 => (4.5 * b * b - 1.5 * b, 9.0 * b - 1.5),
        _ => (4.5 * b * b * (b - 1.0) + b, 13.5 * b * b - 9.0 * b + 1.0),
    }
}

impl FiniteElement for Cubic {
    fn name(&self) -> &'static str {
        "P3"
    }
    fn degree(&self) -> usize {
        3
    }
    fn nodes(&self, corners: usize) -> Vec<Vec<f64>> {
        let place = |node: Vec<u32>| node.iter().map(|&i| f64::from(i) / 3.0).collect();
        lattice(corners as u32).into_iter().map(place).collect()
    }
    fn values(&self, b: &[f64]) -> Vec<f64> {
        let value = |node: Vec<u32>| node.iter().zip(b).map(|(&i, &b)| factor(i, b).0).product();
        lattice(b.len() as u32).into_iter().map(value).collect()
    }
    fn slopes(&self, b: &[f64]) -> Vec<Vec<f64>> {
        let along = |node: &[u32], j: usize| -> f64 {
            let of = |(i, (&count, &b)): (usize, (&u32, &f64))| {
                let (value, slope) = factor(count, b);
                if i == j { slope } else { value }
            };
            node.iter().zip(b).enumerate().map(of).product()
        };
        let slopes = |node: Vec<u32>| (0..b.len()).map(|j| along(&node, j)).collect();
        lattice(b.len() as u32).into_iter().map(slopes).collect()
    }
    fn strain_rule(&self, _: usize) -> Rule {
        triangle_degree_4()
    }
    fn facet_weights(&self, _: usize) -> (Vec<f64>, f64) {
        (vec![1.0, 1.0, 3.0, 3.0], 8.0)
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let scene = Scene::read("manufactured/quadratic-elastic.toml".as_ref())?;
    let mut scene = scene.with_element(Element::new(&Cubic))?;
    scene.predicts[0].order = 3.0;
    scene.predicts[1].order = 3.75;
    assert!(Sweep::of(scene).n(&[4, 8, 16]).jobs(2).run()?.as_expected());
    Ok(())
}
