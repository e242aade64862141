//! What is to become small, as a sum of squares, with derivatives.

use glam::DVec3;
use magsplice_decouple::{Branch, ParameterSlopes, Parameters};
use magsplice_field::IdealFilm;
use magsplice_layout::Goal;

use crate::pattern::half_turn;
use crate::sampling::{Field, Sampling};
use crate::symmetry::Operation;

/// Errors over the points of a sampling.
#[derive(Clone, Debug)]
pub(crate) struct Objective {
    pub(crate) goal: Goal,
    pub(crate) weights: [f64; 3],
    pub(crate) ideal: IdealFilm,
    /// B of the ideal film at the computed points.
    pub(crate) ideal_field_t: Vec<DVec3>,
    /// What the field is to be of it, where the field is the goal; else the least amplitude there is to be, if any.
    pub(crate) amplitude: Option<f64>,
    /// For each grid on which an amplitude is asked for, how much each point of the sampling counts.
    pub(crate) amplitude_weights: Vec<Vec<f64>>,
}

/// The errors of a film: their squares add up to what is to become small.
#[derive(Clone, Debug)]
pub(crate) struct Errors {
    pub(crate) values: Vec<f64>,
    /// Their derivatives, variable fastest.
    pub(crate) slopes: Vec<f64>,
    /// The best-fit amplitudes over the grids they are asked for on, with their derivatives.
    pub(crate) amplitudes: Vec<(f64, Vec<f64>)>,
}

impl Errors {
    /// Half the sum of squares.
    pub(crate) fn loss(&self) -> f64 {
        0.5 * self.values.iter().map(|v| v * v).sum::<f64>()
    }
}

impl Objective {
    /// `None` where B_z = 0 at some point, so that the parameters do not exist.
    pub(crate) fn errors(&self, sampling: &Sampling, field: &Field) -> Option<Errors> {
        let amplitudes =
            self.amplitude_weights.iter().map(|weights| self.amplitude(weights, sampling, field)).collect();
        let (values, slopes) = match self.goal {
            Goal::Field => self.field_errors(sampling, field),
            Goal::Uniformity => self.uniformity_errors(sampling, field)?,
            Goal::Displacement => self.displacement_errors(sampling, field)?,
        };
        Some(Errors { values, slopes, amplitudes })
    }

    fn amplitude(&self, weights: &[f64], sampling: &Sampling, field: &Field) -> (f64, Vec<f64>) {
        let (mut product, mut square) = (0.0, 0.0);
        let mut slopes = vec![0.0; field.variables];
        for (&(index, _), weight) in sampling.images().iter().zip(weights) {
            let ideal = self.ideal_field_t[index];
            product += weight * ideal.dot(field.flux_density_t[index]);
            square += weight * ideal.length_squared();
            for (slope, by) in slopes.iter_mut().zip(field.slopes_at(index)) {
                *slope += weight * ideal.dot(*by);
            }
        }
        slopes.iter_mut().for_each(|slope| *slope /= square);
        (product / square, slopes)
    }

    /// Each component of B minus that of the ideal film, relative to the root mean square of the latter.
    fn field_errors(&self, sampling: &Sampling, field: &Field) -> (Vec<f64>, Vec<f64>) {
        let wanted = self.amplitude.unwrap_or(1.0);
        let square: f64 = sampling.images().iter().map(|&(index, _)| self.ideal_field_t[index].length_squared()).sum();
        let factor = 1.0 / (wanted * square.sqrt());
        let (mut values, mut slopes) = (Vec::new(), Vec::new());
        for &(index, _) in sampling.images() {
            let error = factor * (field.flux_density_t[index] - wanted * self.ideal_field_t[index]);
            for axis in 0..3 {
                values.push(error[axis]);
                slopes.extend(field.slopes_at(index).iter().map(|by| factor * by[axis]));
            }
        }
        (values, slopes)
    }

    /// For each parameter and each plane normal to its axis, the differences from the mean over the plane.
    fn uniformity_errors(&self, sampling: &Sampling, field: &Field) -> Option<(Vec<f64>, Vec<f64>)> {
        let (parameters, slopes, _) = self.parameters(sampling, field)?;
        let (grid, n) = (&sampling.grid, field.variables);
        let mut values = vec![0.0; parameters.len()];
        let mut errors = vec![0.0; slopes.len()];
        for axis in 0..3 {
            let factor = self.weights[axis] / (grid.len() as f64).sqrt();
            let points = (grid.len() / grid.counts()[axis]) as f64;
            for plane in 0..grid.counts()[axis] {
                let rows = || (0..grid.len()).filter(|&i| grid.indices(i)[axis] == plane).map(|i| 3 * i + axis);
                let mean = rows().map(|row| parameters[row]).sum::<f64>() / points;
                let mut mean_slopes = vec![0.0; n];
                for row in rows() {
                    add(&mut mean_slopes, 1.0 / points, &slopes[row * n..][..n]);
                }
                for row in rows() {
                    values[row] = factor * (parameters[row] - mean);
                    let into = &mut errors[row * n..][..n];
                    for ((error, slope), mean) in into.iter_mut().zip(&slopes[row * n..][..n]).zip(&mean_slopes) {
                        *error = factor * (slope - mean);
                    }
                }
            }
        }
        Some((values, errors))
    }

