//! A table of results, one row for each point or sample, from which every format is written.

use glam::DVec3;
use magsplice_magnet::Grid;
use serde::Serialize;
use serde::ser::{SerializeMap, Serializer};

/// Names of the columns of the coordinates.
const COORDINATES: [&str; 3] = ["x_mm", "y_mm", "z_mm"];

/// Rows, the quantities known in each of them, and metadata.
///
/// Serialized, a table is a map from the name of each column to the list of its numbers.
///
/// # Example
///
/// ```
/// use glam::DVec3;
/// use magsplice::results::{ColumnQuantity, Metadata, Points, Table};
///
/// let points = Points::Scattered(vec![DVec3::new(0.0, 0.0, -3.0), DVec3::new(0.5, 0.0, -3.0)]);
/// let flux_density = ColumnQuantity {
///     name: "b_t",
///     components: &["bx_t", "by_t", "bz_t"],
///     values: vec![0.0, 0.0, 0.008, 0.001, 0.0, 0.007],
///     is_whole: false,
/// };
/// let table = Table::new(points, vec![flux_density], Metadata::new());
///
/// let names: Vec<&str> = table.columns().iter().map(|column| column.name).collect();
/// assert_eq!(names, ["x_mm", "y_mm", "z_mm", "bx_t", "by_t", "bz_t"]);
/// assert_eq!(table.columns()[5].get(1), 0.007);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    rows: Rows,
    quantities: Vec<ColumnQuantity>,
    metadata: Metadata,
}

/// What the rows of a table belong to.
#[derive(Clone, Debug, PartialEq)]
pub enum Rows {
    /// Points. Their coordinates are the first columns.
    Points(Points),
    /// Things with consecutive numbers, which are the first column.
    Numbered {
        /// Name of that column.
        name: &'static str,
        /// Number of the first row.
        first: u64,
        /// Number of rows.
        count: usize,
    },
}

/// The points of a table in the order of its rows, in millimetres.
#[derive(Clone, Debug, PartialEq)]
pub enum Points {
    /// A regular grid. z varies fastest from row to row.
    Grid(Grid),
    /// Any points.
    Scattered(Vec<DVec3>),
}

/// A scalar, a vector or a tensor in every row of a table.
#[derive(Clone, Debug, PartialEq)]
pub struct ColumnQuantity {
    /// Name of the quantity with its unit, such as `b_t`. Formats with vectors use it.
    pub name: &'static str,
    /// Names of the columns, one per component, such as `bx_t`.
    pub components: &'static [&'static str],
    /// All components of the first row, then of the second, and so on.
    pub values: Vec<f64>,
    /// Whether all values are whole numbers, such as a status. Files have integers for them.
    pub is_whole: bool,
}

/// Source and maker of a table: names and values.
pub type Metadata = Vec<(&'static str, MetadataValue)>;

/// A value of the metadata.
#[derive(Clone, Debug, PartialEq)]
pub enum MetadataValue {
    /// Text.
    Text(String),
    /// A count.
    Count(usize),
    /// A list of numbers.
    Numbers(Vec<f64>),
}

/// A column of a table: one number per row.
#[derive(Clone, Copy)]
pub struct TableColumn<'a> {
    /// Name with its unit.
    pub name: &'static str,
    rows: &'a Rows,
    /// The quantity; `None` for coordinates and numbers of rows.
    quantity: Option<&'a ColumnQuantity>,
    /// Index of the component or the coordinate.
    index: usize,
}

impl Points {
    /// The number of points.
    pub fn len(&self) -> usize {
        match self {
            Points::Grid(grid) => grid.len(),
            Points::Scattered(points) => points.len(),
        }
    }

    /// Whether there are no points.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The point of a row, in millimetres.
    ///
    /// # Panics
    /// If there is no such row.
    pub fn get(&self, row: usize) -> DVec3 {
        match self {
            Points::Grid(grid) => grid.point(row),
            Points::Scattered(points) => points[row],
        }
    }

    /// All points in order.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = DVec3> + '_ {
        (0..self.len()).map(|row| self.get(row))
    }

    /// The shape of an array with one entry per point: the counts along x, y, z of a grid, or the
    /// number of scattered points.
    pub fn shape(&self) -> Vec<usize> {
        match self {
            Points::Grid(grid) => grid.counts().to_vec(),
            Points::Scattered(points) => vec![points.len()],
        }
    }
}

impl From<Points> for Rows {
    fn from(points: Points) -> Rows {
        Rows::Points(points)
    }
}

impl ColumnQuantity {
    /// A number in every row.
    pub fn of_numbers(name: &'static [&'static str; 1], numbers: impl IntoIterator<Item = f64>) -> ColumnQuantity {
        ColumnQuantity { name: name[0], components: name, values: numbers.into_iter().collect(), is_whole: false }
    }

    /// A whole number in every row, such as a status, or 1 for yes and 0 for no.
    pub fn of_whole<N: Into<u8>>(
        name: &'static [&'static str; 1],
        numbers: impl IntoIterator<Item = N>,
    ) -> ColumnQuantity {
        let numbers = numbers.into_iter().map(|number| f64::from(number.into()));
        ColumnQuantity { is_whole: true, ..ColumnQuantity::of_numbers(name, numbers) }
    }

    /// B in every row.
    pub fn flux_density(field_t: &[DVec3]) -> ColumnQuantity {
        ColumnQuantity::of_vectors("b_t", &["bx_t", "by_t", "bz_t"], field_t)
    }

    /// A vector in every row.
    pub fn of_vectors(name: &'static str, components: &'static [&'static str; 3], vectors: &[DVec3]) -> ColumnQuantity {
        ColumnQuantity { name, components, values: vectors.iter().flat_map(DVec3::to_array).collect(), is_whole: false }
    }
}

