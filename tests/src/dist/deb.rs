//! The Debian package: an `ar` archive of a version, a control archive and a data archive (deb(5)).

use super::archive::tar_gz;
use super::{Entry, Parts, VERSION};
use flate2::Compression;
use flate2::write::GzEncoder;
use parafovea_manifest::install::LIBRARY_NAME;
use parafovea_manifest::json::Half;
use std::io::{self, Write};
use std::path::Path;

/// The package. Its files are for all users of a machine; games have the layer only if it is enabled for them.
///
/// # Errors
/// None on writing to memory.
pub fn package(parts: &Parts) -> io::Result<Vec<u8>> {
    let files = files(parts)?;
    let control = [Entry::new("./control", 0o644, control(parts, &files))];
    let mut package = ar::Builder::new(Vec::new());
    let members: [(&str, Vec<u8>); 3] = [
        ("debian-binary", b"2.0\n".to_vec()),
        ("control.tar.gz", tar_gz(&control, parts.time)?),
        ("data.tar.gz", tar_gz(&files, parts.time)?),
    ];
    for (name, content) in members {
        let mut header = ar::Header::new(name.as_bytes().to_vec(), content.len() as u64);
        header.set_mode(0o100_644);
        header.set_mtime(parts.time);
        package.append(&header, content.as_slice())?;
    }
    package.into_inner()
}

/// Debian's name for the architecture that this was built for.
pub fn architecture() -> &'static str {
    match std::env::consts::ARCH {
        "x86_64" => "amd64",
        "aarch64" => "arm64",
        other => other,
    }
}

fn files(parts: &Parts) -> io::Result<Vec<Entry>> {
    let [bash, zsh, fish, manual] = &parts.generated;
    let mut zipped = GzEncoder::new(Vec::new(), Compression::default());
    zipped.write_all(manual)?;
    let mut files = vec![
        Entry::new("./usr/bin/parafovea", 0o755, parts.command.as_slice()),
        Entry::new("./usr/lib/parafovea/parafovea-probe", 0o755, parts.probe.as_slice()),
        Entry::new("./usr/share/bash-completion/completions/parafovea", 0o644, bash.as_slice()),
        Entry::new("./usr/share/zsh/vendor-completions/_parafovea", 0o644, zsh.as_slice()),
        Entry::new("./usr/share/fish/vendor_completions.d/parafovea.fish", 0o644, fish.as_slice()),
        Entry::new("./usr/share/man/man1/parafovea.1.gz", 0o644, zipped.finish()?),
        Entry::new("./usr/share/doc/parafovea/copyright", 0o644, copyright(parts)),
    ];
    for (name, bytes) in &parts.libraries {
        files.push(Entry::new(format!("./usr/lib/parafovea/{name}"), 0o644, bytes.as_slice()));
    }
    for half in Half::BOTH {
        let path = half.manifest_path(Path::new("./usr/share"));
        // From the manifest's folder up to /usr: as many folders as there are below that.
        let up = "../".repeat(path.components().count() - 3);
        let library = format!("{up}lib/parafovea/{LIBRARY_NAME}");
        // A package does not know who gives the gaze to games (`gaze.offer`); without that, their system has no eye gaze.
        let manifest = half.manifest_with_eye_gaze(&library);
        files.push(Entry::new(path.to_string_lossy(), 0o644, manifest));
    }
    for (name, text) in parts.texts.iter().filter(|(name, _)| !name.starts_with("LICENSE")) {
        files.push(Entry::new(format!("./usr/share/doc/parafovea/{name}"), 0o644, text.as_slice()));
    }
    Ok(files)
}

fn control(parts: &Parts, files: &[Entry]) -> String {
    let [major, minor] = parts.glibc;
    let kibibytes: usize = files.iter().map(|file| file.content.len().div_ceil(1024)).sum();
    format!(
        "Package: parafovea\n\
         Version: {VERSION}\n\
         Architecture: {}\n\
         Maintainer: Parafovea contributors <contributors@parafovea.invalid>\n\
         Installed-Size: {kibibytes}\n\
         Depends: libc6 (>= {major}.{minor}), libgcc-s1, libvulkan1\n\
         Recommends: libasound2t64 | libasound2\n\
         Suggests: libopenxr-loader1\n\
         Section: graphics\n\
         Priority: optional\n\
         Description: foveated rendering for existing OpenXR games\n \
         An OpenXR API layer and a Vulkan layer in one library: it follows the eyes and\n \
         lowers the shading rate in the periphery. Games use it only on request:\n \
         parafovea run -- GAME.\n",
        architecture()
    )
}

fn copyright(parts: &Parts) -> Vec<u8> {
    let mut text =
        b"Parafovea is licensed under MIT or Apache-2.0, as you prefer. The Apache License is in\n\
        /usr/share/common-licenses/Apache-2.0; the MIT licence:\n\n"
            .to_vec();
    if let Some((_, mit)) = parts.texts.iter().find(|(name, _)| *name == "LICENSE-MIT") {
        text.extend_from_slice(mit);
    }
    text
}
