//! Breadth first, from one buffer into another.
//!
//! A step looks at every module, chooses what becomes of it and counts what that gives; the sums over
//! chunks say where each chunk writes; then all chunks are written. Chunks are cut by the string's
//! length alone, and everything but the search for neighbours and cuts runs in parallel, so that any
//! number of threads gives the same bits. The last step writes nothing and hands its modules on.

use rayon::prelude::*;

use super::{Outlet, Sink, chance, compute, root};
use crate::context::{Modules, Neighbours, rest_of_branch};
use crate::error::LsystemError;
use crate::expression::code::Inputs;
use crate::program::{Entry, Group, Program};
use crate::turtle_settings::TurtleSettings;
use linden_base::monitor::{Monitor, Phase, Quiet};
use linden_base::random::Key;

/// Modules that are looked at in one go: some ten microseconds.
const CHUNK: usize = 1 << 12;
/// A choice that is none: the module stays.
const KEEP: u32 = u32::MAX;
/// The module is cut.
pub(super) const DROP: u32 = u32::MAX - 1;
/// A string in memory.
#[derive(Default)]
pub(super) struct Buffer {
    pub modules: Vec<u32>,
    pub births: Vec<u32>,
    /// Empty when nothing is left to chance.
    keys: Vec<Key>,
    /// Where the arguments of a module stand in `values`, when they are computed.
    starts: Vec<u32>,
    values: Vec<f64>,
}

/// A buffer with the meaning of its modules.
pub(super) struct Text<'a> {
    pub program: &'a Program,
    pub buffer: &'a Buffer,
}

impl Modules for Text<'_> {
    #[inline]
    fn id(&self, index: usize) -> u32 {
        self.buffer.modules[index]
    }

    #[inline]
    fn entry(&self, index: usize) -> &Entry {
        &self.program.modules[self.buffer.modules[index] as usize]
    }

    #[inline]
    fn arguments(&self, index: usize) -> &[f64] {
        let entry = self.entry(index);
        if !entry.is_computed() {
            return &entry.constants;
        }
        let start = self.buffer.starts[index] as usize;
        &self.buffer.values[start..start + entry.arity as usize]
    }

    fn count(&self) -> usize {
        self.buffer.modules.len()
    }
}

/// How much a chunk, or a string, becomes.
#[derive(Clone, Copy, Default)]
struct Size {
    modules: u64,
    values: u64,
}

impl Size {
    fn sum(sizes: &[Self]) -> Self {
        let mut sum = Self::default();
        for &size in sizes {
            sum += size;
        }
        sum
    }

    /// What a string of this size takes, and what a step over it takes beside.
    fn bytes(self, program: &Program) -> u64 {
        let chance = if program.random { size_of::<Key>() as u64 } else { 0 };
        let computed = if self.values > 0 { size_of::<u32>() as u64 } else { 0 };
        let bound = program.groups.iter().filter(|group| group.has_context()).map(|group| group.parameters);
        let bound = (bound.max().unwrap_or(0) * size_of::<f64>()) as u64;
        // What it is, when it was written, what becomes of it.
        let module =
            3 * size_of::<u32>() as u64 + chance + computed + bound + Neighbours::bytes_a_module(program);
        self.modules
            .saturating_mul(module)
            .saturating_add(self.values.saturating_mul(size_of::<f64>() as u64))
    }
}

impl std::ops::AddAssign for Size {
    fn add_assign(&mut self, other: Self) {
        self.modules += other.modules;
        self.values += other.values;
    }
}

/// One derivation step over a string.
pub(super) struct Step<'a> {
    text: Text<'a>,
    neighbours: &'a Neighbours,
    /// What becomes of each module: an alternative, [`KEEP`] or [`DROP`].
    pub choices: Vec<u32>,
    /// By chunk, one after another: the parameters of all groups with contexts that were chosen, as long as nothing
    /// is cut.
    bound: Vec<Vec<f64>>,
    number: u32,
}

/// Modules that are looked at in a trial: about half a millisecond.
const TRIAL: usize = 8000;
/// What a step costs besides, in modules.
const TRIAL_STEP: usize = 30;

/// A string that was derived as far as its work was allowed to go.
pub(crate) struct Trial {
    pub modules: Vec<u32>,
    /// Whether it went to the end.
    pub is_complete: bool,
}

