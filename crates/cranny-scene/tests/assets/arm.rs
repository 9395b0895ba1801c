//! The six-axis arm with its gripper: URDF, meshes and scene. Lengths in metres.

use cranny_scene::encode_obj;
use cranny_shapes::{ChainLink, Cup, Gear, LPrism, UPrism};

use crate::generated::cut;

pub(crate) fn files() -> Vec<(String, String)> {
    let turret = UPrism { width: 0.2, height: 0.2, thickness: 0.04, depth: 0.16 };
    let upper_arm = ChainLink {
        straight: 0.3,
        bend_radius: 0.06,
        wire_radius: 0.025,
        arc_segments: 12,
        wire_segments: 12,
    };
    let wrist = Gear {
        teeth: 12,
        module: 0.008,
        thickness: 0.04,
        bore: 0.02,
        backlash: 0.0,
        flank_segments: 2,
    };
    let flange = Cup { radius: 0.04, height: 0.05, wall: 0.008, floor: 0.01, segments: 32 };
    let finger = LPrism { width: 0.05, height: 0.09, thickness: 0.015, depth: 0.03 };
    let mesh = |name: &str, text: String| (format!("robots/arm/meshes/{name}.obj"), text);
    vec![
        ("robots/arm/arm.urdf".to_owned(), URDF.to_owned()),
        mesh("turret", encode_obj(&turret.build().unwrap())),
        mesh("upper_arm", encode_obj(&upper_arm.build().unwrap())),
        mesh("wrist", encode_obj(&wrist.build().unwrap())),
        mesh("flange", encode_obj(&flange.build().unwrap())),
        mesh("finger", encode_obj(&cut(&finger.build().unwrap(), 2))),
    ]
}

