//! A plan as plain text: a small map for each eye, then values and reasons.

use super::frame::{EyePlan, FramePlan};
use std::fmt;

/// Size of a map, characters; a character is about twice as high as wide.
const MAP: [u32; 2] = [46, 23];

/// One line for each sign of the map.
const LEGEND: &str = "@ 1x1   + 1/2   o 1/4   : 1/8   . 1/16   blank: re-used   * gaze";

impl fmt::Display for FramePlan {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "frame {}", self.frame)?;
        for row in 0..MAP[1] {
            let [left, right] = [0, 1].map(|eye: usize| map_row(&self.eyes[eye], row));
            writeln!(f, "{left}  {right}")?;
        }
        writeln!(f, "{LEGEND}")?;
        for (name, eye) in ["left", "right"].into_iter().zip(&self.eyes) {
            let ([width, height], sums) = (eye.extent, eye.statistics());
            writeln!(
                f,
                "{name:<8} {width} x {height}, {} of {} tiles due, mean rate {:.3}, invocations per pixel {:.3}",
                sums.tiles_due, sums.tiles, sums.mean_rate, sums.pixel_share
            )?;
        }
        self.fmt_values(f)?;
        for reason in self.reasons.iter() {
            writeln!(f, "because  {reason}")?;
        }
        Ok(())
    }
}

impl FramePlan {
    fn fmt_values(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (name, eye) in ["left", "right"].into_iter().zip(&self.eyes) {
            write!(f, "rates    {name}: 1x1")?;
            let rings = self.available.coarser().iter().zip(eye.rings.from_deg());
            for (rate, from_deg) in rings.filter(|(_, from_deg)| *from_deg < 180.0) {
                write!(f, ", {}x{} from {from_deg:.1} deg", rate.width(), rate.height())?;
            }
            writeln!(f)?;
        }
        if self.periods == [1; 5] {
            writeln!(f, "updates  every frame")?;
        } else {
            write!(f, "updates  every ")?;
            for (period, to_deg) in self.periods.into_iter().zip(self.regions_deg) {
                write!(f, "{period} to {to_deg:.1} deg, ")?;
            }
            writeln!(f, "{} frames beyond", self.periods[4])?;
        }
        writeln!(f, "gaze     off by up to {:.1} deg", self.inflation_deg)?;
        if let Some(budget) = self.budget {
            writeln!(f, "budget   {budget:.4}")?;
        }
        for (name, focus) in ["left", "right"].into_iter().zip(self.eyes.iter().map(|eye| eye.focus)) {
            let Some(focus) = focus else { continue };
            let (share, radius_deg) = (focus.strength * 100.0, focus.radius.to_degrees());
            writeln!(
                f,
                "chroma   {name}: {share:.0} % of the attenuation, from {radius_deg:.1} deg around the gaze"
            )?;
        }
        Ok(())
    }
}

/// One line of the map of an eye.
fn map_row(eye: &EyePlan, row: u32) -> String {
    (0..MAP[0]).map(|column| sign(eye, [column, row])).collect()
}

fn sign(eye: &EyePlan, cell: [u32; 2]) -> char {
    // The pixel in the middle of the character; 64 bits, as sides may be any.
    let pixel = [0, 1].map(|axis: usize| {
        ((u64::from(cell[axis]) * 2 + 1) * u64::from(eye.extent[axis]) / (u64::from(MAP[axis]) * 2)) as u32
    });
    if eye.extent.contains(&0) {
        return ' ';
    }
    if eye.gaze_pixel().is_some_and(|gaze| is_in_cell(gaze.into(), eye.extent, cell)) {
        return '*';
    }
    let [x, y] = eye.tile_of(pixel);
    if !eye.is_due(x, y) {
        return ' ';
    }
    match (1.0 / eye.rate(x, y).fraction()) as u32 {
        1 => '@',
        2 => '+',
        4 => 'o',
        8 => ':',
        _ => '.',
    }
}

fn is_in_cell(pixel: [f32; 2], extent: [u32; 2], cell: [u32; 2]) -> bool {
    (0..2).all(|axis| {
        let position = pixel[axis] / extent[axis] as f32 * MAP[axis] as f32;
        position >= cell[axis] as f32 && position < cell[axis] as f32 + 1.0
    })
}
