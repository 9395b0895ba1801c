#![allow(clippy::print_stdout, reason = "it is what the example is for")]
//! Runs a scene file and prints how it went: `cargo run -p cranny-ecs --all-features --example
//! run_scene -- SCENE.ron [SECONDS [LENGTH_UNIT [OUT.mcap [PREVIEW.png]]]]`.

use std::error::Error;
use std::path::{Path, PathBuf};

use cranny_ecs::{PictureOptions, PluginOptions, RunOptions, SceneApp, helices};

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let path = arguments.next().ok_or("name a scene file")?;
    let duration = arguments.next().map(|seconds| seconds.parse()).transpose()?;
    let length_unit = arguments.next().map(|length| length.parse()).transpose()?;
    let record = arguments.next().map(PathBuf::from);
    let preview = arguments.next().map(PathBuf::from);

    let scene = cranny_scene::load_scene(Path::new(&path))?;
    let options = RunOptions {
        plugins: PluginOptions {
            helices: helices(&scene),
            length_unit,
            ..PluginOptions::default()
        },
        duration,
        pictures: PictureOptions { preview, record: record.is_some(), ..PictureOptions::default() },
        record,
        inputs: vec![scene.path.clone()],
        source: Some(scene.source_text.clone()),
        ..RunOptions::default()
    };
    let mut app = SceneApp::new(&scene.description, &options)?;
    while app.step()? {}
    let mut summary = app.finish()?;
    summary.motion.truncate(3);
    println!("{summary:#?}");
    Ok(())
}
