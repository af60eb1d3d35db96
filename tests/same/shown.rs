//! Pictures of differences.

use std::path::Path;

use image::{Rgba, RgbaImage};

/// Writes both pictures and where they differ beside each other: changed pixels red on grey. `false` where the files are no two
/// pictures of one size.
pub fn side_by_side(before: &Path, now: &Path, file: &Path) -> Result<bool, String> {
    if before.extension().is_none_or(|extension| extension != "png") || !before.is_file() || !now.is_file() {
        return Ok(false);
    }
    let read = |path: &Path| {
        image::open(path).map(|picture| picture.to_rgba8()).map_err(|error| format!("{}: {error}", path.display()))
    };
    let [a, b] = [read(before)?, read(now)?];
    if a.dimensions() != b.dimensions() {
        return Ok(false);
    }
    let (width, height) = a.dimensions();
    let mut page = RgbaImage::new(3 * width, height);
    for (x, y, was) in a.enumerate_pixels() {
        let is = b.get_pixel(x, y);
        let grey = 128 + is.0[1] / 4;
        let mark = if was == is { Rgba([grey, grey, grey, 255]) } else { Rgba([220, 0, 0, 255]) };
        page.put_pixel(x, y, *was);
        page.put_pixel(x + width, y, *is);
        page.put_pixel(x + 2 * width, y, mark);
    }
    let folder = file.parent().unwrap_or(file);
    std::fs::create_dir_all(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    page.save(file).map(|()| true).map_err(|error| format!("{}: {error}", file.display()))
}
