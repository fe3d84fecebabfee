//! Breadth first, from one buffer into another.
//!
//! A step looks at every module, chooses what becomes of it and counts what that gives; the sums over
//! chunks say where each chunk writes; then all chunks are written. Chunks are cut by the string's
//! length alone, and everything but the search for neighbours and cuts runs in parallel, so that any
//! number of threads gives the same bits. The last step writes nothing and hands its modules on.

use rayon::prelude::*;

use super::slot::Slot;
use super::{Outlet, Sink, bad_condition, root};
use crate::context::{Modules, Neighbours, fit, rest_of_branch};
use crate::error::LsystemError;
use crate::program::{Entry, Group, Program, Word};
use crate::turtle_settings::TurtleSettings;
use linden_base::monitor::{Monitor, Phase, Quiet};
use linden_base::random::Key;

/// Modules that are looked at in one go: some ten microseconds.
const CHUNK: usize = 1 << 12;
/// Neighbours that become the same word are written together from here on.
const MANY: usize = 8;
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
    fn of(word: Word) -> Self {
        Self { modules: word.len() as u64, values: word.values.into() }
    }

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
        let bound = (most_bound(program) * size_of::<f64>()) as u64;
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

/// The most parameters of a group with contexts.
fn most_bound(program: &Program) -> usize {
    let with_context = program.groups.iter().filter(|group| group.has_context());
    with_context.map(|group| group.parameters).max().unwrap_or(0)
}

/// Lists that one step after another fills.
#[derive(Default)]
pub(super) struct Lists {
    neighbours: Neighbours,
    choices: Vec<u32>,
    bound: Vec<Vec<f64>>,
    /// A string that is not needed any more; the next one takes its place.
    pub spare: Buffer,
}

/// One derivation step over a string.
pub(super) struct Step<'a> {
    view: View<'a>,
    /// What becomes of each module: an alternative, [`KEEP`] or [`DROP`].
    pub choices: &'a mut [u32],
    /// By chunk, one after another: the parameters of all groups with contexts that were chosen, as long as nothing
    /// is cut.
    bound: &'a [Vec<f64>],
    /// What each chunk becomes.
    sizes: Vec<Size>,
    spare: &'a mut Buffer,
}

/// What rules look at in a step.
struct View<'a> {
    text: Text<'a>,
    neighbours: &'a Neighbours,
    /// The most parameters of a group with contexts.
    most_bound: usize,
    number: u32,
}

