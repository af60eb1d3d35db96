//! The church behind the houses: a tower with a spire, a nave with aisles, transepts, a choir.

use crate::city::synth::{
    full::{
        blocks::Block,
        frame::{Frame, Strip, steps, yard},
        house::{Form, Function, House},
        object::{Geometry, Object},
        plan::Plan,
    },
    house::Shape,
};

/// Houses around the close with their distance from it, steps.
const MARGIN: i64 = 2 + 38 + steps(4_000);

/// The year in which the tower was done.
const DONE: i64 = 1511;

/// The church in its close, with its parts after it; `None` where there is no room.
pub fn church(plan: &Plan, block: &Block, id: &str, name: &str) -> Option<Vec<Object>> {
    let ground = yard(&block.corners, MARGIN)?;
    let parts = parts(plan, &ground)?;
    let height = parts.iter().map(|(_, part)| part.height()).max().unwrap_or(0);
    let mut church = Object::new(id.into(), "Building")
        .text("name", name)
        .text("function", Function::Church.name())
        .whole("storeysAboveGround", 1)
        .length("measuredHeight", height)
        .whole("yearOfConstruction", DONE)
        .whole("inhabitants", 0);
    let mut objects = Vec::new();
    for (what, part) in parts {
        let object = Object::new(format!("{id}-{what}"), "BuildingPart")
            .length("measuredHeight", part.height())
            .with(Geometry::Solid("1", part.block()))
            .with(Geometry::Solid("2", part.shell()));
        objects.push(object.child_of(&mut church));
    }
    objects.insert(0, church);
    Some(objects)
}

/// Its parts with their names, all on one floor.
fn parts(plan: &Plan, ground: &Strip) -> Option<Vec<(&'static str, House)>> {
    let length = ground.length().min(steps(48_000));
    let across = ground.depth.min(steps(26_000));
    if length < steps(30_000) || across < steps(18_000) {
        return None;
    }
    let frame = ground.house((ground.length() - length) / 2, (ground.depth - across) / 2);
    let tower = steps(9_500);
    let choir = steps(10_000);
    let nave = length - tower - choir;
    let (aisle, arm) = (across * 18 / 100, across * 23 / 100);
    let wide = across - 2 * arm;
    // The transepts stand at the east end of the aisles.
    let crossing = steps(9_000).min(nave / 3);
    let south = |x: i64, width: i64, deep: i64| (frame.moved(x, arm - deep), [width, deep]);
    let north = |x: i64, width: i64, deep: i64| {
        let turned =
            Frame { u: frame.u.map(|a| -a), v: frame.v.map(|a| -a), ..frame.moved(x + width, arm + wide + deep) };
        (turned, [width, deep])
    };
    let here = |x: i64, y: i64, width: i64, deep: i64| (frame.moved(x, y), [width, deep]);
    let middle = (across - tower) / 2;
    let aisles = nave - crossing;
    let gable = Form::Plain(Shape::Gable);
    let list = [
        ("tower", here(0, middle, tower, tower), Form::Pyramid, 37_000, 29_000, 0),
        ("nave", here(tower, arm, nave, wide), gable, 15_000, 9_500, 0),
        ("south-aisle", south(tower, aisles, aisle), Form::Plain(Shape::Shed), 6_500, 3_000, 0),
        ("north-aisle", north(tower, aisles, aisle), Form::Plain(Shape::Shed), 6_500, 3_000, 0),
        ("south-transept", south(tower + aisles, crossing, arm), Form::Gablet, 9_500, 5_000, 0),
        ("north-transept", north(tower + aisles, crossing, arm), Form::Gablet, 9_500, 5_000, 0),
        (
            "choir",
            here(length - choir, arm + wide / 6, choir, wide - 2 * (wide / 6)),
            Form::Plain(Shape::Hip),
            11_500,
            6_500,
            choir / 3,
        ),
    ];
    let mut parts: Vec<(&'static str, House)> = list
        .into_iter()
        .map(|(name, (frame, [width, depth]), form, eaves, rise, inset)| {
            let mut part =
                House { form, width, depth, eaves, rise, inset, storey: eaves, year: DONE, ..House::at(frame) };
            part.stand(&plan.field);
            (name, part)
        })
        .collect();
    let floor = parts.iter().map(|(_, part)| part.floor).max()?;
    let base = parts.iter().map(|(_, part)| part.base).min()?;
    parts.iter_mut().for_each(|(_, part)| (part.floor, part.base) = (floor, base));
    Some(parts)
}
