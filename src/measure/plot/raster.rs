//! The drawing as pixels, with the fonts of the program and no others.

use std::sync::{Arc, LazyLock};

use resvg::{
    tiny_skia::{Pixmap, Transform},
    usvg::{Options, Tree, fontdb},
};

use crate::render::text::fonts;

static FONTS: LazyLock<Arc<fontdb::Database>> = LazyLock::new(|| database(&[fonts::REGULAR, fonts::SEMI_BOLD]));
/// With what the first have no letters for.
static ALL_FONTS: LazyLock<Arc<fontdb::Database>> =
    LazyLock::new(|| database(&[fonts::REGULAR, fonts::SEMI_BOLD, fonts::fallback_data()]));

fn database(files: &[&'static [u8]]) -> Arc<fontdb::Database> {
    let mut found = fontdb::Database::new();
    for file in files {
        found.load_font_source(fontdb::Source::Binary(Arc::new(*file)));
    }
    Arc::new(found)
}

/// Size and pixels (sRGB, opaque) of an SVG drawing at `scale` pixels per CSS pixel.
///
/// # Errors
/// The text is no SVG drawing, or too large a one.
pub fn pixels(svg: &str, scale: f32) -> Result<([u32; 2], Vec<[u8; 4]>), String> {
    let fonts = if svg.chars().all(|c| c.is_control() || fonts::is_in_first(c)) { &FONTS } else { &ALL_FONTS };
    let options = Options { fontdb: Arc::clone(fonts), font_family: "Inter".to_owned(), ..Options::default() };
    let tree = Tree::from_str(svg, &options).map_err(|error| error.to_string())?;
    let size = tree.size().to_int_size().scale_by(scale).ok_or("a drawing of no size")?;
    let mut pixmap = Pixmap::new(size.width(), size.height()).ok_or("a drawing that is too large")?;
    pixmap.fill(resvg::tiny_skia::Color::WHITE);
    resvg::render(&tree, Transform::from_scale(scale, scale), &mut pixmap.as_mut());
    // Opaque everywhere: premultiplied is straight.
    Ok(([size.width(), size.height()], bytemuck::cast_slice(pixmap.data()).to_vec()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::plot::svg::{Anchor, Font, Svg};

    #[test]
    fn text_leaves_ink_without_fonts_of_the_system() {
        let drawn = |text: &str, is_strong: bool| {
            let mut svg = Svg::new([60.0, 20.0], "", "");
            svg.text([5.0, 15.0], Anchor::Start, Font { size: 12.0, is_strong, color: "#000000" }, text);
            let (size, pixels) = pixels(&svg.finish(), 2.0).unwrap();
            assert_eq!((size, pixels.len()), ([120, 40], 4800));
            pixels.iter().map(|p| 255 - u32::from(p[0])).sum::<u32>()
        };
        assert_eq!(drawn("", false), 0);
        assert!(drawn("Veduta", false) > 10_000);
        assert!(drawn("Veduta", true) > drawn("Veduta", false), "semi-bold is darker");
        let [han, other] = ["東京", "京東"].map(|text| drawn(text, false));
        assert!(han > 10_000 && han.abs_diff(other) * 20 < han, "{han} {other}");
        assert!(pixels("no drawing", 1.0).is_err());
    }
}
