//! The certificate of a solid in words.

use super::SolidCertificate;
use crate::certificate::summary::number;
use crate::mesh::counted;

impl SolidCertificate {
    /// What the certificate says, in a few plain sentences: folds, injectivity, singular values.
    pub fn summary(&self) -> String {
        format!(
            "{} {} Singular values {} to {}.",
            self.folds(),
            self.injectivity(),
            number(self.smallest_sigma),
            number(self.largest_sigma),
        )
    }

    fn folds(&self) -> String {
        let all = tetrahedra(self.elements);
        if self.mirrored {
            return format!("{all}, every one inverted: the solid is mirrored.");
        }
        let flat = match self.flat_at_rest.len() {
            0 => String::new(),
            n => format!(", {n} without volume at rest"),
        };
        format!(
            "{all}: {} inverted, {} degenerate{flat} (exact).",
            self.inverted.len(),
            self.degenerate.len(),
        )
    }

    fn injectivity(&self) -> String {
        if self.elements == 0 {
            return "There is nothing to map.".into();
        }
        if self.locally_injective {
            return "The map is injective around every point, inside and on the boundary (proven exactly)."
                .into();
        }
        if !self.inverted.is_empty() || !self.degenerate.is_empty() {
            return "The map folds.".into();
        }
        let listed = |items: [(usize, &str); 3]| {
            let some = items.iter().filter(|(n, _)| *n > 0);
            let words: Vec<String> = some.map(|&(n, noun)| counted(n, noun)).collect();
            words.join(", ")
        };
        let irregular = listed([
            (self.irregular_faces.len(), "face"),
            (self.irregular_edges.len(), "edge"),
            (self.irregular_vertices.len(), "vertex"),
        ]);
        let inside = self.overwound_inside;
        let overwound = listed([
            (inside, "inner edge"),
            (self.overwound_edges.len() - inside, "boundary edge"),
            (self.overwound_vertices.len(), "boundary vertex"),
        ]);
        let mut sentences = Vec::new();
        if !overwound.is_empty() {
            sentences.push(format!(
                "No tetrahedron is inverted, but those around {overwound} overlap."
            ));
        }
        if !irregular.is_empty() {
            sentences.push(format!(
                "The tetrahedra form no manifold at {irregular}: nothing is claimed there."
            ));
        }
        if sentences.is_empty() {
            sentences.push("Nothing is claimed around tetrahedra without volume at rest.".into());
        }
        sentences.join(" ")
    }
}

fn tetrahedra(n: usize) -> String {
    match n {
        1 => "1 tetrahedron".into(),
        _ => format!("{n} tetrahedra"),
    }
}
