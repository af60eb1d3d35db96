//! What somebody may have meant.

/// The known name most like `wrong`, if any is like it at all.
pub fn nearest<'a>(wrong: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let lower = wrong.to_lowercase();
    known
        .into_iter()
        .map(|name| (strsim::jaro_winkler(&lower, &name.to_lowercase()), name))
        // 0.72: `radus` → `radius` (0.96) and `colour` → `color` (0.97) pass, `zoom` → `color` (0.58) does not.
        .filter(|(likeness, _)| *likeness >= 0.72)
        .max_by(|a, b| a.0.total_cmp(&b.0).then_with(|| b.1.cmp(a.1)))
        .map(|(_, name)| name)
}

/// `; did you mean NAME?`, or nothing: to end a message with.
pub fn did_you_mean<'a>(wrong: &str, known: impl IntoIterator<Item = &'a str>) -> String {
    nearest(wrong, known).map_or_else(String::new, |name| format!("; did you mean \"{name}\"?"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slips_are_understood_and_nonsense_is_not() {
        let known = ["radius", "center", "color", "fov_deg"];
        assert_eq!(nearest("raduis", known), Some("radius"));
        assert_eq!(nearest("Centre", known), Some("center"));
        assert_eq!(nearest("colour", known), Some("color"));
        assert_eq!(nearest("fov", known), Some("fov_deg"));
        assert_eq!(nearest("xyzzy", known), None);
        let words =
            ["x-ray", "x-ray-color", "cut-away", "k-buffer", "transparent-box", "discard", "flatten-soft", "edges"];
        for (wrong, right) in [
            ("xray", "x-ray"),
            ("XRay", "x-ray"),
            ("x_ray", "x-ray"),
            ("cutaway", "cut-away"),
            ("cut away", "cut-away"),
            ("kbuffer", "k-buffer"),
            ("edg-es", "edges"),
            ("transparentbox", "transparent-box"),
            ("flattensoft", "flatten-soft"),
            ("xraycolor", "x-ray-color"),
        ] {
            assert_eq!(nearest(wrong, words), Some(right), "{wrong}");
        }
        assert_eq!(did_you_mean("colr", known), "; did you mean \"color\"?");
    }
}
