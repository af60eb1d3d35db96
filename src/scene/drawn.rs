//! The lenses that a picture is made with: an occlusion lens that draws its occluders in several ways, or what they hide, stands for
//! several lenses with one way each. What moves stands still in it, and the look of its style is effects.

use std::borrow::Cow;

use crate::{
    lens::{
        Class, Lens, LensBody, Region, Rendering,
        best_view::StyleLook,
        chosen::Choice,
        rendering::{Case, When},
    },
    scene::model::{PoiPlace, Scene},
};

/// A scene whose lenses draw in one way each, at its moment.
#[derive(Clone, Debug)]
pub struct Drawn<'a> {
    /// With such lenses.
    pub scene: Cow<'a, Scene>,
    /// Of each of them the lens of the scene that it stands for, ascending; `None`: each for itself.
    pub owners: Option<Vec<u32>>,
    wholes: Vec<u32>,
}

impl Drawn<'_> {
    /// The drawn lens that has all of the area of a lens of the scene.
    pub fn whole(&self, lens: u32) -> u32 {
        self.wholes.get(lens as usize).copied().unwrap_or(lens)
    }

    /// The lens of the scene that one of the drawn lenses stands for.
    pub fn owner(&self, lens: u32) -> u32 {
        self.owners.as_ref().map_or(lens, |owners| owners[lens as usize])
    }
}

impl Scene {
    /// The scene as it is drawn. Of an occlusion lens with several cases there is a lens for each of them, of the occluders that it
    /// holds of, then one of all occluders, with what acts beside them, then one of the points of interest.
    pub fn drawn(&self) -> Drawn<'_> {
        let is_plain = |lens: &Lens| lens.rendering().is_none_or(Rendering::is_plain);
        if self.lenses.iter().all(is_plain) {
            let scene = match self.moves() || self.style.look != StyleLook::default() {
                true => Cow::Owned(Self { pois: self.standing_pois(), style: self.style.drawn(), ..self.clone() }),
                false => Cow::Borrowed(self),
            };
            return Drawn { scene, owners: None, wholes: Vec::new() };
        }
        let (mut lenses, mut owners, mut wholes) = (Vec::new(), Vec::new(), Vec::new());
        for (lens, owner) in self.lenses.iter().zip(0..) {
            match lens.rendering() {
                Some(render) if !render.is_plain() => {
                    let parts = self.parts(lens, render);
                    let whole = parts.iter().position(|part| part.shapes == lens.shapes).unwrap_or(0);
                    wholes.push((lenses.len() + whole) as u32);
                    lenses.extend(parts);
                }
                _ => {
                    wholes.push(lenses.len() as u32);
                    lenses.push(lens.clone());
                }
            }
            owners.resize(lenses.len(), owner);
        }
        Drawn {
            scene: Cow::Owned(Self { lenses, pois: self.standing_pois(), style: self.style.drawn(), ..self.clone() }),
            owners: Some(owners),
            wholes,
        }
    }

    fn parts(&self, lens: &Lens, render: &Rendering) -> Vec<Lens> {
        let mut parts = Vec::new();
        let mut rest = lens.clone();
        rest.clear_rendering();
        match &render.cases[..] {
            [one] if one.when.is_always() => draw(&mut rest, one),
            cases => {
                let (inside, beside) = lens.effects.iter().cloned().partition(|used| used.class == Class::Inside);
                rest.effects = beside;
                let when: Vec<When> = cases.iter().map(|case| case.when.clone()).collect();
                for (i, case) in cases.iter().enumerate() {
                    let mut part = lens.clone();
                    draw(&mut part, case);
                    part.shapes.iter_mut().for_each(|shape| narrow(shape, &when[..=i]));
                    part.effects = Vec::clone(&inside);
                    part.kind.set_content(None);
                    // What holds all of the area has its moment.
                    part.time.clear();
                    (part.body, part.section) = (LensBody::None, None);
                    parts.push(part);
                }
            }
        }
        parts.push(rest);
        let pois = lens.occluders().map_or(&[][..], |of| &of.pois);
        let shown = pois.iter().filter_map(|name| self.pois.iter().find(|poi| poi.name == *name));
        let ids: Vec<String> = shown
            .filter_map(|poi| match &poi.place {
                PoiPlace::Object(id) => Some(id.clone()),
                PoiPlace::At(_) | PoiPlace::AboveGround(_) | PoiPlace::On(_) => None,
            })
            .collect();
        if !render.poi_effects.is_empty() && !ids.is_empty() {
            let choice = Choice { ids, ..Choice::default() };
            let mut own = lens.clone();
            own.clear_rendering();
            own.kind.set_content(None);
            parts.push(Lens {
                shapes: vec![Region::Thematic(choice)],
                effects: render.poi_effects.clone(),
                body: LensBody::None,
                sprite: None,
                border: None,
                section: None,
                time: Vec::new(),
                ..own
            });
        }
        parts
    }
}

/// Has a lens draw its occluders in the way of one case.
fn draw(lens: &mut Lens, case: &Case) {
    if let Some(rendering) = lens.kind.rendering_mut() {
        *rendering = Rendering::of_cases(vec![case.clone()]);
    }
}

/// Leaves of the occluders of a focus area those that the last case holds of, and none before.
fn narrow(shape: &mut Region, when: &[When]) {
    match shape {
        Region::Occluders(of) => *shape = Region::Case { of: of.clone(), when: when.to_vec() },
        Region::Combined { parts, .. } => parts.first_mut().into_iter().for_each(|part| narrow(part, when)),
        _ => {}
    }
}
