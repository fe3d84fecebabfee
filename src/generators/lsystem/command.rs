//! What each symbol tells the turtle: one table for the parser and for the turtle.

/// A symbol's meaning (ABOP, appendix C).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Command {
    /// `F`: forward, drawing a segment; inside a polygon, its end is a vertex.
    Draw,
    /// `G`: forward, drawing a segment; inside a polygon, its end is no vertex.
    DrawUnrecorded,
    /// `f`: forward, drawing nothing.
    Move,
    /// `[`: a branch begins.
    Push,
    /// `]`: a branch ends.
    Pop,
    /// `+` left, `-` right, about U.
    Yaw(Sense),
    /// `&` down, `^` up, about L.
    Pitch(Sense),
    /// `\` left, `/` right, about H.
    Roll(Sense),
    /// `|`: half a turn about U.
    TurnAround,
    /// `$`: roll until L is horizontal.
    Level,
    /// `!`: thinner, or `!(w)`.
    Width,
    /// `'`: the next colour.
    Colour,
    /// `{`: a polygon begins.
    PolygonBegin,
    /// `.`: the turtle's place is a vertex of the polygon.
    PolygonVertex,
    /// `}`: the polygon is filled.
    PolygonEnd,
    /// `~`: the module that follows names an organ to be placed here.
    Organ,
    /// `%`: cut the rest of the branch.
    Cut,
    /// Any other letter or digit: rewritten, not drawn.
    Silent,
}

/// Which of two opposite rotations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Sense {
    Left,
    Right,
    Down,
    Up,
}

/// The largest length, angle or width that an argument may name. Together with the largest segment
/// and the most symbols it keeps every position far inside the range of `f32`.
const LARGEST: f64 = 1e6;

impl Command {
    /// The meaning of a symbol; `None` for what is no symbol at all.
    pub(super) fn of(symbol: char) -> Option<Self> {
        Some(match symbol {
            'F' => Self::Draw,
            'G' => Self::DrawUnrecorded,
            'f' => Self::Move,
            '[' => Self::Push,
            ']' => Self::Pop,
            '+' => Self::Yaw(Sense::Left),
            '-' => Self::Yaw(Sense::Right),
            '&' => Self::Pitch(Sense::Down),
            '^' => Self::Pitch(Sense::Up),
            '\\' => Self::Roll(Sense::Left),
            '/' => Self::Roll(Sense::Right),
            '|' => Self::TurnAround,
            '$' => Self::Level,
            '!' => Self::Width,
            '\'' => Self::Colour,
            '{' => Self::PolygonBegin,
            '.' => Self::PolygonVertex,
            '}' => Self::PolygonEnd,
            '~' => Self::Organ,
            '%' => Self::Cut,
            _ if symbol.is_alphanumeric() || symbol == '_' => Self::Silent,
            _ => return None,
        })
    }

    /// What the turtle does there, in words.
    pub(super) fn words(self) -> &'static str {
        match self {
            Self::Draw | Self::DrawUnrecorded => "draws a segment",
            Self::Move => "moves on without drawing",
            Self::Push => "begins a branch",
            Self::Pop => "ends a branch",
            Self::Yaw(Sense::Left) => "turns left",
            Self::Yaw(_) => "turns right",
            Self::Pitch(Sense::Down) => "pitches down",
            Self::Pitch(_) => "pitches up",
            Self::Roll(Sense::Left) => "rolls left",
            Self::Roll(_) => "rolls right",
            Self::TurnAround => "turns round",
            Self::Level => "rolls until left is level",
            Self::Width => "sets the width",
            Self::Colour => "sets the colour of organs",
            Self::PolygonBegin => "begins a polygon",
            Self::PolygonVertex => "sets a vertex",
            Self::PolygonEnd => "fills the polygon",
            Self::Organ => "places the organ that follows",
            Self::Cut => "cuts the rest of the branch",
            Self::Silent => "draws nothing",
        }
    }

    /// Whether it draws a segment, outside polygons.
    pub(super) fn draws(self) -> bool {
        matches!(self, Self::Draw | Self::DrawUnrecorded)
    }

    /// Whether numbers in brackets may follow. The first is the turtle's (ABOP, section 1.10.1).
    pub(super) fn takes_arguments(self) -> bool {
        self == Self::Silent || self.argument_range().is_some()
    }

    /// The range of the first number in brackets where it is drawn, both ends included; `None` when
    /// the turtle reads none.
    pub(super) fn argument_range(self) -> Option<[f64; 2]> {
        match self {
            // A segment may shrink to nothing: it is not drawn then.
            Self::Draw | Self::DrawUnrecorded | Self::Width | Self::Colour => Some([0.0, LARGEST]),
            Self::Move | Self::Yaw(_) | Self::Pitch(_) | Self::Roll(_) => Some([-LARGEST, LARGEST]),
            _ => None,
        }
    }
}

/// What the signs of rules begin, where they stand in their place.
pub(super) fn sign_of_rules(symbol: char) -> Option<&'static str> {
    Some(match symbol {
        '<' => "ends a left context, before the symbol to rewrite",
        '>' => "begins a right context, after the symbol to rewrite",
        ':' => "begins a condition, before the arrow",
        '#' => "begins a line of its own, '#define' or '#ignore'",
        _ => return None,
    })
}
