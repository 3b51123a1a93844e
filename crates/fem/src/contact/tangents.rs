//! Tangents at the points of Γ3, and the unknowns that carry u_τ.

use super::Discretization;
use super::trace::TracePoint;

/// Where a point of the trace carries u_τ along one tangent = sign · unknown.
pub(super) struct Tangential {
    pub(super) unknown: u32,
    pub(super) sign: f64,
}

/// A component of a unit vector that is zero but for rounding.
const ALONG_AXIS: f64 = 1e-12;

impl TracePoint {
    /// The unit tangent in the plane, towards growing x, or growing y on a side along y.
    pub fn tangent(&self) -> [f64; 2] {
        let [x, y, _] = self.normal;
        if y < -ALONG_AXIS || (y <= ALONG_AXIS && x > 0.0) { [-y, x] } else { [y, -x] }
    }

    /// The d - 1 unit tangents along which u_τ and s are given, orthogonal to each other and to ν.
    pub fn tangents(&self) -> impl Iterator<Item = &[f64]> {
        let d = usize::from(self.dimension);
        self.tangents[..d - 1].iter().map(move |tangent| &tangent[..d])
    }

    /// u_τ of a nodal vector along the tangents; its second number is 0 in the plane.
    pub fn slip(&self, u: &[f64]) -> [f64; 2] {
        let at_node = &u[usize::from(self.dimension) * self.node as usize..];
        let along = |tangent: &[f64]| tangent.iter().zip(at_node).map(|(t, u)| t * u).sum();
        let mut slip = [0.0; 2];
        slip.iter_mut().zip(self.tangents()).for_each(|(slip, tangent)| *slip = along(tangent));
        slip
    }

    pub(super) fn add_tangential(&self, components: &[f64], force: &mut [f64]) {
        let at_node = &mut force[usize::from(self.dimension) * self.node as usize..];
        for (value, tangent) in components.iter().zip(self.tangents()) {
            at_node.iter_mut().zip(tangent).for_each(|(force, along)| *force += value * along);
        }
    }

    /// The unknowns of u_τ: the other Cartesian ones, or those of a frame behind the first.
    pub(super) fn tangential_unknowns(&self, space: &Discretization) -> Vec<Tangential> {
        let d = usize::from(self.dimension);
        let frame = space.frames.rows().find(|(node, _)| *node == self.node as usize);
        let unknown = |(k, tangent): (usize, &[f64])| {
            let (component, sign) = match &frame {
                Some((_, rows)) => {
                    let row = &rows[d * (k + 1)..];
                    let along: f64 = row.iter().zip(tangent).map(|(row, t)| row * t).sum();
                    (k + 1, along.signum())
                }
                None => {
                    let axis = tangent.iter().position(|component| *component != 0.0).unwrap_or(0);
                    (axis, tangent[axis])
                }
            };
            Tangential { unknown: (d * self.node as usize + component) as u32, sign }
        };
        self.tangents().enumerate().map(unknown).collect()
    }
}
