//! The progress line on a terminal, and lines about long searches elsewhere.

use std::fmt::Write;
use std::io::{IsTerminal, stderr};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, Sender};
use std::sync::{Arc, Mutex};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use indicatif::{HumanDuration, ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};
use magsplice::{Progress, Stage};

use crate::failure;

/// Time before the line appears; shorter work shows none.
const DELAY: Duration = Duration::from_secs(1);

/// Interval at which the line is redrawn without news, so that it is seen to be alive.
const TICK: Duration = Duration::from_millis(200);

/// Interval of the lines about a search where there is no terminal.
const LOG_INTERVAL: Duration = Duration::from_secs(10);

/// A line on standard error that shows how far the work is. It disappears when the work ends.
pub(crate) struct ProgressLine {
    bar: ProgressBar,
    stage: Mutex<Option<Stage>>,
    /// The next line that is printed. Only for searches without a terminal.
    log: Option<Arc<Mutex<String>>>,
    /// The thread that makes the line appear or prints lines, until the sender is dropped.
    thread: Mutex<Option<(Sender<()>, JoinHandle<()>)>>,
}

impl ProgressLine {
    /// The line of work that begins now, with the reading of a layout. It appears only if `visible`
    /// and on a terminal.
    pub(crate) fn start(visible: bool) -> Arc<ProgressLine> {
        ProgressLine::begin(visible && stderr().is_terminal(), false)
    }

    /// The line of a search. Where standard error is no terminal, a line about the search is
    /// printed every [`LOG_INTERVAL`] instead.
    pub(crate) fn start_search(visible: bool) -> Arc<ProgressLine> {
        let is_terminal = stderr().is_terminal();
        ProgressLine::begin(visible && is_terminal, visible && !is_terminal)
    }

    fn begin(drawn: bool, logged: bool) -> Arc<ProgressLine> {
        let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::hidden());
        let log = logged.then(|| Arc::new(Mutex::new(String::new())));
        let (sender, end) = mpsc::channel();
        let thread = match log.clone() {
            Some(log) => Some(thread::spawn(move || print_lines(&end, &log))),
            None if drawn => {
                let bar = bar.clone();
                Some(thread::spawn(move || draw(&end, &bar)))
            }
            None => None,
        };
        let thread = Mutex::new(thread.map(|thread| (sender, thread)));
        let line = ProgressLine { bar, stage: Mutex::new(None), log, thread };
        line.show(Stage::uncounted("reading the layout"));
        Arc::new(line)
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
        if let Some(Ok(mut next)) = self.log.as_ref().map(|log| log.lock()) {
            *next = format!("{}{}", self.bar.prefix(), in_words(&stage));
        }
        *last = Some(stage);
    }

    /// Sets the words before the name of the stage. They may cite a path.
    pub(crate) fn set_prefix(&self, prefix: &str) {
        self.bar.set_prefix(failure::escaped(&prefix));
    }

    /// Hides the line while `write` writes to the terminal.
    pub(crate) fn suspend<T>(&self, write: impl FnOnce() -> T) -> T {
        self.bar.suspend(write)
    }

    /// Removes the line for good, before results are written to the same terminal.
    pub(crate) fn end(&self) {
        if let Ok(mut running) = self.thread.lock()
            && let Some((sender, thread)) = running.take()
        {
            drop(sender);
            // The thread returns nothing, and panics only where drawing does.
            let _ = thread.join();
            self.bar.finish_and_clear();
        }
    }
}

impl Progress for ProgressLine {
    fn show(&self, stage: Stage) {
        ProgressLine::show(self, stage);
    }
}

/// A stage and its progress as text.
fn in_words(stage: &Stage) -> String {
    match stage {
        Stage { name, done, of: Some(of), unit } => format!("{name}: {done} of {of} {unit}").trim_end().to_owned(),
        Stage { name, of: None, unit: "", .. } => (*name).to_owned(),
        Stage { name, done, of: None, unit } => format!("{name}: {done} {unit}"),
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

/// Draws the line after [`DELAY`], also while the work reports nothing.
fn draw(end: &Receiver<()>, bar: &ProgressBar) {
    if end.recv_timeout(DELAY) == Err(RecvTimeoutError::Timeout) {
        bar.set_draw_target(ProgressDrawTarget::stderr());
        bar.tick();
        bar.enable_steady_tick(TICK);
    }
}

/// Prints lines about a search on standard error that is no terminal, such as the log of a build.
fn print_lines(end: &Receiver<()>, log: &Mutex<String>) {
    let begun = Instant::now();
    while end.recv_timeout(LOG_INTERVAL) == Err(RecvTimeoutError::Timeout) {
        let Ok(text) = log.lock().map(|text| text.clone()) else { return };
        failure::tell(&format_args!("{} s: {text}", begun.elapsed().as_secs()));
    }
}

impl Drop for ProgressLine {
    fn drop(&mut self) {
        self.end();
    }
}
