//! Names that the user may have meant.

/// Maximum number of suggestions.
const OFFERED: usize = 4;

/// Those of `names` that look like `wanted`, most similar first.
pub(crate) fn similar_names(
    wanted: &str,
    names: impl IntoIterator<Item = &'static str>,
) -> Vec<&'static str> {
    let wanted = wanted.to_lowercase();
    let tolerance = 1 + wanted.chars().count() / 3;
    let mut near: Vec<(usize, &'static str)> = names
        .into_iter()
        .filter_map(|name| {
            let is_part = wanted.len() >= 3 && (name.contains(&wanted) || wanted.contains(name));
            let edits = strsim::levenshtein(&wanted, name);
            (is_part || edits <= tolerance).then_some((edits, name))
        })
        .collect();
    near.sort();
    near.into_iter().map(|(_, name)| name).take(OFFERED).collect()
}

/// The end of a message about an unknown name.
pub(crate) fn or_nearest(near: &[&str]) -> String {
    match near {
        [] => "--list shows all".to_owned(),
        near => format!("did you mean {}? --list shows all", near.join(" or ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn typos_and_prefixes_are_recognised() {
        let names = ["glass-refract", "glass-tir", "glass-schlick", "sky", "metal"];
        assert_eq!(similar_names("matal", names), ["metal"]);
        assert_eq!(similar_names("sk", names), ["sky"]);
        assert_eq!(similar_names("glass", names).len(), 3);
        assert_eq!(similar_names("SKY", names), ["sky"]);
        assert!(similar_names("xylophone", names).is_empty());
    }

    #[test]
    fn most_similar_names_come_first() {
        let near = |wanted: &str, names: &[&'static str]| similar_names(wanted, names.iter().copied());
        // Three of six letters may be wrong.
        assert_eq!(near("abcdef", &["abwxyz", "abcxyz", "abcdxf"]), ["abcdxf", "abcxyz"]);
        // Containing the other name counts, however long it is, unless the shared part is too short to be a word.
        assert_eq!(near("abc", &["a song of abc", "abcd"]), ["abcd", "a song of abc"]);
        assert_eq!(near("abcdefghijkl", &["kl", "mn"]), ["kl"]);
        assert_eq!(near("ab", &["a song of ab"]), [""; 0]);
        let many = ["metal6", "metal5", "metal4", "metal3", "metal2"];
        assert_eq!(near("metal", &many), ["metal2", "metal3", "metal4", "metal5"]);
    }

    #[test]
    fn messages_name_similar_names() {
        assert_eq!(or_nearest(&["a", "b"]), "did you mean a or b? --list shows all");
        assert_eq!(or_nearest(&[]), "--list shows all");
    }
}
