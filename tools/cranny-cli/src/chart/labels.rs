//! Names of marks: inside the frame, clear of all marks and of each other.
//!
//! One name after another takes the cheapest free place about its mark. A name that does not stand
//! beside its mark has a line that leads to it.

/// A pixel.
pub(crate) type Pixel = (i32, i32);

/// The two ends of a line.
pub(crate) type Segment = [Pixel; 2];

/// Pixels of a letter of [`LABEL`](super::LABEL), at most on average, and of a line of text.
const LETTER: i32 = 7;
pub(crate) const LINE: i32 = 14;

/// Pixels between a mark and a name beside it.
const GAP: i32 = 3;

/// Pixels from one place that is tried to the next. Larger: narrow room is not found; smaller: full
/// charts take longer.
const STRIDE: i32 = 4;

/// A name farther than this from its mark has a line that leads to it.
const BESIDE: f64 = 8.0;

/// What crossing a line of the chart costs, in pixels of distance.
const CROSSING: f64 = 12.0;

/// What it costs that a line to a name crosses something, in pixels of distance: more than any
/// detour.
const TANGLED: f64 = 2_000.0;

/// What it costs that a name has no place, in pixels of distance: more than anything else.
const LOST: f64 = 1e6;

/// Names of a crowd stand at least this far from their marks, in pixels: lines reach all of them.
const CLEAR: f64 = 20.0;

/// What it costs to stand nearer to another mark than to one's own, in pixels of distance.
const MISTAKABLE: f64 = 40.0;

/// A rectangle of pixels, without its right and lower edges.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Room {
    pub(crate) left: i32,
    pub(crate) top: i32,
    pub(crate) right: i32,
    pub(crate) bottom: i32,
}

impl Room {
    /// Of a mark about a pixel.
    pub(crate) fn of_mark((x, y): Pixel, radius: i32) -> Self {
        let (left, top) = (x - radius, y - radius);
        Self { left, top, right: x + radius + 1, bottom: y + radius + 1 }
    }

    fn of_name((left, top): Pixel, name: &str) -> Self {
        Self { left, top, right: left + width(name), bottom: top + LINE }
    }

    fn overlaps(&self, other: &Self) -> bool {
        self.left < other.right
            && other.left < self.right
            && self.top < other.bottom
            && other.top < self.bottom
    }

    fn holds(&self, other: &Self) -> bool {
        self.left <= other.left
            && self.top <= other.top
            && other.right <= self.right
            && other.bottom <= self.bottom
    }

    /// The pixel nearest to another.
    fn nearest(&self, (x, y): Pixel) -> Pixel {
        (x.clamp(self.left, self.right - 1), y.clamp(self.top, self.bottom - 1))
    }

    /// Returns whether a line passes through (after Liang and Barsky, 1984).
    fn meets(&self, [(x, y), (u, v)]: Segment) -> bool {
        let (mut enter, mut leave) = (0.0f64, 1.0f64);
        let (dx, dy) = (f64::from(u - x), f64::from(v - y));
        let sides = [
            (-dx, x - self.left),
            (dx, self.right - 1 - x),
            (-dy, y - self.top),
            (dy, self.bottom - 1 - y),
        ];
        for (speed, room) in sides {
            let room = f64::from(room);
            if speed == 0.0 {
                if room < 0.0 {
                    return false;
                }
            } else if speed < 0.0 {
                enter = enter.max(room / speed);
            } else {
                leave = leave.min(room / speed);
            }
        }
        enter <= leave
    }
}

/// Where a name stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Placing {
    pub(crate) room: Room,
    /// From the mark's middle to the name, where it does not stand beside its mark.
    pub(crate) leader: Option<Segment>,
}

/// A chart with its marks, and the names that stand in it so far.
pub(crate) struct Field {
    frame: Room,
    marks: Vec<Room>,
    /// Better not written over.
    lines: Vec<Segment>,
    /// No name is farther from its mark, in pixels.
    reach: f64,
    placed: Vec<Placing>,
}

impl Field {
    pub(crate) fn new(frame: Room, marks: Vec<Room>, lines: Vec<Segment>, reach: f64) -> Self {
        Self { frame, marks, lines, reach, placed: Vec::new() }
    }

    /// Finds places for the names of all marks, all of which are about pixels and of one radius:
    /// beside them, or, where those close a mark in, farther out.
    pub(crate) fn place_all(
        &mut self,
        radius: i32,
        names: &[(Pixel, &str)],
    ) -> Vec<Option<Placing>> {
        let before = self.placed.len();
        let mut tried = [0.0, CLEAR].map(|clearance| {
            self.placed.truncate(before);
            let place = |&(at, name): &(Pixel, &str)| self.found(at, radius, name, clearance);
            let all: Vec<Option<(Placing, f64)>> = names.iter().map(place).collect();
            let cost = all.iter().map(|one| one.map_or(LOST, |(_, cost)| cost)).sum::<f64>();
            (cost, all)
        });
        tried.sort_by(|a, b| a.0.total_cmp(&b.0));
        let [(_, best), _] = tried;
        let best: Vec<Option<Placing>> =
            best.into_iter().map(|one| one.map(|(placing, _)| placing)).collect();
        self.placed.truncate(before);
        self.placed.extend(best.iter().flatten());
        best
    }

