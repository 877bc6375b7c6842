//! What the implicit shapes look like: a hand, an octopus, a pair of letters. About two units across.

use super::implicit::{Ball, Implicit};
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// An open right hand, fingers up, palm towards +z, with a bit of forearm.
pub(super) fn hand(least_radius: f64) -> Implicit {
    let ball = |x, y, z, radius| (DVec3::new(x, y, z), radius);
    let mut hand = Implicit::new(least_radius, 0.0);
    hand.join(
        0.0,
        &[&[
            ball(-0.07, -1.06, 0.0, 0.165),
            ball(-0.06, -0.62, 0.0, 0.135),
        ]],
    );
    hand.join(
        0.12,
        &[&[ball(0.08, -1.06, 0.0, 0.165), ball(0.07, -0.62, 0.0, 0.135)]],
    );
    // The palm: one cone for each metacarpal, hollowed a little by setting the outer ones forward.
    hand.join(
        0.16,
        &[
            &[
                ball(-0.09, -0.50, 0.01, 0.14),
                ball(-0.27, 0.14, 0.01, 0.115),
            ],
            &[
                ball(-0.03, -0.50, 0.0, 0.14),
                ball(-0.09, 0.19, -0.01, 0.12),
            ],
            &[ball(0.03, -0.50, 0.0, 0.14), ball(0.09, 0.16, -0.01, 0.115)],
            &[ball(0.09, -0.50, 0.01, 0.13), ball(0.26, 0.07, 0.01, 0.105)],
        ],
    );
    // The ball of the thumb and the thumb.
    hand.join(
        0.14,
        &[&[
            ball(-0.13, -0.38, 0.06, 0.14),
            ball(-0.37, -0.16, 0.10, 0.118),
            ball(-0.53, 0.04, 0.12, 0.098),
            ball(-0.62, 0.22, 0.12, 0.080),
        ]],
    );
    // Knuckle, tilt to the side, length, radius.
    let fingers = [
        (ball(-0.285, 0.16, 0.01, 0.0), -13.0, 0.66, 0.092),
        (ball(-0.095, 0.22, -0.01, 0.0), -3.5, 0.74, 0.095),
        (ball(0.095, 0.19, -0.01, 0.0), 6.0, 0.68, 0.090),
        (ball(0.275, 0.09, 0.01, 0.0), 17.0, 0.53, 0.085),
    ];
    for ((knuckle, _), tilt, length, radius) in fingers {
        let (sin, cos) = f64::to_radians(tilt).sin_cos();
        let mut at = knuckle;
        let mut chain = vec![(at, 1.06 * radius)];
        // Three bones, each bent further towards the palm.
        for (share, bend, thinner) in [(0.46, 4.0, 0.97), (0.30, 12.0, 0.88), (0.24, 22.0, 0.76)] {
            let (forward, up) = f64::to_radians(bend).sin_cos();
            at += DVec3::new(sin * up, cos * up, forward) * (share * length);
            chain.push((at, thinner * radius));
        }
        hand.join(0.045, &[&chain]);
    }
    hand
}

/// An octopus: a head with two eyes on eight tapering arms that reach out and curl up.
pub(super) fn creature(least_radius: f64) -> Implicit {
    const ARMS: usize = 8;
    const BONES: usize = 12;
    let mut creature = Implicit::new(least_radius, 0.0);
    let head: [Ball; 3] = [
        (DVec3::new(0.0, 0.02, 0.0), 0.27),
        (DVec3::new(0.0, 0.30, 0.0), 0.29),
        (DVec3::new(0.0, 0.66, -0.07), 0.37),
    ];
    creature.join(0.0, &[&head]);
    let arms: Vec<Vec<Ball>> = (0..ARMS)
        .map(|arm| {
            let angle = TAU * (arm as f64 + 0.5) / ARMS as f64;
            // All sweep the same way, so that they keep apart; every other one is shorter.
            let reach = [0.92, 0.80][arm % 2];
            (0..=BONES)
                .map(|bone| {
                    let s = bone as f64 / BONES as f64;
                    let drop = (1.0 - s / 0.5).max(0.0);
                    let curl = (s - 0.62).max(0.0) / 0.38;
                    let (sin, cos) = (angle + 0.24 * (1.6 * PI * s).sin()).sin_cos();
                    let out = 0.14 + reach * s * (1.0 - 0.16 * curl);
                    let up = -0.36 + 0.40 * drop * drop + 0.26 * curl * curl;
                    (DVec3::new(out * sin, up, out * cos), 0.128 - 0.066 * s)
                })
                .collect()
        })
        .collect();
    for arm in &arms {
        creature.join(0.06, &[arm]);
    }
    let eye = |x| [(DVec3::new(x, 0.38, 0.235), 0.11)];
    creature.join(0.06, &[&eye(-0.155), &eye(0.155)]);
    creature
}

/// The letters ff in one piece: slanted round strokes with a common crossbar, the second one taller.
pub(super) fn letters(least_radius: f64) -> Implicit {
    const STROKE: f64 = 0.115;
    const SLANT: f64 = 0.16;
    const TURN: usize = 10;
    let ball = |x: f64, y: f64| (DVec3::new(x + SLANT * y, y, 0.0), STROKE);
    let mut letters = Implicit::new(least_radius, 0.04);
    let mut f = |x: f64, top: f64, hook: f64| {
        let mut stem = vec![ball(x, -0.88)];
        // The hook: from the stem over the top and a little down again.
        stem.extend((0..=TURN).map(|step| {
            let (sin, cos) = (0.86 * PI * step as f64 / TURN as f64).sin_cos();
            ball(x + hook * (1.0 - cos), top - hook + hook * sin)
        }));
        letters.join(0.0, &[&stem]);
    };
    f(-0.46, 0.64, 0.18);
    f(0.26, 0.88, 0.25);
    letters.join(0.06, &[&[ball(-0.78, 0.14), ball(0.60, 0.14)]]);
    letters
}
