//! Whether a fragment shader discards once its specialisation constants are known: DXVK's shaders of Direct3D 9 have an alpha test each, which
//! a constant turns off.
//!
//! A branch on constants goes one way, every other branch goes all ways, and a discard counts where a way leads to it. Numbers and flags of
//! 32 bits are followed; anything else may be anything.

use super::specialization::Specialization;
use super::spirv::{self, Instruction, MODEL_FRAGMENT, decoration, op};
use rustc_hash::{FxHashMap, FxHashSet};
use smallvec::{SmallVec, smallvec};

/// Larger shaders are taken to discard.
const MOST_BLOCKS: usize = 4096;

/// Operations within operations that are followed.
const DEEPEST: u32 = 32;

/// The ways through a module's functions.
#[derive(Debug, Default)]
pub struct Flow {
    /// Names of fragment shaders, and their functions.
    entries: SmallVec<[(Box<str>, u32); 1]>,
    /// The first block of each function.
    functions: FxHashMap<u32, u32>,
    blocks: FxHashMap<u32, Block>,
    values: FxHashMap<u32, Value>,
}

/// A block, by its label.
#[derive(Debug)]
struct Block {
    discards: bool,
    /// Called functions.
    calls: SmallVec<[u32; 1]>,
    end: End,
}

/// Successors of a block, by label.
#[derive(Debug)]
enum End {
    /// Any of these; none at an end of the function.
    Any(SmallVec<[u32; 2]>),
    /// The condition, then the labels for true and for false.
    If([u32; 3]),
    /// The selector, then the words of a switch: the default, and literals with their labels.
    Switch(u32, Box<[u32]>),
}

/// A result that may be known.
#[derive(Debug)]
enum Value {
    Constant(u32),
    /// A specialisation constant: its number, and its default.
    Specialised(u32, u32),
    /// Of an operation.
    Of(u32, SmallVec<[u32; 4]>),
}

impl Flow {
    /// Reads a module; `None` if it has no specialisation constants, cannot be parsed, or is too large.
    pub fn read(words: &[u32]) -> Option<Self> {
        let mut reader = Reader::default();
        for found in spirv::instructions(words)? {
            let Instruction { op, operands } = found?;
            reader.instruction(op, operands)?;
        }
        let is_specialised = reader.flow.values.values().any(|value| matches!(value, Value::Specialised(..)));
        is_specialised.then_some(reader.flow)
    }

    /// Whether the fragment shader of that name may discard.
    pub fn discards(&self, name: &str, constants: &Specialization) -> bool {
        let entry = self.entries.iter().find(|(known, _)| **known == *name);
        entry.is_none_or(|(_, function)| self.may_discard(*function, constants).unwrap_or(true))
    }

    /// `None` if a way leads to something unknown.
    fn may_discard(&self, function: u32, constants: &Specialization) -> Option<bool> {
        let mut ways = vec![*self.functions.get(&function)?];
        let mut seen: FxHashSet<u32> = ways.iter().copied().collect();
        while let Some(label) = ways.pop() {
            let block = self.blocks.get(&label)?;
            if block.discards {
                return Some(true);
            }
            let mut next = self.next(&block.end, constants);
            for call in &block.calls {
                next.push(*self.functions.get(call)?);
            }
            ways.extend(next.into_iter().filter(|label| seen.insert(*label)));
        }
        Some(false)
    }

    fn next(&self, end: &End, constants: &Specialization) -> SmallVec<[u32; 2]> {
        match end {
            End::Any(labels) => labels.clone(),
            End::If([condition, yes, no]) => match self.value(*condition, constants, 0) {
                Some(0) => smallvec![*no],
                Some(_) => smallvec![*yes],
                None => smallvec![*yes, *no],
            },
            End::Switch(selector, words) => match self.value(*selector, constants, 0) {
                Some(value) => {
                    let case = words[1..].chunks_exact(2).find(|case| case[0] == value);
                    smallvec![case.map_or(words[0], |case| case[1])]
                }
                // Literals that are a label's number add a way that is none.
                None => words.iter().copied().filter(|word| self.blocks.contains_key(word)).collect(),
            },
        }
    }

