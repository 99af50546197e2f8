//! Recipes too long for an 8-bit picture: a comment with their length and checksum replaces them.

use crate::film::Checksum;
use std::borrow::Cow;

/// Longest recipe in a PNG or PPM file, bytes: about 600,000 listed spheres.
pub const RECIPE_LIMIT: usize = 64 << 20;

/// Start of the comment; the length follows.
const BEGIN: &str = "# This picture does not hold its recipe, because that is too long. It has ";

/// The recipe as PNG and PPM files hold it: the text itself or, beyond [`RECIPE_LIMIT`], the comment that replaces it.
/// Different recipes have different comments.
pub fn recipe_in_picture(recipe: &str) -> Cow<'_, str> {
    if recipe.len() <= RECIPE_LIMIT {
        return Cow::Borrowed(recipe);
    }
    let mut sum = Checksum::default();
    sum.text(recipe.as_bytes());
    Cow::Owned(format!("{BEGIN}{} bytes, and its checksum is {}.\n", recipe.len(), sum.finish()))
}

/// Length in bytes of the recipe that this comment replaces; `None` for a recipe.
pub fn length_of_missing(recipe: &str) -> Option<u64> {
    let (length, _) = recipe.strip_prefix(BEGIN)?.split_once(' ')?;
    length.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_recipe_becomes_a_comment_with_its_checksum() {
        let longest = "x".repeat(RECIPE_LIMIT);
        assert!(matches!(recipe_in_picture(&longest), Cow::Borrowed(text) if text == longest));
        assert_eq!(length_of_missing(&longest), None);
        let [one, other] = ["y", "z"].map(|end| recipe_in_picture(&(longest.clone() + end)).into_owned());
        assert_ne!(one, other);
        for comment in [&one, &other] {
            assert_eq!(length_of_missing(comment), Some(RECIPE_LIMIT as u64 + 1), "{comment}");
            assert!(comment.len() < 200 && comment.lines().count() == 1, "{comment}");
        }
    }
}
