//! Requirements of the tasks on the system: a check for each, and the package that has it.

use std::path::{Path, PathBuf};

/// A package manager that we know package names for.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Manager {
    Apt,
    Dnf,
    Pacman,
}

impl Manager {
    /// All of them, in the order in which a machine is searched for one.
    pub const ALL: [Manager; 3] = [Manager::Apt, Manager::Dnf, Manager::Pacman];

    /// The program that is looked for in `PATH`.
    pub fn program(self) -> &'static str {
        match self {
            Manager::Apt => "apt-get",
            Manager::Dnf => "dnf",
            Manager::Pacman => "pacman",
        }
    }

    /// The command line that installs `packages`, to be run as root.
    pub fn install_command(self, packages: &[&str]) -> String {
        let verb = match self {
            Manager::Apt => "apt-get install",
            Manager::Dnf => "dnf install",
            Manager::Pacman => "pacman -S --needed",
        };
        format!("{verb} {}", packages.join(" "))
    }
}

/// Something that the tasks use and that cargo cannot bring.
pub struct Need {
    /// Its name, for people.
    pub what: &'static str,
    /// Consequence of its absence.
    pub without: &'static str,
    /// The file whose presence proves it.
    pub proof: Proof,
    /// Whether the demo needs it, and not the tests and benches alone.
    pub for_demo: bool,
    /// Package names for [`Manager::ALL`], in that order.
    packages: [&'static str; 3],
}

impl Need {
    /// The package that brings it with `manager`.
    pub fn package(&self, manager: Manager) -> &'static str {
        self.packages[manager as usize]
    }
}

