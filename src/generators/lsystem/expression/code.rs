//! Expressions made ready for evaluating, and evaluation.

use super::{Binary, Expression, Function, MAX_OPERANDS, Token, Unary};
use linden_base::random::Key;

/// One step of an evaluation on a stack.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in super::super) enum Instruction {
    Number(f64),
    Parameter(u16),
    /// Numbers and parameters as right operands, the commonest of all, without a way through the stack.
    WithNumber(Binary, f64),
    WithParameter(Binary, u16),
    Unary(Unary),
    Binary(Binary),
    Call(Function),
    /// `ran`, `nran`: which of the random numbers of its rule.
    Random(Function, u32),
}

/// How one value is computed; the commonest ways without a stack.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in super::super) enum Formula {
    Number(f64),
    Parameter(u16),
    /// A parameter times a number.
    Scaled(u16, f64),
    /// Instructions from one place to another.
    Code(u32, u32),
}

/// The formulas of a grammar.
#[derive(Debug, Default)]
pub(in super::super) struct Library {
    instructions: Vec<Instruction>,
}

/// The inputs of an evaluation.
#[derive(Clone, Copy)]
pub(in super::super) struct Inputs<'a> {
    pub parameters: &'a [f64],
    /// The place whose random numbers these are.
    pub key: Key,
}

impl Library {
    /// Adds an expression. Random numbers are counted on from `randoms`.
    pub(in super::super) fn add(&mut self, expression: &Expression, randoms: &mut u32) -> Formula {
        let start = self.instructions.len();
        for token in &expression.tokens {
            let instruction = match *token {
                Token::Number(number) | Token::Constant(number, _) => Instruction::Number(number),
                Token::Parameter(index, _) => Instruction::Parameter(index),
                Token::Unary(unary) => Instruction::Unary(unary),
                Token::Binary(binary) => Instruction::Binary(binary),
                Token::Call(function) if function.is_random() => {
                    *randoms += 1;
                    Instruction::Random(function, *randoms - 1)
                }
                Token::Call(function) => Instruction::Call(function),
            };
            self.push(instruction, start);
        }
        let formula = match self.instructions[start..] {
            [Instruction::Number(number)] => Formula::Number(number),
            [Instruction::Parameter(index)] => Formula::Parameter(index),
            [Instruction::Parameter(index), Instruction::WithNumber(Binary::Times, factor)]
            | [Instruction::Number(factor), Instruction::WithParameter(Binary::Times, index)] => {
                Formula::Scaled(index, factor)
            }
            _ => return Formula::Code(start as u32, self.instructions.len() as u32),
        };
        self.instructions.truncate(start);
        formula
    }

    /// Adds an instruction; what needs no parameters is computed here, once.
    fn push(&mut self, instruction: Instruction, start: usize) {
        let code = &mut self.instructions;
        let folded = match (instruction, &code[start..]) {
            (Instruction::Unary(unary), [.., Instruction::Number(a)]) => {
                Some((1, Instruction::Number(sign(unary, *a))))
            }
            (Instruction::Binary(binary), [.., Instruction::Number(a), Instruction::Number(b)]) => {
                Some((2, Instruction::Number(operate(binary, *a, *b))))
            }
            (Instruction::Binary(binary), [.., Instruction::Number(b)]) => {
                Some((1, Instruction::WithNumber(binary, *b)))
            }
            (Instruction::Binary(binary), [.., Instruction::Parameter(index)]) => {
                Some((1, Instruction::WithParameter(binary, *index)))
            }
            (Instruction::Call(function), [.., Instruction::Number(a)]) if function.arity() == 1 => {
                Some((1, Instruction::Number(call(function, *a, 0.0))))
            }
            (Instruction::Call(function), [.., Instruction::Number(a), Instruction::Number(b)]) => {
                Some((2, Instruction::Number(call(function, *a, *b))))
            }
            _ => None,
        };
        if let Some((operands, replacement)) = folded {
            code.truncate(code.len() - operands);
            code.push(replacement);
        } else {
            code.push(instruction);
        }
    }

    /// The instructions of a formula that has some.
    pub(in super::super) fn instructions(&self, formula: Formula) -> &[Instruction] {
        if let Formula::Code(start, end) = formula {
            &self.instructions[start as usize..end as usize]
        } else {
            &[]
        }
    }

    /// Whether a formula looks at chance.
    pub(in super::super) fn is_random(&self, formula: Formula) -> bool {
        self.instructions(formula).iter().any(|instruction| matches!(instruction, Instruction::Random(..)))
    }

    #[inline]
    pub(in super::super) fn evaluate(&self, formula: Formula, inputs: Inputs<'_>) -> f64 {
        match formula {
            Formula::Number(number) => number,
            Formula::Parameter(index) => inputs.parameters[index as usize],
            Formula::Scaled(index, factor) => inputs.parameters[index as usize] * factor,
            Formula::Code(start, end) => run(&self.instructions[start as usize..end as usize], inputs),
        }
    }
}

/// Rows that are evaluated together.
const LANES: usize = 32;

