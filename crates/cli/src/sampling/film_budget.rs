//! Results of `budget`: where the displacement error comes from, and whether the first order holds.

use magsplice::FilmRecoil;
use magsplice::layout::Layout;
use magsplice::tolerance::{
    AxisBudget, Budget, Cause, EndlessPattern, FilmErrors, FirstOrder, FirstOrderCheck, SampleError,
};

use super::scene::SampledScene;
use crate::failure::Failure;

/// A film with its budget.
pub(crate) struct FilmBudget<'a> {
    pub(crate) layout: &'a Layout,
    pub(crate) recoil: Option<FilmRecoil>,
    pub(crate) budget: Budget,
    pub(crate) seed: u64,
    pub(crate) samples: u64,
    /// The comparison of the first order with exact samples.
    pub(crate) check: FirstOrderCheck,
    /// Whether the first order gave the budget; otherwise samples did.
    pub(crate) is_first_order: bool,
    /// Why the error of the splicing pattern is not known, if it is not.
    pub(crate) no_pattern: Option<String>,
    /// Mean squares along x, y, z of exact samples, in mm^2.
    pub(crate) sampled_mm2: [f64; 3],
}

/// A part of a budget along one axis.
pub(crate) struct BudgetPart {
    pub(crate) name: String,
    /// Along x, y, z, in mm^2. It is negative where it compensates other parts.
    pub(crate) mean_squares_mm2: [f64; 3],
}

impl<'a> FilmBudget<'a> {
    pub(crate) fn new(scene: &SampledScene<'a>, seed: u64, samples: u64) -> Result<FilmBudget<'a>, Failure> {
        let failed = |error: SampleError| scene.failure(&error);
        let of_sample = |(sample, error): (u64, SampleError)| scene.sample_failure(sample, &error);
        let ideal = scene.ideal()?;
        let in_film = scene.real().in_film(scene.real().tiles()).map_err(|faults| failed(SampleError::Tile(faults)))?;
        let pattern: Result<FilmErrors, String> = EndlessPattern::new(&in_film, ideal)
            .and_then(|pattern| pattern.errors(scene.volume()))
            .map_err(|error| error.to_string());
        let model = FirstOrder::new(scene.real(), scene.volume(), ideal).map_err(failed)?;
        let sampler = scene.sampler(seed)?;
        let check = model.check(&sampler, 0..samples).map_err(of_sample)?;
        let errors = sampler.errors_of_range(0..samples).map_err(of_sample)?;
        let mean_square = |axis: usize| {
            errors.iter().map(|errors| errors.displacement_rmse_mm[axis].powi(2)).sum::<f64>() / samples as f64
        };
        let is_first_order = check.axes.iter().all(|axis| axis.mean_square_is_valid());
        let budget = if is_first_order {
            Budget::new(&model, pattern.as_ref().ok())
        } else {
            Budget::from_samples(scene.real(), scene.volume(), ideal, pattern.as_ref().ok(), seed, 0..samples)
                .map_err(of_sample)?
        };
        Ok(FilmBudget {
            layout: scene.layout(),
            recoil: scene.recoil().cloned(),
            budget,
            seed,
            samples,
            check,
            is_first_order,
            no_pattern: pattern.err(),
            sampled_mm2: [0, 1, 2].map(mean_square),
        })
    }

    /// All parts, whose sum is the total.
    pub(crate) fn parts(&self) -> Vec<BudgetPart> {
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
    pub(crate) fn endless_pattern_mm2(&self) -> Option<[f64; 3]> {
        let [x, y, z] = self.budget.axes.each_ref().map(|axis| axis.pattern_mm2);
        Some([x?, y?, z?])
    }

    /// Those of a pattern that the end of the film compensates, along an axis at least. They may be far
    /// larger than the total, and are no parts of it that could be compared with others.
    pub(crate) fn compensated_pattern_mm2(&self) -> Option<[f64; 3]> {
        let mut ends = self.budget.axes.iter().filter_map(AxisBudget::finite_film_mm2);
        self.endless_pattern_mm2().filter(|_| ends.any(|square| square < 0.0))
    }

    /// The sum of all parts along x, y, z.
    pub(crate) fn totals_mm2(&self) -> [f64; 3] {
        self.budget.axes.each_ref().map(|axis| axis.total_mm2)
    }

    /// A cause in words.
    pub(crate) fn cause(&self, cause: Cause) -> String {
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
