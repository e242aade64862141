//! The displacement error of films sorted from boxes of measured tiles, compared with the same
//! tiles in the order of cutting:
//!
//!     cargo run --release -p magsplice-making --example boxes -- layouts/designed-stock.toml 200 0.25
//!
//! The arguments are a layout, a number of boxes, and the number of spare tiles as a share of the
//! places.

use std::time::Instant;

use magsplice_layout::{FilmTolerance, Layout};
use magsplice_making::{AssignmentProblem, AssignmentSettings};
use magsplice_tolerance::{EvaluationGrid, RealFilm, TileChanges};

#[path = "../tests/making/boxed.rs"]
mod boxed;

use boxed::boxed;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [path, boxes, spares] = arguments.as_slice() else {
        return Err("give a layout, a number of boxes, and spare tiles as a share of the places".into());
    };
    let layout = Layout::read(path)?;
    let (Some(volume), Some(ideal)) = (layout.volume, layout.ideal) else {
        return Err("the layout needs [volume] and [ideal]".into());
    };
    let volume = EvaluationGrid { grid: volume.grid, reference: volume.reference_mm };
    let (tiles, settings) = (layout.bare_tiles(), AssignmentSettings::default());
    let (mut in_order, mut sorted, mut seconds, mut spread) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for seed in 0..boxes.parse()? {
        let groups = boxed(&layout, seed, spares.parse()?);
        let begin = Instant::now();
        let model = TileChanges::new(&RealFilm::new(&tiles, &FilmTolerance::default()), &volume, &ideal)?;
        let problem = AssignmentProblem::new(&model, &tiles, &groups, &[], &settings)?;
        let found = problem.solve(&settings, || ())?;
        seconds.push(begin.elapsed().as_secs_f64());
        in_order.push(found.in_order_rms_mm);
        sorted.push(found.rms_mm);
        spread.push(found.starts_rms_mm[found.starts_rms_mm.len() / 2] / found.starts_rms_mm[0]);
    }
    for (name, mut values) in
        [("in order, mm", in_order), ("sorted, mm", sorted), ("seconds", seconds), ("median start over best", spread)]
    {
        values.sort_by(f64::total_cmp);
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let at = |share: f64| values[((share * values.len() as f64) as usize).min(values.len() - 1)];
        println!("{name}: mean {mean:.5}, median {:.5}, 95 % {:.5}, most {:.5}", at(0.5), at(0.95), at(1.0));
    }
    Ok(())
}
