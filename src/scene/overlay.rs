//! Overlays: where the pictures of best-view lenses stand over the main one, and the lines that tie them to their places.

use std::path::PathBuf;

use crate::{
    lens::{Lens, best_view::LocalView, nearest::did_you_mean},
    scene::{check::SceneProblem, model::Scene},
};

/// The overlay of a best-view lens. Lengths are pixels of the picture; what is not given goes by its size ([`scale_of`]).
#[derive(Clone, Debug, PartialEq)]
pub struct Overlay {
    /// The name of its lens.
    pub lens: String,
    /// Who is placed first: higher before lower.
    pub priority: f64,
    /// Degree of interest, 0..1: how large it gets where the layout goes by interest.
    pub interest: f64,
    /// Where it stands.
    pub stand: Stand,
    /// Preferred size, pixels; `None`: by `share`.
    pub size: Option<[u32; 2]>,
    /// Preferred height as a share of that of a picture of 16 by 9 which just has room in this one, 0..=1, with [`Self::ASPECT`]; of one
    /// without a size.
    pub share: f64,
    /// It is made no smaller; `None`: half its preferred size.
    pub min: Option<[u32; 2]>,
    /// It is made no larger; `None`: its preferred size and a half.
    pub max: Option<[u32; 2]>,
    /// 0 to 1.
    pub opacity: f64,
    /// What is cut out of it and laid over it.
    pub frame: Frame,
    /// A line under what it shows.
    pub caption: Option<String>,
    /// How it is tied to its points of interest; `None`: it is not.
    pub line: Option<ContextLine>,
}

/// Where an overlay stands.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub enum Stand {
    /// Where the layout puts it.
    #[default]
    Laid,
    /// Its middle at these shares of the picture's width and height, 0..1 from the upper left; all of it within the
    /// margin.
    At([f64; 2]),
    /// In the scene, above its first point of interest.
    Scene(CallOut),
}

/// A tilted board in the scene that shows an overlay. Turned to the viewer about the vertical axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CallOut {
    /// From the top of the object to the lower edge, metres; `None`: by the sizes of both.
    pub height_m: Option<f64>,
    /// Width, metres; `None`: as wide in the picture as the overlay's preferred size.
    pub width_m: Option<f64>,
    /// How far its upper edge is tilted away from the viewer, radians: 0 upright, π/2 lying flat; -π/2..π/2.
    pub tilt: f64,
}

impl Default for CallOut {
    fn default() -> Self {
        Self { height_m: None, width_m: None, tilt: 30_f64.to_radians() }
    }
}

/// Alpha mask and frame mask of an overlay.
#[derive(Clone, Debug, PartialEq)]
pub enum Frame {
    /// One that is built in.
    BuiltIn(BuiltInFrame),
    /// Images, stretched over the overlay: what of it is seen (white) and what not (black), and what is laid over it.
    Images {
        /// Alpha mask; `None`: all is seen.
        alpha: Option<PathBuf>,
        /// Frame mask, with alpha; `None`: nothing.
        frame: Option<PathBuf>,
    },
}

impl Default for Frame {
    fn default() -> Self {
        Self::BuiltIn(BuiltInFrame::Rounded)
    }
}

/// Built-in frames.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum BuiltInFrame {
    /// Nothing but the picture.
    None,
    /// A white border with round corners and a soft shadow.
    #[default]
    Rounded,
    /// A thin dark line.
    Thin,
    /// A photographic print: white, wider below.
    Print,
    /// An ellipse with a white border.
    Ellipse,
    /// It fades out to all sides.
    Vignette,
}

impl BuiltInFrame {
    /// All, with their words in scene files.
    pub const WORDS: [(&str, Self); 6] = [
        ("none", Self::None),
        ("rounded", Self::Rounded),
        ("thin", Self::Thin),
        ("print", Self::Print),
        ("ellipse", Self::Ellipse),
        ("vignette", Self::Vignette),
    ];
}

