use rustc_hash::FxHashMap;

use super::*;
use crate::{
    lens::{
        ramp::RampColors,
        thematic::{LegendEntry, LegendKind, Rule, ThematicScale},
    },
    render::furniture::{Panel, Piece},
    scene::{LegendPlace, TextSize},
};

/// A legend of so many categories, `other` and `no data`.
fn categories(count: usize) -> Legend {
    let entry = |label: String, kind| LegendEntry { label, color: [0.5; 3], count: 1, kind };
    let mut legend: Vec<LegendEntry> =
        (0..count).map(|i| entry(format!("category number {i}"), LegendKind::Value)).collect();
    legend.push(entry("other".into(), LegendKind::Other));
    legend.push(entry("no data".into(), LegendKind::NoData));
    let rule = Rule::Categories { colors: FxHashMap::default() };
    let scale = ThematicScale {
        attribute: "a".into(),
        measure: None,
        rule,
        legend,
        no_data: [0.5; 3],
        threshold: None,
        relief: 0.1,
        counts: false,
        histogram: Vec::new(),
    };
    Legend { title: "An attribute".into(), unit: Some("m²".into()), lenses: vec![("a lens".into(), [1.0; 3])], scale }
}

fn ramp(min: f64, max: f64) -> Legend {
    let rule = Rule::Ramp { colors: RampColors::named("viridis"), min, max };
    let mut legend = categories(0);
    legend.scale.rule = rule;
    legend
}

fn figure(legend: LegendPlace) -> Figure {
    Figure {
        legend,
        title: Some("A title that says what is to be seen in this picture of a city".into()),
        caption: Some("A caption\nof several lines, the second of which is too long to stand on one of them.".into()),
        ..Figure::default()
    }
}

/// The cards: panels that are nearly white and nearly opaque.
fn cards(furniture: &Furniture) -> Vec<Panel> {
    let panels = furniture.pieces.iter().filter_map(|piece| match piece {
        Piece::Panel(panel) => Some(*panel),
        _ => None,
    });
    panels.filter(|p| p.color == [1.0; 3] && p.opacity < 1.0).collect()
}

fn texts(furniture: &Furniture) -> Vec<&str> {
    let mut texts = Vec::new();
    for piece in &furniture.pieces {
        if let Piece::Text(line) = piece {
            texts.push(line.text.as_str());
        }
    }
    texts
}

const PLACES: [LegendPlace; 5] = [
    LegendPlace::Auto,
    LegendPlace::Corner(Corner::TopLeft),
    LegendPlace::Corner(Corner::TopRight),
    LegendPlace::Corner(Corner::BottomLeft),
    LegendPlace::Corner(Corner::BottomRight),
];

#[test]
fn cards_stay_inside_and_apart_at_every_size() {
    let sizes = [[1, 1], [64, 64], [320, 240], [640, 360], [1280, 720], [3000, 1688], [400, 2000], [5000, 200]];
    for size in sizes {
        for place in PLACES {
            let furniture = lay_out(&figure(place), &[categories(9), ramp(0.0, 1.0)], size);
            let cards = cards(&furniture);
            let [w, h] = size.map(|side| side as f32);
            for (i, card) in cards.iter().enumerate() {
                let inside = card.low.iter().all(|v| *v > 0.0) && card.high[0] < w && card.high[1] < h;
                assert!(inside, "{size:?} {place:?}: {card:?}");
                for other in &cards[..i] {
                    let apart = (0..2).any(|k| card.low[k] >= other.high[k] || other.low[k] >= card.high[k]);
                    assert!(apart, "{size:?} {place:?}: {card:?} over {other:?}");
                }
            }
            if size[0] >= 640 && size[1] >= 360 {
                assert_eq!(cards.len(), 3, "{size:?} {place:?}");
                let legend = cards[2];
                assert!(legend.high[0] - legend.low[0] <= w / 3.0, "{size:?} {place:?}: {legend:?}");
                assert!(legend.high[1] - legend.low[1] <= 0.8 * h, "{size:?} {place:?}: {legend:?}");
                let Some(corner) = place.corner() else { panic!("every place has a corner") };
                assert_eq!(legend.low[0] < w / 2.0, corner.is_left(), "{size:?} {place:?}");
                // On the left it stands below the title or above the caption.
                let is_high = legend.low[1] + legend.high[1] < h;
                assert!(corner.is_left() || is_high == corner.is_top(), "{size:?} {place:?}");
            }
        }
    }
}

