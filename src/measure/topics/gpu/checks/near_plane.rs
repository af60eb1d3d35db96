//! Lenses about the eye and about the near plane.

use glam::{DQuat, DVec3};

use crate::{
    geom::Shape,
    lens::Lens,
    measure::topics::gpu::{
        check::{Check, Findings},
        cities::synthetic,
        looks::{bit, depths, house, ids, lens, middle, picture, scene, view},
        numbers::Numbers,
        shapes::{KINDS, ask_mask, painted, painted_class, possible_classes, shape, volumes},
    },
    render::picture::{RenderError, Studio},
    view::Camera,
};

/// See the module.
pub const CHECK: Check = Check {
    name: "near plane",
    case: "4",
    property: "every pixel has its exact class with the eye inside, on and outside the lens and the lens around the near \
               plane or behind the eye; a near plane at 0.125 and at 1 m give the same picture beyond 1 m",
    oracle: "entry and exit of the pixel's ray in f64; the other picture",
    unit: "pixels",
    least: 100_000,
    run,
};

const SIZE: [u32; 2] = [160, 120];

fn shapes(eye: DVec3, forward: DVec3) -> Vec<(String, Shape)> {
    let ball = |center, radius| Shape::Sphere { center, radius };
    let on_face =
        Shape::Box { center: eye + DVec3::X * 8.0, size: DVec3::new(16.0, 20.0, 30.0), rotation: DQuat::IDENTITY };
    let by_hand = [
        ("ball, eye in its middle", ball(eye, 14.0)),
        ("ball, eye near its border, inside", ball(eye + forward * 9.9, 10.0)),
        ("ball, eye on its border", ball(eye + forward * 10.0, 10.0)),
        ("box, eye on a face", on_face),
    ];
    let mut all: Vec<(String, Shape)> = by_hand.into_iter().map(|(what, shape)| (what.to_owned(), shape)).collect();
    let places = [
        ("around the near plane", eye + forward * 0.6, 0.7),
        ("outside", eye + forward * 20.0, 14.0),
        ("behind the eye", eye - forward * 30.0, 20.0),
        ("eye in its middle", eye, 25.0),
    ];
    let mut numbers = Numbers(4);
    for kind in 1..KINDS {
        let (what, center, r) = places[kind % places.len()];
        all.push((format!("kind {kind}, {what}"), shape(kind, center, r, &mut numbers)));
    }
    all
}

fn run(found: &mut Findings) -> Result<(), RenderError> {
    let mut studio = synthetic(40, 7)?;
    let house = house(&studio);
    let eye = DVec3::new(house.min.x - 9.0, house.min.y - 6.0, house.min.z + 1.6);
    let target = house.center();
    let shapes = shapes(eye, (target - eye).normalize_or(DVec3::X));
    ask_near(found, &mut studio, &shapes, [eye, target])?;
    for (what, shape) in shapes {
        if !found.goes_on() {
            break;
        }
        ask_classes(found, &mut studio, painted(&what, shape), Camera::looking(eye, target, 1.2))?;
    }
    Ok(())
}

fn ask_classes(found: &mut Findings, studio: &mut Studio, lens: Lens, camera: Camera) -> Result<(), RenderError> {
    let (view, volumes) = (view(camera, SIZE)?, volumes(&lens)?);
    let scene = scene(camera, vec![lens]);
    let lens = &scene.lenses[0];
    let drawn = picture(studio, &scene, SIZE)?;
    ask_mask(found, &drawn, &view, lens, 0)?;
    // Of several bodies each alone is before or behind.
    let [volume] = &volumes[..] else { return Ok(()) };
    for (i, id) in ids(&drawn).iter().enumerate().filter(|(_, id)| **id != 0) {
        let possible = possible_classes(volume, &view, middle(SIZE, i), f64::from(depths(&drawn)[i]), found.snapping);
        let class = painted_class(drawn.rgba[i]);
        found.ask(class.is_some_and(|class| possible.contains(&class)), || {
            format!("{}: pixel {i} of object {id} is {class:?}, not {possible:?}", lens.name)
        });
    }
    Ok(())
}

/// Draws a few lenses at once with the near plane at an eighth of a metre and at one.
fn ask_near(
    found: &mut Findings,
    studio: &mut Studio,
    shapes: &[(String, Shape)],
    [eye, target]: [DVec3; 2],
) -> Result<(), RenderError> {
    let some = &shapes[..shapes.len().min(6)];
    let lenses: Vec<Lens> = some.iter().map(|(what, shape)| lens(what, shape.clone(), "sepia")).collect();
    let mut of = |near_m| {
        let camera = Camera { near_m, ..Camera::looking(eye, target, 1.2) };
        picture(studio, &scene(camera, lenses.clone()), SIZE)
    };
    let (close, far) = (of(0.125)?, of(1.0)?);
    for i in (0..far.rgba.len()).filter(|&i| depths(&far)[i] > 1.0) {
        let bits = |p| (0..some.len()).map(|lens| bit(p, lens, i)).collect::<Vec<_>>();
        let is_same = close.rgba[i] == far.rgba[i] && ids(&close)[i] == ids(&far)[i] && bits(&close) == bits(&far);
        found.ask(is_same, || format!("pixel {i} is another with the near plane at 1 m"));
    }
    Ok(())
}
