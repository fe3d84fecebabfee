//! Clusters: several flowers or fruit on stalks, as one shape.
//!
//! A cluster is one organ: it points along +Y from its foot at the origin, as a leaf does, and one unit is its
//! whole height. What is left to chance (how each member is rolled, how long its stalk is) is drawn by the number
//! of the variant and of the member, so that a kind has the same clusters in all trees.
//!
//! The arrangements are those of botany, idealised: an umbel's stalks end on a part of a sphere, a corymb's on a
//! plate, those of a raceme and a panicle follow the golden angle along a common stalk.

use glam::{Mat3, Vec2, Vec3};

use super::form;
use super::mesh::FoliageError;
use crate::settings::{Cluster, Form, LeafKind};
use crate::texture::leaf::{Cell, Outline};
use linden_base::mesh::Mesh;
use linden_base::random::{GOLDEN_ANGLE, Key};

/// The sizes of a cluster, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Layout {
    shape: Cluster,
    count: u32,
    /// Length of a member without its stalk.
    member: f32,
    /// The common stalk.
    axis: f32,
    /// The longest stalk of a member; the radius of a pompom.
    stalk: f32,
    facing: f32,
}

/// A flower or fruit of a cluster, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Member {
    /// Where its stalk leaves the common one.
    root: Vec3,
    /// Where the stalk would go if it did not bend.
    bend: Vec3,
    /// Where the stalk ends.
    pub at: Vec3,
    /// Unit vector: where it looks, or grows on to.
    pub facing: Vec3,
    /// Unit vector: away from the common stalk.
    out: Vec3,
    roll: f32,
}

/// The part of a raceme or a panicle that bears nothing, at its foot.
const BARE: f32 = 0.15;
/// How far an umbel opens, radians off its axis.
const OPEN: f32 = 1.2;
/// Half the thickness of stalks, in members' lengths, and the least, metres.
const THICK: f32 = 0.012;
const THINNEST_M: f32 = 0.0003;

impl Layout {
    /// That of a kind, with room for all members where it does not say.
    pub fn of(kind: &LeafKind) -> Self {
        let (member, count) = (kind.length_m as f32, kind.cluster_count.max(1));
        let many = (count as f32).sqrt();
        let axis = kind.cluster_length_m.map(|length| length as f32);
        let (usual_axis, usual_stalk, usual_facing) = match kind.cluster {
            Cluster::None => (0.0, 0.0, 0.0),
            Cluster::Umbel => (0.4 * member, (0.42 * many).max(0.9) * member, 0.35),
            Cluster::Corymb => ((0.4 * many + 0.3) * member, 0.56 * many * member, 0.8),
            Cluster::Raceme => ((0.34 * count as f32).max(2.0) * member, 0.5 * member, 0.0),
            Cluster::Panicle => {
                let usual = 0.8 * many.max(1.5) * member;
                (usual, 0.3 * axis.unwrap_or(usual), 0.0)
            }
            Cluster::Pompom => (0.2 * member, (0.22 * many).max(0.35) * member, 0.0),
        };
        Self {
            shape: kind.cluster,
            count,
            member,
            axis: axis.unwrap_or(usual_axis),
            stalk: kind.cluster_stalk_m.map_or(usual_stalk, |stalk| stalk as f32),
            facing: kind.cluster_facing.map_or(usual_facing, |facing| facing as f32),
        }
    }

    /// From the foot to about the end of the last member, metres.
    pub fn height_m(&self) -> f64 {
        let beyond = match self.shape {
            Cluster::Pompom => 2.0 * self.stalk,
            Cluster::Corymb => 0.35 * self.stalk,
            _ => self.stalk,
        };
        f64::from(self.axis + beyond + 0.5 * self.member)
    }

    /// All members of a variant.
    pub fn members(&self, variant: u64) -> Vec<Member> {
        let key = Key::new(variant).named("cluster");
        (0..self.count).map(|i| self.member(i, key.child(u64::from(i)))).collect()
    }

