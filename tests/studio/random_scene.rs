//! Random scenes: two to four lenses of any kind in one place, as text of scene files. A number gives the same scene each time. Scenes
//! come in families of [`FAMILY`], which have the same lenses in other places, of other sizes, from other eyes: one program draws them all,
//! and most of what a small picture takes is the making of its program.

use std::fmt::Write as _;

use veduta::shader::{EffectDefinition, EffectKind, PerObject, effects};

#[path = "random.rs"]
mod random;

pub use random::Random;

/// What a random scene may have.
#[derive(Clone, Copy)]
pub struct Wanted {
    /// Lenses, from these to those.
    pub lenses: [usize; 2],
    /// Whether there may be kinds that move the city.
    pub deformations: bool,
    /// Keys of `[city]` that give it a history; then there are moments, and lenses that show others.
    pub history: Option<&'static str>,
}

/// Scenes of a family, one after the other in number.
pub const FAMILY: u64 = 40;

/// What is thrown for a scene.
struct Dice {
    /// What a family has in common.
    choices: Random,
    /// Places, sizes, shares.
    numbers: Random,
    /// Kinds of time operators, of a family.
    times: Random,
}

impl Dice {
    fn below(&mut self, end: usize) -> usize {
        self.choices.below(end)
    }

    fn pick<'a, T>(&mut self, list: &'a [T]) -> &'a T {
        self.choices.pick(list)
    }

    fn once_in(&mut self, n: usize) -> bool {
        self.choices.once_in(n)
    }

    fn number(&mut self, low: f64, high: f64) -> f64 {
        self.numbers.number(low, high)
    }
}

/// A scene file over a city around the origin.
pub fn scene(seed: u64, city: &str, wanted: Wanted) -> String {
    let dice = &mut Dice {
        choices: Random::new(seed / FAMILY, 0),
        numbers: Random::new(seed, 1),
        times: Random::new(seed / FAMILY, 2),
    };
    let angle = dice.number(0.0, 6.25);
    let (distance, height) = (dice.number(40.0, 160.0), dice.number(4.0, 140.0));
    let (history, moment, sun) = history(dice, wanted);
    let mut text = format!(
        "veduta = 1\n[city]\nfiles = [\"{city}\"]\n{history}{moment}[camera]\neye = [{:.2}, {:.2}, {height:.2}]\ntarget = [{:.2}, {:.2}, 8]\nfov_deg = 55\n\
         [sun]\n{sun}shadows = {}\n[[poi]]\nname = \"p\"\nat = [{:.2}, {:.2}, {:.2}]\n",
        distance * angle.cos(),
        distance * angle.sin(),
        dice.number(-20.0, 20.0),
        dice.number(-20.0, 20.0),
        dice.once_in(6),
        dice.number(-40.0, 40.0),
        dice.number(-40.0, 40.0),
        dice.number(1.0, 12.0),
    );
    if dice.once_in(6) {
        text += "[style]\nbase = \"clay\"\n";
    }
    let [least, most] = wanted.lenses;
    for i in 0..least + dice.below(most - least + 1) {
        text += &lens(dice, i, wanted);
        if wanted.history.is_some() && !dice.times.once_in(3) {
            let _ = writeln!(text, "time = [{}]", operators(dice, i));
        }
    }
    text
}

/// Of `[city]`, `[time]` and `[sun]` what is of time.
fn history(dice: &mut Dice, wanted: Wanted) -> (String, String, &'static str) {
    let Some(history) = wanted.history else { return Default::default() };
    let undated = *dice.times.pick(&["show", "hide", "ghost"]);
    let mut moment = format!("[time]\nat = \"{}\"\n", year(dice));
    if dice.times.once_in(3) {
        let _ = writeln!(moment, "steps = [{}]", operators(dice, 0));
    }
    let is_lit = dice.times.once_in(6);
    let sun = if is_lit { "follows_time = true\nin_lenses = true\nplace = [52, 4]\n" } else { "" };
    (format!("undated = \"{undated}\"\n{history}\n"), moment, sun)
}

fn year(dice: &mut Dice) -> String {
    format!("{:.0}-06-01T10:00", dice.number(1500.0, 2020.0))
}

/// One to three time operators of a lens, by its number: links go to lenses below alone.
fn operators(dice: &mut Dice, number: usize) -> String {
    let by = |dice: &mut Dice| format!("{:.0} years", dice.number(-200.0, 200.0));
    let one = |dice: &mut Dice| match dice.times.below(8) {
        0 | 1 => format!("{{ op = \"set\", at = \"{}\" }}", year(dice)),
        2 | 3 => format!("{{ op = \"shift\", by = \"{}\" }}", by(dice)),
        4 => format!("{{ op = \"aggregate\", at = [\"{}\", \"{}\"], weights = [1, 2] }}", year(dice), by(dice)),
        5 => format!("{{ op = \"aggregate\", at = [\"0 s\", \"{}\"], show = \"any\" }}", by(dice)),
        6 => "{ op = \"ghost\", past = \"120 years\", future = \"90 years\" }".to_owned(),
        _ if number > 0 => format!("{{ op = \"link\", to = \"l{}\", by = \"{}\" }}", number - 1, by(dice)),
        _ => "{ op = \"floor\", unit = \"100 years\" }".to_owned(),
    };
    (0..=dice.times.below(2)).map(|_| one(dice)).collect::<Vec<_>>().join(", ")
}

