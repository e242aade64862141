//! Panels: rectangles of a sheet with axes, and their colour bars.

use plotters::coord::ranged1d::Ranged;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;
use plotters::style::text_anchor::VPos;

use crate::colours::ColourScale;
use crate::raster_image::RasterImage;
use crate::shared_ranges::range_of;
use crate::sheet::{DrawResult, FRAME_PX, INK, LETTERS, Lettering, Sheet, rectangle, units};
use crate::typeset::{self, AxisNumbers};

/// Room for numbers and a name at the left of a panel, in pixels.
pub(crate) const LEFT_PX: f64 = 58.0;
/// Room for numbers and a name below a panel, in pixels.
pub(crate) const BELOW_PX: f64 = 40.0;
/// Room for a colour bar with its numbers and its name, in pixels.
pub(crate) const BAR_PX: f64 = 90.0;

const BAR_WIDTH_PX: f64 = 13.0;
pub(crate) const TICK_PX: f64 = 4.0;
/// Font size of numbers on axes, in pixels.
pub(crate) const NUMBERS_PX: f64 = 12.0;
/// Minimum distance of the numbers on an axis, in pixels.
const PX_PER_NUMBER: f64 = 34.0;
/// Largest count of numbers along an axis.
const MOST_NUMBERS: usize = 11;

/// Mean width of a letter and height of a line of a remark, in pixels.
const REMARK_LETTER_PX: f64 = 6.6;
const REMARK_LINE_PX: f64 = 18.0;

/// Minimum side of a panel as a fraction of its room. A shorter axis would have no numbers.
const MIN_ROOM_FRACTION: f64 = 0.45;

/// A rectangle of a sheet, in pixels, with a range of values along each side.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Panel {
    pub(crate) left: f64,
    pub(crate) top: f64,
    pub(crate) width: f64,
    pub(crate) height: f64,
    /// Values at the left and right side.
    pub(crate) x: [f64; 2],
    /// Values at the lower and upper side.
    pub(crate) y: [f64; 2],
}

/// What an axis of a panel is labelled with.
#[derive(Clone, Copy)]
pub(crate) enum AxisLabel<'a> {
    /// Neither ticks nor numbers: what lies along the axis is named by the figure itself.
    Bare,
    /// Ticks only. The neighbouring panel has the numbers.
    TicksOnly,
    /// Numbers, and this name with its unit.
    Named(&'a str),
    /// Numbers, and the name of this coordinate in millimetres.
    Coordinate(&'a str),
}

impl AxisLabel<'_> {
    fn has_numbers(self) -> bool {
        matches!(self, AxisLabel::Named(_) | AxisLabel::Coordinate(_))
    }

    /// Room beside a panel for an axis whose numbers and name need `named` pixels.
    fn room(self, named: f64) -> f64 {
        if self.has_numbers() { named } else { 2.0 * TICK_PX }
    }

    fn name(self) -> Option<String> {
        match self {
            AxisLabel::Bare | AxisLabel::TicksOnly => None,
            AxisLabel::Named(name) => Some(name.to_owned()),
            AxisLabel::Coordinate(axis) => Some(format!("{} (mm)", typeset::variable(axis))),
        }
    }
}

impl Panel {
    pub(crate) fn new([left, top]: [f64; 2], [width, height]: [f64; 2], x: [f64; 2], y: [f64; 2]) -> Panel {
        Panel { left, top, width, height, x, y }
    }

    /// The position of a pair of values on the sheet, in pixels.
    pub(crate) fn at(&self, x: f64, y: f64) -> [f64; 2] {
        let across = (x - self.x[0]) / (self.x[1] - self.x[0]);
        let along = (y - self.y[0]) / (self.y[1] - self.y[0]);
        [self.left + across * self.width, self.top + (1.0 - along) * self.height]
    }

    /// Whether a pair of values lies inside the panel.
    pub(crate) fn contains(&self, x: f64, y: f64) -> bool {
        (self.x[0]..=self.x[1]).contains(&x) && (self.y[0]..=self.y[1]).contains(&y)
    }

    /// Pixels per unit of x.
    pub(crate) fn px_per_x(&self) -> f64 {
        self.width / (self.x[1] - self.x[0])
    }

    pub(crate) fn right(&self) -> f64 {
        self.left + self.width
    }

    pub(crate) fn bottom(&self) -> f64 {
        self.top + self.height
    }

    /// Draws the letter of the panel, (a) for 0, and a title above it, aligned at the left.
    pub(crate) fn title(&self, sheet: &Sheet, index: usize, text: &str) -> DrawResult {
        let letters = Lettering { along: VPos::Bottom, ..LETTERS };
        let letter = char::from(b'a' + (index % 26) as u8);
        sheet.text([self.left, self.top - 5.0], format!("({letter}) {text}").trim_end(), letters)
    }

