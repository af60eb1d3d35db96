use std::f64::consts::{FRAC_PI_2, PI};

use super::*;
use crate::{
    figure::scene_file::{Options, parse, to_toml},
    geom::combination::Operation,
};

/// The shape of a lens, as a scene file gives it.
fn shape(text: &str) -> Region {
    let lens = format!("veduta = 1\n[[lens]]\nname = \"a\"\neffects = [\"sepia\"]\nshape = {{ {text} }}\n");
    parse(&lens, "scene", &Options::for_command_line()).unwrap().lenses[0].shapes[0].clone()
}

const ALL: [&str; 13] = [
    "kind = \"sphere\", center = [1, 2, 3], radius = 10",
    "kind = \"ellipsoid\", center = [1, 2, 3], radii = [5, 9, 7], rotation_deg = [20, 10, 0]",
    "kind = \"box\", center = [1, 2, 3], size = [20, 40, 10], rotation_deg = [30, 0, 0]",
    "kind = \"cylinder\", center = [1, 2, 3], radius = 8, height = 30, axis = [1, 0, 1]",
    "kind = \"cone\", center = [1, 2, 3], radius = 8, height = 30",
    "kind = \"frustum\", center = [1, 2, 3], radius = 8, top_radius = 4, height = 30",
    "kind = \"flat\", center = [1, 2, 3], radius = 6",
    "kind = \"flat\", center = [1, 2, 3], size = [8, 6], rotation_deg = [40, 0, 90]",
    "kind = \"flat\", center = [1, 2, 3], points = [[-5, -4], [5, -4], [0, 6]]",
    "kind = \"convex\", points = [[0, 0, 0], [9, 0, 0], [0, 9, 0], [0, 0, 9]]",
    "kind = \"corridor\", points = [[0, 0, 2], [60, 10, 2], [90, 80, 5]], width = 12, height = 30",
    "kind = \"mask\", points = [[0, 0], [90, 0], [60, 80]], holes = [[[40, 10], [50, 10], [50, 20]]], base = -5, height = 60",
    "kind = \"union\", shapes = [{ kind = \"sphere\", center = [0, 0, 0], radius = 9 }, { kind = \"box\", center = [6, 0, 0], size = [4, 4, 4] }]",
];

fn level(_: DVec2) -> Option<f64> {
    Some(2.5)
}

fn place_of(region: &Region, kind: GizmoKind) -> DVec3 {
    gizmos(region, &level).into_iter().find(|(own, _)| *own == kind).unwrap().1
}

#[test]
fn every_shape_moves_with_all_that_is_held_of_it() {
    let by = DVec3::new(-7.25, 4.5, 1.125);
    for text in ALL {
        let before = shape(text);
        let mut after = before.clone();
        move_by(&mut after, by);
        // Without a ground below: what is of no height of its own is held where that is.
        let [was, is] = [&before, &after].map(|region| gizmos(region, &|_| None));
        assert!(was.len() == is.len() && !was.is_empty(), "{text}");
        for ((kind, from), (same, to)) in was.iter().zip(&is) {
            assert!(kind == same && to.distance(from + by) < 1e-9, "{text}: {kind:?} {from} {to}");
        }
        let [was, is] = [&before, &after].map(extent);
        assert!(is.min.distance(was.min + by) < 1e-9 && is.max.distance(was.max + by) < 1e-9, "{text}");
    }
}

#[test]
fn a_side_goes_where_it_is_dragged_and_the_opposite_one_stays_or_mirrors_it() {
    let mut count = 0;
    for text in ALL {
        let before = shape(text);
        let Some(block) = block(&before) else { continue };
        for axis in (0..3).filter(|axis| block.has[*axis]) {
            for is_up in [true, false] {
                let out = block.half[axis] + 3.0;
                let mut after = before.clone();
                set_side(&mut after, axis, is_up, out, false);
                let way = if is_up { block.axis(axis) } else { -block.axis(axis) };
                let [side, opposite] = [is_up, !is_up].map(|is_up| place_of(&after, GizmoKind::Side { axis, is_up }));
                let wanted = block.center + out * way;
                assert!(side.distance(wanted) < 2e-3, "{text}: {axis} {is_up}: {side}, not {wanted}");
                let other = place_of(&before, GizmoKind::Side { axis, is_up: !is_up });
                let wanted = if block.is_centered { other - 3.0 * way } else { other };
                assert!(opposite.distance(wanted) < 2e-3, "{text}: {axis} {is_up}: {opposite}, not {wanted}");
                count += 1;
            }
        }
    }
    // Box and ellipsoid 6, cylinder, cone, frustum and mask 2, the rectangle and the corridor 4.
    assert_eq!(count, 2 * 6 + 4 * 2 + 2 * 4);
}

#[test]
fn a_shape_that_is_resized_as_a_whole_keeps_its_middle_and_proportions() {
    for (text, axis) in [(ALL[1], 0), (ALL[2], 1), (ALL[5], 2), (ALL[7], 0)] {
        let before = shape(text);
        let mut after = before.clone();
        let was = block(&before).unwrap();
        set_side(&mut after, axis, false, 1.5 * was.half[axis], true);
        let is = block(&after).unwrap();
        assert!(is.center == was.center && is.half.distance(1.5 * was.half) < 2e-3, "{text}: {is:?}");
    }
    let Region::Shape(Shape::Frustum { radius, top_radius, .. }) = ({
        let mut frustum = shape(ALL[5]);
        set_radius(&mut frustum, 12.0);
        frustum
    }) else {
        panic!("a frustum")
    };
    assert_eq!((radius, top_radius), (12.0, 6.0));
}

