//! Findings about lengths: the tiles beside the ideal film and beside the working volume.

use glam::DVec3;
use magsplice_ideal::IdealFilm;
use magsplice_magnet::{Axis, BoundingBox};

use crate::finding::{Finding, FindingSubject};
use crate::layout::NamedTile;
use crate::plausible::{MAX_LENGTH_RATIO, SHORTEST_WAVELENGTH_MM, doubt, meant_length, short, typed};
use crate::units::decimals;
use crate::volume::WorkingVolume;

/// Distance of the film from z = 0 that is accepted, as a fraction of the wavelength. It changes
/// the field by 2 pi times as much, 0.6 %, less than errors of manufacture do.
const STANDS_WITHIN: f64 = 1e-3;

/// The film's extent as a fraction of the wavelength below which it is no film. A film has at least
/// one wide tile, a third of the wavelength; a tenth of that is left for single tiles.
const LEAST_FILM: f64 = 0.03;

/// Largest ratio of the heights of the film and of the ideal film. A film is made thicker or
/// thinner than the ideal one to change its amplitude, but not by so much.
const MAX_HEIGHT_RATIO: f64 = 30.0;

/// Largest ratio of the longest side of the volume to the longest side of the tiles. The sides of a
/// film and of its volume, 20 and 4 mm, have a ratio of 200 if the film is in metres.
const MAX_VOLUME_RATIO: f64 = 150.0;

/// Longest side of all tiles, in mm, below which they were probably meant in m: a film or an array
/// of 100 mm, or of any smaller size. Magnets that are handled have tenths of a millimetre.
const SMALLEST_FILM_MM: f64 = 0.1;

/// Distance of the volume from the film that is too small for a sensor, as a fraction of the
/// wavelength. Half of the harmonic of order 11 reaches it: the field shows every seam, and has
/// little in common with a sinusoid. No chip in its package comes so near to a film of 10 mm.
const LEAST_DISTANCE: f64 = 0.01;

/// Distance of the reference point from the axis of the film that counts, in half wavelengths: a
/// hundredth is that of an inaccurate stage.
const OFF_AXIS: f64 = 0.05;

/// Findings about the volume, and about the ideal film.
pub(crate) fn findings(tiles: &[NamedTile], ideal: Option<&IdealFilm>, volume: Option<&WorkingVolume>) -> Vec<Finding> {
    let near = |volume| about_distance(tiles, ideal?, volume);
    let about_volume = volume.and_then(|volume| about_volume(tiles, volume).or_else(|| near(volume)));
    let about_ideal = ideal.into_iter().flat_map(|ideal| about_ideal_film(tiles, ideal, volume));
    // Other tables are other lengths to compare the tiles with.
    let alone = (volume.is_none() && ideal.is_none()).then(|| about_tiles(tiles)).flatten();
    about_volume.into_iter().chain(about_ideal).chain(alone).collect()
}

/// The finding about tiles that are together smaller than a magnet.
fn about_tiles(tiles: &[NamedTile]) -> Option<Finding> {
    let film = bounds(tiles);
    let extents = film.upper - film.lower;
    let film_mm = extents.max_element();
    (!tiles.is_empty() && film_mm < SMALLEST_FILM_MM).then(|| {
        let message = format!(
            "the film measures {} mm along {}, less than {SMALLEST_FILM_MM} mm: are the tiles in m, not mm?",
            short(film_mm),
            longest_axis(extents)
        );
        Finding::new(FindingSubject::Tiles, message)
    })
}

/// The mean of the lower faces below a height, and three standard deviations, which those of a film
/// as made have.
fn lower_faces_mm(tiles: &[NamedTile], below_mm: f64) -> [f64; 2] {
    let faces: Vec<f64> =
        tiles.iter().map(|named| bounds(std::slice::from_ref(named)).lower.z).filter(|z| *z < below_mm).collect();
    let count = faces.len().max(1) as f64;
    let mean = faces.iter().sum::<f64>() / count;
    [mean, 3.0 * (faces.iter().map(|z| (z - mean).powi(2)).sum::<f64>() / count).sqrt()]
}

