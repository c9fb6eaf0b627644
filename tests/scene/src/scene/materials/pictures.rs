//! Pictures with cells: windows, signs, instruments, screens, labels, books.

use std::f32::consts::TAU;

use noto_sans_mono_bitmap::FontWeight::{Bold, Regular};

use super::super::canvas::Canvas;
use super::super::noise::hash;
use super::super::texture::Texture;

const WHITE: [u8; 3] = [236, 238, 232];
const GREEN: [u8; 3] = [90, 230, 120];
const AMBER: [u8; 3] = [255, 176, 46];
const CYAN: [u8; 3] = [96, 214, 240];
const RED: [u8; 3] = [240, 66, 56];

/// Words of the print that fills pages, screens and spines.
const WORDS: [&str; 32] = [
    "light", "river", "stone", "of", "the", "a", "winter", "and", "garden", "theory", "in", "sea", "night",
    "on", "atlas", "letters", "to", "north", "music", "history", "glass", "birds", "house", "under",
    "silent", "maps", "iron", "with", "tides", "colour", "small", "hours",
];

fn word(index: u32, seed: u32) -> &'static str {
    WORDS[(hash(index, seed, 51) * WORDS.len() as f32) as usize % WORDS.len()]
}

/// A line of print of at most `width` characters.
fn print(line: u32, seed: u32, width: usize) -> String {
    let mut text = String::new();
    for index in 0.. {
        let next = word(line * 32 + index, seed);
        if text.len() + next.len() > width {
            break;
        }
        text += next;
        text.push(' ');
    }
    text
}

/// Lit rooms behind glazing bars: curtains, shelves, lamps and people.
pub fn windows() -> Texture {
    let mut canvas = Canvas::new([512, 512], [16, 15, 14]);
    for cell in 0..16 {
        let [x, y] = [cell % 4 * 128, cell / 4 * 128];
        let random = |index| hash(cell, index, 52);
        let warm = (150.0 + 90.0 * random(0)) as u8;
        canvas.fill([x + 6, y + 6], [116, 116], [250, 222, warm]);
        let curtain = (14.0 + 26.0 * random(1)) as u32;
        for left in [x + 6, x + 122 - curtain] {
            canvas.fill([left, y + 6], [curtain, 116], [150, 74, 50]);
            for fold in (0..curtain).step_by(6) {
                canvas.fill([left + fold, y + 6], [2, 116], [110, 50, 36]);
            }
        }
        if random(2) > 0.5 {
            let at = x as f32 + 44.0 + 40.0 * random(3);
            canvas.disc([at, y as f32 + 66.0], 11.0, [40, 28, 24]);
            canvas.fill([at as u32 - 17, y + 78], [34, 44], [48, 36, 40]);
        }
        canvas.fill([x + 62, y + 6], [4, 116], [24, 22, 20]);
        canvas.fill([x + 6, y + 40], [116, 4], [24, 22, 20]);
    }
    canvas.texture()
}

/// Shop signs, one under the other.
pub fn signs() -> Texture {
    const SIGNS: [(&str, [u8; 3]); 8] = [
        ("HOTEL  METROPOL", RED),
        ("BOOKS & MAPS  open late", CYAN),
        ("Noodle House 24h", AMBER),
        ("APOTHECARY  +", GREEN),
        ("cinema: THE LONG FRAME", WHITE),
        ("No parking 7-19 h, trams", AMBER),
        ("LINE 11  22  23  depot", GREEN),
        ("Laundry * Keys * Copies", CYAN),
    ];
    let mut canvas = Canvas::new([1024, 512], [6, 6, 9]);
    for (row, (text, colour)) in SIGNS.iter().enumerate() {
        let y = row as u32 * 64;
        canvas.frame([0, y], [1024, 64], 4, 3, *colour);
        canvas.line(text, [28, y + 6], if text.len() < 20 { 2 } else { 1 }, Bold, *colour);
    }
    canvas.texture()
}

