//! Looks of whole pictures: one word for effects on the context, what is behind the city, and the light of sun and sky.

use std::collections::BTreeMap;

use crate::{
    lens::{
        Class, EffectUse, Parameter,
        best_view::{Background, StyleLook},
    },
    scene::model::Style,
    shader::effect::{EffectKind, find},
};

/// What a look stands for.
#[derive(Debug)]
struct Row {
    look: StyleLook,
    word: &'static str,
    /// Effects on the context, each with its parameters.
    effects: &'static [(&'static str, &'static [(&'static str, Value)])],
    /// What is behind the city, sRGB; `None`: the sky.
    background: Option<[u8; 3]>,
    light: SkyLight,
}

/// A value of an effect's parameter.
#[derive(Debug)]
enum Value {
    Number(f64),
    Color(&'static str),
}

/// Light of sun, sky and ground by day, and the sky that is seen; linear light, of a white surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SkyLight {
    /// That of the sun on a surface that faces it, when it stands high.
    pub sun: [f32; 3],
    /// That of the whole sky on level ground.
    pub sky: [f32; 3],
    /// What the ground throws back on a surface that faces down.
    pub ground: [f32; 3],
    /// The sky above, sRGB.
    pub zenith: [f32; 3],
    /// The sky at the horizon, sRGB.
    pub horizon: [f32; 3],
}

/// A clear day.
const DAY: SkyLight = SkyLight {
    sun: [0.86, 0.817, 0.7396],
    sky: [0.335, 0.375, 0.43],
    ground: [0.20, 0.185, 0.165],
    zenith: [0.57, 0.70, 0.84],
    horizon: [0.90, 0.925, 0.94],
};
/// The same of one white light: shades of grey stay grey.
const WHITE: SkyLight = SkyLight { sun: [0.72; 3], sky: [0.46; 3], ground: [0.26; 3], ..DAY };
/// A clear night: the moon from where the sun stands, and streets that light walls from below.
const NIGHT: SkyLight = SkyLight {
    sun: [0.115, 0.145, 0.205],
    sky: [0.035, 0.047, 0.085],
    ground: [0.135, 0.088, 0.042],
    zenith: [0.055, 0.085, 0.17],
    horizon: [0.19, 0.235, 0.34],
};

const ROWS: [Row; 5] = [
    Row { look: StyleLook::Natural, word: "natural", effects: &[], background: None, light: DAY },
    Row {
        look: StyleLook::Paper,
        word: "paper",
        effects: &[
            ("clay", &[("color", Value::Color("#f4f2ee"))]),
            ("edges", &[("color", Value::Color("#2e2d2b")), ("strength", Value::Number(0.72))]),
        ],
        background: Some([255, 255, 255]),
        light: WHITE,
    },
    Row {
        look: StyleLook::Map,
        word: "map",
        effects: &[
            ("flat", &[("relief", Value::Number(0.2)), ("shadows", Value::Number(0.3))]),
            ("saturate", &[("factor", Value::Number(0.72))]),
            ("brighten", &[("amount", Value::Number(0.3))]),
            ("edges", &[("color", Value::Color("#6d675c")), ("strength", Value::Number(0.55))]),
        ],
        background: Some([0xf3, 0xf0, 0xe9]),
        light: DAY,
    },
    Row { look: StyleLook::Night, word: "night", effects: &[], background: None, light: NIGHT },
    Row {
        look: StyleLook::Blueprint,
        word: "blueprint",
        effects: &[(
            "hidden-line",
            &[
                ("paper", Value::Color("#1f4f8f")),
                ("shading", Value::Number(0.35)),
                ("line_color", Value::Color("#e4eefb")),
                ("line_width", Value::Number(0.825)),
            ],
        )],
        background: Some([0x1a, 0x44, 0x7e]),
        light: WHITE,
    },
];

impl StyleLook {
    /// All, with their words in scene files.
    pub const WORDS: [(&str, Self); 5] = [
        (ROWS[0].word, ROWS[0].look),
        (ROWS[1].word, ROWS[1].look),
        (ROWS[2].word, ROWS[2].look),
        (ROWS[3].word, ROWS[3].look),
        (ROWS[4].word, ROWS[4].look),
    ];

    fn row(self) -> &'static Row {
        const { &ROWS }.iter().find(|row| row.look == self).unwrap_or(const { &ROWS[0] })
    }

    /// Its light.
    pub fn light(self) -> &'static SkyLight {
        &self.row().light
    }
}