    /// The changes of the parameters from the reference point minus those of the ideal film, over k.
    fn displacement_errors(&self, sampling: &Sampling, field: &Field) -> Option<(Vec<f64>, Vec<f64>)> {
        let (parameters, slopes, reference) = self.parameters(sampling, field)?;
        let (grid, n, k) = (&sampling.grid, field.variables, self.ideal.wavenumber());
        let (at_reference, reference_slopes) = reference;
        let mut values = vec![0.0; parameters.len()];
        let mut errors = vec![0.0; slopes.len()];
        for (index, point) in grid.points().enumerate() {
            let ideal = k * (point - sampling.reference) * DVec3::new(-1.0, -1.0, 1.0);
            for axis in 0..3 {
                let row = 3 * index + axis;
                let factor = self.weights[axis] / (grid.len() as f64).sqrt() / k;
                let change = parameters[row] - at_reference[axis] - ideal[axis];
                values[row] = factor * if axis < 2 { half_turn(change) } else { change };
                let into = &mut errors[row * n..][..n];
                add(into, factor, &slopes[row * n..][..n]);
                add(into, -factor, &reference_slopes[axis * n..][..n]);
            }
        }
        Some((values, errors))
    }

    /// R_x, R_y, S_z at the points of the grid, parameter fastest, with derivatives; the same at the reference point.
    #[allow(clippy::type_complexity)]
    fn parameters(&self, sampling: &Sampling, field: &Field) -> Option<(Vec<f64>, Vec<f64>, ([f64; 3], Vec<f64>))> {
        let n = field.variables;
        let last = field.flux_density_t.len() - 1;
        let branch = Branch::from_axis_field(field.flux_density_t[last])?;
        let (mut values, mut slopes) = (Vec::new(), Vec::new());
        let mut append = |index: usize, operation: Operation| {
            let b = operation.of(field.flux_density_t[index]);
            let (p, ParameterSlopes { r_x, r_y, s_z }) = Parameters::with_slopes(b, branch)?;
            values.extend([p.r_x, p.r_y, p.s_z]);
            for by_b in [r_x, r_y, s_z] {
                let back = operation.inverse().of(by_b);
                slopes.extend(field.slopes_at(index).iter().map(|by| back.dot(*by)));
            }
            Some(())
        };
        append(last, Operation::IDENTITY)?;
        for &(index, operation) in sampling.images() {
            append(index, operation)?;
        }
        let reference = [values[0], values[1], values[2]];
        let reference_slopes = slopes[..3 * n].to_vec();
        values.drain(..3);
        slopes.drain(..3 * n);
        Some((values, slopes, (reference, reference_slopes)))
    }
}

fn add(into: &mut [f64], factor: f64, row: &[f64]) {
    for (sum, value) in into.iter_mut().zip(row) {
        *sum += factor * value;
    }
}

#[cfg(test)]
mod tests {
    use crate::setting::Setting;
    use magsplice_layout::{Goal, Layout};

