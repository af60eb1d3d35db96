//! Links in time: which lenses a step may name, and what becomes of it when such a lens gets another name or goes.

use crate::lens::{
    definition::Lens,
    effect_use::Parameter,
    epoch::{DELAY, LINK, LINKED, SHIFT, delayed},
    handled::Handled,
};

/// Whether a parameter of a time operator is the name of a lens.
pub fn names_lens(operator: &str, parameter: &str) -> bool {
    operator == LINK && parameter == LINKED
}

/// The step that shows what another lens shows, so much later.
pub fn link_to(name: &str, delay: &str) -> Handled {
    let text = |key: &str, text: &str| (key.to_owned(), Parameter::Text(text.to_owned()));
    Handled { handler: LINK.to_owned(), parameters: [text(LINKED, name), text(DELAY, delay)].into() }
}

/// The step that shows what is so much later.
pub fn shift_by(delay: &str) -> Handled {
    Handled { handler: SHIFT.to_owned(), parameters: [(DELAY.to_owned(), Parameter::Text(delay.to_owned()))].into() }
}

/// The lens that a step names.
pub fn linked_lens(step: &Handled) -> Option<&str> {
    match step.parameters.get(LINKED) {
        Some(Parameter::Text(name)) if step.handler == LINK => Some(name),
        _ => None,
    }
}

/// The names of the lenses that one may be linked to: links of none of them lead back to it. `None`: what is linked is the whole scene.
pub fn linkable(lenses: &[Lens], from: Option<usize>) -> Vec<&str> {
    let own = from.and_then(|from| lenses.get(from)).map(|lens| lens.name.as_str());
    let is_free = |lens: &&Lens| own.is_none_or(|own| !leads_to(lenses, &lens.name, own, &mut Vec::new()));
    lenses.iter().filter(is_free).map(|lens| lens.name.as_str()).collect()
}

/// Whether a lens is another one, or links lead from it there.
fn leads_to<'a>(lenses: &'a [Lens], from: &'a str, to: &str, seen: &mut Vec<&'a str>) -> bool {
    if from == to {
        return true;
    }
    if seen.contains(&from) {
        return false;
    }
    seen.push(from);
    let steps = lenses.iter().filter(|lens| lens.name == from).flat_map(|lens| &lens.time);
    steps.filter_map(linked_lens).any(|next| leads_to(lenses, next, to, seen))
}

/// Gives a lens another name in the steps that name it.
pub fn rename(steps: &mut [Handled], before: &str, after: &str) {
    for step in steps.iter_mut().filter(|step| linked_lens(step) == Some(before)) {
        step.parameters.insert(LINKED.to_owned(), Parameter::Text(after.to_owned()));
    }
}

/// Puts the steps of a lens, and the delay behind them, in the place of links to it: what shows stays as it is.
pub fn replace(steps: &mut Vec<Handled>, name: &str, own: &[Handled]) {
    if !steps.iter().any(|step| linked_lens(step) == Some(name)) {
        return;
    }
    *steps = std::mem::take(steps)
        .into_iter()
        .flat_map(|step| match linked_lens(&step) == Some(name) {
            true => own.iter().cloned().chain(delayed(&step)).collect(),
            false => vec![step],
        })
        .collect();
    if steps.is_empty() {
        // A time lens has a step, though it shows what shows below.
        steps.push(shift_by("0 s"));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        lens::{
            epoch::{linked, moment_after, set_to},
            kind::TimeLens,
        },
        time::Moment,
    };

    fn lens(name: &str, time: Vec<Handled>) -> Lens {
        Lens { time, ..Lens::plain(name, TimeLens::default(), [0.0; 3]) }
    }

    #[test]
    fn a_lens_is_linked_to_those_that_do_not_lead_back() {
        let lenses = [
            lens("a", vec![link_to("b", "0 s")]),
            lens("b", vec![link_to("c", "1 year")]),
            lens("c", Vec::new()),
            lens("d", vec![link_to("d", "0 s")]),
        ];
        assert_eq!(linkable(&lenses, Some(0)), ["b", "c", "d"]);
        assert_eq!(linkable(&lenses, Some(1)), ["c", "d"]);
        assert_eq!(linkable(&lenses, Some(2)), ["d"]);
        assert_eq!(linkable(&lenses, None), ["a", "b", "c", "d"]);
        assert!(names_lens("link", "to") && !names_lens("link", "by") && !names_lens("shift", "to"));
    }

    #[test]
    fn what_was_linked_shows_the_same_when_the_other_lens_is_gone() {
        let year = |year: i64| Moment::of_year(year).expect("a year");
        for delay in ["0 s", "-10 years"] {
            let lenses = [
                lens("then", vec![set_to(year(1650))]),
                lens("after", vec![link_to("then", delay), link_to("other", delay)]),
                lens("other", Vec::new()),
            ];
            let shown = |steps: &[Handled], lenses: &[Lens]| {
                let steps = linked(steps, lenses).expect("links");
                moment_after(&steps, Some(year(1900)), 0.0)
            };
            let mut steps = lenses[1].time.clone();
            replace(&mut steps, "then", &lenses[0].time);
            assert!(steps.iter().all(|step| linked_lens(step) != Some("then")));
            assert_eq!(shown(&steps, &lenses[1..]), shown(&lenses[1].time, &lenses));
            rename(&mut steps, "other", "another");
            assert_eq!(steps.iter().find_map(linked_lens), Some("another"));
        }
    }
}