/// Derives from the seed 0 for as long as that takes no time to speak of.
pub(crate) fn count(program: &Program, derivations: u32) -> Trial {
    let settings = TurtleSettings::default();
    let mut neighbours = Neighbours::default();
    let mut work = 0;
    let mut step = 0;
    let mut string = axiom(program, &settings).ok();
    while let Some(buffer) = &string
        && step < derivations
        && work < TRIAL
    {
        work += TRIAL_STEP + buffer.modules.len();
        step += 1;
        let next = Step::choose(program, buffer, &mut neighbours, step, &Quiet).and_then(|step| {
            let sizes = step.sizes();
            let count = sizes.iter().map(|size| size.modules as usize).sum::<usize>();
            // One word may hold a million modules.
            if work + count > 2 * TRIAL { Ok(None) } else { step.write(&sizes).map(Some) }
        });
        match next {
            Ok(Some(next)) => string = Some(next),
            _ => {
                step -= 1;
                work = TRIAL;
            }
        }
    }
    let modules = string.map(|buffer| buffer.modules).unwrap_or_default();
    Trial { modules, is_complete: step == derivations }
}

pub(super) fn derive<S: Sink>(outlet: &mut Outlet<'_, S>) -> Result<(), LsystemError> {
    let program = outlet.program;
    let settings = outlet.settings;
    let mut scratch = Vec::new();
    let last = settings.derivations;
    if last == 0 {
        return outlet.word(program.axiom, &[], root(settings), 0, &mut scratch);
    }
    let mut string = axiom(program, settings)?;
    let mut neighbours = Neighbours::default();
    for number in 1..last {
        outlet.monitor.check()?;
        let step = Step::choose(program, &string, &mut neighbours, number, outlet.monitor)?;
        let next = step.apply(outlet)?;
        string = next;
        outlet.monitor.advance(Phase::Derive, string.modules.len() as u64, None);
    }
    outlet.sink.hold_beside(string.size().bytes(program));
    let step = Step::choose(program, &string, &mut neighbours, last, outlet.monitor)?;
    step.hand_on(outlet)
}

/// The axiom in a buffer.
pub(super) fn axiom(program: &Program, settings: &TurtleSettings) -> Result<Buffer, LsystemError> {
    let word = program.axiom;
    let mut buffer = Buffer::default();
    let size = Size { modules: word.len() as u64, values: word.values.into() };
    buffer.resize(size, program.random);
    let mut slot = buffer.slots(&[size], program.random).pop();
    if let Some(slot) = &mut slot {
        slot.word(program, word, &[], root(settings), 0)?;
    }
    Ok(buffer)
}

impl<'a> Step<'a> {
    /// Chooses what becomes of every module.
    pub(super) fn choose(
        program: &'a Program,
        buffer: &'a Buffer,
        neighbours: &'a mut Neighbours,
        number: u32,
        monitor: &dyn Monitor,
    ) -> Result<Self, LsystemError> {
        let text = Text { program, buffer };
        neighbours.find(program, &text);
        let mut choices = vec![KEEP; text.count()];
        let step = Self { text, neighbours, choices: Vec::new(), bound: Vec::new(), number };
        let outcomes: Vec<Result<(bool, Vec<f64>), LsystemError>> = choices
            .par_chunks_mut(CHUNK)
            .enumerate()
            .map(|(i, chunk)| step.choose_chunk(i * CHUNK, chunk, monitor))
            .collect();
        let mut cuts = false;
        let mut bound = Vec::with_capacity(outcomes.len());
        for outcome in outcomes {
            let (cuts_some, parameters) = outcome?;
            cuts |= cuts_some;
            bound.push(parameters);
        }
        let mut step = Self { choices, bound, ..step };
        if cuts {
            step.cut();
            step.bound.clear();
        }
        Ok(step)
    }

    /// Chooses for some modules from `first` on. Whether some of what was chosen cuts what follows, and the
    /// parameters of chosen groups with contexts.
    fn choose_chunk(
        &self,
        first: usize,
        choices: &mut [u32],
        monitor: &dyn Monitor,
    ) -> Result<(bool, Vec<f64>), LsystemError> {
        monitor.check()?;
        let program = self.text.program;
        let mut parameters = Vec::new();
        let mut bound = Vec::new();
        let mut cuts = false;
        let mut work = 0;
        for (i, choice) in choices.iter_mut().enumerate() {
            let index = first + i;
            if let Some(group) = self.matching(index, &mut parameters, &mut work) {
                let chosen = program.choose(group, self.key(index));
                cuts |= program.alternatives[chosen].word.cuts;
                *choice = chosen as u32;
                if group.has_context() {
                    bound.extend(parameters.iter().copied());
                }
            }
            if work >= super::PATIENCE {
                work = 0;
                monitor.check()?;
            }
        }
        Ok((cuts, bound))
    }

    fn key(&self, index: usize) -> Key {
        // Without choices the keys are not used.
        self.text.buffer.keys.get(index).copied().unwrap_or(Key::new(0))
    }

