//! `calibrate`: the fitted coefficients.

use std::fmt::Write;

use magsplice::Film;
use magsplice::prelude::DVec3;
use magsplice::sensor::Stiffness;

use super::number::{counted, number};
use super::{header, rows};
use crate::args::sensor::CalibrateArgs;
use crate::sensor::calibration::Calibration;

/// The report of `calibrate`.
pub(crate) fn calibration(film: &Film, args: &CalibrateArgs, calibration: &Calibration) -> String {
    let mut text = header::with_recoil(film.layout(), film.recoil());
    let readings = counted(calibration.readings, "reading", "readings");
    let _ = writeln!(
        text,
        "{}: {readings}; force = stiffness x displacement of the film + force at rest\n",
        args.readings.display()
    );
    rows::heading(&mut text, "displacements by the field of the layout", ["x", "y", "z"]);
    axes(&mut text, &calibration.by_field, calibration.hooke_n_per_mm);
    if let Some(by_closed_form) = &calibration.by_closed_form {
        rows::heading(&mut text, "displacements by the closed form", ["x", "y", "z"]);
        axes(&mut text, by_closed_form, calibration.hooke_n_per_mm);
    }
    text += "intervals hold with 95 % confidence\n";
    text
}

fn axes(text: &mut String, axes: &[Stiffness; 3], hooke_n_per_mm: Option<DVec3>) {
    let row = |text: &mut String, name: &str, of: &dyn Fn(&Stiffness) -> f64| {
        rows::cells(text, name, axes.each_ref().map(|axis| number(of(axis))));
    };
    row(text, "  stiffness, N/mm", &|axis| axis.stiffness);
    row(text, "    +-", &|axis| axis.stiffness_95);
    if let Some(hooke) = hooke_n_per_mm {
        let scale = [0, 1, 2].map(|axis| number(axes[axis].stiffness / hooke[axis]));
        rows::cells(text, "    over Hooke's law of [elastomer]", scale);
    }
    row(text, "  force at rest, N", &|axis| axis.force_at_rest);
    row(text, "    +-", &|axis| axis.force_at_rest_95);
    row(text, "  residual, N", &|axis| axis.residual);
}
