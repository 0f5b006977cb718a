//! Columns of Parquet files by their logical types: numbers as they are meant, or refused.

use std::fs::File;
use std::path::Path;
use std::sync::Arc;

use cylindroid::sweep::parquet_columns;
use parquet::basic::{ConvertedType, LogicalType, Repetition, TimeUnit, Type as Physical};
use parquet::data_type::{
    DataType, DoubleType, FixedLenByteArray, FixedLenByteArrayType, Int32Type, Int64Type, Int96,
    Int96Type,
};
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::{PrimitiveTypeBuilder, Type};

fn column(name: &str, physical: Physical) -> PrimitiveTypeBuilder<'_> {
    Type::primitive_type_builder(name, physical).with_repetition(Repetition::REQUIRED)
}

/// Writes a file of columns with the same values.
fn write<T: DataType>(path: &Path, columns: Vec<PrimitiveTypeBuilder<'_>>, values: &[T::T]) {
    let count = columns.len();
    let fields = columns.into_iter().map(|column| Arc::new(column.build().unwrap())).collect();
    let schema = Type::group_type_builder("file").with_fields(fields).build().unwrap();
    let file = File::create(path).unwrap();
    let mut writer = SerializedFileWriter::new(file, Arc::new(schema), Arc::default()).unwrap();
    let mut group = writer.next_row_group().unwrap();
    for _ in 0..count {
        let mut column = group.next_column().unwrap().unwrap();
        column.typed::<T>().write_batch(values, None, None).unwrap();
        column.close().unwrap();
    }
    group.close().unwrap();
    writer.close().unwrap();
}

/// What is read of a column of these values.
fn read<T: DataType>(
    column: PrimitiveTypeBuilder<'_>,
    values: &[T::T],
) -> Result<Vec<f64>, String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("file.parquet");
    write::<T>(&path, vec![column], values);
    parquet_columns(&path, &["q1"]).map_err(|error| error.to_string())
}

/// The nearest number to each decimal, whatever its integer; also by the older converted type.
#[test]
fn decimals_are_scaled() {
    let of = |physical, scale, precision| {
        column("q1", physical).with_scale(scale).with_precision(precision)
    };
    let logical = |scale, precision| Some(LogicalType::decimal(scale, precision));
    let short = of(Physical::INT32, 3, 9).with_logical_type(logical(3, 9));
    assert_eq!(read::<Int32Type>(short, &[1571, -300, 0]).unwrap(), [1.571, -0.3, 0.0]);
    let older = of(Physical::INT32, 2, 9).with_converted_type(ConvertedType::DECIMAL);
    assert_eq!(read::<Int32Type>(older, &[157, -1]).unwrap(), [1.57, -0.01]);
    let long = of(Physical::INT64, 18, 18).with_logical_type(logical(18, 18));
    let found = read::<Int64Type>(long, &[123_456_789_012_345_678, -7]).unwrap();
    assert_eq!(found, [0.123_456_789_012_345_68, -7e-18]);
    let whole = of(Physical::INT64, 0, 18).with_logical_type(logical(0, 18));
    assert_eq!(read::<Int64Type>(whole, &[-25]).unwrap(), [-25.0]);
}

#[test]
fn integers_have_their_sign() {
    let of = |physical, width, signed| {
        column("q1", physical).with_logical_type(Some(LogicalType::integer(width, signed)))
    };
    let short = [-1, 2, i32::MIN];
    let long = [-1, 2, i64::MIN];
    let found = read::<Int32Type>(of(Physical::INT32, 32, false), &short).unwrap();
    assert_eq!(found, [4_294_967_295.0, 2.0, 2_147_483_648.0]);
    let found = read::<Int64Type>(of(Physical::INT64, 64, false), &long).unwrap();
    assert_eq!(found, [2.0_f64.powi(64), 2.0, 2.0_f64.powi(63)]);
    let found = read::<Int32Type>(of(Physical::INT32, 32, true), &short).unwrap();
    assert_eq!(found, short.map(f64::from));
    let found = read::<Int64Type>(column("q1", Physical::INT64), &long).unwrap();
    assert_eq!(found, [-1.0, 2.0, -(2.0_f64.powi(63))]);
    let older = column("q1", Physical::INT64).with_converted_type(ConvertedType::UINT_64);
    assert_eq!(read::<Int64Type>(older, &[-1]).unwrap(), [2.0_f64.powi(64)]);
}

