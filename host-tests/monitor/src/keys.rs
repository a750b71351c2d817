//! What keys ask for, and the line in which numbers for commands are typed.

use fingertip::link::command::Command;
use model_tables::table::law::Touched;
use ratatui::crossterm::event::{KeyCode, KeyEvent, KeyModifiers};

/// Every key with its meaning, and with a word for a small screen, for the help.
pub(crate) const HELP: [(&str, &str, &str); 17] = [
    ("t", "tare: the fingertip is unloaded, take a new zero", "tare"),
    ("u", "undo the last tare", "undo"),
    ("s", "save zero and gain in the board", "save"),
    ("g", "save another gain, parts in a million", "gain"),
    ("f", "forget what is saved", "forget"),
    ("i", "info: ask for a hello", "info"),
    ("x", "self-test, at an indentation in mm", "test"),
    ("r", "rate: every so many-th report", "rate"),
    ("a", "air around an absolute part, Pa", "air"),
    ("o", "object: radius in mm; 0 a plate, below 0 a cup", "object"),
    ("d", "indentation now, in mm: force and curvature", "depth"),
    ("c", "chart force or pressure rise", "chart"),
    ("p", "pause the screen; a log goes on", "pause"),
    ("k", "forget the peak", "peak 0"),
    ("?", "this help", "help"),
    ("Esc", "leave help or a number", "back"),
    ("q", "quit", "quit"),
];

/// A command that needs a number, or to be confirmed.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub(crate) enum Question {
    Gain,
    Forget,
    SelfTest,
    Rate,
    Air,
    Object,
    Indentation,
}

impl Question {
    fn label(self) -> &'static str {
        match self {
            Self::Gain => "gain, ppm added to the pressure rise (-100000 to 100000): ",
            Self::Forget => "forget the saved zero and gain? y to confirm: ",
            Self::SelfTest => "indentation now, mm (0: not known): ",
            Self::Rate => "every so many-th report (1 to 1000): ",
            Self::Air => "air, Pa (60000 to 108000): ",
            Self::Indentation => "indentation now, mm: ",
            Self::Object => "radius, mm (0: a plate; below 0: a cup): ",
        }
    }

    /// The command for an answer, or what is wrong with it.
    fn command(self, answer: &str) -> Result<Command, String> {
        if self == Self::Forget {
            return match answer {
                "y" | "Y" => Ok(Command::Forget),
                _ => Err("not confirmed".to_owned()),
            };
        }
        let number: f64 = answer
            .parse()
            .map_err(|_| format!("`{answer}` is not a number"))?;
        let within = |low: f64, high: f64| {
            if (low..=high).contains(&number) {
                Ok(number)
            } else {
                Err(format!("{answer} is not within {low} to {high}"))
            }
        };
        let micrometres = |radius: f64| (1e3 * radius).round() as i32;
        Ok(match self {
            Self::Gain => Command::Save {
                gain: Some(within(-1e5, 1e5)?.round() as i32),
            },
            Self::SelfTest => Command::SelfTest {
                indentation: (1e6 * within(0.0, 100.0)?).round() as i32,
            },
            Self::Indentation => Command::Indentation {
                known: (1e6 * within(0.001, 100.0)?).round() as i32,
            },
            Self::Rate => Command::Rate {
                every: within(1.0, 1000.0)?.round() as u16,
            },
            Self::Air => Command::Air {
                pascals: within(6e4, 1.08e5)?.round() as i32,
            },
            Self::Object if number == 0.0 => Command::Object(Touched::Plate),
            Self::Object if number > 0.0 => Command::Object(Touched::Ball(micrometres(within(0.001, 1e6)?))),
            Self::Object => Command::Object(Touched::Cup(micrometres(-within(-1e6, -0.001)?))),
            Self::Forget => Command::Forget,
        })
    }
}

/// What the keyboard asks for.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum KeyAction {
    Quit,
    Send(Command),
    Pause,
    Chart,
    ForgetPeak,
    /// A line for the journal.
    Tell(String),
}

/// The state of the keyboard: a number being typed, the help shown.
#[derive(Clone, Debug, Default)]
pub(crate) struct Keyboard {
    question: Option<(Question, String)>,
    /// Whether the help is shown.
    pub(crate) help: bool,
}