/// Findings about the ideal film, and about tiles and volume that it cannot be compared with.
fn about_ideal_film(tiles: &[NamedTile], ideal: &IdealFilm, volume: Option<&WorkingVolume>) -> Vec<Finding> {
    let mut found = Vec::new();
    let mut add = |message: String| found.push(Finding::new(FindingSubject::IdealFilm, message));
    if let Some(doubt) = doubt("ideal: an amplitude_t", ideal.amplitude_t()) {
        add(doubt);
    }
    let (wavelength, thickness) = (ideal.wavelength(), ideal.thickness());
    if wavelength < SHORTEST_WAVELENGTH_MM {
        add(format!(
            "ideal: wavelength_mm = {wavelength} is below {SHORTEST_WAVELENGTH_MM} mm, too short for a spliced film; {}",
            meant_length(wavelength)
        ));
    }
    let is_thin = thickness * MAX_LENGTH_RATIO < wavelength;
    if is_thin {
        add(format!(
            "ideal: thickness_mm = {thickness} is less than a thousandth of the wavelength, {wavelength} mm; {}",
            meant_length(thickness)
        ));
    }
    let film = bounds(tiles);
    let size = film.upper - film.lower;
    let extent = size.x.max(size.y);
    let [stands_at_mm, scatter_mm] = lower_faces_mm(tiles, film.lower.z + 0.5 * size.z);
    if extent < LEAST_FILM * wavelength {
        add(format!(
            "the film measures {} mm along {}, a small fraction of the wavelength of [ideal], {wavelength} mm: are its \
             tiles in m, not mm?",
            short(extent),
            longest_axis(size.with_z(0.0))
        ));
    } else if !is_thin && (size.z > MAX_HEIGHT_RATIO * thickness || size.z * MAX_HEIGHT_RATIO < thickness) {
        let height = short(size.z);
        add(format!("the tiles are {height} mm high and the film of [ideal] {thickness} mm: is one of them in m?"));
    } else if stands_at_mm.abs() > STANDS_WITHIN * wavelength + scatter_mm {
        let [low, high] = [film.lower.z, film.upper.z].map(|z| decimals(z, 6));
        add(format!(
            "the film is at z = {low} .. {high} mm, and the ideal film fills 0 <= z <= {thickness} mm with the sensor \
             below, at z < 0: {}",
            if film.upper.z <= STANDS_WITHIN * wavelength && volume.is_some_and(|v| v.lower_mm.z >= 0.0) {
                "turn the film and the volume over, so that the film stands on z = 0".to_owned()
            } else {
                format!("move the tiles and the volume by {} mm along z", decimals(-stands_at_mm, 6))
            }
        ));
    }
    if let Some(volume) = volume.filter(|volume| volume.upper_mm.z >= 0.0) {
        let [low, high] = [volume.lower_mm.z, volume.upper_mm.z];
        add(format!(
            "volume: z_mm = [{low}, {high}] is not below the film: the ideal film fills 0 <= z <= {thickness} mm, and its \
             field is known for z < 0 only"
        ));
    }
    if let Some(volume) = volume {
        let film = bounds(tiles);
        let beyond = |axis: &Axis| {
            let i = axis.index();
            volume.lower_mm[i] < film.lower[i] || volume.upper_mm[i] > film.upper[i]
        };
        if let Some(axis) = [Axis::X, Axis::Y].into_iter().find(beyond) {
            let i = axis.index();
            let [low, high, of_film, to] =
                [volume.lower_mm[i], volume.upper_mm[i], film.lower[i], film.upper[i]].map(short);
            add(format!(
                "volume: {axis}_mm = [{low}, {high}] reaches beyond the film, which fills {of_film} to {to} mm: the ideal film \
                 has no rim, so the two have little in common there"
            ));
        }
        let apart = |value: f64| (value / (0.5 * wavelength)).rem_euclid(1.0);
        let is_off = |value: f64| apart(value).min(1.0 - apart(value)) > OFF_AXIS;
        let [x, y, _] = volume.reference_mm.to_array();
        if is_off(x) || is_off(y) {
            add(format!(
                "volume: reference_mm = [{}, {}, ...] is not on the axis of the film, nor half wavelengths, {} mm, beside it: \
                 R_x and R_y of the ideal film are not 0 there",
                short(x),
                short(y),
                short(0.5 * wavelength)
            ));
        }
        // One point in each plane normal to an axis, although the planes have an extent.
        let extents = volume.upper_mm - volume.lower_mm;
        let thin = Axis::ALL.into_iter().filter(|axis| {
            let mut of_plane = extents;
            of_plane[axis.index()] = 0.0;
            volume.grid.plane_len(axis.index()) == 1 && of_plane != DVec3::ZERO
        });
        let axes: Vec<&str> = thin.map(Axis::name).collect();
        if !axes.is_empty() {
            let [nx, ny, nz] = volume.grid.counts();
            add(format!(
                "volume: the grid has {nx} x {ny} x {nz} points, only one in each plane normal to {}: the uniformity \
                 RMSE compares points of a plane, so that it has no meaning there; use a smaller step_mm",
                axes.join(", ")
            ));
        }
    }
    found
}

