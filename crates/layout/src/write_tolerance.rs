//! Writing `[tolerance]`: groups and errors by the names of tiles, measured errors as values.

use std::collections::HashMap;
use std::hash::Hash;

use toml::Spanned;

use crate::distribution::Distribution;
use crate::error_unit::ErrorUnit;
use crate::tables::distribution::{Components, DistributionTable, WrittenDistribution};
use crate::tables::tolerance::{
    FilmTable, GroupTable, NeighbourTable, SensorTable, StrayFieldTable, TemperatureTable, TileErrorsTable,
    ToleranceTable, When,
};
use crate::tolerance::{
    ErrorGroup, FilmPose, FilmTolerance, Neighbour, SensorErrors, StrayField, Temperature, TileErrors,
};

/// The table of tolerances. `names` are those of the tiles, in the order of the errors.
///
/// Errors that most tiles have are written once, and those of other tiles by their names, key by
/// key: the text then has no distribution more often than the file from which it was read.
pub(crate) fn tolerance_table(tolerance: &FilmTolerance, names: &[&str]) -> Spanned<ToleranceTable> {
    let FilmTolerance { tiles, groups, common, samples, seed } = tolerance;
    let mut table = ToleranceTable { samples: Some(*samples), seed: Some(*seed), ..ToleranceTable::default() };
    let (lengths, angles) =
        (|e: &[_; 3]| components(e, ErrorUnit::Millimetre), |e: &[_; 3]| components(e, ErrorUnit::Degree));
    let entry = TileErrorsTable::default;
    let mut entries = Vec::new();
    table.position_mm = by_tile(
        tiles.iter().map(|errors| &errors.position),
        lengths,
        |tiles, errors| TileErrorsTable { tiles, position_mm: errors, ..entry() },
        names,
        &mut entries,
    );
    table.rotation_deg = by_tile(
        tiles.iter().map(|errors| &errors.rotation),
        angles,
        |tiles, errors| TileErrorsTable { tiles, rotation_deg: errors, ..entry() },
        names,
        &mut entries,
    );
    table.size_mm = by_tile(
        tiles.iter().map(|errors| &errors.size),
        lengths,
        |tiles, errors| TileErrorsTable { tiles, size_mm: errors, ..entry() },
        names,
        &mut entries,
    );
    table.strength = by_tile(
        tiles.iter().map(|errors| std::array::from_ref(&errors.strength)),
        |[error]| written(error, ErrorUnit::Fraction),
        |tiles, errors| TileErrorsTable { tiles, strength: errors, ..entry() },
        names,
        &mut entries,
    );
    table.direction_deg = by_tile(
        tiles.iter().map(|errors| &errors.direction),
        |errors| components(errors, ErrorUnit::Degree),
        |tiles, errors| TileErrorsTable { tiles, direction_deg: errors, ..entry() },
        names,
        &mut entries,
    );
    table.tile = entries.into_iter().map(spanned).collect();
    table.group = groups.iter().map(|group| spanned(group_table(group, names))).collect();
    table.film = (common.film != FilmPose::default()).then(|| spanned(film_table(&common.film)));
    table.stray_field = common.stray_field.as_ref().map(|field| spanned(stray_field_table(field)));
    table.neighbour = common.neighbour.as_ref().map(|neighbour| spanned(neighbour_table(neighbour)));
    table.temperature = common.temperature.as_ref().map(|change| spanned(temperature_table(change)));
    table.sensor = (common.sensor != SensorErrors::default()).then(|| spanned(sensor_table(&common.sensor)));
    spanned(table)
}

fn spanned<T>(table: T) -> Spanned<T> {
    Spanned::new(0..0, table)
}

/// The written errors of one key that most tiles have, if there are any. An entry is added for each
/// other error, with the names of its tiles.
fn by_tile<'e, const N: usize, W>(
    errors: impl Iterator<Item = &'e [Distribution; N]>,
    write: impl Fn(&[Distribution; N]) -> W,
    entry: impl Fn(Vec<String>, Option<W>) -> TileErrorsTable,
    names: &[&str],
    entries: &mut Vec<TileErrorsTable>,
) -> Option<W> {
    let mut places: HashMap<[DistributionKey; N], usize> = HashMap::new();
    let mut different: Vec<(&[Distribution; N], Vec<usize>)> = Vec::new();
    for (index, errors) in errors.enumerate() {
        let place = *places.entry(errors.each_ref().map(DistributionKey::from)).or_insert(different.len());
        match different.get_mut(place) {
            Some((_, tiles)) => tiles.push(index),
            None => different.push((errors, vec![index])),
        }
    }
    // The first of those with as many tiles, so that the text does not depend on chance.
    let most = different.iter().map(|(_, tiles)| tiles.len()).max()?;
    let usual = different.iter().position(|(_, tiles)| tiles.len() == most)?;
    for (_, (errors, tiles)) in different.iter().enumerate().filter(|(place, _)| *place != usual) {
        let tiles = tiles.iter().map(|&tile| names[tile].to_owned()).collect();
        entries.push(entry(tiles, Some(write(errors))));
    }
    let (errors, _) = different[usual];
    (!errors.iter().all(Distribution::is_none)).then(|| write(errors))
}

