//! Where the displacement error of the films that are made comes from.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use magsplice_decouple::Figures;
use magsplice_layout::Layout;
use magsplice_tolerance::{
    AxisBudget, Budget, Cause, EndlessPattern, EndlessPatternError, FirstOrder, FirstOrderCheck, SampleError, Sampler,
};

use crate::film::Film;
use crate::film_error::FilmError;
use crate::stage::Stage;

/// The error budget of a film, and whether the first order holds.
#[derive(Clone, Debug)]
pub struct FilmBudget {
    /// The layout of the film.
    pub layout: Arc<Layout>,
    /// Mean squares of the displacement error.
    pub budget: Budget,
    /// The comparison of the first order with exact samples.
    pub check: FirstOrderCheck,
    /// Whether the first order gave the budget; otherwise samples did.
    pub is_first_order: bool,
    /// Why the error of the splicing pattern is not known, if it is not.
    pub no_pattern: Option<EndlessPatternError>,
}

/// A part of a budget.
#[derive(Clone, Debug, PartialEq)]
pub struct BudgetPart {
    /// Where it comes from, in words.
    pub name: String,
    /// Along x, y, z, in mm^2. It is negative where it compensates other parts.
    pub mean_squares_mm2: [f64; 3],
}

impl Film {
    /// Where the displacement error of the films that are made from the layout comes from. So many
    /// samples, at least one, check the first order, or give the budget where it does not hold.
    ///
    /// # Errors
    /// If the layout has no ideal film, no working volume or no errors, or a sample has no
    /// displacement errors.
    pub fn budget(&self, seed: u64, samples: u64) -> Result<FilmBudget, FilmError> {
        let (real, volume, ideal) = (self.real_film()?, self.evaluation_grid()?, self.ideal()?);
        let of_sample = |(sample, error): (u64, SampleError)| FilmError::Sample { sample, error };
        let in_film = real.in_film(real.tiles()).map_err(|faults| of_sample((0, SampleError::Tile(faults))))?;
        let pattern: Result<Figures, EndlessPatternError> =
            EndlessPattern::new(&in_film, ideal).and_then(|pattern| pattern.errors(&volume));
        let model = FirstOrder::new(&real, &volume, ideal).map_err(|error| of_sample((0, error)))?;
        let sampler = Sampler::new(&real, &volume, ideal, seed).map_err(|error| of_sample((0, error)))?;
        let done = AtomicUsize::new(0);
        let counted = || {
            let done = done.fetch_add(1, Ordering::Relaxed);
            self.tell(Stage { name: "budget", done, of: None, unit: "samples" });
        };
        let check = model.check(&sampler, 0..samples, counted).map_err(of_sample)?;
        let is_first_order = check.axes.iter().all(|axis| axis.mean_square_is_valid());
        let budget = if is_first_order {
            Budget::new(&model, pattern.as_ref().ok())
        } else {
            let pattern = pattern.as_ref().ok();
            Budget::from_samples(&real, &volume, ideal, pattern, seed, 0..samples, counted).map_err(of_sample)?
        };
        Ok(FilmBudget { layout: self.layout().clone(), budget, check, is_first_order, no_pattern: pattern.err() })
    }
}

impl FilmBudget {
    /// All parts, whose sum is the total.
    pub fn parts(&self) -> Vec<BudgetPart> {
        let axes = &self.budget.axes;
        let part = |name: String, of: &dyn Fn(&AxisBudget) -> f64| BudgetPart {
            name,
            mean_squares_mm2: axes.each_ref().map(of),
        };
        let mut parts = if self.no_pattern.is_some() || self.compensated_pattern_mm2().is_some() {
            vec![part("film as ordered".to_owned(), &|axis| axis.nominal_mm2)]
        } else {
            vec![
                part("splicing pattern".to_owned(), &|axis| axis.pattern_mm2.unwrap_or(0.0)),
                part("end of the film".to_owned(), &|axis| axis.finite_film_mm2().unwrap_or(0.0)),
            ]
        };
        for (number, share) in axes[0].causes.iter().enumerate() {
            parts.push(part(self.cause(share.cause), &|axis| axis.causes[number].contribution.total_mm2()));
        }
        if !self.is_first_order {
            parts.push(part("causes together".to_owned(), &AxisBudget::together_mm2));
        }
        parts
    }

