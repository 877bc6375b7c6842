//! What a step did, in the words and symbols of the papers.

use crate::history::{Fate, Moment, Part, PhaseKind};

/// One line of the inspector.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Explanation {
    /// Name of the phase.
    pub name: &'static str,
    /// What it computes, in the paper's symbols.
    pub symbol: &'static str,
    /// Where it is in the paper of the method.
    pub equation: &'static str,
    /// What `count` counts, if that is worth a word: singular, plural.
    pub unit: Option<[&'static str; 2]>,
    /// One sentence, with {element}, {elements} and {whole} to be filled in.
    sentence: &'static str,
}

/// What a mode calls things.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Nouns {
    /// One element.
    pub element: &'static str,
    /// Several.
    pub elements: &'static str,
    /// How far off an element's shape is, at worst.
    pub worst: &'static str,
    /// That, in symbols.
    pub formula: &'static str,
    /// The whole.
    pub whole: &'static str,
}

/// Words for surfaces and their maps.
pub const SURFACE: Nouns = Nouns {
    element: "triangle",
    elements: "triangles",
    worst: "worst distortion",
    formula: "max(σ₁, 1/σ₂)",
    whole: "map",
};

/// Words for solids.
pub const SOLID: Nouns = Nouns {
    element: "tetrahedron",
    elements: "tetrahedra",
    worst: "worst stretch",
    formula: "max(σ₁, 1/σ₃)",
    whole: "shape",
};

/// Words for triangles that are deformed in their plane.
pub const PLANAR: Nouns = Nouns {
    element: "triangle",
    elements: "triangles",
    worst: "worst stretch",
    formula: "max(σ₁, 1/σ₂)",
    whole: "shape",
};

impl Explanation {
    /// The sentence, in the words of a mode.
    pub fn sentence(&self, nouns: Nouns) -> String {
        self.sentence
            .replace("{elements}", nouns.elements)
            .replace("{element}", nouns.element)
            .replace("{whole}", nouns.whole)
    }
}

/// A method's name as people write it.
pub fn method_name(method: &str) -> &str {
    match method {
        "wrapd" => "WRAPD",
        "r-admm" => "R-ADMM",
        "w-admm" => "W-ADMM",
        "admm-pd" => "ADMM-PD",
        "l-bfgs" => "L-BFGS",
        "cm" => "CM",
        "wrapd+cm" => "WRAPD+CM",
        "slim" => "SLIM",
        "newton" => "Newton",
        "wrapd+newton" => "WRAPD+Newton",
        "lim" => "LIM",
        "lim-frozen" => "LIM, frozen",
        "lim-off" => "LIM, free",
        "lim-frozen-off" => "LIM, frozen, free",
        "gini" => "GINI",
        "gini+cm" => "GINI+CM",
        "arap" => "ARAP",
        "lscm" => "LSCM",
        "harmonic" => "Harmonic",
        "tutte" => "Tutte",
        other => other,
    }
}

/// Where a method comes from.
pub fn citation(method: &str) -> &'static str {
    match method {
        "wrapd" | "r-admm" | "w-admm" | "wrapd+cm" | "wrapd+newton" => "Brown & Narain 2021",
        "cm" => "Shtengel et al. 2017",
        "slim" => "Rabinovich et al. 2017",
        "newton" => "Smith et al. 2019",
        "admm-pd" => "Overby et al. 2017",
        "l-bfgs" => "Liu et al. 2017",
        "lim" => "Schüller et al. 2013",
        "lim-frozen" | "lim-off" | "lim-frozen-off" => "Schüller 2013",
        "gini" | "gini+cm" => "Overby et al. 2021",
        "arap" => "Liu et al. 2008",
        "lscm" => "Lévy et al. 2002",
        "harmonic" => "Eck et al. 1995",
        "tutte" => "Tutte 1963",
        _ => "",
    }
}

/// The method that makes an iteration of `method`: of the two in a hybrid the second, once the first has ended.
pub fn stage(method: &str, iteration: u32, switched_at: Option<u32>) -> &str {
    let second = switched_at.is_some_and(|last| iteration > last);
    match method.split_once('+') {
        Some((_, then)) if second => then,
        Some((first, _)) => first,
        None => method,
    }
}

/// When a hybrid switched, in one sentence; nothing of other methods.
pub fn handover(method: &str, switched_at: Option<u32>) -> Option<String> {
    let (first, then) = method.split_once('+')?;
    let (first, then) = (method_name(first), method_name(then));
    Some(match switched_at {
        Some(1) => format!("{first} made iteration 1; {then} goes on from there."),
        Some(last) => format!("{first} made iterations 1 to {last}; {then} goes on from there."),
        None if method == "gini+cm" => {
            format!("{first} for now; {then} takes over when the map is injective and has settled.")
        }
        None => {
            format!("{first} for now; {then} takes over at the first iterate without inversions.")
        }
    })
}

