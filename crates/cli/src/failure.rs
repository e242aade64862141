//! Reasons why the program stops, and how it tells them.

use std::fmt;
use std::io::{self, Write};
use std::path::PathBuf;

use magsplice::FilmError;
use magsplice::design::DesignError;
use magsplice::layout::LayoutError;

/// Largest number of faults of one kind that are printed; the rest are counted.
pub(crate) const PRINTED_FAULTS: usize = 20;

/// Prints a message on standard error. A closed standard error is ignored: there is nobody to tell.
///
/// A message may cite a path or a file, so control characters are written as escapes: a terminal
/// would obey them.
pub(crate) fn tell(message: &impl fmt::Display) {
    let _ = writeln!(io::stderr(), "magsplice: {}", escaped(message));
}

/// The text with escapes in place of control characters, but for ends of lines and tabs.
pub(crate) fn escaped(message: &impl fmt::Display) -> String {
    let mut text = String::new();
    for c in message.to_string().chars() {
        if c.is_control() && !matches!(c, '\n' | '\t') {
            text.extend(c.escape_default());
        } else {
            text.push(c);
        }
    }
    text
}

/// Why the program stops.
#[derive(Debug)]
pub(crate) enum Failure {
    /// The layout file cannot be read or breaks a rule.
    Layout(LayoutError),
    /// The film of a layout cannot be evaluated.
    Film { layout: PathBuf, error: Box<FilmError> },
    /// There is no film to design. `place` is the layout file or the verb.
    Design { place: String, error: DesignError },
    /// A file of points or a baseline cannot be used.
    Points { path: PathBuf, message: String },
    /// The report cannot be drawn.
    #[cfg(feature = "report")]
    Report { layout: PathBuf, message: String },
    /// Lines of a file that cannot be read, or points without a field.
    Faults { place: String, faults: Vec<String>, more: usize },
    /// The result cannot be written in the format or to the place asked for.
    Format(String),
    /// Writing failed.
    Write { target: String, error: io::Error },
    /// The reader of standard output closed it.
    PipeClosed,
}

impl From<LayoutError> for Failure {
    fn from(error: LayoutError) -> Failure {
        Failure::Layout(error)
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Failure::Layout(error) => error.fmt(f),
            Failure::Film { layout, error } => write!(f, "{}: {error}", layout.display()),
            Failure::Design { place, error: DesignError::Request(problems) } => {
                let lines: Vec<String> = problems.iter().map(|problem| format!("{place}: {problem}")).collect();
                f.write_str(&lines.join("\n"))
            }
            Failure::Design { place, error } => write!(f, "{place}: {error}"),
            #[cfg(feature = "report")]
            Failure::Report { layout, message } => write!(f, "{}: {message}", layout.display()),
            Failure::Points { path, message } => write!(f, "{}: {message}", path.display()),
            Failure::Faults { place, faults, more } => {
                for (i, fault) in faults.iter().enumerate() {
                    let separator = if i == 0 { "" } else { "\n" };
                    write!(f, "{separator}{place}: {fault}")?;
                }
                if *more > 0 {
                    write!(f, "\n{place}: and {more} more")?;
                }
                Ok(())
            }
            Failure::Format(message) => f.write_str(message),
            Failure::Write { target, error } => write!(f, "cannot write {target}: {error}"),
            Failure::PipeClosed => f.write_str("the reader of standard output closed it"),
        }
    }
}
