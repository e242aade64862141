//! Ranges of axes and colours that the figures of two films share.

use std::cell::RefCell;
use std::collections::HashMap;

/// The widest range that each axis and colour scale has had so far. Figures of a single film get
/// their own ranges. Drawing two films twice gives both of them the common ranges.
#[derive(Default)]
pub(crate) struct SharedRanges(RefCell<HashMap<String, [f64; 2]>>);

impl SharedRanges {
    /// The range that contains `own` and every range that was given for `key` before.
    pub(crate) fn widened(&self, key: &str, own: [f64; 2]) -> [f64; 2] {
        let mut ranges = self.0.borrow_mut();
        let range = ranges.entry(key.to_owned()).or_insert(own);
        *range = [range[0].min(own[0]), range[1].max(own[1])];
        *range
    }

    /// The range of these values, without those that are not finite, and of the values that were
    /// given for `key` before. It is empty without any.
    pub(crate) fn of_values(&self, key: &str, values: impl Iterator<Item = f64>) -> [f64; 2] {
        self.widened(key, range_of(values))
    }
}

/// The range of these values, without those that are not finite. It is empty without any.
pub(crate) fn range_of(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let finite = values.filter(|v| v.is_finite());
    finite.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| [low.min(v), high.max(v)])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_contains_all_that_were_given_for_its_key() {
        let ranges = SharedRanges::default();
        assert_eq!(ranges.of_values("a", [3.0, f64::NAN, 1.0].into_iter()), [1.0, 3.0]);
        assert_eq!(ranges.widened("a", [2.0, 5.0]), [1.0, 5.0]);
        assert_eq!(ranges.widened("b", [2.0, 5.0]), [2.0, 5.0]);
    }
}
