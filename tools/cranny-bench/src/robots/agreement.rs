//! What a peer finds at a configuration, beside what we find.

use cranny_exact::Pose;
use cranny_narrow_phase::{Answer, Demand, PairMemory, Query};
use cranny_primitives::{PlacedShape, query_shapes};

use super::contestants::Found;
use super::stage::RobotStage;

/// Metres. The libraries may count gaps below 1e-6 as hits, and iterate distances to 1e-6. Smaller:
/// such gaps fail. Larger: errors of ours pass.
const TOLERANCE: f64 = 4e-6;

/// How the verdicts and distances of a peer compare with ours.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Agreement {
    /// Configurations that both looked at.
    pub(super) compared: usize,
    /// Hits of ours where one link lies inside the other. A tree of triangles has no inside.
    pub(super) inside: usize,
    /// Hits of the peer where the links are apart by no more than [`TOLERANCE`].
    pub(super) near: usize,
    /// All other differences, a sentence each.
    pub(super) differences: Vec<String>,
}

/// Compares what was found, configuration by configuration.
pub(super) fn compare(
    stage: &RobotStage<'_>,
    ours: &[Option<Found>],
    peer: &[Option<Found>],
) -> Agreement {
    let mut agreement = Agreement::default();
    for (frame, found) in ours.iter().zip(peer).enumerate() {
        let (Some(ours), Some(peer)) = found else { continue };
        agreement.compared += 1;
        let missed = ours.hits.iter().filter(|pair| !peer.hits.contains(pair));
        for &pair in missed {
            agreement.missed_by_peer(stage, frame, pair);
        }
        for &pair in peer.hits.iter().filter(|pair| !ours.hits.contains(pair)) {
            agreement.missed_by_us(stage, frame, pair);
        }
        // A distance follows from the hits, which are compared above.
        if ours.hits != peer.hits {
            continue;
        }
        let (Some(own), Some(other)) = (ours.distance, peer.distance) else { continue };
        if (own - other.max(0.0)).abs() > TOLERANCE {
            let what = format!("configuration {frame}: the distance is {own}, the peer's {other}");
            agreement.differences.push(what);
        }
    }
    agreement
}

impl Agreement {
    fn missed_by_peer(&mut self, stage: &RobotStage<'_>, frame: usize, pair: (usize, usize)) {
        if is_inside(stage, frame, pair) {
            self.inside += 1;
        } else {
            self.differ(stage, frame, pair, "meet, and not for the peer");
        }
    }

    fn missed_by_us(&mut self, stage: &RobotStage<'_>, frame: usize, pair: (usize, usize)) {
        let gap = answer(stage, frame, pair).and_then(|answer| answer.distance);
        if gap.is_some_and(|gap| gap <= TOLERANCE) {
            self.near += 1;
        } else {
            let what = format!("are {gap:?} apart, and meet for the peer");
            self.differ(stage, frame, pair, &what);
        }
    }

    fn differ(&mut self, stage: &RobotStage<'_>, frame: usize, (a, b): (usize, usize), what: &str) {
        let [a, b] = [a, b].map(|link| &stage.cell.robot.links[link].name);
        self.differences.push(format!("configuration {frame}: {a} and {b} {what}"));
    }
}

/// Returns whether one link lies wholly inside the other.
fn is_inside(stage: &RobotStage<'_>, frame: usize, pair: (usize, usize)) -> bool {
    answer(stage, frame, pair).is_some_and(|answer| answer.contained.is_some())
}

/// Returns the answer about a pair, computed without memory.
fn answer(stage: &RobotStage<'_>, frame: usize, (a, b): (usize, usize)) -> Option<Answer> {
    let placed = |link: usize| {
        let pose: Pose = stage.poses[frame][link];
        stage.cell.shapes[link].as_ref().map(|shape| PlacedShape { shape, pose })
    };
    let query = Query::of(Demand::Distance { below: None });
    query_shapes(placed(a)?, placed(b)?, &query, &mut PairMemory::default()).ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robots::stage::RobotCell;

    /// A room with a ball in it that slides out, and its pose at some positions.
    fn compared(positions: &[f64], peer: Found) -> Agreement {
        let folder = tempfile::tempdir().unwrap();
        let urdf = folder.path().join("r.urdf");
        let text = "<robot name='r'>
            <link name='room'><collision><geometry><box size='2 2 2'/></geometry></collision></link>
            <link name='rail'/>
            <link name='ball'><collision><geometry><sphere radius='0.25'/></geometry></collision></link>
            <joint name='base' type='fixed'><parent link='room'/><child link='rail'/></joint>
            <joint name='slide' type='prismatic'><parent link='rail'/><child link='ball'/><axis xyz='1 0 0'/>
            <limit lower='0' upper='9' effort='1' velocity='1'/></joint></robot>";
        std::fs::write(&urdf, text).unwrap();
        let cell = RobotCell::read(&urdf, None).unwrap();
        let poses = positions
            .iter()
            .map(|&at| cell.robot.forward_kinematics(&[("slide".to_owned(), at)].into()).unwrap());
        let stage = RobotStage { cell: &cell, poses: poses.collect() };
        let ours = positions.iter().map(|&at| {
            let gap = (at - 1.25).max(0.0);
            let hits = if gap > 0.0 { Vec::new() } else { vec![(0, 2)] };
            Some(Found { hits, distance: Some(gap) })
        });
        compare(&stage, &ours.collect::<Vec<_>>(), &vec![Some(peer); positions.len()])
    }

    fn found(hits: &[(usize, usize)], distance: f64) -> Found {
        Found { hits: hits.to_vec(), distance: Some(distance) }
    }

    #[test]
    fn answers_are_sorted_by_why_they_differ() {
        let counts = |agreement: Agreement| {
            let Agreement { compared, inside, near, differences } = agreement;
            (compared, inside, near, differences.len())
        };
        assert_eq!(counts(compared(&[3.25], found(&[], 2.0))), (1, 0, 0, 0));
        assert_eq!(counts(compared(&[3.25], found(&[], 2.1))), (1, 0, 0, 1), "a distance");
        assert_eq!(counts(compared(&[0.0], found(&[], 0.75))), (1, 1, 0, 0), "inside");
        assert_eq!(counts(compared(&[1.0], found(&[], 0.1))), (1, 0, 0, 1), "crossing");
        let hit = found(&[(0, 2)], 0.0);
        assert_eq!(counts(compared(&[1.25 + 1e-6], hit.clone())), (1, 0, 1, 0), "a narrow gap");
        let wide = compared(&[1.26], hit);
        assert!(wide.differences[0].contains("room and ball are Some(0.01"), "{wide:?}");
    }
}