    /// Draws a remark on a white plate in the middle of the panel.
    pub(crate) fn remark(&self, sheet: &Sheet, lines: &[&str]) -> DrawResult {
        let longest = lines.iter().map(|line| line.chars().count()).max().unwrap_or(0);
        let [x, y] = [self.left + 0.5 * self.width, self.top + 0.5 * self.height];
        let right = 0.5 * (REMARK_LETTER_PX * longest as f64 + 12.0);
        let down = 0.5 * (REMARK_LINE_PX * lines.len() as f64 + 6.0);
        sheet.fill(&rectangle([x - right, y - down], [x + right, y + down]), WHITE)?;
        for (n, line) in lines.iter().enumerate() {
            let y = y + REMARK_LINE_PX * (n as f64 - 0.5 * (lines.len() as f64 - 1.0));
            sheet.text([x, y], line, LETTERS.centred())?;
        }
        Ok(())
    }

    /// Draws the frame with ticks, numbers and names.
    pub(crate) fn axes(&self, sheet: &Sheet, x: AxisLabel, y: AxisLabel) -> DrawResult {
        let (left, below) = (y.room(LEFT_PX), x.room(BELOW_PX));
        let whole = sheet
            .area
            .clone()
            .shrink((units(self.left - left), units(self.top)), (units(self.width + left), units(self.height + below)));
        let mut chart = ChartBuilder::on(&whole)
            .set_label_area_size(LabelAreaPosition::Left, units(left))
            .set_label_area_size(LabelAreaPosition::Bottom, units(below))
            .build_cartesian_2d(self.x[0]..self.x[1], self.y[0]..self.y[1])?;
        let numbers = LETTERS.sized(NUMBERS_PX).style();
        let (along_x, along_y) = [(self.x, self.width), (self.y, self.height)]
            .map(|(range, px)| AxisNumbers::new(&numbers_in(range, px)))
            .into();
        let number = |label: AxisLabel, value: f64, along: &AxisNumbers| {
            if label.has_numbers() { along.text(value) } else { String::new() }
        };
        let (number_x, number_y) = (|v: &f64| number(x, *v, &along_x), |v: &f64| number(y, *v, &along_y));
        let mut mesh = chart.configure_mesh();
        mesh.disable_mesh()
            .axis_style(INK.stroke_width(units(FRAME_PX) as u32))
            .label_style(numbers)
            .axis_desc_style(LETTERS.style())
            .set_all_tick_mark_size(units(TICK_PX))
            .x_labels(max_numbers(self.x, self.width))
            .y_labels(max_numbers(self.y, self.height))
            .x_label_formatter(&number_x)
            .y_label_formatter(&number_y);
        if matches!(x, AxisLabel::Bare) {
            mesh.disable_x_axis();
        }
        if matches!(y, AxisLabel::Bare) {
            mesh.disable_y_axis();
        }
        if let Some(name) = x.name() {
            mesh.x_desc(name);
        }
        if let Some(name) = y.name() {
            mesh.y_desc(name);
        }
        mesh.draw()?;
        self.frame(sheet)
    }

    /// Draws the frame.
    pub(crate) fn frame(&self, sheet: &Sheet) -> DrawResult {
        sheet.outline(&rectangle([self.left, self.top], [self.right(), self.bottom()]), INK, FRAME_PX)
    }

    /// Fills the panel with `columns` times `rows` coloured cells. Row 0 is the lowest.
    pub(crate) fn cells(
        &self,
        sheet: &mut Sheet,
        [columns, rows]: [usize; 2],
        scale: ColourScale,
        value: impl Fn(usize, usize) -> f64,
    ) {
        let map = scale.mapper();
        let image = RasterImage::new(columns, rows, |column, row| map.colour(value(column, rows - 1 - row)));
        sheet.image([self.left, self.top, self.width, self.height], &image);
    }

    /// Draws a colour bar at the right of the panel, `away` pixels from it and as high.
    pub(crate) fn colour_bar(&self, sheet: &mut Sheet, away: f64, scale: ColourScale, name: &str) -> DrawResult {
        let bar = self.bar(sheet, away, scale);
        let values = numbers_in([scale.low, scale.high], self.height);
        let numbers = AxisNumbers::new(&values);
        bar.numbers(sheet, &values, |value| numbers.text(value), |value| value)?;
        bar.named(sheet, name)
    }

