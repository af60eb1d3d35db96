//! The regions of a frame: what techniques go by that draw the city once for each region, kept for comparison with accumulation: one
//! pass per combination of lenses, or Ropinski and Hinrichs' three ([`crate::render::pass::reference`]).
//!
//! What the geometry passes leave is what accumulation's one pass leaves.

use crate::{
    geom::Aabb,
    lens::Class,
    render::{
        eye::PictureTile,
        frame::FrameInput,
        hiding::{Reach, reaches_of},
        overlaps::{combinations, may_meet},
        seen::SeenVolume,
        volume::LensVolume,
    },
    scene::{Scene, SceneProblem, Technique, technique::MOST_WRITTEN_OUT},
    shader::{ClassTest, Plan, Regions},
};

/// One region that may occur.
#[derive(Clone, Debug)]
pub(super) struct RegionPass {
    /// Its number.
    pub number: u32,
    /// Lenses that it has to do with.
    pub lenses: Vec<u32>,
    /// Where fragments of it may be: in one of each of these.
    pub reaches: Vec<Vec<Reach>>,
    /// The part of the picture that it may be seen in.
    pub part: PictureTile,
    /// What shading does there.
    pub shade: Plan,
    /// Whether what is behind the city may be in it.
    pub has_background: bool,
}

/// The regions of a frame.
#[derive(Clone, Debug)]
pub(super) struct RegionPasses {
    /// How they are told apart.
    pub plan: Plan,
    /// Region 0 first.
    pub passes: Vec<RegionPass>,
    /// Where fragments may be in another region than 0.
    reaches: Vec<Reach>,
}

/// What of a scene's volumes its technique cannot do.
pub(super) fn refused(scene: &Scene, volumes: &[LensVolume]) -> Option<SceneProblem> {
    let technique = scene.style.technique;
    if technique == Technique::Accumulate {
        return None;
    }
    let name = |volume: &LensVolume| &scene.lenses[volume.lens as usize].name;
    let why = || {
        if volumes.len() > MOST_WRITTEN_OUT {
            let count = volumes.len();
            return Some(format!("takes at most {MOST_WRITTEN_OUT} volumes of lenses; the scene has {count}"));
        }
        if technique != Technique::ThreePass {
            return None;
        }
        if let Some(volume) = volumes.iter().find(|v| !v.region.is_form()) {
            let name = name(volume);
            return Some(format!(
                "needs volumes with one front and one back, and that of lens \"{name}\" has no such form"
            ));
        }
        let pairs = volumes.iter().enumerate().flat_map(|(i, a)| volumes[..i].iter().map(move |b| (b, a)));
        let (a, b) = pairs.filter(|(a, b)| a.lens != b.lens).find(|(a, b)| may_meet(a, b))?;
        Some(format!("takes lenses that do not meet, and lenses \"{}\" and \"{}\" may", name(a), name(b)))
    };
    why().map(|why| technique.refusal(&why))
}

/// Has volumes tested as a technique tests them.
pub(super) fn set_tests(technique: Technique, volumes: &mut [LensVolume]) {
    if technique == Technique::ThreePass {
        // The two depth maps.
        volumes.iter_mut().for_each(|volume| volume.sprite = Some(volume.sprite.unwrap_or_default()));
    }
}

impl RegionPasses {
    /// The regions that may occur in a picture of lenses; `plan`: of shading, and `lenses` the numbers of its lenses.
    pub fn new(input: &FrameInput, seen: &[SeenVolume], plan: &Plan, lenses: &[u32]) -> Self {
        let regions = match input.technique {
            Technique::ThreePass => Regions::passes(plan),
            _ => Regions::combinations(plan),
        };
        let (plan, whole_plan) = {
            let mut distinct = plan.clone();
            distinct.steps.clear();
            (distinct.haze, distinct.masks) = (false, false);
            distinct.lenses.iter_mut().zip(0..).for_each(|(lens, number)| lens.number = number);
            distinct.regions = Some(regions.clone());
            (distinct, Plan { regions: Some(regions.clone()), ..plan.clone() })
        };
        let whole = PictureTile::whole(input.tile.size);
        let pass = |number: u32| {
            let mut pass = RegionPass {
                number,
                lenses: Vec::new(),
                reaches: Vec::new(),
                part: whole,
                shade: whole_plan.of_region(number),
                has_background: true,
            };
            for (lens, class) in regions.classes_of(number) {
                let lens = lenses[lens as usize];
                pass.lenses.push(lens);
                pass.reaches.push(reaches_of(Some(lens), Class::from(class), input.volumes, &input.view));
                let own = || seen.iter().filter(|v| v.lens == lens);
                if class != ClassTest::Rest {
                    let around = own().map(|v| v.bounds).reduce(PictureTile::around);
                    pass.part = pass.part.common(around.unwrap_or(PictureTile { origin: [0; 2], size: [0; 2] }));
                }
                let is_endless = || own().any(|v| !input.volumes[v.index].region.is_bounded());
                pass.has_background &= match class {
                    ClassTest::Inside => is_endless(),
                    ClassTest::Front => false,
                    ClassTest::Behind | ClassTest::Rest => true,
                };
            }
            pass
        };
        let possible = match &regions {
            Regions::Combinations(classes) => overlap_combinations(input, classes, lenses),
            Regions::Passes(_) => (0..regions.count().unwrap_or(0)).collect(),
        };
        let passes: Vec<RegionPass> =
            possible.into_iter().map(pass).filter(|p| p.number == 0 || !p.part.is_empty()).collect();
        let others = passes.iter().filter(|p| p.number > 0);
        // What every other region asks for first is enough to know that it may be there.
        let mut reaches: Vec<Reach> = Vec::new();
        for reach in others.flat_map(|p| p.reaches.first().into_iter().flatten()) {
            if !reaches.contains(reach) {
                reaches.push(reach.clone());
            }
        }
        Self { plan, passes, reaches }
    }

    /// Whether fragments in a box may be in another region than 0.
    pub fn is_reached(&self, bounds: &Aabb, input: &FrameInput) -> bool {
        self.reaches.iter().any(|reach| reach.touches(bounds, &input.view))
    }
}

/// The numbers of the combinations that may occur, ascending: of lenses that a place is inside of, the volumes have to meet.
fn overlap_combinations(input: &FrameInput, classes: &[Vec<ClassTest>], lenses: &[u32]) -> Vec<u32> {
    let acting: Vec<usize> = (0..lenses.len()).filter(|&i| classes[i].contains(&ClassTest::Inside)).collect();
    let numbers: Vec<u32> = acting.iter().map(|&i| lenses[i]).collect();
    let mut found = Vec::new();
    for mask in combinations(input.volumes, &numbers) {
        let mut own = vec![0];
        let mut place = 1;
        for (lens, asked) in classes.iter().enumerate() {
            let is_inside = acting.iter().position(|&i| i == lens).is_some_and(|bit| mask >> bit & 1 == 1);
            let states = (1..).zip(asked).filter(|(_, class)| (**class == ClassTest::Inside) == is_inside);
            let states: Vec<u32> = states.map(|(state, _)| state).chain((!is_inside).then_some(0)).collect();
            own = own.iter().flat_map(|number| states.iter().map(move |state| number + state * place)).collect();
            place *= asked.len() as u32 + 1;
        }
        found.append(&mut own);
    }
    found.sort_unstable();
    found
}
