//! Memory traffic and invocations of the layer's tasks in a frame of two images of 2160 x 2160 pixels of four bytes.

use parafovea_core::perception::TileContrast;

/// Pixels of both pictures.
const PIXELS: f64 = 2.0 * 2160.0 * 2160.0;

/// Bytes of a pixel.
const PIXEL_BYTES: f64 = 4.0;

/// Bytes of a texel of luminance: a half float.
const TEXEL_BYTES: f64 = 2.0;

/// Levels of the pyramid that are made of the level before, from the second one over the picture on.
const LEVELS: [&str; 4] = ["level2", "level3", "level4", "level5"];

/// Bands of the contrast of tiles: each reads its level and the two above it. Texels that two bands of a tile read count twice: in
/// between, the concurrent tiles of a GPU read more than its caches contain.
const BANDS: usize = 4;

/// One dispatch, copy or set of draws, which waits for the one before.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dispatch {
    /// The entry point that is run; `None` if nothing is (copies).
    pub entry: Option<&'static str>,
    /// Number of invocations.
    pub invocations: f64,
    /// Bytes that are read and written, each once.
    pub bytes: f64,
    /// Iterations of the program's longest loop.
    pub turns: f64,
}

/// Tasks that a technique adds to a frame.
#[derive(Clone, Copy, Debug)]
pub struct Task {
    /// Its name.
    pub name: &'static str,
    /// The assumed configuration.
    pub what: &'static str,
    /// Its dispatches, in order, with tiles of so many pixels along a side.
    pub dispatches: fn(tile: f64) -> Vec<Dispatch>,
}

/// All tasks.
pub const TASKS: [Task; 8] = [
    Task {
        name: "analyze",
        what: "the contrast of each tile of both pictures, which are new",
        dispatches: analyze,
    },
    Task {
        name: "decide",
        what: "the rate of each tile by castleCSF, the head having turned",
        dispatches: decide,
    },
    Task { name: "resolve", what: "the rates of both pictures in a rate image", dispatches: resolve },
    Task { name: "compose, chroma", what: "a copy, and each pixel attenuated", dispatches: chroma },
    Task {
        name: "compose, re-use",
        what: "a copy, and half of the pixels from an earlier picture by depth, the rest attenuated",
        dispatches: reuse,
    },
    Task { name: "change", what: "half of the tiles compared with an earlier picture", dispatches: change },
    Task { name: "mask", what: "the blocks of both pictures, half of them skipped", dispatches: mask },
    Task { name: "fill", what: "two copies, and half of the blocks filled", dispatches: fill },
];

fn run(entry: &'static str, invocations: f64, bytes: f64, turns: f64) -> Dispatch {
    Dispatch { entry: Some(entry), invocations, bytes, turns }
}

fn copy() -> Dispatch {
    Dispatch { entry: None, invocations: 0.0, bytes: 2.0 * PIXELS * PIXEL_BYTES, turns: 1.0 }
}

fn tiles(tile: f64) -> f64 {
    PIXELS / (tile * tile)
}

/// Texels of a level, of which level 0 is the picture.
fn texels(level: usize) -> f64 {
    PIXELS / 4f64.powi(level as i32)
}

fn analyze(tile: f64) -> Vec<Dispatch> {
    // A thread makes two by two blocks of two by two texels: of the first level, with the luminance of 8 x 8 pixels below it, from 11 x 11
    // pixels. Neighbouring threads read the shared pixels at the same time, side by side: these come from caches.
    let bytes = PIXELS * PIXEL_BYTES + (texels(0) + texels(1)) * TEXEL_BYTES;
    let mut all = vec![run("luminance_unit", texels(1) / 16.0, bytes, 1.0)];
    for (finer, entry) in (1..).zip(LEVELS) {
        let made = texels(finer + 1);
        all.push(run(entry, made / 16.0, (texels(finer) + made) * TEXEL_BYTES, 1.0));
    }
    let read: f64 = (0..BANDS).map(|band| (band..band + 3).map(texels).sum::<f64>()).sum();
    let written = tiles(tile) * size_of::<TileContrast>() as f64;
    // Squares of four by four texels: of the finest band as many as the tile has, of all bands by turns, which the program has one
    // loop for each of.
    let squares = |band: usize| (tile / 4.0 / 2f64.powi(band as i32)).powi(2).max(1.0);
    let turns = (0..BANDS).map(squares).sum::<f64>() / BANDS as f64;
    all.push(run("tiles", tiles(tile), read * TEXEL_BYTES + written, turns));
    all
}

fn decide(tile: f64) -> Vec<Dispatch> {
    // Contrast, coarseness and time since the rate changed, read and written, and the rate.
    let bytes = tiles(tile) * (size_of::<TileContrast>() as f64 + 4.0 + 1.0);
    // A thread decides four tiles.
    vec![run("decide_castle_turned", tiles(tile) / 4.0, bytes, 4.0)]
}

fn resolve(tile: f64) -> Vec<Dispatch> {
    // A thread writes four texels, each of one tile and its table's entries; then they are copied to the image.
    let texels = tiles(tile);
    vec![
        run("resolve", texels / 4.0, texels * 2.0, 4.0),
        Dispatch { entry: None, invocations: 0.0, bytes: texels * 2.0, turns: 1.0 },
    ]
}

fn chroma(_: f64) -> Vec<Dispatch> {
    vec![copy(), run("pixel", PIXELS, 2.0 * PIXELS * PIXEL_BYTES, 1.0)]
}

fn reuse(_: f64) -> Vec<Dispatch> {
    let half = PIXELS / 2.0;
    vec![
        copy(),
        run("pixel", half, 2.0 * half * PIXEL_BYTES, 1.0),
        // The earlier picture, its depth and the newest depth are read.
        run("moved_attenuated", half, 4.0 * half * PIXEL_BYTES, 1.0),
    ]
}

fn change(tile: f64) -> Vec<Dispatch> {
    // Four parts of four taps in two pictures, whose texels no other tile reads.
    let compared = tiles(tile) / 2.0;
    let bytes = compared * (16.0 * 2.0 * PIXEL_BYTES + 8.0);
    vec![run("change", compared, bytes, 16.0)]
}

/// Blocks of four by four pixels.
const BLOCKS: f64 = PIXELS / 16.0;

/// Bytes of a block in the list.
const ENTRY_BYTES: f64 = 8.0;

fn mask(_: f64) -> Vec<Dispatch> {
    vec![
        // A thread makes a word of 32 blocks; then one has a block, and writes eight bytes of depth template; then a skipped one.
        run("shaded", BLOCKS / 32.0, BLOCKS / 8.0, 32.0),
        run("blocks", BLOCKS, BLOCKS * 8.0 + BLOCKS / 2.0 * ENTRY_BYTES, 1.0),
        run("sources", BLOCKS / 2.0, BLOCKS / 2.0 * 2.0 * ENTRY_BYTES, 1.0),
    ]
}

fn fill(_: f64) -> Vec<Dispatch> {
    // A thread fills a block, from four others.
    let filled = BLOCKS / 2.0;
    vec![copy(), run("srgb8", filled, filled * (ENTRY_BYTES + 32.0 * PIXEL_BYTES), 1.0), copy()]
}
