//! Looks up attributes in the program's HTML.

pub struct Html<'a> {
    /// The tags, without their brackets and without the content of scripts.
    tags: Vec<&'a str>,
}

impl<'a> Html<'a> {
    pub fn new(text: &'a str) -> Self {
        let mut tags = Vec::new();
        let mut rest = text;
        while let Some(start) = rest.find('<') {
            let Some(end) = rest[start..].find('>') else { break };
            let tag = &rest[start + 1..start + end];
            tags.push(tag);
            rest = &rest[start + end..];
            for element in ["script", "style"] {
                if tag == element || tag.starts_with(&format!("{element} ")) {
                    let close = rest.find(&format!("</{element}>")).unwrap_or(rest.len());
                    rest = &rest[close..];
                }
            }
        }
        Html { tags }
    }

    pub fn values(&self, name: &str) -> Vec<&'a str> {
        let key = format!(" {name}=\"");
        let value = |tag: &&'a str| {
            let start = tag.find(&key)? + key.len();
            Some(&tag[start..start + tag[start..].find('"')?])
        };
        self.tags.iter().filter_map(value).collect()
    }

    pub fn ids(&self) -> Vec<&'a str> {
        self.values("id")
    }
}
