//! Units of errors in `[tolerance]`: conversion from the file and back, and what no error exceeds.

use crate::plausible::{short, typed};

/// Microtesla in a tesla.
const UT_PER_T: f64 = 1e6;

/// Millitesla in a tesla.
const MT_PER_T: f64 = 1e3;

/// Neighbouring numbers that are tried for one that reads back exactly.
const NEIGHBOURS: usize = 4;

/// The unit of an error in the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum ErrorUnit {
    Millimetre,
    /// Radians in memory.
    Degree,
    /// A fraction of the quantity.
    Fraction,
    /// Tesla in memory.
    Microtesla,
    /// Tesla in memory.
    Millitesla,
    Kelvin,
}

impl ErrorUnit {
    /// A number of the file in the unit in memory.
    pub(crate) fn read(self, written: f64) -> f64 {
        match self {
            ErrorUnit::Degree => written.to_radians(),
            ErrorUnit::Microtesla => written / UT_PER_T,
            ErrorUnit::Millitesla => written / MT_PER_T,
            ErrorUnit::Millimetre | ErrorUnit::Fraction | ErrorUnit::Kelvin => written,
        }
    }

    /// The number in the file that reads back to exactly this one, with few digits if there is one
    /// with few.
    pub(crate) fn written(self, value: f64) -> f64 {
        let guess = match self {
            ErrorUnit::Degree => value.to_degrees(),
            ErrorUnit::Microtesla => value * UT_PER_T,
            ErrorUnit::Millitesla => value * MT_PER_T,
            ErrorUnit::Millimetre | ErrorUnit::Fraction | ErrorUnit::Kelvin => return value,
        };
        let near = |step: fn(f64) -> f64| std::iter::successors(Some(guess), move |x| Some(step(*x))).take(NEIGHBOURS);
        let mut all = std::iter::once(typed(guess)).chain(near(f64::next_up)).chain(near(f64::next_down));
        // A number that was read has one that it was read from. Any other is written to round-off.
        all.find(|written| self.read(*written) == value).unwrap_or(guess)
    }

    /// The rule that a magnitude in the unit of the file breaks if no error is as large, with a
    /// likely meaning. Lengths have no such rule by themselves.
    pub(crate) fn broken_rule(self, value: f64) -> Option<String> {
        let (largest, meant) = match self {
            ErrorUnit::Millimetre | ErrorUnit::Millitesla => return None,
            // An eighth of a turn: a tile that is turned further belongs elsewhere.
            ErrorUnit::Degree => (45.0, "an error in degrees".to_owned()),
            ErrorUnit::Fraction => (0.5, format!("a fraction, not per cent: {}?", short(1e-2 * value))),
            // 0.1 T, as strong as the film.
            ErrorUnit::Microtesla => (1e5, "in microtesla: the earth's field is 50".to_owned()),
            // Magnets lose their polarization below.
            ErrorUnit::Kelvin => (1000.0, "a change in kelvin".to_owned()),
        };
        (value > largest).then(|| format!("must be at most {largest} ({meant})"))
    }

    /// Words for the unit.
    pub(crate) fn words(self) -> &'static str {
        match self {
            ErrorUnit::Millimetre => "mm",
            ErrorUnit::Degree => "degrees",
            ErrorUnit::Fraction => "fractions",
            ErrorUnit::Microtesla => "microtesla",
            ErrorUnit::Millitesla => "millitesla",
            ErrorUnit::Kelvin => "kelvin",
        }
    }

    /// The unit at the end of the name of a column.
    pub(crate) fn of_column(name: &str) -> Option<&'static str> {
        const ENDS: [(&str, &str); 11] = [
            ("_mm", "mm"),
            ("_um", "micrometres"),
            ("_m", "metres"),
            ("_deg", "degrees"),
            ("_rad", "radians"),
            ("_mrad", "milliradians"),
            ("_ut", "microtesla"),
            ("_mt", "millitesla"),
            ("_t", "tesla"),
            ("_k", "kelvin"),
            ("_percent", "per cent"),
        ];
        let lower = name.to_lowercase();
        ENDS.into_iter().find(|(end, _)| lower.ends_with(end)).map(|(_, words)| words)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_written_as_they_were_read() {
        for unit in [ErrorUnit::Degree, ErrorUnit::Microtesla, ErrorUnit::Millitesla] {
            let mut written = 1e-6;
            for _ in 0..20_000 {
                written = typed(written * 1.001);
                assert_eq!(unit.written(unit.read(written)), written, "{unit:?}");
                let long = written / 3.0;
                assert_eq!(unit.read(unit.written(unit.read(long))), unit.read(long), "{unit:?}");
            }
        }
        assert_eq!(ErrorUnit::Degree.read(180.0), std::f64::consts::PI);
        assert_eq!(ErrorUnit::Microtesla.read(50.0), 5e-5);
        assert_eq!(ErrorUnit::Fraction.written(0.01), 0.01);
    }
}
