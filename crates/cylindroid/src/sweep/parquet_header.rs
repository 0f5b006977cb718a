//! The headers of a Parquet file, before its reader sees them: no list is longer than its
//! header, nor all lists of truth values together.
//!
//! Formula  compact protocol of Thrift: a field is a byte (difference of its number to that of the field
//!          before, kind), its number if the difference is zero, and its value; a list is a byte (size or
//!          15, kind of its entries), its size if it was 15, and its entries
//! Valid    fields that Parquet defines have its kinds: its reader reads them as such whatever they say.
//!          Other fields are passed over. Whatever else is wrong with a header, the reader says
//! Why so   Parquet's reader passes over the entries of a list one by one, and truth values have no
//!          bytes: 2^31 of them took seconds (apache/arrow-rs#9874)
//! Source   apache/thrift doc/specs/thrift-compact-protocol.md; apache/parquet-format parquet.thrift
//! Checked  tests/sweep/parquet_forms.rs::lists_longer_than_the_file_are_refused

/// The kinds of values, by what they take in a file.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    Flag,
    Byte,
    /// Of 16, 32 or 64 bits.
    Int,
    Double,
    Binary,
    /// Or a set.
    List,
    Map,
    Struct,
    Uuid,
}

impl Kind {
    fn of(code: u8) -> Option<Self> {
        Some(match code {
            1 | 2 => Self::Flag,
            3 => Self::Byte,
            4..=6 => Self::Int,
            7 => Self::Double,
            8 => Self::Binary,
            9 | 10 => Self::List,
            11 => Self::Map,
            12 => Self::Struct,
            13 => Self::Uuid,
            _ => return None,
        })
    }
}

/// The fields of a struct that Parquet defines: number, kind, and the struct that it or its entries are.
type Fields = &'static [(i64, Kind, Inner)];
/// None of other values, and of structs without fields.
type Inner = Option<&'static Struct>;
/// A struct or union.
struct Struct(Fields);

const fn int(field: i64) -> (i64, Kind, Inner) {
    (field, Kind::Int, None)
}

const fn binary(field: i64) -> (i64, Kind, Inner) {
    (field, Kind::Binary, None)
}

const fn flag(field: i64) -> (i64, Kind, Inner) {
    (field, Kind::Flag, None)
}

const fn list(field: i64, of: Inner) -> (i64, Kind, Inner) {
    (field, Kind::List, of)
}

const fn of(field: i64, inner: Inner) -> (i64, Kind, Inner) {
    (field, Kind::Struct, inner)
}

const fn double(field: i64) -> (i64, Kind, Inner) {
    (field, Kind::Double, None)
}

static FILE: Struct = Struct(&[
    int(1),
    list(2, Some(&SCHEMA_ELEMENT)),
    int(3),
    list(4, Some(&ROW_GROUP)),
    list(5, Some(&KEY_VALUE)),
    binary(6),
    list(7, Some(&COLUMN_ORDER)),
]);
static SCHEMA_ELEMENT: Struct = Struct(&[
    int(1),
    int(2),
    int(3),
    binary(4),
    int(5),
    int(6),
    int(7),
    int(8),
    int(9),
    of(10, Some(&LOGICAL_TYPE)),
]);
static LOGICAL_TYPE: Struct = Struct(&[
    of(1, None),
    of(2, None),
    of(3, None),
    of(4, None),
    of(5, Some(&Struct(&[int(1), int(2)]))),
    of(6, None),
    of(7, Some(&TIME)),
    of(8, Some(&TIME)),
    of(10, Some(&Struct(&[(1, Kind::Byte, None), flag(2)]))),
    of(11, None),
    of(12, None),
    of(13, None),
    of(14, None),
    of(15, None),
    of(16, Some(&Struct(&[(1, Kind::Byte, None)]))),
    of(17, Some(&Struct(&[binary(1)]))),
    of(18, Some(&Struct(&[binary(1), int(2)]))),
    of(19, None),
]);
static TIME: Struct =
    Struct(&[flag(1), of(2, Some(&Struct(&[of(1, None), of(2, None), of(3, None)])))]);
