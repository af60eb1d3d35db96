use glam::DVec3;
use rustc_hash::FxHashMap;

use super::*;
use crate::{
    geom::Aabb,
    lens::{
        ramp::RampColors,
        thematic::{LegendEntry, LegendKind, Rule, ThematicScale},
    },
    render::furniture::{Panel, Piece},
    scene::{Column, Paper, TextSize},
    view::{Camera, Projection},
};

/// Over an orthographic picture from above, 1000 m high.
fn view(size: [u32; 2]) -> View {
    let camera = Camera {
        projection: Projection::Orthographic { height_m: 1000.0 },
        ..Camera::looking(DVec3::new(0.0, -1.0, 500.0), DVec3::ZERO, 1.0)
    };
    View::new(camera, size, &Aabb::EMPTY).unwrap()
}

fn laid(figure: &Figure, legends: &[Legend], size: [u32; 2]) -> Furniture {
    lay_out(figure, &Contents { legends, ..Contents::default() }, &view(size), &[]).furniture
}

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

fn figure(legend: PiecePlace) -> Figure {
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

const PLACES: [PiecePlace; 5] = [
    PiecePlace::Auto,
    PiecePlace::Anchor(Anchor::TopLeft),
    PiecePlace::Anchor(Anchor::TopRight),
    PiecePlace::Anchor(Anchor::BottomLeft),
    PiecePlace::Anchor(Anchor::BottomRight),
];

#[test]
fn cards_stay_inside_and_apart_at_every_size() {
    let sizes = [[1, 1], [64, 64], [320, 240], [640, 360], [1280, 720], [3000, 1688], [400, 2000], [5000, 200]];
    for size in sizes {
        for place in PLACES {
            let furniture = laid(&figure(place), &[categories(9), ramp(0.0, 1.0)], size);
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
                let anchor = if let PiecePlace::Anchor(anchor) = place { anchor } else { Anchor::BottomRight };
                let [x, y] = anchor.share();
                assert_eq!(legend.low[0] < w / 2.0, x == 0.0, "{size:?} {place:?}");
                // On the left it stands below the title or above the caption.
                let is_high = legend.low[1] + legend.high[1] < h;
                assert!(x == 0.0 || is_high == (y == 0.0), "{size:?} {place:?}");
            }
        }
    }
}

