//! Maps in rows and columns with their colour bars.

use crate::colours::ColourScale;
use crate::error::DrawError;
use crate::panel::{AxisLabel, BAR_PX, BELOW_PX, LEFT_PX, Panel, equal_scale};
use crate::sheet::{HEADING_PX, LETTERS, sheet};
use crate::survey::FieldSlice;
use crate::typeset::AXIS_NAMES;

/// Room for a map, in pixels.
pub(super) const ROOM_PX: [f64; 2] = [220.0, 220.0];
/// Left side of the first map, in pixels.
pub(super) const FIRST_PX: f64 = LEFT_PX + 6.0;
/// Distance of columns, in pixels.
pub(super) const GAP_PX: f64 = 26.0;
/// Distance of rows, with the letters of the panels, in pixels.
const ROW_GAP_PX: f64 = 26.0;
/// Room above the maps with a heading, and without, in pixels.
const TOP_PX: [f64; 2] = [52.0, 30.0];
/// Distance of a colour bar from its map and from the side of the sheet, in pixels.
pub(super) const BESIDE_PX: [f64; 2] = [12.0, 12.0];

/// Maps in rows and columns.
pub(crate) struct MapGrid {
    /// Text above all maps.
    pub(super) heading: Option<String>,
    /// Distance of a colour bar from its map, and of the last one's numbers from the side.
    pub(super) beside_px: [f64; 2],
    pub(super) columns: Vec<MapColumn>,
    /// A map for each column.
    pub(super) rows: Vec<Vec<GridMap>>,
    /// Whether the maps of the only row lie below each other.
    pub(super) is_stacked: bool,
}

/// What the maps of a column have in common.
#[derive(Clone)]
pub(super) struct MapColumn {
    pub(super) left: f64,
    pub(super) size: [f64; 2],
    /// The axes to the right and up, and their ranges.
    pub(super) axes: [usize; 2],
    pub(super) ranges_mm: [[f64; 2]; 2],
    /// Whether the axis that points up has numbers.
    pub(super) is_numbered: bool,
    /// Number of cells along each axis.
    pub(super) cells: [usize; 2],
    /// Pixels of a cell along each axis.
    pub(super) pixels: [usize; 2],
}

/// A map of a grid.
pub(super) struct GridMap {
    /// One number per cell, the second axis fastest.
    pub(super) values: Vec<f64>,
    pub(super) scale: ColourScale,
    pub(super) title: String,
    /// Lines on the map.
    pub(super) remark: &'static [&'static str],
    /// Name of the colour bar at its right.
    pub(super) bar: Option<String>,
}

/// A quantity of two things, and its difference.
pub(super) struct ComparedRow {
    pub(super) name: String,
    /// Unit of the quantity and of the difference.
    pub(super) units: [&'static str; 2],
    /// Values of the first, of the second, and their difference.
    pub(super) values: [Vec<f64>; 3],
    /// Scale of the values and of the difference.
    pub(super) scales: [ColourScale; 2],
}

impl MapColumn {
    /// A column of maps of a slice.
    pub(super) fn of_slice(slice: &FieldSlice, left: f64, size: [f64; 2], is_numbered: bool) -> MapColumn {
        let (axes, ranges_mm, cells) = (slice.axes, slice.ranges_mm, slice.cells());
        MapColumn { left, size, axes, ranges_mm, is_numbered, cells, pixels: [1; 2] }
    }
}

impl MapGrid {
    /// Three columns for each row: the two share the colour bar at their right; the difference has
    /// its own. `remark` returns the lines on a map with these values.
    pub(super) fn compared(
        heading: String,
        titles: [&str; 3],
        first: &MapColumn,
        rows: [ComparedRow; 3],
        remark: fn(&[f64]) -> &'static [&'static str],
    ) -> MapGrid {
        let column = |n: usize| {
            let bars = if n == 2 { BAR_PX + 22.0 } else { 0.0 };
            let left = first.left + n as f64 * (first.size[0] + GAP_PX) + bars;
            MapColumn { left, is_numbered: n == 0, ..first.clone() }
        };
        let maps = |(index, ComparedRow { name, units, values, scales }): (usize, ComparedRow)| {
            let bars = [None, Some(format!("{name} ({})", units[0])), Some(format!("\u{394}{name} ({})", units[1]))];
            let map = |(n, (values, bar)): (usize, (Vec<f64>, Option<String>))| GridMap {
                remark: remark(&values),
                values,
                scale: scales[n / 2],
                title: if index == 0 { titles[n] } else { "" }.to_owned(),
                bar,
            };
            values.into_iter().zip(bars).enumerate().map(map).collect()
        };
        MapGrid {
            heading: Some(heading),
            beside_px: BESIDE_PX,
            columns: (0..3).map(column).collect(),
            rows: rows.into_iter().enumerate().map(maps).collect(),
            is_stacked: false,
        }
    }

