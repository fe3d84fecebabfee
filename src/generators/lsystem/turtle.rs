//! The turtle of ABOP, appendix C, drawing a branching structure and what grows on it.

use glam::{DVec3, Vec3};

use super::command::{Command, Sense};
use super::derive::Sink;
use super::error::LsystemError;
use super::frame::{Axis, Frame, Turn};
use super::polygon::Herbarium;
use super::program::Program;
use super::turtle_settings::{MAX_NESTING, TurtleSettings};
use super::variation::Chance;
use linden_base::memory::{OverMemory, bytes_grown, bytes_of};
use linden_base::monitor::Holding;
use linden_base::monitor::Monitor;
use linden_base::random::Key;
use linden_skeleton::organs::{Organs, prototype};
use linden_skeleton::{Branching, Edge, NO_PARENT};

/// Wood is no thinner and no thicker, however often its width was multiplied: metres of radius.
const RADII_M: [f64; 2] = [1e-6, 1e6];
/// A size of an organ that is no size.
pub(super) const LARGEST_ORGAN: f64 = 1e6;
/// How near to a node, in segments, a turtle that drew an outline must come back to stand on it.
const BACK: f64 = 1e-5;

/// A [`Command`] with its numbers, ready to be obeyed.
#[derive(Clone, Copy, Debug)]
enum Action {
    Nothing,
    Draw {
        length_m: f64,
        is_edge: bool,
    },
    Move {
        length_m: f64,
    },
    Push,
    Pop,
    Turn(Axis, Turn),
    TurnAround,
    Level,
    /// In units of the segment width.
    Width(f64),
    Thinner,
    Color(u32),
    NextColor,
    PolygonBegin,
    PolygonVertex,
    PolygonEnd,
    Organ,
}

/// Where the next segment starts.
#[derive(Clone, Copy, Debug)]
enum Anchor {
    /// At a node.
    Node(u32),
    /// At a place without a node so far: an index into [`Turtle::feet`].
    Foot(u32),
}

/// A place where a stem may start.
#[derive(Clone, Copy, Debug)]
struct Foot {
    position: DVec3,
    /// Once something has been drawn from there. Branches that start at one place share its node.
    node: Option<u32>,
}

/// What a bracket remembers.
#[derive(Clone, Copy, Debug)]
struct State {
    position: DVec3,
    frame: Frame,
    anchor: Anchor,
    /// Whether it left its anchor on the edges of a polygon.
    is_adrift: bool,
    /// The last node on the way here.
    node: u32,
    /// How the next segment is joined to its anchor.
    edge: Edge,
    color: u32,
    /// In units of the segment width.
    width: f64,
}

/// For messages about memory.
const DOING: &str = "drawing the L-system";
const ADVICE: &str = "use fewer derivations";

/// Walks, and leaves nodes and organs behind.
pub(super) struct Turtle<'a> {
    /// By module identifier.
    actions: Vec<Action>,
    /// By module identifier, for modules whose arguments are computed.
    commands: Vec<Command>,
    /// By module identifier: what it is as the name of an organ, and the size that it gives.
    names: Vec<(char, f64)>,
    settings: TurtleSettings,
    state: State,
    stack: Vec<State>,
    branching: Branching,
    feet: Vec<Foot>,
    /// How many of `feet` a state on the stack may know; later ones are known to the turtle alone.
    shared_feet: usize,
    herbarium: Herbarium,
    /// Whether the next module names an organ.
    is_placing: bool,
    chance: Option<Chance>,
    /// Bytes that derivation holds.
    beside: u64,
    monitor: &'a dyn Monitor,
}

