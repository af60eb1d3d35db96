//! Panes across a sight line: a city whose layers are known, what a frame makes of them, and compositing in f64.
#![allow(dead_code, reason = "every test binary uses its own part")]

use std::{path::PathBuf, sync::Arc};

use glam::DVec3;
use veduta::{
    city::{
        coplanar::coplanar_triangles,
        load::{LoadOptions, Quiet, load},
        shown::shown_geometries,
    },
    lens::{EffectUse, Parameter},
    render::{
        city::Shown,
        frame::Backend,
        picture::{Request, Studio},
    },
    scene::Scene,
    view::Camera,
};

use crate::studio::*;

pub const SIZE: [u32; 2] = [48, 40];

/// A pane across the x axis: its place, its lower and upper corner in y and z, millimetres, and its material.
#[derive(Clone, Copy, Debug)]
pub struct Pane {
    pub name: usize,
    pub x: i64,
    pub low: [i64; 2],
    pub high: [i64; 2],
    pub material: usize,
}

/// Numbers that look random: xorshift.
pub struct Random(pub u64);

impl Random {
    pub fn below(&mut self, end: u64) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0 % end
    }

    pub fn share(&mut self) -> f64 {
        self.below(1 << 20) as f64 / f64::from(1 << 20)
    }
}

pub const MATERIALS: [&str; 4] = ["[0.9,0.85,0.7]", "[0.7,0.25,0.15]", "[0.1,0.3,0.8]", "[0.2,0.7,0.2]"];

pub fn panes(count: usize, random: &mut Random) -> Vec<Pane> {
    let mut side = |low: u64| -> [i64; 2] { [0, 1].map(|_| (low + random.below(4000)) as i64) };
    let bounds: Vec<_> = (0..count).map(|_| (side(0), side(6000))).collect();
    let pane = |(i, (low, high)): (usize, ([i64; 2], [i64; 2]))| Pane {
        name: i,
        x: 100 * i as i64,
        low,
        high,
        material: i % MATERIALS.len(),
    };
    bounds.into_iter().enumerate().map(pane).collect()
}

/// The city of these panes, in this order.
pub fn city(panes: &[Pane]) -> PathBuf {
    use std::sync::atomic::{AtomicU32, Ordering::Relaxed};
    static MADE: AtomicU32 = AtomicU32::new(0);
    let (mut objects, mut vertices) = (Vec::new(), Vec::new());
    for (i, pane) in panes.iter().enumerate() {
        let ([y, z], [y2, z2]) = (pane.low, pane.high);
        let v = 4 * i;
        objects.push(format!(
            r#""p{}": {{"type": "Building", "attributes": {{"n": {}}}, "geometry": [{{"type": "MultiSurface", "lod": "2",
                "boundaries": [[[{}, {}, {}, {}]]], "material": {{"a": {{"value": {}}}}}}}]}}"#,
            pane.name, pane.name, v, v + 1, v + 2, v + 3, pane.material
        ));
        let x = pane.x;
        vertices.push(format!("[{x},{y},{z}],[{x},{y2},{z}],[{x},{y2},{z2}],[{x},{y},{z2}]"));
    }
    let materials = MATERIALS.iter().enumerate().map(|(i, c)| format!(r#"{{"name": "m{i}", "diffuseColor": {c}}}"#));
    let text = format!(
        r#"{{"type": "CityJSON", "version": "2.0", "transform": {{"scale": [0.001, 0.001, 0.001], "translate": [0, 0, 0]}},
            "CityObjects": {{{}}},
            "appearance": {{"default-theme-material": "a", "materials": [{}]}}, "vertices": [{}]}}"#,
        objects.join(",\n"),
        materials.collect::<Vec<_>>().join(","),
        vertices.join(",")
    );
    let number = MADE.fetch_add(1, Relaxed);
    let path = std::env::temp_dir().join(format!("veduta-panes-{}-{number}.city.json", std::process::id()));
    std::fs::write(&path, text).expect("a temporary file");
    path
}

pub fn studio_of(panes: &[Pane]) -> Studio {
    let path = city(panes);
    let made = studio(std::slice::from_ref(&path));
    std::fs::remove_file(path).expect("the temporary file");
    made
}