const URDF: &str = r#"<?xml version="1.0"?>
<!-- A six-axis arm with a hooked gripper. Its meshes are not convex: a fork carries a link with a hole. -->
<robot name="arm">
  <link name="world"/>
  <link name="base">
    <inertial><mass value="6"/><inertia ixx="0.05" ixy="0" ixz="0" iyy="0.05" iyz="0" izz="0.05"/></inertial>
    <collision><origin xyz="0 0 0.05"/><geometry><cylinder radius="0.12" length="0.1"/></geometry></collision>
  </link>
  <link name="turret">
    <inertial><mass value="3"/><inertia ixx="0.02" ixy="0" ixz="0" iyy="0.02" iyz="0" izz="0.02"/></inertial>
    <collision>
      <origin xyz="0 0 0.1" rpy="1.5707963267948966 0 1.5707963267948966"/>
      <geometry><mesh filename="package://arm/meshes/turret.obj"/></geometry>
    </collision>
  </link>
  <link name="upper_arm">
    <inertial><mass value="2"/><inertia ixx="0.02" ixy="0" ixz="0" iyy="0.02" iyz="0" izz="0.01"/></inertial>
    <collision>
      <origin xyz="0 0 0.15" rpy="1.5707963267948966 -1.5707963267948966 0"/>
      <geometry><mesh filename="package://arm/meshes/upper_arm.obj"/></geometry>
    </collision>
  </link>
  <link name="forearm">
    <inertial><mass value="1.5"/><inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.002"/></inertial>
    <collision><origin xyz="0 0 0"/><geometry><sphere radius="0.03"/></geometry></collision>
    <collision><origin xyz="0 0 0.14"/><geometry><cylinder radius="0.02" length="0.22"/></geometry></collision>
  </link>
  <link name="wrist_1">
    <inertial><mass value="0.5"/><inertia ixx="0.001" ixy="0" ixz="0" iyy="0.001" iyz="0" izz="0.001"/></inertial>
    <collision><geometry><mesh filename="package://arm/meshes/wrist.obj"/></geometry></collision>
  </link>
  <link name="wrist_2">
    <inertial><mass value="0.4"/><inertia ixx="0.001" ixy="0" ixz="0" iyy="0.001" iyz="0" izz="0.001"/></inertial>
    <collision>
      <origin rpy="1.5707963267948966 0 0"/>
      <geometry><cylinder radius="0.03" length="0.08"/></geometry>
    </collision>
  </link>
  <link name="wrist_3">
    <inertial><mass value="0.2"/><inertia ixx="0.0005" ixy="0" ixz="0" iyy="0.0005" iyz="0" izz="0.0005"/></inertial>
    <collision><geometry><mesh filename="package://arm/meshes/flange.obj"/></geometry></collision>
  </link>
  <link name="palm">
    <inertial><mass value="0.3"/><inertia ixx="0.0005" ixy="0" ixz="0" iyy="0.0005" iyz="0" izz="0.0005"/></inertial>
    <collision><geometry><box size="0.18 0.05 0.03"/></geometry></collision>
  </link>
  <link name="left_finger">
    <inertial><mass value="0.1"/><inertia ixx="0.0001" ixy="0" ixz="0" iyy="0.0001" iyz="0" izz="0.0001"/></inertial>
    <collision>
      <origin xyz="0 0 0.0555" rpy="-1.5707963267948966 0 0"/>
      <geometry><mesh filename="package://arm/meshes/finger.obj"/></geometry>
    </collision>
  </link>
  <link name="right_finger">
    <inertial><mass value="0.1"/><inertia ixx="0.0001" ixy="0" ixz="0" iyy="0.0001" iyz="0" izz="0.0001"/></inertial>
    <collision>
      <origin xyz="0 0 0.0555" rpy="-1.5707963267948966 0 0"/>
      <geometry><mesh filename="package://arm/meshes/finger.obj" scale="-1 1 1"/></geometry>
    </collision>
  </link>

  <joint name="anchor" type="fixed">
    <parent link="world"/><child link="base"/>
  </joint>
  <joint name="axis_1" type="revolute">
    <origin xyz="0 0 0.11"/><axis xyz="0 0 1"/>
    <parent link="base"/><child link="turret"/>
    <limit lower="-3" upper="3" effort="100" velocity="3"/>
  </joint>
  <joint name="axis_2" type="revolute">
    <origin xyz="0 0 0.16"/><axis xyz="0 1 0"/>
    <parent link="turret"/><child link="upper_arm"/>
    <limit lower="-1.2" upper="1.2" effort="100" velocity="3"/>
  </joint>
  <joint name="axis_3" type="revolute">
    <origin xyz="0 0 0.3"/><axis xyz="0 1 0"/>
    <parent link="upper_arm"/><child link="forearm"/>
    <limit lower="-2.4" upper="2.4" effort="80" velocity="3"/>
  </joint>
  <joint name="axis_4" type="revolute">
    <origin xyz="0 0 0.28"/><axis xyz="0 0 1"/>
    <parent link="forearm"/><child link="wrist_1"/>
    <limit lower="-3" upper="3" effort="30" velocity="3"/>
  </joint>
  <joint name="axis_5" type="revolute">
    <origin xyz="0 0 0.09"/><axis xyz="0 1 0"/>
    <parent link="wrist_1"/><child link="wrist_2"/>
    <limit lower="-2" upper="2" effort="30" velocity="3"/>
  </joint>
  <joint name="axis_6" type="revolute">
    <origin xyz="0 0 0.04"/><axis xyz="0 0 1"/>
    <parent link="wrist_2"/><child link="wrist_3"/>
    <limit lower="-3" upper="3" effort="30" velocity="3"/>
  </joint>
  <joint name="mount" type="fixed">
    <origin xyz="0 0 0.075"/>
    <parent link="wrist_3"/><child link="palm"/>
  </joint>
  <joint name="grip" type="prismatic">
    <origin xyz="-0.07 0 0.02"/><axis xyz="1 0 0"/>
    <parent link="palm"/><child link="left_finger"/>
    <limit lower="0" upper="0.03" effort="20" velocity="0.2"/>
  </joint>
  <joint name="grip_mirrored" type="prismatic">
    <origin xyz="0.07 0 0.02"/><axis xyz="-1 0 0"/>
    <parent link="palm"/><child link="right_finger"/>
    <limit lower="0" upper="0.03" effort="20" velocity="0.2"/>
    <mimic joint="grip" multiplier="1" offset="0"/>
  </joint>
</robot>
"#;

pub(crate) fn scene() -> String {
    "// A six-axis arm of this project's own sweeps its hooked gripper through a mug on a table.
(
    version: 1,
    gravity: (0, 0, -9.81),
    step: 0.004166666666666667, // 1/240 s
    duration: 4,
    bodies: [
        (name: \"table\", shape: Generator(Cuboid(size: (2, 2, 0.1))), kind: Fixed, pose: (at: (0, 0, -0.06))),
        (
            name: \"mug\",
            shape: Generator(Cup(radius: 0.05, height: 0.12, wall: 0.008, floor: 0.01, segments: 48)),
            pose: (at: (0.49, 0.27, -0.005)),
            material: (density: 800, friction: 0.5),
        ),
    ],
    robots: [
        (
            path: \"../robots/arm/arm.urdf\",
            positions: {\"axis_1\": -0.4, \"axis_2\": 0.9, \"axis_3\": 1.2, \"axis_5\": 1},
            targets: {\"axis_1\": 0.9, \"axis_2\": 0.9, \"axis_3\": 1.2, \"axis_5\": 1, \"grip\": 0.02},
            material: (friction: 0.5),
        ),
    ],
    effects: [Response(), Contacts(margin: 0.005)],
    cameras: [(name: \"main\", preset: Isometric), (name: \"top\", preset: Top)],
    record: (every: 4),
)
"
    .to_owned()
}
