//! `docs/warnings.md` is what the program does: every code, its definition, and files that cause it.

use std::path::PathBuf;

use veduta::city::{
    WarningCode,
    load::{LoadOptions, Quiet, load},
};

/// A section of the page: code, definition, and its files with their languages.
struct Section {
    code: String,
    text: String,
    files: Vec<(String, String)>,
}

fn sections() -> Vec<Section> {
    let page = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/docs/warnings.md")).unwrap();
    let mut sections: Vec<Section> = Vec::new();
    let mut fence: Option<(String, String)> = None;
    for line in page.lines() {
        if let Some((_, content)) = &mut fence {
            if line == "```" {
                sections.last_mut().unwrap().files.extend(fence.take());
            } else {
                content.push_str(line);
                content.push('\n');
            }
        } else if let Some(language) = line.strip_prefix("```") {
            fence = Some((language.to_owned(), String::new()));
        } else if let Some(code) = line.strip_prefix("## `") {
            let code = code.trim_end_matches('`').to_owned();
            sections.push(Section { code, text: String::new(), files: Vec::new() });
        } else if let Some(section) = sections.last_mut() {
            section.text.push_str(line);
            section.text.push('\n');
        }
    }
    sections
}

#[test]
fn the_page_holds_the_table_in_its_order() {
    let sections = sections();
    let codes: Vec<_> = sections.iter().map(|section| section.code.as_str()).collect();
    let table: Vec<_> = WarningCode::ALL.iter().map(|code| code.code()).collect();
    assert_eq!(codes, table);
    for (section, code) in sections.iter().zip(WarningCode::ALL) {
        assert_eq!(section.text.trim().lines().next(), Some(code.meaning()), "{}", section.code);
    }
}

#[test]
fn every_example_causes_its_warning() {
    let mut wrong = Vec::new();
    for (section, code) in sections().iter().zip(WarningCode::ALL) {
        if *code == WarningCode::AreaMismatch {
            assert!(section.files.is_empty(), "an example is known after all");
            continue;
        }
        let folder = std::env::temp_dir().join(format!("veduta-warnings-{}-{}", std::process::id(), section.code));
        std::fs::create_dir_all(&folder).unwrap();
        let paths: Vec<PathBuf> = section
            .files
            .iter()
            .enumerate()
            .map(|(i, (language, content))| {
                // A cut-off line has no end.
                let content = if section.code == "truncated-file" { content.trim_end() } else { content };
                let path = folder.join(format!("{i}.{language}"));
                std::fs::write(&path, content).unwrap();
                path
            })
            .collect();
        match load(&paths, &LoadOptions::default(), &Quiet) {
            Ok(model) if model.warnings.count(*code) == 0 => {
                wrong.push(format!("{}: {:?}", section.code, model.warnings));
            }
            Ok(_) => {}
            Err(error) => wrong.push(format!("{}: {error}", section.code)),
        }
        std::fs::remove_dir_all(&folder).unwrap();
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
