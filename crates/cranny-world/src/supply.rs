//! Answers that come from elsewhere, told in the order of body ids.

use cranny_narrow_phase::{Answer, Contact, Containment, Region};

/// The answer with the bodies' names exchanged.
pub(crate) fn swapped(answer: Answer) -> Answer {
    Answer {
        contained: answer.contained.map(Containment::swapped),
        witnesses: answer.witnesses.map(|[a, b]| [b, a]),
        contacts: answer.contacts.into_iter().map(Contact::swapped).collect(),
        regions: answer.regions.into_iter().map(Region::swapped).collect(),
        ..answer
    }
}
