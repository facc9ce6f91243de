//! The symbols that the turtle obeys.

/// What the turtle does at a module.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Command {
    Push,
    Pop,
    Segment,
    SegmentTo,
    Move,
    Radius,
    Sides,
    TurnLeft,
    TurnRight,
    PitchDown,
    PitchUp,
    RollLeft,
    RollRight,
    TurnAround,
    Level,
    Tropism,
    TropismTo,
    Leaf,
    Crossed,
    Blade,
    Needle,
}

impl Command {
    /// Whether it leaves a leaf behind.
    pub(crate) fn is_leaf(self) -> bool {
        matches!(
            self,
            Self::Leaf | Self::Crossed | Self::Blade | Self::Needle
        )
    }
}

/// Symbols, numbers of parameters, and what they mean, in the order of their
/// symbol numbers.
pub(crate) const COMMANDS: [(&str, usize, Command); 21] = [
    ("[", 0, Command::Push),
    ("]", 0, Command::Pop),
    ("F", 1, Command::Segment),
    ("F", 2, Command::SegmentTo),
    ("f", 1, Command::Move),
    ("!", 1, Command::Radius),
    ("sides", 1, Command::Sides),
    ("+", 1, Command::TurnLeft),
    ("-", 1, Command::TurnRight),
    ("&", 1, Command::PitchDown),
    ("^", 1, Command::PitchUp),
    ("\\", 1, Command::RollLeft),
    ("/", 1, Command::RollRight),
    ("|", 0, Command::TurnAround),
    ("$", 0, Command::Level),
    ("tropism", 1, Command::Tropism),
    ("tropism", 4, Command::TropismTo),
    ("leaf", 1, Command::Leaf),
    ("crossed", 1, Command::Crossed),
    ("blade", 2, Command::Blade),
    ("needle", 1, Command::Needle),
];

/// The symbol number of `[`.
pub(crate) const PUSH: u16 = 0;
/// The symbol number of `]`.
pub(crate) const POP: u16 = 1;

/// The command of a symbol number, if the turtle knows it.
pub(crate) fn command_of(symbol: u16) -> Option<Command> {
    COMMANDS.get(usize::from(symbol)).map(|known| known.2)
}
