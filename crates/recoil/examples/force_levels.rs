//! Forces of tiles with a recoil permeability, at each level of division:
//!
//!     cargo run --release -p magsplice-recoil --example force_levels -- layouts/designed-tilted.toml 1.05 6
//!
//! The arguments are a layout, a permeability, a number of its first tiles, and the highest level
//! (default: 6). Differences are between the forces on a tile by all others, over the largest of
//! them. The last line compares forces at level 3, with mean polarizations for distant pairs of
//! tiles, with the forces of all pairs of cells.

use std::error::Error;

use glam::DVec3;
use magsplice_force::FilmForces;
use magsplice_layout::Layout;
use magsplice_recoil::{Magnetization, Permeability, RecoilTile};

/// Relative error of forces of tiles turned against each other.
const TURNED_ERROR: f64 = 1e-9;

/// The level at which all pairs of cells are evaluated.
const LEVEL_OF_PAIRS: usize = 3;

/// The largest force.
fn largest(forces: impl Iterator<Item = DVec3>) -> f64 {
    forces.map(DVec3::length).fold(0.0, f64::max)
}

/// The largest difference of the forces on a tile by all others.
fn apart(forces: &FilmForces, others: &FilmForces) -> f64 {
    largest(forces.by_all().iter().zip(others.by_all()).map(|(load, other)| load.force - other.force))
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let layout = Layout::read(arguments.next().ok_or("a layout")?)?;
    let permeability = Permeability::isotropic(arguments.next().ok_or("a permeability")?.parse()?)?;
    let count = arguments.next().map_or(Ok(6), |count| count.parse())?;
    let highest = arguments.next().map_or(Ok(6), |level| level.parse())?;
    let bare: Vec<_> = layout.bare_tiles().into_iter().take(count).collect();
    let tiles: Vec<RecoilTile> = bare.iter().map(|tile| RecoilTile { tile: *tile, permeability }).collect();
    let rigid = FilmForces::new(&bare, TURNED_ERROR, || {})?;
    let of_largest = largest(rigid.by_all().iter().map(|load| load.force));
    let at_level = |level: usize| -> Result<(Magnetization, FilmForces), Box<dyn Error>> {
        let solved = Magnetization::solve(&tiles, &layout.iron, level, |_| {})?;
        let forces = FilmForces::of_cells(&solved.mean_tiles(), solved.cells(), solved.owners(), TURNED_ERROR, || {})?;
        Ok((solved, forces))
    };
    let levels = (1..=highest).map(at_level).collect::<Result<Vec<_>, _>>()?;
    let (_, finest) = levels.last().ok_or("a level")?;
    println!("{}, {} tiles, permeability {}", layout.name, tiles.len(), permeability.along());
    println!("recoil changes forces by up to {:.2} %", 100.0 * apart(&rigid, finest) / of_largest);
    println!("level  cells  from level {highest}/%  from the level before/%");
    for (index, (solved, forces)) in levels.iter().enumerate() {
        let [from_finest, from_before] = [finest, &levels[index.saturating_sub(1)].1].map(|of| apart(forces, of));
        let [from_finest, from_before] = [from_finest, from_before].map(|apart| 100.0 * apart / of_largest);
        println!("{:<5}  {:>5}  {from_finest:<14.3}  {from_before:.3}", index + 1, solved.cells().len());
    }
    let (solved, forces) = at_level(LEVEL_OF_PAIRS)?;
    let of_cells = FilmForces::new(solved.cells(), TURNED_ERROR, || {})?;
    let mut by_cells = vec![DVec3::ZERO; tiles.len() * tiles.len()];
    for (of, first) in solved.owners().iter().enumerate() {
        for (by, second) in solved.owners().iter().enumerate().filter(|(_, second)| *second != first) {
            by_cells[first * tiles.len() + second] += of_cells.by_one(of, by).force;
        }
    }
    let pairs = (0..tiles.len()).flat_map(|first| (0..first).map(move |second| (first, second)));
    let worst = largest(
        pairs.map(|(first, second)| forces.by_one(first, second).force - by_cells[first * tiles.len() + second]),
    );
    println!("pairs at level {LEVEL_OF_PAIRS} are within {:.1e} of the largest force on a tile", worst / of_largest);
    Ok(())
}
