//! Which crate may depend on which.

use crate::report::Violation;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};

/// The crates that compute: no files, no clock, no globals, no GPU, f64 only.
const PURE_CRATES: &[&str] = &[
    "cranny-exact",
    "cranny-geometry",
    "cranny-concavity",
    "cranny-broad-phase",
    "cranny-narrow-phase",
    "cranny-impact",
    "cranny-estimate",
    "cranny-primitives",
    "cranny-world",
    "cranny-certificate",
    "cranny-prover",
];

/// Whether a crate computes and does nothing else.
pub(crate) fn computes(name: &str) -> bool {
    PURE_CRATES.contains(&name)
}

/// Row by row: a crate, and those of ours that it may use in what it ships. `?` marks those that
/// must be optional, behind a feature.
const TABLE: &[(&str, &[&str])] = &[
    ("cranny-exact", &[]),
    ("cranny-geometry", &["cranny-exact"]),
    ("cranny-concavity", &["cranny-exact", "cranny-geometry"]),
    ("cranny-broad-phase", &["cranny-exact"]),
    ("cranny-narrow-phase", &["cranny-exact", "cranny-geometry", "cranny-concavity"]),
    // It checks what the detector says, and shares no code with it.
    ("cranny-certificate", &[]),
    (
        "cranny-prover",
        &["cranny-exact", "cranny-geometry", "cranny-narrow-phase", "cranny-certificate"],
    ),
    ("cranny-impact", &["cranny-exact", "cranny-geometry", "cranny-narrow-phase"]),
    (
        "cranny-estimate",
        &["cranny-exact", "cranny-geometry", "cranny-concavity", "cranny-narrow-phase"],
    ),
    (
        "cranny-primitives",
        &["cranny-exact", "cranny-geometry", "cranny-narrow-phase", "cranny-impact"],
    ),
    (
        "cranny-world",
        &[
            "cranny-exact",
            "cranny-geometry",
            "cranny-broad-phase",
            "cranny-narrow-phase",
            "cranny-estimate",
            "cranny-primitives",
        ],
    ),
    ("cranny-shapes", &["cranny-exact", "cranny-geometry", "cranny-primitives"]),
    (
        "cranny-scene",
        &[
            "cranny-exact",
            "cranny-geometry",
            "cranny-broad-phase",
            "cranny-primitives",
            "cranny-world",
            "cranny-shapes",
        ],
    ),
    (
        "cranny-rapier",
        &[
            "cranny-exact",
            "cranny-geometry",
            "cranny-narrow-phase",
            "cranny-impact",
            "cranny-primitives",
        ],
    ),
    (
        "cranny-rapier-f64",
        &[
            "cranny-exact",
            "cranny-geometry",
            "cranny-narrow-phase",
            "cranny-impact",
            "cranny-primitives",
        ],
    ),
    ("cranny-record", &["cranny-exact", "cranny-geometry", "cranny-narrow-phase", "cranny-world"]),
    ("cranny-render", &["cranny-exact"]),
    ("cranny-rerun", &["cranny-exact", "cranny-geometry", "cranny-record"]),
    (
        "cranny-ecs",
        &[
            "cranny-exact",
            "cranny-geometry",
            "cranny-broad-phase",
            "cranny-narrow-phase",
            "cranny-impact",
            "cranny-primitives",
            "cranny-shapes",
            "cranny-world",
            "?cranny-rapier",
            "?cranny-record",
            "?cranny-render",
            "?cranny-scene",
        ],
    ),
    ("cranny-testkit", &["cranny-exact", "cranny-geometry", "cranny-shapes"]),
    (
        "cranny-stability",
        &[
            "cranny-exact",
            "cranny-geometry",
            "cranny-concavity",
            "cranny-narrow-phase",
            "cranny-shapes",
            "cranny-testkit",
            "cranny-certificate",
            "cranny-prover",
        ],
    ),
    (
        "cranny",
        &[
            "cranny-exact",
            "cranny-geometry",
            "cranny-concavity",
            "cranny-broad-phase",
            "cranny-narrow-phase",
            "cranny-impact",
            "cranny-estimate",
            "cranny-primitives",
            "cranny-world",
            "cranny-shapes",
            "?cranny-scene",
            "?cranny-rapier",
            "?cranny-record",
            "?cranny-render",
            "?cranny-ecs",
        ],
    ),
    (
        "cranny-cli",
        &[
            "cranny",
            "cranny-exact",
            "cranny-geometry",
            "cranny-concavity",
            "cranny-broad-phase",
            "cranny-narrow-phase",
            "cranny-estimate",
            "cranny-primitives",
            "cranny-world",
            "cranny-shapes",
            "cranny-scene",
            "cranny-rapier",
            "cranny-record",
            "cranny-render",
            "?cranny-rerun",
            "cranny-ecs",
            "cranny-stability",
            "cranny-certificate",
            "cranny-prover",
        ],
    ),
    (
        "cranny-bench",
        &[
            "cranny-exact",
            "cranny-geometry",
            "cranny-concavity",
            "cranny-broad-phase",
            "cranny-narrow-phase",
            "cranny-primitives",
            "cranny-world",
            "cranny-shapes",
            "cranny-scene",
            "cranny-rapier",
            "cranny-ecs",
        ],
    ),
    ("xtask", &[]),
];

