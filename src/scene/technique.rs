//! How lenses that meet are evaluated: by sequential accumulation, which is ours, or as the literature has it, for
//! comparison. The picture is the same; what a technique cannot do is refused.

use crate::{
    city::lifetime::Undated,
    lens::{Class, EffectUse, Lens, LensBody, epoch::makes_one_moment},
    scene::{check::SceneProblem, model::Scene},
    shader::{EffectKind, effect::find},
};

/// A technique.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Technique {
    /// Every effect in turn, where its lens test holds (Tiesel §3.4.5, the alternative).
    #[default]
    Accumulate,
    /// One branch of the shader for each combination of lenses (Tiesel §3.4.5).
    Branches,
    /// One pass over the city for each combination of lenses (Best and Borst 2008, as Tiesel §3.4.2 tells of it).
    Regions,
    /// What is behind a lens, inside and in front of it in three passes over the city, told apart by two depth maps (Ropinski and
    /// Hinrichs 2004, §3 and §4).
    ThreePass,
}

/// Lenses that [`Technique::Branches`] takes: 2⁶ branches.
const MOST_OF_BRANCHES: usize = 6;
/// Lenses that [`Technique::Regions`] takes: 2¹⁰ regions.
const MOST_OF_REGIONS: usize = 10;
/// Lens volumes of a picture that are written out in its shaders. What is written out runs at every pixel that any lens may
/// touch, and takes the longer to compile; the uber back end goes through more of them, tile by tile.
pub const MOST_WRITTEN_OUT: usize = 24;

impl Technique {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Accumulate, Self::Branches, Self::Regions, Self::ThreePass];

    /// Its word in scene files.
    pub fn word(self) -> &'static str {
        match self {
            Self::Accumulate => "accumulate",
            Self::Branches => "branches",
            Self::Regions => "regions",
            Self::ThreePass => "three-pass",
        }
    }

    /// The technique that a word means.
    pub fn of_word(word: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|t| t.word() == word)
    }

    /// Whether it draws the city once for each region.
    pub fn has_passes(self) -> bool {
        matches!(self, Self::Regions | Self::ThreePass)
    }

    /// Why it cannot do something, as the message of the key that asks for it.
    pub fn refusal(self, why: &str) -> SceneProblem {
        SceneProblem {
            table: "style".to_owned(),
            key: "technique".to_owned(),
            message: format!("\"{}\" {why}; \"accumulate\" would be right", self.word()),
            is_error: true,
        }
    }

    /// What of a scene it cannot do, as far as that can be told without the city.
    pub fn refuses(self, scene: &Scene) -> Option<SceneProblem> {
        self.why_not(scene).map(|why| self.refusal(&why))
    }

    fn why_not(self, scene: &Scene) -> Option<String> {
        if self == Self::Accumulate {
            return None;
        }
        let lenses: Vec<&Lens> = scene.lenses.iter().filter(|lens| lens.enabled).collect();
        let most = match self {
            Self::Branches => MOST_OF_BRANCHES,
            Self::Regions => MOST_OF_REGIONS,
            _ => usize::MAX,
        };
        if lenses.len() > most {
            let count = lenses.len();
            return Some(format!(
                "takes at most {most} lenses, for 2^{most} combinations of them; the scene has {count}"
            ));
        }
        if let Some(lens) = lenses.iter().find(|lens| lens.soft_border().is_some()) {
            return Some(format!("has no soft borders, and lens \"{}\" has one", lens.name));
        }
        let combinations = lenses.iter().map(|lens| classes(lens).len() + 1).try_fold(1_usize, usize::checked_mul);
        let room = 1 << most.min(MOST_OF_REGIONS);
        if self != Self::ThreePass && combinations.is_none_or(|count| count > room) {
            let count = combinations.map_or_else(|| "more".to_owned(), |count| count.to_string());
            return Some(format!("takes at most {room} combinations of lenses and classes; the scene has {count}"));
        }
        let context = || scene.style.effects.iter().map(|used| (used, "the context".to_owned()));
        let of_lenses = || lenses.iter().flat_map(|lens| lens.uses().map(|e| (e, format!("lens \"{}\"", lens.name))));
        let is_rule = |used: &EffectUse| find(&used.effect).is_some_and(|e| e.kind == EffectKind::Opacity);
        if let Some((used, whose)) = context().chain(of_lenses()).find(|(used, _)| is_rule(used)) {
            return Some(format!("shows nothing translucent, and {whose} has the effect \"{}\"", used.effect));
        }
        let is_partly = |lens: &&&Lens| !lens.time.iter().all(makes_one_moment);
        if let Some(lens) = lenses.iter().find(is_partly) {
            return Some(format!("shows nothing by halves, and the time of lens \"{}\" does", lens.name));
        }
        if !scene.time_steps.iter().all(makes_one_moment) {
            return Some("shows nothing by halves, and [time] steps do".to_owned());
        }
        if scene.city.dating.undated == Undated::Ghost {
            return Some("shows nothing by halves, and [city] undated = \"ghost\" does".to_owned());
        }
        if !self.has_passes() {
            return None;
        }
        if scene.shown_moment().is_some() {
            return Some("shows all times, and [time] at asks for one".to_owned());
        }
        if let Some(lens) = lenses.iter().find(|lens| !lens.time.is_empty()) {
            return Some(format!("shows all times, and lens \"{}\" has operators of time", lens.name));
        }
        for lens in &lenses {
            let name = &lens.name;
            if lens.shown().is_some() {
                return Some(format!("shows no contents of lenses, and lens \"{name}\" has one"));
            }
            let body = lens.drawn_body();
            if body != LensBody::None {
                return Some(format!(
                    "draws no bodies of lenses, and lens \"{name}\" has body = \"{}\" (\"none\" draws none)",
                    body.word()
                ));
            }
        }
        for (used, whose) in context().chain(of_lenses()) {
            let Some(definition) = find(&used.effect) else { continue };
            let what = match definition.kind {
                _ if definition.lines => "draws no lines",
                EffectKind::Hide => "hides nothing",
                EffectKind::Filter => "has no neighbourhood filters",
                _ => continue,
            };
            return Some(format!("{what}, and {whose} has the effect \"{}\"", used.effect));
        }
        let acts_beside = |lens: &&&Lens| lens.classes().any(|class| class != Class::Inside);
        match lenses.iter().find(acts_beside) {
            Some(lens) if self == Self::ThreePass && lenses.len() > 1 => Some(format!(
                "takes several lenses that act inside alone, and lens \"{}\" acts in front, behind or beside",
                lens.name
            )),
            _ => None,
        }
    }
}

/// The classes that a lens acts on, each once.
fn classes(lens: &Lens) -> Vec<Class> {
    let mut all: Vec<Class> = Vec::new();
    for class in lens.classes() {
        if !all.contains(&class) {
            all.push(class);
        }
    }
    all
}