/// What a phase of a second-order method's iteration does.
fn second_order(method: &str, kind: PhaseKind) -> Explanation {
    match kind {
        PhaseKind::Local => match method {
            "cm" => Explanation {
                name: "Majorize",
                symbol: "Hᵢ ← convex part of ∂²ψᵢ",
                equation: "Shtengel 2017",
                unit: None,
                sentence: "Every {element} on its own gives the Hessian of a convex function that lies above its energy and touches it here.",
            },
            "slim" => Explanation {
                name: "Reweight",
                symbol: "Wᵢ from σ(Fᵢ), Rᵢ",
                equation: "Rabinovich 2017",
                unit: None,
                sentence: "Every {element} on its own gives the weights with which ½‖W(F − R)‖² has the gradient of its energy.",
            },
            _ => Explanation {
                name: "Hessians",
                symbol: "Hᵢ ← ∂²ψᵢ, made convex",
                equation: "Smith 2019",
                unit: None,
                sentence: "Every {element} on its own gives the Hessian of its energy, with its negative eigenvalues, which have closed forms, set to zero; near the minimum they are kept.",
            },
        },
        PhaseKind::Reweight => Explanation {
            name: "Factor",
            symbol: "H = L Lᵀ",
            equation: "Cholesky",
            unit: Some(["factor", "factors"]),
            sentence: "The matrix of all vertices is factored anew in every step; its pattern never changes.",
        },
        PhaseKind::Global => Explanation {
            name: "Direction",
            symbol: "H D = −g",
            equation: "Newton",
            unit: Some(["solve", "solves"]),
            sentence: "All vertices together: one linear solve with that factor gives the direction, from the gradient g.",
        },
        PhaseKind::Evaluate => Explanation {
            name: "Line search",
            symbol: "X ← X + αD",
            equation: "Smith & Schaefer 2015",
            unit: Some(["trial", "trials"]),
            sentence: "The step is cut before the first {element} would invert, then shortened until the energy falls enough.",
        },
    }
}

/// What a phase of a locally injective mapping's iteration does.
fn locally_injective(method: &str, kind: PhaseKind) -> Explanation {
    let barrier = !method.ends_with("-off");
    match kind {
        PhaseKind::Local if method.starts_with("lim-frozen") => Explanation {
            name: "Hessians",
            symbol: "Hᵢ ← ∂²ψᵢ + β ∂²φᵢ, R kept",
            equation: "appendix (2), (13)",
            unit: None,
            sentence: "Every {element} on its own gives the second derivatives of its energy, as if its rotation stayed, and of its barrier.",
        },
        PhaseKind::Local => Explanation {
            name: "Hessians",
            symbol: "Hᵢ ← ∂²(ψᵢ + βφᵢ), convex",
            equation: "Smith 2019",
            unit: None,
            sentence: "Every {element} on its own gives the second derivatives of its energy and its barrier, without what is negative in them, or with a part of it.",
        },
        PhaseKind::Reweight => Explanation {
            name: "Factor",
            symbol: "H + μI = L Lᵀ",
            equation: "Levenberg–Marquardt",
            unit: Some(["factor", "factors"]),
            sentence: "The matrix of all vertices is factored; where that fails it is not positive definite, and μ grows until it is.",
        },
        PhaseKind::Global => Explanation {
            name: "Direction",
            symbol: "(H + μI) p = −g",
            equation: "(5), (6)",
            unit: Some(["solve", "solves"]),
            sentence: "All vertices together: one linear solve. Handles are led the part 1/(1 + μ²) of the way to their targets.",
        },
        PhaseKind::Evaluate => Explanation {
            name: "Line search",
            symbol: "v ← v + σp",
            equation: if barrier { "(2), (3)" } else { "Armijo" },
            unit: Some(["trial", "trials"]),
            sentence: if barrier {
                "The step ends before the first {element} would lose its last bit of area or volume; it is halved until the objective falls and nothing is inverted, which is checked exactly."
            } else {
                "The step is halved until the objective falls; without the barrier nothing keeps the {elements} from inverting."
            },
        },
    }
}

