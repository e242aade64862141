//! The top of a page: whether the film keeps its bounds, and the numbers that matter most.

use std::borrow::Cow;

use magsplice::expect::Bound;
use magsplice::results::{CheckStatus, CheckedExpectation};

use crate::film_results::FilmResults;
use crate::number_tables::{MT_PER_T, UM_PER_MM, UT_PER_T};
use crate::typeset::{number, rounded};
use magsplice_live_page::html::escaped;

/// Digits behind the first of the numbers that matter most.
const DIGITS: usize = 2;

/// The verdict, the bounds that were checked, and the most important numbers. `prefix` begins the
/// ids.
pub(crate) fn summary(of: &FilmResults, prefix: &str) -> String {
    let absent: String =
        of.absent.iter().map(|what| format!("<p class=\"absent\">Absent: {}.</p>\n", escaped(what))).collect();
    [verdict(of, prefix), key_numbers(of), bounds(&of.input.expectations), absent].concat()
}

/// A sentence about the bounds of the layout, and one about films as made.
fn verdict(of: &FilmResults, prefix: &str) -> String {
    let expectations = &of.input.expectations;
    let with = |status: CheckStatus| -> Vec<String> {
        let having = expectations.iter().filter(|checked| checked.status == status);
        having.map(|checked| escaped(&checked.expectation.to_string())).collect()
    };
    let (broken, unknown) = (with(CheckStatus::Finding), with(CheckStatus::Unusable));
    let all = expectations.len();
    let bounds = |count: usize| if count == 1 { "1 bound".to_owned() } else { format!("{count} bounds") };
    let (class, mut text) = if all == 0 {
        ("open", "No verdict: the layout states no bounds in [expect].".to_owned())
    } else if !broken.is_empty() {
        let (count, names) = (broken.len(), broken.join(", "));
        ("broken", format!("The film breaks {count} of its {}: {names}.", bounds(all)))
    } else if unknown.len() == all {
        ("open", format!("No verdict: none of the {} of [expect] can be evaluated.", bounds(all)))
    } else if !unknown.is_empty() {
        ("open", format!("The film keeps {} of its {}.", all - unknown.len(), bounds(all)))
    } else if all == 1 {
        ("kept", "The film keeps its only bound.".to_owned())
    } else {
        ("kept", format!("The film keeps all {} of [expect].", bounds(all)))
    };
    if !unknown.is_empty() && unknown.len() < all {
        text += &format!(" Not evaluated: {}.", unknown.join(", "));
    }
    let made = match (of.made_mm(), &of.input.samples) {
        (Some([x, y, z]), Some(samples)) => {
            let [x, y, z] = [x, y, z].map(|mm| rounded(UM_PER_MM * mm, DIGITS));
            let share = samples.found.yield_made.as_ref().map(|share| {
                format!("; {} % of the films keep all bounds of [expect.made]", rounded(100.0 * share.value, DIGITS))
            });
            format!(
                "Of {} films as made, 95 % have a displacement RMSE of at most {x}, {y}, {z} \u{b5}m along x, y, z{}.",
                samples.errors.len(),
                share.unwrap_or_default()
            )
        }
        _ => "The numbers are for the film as ordered: the layout states no errors in [tolerance], so nothing here \
              shows how far films as made differ from it."
            .to_owned(),
    };
    format!("<div class=\"verdict {class}\" id=\"{prefix}verdict\"><p><strong>{text}</strong></p><p>{made}</p></div>\n")
}

/// The most important numbers in a few words each.
fn key_numbers(of: &FilmResults) -> String {
    let three = |values: [Option<f64>; 3], factor: f64| {
        values.map(|value| value.map_or("none".to_owned(), |value| rounded(factor * value, DIGITS))).join(", ")
    };
    let mut keys: Vec<(Cow<str>, String, &str)> = Vec::new();
    if let Some(found) = &of.evaluation {
        let errors = found.decoupling.decoupling.displacement_rmse_mm.map(Some).to_array();
        keys.push((
            "Displacement RMSE x, y, z against the ideal film, without calibration".into(),
            three(errors, UM_PER_MM),
            "\u{b5}m",
        ));
        if let Some(uniformity) = of.uniformity_mm() {
            keys.push(("Uniformity RMSE x, y, z as displacement".into(), three(uniformity, UM_PER_MM), "\u{b5}m"));
        }
        keys.push(("Amplitude relative to the ideal film".into(), rounded(found.comparison.amplitude, DIGITS + 1), ""));
    }
    if let Some(b_t) = of.reference_field_t() {
        keys.push(("B x, y, z at the reference point".into(), three(b_t.to_array().map(Some), MT_PER_T), "mT"));
    }
    if let Some(made) = of.made_mm() {
        keys.push((
            "Displacement RMSE x, y, z that 95 % of films as made keep".into(),
            three(made.map(Some), UM_PER_MM),
            "\u{b5}m",
        ));
    }
    if let Some(resolution) = of.resolution_mm() {
        let rms = resolution.rms_mm.to_array().map(Some);
        let noise = of.resolution.as_ref().map_or(String::new(), |found| {
            let [x, y, z] = found.noise.deviation_t.to_array().map(|noise_t| rounded(UT_PER_T * noise_t, DIGITS));
            format!(" at a noise of {x}, {y}, {z} \u{b5}T")
        });
        let name = format!("Resolution of the sensor x, y, z, RMS of the volume{noise}");
        keys.push((name.into(), three(rms, UM_PER_MM), "\u{b5}m"));
    }
    let key =
        |(name, value, unit): &(Cow<str>, String, &str)| format!("<div><dt>{name}</dt><dd>{value} {unit}</dd></div>\n");
    format!("<dl class=\"key\">\n{}</dl>\n", keys.iter().map(key).collect::<String>())
}

/// The bounds with their values, broken ones first.
fn bounds(expectations: &[CheckedExpectation]) -> String {
    if expectations.is_empty() {
        return String::new();
    }
    let mut ordered: Vec<&CheckedExpectation> = expectations.iter().collect();
    ordered.sort_by_key(|checked| std::cmp::Reverse(checked.status));
    let row = |checked: &&CheckedExpectation| {
        let status = match checked.status {
            CheckStatus::Ok => "kept",
            CheckStatus::Finding => "broken",
            CheckStatus::Unusable => "not evaluated",
        };
        let bound = match checked.bound {
            Some(Bound::AtMost(most)) => format!("at most {}", number(most)),
            Some(Bound::AtLeast(least)) => format!("at least {}", number(least)),
            None => String::new(),
        };
        let cells = match &checked.error {
            Some(error) => format!("<td colspan=\"2\" class=\"reason\">{}</td>", escaped(error)),
            None => format!("<td>{}</td><td>{bound}</td>", checked.value.map_or(String::new(), number)),
        };
        let limit = checked.percentile.map_or(String::new(), |of| {
            format!("; P{} is {}, and the limit of its interval counts", of.per_cent, number(of.value))
        });
        let name = escaped(&format!("{}{limit}", checked.expectation));
        format!("<tr><th scope=\"row\">{name}</th>{cells}<td>{status}</td></tr>\n")
    };
    let rows: String = ordered.iter().map(row).collect();
    format!(
        "<details class=\"bounds\"><summary>The bounds of [expect]</summary>\n<table><thead><tr><th scope=\"col\">\
         </th><th scope=\"col\">found</th><th scope=\"col\">bound</th><th scope=\"col\"></th></tr></thead><tbody>\n\
         {rows}</tbody></table></details>\n"
    )
}
