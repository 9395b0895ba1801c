//! `cranny robot`.

use serde_json::Value;

use crate::harness::{Folder, cranny, run, run_command};

/// A sledge on a rail (0.2 to 3 from the left post), which a second one follows at half the way on
/// a rail of its own; a post at the end.
const ROBOT: &str = r#"<robot name="rails">
  <link name="post">
    <inertial><mass value="2"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
    <collision><geometry><box size="1 1 1"/></geometry></collision>
  </link>
  <link name="rail"/>
  <link name="sledge"><collision><geometry><box size="1 1 1"/></geometry></collision></link>
  <link name="follower"><collision><origin xyz="0 0 5"/><geometry><box size="1 1 1"/></geometry></collision></link>
  <joint name="base" type="fixed"><parent link="post"/><child link="rail"/></joint>
  <joint name="slide" type="prismatic"><parent link="rail"/><child link="sledge"/><axis xyz="1 0 0"/>
    <limit lower="0.2" upper="3" effort="5" velocity="1"/></joint>
  <joint name="follow" type="prismatic"><parent link="rail"/><child link="follower"/><axis xyz="1 0 0"/>
    <limit lower="0" upper="3" effort="5" velocity="1"/><mimic joint="slide" multiplier="0.5"/></joint>
</robot>"#;

fn robot(folder: &Folder) -> String {
    folder.write("rails.urdf", ROBOT)
}

