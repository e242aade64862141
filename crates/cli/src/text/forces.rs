//! `forces`: loads on tiles, and an order of laying, as tables.

use std::fmt::Write;

use magsplice::ForceChange;
use magsplice::prelude::DVec3;

use super::number::counted;
use super::{header, rows};
use crate::film_loads::{FilmLoads, LoadN, OrderSource, OrderedLoads};

/// Units of forces with their sizes in N, from the largest.
const UNITS: [(&str, f64); 3] = [("N", 1.0), ("mN", 1e-3), ("uN", 1e-6)];

/// A unit is used down to this fraction of it.
const SMALLEST_LARGEST: f64 = 0.1;

/// The report of `forces`.
pub(crate) fn forces(film: &FilmLoads) -> String {
    let mut text = header::layout(film.layout);
    text += "force on each tile by all others, and torque about its centre; ";
    text += match &film.recoil {
        None => "rigid magnetization\n\n",
        Some(_) => "with recoil\n",
    };
    let largest_n = film.tiles.iter().map(|load| load.force_n.length()).fold(0.0, f64::max);
    let unit = Unit::for_forces(largest_n);
    if let Some(ForceChange { cells, level, change, error }) = film.recoil {
        let _ = writeln!(
            text,
            "recoil: {} at level {level}, forces change by up to {}, known to {}\n",
            counted(cells, "cell", "cells"),
            unit.force(change),
            unit.force(error)
        );
    }
    let lines = film.tiles.iter().enumerate().map(|(tile, load)| (String::new(), tile, load));
    text += &unit.table(film, lines, false);
    text.push('\n');
    if let Some([force, torque]) = film.largest() {
        let (name, load) = (&film.layout.tiles[force].name, &film.tiles[force]);
        let _ = writeln!(text, "largest force   {} on {name}", unit.force(load.force_n.length()));
        let (name, load) = (&film.layout.tiles[torque].name, &film.tiles[torque]);
        let _ = writeln!(text, "largest torque  {} about the centre of {name}", unit.torque(load.torque_n_mm.length()));
    }
    let [force, torque] = [film.sum.force_n.length() / unit.size_n, film.sum.torque_n_mm.length() / unit.size_n];
    let _ = writeln!(
        text,
        "sum of all      {force:.1e} {name}, and {torque:.1e} {name} mm about the origin: round-off",
        name = unit.name
    );
    if let Some(order) = &film.order {
        ordered(&mut text, film, order);
    }
    text
}

fn ordered(text: &mut String, film: &FilmLoads, order: &OrderedLoads) {
    let what = match &order.source {
        OrderSource::Given => "order of the layout file".to_owned(),
        OrderSource::File(path) => format!("order of {path}"),
        OrderSource::Least { seed, .. } => format!("order with the least holding that was found, seed {seed}"),
    };
    let _ = writeln!(text, "\n{what}: load on each tile while it is laid, by those already there\n");
    let unit = Unit::for_forces(order.holding_n);
    let lines = order.steps.iter().enumerate().map(|(step, (tile, load))| ((step + 1).to_string(), *tile, load));
    *text += &unit.table(film, lines, true);
    text.push('\n');
    let Some((tile, _)) = order.steps.get(order.hardest) else { return };
    let name = &film.layout.tiles[*tile].name;
    let _ = writeln!(text, "holding         {} at step {}, {name}", unit.force(order.holding_n), order.hardest + 1);
    if let OrderSource::Least { bound_n, greedy_n, .. } = order.source {
        let _ = writeln!(text, "bound           {}, which no order is below", unit.force(bound_n));
        let _ = writeln!(text, "greedy order    {}", unit.force(greedy_n));
    }
    if !matches!(order.source, OrderSource::Given) {
        let _ = writeln!(text, "given order     {}", unit.force(order.given_holding_n));
    }
}

/// A unit in which the forces of a table have few digits.
struct Unit {
    name: &'static str,
    size_n: f64,
}

impl Unit {
    fn for_forces(largest_n: f64) -> Unit {
        let fits = |(_, size_n): &(&str, f64)| largest_n >= SMALLEST_LARGEST * size_n;
        let (name, size_n) = UNITS.into_iter().find(fits).unwrap_or(UNITS[0]);
        Unit { name, size_n }
    }

    fn force(&self, force_n: f64) -> String {
        format!("{:.4} {}", force_n / self.size_n, self.name)
    }

    fn torque(&self, torque_n_mm: f64) -> String {
        format!("{:.4} {} mm", torque_n_mm / self.size_n, self.name)
    }

    fn number(&self, value: f64) -> String {
        let text = format!("{:.4}", value / self.size_n);
        // Round-off of zero.
        if text.trim_start_matches('-').chars().all(|c| matches!(c, '0' | '.')) { "0.0000".to_owned() } else { text }
    }

    fn table<'a>(
        &self,
        film: &FilmLoads,
        lines: impl Iterator<Item = (String, usize, &'a LoadN)>,
        with_steps: bool,
    ) -> String {
        let name = self.name;
        let head = [
            if with_steps { "step" } else { "" }.to_owned(),
            "tile".to_owned(),
            format!("Fx, {name}"),
            "Fy".to_owned(),
            "Fz".to_owned(),
            "|F|".to_owned(),
            format!("Tx, {name} mm"),
            "Ty".to_owned(),
            "Tz".to_owned(),
        ];
        let mut table = vec![head];
        for (step, tile, load) in lines {
            let numbers = |vector: DVec3| vector.to_array().map(|value| self.number(value));
            let ([fx, fy, fz], [tx, ty, tz]) = (numbers(load.force_n), numbers(load.torque_n_mm));
            let magnitude = self.number(load.force_n.length());
            table.push([step, film.layout.tiles[tile].name.clone(), fx, fy, fz, magnitude, tx, ty, tz]);
        }
        // Numbers end at the right of their columns.
        for column in (0..9).filter(|&column| column != 1) {
            let width = table.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
            for row in &mut table {
                row[column] = format!("{:>width$}", row[column]);
            }
        }
        let lines = rows::columns(&table);
        let cut = if with_steps { 0 } else { 2 };
        lines.into_iter().map(|line| format!("{}\n", &line[cut..])).collect()
    }
}
