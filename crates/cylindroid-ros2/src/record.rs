//! A record of all messages that the node takes and publishes, as an MCAP file with their
//! definitions: what `ros2 bag play`, PlotJuggler and Foxglove read.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::BufWriter;
use std::path::Path;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::{self, JoinHandle};
use std::time::{SystemTime, UNIX_EPOCH};

use anyhow::{Context, Result};
use cylindroid::model::check_output_file;
use mcap::WriteOptions;
use mcap::records::MessageHeader;
use ros2_client::dds::rustdds::CDRSerializerAdapter;
use ros2_client::dds::rustdds::no_key::SerializerAdapter;
use serde::Serialize;

use crate::messages::{Field, Named};

/// Header of little-endian CDR.
const LITTLE_ENDIAN: [u8; 4] = [0, 1, 0, 0];
/// Messages that may wait for the disk; then they are not recorded.
const WAITING: usize = 4096;

/// A message on its way to the file.
struct Entry {
    topic: String,
    /// Type and definition, once for each topic.
    schema: fn() -> [String; 2],
    /// Since 1970 (ns).
    time: u64,
    data: Vec<u8>,
}

/// Hands messages to a thread that writes: the disk does not stop the loop.
pub(crate) struct Recorder {
    sender: Option<SyncSender<Entry>>,
    writer: Option<JoinHandle<Result<()>>>,
    /// Messages that are not in the file.
    lost: u64,
}

impl Recorder {
    pub(crate) fn new(path: &Path) -> Result<Self> {
        let file = check_output_file(path).and_then(|()| File::create(path));
        let file = file.with_context(|| path.display().to_string())?;
        let (sender, receiver) = sync_channel(WAITING);
        let writer = thread::Builder::new().name("record".to_owned());
        let writer = writer.spawn(move || write(file, &receiver))?;
        Ok(Self { sender: Some(sender), writer: Some(writer), lost: 0 })
    }

    pub(crate) fn record<M: Named + Field + Serialize>(&mut self, topic: &str, message: &M) {
        let now = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
        let time = u64::try_from(now.as_nanos()).unwrap_or_default();
        let body = CDRSerializerAdapter::<M>::to_bytes(message);
        let sent = body.ok().and_then(|body| {
            let data = [&LITTLE_ENDIAN[..], &body[..]].concat();
            let entry = Entry { topic: topic.to_owned(), schema: M::schema, time, data };
            self.sender.as_ref()?.try_send(entry).ok()
        });
        self.lost += u64::from(sent.is_none());
    }

    /// Closes the file.
    pub(crate) fn finish(&mut self) -> Result<u64> {
        drop(self.sender.take());
        if let Some(writer) = self.writer.take() {
            writer.join().map_err(|_| anyhow::anyhow!("the thread of the record failed"))??;
        }
        Ok(self.lost)
    }
}

fn write(file: File, entries: &Receiver<Entry>) -> Result<()> {
    let options = WriteOptions::new().profile("ros2").compression(None);
    let mut writer = options.create(BufWriter::new(file))?;
    let mut channels = BTreeMap::new();
    let metadata = BTreeMap::from([("offered_qos_profiles".to_owned(), String::new())]);
    for (sequence, Entry { topic, schema, time, data }) in (0..).zip(entries) {
        let channel_id = match channels.get(&topic) {
            Some(id) => *id,
            None => {
                let [name, definition] = schema();
                let schema = writer.add_schema(&name, "ros2msg", definition.as_bytes())?;
                let id = writer.add_channel(schema, &topic, "cdr", &metadata)?;
                channels.insert(topic, id);
                id
            }
        };
        let header = MessageHeader { channel_id, sequence, log_time: time, publish_time: time };
        writer.write_to_known_channel(&header, &data)?;
    }
    writer.finish()?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::Recorder;

    /// A folder and a device are no place for a record; a new file and one that is there are.
    #[test]
    fn records_are_regular_files() {
        let folder = std::env::temp_dir().join(format!("cylindroid-record-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let new = |path: &std::path::Path| Recorder::new(path).map(|mut r| r.finish().unwrap());
        let error = new(&folder).unwrap_err();
        assert!(format!("{error:#}").contains("it is a folder"), "{error:#}");
        if cfg!(unix) {
            let error = new("/dev/null".as_ref()).unwrap_err();
            assert!(format!("{error:#}").contains("/dev/null: it is a device"), "{error:#}");
        }
        let file = folder.join("a.mcap");
        for _ in 0..2 {
            assert_eq!(new(&file).unwrap(), 0);
        }
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
