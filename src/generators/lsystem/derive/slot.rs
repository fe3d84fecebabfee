//! A piece of the next string while it is written.

use super::{chance, compute};
use crate::error::LsystemError;
use crate::expression::code::Inputs;
use crate::program::{Program, Word};
use linden_base::random::Key;

/// A piece of a buffer that is being filled.
pub(super) struct Slot<'a> {
    pub modules: &'a mut [u32],
    pub births: &'a mut [u32],
    pub keys: &'a mut [Key],
    pub starts: &'a mut [u32],
    pub values: &'a mut [f64],
    /// Where its values stand in the buffer.
    pub offset: u32,
    pub next: usize,
    pub next_value: usize,
}

impl Slot<'_> {
    pub fn module(&mut self, id: u32, birth: u32, key: Key, computed: &[f64]) {
        let end = self.next_value + computed.len();
        let places = &mut self.values[self.next_value..end];
        places.iter_mut().zip(computed).for_each(|(place, value)| *place = *value);
        self.put(id, birth, key);
        self.next_value = end;
    }

    /// A module whose arguments, if they are computed, stand at `next_value`.
    fn put(&mut self, id: u32, birth: u32, key: Key) {
        let next = self.next;
        self.modules[next] = id;
        self.births[next] = birth;
        if let Some(slot) = self.keys.get_mut(next) {
            *slot = key;
        }
        if let Some(slot) = self.starts.get_mut(next) {
            *slot = self.offset + self.next_value as u32;
        }
        self.next += 1;
    }

    pub fn word(
        &mut self,
        program: &Program,
        word: Word,
        parameters: &[f64],
        place: Key,
        birth: u32,
    ) -> Result<(), LsystemError> {
        let inputs = Inputs { parameters, key: chance(program, place) };
        let (modules, ordinals) = (program.word(word), program.ordinals(word));
        let key = |i: usize| if program.random { place.child(ordinals[i].into()) } else { place };
        let mut done = 0;
        for &call in program.calls(word) {
            let at = call.at as usize;
            (done..at).for_each(|i| self.put(modules[i], birth, key(i)));
            let id = modules[at];
            self.put(id, birth, key(at));
            let end = self.next_value + program.formulas(call).len();
            compute(program, (id, call), inputs, &mut self.values[self.next_value..end], birth)
                .map_err(|error| error.by(program.production_of(word)))?;
            self.next_value = end;
            done = at + 1;
        }
        (done..modules.len()).for_each(|i| self.put(modules[i], birth, key(i)));
        Ok(())
    }

    /// The same word for one module after another, without chance. `rows` holds the parameters of each, `width`
    /// of them. Computes each argument for all modules before the next argument.
    pub fn words(
        &mut self,
        program: &Program,
        word: Word,
        rows: &[f64],
        width: usize,
        birth: u32,
    ) -> Result<(), LsystemError> {
        let place = Key::new(0);
        let step = word.values as usize;
        let end = self.next_value + rows.len() / width * step;
        let values = &mut self.values[self.next_value..end];
        let formulas = program.calls(word).iter().flat_map(|&call| program.formulas(call));
        for (column, &formula) in formulas.enumerate() {
            program.library.evaluate_rows(formula, (rows, width), (&mut values[column..], step));
        }
        if !values.iter().all(|value| value.is_finite()) {
            // Finds the first, and says what to say.
            return rows.chunks_exact(width).try_for_each(|row| self.word(program, word, row, place, birth));
        }
        let modules = program.word(word);
        let places = self.next..self.next + rows.len() / width * modules.len();
        for places in self.modules[places.clone()].chunks_exact_mut(modules.len()) {
            places.iter_mut().zip(modules).for_each(|(place, module)| *place = *module);
        }
        self.births[places.clone()].fill(birth);
        let starts = starts_in(program, word);
        let mut first = self.offset + self.next_value as u32;
        for places in self.starts[places.clone()].chunks_exact_mut(modules.len()) {
            places.iter_mut().zip(&starts).for_each(|(place, start)| *place = first + start);
            first += word.values;
        }
        (self.next, self.next_value) = (places.end, end);
        Ok(())
    }
}

/// Where the arguments of each module of a word stand among those of the word, if they are computed.
fn starts_in(program: &Program, word: Word) -> Vec<u32> {
    let mut calls = program.calls(word).iter().peekable();
    let mut start = 0;
    let of_module = |at| {
        let values = calls.next_if(|call| call.at == at).map_or(0, |call| program.formulas(*call).len());
        start += values as u32;
        start - values as u32
    };
    (0..word.len() as u32).map(of_module).collect()
}
