//! Matches the points of a file with vertices by coordinates, since solvers renumber vertices.

use rustc_hash::FxHashMap;

use super::error::VtuReadError;

/// Matching distance relative to the largest coordinate: those written with six digits are off by 5e-6 of it.
const NEAR: f64 = 1e-5;

pub(crate) struct VertexPlaces<'a> {
    vertices: &'a [[f64; 3]],
    near: f64,
    /// Vertices in boxes of size 2 `near`.
    boxes: FxHashMap<[i64; 3], Vec<u32>>,
}

impl<'a> VertexPlaces<'a> {
    pub(crate) fn new(vertices: &'a [[f64; 3]]) -> Self {
        let largest = vertices.iter().flatten().fold(0.0f64, |largest, x| largest.max(x.abs()));
        let mut places = Self { vertices, near: NEAR * largest, boxes: FxHashMap::default() };
        for (vertex, at) in vertices.iter().enumerate() {
            let place = at.map(|x| places.coordinate(x));
            places.boxes.entry(place).or_default().push(vertex as u32);
        }
        places
    }

    fn coordinate(&self, x: f64) -> i64 {
        (x / (2.0 * self.near)).floor() as i64
    }

    /// The vertex of each point; every vertex must occur once.
    ///
    /// # Errors
    /// [`VtuReadError::Points`], [`VtuReadError::Elsewhere`], [`VtuReadError::Twice`].
    pub(crate) fn of(&self, points: &[[f64; 3]]) -> Result<Vec<u32>, VtuReadError> {
        let (found, wanted) = (points.len(), self.vertices.len());
        if found != wanted {
            return Err(VtuReadError::Points { found, wanted });
        }
        let mut taken = vec![usize::MAX; wanted];
        let vertex_of = |(point, &at): (usize, &[f64; 3])| {
            let near = self.near;
            let vertex = self.nearest(at).ok_or(VtuReadError::Elsewhere { point, at, near })?;
            match std::mem::replace(&mut taken[vertex as usize], point) {
                usize::MAX => Ok(vertex),
                first => Err(VtuReadError::Twice { first, point, vertex: vertex as usize }),
            }
        };
        points.iter().enumerate().map(vertex_of).collect()
    }

    /// The nearest vertex within the distance.
    fn nearest(&self, at: [f64; 3]) -> Option<u32> {
        let range = |x: f64| self.coordinate(x - self.near)..=self.coordinate(x + self.near);
        let [x, y, z] = at.map(range);
        let boxes = x.flat_map(|i| {
            let z = z.clone();
            y.clone().flat_map(move |j| z.clone().map(move |k| [i, j, k]))
        });
        boxes
            .filter_map(|place| self.boxes.get(&place))
            .flatten()
            .map(|&vertex| (distance(self.vertices[vertex as usize], at), vertex))
            .filter(|&(distance, _)| distance <= self.near)
            .min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)))
            .map(|(_, vertex)| vertex)
    }
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt()
}
