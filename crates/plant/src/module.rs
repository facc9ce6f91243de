//! Modules: the letters of an L-system, with their numbers.

/// The letter of a module. Those named here are drawn by the turtle; all others
/// only stand for what a production makes of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Symbol(char);

impl Symbol {
    /// `F(length_m, end_radius_m)`: advance and draw a segment of wood that
    /// tapers from the turtle's radius to this one, which it keeps.
    pub const SEGMENT: Self = Self('F');
    /// `f(length_m)`: advance without drawing.
    pub const MOVE: Self = Self('f');
    /// `!(radius_m)`: sets the radius of the wood.
    pub const RADIUS: Self = Self('!');
    /// `#(sides)`: sets how many sides the wood has, 3 to 64.
    pub const SIDES: Self = Self('#');
    /// `+(degrees)`: turn left, about the turtle's up.
    pub const TURN: Self = Self('+');
    /// `&(degrees)`: pitch down, about the turtle's left.
    pub const PITCH: Self = Self('&');
    /// `/(degrees)`: roll right, about the turtle's heading.
    pub const ROLL: Self = Self('/');
    /// `$`: roll until the turtle's left is level and its up points skyward.
    pub const LEVEL: Self = Self('$');
    /// `^(strength)`: from here on every advance bends the heading towards the
    /// sky (or, negative, the ground) by so many radians where it is level.
    pub const TROPISM: Self = Self('^');
    /// `[`: remember where the turtle is.
    pub const PUSH: Self = Self('[');
    /// `]`: go back to where the turtle was at the matching `[`.
    pub const POP: Self = Self(']');
    /// `~(length_m)`: a leaf along the heading, its face towards the turtle's up.
    pub const LEAF: Self = Self('~');

    /// The symbol written as this letter.
    pub const fn new(letter: char) -> Self {
        Self(letter)
    }
}

impl std::fmt::Display for Symbol {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}", self.0)
    }
}

/// A symbol with up to [`Module::MAX_PARAMETERS`] real parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Module {
    parameters: [f64; Self::MAX_PARAMETERS],
    symbol: Symbol,
    parameter_count: u8,
}

impl Module {
    /// The most parameters a module can have.
    pub const MAX_PARAMETERS: usize = 4;

    /// A module.
    ///
    /// # Panics
    /// If there are more than [`Module::MAX_PARAMETERS`] parameters.
    pub fn new(symbol: Symbol, parameters: &[f64]) -> Self {
        assert!(
            parameters.len() <= Self::MAX_PARAMETERS,
            "{symbol} has {} parameters, a module at most {}",
            parameters.len(),
            Self::MAX_PARAMETERS
        );
        let mut padded = [0.0; Self::MAX_PARAMETERS];
        padded[..parameters.len()].copy_from_slice(parameters);
        Self {
            parameters: padded,
            symbol,
            parameter_count: parameters.len() as u8,
        }
    }

    /// Its symbol.
    pub fn symbol(&self) -> Symbol {
        self.symbol
    }

    /// Its parameters.
    pub fn parameters(&self) -> &[f64] {
        &self.parameters[..usize::from(self.parameter_count)]
    }
}
