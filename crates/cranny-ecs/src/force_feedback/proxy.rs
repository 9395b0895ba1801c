//! What a hand feels: a proxy of the body that it moves stays out of all others, and pulls.
//!
//! The proxy is Zilles and Salisbury's god object (1995) in six degrees of freedom (Ortega, Redon
//! and Coquillart, 2007). In each tick it goes as near to the body as the contacts around it allow:
//! a spring between the two is what the hand feels. Where the proxy is, contacts are found exactly
//! on the meshes, and no move ends where bodies overlap.
//!
//! What it feels may not jump, or the hand is kicked. On a face the spring changes no faster than
//! the body moves. Where the proxy slips off an edge or out of a groove, it would catch up at once;
//! instead it catches up along its way by as much as keeps the change of the spring within
//! [`JUMP`] times that of the body.

use std::collections::BTreeMap;

use cranny_exact::{DVec3, Pose};
use cranny_impact::Motion;
use cranny_narrow_phase::{Demand, PairMemory, Placed, Query, QueryError, query};
use cranny_world::BodyId;

use super::constraints::{Constraint, Twist, dot, nearest_allowed, scaled};

/// By how much a tick changes the spring, as a multiple of what body and obstacles move in it.
/// Larger: edges are kicks; less than 1: what the hand presses on seems to yield.
const JUMP: f64 = 1.5;

/// The gap that the proxy keeps, as a share of the body's radius. Smaller: rounding of a slide
/// along a face ends within it; larger: the hand feels a face before it is there.
const SKIN: f64 = 1e-3;

/// How far the proxy goes between two looks at the contacts around it, as a share of the body's
/// radius. Larger: contacts of a whole neighbourhood are looked at; smaller: a fast hand is
/// followed by more queries.
const REACH: f64 = 0.02;

/// How often a tick looks at most. More: a fast hand costs more; fewer: the proxy falls behind.
const LOOKS: usize = 8;

/// How often a move that ends in an overlap is looked for anew. More: a tick in a tight place takes
/// longer; fewer: the proxy sticks where it could go on.
const ATTEMPTS: usize = 6;

/// How often a move that still ends in an overlap is halved before it is given up.
const HALVINGS: usize = 6;

/// The share of [`REACH`] below which a move is none.
const STILL: f64 = 1e-6;

/// How often the share of a move that keeps the spring from jumping is halved to find it.
const BISECTIONS: usize = 30;

/// A force and a torque.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wrench {
    /// On the body, at its centre of mass, world axes: stiffness x length.
    pub force: DVec3,
    /// About its centre of mass: stiffness x length².
    pub torque: DVec3,
}

/// A body that is felt.
#[derive(Clone, Copy, Debug)]
pub struct Obstacle<'a> {
    /// Names it from tick to tick.
    pub id: BodyId,
    /// Its model, and where it is.
    pub placed: Placed<'a>,
}

/// A body that somebody moves, as it would be if it could not enter others.
///
/// ```
/// use cranny_ecs::{Obstacle, Proxy};
/// use cranny_exact::{DVec3, Pose};
/// use cranny_geometry::{BuildOptions, Model};
/// use cranny_narrow_phase::Placed;
/// use cranny_shapes::Cuboid;
/// use cranny_world::BodyId;
///
/// let (cube, _) = Model::build(Cuboid { size: [1.0; 3] }.build()?, &BuildOptions::default())?;
/// let up = |z| Placed { model: &cube, pose: Pose::at(DVec3::new(0.0, 0.0, z)) };
/// let floor = [Obstacle { id: BodyId(0), placed: up(0.0) }];
/// let mut proxy = Proxy::at(up(1.1).pose);
/// let (mut wrench, stiffness) = (Default::default(), 1000.0);
/// for tick in 0..200 {
///     let pushed = up(1.1 - 0.001 * f64::from(tick)); // into the floor by a tenth
///     wrench = proxy.follow(pushed, &floor, stiffness).map_err(|(_, error)| error)?;
/// }
/// assert!((wrench.force.z - 100.0).abs() < 2.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Proxy {
    pose: Pose,
    body: Pose,
    seen: BTreeMap<BodyId, Seen>,
}

/// What is known of an obstacle.
#[derive(Clone, Debug)]
struct Seen {
    pose: Pose,
    memory: PairMemory,
}

