//! One time step: predicted, solved, checked and accepted.

use super::{
    Drive, ENERGY_TOLERANCE, FIRST_ENERGY_TOLERANCE, FIRST_TRAVEL, FORCE_ITERATIONS, FORCE_TOLERANCE,
    History, LARGEST_BEND, LARGEST_GROWTH, LARGEST_TRAVEL, Next, Rejected, Solved,
};
use crate::solid::disc::DiscEnd;
use crate::solid::state::Balance;
use crate::solid::{Failure, section};

impl History {
    /// Solves a step of so many seconds.
    pub(super) fn step(&mut self, seconds: f64, drive: Drive, target: f64) -> Result<Solved, Rejected> {
        if let Some(memory) = &mut self.wall.memory {
            memory.begin(seconds);
        }
        if let Some(outlet) = &mut self.outlet {
            outlet.disc.begin(seconds);
        }
        let (indentation, balance) = match drive {
            Drive::Indentation(_) => {
                self.predict(seconds, target - self.indentation);
                (target, self.settle(target)?)
            }
            Drive::Force(_) => {
                self.predict(seconds, 0.0);
                let (indentation, balance) = self.settle_force(target)?;
                let travel = (indentation - self.indentation).abs() / (LARGEST_TRAVEL * self.height);
                if travel > 1.0 {
                    return Err(Rejected::TooLong(travel * travel));
                }
                // As it would have been predicted for this.
                let trial = self.trial.clone();
                self.predict(seconds, indentation - self.indentation);
                self.trial = trial;
                (indentation, balance)
            }
        };
        if let Some(by) = section::touches_base(&self.wall, &self.trial) {
            return Err(Rejected::Touches(by));
        }
        let of_disc = self.outlet.as_ref().map_or(0.0, |outlet| outlet.disc.share());
        let share = (self.bend() / (LARGEST_BEND * self.height)).max(of_disc);
        if share > 1.0 {
            return Err(Rejected::TooLong(share));
        }
        let (energy, work) = self.work_of_step(indentation, &balance)?;
        let of_actuator = match &mut self.outlet {
            Some(outlet) => {
                let work = outlet.disc.work_of_step();
                Some(work.ok_or(Rejected::Actuator(DiscEnd::NoFurtherState))?)
            }
            None => None,
        };
        Ok(Solved {
            indentation,
            balance,
            share,
            energy,
            work,
            of_actuator,
        })
    }

    /// Relaxed strain energy after the trial, and work of the wall's stresses and of what the fluid carried out in it: as much as the plate does. What is in balance but on
    /// another branch fails this.
    fn work_of_step(&mut self, indentation: f64, balance: &Balance) -> Result<(f64, f64), Rejected> {
        // Between the two walls' iterations the excess volumes are not far below the tolerance: their work counts.
        let energy = if self.outlet.is_some() {
            self.wall.potential(&self.trial)
        } else {
            self.wall.energy(&self.trial)
        };
        let mut work = energy - self.energy;
        if let Some(memory) = &mut self.wall.memory {
            work += memory.end(&self.wall.mesh, &self.wall.material, &self.trial);
        }
        if self.outlet.is_some() {
            work += 0.5 * (self.state.fluid + self.trial.fluid) * (self.volume - balance.volume);
        }
        let supplied = 0.5 * (self.force + balance.force) * (indentation - self.indentation);
        let of_both = supplied.abs().max(work.abs());
        let first = FIRST_TRAVEL * LARGEST_TRAVEL * self.height;
        let allowed = if self.most_work > 0.0 && self.indentation >= first {
            ENERGY_TOLERANCE[0] * of_both + ENERGY_TOLERANCE[1] * self.most_work
        } else {
            // Work grows as the square of the travel: a shorter step is allowed what the first one would be.
            let part = (indentation - self.indentation).abs() / first;
            FIRST_ENERGY_TOLERANCE * of_both / (part * part).clamp(1e-6, 1.0)
        };
        // Nothing at all was done before the plate touches.
        if (work - supplied).abs() <= allowed + f64::EPSILON {
            Ok((energy, work))
        } else {
            Err(Rejected::Failed(Failure::Elsewhere))
        }
    }

