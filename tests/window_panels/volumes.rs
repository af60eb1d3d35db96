//! Volumes in their panel: added, and their transfer function drawn.

use veduta::scene::Volume;

use super::*;

fn volume(harness: &Panels) -> Volume {
    harness.state().document.scene().volumes[0].clone()
}

/// The middle of what has this label, and its size.
fn chart(harness: &Panels) -> egui::Rect {
    harness.get_by_label_contains("Transfer function of").rect()
}

#[test]
fn a_volume_is_added_and_its_transfer_function_is_drawn() {
    let mut harness = window();
    click(&mut harness, "Volumes");
    click(&mut harness, "Add one in the middle of the picture");
    assert_eq!(volume(&harness).file, PathBuf::from("builtin:plume"));
    // Around what is seen.
    let (origin, spacing) = (volume(&harness).origin.unwrap(), volume(&harness).spacing.unwrap());
    assert!(spacing.min_element() > 0.0);
    let extent = harness.state().city.as_ref().unwrap().extent;
    assert!(
        extent.min.truncate().cmplt((origin + 64.0 * spacing).truncate()).all()
            && extent.max.truncate().cmpgt(origin.truncate()).all()
    );
    until(&mut harness, "a picture of the volume", |window| {
        window.frame.as_ref().is_some_and(|frame| frame.volumes.len() == 1)
    });
    harness.run_steps(2);
    assert_eq!(volume(&harness).transfer.opacity, [0.0, 0.2]);
    // The point at the highest value goes to the top.
    let at = chart(&harness);
    let bottom = at.top() + 84.0 - 3.5;
    let height = 84.0 - 7.0;
    let right = at.right() - 3.5;
    drag(&mut harness, egui::pos2(right, bottom - 0.2 * height), egui::pos2(right, bottom - 0.8 * height));
    let opacity = volume(&harness).transfer.opacity;
    assert!((opacity[1] - 0.8).abs() < 0.02 && opacity[0] == 0.0, "{opacity:?}");
    // A drag is one edit.
    press(&mut harness, Modifiers::COMMAND, Key::Z);
    assert_eq!(volume(&harness).transfer.opacity, [0.0, 0.2]);
    press(&mut harness, Modifiers::COMMAND, Key::Z);
    assert!(harness.state().document.scene().volumes.is_empty(), "adding it was another");
}