#[test]
fn corners_go_where_they_are_dragged_and_nothing_else_does() {
    for text in ALL {
        let before = shape(text);
        for (index, _) in corners(&before, &level).iter().enumerate() {
            let mut after = before.clone();
            // In the plane of those that are in one.
            let to = DVec3::new(11.5, -20.25, if text.contains("flat") { 3.0 } else { 2.5 });
            set_corner(&mut after, index, to);
            for (i, at) in corners(&after, &level).iter().enumerate() {
                let wanted = if i == index { to } else { corners(&before, &level)[i] };
                assert!(at.distance(wanted) < 1e-9, "{text}: {i} of {index}: {at}, not {wanted}");
            }
        }
    }
}

#[test]
fn what_is_turned_is_so_about_its_middle_and_back_again() {
    let mut count = 0;
    for text in ALL {
        let before = shape(text);
        let Some(ahead) = heading(&before) else { continue };
        let mut after = before.clone();
        turn_by(&mut after, FRAC_PI_2);
        let now = heading(&after).unwrap();
        // Places are of whole millimetres.
        assert!(now.distance(DVec3::new(-ahead.y, ahead.x, 0.0)) < 3e-3, "{text}: {ahead} to {now}");
        let [was, is] = [&before, &after].map(|region| middle(region, &level).unwrap());
        assert!(was.distance(is) < 2e-3, "{text}");
        turn_by(&mut after, -FRAC_PI_2);
        assert!(heading(&after).unwrap().distance(ahead) < 3e-3, "{text}");
        count += 1;
    }
    assert_eq!(count, 7);
}

#[test]
fn whatever_is_held_has_numbers_that_a_file_takes_and_gives_back() {
    for text in ALL {
        let mut region = shape(text);
        move_by(&mut region, DVec3::new(458_123.456_78, 78_600.012_3, -3.3));
        for (kind, _) in gizmos(&region.clone(), &level) {
            match kind {
                // Dragged through the middle to the other side: small, not inside out.
                GizmoKind::Side { axis, is_up } => set_side(&mut region, axis, is_up, -1e6, false),
                GizmoKind::Ring => set_radius(&mut region, 0.0),
                GizmoKind::Turn => turn_by(&mut region, PI / 7.0),
                GizmoKind::Corner(0) => set_corner(&mut region, 0, DVec3::new(458_010.1, 78_590.2, 30.3)),
                _ => {}
            }
        }
        assert_eq!(region.check(), None, "{text}");
        let options = Options::for_command_line();
        let mut scene = parse("veduta = 1\n[[lens]]\nname = \"a\"\neffects = [\"sepia\"]\nshape = { kind = \"sphere\", center = [0, 0, 0], radius = 1 }\n", "scene", &options).unwrap();
        scene.lenses[0].shapes = vec![region];
        let read = parse(&to_toml(&scene), "scene", &options).unwrap_or_else(|error| panic!("{text}: {error}"));
        // Rotations are written by angles: the same to what those are rounded to.
        let [own, again] = [&scene, &read].map(|scene| gizmos(&scene.lenses[0].shapes[0], &level));
        assert_eq!(own.len(), again.len());
        for ((kind, at), (same, place)) in own.iter().zip(&again) {
            assert!(kind == same && at.distance(*place) < 1e-6, "{text}: {kind:?} {at} {place}");
        }
        assert_eq!(to_toml(&read), to_toml(&scene), "{text}");
    }
}

#[test]
fn wires_join_what_is_held() {
    let block = shape(ALL[2]);
    let wires_of = wires(&block, &level);
    let ends: Vec<DVec3> = wires_of.iter().flat_map(|wire| wire.windows(2).map(|ends| ends[1] - ends[0])).collect();
    assert_eq!(ends.len(), 12, "edges of a box");
    let turn = super::block(&block).unwrap().turn;
    for (axis, length) in [20.0, 40.0, 10.0].into_iter().enumerate() {
        let along = |way: &&DVec3| (way.dot(turn * DVec3::AXES[axis]).abs() - length).abs() < 1e-9;
        assert_eq!(ends.iter().filter(along).count(), 4);
    }
    let route = wires(&shape(ALL[10]), &level);
    assert_eq!(route, [[DVec3::new(0.0, 0.0, 2.0), DVec3::new(60.0, 10.0, 2.0), DVec3::new(90.0, 80.0, 5.0)]]);
    let area = wires(&shape(ALL[11]), &level);
    assert!(area.len() == 1 && area[0].len() == 4 && area[0][0] == area[0][3]);
    assert!(wires(&shape(ALL[0]), &level).is_empty());
}

#[test]
fn what_has_no_place_of_its_own_has_no_handles_and_a_combination_its_middle() {
    let thematic = shape("kind = \"thematic\", types = [\"Building\"]");
    assert!(gizmos(&thematic, &level).is_empty() && extent(&thematic).is_empty());
    let union = shape(ALL[12]);
    assert_eq!(gizmos(&union, &level), [(GizmoKind::Middle, DVec3::new(3.0, 0.0, 0.0))]);
    assert_eq!(extent(&union), Aabb { min: DVec3::new(-9.0, -9.0, -9.0), max: DVec3::splat(9.0) });
    let nothing = Region::Combined { how: Operation::Union, parts: Vec::new() };
    assert!(gizmos(&nothing, &level).is_empty());
    // On the ground as far as that is within it.
    let mask = shape(ALL[11]);
    assert_eq!(place_of(&mask, GizmoKind::Corner(1)), DVec3::new(90.0, 0.0, 2.5));
    assert_eq!(middle(&mask, &|_| Some(1e3)).unwrap().z, 55.0);
}
