//! Rules of single distributions.

use crate::distribution::Distribution;
use crate::error_unit::{ErrorUnit, largest_magnitude};
use crate::limits::MAX_TABULATED_IN_ALL;
use crate::read::faults::TableFaults;
use crate::read::tolerance::tabulated::Tabulated;
use crate::tables::distribution::{Components, DistributionTable, WrittenDistribution};

/// Fraction of its standard deviation below which the limit of a truncated normal distribution
/// makes it uniform, to 1e-4 of its density.
const LEAST_LIMIT: f64 = 0.01;

/// The distributions of the components of a key. Faults are added, and a component with a fault has
/// none.
pub(crate) fn components<const N: usize>(
    key: &str,
    written: &Components<N>,
    unit: ErrorUnit,
    tabulated: &mut Tabulated,
    faults: &mut TableFaults,
) -> [Distribution; N] {
    match written {
        Components::Same(one) => {
            let one = distribution(key, one, unit, tabulated, faults);
            std::array::from_fn(|_| one.clone())
        }
        Components::Each(_) => {
            let mut number = 0;
            written.each().map(|one| {
                let key = format!("{key}[{number}]");
                number += 1;
                distribution(&key, one, unit, tabulated, faults)
            })
        }
    }
}

/// The distribution of a key, or none after adding its faults.
pub(crate) fn distribution(
    key: &str,
    written: &WrittenDistribution,
    unit: ErrorUnit,
    tabulated: &mut Tabulated,
    faults: &mut TableFaults,
) -> Distribution {
    let before = faults.count();
    let found = match written {
        WrittenDistribution::Deviation(deviation) => {
            check_deviation(key, *deviation, faults);
            Distribution::Normal { deviation: *deviation }
        }
        WrittenDistribution::Table(table) => match of_table(key, table, unit, tabulated, faults) {
            Some(found) => found,
            None => return Distribution::NONE,
        },
    };
    if faults.count() > before {
        return Distribution::NONE;
    }
    // Tabulated distributions have been converted already.
    let (found, largest) = match found {
        Distribution::Tabulated(_) => {
            let largest = unit.written(largest_magnitude(&found));
            (found, largest)
        }
        _ => (unit.read_distribution(&found), largest_magnitude(&found)),
    };
    if unit.largest().is_some_and(|most| largest > most) {
        faults.add(format!("{key} = {largest}, {}", unit.rule(largest)));
        return Distribution::NONE;
    }
    if !tabulated.count([&found], 1) {
        faults.add(too_many_values(key));
    }
    found
}

/// The rule that limits tabulated values in all.
pub(crate) fn too_many_values(key: &str) -> String {
    format!(
        "{key}: has too many tabulated values beside the others of the layout, must be at most {MAX_TABULATED_IN_ALL}, \
         counted in each distribution"
    )
}

/// The distribution of a table, in the unit of the file unless it is tabulated.
fn of_table(
    key: &str,
    table: &DistributionTable,
    unit: ErrorUnit,
    tabulated: &mut Tabulated,
    faults: &mut TableFaults,
) -> Option<Distribution> {
    let DistributionTable { normal, within, uniform, fixed, file, column, values } = table;
    let given = [
        ("normal", normal.is_some()),
        ("uniform", uniform.is_some()),
        ("fixed", fixed.is_some()),
        ("file", file.is_some()),
        ("values", values.is_some()),
    ];
    let given: Vec<&str> = given.into_iter().filter(|(_, given)| *given).map(|(key, _)| key).collect();
    if given.len() != 1 {
        let found = if given.is_empty() { "nothing".to_owned() } else { given.join(", ") };
        faults.add(format!("{key} gives {found}, must give one of: normal; uniform; fixed; file; values"));
        return None;
    }
    for (goes_with, key_given, wanted) in [("within", within.is_some(), "normal"), ("column", column.is_some(), "file")]
    {
        if key_given && given != [wanted] {
            faults.add(format!("{key} gives {goes_with}, which goes with {wanted}"));
        }
    }
    match (normal, uniform, fixed, file, values) {
        (Some(deviation), ..) => {
            check_deviation(&format!("{key}.normal"), *deviation, faults);
            let Some(limit) = *within else { return Some(Distribution::Normal { deviation: *deviation }) };
            if !(limit.is_finite() && limit > 0.0) {
                faults.add(format!("{key}.within = {limit}, must be a finite number greater than 0"));
            } else if limit < LEAST_LIMIT * deviation {
                faults.add(format!(
                    "{key}.within = {limit}, must be at least a hundredth of normal = {deviation}: write {{ uniform = {limit} }}"
                ));
            }
            Some(Distribution::Truncated { deviation: *deviation, limit })
        }
        (_, Some(half_width), ..) => {
            if !(half_width.is_finite() && *half_width >= 0.0) {
                faults.add(format!(
                    "{key}.uniform = {half_width}, must be a finite number of at least 0, the largest magnitude"
                ));
            }
            Some(Distribution::Uniform { half_width: *half_width })
        }
        (_, _, Some(value), ..) => {
            if !value.is_finite() {
                faults.add(format!("{key}.fixed = {value}, must be a finite number"));
            }
            Some(Distribution::Fixed(*value))
        }
        (.., Some(file), _) => {
            let found = tabulated.of_file(file, column.as_deref(), unit);
            found.map_err(|rule| faults.add(format!("{key}: {rule}"))).ok()
        }
        (.., Some(values)) => {
            let found = tabulated.of_values(values, unit);
            found.map_err(|rule| faults.add(format!("{key}.values: {rule}"))).ok()
        }
        _ => None,
    }
}

fn check_deviation(key: &str, deviation: f64, faults: &mut TableFaults) {
    if !(deviation.is_finite() && deviation >= 0.0) {
        faults.add(format!("{key} = {deviation}, must be a finite number of at least 0, a standard deviation"));
    }
}