impl Library {
    /// Evaluates a formula without chance for each row of parameters, `width` to a row, into every `step`-th of the
    /// values.
    pub(in super::super) fn evaluate_rows(
        &self,
        formula: Formula,
        (rows, width): (&[f64], usize),
        (values, step): (&mut [f64], usize),
    ) {
        let code = self.instructions(formula);
        if is_straight(code) {
            let blocks = rows.chunks(LANES * width).zip(values.chunks_mut(LANES * step));
            blocks.for_each(|(rows, values)| {
                let lanes = run_straight(code, rows, width);
                values.iter_mut().step_by(step).zip(lanes).for_each(|(value, lane)| *value = lane);
            });
            return;
        }
        let key = Key::new(0);
        for (parameters, value) in rows.chunks_exact(width).zip(values.iter_mut().step_by(step)) {
            *value = self.evaluate(formula, Inputs { parameters, key });
        }
    }
}

/// Whether code works on one value from begin to end.
fn is_straight(code: &[Instruction]) -> bool {
    let goes_on = |instruction: &Instruction| {
        matches!(
            instruction,
            Instruction::WithNumber(..) | Instruction::WithParameter(..) | Instruction::Unary(_)
        )
    };
    matches!(code, [Instruction::Parameter(_), rest @ ..] if rest.iter().all(goes_on))
}

/// [Straight](is_straight) code for a few rows: what an instruction does is decided once for all of them.
fn run_straight(code: &[Instruction], rows: &[f64], width: usize) -> [f64; LANES] {
    let mut lanes = [0.0; LANES];
    let count = rows.len() / width;
    let lanes_used = &mut lanes[..count];
    let parameter = |index: u16| rows.chunks_exact(width).map(move |row| row[index as usize]);
    for instruction in code {
        match *instruction {
            Instruction::Parameter(index) => {
                lanes_used.iter_mut().zip(parameter(index)).for_each(|(lane, value)| *lane = value);
            }
            Instruction::WithNumber(binary, number) => {
                operate_on(lanes_used, binary, std::iter::repeat_n(number, count));
            }
            Instruction::WithParameter(binary, index) => operate_on(lanes_used, binary, parameter(index)),
            Instruction::Unary(unary) => lanes_used.iter_mut().for_each(|lane| *lane = sign(unary, *lane)),
            // Not straight.
            _ => {}
        }
    }
    lanes
}

/// Each lane with its right operand.
#[inline]
fn operate_on(lanes: &mut [f64], binary: Binary, right: impl Iterator<Item = f64>) {
    let pairs = lanes.iter_mut().zip(right);
    // The commonest have loops of their own.
    match binary {
        Binary::Plus => pairs.for_each(|(a, b)| *a += b),
        Binary::Minus => pairs.for_each(|(a, b)| *a -= b),
        Binary::Times => pairs.for_each(|(a, b)| *a *= b),
        Binary::Over => pairs.for_each(|(a, b)| *a /= b),
        _ => pairs.for_each(|(a, b)| *a = operate(binary, *a, b)),
    }
}

/// The value of an expression without parameters and chance.
pub(super) fn constant(expression: &Expression) -> f64 {
    let mut library = Library::default();
    let formula = library.add(expression, &mut 0);
    library.evaluate(formula, Inputs { parameters: &[], key: Key::new(0) })
}

fn run(code: &[Instruction], inputs: Inputs<'_>) -> f64 {
    /// Most expressions need no more: to clear the stack for the longest takes longer than they do.
    const FEW: usize = 8;
    if code.len() <= FEW { run_on::<FEW>(code, inputs) } else { run_on::<MAX_OPERANDS>(code, inputs) }
}

/// `MOST` is how many values may wait below the topmost one; an instruction adds one at most.
#[inline]
fn run_on<const MOST: usize>(code: &[Instruction], inputs: Inputs<'_>) -> f64 {
    let mut below = [0.0; MOST];
    let mut height = 0;
    // The topmost value is kept apart from those below it.
    let mut top = 0.0;
    for instruction in code {
        let mut push = |value| {
            below[height] = top;
            height += 1;
            value
        };
        match *instruction {
            Instruction::Number(number) => top = push(number),
            Instruction::Parameter(index) => top = push(inputs.parameters[index as usize]),
            Instruction::WithNumber(binary, number) => top = operate(binary, top, number),
            Instruction::WithParameter(binary, index) => {
                top = operate(binary, top, inputs.parameters[index as usize]);
            }
            Instruction::Unary(unary) => top = sign(unary, top),
            Instruction::Binary(binary) => {
                height -= 1;
                top = operate(binary, below[height], top);
            }
            Instruction::Call(function) if function.arity() == 1 => top = call(function, top, 0.0),
            Instruction::Call(function) => {
                height -= 1;
                top = call(function, below[height], top);
            }
            Instruction::Random(function, index) => {
                let key = inputs.key.child(index.into());
                if function == Function::Ran {
                    top *= key.unit();
                } else {
                    height -= 1;
                    top = below[height] + top * key.normal();
                }
            }
        }
    }
    top
}