impl<'a> Turtle<'a> {
    /// `segments` is how many segments there will be, 0 when that is unknown, `depth` how many branches
    /// are open at once.
    ///
    /// # Errors
    /// [`OverMemory`] where these would take too much.
    pub(super) fn new(
        program: &Program,
        settings: &TurtleSettings,
        segments: usize,
        depth: usize,
        monitor: &'a dyn Monitor,
    ) -> Result<Self, OverMemory> {
        let sets_widths = program.commands().any(|(command, _)| command == Command::Width);
        let radii = bytes_of::<f32>(if sets_widths { segments + 1 } else { 0 });
        let nodes = Branching::bytes_for(segments + 1) + bytes_of::<Edge>(segments + 1) + radii;
        monitor.admit(DOING, nodes + bytes_grown::<State>(depth.min(MAX_NESTING)), ADVICE)?;
        let branching = Branching {
            positions: Vec::with_capacity(segments + 1),
            parents: Vec::with_capacity(segments + 1),
            births: Vec::with_capacity(segments + 1),
            radii: sets_widths.then(|| Vec::with_capacity(segments + 1)),
            edges: Some(Vec::with_capacity(segments + 1)),
        };
        let numbers = program.commands().map(|(_, numbers)| numbers.first().copied().unwrap_or(1.0));
        Ok(Self {
            actions: program
                .commands()
                .map(|(command, numbers)| action(command, numbers, settings))
                .collect(),
            commands: program.commands().map(|(command, _)| command).collect(),
            names: program.modules.iter().map(|module| module.symbol).zip(numbers).collect(),
            settings: *settings,
            state: State::start(0, 0),
            stack: Vec::new(),
            branching,
            feet: vec![Foot { position: DVec3::ZERO, node: None }],
            shared_feet: 0,
            herbarium: Herbarium::default(),
            is_placing: false,
            chance: None,
            beside: 0,
            monitor,
        })
    }

    /// Puts the turtle where a stem begins: at the origin, rolled by one angle and then leaning by
    /// another. `key` is the root of the stem's variation.
    pub(super) fn start(&mut self, roll_deg: f64, lean_deg: f64, key: Key) {
        let foot = if self.branching.positions.is_empty() {
            0
        } else {
            self.feet.push(Foot { position: DVec3::ZERO, node: None });
            self.feet.len() as u32 - 1
        };
        // Organs below all wood hang on the stem's foot, which comes first.
        self.state = State::start(foot, self.branching.positions.len() as u32);
        self.stack.clear();
        self.shared_feet = foot as usize;
        self.chance = Chance::new(self.settings.variation, key);
        for (axis, degrees) in [(Axis::Roll, roll_deg), (Axis::Pitch, lean_deg)] {
            if degrees != 0.0 {
                self.state.frame.turn(axis, Turn::by_degrees(degrees));
            }
        }
    }

    /// Whether the string may end here.
    ///
    /// # Errors
    /// An open polygon, or a `~` with nothing behind it.
    pub(super) fn finish(&self) -> Result<(), LsystemError> {
        if self.is_placing {
            return Err(LsystemError::UnknownOrgan { found: None });
        }
        self.herbarium.check_closed()
    }

    /// Where it stands, metres.
    pub(super) fn stands_at(&self) -> Vec3 {
        self.state.position.as_vec3()
    }

    /// How many nodes, polygons and placed organs there are.
    pub(super) fn counts(&self) -> [usize; 3] {
        let [polygons, placed] = self.herbarium.counts();
        [self.branching.positions.len(), polygons, placed]
    }

    pub(super) fn into_parts(self) -> (Branching, Organs) {
        let mut organs = self.herbarium.into_organs();
        // Without wood above them, organs of one stem hang on another.
        let last = self.branching.positions.len().saturating_sub(1) as u32;
        for growth in [&mut organs.polygons.growth, &mut organs.placed.growth] {
            growth.nodes.iter_mut().for_each(|node| *node = (*node).min(last));
        }
        (self.branching, organs)
    }

    /// A node with an edge to its parent; `width` is that of the segment between them.
    #[expect(clippy::inline_always, reason = "a call would send the turtle's state through memory")]
    #[inline(always)]
    fn node(
        &mut self,
        position: Vec3,
        (parent, edge): (u32, Edge),
        width: f64,
        birth: u32,
    ) -> Result<u32, OverMemory> {
        if self.branching.positions.len() == self.branching.positions.capacity() {
            self.make_room_for_node()?;
        }
        self.branching.positions.push(position);
        self.branching.parents.push(parent);
        self.branching.births.push(birth);
        if let Some(edges) = &mut self.branching.edges {
            edges.push(edge);
        }
        if let Some(radii) = &mut self.branching.radii {
            let radius_m = 0.5 * width * self.settings.segment_width_m;
            radii.push(radius_m.clamp(RADII_M[0], RADII_M[1]) as f32);
        }
        Ok(self.branching.positions.len() as u32 - 1)
    }

    #[cold]
    fn make_room_for_node(&mut self) -> Result<(), OverMemory> {
        let others = self.bytes() - self.branching.bytes() + self.beside;
        self.branching.make_room(DOING, ADVICE, &Holding::new(self.monitor, others))
    }

    /// Whether the next module is neither in an outline nor the name of an organ, and nothing is left to chance
    /// or bent.
    fn is_plain(&self) -> bool {
        !self.is_placing
            && !self.herbarium.is_outlining()
            && self.chance.is_none()
            && self.settings.susceptibility == 0.0
    }