impl Row {
    fn uses(&self) -> Vec<EffectUse> {
        let parameter = |(name, value): &(&str, Value)| {
            let value = match value {
                Value::Number(number) => Parameter::Number(*number),
                Value::Color(color) => Parameter::Text((*color).to_owned()),
            };
            ((*name).to_owned(), value)
        };
        let used = |(name, parameters): &(&str, &[(&str, Value)])| EffectUse {
            effect: (*name).to_owned(),
            class: Class::Inside,
            blend: None,
            weight: None,
            parameters: parameters.iter().map(parameter).collect::<BTreeMap<_, _>>(),
        };
        self.effects.iter().map(used).collect()
    }
}

impl Style {
    /// The effects on the context: those of the look, and between its scene style and the others those of the style itself. Where that has
    /// a scene style, or an effect of the same name, it stands in place of the look's.
    pub fn all_effects(&self) -> Vec<EffectUse> {
        let is_scene = |used: &EffectUse| find(&used.effect).is_some_and(|found| found.kind == EffectKind::Scene);
        let is_own = |used: &EffectUse| self.effects.iter().any(|own| own.effect == used.effect);
        let uses = self.look.row().uses().into_iter().filter(|used| !is_own(used));
        let (scene, others): (Vec<_>, Vec<_>) = uses.partition(is_scene);
        let scene = scene.into_iter().filter(|_| !self.effects.iter().any(is_scene));
        scene.chain(self.effects.iter().cloned()).chain(others).collect()
    }

    /// What is behind the city: where it says nothing else, what the look has there.
    pub fn backdrop(&self) -> Background {
        match (self.background, self.look.row().background) {
            (Background::Sky, Some(color)) => Background::Color(color.map(|byte| f32::from(byte) / 255.0)),
            (background, _) => background,
        }
    }

    /// With the effects and the background of its look as its own.
    pub fn drawn(&self) -> Self {
        Self { effects: self.all_effects(), background: self.backdrop(), ..self.clone() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lens::effect;

    fn names(style: &Style) -> Vec<String> {
        style.all_effects().into_iter().map(|used| used.effect).collect()
    }

    fn used(effect: &str) -> EffectUse {
        let (class, parameters) = (Class::Inside, BTreeMap::new());
        EffectUse { effect: effect.to_owned(), class, blend: None, weight: None, parameters }
    }

    #[test]
    fn effects_of_looks_are_there_and_take_these_parameters() {
        for (word, look) in StyleLook::WORDS {
            for one in look.row().uses() {
                let found = find(&one.effect);
                assert!(found.is_some(), "{word}: {}", one.effect);
                let definition = found.unwrap();
                let problems = effect::problems_of_parameters(definition, &one.parameters, &[]);
                assert!(problems.is_empty(), "{word}: {problems:?}");
            }
        }
    }

    #[test]
    fn a_style_keeps_its_own_effects_below_the_lines_of_its_look() {
        let paper = Style { look: StyleLook::Paper, ..Style::default() };
        assert_eq!(names(&paper), ["clay", "edges"]);
        let warm = Style { effects: vec![used("sepia")], ..paper.clone() };
        assert_eq!(names(&warm), ["clay", "sepia", "edges"]);
        // Of two scene styles one would be left anyway.
        let by_age = Style { effects: vec![used("thematic"), used("sepia")], ..paper };
        assert_eq!(names(&by_age), ["thematic", "sepia", "edges"]);
        for (_, look) in StyleLook::WORDS {
            let once = Style { look, ..by_age.clone() }.drawn();
            assert_eq!(once.drawn(), once, "{look:?}");
        }
    }

    #[test]
    fn a_background_of_ones_own_stays() {
        let own = Background::Color([0.2, 0.4, 0.6]);
        assert_eq!(Style { look: StyleLook::Paper, background: own, ..Style::default() }.backdrop(), own);
        assert_eq!(Style { look: StyleLook::Paper, ..Style::default() }.backdrop(), Background::Color([1.0; 3]));
        assert_eq!(Style { look: StyleLook::Night, ..Style::default() }.backdrop(), Background::Sky);
    }

    #[test]
    fn plain_style_is_drawn_as_it_is() {
        let style = Style { effects: vec![used("sepia")], ..Style::default() };
        assert_eq!(style.drawn(), style);
    }
}