/// What a phase of an untangling's step does: its last phase is the polisher.
fn untangling(kind: PhaseKind) -> Explanation {
    match kind {
        PhaseKind::Local => Explanation {
            name: "Local step",
            symbol: "Zᵢ ← prox(Fᵢ + Uᵢ)",
            equation: "(5a), (5b)",
            unit: None,
            sentence: "Every {element} on its own trades its energy against staying near its Jacobian, as the primary solver has it; it may choose to stay inverted.",
        },
        PhaseKind::Global => Explanation {
            name: "Quadratic problem",
            symbol: "minimise with cᵢ ≥ η, linear",
            equation: "(6), (10)",
            unit: Some(["iteration", "iterations"]),
            sentence: "All vertices together go where the {elements} want them, under linear constraints that keep the measure of those in trouble: by its dual, one solve with the factored Laplacian an iteration.",
        },
        PhaseKind::Reweight => Explanation {
            name: "Reweight",
            symbol: "nothing",
            equation: "–",
            unit: None,
            sentence: "The weights of this method stay as they are.",
        },
        PhaseKind::Evaluate => Explanation {
            name: "Polisher",
            symbol: "dX ← −Jᵀ(JJᵀ + γD)⁻¹ h",
            equation: "(12), (13)",
            unit: Some(["iteration", "iterations"]),
            sentence: "Every {element} below its least measure η joins the constraints; those that share vertices are a zone, and every zone on its own takes a step of Levenberg and Marquardt’s method towards η.",
        },
    }
}

/// What a phase of a method's iteration does. Equation numbers are those of the WRAPD paper
/// (Brown & Narain 2021) unless a name says otherwise.
pub fn explain(method: &str, kind: PhaseKind) -> Explanation {
    if matches!(method, "cm" | "slim" | "newton") {
        return second_order(method, kind);
    }
    if method == "gini" {
        return untangling(kind);
    }
    if method.starts_with("lim") {
        return locally_injective(method, kind);
    }
    let rotation_aware = matches!(method, "wrapd" | "r-admm");
    match (method, kind) {
        ("arap", PhaseKind::Local) => Explanation {
            name: "Local",
            symbol: "Rᵢ ← rotation of Fᵢ",
            equation: "Liu 2008",
            unit: None,
            sentence: "Every {element} on its own finds the rotation nearest to its Jacobian.",
        },
        ("arap", PhaseKind::Global) => Explanation {
            name: "Global",
            symbol: "A X = B(R)",
            equation: "Liu 2008",
            unit: Some(["solve", "solves"]),
            sentence: "One linear solve with a factor made once puts the vertices where the rotated {elements} want them.",
        },
        ("lscm" | "harmonic" | "tutte", PhaseKind::Global | PhaseKind::Local) => Explanation {
            name: "Solve",
            symbol: "A X = B",
            equation: "direct",
            unit: Some(["solve", "solves"]),
            sentence: "The whole {whole} is the solution of one sparse linear system; there is nothing to iterate.",
        },
        ("l-bfgs", PhaseKind::Global) => Explanation {
            name: "Global",
            symbol: "D ← −H ∇E(X)",
            equation: "Liu 2017",
            unit: Some(["direction", "directions"]),
            sentence: "All vertices together: a quasi-Newton direction, begun from the factored Laplacian.",
        },
        ("l-bfgs", PhaseKind::Evaluate) => Explanation {
            name: "Line search",
            symbol: "E(X + αD) low enough",
            equation: "Armijo",
            unit: Some(["trial", "trials"]),
            sentence: "Energy and gradient of all {elements} at full step; half of it, and so on, until the energy falls.",
        },
        (_, PhaseKind::Local) if rotation_aware => Explanation {
            name: "Local",
            symbol: "Zᵢ ← prox(sym Fᵢ + Uᵢ)",
            equation: "(10b), (10c)",
            unit: None,
            sentence: "Every {element} on its own trades its energy against staying near its own stretch, by singular values; then the multipliers Uᵢ grow by what is left between them.",
        },
        (_, PhaseKind::Local) => Explanation {
            name: "Local",
            symbol: "Zᵢ ← prox(Fᵢ + Uᵢ)",
            equation: "(4b), (4c)",
            unit: None,
            sentence: "Every {element} on its own trades its energy against staying near its Jacobian, rotation included; then the multipliers Uᵢ grow by what is left between them.",
        },
        (_, PhaseKind::Global) if rotation_aware => Explanation {
            name: "Global",
            symbol: "X ← argmin ½Σwᵢ²‖sym Fᵢ − Pᵢ‖²",
            equation: "(11), stop (17)",
            unit: Some(["L-BFGS", "L-BFGS"]),
            sentence: "All vertices move together: L-BFGS started from the factored Laplacian, as long as each of its iterations gains more than the local step did.",
        },
        (_, PhaseKind::Global) => Explanation {
            name: "Global",
            symbol: "A X = B",
            equation: "(4a), (5)",
            unit: Some(["solve", "solves"]),
            sentence: "All vertices move together: one linear solve with the factored weighted Laplacian.",
        },
        (_, PhaseKind::Reweight) => Explanation {
            name: "Reweight",
            symbol: "wᵢ² ← clamp(Aᵢ Kₑ(σ))",
            equation: "(20)–(24)",
            unit: Some(["factor", "factors"]),
            sentence: "Some weight was off by more than 1.5: every {element} takes its present stiffness as its weight, and the Laplacian is factored anew.",
        },
        (_, PhaseKind::Evaluate) => Explanation {
            name: "Evaluate",
            symbol: "E(X), inverted",
            equation: "(1a)",
            unit: None,
            sentence: "Energy, gradient and inverted {elements} of the new iterate decide whether to go on.",
        },
    }
}