/// Findings about a volume that is far too large or too small for the tiles.
fn about_volume(tiles: &[NamedTile], volume: &WorkingVolume) -> Option<Finding> {
    let film = bounds(tiles);
    let (film_extents, volume_extents) = (film.upper - film.lower, volume.upper_mm - volume.lower_mm);
    let (film_mm, volume_mm) = (film_extents.max_element(), volume_extents.max_element());
    let longest = |extents: DVec3| format!("{} mm along {}", short(extents.max_element()), longest_axis(extents));
    let [film, region] = [film_extents, volume_extents].map(longest);
    let message = if film_mm * MAX_VOLUME_RATIO < volume_mm {
        format!(
            "the film measures {film}, and the working volume {region}, more than {MAX_VOLUME_RATIO} times as much: are the \
             tiles in m, not mm?"
        )
    } else if volume_mm > 0.0 && volume_mm * MAX_LENGTH_RATIO < film_mm {
        format!(
            "the working volume measures {region}, and the film {film}, more than {MAX_LENGTH_RATIO} times as much: is the \
             volume in m, not mm?"
        )
    } else {
        return None;
    };
    Some(Finding::new(FindingSubject::Volume, message))
}

/// The finding about a volume below the film that is nearer to it than a sensor can be.
fn about_distance(tiles: &[NamedTile], ideal: &IdealFilm, volume: &WorkingVolume) -> Option<Finding> {
    let film = bounds(tiles);
    let wavelength = ideal.wavelength();
    // Along x and y the volume may be beside the film.
    let apart = (film.lower - volume.upper_mm).max(volume.lower_mm - film.upper).max(DVec3::ZERO).length();
    let distance = film.lower.z - volume.upper_mm.z;
    if !(distance > 0.0 && apart < LEAST_DISTANCE * wavelength) {
        return None;
    }
    let [low, high] = [volume.lower_mm.z, volume.upper_mm.z].map(typed);
    let all_near = film.lower.z - volume.lower_mm.z < LEAST_DISTANCE * wavelength;
    // In metres, the volume is at a distance that a sensor has.
    let meant = (1e3 * distance >= LEAST_DISTANCE * wavelength && all_near).then(|| {
        format!("; did you mean {} .. {} mm, which is {low} .. {high} m?", typed(1e3 * low), typed(1e3 * high))
    });
    Some(Finding::new(
        FindingSubject::Volume,
        format!(
            "volume: z_mm = [{low}, {high}] begins {} mm from the film, nearer than a hundredth of the wavelength, \
             {wavelength} mm{}",
            short(distance),
            meant.unwrap_or_default()
        ),
    ))
}

fn longest_axis(extents: DVec3) -> Axis {
    Axis::ALL[extents.max_position()]
}

/// The box around all tiles.
fn bounds(tiles: &[NamedTile]) -> BoundingBox {
    BoundingBox::from_tiles(tiles.iter().map(|named| &named.tile))
}