/// Lines from an overlay to its points of interest. Lengths are pixels.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct ContextLine {
    /// How it runs.
    pub kind: LineKind,
    /// sRGB 0..1; `None`: the lens colour.
    pub color: Option<[f32; 3]>,
    /// Its widths at the overlay and at the place; `None`: [`Self::WIDTHS`] of a picture of 1280 by 720 pixels, as much of others.
    pub widths: [Option<f64>; 2],
    /// An image along it, with alpha: its left end at the overlay.
    pub skin: Option<PathBuf>,
    /// What it ends at.
    pub to: LineEnd,
    /// What is drawn where the place is out of the picture or behind the eye.
    pub outside: Outside,
    /// Beyond this distance of the place from the eye, metres, an arrow takes its place; `None`: never.
    pub arrow_distance_m: Option<f64>,
    /// It fades where it comes near the middle of the picture: nowhere seen within the first radius, all beyond the second.
    pub fade: Option<[f64; 2]>,
}

/// How a context line runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum LineKind {
    /// Straight.
    #[default]
    Straight,
    /// Along the sides of the picture.
    Orthogonal,
    /// In a curve.
    Curved,
}

impl LineKind {
    /// All, with their words in scene files.
    pub const WORDS: [(&str, Self); 3] =
        [("straight", Self::Straight), ("orthogonal", Self::Orthogonal), ("curved", Self::Curved)];
}

/// What a context line ends at.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum LineEnd {
    /// The middle of its place.
    #[default]
    Point,
    /// The outline of its object, which is drawn.
    Area,
}

impl LineEnd {
    /// All, with their words in scene files.
    pub const WORDS: [(&str, Self); 2] = [("point", Self::Point), ("area", Self::Area)];
}

/// What is drawn for a place that is not in the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Outside {
    /// An arrow at the border of the picture.
    #[default]
    Arrow,
    /// Nothing.
    Hidden,
}

impl Outside {
    /// All, with their words in scene files.
    pub const WORDS: [(&str, Self); 2] = [("arrow", Self::Arrow), ("hidden", Self::Hidden)];
}

/// Width and height of the picture that lengths in pixels are said of where the program chooses them.
const WIDTH_PX: f64 = 1280.0;
const HEIGHT_PX: f64 = 720.0;

/// How many times as large as in a picture of 1280 by 720 pixels something is in another one that has the same share of it, by its narrower side.
pub fn scale_of(picture: [u32; 2]) -> f64 {
    let [w, h] = picture.map(f64::from);
    (w / WIDTH_PX).min(h / HEIGHT_PX)
}

impl ContextLine {
    /// Widths at the overlay and at the place, pixels of a picture of 1280 by 720.
    pub const WIDTHS: [f64; 2] = [6.0, 1.5];

    /// Its widths at the overlay and at the place in a picture, pixels.
    pub fn widths_in(&self, picture: [u32; 2]) -> [f64; 2] {
        [0, 1].map(|end| self.widths[end].unwrap_or(Self::WIDTHS[end] * scale_of(picture)))
    }
}

/// How deep views may nest: overlays in overlays of the main picture's overlays.
pub const DEEPEST: usize = 3;

