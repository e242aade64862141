//! The data on the page that its scripts draw: tiles, maps of the working volume, colours.

use magsplice::decouple::Parameter;
use magsplice::layout::NamedTile;
use magsplice::prelude::{DVec3, Grid};
use serde::Serialize;

use crate::colours::{DirectionColours, Palette, Rgb, colour_table};
use crate::survey::{GridField, Survey};
use crate::typeset::PARAMETER_NAMES;

/// Maximum number of grid points on the page. With nine numbers per point, they take 5 MB. Of a
/// finer grid the page has every second, third, ... point along an axis.
const MAX_POINTS: usize = 30_000;

/// Number of points of the page up to which the grid of the volume is made finer along x and y.
const FINE_POINTS: usize = 12_000;
/// Number of points along an axis up to which it is made finer: more than a screen shows as cells.
const FINE_ALONG: usize = 81;

#[derive(Serialize)]
struct PageData<'a> {
    tiles: Vec<TileData<'a>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    volume: Option<VolumePoints>,
    maps: Vec<MapData>,
    colours: ColourTables,
}

#[derive(Serialize)]
struct TileData<'a> {
    name: &'a str,
    centre_mm: DVec3,
    size_mm: DVec3,
    /// Unit vectors along the sides, in the film's frame.
    axes: [DVec3; 3],
    /// In the film's frame.
    polarization_t: DVec3,
    colour: String,
}

#[derive(Serialize)]
struct VolumePoints {
    lower_mm: DVec3,
    upper_mm: DVec3,
    x_mm: Vec<f64>,
    y_mm: Vec<f64>,
    z_mm: Vec<f64>,
}

#[derive(Serialize)]
struct MapData {
    group: &'static str,
    name: &'static str,
    unit: &'static str,
    /// Whether its colours are those of values of both signs.
    signed: bool,
    /// Differences up to this are round-off and count as 0; in the unit of the values.
    #[serde(skip_serializing_if = "Option::is_none")]
    round_off: Option<f64>,
    /// Names of the two maps whose difference the script computes.
    #[serde(skip_serializing_if = "Option::is_none")]
    difference_of: Option<[&'static str; 2]>,
    /// z fastest, x slowest. Null where there is no value; empty for a difference.
    values: Vec<Option<f64>>,
}

/// 256 colours each, six hexadecimal digits per colour.
#[derive(Serialize)]
struct ColourTables {
    signed: String,
    one_signed: String,
}

/// The data as JSON. `field` is the field at the points of the page.
pub(crate) fn page_data_json(tiles: &[&NamedTile], survey: Option<&Survey>, field: Option<&GridField>) -> String {
    let volume = survey.zip(field);
    let data = PageData {
        tiles: tiles.iter().map(|named| tile_data(named)).collect(),
        volume: volume.map(|(survey, field)| volume_points(survey, &field.grid)),
        maps: volume.map_or(Vec::new(), |(survey, field)| volume_maps(survey, field)),
        colours: ColourTables {
            signed: hex(&colour_table(Palette::Diverging)),
            one_signed: hex(&colour_table(Palette::Sequential)),
        },
    };
    serde_json::to_string(&data).expect("numbers and strings always serialize as JSON")
}

fn tile_data(named: &NamedTile) -> TileData<'_> {
    let tile = &named.tile;
    let polarization = tile.scene_polarization_t();
    TileData {
        name: &named.name,
        centre_mm: tile.position(),
        size_mm: tile.size(),
        axes: DVec3::AXES.map(|axis| tile.rotation() * axis),
        polarization_t: polarization,
        colour: format!("#{}", hex(&[DirectionColours::new().colour(polarization)])),
    }
}

/// Step, in points of the grid, between points of the page along x, y, z.
pub(crate) fn strides(counts: [usize; 3]) -> [usize; 3] {
    let mut strides = [1; 3];
    let kept = |strides: [usize; 3], axis: usize| counts[axis].div_ceil(strides[axis]);
    while (0..3).map(|axis| kept(strides, axis)).product::<usize>() > MAX_POINTS {
        let densest = (0..3).max_by_key(|&axis| kept(strides, axis)).unwrap_or(0);
        strides[densest] += 1;
    }
    strides
}

/// Steps, in points of the page, between points of the grid along x and y. The page shows the field
/// between them, too, where the grid has so few that its cells would be seen.
pub(crate) fn refinement(counts: [usize; 3]) -> [usize; 2] {
    let along = |axis: usize, by: usize| (counts[axis] - 1) * by + 1;
    let fits = |by: &usize| {
        let fine = [0, 1].map(|axis| along(axis, *by));
        fine.iter().all(|count| *count <= FINE_ALONG) && fine[0] * fine[1] * counts[2] <= FINE_POINTS
    };
    let by = (2..FINE_ALONG).take_while(fits).last().unwrap_or(1);
    [0, 1].map(|axis| if counts[axis] > 1 { by } else { 1 })
}

