//! For tests, in builds with debug assertions alone: a file with the verdict on each pass of each frame at its submit. It reveals the gaze.
//!
//! `PARAFOVEA_PASSES_FILE` names it; it is only looked at where devices are armed, so not in processes with elevated
//! rights. Each line is a JSON object:
//!
//! `{"frame":0,"index":0,"extent":[w,h],"area":[w,h],"layers":1,"samples":1,"format":"R8G8B8A8_SRGB","eyes":"left","why":"...",`
//! `"unmasked":"...","map":{"texel":[w,h],"tiles":[columns,rows,layers],"rates":"..."}}`
//!
//! Frames count a device's xrEndFrame calls within a session from 0, indices the passes in the order of their submits. `extent`, `samples`
//! and `format` are of the first colour attachment, or of depth if there is none; `area` is the size of the render area, `layers` the number
//! of views of multiview, else 1; `eyes` is left, right, both or none; `unmasked` is the reason for recording it without a mask, null if it
//! has one, or if the device masks nothing. `map` is the map of the pass's candidate at the end of the frame, if any: `rates` has two
//! hexadecimal digits a texel, layer by layer, row by row.

use super::MapContent;
use crate::backend::MapSize;
use crate::pass_detection::{Event, Eyes, Match, Pass, Unmatched};
use crate::vk::objects::Objects;
use std::fmt::Write as _;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::sync::{Arc, LazyLock, Mutex, PoisonError, Weak};

const VARIABLE: &str = "PARAFOVEA_PASSES_FILE";

static FILE: LazyLock<Option<Mutex<BufWriter<File>>>> = LazyLock::new(|| {
    let path = std::env::var_os(VARIABLE)?;
    match File::create(&path) {
        Ok(file) => Some(Mutex::new(BufWriter::new(file))),
        Err(error) => {
            tracing::error!("{VARIABLE}: {}: {error}", path.display());
            None
        }
    }
});

/// The verdict on a pass.
struct PassVerdict {
    /// Its picture, or why it makes none.
    outcome: Result<Match, Unmatched>,
    /// Its target; this keeps nothing alive.
    candidate: Option<Weak<dyn MapContent>>,
}

/// Verdicts on the events of a frame, in their order.
#[derive(Default)]
pub struct Notes {
    verdicts: Vec<Option<PassVerdict>>,
}

impl Notes {
    /// Whether a file was asked for.
    pub fn is_wanted(&self) -> bool {
        FILE.is_some()
    }

    /// Keeps the verdict on the next event; `None` for an event that is not a pass.
    pub fn push<C: MapContent>(
        &mut self,
        outcome: Option<&Result<Match, Unmatched>>,
        candidate: Option<&Arc<C>>,
    ) {
        let candidate = candidate.map(|candidate| Arc::downgrade(candidate) as Weak<dyn MapContent>);
        self.verdicts.push(outcome.cloned().map(|outcome| PassVerdict { outcome, candidate }));
    }

    /// Writes the passes of a frame with their verdicts, and forgets these.
    pub fn end_frame(&mut self, objects: &Objects, frame: u64, events: &[Event]) {
        write(objects, frame, events.iter().zip(&self.verdicts));
        self.verdicts.clear();
    }
}

fn write<'a>(
    objects: &Objects,
    frame: u64,
    passes: impl Iterator<Item = (&'a Event, &'a Option<PassVerdict>)>,
) {
    let Some(file) = &*FILE else { return };
    let mut file = file.lock().unwrap_or_else(PoisonError::into_inner);
    let verdicts = passes.filter_map(|(event, verdict)| match event {
        Event::Pass(pass) => Some((pass, verdict.as_ref()?)),
        Event::Transfer(_) => None,
    });
    let written = verdicts
        .enumerate()
        .try_for_each(|(index, (pass, verdict))| {
            let map = verdict.candidate.as_ref().and_then(Weak::upgrade).map_or(String::new(), |candidate| {
                let mut line = String::new();
                candidate.read(&mut |size, texels| line = map(size, texels));
                line
            });
            file.write_all(line(objects, [frame, index as u64], pass, &verdict.outcome, &map).as_bytes())
        })
        .and_then(|()| file.flush());
    if let Err(error) = written {
        tracing::error!("{VARIABLE}: {error}");
    }
}