    /// Obeys modules as [`Self::obey`] does, as long as they only draw wood, turn, branch and change what is drawn.
    /// Gives how many these were; asks for a turtle that [is plain](Self::is_plain).
    fn go(&mut self, modules: &[u32], birth: u32) -> Result<usize, LsystemError> {
        // Apart, so that they stay in registers from module to module; a whole state would be copied to
        // memory and back by each bracket.
        let State { mut position, mut frame, mut anchor, mut is_adrift, mut node, .. } = self.state;
        let State { mut edge, mut color, mut width, .. } = self.state;
        let mut taken = 0;
        for &id in modules {
            match self.actions[id as usize] {
                Action::Nothing => {}
                Action::Turn(axis, turn) => frame.turn(axis, turn),
                Action::Draw { length_m, .. } => {
                    let Anchor::Node(start) = anchor else { break };
                    if is_adrift || length_m == 0.0 {
                        break;
                    }
                    position += frame.heading * length_m;
                    let place = position.as_vec3();
                    // What single precision cannot show is no segment.
                    if place != self.branching.positions[start as usize] {
                        node = self.node(place, (start, edge), width, birth)?;
                        anchor = Anchor::Node(node);
                        edge = Edge::Succeeds;
                    }
                }
                Action::Push if self.stack.len() < MAX_NESTING => {
                    self.stack.push(State { position, frame, anchor, is_adrift, node, edge, color, width });
                    edge = Edge::Branches;
                    self.shared_feet = self.feet.len();
                }
                Action::Pop => {
                    if let Some(state) = self.stack.pop() {
                        State { position, frame, anchor, is_adrift, node, edge, color, width } = state;
                    }
                }
                Action::TurnAround => frame.turn(Axis::Yaw, Turn::HALF),
                Action::Width(new) => width = new,
                Action::Thinner => width *= self.settings.width_ratio,
                Action::Color(new) => color = new,
                Action::NextColor => color = color.saturating_add(1),
                _ => break,
            }
            taken += 1;
        }
        self.state = State { position, frame, anchor, is_adrift, node, edge, color, width };
        Ok(taken)
    }

    fn draw(&mut self, length_m: f64, birth: u32) -> Result<(), OverMemory> {
        if length_m == 0.0 {
            return Ok(());
        }
        if self.state.is_adrift {
            self.land()?;
        }
        let start = match self.state.anchor {
            Anchor::Node(node) => node,
            Anchor::Foot(foot) => self.stand(foot as usize, birth)?,
        };
        let length_m = self.chance.as_mut().map_or(length_m, |chance| chance.length_m(length_m));
        self.state.position += self.state.frame.heading * length_m;
        // What single precision cannot show is no segment.
        let State { position, edge, width, .. } = self.state;
        let position = position.as_vec3();
        if position != self.branching.positions[start as usize] {
            let node = self.node(position, (start, edge), width, birth)?;
            self.state.anchor = Anchor::Node(node);
            self.state.node = node;
            self.state.edge = Edge::Succeeds;
        }
        if self.settings.susceptibility != 0.0 {
            self.state.frame.bend(DVec3::from(self.settings.tropism), self.settings.susceptibility);
        }
        Ok(())
    }

    /// The node of the foot that the turtle stands at.
    fn stand(&mut self, foot: usize, birth: u32) -> Result<u32, OverMemory> {
        if let Some(node) = self.feet[foot].node {
            return Ok(node);
        }
        let State { position, width, .. } = self.state;
        let node = self.node(position.as_vec3(), (NO_PARENT, Edge::Succeeds), width, birth)?;
        self.feet[foot].node = Some(node);
        Ok(node)
    }

    fn move_on(&mut self, length_m: f64) -> Result<(), OverMemory> {
        if length_m == 0.0 {
            return Ok(());
        }
        let length_m = self.chance.as_mut().map_or(length_m, |chance| chance.length_m(length_m));
        self.state.position += self.state.frame.heading * length_m;
        self.put_foot()
    }

    /// Makes the turtle's place one where a stem may start.
    fn put_foot(&mut self) -> Result<(), OverMemory> {
        self.state.is_adrift = false;
        // What stands there is a stem, in brackets or not.
        self.state.edge = Edge::Succeeds;
        let position = self.state.position;
        // A foot that no state on the stack knows, and that nothing stands on, moves along.
        if let Anchor::Foot(foot) = self.state.anchor
            && foot as usize >= self.shared_feet
            && self.feet[foot as usize].node.is_none()
        {
            self.feet[foot as usize].position = position;
            return Ok(());
        }
        if self.feet.len() == self.feet.capacity() {
            self.admit(bytes_of::<Foot>(2 * self.feet.capacity()))?;
        }
        self.state.anchor = Anchor::Foot(self.feet.len() as u32);
        self.feet.push(Foot { position, node: None });
        Ok(())
    }

