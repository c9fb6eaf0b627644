//! Chroma attenuation as the configuration asks for it.

use super::{ChromaMatrix, ChromaMode, Config};
use parafovea_core::chroma::{ChromaSettings, Matrix, Mode};

/// The settings; `None` where chroma attenuation is off.
pub fn chroma_settings(config: &Config) -> Option<ChromaSettings> {
    let chroma = &config.chroma;
    let mode = match chroma.mode {
        _ if !config.enabled => return None,
        ChromaMode::Off => return None,
        ChromaMode::Default => Mode::Default,
        ChromaMode::Paper => Mode::Paper,
    };
    // In default mode floor and rim are above the curves nearly everywhere, regardless of the curves' bounds.
    let ChromaSettings { cb_bound, cr_bound, .. } = match mode {
        Mode::Default => ChromaSettings::default(),
        Mode::Paper => ChromaSettings {
            cb_bound: chroma.cb_bound,
            cr_bound: chroma.cr_bound,
            ..ChromaSettings::default()
        },
    };
    Some(ChromaSettings {
        mode,
        cb_bound,
        cr_bound,
        plateau_deg: chroma.plateau_deg,
        max_eccentricity_deg: chroma.max_eccentricity_deg,
        rim_fade: chroma.rim_fade,
        max_change_per_s: chroma.max_change_per_s,
        matrix: match chroma.matrix {
            ChromaMatrix::Bt709 => Matrix::Bt709,
            ChromaMatrix::Bt601 => Matrix::Bt601,
            ChromaMatrix::Bt2020 => Matrix::Bt2020,
        },
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_defaults_of_the_configuration_are_those_of_the_model() {
        let mut config = Config::default();
        assert_eq!(chroma_settings(&config), None);
        config.chroma.mode = ChromaMode::Default;
        assert_eq!(chroma_settings(&config), Some(ChromaSettings::default()));
        config.enabled = false;
        assert_eq!(chroma_settings(&config), None);
    }
}
