//! Pictures of a page: PNG in the page itself.

use cranny_ecs::{PictureQuality, Replay, ReplayFrame, ScenePainter, ScenePainterView};
use cranny_render::{Renderer, RendererOptions};

use super::facts::Overlap;
use crate::failure::Failure;

/// A picture and what it shows.
pub(super) struct Picture {
    pub(super) png: Vec<u8>,
    pub(super) caption: String,
}

/// Of pictures in the strip: sharp at nearly twice the width that a page gives them.
const STRIP_SIZE: [u32; 2] = [640, 400];

/// Of close-ups: no larger than a page shows them, so that the words in them can be read.
const CLOSE_UP_SIZE: [u32; 2] = [560, 360];

/// Draws moments of a recording.
pub(super) struct Artist<'a> {
    replay: &'a Replay,
    renderer: Renderer,
}

impl<'a> Artist<'a> {
    pub(super) fn new(replay: &'a Replay) -> Result<Self, Failure> {
        let renderer = Renderer::new(&RendererOptions::default()).map_err(Failure::run)?;
        Ok(Self { replay, renderer })
    }

    /// Moments from the first to the last, evenly.
    pub(super) fn strip(&mut self, count: u32) -> Result<Vec<Picture>, Failure> {
        let frames = self.replay.frames();
        let last = frames.len() - 1;
        let steps = (count - 1).max(1) as usize;
        let mut chosen: Vec<usize> = (0..count as usize).map(|k| k * last / steps).collect();
        chosen.dedup();
        let view = ScenePainterView::Scene;
        let mut painter = self.painter(&frames[0], view, STRIP_SIZE)?;
        chosen
            .into_iter()
            .map(|i| {
                let moment = self.replay.moment(&frames[i]);
                self.replay.dress(&mut painter, &frames[i]).map_err(crate::simulation::failure)?;
                let image = painter.draw(&mut self.renderer, &moment, view, STRIP_SIZE);
                let png = image
                    .map_err(crate::simulation::failure)?
                    .encode_png()
                    .map_err(Failure::run)?;
                Ok(Picture { png, caption: format!("{:.3} s", frames[i].time) })
            })
            .collect()
    }

    /// An overlap, cut open where it is deepest.
    pub(super) fn close_up(&mut self, overlap: &Overlap) -> Result<Vec<u8>, Failure> {
        let frame = self.replay.nearest(overlap.time);
        let mut alone = frame.clone();
        alone.pairs.retain(|pair| pair.a == overlap.a && pair.b == overlap.b);
        let view = ScenePainterView::Section;
        let mut painter = self.painter(&alone, view, CLOSE_UP_SIZE)?;
        let moment = self.replay.moment(&alone);
        let image = painter.draw(&mut self.renderer, &moment, view, CLOSE_UP_SIZE);
        image.map_err(crate::simulation::failure)?.encode_png().map_err(Failure::run)
    }

    fn painter(
        &self,
        frame: &ReplayFrame,
        view: ScenePainterView,
        size: [u32; 2],
    ) -> Result<ScenePainter, Failure> {
        let scene = self.replay.scene(frame);
        let size = ScenePainter::camera_size(view, size).map_err(crate::simulation::failure)?;
        ScenePainter::new(&scene, size, PictureQuality::Normal).map_err(crate::simulation::failure)
    }
}
