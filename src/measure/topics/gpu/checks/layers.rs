//! The numbers of translucent layers of pixels: rays through shared edges and corners of closed bodies.

use glam::DVec3;

use crate::{
    measure::topics::gpu::{
        check::{Check, Findings},
        cities::{Corner, DUTCH, numbered, of_solids},
        looks::{orthographic, translucent, transparency},
    },
    render::{
        frame::Backend,
        picture::{RenderError, Studio},
    },
    scene::Transparency,
    view::Camera,
};

/// See the module.
pub const CHECK: Check = Check {
    name: "layers of closed bodies",
    case: "10, 11",
    property: "each surface of a closed translucent body is laid once, also where rays pass through shared edges and corners, by \
               all methods that lay every layer and both back ends",
    oracle: "on which side of each outline a pixel's ray passes, in integers",
    unit: "pixels",
    least: 40_000,
    run,
};

/// Millimetres of a corner of the octahedra's net, and of a pixel: every other row and column of pixels is on it.
const NET: i64 = 256;
const PIXEL: i64 = 128;
const SIZE: [u32; 2] = [64, 48];

/// The methods that lay or count every layer of a pixel.
const METHODS: [Transparency; 4] = [
    Transparency::Exact,
    Transparency::Peel { layers: 0 },
    Transparency::KBuffer { layers: 4 },
    Transparency::Weighted,
];

/// An octahedron of `6 * NET`, each face in 36 triangles that share their corners.
fn octahedron(center: Corner) -> Vec<Vec<Corner>> {
    let n = 6;
    let mut faces = Vec::new();
    for signs in 0..8_u32 {
        let at = |i: i64, j: i64| -> Corner {
            let p = [i * NET, j * NET, (n - i - j) * NET];
            [0, 1, 2].map(|k| center[k] + if signs >> k & 1 == 0 { p[k] } else { -p[k] })
        };
        let cells = (0..n).flat_map(|i| (0..n - i).map(move |j| (i, j)));
        for (i, j) in cells {
            let mut split = vec![vec![at(i, j), at(i + 1, j), at(i, j + 1)]];
            if i + j + 1 < n {
                split.push(vec![at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
            }
            // All of them look outwards.
            if signs.count_ones() % 2 == 1 {
                split.iter_mut().for_each(|face| face.reverse());
            }
            faces.extend(split);
        }
    }
    faces
}

/// The number of layers of each pixel, 23 at most: each lets half of the light through, and powers of two are exact. `None` where what is
/// let through is no such power.
fn layers(
    studio: &mut Studio,
    camera: Camera,
    method: Transparency,
    backend: Backend,
) -> Result<Vec<Option<u32>>, RenderError> {
    let found = transparency(studio, &translucent(camera, 0.5, method), SIZE, backend)?;
    let of = |v: &[f32; 4]| {
        let count = -v[3].log2();
        (count.fract() == 0.0 && (0.0..=23.0).contains(&count)).then_some(count as u32)
    };
    Ok(found.iter().map(of).collect())
}

fn run(found: &mut Findings) -> Result<(), RenderError> {
    // Three, one behind the other and beside each other, that do not touch.
    let centers = [[0, 0, 0], [-2 * NET, 3200, NET], [3 * NET, 6400, -2 * NET]];
    let mut studio = of_solids(DUTCH, &numbered(centers.map(octahedron)))?;
    let height = 0.001 * (i64::from(SIZE[1]) * PIXEL) as f64;
    // Which axes go right and up, and where the eye is on the third.
    for (right, up, eye) in [(0, 2, -DVec3::Y), (0, 1, DVec3::Z), (1, 2, DVec3::X)] {
        // Pixels' middles on the net, and 1 mm aside of it.
        for aside in [0, 1] {
            let mut target = DUTCH;
            target[right] += 0.001 * (PIXEL / 2 + aside) as f64;
            target[up] += 0.001 * (PIXEL / 2 + aside) as f64;
            let camera = orthographic(target + 30.0 * eye, target, height);
            let of_methods = METHODS.map(|method| (method, Backend::Specialised));
            for (method, backend) in of_methods.into_iter().chain([(Transparency::Exact, Backend::Uber)]) {
                for (i, count) in layers(&mut studio, camera, method, backend)?.into_iter().enumerate() {
                    let (x, y) = (i as i64 % i64::from(SIZE[0]), i as i64 / i64::from(SIZE[0]));
                    let at = [PIXEL * (x - 31) + aside, PIXEL * (24 - y) + aside];
                    // How far inside each outline, |x| + |y| < 6 NET.
                    let inside = centers.map(|c| 6 * NET - (at[0] - c[right]).abs() - (at[1] - c[up]).abs());
                    let least = 2 * inside.iter().filter(|by| **by > 0).count() as u32;
                    let rims = inside.iter().filter(|by| **by == 0).count() as u32;
                    // On its rim a body is passed in two layers or none.
                    let is_right = count.is_some_and(|n| (least..=least + 2 * rims).contains(&n) && n % 2 == 0);
                    found.ask(is_right, || {
                        format!(
                            "{} by {backend:?}, {eye} {aside}, pixel {x},{y}: {count:?} layers, not {least}",
                            method.word()
                        )
                    });
                }
            }
        }
        if !found.goes_on() {
            break;
        }
    }
    Ok(())
}
