//! Time lenses in their panel: steps, links, and what is wrong with them.

use veduta::{
    lens::{Handled, Parameter, links::link_to},
    time::Moment,
};

use super::*;

fn time(harness: &Panels, lens: usize) -> Vec<Handled> {
    harness.state().document.scene().lenses[lens].time.clone()
}

fn step(op: &str, parameters: &[(&str, &str)]) -> Handled {
    let text = |(key, text): &(&str, &str)| ((*key).to_owned(), Parameter::Text((*text).to_owned()));
    Handled { handler: op.to_owned(), parameters: parameters.iter().map(text).collect() }
}

/// Chooses one of a menu that a button opens.
fn choose(harness: &mut Panels, menu: &str, entry: &str) {
    click(harness, menu);
    let all: Vec<_> = harness.query_all_by_label(entry).collect();
    all.last().unwrap_or_else(|| panic!("\"{menu}\" has no \"{entry}\"")).click();
    harness.run_steps(3);
}

fn undo(harness: &mut Panels) {
    press(harness, Modifiers::COMMAND, Key::Z);
}

#[test]
fn steps_of_a_time_lens_are_typed_added_moved_and_taken_away() {
    let mut harness = window();
    press(&mut harness, Modifiers::NONE, Key::Y);
    assert_eq!(time(&harness, 0), [step("set", &[("at", "1900")])]);
    retype(&mut harness, "At", "1650");
    let first = step("set", &[("at", "1650")]);
    assert_eq!(time(&harness, 0), std::slice::from_ref(&first));
    // What is no time is told while it is typed, and changes nothing.
    retype(&mut harness, "At", "16x0");
    assert!(harness.query_all_by_label_contains("\"16x0\" is no time").count() > 0);
    assert_eq!(time(&harness, 0), std::slice::from_ref(&first));
    retype(&mut harness, "At", "1650");
    assert_eq!(harness.query_all_by_label_contains("is no time").count(), 0);
    harness.check_accessibility();
    choose(&mut harness, "Add time step", "ghost");
    let ghost = step("ghost", &[]);
    assert_eq!(time(&harness, 0), [first.clone(), ghost.clone()]);
    retype(&mut harness, "Past", "50 years");
    let ghost_of_past = step("ghost", &[("past", "50 years")]);
    assert_eq!(time(&harness, 0), [first.clone(), ghost_of_past.clone()]);
    click(&mut harness, "Move time step 2 up");
    assert_eq!(time(&harness, 0), [ghost_of_past.clone(), first.clone()]);
    click(&mut harness, "Take time step 1 away");
    assert_eq!(time(&harness, 0), std::slice::from_ref(&first));
    // The last one of a time lens stays, and it is said why.
    click(&mut harness, "Take time step 1 away");
    assert_eq!(time(&harness, 0), std::slice::from_ref(&first));
    assert!(harness.query_all_by_label_contains("time: ").count() > 0);
    // Each of these was one edit.
    undo(&mut harness);
    assert_eq!(time(&harness, 0), [ghost_of_past.clone(), first.clone()]);
    undo(&mut harness);
    undo(&mut harness);
    assert_eq!(time(&harness, 0), [first.clone(), ghost]);
    undo(&mut harness);
    undo(&mut harness);
    assert_eq!(time(&harness, 0), [step("set", &[("at", "1900")])]);
    // Another operator in its place keeps what fits.
    click(&mut harness, "Time");
    harness.query_all_by_label("aggregate").last().expect("it is offered").click();
    harness.run_steps(3);
    let several = |texts: &[&str]| Parameter::Texts(texts.iter().map(|text| (*text).to_owned()).collect());
    assert_eq!(time(&harness, 0)[0].parameters.get("at"), Some(&several(&["0 s", "-50 years"])));
    retype(&mut harness, "At", "1650, 1750");
    assert_eq!(time(&harness, 0)[0].parameters.get("at"), Some(&several(&["1650", "1750"])));
}

#[test]
fn a_lens_is_linked_to_another_renamed_and_outlives_it() {
    let mut harness = window();
    press(&mut harness, Modifiers::NONE, Key::Y);
    retype(&mut harness, "At", "1650");
    press(&mut harness, Modifiers::NONE, Key::Y);
    choose(&mut harness, "Link to…", "time");
    assert_eq!(time(&harness, 1), [link_to("time", "0 s")]);
    retype(&mut harness, "By", "-10 years");
    assert_eq!(time(&harness, 1), [link_to("time", "-10 years")]);
    // It is renamed in the list; the link follows, in one edit.
    harness.state_mut().chosen.lens = Some(0);
    press(&mut harness, Modifiers::NONE, Key::F2);
    retype(&mut harness, "Name of the lens", "then");
    assert_eq!(time(&harness, 1), [link_to("then", "-10 years")]);
    undo(&mut harness);
    assert_eq!(time(&harness, 1), [link_to("time", "-10 years")]);
    assert_eq!(harness.state().document.scene().lenses[0].name, "time");
    // It goes; what the other one shows stays.
    press(&mut harness, Modifiers::NONE, Key::Delete);
    assert_eq!(time(&harness, 0), [step("set", &[("at", "1650")]), step("shift", &[("by", "-10 years")])]);
    assert!(harness.query_all_by_label_contains("Linked to it was time 2").count() > 0);
    undo(&mut harness);
    assert_eq!(time(&harness, 1), [link_to("time", "-10 years")]);
    until_drawn(&mut harness);
}

#[test]
fn the_whole_scene_has_steps_of_time() {
    let mut harness = window();
    harness.state_mut().document.edit("a moment", |scene| scene.moment = Moment::of_year(1900));
    click(&mut harness, "More of the scene");
    click(&mut harness, "Time");
    choose(&mut harness, "Add time step", "shift");
    let steps = |harness: &Panels| harness.state().document.scene().time_steps.clone();
    assert_eq!(steps(&harness), [step("shift", &[("by", "-10 years")])]);
    assert_eq!(harness.state().document.scene().shown_moment(), Moment::of_year(1890));
    click(&mut harness, "Take time step 1 away");
    assert_eq!(steps(&harness), []);
    undo(&mut harness);
    undo(&mut harness);
    assert_eq!(steps(&harness), []);
    assert_eq!(harness.state().document.scene().moment, Moment::of_year(1900));
}
