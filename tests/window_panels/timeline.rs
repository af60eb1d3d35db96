//! The timeline: typed, stepped, played and scrubbed.

use veduta::time::Moment;

use super::*;

fn moment(harness: &Panels) -> Option<String> {
    harness.state().document.scene().moment.map(Moment::written)
}

#[test]
fn a_moment_is_typed_stepped_played_and_taken_back() {
    let mut harness = window();
    until_drawn(&mut harness);
    harness.check_accessibility();
    assert_eq!(moment(&harness), None, "all times show at first");
    let typed = |harness: &mut Panels, text: &str| retype(harness, "Moment", text);
    typed(&mut harness, "1650");
    assert_eq!(moment(&harness).as_deref(), Some("1650"));
    click(&mut harness, "Step on in time");
    click(&mut harness, "Step on in time");
    assert_eq!(moment(&harness).as_deref(), Some("1652"), "dates of this city are years");
    click(&mut harness, "Step back in time");
    assert_eq!(moment(&harness).as_deref(), Some("1651"));
    // What is no time is told, and changes nothing.
    typed(&mut harness, "soon");
    assert_eq!(moment(&harness).as_deref(), Some("1651"));
    // Steps in a row are one edit.
    press(&mut harness, Modifiers::COMMAND, Key::Z);
    assert_eq!(moment(&harness).as_deref(), None);
    press(&mut harness, Modifiers::COMMAND.plus(Modifiers::SHIFT), Key::Z);
    assert_eq!(moment(&harness).as_deref(), Some("1651"));
    typed(&mut harness, "");
    assert_eq!(moment(&harness), None);
    click(&mut harness, "Play through time");
    harness.step();
    harness.step();
    assert!(harness.state().timeline.plays);
    assert!(moment(&harness).is_some(), "it begins at the beginning");
    click(&mut harness, "Pause");
    assert!(!harness.state().timeline.plays);
}
