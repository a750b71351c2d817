//! TCA9548A (Texas Instruments, SCPS207): an I2C bus to eight branches. It has one register with one bit for each branch. A set
//! bit opens its branch, from the stop after the write on (section 8.6.2). The pin RESET closes all of them (section 8.3.2).

use embedded_hal_async::i2c::{Error, ErrorKind, I2c, Operation};

/// A branch of a multiplexer.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct BusBranch {
    /// The multiplexer's seven-bit address, 0x70 to 0x77.
    pub multiplexer: u8,
    /// Its channel, 0 to 7.
    pub number: u8,
}

impl BusBranch {
    /// A transaction with a part on this branch. The branch is opened and checked before it, and closed after it.
    ///
    /// # Errors
    /// [`PortError`] of the multiplexer or the part. After an error the branch may still be open, unless the part did not acknowledge.
    pub async fn transaction<B: I2c>(
        self,
        bus: &mut B,
        address: u8,
        operations: &mut [Operation<'_>],
    ) -> Result<(), PortError> {
        self.open(bus).await?;
        let outcome = bus
            .transaction(address, operations)
            .await
            .map_err(|error| PortError(error.kind()));
        match outcome {
            // The transaction succeeded, or nobody acknowledged. In both cases the bus is free, so the branch can be closed.
            Ok(()) | Err(PortError(ErrorKind::NoAcknowledge(_))) => self.close(bus).await.and(outcome),
            Err(_) => outcome,
        }
    }

    /// Opens only this branch of its multiplexer, and reads the register back.
    ///
    /// # Errors
    /// [`PortError`] of the bus if the multiplexer does not answer, or if its register has another value.
    async fn open<B: I2c>(self, bus: &mut B) -> Result<(), PortError> {
        let wanted = [1 << (self.number & 7)];
        bus.write(self.multiplexer, &wanted)
            .await
            .map_err(|error| of_it(&error))?;
        let mut found = [0];
        bus.read(self.multiplexer, &mut found)
            .await
            .map_err(|error| of_it(&error))?;
        if found == wanted {
            Ok(())
        } else {
            Err(PortError(ErrorKind::Other))
        }
    }

    /// Closes all branches of its multiplexer.
    ///
    /// # Errors
    /// [`PortError`] of the bus if the multiplexer does not answer.
    async fn close<B: I2c>(self, bus: &mut B) -> Result<(), PortError> {
        bus.write(self.multiplexer, &[0])
            .await
            .map_err(|error| of_it(&error))
    }
}

/// Why a transaction failed.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct PortError(pub ErrorKind);

impl Error for PortError {
    fn kind(&self) -> ErrorKind {
        self.0
    }
}

/// A multiplexer that does not answer is a fault of the bus, because the state of the part behind it is unknown.
fn of_it(error: &impl Error) -> PortError {
    PortError(match error.kind() {
        ErrorKind::NoAcknowledge(_) => ErrorKind::Other,
        kind => kind,
    })
}