    /// Finds a place for the name of the mark about a pixel, and takes it. `None`: there is none
    /// within reach.
    pub(crate) fn place(&mut self, at: Pixel, radius: i32, name: &str) -> Option<Placing> {
        self.found(at, radius, name, 0.0).map(|(placing, _)| placing)
    }

    /// The same with the cost; no nearer to the mark than `clearance`.
    fn found(
        &mut self,
        at: Pixel,
        radius: i32,
        name: &str,
        clearance: f64,
    ) -> Option<(Placing, f64)> {
        let mark = Room::of_mark(at, radius);
        let free = |room: &Room| {
            self.frame.holds(room)
                && between(room, &mark) >= clearance
                && !self.marks.iter().any(|other| room.overlaps(other))
                && !room.overlaps(&mark)
                && !self.placed.iter().any(|other| room.overlaps(&other.room))
        };
        let found = self
            .places(&mark, name)
            .filter(|(room, _)| free(room))
            .filter_map(|(room, cost)| self.tried(&mark, at, room, cost))
            .min_by(|(_, a), (_, b)| a.total_cmp(b))?;
        self.placed.push(found.0);
        Some(found)
    }

    /// Sides and corners of the mark, then a grid, each with what it costs to stand just there: of
    /// equal costs the first counts.
    fn places(&self, mark: &Room, name: &str) -> impl Iterator<Item = (Room, f64)> + use<> {
        let (right, left) = (mark.right + GAP, mark.left - GAP - width(name));
        let (above, below) = (mark.top - LINE + GAP, mark.bottom - GAP);
        let middle = |low: i32, high: i32, size: i32| (low + high - size) / 2;
        let across = middle(mark.left, mark.right, width(name));
        let level = middle(mark.top, mark.bottom, LINE);
        let beside = [
            (right, level),
            (right, above),
            (right, below),
            (left, level),
            (left, above),
            (left, below),
            (across, mark.top - GAP - LINE),
            (across, mark.bottom + GAP),
        ];
        let Room { left, top, right, bottom } = self.frame;
        let grid = (top..bottom)
            .step_by(STRIDE as usize)
            .flat_map(move |y| (left..right).step_by(STRIDE as usize).map(move |x| (x, y)));
        let name = name.to_owned();
        let beside = beside.into_iter().map(|corner| (corner, 0.0));
        let all = beside.chain(grid.map(|corner| (corner, BESIDE)));
        all.map(move |(corner, cost)| (Room::of_name(corner, &name), cost))
    }

    /// A place within reach with its whole cost.
    fn tried(&self, mark: &Room, at: Pixel, room: Room, mut cost: f64) -> Option<(Placing, f64)> {
        let distance = between(mark, &room);
        if distance > self.reach {
            return None;
        }
        let crossed = self.lines.iter().filter(|line| room.meets(**line)).count();
        cost += distance + CROSSING * crossed as f64;
        let others = || self.marks.iter().filter(|other| !other.overlaps(mark));
        let leader = (distance > BESIDE).then(|| [at, room.nearest(at)]);
        let tangled = match leader {
            Some(leader) => {
                others().filter(|other| other.meets(leader)).count()
                    + self.placed.iter().filter(|other| other.room.meets(leader)).count()
            }
            None => {
                if others().any(|other| between(other, &room) <= distance) {
                    cost += MISTAKABLE;
                }
                0
            }
        };
        let leaders = self.placed.iter().filter_map(|other| other.leader);
        let covered = leaders.filter(|other| room.meets(*other)).count();
        cost += TANGLED * (tangled + covered) as f64;
        Some((Placing { room, leader }, cost))
    }
}

fn width(name: &str) -> i32 {
    LETTER * name.chars().count() as i32
}

/// The distance of two rectangles; 0 where they overlap.
fn between(a: &Room, b: &Room) -> f64 {
    let gap = |low: i32, high: i32| f64::from((low - high).max(0));
    let x = gap(a.left, b.right).max(gap(b.left, a.right));
    let y = gap(a.top, b.bottom).max(gap(b.top, a.bottom));
    x.hypot(y)
}

#[cfg(test)]
mod tests {
    use super::*;

    const FRAME: Room = Room { left: 80, top: 40, right: 740, bottom: 330 };
    const RADIUS: i32 = 5;
    const NAMES: [&str; 8] = [
        "cranny",
        "rapier-trimesh",
        "rapier-trimesh-fixed",
        "rapier-decomposition",
        "rapier-boxes",
        "rapier-hulls",
        "rapier-tree",
        "rapier-decomposition, not recycled",
    ];

