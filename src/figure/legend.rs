//! What the legends of a scene say: one for each scale of colours that can be seen.

use rustc_hash::FxHashMap;

use crate::{
    city::{CityModel, shown::ShownObjects},
    figure::ticks::number_text,
    lens::{
        EffectUse,
        color::Srgb,
        ramp::{RampColors, RampKind},
        source::OF_SURFACES,
        thematic::{LegendEntry, LegendKind, Rule, ThematicScale},
    },
    render::fields::ShownVolume,
    scene::Scene,
    shader::{PerObject, effect::find},
};

/// Legends of one picture at most.
pub const MOST: usize = 16;

/// A legend.
#[derive(Clone, Debug, PartialEq)]
pub struct Legend {
    /// What is shown: the effect's `label`, else the attribute's name.
    pub title: String,
    /// Its unit, if the effect names one.
    pub unit: Option<String>,
    /// Name and colour of the lenses it is for; none: the context.
    pub lenses: Vec<(String, Srgb)>,
    /// How values become colours.
    pub scale: ThematicScale,
}

/// One line of a legend: a colour and what it stands for.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// sRGB 0..1, as the effect has it before light.
    pub color: Srgb,
    /// What it stands for.
    pub label: String,
    /// Whether it stays when there is no room for all.
    pub is_kept: bool,
}

/// The legends of a scene, the context's first, then those of the lenses from the top one down; `seen[i]` says whether
/// lens i can be seen. Uses of one scale share a legend. An attribute that the city does not have has none: drawing
/// says so. `now`: the city with the values of the moment that is shown, whose objects are counted; `beside`: other data sets whose objects are
/// counted, too.
pub fn legends(
    scene: &Scene,
    model: &CityModel,
    seen: &[bool],
    now: &CityModel,
    beside: &[ShownObjects],
) -> Vec<Legend> {
    let context = scene.style.effects.iter().map(|used| (used, None));
    let drawn = scene.drawn();
    let is_seen = |i: usize| seen.get(drawn.owner(i as u32) as usize) == Some(&true);
    let lenses = drawn.scene.lenses.iter().enumerate().rev().filter(|(i, lens)| lens.enabled && is_seen(*i));
    let of_lenses = lenses.flat_map(|(_, lens)| lens.uses().map(move |used| (used, Some(lens))));
    let mut legends: Vec<Legend> = Vec::new();
    for (used, lens) in context.chain(of_lenses).filter(|(used, _)| is_thematic(used)) {
        let Ok(mut scale) = ThematicScale::new(model, used) else { continue };
        if !std::ptr::eq(now, model) {
            scale.count_now(now);
        }
        beside.iter().for_each(|shown| scale.count_beside(shown));
        let named = scale.attribute.strip_prefix(OF_SURFACES).unwrap_or(&scale.attribute);
        let title = used.text("label").or(scale.measure.map(|m| m.label)).unwrap_or(named).to_owned();
        let unit = used.text("unit").or(scale.measure.map(|m| m.unit)).map(str::to_owned);
        let mark = lens.map(|lens| (lens.name.clone(), lens.color));
        match legends.iter_mut().find(|l| l.scale == scale && l.title == title && l.unit == unit) {
            // What holds in the context holds everywhere.
            Some(same) if same.lenses.is_empty() => {}
            Some(same) => same.lenses.extend(mark.filter(|m| !same.lenses.contains(m))),
            None => legends.push(Legend { title, unit, lenses: mark.into_iter().collect(), scale }),
        }
        if legends.len() == MOST {
            break;
        }
    }
    legends
}

/// Places at which the colours of a transfer function are looked at.
const TRANSFER_COLORS: usize = 129;
/// Columns of its opacities.
const OPACITY_COLUMNS: usize = 33;
/// What an opacity of 1 is in columns.
const OPAQUE: f64 = 1000.0;