    /// The first group that takes a module; its parameters are then in `parameters`.
    fn matching(&self, index: usize, parameters: &mut Vec<f64>, work: &mut u64) -> Option<&'a Group> {
        let program = self.text.program;
        let rewrite = program.rewrite(self.text.buffer.modules[index])?;
        program.groups(rewrite).iter().find(|group| {
            *work += 1 + u64::from(group.cost);
            self.bind(group, index, parameters, work)
                && program.holds(group, parameters, self.key(index), self.number)
        })
    }

    /// Fills in the parameters of a group, if its contexts are there.
    fn bind(&self, group: &Group, index: usize, parameters: &mut Vec<f64>, work: &mut u64) -> bool {
        if group.has_context() {
            return self.neighbours.surround(group, &self.text, index, parameters, work);
        }
        parameters.clear();
        parameters.extend_from_slice(self.text.arguments(index));
        true
    }

    /// The parameters of the group that was chosen for a module; `bound` is what is left of its chunk's.
    fn parameters_of<'s: 'o, 'o>(
        &'s self,
        group: &Group,
        index: usize,
        bound: &mut &'s [f64],
        own: &'o mut Vec<f64>,
    ) -> &'o [f64] {
        if !group.has_context() {
            return self.text.arguments(index);
        }
        if let Some((parameters, rest)) = bound.split_at_checked(group.parameters) {
            *bound = rest;
            return parameters;
        }
        self.bind(group, index, own, &mut 0);
        own
    }

    /// The parameters that were bound in a chunk; none where something is cut.
    fn bound(&self, chunk: usize) -> &[f64] {
        self.bound.get(chunk).map_or(&[], |bound| bound)
    }

    /// Drops what follows a chosen word that cuts, up to the end of the branch.
    fn cut(&mut self) {
        let program = self.text.program;
        let mut i = 0;
        while i < self.choices.len() {
            let chosen = program.alternatives.get(self.choices[i] as usize);
            i += 1;
            if chosen.is_some_and(|alternative| alternative.word.cuts) {
                let rest = rest_of_branch(&self.text, i);
                self.choices[i..i + rest].fill(DROP);
                i += rest;
            }
        }
    }

    /// Writes the next string, within the limits.
    pub(super) fn apply<S: Sink>(&self, outlet: &Outlet<'_, S>) -> Result<Buffer, LsystemError> {
        let sizes = self.sizes();
        let size = Size::sum(&sizes);
        outlet.check_limit(size.modules)?;
        if size.values > u32::MAX.into() {
            // Places of arguments have 32 bits.
            outlet.check_limit(u64::MAX)?;
        }
        let Text { program, buffer } = self.text;
        let bytes = buffer.size().bytes(program).saturating_add(size.bytes(program));
        let bytes = bytes.saturating_add(outlet.sink.bytes());
        outlet.monitor.admit("deriving the L-system", bytes, "use fewer derivations")?;
        self.write(&sizes)
    }

    /// What each chunk becomes.
    fn sizes(&self) -> Vec<Size> {
        let program = self.text.program;
        let of_chunk = |(chunk, choices): (usize, &[u32])| {
            let mut sum = Size::default();
            for (i, &choice) in choices.iter().enumerate() {
                sum += match choice {
                    DROP => Size::default(),
                    KEEP => {
                        let entry = self.text.entry(chunk * CHUNK + i);
                        Size { modules: 1, values: if entry.is_computed() { entry.arity.into() } else { 0 } }
                    }
                    chosen => {
                        let word = program.alternatives[chosen as usize].word;
                        Size { modules: word.len() as u64, values: word.values.into() }
                    }
                };
            }
            sum
        };
        self.choices.par_chunks(CHUNK).enumerate().map(of_chunk).collect()
    }

    /// Writes the next string.
    fn write(&self, sizes: &[Size]) -> Result<Buffer, LsystemError> {
        let random = self.text.program.random;
        let sum = Size::sum(sizes);
        let mut next = Buffer::default();
        next.resize(sum, random);
        let outcomes: Vec<Result<(), LsystemError>> = next
            .slots(sizes, random)
            .into_par_iter()
            .enumerate()
            .map(|(i, slot)| self.write_chunk(i * CHUNK, slot))
            .collect();
        outcomes.into_iter().collect::<Result<(), _>>()?;
        Ok(next)
    }

    fn write_chunk(&self, first: usize, mut slot: Slot<'_>) -> Result<(), LsystemError> {
        let program = self.text.program;
        let mut own = Vec::new();
        let mut bound = self.bound(first / CHUNK);
        let end = self.choices.len().min(first + CHUNK);
        for index in first..end {
            match self.choices[index] {
                DROP => {}
                KEEP => {
                    let arguments =
                        if self.text.entry(index).is_computed() { self.text.arguments(index) } else { &[] };
                    let Buffer { modules, births, .. } = self.text.buffer;
                    slot.module(modules[index], births[index], self.key(index), arguments);
                }
                chosen => {
                    let alternative = &program.alternatives[chosen as usize];
                    let group = &program.groups[alternative.group as usize];
                    let parameters = self.parameters_of(group, index, &mut bound, &mut own);
                    slot.word(program, alternative.word, parameters, self.key(index), self.number)?;
                }
            }
        }
        Ok(())
    }

    /// Hands the modules of the next string on without writing it.
    fn hand_on<S: Sink>(&self, outlet: &mut Outlet<'_, S>) -> Result<(), LsystemError> {
        let program = self.text.program;
        let Buffer { modules, births, .. } = self.text.buffer;
        let mut own = Vec::new();
        let mut bound = self.bound(0);
        let mut scratch = Vec::new();
        let (mut index, mut chunk) = (0, 0);
        while index < modules.len() {
            if index / CHUNK > chunk {
                chunk = index / CHUNK;
                bound = self.bound(chunk);
            }
            let id = modules[index];
            let birth = births[index];
            match self.choices[index] {
                DROP => outlet.spend(1)?,
                KEEP if self.text.entry(index).is_computed() => {
                    outlet.apply(id, self.text.arguments(index), birth)?;
                }
                KEEP => {
                    // With all that follow it, of the same age, and are handed on as they are.
                    let same = |i: &usize| {
                        self.choices[*i] == KEEP && births[*i] == birth && !self.text.entry(*i).is_computed()
                    };
                    let run = (index + 1..modules.len()).take_while(same).count();
                    outlet.give(&modules[index..=index + run], birth)?;
                    index += run;
                }
                chosen => {
                    let alternative = &program.alternatives[chosen as usize];
                    let group = &program.groups[alternative.group as usize];
                    let parameters = self.parameters_of(group, index, &mut bound, &mut own);
                    outlet.word(alternative.word, parameters, self.key(index), self.number, &mut scratch)?;
                }
            }
            index += 1;
        }
        Ok(())
    }
}