    /// The mean squares of the splicing pattern without end along x, y, z, in mm^2.
    pub fn endless_pattern_mm2(&self) -> Option<[f64; 3]> {
        let [x, y, z] = self.budget.axes.each_ref().map(|axis| axis.pattern_mm2);
        Some([x?, y?, z?])
    }

    /// The mean squares of a pattern along x, y, z, in mm^2, if the end of the film compensates it
    /// along an axis at least. They may be far larger than the total, and are no parts of it that
    /// could be compared with others.
    pub fn compensated_pattern_mm2(&self) -> Option<[f64; 3]> {
        let mut ends = self.budget.axes.iter().filter_map(AxisBudget::finite_film_mm2);
        self.endless_pattern_mm2().filter(|_| ends.any(|square| square < 0.0))
    }

    /// Mean squares along x, y, z of exact samples, in mm^2.
    pub fn sampled_mm2(&self) -> [f64; 3] {
        self.check.axes.map(|axis| axis.sampled_mm2)
    }

    /// The sum of all parts along x, y, z.
    pub fn totals_mm2(&self) -> [f64; 3] {
        self.budget.axes.each_ref().map(|axis| axis.total_mm2)
    }

    /// A cause in words.
    pub fn cause(&self, cause: Cause) -> String {
        match cause {
            Cause::PositionInPlane => "tile positions, x and y".to_owned(),
            Cause::PositionZ => "tile positions, z".to_owned(),
            Cause::Rotation => "tile rotations".to_owned(),
            Cause::Size => "tile sizes".to_owned(),
            Cause::Strength => "tile strengths".to_owned(),
            Cause::Direction => "tile directions of J".to_owned(),
            Cause::Group(group) => {
                let groups = self.layout.tolerance.as_ref().map(|tolerance| &tolerance.groups);
                let name = groups.and_then(|groups| groups.get(group)).map_or("", |group| &group.name);
                format!("group {name}")
            }
            Cause::FilmPose => "pose of the film".to_owned(),
            Cause::StrayField => "stray field".to_owned(),
            Cause::Neighbour => "neighbouring film".to_owned(),
            Cause::Temperature => "temperature".to_owned(),
            Cause::SensorOffset => "sensor offset".to_owned(),
            Cause::SensorRotation => "sensor rotation".to_owned(),
            Cause::SensorGain => "sensor gain".to_owned(),
            Cause::SensorNoise => "sensor noise".to_owned(),
            other => format!("{other:?}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A layout of four squares, with errors of their positions in millimetres.
    fn layout(position_mm: f64) -> Layout {
        let text = format!(
            "format = 1\nname = \"four squares\"\n\
             [ideal]\nwavelength_mm = 10.0\nthickness_mm = 1.0\namplitude_t = 0.12\n\
             [volume]\nx_mm = [-1, 1]\ny_mm = [-1, 1]\nz_mm = [-4, -3]\nstep_mm = 0.5\n\
             [tolerance]\nposition_mm = {position_mm}\n\
             [[tile]]\nposition_mm = [2.5, 2.5, 0.5]\nsize_mm = [3.3, 3.3, 1.0]\npolarization_t = [0.08, 0.08, 0.0]\n\
             mirror = {{ axes = [\"x\", \"y\"] }}\n"
        );
        Layout::parse(&text, "layout").unwrap()
    }

    #[test]
    fn parts_add_up_to_the_total_to_first_order_and_by_samples() {
        for (position_mm, is_first_order) in [(0.01, true), (0.8, false)] {
            let layout = layout(position_mm);
            let found = Film::new(layout.clone()).unwrap().budget(1, 100).unwrap();
            assert_eq!(found.is_first_order, is_first_order);
            let names: Vec<String> = found.parts().into_iter().map(|part| part.name).collect();
            assert!(names.contains(&"tile positions, z".to_owned()), "{names:?}");
            assert_eq!(names.last().unwrap() == "causes together", !is_first_order);
            for (axis, total) in found.totals_mm2().into_iter().enumerate() {
                let sum: f64 = found.parts().iter().map(|part| part.mean_squares_mm2[axis]).sum();
                assert!((sum - total).abs() <= 1e-12 * total, "{sum} {total}");
            }
        }
    }
}
