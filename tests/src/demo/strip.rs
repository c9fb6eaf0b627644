//! Four pictures beside each other: off, on, their difference, and the layer's work drawn over.

use crate::HarnessError;
use crate::compare::difference_times_8;
use crate::picture::Picture;
use std::path::Path;

/// Saves off | on | difference x 8 | drawn over as one picture, and half as large with `_small` behind its name.
///
/// # Errors
/// Errors of [`Picture::save`].
pub fn save(path: &Path, pictures: [&Picture; 3]) -> Result<(), HarnessError> {
    let strip = strip(pictures);
    strip.save(path)?;
    let name = path.file_stem().unwrap_or_default().to_string_lossy();
    strip.halved().save(&path.with_file_name(format!("{name}_small.png")))
}

fn strip([off, on, drawn]: [&Picture; 3]) -> Picture {
    off.beside(on).beside(&difference_times_8(off, on)).beside(drawn)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_four_are_in_their_order() {
        let [off, on, drawn] =
            [10, 13, 99].map(|code| Picture::from_fn(2, 2, |_, _| [code, code, code, 255]));
        let strip = strip([&off, &on, &drawn]);
        assert_eq!((strip.width, strip.height), (8, 2));
        assert_eq!([0, 2, 4, 6].map(|x| strip.at(x, 1)[0]), [10, 13, 24, 99]);
    }
}
