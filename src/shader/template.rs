//! WGSL texts with named places, *hooks*, that are filled by name.
//!
//! In a text a hook is a comment, so the text stays WGSL:
//!
//! ```wgsl
//!     //@name             a line of its own: the filling takes the place of the line, its indent and its line break
//! @fragment //@name       the end of a line: the place of the comment and of the blanks before it
//! f(a/*@name*/)           within a line: the place of the comment
//! ```
//!
//! A name that stands at several places of a template is one hook, with one filling. Nothing is passed over: a hook that is not there,
//! that is filled twice or not at all, and a comment that begins like a hook and is none, are errors with the file and the name.
//! Hooks are found before anything is filled in, so a filling (a user's effect, the name of a lens) never has any.

use std::borrow::Cow;

use crate::shader::library::File;

/// A mistake in the filling of a template.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("shaders/{file}: hook `{hook}` {problem}")]
pub(super) struct HookError {
    /// The file with the hook, below `shaders`; all of the template, where none has it.
    pub(super) file: String,
    /// Its name.
    pub(super) hook: String,
    /// The mistake.
    pub(super) problem: HookProblem,
}

/// Mistakes with hooks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub(super) enum HookProblem {
    /// It is filled where there is none.
    #[error("is not there")]
    Absent,
    /// It has a filling already.
    #[error("is filled twice")]
    Twice,
    /// The text is finished without a filling for it.
    #[error("is not filled")]
    Unfilled,
    /// The text behind the mark is no name, or has no end.
    #[error("is no name of a-z, 0-9 and -, alone at the end of its line or in /*@ */")]
    Malformed,
}

/// A text with hooks, some of which are filled.
#[derive(Clone, Debug, Default)]
pub(super) struct Template<'a> {
    pieces: Vec<Piece<'a>>,
    /// The first mistake.
    error: Option<HookError>,
}

#[derive(Clone, Debug)]
enum Piece<'a> {
    Text(Cow<'a, str>),
    Hook { file: &'a str, name: &'a str, filling: Option<String> },
}

const LINE_MARK: &str = "//@";
const INNER_MARK: &str = "/*@";
const INNER_END: &str = "*/";

impl<'a> Template<'a> {
    /// Files one behind the other, each below a comment with its path.
    pub(super) fn of_files(files: &[File]) -> Self {
        files.iter().fold(Self::default(), |all, file| all.then(Self::below_path(file.path, file.text)))
    }

    /// A text below a comment with the path of its file.
    pub(super) fn below_path(path: &'a str, text: &'a str) -> Self {
        let mut all = Self::default();
        all.pieces.push(Piece::Text(format!("// ==== {path}\n\n").into()));
        all.find_hooks(path, text);
        all.pieces.push(Piece::Text("\n".into()));
        all
    }

    /// Any text; `file` is what mistakes name.
    #[cfg(test)]
    pub(super) fn of_text(file: &'a str, text: &'a str) -> Self {
        let mut all = Self::default();
        all.find_hooks(file, text);
        all
    }

    /// With the text of another template behind it.
    pub(super) fn then(mut self, other: Self) -> Self {
        self.pieces.extend(other.pieces);
        self.error = self.error.or(other.error);
        self
    }

    /// Fills a hook wherever it stands.
    pub(super) fn fill(mut self, hook: &str, text: impl Into<String>) -> Self {
        let text = text.into();
        let (mut found, mut twice) = (false, None);
        for piece in &mut self.pieces {
            match piece {
                Piece::Hook { file, name, filling } if *name == hook => {
                    found = true;
                    twice = twice.or(filling.is_some().then_some(*file));
                    *filling = Some(text.clone());
                }
                _ => {}
            }
        }
        match (found, twice) {
            (true, None) => {}
            (true, Some(file)) => self.note(file, hook, HookProblem::Twice),
            (false, _) => self.note(&self.files(), hook, HookProblem::Absent),
        }
        self
    }

    /// Fills a hook with nothing.
    pub(super) fn leave(self, hook: &str) -> Self {
        self.fill(hook, "")
    }

    /// The whole text.
    ///
    /// # Errors
    /// The first mistake; a hook without a filling is one.
    pub(super) fn finished(self) -> Result<String, HookError> {
        let mut text = String::new();
        let mut error = self.error;
        for piece in &self.pieces {
            match piece {
                Piece::Text(own) => text.push_str(own),
                Piece::Hook { filling: Some(own), .. } => text.push_str(own),
                Piece::Hook { file, name, filling: None } => {
                    error = error.or_else(|| Some(HookError::new(file, name, HookProblem::Unfilled)));
                }
            }
        }
        error.map_or(Ok(text), Err)
    }

    /// The whole text.
    ///
    /// # Panics
    /// On any mistake, in every build. Which hooks are filled depends on the kind of module alone, never on a scene or on a user's file,
    /// so a mistake is one of the program, and the tests that put each kind of module together meet it. A text with a gap is worse at run
    /// time than a panic: it may well be valid and draw something else.
    pub(super) fn text(self) -> String {
        self.finished().unwrap_or_else(|error| panic!("{error}"))
    }

