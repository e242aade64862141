//! How far a long computation is, on a terminal only.

use std::io::IsTerminal;
use std::path::Path;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// Work that is done sooner shows no bar.
const PATIENCE: Duration = Duration::from_secs(1);

/// A bar on standard error, gone when the work is.
pub(crate) struct Progress {
    bar: ProgressBar,
    /// When to show it; `None` if it is shown, or never will be.
    due: Option<Instant>,
}

impl Progress {
    /// Progress through so many points, if that is known, whose results go to `output`.
    pub(crate) fn new(points: Option<usize>, output: Option<&Path>, quiet: bool) -> Progress {
        let bar = ProgressBar::with_draw_target(points.map(|n| n as u64), ProgressDrawTarget::hidden());
        let template = match points {
            Some(_) => "{wide_bar} {human_pos} of {human_len} points, {eta} left",
            None => "{spinner} {human_pos} points in {elapsed}",
        };
        bar.set_style(ProgressStyle::with_template(template).expect("a valid template"));
        // Not among results on the same terminal.
        let in_the_way = output.is_none_or(|path| path == Path::new("-")) && std::io::stdout().is_terminal();
        let due = (!quiet && !in_the_way).then(|| Instant::now() + PATIENCE);
        Progress { bar, due }
    }

    /// So many more points are done.
    pub(crate) fn advance(&mut self, points: usize) {
        self.bar.inc(points as u64);
        let more = self.bar.length().is_none_or(|all| self.bar.position() < all);
        if more && self.due.is_some_and(|due| Instant::now() >= due) {
            self.due = None;
            // Draws nothing where standard error is no terminal.
            self.bar.set_draw_target(ProgressDrawTarget::stderr());
            self.bar.tick();
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