fn lens(dice: &mut Dice, number: usize, wanted: Wanted) -> String {
    let kinds = if wanted.deformations { 9 } else { 8 };
    let mut text = format!("[[lens]]\nname = \"l{number}\"\n");
    let body = *dice.pick(&["outline", "outline", "shell", "halo", "none"]);
    match dice.below(kinds) {
        0..4 => {
            let (shape, mut effects) = (shape(dice, 2), steps(dice, 3));
            if wanted.history.is_some() && dice.times.once_in(2) {
                effects = "{ effect = \"thematic\", attribute = \"use\" }".to_owned();
            }
            let _ = writeln!(text, "kind = \"color\"\nshape = {shape}\neffects = [{effects}]");
            if dice.once_in(3) {
                let _ = writeln!(text, "border = {}", border(dice));
            }
        }
        4 | 5 => {
            let test = *dice.pick(&[
                "{ kind = \"exact\" }",
                "{ kind = \"view-axis\" }",
                "{ kind = \"spherical\", radius = 60 }",
                "{ kind = \"viewer-height\", radius = 80 }",
            ]);
            let render = *dice.pick(&[
                "discard",
                "box",
                "transparent",
                "transparent-plain",
                "transparent-box",
                "x-ray",
                "x-ray-color",
                "x-ray-shape",
                "flatten",
                "dither",
                "lod1",
                "flatten-top",
                "hull",
                "low",
            ]);
            let _ = writeln!(text, "kind = \"occlusion\"\npoi = \"p\"\ntest = {test}\nrender = \"{render}\"");
        }
        6 | 7 => {
            let _ = writeln!(text, "kind = \"content\"\nshape = {}\ncontent = {}", shape(dice, 1), content(dice));
            if dice.once_in(3) {
                let _ = writeln!(text, "clip = \"{}\"", dice.pick(&["merge", "discard"]));
            }
            if dice.once_in(4) {
                let _ = writeln!(text, "effects = [{}]", steps(dice, 1));
            }
        }
        _ => {
            let _ = writeln!(text, "kind = \"deformation\"\nshape = {}\ndeform = [{}]", upright(dice), deformed(dice));
        }
    }
    if !text.contains("deformation") && wanted.deformations && dice.once_in(5) {
        text += "space = \"rest\"\n";
    }
    let _ = writeln!(text, "body = \"{body}\"");
    text
}

fn place(dice: &mut Dice) -> String {
    format!("[{:.2}, {:.2}, {:.2}]", dice.number(-60.0, 60.0), dice.number(-60.0, 60.0), dice.number(-2.0, 20.0))
}

fn turned(dice: &mut Dice) -> String {
    if dice.once_in(2) {
        return String::new();
    }
    format!(", rotation_deg = [{}, {}, {}]", dice.below(360), dice.below(120) as i32 - 60, dice.below(120) as i32 - 60)
}

/// A shape; combinations of some at most so deep.
fn shape(dice: &mut Dice, depth: usize) -> String {
    let of = |dice: &mut Dice, low: f64, high: f64| dice.number(low, high);
    match dice.below(if depth > 0 { 12 } else { 7 }) {
        0 | 1 => format!("{{ kind = \"sphere\", center = {}, radius = {:.2} }}", place(dice), of(dice, 8.0, 50.0)),
        2 => {
            let [x, y, z] = [0; 3].map(|_| of(dice, 6.0, 50.0));
            format!(
                "{{ kind = \"ellipsoid\", center = {}, radii = [{x:.2}, {y:.2}, {z:.2}]{} }}",
                place(dice),
                turned(dice)
            )
        }
        3 => {
            let [x, y, z] = [0; 3].map(|_| of(dice, 10.0, 80.0));
            format!("{{ kind = \"box\", center = {}, size = [{x:.2}, {y:.2}, {z:.2}]{} }}", place(dice), turned(dice))
        }
        4 => {
            let (radius, height) = (of(dice, 8.0, 40.0), of(dice, 10.0, 70.0));
            format!("{{ kind = \"cylinder\", center = {}, radius = {radius:.2}, height = {height:.2} }}", place(dice))
        }
        5 => {
            let (radius, top, height) = (of(dice, 8.0, 50.0), of(dice, 0.0, 30.0), of(dice, 10.0, 60.0));
            let center = place(dice);
            format!(
                "{{ kind = \"frustum\", center = {center}, radius = {radius:.2}, top_radius = {top:.2}, height = {height:.2} }}"
            )
        }
        6 => {
            let (from, to) = (place(dice), place(dice));
            let (width, height) = (of(dice, 6.0, 30.0), of(dice, 10.0, 50.0));
            format!("{{ kind = \"corridor\", points = [{from}, {to}], width = {width:.2}, height = {height:.2} }}")
        }
        7 => {
            let [x, y] = [0; 2].map(|_| of(dice, -40.0, 20.0));
            let size = of(dice, 15.0, 60.0);
            format!(
                "{{ kind = \"mask\", points = [[{x:.2}, {y:.2}], [{:.2}, {y:.2}], [{:.2}, {:.2}]], base = -1, height = {:.2} }}",
                x + size,
                x + 0.4 * size,
                y + size,
                of(dice, 5.0, 40.0)
            )
        }
        8 => format!("{{ kind = \"enclosed\", shapes = [{}] }}", shape(dice, 0)),
        9 => {
            let kind = *dice.pick(&["Building", "SolitaryVegetationObject", "Road"]);
            format!("{{ kind = \"thematic\", types = [\"{kind}\"] }}")
        }
        _ => {
            let how = *dice.pick(&["union", "intersection", "difference"]);
            format!("{{ kind = \"{how}\", shapes = [{}, {}] }}", shape(dice, 0), shape(dice, 0))
        }
    }
}