    /// The names of its hooks, each once.
    #[cfg(test)]
    pub(super) fn hooks(&self) -> Vec<String> {
        let mut names: Vec<String> = Vec::new();
        for piece in &self.pieces {
            if let Piece::Hook { name, .. } = piece
                && !names.iter().any(|known| known == name)
            {
                names.push((*name).to_owned());
            }
        }
        names
    }

    /// Notes a mistake, unless there is an earlier one.
    fn note(&mut self, file: &str, hook: &str, problem: HookProblem) {
        self.error.get_or_insert_with(|| HookError::new(file, hook, problem));
    }

    /// The files that have hooks, each once.
    fn files(&self) -> String {
        let mut files: Vec<&str> = Vec::new();
        for piece in &self.pieces {
            if let Piece::Hook { file, .. } = piece
                && !files.contains(file)
            {
                files.push(file);
            }
        }
        files.join(", ")
    }

    /// Appends a text and its hooks.
    fn find_hooks(&mut self, file: &'a str, text: &'a str) {
        let (mut rest, mut is_at_start) = (text, true);
        while let Some(at) = next_mark(rest) {
            let before = &rest[..at];
            let (end, body, is_inner) = match rest[at..].strip_prefix(INNER_MARK) {
                Some(body) => (body.find(INNER_END), body, true),
                None => (
                    Some(rest[at..].find('\n').map_or(rest.len() - at, |n| n) - LINE_MARK.len()),
                    &rest[at + LINE_MARK.len()..],
                    false,
                ),
            };
            let name = end.map_or(body, |end| &body[..end]);
            if end.is_none() || !is_name(name) {
                self.note(file, name.lines().next().unwrap_or(""), HookProblem::Malformed);
            }
            let after = &body[name.len()..];
            let indent = before.trim_end_matches([' ', '\t']);
            let is_line = !is_inner && (indent.ends_with('\n') || (indent.is_empty() && is_at_start));
            let (text, next) = match (is_inner, is_line) {
                (true, _) => (before, after.strip_prefix(INNER_END).unwrap_or("")),
                (false, true) => (indent, after.strip_prefix('\n').unwrap_or("")),
                (false, false) => (indent, after),
            };
            is_at_start = is_line;
            self.pieces.push(Piece::Text(text.into()));
            self.pieces.push(Piece::Hook { file, name, filling: None });
            rest = next;
        }
        self.pieces.push(Piece::Text(rest.into()));
    }
}

impl HookError {
    fn new(file: &str, hook: &str, problem: HookProblem) -> Self {
        Self { file: file.to_owned(), hook: hook.to_owned(), problem }
    }
}

/// Where the next hook begins.
fn next_mark(text: &str) -> Option<usize> {
    [LINE_MARK, INNER_MARK].into_iter().filter_map(|mark| text.find(mark)).min()
}

fn is_name(text: &str) -> bool {
    text.starts_with(|c: char| c.is_ascii_lowercase())
        && text.bytes().all(|b| b.is_ascii_lowercase() || b.is_ascii_digit() || b == b'-')
}

#[cfg(test)]
mod tests {
    use super::*;

    fn template(text: &str) -> Template<'_> {
        Template::of_text("lib/a.wgsl", text)
    }

    fn problem(template: Template) -> (String, HookProblem) {
        let error = template.finished().expect_err("a mistake");
        assert_eq!(error.file, "lib/a.wgsl");
        (error.hook, error.problem)
    }

    #[test]
    fn fillings_take_the_place_of_lines_ends_of_lines_and_comments() {
        let text = "//@first\nfn f(/*@in*/) {  //@end\n    //@line\n}\n    //@line";
        let filled =
            template(text).fill("first", "A\n").fill("in", "x: f32").fill("end", " // E").fill("line", "    L;\n");
        assert_eq!(filled.finished().as_deref(), Ok("A\nfn f(x: f32) { // E\n    L;\n}\n    L;\n"));
        let left = ["first", "in", "end", "line"].into_iter().fold(template(text), Template::leave);
        assert_eq!(left.finished().as_deref(), Ok("fn f() {\n}\n"));
        assert_eq!(template("// none\n/* none */").finished().as_deref(), Ok("// none\n/* none */"));
    }

    #[test]
    fn no_mistake_is_passed_over() {
        let text = "//@one\nf(/*@two*/);\n";
        assert_eq!(problem(template(text).leave("one")), ("two".to_owned(), HookProblem::Unfilled));
        assert_eq!(
            problem(template(text).leave("one").leave("two").leave("one")),
            ("one".to_owned(), HookProblem::Twice)
        );
        assert_eq!(problem(template(text).leave("three")), ("three".to_owned(), HookProblem::Absent));
        for wrong in ["//@ one\n", "//@One\n", "//@one two\n", "/*@one", "/*@*/", "//@"] {
            assert_eq!(problem(template(wrong)).1, HookProblem::Malformed, "{wrong}");
        }
        let message = template(text).leave("three").finished().expect_err("a mistake").to_string();
        assert_eq!(message, "shaders/lib/a.wgsl: hook `three` is not there");
    }

    #[test]
    fn a_filling_has_no_hooks() {
        let filled = template("//@one\n//@two\n").fill("one", "//@two\n").fill("two", "2\n");
        assert_eq!(filled.finished().as_deref(), Ok("//@two\n2\n"));
    }
}