impl From<[f64; 3]> for MetadataValue {
    fn from(numbers: [f64; 3]) -> MetadataValue {
        MetadataValue::Numbers(numbers.to_vec())
    }
}

impl Rows {
    /// The number of rows.
    pub fn len(&self) -> usize {
        match self {
            Rows::Points(points) => points.len(),
            Rows::Numbered { count, .. } => *count,
        }
    }

    /// Whether there are no rows.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The shape of an array with one entry per row: see [`Points::shape`].
    pub fn shape(&self) -> Vec<usize> {
        match self {
            Rows::Points(points) => points.shape(),
            Rows::Numbered { count, .. } => vec![*count],
        }
    }
}

impl Table {
    /// A table of these quantities in these rows.
    ///
    /// # Panics
    /// If a quantity does not have one value per component and row.
    pub fn new(rows: impl Into<Rows>, quantities: Vec<ColumnQuantity>, metadata: Metadata) -> Table {
        let rows = rows.into();
        for ColumnQuantity { name, components, values, .. } in &quantities {
            assert_eq!(values.len(), components.len() * rows.len(), "values of the quantity {name}");
        }
        Table { rows, quantities, metadata }
    }

    /// The rows.
    pub fn rows(&self) -> &Rows {
        &self.rows
    }

    /// The quantities.
    pub fn quantities(&self) -> &[ColumnQuantity] {
        &self.quantities
    }

    /// What the table was made from and by.
    pub fn metadata(&self) -> &Metadata {
        &self.metadata
    }

    /// All columns: the three coordinates or the number of the row, then the components of each
    /// quantity.
    pub fn columns(&self) -> Vec<TableColumn<'_>> {
        let rows = &self.rows;
        let coordinates = match rows {
            Rows::Points(_) => &COORDINATES[..],
            Rows::Numbered { name, .. } => std::slice::from_ref(name),
        };
        let named = |names: &'_ [&'static str], quantity| -> Vec<TableColumn<'_>> {
            names.iter().enumerate().map(|(index, name)| TableColumn { name, rows, quantity, index }).collect()
        };
        let mut columns = named(coordinates, None);
        columns.extend(self.quantities.iter().flat_map(|quantity| named(quantity.components, Some(quantity))));
        columns
    }
}

impl TableColumn<'_> {
    /// The number in a row.
    ///
    /// # Panics
    /// If there is no such row.
    pub fn get(&self, row: usize) -> f64 {
        match (self.quantity, self.rows) {
            (Some(ColumnQuantity { components, values, .. }), _) => values[row * components.len() + self.index],
            (None, Rows::Points(points)) => points.get(row)[self.index],
            (None, Rows::Numbered { first, .. }) => (first + row as u64) as f64,
        }
    }

    /// Whether all numbers are whole, so that files have integers for them.
    pub fn is_whole(&self) -> bool {
        match (self.quantity, self.rows) {
            (Some(quantity), _) => quantity.is_whole,
            (None, Rows::Points(_)) => false,
            (None, Rows::Numbered { .. }) => true,
        }
    }

    /// The numbers of all rows in order.
    pub fn values(&self) -> impl ExactSizeIterator<Item = f64> + '_ {
        (0..self.rows.len()).map(|row| self.get(row))
    }
}

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

impl Serialize for TableColumn<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        if self.is_whole() {
            return serializer.collect_seq(self.values().map(|value| value as i64));
        }
        serializer.collect_seq(self.values())
    }
}

/// A result with its columns as lists, as JSON files have them.
#[derive(Serialize)]
pub struct Tabled<'a, T> {
    #[serde(flatten)]
    result: &'a T,
    /// Shape of each column as an array: counts along x, y, z on a grid, else the number of rows.
    shape: Vec<usize>,
    columns: &'a Table,
}

impl<'a, T> Tabled<'a, T> {
    /// The result with the columns of its table.
    pub fn new(result: &'a T, table: &'a Table) -> Tabled<'a, T> {
        Tabled { result, shape: table.rows().shape(), columns: table }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_numbers_are_integers() {
        let status = ColumnQuantity::of_whole(&["status"], [0_u8, 4]);
        let number = ColumnQuantity::of_numbers(&["number"], [1.0, 2.0]);
        let rows = Rows::Numbered { name: "reading", first: 1, count: 2 };
        let json = serde_json::to_string(&Table::new(rows, vec![status, number], Vec::new())).unwrap();
        assert_eq!(json, r#"{"reading":[1,2],"status":[0,4],"number":[1.0,2.0]}"#);
    }

    #[test]
    #[should_panic = "values of the quantity b_t"]
    fn quantity_without_a_value_per_component_and_point_is_refused() {
        let points = Points::Scattered(vec![DVec3::ZERO; 2]);
        let quantity = ColumnQuantity {
            name: "b_t",
            components: &["bx_t", "by_t", "bz_t"],
            values: vec![0.0; 5],
            is_whole: false,
        };
        Table::new(points, vec![quantity], Vec::new());
    }
}