/// The legends of the volumes of a scene; columns are as high as values are opaque.
pub fn volume_legends(scene: &Scene, shown: &[ShownVolume]) -> Vec<Legend> {
    let legend = |own: &ShownVolume| {
        let volume = &scene.volumes[own.index];
        let transfer = &volume.transfer;
        let [min, max] = own.ends;
        let places = |count: usize| (0..count).map(move |i| min + (max - min) * i as f64 / (count - 1) as f64);
        let rule = match volume.labels {
            true => Rule::Categories { colors: FxHashMap::default() },
            false => {
                let colors = places(TRANSFER_COLORS).map(|value| transfer.look(value, own.ends).0).collect();
                Rule::Ramp { colors: RampColors::own(RampKind::Sequential, colors), min, max }
            }
        };
        let entry = |(i, label): (usize, &f64)| LegendEntry {
            color: transfer.label_color(i),
            label: transfer.names.get(i).cloned().unwrap_or_else(|| number_text(*label, 1.0)),
            count: 0,
            kind: LegendKind::Value,
        };
        let opacity = |value: f64| (OPAQUE * f64::from(transfer.look(value, own.ends).1)).round() as u64;
        let is_ramp = !volume.labels;
        let scale = ThematicScale {
            attribute: own.title.clone(),
            measure: None,
            rule,
            legend: match is_ramp {
                true if max > min => Vec::new(),
                true => vec![LegendEntry {
                    color: transfer.look(min, own.ends).0,
                    label: number_text(min, 0.01),
                    count: 0,
                    kind: LegendKind::Value,
                }],
                false => transfer.values.iter().enumerate().map(entry).collect(),
            },
            no_data: [0.0; 3],
            threshold: None,
            relief: 0.0,
            counts: false,
            histogram: if is_ramp { places(OPACITY_COLUMNS).map(opacity).collect() } else { Vec::new() },
        };
        Legend { title: own.title.clone(), unit: own.unit.clone(), lenses: Vec::new(), scale }
    };
    shown.iter().map(legend).collect()
}

/// Adds the legends of another picture: those of one scale and title are shared, and belong to the lenses of both.
pub fn join(all: &mut Vec<Legend>, others: Vec<Legend>) {
    for other in others {
        let has_room = all.len() < MOST;
        let is_same = |l: &&mut Legend| l.scale == other.scale && l.title == other.title && l.unit == other.unit;
        match all.iter_mut().find(is_same) {
            // What holds in a context holds everywhere.
            Some(same) if same.lenses.is_empty() => {}
            Some(same) if other.lenses.is_empty() => same.lenses.clear(),
            Some(same) => {
                let new: Vec<_> = other.lenses.into_iter().filter(|lens| !same.lenses.contains(lens)).collect();
                same.lenses.extend(new);
            }
            None if has_room => all.push(other),
            None => {}
        }
    }
}

fn is_thematic(used: &EffectUse) -> bool {
    find(&used.effect).is_some_and(|definition| definition.objects == Some(PerObject::Colors))
}

impl Legend {
    /// How high the columns of a histogram along the bar are, the highest 1; none where nobody asked.
    pub fn columns(&self) -> Vec<f32> {
        let most = self.scale.histogram.iter().copied().max().unwrap_or(0).max(1) as f32;
        self.scale.histogram.iter().map(|count| *count as f32 / most).collect()
    }

    /// Ends of the ramp where there is one to draw as a bar.
    pub fn bar(&self) -> Option<(f64, f64)> {
        match self.scale.rule {
            Rule::Ramp { min, max, .. } if max > min && (max - min).is_finite() => Some((min, max)),
            _ => None,
        }
    }

