//! The rest shape of every element: its measure and the operator that takes positions to the
//! deformation gradient.

use crate::mesh::{SolidMesh, SurfaceMesh};
use crate::optim::BuildError;
use glam::{DMat2, DMat3, DVec3};

/// Rest shapes of simplices of dimension k, each in its own frame.
#[derive(Debug, Clone, Default)]
pub struct RestShape {
    /// k: 2 for triangles, 3 for tetrahedra.
    pub stretches: usize,
    /// Vertices, k+1 an element.
    pub vertices: Vec<u32>,
    /// Inverse of the edge matrix Dm = [e₁ … e_k] in the element's frame, k×k by columns:
    /// F = [x₁−x₀ … x_k−x₀] Dm⁻¹.
    pub inverse: Vec<f64>,
    /// Area or volume of each element.
    pub measure: Vec<f64>,
}

/// A triangle in space in its own frame (first edge, in-plane normal), e₁ = (l, 0) and e₂ = (x, y):
/// returns [l, x, y] and the area.
pub fn triangle_rest(a: DVec3, b: DVec3, c: DVec3) -> ([f64; 3], f64) {
    let (e1, e2) = (b - a, c - a);
    let length = e1.length();
    let normal = e1.cross(e2).length();
    ([length, e1.dot(e2) / length, normal / length], 0.5 * normal)
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

/// Are all of these signed measures negative?
fn oriented(measures: &[f64]) -> Result<bool, BuildError> {
    let mean = measures.iter().map(|v| v.abs()).sum::<f64>() / measures.len().max(1) as f64;
    let small = |v: &&f64| !(v.abs() > 1e-14 * mean && v.is_finite());
    if let Some(index) = measures.iter().position(|v| small(&v)) {
        let measure = measures[index];
        return Err(BuildError::DegenerateElement { index, measure });
    }
    let turned = measures.iter().all(|&v| v < 0.0);
    if let (false, Some(index)) = (turned, measures.iter().position(|&v| v < 0.0)) {
        let measure = measures[index];
        return Err(BuildError::InvertedRestElement { index, measure });
    }
    Ok(turned)
}

impl RestShape {
    /// Rest shapes of the triangles of a surface whose lengths are multiplied by `scale`.
    ///
    /// # Errors
    /// `DegenerateElement` names the first triangle of area below 1e-14 (for a surface scaled to unit
    /// area that is a relative bound; the paper's code has the same) or not finite.
    pub fn of_surface(mesh: &SurfaceMesh, scale: f64) -> Result<Self, BuildError> {
        Self::of_triangles(mesh, scale, 1e-14)
    }

    /// Rest shapes of the triangles of a surface as it is.
    ///
    /// # Errors
    /// `DegenerateElement` names the first triangle whose area is below 1e-14 of the mean.
    pub fn of_sheet(mesh: &SurfaceMesh) -> Result<Self, BuildError> {
        let mean = surface_area(mesh) / mesh.simplices.len().max(1) as f64;
        Self::of_triangles(mesh, 1.0, 1e-14 * mean)
    }

    fn of_triangles(mesh: &SurfaceMesh, scale: f64, least: f64) -> Result<Self, BuildError> {
        let mut rest = RestShape {
            stretches: 2,
            vertices: mesh.simplices.iter().flatten().copied().collect(),
            inverse: Vec::with_capacity(4 * mesh.simplices.len()),
            measure: Vec::with_capacity(mesh.simplices.len()),
        };
        for (index, &[a, b, c]) in mesh.simplices.iter().enumerate() {
            let [a, b, c] = [a, b, c].map(|v| mesh.positions[v as usize] * scale);
            let ([l, x, y], measure) = triangle_rest(a, b, c);
            if !(measure > 0.0 && measure >= least && measure.is_finite()) {
                return Err(BuildError::DegenerateElement { index, measure });
            }
            rest.inverse
                .extend([l.recip(), 0.0, -x / (l * y), y.recip()]);
            rest.measure.push(measure);
        }
        Ok(rest)
    }

    /// Rest shapes of triangles in the plane z = constant, in its x and y, and whether all of them were
    /// clockwise, and are turned (by an exchange of their last two vertices).
    ///
    /// # Errors
    /// `DegenerateElement` names the first triangle whose area is below 1e-14 of the mean, `InvertedRestElement`
    /// the first that is clockwise where others are not.
    pub fn of_plane(mesh: &SurfaceMesh) -> Result<(Self, bool), BuildError> {
        let edges = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|v| mesh.positions[v as usize].truncate());
            DMat2::from_cols(b - a, c - a)
        };
        let areas: Vec<f64> = mesh
            .simplices
            .iter()
            .map(|t| 0.5 * edges(t).determinant())
            .collect();
        let turned = oriented(&areas)?;
        let mut rest = RestShape {
            stretches: 2,
            vertices: Vec::with_capacity(3 * mesh.simplices.len()),
            inverse: Vec::with_capacity(4 * mesh.simplices.len()),
            measure: areas.iter().map(|a| a.abs()).collect(),
        };
        for &[a, b, c] in &mesh.simplices {
            let triangle = if turned { [a, c, b] } else { [a, b, c] };
            rest.vertices.extend(triangle);
            rest.inverse
                .extend(edges(&triangle).inverse().to_cols_array());
        }
        Ok((rest, turned))
    }

    /// Rest shapes of the tetrahedra of a solid, and whether all of them were inside out, and are turned
    /// (by an exchange of their last two vertices).
    ///
    /// # Errors
    /// `DegenerateElement` names the first tetrahedron whose volume is below 1e-14 of the mean,
    /// `InvertedRestElement` the first that is inside out where others are not.
    pub fn of_solid(mesh: &SolidMesh) -> Result<(Self, bool), BuildError> {
        let edges = |t: &[u32; 4]| {
            let [a, b, c, d] = t.map(|v| mesh.positions[v as usize]);
            DMat3::from_cols(b - a, c - a, d - a)
        };
        let volumes: Vec<f64> = mesh
            .simplices
            .iter()
            .map(|t| edges(t).determinant() / 6.0)
            .collect();
        let turned = oriented(&volumes)?;
        let mut rest = RestShape {
            stretches: 3,
            vertices: Vec::with_capacity(4 * mesh.simplices.len()),
            inverse: Vec::with_capacity(9 * mesh.simplices.len()),
            measure: volumes.iter().map(|v| v.abs()).collect(),
        };
        for &[a, b, c, d] in &mesh.simplices {
            let tetrahedron = if turned { [a, b, d, c] } else { [a, b, c, d] };
            rest.vertices.extend(tetrahedron);
            let inverse = edges(&tetrahedron).inverse();
            rest.inverse.extend(inverse.to_cols_array());
        }
        Ok((rest, turned))
    }

    /// The elements in another order: element `order[k]` becomes the k-th.
    pub fn reordered(&self, order: &[u32]) -> Self {
        let k = self.stretches;
        let pick = |width: usize| {
            order
                .iter()
                .flat_map(move |&e| e as usize * width..(e as usize + 1) * width)
        };
        Self {
            stretches: k,
            vertices: pick(k + 1).map(|i| self.vertices[i]).collect(),
            inverse: pick(k * k).map(|i| self.inverse[i]).collect(),
            measure: pick(1).map(|i| self.measure[i]).collect(),
        }
    }

    /// Number of elements.
    pub fn len(&self) -> usize {
        self.measure.len()
    }

    /// Are there no elements?
    pub fn is_empty(&self) -> bool {
        self.measure.is_empty()
    }

    /// The vertices of an element.
    pub fn simplex(&self, element: usize) -> &[u32] {
        let corners = self.stretches + 1;
        &self.vertices[element * corners..(element + 1) * corners]
    }

    /// Gradient of the hat function of corner `v` of an element, in its frame (row v of D_i), so that
    /// F = Σ_v x_v ⊗ g_v. Entries beyond k are 0.
    pub fn hat_gradient(&self, element: usize, v: usize) -> [f64; 3] {
        let k = self.stretches;
        let inverse = &self.inverse[element * k * k..(element + 1) * k * k];
        let row = |r: usize, column: usize| inverse[column * k + r];
        core::array::from_fn(|column| match v {
            _ if column >= k => 0.0,
            0 => -(0..k).map(|r| row(r, column)).sum::<f64>(),
            _ => row(v - 1, column),
        })
    }

    /// g_a·g_b of two corners of an element: the entry of D_iᵀD_i (5a).
    pub fn hat_product(&self, element: usize, a: usize, b: usize) -> f64 {
        let (a, b) = (self.hat_gradient(element, a), self.hat_gradient(element, b));
        a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
    }

    /// The diagonal of Σ A DᵀD (5a), by vertex.
    pub fn laplacian_diagonal(&self, vertices: usize) -> Vec<f64> {
        let mut diagonal = vec![0.0; vertices];
        for e in 0..self.len() {
            for (corner, &v) in self.simplex(e).iter().enumerate() {
                diagonal[v as usize] += self.measure[e] * self.hat_product(e, corner, corner);
            }
        }
        diagonal
    }

    /// Every pair of corners of every element, the diagonal included, as (corner, corner, element)
    /// with vertex indices.
    pub fn pairs(&self) -> impl Iterator<Item = (u32, u32, u32)> + Clone + '_ {
        let corners = self.stretches + 1;
        (0..self.len()).flat_map(move |e| {
            (0..corners).flat_map(move |a| {
                (0..=a).map(move |b| {
                    let simplex = self.simplex(e);
                    (simplex[a], simplex[b], e as u32)
                })
            })
        })
    }
}
