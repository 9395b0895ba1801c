//! Rerun's files, read by Rerun's own decoder.

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use re_log_encoding::DecoderApp;
use re_sdk::log::{Chunk, LogMsg};
use re_sdk::{Component, ComponentDescriptor, EntityPath, StoreKind, TimelineName};

/// What a file holds.
pub(crate) struct Rrd {
    chunks: Vec<Chunk>,
    /// Chunks of layouts.
    pub(crate) layout_chunks: usize,
}

/// A row: nanoseconds and step, `None` where it holds at all times; and the values.
pub(crate) type Row<C> = (Option<(i64, i64)>, Vec<C>);

impl Rrd {
    pub(crate) fn read(path: &Path) -> Self {
        let file = BufReader::new(File::open(path).unwrap());
        let mut rrd = Self { chunks: Vec::new(), layout_chunks: 0 };
        for message in DecoderApp::decode_eager(file).unwrap() {
            let LogMsg::ArrowMsg(store, message) = message.unwrap() else { continue };
            match store.kind() {
                StoreKind::Recording => rrd.chunks.push(Chunk::from_arrow_msg(&message).unwrap()),
                StoreKind::Blueprint => rrd.layout_chunks += 1,
            }
        }
        rrd.chunks.iter().for_each(|chunk| chunk.sanity_check().unwrap());
        rrd
    }

    /// All entities, but for those that Rerun adds.
    pub(crate) fn entities(&self) -> Vec<String> {
        let own = self.chunks.iter().map(Chunk::entity_path).filter(|path| !path.is_reserved());
        let mut entities: Vec<String> = own.map(ToString::to_string).collect();
        entities.sort();
        entities.dedup();
        entities
    }

    /// All rows of a component of an entity.
    pub(crate) fn rows<C: Component>(
        &self,
        entity: &str,
        descriptor: &ComponentDescriptor,
    ) -> Vec<Row<C>> {
        let entity = EntityPath::from(entity);
        let component = descriptor.component;
        let mut rows = Vec::new();
        for chunk in self.chunks.iter().filter(|chunk| *chunk.entity_path() == entity) {
            let times = |name: &'static str| -> Vec<i64> {
                let column = chunk.timelines().get(&TimelineName::from(name));
                column.map_or(Vec::new(), |column| column.times_raw().to_vec())
            };
            let (times, steps) = (times("time"), times("step"));
            assert_eq!(chunk.timelines().len(), if chunk.is_static() { 0 } else { 2 }, "{entity}");
            for (row, values) in chunk.iter_component::<C>(component).enumerate() {
                let at = times.get(row).copied().zip(steps.get(row).copied());
                rows.push((at, values.as_slice().to_vec()));
            }
        }
        rows
    }
}
