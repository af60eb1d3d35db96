//! Text: of files in messages, as a terminal, a window and a log may have it; and numbers that stand for it.

/// Characters of a quoted name that messages show.
const NAME: usize = 200;
/// Characters of a line.
const LINE: usize = 1000;

/// FNV-1a of a text, 64 bits: the same everywhere, and no defence against anybody.
pub fn hash(text: &str) -> u64 {
    text.bytes().fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

/// A message of one or more lines, of names from files neither what steers a terminal, nor what turns the order of letters round, nor more
/// than 200 characters in quotes.
pub fn shown(message: &str) -> String {
    cleaned(message, true)
}

/// The same of a message that is one line, whatever the names in it have, and not endless.
pub fn one_line(message: &str) -> String {
    let mut line = cleaned(message.trim_end(), false);
    if let Some((end, _)) = line.char_indices().nth(LINE) {
        line.truncate(end);
        line.push('…');
    }
    line
}

fn cleaned(message: &str, has_lines: bool) -> String {
    let mut shown = String::with_capacity(message.len());
    // How long the name in quotes is, in one.
    let mut quoted: Option<usize> = None;
    for c in message.chars() {
        let ends_line = c == '\n' && has_lines;
        if c == '"' || ends_line {
            quoted = if quoted.is_none() && c == '"' { Some(0) } else { None };
            shown.push(c);
            continue;
        }
        if let Some(length) = &mut quoted {
            *length += 1;
            if *length > NAME {
                if *length == NAME + 1 {
                    shown.push('…');
                }
                continue;
            }
        }
        if steers(c) && c != '\t' {
            shown.extend(c.escape_default());
        } else {
            shown.push(c);
        }
    }
    shown
}

/// Whether a character does something to a terminal, or to what stands around it.
pub fn steers(c: char) -> bool {
    let turns = matches!(c, '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    turns || c.is_control()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_do_nothing_to_a_terminal() {
        assert_eq!(shown("a\tb, \"é 東\" – fine\nnext"), "a\tb, \"é 東\" – fine\nnext");
        assert_eq!(shown("\u{1b}[2J\r\u{7}\u{9b}x\u{202e}"), "\\u{1b}[2J\\r\\u{7}\\u{9b}x\\u{202e}");
        let long = "n".repeat(5000);
        assert_eq!(shown(&format!("no \"{long}\" here")), format!("no \"{}…\" here", &long[..200]));
        // A quote that is not closed ends with its line.
        assert_eq!(shown(&format!("5\" wide\n{long}")).len(), long.len() + 8);
    }

    #[test]
    fn a_line_stays_one() {
        assert_eq!(one_line("no \"a\nb\" here\n"), "no \"a\\nb\" here");
        let long = "n\n".repeat(5000);
        assert_eq!(one_line(&format!("no \"{long}\" here")), format!("no \"{}…\" here", "n\\n".repeat(100)));
    }
}
