//! The rule that tiles do not overlap. Touching tiles are allowed.

use glam::DVec3;
use magsplice_magnet::{Axis, BoundingBox, Overlap, Tile, TooManyPairs, overlaps_among};

use crate::faults::Faults;
use crate::layout::NamedTile;
use crate::limits::{MAX_LISTED, MAX_OVERLAPS, PAIRS_PER_TILE, SPARE_PAIRS};
use crate::tile::entries::{Entry, Origin, origin};

/// Two entries of the file whose tiles overlap, by index. An entry that overlaps its own images is
/// listed once for each axis that the mirror reflects.
type Between = (usize, usize, Option<usize>);

/// Adds a fault for each pair of entries with tiles that overlap by more than round-off and
/// `allowed_mm`. A pair of tiles that stand in the file is reported before one of images.
pub(crate) fn check(tiles: &[NamedTile], entries: &[Entry], allowed_mm: f64, faults: &mut Faults) {
    let bare: Vec<Tile> = tiles.iter().map(|named| named.tile).collect();
    let most = PAIRS_PER_TILE * tiles.len() + SPARE_PAIRS;
    let mut listed: Vec<(Between, Overlap, [Origin; 2])> = Vec::new();
    let mut more = false;
    // The deepest overlap, while all are shallow.
    let mut shallow_mm = Some(0.0);
    // An allowed depth is a decimal number, and the depth has round-off.
    let most_mm = allowed_mm * (1.0 + DECIMAL_ROUNDING);
    let is_refused = |pair: &Result<Overlap, TooManyPairs>| pair.as_ref().map_or(true, |pair| pair.depth > most_mm);
    for (number, pair) in overlaps_among(&bare, most).filter(is_refused).enumerate() {
        let Ok(pair) = pair else {
            faults.add_to_layout(format!(
                "more than {most} pairs of tiles may overlap, too many to examine: many tiles are in one place (for \
                 example, because their positions differ only beyond the last digit of a number), or are rotated next \
                 to each other"
            ));
            break;
        };
        let ends = [pair.first, pair.second].map(|index| origin(index, entries, tiles.len()));
        let longest = bare[pair.first].size().max(bare[pair.second].size()).max_element();
        shallow_mm = shallow_mm.filter(|_| pair.depth <= SHALLOW * longest).map(|deepest| pair.depth.max(deepest));
        let between = between(ends[0], ends[1]);
        let known = listed.iter().position(|(other, ..)| *other == between);
        let is_full = known.is_none() && listed.len() == MAX_LISTED - 1 - usize::from(shallow_mm.is_some());
        more |= is_full || number > MAX_OVERLAPS;
        if number > MAX_OVERLAPS || is_full && shallow_mm.is_none() {
            break;
        }
        if is_full {
            continue;
        }
        let is_written = |ends: &[Origin; 2]| ends.iter().all(|origin| !origin.is_image());
        match known {
            None => listed.push((between, pair, ends)),
            Some(known) if !is_written(&listed[known].2) && is_written(&ends) => listed[known] = (between, pair, ends),
            Some(_) => {}
        }
    }
    let rule = match allowed_mm > 0.0 {
        true => format!("must be at most overlap_mm = {allowed_mm}"),
        false => "must not overlap without overlap_mm".to_owned(),
    };
    for (between, pair, [first, second]) in listed {
        let place = format!("tile \"{}\"", tiles[second.original].name);
        let message = match between {
            (_, _, Some(axis)) => of_own_image(&tiles[second.original], axis, &entries[second.entry], &pair, &rule),
            _ => of_two(tiles, first, second, &pair, &rule),
        };
        faults.at(entries[second.entry].start, place).add(message);
    }
    if more {
        faults.add_to_layout("more pairs of tiles overlap");
    }
    if let Some(deepest_mm) = shallow_mm.filter(|deepest_mm| *deepest_mm > 0.0) {
        let depth_mm = shown(deepest_mm);
        faults.add_to_layout(format!(
            "tiles overlap by up to {depth_mm} mm, perhaps because their numbers are rounded: overlap_mm = {depth_mm} \
             allows it (in a layout, or `import --overlap {depth_mm}`)"
        ));
    }
}

fn between(first: Origin, second: Origin) -> Between {
    let own = first.original == second.original;
    let axis = (0..3).find(|&axis| own && first.mirrored[axis] != second.mirrored[axis]);
    (first.entry, second.entry, axis)
}

