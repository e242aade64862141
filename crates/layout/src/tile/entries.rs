//! The entries of a file, `[[tile]]` and `[[lattice]]`, and the tiles that each of them makes.

use glam::DVec3;

use crate::tile::repeat::MirrorTable;

/// One `[[tile]]` or `[[lattice]]`.
pub(crate) struct Entry<'t> {
    /// Where the table begins in the text.
    pub(crate) start: usize,
    /// Index of its first tile. Its other tiles follow: all copies, then their images in the first
    /// mirror, then the images of all these in the second, and so on.
    pub(crate) first: usize,
    pub(crate) mirror: Option<&'t MirrorTable>,
}

/// Where one tile of a layout comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Origin {
    /// Index of the entry.
    pub(crate) entry: usize,
    /// Index of the tile of which it is an image, or its own.
    pub(crate) original: usize,
    /// Which of x, y, z are mirrored.
    pub(crate) mirrored: [bool; 3],
}

impl Origin {
    pub(crate) fn is_image(self) -> bool {
        self.mirrored != [false; 3]
    }

    /// The vector by which the original moves if its image moves by `shift`.
    pub(crate) fn shift_of_original(self, shift: DVec3) -> DVec3 {
        let sign = self.mirrored.map(|mirrored| if mirrored { -1.0 } else { 1.0 });
        DVec3::from(sign) * shift
    }
}

/// The index of the entry that makes the tile with this index.
pub(crate) fn entry_of(index: usize, entries: &[Entry]) -> usize {
    entries.partition_point(|entry| entry.first <= index) - 1
}

/// The origin of the tile with this index, among `count` tiles.
pub(crate) fn origin(index: usize, entries: &[Entry], count: usize) -> Origin {
    let entry = entry_of(index, entries);
    let first = entries[entry].first;
    let end = entries.get(entry + 1).map_or(count, |next| next.first);
    let axes = entries[entry].mirror.map_or(&[][..], |mirror| &mirror.axes);
    let copies = (end - first) >> axes.len();
    let images = (index - first) / copies;
    let mut mirrored = [false; 3];
    for (bit, axis) in axes.iter().enumerate() {
        mirrored[axis.index()] = images >> bit & 1 == 1;
    }
    Origin { entry, original: first + (index - first) % copies, mirrored }
}

#[cfg(test)]
mod tests {
    use super::*;
    use magsplice_magnet::Axis;

    use crate::tile::repeat::Reflection;

    #[test]
    fn images_know_their_original_and_their_mirrors() {
        let mirror = MirrorTable { axes: vec![Axis::Y, Axis::X], at_mm: [0.0; 3], polarization: Reflection::Reflect };
        let entry = |first, mirror| Entry { start: 0, first, mirror };
        // Three tiles, two copies with their images, three copies.
        let entries = [entry(0, None), entry(3, Some(&mirror)), entry(11, None)];
        let of = |index| origin(index, &entries, 14);
        let expected = |entry, original, mirrored| Origin { entry, original, mirrored };
        assert_eq!(of(0), expected(0, 0, [false; 3]));
        assert_eq!(of(2), expected(0, 2, [false; 3]));
        assert_eq!(of(4), expected(1, 4, [false; 3]));
        assert_eq!(of(5), expected(1, 3, [false, true, false]));
        assert_eq!(of(8), expected(1, 4, [true, false, false]));
        assert_eq!(of(10), expected(1, 4, [true, true, false]));
        assert_eq!(of(12), expected(2, 12, [false; 3]));
        assert_eq!(of(8).shift_of_original(DVec3::new(1.0, 2.0, 3.0)), DVec3::new(-1.0, 2.0, 3.0));
    }
}