impl Buffer {
    fn size(&self) -> Size {
        Size { modules: self.modules.len() as u64, values: self.values.len() as u64 }
    }

    fn resize(&mut self, size: Size, random: bool) {
        let modules = size.modules as usize;
        self.modules.resize(modules, 0);
        self.births.resize(modules, 0);
        self.keys.resize(if random { modules } else { 0 }, Key::new(0));
        // Nobody looks for values where there are none.
        self.starts.resize(if size.values > 0 { modules } else { 0 }, 0);
        self.values.resize(size.values as usize, 0.0);
    }

    /// Cuts the buffer into pieces of the given sizes, to be filled one beside the other.
    fn slots(&mut self, sizes: &[Size], random: bool) -> Vec<Slot<'_>> {
        let mut slots = Vec::with_capacity(sizes.len());
        let (mut modules, mut births) = (&mut self.modules[..], &mut self.births[..]);
        let (mut keys, mut starts) = (&mut self.keys[..], &mut self.starts[..]);
        let mut values = &mut self.values[..];
        let has_values = !values.is_empty();
        let mut offset = 0;
        for size in sizes {
            let count = size.modules as usize;
            slots.push(Slot {
                modules: modules.split_off_mut(..count).unwrap_or_default(),
                births: births.split_off_mut(..count).unwrap_or_default(),
                keys: keys.split_off_mut(..if random { count } else { 0 }).unwrap_or_default(),
                starts: starts.split_off_mut(..if has_values { count } else { 0 }).unwrap_or_default(),
                values: values.split_off_mut(..size.values as usize).unwrap_or_default(),
                offset,
                next: 0,
                next_value: 0,
            });
            offset += size.values as u32;
        }
        slots
    }
}

/// A piece of a buffer that is being filled.
struct Slot<'a> {
    modules: &'a mut [u32],
    births: &'a mut [u32],
    keys: &'a mut [Key],
    starts: &'a mut [u32],
    values: &'a mut [f64],
    /// Where its values stand in the buffer.
    offset: u32,
    next: usize,
    next_value: usize,
}

impl Slot<'_> {
    fn module(&mut self, id: u32, birth: u32, key: Key, computed: &[f64]) {
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

    fn word(
        &mut self,
        program: &Program,
        word: crate::program::Word,
        parameters: &[f64],
        place: Key,
        birth: u32,
    ) -> Result<(), LsystemError> {
        let inputs = Inputs { parameters, key: chance(program, place) };
        let ordinals = program.ordinals(word);
        let mut calls = program.calls(word).iter().peekable();
        for (i, &id) in program.word(word).iter().enumerate() {
            let key = if program.random { place.child(ordinals[i].into()) } else { place };
            self.put(id, birth, key);
            if let Some(&call) = calls.next_if(|call| call.at as usize == i) {
                let end = self.next_value + program.modules[id as usize].arity as usize;
                compute(program, (id, call), inputs, &mut self.values[self.next_value..end], birth)?;
                self.next_value = end;
            }
        }
        Ok(())
    }
}