    fn value(&self, id: u32, constants: &Specialization, depth: u32) -> Option<u32> {
        if depth > DEEPEST {
            return None;
        }
        match self.values.get(&id)? {
            Value::Constant(value) => Some(*value),
            Value::Specialised(number, default) => constants.value(*number, *default),
            Value::Of(op, operands) => {
                let operand = |index: usize| self.value(*operands.get(index)?, constants, depth + 1);
                of_operation(*op, operand)
            }
        }
    }
}

/// The result of an operation of [`is_followed`].
fn of_operation(op: u32, operand: impl Fn(usize) -> Option<u32>) -> Option<u32> {
    let flag = |value: bool| Some(u32::from(value));
    let (first, second) = (operand(0), operand(1));
    // One of the two is enough.
    match (op, first, second) {
        (op::SELECT, Some(condition), _) => return operand(if condition == 0 { 2 } else { 1 }),
        (op::LOGICAL_AND, Some(0), _) | (op::LOGICAL_AND, _, Some(0)) => return Some(0),
        (op::LOGICAL_OR, Some(1), _) | (op::LOGICAL_OR, _, Some(1)) => return Some(1),
        (op::LOGICAL_NOT, Some(value), _) => return flag(value == 0),
        _ => {}
    }
    let (first, second) = (first?, second?);
    let (signed, other) = (first.cast_signed(), second.cast_signed());
    match op {
        op::I_EQUAL | op::LOGICAL_EQUAL => flag(first == second),
        op::I_NOT_EQUAL | op::LOGICAL_NOT_EQUAL => flag(first != second),
        op::LOGICAL_AND => flag(first != 0 && second != 0),
        op::LOGICAL_OR => flag(first != 0 || second != 0),
        op::U_GREATER_THAN => flag(first > second),
        op::U_GREATER_THAN_EQUAL => flag(first >= second),
        op::U_LESS_THAN => flag(first < second),
        op::U_LESS_THAN_EQUAL => flag(first <= second),
        op::S_GREATER_THAN => flag(signed > other),
        op::S_GREATER_THAN_EQUAL => flag(signed >= other),
        op::S_LESS_THAN => flag(signed < other),
        op::S_LESS_THAN_EQUAL => flag(signed <= other),
        op::BITWISE_AND => Some(first & second),
        op::SHIFT_RIGHT_LOGICAL => first.checked_shr(second),
        op::BIT_FIELD_U_EXTRACT => {
            let count = operand(2)?;
            let mask = u32::MAX.checked_shr(u32::BITS.checked_sub(count)?).unwrap_or(0);
            Some(first.checked_shr(second)? & mask)
        }
        _ => None,
    }
}

fn is_followed(op: u32) -> bool {
    matches!(
        op,
        op::LOGICAL_EQUAL
            ..=op::S_LESS_THAN_EQUAL | op::SHIFT_RIGHT_LOGICAL | op::BITWISE_AND | op::BIT_FIELD_U_EXTRACT
    )
}

/// The state of reading.
#[derive(Default)]
struct Reader {
    flow: Flow,
    /// Numbers of specialisation constants.
    numbers: FxHashMap<u32, u32>,
    /// Types of flags, and of numbers of 32 bits.
    types: FxHashSet<u32>,
    function: Option<u32>,
    /// The block that is read.
    block: Option<(u32, Block)>,
}