/// Binaries: nothing imports them.
const TOOLS: &[&str] = &["cranny-cli", "cranny-bench", "xtask"];

/// Foreign crates that no crate of [`PURE_CRATES`] may reach, however far down.
const FAR_FROM_PURE: &[&str] = &[
    "wgpu",
    "rapier3d",
    "rapier3d-f64",
    "bevy_app",
    "bevy_ecs",
    "bevy_time",
    "bevy_transform",
    "mcap",
    "foxglove",
    "re_sdk",
    "tokio",
    "tempfile",
    "clap",
];

/// A dependency as a manifest states it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Dependency {
    name: String,
    /// Only for tests, benches and examples.
    is_dev: bool,
    is_optional: bool,
}

/// A member of the workspace.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Package {
    pub(crate) name: String,
    pub(crate) folder: String,
    manifest: String,
    dependencies: Vec<Dependency>,
}

/// What `cargo metadata` says about the workspace.
#[derive(Clone, Debug, Default)]
pub(crate) struct Graph {
    root: String,
    members: Vec<Package>,
    /// Names of the packages that a package of this name ships with, one step down.
    shipped: BTreeMap<String, BTreeSet<String>>,
}

impl Graph {
    pub(crate) fn from_metadata(metadata: &Value) -> Result<Self, String> {
        let list = |value: &Value| value.as_array().cloned().unwrap_or_default();
        let text = |value: &Value| value.as_str().unwrap_or_default().to_owned();
        let root = text(&metadata["workspace_root"]);
        let member_ids: BTreeSet<String> =
            list(&metadata["workspace_members"]).iter().map(text).collect();
        let mut graph = Self { root, ..Self::default() };
        let mut name_of = BTreeMap::new();
        for package in list(&metadata["packages"]) {
            let (id, name) = (text(&package["id"]), text(&package["name"]));
            if member_ids.contains(&id) {
                let manifest = text(&package["manifest_path"]);
                let dependency = |d: &Value| Dependency {
                    name: text(&d["name"]),
                    is_dev: d["kind"] == "dev",
                    is_optional: d["optional"] == true,
                };
                graph.members.push(Package {
                    name: name.clone(),
                    folder: manifest.trim_end_matches("Cargo.toml").to_owned(),
                    manifest: manifest
                        .trim_start_matches(&graph.root)
                        .trim_start_matches('/')
                        .into(),
                    dependencies: list(&package["dependencies"]).iter().map(dependency).collect(),
                });
            }
            name_of.insert(id, name);
        }
        for node in list(&metadata["resolve"]["nodes"]) {
            let name = |id: &Value| name_of.get(&text(id)).cloned().unwrap_or_default();
            let ships = |d: &Value| list(&d["dep_kinds"]).iter().any(|kind| kind["kind"].is_null());
            let below = list(&node["deps"]).into_iter().filter(ships).map(|d| name(&d["pkg"]));
            graph.shipped.entry(name(&node["id"])).or_default().extend(below);
        }
        if graph.members.is_empty() || graph.shipped.is_empty() {
            return Err("cargo metadata lists no workspace members or no resolved graph".into());
        }
        Ok(graph)
    }

