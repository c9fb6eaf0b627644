//! Effects of fragment shaders that shading rates must not change, read from their SPIR-V.
//!
//! A shader may store to memory, count, or write identifiers. The application expects such a shader to run once per pixel. At a coarse rate
//! it runs once per block, and its results have holes. A shader that discards decides for a whole block at once (Vulkan specification,
//! VK_KHR_shader_terminate_invocation: the coverage of all samples of the invocation becomes 0).

use super::spirv::{self, Instruction, MODEL_FRAGMENT, built_in, class, decoration, op};
use smallvec::SmallVec;
use std::collections::HashMap;

/// Effects of a fragment shader.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Effects {
    /// It stores to buffers or images, or uses atomics.
    pub stores: bool,
    /// It orders invocations of a pixel (`SPV_EXT_fragment_shader_interlock`).
    pub interlocks: bool,
    /// It runs for each sample (SampleId, SamplePosition, inputs interpolated at samples).
    pub per_sample: bool,
    /// It writes integers to a colour attachment.
    pub writes_integers: bool,
    /// It writes depth or stencil.
    pub writes_depth_stencil: bool,
    /// It reads or writes the sample mask.
    pub uses_sample_mask: bool,
    /// It may discard its fragment, as alpha tests do.
    pub discards: bool,
}

impl Effects {
    /// Of a shader that could not be read.
    pub const UNKNOWN: Self = Self {
        stores: true,
        interlocks: true,
        per_sample: true,
        writes_integers: true,
        writes_depth_stencil: true,
        uses_sample_mask: true,
        discards: true,
    };
}

impl Effects {
    /// A bit for each.
    pub fn to_bits(self) -> u8 {
        let Self {
            stores,
            interlocks,
            per_sample,
            writes_integers,
            writes_depth_stencil,
            uses_sample_mask,
            discards,
        } = self;
        let all = [
            stores,
            interlocks,
            per_sample,
            writes_integers,
            writes_depth_stencil,
            uses_sample_mask,
            discards,
        ];
        all.into_iter().zip(0..).fold(0, |bits, (has, index)| bits | u8::from(has) << index)
    }

    /// From [`Self::to_bits`]; `None` for other bits.
    pub fn from_bits(bits: u8) -> Option<Self> {
        let has = |index: u8| bits & 1 << index != 0;
        let effects = Self {
            stores: has(0),
            interlocks: has(1),
            per_sample: has(2),
            writes_integers: has(3),
            writes_depth_stencil: has(4),
            uses_sample_mask: has(5),
            discards: has(6),
        };
        (effects.to_bits() == bits).then_some(effects)
    }
}

/// The fragment shaders of a module, by their entry points' names.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct FragmentShaders(SmallVec<[(Box<str>, Effects); 1]>);

impl FragmentShaders {
    /// Reads a module; `None` if it is not one that can be parsed.
    pub fn read(words: &[u32]) -> Option<Self> {
        let module = Module::read(words)?;
        let shaders = module.entry_points.iter().map(|entry| (entry.name.clone(), module.effects(entry)));
        Some(Self(shaders.collect()))
    }

    /// Whether it has none.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Names and effects.
    pub fn iter(&self) -> impl Iterator<Item = (&str, Effects)> {
        self.0.iter().map(|(name, effects)| (&**name, *effects))
    }

    /// Effects of the fragment shader of that name; unknown without one.
    pub fn effects(&self, name: &str) -> Effects {
        let found = self.0.iter().find(|(known, _)| **known == *name);
        found.map_or(Effects::UNKNOWN, |(_, effects)| *effects)
    }
}

impl FromIterator<(Box<str>, Effects)> for FragmentShaders {
    fn from_iter<I: IntoIterator<Item = (Box<str>, Effects)>>(shaders: I) -> Self {
        Self(shaders.into_iter().collect())
    }
}

const MODE_DEPTH_REPLACING: u32 = 12;
const MODE_STENCIL_REF_REPLACING: u32 = 5027;
/// PixelInterlockOrderedEXT to ShadingRateInterlockUnorderedEXT.
const MODES_INTERLOCK: std::ops::RangeInclusive<u32> = 5366..=5371;

