//! The numbers below a cell of a sheet.

use serde_json::json;

use crate::{
    figure::sheet::{Cell, CellFigure, Sheet},
    lens::Lens,
    measure::{ratio::Estimate, run::frame_ratio},
    render::{
        picture::{RenderError, Request, Studio},
        visible_share::share_in,
    },
    scene::Scene,
};

/// The numbers found of one cell; `None`: not asked for.
#[derive(Clone, Debug, Default)]
pub struct Figures {
    /// The share of the point of interest that is seen; `None` within: it is not in the picture.
    share: Option<Option<f64>>,
    /// The objects that its lenses mean.
    touched: Option<Touched>,
    /// Time of the frame against that of the plain one.
    ratio: Option<Estimate>,
}

/// City objects that lenses act on.
#[derive(Clone, Copy, Debug)]
enum Touched {
    /// Roots that the occlusion lenses of a scene found.
    Occluders(u64),
    /// Objects of another scene of which a triangle meets a volume, parts by themselves.
    Objects(u64),
}

/// Finds what a sheet asks for of a cell.
pub fn of(studio: &mut Studio, cell: &Cell, sheet: &Sheet) -> Result<Figures, RenderError> {
    let wants = |figure| sheet.figures.contains(&figure);
    let mut found = Figures::default();
    let scene = &*studio.on_ground(&cell.scene)?;
    if let (true, Some(id)) = (wants(CellFigure::VisibleShare), &cell.poi) {
        found.share = Some(share_in(studio, scene, scene.figure.pixels(), id)?);
    }
    if wants(CellFigure::Occluders) {
        let asked = Request { statistics: true, ..Request::plain(scene.figure.pixels()) };
        let statistics = studio.render(&with_its_occluders(scene), &asked)?.statistics;
        let occluders = statistics.lenses.iter().filter_map(|lens| lens.occluders.as_ref());
        let found_by_each: Vec<u64> = occluders.map(|list| list.len() as u64).collect();
        found.touched = Some(match &found_by_each[..] {
            [] => Touched::Objects(statistics.lenses.iter().map(|lens| lens.objects).sum()),
            each => Touched::Occluders(each.iter().sum()),
        });
    }
    if wants(CellFigure::FrameRatio) {
        let plain = Scene { lenses: Vec::new(), ..scene.clone() };
        found.ratio = Some(frame_ratio(studio, scene, &plain, scene.figure.pixels(), sheet.pairs)?);
    }
    Ok(found)
}

/// A scene whose occlusion lenses find what they look for: where none of them is enabled, all are. What hides something does so whether or not it is
/// drawn in another way.
fn with_its_occluders(scene: &Scene) -> Scene {
    let mut own = scene.clone();
    let finds = |lens: &Lens| lens.occluders().is_some();
    if !own.lenses.iter().any(|lens| finds(lens) && lens.enabled) {
        own.lenses.iter_mut().filter(|lens| finds(lens)).for_each(|lens| lens.enabled = true);
    }
    own
}

impl Figures {
    /// The line below the cell.
    pub fn text(&self, figure: CellFigure) -> String {
        match figure {
            CellFigure::VisibleShare => match self.share.flatten() {
                Some(share) => format!("visible share {}", percent(share)),
                None => "out of the picture".to_owned(),
            },
            CellFigure::Occluders => match self.touched.unwrap_or(Touched::Objects(0)) {
                Touched::Occluders(1) => "1 occluder".to_owned(),
                Touched::Occluders(count) => format!("{count} occluders"),
                Touched::Objects(1) => "1 object touched".to_owned(),
                Touched::Objects(count) => format!("{count} objects touched"),
            },
            CellFigure::FrameRatio => match self.ratio {
                Some(ratio) => format!("frame × {:.2} ({:.2}–{:.2})", ratio.median, ratio.low, ratio.high),
                None => "–".to_owned(),
            },
        }
    }

    /// All of them, with the names of the cell.
    pub fn json(&self, cell: &Cell) -> serde_json::Value {
        let mut all = json!({ "name": cell.name, "row": cell.row, "column": cell.column });
        if let Some(share) = self.share {
            all[CellFigure::VisibleShare.word()] = json!(share);
        }
        if let Some(Touched::Occluders(count) | Touched::Objects(count)) = self.touched {
            all[CellFigure::Occluders.word()] = json!(count);
        }
        if let Some(ratio) = self.ratio {
            all[CellFigure::FrameRatio.word()] = json!(ratio);
        }
        all
    }
}

/// A share as people read it: 0 % and 100 % only where it is that.
fn percent(share: f64) -> String {
    let whole = (100.0 * share).round();
    match whole {
        _ if share <= 0.0 => "0 %".to_owned(),
        _ if share >= 1.0 => "100 %".to_owned(),
        0.0 => "< 1 %".to_owned(),
        100.0 => "> 99 %".to_owned(),
        whole => format!("{whole} %"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_and_nothing_are_said_of_nothing_else() {
        let said = [0.0, 0.001, 0.426, 0.9999, 1.0].map(percent);
        assert_eq!(said, ["0 %", "< 1 %", "43 %", "> 99 %", "100 %"]);
    }
}
