//! The causes of the displacement error of films as made.

use magsplice_decouple::{Figures, PerAxis};
use magsplice_layout::Layout;
use magsplice_tolerance::{AxisBudget, Budget, Cause, EndlessPattern, Estimate, FirstOrder, SampleError, Sampler};
use serde::Serialize;

use super::source::Source;
use crate::film::Film;
use crate::film_error::FilmError;

/// Bytes of 64 pairs of samples for each point of the volume, and of a sampler.
const BYTES_OF_SAMPLES: f64 = 64.0 * 48.0 + 176.0;

/// Bytes of the derivatives by the twelve errors of a tile for each point, twice. Measured with 20
/// samples and four tiles: 3518 in all.
const BYTES_PER_TILE: f64 = 12.0 * 48.0;

/// The error budget of a film: mean squares of the displacement error, which add up.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FilmBudget {
    /// The film.
    #[serde(flatten)]
    pub source: Source,
    /// Seed of the samples.
    pub seed: u64,
    /// Number of samples.
    pub samples: u64,
    /// Whether the first order gave the parts; otherwise samples of each cause alone did.
    pub is_first_order: bool,
    /// All parts, whose sum is the total.
    pub parts: Vec<BudgetPart>,
    /// The splicing pattern without end. `None` if it is not known.
    pub endless_pattern_mm2: Option<PerAxis>,
    /// Why it is not known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub no_pattern: Option<String>,
    /// The sum of all parts.
    pub total_mm2: PerAxis,
    /// The same by exact samples.
    pub sampled_mm2: PerAxis,
    /// The expected mean square of exact samples over the first order. `None` without any error.
    pub mean_square_ratio: PerAxis<Option<Estimate>>,
    /// Causes that are worth halving, the one that saves most first.
    pub worth_halving: Vec<Improvement>,
    /// Tiles whose errors are worth halving, the one that saves most first.
    pub tiles_worth_halving: Vec<Improvement>,
    /// The splicing pattern without end, if the end of the film compensates it along an axis at
    /// least. It may be far larger than the total, and is then no part of it.
    #[serde(skip)]
    pub compensated_pattern_mm2: Option<PerAxis>,
}

/// A part of a budget.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BudgetPart {
    /// Its cause, in words.
    pub name: String,
    /// The mean square. It is negative where it compensates other parts.
    pub mean_square_mm2: PerAxis,
    /// Its share of the total; 0 of a total of 0.
    pub share: PerAxis,
}

/// What is saved if errors are halved.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Improvement {
    /// The cause in words, or the tile.
    pub name: String,
    /// By how much the total falls.
    pub saved_mm2: PerAxis,
}

impl Film {
    /// The causes of the displacement error of films as made. `samples` exact samples, at least
    /// one, check the first-order budget, or replace it where it is not valid.
    ///
    /// # Errors
    /// If the layout has no ideal film, no working volume or no errors, or a sample has no
    /// displacement errors.
    pub fn budget(&self, seed: u64, samples: u64) -> Result<FilmBudget, FilmError> {
        let layout = self.layout();
        let tiles = layout.tiles.len() as f64;
        let volume = self.evaluation_grid(BYTES_OF_SAMPLES + BYTES_PER_TILE * tiles)?;
        let (real, ideal) = (self.real_film()?, self.ideal()?);
        let of_sample = |(sample, error): (u64, SampleError)| FilmError::Sample { sample, error };
        let in_film = real.in_film(real.tiles()).map_err(|faults| of_sample((0, SampleError::Tile(faults))))?;
        let of_pattern = |pattern: EndlessPattern| match self.head() {
            Some(head) => pattern.errors_of_head(&volume, head),
            None => pattern.errors(&volume),
        };
        let pattern: Result<Figures, String> = match layout.iron.is_empty() {
            true => EndlessPattern::new(&in_film, ideal).and_then(of_pattern).map_err(|error| error.to_string()),
            false => Err("the ideal film has no iron behind it".to_owned()),
        };
        let model = FirstOrder::new(&real, &volume, ideal).map_err(|error| of_sample((0, error)))?;
        let sampler = Sampler::new(&real, &volume, ideal, seed).map_err(|error| of_sample((0, error)))?;
        let counted = self.counting("budget", None, "samples");
        let check = model.check(&sampler, 0..samples, &counted).map_err(of_sample)?;
        let is_first_order = check.axes.iter().all(|axis| axis.mean_square_is_valid());
        let budget = if is_first_order {
            Budget::new(&model, pattern.as_ref().ok())
        } else {
            let pattern = pattern.as_ref().ok();
            Budget::from_samples(&real, &volume, ideal, pattern, seed, 0..samples, &counted).map_err(of_sample)?
        };
        let [x, y, z] = budget.axes.each_ref().map(|axis| axis.pattern_mm2);
        let endless_pattern_mm2 = x.zip(y).zip(z).map(|((x, y), z)| PerAxis { x, y, z });
        // The end of the film compensates a pattern where it adds a negative mean square.
        let is_compensated = budget.axes.iter().any(|axis| axis.finite_film_mm2().is_some_and(|square| square < 0.0));
        let compensated_pattern_mm2 = endless_pattern_mm2.filter(|_| is_compensated);
        let with_pattern = endless_pattern_mm2.is_some() && !is_compensated;
        let improvement = |name: String, saved_mm2: [f64; 3]| Improvement { name, saved_mm2: saved_mm2.into() };
        Ok(FilmBudget {
            source: Source::of(self),
            seed,
            samples,
            is_first_order,
            parts: parts(layout, &budget, is_first_order, with_pattern),
            endless_pattern_mm2,
            no_pattern: pattern.err(),
            total_mm2: budget.axes.each_ref().map(|axis| axis.total_mm2).into(),
            sampled_mm2: check.axes.map(|axis| axis.sampled_mm2).into(),
            mean_square_ratio: check.axes.map(|axis| axis.mean_square_ratio).into(),
            worth_halving: budget
                .causes
                .iter()
                .map(|item| improvement(cause(layout, item.of), item.saved_mm2))
                .collect(),
            tiles_worth_halving: budget
                .tiles
                .iter()
                .map(|item| improvement(layout.tiles[item.of].name.clone(), item.saved_mm2))
                .collect(),
            compensated_pattern_mm2,
        })
    }
}