    /// One row alone, its maps below each other, on a sheet of this width in pixels. Each map has
    /// its colour bar and its numbers, because the maps beside it had them.
    pub(crate) fn stacked(mut self, row: usize, width_px: f64) -> MapGrid {
        let titles: Vec<String> = self.rows[0].iter().map(|map| map.title.clone()).collect();
        let mut maps = self.rows.swap_remove(row);
        let mut bar = None;
        for map in maps.iter_mut().rev() {
            bar = map.bar.take().or(bar);
            map.bar.clone_from(&bar);
        }
        for (map, title) in maps.iter_mut().zip(titles) {
            if !map.title.contains(&title) {
                let between = if map.title.is_empty() { "" } else { ", " };
                map.title = format!("{title}{between}{}", map.title);
            }
        }
        let [away, beside] = self.beside_px;
        let room = width_px - FIRST_PX - away - beside - BAR_PX;
        let widest = self.columns.iter().map(|column| column.size[0]).fold(0.0, f64::max);
        let mut columns = self.columns;
        for column in &mut columns {
            let size = column.size.map(|side| side * room / widest);
            (column.left, column.size, column.is_numbered) = (FIRST_PX, size, true);
        }
        MapGrid { columns, rows: vec![maps], is_stacked: true, ..self }
    }

    /// The figure as SVG.
    pub(crate) fn draw(&self) -> Result<String, DrawError> {
        let MapGrid { heading, beside_px: [away, beside], columns, rows, is_stacked } = self;
        let first = TOP_PX[usize::from(heading.is_none())];
        let height = columns.iter().map(|column| column.size[1]).fold(0.0, f64::max);
        // Stacked maps each have the name of the axis below them.
        let top = |row: usize, n: usize| match is_stacked {
            true => first + columns[..n].iter().map(|above| above.size[1] + BELOW_PX + ROW_GAP_PX).sum::<f64>(),
            false => first + row as f64 * (height + ROW_GAP_PX),
        };
        let right = columns.iter().map(|column| column.left + column.size[0]).fold(0.0, f64::max);
        let last = columns.len() - 1;
        let bottom = top(rows.len() - 1, last) + if *is_stacked { columns[last].size[1] } else { height };
        sheet([right + beside + BAR_PX, bottom + BELOW_PX + 6.0], |sheet| {
            if let Some(heading) = heading {
                sheet.text([FIRST_PX, 14.0], heading, LETTERS.sized(HEADING_PX))?;
            }
            for (index, maps) in rows.iter().enumerate() {
                for (n, (column, map)) in columns.iter().zip(maps).enumerate() {
                    let ([width, height], [x, y]) = (column.size, column.ranges_mm);
                    let panel = Panel { left: column.left, top: top(index, n), width, height, x, y };
                    let (rows_of_cells, [across, along]) = (column.cells[1], column.pixels);
                    let pixels = [column.cells[0] * across, column.cells[1] * along];
                    panel.cells(sheet, pixels, map.scale, |u, v| map.values[u / across * rows_of_cells + v / along]);
                    panel.title(sheet, index * columns.len() + n, &map.title)?;
                    if !map.remark.is_empty() {
                        panel.remark(sheet, map.remark)?;
                    }
                    let [x, y] = column.axes.map(|axis| AxisLabel::Coordinate(AXIS_NAMES[axis]));
                    let x = if index + 1 == rows.len() { x } else { AxisLabel::TicksOnly };
                    panel.axes(sheet, x, if column.is_numbered { y } else { AxisLabel::TicksOnly })?;
                    if let Some(name) = &map.bar {
                        panel.colour_bar(sheet, *away, map.scale, name)?;
                    }
                }
            }
            Ok(())
        })
    }
}

/// A remark where the values are 0 in every cell: round-off is drawn as 0.
pub(super) fn zero_remark(values: &[f64]) -> &'static [&'static str] {
    if values.iter().all(|value| *value == 0.0) { &["0 everywhere,", "but for round-off"] } else { &[] }
}

/// Size of a map of these ranges in the room for it, in pixels.
pub(super) fn map_size(room_px: [f64; 2], ranges_mm: [[f64; 2]; 2]) -> [f64; 2] {
    equal_scale(room_px, ranges_mm.map(|[low, high]| high - low))
}
