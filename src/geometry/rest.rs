//! The rest shape of every element: its measure and the operator that takes positions to the
//! deformation gradient.

use crate::mesh::SurfaceMesh;
use crate::optim::BuildError;
use glam::DVec3;

/// Rest shapes of triangles, each in its own frame (first edge, in-plane normal).
#[derive(Debug, Clone, Default)]
pub struct RestShape {
    /// Vertices of each element.
    pub simplices: Vec<[u32; 3]>,
    /// Inverse of the edge matrix [e₁ e₂] in the element's frame, by columns: F = [x₁−x₀ x₂−x₀] Dm⁻¹.
    pub inverse: Vec<[f64; 4]>,
    /// Area of each element.
    pub measure: Vec<f64>,
}

/// Edge lengths and area of a triangle in space, in its frame: e₁ = (l, 0), e₂ = (x, y).
///
/// The area is taken with the shortest edge as one side of the cross product, so that slivers keep
/// their relative accuracy.
pub fn triangle_rest(a: DVec3, b: DVec3, c: DVec3) -> ([f64; 3], f64) {
    let (e1, e2) = (b - a, c - a);
    let length = e1.length();
    let normal = e1.cross(e2).length();
    let y = normal / length;
    ([length, e1.dot(e2) / length, y], 0.5 * normal)
}

/// Area of the whole surface, in the square of its units.
pub fn surface_area(mesh: &SurfaceMesh) -> f64 {
    mesh.simplices
        .iter()
        .map(|&[a, b, c]| {
            let [a, b, c] = [a, b, c].map(|v| mesh.positions[v as usize]);
            0.5 * (b - a).cross(c - a).length()
        })
        .sum()
}

impl RestShape {
    /// Rest shapes of a surface whose lengths are multiplied by `scale`.
    ///
    /// # Errors
    /// `DegenerateElement` names the first triangle of area below 1e-14 (paper's code; the surface is
    /// scaled to unit area) or that is not finite.
    pub fn of_surface(mesh: &SurfaceMesh, scale: f64) -> Result<Self, BuildError> {
        let mut rest = RestShape {
            simplices: mesh.simplices.clone(),
            inverse: Vec::with_capacity(mesh.simplices.len()),
            measure: Vec::with_capacity(mesh.simplices.len()),
        };
        for (index, &[a, b, c]) in mesh.simplices.iter().enumerate() {
            let [a, b, c] = [a, b, c].map(|v| mesh.positions[v as usize] * scale);
            let ([l, x, y], measure) = triangle_rest(a, b, c);
            if !(measure >= 1e-14 && measure.is_finite()) {
                return Err(BuildError::DegenerateElement { index, measure });
            }
            rest.inverse.push([l.recip(), 0.0, -x / (l * y), y.recip()]);
            rest.measure.push(measure);
        }
        Ok(rest)
    }

    /// Number of elements.
    pub fn len(&self) -> usize {
        self.simplices.len()
    }

    /// Are there no elements?
    pub fn is_empty(&self) -> bool {
        self.simplices.is_empty()
    }

    /// Gradients of the three hat functions of an element, in its frame: row v of D_i, so that
    /// F = Σ_v x_v ⊗ g_v.
    pub fn hat_gradients(&self, element: usize) -> [[f64; 2]; 3] {
        let [a, b, c, d] = self.inverse[element];
        // rows of Dm⁻¹: g₁ = (a, c), g₂ = (b, d)
        [[-(a + b), -(c + d)], [a, c], [b, d]]
    }
}
