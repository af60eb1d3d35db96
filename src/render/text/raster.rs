//! One line of text as coverage, pixel by pixel: of the letters, and of the halo around them.

use swash::{
    scale::{Render, Source},
    zeno::{Join, Stroke, Vector},
};

use crate::{
    lens::color::{Srgb, linear_from_srgb},
    render::text::{Halo, TextLine, Typesetter, cleaned, size_of},
};

/// A line of text as pixels of the picture.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Run {
    /// Left, top, pixels of the picture.
    pub origin: [u32; 2],
    /// Width, height.
    pub size: [u32; 2],
    /// Coverage by letters and by their halo, row by row, 0..=255.
    pub texels: Vec<[u8; 2]>,
}

/// The image of one glyph, placed in the picture; rows go down.
struct Stamp {
    left: i64,
    top: i64,
    width: usize,
    data: Vec<u8>,
    part: Part,
}

/// What of a glyph a stamp is.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Part {
    /// What its outline encloses.
    Letter,
    /// A line along its outline, which makes it heavier.
    Weight,
    /// A wide line along its outline.
    Halo,
}

impl Typesetter {
    /// The pixels of a line within a picture of `size`; `None` where there are none.
    pub fn rasterised(&mut self, line: &TextLine, size: [u32; 2]) -> Option<Run> {
        let is_near = line.at.iter().all(|at| at.is_finite() && at.abs() < 1e6);
        let stamps = if is_near { self.stamps(line, size) } else { Vec::new() };
        let inside = |v: i64, side: u32| v.clamp(0, i64::from(side));
        let mut bounds: Option<[i64; 4]> = None;
        for s in &stamps {
            let rows = (s.data.len() / s.width) as i64;
            let [x0, y0] = [inside(s.left, size[0]), inside(s.top, size[1])];
            let [x1, y1] = [inside(s.left + s.width as i64, size[0]), inside(s.top + rows, size[1])];
            if x0 < x1 && y0 < y1 {
                let all = bounds.unwrap_or([x0, y0, x1, y1]);
                bounds = Some([all[0].min(x0), all[1].min(y0), all[2].max(x1), all[3].max(y1)]);
            }
        }
        let [x0, y0, x1, y1] = bounds?;
        let mut run = Run {
            origin: [x0 as u32, y0 as u32],
            size: [(x1 - x0) as u32, (y1 - y0) as u32],
            texels: vec![[0; 2]; (x1 - x0) as usize * (y1 - y0) as usize],
        };
        for stamp in &stamps {
            run.put(stamp);
        }
        let bend: Vec<u8> = (0..=255_u8).map(|c| bent(c, line.color)).collect();
        run.texels.iter_mut().for_each(|texel| texel[0] = bend[usize::from(texel[0])]);
        Some(run)
    }

    /// The glyphs that may reach into the picture: so many as fit beside each other, however long the text.
    fn stamps(&mut self, line: &TextLine, size: [u32; 2]) -> Vec<Stamp> {
        let (glyphs, _) = self.shaped(&cleaned(&line.text), line.style);
        let halo = line.halo.filter(|h| h.width_px > 0.0 && h.opacity > 0.0);
        let stroke = |width: f32| {
            let mut stroke = Stroke::new(width);
            stroke.join(Join::Round);
            stroke
        };
        let mut stamps = Vec::new();
        for run in glyphs.chunk_by(|a, b| a.face == b.face) {
            let face = run[0].face;
            let heavier = face.emboldened_em() * size_of(line.style);
            let weight = (heavier > 0.0).then(|| (Part::Weight, Some(stroke(heavier))));
            let around = |h: Halo| (Part::Halo, Some(stroke(2.0 * h.width_px.min(size_of(line.style)) + heavier)));
            let parts = [Some((Part::Letter, None)), weight, halo.map(around)];
            let mut scaler = self.scale.builder(face.font()).size(size_of(line.style)).hint(false).build();
            for glyph in run {
                let (x, y) = (line.at[0] + glyph.x, line.at[1] - glyph.y);
                let reach = 3.0 * size_of(line.style);
                if !(-reach..size[0] as f32 + reach).contains(&x) || !(-reach..size[1] as f32 + reach).contains(&y) {
                    continue;
                }
                let (column, row) = (x.floor(), y.round());
                for (part, stroke) in parts.into_iter().flatten() {
                    let mut render = Render::new(&[Source::Outline]);
                    // Quarters of a pixel: letters stand evenly.
                    render.offset(Vector::new(((x - column) * 4.0).floor() / 4.0, 0.0));
                    if let Some(stroke) = stroke {
                        render.style(stroke);
                    }
                    let Some(image) = render.render(&mut scaler, glyph.id) else { continue };
                    let placed = image.placement;
                    if placed.width > 0 && placed.height > 0 {
                        stamps.push(Stamp {
                            left: column as i64 + i64::from(placed.left),
                            top: row as i64 - i64::from(placed.top),
                            width: placed.width as usize,
                            data: image.data,
                            part,
                        });
                    }
                }
            }
        }
        stamps
    }
}