    /// Asks for memory beside what there is.
    fn admit(&self, bytes: u64) -> Result<(), OverMemory> {
        self.monitor.admit(DOING, self.bytes() + self.beside + bytes, ADVICE)
    }

    /// Asks before the lists of organs move to larger places.
    fn make_room_for_organ(&self) -> Result<(), OverMemory> {
        if self.herbarium.is_full() { self.admit(2 * self.herbarium.bytes()) } else { Ok(()) }
    }

    /// Wood again, after an outline: an outline that closed leads back to where it began, any other one
    /// is a way without wood.
    fn land(&mut self) -> Result<(), OverMemory> {
        let anchor = match self.state.anchor {
            Anchor::Node(node) => self.branching.positions[node as usize].as_dvec3(),
            Anchor::Foot(foot) => self.feet[foot as usize].position,
        };
        // Nodes are rounded to single precision.
        let rounding = anchor.abs().max_element() * f64::from(f32::EPSILON);
        if self.state.position.distance(anchor) <= BACK * self.settings.segment_m + rounding {
            self.state.is_adrift = false;
            Ok(())
        } else {
            self.put_foot()
        }
    }

    /// Within a polygon: no wood.
    fn go_along_edge(&mut self, length_m: f64, is_edge: bool) -> Result<(), LsystemError> {
        let from = self.state.position;
        self.state.position += self.state.frame.heading * length_m;
        self.state.is_adrift = true;
        if is_edge { self.herbarium.edge(from, self.state.position) } else { Ok(()) }
    }

    fn push(&mut self) -> Result<(), LsystemError> {
        if self.stack.len() == MAX_NESTING {
            let derivations = self.settings.derivations;
            return Err(LsystemError::NestedTooDeeply { derivations, limit: MAX_NESTING });
        }
        self.stack.push(self.state);
        self.state.edge = Edge::Branches;
        self.shared_feet = self.feet.len();
        if let Some(chance) = &mut self.chance {
            let roll_deg = chance.push();
            if roll_deg != 0.0 && !self.herbarium.is_outlining() {
                self.state.frame.turn(Axis::Roll, Turn::by_degrees(roll_deg));
            }
        }
        Ok(())
    }

    fn pop(&mut self) {
        // Grammars are balanced: there always is a state.
        self.state = self.stack.pop().unwrap_or(self.state);
        if let Some(chance) = &mut self.chance {
            chance.pop();
        }
    }

    fn turn(&mut self, axis: Axis, turn: Turn) {
        let turn = match &mut self.chance {
            // Outlines keep their shape.
            Some(chance) if !self.herbarium.is_outlining() && self.settings.variation.angle_deg != 0.0 => {
                Turn::by_degrees(chance.angle_deg(turn.degrees))
            }
            _ => turn,
        };
        self.state.frame.turn(axis, turn);
    }

    fn obey(&mut self, action: Action, birth: u32) -> Result<(), LsystemError> {
        let is_outlining = self.herbarium.is_outlining();
        match action {
            Action::Nothing => {}
            Action::Draw { length_m, is_edge } if is_outlining => self.go_along_edge(length_m, is_edge)?,
            Action::Draw { length_m, .. } => self.draw(length_m, birth)?,
            Action::Move { length_m } if is_outlining => self.go_along_edge(length_m, true)?,
            Action::Move { length_m } => self.move_on(length_m)?,
            Action::Push => self.push()?,
            Action::Pop => self.pop(),
            Action::Turn(axis, turn) => self.turn(axis, turn),
            Action::TurnAround => self.state.frame.turn(Axis::Yaw, Turn::HALF),
            Action::Level => self.state.frame.level(),
            Action::Width(width) => self.state.width = width,
            Action::Thinner => self.state.width *= self.settings.width_ratio,
            Action::Color(color) => self.state.color = color,
            Action::NextColor => self.state.color = self.state.color.saturating_add(1),
            Action::PolygonBegin => {
                if self.herbarium.depth() == MAX_NESTING {
                    let derivations = self.settings.derivations;
                    return Err(LsystemError::NestedTooDeeply { derivations, limit: MAX_NESTING });
                }
                self.herbarium.begin(&self.state.frame, self.state.node, self.state.color);
            }
            Action::PolygonVertex => self.herbarium.corner(self.state.position)?,
            Action::PolygonEnd => {
                self.make_room_for_organ()?;
                self.herbarium.end(birth)?;
            }
            Action::Organ => self.is_placing = true,
        }
        Ok(())
    }

