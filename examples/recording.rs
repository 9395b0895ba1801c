//! A scene that runs and is recorded: a file for Foxglove, Lichtblick or Rerun, with the bodies,
//! where they are in each recorded step, and their contacts.
//!
//! `cargo run --example recording --features ecs,rapier,scene,record [OUT.mcap]`

#![expect(clippy::print_stdout, reason = "an example talks to a person")]

use std::error::Error;
use std::path::PathBuf;

use cranny::ecs::{PluginOptions, RunOptions, SceneApp};
use cranny::scene::load_scene;

fn main() -> Result<(), Box<dyn Error>> {
    let given = std::env::args_os().nth(1).map(PathBuf::from);
    let path = given.clone().unwrap_or_else(|| std::env::temp_dir().join("hook_on_ring.mcap"));
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/assets/scenes/hook_on_ring.ron");
    let scene = load_scene(file.as_ref())?;

    let options = RunOptions {
        plugins: PluginOptions::default(),
        duration: Some(1.0),
        source: Some(scene.source_text.clone()), // goes into the file
        record: Some(path.clone()),
        ..RunOptions::default()
    };
    let mut app = SceneApp::new(&scene.description, &options)?;
    while app.step()? {}
    let summary = app.finish()?; // gives the file its name, which it has only once it is whole
    let bytes = std::fs::metadata(&path)?.len();
    println!("{} steps, {} bytes in {}", summary.steps, bytes, path.display());
    assert!(summary.steps == 240 && bytes > 10_000);
    if given.is_none() {
        std::fs::remove_file(path)?;
    }
    Ok(())
}
