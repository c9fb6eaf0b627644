//! The rooms of the library, which are the folders of `layer/src`, import each other without circles; its unsafe blocks are short.
//!
//! `vk` and `backend` are several rooms: each of their folders and files is one. Unit tests are left out, and so are the re-exports of the file that
//! declares a room's parts.

#![allow(clippy::unwrap_used, reason = "a test")]

mod imports;
mod unsafe_blocks;

use imports::{Import, imports};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// Top folders whose own folders and files are rooms.
const PARTED: [&str; 2] = ["backend", "vk"];

/// Imports that may still close a circle, from one room to another. To be emptied.
const ALLOWED: [(&str, &str); 0] = [];

/// Rooms by room that they import, with an example each.
type Graph = BTreeMap<String, BTreeMap<String, Import>>;

fn source_folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("src")
}

/// The sources below a folder except unit tests, each as the path of its module.
fn modules(folder: &Path, above: &[String], into: &mut BTreeMap<Vec<String>, String>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_stem().unwrap().to_str().unwrap().to_owned();
        let module: Vec<String> = above.iter().cloned().chain([name]).collect();
        if module.last().is_some_and(|name| name == "tests" || name == "lib") {
            continue;
        }
        if path.is_dir() {
            modules(&path, &module, into);
        } else {
            into.insert(module, fs::read_to_string(&path).unwrap());
        }
    }
}

/// The room of a module or item.
fn room(path: &[String]) -> String {
    let depth = if path.first().is_some_and(|top| PARTED.contains(&top.as_str())) { 2 } else { 1 };
    path[..depth.min(path.len())].join("::")
}

fn graph(modules: &BTreeMap<Vec<String>, String>) -> Graph {
    let mut graph = Graph::new();
    for (module, source) in modules {
        for import in imports(module, source) {
            // The longest prefix that is a module; of a re-export, the module that it is named by.
            let target = (1..=import.path.len()).rev().map(|len| &import.path[..len]);
            let Some(target) = target.into_iter().find(|path| modules.contains_key(*path)) else { continue };
            let (from, to) = (room(module), room(target));
            let is_own_part = modules.contains_key(&vec![from.clone()]) && import.is_public;
            if from != to && !is_own_part {
                graph.entry(from).or_default().entry(to).or_insert(import);
            }
        }
    }
    graph
}

/// A circle of rooms; `None` if there is none.
fn circle(graph: &Graph) -> Option<Vec<String>> {
    fn visit(
        graph: &Graph,
        room: &str,
        path: &mut Vec<String>,
        done: &mut BTreeSet<String>,
    ) -> Option<Vec<String>> {
        if let Some(start) = path.iter().position(|known| known == room) {
            return Some(path[start..].to_vec());
        }
        if done.contains(room) {
            return None;
        }
        path.push(room.to_owned());
        let found = graph
            .get(room)
            .into_iter()
            .flat_map(BTreeMap::keys)
            .filter(|to| !ALLOWED.contains(&(room, to.as_str())))
            .find_map(|to| visit(graph, to, path, done));
        path.pop();
        done.insert(room.to_owned());
        found
    }
    let mut done = BTreeSet::new();
    graph.keys().find_map(|room| visit(graph, room, &mut Vec::new(), &mut done))
}

/// A circle with the import that closes each step.
fn described(graph: &Graph, circle: &[String]) -> String {
    let next = circle.iter().cycle().skip(1);
    let step = |(from, to): (&String, &String)| {
        let import = &graph[from][to];
        format!("{from} -> {to}: {} imports {}", import.file, import.path.join("::"))
    };
    circle.iter().zip(next).map(step).collect::<Vec<_>>().join("\n")
}

#[test]
fn rooms_import_each_other_without_circles() {
    let mut found = BTreeMap::new();
    modules(&source_folder(), &[], &mut found);
    assert!(found.len() > 200, "{} modules", found.len());
    let graph = graph(&found);
    let count: usize = graph.values().map(BTreeMap::len).sum();
    assert!(graph.len() > 25 && count > 100, "{} rooms, {count} imports", graph.len());
    if let Some(circle) = circle(&graph) {
        panic!("rooms of layer/src in a circle:\n{}", described(&graph, &circle));
    }
}

#[test]
fn a_circle_is_found() {
    let sources = [
        ("gpu", "use crate::vk::objects::{Image, View as V};"),
        ("vk", "mod objects;\npub use objects::Image;"),
        ("vk/objects", "mod views;"),
        ("vk/objects/views", "use super::super::frame;"),
        ("vk/frame", "fn f() { crate::gpu::g(); }\n#[cfg(test)]\nmod tests {\n    use crate::xr;\n}"),
        ("xr", "use crate::{gpu, vk::frame};"),
    ];
    let modules: BTreeMap<Vec<String>, String> = sources
        .into_iter()
        .map(|(path, source)| (path.split('/').map(str::to_owned).collect(), source.to_owned()))
        .collect();
    let graph = graph(&modules);
    let edges: Vec<_> =
        graph.iter().flat_map(|(from, to)| to.keys().map(move |to| (from.as_str(), to.as_str()))).collect();
    assert_eq!(
        edges,
        [
            ("gpu", "vk::objects"),
            ("vk::frame", "gpu"),
            ("vk::objects", "vk::frame"),
            ("xr", "gpu"),
            ("xr", "vk::frame")
        ]
    );
    assert_eq!(circle(&graph).unwrap(), ["gpu", "vk::objects", "vk::frame"]);
}