/// A box or a cylinder that stands upright, as deformations want it.
fn upright(dice: &mut Dice) -> String {
    let [x, y, z] = [0; 3].map(|_| dice.number(40.0, 110.0));
    format!("{{ kind = \"box\", center = {}, size = [{x:.2}, {y:.2}, {z:.2}] }}", place(dice))
}

fn deformed(dice: &mut Dice) -> String {
    match dice.below(5) {
        0 => format!("{{ kind = \"twist\", angle_deg = {} }}", dice.below(120) as i32 - 60),
        1 => format!("{{ kind = \"taper\", factor = {:.2} }}", dice.number(0.5, 1.4)),
        2 => format!("{{ kind = \"bend\", angle_deg = {} }}", dice.below(80) as i32 - 40),
        3 => format!("{{ kind = \"scale\", factors = [1.0, 1.0, {:.2}] }}", dice.number(0.4, 2.5)),
        _ => format!(
            "{{ kind = \"translate\", by = [{:.2}, 0.0, {:.2}] }}",
            dice.number(-8.0, 8.0),
            dice.number(-4.0, 20.0)
        ),
    }
}

fn content(dice: &mut Dice) -> String {
    let own = match dice.below(7) {
        0 => "derive = \"box\"".to_owned(),
        1 => "derive = \"hull\"".to_owned(),
        2 => "derive = \"flat\"".to_owned(),
        3 => "derive = \"prism\"".to_owned(),
        4 => "derive = \"height\", height = 4.0".to_owned(),
        _ => format!(
            "from = [0, 0, 0], to = [{:.2}, {:.2}, {:.2}], rotation_deg = [{}, 0, 0], scale = {:.2}",
            dice.number(-20.0, 20.0),
            dice.number(-20.0, 20.0),
            dice.number(0.0, 15.0),
            dice.below(360),
            dice.number(0.3, 1.6)
        ),
    };
    let class = *dice.pick(&["inside", "inside", "inside", "behind", "front"]);
    format!("{{ {own}, class = \"{class}\" }}")
}

fn border(dice: &mut Dice) -> String {
    let width = dice.number(1.0, 20.0);
    let discrete = if dice.once_in(3) { ", discrete = \"dither\"" } else { "" };
    format!("{{ width = {width:.2}{discrete} }}")
}

/// Effects that a lens may have with their defaults alone.
fn ready() -> impl Iterator<Item = &'static EffectDefinition> {
    let kinds = [
        EffectKind::Hide,
        EffectKind::Opacity,
        EffectKind::Material,
        EffectKind::Light,
        EffectKind::Scene,
        EffectKind::Post,
        EffectKind::Filter,
    ];
    effects().filter(move |e| {
        kinds.contains(&e.kind) && e.objects != Some(PerObject::Sights) && !e.parameters.iter().any(|p| p.is_required())
    })
}

/// One to `most` effects; of scene styles and filters one at most.
fn steps(dice: &mut Dice, most: usize) -> String {
    let all: Vec<&EffectDefinition> = ready().collect();
    let (mut chosen, mut has_style): (Vec<String>, bool) = (Vec::new(), false);
    for _ in 0..1 + dice.below(most) {
        let effect = dice.pick(&all);
        let is_style = matches!(effect.kind, EffectKind::Scene | EffectKind::Filter);
        if is_style && has_style {
            continue;
        }
        has_style |= is_style;
        let class = *dice.pick(&["inside", "inside", "inside", "behind", "front", "rest"]);
        chosen.push(format!("{{ effect = \"{}\", class = \"{class}\" }}", effect.name));
    }
    chosen.join(", ")
}
