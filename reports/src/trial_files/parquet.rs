//! `trials.parquet`: the columns of `trials.csv` with their types. An undefined value is null.

use evaluation::trials::Length;
use evaluation::trials::{Metric, Trial};
use files::OutputError;
use parquet::basic::{Compression, Encoding};
use parquet::data_type::{ByteArray, ByteArrayType, DataType, DoubleType, Int64Type};
use parquet::errors::{ParquetError, Result as ParquetResult};
use parquet::file::properties::{EnabledStatistics, WriterProperties};
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};
use parquet::schema::parser::parse_message_type;
use parquet::schema::types::{ColumnPath, Type};
use std::fs::File;
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The least number of rows of a group, after which the group is written: 12 MB in memory.
const GROUP_ROWS: usize = 100_000;
pub(super) struct ParquetFile {
    path: PathBuf,
    file: SerializedFileWriter<BufWriter<File>>,
    rows: Rows,
}

/// The rows of the group that is not written yet, by column.
#[derive(Default)]
struct Rows {
    /// World, estimator and strategy.
    names: [Vec<ByteArray>; 3],
    seeds: Vec<i64>,
    times: Vec<i64>,
    /// The defined values, and for every row 1 if its value is defined, otherwise 0.
    metrics: [(Vec<f64>, Vec<i16>); Metric::ALL.len()],
    map_hashes: Vec<ByteArray>,
}

impl ParquetFile {
    pub(super) fn create(path: &Path, length: Length) -> Result<Self, OutputError> {
        let failed = |why| OutputError::new(path, why);
        let file = BufWriter::new(File::create(path).map_err(failed)?);
        let made = schema(length)
            .and_then(|schema| SerializedFileWriter::new(file, Arc::new(schema), Arc::new(properties())));
        let file = made.map_err(|error| failed(io_error(error)))?;
        Ok(Self { path: path.to_owned(), file, rows: Rows::default() })
    }

    pub(super) fn add(&mut self, trials: &[Trial]) -> Result<(), OutputError> {
        for trial in trials {
            self.rows.add(trial);
            if self.rows.seeds.len() >= GROUP_ROWS {
                self.write_group()?;
            }
        }
        Ok(())
    }

    fn write_group(&mut self) -> Result<(), OutputError> {
        let rows = std::mem::take(&mut self.rows);
        let written = self.file.next_row_group().and_then(|group| rows.write(group));
        written.map_err(|error| OutputError::new(&self.path, io_error(error)))
    }

    pub(super) fn finish(mut self) -> Result<(), OutputError> {
        if !self.rows.seeds.is_empty() {
            self.write_group()?;
        }
        let closed = self.file.into_inner().map_err(io_error);
        let flushed = closed.and_then(|file| file.into_inner().map_err(io::IntoInnerError::into_error));
        flushed.map(drop).map_err(|why| OutputError::new(&self.path, why))
    }
}

impl Rows {
    fn add(&mut self, trial: &Trial) {
        let count = trial.samples.len();
        for (column, name) in self.names.iter_mut().zip([&trial.world, &trial.estimator, &trial.strategy]) {
            column.extend(std::iter::repeat_n(ByteArray::from(name.as_str()), count));
        }
        self.map_hashes.extend(std::iter::repeat_n(ByteArray::from(trial.map_hash.as_str()), count));
        self.seeds.extend(std::iter::repeat_n(trial.seed.cast_signed(), count));
        self.times.extend(trial.samples.iter().map(|sample| sample.time.cast_signed()));
        for (metric, (values, is_defined)) in Metric::ALL.iter().zip(&mut self.metrics) {
            let column = trial.samples.iter().map(|sample| metric.of(sample));
            is_defined.extend(column.clone().map(|value| i16::from(!value.is_nan())));
            values.extend(column.filter(|value| !value.is_nan()));
        }
    }

    fn write(&self, mut group: SerializedRowGroupWriter<BufWriter<File>>) -> ParquetResult<()> {
        for names in &self.names {
            write_column::<ByteArrayType>(&mut group, names, None)?;
        }
        for numbers in [&self.seeds, &self.times] {
            write_column::<Int64Type>(&mut group, numbers, None)?;
        }
        for (values, is_defined) in &self.metrics {
            write_column::<DoubleType>(&mut group, values, Some(is_defined))?;
        }
        write_column::<ByteArrayType>(&mut group, &self.map_hashes, None)?;
        group.close().map(drop)
    }
}

fn write_column<T: DataType>(
    group: &mut SerializedRowGroupWriter<BufWriter<File>>,
    values: &[T::T],
    is_defined: Option<&[i16]>,
) -> ParquetResult<()> {
    let Some(mut column) = group.next_column()? else {
        return Err(ParquetError::General("the table has fewer columns than the rows".into()));
    };
    column.typed::<T>().write_batch(values, is_defined, None)?;
    column.close()
}

fn schema(length: Length) -> ParquetResult<Type> {
    let metrics = Metric::ALL.map(|metric| format!("OPTIONAL DOUBLE {};", metric.name())).concat();
    parse_message_type(&format!(
        "message trials {{
             REQUIRED BYTE_ARRAY world (STRING);
             REQUIRED BYTE_ARRAY estimator (STRING);
             REQUIRED BYTE_ARRAY strategy (STRING);
             REQUIRED INT64 seed (INTEGER(64, false));
             REQUIRED INT64 {} (INTEGER(64, false));
             {metrics}
             REQUIRED BYTE_ARRAY map_hash (STRING);
         }}",
        length.column()
    ))
}

/// Text is kept in dictionaries. Numbers are split into streams of their bytes, since their exponents repeat and their
/// last bits do not.
fn properties() -> WriterProperties {
    let mut properties = WriterProperties::builder()
        .set_compression(Compression::LZ4_RAW)
        .set_statistics_enabled(EnabledStatistics::Chunk);
    for metric in Metric::ALL {
        let column = ColumnPath::from(metric.name());
        properties = properties
            .set_column_dictionary_enabled(column.clone(), false)
            .set_column_encoding(column, Encoding::BYTE_STREAM_SPLIT);
    }
    properties.build()
}

/// The error of the operating system, or the text of another error.
fn io_error(error: ParquetError) -> io::Error {
    match error {
        ParquetError::External(error) => match error.downcast::<io::Error>() {
            Ok(error) => *error,
            Err(error) => io::Error::other(error),
        },
        error => io::Error::other(error),
    }
}