/// The name of a part of a step of an untangling.
pub fn moment_name(moment: &Moment) -> String {
    match moment.part {
        Part::Start => "start".into(),
        Part::Local => "local step".into(),
        Part::Quadratic => format!(
            "quadratic problem, iteration {} of {}",
            moment.polish[0], moment.solves
        ),
        Part::Polish => format!("polisher {} of {}", moment.polish[0], moment.polish[1]),
        Part::Outcome => match moment.fate {
            Fate::Reached => "handed out",
            Fate::Partway => "x went a part of the way",
            Fate::Stays => "not handed out",
        }
        .into(),
    }
}

/// What the energy of the run counts, with the value of an isometry.
pub fn energy_caption(energy: &str, solid: bool) -> &'static str {
    if energy.starts_with("lim:") {
        "deformation energy (undeformed: 0)"
    } else if solid {
        match energy {
            "symmetric-dirichlet" => "relative energy (undeformed: 2)",
            "dirichlet" => "relative energy (undeformed: 1.5)",
            _ => "relative energy (undeformed: 0)",
        }
    } else if energy == "arap" {
        "energy (isometry: 0)"
    } else {
        "energy (isometry: 1)"
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_phase_of_every_method_is_explained() {
        for method in [
            "wrapd",
            "r-admm",
            "w-admm",
            "admm-pd",
            "l-bfgs",
            "cm",
            "wrapd+cm",
            "gini+cm",
            "slim",
            "newton",
            "wrapd+newton",
            "lim",
            "lim-frozen",
            "lim-off",
            "lim-frozen-off",
            "gini",
            "arap",
            "lscm",
            "harmonic",
            "tutte",
        ] {
            assert!(!citation(method).is_empty());
            for kind in [
                PhaseKind::Local,
                PhaseKind::Global,
                PhaseKind::Reweight,
                PhaseKind::Evaluate,
            ] {
                let e = explain(method, kind);
                for nouns in [SURFACE, SOLID, PLANAR] {
                    let sentence = e.sentence(nouns);
                    assert!(
                        sentence.ends_with('.') && !sentence.contains('{'),
                        "{sentence}"
                    );
                }
                assert!(!e.symbol.is_empty() && !e.equation.is_empty());
            }
        }
    }

    #[test]
    fn a_hybrid_is_explained_by_the_stage_it_is_in() {
        assert_eq!(stage("wrapd+cm", 4, None), "wrapd");
        assert_eq!(stage("wrapd+cm", 4, Some(4)), "wrapd");
        assert_eq!(stage("wrapd+cm", 5, Some(4)), "cm");
        assert_eq!(stage("cm", 5, None), "cm");
        let words = handover("wrapd+newton", Some(7)).unwrap_or_default();
        assert!(words.contains("1 to 7; Newton goes on"), "{words}");
        assert!(handover("wrapd+cm", None).is_some_and(|words| words.contains("CM takes over")));
        assert!(handover("wrapd+cm", Some(1)).is_some_and(|words| words.contains("iteration 1;")));
        assert_eq!(handover("wrapd", None), None);
    }

    #[test]
    fn sentences_speak_of_what_is_on_the_bench() {
        let local = explain("wrapd", PhaseKind::Local);
        assert!(local.sentence(SURFACE).contains("Every triangle"));
        assert!(local.sentence(SOLID).contains("Every tetrahedron"));
    }

    #[test]
    fn rotation_awareness_changes_the_words() {
        assert_eq!(
            explain("wrapd", PhaseKind::Global).equation,
            "(11), stop (17)"
        );
        assert_eq!(explain("w-admm", PhaseKind::Global).equation, "(4a), (5)");
    }
}
