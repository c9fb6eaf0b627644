//! Fragment shaders that return at once in skipped blocks: SPIR-V with a test of ours in front of the application's code.
//!
//! The entry point becomes a function of ours, which looks up the fragment's block ([`EarlyReturnParams`]) and calls the application's if
//! that is shaded. Nothing else in the module changes, so that shaded fragments compute the same results:
//! - Blocks of 4x4 pixels are counted from the framebuffer's corner, regardless of viewport and render area, and so are quads of 2x2: all
//!   invocations of a quad, helpers too, have their own FragCoord and take the same way. Derivatives need no more (Vulkan specification,
//!   "Derivative Operations": control flow that is uniform within the quad).
//! - Operations on subgroups see fewer invocations than before, unless each lies in one block; modules that have any but the election of
//!   one, and quads', are left alone. On the CPU each does: llvmpipe shades stamps of 4x4 pixels, aligned to four, by one or more vectors
//!   each, and SwiftShader quads. The content of subgroups is up to the device (Vulkan specification, "Subgroup").
//! - Nothing is discarded. Where the shader itself neither discards nor writes depth or coverage, the same samples pass depth tests, and
//!   their depth is written. An early fragment's outputs are zero.
//!
//! The result depends on the module alone: it is the same in every run.
//!
//! [`EarlyReturnParams`]: parafovea_core::mask::EarlyReturnParams

mod module;
mod subgroups;

use crate::vk::shaders::spirv::{
    Instruction, MODEL_FRAGMENT, built_in, class, decoration, op, text, words_of,
};
use module::{Assembly, Parsed};
use std::ffi::CStr;
use subgroups::OVER_SUBGROUPS;
use thiserror::Error;

/// The wanted shader.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EarlyReturn<'a> {
    /// Name of the entry point.
    pub entry: &'a str,
    /// Number of the descriptor set of ours: a storage buffer with the template at binding 0, a uniform one with the parameters
    /// at 1.
    pub set: u32,
    /// Whether the layer is the view that is drawn (multiview), else 0.
    pub by_view: bool,
    /// Whether no subgroup of the device lies in two blocks of 4x4 pixels that are counted from the framebuffer's corner: all invocations
    /// of one take the same path, like the invocations of a quad.
    pub has_whole_subgroups: bool,
}

/// Reason why a shader cannot return early.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum NoEarlyReturn {
    /// It is no SPIR-V of a kind that is known.
    #[error("a shader that the layer cannot parse")]
    Unknown,
    /// It computes over a subgroup.
    #[error("a shader with subgroup operations")]
    Subgroups,
    /// It takes the position of its fragment in a way that cannot be shared, or with less than its precision.
    #[error("a shader without access to the position of its fragment")]
    Position,
}

/// Words of [`EarlyReturnParams`](parafovea_core::mask::EarlyReturnParams).
const PARAMS: usize = size_of::<parafovea_core::mask::EarlyReturnParams>() / 4;

const VERSION_1_3: u32 = 0x0001_0300;
const VERSION_1_4: u32 = 0x0001_0400;
const CAPABILITY_MULTI_VIEW: u32 = 4439;

/// The extension with this capability; SPIR-V 1.3 includes it.
const MULTI_VIEW_EXTENSION: &CStr = c"SPV_KHR_multiview";

/// Whether fragments of any shader of the module may be discarded, or turned into helpers.
pub fn discards(words: &[u32]) -> bool {
    let is_discard = |found: Instruction<'_>| {
        matches!(found.op, op::KILL | op::TERMINATE_INVOCATION | op::DEMOTE_TO_HELPER_INVOCATION)
    };
    Parsed::of(words).is_none_or(|parsed| parsed.instructions.iter().any(|found| is_discard(*found)))
}

/// The module with the shader returning early, and no other entry point.
///
/// # Errors
/// The reason against it.
pub fn returning_early(words: &[u32], wanted: EarlyReturn<'_>) -> Result<Vec<u32>, NoEarlyReturn> {
    let parsed = Parsed::of(words).ok_or(NoEarlyReturn::Unknown)?;
    let is_over_subgroups = |found: &Instruction<'_>| {
        found.op == op::CAPABILITY && found.operands.first().is_some_and(|of| OVER_SUBGROUPS.contains(of))
    };
    if !wanted.has_whole_subgroups && parsed.instructions.iter().any(is_over_subgroups) {
        return Err(NoEarlyReturn::Subgroups);
    }
    Patch::new(&parsed, wanted)?.finish(&parsed)
}

/// The entry point as it was.
struct Entry {
    function: u32,
    interface: Vec<u32>,
}

