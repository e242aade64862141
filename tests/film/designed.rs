//! The rules of docs/design.md for designed films that `magsplice check` does not check.

use std::fs;

use glam::DQuat;
use magsplice::layout::{Layout, Variable};
use magsplice_field::overlaps;

use crate::shipped::folder;

#[test]
fn designed_films_keep_their_size_strength_cuts_and_parts() {
    let files = fs::read_dir(folder()).expect("layouts").map(|entry| entry.expect("an entry").path());
    let is_designed = |name: &str| name.starts_with("designed-") || name.starts_with("robust-");
    let designed = files.filter(|path| path.file_name().is_some_and(|name| is_designed(&name.to_string_lossy())));
    let mut count = 0;
    for path in designed {
        let layout = Layout::read(&path).unwrap_or_else(|error| panic!("{error}"));
        let name = &layout.name;
        // The film spans two wavelengths, like the published film.
        let half_mm = layout.ideal.expect("an ideal film").wavelength();
        let brief = layout.brief.as_ref().expect("a design");
        let least_mm = brief.smallest_cut_mm.unwrap_or(0.8);
        assert!(layout.tiles.len() <= 60, "{name}");
        let tiles = layout.bare_tiles();
        assert_eq!(overlaps(&tiles).count(), 0, "{name}");
        for tile in &tiles {
            let reach = tile.position().abs() + 0.5 * tile.size();
            assert!(reach.x <= half_mm + 1e-9 && reach.y <= half_mm + 1e-9, "{name}: {reach}");
            assert!(tile.size().x.min(tile.size().y) >= least_mm - 1e-9, "{name}: {}", tile.size());
            assert!((tile.polarization_t().length() - 0.12).abs() < 1e-15, "{name}");
            assert!(brief.varies(Variable::Tilt) || tile.polarization_t().z == 0.0, "{name}");
            assert_eq!(tile.rotation(), DQuat::IDENTITY, "{name}");
        }
        if let Some(parts) = brief.parts {
            assert!(layout.parts().len() <= parts, "{name}: {} parts", layout.parts().len());
        }
        assert_eq!(layout.history.len(), 1, "{name}");
        count += 1;
    }
    assert!(count >= 12, "{count} designed films");
}
