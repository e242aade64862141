//! What `check` found, as JUnit XML: a suite for each layout, with a case for the file itself and one for each expectation.

use magsplice::expect::Outcome;
use magsplice::layout::Layout;
use quick_junit::{NonSuccessKind, Report, TestCase, TestCaseStatus, TestSuite};

use super::text::{bound, place};
use super::{Checked, Status};

pub(super) fn of(all: &[Checked]) -> String {
    let mut report = Report::new("magsplice check");
    report.add_test_suites(all.iter().map(suite));
    report.to_string().expect("text can always be written as XML")
}

fn suite(checked: &Checked) -> TestSuite {
    let file = checked.path.display().to_string();
    let mut suite = TestSuite::new(file.clone());
    let own = match &checked.layout {
        Err(message) => status(Status::Unusable, message),
        Ok(layout) if layout.findings.is_empty() => TestCaseStatus::success(),
        Ok(layout) => status(Status::Finding, &layout.findings.join("\n")),
    };
    suite.add_test_case(case("layout", &file, own));
    if let Ok(layout) = &checked.layout {
        suite.add_test_cases(checked.lines.iter().map(|line| {
            let message = match &line.outcome {
                Ok(outcome) => said(outcome, layout),
                Err(message) => message.clone(),
            };
            let mut case = case(&line.expectation.to_string(), &file, status(line.status(), &message));
            case.set_system_out(message);
            case
        }));
    }
    suite
}

fn case(name: &str, file: &str, status: TestCaseStatus) -> TestCase {
    let mut case = TestCase::new(name, status);
    case.set_classname(file);
    case
}

fn status(status: Status, message: &str) -> TestCaseStatus {
    let kind = match status {
        Status::Fine => return TestCaseStatus::success(),
        Status::Finding => NonSuccessKind::Failure,
        Status::Unusable => NonSuccessKind::Error,
    };
    let mut status = TestCaseStatus::non_success(kind);
    status.set_message(message);
    status
}

fn said(outcome: &Outcome, layout: &Layout) -> String {
    let (value, margin) = (outcome.value, outcome.margin());
    format!("{value:?}, {}, margin {margin:?} {}", bound(outcome), place(outcome, layout)).trim_end().to_owned()
}
