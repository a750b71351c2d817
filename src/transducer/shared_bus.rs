//! One I2C bus for several parts. They take turns, first come first served, one transaction at a time. For a part behind a
//! multiplexer, its branch is opened and checked before each transaction, and closed after it. After an aborted transaction,
//! the bus is freed before the next turn.

use crate::transducer::bus::Bus;
use crate::transducer::multiplexer::{BusBranch, PortError};
use crate::transducer::rounds::RoundTimer;
use core::cell::Cell;
use embassy_sync::blocking_mutex::raw::NoopRawMutex;
use embassy_sync::mutex::Mutex;
use embassy_sync::semaphore::{FairSemaphore, Semaphore};
use embedded_hal_async::i2c::{Error, ErrorKind, ErrorType, I2c, Operation};

/// The bus of up to `N` parts.
#[derive(Debug)]
pub struct SharedBus<B, const N: usize> {
    turns: FairSemaphore<NoopRawMutex, N>,
    bus: Mutex<NoopRawMutex, B>,
}

impl<B: Bus, const N: usize> SharedBus<B, N> {
    /// A bus that nobody uses yet. Each of its transactions must end within
    /// [`OPERATION_LIMIT`](model_tables::constants::hand_bus::OPERATION_LIMIT).
    pub const fn new(bus: B) -> Self {
        Self {
            turns: FairSemaphore::new(1),
            bus: Mutex::new(bus),
        }
    }

    /// Frees the bus and closes all branches, including those that a previous run left open.
    pub async fn clear(&self) {
        self.bus.lock().await.clear().await;
    }

    /// One transaction of a part.
    async fn exchange(
        &self,
        branch: Option<BusBranch>,
        address: u8,
        operations: &mut [Operation<'_>],
    ) -> Result<(), PortError> {
        // Each of the N parts waits for one turn at a time.
        let _turn = self
            .turns
            .acquire(1)
            .await
            .map_err(|_| PortError(ErrorKind::Other))?;
        let mut bus = self.bus.lock().await;
        let outcome = match branch {
            Some(branch) => bus.through(branch, address, operations).await,
            None => bus
                .transaction(address, operations)
                .await
                .map_err(|error| PortError(error.kind())),
        };
        if let Err(PortError(kind)) = outcome
            && !matches!(kind, ErrorKind::NoAcknowledge(_))
        {
            bus.clear().await;
        }
        outcome
    }
}

/// Access of one part of a hand to the bus.
#[derive(Debug)]
pub struct BusPort<'a, B, T, const N: usize> {
    shared: &'a SharedBus<B, N>,
    branch: Option<BusBranch>,
    timer: T,
    commanded: &'a Cell<u64>,
}

impl<'a, B: Bus, T: RoundTimer, const N: usize> BusPort<'a, B, T, N> {
    /// Access to the bus or to a branch of it. The time of the part's last command, a transaction that only writes, is stored in `commanded`.
    pub const fn new(
        shared: &'a SharedBus<B, N>,
        branch: Option<BusBranch>,
        timer: T,
        commanded: &'a Cell<u64>,
    ) -> Self {
        Self {
            shared,
            branch,
            timer,
            commanded,
        }
    }
}

impl<B, T, const N: usize> ErrorType for BusPort<'_, B, T, N> {
    type Error = PortError;
}

impl<B: Bus, T: RoundTimer, const N: usize> I2c for BusPort<'_, B, T, N> {
    async fn transaction(&mut self, address: u8, operations: &mut [Operation<'_>]) -> Result<(), PortError> {
        let commands = matches!(operations, [Operation::Write(_)]);
        self.shared.exchange(self.branch, address, operations).await?;
        if commands {
            self.commanded.set(self.timer.now());
        }
        Ok(())
    }
}

impl<B: Bus, T: RoundTimer, const N: usize> Bus for BusPort<'_, B, T, N> {
    /// The shared bus has already freed itself.
    async fn clear(&mut self) {}
}