    /// What a `~` before this module asks for.
    fn place(&mut self, letter: char, size: f64, birth: u32) -> Result<(), LsystemError> {
        self.is_placing = false;
        let Some(prototype) = prototype(letter) else {
            return Err(LsystemError::UnknownOrgan { found: Some(letter) });
        };
        if !(0.0..=LARGEST_ORGAN).contains(&size) {
            return Err(LsystemError::OrganSize { letter, size, most: LARGEST_ORGAN });
        }
        let State { position, frame, node, color, .. } = self.state;
        let size_m = size * self.settings.segment_m;
        // What is too small for single precision is not there.
        if size_m as f32 > 0.0 {
            self.make_room_for_organ()?;
            self.herbarium.place(prototype, size_m, position, &frame, [node, color, birth]);
        }
        Ok(())
    }
}

impl State {
    /// Looking up.
    fn start(foot: u32, node: u32) -> Self {
        Self {
            position: DVec3::ZERO,
            frame: Frame::START,
            anchor: Anchor::Foot(foot),
            is_adrift: false,
            node,
            edge: Edge::Succeeds,
            color: 0,
            width: 1.0,
        }
    }
}

impl Sink for Turtle<'_> {
    fn take(&mut self, modules: &[u32], birth: u32) -> Result<(), LsystemError> {
        let mut rest = modules;
        while let [id, more @ ..] = rest {
            if self.is_plain() {
                let taken = self.go(rest, birth)?;
                if taken > 0 {
                    rest = &rest[taken..];
                    continue;
                }
            }
            if self.is_placing {
                let (letter, size) = self.names[*id as usize];
                self.place(letter, size, birth)?;
            } else {
                self.obey(self.actions[*id as usize], birth)?;
            }
            rest = more;
        }
        Ok(())
    }

    fn apply(&mut self, module: u32, arguments: &[f64], birth: u32) -> Result<(), LsystemError> {
        if self.is_placing {
            let (letter, _) = self.names[module as usize];
            return self.place(letter, arguments.first().copied().unwrap_or(1.0), birth);
        }
        self.obey(action(self.commands[module as usize], arguments, &self.settings), birth)
    }

    fn bytes(&self) -> u64 {
        let lists = bytes_of::<Foot>(self.feet.capacity()) + bytes_of::<State>(self.stack.capacity());
        lists + self.branching.bytes() + self.herbarium.bytes()
    }

    fn hold_beside(&mut self, bytes: u64) {
        self.beside = bytes;
    }
}

fn action(command: Command, arguments: &[f64], settings: &TurtleSettings) -> Action {
    // The first of several arguments is the turtle's (ABOP, section 1.10.1).
    let number = arguments.first().copied();
    let length_m = settings.segment_m * number.unwrap_or(1.0);
    let degrees = number.unwrap_or(settings.angle_deg);
    let turn = |positive| Turn::by_degrees(if positive { degrees } else { -degrees });
    match command {
        Command::Draw => Action::Draw { length_m, is_edge: true },
        Command::DrawUnrecorded => Action::Draw { length_m, is_edge: false },
        Command::Move => Action::Move { length_m },
        Command::Push => Action::Push,
        Command::Pop => Action::Pop,
        Command::Yaw(sense) => Action::Turn(Axis::Yaw, turn(sense == Sense::Left)),
        Command::Pitch(sense) => Action::Turn(Axis::Pitch, turn(sense == Sense::Down)),
        Command::Roll(sense) => Action::Turn(Axis::Roll, turn(sense == Sense::Left)),
        Command::TurnAround => Action::TurnAround,
        Command::Level => Action::Level,
        Command::Width => number.map_or(Action::Thinner, Action::Width),
        // Rounded; out of range is the first or the last.
        Command::Colour => number.map_or(Action::NextColor, |n| Action::Color(n.round() as u32)),
        Command::PolygonBegin => Action::PolygonBegin,
        Command::PolygonVertex => Action::PolygonVertex,
        Command::PolygonEnd => Action::PolygonEnd,
        Command::Organ => Action::Organ,
        // `%` has done its work by now.
        Command::Cut | Command::Silent => Action::Nothing,
    }
}