/// What does not change in a tick.
struct Tick<'a> {
    body: Placed<'a>,
    obstacles: &'a [Obstacle<'a>],
    /// The body's centre of mass, in its frame.
    center: DVec3,
    /// By which a rotation is a length: half of the body's radius.
    arm: f64,
    reach: f64,
    skin: f64,
}

impl Proxy {
    /// Where the body is: what it overlaps there it feels once it has come out.
    #[must_use]
    pub fn at(pose: Pose) -> Self {
        Self { pose, body: pose, seen: BTreeMap::new() }
    }

    /// Where the proxy is.
    #[must_use]
    pub fn pose(&self) -> Pose {
        self.pose
    }

    /// How far the proxy's origin is from the body's.
    pub(super) fn lag(&self, body: Pose) -> f64 {
        self.pose.translation.distance(body.translation)
    }

    /// Lets the proxy follow the body, once a tick, among obstacles near both; returns what the
    /// body feels. From tick to tick its force changes by at most `stiffness` x 1.5 x what the body
    /// moves, and obstacles near it do (a rotation counts by half the body's radius); force and
    /// torque over that length change by no more together. That holds as long as proxy and body are
    /// turned against each other by less than 2 radians: at half a turn the torque changes sides.
    ///
    /// # Errors
    ///
    /// The obstacle and [`QueryError`] where a pose is invalid; the proxy is where it was then, or
    /// nearer to the body.
    pub fn follow(
        &mut self,
        body: Placed<'_>,
        obstacles: &[Obstacle<'_>],
        stiffness: f64,
    ) -> Result<Wrench, (BodyId, QueryError)> {
        let radius = body.model.radius();
        let center = body.model.mass_properties().map_or(DVec3::ZERO, |mass| mass.center);
        let (reach, skin, arm) = (REACH * radius, SKIN * radius, 0.5 * radius);
        let tick = Tick { body, obstacles, center, arm, reach, skin };
        let allowed = JUMP * self.moved(&tick);
        let before = tick.twist(self.body, self.pose);
        self.body = body.pose;
        self.seen.retain(|id, _| obstacles.iter().any(|o| o.id == *id));
        for _ in 0..LOOKS {
            let step = self.step(&tick, &before, allowed)?;
            if dot(&step, &step).sqrt() < STILL * reach {
                break;
            }
        }
        for obstacle in obstacles {
            self.known(obstacle).pose = obstacle.placed.pose;
        }
        let spring = tick.twist(body.pose, self.pose);
        let [force, rotation] = halves(&scaled(&spring, stiffness));
        Ok(Wrench { force, torque: arm * rotation })
    }

    fn known(&mut self, obstacle: &Obstacle<'_>) -> &mut Seen {
        let pose = obstacle.placed.pose;
        self.seen.entry(obstacle.id).or_insert_with(|| Seen { pose, memory: PairMemory::default() })
    }

    /// How far body and obstacles have moved since the last tick: the body's twist, and of the
    /// obstacle that moved farthest that of its material at the proxy.
    fn moved(&self, tick: &Tick<'_>) -> f64 {
        let own = tick.twist(self.body, tick.body.pose);
        let at = self.pose.world_from_body().apply(tick.center);
        let of_obstacles = tick.obstacles.iter().filter_map(|obstacle| {
            let (from, to) = (self.seen.get(&obstacle.id)?.pose, obstacle.placed.pose);
            let pivot = from.world_from_body().inverse().apply(at);
            let motion = Motion::between(from, to, pivot);
            Some(motion.travel.length().hypot(tick.arm * motion.turn.length()))
        });
        dot(&own, &own).sqrt() + of_obstacles.fold(0.0, f64::max)
    }

    /// One move towards the body; returns what was moved.
    ///
    /// Contacts for a solver are few, and a body may tip about two of them onto a corner that has
    /// none: what a move meets is a constraint of the next attempt.
    fn step(
        &mut self,
        tick: &Tick<'_>,
        before: &Twist,
        allowed: f64,
    ) -> Result<Twist, (BodyId, QueryError)> {
        let mut constraints = self.constraints(tick, &[0.0; 6])?;
        let overlaps = constraints.iter().any(|constraint| constraint.least > tick.skin);
        let wanted = tick.twist(self.pose, tick.body.pose);
        let mut way = [0.0; 6];
        for _ in 0..ATTEMPTS {
            way = nearest_allowed(&wanted, &constraints);
            let length = dot(&way, &way).sqrt();
            way = scaled(&way, (tick.reach / length).min(1.0));
            way = scaled(&way, self.share_without_jump(tick, &way, before, allowed));
            if overlaps {
                self.pose = tick.moved(self.pose, &way);
                return Ok(way);
            }
            if self.moves_freely(tick, &way)? {
                return Ok(way);
            }
            constraints.extend(self.constraints(tick, &way)?);
        }
        for _ in 0..HALVINGS {
            way = scaled(&way, 0.5);
            if self.moves_freely(tick, &way)? {
                return Ok(way);
            }
        }
        Ok([0.0; 6])
    }

    /// Moves, unless that ends in an overlap.
    fn moves_freely(&mut self, tick: &Tick<'_>, way: &Twist) -> Result<bool, (BodyId, QueryError)> {
        let pose = tick.moved(self.pose, way);
        let free = self.is_free(tick, pose)?;
        if free {
            self.pose = pose;
        }
        Ok(free)
    }

    /// The greatest share of a move up to which the spring has changed by no more than is allowed.
    fn share_without_jump(
        &self,
        tick: &Tick<'_>,
        way: &Twist,
        before: &Twist,
        allowed: f64,
    ) -> f64 {
        let changed = |share: f64| {
            let pose = tick.moved(self.pose, &scaled(way, share));
            let spring = tick.twist(tick.body.pose, pose);
            let change: Twist = std::array::from_fn(|i| spring[i] - before[i]);
            dot(&change, &change).sqrt()
        };
        if changed(1.0) <= allowed {
            return 1.0;
        }
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (low + high);
            if changed(middle) <= allowed { low = middle } else { high = middle }
        }
        low
    }

