//! How the viewer arranges it all: the scene above the words, plots beside.

use re_sdk::blueprint::components::PanelState::Collapsed;
use re_sdk::blueprint::{
    Blueprint, BlueprintPanel, ContainerLike, Horizontal, SelectionPanel, Spatial2DView,
    Spatial3DView, Tabs, TextDocumentView, TextLogView, TimePanel, TimeSeriesView, Vertical,
};

use crate::clock::TIME;
use crate::plots::Groups;
use crate::source::Source;
use crate::{bodies, contacts, notes, plots};

/// The layout of a recording with these plots.
pub(crate) fn layout(source: &Source, groups: &Groups) -> Blueprint {
    let left = Vertical::new([tabs(source), words()]).with_row_shares([3.0, 1.0]);
    let right = Vertical::new(groups.keys().map(|group| plot(group)));
    let all = Horizontal::new([left.into(), right.into()]).with_column_shares([2.0, 1.0]);
    Blueprint::new(all)
        .with_blueprint_panel(BlueprintPanel::from_state(Collapsed))
        .with_selection_panel(SelectionPanel::from_state(Collapsed))
        .with_time_panel(TimePanel::new().with_state(Collapsed).with_timeline(TIME))
}

/// The scene, its contacts alone, since solids hide them, and the pictures where there are any.
fn tabs(source: &Source) -> ContainerLike {
    let [bodies, contacts] = [bodies::GROUP, contacts::GROUP].map(|group| format!("/{group}/**"));
    let scene =
        Spatial3DView::new("Scene").with_origin("/").with_contents([bodies, contacts.clone()]);
    let contacts = Spatial3DView::new("Contacts").with_origin("/").with_contents([contacts]);
    let about = TextDocumentView::new("About").with_origin(format!("/{}", notes::ABOUT));
    let mut views: Vec<ContainerLike> = vec![scene.into(), contacts.into(), about.into()];
    let mut cameras: Vec<&str> = source.pictures.iter().map(|(_, p)| p.camera.as_str()).collect();
    cameras.dedup();
    for camera in cameras {
        let origin = crate::stream::path(&[notes::CAMERAS], camera);
        views.push(Spatial2DView::new(camera).with_origin(origin).into());
    }
    Tabs::new(views).into()
}

fn words() -> ContainerLike {
    let contents = [notes::EVENTS, notes::LOG].map(|name| format!("/{name}"));
    TextLogView::new("Events and log").with_origin("/").with_contents(contents).into()
}

fn plot(group: &str) -> ContainerLike {
    let origin = crate::stream::path(&[plots::GROUP], group);
    let mut title = group.to_owned();
    title[..1].make_ascii_uppercase();
    TimeSeriesView::new(title).with_origin(origin).into()
}
