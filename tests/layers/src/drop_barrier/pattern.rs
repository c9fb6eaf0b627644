//! Pattern of the barriers to drop.

use ash::vk;
use std::str::FromStr;

/// `old_layout,new_layout,src_stage,dst_stage`, as numbers.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct Pattern {
    old_layout: vk::ImageLayout,
    new_layout: vk::ImageLayout,
    src_stage: u64,
    dst_stage: u64,
}

impl Pattern {
    /// Whether a barrier has exactly these values.
    pub fn matches(&self, old: vk::ImageLayout, new: vk::ImageLayout, src: u64, dst: u64) -> bool {
        (self.old_layout, self.new_layout, self.src_stage, self.dst_stage) == (old, new, src, dst)
    }
}

impl FromStr for Pattern {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers = text.split(',').map(number).collect::<Result<Vec<_>, _>>()?;
        let &[old, new, src_stage, dst_stage] = &numbers[..] else {
            return Err(format!(
                "{} values; old_layout,new_layout,src_stage,dst_stage are wanted",
                numbers.len()
            ));
        };
        let layout = |value: u64| {
            let value = i32::try_from(value).map_err(|_| format!("{value} is no VkImageLayout"))?;
            Ok::<_, String>(vk::ImageLayout::from_raw(value))
        };
        Ok(Self { old_layout: layout(old)?, new_layout: layout(new)?, src_stage, dst_stage })
    }
}

fn number(text: &str) -> Result<u64, String> {
    let text = text.trim();
    let parsed = match text.strip_prefix("0x") {
        Some(digits) => u64::from_str_radix(digits, 16),
        None => text.parse(),
    };
    parsed.map_err(|error| format!("{text:?}: {error}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn four_numbers_that_match_only_together() {
        let pattern: Pattern = "2, 7,0x400,4096".parse().unwrap();
        let (old, new) = (vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL, vk::ImageLayout::TRANSFER_DST_OPTIMAL);
        assert!(pattern.matches(old, new, 0x400, 0x1000));
        assert!(!pattern.matches(new, old, 0x400, 0x1000));
        assert!(!pattern.matches(old, new, 0x401, 0x1000));
    }

    #[test]
    fn anything_else_is_an_error_that_says_so() {
        for (text, part) in
            [("", "\"\""), ("1,2,3", "3 values"), ("1,2,3,x", "\"x\""), ("5000000000,1,1,1", "VkImageLayout")]
        {
            let error = text.parse::<Pattern>().unwrap_err();
            assert!(error.contains(part), "{text}: {error}");
        }
    }
}
