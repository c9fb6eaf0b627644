//! The gaze from OSC packets on Monado: unmodified hello_xr in the system of `cargo dev monado`, a sender outside of it. Maps come from a
//! rate attachment, with the test layer that stands in for one.

use crate::HarnessError;
use crate::artifacts::Library;
use crate::osc::{FORMATS, LOOK, Sender, free_address};
use parafovea_manifest::paths::Environment;
use parafovea_manifest::status::{Status, read_all};
use parafovea_test_layers::{
    SHADING_RATE_FILE_VARIABLE, SHADING_RATE_PROFILE_VARIABLE, SHADING_RATE_TEXELS_VARIABLE, ShadingRateLine,
    ShadingRateMap, ShadingRateProfile, TestLayer,
};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// Longest wait for an event on a busy machine.
const PATIENCE: Duration = Duration::from_secs(90);

/// Interval between reads of the status.
const POLL: Duration = Duration::from_millis(100);

/// Of an eye tracker of 100 Hz.
const PERIOD: Duration = Duration::from_millis(10);

/// Frames until filter and safety limits have settled, and more.
const SETTLING_FRAMES: u64 = 100;

/// The most by which the centre of full rates may be elsewhere, texels: Monado's simulated head moves, and with it the area for a gaze that
/// moves in the world.
const NEAR_TEXELS: f32 = 1.0;

/// Enters the system with the kernel's folders for as long as a program runs.
const ENTER: &str = r#"mount --bind /proc "$0/proc" && mount --bind /dev "$0/dev" && exec chroot "$0" "$@""#;

/// The file of maps in the system.
const MAPS: &str = "tmp/rates.jsonl";

/// The recording of the gaze in the system.
const RECORDING: &str = "opt/parafovea/gaze.csv";

/// The system in its folder.
#[derive(Debug)]
pub struct Bed {
    root: PathBuf,
}

/// A run's status and its last map.
#[derive(Debug)]
struct Seen {
    status: Status,
    map: ShadingRateMap,
}

impl Bed {
    /// Puts the layers of tests into the system at `root`, which `cargo dev monado` has filled.
    ///
    /// # Errors
    /// [`HarnessError::NotBuilt`], and errors of files.
    pub fn new(root: &Path) -> Result<Self, HarnessError> {
        let library = root.join("opt/layers/libparafovea_test_layers.so");
        let manifests = root.join("root/.local/share/vulkan/explicit_layer.d");
        fs::create_dir_all(root.join("opt/layers")).map_err(HarnessError::file(&library))?;
        fs::copy(Library::TestLayers.path()?, &library).map_err(HarnessError::file(&library))?;
        let inside = Path::new("/opt/layers/libparafovea_test_layers.so");
        TestLayer::write_manifests(inside, &manifests).map_err(HarnessError::file(&manifests))?;
        Ok(Self { root: root.to_owned() })
    }

    /// Drives hello_xr with each format, and prints a line for each.
    ///
    /// # Errors
    /// The layer does not report a format, or its maps differ from the maps of the same gaze in a file.
    pub fn follow_packets(&self) -> Result<(), HarnessError> {
        let [left, up] = LOOK;
        self.write(RECORDING, &format!("0,{left},{up}\n"))?;
        let file = self.seen("source = \"file\"\nfile = \"/opt/parafovea/gaze.csv\"", |status| {
            status.gaze.holder == "file" && status.gaze.is_valid
        })?;
        let address = free_address().map_err(HarnessError::file(Path::new("a UDP port")))?;
        let lines = format!("source = \"osc\"\nosc_listen = \"{address}\"");
        let nobody = self.seen(&lines, |status| status.gaze.holder == "osc" && !status.gaze.is_valid)?;
        let [expected, elsewhere] = [&file, &nobody].map(|seen| centre(&seen.map));
        if distance(expected, elsewhere) <= NEAR_TEXELS {
            return Err(failed(format!("rates around {expected:?} with a gaze, {elsewhere:?} without")));
        }
        println!("a file: full rates around texel {expected:.1?}; no packets: {elsewhere:.1?}");
        for format in FORMATS {
            // As eyes and trackers are, never quite at rest: Monado's head turns, and a gaze that stays the same to the last digit is rejected.
            let mut trembles = (0u8..7).cycle().map(|turn| f32::from(turn) * 0.02);
            let sender = Sender::new(
                address,
                move || (format.packets)([left + trembles.next().unwrap_or_default(), up]),
                PERIOD,
            );
            let _sender = sender.map_err(HarnessError::file(Path::new("a UDP port")))?;
            let seen = self.seen(&lines, |status| {
                let gaze = &status.gaze;
                gaze.holder == "osc" && gaze.is_valid && gaze.osc.format == format.status
            })?;
            let found = centre(&seen.map);
            let osc = &seen.status.gaze.osc;
            println!(
                "{}: {}; {} packets; full rates around texel {found:.1?}",
                format.name, seen.status.gaze, osc.packets
            );
            if distance(expected, found) > NEAR_TEXELS || osc.malformed > 0 {
                return Err(failed(format!("{}: {found:?} instead of {expected:?}, {osc:?}", format.name)));
            }
        }
        Ok(())
    }

