//! The header of a film: its name, tiles, working volume and accuracy.

use std::path::Path;

use magsplice::Film;
use magsplice::layout::{Layout, WorkingVolume};
use magsplice::results::{HeadSummary, IronSummary};

use super::number::counted;
use super::recoil;
use super::units::in_per_cent;

/// Name, tiles, accuracy of their shapes, and hash of a layout.
pub(crate) fn layout(layout: &Layout) -> String {
    let shapes = layout.shape_error.map_or(String::new(), |error| {
        format!(" (discs as strips, right to {:.2} % one radius away)", in_per_cent(error))
    });
    let slices = layout.slice_error.map_or(String::new(), |error| {
        let percent = in_per_cent(error);
        // Far from the film it is round-off.
        let percent = if percent < 1e-9 { "1e-9".to_owned() } else { format!("{percent:.1e}") };
        format!(" (waves in slices, without the ends of the film right to {percent} % in the volume)")
    });
    format!("{}: {}{shapes}{slices}, sha256 {}\n", layout.name, tile_count(layout), &layout.sha256[..12])
}

/// A layout with its iron, and what recoil changes in its field.
pub(crate) fn with_recoil(film: &Film) -> String {
    layout(film.layout()) + &iron(film.layout()) + &recoil(film)
}

/// A film with its working volume, or with a number of points of a file.
pub(crate) fn of_points(of: &Film, given: Option<(&Path, usize)>) -> String {
    match (given, of.volume()) {
        (Some((path, points)), _) => {
            let points = counted(points, "point", "points");
            format!("{}at {points} of {}\n{}", layout(of.layout()), path.display(), accuracy(of))
        }
        (None, Ok(volume)) => film(of, volume),
        (None, Err(_)) => layout(of.layout()) + &accuracy(of),
    }
}

/// A layout with its working volume and the accuracy of its field.
pub(crate) fn film(film: &Film, volume: &WorkingVolume) -> String {
    let (l, u, s) = (volume.lower_mm, volume.upper_mm, volume.step_mm);
    let step = if s.x == s.y && s.x == s.z { format!("{}", s.x) } else { format!("{}, {}, {}", s.x, s.y, s.z) };
    format!(
        "{}working volume: x {} .. {}, y {} .. {}, z {} .. {} mm, step {step} mm, {} points\n{}",
        layout(film.layout()),
        l.x,
        u.x,
        l.y,
        u.y,
        l.z,
        u.z,
        volume.grid.len(),
        accuracy(film)
    )
}

/// The accuracy of a film's field, its iron, and what recoil changes in it.
pub(crate) fn accuracy(film: &Film) -> String {
    let head = HeadSummary::of(film.layout()).map_or(String::new(), |head| format!("sensor: {head}\n"));
    format!("accuracy: {}\n{head}{}{}", film.scene().accuracy(), iron(film.layout()), recoil(film))
}

fn iron(layout: &Layout) -> String {
    IronSummary::of(layout).map_or(String::new(), |iron| format!("iron: {iron}\n"))
}

fn recoil(film: &Film) -> String {
    film.recoil().map_or(String::new(), recoil::line)
}

pub(crate) fn tile_count(layout: &Layout) -> String {
    counted(layout.tiles.len(), "tile", "tiles")
}
