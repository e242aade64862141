//! Panels with axes, and colour bars.

use plotters::coord::ranged1d::Ranged;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;
use plotters::style::text_anchor::VPos;

use crate::colours::{INK_LINE, Scale};
use crate::image::Image;
use crate::sheet::{Drawn, INK, LETTERS, Lettering, Sheet, units};
use crate::typeset;

/// Room for numbers and a name beside a panel, in pixels.
pub(crate) const LEFT_PX: f64 = 52.0;
pub(crate) const BELOW_PX: f64 = 40.0;
/// Room for a colour bar with its numbers and its name.
pub(crate) const BAR_PX: f64 = 74.0;

const BAR_WIDTH_PX: f64 = 13.0;
const TICK_PX: f64 = 4.0;
const NUMBERS: f64 = 12.0;
/// A number on an axis for so many pixels, at most.
const PX_PER_NUMBER: f64 = 34.0;

/// A side of a panel is at least this fraction of its room, or its axis had no numbers.
const LEAST_OF_ROOM: f64 = 0.45;

/// A rectangle of a sheet, in pixels, with a range of values along each side.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Panel {
    pub(crate) left: f64,
    pub(crate) top: f64,
    pub(crate) width: f64,
    pub(crate) height: f64,
    pub(crate) x: [f64; 2],
    pub(crate) y: [f64; 2],
}

/// What stands beside an axis.
#[derive(Clone, Copy)]
pub(crate) enum Beside<'a> {
    /// Ticks only: the numbers are those of a panel beside it.
    Ticks,
    /// Numbers and a name with unit.
    Named(&'a str),
    /// The same for the coordinate of this axis in millimetres.
    Length(&'a str),
}

impl Beside<'_> {
    fn name(self) -> Option<String> {
        match self {
            Beside::Ticks => None,
            Beside::Named(name) => Some(name.to_owned()),
            Beside::Length(axis) => Some(format!("{} (mm)", typeset::variable(axis))),
        }
    }
}

impl Panel {
    /// Where a pair of values is on the sheet.
    pub(crate) fn at(&self, x: f64, y: f64) -> [f64; 2] {
        let across = (x - self.x[0]) / (self.x[1] - self.x[0]);
        let along = (y - self.y[0]) / (self.y[1] - self.y[0]);
        [self.left + across * self.width, self.top + (1.0 - along) * self.height]
    }

    pub(crate) fn contains(&self, x: f64, y: f64) -> bool {
        (self.x[0]..=self.x[1]).contains(&x) && (self.y[0]..=self.y[1]).contains(&y)
    }

    /// Pixels for a unit of x.
    pub(crate) fn px_per_x(&self) -> f64 {
        self.width / (self.x[1] - self.x[0])
    }

    pub(crate) fn right(&self) -> f64 {
        self.left + self.width
    }

    pub(crate) fn bottom(&self) -> f64 {
        self.top + self.height
    }

    /// A title above the panel, at its left.
    pub(crate) fn title(&self, sheet: &Sheet, text: &str) -> Drawn {
        let letters = Lettering { along: VPos::Bottom, ..LETTERS };
        sheet.text([self.left, self.top - 5.0], text, letters)
    }

    /// The frame with ticks, numbers and names.
    pub(crate) fn axes(&self, sheet: &Sheet, x: Beside, y: Beside) -> Drawn {
        let (left, below) = (room(y, LEFT_PX), room(x, BELOW_PX));
        let whole = sheet
            .area
            .clone()
            .shrink((units(self.left - left), units(self.top)), (units(self.width + left), units(self.height + below)));
        let mut chart = ChartBuilder::on(&whole)
            .set_label_area_size(LabelAreaPosition::Left, units(left))
            .set_label_area_size(LabelAreaPosition::Bottom, units(below))
            .build_cartesian_2d(self.x[0]..self.x[1], self.y[0]..self.y[1])?;
        let numbers = LETTERS.sized(NUMBERS).style();
        let number = |named: Beside, value: f64, range: [f64; 2]| match named {
            Beside::Ticks => String::new(),
            Beside::Named(_) | Beside::Length(_) => typeset::on_axis(value, range),
        };
        let (number_x, number_y) = (|v: &f64| number(x, *v, self.x), |v: &f64| number(y, *v, self.y));
        let mut mesh = chart.configure_mesh();
        mesh.disable_mesh()
            .axis_style(INK.stroke_width(units(INK_LINE) as u32))
            .label_style(numbers)
            .axis_desc_style(LETTERS.style())
            .set_all_tick_mark_size(units(TICK_PX))
            .x_labels(most_numbers(self.width))
            .y_labels(most_numbers(self.height))
            .x_label_formatter(&number_x)
            .y_label_formatter(&number_y);
        if let Some(name) = x.name() {
            mesh.x_desc(name);
        }
        if let Some(name) = y.name() {
            mesh.y_desc(name);
        }
        mesh.draw()?;
        let (right, bottom) = (self.right(), self.bottom());
        let frame = [[self.left, self.top], [right, self.top], [right, bottom], [self.left, bottom]];
        sheet.outline(&frame, INK, INK_LINE)
    }

