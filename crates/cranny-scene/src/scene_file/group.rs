//! Bodies made by rule, clear of what stands there.

use std::sync::Arc;

use cranny_exact::{Aabb, DVec3, Pose};
use cranny_primitives::BodyShape;
use cranny_world::description::{BodyDescription, StatedMass};
use cranny_world::world_box;

use super::assemble::Assembly;
use super::geometry::CollisionGeometry;
use super::locate;
use super::obstacles::{Obstacles, Standing, prepared};
use super::pile::{self, Piece};
use super::problem::{SceneError, SceneProblem};
use super::syntax::{GridFile, GroupFile, PieceFile, PileFile, effects};
use crate::robot::LinkModels;

/// What the bodies of a group are made of.
struct Stock {
    shapes: Vec<CollisionGeometry>,
    masses: Vec<Option<StatedMass>>,
    models: LinkModels,
}

impl Stock {
    /// What collides of each shape, prepared.
    fn prepared(&mut self, name: &str) -> Result<Vec<BodyShape>, String> {
        let Self { shapes, models, .. } = self;
        shapes.iter().map(|shape| prepared(shape, name, models)).collect()
    }
}

impl Assembly<'_> {
    pub(super) fn group(&mut self, group: &GroupFile) -> Result<(), SceneError> {
        match group {
            GroupFile::Pile(pile) => self.pile(pile, &group.pieces()),
            GroupFile::Grid(grid) => self.grid(grid, &group.pieces()),
        }
    }

    fn pile(&mut self, group: &PileFile, of: &PieceFile<'_>) -> Result<(), SceneError> {
        let region = Aabb { min: group.region.min.0, max: group.region.max.0 };
        if !region.min.cmplt(region.max).all() {
            let problem = "its region's min must lie below its max in x, y and z";
            return Err(self.refused_group(of, problem));
        }
        let mut stock = self.stock(of)?;
        let seed = group.seed.unwrap_or_else(|| self.description.seed.wrapping_add(self.piles));
        self.piles += 1;
        let pieces = self.piled(group, of, seed, &region, &mut stock);
        let pieces = pieces.map_err(|problem| self.refused_group(of, &problem))?;
        self.add_pieces(of, &stock, pieces);
        Ok(())
    }

    fn piled(
        &self,
        group: &PileFile,
        of: &PieceFile<'_>,
        seed: u64,
        region: &Aabb,
        stock: &mut Stock,
    ) -> Result<Vec<Piece>, String> {
        let bodies = &self.description.bodies;
        let mut obstacles = Obstacles::within(region, of.layers, bodies, &mut stock.models)?;
        let shapes = if obstacles.is_empty() { Vec::new() } else { stock.prepared(of.name)? };
        let meshes: Vec<_> = stock.shapes.iter().map(|shape| Arc::clone(&shape.mesh)).collect();
        let is_clear = |piece: &Piece| match shapes.get(piece.shape) {
            Some(shape) => Ok(obstacles.meeting(shape, &piece.pose)?.is_none()),
            None => Ok(true),
        };
        let placed =
            pile::place(group.count as usize, seed, region, group.gap.0, &meshes, is_clear);
        placed.map_err(|problem| match obstacles.listed() {
            Some(names) => format!("{problem}. In the way: {names}"),
            None => problem,
        })
    }

    fn grid(&mut self, group: &GridFile, of: &PieceFile<'_>) -> Result<(), SceneError> {
        let count = group.count.iter().map(|&n| u128::from(n)).product();
        pile::check_count(count).map_err(|problem| self.refused_group(of, &problem))?;
        let mut stock = self.stock(of)?;
        let first = self.pose(&format!("grid {:?}", of.name), group.pose);
        let placed = self.gridded(group, of, first, &mut stock);
        let (pieces, left_out) = placed.map_err(|problem| self.refused_group(of, &problem))?;
        self.warnings.extend(left_out.map(|left_out| format!("grid {:?}: {left_out}", of.name)));
        self.add_pieces(of, &stock, pieces);
        Ok(())
    }

    /// The pieces that are clear of what stands there, and what is to be known of the others.
    fn gridded(
        &self,
        group: &GridFile,
        of: &PieceFile<'_>,
        first: Pose,
        stock: &mut Stock,
    ) -> Result<(Vec<Piece>, Option<String>), String> {
        let shapes = stock.prepared(of.name)?;
        let places = places(group);
        let candidates: Vec<Piece> = (0..)
            .zip(places)
            .map(|(i, offset): (usize, DVec3)| Piece {
                shape: i % shapes.len(),
                pose: Pose { translation: first.translation + offset, ..first },
            })
            .collect();
        let bounds = |piece: &Piece| world_box(&shapes[piece.shape], &piece.pose, 0.0);
        let around = candidates.iter().fold(Aabb::EMPTY, |all, piece| all.union(&bounds(piece)));
        let bodies = &self.description.bodies;
        let mut obstacles = Obstacles::within(&around, of.layers, bodies, &mut stock.models)?;
        let (all, mut pieces) = (candidates.len(), Vec::new());
        for piece in candidates {
            if obstacles.meeting(&shapes[piece.shape], &piece.pose)?.is_none() {
                pieces.push(piece);
            }
        }
        let standing = pieces.iter().enumerate().map(|(i, piece)| Standing {
            name: of.name_of(i),
            shape: shapes[piece.shape].clone(),
            pose: piece.pose,
        });
        if let Some([a, b]) = Obstacles::of(standing.collect()).meeting_each_other()? {
            return Err(format!("its pieces {a:?} and {b:?} meet. Enlarge its spacing"));
        }
        let left_out = all - pieces.len();
        let why = obstacles.listed().map(|names| {
            format!("{left_out} of its {all} bodies are left out, since they would meet {names}. Move it, or what stands there")
        });
        Ok((pieces, why))
    }

    fn refused_group(&self, of: &PieceFile<'_>, problem: &str) -> SceneError {
        let problem = format!("{} {:?}: {problem}", of.rule.to_lowercase(), of.name);
        let place = self.source.find("name", of.name);
        let place = place.or_else(|| locate::find_unnamed(self.source.text, of.rule));
        self.source.error(place, SceneProblem::Contradiction(problem))
    }

    fn stock(&mut self, of: &PieceFile<'_>) -> Result<Stock, SceneError> {
        if of.shapes.is_empty() {
            let problem = "its `shapes` is empty, so there is nothing to make its bodies of. Name at least one, such as `shapes: [Generator(Cuboid())]`";
            return Err(self.refused_group(of, problem));
        }
        let shapes = of.shapes.iter().map(|shape| self.geometry(of.name, shape));
        let shapes = shapes.collect::<Result<Vec<_>, _>>()?;
        for shape in &shapes {
            self.check_primitive(of.name, shape, of.normals)?;
        }
        let masses =
            shapes.iter().map(|shape| self.mass(of.name, of.kind, shape, None, of.material));
        let masses = masses.collect::<Result<Vec<_>, _>>()?;
        Ok(Stock { shapes, masses, models: LinkModels::default() })
    }

    fn add_pieces(&mut self, of: &PieceFile<'_>, stock: &Stock, pieces: Vec<Piece>) {
        let body = |(i, piece): (usize, Piece)| BodyDescription {
            name: of.name_of(i),
            collision: Arc::clone(&stock.shapes[piece.shape].mesh),
            shape: stock.shapes[piece.shape].shape.clone(),
            visual: None,
            color: of.color,
            kind: of.kind,
            pose: piece.pose,
            linear_velocity: DVec3::ZERO,
            angular_velocity: DVec3::ZERO,
            path: None,
            tracker: None,
            material: of.material,
            mass: stock.masses[piece.shape],
            normals: of.normals,
            sensor: false,
            layers: of.layers.to_vec(),
            effects: effects(of.effects),
        };
        let first = self.description.bodies.len();
        self.description.bodies.extend(pieces.into_iter().enumerate().map(body));
        let members = (first..self.description.bodies.len()).collect();
        self.groups.insert(of.name.to_owned(), Ok(members));
    }
}

/// Where the pieces are from the first one, x first.
fn places(group: &GridFile) -> impl Iterator<Item = DVec3> {
    let ([nx, ny, nz], spacing) = (group.count, group.spacing.0);
    let rows = (0..nz).flat_map(move |z| (0..ny).map(move |y| (y, z)));
    rows.flat_map(move |(y, z)| {
        (0..nx).map(move |x| DVec3::new(f64::from(x), f64::from(y), f64::from(z)) * spacing)
    })
}