#[test]
fn what_is_no_number_is_refused() {
    let (short, long) = (Physical::INT32, Physical::INT64);
    let logical = |physical, kind| column("q1", physical).with_logical_type(Some(kind));
    let converted = |physical, kind| column("q1", physical).with_converted_type(kind);
    let of_short = [
        (logical(short, LogicalType::Date), "dates"),
        (logical(short, LogicalType::time(true, TimeUnit::MILLIS)), "times of day"),
        (converted(short, ConvertedType::DATE), "dates"),
        (converted(short, ConvertedType::TIME_MILLIS), "times of day"),
    ];
    let of_long = [
        (logical(long, LogicalType::time(false, TimeUnit::NANOS)), "times of day"),
        (logical(long, LogicalType::timestamp(true, TimeUnit::MICROS)), "points in time"),
        (logical(long, LogicalType::timestamp(true, TimeUnit::NANOS)), "points in time"),
        (converted(long, ConvertedType::TIMESTAMP_MILLIS), "points in time"),
    ];
    let decimal = column("q1", Physical::FIXED_LEN_BYTE_ARRAY)
        .with_length(2)
        .with_precision(4)
        .with_scale(1)
        .with_logical_type(Some(LogicalType::decimal(1, 4)));
    let half = column("q1", Physical::FIXED_LEN_BYTE_ARRAY)
        .with_length(2)
        .with_logical_type(Some(LogicalType::Float16));
    let bytes = FixedLenByteArray::from(vec![0, 1]);
    let of_bytes = [(decimal, "decimals in bytes"), (half, "numbers of 16 bits")];
    let of_oldest = [(column("q1", Physical::INT96), "points in time")];
    let refused = of_short
        .map(|(own, says)| (read::<Int32Type>(own, &[1]), says))
        .into_iter()
        .chain(of_long.map(|(own, says)| (read::<Int64Type>(own, &[1]), says)))
        .chain(of_oldest.map(|(own, says)| (read::<Int96Type>(own, &[Int96::new()]), says)))
        .chain(of_bytes.map(|(own, says)| {
            (read::<FixedLenByteArrayType>(own, std::slice::from_ref(&bytes)), says)
        }));
    for (found, says) in refused {
        let error = found.unwrap_err();
        let says = format!("column 'q1' holds {says}");
        assert!(error.contains(&says) && error.contains("as float64"), "{error}");
    }
}

#[test]
fn a_column_has_a_name_of_its_own() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("file.parquet");
    let names = ["q1", "q2", "q1"];
    let columns = names.map(|name| column(name, Physical::DOUBLE)).into_iter().collect();
    write::<DoubleType>(&path, columns, &[0.5]);
    let error = parquet_columns(&path, &["q2", "q1"]).unwrap_err().to_string();
    assert!(error.contains("column 'q1' is given twice"), "{error}");
    assert_eq!(parquet_columns(&path, &["q2"]).unwrap(), [0.5]);
}

/// A list of 2^31 truth values, which have no bytes, in a field that Parquet does not define takes its
/// reader seconds: in a footer and in the header of a page. It is refused first.
#[test]
fn lists_longer_than_the_file_are_refused() {
    // As many entries as an i32 counts, after the kind of a field.
    const LIST: [u8; 6] = [0xf1, 0xff, 0xff, 0xff, 0xff, 0x07];
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("file.parquet");
    write::<DoubleType>(&path, vec![column("q1", Physical::DOUBLE)], &[0.5, 1.5]);
    let whole = std::fs::read(&path).unwrap();
    let end = whole.len() - 8;
    let length = u32::from_le_bytes(whole[end..end + 4].try_into().unwrap());
    let (pages, old) = whole[..end].split_at(end - length as usize);
    let read_with = |footer: &[u8], pages: &[u8]| {
        let length = u32::try_from(footer.len()).unwrap().to_le_bytes();
        std::fs::write(&path, [pages, footer, &length, b"PAR1"].concat()).unwrap();
        parquet_columns(&path, &["q1"]).map_err(|error| error.to_string())
    };
    assert_eq!(read_with(old, pages).unwrap(), [0.5, 1.5]);

    // A field more before the stop of the footer, its number 15 above that of the last one.
    let with = |list: &[u8]| [&old[..old.len() - 1], &[0xf9], list, &[0]].concat();
    assert_eq!(read_with(&with(&[0x23, 1, 2]), pages).unwrap(), [0.5, 1.5]);
    let error = read_with(&with(&LIST), pages).unwrap_err();
    assert!(error.contains("the footer announces a list that is longer"), "{error}");

    // Many lists that are shorter than the footer, each of as many truth values as zeros follow.
    let lists = |count: usize| {
        let first = [&old[..old.len() - 1], &[0xf9, 0xf1, 100]].concat();
        [&first, &[0x19, 0xf1, 100].repeat(count)[..], &[0x18, 100], &[0; 100], &[0]].concat()
    };
    assert_eq!(read_with(&lists(0), pages).unwrap(), [0.5, 1.5]);
    let error = read_with(&lists(20), pages).unwrap_err();
    assert!(error.contains("the footer announces a list that is longer"), "{error}");

    // The number of rows, field 3, as a list, of which the reader would take the size for a number.
    let wrong = [&[0x15, 2, 0x29], &LIST[..], &[0]].concat();
    let error = read_with(&wrong, pages).unwrap_err();
    assert!(error.contains("the footer has a field of another kind"), "{error}");

    // The list in the place of the header of the first page.
    let mut damaged = pages.to_vec();
    damaged[4..11].copy_from_slice(&[&[0xf9], &LIST[..]].concat());
    let error = read_with(old, &damaged).unwrap_err();
    assert!(error.contains("the header of a page announces a list"), "{error}");
}