    /// Runs hello_xr until its status has been so for a while.
    fn seen(&self, gaze: &str, is_so: impl Fn(&Status) -> bool) -> Result<Seen, HarnessError> {
        let config = format!("[gaze]\n{gaze}\n[rates]\nmode = \"fixed\"\ngate = \"on\"\n");
        self.write("root/.config/parafovea/config.toml", &config)?;
        // Of an earlier run, if there was one.
        let _ = fs::remove_file(self.root.join(MAPS));
        let mut child = self.start()?;
        let watched = self.watch(&mut child, is_so);
        // hello_xr ends with its input, which ends with this.
        self.write("run/monado/ended", "")?;
        let ended = child.wait().map_err(HarnessError::file(&self.root))?;
        let status = watched?;
        if !ended.success() {
            return Err(failed(format!("hello_xr: {ended}\n{}", self.read("tmp/output.log"))));
        }
        let lines = self.read(MAPS);
        let mut maps = lines.lines().filter_map(|line| match serde_json::from_str(line) {
            Ok(ShadingRateLine::Pass(pass)) => pass.map,
            Ok(ShadingRateLine::Finding(_)) | Err(_) => None,
        });
        let map = maps.next_back().ok_or_else(|| failed(format!("no map\n{}", self.log())))?;
        Ok(Seen { status, map })
    }

    fn start(&self) -> Result<Child, HarnessError> {
        let mut command = Command::new("unshare");
        command.args(["--mount", "sh", "-c", ENTER]).arg(&self.root);
        // Tenths of a second for which hello_xr may show frames.
        command.args(["env", "PLAYED=900", "bash", "/opt/parafovea/run.sh", "env"]);
        command.arg(format!("VK_INSTANCE_LAYERS={}", TestLayer::ShadingRate.name()));
        command.arg(format!("{SHADING_RATE_PROFILE_VARIABLE}={}", ShadingRateProfile::NvkTuring.name()));
        command.arg(format!("{SHADING_RATE_FILE_VARIABLE}=/{MAPS}"));
        command.arg(format!("{SHADING_RATE_TEXELS_VARIABLE}=1"));
        command.args(["/opt/parafovea/parafovea", "run", "--", "hello_xr", "-g", "Vulkan2"]);
        command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
        command.spawn().map_err(|source| HarnessError::Start { program: "unshare".into(), source })
    }

    /// The status, after it has been so for enough frames.
    fn watch(&self, child: &mut Child, is_so: impl Fn(&Status) -> bool) -> Result<Status, HarnessError> {
        let (begun, folder) = (Instant::now(), self.root.join("run/monado"));
        let environment =
            Environment::new(false, |name| (name == "XDG_RUNTIME_DIR").then(|| folder.clone().into()));
        let mut since: Option<u64> = None;
        let mut newest = None;
        while begun.elapsed() < PATIENCE && matches!(child.try_wait(), Ok(None)) {
            let found = read_all(&environment, std::time::SystemTime::now()).found;
            if let Some(status) = found.into_iter().next().map(|found| found.status) {
                since = is_so(&status).then(|| since.unwrap_or(status.frames));
                if since.is_some_and(|since| status.frames >= since + SETTLING_FRAMES) {
                    return Ok(status);
                }
                newest = Some(status);
            }
            sleep(POLL);
        }
        Err(failed(format!("never so: {:?}\n{}{}", newest, self.read("tmp/output.log"), self.log())))
    }

    fn write(&self, path: &str, text: &str) -> Result<(), HarnessError> {
        let path = self.root.join(path);
        fs::write(&path, text).map_err(HarnessError::file(&path))
    }

    fn read(&self, path: &str) -> String {
        String::from_utf8_lossy(&fs::read(self.root.join(path)).unwrap_or_default()).into_owned()
    }

    fn log(&self) -> String {
        let folder = self.root.join("root/.local/state/parafovea");
        let files = fs::read_dir(folder).into_iter().flatten().flatten();
        files
            .map(|file| String::from_utf8_lossy(&fs::read(file.path()).unwrap_or_default()).into_owned())
            .collect()
    }
}

fn failed(reason: String) -> HarnessError {
    HarnessError::Application { application: "hello_xr on Monado".to_owned(), reason, output: String::new() }
}

/// The centre of the texels with full rates, texels from the left upper corner; the corner without any.
fn centre(map: &ShadingRateMap) -> [f32; 2] {
    let [width, _, _] = map.extent;
    let digits = map.texels.as_deref().unwrap_or_default().as_bytes();
    let full = digits.chunks(2).enumerate().filter(|(_, texel)| *texel == b"00");
    let (mut count, mut sum) = (0, [0.0; 2]);
    for (index, _) in full {
        let index = index as u32;
        count += 1;
        sum[0] += (index % width.max(1)) as f32;
        sum[1] += (index / width.max(1)) as f32;
    }
    sum.map(|sum| sum / count.max(1) as f32)
}

fn distance(one: [f32; 2], other: [f32; 2]) -> f32 {
    (one[0] - other[0]).hypot(one[1] - other[1])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_centre_of_full_rates_is_found() {
        let map = |texels: &str| ShadingRateMap {
            extent: [4, 2, 1],
            histogram: Default::default(),
            hash: String::new(),
            texels: Some(texels.to_owned()),
        };
        assert_eq!(centre(&map("0a0000050a00000a")), [1.5, 0.5]);
        assert_eq!(centre(&map("0a0a0a0a0a0a0a00")), [3.0, 1.0]);
        assert_eq!(centre(&map("0a0a0a0a0a0a0a0a")), [0.0, 0.0]);
    }
}