/// What was chosen for a chunk.
#[derive(Clone, Copy)]
struct Chosen {
    size: Size,
    /// Whether something cuts what follows.
    cuts: bool,
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
    let mut lists = Lists::default();
    let mut work = 0;
    let mut step = 0;
    let mut string = axiom(program, &settings).ok();
    while let Some(buffer) = &string
        && step < derivations
        && work < TRIAL
    {
        work += TRIAL_STEP + buffer.modules.len();
        step += 1;
        let next = Step::choose(program, buffer, &mut lists, step, &Quiet).and_then(|step| {
            let count = Size::sum(&step.sizes).modules as usize;
            // One word may hold a million modules.
            if work + count > 2 * TRIAL { Ok(None) } else { step.write().map(Some) }
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
    let mut lists = Lists::default();
    for number in 1..last {
        outlet.within_limit = Some(number - 1);
        outlet.monitor.check()?;
        let step = Step::choose(program, &string, &mut lists, number, outlet.monitor)?;
        let next = step.apply(outlet)?;
        lists.spare = std::mem::replace(&mut string, next);
        outlet.monitor.advance(Phase::Derive, string.modules.len() as u64, None);
    }
    outlet.within_limit = Some(last - 1);
    lists.spare = Buffer::default();
    outlet.sink.hold_beside(string.size().bytes(program));
    let step = Step::choose(program, &string, &mut lists, last, outlet.monitor)?;
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

impl<'a> View<'a> {
    /// Chooses for some modules from `first` on. The parameters of chosen groups with contexts are then in
    /// `bound`, one after another.
    fn choose(
        &self,
        first: usize,
        choices: &mut [u32],
        bound: &mut Vec<f64>,
        monitor: &dyn Monitor,
    ) -> Result<Chosen, LsystemError> {
        monitor.check()?;
        let program = self.text.program;
        fit(bound, choices.len() * self.most_bound, 0.0);
        let mut at = 0;
        let mut chosen = Chosen { size: Size::default(), cuts: false };
        let mut work = 0;
        for (index, choice) in (first..).zip(choices) {
            let matching = self.matching(index, &mut bound[at..], &mut work).map_err(|group| {
                let module = (self.text.id(index), self.text.arguments(index));
                bad_condition(program, group, module, self.number)
            })?;
            *choice = match matching {
                None => {
                    chosen.size += self.size_of_kept(index);
                    KEEP
                }
                Some(group) => {
                    let alternative = program.choose(group, self.key(index));
                    let word = program.alternatives[alternative].word;
                    chosen.size += Size::of(word);
                    chosen.cuts |= word.cuts;
                    if group.has_context() {
                        at += group.parameters;
                    }
                    alternative as u32
                }
            };
            if work >= super::PATIENCE {
                work = 0;
                monitor.check()?;
            }
        }
        Ok(chosen)
    }

    fn size_of_kept(&self, index: usize) -> Size {
        let entry = self.text.entry(index);
        Size { modules: 1, values: if entry.is_computed() { entry.arity.into() } else { 0 } }
    }

    fn key(&self, index: usize) -> Key {
        // Without choices the keys are not used.
        self.text.buffer.keys.get(index).copied().unwrap_or(Key::new(0))
    }

    /// The first group that takes a module. If it has contexts, its parameters are then at the begin of `bound`.
    ///
    /// # Errors
    /// The group whose condition comes to no number.
    #[inline]
    fn matching(
        &self,
        index: usize,
        bound: &mut [f64],
        work: &mut u64,
    ) -> Result<Option<&'a Group>, &'a Group> {
        let program = self.text.program;
        let Some(rewrite) = program.rewrite(self.text.buffer.modules[index]) else { return Ok(None) };
        for group in program.groups(rewrite) {
            *work += 1 + u64::from(group.cost);
            let holds = if group.has_context() {
                let parameters = &mut bound[..group.parameters];
                if !self.neighbours.surround(group, &self.text, index, parameters, work) {
                    continue;
                }
                program.holds(group, parameters, self.key(index), self.number)
            } else {
                program.holds(group, self.text.arguments(index), self.key(index), self.number)
            };
            match holds {
                Some(true) => return Ok(Some(group)),
                Some(false) => {}
                None => return Err(group),
            }
        }
        Ok(None)
    }
}

impl<'a> Step<'a> {
    /// Chooses what becomes of every module.
    pub(super) fn choose(
        program: &'a Program,
        buffer: &'a Buffer,
        lists: &'a mut Lists,
        number: u32,
        monitor: &dyn Monitor,
    ) -> Result<Self, LsystemError> {
        let text = Text { program, buffer };
        let Lists { neighbours, choices, bound, spare } = lists;
        neighbours.find(program, &text);
        fit(choices, text.count(), KEEP);
        bound.resize_with(text.count().div_ceil(CHUNK), Vec::new);
        let view = View { text, neighbours, most_bound: most_bound(program), number };
        let outcomes: Vec<Result<Chosen, LsystemError>> = choices
            .par_chunks_mut(CHUNK)
            .zip(bound.par_iter_mut())
            .enumerate()
            .map(|(i, (choices, bound))| view.choose(i * CHUNK, choices, bound, monitor))
            .collect();
        let chosen = outcomes.into_iter().collect::<Result<Vec<Chosen>, LsystemError>>()?;
        let sizes = chosen.iter().map(|chosen| chosen.size).collect();
        let mut step = Self { view, choices, bound, sizes, spare };
        if chosen.iter().any(|chosen| chosen.cuts) {
            step.cut();
            step.bound = &[];
            step.sizes = step.sizes_of_chosen();
        }
        Ok(step)
    }

    /// The parameters of the group that was chosen for a module; `bound` is what is left of its chunk's.
    fn parameters_of<'s: 'o, 'o>(
        &'s self,
        group: &Group,
        index: usize,
        bound: &mut &'s [f64],
        own: &'o mut Vec<f64>,
    ) -> &'o [f64] {
        let View { text, neighbours, .. } = &self.view;
        if !group.has_context() {
            return text.arguments(index);
        }
        if let Some((parameters, rest)) = bound.split_at_checked(group.parameters) {
            *bound = rest;
            return parameters;
        }
        own.resize(group.parameters, 0.0);
        neighbours.surround(group, text, index, own, &mut 0);
        own
    }

    /// The parameters that were bound in a chunk; none where something is cut.
    fn bound(&self, chunk: usize) -> &[f64] {
        self.bound.get(chunk).map_or(&[], |bound| bound)
    }

    /// Drops what follows a chosen word that cuts, up to the end of the branch.
    fn cut(&mut self) {
        let text = &self.view.text;
        let program = text.program;
        let mut i = 0;
        while i < self.choices.len() {
            let chosen = program.alternatives.get(self.choices[i] as usize);
            i += 1;
            if chosen.is_some_and(|alternative| alternative.word.cuts) {
                let rest = rest_of_branch(text, i);
                self.choices[i..i + rest].fill(DROP);
                i += rest;
            }
        }
    }

    /// Writes the next string, within the limits.
    pub(super) fn apply<S: Sink>(self, outlet: &Outlet<'_, S>) -> Result<Buffer, LsystemError> {
        let size = Size::sum(&self.sizes);
        outlet.check_limit(size.modules)?;
        if size.values > u32::MAX.into() {
            // Places of arguments have 32 bits.
            outlet.check_limit(u64::MAX)?;
        }
        let Text { program, buffer } = self.view.text;
        let bytes = buffer.size().bytes(program).saturating_add(size.bytes(program));
        let bytes = bytes.saturating_add(outlet.sink.bytes());
        outlet.monitor.admit("deriving the L-system", bytes, "use fewer derivations")?;
        self.write()
    }

    /// What each chunk becomes, by its choices.
    fn sizes_of_chosen(&self) -> Vec<Size> {
        let of_module = |(index, &choice): (usize, &u32)| match choice {
            DROP => Size::default(),
            KEEP => self.view.size_of_kept(index),
            chosen => Size::of(self.view.text.program.alternatives[chosen as usize].word),
        };
        let chunks = self.choices.chunks(CHUNK).enumerate();
        let of_chunk = |(chunk, choices): (usize, &[u32])| {
            let sizes: Vec<Size> = (chunk * CHUNK..).zip(choices).map(of_module).collect();
            Size::sum(&sizes)
        };
        chunks.map(of_chunk).collect()
    }

    /// Writes the next string.
    fn write(self) -> Result<Buffer, LsystemError> {
        let random = self.view.text.program.random;
        let mut next = std::mem::take(self.spare);
        next.resize(Size::sum(&self.sizes), random);
        let outcomes: Vec<Result<(), LsystemError>> = next
            .slots(&self.sizes, random)
            .into_par_iter()
            .enumerate()
            .map(|(i, slot)| self.write_chunk(i * CHUNK, slot))
            .collect();
        outcomes.into_iter().collect::<Result<(), _>>()?;
        Ok(next)
    }

    fn write_chunk(&self, first: usize, mut slot: Slot<'_>) -> Result<(), LsystemError> {
        let View { text, number, .. } = &self.view;
        let program = text.program;
        let mut own = Vec::new();
        let mut bound = self.bound(first / CHUNK);
        let end = self.choices.len().min(first + CHUNK);
        let mut rest = first..end;
        while let Some(index) = rest.next() {
            match self.choices[index] {
                DROP => {}
                KEEP => {
                    let arguments = if text.entry(index).is_computed() { text.arguments(index) } else { &[] };
                    let Buffer { modules, births, .. } = text.buffer;
                    slot.module(modules[index], births[index], self.view.key(index), arguments);
                }
                chosen => {
                    let alternative = &program.alternatives[chosen as usize];
                    let group = &program.groups[alternative.group as usize];
                    // Nothing is bound behind a cut: a run would be counted anew for each of its modules.
                    let are_bound = group.has_context() && group.parameters > 0 && !bound.is_empty();
                    if are_bound && alternative.word.values > 0 && !program.random {
                        let run =
                            self.choices[index..end].iter().take_while(|&&choice| choice == chosen).count();
                        if let Some((rows, others)) = bound.split_at_checked(run * group.parameters)
                            && run >= MANY
                        {
                            bound = others;
                            slot.words(program, alternative.word, rows, group.parameters, *number)?;
                            rest = index + run..end;
                            continue;
                        }
                    }
                    let parameters = self.parameters_of(group, index, &mut bound, &mut own);
                    slot.word(program, alternative.word, parameters, self.view.key(index), *number)?;
                }
            }
        }
        Ok(())
    }

    /// Hands the modules of the next string on without writing it.
    fn hand_on<S: Sink>(&self, outlet: &mut Outlet<'_, S>) -> Result<(), LsystemError> {
        let View { text, number, .. } = &self.view;
        let program = text.program;
        let Buffer { modules, births, .. } = text.buffer;
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
                KEEP if text.entry(index).is_computed() => {
                    outlet.apply(id, text.arguments(index), birth)?;
                }
                KEEP => {
                    // With all that follow it, of the same age, and are handed on as they are.
                    let same = |i: &usize| {
                        self.choices[*i] == KEEP && births[*i] == birth && !text.entry(*i).is_computed()
                    };
                    let run = (index + 1..modules.len()).take_while(same).count();
                    outlet.give(&modules[index..=index + run], birth)?;
                    index += run;
                }
                chosen => {
                    let alternative = &program.alternatives[chosen as usize];
                    let group = &program.groups[alternative.group as usize];
                    let parameters = self.parameters_of(group, index, &mut bound, &mut own);
                    outlet.word(alternative.word, parameters, self.view.key(index), *number, &mut scratch)?;
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
        fit(&mut self.modules, modules, 0);
        fit(&mut self.births, modules, 0);
        fit(&mut self.keys, if random { modules } else { 0 }, Key::new(0));
        // Nobody looks for values where there are none.
        fit(&mut self.starts, if size.values > 0 { modules } else { 0 }, 0);
        fit(&mut self.values, size.values as usize, 0.0);
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