struct EntryPoint {
    name: Box<str>,
    function: u32,
    interface: Vec<u32>,
    modes: Vec<u32>,
}

/// A function's own effects, and its callees.
#[derive(Default)]
struct Function {
    stores: bool,
    interlocks: bool,
    discards: bool,
    calls: Vec<u32>,
}

/// The kept facts of a type.
#[derive(Clone, Copy)]
enum Type {
    Integer,
    /// A vector or an array of elements of a type.
    Elements(u32),
    /// A pointer: storage class, and the type that it points to.
    Pointer(u32, u32),
}

#[derive(Default)]
struct Module {
    entry_points: Vec<EntryPoint>,
    functions: HashMap<u32, Function>,
    types: HashMap<u32, Type>,
    /// The types of results that may be pointers.
    results: HashMap<u32, u32>,
    built_ins: HashMap<u32, u32>,
    per_sample: Vec<u32>,
    /// Whether a member of a block is interpolated at samples.
    has_per_sample_members: bool,
}

impl Module {
    fn read(words: &[u32]) -> Option<Self> {
        let mut module = Self::default();
        let mut function = None;
        for found in spirv::instructions(words)? {
            let Instruction { op, operands } = found?;
            module.instruction(op, operands, &mut function)?;
        }
        Some(module)
    }

    /// Takes an instruction's operands; `None` if there are too few.
    fn instruction(&mut self, op: u32, operands: &[u32], function: &mut Option<u32>) -> Option<()> {
        let operand = |index: usize| operands.get(index).copied();
        match op {
            op::ENTRY_POINT if operand(0)? == MODEL_FRAGMENT => {
                let (name, words) = spirv::text(operands.get(2..)?)?;
                let interface = operands.get(2 + words..)?.to_vec();
                self.entry_points.push(EntryPoint {
                    name: String::from_utf8(name).ok()?.into(),
                    function: operand(1)?,
                    interface,
                    modes: Vec::new(),
                });
            }
            op::EXECUTION_MODE => {
                let (target, mode) = (operand(0)?, operand(1)?);
                for entry in self.entry_points.iter_mut().filter(|entry| entry.function == target) {
                    entry.modes.push(mode);
                }
            }
            op::DECORATE if operand(1)? == decoration::BUILT_IN => {
                self.built_ins.insert(operand(0)?, operand(2)?);
            }
            op::DECORATE if operand(1)? == decoration::SAMPLE => self.per_sample.push(operand(0)?),
            op::MEMBER_DECORATE if operand(2)? == decoration::SAMPLE => self.has_per_sample_members = true,
            op::TYPE_INT => drop(self.types.insert(operand(0)?, Type::Integer)),
            op::TYPE_VECTOR | op::TYPE_ARRAY => {
                self.types.insert(operand(0)?, Type::Elements(operand(1)?));
            }
            op::TYPE_POINTER => {
                self.types.insert(operand(0)?, Type::Pointer(operand(1)?, operand(2)?));
            }
            op::FUNCTION => {
                *function = Some(operand(1)?);
                self.functions.insert(operand(1)?, Function::default());
            }
            op::FUNCTION_END => *function = None,
            _ => self.in_function(op, operands, *function)?,
        }
        Some(())
    }

    fn in_function(&mut self, op: u32, operands: &[u32], function: Option<u32>) -> Option<()> {
        let operand = |index: usize| operands.get(index).copied();
        if makes_pointers(op) {
            self.results.insert(operand(1)?, operand(0)?);
        }
        let stores = match op {
            op::STORE | op::COPY_MEMORY | op::COPY_MEMORY_SIZED => self.is_memory(operand(0)?),
            op::IMAGE_WRITE | op::ATOMIC_STORE | op::ATOMIC_FLAG_TEST_AND_SET | op::ATOMIC_FLAG_CLEAR => true,
            op::ATOMIC_F_MIN | op::ATOMIC_F_MAX | op::ATOMIC_F_ADD => true,
            op::ATOMIC_EXCHANGE..=op::ATOMIC_XOR => true,
            _ => false,
        };
        if let Some(function) = function.and_then(|function| self.functions.get_mut(&function)) {
            function.stores |= stores;
            function.interlocks |= op == op::BEGIN_INTERLOCK;
            function.discards |=
                matches!(op, op::KILL | op::TERMINATE_INVOCATION | op::DEMOTE_TO_HELPER_INVOCATION);
            if op == op::FUNCTION_CALL {
                function.calls.push(operand(2)?);
            }
        }
        Some(())
    }