/// What tells distributions apart: their form and the bits of their numbers. Tabulated ones are
/// told apart by their place in memory, which copies share.
#[derive(Clone, Copy, Eq, Hash, PartialEq)]
struct DistributionKey(u8, u64, u64);

impl From<&Distribution> for DistributionKey {
    fn from(distribution: &Distribution) -> DistributionKey {
        match distribution {
            // Adding 0 turns -0 into 0.
            Distribution::Fixed(value) => DistributionKey(0, (value + 0.0).to_bits(), 0),
            Distribution::Normal { deviation } => DistributionKey(1, deviation.to_bits(), 0),
            Distribution::Truncated { deviation, limit } => DistributionKey(2, deviation.to_bits(), limit.to_bits()),
            Distribution::Uniform { half_width } => DistributionKey(3, half_width.to_bits(), 0),
            Distribution::Tabulated(values) => DistributionKey(4, values.as_ptr().addr() as u64, values.len() as u64),
        }
    }
}

/// Distributions of components: one if all are the same.
fn components<const N: usize>(errors: &[Distribution; N], unit: ErrorUnit) -> Components<N> {
    let key = |error| DistributionKey::from(error);
    if errors.iter().all(|error| key(error) == key(&errors[0])) {
        return Components::Same(written(&errors[0], unit));
    }
    Components::Each(errors.iter().map(|error| written(error, unit)).collect())
}

/// Distributions of components, or nothing if there are no errors.
fn some_components<const N: usize>(errors: &[Distribution; N], unit: ErrorUnit) -> Option<Components<N>> {
    (!errors.iter().all(Distribution::is_none)).then(|| components(errors, unit))
}

fn some_written(error: &Distribution, unit: ErrorUnit) -> Option<WrittenDistribution> {
    (!error.is_none()).then(|| written(error, unit))
}

fn written(error: &Distribution, unit: ErrorUnit) -> WrittenDistribution {
    let number = |value: f64| Some(unit.written(value));
    let table = DistributionTable::default();
    WrittenDistribution::Table(match error {
        Distribution::Fixed(0.0) => return WrittenDistribution::Deviation(0.0),
        Distribution::Normal { deviation } => return WrittenDistribution::Deviation(unit.written(*deviation)),
        Distribution::Fixed(value) => DistributionTable { fixed: number(*value), ..table },
        Distribution::Truncated { deviation, limit } => {
            DistributionTable { normal: number(*deviation), within: number(*limit), ..table }
        }
        Distribution::Uniform { half_width } => DistributionTable { uniform: number(*half_width), ..table },
        Distribution::Tabulated(values) => {
            DistributionTable { values: Some(values.iter().map(|value| unit.written(*value)).collect()), ..table }
        }
    })
}

fn group_table(group: &ErrorGroup, names: &[&str]) -> GroupTable {
    let ErrorGroup { name, tiles, errors } = group;
    let TileErrors { position, rotation, size, strength, direction } = errors;
    let has_none = errors.values().all(Distribution::is_none);
    GroupTable {
        name: Some(name.clone()),
        tiles: Some(tiles.iter().map(|&tile| names[tile].to_owned()).collect()),
        position_mm: some_components(position, ErrorUnit::Millimetre),
        rotation_deg: some_components(rotation, ErrorUnit::Degree),
        size_mm: some_components(size, ErrorUnit::Millimetre),
        // A group gives at least one key.
        strength: if has_none {
            Some(WrittenDistribution::Deviation(0.0))
        } else {
            some_written(strength, ErrorUnit::Fraction)
        },
        direction_deg: some_components(direction, ErrorUnit::Degree),
        ..GroupTable::default()
    }
}

fn film_table(pose: &FilmPose) -> FilmTable {
    FilmTable {
        position_mm: some_components(&pose.position_mm, ErrorUnit::Millimetre),
        rotation_deg: some_components(&pose.rotation_rad, ErrorUnit::Degree),
    }
}

fn when(later: bool) -> When {
    if later { When::After } else { When::Before }
}

fn stray_field_table(field: &StrayField) -> StrayFieldTable {
    StrayFieldTable {
        field_ut: some_components(&field.field_t, ErrorUnit::Microtesla),
        any_direction_ut: some_written(&field.any_direction_t, ErrorUnit::Microtesla),
        when: when(field.later),
    }
}

fn neighbour_table(neighbour: &Neighbour) -> NeighbourTable {
    NeighbourTable {
        layout: neighbour.layout.clone(),
        position_mm: Some(neighbour.position_mm),
        rotation: neighbour.rotation.map(Into::into),
        when: when(neighbour.later),
    }
}

fn temperature_table(change: &Temperature) -> TemperatureTable {
    TemperatureTable {
        change_k: written(&change.change_k, ErrorUnit::Kelvin),
        strength_per_k: Some(change.strength_per_k),
    }
}

fn sensor_table(sensor: &SensorErrors) -> SensorTable {
    SensorTable {
        offset_ut: some_components(&sensor.offset_t, ErrorUnit::Microtesla),
        rotation_deg: some_components(&sensor.rotation_rad, ErrorUnit::Degree),
        gain: some_components(&sensor.gain, ErrorUnit::Fraction),
        noise_ut: some_components(&sensor.noise_t, ErrorUnit::Microtesla),
    }
}