/// A tile that reaches over its mirror normal to `axis`. It must leave this mirror, along the axis:
/// its image moves with it along all others.
fn of_own_image(named: &NamedTile, axis: usize, entry: &Entry, pair: &Overlap, rule: &str) -> String {
    let (name, letter) = (&named.name, Axis::ALL[axis]);
    let mirror_mm = entry.mirror.map_or(0.0, |mirror| mirror.at_mm[axis]);
    let bounds = BoundingBox::from_tile(&named.tile);
    let distance = named.tile.position()[axis] - mirror_mm;
    let reach = 0.5 * (bounds.upper[axis] - bounds.lower[axis]);
    let move_mm = three_digits_up((reach - distance.abs()).max(0.5 * pair.depth));
    let depth_mm = three_digits_up(2.0 * (reach - distance.abs()).max(0.5 * pair.depth));
    let sign = if distance < 0.0 { '-' } else { '+' };
    let or = if distance.abs() <= DECIMAL_ROUNDING * reach {
        format!(", or leave \"{letter}\" out of mirror.axes: the tile is its own image")
    } else {
        String::new()
    };
    format!(
        "overlaps its own mirror image by {depth_mm} mm, {rule}: move \"{name}\" by {move_mm} mm along \
         {sign}{letter}{or}"
    )
}

/// Two tiles, of different entries or copies of one. Only the second moves; its image moves with
/// it.
fn of_two(tiles: &[NamedTile], first: Origin, second: Origin, pair: &Overlap, rule: &str) -> String {
    let name = &tiles[second.original].name;
    let whole =
        if second.is_image() { format!("its image{} overlaps", mirrors(second)) } else { "overlaps".to_owned() };
    let other = &tiles[first.original].name;
    let other = if first.is_image() {
        format!("the image{} of tile \"{other}\"", mirrors(first))
    } else {
        format!("tile \"{other}\"")
    };
    format!(
        "{whole} {other} before it by {} mm, {rule}: move \"{name}\" that far along {}",
        shown(pair.depth),
        direction(second.shift_of_original(pair.direction))
    )
}

/// The axes that an image mirrors, such as " mirrored along x and y".
fn mirrors(origin: Origin) -> String {
    let axes: Vec<&str> = (0..3).filter(|&axis| origin.mirrored[axis]).map(|axis| Axis::ALL[axis].name()).collect();
    format!(" mirrored along {}", axes.join(" and "))
}

/// A depth to three digits, rounded up. Small ones have an exponent.
fn shown(depth_mm: f64) -> String {
    let depth_mm = three_digits_up(depth_mm);
    if depth_mm < 1e-4 { format!("{depth_mm:e}") } else { depth_mm.to_string() }
}

/// Three significant digits, rounded up, so that a move by that much ends the overlap.
fn three_digits_up(depth: f64) -> f64 {
    let digit = 10_f64.powf(depth.log10().floor() - 2.0);
    // Through decimal text, which removes the round-off of the product. A depth is often a decimal
    // number with round-off, which must not be rounded up by a whole digit.
    let rounded = ((depth / digit) * (1.0 - DECIMAL_ROUNDING)).ceil() * digit;
    format!("{rounded:.2e}").parse().unwrap_or(depth)
}

/// Largest overlap that may come from rounded numbers, as a fraction of the longest side. The
/// numbers of two sides of 1 mm with two decimals make 0.015 mm.
const SHALLOW: f64 = 0.02;

/// Round-off of sums and differences of a few decimal numbers.
const DECIMAL_ROUNDING: f64 = 1e-9;

/// An axis by its name, any other direction by its components.
fn direction(d: DVec3) -> String {
    for (axis, name) in DVec3::AXES.into_iter().zip(["x", "y", "z"]) {
        if d.dot(axis).abs() > 1.0 - DECIMAL_ROUNDING {
            return format!("{}{name}", if d.dot(axis) > 0.0 { '+' } else { '-' });
        }
    }
    format!("({:.3}, {:.3}, {:.3})", d.x, d.y, d.z)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn depths_are_rounded_up_to_three_digits() {
        for (depth, shown) in
            [(0.25, 0.25), (0.1 + 0.2, 0.3), (0.250_1, 0.251), (1.0, 1.0), (999.5, 1000.0), (3.0, 3.0), (1e-9, 1e-9)]
        {
            assert_eq!(three_digits_up(depth), shown, "{depth}");
        }
    }

    #[test]
    fn small_depths_have_an_exponent() {
        assert_eq!([0.25, 3.0, 0.0123, 4.613e-7].map(shown), ["0.25", "3", "0.0123", "4.62e-7"]);
    }

    #[test]
    fn directions_along_axes_have_names() {
        assert_eq!((direction(DVec3::X), direction(-DVec3::Z)), ("+x".to_owned(), "-z".to_owned()));
        assert_eq!(direction(DVec3::new(0.6, -0.8, 0.0)), "(0.600, -0.800, 0.000)");
    }
}
