//! The debug view that `parafovea status --view` requests of a running application, in place of its configuration's.
//!
//! It is a file with the view's name beside the status, in the folder that is its user's alone, and goes with the session: the
//! configuration stays as the user wrote it.

use super::request::{self, request_file};
use crate::options::DebugView;
use crate::paths::Environment;
use std::io;
use std::path::PathBuf;

/// More than a name has.
const MOST_BYTES: usize = 32;

/// The requests of this kind.
pub(super) const KIND: &str = "view";

/// The place where a process looks for requests.
#[derive(Debug)]
pub struct AskedView(Option<PathBuf>);

impl AskedView {
    /// Of the process `pid`, as it knows itself.
    pub fn new(environment: &Environment, pid: u32) -> Self {
        Self(environment.status_folder().map(|folder| request_file(&folder, pid, KIND)))
    }

    /// The requested view; `None` for the configuration's. Anything but the name of a view, in a file that only this folder's owner
    /// can write, counts as no request. Never waits, and allocates nothing.
    pub fn look(&self) -> Option<DebugView> {
        DebugView::of_name(request::read(self.0.as_deref()?, &mut [0; MOST_BYTES])?)
    }
}

/// Requests `view` of the process `pid`, as its status calls it; `None` for the configuration's view. It follows within a second.
///
/// # Errors
/// There is no status folder, or the file system refuses.
pub fn ask_view(environment: &Environment, pid: u32, view: Option<DebugView>) -> io::Result<()> {
    request::write(environment, pid, KIND, view.map(DebugView::name))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::status::StatusFile;
    use std::fs;
    use std::os::unix::fs::{PermissionsExt, symlink};
    use tempfile::TempDir;

    fn environment(folder: &TempDir) -> Environment {
        Environment::new(false, |name| (name == "XDG_RUNTIME_DIR").then(|| folder.path().into()))
    }

    #[test]
    fn a_requested_view_lasts_until_the_session_ends() {
        let runtime = TempDir::new().unwrap();
        let environment = environment(&runtime);
        let asked = AskedView::new(&environment, 7);
        assert!(ask_view(&environment, 7, Some(DebugView::Gaze)).is_err(), "nobody has a folder there");
        let session = StatusFile::new(&environment, 7).unwrap().unwrap();
        assert_eq!(asked.look(), None);
        for view in DebugView::ALL {
            ask_view(&environment, 7, Some(*view)).unwrap();
            assert_eq!(asked.look(), Some(*view));
            assert_eq!(AskedView::new(&environment, 8).look(), None, "asked of another process");
        }
        let file = runtime.path().join("parafovea/7.view");
        assert_eq!(fs::metadata(&file).unwrap().permissions().mode() & 0o777, 0o600);
        ask_view(&environment, 7, None).unwrap();
        ask_view(&environment, 7, None).unwrap();
        assert_eq!(asked.look(), None);
        ask_view(&environment, 7, Some(DebugView::Gaze)).unwrap();
        drop(session);
        assert_eq!(fs::read_dir(runtime.path().join("parafovea")).unwrap().count(), 0);
        assert_eq!(asked.look(), None);
    }

    #[test]
    fn a_new_process_is_not_asked_what_an_earlier_one_was() {
        let runtime = TempDir::new().unwrap();
        let environment = environment(&runtime);
        let earlier = StatusFile::new(&environment, 7).unwrap().unwrap();
        ask_view(&environment, 7, Some(DebugView::Rates)).unwrap();
        std::mem::forget(earlier);
        let _later = StatusFile::new(&environment, 7).unwrap().unwrap();
        assert_eq!(AskedView::new(&environment, 7).look(), None);
    }

    #[test]
    fn requests_that_others_could_have_written_are_ignored() {
        let runtime = TempDir::new().unwrap();
        let environment = environment(&runtime);
        let _session = StatusFile::new(&environment, 7).unwrap().unwrap();
        let (file, asked) = (runtime.path().join("parafovea/7.view"), AskedView::new(&environment, 7));
        for text in
            ["", "everything", "gazegaze", "\0", "none\0", "gaze gaze gaze gaze gaze gaze gaze gaze gaze"]
        {
            fs::write(&file, text).unwrap();
            assert_eq!(asked.look(), None, "{text}");
        }
        fs::write(&file, "gaze\n").unwrap();
        fs::set_permissions(&file, fs::Permissions::from_mode(0o644)).unwrap();
        assert_eq!(asked.look(), Some(DebugView::Gaze));
        fs::set_permissions(&file, fs::Permissions::from_mode(0o666)).unwrap();
        assert_eq!(asked.look(), None, "others may write it");
        fs::remove_file(&file).unwrap();
        let elsewhere = runtime.path().join("elsewhere");
        fs::write(&elsewhere, "gaze").unwrap();
        symlink(&elsewhere, &file).unwrap();
        assert_eq!(asked.look(), None, "a link");
        fs::remove_file(&file).unwrap();
        fs::create_dir(&file).unwrap();
        assert_eq!(asked.look(), None, "a folder");
        assert_eq!(AskedView::new(&Environment::default(), 7).look(), None);
    }
}
