//! The modules of the library, which are the folders of `layer/src`, have no import cycles; its unsafe blocks are short.
//!
//! `vk` and `backend` are several modules: each of their folders and files is one. Unit tests are left out, and so are the re-exports of
//! the file that declares a module's parts.

#![allow(clippy::unwrap_used, reason = "a test")]

mod imports;
mod unsafe_blocks;

use imports::{Import, imports};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// Top folders whose own folders and files are modules.
const PARTED: [&str; 2] = ["backend", "vk"];

/// Imports that may still close a cycle, from one module to another. To be emptied.
const ALLOWED: [(&str, &str); 0] = [];

/// Imported modules by importing module, with an example each.
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

/// The module that a source or an item belongs to.
fn module_of(path: &[String]) -> String {
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
            let (from, to) = (module_of(module), module_of(target));
            let is_own_part = modules.contains_key(&vec![from.clone()]) && import.is_public;
            if from != to && !is_own_part {
                graph.entry(from).or_default().entry(to).or_insert(import);
            }
        }
    }
    graph
}

/// A cycle of modules; `None` if there is none.
fn cycle(graph: &Graph) -> Option<Vec<String>> {
    fn visit(
        graph: &Graph,
        module: &str,
        path: &mut Vec<String>,
        done: &mut BTreeSet<String>,
    ) -> Option<Vec<String>> {
        if let Some(start) = path.iter().position(|known| known == module) {
            return Some(path[start..].to_vec());
        }
        if done.contains(module) {
            return None;
        }
        path.push(module.to_owned());
        let found = graph
            .get(module)
            .into_iter()
            .flat_map(BTreeMap::keys)
            .filter(|to| !ALLOWED.contains(&(module, to.as_str())))
            .find_map(|to| visit(graph, to, path, done));
        path.pop();
        done.insert(module.to_owned());
        found
    }
    let mut done = BTreeSet::new();
    graph.keys().find_map(|module| visit(graph, module, &mut Vec::new(), &mut done))
}

/// A cycle with the import that closes each step.
fn described(graph: &Graph, cycle: &[String]) -> String {
    let next = cycle.iter().cycle().skip(1);
    let step = |(from, to): (&String, &String)| {
        let import = &graph[from][to];
        format!("{from} -> {to}: {} imports {}", import.file, import.path.join("::"))
    };
    cycle.iter().zip(next).map(step).collect::<Vec<_>>().join("\n")
}

#[test]
fn modules_have_no_import_cycles() {
    let mut found = BTreeMap::new();
    modules(&source_folder(), &[], &mut found);
    assert!(found.len() > 200, "{} modules", found.len());
    let graph = graph(&found);
    let count: usize = graph.values().map(BTreeMap::len).sum();
    assert!(graph.len() > 25 && count > 100, "{} modules, {count} imports", graph.len());
    if let Some(cycle) = cycle(&graph) {
        panic!("an import cycle of modules of layer/src:\n{}", described(&graph, &cycle));
    }
}

#[test]
fn a_cycle_is_found() {
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
    assert_eq!(cycle(&graph).unwrap(), ["gpu", "vk::objects", "vk::frame"]);
}
