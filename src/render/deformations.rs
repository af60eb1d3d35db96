//! The deformations of a scene's lenses, in the world and safe: where they stand in a picture, and at which part of their strength they
//! fold nothing.

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
    sync::Arc,
};

use crate::{
    city::CityModel,
    geom::{
        Aabb, Shape,
        deform::{CLEAR, Deformation, Deformer, Deformers, Fault, Frame, Proof, Texels},
    },
    lens::{Deform, Lens, Placement, Region, deform::Viewer, solids::ShownCity},
    render::{
        displayed::Stand,
        height_rules::{Asked, Rule, heights_of},
        heights::Heights,
        moved::Moved,
        occlusion::Occlusion,
        placement::Eye,
    },
    scene::Scene,
    view::Camera,
};

/// Beyond this an image of a control is made smaller: a deformation is as smooth as its texels are few.
const MOST_TEXELS: u32 = 512;

/// What is known of deformations that were asked for: proofs take longer than frames.
#[derive(Debug, Default)]
pub(super) struct KnownDeformations {
    strengths: Vec<KnownStrength>,
    images: Vec<(PathBuf, Texels)>,
    /// The number of the last city, its rules of heights, and what they made of its heights; the second as its file has it.
    heights: (u64, Vec<Rule>, [Arc<Heights>; 2]),
}

/// How much of a deformation is used, wherever it stands.
#[derive(Debug)]
struct KnownStrength {
    /// In its own frame.
    of: Deformation,
    /// The part of that frame in which it shall fold nothing.
    part: Aabb,
    /// The part of its strength.
    strength: f64,
    /// Whether all of it is proven: what is part of that part is so, too.
    is_proven: bool,
    is_wanted: bool,
}

/// A deformation as it is used.
#[derive(Clone, Debug)]
struct Used {
    /// The part of its strength.
    strength: f64,
    deformer: Deformer,
}

/// The deformations of a picture, bottom first.
#[derive(Clone, Debug, Default)]
pub(super) struct SceneDeformations {
    /// What they do to heights of objects, and then to all there is.
    pub moved: Moved,
    /// Of those that would fold space, by lens: thousandths of its strength that are used.
    pub weakened: BTreeMap<u32, u32>,
}

/// What a picture's deformations are found in.
pub(super) struct Stage<'a> {
    pub scene: &'a Scene,
    /// The city where it stands.
    pub model: &'a CityModel,
    /// The same as its file has it.
    pub file: &'a CityModel,
    /// Box around what is drawn at rest.
    pub bounds: Aabb,
    pub camera: Camera,
    pub eye: &'a Eye,
    pub city: ShownCity<'a>,
    pub occlusion: &'a mut Occlusion,
}

impl KnownDeformations {
    /// The deformations of a scene's enabled lenses.
    ///
    /// # Errors
    /// What a lens cannot do, with its place in the scene file.
    pub fn of_scene(&mut self, stage: &mut Stage) -> Result<SceneDeformations, String> {
        let mut found = SceneDeformations::default();
        let mut deformers = Deformers::default();
        let mut rules = Vec::new();
        let enabled = || stage.scene.lenses.iter().filter(|lens| lens.enabled);
        let others = enabled().filter_map(Lens::deform).any(Deform::always_moves);
        for (i, lens) in stage.scene.lenses.iter().enumerate().filter(|(_, lens)| lens.enabled) {
            let Some(deform) = lens.deform() else { continue };
            let wrong = |message: String| format!("[lens.{i}] {message}");
            if deform.is_of_objects() {
                let mut asked = Asked {
                    stand: Stand { city: stage.city, pois: &stage.scene.pois },
                    occlusion: &mut *stage.occlusion,
                    viewer: stage.eye.viewer(),
                };
                rules.extend(Rule::of_lens(i, &lens.name, deform, &mut asked));
                continue;
            }
            let running = deform.running(others);
            let Some(deformation) = self.placed(stage, lens, &running).map_err(wrong)? else { continue };
            let own = self.strength(&deformation, &stage.bounds).map_err(wrong)?;
            if own.strength < 1.0 {
                found.weakened.insert(i as u32, (1000.0 * own.strength).floor() as u32);
            }
            // What moves nothing costs nothing.
            if own.deformer.deformation().chain != deformation.at_strength(0.0).chain {
                deformers.0.push(own.deformer);
            }
        }
        self.strengths.retain(|known| known.is_wanted);
        self.strengths.iter_mut().for_each(|known| known.is_wanted = false);
        if self.heights.0 != stage.city.number || self.heights.1 != rules {
            let own = Arc::new(heights_of(&rules, stage.city)?);
            let of_file = match std::ptr::eq(stage.city.model, stage.file) {
                true => own.clone(),
                false => Arc::new(heights_of(&rules, ShownCity { model: stage.file, ..stage.city })?),
            };
            self.heights = (stage.city.number, rules, [own, of_file]);
        }
        let [heights, heights_of_file] = self.heights.2.clone();
        found.moved = Moved { heights, heights_of_file, deformers: Arc::new(deformers) };
        Ok(found)
    }

