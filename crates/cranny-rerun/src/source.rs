//! All that is read of a recording.

use cranny_exact::Pose;
use cranny_record::{
    BodyChanges, ContactsMessage, DrawnContact, DrawnCurve, EventsMessage, LogLine, PosesByName,
    RecordedPicture, Recording, StatsMessage,
};

use crate::error::RerunError;

/// What a recording holds, by log times.
pub(crate) struct Source {
    pub(crate) bodies: Vec<(u64, BodyChanges)>,
    pub(crate) transforms: Vec<(u64, PosesByName)>,
    pub(crate) contacts: Vec<(u64, ContactsMessage)>,
    pub(crate) points: Vec<(u64, Vec<DrawnContact>)>,
    pub(crate) normals: Vec<(u64, Vec<Pose>)>,
    pub(crate) curves: Vec<(u64, Vec<DrawnCurve>)>,
    pub(crate) events: Vec<(u64, EventsMessage)>,
    pub(crate) stats: Vec<(u64, StatsMessage)>,
    pub(crate) log: Vec<(u64, LogLine)>,
    pub(crate) pictures: Vec<(u64, RecordedPicture)>,
}

impl Source {
    /// Reads everything, so that whatever is wrong is known before anything is written.
    pub(crate) fn of(recording: &Recording) -> Result<Self, RerunError> {
        let not_whole = |why: &str| RerunError::NotWhole {
            path: recording.path().to_owned(),
            why: why.to_owned(),
        };
        match recording.damaged_chunks() {
            0 if recording.is_complete() => {}
            0 => return Err(not_whole("is cut off: the run was killed, or the disk was full")),
            n => return Err(not_whole(&format!("is damaged: {n} parts do not match their sums"))),
        }
        let source = Self {
            bodies: recording.body_changes()?,
            transforms: recording.transforms()?,
            contacts: recording.contacts()?,
            points: recording.contact_points()?,
            normals: recording.contact_normals()?,
            curves: recording.contact_curves()?,
            events: recording.events()?,
            stats: recording.stats()?,
            log: recording.log()?,
            pictures: recording.pictures()?,
        };
        match source.transforms.is_empty() {
            false => Ok(source),
            true => Err(RerunError::Empty { path: recording.path().to_owned() }),
        }
    }

    /// What was found about pairs at a log time.
    pub(crate) fn pairs(&self, time: u64) -> Option<&ContactsMessage> {
        let found = self.contacts.binary_search_by_key(&time, |(at, _)| *at).ok()?;
        Some(&self.contacts[found].1)
    }

    /// Whether a log time is no later than the first frame.
    pub(crate) fn is_before_frames(&self, time: u64) -> bool {
        self.transforms.first().is_none_or(|(first, _)| time <= *first)
    }
}
