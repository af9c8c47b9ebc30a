//! The verb `explain`: why each contact of a pair was kept or dropped.

mod args;
mod event_row;
mod names;
mod ply;
mod scene;
mod story;
mod text;

pub(crate) use args::ExplainArgs;

use event_row::EventRow;
use scene::Scene;
use story::Story;

use super::{Error, write_csv};

pub(crate) fn run(args: &ExplainArgs) -> Result<(), Error> {
    args.check()?;
    let scene = Scene::of(args)?;
    let events = scene.events()?;
    let story = Story::of(&scene, &events);
    let rows = EventRow::all(&scene, &events);
    if let Some(path) = &args.csv {
        write_csv(path, &rows)?;
    }
    if let Some(path) = &args.ply {
        vps_build::write_atomically(path, ply::text(&scene, &story).as_bytes())?;
    }
    if args.json {
        println!("{}", serde_json::to_string_pretty(&story)?);
    } else {
        print!("{}", text::text(&story, &rows));
    }
    Ok(())
}
