//! Colours: the distortion ramp, the solvers' colours, the two themes.

/// An sRGB colour, 0–255 a channel.
pub type Rgb = [u8; 3];

/// Distortion at which the ramp ends; larger values are drawn in its last colour and marked.
pub const DISTORTION_END: f64 = 4.0;

/// Vermilion of inverted triangles (Okabe & Ito 2008), the same in both themes.
pub const VERMILION: Rgb = [213, 94, 0];

/// The cividis colour map (Nuñez, Anderton & Renslow 2018), `t` in [0, 1], by the polynomial of
/// d3-scale-chromatic.
pub fn cividis(t: f64) -> Rgb {
    let t = t.clamp(0.0, 1.0);
    let red = -4.54 - t * (35.34 - t * (2381.73 - t * (6402.7 - t * (7024.72 - t * 2710.57))));
    let green = 32.49 + t * (170.73 + t * (52.82 - t * (131.46 - t * (176.58 - t * 67.37))));
    let blue = 81.24 + t * (442.36 - t * (2482.43 - t * (6167.24 - t * (6614.94 - t * 2475.67))));
    [red, green, blue].map(|c| c.round().clamp(0.0, 255.0) as u8)
}

/// Position on the ramp of a distortion in [1, ∞): logarithmic, 0 at 1 and 1 at [`DISTORTION_END`].
pub fn ramp_position(distortion: f64) -> f64 {
    (distortion.max(1.0).ln() / DISTORTION_END.ln()).min(1.0)
}

/// A diverging map, purple through a light grey to green (readable with any colour vision, and apart
/// from the vermilion of what is inverted): `t` in [0, 1], the middle at one half.
pub fn diverging(t: f64) -> Rgb {
    const STOPS: [[f64; 3]; 7] = [
        [84.0, 39.0, 136.0],
        [128.0, 98.0, 176.0],
        [189.0, 174.0, 214.0],
        [240.0, 240.0, 238.0],
        [168.0, 214.0, 170.0],
        [74.0, 160.0, 96.0],
        [0.0, 84.0, 44.0],
    ];
    let x = t.clamp(0.0, 1.0) * (STOPS.len() - 1) as f64;
    let i = (x as usize).min(STOPS.len() - 2);
    let part = x - i as f64;
    std::array::from_fn(|k| (STOPS[i][k] + part * (STOPS[i + 1][k] - STOPS[i][k])).round() as u8)
}

/// How many colours [`zones`] has.
pub const ZONE_COLOURS: usize = 9;

/// A neutral grey for what is in no zone, then eight colours to tell zones apart, none of them like the vermilion of what
/// is inverted (from Okabe & Ito 2008 and lighter and darker ones): `t` in [0, 1].
pub fn zones(t: f64) -> Rgb {
    const COLOURS: [Rgb; ZONE_COLOURS] = [
        [206, 209, 212],
        [0, 114, 178],
        [240, 228, 66],
        [0, 158, 115],
        [204, 121, 167],
        [86, 180, 233],
        [120, 94, 160],
        [150, 160, 60],
        [20, 80, 90],
    ];
    COLOURS[((t.clamp(0.0, 1.0) * ZONE_COLOURS as f64) as usize).min(ZONE_COLOURS - 1)]
}

/// The ramps as `n` RGBA texels each, for the GPU: [`cividis`], [`diverging`], [`zones`], and the last again.
pub fn ramp_texels(n: usize) -> Vec<u8> {
    let last = n.saturating_sub(1).max(1) as f64;
    [cividis, diverging, zones, zones]
        .iter()
        .flat_map(|ramp| {
            (0..n).flat_map(move |i| {
                let [r, g, b] = ramp(i as f64 / last);
                [r, g, b, 255]
            })
        })
        .collect()
}

/// How a solver's curve is drawn, everywhere and always.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CurveStyle {
    /// Colour on a light ground.
    pub light: Rgb,
    /// Colour on a dark ground.
    pub dark: Rgb,
    /// Lengths of dash and gap in points; empty for a solid line.
    pub dash: &'static [f32],
}

/// The style of a method's curve (kebab-case name as in the options).
pub fn curve_style(method: &str) -> CurveStyle {
    let (light, dark, dash): (Rgb, Rgb, &[f32]) = match method {
        "wrapd" => ([0, 114, 178], [86, 180, 233], &[]),
        "wrapd+cm" => ([16, 42, 112], [138, 152, 255], &[13.0, 3.0]),
        "cm" => ([0, 132, 96], [0, 190, 142], &[5.0, 2.0]),
        "slim" => (
            [204, 112, 0],
            [240, 165, 30],
            &[7.0, 2.5, 1.5, 2.5, 1.5, 2.5],
        ),
        "newton" => ([28, 30, 33], [230, 231, 232], &[10.0, 3.0]),
        "wrapd+newton" => ([70, 40, 120], [184, 160, 250], &[13.0, 3.0, 2.0, 3.0]),
        "r-admm" => ([24, 122, 140], [96, 200, 216], &[7.0, 3.0]),
        "w-admm" => ([122, 116, 16], [206, 198, 84], &[3.0, 3.0]),
        "admm-pd" => ([110, 114, 120], [160, 165, 172], &[1.5, 3.0]),
        "l-bfgs" => ([126, 96, 62], [196, 166, 128], &[9.0, 3.0, 3.0, 3.0]),
        "lim" => ([118, 52, 160], [190, 140, 236], &[]),
        "lim-frozen" => ([118, 52, 160], [190, 140, 236], &[8.0, 3.0]),
        "lim-off" => ([118, 52, 160], [190, 140, 236], &[2.0, 3.0]),
        "lim-frozen-off" => ([118, 52, 160], [190, 140, 236], &[8.0, 3.0, 2.0, 3.0]),
        "gini" => ([134, 58, 22], [226, 148, 104], &[]),
        "gini+cm" => ([134, 58, 22], [226, 148, 104], &[13.0, 3.0]),
        "arap" => ([164, 76, 130], [204, 121, 167], &[7.0, 3.0, 1.5, 3.0]),
        _ => ([90, 94, 100], [180, 184, 190], &[]),
    };
    CurveStyle { light, dark, dash }
}