    pub(crate) fn workspace_root(&self) -> &str {
        &self.root
    }

    pub(crate) fn members(&self) -> impl Iterator<Item = &Package> {
        self.members.iter()
    }

    /// Every dependency that points the wrong way.
    pub(crate) fn check(&self) -> Vec<Violation> {
        let mut violations: Vec<_> =
            self.members.iter().flat_map(|package| self.check_package(package)).collect();
        for &pure in PURE_CRATES {
            violations.extend(self.check_reach(pure));
        }
        violations
    }

    fn check_package(&self, package: &Package) -> Vec<Violation> {
        let broken = |rule, found: String, reason| Violation {
            place: package.manifest.clone(),
            rule,
            found,
            reason,
        };
        let name = &package.name;
        let Some((_, allowed)) = TABLE.iter().find(|(row, _)| row == name) else {
            return vec![broken(
                "unknown-crate",
                format!("`{name}` has no row in the table of crate directions"),
                "say in tools/xtask/src/directions.rs what it may depend on",
            )];
        };
        let ours = |d: &&Dependency| self.members.iter().any(|member| member.name == d.name);
        let mut violations = Vec::new();
        for dependency in package.dependencies.iter().filter(ours) {
            let target = dependency.name.as_str();
            if dependency.is_dev {
                if TOOLS.contains(&target) {
                    violations.push(broken(
                        "no-tool-below",
                        format!("`{name}` tests with `{target}`"),
                        "nothing imports the tools: run the command's tests in the command's own package",
                    ));
                }
            } else if let Some(row) =
                allowed.iter().find(|row| row.trim_start_matches('?') == target)
            {
                if row.starts_with('?') && !dependency.is_optional {
                    violations.push(broken(
                        "adapters-are-optional",
                        format!("`{name}` always depends on `{target}`"),
                        "what a scene does not ask for is not even compiled: put it behind a feature",
                    ));
                }
            } else {
                violations.push(broken(
                    "crate-direction",
                    format!("`{name}` depends on `{target}`"),
                    why_not(name, target),
                ));
            }
        }
        violations
    }

    /// Foreign crates that a pure crate must not ship with.
    fn check_reach(&self, pure: &str) -> Vec<Violation> {
        let mut reached: BTreeMap<&str, &str> = BTreeMap::new(); // crate, and who brought it
        let mut open = vec![pure];
        while let Some(from) = open.pop() {
            for to in self.shipped.get(from).into_iter().flatten() {
                if !reached.contains_key(to.as_str()) {
                    reached.insert(to, from);
                    open.push(to);
                }
            }
        }
        let far = FAR_FROM_PURE.iter().filter_map(|far| Some((*far, *reached.get(far)?)));
        far.map(|(far, through)| Violation {
            place: format!("crates/{pure}/Cargo.toml"),
            rule: "pure-crates",
            found: format!("`{pure}` ships with `{far}`, brought by `{through}`"),
            reason: "the crates that compute open no files, read no clock and touch no GPU, however far down",
        })
        .collect()
    }
}