#[test]
fn text_stays_on_its_card() {
    let mut set = crate::render::text::Typesetter::default();
    for size in [[320, 240], [640, 360], [3000, 1688]] {
        let furniture = lay_out(&figure(LegendPlace::Auto), &[categories(14), ramp(-1e12, 3e12)], size);
        let cards = cards(&furniture);
        for piece in &furniture.pieces {
            let Piece::Text(line) = piece else { continue };
            let right = line.at[0] + set.width(&line.text, line.style);
            let on = |card: &Panel| {
                line.at[0] >= card.low[0]
                    && right <= card.high[0]
                    && line.at[1] - 0.7 * line.style.size_px > card.low[1]
                    && line.at[1] < card.high[1]
            };
            assert!(cards.iter().any(on), "{size:?}: \"{}\" at {:?}", line.text, line.at);
        }
    }
}

#[test]
fn what_does_not_fit_is_counted() {
    let figure = Figure { legend: LegendPlace::Auto, ..Figure::default() };
    let shown = |size: [u32; 2], legends: &[Legend]| {
        let furniture = lay_out(&figure, legends, size);
        texts(&furniture).iter().map(|t| (*t).to_owned()).collect::<Vec<String>>()
    };
    let all = shown([1280, 720], &[categories(14)]);
    assert!(all.iter().filter(|t| t.starts_with("category")).count() == 14 && !all.iter().any(|t| t.contains("more")));
    let some = shown([640, 200], &[categories(14)]);
    let kept = some.iter().filter(|t| t.starts_with("category")).count();
    assert!((1..14).contains(&kept), "{some:?}");
    assert!(some.contains(&format!("… and {} more", 14 - kept)), "{some:?}");
    assert!(some.contains(&"no data (1)".to_owned()) && some.contains(&"other".to_owned()), "{some:?}");
    let many: Vec<Legend> = (0..9).map(|i| ramp(0.0, f64::from(i + 1))).collect();
    let some = shown([640, 360], &many);
    let kept = some.iter().filter(|t| *t == "An attribute").count();
    assert!((1..9).contains(&kept), "{some:?}");
    assert!(some.contains(&format!("… and {} more legends", 9 - kept)), "{some:?}");
}

#[test]
fn text_follows_the_picture_and_the_scene() {
    let auto = Figure::default();
    let em = |size| em_px(&auto, size);
    assert_eq!(em([1280, 720]), EM_PX);
    assert_eq!(em([2560, 1440]), 2.0 * EM_PX);
    assert_eq!(em([2560, 720]), EM_PX);
    assert_eq!(em([64, 64]), LEAST_EM_PX);
    let of = |text, dpi| em_px(&Figure { text: Some(text), dpi, ..auto.clone() }, [64, 64]);
    assert_eq!(of(TextSize::Pixels(20.0), None), 20.0);
    assert_eq!(of(TextSize::Pixels(20.0), Some(300.0)), 20.0);
    // N points at D dots per inch are N D / 72 pixels; without D at 96.
    assert_eq!(of(TextSize::Points(9.0), Some(300.0)), 37.5);
    assert_eq!(of(TextSize::Points(9.0), Some(72.0)), 9.0);
    assert_eq!(of(TextSize::Points(9.0), None), 12.0);
    // What is not given in points does not follow the dots.
    assert_eq!(em_px(&Figure { dpi: Some(300.0), ..auto.clone() }, [1280, 720]), EM_PX);
}

#[test]
fn ramps_have_round_numbers_below_them() {
    let figure = Figure { legend: LegendPlace::Auto, ..Figure::default() };
    let numbers = |min, max| {
        let furniture = lay_out(&figure, &[ramp(min, max)], [1280, 720]);
        let is_number = |t: &&&str| t.contains(|c: char| c.is_ascii_digit()) && !t.starts_with("no data");
        texts(&furniture).iter().filter(is_number).map(|t| (*t).into()).collect()
    };
    let years: Vec<String> = numbers(1653.0, 2019.0);
    assert_eq!(years, ["1700", "1800", "1900", "2000"]);
    let shares: Vec<String> = numbers(0.0, 1.0);
    assert_eq!(shares, ["0.0", "0.5", "1.0"]);
    // No two round numbers inside: the ends.
    let narrow: Vec<String> = numbers(1e9 + 0.5, 1e9 + 0.75);
    assert!(narrow.len() <= 2, "{narrow:?}");
}
