//! `parafovea-dist BUILT REPOSITORY OUT`: packs the programs of the folder `BUILT` into the folder `OUT`.

use parafovea_tests::dist::{DistError, NEWEST_GLIBC, Parts, VERSION, archive, package};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::{env, fs, io};

fn main() -> ExitCode {
    let paths: Vec<PathBuf> = env::args_os().skip(1).map(PathBuf::from).collect();
    let [built, repository, out] = paths.as_slice() else {
        eprintln!("usage: parafovea-dist BUILT REPOSITORY OUT");
        return ExitCode::from(2);
    };
    match dist(built, repository, out) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("parafovea-dist: {error}");
            ExitCode::FAILURE
        }
    }
}

fn dist(built: &Path, repository: &Path, out: &Path) -> Result<(), DistError> {
    let parts = Parts::collect(built, repository)?;
    parts.check_release()?;
    let [major, minor] = parts.glibc;
    let [newest_major, newest_minor] = NEWEST_GLIBC;
    println!("needs GLIBC_{major}.{minor}; allowed: at most GLIBC_{newest_major}.{newest_minor}");
    fs::create_dir_all(out).map_err(|source| DistError::File { path: out.to_owned(), source })?;
    let arch = env::consts::ARCH;
    write(&out.join(format!("parafovea-{VERSION}-{arch}.tar.gz")), archive(&parts))?;
    write(
        &out.join(format!("parafovea_{VERSION}_{}.deb", parafovea_tests::dist::debian_architecture())),
        package(&parts),
    )
}

fn write(path: &Path, content: io::Result<Vec<u8>>) -> Result<(), DistError> {
    let written = content.and_then(|content| {
        fs::write(path, &content)?;
        Ok(content.len())
    });
    let bytes = written.map_err(|source| DistError::File { path: path.to_owned(), source })?;
    println!("{} ({:.1} MB)", path.display(), bytes as f64 / 1e6);
    Ok(())
}