/// A file that proves that something is installed; looking is much faster than asking a package manager.
pub enum Proof {
    /// A program in `PATH`.
    Program(&'static str),
    /// A shared library in one of the usual folders, or in `LD_LIBRARY_PATH`.
    Library(&'static str),
    /// A C header in one of the usual folders.
    Header(&'static str),
    /// A file in a folder below the data or configuration folders (`/usr/share`, `/etc`, ...), by prefix.
    Data { folder: &'static str, prefix: &'static str },
}

impl Proof {
    /// Whether the file exists.
    pub fn holds(&self) -> bool {
        match self {
            Proof::Program(name) => program_in_path(name),
            Proof::Library(name) => library_folders().iter().any(|folder| folder.join(name).exists()),
            Proof::Header(name) => ["/usr/include", "/usr/local/include"]
                .iter()
                .any(|folder| Path::new(folder).join(name).exists()),
            Proof::Data { folder, prefix } => {
                data_folders().iter().any(|data| has_file_with_prefix(&data.join(folder), prefix))
            }
        }
    }
}

/// Everything that the tasks look for. None is needed to build, but for the sound capture library: see [`can_build_audio`].
pub const NEEDS: [Need; 19] = [
    Need {
        what: "lavapipe, a Vulkan driver that renders on the CPU",
        without: "tasks use the first Vulkan driver of this machine, and figures differ from the README's",
        proof: Proof::Data { folder: "vulkan/icd.d", prefix: "lvp_icd" },
        for_demo: true,
        packages: ["mesa-vulkan-drivers", "mesa-vulkan-drivers", "vulkan-swrast"],
    },
    Need {
        what: "the Vulkan loader",
        without: "demo, benchmarks and end-to-end tests fail",
        proof: Proof::Library("libvulkan.so.1"),
        for_demo: true,
        packages: ["libvulkan1", "vulkan-loader", "vulkan-icd-loader"],
    },
    Need {
        what: "the Vulkan validation layer",
        without: "tests that validate Vulkan calls fail",
        proof: Proof::Data { folder: "vulkan/explicit_layer.d", prefix: "VkLayer_khronos_validation" },
        for_demo: false,
        packages: ["vulkan-validationlayers", "vulkan-validation-layers", "vulkan-validation-layers"],
    },
    Need {
        what: "the OpenXR loader",
        without: "demo, benchmarks and end-to-end tests fail",
        proof: Proof::Library("libopenxr_loader.so.1"),
        for_demo: true,
        packages: ["libopenxr-loader1", "openxr-libs", "openxr"],
    },
    Need {
        what: "hello_xr, an unmodified application",
        without: "the demo omits hello_xr, and tests with hello_xr fail",
        proof: Proof::Program("hello_xr"),
        for_demo: true,
        packages: ["libopenxr-utils", "openxr", "openxr"],
    },
    Need {
        what: "the OpenXR core validation layer",
        without: "tests that validate OpenXR calls fail",
        proof: Proof::Data { folder: "openxr/1/api_layers/explicit.d", prefix: "XrApiLayer_core_validation" },
        for_demo: false,
        packages: ["openxr-layer-corevalidation", "openxr", "openxr"],
    },
    Need {
        what: "strace, to trace written files",
        without: "the test that no file contains the gaze is skipped",
        proof: Proof::Program("strace"),
        for_demo: false,
        packages: ["strace", "strace", "strace"],
    },
    Need {
        what: "vulkaninfo, to create Vulkan devices",
        without: "the tests of vulkaninfo on Mesa's drivers are skipped",
        proof: Proof::Program("vulkaninfo"),
        for_demo: false,
        packages: ["vulkan-tools", "vulkan-tools", "vulkan-tools"],
    },
    Need {
        what: "Valgrind, to count instructions",
        without: "the benchmark `overhead` fails",
        proof: Proof::Program("valgrind"),
        for_demo: false,
        packages: ["valgrind", "valgrind", "valgrind"],
    },
    Need {
        what: "CMake, to build the OpenXR loader 1.1",
        without: "tests with the OpenXR loader 1.1 fail",
        proof: Proof::Program("cmake"),
        for_demo: false,
        packages: ["cmake", "cmake", "cmake"],
    },
    Need {
        what: "make, to build the OpenXR loader 1.1",
        without: "tests with the OpenXR loader 1.1 fail",
        proof: Proof::Program("make"),
        for_demo: false,
        packages: ["make", "make", "make"],
    },
    Need {
        what: "X11 headers, to build the OpenXR loader 1.1",
        without: "tests with the OpenXR loader 1.1 fail",
        proof: Proof::Header("X11/Xlib.h"),
        for_demo: false,
        packages: ["libx11-dev", "libX11-devel", "libx11"],
    },
    Need {
        what: "a C++ compiler, to build NVIDIA's FLIP, which compares images, and the OpenXR loader 1.1",
        without: "the demo, and other programs that compare images, cannot be built",
        proof: Proof::Program("c++"),
        for_demo: true,
        packages: ["g++", "gcc-c++", "gcc"],
    },
    Need {
        what: "ALSA headers, to build sound capture",
        without: NO_AUDIO,
        proof: ALSA_HEADERS,
        for_demo: false,
        packages: ["libasound2-dev", "alsa-lib-devel", "alsa-lib"],
    },
    Need {
        what: "pkg-config, to find the ALSA headers",
        without: NO_AUDIO,
        proof: PKG_CONFIG,
        for_demo: false,
        packages: ["pkg-config", "pkgconf-pkg-config", "pkgconf"],
    },
    Need {
        what: "the PulseAudio server, which needs no sound card",
        without: "tests of sound capture fail",
        proof: Proof::Program("pulseaudio"),
        for_demo: false,
        packages: ["pulseaudio", "pulseaudio", "pulseaudio"],
    },
    Need {
        what: "PipeWire's PulseAudio server",
        without: "the test with PipeWire fails",
        proof: Proof::Program("pipewire-pulse"),
        for_demo: false,
        packages: ["pipewire-pulse", "pipewire-pulseaudio", "pipewire-pulse"],
    },
    Need {
        what: "PipeWire's session manager",
        without: "the test with PipeWire fails",
        proof: Proof::Program("wireplumber"),
        for_demo: false,
        packages: ["wireplumber", "wireplumber", "wireplumber"],
    },
    Need {
        what: "D-Bus, for PipeWire's session manager",
        without: "the test with PipeWire fails",
        proof: Proof::Program("dbus-daemon"),
        for_demo: false,
        packages: ["dbus", "dbus-daemon", "dbus"],
    },
];

const NO_AUDIO: &str = "the capture library is not built, and sound capture is missing";

const ALSA_HEADERS: Proof = Proof::Header("alsa/asoundlib.h");

const PKG_CONFIG: Proof = Proof::Program("pkg-config");

/// Whether this machine can build the library that captures sound.
pub fn can_build_audio() -> bool {
    ALSA_HEADERS.holds() && PKG_CONFIG.holds()
}

/// Whether a program of that name is in a folder of `PATH`.
pub fn program_in_path(name: &str) -> bool {
    std::env::var_os("PATH")
        .is_some_and(|path| std::env::split_paths(&path).any(|folder| folder.join(name).is_file()))
}

fn library_folders() -> Vec<PathBuf> {
    let mut folders: Vec<PathBuf> =
        ["/usr/lib64", "/usr/lib", "/usr/local/lib", "/usr/local/lib64", "/lib64", "/lib"]
            .map(PathBuf::from)
            .into();
    // Debian's multiarch folders: /usr/lib/x86_64-linux-gnu and its like.
    let multiarch = std::fs::read_dir("/usr/lib").into_iter().flatten().flatten().map(|entry| entry.path());
    folders.extend(multiarch.filter(|path| path.to_string_lossy().ends_with("-linux-gnu")));
    folders.extend(std::env::var_os("LD_LIBRARY_PATH").iter().flat_map(std::env::split_paths));
    folders
}

fn data_folders() -> Vec<PathBuf> {
    let mut folders: Vec<PathBuf> = ["/usr/share", "/usr/local/share", "/etc"].map(PathBuf::from).into();
    folders.extend(std::env::var_os("XDG_DATA_DIRS").iter().flat_map(std::env::split_paths));
    folders
}

fn has_file_with_prefix(folder: &Path, prefix: &str) -> bool {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    entries.into_iter().any(|entry| entry.file_name().to_string_lossy().starts_with(prefix))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_manager_has_a_command_for_every_need() {
        for manager in Manager::ALL {
            let packages: Vec<&str> = NEEDS.iter().map(|need| need.package(manager)).collect();
            let command = manager.install_command(&packages);
            assert!(command.starts_with(manager.program().split('-').next().unwrap()), "{command}");
            assert!(packages.iter().all(|package| command.contains(package)), "{command}");
        }
    }

    #[test]
    fn proofs_look_at_files() {
        assert!(Proof::Program("sh").holds());
        assert!(!Proof::Program("no-such-program-as-this").holds());
        assert!(Proof::Library("libc.so.6").holds());
        assert!(!Proof::Header("no/such/header.h").holds());
        assert!(!Proof::Data { folder: "no/such/folder", prefix: "" }.holds());
    }
}
