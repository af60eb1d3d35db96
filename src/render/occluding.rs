//! Occluders that the occlusion lenses of a scene find, and how these come and go over time.

use crate::{
    lens::{Lens, rendering::When},
    render::{
        displayed::Stands,
        moved::Moved,
        occlusion::{Passing, Search},
        picture::{RenderError, Studio},
        placement::Eye,
        stats,
    },
    scene::{Poi, Scene},
    view::View,
};

/// The cases that a lens draws occluders in; none: all in one way.
fn cases_of(lens: &Lens) -> Vec<When> {
    match lens.rendering().map_or(&[][..], |render| &render.cases[..]) {
        [one] if one.when.is_always() => Vec::new(),
        several => several.iter().map(|case| case.when.clone()).collect(),
    }
}

impl Studio {
    /// The city and points of interest at rest, and where deformations show them if a lens of the scene asks for that.
    pub(super) fn stands<'a>(&'a self, scene: &Scene, moved: &Moved, pois: &'a [Poi]) -> Stands<'a> {
        Stands::of_scene(scene, self.shown(), pois, moved, &mut self.known().displayed)
    }

    /// Lets time go on by `dt` seconds, ≥ 0, to the moment of a scene: occluders come and go gradually. The first time everything
    /// begins settled. A picture of that scene then has its history; one of another moment has none.
    pub fn pass(&mut self, scene: &Scene, size: [u32; 2], dt: f64) -> Result<(), RenderError> {
        let (moved, pois) = (self.moved(scene, size)?, scene.standing_pois());
        let stands = self.stands(scene, &moved, &pois);
        let mut lenses = Vec::new();
        for lens in scene.lenses.iter().filter(|lens| lens.enabled) {
            let Some(of) = lens.occluders() else { continue };
            let stand = stands.of_lens(lens);
            lenses.push(Passing { name: &lens.name, of, when: cases_of(lens), stand });
        }
        let eye = Eye::new(&self.camera(scene, size))?;
        self.known().occlusion.pass(&lenses, eye.viewer(), dt);
        Ok(())
    }

    /// Per object of the city, how far it is drawn as an occluder of a lens, by its name, 0 to 1, since time last passed
    /// ([`Self::pass`]); `None` of a lens that was not there then.
    pub fn occluder_weights(&self, lens: &str) -> Option<Vec<f32>> {
        self.known().occlusion.weights(lens)
    }

    /// Of each case that a lens draws occluders in, the same: together they are its weights, less what is drawn in no case.
    pub fn case_weights(&self, lens: &str) -> Option<Vec<Vec<f32>>> {
        self.known().occlusion.case_weights(lens, self.shown())
    }

    /// How often the city was asked for occluders so far.
    pub fn occlusion_tests(&self) -> u64 {
        self.known().occlusion.asked()
    }

    /// Occluders that an occlusion lens finds, with reasons; `None` for other lenses.
    pub(super) fn occluders(&self, stands: &Stands, lens: &Lens, view: &View) -> Option<Vec<stats::Occluder>> {
        let of = lens.occluders()?;
        let Some(eye) = Eye::new(&view.camera).ok().filter(|_| lens.enabled) else { return Some(Vec::new()) };
        Some(self.known().occlusion.explained(
            &lens.name,
            Search { of, when: &cases_of(lens) },
            stands.of_lens(lens),
            eye.viewer(),
        ))
    }

    /// How many of them come and go; `None` where no time passed up to here.
    pub(super) fn over_time(&self, stands: &Stands, lens: &Lens, view: &View) -> Option<stats::OverTime> {
        let (of, eye) = (lens.occluders().filter(|_| lens.enabled)?, Eye::new(&view.camera).ok()?);
        let pois = stands.of_lens(lens).pois;
        self.known().occlusion.over_time(&lens.name, of, pois, eye.viewer())
    }

    /// Whether occluders come, go or change at the moment up to which time passed ([`Self::pass`]).
    pub fn is_fading(&self) -> bool {
        self.known().occlusion.is_fading()
    }
}