impl Run {
    /// Lays a glyph over what is there: letters that touch add up, halos do not. A line along an outline lies half on the letter: where it
    /// covers a share of a pixel, it covers that share of what the letter leaves free.
    fn put(&mut self, stamp: &Stamp) {
        let [w, h] = self.size.map(i64::from);
        for (i, &coverage) in stamp.data.iter().enumerate() {
            let x = stamp.left + (i % stamp.width) as i64 - i64::from(self.origin[0]);
            let y = stamp.top + (i / stamp.width) as i64 - i64::from(self.origin[1]);
            if (0..w).contains(&x) && (0..h).contains(&y) {
                let texel = &mut self.texels[(y * w + x) as usize];
                texel[1] = texel[1].max(coverage);
                match stamp.part {
                    Part::Letter => texel[0] = texel[0].saturating_add(coverage),
                    Part::Weight => {
                        let [is, more] = [texel[0], coverage].map(u32::from);
                        texel[0] = (is + (more * (255 - is) + 127) / 255) as u8;
                    }
                    Part::Halo => {}
                }
            }
        }
    }
}

/// The coverage that, blended in linear light, looks as `coverage` blended in sRGB: what letters are drawn for. Dark
/// letters are taken to stand on white, light ones on black.
pub fn bent(coverage: u8, color: Srgb) -> u8 {
    let light = linear_from_srgb(color).iter().zip([0.2126, 0.7152, 0.0722]).map(|(c, weight)| c * weight).sum::<f32>();
    let gray =
        |linear: f32| if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 };
    let ground = if light < 0.2 { 1.0 } else { 0.0 };
    let share = f32::from(coverage) / 255.0;
    let seen = ground + (gray(light) - ground) * share;
    let [mixed, ..] = linear_from_srgb([seen; 3]);
    (255.0 * (mixed - ground) / (light - ground)).round().clamp(0.0, 255.0) as u8
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::text::{TextStyle, Weight};

    fn line(text: &str, at: [f32; 2]) -> TextLine {
        let style = TextStyle { size_px: 40.0, weight: Weight::Regular, tabular: false };
        TextLine { text: text.into(), at, style, color: [1.0; 3], halo: None }
    }

    #[test]
    fn coverage_is_bent_between_none_and_all() {
        for color in [[0.0; 3], [0.1, 0.2, 0.1], [0.5; 3], [0.9, 0.1, 0.1], [1.0; 3]] {
            assert_eq!((bent(0, color), bent(255, color)), (0, 255), "{color:?}");
            assert!((1..=255).all(|c| bent(c, color) >= bent(c - 1, color)), "{color:?}");
        }
        // Half covered, black on white: sRGB 0.5, whose linear light is 0.2140.
        assert_eq!(bent(128, [0.0; 3]), (255.0_f32 * (1.0 - 0.2122)).round() as u8);
        assert!(bent(128, [1.0; 3]) < 60);
    }

    #[test]
    fn a_bar_stands_where_it_should() {
        // U+25A0 is a filled square: its pixels are full inside and its box stands on the line.
        let run = Typesetter::default().rasterised(&line("■", [10.0, 50.0]), [100, 100]).expect("pixels");
        let full = run.texels.iter().filter(|t| t[0] == 255).count();
        assert!(full * 10 > run.texels.len() * 8, "{full} of {}", run.texels.len());
        assert!(run.origin[0] >= 10 && run.origin[1] + run.size[1] <= 60 && run.origin[1] > 10);
    }

    #[test]
    fn the_pixels_of_a_missing_glyph_are_a_box() {
        let run = Typesetter::default().rasterised(&line("ש", [10.0, 50.0]), [100, 100]).expect("a box");
        let [w, h] = run.size.map(|s| s as usize);
        let column = |x: usize| (0..h).filter(|y| run.texels[y * w + x][0] > 100).count();
        let sides = (0..w).filter(|&x| column(x) * 10 > h * 8).count();
        assert!(sides >= 2, "no two upright sides in {w}x{h}");
    }

    #[test]
    fn every_script_of_the_fonts_leaves_ink_and_no_boxes() {
        let mut set = Typesetter::default();
        let mut drawn = |text: &str, weight: Weight| {
            let mut line = line(text, [10.0, 50.0]);
            line.style.weight = weight;
            set.rasterised(&line, [100, 100]).expect("pixels")
        };
        let ink = |run: &Run| run.texels.iter().map(|texel| u32::from(texel[0])).sum::<u32>();
        for weight in [Weight::Regular, Weight::SemiBold] {
            let missing = drawn("ש", weight);
            let mut seen = vec![missing];
            for c in "城视臺京駅築のカ한글서ΑλЖя".chars() {
                let run = drawn(&c.to_string(), weight);
                assert!(ink(&run) > 255 * 40, "{c}");
                // Upright: in the em of 40 pixels that stands on the base line, a little below and above it.
                assert!(
                    run.origin[1] >= 14 && run.origin[1] + run.size[1] <= 60,
                    "{c}: {:?} {:?}",
                    run.origin,
                    run.size
                );
                assert!(!seen.contains(&run), "{c} looks like another");
                seen.push(run);
            }
        }
        assert!(ink(&drawn("京", Weight::SemiBold)) * 100 > ink(&drawn("京", Weight::Regular)) * 110, "no heavier");
    }

    #[test]
    fn scripts_beside_each_other_are_drawn_as_alone() {
        let mut set = Typesetter::default();
        let mut drawn = |text: &str, x: f32| set.rasterised(&line(text, [x, 50.0]), [200, 100]).expect("pixels");
        // 漢 is as wide as the em: its neighbour stands on a whole pixel.
        let (both, han, latin) = (drawn("漢H", 10.0), drawn("漢", 10.0), drawn("H", 50.0));
        let at = |run: &Run, x: u32, y: u32| {
            let [i, j] = [x.wrapping_sub(run.origin[0]), y.wrapping_sub(run.origin[1])];
            if i < run.size[0] && j < run.size[1] { run.texels[(j * run.size[0] + i) as usize][0] } else { 0 }
        };
        for (x, y) in (0..100).flat_map(|y| (0..200).map(move |x| (x, y))) {
            assert_eq!(at(&both, x, y), at(&han, x, y).saturating_add(at(&latin, x, y)), "{x} {y}");
        }
    }

    #[test]
    fn a_run_stays_inside_its_picture() {
        let mut set = Typesetter::default();
        for at in [[-300.0, 10.0], [90.0, 10.0], [10.0, 400.0], [f32::NAN, 0.0], [1e30, 5.0]] {
            if let Some(run) = set.rasterised(&line("wide enough", at), [100, 30]) {
                assert!(run.origin[0] + run.size[0] <= 100 && run.origin[1] + run.size[1] <= 30, "{at:?}");
                assert_eq!(run.texels.len(), run.size[0] as usize * run.size[1] as usize);
            }
        }
        assert_eq!(set.rasterised(&line("  ", [10.0, 10.0]), [100, 30]), None);
    }

    #[test]
    fn a_halo_surrounds_the_letters() {
        let mut set = Typesetter::default();
        let plain = set.rasterised(&line("l", [50.0, 50.0]), [100, 100]).expect("pixels");
        let halo = Some(Halo { color: [0.0; 3], width_px: 4.0, opacity: 1.0 });
        let with = set.rasterised(&TextLine { halo, ..line("l", [50.0, 50.0]) }, [100, 100]).expect("pixels");
        for side in 0..2 {
            let grown = with.size[side] as i64 - plain.size[side] as i64;
            assert!((7..=10).contains(&grown), "{grown}");
        }
        assert!(with.texels.iter().all(|[letter, halo]| halo >= letter || *letter == 255 || *halo > 200));
    }
}