    /// Starts the trial where the wall is likely to be after a step of so many seconds in which the plate goes so far, and keeps that.
    fn predict(&mut self, seconds: f64, travel: f64) {
        let ratio = if self.force > 0.0 {
            travel
        } else if self.seconds > 0.0 {
            (seconds / self.seconds).min(LARGEST_GROWTH)
        } else {
            0.0
        };
        self.guess.copy_from(&self.state);
        self.guess.add(ratio, &self.onward);
        self.trial.copy_from(&self.guess);
    }

    /// The largest distance of a node from the guess.
    fn bend(&self) -> f64 {
        let (trial, guess) = (self.trial.nodes.as_flattened(), self.guess.nodes.as_flattened());
        trial
            .iter()
            .zip(guess)
            .fold(0.0, |largest, (x, y)| f64::max(largest, (x - y).abs()))
    }

    /// Solves with the plate at an indentation.
    fn settle(&mut self, indentation: f64) -> Result<Balance, Rejected> {
        let plate = self.height - indentation;
        if let Some(outlet) = &mut self.outlet {
            return outlet.settle(
                &mut self.wall,
                &mut self.trial,
                plate,
                self.whole,
                &mut self.fluid,
            );
        }
        self.wall
            .settle(&mut self.trial, plate, &self.fluid)
            .map_err(Rejected::Failed)
    }

    /// Solves with a force on the plate: where it is, and the balance.
    fn settle_force(&mut self, force: f64) -> Result<(f64, Balance), Rejected> {
        if force <= 0.0 {
            let balance = self.settle(-self.height)?;
            return Ok((self.height - self.top(&self.trial), balance));
        }
        let largest = LARGEST_TRAVEL * self.height;
        let mut indentation = if self.force > 0.0 {
            self.indentation
        } else {
            // Nothing presses at first touch, and nothing is factored.
            self.height - self.top(&self.trial) + 0.01 * largest
        };
        for _ in 0..FORCE_ITERATIONS {
            let balance = self.settle(indentation)?;
            let missing = force - balance.force;
            if missing.abs() <= FORCE_TOLERANCE * force {
                return Ok((indentation, balance));
            }
            let stiffness = if balance.force > 0.0 {
                let tangent = self.wall.tangent(&self.fluid);
                tangent.ok_or(Rejected::Failed(Failure::Singular))?.force
            } else {
                0.0
            };
            let step = missing / stiffness;
            // Before first touch there is no stiffness, and after it little.
            let touch = self.height - self.top(&self.trial) - indentation;
            indentation += if stiffness > 0.0 {
                step.clamp(-largest, largest)
            } else {
                touch.max(0.0) + 0.01 * largest
            };
        }
        Err(Rejected::Failed(Failure::Stalled { residual: 1.0 }))
    }

    /// Takes a step as it was solved.
    pub(super) fn take(&mut self, solved: &Solved, seconds: f64) -> Option<()> {
        if let (Some(outlet), Some(work)) = (&mut self.outlet, solved.of_actuator) {
            outlet.disc.take(work, seconds)?;
        }
        if let Some(memory) = &mut self.wall.memory {
            memory.take();
        }
        self.energy = solved.energy;
        self.volume = solved.balance.volume;
        self.work += solved.work;
        self.most_work = self.most_work.max(self.work);
        self.supplied += 0.5 * (self.force + solved.balance.force) * (solved.indentation - self.indentation);
        self.onward.copy_from(&self.trial);
        self.onward.add(-1.0, &self.state);
        if solved.balance.force > 0.0
            && let Some(tangent) = self.wall.tangent(&self.fluid)
        {
            self.onward = tangent.state;
        }
        self.state.copy_from(&self.trial);
        let travel = (solved.indentation - self.indentation).abs();
        self.indentation = solved.indentation;
        self.force = solved.balance.force;
        self.seconds = seconds;
        let growth = libm::sqrt(0.6 / solved.share.max(1e-3)).clamp(0.5, LARGEST_GROWTH);
        self.next = Next {
            seconds: growth * seconds,
            travel: (growth * travel.max(self.next.travel)).min(LARGEST_TRAVEL * self.height),
        };
        self.steps += 1;
        Some(())
    }
}
