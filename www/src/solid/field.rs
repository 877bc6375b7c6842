//! What the colours of a solid mean.

use crate::colour::ZONE_COLOURS;

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
    /// Which zone of violated constraints it is in.
    Zone,
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
            "zone" => Some(Self::Zone),
            _ => None,
        }
    }

    /// What the legend says.
    pub fn caption(self) -> &'static str {
        match self {
            Self::Stretch => "stretch or squeeze, max(σ₁, 1/σ₃)",
            Self::Volume => "volume, relative to rest",
            Self::Stress => "von Mises stress ÷ stiffness",
            Self::Zone => "zones of violated constraints",
        }
    }

    /// The same of triangles in a plane.
    pub fn planar_caption(self) -> &'static str {
        match self {
            Self::Stretch => "stretch or squeeze, max(σ₁, 1/σ₂)",
            Self::Volume => "area, relative to rest",
            Self::Stress => "von Mises stress",
            Self::Zone => "zones of violated constraints",
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
            Self::Zone => &[(0.0, "none")],
        }
    }

    /// Which ramp it has on the graphics card.
    pub fn row(self) -> f32 {
        match self {
            Self::Stretch | Self::Stress => 0.0,
            Self::Volume => 1.0,
            Self::Zone => 2.0,
        }
    }

    /// Position on the ramp, logarithmic; above 1 where the ramp ends before the value.
    pub fn position(self, value: f64) -> f32 {
        let (low, high) = match self {
            Self::Stretch => (1.0, STRETCH),
            Self::Volume => (1.0 / VOLUME, VOLUME),
            Self::Stress => (STRESS[0], STRESS[1]),
            Self::Zone => return zone_colour(value as usize),
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

/// Where on their ramp the colour of a zone is, the first being 1; 0: of what is in none. Colours come again.
fn zone_colour(zone: usize) -> f32 {
    let colour = match zone.checked_sub(1) {
        Some(zone) => 1 + zone % (ZONE_COLOURS - 1),
        None => 0,
    };
    (colour as f32 + 0.5) / ZONE_COLOURS as f32
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
    fn neighbouring_zones_have_other_colours() {
        let at = |zone: usize| Field::Zone.position(zone as f64);
        assert!((0..40).all(|z| (0.0..1.0).contains(&at(z)) && at(z) != at(z + 1)));
        assert_eq!(at(1), at(ZONE_COLOURS));
        assert!(
            (1..40).all(|z| at(z) != at(0)),
            "the colour of none is its own"
        );
    }

    #[test]
    fn names_are_those_of_the_page() {
        assert_eq!(Field::from_name("stress"), Some(Field::Stress));
        assert_eq!(Field::from_name("colour"), None);
    }
}