/// Puts another city into a studio.
pub fn set_city(studio: &mut Studio, panes: &[Pane]) {
    let path = city(panes);
    let model = load(std::slice::from_ref(&path), &LoadOptions::default(), &Quiet).expect("the file loads");
    std::fs::remove_file(path).expect("the temporary file");
    let geometries = shown_geometries(&model, None);
    let coplanar = coplanar_triangles(&model, &geometries);
    let shown = Shown { coplanar: &coplanar, ..Shown::of(&model, &geometries) };
    studio.renderer.set_city(&shown, None).expect("the city fits");
    (studio.model, studio.geometries) = (Arc::new(model), geometries);
}

/// From before the first pane, without air between.
pub fn camera() -> Camera {
    orthographic(DVec3::new(-20.0, 5.0, 5.0), DVec3::new(0.0, 5.0, 5.0), 11.0)
}

pub fn rule(effect: &str, numbers: &[(&str, f64)], chosen: Option<&[usize]>, except: bool) -> EffectUse {
    let mut made = with_numbers(effect, numbers);
    if let Some(chosen) = chosen {
        let values = chosen.iter().map(ToString::to_string).collect();
        made.parameters.insert("attribute".into(), Parameter::Text("n".into()));
        made.parameters.insert("values".into(), Parameter::Texts(values));
        made.parameters.insert("except".into(), Parameter::Boolean(except));
    }
    made
}

pub fn of_context(effects: Vec<EffectUse>) -> Scene {
    let mut scene = scene(camera(), vec![]);
    scene.style.effects = effects;
    scene
}

/// What the last frame laid over its picture.
pub fn transparency(studio: &mut Studio, scene: &Scene, backend: Backend, size: [u32; 2]) -> Vec<[f32; 4]> {
    studio.backend = backend;
    studio.redraw(scene, size).expect("a frame");
    let targets = studio.renderer.targets().expect("targets");
    let bytes =
        studio.renderer.gpu.read_texture(&targets.transparency.texture, 0, wgpu::TextureAspect::All).expect("texels");
    bytemuck::pod_collect_to_vec(&bytes)
}

/// Colours of a pane where it is, as shaded.
pub fn colors(studio: &mut Studio, pane: usize) -> Vec<Option<[f32; 3]>> {
    let alone = [rule("eraser", &[], Some(&[pane]), true), rule("transparent", &[("opacity", 1.0)], None, false)];
    let seen = transparency(studio, &of_context(alone.to_vec()), Backend::Specialised, SIZE);
    seen.iter().map(|v| (v[3] == 0.0).then(|| [v[0], v[1], v[2]])).collect()
}

/// Layers of each pixel, from near to far: of which pane, and its colour.
pub fn stacks(studio: &mut Studio, panes: &[Pane]) -> Vec<Vec<(usize, [f32; 3])>> {
    let mut stacks = vec![Vec::new(); (SIZE[0] * SIZE[1]) as usize];
    let mut sorted: Vec<&Pane> = panes.iter().collect();
    sorted.sort_by_key(|pane| pane.x);
    for pane in sorted {
        for (stack, color) in stacks.iter_mut().zip(colors(studio, pane.name)) {
            stack.extend(color.map(|color| (pane.name, color)));
        }
    }
    stacks
}

/// Laid one over the other in f64.
pub fn composited(stack: &[(usize, [f32; 3])], opacity: impl Fn(usize, usize) -> f64) -> [f64; 4] {
    let (mut color, mut through) = ([0.0; 3], 1.0);
    for (layer, (pane, own)) in stack.iter().enumerate() {
        let a = opacity(layer, *pane);
        for (sum, c) in color.iter_mut().zip(own) {
            *sum += through * a * f64::from(*c);
        }
        through *= 1.0 - a;
    }
    [color[0], color[1], color[2], through]
}

pub fn largest_difference(found: &[[f32; 4]], expected: &[[f64; 4]]) -> f64 {
    let of = |(f, e): (&[f32; 4], &[f64; 4])| (0..4).map(|i| (f64::from(f[i]) - e[i]).abs()).fold(0.0, f64::max);
    found.iter().zip(expected).map(of).fold(0.0, f64::max)
}

pub fn request(backend: Backend) -> Request {
    Request { aovs: ALL, backend, ..Request::plain([160, 100]) }
}
