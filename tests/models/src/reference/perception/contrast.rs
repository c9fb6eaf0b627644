//! Contrast per tile as Burt and Adelson 1983 write the pyramid: each value is its own sum over the filter's taps.

use parafovea_core::image::Plane;

/// The filter, from 2 before to 2 after.
const WEIGHTS: [f64; 5] = [1.0 / 16.0, 4.0 / 16.0, 6.0 / 16.0, 4.0 / 16.0, 1.0 / 16.0];

/// One tile: contrast of the bands, their greatest and their mean, and mean luminance.
#[derive(Clone, Debug)]
pub struct Tile {
    /// Greatest contrast of each band.
    pub peak: [f64; 4],
    /// Mean contrast of each band.
    pub mean: [f64; 4],
    /// cd/m^2.
    pub adaptation: f64,
}

/// The tiles of an image in cd/m^2, row by row. Negative values and NaN count as 0, infinity as 10,000.
pub fn tiles(picture: &Plane, tile_size: usize, dark: f64) -> Vec<Tile> {
    let bounded = |value: f32| if value > 0.0 { f64::from(value).min(10_000.0) } else { 0.0 };
    let mut levels = vec![Level {
        width: picture.width() as usize,
        height: picture.height() as usize,
        texels: picture.texels().iter().copied().map(bounded).collect(),
    }];
    for _ in 0..5 {
        levels.push(levels[levels.len() - 1].reduce());
    }
    let (columns, rows) = (levels[0].width.div_ceil(tile_size), levels[0].height.div_ceil(tile_size));
    (0..columns * rows).map(|i| tile(&levels, i % columns, i / columns, tile_size, dark)).collect()
}

fn tile(levels: &[Level], column: usize, row: usize, tile_size: usize, dark: f64) -> Tile {
    let bands: Vec<Vec<f64>> = (0..4)
        .map(|i| {
            levels[i]
                .within(column, row, tile_size >> i)
                .map(|(x, y)| {
                    let difference = levels[i].at(x, y) - levels[i + 1].expanded(x, y);
                    difference.abs() / (levels[i + 2].interpolated(x, y) + dark)
                })
                .collect()
        })
        .collect();
    let light: Vec<f64> = levels[0].within(column, row, tile_size).map(|(x, y)| levels[0].at(x, y)).collect();
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    Tile {
        peak: std::array::from_fn(|i| bands[i].iter().copied().fold(0.0, f64::max)),
        mean: std::array::from_fn(|i| mean(&bands[i])),
        adaptation: mean(&light),
    }
}

struct Level {
    width: usize,
    height: usize,
    texels: Vec<f64>,
}

impl Level {
    fn at(&self, x: usize, y: usize) -> f64 {
        self.texels[y * self.width + x]
    }

    /// Beyond the edge the last texel repeats.
    fn clamped(&self, x: i64, y: i64) -> f64 {
        let [x, y] = [(x, self.width), (y, self.height)].map(|(i, n)| i.clamp(0, n as i64 - 1) as usize);
        self.at(x, y)
    }

    fn within(&self, column: usize, row: usize, side: usize) -> impl Iterator<Item = (usize, usize)> + '_ {
        let columns = column * side..((column + 1) * side).min(self.width);
        (row * side..((row + 1) * side).min(self.height))
            .flat_map(move |y| columns.clone().map(move |x| (x, y)))
    }

    fn reduce(&self) -> Self {
        let (width, height) = (self.width.div_ceil(2), self.height.div_ceil(2));
        let texels = (0..width * height)
            .map(|i| {
                taps()
                    .map(|(m, n, weight)| {
                        weight * self.clamped(2 * (i % width) as i64 + m, 2 * (i / width) as i64 + n)
                    })
                    .sum()
            })
            .collect();
        Self { width, height, texels }
    }

    /// Texel (x, y) of the next finer level as this one predicts it: four times the sum over those taps that meet a
    /// texel.
    fn expanded(&self, x: usize, y: usize) -> f64 {
        let (x, y) = (x as i64, y as i64);
        taps()
            .filter(|(m, n, _)| (x - m) % 2 == 0 && (y - n) % 2 == 0)
            .map(|(m, n, weight)| 4.0 * weight * self.clamped((x - m).div_euclid(2), (y - n).div_euclid(2)))
            .sum()
    }

    /// Texel (x, y) of the level two finer, linearly between four texels.
    fn interpolated(&self, x: usize, y: usize) -> f64 {
        let (i, j) = ((x / 4) as i64, (y / 4) as i64);
        let (u, v) = ((x % 4) as f64 / 4.0, (y % 4) as f64 / 4.0);
        (1.0 - u) * (1.0 - v) * self.clamped(i, j)
            + u * (1.0 - v) * self.clamped(i + 1, j)
            + (1.0 - u) * v * self.clamped(i, j + 1)
            + u * v * self.clamped(i + 1, j + 1)
    }
}

fn taps() -> impl Iterator<Item = (i64, i64, f64)> {
    (0..25).map(|i| (i % 5 - 2, i / 5 - 2, WEIGHTS[(i % 5) as usize] * WEIGHTS[(i / 5) as usize]))
}
