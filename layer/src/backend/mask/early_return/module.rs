//! A module of SPIR-V as a list of instructions, read and written.

/// Operations.
pub mod op {
    pub const EXTENSION: u32 = 10;
    pub const ENTRY_POINT: u32 = 15;
    pub const EXECUTION_MODE: u32 = 16;
    pub const CAPABILITY: u32 = 17;
    pub const TYPE_VOID: u32 = 19;
    pub const TYPE_BOOL: u32 = 20;
    pub const TYPE_INT: u32 = 21;
    pub const TYPE_FLOAT: u32 = 22;
    pub const TYPE_VECTOR: u32 = 23;
    pub const TYPE_RUNTIME_ARRAY: u32 = 29;
    pub const TYPE_STRUCT: u32 = 30;
    pub const TYPE_POINTER: u32 = 32;
    pub const TYPE_FUNCTION: u32 = 33;
    pub const CONSTANT: u32 = 43;
    pub const CONSTANT_NULL: u32 = 46;
    pub const FUNCTION: u32 = 54;
    pub const FUNCTION_END: u32 = 56;
    pub const FUNCTION_CALL: u32 = 57;
    pub const VARIABLE: u32 = 59;
    pub const LOAD: u32 = 61;
    pub const STORE: u32 = 62;
    pub const ACCESS_CHAIN: u32 = 65;
    pub const DECORATE: u32 = 71;
    pub const MEMBER_DECORATE: u32 = 72;
    pub const GROUP_MEMBER_DECORATE: u32 = 75;
    pub const COMPOSITE_EXTRACT: u32 = 81;
    pub const CONVERT_F_TO_U: u32 = 109;
    pub const BITCAST: u32 = 124;
    pub const I_ADD: u32 = 128;
    pub const I_MUL: u32 = 132;
    pub const I_EQUAL: u32 = 170;
    pub const SHIFT_RIGHT_LOGICAL: u32 = 194;
    pub const SELECTION_MERGE: u32 = 247;
    pub const LABEL: u32 = 248;
    pub const BRANCH: u32 = 249;
    pub const BRANCH_CONDITIONAL: u32 = 250;
    pub const RETURN: u32 = 253;
    pub const EXECUTION_MODE_ID: u32 = 331;
    pub const DECORATE_ID: u32 = 332;
    pub const DECORATE_STRING: u32 = 5632;
    pub const MEMBER_DECORATE_STRING: u32 = 5633;
}

const MAGIC: u32 = 0x0723_0203;
const HEADER: usize = 5;
const DECORATION_BUILT_IN: u32 = 11;

/// One instruction, without its first word.
#[derive(Clone, Copy, Debug)]
pub struct Instruction<'a> {
    /// The operation.
    pub op: u32,
    /// The words after the first.
    pub operands: &'a [u32],
}

impl Instruction<'_> {
    /// Whether it annotates.
    pub fn is_decoration(&self) -> bool {
        matches!(
            self.op,
            op::DECORATE
                ..=op::GROUP_MEMBER_DECORATE
                    | op::DECORATE_ID
                    | op::DECORATE_STRING
                    | op::MEMBER_DECORATE_STRING
        )
    }
}

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
        let (header, mut rest) = words.split_at_checked(HEADER)?;
        if header[0] != MAGIC {
            return None;
        }
        let mut instructions = Vec::with_capacity(rest.len() / 4);
        while let Some(&first) = rest.first() {
            let (length, op) = ((first >> 16) as usize, first & 0xffff);
            let found = rest.get(1..length)?;
            // What is looked into has its operands.
            let least = match op {
                op::ENTRY_POINT | op::MEMBER_DECORATE => 3,
                op::DECORATE | op::EXECUTION_MODE | op::EXECUTION_MODE_ID => 2,
                op::VARIABLE | op::TYPE_POINTER => 3,
                op::TYPE_VOID..=op::TYPE_FUNCTION | op::CAPABILITY | op::EXTENSION => 1,
                _ => 0,
            };
            if found.len() < least {
                return None;
            }
            instructions.push(Instruction { op, operands: found });
            rest = &rest[length..];
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
        members.any(|found| found.operands[2..] == [DECORATION_BUILT_IN, which])
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

/// A string's bytes, and how many words it takes.
pub fn text(words: &[u32]) -> Option<(Vec<u8>, usize)> {
    let mut bytes: Vec<u8> = words.iter().flat_map(|word| word.to_le_bytes()).collect();
    let length = bytes.iter().position(|&byte| byte == 0)?;
    bytes.truncate(length);
    Some((bytes, length / 4 + 1))
}
