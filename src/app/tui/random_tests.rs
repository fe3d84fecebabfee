//! Whatever comes in whatever order at whatever size: the model takes it and the view shows it.

use crossterm::event::{Event, KeyCode, KeyModifiers, MouseButton, MouseEvent, MouseEventKind};
use linden::random::Key as Seed;
use linden_terminal::input::Shortcut;

use super::commands;
use super::testing::Bench;
use super::update::Msg;

/// Numbers that are the same every time.
struct Dice {
    seed: Seed,
    thrown: u64,
}

impl Dice {
    fn below(&mut self, n: usize) -> usize {
        self.thrown += 1;
        (self.seed.child(self.thrown).unit() * n as f64) as usize
    }

    fn event(&mut self, keys: &[Shortcut], size: (u16, u16)) -> Msg {
        let mouse = |dice: &mut Self, kind| {
            let (column, row) = (dice.below(size.0.into()) as u16, dice.below(size.1.into()) as u16);
            let held = dice.below(6);
            let modifiers = match held {
                0 => KeyModifiers::SHIFT,
                1 => KeyModifiers::ALT,
                2 => KeyModifiers::CONTROL,
                _ => KeyModifiers::NONE,
            };
            let mouse = MouseEvent { kind, column, row, modifiers };
            Msg::Input(Event::Mouse(mouse))
        };
        let button = [MouseButton::Left, MouseButton::Middle, MouseButton::Right][self.below(3)];
        match self.below(20) {
            0 => Msg::Resized(1 + self.below(400) as u16, 1 + self.below(120) as u16),
            1 => Msg::Resized(1 + self.below(60) as u16, 1 + self.below(12) as u16),
            2 => Msg::Tick,
            3 => Msg::Input(Event::Paste(["fir", "年輪\n\u{1b}[2J", "1e9", ""][self.below(4)].to_owned())),
            4 => mouse(self, MouseEventKind::Drag(button)),
            5 => mouse(self, MouseEventKind::Up(button)),
            6 => mouse(self, MouseEventKind::ScrollUp),
            7 => mouse(self, MouseEventKind::ScrollDown),
            8 | 9 => mouse(self, MouseEventKind::Down(button)),
            10 => {
                Msg::Input(Event::Key(KeyCode::Char(['a', '7', '.', 'é', '木', '-'][self.below(6)]).into()))
            }
            11 => Msg::Input(Event::Key(KeyCode::Esc.into())),
            _ => Msg::Input(Event::Key(keys[self.below(keys.len())].into())),
        }
    }
}

#[test]
fn no_order_of_events_breaks_the_workbench() {
    let keys: Vec<Shortcut> =
        commands::all().flat_map(|command| command.keys).map(|key| key.parse().unwrap()).collect();
    for round in 0..60 {
        let mut dice = Dice { seed: Seed::new(round), thrown: 0 };
        let mut bench = Bench::grown(100, 30);
        for _ in 0..150 {
            let event = dice.event(&keys, bench.model.size);
            // Paints, too.
            bench.msg(event);
            bench.load();
        }
    }
}
