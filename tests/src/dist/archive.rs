//! Archives: `.tar.gz`, and the one for people, with its installer.

use super::{Entry, Parts, VERSION};
use flate2::Compression;
use flate2::write::GzEncoder;
use std::collections::BTreeSet;
use std::io;

const INSTALLER: &str = include_str!("install.sh");

/// The archive for people: `parafovea-<version>-<architecture>/` with `install.sh`.
///
/// # Errors
/// None on writing to memory.
pub fn archive(parts: &Parts) -> io::Result<Vec<u8>> {
    let [bash, zsh, fish, manual] = &parts.generated;
    let mut entries = vec![
        Entry::new("install.sh", 0o755, INSTALLER),
        Entry::new("bin/parafovea", 0o755, parts.command.as_slice()),
        Entry::new("lib/parafovea/parafovea-probe", 0o755, parts.probe.as_slice()),
        Entry::new("share/bash-completion/completions/parafovea", 0o644, bash.as_slice()),
        Entry::new("share/zsh/site-functions/_parafovea", 0o644, zsh.as_slice()),
        Entry::new("share/fish/vendor_completions.d/parafovea.fish", 0o644, fish.as_slice()),
        Entry::new("share/man/man1/parafovea.1", 0o644, manual.as_slice()),
    ];
    let libraries = parts.libraries.iter();
    entries.extend(
        libraries.map(|(name, bytes)| Entry::new(format!("lib/parafovea/{name}"), 0o755, bytes.as_slice())),
    );
    entries.extend(parts.texts.iter().map(|(name, text)| Entry::new(*name, 0o644, text.as_slice())));
    let top = format!("parafovea-{VERSION}-{}", std::env::consts::ARCH);
    for entry in &mut entries {
        entry.path = format!("{top}/{}", entry.path);
    }
    tar_gz(&entries, parts.time)
}

/// Packs entries and the folders above them.
pub(crate) fn tar_gz(entries: &[Entry], time: u64) -> io::Result<Vec<u8>> {
    let mut builder = tar::Builder::new(GzEncoder::new(Vec::new(), Compression::default()));
    let header = |kind, mode, size| {
        let mut header = tar::Header::new_gnu();
        header.set_entry_type(kind);
        header.set_mode(mode);
        header.set_size(size);
        header.set_mtime(time);
        header.set_uid(0);
        header.set_gid(0);
        header
    };
    let mut folders = BTreeSet::new();
    for entry in entries {
        for (end, _) in entry.path.match_indices('/') {
            let folder = &entry.path[..=end];
            if folders.insert(folder) {
                builder.append_data(&mut header(tar::EntryType::Directory, 0o755, 0), folder, io::empty())?;
            }
        }
        let size = entry.content.len() as u64;
        let mut header = header(tar::EntryType::Regular, entry.mode, size);
        builder.append_data(&mut header, &entry.path, entry.content.as_slice())?;
    }
    builder.into_inner()?.finish()
}