impl Keyboard {
    /// The line that is being typed; none where there is no question.
    pub(crate) fn line(&self) -> Option<String> {
        self.question
            .as_ref()
            .map(|(question, answer)| format!("{}{answer}_", question.label()))
    }

    /// Takes a key.
    pub(crate) fn press(&mut self, key: KeyEvent) -> Option<KeyAction> {
        if key.code == KeyCode::Char('c') && key.modifiers.contains(KeyModifiers::CONTROL) {
            return Some(KeyAction::Quit);
        }
        if let Some((question, mut answer)) = self.question.take() {
            match key.code {
                KeyCode::Enter => {
                    return Some(match question.command(answer.trim()) {
                        Ok(command) => KeyAction::Send(command),
                        Err(reason) => KeyAction::Tell(format!("not sent: {reason}")),
                    });
                }
                KeyCode::Esc => return None,
                KeyCode::Backspace => drop(answer.pop()),
                KeyCode::Char(letter) if answer.len() < 12 => answer.push(letter),
                _ => {}
            }
            self.question = Some((question, answer));
            return None;
        }
        if std::mem::take(&mut self.help) && key.code == KeyCode::Esc {
            return None;
        }
        let KeyCode::Char(letter) = key.code else {
            return (key.code == KeyCode::Esc).then_some(KeyAction::Quit);
        };
        let question = match letter {
            'q' => return Some(KeyAction::Quit),
            't' => return Some(KeyAction::Send(Command::Tare)),
            'u' => return Some(KeyAction::Send(Command::Undo)),
            's' => return Some(KeyAction::Send(Command::Save { gain: None })),
            'i' => return Some(KeyAction::Send(Command::Info)),
            'p' | ' ' => return Some(KeyAction::Pause),
            'c' => return Some(KeyAction::Chart),
            'k' => return Some(KeyAction::ForgetPeak),
            '?' | 'h' => {
                self.help = true;
                return None;
            }
            'g' => Question::Gain,
            'f' => Question::Forget,
            'x' => Question::SelfTest,
            'r' => Question::Rate,
            'a' => Question::Air,
            'o' => Question::Object,
            'd' => Question::Indentation,
            _ => return None,
        };
        self.question = Some((question, String::new()));
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What the last of these keys asks for.
    fn typed(keys: &str) -> Option<KeyAction> {
        let mut keyboard = Keyboard::default();
        keys.chars()
            .map(|letter| match letter {
                '\n' => KeyCode::Enter,
                '\u{1b}' => KeyCode::Esc,
                '<' => KeyCode::Backspace,
                letter => KeyCode::Char(letter),
            })
            .map(|code| keyboard.press(KeyEvent::new(code, KeyModifiers::NONE)))
            .last()
            .flatten()
    }

    #[test]
    fn numbers_are_typed_and_checked_before_they_are_sent() {
        let send = |command| Some(KeyAction::Send(command));
        assert_eq!(typed("g-2500\n"), send(Command::Save { gain: Some(-2500) }));
        assert_eq!(typed("r19<0\n"), send(Command::Rate { every: 10 }));
        assert_eq!(typed("x0.75\n"), send(Command::SelfTest { indentation: 750_000 }));
        assert_eq!(typed("a101325\n"), send(Command::Air { pascals: 101_325 }));
        assert_eq!(typed("o0\n"), send(Command::Object(Touched::Plate)));
        assert_eq!(typed("o8\n"), send(Command::Object(Touched::Ball(8000))));
        assert_eq!(typed("o-20\n"), send(Command::Object(Touched::Cup(20_000))));
        assert_eq!(typed("d0.75\n"), send(Command::Indentation { known: 750_000 }));
        assert_eq!(typed("fy\n"), send(Command::Forget));
        for refused in [
            "g1e9\n", "r0\n", "r1001\n", "a1\n", "x-1\n", "f\n", "fn\n", "onan\n",
        ] {
            assert!(matches!(typed(refused), Some(KeyAction::Tell(_))), "{refused}");
        }
        // Esc leaves the number, not the program.
        assert_eq!(typed("g25\u{1b}"), None);
        assert_eq!(typed("\u{1b}"), Some(KeyAction::Quit));
        assert_eq!(typed("?\u{1b}"), None);
    }
}