    /// All names, or a panic: each has a place, and none covers another, a mark or the border.
    fn placed(marks: &[Pixel]) -> Vec<Placing> {
        let rooms: Vec<Room> = marks.iter().map(|at| Room::of_mark(*at, RADIUS)).collect();
        let mut field = Field::new(FRAME, rooms.clone(), Vec::new(), f64::INFINITY);
        let names: Vec<(Pixel, &str)> =
            marks.iter().copied().zip(NAMES.iter().copied().cycle()).collect();
        let all: Vec<Placing> =
            field.place_all(RADIUS, &names).into_iter().map(Option::unwrap).collect();
        assert_eq!(field.placed, all);
        for (i, (placing, at)) in all.iter().zip(marks).enumerate() {
            let Placing { room, leader } = placing;
            let apart = |other: &Room| {
                room.right <= other.left
                    || other.right <= room.left
                    || room.bottom <= other.top
                    || other.bottom <= room.top
            };
            assert_eq!(room.right - room.left, LETTER * NAMES[i % 8].len() as i32);
            assert!(room.left >= 80 && room.right <= 740, "{room:?}");
            assert!(room.top >= 40 && room.bottom <= 330, "{room:?}");
            assert!(all[..i].iter().all(|other| apart(&other.room)), "{i}: {all:?}");
            assert!(rooms.iter().all(apart), "{i}: {placing:?} on one of {rooms:?}");
            match leader {
                Some([from, to]) => {
                    assert_eq!(from, at);
                    let on_edge = (room.left..room.right).contains(&to.0)
                        && (room.top..room.bottom).contains(&to.1);
                    assert!(on_edge, "{placing:?}");
                }
                None => assert!(between(&rooms[i], room) <= BESIDE, "{placing:?} of {at:?}"),
            }
        }
        all
    }

    #[test]
    fn a_name_stands_on_the_right_of_a_lonely_mark() {
        let [Placing { room, leader }] = placed(&[(300, 200)])[..] else { panic!("one") };
        assert_eq!((room.left, room.top, leader), (309, 193, None));
    }

    #[test]
    fn marks_in_one_place_have_names_apart_with_leaders() {
        let all = placed(&[(400, 200); 8]);
        assert!(all.iter().any(|placing| placing.leader.is_some()), "{all:?}");
    }

    #[test]
    fn names_stay_inside_at_the_border_and_in_corners() {
        for x in [80, 81, 410, 739] {
            for y in [40, 41, 185, 329] {
                placed(&[(x, y); 8]);
                placed(&[(x, y)]);
            }
        }
    }

    #[test]
    fn names_of_crowds_keep_apart() {
        // Rows and columns that are denser than letters are high.
        placed(&(0..8).map(|i| (700 + 5 * i, 60)).collect::<Vec<_>>());
        placed(&(0..8).map(|i| (735, 60 + 4 * i)).collect::<Vec<_>>());
        // Clusters of all sizes, everywhere.
        let mut state = 1u64;
        let mut random = |below: i32| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            ((state >> 33) % below as u64) as i32
        };
        for _ in 0..60 {
            let (w, h) = (1 + random(300), 1 + random(120));
            let (x, y) = (80 + random(660 - w), 40 + random(290 - h));
            let marks: Vec<Pixel> = (0..12).map(|_| (x + random(w), y + random(h))).collect();
            placed(&marks);
        }
    }

    #[test]
    fn leaders_go_round_names() {
        let row: Vec<Pixel> = (0..8).map(|i| (660 + 3 * i, 60)).collect();
        let cluster = vec![(400, 200), (402, 203), (398, 196), (405, 200), (395, 200), (400, 208)];
        for marks in [vec![(400, 200); 8], row, cluster] {
            let all = placed(&marks);
            for (i, one) in all.iter().enumerate() {
                let Some(leader) = one.leader else { continue };
                for other in all[..i].iter().chain(&all[i + 1..]) {
                    assert!(!other.room.meets(leader), "{one:?} through {other:?}");
                }
            }
        }
    }

    #[test]
    fn a_name_without_room_within_reach_is_left_out() {
        let mark = || vec![Room::of_mark((100, 100), RADIUS)];
        let narrow = Room { left: 80, top: 80, right: 120, bottom: 120 };
        let mut field = Field::new(narrow, mark(), Vec::new(), f64::INFINITY);
        assert_eq!(field.place((100, 100), RADIUS, "rapier-boxes"), None);
        let mut field = Field::new(FRAME, vec![Room::of_mark((400, 200), 60)], Vec::new(), 20.0);
        assert_eq!(field.place((400, 200), RADIUS, "x"), None);
        assert!(field.place((400, 120), RADIUS, "x").is_some());
    }

    #[test]
    fn names_keep_off_lines_where_there_is_room_beside() {
        let line = [(200, 200), (600, 200)];
        let rooms = vec![Room::of_mark((400, 200), RADIUS)];
        let mut field = Field::new(FRAME, rooms, vec![line], 20.0);
        let Placing { room, leader } = field.place((400, 200), RADIUS, "exact").unwrap();
        assert!(!room.meets(line) && leader.is_none(), "{room:?}");
        assert!(Room::of_name((400, 195), "exact").meets(line));
        assert!(Room::of_name((198, 198), "exact").meets([(190, 190), (210, 210)]));
        assert!(!Room::of_name((198, 198), "exact").meets([(190, 190), (196, 196)]));
        assert!(!Room::of_name((198, 198), "exact").meets([(190, 205), (190, 290)]));
    }
}
