//! What the colours of a solid mean.

/// A quantity that has one value a tetrahedron.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Field {
    /// max(σ₁, 1/σ₃), by how much a length is stretched or squeezed at worst.
    #[default]
    Stretch,
    /// Volume over rest volume.
    Volume,
    /// Von Mises stress, relative to the stiffness of the material.
    Stress,
}

/// Stress at which the ramp begins and ends, relative.
const STRESS: [f64; 2] = [0.01, 10.0];

/// Stretch at which its ramp ends; it begins at 1. An elastic solid rarely goes further.
const STRETCH: f64 = 2.0;

/// Volume ratio at which its ramp ends; it begins at the inverse.
const VOLUME: f64 = 2.0;

impl Field {
    /// From the page's name for it.
    pub fn from_name(name: &str) -> Option<Self> {
        match name {
            "stretch" => Some(Self::Stretch),
            "volume" => Some(Self::Volume),
            "stress" => Some(Self::Stress),
            _ => None,
        }
    }

    /// What the legend says.
    pub fn caption(self) -> &'static str {
        match self {
            Self::Stretch => "stretch or squeeze, max(σ₁, 1/σ₃)",
            Self::Volume => "volume, relative to rest",
            Self::Stress => "von Mises stress ÷ stiffness",
        }
    }

    /// The same of triangles in a plane.
    pub fn planar_caption(self) -> &'static str {
        match self {
            Self::Stretch => "stretch or squeeze, max(σ₁, 1/σ₂)",
            Self::Volume => "area, relative to rest",
            Self::Stress => "von Mises stress",
        }
    }

    /// Ticks of the legend.
    pub fn ticks(self) -> &'static [(f64, &'static str)] {
        match self {
            Self::Stretch => &[(1.0, "1"), (1.2, "1.2"), (1.5, "1.5"), (2.0, "2+")],
            Self::Volume => &[
                (0.5, "½−"),
                (0.71, "0.7"),
                (1.0, "1"),
                (1.4, "1.4"),
                (2.0, "2+"),
            ],
            Self::Stress => &[
                (0.01, "1 %"),
                (0.1, "10 %"),
                (1.0, "100 %"),
                (10.0, "1000 %+"),
            ],
        }
    }

    /// Position on the ramp, logarithmic; above 1 where the ramp ends before the value.
    pub fn position(self, value: f64) -> f32 {
        let (low, high) = match self {
            Self::Stretch => (1.0, STRETCH),
            Self::Volume => (1.0 / VOLUME, VOLUME),
            Self::Stress => (STRESS[0], STRESS[1]),
        };
        let t = (value.max(f64::MIN_POSITIVE) / low).ln() / (high / low).ln();
        if t > 1.0 {
            return 2.0;
        }
        // Volumes end at both sides of their ramp.
        if t < 0.0 && self == Self::Volume {
            return 3.0;
        }
        t.max(0.0) as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_stand_on_the_ramp() {
        for field in [Field::Stretch, Field::Volume, Field::Stress] {
            let places: Vec<f32> = field.ticks().iter().map(|t| field.position(t.0)).collect();
            assert!(
                places.is_sorted() && places[0] == 0.0,
                "{field:?} {places:?}"
            );
            assert!((places.last().unwrap() - 1.0).abs() < 1e-6);
        }
    }

    #[test]
    fn what_lies_beyond_the_ramp_is_marked() {
        assert_eq!(Field::Stretch.position(9.0), 2.0);
        assert_eq!(Field::Volume.position(0.1), 3.0);
        assert_eq!(Field::Stress.position(0.0), 0.0);
        assert_eq!(Field::Volume.position(1.0), 0.5);
    }

    #[test]
    fn names_are_those_of_the_page() {
        assert_eq!(Field::from_name("stress"), Some(Field::Stress));
        assert_eq!(Field::from_name("colour"), None);
    }
}