impl Reader {
    /// Takes an instruction's operands; `None` if there are too few, or blocks do not end.
    fn instruction(&mut self, op: u32, operands: &[u32]) -> Option<()> {
        let operand = |index: usize| operands.get(index).copied();
        match op {
            op::ENTRY_POINT if operand(0)? == MODEL_FRAGMENT => {
                let (name, _) = spirv::text(operands.get(2..)?)?;
                self.flow.entries.push((String::from_utf8(name).ok()?.into(), operand(1)?));
            }
            op::DECORATE if operand(1)? == decoration::SPEC_ID => {
                self.numbers.insert(operand(0)?, operand(2)?);
            }
            op::TYPE_BOOL => drop(self.types.insert(operand(0)?)),
            op::TYPE_INT if operand(1)? == 32 => drop(self.types.insert(operand(0)?)),
            op::CONSTANT => self.constant(operands, operand(2)?),
            op::CONSTANT_TRUE => self.constant(operands, 1),
            op::CONSTANT_FALSE | op::CONSTANT_NULL => self.constant(operands, 0),
            op::SPEC_CONSTANT => self.specialised(operands, operand(2)?),
            op::SPEC_CONSTANT_TRUE => self.specialised(operands, 1),
            op::SPEC_CONSTANT_FALSE => self.specialised(operands, 0),
            op::SPEC_CONSTANT_OP => self.result(operand(2)?, operands, 3),
            op::FUNCTION => self.function = Some(operand(1)?),
            op::FUNCTION_END => self.function = None,
            op::LABEL => {
                let label = operand(0)?;
                if let Some(function) = self.function {
                    self.flow.functions.entry(function).or_insert(label);
                }
                let block = Block { discards: false, calls: SmallVec::new(), end: End::Any(SmallVec::new()) };
                // The one before has ended.
                return self.block.replace((label, block)).is_none().then_some(());
            }
            op::FUNCTION_CALL => self.block.as_mut()?.1.calls.push(operand(2)?),
            op::DEMOTE_TO_HELPER_INVOCATION => self.block.as_mut()?.1.discards = true,
            op::KILL | op::TERMINATE_INVOCATION => {
                self.block.as_mut()?.1.discards = true;
                return self.end(End::Any(SmallVec::new()));
            }
            op::RETURN..=op::UNREACHABLE => return self.end(End::Any(SmallVec::new())),
            op::BRANCH => return self.end(End::Any(smallvec![operand(0)?])),
            op::BRANCH_CONDITIONAL => return self.end(End::If([operand(0)?, operand(1)?, operand(2)?])),
            op::SWITCH => {
                return self
                    .end(End::Switch(operand(0)?, operands.get(1..)?.into()))
                    .filter(|()| operands.len() > 1);
            }
            _ => self.result(op, operands, 2),
        }
        Some(())
    }

    /// The block that is read ends.
    fn end(&mut self, end: End) -> Option<()> {
        let (label, block) = self.block.take()?;
        self.flow.blocks.insert(label, Block { end, ..block });
        (self.flow.blocks.len() <= MOST_BLOCKS).then_some(())
    }

    /// A constant; of other types nothing is known.
    fn constant(&mut self, operands: &[u32], value: u32) {
        self.keep(operands, Value::Constant(value));
    }

    /// A constant that a pipeline may set where it has a number.
    fn specialised(&mut self, operands: &[u32], default: u32) {
        let number = operands.get(1).and_then(|id| self.numbers.get(id)).copied();
        let value = number.map_or(Value::Constant(default), |number| Value::Specialised(number, default));
        self.keep(operands, value);
    }

    /// The result of an operation, whose own operands begin there.
    fn result(&mut self, op: u32, operands: &[u32], from: usize) {
        if is_followed(op) {
            let own = operands.get(from..).unwrap_or_default();
            self.keep(operands, Value::Of(op, own.into()));
        }
    }

    fn keep(&mut self, operands: &[u32], value: Value) {
        if let [of, id, ..] = operands
            && self.types.contains(of)
        {
            self.flow.values.insert(*id, value);
        }
    }
}

#[cfg(test)]
mod tests;