/// Round instruments: a scale with figures, a name and a unit; the needles are things of their own.
pub fn gauges() -> Texture {
    const NAMES: [(&str, &str); 16] = [
        ("AIRSPEED", "knots"),
        ("ALT", "ft x100"),
        ("V/S", "ft/min"),
        ("RPM", "x1000"),
        ("OIL P", "psi"),
        ("OIL T", "deg C"),
        ("FUEL L", "kg"),
        ("FUEL R", "kg"),
        ("EGT", "deg C"),
        ("TORQUE", "%"),
        ("N1", "% rpm"),
        ("N2", "% rpm"),
        ("CABIN", "ft"),
        ("VOLTS", "V"),
        ("AMPS", "A"),
        ("CLOCK", "UTC"),
    ];
    let mut canvas = Canvas::new([1024, 1024], [20, 21, 23]);
    for (cell, (name, unit)) in NAMES.iter().enumerate() {
        let [x, y] = [cell as u32 % 4 * 256, cell as u32 / 4 * 256];
        let centre = [x as f32 + 128.0, y as f32 + 128.0];
        canvas.disc(centre, 124.0, [58, 60, 64]);
        canvas.disc(centre, 117.0, [9, 10, 12]);
        let at = |turn: f32, radius: f32| {
            let (sin, cos) = (turn * TAU).sin_cos();
            [centre[0] + radius * sin, centre[1] - radius * cos]
        };
        for tick in 0..=40 {
            // Three quarters of a turn, from lower left to lower right.
            let turn = -0.375 + 0.75 * tick as f32 / 40.0;
            let (length, width) = if tick % 5 == 0 { (20.0, 4.0) } else { (11.0, 2.0) };
            let colour = match tick {
                36.. => RED,
                28..36 => AMBER,
                _ => WHITE,
            };
            canvas.stroke(at(turn, 112.0), at(turn, 112.0 - length), width, colour);
            if tick % 10 == 0 {
                let figure = format!("{}", tick / 5 * (cell as u32 % 3 + 1));
                let [left, top] = at(turn, 76.0);
                let width = 9 * figure.len() as u32;
                canvas.small_line(&figure, [left as u32 - width / 2, top as u32 - 9], WHITE);
            }
        }
        canvas.small_line(name, [x + 128 - 4 * name.len() as u32, y + 158], WHITE);
        canvas.small_line(unit, [x + 128 - 4 * unit.len() as u32, y + 178], CYAN);
    }
    canvas.texture()
}

/// Four screens: navigation, engines, a list of messages, radio.
pub fn screens() -> Texture {
    let mut canvas = Canvas::new([1024, 1024], [3, 5, 9]);
    let origin = |cell: u32| [cell % 2 * 512, cell / 2 * 512];
    let [x, y] = origin(0);
    for ring in 1..4 {
        for dot in 0..180 {
            let (sin, cos) = (dot as f32 / 180.0 * TAU).sin_cos();
            let radius = 75.0 * ring as f32;
            canvas.disc([256.0 + radius * sin, 256.0 - radius * cos], 1.0, WHITE);
        }
    }
    let route = [[256.0, 470.0], [250.0, 300.0], [330.0, 200.0], [300.0, 60.0]];
    for (index, leg) in route.windows(2).enumerate() {
        canvas.stroke(leg[0], leg[1], 2.0, [230, 70, 220]);
        let name = ["KETIL", "OSMO7", "RUNWY"][index];
        canvas.small_line(name, [leg[1][0] as u32 + 10, leg[1][1] as u32 - 8], CYAN);
    }
    canvas.small_line("GS 142  TAS 151  HDG 274", [x + 14, y + 12], GREEN);
    canvas.line("KETIL 12.4 NM", [x + 14, y + 466], 1, Regular, WHITE);
    let [x, y] = origin(1);
    for (row, name) in ["N1", "EGT", "N2", "FF", "OIL P", "OIL T", "VIB"].iter().enumerate() {
        let top = y + 20 + 68 * row as u32;
        canvas.line(name, [x + 16, top], 1, Regular, CYAN);
        for engine in 0..2 {
            let share = hash(row as u32, engine, 53);
            let left = x + 130 + 190 * engine;
            canvas.frame([left, top + 4], [110, 24], 0, 2, WHITE);
            canvas.fill(
                [left + 3, top + 7],
                [(104.0 * share) as u32, 18],
                if share > 0.9 { RED } else { GREEN },
            );
            canvas.small_line(&format!("{:5.1}", share * 100.0), [left + 116, top + 8], WHITE);
        }
    }
    let [x, y] = origin(2);
    canvas.line("MESSAGES", [x + 16, y + 10], 1, Bold, AMBER);
    for line in 0..26 {
        let colour = [WHITE, WHITE, GREEN, AMBER][line as usize % 4];
        let text = format!("{:02}:{:02} {}", 9 + line / 6, line * 17 % 60, print(line, 1, 50));
        canvas.small_line(&text, [x + 12, y + 56 + 17 * line], colour);
    }
    let [x, y] = origin(3);
    for (row, (name, figure)) in
        [("COM1", "118.705"), ("COM2", "121.500"), ("NAV1", "110.30"), ("NAV2", "113.95"), ("XPDR", "4271")]
            .iter()
            .enumerate()
    {
        let top = y + 16 + 98 * row as u32;
        canvas.line(name, [x + 16, top + 16], 1, Regular, CYAN);
        canvas.line(figure, [x + 150, top], 2, Bold, if row == 1 { AMBER } else { GREEN });
        canvas.small_line(&print(row as u32, 2, 40), [x + 150, top + 64], WHITE);
    }
    canvas.texture()
}