/// The points of the page: those of the grid, with further ones between them or without some.
pub(crate) fn page_grid(grid: &Grid) -> Grid {
    let counts = grid.counts();
    let (strides, [by_x, by_y]) = (strides(counts), refinement(counts));
    let last = [0, 1, 2].map(|axis| (counts[axis] - 1) / strides[axis] * strides[axis]);
    let at = |index: [usize; 3]| DVec3::from([0, 1, 2].map(|axis| grid.coordinate(axis, index[axis])));
    let refined = [by_x, by_y, 1];
    let counts = [0, 1, 2].map(|axis| last[axis] / strides[axis] * refined[axis] + 1);
    Grid::new(at([0; 3]), at(last), counts).expect("points of a valid grid are a valid grid")
}

fn volume_points(survey: &Survey, grid: &Grid) -> VolumePoints {
    let along = |axis: usize| -> Vec<f64> { (0..grid.counts()[axis]).map(|i| grid.coordinate(axis, i)).collect() };
    VolumePoints {
        lower_mm: survey.volume.lower_mm,
        upper_mm: survey.volume.upper_mm,
        x_mm: along(0),
        y_mm: along(1),
        z_mm: along(2),
    }
}

/// The maps in the order of the page's menu.
fn volume_maps(survey: &Survey, of: &GridField) -> Vec<MapData> {
    let map = |group, name, unit, value: &dyn Fn(usize) -> Option<f64>| {
        let values = (0..of.grid.len()).map(value).map(|value| value.filter(|v| v.is_finite())).collect();
        MapData { group, name, unit, signed: true, round_off: None, difference_of: None, values }
    };
    let field = |group, name, fields_t: &[DVec3], axis: usize| map(group, name, "T", &|i| Some(fields_t[i][axis]));
    let b = ["B_x", "B_y", "B_z"];
    let mut maps: Vec<MapData> = (0..3).map(|axis| field("this film", b[axis], &of.field_t, axis)).collect();
    let magnitude = map("this film", "|B|", "T", &|index| Some(of.field_t[index].length()));
    maps.push(MapData { signed: false, ..magnitude });
    let Some(against) = &survey.against_ideal else { return maps };
    let ideal_t = of.ideal_t(against.film);
    let ideal = ["ideal B_x", "ideal B_y", "ideal B_z"];
    maps.extend((0..3).map(|axis| field("ideal film", ideal[axis], &ideal_t, axis)));
    let differences = ["B_x \u{2212} ideal", "B_y \u{2212} ideal", "B_z \u{2212} ideal"];
    maps.extend((0..3).map(|axis| MapData {
        group: "difference",
        name: differences[axis],
        unit: "T",
        signed: true,
        round_off: Some(survey.round_off_t),
        difference_of: Some([b[axis], ideal[axis]]),
        values: Vec::new(),
    }));
    let parameters = of.parameters(against.branch);
    for ((parameter, name), unit) in Parameter::ALL.into_iter().zip(PARAMETER_NAMES).zip(["rad", "rad", "ln of T"]) {
        let map = map("decoupling", name, unit, &|index| Some(parameters[index][parameter.axis().index()]));
        maps.push(MapData { signed: parameter != Parameter::Sz, ..map });
    }
    maps
}

/// Colours as hexadecimal digits, six per colour.
fn hex(colours: &[Rgb]) -> String {
    colours.iter().flatten().map(|c| format!("{c:02x}")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_coarse_grid_is_made_finer_and_keeps_its_points() {
        let grid = Grid::new(DVec3::new(-2.0, -2.0, -5.0), DVec3::new(2.0, 2.0, -3.0), [9, 9, 5]).unwrap();
        let [by, _] = refinement(grid.counts());
        let fine = page_grid(&grid);
        assert!(by > 2 && fine.counts() == [8 * by + 1, 8 * by + 1, 5] && fine.len() <= FINE_POINTS);
        for index in 0..9 {
            assert_eq!(fine.coordinate(0, by * index), grid.coordinate(0, index));
        }
        assert_eq!(refinement([41, 41, 11]), [1, 1]);
        assert_eq!(refinement([1, 9, 1])[0], 1);
    }

    #[test]
    fn a_fine_grid_is_thinned_along_its_densest_axes() {
        assert_eq!(strides([9, 9, 5]), [1, 1, 1]);
        let strides = strides([400, 400, 3]);
        assert_eq!(strides[2], 1);
        assert!(400_usize.div_ceil(strides[0]) * 400_usize.div_ceil(strides[1]) * 3 <= MAX_POINTS);
    }
}
