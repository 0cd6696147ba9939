//! How long a solution may take.

use std::time::{Duration, Instant};

/// The time after which Newton's method begins no further iteration; none for ever.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Deadline(Option<Instant>);

impl Deadline {
    /// So many seconds from now; 0 is no limit.
    pub fn after(seconds: f64) -> Self {
        let limit = Duration::try_from_secs_f64(seconds).ok().filter(|limit| !limit.is_zero());
        Self(limit.and_then(|limit| Instant::now().checked_add(limit)))
    }

    /// Whether it is over.
    pub fn passed(self) -> bool {
        self.0.is_some_and(|end| Instant::now() >= end)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zero_is_no_limit() {
        assert!(!Deadline::after(0.0).passed() && !Deadline::after(1e3).passed() && !Deadline::after(1e300).passed());
        let short = Deadline::after(1e-9);
        std::thread::sleep(Duration::from_millis(1));
        assert!(short.passed());
    }
}
