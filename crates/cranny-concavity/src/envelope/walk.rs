//! A probe in a concavity: entry, offended facets, the cell it is in, exit.
//!
//! Source: cells are kept as Ponamgi, Manocha and Lin (1997) keep features, see the module; layers
//! are this crate's own. Cost: at most two support evaluations a lid; then, in each layer opened, a
//! comparison of boxes for each facet that comes as far as the probe and an evaluation for each
//! whose box it meets. [`Opened`] counts them. Tracking costs one evaluation where the cell stays,
//! else one a facet of the layer.

use cranny_exact::DVec3;

use super::{Envelope, HalfSpace, Probe};
use crate::ids::{EnvelopeFacetId, LayerId};
use cranny_geometry::FaceId;

/// Where a probe is with respect to a concavity's lids.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Passage {
    /// Wholly beyond the half-space of this lid: it has left, or not come in, and touches no face.
    Beyond(usize),
    /// Its box misses the pocket's.
    Apart,
    /// Partly beyond the half-space of this lid, the first such.
    Through(usize),
    /// Beneath all lids; or the concavity has none.
    Within,
}

/// What was looked at on the way to some faces.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Opened {
    /// Layers looked at.
    pub layers: usize,
    /// Facets whose box was compared.
    pub boxes: usize,
    /// Facets whose plane was compared: support evaluations.
    pub planes: usize,
    /// Facets offended.
    pub facets: usize,
    /// Faces handed over.
    pub faces: usize,
}

/// The facet of a layer that a probe is nearest to, kept from frame to frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cell {
    /// The facet with the least slack; the lowest where several have it.
    pub facet: EnvelopeFacetId,
    /// `least(normal · x) − offset`, to rounding: how far the probe is clear of everything beneath
    /// the layer; negative where it offends.
    pub slack: f64,
    /// No other facet of the layer has less.
    others: f64,
}

impl Envelope<'_> {
    /// Where a probe is with respect to the lids. Cost: at most two evaluations a lid.
    #[must_use]
    pub fn passage<F: Fn(DVec3) -> f64>(&self, probe: &Probe<F>) -> Passage {
        let lids = self.lids();
        if let Some(lid) = lids.iter().position(|l| probe.is_beyond(l.normal, l.offset)) {
            return Passage::Beyond(lid);
        }
        if !probe.bounds().overlaps(self.bounds()) {
            return Passage::Apart;
        }
        let crosses = |l: &HalfSpace| -probe.least(-l.normal) > l.offset;
        lids.iter().position(crosses).map_or(Passage::Within, Passage::Through)
    }

    /// Calls `visit` with each facet of a layer that the probe may offend: where it does not, it
    /// certainly touches nothing beneath. From the cap inwards, no further than the probe comes.
    pub fn offended<F: Fn(DVec3) -> f64>(
        &self,
        layer: LayerId,
        probe: &Probe<F>,
        visit: impl FnMut(EnvelopeFacetId),
    ) {
        let lowest = probe.least(self.axis());
        self.offended_above(layer, probe, lowest, &mut Opened::default(), visit);
    }

    /// Whether the probe may offend a facet; where it does not, it certainly touches nothing
    /// beneath.
    #[must_use]
    pub fn is_offended<F: Fn(DVec3) -> f64>(
        &self,
        facet: EnvelopeFacetId,
        probe: &Probe<F>,
    ) -> bool {
        let (lowest, mut is_offended) = (probe.least(self.axis()), false);
        self.offended_among([facet], probe, lowest, &mut Opened::default(), |_| is_offended = true);
        is_offended
    }

    fn offended_above<F: Fn(DVec3) -> f64>(
        &self,
        layer: LayerId,
        probe: &Probe<F>,
        lowest: f64,
        opened: &mut Opened,
        visit: impl FnMut(EnvelopeFacetId),
    ) {
        opened.layers += 1;
        self.offended_among(self.all.layer(layer), probe, lowest, opened, visit);
    }

    /// Of some facets, those that reach farther up first.
    fn offended_among<F: Fn(DVec3) -> f64>(
        &self,
        facets: impl IntoIterator<Item = EnvelopeFacetId>,
        probe: &Probe<F>,
        lowest: f64,
        opened: &mut Opened,
        mut visit: impl FnMut(EnvelopeFacetId),
    ) {
        for id in facets {
            let facet = self.all.facet(id);
            if probe.is_above(lowest, facet.reach) {
                break; // the facets that follow reach no farther
            }
            opened.boxes += 1;
            if !probe.bounds().overlaps(&facet.bounds) {
                continue;
            }
            opened.planes += 1;
            if !probe.is_beyond(facet.beneath.normal, facet.beneath.offset) {
                opened.facets += 1;
                visit(id);
            }
        }
    }

    /// Calls `visit` with the faces that lie beneath offended facets, layer by layer: all faces
    /// that meet the probe are among them. Says what was looked at.
    pub fn for_each_face<F: Fn(DVec3) -> f64>(
        &self,
        probe: &Probe<F>,
        mut visit: impl FnMut(FaceId),
    ) -> Opened {
        let mut opened = Opened::default();
        if matches!(self.passage(probe), Passage::Beyond(_) | Passage::Apart) {
            return opened;
        }
        let lowest = probe.least(self.axis());
        let mut stack: Vec<LayerId> = self.first_layer().into_iter().collect();
        let mut faces = 0;
        while let Some(layer) = stack.pop() {
            let open = |id: EnvelopeFacetId| match self.all.layer_beneath(id) {
                Some(layer) => stack.push(layer),
                None => {
                    let beneath = self.all.faces_beneath(id);
                    faces += beneath.len();
                    beneath.iter().copied().for_each(&mut visit);
                }
            };
            self.offended_above(layer, probe, lowest, &mut opened, open);
        }
        opened.faces = faces;
        opened
    }

    /// The cell of a layer that the probe is in. With the cell of an earlier frame and a bound on
    /// how much any `least` may have changed since (the motion of the probe's points, rounding
    /// included) one evaluation mostly suffices; the facet and the slack are those of a cold look,
    /// to the bit.
    #[must_use]
    pub fn track<F: Fn(DVec3) -> f64>(
        &self,
        layer: LayerId,
        probe: &Probe<F>,
        earlier: Option<(&Cell, f64)>,
    ) -> Cell {
        let slack = |id: EnvelopeFacetId| {
            let beneath = &self.all.facet(id).beneath;
            probe.least(beneath.normal) - beneath.offset
        };
        if let Some((cell, motion)) = earlier
            && self.all.layer(layer).any(|id| id == cell.facet)
        {
            let others = remaining(cell.others, motion);
            let slack = slack(cell.facet);
            if slack < others {
                return Cell { facet: cell.facet, slack, others };
            }
        }
        let mut best =
            Cell { facet: EnvelopeFacetId(u32::MAX), slack: f64::INFINITY, others: f64::INFINITY };
        for id in self.all.layer(layer) {
            let slack = slack(id);
            if slack < best.slack {
                best = Cell { facet: id, slack, others: best.slack };
            } else {
                best.others = best.others.min(slack);
            }
        }
        best
    }
}

/// What a slack is worth after a motion, rounded down: the two subtractions that make a slack and
/// this one round by half an ulp each.
fn remaining(slack: f64, motion: f64) -> f64 {
    if slack == f64::INFINITY {
        return slack; // there is no other facet
    }
    (slack - motion) - 4.0 * f64::EPSILON * (slack.abs() + motion)
}
