//! Pictures of a run; where no adapter is found, that the run says so.

use cranny_ecs::*;
use cranny_world::description::{CameraDescription, CameraView, Effect};

use crate::build::gate;

#[test]
fn pictures_are_written_or_said_to_be_skipped() {
    let folder = tempfile::tempdir().unwrap();
    let (frames, preview) = (folder.path().join("new/frames"), folder.path().join("preview.png"));
    let mut scene = gate(&[Effect::Contacts { margin: 0.1 }]);
    scene.cameras = [("front", CameraView::Front), ("top", CameraView::Top)]
        .map(|(name, view)| CameraDescription { name: name.into(), view })
        .into();
    let options = RunOptions {
        duration: Some(1.0),
        pictures: PictureOptions {
            frames: Some(frames.clone()),
            preview: Some(preview.clone()),
            ..PictureOptions::default()
        },
        ..RunOptions::default()
    };
    let mut app = SceneApp::new(&scene, &options).unwrap();
    while app.step().unwrap() {}
    let summary = app.finish().unwrap();
    if let Some(skipped) = summary.skipped.iter().find(|skipped| skipped.what == "pictures") {
        assert!(!skipped.why.is_empty() && summary.outputs.is_empty() && !preview.exists());
        return;
    }
    assert_eq!(summary.outputs.len(), 2);
    // Four steps of a quarter of a second, and the end; two cameras.
    for number in 0..5 {
        for camera in ["front", "top"] {
            let path = frame_path(&frames, camera, number);
            assert!(std::fs::read(&path).unwrap().starts_with(b"\x89PNG"), "{path:?}");
        }
    }
    assert!(!frame_path(&frames, "front", 5).exists());
    let animation = std::fs::read(&preview).unwrap();
    assert!(animation.windows(4).any(|chunk| chunk == b"acTL"));
    assert!(summary.time_ms.render > 0.0);
}

#[test]
fn pictures_read_points_in_the_steps_that_they_show_and_at_the_end() {
    let folder = tempfile::tempdir().unwrap();
    let mut scene = gate(&[Effect::Contacts { margin: 0.1 }]);
    scene.step = 0.05;
    let preview = Some(folder.path().join("preview.png"));
    let options = RunOptions {
        plugins: PluginOptions { contact_fields: ContactFields::NONE, ..PluginOptions::default() },
        pictures: PictureOptions { preview, ..PictureOptions::default() },
        ..RunOptions::default()
    };
    let mut app = SceneApp::new(&scene, &options).unwrap();
    let painted = |app: &SceneApp| app.app().world().get_resource::<Painter>().map(Painter::drawn);
    let read = |app: &SceneApp| {
        let readers = app.app().world().resource::<ContactReaders>();
        readers.of(ContactReaders::PICTURES).points
    };
    let Some(mut before) = painted(&app) else { return };
    for _ in 0..12 {
        app.step().unwrap();
        let now = painted(&app).unwrap();
        assert_eq!(read(&app), now > before, "step {}", app.steps_done());
        before = now;
    }
    assert!(before > 1 && before < 12, "{before} of 12 steps are shown");
}

#[test]
fn an_unwritable_picture_is_refused_before_anything_runs() {
    let folder = tempfile::tempdir().unwrap();
    let preview = folder.path().join("missing/preview.png");
    let file = folder.path().join("file");
    std::fs::write(&file, "").unwrap();
    for pictures in [
        PictureOptions { preview: Some(preview.clone()), ..PictureOptions::default() },
        PictureOptions { frames: Some(file.clone()), ..PictureOptions::default() },
    ] {
        let path = pictures.preview.clone().or(pictures.frames.clone()).unwrap();
        let options = RunOptions { pictures, ..RunOptions::default() };
        let error = SceneApp::new(&gate(&[]), &options).err().unwrap().to_string();
        assert!(error.contains(&path.display().to_string()), "{error}");
    }
}