    fn member(&self, i: u32, key: Key) -> Member {
        let share = (i as f32 + 0.5) / self.count as f32;
        let vary = |name: &str, by: f64| 1.0 + key.named(name).between(-by, by) as f32;
        let (sin, cos) = libm::sincosf((f64::from(i) * GOLDEN_ANGLE % std::f64::consts::TAU) as f32);
        let round = Vec3::new(cos, 0.0, sin);
        let end = Vec3::Y * self.axis;
        let stalk = self.stalk * vary("long", 0.12);
        let (root, at, way) = match self.shape {
            Cluster::None => (Vec3::ZERO, Vec3::ZERO, Vec3::Y),
            Cluster::Umbel => {
                let open = if self.count == 1 { 0.0 } else { OPEN };
                let up = 1.0 - (1.0 - libm::cosf(open)) * share;
                let way = (round * (1.0 - up * up).max(0.0).sqrt() + Vec3::Y * up) * vary("open", 0.1);
                self.bent(end, way.normalize_or(Vec3::Y), stalk)
            }
            Cluster::Corymb => {
                let off = share.sqrt();
                let root = end * (1.0 - 0.6 * off);
                let top = 0.35 * self.stalk * (1.0 - 0.4 * off * off) * vary("high", 0.15);
                let at = round * (0.85 * self.stalk * off) * vary("off", 0.06) + end + Vec3::Y * top;
                (root, at, (at - root).normalize_or(Vec3::Y))
            }
            Cluster::Raceme => {
                let root = end * (BARE + (1.0 - BARE) * share);
                let (sin, cos) = libm::sincosf(1.35 - 0.8 * share);
                // The last ones have just opened.
                self.bent(root, round * sin + Vec3::Y * cos, stalk * (1.0 - 0.5 * share))
            }
            Cluster::Panicle => {
                // As many as a cone has room at each height.
                let along = 1.0 - (1.0 - share).sqrt();
                let wide = self.stalk * (1.0 - 0.9 * along);
                let height = end * (BARE + (1.0 - BARE) * along);
                let at = height + round * wide * vary("deep", 0.25);
                let root = height - Vec3::Y * (0.45 * wide).min(height.y);
                let way = (at - root).normalize_or(Vec3::Y);
                (root, at, way)
            }
            Cluster::Pompom => {
                let center = end + Vec3::Y * self.stalk;
                let up = 1.0 - 2.0 * share;
                let way = round * (1.0 - up * up).max(0.0).sqrt() + Vec3::Y * up;
                (center, center + way * stalk, way)
            }
        };
        let facing = way.lerp(Vec3::Y * self.facing.signum(), self.facing.abs()).normalize_or(way);
        let bend = root + way * (0.6 * root.distance(at));
        let out = round;
        Member {
            root,
            bend,
            at,
            facing,
            out,
            roll: key.named("roll").between(0.0, std::f64::consts::TAU) as f32,
        }
    }

    /// Root, end and direction of a stalk that turns to where its flower looks.
    fn bent(&self, root: Vec3, way: Vec3, stalk: f32) -> (Vec3, Vec3, Vec3) {
        let facing = way.lerp(Vec3::Y * self.facing.signum(), self.facing.abs()).normalize_or(way);
        (root, root + (way * 0.6 + facing * 0.4) * stalk, way)
    }

    /// Half the thickness of a stalk.
    fn thick(&self) -> f32 {
        (THICK * self.member).max(THINNEST_M)
    }
}