    /// Everything free at once, no symmetry lost on it: central differences in every variable, for every goal.
    ///
    /// With steps of 1e-5 of a millimetre, a radian or a tesla times the strength the differences are off by the third derivative times 1e-10 and by round-off over 1e-5: below 1e-7
    /// of the largest slope of a variable.
    #[test]
    fn slopes_are_derivatives() {
        let text = |design: &str, tiles: &str| {
            format!(
                "format = 1\nname = \"film\"\n[ideal]\nwavelength_mm = 10.0\nthickness_mm = 1.0\namplitude_t = 0.12\n[volume]\nx_mm = [-1.5, 2.0]\ny_mm = [-1.0, 1.0]\n\
                 z_mm = [-5.0, -3.0]\nstep_mm = 1.0\n[design]\n{design}\nthickness_mm = {{ min = 0.5, max = 2.0 }}\nstrength_t = {{ min = 0.0, max = 1.0 }}\n{tiles}"
            )
        };
        let mirrored = "[[tile]]\nposition_mm = [2.5, 2.3, 0.5]\nsize_mm = [3.0, 2.0, 1.0]\npolarization_t = [0.12, 0.05, 0.01]\nmirror = { axes = [\"x\", \"y\"] }\n\
                        [[tile]]\nposition_mm = [6.0, 0.0, 0.6]\nsize_mm = [2.0, 1.0, 1.2]\npolarization_t = [-0.1, 0.0, 0.02]\nmirror = { axes = [\"x\"] }\n";
        let alone = "[[tile]]\nposition_mm = [1.5, 0.3, 0.5]\nsize_mm = [3.0, 2.0, 1.0]\npolarization_t = [0.12, 0.05, 0.01]\n\
                     [[tile]]\nposition_mm = [-2.0, -0.4, 0.5]\nsize_mm = [2.0, 2.5, 1.0]\npolarization_t = [-0.1, 0.03, 0.0]\n";
        let all = "\"thickness\", \"direction\", \"tilt\", \"strength\"]";
        for (vary, symmetry, tiles) in [
            (format!("vary = [\"size\", \"position\", {all}"), "mirror", mirrored),
            (format!("vary = [\"cut\", {all}"), "mirror", mirrored),
            (format!("vary = [\"size\", {all}"), "none", alone),
            (format!("vary = [\"position\", {all}"), "none", alone),
        ] {
            for goal in [Goal::Uniformity, Goal::Displacement, Goal::Field] {
                let text = text(
                    &format!("{vary}\nsymmetry = \"{symmetry}\"\nweights = {{ r_x = 1.0, r_y = 2.0, s_z = 0.5 }}"),
                    tiles,
                );
                let layout = Layout::parse(&text, "test").unwrap_or_else(|e| panic!("{e}"));
                let mut brief = layout.brief.clone().unwrap();
                brief.goal = goal;
                let setting = Setting::with_brief(&layout, brief).unwrap();
                assert!(setting.free() >= 8, "{}", setting.free());
                let (pattern, sampling) = (&setting.pattern, &setting.problem.sampling);
                let errors = |at: &[f64], with_slopes: bool| {
                    setting
                        .problem
                        .objective
                        .errors(sampling, &sampling.field(pattern, at, with_slopes).unwrap())
                        .unwrap()
                };
                let at = &pattern.start;
                let (here, n) = (errors(at, true), at.len());
                for variable in 0..n {
                    let h = 1e-5;
                    let moved = |by: f64| {
                        let mut at = at.clone();
                        at[variable] += by;
                        errors(&at, false)
                    };
                    let [above, below] = [h, -h].map(moved);
                    let slopes: Vec<f64> = here.slopes.iter().skip(variable).step_by(n).copied().collect();
                    let largest = slopes.iter().fold(0.0_f64, |most, slope| most.max(slope.abs()));
                    assert!(largest > 0.0, "variable {variable} of {vary} changes nothing");
                    for (row, slope) in slopes.iter().enumerate() {
                        let difference = (above.values[row] - below.values[row]) / (2.0 * h);
                        assert!(
                            (difference - slope).abs() <= 1e-6 * largest,
                            "{goal:?}, variable {variable} of {vary}, row {row}: {difference} is not {slope}"
                        );
                    }
                    for (index, (_, slopes)) in here.amplitudes.iter().enumerate() {
                        let difference = (above.amplitudes[index].0 - below.amplitudes[index].0) / (2.0 * h);
                        assert!((difference - slopes[variable]).abs() <= 1e-7 * slopes[variable].abs().max(1e-2));
                    }
                }
            }
        }
    }

    /// Amplitudes by weights are those over the other grid.
    #[test]
    fn weights_stand_for_a_finer_grid() {
        let layout = Layout::read("../../layouts/published-film.toml".as_ref()).unwrap_or_else(|e| panic!("{e}"));
        let setting = Setting::of(&layout).unwrap();
        let field = setting.problem.sampling.field(&setting.pattern, &setting.pattern.start, false).unwrap();
        let errors = setting.problem.objective.errors(&setting.problem.sampling, &field).unwrap();
        let exact = crate::Figures::of(
            &layout.bare_tiles(),
            &setting.finer_grid(),
            layout.volume.unwrap().reference_mm,
            &layout.ideal.unwrap(),
        );
        let exact = exact.unwrap().amplitude;
        // The coarse grid and the finer one differ by 7e-3.
        assert!((errors.amplitudes[1].0 - exact).abs() < 2e-5, "{} is not {exact}", errors.amplitudes[1].0);
        assert!((errors.amplitudes[0].0 - exact).abs() > 1e-4, "the grids differ");
    }

    /// Symmetry saves points and changes nothing.
    #[test]
    fn images_of_points_have_the_images_of_the_field() {
        let layout = Layout::read("../../layouts/published-film.toml".as_ref()).unwrap_or_else(|e| panic!("{e}"));
        let setting = Setting::of(&layout).unwrap();
        let sampling = &setting.problem.sampling;
        assert_eq!(sampling.grid.len(), 405);
        // 15 points of an eighth of each plane, and the reference.
        assert_eq!(sampling.computed().len(), 15 * 5 + 1);
        let field = sampling.field(&setting.pattern, &setting.pattern.start, false).unwrap();
        let scene = magsplice_field::Scene::new(&layout.bare_tiles());
        for (point, &(index, operation)) in sampling.grid.points().zip(sampling.images()) {
            let exact = scene.field(magsplice_field::Quantity::FluxDensity, point).unwrap();
            assert!((operation.of(field.flux_density_t[index]) - exact).length() < 1e-15);
        }
    }
}
