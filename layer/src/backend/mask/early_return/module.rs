//! A module of SPIR-V as a list of instructions, read and written.

use crate::vk::shaders::spirv::{self, HEADER, Instruction, decoration, op};

/// A module that was read.
#[derive(Debug)]
pub struct Parsed<'a> {
    header: &'a [u32],
    /// The version: major in the third byte, minor in the second.
    pub version: u32,
    /// All ids are below.
    pub bound: u32,
    /// In their order.
    pub instructions: Vec<Instruction<'a>>,
}

impl<'a> Parsed<'a> {
    /// Reads a module; `None` where it is none, or one of another byte order.
    pub fn of(words: &'a [u32]) -> Option<Self> {
        let header = words.get(..HEADER)?;
        let mut instructions = Vec::with_capacity(words.len() / 4);
        for found in spirv::instructions(words)? {
            let found = found?;
            // Instructions whose operands are read must have them.
            let least = match found.op {
                op::ENTRY_POINT | op::MEMBER_DECORATE => 3,
                op::DECORATE | op::EXECUTION_MODE | op::EXECUTION_MODE_ID => 2,
                op::VARIABLE | op::TYPE_POINTER => 3,
                op::TYPE_VOID..=op::TYPE_FUNCTION | op::CAPABILITY | op::EXTENSION => 1,
                _ => 0,
            };
            if found.operands.len() < least {
                return None;
            }
            instructions.push(found);
        }
        Some(Self { header, version: header[1], bound: header[3], instructions })
    }

    /// The header, with room for more ids.
    pub fn header(&self, bound: u32) -> Assembly {
        let mut words = self.header.to_vec();
        words[3] = bound;
        Assembly(words)
    }

    /// Declarations ahead of the functions.
    pub fn globals(&self) -> impl Iterator<Item = &Instruction<'a>> {
        self.instructions.iter().take_while(|found| found.op != op::FUNCTION)
    }

    /// Whether an id is decorated so, with these operands.
    pub fn is_decorated(&self, id: u32, with: &[u32]) -> bool {
        let mut decorations = self.globals().filter(|found| found.op == op::DECORATE);
        decorations.any(|found| found.operands[0] == id && found.operands[1..] == *with)
    }

    /// Whether an id has such a decoration.
    pub fn has_decoration(&self, id: u32, which: u32) -> bool {
        let mut decorations = self.globals().filter(|found| found.op == op::DECORATE);
        decorations.any(|found| found.operands[..2] == [id, which])
    }

    /// Whether a member of a structure is this built-in.
    pub fn has_member_built_in(&self, which: u32) -> bool {
        let mut members = self.globals().filter(|found| found.op == op::MEMBER_DECORATE);
        members.any(|found| found.operands[2..] == [decoration::BUILT_IN, which])
    }

    fn variable(&self, id: u32) -> Option<&Instruction<'a>> {
        self.globals().find(|found| found.op == op::VARIABLE && found.operands[1] == id)
    }

    /// The storage class of a variable.
    pub fn class(&self, variable: u32) -> Option<u32> {
        Some(self.variable(variable)?.operands[2])
    }

    /// The type that a variable points to.
    pub fn pointee(&self, variable: u32) -> Option<u32> {
        let pointer = self.variable(variable)?.operands[0];
        let ty = self.globals().find(|found| found.op == op::TYPE_POINTER && found.operands[0] == pointer)?;
        Some(ty.operands[2])
    }
}

/// Instructions that are written.
#[derive(Debug, Default)]
pub struct Assembly(Vec<u32>);

impl Assembly {
    /// Adds one.
    pub fn push(&mut self, op: u32, operands: &[u32]) {
        self.0.push((operands.len() as u32 + 1) << 16 | op);
        self.0.extend_from_slice(operands);
    }

    /// Adds all of another.
    pub fn append(&mut self, other: &Self) {
        self.0.extend_from_slice(&other.0);
    }

    /// The written words.
    pub fn into_words(self) -> Vec<u32> {
        self.0
    }
}