    /// Whether a pointer is to memory that others see. One that is not understood is.
    fn is_memory(&self, pointer: u32) -> bool {
        let pointer_type = self.results.get(&pointer).and_then(|result| self.types.get(result));
        match pointer_type {
            Some(&Type::Pointer(class, _)) => {
                ![class::OUTPUT, class::PRIVATE, class::FUNCTION].contains(&class)
            }
            _ => true,
        }
    }

    fn effects(&self, entry: &EntryPoint) -> Effects {
        let has_mode = |mode: u32| entry.modes.contains(&mode);
        let reached = self.reached(entry.function);
        let variables = || entry.interface.iter().filter_map(|&id| Some((id, self.pointer(id)?)));
        let reads = |wanted: u32| entry.interface.iter().any(|id| self.built_ins.get(id) == Some(&wanted));
        Effects {
            stores: reached.iter().any(|function| function.stores),
            interlocks: entry.modes.iter().any(|mode| MODES_INTERLOCK.contains(mode))
                || reached.iter().any(|function| function.interlocks),
            per_sample: reads(built_in::SAMPLE_ID)
                || reads(built_in::SAMPLE_POSITION)
                || self.has_per_sample_members
                || variables().any(|(id, (class, _))| class == class::INPUT && self.per_sample.contains(&id)),
            writes_integers: variables().any(|(id, (class, pointee))| {
                class == class::OUTPUT && !self.built_ins.contains_key(&id) && self.is_integer(pointee)
            }),
            writes_depth_stencil: has_mode(MODE_DEPTH_REPLACING) || has_mode(MODE_STENCIL_REF_REPLACING),
            uses_sample_mask: reads(built_in::SAMPLE_MASK),
            discards: reached.iter().any(|function| function.discards),
        }
    }

    /// A variable's storage class and type.
    fn pointer(&self, variable: u32) -> Option<(u32, u32)> {
        match self.types.get(self.results.get(&variable)?)? {
            &Type::Pointer(class, pointee) => Some((class, pointee)),
            _ => None,
        }
    }

    /// Whether a type is integers, or vectors or arrays of them.
    fn is_integer(&self, of: u32) -> bool {
        const DEEPEST: usize = 8;
        let elements = |&at: &u32| match self.types.get(&at) {
            Some(&Type::Elements(of)) => Some(of),
            _ => None,
        };
        let innermost = std::iter::successors(Some(of), elements).take(DEEPEST).last();
        innermost.is_some_and(|at| matches!(self.types.get(&at), Some(Type::Integer)))
    }

    /// The functions that are called from one, and itself.
    fn reached(&self, from: u32) -> Vec<&Function> {
        let mut ids = vec![from];
        let mut next = 0;
        while let Some(id) = ids.get(next) {
            next += 1;
            let calls = self.functions.get(id).map_or(&[][..], |function| &function.calls);
            let new: Vec<u32> = calls.iter().copied().filter(|call| !ids.contains(call)).collect();
            ids.extend(new);
        }
        ids.iter().filter_map(|id| self.functions.get(id)).collect()
    }
}

/// Whether an instruction has a result that may be a pointer; its operands are type and result first.
fn makes_pointers(op: u32) -> bool {
    matches!(
        op,
        op::FUNCTION_PARAMETER
            | op::FUNCTION_CALL
            | op::VARIABLE
            | op::IMAGE_TEXEL_POINTER
            | op::LOAD
            | op::ACCESS_CHAIN
            | op::IN_BOUNDS_ACCESS_CHAIN
            | op::PTR_ACCESS_CHAIN
            | op::IN_BOUNDS_PTR_ACCESS_CHAIN
            | op::COPY_OBJECT
            | op::CONVERT_U_TO_PTR
            | op::BITCAST
            | op::SELECT
            | op::PHI
    )
}

#[cfg(test)]
pub mod tests;
