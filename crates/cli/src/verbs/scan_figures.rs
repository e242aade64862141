//! `scan --figures`: measured planes beside the field of the layout.

use std::path::Path;

use magsplice::Film;
use magsplice::prelude::Branch;
use magsplice_report::{Drawing, ReportError, ScanPlane, SvgText, scan_field_figure, scan_parameters_figure};

use crate::args::sensor::ScanArgs;
use crate::failure::Failure;
use crate::output::folder::Folder;
use crate::sensor::scan_planes::ScanPlanes;
use crate::sensor::scanned_film::ScannedFilm;

const FIELDS: [&str; 3] = ["scan-field-lowest", "scan-field-middle", "scan-field-highest"];
const LEVEL: [&str; 3] = ["scan-parameters-lowest", "scan-parameters-middle", "scan-parameters-highest"];
const UPRIGHT: [&str; 2] = ["scan-parameters-upright-y", "scan-parameters-upright-x"];

/// Opens the folder, so that one that cannot be written is refused before any work.
pub(super) fn open(args: &ScanArgs, inputs: &[&Path]) -> Result<Option<Folder>, Failure> {
    args.figures.as_deref().map(|path| Folder::open(path, "scan", inputs)).transpose()
}

/// Draws all figures into the folder.
pub(super) fn draw(args: &ScanArgs, film: &Film, scanned: &ScannedFilm, mut folder: Folder) -> Result<(), Failure> {
    let refused = |message: String| Failure::Points { path: args.scan.clone(), message };
    let branch = match (film.ideal(), film.reference_field_t()) {
        (Ok(_), Ok(reference_t)) => Branch::from_axis_field(reference_t),
        _ => None,
    };
    let planes = ScanPlanes::new(scanned, branch)
        .filter(|planes| !planes.level.is_empty() || !planes.upright.is_empty())
        .ok_or_else(|| {
            refused("--figures needs positions on a grid with equal steps, and two at least along two axes".to_owned())
        })?;
    let drawn = figures(&planes).map_err(|error| Failure::Format(error.to_string()))?;
    for figure in &drawn {
        for (name, contents) in figure.files() {
            folder.write(&name, contents)?;
        }
    }
    folder.finish()
}

fn figures(planes: &ScanPlanes) -> Result<Vec<Drawing>, ReportError> {
    let mut figures = Vec::new();
    // The last of one or two planes is the highest.
    let named = |names: [&'static str; 3]| -> Vec<(&'static str, &ScanPlane)> {
        let names = if planes.level.len() == 2 { vec![names[0], names[2]] } else { names.to_vec() };
        names.into_iter().zip(&planes.level).collect()
    };
    for (name, plane) in named(FIELDS) {
        figures.push(scan_field_figure(plane, name, SvgText::Text)?);
    }
    for (name, plane) in named(LEVEL).into_iter().chain(UPRIGHT.into_iter().zip(&planes.upright)) {
        figures.extend(scan_parameters_figure(plane, name, SvgText::Text)?);
    }
    Ok(figures)
}
