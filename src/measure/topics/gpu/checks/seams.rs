//! Deformed closed bodies whose edges are refined unevenly: nothing shines through.

use glam::{DQuat, DVec3};

use crate::{
    geom::Shape,
    lens::{
        Deform, Lens, LensBody,
        deform::{ControlProfile, Step},
        kind::Deformation,
    },
    measure::topics::gpu::{
        check::{Check, Findings},
        cities::{Corner, DUTCH, numbered, of_solids, place},
        looks::{depths, picture_by, scene},
        numbers::Numbers,
    },
    render::{frame::Backend, picture::RenderError},
    view::Camera,
};

/// See the module.
pub const CHECK: Check = Check {
    name: "seams",
    case: "18",
    property: "from within a closed body that is cut unevenly, twisted and tapered, every pixel shows something",
    oracle: "the axis of a twist and of a taper stays where it is, and the body around it stays closed",
    unit: "pixels",
    least: 100_000,
    run,
};

const SIZE: [u32; 2] = [200, 150];
/// Half the sides of the body, millimetres.
const HALF: Corner = [9_000, 12_000, 15_000];

/// A closed body around zero whose edges were halved at random, in both triangles beside each.
fn body(cuts: usize, numbers: &mut Numbers) -> Vec<Vec<Corner>> {
    let at = |i: usize| [0, 1, 2].map(|axis| if i >> axis & 1 == 0 { -HALF[axis] } else { HALF[axis] });
    let mut corners: Vec<Corner> = (0..8).map(at).collect();
    let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let mut triangles: Vec<[usize; 3]> = faces.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    for _ in 0..cuts {
        let [a, b, _] = triangles[numbers.below(triangles.len() as u64) as usize];
        let (p, q) = (corners[a], corners[b]);
        // On the face's plane: ends are whole millimetres, and so is their middle, or the edge stays.
        if (0..3).any(|i| (p[i] + q[i]) % 2 != 0) {
            continue;
        }
        let m = corners.len();
        corners.push([0, 1, 2].map(|i| (p[i] + q[i]) / 2));
        let halves = |t: &[usize; 3]| -> Vec<[usize; 3]> {
            let is_cut = |i: &usize| [[a, b], [b, a]].contains(&[t[*i], t[(i + 1) % 3]]);
            match (0..3).find(is_cut) {
                Some(i) => vec![[m, t[(i + 2) % 3], t[i]], [m, t[(i + 1) % 3], t[(i + 2) % 3]]],
                None => vec![*t],
            }
        };
        triangles = triangles.iter().flat_map(halves).collect();
    }
    triangles.iter().map(|t| t.map(|i| corners[i]).to_vec()).collect()
}

/// A lens that turns and narrows what is around the body's upright axis, which stays.
fn deformation(twist: f64, taper: f64) -> Lens {
    let size = DVec3::new(40.0, 44.0, 36.0);
    let shape = Shape::Box { center: place(DUTCH, [0; 3]), size, rotation: DQuat::IDENTITY };
    let steps = vec![Step::Twist { angle: twist }, Step::Taper { factor: taper }];
    let deform = Deform { steps, control: Some(ControlProfile::Everywhere), strength: 1.0 };
    Lens {
        shapes: vec![shape.into()],
        body: LensBody::None,
        ..Lens::plain("seams", Deformation::from(deform), [0.5; 3])
    }
}

fn run(found: &mut Findings) -> Result<(), RenderError> {
    let mut numbers = Numbers(718);
    let mut studio = of_solids(DUTCH, &numbered([body(120, &mut numbers)]))?;
    for (round, (twist, taper)) in [(4.0, 0.4), (-6.0, 1.5), (2.5, 0.7)].into_iter().enumerate() {
        let lens = deformation(twist, taper);
        for look in 0..6 {
            let eye = place(DUTCH, [0, 0, numbers.below(20_000) - 10_000]);
            let fov = [0.6, 1.2, 2.4][look % 3];
            let camera = Camera { near_m: 0.02, ..Camera::looking(eye, eye + numbers.direction(), fov) };
            let backend = if look == 5 { Backend::Uber } else { Backend::Specialised };
            let drawn = picture_by(&mut studio, &scene(camera, vec![lens.clone()]), SIZE, backend)?;
            for (i, d) in depths(&drawn).iter().enumerate() {
                found.ask(*d > 0.0 && *d < 1e3, || format!("deformation {round}, look {look}, pixel {i}: {d} m"));
            }
        }
        if !found.goes_on() {
            break;
        }
    }
    Ok(())
}
