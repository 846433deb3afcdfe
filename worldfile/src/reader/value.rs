//! What the file says, as the type that is asked for.

use super::fault::{Faults, Path};
use super::stand_in::{Judged, StandIn};
use serde::de::value::{Error, SeqAccessDeserializer, SeqDeserializer};
use serde::de::{DeserializeSeed, Deserializer, IntoDeserializer, MapAccess, Visitor};
use serde::forward_to_deserialize_any;
use serde_spanned::Spanned;
use serde_spanned::de::{SpannedDeserializer, is_spanned};
use std::cell::Cell;
use toml::de::{DeFloat, DeInteger, DeTable, DeValue};

/// A value of the file.
#[derive(Clone, Copy)]
pub(super) struct Value<'a> {
    found: &'a Spanned<DeValue<'a>>,
    path: Path<'a>,
    faults: &'a Faults,
}

impl<'a> Value<'a> {
    /// The file as a whole.
    pub(super) fn root(found: &'a Spanned<DeValue<'a>>, faults: &'a Faults) -> Self {
        Self { found, path: Path::Root, faults }
    }

    /// Notes that something else was expected here.
    fn refuse(&self, expected: &str) -> StandIn<'a> {
        self.faults.mistyped(self.path, self.found, expected);
        StandIn { is_needed: &self.faults.ignored }
    }

    fn list(&self, list: &'a [Spanned<DeValue<'a>>]) -> SeqDeserializer<impl Iterator<Item = Self>, Error> {
        let Self { path, faults, .. } = *self;
        SeqDeserializer::new(list.iter().map(move |found| Self { found, path, faults }))
    }
}

impl<'de> Deserializer<'de> for Value<'_> {
    type Error = Error;

    fn deserialize_any<V: Visitor<'de>>(self, _: V) -> Result<V::Value, Error> {
        Err(serde::de::Error::custom("a value of any type cannot be read"))
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        visitor.visit_some(self)
    }

    fn deserialize_bool<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        match self.found.get_ref() {
            DeValue::Boolean(truth) => visitor.visit_bool(*truth),
            _ => self.refuse("`true` or `false`").deserialize_bool(visitor),
        }
    }

    fn deserialize_i64<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        match self.found.get_ref().as_integer().and_then(whole) {
            Some(number) => visitor.visit_i64(number),
            None => self.refuse("a whole number").deserialize_i64(visitor),
        }
    }

    fn deserialize_u32<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        match self.found.get_ref().as_integer().and_then(whole).map(u32::try_from) {
            Some(Ok(number)) => visitor.visit_u32(number),
            _ => self.refuse("a whole number of at least 0").deserialize_u32(visitor),
        }
    }

    fn deserialize_f64<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        let number = match self.found.get_ref() {
            DeValue::Integer(number) => whole(number).map(|number| number as f64),
            DeValue::Float(number) => float(number),
            _ => None,
        };
        match number {
            Some(number) => visitor.visit_f64(number),
            None => self.refuse("a number").deserialize_f64(visitor),
        }
    }

    fn deserialize_string<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        match self.found.get_ref() {
            DeValue::String(text) => visitor.visit_str(text),
            _ => self.refuse("a text in quotes").deserialize_string(visitor),
        }
    }

    fn deserialize_seq<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Error> {
        match self.found.get_ref() {
            DeValue::Array(list) => visitor.visit_seq(self.list(list)),
            _ => self.refuse(&self.path.list()).deserialize_seq(visitor),
        }
    }

    /// Two numbers: the only tuple there is.
    fn deserialize_tuple<V: Visitor<'de>>(self, length: usize, visitor: V) -> Result<V::Value, Error> {
        match self.found.get_ref() {
            DeValue::Array(list) if list.len() == length => visitor.visit_seq(self.list(list)),
            _ => self.refuse("two numbers, as in `[1.0, 2.0]`").deserialize_tuple(length, visitor),
        }
    }

    /// A [`super::OneOrMore`].
    fn deserialize_newtype_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        visitor: V,
    ) -> Result<V::Value, Error> {
        match self.found.get_ref() {
            DeValue::Array(_) => visitor.visit_newtype_struct(self),
            DeValue::Table(_) => {
                let one = self.list(std::slice::from_ref(self.found));
                visitor.visit_newtype_struct(SeqAccessDeserializer::new(one))
            }
            _ => self
                .refuse("a table of keys, or a list of them")
                .deserialize_newtype_struct("OneOrMore", visitor),
        }
    }

    /// A [`super::Sound`]: it is so unless reading it finds something wrong.
    fn deserialize_tuple_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        _: usize,
        visitor: V,
    ) -> Result<V::Value, Error> {
        let before = self.faults.count();
        visitor.visit_seq(Judged { value: Some(self), is_sound: || self.faults.count() == before })
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        name: &'static str,
        fields: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Error> {
        if is_spanned(name) {
            return visitor.visit_map(SpannedDeserializer::new(self, self.found.span()));
        }
        let DeValue::Table(entries) = self.found.get_ref() else {
            return self.refuse("a table of keys").deserialize_struct(name, fields, visitor);
        };
        let unknown = entries.keys().filter(|key| !fields.contains(&key.get_ref().as_ref()));
        let meant = unknown.filter_map(|key| self.faults.unknown(self.path, key, fields)).collect();
        visitor.visit_map(Fields { table: self, entries, meant, fields: fields.iter(), field: "" })
    }

    forward_to_deserialize_any! {
        i8 i16 i32 i128 u8 u16 u64 u128 f32 char str bytes byte_buf unit unit_struct map enum identifier
        ignored_any
    }
}

impl<'de> IntoDeserializer<'de, Error> for Value<'_> {
    type Deserializer = Self;

    fn into_deserializer(self) -> Self {
        self
    }
}

/// The known keys of a table.
struct Fields<'a> {
    table: Value<'a>,
    entries: &'a DeTable<'a>,
    /// Those that an unknown key seems to mean: they are not missing as well.
    meant: Vec<&'static str>,
    fields: std::slice::Iter<'static, &'static str>,
    field: &'static str,
}

impl<'de> MapAccess<'de> for Fields<'_> {
    type Error = Error;

    fn next_key_seed<K: DeserializeSeed<'de>>(&mut self, seed: K) -> Result<Option<K::Value>, Error> {
        let Some(field) = self.fields.next() else { return Ok(None) };
        self.field = field;
        seed.deserialize(self.field.into_deserializer()).map(Some)
    }

    fn next_value_seed<V: DeserializeSeed<'de>>(&mut self, seed: V) -> Result<V::Value, Error> {
        let Value { found: table, path, faults } = self.table;
        if let Some(found) = self.entries.get(self.field) {
            return seed.deserialize(Value { found, path: Path::Key(&path, self.field), faults });
        }
        let is_needed = Cell::new(false);
        let value = seed.deserialize(StandIn { is_needed: &is_needed })?;
        if is_needed.get() && !self.meant.contains(&self.field) {
            faults.missing(path, table.span(), self.field);
        }
        Ok(value)
    }
}

fn whole(number: &DeInteger<'_>) -> Option<i64> {
    i64::from_str_radix(number.as_str(), number.radix()).ok()
}

/// The number, unless it is too large.
fn float(number: &DeFloat<'_>) -> Option<f64> {
    let value: f64 = number.as_str().parse().ok()?;
    (value.is_finite() || !number.as_str().contains(|c: char| c.is_ascii_digit())).then_some(value)
}
