//! The JUnit form of the results of `check`: a suite for each layout, with a case for the file and
//! one for each expectation.

use std::path::Path;
use std::time::Duration;

use quick_junit::{NonSuccessKind, Report, TestCase, TestCaseStatus, TestSuite};

use crate::checked::{CheckStatus, CheckedLayout};
use crate::layout_files::NO_LAYOUT;
use crate::text::check::sentence;

/// The results as JUnit XML.
pub(crate) fn xml(layouts: &[CheckedLayout], skipped: &[&Path]) -> String {
    let mut report = Report::new("magsplice check");
    report.add_test_suites(layouts.iter().map(suite));
    report.add_test_suites(skipped.iter().map(|path| skipped_suite(path)));
    let all =
        layouts.iter().map(|layout| layout.reading + layout.expectations.iter().map(|e| e.took).sum::<Duration>());
    report.set_time(all.sum());
    report.to_string().expect("text can always be written as XML")
}

fn suite(checked: &CheckedLayout) -> TestSuite {
    let file = xml_text(&checked.path.display().to_string());
    let mut suite = TestSuite::new(file.clone());
    let own = match &checked.layout {
        Err(message) => status(CheckStatus::Unusable, message),
        Ok(layout) if layout.findings.is_empty() => TestCaseStatus::success(),
        Ok(layout) => {
            let findings: Vec<&str> = layout.findings.iter().map(|finding| finding.message.as_str()).collect();
            status(CheckStatus::Finding, &findings.join("\n"))
        }
    };
    suite.add_test_case(case("layout", &file, own, checked.reading));
    let evaluation: Duration = checked.expectations.iter().map(|expectation| expectation.took).sum();
    suite.set_time(checked.reading + evaluation);
    if let Some(moved) = &checked.moved {
        suite.add_property(("moved", moved.as_str()));
    }
    if let Ok(layout) = &checked.layout {
        suite.add_test_cases(checked.expectations.iter().map(|checked| {
            let message = match &checked.outcome {
                Ok(outcome) => sentence(outcome, layout),
                Err(message) => message.clone(),
            };
            let mut case =
                case(&checked.expectation.to_string(), &file, status(checked.status(), &message), checked.took);
            // A failure and an error hold the message themselves.
            if checked.status() == CheckStatus::Ok {
                case.set_system_out(xml_text(&message));
            }
            case
        }));
    }
    suite
}

/// A TOML file that is no layout.
fn skipped_suite(path: &Path) -> TestSuite {
    let file = xml_text(&path.display().to_string());
    let mut suite = TestSuite::new(file.clone());
    let mut skipped = TestCaseStatus::skipped();
    skipped.set_message(NO_LAYOUT);
    suite.add_test_case(case("layout", &file, skipped, Duration::ZERO));
    suite.set_time(Duration::ZERO);
    suite
}

/// The text with U+FFFD in place of characters that XML 1.0 does not allow.
fn xml_text(text: &str) -> String {
    let is_allowed = |c: char| matches!(c, '\t' | '\n' | '\r' | ' '..='\u{fffd}' | '\u{10000}'..);
    text.chars().map(|c| if is_allowed(c) { c } else { char::REPLACEMENT_CHARACTER }).collect()
}

fn case(name: &str, file: &str, status: TestCaseStatus, took: Duration) -> TestCase {
    let mut case = TestCase::new(name, status);
    case.set_time(took);
    case.set_classname(file);
    case
}

fn status(status: CheckStatus, message: &str) -> TestCaseStatus {
    let kind = match status {
        CheckStatus::Ok => return TestCaseStatus::success(),
        CheckStatus::Finding => NonSuccessKind::Failure,
        CheckStatus::Unusable => NonSuccessKind::Error,
    };
    let mut status = TestCaseStatus::non_success(kind);
    // An attribute has no line breaks: XML parsers read them as blanks.
    status.set_message(xml_text(message.lines().next().unwrap_or_default()));
    status.set_description(xml_text(message));
    status
}