impl Entry {
    fn of(parsed: &Parsed<'_>, name: &str) -> Option<Self> {
        parsed.instructions.iter().filter(|found| found.op == op::ENTRY_POINT).find_map(|found| {
            let (is, words) = text(found.operands.get(2..)?)?;
            let is_wanted = found.operands[0] == MODEL_FRAGMENT && is == name.as_bytes();
            let interface = found.operands.get(2 + words..)?.to_vec();
            is_wanted.then_some(Self { function: found.operands[1], interface })
        })
    }
}

/// The module on its way.
struct Patch<'a> {
    entry: Entry,
    wanted: EarlyReturn<'a>,
    version: u32,
    /// New decorations, declarations, and the function.
    decorations: Assembly,
    globals: Assembly,
    function: Assembly,
    wrapper: u32,
    bound: u32,
}

impl<'a> Patch<'a> {
    fn new(parsed: &Parsed<'_>, wanted: EarlyReturn<'a>) -> Result<Self, NoEarlyReturn> {
        let entry = Entry::of(parsed, wanted.entry).ok_or(NoEarlyReturn::Unknown)?;
        let mut patch = Self {
            entry,
            wanted,
            version: parsed.version,
            decorations: Assembly::default(),
            globals: Assembly::default(),
            function: Assembly::default(),
            wrapper: 0,
            bound: parsed.bound,
        };
        patch.wrapper = patch.id();
        patch.write(parsed)?;
        Ok(patch)
    }

    fn id(&mut self) -> u32 {
        self.bound += 1;
        self.bound - 1
    }

    /// A type that the module has, or gets: types that are not aggregates must be declared once.
    fn declared(&mut self, parsed: &Parsed<'_>, op: u32, operands: &[u32]) -> u32 {
        let of_module =
            parsed.globals().find(|found| found.op == op && found.operands.get(1..) == Some(operands));
        if let Some(found) = of_module {
            return found.operands[0];
        }
        self.fresh(op, operands)
    }

    fn fresh(&mut self, op: u32, operands: &[u32]) -> u32 {
        let id = self.id();
        self.globals.push(op, &[&[id], operands].concat());
        id
    }

    fn constant(&mut self, uint: u32, value: u32) -> u32 {
        let id = self.id();
        self.globals.push(op::CONSTANT, &[uint, id, value]);
        id
    }

    fn variable(&mut self, parsed: &Parsed<'_>, class: u32, of: u32) -> u32 {
        let pointer = self.declared(parsed, op::TYPE_POINTER, &[class, of]);
        let id = self.id();
        self.globals.push(op::VARIABLE, &[pointer, id, class]);
        id
    }

    /// A value of the function: its type and operands.
    fn value(&mut self, op: u32, ty: u32, operands: &[u32]) -> u32 {
        let id = self.id();
        self.function.push(op, &[&[ty, id], operands].concat());
        id
    }

    /// The input variable of a built-in and the type that it points to; one that the entry point has is used again (there must
    /// be no two, VUID-StandaloneSpirv-OpEntryPoint-09658).
    fn built_in(&mut self, parsed: &Parsed<'_>, which: u32, of: u32) -> Result<(u32, u32), NoEarlyReturn> {
        if parsed.has_member_built_in(which) {
            return Err(NoEarlyReturn::Position);
        }
        let own = self
            .entry
            .interface
            .iter()
            .copied()
            .find(|id| parsed.is_decorated(*id, &[decoration::BUILT_IN, which]));
        let Some(own) = own else {
            let id = self.variable(parsed, class::INPUT, of);
            self.decorations.push(op::DECORATE, &[id, decoration::BUILT_IN, which]);
            self.entry.interface.push(id);
            return Ok((id, of));
        };
        if parsed.is_decorated(own, &[decoration::RELAXED_PRECISION]) {
            return Err(NoEarlyReturn::Position);
        }
        Ok((own, parsed.pointee(own).ok_or(NoEarlyReturn::Unknown)?))
    }

    /// The buffer of the template, which is only read.
    fn template(&mut self, parsed: &Parsed<'_>, uint: u32) -> u32 {
        // Storage buffers have a class of their own from 1.3 on, and from 1.4 on all variables are in the interface.
        let (class, block) = match self.version >= VERSION_1_3 {
            true => (class::STORAGE_BUFFER, decoration::BLOCK),
            false => (class::UNIFORM, decoration::BUFFER_BLOCK),
        };
        let array = self.fresh(op::TYPE_RUNTIME_ARRAY, &[uint]);
        let structure = self.fresh(op::TYPE_STRUCT, &[array]);
        self.decorations.push(op::DECORATE, &[array, decoration::ARRAY_STRIDE, 4]);
        self.decorations.push(op::DECORATE, &[structure, block]);
        self.decorations.push(op::MEMBER_DECORATE, &[structure, 0, decoration::OFFSET, 0]);
        self.decorations.push(op::MEMBER_DECORATE, &[structure, 0, decoration::NON_WRITABLE]);
        self.bound_to(parsed, (class, structure), 0)
    }