    /// The lines beside or below the bar: classes, categories, threshold, no data. What has no value is counted, the others where that is asked
    /// for.
    pub fn rows(&self) -> Vec<Row> {
        let bar = self.bar().is_some();
        let mut rows: Vec<Row> = Vec::new();
        for entry in self.scale.legend.iter().filter(|e| !(bar && e.kind == LegendKind::Value)) {
            let count = || format!("{} ({})", entry.label, number_text(entry.count as f64, 1.0));
            let is_counted = self.scale.counts || entry.kind == LegendKind::NoData;
            let label = if is_counted { count() } else { entry.label.clone() };
            let row = Row { color: entry.color, label, is_kept: entry.kind != LegendKind::Value };
            // A ramp of one value has two ends of one name.
            if rows.last() != Some(&row) {
                rows.push(row);
            }
        }
        rows
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use crate::{
        city::load::{LoadOptions, Quiet, load},
        lens::{Class, Lens, LensKind, Parameter},
    };

    fn used(parameters: &[(&str, &str)]) -> EffectUse {
        let parameters = parameters.iter().map(|(k, v)| ((*k).into(), Parameter::Text((*v).into()))).collect();
        EffectUse { effect: "thematic".into(), class: Class::Inside, blend: None, weight: None, parameters }
    }

    fn lens(name: &str, effects: Vec<EffectUse>) -> Lens {
        Lens {
            name: name.into(),
            kind: LensKind::default(),
            enabled: true,
            color: [1.0, 0.0, 0.0],
            placement: Default::default(),
            shapes: vec![],
            effects,
            time: vec![],
            body: Default::default(),
            sprite: None,
            border: None,
            keeps_shadows: false,
            at_rest: false,
            section: None,
        }
    }

    #[test]
    fn uses_of_one_scale_share_a_legend() {
        let model = load(&["builtin:town".into()], &LoadOptions::default(), &Quiet).unwrap();
        let age = || used(&[("attribute", "yearOfConstruction")]);
        let function = used(&[("attribute", "function"), ("label", "Use"), ("unit", "kind")]);
        let reversed = EffectUse {
            parameters: age().parameters.into_iter().chain([("reverse".into(), Parameter::Boolean(true))]).collect(),
            ..age()
        };
        let sepia = EffectUse { effect: "sepia".into(), parameters: BTreeMap::new(), ..age() };
        let lenses = vec![
            lens("a", vec![age(), sepia]),
            lens("b", vec![function]),
            lens("c", vec![age()]),
            lens("hidden", vec![reversed.clone()]),
            Lens { enabled: false, ..lens("off", vec![reversed]) },
            lens("unknown", vec![used(&[("attribute", "nothing")])]),
        ];
        let mut scene = Scene { lenses, ..Scene::default() };
        let all = legends(&scene, &model, &[true, true, true, false, true, true], &model, &[]);
        let said: Vec<_> = all
            .iter()
            .map(|l| (l.title.as_str(), l.unit.as_deref(), l.lenses.iter().map(|l| l.0.as_str()).collect::<String>()))
            .collect();
        assert_eq!(said, [("yearOfConstruction", None, "ca".to_owned()), ("Use", Some("kind"), "b".to_owned())]);
        scene.style.effects = vec![age()];
        let all = legends(&scene, &model, &[true; 6], &model, &[]);
        assert_eq!(all.len(), 3, "the reversed one is another scale");
        assert!(all[0].lenses.is_empty(), "the context's holds everywhere");
    }

    #[test]
    fn a_bar_has_no_rows_for_its_ends() {
        let model = load(&["builtin:town".into()], &LoadOptions::default(), &Quiet).unwrap();
        let of = |parameters: &[(&str, &str)]| {
            let scene = Scene { lenses: vec![lens("a", vec![used(parameters)])], ..Scene::default() };
            legends(&scene, &model, &[true], &model, &[]).remove(0)
        };
        let ramp = of(&[("attribute", "yearOfConstruction")]);
        assert!(ramp.bar().is_some_and(|(min, max)| min < max));
        assert!(ramp.rows().iter().all(|row| row.is_kept));
        let no_data = ramp.scale.legend.iter().find(|e| e.kind == LegendKind::NoData).expect("some have none");
        assert!(ramp.rows().iter().any(|row| row.label == format!("no data ({})", no_data.count)));
        assert_eq!(ramp.columns(), [] as [f32; 0]);
        let classes = of(&[("attribute", "yearOfConstruction"), ("scale", "equal")]);
        assert_eq!(classes.bar(), None);
        assert_eq!(classes.rows().iter().filter(|row| !row.is_kept).count(), 5);
    }

    #[test]
    fn counts_and_columns_are_those_of_the_objects() {
        let model = load(&["builtin:town".into()], &LoadOptions::default(), &Quiet).unwrap();
        let of = |flags: &[&str], parameters: &[(&str, &str)]| {
            let mut effect = used(parameters);
            effect.parameters.extend(flags.iter().map(|flag| ((*flag).into(), Parameter::Boolean(true))));
            let scene = Scene { lenses: vec![lens("a", vec![effect])], ..Scene::default() };
            legends(&scene, &model, &[true], &model, &[]).remove(0)
        };
        let classes = of(&["counts"], &[("attribute", "yearOfConstruction"), ("scale", "natural")]);
        for (row, entry) in classes.rows().iter().zip(&classes.scale.legend) {
            assert_eq!(row.label, format!("{} ({})", entry.label, number_text(entry.count as f64, 1.0)));
        }
        let ramp = of(&["histogram"], &[("attribute", "yearOfConstruction")]);
        let with_value: u64 =
            classes.scale.legend.iter().filter(|e| e.kind == LegendKind::Value).map(|e| e.count).sum();
        assert_eq!(ramp.scale.histogram.iter().sum::<u64>(), with_value);
        assert!(ramp.columns().contains(&1.0) && ramp.columns().iter().all(|c| (0.0..=1.0).contains(c)));
        // What is measured has a name and a unit of its own.
        let height = of(&[], &[("attribute", "geometry:height")]);
        assert_eq!((height.title.as_str(), height.unit.as_deref()), ("Height", Some("m")));
        let named = of(&[], &[("attribute", "geometry:height"), ("label", "Tall"), ("unit", "ft")]);
        assert_eq!((named.title.as_str(), named.unit.as_deref()), ("Tall", Some("ft")));
    }
}