/// The shape of a variant of a kind whose members stand in clusters: one unit high.
///
/// # Errors
/// [`FoliageError`]: too many triangles of a user's mesh, which `member` is then.
pub(super) fn cluster(
    kind: &LeafKind,
    variant: usize,
    cells: &[Cell],
    users: Option<&Mesh>,
) -> Result<Mesh, FoliageError> {
    let layout = Layout::of(kind);
    let mut all = Mesh::default();
    let stalk_uv = cells.get(variant).map_or(Vec2::ZERO, |cell| cell.stalk);
    let thick = layout.thick();
    if layout.axis > 0.0 {
        let end = Vec3::Y * layout.axis;
        stroke(&mut all, &[Vec3::ZERO, end], Vec3::X * (1.6 * thick), stalk_uv);
        stroke(&mut all, &[Vec3::ZERO, end], Vec3::Z * (1.6 * thick), stalk_uv);
    }
    let models: Vec<Mesh> = cells
        .iter()
        .map(|cell| match users {
            Some(mesh) => mesh.clone(),
            None => form::member(kind, cell),
        })
        .collect();
    let triangles = layout.count as usize * models.first().map_or(0, |model| model.triangles.len());
    if triangles > form::MAX_TRIANGLES {
        return Err(FoliageError::MeshTooLarge { triangles, limit: form::MAX_TRIANGLES });
    }
    for (i, member) in layout.members(variant as u64).iter().enumerate() {
        if layout.shape != Cluster::Pompom && layout.stalk > 0.0 {
            let side = (member.at - member.root).cross(member.facing.any_orthonormal_vector());
            let side = side.normalize_or(member.facing.any_orthonormal_vector()) * thick;
            let middle = member.root.lerp(member.bend, 0.5).lerp(member.bend.lerp(member.at, 0.5), 0.5);
            let is_straight = layout.facing == 0.0;
            let path = [member.root, middle, member.at];
            stroke(&mut all, if is_straight { &path[1..] } else { &path }, side, stalk_uv);
            if is_straight {
                let first = all.positions.len() - 4;
                // From where the stalk begins.
                all.positions[first] = member.root - side;
                all.positions[first + 1] = member.root + side;
            }
        }
        let model = &models[(variant + i) % models.len()];
        // Blades turn their backs to the middle: their tips bend in, as petals and scales do.
        let roll = if is_round(kind) { member.roll } else { 0.0 };
        let turn = frame(member.facing, member.out) * Mat3::from_rotation_y(roll);
        let first = all.positions.len() as u32;
        all.positions.extend(model.positions.iter().map(|&p| member.at + turn * p * layout.member));
        all.normals.extend(model.normals.iter().map(|&n| turn * n));
        all.uvs.extend_from_slice(&model.uvs);
        all.triangles.extend(model.triangles.iter().map(|t| t.map(|v| first + v)));
    }
    let height = (layout.height_m() as f32).max(f32::MIN_POSITIVE);
    all.positions.iter_mut().for_each(|p| *p /= height);
    Ok(all)
}

/// Members that are shown of a cluster while it is turned at most.
const SKETCHED: usize = 12;

/// A few squares in place of the members of a cluster.
pub(super) fn sketch(kind: &LeafKind, cell: &Cell) -> Mesh {
    let layout = Layout::of(kind);
    let members = layout.members(0);
    let shown = members.len().min(SKETCHED);
    let half = 0.5 * layout.member * (members.len() as f32 / shown.max(1) as f32).sqrt();
    let height = (layout.height_m() as f32).max(f32::MIN_POSITIVE);
    let mut all = Mesh::default();
    for i in 0..shown {
        let member = &members[i * members.len() / shown];
        let turn = frame(member.facing, member.out);
        let first = all.positions.len() as u32;
        for corner in [
            Vec3::new(-half, 0.0, half),
            Vec3::new(half, 0.0, half),
            Vec3::new(half, 0.0, -half),
            Vec3::new(-half, 0.0, -half),
        ] {
            all.positions.push((member.at + turn * corner) / height);
            all.normals.push(member.facing);
            all.uvs.push(cell.attach);
        }
        all.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
    }
    all
}

/// Takes +Y to a direction, and +Z as near to another as can be.
fn frame(facing: Vec3, out: Vec3) -> Mat3 {
    let up = out.reject_from_normalized(facing).normalize_or(facing.any_orthonormal_vector());
    Mat3::from_cols(facing.cross(up), facing, up)
}

