//! The limits on all tiles of a layout together, checked before the tiles are made.

use std::fmt;

use crate::faults::TableFaults;
use crate::limits::{MAX_TILES, MAX_TOTAL_NAME_BYTES};

/// Bytes that a repetition adds to the name of a tile at most, as in -x1234567-y1234567-mx-my.
const LONGEST_SUFFIX: usize = 40;

/// What the tables read so far have used of the limits.
#[derive(Default)]
pub(crate) struct Room {
    tiles: usize,
    name_bytes: usize,
}

impl Room {
    /// Makes room for the tiles of one table, whose name and kind together have `name_bytes` each.
    /// Returns whether there is room, and adds a fault if there is not. `what` describes the
    /// source of the tiles, such as "grid makes 12 tiles".
    pub(crate) fn take(
        &mut self,
        tiles: usize,
        name_bytes: usize,
        what: impl fmt::Display,
        faults: &mut TableFaults,
    ) -> bool {
        let total = self.tiles.saturating_add(tiles);
        if total > MAX_TILES {
            let before =
                if self.tiles > 0 { format!(", including the {} before it", self.tiles) } else { String::new() };
            faults.add(format!("{what}, must be at most {MAX_TILES} tiles in the whole layout{before}"));
            return false;
        }
        // No overflow: the tiles are at most MAX_TILES, and the names are parts of the file.
        let total_bytes = self.name_bytes + tiles * (name_bytes + LONGEST_SUFFIX);
        if total_bytes > MAX_TOTAL_NAME_BYTES {
            faults.add(format!(
                "{what} with names of up to {} bytes, which makes {total_bytes} bytes of names in the layout, must be at \
                 most {MAX_TOTAL_NAME_BYTES}: use shorter names",
                name_bytes + LONGEST_SUFFIX
            ));
            return false;
        }
        (self.tiles, self.name_bytes) = (total, total_bytes);
        true
    }
}