    /// A lens' deformation in the world; `None`: what it is attached to is not there.
    fn placed(&mut self, stage: &Stage, lens: &Lens, deform: &Deform) -> Result<Option<Deformation>, String> {
        let viewer = Viewer {
            eye: stage.camera.eye,
            forward: stage.camera.target - stage.camera.eye,
            ground: stage.bounds.min.z,
        };
        let area: Option<&Shape> = match &lens.shapes[..] {
            [] => None,
            [Region::Shape(shape)] => Some(shape),
            _ => return Err("shape: a deformation has one: a box, a cylinder, a sphere or a corridor".into()),
        };
        let mut made =
            deform.deformation(area, &viewer, |file| self.image(file)).map_err(|e| format!("deform: {e}"))?;
        if area.is_some() || lens.placement != Placement::World {
            let Some(motion) = stage.eye.motion(lens, stage.scene, stage.model) else { return Ok(None) };
            if area.is_some() {
                let axes = glam::DMat3::from_quat(motion.rotation) * made.frame.axes;
                made.frame = Frame { pivot: motion.point(made.frame.pivot), axes };
            }
        }
        Ok(Some(made))
    }

    /// At all of its strength, if that is proven to fold nothing, or seen not to: there is no proof of long openings that takes less than
    /// seconds. Otherwise at as much as is. A lens that moves is not asked again for what it has in its own frame.
    fn strength(&mut self, deformation: &Deformation, bounds: &Aabb) -> Result<Used, String> {
        let wrong = |fault: Fault| format!("deform: {fault}");
        let asked = Deformer::new(deformation.clone()).map_err(wrong)?;
        let part = asked.support().part_of(bounds);
        let of = Deformation { frame: Frame::WORLD, ..deformation.clone() };
        let serves = |known: &&mut KnownStrength| {
            known.of == of && (known.part == part || (known.is_proven && known.part.union(part) == known.part))
        };
        let strength = if let Some(known) = self.strengths.iter_mut().find(serves) {
            known.is_wanted = true;
            known.strength
        } else {
            let proof = asked.prove(bounds);
            let is_proven = proof == Proof::Proven;
            let strength = match proof {
                Proof::Proven => 1.0,
                Proof::Unknown { least } if least >= CLEAR => 1.0,
                Proof::Unknown { .. } | Proof::Folds { .. } => deformation.safe_strength(bounds).map_err(wrong)?.seen,
            };
            self.strengths.push(KnownStrength { of, part, strength, is_proven, is_wanted: true });
            strength
        };
        let deformer = match strength {
            1.0 => asked,
            part => Deformer::new(deformation.at_strength(part)).map_err(wrong)?,
        };
        Ok(Used { strength, deformer })
    }

    /// The lightness of an image, its lower edge first.
    fn image(&mut self, file: &Path) -> Result<Texels, String> {
        if let Some((_, known)) = self.images.iter().find(|(of, _)| of == file) {
            return Ok(known.clone());
        }
        let wrong = |message: String| format!("{}: {message}", file.display());
        let image = image::open(file).map_err(|error| wrong(error.to_string()))?;
        let small = match image.width().max(image.height()) > MOST_TEXELS {
            true => image.thumbnail(MOST_TEXELS, MOST_TEXELS),
            false => image,
        };
        let grey = small.to_luma32f();
        let (width, height) = (grey.width() as usize, grey.height() as usize);
        let rows = grey.as_raw().chunks(width.max(1)).rev();
        let values = rows.flatten().map(|v| v.clamp(0.0, 1.0)).collect();
        let texels = Texels::new(width, height, values).ok_or_else(|| wrong("the image is empty".into()))?;
        self.images.push((file.to_owned(), texels.clone()));
        Ok(texels)
    }
}
