//! The picture of `cranny query --heat`: what the search of the last pose compares, painted on
//! both meshes, each by itself and seen from the side of the other.

use std::path::Path;
use std::sync::Arc;

use cranny_exact::{DVec3, Pose};
use cranny_geometry::{Mesh, Model};
use cranny_narrow_phase::{
    Answer, PairMemory, Placed, Query, QueryError, SearchHeat, query, query_observed,
};
use cranny_render::palette::COLD;
use cranny_render::{Color, DrawList, DrawMesh, DrawMeshError, Instance, Key, Mark, Ramp, Style};

use crate::picture::{self, Drawing, PictureView, Trouble};
use crate::pose_file::PosePair;
use crate::words::counted;

/// Poses before the last that memory goes through at most. Fewer: what motion has spent is not yet
/// what it mostly is; more: nothing changes but the time.
const POSES_BEFORE: usize = 12;

/// A query, with its models and poses.
pub(super) struct Searched<'a> {
    pub(super) models: [&'a Model; 2],
    pub(super) names: [String; 2],
    pub(super) question: Query,
    /// Ascending; the last is the one that is painted.
    pub(super) poses: &'a [PosePair],
    /// Whether everything is forgotten between one pose and the next.
    pub(super) cold: bool,
}

/// What a search found, and what it compared for that.
struct Observed<'a> {
    answer: Answer,
    heat: SearchHeat<'a>,
    /// Poses that memory went through before.
    before: usize,
}

impl<'a> Searched<'a> {
    /// Draws the picture and writes it as PNG: whole, or not at all.
    pub(super) fn draw(&self, path: &Path) -> Result<(), Trouble> {
        let failed = |error: QueryError| {
            Trouble::Failed(crate::failure::Failure::input(format!("the last pose: {error}")))
        };
        let Some(observed) = self.observed().map_err(failed)? else { return Ok(()) };
        picture::draw(path, || self.drawing(&observed))
    }

    /// Repeats the query under observation; `None` where there are no poses.
    fn observed(&self) -> Result<Option<Observed<'a>>, QueryError> {
        let Some((&last, earlier)) = self.poses.split_last() else { return Ok(None) };
        let before = if self.cold { 0 } else { earlier.len().min(POSES_BEFORE) };
        let [a, b] = self.models;
        let placed = |poses: PosePair| {
            [Placed { model: a, pose: poses[0] }, Placed { model: b, pose: poses[1] }]
        };
        let mut memory = PairMemory::default();
        for &poses in &earlier[earlier.len() - before..] {
            let [a, b] = placed(poses);
            query(a, b, &self.question, &mut memory)?;
        }
        let mut heat = SearchHeat::of(self.models);
        let [a, b] = placed(last);
        let answer = query_observed(a, b, &self.question, &mut memory, &mut heat)?;
        Ok(Some(Observed { answer, heat, before }))
    }

    fn drawing(&self, observed: &Observed<'_>) -> Result<Drawing, DrawMeshError> {
        let Observed { answer, heat, before } = observed;
        let times = [0, 1].map(|body| heat.looked_at(body));
        let most = times.iter().flatten().copied().max().unwrap_or(0);
        let poses = self.poses.last().copied().unwrap_or([Pose::IDENTITY; 2]);
        let a_to_b = self.direction(answer, poses);
        let mut views = Vec::new();
        for (body, toward) in [(0, a_to_b), (1, -a_to_b)] {
            let mut list = DrawList::new();
            let instances = painted(self.models[body].mesh(), &times[body], most, poses[body]);
            list.instances.extend(instances?);
            let title = format!("{}, seen from the other", self.names[body]);
            views.push(PictureView { list, title, from: toward });
        }
        let work = answer.counters;
        let mut keys = vec![Key::new(Mark::Body(COLD), "not looked at: seen through")];
        if most > 0 {
            keys.push(Key::new(
                Mark::Ramp(Ramp::Heat),
                format!(
                    "compared 1 to {most} times (logarithmic): the face, its cluster of at most \
                     eight, or the box of that"
                ),
            ));
        }
        let memory = match before {
            0 => "from nothing".to_owned(),
            &before => format!("with what {} before have left", counted(before, "pose")),
        };
        let caption = format!(
            "pose {}, {memory}: {} pairs of boxes, {} of clusters, {} of faces or features",
            self.poses.len() - 1,
            work.node_tests + work.front_tested,
            work.cluster_tests,
            work.triangle_tests
        );
        let title = format!("{} and {}: heat of the search", self.names[0], self.names[1]);
        Ok(Drawing { views, title, keys, caption: vec![caption] })
    }

    /// From A to B where they meet or are nearest, or else from middle to middle.
    fn direction(&self, answer: &Answer, poses: PosePair) -> DVec3 {
        let deepest = answer.regions.iter().max_by(|p, q| {
            let depth = |region: &cranny_narrow_phase::Region| region.depth.unwrap_or(0.0);
            depth(p).total_cmp(&depth(q))
        });
        let nearest = answer.witnesses.map(|[p, q]| q.point - p.point);
        let middles = [0, 1]
            .map(|body| poses[body].world_from_body().apply(self.models[body].bounds().center()));
        let directions = [deepest.map(|region| region.normal), nearest];
        let directions = directions.into_iter().flatten().chain([middles[1] - middles[0]]);
        directions.filter_map(DVec3::try_normalize).next().unwrap_or(DVec3::NEG_Y)
    }
}