/// Labels of switches on the left half, a checklist in small print on the right.
pub fn placards() -> Texture {
    const LABELS: [&str; 8] = [
        "MASTER  ALT  AVIONICS",
        "FUEL PUMP  L  R  XFEED",
        "PITOT HEAT  ON / OFF",
        "NAV  STROBE  BCN  TAXI",
        "PARK BRAKE  pull, turn",
        "GEAR  UP   DOWN 140 KT",
        "FLAPS 0  10  20  30  FULL",
        "NO STEP - NO SMOKING",
    ];
    let mut canvas = Canvas::new([1024, 1024], [26, 27, 29]);
    for (row, label) in LABELS.iter().enumerate() {
        let y = row as u32 * 128;
        canvas.line(label, [12, y + 8], 1, Bold, WHITE);
        canvas.small_line(&print(row as u32, 3, 54), [12, y + 50], AMBER);
        canvas.small_line(&print(row as u32, 4, 54), [12, y + 70], WHITE);
        canvas.frame([0, y], [512, 128], 2, 2, [90, 92, 96]);
    }
    canvas.fill([516, 4], [504, 1016], [232, 230, 214]);
    canvas.line("CHECKLIST", [532, 16], 1, Bold, [20, 20, 24]);
    for line in 0..54 {
        let item = print(line, 5, 40);
        canvas.small_line(&format!("{line:2}. {item:.<46} set"), [530, 58 + 17 * line], [30, 30, 34]);
    }
    canvas.texture()
}

/// Spines of books with titles that run downwards.
pub fn spines() -> Texture {
    let mut canvas = Canvas::new([1024, 1024], [40, 30, 24]);
    for cell in 0..128 {
        let [x, y] = [cell % 32 * 32, cell / 32 * 256];
        let random = |index| hash(cell, index, 54);
        let leather = [150.0, 90.0, 80.0].map(|most| (24.0 + most * random(most as u32)) as u8);
        canvas.fill([x, y], [32, 256], leather);
        canvas.fill([x, y], [2, 256], leather.map(|c| c / 2));
        canvas.fill([x + 30, y], [2, 256], leather.map(|c| c / 2));
        let gold = [[226, 190, 104], [230, 226, 210], [20, 18, 18]][(random(1) * 2.99) as usize];
        for band in [14, 20, 224, 232] {
            canvas.fill([x + 2, y + band], [28, 2], gold);
        }
        let title = format!("{} {} {}", word(cell, 6), word(cell, 7), word(cell, 8));
        canvas.spine(&title[..title.len().min(23)], [x + 24, y + 32], gold);
    }
    canvas.texture()
}

/// Two pages of print.
pub fn pages() -> Texture {
    let mut canvas = Canvas::new([1024, 512], [226, 218, 196]);
    for page in 0..2 {
        let x = 512 * page + 36;
        canvas.line(["IX. The Lamps", "of the Reading Room"][page as usize], [x, 16], 1, Bold, [40, 30, 26]);
        for line in 0..25 {
            canvas.small_line(&print(line, 9 + page, 54), [x, 62 + 17 * line], [46, 40, 36]);
        }
    }
    canvas.fill([508, 0], [8, 512], [150, 138, 116]);
    canvas.texture()
}
