//! The structs of forms in WGSL: their members name the places of a region's rows that they are loaded from, as
//! `center: vec3f,  // a.xyz: metres`. Loaders are written from them.

use std::fmt::Write as _;

use crate::shader::{library::File, wgsl::token::snake};

/// A member of such a struct.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Member<'a> {
    kind: &'a str,
    /// Places in the rows, one after another.
    places: Vec<&'a str>,
}

/// The struct of a form.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Rows<'a> {
    name: &'a str,
    /// Its declaration.
    text: &'a str,
    members: Vec<Member<'a>>,
}

impl<'a> Rows<'a> {
    /// The struct of this name in a file.
    ///
    /// # Panics
    /// Where there is none, or a member names no place: as a hook that is not filled.
    pub(super) fn of(file: &File, name: &'a str) -> Self {
        Self::found(file.text, name).unwrap_or_else(|problem| panic!("shaders/{}: struct {name}: {problem}", file.path))
    }

    fn found(text: &'static str, name: &'a str) -> Result<Self, String> {
        let head = format!("struct {name} {{\n");
        let start = text.find(&head).ok_or("there is none")?;
        let end = start + text[start..].find("\n}\n").ok_or("it does not end")? + "\n}\n".len();
        let lines = text[start + head.len()..end - "\n}\n".len()].lines();
        let members = lines.map(member).collect::<Result<_, _>>()?;
        Ok(Self { name, text: &text[start..end], members })
    }

    /// Its declaration.
    pub(super) fn declaration(&self) -> String {
        format!("{}\n", self.text)
    }

    /// The name of the function that loads it.
    pub(super) fn loader_name(&self) -> String {
        snake(self.name) + "_of"
    }

    /// The function that loads it.
    pub(super) fn loader(&self) -> String {
        let values: Vec<String> = self.members.iter().map(Member::loaded).collect();
        let (loader, name) = (self.loader_name(), self.name);
        format!("fn {loader}(rows: Region) -> {name} {{\n    return {name}({});\n}}\n\n", values.join(", "))
    }

    /// The places that it reads, each once, and how many numbers that is.
    pub(super) fn places(&self) -> Vec<(&'a str, usize)> {
        let mut out: Vec<(&str, usize)> = Vec::new();
        for place in self.members.iter().flat_map(|member| &member.places) {
            if !out.iter().any(|(own, _)| own == place) {
                out.push((place, place.len() - 2));
            }
        }
        out
    }
}

/// A line: `name: kind,  // place place: text`.
fn member(line: &'static str) -> Result<Member<'static>, String> {
    let wrong = || format!("no `name: type,  // place: text`: {line}");
    let (declared, comment) = line.split_once("//").ok_or_else(wrong)?;
    let kind = declared.split_once(':').ok_or_else(wrong)?.1.trim().trim_end_matches(',');
    let places: Vec<&str> = comment.split(':').next().unwrap_or_default().split_whitespace().collect();
    match !places.is_empty() && places.iter().all(|place| is_place(place)) {
        true => Ok(Member { kind, places }),
        false => Err(wrong()),
    }
}

/// `a.xyz`, `b.w`: neighbours of a row; the first has three numbers.
fn is_place(place: &str) -> bool {
    match place.split_once('.') {
        Some(("a", numbers)) => "xyz".contains(numbers) && !numbers.is_empty(),
        Some(("b" | "c" | "d", numbers)) => "xyzw".contains(numbers) && !numbers.is_empty(),
        _ => false,
    }
}

impl Member<'_> {
    fn loaded(&self) -> String {
        let mut all = String::new();
        for (i, place) in self.places.iter().enumerate() {
            let _ = write!(all, "{}rows.{place}", if i == 0 { "" } else { ", " });
        }
        let is_whole = self.places.len() == 1 && self.kind != "u32";
        if is_whole { all } else { format!("{}({all})", self.kind) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn structs_are_loaded_from_the_places_that_their_members_name() {
        const TEXT: &str = "// A.\n\nstruct Two {\n    a: vec3f,   // a.xyz: metres\n    b: vec2f,   // b.w c.w\n    c: u32,     // b.w: first\n}\n";
        let rows = Rows::found(TEXT, "Two").expect("sound");
        assert_eq!(
            rows.loader(),
            "fn two_of(rows: Region) -> Two {\n    return Two(rows.a.xyz, vec2f(rows.b.w, rows.c.w), u32(rows.b.w));\n}\n\n"
        );
        assert_eq!(rows.places(), [("a.xyz", 3), ("b.w", 1), ("c.w", 1)]);
        assert!(Rows::found(TEXT, "One").is_err());
        for wrong in ["    a: f32,", "    a: f32,  // metres", "    a: f32,  // a.w: metres", "    a: f32,  // e.x"] {
            assert!(member(wrong).is_err(), "{wrong}");
        }
    }
}
