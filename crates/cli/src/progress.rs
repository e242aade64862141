//! The progress line on a terminal.

use std::fmt::Write;
use std::io::{IsTerminal, stderr};
use std::sync::Mutex;
use std::sync::mpsc::{self, RecvTimeoutError, Sender};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use indicatif::{HumanDuration, ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};
use magsplice::Stage;

/// Time before the line appears; shorter work shows none.
const DELAY: Duration = Duration::from_secs(1);

/// Interval at which the line is redrawn without news, so that it is seen to be alive.
const TICK: Duration = Duration::from_millis(200);

/// A line on standard error that shows how far the work is. It disappears when the work ends.
pub(crate) struct ProgressLine {
    bar: ProgressBar,
    stage: Mutex<Option<Stage>>,
    /// The thread that makes the line appear after [`DELAY`], unless the sender is dropped before.
    watch: Mutex<Option<(Sender<()>, JoinHandle<()>)>>,
}

impl ProgressLine {
    /// The line of work that begins now, with the reading of a layout. It appears only if `visible`
    /// and on a terminal.
    pub(crate) fn start(visible: bool) -> ProgressLine {
        let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::hidden());
        let watch = (visible && stderr().is_terminal()).then(|| watch(&bar));
        let line = ProgressLine { bar, stage: Mutex::new(None), watch: Mutex::new(watch) };
        line.show(Stage::uncounted("reading the layout"));
        line
    }

    /// Shows a stage of the work, and how much of it is done.
    pub(crate) fn show(&self, stage: Stage) {
        let Ok(mut last) = self.stage.lock() else { return };
        if last.is_none_or(|last| (last.name, last.of) != (stage.name, stage.of)) {
            // Times are counted from the start of this stage.
            self.bar.reset_elapsed();
            self.bar.reset_eta();
            self.bar.set_style(style(&stage));
        }
        // Both in one update: otherwise one would be drawn with the other of the stage before.
        self.bar.update(|state| {
            state.set_pos(stage.done as u64);
            state.set_len(stage.of.unwrap_or(0) as u64);
        });
        *last = Some(stage);
    }

    /// Sets the words before the name of the stage.
    pub(crate) fn set_prefix(&self, prefix: String) {
        self.bar.set_prefix(prefix);
    }

    /// Hides the line while `write` writes to the terminal.
    pub(crate) fn suspend<T>(&self, write: impl FnOnce() -> T) -> T {
        self.bar.suspend(write)
    }

    /// Removes the line for good, before results are written to the same terminal.
    pub(crate) fn end(&self) {
        if let Ok(mut watch) = self.watch.lock()
            && let Some((ended, thread)) = watch.take()
        {
            drop(ended);
            // The thread returns nothing, and panics only where drawing does.
            let _ = thread.join();
            self.bar.finish_and_clear();
        }
    }
}

fn style(stage: &Stage) -> ProgressStyle {
    let Stage { name, of, unit, .. } = stage;
    let template = match (of, *unit) {
        (Some(_), _) => format!("{{prefix}}{name} {{wide_bar}} {{human_pos}} of {{human_len}} {unit}{{left}}"),
        (None, "") => format!("{{spinner}} {{prefix}}{name}, {{elapsed}}"),
        (None, _) => format!("{{spinner}} {{prefix}}{name}: {{human_pos}} {unit} in {{elapsed}}"),
    };
    let style = ProgressStyle::with_template(&template).expect("a valid template");
    style.with_key("left", |state: &ProgressState, text: &mut dyn Write| {
        // Without any progress there is no estimate.
        if state.pos() > 0 {
            let _ = write!(text, ", {:#} left", HumanDuration(state.eta()));
        }
    })
}

/// Starts a thread that draws the line, also while the work reports nothing.
fn watch(bar: &ProgressBar) -> (Sender<()>, JoinHandle<()>) {
    let (ended, end) = mpsc::channel();
    let bar = bar.clone();
    let thread = thread::spawn(move || {
        if end.recv_timeout(DELAY) == Err(RecvTimeoutError::Timeout) {
            bar.set_draw_target(ProgressDrawTarget::stderr());
            bar.tick();
            bar.enable_steady_tick(TICK);
        }
    });
    (ended, thread)
}

impl Drop for ProgressLine {
    fn drop(&mut self) {
        self.end();
    }
}
