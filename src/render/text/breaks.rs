//! Where a line may end: at blanks, and between the characters of scripts that are written without any.

use swash::text::{analyze, cluster::Boundary};

/// Whether a character is Chinese or Japanese, or a sign of their full width: a line may end beside it. Korean has blanks.
fn is_unspaced(c: char) -> bool {
    matches!(c, '\u{2e80}'..='\u{3130}' | '\u{3190}'..='\u{9fff}' | '\u{f900}'..='\u{faff}' | '\u{fe30}'..='\u{fe4f}' |
        '\u{ff00}'..='\u{ff9f}' | '\u{20000}'..='\u{3ffff}')
}

/// What has more characters is no word.
const LONGEST: usize = 24;

/// A word in the pieces between which a line may end (UAX #14): beside Chinese and Japanese characters, but not before what closes
/// (、 。 」 and small kana) nor after what opens. Ids and the like, longer than words are, may end after the signs between their parts.
pub fn pieces(word: &str) -> Vec<&str> {
    if !word.chars().any(is_unspaced) {
        let is_long = word.chars().count() > LONGEST;
        return if is_long { word.split_inclusive(['-', '_', '.', '/']).collect() } else { vec![word] };
    }
    let mut found = Vec::new();
    let (mut start, mut last) = (0, None);
    for ((at, c), (_, boundary)) in word.char_indices().zip(analyze(word.chars())) {
        let is_beside = is_unspaced(c) || last.is_some_and(is_unspaced);
        if at > start && boundary >= Boundary::Line && is_beside {
            found.push(&word[start..at]);
            start = at;
        }
        last = Some(c);
    }
    found.push(&word[start..]);
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_with_blanks_are_whole() {
        for word in ["Rotterdam", "well-known", "a/b", "도시의", "", "½—¾"] {
            assert_eq!(pieces(word), [word]);
        }
    }

    #[test]
    fn ids_end_between_their_parts() {
        let id = "NL.IMBAG.Pand.0503100000031316";
        assert_eq!(pieces(id), ["NL.", "IMBAG.", "Pand.", "0503100000031316"]);
        assert_eq!(pieces("GUID_8AEB4C1E-0B4C-4A0F"), ["GUID_8AEB4C1E-0B4C-4A0F"], "no longer than a word");
        assert_eq!(pieces("GUID_8AEB4C1E-0B4C-4A0F-9").len(), 5);
    }

    #[test]
    fn lines_end_between_characters_but_not_before_what_closes() {
        assert_eq!(pieces("城市视图"), ["城", "市", "视", "图"]);
        assert_eq!(pieces("「東京」、築。"), ["「東", "京」、", "築。"]);
        assert_eq!(pieces("年（年）"), ["年", "（年）"]);
        // Small kana and the sign of long vowels stay with what they belong to.
        assert_eq!(pieces("カッター"), ["カッ", "ター"]);
        assert_eq!(pieces("LoD2の街"), ["LoD2", "の", "街"]);
        // The mark of a letter written in two.
        assert_eq!(pieces("か\u{3099}き"), ["か\u{3099}", "き"]);
    }
}
