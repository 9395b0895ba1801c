//! What matter encloses, which no picture of a body from outside would show.

use std::collections::BTreeSet;

use cranny_concavity::ConcavityId;
use cranny_concavity::{Concavity, ConcavityKind};

use super::canvas::Canvas;

/// Where matter encloses voids, or pieces of matter, whatever is around them becomes glass.
pub(super) fn lay_bare_what_is_enclosed(canvas: &mut Canvas<'_>) {
    let concavities = canvas.concavities;
    let is_hidden = |c: &Concavity<'_>| match c.kind {
        ConcavityKind::Void => true,
        ConcavityKind::Island => c.parent.is_none(),
        _ => false,
    };
    if !concavities.iter().any(|c| is_hidden(&c)) {
        return;
    }
    let around: BTreeSet<ConcavityId> = concavities.iter().filter_map(|c| c.parent).collect();
    let has_lid = |id| concavities.get(id).lids().len() > 0;
    canvas.lay_bare(|face| {
        concavities.of_face(face).is_some_and(|id| !has_lid(id) && !around.contains(&id))
    });
    canvas.remark("what surrounds concavities without a lid is translucent");
}