fn line(
    objects: &Objects,
    [frame, index]: [u64; 2],
    pass: &Pass,
    outcome: &Result<Match, Unmatched>,
    map: &str,
) -> String {
    let image = pass.colors.first().or(pass.depth.as_ref()).and_then(|target| objects.describe(target.image));
    let (extent, samples) = image.map_or(([0, 0], 0), |image| (image.extent, image.samples));
    let format = image.map_or_else(|| "unknown".to_owned(), |image| format!("{:?}", image.format));
    let [_, _, width, height] = pass.area;
    let layers = pass.view_mask.count_ones().max(1);
    let why = match outcome {
        Ok(found) => found.how.to_string(),
        Err(reason) => reason.to_string(),
    };
    let unmasked =
        pass.unmasked.map_or_else(|| "null".to_owned(), |reason| format!("{:?}", reason.to_string()));
    format!(
        "{{\"frame\":{frame},\"index\":{index},\"extent\":{extent:?},\"area\":[{width}, {height}],\"layers\":{layers},\
         \"samples\":{samples},\"format\":{format:?},\"eyes\":\"{}\",\"why\":{why:?},\"unmasked\":{unmasked}{map}}}\n",
        eyes(outcome)
    )
}

/// The part of a line on a map with these texels.
fn map(size: MapSize, texels: &[u8]) -> String {
    if texels.is_empty() {
        return String::new();
    }
    let ([columns, rows], layers) = (size.tiles, size.layers);
    let rates = texels.iter().fold(String::new(), |mut digits, texel| {
        let _ = write!(digits, "{texel:02x}");
        digits
    });
    let texel = size.texel;
    format!(",\"map\":{{\"texel\":{texel:?},\"tiles\":[{columns}, {rows}, {layers}],\"rates\":\"{rates}\"}}")
}

/// Eyes that the pass draws, over all of its parts.
fn eyes(outcome: &Result<Match, Unmatched>) -> &'static str {
    let parts = outcome.as_ref().map_or(&[][..], |found| &found.parts);
    let shows = |eye| parts.iter().any(|part| part.eyes == eye || part.eyes == Eyes::Finer);
    match (shows(Eyes::Left), shows(Eyes::Right)) {
        (true, true) => "both",
        (true, false) => "left",
        (false, true) => "right",
        (false, false) => "none",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pass_detection::{How, Orientation, Part, PassFacts};
    use smallvec::SmallVec;

    #[test]
    fn a_line_says_whose_picture_a_pass_makes() {
        let part =
            |eyes| Part { eyes, layer: 0, rect: [0.0, 0.0, 1.0, 1.0], orientation: Orientation::Upright };
        let found = |parts: &[Part]| Ok(Match { parts: parts.into(), how: How::Swapchain });
        assert_eq!(eyes(&found(&[part(Eyes::Left)])), "left");
        assert_eq!(eyes(&found(&[part(Eyes::Right)])), "right");
        assert_eq!(eyes(&found(&[part(Eyes::Right), part(Eyes::Left)])), "both");
        assert_eq!(eyes(&found(&[part(Eyes::Finer)])), "both");
        assert_eq!(eyes(&Err(Unmatched::Cube)), "none");
        let pass = Pass {
            colors: SmallVec::new(),
            resolves: SmallVec::new(),
            depth: None,
            area: [1, 2, 30, 40],
            region: [1, 2, 30, 40],
            view_mask: 0b11,
            facts: PassFacts::default(),
            unmasked: None,
            draws: None,
        };
        assert_eq!(
            line(&Objects::default(), [3, 1], &pass, &Err(Unmatched::NoColour), ",\"map\":0"),
            "{\"frame\":3,\"index\":1,\"extent\":[0, 0],\"area\":[30, 40],\"layers\":2,\"samples\":0,\
             \"format\":\"unknown\",\"eyes\":\"none\",\"why\":\"no colour: a shadow map or a depth pre-pass\",\
             \"unmasked\":null,\"map\":0}\n"
        );
        let size = MapSize { texel: [16, 8], tiles: [2, 1], layers: 1 };
        assert_eq!(
            map(size, &[0, 10]),
            ",\"map\":{\"texel\":[16, 8],\"tiles\":[2, 1, 1],\"rates\":\"000a\"}"
        );
        assert_eq!(map(size, &[]), "");
    }
}