/// What is wrong with the overlays of a scene: names that nothing has, and views that show themselves.
pub fn problems(scene: &Scene) -> Vec<SceneProblem> {
    let mut problems = Vec::new();
    let mut note = |table: String, key: &str, message: String| {
        problems.push(SceneProblem { table, key: key.to_owned(), message, is_error: true });
    };
    let has_overlay = |lens: &&Lens| lens.kind.has_overlay();
    for (i, overlay) in scene.overlays.iter().enumerate() {
        let table = format!("overlay.{i}");
        match scene.lenses.iter().find(|lens| lens.name == overlay.lens) {
            None if overlay.lens.is_empty() => {}
            None => {
                let hint =
                    did_you_mean(&overlay.lens, scene.lenses.iter().filter(has_overlay).map(|l| l.name.as_str()));
                note(table.clone(), "lens", format!("there is no lens \"{}\"{hint}", overlay.lens));
            }
            Some(lens) if !lens.kind.has_overlay() => {
                let message =
                    format!("\"{}\" is a lens of kind \"{}\", which has no overlay", lens.name, lens.kind.word());
                note(table.clone(), "lens", message);
            }
            Some(lens) if scene.overlays[..i].iter().any(|other| other.lens == lens.name) => {
                note(table.clone(), "lens", format!("\"{}\" has an overlay already: a lens has one", lens.name));
            }
            Some(lens)
                if matches!(overlay.stand, Stand::Scene(_))
                    && lens.best_view().is_some_and(|shown| shown.pois.is_empty()) =>
            {
                let message = format!("stands above a point of interest, and lens \"{}\" has no poi", lens.name);
                note(table.clone(), "call_out", message);
            }
            Some(_) => {}
        }
        let is_over = |a: [u32; 2], b: [u32; 2]| a[0] > b[0] || a[1] > b[1];
        if overlay.min.zip(overlay.size).is_some_and(|(min, size)| is_over(min, size)) {
            note(table.clone(), "min", "is larger than size".to_owned());
        }
        if overlay.max.zip(overlay.size).is_some_and(|(max, size)| is_over(size, max)) {
            note(table.clone(), "max", "is smaller than size".to_owned());
        }
        if let Some([inner, outer]) = overlay.line.as_ref().and_then(|line| line.fade)
            && inner > outer
        {
            note(table, "line", "fade = [inner, outer]: the inner radius is larger than the outer one".to_owned());
        }
    }
    for (i, lens) in scene.lenses.iter().enumerate() {
        let Some(shown) = lens.best_view() else { continue };
        let table = format!("lens.{i}");
        for name in &shown.pois {
            if !scene.pois.iter().any(|poi| poi.name == *name) {
                let hint = did_you_mean(name, scene.pois.iter().map(|poi| poi.name.as_str()));
                note(table.clone(), "poi", format!("there is no point of interest \"{name}\"{hint}"));
            }
        }
        let is_of_poi = shown.view().is_some_and(LocalView::is_of_poi);
        if shown.pois.is_empty() && is_of_poi {
            note(table.clone(), "poi", "is missing: this view is of a point of interest".to_owned());
        }
        for name in shown.lenses.iter().flatten() {
            if !scene.lenses.iter().any(|lens| lens.name == *name) {
                let hint = did_you_mean(name, scene.lenses.iter().map(|lens| lens.name.as_str()));
                note(table.clone(), "lenses", format!("there is no lens \"{name}\"{hint}"));
            }
        }
        if let Some(chain) = too_deep(scene, &mut vec![i]) {
            let names: Vec<String> = chain.iter().map(|&i| format!("\"{}\"", scene.lenses[i].name)).collect();
            let is_cycle = chain[..chain.len() - 1].contains(&chain[chain.len() - 1]);
            let why = if is_cycle { "a view would show itself" } else { "views nest at most three deep" };
            note(table, "lenses", format!("{why}: {}", names.join(" shows ")));
        }
    }
    problems
}

/// A way from the last lens of `chain` over the lenses of overlays that leads back to the first of it or is too long.
fn too_deep(scene: &Scene, chain: &mut Vec<usize>) -> Option<Vec<usize>> {
    let last = scene.lenses.get(*chain.last()?)?;
    for name in last.best_view().into_iter().flat_map(|shown| shown.lenses.iter().flatten()) {
        let Some(next) = scene.lenses.iter().position(|lens| lens.name == *name && lens.kind.has_overlay()) else {
            continue;
        };
        let is_cycle = chain.first() == Some(&next);
        // A cycle that this lens is not on is told where it is.
        if chain[1..].contains(&next) {
            continue;
        }
        chain.push(next);
        if is_cycle || chain.len() > DEEPEST {
            return Some(chain.clone());
        }
        if let Some(found) = too_deep(scene, chain) {
            return Some(found);
        }
        chain.pop();
    }
    None
}

impl Overlay {
    /// Preferred height where nothing is said: 160 pixels of 720.
    pub const SHARE: f64 = 2.0 / 9.0;
    /// Width over height where only a share is said.
    pub const ASPECT: f64 = 1.5;

