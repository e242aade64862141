//! The form of a value: what a node of the JSON Schema requires of it.

use serde_json::Value;

/// The form that the value of a key must have.
#[derive(Clone, Copy)]
pub(crate) struct Form<'s> {
    root: &'s Value,
    /// The node at the key, with the description and the example of the key.
    site: &'s Value,
    /// The node itself, or the type that it refers to.
    node: &'s Value,
}

/// What a form requires.
pub(crate) enum Kind<'s> {
    Number,
    /// An integer, of at least 0 if so stated.
    Integer {
        is_unsigned: bool,
    },
    Text,
    /// One of the words of an enumeration.
    Word(Vec<&'s str>),
    /// A list of values of one form, of a length or of any.
    List(Form<'s>, Option<usize>),
    Table,
    /// One of several forms.
    OneOf(Vec<Form<'s>>),
}

impl<'s> Form<'s> {
    /// The form of a document with this schema.
    pub(crate) fn of_document(schema: &'s Value) -> Form<'s> {
        Form { root: schema, site: schema, node: schema }
    }

    fn at(self, site: &'s Value) -> Form<'s> {
        let refers_to = site["$ref"].as_str().and_then(|path| self.root.pointer(path.trim_start_matches('#')));
        Form { site, node: refers_to.unwrap_or(site), ..self }
    }

    pub(crate) fn kind(self) -> Kind<'s> {
        let node = self.node;
        if let Some(choices) = node["anyOf"].as_array() {
            let all = choices.iter().flat_map(|choice| match self.at(choice).kind() {
                Kind::OneOf(inner) => inner,
                _ => vec![self.at(choice)],
            });
            return Kind::OneOf(all.collect());
        }
        let words: Vec<&str> = match (node["oneOf"].as_array(), node["enum"].as_array()) {
            (Some(choices), _) => choices.iter().filter_map(|choice| choice["const"].as_str()).collect(),
            (_, Some(words)) => words.iter().filter_map(Value::as_str).collect(),
            _ => Vec::new(),
        };
        match node["type"].as_str() {
            _ if !words.is_empty() => Kind::Word(words),
            Some("number") => Kind::Number,
            Some("integer") => Kind::Integer { is_unsigned: node["minimum"] == 0 },
            Some("array") => Kind::List(self.at(&node["items"]), node["maxItems"].as_u64().map(|n| n as usize)),
            Some("object") => Kind::Table,
            _ => Kind::Text,
        }
    }

    /// The form of a key of a table. `None` if the table has no such key.
    pub(crate) fn property(self, key: &str) -> Option<Form<'s>> {
        let any = Some(&self.node["additionalProperties"]).filter(|node| node.is_object());
        self.node["properties"].get(key).or(any).map(|site| self.at(site))
    }

    /// The keys of a table, in alphabetical order.
    pub(crate) fn keys(self) -> Vec<&'s str> {
        self.node["properties"].as_object().into_iter().flatten().map(|(key, _)| key.as_str()).collect()
    }

    /// The keys that a table must have, in the order of its type.
    pub(crate) fn required(self) -> impl Iterator<Item = &'s str> {
        self.node["required"].as_array().into_iter().flatten().filter_map(Value::as_str)
    }

    /// Whether a table must have keys, whichever they are.
    pub(crate) fn must_have_keys(self) -> bool {
        [self.site, self.node].iter().any(|node| node["minProperties"].is_number())
    }

    /// What the key is, in a sentence.
    pub(crate) fn description(self) -> Option<&'s str> {
        self.text("description")
    }

    /// A value as it stands in a file.
    pub(crate) fn example(self) -> Option<&'s str> {
        self.text("example")
    }

    fn text(self, property: &str) -> Option<&'s str> {
        self.site[property].as_str().or(self.node[property].as_str())
    }
}
