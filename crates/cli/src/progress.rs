//! How far long work is, on a terminal only.

use std::fmt::Write;
use std::io::{IsTerminal, stderr};
use std::sync::Mutex;
use std::sync::mpsc::{self, RecvTimeoutError, Sender};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use indicatif::{HumanDuration, ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};
use magsplice::Stage;

/// Work that is done sooner shows no bar.
const PATIENCE: Duration = Duration::from_secs(1);

/// How often what is shown changes though nothing was done, so that it is seen to be alive.
const TICK: Duration = Duration::from_millis(200);

/// A bar on standard error, gone when the work is.
pub(crate) struct Progress {
    bar: ProgressBar,
    stage: Mutex<Option<Stage>>,
    /// Shows the bar when it is due, unless the sender is dropped before.
    watch: Mutex<Option<(Sender<()>, JoinHandle<()>)>>,
}

impl Progress {
    /// Progress of work that begins now, if anybody is to see it.
    pub(crate) fn start(seen: bool) -> Progress {
        let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::hidden());
        let watch = (seen && stderr().is_terminal()).then(|| watch(&bar));
        let progress = Progress { bar, stage: Mutex::new(None), watch: Mutex::new(watch) };
        progress.show(Stage::uncounted("reading the layout"));
        progress
    }

    /// How far it is.
    pub(crate) fn show(&self, stage: Stage) {
        let Ok(mut last) = self.stage.lock() else { return };
        if last.is_none_or(|last| (last.name, last.of) != (stage.name, stage.of)) {
            // Times are those of this stage.
            self.bar.reset_elapsed();
            self.bar.reset_eta();
            self.bar.set_style(style(&stage));
        }
        // Both at once: one of them would be drawn beside the other of the stage before.
        self.bar.update(|state| {
            state.set_pos(stage.done as u64);
            state.set_len(stage.of.unwrap_or(0) as u64);
        });
        *last = Some(stage);
    }

    /// Of which of several layouts.
    pub(crate) fn of(&self, what: String) {
        self.bar.set_prefix(what);
        self.show(Stage::uncounted("reading the layout"));
    }

    /// What is known so far, before the name of the stage.
    pub(crate) fn best(&self, what: String) {
        self.bar.set_prefix(what);
    }

    /// Writes to the terminal without meeting the bar there.
    pub(crate) fn aside<T>(&self, write: impl FnOnce() -> T) -> T {
        self.bar.suspend(write)
    }

    /// Removes the bar for good, before results go to where it is.
    pub(crate) fn end(&self) {
        if let Ok(mut watch) = self.watch.lock()
            && let Some((ended, thread)) = watch.take()
        {
            drop(ended);
            // It has nothing to give, and fails only where drawing does.
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
        // Nothing can be told from nothing.
        if state.pos() > 0 {
            let _ = write!(text, ", {:#} left", HumanDuration(state.eta()));
        }
    })
}

/// A thread of its own, for work that says nothing while it goes on.
fn watch(bar: &ProgressBar) -> (Sender<()>, JoinHandle<()>) {
    let (ended, end) = mpsc::channel();
    let bar = bar.clone();
    let thread = thread::spawn(move || {
        if end.recv_timeout(PATIENCE) == Err(RecvTimeoutError::Timeout) {
            bar.set_draw_target(ProgressDrawTarget::stderr());
            bar.tick();
            bar.enable_steady_tick(TICK);
        }
    });
    (ended, thread)
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.end();
    }
}
