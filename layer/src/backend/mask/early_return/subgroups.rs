//! Operations over the fragments of a subgroup.

/// Capabilities of operations whose results depend on the other fragments of the subgroup. Source: SPIR-V specification, section 3.31,
/// "Capability".
pub const OVER_SUBGROUPS: [u32; 9] = [
    capability::GROUP_NON_UNIFORM_VOTE,
    capability::GROUP_NON_UNIFORM_ARITHMETIC,
    capability::GROUP_NON_UNIFORM_BALLOT,
    capability::GROUP_NON_UNIFORM_SHUFFLE,
    capability::GROUP_NON_UNIFORM_SHUFFLE_RELATIVE,
    capability::GROUP_NON_UNIFORM_CLUSTERED,
    capability::SUBGROUP_BALLOT,
    capability::SUBGROUP_VOTE,
    capability::GROUP_NON_UNIFORM_ROTATE,
];

/// Numbers of capabilities, by their names in SPIR-V.
mod capability {
    pub const GROUP_NON_UNIFORM_VOTE: u32 = 62;
    pub const GROUP_NON_UNIFORM_ARITHMETIC: u32 = 63;
    pub const GROUP_NON_UNIFORM_BALLOT: u32 = 64;
    pub const GROUP_NON_UNIFORM_SHUFFLE: u32 = 65;
    pub const GROUP_NON_UNIFORM_SHUFFLE_RELATIVE: u32 = 66;
    pub const GROUP_NON_UNIFORM_CLUSTERED: u32 = 67;
    pub const SUBGROUP_BALLOT: u32 = 4423;
    pub const SUBGROUP_VOTE: u32 = 4431;
    pub const GROUP_NON_UNIFORM_ROTATE: u32 = 6026;
}
