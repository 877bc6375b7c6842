//! The one clock of the library.

use web_time::Instant;

/// Wall time since it was started: natively the system's monotonic clock, in WebAssembly the page's.
#[derive(Debug, Clone, Copy)]
pub struct Stopwatch(Instant);

impl Stopwatch {
    /// Starts now.
    // natively `web_time` is `std::time`, whose use elsewhere would panic in wasm and is banned
    #[allow(clippy::disallowed_methods)]
    pub fn start() -> Self {
        Self(Instant::now())
    }
    /// Seconds since the start.
    pub fn seconds(self) -> f64 {
        self.0.elapsed().as_secs_f64()
    }
    /// Milliseconds since the start.
    pub fn milliseconds(self) -> f64 {
        1e3 * self.seconds()
    }
}