    /// What the contacts around the proxy allow, as they are after a twist.
    fn constraints(
        &mut self,
        tick: &Tick<'_>,
        after: &Twist,
    ) -> Result<Vec<Constraint>, (BodyId, QueryError)> {
        let proxy = Placed { pose: tick.moved(self.pose, after), ..tick.body };
        let center = proxy.pose.world_from_body().apply(tick.center);
        // A point of the body moves by at most so much: radius / arm is 2.
        let ask = Query::of(Demand::contacts(3.0 * tick.reach + tick.skin));
        let mut found = Vec::new();
        for obstacle in tick.obstacles {
            let memory = &mut self.known(obstacle).memory;
            let answer =
                query(obstacle.placed, proxy, &ask, memory).map_err(|e| (obstacle.id, e))?;
            found.extend(answer.contacts.iter().map(|contact| {
                let turning = (contact.point_b - center).cross(contact.normal) / tick.arm;
                let along = joined(contact.normal, turning);
                let least = tick.skin - contact.separation + dot(&along, after);
                Constraint { along, least }
            }));
        }
        Ok(found)
    }

    /// Whether the proxy overlaps nothing at a pose.
    fn is_free(&mut self, tick: &Tick<'_>, pose: Pose) -> Result<bool, (BodyId, QueryError)> {
        let (proxy, ask) = (Placed { pose, ..tick.body }, Query::of(Demand::Intersects));
        for obstacle in tick.obstacles {
            let memory = &mut self.known(obstacle).memory;
            let answer = query(obstacle.placed, proxy, &ask, memory);
            if answer.map_err(|e| (obstacle.id, e))?.touches() {
                return Ok(false);
            }
        }
        Ok(true)
    }
}

impl Tick<'_> {
    /// From one pose of the body to another.
    fn twist(&self, from: Pose, to: Pose) -> Twist {
        let motion = Motion::between(from, to, self.center);
        joined(motion.travel, self.arm * motion.turn)
    }

    /// A pose after a twist.
    fn moved(&self, from: Pose, twist: &Twist) -> Pose {
        let [travel, turn] = halves(twist);
        let turn = turn / self.arm;
        Motion { start: from, pivot: self.center, turn, travel }.pose_at(1.0)
    }
}

fn joined(linear: DVec3, angular: DVec3) -> Twist {
    let ([a, b, c], [d, e, f]) = (linear.to_array(), angular.to_array());
    [a, b, c, d, e, f]
}

fn halves(twist: &Twist) -> [DVec3; 2] {
    let [a, b, c, d, e, f] = *twist;
    [DVec3::new(a, b, c), DVec3::new(d, e, f)]
}
