//! A picture without a window: an animated PNG of a scene, whose first picture is the final state.
//! It needs a graphics adapter, which may be a software one; without any it says so and ends well.
//!
//! `cargo run --example offscreen_picture --features ecs,rapier,scene,render [OUT.png]`

#![expect(clippy::print_stdout, reason = "an example talks to a person")]

use std::error::Error;
use std::path::PathBuf;

use cranny::ecs::{PictureOptions, RunOptions, SceneApp};
use cranny::scene::load_scene;

fn main() -> Result<(), Box<dyn Error>> {
    let given = std::env::args_os().nth(1).map(PathBuf::from);
    let path = given.clone().unwrap_or_else(|| std::env::temp_dir().join("hook_on_ring.png"));
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/assets/scenes/hook_on_ring.ron");
    let scene = load_scene(file.as_ref())?;

    let options = RunOptions {
        duration: Some(0.25),
        pictures: PictureOptions { preview: Some(path.clone()), ..PictureOptions::default() },
        ..RunOptions::default()
    };
    let mut app = SceneApp::new(&scene.description, &options)?;
    while app.step()? {}
    let summary = app.finish()?;
    if let Some(skipped) = summary.skipped.first() {
        println!("no picture: {}", skipped.why);
        return Ok(());
    }
    let bytes = std::fs::metadata(&path)?.len();
    println!("{} bytes in {}", bytes, path.display());
    assert!(bytes > 1_000);
    if given.is_none() {
        std::fs::remove_file(path)?;
    }
    Ok(())
}
