//! Features that WGSL lacks: rewritten in the SPIR-V words, as the SPIR-V specification numbers them.

const HEADER: usize = 5;

const EXTENSION: u32 = 10;
const CAPABILITY: u32 = 17;
const TYPE_IMAGE: u32 = 25;
const DECORATE: u32 = 71;
const IMAGE_FETCH: u32 = 95;
const IMAGE_READ: u32 = 98;

const FLAT: u32 = 14;
const BUILT_IN: u32 = 11;
const LOCATION: u32 = 30;
const BINDING: u32 = 33;
const INPUT_ATTACHMENT_INDEX: u32 = 43;
const VIEWPORT_INDEX: u32 = 10;

const SUBPASS_DATA: u32 = 6;
const LOD: u32 = 2;

const INPUT_ATTACHMENT: u32 = 40;
const SHADER_VIEWPORT_INDEX_LAYER: u32 = 5254;

/// Makes the module's one texture, at this binding, an input attachment with index 0.
pub fn input_attachment(words: &[u32], binding: u32) -> Vec<u32> {
    let mut patched = with_capability(words, INPUT_ATTACHMENT);
    for instruction in instructions(words) {
        let mut instruction = instruction.to_vec();
        match opcode(&instruction) {
            TYPE_IMAGE => (instruction[3], instruction[7]) = (SUBPASS_DATA, 2),
            IMAGE_FETCH => {
                // A level of detail is not for input attachments; the number of a sample is.
                if instruction.get(5) == Some(&LOD) {
                    instruction.truncate(5);
                }
                instruction[0] = (instruction.len() as u32) << 16 | IMAGE_READ;
            }
            DECORATE if instruction[2..] == [BINDING, binding] => {
                patched.extend([4 << 16 | DECORATE, instruction[1], INPUT_ATTACHMENT_INDEX, 0]);
            }
            _ => {}
        }
        patched.extend(instruction);
    }
    patched
}

/// Makes the outputs at this location the index of the viewport.
pub fn viewport_index(words: &[u32], location: u32) -> Vec<u32> {
    let mut patched = with_capability(words, SHADER_VIEWPORT_INDEX_LAYER);
    let routed: Vec<u32> = instructions(words)
        .filter(|one| opcode(one) == DECORATE && one[2..] == [LOCATION, location])
        .map(|one| one[1])
        .collect();
    let mut extended = false;
    for instruction in instructions(words) {
        if !extended && opcode(instruction) != CAPABILITY {
            let name = b"SPV_EXT_shader_viewport_index_layer\0";
            patched.push((1 + name.len() as u32 / 4) << 16 | EXTENSION);
            patched
                .extend(name.chunks(4).map(|four| u32::from_le_bytes([four[0], four[1], four[2], four[3]])));
            extended = true;
        }
        if opcode(instruction) == DECORATE && routed.contains(&instruction[1]) {
            if instruction[2] == LOCATION {
                patched.extend([4 << 16 | DECORATE, instruction[1], BUILT_IN, VIEWPORT_INDEX]);
            }
            assert!([LOCATION, FLAT].contains(&instruction[2]), "no other decoration is expected");
            continue;
        }
        patched.extend(instruction);
    }
    patched
}

fn with_capability(words: &[u32], capability: u32) -> Vec<u32> {
    let mut patched = words[..HEADER].to_vec();
    patched.extend([2 << 16 | CAPABILITY, capability]);
    patched
}

fn opcode(instruction: &[u32]) -> u32 {
    instruction[0] & 0xffff
}

fn instructions(words: &[u32]) -> impl Iterator<Item = &[u32]> {
    let mut rest = &words[HEADER..];
    std::iter::from_fn(move || {
        let length = (*rest.first()? >> 16) as usize;
        let (instruction, after) = rest.split_at(length);
        rest = after;
        Some(instruction)
    })
}
