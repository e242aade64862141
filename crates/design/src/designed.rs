//! A film found, as a layout.

use glam::DVec3;
use magsplice_decouple::PerParameter;
use magsplice_layout::{Expectations, Layout};

use crate::figures::Figures;
use crate::search::Outcome;
use crate::setting::Setting;

/// Expectations leave this much to what is measured, as a fraction: round-off and other points.
const ROOM: f64 = 0.01;

/// Ends the names of films that were searched for.
const DESIGNED: &str = ", designed";

impl Setting<'_> {
    /// The layout of a film found: the tiles, what it reached as what it must meet, and a line of history. `program` is who found it, such as "magsplice 1.0 design".
    ///
    /// A baseline of the field is left out, since it belongs to the film before, and so are tiles whose strength has become 0.
    pub fn layout_of(&self, outcome: &Outcome, program: &str) -> Layout {
        let mut layout = self.layout.clone();
        for (named, tile) in layout.tiles.iter_mut().zip(&outcome.tiles) {
            (named.tile, named.kind) = (*tile, None);
        }
        // A tile without polarization is none.
        layout.tiles.retain(|named| named.tile.polarization_t() != DVec3::ZERO);
        if !layout.name.ends_with(DESIGNED) {
            layout.name += DESIGNED;
        }
        // What its author says is of the film before.
        layout.description = None;
        let PerParameter { r_x, r_y, s_z } = outcome.after.uniformity_rmse;
        layout.expectations = Expectations {
            uniformity_rmse: [r_x, r_y, s_z].map(|reached| Some(up_to_three_digits(reached * (1.0 + ROOM)))),
            displacement_rmse_mm: self
                .displacement_mm(&outcome.after)
                .map(|reached| Some(up_to_three_digits(reached * (1.0 + ROOM)))),
            least_amplitude: Some((outcome.after.amplitude * 1e4).floor() / 1e4),
            field: None,
            ..layout.expectations
        };
        layout.brief = Some(self.brief.clone());
        layout.history.push(self.told_of(outcome, program));
        layout
    }

    /// Errors of displacement along x, y, z.
    pub fn displacement_mm(&self, figures: &Figures) -> [f64; 3] {
        figures.ideal_rmse.as_lengths(self.ideal.wavenumber()).to_array()
    }

    /// Uniformity errors as displacements along x, y, z.
    pub fn uniformity_mm(&self, figures: &Figures) -> [f64; 3] {
        figures.uniformity_rmse.as_lengths(self.ideal.wavenumber()).to_array()
    }

    fn told_of(&self, outcome: &Outcome, program: &str) -> String {
        let errors = |figures: &Figures| {
            let PerParameter { r_x, r_y, s_z } = figures.uniformity_rmse;
            let [x, y, z] = self.displacement_mm(figures);
            format!(
                "uniformity RMSE {r_x:.3e}, {r_y:.3e}, {s_z:.3e}, displacement RMSE {x:.3e}, {y:.3e}, {z:.3e} mm, amplitude {:.4}",
                figures.amplitude
            )
        };
        format!(
            "{program}: from \"{}\" (sha256 {}), {} free numbers, {} starts, seed {}: {} -> {}",
            self.layout.name,
            &self.layout.sha256[..12],
            self.free(),
            self.brief.starts,
            self.brief.seed,
            errors(&outcome.before),
            errors(&outcome.after)
        )
    }
}

/// Three digits, not less than the value.
fn up_to_three_digits(value: f64) -> f64 {
    if !(value > 0.0 && value.is_finite()) {
        return value;
    }
    let unit = value.log10().floor() as i32 - 2;
    let digits = (value / 10_f64.powi(unit)).ceil();
    // By its decimals, so that it is written as short as it is meant.
    format!("{digits}e{unit}").parse().unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::up_to_three_digits;

    #[test]
    fn bounds_are_short_and_not_less() {
        assert_eq!(up_to_three_digits(0.0012341), 0.00124);
        assert_eq!(up_to_three_digits(9.999e-6), 1e-5);
        assert_eq!(up_to_three_digits(0.0), 0.0);
    }
}
