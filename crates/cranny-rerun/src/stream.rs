//! The one way in which anything gets to Rerun.

use re_sdk::{
    AsComponents, EntityPath, EntityPathPart, RecordingStream, SerializationResult,
    SerializedComponentBatch, SerializedComponentColumn,
};

use crate::clock::Clock;
use crate::error::RerunError;

/// Rows of a chunk at most. Smaller: a long recording has more chunks, which each cost the viewer
/// an index entry; larger: it unpacks more to show one frame of many contacts.
const ROWS_PER_CHUNK: usize = 256;

/// The columns of some rows.
pub(crate) type Columns = SerializationResult<Vec<SerializedComponentColumn>>;

/// Logs to Rerun what is known of an entity, always or at log times.
pub(crate) struct Stream<'a> {
    pub(crate) to: &'a RecordingStream,
    pub(crate) clock: &'a Clock,
}

impl Stream<'_> {
    /// What holds at all times.
    pub(crate) fn once(
        &self,
        path: &EntityPath,
        components: &dyn AsComponents,
    ) -> Result<(), RerunError> {
        self.to
            .log_static(path.clone(), components)
            .map_err(|source| RerunError::Stream { what: path.to_string(), source: source.into() })
    }

    /// What holds from a log time on.
    pub(crate) fn at(
        &self,
        time: u64,
        path: &EntityPath,
        components: &dyn AsComponents,
    ) -> Result<(), RerunError> {
        self.rows(path, &[(time, ())], |_| {
            let batches = components.as_serialized_batches();
            let whole = |batch: SerializedComponentBatch| {
                let length = batch.array.len();
                batch.partitioned([length])
            };
            batches.into_iter().map(whole).collect()
        })
    }

    /// What changes: a row for each log time, and how rows become columns.
    pub(crate) fn rows<T>(
        &self,
        path: &EntityPath,
        rows: &[(u64, T)],
        columns: impl Fn(&[(u64, T)]) -> Columns,
    ) -> Result<(), RerunError> {
        for rows in rows.chunks(ROWS_PER_CHUNK) {
            let times = self.clock.columns(rows.iter().map(|(time, _)| *time));
            let sent = columns(rows)
                .map_err(Into::into)
                .and_then(|columns| self.to.send_columns(path.clone(), times, columns));
            sent.map_err(|source| RerunError::Stream {
                what: path.to_string(),
                source: source.into(),
            })?;
        }
        Ok(())
    }
}

/// The path of a thing in a group. A name stays one part, whatever slashes it has: transforms of
/// what lies beneath another part would add up.
pub(crate) fn path(group: &[&str], name: &str) -> EntityPath {
    let parts = group.iter().chain([&name]).map(|&part| EntityPathPart::new(part));
    EntityPath::new(parts.collect())
}