    /// A panel full of colours, one for each of `columns` times `rows` cells; the first row is the lowest.
    pub(crate) fn cells(
        &self,
        sheet: &mut Sheet,
        [columns, rows]: [usize; 2],
        scale: Scale,
        value: impl Fn(usize, usize) -> f64,
    ) {
        let map = scale.map();
        let image = Image::new(columns, rows, |column, row| map.colour(value(column, rows - 1 - row)));
        sheet.image([self.left, self.top, self.width, self.height], &image);
    }

    /// A colour bar at the panel's right, `away` pixels from it and as high.
    pub(crate) fn colour_bar(&self, sheet: &mut Sheet, away: f64, scale: Scale, name: &str) -> Drawn {
        let bar = self.bar(sheet, away, scale);
        let values = RangedCoordf64::from(scale.low..scale.high).key_points(most_numbers(self.height));
        bar.numbers(sheet, &values, |value| value)?;
        bar.named(sheet, name)
    }

    /// A colour bar whose values grow by factors; `scale` is of their decimal logarithms.
    pub(crate) fn logarithmic_bar(&self, sheet: &mut Sheet, away: f64, scale: Scale, name: &str) -> Drawn {
        let bar = self.bar(sheet, away, scale);
        let values = steps(scale.low, scale.high);
        bar.numbers(sheet, &values, f64::log10)?;
        bar.named(sheet, name)
    }

    /// Ticks and numbers at a bar's right; `level` is where on the bar a value is.
    fn numbers(&self, sheet: &Sheet, values: &[f64], level: impl Fn(f64) -> f64) -> Drawn {
        for &value in values {
            let [right, y] = self.at(1.0, level(value));
            if !(self.top..=self.bottom()).contains(&y) {
                continue;
            }
            sheet.line(&[[right, y], [right + TICK_PX, y]], INK, INK_LINE)?;
            let range = [level(values[0]), level(values[values.len() - 1])];
            let text = typeset::on_axis(value, if values.len() > 1 { range } else { [0.0, 0.0] });
            sheet.text([right + 2.0 * TICK_PX, y], &text, LETTERS.sized(NUMBERS))?;
        }
        Ok(())
    }

    fn bar(&self, sheet: &mut Sheet, away: f64, scale: Scale) -> Panel {
        let bar = Panel {
            left: self.right() + away,
            width: BAR_WIDTH_PX,
            x: [0.0, 1.0],
            y: [scale.low, scale.high],
            ..*self
        };
        let rows = 256;
        let value = |row: usize| scale.low + (row as f64 + 0.5) / rows as f64 * (scale.high - scale.low);
        bar.cells(sheet, [1, rows], scale, |_, row| value(row));
        bar
    }

    /// The name of a colour bar, upright at the right of its numbers, and its frame.
    fn named(&self, sheet: &Sheet, name: &str) -> Drawn {
        let (right, bottom) = (self.right(), self.bottom());
        sheet.outline(
            &[[self.left, self.top], [right, self.top], [right, bottom], [self.left, bottom]],
            INK,
            INK_LINE,
        )?;
        let letters = Lettering { upright: true, ..LETTERS.centred() };
        sheet.text([self.left + BAR_PX - 14.0, self.top + 0.5 * self.height], name, letters)
    }
}

/// 1, 2, 5, 10, 20, ... between two powers of ten. plotters' own are one to a decade or nine.
fn steps(low: f64, high: f64) -> Vec<f64> {
    let decades = low.floor() as i32..=high.ceil() as i32;
    let all = decades.flat_map(|decade| [1.0, 2.0, 5.0].map(|digit| digit * 10_f64.powi(decade)));
    all.filter(|value| (low..=high).contains(&value.log10())).collect()
}

fn room(beside: Beside, named: f64) -> f64 {
    match beside {
        Beside::Ticks => 2.0 * TICK_PX,
        Beside::Named(_) | Beside::Length(_) => named,
    }
}

fn most_numbers(px: f64) -> usize {
    ((px / PX_PER_NUMBER) as usize).clamp(2, 11)
}

/// Two panels or more of one scale for lengths: pixels for a millimetre so that these extents fit into this room.
pub(crate) fn equal_scale(room_px: [f64; 2], extents_mm: [f64; 2]) -> [f64; 2] {
    let per_mm = (room_px[0] / extents_mm[0]).min(room_px[1] / extents_mm[1]);
    // A sliver would not be readable; its scales then differ.
    [0, 1].map(|i| (per_mm * extents_mm[i]).max(LEAST_OF_ROOM * room_px[i]))
}