static KEY_VALUE: Struct = Struct(&[binary(1), binary(2)]);
static COLUMN_ORDER: Struct = Struct(&[of(1, None), of(2, None)]);
static ROW_GROUP: Struct = Struct(&[
    list(1, Some(&COLUMN_CHUNK)),
    int(2),
    int(3),
    list(4, Some(&Struct(&[int(1), flag(2), flag(3)]))),
    int(5),
    int(6),
    int(7),
]);
static COLUMN_CHUNK: Struct =
    Struct(&[binary(1), int(2), of(3, Some(&COLUMN)), int(4), int(5), int(6), int(7)]);
static COLUMN: Struct = Struct(&[
    int(1),
    list(2, None),
    list(3, None),
    int(4),
    int(5),
    int(6),
    int(7),
    list(8, Some(&KEY_VALUE)),
    int(9),
    int(10),
    int(11),
    of(12, Some(&STATISTICS)),
    list(13, Some(&Struct(&[int(1), int(2), int(3)]))),
    int(14),
    int(15),
    of(16, Some(&Struct(&[int(1), list(2, None), list(3, None)]))),
    of(17, Some(&Struct(&[of(1, Some(&BOX)), list(2, None)]))),
]);
static STATISTICS: Struct =
    Struct(&[binary(1), binary(2), int(3), int(4), binary(5), binary(6), flag(7), flag(8), int(9)]);
static BOX: Struct = Struct(&[
    double(1),
    double(2),
    double(3),
    double(4),
    double(5),
    double(6),
    double(7),
    double(8),
]);
static PAGE: Struct = Struct(&[
    int(1),
    int(2),
    int(3),
    int(4),
    of(5, Some(&Struct(&[int(1), int(2), int(3), int(4), of(5, Some(&STATISTICS))]))),
    of(6, None),
    of(7, Some(&Struct(&[int(1), int(2), flag(3)]))),
    of(8, Some(&PAGE_V2)),
]);
static PAGE_V2: Struct =
    Struct(&[int(1), int(2), int(3), int(4), int(5), int(6), flag(7), of(8, Some(&STATISTICS))]);

/// Structs in structs, and lists in lists, at most: as in Parquet's reader.
const DEEPEST: u32 = 64;

/// Why Parquet's reader shall not see a header.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Flaw {
    /// It ends within, or is not in the protocol: the reader says so itself.
    Unreadable,
    LongList,
    WrongKind,
}

impl Flaw {
    /// The end of a sentence that begins with the header.
    const fn message(self) -> &'static str {
        match self {
            Self::Unreadable => "cannot be read",
            Self::LongList => "announces a list that is longer than the header",
            Self::WrongKind => "has a field of another kind than Parquet defines",
        }
    }
}

/// Checks what a file says about itself at its end.
///
/// # Errors
/// A list that is longer than the rest, a field of the wrong kind.
pub(super) fn check_footer(bytes: &[u8]) -> Result<(), &'static str> {
    match Walk::of(bytes).fields(Some(&FILE), DEEPEST) {
        Ok(()) | Err(Flaw::Unreadable) => Ok(()),
        Err(flaw) => Err(flaw.message()),
    }
}

/// The same of the header of a page, which begins these bytes; `is_all` if the file ends with them.
///
/// # Errors
/// Also a header that does not end in these bytes, if the file does not either.
pub(super) fn check_page(bytes: &[u8], is_all: bool) -> Result<(), &'static str> {
    let mut walk = Walk::of(bytes);
    match walk.fields(Some(&PAGE), DEEPEST) {
        Ok(()) => Ok(()),
        Err(Flaw::Unreadable) if is_all || !walk.rest.is_empty() => Ok(()),
        Err(flaw) => Err(flaw.message()),
    }
}