    /// Preferred size in a picture, pixels, at least 1.
    pub fn size_in(&self, picture: [u32; 2]) -> [u32; 2] {
        self.size.unwrap_or_else(|| {
            let height = self.share * HEIGHT_PX * scale_of(picture);
            [Self::ASPECT * height, height].map(|side| (side.round() as u32).max(1))
        })
    }

    /// The overlay of a lens that says nothing of it.
    pub fn of(lens: &str) -> Self {
        Self {
            lens: lens.to_owned(),
            priority: 0.0,
            interest: 0.5,
            stand: Stand::default(),
            size: None,
            share: Self::SHARE,
            min: None,
            max: None,
            opacity: 1.0,
            frame: Frame::default(),
            caption: None,
            line: Some(ContextLine::default()),
        }
    }
}

/// How overlays are laid out.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Layout {
    /// Where they stand.
    pub along: Along,
    /// What their sizes go by.
    pub sizes: Sizes,
    /// Whether the overlay nearest to the middle of the picture is in the middle of its row.
    pub exploration_focus: bool,
    /// Between overlays and the border of the picture, pixels; `None`: [`Self::MARGIN`] of a picture of 1280 by 720, as much of others.
    pub margin_px: Option<f64>,
    /// Between overlays, pixels; `None`: [`Self::GAP`], likewise.
    pub gap_px: Option<f64>,
}

impl Layout {
    /// To the border of a picture of 1280 by 720, pixels.
    pub const MARGIN: f64 = 16.0;
    /// Between overlays of such a picture, pixels.
    pub const GAP: f64 = 12.0;

    /// The margin in a picture, whole pixels.
    pub fn margin_in(&self, picture: [u32; 2]) -> u32 {
        self.margin_px.unwrap_or(Self::MARGIN * scale_of(picture)).round() as u32
    }

    /// The gap in a picture, whole pixels.
    pub fn gap_in(&self, picture: [u32; 2]) -> u32 {
        self.gap_px.unwrap_or(Self::GAP * scale_of(picture)).round() as u32
    }
}

/// Where overlays stand.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Along {
    /// In a row at the top.
    Top,
    /// In a row at the bottom.
    Bottom,
    /// In a column on the left.
    Left,
    /// In a column on the right.
    Right,
    /// In two columns.
    Sides,
    /// All around.
    #[default]
    Border,
}

impl Along {
    /// All, with their words in scene files.
    pub const WORDS: [(&str, Self); 6] = [
        ("top", Self::Top),
        ("bottom", Self::Bottom),
        ("left", Self::Left),
        ("right", Self::Right),
        ("sides", Self::Sides),
        ("border", Self::Border),
    ];
}

/// What the sizes of overlays go by.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Sizes {
    /// Their preferred sizes.
    #[default]
    Preferred,
    /// How near their places are.
    Distance,
    /// Their degrees of interest.
    Interest,
}

impl Sizes {
    /// All, with their words in scene files.
    pub const WORDS: [(&str, Self); 3] =
        [("preferred", Self::Preferred), ("distance", Self::Distance), ("interest", Self::Interest)];
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_given_has_the_same_share_of_every_picture() {
        let plain = Overlay::of("a");
        for (picture, size, margin) in [
            ([1280, 720], [240, 160], 16),
            ([4096, 2160], [720, 480], 48),
            ([320, 200], [60, 40], 4),
            ([720, 1280], [135, 90], 9),
        ] {
            assert_eq!((plain.size_in(picture), Layout::default().margin_in(picture)), (size, margin), "{picture:?}");
        }
        let half = Overlay { share: 0.5, ..Overlay::of("a") };
        assert_eq!(half.size_in([1280, 720]), [540, 360]);
        let pixels = Overlay { size: Some([300, 90]), ..half };
        assert_eq!(pixels.size_in([4096, 2160]), [300, 90], "pixels stay pixels");
        let line = ContextLine { widths: [None, Some(2.0)], ..ContextLine::default() };
        assert_eq!(line.widths_in([2560, 1440]), [12.0, 2.0]);
        assert_eq!(plain.size_in([1, 1]), [1, 1]);
    }
}
