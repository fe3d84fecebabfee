//! The groups of joints that Unreal's plug-in Dynamic Wind moves, as the JSON that it imports.
//!
//! ```json
//! {"Joints": [{"JointName": "joint_0_0", "SimulationGroupIndex": 0}, …],
//!  "SimulationGroups": [{"bUseDualInfluence": false, "Influence": 0.31, "MinInfluence": 0, "MaxInfluence": 0,
//!                        "ShiftTop": 0, "bIsTrunkGroup": true}, …],
//!  "bIsGroundCover": false, "GustAttenuation": 0.5}
//! ```
//!
//! A group for each order of axes, stems first and as the trunk group; the plug-in takes joints of one group, each the parent
//! of the next, for a chain, and those are linden's axes. `Influence` is how far the axes of that order bend in linden's own
//! sway ([`Bones::bends_rad`]) as a share of the order that bends most. `GustAttenuation`, which holds gusts back from trunks,
//! is what `gustiness` leaves of 1. How strong and whence the wind blows is the engine's to say.
//!
//! The keys are those that Epic's plug-in writes by its Python example `export_dynamic_wind_json.py`; what they mean is told
//! by `VitalyVishnev/SpeedAssembly` (`wind_dynamic_json.md`) and by the notes of `XRFutureForests/growpy`. Not tried there.

use linden_pipeline::wind::Bones;

/// What the name of the file ends with, after that of the main file.
pub(super) const SUFFIX: &str = "_wind.json";

/// The file.
pub(super) fn describe(bones: &Bones) -> String {
    let bends = bones.bends_rad();
    let most = bends.iter().copied().fold(0.0, f32::max);
    let joint = |joint: &linden_pipeline::wind::Joint| {
        format!("{{ \"JointName\": \"{}\", \"SimulationGroupIndex\": {} }}", joint.name, joint.order)
    };
    let group = |(order, bend): (usize, &f32)| {
        let share = if most > 0.0 { to_places(bend / most) } else { 0.0 };
        format!(
            "{{ \"bUseDualInfluence\": false, \"Influence\": {share}, \"MinInfluence\": 0, \"MaxInfluence\": 0, \
             \"ShiftTop\": 0, \"bIsTrunkGroup\": {} }}",
            order == 0
        )
    };
    let listed = |rows: Vec<String>| rows.join(",\n        ");
    let joints = listed(bones.joints.iter().map(joint).collect());
    let groups = listed(bends.iter().enumerate().map(group).collect());
    let attenuation = to_places((1.0 - bones.sway.gustiness()) as f32);
    format!(
        "{{\n    \"Joints\": [\n        {joints}\n    ],\n    \"SimulationGroups\": [\n        {groups}\n    ],\n    \
         \"bIsGroundCover\": false,\n    \"GustAttenuation\": {attenuation}\n}}\n"
    )
}

/// To four places.
fn to_places(share: f32) -> f32 {
    libm::roundf(share * 1e4) / 1e4
}
