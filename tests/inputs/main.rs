//! What users bring: meshes, points, scans; well made, hostile, and from other programs.

mod envelope;
mod obj;
mod ply;
mod scan;
mod shapes;
mod xyz;