/// A way through a header.
struct Walk<'a> {
    rest: &'a [u8],
    /// Truth values in lists that may come, all together.
    truth_values: u64,
}

impl<'a> Walk<'a> {
    fn of(bytes: &'a [u8]) -> Self {
        Self { rest: bytes, truth_values: bytes.len() as u64 }
    }

    fn pass(&mut self, count: u64) -> Result<(), Flaw> {
        let count = usize::try_from(count).unwrap_or(usize::MAX);
        let after = self.rest.get(count..);
        self.rest = after.unwrap_or_default();
        after.map(|_| ()).ok_or(Flaw::Unreadable)
    }

    fn byte(&mut self) -> Result<u8, Flaw> {
        let (first, rest) = self.rest.split_first().ok_or(Flaw::Unreadable)?;
        self.rest = rest;
        Ok(*first)
    }

    /// A number of seven bits a byte, the lowest first.
    fn number(&mut self) -> Result<u64, Flaw> {
        let (mut number, mut shift) = (0_u64, 0_u32);
        loop {
            let byte = self.byte()?;
            number |= u64::from(byte & 0x7f).checked_shl(shift).unwrap_or(0);
            shift += 7;
            if byte & 0x80 == 0 {
                return Ok(number);
            }
        }
    }

    fn fields(&mut self, known: Inner, depth: u32) -> Result<(), Flaw> {
        let mut field = 0_i64;
        loop {
            let head = self.byte()?;
            if head & 0xf == 0 {
                return Ok(());
            }
            let kind = Kind::of(head & 0xf).ok_or(Flaw::Unreadable)?;
            field = match head >> 4 {
                0 => {
                    let number = self.number()?;
                    // Signs in the lowest bit.
                    (number >> 1).cast_signed() ^ -(number & 1).cast_signed()
                }
                more => field.saturating_add(i64::from(more)),
            };
            let inner = match known.and_then(|s| s.0.iter().find(|f| f.0 == field)) {
                Some((_, defined, _)) if *defined != kind => return Err(Flaw::WrongKind),
                Some((.., inner)) => *inner,
                None => None,
            };
            self.value(kind, inner, depth)?;
        }
    }

    fn value(&mut self, kind: Kind, inner: Inner, depth: u32) -> Result<(), Flaw> {
        let depth = depth.checked_sub(1).ok_or(Flaw::Unreadable)?;
        match kind {
            Kind::Flag => Ok(()),
            Kind::Byte => self.pass(1),
            Kind::Int => self.number().map(|_| ()),
            Kind::Double => self.pass(8),
            Kind::Binary => self.number().and_then(|length| self.pass(length)),
            Kind::Uuid => self.pass(16),
            Kind::Struct => self.fields(inner, depth),
            Kind::List => {
                let head = self.byte()?;
                let size = match head >> 4 {
                    15 => self.number()?,
                    size => u64::from(size),
                };
                self.entries(size, &[head & 0xf], inner, depth)
            }
            Kind::Map => match self.number()? {
                0 => Ok(()),
                size => {
                    let kinds = self.byte()?;
                    self.entries(size, &[kinds >> 4, kinds & 0xf], None, depth)
                }
            },
        }
    }

    /// The entries of a list or map, of which each takes a byte if it is no truth value.
    fn entries(&mut self, size: u64, kinds: &[u8], inner: Inner, depth: u32) -> Result<(), Flaw> {
        if size > self.rest.len() as u64 {
            return Err(Flaw::LongList);
        }
        if kinds.iter().all(|kind| Kind::of(*kind) == Some(Kind::Flag)) {
            self.truth_values = self.truth_values.checked_sub(size).ok_or(Flaw::LongList)?;
            return Ok(());
        }
        for _ in 0..size {
            for kind in kinds {
                self.value(Kind::of(*kind).ok_or(Flaw::Unreadable)?, inner, depth)?;
            }
        }
        Ok(())
    }
}