/// The reason that fits best.
fn why_not(from: &str, to: &str) -> &'static str {
    const ADAPTERS: [&str; 6] = [
        "cranny-rapier",
        "cranny-rapier-f64",
        "cranny-record",
        "cranny-render",
        "cranny-rerun",
        "cranny-scene",
    ];
    const PHASES: [&str; 2] = ["cranny-broad-phase", "cranny-narrow-phase"];
    match () {
        () if TOOLS.contains(&to) => "nothing imports the tools",
        () if to == "cranny-testkit" => {
            "the oracles are for tests only: make it a dev-dependency of integration tests"
        }
        () if PHASES.contains(&from) && PHASES.contains(&to) => {
            "the two phases know nothing of each other: cranny-world brings them together"
        }
        () if ADAPTERS.contains(&from) && ADAPTERS.contains(&to) => {
            "the adapters know nothing of each other: cranny-ecs composes them"
        }
        () => {
            "arrows point downward only: the table is in tools/xtask/src/directions.rs and ARCHITECTURE.md"
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    /// A crate, and its dependencies as `(name, kind, optional)`.
    type Row<'a> = (&'a str, &'a [(&'a str, Value, bool)]);

    /// A workspace of the given packages.
    fn graph(packages: &[Row<'_>]) -> Graph {
        let list: Vec<Value> = packages
            .iter()
            .map(|(name, dependencies)| {
                let dependencies: Vec<Value> = dependencies
                    .iter()
                    .map(|(name, kind, optional)| json!({"name": name, "kind": kind, "optional": optional}))
                    .collect();
                json!({"id": name, "name": name, "manifest_path": format!("/w/crates/{name}/Cargo.toml"),
                       "dependencies": dependencies})
            })
            .collect();
        let members: Vec<&Value> = list
            .iter()
            .map(|p| &p["id"])
            .filter(|id| id.as_str().is_some_and(|s| s != "wgpu"))
            .collect();
        let nodes: Vec<Value> = packages
            .iter()
            .map(|(name, dependencies)| {
                let deps: Vec<Value> = dependencies
                    .iter()
                    .map(|(to, kind, _)| json!({"pkg": to, "dep_kinds": [{"kind": kind}]}))
                    .collect();
                json!({"id": name, "deps": deps})
            })
            .collect();
        Graph::from_metadata(&json!({"workspace_root": "/w", "workspace_members": members,
                                     "packages": list, "resolve": {"nodes": nodes}}))
        .expect("a graph")
    }

    fn rules(graph: &Graph) -> Vec<&'static str> {
        graph.check().iter().map(|violation| violation.rule).collect()
    }

    const NORMAL: Value = Value::Null;

    fn dev() -> Value {
        json!("dev")
    }

    #[test]
    fn downward_is_allowed_and_the_testkit_in_tests() {
        let graph = graph(&[
            ("cranny-exact", &[("cranny-testkit", dev(), false), ("glam", NORMAL, false)]),
            ("cranny-geometry", &[("cranny-exact", NORMAL, false)]),
            ("cranny-testkit", &[("cranny-geometry", NORMAL, false)]),
            ("cranny-render", &[("cranny-exact", NORMAL, false)]),
            ("cranny-ecs", &[("cranny-render", NORMAL, true)]),
        ]);
        assert_eq!(graph.check(), []);
    }

    #[test]
    fn wrong_arrows_are_named_with_their_reason() {
        let graph = graph(&[
            ("cranny-broad-phase", &[("cranny-narrow-phase", NORMAL, false)]),
            ("cranny-narrow-phase", &[("cranny-testkit", NORMAL, false)]),
            ("cranny-record", &[("cranny-render", NORMAL, true)]),
            ("cranny-render", &[("cranny-cli", dev(), false)]),
            ("cranny-testkit", &[]),
            ("cranny-ecs", &[("cranny-record", NORMAL, false)]),
            ("cranny-cli", &[]),
            ("cranny-new", &[]),
        ]);
        assert_eq!(
            rules(&graph),
            [
                "crate-direction",
                "crate-direction",
                "crate-direction",
                "no-tool-below",
                "adapters-are-optional",
                "unknown-crate"
            ]
        );
        let text = graph.check()[0].to_string();
        assert!(text.starts_with("crates/cranny-broad-phase/Cargo.toml: ["), "{text}");
        assert!(text.contains("the two phases"), "{text}");
        assert!(graph.check()[2].reason.contains("cranny-ecs composes"));
    }

    #[test]
    fn a_gpu_far_below_a_pure_crate_is_found_but_not_one_below_its_tests() {
        let shipped = graph(&[
            ("cranny-exact", &[("glam", NORMAL, false)]),
            ("glam", &[("wgpu", NORMAL, false)]),
            ("wgpu", &[]),
        ]);
        let found = shipped.check();
        let reach = found.iter().find(|v| v.rule == "pure-crates").expect("found");
        assert!(reach.found.contains("`wgpu`, brought by `glam`"), "{reach}");
        let tested = graph(&[("cranny-exact", &[("wgpu", dev(), false)]), ("wgpu", &[])]);
        assert_eq!(tested.check(), []);
    }

    #[test]
    fn every_row_points_at_rows_of_the_table() {
        for (row, allowed) in TABLE {
            for target in *allowed {
                let target = target.trim_start_matches('?');
                assert!(TABLE.iter().any(|(name, _)| *name == target), "{row}: {target}");
            }
        }
    }
}