/// All parts, whose sum is the total. The pattern and the end of the film are parts if
/// `with_pattern`, else the film as ordered.
fn parts(layout: &Layout, budget: &Budget, is_first_order: bool, with_pattern: bool) -> Vec<BudgetPart> {
    let axes = &budget.axes;
    let part = |name: &str, of: &dyn Fn(&AxisBudget) -> f64| {
        let share = |axis: &AxisBudget| if axis.total_mm2 > 0.0 { of(axis) / axis.total_mm2 } else { 0.0 };
        BudgetPart {
            name: name.to_owned(),
            mean_square_mm2: axes.each_ref().map(of).into(),
            share: axes.each_ref().map(share).into(),
        }
    };
    let mut parts = if with_pattern {
        vec![
            part("splicing pattern", &|axis| axis.pattern_mm2.unwrap_or(0.0)),
            part("end of the film", &|axis| axis.finite_film_mm2().unwrap_or(0.0)),
        ]
    } else {
        vec![part("film as ordered", &|axis| axis.nominal_mm2)]
    };
    for (number, share) in axes[0].causes.iter().enumerate() {
        parts.push(part(&cause(layout, share.cause), &|axis| axis.causes[number].contribution.total_mm2()));
    }
    if !is_first_order {
        parts.push(part("causes together", &AxisBudget::together_mm2));
    }
    parts
}

/// A cause in words.
fn cause(layout: &Layout, cause: Cause) -> String {
    let words = match cause {
        Cause::PositionInPlane => "tile positions, x and y",
        Cause::PositionZ => "tile positions, z",
        Cause::Rotation => "tile rotations",
        Cause::Size => "tile sizes",
        Cause::Strength => "tile strengths",
        Cause::Direction => "tile directions of J",
        Cause::Group(group) => {
            let groups = layout.tolerance.as_ref().map(|tolerance| &tolerance.groups);
            let name = groups.and_then(|groups| groups.get(group)).map_or("", |group| &group.name);
            return format!("group {name}");
        }
        Cause::FilmPose => "pose of the film",
        Cause::StrayField => "stray field",
        Cause::Neighbour => "neighbouring film",
        Cause::Temperature => "temperature",
        Cause::Iron => "iron nearby",
        Cause::SensorOffset => "sensor offset",
        Cause::SensorRotation => "sensor rotation",
        Cause::SensorGain => "sensor gain",
        Cause::SensorPosition => "sensor place",
        Cause::SensorNoise => "sensor noise",
        other => return format!("{other:?}"),
    };
    words.to_owned()
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
            let found = Film::new(layout(position_mm)).unwrap().budget(1, 100).unwrap();
            assert_eq!(found.is_first_order, is_first_order);
            let names: Vec<&str> = found.parts.iter().map(|part| part.name.as_str()).collect();
            assert!(names.contains(&"tile positions, z"), "{names:?}");
            assert_eq!(*names.last().unwrap() == "causes together", !is_first_order);
            for (axis, total) in found.total_mm2.to_array().into_iter().enumerate() {
                let sum: f64 = found.parts.iter().map(|part| part.mean_square_mm2.to_array()[axis]).sum();
                assert!((sum - total).abs() <= 1e-12 * total, "{sum} {total}");
                let shares: f64 = found.parts.iter().map(|part| part.share.to_array()[axis]).sum();
                assert!((shares - 1.0).abs() < 1e-12, "{shares}");
            }
        }
    }
}
