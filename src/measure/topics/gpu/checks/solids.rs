//! Lenses that rays enter and leave many times: a comb, and a star with a hole.

use glam::{DVec2, DVec3};

use crate::{
    lens::Region,
    measure::topics::gpu::{
        check::{Check, Findings},
        cities::synthetic,
        looks::{bit, cameras, column_row, depths, house, lens, picture_by, scene, view},
    },
    render::{frame::Backend, picture::RenderError},
};

/// See the module.
pub const CHECK: Check = Check {
    name: "concave solids",
    case: "7",
    property: "a shown place is in a prism where it is in its plan and between its ends, however often its ray crosses the \
               faces",
    oracle: "crossings of a line in plan, in f64",
    unit: "pixels",
    least: 50_000,
    run,
};

const SIZE: [u32; 2] = [160, 120];

/// A prism: its rings in plan, the first one outside, and where it begins and ends.
struct Prism {
    name: &'static str,
    rings: Vec<Vec<DVec2>>,
    ends: [f64; 2],
}

impl Prism {
    fn focus(&self) -> Region {
        Region::Prism {
            points: self.rings[0].clone(),
            holes: self.rings[1..].to_vec(),
            base: self.ends[0],
            height: self.ends[1] - self.ends[0],
        }
    }

    fn edges(&self) -> impl Iterator<Item = [DVec2; 2]> {
        self.rings.iter().flat_map(|ring| (0..ring.len()).map(move |i| [ring[i], ring[(i + 1) % ring.len()]]))
    }

    /// Whether it holds a place: a line to the right crosses the rings an odd number of times.
    fn holds(&self, p: DVec3) -> bool {
        let is_crossed =
            |[a, b]: &[DVec2; 2]| (a.y <= p.y) != (b.y <= p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x);
        let [low, high] = self.ends;
        p.z >= low && p.z <= high && self.edges().filter(is_crossed).count() % 2 == 1
    }

    /// No farther from its surface than this, metres.
    fn distance(&self, p: DVec3) -> f64 {
        let from_edge = |[a, b]: [DVec2; 2]| {
            let t = ((p.truncate() - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
            p.truncate().distance(a + t * (b - a))
        };
        let from_ends = self.ends.iter().map(|end| (p.z - end).abs()).fold(f64::INFINITY, f64::min);
        self.edges().map(from_edge).fold(from_ends, f64::min)
    }
}

fn prisms(at: DVec3, r: f64) -> Vec<Prism> {
    let polar = |length: f64, turns: f64| at.truncate() + r * length * DVec2::from_angle(std::f64::consts::TAU * turns);
    let star = (0..14).map(|i| polar(if i % 2 == 0 { 1.0 } else { 0.4 }, f64::from(i) / 14.0)).collect();
    let hole = (0..5).rev().map(|i| polar(0.2, f64::from(i) / 5.0)).collect();
    // Twenty walls: a ray along x crosses forty faces.
    let wall = |i: i32| {
        let x = 0.1 * f64::from(i) - 1.0;
        [[x, -0.8], [x, 0.8], [x + 0.05, 0.8], [x + 0.05, -0.7]]
    };
    let comb = (0..20).flat_map(wall).chain([[1.0, -0.7], [1.0, -0.8]]);
    let comb = comb.map(|p| at.truncate() + r * DVec2::from(p)).collect();
    let ends = [at.z - 0.6 * r, at.z + 0.3 * r];
    vec![
        Prism { name: "star with a hole", rings: vec![star, hole], ends },
        Prism { name: "comb of twenty walls", rings: vec![comb], ends },
    ]
}

fn run(found: &mut Findings) -> Result<(), RenderError> {
    let mut studio = synthetic(60, 7)?;
    let prisms = prisms(house(&studio).center(), 40.0);
    for backend in [Backend::Specialised, Backend::Uber] {
        for camera in cameras(&studio) {
            let lenses = prisms.iter().map(|prism| lens(prism.name, prism.focus(), "sepia")).collect();
            let drawn = picture_by(&mut studio, &scene(camera, lenses), SIZE, backend)?;
            let view = view(camera, SIZE)?;
            for (number, prism) in prisms.iter().enumerate() {
                for (i, &d) in depths(&drawn).iter().enumerate() {
                    let d = f64::from(d);
                    let [x, y] = column_row(SIZE, i);
                    let p = view.pixel_ray(x, y).at(d);
                    let is_in = bit(&drawn, number, i);
                    // Solids ask beside a place, and of each place as far along the normal.
                    let band = 8.0 * 2_f64.powi(-23) * d.max(camera.eye.distance(p))
                        + 1e-6 * 40.0
                        + 2.0 * found.snapping * view.pixel_m(d.min(1e30));
                    let is_right =
                        is_in == (d.is_finite() && prism.holds(p)) || d.is_finite() && prism.distance(p) <= band;
                    found.ask(is_right, || format!("{}: pixel {x},{y} at {d} m is in it: {is_in}", prism.name));
                }
            }
        }
        if !found.goes_on() {
            break;
        }
    }
    Ok(())
}