    /// The buffer of the parameters: software reads words of a uniform one for all fragments at once.
    fn params(&mut self, parsed: &Parsed<'_>, uint: u32) -> u32 {
        let structure = self.fresh(op::TYPE_STRUCT, &[uint; PARAMS]);
        self.decorations.push(op::DECORATE, &[structure, decoration::BLOCK]);
        for member in 0..PARAMS as u32 {
            self.decorations.push(op::MEMBER_DECORATE, &[structure, member, decoration::OFFSET, 4 * member]);
        }
        self.bound_to(parsed, (class::UNIFORM, structure), 1)
    }

    fn bound_to(&mut self, parsed: &Parsed<'_>, (class, structure): (u32, u32), binding: u32) -> u32 {
        let id = self.variable(parsed, class, structure);
        self.decorations.push(op::DECORATE, &[id, decoration::DESCRIPTOR_SET, self.wanted.set]);
        self.decorations.push(op::DECORATE, &[id, decoration::BINDING, binding]);
        if self.version >= VERSION_1_4 {
            self.entry.interface.push(id);
        }
        id
    }

    fn write(&mut self, parsed: &Parsed<'_>) -> Result<(), NoEarlyReturn> {
        let void = self.declared(parsed, op::TYPE_VOID, &[]);
        let function = self.declared(parsed, op::TYPE_FUNCTION, &[void]);
        let bool = self.declared(parsed, op::TYPE_BOOL, &[]);
        let uint = self.declared(parsed, op::TYPE_INT, &[32, 0]);
        let float = self.declared(parsed, op::TYPE_FLOAT, &[32]);
        let vec4 = self.declared(parsed, op::TYPE_VECTOR, &[float, 4]);
        let (position, position_type) = self.built_in(parsed, built_in::FRAG_COORD, vec4)?;
        let view = match self.wanted.by_view {
            true => Some(self.view(parsed, uint)?),
            false => None,
        };
        let (template, params) = (self.template(parsed, uint), self.params(parsed, uint));
        let param = self.declared(parsed, op::TYPE_POINTER, &[class::UNIFORM, uint]);
        let word = match self.version >= VERSION_1_3 {
            true => self.declared(parsed, op::TYPE_POINTER, &[class::STORAGE_BUFFER, uint]),
            false => param,
        };
        let constants: [u32; PARAMS] = std::array::from_fn(|value| self.constant(uint, value as u32));

        let outputs = self.outputs(parsed);
        let [start, body, early, end] = std::array::from_fn(|_| self.id());
        self.function.push(op::FUNCTION, &[void, self.wrapper, 0, function]);
        self.function.push(op::LABEL, &[start]);
        let params: [u32; PARAMS] = constants.map(|index| {
            let at = self.value(op::ACCESS_CHAIN, param, &[params, index]);
            self.value(op::LOAD, uint, &[at])
        });
        let [row_words, layer_words, column_shift, row_shift, shaded] = params;
        let position = self.value(op::LOAD, position_type, &[position]);
        let [x, y] = [0, 1].map(|axis| {
            let at = self.value(op::COMPOSITE_EXTRACT, float, &[position, axis]);
            self.value(op::CONVERT_F_TO_U, uint, &[at])
        });
        let row = self.value(op::SHIFT_RIGHT_LOGICAL, uint, &[y, row_shift]);
        let row = self.value(op::I_MUL, uint, &[row, row_words]);
        let column = self.value(op::SHIFT_RIGHT_LOGICAL, uint, &[x, column_shift]);
        let mut index = self.value(op::I_ADD, uint, &[row, column]);
        if let Some((view, view_type)) = view {
            let layer = self.value(op::LOAD, view_type, &[view]);
            let layer = if view_type == uint { layer } else { self.value(op::BITCAST, uint, &[layer]) };
            let layer = self.value(op::I_MUL, uint, &[layer, layer_words]);
            index = self.value(op::I_ADD, uint, &[layer, index]);
        }
        let at = self.value(op::ACCESS_CHAIN, word, &[template, constants[0], index]);
        let found = self.value(op::LOAD, uint, &[at]);
        let is_shaded = self.value(op::I_EQUAL, bool, &[found, shaded]);
        self.function.push(op::SELECTION_MERGE, &[end, 0]);
        self.function.push(op::BRANCH_CONDITIONAL, &[is_shaded, body, early]);
        self.function.push(op::LABEL, &[body]);
        self.value(op::FUNCTION_CALL, void, &[self.entry.function]);
        self.function.push(op::BRANCH, &[end]);
        self.function.push(op::LABEL, &[early]);
        for (output, zero) in outputs {
            self.function.push(op::STORE, &[output, zero]);
        }
        self.function.push(op::BRANCH, &[end]);
        self.function.push(op::LABEL, &[end]);
        self.function.push(op::RETURN, &[]);
        self.function.push(op::FUNCTION_END, &[]);
        Ok(())
    }

