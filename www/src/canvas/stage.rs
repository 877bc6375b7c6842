//! The benches of the page's modes, one of which is on show.

use super::bench::Bench;

/// A mode of the page.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Mode {
    /// Surfaces and their maps.
    #[default]
    Flatten,
    /// Solids and their handles.
    Deform,
    /// Several solvers on one surface.
    Compare,
    /// Bodies that are folded, and no more in the end.
    Untangle,
}

impl Mode {
    /// From the page's name for it.
    pub fn from_name(name: &str) -> Option<Self> {
        match name {
            "flatten" => Some(Self::Flatten),
            "deform" => Some(Self::Deform),
            "compare" => Some(Self::Compare),
            "untangle" => Some(Self::Untangle),
            _ => None,
        }
    }
}

/// One bench a mode: what lies on each stays when another is shown.
pub struct Stage {
    benches: [Bench; 4],
    mode: Mode,
}

impl Stage {
    /// Empty benches; flattening is shown.
    pub fn new() -> Self {
        Self {
            benches: [Bench::new(), Bench::new(), Bench::comparing(), Bench::new()],
            mode: Mode::default(),
        }
    }

    /// Shows another mode's bench.
    pub fn choose(&mut self, mode: Mode) {
        self.mode = mode;
    }

    /// The mode on show.
    pub fn mode(&self) -> Mode {
        self.mode
    }

    /// The bench of a mode.
    pub fn bench(&mut self, mode: Mode) -> &mut Bench {
        &mut self.benches[mode as usize]
    }

    /// The bench on show.
    pub fn shown(&self) -> &Bench {
        &self.benches[self.mode as usize]
    }

    /// The bench on show.
    pub fn shown_mut(&mut self) -> &mut Bench {
        self.bench(self.mode)
    }

    /// All benches, for what they share: theme, text size, layout.
    pub fn all(&mut self) -> &mut [Bench] {
        &mut self.benches
    }
}