    /// Draws a colour bar for values on a logarithmic scale. `scale` is the one of their decimal
    /// logarithms.
    pub(crate) fn logarithmic_bar(&self, sheet: &mut Sheet, away: f64, scale: ColourScale, name: &str) -> DrawResult {
        let bar = self.bar(sheet, away, scale);
        let values = steps(scale.low, scale.high);
        bar.numbers(sheet, &values, typeset::number, f64::log10)?;
        bar.named(sheet, name)
    }

    /// Draws ticks and numbers at the right of a bar. `level` maps a value to the y of the bar.
    fn numbers(
        &self,
        sheet: &Sheet,
        values: &[f64],
        text: impl Fn(f64) -> String,
        level: impl Fn(f64) -> f64,
    ) -> DrawResult {
        for &value in values {
            let [right, y] = self.at(1.0, level(value));
            if !(self.top..=self.bottom()).contains(&y) {
                continue;
            }
            sheet.line(&[[right, y], [right + TICK_PX, y]], INK, FRAME_PX)?;
            sheet.text([right + 2.0 * TICK_PX, y], &text(value), LETTERS.sized(NUMBERS_PX))?;
        }
        Ok(())
    }

    /// Draws the colours of a colour bar, and returns its panel.
    fn bar(&self, sheet: &mut Sheet, away: f64, scale: ColourScale) -> Panel {
        let (at, size) = ([self.right() + away, self.top], [BAR_WIDTH_PX, self.height]);
        let bar = Panel::new(at, size, [0.0, 1.0], [scale.low, scale.high]);
        let rows = 256;
        let value = |row: usize| scale.low + (row as f64 + 0.5) / rows as f64 * (scale.high - scale.low);
        bar.cells(sheet, [1, rows], scale, |_, row| value(row));
        bar
    }

    /// Draws the frame of a colour bar, and its name upwards at the right of its numbers.
    fn named(&self, sheet: &Sheet, name: &str) -> DrawResult {
        self.frame(sheet)?;
        let letters = Lettering { upright: true, ..LETTERS.centred() };
        sheet.text([self.left + BAR_PX - 14.0, self.top + 0.5 * self.height], name, letters)
    }
}

/// The values 1, 2, 5, 10, 20, ... between two decimal logarithms. plotters offers one or nine
/// values per decade, which is too few or too many.
fn steps(low: f64, high: f64) -> Vec<f64> {
    let decades = low.floor() as i32..=high.ceil() as i32;
    let all = decades.flat_map(|decade| [1.0, 2.0, 5.0].map(|digit| digit * 10_f64.powi(decade)));
    all.filter(|value| (low..=high).contains(&value.log10())).collect()
}

/// Numbers along an axis, at least two where plotters finds so many.
fn numbers_in(range: [f64; 2], px: f64) -> Vec<f64> {
    RangedCoordf64::from(range[0]..range[1]).key_points(max_numbers(range, px))
}

/// Largest count of numbers along an axis. It is raised where it leaves a single number, from which
/// no scale can be read: plotters takes steps of powers of ten, times 1, 2 or 5.
fn max_numbers([low, high]: [f64; 2], px: f64) -> usize {
    let wanted = ((px / PX_PER_NUMBER) as usize).clamp(2, MOST_NUMBERS);
    let is_enough = |count: &usize| RangedCoordf64::from(low..high).key_points(*count).len() > 1;
    (wanted..=MOST_NUMBERS).find(is_enough).unwrap_or(wanted)
}

/// Width and height in pixels of a panel for these extents that fits into this room. All panels of
/// the same extents and room have the same scale.
pub(crate) fn equal_scale(room_px: [f64; 2], extents_mm: [f64; 2]) -> [f64; 2] {
    let per_mm = (room_px[0] / extents_mm[0]).min(room_px[1] / extents_mm[1]);
    // A very narrow panel would not be readable, so there the two scales may differ.
    [0, 1].map(|i| (per_mm * extents_mm[i]).max(MIN_ROOM_FRACTION * room_px[i]))
}

/// The range of the finite values with a margin. It is never empty.
pub(crate) fn padded(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let [low, high] = range_of(values);
    if low > high {
        return [0.0, 1.0];
    }
    let margin = if high > low { 0.06 * (high - low) } else { 0.1 * high.abs().max(1.0) };
    [low - margin, high + margin]
}

#[cfg(test)]
mod tests {
    use super::numbers_in;

    #[test]
    fn short_axes_have_two_numbers() {
        assert_eq!(numbers_in([-0.5, 0.5], 95.0), [-0.5, 0.0, 0.5]);
        assert_eq!(numbers_in([-1.7, 1.7], 95.0), [-1.0, 0.0, 1.0]);
        assert_eq!(numbers_in([0.0, 100.0], 400.0).len(), 11);
    }
}