    /// The outputs of the entry point to attachments, each with a zero of its type. Built-ins stay: a shader that changes coverage by them
    /// does not return early where coverage counts.
    fn outputs(&mut self, parsed: &Parsed<'_>) -> Vec<(u32, u32)> {
        let interface = self.entry.interface.clone();
        let colors = interface.into_iter().filter(|id| {
            parsed.class(*id) == Some(class::OUTPUT) && !parsed.has_decoration(*id, decoration::BUILT_IN)
        });
        colors.filter_map(|id| Some((id, self.fresh_zero(parsed.pointee(id)?)))).collect()
    }

    fn fresh_zero(&mut self, of: u32) -> u32 {
        let id = self.id();
        self.globals.push(op::CONSTANT_NULL, &[of, id]);
        id
    }

    fn view(&mut self, parsed: &Parsed<'_>, uint: u32) -> Result<(u32, u32), NoEarlyReturn> {
        let known = self.entry.interface.len();
        let view = self.built_in(parsed, built_in::VIEW_INDEX, uint)?;
        if self.entry.interface.len() > known {
            self.decorations.push(op::DECORATE, &[view.0, decoration::FLAT]);
        }
        Ok(view)
    }

    fn finish(self, parsed: &Parsed<'_>) -> Result<Vec<u32>, NoEarlyReturn> {
        let is_function = |found: &&Instruction<'_>| found.op == op::FUNCTION;
        let first_function = parsed.instructions.iter().find(is_function).ok_or(NoEarlyReturn::Unknown)?;
        let last_decoration = parsed.instructions.iter().rposition(|found| found.is_decoration());
        let last_decoration = last_decoration.ok_or(NoEarlyReturn::Unknown)?;
        let has_capability = parsed
            .instructions
            .iter()
            .any(|found| found.op == op::CAPABILITY && found.operands == [CAPABILITY_MULTI_VIEW]);
        let mut out = parsed.header(self.bound);
        let needs_capability = self.wanted.by_view && !has_capability;
        if needs_capability {
            out.push(op::CAPABILITY, &[CAPABILITY_MULTI_VIEW]);
        }
        // Capabilities come first, extensions next. Multiview is an extension before 1.3: Qt compiles its shaders to SPIR-V 1.0.
        let mut extension_is_due = needs_capability && self.version < VERSION_1_3;
        for (index, found) in parsed.instructions.iter().enumerate() {
            if extension_is_due && found.op != op::CAPABILITY {
                out.push(op::EXTENSION, &words_of(MULTI_VIEW_EXTENSION));
                extension_is_due = false;
            }
            if std::ptr::eq(found, first_function) {
                out.append(&self.globals);
            }
            match found.op {
                op::ENTRY_POINT => self.entry_point(found, &mut out),
                op::EXECUTION_MODE | op::EXECUTION_MODE_ID => {
                    if found.operands.first() == Some(&self.entry.function) {
                        out.push(found.op, &[&[self.wrapper], &found.operands[1..]].concat());
                    }
                }
                _ => out.push(found.op, found.operands),
            }
            if index == last_decoration {
                out.append(&self.decorations);
            }
        }
        out.append(&self.function);
        Ok(out.into_words())
    }

    /// The entry point is ours; others, which may be anything, go.
    fn entry_point(&self, found: &Instruction<'_>, out: &mut Assembly) {
        let operands = found.operands;
        let Some((name, words)) = operands.get(2..).and_then(text) else { return };
        if operands[0] == MODEL_FRAGMENT && name == self.wanted.entry.as_bytes() {
            let name = &operands[2..2 + words];
            out.push(
                op::ENTRY_POINT,
                &[&[MODEL_FRAGMENT, self.wrapper], name, &self.entry.interface].concat(),
            );
        }
    }
}

#[cfg(test)]
mod tests;
