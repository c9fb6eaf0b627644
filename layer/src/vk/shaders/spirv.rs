//! SPIR-V, as far as the layer reads and writes it. Numbers are from the SPIR-V specification, section 3.

use std::ffi::CStr;

/// The first word of a module in this machine's byte order.
pub const MAGIC: u32 = 0x0723_0203;

/// Words of a module ahead of its instructions.
pub const HEADER: usize = 5;

/// The execution model of fragment shaders.
pub const MODEL_FRAGMENT: u32 = 4;

/// Operations.
#[allow(missing_docs, reason = "the specification's names")]
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
    pub const TYPE_ARRAY: u32 = 28;
    pub const TYPE_RUNTIME_ARRAY: u32 = 29;
    pub const TYPE_STRUCT: u32 = 30;
    pub const TYPE_POINTER: u32 = 32;
    pub const TYPE_FUNCTION: u32 = 33;
    pub const CONSTANT_TRUE: u32 = 41;
    pub const CONSTANT_FALSE: u32 = 42;
    pub const CONSTANT: u32 = 43;
    pub const CONSTANT_NULL: u32 = 46;
    pub const SPEC_CONSTANT_TRUE: u32 = 48;
    pub const SPEC_CONSTANT_FALSE: u32 = 49;
    pub const SPEC_CONSTANT: u32 = 50;
    pub const SPEC_CONSTANT_OP: u32 = 52;
    pub const FUNCTION: u32 = 54;
    pub const FUNCTION_PARAMETER: u32 = 55;
    pub const FUNCTION_END: u32 = 56;
    pub const FUNCTION_CALL: u32 = 57;
    pub const VARIABLE: u32 = 59;
    pub const IMAGE_TEXEL_POINTER: u32 = 60;
    pub const LOAD: u32 = 61;
    pub const STORE: u32 = 62;
    pub const COPY_MEMORY: u32 = 63;
    pub const COPY_MEMORY_SIZED: u32 = 64;
    pub const ACCESS_CHAIN: u32 = 65;
    pub const IN_BOUNDS_ACCESS_CHAIN: u32 = 66;
    pub const PTR_ACCESS_CHAIN: u32 = 67;
    pub const IN_BOUNDS_PTR_ACCESS_CHAIN: u32 = 70;
    pub const DECORATE: u32 = 71;
    pub const MEMBER_DECORATE: u32 = 72;
    pub const GROUP_MEMBER_DECORATE: u32 = 75;
    pub const COMPOSITE_EXTRACT: u32 = 81;
    pub const COPY_OBJECT: u32 = 83;
    pub const IMAGE_WRITE: u32 = 99;
    pub const CONVERT_F_TO_U: u32 = 109;
    pub const CONVERT_U_TO_PTR: u32 = 120;
    pub const BITCAST: u32 = 124;
    pub const I_ADD: u32 = 128;
    pub const I_MUL: u32 = 132;
    pub const LOGICAL_EQUAL: u32 = 164;
    pub const LOGICAL_NOT_EQUAL: u32 = 165;
    pub const LOGICAL_OR: u32 = 166;
    pub const LOGICAL_AND: u32 = 167;
    pub const LOGICAL_NOT: u32 = 168;
    pub const SELECT: u32 = 169;
    pub const I_EQUAL: u32 = 170;
    pub const I_NOT_EQUAL: u32 = 171;
    pub const U_GREATER_THAN: u32 = 172;
    pub const S_GREATER_THAN: u32 = 173;
    pub const U_GREATER_THAN_EQUAL: u32 = 174;
    pub const S_GREATER_THAN_EQUAL: u32 = 175;
    pub const U_LESS_THAN: u32 = 176;
    pub const S_LESS_THAN: u32 = 177;
    pub const U_LESS_THAN_EQUAL: u32 = 178;
    pub const S_LESS_THAN_EQUAL: u32 = 179;
    pub const SHIFT_RIGHT_LOGICAL: u32 = 194;
    pub const BITWISE_AND: u32 = 199;
    pub const BIT_FIELD_U_EXTRACT: u32 = 203;
    pub const ATOMIC_STORE: u32 = 228;
    pub const ATOMIC_EXCHANGE: u32 = 229;
    pub const ATOMIC_XOR: u32 = 242;
    pub const PHI: u32 = 245;
    pub const SELECTION_MERGE: u32 = 247;
    pub const LABEL: u32 = 248;
    pub const BRANCH: u32 = 249;
    pub const BRANCH_CONDITIONAL: u32 = 250;
    pub const SWITCH: u32 = 251;
    pub const KILL: u32 = 252;
    pub const RETURN: u32 = 253;
    pub const UNREACHABLE: u32 = 255;
    pub const ATOMIC_FLAG_TEST_AND_SET: u32 = 318;
    pub const ATOMIC_FLAG_CLEAR: u32 = 319;
    pub const EXECUTION_MODE_ID: u32 = 331;
    pub const DECORATE_ID: u32 = 332;
    pub const TERMINATE_INVOCATION: u32 = 4416;
    pub const BEGIN_INTERLOCK: u32 = 5364;
    pub const DEMOTE_TO_HELPER_INVOCATION: u32 = 5380;
    pub const ATOMIC_F_MIN: u32 = 5614;
    pub const ATOMIC_F_MAX: u32 = 5615;
    pub const DECORATE_STRING: u32 = 5632;
    pub const MEMBER_DECORATE_STRING: u32 = 5633;
    pub const ATOMIC_F_ADD: u32 = 6035;
}