/// A mesh of which faces were compared so often: those that were not are seen through, so that
/// they hide nothing.
fn painted(
    mesh: &Mesh,
    times: &[u64],
    most: u64,
    pose: Pose,
) -> Result<Vec<Instance>, DrawMeshError> {
    let of = |is_cold: bool| {
        let chosen = mesh.faces().iter().zip(times).filter(|(_, times)| (**times == 0) == is_cold);
        let color = |times: u64| Ramp::Heat.color_of_count(times, most);
        let (faces, colors): (Vec<_>, Vec<_>) =
            chosen.map(|(face, &times)| (*face, color(times))).unzip();
        let style = if is_cold { Style::XRay } else { Style::Solid };
        let drawn = DrawMesh::with_face_colors(mesh.vertices(), &faces, &colors)?;
        Ok(Instance { style, ..Instance::solid(Arc::new(drawn), pose, Color::WHITE) })
    };
    let both = [true, false].map(of).into_iter().collect::<Result<Vec<_>, _>>()?;
    Ok(both.into_iter().filter(|instance| instance.mesh.triangle_count() > 0).collect())
}

#[cfg(test)]
mod tests {
    use cranny_geometry::BuildOptions;
    use cranny_narrow_phase::Demand;
    use cranny_shapes::Torus;

    use super::*;

    fn ring() -> Model {
        let ring = Torus { major_segments: 24, minor_segments: 8, ..Torus::default() };
        Model::build(ring.build().unwrap(), &BuildOptions::default()).unwrap().0
    }

    fn searched<'a>(models: [&'a Model; 2], poses: &'a [PosePair], cold: bool) -> Searched<'a> {
        let question = Query::of(Demand::Distance { below: None });
        let names = ["a", "b"].map(str::to_owned);
        Searched { models, names, question, poses, cold }
    }

    #[test]
    fn each_mesh_is_seen_from_the_side_of_the_other() {
        let models = [ring(), ring()];
        let poses = [[Pose::IDENTITY, Pose::at(DVec3::new(3.0, 0.0, 0.0))]];
        let searched = searched(models.each_ref(), &poses, false);
        let observed = searched.observed().unwrap().unwrap();
        let drawing = searched.drawing(&observed).unwrap();
        let [a, b] = &drawing.views[..] else { panic!("two meshes") };
        assert!(a.from.x > 0.99 && b.from.x < -0.99, "{:?} {:?}", a.from, b.from);
        for (body, view) in drawing.views.iter().enumerate() {
            let [cold, hot] = &view.list.instances[..] else { panic!("both kinds of faces") };
            let looked_at = observed.heat.looked_at(body).iter().filter(|&&t| t > 0).count();
            assert_eq!(hot.mesh.triangle_count(), looked_at);
            assert_eq!(cold.mesh.triangle_count() + looked_at, 2 * 24 * 8);
            assert!(cold.style == Style::XRay && hot.style == Style::Solid);
        }
        let middle = b.list.bounds().center();
        assert!((middle - DVec3::new(3.0, 0.0, 0.0)).length() < 1e-9, "{middle}");
        assert_eq!(drawing.keys.len(), 2);
        assert!(drawing.caption[0].starts_with("pose 0, from nothing: "), "{:?}", drawing.caption);
    }

    #[test]
    fn what_memory_keeps_is_not_compared_again() {
        let models = [ring(), ring()];
        let at = |x: f64| [Pose::IDENTITY, Pose::at(DVec3::new(x, 0.0, 0.0))];
        let poses: Vec<PosePair> = (0..20).map(|i| at(2.3 - 1e-6 * f64::from(i))).collect();
        let looked_at = |cold| {
            let mut searched = searched(models.each_ref(), &poses, cold);
            searched.question = Query::of(Demand::contacts(0.0));
            let observed = searched.observed().unwrap().unwrap();
            let drawing = searched.drawing(&observed).unwrap();
            (observed.heat.looked_at(0).iter().sum::<u64>(), drawing.caption)
        };
        let ((cold, alone), (warm, after)) = (looked_at(true), looked_at(false));
        assert!(warm < cold, "{warm} of {cold}");
        assert!(alone[0].starts_with("pose 19, from nothing: "), "{alone:?}");
        assert!(
            after[0].starts_with("pose 19, with what 12 poses before have left: "),
            "{after:?}"
        );
        assert!(searched(models.each_ref(), &[], false).observed().unwrap().is_none());
    }
}
