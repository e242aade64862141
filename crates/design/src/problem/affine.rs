//! Affine expressions: numbers that depend linearly on the variables of a design.

/// A constant plus multiples of variables.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Affine {
    pub(crate) constant: f64,
    /// Variables with their factors, in ascending order, each at most once.
    pub(crate) terms: Vec<(usize, f64)>,
}

impl Affine {
    pub(crate) fn constant(constant: f64) -> Affine {
        Affine { constant, terms: Vec::new() }
    }

    pub(crate) fn variable(index: usize) -> Affine {
        Affine { constant: 0.0, terms: vec![(index, 1.0)] }
    }

    pub(crate) fn eval(&self, variables: &[f64]) -> f64 {
        self.constant + self.terms.iter().map(|&(index, factor)| factor * variables[index]).sum::<f64>()
    }

    pub(crate) fn times(&self, factor: f64) -> Affine {
        let terms = self.terms.iter().map(|&(index, of)| (index, factor * of)).collect();
        Affine { constant: factor * self.constant, terms }
    }

    pub(crate) fn plus(&self, other: &Affine) -> Affine {
        let mut terms = self.terms.clone();
        for &(index, factor) in &other.terms {
            match terms.binary_search_by_key(&index, |term| term.0) {
                Ok(place) => terms[place].1 += factor,
                Err(place) => terms.insert(place, (index, factor)),
            }
        }
        terms.retain(|term| term.1 != 0.0);
        Affine { constant: self.constant + other.constant, terms }
    }

    pub(crate) fn minus(&self, other: &Affine) -> Affine {
        self.plus(&other.times(-1.0))
    }
}