/// Storage classes.
#[allow(missing_docs, reason = "the specification's names")]
pub mod class {
    pub const INPUT: u32 = 1;
    pub const UNIFORM: u32 = 2;
    pub const OUTPUT: u32 = 3;
    pub const PRIVATE: u32 = 6;
    pub const FUNCTION: u32 = 7;
    pub const STORAGE_BUFFER: u32 = 12;
}

/// Decorations.
#[allow(missing_docs, reason = "the specification's names")]
pub mod decoration {
    pub const RELAXED_PRECISION: u32 = 0;
    pub const SPEC_ID: u32 = 1;
    pub const BLOCK: u32 = 2;
    pub const BUFFER_BLOCK: u32 = 3;
    pub const ARRAY_STRIDE: u32 = 6;
    pub const BUILT_IN: u32 = 11;
    pub const FLAT: u32 = 14;
    pub const SAMPLE: u32 = 17;
    pub const NON_WRITABLE: u32 = 24;
    pub const BINDING: u32 = 33;
    pub const DESCRIPTOR_SET: u32 = 34;
    pub const OFFSET: u32 = 35;
}

/// Built-in variables.
#[allow(missing_docs, reason = "the specification's names")]
pub mod built_in {
    pub const FRAG_COORD: u32 = 15;
    pub const SAMPLE_ID: u32 = 18;
    pub const SAMPLE_POSITION: u32 = 19;
    pub const SAMPLE_MASK: u32 = 20;
    pub const VIEW_INDEX: u32 = 4440;
}

/// One instruction.
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

/// The instructions of a module in their order, the last of them `None` if the module is cut off. `None` for another file, or one of
/// another byte order.
pub fn instructions(words: &[u32]) -> Option<impl Iterator<Item = Option<Instruction<'_>>>> {
    let (header, mut rest) = words.split_at_checked(HEADER)?;
    let next = move || {
        let first = *rest.first()?;
        let (length, op) = ((first >> 16) as usize, first & 0xffff);
        let operands = rest.get(1..length);
        rest = operands.and(rest.get(length..)).unwrap_or_default();
        Some(operands.map(|operands| Instruction { op, operands }))
    };
    (header[0] == MAGIC).then(|| std::iter::from_fn(next))
}

/// A string's bytes, and the number of its words; `None` if it does not end.
pub fn text(words: &[u32]) -> Option<(Vec<u8>, usize)> {
    let mut bytes: Vec<u8> = words.iter().flat_map(|word| word.to_le_bytes()).collect();
    let length = bytes.iter().position(|&byte| byte == 0)?;
    bytes.truncate(length);
    Some((bytes, length / 4 + 1))
}

/// A text as an instruction has it: its bytes, the end, and zeros up to a whole word.
pub fn words_of(text: &CStr) -> Vec<u32> {
    let word = |bytes: &[u8]| {
        let mut word = [0; 4];
        word[..bytes.len()].copy_from_slice(bytes);
        u32::from_le_bytes(word)
    };
    text.to_bytes_with_nul().chunks(4).map(word).collect()
}
