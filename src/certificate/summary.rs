//! A certificate in words.

use super::Certificate;

impl Certificate {
    /// What the certificate says, in a few plain sentences: folds, injectivity, distortion.
    pub fn summary(&self) -> String {
        let mut text = self.folds();
        text.push(' ');
        text.push_str(&self.injectivity());
        text.push_str(&format!(
            " Symmetric Dirichlet energy {} (an isometry has 1), singular values {} to {}, worst anisotropy {}.",
            number(self.symmetric_dirichlet),
            number(self.smallest_sigma),
            number(self.largest_sigma),
            number(self.worst_anisotropy),
        ));
        text
    }

    fn folds(&self) -> String {
        let all = count(self.elements, "triangle");
        if self.mirrored {
            return format!("{all}, every one inverted: the map as a whole is mirrored.");
        }
        format!(
            "{all}: {} inverted, {} degenerate.",
            self.inverted.len(),
            self.degenerate.len()
        )
    }

    fn windings(&self) -> String {
        let inside = self.overwound_inside;
        let beside = self.overwound.len() - inside;
        let vertices = |n: usize, place: &str| match n {
            0 => String::new(),
            1 => format!("1 {place} vertex"),
            _ => format!("{n} {place} vertices"),
        };
        let both = if inside > 0 && beside > 0 {
            " and "
        } else {
            ""
        };
        format!(
            "Nothing folds, but the triangles around {}{both}{} wind more than once.",
            vertices(inside, "inner"),
            vertices(beside, "boundary"),
        )
    }

    fn injectivity(&self) -> String {
        if self.elements == 0 {
            return "There is nothing to map.".into();
        }
        let crossings = match self.boundary_crossing_count {
            0 => String::new(),
            n => format!(
                " The boundary meets itself at {}{}.",
                if n >= super::COUNTED { "at least " } else { "" },
                count(n, "pair of edges"),
            ),
        };
        let verdict: &str = if self.globally_injective {
            "The map is injective (proven exactly)."
        } else if self.sheets.is_some_and(|s| s > 1) {
            "Parts of the map lie on each other."
        } else if self.locally_injective {
            "The map is injective around every point, but not as a whole."
        } else if !self.overwound.is_empty() {
            return format!("{}{crossings}", self.windings());
        } else if self.irregular_edges > 0 {
            "The triangles do not form an oriented surface."
        } else {
            "The map folds."
        };
        format!("{verdict}{crossings}")
    }
}

fn count(n: usize, what: &str) -> String {
    match n {
        1 => format!("1 {what}"),
        _ => match what.split_once(' ') {
            Some((head, tail)) => format!("{n} {head}s {tail}"),
            None => format!("{n} {what}s"),
        },
    }
}

/// Seven significant digits, in scientific notation where the plain one is unreadable.
pub(super) fn number(x: f64) -> String {
    if x.is_nan() {
        return "undefined".into();
    }
    if x.is_infinite() {
        return if x > 0.0 { "infinite" } else { "−infinite" }.into();
    }
    let size = x.abs();
    if size != 0.0 && !(1e-2..1e7).contains(&size) {
        return format!("{x:.3e}");
    }
    let digits = if size >= 1.0 {
        6 - (size.log10() as usize).min(6)
    } else {
        6
    };
    format!("{x:.digits$}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_well() {
        let shown = [1.0128375275, -0.5, 1234567.0, 3.2e9, 0.0, f64::INFINITY].map(number);
        let expected = [
            "1.012838",
            "-0.500000",
            "1234567",
            "3.200e9",
            "0.000000",
            "infinite",
        ];
        assert_eq!(shown, expected);
        assert_eq!(number(f64::NAN), "undefined");
        assert_eq!(count(2, "pair of edges"), "2 pairs of edges");
        assert_eq!(count(1, "pair of edges"), "1 pair of edges");
    }
}
