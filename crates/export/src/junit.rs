//! The JUnit form of the results of `check`: a suite for each layout, with a case for the file and
//! a case for each expectation.

use std::time::Duration;

use magsplice::results::{Check, CheckStatus, CheckedExpectation, CheckedLayout, SkippedFile};
use quick_junit::{NonSuccessKind, Report, TestCase, TestCaseStatus, TestSuite};

/// The results as JUnit XML. `sentence` describes an outcome in words.
pub fn xml(check: &Check, sentence: &dyn Fn(&CheckedExpectation) -> String) -> String {
    let mut report = Report::new("magsplice check");
    report.add_test_suites(check.layouts.iter().map(|checked| suite(checked, sentence)));
    report.add_test_suites(check.skipped.iter().map(skipped_suite));
    report.set_time(check.layouts.iter().map(|layout| layout.reading + evaluation(layout)).sum());
    report.to_string().expect("text can always be written as XML")
}

/// Time of the evaluation of the expectations.
fn evaluation(checked: &CheckedLayout) -> Duration {
    checked.expectations.iter().map(|expectation| expectation.took).sum()
}

fn suite(checked: &CheckedLayout, sentence: &dyn Fn(&CheckedExpectation) -> String) -> TestSuite {
    let file = xml_text(&checked.file);
    let mut suite = TestSuite::new(file.clone());
    let own = match &checked.error {
        Some(message) => status(CheckStatus::Unusable, message),
        None if checked.findings.is_empty() => TestCaseStatus::success(),
        None => status(CheckStatus::Finding, &checked.findings.join("\n")),
    };
    suite.add_test_case(case("layout", &file, own, checked.reading));
    suite.set_time(checked.reading + evaluation(checked));
    if let Some(moved) = &checked.moved {
        suite.add_property(("moved", moved.as_str()));
    }
    suite.add_test_cases(checked.expectations.iter().map(|checked| {
        let message = checked.error.clone().unwrap_or_else(|| sentence(checked));
        let mut case = case(&checked.expectation.to_string(), &file, status(checked.status, &message), checked.took);
        // A failure or an error contains the message.
        if checked.status == CheckStatus::Ok {
            case.set_system_out(xml_text(&message));
        }
        case
    }));
    suite
}

/// The suite of a TOML file that is no layout.
fn skipped_suite(skipped: &SkippedFile) -> TestSuite {
    let file = xml_text(&skipped.file);
    let mut suite = TestSuite::new(file.clone());
    let mut status = TestCaseStatus::skipped();
    status.set_message(skipped.reason);
    suite.add_test_case(case("layout", &file, status, Duration::ZERO));
    suite.set_time(Duration::ZERO);
    suite
}

/// The text with U+FFFD in place of characters forbidden in XML 1.0.
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
    // XML parsers read line breaks in attributes as blanks.
    status.set_message(xml_text(message.lines().next().unwrap_or_default()));
    status.set_description(xml_text(message));
    status
}