fn lines(stdout: &str) -> Vec<Value> {
    stdout.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

#[test]
fn a_line_a_configuration_names_the_links_that_meet_and_the_nearest() {
    let folder = Folder::new();
    let urdf = robot(&folder);
    let q = folder.write("q.json", r#"[{}, {"slide": 2.5}, {"slide": 1}]"#);
    let found = run(&["robot", &urdf, "--configurations", &q, "--distance"]);
    assert_eq!((found.code, found.stderr.as_str()), (Some(0), ""));
    let found = lines(&found.stdout);
    assert_eq!(found.len(), 3);
    // 0 is below the limit: the sledge is at 0.2, in the post. Its rail has no geometry.
    let hit = serde_json::json!(["post", "sledge"]);
    assert_eq!((&found[0]["configuration"], &found[0]["hits"][0]), (&0.into(), &hit));
    assert_eq!((&found[0]["distance"], &found[0]["pair"]), (&0.0.into(), &hit));
    assert!(found[1]["hits"].as_array().unwrap().is_empty());
    assert_eq!((&found[1]["distance"], &found[1]["pair"]), (&1.5.into(), &hit));
    assert_eq!(found[2]["hits"][0], hit, "faces that touch");
}

#[test]
fn disabled_pairs_are_not_checked_and_distances_are_of_who_asks() {
    let folder = Folder::new();
    let urdf = robot(&folder);
    let q = folder.write("q.json", "[{}]");
    let srdf = "<robot name='rails'><disable_collisions link1='sledge' link2='post'/>\
                <disable_collisions link1='sledge' link2='crane'/></robot>";
    let srdf = folder.write("rails.srdf", srdf);
    let args = ["robot", &urdf, "--configurations", &q, "--srdf", &srdf];
    let found = lines(&run(&args).stdout);
    assert!(found[0]["hits"].as_array().unwrap().is_empty());
    assert!(found[0]["distance"].is_null() && found[0]["pair"].is_null());
    let text = run(&[&args[..], &["--distance", "--format", "text"]].concat()).stdout;
    // The follower is at 0.1 and 5 above.
    assert!(text.contains("no links meet  nearest 4.000"), "{text}");
    let described = run(&["robot", &urdf, "--srdf", &srdf]).stdout;
    assert!(described.contains("2 pairs of links are checked"), "{described}");
    assert!(described.contains("\"crane\", which the robot lacks"), "{described}");
}

/// A warning is there whether or not somebody sits at a terminal.
#[test]
fn an_srdf_that_fits_in_part_is_warned_of_and_that_of_another_robot_is_refused() {
    let folder = Folder::new();
    let urdf = robot(&folder);
    let q = folder.write("q.json", "[{}]");
    let args = |srdf: &str, more: &[&str]| {
        let srdf = folder.write("a.srdf", srdf);
        run(&[&["robot", &urdf, "--configurations", &q, "--srdf", &srdf], more].concat())
    };
    let pair = |a: &str, b: &str| format!("<disable_collisions link1='{a}' link2='{b}'/>");
    let of = |name: &str, inner: String| format!("<robot name='{name}'>{inner}</robot>");
    let in_part = of("old", pair("sledge", "post") + &pair("sledge", "crane"));
    let warned = args(&in_part, &[]);
    assert_eq!(lines(&warned.stdout)[0]["hits"], serde_json::json!([]));
    for says in ["is of the robot \"old\"", "the URDF of \"rails\"", "the link \"crane\", which"] {
        assert!(warned.stderr.contains(says), "{warned:?}");
    }
    assert_eq!(args(&in_part, &["--quiet"]).stderr, "");
    assert_eq!(args(&of("rails", pair("sledge", "post")), &[]).stderr, "");
    args(ROBOT, &[]).assert_refused(2, &["a.srdf", "line 2", "URDF and no SRDF"]);
    let unknown = pair("arm", "hand") + &pair("arm", "post");
    args(&of("panda", unknown.clone()), &[])
        .assert_refused(2, &["a.srdf", "\"panda\"", "of the 3 links", "\"rails\" lacks 2"]);
    // Part of a robot has its name, and less than the whole.
    assert!(args(&of("rails", unknown), &[]).stderr.contains("\"arm\", \"hand\", which"));
    args(&of("rails", pair("arm", "hand")), &[]).assert_refused(2, &["lacks 2"]);
}

#[test]
fn a_group_that_moves_nothing_against_anything_is_refused() {
    let folder = Folder::new();
    let urdf = robot(&folder);
    let srdf = "<robot name='rails'><group name='none'/><group name='empty'><link name='rail'/></group></robot>";
    let srdf = folder.write("rails.srdf", srdf);
    for group in ["none", "empty"] {
        run(&["robot", &urdf, "--srdf", &srdf, "--group", group])
            .assert_refused(2, &["rails.srdf", group, "moves no pair of links"]);
    }
    let bare = folder.write("bare.srdf", "<robot name='rails'/>");
    run(&["robot", &urdf, "--srdf", &bare, "--group", "arm"])
        .assert_refused(2, &["no group \"arm\". It has no groups"]);
}

#[test]
fn a_group_is_checked_against_all_that_it_may_meet() {
    let folder = Folder::new();
    let urdf = robot(&folder);
    let srdf = folder.write(
        "rails.srdf",
        "<robot name='rails'><group name='carriage'><joint name='slide'/></group>\n\
         <group name='still'><link name='post'/></group>\n\
         <group name='lost'>\n<link name='crane'/></group></robot>",
    );
    let q = folder.write("q.json", "[{}]");
    let args = |group| {
        ["robot", &urdf, "--srdf", &srdf, "--configurations", &q, "--distance", "--group", group]
    };
    let hits = |group| lines(&run(&args(group)).stdout)[0]["hits"].clone();
    let hit = serde_json::json!([["post", "sledge"]]);
    assert_eq!((hits("carriage"), hits("still")), (hit.clone(), hit));
    let described = run(&["robot", &urdf, "--srdf", &srdf, "--group", "still"]).stdout;
    assert!(described.contains("2 pairs of links are checked"), "{described}");
    let says = ["rails.srdf", "no group \"arm\"", "carriage, lost, still"];
    run(&args("arm")).assert_refused(2, &says);
    let says = ["rails.srdf", "line 4", "\"lost\"", "\"crane\"", "post, rail"];
    run(&args("lost")).assert_refused(2, &says);
    let alone = run(&["robot", &urdf, "--group", "arm"]);
    assert!(alone.code == Some(2) && alone.stderr.contains("--srdf"), "{alone:?}");
}

#[test]
fn a_robot_is_described() {
    let folder = Folder::new();
    let urdf = robot(&folder);
    let described = run(&["robot", &urdf, "--format", "json"]);
    assert_eq!(described.code, Some(0), "{described:?}");
    let described = &lines(&described.stdout)[0];
    assert_eq!((&described["robot"], &described["root"]), (&"rails".into(), &"post".into()));
    assert_eq!((&described["checked_pairs"], &described["mass"]), (&3.into(), &2.0.into()));
    let [post, rail] = [0, 1].map(|link| &described["links"][link]);
    assert_eq!((&post["faces"], &post["inertia"]), (&12.into(), &true.into()));
    assert!(rail["faces"].is_null() && rail["mass"].is_null());
    let slide = &described["joints"][1];
    assert_eq!((&slide["kind"], &slide["max_effort"]), (&"prismatic".into(), &5.0.into()));
    assert_eq!(slide["limits"], serde_json::json!([0.2, 3.0]));
    assert_eq!(described["joints"][2]["follows"], "slide x 0.5 + 0");
    let text = run(&["robot", &urdf]).stdout;
    assert!(text.contains("rail -> sledge") && text.contains("0.2000 to 3.0000"), "{text}");
}

#[test]
fn the_picture_shows_the_configuration_and_marks_links_that_meet() {
    let folder = Folder::new();
    let urdf = robot(&folder);
    let q = folder.write("q.json", r#"[{"slide": 2.5}, {"slide": 0.5}]"#);
    let reds = |name: &str, more: &[&str]| {
        let picture = folder.path(name);
        let found = run(&[&["robot", &urdf, "--render", picture.to_str().unwrap()], more].concat());
        assert_eq!(found.code, Some(0), "{found:?}");
        let is_drawn = picture.exists();
        assert_eq!(
            found.stdout.contains("drawn: ") && !is_drawn,
            found.stdout.contains("not drawn")
        );
        is_drawn.then(|| reds_of(&picture))
    };
    let of_first = reds("first.png", &["--configurations", &q]);
    let of_second = reds("second.png", &["--configurations", &q, "--at", "1"]);
    // At rest the sledge is at its limit, in the post.
    let at_rest = reds("rest.png", &[]);
    let Some(((first, second), rest)) = of_first.zip(of_second).zip(at_rest) else {
        println!("skipped: no graphics adapter");
        return;
    };
    assert!(first == 0 && second > 5_000 && rest > 5_000, "{first} {second} {rest}");
}

/// Pixels of a picture that are red.
fn reds_of(picture: &std::path::Path) -> usize {
    let decoder = png::Decoder::new(std::io::BufReader::new(std::fs::File::open(picture).unwrap()));
    let mut reader = decoder.read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut pixels).unwrap();
    let samples = info.color_type.samples();
    let is_red = |p: &&[u8]| p[0] > 100 && p[1] < p[0] / 3 && p[2] < p[0] / 3;
    pixels.chunks_exact(samples).filter(is_red).count()
}

#[test]
fn a_picture_that_cannot_be_is_refused() {
    let folder = Folder::new();
    let urdf = robot(&folder);
    let q = folder.write("q.json", "[{}, {}]");
    run(&["robot", &urdf, "--render", "r.jpg"]).assert_refused(2, &["--render r.jpg", ".png"]);
    run(&["robot", &urdf, "--render", &urdf]).assert_refused(2, &["rails.urdf", "it is the input"]);
    let args = ["robot", &urdf, "--configurations", &q, "--render", "r.png", "--at", "2"];
    run(&args).assert_refused(2, &["--at 2", "the last configuration is 1"]);
}

#[test]
fn configurations_come_by_standard_input_as_well() {
    let folder = Folder::new();
    let urdf = robot(&folder);
    let piped = |text: &str| {
        let input = std::fs::File::open(folder.write("q.json", text)).unwrap();
        let args = ["robot", &urdf, "--configurations", "-"];
        run_command(cranny().args(args).stdin(input))
    };
    assert_eq!(lines(&piped("[{}, {\"slide\": 2}]").stdout).len(), 2);
    piped("[").assert_refused(2, &["standard input: ", "line 1"]);
    piped("[{\"elbow\": 1}]").assert_refused(2, &["standard input: configuration 0", "\"elbow\""]);
}

#[test]
fn what_is_no_robot_and_no_configuration_is_refused() {
    let folder = Folder::new();
    let urdf = robot(&folder);
    let refused = |text: &str, words: &[&str]| {
        let q = folder.write("q.json", text);
        run(&["robot", &urdf, "--configurations", &q]).assert_refused(2, words);
    };
    refused("{}", &["q.json", "brackets", "list of"]);
    refused("[]", &["at least one"]);
    refused("[{\"slide\": 1,\n\"slide\": 2}]", &["line 2", "\"slide\" is named twice"]);
    refused(r#"[{}, {"elbow": 1}]"#, &["configuration 1", "\"elbow\"", "movable joints are slide"]);
    refused(r#"[{"follow": 1}]"#, &["configuration 0", "follows joint \"slide\""]);
    refused(r#"[{"base": 1}]"#, &["is fixed"]);
    let missing = folder.path("missing.urdf").display().to_string();
    run(&["robot", &missing]).assert_refused(2, &["missing.urdf", "no such file"]);
    let half = folder.write("half.urdf", "<robot name='r'>\n<link name='a'>\n");
    run(&["robot", &half]).assert_refused(2, &["half.urdf", "line"]);
    let srdf = folder.write("r.srdf", "<robot>\n<disable_collisions link1='a'/></robot>");
    run(&["robot", &urdf, "--srdf", &srdf]).assert_refused(2, &["r.srdf", "line 2", "link2"]);
    let alone = run(&["robot", &urdf, "--distance"]);
    assert!(alone.code == Some(2) && alone.stderr.contains("--configurations"), "{alone:?}");
}

#[test]
fn an_srdf_file_in_place_of_the_robot_is_refused_with_the_option() {
    let folder = Folder::new();
    let srdf = folder.write("arm.srdf", "<robot name=\"arm\"/>");
    run(&["robot", &srdf]).assert_refused(2, &["arm.srdf", "Name the URDF", "--srdf"]);
}

/// A flange without geometry between two links: no joint joins those, and they never part.
#[test]
fn links_that_fixed_joints_hold_in_each_other_are_named_once() {
    let folder = Folder::new();
    let link = |name: &str| {
        format!(
            "<link name='{name}'><collision><geometry><box size='1 1 1'/></geometry></collision></link>"
        )
    };
    let joint = |parent: &str, child: &str| {
        format!(
            "<joint name='to_{child}' type='fixed'><parent link='{parent}'/><child link='{child}'/></joint>"
        )
    };
    let urdf = |flange: &str| {
        let parts = [
            link("arm"),
            flange.to_owned(),
            link("hand"),
            joint("arm", "flange"),
            joint("flange", "hand"),
        ];
        folder.write("r.urdf", format!("<robot name='r'>{}</robot>", parts.concat()))
    };
    let described = run(&["robot", &urdf("<link name='flange'/>")]).stdout;
    assert!(described.starts_with("robot r: 3 links, 2 joints, 0.0000 kg"), "{described}");
    assert!(described.contains("; 1 pair of links is checked"), "{described}");
    let says = "1 pair of links meets at every configuration, since fixed joints hold them together: arm - hand. Name an SRDF file";
    assert!(described.contains(says), "{described}");
    let q = folder.write("q.json", "[{}]");
    let checked = run(&["robot", &urdf("<link name='flange'/>"), "--configurations", &q]);
    assert!(checked.code == Some(0) && checked.stderr.contains(says), "{checked:?}");
    let alone = folder.write("alone.urdf", format!("<robot name='a'>{}</robot>", link("arm")));
    let alone = run(&["robot", &alone]).stdout;
    assert!(alone.starts_with("robot a: 1 link, 0 joints, 0.0000 kg"), "{alone}");
}