fn truth(is: bool) -> f64 {
    f64::from(u8::from(is))
}

/// Whether a value counts as true: any number but 0 does. `None` for what is no number.
pub(in super::super) fn is_true(value: f64) -> Option<bool> {
    value.is_finite().then_some(value != 0.0)
}

/// 1 or 0, and no number where it is not known.
fn known(is: Option<bool>) -> f64 {
    is.map_or(f64::NAN, truth)
}

/// What a comparison gives; no number where one of both sides is none. Without a branch: only of a number is 0 times it 0.
#[inline]
fn compared(is: bool, a: f64, b: f64) -> f64 {
    truth(is) + 0.0 * a + 0.0 * b
}

fn sign(unary: Unary, a: f64) -> f64 {
    match unary {
        Unary::Minus => -a,
        Unary::Not => known(is_true(a).map(|is| !is)),
    }
}

#[inline]
fn operate(binary: Binary, a: f64, b: f64) -> f64 {
    match binary {
        // One side may decide: 'x != 0 && 1/x > 3' is false of 0.
        Binary::Or => known(match (is_true(a), is_true(b)) {
            (Some(true), _) | (_, Some(true)) => Some(true),
            (a, b) => a.and(b),
        }),
        Binary::And => known(match (is_true(a), is_true(b)) {
            (Some(false), _) | (_, Some(false)) => Some(false),
            (a, b) => a.and(b),
        }),
        Binary::Less => compared(a < b, a, b),
        Binary::LessOrEqual => compared(a <= b, a, b),
        Binary::Greater => compared(a > b, a, b),
        Binary::GreaterOrEqual => compared(a >= b, a, b),
        Binary::Equal => compared(a == b, a, b),
        Binary::Unequal => compared(a != b, a, b),
        Binary::Plus => a + b,
        Binary::Minus => a - b,
        Binary::Times => a * b,
        Binary::Over => a / b,
        Binary::Power => libm::pow(a, b),
    }
}

fn call(function: Function, a: f64, b: f64) -> f64 {
    match function {
        Function::Abs => a.abs(),
        Function::Floor => a.floor(),
        Function::Ceil => a.ceil(),
        Function::Sqrt => a.sqrt(),
        Function::Exp => libm::exp(a),
        Function::Log => libm::log(a),
        Function::Sin => sin_cos_deg(a).0,
        Function::Cos => sin_cos_deg(a).1,
        Function::Tan => {
            let (sin, cos) = sin_cos_deg(a);
            sin / cos
        }
        // A value that is no number stays one, so that the error names the module that got it.
        Function::Min | Function::Max if a.is_nan() || b.is_nan() => f64::NAN,
        Function::Min => {
            if b < a {
                b
            } else {
                a
            }
        }
        Function::Max => {
            if b > a {
                b
            } else {
                a
            }
        }
        Function::Pow => libm::pow(a, b),
        // Need a key: never called here.
        Function::Ran | Function::Nran => f64::NAN,
    }
}

/// Exact for quarter turns.
fn sin_cos_deg(degrees: f64) -> (f64, f64) {
    match degrees % 360.0 {
        0.0 => (0.0, 1.0),
        90.0 | -270.0 => (1.0, 0.0),
        180.0 | -180.0 => (0.0, -1.0),
        270.0 | -90.0 => (-1.0, 0.0),
        reduced => libm::sincos(reduced.to_radians()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_evaluated_as_each_alone() {
        use Instruction::{Binary as Two, Call, Number, Parameter, Unary as One};
        let codes: [&[Instruction]; 4] = [
            &[Parameter(0), Parameter(2), Two(Binary::Plus), Parameter(1), Two(Binary::Over)],
            &[
                Parameter(1),
                Number(3.0),
                Two(Binary::Power),
                One(Unary::Minus),
                Parameter(0),
                Two(Binary::Less),
            ],
            &[
                Parameter(0),
                Parameter(1),
                Two(Binary::Minus),
                Parameter(2),
                One(Unary::Minus),
                Two(Binary::Times),
            ],
            &[Parameter(2), Call(Function::Sqrt)],
        ];
        for (code, count) in
            codes.into_iter().flat_map(|code| [1, LANES, 2 * LANES + 5].map(|count| (code, count)))
        {
            let mut library = Library::default();
            for &instruction in code {
                library.push(instruction, 0);
            }
            let formula = Formula::Code(0, library.instructions.len() as u32);
            let rows: Vec<f64> = (0..3 * count).map(|i| f64::from(i as u32 % 31) - 7.5).collect();
            let mut values = vec![9.0; 2 * count];
            library.evaluate_rows(formula, (&rows, 3), (&mut values[1..], 2));
            for (row, pair) in rows.chunks_exact(3).zip(values.chunks_exact(2)) {
                let alone = library.evaluate(formula, Inputs { parameters: row, key: Key::new(0) });
                assert_eq!((pair[0], pair[1].to_bits()), (9.0, alone.to_bits()), "{code:?} of {row:?}");
            }
        }
    }
}
