//! Whatever comes in whatever order at whatever size: the model takes it and the view shows it.

use linden::random::Key as Seed;
use linden_terminal::input::{Button, Event, Key, KeyCode, Mouse, MouseAction};

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

    fn event(&mut self, keys: &[Key], size: (u16, u16)) -> Msg {
        let mouse = |dice: &mut Self, action| {
            let (column, row) = (dice.below(size.0.into()) as u16, dice.below(size.1.into()) as u16);
            let held = dice.below(6);
            let mouse = Mouse { action, column, row, shift: held == 0, alt: held == 1, ctrl: held == 2 };
            Msg::Input(Event::Mouse(mouse))
        };
        let button = [Button::Left, Button::Middle, Button::Right][self.below(3)];
        match self.below(20) {
            0 => Msg::Resized(1 + self.below(400) as u16, 1 + self.below(120) as u16),
            1 => Msg::Resized(1 + self.below(60) as u16, 1 + self.below(12) as u16),
            2 => Msg::Tick,
            3 => Msg::Input(Event::Paste(["fir", "年輪\n\u{1b}[2J", "1e9", ""][self.below(4)].to_owned())),
            4 => mouse(self, MouseAction::Drag(button)),
            5 => mouse(self, MouseAction::Release(button)),
            6 => mouse(self, MouseAction::WheelUp),
            7 => mouse(self, MouseAction::WheelDown),
            8 | 9 => mouse(self, MouseAction::Press(button)),
            10 => Msg::Input(Event::Key(Key::char(['a', '7', '.', 'é', '木', '-'][self.below(6)]))),
            11 => Msg::Input(Event::Key(Key::plain(KeyCode::Escape))),
            _ => Msg::Input(Event::Key(keys[self.below(keys.len())])),
        }
    }
}

#[test]
fn no_order_of_events_breaks_the_workbench() {
    let keys: Vec<Key> =
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