/// The colours of a theme.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Theme {
    /// Whether the ground is dark.
    pub dark: bool,
    /// The ground.
    pub ground: Rgb,
    /// Body text.
    pub ink: Rgb,
    /// Captions, axes.
    pub quiet: Rgb,
    /// Hairlines between regions.
    pub line: Rgb,
    /// The one accent.
    pub accent: Rgb,
    /// The light square of the checkerboard.
    pub check_light: Rgb,
    /// The dark square of the checkerboard.
    pub check_dark: Rgb,
    /// A solid's skin.
    pub skin: Rgb,
    /// Outline of inverted triangles, boundary of the map.
    pub outline: Rgb,
    /// Text and marks that warn.
    pub warn: Rgb,
}

/// The light theme: ink on paper.
pub const LIGHT: Theme = Theme {
    dark: false,
    ground: [252, 252, 250],
    ink: [28, 30, 33],
    quiet: [98, 102, 108],
    line: [222, 223, 221],
    accent: [0, 99, 155],
    check_light: [235, 235, 232],
    check_dark: [205, 206, 205],
    skin: [196, 204, 214],
    outline: [30, 18, 8],
    warn: [173, 62, 0],
};

/// The dark theme: for a dim room or a projector.
pub const DARK: Theme = Theme {
    dark: true,
    ground: [19, 21, 24],
    ink: [230, 231, 232],
    quiet: [154, 159, 166],
    line: [46, 49, 54],
    accent: [102, 187, 238],
    check_light: [178, 180, 182],
    check_dark: [146, 149, 152],
    skin: [150, 164, 182],
    outline: [10, 6, 3],
    warn: [255, 140, 66],
};

/// The contrast ratio of two colours by WCAG 2.
pub fn contrast(a: Rgb, b: Rgb) -> f64 {
    let luminance = |c: Rgb| {
        let [r, g, b] = c.map(|v| {
            let v = f64::from(v) / 255.0;
            if v <= 0.04045 {
                v / 12.92
            } else {
                ((v + 0.055) / 1.055).powf(2.4)
            }
        });
        0.2126 * r + 0.7152 * g + 0.0722 * b
    };
    let (a, b) = (luminance(a), luminance(b));
    (a.max(b) + 0.05) / (a.min(b) + 0.05)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cividis_has_its_published_ends() {
        for (t, expected) in [(0.0, [0, 32, 81]), (1.0, [253, 234, 69])] {
            for (got, want) in cividis(t).into_iter().zip(expected) {
                assert!(got.abs_diff(want) <= 1, "cividis({t}) = {:?}", cividis(t));
            }
        }
    }

    #[test]
    fn the_ramp_grows_lighter() {
        let grey = |c: Rgb| contrast(c, [0, 0, 0]);
        assert!(
            (1..=64).all(
                |i| grey(cividis(f64::from(i) / 64.0)) > grey(cividis(f64::from(i - 1) / 64.0))
            )
        );
    }

    #[test]
    fn the_ramp_is_logarithmic_and_clamped() {
        assert_eq!(ramp_position(1.0), 0.0);
        assert!((ramp_position(2.0) - 0.5).abs() < 1e-12);
        assert_eq!(ramp_position(f64::INFINITY), 1.0);
        assert_eq!(ramp_texels(256).len(), 4096);
    }

    #[test]
    fn text_is_readable_on_its_ground() {
        for theme in [LIGHT, DARK] {
            for text in [theme.ink, theme.quiet, theme.accent, theme.warn] {
                assert!(
                    contrast(text, theme.ground) >= 4.5,
                    "{text:?} on {:?}",
                    theme.ground
                );
            }
        }
    }

    #[test]
    fn solver_curves_are_visible_and_distinct() {
        let methods = [
            "wrapd",
            "wrapd+cm",
            "cm",
            "slim",
            "newton",
            "wrapd+newton",
            "r-admm",
            "w-admm",
            "admm-pd",
            "l-bfgs",
            "arap",
        ];
        for (i, a) in methods.iter().enumerate() {
            assert!(contrast(curve_style(a).light, LIGHT.ground) >= 3.0, "{a}");
            assert!(contrast(curve_style(a).dark, DARK.ground) >= 3.0, "{a}");
            for b in &methods[..i] {
                assert_ne!(curve_style(a).light, curve_style(b).light);
                assert_ne!(curve_style(a).dash, curve_style(b).dash, "{a} {b}");
            }
        }
    }
}
