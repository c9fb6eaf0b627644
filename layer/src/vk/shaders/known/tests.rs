use super::*;
use crate::vk::shaders::effects::Effects;
use std::fs;
use std::path::Path;

fn shaders(stores: bool) -> Arc<FragmentShaders> {
    let effects = Effects { stores, ..Effects::default() };
    let every = ("a name with spaces".into(), Effects::UNKNOWN);
    Arc::new(FragmentShaders::from_iter([("main".into(), effects), every]))
}

fn launch(file: &Path) -> Arc<KnownShaders> {
    Arc::new(KnownShaders::at(Some(file.to_owned())))
}

#[test]
fn code_is_requested_only_if_the_next_launch_will_know_it() {
    let folder = tempfile::tempdir().unwrap();
    let known = launch(&folder.path().join("shaders"));
    known.note(b"one", &shaders(false));
    assert!(known.is_worth_a_request(b"two") && !known.is_worth_a_request(b"one"));
    (1..MOST_MODULES as u32).for_each(|number| known.note(&number.to_le_bytes(), &shaders(false)));
    assert!(!known.is_worth_a_request(b"two"), "as many as are kept");

    let nowhere = Arc::new(KnownShaders::at(None));
    assert!(!nowhere.is_worth_a_request(b"two"), "without a file");
    // A folder where the file belongs.
    fs::create_dir(folder.path().join("occupied")).unwrap();
    let unwritable = launch(&folder.path().join("occupied"));
    assert!(unwritable.is_worth_a_request(b"two"));
    unwritable.note(b"one", &shaders(false));
    unwritable.write();
    assert!(!unwritable.is_worth_a_request(b"two"), "after a failed write");
}

#[test]
fn a_second_launch_knows_what_the_first_has_seen() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("parafovea/shaders");
    let first = launch(&file);
    assert_eq!(first.get(b"one"), None);
    first.note(b"one", &shaders(false));
    first.note(b"two", &shaders(true));
    first.note(b"", &shaders(true));
    first.write();
    let second = launch(&file);
    assert_eq!(second.get(b"one"), Some(shaders(false)));
    assert_eq!(second.get(b"two"), Some(shaders(true)));
    assert_eq!((second.get(b"three"), second.get(b"")), (None, None));
    // Two processes at once: neither loses the other's facts.
    let other = launch(&file);
    other.note(b"three", &shaders(true));
    other.write();
    second.note(b"four", &shaders(true));
    second.write();
    let last = launch(&file);
    for identifier in [&b"one"[..], b"two", b"three", b"four"] {
        assert!(last.get(identifier).is_some(), "{identifier:?}");
    }
    let names: Vec<_> =
        fs::read_dir(file.parent().unwrap()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    assert_eq!(names, ["shaders"], "nothing else is left");
}

/// Files cut at any byte, and files with any one byte changed.
#[test]
fn a_damaged_file_has_nothing() {
    let mut facts = Facts::default();
    facts.insert((*b"one").as_slice().into(), shaders(true));
    let text = file::print(&facts);
    assert_eq!(file::parse(&text), Some(facts));
    for end in 0..text.len() {
        assert_eq!(file::parse(&text[..end]), None, "cut after {end} bytes");
    }
    for index in 0..text.len() {
        let mut bytes = text.clone().into_bytes();
        bytes[index] ^= 1;
        let damaged = String::from_utf8(bytes).unwrap();
        assert_eq!(file::parse(&damaged), None, "byte {index}");
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("shaders");
    fs::write(&path, [0xff; 64]).unwrap();
    assert_eq!(launch(&path).get(b"one"), None);
    assert_eq!(launch(folder.path()).get(b"one"), None, "a folder in its place");
}

#[test]
fn the_newest_are_kept() {
    let mut facts = Facts::default();
    let only = shaders(false);
    for number in 0..MOST_MODULES + 10 {
        facts.insert(number.to_ne_bytes().as_slice().into(), Arc::clone(&only));
    }
    assert_eq!((facts.order.len(), facts.by_identifier.len()), (MOST_MODULES, MOST_MODULES));
    let has = |number: usize| facts.by_identifier.contains_key(number.to_ne_bytes().as_slice());
    assert!(!has(9) && has(10) && has(MOST_MODULES + 9));
    assert!((file::print(&facts).len() as u64) < 8 << 20);
}
