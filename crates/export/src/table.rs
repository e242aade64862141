//! Results at points: what every format of tables is written from.

use glam::DVec3;
use magsplice_field::Grid;
use serde::ser::{Serialize, SerializeMap, Serializer};

/// Names of the coordinates of a point.
const COORDINATES: [&str; 3] = ["x_mm", "y_mm", "z_mm"];

/// Points and what is known at each of them.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// The points, in millimetres.
    pub points: Points,
    /// What is known, each with one entry per point.
    pub quantities: Vec<Quantity>,
    /// What it was made from and by.
    pub metadata: Metadata,
}

/// The points of a table, in the order of its rows.
#[derive(Clone, Debug, PartialEq)]
pub enum Points {
    /// A regular grid, z fastest.
    Grid(Grid),
    /// Points anywhere.
    Scattered(Vec<DVec3>),
}

/// A scalar, a vector or a tensor at every point.
#[derive(Clone, Debug, PartialEq)]
pub struct Quantity {
    /// Name of the whole with its unit, such as `b_t`, where a format has vectors.
    pub name: &'static str,
    /// Names of its columns, such as `bx_t`.
    pub components: &'static [&'static str],
    /// Its components point by point.
    pub values: Vec<f64>,
}

/// Facts about a table: their names and values.
pub type Metadata = Vec<(&'static str, Value)>;

/// A fact about a table.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// Words.
    Text(String),
    /// How many.
    Count(usize),
    /// Numbers.
    Numbers(Vec<f64>),
}

/// One number for every point.
#[derive(Clone, Copy)]
pub struct Column<'a> {
    /// Name with its unit.
    pub name: &'static str,
    source: Source<'a>,
    rows: usize,
}

#[derive(Clone, Copy)]
enum Source<'a> {
    Coordinate(&'a Points, usize),
    Component { values: &'a [f64], first: usize, step: usize },
}

impl Points {
    /// How many.
    pub fn len(&self) -> usize {
        match self {
            Points::Grid(grid) => grid.len(),
            Points::Scattered(points) => points.len(),
        }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The point of this row.
    pub fn get(&self, row: usize) -> DVec3 {
        match self {
            Points::Grid(grid) => grid.point(row),
            Points::Scattered(points) => points[row],
        }
    }

    /// The shape of an array with one entry per point: counts along x, y, z, or the number of points.
    pub fn shape(&self) -> Vec<usize> {
        match self {
            Points::Grid(grid) => grid.counts().to_vec(),
            Points::Scattered(points) => vec![points.len()],
        }
    }
}

impl Table {
    /// All columns, the coordinates first.
    ///
    /// # Panics
    /// If a quantity does not have all its components at every point.
    pub fn columns(&self) -> Vec<Column<'_>> {
        let rows = self.points.len();
        let coordinate =
            |axis: usize| Column { name: COORDINATES[axis], source: Source::Coordinate(&self.points, axis), rows };
        let components = self.quantities.iter().flat_map(|quantity| {
            let (values, step) = (&quantity.values[..], quantity.components.len());
            assert_eq!(values.len(), rows * step, "{} has {step} components at every point", quantity.name);
            let column = move |(first, name): (usize, &&'static str)| Column {
                name,
                source: Source::Component { values, first, step },
                rows,
            };
            quantity.components.iter().enumerate().map(column)
        });
        (0..3).map(coordinate).chain(components).collect()
    }
}

impl Column<'_> {
    /// The number in this row.
    pub fn get(&self, row: usize) -> f64 {
        match self.source {
            Source::Coordinate(points, axis) => points.get(row)[axis],
            Source::Component { values, first, step } => values[row * step + first],
        }
    }

    /// The numbers from the first row to the last.
    pub fn values(&self) -> impl ExactSizeIterator<Item = f64> + '_ {
        (0..self.rows).map(|row| self.get(row))
    }
}

/// The columns by name.
impl Serialize for Table {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let columns = self.columns();
        let mut map = serializer.serialize_map(Some(columns.len()))?;
        for column in &columns {
            map.serialize_entry(column.name, column)?;
        }
        map.end()
    }
}

impl Serialize for Column<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(self.values())
    }
}