/// A flat strip along a line of points, `side` to both sides.
fn stroke(all: &mut Mesh, points: &[Vec3], side: Vec3, uv: Vec2) {
    let along = points.last().copied().unwrap_or_default() - points.first().copied().unwrap_or_default();
    let normal = side.cross(along).normalize_or(Vec3::Z);
    for (i, &point) in points.iter().enumerate() {
        let first = all.positions.len() as u32;
        all.positions.extend([point - side, point + side]);
        all.normals.extend([normal; 2]);
        all.uvs.extend([uv; 2]);
        if i > 0 {
            let [a, b, c, d] = [first - 2, first - 1, first + 1, first];
            all.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
}

/// How far the rim of an open flower stands before its middle, that of a double one behind it, and how far the
/// latter reaches back beyond its rim, in its diameters.
const CUP: f32 = 0.18;
const DOME: f32 = 0.3;
const BACK: f32 = 0.26;
/// Sides of an open flower.
const SIDES: usize = 6;

/// A flower or a berry that looks along +Y, its middle at the origin, one unit wide: its picture shows it from
/// above.
pub(super) fn round(kind: &LeafKind, cell: &Cell) -> Mesh {
    match kind.form {
        Form::Card if kind.outline == Outline::Fruit => square(cell, Mat3::IDENTITY),
        _ if kind.outline == Outline::Fruit => ball(cell),
        Form::Card => square(cell, Mat3::IDENTITY),
        Form::Cross | Form::Tuft => {
            let quarter = std::f32::consts::FRAC_PI_2;
            let mut all = square(cell, Mat3::IDENTITY);
            for turn in [Mat3::from_rotation_x(quarter), Mat3::from_rotation_z(quarter)] {
                let other = square(cell, turn);
                let first = all.positions.len() as u32;
                all.positions.extend(other.positions);
                all.normals.extend(other.normals);
                all.uvs.extend(other.uvs);
                all.triangles.extend(other.triangles.iter().map(|t| t.map(|v| first + v)));
            }
            all
        }
        Form::None | Form::Curved | Form::Twig | Form::Fan | Form::Mesh => bowl(kind, cell),
    }
}

/// A point of a flower's picture, from its middle, in its diameters.
fn uv(cell: &Cell, at: Vec2) -> Vec2 {
    (cell.attach + (at + Vec2::new(0.0, 0.5)) * cell.unit).clamp(cell.min, cell.max)
}

/// The picture on a flat square, without the corner that has the colour of stalks.
fn square(cell: &Cell, turn: Mat3) -> Mesh {
    let mut mesh = Mesh::default();
    for (x, y) in [(0.5, -0.5), (0.5, 0.5), (-0.5, 0.5), (-0.5, -0.28), (-0.28, -0.5)] {
        let at = Vec2::new(x, y);
        mesh.positions.push(turn * Vec3::new(x, 0.0, -y));
        mesh.normals.push(turn * Vec3::Y);
        mesh.uvs.push(uv(cell, at));
    }
    mesh.triangles = vec![[0, 1, 2], [0, 2, 3], [0, 3, 4]];
    mesh
}

/// A cup, or the cushion of a double flower, which is full behind too.
fn bowl(kind: &LeafKind, cell: &Cell) -> Mesh {
    match kind.petal_rows {
        0 | 1 => disc(cell, -CUP / 2.0, CUP / 2.0),
        2 => disc(cell, DOME / 2.0, -DOME / 2.0),
        _ => {
            let (mut all, back) = (disc(cell, DOME, 0.0), disc(cell, -BACK, 0.0));
            let first = all.positions.len() as u32;
            all.positions.extend(back.positions);
            all.normals.extend(back.normals.iter().map(|&normal| -normal));
            all.uvs.extend(back.uvs);
            // Seen from behind.
            all.triangles.extend(back.triangles.iter().map(|&[a, b, c]| [first + a, first + c, first + b]));
            all
        }
    }
}

/// The picture on a cone of six sides: the height of its middle and of its rim.
fn disc(cell: &Cell, middle: f32, rim: f32) -> Mesh {
    let mut mesh = Mesh::default();
    mesh.positions.push(Vec3::Y * middle);
    mesh.uvs.push(uv(cell, Vec2::ZERO));
    for side in 0..SIDES {
        let (sin, cos) = libm::sincosf(std::f32::consts::TAU * side as f32 / SIDES as f32);
        // The hexagon holds nearly all of the circle.
        let at = Vec2::new(cos, sin) * 0.555;
        mesh.positions.push(Vec3::new(at.x, rim, -at.y));
        mesh.uvs.push(uv(cell, at));
    }
    for side in 0..SIDES as u32 {
        mesh.triangles.push([0, 1 + side, 1 + (side + 1) % SIDES as u32]);
    }
    mesh.with_smooth_normals()
}

/// An octahedron with the light of a ball.
fn ball(cell: &Cell) -> Mesh {
    let mut mesh = Mesh::default();
    let corners = [Vec3::Y, Vec3::X, Vec3::NEG_Z, Vec3::NEG_X, Vec3::Z, Vec3::NEG_Y];
    for corner in corners {
        // As large as a ball on average.
        mesh.positions.push(corner * 0.56);
        mesh.normals.push(corner);
        let at = Vec2::new(corner.x, -corner.z) * 0.3 + Vec2::new(0.0, 0.02);
        mesh.uvs.push(uv(cell, at));
    }
    for side in 0..4 {
        let (a, b) = (1 + side, 1 + (side + 1) % 4);
        mesh.triangles.extend([[0, a, b], [5, b, a]]);
    }
    mesh
}

/// Whether a kind's members look out from their stalks, as flowers and berries do, or go on along them.
pub(super) fn is_round(kind: &LeafKind) -> bool {
    matches!(kind.outline, Outline::Blossom | Outline::Fruit) && kind.form != Form::Mesh
}

#[cfg(test)]
mod tests {
    use super::*;

    fn layout(cluster: Cluster, count: u32) -> Layout {
        Layout::of(&LeafKind { cluster, cluster_count: count, length_m: 0.02, ..LeafKind::default() })
    }

    const ALL: [Cluster; 5] =
        [Cluster::Umbel, Cluster::Corymb, Cluster::Raceme, Cluster::Panicle, Cluster::Pompom];

    #[test]
    fn members_have_room() {
        for cluster in ALL {
            for count in [3, 12, 60] {
                let members = layout(cluster, count).members(1);
                let mut sum = 0.0;
                for (i, a) in members.iter().enumerate() {
                    let others = members.iter().enumerate().filter(|(j, _)| *j != i);
                    sum += others.map(|(_, b)| a.at.distance(b.at)).fold(f32::MAX, f32::min);
                }
                let nearest = sum / members.len() as f32 / 0.02;
                assert!((0.4..2.0).contains(&nearest), "{cluster:?} {count}: {nearest} lengths to the next");
            }
        }
    }

    #[test]
    fn each_arrangement_is_what_botany_calls_so() {
        let heights = |members: &[Member]| -> (f32, f32) {
            let all = members.iter().map(|member| member.at.y);
            (all.clone().fold(f32::MAX, f32::min), all.fold(0.0, f32::max))
        };
        let off = |at: Vec3| Vec2::new(at.x, at.z).length();
        // All stalks from one point, equally long but for chance.
        let umbel = layout(Cluster::Umbel, 20);
        for member in umbel.members(0) {
            assert_eq!(member.root, Vec3::Y * umbel.axis);
            assert!((member.at.distance(member.root) / umbel.stalk - 1.0).abs() < 0.25);
        }
        // Level above, outer stalks longer.
        let corymb = layout(Cluster::Corymb, 40).members(0);
        let (low, high) = heights(&corymb);
        let wide = corymb.iter().map(|member| off(member.at)).fold(0.0, f32::max);
        assert!(high - low < 0.45 * wide, "{low} {high} {wide}");
        let long = |member: &Member| member.at.distance(member.root);
        assert!(long(&corymb[39]) > 1.5 * long(&corymb[0]));
        // Along a common stalk; a panicle is widest at its foot.
        let raceme = layout(Cluster::Raceme, 20);
        let (low, high) = heights(&raceme.members(0));
        assert!(high - low > 0.7 * raceme.axis);
        let panicle = layout(Cluster::Panicle, 60).members(0);
        let (low, high) = heights(&panicle);
        let wide = |from: f32, to: f32| {
            let within = panicle.iter().filter(|m| (from..=to).contains(&((m.at.y - low) / (high - low))));
            within.map(|m| off(m.at)).fold(0.0, f32::max)
        };
        assert!(wide(0.0, 0.3) > 2.0 * wide(0.75, 1.0));
        // A ball.
        let pompom = layout(Cluster::Pompom, 40);
        let center = Vec3::Y * (pompom.axis + pompom.stalk);
        for member in pompom.members(0) {
            assert!((member.at.distance(center) / pompom.stalk - 1.0).abs() < 0.13);
            assert!((member.at - center).normalize().dot(member.facing) > 0.999);
        }
    }

    #[test]
    fn members_look_where_they_are_told() {
        for (facing, sign) in [(1.0, 1.0), (-1.0, -1.0)] {
            let kind =
                LeafKind { cluster: Cluster::Umbel, cluster_facing: Some(facing), ..LeafKind::default() };
            assert!(Layout::of(&kind).members(0).iter().all(|member| member.facing.y * sign > 0.999));
        }
    }
}
