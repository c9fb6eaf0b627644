//! The content of an image when it is read.

use super::{Kind, Known, MOST_STEPS, Provenance, Sources, writes};
use crate::pass_detection::recognition::candidate;
use crate::pass_detection::{Event, ImageKey};

impl Provenance {
    /// Adds the cameras whose content an image holds where event number `reader` reads it. Whether it may hold something else.
    ///
    /// Content that no earlier event of the frame writes is from the last frame, whose later events were like this one's.
    pub(super) fn sources_of(
        &mut self,
        image: ImageKey,
        reader: usize,
        events: &[Event],
        known: &Known<'_>,
        depth: usize,
        sources: &mut Sources,
    ) -> bool {
        if depth > super::DEEPEST {
            return true;
        }
        let mut is_written = false;
        let order = (0..reader).rev().chain((reader + 1..events.len()).rev());
        for index in order {
            // An earlier write may cover the image in part only.
            let is_doubtful = u32::from(is_written && index > reader);
            self.steps += 1;
            if self.steps > MOST_STEPS {
                return true;
            }
            match &events[index] {
                Event::Pass(pass) if writes(pass, image) => {
                    is_written = true;
                    match self.nodes[index].kind {
                        Kind::Camera => {
                            let group = self.nodes[index].group;
                            if !sources.contains(&group) {
                                sources.push(group);
                            }
                            // An interface without depth is drawn over the picture that it loads.
                            let is_over = pass.facts.loads_color && !self.groups.all[group].has_depth;
                            if !is_over {
                                return false;
                            }
                        }
                        Kind::Screen { .. } => {
                            self.doubts += is_doubtful;
                            let (found, has_unknown) = self.origins(index, pass, events, known, depth + 1);
                            self.doubts -= is_doubtful;
                            // A pass without sources of its own draws over the existing picture.
                            let is_over =
                                pass.facts.loads_color && self.is_over(index, image, &found, events);
                            if !found.is_empty() || has_unknown {
                                sources.extend(
                                    found
                                        .into_iter()
                                        .filter(|found| !sources.contains(found))
                                        .collect::<Sources>(),
                                );
                                // The picture under it may be the one as well.
                                if !is_over || has_unknown {
                                    return has_unknown;
                                }
                            }
                        }
                        Kind::Transfer | Kind::Other => {}
                    }
                }
                Event::Transfer(transfer) if transfer.to.image == image && transfer.from.image != image => {
                    let from = transfer.from.image;
                    self.doubts += is_doubtful;
                    let is_unknown = self.sources_of(from, index, events, known, depth + 1, sources);
                    self.doubts -= is_doubtful;
                    return is_unknown;
                }
                Event::Pass(_) | Event::Transfer(_) => {}
            }
        }
        // Nothing draws it, ever: compute does.
        let holds_colours =
            known.memory.description(image).is_none_or(|image| candidate::holds_colours(image.format));
        !is_written && holds_colours && !known.memory.is_drawn(image)
    }
}
