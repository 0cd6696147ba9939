//! What the importer is told, and by which category it can choose.

/// The outcome of a call, as FMI counts it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Status {
    /// Done.
    Ok = 0,
    /// Done, with a remark.
    Warning = 1,
    /// Not done for this step size or this input; the state before the call is kept.
    Discard = 2,
    /// Refused; nothing has changed.
    Error = 3,
    /// The instance can only be freed.
    Fatal = 4,
}

/// Kinds of messages.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Category {
    /// Why a call returned `fmi2Error`.
    Error,
    /// Why a call returned `fmi2Discard`.
    Discard,
    /// Why a call returned `fmi2Fatal`.
    Fatal,
    /// What mesh and sector do not resolve, and what the equations leave out.
    Warning,
    /// What the solver did, a line a solution.
    Solver,
}

impl Category {
    /// All categories with name and description, in the order of the enum.
    pub const ITEMS: [(&'static str, &'static str); 5] = [
        ("logStatusError", "Why a call was refused: which variable, which value, what is allowed"),
        ("logStatusDiscard", "Why a step could not be done"),
        ("logStatusFatal", "A fault in the FMU itself"),
        ("logStatusWarning", "What is doubtful about a result, each kind once"),
        ("logSolver", "What the solver did, a line a solution"),
    ];

    /// Its name in modelDescription.xml.
    pub fn name(self) -> &'static str {
        Self::ITEMS[self as usize].0
    }
}

/// A message for the importer.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    /// Status of the call.
    pub status: Status,
    /// Kind of message.
    pub category: Category,
    /// The message.
    pub message: String,
}

/// Lines that wait to be handed to the importer, and which categories it wants.
#[derive(Debug, Clone)]
pub struct Log {
    enabled: [bool; 5],
    lines: Vec<Line>,
}

impl Log {
    /// Refusals, failures and warnings are always told; `debug` adds the rest.
    pub fn new(debug: bool) -> Self {
        Self { enabled: [true, true, true, true, debug], lines: Vec::new() }
    }

    /// Switches categories on or off; none named means all.
    ///
    /// # Errors
    /// A message that names the category that does not exist; nothing is switched then.
    pub fn switch(&mut self, on: bool, categories: &[String]) -> Result<(), String> {
        let mut enabled = self.enabled;
        if categories.is_empty() {
            enabled = [on; 5];
        }
        for category in categories {
            match Category::ITEMS.iter().position(|(name, _)| name == category) {
                Some(index) => enabled[index] = on,
                None => {
                    let names: Vec<_> = Category::ITEMS.iter().map(|(name, _)| *name).collect();
                    return Err(format!("log category \"{category}\" is unknown; there are {}", names.join(", ")));
                }
            }
        }
        self.enabled = enabled;
        Ok(())
    }

    /// Adds a line if its category is wanted.
    pub fn add(&mut self, status: Status, category: Category, message: impl Into<String>) {
        if self.enabled[category as usize] {
            self.lines.push(Line { status, category, message: message.into() });
        }
    }

    /// Takes out the lines that wait.
    pub fn take(&mut self) -> Vec<Line> {
        std::mem::take(&mut self.lines)
    }
}
