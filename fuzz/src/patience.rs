//! An end to runs that do not end by themselves: seconds of the processor, unlike those of the clock that libFuzzer's own
//! `-timeout` counts, are the same on a busy machine.

use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

/// How long one run may compute.
const LONGEST: Duration = Duration::from_secs(10);

static RUNS: AtomicU64 = AtomicU64::new(0);

/// A run begins.
pub fn begin() {
    RUNS.fetch_add(1, Ordering::Relaxed);
}

/// Watches over the runs of this process from a thread of its own.
pub fn watch() {
    std::thread::spawn(|| {
        let (mut run, mut since) = (0, Duration::ZERO);
        loop {
            std::thread::sleep(Duration::from_secs(1));
            let (now, computed) = (RUNS.load(Ordering::Relaxed), computed());
            if now != run {
                (run, since) = (now, computed);
            } else if computed.saturating_sub(since) > LONGEST {
                eprintln!("a run has taken more than {} s of the processor", LONGEST.as_secs());
                std::process::abort();
            }
        }
    });
}

/// What the first thread has computed so far; Linux alone says it, elsewhere only libFuzzer's clock counts.
fn computed() -> Duration {
    let text = std::fs::read_to_string("/proc/self/schedstat").unwrap_or_default();
    Duration::from_nanos(text.split(' ').next().and_then(|word| word.parse().ok()).unwrap_or(0))
}