#[test]
fn text_stays_on_its_card() {
    let mut set = crate::render::text::Typesetter::default();
    for size in [[320, 240], [640, 360], [3000, 1688]] {
        let furniture = laid(&figure(PiecePlace::Auto), &[categories(14), ramp(-1e12, 3e12)], size);
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
    let figure = Figure { legend: PiecePlace::Auto, ..Figure::default() };
    let shown = |size: [u32; 2], legends: &[Legend]| {
        let furniture = laid(&figure, legends, size);
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
    // On paper it is 7 points without being asked.
    let paper = Some(Paper::Column(Column::Single));
    let on_paper = Figure { paper, dpi: Some(600.0), ..auto.clone() };
    assert!((em_px(&on_paper, on_paper.pixels()) - 7.0 / 72.0 * 600.0).abs() < 1e-3);
    assert_eq!(em_px(&Figure { text: Some(TextSize::Pixels(20.0)), ..on_paper }, [64, 64]), 20.0);
    // What is not given in points does not follow the dots.
    assert_eq!(em_px(&Figure { dpi: Some(300.0), ..auto.clone() }, [1280, 720]), EM_PX);
}

#[test]
fn ramps_have_round_numbers_below_them() {
    let figure = Figure { legend: PiecePlace::Auto, ..Figure::default() };
    let numbers = |min, max| {
        let furniture = laid(&figure, &[ramp(min, max)], [1280, 720]);
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

/// The bar of a scale: its dark panel, and how many metres it says that it is.
fn scale(furniture: &Furniture) -> (Panel, f64) {
    let bars = furniture.pieces.iter().filter_map(|piece| match piece {
        Piece::Panel(panel) if panel.color == card::INK && panel.radius_px == 0.0 => Some(*panel),
        _ => None,
    });
    let said = texts(furniture).into_iter().filter_map(|text| {
        let (number, unit) = text.trim_end_matches(" here").split_once('\u{a0}')?;
        Some(number.replace('\u{2009}', "").parse::<f64>().ok()? * if unit == "km" { 1000.0 } else { 1.0 })
    });
    let (bars, said): (Vec<_>, Vec<_>) = (bars.collect(), said.collect());
    assert_eq!((bars.len(), said.len()), (1, 1), "{bars:?} {said:?}");
    (bars[0], said[0])
}

#[test]
fn a_scale_bar_is_as_long_as_it_says() {
    let asked = Figure { scale_bar: PiecePlace::Auto, ..Figure::default() };
    let mut seen = 0;
    for (i, height_m) in [3.0, 47.0, 800.0, 12_345.0].into_iter().enumerate() {
        for (eye, size) in [
            (DVec3::new(0.0, -0.001, 500.0), [1280, 720]),
            (DVec3::new(300.0, -200.0, 250.0), [1000, 1000]),
            (DVec3::new(-400.0, 100.0, 2.0), [640, 1200]),
        ] {
            let target = DVec3::new(10.0, 20.0, 3.0);
            let camera = Camera::looking(eye + target, target, 0.7);
            let flat = Camera { projection: Projection::Orthographic { height_m }, ..camera };
            for camera in
                [flat, Camera { projection: Projection::Perspective { fov_y: 0.3 + 0.2 * i as f64 }, ..camera }]
            {
                let view = View::new(camera, size, &Aabb::EMPTY).unwrap();
                let (bar, metres) = scale(&lay_out(&asked, &Contents::default(), &view, &[]).furniture);
                let across = view.basis.right;
                assert!(across.z.abs() < 1e-12, "level");
                let [from, to] = [-0.5, 0.5].map(|share| view.pixel(target + share * metres * across).unwrap());
                let (long, expected) = (f64::from(bar.high[0] - bar.low[0]), from.truncate().distance(to.truncate()));
                assert!((long / expected - 1.0).abs() < 0.005, "{long} for {expected} pixels of {metres} m");
                let share = long / f64::from(size[0]);
                assert!((0.12..0.33).contains(&share), "{share} of the width");
                if !view.is_orthographic() {
                    // It lies where it is true.
                    let middle = 0.5 * (bar.low[0] + bar.high[0]);
                    assert!((f64::from(middle) - 0.5 * (from.x + to.x)).abs() < 1.0);
                    assert!((f64::from(bar.low[1]) - from.y).abs() < 20.0);
                }
                seen += 1;
            }
        }
    }
    assert_eq!(seen, 24);
}

#[test]
fn a_bar_is_true_on_the_ground_in_a_picture_that_is_turned() {
    let asked = Figure { scale_bar: PiecePlace::Auto, ..Figure::default() };
    for up in [DVec3::new(0.6, 0.0, 1.0), DVec3::new(-1.0, 0.3, 0.2), DVec3::X] {
        let camera = Camera::looking(DVec3::new(0.0, -300.0, 250.0), DVec3::ZERO, 1.0);
        let camera = Camera { up, projection: Projection::Orthographic { height_m: 400.0 }, ..camera };
        let view = View::new(camera, [1280, 720], &Aabb::EMPTY).unwrap();
        let (bar, metres) = scale(&lay_out(&asked, &Contents::default(), &view, &[]).furniture);
        // The level way that goes across the picture, found by going round.
        let ways = (0..36_000).map(|i| {
            let turn = f64::from(i) * std::f64::consts::PI / 36_000.0;
            let to = metres * DVec3::new(turn.cos(), turn.sin(), 0.0);
            (view.pixel(to).unwrap() - view.pixel(DVec3::ZERO).unwrap()).truncate()
        });
        let across = ways.min_by(|a, b| a.y.abs().total_cmp(&b.y.abs())).unwrap();
        let long = f64::from(bar.high[0] - bar.low[0]);
        assert!((long / across.x.abs() - 1.0).abs() < 0.005, "{up}: {long} of {across}");
    }
}

#[test]
fn a_bar_elsewhere_in_a_perspective_is_true_there() {
    let camera = Camera::looking(DVec3::new(0.0, -400.0, 200.0), DVec3::ZERO, 0.8);
    let view = View::new(camera, [1280, 720], &Aabb::EMPTY).unwrap();
    let bar = |place| lay_out(&Figure { scale_bar: place, ..Figure::default() }, &Contents::default(), &view, &[]);
    let pixel_m = |laid: &Laid| {
        let (bar, metres) = scale(&laid.furniture);
        metres / f64::from(bar.high[0] - bar.low[0])
    };
    let [near, middle, far] = [PiecePlace::At([0.5, 0.85]), PiecePlace::Auto, PiecePlace::At([0.5, 0.3])].map(bar);
    assert!(pixel_m(&near) < pixel_m(&middle) && pixel_m(&middle) < pixel_m(&far));
    // The ground 0.85 of the height down: where the ray meets z = 0.
    let ray = view.ray(glam::DVec2::new(640.0, 0.85 * 720.0));
    let depth = view.depth(ray.at(-ray.origin.z / ray.direction.z));
    assert!((pixel_m(&near) / view.pixel_m(depth) - 1.0).abs() < 1e-5);
    // There is no ground in the sky.
    let level = Camera::looking(DVec3::new(0.0, -400.0, 20.0), DVec3::ZERO, 0.8);
    let view = View::new(level, [1280, 720], &Aabb::EMPTY).unwrap();
    let sky = lay_out(
        &Figure { scale_bar: PiecePlace::At([0.5, 0.1]), ..Figure::default() },
        &Contents::default(),
        &view,
        &[],
    );
    assert_eq!((sky.left_out, sky.furniture.is_empty()), (vec!["scale bar"], true));
}

#[test]
fn an_arrow_points_to_the_north_as_the_camera_sees_it() {
    let asked = Figure { north_arrow: PiecePlace::Auto, ..Figure::default() };
    for (eye, fov_y) in [
        (DVec3::new(0.0, -0.001, 900.0), None),
        (DVec3::new(300.0, -200.0, 250.0), None),
        (DVec3::new(300.0, 200.0, 150.0), Some(0.8)),
        (DVec3::new(-250.0, 20.0, 60.0), Some(1.2)),
        (DVec3::new(0.0, -500.0, 15.0), Some(0.6)),
    ] {
        let camera = Camera::looking(eye, DVec3::ZERO, fov_y.unwrap_or(1.0));
        let projection =
            fov_y.map_or(Projection::Orthographic { height_m: 300.0 }, |fov_y| Projection::Perspective { fov_y });
        let view = View::new(Camera { projection, ..camera }, [1280, 720], &Aabb::EMPTY).unwrap();
        let laid = lay_out(&asked, &Contents::default(), &view, &[]);
        let card = cards(&laid.furniture)[0];
        let middle = glam::Vec2::from([0, 1].map(|axis| 0.5 * (card.low[axis] + card.high[axis])));
        let hand = laid.furniture.pieces.iter().find_map(|piece| match piece {
            Piece::Polygon(polygon) => Some(polygon.points[0]),
            _ => None,
        });
        let found = glam::Vec2::from(hand.unwrap()) - middle;
        // A metre to the north and one across, at the target.
        let pixel = |p: DVec3| view.pixel(p).unwrap().truncate();
        let north = (pixel(0.01 * DVec3::Y) - pixel(-0.01 * DVec3::Y)).as_vec2();
        let across = (pixel(0.01 * view.basis.right) - pixel(-0.01 * view.basis.right)).length() as f32;
        assert!(found.length() < 1.0 || found.angle_to(north).abs() < 0.02, "{eye}: {found} {north}");
        let short = found.length() / em_px(&asked, [1280, 720]) / 1.75;
        assert!((short - north.length() / across).abs() < 0.03, "{eye}: {short} of {}", north.length() / across);
    }
}

#[test]
fn pieces_stand_where_they_are_wanted() {
    let asked = Figure {
        title: Some("Title".into()),
        title_at: PiecePlace::Anchor(Anchor::Top),
        caption: Some("Caption".into()),
        caption_at: PiecePlace::At([0.3, 0.6]),
        scale_bar: PiecePlace::Anchor(Anchor::Right),
        north_arrow: PiecePlace::Anchor(Anchor::BottomLeft),
        ..Figure::default()
    };
    let found = cards(&laid(&asked, &[], [1280, 720]));
    let middle = |card: &Panel| [0, 1].map(|axis| 0.5 * (card.low[axis] + card.high[axis]));
    let [title, caption, bar, arrow] = &found[..] else { panic!("four cards") };
    assert!((middle(title)[0] - 640.0).abs() < 1.0 && title.low[1] == 16.0, "{title:?}");
    assert!((middle(caption)[0] - 384.0).abs() < 1.0 && (middle(caption)[1] - 432.0).abs() < 1.0, "{caption:?}");
    assert!(bar.high[0] == 1264.0 && (middle(bar)[1] - 360.0).abs() < 1.0, "{bar:?}");
    assert!(arrow.low[0] == 16.0 && arrow.high[1] == 704.0, "{arrow:?}");
}
