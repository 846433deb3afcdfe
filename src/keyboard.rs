//! The keyboard pilot: a person drives with the keys of a terminal.

use agent::Features;
use anyhow::{anyhow, ensure};
use crossterm::event::{self, Event, KeyCode, KeyEvent, KeyEventKind, KeyModifiers};
use crossterm::terminal;
use interfaces::Twist;
use mapper::Mapper;
use robot::{Belief, Pilot, PilotView};
use std::io::IsTerminal;
use std::time::{Duration, Instant};

/// A terminal reports that a key is pressed, but not that it is released: a key counts for this time, which is
/// longer than the delay before a held key repeats.
const HOLD: Duration = Duration::from_millis(600);

/// Drives with arrows or WASD; space stops, Q or Esc ends the run.
///
/// The terminal is in raw mode until the value is dropped.
#[derive(Debug)]
pub struct Keyboard {
    max: Twist,
    command: Twist,
    pressed: Option<Instant>,
    is_done: bool,
}

impl Keyboard {
    /// Reads the keys of the terminal; `max` is the maximum speed of the robot.
    ///
    /// # Errors
    ///
    /// When there is no terminal, or its keys cannot be read.
    pub fn new(max: Twist) -> anyhow::Result<Self> {
        ensure!(
            std::io::stdin().is_terminal(),
            "--drive keyboard needs a terminal to read keys from; use --drive agent or --drive tour here"
        );
        terminal::enable_raw_mode().map_err(|why| anyhow!("cannot read keys from this terminal: {why}"))?;
        Ok(Self { max, command: Twist::STOP, pressed: None, is_done: false })
    }

    fn press(&mut self, key: KeyEvent) {
        if key.kind == KeyEventKind::Release {
            return;
        }
        let is_interrupt = key.modifiers.contains(KeyModifiers::CONTROL) && key.code == KeyCode::Char('c');
        let (linear, angular) = match key.code {
            _ if is_interrupt => return self.is_done = true,
            KeyCode::Char('q' | 'Q') | KeyCode::Esc => return self.is_done = true,
            KeyCode::Up | KeyCode::Char('w' | 'W') => (1.0, 0.0),
            KeyCode::Down | KeyCode::Char('s' | 'S') => (-0.5, 0.0),
            KeyCode::Left | KeyCode::Char('a' | 'A') => (0.0, 0.5),
            KeyCode::Right | KeyCode::Char('d' | 'D') => (0.0, -0.5),
            KeyCode::Char(' ') => (0.0, 0.0),
            _ => return,
        };
        // A turn during a forward drive keeps the speed: a curve.
        let keeps_driving = angular != 0.0 && self.command.linear_mps > 0.0;
        self.command = Twist {
            linear_mps: if keeps_driving { self.command.linear_mps } else { linear * self.max.linear_mps },
            angular_radps: angular * self.max.angular_radps,
        };
        self.pressed = Some(Instant::now());
    }
}

impl Pilot for Keyboard {
    type Command = Twist;

    fn command(&mut self, _: &Belief, _: Features, _: &Mapper) -> Twist {
        // The terminal is gone after an error: stop, and let the run write its results.
        loop {
            match event::poll(Duration::ZERO)
                .and_then(|has| if has { event::read().map(Some) } else { Ok(None) })
            {
                Ok(Some(Event::Key(key))) => self.press(key),
                Ok(Some(_)) => {}
                Ok(None) => break,
                Err(_) => {
                    self.is_done = true;
                    break;
                }
            }
        }
        if self.pressed.is_none_or(|pressed| pressed.elapsed() > HOLD) {
            self.command = Twist::STOP;
        }
        self.command
    }

    fn view(&self) -> PilotView<'_> {
        PilotView { is_done: self.is_done, ..PilotView::default() }
    }
}

impl Drop for Keyboard {
    fn drop(&mut self) {
        let _ = terminal::disable_raw_mode(); // fails only without a terminal
    }
}
