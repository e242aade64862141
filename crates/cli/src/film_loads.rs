//! Results of `forces`: a layout with the loads on its tiles, and an order of laying.

use magsplice::ForceChange;
use magsplice::force::{FilmForces, LayingOrder, LeastHolding, Load};
use magsplice::layout::Layout;
use magsplice::prelude::DVec3;

/// From T^2 mm^2 / mu0 to N, and from T^2 mm^3 / mu0 to N mm.
const PER_MM2: f64 = 1e-6;

/// Force in newtons and torque in newton millimetres.
#[derive(Clone, Copy)]
pub(crate) struct LoadN {
    pub(crate) force_n: DVec3,
    pub(crate) torque_n_mm: DVec3,
}

impl LoadN {
    fn new(load: &Load) -> LoadN {
        LoadN { force_n: PER_MM2 * load.force, torque_n_mm: PER_MM2 * load.torque }
    }
}

/// Where an order of laying comes from.
pub(crate) enum OrderSource {
    Given,
    File(String),
    /// With the bound in newtons, the holding of the greedy order, and the seed.
    Least {
        bound_n: f64,
        greedy_n: f64,
        seed: u64,
    },
}

/// An order of laying.
pub(crate) struct OrderedLoads {
    pub(crate) source: OrderSource,
    /// The tile of each step, and the load on it by those before.
    pub(crate) steps: Vec<(usize, LoadN)>,
    /// The hardest step, from 0.
    pub(crate) hardest: usize,
    /// Holding of the order.
    pub(crate) holding_n: f64,
    /// Holding of the order of the layout file.
    pub(crate) given_holding_n: f64,
}

impl OrderedLoads {
    pub(crate) fn new(order: &LayingOrder, source: OrderSource, given: &LayingOrder) -> OrderedLoads {
        let (hardest, holding) = order.hardest_step().unwrap_or((0, 0.0));
        OrderedLoads {
            source,
            steps: order.tiles().iter().copied().zip(order.loads().iter().map(LoadN::new)).collect(),
            hardest,
            holding_n: PER_MM2 * holding,
            given_holding_n: PER_MM2 * given.holding(),
        }
    }

    pub(crate) fn least(found: &LeastHolding, seed: u64, given: &LayingOrder) -> OrderedLoads {
        let source = OrderSource::Least { bound_n: PER_MM2 * found.bound, greedy_n: PER_MM2 * found.greedy, seed };
        OrderedLoads::new(&found.order, source, given)
    }
}

/// The loads of a film.
pub(crate) struct FilmLoads<'a> {
    pub(crate) layout: &'a Layout,
    /// What recoil changes in the forces, and their error, in newtons.
    pub(crate) recoil: Option<ForceChange>,
    /// On each tile, by all others.
    pub(crate) tiles: Vec<LoadN>,
    /// Sum of all forces, and of all torques about the origin: zero but for round-off.
    pub(crate) sum: LoadN,
    pub(crate) order: Option<OrderedLoads>,
}

impl<'a> FilmLoads<'a> {
    pub(crate) fn new(
        layout: &'a Layout,
        forces: &FilmForces,
        recoil: Option<ForceChange>,
        order: Option<OrderedLoads>,
    ) -> FilmLoads<'a> {
        let in_n =
            |found: ForceChange| ForceChange { change: PER_MM2 * found.change, error: PER_MM2 * found.error, ..found };
        let tiles: Vec<LoadN> = forces.by_all().iter().map(LoadN::new).collect();
        let mut sum = LoadN { force_n: DVec3::ZERO, torque_n_mm: DVec3::ZERO };
        for (named, load) in layout.tiles.iter().zip(&tiles) {
            sum.force_n += load.force_n;
            sum.torque_n_mm += load.torque_n_mm + named.tile.position().cross(load.force_n);
        }
        FilmLoads { layout, recoil: recoil.map(in_n), tiles, sum, order }
    }

    /// The tile with the largest force, and with the largest torque.
    pub(crate) fn largest(&self) -> Option<[usize; 2]> {
        let largest = |size: &dyn Fn(&LoadN) -> f64| {
            (0..self.tiles.len())
                .reduce(|most, next| if size(&self.tiles[next]) > size(&self.tiles[most]) { next } else { most })
        };
        Some([largest(&|load| load.force_n.length())?, largest(&|load| load.torque_n_mm.length())?])
    }

    /// One line per tile; in the order of laying where there is one.
    pub(crate) fn csv(&self) -> String {
        let load = |load: &LoadN| {
            let numbers = load.force_n.to_array().into_iter().chain(load.torque_n_mm.to_array());
            numbers.map(|number| format!(",{number:e}")).collect::<String>()
        };
        let columns = |prefix: &str| {
            let force = ["x", "y", "z"].map(|axis| format!(",{prefix}force_{axis}_n"));
            let torque = ["x", "y", "z"].map(|axis| format!(",{prefix}torque_{axis}_n_mm"));
            force.concat() + &torque.concat()
        };
        let name = |tile: usize| format!("\"{}\"", self.layout.tiles[tile].name.replace('"', "\"\""));
        let mut csv = format!("tile{}", columns(""));
        let Some(order) = &self.order else {
            csv.push('\n');
            for (tile, by_all) in self.tiles.iter().enumerate() {
                csv += &format!("{}{}\n", name(tile), load(by_all));
            }
            return csv;
        };
        csv += &format!(",step{}\n", columns("laying_"));
        for (step, (tile, laying)) in order.steps.iter().enumerate() {
            csv += &format!("{}{},{}{}\n", name(*tile), load(&self.tiles[*tile]), step + 1, load(laying));
        }
        csv
    }
}
