//! Operations over the fragments of a subgroup.

/// Capabilities of operations whose results depend on the other fragments of the subgroup. Source: SPIR-V specification, section 3.31,
/// "Capability".
pub const OVER_SUBGROUPS: [u32; 13] = [
    capability::GROUPS,
    capability::GROUP_NON_UNIFORM_VOTE,
    capability::GROUP_NON_UNIFORM_ARITHMETIC,
    capability::GROUP_NON_UNIFORM_BALLOT,
    capability::GROUP_NON_UNIFORM_SHUFFLE,
    capability::GROUP_NON_UNIFORM_SHUFFLE_RELATIVE,
    capability::GROUP_NON_UNIFORM_CLUSTERED,
    capability::SUBGROUP_BALLOT,
    capability::SUBGROUP_VOTE,
    capability::GROUP_NON_UNIFORM_PARTITIONED_NV,
    capability::SUBGROUP_SHUFFLE_INTEL,
    capability::GROUP_NON_UNIFORM_ROTATE,
    capability::GROUP_UNIFORM_ARITHMETIC,
];

/// Numbers of capabilities, by their names in SPIR-V.
mod capability {
    /// Of `SPV_AMD_shader_ballot`, too.
    pub const GROUPS: u32 = 18;
    pub const GROUP_NON_UNIFORM_VOTE: u32 = 62;
    pub const GROUP_NON_UNIFORM_ARITHMETIC: u32 = 63;
    pub const GROUP_NON_UNIFORM_BALLOT: u32 = 64;
    pub const GROUP_NON_UNIFORM_SHUFFLE: u32 = 65;
    pub const GROUP_NON_UNIFORM_SHUFFLE_RELATIVE: u32 = 66;
    pub const GROUP_NON_UNIFORM_CLUSTERED: u32 = 67;
    pub const SUBGROUP_BALLOT: u32 = 4423;
    pub const SUBGROUP_VOTE: u32 = 4431;
    pub const GROUP_NON_UNIFORM_PARTITIONED_NV: u32 = 5297;
    pub const SUBGROUP_SHUFFLE_INTEL: u32 = 5568;
    pub const GROUP_NON_UNIFORM_ROTATE: u32 = 6026;
    pub const GROUP_UNIFORM_ARITHMETIC: u32 = 6400;
}
